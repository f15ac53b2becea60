//! Factors by faer, sequential inside: the same bits for any number of threads.

use super::pattern::Pattern;
use super::single::Single;
use faer::dyn_stack::{MemBuffer, MemStack, StackReq};
use faer::linalg::cholesky::ldlt::factor::LdltRegularization;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, LdltRef, SymbolicCholesky, SymbolicCholeskyRaw, SymmetricOrdering,
    factorize_symbolic_cholesky,
};
use faer::sparse::linalg::lu::{
    LuRef, LuSymbolicParams, NumericLu, SymbolicLu, factorize_symbolic_lu,
};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Conj, MatMut, Par, Side, Spec};

/// Marks a failed factorisation; the caller finds out why.
#[derive(Debug)]
pub(super) struct Failed;

pub(super) fn symbolic(pattern: &Pattern) -> SymbolicSparseColMatRef<'_, u32> {
    let n = pattern.size();
    SymbolicSparseColMatRef::new_checked(n, n, &pattern.starts, None, &pattern.rows)
}

/// LDL^T of a symmetric matrix whose upper triangle is stored, without pivoting.
pub(super) struct Ldlt {
    symbolic: SymbolicCholesky<u32>,
    values: Vec<f64>,
    memory: MemBuffer,
    /// Of large factors.
    single: Option<Single>,
}

/// Number of entries from which factors are kept in single precision, too: they leave the cache of one core.
pub(super) const LARGE: usize = 1 << 18;

impl Ldlt {
    pub(super) fn new(pattern: &Pattern) -> Result<Self, Failed> {
        let factors = factorize_symbolic_cholesky(
            symbolic(pattern),
            Side::Upper,
            SymmetricOrdering::Amd,
            CholeskySymbolicParams::default(),
        )
        .map_err(|_| Failed)?;
        let memory = MemBuffer::try_new(StackReq::any_of(&[
            factors.factorize_numeric_ldlt_scratch::<f64>(Par::Seq, Spec::default()),
            factors.solve_in_place_scratch::<f64>(1, Par::Seq),
        ]))
        .map_err(|_| Failed)?;
        let single = match factors.raw() {
            SymbolicCholeskyRaw::Supernodal(raw) if raw.len_val() >= LARGE => {
                Some(Single::new(raw))
            }
            _ => None,
        };
        Ok(Self { values: vec![0.0; factors.len_val()], symbolic: factors, memory, single })
    }

    pub(super) fn factor(&mut self, pattern: &Pattern, matrix: &[f64]) -> Result<(), Failed> {
        self.symbolic
            .factorize_numeric_ldlt(
                &mut self.values,
                SparseColMatRef::new(symbolic(pattern), matrix),
                Side::Upper,
                LdltRegularization::default(),
                Par::Seq,
                MemStack::new(&mut self.memory),
                Spec::default(),
            )
            .map(|_| ())
            .map_err(|_| Failed)
    }

    pub(super) fn solve(&mut self, x: &mut [f64]) {
        let n = x.len();
        LdltRef::new(&self.symbolic, &self.values).solve_in_place_with_conj(
            Conj::No,
            MatMut::from_column_major_slice_mut(x, n, 1),
            Par::Seq,
            MemStack::new(&mut self.memory),
        );
    }

    /// Copies large factors to single precision; returns whether they are large.
    pub(super) fn copy_single(&mut self) -> bool {
        let Self { symbolic, values, single, .. } = self;
        match (symbolic.raw(), single) {
            (SymbolicCholeskyRaw::Supernodal(raw), Some(single)) => {
                single.copy(raw, values);
                true
            }
            _ => false,
        }
    }

    /// Solves with the copy.
    pub(super) fn solve_single(&mut self, x: &mut [f64]) {
        let Self { symbolic, single, .. } = self;
        if let (SymbolicCholeskyRaw::Supernodal(raw), Some(single), Some(order)) =
            (symbolic.raw(), single, symbolic.perm())
        {
            single.solve(raw, order.arrays().0, x);
        }
    }

    /// Number of negative pivots: that of negative eigenvalues (Sylvester's law of inertia).
    pub(super) fn negative_pivots(&self) -> usize {
        match self.symbolic.raw() {
            SymbolicCholeskyRaw::Simplicial(factors) => {
                let starts = factors.col_ptr();
                let first = starts[..factors.ncols()].iter();
                first.filter(|&&k| self.values[k as usize] < 0.0).count()
            }
            SymbolicCholeskyRaw::Supernodal(factors) => (0..factors.n_supernodes())
                .map(|s| {
                    let columns = factors.supernode_end()[s] - factors.supernode_begin()[s];
                    let rows = (columns + factors.nnz_per_super()[s]) as usize;
                    let block = &self.values[factors.col_ptr_for_val()[s] as usize..];
                    (0..columns as usize).filter(|j| block[j * (rows + 1)] < 0.0).count()
                })
                .sum(),
        }
    }

    /// Number of stored entries, and whether columns are treated in blocks.
    pub(super) fn size(&self) -> (usize, bool) {
        let blocked = matches!(self.symbolic.raw(), SymbolicCholeskyRaw::Supernodal(_));
        (self.values.len(), blocked)
    }
}

/// LU with partial pivoting of a matrix stored completely.
pub(super) struct Lu {
    symbolic: SymbolicLu<u32>,
    numeric: NumericLu<u32, f64>,
    memory: MemBuffer,
    factored: bool,
}

impl Lu {
    pub(super) fn new(pattern: &Pattern) -> Result<Self, Failed> {
        let factors = factorize_symbolic_lu(symbolic(pattern), LuSymbolicParams::default())
            .map_err(|_| Failed)?;
        let memory = MemBuffer::try_new(StackReq::any_of(&[
            factors.factorize_numeric_lu_scratch::<f64>(Par::Seq, Spec::default()),
            factors.solve_in_place_scratch::<f64>(1, Par::Seq),
            factors.solve_transpose_in_place_scratch::<f64>(1, Par::Seq),
        ]))
        .map_err(|_| Failed)?;
        Ok(Self { symbolic: factors, numeric: NumericLu::new(), memory, factored: false })
    }

    pub(super) fn factor(&mut self, pattern: &Pattern, matrix: &[f64]) -> Result<(), Failed> {
        self.factored = self
            .symbolic
            .factorize_numeric_lu(
                &mut self.numeric,
                SparseColMatRef::new(symbolic(pattern), matrix),
                Par::Seq,
                MemStack::new(&mut self.memory),
                Spec::default(),
            )
            .is_ok();
        if self.factored { Ok(()) } else { Err(Failed) }
    }

    /// Does nothing before a successful [`Self::factor`].
    pub(super) fn solve(&mut self, x: &mut [f64], transposed: bool) {
        if !self.factored {
            return;
        }
        let n = x.len();
        let factors = LuRef::new_unchecked(&self.symbolic, &self.numeric);
        let x = MatMut::from_column_major_slice_mut(x, n, 1);
        let stack = MemStack::new(&mut self.memory);
        if transposed {
            factors.solve_transpose_in_place_with_conj(Conj::No, x, Par::Seq, stack);
        } else {
            factors.solve_in_place_with_conj(Conj::No, x, Par::Seq, stack);
        }
    }
}
