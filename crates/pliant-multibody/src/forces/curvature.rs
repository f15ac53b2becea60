//! A rest curvature of a shell that changes in time: stored energy `W(E, k + kappa) - W(E, k)` on a face.
//!
//! A surface that is free takes the rest curvature `B0 + kappa`, positive towards its normal; what it gains or loses
//! where nothing moves is work.

use super::{At, Context, ForceElement, Part};
use crate::error::ModelError;
use crate::loads::pressure::Face;
use crate::point::Support;
use crate::signal::Value;
use crate::spec::ForceSpec;
use pliant_dae::structure::Storage;
use pliant_elements::SurfaceBlock;

/// Changing rest curvature of one face.
pub struct Curvature {
    /// The face alone, over its own coordinates.
    block: SurfaceBlock,
    value: Value,
    steady: bool,
    support: Support,
}

impl Curvature {
    /// One for each face.
    pub(super) fn of_spec(
        force: &ForceSpec,
        context: &Context<'_>,
    ) -> Result<Vec<Self>, ModelError> {
        let ForceSpec::Curvature { name, surface, faces, value, steady } = force else {
            return Err(super::other_kind("curvature"));
        };
        let place = format!("curvature '{name}'");
        let value = Value::new(value, &place)?;
        let each = |(Face { block, element }, support): (Face, Support)| {
            if !block.surface_kind().bends() {
                let reason = "a membrane has no curvature at rest";
                return Err(ModelError::Unsupported { place: place.clone(), reason });
            }
            let block = block.alone(element);
            Ok(Self { block, value: value.clone(), steady: *steady, support })
        };
        (context.faces)(*surface, faces, &place)?.into_iter().map(each).collect()
    }
}

impl ForceElement for Curvature {
    fn support(&self) -> &Support {
        &self.support
    }

    fn parts(&self) -> &[Part] {
        &[Part::Stored]
    }

    fn add_force(&self, part: Part, at: At<'_>, factor: f64, out: &mut [f64]) {
        if part == Part::Stored {
            let gradient = self.block.curvature_gradient(0, at.x, self.value.at(at.now));
            out.iter_mut().zip(gradient).for_each(|(out, g)| *out -= factor * g);
        }
    }

    fn add_tangent(&self, at: At<'_>, stiffness: f64, _damping: f64, out: &mut [f64]) {
        if stiffness != 0.0 {
            self.block.add_curvature_hessian(0, at.x, self.value.at(at.now), stiffness, out);
        }
    }

    fn storage(&self) -> Storage {
        Storage::Symmetric
    }

    fn energy(&self, at: At<'_>) -> f64 {
        self.block.curvature_energy(0, at.x, self.value.at(at.now))
    }

    fn is_rheonomic(&self) -> bool {
        !self.steady
    }

    fn next_break(&self, t: f64) -> Option<f64> {
        self.value.next_break(t)
    }

    fn output_count(&self) -> usize {
        0
    }

    fn outputs(&self, _at: At<'_>, _out: &mut [f64]) {}
}
