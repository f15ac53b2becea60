//! Models of soft machines: from a document to a system of equations, runs, and what is read from them.

mod build;
mod chambers;
pub mod checkpoint;
pub mod contact_coupling;
pub mod document;
pub mod dof_map;
pub mod error;
pub mod forces;
pub mod freedom;
pub mod jet;
pub mod joints;
pub mod latches;
pub mod loads;
pub mod memory;
pub mod model;
mod output;
pub mod point;
pub mod rigid;
pub mod run;
pub mod signal;
pub mod solve;
pub mod spec;
pub mod surface_map;
pub mod system;
pub mod teaching;
mod vector;
pub mod winch;
