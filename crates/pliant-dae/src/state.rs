//! What a run consists of at one moment.

use crate::newton::FactorAge;
use crate::problem::Point;
use crate::step_control::Controller;
use serde::{Deserialize, Serialize};

/// What the kept factorisation was made from; a continued run rebuilds it.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct FactorPoint {
    /// Step it belongs to [s]; 0 if there is none.
    pub h: f64,
    /// Time [s].
    pub t: f64,
    /// Coordinates.
    pub q: Vec<f64>,
    /// Velocities.
    pub v: Vec<f64>,
    /// Accelerations.
    pub a: Vec<f64>,
    /// Multipliers.
    pub lambda_: Vec<f64>,
    /// Rounding errors of the coordinates there, in units of the scale.
    pub floor: f64,
    /// How much it has been used.
    pub age: FactorAge,
}

/// Everything that a bit-identical continuation needs.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct State {
    /// Time [s].
    pub t: f64,
    /// Coordinates, length `coordinates`.
    pub q: Vec<f64>,
    /// Velocities, length `velocities`. They satisfy the constraints up to `h^2`.
    pub v: Vec<f64>,
    /// True accelerations, length `velocities`.
    pub a: Vec<f64>,
    /// Algorithmic accelerations, length `velocities`.
    pub a_alg: Vec<f64>,
    /// True accelerations one step before, length `velocities`.
    pub a_previous: Vec<f64>,
    /// Multipliers, length `multipliers`.
    pub lambda_: Vec<f64>,
    /// Step that `v` and `a_alg` are prepared for [s]; 0 before the first.
    pub h: f64,
    /// Start of the current series of equal nominal steps [s].
    pub series_start: f64,
    /// Nominal step of the series [s].
    pub series_step: f64,
    /// Nominal steps done in the series; times are `series_start + n series_step`, free of accumulated rounding.
    pub series_steps: u64,
    /// Memory of the step control.
    pub control: Controller,
    /// The kept factorisation.
    pub factor: FactorPoint,
}

impl State {
    /// The state as a point of evaluation.
    #[must_use]
    pub fn point(&self) -> Point<'_> {
        Point { t: self.t, q: &self.q, v: &self.v, a: &self.a, lambda_: &self.lambda_ }
    }
}
