//! Where two solids with flat faces touch: points on both with one normal, from parry's separating axes and clipping.

use crate::probe::Pose;
use crate::shapes::Shape;
use nalgebra::{Matrix3, UnitQuaternion, Vector3};
use parry3d_f64::math::{Pose as ParryPose, Rotation, Vector};
use parry3d_f64::query::{ContactManifold, DefaultQueryDispatcher, PersistentQueryDispatcher};
use parry3d_f64::shape::{Cuboid, Cylinder, Shape as ParryShape};

/// A point where two solids touch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Meeting {
    /// The point of the first, in its frame.
    pub first: Vector3<f64>,
    /// The point of the second, in its frame.
    pub second: Vector3<f64>,
    /// Outward normal of the first, in its frame.
    pub normal: Vector3<f64>,
}

/// The solid in parry's axes, and parry's axes in ours: its cylinders stand along y.
fn solid(shape: &Shape) -> Option<(Box<dyn ParryShape>, Matrix3<f64>)> {
    match *shape {
        Shape::Box { half } => {
            Some((Box::new(Cuboid::new(Vector::from_array(half))), Matrix3::identity()))
        }
        Shape::Cylinder { radius, half } => {
            let turn = Matrix3::new(0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0);
            Some((Box::new(Cylinder::new(half, radius)), turn))
        }
        _ => None,
    }
}

fn parry(v: Vector3<f64>) -> Vector {
    Vector::new(v.x, v.y, v.z)
}

fn ours(v: Vector) -> Vector3<f64> {
    Vector3::new(v.x, v.y, v.z)
}

/// Whether [`meet`] knows both.
#[must_use]
pub fn has_faces(shape: &Shape) -> bool {
    matches!(shape, Shape::Box { .. } | Shape::Cylinder { .. })
}

/// All points where two boxes or cylinders penetrate each other.
#[must_use]
pub fn meet(first: (&Shape, &Pose), second: (&Shape, &Pose)) -> Vec<Meeting> {
    let (Some((one, turn_1)), Some((two, turn_2))) = (solid(first.0), solid(second.0)) else {
        return Vec::new();
    };
    let axes = (first.1.axes * turn_1).transpose() * second.1.axes * turn_2;
    let offset = turn_1.transpose() * first.1.local(second.1.origin);
    let q = UnitQuaternion::from_matrix(&axes);
    let rotation = Rotation::from_xyzw(q.i, q.j, q.k, q.w);
    let pose = ParryPose::from_parts(parry(offset), rotation);
    let mut manifold: ContactManifold<(), ()> = ContactManifold::new();
    let outcome = DefaultQueryDispatcher.contact_manifold_convex_convex(
        &pose,
        one.as_ref(),
        two.as_ref(),
        None,
        None,
        0.0,
        &mut manifold,
    );
    if outcome.is_err() {
        return Vec::new();
    }
    let normal = turn_1 * ours(manifold.local_n1);
    let points = manifold.points.iter().filter(|p| p.dist < 0.0);
    points
        .map(|p| Meeting {
            first: turn_1 * ours(p.local_p1),
            second: turn_2 * ours(p.local_p2),
            normal,
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(z: f64) -> Pose {
        Pose { origin: Vector3::new(0.0, 0.0, z), axes: Matrix3::identity() }
    }

    #[test]
    fn a_box_on_a_box_stands_on_four_corners() {
        let (big, small) = (Shape::Box { half: [0.5; 3] }, Shape::Box { half: [0.2; 3] });
        let found = meet((&big, &at(0.0)), (&small, &at(0.69)));
        assert_eq!(found.len(), 4);
        for point in found {
            assert!((point.normal - Vector3::z()).norm() < 1e-12);
            assert!((point.first.z - 0.5).abs() < 1e-12);
            assert!((point.second.z + 0.2).abs() < 1e-12);
            assert!((point.second.xy().amax() - 0.2).abs() < 1e-12);
        }
        assert!(meet((&big, &at(0.0)), (&small, &at(0.71))).is_empty());
    }

    #[test]
    fn crossed_planks_touch_where_they_overlap() {
        let one = Shape::Box { half: [1.0, 0.1, 0.05] };
        let two = Shape::Box { half: [0.1, 1.0, 0.05] };
        let found = meet((&one, &at(0.0)), (&two, &at(0.099)));
        assert_eq!(found.len(), 4);
        for point in found {
            assert!(point.first.xy().amax() < 0.1 + 1e-9);
        }
    }

    #[test]
    fn a_cylinder_stands_on_a_box() {
        let (floor, can) =
            (Shape::Box { half: [1.0, 1.0, 0.1] }, Shape::Cylinder { radius: 0.2, half: 0.3 });
        let found = meet((&floor, &at(0.0)), (&can, &at(0.399)));
        assert!(found.len() >= 3, "{found:?}");
        for point in found {
            assert!((point.normal - Vector3::z()).norm() < 1e-9);
            assert!((point.second.z + 0.3).abs() < 1e-9);
        }
    }
}
