//! Slider: two bodies keep their orientation to each other and slide along an axis, `phi = (d.n1, d.n2, a_1.b_2,
//! a_2.b_3, a_3.b_1)` (5 equations; of a line `(d.n1, d.n2, t.m1, t.m2)`, 4), d = r_a - r_b, n1 and n2 normal to the
//! axis in b (in a where b is a line).
//!
//! Jacobian: row `d.n` holds n at the points and d at n. Hessian: multiplier times the identity between d and n.
//! Minus the first two multipliers are the force on a along the normals. The freedom is d along the axis.

use super::product::{Product, Products};
use super::side::{Side, gap, locked};
use crate::freedom::Freedom;
use crate::vector::normals;
use nalgebra::Vector3;

/// Two bodies slide along an axis.
#[must_use]
pub fn slider(a: &Side<'_>, b: &Side<'_>, axis: Vector3<f64>) -> Option<Products> {
    let mut equations = along(a, b, axis)?;
    equations.extend(locked(a, b)?);
    Some(Products::new(equations, travel(a, b, axis)))
}

/// `d.n1 = d.n2 = 0`: the point of a stays on the axis through that of b.
pub(super) fn along(a: &Side<'_>, b: &Side<'_>, axis: Vector3<f64>) -> Option<Vec<Product>> {
    let frame = if b.is_frame() { b } else { a };
    let (n1, n2) = normals(axis);
    let equation = |n| Some(Product::orthogonal(gap(a, b), frame.direction(n)?));
    [n1, n2].into_iter().map(equation).collect()
}

/// The way along the axis.
pub(super) fn travel(a: &Side<'_>, b: &Side<'_>, axis: Vector3<f64>) -> Option<Freedom> {
    let frame = if b.is_frame() { b } else { a };
    Some(Freedom::Length { u: gap(a, b), w: frame.direction(axis)? })
}
