//! Access for tests to what the assembly never needs: energies and forces of single elements over dual numbers.

use pliant_math::Dual;

use crate::beam::BeamBlock;
use crate::block::CableBlock;
use crate::surface::SurfaceBlock;

/// Elastic energy of element `e` at local coordinates.
#[must_use]
pub fn energy(block: &CableBlock, e: usize, q: &[f64; 12]) -> f64 {
    block.local_energy(e, q)
}

/// Elastic energy of element `e` with its derivative along the dual parts of the local coordinates.
#[must_use]
pub fn energy_dual(block: &CableBlock, e: usize, q: &[Dual; 12]) -> Dual {
    block.local_energy(e, q)
}

/// Work on plastic flow since the state that element `e` remembers.
#[must_use]
pub fn plastic_work(block: &CableBlock, e: usize, q: &[f64; 12]) -> f64 {
    block.local_plastic_work(e, q)
}

/// The same with its derivative along the dual parts.
#[must_use]
pub fn plastic_work_dual(block: &CableBlock, e: usize, q: &[Dual; 12]) -> Dual {
    block.local_plastic_work(e, q)
}

/// Internal force of element `e` at local coordinates and velocities.
#[must_use]
pub fn force(block: &CableBlock, e: usize, q: &[f64; 12], v: &[f64; 12]) -> [f64; 12] {
    block.local_force(e, q, v)
}

/// Internal force of element `e` with its derivative along the dual parts.
#[must_use]
pub fn force_dual(block: &CableBlock, e: usize, q: &[Dual; 12], v: &[Dual; 12]) -> [Dual; 12] {
    block.local_force(e, q, v)
}

/// Elastic energy of surface element `e` at local coordinates.
#[must_use]
pub fn surface_energy(block: &SurfaceBlock, e: usize, q: &[f64]) -> f64 {
    block.local_energy(e, q)
}

/// The same with its derivative along the dual parts.
#[must_use]
pub fn surface_energy_dual(block: &SurfaceBlock, e: usize, q: &[Dual]) -> Dual {
    block.local_energy(e, q)
}

/// Inner force of surface element `e` at local coordinates and velocities.
#[must_use]
pub fn surface_force(block: &SurfaceBlock, e: usize, q: &[f64], v: &[f64]) -> Vec<f64> {
    block.local_force(e, q, v)
}

/// The same with its derivative along the dual parts.
#[must_use]
pub fn surface_force_dual(block: &SurfaceBlock, e: usize, q: &[Dual], v: &[Dual]) -> Vec<Dual> {
    block.local_force(e, q, v)
}

/// Elastic energy of beam element `e` at local coordinates.
#[must_use]
pub fn beam_energy(block: &BeamBlock, e: usize, q: &[f64; 24]) -> f64 {
    block.local_energy(e, q)
}

/// The same with its derivative along the dual parts.
#[must_use]
pub fn beam_energy_dual(block: &BeamBlock, e: usize, q: &[Dual; 24]) -> Dual {
    block.local_energy(e, q)
}

/// Inner force of beam element `e` at local coordinates and velocities.
#[must_use]
pub fn beam_force(block: &BeamBlock, e: usize, q: &[f64; 24], v: &[f64; 24]) -> [f64; 24] {
    block.local_force(e, q, v)
}

/// The same with its derivative along the dual parts.
#[must_use]
pub fn beam_force_dual(block: &BeamBlock, e: usize, q: &[Dual; 24], v: &[Dual; 24]) -> [Dual; 24] {
    block.local_force(e, q, v)
}
