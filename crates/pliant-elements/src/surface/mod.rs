//! A block of surface elements of one kind and one law.
//!
//! Elements are lists of nodal vectors; what they are made of, rows of shape functions, lies in tables that equal
//! elements share. One kernel serves every kind (docs/theory/shell.md).

mod actuation;
mod build;
mod kernel;
mod output;
mod point;
mod precomputed;
mod pressure;
mod scalar;
mod volume;

use pulp::{Arch, Simd, WithSimd};
use rayon::prelude::*;

use crate::element::{Block, Momentum, Motion, Slot, Weights, Workspace};
use crate::elements::cable::Bending;
use crate::elements::surface::{Integrals, Quadrature, SurfaceKind};
use crate::integrals::surface::Table;
use crate::materials::{PlaneStress, SaintVenantKirchhoff};
pub use build::SurfaceElement;
pub(crate) use kernel::Scratch;
pub use pressure::RulePoint;

/// Elements per task of the parallel evaluation.
const TASK: usize = 64;

/// What the elements of a block have in common.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceLaw {
    /// Law of the material.
    pub material: PlaneStress,
    /// Retardation time of the Kelvin-Voigt law tau [s]: stress of the linear law for the strain's rate; 0: none.
    pub retardation_time: f64,
    /// Mass per volume [kg/m^3].
    pub density: f64,
    /// Quadrature of the elastic energy.
    pub quadrature: Quadrature,
    /// How the membrane's energy is integrated.
    pub integrals: Integrals,
    /// Curvature of the surface, or second derivatives of its position (flat and little strained surfaces).
    pub bending: Bending,
}

impl SurfaceLaw {
    /// Rows of shape functions at a point: second derivatives where curvature is measured.
    pub(crate) fn rows(&self, kind: SurfaceKind) -> usize {
        if kind.bends() && self.bending == Bending::Exact { 5 } else { 2 }
    }
}

/// Surface elements of one kind and one law.
#[derive(Clone, Debug)]
pub struct SurfaceBlock {
    kind: SurfaceKind,
    law: SurfaceLaw,
    /// The material for small strains.
    linear: SaintVenantKirchhoff,
    density: f64,
    tables: Vec<Table>,
    /// Table of each element.
    table_of: Vec<u32>,
    /// Thickness of each element [m].
    thickness: Vec<f64>,
    /// First coordinates of the nodal vectors, element by element.
    offsets: Vec<u32>,
    extent: usize,
}

/// Chooses the kernel for the width and the rows of a kind.
macro_rules! with_shape {
    ($block:expr, $function:ident :: <S, ..> ( $($argument:expr),* )) => {
        match ($block.rows(), $block.width()) {
            (5, 16) => $function::<S, 16, 5>($($argument),*),
            (5, _) => $function::<S, 8, 5>($($argument),*),
            (_, 16) => $function::<S, 16, 2>($($argument),*),
            (_, _) => $function::<S, 8, 2>($($argument),*),
        }
    };
}

impl SurfaceBlock {
    /// Kind of its elements.
    #[must_use]
    pub fn surface_kind(&self) -> SurfaceKind {
        self.kind
    }

    /// The law of the block.
    #[must_use]
    pub fn law(&self) -> SurfaceLaw {
        self.law
    }

    /// First coordinates of the nodal vectors of element `e`.
    #[must_use]
    pub fn vectors_of(&self, e: usize) -> &[u32] {
        let n = self.kind.vectors();
        &self.offsets[n * e..n * (e + 1)]
    }

    /// Number of nodal vectors with padding.
    fn width(&self) -> usize {
        self.kind.vectors().next_multiple_of(8)
    }

    /// Rows of shape functions at a point.
    fn rows(&self) -> usize {
        self.law.rows(self.kind)
    }

    fn entries(&self) -> usize {
        let n = 3 * self.kind.vectors();
        n * (n + 1) / 2
    }

    fn is_damped(&self) -> bool {
        self.law.retardation_time != 0.0
    }

    fn element(&self, e: usize) -> (&Table, &[u32], f64) {
        (&self.tables[self.table_of[e] as usize], self.vectors_of(e), self.thickness[e])
    }

    fn tangents(
        &self,
        motion: Motion<'_>,
        weights: Weights,
        predicted: bool,
        values: &mut [f64],
        parallel: bool,
    ) {
        let arch = Arch::new();
        let task = TASK * self.entries();
        let values = &mut values[..self.element_count() * self.entries()];
        let part = |first, values: &mut [f64]| {
            arch.dispatch(Tangent { block: self, motion, weights, predicted, first, values });
        };
        if parallel && self.element_count() > TASK {
            let parts = values.par_chunks_mut(task).enumerate();
            parts.for_each(|(k, values)| part(k * TASK, values));
        } else {
            part(0, values);
        }
    }

    /// Numbers of the nodal vectors that are positions.
    fn positions(&self) -> std::iter::StepBy<std::ops::Range<usize>> {
        (0..self.kind.vectors()).step_by(self.kind.vectors_per_node())
    }
}

/// Where forces go.
enum Forces<'a> {
    /// Added to the global vector.
    Global(&'a mut [f64]),
    /// Written element by element.
    Buffer(&'a mut [f64]),
}

struct Residual<'a> {
    block: &'a SurfaceBlock,
    motion: Motion<'a>,
    gravity: [f64; 3],
    elements: std::ops::Range<usize>,
    scratch: &'a mut Scratch,
    forces: Forces<'a>,
}

impl WithSimd for Residual<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        with_shape!(self.block, residuals::<S, ..>(simd, self));
    }
}

#[inline(always)]
fn residuals<S: Simd, const W: usize, const R: usize>(simd: S, task: Residual<'_>) {
    let Residual { block, motion, gravity, elements, scratch, mut forces } = task;
    let first = elements.start;
    let n = block.kind.vectors();
    for e in elements {
        let f = kernel::residual::<S, W, R>(simd, block, e, motion, gravity, scratch);
        match &mut forces {
            Forces::Global(force) => {
                for (i, &offset) in block.vectors_of(e).iter().enumerate().take(W) {
                    for c in 0..3 {
                        force[offset as usize + c] += f[c][i];
                    }
                }
            }
            Forces::Buffer(buffer) => {
                let to = &mut buffer[3 * n * (e - first)..3 * n * (e - first + 1)];
                for i in 0..n.min(W) {
                    for c in 0..3 {
                        to[3 * i + c] = f[c][i];
                    }
                }
            }
        }
    }
}

struct Tangent<'a> {
    block: &'a SurfaceBlock,
    motion: Motion<'a>,
    weights: Weights,
    /// Whether the motion's velocities are an increment, and forces are predicted by it.
    predicted: bool,
    first: usize,
    values: &'a mut [f64],
}

impl WithSimd for Tangent<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        with_shape!(self.block, tangents::<S, ..>(simd, self));
    }
}

#[inline(always)]
fn tangents<S: Simd, const W: usize, const R: usize>(simd: S, task: Tangent<'_>) {
    let Tangent { block, motion, weights, predicted, first, values } = task;
    let mut scratch = Box::<Scratch>::default();
    for (k, out) in values.chunks_exact_mut(block.entries()).enumerate() {
        let e = first + k;
        kernel::tangent::<S, W, R>(simd, block, e, motion, weights, predicted, &mut scratch, out);
    }
}

impl Block for SurfaceBlock {
    fn kind(&self) -> &'static str {
        self.kind.name()
    }

    fn element_count(&self) -> usize {
        self.table_of.len()
    }

    fn extent(&self) -> usize {
        self.extent
    }

    fn has_damping(&self) -> bool {
        self.is_damped()
    }

    fn residual(
        &self,
        motion: Motion<'_>,
        gravity: [f64; 3],
        workspace: &mut Workspace,
        force: &mut [f64],
        parallel: bool,
    ) {
        let count = self.element_count();
        let arch = Arch::new();
        if !parallel || count <= TASK {
            let scratch = &mut **workspace.surface.get_or_insert_default();
            let (elements, forces) = (0..count, Forces::Global(force));
            arch.dispatch(Residual { block: self, motion, gravity, elements, scratch, forces });
            return;
        }
        let size = 3 * self.kind.vectors();
        workspace.sums.resize(count * size, 0.0);
        let sums = &mut workspace.sums[..count * size];
        sums.par_chunks_mut(TASK * size).enumerate().for_each_init(
            Box::<Scratch>::default,
            |scratch, (task, buffer)| {
                let elements = task * TASK..task * TASK + buffer.len() / size;
                let forces = Forces::Buffer(buffer);
                arch.dispatch(Residual { block: self, motion, gravity, elements, scratch, forces });
            },
        );
        for (offset, f) in self.offsets.iter().zip(sums.chunks_exact(3)) {
            for c in 0..3 {
                force[*offset as usize + c] += f[c];
            }
        }
    }

    fn values_len(&self) -> usize {
        self.element_count() * self.entries()
    }

    fn tangent(&self, motion: Motion<'_>, weights: Weights, values: &mut [f64], parallel: bool) {
        self.tangents(motion, weights, false, values, parallel);
    }

    fn predicts(&self) -> bool {
        true
    }

    fn predicted_tangent(
        &self,
        motion: Motion<'_>,
        weights: Weights,
        values: &mut [f64],
        parallel: bool,
    ) {
        self.tangents(motion, weights, true, values, parallel);
    }

    fn slot_of(&self, e: usize) -> Slot {
        Slot { base: e * self.entries(), stride: 1 }
    }

    fn elastic_energy(&self, q: &[f64]) -> f64 {
        (0..self.element_count()).map(|e| self.element_elastic_energy(e, q)).sum()
    }

    fn kinetic_energy(&self, v: &[f64]) -> f64 {
        self.total_kinetic_energy(v)
    }

    fn dissipation(&self, q: &[f64], v: &[f64]) -> f64 {
        self.total_dissipation(q, v)
    }

    fn momentum(&self, q: &[f64], v: &[f64]) -> Momentum {
        self.total_momentum(q, v)
    }

    fn mass(&self) -> f64 {
        (0..self.element_count()).map(|e| self.element_mass(e)).sum()
    }

    fn first_moment(&self, q: &[f64]) -> [f64; 3] {
        self.total_first_moment(q)
    }
}
