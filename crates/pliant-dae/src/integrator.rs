//! The face of the time integration: start, continuation, and nominal steps that survive failing ones.

use crate::coefficients::Coefficients;
use crate::error::{Error, check_length};
use crate::initial::{Consistent, consistent_start};
use crate::linear_solver::LinearSolver;
use crate::newton::{Monitor, NewtonOptions};
use crate::problem::Problem;
use crate::redundancy::project_positions;
use crate::scaling::inverse;
use crate::state::State;
use crate::statistics::Statistics;
use crate::step_change::Saved;

/// Controls of the time integration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// Spectral radius at infinite frequency, in [0, 1] (at most 0.98 with constraints).
    pub spectral_radius: f64,
    /// Newton's iteration.
    pub newton: NewtonOptions,
    /// Whether [`Integrator::advance`] repeats failed steps with smaller ones.
    pub retry: bool,
    /// Whether times by part are measured.
    pub timed: bool,
}

impl Default for Options {
    fn default() -> Self {
        Self { spectral_radius: 0.8, newton: NewtonOptions::default(), retry: true, timed: false }
    }
}

/// What a step took.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct StepReport {
    /// Newton iterations.
    pub iterations: usize,
    /// Factorisations of the iteration matrix.
    pub factorizations: usize,
    /// Steps taken, more than one where a failed step was repeated in parts.
    pub steps: usize,
}

/// Sub-steps of a nominal step are multiples of its 1024th part.
const TICKS: u32 = 1024;
/// Successful sub-steps before their size is doubled again.
const SUCCESSES_TO_GROW: u32 = 4;

/// Integrates a problem step by step.
pub struct Integrator<P> {
    pub(crate) problem: P,
    pub(crate) solver: Box<dyn LinearSolver>,
    pub(crate) options: Options,
    pub(crate) coefficients: Coefficients,
    pub(crate) state: State,
    pub(crate) statistics: Statistics,
    pub(crate) work: Workspace,
}

/// Scratch memory; nothing here outlives a step.
pub(crate) struct Workspace {
    /// The state aimed at.
    pub(crate) next: State,
    /// Increment of positions since the start of the step (used unless the problem is flat).
    pub(crate) delta: Vec<f64>,
    /// Residual, then increments of the unknowns.
    pub(crate) x: Vec<f64>,
    /// Increment of the unknowns that may be shortened.
    pub(crate) direction: Vec<f64>,
    /// Element values of the iteration matrix.
    pub(crate) values: Vec<f64>,
    pub(crate) inverse_scale: Vec<f64>,
    pub(crate) inverse_constraint_scale: Vec<f64>,
    pub(crate) zero: Vec<f64>,
    pub(crate) monitor: Monitor,
    pub(crate) saved: Saved,
    /// Part of the nominal step that is tried; 0 outside of nominal steps.
    pub(crate) part: f64,
    /// Accelerations perturbed for the error estimate.
    pub(crate) perturbed: Vec<f64>,
    /// Error of the last controlled step, in units of the tolerance.
    pub(crate) error: f64,
    pub(crate) inverse_error_scale: Vec<f64>,
}

impl<P: Problem> Integrator<P> {
    /// Starts at positions `q` and velocities `v` (projected onto the constraints, see [`Consistent`]).
    ///
    /// # Errors
    /// Invalid options or initial values, see [`Coefficients::new`] and [`consistent_start`].
    pub fn new(
        mut problem: P,
        mut solver: Box<dyn LinearSolver>,
        options: Options,
        t: f64,
        q: &[f64],
        v: &[f64],
    ) -> Result<(Self, Consistent), Error> {
        check_options(&problem, &options)?;
        if !t.is_finite() {
            return Err(Error::Value { what: "the initial time", expected: "finite", got: t });
        }
        let start = consistent_start(&mut problem, solver.as_mut(), t, q, v)?;
        let state = State {
            t,
            q: q.to_vec(),
            v: start.v.clone(),
            a: start.a.clone(),
            a_alg: start.a.clone(),
            a_previous: start.a.clone(),
            lambda_: start.lambda_.clone(),
            ..State::default()
        };
        Ok((Self::resume(problem, solver, options, state)?, start))
    }

    /// Continues from a state, with the same bits as if the run had never stopped.
    ///
    /// # Errors
    /// Invalid options, wrong lengths, or a factorisation that fails.
    pub fn resume(
        problem: P,
        solver: Box<dyn LinearSolver>,
        options: Options,
        state: State,
    ) -> Result<Self, Error> {
        let coefficients = check_options(&problem, &options)?;
        let (n, m) = (problem.velocities(), problem.multipliers());
        check_state(&problem, &state)?;
        let work = Workspace {
            next: state.clone(),
            delta: vec![0.0; if problem.is_flat() { 0 } else { n }],
            x: vec![0.0; n + m],
            direction: Vec::new(),
            values: vec![0.0; problem.structure().values()],
            inverse_scale: inverse(problem.scale()),
            inverse_constraint_scale: inverse(problem.constraint_scale()),
            monitor: Monitor::with_capacity(options.newton.max_iterations),
            saved: Saved::default(),
            part: 0.0,
            perturbed: Vec::new(),
            error: 0.0,
            inverse_error_scale: inverse(&problem.error_scale()),
            zero: vec![0.0; n.max(m)],
        };
        let statistics = Statistics::default();
        let mut new = Self { problem, solver, options, coefficients, state, statistics, work };
        new.rebuild_factor()?;
        Ok(new)
    }

    /// Goes to another state of the same problem, with the same bits as if the run had been there all along.
    ///
    /// # Errors
    /// Wrong lengths (nothing has changed then), or a factorisation that fails.
    pub fn reset(&mut self, state: State) -> Result<(), Error> {
        check_state(&self.problem, &state)?;
        self.state = state;
        self.rebuild_factor()
    }

    /// The problem.
    pub fn problem(&self) -> &P {
        &self.problem
    }

    /// The problem, to change what is not part of its structure.
    pub fn problem_mut(&mut self) -> &mut P {
        &mut self.problem
    }

    /// The state reached.
    pub fn state(&self) -> &State {
        &self.state
    }

    /// Coefficients of the scheme.
    pub fn coefficients(&self) -> &Coefficients {
        &self.coefficients
    }

    /// Cost so far.
    pub fn statistics(&self) -> &Statistics {
        &self.statistics
    }

    /// Continues counting from these numbers.
    pub fn set_statistics(&mut self, statistics: Statistics) {
        self.statistics = statistics;
    }

    /// The linear solver.
    pub fn solver(&self) -> &dyn LinearSolver {
        self.solver.as_ref()
    }

    /// Gives back the problem, the solver and the state.
    pub fn into_parts(self) -> (P, Box<dyn LinearSolver>, State) {
        (self.problem, self.solver, self.state)
    }

    /// Takes out of the velocities what the scheme adds to them for the sake of its step, normal to the constraints:
    /// to be called before an event changes those. [`Self::restart`] must follow.
    ///
    /// # Errors
    /// A singular mass matrix.
    pub fn settle(&mut self) -> Result<(), Error> {
        let h = self.state.h;
        if h > 0.0 {
            let factor = -h * h * self.coefficients.error_constant();
            let dv = self.normal_velocity_correction(factor)?;
            for (v, d) in self.state.v.iter_mut().zip(&dv) {
                *v += d;
            }
            self.state.h = 0.0;
            self.state.factor.h = 0.0;
        }
        Ok(())
    }

    /// Moves positions onto constraints that were left out and are not met any more, and restarts there.
    ///
    /// # Errors
    /// Contradictory constraints, and as [`Self::restart`].
    pub fn restart_on_constraints(&mut self) -> Result<Consistent, Error> {
        self.settle()?;
        let tolerance = self.options.newton.constraint_tolerance;
        let Self { problem, solver, state, .. } = self;
        project_positions(problem, solver.as_mut(), state.t, &mut state.q, tolerance)?;
        self.restart()
    }

    /// Forgets the kept factorisation, and prepares velocities and accelerations anew for the next step: to be
    /// called after an event changed the problem (a joint released, say). Velocities are projected.
    ///
    /// # Errors
    /// As [`consistent_start`].
    pub fn restart(&mut self) -> Result<Consistent, Error> {
        let state = &mut self.state;
        let start =
            consistent_start(&mut self.problem, self.solver.as_mut(), state.t, &state.q, &state.v)?;
        state.v.clone_from(&start.v);
        state.a.clone_from(&start.a);
        state.a_alg.clone_from(&start.a);
        state.a_previous.clone_from(&start.a);
        state.lambda_.clone_from(&start.lambda_);
        state.h = 0.0;
        state.factor.h = 0.0;
        state.control.forget();
        Ok(start)
    }

    /// The end of the next nominal step.
    pub fn nominal_end(&mut self, h: f64) -> f64 {
        self.begin_series(h);
        self.state.series_start + (self.state.series_steps as f64 + 1.0) * h
    }

    /// Goes to the time `t` within the present nominal step, or to the end of it where it `completes` the step; the
    /// series of nominal times goes on.
    ///
    /// # Errors
    /// As [`Self::advance`].
    pub fn advance_part(&mut self, t: f64, completes: bool) -> Result<StepReport, Error> {
        let state = &self.state;
        let (start, step, steps) = (state.series_start, state.series_step, state.series_steps);
        let mut h = t - state.t;
        if (h - step).abs() <= 1e-12 * step {
            // A step of the same length needs no preparation.
            h = step;
        }
        let report = self.advance_to(Some(t), h)?;
        let state = &mut self.state;
        (state.series_start, state.series_step) = (start, step);
        state.series_steps = steps + u64::from(completes);
        Ok(report)
    }

    fn begin_series(&mut self, h: f64) {
        if self.state.series_step != h {
            self.state.series_start = self.state.t;
            self.state.series_step = h;
            self.state.series_steps = 0;
        }
    }

    /// Advances by the nominal step `h`, in smaller ones where it fails (halved down to `h/1024`, doubled again
    /// after successes). Equal nominal steps land on `start + n h` without accumulated rounding.
    ///
    /// # Errors
    /// The last failure; the state is then the last one reached.
    pub fn advance(&mut self, h: f64) -> Result<StepReport, Error> {
        self.advance_to(None, h)
    }

    /// Like [`Self::advance`]; ends at exactly the time `end` where it is given, `h` away up to rounding.
    ///
    /// # Errors
    /// As [`Self::advance`].
    pub fn advance_to(&mut self, end: Option<f64>, h: f64) -> Result<StepReport, Error> {
        check_step(h)?;
        self.begin_series(h);
        let n = self.state.series_steps;
        let time = |steps: f64| self.state.series_start + steps * h;
        let begin = time(n as f64);
        let lands = end.is_some();
        let end = end.unwrap_or_else(|| time((n + 1) as f64));
        let (mut done, mut size, mut successes) = (0, TICKS, 0);
        let mut total = StepReport::default();
        while done < TICKS {
            let part = f64::from(size) / f64::from(TICKS);
            let t = if done + size == TICKS {
                end
            } else {
                begin + h * (f64::from(done + size) / f64::from(TICKS))
            };
            self.work.part = part;
            let outcome = self.step_to(t, h * part);
            self.work.part = 0.0;
            match outcome {
                Ok(report) => {
                    done += size;
                    total.iterations += report.iterations;
                    total.factorizations += report.factorizations;
                    total.steps += 1;
                    successes += 1;
                    if successes >= SUCCESSES_TO_GROW && done % (2 * size) == 0 {
                        size *= 2;
                        successes = 0;
                    }
                }
                Err(error) => {
                    if !self.options.retry || !error.is_recoverable() || size == 1 {
                        self.state.series_step = 0.0;
                        return Err(error);
                    }
                    self.statistics.rejected += 1;
                    size /= 2;
                    successes = 0;
                }
            }
        }
        self.state.series_steps = n + 1;
        if lands {
            // Further steps count from the time that was asked for.
            self.state.series_step = 0.0;
        }
        Ok(total)
    }

    /// One step of length `h` [s]; on failure the state is unchanged.
    ///
    /// # Errors
    /// No convergence, numbers that are not finite, a singular matrix, or a failing evaluation.
    pub fn step(&mut self, h: f64) -> Result<StepReport, Error> {
        check_step(h)?;
        self.state.series_step = 0.0;
        self.step_to(self.state.t + h, h)
    }
}

fn check_options<P: Problem>(problem: &P, options: &Options) -> Result<Coefficients, Error> {
    let newton = &options.newton;
    for (what, value) in [
        ("newton.tolerance", newton.tolerance),
        ("newton.constraint_tolerance", newton.constraint_tolerance),
        ("newton.reduction", newton.reduction),
    ] {
        if !(value > 0.0 && value < 1.0) {
            return Err(Error::Value { what, expected: "between 0 and 1", got: value });
        }
    }
    if newton.max_iterations < 2 {
        let got = newton.max_iterations as f64;
        return Err(Error::Value { what: "newton.max_iterations", expected: "at least 2", got });
    }
    Coefficients::new(options.spectral_radius, problem.multipliers() > 0)
}

fn check_state<P: Problem>(problem: &P, state: &State) -> Result<(), Error> {
    let (n, m) = (problem.velocities(), problem.multipliers());
    check_length("q", &state.q, problem.coordinates())?;
    for (what, array) in [
        ("v", &state.v),
        ("a", &state.a),
        ("a_alg", &state.a_alg),
        ("a_previous", &state.a_previous),
    ] {
        check_length(what, array, n)?;
    }
    check_length("lambda_", &state.lambda_, m)?;
    let factor = &state.factor;
    if factor.h == 0.0 {
        return Ok(());
    }
    check_length("factor.q", &factor.q, problem.coordinates())?;
    check_length("factor.v", &factor.v, n)?;
    check_length("factor.a", &factor.a, n)?;
    check_length("factor.lambda_", &factor.lambda_, m)
}

fn check_step(h: f64) -> Result<(), Error> {
    if h > 0.0 && h.is_finite() {
        Ok(())
    } else {
        Err(Error::Value { what: "the step", expected: "positive and finite", got: h })
    }
}
