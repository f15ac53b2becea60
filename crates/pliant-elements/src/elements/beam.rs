//! Fully parameterised ANCF beam with 24 coordinates: position r and the gradients r,x r,y r,z at both nodes.
//!
//! Yakoub & Shabana (2001). `r = N1 r1 + N2 x1 + N3 r2 + N4 x2 + (1 - xi)(y y1 + z z1) + xi (y y2 + z z2)`: cubic
//! along the axis, linear across. Every Green-Lagrange strain is linear in the 28 scalar products g of the seven
//! translation-free vectors `V = (d, x1, y1, z1, x2, y2, z2)`, `d = (r2 - r1)/L`, so that the energy of any quadrature,
//! any rest shape and any assumed strain is `U = 1/2 (g - g0)^T H (g - g0)` with one symmetric 28 x 28 matrix
//! ([`crate::integrals::beam`], docs/theory/beam.md). The kernel below knows no more than that, and is written over
//! [`Real`] for scalars, lanes of elements and dual numbers alike.

use crate::element::Weights;
use pliant_math::{Real, Vec3};

/// Translation-free vectors.
pub(crate) const VECTORS: usize = 7;
/// Their scalar products.
pub(crate) const PRODUCTS: usize = 28;
/// Entries of the lower triangle of H.
pub(crate) const STIFFNESS: usize = PRODUCTS * (PRODUCTS + 1) / 2;
/// Stored entries of an element matrix.
pub(crate) const ENTRIES: usize = 300;

/// Places of the precomputed numbers of an element.
pub(crate) mod place {
    use super::{PRODUCTS, STIFFNESS};

    /// H, lower triangle by rows.
    pub const H: usize = 0;
    /// g0.
    pub const G0: usize = H + STIFFNESS;
    /// Scalar mass matrix of (r1, x1, r2, x2), lower triangle by rows (10).
    pub const MASS: usize = G0 + PRODUCTS;
    /// That of (y1, y2) (3), then that of (z1, z2) (3).
    pub const MASS_Y: usize = MASS + 10;
    /// 1/L.
    pub const INVERSE_LENGTH: usize = MASS_Y + 6;
    /// Retardation time.
    pub const TAU: usize = INVERSE_LENGTH + 1;
    /// Rate of the twist measure by torsion of the rest shape.
    pub const TWIST: usize = TAU + 1;
    /// Length of a column.
    pub const COUNT: usize = TWIST + 1;
}

/// Number of the product of vectors i and j.
pub(crate) const fn pair(i: usize, j: usize) -> usize {
    if i >= j { i * (i + 1) / 2 + j } else { j * (j + 1) / 2 + i }
}

/// Numbers of the products, `PAIR[i][j]`.
const PAIR: [[usize; VECTORS]; VECTORS] = {
    let mut table = [[0; VECTORS]; VECTORS];
    let mut i = 0;
    while i < VECTORS {
        let mut j = 0;
        while j < VECTORS {
            table[i][j] = pair(i, j);
            j += 1;
        }
        i += 1;
    }
    table
};

/// Access to an element's precomputed numbers, as the kind of number that the kernel runs on.
pub(crate) trait Column<T>: Copy {
    /// Number at `place`.
    fn get(self, place: usize) -> T;
}

/// Nodal vectors (r1, x1, y1, z1, r2, x2, y2, z2).
pub(crate) type Nodal<T> = [Vec3<T>; 8];
/// The vectors V.
type Free<T> = [Vec3<T>; VECTORS];

#[inline(always)]
fn free<T: Real>(x: &Nodal<T>, inverse_length: T) -> Free<T> {
    [(x[4] - x[0]).times(inverse_length), x[1], x[2], x[3], x[5], x[6], x[7]]
}

/// `V_i.V_j`, or their rates with `w = V'`.
#[inline(always)]
fn products<T: Real>(v: &Free<T>, rates: Option<&Free<T>>) -> [T; PRODUCTS] {
    let mut g = [v[0].x.zero(); PRODUCTS];
    for i in 0..VECTORS {
        for j in 0..=i {
            g[PAIR[i][j]] = match rates {
                None => v[i].dot(v[j]),
                Some(w) => v[i].dot_add(w[j], w[i].dot(v[j])),
            };
        }
    }
    g
}

/// `s = H e`
#[inline(always)]
fn stress<T: Real>(column: impl Column<T>, e: &[T; PRODUCTS]) -> [T; PRODUCTS] {
    let mut s = [e[0].zero(); PRODUCTS];
    let mut k = place::H;
    for i in 0..PRODUCTS {
        let mut sum = e[0].zero();
        for j in 0..i {
            let h = column.get(k + j);
            sum = h.mul_add(e[j], sum);
            s[j] = h.mul_add(e[i], s[j]);
        }
        s[i] = column.get(k + i).mul_add(e[i], s[i] + sum);
        k += i + 1;
    }
    s
}

/// `g - g0`
#[inline(always)]
fn strain<T: Real>(column: impl Column<T>, v: &Free<T>) -> [T; PRODUCTS] {
    let mut e = products(v, None);
    for (k, e) in e.iter_mut().enumerate() {
        *e = *e - column.get(place::G0 + k);
    }
    e
}

/// Elastic energy [J].
#[inline(always)]
pub(crate) fn energy<T: Real>(column: impl Column<T>, x: &Nodal<T>) -> T {
    let v = free(x, column.get(place::INVERSE_LENGTH));
    let e = strain(column, &v);
    let s = stress(column, &e);
    (0..PRODUCTS).fold(e[0].zero(), |sum, k| s[k].mul_add(e[k], sum)).scale(0.5)
}

/// Stresses s at a state with the viscous part tau H g'.
#[inline(always)]
fn total_stress<T: Real>(
    column: impl Column<T>,
    v: &Free<T>,
    rates: Option<&Nodal<T>>,
) -> [T; PRODUCTS] {
    let mut e = strain(column, v);
    if let Some(rates) = rates {
        let w = free(rates, column.get(place::INVERSE_LENGTH));
        let tau = column.get(place::TAU);
        let rate = products(v, Some(&w));
        for k in 0..PRODUCTS {
            e[k] = rate[k].mul_add(tau, e[k]);
        }
    }
    stress(column, &e)
}

/// Inner force, elastic and viscous: `F_i = sum_j (1 + delta_ij) s_ij V_j`, scattered by `d = (r2 - r1)/L`.
#[inline(always)]
pub(crate) fn force<T: Real>(
    column: impl Column<T>,
    x: &Nodal<T>,
    rates: Option<&Nodal<T>>,
) -> Nodal<T> {
    let inverse_length = column.get(place::INVERSE_LENGTH);
    let v = free(x, inverse_length);
    let s = total_stress(column, &v, rates);
    let mut f = v;
    for i in 0..VECTORS {
        let mut sum = v[i].times(s[PAIR[i][i]]);
        for j in 0..VECTORS {
            sum = sum.add_times(s[PAIR[i][j]], v[j]);
        }
        f[i] = sum;
    }
    let on_position = f[0].times(inverse_length);
    [-on_position, f[1], f[2], f[3], on_position, f[4], f[5], f[6]]
}

/// Mass between nodal vectors a and b; none where there is none at all.
#[inline(always)]
fn mass_place(a: usize, b: usize) -> Option<usize> {
    let (i, j) = (a % 4, b % 4);
    if i < 2 && j < 2 {
        let (k, l) = (2 * (a / 4) + i, 2 * (b / 4) + j);
        let (k, l) = if k >= l { (k, l) } else { (l, k) };
        return Some(place::MASS + k * (k + 1) / 2 + l);
    }
    if i == j { Some(place::MASS_Y + 3 * (i - 2) + a / 4 + b / 4) } else { None }
}

/// `M a`
#[inline(always)]
pub(crate) fn inertia<T: Real>(column: impl Column<T>, a: &Nodal<T>) -> Nodal<T> {
    let mut f = *a;
    for i in 0..8 {
        let mut sum = Vec3::zero(a[0].x);
        for j in 0..8 {
            if let Some(k) = mass_place(i, j) {
                sum = sum.add_times(column.get(k), a[j]);
            }
        }
        f[i] = sum;
    }
    f
}

/// Vector of V that nodal vector k belongs to, positions to d.
const VECTOR_OF: [usize; 8] = [0, 1, 2, 3, 0, 4, 5, 6];

/// Weighted tangent `mass M + damping C + stiffness K`, lower triangle by rows, each entry passed to `store`.
///
/// `K = S (x) I + J^T H J` with `S_ij = (1 + delta_ij) s_ij` and J = dg/dV; `C = tau J^T H J`. The unsymmetric part of
/// the viscous stress' derivative by positions, `tau J^T H dg'/dV`, is left out: it vanishes with the rates.
#[inline(always)]
pub(crate) fn tangent<T: Real>(
    column: impl Column<T>,
    x: &Nodal<T>,
    rates: Option<&Nodal<T>>,
    weights: Weights,
    mut store: impl FnMut(usize, T),
) {
    let inverse_length = column.get(place::INVERSE_LENGTH);
    let v = free(x, inverse_length);
    let s = total_stress(column, &v, rates);
    let zero = v[0].x.zero();
    let material = match rates {
        Some(_) => column
            .get(place::TAU)
            .mul_add(zero.constant(weights.damping), zero.constant(weights.stiffness)),
        None => zero.constant(weights.stiffness),
    };
    // Columns of H J: of the product (l, n) only the derivative by V_l, V_n counts.
    let mut components = [[zero; 3]; VECTORS];
    for k in 0..VECTORS {
        components[k] = v[k].times(material).array();
    }
    let own = v.map(Vec3::array);
    let mut k_v = [[zero; 3 * VECTORS]; 3 * VECTORS];
    for l in 0..VECTORS {
        let mut hj = [[zero; 3]; PRODUCTS];
        for (p, hj) in hj.iter_mut().enumerate() {
            for n in 0..VECTORS {
                let q = PAIR[l][n];
                let (row, at) = if p >= q { (p, q) } else { (q, p) };
                let mut h = column.get(place::H + row * (row + 1) / 2 + at);
                if n == l {
                    h = h + h;
                }
                for c in 0..3 {
                    hj[c] = h.mul_add(components[n][c], hj[c]);
                }
            }
        }
        for k in l..VECTORS {
            for d in 0..3 {
                for c in 0..3 {
                    let mut sum = own[k][c] * hj[PAIR[k][k]][d];
                    for m in 0..VECTORS {
                        sum = own[m][c].mul_add(hj[PAIR[k][m]][d], sum);
                    }
                    k_v[3 * k + c][3 * l + d] = sum;
                }
            }
        }
    }
    let geometric = zero.constant(weights.stiffness);
    for k in 0..VECTORS {
        for l in 0..=k {
            let mut stiffness = s[PAIR[k][l]] * geometric;
            if k == l {
                stiffness = stiffness + stiffness;
            }
            for c in 0..3 {
                k_v[3 * k + c][3 * l + c] = k_v[3 * k + c][3 * l + c] + stiffness;
            }
        }
    }
    let sign = [-inverse_length, zero.constant(1.0), zero.constant(1.0), zero.constant(1.0)];
    let factor =
        |node_vector: usize| if node_vector == 4 { inverse_length } else { sign[node_vector % 4] };
    let mass = zero.constant(weights.mass);
    let mut number = 0;
    for i in 0..24 {
        for j in 0..=i {
            let (a, b) = (i / 3, j / 3);
            let (p, q) = (3 * VECTOR_OF[a] + i % 3, 3 * VECTOR_OF[b] + j % 3);
            // Only the lower triangle of vectors is there; positions of the second node come before the first slopes.
            let entry = if VECTOR_OF[a] >= VECTOR_OF[b] { k_v[p][q] } else { k_v[q][p] };
            let mut value = entry * factor(a) * factor(b);
            if i % 3 == j % 3
                && let Some(k) = mass_place(a, b)
            {
                value = column.get(k).mul_add(mass, value);
            }
            store(number, value);
            number += 1;
        }
    }
}
