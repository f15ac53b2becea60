//! Kinematics of a Kirchhoff-Love surface at a point, a function of five vectors: a_1, a_2, h_11, h_22, h_12.
//!
//! `g_ij = a_i.a_j`, `E_ij = (g_ij - delta_ij)/2`, `n = a_1 x a_2/|a_1 x a_2|`, `b_ij = h_ij.n`, `k_ij = B0_ij - b_ij`;
//! the strain at height z along n is `E + z k`. `dk_ij = -n.(dh_ij - G^c_ij da_c)` with `G^c_ij = a^c.h_ij`.

use crate::materials::{Stiffness, Voigt};
use pliant_math::{Real, Vec3};

/// The five vectors; membranes have the first two alone.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Vectors<T> {
    /// a_1, a_2.
    pub a: [Vec3<T>; 2],
    /// h_11, h_22, h_12.
    pub h: [Vec3<T>; 3],
}

/// How often h_11, h_22 and h_12 occur in sums over ij.
const TIMES: [f64; 3] = [1.0, 1.0, 2.0];

/// What derives from the vectors.
pub(crate) struct Frame<T> {
    /// Membrane strain (E11, E22, 2 E12).
    pub membrane: Voigt<T>,
    /// Change of curvature (k11, k22, 2 k12).
    pub bending: Voigt<T>,
    /// Unit normal.
    pub normal: Vec3<T>,
    /// a^1, a^2.
    pub dual: [Vec3<T>; 2],
    /// g^11, g^22, g^12.
    pub metric: [T; 3],
    /// b_11, b_22, b_12.
    pub curvature: [T; 3],
}

/// Membrane strain alone.
#[inline(always)]
pub(crate) fn membrane_strain<T: Real>(a: &[Vec3<T>; 2]) -> Voigt<T> {
    let one = a[0].x.constant(1.0);
    [(a[0].dot(a[0]) - one).scale(0.5), (a[1].dot(a[1]) - one).scale(0.5), a[0].dot(a[1])]
}

impl<T: Real> Frame<T> {
    #[inline(always)]
    pub fn new(x: &Vectors<T>, reference: [f64; 3]) -> Self {
        let [a1, a2] = x.a;
        let one = a1.x.constant(1.0);
        let (g11, g22, g12) = (a1.dot(a1), a2.dot(a2), a1.dot(a2));
        let cross = a1.cross(a2);
        let g = cross.dot(cross);
        let inverse = one / g;
        let normal = cross.times(one / g.sqrt());
        let metric = [g22 * inverse, g11 * inverse, -(g12 * inverse)];
        let dual = [
            a1.times(metric[0]).add_times(metric[2], a2),
            a2.times(metric[1]).add_times(metric[2], a1),
        ];
        let curvature = x.h.map(|h| h.dot(normal));
        let change = |k: usize| (one.constant(reference[k]) - curvature[k]).scale(TIMES[k]);
        Self {
            membrane: [(g11 - one).scale(0.5), (g22 - one).scale(0.5), g12],
            bending: [change(0), change(1), change(2)],
            normal,
            dual,
            metric,
            curvature,
        }
    }

    /// Rates of the strains under rates of the five vectors.
    #[inline(always)]
    pub fn rates(&self, x: &Vectors<T>, v: &Vectors<T>) -> [Voigt<T>; 2] {
        let u = v.a.map(|v| self.normal.dot(v));
        let rate = |k: usize| {
            let christoffel = self.dual.map(|a| a.dot(x.h[k]));
            (christoffel[0] * u[0] + christoffel[1] * u[1] - self.normal.dot(v.h[k]))
                .scale(TIMES[k])
        };
        [membrane_rates(&x.a, &v.a), [rate(0), rate(1), rate(2)]]
    }

    /// Derivatives of the energy by the five vectors, from the resultants.
    #[inline(always)]
    pub fn gradient(&self, x: &Vectors<T>, n: Voigt<T>, m: Voigt<T>) -> Vectors<T> {
        let [a1, a2] = x.a;
        let m = [m[0], m[1], m[2].scale(2.0)];
        // sum M_ij h_ij, whose dual components turn the normal.
        let sum = x.h[0].times(m[0]).add_times(m[1], x.h[1]).add_times(m[2], x.h[2]);
        let [m1, m2] = self.dual.map(|a| a.dot(sum));
        Vectors {
            a: [
                a1.times(n[0]).add_times(n[2], a2).add_times(m1, self.normal),
                a2.times(n[1]).add_times(n[2], a1).add_times(m2, self.normal),
            ],
            h: m.map(|m| self.normal.times(-m)),
        }
    }
}

/// Rates of the membrane strain.
#[inline(always)]
pub(crate) fn membrane_rates<T: Real>(a: &[Vec3<T>; 2], v: &[Vec3<T>; 2]) -> Voigt<T> {
    [a[0].dot(v[0]), a[1].dot(v[1]), a[0].dot(v[1]) + a[1].dot(v[0])]
}

/// Force vectors of a membrane.
#[inline(always)]
pub(crate) fn membrane_gradient<T: Real>(a: &[Vec3<T>; 2], n: Voigt<T>) -> [Vec3<T>; 2] {
    [a[0].times(n[0]).add_times(n[2], a[1]), a[1].times(n[1]).add_times(n[2], a[0])]
}

/// Component pairs (c, d), c >= d, in the order of [`Hessian`].
pub(crate) const PAIRS: [(usize, usize); 6] = [(0, 0), (1, 1), (2, 2), (1, 0), (2, 0), (2, 1)];

/// Second derivatives of the energy by (a_1, a_2, p_11, p_22, p_12), `p_ij = dh_ij - G^c_ij da_c`, for each of
/// [`PAIRS`]: entry `[s][t]` belongs to component c of vector s and component d of vector t.
pub(crate) type Hessian = [[[f64; 5]; 5]; 6];

/// The membrane's part: material, and `N_ij` times the identity.
#[inline(always)]
pub(crate) fn membrane_hessian(
    a: &[Vec3<f64>; 2],
    n: Voigt<f64>,
    stiffness: &Stiffness,
    out: &mut Hessian,
) {
    let d = stiffness;
    let (a1, a2) = (a[0].array(), a[1].array());
    for (out, (i, j)) in out.iter_mut().zip(PAIRS) {
        let same = f64::from(u8::from(i == j));
        let (p11, p12, p21, p22) = (a1[i] * a1[j], a1[i] * a2[j], a2[i] * a1[j], a2[i] * a2[j]);
        out[0][0] = d[0][0] * p11 + d[2][2] * p22 + d[0][2] * (p12 + p21) + same * n[0];
        out[1][1] = d[1][1] * p22 + d[2][2] * p11 + d[1][2] * (p12 + p21) + same * n[1];
        let both = d[0][2] * p11 + d[1][2] * p22 + same * n[2];
        out[0][1] = d[0][1] * p12 + d[2][2] * p21 + both;
        out[1][0] = d[0][1] * p21 + d[2][2] * p12 + both;
    }
}

/// All of it. `n`, `m` carry the geometric part, `stiffness` the material's.
#[inline(always)]
pub(crate) fn hessian(
    frame: &Frame<f64>,
    x: &Vectors<f64>,
    n: Voigt<f64>,
    m: Voigt<f64>,
    stiffness: &Stiffness,
    out: &mut Hessian,
) {
    membrane_hessian(&x.a, n, stiffness, out);
    let d = stiffness;
    let normal = frame.normal.array();
    let a = x.a.map(Vec3::array);
    let dual = frame.dual.map(Vec3::array);
    let twice = [m[0], m[1], 2.0 * m[2]];
    let turning: f64 = (0..3).map(|k| twice[k] * frame.curvature[k]).sum();
    let metric = frame.metric.map(|g| turning * g);
    // Shear of a_1 pulls a_2 and the other way round.
    let pull = |s: usize, k: usize, c: usize| d[s][3 + k] * a[s][c] + d[2][3 + k] * a[1 - s][c];
    for (out, (i, j)) in out.iter_mut().zip(PAIRS) {
        let nn = normal[i] * normal[j];
        out[0][0] += metric[0] * nn;
        out[1][1] += metric[1] * nn;
        out[0][1] += metric[2] * nn;
        out[1][0] += metric[2] * nn;
        for k in 0..3 {
            for s in 0..2 {
                out[s][2 + k] =
                    twice[k] * normal[i] * dual[s][j] - TIMES[k] * pull(s, k, i) * normal[j];
                out[2 + k][s] =
                    twice[k] * dual[s][i] * normal[j] - TIMES[k] * normal[i] * pull(s, k, j);
            }
            for l in 0..3 {
                out[2 + k][2 + l] = TIMES[k] * TIMES[l] * d[3 + k][3 + l] * nn;
            }
        }
    }
}
