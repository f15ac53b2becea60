//! Loads: generalized forces from values over time. One file a load; this is their registry.

pub mod force;
pub mod line;
pub mod moment;
pub mod moving;

use crate::point::Support;
use crate::signal::Moment;

/// One load. `value` is its signal at the time of evaluation.
pub trait Load: Send + Sync {
    /// Adds `factor` times the generalized force at coordinates `q` to `force`.
    fn add_force(
        &self,
        now: Moment<'_>,
        value: [f64; 3],
        q: &[f64],
        factor: f64,
        force: &mut [f64],
    );

    /// The coordinates its stiffness couples; none for dead loads.
    fn support(&self) -> Option<&Support> {
        None
    }

    /// `out = factor * d(generalized force)/dq` over the support, row by row, overwritten.
    fn jacobian(&self, value: [f64; 3], q: &[f64], factor: f64, out: &mut [f64]) {
        let _ = (value, q, factor);
        out.fill(0.0);
    }
}
