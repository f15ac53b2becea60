//! Joints: constraints `phi(q, t) = 0` between material points. One file a joint; this is their registry.

pub mod clamp;
pub mod pin;

use crate::point::Support;

/// One joint. Coordinates reach it as its local vector `x`, the unknowns of its [`Support`].
pub trait Joint: Send + Sync {
    /// Number of equations m.
    fn equations(&self) -> usize;

    /// The coordinates it acts on.
    fn support(&self) -> &Support;

    /// Typical size of each equation's residual, given the size of the model [m].
    fn scale(&self, length: f64, out: &mut [f64]);

    /// `phi`, (m,).
    fn residual(&self, t: f64, x: &[f64], phi: &mut [f64]);

    /// `phi_q`, (m, local unknowns) row by row, overwritten.
    fn jacobian(&self, t: f64, x: &[f64], out: &mut [f64]);

    /// Adds `stiffness (phi_q^T lambda_)_q`, row by row.
    fn add_hessian(&self, t: f64, x: &[f64], lambda_: &[f64], stiffness: f64, out: &mut [f64]) {
        let _ = (t, x, lambda_, stiffness, out);
    }

    /// `(phi_q v)_q v + 2 phi_qt v + phi_tt`, (m,), overwritten.
    fn acceleration(&self, t: f64, x: &[f64], v: &[f64], out: &mut [f64]) {
        let _ = (t, x, v);
        out.fill(0.0);
    }

    /// The third time derivative of phi at zero jerk, (m,), overwritten.
    fn jerk(&self, t: f64, x: &[f64], v: &[f64], a: &[f64], out: &mut [f64]) {
        let _ = (t, x, v, a);
        out.fill(0.0);
    }

    /// `phi_t`, (m,), overwritten.
    fn rate(&self, t: f64, x: &[f64], out: &mut [f64]) {
        let _ = (t, x);
        out.fill(0.0);
    }

    /// Force [N] and moment [N m] that the joint exerts on its first body, about the joint's point.
    fn reaction(&self, t: f64, x: &[f64], lambda_: &[f64]) -> ([f64; 3], [f64; 3]);
}
