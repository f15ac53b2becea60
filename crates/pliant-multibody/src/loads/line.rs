//! A force per stress-free length along a line: `w L (1/2, L/12, 1/2, -L/12)` on each element's (r1, t1, r2, t2).

use super::Load;
use crate::point::Interpolation;
use crate::signal;

/// A force per stress-free length, fixed in space.
#[derive(Clone, Debug)]
pub struct LineLoad {
    /// Its integral as a weighted sum over nodal vectors, lengths as weights [m].
    pub weights: Interpolation,
}

impl Load for LineLoad {
    fn add_force(
        &self,
        _now: signal::Moment<'_>,
        value: [f64; 3],
        _q: &[f64],
        factor: f64,
        force: &mut [f64],
    ) {
        self.weights.add_force(value.map(|f| factor * f), force);
    }
}
