//! Kernels on 6 x 6 blocks whose rows are padded to eight numbers, the width of the widest vector registers.
//!
//! All functions are inlined into one dispatched entry, so that they are compiled for the processor found at run
//! time. `FMA` is false only where no fused multiply-add exists and emulating it would cost a library call.

use crate::structure::{Slot, entry_number};

/// Unknowns of one chain node.
pub(super) const N: usize = 6;
/// Pivots smaller than this part of their diagonal entry call for pivoting.
const SAFE_PIVOT: f64 = 1e-9;
/// Pivots smaller than this part of their row count as zero.
const ZERO_PIVOT: f64 = 1e-14;

/// Six numbers and two zeros.
#[derive(Clone, Copy, Debug, Default)]
#[repr(align(64))]
pub(super) struct Row(pub(super) [f64; 8]);

/// Six rows.
pub(super) type Block = [Row; N];

/// A block of zeros.
pub(super) const ZERO: Block = [Row([0.0; 8]); N];

#[inline(always)]
fn multiply_add<const FMA: bool>(a: f64, b: f64, c: f64) -> f64 {
    if FMA { a.mul_add(b, c) } else { a * b + c }
}

impl Row {
    /// The six numbers of a node.
    #[inline(always)]
    pub(super) fn load(x: &[f64]) -> Self {
        let mut row = [0.0; 8];
        row[..N].copy_from_slice(&x[..N]);
        Self(row)
    }

    /// `self += a row`.
    #[inline(always)]
    pub(super) fn add<const FMA: bool>(&mut self, a: f64, row: &Self) {
        for j in 0..8 {
            self.0[j] = multiply_add::<FMA>(a, row.0[j], self.0[j]);
        }
    }

    /// `self += a * b`, number by number.
    #[inline(always)]
    pub(super) fn add_products<const FMA: bool>(&mut self, a: &Self, b: &Self) {
        for j in 0..8 {
            self.0[j] = multiply_add::<FMA>(a.0[j], b.0[j], self.0[j]);
        }
    }

    /// `self - other`.
    #[inline(always)]
    pub(super) fn minus(&self, other: &Self) -> Self {
        let mut row = *self;
        for j in 0..8 {
            row.0[j] -= other.0[j];
        }
        row
    }

    /// Sum of all numbers.
    #[inline(always)]
    pub(super) fn sum(&self) -> f64 {
        let r = &self.0;
        ((r[0] + r[1]) + (r[2] + r[3])) + (r[4] + r[5])
    }
}

/// `sum_i x_i rows_i`: the product of the transposed block with x.
#[inline(always)]
pub(super) fn combine<const FMA: bool>(rows: &Block, x: &Row) -> Row {
    // Two sums at a time halve the latency of the recurrences.
    let mut even = Row::default();
    let mut odd = Row::default();
    for i in 0..N / 2 {
        even.add::<FMA>(x.0[2 * i], &rows[2 * i]);
        odd.add::<FMA>(x.0[2 * i + 1], &rows[2 * i + 1]);
    }
    for j in 0..8 {
        even.0[j] += odd.0[j];
    }
    even
}

/// `a b`.
#[inline(always)]
pub(super) fn product<const FMA: bool>(a: &Block, b: &Block) -> Block {
    let mut c = ZERO;
    for i in 0..N {
        for j in 0..N {
            c[i].add::<FMA>(a[i].0[j], &b[j]);
        }
    }
    c
}

/// `a^T b`.
#[inline(always)]
pub(super) fn transposed_product<const FMA: bool>(a: &Block, b: &Block) -> Block {
    let mut c = ZERO;
    for i in 0..N {
        for j in 0..N {
            c[i].add::<FMA>(a[j].0[i], &b[j]);
        }
    }
    c
}

/// `c - a^T b`.
#[inline(always)]
pub(super) fn minus_transposed_product<const FMA: bool>(c: &Block, a: &Block, b: &Block) -> Block {
    let ab = transposed_product::<FMA>(a, b);
    let mut difference = ZERO;
    for i in 0..N {
        difference[i] = c[i].minus(&ab[i]);
    }
    difference
}

/// The transposed block.
#[inline(always)]
pub(super) fn transpose(a: &Block) -> Block {
    let mut t = ZERO;
    for j in 0..N {
        t[j] = row_of(|i| a[i].0[j]);
    }
    t
}

/// A row from its six numbers, written out: a loop of strided stores would become slow scatters.
#[inline(always)]
fn row_of(entry: impl Fn(usize) -> f64) -> Row {
    Row([entry(0), entry(1), entry(2), entry(3), entry(4), entry(5), 0.0, 0.0])
}

/// The inverse by sweeps without pivoting, and whether all pivots were safe.
///
/// Sweeps are as stable as a Cholesky factorisation where the block is definite, however stiff it is; cofactors are
/// not.
#[inline(always)]
pub(super) fn invert<const FMA: bool>(block: &Block) -> (Block, bool) {
    let mut a = *block;
    let mut safe = true;
    for k in 0..N {
        let pivot = a[k].0[k];
        safe &= pivot.abs() > SAFE_PIVOT * block[k].0[k].abs();
        let inverse = 1.0 / pivot;
        let mut row = a[k];
        row.0[k] = 1.0;
        for j in 0..8 {
            row.0[j] *= inverse;
        }
        for i in 0..N {
            if i != k {
                let factor = a[i].0[k];
                a[i].0[k] = 0.0;
                a[i].add::<FMA>(-factor, &row);
            }
        }
        a[k] = row;
    }
    (a, safe)
}

/// The inverse by elimination with row pivoting; on failure the column without a pivot.
#[inline(never)]
pub(super) fn invert_pivoted(block: &Block) -> Result<Block, usize> {
    let mut a = *block;
    let mut inverse = ZERO;
    for i in 0..N {
        let largest = a[i].0.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
        if largest == 0.0 || !largest.is_finite() {
            return Err(i);
        }
        for v in &mut a[i].0 {
            *v /= largest;
        }
        inverse[i].0[i] = 1.0 / largest;
    }
    for k in 0..N {
        let mut best = k;
        for i in k + 1..N {
            if a[i].0[k].abs() > a[best].0[k].abs() {
                best = i;
            }
        }
        a.swap(k, best);
        inverse.swap(k, best);
        let pivot = a[k].0[k];
        if pivot.is_nan() || pivot.abs() < ZERO_PIVOT {
            return Err(k);
        }
        for v in a[k].0.iter_mut().chain(&mut inverse[k].0) {
            *v /= pivot;
        }
        let (row, inverse_row) = (a[k], inverse[k]);
        for i in 0..N {
            if i != k {
                let factor = a[i].0[k];
                a[i].add::<false>(-factor, &row);
                inverse[i].add::<false>(-factor, &inverse_row);
            }
        }
    }
    Ok(inverse)
}

/// `block += A[row.., column..]`, from an element matrix of size n in any storage.
#[inline(never)]
pub(super) fn add_part(
    block: &mut Block,
    values: &[f64],
    slot: Slot,
    n: usize,
    row: usize,
    column: usize,
) {
    for i in 0..N {
        for j in 0..N {
            let k = entry_number(n, row + i, column + j, slot.storage);
            block[i].0[j] += values[slot.base + k * slot.stride];
        }
    }
}

/// The parts of a symmetric 12 x 12 element matrix of fixed stride, seen from its first (or, `SWAPPED`, second) node:
/// `diagonal` plus that node's block, its coupling to the other node, and the other node's block.
#[inline(always)]
pub(super) fn pick<const STRIDE: usize, const SWAPPED: bool>(
    values: &[f64],
    base: usize,
    diagonal: &Block,
) -> [Block; 3] {
    // One bounds check for all entries.
    let v = &values[base..base + 77 * STRIDE + 1];
    let entry = |i: usize, j: usize| {
        let (i, j) = if i < j { (j, i) } else { (i, j) };
        v[STRIDE * (i * (i + 1) / 2 + j)]
    };
    let (here, there) = if SWAPPED { (N, 0) } else { (0, N) };
    let mut parts = [ZERO; 3];
    for i in 0..N {
        parts[0][i] = row_of(|j| diagonal[i].0[j] + entry(here + i, here + j));
        parts[1][i] = row_of(|j| entry(here + i, there + j));
        parts[2][i] = row_of(|j| entry(there + i, there + j));
    }
    parts
}
