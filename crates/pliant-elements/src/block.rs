//! A block of cables of one law: structure of arrays, lanes of consecutive elements.
//!
//! The nodes of all cables are concatenated to one row of slots; element e joins slots e and e + 1. Between two cables
//! lies a bridge, an element of no stiffness and no mass, so that the lanes of eight consecutive elements run across the
//! ends of cables. Precomputed numbers are kept in groups of eight lanes, and equal groups are kept once.

mod build;
mod lanes;
mod lengths;
mod output;
mod plastic;
mod scalar;

use std::ops::Range;

use rayon::prelude::*;

use crate::element::{Block, Momentum, Motion, Slot, Weights, Workspace};
use crate::elements::cable::{
    CableLaw, FixedLaw, LawSource, NodeOffsets, PlasticLaw, WoundLaw, place,
};

pub(crate) use lanes::ResidualRows;
use lanes::Sums;
use lengths::Lengths;
pub use plastic::PAST;
use plastic::PastRows;
pub use scalar::Parameter;

/// Lanes per group of elements.
pub(crate) const LANES: usize = 8;
/// Elements per chunk, evaluated from one gathered copy of their nodes.
pub(crate) const CHUNK: usize = 64;
/// Chunks per task of the parallel evaluation.
const CHUNKS_PER_TASK: usize = 16;
/// Stored entries of an element matrix.
const ENTRIES: usize = 78;
/// Stored entries of a group of element matrices.
pub(crate) const GROUP_VALUES: usize = ENTRIES * LANES;
/// Node sums of one chunk: its first nodes, then the force carried to the next chunk's first node.
const CHUNK_SUMS: usize = 6 * (CHUNK + 1);

pub(crate) type Core = [[f64; LANES]; place::COUNT];
pub(crate) type Gram = [[f64; LANES]; place::GRAM_COUNT];

/// Cables of one law.
#[derive(Clone, Debug)]
pub struct CableBlock {
    law: CableLaw,
    slots: Vec<NodeOffsets>,
    /// Slots of each cable.
    cables: Vec<Range<usize>>,
    is_bridge: Vec<bool>,
    /// Of each chunk: whether its nodes' coordinates lie one after the other, r then t.
    contiguous: Vec<bool>,
    /// Which set of numbers each group of eight elements has.
    groups: Vec<u32>,
    core: Vec<Core>,
    /// Gram forms, parallel to `core`; empty where the law has no use for them.
    gram: Vec<Gram>,
    /// Factors of the lengths; empty without winches.
    lengths: Lengths,
    /// What the axial points remember; empty where nothing yields.
    past: PastRows,
    extent: usize,
}

impl CableBlock {
    /// The law of the block.
    #[must_use]
    pub fn law(&self) -> CableLaw {
        self.law
    }

    /// Number of cables.
    #[must_use]
    pub fn cable_count(&self) -> usize {
        self.cables.len()
    }

    /// Elements of cable `cable`, as numbers in the block.
    #[must_use]
    pub fn elements_of(&self, cable: usize) -> Range<usize> {
        let slots = &self.cables[cable];
        slots.start..slots.end - 1
    }

    /// Nodes of all cables, one after the other; element e joins slots e and e + 1.
    #[must_use]
    pub fn slots(&self) -> &[NodeOffsets] {
        &self.slots
    }

    /// The two nodes of element `e`.
    #[must_use]
    pub fn nodes_of(&self, e: usize) -> [NodeOffsets; 2] {
        [self.slots[e], self.slots[e + 1]]
    }

    /// Whether element `e` is a bridge between two cables, which contributes nothing.
    #[must_use]
    pub fn is_bridge(&self, e: usize) -> bool {
        self.is_bridge[e]
    }

    /// The elements that are no bridges, with their nodes.
    pub fn real_elements(&self) -> impl Iterator<Item = (usize, [NodeOffsets; 2])> + '_ {
        (0..self.is_bridge.len()).filter(|&e| !self.is_bridge[e]).map(|e| (e, self.nodes_of(e)))
    }

    fn tasks(&self) -> usize {
        self.is_bridge.len().div_ceil(CHUNK * CHUNKS_PER_TASK)
    }

    fn chunks(&self) -> usize {
        self.is_bridge.len().div_ceil(CHUNK)
    }

    /// Adds the sums of nodes `first..` to the global vector; returns the force carried on.
    fn scatter(&self, first: usize, sums: &[f64], carry: [f64; 6], force: &mut [f64]) -> [f64; 6] {
        let count = CHUNK.min(self.is_bridge.len() - first);
        let mut carry = carry;
        for (node, sum) in self.slots[first..first + count].iter().zip(sums.chunks_exact(6)) {
            let r = &mut force[node.r as usize..node.r as usize + 3];
            for c in 0..3 {
                r[c] += sum[c] + carry[c];
            }
            let t = &mut force[node.t as usize..node.t as usize + 3];
            for c in 0..3 {
                t[c] += sum[3 + c] + carry[3 + c];
            }
            carry = [0.0; 6];
        }
        std::array::from_fn(|c| sums[6 * count + c])
    }

    fn residual_with<L: LawSource>(
        &self,
        law: L,
        motion: Motion<'_>,
        gravity: [f64; 3],
        workspace: &mut Workspace,
        force: &mut [f64],
        parallel: bool,
    ) {
        if parallel && self.tasks() > 1 {
            workspace.sums.resize(self.chunks() * CHUNK_SUMS, 0.0);
            workspace.sums.par_chunks_mut(CHUNKS_PER_TASK * CHUNK_SUMS).enumerate().for_each(
                |(task, sums)| {
                    let first = task * CHUNKS_PER_TASK;
                    let chunks = first..first + sums.len() / CHUNK_SUMS;
                    let rows = &mut ResidualRows::default();
                    lanes::residual(self, law, motion, gravity, chunks, rows, Sums::Buffer(sums));
                },
            );
            let mut carry = [0.0; 6];
            for (chunk, sums) in workspace.sums.chunks_exact(CHUNK_SUMS).enumerate() {
                carry = self.scatter(chunk * CHUNK, sums, carry, force);
            }
            self.add_to_last(carry, force);
        } else {
            let chunks = 0..self.chunks();
            let rows = workspace.rows.get_or_insert_default();
            lanes::residual(self, law, motion, gravity, chunks, rows, Sums::Global(force));
        }
    }

    /// Adds the force that the last element leaves at the last node.
    fn add_to_last(&self, carry: [f64; 6], force: &mut [f64]) {
        if let Some(last) = self.slots.last() {
            for c in 0..3 {
                force[last.r as usize + c] += carry[c];
                force[last.t as usize + c] += carry[3 + c];
            }
        }
    }

    fn tangent_with<L: LawSource>(
        &self,
        law: L,
        motion: Motion<'_>,
        weights: Weights,
        values: &mut [f64],
        parallel: bool,
    ) {
        const TASK: usize = CHUNKS_PER_TASK * CHUNK / LANES * GROUP_VALUES;
        let values = &mut values[..self.groups.len() * GROUP_VALUES];
        if parallel && self.tasks() > 1 {
            values.par_chunks_mut(TASK).enumerate().for_each(|(task, values)| {
                lanes::tangent(self, law, motion, weights, task * CHUNKS_PER_TASK, values);
            });
        } else {
            lanes::tangent(self, law, motion, weights, 0, values);
        }
    }
}

/// Calls `$self.$method(law, ...)` with a law that the compiler knows where it is a common one.
macro_rules! with_law {
    ($self:ident . $method:ident ( $($argument:expr),* )) => {
        match $self.law.code() {
            0 => $self.$method(FixedLaw::<0>, $($argument),*),
            1 => $self.$method(FixedLaw::<1>, $($argument),*),
            4 => $self.$method(FixedLaw::<4>, $($argument),*),
            32 => $self.$method(FixedLaw::<32>, $($argument),*),
            _ if $self.law.plastic => $self.$method(PlasticLaw($self.law), $($argument),*),
            _ if $self.law.wound => $self.$method(WoundLaw($self.law), $($argument),*),
            _ => $self.$method($self.law, $($argument),*),
        }
    };
}

impl Block for CableBlock {
    fn kind(&self) -> &'static str {
        "cable"
    }

    /// Bridges included.
    fn element_count(&self) -> usize {
        self.is_bridge.len()
    }

    fn extent(&self) -> usize {
        self.extent
    }

    fn has_damping(&self) -> bool {
        self.law.damped
    }

    fn residual(
        &self,
        motion: Motion<'_>,
        gravity: [f64; 3],
        workspace: &mut Workspace,
        force: &mut [f64],
        parallel: bool,
    ) {
        with_law!(self.residual_with(motion, gravity, workspace, force, parallel));
    }

    fn values_len(&self) -> usize {
        self.groups.len() * GROUP_VALUES
    }

    fn tangent(&self, motion: Motion<'_>, weights: Weights, values: &mut [f64], parallel: bool) {
        with_law!(self.tangent_with(motion, weights, values, parallel));
    }

    fn slot_of(&self, e: usize) -> Slot {
        Slot { base: e / LANES * GROUP_VALUES + e % LANES, stride: LANES }
    }

    fn elastic_energy(&self, q: &[f64]) -> f64 {
        self.real_elements().map(|(e, _)| self.element_elastic_energy(e, q)).sum()
    }

    fn kinetic_energy(&self, v: &[f64]) -> f64 {
        self.total_kinetic_energy(v)
    }

    fn dissipation(&self, q: &[f64], v: &[f64]) -> f64 {
        self.total_dissipation(q, v)
    }

    fn momentum(&self, q: &[f64], v: &[f64]) -> Momentum {
        self.total_momentum(q, v)
    }

    fn mass(&self) -> f64 {
        self.total_mass()
    }

    fn first_moment(&self, q: &[f64]) -> [f64; 3] {
        self.total_first_moment(q)
    }
}
