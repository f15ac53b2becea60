//! Condensed chains of every shape against dense LU of the whole matrix.
#![allow(clippy::unwrap_used)] // helpers of tests, too

mod linear_support;

use linear_support::{
    Builder, INDEFINITE, Material, Random, SOFT, STIFF, System, net, pinned_chain, residual,
    right_side,
};
use pliant_dae::linear_solver::{FactorError, LinearSolver, Options, analyze};
use pliant_dae::structure::Structure;
use proptest::prelude::*;

const DENSE: Options = Options { condense: false, parallel: false, dense_limit: usize::MAX };
const SKEW: Material = Material { skew: 0.1, ..SOFT };

fn solve(solver: &mut dyn LinearSolver, b: &[f64], transposed: bool) -> Vec<f64> {
    let mut x = b.to_vec();
    if transposed {
        solver.solve_transposed(&mut x);
    } else {
        solver.solve(&mut x);
    }
    x
}

/// Compares with dense LU and returns the description of the solver.
fn check(system: &System) -> String {
    let System { structure, values } = system;
    let mut dense = analyze(structure, DENSE).unwrap();
    dense.factor(structure, values).unwrap();
    let mut solver = analyze(structure, Options::default()).unwrap();
    // Twice: nothing may be left over from the first time.
    for _ in 0..2 {
        solver.factor(structure, values).unwrap();
        for transposed in [false, true] {
            let (_, b) = right_side(system, 11, transposed);
            let x = solve(solver.as_mut(), &b, transposed);
            let reference = solve(dense.as_mut(), &b, transposed);
            let size = reference.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
            for (i, (x, r)) in x.iter().zip(&reference).enumerate() {
                assert!(
                    (x - r).abs() <= 1e-7 * size,
                    "{}, transposed {transposed}: unknown {i} is {x}, must be {r}",
                    solver.describe()
                );
            }
            let r = residual(system, &x, &b, transposed);
            assert!(r < 1e-10, "{}: residual {r}", solver.describe());
        }
    }
    solver.describe()
}

/// Checks a system built by `fill` with symmetric and unsymmetric, packed and interleaved matrices.
fn check_all(expected: &str, fill: impl Fn(&mut Builder)) {
    for (material, lanes) in [(SOFT, false), (SOFT, true), (SKEW, false)] {
        let mut b = Builder::new(17, material);
        b.lanes = lanes;
        fill(&mut b);
        let description = check(&b.build());
        assert!(description.contains(expected), "{description}");
    }
}

#[test]
fn a_chain_pinned_at_one_end_leaves_no_interface() {
    for n in [3, 4, 5, 6, 17] {
        check_all("1 chain", |b| {
            let nodes = b.nodes(n + 1);
            b.chain(&nodes);
            b.joint(&[nodes[0]], 3);
        });
    }
    let system = pinned_chain(30, SOFT);
    assert_eq!(check(&system), "condensed: 1 chain of 30 nodes");
}

#[test]
fn both_ends_may_be_pinned_or_clamped() {
    check_all("1 chain of 7 nodes", |b| {
        let nodes = b.nodes(9);
        b.chain(&nodes);
        b.joint(&[nodes[0]], 5);
        b.joint(&[nodes[8]], 3);
    });
}

#[test]
fn a_chain_may_be_free() {
    check_all("1 chain of 9 nodes", |b| {
        let nodes = b.nodes(9);
        b.chain(&nodes);
        b.mass(nodes[8], 0.3);
        b.mass(nodes[3], 0.2);
        b.mass(nodes[4], 0.1);
    });
}

#[test]
fn elements_may_face_either_way_and_lie_double() {
    check_all("1 chain of 8 nodes", |b| {
        let nodes = b.nodes(8);
        for k in 1..8 {
            if k % 3 == 0 {
                b.line(&[nodes[k], nodes[k - 1]]);
            } else {
                b.line(&[nodes[k - 1], nodes[k]]);
            }
        }
        b.line(&[nodes[2], nodes[3]]);
        b.line(&[nodes[6], nodes[5]]);
    });
}

#[test]
fn lines_of_a_net_share_positions() {
    check_all("2 chains of 10 nodes", |b| {
        let knots = [b.group(3), b.group(3), b.group(3)];
        b.span(knots[0], knots[1], 6);
        b.span(knots[1], knots[2], 6);
        b.mass(knots[1], 0.1);
    });
    check_all("6 chains", |b| {
        let centre = b.group(3);
        let ring: Vec<usize> = (0..3).map(|_| b.group(3)).collect();
        for k in 0..3 {
            b.span(centre, ring[k], 5);
            b.span(ring[k], ring[(k + 1) % 3], 4);
        }
        b.joint(&[ring[0]], 2);
    });
}

#[test]
fn a_ring_is_cut_open() {
    check_all("1 chain of 6 nodes, interface dense: 6 unknowns", |b| {
        let mut nodes = b.nodes(7);
        nodes.push(nodes[0]);
        b.chain(&nodes);
    });
}

#[test]
fn short_chains_are_left_alone() {
    check_all("dense", |b| {
        let nodes = b.nodes(2);
        b.chain(&nodes);
        b.joint(&[nodes[0]], 3);
        let ends = [b.group(3), b.group(3), b.group(3), b.group(3)];
        b.line(&ends);
    });
}

#[test]
fn a_joint_between_chains_cuts_them() {
    check_all("4 chains", |b| {
        let first = b.nodes(9);
        let second = b.nodes(9);
        b.chain(&first);
        b.chain(&second);
        b.joint(&[first[4], second[4]], 3);
        b.joint(&[first[0]], 3);
    });
}

#[test]
fn a_chain_may_hang_on_a_body_that_others_share() {
    check_all("2 chains of 10 nodes, interface dense: 6 unknowns", |b| {
        let body = b.group(6);
        b.mass(body, 2.0);
        for _ in 0..2 {
            let nodes = b.nodes(6);
            b.chain(&nodes);
            b.joint(&[nodes[0], body], 5);
        }
    });
    // A body of its own belongs to the chain's end.
    check_all("condensed: 1 chain of 5 nodes", |b| {
        let body = b.group(6);
        b.mass(body, 2.0);
        let nodes = b.nodes(6);
        b.chain(&nodes);
        b.joint(&[nodes[0], body], 5);
    });
}

#[test]
fn indefinite_chains_are_solved() {
    for material in [STIFF, INDEFINITE] {
        for system in [pinned_chain(200, material), net(2, 5, 12, material)] {
            let mut solver = analyze(&system.structure, Options::default()).unwrap();
            solver.factor(&system.structure, &system.values).unwrap();
            let (_, b) = right_side(&system, 5, false);
            let x = solve(solver.as_mut(), &b, false);
            let y = linear_support::product(&system, &x, false);
            let size = b.iter().fold(0.0_f64, |m, b| m.max(b.abs()));
            let worst = y.iter().zip(&b).fold(0.0_f64, |m, (y, b)| m.max((y - b).abs()));
            assert!(worst < 1e-8 * size, "{}: {}", solver.describe(), worst / size);
        }
    }
}

#[test]
fn a_chain_that_is_singular_alone_is_solved_with_its_neighbours() {
    let mut b = Builder::new(3, SOFT);
    let nodes = b.nodes(5);
    b.chain(&nodes[..4]);
    // The last node has no matrix of its own but a coupling to an equally empty one.
    let other = b.group(6);
    let mut matrix = vec![0.0; 144];
    for i in 0..6 {
        matrix[i * 12 + 6 + i] = 2.0;
        matrix[(6 + i) * 12 + i] = 2.0;
    }
    b.element(&[nodes[4], other], matrix.clone());
    b.element(&[nodes[3], nodes[4]], vec![0.0; 144]);
    check(&b.build());
}

#[test]
fn singular_matrices_are_reported() {
    let mut b = Builder::new(3, SOFT);
    let nodes = b.nodes(6);
    b.chain(&nodes);
    let floating = b.group(6);
    b.element(&[floating], vec![0.0; 36]);
    let system = b.build();
    let first = system.structure.groups()[floating].start;
    let mut solver = analyze(&system.structure, Options::default()).unwrap();
    assert_eq!(
        solver.factor(&system.structure, &system.values),
        Err(FactorError::Singular { unknown: first })
    );

    // A chain without mass or support, in its straight state, has rigid motions.
    let mut system = pinned_chain(5, SOFT);
    system.values.fill(0.0);
    let mut solver = analyze(&system.structure, Options::default()).unwrap();
    let outcome = solver.factor(&system.structure, &system.values);
    assert!(matches!(outcome, Err(FactorError::Singular { .. })), "{outcome:?}");
}

#[test]
fn numbers_that_are_not_finite_are_named() {
    let mut system = pinned_chain(9, SOFT);
    let slot = system.structure.slot(4);
    system.values[slot.base + 7 * slot.stride] = f64::INFINITY;
    let mut solver = analyze(&system.structure, Options::default()).unwrap();
    assert_eq!(
        solver.factor(&system.structure, &system.values),
        Err(FactorError::NotFinite { element: 4 })
    );
}

#[test]
fn threads_do_not_change_the_bits() {
    for system in [pinned_chain(5000, STIFF), net(3, 8, 60, STIFF), net(3, 8, 60, SKEW)] {
        let mut results = Vec::new();
        for (threads, parallel) in [(1, false), (1, true), (2, true), (3, true)] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            results.push(pool.install(|| {
                let options = Options { parallel, ..Options::default() };
                let mut solver = analyze(&system.structure, options).unwrap();
                solver.factor(&system.structure, &system.values).unwrap();
                let (_, b) = right_side(&system, 5, false);
                solve(solver.as_mut(), &b, false)
            }));
        }
        for other in &results[1..] {
            assert!(results[0].iter().zip(other).all(|(a, b)| a.to_bits() == b.to_bits()));
        }
    }
}

#[test]
fn the_interface_of_a_net_does_not_grow_with_the_lines() {
    for n in [5, 10, 40] {
        let system = net(2, 4, n, SOFT);
        let solver = analyze(&system.structure, Options::default()).unwrap();
        let expected = format!("16 chains of {} nodes, interface dense: 27 unknowns", 16 * (n - 1));
        assert!(solver.describe().contains(&expected), "{}", solver.describe());
    }
}

/// A random graph: chains between random ends, some closed, some jointed, some sharing positions.
fn random_system(seed: u64, material: Material) -> System {
    let mut b = Builder::new(seed, material);
    b.lanes = seed.is_multiple_of(2);
    let mut r = Random(seed.wrapping_mul(77_777) | 1);
    for _ in 0..8 {
        r.next();
    }
    let knots: Vec<usize> = (0..1 + r.below(3)).map(|_| b.group(3)).collect();
    for &knot in &knots {
        b.mass(knot, 0.05);
    }
    let mut all = Vec::new();
    for _ in 0..1 + r.below(4) {
        let count = 1 + r.below(8);
        let mut nodes = b.nodes(count);
        all.extend(nodes.clone());
        match r.below(6) {
            0 if count > 2 => nodes.push(nodes[0]),
            1 => {
                b.joint(&[nodes[0]], 3);
            }
            2 => {
                let knot = knots[r.below(knots.len())];
                let slopes = b.group(3);
                b.line(&[knot, slopes, nodes[0]]);
            }
            3 => {
                let (a, c) = (knots[r.below(knots.len())], knots[r.below(knots.len())]);
                if a != c {
                    b.span(a, c, 2 + r.below(6));
                }
            }
            _ => {}
        }
        b.chain(&nodes);
        if r.below(3) == 0 {
            let node = nodes[r.below(count)];
            b.mass(node, 0.2);
        }
        for &node in &nodes {
            b.mass(node, 1e-3);
        }
    }
    for _ in 0..r.below(3) {
        let (i, j) = (all[r.below(all.len())], all[r.below(all.len())]);
        if i != j {
            b.joint(&[i, j], 2);
        }
    }
    // A tree: some chains begin in the middle of others.
    for _ in 0..r.below(3) {
        let mut branch = vec![all[r.below(all.len())]];
        branch.extend(b.nodes(1 + r.below(6)));
        b.chain(&branch);
    }
    b.build()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 96, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn random_graphs_are_solved(seed in 1_u64..1_000_000, skew in any::<bool>()) {
        check(&random_system(seed, if skew { SKEW } else { SOFT }));
    }
}

#[test]
fn an_empty_structure_is_solved() {
    let structure = Structure::new(0, 0);
    let mut solver = analyze(&structure, Options::default()).unwrap();
    solver.factor(&structure, &[]).unwrap();
    solver.solve(&mut []);
}
