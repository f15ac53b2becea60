//! Every kind of force: the stored part against differences of the energy, the tangent against differences of the
//! force, dampers that only take, and the balance of energy in a run.
#![allow(missing_docs, clippy::unwrap_used)]

mod support;

use pliant_dae::generalized_alpha::Options;
use pliant_dae::problem::{Point, Problem, Weights};
use pliant_multibody::model::Model;
use pliant_multibody::run::{Leg, Run, RunOptions, Start};
use pliant_multibody::spec::{
    Array, CableSpec, ForceSpec, JointSpec, LiftSpec, MassSpec, ModelSpec, PointSpec, PullSpec,
    RigidBodySpec, Signal, StopSpec,
};
use pliant_multibody::system::{Mode, System};
use std::f64::consts::PI;
use std::sync::Arc;
use std::time::Duration;

fn body(name: &str, position: [f64; 3], angle: f64) -> RigidBodySpec {
    let (s, c) = angle.sin_cos();
    RigidBodySpec {
        name: name.to_owned(),
        mass: 1.5,
        inertia: [[0.2, 0.0, 0.0], [0.0, 0.3, 0.0], [0.0, 0.0, 0.4]],
        position,
        axes: [[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]],
        velocity: [0.3, -0.1, 0.2],
        angular_velocity: [0.4, 0.3, -0.5],
    }
}

fn on_body(rigid: usize, local: [f64; 3]) -> PointSpec {
    PointSpec::Rigid { rigid, local }
}

/// Two bodies and a point mass, with these joints and forces.
fn document(joints: Vec<JointSpec>, forces: Vec<ForceSpec>) -> ModelSpec {
    let mut document = support::document([0.0; 3], Vec::new(), joints);
    document.rigid_bodies =
        vec![body("left", [0.1, -0.2, 0.3], 0.4), body("right", [0.9, 0.4, -0.1], -0.7)];
    document.shared_points = Array::Inline(vec![0.2, 0.8, 0.5]);
    document.shared_velocities = Array::Inline(vec![-0.3, 0.1, 0.7]);
    let at = PointSpec::Shared { shared: 0 };
    document.masses = vec![MassSpec { name: "ball".to_owned(), mass: 0.8, at }];
    if forces.iter().any(|force| matches!(force, ForceSpec::Wind { .. })) {
        let soft = |x| Array::Inline(vec![x]);
        document.cables = vec![CableSpec {
            axial_stiffness: soft(40.0),
            bending_stiffness: soft(0.05),
            mass_per_length: soft(0.3),
            ..support::straight_cable("line", 3, 1.2)
        }];
    }
    let on_sheet =
        |f: &ForceSpec| matches!(f, ForceSpec::SheetWind { .. } | ForceSpec::Curvature { .. });
    if forces.iter().any(on_sheet) {
        document.surfaces = vec![support::sheet([2, 1], [0.4, 0.5], 40.0, 0.1)];
    }
    document.forces = forces;
    document
}

/// One of each kind and of each of its cases, with the joints that it needs.
fn specs() -> Vec<(Vec<JointSpec>, ForceSpec)> {
    let spring = |a, b, [stiffness, damping, length]: [f64; 3]| {
        let name = "spring".to_owned();
        (Vec::new(), ForceSpec::Spring { name, a, b, stiffness, damping, length })
    };
    let ball = || PointSpec::Shared { shared: 0 };
    let world_hinge = || {
        let name = "hinge".to_owned();
        let (s, c) = 0.4_f64.sin_cos();
        let world = [0.1 + 0.3 * c + 0.2 * s, -0.2 + 0.3 * s - 0.2 * c, 0.8];
        let (a, b) = (on_body(0, [0.3, -0.2, 0.5]), PointSpec::World { world });
        JointSpec::Hinge { name, a, b, axis: [0.0, 0.6, 0.8] }
    };
    let pair_slider = || {
        let name = "slider".to_owned();
        // The centre of the right body, seen from the left one.
        let ((s, c), d) = (0.4_f64.sin_cos(), [0.8, 0.6, -0.4]);
        let local = [c * d[0] + s * d[1], c * d[1] - s * d[0], d[2]];
        let (a, b) = (on_body(0, local), on_body(1, [0.0; 3]));
        JointSpec::Slider { name, a, b, axis: [0.6, 0.0, 0.8] }
    };
    let along = |joint: JointSpec, stops: Option<StopSpec>, drive: Option<Signal>| {
        let (name, stiffness, damping) = ("along".to_owned(), 8.0, 0.7);
        let damping = if stops.is_some() { 0.0 } else { damping };
        let force =
            ForceSpec::Joint { name, joint: 0, stiffness, damping, rest: 0.3, stops, drive };
        (vec![joint], force)
    };
    let stops = |lower: f64, upper: f64| {
        Some(StopSpec { lower: Some(lower), upper: Some(upper), stiffness: 60.0, damping: 0.4 })
    };
    let torque = || {
        let ramp = Signal::Ramp { duration: 1.0 };
        Some(Signal::Product(vec![Signal::Constant(vec![0.6]), ramp]))
    };
    let world = || PointSpec::World { world: [0.3, 0.2, -0.6] };
    let tendon = |pull, friction| {
        let points = vec![
            on_body(0, [0.3, -0.2, 0.5]),
            ball(),
            on_body(1, [-0.1, 0.4, 0.2]),
            PointSpec::World { world: [1.5, -0.8, 0.4] },
        ];
        let name = "tendon".to_owned();
        (Vec::new(), ForceSpec::Tendon { name, points, pull, friction, slip_velocity: 0.4 })
    };
    let rising = || {
        Signal::Sum(vec![
            Signal::Constant(vec![2.0]),
            Signal::Product(vec![Signal::Constant(vec![-0.4]), Signal::Ramp { duration: 1.5 }]),
        ])
    };
    let motor = |damping| PullSpec::Motor { length: rising(), stiffness: 25.0, damping };
    let wind = |lift| ForceSpec::Wind {
        name: "wind".to_owned(),
        cable: 0,
        velocity: Signal::Constant(vec![1.0, -2.0, 0.7]),
        direction: [0.3, -0.8, 0.4],
        density: 1.2,
        drag: 1.1,
        lift,
        diameters: vec![0.2, 0.25, 0.3],
    };
    let faces = || Array::Inline(vec![0.0, 1.0]);
    let sheet_wind = |lift| ForceSpec::SheetWind {
        name: "wind".to_owned(),
        surface: 0,
        faces: faces(),
        velocity: Signal::Constant(vec![1.0, -2.0, 0.7]),
        density: 1.2,
        drag: 1.1,
        lift,
    };
    let bending = || ForceSpec::Curvature {
        name: "curvature".to_owned(),
        surface: 0,
        faces: faces(),
        value: Signal::Product(vec![
            Signal::Constant(vec![0.8, -0.5, 0.3]),
            Signal::Ramp { duration: 1.5 },
        ]),
        steady: false,
    };
    let angles: Vec<f64> = (0..=24).map(|i| PI * (f64::from(i) / 12.0 - 1.0)).collect();
    let coefficients = angles.iter().map(|a| 0.4 - 0.8 * a.sin() + 0.2 * (2.0 * a).cos()).collect();
    vec![
        tendon(PullSpec::Force { tension: rising() }, 0.0),
        tendon(PullSpec::Force { tension: rising() }, 0.6),
        tendon(motor(0.0), 0.0),
        tendon(motor(3.0), 0.3),
        (Vec::new(), wind(LiftSpec::Constant(0.5))),
        (Vec::new(), wind(LiftSpec::Angle { angles, coefficients })),
        (Vec::new(), bending()),
        (Vec::new(), sheet_wind(1.1)),
        (Vec::new(), sheet_wind(0.4)),
        spring(on_body(0, [0.3, -0.2, 0.5]), on_body(1, [-0.1, 0.4, 0.2]), [30.0, 0.0, 0.7]),
        spring(on_body(0, [0.3, -0.2, 0.5]), ball(), [30.0, 4.0, 0.7]),
        spring(ball(), world(), [30.0, 4.0, 0.0]),
        along(world_hinge(), None, None),
        along(world_hinge(), None, torque()),
        along(pair_slider(), None, torque()),
        along(world_hinge(), stops(-0.03, 0.02), None),
        along(pair_slider(), stops(-0.01, 0.02), None),
    ]
}

fn motor_without_damping() -> PullSpec {
    PullSpec::Motor { length: Signal::Constant(vec![1.9]), stiffness: 25.0, damping: 0.0 }
}

/// Pulls, friction and sliding of a tendon bring down the tension by the formula of Euler, and takes energy only.
#[test]
fn tension_falls_by_the_capstan_formula() {
    let friction = 0.7;
    let points = vec![
        PointSpec::World { world: [0.0, -1.0, 0.0] },
        PointSpec::World { world: [0.0, 0.0, 0.0] },
        PointSpec::World { world: [1.0, 0.0, 0.0] },
        PointSpec::Shared { shared: 0 },
    ];
    let spec = ForceSpec::Tendon {
        name: "tendon".to_owned(),
        points,
        pull: PullSpec::Force { tension: Signal::Constant(vec![5.0]) },
        friction,
        slip_velocity: 1e-3,
    };
    let mut document = document(Vec::new(), vec![spec]);
    document.shared_points = Array::Inline(vec![2.0, 1.0, 0.0]);
    let model = Arc::new(Model::new(&document, &[]).unwrap());
    let system = System::new(model.clone(), Mode::Dynamic, None, false);
    let ball = model.map().shared[0];
    for slide in [-1.0, 1.0] {
        let mut v = vec![0.0; model.coordinates()];
        // Away from the last guide: the tendon slides to the fastened end.
        v[ball] = slide;
        v[ball + 1] = slide;
        let mut out = Vec::new();
        let rest = vec![0.0; v.len()];
        let at = Point { t: 0.0, q: model.initial_q(), v: &v, a: &rest, lambda_: &[] };
        system.outputs(at, &mut out);
        for (tension, wrap) in out[1..].iter().zip([0.0, PI / 2.0, 0.75 * PI]) {
            let expected = 5.0 * (slide * friction * wrap).exp();
            assert!((tension / expected - 1.0).abs() < 1e-12, "{tension} {expected}");
        }
    }
}

fn model(joints: Vec<JointSpec>, force: ForceSpec) -> Arc<Model> {
    Arc::new(Model::new(&document(joints, vec![force]), &[]).unwrap())
}

fn moved(x: &[f64], by: &[f64], factor: f64) -> Vec<f64> {
    x.iter().zip(by).map(|(x, d)| x + factor * d).collect()
}

fn noise(n: usize, seed: f64) -> Vec<f64> {
    (0..n).map(|i| (1.7 * (i + 1) as f64 + 12.3 * seed).sin()).collect()
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// What the forces add to the left-hand side: the residual without inertia, weight and multipliers.
fn force(system: &mut System, q: &[f64], v: &[f64]) -> Vec<f64> {
    let (n, m) = (system.velocities(), system.multipliers());
    let (mut force, mut phi) = (vec![0.0; n], vec![0.0; m]);
    let at = Point { t: 0.3, q, v, a: &vec![0.0; n], lambda_: &vec![0.0; m] };
    system.residual(at, &mut force, &mut phi).unwrap();
    force
}

#[test]
fn every_kind_is_here() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/src/forces");
    let files = std::fs::read_dir(folder).unwrap().count() - 1;
    let mut kinds: Vec<String> = Vec::new();
    for (_, spec) in specs() {
        let text = format!("{spec:?}");
        kinds.push(text.split(' ').next().unwrap().to_owned());
    }
    kinds.dedup();
    assert_eq!(files, kinds.len(), "{kinds:?}");
}

#[test]
fn stored_forces_are_derivatives_of_the_energy() {
    let stored = |spec: &ForceSpec| match spec {
        ForceSpec::Tendon { pull, .. } => matches!(pull, PullSpec::Motor { .. }),
        ForceSpec::Wind { .. }
        | ForceSpec::SheetWind { .. }
        | ForceSpec::Joint { drive: Some(_), .. } => false,
        _ => true,
    };
    for (joints, spec) in specs().into_iter().filter(|(_, spec)| stored(spec)) {
        // A damped motor that turns pulls at rest, too.
        let spec = match spec {
            ForceSpec::Tendon { name, points, friction, slip_velocity, .. } => ForceSpec::Tendon {
                name,
                points,
                pull: motor_without_damping(),
                friction,
                slip_velocity,
            },
            other => other,
        };
        let model = model(joints, spec.clone());
        let n = model.coordinates();
        let mut system = System::new(model.clone(), Mode::Dynamic, None, false);
        system.begin(0.3, model.initial_q());
        let q = moved(model.initial_q(), &noise(n, 2.0), 0.1);
        let (by, rest) = (noise(n, 3.0), vec![0.0; n]);
        let h = 1e-4;
        let energy = |factor: f64| system.energy(0.3, &moved(&q, &by, factor), &rest)[1];
        let slope = (energy(h) - energy(-h)) / (2.0 * h);
        let found = dot(&force(&mut system, &q, &rest), &by);
        // Central differences: h^2 times third derivatives of some hundreds.
        assert!((slope - found).abs() < 1e-5, "{spec:?}: {found} and {slope}");
    }
}

#[test]
fn tangents_are_derivatives_of_forces() {
    for (joints, spec) in specs() {
        let model = model(joints, spec.clone());
        let n = model.coordinates();
        let mut system = System::new(model.clone(), Mode::Dynamic, None, false);
        system.begin(0.3, model.initial_q());
        let (q, v) = (moved(model.initial_q(), &noise(n, 2.0), 0.1), noise(n, 4.0));
        let by = noise(n, 3.0);
        let h = 1e-5;
        for (stiffness, damping) in [(1.0, 0.0), (0.0, 1.0)] {
            let mut at = |factor: f64| {
                let (dq, dv) = (factor * stiffness, factor * damping);
                force(&mut system, &moved(&q, &by, dq), &moved(&v, &by, dv))
            };
            let (plus, minus) = (at(h), at(-h));
            let weights = Weights { mass: 0.0, damping, stiffness, jacobian: 0.0 };
            let m = system.multipliers();
            let point = Point { t: 0.3, q: &q, v: &v, a: &vec![0.0; n], lambda_: &vec![0.0; m] };
            let mut values = vec![0.0; system.structure().values()];
            system.tangent(point, weights, &mut values);
            let (mut x, mut out) = (by.clone(), vec![0.0; n + m]);
            x.resize(n + m, 0.0);
            system.structure().multiply_add(&values, &x, &mut out, false);
            for i in 0..n {
                let slope = (plus[i] - minus[i]) / (2.0 * h);
                // h^2 times third derivatives of some thousands, and rounding over h.
                let tolerance = 1e-6 * slope.abs().max(1.0);
                assert!(
                    (slope - out[i]).abs() < tolerance,
                    "{spec:?}, row {i}: {} and {slope}",
                    out[i]
                );
            }
        }
    }
}

/// Errors in the balance of energy over two seconds at steps h and h/2: second order, and small.
#[test]
fn energy_is_accounted_for() {
    for (joints, spec) in specs() {
        let drift = |h: f64| {
            let options = RunOptions { integrator: Options::default(), threads: 1 };
            let model = model(joints.clone(), spec.clone());
            let (mut run, _) = Run::new(model, &options, Start::default()).unwrap();
            run.record().unwrap();
            let steps = (2.0 / h).round() as u64;
            let leg = Leg { steps, step: h, end: None, output_every: steps };
            run.advance(leg, Duration::MAX).unwrap();
            let energy = run.take_records().energy;
            let total = |row: &[f64]| row[0] + row[1] + row[2] + row[3] - row[4];
            (total(&energy[5..]) - total(&energy[..5]), energy[8])
        };
        let ((coarse, _), (fine, lost)) = (drift(4e-3), drift(2e-3));
        let order = (coarse / fine).abs().log2();
        // Where a stop is met within a step, single steps lose an order: little, and of either sign.
        assert!(order > 1.7 || fine.abs() < 1e-5, "{spec:?}: {coarse:.2e}, {fine:.2e}");
        // Of some joules in play, with a hundred steps a period.
        assert!(fine.abs() < 1e-3, "{spec:?}: {fine:.2e}");
        assert!(lost >= 0.0, "{spec:?} gave {lost}");
    }
}
