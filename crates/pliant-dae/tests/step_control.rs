//! Steps chosen by an error tolerance: orders, stops, rejections, continuation.
#![allow(missing_docs, clippy::unwrap_used)]

mod common;

use common::{Chapter, Pendulum, order, solver};
use pliant_dae::error::Error;
use pliant_dae::generalized_alpha::{Integrator, Options, State};
use pliant_dae::step_control::StepControl;

const CHAPTER: Chapter = Chapter {
    file: "crates/pliant-dae/tests/step_control.rs",
    about: "The planar pendulum with steps chosen by the error estimate, against Runge-Kutta in the angle.",
};

fn start(problem: Pendulum, spectral_radius: f64) -> Integrator<Pendulum> {
    let solver = solver(&problem);
    let options = Options { spectral_radius, ..Options::default() };
    Integrator::new(problem, solver, options, 0.0, &[1.0, 0.0], &[0.0, 0.0]).unwrap().0
}

fn control(tolerance: f64) -> StepControl {
    StepControl { tolerance, max_step: f64::INFINITY, first_step: None }
}

fn grid(count: usize) -> Vec<f64> {
    (1..=count).map(|k| 2.0 * k as f64 / count as f64).collect()
}

/// States at `stops`, and the integrator at the last.
fn run(tolerance: f64, rho: f64, stops: &[f64]) -> (Vec<State>, Integrator<Pendulum>) {
    let mut integrator = start(Pendulum::new(), rho);
    let mut states = Vec::new();
    for &stop in stops {
        while integrator.state().t < stop {
            integrator.advance_within(stop, &control(tolerance)).unwrap();
        }
        states.push(integrator.state().clone());
    }
    (states, integrator)
}

fn worst(states: &[State]) -> [f64; 3] {
    let times: Vec<f64> = states.iter().map(|s| s.t).collect();
    let mut worst = [0.0_f64; 3];
    for (s, e) in states.iter().zip(Pendulum::exact(&times)) {
        worst[0] = worst[0].max((s.q[0] - e[0]).hypot(s.q[1] - e[1]));
        worst[1] = worst[1].max((s.v[0] - e[2]).hypot(s.v[1] - e[3]));
        worst[2] = worst[2].max((s.lambda_[0] - e[4]).abs());
    }
    worst
}

#[test]
fn errors_fall_with_the_tolerance_to_the_power_of_two_thirds() {
    let tolerances = [1e-5, 1e-6, 1e-7, 1e-8];
    for (rho, count) in [(0.8, 8), (0.5, 8), (0.8, 1)] {
        let mut all = Vec::new();
        for tolerance in tolerances {
            let (states, integrator) = run(tolerance, rho, &grid(count));
            let s = integrator.statistics();
            let errors = worst(&states);
            println!("{tolerance:e} {errors:?} {} steps, {} rejected", s.steps, s.rejected);
            assert!(s.rejected <= 3 + s.steps / 20, "{} of {}", s.rejected, s.steps);
            all.push(errors);
        }
        for (k, what) in ["q", "v", "lambda"].iter().enumerate() {
            let series: Vec<f64> = all.iter().map(|e| e[k]).collect();
            let slope = order(&tolerances, &series);
            // Steps change by a third at once: over three decades the slope is uncertain by hundredths.
            let name = format!("rho {rho}, {count} stops, power of {what}");
            CHAPTER.record(&name, slope, 2.0 / 3.0, 0.04, "");
        }
    }
}

#[test]
fn stops_are_met_exactly_and_even_grids_need_few_changes() {
    let stops = grid(40);
    let (states, integrator) = run(1e-6, 0.8, &stops);
    for (state, stop) in states.iter().zip(&stops) {
        assert_eq!(state.t.to_bits(), stop.to_bits());
    }
    let s = integrator.statistics();
    let free = run(1e-6, 0.8, &[2.0]).1.statistics().clone();
    println!("{} steps with 40 stops, {} without", s.steps, free.steps);
    assert!(s.steps < 2 * free.steps);
    // A step is taken in equal parts of the interval: no odd ones that only fill up.
    assert!(s.steps >= 40);
}

#[test]
fn same_bits_after_a_stop_in_the_middle() {
    let reference = run(1e-6, 0.8, &[0.7, 2.0]).1.state().clone();
    for stop in [1, 7, 40] {
        let mut integrator = start(Pendulum::new(), 0.8);
        let mut steps = 0;
        for end in [0.7, 2.0] {
            while integrator.state().t < end {
                if steps == stop {
                    let (problem, _, state) = integrator.into_parts();
                    let linear = solver(&problem);
                    let options = Options { spectral_radius: 0.8, ..Options::default() };
                    integrator = Integrator::resume(problem, linear, options, state).unwrap();
                }
                integrator.advance_within(end, &control(1e-6)).unwrap();
                steps += 1;
            }
        }
        assert_eq!(&reference, integrator.state(), "stopped at step {stop}");
    }
}

#[test]
fn rejected_steps_leave_no_trace_but_a_shorter_step() {
    let mut integrator = start(Pendulum::new(), 0.8);
    let long = StepControl { first_step: Some(0.3), ..control(1e-7) };
    integrator.advance_within(1.0, &long).unwrap();
    let s = integrator.statistics();
    assert!(s.rejected >= 1 && s.steps == 1);
    let (t, state) = (integrator.state().t, integrator.state().clone());
    let e = Pendulum::exact(&[(t / 5e-5).round() * 5e-5])[0];
    // The exact values are known at multiples of 50 us only; the bob moves by less than that times its speed.
    assert!((state.q[1] - e[1]).abs() < 2e-6 + 5e-5 * state.v[1].abs());
}

#[test]
fn what_cannot_be_met_is_said() {
    // The force is not finite from 0.5 s on: no step is short enough.
    let mut integrator = start(Pendulum { broken_from: 0.5, ..Pendulum::new() }, 0.8);
    let error = loop {
        if let Err(error) = integrator.advance_within(1.0, &control(1e-5)) {
            break error;
        }
    };
    assert!(matches!(error, Error::NotFinite(_)), "{error}");
    assert!((integrator.state().t - 0.5).abs() < 1e-6);

    // A tolerance below the rounding of Newton's method.
    let mut integrator = start(Pendulum::new(), 0.8);
    let impossible = StepControl { first_step: Some(1e-3), ..control(1e-60) };
    let error = integrator.advance_within(1.0, &impossible).unwrap_err();
    let Error::Accuracy(what) = &error else { panic!("{error}") };
    assert!(what.estimate > 1.0 && what.name.contains("bob"), "{error}");
    assert!(error.to_string().contains("times the tolerance"), "{error}");
}

#[test]
fn bad_controls_are_refused() {
    let mut integrator = start(Pendulum::new(), 0.8);
    for bad in [
        control(0.0),
        control(f64::NAN),
        StepControl { max_step: 0.0, ..control(1e-5) },
        StepControl { first_step: Some(-1.0), ..control(1e-5) },
    ] {
        let error = integrator.advance_within(1.0, &bad).unwrap_err();
        assert!(matches!(error, Error::Value { .. }), "{error}");
    }
    assert!(integrator.advance_within(0.0, &control(1e-5)).is_err());
}
