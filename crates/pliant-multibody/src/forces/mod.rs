//! Forces that depend on positions and velocities: springs and what acts along joints. One file a kind; this is their
//! registry. Forces given over time, with at most a direction that turns, are [`crate::loads`].

pub mod curvature;
pub mod joint;
pub mod sheet_wind;
pub mod spring;
pub mod tendon;
pub mod wind;

use crate::dof_map::DofMap;
use crate::error::ModelError;
use crate::loads::pressure::Face;
use crate::model::PlacedFreedom;
use crate::point::{Interpolation, Support};
use crate::signal::Moment;
use crate::spec::{Array, ForceSpec};
use nalgebra::Matrix3;
use pliant_dae::structure::Storage;

/// What becomes of the energy that a force takes from the motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// It is stored: minus the derivative of [`ForceElement::energy`] by the coordinates.
    Stored,
    /// It is lost: `energy.dissipated` gathers it.
    Dissipated,
    /// It comes from outside: `energy.work` gathers what the force gives.
    Work,
}

/// Where a force is evaluated, in the coordinates of its support.
#[derive(Clone, Copy, Debug)]
pub struct At<'a> {
    /// Time and inputs, for signals.
    pub now: Moment<'a>,
    /// Coordinates.
    pub x: &'a [f64],
    /// Velocities.
    pub v: &'a [f64],
}

/// A force between parts of the model. Coordinates and velocities reach it as local vectors, the unknowns of its
/// [`Support`].
pub trait ForceElement: Send + Sync {
    /// The coordinates it acts on and depends on.
    fn support(&self) -> &Support;

    /// The parts it has: [`Self::add_force`] is asked for these.
    fn parts(&self) -> &[Part];

    /// Adds `factor` times one part of the generalized force.
    fn add_force(&self, part: Part, at: At<'_>, factor: f64, out: &mut [f64]);

    /// Adds `-(stiffness dF/dx + damping dF/dv)` of the whole force F to an n x n matrix, row by row.
    fn add_tangent(&self, at: At<'_>, stiffness: f64, damping: f64, out: &mut [f64]);

    /// How the tangent is stored: symmetric only where it is at every state and velocity.
    fn storage(&self) -> Storage {
        Storage::Full
    }

    /// Whether the force depends on velocities.
    fn has_damping(&self) -> bool {
        self.parts().contains(&Part::Dissipated)
    }

    /// Whether the force at rest derives from a potential.
    fn has_potential(&self) -> bool {
        true
    }

    /// Stored energy [J].
    fn energy(&self, at: At<'_>) -> f64 {
        let _ = at;
        0.0
    }

    /// Whether the stored energy changes with time where nothing moves (a winch turns): that counts as work.
    fn is_rheonomic(&self) -> bool {
        false
    }

    /// Power that comes from outside and is lost at once, without a part in the motion [W]: it counts as work and as
    /// loss.
    fn transit(&self, at: At<'_>) -> f64 {
        let _ = at;
        0.0
    }

    /// Whether [`Self::transit`] may be above zero, and rates of signals are asked for.
    fn has_transit(&self) -> bool {
        false
    }

    /// The first time after `t` at which a value over time that it depends on has a kink.
    fn next_break(&self, t: f64) -> Option<f64> {
        let _ = t;
        None
    }

    /// How many numbers [`Self::outputs`] gives.
    fn output_count(&self) -> usize;

    /// What results show of it at an instant, a few numbers; overwritten.
    fn outputs(&self, at: At<'_>, out: &mut [f64]);
}

/// What a force of a document is built from.
pub(crate) struct Context<'a> {
    /// Places of all bodies.
    pub map: &'a DofMap,
    /// Makes the support of some points.
    pub support: &'a dyn Fn(&[&Interpolation]) -> Support,
    /// What joints leave free.
    pub freedoms: &'a [PlacedFreedom],
    /// Faces of a surface with their coordinates, in the order of their nodal vectors.
    pub faces: &'a FacesOf<'a>,
}

/// Finds faces by the number of their surface and their own.
pub(crate) type FacesOf<'a> =
    dyn Fn(usize, &Array, &str) -> Result<Vec<(Face, Support)>, ModelError> + 'a;

/// The force of a document, in one piece or several; only the first shows numbers.
///
/// # Errors
/// [`ModelError`] naming the force whose points or numbers are wrong.
pub(crate) fn of_spec(
    force: &ForceSpec,
    context: &Context<'_>,
) -> Result<Vec<Box<dyn ForceElement>>, ModelError> {
    let one = |force: Box<dyn ForceElement>| vec![force];
    Ok(match force {
        ForceSpec::Joint { .. } => one(Box::new(joint::JointForce::of_spec(force, context)?)),
        ForceSpec::Spring { .. } => one(Box::new(spring::Spring::of_spec(force, context)?)),
        ForceSpec::Tendon { .. } => one(Box::new(tendon::Tendon::of_spec(force, context)?)),
        ForceSpec::Curvature { .. } => boxed(curvature::Curvature::of_spec(force, context)?),
        ForceSpec::SheetWind { .. } => boxed(sheet_wind::SheetWind::of_spec(force, context)?),
        ForceSpec::Wind { .. } => boxed(wind::Wind::of_spec(force, context)?),
    })
}

fn boxed<F: ForceElement + 'static>(forces: Vec<F>) -> Vec<Box<dyn ForceElement>> {
    forces.into_iter().map(|force| Box::new(force) as Box<dyn ForceElement>).collect()
}

/// The error of a force that was asked to read the document of another kind.
fn other_kind(kind: &str) -> ModelError {
    let reason = "the force is of another kind";
    ModelError::Unsupported { place: kind.to_owned(), reason }
}

/// `out += sum_ij w_i w_j k` over the terms of two local interpolations, `out` n x n: what a force at `r` gains where
/// it depends on `t` by the matrix `k`.
pub fn add_outer(
    r: &Interpolation,
    t: &Interpolation,
    k: &Matrix3<f64>,
    n: usize,
    out: &mut [f64],
) {
    for &(i, w_i) in &r.terms {
        for &(j, w_j) in &t.terms {
            for a in 0..3 {
                for b in 0..3 {
                    out[(i + a) * n + j + b] += w_i * w_j * k[(a, b)];
                }
            }
        }
    }
}
