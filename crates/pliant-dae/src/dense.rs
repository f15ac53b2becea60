//! LU factorisation with partial pivoting of a small dense matrix.

use crate::linear_solver::{FactorError, LinearSolver, non_finite_element};
use crate::structure::Structure;

/// Pivots below this, in a matrix whose rows and columns have largest entries 1, count as zero.
const ZERO_PIVOT: f64 = 1e-14;

/// Dense LU with row pivoting of the equilibrated matrix.
#[derive(Clone, Debug, Default)]
pub(crate) struct DenseLu {
    n: usize,
    /// Row by row: U above the diagonal, the multipliers of L below, inverse pivots on the diagonal.
    lu: Vec<f64>,
    row_scale: Vec<f64>,
    column_scale: Vec<f64>,
    /// Row `permutation[i]` of the matrix is row i of the factors.
    permutation: Vec<u32>,
    scratch: Vec<f64>,
}

impl DenseLu {
    /// Room for a matrix of `n` unknowns.
    pub(crate) fn new(n: usize) -> Self {
        Self {
            n,
            lu: vec![0.0; n * n],
            row_scale: vec![1.0; n],
            column_scale: vec![1.0; n],
            permutation: (0..n as u32).collect(),
            scratch: vec![0.0; n],
        }
    }

    /// The matrix, row by row, to be filled before [`Self::factor`].
    pub(crate) fn matrix(&mut self) -> &mut [f64] {
        &mut self.lu
    }

    /// Factorises what was put into [`Self::matrix`]; on failure names the column without a pivot.
    pub(crate) fn factor(&mut self) -> Result<(), usize> {
        let n = self.n;
        self.equilibrate()?;
        for (i, p) in self.permutation.iter_mut().enumerate() {
            *p = i as u32;
        }
        for k in 0..n {
            let mut best = k;
            for i in k + 1..n {
                if self.lu[i * n + k].abs() > self.lu[best * n + k].abs() {
                    best = i;
                }
            }
            let pivot = self.lu[best * n + k];
            if pivot.is_nan() || pivot.abs() < ZERO_PIVOT {
                return Err(k);
            }
            if best != k {
                let (upper, lower) = self.lu.split_at_mut(best * n);
                upper[k * n..(k + 1) * n].swap_with_slice(&mut lower[..n]);
                self.permutation.swap(k, best);
            }
            self.eliminate(k);
        }
        Ok(())
    }

    /// Scales rows, then columns, to largest entries of 1: forces and constraints become comparable.
    fn equilibrate(&mut self) -> Result<(), usize> {
        let n = self.n;
        self.column_scale.fill(0.0);
        for i in 0..n {
            let row = &mut self.lu[i * n..(i + 1) * n];
            let largest = row.iter().fold(0.0_f64, |m, a| m.max(a.abs()));
            if largest == 0.0 || !largest.is_finite() {
                return Err(i);
            }
            self.row_scale[i] = 1.0 / largest;
            for (a, c) in row.iter_mut().zip(&mut self.column_scale) {
                *a /= largest;
                *c = c.max(a.abs());
            }
        }
        for (j, c) in self.column_scale.iter_mut().enumerate() {
            if *c == 0.0 {
                return Err(j);
            }
            *c = 1.0 / *c;
        }
        for row in self.lu.chunks_exact_mut(n.max(1)) {
            for (a, c) in row.iter_mut().zip(&self.column_scale) {
                *a *= c;
            }
        }
        Ok(())
    }

    fn eliminate(&mut self, k: usize) {
        let n = self.n;
        let (upper, lower) = self.lu.split_at_mut((k + 1) * n);
        let pivot_row = &mut upper[k * n..];
        let inverse = 1.0 / pivot_row[k];
        pivot_row[k] = inverse;
        let tail = &pivot_row[k + 1..];
        for row in lower.chunks_exact_mut(n) {
            // Small systems are mostly sparse too.
            if row[k] != 0.0 {
                let factor = row[k] * inverse;
                row[k] = factor;
                for (a, p) in row[k + 1..].iter_mut().zip(tail) {
                    *a -= factor * p;
                }
            }
        }
    }

    /// Overwrites the right-hand side by the solution.
    pub(crate) fn solve(&mut self, x: &mut [f64]) {
        let n = self.n;
        for i in 0..n {
            let p = self.permutation[i] as usize;
            let row = &self.lu[i * n..i * n + i];
            let sum: f64 = row.iter().zip(&self.scratch).map(|(l, y)| l * y).sum();
            self.scratch[i] = self.row_scale[p] * x[p] - sum;
        }
        for i in (0..n).rev() {
            let row = &self.lu[i * n..(i + 1) * n];
            let sum: f64 =
                row[i + 1..].iter().zip(&self.scratch[i + 1..]).map(|(u, y)| u * y).sum();
            self.scratch[i] = (self.scratch[i] - sum) * row[i];
        }
        for ((x, y), c) in x.iter_mut().zip(&self.scratch).zip(&self.column_scale) {
            *x = y * c;
        }
    }

    /// The same with the transposed matrix.
    pub(crate) fn solve_transposed(&mut self, x: &mut [f64]) {
        let n = self.n;
        for (i, y) in self.scratch.iter_mut().enumerate() {
            *y = x[i] * self.column_scale[i];
        }
        for i in 0..n {
            let row = &self.lu[i * n..(i + 1) * n];
            let (head, tail) = self.scratch.split_at_mut(i + 1);
            head[i] *= row[i];
            let y = head[i];
            for (s, u) in tail.iter_mut().zip(&row[i + 1..]) {
                *s -= u * y;
            }
        }
        for i in (0..n).rev() {
            let (head, tail) = self.scratch.split_at_mut(i);
            for (s, l) in head.iter_mut().zip(&self.lu[i * n..i * n + i]) {
                *s -= l * tail[0];
            }
        }
        for (i, &p) in self.permutation.iter().enumerate() {
            x[p as usize] = self.scratch[i] * self.row_scale[p as usize];
        }
    }
}

/// Adds the element matrices of `structure` into a dense matrix, row by row.
pub(crate) fn assemble(structure: &Structure, values: &[f64], matrix: &mut [f64]) {
    let n = structure.unknowns();
    matrix.fill(0.0);
    for e in 0..structure.elements() {
        let size = structure.element_unknowns(e).count();
        for (i, row) in structure.element_unknowns(e).enumerate() {
            for (j, column) in structure.element_unknowns(e).enumerate() {
                matrix[row * n + column] += structure.entry(e, size, i, j, values);
            }
        }
    }
}

/// Back end for small systems.
pub(crate) struct Dense {
    lu: DenseLu,
}

impl Dense {
    pub(crate) fn new(structure: &Structure) -> Self {
        Self { lu: DenseLu::new(structure.unknowns()) }
    }
}

impl LinearSolver for Dense {
    fn factor(&mut self, structure: &Structure, values: &[f64]) -> Result<(), FactorError> {
        assemble(structure, values, self.lu.matrix());
        self.lu.factor().map_err(|unknown| match non_finite_element(structure, values) {
            Some(element) => FactorError::NotFinite { element },
            None => FactorError::Singular { unknown },
        })
    }

    fn solve(&mut self, x: &mut [f64]) {
        self.lu.solve(x);
    }

    fn solve_transposed(&mut self, x: &mut [f64]) {
        self.lu.solve_transposed(x);
    }

    fn factor_cost(&self) -> f64 {
        // n^3 / 3 against n^2, with a tangent of about five residuals.
        5.0 + self.lu.n as f64 / 12.0
    }

    fn describe(&self) -> String {
        format!("dense: {} unknowns", self.lu.n)
    }
}
