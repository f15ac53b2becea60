//! Universal joint: two bodies share a point, an axis of a stays normal to an axis of b, `phi = (r_a - r_b, a.b)`
//! (4 equations).
//!
//! Jacobian: row `a.b` holds b at a and a at b. Hessian: multiplier times the identity between a and b. Minus the
//! first multipliers are the force on a, the last is a moment `lambda_ b x a` on it.

use super::product::{Product, Products};
use super::side::{Side, coincident};
use nalgebra::Vector3;

/// Two bodies share a point, and an axis of each stays normal to that of the other.
#[must_use]
pub fn universal(
    a: &Side<'_>,
    b: &Side<'_>,
    axis_a: Vector3<f64>,
    axis_b: Vector3<f64>,
) -> Option<Products> {
    let mut equations = coincident(a, b);
    equations.push(Product::orthogonal(a.direction(axis_a)?, b.direction(axis_b)?));
    Some(Products::new(equations, None))
}
