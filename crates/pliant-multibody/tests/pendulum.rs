//! The falling cable pendulum against an independent explicit integration of the same equations.

#![allow(clippy::unwrap_used)]

mod support;

use pliant_dae::generalized_alpha::Options;
use pliant_multibody::model::Model;
use pliant_multibody::run::{Leg, Run, RunOptions, Start};
use pliant_multibody::spec::IntegrationSpec;
use std::sync::Arc;
use std::time::Duration;

fn run(
    elements: usize,
    integration: IntegrationSpec,
    h: f64,
    duration: f64,
    threads: usize,
) -> Run {
    let mut spec = support::pendulum(elements);
    spec.cables[0].integration = integration;
    let model = Arc::new(Model::new(&spec, &[]).unwrap());
    let integrator = Options { spectral_radius: 0.9, ..Options::default() };
    let options = RunOptions { integrator, threads };
    let (mut run, _) = Run::new(model, &options, Start::default()).unwrap();
    let steps = (duration / h).round() as u64;
    assert_eq!(
        run.advance(Leg { steps, step: h, end: None, output_every: 0 }, Duration::MAX).unwrap(),
        steps
    );
    run
}

#[test]
fn the_tip_agrees_with_an_explicit_integration() {
    // 16 elements, Biot strain, five-point axial rule: Runge-Kutta of order 8, 40,000 steps.
    let exact = [0.799_871_408_992, -0.423_710_733_278];
    let error = |h: f64| {
        let run = run(16, IntegrationSpec::Full, h, 0.3, 1);
        let q = &run.state().q;
        let tip = &q[q.len() - 6..];
        (tip[0] - exact[0]).hypot(tip[1] - exact[1])
    };
    // Undamped axial waves of 16 elements have periods from 0.2 ms on: they are resolved by the finer step only, so
    // the coarser one is not yet in the range of second order.
    let (coarse, fine) = (error(2e-4), error(5e-5));
    assert!(fine < 1.5e-7 && fine < coarse / 4.0, "{coarse:e} {fine:e}");
}

#[test]
fn threads_do_not_change_the_bits() {
    let states: Vec<_> = [1, 2]
        .into_iter()
        .map(|threads| run(4100, IntegrationSpec::Lobatto, 1e-3, 0.005, threads).state().clone())
        .collect();
    assert_eq!(states[0], states[1]);
}

#[test]
fn a_stiff_start_needs_no_smaller_steps() {
    // Let go, the slope beside the pin accelerates by g over an element's length: 40,000 rad/s^2 in elements of a
    // quarter millimetre, whose stiffest motion the step is 10,000 times too long for. Taken as it is, it made Newton's
    // iteration diverge.
    let run = run(4000, IntegrationSpec::Lobatto, 1e-3, 0.01, 1);
    let statistics = run.statistics();
    assert_eq!(statistics.rejected, 0);
    assert!(statistics.newton_iterations <= 60, "{statistics:?}");
}
