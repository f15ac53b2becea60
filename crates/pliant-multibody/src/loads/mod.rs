//! Loads: generalized forces from values over time. One file a load; this is their registry.

pub mod edge_moment;
pub mod force;
pub mod line;
pub mod moment;
pub mod moving;
pub mod pressure;
pub mod section;

use crate::point::Support;
use crate::signal::Moment;
use pliant_dae::structure::Storage;

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

    /// The coordinates that the parts of its stiffness couple; none for dead loads.
    fn supports(&self) -> &[Support] {
        &[]
    }

    /// How these parts are stored: symmetric where only their sum's symmetric part counts.
    fn storage(&self) -> Storage {
        Storage::Full
    }

    /// Whether the load derives from a potential.
    fn has_potential(&self) -> bool {
        self.supports().is_empty()
    }

    /// `out = factor * d(generalized force)/dq`, part `part` over its support, row by row, overwritten.
    fn jacobian(&self, part: usize, value: [f64; 3], q: &[f64], factor: f64, out: &mut [f64]) {
        let _ = (part, value, q, factor);
        out.fill(0.0);
    }

    /// The first time after `t` at which a value over time beside its own one has a kink.
    fn next_break(&self, t: f64) -> Option<f64> {
        let _ = t;
        None
    }
}
