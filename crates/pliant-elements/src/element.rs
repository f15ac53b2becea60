//! What a block of elements is: the face that assembly sees.
//!
//! An element is a set of pure functions of its nodal coordinates: energy, force, tangent, mass. Elements of one kind
//! and one law form a [`Block`]. Local coordinates are the nodes' coordinates in the order of the nodes.

use crate::block::ResidualRows;

/// Positions, velocities and accelerations of the whole system.
#[derive(Clone, Copy, Debug)]
pub struct Motion<'a> {
    /// Coordinates.
    pub q: &'a [f64],
    /// Velocities; read only by laws with damping and by kinetic energy and momenta.
    pub v: &'a [f64],
    /// Accelerations; read only by forces.
    pub a: &'a [f64],
}

/// Weights of the parts of a tangent: `mass M + damping df/dv + stiffness df/dq`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Weights {
    /// Factor of the mass matrix.
    pub mass: f64,
    /// Factor of the damping matrix.
    pub damping: f64,
    /// Factor of the stiffness matrix.
    pub stiffness: f64,
}

/// Place of one element matrix (lower triangle by rows) in the values of its block:
/// entry `k = i (i + 1) / 2 + j` is `values[base + k * stride]`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Slot {
    /// Index of entry 0.
    pub base: usize,
    /// Distance between consecutive entries.
    pub stride: usize,
}

/// Linear momentum [kg m/s] and angular momentum about the origin [kg m^2/s].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Momentum {
    /// Linear.
    pub linear: [f64; 3],
    /// Angular, about the origin.
    pub angular: [f64; 3],
}

/// Scratch of the residual; may be shared by blocks that are evaluated one after the other.
#[derive(Clone, Debug, Default)]
pub struct Workspace {
    pub(crate) sums: Vec<f64>,
    pub(crate) rows: Option<Box<ResidualRows>>,
    pub(crate) surface: Option<Box<crate::surface::Scratch>>,
}

/// A block of elements of one kind and one law.
///
/// Global vectors are as long as the system; a block touches its own nodes only. Results are the same bits for any
/// number of threads.
///
/// # Panics
/// All methods index the global vectors and panic where these are shorter than [`Block::extent`].
pub trait Block: Send + Sync {
    /// Name of the kind, as in [`crate::elements::KINDS`].
    fn kind(&self) -> &'static str;

    /// Number of elements that take part in the tangent's storage.
    fn element_count(&self) -> usize;

    /// One more than the largest global index the block touches.
    fn extent(&self) -> usize;

    /// Whether forces depend on velocities.
    fn has_damping(&self) -> bool;

    /// `force += M (a - g) + f(q, v)`, with the gravity g [m/s^2] acting on positions only.
    fn residual(
        &self,
        motion: Motion<'_>,
        gravity: [f64; 3],
        workspace: &mut Workspace,
        force: &mut [f64],
        parallel: bool,
    );

    /// Length of the array that [`Block::tangent`] writes.
    fn values_len(&self) -> usize;

    /// Writes the weighted element matrices to `values` (length [`Block::values_len`]), placed as [`Block::slot_of`]
    /// tells.
    fn tangent(&self, motion: Motion<'_>, weights: Weights, values: &mut [f64], parallel: bool);

    /// Whether [`Block::predicted_tangent`] differs from [`Block::tangent`].
    fn predicts(&self) -> bool {
        false
    }

    /// The tangent at rest with the geometric stiffness of predicted forces, those of the linearisation one increment
    /// ago: `motion.v` holds the increment of the coordinates since then.
    fn predicted_tangent(
        &self,
        motion: Motion<'_>,
        weights: Weights,
        values: &mut [f64],
        parallel: bool,
    ) {
        self.tangent(motion, weights, values, parallel);
    }

    /// Place of the matrix of element `e` in the values.
    fn slot_of(&self, e: usize) -> Slot;

    /// Elastic energy [J].
    fn elastic_energy(&self, q: &[f64]) -> f64;

    /// Kinetic energy [J].
    fn kinetic_energy(&self, v: &[f64]) -> f64;

    /// Energy in the gravity field g [J], zero at the origin.
    fn gravitational_energy(&self, q: &[f64], gravity: [f64; 3]) -> f64 {
        let moment = self.first_moment(q);
        -(0..3).map(|k| gravity[k] * moment[k]).sum::<f64>()
    }

    /// Power lost to damping, `v^T C v` [W].
    fn dissipation(&self, q: &[f64], v: &[f64]) -> f64;

    /// Linear and angular momentum.
    fn momentum(&self, q: &[f64], v: &[f64]) -> Momentum;

    /// Total mass [kg].
    fn mass(&self) -> f64;

    /// First moment of mass about the origin [kg m].
    fn first_moment(&self, q: &[f64]) -> [f64; 3];
}
