//! Probes before shapes: action is reaction, the tangent is that of the force, the force that of the energy.

mod common;

use common::{LOCAL, laws};
use nalgebra::{Matrix3, Rotation3, Vector3};
use pliant_contact::point::{Laws, Motion};
use pliant_contact::probe::{Blocks, Opposing, Pose, Probe, Slave};
use pliant_contact::shapes::Shape;
use proptest::prelude::*;

type Vectors = [Vector3<f64>; 8];

const RADIUS: f64 = 0.07;

fn shapes() -> Vec<Shape> {
    vec![
        Shape::HalfSpace,
        Shape::Ball { radius: 0.4 },
        Shape::Box { half: [0.3, 0.4, 0.35] },
        Shape::Cylinder { radius: 0.35, half: 0.3 },
        Shape::Capsule { radius: 0.3, half: 0.2 },
    ]
}

/// The probe over eight vectors: what carries it is 0 a point, 1 a body.
fn probe(shape: &Shape, carrier: usize, x: &Vectors) -> Probe {
    let master = Pose { origin: x[4], axes: Matrix3::from_columns(&[x[5], x[6], x[7]]) };
    let local = Vector3::from(LOCAL);
    let (slave, p) = if carrier == 0 {
        (Slave::Point, x[0])
    } else {
        let pose = Pose { origin: x[0], axes: Matrix3::from_columns(&[x[1], x[2], x[3]]) };
        (Slave::Body(pose, local), pose.at(local))
    };
    let distance = shape.distance(master.local(p));
    Probe { slave, p, radius: RADIUS, master, moves: true, distance, weight: 1.3 }
}

struct Case {
    x: Vectors,
    v: Vectors,
    moved: Vectors,
    z: Vector3<f64>,
}

/// A state in which the probe penetrates the shape by a few millimetres.
fn case(shape: &Shape, carrier: usize, numbers: &[f64]) -> Case {
    let turn = |k: usize| Rotation3::new(Vector3::new(numbers[k], numbers[k + 1], numbers[k + 2]));
    let (own, other) = (turn(0), turn(3));
    let direction = Vector3::new(numbers[6], numbers[7], 0.3 + numbers[8].abs()).normalize();
    // Along a ray from the centre to where the gap is -3 mm.
    let (mut low, mut high) = (0.0, 3.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if shape.distance(direction * middle).value - RADIUS < -3e-3 {
            low = middle;
        } else {
            high = middle;
        }
    }
    let origin = Vector3::new(0.3, -0.2, 0.1);
    let p = origin + other * (direction * low);
    let r = if carrier == 0 { p } else { p - own * Vector3::from(LOCAL) };
    let axis = |m: &Rotation3<f64>, k: usize| m * Vector3::ith(k, 1.0);
    let x = [
        r,
        axis(&own, 0),
        axis(&own, 1),
        axis(&own, 2),
        origin,
        axis(&other, 0),
        axis(&other, 1),
        axis(&other, 2),
    ];
    let wild = |from: usize| -> Vectors {
        std::array::from_fn(|k| {
            Vector3::from_fn(|c, _| 0.5 * numbers[(from + 3 * k + c) % numbers.len()])
        })
    };
    let n = other * shape.distance(direction * low).normal;
    let z = wild(2)[0] * 0.01;
    Case { x, v: wild(0), moved: wild(5).map(|m| m * 0.002), z: z - n * n.dot(&z) }
}

fn force(
    shape: &Shape,
    carrier: usize,
    laws: &Laws,
    case: &Case,
    x: &Vectors,
    v: &Vectors,
) -> Vectors {
    let probe = probe(shape, carrier, x);
    let moved = std::array::from_fn(|k| case.moved[k] + x[k] - case.x[k]);
    let motion = Motion { v, moved: &moved, h: 2e-3, z: case.z };
    let mut out = [Vector3::zeros(); 8];
    probe.add_force(probe.force(laws, &motion).total, &mut out);
    out
}

proptest! {
    #[test]
    fn tangent_is_the_derivative_of_the_force(numbers in prop::collection::vec(-1.0..1.0_f64, 29)) {
        for shape in shapes() {
            for carrier in 0..2 {
                let case = case(&shape, carrier, &numbers);
                let here = probe(&shape, carrier, &case.x);
                for (friction, weights) in [(false, (1.0, 0.0)), (true, (1.0, 0.0)), (true, (0.0, 1.0))] {
                    let laws = laws(friction);
                    let motion = Motion { v: &case.v, moved: &case.moved, h: 2e-3, z: case.z };
                    let mut blocks: Blocks = [[Matrix3::zeros(); 8]; 8];
                    here.add_tangent(&laws, &motion, weights, false, &mut blocks);
                    let size = blocks.iter().flatten().map(|b| b.amax()).fold(1.0, f64::max);
                    let e = 2e-8;
                    for l in 0..8 {
                        for c in 0..3 {
                            let shifted = |sign: f64| {
                                let (mut x, mut v) = (case.x, case.v);
                                if weights.0 == 0.0 { v[l][c] += sign * e } else { x[l][c] += sign * e }
                                (force(&shape, carrier, &laws, &case, &x, &v), probe(&shape, carrier, &x))
                            };
                            let ((up, one), (down, two)) = (shifted(1.0), shifted(-1.0));
                            // Kinks of the shape, where its normal or its curvature jumps.
                            let bent = (one.distance.hessian - two.distance.hessian).amax();
                            if (one.normal() - two.normal()).norm() > 1e-4 || bent > 1e-3 {
                                continue;
                            }
                            for k in 0..8 {
                                let expected = (up[k] - down[k]) / (2.0 * e);
                                let got: Vector3<f64> = blocks[k][l].column(c).into();
                                // Differences: e^2 times third derivatives, 1/ramp^2 or those of the friction law by e/h, and
                                // rounding over e.
                                prop_assert!((expected - got).amax() < 2e-5 * size,
                                    "{shape:?} carrier {carrier} {friction} ({k}, {l}, {c}): {expected} {got}");
                            }
                        }
                    }
                }
            }
        }
    }

    #[test]
    fn action_is_reaction(numbers in prop::collection::vec(-1.0..1.0_f64, 29)) {
        for shape in shapes() {
            for carrier in 0..2 {
                let case = case(&shape, carrier, &numbers);
                let laws = laws(true);
                let f = force(&shape, carrier, &laws, &case, &case.x, &case.v);
                let size = f.iter().map(|f| f.norm()).fold(1e-12, f64::max);
                prop_assert!((f[0] + f[4]).norm() < 1e-12 * size);
                if carrier == 1 {
                    let moment: Vector3<f64> = (0..8).map(|k| case.x[k].cross(&f[k])).sum();
                    prop_assert!(moment.norm() < 1e-11 * size, "{shape:?} {moment}");
                }
            }
        }
    }

    #[test]
    fn what_turns_with_the_bodies_sees_the_same_force(numbers in prop::collection::vec(-1.0..1.0_f64, 29)) {
        let turn = Rotation3::new(Vector3::new(0.4, -1.1, 0.7));
        for shape in shapes() {
            for carrier in 0..2 {
                let case = case(&shape, carrier, &numbers);
                let laws = laws(true);
                let plain = force(&shape, carrier, &laws, &case, &case.x, &case.v);
                let turned = Case {
                    x: case.x.map(|x| turn * x),
                    v: case.v.map(|x| turn * x),
                    moved: case.moved.map(|x| turn * x),
                    z: turn * case.z,
                };
                let other = force(&shape, carrier, &laws, &turned, &turned.x, &turned.v);
                for k in 0..8 {
                    prop_assert!((turn * plain[k] - other[k]).norm() < 1e-7 * (1.0 + plain[k].norm()));
                }
            }
        }
    }

    #[test]
    fn power_is_lost_only(numbers in prop::collection::vec(-1.0..1.0_f64, 29)) {
        // Without friction and damping the power is minus the rate of the energy, also while the axes turn.
        for shape in shapes() {
            let case = case(&shape, 1, &numbers);
            let mut laws = laws(false);
            laws.normal.c = 0.0;
            let spin = [0, 9].map(|k| Vector3::new(numbers[k], numbers[k + 4], numbers[k + 7]));
            let v: Vectors = std::array::from_fn(|k| match k {
                0 | 4 => case.v[k],
                _ => spin[k / 4].cross(&case.x[k]),
            });
            let f = force(&shape, 1, &laws, &case, &case.x, &v);
            let power: f64 = (0..8).map(|k| f[k].dot(&v[k])).sum();
            let e = 1e-6;
            let energy = |sign: f64| {
                let x = std::array::from_fn(|k| case.x[k] + v[k] * (sign * e));
                laws.normal.energy(-probe(&shape, 1, &x).gap()) * 1.3
            };
            let rate = (energy(1.0) - energy(-1.0)) / (2.0 * e);
            // Second order in e, the axes leave orthonormality by e^2.
            prop_assert!((power - rate).abs() < 1e-4 * (1.0 + power.abs()), "{shape:?} {power} {rate}");
        }
    }
}
