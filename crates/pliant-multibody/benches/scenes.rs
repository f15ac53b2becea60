//! Whole steps of the falling cable pendulum: microseconds of CPU per element and step, with what the steps took and
//! how well they kept the energy, for a loosened Newton is not speed.

#![allow(clippy::unwrap_used, missing_docs)]

#[path = "../tests/support/mod.rs"]
mod support;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use pliant_dae::generalized_alpha::Options;
use pliant_multibody::altered::Altered;
use pliant_multibody::model::Model;
use pliant_multibody::run::{Leg, Run, RunOptions, Start};
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Largest time spent on preparing one measurement is that of this many element steps.
const ELEMENT_STEPS: u64 = 400_000;

fn start(model: &Arc<Model>, timed: bool) -> Run {
    let integrator = Options { spectral_radius: 0.9, timed, ..Options::default() };
    let options = RunOptions { integrator, threads: 1 };
    Run::new(model.clone(), &options, Start::default()).unwrap().0
}

fn leg(steps: u64) -> Leg {
    Leg { steps, step: 1e-3, end: None, output_every: 0 }
}

fn pendulum(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("pendulum, one step");
    group.sample_size(10);
    for elements in [40_usize, 100, 400, 1000, 10_000] {
        let model = Arc::new(Model::new(&support::pendulum(elements), &[]).unwrap());
        let steps = (ELEMENT_STEPS / elements as u64).clamp(100, 1000);
        let energy = |run: &Run| {
            let state = run.state();
            model.energy(&Altered::new(&model), &state.q, &state.v).iter().sum::<f64>()
        };
        let mut run = start(&model, true);
        let before = energy(&run);
        run.advance(leg(steps), Duration::MAX).unwrap();
        let statistics = run.statistics();
        let per = |count: usize| count as f64 / statistics.steps as f64;
        let s = statistics.seconds;
        let ns = |seconds: f64| 1e9 * seconds / (statistics.steps * elements) as f64;
        println!(
            "{elements} elements, {steps} steps: {:.2} iterations and {:.2} factorisations a step, energy {:+.2e} J; \
             ns per element and step: residual {:.0}, tangent {:.0}, factor {:.0}, solve {:.0}, other {:.0}",
            per(statistics.newton_iterations),
            per(statistics.factorizations),
            energy(&run) - before,
            ns(s.residual),
            ns(s.tangent),
            ns(s.factor),
            ns(s.solve),
            ns(s.other),
        );
        group.throughput(Throughput::Elements(elements as u64));
        group.bench_with_input(BenchmarkId::from_parameter(elements), &model, |bencher, model| {
            bencher.iter_custom(|iterations| {
                let mut spent = Duration::ZERO;
                let mut left = iterations;
                while left > 0 {
                    // Every measurement runs through the same motion from the start.
                    let mut run = start(model, false);
                    let count = left.min(steps);
                    let begin = Instant::now();
                    run.advance(leg(count), Duration::MAX).unwrap();
                    spent += begin.elapsed();
                    left -= count;
                }
                spent
            });
        });
    }
    group.finish();
}

/// Two ropes that hit each other, slide and rest on each other: half a second in steps of half a millisecond, 80 % of
/// them in contact.
fn crossing(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("crossing ropes, one step");
    group.sample_size(10);
    for elements in [20_usize, 40, 80] {
        let model = Arc::new(Model::new(&support::thrown_across(elements), &[]).unwrap());
        let integrator = Options { spectral_radius: 0.5, timed: true, ..Options::default() };
        let options = RunOptions { integrator, threads: 1 };
        let steps = 1000;
        let leg = Leg { steps, step: 5e-4, end: None, output_every: 0 };
        let whole = || {
            let mut run = Run::new(model.clone(), &options, Start::default()).unwrap().0;
            run.advance(leg, Duration::MAX).unwrap();
            run
        };
        let run = whole();
        let statistics = run.statistics();
        let per = |count: usize| count as f64 / steps as f64;
        let s = statistics.seconds;
        let us = |seconds: f64| 1e6 * seconds / steps as f64;
        println!(
            "{elements} elements each: {:.2} iterations, {:.2} factorisations a step, {} steps refused; us a step: \
             residual {:.0}, tangent {:.0}, factor {:.0}, solve {:.0}, other {:.0}",
            per(statistics.newton_iterations),
            per(statistics.factorizations),
            statistics.rejected,
            us(s.residual),
            us(s.tangent),
            us(s.factor),
            us(s.solve),
            us(s.other),
        );
        group.bench_function(BenchmarkId::from_parameter(elements), |bencher| {
            bencher.iter_custom(|repeats| {
                let begin = Instant::now();
                whole();
                begin.elapsed() / steps as u32 * repeats as u32
            });
        });
    }
    group.finish();
}

criterion_group!(benches, pendulum, crossing);
criterion_main!(benches);
