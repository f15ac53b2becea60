//! Membranes: positions at the corners of quadrilaterals (bilinear) and triangles (linear), no bending. They conform with
//! each other along edges, and every edge may fold. Their parameters are those of the unit square and triangle.

use super::surface::{CORNERS, Jet, QuadraturePoint, linear};

/// Bilinear functions.
pub(crate) fn quad([x, y]: [f64; 2]) -> Vec<Jet> {
    let (u, v) = (linear(x, 1.0), linear(y, 1.0));
    CORNERS.iter().map(|&[i, j]| Jet::product(u[i], v[j])).collect()
}

/// Linear functions: area coordinates.
pub(crate) fn triangle([x, y]: [f64; 2]) -> Vec<Jet> {
    let jet = |value, u, v| Jet { value, u, v, ..Jet::default() };
    vec![jet(1.0 - x - y, -1.0, -1.0), jet(x, 1.0, 0.0), jet(y, 0.0, 1.0)]
}

/// One point: the strain is constant.
pub(crate) fn triangle_rule() -> Vec<QuadraturePoint> {
    vec![QuadraturePoint { at: [1.0 / 3.0, 1.0 / 3.0], membrane: 1.0, bending: 1.0 }]
}

/// Three points, exact to degree 2.
pub(crate) fn triangle_mass_rule() -> Vec<QuadraturePoint> {
    let third = 1.0 / 3.0;
    [[1.0 / 6.0, 1.0 / 6.0], [4.0 / 6.0, 1.0 / 6.0], [1.0 / 6.0, 4.0 / 6.0]]
        .map(|at| QuadraturePoint { at, membrane: third, bending: third })
        .to_vec()
}
