//! Kernels of surface elements, force and tangent, every kind and material. Times are per element.
//!
//! To be laid beside a hand-written C prototype of the same equations (gcc -O3 -march=native -ffast-math): bicubic with
//! 3 x 3 points 0.42 us for the force and 5.4 us for the tangent.
#![allow(missing_docs)]

use std::hint::black_box;
use std::time::{Duration, Instant};

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use pliant_elements::materials::{NeoHookean, PlaneStress, SaintVenantKirchhoff, TensionField};
use pliant_elements::{
    Bending, Block, Integrals, Motion, Quadrature, SURFACE_KINDS, SurfaceBlock, SurfaceElement,
    SurfaceKind, SurfaceLaw, Weights, Workspace,
};

const ELASTIC: SaintVenantKirchhoff =
    SaintVenantKirchhoff { youngs_modulus: 1e6, poisson_ratio: 0.3 };

/// A row of equal flat elements, slightly disturbed.
fn row(kind: SurfaceKind, law: SurfaceLaw, n: usize) -> (SurfaceBlock, Vec<f64>) {
    let vectors = kind.vectors();
    let corners = [[0.0, 0.0], [0.1, 0.0], [0.1, 0.1], [0.0, 0.1]];
    let frame = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 0.0]];
    let reference: Vec<[f64; 3]> = (0..kind.corners())
        .flat_map(|c| {
            let place = [corners[c][0], corners[c][1], 0.0];
            std::iter::once(place).chain(frame).take(kind.vectors_per_node()).collect::<Vec<_>>()
        })
        .collect();
    let elements: Vec<SurfaceElement> = (0..n)
        .map(|e| SurfaceElement {
            vectors: (0..vectors).map(|k| 3 * (e * vectors + k) as u32).collect(),
            chart: corners.into(),
            reference: reference.clone(),
            thickness: 0.01,
        })
        .collect();
    #[allow(clippy::expect_used)]
    let block = SurfaceBlock::new(kind, law, &elements).expect("the data above are valid");
    let q = (0..n)
        .flat_map(|_| reference.iter().flatten().copied())
        .enumerate()
        .map(|(k, x)| x + 1e-3 * (1.3 * k as f64).sin())
        .collect();
    (block, q)
}

/// Processor time of the thread where the system tells, else that of the clock: the machine may be shared.
fn now(start: Instant) -> Duration {
    let told = std::fs::read_to_string("/proc/thread-self/schedstat").ok();
    let nanoseconds = told.and_then(|text| text.split(' ').next()?.parse().ok());
    nanoseconds.map_or_else(|| start.elapsed(), Duration::from_nanos)
}

fn timed(runs: u64, mut work: impl FnMut()) -> Duration {
    let start = Instant::now();
    let before = now(start);
    for _ in 0..runs {
        work();
    }
    now(start) - before
}

fn kernels(c: &mut Criterion) {
    let n = 256;
    let weights = Weights { mass: 1.0, damping: 0.0, stiffness: 0.5 };
    for kind in SURFACE_KINDS {
        let mut group = c.benchmark_group(kind.name());
        group.throughput(Throughput::Elements(n as u64));
        let rubber = NeoHookean::new(1e6, 0.5, kind.bends());
        let film = TensionField { elastic: ELASTIC, residual_stiffness: 1e-3 };
        let elastic = SurfaceLaw {
            material: PlaneStress::SaintVenantKirchhoff(ELASTIC),
            retardation_time: 0.0,
            density: 1e3,
            quadrature: Quadrature::Standard,
            integrals: Integrals::Quadrature,
            bending: Bending::Exact,
        };
        let exact = SurfaceLaw { integrals: Integrals::Precomputed, ..elastic };
        let mut laws = vec![
            ("standard", elastic),
            ("reduced", SurfaceLaw { quadrature: Quadrature::Reduced, ..elastic }),
            ("full", SurfaceLaw { quadrature: Quadrature::Full, ..elastic }),
            ("neo-hookean", SurfaceLaw { material: PlaneStress::NeoHookean(rubber), ..elastic }),
            ("tension field", SurfaceLaw { material: PlaneStress::TensionField(film), ..elastic }),
        ];
        if kind.bends() {
            laws.push(("simplified", SurfaceLaw { bending: Bending::Simplified, ..elastic }));
        }
        if kind.exact_rule().is_some() {
            laws.push(("precomputed", exact));
            if kind.bends() {
                let constant = SurfaceLaw { bending: Bending::Simplified, ..exact };
                laws.push(("precomputed, simplified", constant));
            }
        }
        for (name, law) in laws {
            let (block, q) = row(kind, law, n);
            let rest = vec![0.0; q.len()];
            let motion = Motion { q: &q, v: &rest, a: &rest };
            let mut force = vec![0.0; q.len()];
            let mut workspace = Workspace::default();
            group.bench_function(BenchmarkId::new("residual", name), |b| {
                b.iter_custom(|runs| {
                    timed(runs, || {
                        block.residual(motion, [0.0; 3], &mut workspace, &mut force, false);
                        black_box(&mut force);
                    })
                });
            });
            let mut values = vec![0.0; block.values_len()];
            group.bench_function(BenchmarkId::new("tangent", name), |b| {
                b.iter_custom(|runs| {
                    timed(runs, || {
                        block.tangent(motion, weights, &mut values, false);
                        black_box(&mut values);
                    })
                });
            });
        }
    }
}

criterion_group!(benches, kernels);
criterion_main!(benches);
