//! Coulomb friction made regular by bristles that stick until they carry the full force: `F = f_n (sigma_0 z + sigma_1 v)`
//! while that is at most `mu f_n`, else the force slides at `mu f_n` in its direction (return mapping). It does not
//! creep, and never exceeds the cone.

use super::{Response, Slip};
use nalgebra::Matrix3;

/// Coefficients of the law.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coulomb {
    /// Coefficient of friction.
    pub mu: f64,
    /// Stiffness while sticking, per normal force [1/m].
    pub sigma_0: f64,
    /// Damping while sticking, per normal force [s/m].
    pub sigma_1: f64,
}

impl Coulomb {
    /// The answer to a slip.
    #[must_use]
    pub fn respond(&self, slip: &Slip) -> Response {
        let &Slip { z, mean: v, normal, h, .. } = slip;
        let &Self { mu, sigma_0, sigma_1 } = self;
        let trial = z + v * h;
        let force = trial * sigma_0 + v * sigma_1;
        let by_v = sigma_0 * h + sigma_1;
        let size = force.norm();
        let limit = mu / sigma_0;
        let bent = if trial.norm() > limit { trial * (limit / trial.norm()) } else { trial };
        let (force, slope) = if size > mu {
            let along = force / size;
            let across = Matrix3::identity() - along * along.transpose();
            (along * mu, across * (by_v * mu / size))
        } else {
            (force, Matrix3::from_diagonal_element(by_v))
        };
        let normal = normal.max(0.0);
        Response {
            z: bent,
            force: force * normal,
            by_mean: slope * normal,
            by_end: Matrix3::zeros(),
            by_normal: if normal > 0.0 { force } else { force * 0.0 },
        }
    }
}
