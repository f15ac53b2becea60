//! Distance: two points stay a length l apart, `phi = (d.d - l^2) / (2 l)` (1 equation), d = r_a - r_b.
//!
//! Jacobian: d/l at r_a, -d/l at r_b. Hessian: multiplier / l times the identity on (r_a, r_b), negative between them.
//! The multiplier is the tension: the force on a is `-lambda_ d / l`, towards b.

use super::product::{Product, Products};
use super::side::{Side, gap};

/// Two points stay `length` apart.
#[must_use]
pub fn distance(a: &Side<'_>, b: &Side<'_>, length: f64) -> Products {
    let equation = Product {
        factor: 0.5 / length,
        constant: 0.5 * length,
        ..Product::orthogonal(gap(a, b), gap(a, b))
    };
    Products::new(vec![equation], None)
}
