//! Equilibria that are stable: a slack steel rope, a strut, a run that starts at rest.

#![allow(clippy::unwrap_used)]

mod support;

use pliant_dae::error::Error;
use pliant_dae::generalized_alpha::Options;
use pliant_multibody::altered::Altered;
use pliant_multibody::model::Model;
use pliant_multibody::run::{Leg, Run, RunOptions, Start};
use pliant_multibody::solve::{Path, StaticOptions, statics};
use pliant_multibody::spec::{Array, JointSpec, LoadSpec, ModelSpec, PointSpec, Signal};
use std::f64::consts::PI;
use std::sync::Arc;
use std::time::{Duration, Instant};

const STABLE: StaticOptions = StaticOptions {
    load_steps: 1,
    tolerance: None,
    stable: true,
    arc_length: false,
    chosen: None,
    fade: false,
};

fn solve(model: &Arc<Model>, options: &StaticOptions) -> (Path, Result<(), Error>) {
    let begin = Instant::now();
    let found = statics(model, options, (None, None), None, &mut |_| true);
    println!("{:?} after {:?}", found.1, begin.elapsed());
    found
}

fn pin(name: &str, element: usize, xi: f64, world: [f64; 3]) -> JointSpec {
    JointSpec::Pin {
        name: name.to_owned(),
        a: PointSpec::Cable { cable: 0, element, xi },
        b: PointSpec::World { world },
    }
}

/// A steel rope of 4.2 m between pins 4 m apart, given straight.
fn rope(elements: usize) -> ModelSpec {
    let mut cable = support::straight_cable("rope", elements, 4.0);
    let area = PI * 4e-6;
    cable.lengths = Array::Inline(vec![4.2 / elements as f64; elements]);
    let stretch = 4.0 / 4.2;
    cable.t = Array::Inline((0..=elements).flat_map(|_| [stretch, 0.0, 0.0]).collect());
    cable.axial_stiffness = Array::Inline(vec![2.1e11 * area]);
    cable.bending_stiffness = Array::Inline(vec![2.1e11 * PI * 16e-12 / 4.0]);
    cable.mass_per_length = Array::Inline(vec![7850.0 * area]);
    let pins = vec![pin("a", 0, 0.0, [0.0; 3]), pin("b", elements - 1, 1.0, [4.0, 0.0, 0.0])];
    support::document([0.0, 0.0, -9.81], vec![cable], pins)
}

/// Kinetic energy after 0.2 s from the last equilibrium.
fn kinetic_energy(model: &Arc<Model>, path: &Path) -> f64 {
    let n = model.coordinates();
    let q = &path.records.q[path.records.q.len() - n..];
    let integrator = Options { spectral_radius: 0.8, ..Options::default() };
    let options = RunOptions { integrator, threads: 1 };
    let start = Start { q: Some(q), ..Start::default() };
    let (mut run, _) = Run::new(model.clone(), &options, start).unwrap();
    let leg = Leg { steps: 200, step: 1e-3, end: None, output_every: 0 };
    run.advance(leg, Duration::MAX).unwrap();
    model.energy(&Altered::new(model), q, &run.state().v)[0]
}

#[test]
fn a_slack_steel_rope_hangs() {
    let model = Arc::new(Model::new(&rope(24), &[]).unwrap());
    let (path, outcome) = solve(&model, &STABLE);
    outcome.unwrap();
    assert!(path.unstable.is_empty());
    let q = &path.records.q;
    let sag = -q[6 * 12 + 2];
    // Catenary of length 4.2 m over 4 m: 2 a sinh(2 / a) = 4.2; its stretch is 1e-6; its bending
    // stiffness, sqrt(EI / H) = 0.86 m, changes the shape and so the sag by 2.4 %.
    let (mut low, mut high) = (0.5_f64, 50.0_f64);
    for _ in 0..80 {
        let a = 0.5 * (low + high);
        if 2.0 * a * (2.0 / a).sinh() > 4.2 { low = a } else { high = a }
    }
    let exact = low * ((2.0 / low).cosh() - 1.0);
    println!("sag {sag} against {exact}");
    assert!((sag / exact - 1.0).abs() < 0.03);
    let weight = 7850.0 * PI * 4e-6 * 4.2 * 9.81;
    let lambda_ = &path.records.lambda_;
    for z in [lambda_[2], lambda_[5]] {
        assert!((z.abs() - 0.5 * weight).abs() < 1e-6 * weight, "{z} against {weight}");
    }
    let mut force = Vec::new();
    model.axial_force(0, &Altered::new(&model), q, &mut force);
    assert!(force.iter().all(|f| *f > 0.0), "{force:?}");
    let kinetic = kinetic_energy(&model, &path);
    println!("kinetic energy {kinetic:e}");
    assert!(kinetic < 1e-20);
}

#[test]
fn an_unstable_equilibrium_is_kept_on_purpose_and_told() {
    let model = Arc::new(Model::new(&rope(24), &[]).unwrap());
    let (path, outcome) = solve(&model, &StaticOptions { stable: false, ..STABLE });
    outcome.unwrap();
    assert_eq!(path.unstable, [1.0]);
}

/// A clamped line of EI = L = 1 under a dead force along it, in units of the critical one.
fn strut(ratio: f64) -> Arc<Model> {
    let mut cable = support::straight_cable("strut", 16, 1.0);
    cable.axial_stiffness = Array::Inline(vec![1e6]);
    cable.bending_stiffness = Array::Inline(vec![1.0]);
    cable.mass_per_length = Array::Inline(vec![1.0]);
    let clamp = JointSpec::Clamp {
        name: "clamp1".to_owned(),
        a: PointSpec::Cable { cable: 0, element: 0, xi: 0.0 },
        direction: None,
    };
    let mut spec = support::document([0.0; 3], vec![cable], vec![clamp]);
    spec.loads.push(LoadSpec::Force {
        name: "force1".to_owned(),
        at: PointSpec::Cable { cable: 0, element: 15, xi: 1.0 },
        value: Signal::Constant(vec![-ratio * PI * PI / 4.0, 0.0, 0.0]),
        follower: false,
    });
    Arc::new(Model::new(&spec, &[]).unwrap())
}

#[test]
fn a_strut_buckles_above_the_critical_load_only() {
    // K(k) = pi/2 sqrt(P/P_cr), tip ((2 E - K) / K, 2 k / K); 16 elements and EA = 1e6: errors of 2e-6.
    for (ratio, exact) in [(0.99, [1.0, 0.0]), (1.5, [0.363_588_224_9, 0.788_575_805_7])] {
        let model = strut(ratio);
        let (path, outcome) = solve(&model, &STABLE);
        outcome.unwrap();
        assert!(path.unstable.is_empty());
        let q = &path.records.q;
        let tip = &q[q.len() - 6..];
        let deflection = tip[1].hypot(tip[2]);
        println!("{ratio}: tip {tip:?}, deflection {deflection}, exact {exact:?}");
        assert!((tip[0] - exact[0]).abs() < 5e-6 && (deflection - exact[1]).abs() < 5e-6);
        assert!(kinetic_energy(&model, &path) < 1e-20);
    }
}
