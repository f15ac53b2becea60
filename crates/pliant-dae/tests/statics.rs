//! Equilibria and their sensitivities: trusses with known solutions, hanging chains, a bending chain, free bodies.
#![allow(missing_docs, clippy::unwrap_used)]

mod common;

use common::{Truss, solver};
use pliant_dae::error::Error;
use pliant_dae::problem::Problem;
use pliant_dae::sensitivity::{static_gradient, static_sensitivities};
use pliant_dae::statics::{StaticOptions, StaticPoint, solve_static};

fn solve(truss: &mut Truss, options: &StaticOptions) -> Result<Vec<StaticPoint>, Error> {
    let q = truss.start.clone();
    let lambda_ = vec![0.0; truss.multipliers()];
    let mut linear = solver(truss);
    solve_static(truss, linear.as_mut(), &q, &lambda_, options, &mut || false)
}

#[test]
fn von_mises_truss_follows_its_closed_form() {
    // Two bars from (-1, 0) and (1, 0) to (0, 0.5), strain (l^2 - l0^2) / (2 l0^2), stiffness EA = 1e5 N:
    // P(w) = 2 EA / l0^3 (w^2 - h^2) / 2 w for the height w of the apex under a load P downwards.
    let mut truss = Truss::new(vec![[-1.0, 0.0], [1.0, 0.0], [0.0, 0.5]], 1e5);
    truss.fix(0);
    truss.fix(1);
    truss.bar(0, 2);
    truss.bar(1, 2);
    let l0 = 1.25_f64.sqrt();
    let w: f64 = 0.42;
    let load = 1e5 / l0.powi(3) * (0.25 - w * w) * w;
    truss.load(2, [0.0, -load]);
    let path =
        solve(&mut truss, &StaticOptions { load_steps: 4, ..StaticOptions::default() }).unwrap();
    assert_eq!(path.len(), 4);
    let last = path.last().unwrap();
    // Rounding.
    assert!((last.q[5] - w).abs() < 1e-13 && last.q[4].abs() < 1e-13, "{:?}", last.q);
    // Supports are constraints q - q0 = 0: each carries half the load upwards.
    assert!((last.lambda_[1].abs() - 0.5 * load).abs() < 1e-9 * load);
}

#[test]
fn a_chain_hangs_from_a_poor_guess() {
    // Two straight slack halves, without any stiffness across themselves: the tangent is singular at the start.
    let (n, span) = (20, 0.7_f64);
    let depth = (0.25 - 0.25 * span * span).sqrt();
    let nodes = (0..=n)
        .map(|i| i as f64 / n as f64)
        .map(|x| [span * x, -depth * (1.0 - (2.0 * x - 1.0).abs())])
        .collect();
    let mut truss = Truss::new(nodes, 1e4);
    truss.fix(0);
    truss.fix(n);
    for i in 0..n {
        truss.bar_of_length(i, i + 1, 1.0 / n as f64);
    }
    for i in 1..n {
        truss.load(i, [0.0, -9.81 / n as f64]);
    }
    let path = solve(&mut truss, &StaticOptions::default()).unwrap();
    let last = path.last().unwrap();
    // Catenary of length 1 over 0.7: 2 a sinh(0.35 / a) = 1, sag a (cosh(0.35 / a) - 1); a chain of 20 bars
    // deviates by less than 1/n^2, its stretch is 1e-3.
    let (mut low, mut high) = (0.05_f64, 5.0_f64);
    for _ in 0..80 {
        let a = 0.5 * (low + high);
        if 2.0 * a * (0.35 / a).sinh() > 1.0 { low = a } else { high = a }
    }
    let sag = low * ((0.35 / low).cosh() - 1.0);
    println!("sag {} against {sag} in {} iterations", -last.q[n + 1], last.iterations);
    assert!((-last.q[n + 1] - sag).abs() < 2.5e-3);
    // Left and right are the same, to the rounding floor of a soft direction.
    assert!((last.q[2 * 5 + 1] - last.q[2 * 15 + 1]).abs() < 1e-9);
}

#[test]
fn a_stiff_slender_chain_bends_far_in_one_call() {
    // Elastica by 16 stiff links with rotation springs at the joints: P L^2 / EI = 10, EA L^2 / EI = 1e8.
    let n = 16;
    let nodes = (0..=n).map(|i| [i as f64 / n as f64, 0.0]).collect();
    let mut truss = Truss::new(nodes, 1e8);
    truss.fix(0);
    truss.fix(1);
    for i in 0..n {
        truss.bar(i, i + 1);
    }
    for i in 1..n {
        truss.hinge(i, n as f64);
    }
    truss.load(n, [0.0, -10.0]);
    let path = solve(&mut truss, &StaticOptions::default()).unwrap();
    let last = path.last().unwrap();
    let tip = [last.q[2 * n], last.q[2 * n + 1]];
    println!("tip {tip:?}, {} iterations, last {:e}", last.iterations, last.last_increment);
    // Inextensible elastica at this load: tip (0.44500, -0.81061) (Mattiasson 1981). The first link is held
    // straight: its length of 1/16 and the discretisation leave a few hundredths.
    assert!((tip[0] - 0.445).abs() < 0.06 && (tip[1] + 0.8106).abs() < 0.06);
    assert!(last.last_increment < 1e-9);
    // The same in ten parts ends at the same point, to the rounding of forces against the softest mode: eps EA
    // L^2 / EI = 1e-8.
    let parts =
        solve(&mut truss, &StaticOptions { load_steps: 10, ..StaticOptions::default() }).unwrap();
    for (a, b) in last.q.iter().zip(&parts.last().unwrap().q) {
        assert!((a - b).abs() < 1e-8, "{a} {b}");
    }
}

#[test]
fn what_floats_free_is_named() {
    let mut truss = Truss::new(vec![[0.0, 0.0], [1.0, 0.0], [2.0, 0.3], [3.0, 0.0]], 1e3);
    truss.fix(0);
    truss.bar(0, 1);
    truss.bar(2, 3);
    truss.load(1, [1.0, 0.0]);
    truss.load(3, [0.1, 0.1]);
    let error = solve(&mut truss, &StaticOptions::default()).unwrap_err();
    println!("{error}");
    let Error::Singular { unknown, .. } = error else { panic!("{error}") };
    assert!(unknown >= 3, "node 0 is held, node 1 by tension in one direction only");
}

#[test]
fn a_search_does_not_go_through_what_is_in_its_way() {
    // A shallow truss that hangs, and is pulled down by its apex: it stiffens.
    let pulled = |floor: Option<f64>| {
        let mut truss = Truss::new(vec![[-1.0, 0.0], [1.0, 0.0], [0.0, -0.1]], 1e5);
        truss.fix(0);
        truss.fix(1);
        truss.bar(0, 2);
        truss.bar(1, 2);
        truss.load(2, [0.0, -2e3]);
        truss.floor = floor;
        solve(&mut truss, &StaticOptions::default())
    };
    let free = pulled(None).unwrap().pop().unwrap();
    let depth = free.q[5];
    assert!(depth < -0.2, "{depth}");
    // Newton's first increment goes deeper than the equilibrium: a floor between the two only shortens it.
    let low = pulled(Some(depth - 0.01)).unwrap().pop().unwrap();
    assert!((low.q[5] - depth).abs() < 1e-12, "{} {depth}", low.q[5]);
    assert!(low.iterations > 1);
    // One above it bars the way, and is named.
    let error = pulled(Some(depth + 0.05)).unwrap_err();
    let Error::Barred { failure, what } = &error else { panic!("{error}") };
    assert_eq!(what, "the floor");
    assert!(failure.iterations > 0 && error.to_string().contains("the floor"));
}

#[test]
fn polls_stop_the_search() {
    let mut truss = Truss::new(vec![[0.0, 0.0], [1.0, 0.0]], 1e3);
    truss.fix(0);
    truss.bar(0, 1);
    let (q, mut linear) = (truss.start.clone(), solver(&truss));
    let error = solve_static(
        &mut truss,
        linear.as_mut(),
        &q,
        &[0.0, 0.0],
        &StaticOptions::default(),
        &mut || true,
    )
    .unwrap_err();
    assert!(matches!(error, Error::Interrupted { .. }));
}

#[test]
fn sensitivities_agree_with_differences_and_with_the_adjoint() {
    let build = |ea: f64, p: f64| {
        let mut truss = Truss::new(vec![[-1.0, 0.0], [1.0, 0.2], [0.0, 0.5]], ea);
        truss.fix(0);
        truss.fix(1);
        truss.bar(0, 2);
        truss.bar(1, 2);
        truss.load(2, [0.3 * p, -p]);
        truss
    };
    let at = |ea: f64, p: f64| {
        let mut truss = build(ea, p);
        solve(&mut truss, &StaticOptions::default()).unwrap().pop().unwrap()
    };
    let (ea, p) = (1e3, 40.0);
    let point = at(ea, p);
    let mut truss = build(ea, p);
    let mut linear = solver(&truss);
    let all =
        static_sensitivities(&mut truss, linear.as_mut(), 1.0, &point.q, &point.lambda_).unwrap();
    // Parameter 0 of the test problem is EA. Central differences of 1e-5 EA: error 1e-10 relative, and rounding
    // 1e-16 / 1e-5.
    let e = 1e-5 * ea;
    let (up, down) = (at(ea + e, p), at(ea - e, p));
    let size = all[0].iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    for (i, s) in all[0].iter().enumerate() {
        let pick = |x: &StaticPoint| if i < 6 { x.q[i] } else { x.lambda_[i - 6] };
        let difference = (pick(&up) - pick(&down)) / (2.0 * e);
        assert!((s - difference).abs() < 1e-8 * size, "{i}: {s} against {difference}");
    }
    let g: Vec<f64> = (0..10).map(|i| 0.1 + 0.3 * i as f64).collect();
    let gradient =
        static_gradient(&mut truss, linear.as_mut(), 1.0, &point.q, &point.lambda_, &g).unwrap();
    for (p, s) in all.iter().enumerate() {
        let forward: f64 = s.iter().zip(&g).map(|(s, g)| s * g).sum();
        // Two solutions with the same factors: rounding.
        assert!((gradient[p] - forward).abs() < 1e-12 * forward.abs().max(1e-6));
    }
}
