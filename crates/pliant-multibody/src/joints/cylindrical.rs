//! Cylindrical joint: two bodies slide along an axis and turn about it, `phi = (d.n1, d.n2, a_3.n1, a_3.n2)`
//! (4 equations), d = r_a - r_b, a_3 the axis in one body, n1 and n2 normal to it in the other.
//!
//! Jacobian: row `d.n` holds n at the points and d at n, row `a.n` n at a and a at n. Hessian: multiplier times the
//! identity between the two vectors of a row. Minus the first two multipliers are the force on a along the normals.

use super::product::Products;
use super::side::{Side, parallel};
use super::slider::along;
use nalgebra::Vector3;

/// Two bodies slide along an axis and turn about it.
#[must_use]
pub fn cylindrical(a: &Side<'_>, b: &Side<'_>, axis: Vector3<f64>) -> Option<Products> {
    let mut equations = along(a, b, axis)?;
    equations.extend(parallel(a, b, axis)?);
    Some(Products::new(equations, None))
}
