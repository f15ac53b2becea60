//! One face for all factorisations: analysed once per structure, factorised often, solved oftener.

use crate::condensation::Condensed;
use crate::dense::Dense;
use crate::sparse::Sparse;
use crate::structure::{Structure, entries};

/// Why a factorisation failed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum FactorError {
    /// A pivot vanished (or is not finite) at this unknown.
    #[error("the iteration matrix is singular at unknown {unknown}")]
    Singular {
        /// Number of the unknown.
        unknown: usize,
    },
    /// The matrix holds a number that is not finite, in this element.
    #[error("the iteration matrix is not finite in element {element}")]
    NotFinite {
        /// Number of the element.
        element: usize,
    },
    /// The factors do not fit into memory.
    #[error("the factors of {unknowns} unknowns do not fit into memory")]
    TooLarge {
        /// Number of unknowns.
        unknowns: usize,
    },
}

/// A direct solver of `A x = b`, A being the sum of the element matrices of a [`Structure`].
pub trait LinearSolver: Send {
    /// Factorises A. On failure the previous factorisation is lost.
    ///
    /// # Errors
    /// [`FactorError`] if A is singular to working precision or not finite.
    fn factor(&mut self, structure: &Structure, values: &[f64]) -> Result<(), FactorError>;

    /// Overwrites `x` (right-hand side, one number for each unknown) by the solution.
    fn solve(&mut self, x: &mut [f64]);

    /// The same without refinement, where the factors allow it: for corrections inside an iteration that computes its
    /// own residuals.
    fn correct(&mut self, x: &mut [f64]) {
        self.solve(x);
    }

    /// Number of negative eigenvalues of A, where it is symmetric and its factors tell.
    fn negative_eigenvalues(&self) -> Option<usize> {
        None
    }

    /// The same with the transpose of A.
    fn solve_transposed(&mut self, x: &mut [f64]);

    /// Estimated cost of a factorisation, with its tangent, in units of one Newton iteration without it.
    fn factor_cost(&self) -> f64;

    /// A line for statistics: which back end, sizes of its parts.
    fn describe(&self) -> String;
}

/// How [`analyze`] chooses.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Options {
    /// Eliminate chains of nodes first.
    pub condense: bool,
    /// Use rayon's threads. Results have the same bits for any number of threads, and without them.
    pub parallel: bool,
    /// Systems of up to this number of unknowns are dense.
    pub dense_limit: usize,
}

impl Default for Options {
    fn default() -> Self {
        Self { condense: true, parallel: true, dense_limit: 240 }
    }
}

/// Chooses and prepares the solver for matrices of this structure.
///
/// # Errors
/// [`FactorError::TooLarge`] if the symbolic analysis runs out of memory or index range.
pub fn analyze(
    structure: &Structure,
    options: Options,
) -> Result<Box<dyn LinearSolver>, FactorError> {
    let solver = choose(structure, options)?;
    Ok(Box::new(Following { solver, options, version: structure.version() }))
}

/// A solver that is analysed anew whenever its structure has changed.
struct Following {
    solver: Box<dyn LinearSolver>,
    options: Options,
    version: u64,
}

impl LinearSolver for Following {
    fn factor(&mut self, structure: &Structure, values: &[f64]) -> Result<(), FactorError> {
        if structure.version() != self.version {
            self.solver = choose(structure, self.options)?;
            self.version = structure.version();
        }
        self.solver.factor(structure, values)
    }

    fn solve(&mut self, x: &mut [f64]) {
        self.solver.solve(x);
    }

    fn correct(&mut self, x: &mut [f64]) {
        self.solver.correct(x);
    }

    fn negative_eigenvalues(&self) -> Option<usize> {
        self.solver.negative_eigenvalues()
    }

    fn solve_transposed(&mut self, x: &mut [f64]) {
        self.solver.solve_transposed(x);
    }

    fn factor_cost(&self) -> f64 {
        self.solver.factor_cost()
    }

    fn describe(&self) -> String {
        self.solver.describe()
    }
}

/// The back end for a structure.
pub(crate) fn choose(
    structure: &Structure,
    options: Options,
) -> Result<Box<dyn LinearSolver>, FactorError> {
    if options.condense
        && let Some(condensed) = Condensed::new(structure, options)?
    {
        return Ok(Box::new(condensed));
    }
    if structure.unknowns() <= options.dense_limit {
        return Ok(Box::new(Dense::new(structure)));
    }
    Ok(Box::new(Sparse::new(structure)?))
}

/// The first element whose matrix holds a number that is not finite.
pub(crate) fn non_finite_element(structure: &Structure, values: &[f64]) -> Option<usize> {
    (0..structure.elements()).find(|&e| {
        let slot = structure.slot(e);
        let count = entries(structure.element_unknowns(e).count(), slot.storage);
        (0..count).any(|k| !values[slot.base + k * slot.stride].is_finite())
    })
}
