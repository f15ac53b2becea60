//! Generalized-alpha for index-3 differential-algebraic equations, on vector spaces and on Lie groups.
//!
//! ```text
//! q1 = q (+) [h v + h^2 ((1/2 - beta) A + beta A1)]        v1 = v + h ((1 - gamma) A + gamma A1)
//! (1 - alpha_m) A1 + alpha_m A = (1 - alpha_f) a1 + alpha_f a
//! M a1 + f(t1, q1, v1) + phi_q^T lambda1 = 0               phi(t1, q1) = 0
//! ```
//! `a` is the true acceleration, `A` (here `a_alg`) the algorithmic one. Sources: Chung & Hulbert 1993;
//! Arnold & Bruls 2007; Bruls, Cardona & Arnold 2012; scaling by Bottasso, Bauchau & Cardona 2007.

use std::mem::swap;

use crate::coefficients::Coefficients;
use crate::error::{Error, Failure, check_length};
use crate::initial::{Consistent, consistent_start};
use crate::linear_solver::LinearSolver;
use crate::newton::{FactorAge, Monitor, NewtonOptions, Verdict};
use crate::problem::{Point, Problem};
use crate::scaling::{first_not_finite, inverse, largest, magnitude, weighted_max, worst};
use crate::statistics::{Statistics, Stopwatch};
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

/// What the kept factorisation was made from; a continued run rebuilds it.
#[derive(Clone, Debug, Default, PartialEq)]
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
#[derive(Clone, Debug, Default, PartialEq)]
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
    options: Options,
    pub(crate) coefficients: Coefficients,
    pub(crate) state: State,
    pub(crate) statistics: Statistics,
    pub(crate) work: Workspace,
}

/// Scratch memory; nothing here outlives a step.
pub(crate) struct Workspace {
    /// The state aimed at.
    next: State,
    /// Increment of positions since the start of the step (used unless the problem is flat).
    delta: Vec<f64>,
    /// Residual, then increments of the unknowns.
    x: Vec<f64>,
    /// Element values of the iteration matrix.
    values: Vec<f64>,
    pub(crate) inverse_scale: Vec<f64>,
    inverse_constraint_scale: Vec<f64>,
    zero: Vec<f64>,
    monitor: Monitor,
    pub(crate) saved: Saved,
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
        let work = Workspace {
            next: state.clone(),
            delta: vec![0.0; if problem.is_flat() { 0 } else { n }],
            x: vec![0.0; n + m],
            values: vec![0.0; problem.structure().values()],
            inverse_scale: inverse(problem.scale()),
            inverse_constraint_scale: inverse(problem.constraint_scale()),
            monitor: Monitor::with_capacity(options.newton.max_iterations),
            saved: Saved::default(),
            zero: vec![0.0; n.max(m)],
        };
        let statistics = Statistics::default();
        let mut new = Self { problem, solver, options, coefficients, state, statistics, work };
        new.rebuild_factor()?;
        Ok(new)
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

    /// The linear solver.
    pub fn solver(&self) -> &dyn LinearSolver {
        self.solver.as_ref()
    }

    /// Gives back the problem, the solver and the state.
    pub fn into_parts(self) -> (P, Box<dyn LinearSolver>, State) {
        (self.problem, self.solver, self.state)
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
        Ok(start)
    }

    /// Advances by the nominal step `h`, in smaller ones where it fails (halved down to `h/1024`, doubled again
    /// after successes). Equal nominal steps land on `start + n h` without accumulated rounding.
    ///
    /// # Errors
    /// The last failure; the state is then the last one reached.
    pub fn advance(&mut self, h: f64) -> Result<StepReport, Error> {
        check_step(h)?;
        if self.state.series_step != h {
            self.state.series_start = self.state.t;
            self.state.series_step = h;
            self.state.series_steps = 0;
        }
        let n = self.state.series_steps;
        let time = |steps: f64| self.state.series_start + steps * h;
        let (begin, end) = (time(n as f64), time((n + 1) as f64));
        let (mut done, mut size, mut successes) = (0, TICKS, 0);
        let mut total = StepReport::default();
        while done < TICKS {
            let part = f64::from(size) / f64::from(TICKS);
            let t = if done + size == TICKS {
                end
            } else {
                begin + h * (f64::from(done + size) / f64::from(TICKS))
            };
            match self.step_to(t, h * part) {
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

    fn step_to(&mut self, t: f64, h: f64) -> Result<StepReport, Error> {
        let before = (self.statistics.newton_iterations, self.statistics.factorizations);
        let prepared_anew = self.state.h != h;
        if prepared_anew {
            self.prepare(h)?;
        }
        let mut watch = Stopwatch::start(self.options.timed);
        self.predict(t, h);
        if let Err(error) = self.iterate(h, &mut watch) {
            if prepared_anew {
                self.undo_prepare();
            }
            return Err(error);
        }
        self.accept(h);
        watch.lap(&mut self.statistics.seconds.other);
        Ok(StepReport {
            iterations: self.statistics.newton_iterations - before.0,
            factorizations: self.statistics.factorizations - before.1,
            steps: 1,
        })
    }

    /// Predicts `a1 = a`, `lambda1 = lambda`; positions and velocities follow.
    fn predict(&mut self, t: f64, h: f64) {
        let c = self.coefficients;
        let (old, next) = (&self.state, &mut self.work.next);
        let n = old.v.len();
        let (v, a, a_alg) = (&old.v[..n], &old.a[..n], &old.a_alg[..n]);
        let (v1, a1) = (&mut next.v[..n], &mut next.a[..n]);
        let flat = self.problem.is_flat();
        let moved = if flat { &mut next.q[..n] } else { &mut self.work.delta[..n] };
        let (ca, cm) = (1.0 / (1.0 - c.alpha_m), c.alpha_m / (1.0 - c.alpha_m));
        let (q_old, q_new) = (h * h * (0.5 - c.beta), h * h * c.beta);
        let (v_old, v_new) = (h * (1.0 - c.gamma), h * c.gamma);
        for i in 0..n {
            let guess = ca * a[i] - cm * a_alg[i];
            moved[i] = h * v[i] + (q_old * a_alg[i] + q_new * guess);
            v1[i] = v[i] + (v_old * a_alg[i] + v_new * guess);
            a1[i] = a[i];
        }
        if flat {
            for (new, old) in next.q.iter_mut().zip(&old.q) {
                *new += old;
            }
        } else {
            self.problem.retract(&old.q, &self.work.delta, &mut next.q);
        }
        next.lambda_.copy_from_slice(&old.lambda_);
        next.t = t;
    }

    /// Newton's iteration for `(dq, beta h^2 dlambda)`.
    fn iterate(&mut self, h: f64, watch: &mut Stopwatch) -> Result<(), Error> {
        self.work.monitor.reset();
        if self.state.factor.h != h || self.state.factor.age.is_worn(self.solver.factor_cost()) {
            watch.lap(&mut self.statistics.seconds.other);
            self.factor(h, watch)?;
        }
        loop {
            let floor = self.state.factor.floor;
            watch.lap(&mut self.statistics.seconds.other);
            let phi = self.residual(h, watch)?;
            self.solver.solve(&mut self.work.x);
            watch.lap(&mut self.statistics.seconds.solve);
            let size = self.update(h);
            self.statistics.newton_iterations += 1;
            self.state.factor.age.iterations += 1;
            let mut verdict = self.work.monitor.judge(size, phi, floor, &self.options.newton);
            if verdict == Verdict::Stalled {
                verdict = if self.is_rounding_noise(size)? {
                    Verdict::Converged
                } else {
                    self.work.monitor.after_stall(floor, &self.options.newton)
                };
            }
            match verdict {
                Verdict::Converged => return Ok(()),
                Verdict::Refactor => {
                    watch.lap(&mut self.statistics.seconds.other);
                    self.factor(h, watch)?;
                }
                Verdict::Failed => return Err(self.failure(h)),
                Verdict::Continue | Verdict::Stalled => {}
            }
        }
    }

    /// Right-hand side `-(beta h^2 force, phi)`; returns the constraints' norm.
    fn residual(&mut self, h: f64, watch: &mut Stopwatch) -> Result<f64, Error> {
        let next = &self.work.next;
        let (force, phi) = self.work.x.split_at_mut(next.v.len());
        self.statistics.residuals += 1;
        self.problem
            .residual(next.point(), force, phi)
            .map_err(|source| Error::Evaluation { t: next.t, source })?;
        let norm = weighted_max(phi, &self.work.inverse_constraint_scale);
        let scale = -self.coefficients.beta * h * h;
        let mut size = 0;
        for f in force {
            size = size.max(magnitude(*f));
            *f *= scale;
        }
        for p in phi {
            *p = -*p;
        }
        watch.lap(&mut self.statistics.seconds.residual);
        if f64::from_bits(size).is_finite() && norm.is_finite() {
            Ok(norm)
        } else {
            Err(self.not_finite(h))
        }
    }

    /// Adds the increments to the state aimed at; returns `max |dq_i| / scale_i`.
    fn update(&mut self, h: f64) -> f64 {
        let c = self.coefficients;
        let next = &mut self.work.next;
        let n = next.v.len();
        let (dq, dl) = self.work.x.split_at(n);
        let weight = &self.work.inverse_scale[..n];
        let flat = self.problem.is_flat();
        let moved = if flat { &mut next.q[..n] } else { &mut self.work.delta[..n] };
        let a = &mut next.a[..n];
        let rate = c.acceleration_rate(h);
        let mut size = 0;
        for i in 0..n {
            moved[i] += dq[i];
            a[i] += rate * dq[i];
            size = size.max(magnitude(dq[i] * weight[i]));
        }
        if self.problem.has_damping() {
            let rate = c.velocity_rate(h);
            for (v, d) in next.v.iter_mut().zip(dq) {
                *v += rate * d;
            }
        }
        let unscale = 1.0 / (c.beta * h * h);
        for (lambda_, d) in next.lambda_.iter_mut().zip(dl) {
            *lambda_ += unscale * d;
        }
        if !flat {
            self.problem.retract(&self.state.q, &self.work.delta, &mut next.q);
        }
        f64::from_bits(size)
    }

    /// Computes what follows from the accelerations, hands over to the problem, and turns the buffers round.
    fn accept(&mut self, h: f64) {
        let c = self.coefficients;
        let (old, next) = (&mut self.state, &mut self.work.next);
        let n = old.v.len();
        {
            let (v, a, a_alg) = (&old.v[..n], &old.a[..n], &old.a_alg[..n]);
            let (v1, a1, a1_alg) = (&mut next.v[..n], &next.a[..n], &mut next.a_alg[..n]);
            let inverse = 1.0 / (1.0 - c.alpha_m);
            let (c1, c0, cm) =
                ((1.0 - c.alpha_f) * inverse, c.alpha_f * inverse, c.alpha_m * inverse);
            let (v_old, v_new) = (h * (1.0 - c.gamma), h * c.gamma);
            for i in 0..n {
                let new = c1 * a1[i] + (c0 * a[i] - cm * a_alg[i]);
                v1[i] = v[i] + (v_old * a_alg[i] + v_new * new);
                a1_alg[i] = new;
            }
        }
        self.problem.accept(old.point(), next.point());
        swap(&mut old.a_previous, &mut old.a);
        swap(&mut old.a, &mut next.a);
        swap(&mut old.q, &mut next.q);
        swap(&mut old.v, &mut next.v);
        swap(&mut old.a_alg, &mut next.a_alg);
        swap(&mut old.lambda_, &mut next.lambda_);
        old.t = next.t;
        old.factor.age.steps += 1;
        old.factor.age.last = self.work.monitor.increments.len();
        self.statistics.steps += 1;
    }

    /// Factorises the iteration matrix at the state aimed at, and remembers where.
    fn factor(&mut self, h: f64, watch: &mut Stopwatch) -> Result<(), Error> {
        let (kept, next) = (&mut self.state.factor, &self.work.next);
        kept.t = next.t;
        kept.q.clone_from(&next.q);
        kept.v.clone_from(&next.v);
        kept.a.clone_from(&next.a);
        kept.lambda_.clone_from(&next.lambda_);
        kept.age = FactorAge::default();
        kept.h = h;
        let weight = &self.work.inverse_scale;
        let coordinates = if self.problem.is_flat() {
            weighted_max(&next.q, weight)
        } else {
            largest(&next.q) * largest(weight)
        };
        kept.floor = 8.0 * f64::EPSILON * coordinates.max(1.0);
        let outcome = self.rebuild_factor();
        if outcome.is_err() {
            self.state.factor.h = 0.0;
        }
        *watch = Stopwatch::start(self.options.timed);
        outcome
    }

    /// Factorises the iteration matrix where the state says that it was made, if anywhere.
    fn rebuild_factor(&mut self) -> Result<(), Error> {
        let kept = &self.state.factor;
        if kept.h == 0.0 {
            return Ok(());
        }
        let mut watch = Stopwatch::start(self.options.timed);
        let at = Point { t: kept.t, q: &kept.q, v: &kept.v, a: &kept.a, lambda_: &kept.lambda_ };
        self.problem.tangent(at, self.coefficients.weights(kept.h), &mut self.work.values);
        watch.lap(&mut self.statistics.seconds.tangent);
        self.statistics.factorizations += 1;
        let outcome = self.solver.factor(self.problem.structure(), &self.work.values);
        watch.lap(&mut self.statistics.seconds.factor);
        outcome.map_err(|e| Error::from_factor(&self.problem, kept.t, &e))
    }

    /// Whether the last increment is rounding noise: 1e-14 of the coordinates, or the answer to a residual of
    /// 1e-12 of the forces that cancel in it (stiff problems cannot do better).
    fn is_rounding_noise(&mut self, size: f64) -> Result<bool, Error> {
        let next = &self.work.next;
        let (force, phi) = self.work.x.split_at_mut(next.v.len());
        self.statistics.residuals += 2;
        let t = next.t;
        let mut evaluate = |at: Point<'_>, phi: &mut [f64]| {
            let outcome = self.problem.residual(at, force, phi);
            outcome.map(|()| largest(force)).map_err(|source| Error::Evaluation { t, source })
        };
        let rest = evaluate(next.point(), phi)?;
        let gap = weighted_max(phi, &self.work.inverse_constraint_scale);
        let zero = &self.work.zero;
        let (a, lambda_) = (&zero[..next.v.len()], &zero[..next.lambda_.len()]);
        let forces = evaluate(Point { a, lambda_, ..next.point() }, phi)?;
        Ok(gap <= self.options.newton.constraint_tolerance
            && (size <= 8.0 * self.state.factor.floor || rest <= 1e-12 * forces))
    }

    /// The error of an iteration that was given up.
    fn failure(&self, h: f64) -> Error {
        let n = self.state.v.len();
        let unknown = worst(&self.work.x[..n], &self.work.inverse_scale);
        let finite = self.work.monitor.increments.last().is_none_or(|size| size.is_finite());
        let failure = Box::new(self.describe_failure(h, unknown));
        if finite { Error::NotConverged(failure) } else { Error::NotFinite(failure) }
    }

    /// The error of a residual with an entry that is not finite.
    fn not_finite(&self, h: f64) -> Error {
        let unknown = first_not_finite(&self.work.x).unwrap_or_default();
        Error::NotFinite(Box::new(self.describe_failure(h, unknown)))
    }

    fn describe_failure(&self, h: f64, unknown: usize) -> Failure {
        let increments = self.work.monitor.increments.clone();
        Failure {
            t: self.work.next.t,
            h,
            iterations: increments.len(),
            increments,
            unknown,
            name: self.problem.describe(unknown),
        }
    }
}

fn check_options<P: Problem>(problem: &P, options: &Options) -> Result<Coefficients, Error> {
    let newton = &options.newton;
    for (what, value) in [
        ("newton.tolerance", newton.tolerance),
        ("newton.constraint_tolerance", newton.constraint_tolerance),
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

fn check_step(h: f64) -> Result<(), Error> {
    if h > 0.0 && h.is_finite() {
        Ok(())
    } else {
        Err(Error::Value { what: "the step", expected: "positive and finite", got: h })
    }
}
