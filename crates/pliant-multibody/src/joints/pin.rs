//! Pin: two points coincide, `phi = r_a - r_b` (3 equations). The multiplier is the force on b, and minus that on a.

use super::Joint;
use crate::point::{Interpolation, Support};

/// Two points coincide.
#[derive(Clone, Debug)]
pub struct Pin {
    a: Interpolation,
    b: Interpolation,
    support: Support,
}

impl Pin {
    /// A pin between two points, given over the coordinates of `support`.
    #[must_use]
    pub fn new(a: &Interpolation, b: &Interpolation, support: Support) -> Self {
        Self { a: support.localize(a), b: support.localize(b), support }
    }
}

impl Joint for Pin {
    fn equations(&self) -> usize {
        3
    }

    fn support(&self) -> &Support {
        &self.support
    }

    fn scale(&self, length: f64, out: &mut [f64]) {
        out.fill(length);
    }

    fn residual(&self, _t: f64, x: &[f64], phi: &mut [f64]) {
        let (a, b) = (self.a.at(x), self.b.at(x));
        for k in 0..3 {
            phi[k] = a[k] - b[k];
        }
    }

    fn jacobian(&self, _t: f64, _x: &[f64], out: &mut [f64]) {
        out.fill(0.0);
        let n = self.support.unknowns.len();
        for (point, sign) in [(&self.a, 1.0), (&self.b, -1.0)] {
            for &(offset, w) in &point.terms {
                for k in 0..3 {
                    out[k * n + offset + k] += sign * w;
                }
            }
        }
    }

    fn reaction(&self, _t: f64, _x: &[f64], lambda_: &[f64]) -> ([f64; 3], [f64; 3]) {
        ([-lambda_[0], -lambda_[1], -lambda_[2]], [0.0; 3])
    }
}
