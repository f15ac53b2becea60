//! Small undamped vibrations about an equilibrium: `[K phi_q^T; phi_q 0] x = omega^2 [M 0; 0 0] x`.
//!
//! Damping and gyroscopic forces are left out. Small problems are reduced to the null space of the constraints and
//! solved densely; large ones by block Krylov iteration on the shifted inverse with full orthogonalisation, which
//! finds multiple frequencies (rigid-body motions) up to the size of the block.

use nalgebra::{DMatrix, DVector, SymmetricEigen};

use crate::compliance::Compliance;
use crate::error::{Error, check_length};
use crate::initial::finite_or_name;
use crate::linear_solver::LinearSolver;
use crate::problem::{Point, Problem, Weights};
use crate::redundancy::leave_out_dependent;
use crate::scaling::largest;

/// Controls of the search for modes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ModeOptions {
    /// Number of modes wanted, those of the lowest `omega^2`.
    pub count: usize,
    /// Problems of up to this number of velocities are solved densely.
    pub dense_limit: usize,
    /// Relative residual of the iteration.
    pub tolerance: f64,
}

impl Default for ModeOptions {
    fn default() -> Self {
        Self { count: 10, dense_limit: 600, tolerance: 1e-10 }
    }
}

/// One mode of vibration.
#[derive(Clone, Debug, PartialEq)]
pub struct Mode {
    /// Square of the angular frequency [rad^2/s^2]: zero for rigid-body motions, negative where unstable.
    pub omega_squared: f64,
    /// Whether it grows: `omega_squared` is negative beyond rounding.
    pub unstable: bool,
    /// Shape at velocity level, length `velocities`, of modal mass 1.
    pub shape: Vec<f64>,
}

impl Mode {
    /// Frequency [Hz]; 0 where unstable.
    #[must_use]
    pub fn frequency(&self) -> f64 {
        self.omega_squared.max(0.0).sqrt() / std::f64::consts::TAU
    }

    /// Eigenvalue of larger real part, or of positive imaginary part, as (real, imaginary) [1/s]: `x ~ exp(s t)`.
    #[must_use]
    pub fn eigenvalue(&self) -> (f64, f64) {
        let rate = self.omega_squared.abs().sqrt();
        if self.omega_squared < 0.0 { (rate, 0.0) } else { (0.0, rate) }
    }
}

const STIFFNESS: Weights = Weights { mass: 0.0, damping: 0.0, stiffness: 1.0, jacobian: 0.0 };
const MASS: Weights = Weights { mass: 1.0, damping: 0.0, stiffness: 0.0, jacobian: 0.0 };
const JACOBIAN: Weights = Weights { mass: 0.0, damping: 0.0, stiffness: 0.0, jacobian: 1.0 };

/// Values of `omega^2` below this part of the largest are rounding.
const ROUNDING: f64 = 1e-13;
/// Relative size below which a direction counts as dependent, or massless.
const DEPENDENT: f64 = 1e-12;
/// Vectors iterated together: more than the six rigid-body motions.
const BLOCK: usize = 8;
/// Largest number of vectors kept by the iteration, in units of the number of modes wanted.
const LARGEST_BASIS: usize = 12;
/// Shift, as a part of the ratio of the largest stiffness and mass.
const SHIFT: f64 = 1e-10;

/// Modes about the state `(t, q, lambda_)` at rest, ascending in `omega_squared`.
///
/// # Errors
/// Wrong lengths, a singular matrix, or no convergence of the iteration.
pub fn solve_modes<P: Problem + ?Sized>(
    problem: &mut P,
    solver: &mut dyn LinearSolver,
    t: f64,
    q: &[f64],
    lambda_: &[f64],
    options: &ModeOptions,
) -> Result<Vec<Mode>, Error> {
    check_length("q", q, problem.coordinates())?;
    check_length("lambda_", lambda_, problem.multipliers())?;
    let zero = vec![0.0; problem.velocities()];
    let at = Point { t, q, v: &zero, a: &zero, lambda_ };
    leave_out_dependent(problem, t, q);
    let mut modes = if problem.velocities() <= options.dense_limit {
        dense_modes(problem, at)
    } else {
        krylov_modes(problem, solver, at, options)?
    };
    modes.sort_by(|a, b| a.omega_squared.total_cmp(&b.omega_squared));
    modes.truncate(options.count);
    Ok(modes)
}

fn element_values<P: Problem + ?Sized>(problem: &mut P, at: Point<'_>, w: Weights) -> Vec<f64> {
    let mut values = vec![0.0; problem.structure().values()];
    problem.tangent(at, w, &mut values);
    values
}

/// The whole matrix with the given weights.
fn dense_matrix<P: Problem + ?Sized>(problem: &mut P, at: Point<'_>, w: Weights) -> DMatrix<f64> {
    let values = element_values(problem, at, w);
    let structure = problem.structure();
    let mut matrix = DMatrix::zeros(structure.unknowns(), structure.unknowns());
    for e in 0..structure.elements() {
        let unknowns: Vec<usize> = structure.element_unknowns(e).collect();
        for (i, &row) in unknowns.iter().enumerate() {
            for (j, &column) in unknowns.iter().enumerate() {
                matrix[(row, column)] += structure.entry(e, unknowns.len(), i, j, &values);
            }
        }
    }
    matrix
}

fn dense_modes<P: Problem + ?Sized>(problem: &mut P, at: Point<'_>) -> Vec<Mode> {
    let (n, m) = (problem.velocities(), problem.multipliers());
    let block = |matrix: DMatrix<f64>| matrix.view((0, 0), (n, n)).into_owned();
    let mut stiffness = block(dense_matrix(problem, at, STIFFNESS));
    for (row, factor) in Compliance::new(problem, at).rows() {
        let g = DVector::from_column_slice(row);
        stiffness += *factor * &g * g.transpose();
    }
    let mass = block(dense_matrix(problem, at, MASS));
    let jacobian = dense_matrix(problem, at, JACOBIAN).view((n, 0), (m, n)).into_owned();
    let z = null_space(&jacobian);
    let (k, m) = (z.tr_mul(&(stiffness * &z)), z.tr_mul(&(mass * &z)));
    let (k, to_z) = whiten(0.5 * (&k + k.transpose()), 0.5 * (&m + m.transpose()));
    let eigen = SymmetricEigen::new(0.5 * (&k + k.transpose()));
    let shapes = z * to_z * eigen.eigenvectors;
    let rounding = ROUNDING * eigen.eigenvalues.amax();
    (0..eigen.eigenvalues.len())
        .map(|i| Mode {
            omega_squared: eigen.eigenvalues[i],
            unstable: eigen.eigenvalues[i] < -rounding,
            shape: shapes.column(i).iter().copied().collect(),
        })
        .collect()
}

/// Orthonormal columns that span the null space of a matrix of any rank.
fn null_space(jacobian: &DMatrix<f64>) -> DMatrix<f64> {
    let n = jacobian.ncols();
    if jacobian.nrows() == 0 {
        return DMatrix::identity(n, n);
    }
    let qr = jacobian.transpose().col_piv_qr();
    let r = qr.r();
    let first = r[(0, 0)].abs();
    let rank =
        (0..r.nrows().min(r.ncols())).take_while(|&i| r[(i, i)].abs() > DEPENDENT * first).count();
    let mut q = DMatrix::identity(n, n);
    qr.q_tr_mul(&mut q);
    q.rows(rank, n - rank).transpose()
}

/// Reduces `K x = omega^2 M x` to a standard problem; also returns the map from its unknowns to x. Massless
/// directions follow statically.
fn whiten(k: DMatrix<f64>, m: DMatrix<f64>) -> (DMatrix<f64>, DMatrix<f64>) {
    let n = m.nrows();
    let eigen = SymmetricEigen::new(m);
    let bound = DEPENDENT * eigen.eigenvalues.amax();
    let (heavy, massless): (Vec<usize>, Vec<usize>) =
        (0..n).partition(|&i| eigen.eigenvalues[i] > bound);
    let mut moving = eigen.eigenvectors.select_columns(&heavy);
    for (mut column, &i) in moving.column_iter_mut().zip(&heavy) {
        column /= eigen.eigenvalues[i].sqrt();
    }
    if !massless.is_empty() {
        let still = eigen.eigenvectors.select_columns(&massless);
        let coupling = still.tr_mul(&(&k * &moving));
        if let Some(follow) = still.tr_mul(&(&k * &still)).lu().solve(&coupling) {
            moving -= still * follow;
        }
    }
    (moving.tr_mul(&(k * &moving)), moving)
}

/// The inverse of `K - sigma M` on the constraints, times M.
struct ShiftedInverse<'a, P: ?Sized> {
    problem: &'a P,
    solver: &'a mut dyn LinearSolver,
    mass: Vec<f64>,
    scale: f64,
    n: usize,
    unknowns: usize,
}

impl<P: Problem + ?Sized> ShiftedInverse<'_, P> {
    fn mass_times(&self, x: &DVector<f64>) -> DVector<f64> {
        let mut padded = x.as_slice().to_vec();
        padded.resize(self.unknowns, 0.0);
        let mut y = vec![0.0; self.unknowns];
        self.problem.structure().multiply_add(&self.mass, &padded, &mut y, false);
        y.truncate(self.n);
        DVector::from_vec(y)
    }

    fn apply(&mut self, mass_x: &DVector<f64>) -> DVector<f64> {
        let mut y: Vec<f64> = mass_x.iter().map(|x| x * self.scale).collect();
        y.resize(self.unknowns, 0.0);
        self.solver.solve(&mut y);
        y.truncate(self.n);
        DVector::from_vec(y)
    }
}

fn krylov_modes<P: Problem + ?Sized>(
    problem: &mut P,
    solver: &mut dyn LinearSolver,
    at: Point<'_>,
    options: &ModeOptions,
) -> Result<Vec<Mode>, Error> {
    let (n, m) = (problem.velocities(), problem.multipliers());
    let mass = element_values(problem, at, MASS);
    let stiffest = largest(&element_values(problem, at, STIFFNESS));
    let scale = if stiffest > 0.0 { 1.0 / stiffest } else { 1.0 };
    let ratio = stiffest / largest(&mass);
    let shift = -SHIFT * ratio;
    let weights = Weights { mass: -shift * scale, damping: 0.0, stiffness: scale, jacobian: 1.0 };
    let values = element_values(problem, at, weights);
    solver
        .factor(problem.structure(), &values)
        .map_err(|e| Error::from_factor(problem, at.t, &e))?;
    let mut inverse = ShiftedInverse { problem, solver, mass, scale, n, unknowns: n + m };

    // Basis, its product with the mass, and the operator in the basis.
    let mut basis: Vec<DVector<f64>> = Vec::new();
    let mut mass_basis: Vec<DVector<f64>> = Vec::new();
    let mut images: Vec<Vec<f64>> = Vec::new();
    for j in 0..BLOCK {
        let x = DVector::from_fn(n, |i, _| ((1 + i * (2 * j + 3)) as f64 * 0.618_034).sin());
        let y = inverse.apply(&inverse.mass_times(&x));
        finite_or_name(inverse.problem, at.t, y.as_slice())?;
        extend(&inverse, &mut basis, &mut mass_basis, y);
    }
    let idle = inverse.problem.idle().iter().filter(|idle| **idle).count();
    let free = n.saturating_sub(m - idle - inverse.problem.compliant().len());
    let wanted = options.count.min(free);
    let limit = (LARGEST_BASIS * wanted + 4 * BLOCK).min(free);
    loop {
        let size = basis.len();
        for j in images.len()..size {
            let y = inverse.apply(&mass_basis[j]);
            images.push(extend(&inverse, &mut basis, &mut mass_basis, y));
        }
        let inside = DMatrix::from_fn(size, size, |i, j| images[j].get(i).copied().unwrap_or(0.0));
        let eigen = SymmetricEigen::new(0.5 * (&inside + inside.transpose()));
        let mut order: Vec<usize> = (0..size).collect();
        order.sort_by(|&i, &j| eigen.eigenvalues[j].abs().total_cmp(&eigen.eigenvalues[i].abs()));
        order.truncate(wanted);
        let error = |i: usize| {
            // The part of the operator's image that leaves the basis.
            let out: f64 = (size..basis.len())
                .map(|row| {
                    (0..size)
                        .map(|j| images[j].get(row).unwrap_or(&0.0) * eigen.eigenvectors[(j, i)])
                        .sum::<f64>()
                        .powi(2)
                })
                .sum();
            out.sqrt() / eigen.eigenvalues[i].abs()
        };
        let complete = basis.len() == size || size >= limit;
        if complete
            || size >= wanted + BLOCK && order.iter().all(|&i| error(i) <= options.tolerance)
        {
            return Ok(order
                .iter()
                .map(|&i| {
                    let omega_squared = shift + 1.0 / eigen.eigenvalues[i];
                    let mut shape = DVector::zeros(n);
                    for (j, x) in basis[..size].iter().enumerate() {
                        shape.axpy(eigen.eigenvectors[(j, i)], x, 1.0);
                    }
                    let unstable = omega_squared < -ROUNDING * ratio;
                    Mode { omega_squared, unstable, shape: shape.as_slice().to_vec() }
                })
                .collect());
        }
    }
}

/// Adds to the basis what is new in `y` (orthogonalised twice in the mass); returns all its components.
fn extend<P: Problem + ?Sized>(
    inverse: &ShiftedInverse<'_, P>,
    basis: &mut Vec<DVector<f64>>,
    mass_basis: &mut Vec<DVector<f64>>,
    mut y: DVector<f64>,
) -> Vec<f64> {
    let norm = |y: &DVector<f64>, my: &DVector<f64>| y.dot(my).max(0.0).sqrt();
    let start = norm(&y, &inverse.mass_times(&y));
    let mut components = vec![0.0; basis.len()];
    for _ in 0..2 {
        for (k, (x, mx)) in basis.iter().zip(mass_basis.iter()).enumerate() {
            let part = y.dot(mx);
            components[k] += part;
            y.axpy(-part, x, 1.0);
        }
    }
    let my = inverse.mass_times(&y);
    let rest = norm(&y, &my);
    if rest > DEPENDENT * start {
        components.push(rest);
        basis.push(y / rest);
        mass_basis.push(my / rest);
    }
    components
}
