//! Triangle (reduced Hsieh-Clough-Tocher): r, r_u and r_v at three corners, cubic on three inner triangles, the slope
//! normal to each edge linear along it: the tangent plane is continuous on any triangulation of a plane of parameters.
//!
//! The Bezier net of the inner triangles is linear in the nine nodal numbers (docs/theory/shell.md): it is evaluated for
//! unit vectors. Stiff as macro elements are: for corners and fillings.

use super::surface::{Jet, QuadraturePoint};

type Row = [f64; 9];
type Place = [f64; 2];

fn minus(a: Place, b: Place) -> Place {
    [a[0] - b[0], a[1] - b[1]]
}

fn dot(a: Place, b: Place) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

fn combine<const N: usize>(terms: [(f64, &Row); N]) -> Row {
    std::array::from_fn(|k| terms.iter().map(|(w, row)| w * row[k]).sum())
}

/// Area of the triangle of parameters.
pub(crate) fn area(p: &[Place; 4]) -> f64 {
    let (a, b) = (minus(p[1], p[0]), minus(p[2], p[0]));
    0.5 * (a[0] * b[1] - a[1] * b[0])
}

/// Control points of a cubic on a triangle by exponents (i, j, k), and what they are of the nodal numbers.
type Net = [([i32; 3], Row); 10];

/// Bezier nets of the three inner triangles; the one opposite to corner k has the corners (k + 1, k + 2, centroid).
fn nets(p: &[Place; 4]) -> [Net; 3] {
    let center: Place = [0, 1].map(|c| (p[0][c] + p[1][c] + p[2][c]) / 3.0);
    let position = |i: usize| -> Row { std::array::from_fn(|k| f64::from(u8::from(k == 3 * i))) };
    // r_i + D_i(t)/3
    let along = |i: usize, t: Place| -> Row {
        let mut row = position(i);
        row[3 * i + 1] = t[0] / 3.0;
        row[3 * i + 2] = t[1] / 3.0;
        row
    };
    let r: [Row; 3] = std::array::from_fn(position);
    let b = |i: usize, j: usize| along(i, minus(p[j], p[i]));
    let c: [Row; 3] = std::array::from_fn(|i| along(i, minus(center, p[i])));
    // Of the edge opposite to k.
    let m: [Row; 3] = std::array::from_fn(|k| {
        let (i, j) = ((k + 1) % 3, (k + 2) % 3);
        let edge = minus(p[j], p[i]);
        let th = dot(minus(center, p[i]), edge) / dot(edge, edge);
        let (b_ij, b_ji) = (b(i, j), b(j, i));
        combine([
            (1.0 - th, &b_ij),
            (th, &b_ji),
            (0.5, &c[i]),
            (0.5, &c[j]),
            (-0.5 * (1.0 - th), &r[i]),
            (-0.5 * (1.0 - th), &b_ji),
            (-0.5 * th, &b_ij),
            (-0.5 * th, &r[j]),
        ])
    });
    let third = 1.0 / 3.0;
    let d: [Row; 3] = std::array::from_fn(|i| {
        combine([(third, &c[i]), (third, &m[(i + 1) % 3]), (third, &m[(i + 2) % 3])])
    });
    let s = combine([(third, &d[0]), (third, &d[1]), (third, &d[2])]);
    std::array::from_fn(|k| {
        let (i, j) = ((k + 1) % 3, (k + 2) % 3);
        [
            ([3, 0, 0], r[i]),
            ([2, 1, 0], b(i, j)),
            ([1, 2, 0], b(j, i)),
            ([0, 3, 0], r[j]),
            ([2, 0, 1], c[i]),
            ([1, 1, 1], m[k]),
            ([0, 2, 1], c[j]),
            ([1, 0, 2], d[i]),
            ([0, 1, 2], d[j]),
            ([0, 0, 3], s),
        ]
    })
}

/// Shape functions at the weights (x, y) of corners 1 and 2.
pub(crate) fn shape(p: &[Place; 4], [x, y]: [f64; 2]) -> Vec<Jet> {
    let weights = [1.0 - x - y, x, y];
    // The inner triangle opposite to the corner with the least weight holds the point.
    let k = (0..3).fold(0, |best, i| if weights[i] < weights[best] { i } else { best });
    let (i, j) = ((k + 1) % 3, (k + 2) % 3);
    // Area coordinates in the inner triangle: the centroid takes three times the least weight.
    let l = [weights[i] - weights[k], weights[j] - weights[k], 3.0 * weights[k]];
    let center: Place = [0, 1].map(|c| (p[0][c] + p[1][c] + p[2][c]) / 3.0);
    let q = [p[i], p[j], center];
    let twice = {
        let (a, b) = (minus(q[1], q[0]), minus(q[2], q[0]));
        a[0] * b[1] - a[1] * b[0]
    };
    // Gradients of the area coordinates.
    let g: [Place; 3] = std::array::from_fn(|a| {
        let e = minus(q[(a + 2) % 3], q[(a + 1) % 3]);
        [-e[1] / twice, e[0] / twice]
    });
    let mut jets = vec![Jet::default(); 9];
    for (powers, row) in &nets(p)[k] {
        let jet = bernstein(*powers, l, g);
        for (out, w) in jets.iter_mut().zip(row) {
            out.value += w * jet.value;
            out.u += w * jet.u;
            out.v += w * jet.v;
            out.uu += w * jet.uu;
            out.vv += w * jet.vv;
            out.uv += w * jet.uv;
        }
    }
    jets
}

/// `6/(i! j! k!) l^(i, j, k)` with its derivatives.
fn bernstein(powers: [i32; 3], l: [f64; 3], g: [Place; 3]) -> Jet {
    let factorial = |n: i32| (1..=n).product::<i32>();
    let scale = 6.0 / f64::from(powers.iter().map(|&n| factorial(n)).product::<i32>());
    let power = |x: f64, n: i32| if n < 0 { 0.0 } else { x.powi(n) };
    let term = |down: [i32; 3]| -> f64 {
        (0..3)
            .map(|a| {
                let (n, d) = (powers[a], down[a]);
                let falling: i32 = (0..d).map(|s| n - s).product();
                f64::from(falling) * power(l[a], n - d)
            })
            .product()
    };
    let unit = |a: usize| -> [i32; 3] { std::array::from_fn(|b| i32::from(a == b)) };
    let mut jet = Jet { value: scale * term([0; 3]), ..Jet::default() };
    for a in 0..3 {
        let first = scale * term(unit(a));
        jet.u += first * g[a][0];
        jet.v += first * g[a][1];
        for b in 0..3 {
            let (ua, ub) = (unit(a), unit(b));
            let second = scale * term(std::array::from_fn(|c| ua[c] + ub[c]));
            jet.uu += second * g[a][0] * g[b][0];
            jet.vv += second * g[a][1] * g[b][1];
            jet.uv += second * g[a][0] * g[b][1];
        }
    }
    jet
}

/// A rule of symmetric orbits (a, a, 1 - 2 a) on each inner triangle, weights of an orbit's points.
fn inner(orbits: &[(f64, f64)], pairs: &[(f64, f64, f64)]) -> Vec<QuadraturePoint> {
    let mut local: Vec<([f64; 3], f64)> = Vec::new();
    for &(a, w) in orbits {
        for k in 0..3 {
            let mut l = [a; 3];
            l[k] = 1.0 - 2.0 * a;
            local.push((l, w));
        }
    }
    for &(a, b, w) in pairs {
        let c = 1.0 - a - b;
        for l in [[a, b, c], [b, a, c], [a, c, b], [c, a, b], [b, c, a], [c, b, a]] {
            local.push((l, w));
        }
    }
    let mut rule = Vec::with_capacity(3 * local.len());
    for k in 0..3 {
        let (i, j) = ((k + 1) % 3, (k + 2) % 3);
        for (l, w) in &local {
            let mut weights = [l[2] / 3.0; 3];
            weights[i] += l[0];
            weights[j] += l[1];
            let w = w / 3.0;
            rule.push(QuadraturePoint { at: [weights[1], weights[2]], membrane: w, bending: w });
        }
    }
    rule
}

/// Six points of degree 4 on each inner triangle.
pub(crate) fn rule() -> Vec<QuadraturePoint> {
    inner(
        &[
            (0.445_948_490_915_965, 0.223_381_589_678_011),
            (0.091_576_213_509_771, 0.109_951_743_655_322),
        ],
        &[],
    )
}

/// Three points of degree 2 on each inner triangle: exact for bending of flat elements.
pub(crate) fn reduced_rule() -> Vec<QuadraturePoint> {
    inner(&[(1.0 / 6.0, 1.0 / 3.0)], &[])
}

/// Twelve points of degree 6 on each inner triangle.
pub(crate) fn mass_rule() -> Vec<QuadraturePoint> {
    inner(
        &[
            (0.063_089_014_491_502, 0.050_844_906_370_207),
            (0.249_286_745_170_910, 0.116_786_275_726_379),
        ],
        &[(0.310_352_451_033_785, 0.053_145_049_844_816, 0.082_851_075_618_374)],
    )
}
