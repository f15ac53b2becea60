//! Weld: two bodies move as one at a point, `phi = (r_a - r_b, a_1.b_2, a_2.b_3, a_3.b_1)` (6 equations), axes that
//! coincide at the start. Where one side is a line, `(r_a - r_b, t.n1, t.n2)` (5): a line has no twist.
//!
//! Jacobian: `r_a - r_b` linear, row `a_i.b_j` holds b_j at a_i and a_i at b_j. Hessian: multiplier times the
//! identity between a_i and b_j. Minus the first multipliers are the force on a; each other one is a moment
//! `lambda_ b_j x a_i` on a.

use super::product::Products;
use super::side::{Side, coincident, locked};

/// Two bodies move as one.
#[must_use]
pub fn weld(a: &Side<'_>, b: &Side<'_>) -> Option<Products> {
    let mut equations = coincident(a, b);
    equations.extend(locked(a, b)?);
    Some(Products::new(equations, None))
}
