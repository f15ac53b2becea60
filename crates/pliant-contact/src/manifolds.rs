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
    /// Share of the outline of where the two may touch that it stands for, four in all: one for each corner of a box
    /// that stands. Points that fall together share theirs, so that the force does not jump with their number.
    pub weight: f64,
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

/// Shares of the outline of points in a plane, four in all; those inside have none.
fn shares(points: &[[f64; 2]]) -> Vec<f64> {
    let mut order: Vec<usize> = (0..points.len()).collect();
    order.sort_by(|&i, &j| {
        points[i][0].total_cmp(&points[j][0]).then(points[i][1].total_cmp(&points[j][1]))
    });
    let turn = |a: usize, b: usize, c: usize| {
        let d = |i: usize, k: usize| points[i][k] - points[a][k];
        d(b, 0) * d(c, 1) - d(b, 1) * d(c, 0)
    };
    // Andrew's monotone chain: below from left to right, above back.
    let mut outline: Vec<usize> = Vec::new();
    let mut chain = |sequence: &mut dyn Iterator<Item = usize>| {
        let first = outline.len();
        for i in sequence {
            while outline.len() >= first + 2
                && turn(outline[outline.len() - 2], outline[outline.len() - 1], i) <= 0.0
            {
                outline.pop();
            }
            outline.push(i);
        }
        outline.pop();
    };
    chain(&mut order.iter().copied());
    chain(&mut order.iter().rev().copied());
    let mut weights = vec![0.0; points.len()];
    let n = outline.len();
    let length = |i: usize, j: usize| {
        let (a, b) = (points[outline[i % n]], points[outline[j % n]]);
        (a[0] - b[0]).hypot(a[1] - b[1])
    };
    let whole: f64 = (0..n).map(|i| length(i, i + 1)).sum();
    if whole > 0.0 {
        for i in 0..n {
            weights[outline[i]] += 2.0 * (length(i, i + 1) + length(i + n - 1, i)) / whole;
        }
    } else if let Some(first) = weights.first_mut() {
        *first = 4.0;
    }
    weights
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
    // Corners that have left count in the outline still.
    let size = |shape: &Shape| shape.half_extent().into_iter().fold(f64::INFINITY, f64::min);
    let margin = 0.5 * size(first.0).min(size(second.0));
    let mut manifold: ContactManifold<(), ()> = ContactManifold::new();
    let outcome = DefaultQueryDispatcher.contact_manifold_convex_convex(
        &pose,
        one.as_ref(),
        two.as_ref(),
        None,
        None,
        margin,
        &mut manifold,
    );
    if outcome.is_err() {
        return Vec::new();
    }
    let normal = turn_1 * ours(manifold.local_n1);
    let across = normal.cross(&Vector3::ith(normal.iamin(), 1.0)).normalize();
    let aside = normal.cross(&across);
    let places: Vec<Vector3<f64>> =
        manifold.points.iter().map(|p| turn_1 * ours(p.local_p1)).collect();
    let flat: Vec<[f64; 2]> = places.iter().map(|p| [across.dot(p), aside.dot(p)]).collect();
    let weights = shares(&flat);
    let points = manifold.points.iter().zip(&places).zip(weights);
    points
        .filter(|((p, _), weight)| p.dist < 0.0 && *weight > 0.0)
        .map(|((p, &first), weight)| Meeting {
            first,
            second: turn_2 * ours(p.local_p2),
            normal,
            weight,
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
    fn shares_do_not_count_points_twice() {
        let square = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        assert_eq!(shares(&square), [1.0; 4]);
        let more = [square[0], square[1], square[1], square[2], square[3], [0.3, 0.4]];
        let weights = shares(&more);
        // Rounding.
        assert!((weights[1] + weights[2] - 1.0).abs() < 1e-15 && weights[5] == 0.0);
        assert_eq!(shares(&[[0.0, 0.0], [2.0, 0.0], [1.0, 0.0]]), [2.0, 2.0, 0.0]);
        assert_eq!(shares(&[[0.3, 0.1]]), [4.0]);
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
