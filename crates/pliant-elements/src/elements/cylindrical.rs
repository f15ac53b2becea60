//! Cylindrical shell: r and r_u at the four corners, cubic along u and linear along v. For strips, tubes and rolls that
//! bend along u: between elements that meet along u it is a hinge, so it is no plate.

use super::surface::{CORNERS, Chart, Jet, hermite, linear};

/// Shape functions: cubic Hermite functions of u times linear ones of v.
pub(crate) fn shape(chart: &Chart, [x, y]: [f64; 2]) -> Vec<Jet> {
    let u = hermite(x, chart[1][0] - chart[0][0]);
    let v = linear(y, chart[3][1] - chart[0][1]);
    CORNERS.iter().flat_map(|&[i, j]| [0, 1].map(|du| Jet::product(u[2 * i + du], v[j]))).collect()
}
