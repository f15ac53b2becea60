//! Counters and times of a run.

use serde::{Deserialize, Serialize};
use std::time::{Duration, Instant};

/// What a run has cost so far.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Statistics {
    /// Accepted steps.
    pub steps: usize,
    /// Steps that failed and were repeated with a smaller one.
    pub rejected: usize,
    /// Newton iterations, those of failed steps included.
    pub newton_iterations: usize,
    /// Factorisations of the iteration matrix or of the mass matrix with constraints.
    pub factorizations: usize,
    /// Evaluations of the residual.
    pub residuals: usize,
    /// Time by part; stays zero unless timing was asked for.
    pub seconds: Seconds,
}

/// Wall time by part [s].
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Seconds {
    /// Evaluation of residuals.
    pub residual: f64,
    /// Evaluation of tangents.
    pub tangent: f64,
    /// Factorisation.
    pub factor: f64,
    /// Forward and backward substitution.
    pub solve: f64,
    /// Prediction, update and acceptance.
    pub other: f64,
}

/// Charges the time since the last lap to a part, if switched on (a reading of the clock costs about 25 ns).
#[derive(Clone, Copy, Debug)]
pub(crate) struct Stopwatch(Option<Instant>);

impl Stopwatch {
    pub(crate) fn start(enabled: bool) -> Self {
        Self(enabled.then(Instant::now))
    }

    #[inline]
    pub(crate) fn lap(&mut self, part: &mut f64) {
        if let Some(last) = &mut self.0 {
            let now = Instant::now();
            *part += now.checked_duration_since(*last).unwrap_or(Duration::ZERO).as_secs_f64();
            *last = now;
        }
    }
}
