//! The few unknowns at the end of a chain that belong to nobody else: private slopes, a joint to the world with its
//! multipliers. They are eliminated first, by a small pivoted factorisation.

use super::block::N;
use super::graph::End;
use crate::dense::DenseLu;
use crate::structure::{Structure, entry_number};

/// A cap of `p` unknowns, coupled to `rest` others: the first chain node, then the interface.
pub(super) struct Cap {
    unknowns: Vec<u32>,
    rest: usize,
    /// Element value to matrix entry.
    moves: Vec<(u32, u32)>,
    /// All of it, (p + rest) square, row by row.
    matrix: Vec<f64>,
    lu: DenseLu,
    /// Inverse of the cap's own block K.
    inverse: Vec<f64>,
    /// `K^-1 A[cap, rest]`.
    right: Vec<f64>,
    /// `A[rest, cap] K^-1`.
    left: Vec<f64>,
    /// What is left for the rest, square.
    pub(super) schur: Vec<f64>,
    z: Vec<f64>,
}

impl Cap {
    pub(super) fn new(structure: &Structure, end: &End, first: usize) -> Self {
        let of = |groups: &[u32]| -> Vec<u32> {
            let ranges = groups.iter().map(|&g| structure.groups()[g as usize].clone());
            ranges.flatten().map(|u| u as u32).collect()
        };
        let unknowns = of(&end.cap);
        let mut all = unknowns.clone();
        all.extend(of(&[first as u32]));
        all.extend(of(&end.interface));
        let (p, t) = (unknowns.len(), all.len());
        let mut moves = Vec::new();
        for &e in &end.elements {
            let slot = structure.slot(e);
            let local: Vec<usize> = structure
                .element_unknowns(e)
                .filter_map(|u| all.iter().position(|&a| a as usize == u))
                .collect();
            let n = local.len();
            for (i, row) in local.iter().enumerate() {
                for (j, column) in local.iter().enumerate() {
                    let k = slot.base + slot.stride * entry_number(n, i, j, slot.storage);
                    moves.push((k as u32, (row * t + column) as u32));
                }
            }
        }
        let rest = t - p;
        Self {
            unknowns,
            rest,
            moves,
            matrix: vec![0.0; t * t],
            lu: DenseLu::new(p),
            inverse: vec![0.0; p * p],
            right: vec![0.0; p * rest],
            left: vec![0.0; rest * p],
            schur: vec![0.0; rest * rest],
            z: vec![0.0; p],
        }
    }

    /// Number of interface unknowns.
    pub(super) fn interface(&self) -> usize {
        self.rest - N
    }

    /// Eliminates the cap; on failure names the unknown.
    pub(super) fn factor(&mut self, values: &[f64]) -> Result<(), usize> {
        let (p, rest) = (self.unknowns.len(), self.rest);
        let t = p + rest;
        self.matrix.fill(0.0);
        for &(from, to) in &self.moves {
            self.matrix[to as usize] += values[from as usize];
        }
        for i in 0..p {
            let row = &self.matrix[i * t..i * t + p];
            self.lu.matrix()[i * p..(i + 1) * p].copy_from_slice(row);
        }
        self.lu.factor().map_err(|i| self.unknowns[i] as usize)?;
        for j in 0..p {
            self.z.fill(0.0);
            self.z[j] = 1.0;
            self.lu.solve(&mut self.z);
            for i in 0..p {
                self.inverse[i * p + j] = self.z[i];
            }
        }
        for i in 0..p {
            for c in 0..rest {
                let sum = |at: &dyn Fn(usize) -> f64, row: &dyn Fn(usize) -> f64| -> f64 {
                    (0..p).map(|k| at(k) * row(k)).sum()
                };
                self.right[i * rest + c] =
                    sum(&|k| self.inverse[i * p + k], &|k| self.matrix[k * t + p + c]);
                self.left[c * p + i] =
                    sum(&|k| self.matrix[(p + c) * t + k], &|k| self.inverse[k * p + i]);
            }
        }
        for a in 0..rest {
            for b in 0..rest {
                let eliminated: f64 =
                    (0..p).map(|k| self.matrix[(p + a) * t + k] * self.right[k * rest + b]).sum();
                self.schur[a * rest + b] = self.matrix[(p + a) * t + p + b] - eliminated;
            }
        }
        Ok(())
    }

    /// Share of the cap's right-hand side in number `c` of the rest, to be subtracted there.
    pub(super) fn forward(&self, b: &[f64], c: usize, transposed: bool) -> f64 {
        let (p, rest) = (self.unknowns.len(), self.rest);
        let mut sum = 0.0;
        for (i, &u) in self.unknowns.iter().enumerate() {
            let factor = if transposed { self.right[i * rest + c] } else { self.left[c * p + i] };
            sum += factor * b[u as usize];
        }
        sum
    }

    /// Keeps the cap's part of the right-hand side, solved.
    pub(super) fn keep(&mut self, b: &[f64], transposed: bool) {
        let p = self.unknowns.len();
        for i in 0..p {
            self.z[i] = 0.0;
            for (k, &u) in self.unknowns.iter().enumerate() {
                let a = if transposed { self.inverse[k * p + i] } else { self.inverse[i * p + k] };
                self.z[i] += a * b[u as usize];
            }
        }
    }

    /// Solution of the cap, from that of the first node and the interface.
    pub(super) fn backward(&mut self, first: &[f64], interface: &[f64], transposed: bool) {
        let (p, rest) = (self.unknowns.len(), self.rest);
        for i in 0..p {
            let known = first[..N].iter().chain(interface).enumerate();
            for (c, x) in known {
                let a = if transposed { self.left[c * p + i] } else { self.right[i * rest + c] };
                self.z[i] -= a * x;
            }
        }
    }

    /// Writes the solution.
    pub(super) fn scatter(&self, x: &mut [f64]) {
        for (&u, z) in self.unknowns.iter().zip(&self.z) {
            x[u as usize] = *z;
        }
    }
}
