//! The vectorised evaluation of chunks of elements.

use pliant_math::{Lanes, Vec3};
use pulp::{Arch, Simd, WithSimd};

use super::{CHUNK, CableBlock, Core, GROUP_VALUES, Gram, LANES};
use crate::element::{Motion, Weights};
use crate::elements::cable::{Column, LawSource, Nodal, NodeOffsets, force, inertia};

/// Room for a chunk's nodes and the lanes beyond.
const WIDTH: usize = CHUNK + LANES;

/// Six rows over the nodes of a chunk: x, y, z of r, then of t.
type Rows = [[f64; WIDTH]; 6];

/// Numbers of the elements `offset..` of a group.
#[derive(Clone, Copy)]
struct LaneColumn<'a, S> {
    simd: S,
    core: &'a Core,
    gram: Option<&'a Gram>,
    offset: usize,
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
}

#[inline(always)]
fn gather(slots: &[NodeOffsets], from: &[f64], to: &mut Rows) {
    for (i, node) in slots.iter().enumerate().take(CHUNK + 1) {
        let r = &from[node.r as usize..node.r as usize + 3];
        let t = &from[node.t as usize..node.t as usize + 3];
        for c in 0..3 {
            to[c][i] = r[c];
            to[3 + c][i] = t[c];
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
        LaneColumn { simd, core: &self.core[group], gram: self.gram.get(group), offset: e % LANES }
    }

    /// Slots of the nodes of the chunk from element `first`, and its number of elements.
    #[inline(always)]
    fn chunk_slots(&self, first: usize) -> (&[NodeOffsets], usize) {
        let count = CHUNK.min(self.is_bridge.len() - first);
        (&self.slots[first..=first + count], count)
    }
}

/// `M (a - g) + f(q, v)` of consecutive chunks from number `first`, summed at their nodes into one item of `out` each.
pub(super) fn residual<'s, L: LawSource>(
    block: &CableBlock,
    law: L,
    motion: Motion<'_>,
    gravity: [f64; 3],
    first: usize,
    out: impl Iterator<Item = &'s mut [f64]>,
) {
    Arch::new().dispatch(Residual { block, law, motion, gravity, first, out });
}

struct Residual<'a, L, O> {
    block: &'a CableBlock,
    law: L,
    motion: Motion<'a>,
    gravity: [f64; 3],
    first: usize,
    out: O,
}

impl<'s, L: LawSource, O: Iterator<Item = &'s mut [f64]>> WithSimd for Residual<'_, L, O> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let law = self.law.law();
        let mut x: Rows = [[0.0; WIDTH]; 6];
        let mut a = x;
        let mut v = x;
        let mut f = [[0.0; WIDTH]; 12];
        let gravity = Vec3::new(
            Lanes::splat(simd, self.gravity[0]),
            Lanes::splat(simd, self.gravity[1]),
            Lanes::splat(simd, self.gravity[2]),
        );
        for (chunk, out) in self.out.enumerate() {
            let first = (self.first + chunk) * CHUNK;
            let (slots, count) = self.block.chunk_slots(first);
            gather(slots, self.motion.q, &mut x);
            gather(slots, self.motion.a, &mut a);
            if law.damped {
                gather(slots, self.motion.v, &mut v);
            }
            let mut e = 0;
            while e < count {
                let column = self.block.lane_column(simd, first + e);
                let nodes = nodal(simd, &x, e);
                let rates = if law.damped { Some(nodal(simd, &v, e)) } else { None };
                let internal = force(law, column, &nodes, rates.as_ref());
                let mut acceleration = nodal(simd, &a, e);
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
            let out = &mut out[..6 * count + 6];
            for c in 0..6 {
                out[c] = f[c][0];
                out[6 * count + c] = f[6 + c][count - 1];
            }
            for (i, sum) in out[6..6 * count].chunks_exact_mut(6).enumerate() {
                for c in 0..6 {
                    sum[c] = f[c][i + 1] + f[6 + c][i];
                }
            }
        }
    }
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
            let (slots, _) = self.block.chunk_slots(first);
            gather(slots, self.motion.q, &mut x);
            if law.damped {
                gather(slots, self.motion.v, &mut v);
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
                    tangent_kernel(law, column, &nodes, rates.as_ref(), self.weights, store);
                    lane += S::F64_LANES;
                }
            }
        }
    }
}

use crate::elements::cable::tangent as tangent_kernel;
