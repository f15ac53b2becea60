//! The one error type of this crate.

use crate::linear_solver::FactorError;
use crate::problem::{EvaluationError, Problem};

/// Where an iteration stood when it was given up.
#[derive(Clone, Debug, PartialEq)]
pub struct Failure {
    /// Time aimed at [s], or the load factor in statics.
    pub t: f64,
    /// Step tried [s], or the increment of the load factor.
    pub h: f64,
    /// Number of iterations done.
    pub iterations: usize,
    /// Size of the increment of each iteration, `max |dq_i| / scale_i`.
    pub increments: Vec<f64>,
    /// The unknown that moved most in the last iteration, or is not finite.
    pub unknown: usize,
    /// Its description.
    pub name: String,
}

impl Failure {
    /// Increments that a message shows: a dozen.
    #[must_use]
    pub fn last_increments(&self) -> &[f64] {
        &self.increments[self.increments.len().saturating_sub(12)..]
    }
}

/// A step whose local error is too large.
#[derive(Clone, Debug, PartialEq)]
pub struct Accuracy {
    /// Time aimed at [s].
    pub t: f64,
    /// Step tried [s].
    pub h: f64,
    /// Estimated error in units of the tolerance.
    pub estimate: f64,
    /// The unknown that errs most.
    pub unknown: usize,
    /// Its description.
    pub name: String,
}

/// Everything that can go wrong here.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Error {
    /// The spectral radius is outside [0, 1].
    #[error("spectral_radius must lie between 0 and 1, got {spectral_radius}")]
    SpectralRadius {
        /// The value refused.
        spectral_radius: f64,
    },
    /// The spectral radius is too close to 1 for a problem with constraints.
    #[error(
        "spectral_radius {spectral_radius} is refused with constraints: above 0.98 their multipliers oscillate \
         undamped and the motion gains energy without bound; take 0.9 where energy matters most, 0.8 in general, \
         0.5 to 0.6 with impacts"
    )]
    UndampedConstraints {
        /// The value refused.
        spectral_radius: f64,
    },
    /// An array has the wrong length.
    #[error("{what} must hold {expected} numbers, got {got}")]
    Length {
        /// Which array.
        what: &'static str,
        /// Length wanted.
        expected: usize,
        /// Length given.
        got: usize,
    },
    /// A number is not finite or outside its range.
    #[error("{what} must be {expected}, got {got}")]
    Value {
        /// Which number.
        what: &'static str,
        /// What is allowed.
        expected: &'static str,
        /// What was given.
        got: f64,
    },
    /// The given positions do not satisfy the constraints.
    #[error(
        "positions violate {name} at t = {t}: residual {residual:.3e} at a typical size of {scale:.3e}"
    )]
    ConstraintViolated {
        /// Time [s].
        t: f64,
        /// Number of the constraint.
        constraint: usize,
        /// Its description.
        name: String,
        /// Its residual.
        residual: f64,
        /// Its typical size.
        scale: f64,
    },
    /// Constraints that repeat each other do not agree.
    #[error("at t = {t}, {} contradict each other: there are no {what}; take one of them out", .names.join(" and "))]
    Contradictory {
        /// Time [s], or the load factor in statics.
        t: f64,
        /// What they belong to.
        names: Vec<String>,
        /// What would satisfy all of them.
        what: &'static str,
    },
    /// The iteration matrix is singular: something floats free.
    #[error(
        "at t = {t} the equations leave {name} undetermined: it floats free; hold it by a joint, a spring or a load that \
         depends on where it is"
    )]
    Singular {
        /// Time [s], or the load factor in statics.
        t: f64,
        /// The unknown that no equation determines.
        unknown: usize,
        /// Its description.
        name: String,
    },
    /// No stable equilibrium was found.
    #[error(
        "at t = {t} only unstable equilibria were found, by which {name} moves most: there may be no stable one"
    )]
    Unstable {
        /// The load factor.
        t: f64,
        /// The unknown that moves most in the unstable motion.
        unknown: usize,
        /// Its description.
        name: String,
    },
    /// The iteration did not converge.
    #[error(
        "no convergence at t = {} with a step of {} after {} iterations; {} still moves (last increments {:?})",
        .0.t, .0.h, .0.iterations, .0.name, .0.last_increments()
    )]
    NotConverged(Box<Failure>),
    /// The search for an equilibrium was held up by bodies that do not pass through each other.
    #[error(
        "at t = {} no equilibrium was found on this side of what is in the way after {} iterations: {what} \
         (last increments {:?}); take more load steps, or let the model come to rest in a simulation and start from \
         there",
        .failure.t, .failure.iterations, .failure.last_increments()
    )]
    Barred {
        /// Where the iteration stood.
        failure: Box<Failure>,
        /// What would have passed through what.
        what: String,
    },
    /// No step is short enough for the accuracy asked for.
    #[error(
        "at t = {} a step of {:.3e} s still errs by {:.3e} times the tolerance, most in {}: the motion jumps there \
         (an impact, or a load that jumps), or the tolerance is below rounding",
        .0.t, .0.h, .0.estimate, .0.name
    )]
    Accuracy(Box<Accuracy>),
    /// The path of equilibria does not lead to the load.
    #[error(
        "the path of equilibria has not come to load factor {to} after {points} points; it is at {t}"
    )]
    PathEnded {
        /// Load factor of the last point.
        t: f64,
        /// Number of points.
        points: usize,
        /// Load factor asked for.
        to: f64,
    },
    /// A force, constraint or increment is not finite.
    #[error("not finite at t = {} with a step of {}: {}", .0.t, .0.h, .0.name)]
    NotFinite(Box<Failure>),
    /// The problem could not be evaluated.
    #[error("at t = {t}: {source}")]
    Evaluation {
        /// Time [s], or the load factor in statics.
        t: f64,
        /// What the problem said.
        source: EvaluationError,
    },
    /// The linear solver refused the matrix.
    #[error("at t = {t}: {source}")]
    Solver {
        /// Time [s], or the load factor in statics.
        t: f64,
        /// What the solver said.
        source: FactorError,
    },
    /// The poll asked to stop.
    #[error("interrupted at t = {t}")]
    Interrupted {
        /// Time [s], or the load factor in statics.
        t: f64,
    },
}

impl Error {
    /// Whether a smaller step may help.
    #[must_use]
    pub fn is_recoverable(&self) -> bool {
        match self {
            Self::NotConverged(_)
            | Self::Barred { .. }
            | Self::NotFinite(_)
            | Self::Singular { .. }
            | Self::Unstable { .. } => true,
            Self::Evaluation { source, .. } => source.recoverable,
            _ => false,
        }
    }

    /// A failed factorisation, with the name of the unknown.
    pub(crate) fn from_factor<P: Problem + ?Sized>(
        problem: &P,
        t: f64,
        error: &FactorError,
    ) -> Self {
        match *error {
            FactorError::Singular { unknown } => {
                Self::Singular { t, unknown, name: problem.describe(unknown) }
            }
            FactorError::NotFinite { element } => {
                let unknown =
                    problem.structure().element_unknowns(element).next().unwrap_or_default();
                let name = problem.describe(unknown);
                Self::NotFinite(Box::new(Failure {
                    t,
                    h: 0.0,
                    iterations: 0,
                    increments: Vec::new(),
                    unknown,
                    name,
                }))
            }
            FactorError::TooLarge { .. } => Self::Solver { t, source: error.clone() },
        }
    }
}

/// Refuses an array of the wrong length.
pub(crate) fn check_length(
    what: &'static str,
    array: &[f64],
    expected: usize,
) -> Result<(), Error> {
    if array.len() == expected {
        Ok(())
    } else {
        Err(Error::Length { what, expected, got: array.len() })
    }
}
