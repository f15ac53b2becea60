//! When Newton's iteration has converged, and when its matrix is worth factorising anew.

use serde::{Deserialize, Serialize};

/// Controls of Newton's iteration inside a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NewtonOptions {
    /// Bound of the remaining error of an increment, in units of the problem's scale.
    pub tolerance: f64,
    /// Bound of the constraints' residuals, in units of their scale.
    pub constraint_tolerance: f64,
    /// Part of a step's first increment and constraint residual that may be left over, where that is less than the
    /// tolerances. Multipliers amplify it; 1e-4 will do without constraints.
    pub reduction: f64,
    /// Iterations after which a step has failed.
    pub max_iterations: usize,
}

impl Default for NewtonOptions {
    fn default() -> Self {
        Self { tolerance: 1e-10, constraint_tolerance: 1e-10, reduction: 1e-6, max_iterations: 40 }
    }
}

/// What to do after an iteration.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Verdict {
    /// Stop: the remaining error is below the tolerance.
    Converged,
    /// Iterate with the same matrix.
    Continue,
    /// Iterate with a matrix factorised here.
    Refactor,
    /// The contraction is lost although increments are small: perhaps they are rounding noise.
    Stalled,
    /// Give up.
    Failed,
}

/// Contraction above which the matrix is renewed inside a step. Larger values make long chains take tens of
/// iterations now and then.
const SLOW: f64 = 0.5;
/// Iterations that a new matrix takes.
const FEW: f64 = 2.0;
/// Successive increments without contraction after which a step has failed.
const MAX_GROWTHS: usize = 4;
/// Increments (in units of the scale) beyond any sense.
const ABSURD: f64 = 1e8;

/// Watches the increments of one step.
///
/// The contraction is measured in this step only: a first iteration accepted on a rate inherited from earlier
/// steps leaves stiff errors that are small in positions, large in forces, and add up.
#[derive(Clone, Debug, Default)]
pub(crate) struct Monitor {
    /// Sizes of the increments so far.
    pub(crate) increments: Vec<f64>,
    first_phi: f64,
    growths: usize,
}

impl Monitor {
    pub(crate) fn with_capacity(iterations: usize) -> Self {
        Self { increments: Vec::with_capacity(iterations), ..Self::default() }
    }

    /// Begins a step.
    pub(crate) fn reset(&mut self) {
        self.increments.clear();
        self.growths = 0;
    }

    /// Judges an iteration by the size of its increment and of the constraint residual that it answers; `floor` is
    /// the size of rounding errors of both, `cost` that of a factorisation in iterations.
    pub(crate) fn judge(
        &mut self,
        size: f64,
        phi: f64,
        (floor, cost): (f64, f64),
        options: &NewtonOptions,
    ) -> Verdict {
        let previous = self.increments.last().copied();
        self.increments.push(size);
        if previous.is_none() {
            self.first_phi = phi;
        }
        let phi_target =
            options.constraint_tolerance.min(options.reduction * self.first_phi).max(floor);
        let settled = phi <= phi_target;
        let target = self.target(floor, options);
        if settled && (size <= floor || previous.is_some() && size <= 0.01 * target) {
            return Verdict::Converged;
        }
        let theta = previous.map_or(0.0, |p| size / p);
        if previous.is_some() && theta < 1.0 {
            // The errors left over are geometric series of what this iteration has corrected.
            let rest = theta / (1.0 - theta);
            if rest * size <= target && rest * phi <= phi_target {
                return Verdict::Converged;
            }
        }
        let mut dear = false;
        if previous.is_some() && theta < 1.0 {
            // Iterations to come at this rate, against a new matrix and the few that it takes.
            let to_come = (target * (1.0 - theta) / (theta * size)).ln() / theta.ln();
            dear = to_come > cost + FEW;
        }
        self.growths = if theta >= 1.0 { self.growths + 1 } else { 0 };
        let slow = theta > SLOW;
        let exhausted = self.increments.len() >= options.max_iterations;
        if slow && (size <= 100.0 * target || exhausted) {
            return Verdict::Stalled;
        }
        if exhausted || self.growths >= MAX_GROWTHS || size.is_nan() || size > ABSURD {
            return Verdict::Failed;
        }
        if slow || dear { Verdict::Refactor } else { Verdict::Continue }
    }

    /// Error to be reached: the tolerance, but never more than a small part of the first increment, which
    /// measures the acceleration's change within the step. Errors of increments enter accelerations divided by
    /// `beta h^2`: with a fixed bound they would outgrow those of the scheme as the step is refined.
    fn target(&self, floor: f64, options: &NewtonOptions) -> f64 {
        let first = self.increments.first().copied().unwrap_or(f64::INFINITY);
        options.tolerance.min(options.reduction * first).max(floor)
    }

    /// What to do after an increment that was shortened to a part: its size says nothing about convergence.
    pub(crate) fn after_shortening(&mut self, part: f64, options: &NewtonOptions) -> Verdict {
        self.growths = 0;
        if let Some(last) = self.increments.last_mut() {
            *last *= part;
        }
        if self.increments.len() >= options.max_iterations {
            Verdict::Failed
        } else {
            Verdict::Refactor
        }
    }

    /// What to do when a stall was not rounding noise.
    pub(crate) fn after_stall(&self, floor: f64, options: &NewtonOptions) -> Verdict {
        let exhausted = self.increments.len() >= options.max_iterations;
        if exhausted || self.growths >= MAX_GROWTHS {
            Verdict::Failed
        } else if self
            .increments
            .last()
            .is_some_and(|&size| size > 10.0 * self.target(floor, options))
        {
            Verdict::Refactor
        } else {
            Verdict::Continue
        }
    }
}

/// Decides between steps whether to keep a factorisation.
///
/// It is renewed when the last step took more iterations than the mean cost of a step since it was made, its own cost
/// included. Where contraction was lost so far that it had to be renewed inside a step, iterations were thrown away:
/// from then on it is renewed before it gets as old, and allowed to grow older again bit by bit.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct FactorAge {
    /// Steps accepted since the factorisation.
    pub steps: usize,
    /// Iterations since the factorisation.
    pub iterations: usize,
    /// Iterations of the last accepted step.
    pub last: usize,
    /// Number of steps for which it may serve.
    pub limit: f64,
}

/// Growth of the limit with each renewal between steps.
const LIMIT_GROWTH: f64 = 1.1;

impl Default for FactorAge {
    fn default() -> Self {
        Self { steps: 0, iterations: 0, last: 0, limit: f64::INFINITY }
    }
}

impl FactorAge {
    /// Whether renewing pays; `cost` is that of a factorisation in iterations.
    #[must_use]
    pub fn is_worn(&self, cost: f64) -> bool {
        let steps = self.steps as f64;
        self.steps > 0
            && (steps + 1.0 > self.limit
                || self.last as f64 * steps > cost + self.iterations as f64)
    }

    /// The age of a factorisation that replaces this one, between steps or `inside` one.
    pub(crate) fn renewed(&self, inside: bool) -> Self {
        let limit =
            if inside && self.steps > 0 { self.steps as f64 } else { self.limit * LIMIT_GROWTH };
        Self { limit, ..Self::default() }
    }
}
