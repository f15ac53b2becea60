//! Pressure on faces of a surface, along the normal of the vertex order; one part of the stiffness for each face.
//!
//! Where the faces are closed or their rim is held, the sum of the faces' tangents is symmetric, and the symmetric part
//! of each is all that counts: p V is a potential.

use super::Load;
use crate::point::Support;
use crate::signal::Moment;
use pliant_dae::structure::Storage;
use pliant_elements::SurfaceBlock;
use std::sync::Arc;

/// A face under pressure.
#[derive(Clone, Debug)]
pub struct Face {
    /// Its block.
    pub block: Arc<SurfaceBlock>,
    /// Its number there.
    pub element: usize,
}

/// A pressure [Pa].
#[derive(Clone, Debug)]
pub struct Pressure {
    faces: Vec<Face>,
    supports: Vec<Support>,
    conservative: bool,
}

impl Pressure {
    /// Pressure on faces with their supports, in the order of their nodal vectors.
    #[must_use]
    pub fn new(parts: Vec<(Face, Support)>, conservative: bool) -> Self {
        let (faces, supports) = parts.into_iter().unzip();
        Self { faces, supports, conservative }
    }
}

impl Load for Pressure {
    fn add_force(
        &self,
        _now: Moment<'_>,
        value: [f64; 3],
        q: &[f64],
        factor: f64,
        force: &mut [f64],
    ) {
        for (face, support) in self.faces.iter().zip(&self.supports) {
            let unit = face.block.pressure_force(face.element, q);
            for (&u, f) in support.unknowns.iter().zip(unit) {
                force[u] += factor * value[0] * f;
            }
        }
    }

    fn supports(&self) -> &[Support] {
        &self.supports
    }

    fn storage(&self) -> Storage {
        if self.conservative { Storage::Symmetric } else { Storage::Full }
    }

    fn has_potential(&self) -> bool {
        self.conservative
    }

    fn jacobian(&self, part: usize, value: [f64; 3], q: &[f64], factor: f64, out: &mut [f64]) {
        out.fill(0.0);
        let Face { block, element } = &self.faces[part];
        block.add_pressure_jacobian(*element, q, factor * value[0], out);
    }
}
