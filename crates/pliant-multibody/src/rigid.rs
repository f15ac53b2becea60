//! Rigid bodies as reference nodes: the centre of mass r and three axes `e_i`, kept orthonormal by the constraints of
//! [`crate::joints::rigidity`].
//!
//! With the Euler tensor `J = tr(I)/2 E - I` the kinetic energy is `m r'.r'/2 + sum_ij J_ij e_i'.e_j'/2`: the mass
//! matrix is constant, and there are no Coriolis terms (García de Jalón & Bayo 1994, section 4.2.2).

use crate::vector::vector;
use nalgebra::{Matrix3, Vector3};

/// A rigid body.
#[derive(Clone, Debug)]
pub struct RigidBody {
    /// Mass [kg].
    pub mass: f64,
    /// Euler tensor about the centre of mass in body axes [kg m^2].
    pub euler: Matrix3<f64>,
    /// Offset of its 12 coordinates.
    pub first: usize,
    /// Its element matrix.
    pub element: usize,
}

impl RigidBody {
    /// The Euler tensor of an inertia tensor.
    #[must_use]
    pub fn euler_tensor(inertia: &Matrix3<f64>) -> Matrix3<f64> {
        Matrix3::from_diagonal_element(0.5 * inertia.trace()) - inertia
    }

    /// Entry (i, j) of the mass matrix between the vectors (r, e1, e2, e3), each times the identity of space.
    #[must_use]
    pub fn weight(&self, i: usize, j: usize) -> f64 {
        match (i, j) {
            (0, 0) => self.mass,
            (0, _) | (_, 0) => 0.0,
            _ => self.euler[(i - 1, j - 1)],
        }
    }

    /// Vector `i` of (r, e1, e2, e3).
    fn vector(&self, i: usize, q: &[f64]) -> Vector3<f64> {
        let at = self.first + 3 * i;
        Vector3::new(q[at], q[at + 1], q[at + 2])
    }

    /// The mass matrix times `v`, vector `i`.
    fn momentum_of(&self, i: usize, v: &[f64]) -> Vector3<f64> {
        (0..4).map(|j| self.vector(j, v) * self.weight(i, j)).sum()
    }

    /// Adds inertia and weight, `M a - m g`.
    pub fn add_residual(&self, a: &[f64], gravity: [f64; 3], force: &mut [f64]) {
        for i in 0..4 {
            let mut f = self.momentum_of(i, a);
            if i == 0 {
                f -= vector(gravity) * self.mass;
            }
            for k in 0..3 {
                force[self.first + 3 * i + k] += f[k];
            }
        }
    }

    /// Kinetic energy [J].
    #[must_use]
    pub fn kinetic_energy(&self, v: &[f64]) -> f64 {
        (0..4).map(|i| 0.5 * self.vector(i, v).dot(&self.momentum_of(i, v))).sum()
    }

    /// Energy in a field of gravity, zero at the origin [J].
    #[must_use]
    pub fn gravitational_energy(&self, q: &[f64], gravity: [f64; 3]) -> f64 {
        -self.mass * self.vector(0, q).dot(&vector(gravity))
    }

    /// Linear momentum [kg m/s] and angular momentum about the origin [kg m^2/s].
    #[must_use]
    pub fn momentum(&self, q: &[f64], v: &[f64]) -> (Vector3<f64>, Vector3<f64>) {
        let angular = (0..4).map(|i| self.vector(i, q).cross(&self.momentum_of(i, v))).sum();
        (self.momentum_of(0, v), angular)
    }

    /// First moment of mass about the origin [kg m].
    #[must_use]
    pub fn first_moment(&self, q: &[f64]) -> Vector3<f64> {
        self.vector(0, q) * self.mass
    }
}
