//! Elastic energy, by plain quadrature, and measures of strain for output.

use pliant_math::quadrature::{GAUSS_3, GAUSS_5, LOBATTO_3};
use pliant_math::{Real, Vec3};

use super::force::normal;
use super::{
    Bending, CableLaw, Column, Integration, Line, Nodal, Reference, Scale, axial_law, elastic_law,
    flow, place, strain,
};

/// Elastic energy, which unloading gives back. Written point by point, so that it checks the forces and the precomputed forms.
#[inline(always)]
pub(crate) fn elastic_energy<T: Real>(law: CableLaw, column: impl Column<T>, x: &Nodal<T>) -> T {
    let line = Line::new(x, column.get(place::INVERSE_LENGTH));
    let mut energy = -column.get(place::ENERGY);
    let mut axial = |k: usize, xi: f64| {
        let v = line.tangent(2.0 * xi - 1.0);
        let a = v.dot_add(v, column.get(place::GUARD));
        let (eps, _) = strain(law, column, k, a);
        let elastic = if law.plastic { flow(law, column.past(k), eps).elastic } else { eps };
        energy = column.get(place::AXIAL + k).mul_add(axial_energy(law, column, elastic), energy);
    };
    match law.integration {
        Integration::Lobatto => (0..3).for_each(|k| axial(k, LOBATTO_3.xi[k])),
        Integration::Full => (0..5).for_each(|k| axial(k, GAUSS_5.xi[k])),
    }
    if law.bending == Bending::Simplified && law.reference == Reference::Straight {
        // L r'' = p + eta q.
        let p = line.e.scale(2.0);
        let q = (line.h - line.d).scale(6.0);
        let s = |j| column.get(place::SIMPLIFIED + j);
        let twice = s(0) * p.dot(p) + s(1) * p.dot(q).scale(2.0) + s(2) * q.dot(q);
        return energy + twice.scale(0.5);
    }
    for k in 0..3 {
        let eta = 2.0 * GAUSS_3.xi[k] - 1.0;
        let (v, u) = (line.tangent(eta), line.second(eta));
        let w = column.get(place::BENDING + k);
        let a = v.dot_add(v, column.get(place::GUARD));
        let b = u.dot(u);
        let curved = column.get(place::CURVATURE + k);
        energy = match (law.bending, law.reference) {
            (Bending::Exact, Reference::Straight) => energy + bending_energy(w, v, u, a),
            (Bending::Exact, Reference::Planar) => {
                energy + bending_energy(w, v, u, a) - curved * normal(column).dot(v.cross(u)) / a
            }
            (Bending::Simplified, _) => {
                let root = (b + column.get(place::CURVATURE_SMOOTHING + k)).sqrt();
                energy + w * (b.scale(0.5) - curved * root)
            }
        };
    }
    energy
}

/// Work spent on plastic flow since the state that the points remember: with the elastic energy it is the potential of
/// the forces.
#[inline(always)]
pub(crate) fn plastic_work<T: Real>(law: CableLaw, column: impl Column<T>, x: &Nodal<T>) -> T {
    let line = Line::new(x, column.get(place::INVERSE_LENGTH));
    let mut work = column.get(place::GUARD).zero();
    let mut axial = |k: usize, xi: f64| {
        let v = line.tangent(2.0 * xi - 1.0);
        let (eps, _) = strain(law, column, k, v.dot_add(v, column.get(place::GUARD)));
        work = column.get(place::AXIAL + k).mul_add(work_at(law, column, k, eps), work);
    };
    match law.integration {
        Integration::Lobatto => (0..3).for_each(|k| axial(k, LOBATTO_3.xi[k])),
        Integration::Full => (0..5).for_each(|k| axial(k, GAUSS_5.xi[k])),
    }
    work
}

/// Plastic work over EA at point `k`: the stress along the flow times the flow. It is linear in the flow, or nearly so
/// where it lies within the passage to slack.
#[inline(always)]
fn work_at<T: Real>(law: CableLaw, column: impl Column<T>, k: usize, eps: T) -> T {
    let past = column.past(k);
    let step = flow(law, past, eps).step;
    let (back, bound) = past.range();
    let first = step.select_positive(back + bound, back - bound);
    let change = (past.isotropic + past.kinematic) * step;
    let mut mean = step.zero();
    for (xi, weight) in GAUSS_5.xi.into_iter().zip(GAUSS_5.weight) {
        let stress = elastic_law(law, column, change.mul_add(step.constant(xi), first)).0;
        mean = stress.mul_add(step.constant(weight), mean);
    }
    mean * step
}

/// `w/2 |v x u|^2/A^2`.
#[inline(always)]
fn bending_energy<T: Real>(w: T, v: Vec3<T>, u: Vec3<T>, a: T) -> T {
    let x = v.cross(u);
    (w * x.dot(x) / (a * a)).scale(0.5)
}

/// Energy over EA at elastic strain `eps`: the integral of [`elastic_law`].
#[inline(always)]
fn axial_energy<T: Real>(law: CableLaw, column: impl Column<T>, eps: T) -> T {
    let square = (eps * eps).scale(0.5);
    if !law.tension_only {
        return square;
    }
    let (rho, width) = (column.get(place::RESIDUAL), column.get(place::SMOOTHING));
    let half = (eps.constant(1.0) - rho).scale(0.5);
    let root = eps.mul_add(eps, width * width).sqrt();
    // The integral of sqrt(eps^2 + d^2).
    let smooth = (eps * root + width * width * (eps / width).asinh()).scale(0.5);
    half * (square + smooth - width * eps) + rho * square
}

/// Axial strain and elastic axial force over EA at mid-element.
pub(crate) fn mid_strain_and_force(
    law: CableLaw,
    column: impl Column<f64>,
    x: &Nodal<f64>,
    scale: Scale<f64>,
) -> (f64, f64) {
    let v = Line::new(x, column.get(place::INVERSE_LENGTH)).middle().scale(scale.inverse);
    // The middle is point 1 of the Lobatto rule and point 2 of the 5-point Gauss rule.
    let k = match law.integration {
        Integration::Lobatto => 1,
        Integration::Full => 2,
    };
    let (eps, _) = strain(law, column, k, v.dot_add(v, column.get(place::GUARD)));
    (eps, axial_law(law, column, k, eps).force)
}

/// `r' x r''/|r'|^2` at mid-element [1/m], per stress-free length.
pub(crate) fn curvature(column: impl Column<f64>, x: &Nodal<f64>, scale: Scale<f64>) -> [f64; 3] {
    let line = Line::new(x, column.get(place::INVERSE_LENGTH));
    let v = line.middle();
    let scale = column.get(place::INVERSE_LENGTH) * scale.inverse / v.dot(v);
    v.cross(line.second(0.0)).times(scale).array()
}
