//! The sparse and dense back ends against known solutions.
#![allow(clippy::unwrap_used)] // helpers of tests, too

mod linear_support;

use linear_support::{
    Builder, INDEFINITE, SOFT, STIFF, System, net, pinned_chain, residual, right_side,
};
use pliant_dae::linear_solver::{FactorError, LinearSolver, Options, analyze};

const DENSE: Options = Options { condense: false, parallel: false, dense_limit: usize::MAX };
const SPARSE: Options = Options { condense: false, parallel: false, dense_limit: 0 };
/// Residual of corrections by factors in single precision.
const ROUGH: f64 = 1e-4;

fn check(system: &System, options: Options, tolerance: f64) -> Box<dyn LinearSolver> {
    let mut solver = analyze(&system.structure, options).unwrap();
    solver.factor(&system.structure, &system.values).unwrap();
    for transposed in [false, true] {
        let (_, b) = right_side(system, 3, transposed);
        let mut x = b.clone();
        if transposed {
            solver.solve_transposed(&mut x);
        } else {
            solver.solve(&mut x);
        }
        let r = residual(system, &x, &b, transposed);
        assert!(r < tolerance, "{}: residual {r}", solver.describe());
    }
    let (_, b) = right_side(system, 3, false);
    let mut x = b.clone();
    solver.correct(&mut x);
    let r = residual(system, &x, &b, false);
    assert!(r < f64::max(tolerance, ROUGH), "{}: residual of a correction {r}", solver.describe());
    solver
}

#[test]
fn known_solutions_are_found() {
    for material in [SOFT, STIFF, INDEFINITE] {
        for system in [pinned_chain(12, material), net(1, 4, 3, material)] {
            check(&system, DENSE, 1e-11);
            check(&system, SPARSE, 1e-11);
        }
    }
}

#[test]
fn unsymmetric_matrices_are_solved_by_lu() {
    let material = linear_support::Material { skew: 0.1, ..SOFT };
    for system in [pinned_chain(12, material), net(1, 4, 3, material)] {
        check(&system, DENSE, 1e-11);
        let solver = check(&system, SPARSE, 1e-11);
        assert!(solver.describe().contains("LU"), "{}", solver.describe());
    }
}

#[test]
fn an_indefinite_matrix_without_safe_pivots_is_solved() {
    let mut b = Builder::new(5, SOFT);
    let nodes = b.nodes(2);
    b.chain(&nodes);
    // Zero diagonals: no order of elimination without pivoting survives.
    let zero = b.group(2);
    b.element(&[zero], vec![0.0, 3.0, 3.0, 0.0]);
    let system = b.build();
    check(&system, SPARSE, 1e-11);
    check(&system, DENSE, 1e-11);
}

#[test]
fn an_unsymmetric_matrix_without_safe_pivots_is_solved() {
    let material = linear_support::Material { skew: 0.1, ..SOFT };
    let mut b = Builder::new(5, material);
    let nodes = b.nodes(40);
    b.chain(&nodes);
    // Each is the first to be eliminated and has nothing on its diagonal; its pivot lies in another block.
    for pair in nodes.chunks_exact(20) {
        let zero = b.group(1);
        let mut matrix = vec![0.0; 13 * 13];
        for (k, entry) in [(1, 2.0), (8, -3.0)] {
            matrix[k] = entry;
            matrix[k * 13] = 1.5 * entry;
        }
        b.element(&[zero, pair[0], pair[19]], matrix);
    }
    let system = b.build();
    check(&system, SPARSE, 1e-11);
    check(&system, DENSE, 1e-11);
}

#[test]
fn wide_fronts_are_solved() {
    let mut b = Builder::new(3, linear_support::Material { skew: 0.1, ..SOFT });
    let groups: Vec<usize> = (0..9).map(|_| b.group(96)).collect();
    for pair in [[0, 1], [1, 2], [3, 4], [4, 5], [2, 6], [5, 6], [6, 7], [7, 8], [0, 8]] {
        // Unsymmetric, with small diagonals: rows must be exchanged.
        let entry = |i: usize, j: usize| ((7 * i + 13 * j) as f64 + (i * j) as f64 * 0.1).sin();
        let both = pair.map(|k| groups[k]);
        b.element(&both, (0..36_864).map(|k| entry(k / 192, k % 192)).collect());
    }
    let solver = check(&b.build(), SPARSE, 1e-10);
    assert!(solver.describe().contains("LU"), "{}", solver.describe());
}

#[test]
fn a_floating_node_is_named() {
    for options in [DENSE, SPARSE] {
        let mut b = Builder::new(9, SOFT);
        let nodes = b.nodes(4);
        b.chain(&nodes);
        let floating = b.group(6);
        b.element(&[floating], vec![0.0; 36]);
        let system = b.build();
        let first = system.structure.groups()[floating].start;
        let mut solver = analyze(&system.structure, options).unwrap();
        assert_eq!(
            solver.factor(&system.structure, &system.values),
            Err(FactorError::Singular { unknown: first })
        );
    }
}

#[test]
fn numbers_that_are_not_finite_are_named() {
    for options in [DENSE, SPARSE] {
        let mut system = pinned_chain(5, SOFT);
        let slot = system.structure.slot(3);
        system.values[slot.base + 4 * slot.stride] = f64::NAN;
        let mut solver = analyze(&system.structure, options).unwrap();
        assert_eq!(
            solver.factor(&system.structure, &system.values),
            Err(FactorError::NotFinite { element: 3 })
        );
    }
}

#[test]
fn redundant_but_consistent_constraints_are_solved_through() {
    let mut b = Builder::new(9, SOFT);
    let nodes = b.nodes(8);
    b.chain(&nodes);
    // The same constraint twice.
    let mut matrix = vec![0.0; 64];
    for c in [6, 7] {
        matrix[c * 8 + 1] = 1.0;
        matrix[8 + c] = 1.0;
    }
    let both = b.multipliers(2);
    b.element(&[nodes[0], both], matrix);
    let system = b.build();
    let solver = check(&system, SPARSE, 1e-10);
    assert!(solver.describe().contains("LDL"), "{}", solver.describe());
}

/// Number of negative eigenvalues, by the eigenvalues.
fn negative(system: &System) -> usize {
    let structure = &system.structure;
    let n = structure.unknowns();
    let mut matrix = nalgebra::DMatrix::<f64>::zeros(n, n);
    for e in 0..structure.elements() {
        let unknowns: Vec<usize> = structure.element_unknowns(e).collect();
        for (i, &row) in unknowns.iter().enumerate() {
            for (j, &column) in unknowns.iter().enumerate() {
                matrix[(row, column)] += structure.entry(e, unknowns.len(), i, j, &system.values);
            }
        }
    }
    matrix.symmetric_eigenvalues().iter().filter(|&&x| x < 0.0).count()
}

#[test]
fn pivots_tell_the_inertia() {
    let mut blocked = Builder::new(3, SOFT);
    let groups: Vec<usize> = (0..4).map(|_| blocked.group(100)).collect();
    for pair in groups.windows(2) {
        let entry = |i: usize, j: usize| ((i * j) as f64).sin() + if i == j { 4.0 } else { 0.0 };
        blocked.element(pair, (0..40_000).map(|k| entry(k / 200, k % 200)).collect());
    }
    let (mut kinds, mut negatives) = (Vec::new(), 0);
    for system in
        [pinned_chain(12, SOFT), net(1, 4, 3, INDEFINITE), net(1, 4, 3, STIFF), blocked.build()]
    {
        let mut solver = analyze(&system.structure, SPARSE).unwrap();
        solver.factor(&system.structure, &system.values).unwrap();
        assert_eq!(solver.negative_eigenvalues(), Some(negative(&system)), "{}", solver.describe());
        negatives += negative(&system);
        kinds.push(solver.describe());
    }
    assert!(negatives > 0);
    for kind in ["simplicial", "supernodal"] {
        assert!(kinds.iter().any(|d| d.contains(kind)), "{kinds:?}");
    }
}

#[test]
fn corrections_are_solutions() {
    let system = net(1, 4, 3, STIFF);
    let mut solver = analyze(&system.structure, SPARSE).unwrap();
    solver.factor(&system.structure, &system.values).unwrap();
    let (solution, mut x) = right_side(&system, 3, false);
    solver.correct(&mut x);
    let error = x.iter().zip(&solution).map(|(x, y)| (x - y).abs()).fold(0.0, f64::max);
    // What the probe allows to remain without refinement, and some for another right-hand side.
    assert!(error < 1e-3, "{error}");
}

#[test]
fn corrections_of_large_systems_are_solutions() {
    let mut b = Builder::new(3, SOFT);
    let groups: Vec<usize> = (0..40).map(|_| b.group(96)).collect();
    for pair in groups.windows(2) {
        let entry = |i: usize, j: usize| {
            let noise = ((i.max(j) * 7 + i.min(j) * 13) as f64).sin();
            noise + if i == j { 60.0 } else { 0.0 }
        };
        b.element(pair, (0..36_864).map(|k| entry(k / 192, k % 192)).collect());
    }
    let system = b.build();
    let mut solver = analyze(&system.structure, SPARSE).unwrap();
    solver.factor(&system.structure, &system.values).unwrap();
    assert!(solver.describe().contains("supernodal"), "{}", solver.describe());
    let (solution, right) = right_side(&system, 3, false);
    let error = |x: &[f64]| x.iter().zip(&solution).map(|(x, y)| (x - y).abs()).fold(0.0, f64::max);
    let mut corrected = right.clone();
    solver.correct(&mut corrected);
    // Single precision, on factors of moderate condition; and in use.
    assert!((1e-10..1e-4).contains(&error(&corrected)), "{}", error(&corrected));
    let mut solved = right;
    solver.solve(&mut solved);
    assert!(error(&solved) < 1e-11, "{}", error(&solved));
}
