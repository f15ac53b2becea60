//! Cable kernels in every rule beside the textbook's dense quadrature and the 10x10 tensor form of the precomputed
//! stiffness: force, and force with Jacobian, single (scalar) and batched (lanes).
//!
//! Times are per element. The batched figures include gathering the nodes, inertia, and summing at the nodes.
#![allow(missing_docs)]

mod rivals;

use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use pliant_elements::{
    Bending, Block, Cable, CableBlock, CableElement, CableLaw, Integration, Motion, NodeOffsets,
    Section, Sections, Slack, Strain, Weights, Workspace, Yielding, testing,
};

const SECTION: Section =
    Section { axial_stiffness: 785.0, bending_stiffness: 4.9e-3, mass_per_length: 0.0785 };

fn laws() -> Vec<(&'static str, CableLaw)> {
    let default = CableLaw::default();
    let biot = CableLaw { strain: Strain::Biot, ..default };
    let simplified = CableLaw { bending: Bending::Simplified, ..default };
    let full = CableLaw { integration: Integration::Full, ..default };
    vec![
        ("lobatto exact", default),
        ("lobatto exact biot", biot),
        ("lobatto exact damped", CableLaw { damped: true, ..default }),
        ("lobatto exact tension-only", CableLaw { tension_only: true, ..default }),
        ("lobatto simplified", simplified),
        ("full exact", full),
        ("full simplified", CableLaw { bending: Bending::Simplified, ..full }),
    ]
}

fn block(law: CableLaw, n: usize) -> (CableBlock, Vec<f64>) {
    let length = 1.0 / n as f64;
    let cable = Cable {
        nodes: (0..=n as u32).map(|k| NodeOffsets { r: 6 * k, t: 6 * k + 3 }).collect(),
        elements: vec![CableElement {
            length,
            sections: Sections::constant(SECTION),
            retardation_time: if law.damped { 1e-3 } else { 0.0 },
            reference: None,
        }],
        normal: [0.0, 0.0, 1.0],
        slack: Slack::default(),
        yielding: Yielding { strain: 1e-2, isotropic: 0.1, kinematic: 0.0 },
    };
    let q = (0..=n)
        .flat_map(|k| {
            let s = k as f64 * length;
            [s, 0.01 * (3.0 * s).sin(), 0.02 * s, 1.0, 0.03 * (3.0 * s).cos(), 0.02]
        })
        .collect();
    #[allow(clippy::expect_used)]
    let block = CableBlock::new(law, &[cable]).expect("the data above are valid");
    (block, q)
}

fn batched(c: &mut Criterion) {
    let weights = Weights { mass: 1.0, damping: 0.1, stiffness: 0.5 };
    for n in [100, 1000] {
        let mut group = c.benchmark_group(format!("batched {n}"));
        group.throughput(Throughput::Elements(n as u64));
        for (name, law) in laws() {
            let (block, q) = block(law, n);
            let v: Vec<f64> = q.iter().map(|c| 0.1 * c).collect();
            let motion = Motion { q: &q, v: &v, a: &v };
            let mut force = vec![0.0; q.len()];
            let mut workspace = Workspace::default();
            group.bench_function(BenchmarkId::new("residual", name), |b| {
                b.iter(|| {
                    block.residual(motion, [0.0, 0.0, -9.81], &mut workspace, &mut force, false);
                    black_box(&mut force);
                });
            });
            let mut values = vec![0.0; block.values_len()];
            group.bench_function(BenchmarkId::new("tangent", name), |b| {
                b.iter(|| {
                    block.tangent(motion, weights, &mut values, false);
                    black_box(&mut values);
                });
            });
        }
        group.finish();
    }
}

fn single(c: &mut Criterion) {
    let weights = Weights { mass: 0.0, damping: 0.0, stiffness: 1.0 };
    let mut group = c.benchmark_group("single");
    for (name, law) in laws() {
        let (block, q) = block(law, 1);
        let v = vec![0.0; 12];
        let local: [f64; 12] = block.local(0, &q);
        group.bench_function(BenchmarkId::new("force", name), |b| {
            b.iter(|| testing::force(&block, 0, black_box(&local), &[0.0; 12]));
        });
        let motion = Motion { q: &q, v: &v, a: &v };
        group.bench_function(BenchmarkId::new("force + jacobian", name), |b| {
            b.iter(|| {
                let f = testing::force(&block, 0, black_box(&local), &[0.0; 12]);
                (f, block.element_tangent(0, black_box(motion), weights))
            });
        });
    }
    let (_, q) = block(CableLaw::default(), 1);
    let q: [f64; 12] = std::array::from_fn(|k| q[k]);
    let textbook = rivals::Textbook::new(1.0, SECTION);
    let tensor = rivals::Tensor::new(1.0, SECTION);
    group.bench_function("force/textbook 3x12, G5 + G3", |b| {
        b.iter(|| textbook.force(black_box(&q)));
    });
    group.bench_function("force + jacobian/textbook 3x12, G5 + G3", |b| {
        b.iter(|| textbook.force_and_jacobian(black_box(&q)));
    });
    group.bench_function("force/tensor 10x10, full simplified", |b| {
        b.iter(|| tensor.force(black_box(&q)));
    });
    group.bench_function("force + jacobian/tensor 10x10, full simplified", |b| {
        b.iter(|| tensor.force_and_jacobian(black_box(&q)));
    });
    group.finish();
}

/// The rivals compute the same forces as the kernels they are compared with.
fn agree(_: &mut Criterion) {
    let full = CableLaw { integration: Integration::Full, ..CableLaw::default() };
    let simplified = CableLaw { bending: Bending::Simplified, ..full };
    let (exact, q) = block(full, 1);
    let q: [f64; 12] = std::array::from_fn(|k| q[k]);
    let check = |ours: [f64; 12], theirs: [f64; 12]| {
        let size = ours.iter().fold(0.0_f64, |m, c| m.max(c.abs()));
        for k in 0..12 {
            assert!((ours[k] - theirs[k]).abs() < 1e-11 * size, "{ours:?} {theirs:?}");
        }
    };
    check(testing::force(&exact, 0, &q, &[0.0; 12]), rivals::Textbook::new(1.0, SECTION).force(&q));
    let (block, _) = block(simplified, 1);
    check(testing::force(&block, 0, &q, &[0.0; 12]), rivals::Tensor::new(1.0, SECTION).force(&q));
}

criterion_group! {
    name = benches;
    config = Criterion::default()
        .sample_size(20)
        .warm_up_time(std::time::Duration::from_millis(200))
        .measurement_time(std::time::Duration::from_millis(500));
    targets = agree, single, batched
}
criterion_main!(benches);
