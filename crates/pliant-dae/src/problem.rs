//! What a problem must offer to be integrated, brought to rest, or linearised.
//!
//! `M(q) a + f(t, q, v) + phi_q^T lambda_ = 0`, `phi(t, q) = 0`, with all forces collected in `f`.
//! Positions `q` may have more coordinates than there are velocities (quaternions): positions are moved only by
//! [`Problem::retract`], and everything else lives in the space of velocities.

use crate::structure::Structure;

/// A point of evaluation.
#[derive(Clone, Copy, Debug)]
pub struct Point<'a> {
    /// Time [s], or the load factor in statics.
    pub t: f64,
    /// Coordinates, length [`Problem::coordinates`].
    pub q: &'a [f64],
    /// Velocities, length [`Problem::velocities`].
    pub v: &'a [f64],
    /// Accelerations, length [`Problem::velocities`].
    pub a: &'a [f64],
    /// Multipliers, length [`Problem::multipliers`].
    pub lambda_: &'a [f64],
}

/// Weights of the parts of the iteration matrix
/// `[mass M + damping df/dv + stiffness (df/dq + (phi_q^T lambda_)_q), jacobian phi_q^T; jacobian phi_q, 0]`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Weights {
    /// Factor of the mass matrix.
    pub mass: f64,
    /// Factor of the damping matrix.
    pub damping: f64,
    /// Factor of the stiffness matrix.
    pub stiffness: f64,
    /// Factor of the constraint Jacobian: 1, or 0 to leave the multipliers' rows empty.
    pub jacobian: f64,
}

/// How often the slope of forces jumps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kinks {
    /// Nowhere.
    None,
    /// Now and then, as where bodies begin to touch.
    Few,
    /// At many places, as in bodies whose parts pull but do not push: steps take many iterations, none in vain.
    Many,
}

/// An evaluation failed: the state is outside the domain of the model (or an input could not be evaluated).
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{message}")]
pub struct EvaluationError {
    /// What happened, with the numbers.
    pub message: String,
    /// Whether a smaller step may help (not for a failing user callback, say).
    pub recoverable: bool,
}

/// A problem in the form above. Methods take `&mut self` only for scratch memory: equal points give equal bits.
pub trait Problem: Send {
    /// Number of coordinates `q`.
    fn coordinates(&self) -> usize;
    /// Number of velocities `v`.
    fn velocities(&self) -> usize;
    /// Number of multipliers.
    fn multipliers(&self) -> usize;
    /// Sparsity of the iteration matrix.
    fn structure(&self) -> &Structure;
    /// Typical size of an increment of each velocity-level coordinate (a length for positions, 1 for slopes and
    /// rotations), length `velocities`: makes norms of increments dimensionless.
    fn scale(&self) -> &[f64];
    /// Size of an error of each velocity-level coordinate that counts as much as one of the model's size, for the
    /// control of steps. By default [`Self::scale`].
    fn error_scale(&self) -> Vec<f64> {
        self.scale().to_vec()
    }

    /// Typical size of each constraint's residual, length `multipliers`.
    fn constraint_scale(&self) -> &[f64];

    /// `out = q` moved by `increment` (length `velocities`). The default is `q + increment`.
    fn retract(&self, q: &[f64], increment: &[f64], out: &mut [f64]) {
        for ((o, q), d) in out.iter_mut().zip(q).zip(increment) {
            *o = q + d;
        }
    }

    /// Whether `retract` is the plain sum and coordinates are velocities' integrals.
    fn is_flat(&self) -> bool {
        true
    }

    /// `out = [v, w]`, the commutator of two velocities where `retract` is not commutative: `v x w` for angular
    /// velocities in the body's own frame, zero on vector spaces. It enters the local error of the positions.
    fn commutator(&self, v: &[f64], w: &[f64], out: &mut [f64]) {
        let _ = (v, w);
        out.fill(0.0);
    }

    /// Whether forces depend on velocities (else the integrator leaves `v` stale inside Newton).
    fn has_damping(&self) -> bool;

    /// Whether forces at rest derive from a potential (not those that turn with the motion): only then do minima of
    /// the energy tell which equilibria are stable.
    fn has_potential(&self) -> bool {
        true
    }

    /// Kinks of the forces: steps of Newton's iteration that go too far are shortened where there are any.
    fn kinks(&self) -> Kinks {
        Kinks::None
    }

    /// `force = M a + f + phi_q^T lambda_`, `phi`; both overwritten.
    ///
    /// # Errors
    /// [`EvaluationError`] where the model cannot be evaluated.
    fn residual(
        &mut self,
        at: Point<'_>,
        force: &mut [f64],
        phi: &mut [f64],
    ) -> Result<(), EvaluationError>;

    /// Element matrices of the iteration matrix, written to `values`.
    ///
    /// The structure may change here, and only here, with what is coupled at this point: `values` is left with its
    /// length, `structure().values()`, then.
    fn tangent(&mut self, at: Point<'_>, weights: Weights, values: &mut Vec<f64>);

    /// Judges a step that has converged, before it is accepted: refused, it is tried again in smaller ones. `part` is
    /// its part of the nominal step, which cannot be cut for ever; 0 where there is none.
    ///
    /// # Errors
    /// [`EvaluationError`] saying what is wrong with it.
    fn judge(
        &mut self,
        before: Point<'_>,
        after: Point<'_>,
        part: f64,
    ) -> Result<(), EvaluationError> {
        let _ = (before, after, part);
        Ok(())
    }

    /// Part of an increment from `q`, at most 1, that a search for equilibria may go, and what is in its way beyond. A
    /// motion takes it there, or not at all: bodies do not pass through each other, and iterates that jump over one
    /// never feel it.
    fn way(&mut self, q: &[f64], increment: &[f64]) -> (f64, Option<String>) {
        let _ = (q, increment);
        (1.0, None)
    }

    /// Whether [`Self::predicted_tangent`] differs from [`Self::tangent`].
    fn predicts(&self) -> bool {
        false
    }

    /// The tangent at rest with the geometric stiffness of predicted forces, those of the linearisation one increment
    /// ago: `at.v` holds the increment of the coordinates since then, and the weight of damping is 0.
    fn predicted_tangent(&mut self, at: Point<'_>, weights: Weights, values: &mut Vec<f64>) {
        self.tangent(at, weights, values);
    }

    /// What is left of the second time derivative of `phi` at a = 0:
    /// `out = (phi_q v)_q v + 2 phi_qt v + phi_tt`.
    fn constraint_acceleration(&mut self, at: Point<'_>, out: &mut [f64]);

    /// What is left of the third time derivative of `phi` at zero jerk:
    /// `out = 3 phi_qq(v, a) + phi_qqq(v, v, v) + mixed time terms + phi_ttt`.
    fn constraint_jerk(&mut self, at: Point<'_>, out: &mut [f64]);

    /// `out = phi_t`, the rate of the constraints at v = 0.
    fn constraint_rate(&mut self, t: f64, q: &[f64], out: &mut [f64]) {
        let _ = (t, q);
        out.fill(0.0);
    }

    /// Which equations read `lambda_ = 0` at present instead of `phi = 0`, those left out by [`Self::leave_out`] or for
    /// reasons of the problem's own: `phi`, `phi_q` and the derivatives of `phi` are zero there, the diagonal of the
    /// iteration matrix is minus the weight of the Jacobian. Length `multipliers`, or empty: none.
    fn idle(&self) -> &[bool] {
        &[]
    }

    /// Multipliers whose equations are compliant: `phi(t, q, lambda_) = 0` determines `lambda_` where the coordinates
    /// are given (the pressure of an enclosed gas). Their diagonal in the iteration matrix is `jacobian / stiffness`
    /// times `dphi/dlambda_`. They say nothing about velocities and accelerations: with a stiffness of zero
    /// `phi_q` is zero there and the diagonal is minus the weight of the Jacobian.
    fn compliant(&self) -> &[usize] {
        &[]
    }

    /// Writes the multipliers that coordinates determine, see [`Self::compliant`].
    fn determine(&mut self, t: f64, q: &[f64], lambda_: &mut [f64]) {
        let _ = (t, q, lambda_);
    }

    /// Makes equations idle that follow from others, and no others (length `multipliers`, or empty: none).
    fn leave_out(&mut self, equations: &[bool]) {
        let _ = equations;
    }

    /// Order in which equations are kept where some follow from others.
    fn constraint_order(&self) -> Vec<usize> {
        (0..self.multipliers()).collect()
    }

    /// What a constraint belongs to, for messages.
    fn owner(&self, multiplier: usize) -> String {
        self.describe(self.velocities() + multiplier)
    }

    /// A step was accepted: commit internal variables, gather integrals over time.
    fn accept(&mut self, before: Point<'_>, after: Point<'_>) {
        let _ = (before, after);
    }

    /// An equilibrium was found, from which the search goes on.
    fn equilibrium(&mut self, at: Point<'_>) {
        let _ = at;
    }

    /// Number of parameters whose sensitivities can be asked for.
    fn parameters(&self) -> usize {
        0
    }

    /// Derivative of the residual by parameter `p`: `force` (length `velocities`) and `phi` overwritten.
    fn parameter_derivative(
        &mut self,
        at: Point<'_>,
        p: usize,
        force: &mut [f64],
        phi: &mut [f64],
    ) {
        let _ = (at, p);
        force.fill(0.0);
        phi.fill(0.0);
    }

    /// Name of an unknown for messages: which body, node and component.
    fn describe(&self, unknown: usize) -> String {
        format!("unknown {unknown}")
    }
}
