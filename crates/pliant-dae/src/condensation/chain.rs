//! One chain, eliminated from both ends to its middle node.
//!
//! With D the block of a node, C its coupling to the next one inwards, E the coupling back (C^T if symmetric) and B
//! its coupling to the interface at its end: `W = D^-1 C`, `V = D^-1 B`; the next block is lessened by `E W`, the
//! next coupling to the interface is `-E V`, and the interface's own matrix is lessened by `B^T V`.
//! Two ends make two independent recurrences: they hide each other's latency, or run in two threads.

use super::arm::{Arm, Carry, Own, Sweep, Way, own};
use super::block::{Block, Lanes, N, PLAIN, Row, Wide, ZERO, combine, transpose};
use super::graph::Path;
use crate::structure::Structure;
use pulp::{Arch, Simd, WithSimd};

/// Chains of at least this number of nodes are worth two threads.
const WORTH_TWO_THREADS: usize = 4000;

/// One chain with its factors.
pub(super) struct Chain {
    arms: [Arm; 2],
    /// First unknown of the middle node, and the element matrices over it alone.
    middle: usize,
    middle_own: Vec<Own>,
    sides: [MiddleFactors; 2],
    z: Row,
    symmetric: bool,
    /// Interface unknowns at both ends.
    pub(super) interface: Vec<u32>,
    /// What is left for the interface after a factorisation, square.
    pub(super) condensed: Vec<f64>,
    /// What the interface's right-hand side is lessened by.
    pub(super) share: Vec<f64>,
    known: Vec<f64>,
    /// Unknown without a pivot, if the last factorisation failed.
    pub(super) failed: Option<usize>,
    /// Whether a block needed pivoting.
    pub(super) suspect: bool,
}

/// Factors at the middle, for the matrix or its transpose.
#[derive(Default)]
struct MiddleFactors {
    inverse: Block,
    forward: Vec<Row>,
    back: Vec<Row>,
}

impl Chain {
    pub(super) fn new(structure: &Structure, path: &Path, symmetric: bool) -> Self {
        let n = path.nodes.len();
        let middle = n / 2;
        let unknowns = |g: u32| structure.groups()[g as usize].clone();
        let mut interface = Vec::new();
        for end in &path.ends {
            let all = end.interface.iter().flat_map(|&g| unknowns(g));
            interface.extend(all.map(|u| u as u32));
        }
        let arms = [
            Arm::new(structure, path, (0..middle).collect(), 0, symmetric),
            Arm::new(structure, path, (middle + 1..n).rev().collect(), 1, symmetric),
        ];
        let m = interface.len();
        let side = |used: bool| {
            let rows = vec![Row::default(); if used { m } else { 0 }];
            MiddleFactors { inverse: ZERO, forward: rows.clone(), back: rows }
        };
        Self {
            arms,
            middle: unknowns(path.nodes[middle]).start,
            middle_own: own(structure, &path.own[middle], 0),
            sides: [side(true), side(!symmetric)],
            z: Row::default(),
            symmetric,
            interface,
            condensed: vec![0.0; m * m],
            share: vec![0.0; m],
            known: vec![0.0; m],
            failed: None,
            suspect: false,
        }
    }

    /// Number of nodes.
    pub(super) fn len(&self) -> usize {
        self.arms[0].len() + self.arms[1].len() + 1
    }

    pub(super) fn is_symmetric(&self) -> bool {
        self.symmetric
    }

    fn in_two_threads(&self, parallel: bool) -> bool {
        parallel && self.len() >= WORTH_TWO_THREADS
    }

    /// Factorises; the outcome is in `failed`, `suspect` and `condensed`.
    pub(super) fn factor(&mut self, values: &[f64], parallel: bool) {
        self.suspect = false;
        self.failed = None;
        for arm in &mut self.arms {
            if let Err(unknown) = arm.cap.factor(values) {
                self.failed = Some(unknown);
                return;
            }
        }
        let two = self.in_two_threads(parallel);
        let symmetric = self.symmetric;
        let [left, right] = &mut self.arms;
        let arch = Arch::new();
        let carries = if two {
            let (a, b) = rayon::join(
                || arch.dispatch(Eliminate { arm: left, other: None, values, symmetric })[0],
                || arch.dispatch(Eliminate { arm: right, other: None, values, symmetric })[0],
            );
            [a, b]
        } else {
            arch.dispatch(Eliminate { arm: left, other: Some(right), values, symmetric })
        };
        self.finish(carries, values);
    }

    /// Eliminates the middle node and collects what is left for the interface.
    fn finish(&mut self, carries: [Carry; 2], values: &[f64]) {
        for (carry, arm) in carries.iter().zip(&self.arms) {
            self.suspect |= carry.suspect;
            if let Some(k) = carry.failed {
                self.failed = Some(arm.unknown(k));
                return;
            }
        }
        let mut d = ZERO;
        for i in 0..N {
            for j in 0..N {
                d[i].0[j] = carries[0].diagonal[i].0[j] + carries[1].diagonal[i].0[j];
            }
        }
        for own in &self.middle_own {
            own.add(&mut d, values);
        }
        // The middle node closes both recurrences: one pivoted inverse is cheap insurance.
        match super::block::invert_pivoted(&d) {
            Ok(inverse) => self.sides[0].inverse = inverse,
            Err(i) => {
                self.failed = Some(self.middle + i);
                return;
            }
        }
        self.sides[1].inverse = transpose(&self.sides[0].inverse);
        let m = self.interface.len();
        self.condensed.fill(0.0);
        let mut at = 0;
        for arm in &self.arms {
            let width = arm.width();
            for a in 0..width {
                let (row, column) = (arm.reach_row(a), arm.reach(a));
                self.sides[0].back[at + a] = combine(PLAIN, &self.sides[1].inverse, column);
                self.sides[0].forward[at + a] = combine(PLAIN, &self.sides[0].inverse, row);
                for b in 0..width {
                    self.condensed[(at + a) * m + at + b] = arm.schur[a * width + b];
                }
            }
            at += width;
        }
        let mut a = 0;
        for arm in &self.arms {
            for local in 0..arm.width() {
                for b in 0..m {
                    let mut lane = Row::default();
                    lane.add_products(PLAIN, arm.reach_row(local), &self.sides[0].back[b]);
                    self.condensed[a * m + b] -= lane.sum();
                }
                a += 1;
            }
        }
        if !self.symmetric {
            let [plain, transposed] = &mut self.sides;
            transposed.forward.copy_from_slice(&plain.back);
            transposed.back.copy_from_slice(&plain.forward);
        }
    }

    fn side(&self, transposed: bool) -> usize {
        usize::from(transposed && !self.symmetric)
    }

    /// Carries the right-hand side inwards; the interface's share is in `share`.
    pub(super) fn forward(&mut self, b: &[f64], transposed: bool, parallel: bool) {
        let two = self.in_two_threads(parallel);
        let side = self.side(transposed);
        let Self { arms: [left, right], .. } = self;
        left.start(b, transposed);
        right.start(b, transposed);
        let arch = Arch::new();
        let way = Way::Inwards(b);
        let carries = if two {
            let (a, b) = rayon::join(
                || arch.dispatch(Sweep { arm: left, other: None, way, side })[0],
                || arch.dispatch(Sweep { arm: right, other: None, way, side })[0],
            );
            [a, b]
        } else {
            arch.dispatch(Sweep { arm: left, other: Some(right), way, side })
        };
        let middle = &self.sides[side];
        let y = Row::load(&b[self.middle..]).minus(PLAIN, &carries[0]).minus(PLAIN, &carries[1]);
        self.z = combine(PLAIN, &self.sides[1 - side].inverse, &y);
        let mut c = 0;
        for arm in &self.arms {
            for a in 0..arm.width() {
                let mut lanes = arm.shares[a];
                lanes.add_products(PLAIN, &middle.forward[c], &y);
                self.share[c] = arm.cap.forward(b, N + a, transposed) + lanes.sum();
                c += 1;
            }
        }
    }

    /// Carries the solution outwards, given that of the interface in `interface`.
    pub(super) fn backward(&mut self, transposed: bool, parallel: bool) {
        let two = self.in_two_threads(parallel);
        let side = self.side(transposed);
        let middle = &self.sides[side];
        for (c, x) in self.known.iter().enumerate() {
            self.z.add(PLAIN, -x, &middle.back[c]);
        }
        let z = self.z;
        let (known_left, known_right) = self.known.split_at(self.arms[0].width());
        let Self { arms: [left, right], .. } = self;
        let arch = Arch::new();
        let way = Way::Outwards([known_left, known_right], z);
        if two {
            let other_way = Way::Outwards([known_right; 2], z);
            rayon::join(
                || arch.dispatch(Sweep { arm: left, other: None, way, side }),
                || arch.dispatch(Sweep { arm: right, other: None, way: other_way, side }),
            );
        } else {
            arch.dispatch(Sweep { arm: left, other: Some(right), way, side });
        }
        left.stop(&z, known_left, transposed);
        right.stop(&z, known_right, transposed);
    }

    /// Solution of number `c` of `interface`, to be set before [`Self::backward`].
    pub(super) fn set_known(&mut self, solution: impl Fn(usize) -> f64) {
        for (known, &u) in self.known.iter_mut().zip(&self.interface) {
            *known = solution(u as usize);
        }
    }

    /// Writes the solution of all nodes and caps.
    pub(super) fn scatter(&self, x: &mut [f64]) {
        for arm in &self.arms {
            arm.scatter(x);
        }
        x[self.middle..self.middle + N].copy_from_slice(&self.z.0[..N]);
    }
}

/// The elimination of one arm, or of two of which the other is not the longer.
struct Eliminate<'a> {
    arm: &'a mut Arm,
    other: Option<&'a mut Arm>,
    values: &'a [f64],
    symmetric: bool,
}

impl WithSimd for Eliminate<'_> {
    type Output = [Carry; 2];

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> [Carry; 2] {
        match S::F64_LANES {
            8 => self.start(Wide::<S, 1>(simd)),
            4 => self.start(Wide::<S, 2>(simd)),
            2 => self.start(Wide::<S, 4>(simd)),
            _ => self.start(PLAIN),
        }
    }
}

impl Eliminate<'_> {
    #[inline(always)]
    fn start<L: Lanes>(self, l: L) -> [Carry; 2] {
        if self.symmetric { self.run::<L, true>(l) } else { self.run::<L, false>(l) }
    }

    #[inline(always)]
    fn run<L: Lanes, const SYMMETRIC: bool>(self, l: L) -> [Carry; 2] {
        let Self { arm, mut other, values, .. } = self;
        let mut carry = arm.first();
        let mut other_carry = other.as_mut().map_or(carry, |other| other.first());
        for k in 0..arm.len() {
            arm.eliminate::<L, SYMMETRIC>(l, &mut carry, k, values);
            if let Some(other) = other.as_mut().filter(|other| k < other.len()) {
                other.eliminate::<L, SYMMETRIC>(l, &mut other_carry, k, values);
            }
        }
        [carry, other_carry]
    }
}
