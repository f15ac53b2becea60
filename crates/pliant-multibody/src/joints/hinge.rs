//! Hinge: two bodies share a point and an axis, `phi = (r_a - r_b, a_3.n1, a_3.n2)` (5 equations), a_3 the axis in one
//! body, n1 and n2 normal to it in the other. A line whose tangent is normal to the axis keeps it so: `t.a_3` (4).
//!
//! Jacobian: row `a.n` holds n at a and a at n. Hessian: multiplier times the identity between a and n. Minus the
//! first multipliers are the force on a; the others make up the moment normal to the axis. The freedom is the angle
//! of a against b about the axis, zero at the start.

use super::product::Products;
use super::side::{Side, coincident, turning};
use crate::freedom::Freedom;
use crate::vector::{normals, vector};
use nalgebra::Vector3;

/// Two bodies share a point and an axis.
#[must_use]
pub fn hinge(a: &Side<'_>, b: &Side<'_>, axis: Vector3<f64>) -> Option<Products> {
    let mut equations = coincident(a, b);
    equations.extend(turning(a, b, axis)?);
    Some(Products::new(equations, angle(a, b, axis)))
}

/// The angle of a against b about an axis.
pub(crate) fn angle(a: &Side<'_>, b: &Side<'_>, axis: Vector3<f64>) -> Option<Freedom> {
    let (frame, other, sign) = if b.is_frame() { (b, a, 1.0) } else { (a, b, -1.0) };
    let zero = match &other.frame {
        super::side::Frame::Line(t) => vector(t.at(other.q)).try_normalize(0.0)?,
        _ => normals(axis).0,
    };
    Some(Freedom::Angle {
        u: other.direction(zero)?,
        cosine: frame.direction(zero)?,
        sine: frame.direction(axis.cross(&zero))?,
        sign,
    })
}
