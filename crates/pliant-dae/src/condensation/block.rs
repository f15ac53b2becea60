//! Kernels on 6 x 6 blocks whose rows are padded to eight numbers, the width of the widest vector registers.
//!
//! All functions are inlined into one dispatched entry, so that they are compiled for the processor found at run
//! time. Vectors are pulp's types: loops over plain arrays of this size are not reliably kept in registers.

use crate::structure::{Slot, entry_number};
use pulp::{Scalar, Simd};

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

/// Arithmetic on rows held in registers.
pub(super) trait Lanes: Copy {
    /// A row.
    type V: Copy;
    fn splat(self, a: f64) -> Self::V;
    fn load(self, row: &Row) -> Self::V;
    fn store(self, v: Self::V) -> Row;
    fn multiply(self, a: Self::V, b: Self::V) -> Self::V;
    /// `a - b`.
    fn subtract(self, a: Self::V, b: Self::V) -> Self::V;
    /// `a b + c`, fused only where the processor can.
    fn multiply_add(self, a: Self::V, b: Self::V, c: Self::V) -> Self::V;
}

/// Rows as `M` vectors of S.
#[derive(Clone, Copy)]
pub(super) struct Wide<S, const M: usize>(pub(super) S);

/// Without vectors.
pub(super) const PLAIN: Wide<Scalar, 8> = Wide(Scalar);

impl<S: Simd, const M: usize> Lanes for Wide<S, M> {
    type V = [S::f64s; M];

    #[inline(always)]
    fn splat(self, a: f64) -> Self::V {
        [self.0.splat_f64s(a); M]
    }

    #[inline(always)]
    fn load(self, row: &Row) -> Self::V {
        let (vectors, _) = S::as_simd_f64s(&row.0);
        let mut v = self.splat(0.0);
        v.copy_from_slice(&vectors[..M]);
        v
    }

    #[inline(always)]
    fn store(self, v: Self::V) -> Row {
        let mut row = Row::default();
        let (vectors, _) = S::as_mut_simd_f64s(&mut row.0);
        vectors[..M].copy_from_slice(&v);
        row
    }

    #[inline(always)]
    fn multiply(self, a: Self::V, b: Self::V) -> Self::V {
        let mut c = a;
        for m in 0..M {
            c[m] = self.0.mul_f64s(a[m], b[m]);
        }
        c
    }

    #[inline(always)]
    fn subtract(self, a: Self::V, b: Self::V) -> Self::V {
        let mut c = a;
        for m in 0..M {
            c[m] = self.0.sub_f64s(a[m], b[m]);
        }
        c
    }

    #[inline(always)]
    fn multiply_add(self, a: Self::V, b: Self::V, c: Self::V) -> Self::V {
        let mut d = c;
        for m in 0..M {
            d[m] = self.0.mul_add_e_f64s(a[m], b[m], c[m]);
        }
        d
    }
}

impl Row {
    /// The six numbers of a node.
    #[inline(always)]
    pub(super) fn load(x: &[f64]) -> Self {
        let x = &x[..N];
        row_of(|i| x[i])
    }

    /// `self += a row`.
    #[inline(always)]
    pub(super) fn add<L: Lanes>(&mut self, l: L, a: f64, row: &Self) {
        *self = l.store(l.multiply_add(l.splat(a), l.load(row), l.load(self)));
    }

    /// `self += a * b`, number by number.
    #[inline(always)]
    pub(super) fn add_products<L: Lanes>(&mut self, l: L, a: &Self, b: &Self) {
        *self = l.store(l.multiply_add(l.load(a), l.load(b), l.load(self)));
    }

    /// `self - other`.
    #[inline(always)]
    pub(super) fn minus<L: Lanes>(&self, l: L, other: &Self) -> Self {
        l.store(l.subtract(l.load(self), l.load(other)))
    }

    /// Sum of all numbers.
    #[inline(always)]
    pub(super) fn sum(&self) -> f64 {
        let r = &self.0;
        ((r[0] + r[1]) + (r[2] + r[3])) + (r[4] + r[5])
    }
}

/// `sum_i x_i rows_i`, in registers.
#[inline(always)]
fn combined<L: Lanes>(l: L, rows: &Block, x: impl Fn(usize) -> f64) -> L::V {
    // Two sums at a time halve the latency of the recurrences.
    let mut even = l.multiply(l.splat(x(0)), l.load(&rows[0]));
    let mut odd = l.multiply(l.splat(x(1)), l.load(&rows[1]));
    even = l.multiply_add(l.splat(x(2)), l.load(&rows[2]), even);
    odd = l.multiply_add(l.splat(x(3)), l.load(&rows[3]), odd);
    even = l.multiply_add(l.splat(x(4)), l.load(&rows[4]), even);
    odd = l.multiply_add(l.splat(x(5)), l.load(&rows[5]), odd);
    l.multiply_add(l.splat(1.0), even, odd)
}

/// `sum_i x_i rows_i`: the product of the transposed block with x.
#[inline(always)]
pub(super) fn combine<L: Lanes>(l: L, rows: &Block, x: &Row) -> Row {
    l.store(combined(l, rows, |i| x.0[i]))
}

/// `rows x`: slower than [`combine`] by the sums along rows.
#[inline(always)]
pub(super) fn multiply<L: Lanes>(l: L, rows: &Block, x: &Row) -> Row {
    let x = l.load(x);
    let mut products = ZERO;
    for i in 0..N {
        products[i] = l.store(l.multiply(l.load(&rows[i]), x));
    }
    row_of(|i| products[i].sum())
}

/// `a b`.
#[inline(always)]
pub(super) fn product<L: Lanes>(l: L, a: &Block, b: &Block) -> Block {
    let mut c = ZERO;
    for i in 0..N {
        c[i] = l.store(combined(l, b, |j| a[i].0[j]));
    }
    c
}

/// `a^T b`.
#[inline(always)]
pub(super) fn transposed_product<L: Lanes>(l: L, a: &Block, b: &Block) -> Block {
    let mut c = ZERO;
    for i in 0..N {
        c[i] = l.store(combined(l, b, |j| a[j].0[i]));
    }
    c
}

/// `c - a^T b`.
#[inline(always)]
pub(super) fn minus_transposed_product<L: Lanes>(l: L, c: &Block, a: &Block, b: &Block) -> Block {
    let mut difference = ZERO;
    for i in 0..N {
        let ab = combined(l, b, |j| a[j].0[i]);
        difference[i] = l.store(l.subtract(l.load(&c[i]), ab));
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

/// One in lane k, zero elsewhere, and the opposite.
const fn unit(k: usize, one: f64, zero: f64) -> Row {
    let mut row = [zero; 8];
    row[k] = one;
    Row(row)
}

/// Sweeps row K: afterwards its column holds that of the inverse so far. Returns whether the pivot was safe.
#[inline(always)]
fn sweep<L: Lanes, const K: usize>(l: L, a: &mut [L::V; N], block: &Block) -> bool {
    let pivot_row = l.store(a[K]);
    let pivot = pivot_row.0[K];
    let safe = pivot.abs() > SAFE_PIVOT * block[K].0[K].abs();
    let others = l.load(&const { unit(K, 0.0, 1.0) });
    let itself = l.load(&const { unit(K, 1.0, 0.0) });
    let row = l.multiply(l.splat(1.0 / pivot), l.multiply_add(a[K], others, itself));
    for i in 0..N {
        if i != K {
            let factor = l.store(a[i]).0[K];
            a[i] = l.multiply_add(l.splat(-factor), row, l.multiply(a[i], others));
        }
    }
    a[K] = row;
    safe
}

/// The inverse by sweeps without pivoting, and whether all pivots were safe.
///
/// Sweeps are as stable as a Cholesky factorisation where the block is definite, however stiff it is; cofactors are
/// not.
#[inline(always)]
pub(super) fn invert<L: Lanes>(l: L, block: &Block) -> (Block, bool) {
    let mut a = [l.splat(0.0); N];
    for i in 0..N {
        a[i] = l.load(&block[i]);
    }
    let mut safe = sweep::<L, 0>(l, &mut a, block);
    safe &= sweep::<L, 1>(l, &mut a, block);
    safe &= sweep::<L, 2>(l, &mut a, block);
    safe &= sweep::<L, 3>(l, &mut a, block);
    safe &= sweep::<L, 4>(l, &mut a, block);
    safe &= sweep::<L, 5>(l, &mut a, block);
    let mut inverse = ZERO;
    for i in 0..N {
        inverse[i] = l.store(a[i]);
    }
    (inverse, safe)
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
                a[i].add(PLAIN, -factor, &row);
                inverse[i].add(PLAIN, -factor, &inverse_row);
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
    // One by one: an array of three would be cleared by a call.
    let (mut own, mut coupling, mut next) = (ZERO, ZERO, ZERO);
    for i in 0..N {
        own[i] = row_of(|j| diagonal[i].0[j] + entry(here + i, here + j));
        coupling[i] = row_of(|j| entry(here + i, there + j));
        next[i] = row_of(|j| entry(there + i, there + j));
    }
    [own, coupling, next]
}
