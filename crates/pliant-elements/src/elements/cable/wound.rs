//! Cables on a winch: the stress-free length is scaled by lambda, the mass stays.
//!
//! The coordinate x of the line counts its mass and never changes; the stress-free arc length is `X = lambda x`. Seen
//! by X the element is an ordinary one of length lambda L, with the slopes `dr/dX = t / lambda`: strains and curvatures
//! are measured against the scaled line, energy densities are integrated over it. Every precomputed number of the
//! elastic part is a power of the length, so the ordinary kernels run on scaled columns and scaled slopes, and forces
//! on the slopes come back divided by lambda.
//!
//! Rates: `d/dt (dr/dX) = (v' - mu r')/lambda` with `mu = lambda_rate/lambda`, which is the rate of nodes that move by
//! `v - mu x`. Bending is damped by the rate of the angle between the sections, on which mu has no part.
//!
//! The winch does work by `dU/dlambda`, and likewise of the damping: an axial energy is of degree 1, one of bending of
//! degree -1 in the length, and the slopes and differences of degree -1, so that with the forces f on the scaled nodes
//! `dU/dlambda = (U_axial - U_bending - f.x)/lambda`. What a winch lets out or hauls in is as strained as what hangs,
//! plastic strains included: those stay while the length changes.

use pliant_math::Real;
use pliant_math::quadrature::{GAUSS_5, LOBATTO_3};

use super::force::Rates;
use super::{
    Bending, CableLaw, Column, Integration, Line, Nodal, Past, elastic_energy, force, place,
    plastic_work, strain, tangent,
};
use crate::element::Weights;

/// Factor of the stress-free length, its inverse, and its rate over it [1/s].
#[derive(Clone, Copy, Debug)]
pub(crate) struct Scale<T> {
    pub length: T,
    pub inverse: T,
    pub rate: T,
}

/// The numbers of an element of scaled length.
#[derive(Clone, Copy)]
struct Scaled<C, T> {
    column: C,
    law: CableLaw,
    scale: Scale<T>,
}

impl<T: Real, C: Column<T>> Column<T> for Scaled<C, T> {
    #[inline(always)]
    fn get(self, at: usize) -> T {
        let Scale { length, inverse, .. } = self.scale;
        let number = self.column.get(at);
        match at {
            place::INVERSE_LENGTH | place::ENERGY => number * inverse,
            // The mass of scaled slopes: that of the slopes comes out of the tangent unchanged.
            place::MASS..place::AXIAL => match slopes(at - place::MASS) {
                0 => number,
                1 => number * length,
                _ => number * length * length,
            },
            place::AXIAL..place::AXIAL_METRIC => number * length,
            place::BENDING..place::TAU => number * inverse,
            place::CURVATURE..place::CURVATURE_SMOOTHING if self.law.bending == Bending::Exact => {
                number * inverse
            }
            _ => number,
        }
    }

    #[inline(always)]
    fn gram(self, k: usize) -> T {
        let number = self.column.gram(k);
        if k < 21 { number * self.scale.length } else { number }
    }

    #[inline(always)]
    fn past(self, k: usize) -> Past<T> {
        self.column.past(k)
    }
}

/// How many slopes there are among the row and the column of entry `k` of a 4x4 matrix by its lower triangle.
#[inline(always)]
const fn slopes(k: usize) -> usize {
    let row = match k {
        0 => 0,
        1 | 2 => 1,
        3..=5 => 2,
        _ => 3,
    };
    let column = k - row * (row + 1) / 2;
    row % 2 + column % 2
}

/// Nodes with slopes by the scaled arc length.
#[inline(always)]
fn nodes<T: Real>(x: &Nodal<T>, scale: Scale<T>) -> Nodal<T> {
    [x[0], x[1].times(scale.inverse), x[2], x[3].times(scale.inverse)]
}

/// Their rates.
#[inline(always)]
fn rates<T: Real>(x: &Nodal<T>, v: &Nodal<T>, scale: Scale<T>) -> Nodal<T> {
    let mu = -scale.rate;
    let v = [
        v[0].add_times(mu, x[0]),
        v[1].add_times(mu, x[1]),
        v[2].add_times(mu, x[2]),
        v[3].add_times(mu, x[3]),
    ];
    nodes(&v, scale)
}

/// [`force`] of an element of scaled length.
#[inline(always)]
pub(crate) fn wound_force<T: Real>(
    law: CableLaw,
    column: impl Column<T>,
    x: &Nodal<T>,
    v: Rates<'_, T>,
    scale: Scale<T>,
) -> Nodal<T> {
    let moving = v.map(|v| rates(x, v, scale));
    let column = Scaled { column, law, scale };
    nodes(&force(law, column, &nodes(x, scale), moving.as_ref()), scale)
}

/// [`tangent`] of an element of scaled length. What the rate of the length adds to the derivatives of damping forces,
/// of order tau mu, is left out like other terms of that order.
#[inline(always)]
pub(crate) fn wound_tangent<T: Real>(
    law: CableLaw,
    column: impl Column<T>,
    x: &Nodal<T>,
    v: Rates<'_, T>,
    weights: Weights,
    scale: Scale<T>,
    mut store: impl FnMut(usize, T),
) {
    let moving = v.map(|v| rates(x, v, scale));
    let column = Scaled { column, law, scale };
    let inverse = scale.inverse;
    let square = inverse * inverse;
    tangent(law, column, &nodes(x, scale), moving.as_ref(), weights, |k, value| {
        let value = match POWERS[k] {
            0 => value,
            1 => value * inverse,
            _ => value * square,
        };
        store(k, value);
    });
}

/// How many slopes there are among row and column of each entry of an element matrix.
const POWERS: [u8; 78] = {
    let mut powers = [0; 78];
    let (mut i, mut k) = (0, 0);
    while i < 12 {
        let mut j = 0;
        while j <= i {
            powers[k] = ((i / 3) % 2 + (j / 3) % 2) as u8;
            k += 1;
            j += 1;
        }
        i += 1;
    }
    powers
};

/// [`elastic_energy`] of an element of scaled length.
#[inline(always)]
pub(crate) fn wound_energy<T: Real>(
    law: CableLaw,
    column: impl Column<T>,
    x: &Nodal<T>,
    scale: Scale<T>,
) -> T {
    elastic_energy(law, Scaled { column, law, scale }, &nodes(x, scale))
}

/// [`plastic_work`] of an element of scaled length.
#[inline(always)]
pub(crate) fn wound_plastic_work<T: Real>(
    law: CableLaw,
    column: impl Column<T>,
    x: &Nodal<T>,
    scale: Scale<T>,
) -> T {
    plastic_work(law, Scaled { column, law, scale }, &nodes(x, scale))
}

/// Strains at the axial points of an element of scaled length; the last of five are unused where the rule has three.
pub(crate) fn wound_strains(
    law: CableLaw,
    column: impl Column<f64>,
    x: &Nodal<f64>,
    scale: Scale<f64>,
) -> [f64; 5] {
    let line = Line::new(&nodes(x, scale), column.get(place::INVERSE_LENGTH) * scale.inverse);
    let at = |k: usize, xi: f64| {
        let v = line.tangent(2.0 * xi - 1.0);
        strain(law, column, k, v.dot_add(v, column.get(place::GUARD))).0
    };
    match law.integration {
        Integration::Lobatto => {
            let [a, b, c] = LOBATTO_3.xi;
            [at(0, a), at(1, b), at(2, c), 0.0, 0.0]
        }
        Integration::Full => std::array::from_fn(|k| at(k, GAUSS_5.xi[k])),
    }
}

/// Forces on the factor of the length, elastic and of damping: their product with its rate is the power of the winch.
/// `axial` are the numbers of the axial part alone.
pub(crate) fn length_forces(
    law: CableLaw,
    column: impl Column<f64>,
    axial: impl Column<f64>,
    x: &Nodal<f64>,
    v: Rates<'_, f64>,
    scale: Scale<f64>,
) -> [f64; 2] {
    let work = |v: Rates<'_, f64>| -> f64 {
        let f = wound_force(law, column, x, v, scale);
        (0..4).map(|k| f[k].dot(x[k])).sum()
    };
    let total = wound_energy(law, column, x, scale);
    // The constant of the energy belongs to bending.
    let constant = column.get(place::ENERGY) * scale.inverse;
    let axial = wound_energy(law, axial, x, scale) + constant;
    let elastic = work(None);
    let damping = if v.is_some() { work(v) - elastic } else { 0.0 };
    [(2.0 * axial - total - elastic) * scale.inverse, -damping * scale.inverse]
}
