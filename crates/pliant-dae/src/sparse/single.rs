//! Supernodal factors in single precision, for corrections.
//!
//! A solution reads the factors twice and does little else: of large systems it costs what reading costs, and half as
//! long numbers half of that. All sums are in double precision; the solution is good to about 1e-7 times the growth in
//! the factors, which the probe measures.

use crate::passes::vectorised;
use faer::sparse::linalg::cholesky::supernodal::SymbolicSupernodalCholesky;
use pulp::{Arch, Simd, WithSimd};

/// Entries below this are nothing: numbers without a leading one are slow.
const NOTHING: f64 = 1e-30;
/// Columns treated together.
const TOGETHER: usize = 4;
/// Rows added at once.
const LANES: usize = 8;

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
        vectorised(|| {
            for (to, &from) in self.values.iter_mut().zip(values) {
                *to = if from.abs() < NOTHING { 0.0 } else { from as f32 };
            }
        });
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

/// `y <- L^-1 y` in the first rows, `-L y` added to the others.
#[inline(always)]
fn forward(l: &[f32], columns: usize, y: &mut [f64]) {
    let height = y.len();
    let column = |j: usize| &l[j * height..(j + 1) * height];
    let mut j = 0;
    while j + TOGETHER <= columns {
        for k in 0..TOGETHER - 1 {
            for i in k + 1..TOGETHER {
                y[j + i] -= f64::from(column(j + k)[j + i]) * y[j + k];
            }
        }
        let [a, b, c, d] = std::array::from_fn(|k| y[j + k]);
        let rest = j + TOGETHER..height;
        let y = &mut y[rest.clone()];
        let n = y.len();
        let [la, lb, lc, ld] = std::array::from_fn(|k| &column(j + k)[rest.clone()][..n]);
        for i in 0..n {
            y[i] -= (f64::from(la[i]) * a + f64::from(lb[i]) * b)
                + (f64::from(lc[i]) * c + f64::from(ld[i]) * d);
        }
        j += TOGETHER;
    }
    while j < columns {
        let a = y[j];
        for (y, l) in y[j + 1..].iter_mut().zip(&column(j)[j + 1..]) {
            *y -= f64::from(*l) * a;
        }
        j += 1;
    }
}

/// `y <- L^-T y` in the first rows, all others known.
#[inline(always)]
fn backward(l: &[f32], columns: usize, y: &mut [f64]) {
    let height = y.len();
    let column = |j: usize| &l[j * height..(j + 1) * height];
    let mut j = columns;
    while !j.is_multiple_of(TOGETHER) {
        j -= 1;
        y[j] -= product(&column(j)[j + 1..], &y[j + 1..]);
    }
    while j > 0 {
        j -= TOGETHER;
        let rest = j + TOGETHER..height;
        let sums =
            products(std::array::from_fn(|k| &column(j + k)[rest.clone()]), &y[rest.clone()]);
        for k in (0..TOGETHER).rev() {
            let mut sum = sums[k];
            for i in k + 1..TOGETHER {
                sum += f64::from(column(j + k)[j + i]) * y[j + i];
            }
            y[j + k] -= sum;
        }
    }
}

#[inline(always)]
fn product(l: &[f32], y: &[f64]) -> f64 {
    let (l, l_rest) = l.as_chunks::<LANES>();
    let (y, y_rest) = y.as_chunks::<LANES>();
    let mut sums = [0.0; LANES];
    for (l, y) in l.iter().zip(y) {
        for i in 0..LANES {
            sums[i] += f64::from(l[i]) * y[i];
        }
    }
    let rest: f64 = l_rest.iter().zip(y_rest).map(|(l, y)| f64::from(*l) * y).sum();
    sums.iter().sum::<f64>() + rest
}

/// Products of four columns with one vector.
#[inline(always)]
fn products(l: [&[f32]; TOGETHER], y: &[f64]) -> [f64; TOGETHER] {
    let chunks = l.map(|l| l.as_chunks::<LANES>());
    let (full, rest) = y.as_chunks::<LANES>();
    let n = full.len();
    let columns = chunks.map(|(l, _)| &l[..n]);
    let mut sums = [[0.0; LANES]; TOGETHER];
    for (c, y) in full.iter().enumerate() {
        for k in 0..TOGETHER {
            for i in 0..LANES {
                sums[k][i] += f64::from(columns[k][c][i]) * y[i];
            }
        }
    }
    std::array::from_fn(|k| {
        let tail: f64 = chunks[k].1.iter().zip(rest).map(|(l, y)| f64::from(*l) * y).sum();
        sums[k].iter().sum::<f64>() + tail
    })
}
