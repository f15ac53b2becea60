//! Cylindrical shell: r and r_u at the four corners, cubic along u and linear along v. For strips, tubes and rolls that
//! bend along u: between elements that meet along u it is a hinge, so it is no plate.

use super::surface::{CORNERS, Jet, hermite, linear};

/// Shape functions: cubic Hermite functions of u times linear ones of v.
pub(crate) fn shape([a, b]: [f64; 2], [x, y]: [f64; 2]) -> Vec<Jet> {
    let u = hermite(x, a);
    let v = linear(y, b);
    CORNERS.iter().flat_map(|&[i, j]| [0, 1].map(|du| Jet::product(u[2 * i + du], v[j]))).collect()
}
