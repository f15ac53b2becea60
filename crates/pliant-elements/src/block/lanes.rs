//! The vectorised evaluation of chunks of elements.

use pliant_math::{Lanes, Vec3};
use pulp::{Arch, Simd, WithSimd};

use std::ops::Range;

use super::{CHUNK, CHUNK_SUMS, CableBlock, Core, GROUP_VALUES, Gram, LANES, PastRows};
use crate::element::{Motion, Weights};
use crate::elements::cable::tangent as tangent_kernel;
use crate::elements::cable::{
    Column, LawSource, Nodal, NodeOffsets, Past, force, inertia, wound_force, wound_tangent,
};

/// Room for a chunk's nodes and the lanes beyond.
const WIDTH: usize = CHUNK + LANES;

/// Six rows over the nodes of a chunk: x, y, z of r, then of t.
type Rows = [[f64; WIDTH]; 6];
/// Twelve rows over the elements of a chunk: forces on the first node, then on the second.
type ForceRows = [[f64; WIDTH]; 12];

/// Scratch of a residual: it is kept between calls, for clearing it costs as much as fifteen elements.
#[derive(Clone, Debug)]
pub(crate) struct ResidualRows {
    x: Rows,
    a: Rows,
    v: Rows,
    f: ForceRows,
}

impl Default for ResidualRows {
    fn default() -> Self {
        let rows = [[0.0; WIDTH]; 6];
        Self { x: rows, a: rows, v: rows, f: [[0.0; WIDTH]; 12] }
    }
}

/// Nodes of a chunk.
#[derive(Clone, Copy)]
struct ChunkNodes<'a> {
    slots: &'a [NodeOffsets],
    /// Index of the first coordinate where all nodes lie one after the other, r then t.
    contiguous_from: Option<usize>,
}

/// Numbers of the elements `offset..` of a group.
#[derive(Clone, Copy)]
struct LaneColumn<'a, S> {
    simd: S,
    core: &'a Core,
    gram: Option<&'a Gram>,
    offset: usize,
    past: &'a PastRows,
    element: usize,
}

impl<S: Simd> Column<Lanes<S>> for LaneColumn<'_, S> {
    #[inline(always)]
    fn get(self, place: usize) -> Lanes<S> {
        Lanes::load(self.simd, &self.core[place][self.offset..])
    }
    #[inline(always)]
    fn gram(self, k: usize) -> Lanes<S> {
        match self.gram {
            Some(gram) => Lanes::load(self.simd, &gram[k][self.offset..]),
            None => Lanes::splat(self.simd, 0.0),
        }
    }
    #[inline(always)]
    fn past(self, k: usize) -> Past<Lanes<S>> {
        self.past.lanes(self.simd, k, self.element)
    }
}

/// Copies the nodes' six coordinates to rows.
#[inline(always)]
fn gather(nodes: ChunkNodes<'_>, from: &[f64], to: &mut Rows) {
    let [x, y, z, tx, ty, tz] = to;
    if let Some(first) = nodes.contiguous_from {
        let (from, _) = from[first..first + 6 * nodes.slots.len()].as_chunks::<6>();
        for (i, c) in from.iter().enumerate().take(WIDTH) {
            x[i] = c[0];
            y[i] = c[1];
            z[i] = c[2];
            tx[i] = c[3];
            ty[i] = c[4];
            tz[i] = c[5];
        }
    } else {
        for (i, node) in nodes.slots.iter().enumerate().take(WIDTH) {
            let r = &from[node.r as usize..node.r as usize + 3];
            let t = &from[node.t as usize..node.t as usize + 3];
            x[i] = r[0];
            y[i] = r[1];
            z[i] = r[2];
            tx[i] = t[0];
            ty[i] = t[1];
            tz[i] = t[2];
        }
    }
}

/// Adds rows to the nodes' six coordinates; the reverse of [`gather`].
#[inline(always)]
fn scatter(nodes: ChunkNodes<'_>, count: usize, rows: &ForceRows, force: &mut [f64]) {
    if let Some(first) = nodes.contiguous_from {
        let (to, _) = force[first..first + 6 * count].as_chunks_mut::<6>();
        for (i, to) in to.iter_mut().enumerate().take(WIDTH) {
            for c in 0..6 {
                to[c] += rows[c][i];
            }
        }
    } else {
        for (i, node) in nodes.slots[..count].iter().enumerate().take(WIDTH) {
            let r = &mut force[node.r as usize..node.r as usize + 3];
            for c in 0..3 {
                r[c] += rows[c][i];
            }
            let t = &mut force[node.t as usize..node.t as usize + 3];
            for c in 0..3 {
                t[c] += rows[3 + c][i];
            }
        }
    }
}

/// Nodal vectors of the elements `e..`: the second node's rows are the first node's, one further.
#[inline(always)]
fn nodal<S: Simd>(simd: S, rows: &Rows, e: usize) -> Nodal<Lanes<S>> {
    let at = |c: usize, i: usize| Lanes::load(simd, &rows[c][i..i + S::F64_LANES]);
    let vector = |c: usize, i: usize| Vec3::new(at(c, i), at(c + 1, i), at(c + 2, i));
    [vector(0, e), vector(3, e), vector(0, e + 1), vector(3, e + 1)]
}

impl CableBlock {
    #[inline(always)]
    fn lane_column<S: Simd>(&self, simd: S, e: usize) -> LaneColumn<'_, S> {
        let group = self.groups[e / LANES] as usize;
        LaneColumn {
            simd,
            core: &self.core[group],
            gram: self.gram.get(group),
            offset: e % LANES,
            past: &self.past,
            element: e,
        }
    }

    /// Nodes of the chunk from element `first`, and its number of elements.
    #[inline(always)]
    fn chunk_nodes(&self, first: usize) -> (ChunkNodes<'_>, usize) {
        let count = CHUNK.min(self.is_bridge.len() - first);
        let slots = &self.slots[first..=first + count];
        let nodes = ChunkNodes {
            slots,
            contiguous_from: self.contiguous[first / CHUNK].then_some(slots[0].r as usize),
        };
        (nodes, count)
    }
}

/// Where the node sums of chunks go.
pub(super) enum Sums<'a> {
    /// Straight to the global vector, chunk after chunk.
    Global(&'a mut [f64]),
    /// To a buffer: per chunk its first nodes' sums, node by node, then the force carried to the next chunk.
    Buffer(&'a mut [f64]),
}

/// `M (a - g) + f(q, v)` of the chunks `first..last`, summed at their nodes. Into the global vector all chunks must be
/// summed at once.
pub(super) fn residual<L: LawSource>(
    block: &CableBlock,
    law: L,
    motion: Motion<'_>,
    gravity: [f64; 3],
    chunks: Range<usize>,
    rows: &mut ResidualRows,
    sums: Sums<'_>,
) {
    Arch::new().dispatch(Residual { block, law, motion, gravity, chunks, rows, sums });
}

struct Residual<'a, L> {
    block: &'a CableBlock,
    law: L,
    motion: Motion<'a>,
    gravity: [f64; 3],
    chunks: Range<usize>,
    rows: &'a mut ResidualRows,
    sums: Sums<'a>,
}

impl<L: LawSource> WithSimd for Residual<'_, L> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(mut self, simd: S) {
        let law = self.law.law();
        let ResidualRows { x, a, v, f } = self.rows;
        let mut carry = [0.0; 6];
        let gravity = Vec3::new(
            Lanes::splat(simd, self.gravity[0]),
            Lanes::splat(simd, self.gravity[1]),
            Lanes::splat(simd, self.gravity[2]),
        );
        let first_chunk = self.chunks.start;
        for chunk in self.chunks.clone() {
            let first = chunk * CHUNK;
            let (nodes, count) = self.block.chunk_nodes(first);
            gather(nodes, self.motion.q, x);
            gather(nodes, self.motion.a, a);
            if law.damped {
                gather(nodes, self.motion.v, v);
            }
            let mut e = 0;
            while e < count {
                let column = self.block.lane_column(simd, first + e);
                let rates;
                let rates = if law.damped {
                    rates = nodal(simd, v, e);
                    Some(&rates)
                } else {
                    None
                };
                let nodes = nodal(simd, x, e);
                let internal = if L::WOUND {
                    let scale = self.block.lengths.lanes(simd, first + e);
                    wound_force(law, column, &nodes, rates, scale)
                } else {
                    force(law, column, &nodes, rates)
                };
                let mut acceleration = nodal(simd, a, e);
                acceleration[0] = acceleration[0] - gravity;
                acceleration[2] = acceleration[2] - gravity;
                let inertial = inertia(column, &acceleration);
                for node in 0..4 {
                    let sum = (internal[node] + inertial[node]).array();
                    for c in 0..3 {
                        sum[c].store(&mut f[3 * node + c][e..e + S::F64_LANES]);
                    }
                }
                e += S::F64_LANES;
            }
            let [first_rows, second_rows] = halves(f);
            for c in 0..6 {
                // Sum of a node: first node of its element, second node of the one before.
                for i in 0..CHUNK - 1 {
                    first_rows[c][i + 1] += second_rows[c][i];
                }
            }
            match &mut self.sums {
                Sums::Global(force) => {
                    for c in 0..6 {
                        f[c][0] += carry[c];
                        carry[c] = f[6 + c][count - 1];
                    }
                    scatter(nodes, count, f, force);
                    if chunk + 1 == self.block.chunks() {
                        self.block.add_to_last(carry, force);
                    }
                }
                Sums::Buffer(buffer) => {
                    let at = (chunk - first_chunk) * CHUNK_SUMS;
                    let (out, _) = buffer[at..at + CHUNK_SUMS].as_chunks_mut::<6>();
                    for (i, sum) in out[..count].iter_mut().enumerate() {
                        for c in 0..6 {
                            sum[c] = f[c][i];
                        }
                    }
                    for c in 0..6 {
                        out[count][c] = f[6 + c][count - 1];
                    }
                }
            }
        }
    }
}

#[inline(always)]
fn halves(rows: &mut ForceRows) -> [&mut [[f64; WIDTH]]; 2] {
    let (first, second) = rows.split_at_mut(6);
    [first, second]
}

/// Weighted element matrices of consecutive groups, from chunk number `first` until `values` is full.
pub(super) fn tangent<L: LawSource>(
    block: &CableBlock,
    law: L,
    motion: Motion<'_>,
    weights: Weights,
    first: usize,
    values: &mut [f64],
) {
    Arch::new().dispatch(Tangent { block, law, motion, weights, first, values });
}

struct Tangent<'a, L> {
    block: &'a CableBlock,
    law: L,
    motion: Motion<'a>,
    weights: Weights,
    first: usize,
    values: &'a mut [f64],
}

impl<L: LawSource> WithSimd for Tangent<'_, L> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let law = self.law.law();
        let mut x: Rows = [[0.0; WIDTH]; 6];
        let mut v = x;
        const CHUNK_VALUES: usize = CHUNK / LANES * GROUP_VALUES;
        for (chunk, values) in self.values.chunks_mut(CHUNK_VALUES).enumerate() {
            let first = (self.first + chunk) * CHUNK;
            let (nodes, _) = self.block.chunk_nodes(first);
            gather(nodes, self.motion.q, &mut x);
            if law.damped {
                gather(nodes, self.motion.v, &mut v);
            }
            for (group, values) in values.chunks_exact_mut(GROUP_VALUES).enumerate() {
                let mut lane = 0;
                while lane < LANES {
                    let e = group * LANES + lane;
                    let column = self.block.lane_column(simd, first + e);
                    let nodes = nodal(simd, &x, e);
                    let rates = if law.damped { Some(nodal(simd, &v, e)) } else { None };
                    let store = |k: usize, value: Lanes<S>| {
                        let at = k * LANES + lane;
                        value.store(&mut values[at..at + S::F64_LANES]);
                    };
                    let (rates, weights) = (rates.as_ref(), self.weights);
                    if L::WOUND {
                        let scale = self.block.lengths.lanes(simd, first + e);
                        wound_tangent(law, column, &nodes, rates, weights, scale, store);
                    } else {
                        tangent_kernel(law, column, &nodes, rates, weights, store);
                    }
                    lane += S::F64_LANES;
                }
            }
        }
    }
}
