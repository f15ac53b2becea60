//! Every joint: Jacobian, Hessian, acceleration and jerk against finite differences; action equals reaction.

use nalgebra::Vector3;
use pliant_multibody::joints::arm::{Arm, Role};
use pliant_multibody::joints::hold::{Equation, hold};
use pliant_multibody::joints::rigidity::rigidity;
use pliant_multibody::joints::side::{Frame, Side};
use pliant_multibody::joints::{Draft, Joint, of_spec};
use pliant_multibody::point::{Interpolation, Support};
use pliant_multibody::signal::Moment;
use pliant_multibody::spec::{JointSpec, PointSpec};

/// Two rigid bodies (12 coordinates each), a node of a line (6) and the gradients of a section (6). Another section lies
/// in the axes of the second body.
const UNKNOWNS: usize = 36;

/// Numbers between -1 and 1.
fn noise(seed: usize) -> Vec<f64> {
    (0..UNKNOWNS).map(|i| (1.7 * (i + 1) as f64 + 12.3 * seed as f64).sin()).collect()
}

/// Bodies turned against the world, and a line along y.
fn start() -> Vec<f64> {
    let mut q = noise(1);
    for first in [3, 15] {
        let turn = nalgebra::Rotation3::from_euler_angles(q[0], q[1] * first as f64, 0.3);
        q[first..first + 9].copy_from_slice(turn.matrix().as_slice());
    }
    q[27..30].copy_from_slice(&[0.0, 1.1, 0.0]);
    let turn = nalgebra::Rotation3::from_euler_angles(0.4, -1.0, 0.7);
    q[30..].copy_from_slice(&turn.matrix().as_slice()[..6]);
    q
}

fn vector_at(offset: usize) -> Interpolation {
    Interpolation::weighted([(offset, 1.0)])
}

fn body(first: usize, local: [f64; 3]) -> (Interpolation, Frame) {
    let terms = (0..3).map(|k| (first + 3 + 3 * k, local[k]));
    let r = Interpolation::weighted(std::iter::once((first, 1.0)).chain(terms));
    (r, Frame::Body([3, 6, 9].map(|k| vector_at(first + k))))
}

fn specs() -> Vec<JointSpec> {
    let world = || PointSpec::World { world: [0.0; 3] };
    let (name, a, b) = (String::new, world, world);
    let axis = [0.0, 1.0, 0.0];
    vec![
        JointSpec::Pin { name: name(), a: a(), b: b() },
        JointSpec::Clamp { name: name(), a: a(), direction: None },
        JointSpec::Weld { name: name(), a: a(), b: b() },
        JointSpec::Hinge { name: name(), a: a(), b: b(), axis },
        JointSpec::Hinge { name: name(), a: a(), b: b(), axis: [0.6, 0.0, -0.8] },
        JointSpec::Slider { name: name(), a: a(), b: b(), axis: [0.0, 0.6, 0.8] },
        JointSpec::Cylindrical { name: name(), a: a(), b: b(), axis },
        JointSpec::Universal {
            name: name(),
            a: a(),
            b: b(),
            axis_a: axis,
            axis_b: [0.0, 0.0, 1.0],
        },
        JointSpec::Universal {
            name: name(),
            a: a(),
            b: b(),
            axis_a: [1.0, 0.0, 0.0],
            axis_b: axis,
        },
        JointSpec::SlideLine { name: name(), a: a(), b: b(), axis },
        JointSpec::Distance { name: name(), a: a(), b: b(), length: 0.7 },
    ]
}

/// Every joint between every two kinds of sides that can carry it, with a name.
fn joints() -> Vec<(String, Box<dyn Joint>)> {
    let q = start();
    let kinds = || {
        [
            ("body", body(0, [0.3, -0.2, 0.5])),
            ("other body", body(12, [-0.1, 0.4, 0.2])),
            ("line", (vector_at(24), Frame::Line(vector_at(27)))),
            ("section", (vector_at(24), Frame::Section([30, 33].map(vector_at)))),
            ("other section", (vector_at(12), Frame::Section([15, 18].map(vector_at)))),
            ("point", (vector_at(24), Frame::Point)),
            ("world", (Interpolation::fixed([0.2, 0.1, -0.4]), Frame::World)),
        ]
    };
    let unknowns = || Support { groups: Vec::new(), unknowns: (0..UNKNOWNS).collect() };
    let mut all = Vec::new();
    for spec in specs() {
        for (a_kind, (r, frame)) in kinds() {
            let a = Side { r, frame, first: true, q: &q };
            for (b_kind, (r, frame)) in kinds() {
                let b = Side { r, frame, first: false, q: &q };
                if a_kind != b_kind
                    && let Some(joint) = of_spec(&spec, &a, &b)
                {
                    let name = format!("{spec:?} of {a_kind} and {b_kind}");
                    all.push((name, Box::new(joint).placed(unknowns())));
                }
            }
        }
    }
    let axes = [3, 6, 9].map(vector_at);
    all.push(("rigidity".to_owned(), Box::new(rigidity(&axes)).placed(unknowns())));
    // Nodal vectors of a surface: a position against another, a slope against the world.
    let equation = |terms: [(usize, f64); 2], role, direction: [f64; 3]| Equation {
        value: Interpolation::weighted(terms),
        role,
        direction: Arm::fixed(direction),
    };
    let held = vec![
        equation([(0, 1.0), (12, -1.0)], Role::Gap, [0.0, 0.6, 0.8]),
        equation([(3, 0.8), (6, -0.6)], Role::OfFirst, [1.0, 0.0, 0.0]),
        // A slope against an axis of a body.
        Equation {
            value: Interpolation::weighted([(9, 0.7), (24, 0.2)]),
            role: Role::OfFirst,
            direction: Arm::new(vector_at(15), Role::Other),
        },
    ];
    all.push(("hold".to_owned(), Box::new(hold(held, &q, None)).placed(unknowns())));
    all
}

fn moved(q: &[f64], v: &[f64], t: f64) -> Vec<f64> {
    q.iter().zip(v).map(|(q, v)| q + t * v).collect()
}

fn close(a: &[f64], b: &[f64], tolerance: f64, what: &str) {
    for (k, (a, b)) in a.iter().zip(b).enumerate() {
        assert!((a - b).abs() < tolerance, "{what}, entry {k}: {a} and {b}");
    }
}

#[test]
fn derivatives_agree_with_finite_differences() {
    let all = joints();
    // Every file of the folder is in the loop; four hold what the joints share, three have tests of their own.
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/src/joints");
    let files = std::fs::read_dir(folder).unwrap().count() - 7;
    let mut kinds: Vec<_> =
        all.iter().map(|(n, _)| n.split(' ').next().unwrap().to_owned()).collect();
    kinds.dedup();
    assert_eq!(files, kinds.len(), "{kinds:?}");
    let (q, v, a) = (noise(2), noise(3), noise(4));
    for (name, joint) in all {
        let m = joint.equations();
        let phi = |q: &[f64]| {
            let mut phi = vec![0.0; m];
            joint.residual(Moment::at(0.0), q, &mut phi);
            phi
        };
        let jacobian = |q: &[f64]| {
            let mut out = vec![0.0; m * UNKNOWNS];
            joint.jacobian(Moment::at(0.0), q, &mut out);
            out
        };
        let times = |matrix: &[f64], v: &[f64]| -> Vec<f64> {
            matrix.chunks(v.len()).map(|r| r.iter().zip(v).map(|(r, v)| r * v).sum()).collect()
        };
        // Polynomials up to degree four: these differences are exact but for rounding.
        let h = 0.1;
        let combined = |f: &dyn Fn(&[f64]) -> Vec<f64>, weights: [f64; 2]| -> Vec<f64> {
            let at = |k: f64| f(&moved(&q, &v, k * h));
            let points = [at(1.0), at(-1.0), at(2.0), at(-2.0)];
            let sum = |i: usize| {
                weights[0] * (points[0][i] - points[1][i])
                    + weights[1] * (points[2][i] - points[3][i])
            };
            (0..points[0].len()).map(sum).collect()
        };
        let first = [8.0 / (12.0 * h), -1.0 / (12.0 * h)];
        let slope = combined(&phi, first);
        close(&times(&jacobian(&q), &v), &slope, 1e-10, &format!("{name}: Jacobian"));
        // (phi_q v)_q v
        let turn = combined(&jacobian, first);
        let mut out = vec![0.0; m];
        joint.acceleration(Moment::at(0.0), &q, &v, &mut out);
        close(&out, &times(&turn, &v), 1e-10, &format!("{name}: acceleration"));
        // 3 (phi_q v)_q a + phi_qqq(v, v, v)
        let third = combined(&phi, [-1.0 / h.powi(3), 0.5 / h.powi(3)]);
        joint.jerk(Moment::at(0.0), &q, &v, &a, &mut out);
        let expected: Vec<f64> =
            times(&turn, &a).iter().zip(&third).map(|(x, y)| 3.0 * x + y).collect();
        close(&out, &expected, 1e-9, &format!("{name}: jerk"));
        // (phi_q^T lambda_)_q v
        let lambda_: Vec<f64> = noise(5)[..m].to_vec();
        let mut hessian = vec![0.0; UNKNOWNS * UNKNOWNS];
        joint.add_hessian(Moment::at(0.0), &q, &lambda_, 2.0, &mut hessian);
        let expected: Vec<f64> = (0..UNKNOWNS)
            .map(|j| (0..m).map(|i| 2.0 * lambda_[i] * turn[i * UNKNOWNS + j]).sum())
            .collect();
        close(&times(&hessian, &v), &expected, 1e-10, &format!("{name}: Hessian"));
    }
}

/// The reaction on the first body is the generalized force on its coordinates, and the two sides are in balance: about
/// the joint's point the moments of all generalized forces cancel.
#[test]
fn action_equals_reaction() {
    let q = start();
    let a_point = body(0, [0.3, -0.2, 0.5]).0;
    for (name, joint) in joints() {
        if !name.contains("of body and other body") || name.contains("Distance") {
            continue;
        }
        // Side b is moved so that the points coincide, as they do in a run.
        let mut x = q.clone();
        let b_point = body(12, [-0.1, 0.4, 0.2]).0;
        let (ra, rb) = (a_point.at(&x), b_point.at(&x));
        for k in 0..3 {
            x[12 + k] += ra[k] - rb[k];
        }
        let m = joint.equations();
        let lambda_ = noise(6)[..m].to_vec();
        let mut jacobian = vec![0.0; m * UNKNOWNS];
        joint.jacobian(Moment::at(0.0), &x, &mut jacobian);
        let on = |first: usize| {
            let vector = |i: usize, of: &dyn Fn(usize) -> f64| {
                Vector3::from_fn(|k, _| of(first + 3 * i + k))
            };
            let f = |j: usize| -> f64 {
                -(0..m).map(|i| lambda_[i] * jacobian[i * UNKNOWNS + j]).sum::<f64>()
            };
            let place = |j: usize| x[j];
            let force = vector(0, &f);
            let about_center: Vector3<f64> =
                (1..4).map(|i| vector(i, &place).cross(&vector(i, &f))).sum();
            let arm = vector(0, &place) - Vector3::from(ra);
            (force, about_center + arm.cross(&force))
        };
        let ((force, moment), (other_force, other_moment)) = (on(0), on(12));
        let reaction = joint.reaction(Moment::at(0.0), &x, &lambda_);
        close(force.as_slice(), &reaction.0, 1e-12, &format!("{name}: force"));
        close(moment.as_slice(), &reaction.1, 1e-12, &format!("{name}: moment"));
        close((-other_force).as_slice(), &reaction.0, 1e-12, &format!("{name}: force on b"));
        close((-other_moment).as_slice(), &reaction.1, 1e-12, &format!("{name}: moment on b"));
    }
}

/// The same for sections of beams, whose gradients are not orthonormal; a torque about the normal does not shear them.
#[test]
fn sections_are_in_balance_and_torques_do_not_shear_them() {
    let mut q = start();
    for k in 0..3 {
        q[12 + k] = q[24 + k];
    }
    for (name, joint) in joints() {
        if !name.contains("of section and other section") || name.contains("Distance") {
            continue;
        }
        let m = joint.equations();
        let lambda_ = noise(6)[..m].to_vec();
        let strained: Vec<f64> =
            (0..UNKNOWNS).map(|i| q[i] + if i >= 30 { 0.1 * noise(8)[i] } else { 0.0 }).collect();
        for x in [&q, &strained] {
            let mut jacobian = vec![0.0; m * UNKNOWNS];
            joint.jacobian(Moment::at(0.0), x, &mut jacobian);
            let force = |at: usize| {
                Vector3::from_fn(|k, _| {
                    -(0..m).map(|i| lambda_[i] * jacobian[i * UNKNOWNS + at + k]).sum::<f64>()
                })
            };
            let place = |at: usize| Vector3::from_column_slice(&x[at..at + 3]);
            let moment = |gradients: [usize; 2]| -> Vector3<f64> {
                gradients.map(|at| place(at).cross(&force(at))).iter().sum()
            };
            let reaction = joint.reaction(Moment::at(0.0), x, &lambda_);
            close(force(24).as_slice(), &reaction.0, 1e-12, &format!("{name}: force"));
            close((-force(12)).as_slice(), &reaction.0, 1e-12, &format!("{name}: force on b"));
            let on_a = moment([30, 33]);
            close(on_a.as_slice(), &reaction.1, 1e-12, &format!("{name}: moment"));
            let on_b = -moment([15, 18]);
            close(on_b.as_slice(), &reaction.1, 1e-12, &format!("{name}: moment on b"));
        }
        if name.contains("Weld") {
            // Shear of the section in its plane, y.dz + z.dy, takes no work.
            let mut jacobian = vec![0.0; m * UNKNOWNS];
            joint.jacobian(Moment::at(0.0), &q, &mut jacobian);
            for (y, z) in [(30, 33), (15, 18)] {
                for row in jacobian.chunks(UNKNOWNS) {
                    let work: f64 =
                        (0..3).map(|k| row[y + k] * q[z + k] + row[z + k] * q[y + k]).sum();
                    assert!(work.abs() < 1e-12, "{name}: {work}");
                }
            }
        }
    }
}

/// A hold is met where it was made; its force is on positions, its moment that of the forces on slopes.
#[test]
fn holds_keep_what_they_find() {
    let q = start();
    for (name, joint) in joints().into_iter().filter(|(name, _)| name == "hold") {
        let mut phi = vec![1.0; joint.equations()];
        joint.residual(Moment::at(0.0), &q, &mut phi);
        close(&phi, &[0.0; 3], 1e-15, &name);
        // The gap gives a force against its direction, the slope a moment along s x d.
        let (force, moment) = joint.reaction(Moment::at(0.0), &q, &[2.0, 3.0, 0.0]);
        close(&force, &[0.0, -1.2, -1.6], 1e-15, &name);
        let slope = Vector3::from_fn(|k, _| 0.8 * q[3 + k] - 0.6 * q[6 + k]);
        let couple = slope.cross(&Vector3::new(-3.0, 0.0, 0.0));
        close(&moment, couple.as_slice(), 1e-15, &name);
    }
}
