//! Pin: two points coincide, `phi = r_a - r_b` (3 equations). The Jacobian is constant, the Hessian zero. The
//! multiplier is the force on b, and minus that on a.

use super::product::Products;
use super::side::{Side, coincident};

/// Two points coincide.
#[must_use]
pub fn pin(a: &Side<'_>, b: &Side<'_>) -> Products {
    Products::new(coincident(a, b), None)
}
