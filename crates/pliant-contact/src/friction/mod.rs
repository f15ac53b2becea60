//! Friction laws: one file each. A law turns the slip of a point in contact, its normal force and what it remembers
//! into a tangential force.
//!
//! All vectors lie in the plane of contact. The force has the sign of the slip velocity: it acts so on what is seen as
//! at rest, and against the motion on what moves.

pub mod coulomb;
pub mod lugre;

pub use coulomb::Coulomb;
pub use lugre::LuGre;

use nalgebra::{Matrix3, Vector3};

/// The motion of a point in contact over a step.
#[derive(Clone, Copy, Debug)]
pub struct Slip {
    /// What is remembered from the step before: the deflection of the bristles [m].
    pub z: Vector3<f64>,
    /// Velocity that carries the bristles through the step [m/s].
    pub mean: Vector3<f64>,
    /// Velocity at its end [m/s].
    pub end: Vector3<f64>,
    /// Normal force, or that per length [N], [N/m]: not negative.
    pub normal: f64,
    /// Length of the step [s]; 0 leaves the bristles as they are.
    pub h: f64,
}

/// What a law answers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Response {
    /// Deflection at the end of the step [m].
    pub z: Vector3<f64>,
    /// Tangential force, in the unit of the normal force.
    pub force: Vector3<f64>,
    /// Its derivative by the mean velocity.
    pub by_mean: Matrix3<f64>,
    /// Its derivative by the velocity at the end.
    pub by_end: Matrix3<f64>,
    /// Its derivative by the normal force.
    pub by_normal: Vector3<f64>,
}

impl Response {
    /// No force, and nothing to remember.
    #[must_use]
    pub fn none() -> Self {
        Self {
            z: Vector3::zeros(),
            force: Vector3::zeros(),
            by_mean: Matrix3::zeros(),
            by_end: Matrix3::zeros(),
            by_normal: Vector3::zeros(),
        }
    }
}

/// The laws there are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Friction {
    /// Bristles that bend, slip and remember.
    LuGre(LuGre),
    /// One coefficient.
    Coulomb(Coulomb),
}

impl Friction {
    /// The law's answer.
    #[must_use]
    pub fn respond(&self, slip: &Slip) -> Response {
        match self {
            Self::LuGre(law) => law.respond(slip),
            Self::Coulomb(law) => law.respond(slip),
        }
    }
}

/// A tangent vector carried along while the normal turns from `n_0` to `n` by the least rotation: it keeps its length
/// and stays tangent.
#[must_use]
pub fn transport(z: Vector3<f64>, n_0: Vector3<f64>, n: Vector3<f64>) -> Vector3<f64> {
    let sum = 1.0 + n_0.dot(&n);
    if sum > 1e-6 { z - (n_0 + n) * (n.dot(&z) / sum) } else { z - n * n.dot(&z) }
}
