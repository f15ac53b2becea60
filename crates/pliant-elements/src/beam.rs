//! A block of beams of one law: lanes of consecutive elements, whose precomputed numbers equal elements share.
//!
//! The kernel is [`crate::elements::beam`], what it runs on [`crate::integrals::beam`].

mod build;
mod output;
mod scalar;

use std::ops::Range;

use pliant_math::{Lanes, Vec3};
use pulp::{Arch, Simd, WithSimd};
use rayon::prelude::*;

use crate::element::{Block, Momentum, Motion, Slot, Weights, Workspace};
use crate::elements::beam::{Column, ENTRIES, Nodal, force, inertia, place, tangent};
use crate::integrals::beam::Table;
pub use build::{BeamElement, BeamLaw, Locking};
pub use output::BeamStrain;

/// Lanes per group of elements.
const LANES: usize = 8;
/// Groups per task of the parallel evaluation.
const TASK: usize = 8;
/// Stored entries of a group of element matrices.
const GROUP_VALUES: usize = ENTRIES * LANES;
/// Coordinates of an element.
const SIZE: usize = 24;

/// Coordinates of a group of elements, one row a coordinate.
type Rows = [[f64; LANES]; SIZE];

/// Precomputed numbers of a group of elements.
#[derive(Clone, Debug)]
enum Group {
    /// Number of the table that all of them share.
    Shared(u32),
    /// Their own, lane by lane.
    Own(Box<[[f64; LANES]; place::COUNT]>),
}

/// Beams of one law.
#[derive(Clone, Debug)]
pub struct BeamBlock {
    law: BeamLaw,
    tables: Vec<Table>,
    /// Table of each element.
    table_of: Vec<u32>,
    groups: Vec<Group>,
    /// First coordinates of the two nodes of each element: r, then the three gradients.
    nodes: Vec<[u32; 2]>,
    /// For each element the area of its section in the middle [m^2].
    areas: Vec<f64>,
    extent: usize,
}

impl BeamBlock {
    /// The law of the block.
    #[must_use]
    pub fn law(&self) -> &BeamLaw {
        &self.law
    }

    /// First coordinates of the two nodes of element `e`.
    #[must_use]
    pub fn nodes_of(&self, e: usize) -> [u32; 2] {
        self.nodes[e]
    }

    fn is_damped(&self) -> bool {
        self.law.retardation_time != 0.0
    }

    /// Coordinates of a group; lanes beyond the last element repeat it.
    #[inline(always)]
    fn gather(&self, group: usize, from: &[f64]) -> Rows {
        let mut rows = [[0.0; LANES]; SIZE];
        for lane in 0..LANES {
            let e = (group * LANES + lane).min(self.nodes.len() - 1);
            for (half, &node) in self.nodes[e].iter().enumerate() {
                let x = &from[node as usize..node as usize + 12];
                for c in 0..12 {
                    rows[12 * half + c][lane] = x[c];
                }
            }
        }
        rows
    }
}

/// Numbers of the lanes `lane..` of a group.
#[derive(Clone, Copy)]
struct OwnColumn<'a, S> {
    simd: S,
    numbers: &'a [[f64; LANES]; place::COUNT],
    lane: usize,
}

impl<S: Simd> Column<Lanes<S>> for OwnColumn<'_, S> {
    #[inline(always)]
    fn get(self, place: usize) -> Lanes<S> {
        Lanes::load(self.simd, &self.numbers[place][self.lane..])
    }
}

/// The same numbers in all lanes.
#[derive(Clone, Copy)]
struct SharedColumn<'a, S> {
    simd: S,
    numbers: &'a [f64],
}

impl<S: Simd> Column<Lanes<S>> for SharedColumn<'_, S> {
    #[inline(always)]
    fn get(self, place: usize) -> Lanes<S> {
        Lanes::splat(self.simd, self.numbers[place])
    }
}

#[inline(always)]
fn nodal<S: Simd>(simd: S, rows: &Rows, lane: usize) -> Nodal<Lanes<S>> {
    let at = |c: usize| Lanes::load(simd, &rows[c][lane..lane + S::F64_LANES]);
    std::array::from_fn(|k| Vec3::new(at(3 * k), at(3 * k + 1), at(3 * k + 2)))
}

struct Residual<'a> {
    block: &'a BeamBlock,
    motion: Motion<'a>,
    gravity: [f64; 3],
    group: usize,
}

impl WithSimd for Residual<'_> {
    type Output = Rows;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Rows {
        let Self { block, motion, gravity, group } = self;
        let (q, mut a) = (block.gather(group, motion.q), block.gather(group, motion.a));
        for half in [0, 12] {
            for c in 0..3 {
                for x in &mut a[half + c] {
                    *x -= gravity[c];
                }
            }
        }
        let v = if block.is_damped() { Some(block.gather(group, motion.v)) } else { None };
        let mut out = [[0.0; LANES]; SIZE];
        let mut lane = 0;
        while lane < LANES {
            let x = nodal(simd, &q, lane);
            let rates = v.as_ref().map(|v| nodal(simd, v, lane));
            let a = nodal(simd, &a, lane);
            let (internal, inertial) = match &block.groups[group] {
                Group::Shared(table) => {
                    let column = SharedColumn { simd, numbers: &block.tables[*table as usize] };
                    (force(column, &x, rates.as_ref()), inertia(column, &a))
                }
                Group::Own(numbers) => {
                    let column = OwnColumn { simd, numbers, lane };
                    (force(column, &x, rates.as_ref()), inertia(column, &a))
                }
            };
            for k in 0..8 {
                let sum = (internal[k] + inertial[k]).array();
                for c in 0..3 {
                    sum[c].store(&mut out[3 * k + c][lane..lane + S::F64_LANES]);
                }
            }
            lane += S::F64_LANES;
        }
        out
    }
}

struct Tangent<'a> {
    block: &'a BeamBlock,
    motion: Motion<'a>,
    weights: Weights,
    group: usize,
    values: &'a mut [f64],
}

impl WithSimd for Tangent<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { block, motion, weights, group, values } = self;
        let q = block.gather(group, motion.q);
        let v = if block.is_damped() { Some(block.gather(group, motion.v)) } else { None };
        let mut lane = 0;
        while lane < LANES {
            let x = nodal(simd, &q, lane);
            let rates = v.as_ref().map(|v| nodal(simd, v, lane));
            let store = |k: usize, value: Lanes<S>| {
                let at = k * LANES + lane;
                value.store(&mut values[at..at + S::F64_LANES]);
            };
            match &block.groups[group] {
                Group::Shared(table) => {
                    let column = SharedColumn { simd, numbers: &block.tables[*table as usize] };
                    tangent(column, &x, rates.as_ref(), weights, store);
                }
                Group::Own(numbers) => {
                    let column = OwnColumn { simd, numbers, lane };
                    tangent(column, &x, rates.as_ref(), weights, store);
                }
            }
            lane += S::F64_LANES;
        }
    }
}

impl BeamBlock {
    fn group_residual(&self, motion: Motion<'_>, gravity: [f64; 3], group: usize) -> Rows {
        Arch::new().dispatch(Residual { block: self, motion, gravity, group })
    }

    /// Elements of a group.
    fn elements_of(&self, group: usize) -> Range<usize> {
        group * LANES..((group + 1) * LANES).min(self.nodes.len())
    }

    fn scatter(&self, group: usize, rows: &Rows, force: &mut [f64]) {
        for (lane, e) in self.elements_of(group).enumerate() {
            for (half, &node) in self.nodes[e].iter().enumerate() {
                for (c, f) in force[node as usize..node as usize + 12].iter_mut().enumerate() {
                    *f += rows[12 * half + c][lane];
                }
            }
        }
    }
}

impl Block for BeamBlock {
    fn kind(&self) -> &'static str {
        "beam"
    }

    fn element_count(&self) -> usize {
        self.nodes.len()
    }

    fn extent(&self) -> usize {
        self.extent
    }

    fn has_damping(&self) -> bool {
        self.is_damped()
    }

    fn residual(
        &self,
        motion: Motion<'_>,
        gravity: [f64; 3],
        _workspace: &mut Workspace,
        force: &mut [f64],
        parallel: bool,
    ) {
        if parallel && self.groups.len() > TASK {
            let rows: Vec<Rows> = (0..self.groups.len())
                .into_par_iter()
                .with_min_len(TASK)
                .map(|group| self.group_residual(motion, gravity, group))
                .collect();
            for (group, rows) in rows.iter().enumerate() {
                self.scatter(group, rows, force);
            }
        } else {
            for group in 0..self.groups.len() {
                let rows = self.group_residual(motion, gravity, group);
                self.scatter(group, &rows, force);
            }
        }
    }

    fn values_len(&self) -> usize {
        self.groups.len() * GROUP_VALUES
    }

    fn tangent(&self, motion: Motion<'_>, weights: Weights, values: &mut [f64], parallel: bool) {
        let arch = Arch::new();
        let each = |(group, values): (usize, &mut [f64])| {
            arch.dispatch(Tangent { block: self, motion, weights, group, values });
        };
        let values = &mut values[..self.groups.len() * GROUP_VALUES];
        if parallel && self.groups.len() > TASK {
            values.par_chunks_mut(GROUP_VALUES).enumerate().with_min_len(TASK).for_each(each);
        } else {
            values.chunks_mut(GROUP_VALUES).enumerate().for_each(each);
        }
    }

    fn slot_of(&self, e: usize) -> Slot {
        Slot { base: e / LANES * GROUP_VALUES + e % LANES, stride: LANES }
    }

    fn elastic_energy(&self, q: &[f64]) -> f64 {
        (0..self.nodes.len()).map(|e| self.element_elastic_energy(e, q)).sum()
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
        (0..self.nodes.len()).map(|e| self.element_mass(e)).sum()
    }

    fn first_moment(&self, q: &[f64]) -> [f64; 3] {
        let each = (0..self.nodes.len()).map(|e| self.element_first_moment(e, q));
        each.fold([0.0; 3], |sum, m| std::array::from_fn(|c| sum[c] + m[c]))
    }
}
