//! Plate (Adini-Clough-Melosh): r, r_u and r_v at the four corners of a rectangle in (u, v), the incomplete quartic 1, x,
//! y, x2, xy, y2, x3, x2y, xy2, y3, x3y, xy3. Slopes across edges agree at nodes only; it passes the patch test on
//! rectangles. No twist at nodes, so that patches with turned directions may share them.

use super::surface::{CORNERS, Jet};

/// Powers of x and y of the monomials.
const POWERS: [[i32; 2]; 12] = [
    [0, 0],
    [1, 0],
    [0, 1],
    [2, 0],
    [1, 1],
    [0, 2],
    [3, 0],
    [2, 1],
    [1, 2],
    [0, 3],
    [3, 1],
    [1, 3],
];

/// x^p with two derivatives.
fn power(x: f64, p: i32) -> [f64; 3] {
    let p_f = f64::from(p);
    [
        x.powi(p),
        if p > 0 { p_f * x.powi(p - 1) } else { 0.0 },
        if p > 1 { p_f * (p_f - 1.0) * x.powi(p - 2) } else { 0.0 },
    ]
}

/// Shape functions: the monomials through the inverse of their nodal values.
pub(crate) fn shape([a, b]: [f64; 2], [x, y]: [f64; 2]) -> Vec<Jet> {
    let monomial =
        |x: f64, y: f64, k: usize| Jet::product(power(x, POWERS[k][0]), power(y, POWERS[k][1]));
    // On the unit square: (N, N_x, N_y) at the corners.
    let nodal = nalgebra::SMatrix::<f64, 12, 12>::from_fn(|row, k| {
        let [i, j] = CORNERS[row / 3];
        let jet = monomial(i as f64, j as f64, k);
        [jet.value, jet.u, jet.v][row % 3]
    });
    let inverse = nodal.try_inverse().unwrap_or_default();
    (0..12)
        .map(|i| {
            let factor = [1.0, a, b][i % 3];
            let mut sum = Jet::default();
            for k in 0..12 {
                let (w, m) = (factor * inverse[(k, i)], monomial(x, y, k));
                sum.value += w * m.value;
                sum.u += w * m.u / a;
                sum.v += w * m.v / b;
                sum.uu += w * m.uu / (a * a);
                sum.vv += w * m.vv / (b * b);
                sum.uv += w * m.uv / (a * b);
            }
            sum
        })
        .collect()
}
