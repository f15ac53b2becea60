//! Differential-algebraic equations on slices: time integration, statics, modes, and the linear algebra under them.
//!
//! This crate knows no mechanics beyond `M a + f + phi_q^T lambda_ = 0`, `phi = 0` (see [`problem::Problem`]).

mod dense;
pub mod linear_solver;
pub mod problem;
mod sparse;
pub mod structure;
