//! Drives and gears: Jacobian, rate, acceleration and jerk of each against differences along a curve q(t) that moves
//! as the drive does not, Hessians against differences of Jacobians.

mod support;

use pliant_dae::problem::{Point, Problem, Weights};
use pliant_multibody::model::Model;
use pliant_multibody::spec::{JointSpec, ModelSpec, PointSpec, RigidBodySpec, Signal};
use pliant_multibody::system::{Mode, System};
use std::sync::Arc;

fn body(name: &str, position: [f64; 3]) -> RigidBodySpec {
    RigidBodySpec {
        name: name.to_owned(),
        mass: 1.5,
        inertia: [[0.2, 0.0, 0.0], [0.0, 0.3, 0.0], [0.0, 0.0, 0.4]],
        position,
        axes: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        velocity: [0.0; 3],
        angular_velocity: [0.0; 3],
    }
}

/// A cable along x, two bodies on a hinge and a slider, and a drive or gear as joint 2.
fn document(driven: JointSpec) -> ModelSpec {
    let hinge = JointSpec::Hinge {
        name: "hinge".to_owned(),
        a: PointSpec::Rigid { rigid: 0, local: [0.1, 0.2, 0.3] },
        b: PointSpec::World { world: [0.1, 2.2, 0.3] },
        axis: [0.0, 0.6, 0.8],
    };
    let slider = JointSpec::Slider {
        name: "slider".to_owned(),
        a: PointSpec::Rigid { rigid: 1, local: [0.0, 1.0, 0.0] },
        b: PointSpec::Rigid { rigid: 0, local: [0.0, 2.0, 0.0] },
        axis: [0.6, 0.8, 0.0],
    };
    let cables = vec![support::straight_cable("rope", 2, 1.0)];
    let mut document = support::document([0.0; 3], cables, vec![hinge, slider, driven]);
    document.rigid_bodies = vec![body("arm", [0.0, 2.0, 0.0]), body("block", [0.0, 3.0, 0.0])];
    document
}

/// A smooth signal of one or three components with all derivatives.
fn smooth(amplitudes: &[f64]) -> Signal {
    let times: Vec<f64> = (0..=40).map(|i| 0.05 * f64::from(i)).collect();
    let row = |t: f64| amplitudes.iter().map(move |a| a * (3.0 * t).sin());
    let values = times.iter().flat_map(|&t| row(t)).collect();
    let table = Signal::Table { times, values, period: None, smooth: true };
    Signal::Product(vec![Signal::Ramp { duration: 0.9 }, table])
}

fn specs() -> Vec<JointSpec> {
    let name = || "drive".to_owned();
    let end = || PointSpec::Cable { cable: 0, element: 1, xi: 1.0 };
    let sum = |first: [f64; 3], amplitudes: [f64; 3]| {
        Signal::Sum(vec![Signal::Constant(first.to_vec()), smooth(&amplitudes)])
    };
    vec![
        JointSpec::DrivePoint {
            name: name(),
            a: end(),
            position: Some(sum([1.0, 0.0, 0.0], [0.3, -0.2, 0.4])),
            direction: Some(sum([1.5, 0.0, 0.0], [0.3, 1.8, -0.9])),
            orientation: None,
        },
        JointSpec::DrivePoint {
            name: name(),
            a: PointSpec::Rigid { rigid: 1, local: [0.1, 0.0, 0.2] },
            position: Some(sum([0.1, 3.0, 0.2], [0.3, -0.2, 0.4])),
            direction: None,
            orientation: Some(Box::new([
                sum([1.0, 0.0, 0.0], [0.3, 0.1, 0.2]),
                sum([0.0, 1.0, 0.0], [0.3, 0.1, -0.2]),
                sum([0.0, 0.0, 1.0], [-0.3, 0.1, 0.2]),
            ])),
        },
        JointSpec::DriveJoint { name: name(), joint: 0, value: smooth(&[0.7]), rate: false },
        JointSpec::DriveJoint { name: name(), joint: 1, value: smooth(&[0.7]), rate: false },
        JointSpec::DriveJoint { name: name(), joint: 0, value: smooth(&[0.7]), rate: true },
        JointSpec::DriveAxis {
            name: name(),
            a: PointSpec::Rigid { rigid: 0, local: [0.0; 3] },
            axis: [0.0, 0.0, 1.0],
            value: smooth(&[0.5]),
            rate: false,
        },
        JointSpec::Gear { name: name(), joint_a: 0, joint_b: 1, ratio: 2.3 },
    ]
}

fn noise(n: usize, seed: f64) -> Vec<f64> {
    (0..n).map(|i| 0.3 * (1.7 * (i + 1) as f64 + 12.3 * seed).sin()).collect()
}

fn close(a: &[f64], b: &[f64], tolerance: f64, what: &str) {
    for (k, (a, b)) in a.iter().zip(b).enumerate() {
        assert!((a - b).abs() < tolerance, "{what}, entry {k}: {a} and {b}");
    }
}

#[test]
fn derivatives_agree_with_differences_along_a_curve() {
    for spec in specs() {
        let model = Arc::new(Model::new(&document(spec.clone()), &[]).unwrap());
        let (n, m) = (model.coordinates(), model.multipliers());
        let mut system = System::new(model.clone(), Mode::Dynamic, None, false);
        // Within one piece of the table, where Gauss's rule is exact.
        system.begin(0.36, model.initial_q());
        let (t_0, v, a) = (0.37, noise(n, 3.0), noise(n, 4.0));
        let q_0: Vec<f64> =
            model.initial_q().iter().zip(noise(n, 2.0)).map(|(q, d)| q + 0.1 * d).collect();
        let lambda_ = noise(m, 5.0);
        let place = |s: f64| -> Vec<f64> {
            (0..n).map(|i| q_0[i] + s * v[i] + 0.5 * s * s * a[i]).collect()
        };
        let mut phi = |s: f64| {
            let (mut force, mut phi, q, zero) =
                (vec![0.0; n], vec![0.0; m], place(s), vec![0.0; n]);
            let at = Point { t: t_0 + s, q: &q, v: &zero, a: &zero, lambda_: &lambda_ };
            system.residual(at, &mut force, &mut phi).unwrap();
            phi
        };
        // Derivatives along the curve: central differences of sixth and, for the third, fourth order.
        let h = 2e-3;
        let f: Vec<Vec<f64>> = (-3..=3).map(|k| phi(f64::from(k) * h)).collect();
        let combine = |weights: [f64; 7], order: i32| -> Vec<f64> {
            (0..m)
                .map(|i| (0..7).map(|k| weights[k] * f[k][i]).sum::<f64>() / h.powi(order))
                .collect()
        };
        let first = [-1.0 / 60.0, 0.15, -0.75, 0.0, 0.75, -0.15, 1.0 / 60.0];
        let second = [1.0 / 90.0, -0.15, 1.5, -49.0 / 18.0, 1.5, -0.15, 1.0 / 90.0];
        let third = [0.125, -1.0, 1.625, 0.0, -1.625, 1.0, -0.125];
        let at = Point { t: t_0, q: &q_0, v: &v, a: &a, lambda_: &lambda_ };
        let mut values = vec![0.0; system.structure().values()];
        let weights = Weights { mass: 0.0, damping: 0.0, stiffness: 0.0, jacobian: 1.0 };
        system.tangent(at, weights, &mut values);
        let times = |system: &System, x: &[f64]| {
            let (mut x, mut out) = (x.to_vec(), vec![0.0; n + m]);
            x.resize(n + m, 0.0);
            system.structure().multiply_add(&values, &x, &mut out, false);
            out[n..].to_vec()
        };
        let add =
            |a: Vec<f64>, b: &[f64]| -> Vec<f64> { a.iter().zip(b).map(|(a, b)| a + b).collect() };
        let mut rest = vec![0.0; m];
        system.constraint_rate(t_0, &q_0, &mut rest);
        close(
            &add(times(&system, &v), &rest),
            &combine(first, 1),
            1e-9,
            &format!("{spec:?}: rate"),
        );
        system.constraint_acceleration(at, &mut rest);
        let found = add(times(&system, &a), &rest);
        close(&found, &combine(second, 2), 1e-6, &format!("{spec:?}: acceleration"));
        system.constraint_jerk(at, &mut rest);
        // Fourth order in h, derivatives of some hundreds, rounding 1e-16/h^3.
        close(&rest, &combine(third, 3), 2e-5, &format!("{spec:?}: jerk"));
    }
}

#[test]
fn hessians_are_derivatives_of_jacobians() {
    for spec in specs() {
        let model = Arc::new(Model::new(&document(spec.clone()), &[]).unwrap());
        let (n, m) = (model.coordinates(), model.multipliers());
        let mut system = System::new(model.clone(), Mode::Dynamic, None, false);
        // Within one piece of the table, where Gauss's rule is exact.
        system.begin(0.36, model.initial_q());
        let (by, zero, lambda_) = (noise(n, 3.0), vec![0.0; n], noise(m, 5.0));
        let mut force = |factor: f64, lambda_: &[f64]| {
            let q: Vec<f64> =
                model.initial_q().iter().zip(&by).map(|(q, d)| q + (0.2 + factor) * d).collect();
            let (mut force, mut phi) = (vec![0.0; n], vec![0.0; m]);
            let at = Point { t: 0.37, q: &q, v: &zero, a: &zero, lambda_ };
            system.residual(at, &mut force, &mut phi).unwrap();
            (q, force)
        };
        let h = 1e-5;
        let ((_, plus), (_, minus)) = (force(h, &lambda_), force(-h, &lambda_));
        let (q, _) = force(0.0, &lambda_);
        let weights = Weights { mass: 0.0, damping: 0.0, stiffness: 1.0, jacobian: 0.0 };
        let at = Point { t: 0.37, q: &q, v: &zero, a: &zero, lambda_: &lambda_ };
        let mut values = vec![0.0; system.structure().values()];
        system.tangent(at, weights, &mut values);
        let (mut x, mut out) = (by.clone(), vec![0.0; n + m]);
        x.resize(n + m, 0.0);
        system.structure().multiply_add(&values, &x, &mut out, false);
        let scale = out[..n].iter().fold(1.0_f64, |s, x| s.max(x.abs()));
        for i in 0..n {
            let slope = (plus[i] - minus[i]) / (2.0 * h);
            // h^2 times third derivatives, and rounding of stiff elements over h.
            assert!((slope - out[i]).abs() < 1e-6 * scale, "{spec:?}, {i}: {} {slope}", out[i]);
        }
    }
}
