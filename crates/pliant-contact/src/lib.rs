//! Contact and friction of curves with a radius and of shapes: where they touch, and with which forces.
//!
//! Nothing here knows elements, bodies or time stepping: curves are cubic pieces given by their ends and slopes, and
//! forces come as numbers for the points in contact with their derivatives.

pub mod bore;
pub mod broad_phase;
pub mod curve;
pub mod foot;
pub mod friction;
pub mod manifolds;
pub mod meshes;
pub mod net;
pub mod normal;
pub mod point;
pub mod probe;
pub mod shapes;
pub mod touch;
pub mod zones;
