//! Pure mathematics under pliant: number types, quadrature, shape functions, rotations.
//!
//! Element kernels are written once over [`Real`] and run on scalars, on vector lanes and on dual numbers.

pub mod check;
pub mod dual;
pub mod hermite;
pub mod quadrature;
pub mod real;
pub mod rotation;
pub mod vec3;

pub use dual::Dual;
pub use real::{Lanes, Real};
pub use vec3::Vec3;
