//! Consistent initial values: velocities on the constraints, accelerations and multipliers from
//! `[M phi_q^T; phi_q 0] [a; lambda_] = -[f; phi_acceleration]`.

use crate::error::{Error, Failure, check_length};
use crate::linear_solver::LinearSolver;
use crate::problem::{Point, Problem, Weights};
use crate::redundancy::{Dependency, leave_out_dependent, require_agreement};
use crate::scaling::{first_not_finite, inverse, magnitude, weighted_max, worst};

/// Constraint residuals above this, in units of their scale, are refused at the start: the first step would
/// correct them within `h` and report the jump as an acceleration.
pub const LARGEST_INITIAL_VIOLATION: f64 = 1e-8;

/// The matrix `[M phi_q^T; phi_q 0]`.
pub(crate) const MASS_WITH_CONSTRAINTS: Weights =
    Weights { mass: 1.0, damping: 0.0, stiffness: 0.0, jacobian: 1.0 };

/// Consistent initial values.
#[derive(Clone, Debug, PartialEq)]
pub struct Consistent {
    /// Velocities that satisfy the constraints, the nearest to the given ones in the kinetic energy.
    pub v: Vec<f64>,
    /// Accelerations.
    pub a: Vec<f64>,
    /// Multipliers.
    pub lambda_: Vec<f64>,
    /// Largest change of a velocity, `max |dv_i| / scale_i` [1/s].
    pub velocity_correction: f64,
    /// The velocity that was changed most.
    pub most_corrected: usize,
    /// Constraints that follow from others.
    pub dependencies: Vec<Dependency>,
}

/// Checks positions, projects velocities, and solves for accelerations and multipliers at time `t`.
///
/// # Errors
/// Wrong lengths, numbers that are not finite, positions off the constraints, a singular mass matrix,
/// contradictory constraints, or a failing evaluation.
pub fn consistent_start<P: Problem + ?Sized>(
    problem: &mut P,
    solver: &mut dyn LinearSolver,
    t: f64,
    q: &[f64],
    v: &[f64],
) -> Result<Consistent, Error> {
    check_length("q", q, problem.coordinates())?;
    check_length("v", v, problem.velocities())?;
    for (what, array) in [("q", q), ("v", v)] {
        if let Some(i) = first_not_finite(array) {
            return Err(Error::Value { what, expected: "finite", got: array[i] });
        }
    }
    problem.leave_out(&[]);
    check_positions(problem, t, q, v)?;
    let dependencies = leave_out_dependent(problem, t, q);
    check_dependent(problem, t, q, v, &dependencies, false)?;
    let mut velocity = v.to_vec();
    let (velocity_correction, most_corrected) =
        project_velocities(problem, solver, t, q, &mut velocity)?;
    check_dependent(problem, t, q, &velocity, &dependencies, true)?;
    let (a, lambda_) = consistent_acceleration(problem, solver, t, q, &velocity)?;
    Ok(Consistent { v: velocity, a, lambda_, velocity_correction, most_corrected, dependencies })
}

/// Refuses constraints that follow from others but not with their rates, or accelerations.
fn check_dependent<P: Problem + ?Sized>(
    problem: &mut P,
    t: f64,
    q: &[f64],
    v: &[f64],
    dependencies: &[Dependency],
    accelerations: bool,
) -> Result<(), Error> {
    if dependencies.is_empty() {
        return Ok(());
    }
    let (n, m) = (problem.velocities(), problem.multipliers());
    let zero = vec![0.0; n.max(m)];
    let mut left_out = vec![false; m];
    for dependency in dependencies {
        left_out[dependency.equation] = true;
    }
    let mut values = vec![0.0; m];
    problem.leave_out(&[]);
    let what = if accelerations {
        let at = Point { t, q, v, a: &zero[..n], lambda_: &zero[..m] };
        problem.constraint_acceleration(at, &mut values);
        "accelerations that all allow (a position where the freedoms branch, perhaps: start beside it)"
    } else {
        problem.constraint_rate(t, q, &mut values);
        "velocities that all allow"
    };
    problem.leave_out(&left_out);
    require_agreement(problem, t, dependencies, &values, what)
}

fn check_positions<P: Problem + ?Sized>(
    problem: &mut P,
    t: f64,
    q: &[f64],
    v: &[f64],
) -> Result<(), Error> {
    let (n, m) = (problem.velocities(), problem.multipliers());
    let (a, mut lambda_) = (vec![0.0; n], vec![0.0; m]);
    problem.determine(t, q, &mut lambda_);
    let (mut force, mut phi) = (vec![0.0; n], vec![0.0; m]);
    let point = Point { t, q, v, a: &a, lambda_: &lambda_ };
    problem
        .residual(point, &mut force, &mut phi)
        .map_err(|source| Error::Evaluation { t, source })?;
    let weight = inverse(problem.constraint_scale());
    if weighted_max(&phi, &weight) <= LARGEST_INITIAL_VIOLATION {
        return Ok(());
    }
    let constraint = worst(&phi, &weight);
    Err(Error::ConstraintViolated {
        t,
        constraint,
        name: problem.describe(n + constraint),
        residual: phi[constraint],
        scale: problem.constraint_scale()[constraint],
    })
}

/// Projects `v` onto `phi_q v + phi_t = 0`, orthogonally in the mass; returns the largest change in units of the
/// scale [1/s] and where it is.
fn project_velocities<P: Problem + ?Sized>(
    problem: &mut P,
    solver: &mut dyn LinearSolver,
    t: f64,
    q: &[f64],
    v: &mut [f64],
) -> Result<(f64, usize), Error> {
    let (n, m) = (problem.velocities(), problem.multipliers());
    if m == 0 {
        return Ok((0.0, 0));
    }
    let mut rate = vec![0.0; m];
    problem.constraint_rate(t, q, &mut rate);
    let dv = normal_component(problem, solver, t, q, v, &rate)?;
    for (v, d) in v.iter_mut().zip(&dv) {
        *v -= d;
    }
    let weight = inverse(problem.scale());
    debug_assert_eq!(dv.len(), n);
    Ok((weighted_max(&dv, &weight), worst(&dv, &weight)))
}

/// The vector w of least kinetic energy with `phi_q w = phi_q x + shift`.
pub(crate) fn normal_component<P: Problem + ?Sized>(
    problem: &mut P,
    solver: &mut dyn LinearSolver,
    t: f64,
    q: &[f64],
    x: &[f64],
    shift: &[f64],
) -> Result<Vec<f64>, Error> {
    normal_components(problem, solver, t, q, [(x, shift)]).map(|[w]| w)
}

/// The same for several vectors and their shifts, with one factorisation.
pub(crate) fn normal_components<P: Problem + ?Sized, const K: usize>(
    problem: &mut P,
    solver: &mut dyn LinearSolver,
    t: f64,
    q: &[f64],
    given: [(&[f64], &[f64]); K],
) -> Result<[Vec<f64>; K], Error> {
    let n = problem.velocities();
    let values = factor_mass(problem, solver, t, q, &vec![0.0; n])?;
    let found = given.map(|(x, shift)| {
        let mut input = x.to_vec();
        input.resize(n + shift.len(), 0.0);
        let mut out = vec![0.0; n + shift.len()];
        problem.structure().multiply_add(&values, &input, &mut out, false);
        out[..n].fill(0.0);
        for (o, s) in out[n..].iter_mut().zip(shift) {
            *o += s;
        }
        solver.solve(&mut out);
        out.truncate(n);
        out
    });
    for w in &found {
        finite_or_name(problem, t, w)?;
    }
    Ok(found)
}

/// Accelerations and multipliers at a state, with one step of iterative refinement.
///
/// # Errors
/// As [`consistent_start`].
pub fn consistent_acceleration<P: Problem + ?Sized>(
    problem: &mut P,
    solver: &mut dyn LinearSolver,
    t: f64,
    q: &[f64],
    v: &[f64],
) -> Result<(Vec<f64>, Vec<f64>), Error> {
    let (n, m) = (problem.velocities(), problem.multipliers());
    let values = factor_mass(problem, solver, t, q, v)?;
    let mut right = vec![0.0; n + m];
    let zero = vec![0.0; n + m];
    let mut given = vec![0.0; m];
    problem.determine(t, q, &mut given);
    let point = Point { t, q, v, a: &zero[..n], lambda_: &given };
    let (force, phi) = right.split_at_mut(n);
    problem.residual(point, force, phi).map_err(|source| Error::Evaluation { t, source })?;
    problem.constraint_acceleration(point, phi);
    finite_or_name(problem, t, &right)?;
    // Solves for -(a, lambda_); the residual of that solution is solved for once more.
    let mut x = right.clone();
    solver.solve(&mut x);
    let mut rest = zero;
    problem.structure().multiply_add(&values, &x, &mut rest, false);
    for (r, b) in rest.iter_mut().zip(&right) {
        *r = b - *r;
    }
    solver.solve(&mut rest);
    for (x, r) in x.iter_mut().zip(&rest) {
        *x = -(*x + r);
    }
    finite_or_name(problem, t, &x)?;
    let mut lambda_ = x.split_off(n);
    for (lambda_, given) in lambda_.iter_mut().zip(&given) {
        *lambda_ += given;
    }
    Ok((x, lambda_))
}

/// Factorises `[M phi_q^T; phi_q 0]` and returns its element values.
fn factor_mass<P: Problem + ?Sized>(
    problem: &mut P,
    solver: &mut dyn LinearSolver,
    t: f64,
    q: &[f64],
    v: &[f64],
) -> Result<Vec<f64>, Error> {
    let zero = vec![0.0; problem.velocities() + problem.multipliers()];
    let (a, lambda_) = zero.split_at(problem.velocities());
    let mut values = vec![0.0; problem.structure().values()];
    problem.tangent(Point { t, q, v, a, lambda_ }, MASS_WITH_CONSTRAINTS, &mut values);
    solver.factor(problem.structure(), &values).map_err(|e| Error::from_factor(problem, t, &e))?;
    Ok(values)
}

/// An error that names the first unknown whose number is not finite.
pub(crate) fn finite_or_name<P: Problem + ?Sized>(
    problem: &P,
    t: f64,
    x: &[f64],
) -> Result<(), Error> {
    if f64::from_bits(x.iter().fold(0, |m, &x| m.max(magnitude(x)))).is_finite() {
        return Ok(());
    }
    let unknown = first_not_finite(x).unwrap_or_default();
    Err(Error::NotFinite(Box::new(Failure {
        t,
        h: 0.0,
        iterations: 0,
        increments: Vec::new(),
        unknown,
        name: problem.describe(unknown),
    })))
}
