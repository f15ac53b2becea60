//! Sliding along a straight line: a point stays on it and turns as it likes, `phi = (d.n1, d.n2)` (2 equations),
//! d = r_a - r_b, n1 and n2 normal to the line, with which they turn.
//!
//! Jacobian: row `d.n` holds n at the points and d at n. Hessian: multiplier times the identity between d and n.
//! Minus the multipliers are the force on a along the normals. The freedom is d along the line.

use super::product::Products;
use super::side::Side;
use super::slider::{along, travel};
use nalgebra::Vector3;

/// A point slides along a line through the point of b.
#[must_use]
pub fn slide_line(a: &Side<'_>, b: &Side<'_>, axis: Vector3<f64>) -> Option<Products> {
    Some(Products::new(along(a, b, axis)?, travel(a, b, axis)))
}
