//! Search and forces of contact: what a pair costs that is apart, that crosses, that lies along the other; the forces
//! and the tangent of a patch; a step of the bristles; and the tree of boxes for 32,000 elements.

#![allow(clippy::unwrap_used, missing_docs)]

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use nalgebra::{Matrix3, Vector3};
use pliant_contact::broad_phase::{Box3, pairs};
use pliant_contact::curve::Piece;
use pliant_contact::friction::{Friction, LuGre, Slip};
use pliant_contact::normal::Normal;
use pliant_contact::point::{Laws, Motion};
use pliant_contact::shapes::{Placed, Shape};
use pliant_contact::touch::Master;
use std::hint::black_box;

const R: f64 = 5e-3;

/// An element of 25 mm, slightly bent.
fn piece(middle: [f64; 3], along: [f64; 3]) -> Piece {
    let (middle, along) = (Vector3::from(middle), Vector3::from(along).normalize());
    let l = 25e-3;
    let bend = Vector3::z() * 0.05;
    let x = [middle - along * (0.5 * l), along - bend, middle + along * (0.5 * l), along + bend];
    Piece::new(x, l, R)
}

fn search(criterion: &mut Criterion) {
    let master = piece([0.0; 3], [1.0, 0.0, 0.0]);
    let slaves = [
        ("apart", piece([0.0, 0.0, 14e-3], [0.3, 1.0, 0.0])),
        ("crossing", piece([1e-3, 2e-3, 9.5e-3], [0.3, 1.0, 0.0])),
        ("along", piece([1e-3, 0.0, 9.98e-3], [1.0, 0.01, 0.0])),
    ];
    let mut group = criterion.benchmark_group("search of a pair");
    for (name, slave) in slaves {
        let mut found = Vec::new();
        group.bench_function(name, |bencher| {
            bencher.iter(|| {
                found.clear();
                let facing = Master::Line(black_box(&master), [false, false]);
                facing.touch(black_box(&slave), [false, false], &mut found);
            });
        });
    }
    let ground = Placed {
        shape: Shape::HalfSpace,
        origin: Vector3::new(0.0, 0.0, -R + 2e-5),
        axes: Matrix3::identity(),
    };
    let mut found = Vec::new();
    group.bench_function("lying on the ground", |bencher| {
        bencher.iter(|| {
            found.clear();
            Master::Shape(&ground).touch(black_box(&master), [false, false], &mut found);
        });
    });
    group.finish();
}

fn tangent(criterion: &mut Criterion) {
    let (master, slave) =
        (piece([0.0; 3], [1.0, 0.0, 0.0]), piece([1e-3, 2e-3, 9.5e-3], [0.3, 1.0, 0.0]));
    let mut found = Vec::new();
    Master::Line(&master, [false, false]).touch(&slave, [false, false], &mut found);
    let lugre = LuGre {
        mu_s: 0.5,
        mu_d: 0.4,
        v_s: 1e-2,
        alpha: 2.0,
        sigma_0: 1e5,
        sigma_1: 20.0,
        sigma_2: 0.0,
        scaled: true,
        v_d: 5e-2,
    };
    let laws = Laws {
        normal: Normal { k: 3e6, d_0: 2.5e-5, c: 3.0 },
        friction: Some(Friction::LuGre(lugre)),
    };
    let v = [Vector3::new(0.01, 0.02, -0.01); 8];
    let motion = Motion { v: &v, moved: &v.map(|v| v * 1e-3), h: 1e-3, z: Vector3::zeros() };
    criterion.bench_function("forces of a patch", |bencher| {
        bencher.iter(|| {
            let mut out = [Vector3::zeros(); 8];
            for point in found[0].points() {
                let force = point.place.force(&laws, &black_box(motion));
                point.place.add_force(force.total, &mut out);
            }
            out
        });
    });
    let (mean, end) = (Vector3::new(0.01, 0.02, 0.0), Vector3::new(0.011, 0.021, 0.0));
    let z = Vector3::new(2e-6, 1e-6, 0.0);
    let slip = Slip { z, mean, end, normal: 30.0, h: 1e-3 };
    criterion.bench_function("bristles over a step", |bencher| {
        bencher.iter(|| lugre.respond(&black_box(slip)));
    });
    let mut blocks = [[Matrix3::zeros(); 8]; 8];
    criterion.bench_function("tangent of a patch", |bencher| {
        bencher.iter(|| {
            found[0].add_tangent(&laws, |_| black_box(motion), (1.0, 500.0), false, &mut blocks);
        });
    });
}

fn tree(criterion: &mut Criterion) {
    // Layers of parallel lines across each other.
    let boxes: Vec<Box3> = (0..32_000)
        .map(|i| {
            let (line, e) = (i / 500, i % 500);
            let (y, x, layer) = (0.1 * (line / 2) as f64, 6.4e-3 * e as f64, line % 2);
            let p = if layer == 0 { [x, y, 0.0] } else { [y, x, 2.0 * R] };
            Box3::around(&[p], R)
        })
        .collect();
    let mut group = criterion.benchmark_group("tree of boxes");
    group.throughput(Throughput::Elements(boxes.len() as u64));
    group.sample_size(10);
    // Neighbours on one line do not count.
    let wanted = |i: u32, j: u32| i / 500 != j / 500;
    group.bench_function("32,000", |bencher| bencher.iter(|| pairs(&boxes, wanted)));
    group.finish();
}

criterion_group!(benches, search, tangent, tree);
criterion_main!(benches);
