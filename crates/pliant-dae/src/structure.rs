//! What the linear algebra knows of a problem: groups of unknowns, and small dense element matrices over them.
//!
//! The iteration matrix is never assembled by the problem. It is delivered as a sum of element matrices, each over
//! a few *groups* of unknowns, and every back end (dense, sparse, condensed) gathers what it needs from there.

use std::ops::Range;

/// How the matrix of one element is stored in the array of element values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Storage {
    /// Lower triangle, row by row: entry (i, j), j <= i, is number `i (i + 1) / 2 + j`.
    Symmetric,
    /// All entries, row by row: entry (i, j) is number `i n + j`.
    Full,
}

/// Place of one element matrix: entry number `k` is `values[base + k * stride]`.
///
/// A stride above one lets vectorised kernels write the matrices of several elements lane by lane.
#[derive(Clone, Copy, Debug)]
pub struct Slot {
    /// Index of entry 0.
    pub base: usize,
    /// Distance between consecutive entries.
    pub stride: usize,
    /// Which entries are stored.
    pub storage: Storage,
}

/// Sparsity of the iteration matrix: groups of unknowns and the elements that couple them.
///
/// Unknowns are numbered `0..velocities` for velocity-level coordinates, then the multipliers. A group is a
/// contiguous range of unknowns that always occur together (a node, a shared position, the multipliers of one joint).
/// Groups are disjoint and cover all unknowns.
#[derive(Clone, Debug, Default)]
pub struct Structure {
    unknowns: usize,
    velocities: usize,
    groups: Vec<Range<usize>>,
    element_starts: Vec<usize>,
    element_groups: Vec<u32>,
    slots: Vec<Slot>,
    values: usize,
    version: u64,
}

/// Where a structure ends, to go back there: see [`Structure::truncate`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Mark {
    elements: usize,
    values: usize,
}

impl Structure {
    /// An empty structure over `velocities` velocity-level unknowns followed by `multipliers` multipliers.
    #[must_use]
    pub fn new(velocities: usize, multipliers: usize) -> Self {
        Self {
            unknowns: velocities + multipliers,
            velocities,
            element_starts: vec![0],
            ..Self::default()
        }
    }

    /// Adds a group of unknowns; returns its number.
    pub fn add_group(&mut self, unknowns: Range<usize>) -> usize {
        debug_assert!(unknowns.end <= self.unknowns && !unknowns.is_empty());
        self.groups.push(unknowns);
        self.groups.len() - 1
    }

    /// Where the structure ends.
    #[must_use]
    pub fn mark(&self) -> Mark {
        Mark { elements: self.elements(), values: self.values }
    }

    /// Takes back all elements and values added since `mark`; what is added then makes a new version.
    pub fn truncate(&mut self, mark: Mark) {
        self.slots.truncate(mark.elements);
        self.element_starts.truncate(mark.elements + 1);
        self.element_groups.truncate(self.element_starts[mark.elements]);
        self.values = mark.values;
        self.version += 1;
    }

    /// Changes with [`Self::truncate`]: solvers analyse a structure again when it does.
    #[must_use]
    pub fn version(&self) -> u64 {
        self.version
    }

    /// Adds one element over `groups` (its local unknowns are theirs, in this order) with its own storage of
    /// unit stride; returns its number.
    pub fn add_element(&mut self, groups: &[usize], storage: Storage) -> usize {
        let n: usize = groups.iter().map(|&g| self.groups[g].len()).sum();
        let slot = Slot { base: self.values, stride: 1, storage };
        self.values += entries(n, storage);
        self.push_element(groups, slot)
    }

    /// Reserves `count` values, for elements placed there by [`Self::add_element_at`]; returns the first index.
    pub fn reserve(&mut self, count: usize) -> usize {
        let base = self.values;
        self.values += count;
        base
    }

    /// Adds one element whose matrix lies in storage reserved before; returns its number.
    pub fn add_element_at(&mut self, groups: &[usize], slot: Slot) -> usize {
        self.push_element(groups, slot)
    }

    fn push_element(&mut self, groups: &[usize], slot: Slot) -> usize {
        self.element_groups.extend(groups.iter().map(|&g| g as u32));
        self.element_starts.push(self.element_groups.len());
        self.slots.push(slot);
        self.slots.len() - 1
    }

    /// Number of unknowns, multipliers included.
    #[must_use]
    pub fn unknowns(&self) -> usize {
        self.unknowns
    }

    /// Number of velocity-level unknowns; the multipliers follow them.
    #[must_use]
    pub fn velocities(&self) -> usize {
        self.velocities
    }

    /// The groups of unknowns.
    #[must_use]
    pub fn groups(&self) -> &[Range<usize>] {
        &self.groups
    }

    /// Number of elements.
    #[must_use]
    pub fn elements(&self) -> usize {
        self.slots.len()
    }

    /// Numbers of the groups of element `e`.
    #[must_use]
    pub fn element(&self, e: usize) -> &[u32] {
        &self.element_groups[self.element_starts[e]..self.element_starts[e + 1]]
    }

    /// Storage of element `e`.
    #[must_use]
    pub fn slot(&self, e: usize) -> Slot {
        self.slots[e]
    }

    /// Length of the array of element values.
    #[must_use]
    pub fn values(&self) -> usize {
        self.values
    }

    /// Whether every element matrix is stored symmetric.
    #[must_use]
    pub fn is_symmetric(&self) -> bool {
        self.slots.iter().all(|s| s.storage == Storage::Symmetric)
    }

    /// The unknowns of element `e`, in its local order.
    pub fn element_unknowns(&self, e: usize) -> impl Iterator<Item = usize> + '_ {
        self.element(e).iter().flat_map(|&g| self.groups[g as usize].clone())
    }

    /// Entry (i, j) of element `e` in `values`.
    #[must_use]
    pub fn entry(&self, e: usize, n: usize, i: usize, j: usize, values: &[f64]) -> f64 {
        let slot = self.slots[e];
        values[slot.base + slot.stride * entry_number(n, i, j, slot.storage)]
    }

    /// `y += A x`, with A the sum of the element matrices (its transpose where `transposed`).
    pub fn multiply_add(&self, values: &[f64], x: &[f64], y: &mut [f64], transposed: bool) {
        let mut unknowns = Vec::with_capacity(48);
        let (mut from, mut to) = (Vec::with_capacity(48), Vec::with_capacity(48));
        for e in 0..self.elements() {
            unknowns.clear();
            unknowns.extend(self.element_unknowns(e));
            from.clear();
            from.extend(unknowns.iter().map(|&u| x[u]));
            to.clear();
            to.resize(unknowns.len(), 0.0);
            let slot = self.slots[e];
            let mut entries = values[slot.base..].iter().step_by(slot.stride);
            for i in 0..unknowns.len() {
                let mut sum = 0.0;
                match slot.storage {
                    Storage::Symmetric => {
                        for (j, a) in entries.by_ref().take(i + 1).enumerate() {
                            sum += a * from[j];
                            if j < i {
                                to[j] += a * from[i];
                            }
                        }
                    }
                    Storage::Full => {
                        for (j, a) in entries.by_ref().take(unknowns.len()).enumerate() {
                            if transposed {
                                to[j] += a * from[i];
                            } else {
                                sum += a * from[j];
                            }
                        }
                    }
                }
                to[i] += sum;
            }
            for (&u, to) in unknowns.iter().zip(&to) {
                y[u] += to;
            }
        }
    }
}

/// Number of stored entries of an n x n element matrix.
#[must_use]
pub fn entries(n: usize, storage: Storage) -> usize {
    match storage {
        Storage::Symmetric => n * (n + 1) / 2,
        Storage::Full => n * n,
    }
}

/// Number of entry (i, j) of an n x n element matrix in its storage.
#[must_use]
pub fn entry_number(n: usize, i: usize, j: usize, storage: Storage) -> usize {
    match storage {
        Storage::Symmetric if j <= i => i * (i + 1) / 2 + j,
        Storage::Symmetric => j * (j + 1) / 2 + i,
        Storage::Full => i * n + j,
    }
}
