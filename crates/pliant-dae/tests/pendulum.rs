//! The planar pendulum as an index-3 system: orders, energy, scaling, failures and continuation.
#![allow(missing_docs, clippy::unwrap_used)]

mod common;

use common::{Chapter, Pendulum, order, solver};
use pliant_dae::error::Error;
use pliant_dae::generalized_alpha::{Integrator, Options, State};

const CHAPTER: Chapter = Chapter {
    file: "crates/pliant-dae/tests/pendulum.rs",
    about: "The planar pendulum as an index-3 system, against Dormand-Prince 8(5,3) at 1e-13.",
};

fn start(problem: Pendulum, spectral_radius: f64) -> Integrator<Pendulum> {
    let solver = solver(&problem);
    let options = Options { spectral_radius, ..Options::default() };
    Integrator::new(problem, solver, options, 0.0, &[1.0, 0.0], &[0.0, 0.0]).unwrap().0
}

/// Largest errors of positions, velocities and the multiplier over one second, from the first step on.
fn errors(spectral_radius: f64, steps: &[f64]) -> [f64; 3] {
    let mut integrator = start(Pendulum::new(), spectral_radius);
    let mut states: Vec<State> = Vec::new();
    for &h in steps {
        integrator.step(h).unwrap();
        states.push(integrator.state().clone());
    }
    let times: Vec<f64> = states.iter().map(|s| s.t).collect();
    let mut worst = [0.0_f64; 3];
    for (s, e) in states.iter().zip(Pendulum::exact(&times)) {
        let size = |x: f64, y: f64| x.hypot(y);
        worst[0] = worst[0].max(size(s.q[0] - e[0], s.q[1] - e[1]));
        worst[1] = worst[1].max(size(s.v[0] - e[2], s.v[1] - e[3]));
        worst[2] = worst[2].max((s.lambda_[0] - e[4]).abs());
    }
    worst
}

fn check_second_order(name: &str, h: &[f64], errors: &[[f64; 3]]) {
    for (k, what) in ["q", "v", "lambda"].iter().enumerate() {
        let series: Vec<f64> = errors.iter().map(|e| e[k]).collect();
        let slope = order(h, &series);
        // Second order; the rest is the next term of the error's expansion.
        CHAPTER.record(&format!("{name}, order of {what}"), slope, 2.0, 0.1, "");
    }
}

#[test]
fn second_order_from_the_first_step() {
    let h: [f64; 4] = [0.01, 0.005, 0.0025, 0.00125];
    for rho in [0.9, 0.5] {
        let e: Vec<_> =
            h.iter().map(|&h| errors(rho, &vec![h; (1.0 / h).round() as usize])).collect();
        check_second_order(&format!("rho {rho}"), &h, &e);
    }
    // Independent implementation at h = 0.0025 over 2 s, against DOP853 at 1e-13: 1.4288e-4, 6.289e-4, 2.8372e-3.
    // Its norms may be of components: a factor of at most sqrt(2).
    let own = errors(0.9, &[0.0025; 800]);
    for ((own, other), what) in
        own.iter().zip([1.4288e-4, 6.289e-4, 2.8372e-3]).zip(["q", "v", "lambda"])
    {
        let name = format!("rho 0.9, h = 2.5 ms, largest error of {what} over 2 s");
        CHAPTER.record(&name, *own, other, 0.42 * other, "");
    }
}

#[test]
fn second_order_across_changes_of_step() {
    let h = [0.003, 0.0015, 0.00075, 0.0005];
    for rho in [0.9, 0.5] {
        let series = |h: f64| -> Vec<f64> {
            let (mut t, mut steps) = (0.0, Vec::new());
            while t < 1.0 - 1e-9 {
                let now = if (steps.len() / 7) % 2 == 0 { h } else { 0.4 * h };
                steps.push(now);
                t += now;
            }
            steps
        };
        let e: Vec<_> = h.iter().map(|&h| errors(rho, &series(h))).collect();
        check_second_order(&format!("alternating, rho {rho}"), &h, &e);
    }
}

#[test]
fn energy_after_a_minute() {
    for (rho, loss) in [(0.9, -3.5e-3), (0.5, -2.3e-2)] {
        let mut integrator = start(Pendulum::new(), rho);
        for _ in 0..6000 {
            integrator.advance(0.01).unwrap();
        }
        let s = integrator.state();
        assert_eq!(s.t, 60.0);
        let energy = Pendulum::energy(&s.q, &s.v);
        // Figures of an independent implementation, printed with two digits; the phase of the oscillating part
        // of the discrete energy differs by the start.
        let name = format!("rho {rho}, h = 10 ms, energy after 60 s");
        CHAPTER.record(&name, energy, loss, 0.1 * loss.abs(), "J");
        // Positions are held on the constraint by Newton itself.
        assert!((s.q[0].hypot(s.q[1]) - 1.0).abs() < 1e-10);
    }
}

#[test]
fn iterations_do_not_depend_on_the_step() {
    // The scaled iteration matrix has the same condition at every step; at h = 1e-6 an unscaled one would have
    // lost all digits (condition 1e25).
    for h in [1e-2, 1e-3, 1e-4, 1e-5, 1e-6] {
        let mut integrator = start(Pendulum::new(), 0.9);
        for _ in 0..50 {
            integrator.advance(h).unwrap();
        }
        let s = integrator.statistics();
        println!(
            "h {h:e}: {} iterations, {} factorisations",
            s.newton_iterations, s.factorizations
        );
        assert!(s.newton_iterations <= 50 * 5, "{} iterations at h = {h}", s.newton_iterations);
        let e = Pendulum::energy(&integrator.state().q, &integrator.state().v);
        assert!(e.abs() < 1e-2, "energy {e} at h = {h}");
    }
}

#[test]
fn undamped_constraints_are_refused() {
    let problem = Pendulum::new();
    let solver = solver(&problem);
    let options = Options { spectral_radius: 0.99, ..Options::default() };
    let error =
        Integrator::new(problem, solver, options, 0.0, &[1.0, 0.0], &[0.0, 0.0]).err().unwrap();
    assert!(matches!(error, Error::UndampedConstraints { .. }));
    assert!(error.to_string().contains("0.98"));
}

#[test]
fn initial_values_are_checked_and_projected() {
    let problem = Pendulum::new();
    let linear = solver(&problem);
    let error = Integrator::new(problem, linear, Options::default(), 0.0, &[1.1, 0.0], &[0.0, 0.0])
        .err()
        .unwrap();
    assert!(error.to_string().contains("length of the rod"), "{error}");

    let problem = Pendulum::new();
    let linear = solver(&problem);
    let (integrator, start) =
        Integrator::new(problem, linear, Options::default(), 0.0, &[1.0, 0.0], &[0.3, 0.5])
            .unwrap();
    // Only the radial part is removed; rounding of a 3x3 solve.
    assert!((start.v[0]).abs() < 1e-15 && (start.v[1] - 0.5).abs() < 1e-15);
    assert!((start.velocity_correction - 0.3).abs() < 1e-15 && start.most_corrected == 0);
    // Centripetal force at the start: lambda_ = v^2.
    assert!((integrator.state().lambda_[0] - 0.25).abs() < 1e-14);
}

#[test]
fn a_force_that_is_not_finite_is_named_and_leaves_the_state() {
    let mut integrator = start(Pendulum { broken_from: 0.095, ..Pendulum::new() }, 0.8);
    for _ in 0..9 {
        integrator.step(0.01).unwrap();
    }
    let before = integrator.state().clone();
    let error = integrator.step(0.01).unwrap_err();
    let Error::NotFinite(failure) = &error else { panic!("{error}") };
    assert_eq!((failure.unknown, failure.name.as_str()), (1, "y of the bob"));
    let mut after = integrator.state().clone();
    // A step outside a nominal series does not belong to it; the kept factor may have been renewed.
    after.factor = before.factor.clone();
    assert_eq!(before, after);
    // Retrying takes it to the last moment before the break, and reports it there.
    integrator.advance(0.01).unwrap_err();
    assert!(integrator.state().t < 0.095 && integrator.state().t > 0.0949);
}

#[test]
fn failed_steps_are_repeated_in_parts_that_land_on_the_nominal_times() {
    let mut integrator = start(Pendulum { longest_step: 0.003, ..Pendulum::new() }, 0.8);
    for n in 1..=20 {
        let report = integrator.advance(0.01).unwrap();
        assert!(report.steps >= 4);
        assert_eq!(integrator.state().t, f64::from(n) * 0.01);
    }
    assert!(integrator.statistics().rejected >= 40);
    let s = integrator.state();
    let e = Pendulum::exact(&[0.2])[0];
    // Second order at h = 0.0025: the error of one second above is 1.4e-4.
    assert!((s.q[0] - e[0]).hypot(s.q[1] - e[1]) < 2e-5);
    assert!((s.lambda_[0] - e[4]).abs() < 1e-3);
}

#[test]
fn same_bits_on_repetition_and_continuation() {
    let run = |stop: Option<usize>| {
        let mut integrator = start(Pendulum::new(), 0.8);
        for n in 0..100 {
            if stop == Some(n) {
                let (problem, _, state) = integrator.into_parts();
                let linear = solver(&problem);
                integrator = Integrator::resume(problem, linear, *OPTIONS, state).unwrap();
            }
            integrator.advance(if n < 60 { 0.01 } else { 0.007 }).unwrap();
        }
        integrator.state().clone()
    };
    let whole = run(None);
    assert_eq!(whole, run(None));
    for stop in [1, 37, 61] {
        assert_eq!(whole, run(Some(stop)), "stopped at step {stop}");
    }
}

const OPTIONS: &Options = &Options {
    spectral_radius: 0.8,
    newton: pliant_dae::newton::NewtonOptions {
        tolerance: 1e-10,
        constraint_tolerance: 1e-10,
        reduction: 1e-6,
        max_iterations: 40,
    },
    retry: true,
    timed: false,
};
