//! Rigidity: the three axes of a rigid body stay orthonormal, `phi = ((e_i.e_i - 1) / 2, e_1.e_2, e_2.e_3, e_3.e_1)`
//! (6 equations).
//!
//! Jacobian: row ii holds e_i at e_i, row ij holds e_j at e_i and e_i at e_j. Hessian: the symmetric matrix of the
//! multipliers, times the identity of space. The multipliers are minus the stresses, integrated over the body.

use super::arm::{Arm, Role};
use super::product::{Product, Products};
use crate::point::Interpolation;

/// The axes `e` stay orthonormal.
#[must_use]
pub fn rigidity(e: &[Interpolation; 3]) -> Products {
    let arm = |i: usize| Arm::new(e[i].clone(), Role::Other);
    let unit = |i| Product { u: arm(i), w: arm(i), factor: 0.5, constant: 0.5, and: None };
    let right = |i| Product::orthogonal(arm(i), arm((i + 1) % 3));
    Products::new((0..3).map(unit).chain((0..3).map(right)).collect(), None)
}
