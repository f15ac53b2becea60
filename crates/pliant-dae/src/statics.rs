//! Equilibria: `f(s, q) + phi_q^T lambda_ = 0`, `phi(s, q) = 0`, along a load factor s.
//!
//! Newton's method with the full tangent, damped by the natural monotonicity test (Deuflhard 2004, algorithm
//! NLEQ-ERR): a trial is judged by the correction that the present factorisation asks for there. Unlike a norm
//! of forces this is independent of units and of stiffness ratios: it lets a slender part bend, although that
//! first stretches it.
//!
//! What is thin, shells, goes by Newton's method with predicted forces first, which needs no damping (`mixed`).
//!
//! Newton's method finds equilibria of any kind. Where it fails (a slack line), or finds one that is unstable (a
//! straight line under compression), the search goes on by the flow of steepest descent `M dq/dtau = -f` from
//! there, in implicit steps that grow as it settles (pseudo-transient continuation, Kelley & Keyes 1998).

mod descent;
mod mixed;
pub mod path;
mod stability;

use crate::error::{Error, Failure, check_length};
use crate::linear_solver::LinearSolver;
use crate::problem::{Point, Problem, Weights};
use crate::redundancy::{leave_out_dependent, require_met};
use crate::scaling::{first_not_finite, inverse, largest, weighted_max, worst};
use stability::Stability;

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
    /// Leave unstable equilibria for stable ones.
    pub stable: bool,
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
            stable: true,
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
    /// Whether no motion lowers the energy; none where forces have no potential.
    pub stable: Option<bool>,
}

/// Load increments are cut down to this part of the nominal one.
const SMALLEST_CUT: f64 = 1.0 / 1024.0;
/// Damping below which an iteration has failed.
const SMALLEST_DAMPING: f64 = 1e-4;
/// Increments that stagnate below this many tolerances are rounding noise.
const NOISE: f64 = 1e5;
/// Unstable equilibria left, one after the other, before the search is given up.
const ESCAPES: usize = 8;
/// Part of a nominal load increment down to which one that fails by predicted forces is cut rather than laboured at.
const LABOURED: f64 = 0.25;
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
    let dependencies = leave_out_dependent(problem, options.from, q);
    let mut lambda_ = lambda_.to_vec();
    for dependency in &dependencies {
        lambda_[dependency.equation] = 0.0;
    }
    problem.determine(options.from, q, &mut lambda_);
    let mut search = Search::new(problem, solver, *options, poll);
    let nominal = (options.to - options.from) / options.load_steps.max(1) as f64;
    let mut path = Vec::new();
    let mut q = q.to_vec();
    let (mut load, mut cut) = (options.from, 1.0);
    loop {
        let rest = options.to - load;
        let step =
            if (rest.abs()) <= (cut * nominal).abs() * (1.0 + 1e-9) { rest } else { cut * nominal };
        let target = if step == rest { options.to } else { load + step };
        let easy = cut > LABOURED && nominal != 0.0;
        match search.equilibrium(target, step, &q, &lambda_, easy) {
            Ok(point) => {
                require_met(search.problem, target, &point.q, &dependencies)?;
                q.clone_from(&point.q);
                lambda_.clone_from(&point.lambda_);
                load = target;
                cut = (2.0_f64 * cut).min(1.0);
                search.found(load, &q, &lambda_);
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
    /// What was in the way of the last increment.
    barrier: Option<String>,
}

/// Where the iteration stands, and how far it moved since the flow's last step.
#[derive(Clone, Debug)]
struct Place {
    q: Vec<f64>,
    lambda_: Vec<f64>,
    moved: Vec<f64>,
}

/// What Newton's method is asked for.
#[derive(Clone, Copy, Debug)]
struct Goal {
    /// Factor of the mass term.
    mu: f64,
    tolerance: f64,
    iterations: usize,
}

/// How an iteration ended.
enum Outcome {
    Equilibrium { last_increment: f64, iterations: usize },
    Failed(Error),
}

impl<'a, P: Problem + ?Sized> Search<'a, P> {
    /// Tells the problem of an equilibrium from which the search goes on.
    fn found(&mut self, load: f64, q: &[f64], lambda_: &[f64]) {
        let (v, a) = (&self.zero[..], &self.zero[..]);
        self.problem.equilibrium(Point { t: load, q, v, a, lambda_ });
    }

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
            barrier: None,
            problem,
            solver,
            options,
            poll,
        }
    }

    /// Newton's method, with the flow's help if it fails; then away from there as long as that is unstable. Where forces
    /// can be predicted an `easy` search ends with the method that predicts them.
    fn equilibrium(
        &mut self,
        load: f64,
        step: f64,
        q: &[f64],
        lambda_: &[f64],
        easy: bool,
    ) -> Result<StaticPoint, Error> {
        self.measure_forces(load, q, lambda_);
        let n = self.zero.len();
        let start = Place { q: q.to_vec(), lambda_: lambda_.to_vec(), moved: vec![0.0; n] };
        let mut place = start.clone();
        let mut iterations = 0;
        let mut outcome = self.search(load, step, &mut place, self.exact())?;
        if self.problem.predicts() && matches!(outcome, Outcome::Failed(_)) && !easy {
            place = start.clone();
            outcome = self.newton(load, step, &mut place, self.exact())?;
        }
        if matches!(outcome, Outcome::Failed(_)) && !(easy && self.problem.predicts()) {
            place = start;
            self.descend(load, step, &mut place, None)?;
            outcome = self.newton(load, step, &mut place, self.exact())?;
        }
        for _ in 0..ESCAPES {
            let last_increment = match outcome {
                Outcome::Failed(error) => return Err(error),
                Outcome::Equilibrium { last_increment, iterations: more } => {
                    iterations += more;
                    last_increment
                }
            };
            let (x, curvature) = match self.stability(load, &place)? {
                Stability::Unstable { x, curvature } if self.options.stable => (x, curvature),
                other => {
                    let stable = match other {
                        Stability::Stable => Some(true),
                        Stability::Unstable { .. } => Some(false),
                        Stability::Unknown => None,
                    };
                    let Place { q, lambda_, .. } = place;
                    return Ok(StaticPoint {
                        load,
                        q,
                        lambda_,
                        iterations,
                        last_increment,
                        stable,
                    });
                }
            };
            self.leave(load, &mut place, &x)?;
            self.descend(load, step, &mut place, Some(-curvature))?;
            outcome = self.newton(load, step, &mut place, self.exact())?;
        }
        let unknown = match self.stability(load, &place)? {
            Stability::Unstable { x, .. } => worst(&x, &self.inverse_scale),
            _ => 0,
        };
        Err(Error::Unstable { t: load, unknown, name: self.problem.describe(unknown) })
    }

    /// Newton's method down to rounding, without a mass term.
    fn exact(&self) -> Goal {
        Goal { mu: 0.0, tolerance: self.options.tolerance, iterations: self.options.max_iterations }
    }

    /// Damped Newton's method (NLEQ-ERR) for `f + mu M moved = 0`; errors are those that no other method would cure.
    fn newton(
        &mut self,
        load: f64,
        step: f64,
        place: &mut Place,
        goal: Goal,
    ) -> Result<Outcome, Error> {
        let n = self.zero.len();
        let mut increments: Vec<f64> = Vec::new();
        let mut trial = place.clone();
        let mut worst_unknown = 0;
        let mut damping = 1.0_f64;
        while increments.len() < goal.iterations {
            if (self.poll)() {
                return Err(Error::Interrupted { t: load });
            }
            let dx = match self.correction(load, place, goal.mu, None) {
                Ok(dx) => dx,
                Err(error) if error.is_recoverable() => return Ok(Outcome::Failed(error)),
                Err(error) => return Err(error),
            };
            let size = weighted_max(&dx[..n], &self.inverse_scale);
            worst_unknown = worst(&dx[..n], &self.inverse_scale);
            let previous = increments.last().copied().unwrap_or(f64::INFINITY);
            increments.push(size);
            let noise = size > 0.5 * previous && size <= NOISE * self.options.tolerance;
            if size <= goal.tolerance || noise {
                let part = self.part(&place.q, &dx, 1.0);
                self.add(place, &dx, part);
                let iterations = increments.len();
                return Ok(Outcome::Equilibrium { last_increment: size, iterations });
            }
            let longest = self.part(&place.q, &dx, (self.options.max_increment / size).min(1.0));
            if longest == 0.0 {
                let failure = self.failure(load, step, &increments, worst_unknown);
                return Ok(Outcome::Failed(failure));
            }
            damping = (4.0 * damping).min(longest);
            loop {
                trial.clone_from(place);
                self.add(&mut trial, &dx, damping);
                // The correction asked for at the trial point, by the same matrix.
                let next = self.right_hand_side(load, &trial, goal.mu).map(|mut r| {
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
                    let failure = self.failure(load, step, &increments, worst_unknown);
                    return Ok(Outcome::Failed(failure));
                }
            }
            std::mem::swap(place, &mut trial);
        }
        Ok(Outcome::Failed(self.failure(load, step, &increments, worst_unknown)))
    }

    /// Newton's increment `(dq, force_scale dlambda)` with a mass term `mu M`; its matrix stays factorised. It has the
    /// forces that were predicted one increment of the coordinates ago where that is given.
    fn correction(
        &mut self,
        load: f64,
        place: &Place,
        mu: f64,
        last: Option<&[f64]>,
    ) -> Result<Vec<f64>, Error> {
        let mut x = self.right_hand_side(load, place, mu)?;
        let weights = Weights {
            mass: mu * self.force_scale,
            damping: 0.0,
            stiffness: self.force_scale,
            jacobian: 1.0,
        };
        let v = last.unwrap_or(&self.zero);
        let at = Point { t: load, q: &place.q, v, a: &self.zero, lambda_: &place.lambda_ };
        if last.is_some() {
            self.problem.predicted_tangent(at, weights, &mut self.values);
        } else {
            self.problem.tangent(at, weights, &mut self.values);
        }
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

    /// `-(force_scale (force + mu M moved), phi)`: the mass term is the force of inertia at `a = mu moved`.
    fn right_hand_side(&mut self, load: f64, place: &Place, mu: f64) -> Result<Vec<f64>, Error> {
        let n = self.zero.len();
        let mut x = vec![0.0; n + place.lambda_.len()];
        let (force, phi) = x.split_at_mut(n);
        let a: Vec<f64> = place.moved.iter().map(|x| mu * x).collect();
        let at = Point { t: load, q: &place.q, v: &self.zero, a: &a, lambda_: &place.lambda_ };
        self.problem
            .residual(at, force, phi)
            .map_err(|source| Error::Evaluation { t: load, source })?;
        if let Some(unknown) = first_not_finite(&x) {
            return Err(Error::NotFinite(Box::new(self.describe(load, 0.0, &[], unknown))));
        }
        for f in &mut x[..n] {
            *f *= -self.force_scale;
        }
        for p in &mut x[n..] {
            *p = -*p;
        }
        Ok(x)
    }

    /// Number of motions that lower the energy, if the factors of the stiffness and the constraints made last tell:
    /// each multiplier adds one negative eigenvalue to theirs.
    fn falling_by_inertia(&self) -> Option<usize> {
        self.solver.negative_eigenvalues()?.checked_sub(self.problem.multipliers())
    }

    fn add(&self, place: &mut Place, dx: &[f64], factor: f64) {
        let n = self.zero.len();
        let dq: Vec<f64> = dx[..n].iter().map(|d| factor * d).collect();
        let from = place.q.clone();
        self.problem.retract(&from, &dq, &mut place.q);
        for (l, d) in place.lambda_.iter_mut().zip(&dx[n..]) {
            *l += factor * d / self.force_scale;
        }
        for (m, d) in place.moved.iter_mut().zip(&dq) {
            *m += d;
        }
    }

    /// At most this part of an increment: as much as nothing is in the way of.
    fn part(&mut self, q: &[f64], dx: &[f64], part: f64) -> f64 {
        let dq: Vec<f64> = dx[..self.zero.len()].iter().map(|d| part * d).collect();
        let (free, barrier) = self.problem.way(q, &dq);
        self.barrier = barrier;
        part * free
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
        let place = Place { q: q.to_vec(), lambda_: lambda_.to_vec(), moved: vec![0.0; n] };
        match self.correction(load, &place, 0.0, None) {
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
        let failure = Box::new(self.describe(load, step, increments, unknown));
        match &self.barrier {
            Some(what) => Error::Barred { failure, what: what.clone() },
            None => Error::NotConverged(failure),
        }
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
