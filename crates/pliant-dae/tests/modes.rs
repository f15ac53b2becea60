//! Frequencies of spring chains against closed forms, and the iteration against the dense path.
#![allow(missing_docs, clippy::unwrap_used)]

mod common;

use std::f64::consts::PI;

use common::{Truss, solver};
use pliant_dae::modes::{Mode, ModeOptions, solve_modes};
use pliant_dae::problem::Problem;

/// Bars of unit length and unit mass in a row, stretched to the given strain so that they vibrate sideways as well.
fn chain(n: usize, ends_held: bool) -> Truss {
    let mut truss = Truss::new((0..=n).map(|i| [i as f64, 0.0]).collect(), 100.0);
    if ends_held {
        truss.fix(0);
        truss.fix(n);
    }
    for i in 0..n {
        truss.bar(i, i + 1);
    }
    truss
}

fn modes(truss: &mut Truss, stretch: f64, options: &ModeOptions) -> Vec<Mode> {
    let q: Vec<f64> = truss.start.iter().map(|x| (1.0 + stretch) * x).collect();
    let lambda_ = vec![0.0; truss.multipliers()];
    let mut linear = solver(truss);
    solve_modes(truss, linear.as_mut(), 0.0, &q, &lambda_, options).unwrap()
}

#[test]
fn a_held_chain_vibrates_at_its_closed_form() {
    // Sideways stiffness EA e / l0 with e Green's strain, along EA (e + d^2): omega = 2 sqrt(k) sin(j pi / 2 n).
    let (n, stretch) = (12, 0.1);
    let strain: f64 = 0.5 * (1.1 * 1.1 - 1.0);
    let mut all: Vec<f64> = (1..n)
        .flat_map(|j| {
            let s = 2.0 * (j as f64 * PI / (2 * n) as f64).sin();
            [s * (100.0 * strain).sqrt(), s * (100.0 * (strain + 1.21_f64)).sqrt()]
        })
        .collect();
    all.sort_by(f64::total_cmp);
    let options = ModeOptions { count: 100, ..ModeOptions::default() };
    let found = modes(&mut chain(n, true), stretch, &options);
    assert_eq!(found.len(), all.len());
    for (mode, omega) in found.iter().zip(&all) {
        // Rounding of a 22 x 22 eigenproblem.
        assert!((mode.frequency() * 2.0 * PI - omega).abs() < 1e-10 * omega);
        assert!(!mode.unstable && mode.eigenvalue().0 == 0.0);
        // Supports do not move.
        assert!(mode.shape[0].abs() < 1e-12 && mode.shape[2 * n + 1].abs() < 1e-12);
    }
}

#[test]
fn free_and_compressed_chains_show_zero_and_negative_squares() {
    let options = ModeOptions { count: 5, ..ModeOptions::default() };
    let free = modes(&mut chain(1, false), 0.0, &options);
    // A free bar: two translations and a rotation, and one stretching mode, omega^2 = 2 EA / l.
    for mode in &free[..3] {
        assert!(mode.omega_squared.abs() < 1e-11 && !mode.unstable);
    }
    assert!((free[3].omega_squared - 200.0).abs() < 1e-10);
    let pressed = modes(&mut chain(6, true), -0.01, &options);
    assert!(
        pressed[0].unstable && pressed[0].eigenvalue().0 > 0.0 && pressed[0].frequency() == 0.0
    );
}

#[test]
fn the_iteration_finds_what_the_dense_path_finds() {
    let dense = ModeOptions { count: 12, dense_limit: 1000, ..ModeOptions::default() };
    let iterated = ModeOptions { dense_limit: 0, ..dense };
    for (held, stretch) in [(true, 0.05), (false, 0.0)] {
        let mut truss = chain(120, held);
        if !held {
            // Unstretched bars have no stiffness sideways; hinges leave three rigid-body motions.
            (1..120).for_each(|i| truss.hinge(i, 3.0));
        }
        let (a, b) = (modes(&mut truss, stretch, &dense), modes(&mut truss, stretch, &iterated));
        assert_eq!((a.len(), b.len()), (12, 12));
        for (x, y) in a.iter().zip(&b) {
            println!("{:e} {:e}", x.omega_squared, y.omega_squared);
            // Relative to the largest omega^2, about 400, both are exact to rounding.
            assert!((x.omega_squared - y.omega_squared).abs() < 1e-8 * x.omega_squared + 1e-10);
            let mass: f64 = y.shape.iter().map(|s| s * s).sum();
            assert!((mass - 1.0).abs() < 1e-10);
        }
    }
}
