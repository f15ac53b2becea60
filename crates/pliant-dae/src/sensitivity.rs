//! Derivatives of solutions by parameters, forward and adjoint, from the factorised tangent.
//!
//! Differentiating `r(x, p) = 0` gives `A dx/dp = -dr/dp` (forward, one solution a parameter) and, for a scalar
//! `g(x)`, `dg/dp = mu . dr/dp` with `A^T mu = -dg/dx` (adjoint, one solution for all parameters).

use crate::coefficients::Coefficients;
use crate::error::{Error, check_length};
use crate::linear_solver::LinearSolver;
use crate::problem::{Point, Problem, Weights};

const STATIC: Weights = Weights { mass: 0.0, damping: 0.0, stiffness: 1.0, jacobian: 1.0 };

/// Derivative of a state by one parameter; zero where the initial state does not depend on it.
#[derive(Clone, Debug, PartialEq)]
pub struct Sensitivity {
    /// Of the positions, at velocity level.
    pub q: Vec<f64>,
    /// Of the velocities.
    pub v: Vec<f64>,
    /// Of the true accelerations.
    pub a: Vec<f64>,
    /// Of the algorithmic accelerations.
    pub a_alg: Vec<f64>,
    /// Of the multipliers.
    pub lambda_: Vec<f64>,
}

impl Sensitivity {
    /// All zeros.
    #[must_use]
    pub fn zero<P: Problem + ?Sized>(problem: &P) -> Self {
        let n = vec![0.0; problem.velocities()];
        Self {
            q: n.clone(),
            v: n.clone(),
            a: n.clone(),
            a_alg: n,
            lambda_: vec![0.0; problem.multipliers()],
        }
    }
}

/// Derivatives of an equilibrium (positions at velocity level, then multipliers) by every parameter.
///
/// # Errors
/// Wrong lengths or a singular tangent.
pub fn static_sensitivities<P: Problem + ?Sized>(
    problem: &mut P,
    solver: &mut dyn LinearSolver,
    t: f64,
    q: &[f64],
    lambda_: &[f64],
) -> Result<Vec<Vec<f64>>, Error> {
    check_lengths(problem, q, lambda_)?;
    let zero = vec![0.0; problem.velocities()];
    let at = Point { t, q, v: &zero, a: &zero, lambda_ };
    factor(problem, solver, at, STATIC)?;
    Ok((0..problem.parameters())
        .map(|p| {
            let mut x = derivative(problem, at, p);
            x.iter_mut().for_each(|x| *x = -*x);
            solver.solve(&mut x);
            x
        })
        .collect())
}

/// Gradient by all parameters of a scalar of an equilibrium whose derivative by positions and multipliers is `g`.
///
/// # Errors
/// Wrong lengths or a singular tangent.
pub fn static_gradient<P: Problem + ?Sized>(
    problem: &mut P,
    solver: &mut dyn LinearSolver,
    t: f64,
    q: &[f64],
    lambda_: &[f64],
    g: &[f64],
) -> Result<Vec<f64>, Error> {
    check_lengths(problem, q, lambda_)?;
    check_length("g", g, problem.velocities() + problem.multipliers())?;
    let zero = vec![0.0; problem.velocities()];
    let at = Point { t, q, v: &zero, a: &zero, lambda_ };
    factor(problem, solver, at, STATIC)?;
    let mut mu: Vec<f64> = g.iter().map(|g| -g).collect();
    solver.solve_transposed(&mut mu);
    Ok((0..problem.parameters())
        .map(|p| derivative(problem, at, p).iter().zip(&mu).map(|(r, mu)| r * mu).sum())
        .collect())
}

/// Carries the derivative by parameter `p` over one step of length `h` that ended at `after` (flat problems only:
/// increments are taken to add up).
///
/// # Errors
/// Wrong lengths or a singular tangent.
pub fn step_sensitivity<P: Problem + ?Sized>(
    problem: &mut P,
    solver: &mut dyn LinearSolver,
    coefficients: &Coefficients,
    h: f64,
    after: Point<'_>,
    p: usize,
    s: &mut Sensitivity,
) -> Result<(), Error> {
    check_lengths(problem, after.q, after.lambda_)?;
    let c = coefficients;
    let n = problem.velocities();
    // The state at the end of the step if the accelerations' derivative stayed as it was.
    let guess: Vec<f64> =
        (0..n).map(|i| (s.a[i] - c.alpha_m * s.a_alg[i]) / (1.0 - c.alpha_m)).collect();
    for i in 0..n {
        let (a_alg, a1_alg) = (s.a_alg[i], guess[i]);
        s.q[i] += h * s.v[i] + h * h * ((0.5 - c.beta) * a_alg + c.beta * a1_alg);
        s.v[i] += h * ((1.0 - c.gamma) * a_alg + c.gamma * a1_alg);
        s.a_alg[i] = a1_alg;
    }
    // The residual's derivative there: M a + C v + (K q, phi_q^T lambda_; phi_q q) + dr/dp.
    let mut x = derivative(problem, after, p);
    let mut values = vec![0.0; problem.structure().values()];
    let none = Weights { mass: 0.0, damping: 0.0, stiffness: 0.0, jacobian: 0.0 };
    let mut add = |problem: &mut P, weights: Weights, part: &[f64], lambda_: &[f64]| {
        problem.tangent(after, weights, &mut values);
        let vector: Vec<f64> = part.iter().chain(lambda_).copied().collect();
        problem.structure().multiply_add(&values, &vector, &mut x, false);
    };
    add(problem, Weights { mass: 1.0, ..none }, &s.a, &vec![0.0; s.lambda_.len()]);
    add(problem, Weights { damping: 1.0, ..none }, &s.v, &vec![0.0; s.lambda_.len()]);
    add(problem, Weights { stiffness: 1.0, jacobian: 1.0, ..none }, &s.q, &s.lambda_);
    let scale = c.beta * h * h;
    x[..n].iter_mut().for_each(|x| *x *= -scale);
    x[n..].iter_mut().for_each(|x| *x = -*x);
    factor(problem, solver, after, c.weights(h))?;
    solver.solve(&mut x);
    let rate_alg = 1.0 / scale;
    for i in 0..n {
        s.q[i] += x[i];
        s.v[i] += c.velocity_rate(h) * x[i];
        s.a[i] += c.acceleration_rate(h) * x[i];
        s.a_alg[i] += rate_alg * x[i];
    }
    for (l, d) in s.lambda_.iter_mut().zip(&x[n..]) {
        *l += d / scale;
    }
    Ok(())
}

fn check_lengths<P: Problem + ?Sized>(
    problem: &P,
    q: &[f64],
    lambda_: &[f64],
) -> Result<(), Error> {
    check_length("q", q, problem.coordinates())?;
    check_length("lambda_", lambda_, problem.multipliers())
}

fn factor<P: Problem + ?Sized>(
    problem: &mut P,
    solver: &mut dyn LinearSolver,
    at: Point<'_>,
    weights: Weights,
) -> Result<(), Error> {
    let mut values = vec![0.0; problem.structure().values()];
    problem.tangent(at, weights, &mut values);
    let outcome = solver.factor(problem.structure(), &values);
    outcome.map_err(|e| Error::from_factor(problem, at.t, &e))
}

fn derivative<P: Problem + ?Sized>(problem: &mut P, at: Point<'_>, p: usize) -> Vec<f64> {
    let n = problem.velocities();
    let mut r = vec![0.0; n + problem.multipliers()];
    let (force, phi) = r.split_at_mut(n);
    problem.parameter_derivative(at, p, force, phi);
    r
}
