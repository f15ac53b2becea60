//! Contacts of bodies other than lines, as a document describes them.

use crate::document::{Arrays, row};
use crate::error::ModelError;
use crate::spec::{Array, FrictionSpec, PointSpec, ShapeSpec, default_array};
use pliant_contact::bore::Bore;
use pliant_contact::meshes::Mesh;
use pliant_contact::shapes::Shape;
use serde::{Deserialize, Serialize};

/// Two sides that may touch.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ProbeContactSpec {
    /// Name of the contact.
    pub name: String,
    /// One side.
    pub a: SideSpec,
    /// The other.
    pub b: SideSpec,
    /// Stiffness k, force per penetration [N/m]; of surfaces per area [N/m^3], of lines per length [N/m^2].
    pub stiffness: f64,
    /// Penetration at which the full stiffness is reached [m].
    pub ramp: f64,
    /// Size of what touches: a thickness, a radius [m].
    pub size: f64,
    /// Damping c [s/m].
    pub damping: f64,
    /// Friction; none: none.
    pub friction: Option<FrictionSpec>,
    /// Of a surface with itself: neighbours nearer than this on the stress-free surface do not touch [m].
    #[serde(default)]
    pub window: f64,
    /// Where joints hold the two: side (0 or 1), place on the stress-free surface of this side (3) [m], and how far
    /// around it nothing touches [m], (k, 5).
    #[serde(default = "default_array")]
    pub apart: Array,
}

/// One side of a contact.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "side", rename_all = "snake_case", deny_unknown_fields)]
pub enum SideSpec {
    /// A shell or membrane.
    Surface {
        /// Its number.
        surface: usize,
    },
    /// A rigid body with a shape about its centre.
    Rigid {
        /// Its number.
        rigid: usize,
        /// The shape.
        shape: ShapeSpec,
    },
    /// A mass at a point.
    Mass {
        /// Where.
        at: PointSpec,
        /// Its mass [kg].
        mass: f64,
        /// Its radius [m]; 0: a point.
        radius: f64,
    },
    /// A cable or a beam.
    Line {
        /// Its number, cables first, then beams.
        line: usize,
    },
    /// A shape at rest.
    Rest {
        /// Its centre [m].
        origin: [f64; 3],
        /// Its axes, one a row.
        axes: [[f64; 3]; 3],
        /// The shape.
        shape: ShapeSpec,
    },
}

/// Makes the shape of a description.
///
/// # Errors
/// [`ModelError`] for meshes that name points which are not there.
pub(crate) fn shape_of(
    spec: &ShapeSpec,
    arrays: Arrays<'_>,
    place: &str,
) -> Result<Shape, ModelError> {
    Ok(match spec {
        ShapeSpec::HalfSpace => Shape::HalfSpace,
        &ShapeSpec::Sphere { radius } => Shape::Ball { radius },
        ShapeSpec::Box { size } => Shape::Box { half: size.map(|x| 0.5 * x) },
        &ShapeSpec::Cylinder { radius, length } => Shape::Cylinder { radius, half: 0.5 * length },
        &ShapeSpec::Capsule { radius, length } => Shape::Capsule { radius, half: 0.5 * length },
        ShapeSpec::Mesh { points, triangles } => {
            let points = flat(points, arrays, place)?;
            let corners: Vec<[u32; 3]> = arrays
                .whole(triangles, place)?
                .chunks_exact(3)
                .map(|t| [t[0] as u32, t[1] as u32, t[2] as u32])
                .collect();
            Shape::Mesh(Mesh::new(&points, &corners).ok_or_else(|| ModelError::Unsupported {
                place: place.to_owned(),
                reason: "its mesh has no triangles, or one names a point that is not there",
            })?)
        }
        ShapeSpec::Bore { radius, points, tangents, lengths } => {
            let lengths = arrays.get(lengths, place)?;
            let (points, tangents) = (flat(points, arrays, place)?, flat(tangents, arrays, place)?);
            let bore = Bore::new(&points, &tangents, lengths, *radius);
            Shape::Bore(bore.ok_or_else(|| ModelError::Unsupported {
                place: place.to_owned(),
                reason: "its line has no pieces, or bends more sharply than its radius",
            })?)
        }
    })
}

fn flat(array: &Array, arrays: Arrays<'_>, place: &str) -> Result<Vec<[f64; 3]>, ModelError> {
    let values = arrays.get(array, place)?;
    Ok((0..values.len() / 3).map(|i| row(values, i)).collect())
}
