//! Finite elements of pliant as pure functions of nodal coordinates: energy, force, tangent, mass.
//!
//! Elements of one kind and one law form a [`Block`]: arrays of plain numbers, one dispatch per block, static code
//! inside. Time stepping, contact and joints are unknown here.

pub mod block;
pub mod element;
pub mod elements;
mod error;
mod integrals;
pub mod testing;

pub use block::{CableBlock, Parameter};
pub use element::{Block, Momentum, Motion, Slot, Weights, Workspace};
pub use elements::cable::{
    Bending, Cable, CableElement, CableLaw, Integration, NodeOffsets, Reference, Section, Sections,
    Slack, Strain,
};
pub use error::ElementError;
