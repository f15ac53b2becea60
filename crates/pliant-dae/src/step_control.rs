//! Steps as long as an error tolerance allows.
//!
//! The local error of positions is `c h^3 j`, c the scheme's error constant and j the jerk; with the change of the
//! algorithmic accelerations, `A1 - A = h j`, it is `|c| h^2 |A1 - A|`. Modes far too fast for the step dominate that
//! difference and mean nothing: their amplitude is what errs, not their acceleration. So the difference is passed
//! through the iteration matrix, `S x + phi_q^T mu = m M (A1 - A)`, which leaves what the step resolves and divides
//! the rest by `(h omega)^2` (the filter of Shampine 1982 for stiff problems). Normal to the constraints, `phi_q x` is
//! h times the kinematic jerk: positions on the constraints do not show that part, velocities and multipliers
//! do, and a step that disregards it ruins them where the motion turns. The price is a residual and a solution a step.
//!
//! A change of step costs two factorisations and the corrections of [`crate::step_change`]; the controller
//! therefore keeps the step while that is nearly as good, and divides the time to the next stop evenly, so that stops
//! are met exactly without steps of odd lengths. With tolerance tol steps are `~ tol^(1/3)`, errors `~ tol^(2/3)`.

use serde::{Deserialize, Serialize};

use crate::error::{Accuracy, Error};
use crate::integrator::{Integrator, StepReport};
use crate::problem::{Point, Problem};
use crate::scaling::{first_not_finite, weighted_max, worst};

/// What adaptive steps must keep to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepControl {
    /// Largest local error of any coordinate in a step, in units of its error scale.
    pub tolerance: f64,
    /// Largest step [s].
    pub max_step: f64,
    /// First step [s]; none: chosen from velocities and accelerations.
    pub first_step: Option<f64>,
}

/// What the controller remembers from step to step.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Controller {
    /// Step that the accuracy asks for [s]; 0 before the first.
    wanted: f64,
    /// Error of the last accepted step in units of the tolerance; 0 where there is none to compare with.
    error: f64,
    /// Time up to which equal steps are planned [s].
    stop: f64,
    /// Steps left to there.
    left: u64,
    /// The planned step [s].
    h: f64,
}

impl Controller {
    /// The next step, from nothing but the tolerance: to be called after an event.
    pub(crate) fn forget(&mut self) {
        *self = Self::default();
    }
}

/// Part of the tolerance aimed at.
const SAFETY: f64 = 0.9;
/// Range of the change of a step.
const SHRINK: f64 = 0.2;
const GROW: f64 = 2.0;
/// A longer step must be longer by this to be worth its change.
const WORTHWHILE: f64 = 1.3;
/// A planned step may exceed the wanted one by this.
const SLACK: f64 = 1.05;
/// Reduction after Newton's method failed.
const FAILED: f64 = 0.25;
/// Rejections in a row before the step is given up.
const REJECTIONS: usize = 30;
/// Smallest step, relative to the time reached and to the largest step.
const SMALLEST: f64 = 1e-14;

impl<P: Problem> Integrator<P> {
    /// One step of a length that keeps to the tolerance, never past the time `stop` (infinite: none); rejected steps
    /// are repeated with shorter ones.
    ///
    /// # Errors
    /// [`Error::Accuracy`] where no step is short enough, or the last failure of Newton's method.
    pub fn advance_within(
        &mut self,
        stop: f64,
        control: &StepControl,
    ) -> Result<StepReport, Error> {
        check(control, self.state.t, stop)?;
        self.state.series_step = 0.0;
        if self.state.control.wanted == 0.0 {
            self.state.control.wanted = self.first_step(stop, control);
        }
        let plan = self.state.control;
        if plan.left == 0 || plan.stop != stop || plan.h > control.max_step {
            self.plan(stop, control, false);
        }
        for _ in 0..REJECTIONS {
            let h = self.state.control.h;
            let t = if self.state.control.left == 1 { stop } else { self.state.t + h };
            if h < SMALLEST * self.state.t.abs() || t <= self.state.t {
                break;
            }
            match self.attempt(t, h, Some(control.tolerance)) {
                Ok(report) => {
                    self.adapt(h, stop, control);
                    return Ok(report);
                }
                Err(error @ Error::Accuracy(_)) => {
                    let Error::Accuracy(ref what) = error else { return Err(error) };
                    let factor = (SAFETY * what.estimate.powf(-1.0 / 3.0)).clamp(SHRINK, 0.8);
                    self.reject(h * factor, stop, control, error)?;
                }
                Err(error) if error.is_recoverable() => {
                    self.reject(h * FAILED, stop, control, error)?;
                }
                Err(error) => return Err(error),
            }
        }
        // Once more, for its error.
        let h = self.state.control.h;
        match self.attempt(self.state.t + h, h, Some(control.tolerance)) {
            Err(error) => Err(error),
            Ok(report) => {
                self.adapt(h, stop, control);
                self.state.control.left = 0;
                Ok(report)
            }
        }
    }

    fn reject(
        &mut self,
        shorter: f64,
        stop: f64,
        control: &StepControl,
        error: Error,
    ) -> Result<(), Error> {
        self.statistics.rejected += 1;
        let smallest = SMALLEST * self.state.t.abs().max(control.max_step.min(1.0));
        if shorter < smallest {
            return Err(error);
        }
        self.state.control.wanted = shorter;
        self.state.control.error = 0.0;
        self.plan(stop, control, true);
        Ok(())
    }

    /// Divides the time to the stop into equal steps, of the present length where that serves.
    fn plan(&mut self, stop: f64, control: &StepControl, must_change: bool) {
        let state = &mut self.state;
        let wanted = state.control.wanted.min(control.max_step);
        let now = state.h;
        let serves = !must_change
            && now > 0.0
            && now <= (SLACK * wanted).min(control.max_step)
            && now * WORTHWHILE >= wanted;
        let preferred = if serves { now } else { wanted };
        let (h, left) = if stop.is_finite() {
            let rest = stop - state.t;
            let slack = if serves { 1e-9 } else { SLACK - 1.0 };
            let least = rest / control.max_step * (1.0 - 1e-12);
            let steps = (rest / preferred * (1.0 - slack)).max(least).ceil().max(1.0);
            (rest / steps, steps as u64)
        } else {
            (preferred, u64::MAX)
        };
        // Lengths that differ by the rounding of times are the same: changes cost.
        let rounding =
            16.0 * f64::EPSILON * state.t.abs().max(if stop.is_finite() { stop } else { 0.0 });
        let h = if (h - now).abs() <= rounding { now } else { h };
        state.control = Controller { h, left, stop, ..state.control };
    }

    /// After an accepted step: what the next one should be.
    fn adapt(&mut self, h: f64, stop: f64, control: &StepControl) {
        let error = self.work.error.max(1e-9);
        let memory = &mut self.state.control;
        memory.left -= 1;
        let growth = if memory.error > 0.0 { (error / memory.error).clamp(1.0, 2.0) } else { 1.0 };
        let best = h * SAFETY * (error * growth).powf(-1.0 / 3.0);
        // Less than a step cut short by a stop asks for says nothing of what was wanted before.
        memory.wanted = best.clamp(SHRINK * h, (GROW * h).max(memory.wanted)).min(control.max_step);
        memory.error = error;
        let expects_rejection = error * growth > 1.0;
        let worthwhile = memory.wanted >= WORTHWHILE * h;
        if memory.left > 0 && (expects_rejection || worthwhile) {
            let before = self.state.control;
            self.plan(stop, control, expects_rejection);
            let ratio = self.state.control.h / h;
            if !expects_rejection && ratio < WORTHWHILE {
                let wanted = self.state.control.wanted;
                self.state.control = Controller { wanted, ..before };
            }
        }
    }

    /// The estimated local error of the step just solved, in units of the tolerance, before it is accepted.
    pub(crate) fn estimate(&mut self, h: f64, tolerance: f64) -> Result<(), Error> {
        let c = self.coefficients;
        let n = self.state.v.len();
        let inverse = 1.0 / (1.0 - c.alpha_m);
        let Self { problem, state, work, solver, statistics, .. } = self;
        work.perturbed.resize(n, 0.0);
        for i in 0..n {
            let a_alg = inverse
                * ((1.0 - c.alpha_f) * work.next.a[i] + c.alpha_f * state.a[i]
                    - c.alpha_m * state.a_alg[i]);
            work.perturbed[i] = work.next.a[i] + (a_alg - state.a_alg[i]);
        }
        // The residual vanishes at the accelerations found: what is left at the perturbed ones is M (A1 - A).
        let t = work.next.t;
        let (force, phi) = work.x.split_at_mut(n);
        let at = Point { a: &work.perturbed, ..work.next.point() };
        statistics.residuals += 1;
        problem.residual(at, force, phi).map_err(|source| Error::Evaluation { t, source })?;
        let mass = c.weights(h).mass;
        force.iter_mut().for_each(|f| *f *= mass);
        problem.constraint_jerk(work.next.point(), phi);
        phi.iter_mut().for_each(|p| *p *= -h);
        solver.solve(&mut work.x);
        if let Some(unknown) = first_not_finite(&work.x) {
            return Err(Error::Singular { t, unknown, name: problem.describe(unknown) });
        }
        let factor = c.error_constant().abs() * h * h / tolerance;
        let weight = &work.inverse_error_scale;
        work.error = factor * weighted_max(&work.x[..n], weight);
        if work.error > 1.0 {
            let unknown = worst(&work.x[..n], weight);
            return Err(Error::Accuracy(Box::new(Accuracy {
                t,
                h,
                estimate: work.error,
                unknown,
                name: problem.describe(unknown),
            })));
        }
        Ok(())
    }

    /// A first step from the size of velocities and accelerations, as if the jerk were `|a|^(3/2)`, half for safety.
    fn first_step(&self, stop: f64, control: &StepControl) -> f64 {
        let longest = control.max_step.min(stop - self.state.t).min(1.0);
        if let Some(first) = control.first_step {
            return first.min(control.max_step);
        }
        let size = |x: &[f64]| weighted_max(x, &self.work.inverse_error_scale);
        let (v, a) = (size(&self.state.v), size(&self.state.a));
        let root = (control.tolerance / self.coefficients.error_constant().abs()).cbrt();
        let rate = a.sqrt().max(v);
        if rate > 0.0 { (0.5 * root / rate).min(longest) } else { 1e-3 * longest }
    }
}

fn check(control: &StepControl, t: f64, stop: f64) -> Result<(), Error> {
    let refuse = |what, expected, got| Err(Error::Value { what, expected, got });
    if !(control.tolerance > 0.0 && control.tolerance < 1.0) {
        return refuse("the tolerance of a step", "between 0 and 1", control.tolerance);
    }
    if control.max_step.is_nan() || control.max_step <= 0.0 {
        return refuse("the largest step", "positive", control.max_step);
    }
    if let Some(first) = control.first_step.filter(|h| !(*h > 0.0 && h.is_finite())) {
        return refuse("the first step", "positive and finite", first);
    }
    if stop.is_nan() || stop <= t {
        return refuse("the time of the next stop", "after the present time", stop);
    }
    Ok(())
}
