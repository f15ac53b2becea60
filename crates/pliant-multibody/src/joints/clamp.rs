//! Clamp of a line to the world: `phi = (r - r_0, t.n1, t.n2)` (5 equations), t the tangent dr/ds.
//!
//! The length of t stays free: fixing it would impose the stress-free stretch at the clamp. The first three
//! multipliers are minus the force on the line, the others minus a force on its tangent along the normals.

use super::Joint;
use crate::point::{Interpolation, Support};
use crate::vector::{normals, vector};
use nalgebra::Vector3;

/// Position and direction of the tangent are fixed.
#[derive(Clone, Debug)]
pub struct Clamp {
    r: Interpolation,
    t: Interpolation,
    n: [Vector3<f64>; 2],
    support: Support,
}

impl Clamp {
    /// Fixes the point `r` at `position` and its tangent `t` to the unit vector `direction`.
    #[must_use]
    pub fn new(
        r: &Interpolation,
        t: &Interpolation,
        position: [f64; 3],
        direction: Vector3<f64>,
        support: Support,
    ) -> Self {
        let (n1, n2) = normals(direction);
        let mut r = support.localize(r);
        r.constant = position.map(|x| -x);
        Self { r, t: support.localize(t), n: [n1, n2], support }
    }
}

impl Joint for Clamp {
    fn equations(&self) -> usize {
        5
    }

    fn support(&self) -> &Support {
        &self.support
    }

    fn scale(&self, length: f64, out: &mut [f64]) {
        out[..3].fill(length);
        out[3..].fill(1.0);
    }

    fn residual(&self, _t: f64, x: &[f64], phi: &mut [f64]) {
        phi[..3].copy_from_slice(&self.r.at(x));
        let t = vector(self.t.at(x));
        phi[3] = t.dot(&self.n[0]);
        phi[4] = t.dot(&self.n[1]);
    }

    fn jacobian(&self, _t: f64, _x: &[f64], out: &mut [f64]) {
        out.fill(0.0);
        let n = self.support.unknowns.len();
        for &(offset, w) in &self.r.terms {
            for k in 0..3 {
                out[k * n + offset + k] += w;
            }
        }
        for (row, normal) in self.n.iter().enumerate() {
            for &(offset, w) in &self.t.terms {
                for k in 0..3 {
                    out[(3 + row) * n + offset + k] += w * normal[k];
                }
            }
        }
    }

    fn reaction(&self, _t: f64, x: &[f64], lambda_: &[f64]) -> ([f64; 3], [f64; 3]) {
        // Virtual work of a moment m on the tangent: m . (t x dt) / |t|^2, hence m = t x f_t.
        let f_t = -(self.n[0] * lambda_[3] + self.n[1] * lambda_[4]);
        let m = vector(self.t.at(x)).cross(&f_t);
        ([-lambda_[0], -lambda_[1], -lambda_[2]], m.into())
    }
}
