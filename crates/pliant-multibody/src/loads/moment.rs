//! A moment at a point of a line. The tangent t turns by `d theta = t x dt / |t|^2`, so the generalized force on it
//! is `(m x t) / |t|^2`; the part of m along t does no work, for a line has no twist. On the axes of a rigid body a
//! moment acts as `f_ei = (m x e_i) / 2`, for `sum_i e_i x (m x e_i) = 2 m`.

use super::Load;
use super::force::add_outer;
use crate::point::{Interpolation, Support};
use crate::signal;
use crate::vector::vector;

/// A moment fixed in space.
#[derive(Clone, Debug)]
pub struct Moment {
    t: Interpolation,
    support: Support,
}

impl Moment {
    /// A moment on the tangent `t`.
    #[must_use]
    pub fn new(t: Interpolation, support: Support) -> Self {
        Self { t, support }
    }
}

impl Load for Moment {
    fn add_force(
        &self,
        _now: signal::Moment<'_>,
        value: [f64; 3],
        q: &[f64],
        factor: f64,
        force: &mut [f64],
    ) {
        let t = vector(self.t.at(q));
        let f = vector(value).cross(&t) * (factor / t.norm_squared());
        self.t.add_force(f.into(), force);
    }

    fn supports(&self) -> &[Support] {
        std::slice::from_ref(&self.support)
    }

    fn jacobian(&self, _part: usize, value: [f64; 3], q: &[f64], factor: f64, out: &mut [f64]) {
        out.fill(0.0);
        // d/dt of (m x t)/|t|^2: [m]x/|t|^2 - 2 (m x t) t^T/|t|^4
        let (m, t) = (vector(value), vector(self.t.at(q)));
        let l2 = t.norm_squared();
        let k = m.cross_matrix() / l2 - m.cross(&t) * t.transpose() * (2.0 / (l2 * l2));
        add_outer(&self.support, &self.t, &self.t, &(k * factor), out);
    }
}

/// A moment on a rigid body, fixed in space.
#[derive(Clone, Debug)]
pub struct BodyMoment {
    e: [Interpolation; 3],
    support: Support,
}

impl BodyMoment {
    /// A moment on the axes `e`.
    #[must_use]
    pub fn new(e: [Interpolation; 3], support: Support) -> Self {
        Self { e, support }
    }
}

impl Load for BodyMoment {
    fn add_force(
        &self,
        _now: signal::Moment<'_>,
        value: [f64; 3],
        q: &[f64],
        factor: f64,
        force: &mut [f64],
    ) {
        for e in &self.e {
            let f = vector(value).cross(&vector(e.at(q))) * (0.5 * factor);
            e.add_force(f.into(), force);
        }
    }

    fn supports(&self) -> &[Support] {
        std::slice::from_ref(&self.support)
    }

    fn jacobian(&self, _part: usize, value: [f64; 3], _q: &[f64], factor: f64, out: &mut [f64]) {
        out.fill(0.0);
        let k = vector(value).cross_matrix() * (0.5 * factor);
        for e in &self.e {
            add_outer(&self.support, e, e, &k, out);
        }
    }
}
