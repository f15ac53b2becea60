//! The vectorised evaluation of elements: rows of shape functions run along vector registers, `W` wide (nodal vectors,
//! padded), `R` rows a point (5, or 2 of membranes).
//!
//! Force: the five vectors at all points are one product of the rows with the nodal vectors, nodal forces another one
//! with the gradients. Tangent: the block between components c and d is `rows^T (X_cd rows)`, X the second derivatives
//! at the points.

use pliant_math::Vec3;
use pulp::Simd;

use super::SurfaceBlock;
use super::point::{
    Frame, Hessian, PAIRS, Vectors, hessian, membrane_gradient, membrane_hessian, membrane_rates,
    membrane_strain,
};
use super::precomputed::{self, Blocks};
use crate::element::{Motion, Weights};
use crate::integrals::surface::Table;
use crate::materials::Voigt;

/// Rows of all points of a rule at most, padded.
const MOST: usize = 184;
/// Points of a rule at most.
const MOST_POINTS: usize = 36;
/// Widest element.
pub(super) const WIDEST: usize = 16;

/// Components of the nodal vectors, padded.
pub(super) type Nodal<const W: usize> = [[f64; W]; 3];
/// Components of row products.
type Products = [[f64; MOST]; 3];

/// Scratch of one thread.
#[derive(Clone, Debug)]
pub(crate) struct Scratch {
    x: Products,
    v: Products,
    rows: [[f64; WIDEST]; MOST],
    products: [[f64; WIDEST]; MOST],
    hessians: [Hessian; MOST_POINTS],
    block: [[f64; WIDEST]; WIDEST],
    precomputed: Blocks,
}

impl Default for Scratch {
    fn default() -> Self {
        Self {
            x: [[0.0; MOST]; 3],
            v: [[0.0; MOST]; 3],
            rows: [[0.0; WIDEST]; MOST],
            products: [[0.0; WIDEST]; MOST],
            hessians: [[[[0.0; 5]; 5]; 6]; MOST_POINTS],
            block: [[0.0; WIDEST]; WIDEST],
            precomputed: [[[0.0; WIDEST]; WIDEST]; 6],
        }
    }
}

#[inline(always)]
fn load<S: Simd>(simd: S, from: &[f64]) -> S::f64s {
    match S::as_simd_f64s(from).0 {
        [first, ..] => *first,
        [] => simd.splat_f64s(0.0),
    }
}

#[inline(always)]
fn store<S: Simd>(to: &mut [f64], value: S::f64s) {
    if let [first, ..] = S::as_mut_simd_f64s(to).0 {
        *first = value;
    }
}

#[inline(always)]
fn gather<const W: usize>(offsets: &[u32], from: &[f64]) -> Nodal<W> {
    let mut to = [[0.0; W]; 3];
    for (i, &offset) in offsets.iter().enumerate().take(W) {
        let x = &from[offset as usize..offset as usize + 3];
        for c in 0..3 {
            to[c][i] = x[c];
        }
    }
    to
}

/// All rows times the nodal vectors.
#[inline(always)]
fn contract<S: Simd, const W: usize>(simd: S, table: &Table, q: &Nodal<W>, out: &mut Products) {
    let mut k = 0;
    while k < table.stride {
        let mut sums = [simd.splat_f64s(0.0); 3];
        for i in 0..W {
            let column = load(simd, &table.columns[i * table.stride + k..]);
            for c in 0..3 {
                sums[c] = simd.mul_add_e_f64s(column, simd.splat_f64s(q[c][i]), sums[c]);
            }
        }
        for c in 0..3 {
            store::<S>(&mut out[c][k..], sums[c]);
        }
        k += S::F64_LANES;
    }
}

#[inline(always)]
fn vector(x: &Products, k: usize) -> Vec3<f64> {
    Vec3::new(x[0][k], x[1][k], x[2][k])
}

#[inline(always)]
fn vectors<const R: usize>(x: &Products, point: usize) -> Vectors<f64> {
    let k = R * point;
    let a = [vector(x, k), vector(x, k + 1)];
    let h = if R == 5 {
        [vector(x, k + 2), vector(x, k + 3), vector(x, k + 4)]
    } else {
        [Vec3::zero(0.0); 3]
    };
    Vectors { a, h }
}

#[inline(always)]
fn set(to: &mut Products, k: usize, x: Vec3<f64>) {
    let x = x.array();
    for c in 0..3 {
        to[c][k] = x[c];
    }
}

/// `factor x` added to `to`.
#[inline(always)]
fn add(to: &mut Voigt<f64>, factor: f64, x: Voigt<f64>) {
    for k in 0..3 {
        to[k] += factor * x[k];
    }
}

/// The membrane strain that the law sees.
#[inline(always)]
fn seen(block: &SurfaceBlock, mut e: Voigt<f64>, rates: Option<[Voigt<f64>; 2]>) -> Voigt<f64> {
    if let Some([rate, _]) = rates
        && block.law.material.is_one_sided()
    {
        add(&mut e, block.law.retardation_time, rate);
    }
    e
}

/// Resultants at a strain and its rate, for each area of the point.
#[inline(always)]
fn resultants(
    block: &SurfaceBlock,
    h: f64,
    [e, k]: [Voigt<f64>; 2],
    rates: Option<[Voigt<f64>; 2]>,
    areas: [f64; 2],
) -> [Voigt<f64>; 2] {
    let [mut n, mut m] = block.law.material.resultants(h, seen(block, e, rates), k);
    if let Some([e, k]) = rates {
        let tau = block.law.retardation_time;
        let linear = block.linear;
        if !block.law.material.is_one_sided() {
            add(&mut n, tau * h, linear.stress(e));
        }
        add(&mut m, tau * h * h * h / 12.0, linear.stress(k));
    }
    (n, m) = (n.map(|n| areas[0] * n), m.map(|m| areas[1] * m));
    [n, m]
}

/// `M (a - g) + f(q, v)` of element `e`.
#[inline(always)]
pub(super) fn residual<S: Simd, const W: usize, const R: usize>(
    simd: S,
    block: &SurfaceBlock,
    e: usize,
    motion: Motion<'_>,
    gravity: [f64; 3],
    scratch: &mut Scratch,
) -> Nodal<W> {
    let (table, offsets, h) = block.element(e);
    let Scratch { x, v, .. } = scratch;
    contract(simd, table, &gather::<W>(offsets, motion.q), x);
    if block.is_damped() {
        contract(simd, table, &gather::<W>(offsets, motion.v), v);
    }
    for p in 0..table.points {
        let here = vectors::<R>(x, p);
        let rate = if block.is_damped() { Some(vectors::<R>(v, p)) } else { None };
        if R == 5 {
            let frame = Frame::new(&here, table.curvature[p]);
            let rates = match rate {
                Some(rate) => Some(frame.rates(&here, &rate)),
                None => None,
            };
            let strains = [frame.membrane, frame.bending];
            let [n, m] = resultants(block, h, strains, rates, table.areas[p]);
            let on = frame.gradient(&here, n, m);
            set(x, 5 * p, on.a[0]);
            set(x, 5 * p + 1, on.a[1]);
            for k in 0..3 {
                set(x, 5 * p + 2 + k, on.h[k]);
            }
        } else {
            let strain = [membrane_strain(&here.a), [0.0; 3]];
            let rates = match rate {
                Some(rate) => Some([membrane_rates(&here.a, &rate.a), [0.0; 3]]),
                None => None,
            };
            let [n, _] = resultants(block, h, strain, rates, table.areas[p]);
            let on = membrane_gradient(&here.a, n);
            set(x, 2 * p, on[0]);
            set(x, 2 * p + 1, on[1]);
        }
    }
    let mut a = gather::<W>(offsets, motion.a);
    for i in block.positions() {
        for c in 0..3 {
            a[c][i] -= gravity[c];
        }
    }
    let mass = block.density * h;
    let mut f = [[0.0; W]; 3];
    let mut i = 0;
    while i < W {
        let mut sums = [simd.splat_f64s(0.0); 3];
        for j in 0..W {
            let row = load(simd, &table.mass[j * W + i..]);
            for c in 0..3 {
                sums[c] = simd.mul_add_e_f64s(row, simd.splat_f64s(mass * a[c][j]), sums[c]);
            }
        }
        for k in 0..R * table.points {
            let row = load(simd, &table.rows[k * W + i..]);
            for c in 0..3 {
                sums[c] = simd.mul_add_e_f64s(row, simd.splat_f64s(x[c][k]), sums[c]);
            }
        }
        for c in 0..3 {
            store::<S>(&mut f[c][i..], sums[c]);
        }
        i += S::F64_LANES;
    }
    if table.has_integrals() {
        let q = gather::<W>(offsets, motion.q);
        let v = block.is_damped().then(|| gather::<W>(offsets, motion.v));
        precomputed::add_forces(block, table, h, &q, v.as_ref(), &mut f);
    }
    f
}

/// Resultants at `here` as the linearisation one `increment` ago predicts them, for each area of the point.
#[inline(always)]
fn predict<const R: usize>(
    block: &SurfaceBlock,
    h: f64,
    here: &Vectors<f64>,
    increment: &Vectors<f64>,
    reference: [f64; 3],
    areas: [f64; 2],
) -> [Voigt<f64>; 2] {
    let then = Vectors {
        a: std::array::from_fn(|k| here.a[k] - increment.a[k]),
        h: std::array::from_fn(|k| here.h[k] - increment.h[k]),
    };
    let ([e, k], [de, dk]) = if R == 5 {
        let frame = Frame::new(&then, reference);
        ([frame.membrane, frame.bending], frame.rates(&then, increment))
    } else {
        let rates = membrane_rates(&then.a, &increment.a);
        ([membrane_strain(&then.a), [0.0; 3]], [rates, [0.0; 3]])
    };
    let [mut n, mut m] = block.law.material.resultants(h, e, k);
    let d = block.law.material.stiffness(h, e, k);
    for i in 0..3 {
        for j in 0..3 {
            n[i] += d[i][j] * de[j] + d[i][3 + j] * dk[j];
            m[i] += d[3 + i][j] * de[j] + d[3 + i][3 + j] * dk[j];
        }
    }
    [n.map(|n| areas[0] * n), m.map(|m| areas[1] * m)]
}

/// Rows and second derivatives at all points; where `predicted`, `motion.v` is an increment.
#[inline(always)]
fn linearise<S: Simd, const W: usize, const R: usize>(
    simd: S,
    block: &SurfaceBlock,
    e: usize,
    motion: Motion<'_>,
    weights: Weights,
    predicted: bool,
    scratch: &mut Scratch,
) {
    let (table, offsets, h) = block.element(e);
    let Scratch { x, v, rows, hessians, .. } = scratch;
    contract(simd, table, &gather::<W>(offsets, motion.q), x);
    let moving = predicted || block.is_damped();
    if moving {
        contract(simd, table, &gather::<W>(offsets, motion.v), v);
    }
    for p in 0..table.points {
        let here = vectors::<R>(x, p);
        let rate = if moving { Some(vectors::<R>(v, p)) } else { None };
        let [membrane, bending] = table.areas[p];
        let scaled = |[e, k]: [Voigt<f64>; 2], rates: Option<[Voigt<f64>; 2]>| {
            let mut d = block.law.material.stiffness(h, seen(block, e, rates), k);
            let within = block.law.material.is_one_sided();
            let tau = weights.damping * block.law.retardation_time;
            let along = weights.stiffness + if within { tau } else { 0.0 };
            for i in 0..3 {
                for j in 0..3 {
                    d[i][j] *= along * membrane;
                    d[i][3 + j] *= weights.stiffness * bending;
                    d[3 + i][j] *= weights.stiffness * bending;
                    d[3 + i][3 + j] *= weights.stiffness * bending;
                }
            }
            if block.is_damped() {
                let c = block.linear.matrix();
                let beside = if within { 0.0 } else { tau * h * membrane };
                for i in 0..3 {
                    for j in 0..3 {
                        d[i][j] += beside * c[i][j];
                        d[3 + i][3 + j] += tau * h * h * h / 12.0 * bending * c[i][j];
                    }
                }
            }
            d
        };
        let geometric = [weights.stiffness * membrane, weights.stiffness * bending];
        for s in 0..2 {
            let from = (R * p + s) * W;
            rows[R * p + s][..W].copy_from_slice(&table.rows[from..from + W]);
        }
        if R == 5 {
            let frame = Frame::new(&here, table.curvature[p]);
            let strains = [frame.membrane, frame.bending];
            let rates = match rate {
                Some(rate) if !predicted => Some(frame.rates(&here, &rate)),
                _ => None,
            };
            let [n, m] = match rate {
                Some(d) if predicted => {
                    predict::<R>(block, h, &here, &d, table.curvature[p], geometric)
                }
                _ => resultants(block, h, strains, rates, geometric),
            };
            let d = scaled(strains, rates);
            hessian(&frame, &here, n, m, &d, &mut hessians[p]);
            for k in 0..3 {
                // Covariant second derivative: W_ij = H_ij - G^c_ij B_c.
                let christoffel = frame.dual.map(|a| simd.splat_f64s(-a.dot(here.h[k])));
                let from = (5 * p + 2 + k) * W;
                let mut i = 0;
                while i < W {
                    let mut row = load(simd, &table.rows[from + i..]);
                    for c in 0..2 {
                        let b = load(simd, &table.rows[(5 * p + c) * W + i..]);
                        row = simd.mul_add_e_f64s(christoffel[c], b, row);
                    }
                    store::<S>(&mut rows[5 * p + 2 + k][i..], row);
                    i += S::F64_LANES;
                }
            }
        } else {
            let strain = [membrane_strain(&here.a), [0.0; 3]];
            let rates = match rate {
                Some(rate) if !predicted => Some([membrane_rates(&here.a, &rate.a), [0.0; 3]]),
                _ => None,
            };
            let [n, _] = match rate {
                Some(d) if predicted => predict::<R>(block, h, &here, &d, [0.0; 3], geometric),
                _ => resultants(block, h, strain, rates, geometric),
            };
            let d = scaled(strain, rates);
            membrane_hessian(&here.a, n, &d, &mut hessians[p]);
        }
    }
}

/// Rows of a tile of the product.
const TILE: usize = 8;

/// The weighted tangent of element `e`: lower triangle by rows.
#[inline(always)]
pub(super) fn tangent<S: Simd, const W: usize, const R: usize>(
    simd: S,
    block: &SurfaceBlock,
    e: usize,
    motion: Motion<'_>,
    weights: Weights,
    predicted: bool,
    scratch: &mut Scratch,
    out: &mut [f64],
) {
    linearise::<S, W, R>(simd, block, e, motion, weights, predicted, scratch);
    let (table, offsets, h) = block.element(e);
    let n = offsets.len();
    let count = R * table.points;
    let mass = weights.mass * block.density * h;
    let Scratch { rows, products, hessians, block: part, precomputed: blocks, .. } = scratch;
    if table.has_integrals() {
        let q = gather::<W>(offsets, motion.q);
        let moving = predicted || block.is_damped();
        let v = moving.then(|| gather::<W>(offsets, motion.v));
        precomputed::tangents(block, table, h, &q, (v.as_ref(), predicted), weights, blocks);
    }
    for (pair, (c, d)) in PAIRS.into_iter().enumerate() {
        for p in 0..table.points {
            let x = &hessians[p][pair];
            let mut i = 0;
            while i < W {
                for s in 0..R {
                    let mut sum = simd.splat_f64s(0.0);
                    for t in 0..R {
                        let row = load(simd, &rows[R * p + t][i..]);
                        sum = simd.mul_add_e_f64s(simd.splat_f64s(x[s][t]), row, sum);
                    }
                    store::<S>(&mut products[R * p + s][i..], sum);
                }
                i += S::F64_LANES;
            }
        }
        let mut j = 0;
        while j < W {
            for tile in (0..W).step_by(TILE) {
                // Of the symmetric blocks the lower triangle is enough.
                if c == d && j > tile + TILE - 1 {
                    continue;
                }
                let mut sums = [simd.splat_f64s(0.0); TILE];
                if c == d && mass != 0.0 {
                    let factor = simd.splat_f64s(mass);
                    for (i, sum) in sums.iter_mut().enumerate() {
                        let row = load(simd, &table.mass[(tile + i) * W + j..]);
                        *sum = simd.mul_f64s(factor, row);
                    }
                }
                for k in 0..count {
                    let product = load(simd, &products[k][j..]);
                    let left = &rows[k][tile..tile + TILE];
                    for i in 0..TILE {
                        sums[i] = simd.mul_add_e_f64s(simd.splat_f64s(left[i]), product, sums[i]);
                    }
                }
                for (i, sum) in sums.into_iter().enumerate() {
                    store::<S>(&mut part[tile + i][j..], sum);
                }
            }
            j += S::F64_LANES;
        }
        if table.has_integrals() {
            for (part, more) in part.iter_mut().zip(&blocks[pair]) {
                for (part, more) in part.iter_mut().zip(more) {
                    *part += more;
                }
            }
        }
        scatter(part, n, c, d, out);
    }
}

/// Writes the block between components c >= d to the lower triangle of the element's matrix.
#[inline(always)]
fn scatter(part: &[[f64; WIDEST]; WIDEST], n: usize, c: usize, d: usize, out: &mut [f64]) {
    let start = |row: usize| row * (row + 1) / 2;
    for i in 0..n {
        let to = &mut out[start(3 * i + c)..];
        for j in 0..=i {
            to[3 * j + d] = part[i][j];
        }
    }
    if c != d {
        // Above the block's diagonal: entry (3 i + c, 3 j + d), i < j, is (3 j + d, 3 i + c) of the lower triangle.
        for j in 0..n {
            let to = &mut out[start(3 * j + d)..];
            for i in 0..j {
                to[3 * i + c] = part[i][j];
            }
        }
    }
}
