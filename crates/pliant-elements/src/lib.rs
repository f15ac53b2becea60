//! Finite elements of pliant as pure functions of nodal coordinates: energy, force, tangent, mass.
//!
//! Elements of one kind and one law form a [`Block`]: arrays of plain numbers, one dispatch per block, static code
//! inside. Time stepping, contact and joints are unknown here.

pub mod beam;
pub mod block;
pub mod element;
pub mod elements;
mod error;
mod integrals;
pub mod materials;
mod surface;
pub mod testing;

pub use beam::{BeamBlock, BeamElement, BeamLaw, BeamStrain, Locking};
pub use block::{CableBlock, PAST, Parameter};
pub use element::{Block, Momentum, Motion, Slot, Weights, Workspace};
pub use elements::cable::{
    Bending, Cable, CableElement, CableLaw, Integration, NodeOffsets, Reference, Section, Sections,
    Slack, Strain, Yielding,
};
pub use elements::surface::{Chart, Integrals, Jet, Quadrature, SURFACE_KINDS, SurfaceKind};
pub use error::ElementError;
pub use surface::{RulePoint, SurfaceBlock, SurfaceElement, SurfaceLaw};
