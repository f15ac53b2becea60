//! Factorisation and solution by every back end: single chains, and a net of the size of a mesh reflector.
//!
//! `cargo bench -p pliant-dae --bench linear_solvers`; times per node in nanoseconds are printed as throughput.

#[path = "../tests/linear_support/mod.rs"]
mod linear_support;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use linear_support::{INDEFINITE, Material, SOFT, STIFF, System, net, pinned_chain};
use pliant_dae::linear_solver::{Options, analyze};
use std::time::{Duration, Instant};

const ALONE: Options = Options { condense: true, parallel: false, dense_limit: 240 };
const SPARSE: Options = Options { condense: false, ..ALONE };

const SKEW: Material = Material { skew: 0.1, ..SOFT };

fn chains(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("chain");
    group.sample_size(20).warm_up_time(Duration::from_millis(300));
    group.measurement_time(Duration::from_secs(1));
    for n in [100, 300, 1000, 10_000] {
        group.throughput(Throughput::Elements(n as u64));
        for (name, material) in [("soft", SOFT), ("stiff", STIFF), ("skew", SKEW)] {
            let system = pinned_chain(n, material);
            let mut solver = match analyze(&system.structure, ALONE) {
                Ok(solver) => solver,
                Err(error) => return eprintln!("{error}"),
            };
            group.bench_function(format!("factor/{name}/{n}"), |b| {
                b.iter(|| solver.factor(&system.structure, &system.values));
            });
            let mut x = vec![1.0; system.structure.unknowns()];
            group.bench_function(format!("solve/{name}/{n}"), |b| {
                b.iter(|| {
                    x.fill(1.0);
                    solver.solve(&mut x);
                });
            });
        }
    }
}

/// Best time of a few runs in milliseconds.
fn best(runs: usize, mut task: impl FnMut()) -> f64 {
    let time = |task: &mut dyn FnMut()| {
        let start = Instant::now();
        task();
        start.elapsed().as_secs_f64() * 1e3
    };
    (0..runs).map(|_| time(&mut task)).fold(f64::INFINITY, f64::min)
}

fn table_row(name: &str, system: &System, options: Options) {
    let System { structure, values } = system;
    let mut solver = None;
    let analysis = best(1, || solver = analyze(structure, options).ok());
    let Some(mut solver) = solver else { return };
    let mut outcome = Ok(());
    let factor = best(5, || outcome = solver.factor(structure, values));
    let (_, b) = linear_support::right_side(system, 5, false);
    let mut x = b.clone();
    let solve = best(10, || {
        x.copy_from_slice(&b);
        solver.solve(&mut x);
    });
    let y = linear_support::product(system, &x, false);
    let size = b.iter().fold(0.0_f64, |m, b| m.max(b.abs()));
    let worst = y.iter().zip(&b).fold(0.0_f64, |m, (y, b)| m.max((y - b).abs())) / size;
    println!(
        "| {name} | {analysis:.0} | {factor:.2} | {solve:.2} | {worst:.1e} | {outcome:?} | {} |",
        solver.describe()
    );
}

/// Times of one-off runs on a large net: too long for statistics.
fn reflector(_: &mut Criterion) {
    if std::env::args().any(|argument| argument.contains("chain")) {
        return;
    }
    for n in [100, 300, 1000, 10_000] {
        for (name, material) in [("symmetric", STIFF), ("unsymmetric", SKEW)] {
            let system = pinned_chain(n, material);
            let Ok(mut solver) = analyze(&system.structure, ALONE) else { return };
            let mut x = vec![1.0; system.structure.unknowns()];
            let factor = best(300, || drop(solver.factor(&system.structure, &system.values)));
            let solve = best(300, || solver.solve(&mut x));
            let per_node = 1e6 / n as f64;
            println!(
                "chain of {n}, {name}: factor {:.0}, solve {:.1} ns a node",
                factor * per_node,
                solve * per_node
            );
        }
    }
    println!("| matrix, back end | analysis ms | factor ms | solve ms | residual | | |");
    let skew = Material { skew: 0.02, ..STIFF };
    for (name, material) in [("slack", STIFF), ("indefinite", INDEFINITE), ("unsymmetric", skew)] {
        let system = net(21, 36, 21, material);
        println!("{} unknowns", system.structure.unknowns());
        table_row(&format!("{name}, condensed"), &system, ALONE);
        let two = Options { parallel: true, ..ALONE };
        table_row(&format!("{name}, condensed, threads"), &system, two);
        table_row(&format!("{name}, sparse"), &system, SPARSE);
    }
}

criterion_group!(benches, chains, reflector);
criterion_main!(benches);
