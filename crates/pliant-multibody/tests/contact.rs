//! Contact in the problem that the solvers see: its tangent, its structure, its memory.

#![allow(clippy::unwrap_used)]

mod support;

use pliant_dae::generalized_alpha::Options;
use pliant_dae::problem::{Point, Problem, Weights};
use pliant_multibody::model::Model;
use pliant_multibody::run::{Leg, Run, RunOptions, Start};
use pliant_multibody::spec::{Array, ContactSpec, FrictionSpec, MasterSpec, ModelSpec, ShapeSpec};
use pliant_multibody::system::{Mode, System};
use std::sync::Arc;
use std::time::Duration;
use support::{document, straight_cable};

fn friction() -> FrictionSpec {
    FrictionSpec::Lugre {
        mu_s: 0.5,
        mu_d: 0.4,
        v_s: 1e-2,
        alpha: 2.0,
        sigma_0: 1e4,
        sigma_1: 6.0,
        sigma_2: 0.1,
        v_d: 5e-2,
        scaled: true,
    }
}

/// A cable that crosses another half a radius deep and lies in the ground.
fn crossing(friction: Option<FrictionSpec>) -> ModelSpec {
    crossing_at(friction, [0.0, 1.0])
}

/// The same in a direction of the plane; one that leans crosses the lower cable where two of its elements meet.
fn crossing_at(friction: Option<FrictionSpec>, along: [f64; 2]) -> ModelSpec {
    let low = straight_cable("low", 6, 1.0);
    let mut high = straight_cable("high", 7, 1.0);
    let nodes = 8;
    let l = 1.0 / 7.0;
    let [x, y] = along;
    let middle = if x == 0.0 { 0.47 } else { 0.5 };
    let place = |i: usize| {
        let s = l * i as f64 - 0.52;
        [middle + x * s, y * s, 0.0075]
    };
    high.r = Array::Inline((0..nodes).flat_map(place).collect());
    high.t = Array::Inline((0..nodes).flat_map(|_| [x, y, 0.0]).collect());
    let mut spec = document([0.0, 0.0, -9.81], vec![low, high], Vec::new());
    let contact = |name: &str, slave, master| ContactSpec {
        name: name.to_owned(),
        slave,
        master,
        stiffness: 1e6,
        ramp: 2e-3,
        damping: 2.0,
        friction: friction.clone(),
        window: 0.0,
        apart: Array::Inline(Vec::new()),
    };
    let ground = MasterSpec::Shape {
        origin: [0.0, 0.0, -4e-3],
        axes: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        shape: ShapeSpec::HalfSpace,
    };
    spec.contacts =
        vec![contact("both", 1, MasterSpec::Line { line: 0 }), contact("ground", 0, ground)];
    spec
}

fn numbers(n: usize, size: f64, seed: usize) -> Vec<f64> {
    (0..n).map(|i| size * ((i * 7919 + seed * 104_729) as f64 * 0.61803).sin()).collect()
}

#[test]
fn tangent_is_the_derivative_of_the_residual() {
    for (along, pairs) in [([0.0, 1.0], 1), ([0.6, 0.8], 2)] {
        check_tangent(crossing_at(None, along), pairs, false);
        check_tangent(crossing_at(Some(friction()), along), pairs, true);
    }
}

fn check_tangent(spec: ModelSpec, pairs: usize, full: bool) {
    let model = Arc::new(Model::new(&spec, &[]).unwrap());
    let mut system = System::new(model.clone(), Mode::Dynamic, None, false);
    let none = system.structure().elements();
    let n = system.velocities();
    let start: Vec<f64> = model.initial_q().to_vec();
    let still = vec![0.0; n];
    system.note_loads(Point { t: 0.0, q: &start, v: &still, a: &still, lambda_: &[] });
    let q: Vec<f64> = start.iter().zip(numbers(n, 2e-5, 1)).map(|(q, d)| q + d).collect();
    let v = numbers(n, 2e-3, 2);
    let zero = vec![0.0; n];
    let at = |q: &[f64], v: &[f64], system: &mut System| {
        let mut force = vec![0.0; n];
        let point = Point { t: 1e-3, q, v, a: &zero, lambda_: &[] };
        system.residual(point, &mut force, &mut []).unwrap();
        force
    };
    let mut values = Vec::new();
    for (stiffness, damping) in [(1.0, 0.0), (0.0, 1.0)] {
        let weights = Weights { mass: 0.0, damping, stiffness, jacobian: 1.0 };
        let point = Point { t: 1e-3, q: &q, v: &v, a: &zero, lambda_: &[] };
        system.tangent(point, weights, &mut values);
        assert_eq!(values.len(), system.structure().values());
        assert_eq!(system.structure().elements(), none + 6 + pairs);
        assert_eq!(system.structure().is_symmetric(), !full);
        let d = numbers(n, 1.0, 3);
        let mut product = vec![0.0; n];
        system.structure().multiply_add(&values, &d, &mut product, false);
        let e = 1e-8;
        let moved = |x: &[f64], factor: f64| -> Vec<f64> {
            x.iter().zip(&d).map(|(x, d)| x + factor * e * d).collect()
        };
        let (up, down) = if stiffness > 0.0 {
            (at(&moved(&q, 1.0), &v, &mut system), at(&moved(&q, -1.0), &v, &mut system))
        } else {
            (at(&q, &moved(&v, 1.0), &mut system), at(&q, &moved(&v, -1.0), &mut system))
        };
        let mut worst = 0.0_f64;
        let mut size = 0.0_f64;
        for i in 0..n {
            let difference = (up[i] - down[i]) / (2.0 * e);
            worst = worst.max((difference - product[i]).abs());
            size = size.max(difference.abs());
        }
        // Rounding of forces of 1e4 N over 1e-8; without friction what is not symmetric: the damping's share, and what
        // five points miss of the ramp.
        let allowed = if full { 1e-6 } else { 2e-2 };
        assert!(worst < allowed * size, "{worst} of {size}, {pairs} pairs, {full}, {weights:?}");
    }
}

#[test]
fn structure_grows_with_what_touches_and_forgets_it() {
    let model = Arc::new(Model::new(&crossing(Some(friction())), &[]).unwrap());
    let mut system = System::new(model.clone(), Mode::Dynamic, None, false);
    let n = system.velocities();
    let zero = vec![0.0; n];
    let touching = model.initial_q().to_vec();
    let mut apart = touching.clone();
    // The upper cable's positions come after the lower one's seven nodes.
    for node in 7..15 {
        apart[6 * node + 2] += 0.1;
    }
    let weights = Weights { mass: 1.0, damping: 0.0, stiffness: 1.0, jacobian: 1.0 };
    let mut values = Vec::new();
    let none = system.structure().elements();
    let mut elements = |q: &[f64], system: &mut System| {
        let point = Point { t: 0.0, q, v: &zero, a: &zero, lambda_: &[] };
        system.tangent(point, weights, &mut values);
        system.structure().elements()
    };
    // One for each of the six elements of the lower cable, which lies in the ground, and one for the crossing.
    let both = elements(&touching, &mut system);
    assert_eq!(both, none + 6 + 1);
    let version = system.structure().version();
    assert_eq!(elements(&apart, &mut system), both);
    assert_eq!(system.structure().version(), version);
    let point = |q| Point { t: 0.0, q, v: &zero, a: &zero, lambda_: &[] };
    for _ in 0..22 {
        system.accept(point(&apart), point(&apart));
    }
    assert_eq!(elements(&apart, &mut system), none + 6);
    assert!(system.structure().version() > version);
}

#[test]
fn a_zone_is_one_record_however_the_lines_run() {
    // A cable along another, over several elements of both, which end at different places.
    let mut forces = Vec::new();
    for (sign, begin) in [(1.0, -0.1), (-1.0, 1.1)] {
        let low = straight_cable("low", 6, 1.2);
        let mut master = low.clone();
        let x = |i: usize| begin + sign * 0.2 * i as f64;
        master.r = Array::Inline((0..7).flat_map(|i| [x(i), 0.0, 0.0]).collect());
        master.t = Array::Inline((0..7).flat_map(|_| [sign, 0.0, 0.0]).collect());
        let mut high = straight_cable("high", 7, 0.9);
        let y = |i: usize| 0.9 / 7.0 * i as f64;
        high.r = Array::Inline((0..8).flat_map(|i| [y(i), 0.0, 9.9e-3]).collect());
        let mut spec = document([0.0; 3], vec![master, high], Vec::new());
        spec.contacts = crossing(None).contacts;
        spec.contacts.truncate(1);
        let model = Arc::new(Model::new(&spec, &[]).unwrap());
        let options = RunOptions { integrator: Options::default(), threads: 1 };
        let mut run = Run::new(model, &options, Start::default()).unwrap().0;
        // A step so short that nothing moves by 1e-9 m.
        let leg = Leg { steps: 1, step: 1e-9, end: None, output_every: 0 };
        run.advance(leg, Duration::MAX).unwrap();
        let records = run.present().patches;
        // The zone, and the free ends of the upper cable.
        assert_eq!(records.len(), 3, "{sign}: {records:?}");
        assert!(records.iter().all(|record| (record[7] + 1e-4).abs() < 1e-9), "{records:?}");
        forces.push(records.iter().map(|record| record[8]).fold(0.0, f64::max));
    }
    // Rounding.
    assert!((forces[0] / forces[1] - 1.0).abs() < 1e-9, "{forces:?}");
}
