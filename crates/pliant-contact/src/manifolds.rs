//! Where two solids with flat faces touch: points on both with one normal, from parry's separating axes. The faces of
//! boxes are clipped here: the result must not jump where their sides lie in one plane, as they do in every wall.

use crate::probe::Pose;
use crate::shapes::Shape;
use nalgebra::{Matrix3, UnitQuaternion, Vector3};
use parry3d_f64::math::{Pose as ParryPose, Rotation, Vector};
use parry3d_f64::query::{
    ContactManifold, DefaultQueryDispatcher, PersistentQueryDispatcher, TrackedContact,
};
use parry3d_f64::shape::{Cuboid, Cylinder, Shape as ParryShape};
use std::f64::consts::PI;

/// A point where two solids touch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Meeting {
    /// The point of the first, in its frame.
    pub first: Vector3<f64>,
    /// The point of the second, in its frame.
    pub second: Vector3<f64>,
    /// Outward normal of the first, in its frame.
    pub normal: Vector3<f64>,
    /// Share of the turn of the outline of where the two may touch that it stands for, four in all: one for each corner
    /// of a box that stands. Points that fall together share theirs and points within a side have none, so that the
    /// force does not jump with their number.
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

/// Shares in the turn of the outline of points in a plane, four in all; those inside have none. Of a convex outline the
/// turn is a measure that depends on its shape continuously (Federer 1959), however many points lie along its sides.
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
    let side = |i: usize| {
        let (a, b) = (points[outline[i % n]], points[outline[(i + 1) % n]]);
        [b[0] - a[0], b[1] - a[1]]
    };
    if n > 1 {
        for i in 0..n {
            let (a, b) = (side(i + n - 1), side(i));
            let (across, along) = (a[0] * b[1] - a[1] * b[0], a[0] * b[0] + a[1] * b[1]);
            weights[outline[i]] += 2.0 / PI * across.atan2(along).abs();
        }
    } else if let Some(first) = weights.first_mut() {
        *first = 4.0;
    }
    weights
}

/// Corners of the face of a box that looks most along `n`, in order around it, and its outward normal.
fn face(half: &[f64; 3], n: Vector3<f64>) -> ([Vector3<f64>; 4], Vector3<f64>) {
    let k = n.iamax();
    let outward = Vector3::ith(k, n[k].signum());
    let (u, v) = ((k + 1) % 3, (k + 2) % 3);
    let corner = |a: f64, b: f64| {
        outward * half[k] + Vector3::ith(u, a * half[u]) + Vector3::ith(v, b * half[v])
    };
    ([corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)], outward)
}

/// Corners of the part of a convex polygon that lies in another (Sutherland & Hodgman 1974). Sides of both that lie on
/// one line may be cut anywhere along it, but no corner is lost there.
fn overlap(subject: &[[f64; 2]], window: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let twice = |a: [f64; 2], b: [f64; 2], p: [f64; 2]| {
        (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0])
    };
    let turn = twice(window[0], window[1], window[2]).signum();
    let mut part = subject.to_vec();
    for (i, &a) in window.iter().enumerate() {
        let b = window[(i + 1) % window.len()];
        let inside = |p: [f64; 2]| turn * twice(a, b, p);
        let mut kept = Vec::with_capacity(part.len() + 1);
        for (j, &p) in part.iter().enumerate() {
            let q = part[(j + 1) % part.len()];
            let (at_p, at_q) = (inside(p), inside(q));
            if at_p >= 0.0 {
                kept.push(p);
            }
            if at_p * at_q < 0.0 {
                let part = at_p / (at_p - at_q);
                kept.push([0, 1].map(|c| p[c] + part * (q[c] - p[c])));
            }
        }
        part = kept;
    }
    part
}

/// Points of two boxes in their frames, and their distance along the normal `n`, both in the frame of the first.
type Pair = (Vector3<f64>, Vector3<f64>, f64);

/// Corners of where the faces of two boxes that look at each other overlap, seen along `n`; `axes` and `offset` place
/// the second in the first.
fn faces(
    halves: [&[f64; 3]; 2],
    (axes, offset): (&Matrix3<f64>, Vector3<f64>),
    n: Vector3<f64>,
    plane: [Vector3<f64>; 2],
) -> Vec<Pair> {
    let (corners_1, out_1) = face(halves[0], n);
    let (corners_2, out_2) = face(halves[1], axes.transpose() * -n);
    let (corners_2, out_2) = (corners_2.map(|c| axes * c + offset), axes * out_2);
    let flat = |corner: Vector3<f64>| plane.map(|e| e.dot(&corner));
    let lift = |p: [f64; 2], (corner, out): (Vector3<f64>, Vector3<f64>)| {
        let place = plane[0] * p[0] + plane[1] * p[1];
        // The face that looks most along n does so by 1/sqrt(3) at least.
        place + n * ((corner - place).dot(&out) / n.dot(&out))
    };
    overlap(&corners_2.map(flat), &corners_1.map(flat))
        .into_iter()
        .map(|p| {
            let (first, second) = (lift(p, (corners_1[0], out_1)), lift(p, (corners_2[0], out_2)));
            (first, axes.transpose() * (second - offset), n.dot(&(second - first)))
        })
        .collect()
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
    // Places on the bodies do not stretch with axes that an iterate has off being orthonormal.
    let axes = q.to_rotation_matrix().into_inner();
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
    let normal = turn_1 * ours(manifold.local_n1);
    if outcome.is_err() || normal == Vector3::zeros() {
        return Vec::new();
    }
    let across = normal.cross(&Vector3::ith(normal.iamin(), 1.0)).normalize();
    let plane = [across, normal.cross(&across)];
    let pairs: Vec<Pair> = match (first.0, second.0) {
        (Shape::Box { half: one }, Shape::Box { half: two }) => {
            faces([one, two], (&axes, offset), normal, plane)
        }
        _ => {
            let pair = |p: &TrackedContact<()>| {
                (turn_1 * ours(p.local_p1), turn_2 * ours(p.local_p2), p.dist)
            };
            manifold.points.iter().map(pair).collect()
        }
    };
    let flat: Vec<[f64; 2]> = pairs.iter().map(|(p, ..)| plane.map(|e| e.dot(p))).collect();
    pairs
        .into_iter()
        .zip(shares(&flat))
        .filter(|((.., distance), weight)| *distance < 0.0 && *weight > 0.0)
        .map(|((first, second, _), weight)| Meeting { first, second, normal, weight })
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
        // A point that leaves a side by rounding does not take from the corners.
        let dented = [square[0], [0.4, -1e-15], square[1], square[2], square[3]];
        let weights = shares(&dented);
        assert!((weights[0] - 1.0).abs() < 1e-14 && weights[1] < 1e-14, "{weights:?}");
    }

    #[test]
    fn what_carries_does_not_jump_where_sides_are_flush() {
        let shape = Shape::Box { half: [0.1, 0.1, 0.05] };
        let mut random = 1_u64;
        let mut part = || {
            random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (random >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
        };
        for k in 0..3000 {
            let size = 10.0_f64.powi(-9 - k % 10);
            let turned = Vector3::from_fn(|_, _| part()) * size;
            let moved = Vector3::from_fn(|_, _| part()) * size;
            let pose = Pose {
                origin: Vector3::new(0.01, 0.0, 0.0999) + moved,
                axes: UnitQuaternion::from_scaled_axis(turned).to_rotation_matrix().into_inner(),
            };
            let found = meet((&shape, &at(0.0)), (&shape, &pose));
            // Four corners of 0.19 m by 0.2 m, each of weight one, however many points stand for them.
            for (x, y) in [(-0.09, -0.1), (-0.09, 0.1), (0.1, -0.1), (0.1, 0.1)] {
                let near = found.iter().filter(|p| (p.first.x - x).hypot(p.first.y - y) < 1e-3);
                let weight: f64 = near.map(|p| p.weight).sum();
                // Sides turn against each other by as much as the boxes.
                assert!((weight - 1.0).abs() < 1e-7, "{k}: {found:?}");
            }
        }
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
