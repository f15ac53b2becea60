//! Whether an equilibrium is a minimum of the potential energy on the constraints.
//!
//! The inertia of the constrained stiffness tells, where the solver knows it: as many negative eigenvalues as there are
//! multipliers, and no motion lowers the energy. Otherwise it is proved that one does.
//!
//! A direction x on the constraints with `x^T K x < 0` proves that it is not. Directions come from Rayleigh-Ritz on
//! Krylov spaces of `(K + mu M)^-1 M`, which show the modes whose `omega^2` lies around `-mu`; mu descends a ladder
//! from the stiffest motion to rounding, so that strong and weak instabilities are seen alike.

use nalgebra::{DMatrix, SymmetricEigen};

use crate::compliance::Compliance;
use crate::error::Error;
use crate::linear_solver::LinearSolver;
use crate::problem::{Point, Problem, Weights};
use crate::scaling::largest;
use crate::structure::{Storage, Structure};

/// What the test found.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Stability {
    /// No motion lowers the energy, beyond rounding.
    Stable,
    /// This motion does: of modal mass 1, with its curvature `x^T K x` [1/s^2].
    Unstable { x: Vec<f64>, curvature: f64 },
    /// The forces have no potential (follower loads), or nothing has mass.
    Unknown,
}

/// Ratio of one rung of the ladder to the next, and the last one relative to the stiffest motion.
const RUNG: f64 = 1.0 / 16.0;
const LAST_RUNG: f64 = 1e-14;
/// Solutions on each rung, and vectors handed to the next.
const SOLUTIONS: usize = 6;
const CARRIED: usize = 2;
/// Curvatures below this part of what their terms add up to without their signs are rounding.
const ROUNDING: f64 = 1e-12;
/// Asymmetry of the stiffness, relative to its largest entry, above which forces have no potential.
const ASYMMETRY: f64 = 1e-10;
/// Relative size below which a vector adds nothing to a basis.
const DEPENDENT: f64 = 1e-10;

/// Tests the state at rest `at`; `load` is the direction of the loads, which is tried first: where it lowers the
/// energy it is the way out.
pub(super) fn test<P: Problem + ?Sized>(
    problem: &mut P,
    solver: &mut dyn LinearSolver,
    at: Point<'_>,
    load: &[f64],
) -> Result<Stability, Error> {
    if !problem.has_potential() {
        return Ok(Stability::Unknown);
    }
    let n = problem.velocities();
    let mut values = |mass, stiffness, jacobian| {
        let mut values = vec![0.0; problem.structure().values()];
        problem.tangent(at, Weights { mass, damping: 0.0, stiffness, jacobian }, &mut values);
        values
    };
    let (mass, stiffness) = (values(1.0, 0.0, 0.0), values(0.0, 1.0, 0.0));
    let mut jacobian = values(0.0, 0.0, 1.0);
    let (heaviest, stiffest) = (largest(&mass), largest(&stiffness));
    let ratio = stiffest / heaviest;
    if !(ratio.is_finite() && ratio > 0.0) {
        return Ok(Stability::Unknown);
    }
    if !problem.compliant().is_empty() {
        // Compliant equations are there where the stiffness has a weight.
        let weights = Weights { mass: 0.0, damping: 0.0, stiffness: 1.0 / stiffest, jacobian: 1.0 };
        problem.tangent(at, weights, &mut jacobian);
        for (jacobian, stiffness) in jacobian.iter_mut().zip(&stiffness) {
            *jacobian -= stiffness / stiffest;
        }
    }
    let compliance = Compliance::new(problem, at);
    let structure = problem.structure();
    if asymmetry(structure, &stiffness) > ASYMMETRY * stiffest {
        return Ok(Stability::Unknown);
    }
    let mut values: Vec<f64> =
        stiffness.iter().zip(&jacobian).map(|(k, j)| k / stiffest + j).collect();
    let multipliers = structure.unknowns() - n;
    if solver.factor(structure, &values).is_ok()
        && solver.negative_eigenvalues() == Some(multipliers)
    {
        return Ok(Stability::Stable);
    }
    let matrices = Matrices { structure, n, mass: &mass, stiffness: &stiffness, compliance };
    let mut carried: Vec<Vec<f64>> =
        vec![(0..n).map(|i| ((1 + 3 * i) as f64 * 0.618_034).sin()).collect()];
    let mut part = 1.0;
    while part >= LAST_RUNG {
        // The matrix of order one: (K + part ratio M) / stiffest, and the constraints.
        for (i, value) in values.iter_mut().enumerate() {
            *value = stiffness[i] / stiffest + part * mass[i] / heaviest + jacobian[i];
        }
        part *= RUNG;
        // A rung that meets an eigenvalue exactly is passed over: its neighbours see that one.
        if solver.factor(structure, &values).is_err() {
            continue;
        }
        let mut solve = |b: &[f64]| {
            let mut x = b.to_vec();
            x.resize(structure.unknowns(), 0.0);
            solver.solve(&mut x);
            x.truncate(n);
            x
        };
        let mut basis = Basis::new(&matrices);
        if basis.extend(solve(load))
            && let Some(found) = basis.unstable()
        {
            return Ok(found);
        }
        for x in &carried {
            basis.extend(solve(&matrices.mass_times(x)));
        }
        for k in 0..SOLUTIONS {
            let Some(x) = basis.mass_x.get(k) else { break };
            let y = solve(x);
            basis.extend(y);
        }
        if let Some(found) = basis.unstable() {
            return Ok(found);
        }
        carried = basis.softest(CARRIED).into_iter().map(|(x, _)| x).collect();
    }
    Ok(Stability::Stable)
}

/// Largest difference of an element matrix and its transpose.
fn asymmetry(structure: &Structure, values: &[f64]) -> f64 {
    let mut worst = 0.0_f64;
    for e in (0..structure.elements()).filter(|&e| structure.slot(e).storage == Storage::Full) {
        let n = structure.element_unknowns(e).count();
        for i in 0..n {
            for j in 0..i {
                let entry = |i, j| structure.entry(e, n, i, j, values);
                worst = worst.max((entry(i, j) - entry(j, i)).abs());
            }
        }
    }
    worst
}

/// Mass and stiffness at the state.
struct Matrices<'a> {
    structure: &'a Structure,
    n: usize,
    mass: &'a [f64],
    stiffness: &'a [f64],
    compliance: Compliance,
}

impl Matrices<'_> {
    fn times(&self, values: &[f64], x: &[f64]) -> Vec<f64> {
        let mut padded = x.to_vec();
        padded.resize(self.structure.unknowns(), 0.0);
        let mut y = vec![0.0; self.structure.unknowns()];
        self.structure.multiply_add(values, &padded, &mut y, false);
        y.truncate(self.n);
        y
    }

    fn stiffness_times(&self, x: &[f64]) -> Vec<f64> {
        let mut y = self.times(self.stiffness, x);
        self.compliance.add_product(x, &mut y);
        y
    }

    fn mass_times(&self, x: &[f64]) -> Vec<f64> {
        self.times(self.mass, x)
    }

    /// What the terms of `x^T K x` add up to without their signs.
    fn absolute_curvature(&self, x: &[f64]) -> f64 {
        let absolute = |x: &[f64]| x.iter().map(|x| x.abs()).collect::<Vec<_>>();
        let (values, x) = (absolute(self.stiffness), absolute(x));
        dot(&self.times(&values, &x), &x)
    }
}

/// Vectors on the constraints, orthonormal in the mass, with their products.
struct Basis<'a> {
    matrices: &'a Matrices<'a>,
    x: Vec<Vec<f64>>,
    mass_x: Vec<Vec<f64>>,
    stiffness_x: Vec<Vec<f64>>,
}

impl<'a> Basis<'a> {
    fn new(matrices: &'a Matrices<'a>) -> Self {
        Self { matrices, x: Vec::new(), mass_x: Vec::new(), stiffness_x: Vec::new() }
    }

    /// Adds what is new in `y`; returns whether anything is.
    fn extend(&mut self, mut y: Vec<f64>) -> bool {
        let norm = |y: &[f64]| dot(y, &self.matrices.mass_times(y)).max(0.0).sqrt();
        let start = norm(&y);
        if !(start.is_finite() && start > 0.0) {
            return false;
        }
        for _ in 0..2 {
            for (x, mass_x) in self.x.iter().zip(&self.mass_x) {
                let part = dot(&y, mass_x);
                add(&mut y, -part, x);
            }
        }
        let rest = norm(&y);
        if rest <= DEPENDENT * start {
            return false;
        }
        y.iter_mut().for_each(|y| *y /= rest);
        self.mass_x.push(self.matrices.mass_times(&y));
        self.stiffness_x.push(self.matrices.stiffness_times(&y));
        self.x.push(y);
        true
    }

    /// The `count` vectors of lowest curvature in the span, with it.
    fn softest(&self, count: usize) -> Vec<(Vec<f64>, f64)> {
        let size = self.x.len();
        let inside = DMatrix::from_fn(size, size, |i, j| {
            0.5 * (dot(&self.x[i], &self.stiffness_x[j]) + dot(&self.x[j], &self.stiffness_x[i]))
        });
        let eigen = SymmetricEigen::new(inside);
        let mut order: Vec<usize> = (0..size).collect();
        order.sort_by(|&i, &j| eigen.eigenvalues[i].total_cmp(&eigen.eigenvalues[j]));
        let vector = |&i: &usize| {
            let mut x = vec![0.0; self.matrices.n];
            for (j, basis) in self.x.iter().enumerate() {
                add(&mut x, eigen.eigenvectors[(j, i)], basis);
            }
            (x, eigen.eigenvalues[i])
        };
        order.iter().take(count).map(vector).collect()
    }

    /// A vector of negative curvature, if there is one in the span.
    fn unstable(&self) -> Option<Stability> {
        let (x, _) = self.softest(1).pop()?;
        // The projection has the rounding of the stiffest vector in the basis: take the vector's own curvature.
        let curvature = dot(&self.matrices.stiffness_times(&x), &x);
        let bound = -ROUNDING * self.matrices.absolute_curvature(&x);
        (curvature < bound).then_some(Stability::Unstable { x, curvature })
    }
}

pub(super) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn add(y: &mut [f64], factor: f64, x: &[f64]) {
    for (y, x) in y.iter_mut().zip(x) {
        *y += factor * x;
    }
}
