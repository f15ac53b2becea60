//! Differential-algebraic equations on slices: time integration, statics, modes, and the linear algebra under them.
//!
//! This crate knows no mechanics beyond `M a + f + phi_q^T lambda_ = 0`, `phi = 0` (see [`problem::Problem`]).

pub mod coefficients;
mod compliance;
mod condensation;
mod dense;
pub mod error;
pub mod generalized_alpha;
pub mod initial;
mod integrator;
pub mod linear_solver;
pub mod modes;
pub mod newton;
mod passes;
pub mod problem;
pub mod redundancy;
mod scaling;
pub mod sensitivity;
mod sparse;
mod state;
pub mod statics;
pub mod statistics;
mod step_change;
pub mod step_control;
pub mod structure;
