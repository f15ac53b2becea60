//! A force at a point: fixed in space, or following the tangent of a line or a rigid body.

use super::Load;
use crate::point::{Interpolation, Support};
use crate::signal;
use crate::vector::vector;
use nalgebra::{Matrix3, Vector3};

/// A force fixed in space.
#[derive(Clone, Debug)]
pub struct DeadForce {
    /// Where it acts.
    pub r: Interpolation,
}

impl Load for DeadForce {
    fn add_force(
        &self,
        _now: signal::Moment<'_>,
        value: [f64; 3],
        _q: &[f64],
        factor: f64,
        force: &mut [f64],
    ) {
        self.r.add_force(value.map(|f| factor * f), force);
    }
}

/// A force that turns with the tangent t of a line, in the plane of the starting tangent t_0 and the given force:
/// `F = p_t t/|t| + p_n n x t/|t|`, n normal to that plane.
#[derive(Clone, Debug)]
pub struct FollowerForce {
    r: Interpolation,
    t: Interpolation,
    t_0: Vector3<f64>,
    support: Support,
}

impl FollowerForce {
    /// A force at `r` following the tangent `t`, which starts along the unit vector `t_0`.
    #[must_use]
    pub fn new(r: Interpolation, t: Interpolation, t_0: Vector3<f64>, support: Support) -> Self {
        Self { r, t, t_0, support }
    }

    /// `p_t I + p_n [n]x`, which turns t/|t| into the force.
    fn matrix(&self, value: [f64; 3]) -> Matrix3<f64> {
        let f = vector(value);
        let p_t = f.dot(&self.t_0);
        Matrix3::from_diagonal_element(p_t) + self.t_0.cross(&f).cross_matrix()
    }
}

impl Load for FollowerForce {
    fn add_force(
        &self,
        _now: signal::Moment<'_>,
        value: [f64; 3],
        q: &[f64],
        factor: f64,
        force: &mut [f64],
    ) {
        let f = self.matrix(value) * vector(self.t.at(q)).normalize() * factor;
        self.r.add_force(f.into(), force);
    }

    fn supports(&self) -> &[Support] {
        std::slice::from_ref(&self.support)
    }

    fn jacobian(&self, _part: usize, value: [f64; 3], q: &[f64], factor: f64, out: &mut [f64]) {
        // d(t/|t|)/dt = I/|t| - t t^T/|t|^3
        out.fill(0.0);
        let t = vector(self.t.at(q));
        let l = t.norm();
        let k = self.matrix(value) * (Matrix3::identity() / l - t * t.transpose() / l.powi(3));
        add_outer(&self.support, &self.r, &self.t, &(k * factor), out);
    }
}

/// A force that turns with a rigid body: `F = sum_i (e_i0.p) e_i`, p the given force and e_i0 the axes at the start.
#[derive(Clone, Debug)]
pub struct BodyForce {
    r: Interpolation,
    e: [Interpolation; 3],
    start: [Vector3<f64>; 3],
    support: Support,
}

impl BodyForce {
    /// A force at `r` that turns with the axes `e`, which start along `start`.
    #[must_use]
    pub fn new(
        r: Interpolation,
        e: [Interpolation; 3],
        start: [Vector3<f64>; 3],
        support: Support,
    ) -> Self {
        Self { r, e, start, support }
    }
}

impl Load for BodyForce {
    fn add_force(
        &self,
        _now: signal::Moment<'_>,
        value: [f64; 3],
        q: &[f64],
        factor: f64,
        force: &mut [f64],
    ) {
        for (e, start) in self.e.iter().zip(&self.start) {
            let f = vector(e.at(q)) * (factor * start.dot(&vector(value)));
            self.r.add_force(f.into(), force);
        }
    }

    fn supports(&self) -> &[Support] {
        std::slice::from_ref(&self.support)
    }

    fn jacobian(&self, _part: usize, value: [f64; 3], _q: &[f64], factor: f64, out: &mut [f64]) {
        out.fill(0.0);
        for (e, start) in self.e.iter().zip(&self.start) {
            let k = Matrix3::from_diagonal_element(factor * start.dot(&vector(value)));
            add_outer(&self.support, &self.r, e, &k, out);
        }
    }
}

/// The Jacobian of a force at `r` that depends on `t` by the matrix `k`.
pub(super) fn add_outer(
    support: &Support,
    r: &Interpolation,
    t: &Interpolation,
    k: &Matrix3<f64>,
    out: &mut [f64],
) {
    let (r, t) = (support.localize(r), support.localize(t));
    crate::forces::add_outer(&r, &t, k, support.unknowns.len(), out);
}
