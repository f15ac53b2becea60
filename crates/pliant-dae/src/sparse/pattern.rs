//! Compressed columns of the assembled matrix, and where every element entry goes.

use crate::structure::{Storage, Structure, entry_number};

/// Sparsity of the assembled matrix by columns: all of it, or its upper triangle.
#[derive(Clone, Debug, Default)]
pub(super) struct Pattern {
    pub(super) starts: Vec<u32>,
    pub(super) rows: Vec<u32>,
    /// Index of each diagonal entry (all are present).
    pub(super) diagonal: Vec<u32>,
    /// Whether only entries with row <= column are stored.
    pub(super) upper: bool,
}

/// `matrix[to] += values[from]`, in the order of the elements.
#[derive(Clone, Copy, Debug)]
pub(super) struct Move {
    from: u32,
    to: u32,
}

impl Pattern {
    /// The pattern of a structure, and the moves that assemble its matrix.
    pub(super) fn new(structure: &Structure, upper: bool) -> (Self, Vec<Move>) {
        let n = structure.unknowns();
        let mut sources = Vec::new();
        let mut places = Vec::new();
        // A place for each diagonal entry, whether an element has it or not.
        for i in 0..n as u32 {
            places.push((i, i));
        }
        let mut unknowns = Vec::new();
        for e in 0..structure.elements() {
            unknowns.clear();
            unknowns.extend(structure.element_unknowns(e).map(|u| u as u32));
            let size = unknowns.len();
            let slot = structure.slot(e);
            for i in 0..size {
                for j in 0..size {
                    // Of a symmetric pair the upper triangle keeps one; within one unknown both count.
                    let (row, column) = (unknowns[i], unknowns[j]);
                    if upper && row > column {
                        continue;
                    }
                    debug_assert!(!upper || slot.storage == Storage::Symmetric);
                    let k = entry_number(size, i, j, slot.storage);
                    sources.push((slot.base + k * slot.stride) as u32);
                    places.push((row, column));
                }
            }
        }
        let (pattern, slots) = Self::from_places(n, &places, upper);
        let moves = sources.iter().zip(&slots[n..]).map(|(&from, &to)| Move { from, to }).collect();
        (pattern, moves)
    }

    /// Sorts places (row, column) into columns, merging equal ones; returns the index of each place too.
    fn from_places(n: usize, places: &[(u32, u32)], upper: bool) -> (Self, Vec<u32>) {
        let mut column_starts = vec![0_u32; n + 1];
        for &(_, column) in places {
            column_starts[column as usize + 1] += 1;
        }
        for j in 0..n {
            column_starts[j + 1] += column_starts[j];
        }
        let mut next = column_starts.clone();
        let mut sorted = vec![(0_u32, 0_u32); places.len()];
        for (k, &(row, column)) in places.iter().enumerate() {
            let at = &mut next[column as usize];
            sorted[*at as usize] = (row, k as u32);
            *at += 1;
        }
        let mut pattern = Self { starts: vec![0], diagonal: vec![0; n], upper, ..Self::default() };
        let mut slots = vec![0; places.len()];
        for j in 0..n {
            let column = &mut sorted[column_starts[j] as usize..column_starts[j + 1] as usize];
            column.sort_unstable();
            let mut last = u32::MAX;
            for &(row, k) in column.iter() {
                if row != last {
                    pattern.rows.push(row);
                    last = row;
                }
                let slot = pattern.rows.len() as u32 - 1;
                slots[k as usize] = slot;
                if row as usize == j {
                    pattern.diagonal[j] = slot;
                }
            }
            pattern.starts.push(pattern.rows.len() as u32);
        }
        (pattern, slots)
    }

    /// The whole pattern of an upper one, with the index of each entry's value there.
    pub(super) fn expanded(&self) -> (Self, Vec<u32>) {
        let n = self.size();
        let mut places = Vec::with_capacity(2 * self.rows.len());
        let mut origins = Vec::with_capacity(2 * self.rows.len());
        for j in 0..n {
            for k in self.column(j) {
                let i = self.rows[k];
                places.push((i, j as u32));
                origins.push(k as u32);
                if i as usize != j {
                    places.push((j as u32, i));
                    origins.push(k as u32);
                }
            }
        }
        let (pattern, slots) = Self::from_places(n, &places, false);
        let mut from = vec![0; pattern.rows.len()];
        for (&slot, &origin) in slots.iter().zip(&origins) {
            from[slot as usize] = origin;
        }
        (pattern, from)
    }

    /// The pattern's upper triangle alone.
    pub(super) fn upper_part(&self) -> Self {
        let mut part = Self { starts: vec![0], upper: true, ..Self::default() };
        for j in 0..self.size() {
            let rows = &self.rows[self.column(j)];
            part.rows.extend(rows.iter().take_while(|&&i| i as usize <= j));
            // Rows ascend: the diagonal entry comes last.
            part.diagonal.push(part.rows.len() as u32 - 1);
            part.starts.push(part.rows.len() as u32);
        }
        part
    }

    /// Number of unknowns.
    pub(super) fn size(&self) -> usize {
        self.diagonal.len()
    }

    /// Indices of the entries of column `j`.
    pub(super) fn column(&self, j: usize) -> std::ops::Range<usize> {
        self.starts[j] as usize..self.starts[j + 1] as usize
    }

    /// Overwrites the entries of the matrix by the sums of the element entries.
    pub(super) fn assemble(&self, moves: &[Move], values: &[f64], matrix: &mut [f64]) {
        matrix.fill(0.0);
        for m in moves {
            matrix[m.to as usize] += values[m.from as usize];
        }
    }

    /// `y -= A x`, or with the transpose.
    pub(super) fn subtract_product(
        &self,
        matrix: &[f64],
        x: &[f64],
        y: &mut [f64],
        transposed: bool,
    ) {
        for j in 0..self.size() {
            let mut sum = 0.0;
            let entries = self.column(j);
            if self.upper || !transposed {
                let xj = x[j];
                for (&i, &a) in self.rows[entries.clone()].iter().zip(&matrix[entries.clone()]) {
                    y[i as usize] -= a * xj;
                }
            }
            if self.upper || transposed {
                for (&i, &a) in self.rows[entries.clone()].iter().zip(&matrix[entries]) {
                    sum += a * x[i as usize];
                }
                if self.upper {
                    sum -= matrix[self.diagonal[j] as usize] * x[j];
                }
                y[j] -= sum;
            }
        }
    }
}
