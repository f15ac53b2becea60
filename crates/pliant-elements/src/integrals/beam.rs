//! Precomputed numbers of the 24-coordinate beam: H, g0 and the mass matrix.
//!
//! Strains are rows over the 28 products g. With `h_a = dr/da` in terms of the vectors V,
//! `E_ab = (h_a^T G h_b - delta_ab)/2`; see docs/theory/beam.md for the assumed strains of [`Locking::Enhanced`].

use crate::beam::{BeamElement, BeamLaw, Locking};
use crate::elements::beam::{PRODUCTS, STIFFNESS, VECTORS, pair, place};
use nalgebra::{Matrix3, Matrix6, Vector3};
use pliant_math::quadrature::{GAUSS_3, GAUSS_5, LOBATTO_3};
use pliant_math::{Vec3, hermite};

/// Coefficients of the vectors V.
type Vector = [f64; VECTORS];
/// Coefficients of the products g.
pub(crate) type Row = [f64; PRODUCTS];
/// All numbers of an element, [`place::COUNT`] of them.
pub(crate) type Table = Vec<f64>;

/// The scalar product of two vectors as a row.
fn dot(a: &Vector, b: &Vector) -> Row {
    let mut row = [0.0; PRODUCTS];
    for i in 0..VECTORS {
        for j in 0..VECTORS {
            row[pair(i, j)] += a[i] * b[j];
        }
    }
    row
}

fn sum<const N: usize>(terms: [(f64, &Row); N]) -> Row {
    std::array::from_fn(|k| terms.iter().map(|(c, row)| c * row[k]).sum())
}

/// Unit vectors of V.
const fn unit(k: usize) -> Vector {
    let mut v = [0.0; VECTORS];
    v[k] = 1.0;
    v
}
const D: Vector = unit(0);
const X: [Vector; 2] = [unit(1), unit(4)];
const Y: [Vector; 2] = [unit(2), unit(5)];
const Z: [Vector; 2] = [unit(3), unit(6)];

/// Gradients (r,x r,y r,z) at a place, y and z over the length of the element.
fn gradients(xi: f64, y: f64, z: f64) -> [Vector; 3] {
    let d = 6.0 * xi * (1.0 - xi);
    let (n1, n2) = (1.0 - 4.0 * xi + 3.0 * xi * xi, 3.0 * xi * xi - 2.0 * xi);
    let (a, b) = (1.0 - xi, xi);
    [[d, n1, -y, -z, n2, y, z], [0.0, 0.0, a, 0.0, 0.0, b, 0.0], [0.0, 0.0, 0.0, a, 0.0, 0.0, b]]
}

/// Green-Lagrange strains (xx, yy, zz, yz, xz, xy), shears doubled, without the constant part.
fn green_lagrange(h: &[Vector; 3]) -> [Row; 6] {
    let normal = |a: usize| sum([(0.5, &dot(&h[a], &h[a]))]);
    let shear = |a: usize, b: usize| dot(&h[a], &h[b]);
    [normal(0), normal(1), normal(2), shear(1, 2), shear(0, 2), shear(0, 1)]
}

/// Strains in the middle of an element that are shown, see [`Locking::Enhanced`] for their definitions: axial,
/// shear (along y and z), twist, curvature about y and about z, each `row . (g - g0)`; `rate` is that of [`twist_rate`].
pub(crate) fn shown(length: f64, rate: f64) -> [Row; 6] {
    let middle = gradients(0.5, 0.0, 0.0);
    let axial = sum([(0.5, &dot(&middle[0], &middle[0]))]);
    let mean = |a: &[Vector; 2]| sum([(0.5, &dot(&X[0], &a[0])), (0.5, &dot(&X[1], &a[1]))]);
    let [about_z, _] = bending(&Y, length);
    let [about_y, _] = bending(&Z, length);
    [axial, mean(&Y), mean(&Z), twist(length, rate), about_y, sum([(-1.0, &about_z)])]
}

/// Mean and slope of `r'.a'` along eta for a director a (y or z): `(2 d - (x1 + x2)/2).(a2 - a1)/L`, and, of the sign of
/// `-r''.a`, `-(3 ((x1 + x2)/2 - d).(a1 + a2) + (x2 - x1).(a2 - a1)/2)/L`.
fn bending(a: &[Vector; 2], length: f64) -> [Row; 2] {
    let tangent: Vector = std::array::from_fn(|k| 2.0 * D[k] - 0.5 * (X[0][k] + X[1][k]));
    let bow: Vector = std::array::from_fn(|k| 0.5 * (X[0][k] + X[1][k]) - D[k]);
    let turn: Vector = std::array::from_fn(|k| X[1][k] - X[0][k]);
    let change: Vector = std::array::from_fn(|k| a[1][k] - a[0][k]);
    let total: Vector = std::array::from_fn(|k| a[0][k] + a[1][k]);
    let slope = sum([(-3.0 / length, &dot(&bow, &total)), (-0.5 / length, &dot(&turn, &change))]);
    [sum([(1.0 / length, &dot(&tangent, &change))]), slope]
}

/// How `(y2.z1 - y1.z2)/(2 L)` changes by torsion tau of the rest shape: sections turn by `tau L d_0` from node to node,
/// so that it is `d_0.(y2 x z1 + y1 x z2)/2`; 1 for straight elements, less for those that are curved or twisted at rest.
fn twist_rate(g_0: &[Vec3<f64>; VECTORS]) -> f64 {
    let [d, _, y_1, z_1, _, y_2, z_2] = *g_0;
    0.5 * d.dot(y_2.cross(z_1) + y_1.cross(z_2))
}

/// `(y2.z1 - y1.z2)/(2 L)` over its rate by torsion.
fn twist(length: f64, rate: f64) -> Row {
    let half = 0.5 / (length * rate);
    sum([(half, &dot(&Y[1], &Z[0])), (-half, &dot(&Y[0], &Z[1]))])
}

/// `H += weight rows^T D rows`
fn add<const N: usize>(h: &mut [f64], rows: &[Row; N], d: &[[f64; N]; N], weight: f64) {
    let mut k = 0;
    for i in 0..PRODUCTS {
        for j in 0..=i {
            for a in 0..N {
                if rows[a][i] == 0.0 {
                    continue;
                }
                for b in 0..N {
                    h[k] += weight * rows[a][i] * d[a][b] * rows[b][j];
                }
            }
            k += 1;
        }
    }
}

/// The isotropic law, strains in the order (xx, yy, zz, yz, xz, xy); shear corrections (xz, xy).
fn isotropic(law: &BeamLaw, [k_y, k_z]: [f64; 2]) -> [[f64; 6]; 6] {
    let (e, nu) = (law.youngs_modulus, law.poisson_ratio);
    let lambda = e * nu / ((1.0 + nu) * (1.0 - 2.0 * nu));
    let g = law.shear_modulus();
    let mut d = [[0.0; 6]; 6];
    for i in 0..3 {
        for j in 0..3 {
            d[i][j] = lambda;
        }
        d[i][i] += 2.0 * g;
    }
    d[3][3] = g;
    d[4][4] = k_z * g;
    d[5][5] = k_y * g;
    d
}

/// Section law of a beam on assumed strains.
fn add_enhanced(h: &mut [f64], law: &BeamLaw, element: &BeamElement, rate: f64) {
    let length = element.length;
    let node = |k: usize| green_lagrange(&gradients([0.0, 1.0][k], 0.0, 0.0));
    let (first, second) = (node(0), node(1));
    let mut middle: [Row; 6] = std::array::from_fn(|k| sum([(0.5, &first[k]), (0.5, &second[k])]));
    let tangent = gradients(0.5, 0.0, 0.0)[0];
    middle[0] = sum([(0.5, &dot(&tangent, &tangent))]);
    for (k, rows) in [first, middle, second].iter().enumerate() {
        let [area, k_y, k_z] = element.stretch[k];
        add(h, rows, &isotropic(law, [k_y, k_z]), LOBATTO_3.weight[k] * length * area);
    }
    let twist = twist(length, rate);
    let bends = [bending(&Z, length), bending(&Y, length)];
    for (k, (xi, weight)) in GAUSS_3.pairs().into_iter().enumerate() {
        let eta = 2.0 * xi - 1.0;
        let [i_y, i_z, torsion] = element.bend[k];
        let rows: [Row; 3] = [
            sum([(1.0, &bends[0][0]), (eta, &bends[0][1])]),
            sum([(1.0, &bends[1][0]), (eta, &bends[1][1])]),
            twist,
        ];
        let mut d = [[0.0; 3]; 3];
        d[0][0] = law.youngs_modulus * i_y;
        d[1][1] = law.youngs_modulus * i_z;
        d[2][2] = law.shear_modulus() * torsion;
        add(h, &rows, &d, weight * length);
    }
}

/// Strains in the Cartesian frame of the rest shape, and its volume for each part of the element's.
fn strains_at(
    element: &BeamElement,
    g_0: &[Vec3<f64>; VECTORS],
    xi: f64,
    y: f64,
    z: f64,
) -> ([Row; 6], f64) {
    let h = gradients(xi, y / element.length, z / element.length);
    let rows = green_lagrange(&h);
    let column = |h: &Vector| {
        let x = (0..VECTORS).fold(Vec3::zero(0.0), |sum, k| sum.add_times(h[k], g_0[k]));
        Vector3::from(x.array())
    };
    let f = Matrix3::from_columns(&[column(&h[0]), column(&h[1]), column(&h[2])]);
    let volume = f.determinant();
    // A frame along the rest shape: F = Q U with Q from Gram-Schmidt on (r,y r,z), so that the axes stay those of the
    // section; strains are U^-T E U^-1.
    let e_2 = f.column(1).normalize();
    let e_1 = f.column(1).cross(&f.column(2)).normalize();
    let q = Matrix3::from_columns(&[e_1, e_2, e_1.cross(&e_2)]);
    let Some(inverse) = (q.transpose() * f).try_inverse() else { return (rows, 0.0) };
    // Voigt order with doubled shears.
    const PLACES: [(usize, usize); 6] = [(0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1)];
    let mut map = Matrix6::<f64>::zeros();
    for (r, &(i, j)) in PLACES.iter().enumerate() {
        for (c, &(a, b)) in PLACES.iter().enumerate() {
            let one = inverse[(a, i)] * inverse[(b, j)];
            let other = inverse[(b, i)] * inverse[(a, j)];
            let twice = if r > 2 { 2.0 } else { 1.0 };
            map[(r, c)] = if a == b { twice * one } else { 0.5 * twice * (one + other) };
        }
    }
    let turned = std::array::from_fn(|r| {
        std::array::from_fn(|k| (0..6).map(|c| map[(r, c)] * rows[c][k]).sum())
    });
    (turned, volume)
}

/// The law of the continuum over the section's points, or with Poisson's ratio on the axis only.
fn add_volume(h: &mut [f64], law: &BeamLaw, element: &BeamElement, free: &[Vec3<f64>; VECTORS]) {
    let [area, k_y, k_z] = element.stretch[1];
    let mut plain = [[0.0; 6]; 6];
    for k in 0..3 {
        plain[k][k] = law.youngs_modulus;
        plain[3 + k][3 + k] = law.shear_modulus() * [1.0, k_z, k_y][k];
    }
    let full = isotropic(law, [1.0, 1.0]);
    let on_axis: [[f64; 6]; 6] = std::array::from_fn(|i| {
        std::array::from_fn(|j| {
            let own = if i != j {
                0.0
            } else if i < 3 {
                law.youngs_modulus
            } else {
                law.shear_modulus()
            };
            full[i][j] - own
        })
    });
    for (xi, weight) in GAUSS_5.pairs() {
        for &[y, z, part] in &law.section_points {
            let (rows, volume) = strains_at(element, free, xi, y, z);
            let d = if law.locking == Locking::None { &full } else { &plain };
            add(h, &rows, d, weight * element.length * part * volume);
        }
        if law.locking == Locking::Poisson {
            let (rows, volume) = strains_at(element, free, xi, 0.0, 0.0);
            add(h, &rows, &on_axis, weight * element.length * area * volume);
        }
    }
}

/// Mass matrices for rho = 1 at the given points: of (r1, x1, r2, x2), of (y1, y2), of (z1, z2).
fn mass(element: &BeamElement, density: f64) -> [f64; 16] {
    let mut out = [0.0; 16];
    for (k, (xi, weight)) in GAUSS_5.pairs().into_iter().enumerate() {
        let n = hermite::shape(xi, element.length);
        let ends = [1.0 - xi, xi];
        let [area, i_y, i_z] = element.mass[k].map(|m| density * weight * element.length * m);
        let mut at = 0;
        for i in 0..4 {
            for j in 0..=i {
                out[at] += area * n[i] * n[j];
                at += 1;
            }
        }
        // r,y goes with y: its mass is the integral of y^2, I_z.
        for (first, inertia) in [(10, i_z), (13, i_y)] {
            for (i, j) in [(0, 0), (0, 1), (1, 1)] {
                out[first + i + j] += inertia * ends[i] * ends[j];
            }
        }
    }
    out
}

/// All numbers of an element.
pub(crate) fn table(law: &BeamLaw, element: &BeamElement) -> Table {
    let x = element.reference.map(Vec3::from);
    let inverse_length = 1.0 / element.length;
    let free = [(x[4] - x[0]).times(inverse_length), x[1], x[2], x[3], x[5], x[6], x[7]];
    let mut table = vec![0.0; place::COUNT];
    let h = &mut table[place::H..place::H + STIFFNESS];
    let rate = twist_rate(&free);
    match law.locking {
        Locking::Enhanced => add_enhanced(h, law, element, rate),
        Locking::Poisson | Locking::None => add_volume(h, law, element, &free),
    }
    for i in 0..VECTORS {
        for j in 0..=i {
            table[place::G0 + pair(i, j)] = free[i].dot(free[j]);
        }
    }
    table[place::MASS..place::MASS + 16].copy_from_slice(&mass(element, law.density));
    table[place::INVERSE_LENGTH] = inverse_length;
    table[place::TAU] = law.retardation_time;
    table[place::TWIST] = rate;
    table
}
