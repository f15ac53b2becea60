//! Forces and tangents from integrals computed once: of the membrane, and of simplified bending
//! (`integrals/invariants.rs`).

use pliant_math::{Real, Vec3};

use super::SurfaceBlock;
use super::kernel::{Nodal, WIDEST};
use super::point::PAIRS;
use crate::element::Weights;
use crate::integrals::invariants::{Membrane, pair};
use crate::integrals::surface::Table;

/// Nodal vectors at most, of precomputed membranes, and their pairs, padded.
const MOST: usize = 12;
const MOST_PAIRS: usize = 80;

/// Blocks of a tangent between components, one for each of [`PAIRS`].
pub(super) type Blocks = [[[f64; WIDEST]; WIDEST]; 6];

/// Positions from the first one on: strains do not know where the element is, and rounding need not either.
#[inline(always)]
fn local<const W: usize>(block: &SurfaceBlock, q: &Nodal<W>) -> Nodal<W> {
    let mut out = *q;
    for c in 0..3 {
        for i in block.positions() {
            out[c][i] -= q[c][0];
        }
    }
    out
}

/// `a_i.b_j + a_j.b_i` for each pair.
#[inline(always)]
fn products<const W: usize>(n: usize, a: &Nodal<W>, b: &Nodal<W>) -> [f64; MOST_PAIRS] {
    let mut out = [0.0; MOST_PAIRS];
    for j in 0..n.min(MOST) {
        for i in 0..=j {
            for c in 0..3 {
                out[pair(i, j)] += a[c][i] * b[c][j] + a[c][j] * b[c][i];
            }
        }
    }
    out
}

/// S for unit thickness at `2 G`, with the viscous part of `(tau, dG/dt)`.
#[inline(always)]
fn stresses<const W: usize>(
    membrane: &Membrane,
    n: usize,
    twice: &[f64; MOST_PAIRS],
    viscous: Option<(f64, [f64; MOST_PAIRS])>,
) -> [[f64; W]; W] {
    let mut strain = [0.0; MOST_PAIRS];
    for ((strain, twice), reference) in strain.iter_mut().zip(twice).zip(&membrane.reference) {
        *strain = 0.5 * twice - reference;
    }
    if let Some((tau, rates)) = viscous {
        for (strain, rate) in strain.iter_mut().zip(&rates) {
            *strain += tau * rate;
        }
    }
    let mut d = [0.0; MOST_PAIRS];
    for (row, x) in membrane.quadratic.chunks_exact(membrane.stride).zip(&strain) {
        for (d, k) in d.iter_mut().zip(row) {
            *d += k * x;
        }
    }
    let mut s = [[0.0; W]; W];
    for j in 0..n.min(MOST) {
        for i in 0..j {
            s[i][j] = d[pair(i, j)];
            s[j][i] = s[i][j];
        }
        s[j][j] = 2.0 * d[pair(j, j)];
    }
    s
}

/// `f += factor S q`, S symmetric.
#[inline(always)]
fn add_force<const W: usize>(factor: f64, s: &[[f64; W]; W], q: &Nodal<W>, f: &mut Nodal<W>) {
    for c in 0..3 {
        for j in 0..W {
            let x = factor * q[c][j];
            for i in 0..W {
                f[c][i] += s[j][i] * x;
            }
        }
    }
}

/// A matrix row by row.
#[inline(always)]
fn square<const W: usize>(matrix: &[f64]) -> [[f64; W]; W] {
    let mut out = [[0.0; W]; W];
    for (out, row) in out.iter_mut().zip(matrix.chunks_exact(W)) {
        out.copy_from_slice(row);
    }
    out
}

/// Adds the forces that need no quadrature; `v` of damped blocks.
#[inline(always)]
pub(super) fn add_forces<const W: usize>(
    block: &SurfaceBlock,
    table: &Table,
    h: f64,
    q: &Nodal<W>,
    v: Option<&Nodal<W>>,
    f: &mut Nodal<W>,
) {
    let n = block.kind.vectors();
    let q = &local(block, q);
    if let Some(membrane) = &table.membrane {
        let viscous = v.map(|v| (block.law.retardation_time, products(n, q, &local(block, v))));
        add_force(h, &stresses::<W>(membrane, n, &products(n, q, q), viscous), q, f);
    }
    if let Some(bending) = &table.bending {
        add_force(h * h * h / 12.0, &square::<W>(bending), q, f);
    }
}

/// The weighted tangent's part that needs no quadrature; `v` as in [`add_forces`], or the increment where forces are
/// `predicted`.
#[inline(always)]
pub(super) fn tangents<const W: usize>(
    block: &SurfaceBlock,
    table: &Table,
    h: f64,
    q: &Nodal<W>,
    (v, predicted): (Option<&Nodal<W>>, bool),
    weights: Weights,
    out: &mut Blocks,
) {
    let n = block.kind.vectors();
    *out = [[[0.0; WIDEST]; WIDEST]; 6];
    let q = &local(block, q);
    let v = v.map(|v| local(block, v));
    if let Some(membrane) = &table.membrane {
        let tau = block.law.retardation_time;
        let mut twice = products(n, q, q);
        let mut viscous = None;
        match v {
            // The square of the increment is what a linearisation misses.
            Some(d) if predicted => {
                for (g, d) in twice.iter_mut().zip(products(n, &d, &d)) {
                    *g -= d;
                }
            }
            Some(v) => viscous = Some((tau, products(n, q, &v))),
            None => {}
        }
        let s = stresses::<W>(membrane, n, &twice, viscous);
        let material = 4.0 * h * (weights.stiffness + tau * weights.damping);
        let row = n * W;
        for i in 0..n.min(MOST) {
            // Derivatives of row i of S, times the nodal vectors from the left.
            let mut left = [[0.0; MOST * WIDEST]; 3];
            for (j, tensor) in membrane.tensor[i * n * row..].chunks_exact(row).take(n).enumerate()
            {
                for c in 0..3 {
                    let x = material * q[c][j];
                    for (to, t) in left[c][..row].iter_mut().zip(tensor) {
                        *to += t * x;
                    }
                }
            }
            for (out, (c, d)) in out.iter_mut().zip(PAIRS) {
                for (k, left) in left[c][..row].chunks_exact(W).enumerate() {
                    let mut sum = 0.0;
                    for l in 0..W {
                        sum += left[l] * q[d][l];
                    }
                    let same = if c == d { weights.stiffness * h * s[i][k] } else { 0.0 };
                    out[i][k] += sum + same;
                }
            }
        }
    }
    if let Some(bending) = &table.bending {
        let factor = weights.stiffness * h * h * h / 12.0;
        for (out, (c, d)) in out.iter_mut().zip(PAIRS) {
            if c == d {
                for (out, row) in out.iter_mut().zip(bending.chunks_exact(W)) {
                    for (out, k) in out.iter_mut().zip(row) {
                        *out += factor * k;
                    }
                }
            }
        }
    }
}

/// As [`local`], over any kind of number.
fn local_of<T: Real>(block: &SurfaceBlock, q: &[Vec3<T>]) -> Vec<Vec3<T>> {
    let mut out = q.to_vec();
    for i in block.positions() {
        out[i] = out[i] - q[0];
    }
    out
}

/// Products of pairs over any kind of number.
fn pairs<T: Real>(n: usize, product: impl Fn(usize, usize) -> T) -> Vec<T> {
    (0..n).flat_map(|j| (0..=j).map(move |i| (i, j))).map(|(i, j)| product(i, j)).collect()
}

/// `KK x`, row p.
fn row<T: Real>(membrane: &Membrane, p: usize, x: &[T]) -> T {
    let row = &membrane.quadratic[p * membrane.stride..];
    x.iter().zip(row).fold(x[0].zero(), |sum, (x, k)| sum + x.scale(*k))
}

/// Energy of what needs no quadrature.
pub(super) fn energy<T: Real>(block: &SurfaceBlock, table: &Table, h: f64, q: &[Vec3<T>]) -> T {
    let (n, width) = (q.len(), block.width());
    let q = local_of(block, q);
    let mut sum = q[0].x.zero();
    if let Some(membrane) = &table.membrane {
        let strain = pairs(n, |i, j| {
            let product = q[i].dot(q[j]);
            product - product.constant(membrane.reference[pair(i, j)])
        });
        for (p, &x) in strain.iter().enumerate() {
            sum = sum + (row(membrane, p, &strain) * x).scale(0.5 * h);
        }
    }
    if let Some(bending) = &table.bending {
        for i in 0..n {
            for j in 0..n {
                sum = sum + q[i].dot(q[j]).scale(h * h * h / 24.0 * bending[i * width + j]);
            }
        }
    }
    sum
}

/// Adds its force.
pub(super) fn add_force_of<T: Real>(
    block: &SurfaceBlock,
    table: &Table,
    h: f64,
    (q, v): (&[Vec3<T>], &[Vec3<T>]),
    force: &mut [Vec3<T>],
) {
    let (n, width, tau) = (q.len(), block.width(), block.law.retardation_time);
    let (q, v) = (local_of(block, q), local_of(block, v));
    if let Some(membrane) = &table.membrane {
        // With what viscosity adds to it.
        let strain = pairs(n, |i, j| {
            let product = q[i].dot(q[j]);
            let rate = q[i].dot(v[j]) + v[i].dot(q[j]);
            product - product.constant(membrane.reference[pair(i, j)]) + rate.scale(tau)
        });
        for j in 0..n {
            for i in 0..=j {
                let s = row(membrane, pair(i, j), &strain).scale(h);
                force[i] = force[i].add_times(s, q[j]);
                force[j] = force[j].add_times(s, q[i]);
            }
        }
    }
    if let Some(bending) = &table.bending {
        for i in 0..n {
            for j in 0..n {
                let factor = h * h * h / 12.0 * bending[i * width + j];
                force[i] = force[i].add_scaled(factor, q[j]);
            }
        }
    }
}
