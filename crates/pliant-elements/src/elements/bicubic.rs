//! Bicubic shell (Bogner-Fox-Schmit): r, r_u, r_v and r_uv at the four corners of a rectangle in the parameters (u, v).
//! The surface and its tangent plane are continuous where meshes have common (u, v) directions.

use super::surface::{CORNERS, Jet, hermite};

/// Shape functions: products of cubic Hermite functions.
pub(crate) fn shape([a, b]: [f64; 2], [x, y]: [f64; 2]) -> Vec<Jet> {
    let u = hermite(x, a);
    let v = hermite(y, b);
    CORNERS
        .iter()
        .flat_map(|&[i, j]| {
            [[0, 0], [1, 0], [0, 1], [1, 1]]
                .map(|[du, dv]| Jet::product(u[2 * i + du], v[2 * j + dv]))
        })
        .collect()
}
