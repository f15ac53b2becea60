//! Kernels of beams, force and tangent, equal elements and elements that all differ. Times are per element.
//!
//! To be laid beside the theory's count of 2100 operations for the force.
#![allow(missing_docs)]

use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use pliant_elements::{
    BeamBlock, BeamElement, BeamLaw, Block, Locking, Motion, Weights, Workspace,
};

const LENGTH: f64 = 0.1;

/// A row of straight elements, slightly disturbed; `spread` makes their sections differ.
fn row(n: usize, spread: f64) -> (BeamBlock, Vec<f64>) {
    let node = |k: usize| {
        [[LENGTH * k as f64, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]
    };
    let elements: Vec<BeamElement> = (0..n)
        .map(|e| {
            let area = 1e-4 * (1.0 + spread * e as f64);
            let (inertia, torsion) = (1e-9, 1.4e-9);
            BeamElement {
                nodes: [12 * e as u32, 12 * e as u32 + 12],
                length: LENGTH,
                reference: std::array::from_fn(|k| node(e + k / 4)[k % 4]),
                stretch: [[area, 0.85, 0.85]; 3],
                bend: [[inertia, inertia, torsion]; 3],
                mass: [[area, inertia, inertia]; 5],
            }
        })
        .collect();
    let law = BeamLaw {
        youngs_modulus: 1e9,
        poisson_ratio: 0.3,
        density: 1e3,
        retardation_time: 0.0,
        locking: Locking::Enhanced,
        section_points: Vec::new(),
    };
    #[allow(clippy::expect_used)]
    let block = BeamBlock::new(law, &elements).expect("the data above are valid");
    let q = (0..=n)
        .flat_map(|k| node(k).into_iter().flatten().collect::<Vec<_>>())
        .enumerate()
        .map(|(k, x)| x + 1e-3 * (1.3 * k as f64).sin())
        .collect();
    (block, q)
}

fn kernels(c: &mut Criterion) {
    let n = 256;
    let weights = Weights { mass: 1.0, damping: 0.0, stiffness: 0.5 };
    let mut group = c.benchmark_group("beam");
    group.throughput(Throughput::Elements(n as u64));
    for (name, spread) in [("equal", 0.0), ("different", 1e-3)] {
        let (block, q) = row(n, spread);
        let motion = Motion { q: &q, v: &q, a: &q };
        let mut force = vec![0.0; q.len()];
        let mut workspace = Workspace::default();
        group.bench_function(BenchmarkId::new("force", name), |b| {
            b.iter(|| {
                let motion = black_box(motion);
                block.residual(motion, [0.0, 0.0, -9.81], &mut workspace, &mut force, false);
            });
        });
        let mut values = vec![0.0; block.values_len()];
        group.bench_function(BenchmarkId::new("tangent", name), |b| {
            b.iter(|| block.tangent(black_box(motion), weights, &mut values, false));
        });
    }
    group.finish();
}

criterion_group!(benches, kernels);
criterion_main!(benches);
