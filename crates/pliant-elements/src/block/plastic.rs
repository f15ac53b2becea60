//! What the axial points of cables that yield remember: plastic strain and its path, and how they change.

use std::ops::Range;

use pliant_math::{Lanes, Real};
use pulp::Simd;

use super::scalar::vectors;
use super::{CableBlock, LANES};
use crate::elements::cable::{Integration, Past, Yielding, flow, wound_strains};

/// Numbers that a point remembers: plastic strain and path.
pub const PAST: usize = 2;
/// Axial points of the rule with most of them.
const POINTS: usize = 5;

/// Laws and memories of all points, as rows over the elements with room for the last lanes; empty where nothing yields.
#[derive(Clone, Debug, Default)]
pub(crate) struct PastRows {
    yield_strain: Vec<f64>,
    isotropic: Vec<f64>,
    kinematic: Vec<f64>,
    strain: [Vec<f64>; POINTS],
    path: [Vec<f64>; POINTS],
    lead: f64,
}

impl PastRows {
    /// Those of so many elements that have not yielded, and of the bridges beyond.
    pub fn new(elements: usize) -> Self {
        let row = |x: f64| vec![x; elements.next_multiple_of(LANES)];
        let Yielding { strain, isotropic, kinematic } = Yielding::NONE;
        Self {
            yield_strain: row(strain),
            isotropic: row(isotropic),
            kinematic: row(kinematic),
            strain: std::array::from_fn(|_| row(0.0)),
            path: std::array::from_fn(|_| row(0.0)),
            lead: 0.0,
        }
    }

    /// Gives elements their law.
    pub fn begin(&mut self, elements: Range<usize>, law: Yielding) {
        self.yield_strain[elements.clone()].fill(law.strain);
        self.isotropic[elements.clone()].fill(law.isotropic);
        self.kinematic[elements].fill(law.kinematic);
    }

    /// Point `k` of the elements `e..`.
    #[inline(always)]
    pub fn lanes<S: Simd>(&self, simd: S, k: usize, e: usize) -> Past<Lanes<S>> {
        let load = |x: &[f64]| Lanes::load(simd, &x[e..]);
        let yield_strain = load(&self.yield_strain);
        Past {
            yield_strain,
            isotropic: load(&self.isotropic),
            kinematic: load(&self.kinematic),
            strain: load(&self.strain[k]),
            path: load(&self.path[k]),
            lead: yield_strain.constant(self.lead),
        }
    }

    /// Point `k` of element `e`.
    pub fn at(&self, k: usize, e: usize) -> Past<f64> {
        Past {
            yield_strain: self.yield_strain[e],
            isotropic: self.isotropic[e],
            kinematic: self.kinematic[e],
            strain: self.strain[k][e],
            path: self.path[k][e],
            lead: self.lead,
        }
    }
}

impl CableBlock {
    /// Axial points of an element.
    #[must_use]
    pub fn axial_points(&self) -> usize {
        match self.law.integration {
            Integration::Lobatto => 3,
            Integration::Full => 5,
        }
    }

    /// How near to yielding, as a part of the bound, the tangent counts a point as flowing: a small number above zero
    /// where loads grow on, minus infinity for small motions about a state, which are elastic. 0 unless told.
    pub fn set_lead(&mut self, lead: f64) {
        self.past.lead = lead;
    }

    /// Sets what element `e` remembers, plastic strain and path of each of its points; the law is a plastic one.
    ///
    /// # Panics
    /// Where there are fewer than [`PAST`] numbers for each point.
    pub fn set_past(&mut self, e: usize, numbers: &[f64]) {
        for (k, point) in numbers.chunks_exact(PAST).enumerate().take(self.axial_points()) {
            (self.past.strain[k][e], self.past.path[k][e]) = (point[0], point[1]);
        }
    }

    /// Appends what element `e` will remember after a step to coordinates `q`. Nothing flows twice: there it stays.
    pub fn flowed(&self, e: usize, q: &[f64], out: &mut Vec<f64>) {
        let x = vectors(&self.local(e, q));
        let strains = wound_strains(self.law, self.column(e), &x, self.scale(e, 1.0));
        for (k, &eps) in strains.iter().enumerate().take(self.axial_points()) {
            let past = self.past.at(k, e);
            let step = flow(self.law, past, eps).step;
            out.extend([past.strain + step, past.path + step.abs()]);
        }
    }

    /// Work of element `e` on plastic flow in a step to coordinates `q` [J].
    #[must_use]
    pub fn plastic_work(&self, e: usize, q: &[f64]) -> f64 {
        self.local_plastic_work(e, &self.local(e, q))
    }
}
