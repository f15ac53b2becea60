//! LU of matrices that are unsymmetric on a symmetric pattern, by fronts (Duff and Reid 1984) in the order and the
//! blocks of a Cholesky factorisation.
//!
//! Rigid bodies and friction disturb the symmetry of numbers, never that of the pattern. Rows are exchanged within
//! the columns of a block only: the factors fill in as those of LDL^T do, where orders that are safe for all
//! exchanges of rows fill in far more. Whether the pivots found were good enough is for
//! the caller's probe to tell.

use super::factors::{Failed, LARGE, symbolic};
use super::kernels::{Number, TOGETHER, copy_single, forward, product, products};
use super::pattern::Pattern;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::lu::partial_pivoting::factor::{lu_in_place, lu_in_place_scratch};
use faer::linalg::matmul::matmul;
use faer::linalg::triangular_solve::{
    solve_lower_triangular_in_place, solve_unit_lower_triangular_in_place,
};
use faer::prelude::{IntoConst, ReborrowMut};
use faer::sparse::linalg::SupernodalThreshold;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, SymbolicCholeskyRaw, SymmetricOrdering, factorize_symbolic_cholesky,
};
use faer::{Accum, MatMut, Par, Side, Spec};
use pulp::{Arch, Simd, WithSimd};
use std::ops::Range;

/// Consecutive columns that are eliminated together.
#[derive(Clone, Debug, Default)]
struct Block {
    first: usize,
    columns: usize,
    /// Its unknowns below the diagonal block, in `rows`.
    below: Range<usize>,
    /// First of its factors: L and the diagonal block by columns, then the transpose of what is right of the block.
    factors: usize,
    /// Where its update goes, and where it is summed up: above those of its children.
    update: usize,
    front: usize,
    /// Blocks whose updates it takes up.
    children: Vec<u32>,
}

impl Block {
    fn height(&self) -> usize {
        self.columns + self.below.len()
    }

    /// The block's part of L, that of U, and nothing else.
    fn split<'a>(&self, factors: &'a mut [f64]) -> (&'a mut [f64], &'a mut [f64]) {
        let lower = self.height() * self.columns;
        factors[self.factors..self.factors + lower + self.below.len() * self.columns]
            .split_at_mut(lower)
    }

    fn parts<'a, T>(&self, factors: &'a [T]) -> (&'a [T], &'a [T]) {
        let lower = self.height() * self.columns;
        factors[self.factors..self.factors + lower + self.below.len() * self.columns]
            .split_at(lower)
    }
}

/// The factors, and what is known of them before the numbers.
pub(super) struct Fronts {
    /// Unknowns in the order of elimination.
    order: Vec<u32>,
    /// After their children.
    blocks: Vec<Block>,
    /// Unknowns, counted in the order of elimination, ascending within a block.
    rows: Vec<u32>,
    /// Places of `rows` in the front that takes up the block's update.
    places: Vec<u32>,
    /// From an entry of the matrix to one of the factors.
    moves: Vec<(u32, u32)>,
    factors: Vec<f64>,
    /// A copy of large factors, for corrections.
    single: Vec<f32>,
    /// Reciprocals of the diagonal of U.
    reciprocals: Vec<f64>,
    updates: Vec<f64>,
    /// Row exchanged into each row of a block, counted from its first.
    pivots: Vec<u32>,
    inverse: Vec<u32>,
    memory: MemBuffer,
    scratch: Vec<f64>,
    x: Vec<f64>,
}

impl Fronts {
    /// Analyses a pattern stored completely.
    pub(super) fn new(pattern: &Pattern) -> Result<Self, Failed> {
        let n = pattern.size();
        let parameters = CholeskySymbolicParams {
            supernodal_flop_ratio_threshold: SupernodalThreshold::FORCE_SUPERNODAL,
            ..CholeskySymbolicParams::default()
        };
        let upper = pattern.upper_part();
        let analysis = factorize_symbolic_cholesky(
            symbolic(&upper),
            Side::Upper,
            SymmetricOrdering::Amd,
            parameters,
        )
        .map_err(|_| Failed)?;
        let SymbolicCholeskyRaw::Supernodal(tree) = analysis.raw() else { return Err(Failed) };
        let order = analysis.perm().ok_or(Failed)?.arrays().0.to_vec();
        let count = tree.n_supernodes();
        let mut rows = Vec::with_capacity(tree.row_idx().len());
        let mut block_of = vec![0_u32; n];
        let mut blocks = Vec::with_capacity(count);
        for s in 0..count {
            let first = tree.supernode_begin()[s] as usize;
            let end = tree.supernode_end()[s] as usize;
            block_of[first..end].fill(s as u32);
            let start = tree.col_ptr_for_row_idx()[s] as usize;
            let below = &tree.row_idx()[start..start + tree.nnz_per_super()[s] as usize];
            let from = rows.len();
            rows.extend_from_slice(below);
            rows[from..].sort_unstable();
            let below = from..rows.len();
            blocks.push(Block { first, columns: end - first, below, ..Block::default() });
        }
        let mut roots = Vec::new();
        for s in 0..count {
            match rows[blocks[s].below.clone()].first() {
                Some(&row) => blocks[block_of[row as usize] as usize].children.push(s as u32),
                None => roots.push(s as u32),
            }
        }
        let places = places(&blocks, &rows, &block_of);
        let visits = visits(&blocks, &roots);
        let (height, factors) = lay_out(&mut blocks, &visits);
        if factors > u32::MAX as usize {
            return Err(Failed);
        }
        let moves = moves(pattern, &order, &blocks, &rows, &block_of);
        let mut position = vec![0; count];
        for (k, &s) in visits.iter().enumerate() {
            position[s as usize] = k as u32;
        }
        let mut blocks: Vec<Block> =
            visits.iter().map(|&s| std::mem::take(&mut blocks[s as usize])).collect();
        for child in blocks.iter_mut().flat_map(|block| &mut block.children) {
            *child = position[*child as usize];
        }
        let widest = blocks.iter().map(|b| b.columns).max().unwrap_or(0);
        let largest = blocks.iter().map(|b| b.height().max(b.below.len() * b.columns)).max();
        let pivoting = lu_in_place_scratch::<u32, f64>(widest, widest, Par::Seq, Spec::default());
        Ok(Self {
            order,
            blocks,
            rows,
            places,
            moves,
            factors: vec![0.0; factors],
            single: vec![0.0; if factors >= LARGE { factors } else { 0 }],
            reciprocals: vec![0.0; n],
            updates: vec![0.0; height],
            pivots: vec![0; n],
            inverse: vec![0; widest],
            memory: MemBuffer::try_new(pivoting).map_err(|_| Failed)?,
            scratch: vec![0.0; largest.unwrap_or(0)],
            x: vec![0.0; n],
        })
    }

    /// Number of stored entries.
    pub(super) fn size(&self) -> usize {
        self.factors.len()
    }

    pub(super) fn factor(&mut self, matrix: &[f64]) -> Result<(), Failed> {
        self.factors.fill(0.0);
        for &(from, to) in &self.moves {
            self.factors[to as usize] = matrix[from as usize];
        }
        for s in 0..self.blocks.len() {
            self.take_up(s);
            self.eliminate(s)?;
        }
        Ok(())
    }

    /// Adds the updates of its children to a front.
    fn take_up(&mut self, s: usize) {
        let Self { blocks, places, factors, updates, .. } = self;
        let block = &blocks[s];
        if block.children.is_empty() {
            return;
        }
        let (c, b, height) = (block.columns, block.below.len(), block.height());
        let (lower, upper) = block.split(factors);
        let (children, front) = updates.split_at_mut(block.front);
        let front = &mut front[..b * b];
        front.fill(0.0);
        for &child in &block.children {
            let child = &blocks[child as usize];
            let to = &places[child.below.clone()];
            let inside = to.partition_point(|&i| (i as usize) < c);
            let size = to.len();
            for (j, &column) in to.iter().enumerate() {
                let from = &children[child.update + j * size..child.update + (j + 1) * size];
                let column = column as usize;
                if j < inside {
                    let target = &mut lower[column * height..(column + 1) * height];
                    for (&i, &value) in to.iter().zip(from) {
                        target[i as usize] += value;
                    }
                    continue;
                }
                let beyond = column - c;
                for (&i, &value) in to[..inside].iter().zip(from) {
                    upper[beyond + i as usize * b] += value;
                }
                let target = &mut front[beyond * b..(beyond + 1) * b];
                for (&i, &value) in to[inside..].iter().zip(&from[inside..]) {
                    target[i as usize - c] += value;
                }
            }
        }
    }

    /// Eliminates the columns of a block from its front, and leaves its update to its parent.
    fn eliminate(&mut self, s: usize) -> Result<(), Failed> {
        let Self {
            blocks, factors, reciprocals, updates, pivots, inverse, memory, scratch, ..
        } = self;
        let block = &blocks[s];
        let (c, b, height) = (block.columns, block.below.len(), block.height());
        let (lower, upper) = block.split(factors);
        let (mut pivot_block, mut lower) =
            MatMut::from_column_major_slice_mut(lower, height, c).split_at_row_mut(c);
        let exchange = &mut pivots[block.first..block.first + c];
        lu_in_place(
            pivot_block.rb_mut(),
            exchange,
            &mut inverse[..c],
            Par::Seq,
            MemStack::new(memory),
            Spec::default(),
        );
        let pivot_block = pivot_block.into_const();
        // Not `== 0`: what is not a number has failed, too.
        if !(0..c).all(|j| pivot_block[(j, j)].abs() > f64::MIN_POSITIVE) {
            return Err(Failed);
        }
        for j in 0..c {
            reciprocals[block.first + j] = 1.0 / pivot_block[(j, j)];
        }
        if b == 0 {
            return Ok(());
        }
        if exchange.iter().enumerate().any(|(i, &p)| p as usize != i) {
            let old = &mut scratch[..b * c];
            old.copy_from_slice(upper);
            for (column, &p) in upper.chunks_exact_mut(b).zip(exchange.iter()) {
                column.copy_from_slice(&old[p as usize * b..(p as usize + 1) * b]);
            }
        }
        // Transposes: L21 U11 = A21 and L11 U12 = A12.
        solve_lower_triangular_in_place(
            pivot_block.transpose(),
            lower.rb_mut().transpose_mut(),
            Par::Seq,
        );
        let mut upper = MatMut::from_column_major_slice_mut(upper, b, c);
        solve_unit_lower_triangular_in_place(pivot_block, upper.rb_mut().transpose_mut(), Par::Seq);
        let summed = if block.children.is_empty() { Accum::Replace } else { Accum::Add };
        let front = &mut updates[block.front..block.front + b * b];
        let upper = upper.into_const().transpose();
        let lower = lower.into_const();
        let front = MatMut::from_column_major_slice_mut(front, b, b);
        matmul(front, summed, lower, upper, -1.0, Par::Seq);
        updates.copy_within(block.front..block.front + b * b, block.update);
        Ok(())
    }

    /// Copies large factors to single precision; returns whether they are large.
    pub(super) fn copy_single(&mut self) -> bool {
        if !self.single.is_empty() {
            copy_single(&self.factors, &mut self.single);
        }
        !self.single.is_empty()
    }

    /// Overwrites the right-hand side by the solution, of the transposed system where asked for.
    pub(super) fn solve(&mut self, b: &mut [f64], transposed: bool) {
        self.permute(b);
        if transposed {
            (0..self.blocks.len()).for_each(|s| self.forward_transposed(s));
            (0..self.blocks.len()).rev().for_each(|s| self.backward_transposed(s));
        } else {
            let Self { blocks, rows, factors, reciprocals, pivots, scratch, x, .. } = self;
            let sweeps = Sweeps { blocks, rows, factors, reciprocals, pivots, scratch, x };
            Arch::new().dispatch(sweeps);
        }
        self.permute_back(b);
    }

    /// The same with the copy in single precision.
    pub(super) fn solve_single(&mut self, b: &mut [f64]) {
        self.permute(b);
        let Self { blocks, rows, single, reciprocals, pivots, scratch, x, .. } = self;
        let sweeps = Sweeps { blocks, rows, factors: single, reciprocals, pivots, scratch, x };
        Arch::new().dispatch(sweeps);
        self.permute_back(b);
    }

    fn permute(&mut self, b: &[f64]) {
        for (x, &i) in self.x.iter_mut().zip(&self.order) {
            *x = b[i as usize];
        }
    }

    fn permute_back(&self, b: &mut [f64]) {
        for (x, &i) in self.x.iter().zip(&self.order) {
            b[i as usize] = *x;
        }
    }

    /// `[y; rest] <- [U11^-T b; rest - U12^T y]`.
    fn forward_transposed(&mut self, s: usize) {
        let Self { blocks, rows, factors, reciprocals, scratch, x, .. } = self;
        let block = &blocks[s];
        let (c, b, height) = (block.columns, block.below.len(), block.height());
        let own = block.first..block.first + c;
        let (lower, upper) = block.parts(factors);
        let y = &mut scratch[..height];
        y[..c].copy_from_slice(&x[own.clone()]);
        y[c..].fill(0.0);
        for j in 0..c {
            let column = &lower[j * height..j * height + j];
            y[j] = (y[j] - product(column, &y[..j])) * reciprocals[block.first + j];
            let by = y[j];
            for (y, u) in y[c..].iter_mut().zip(&upper[j * b..(j + 1) * b]) {
                *y -= by * u;
            }
        }
        x[own].copy_from_slice(&y[..c]);
        scatter(&rows[block.below.clone()], &y[c..], x);
    }

    /// `y <- P^T L11^-T (y - L21^T rest)`.
    fn backward_transposed(&mut self, s: usize) {
        let Self { blocks, rows, factors, pivots, scratch, x, .. } = self;
        let block = &blocks[s];
        let (c, height) = (block.columns, block.height());
        let own = block.first..block.first + c;
        let (lower, _) = block.parts(factors);
        let y = &mut scratch[..height];
        y[..c].copy_from_slice(&x[own.clone()]);
        gather(&rows[block.below.clone()], x, &mut y[c..]);
        for j in (0..c).rev() {
            y[j] -= product(&lower[j * height + j + 1..(j + 1) * height], &y[j + 1..]);
        }
        for (y, &p) in y[..c].iter().zip(&pivots[own]) {
            x[block.first + p as usize] = *y;
        }
    }
}

fn gather(rows: &[u32], x: &[f64], y: &mut [f64]) {
    for (y, &i) in y.iter_mut().zip(rows) {
        *y = x[i as usize];
    }
}

fn scatter(rows: &[u32], y: &[f64], x: &mut [f64]) {
    for (y, &i) in y.iter().zip(rows) {
        x[i as usize] += y;
    }
}

/// Forward and backward substitution, compiled for the vector registers of the processor at hand.
struct Sweeps<'a, T> {
    blocks: &'a [Block],
    rows: &'a [u32],
    factors: &'a [T],
    reciprocals: &'a [f64],
    pivots: &'a [u32],
    scratch: &'a mut [f64],
    x: &'a mut [f64],
}

impl<T: Number> WithSimd for Sweeps<'_, T> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(mut self, _: S) {
        for block in self.blocks {
            self.forward(block);
        }
        for block in self.blocks.iter().rev() {
            self.backward(block);
        }
    }
}

impl<T: Number> Sweeps<'_, T> {
    /// `[y; rest] <- [L11^-1 P b; rest - L21 y]`.
    #[inline(always)]
    fn forward(&mut self, block: &Block) {
        let Self { rows, factors, pivots, scratch, x, .. } = self;
        let (c, height) = (block.columns, block.height());
        let own = block.first..block.first + c;
        let y = &mut scratch[..height];
        for (y, &p) in y.iter_mut().zip(&pivots[own.clone()]) {
            *y = x[block.first + p as usize];
        }
        y[c..].fill(0.0);
        forward(block.parts(factors).0, c, y);
        x[own].copy_from_slice(&y[..c]);
        scatter(&rows[block.below.clone()], &y[c..], x);
    }

    /// `y <- U11^-1 (y - U12 rest)`.
    #[inline(always)]
    fn backward(&mut self, block: &Block) {
        let Self { rows, factors, reciprocals, scratch, x, .. } = self;
        let (c, b, height) = (block.columns, block.below.len(), block.height());
        let own = block.first..block.first + c;
        let (lower, upper) = block.parts(factors);
        let (y, rest) = scratch[..height].split_at_mut(c);
        y.copy_from_slice(&x[own.clone()]);
        gather(&rows[block.below.clone()], x, rest);
        let row = |j: usize| &upper[j * b..(j + 1) * b];
        let mut together = y.chunks_exact_mut(TOGETHER);
        let mut j = 0;
        for y in &mut together {
            let sums = products(std::array::from_fn(|k| row(j + k)), rest);
            for k in 0..TOGETHER {
                y[k] -= sums[k];
            }
            j += TOGETHER;
        }
        for y in together.into_remainder() {
            *y -= product(row(j), rest);
            j += 1;
        }
        for j in (0..c).rev() {
            y[j] *= reciprocals[block.first + j];
            let by = y[j];
            for (y, u) in y[..j].iter_mut().zip(&lower[j * height..]) {
                *y -= by * u.number();
            }
        }
        x[own].copy_from_slice(y);
    }
}

/// Places of the rows of each block in the front of its parent.
fn places(blocks: &[Block], rows: &[u32], block_of: &[u32]) -> Vec<u32> {
    let mut places = vec![0; rows.len()];
    for block in blocks {
        let below = block.below.clone();
        let Some(&first) = rows[below.clone()].first() else { continue };
        let parent = &blocks[block_of[first as usize] as usize];
        for k in below {
            places[k] = place(parent, rows, rows[k]);
        }
    }
    places
}

/// Place of an unknown in a front that has it.
fn place(block: &Block, rows: &[u32], unknown: u32) -> u32 {
    let end = block.first + block.columns;
    if (unknown as usize) < end {
        return unknown - block.first as u32;
    }
    let below = &rows[block.below.clone()];
    (block.columns + below.partition_point(|&row| row < unknown)) as u32
}

/// All blocks, each right after the trees of its children.
fn visits(blocks: &[Block], roots: &[u32]) -> Vec<u32> {
    // Parents before children, backwards.
    let mut waiting = roots.to_vec();
    let mut visits = Vec::with_capacity(blocks.len());
    while let Some(s) = waiting.pop() {
        visits.push(s);
        waiting.extend(&blocks[s as usize].children);
    }
    visits.reverse();
    visits
}

/// Gives each block its place among factors and on the stack of updates; returns the height of that, and the number
/// of all factors.
fn lay_out(blocks: &mut [Block], visits: &[u32]) -> (usize, usize) {
    let (mut top, mut highest, mut factors) = (0, 0, 0);
    for &s in visits {
        let children: usize = blocks[s as usize]
            .children
            .iter()
            .map(|&child| blocks[child as usize].below.len().pow(2))
            .sum();
        let block = &mut blocks[s as usize];
        let size = block.below.len().pow(2);
        block.front = top;
        highest = highest.max(top + size);
        block.update = top - children;
        top = block.update + size;
        block.factors = factors;
        factors += (block.height() + block.below.len()) * block.columns;
    }
    (highest, factors)
}

/// Where each entry of the matrix goes.
fn moves(
    pattern: &Pattern,
    order: &[u32],
    blocks: &[Block],
    rows: &[u32],
    block_of: &[u32],
) -> Vec<(u32, u32)> {
    let mut eliminated = vec![0_u32; order.len()];
    for (k, &i) in order.iter().enumerate() {
        eliminated[i as usize] = k as u32;
    }
    let mut moves = Vec::with_capacity(pattern.rows.len());
    for j in 0..pattern.size() {
        let column = eliminated[j];
        for k in pattern.column(j) {
            let row = eliminated[pattern.rows[k] as usize];
            let block = &blocks[block_of[row.min(column) as usize] as usize];
            let (i, j) = (place(block, rows, row) as usize, place(block, rows, column) as usize);
            let to = match j.checked_sub(block.columns) {
                None => i + j * block.height(),
                Some(beyond) => block.height() * block.columns + beyond + i * block.below.len(),
            };
            moves.push((k as u32, (block.factors + to) as u32));
        }
    }
    moves
}
