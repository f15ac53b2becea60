//! Joints: constraints `phi(q, t) = 0` between material points. One file a joint; this is their registry.

pub mod arm;
pub mod clamp;
pub mod coupled;
pub mod cylindrical;
pub mod distance;
pub mod guided;
pub mod hinge;
pub mod hold;
pub mod pin;
pub mod product;
pub mod rigidity;
pub mod side;
pub mod slide_cable;
pub mod slide_line;
pub mod slider;
pub mod universal;
pub mod weld;

use crate::freedom::Freedom;
use crate::point::{Interpolation, Support};
use crate::signal::Moment;
use crate::spec::JointSpec;
use nalgebra::Vector3;
use product::Products;
use side::{Side, unsheared};

/// The joint of a document between its sides; none where a side has no direction that the joint needs.
#[must_use]
pub fn of_spec(joint: &JointSpec, a: &Side<'_>, b: &Side<'_>) -> Option<Products> {
    let unit = |axis: &[f64; 3]| Vector3::from(*axis).try_normalize(0.0);
    // Along single directions.
    let held = |joint: Products| joint.with([a, b].into_iter().filter_map(unsheared));
    match joint {
        // Between nodes, not points: see `hold`.
        JointSpec::Hold { .. } => None,
        JointSpec::Pin { .. } => Some(pin::pin(a, b)),
        JointSpec::Clamp { direction, .. } => clamp::clamp(a, b, direction.map(Vector3::from)),
        JointSpec::Weld { .. } => weld::weld(a, b),
        JointSpec::Hinge { axis, .. } => hinge::hinge(a, b, unit(axis)?).map(held),
        JointSpec::Slider { axis, .. } => slider::slider(a, b, unit(axis)?),
        JointSpec::Cylindrical { axis, .. } => {
            cylindrical::cylindrical(a, b, unit(axis)?).map(held)
        }
        JointSpec::Universal { axis_a, axis_b, .. } => {
            universal::universal(a, b, unit(axis_a)?, unit(axis_b)?).map(held)
        }
        JointSpec::SlideLine { axis, .. } => slide_line::slide_line(a, b, unit(axis)?),
        JointSpec::SlideCable { .. } => None,
        JointSpec::Distance { length, .. } => Some(distance::distance(a, b, *length)),
        JointSpec::DrivePoint { .. }
        | JointSpec::DriveAxis { .. }
        | JointSpec::DriveJoint { .. }
        | JointSpec::Gear { .. } => None,
    }
}

/// A joint over all coordinates, before its place in the equations is known.
pub trait Draft {
    /// Number of equations.
    fn count(&self) -> usize;

    /// Vectors that the equations are made of.
    fn interpolations(&self) -> Vec<&Interpolation>;

    /// Vectors of the parts of a joint that acts on one part of its coordinates at a time, see [`Joint::window`].
    fn windows(&self) -> Vec<Vec<&Interpolation>> {
        Vec::new()
    }

    /// The freedom that the joint leaves, if it is a single number.
    fn freedom(&self) -> Option<&Freedom> {
        None
    }

    /// The same joint over the coordinates of `support`.
    fn placed(self: Box<Self>, support: Support) -> Box<dyn Joint>;
}

/// One joint. Coordinates reach it as its local vector `x`, the unknowns of its [`Support`].
pub trait Joint: Send + Sync {
    /// Number of equations m.
    fn equations(&self) -> usize;

    /// The coordinates it acts on.
    fn support(&self) -> &Support;

    /// Typical size of each equation's residual, given the size of the model [m].
    fn scale(&self, length: f64, out: &mut [f64]);

    /// `phi`, (m,).
    fn residual(&self, now: Moment<'_>, x: &[f64], phi: &mut [f64]);

    /// `phi_q`, (m, local unknowns) row by row, overwritten.
    fn jacobian(&self, now: Moment<'_>, x: &[f64], out: &mut [f64]);

    /// Adds `stiffness (phi_q^T lambda_)_q`, row by row.
    fn add_hessian(
        &self,
        now: Moment<'_>,
        x: &[f64],
        lambda_: &[f64],
        stiffness: f64,
        out: &mut [f64],
    ) {
        let _ = (now, x, lambda_, stiffness, out);
    }

    /// `(phi_q v)_q v + 2 phi_qt v + phi_tt`, (m,), overwritten.
    fn acceleration(&self, now: Moment<'_>, x: &[f64], v: &[f64], out: &mut [f64]) {
        let _ = (now, x, v);
        out.fill(0.0);
    }

    /// The third time derivative of phi at zero jerk, (m,), overwritten.
    fn jerk(&self, now: Moment<'_>, x: &[f64], v: &[f64], a: &[f64], out: &mut [f64]) {
        let _ = (now, x, v, a);
        out.fill(0.0);
    }

    /// `phi_t`, (m,), overwritten.
    fn rate(&self, now: Moment<'_>, x: &[f64], out: &mut [f64]) {
        let _ = (now, x);
        out.fill(0.0);
    }

    /// Force [N] and moment [N m] that the joint exerts on its first body, about the joint's point.
    fn reaction(&self, now: Moment<'_>, x: &[f64], lambda_: &[f64]) -> ([f64; 3], [f64; 3]);

    /// Number of the part of its coordinates that it acts on at present, of those of [`Draft::windows`].
    fn window(&self, x: &[f64]) -> usize {
        let _ = x;
        0
    }

    /// Entries (row, column, value) of `(phi_q^T lambda_)_q`, for joints with windows.
    fn hessian_entries(&self, x: &[f64], lambda_: &[f64], out: &mut Vec<(usize, usize, f64)>) {
        let _ = (x, lambda_, out);
    }

    /// What is wrong where it has left what it moves on.
    fn strayed(&self, x: &[f64]) -> Option<String> {
        let _ = x;
        None
    }

    /// The joint's freedom and its rate, where it leaves a single one that is a number.
    fn motion(&self, x: &[f64], v: &[f64]) -> Option<[f64; 2]> {
        let _ = (x, v);
        None
    }

    /// Whether it moves in time by itself: its forces do work.
    fn is_driven(&self) -> bool {
        false
    }

    /// The first time after `t` at which a value over time that it depends on has a kink.
    fn next_break(&self, t: f64) -> Option<f64> {
        let _ = t;
        None
    }

    /// How many numbers it remembers from one step to the next.
    fn memory(&self) -> usize {
        0
    }

    /// Writes what it remembers at the start.
    fn begin(&self, now: Moment<'_>, memory: &mut [f64]) {
        let _ = (now, memory);
    }

    /// Writes what it remembers of the end of a step; `now` has what it remembered before.
    fn remember(&self, now: Moment<'_>, memory: &mut [f64]) {
        let _ = (now, memory);
    }
}
