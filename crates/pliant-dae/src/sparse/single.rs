//! Supernodal factors in single precision, for corrections.
//!
//! A solution reads the factors twice and does little else: of large systems it costs what reading costs, and half as
//! long numbers half of that. All sums are in double precision; the solution is good to about 1e-7 times the growth in
//! the factors, which the probe measures.

use super::kernels::{backward, copy_single, forward};
use faer::sparse::linalg::cholesky::supernodal::SymbolicSupernodalCholesky;
use pulp::{Arch, Simd, WithSimd};

type Symbolic = SymbolicSupernodalCholesky<u32>;

/// A copy of factors L and D.
pub(super) struct Single {
    /// As the factors' own: blocks of columns, D on the diagonal.
    values: Vec<f32>,
    /// Reciprocals of D.
    inverse: Vec<f64>,
    /// The permuted right-hand side.
    x: Vec<f64>,
    /// Rows of one block.
    rows: Vec<f64>,
}

/// Columns of a block of factors: its first unknown, their number, that of its rows and the first entry.
struct Block {
    first: usize,
    columns: usize,
    rows: usize,
    start: usize,
}

fn block(symbolic: &Symbolic, s: usize) -> Block {
    let first = symbolic.supernode_begin()[s] as usize;
    let columns = symbolic.supernode_end()[s] as usize - first;
    let rows = columns + symbolic.nnz_per_super()[s] as usize;
    Block { first, columns, rows, start: symbolic.col_ptr_for_val()[s] as usize }
}

/// Unknowns of the rows below the diagonal block.
fn below(symbolic: &Symbolic, s: usize) -> &[u32] {
    let start = symbolic.col_ptr_for_row_idx()[s] as usize;
    &symbolic.row_idx()[start..start + symbolic.nnz_per_super()[s] as usize]
}

impl Single {
    pub(super) fn new(symbolic: &Symbolic) -> Self {
        let count = symbolic.n_supernodes();
        let longest = (0..count).map(|s| block(symbolic, s).rows).max().unwrap_or(0);
        Self {
            values: vec![0.0; symbolic.len_val()],
            inverse: vec![0.0; symbolic.ncols()],
            x: vec![0.0; symbolic.ncols()],
            rows: vec![0.0; longest],
        }
    }

    /// Takes over factors.
    pub(super) fn copy(&mut self, symbolic: &Symbolic, values: &[f64]) {
        copy_single(values, &mut self.values);
        for s in 0..symbolic.n_supernodes() {
            let Block { first, columns, rows, start } = block(symbolic, s);
            for j in 0..columns {
                self.inverse[first + j] = 1.0 / values[start + j * (rows + 1)];
            }
        }
    }

    /// Overwrites the right-hand side by the solution; `order` lists the unknowns as they were eliminated.
    pub(super) fn solve(&mut self, symbolic: &Symbolic, order: &[u32], b: &mut [f64]) {
        for (x, &i) in self.x.iter_mut().zip(order) {
            *x = b[i as usize];
        }
        Arch::new().dispatch(Sweeps { symbolic, factors: self });
        for (x, &i) in self.x.iter().zip(order) {
            b[i as usize] = *x;
        }
    }
}

/// Forward and backward substitution, compiled for the vector registers of the processor at hand.
struct Sweeps<'a> {
    symbolic: &'a Symbolic,
    factors: &'a mut Single,
}

impl WithSimd for Sweeps<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self { symbolic, factors: Single { values, inverse, x, rows } } = self;
        for s in 0..symbolic.n_supernodes() {
            let Block { first, columns, rows: height, start } = block(symbolic, s);
            let l = &values[start..start + columns * height];
            let y = &mut rows[..height];
            y[..columns].copy_from_slice(&x[first..first + columns]);
            y[columns..].fill(0.0);
            forward(l, columns, y);
            x[first..first + columns].copy_from_slice(&y[..columns]);
            for (&i, y) in below(symbolic, s).iter().zip(&y[columns..]) {
                x[i as usize] += y;
            }
        }
        for s in (0..symbolic.n_supernodes()).rev() {
            let Block { first, columns, rows: height, start } = block(symbolic, s);
            let l = &values[start..start + columns * height];
            let y = &mut rows[..height];
            for (&i, y) in below(symbolic, s).iter().zip(&mut y[columns..]) {
                *y = x[i as usize];
            }
            for j in 0..columns {
                y[j] = x[first + j] * inverse[first + j];
            }
            backward(l, columns, y);
            x[first..first + columns].copy_from_slice(&y[..columns]);
        }
    }
}
