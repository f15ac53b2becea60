//! Clamp of a line to the world: `phi = (r - r_0, t.n1, t.n2)` (5 equations), t the tangent dr/ds; of a rigid body: a
//! weld to the world. Constant Jacobian, zero Hessian.
//!
//! The length of t stays free: fixing it would impose the stress-free stretch at the clamp. The first three
//! multipliers are minus the force on the body, the others minus a force on its directions along the normals.

use super::arm::{Arm, Role};
use super::product::{Product, Products};
use super::side::{Frame, Side, coincident};
use super::weld::weld;
use crate::vector::{normals, vector};
use nalgebra::Vector3;

/// Position and directions are fixed where `world` is; the tangent of a line along `direction`, or as at the start.
#[must_use]
pub fn clamp(a: &Side<'_>, world: &Side<'_>, direction: Option<Vector3<f64>>) -> Option<Products> {
    let Frame::Line(t) = &a.frame else { return weld(a, world) };
    let along = direction.unwrap_or_else(|| vector(t.at(a.q))).try_normalize(0.0)?;
    let (n1, n2) = normals(along);
    let tangent = || Arm::new(t.clone(), Role::OfFirst);
    let mut equations = coincident(a, world);
    equations.extend([n1, n2].map(|n| Product::orthogonal(tangent(), Arm::fixed(n.into()))));
    Some(Products::new(equations, None))
}
