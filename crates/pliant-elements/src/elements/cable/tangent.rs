//! Tangent `mass M + damping C + stiffness K`, symmetric.
//!
//! K is the derivative of the elastic force; of the damping forces it holds the geometric part of the axial one (N with
//! its rate part), which keeps it symmetric. The rest, of order tau times the rate of strain, is left to the Newton
//! iteration. C is the exact derivative of the force by velocities.

use pliant_math::quadrature::GAUSS_5;
use pliant_math::{Real, Vec3};

use super::force::{Rates, gram_gradient, legendre, normal, symmetric};
use super::{
    Bending, CableLaw, Column, ETA, Integration, Line, Nodal, Reference, axial_law, place, strain,
};
use crate::element::Weights;

/// Symmetric 3x3: (xx, yx, yy, zx, zy, zz).
type Symmetric<T> = [T; 6];
/// General 3x3, by rows.
type Matrix<T> = [[T; 3]; 3];

#[inline(always)]
fn map6<T: Real>(f: impl Fn(usize) -> T) -> Symmetric<T> {
    [f(0), f(1), f(2), f(3), f(4), f(5)]
}

#[inline(always)]
fn map9<T: Real>(f: impl Fn(usize, usize) -> T) -> Matrix<T> {
    [[f(0, 0), f(0, 1), f(0, 2)], [f(1, 0), f(1, 1), f(1, 2)], [f(2, 0), f(2, 1), f(2, 2)]]
}

/// Row and column of entry k of a symmetric 3x3.
const ROW: [usize; 6] = [0, 1, 1, 2, 2, 2];
const COLUMN: [usize; 6] = [0, 0, 1, 0, 1, 2];
const IS_DIAGONAL: [bool; 6] = [true, false, true, false, false, true];

/// `M + M^T`.
#[inline(always)]
fn twice_symmetric_part<T: Real>(m: &Matrix<T>) -> Symmetric<T> {
    map6(|k| m[ROW[k]][COLUMN[k]] + m[COLUMN[k]][ROW[k]])
}

/// `m a a^T + n I`.
#[inline(always)]
fn outer_and_identity<T: Real>(m: T, a: Vec3<T>, n: T) -> Symmetric<T> {
    let (a, b) = (a.array(), a.times(m).array());
    map6(
        |k| {
            if IS_DIAGONAL[k] {
                a[ROW[k]].mul_add(b[COLUMN[k]], n)
            } else {
                a[ROW[k]] * b[COLUMN[k]]
            }
        },
    )
}

/// Second derivatives of the energy by (d, h, e).
struct Blocks<T> {
    dd: Symmetric<T>,
    hh: Symmetric<T>,
    ee: Symmetric<T>,
    /// Rows h, columns d.
    hd: Matrix<T>,
    /// Rows e, columns d.
    ed: Matrix<T>,
    /// Rows e, columns h.
    eh: Matrix<T>,
}

impl<T: Real> Blocks<T> {
    /// Adds a symmetric second derivative by r' at `eta`.
    #[inline(always)]
    fn add_tangent(&mut self, eta: f64, k: &Symmetric<T>) {
        let p = 1.5 * (1.0 - eta * eta);
        let h = 1.0 - p;
        for i in 0..6 {
            self.dd[i] = k[i].mul_add(k[i].constant(p * p), self.dd[i]);
            self.hh[i] = k[i].mul_add(k[i].constant(h * h), self.hh[i]);
            self.ee[i] = k[i].mul_add(k[i].constant(eta * eta), self.ee[i]);
        }
        for i in 0..3 {
            for j in 0..3 {
                let k = k[symmetric(i, j)];
                self.hd[i][j] = k.mul_add(k.constant(h * p), self.hd[i][j]);
                self.ed[i][j] = k.mul_add(k.constant(eta * p), self.ed[i][j]);
                self.eh[i][j] = k.mul_add(k.constant(eta * h), self.eh[i][j]);
            }
        }
    }
}

/// Second derivatives by r' (v) and L r'' (u) at a bending point.
#[derive(Clone, Copy)]
struct Point<T> {
    vv: Symmetric<T>,
    /// Rows v, columns u.
    vu: Matrix<T>,
    uu: Symmetric<T>,
}

/// Weights as numbers of the kernel's kind.
#[derive(Clone, Copy)]
struct Scale<T> {
    mass: T,
    damping: T,
    stiffness: T,
}

/// Writes the lower triangle of the weighted tangent in the order (r1, t1, r2, t2), entry `i (i + 1)/2 + j` by
/// `store`. `rates` are read by laws with damping.
#[inline(always)]
pub(crate) fn tangent<T: Real>(
    law: CableLaw,
    column: impl Column<T>,
    x: &Nodal<T>,
    rates: Rates<'_, T>,
    weights: Weights,
    mut store: impl FnMut(usize, T),
) {
    let inverse_length = column.get(place::INVERSE_LENGTH);
    let guard = column.get(place::GUARD);
    let scale = Scale {
        mass: guard.constant(weights.mass),
        damping: guard.constant(weights.damping),
        stiffness: guard.constant(weights.stiffness),
    };
    let line = Line::new(x, inverse_length);
    let rate = rates.map(|v| Line::new(v, inverse_length));
    let middle = line.middle();
    let o = guard.zero();

    let mut cc = [o; 6];
    let (mut t1t1, mut t2t2) = (cc, cc);
    if !law.uses_gram() && law.integration == Integration::Lobatto {
        let v = rates.map(|v| (v[1], v[3]));
        t1t1 = axial_stiffness(law, column, 0, guard, x[1], v.map(|v| v.0), scale);
        t2t2 = axial_stiffness(law, column, 2, guard, x[3], v.map(|v| v.1), scale);
        let v = rate.map(|r| r.middle());
        cc = axial_stiffness(law, column, 1, guard, middle, v, scale);
    }

    let straight_simplified =
        law.bending == Bending::Simplified && law.reference == Reference::Straight;
    let mut blocks = if straight_simplified && rate.is_none() {
        let mut blocks = Blocks {
            dd: [o; 6],
            hh: [o; 6],
            ee: [o; 6],
            hd: [[o; 3]; 3],
            ed: [[o; 3]; 3],
            eh: [[o; 3]; 3],
        };
        blocks.add_tangent(0.0, &cc);
        blocks
    } else {
        let at = StiffnessAt { law, column, guard, damped: rate.is_some(), scale };
        let minus = at.point(0, line.tangent(-ETA), line.second(-ETA));
        let mid = at.point(1, middle, line.e.scale(2.0));
        let plus = at.point(2, line.tangent(ETA), line.second(ETA));
        combine(minus, mid, plus, &cc)
    };
    if straight_simplified {
        // L r'' = 2 e + eta 6 (h - d).
        let s = |j: usize, c: f64| (column.get(place::SIMPLIFIED + j) * scale.stiffness).scale(c);
        let (s0, s1, s2) = (s(0, 4.0), s(1, 12.0), s(2, 36.0));
        for i in 0..3 {
            let k = symmetric(i, i);
            blocks.ee[k] = blocks.ee[k] + s0;
            blocks.eh[i][i] = blocks.eh[i][i] + s1;
            blocks.ed[i][i] = blocks.ed[i][i] - s1;
            blocks.hh[k] = blocks.hh[k] + s2;
            blocks.dd[k] = blocks.dd[k] + s2;
            blocks.hd[i][i] = blocks.hd[i][i] - s2;
        }
    }
    if law.uses_gram() {
        add_gram(column, &line, rate.as_ref(), scale, &mut blocks);
    } else if law.integration == Integration::Full {
        for k in 0..5 {
            let eta = 2.0 * GAUSS_5.xi[k] - 1.0;
            let v = rate.map(|r| r.tangent(eta));
            let k = axial_stiffness(law, column, k, guard, line.tangent(eta), v, scale);
            blocks.add_tangent(eta, &k);
        }
    }
    scatter(column, &blocks, &t1t1, &t2t2, scale, &mut store);
}

/// Second derivative of the axial energy at point `k` by r', with damping.
#[inline(always)]
fn axial_stiffness<T: Real>(
    law: CableLaw,
    column: impl Column<T>,
    k: usize,
    guard: T,
    v: Vec3<T>,
    rate: Option<Vec3<T>>,
    scale: Scale<T>,
) -> Symmetric<T> {
    use super::Strain;
    let a = v.dot_add(v, guard);
    let (eps, g) = strain(law, column, k, a);
    let axial = axial_law(law, column, k, eps);
    let mut n = axial.force;
    let w = column.get(place::AXIAL + k);
    let mut weight = scale.stiffness * axial.slope;
    if let Some(rate) = rate {
        let viscous = column.get(place::TAU) * axial.viscous;
        n = (viscous * g).mul_add(v.dot(rate), n);
        weight = viscous.mul_add(scale.damping, weight);
    }
    let wg = w * g;
    let n = n * scale.stiffness;
    let mut outer = weight * g;
    if law.strain == Strain::Biot {
        // d^2 eps/d r'^2 = g (I - r' r'^T/A).
        outer = outer - n / a;
    }
    outer_and_identity(wg * outer, v, wg * n)
}

/// What the bending points of an element have in common.
#[derive(Clone, Copy)]
struct StiffnessAt<T, C> {
    law: CableLaw,
    column: C,
    guard: T,
    damped: bool,
    scale: Scale<T>,
}

impl<T: Real, C: Column<T>> StiffnessAt<T, C> {
    /// Second derivatives of the bending energy at point `k`, with the damping matrix.
    #[inline(always)]
    fn point(self, k: usize, v: Vec3<T>, u: Vec3<T>) -> Point<T> {
        let Self { law, column, guard, damped, scale } = self;
        let w = column.get(place::BENDING + k) * scale.stiffness;
        let a = v.dot_add(v, guard);
        let inverse = a.recip();
        let o = guard.zero();
        let mut point = Point { vv: [o; 6], vu: [[o; 3]; 3], uu: [o; 6] };
        match (law.bending, law.reference) {
            (Bending::Exact, reference) => {
                let (b, c) = (u.dot(u), v.dot(u));
                let wi = w * inverse;
                let beta = wi * inverse;
                let ci = c * inverse;
                let ka = beta * (c + c).mul_add(ci, -b);
                let kc = -(wi * ci);
                // d^2/dA^2, d^2/dA dC, d^2/dC^2 of w/2 (B/A - C^2/A^2), with the factors of the chain rule.
                let beta4 = beta.scale(4.0);
                let aa = beta4 * inverse * c.scale(-3.0).mul_add(ci, b);
                let ac = beta4 * ci;
                let p = v.times(aa).add_times(ac, u).array();
                let q = v.times(ac).add_times(-beta, u).array();
                let s = v.times(ac).add_times(beta.scale(-2.0), u).array();
                let t = v.times(-beta).array();
                let (va, ua) = (v.array(), u.array());
                point.vv = map6(|k| {
                    let (i, j) = (ROW[k], COLUMN[k]);
                    let m = va[i].mul_add(p[j], ua[i] * q[j]);
                    if IS_DIAGONAL[k] { m + ka } else { m }
                });
                point.vu = map9(|i, j| {
                    let m = va[i].mul_add(s[j], ua[i] * t[j]);
                    if i == j { m + kc } else { m }
                });
                point.uu = outer_and_identity(-beta, v, wi);
                if reference == Reference::Planar {
                    let q = column.get(place::CURVATURE + k) * scale.stiffness;
                    add_reference_curvature(&mut point, normal(column), v, u, q, inverse);
                }
            }
            (Bending::Simplified, Reference::Planar) => {
                let root = u.dot_add(u, column.get(place::CURVATURE_SMOOTHING + k)).sqrt();
                let pull = w * column.get(place::CURVATURE + k) / root;
                point.uu = outer_and_identity(pull / (root * root), u, w - pull);
            }
            (Bending::Simplified, Reference::Straight) => {}
        }
        if damped {
            let w = column.get(place::BENDING_DAMPING + k) * scale.damping;
            add_bending_damping(&mut point, v, u, w, a, inverse);
        }
        point
    }
}

/// Second derivatives of `-q n.(v x u)/A`, the signed curvature's part with a curved reference.
#[inline(always)]
fn add_reference_curvature<T: Real>(
    point: &mut Point<T>,
    n: Vec3<T>,
    v: Vec3<T>,
    u: Vec3<T>,
    q: T,
    inverse: T,
) {
    let (n_v, n_u) = (u.cross(n), n.cross(v));
    let value = u.dot(n_u);
    let qi = q * inverse;
    let qii = (qi * inverse).scale(2.0);
    let identity = qii * value;
    let twice = twice_symmetric_part(&outer(n_v, v));
    let square = outer_and_identity(identity.scale(-4.0) * inverse, v, identity);
    point.vv = map6(|k| point.vv[k] + qii.mul_add(twice[k], square[k]));
    let mixed = outer(v.times(qii), n_u);
    // -q/A d^2(n.(v x u))/dv du = q/A [n]x.
    let n = n.times(qi);
    let spin = [[qi.zero(), -n.z, n.y], [n.z, qi.zero(), -n.x], [-n.y, n.x, qi.zero()]];
    point.vu = map9(|i, j| point.vu[i][j] + mixed[i][j] + spin[i][j]);
}

#[inline(always)]
fn outer<T: Real>(a: Vec3<T>, b: Vec3<T>) -> Matrix<T> {
    let (a, b) = (a.array(), b.array());
    map9(|i, j| a[i] * b[j])
}

/// Adds `w B^T B` with the rate of the curvature vector `B_v v_rate + B_u u_rate`,
/// `B_v = (-[u]x - 2 kappa v^T + v kappa^T)/A`, `B_u = [v]x/A`.
#[inline(always)]
fn add_bending_damping<T: Real>(
    point: &mut Point<T>,
    v: Vec3<T>,
    u: Vec3<T>,
    w: T,
    a: T,
    inverse: T,
) {
    let kappa = v.cross(u).times(inverse);
    let minus_two_kappa = kappa.scale(-2.0);
    let (o1, o2) = (outer(minus_two_kappa, v), outer(v, kappa));
    let o = w.zero();
    let spin = [[o, u.z, -u.y], [-u.z, o, u.x], [u.y, -u.x, o]];
    let b_v = map9(|i, j| spin[i][j] + o1[i][j] + o2[i][j]);
    let w2 = w * inverse * inverse;
    let mut columns = [v; 3];
    for j in 0..3 {
        columns[j] = Vec3::new(b_v[0][j], b_v[1][j], b_v[2][j]);
    }
    point.vv = map6(|k| w2.mul_add(columns[ROW[k]].dot(columns[COLUMN[k]]), point.vv[k]));
    // Row i of B_v^T [v]x is (column i) x v.
    let rows =
        [columns[0].cross(v).array(), columns[1].cross(v).array(), columns[2].cross(v).array()];
    point.vu = map9(|i, j| w2.mul_add(rows[i][j], point.vu[i][j]));
    let uu = outer_and_identity(-w2, v, w2 * a);
    point.uu = map6(|k| point.uu[k] + uu[k]);
}

/// Sums the bending points (and the axial one in the middle, `cc`) into second derivatives by (d, h, e).
///
/// At the outer points `v = p -+ s e` and `u = 2 e -+ 6 s q` with `p = 0.6 d + 0.4 h`, `q = h - d`, s^2 = 3/5: sums and
/// differences of the two points are distributed once, instead of each point for itself.
#[inline(always)]
fn combine<T: Real>(
    minus: Point<T>,
    mid: Point<T>,
    plus: Point<T>,
    cc: &Symmetric<T>,
) -> Blocks<T> {
    let c = |x: T, c: f64| x.scale(c);
    let pp = map6(|k| plus.vv[k] + minus.vv[k]);
    let dvv = map6(|k| plus.vv[k] - minus.vv[k]);
    let svu = map9(|i, j| plus.vu[i][j] + minus.vu[i][j]);
    let dvu = map9(|i, j| plus.vu[i][j] - minus.vu[i][j]);
    let suu = map6(|k| plus.uu[k] + minus.uu[k]);
    let duu = map6(|k| plus.uu[k] - minus.uu[k]);
    let s = ETA;
    let fma = |x: T, f: f64, y: T| x.mul_add(x.constant(f), y);

    // Rows p or e, columns e or q.
    let pe = map9(|i, j| fma(dvv[symmetric(i, j)], s, c(svu[i][j], 2.0)));
    let pq = map9(|i, j| c(dvu[i][j], 6.0 * s));
    let eq = map9(|i, j| fma(svu[i][j], 3.6, c(duu[symmetric(i, j)], 12.0 * s)));
    let dvu2 = twice_symmetric_part(&dvu);
    let ee = map6(|k| fma(pp[k], 0.6, fma(dvu2[k], 2.0 * s, c(suu[k] + mid.uu[k], 4.0))));
    let qq = map6(|k| c(suu[k], 21.6));
    let cc = map6(|k| cc[k] + mid.vv[k]);
    let ce = map9(|i, j| c(mid.vu[i][j], 2.0));

    let pq2 = twice_symmetric_part(&pq);
    Blocks {
        dd: map6(|k| fma(cc[k], 2.25, fma(pp[k], 0.36, fma(pq2[k], -0.6, qq[k])))),
        hh: map6(|k| fma(cc[k], 0.25, fma(pp[k], 0.16, fma(pq2[k], 0.4, qq[k])))),
        hd: {
            let even = map6(|k| fma(pp[k], 0.24, fma(cc[k], -0.75, -qq[k])));
            map9(|i, j| fma(pq[i][j], -0.4, fma(pq[j][i], 0.6, even[symmetric(i, j)])))
        },
        ed: map9(|i, j| fma(pe[j][i], 0.6, fma(ce[j][i], 1.5, -eq[i][j]))),
        eh: map9(|i, j| fma(pe[j][i], 0.4, fma(ce[j][i], -0.5, eq[i][j]))),
        ee,
    }
}

/// Adds the precomputed axial energy's second derivatives: `Sm kron I + J^T H J` with J = dg/dD.
#[inline(always)]
fn add_gram<T: Real>(
    column: impl Column<T>,
    line: &Line<T>,
    rate: Option<&Line<T>>,
    scale: Scale<T>,
    blocks: &mut Blocks<T>,
) {
    let mut s = gram_gradient(column, line, rate);
    for k in 0..6 {
        s[k] = s[k] * scale.stiffness;
    }
    let mut weight = scale.stiffness;
    if rate.is_some() {
        weight = column.get(place::TAU).mul_add(scale.damping, weight);
    }
    let d = legendre(line);
    let (m00, m10) =
        (gram_block(column, &s, &d, weight, 0, 0), gram_block(column, &s, &d, weight, 1, 0));
    let (m11, m20) =
        (gram_block(column, &s, &d, weight, 1, 1), gram_block(column, &s, &d, weight, 2, 0));
    let (m12, m22) =
        (gram_block(column, &s, &d, weight, 1, 2), gram_block(column, &s, &d, weight, 2, 2));
    // D0 = d, D1 = e, D2 = h - d.
    for k in 0..6 {
        let (a, b) = (ROW[k], COLUMN[k]);
        blocks.dd[k] = blocks.dd[k] + m00[a][b] - m20[a][b] - m20[b][a] + m22[a][b];
        blocks.hh[k] = blocks.hh[k] + m22[a][b];
        blocks.ee[k] = blocks.ee[k] + m11[a][b];
    }
    blocks.hd = map9(|a, b| blocks.hd[a][b] + m20[a][b] - m22[a][b]);
    blocks.ed = map9(|a, b| blocks.ed[a][b] + m10[a][b] - m12[a][b]);
    blocks.eh = map9(|a, b| blocks.eh[a][b] + m12[a][b]);
}

/// Number of the pair (i, j) among the Gram numbers.
#[inline(always)]
const fn pair(i: usize, j: usize) -> usize {
    [[0, 1, 2], [1, 3, 4], [2, 4, 5]][i][j]
}

/// Factor of D_j in the derivative of g_ij by D_i.
#[inline(always)]
const fn both(i: usize, j: usize) -> f64 {
    if i == j { 2.0 } else { 1.0 }
}

/// Block (i, j) of the Legendre vectors: `s_ij I + sum_kl H_(ik)(jl) D_k D_l^T`, doubled where a pair is a square.
#[inline(always)]
fn gram_block<T: Real>(
    column: impl Column<T>,
    s: &[T; 6],
    d: &[Vec3<T>; 3],
    weight: T,
    i: usize,
    j: usize,
) -> Matrix<T> {
    let diagonal = s[pair(i, j)].scale(both(i, j));
    let o = diagonal.zero();
    let mut m = [[diagonal, o, o], [o, diagonal, o], [o, o, diagonal]];
    for k in 0..3 {
        let mut sum = Vec3::zero(weight);
        for l in 0..3 {
            let h = column.gram(symmetric(pair(i, k), pair(j, l))) * weight;
            sum = sum.add_times(h.scale(both(i, k) * both(j, l)), d[l]);
        }
        let (dk, sum) = (d[k].array(), sum.array());
        for a in 0..3 {
            for b in 0..3 {
                m[a][b] = dk[a].mul_add(sum[b], m[a][b]);
            }
        }
    }
    m
}

/// From (d, h, e) to (r1, t1, r2, t2), with the mass matrix.
#[inline(always)]
fn scatter<T: Real>(
    column: impl Column<T>,
    blocks: &Blocks<T>,
    t1t1: &Symmetric<T>,
    t2t2: &Symmetric<T>,
    scale: Scale<T>,
    store: &mut impl FnMut(usize, T),
) {
    let Blocks { dd, hh, ee, hd, ed, eh } = blocks;
    let mass = |i: usize, j: usize| column.get(place::MASS + symmetric(i, j)) * scale.mass;
    let inverse = column.get(place::INVERSE_LENGTH);
    let inverse2 = inverse * inverse;
    let half = inverse.scale(0.5);
    let mut put = |i: usize, j: usize, a: usize, b: usize, value: T| {
        // Only the lower triangle; diagonal blocks are written once per pair.
        store(symmetric(3 * i + a, 3 * j + b), value);
    };

    let (m00, m22, m20) = (mass(0, 0), mass(2, 2), mass(2, 0));
    let (m11, m33, m31) = (mass(1, 1), mass(3, 3), mass(3, 1));
    let eh2 = twice_symmetric_part(eh);
    for k in 0..6 {
        let (a, b) = (ROW[k], COLUMN[k]);
        let r = dd[k] * inverse2;
        let even = hh[k] + ee[k];
        let quarter = even.constant(0.25);
        let t1 = (even - eh2[k]).mul_add(quarter, t1t1[k]);
        let t2 = (even + eh2[k]).mul_add(quarter, t2t2[k]);
        if IS_DIAGONAL[k] {
            put(0, 0, a, b, r + m00);
            put(2, 2, a, b, r + m22);
            put(1, 1, a, b, t1 + m11);
            put(3, 3, a, b, t2 + m33);
        } else {
            put(0, 0, a, b, r);
            put(2, 2, a, b, r);
            put(1, 1, a, b, t1);
            put(3, 3, a, b, t2);
        }
    }
    let (m10, m21, m30, m32) = (mass(1, 0), mass(2, 1), mass(3, 0), mass(3, 2));
    for a in 0..3 {
        for b in 0..3 {
            // Rows t, columns r2; r1 takes the opposite sign.
            let t1 = (hd[a][b] - ed[a][b]) * half;
            let t2 = (hd[a][b] + ed[a][b]) * half;
            let r = -(dd[symmetric(a, b)] * inverse2);
            let odd = eh[a][b] - eh[b][a];
            let even = hh[symmetric(a, b)] - ee[symmetric(a, b)];
            let t2t1 = (even + odd).scale(0.25);
            if a == b {
                put(1, 0, a, b, m10 - t1);
                put(3, 0, a, b, m30 - t2);
                put(2, 1, b, a, t1 + m21);
                put(3, 2, a, b, t2 + m32);
                put(2, 0, a, b, r + m20);
                put(3, 1, a, b, t2t1 + m31);
            } else {
                put(1, 0, a, b, -t1);
                put(3, 0, a, b, -t2);
                put(2, 1, b, a, t1);
                put(3, 2, a, b, t2);
                put(2, 0, a, b, r);
                put(3, 1, a, b, t2t1);
            }
        }
    }
}
