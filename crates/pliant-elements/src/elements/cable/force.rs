//! Elastic, damping and inertia forces.

use pliant_math::quadrature::GAUSS_5;
use pliant_math::{Real, Vec3};

use super::{
    Bending, CableLaw, Column, ETA, Integration, Line, Nodal, Reference, axial_law, place, strain,
};

/// The line's rates of change where there is damping.
pub(crate) type Rates<'a, T> = Option<&'a Nodal<T>>;

/// Forces on (d, h, e).
struct Forces<T> {
    d: Vec3<T>,
    h: Vec3<T>,
    e: Vec3<T>,
}

impl<T: Real> Forces<T> {
    /// Adds a force on r' at `eta`.
    #[inline(always)]
    fn add_tangent(&mut self, eta: f64, f: Vec3<T>) {
        let p = 1.5 * (1.0 - eta * eta);
        self.d = self.d.add_scaled(p, f);
        self.h = self.h.add_scaled(1.0 - p, f);
        self.e = self.e.add_scaled(eta, f);
    }

    /// Adds a force on L r'' at `eta`.
    #[inline(always)]
    fn add_second(&mut self, eta: f64, f: Vec3<T>) {
        self.e = self.e.add_scaled(2.0, f);
        self.h = self.h.add_scaled(6.0 * eta, f);
        self.d = self.d.add_scaled(-6.0 * eta, f);
    }
}

/// The line or its rate at a point, as (r', L r''). Not a closure: those are not sure to be inlined, and code that is
/// not inlined into the dispatched function is compiled without its instruction set.
#[inline(always)]
fn point<T: Real>(line: Option<&Line<T>>, eta: f64) -> Option<(Vec3<T>, Vec3<T>)> {
    let line = line?;
    Some((line.tangent(eta), line.second(eta)))
}

/// Internal force `f(q, v)`.
#[inline(always)]
pub(crate) fn force<T: Real>(
    law: CableLaw,
    column: impl Column<T>,
    x: &Nodal<T>,
    rates: Rates<'_, T>,
) -> Nodal<T> {
    let inverse_length = column.get(place::INVERSE_LENGTH);
    let guard = column.get(place::GUARD);
    let line = Line::new(x, inverse_length);
    let rate = rates.map(|v| Line::new(v, inverse_length));
    let middle = line.middle();
    let middle_rate = rate.map(|r| r.middle());
    let zero = Vec3::zero(inverse_length);
    let mut on = Forces { d: zero, h: zero, e: zero };
    let (mut on_t1, mut on_t2) = (zero, zero);
    // The middle is an axial and a bending point at once: collect its force before distributing it.
    let mut on_middle = zero;

    if law.uses_gram() {
        let (d, h, e) = gram_force(column, &line, rate.as_ref());
        on = Forces { d, h, e };
    } else {
        match law.integration {
            Integration::Lobatto => {
                let v = rates.map(|v| (v[1], v[3]));
                on_t1 = axial_force(law, column, 0, guard, x[1], v.map(|v| v.0));
                on_middle = axial_force(law, column, 1, guard, middle, middle_rate);
                on_t2 = axial_force(law, column, 2, guard, x[3], v.map(|v| v.1));
            }
            Integration::Full => {
                for k in 0..5 {
                    let eta = 2.0 * GAUSS_5.xi[k] - 1.0;
                    let v = line.tangent(eta);
                    let f = axial_force(law, column, k, guard, v, rate.map(|r| r.tangent(eta)));
                    on.add_tangent(eta, f);
                }
            }
        }
    }

    let straight_simplified =
        law.bending == Bending::Simplified && law.reference == Reference::Straight;
    if straight_simplified {
        let q = (line.h - line.d).scale(6.0);
        let p = line.e.scale(2.0);
        let s0 = column.get(place::SIMPLIFIED);
        let s1 = column.get(place::SIMPLIFIED + 1);
        let s2 = column.get(place::SIMPLIFIED + 2);
        let f_p = p.times(s0).add_times(s1, q);
        let f_q = p.times(s1).add_times(s2, q);
        on.e = on.e.add_scaled(2.0, f_p);
        on.h = on.h.add_scaled(6.0, f_q);
        on.d = on.d.add_scaled(-6.0, f_q);
    }
    if !straight_simplified || rate.is_some() {
        for (k, eta) in [(0, -ETA), (2, ETA)] {
            let rates = point(rate.as_ref(), eta);
            let (v, u) = (line.tangent(eta), line.second(eta));
            let (f_v, f_u) = bending_force(law, column, k, guard, v, u, rates);
            on.add_tangent(eta, f_v);
            on.add_second(eta, f_u);
        }
        let rates = point(rate.as_ref(), 0.0);
        let (f_v, f_u) = bending_force(law, column, 1, guard, middle, line.e.scale(2.0), rates);
        on_middle = on_middle + f_v;
        on.e = on.e.add_scaled(2.0, f_u);
    }

    on.d = on.d.add_scaled(1.5, on_middle);
    on.h = on.h.add_scaled(-0.5, on_middle);
    let r2 = on.d.times(inverse_length);
    let (half_h, half_e) = (on.h.scale(0.5), on.e.scale(0.5));
    [-r2, on_t1 + half_h - half_e, r2, on_t2 + half_h + half_e]
}

/// Force on r' from the axial energy at point `k`: `N(eps + tau eps_rate) d eps/d r'`, weighted.
#[inline(always)]
fn axial_force<T: Real>(
    law: CableLaw,
    column: impl Column<T>,
    k: usize,
    guard: T,
    v: Vec3<T>,
    rate: Option<Vec3<T>>,
) -> Vec3<T> {
    let (eps, g) = strain(law, column, k, v.dot_add(v, guard));
    let axial = axial_law(law, column, k, eps);
    let mut n = axial.force;
    if let Some(rate) = rate {
        n = (column.get(place::TAU) * axial.viscous * g).mul_add(v.dot(rate), n);
    }
    v.times(column.get(place::AXIAL + k) * n * g)
}

/// Forces on r' and L r'' from bending at point `k`.
///
/// Elastic: `w/2 (B/A - C^2/A^2)` with A = v.v, B = u.u, C = v.u and the weight w, which is EI/2 k^2 for the material
/// curvature k; a curved reference adds `-w k0 n.(v x u)/A`. Damping: the vector form, in which the curvature vector
/// `v x u/A` is seen from a frame carried with the tangent by the smallest rotation.
#[inline(always)]
fn bending_force<T: Real>(
    law: CableLaw,
    column: impl Column<T>,
    k: usize,
    guard: T,
    v: Vec3<T>,
    u: Vec3<T>,
    rates: Option<(Vec3<T>, Vec3<T>)>,
) -> (Vec3<T>, Vec3<T>) {
    let w = column.get(place::BENDING + k);
    let mut on_v = Vec3::zero(w);
    let mut on_u = on_v;
    let inverse = v.dot_add(v, guard).recip();
    match law.bending {
        Bending::Exact => {
            let (b, c) = (u.dot(u), v.dot(u));
            let wi = w * inverse;
            let ci = c * inverse;
            let kc = -(wi * ci);
            let ka = wi * inverse * ((c + c).mul_add(ci, -b));
            on_v = v.times(ka).add_times(kc, u);
            on_u = u.times(wi).add_times(kc, v);
            if law.reference == Reference::Planar {
                let n = normal(column);
                let n_u = n.cross(v);
                let qi = column.get(place::CURVATURE + k) * inverse;
                let turn = (qi * inverse * u.dot(n_u)).scale(2.0);
                on_v = on_v.add_times(-qi, u.cross(n)).add_times(turn, v);
                on_u = on_u.add_times(-qi, n_u);
            }
        }
        Bending::Simplified => {
            if law.reference == Reference::Planar {
                let root = u.dot_add(u, column.get(place::CURVATURE_SMOOTHING + k)).sqrt();
                let excess = w.constant(1.0) - column.get(place::CURVATURE + k) / root;
                on_u = u.times(w * excess);
            }
        }
    }
    if let Some((dv, du)) = rates {
        let kappa = v.cross(u).times(inverse);
        let rate = (dv.cross(u) + v.cross(du))
            .add_times(v.dot(dv).scale(-2.0), kappa)
            .add_times(kappa.dot(dv), v);
        let m = rate.times(column.get(place::BENDING_DAMPING + k) * inverse * inverse);
        // v.m = 0: the term B^T = ... + kappa v^T drops out.
        on_v = on_v + u.cross(m).add_times(kappa.dot(m).scale(-2.0), v);
        on_u = on_u + m.cross(v);
    }
    (on_v, on_u)
}

#[inline(always)]
pub(super) fn normal<T: Real>(column: impl Column<T>) -> Vec3<T> {
    Vec3::new(
        column.get(place::NORMAL),
        column.get(place::NORMAL + 1),
        column.get(place::NORMAL + 2),
    )
}

/// The Legendre vectors D0, D1, D2 of r' = sum D_k P_k(eta).
#[inline(always)]
pub(super) fn legendre<T: Real>(line: &Line<T>) -> [Vec3<T>; 3] {
    [line.d, line.e, line.h - line.d]
}

/// Pairs (i, j) of the Gram numbers g = (G00, G01, G02, G11, G12, G22).
pub(super) const PAIRS: [(usize, usize); 6] = [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)];

/// `s = dU/dg = Hc (g - g0 + tau g_rate)/4` of the precomputed axial energy `(g - g0)^T Hc (g - g0)/8`.
#[inline(always)]
pub(super) fn gram_gradient<T: Real>(
    column: impl Column<T>,
    line: &Line<T>,
    rate: Option<&Line<T>>,
) -> [T; 6] {
    let d = legendre(line);
    let mut g = [d[0].x; 6];
    for k in 0..6 {
        let (i, j) = PAIRS[k];
        g[k] = d[i].dot_add(d[j], -column.gram(21 + k));
    }
    if let Some(rate) = rate {
        let dd = legendre(rate);
        let tau = column.get(place::TAU);
        for k in 0..6 {
            let (i, j) = PAIRS[k];
            g[k] = tau.mul_add(d[i].dot_add(dd[j], d[j].dot(dd[i])), g[k]);
        }
    }
    let mut s = [g[0].zero(); 6];
    for i in 0..6 {
        for j in 0..6 {
            s[i] = column.gram(symmetric(i, j)).mul_add(g[j], s[i]);
        }
    }
    s
}

#[inline(always)]
fn gram_force<T: Real>(
    column: impl Column<T>,
    line: &Line<T>,
    rate: Option<&Line<T>>,
) -> (Vec3<T>, Vec3<T>, Vec3<T>) {
    let s = gram_gradient(column, line, rate);
    let [d0, d1, d2] = legendre(line);
    let f0 = d0.scale(2.0).times(s[0]).add_times(s[1], d1).add_times(s[2], d2);
    let f1 = d1.scale(2.0).times(s[3]).add_times(s[1], d0).add_times(s[4], d2);
    let f2 = d2.scale(2.0).times(s[5]).add_times(s[2], d0).add_times(s[4], d1);
    (f0 - f2, f2, f1)
}

/// Number of entry (i, j) of a symmetric matrix stored by its lower triangle.
#[inline(always)]
pub(crate) const fn symmetric(i: usize, j: usize) -> usize {
    if i >= j { i * (i + 1) / 2 + j } else { j * (j + 1) / 2 + i }
}

/// `M a`, one scalar 4x4 matrix for the three components.
#[inline(always)]
pub(crate) fn inertia<T: Real>(column: impl Column<T>, a: &Nodal<T>) -> Nodal<T> {
    [
        inertia_row(column, a, 0),
        inertia_row(column, a, 1),
        inertia_row(column, a, 2),
        inertia_row(column, a, 3),
    ]
}

#[inline(always)]
fn inertia_row<T: Real>(column: impl Column<T>, a: &Nodal<T>, i: usize) -> Vec3<T> {
    let mut sum = a[0].times(column.get(place::MASS + symmetric(i, 0)));
    for j in 1..4 {
        sum = sum.add_times(column.get(place::MASS + symmetric(i, j)), a[j]);
    }
    sum
}
