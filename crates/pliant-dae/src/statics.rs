//! Equilibria: `f(s, q) + phi_q^T lambda_ = 0`, `phi(s, q) = 0`, along a load factor s.
//!
//! Newton's method with the full tangent, damped by the natural monotonicity test (Deuflhard 2004, algorithm
//! NLEQ-ERR): a trial is judged by the correction that the present factorisation asks for there. Unlike a norm
//! of forces this is independent of units and of stiffness ratios: it lets a slender part bend, although that
//! first stretches it. Where the tangent is singular or indefinite far from equilibrium (a slack line), a mass term
//! that fades with the residual keeps it regular (pseudo-transient continuation, Kelley & Keyes 1998).

use crate::error::{Error, Failure, check_length};
use crate::linear_solver::LinearSolver;
use crate::problem::{Point, Problem, Weights};
use crate::scaling::{first_not_finite, inverse, largest, weighted_max, worst};

/// Controls of the search for equilibria.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StaticOptions {
    /// Load factor at the start (of which the given state need not be an equilibrium).
    pub from: f64,
    /// Load factor to be reached.
    pub to: f64,
    /// Number of load increments, each of them cut and grown again as needed; 1 tries the full load at once.
    pub load_steps: usize,
    /// Increments below this, in units of the scale, end the iteration. Rounding may stop it before: increments
    /// that no longer shrink are accepted below `1e5` times this.
    pub tolerance: f64,
    /// Largest increment of any coordinate in one iteration, in units of its scale.
    pub max_increment: f64,
    /// Iterations for each load increment.
    pub max_iterations: usize,
}

impl Default for StaticOptions {
    fn default() -> Self {
        Self {
            from: 0.0,
            to: 1.0,
            load_steps: 1,
            tolerance: 1e-12,
            max_increment: 0.5,
            max_iterations: 100,
        }
    }
}

/// One equilibrium.
#[derive(Clone, Debug, PartialEq)]
pub struct StaticPoint {
    /// Load factor.
    pub load: f64,
    /// Coordinates.
    pub q: Vec<f64>,
    /// Multipliers.
    pub lambda_: Vec<f64>,
    /// Iterations that it took.
    pub iterations: usize,
    /// Size of the last increment, in units of the scale: the accuracy reached.
    pub last_increment: f64,
}

/// Load increments are cut down to this part of the nominal one.
const SMALLEST_CUT: f64 = 1.0 / 1024.0;
/// Damping below which an iteration has failed.
const SMALLEST_DAMPING: f64 = 1e-4;
/// Increments that stagnate below this many tolerances are rounding noise.
const NOISE: f64 = 1e5;
/// A null vector is a motion that changes forces by less than this part of what its size could.
const SINGULAR: f64 = 1e-13;

/// Finds equilibria along the load factor (passed to the problem as time, with zero velocities and accelerations);
/// `poll` is called once an iteration and stops the search by returning true.
///
/// Returns the path, ending at `options.to`; on a stable branch it may be continued from its last point.
///
/// # Errors
/// [`Error::Singular`] naming what floats free, [`Error::NotConverged`] at the smallest load increment,
/// [`Error::Interrupted`], wrong lengths, or a failing evaluation.
pub fn solve_static<P: Problem + ?Sized>(
    problem: &mut P,
    solver: &mut dyn LinearSolver,
    q: &[f64],
    lambda_: &[f64],
    options: &StaticOptions,
    poll: &mut dyn FnMut() -> bool,
) -> Result<Vec<StaticPoint>, Error> {
    check_length("q", q, problem.coordinates())?;
    check_length("lambda_", lambda_, problem.multipliers())?;
    let mut search = Search::new(problem, solver, *options, poll);
    let nominal = (options.to - options.from) / options.load_steps.max(1) as f64;
    let mut path = Vec::new();
    let (mut q, mut lambda_) = (q.to_vec(), lambda_.to_vec());
    let (mut load, mut cut) = (options.from, 1.0);
    loop {
        let rest = options.to - load;
        let step =
            if (rest.abs()) <= (cut * nominal).abs() * (1.0 + 1e-9) { rest } else { cut * nominal };
        let target = if step == rest { options.to } else { load + step };
        match search.equilibrium(target, step, &q, &lambda_) {
            Ok(point) => {
                q.clone_from(&point.q);
                lambda_.clone_from(&point.lambda_);
                load = target;
                cut = (2.0_f64 * cut).min(1.0);
                path.push(point);
                if load == options.to {
                    return Ok(path);
                }
            }
            Err(error) => {
                cut *= 0.5;
                if !error.is_recoverable() || cut < SMALLEST_CUT || nominal == 0.0 {
                    return Err(search.singular_or(error, target, &q, &lambda_));
                }
            }
        }
    }
}

struct Search<'a, P: ?Sized> {
    problem: &'a mut P,
    solver: &'a mut dyn LinearSolver,
    options: StaticOptions,
    poll: &'a mut dyn FnMut() -> bool,
    inverse_scale: Vec<f64>,
    /// Factor of forces and stiffness that makes entries of the matrix of order one.
    force_scale: f64,
    zero: Vec<f64>,
    values: Vec<f64>,
}

/// How an iteration ended.
enum Outcome {
    Equilibrium { last_increment: f64 },
    Failed(Error),
}

impl<'a, P: Problem + ?Sized> Search<'a, P> {
    fn new(
        problem: &'a mut P,
        solver: &'a mut dyn LinearSolver,
        options: StaticOptions,
        poll: &'a mut dyn FnMut() -> bool,
    ) -> Self {
        let n = problem.velocities();
        Self {
            inverse_scale: inverse(problem.scale()),
            force_scale: 1.0,
            zero: vec![0.0; n],
            values: vec![0.0; problem.structure().values()],
            problem,
            solver,
            options,
            poll,
        }
    }

    /// Newton's method; if it fails, once more with a fading mass term, and Newton's method again from there.
    fn equilibrium(
        &mut self,
        load: f64,
        step: f64,
        q: &[f64],
        lambda_: &[f64],
    ) -> Result<StaticPoint, Error> {
        self.measure_forces(load, q, lambda_);
        let mut increments = Vec::new();
        let (mut q1, mut lambda1) = (q.to_vec(), lambda_.to_vec());
        let mut outcome = self.newton(load, step, &mut q1, &mut lambda1, &mut increments)?;
        if matches!(outcome, Outcome::Failed(_)) {
            q1.copy_from_slice(q);
            lambda1.copy_from_slice(lambda_);
            self.relax(load, &mut q1, &mut lambda1)?;
            increments.clear();
            outcome = self.newton(load, step, &mut q1, &mut lambda1, &mut increments)?;
        }
        match outcome {
            Outcome::Failed(error) => Err(error),
            Outcome::Equilibrium { last_increment } => Ok(StaticPoint {
                load,
                q: q1,
                lambda_: lambda1,
                iterations: increments.len(),
                last_increment,
            }),
        }
    }

    /// Damped Newton's method (NLEQ-ERR); errors are those that no other method would cure.
    fn newton(
        &mut self,
        load: f64,
        step: f64,
        q: &mut Vec<f64>,
        lambda_: &mut Vec<f64>,
        increments: &mut Vec<f64>,
    ) -> Result<Outcome, Error> {
        let n = self.zero.len();
        let (mut trial_q, mut trial_lambda) = (q.clone(), lambda_.clone());
        let mut worst_unknown = 0;
        let mut damping = 1.0_f64;
        while increments.len() < self.options.max_iterations {
            if (self.poll)() {
                return Err(Error::Interrupted { t: load });
            }
            let mut dx = match self.correction(load, q, lambda_, 0.0) {
                Ok(dx) => dx,
                Err(error) if error.is_recoverable() => return Ok(Outcome::Failed(error)),
                Err(error) => return Err(error),
            };
            let size = weighted_max(&dx[..n], &self.inverse_scale);
            worst_unknown = worst(&dx[..n], &self.inverse_scale);
            let previous = increments.last().copied().unwrap_or(f64::INFINITY);
            increments.push(size);
            let noise = size > 0.5 * previous && size <= NOISE * self.options.tolerance;
            if size <= self.options.tolerance || noise {
                self.add(q, lambda_, &dx, 1.0);
                return Ok(Outcome::Equilibrium { last_increment: size });
            }
            let longest = (self.options.max_increment / size).min(1.0);
            damping = (4.0 * damping).min(longest);
            loop {
                trial_q.copy_from_slice(q);
                trial_lambda.copy_from_slice(lambda_);
                self.add(&mut trial_q, &mut trial_lambda, &dx, damping);
                // The correction asked for at the trial point, by the same matrix.
                let next = self.right_hand_side(load, &trial_q, &trial_lambda).map(|mut r| {
                    self.solver.solve(&mut r);
                    weighted_max(&r[..n], &self.inverse_scale)
                });
                match next {
                    Ok(next) if next <= (1.0 - 0.25 * damping) * size => break,
                    Err(error) if !error.is_recoverable() => return Err(error),
                    _ if size <= NOISE * self.options.tolerance => break,
                    _ => damping *= 0.5,
                }
                if damping < SMALLEST_DAMPING * longest {
                    return Ok(Outcome::Failed(self.failure(
                        load,
                        step,
                        increments,
                        worst_unknown,
                    )));
                }
            }
            std::mem::swap(q, &mut trial_q);
            std::mem::swap(lambda_, &mut trial_lambda);
            dx.clear();
        }
        Ok(Outcome::Failed(self.failure(load, step, increments, worst_unknown)))
    }

    /// Follows `M dq/dtau = -f` by implicit steps that grow as the force falls, until Newton's method may work.
    fn relax(&mut self, load: f64, q: &mut [f64], lambda_: &mut [f64]) -> Result<(), Error> {
        let n = self.zero.len();
        let mass = self.largest_value(load, q, lambda_, WEIGHTS_MASS);
        let mut mu = if mass > 0.0 { 1.0 / (self.force_scale * mass) } else { 0.0 };
        let smallest = 1e-12 * mu;
        for _ in 0..5 * self.options.max_iterations {
            if (self.poll)() {
                return Err(Error::Interrupted { t: load });
            }
            let dx = match self.correction(load, q, lambda_, mu) {
                Ok(dx) => dx,
                Err(error) if error.is_recoverable() => {
                    mu *= 4.0;
                    continue;
                }
                Err(error) => return Err(error),
            };
            let size = weighted_max(&dx[..n], &self.inverse_scale);
            let longest = 0.2 * self.options.max_increment;
            self.add(q, lambda_, &dx, (longest / size).min(1.0));
            // Short moves allow longer pseudo-times; long ones ask for shorter.
            mu *= if size < 0.25 * longest {
                0.3
            } else if size < longest {
                0.7
            } else {
                2.0
            };
            if mu < smallest {
                break;
            }
        }
        Ok(())
    }

    /// Newton's increment `(dq, force_scale dlambda)` with a mass term `mu M`; its matrix stays factorised.
    fn correction(
        &mut self,
        load: f64,
        q: &[f64],
        lambda_: &[f64],
        mu: f64,
    ) -> Result<Vec<f64>, Error> {
        let mut x = self.right_hand_side(load, q, lambda_)?;
        let weights = Weights {
            mass: mu * self.force_scale,
            damping: 0.0,
            stiffness: self.force_scale,
            jacobian: 1.0,
        };
        let at = Point { t: load, q, v: &self.zero, a: &self.zero, lambda_ };
        self.problem.tangent(at, weights, &mut self.values);
        self.solver
            .factor(self.problem.structure(), &self.values)
            .map_err(|e| Error::from_factor(self.problem, load, &e))?;
        self.solver.solve(&mut x);
        match first_not_finite(&x) {
            None => Ok(x),
            Some(unknown) => {
                Err(Error::Singular { t: load, unknown, name: self.problem.describe(unknown) })
            }
        }
    }

    /// `-(force_scale force, phi)`.
    fn right_hand_side(
        &mut self,
        load: f64,
        q: &[f64],
        lambda_: &[f64],
    ) -> Result<Vec<f64>, Error> {
        let n = self.zero.len();
        let mut x = vec![0.0; n + lambda_.len()];
        let (force, phi) = x.split_at_mut(n);
        let at = Point { t: load, q, v: &self.zero, a: &self.zero, lambda_ };
        self.problem
            .residual(at, force, phi)
            .map_err(|source| Error::Evaluation { t: load, source })?;
        if let Some(unknown) = first_not_finite(&x) {
            let mut failure = self.describe(load, 0.0, &[], unknown);
            failure.h = 0.0;
            return Err(Error::NotFinite(Box::new(failure)));
        }
        for f in &mut x[..n] {
            *f *= -self.force_scale;
        }
        for p in &mut x[n..] {
            *p = -*p;
        }
        Ok(x)
    }

    fn add(&self, q: &mut [f64], lambda_: &mut [f64], dx: &[f64], factor: f64) {
        let n = self.zero.len();
        let dq: Vec<f64> = dx[..n].iter().map(|d| factor * d).collect();
        let from = q.to_vec();
        self.problem.retract(&from, &dq, q);
        for (l, d) in lambda_.iter_mut().zip(&dx[n..]) {
            *l += factor * d / self.force_scale;
        }
    }

    /// Chooses the scale of forces from the entries of the stiffness matrix.
    fn measure_forces(&mut self, load: f64, q: &[f64], lambda_: &[f64]) {
        let stiffness = self.largest_value(load, q, lambda_, WEIGHTS_STIFFNESS);
        self.force_scale =
            if stiffness > 0.0 && stiffness.is_finite() { 1.0 / stiffness } else { 1.0 };
    }

    fn largest_value(&mut self, load: f64, q: &[f64], lambda_: &[f64], weights: Weights) -> f64 {
        let at = Point { t: load, q, v: &self.zero, a: &self.zero, lambda_ };
        self.problem.tangent(at, weights, &mut self.values);
        largest(&self.values)
    }

    /// The error, or what floats free if the tangent at the last equilibrium is singular.
    fn singular_or(&mut self, error: Error, load: f64, q: &[f64], lambda_: &[f64]) -> Error {
        if !matches!(error, Error::NotConverged(_)) {
            return error;
        }
        match self.null_unknown(load, q, lambda_) {
            Some(unknown) => {
                Error::Singular { t: load, unknown, name: self.problem.describe(unknown) }
            }
            None => error,
        }
    }

    /// The unknown that moves most in a null vector of the tangent, by two inverse iterations.
    fn null_unknown(&mut self, load: f64, q: &[f64], lambda_: &[f64]) -> Option<usize> {
        let n = self.zero.len();
        match self.correction(load, q, lambda_, 0.0) {
            Err(Error::Singular { unknown, .. }) => return Some(unknown),
            Err(_) => return None,
            Ok(_) => {}
        }
        let mut x: Vec<f64> =
            (0..n + lambda_.len()).map(|i| 1.0 + 0.3 * (i as f64).sin()).collect();
        for _ in 0..2 {
            let size = largest(&x);
            x.iter_mut().for_each(|x| *x /= size);
            self.solver.solve(&mut x);
        }
        // The largest entry of the scaled matrix is about 1, that of x before the last solution was 1.
        (largest(&x[..n]) * SINGULAR > 1.0).then(|| worst(&x[..n], &self.inverse_scale))
    }

    fn failure(&self, load: f64, step: f64, increments: &[f64], unknown: usize) -> Error {
        Error::NotConverged(Box::new(self.describe(load, step, increments, unknown)))
    }

    fn describe(&self, load: f64, step: f64, increments: &[f64], unknown: usize) -> Failure {
        Failure {
            t: load,
            h: step,
            iterations: increments.len(),
            increments: increments.to_vec(),
            unknown,
            name: self.problem.describe(unknown),
        }
    }
}

const WEIGHTS_MASS: Weights = Weights { mass: 1.0, damping: 0.0, stiffness: 0.0, jacobian: 0.0 };
const WEIGHTS_STIFFNESS: Weights =
    Weights { mass: 0.0, damping: 0.0, stiffness: 1.0, jacobian: 0.0 };
