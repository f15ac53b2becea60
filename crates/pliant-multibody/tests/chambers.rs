//! Chambers: forces of the gas against differences of the volume, the tangent against differences of both.
#![allow(missing_docs, clippy::unwrap_used)]

mod support;

use pliant_dae::problem::{Point, Problem, Weights};
use pliant_multibody::model::Model;
use pliant_multibody::spec::{
    Array, ChamberSpec, ClosureSpec, FacesSpec, GasSpec, ModelSpec, RimSpec, SidesSpec,
};
use pliant_multibody::system::{Mode, System};
use std::sync::Arc;

const N: [usize; 2] = [2, 2];
const SIZE: [f64; 2] = [0.4, 0.5];
/// Sides (face, side) at u = 0, u = max, v = 0, v = max; side 0 runs along u.
const SIDES: [[[usize; 2]; 2]; 4] =
    [[[0, 3], [1, 3]], [[2, 1], [3, 1]], [[0, 0], [2, 0]], [[1, 2], [3, 2]]];
const FREE: ClosureSpec = ClosureSpec::Lid {
    projection: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
    shift: [0.0; 3],
};

fn rim(sides: &[[usize; 2]], closure: ClosureSpec) -> RimSpec {
    let rows = sides.iter().flatten().map(|&x| x as f64).collect();
    RimSpec { sides: vec![SidesSpec { surface: 0, sides: Array::Inline(rows) }], closure }
}

/// An arch over the unit of its rims, closed by them.
fn document(rims: Vec<RimSpec>, origin: [f64; 3]) -> ModelSpec {
    let mut document = support::document([0.0; 3], Vec::new(), Vec::new());
    let mut sheet = support::sheet(N, SIZE, 400.0, 0.02);
    let Array::Inline(mut q) = sheet.reference.clone() else { unreachable!() };
    for node in q.chunks_exact_mut(12) {
        let (x, y) = (node[0] / SIZE[0] - 1.0, node[1] / SIZE[1] - 1.0);
        node[2] = 0.3 * (1.0 - x * x) * (1.0 - y * y);
    }
    sheet.q = Array::Inline(q);
    document.surfaces = vec![sheet];
    let faces = Array::Inline((0..4).map(f64::from).collect());
    document.chambers = vec![ChamberSpec {
        name: "gas".to_owned(),
        faces: vec![FacesSpec { surface: 0, faces }],
        rims,
        origin,
        gas: GasSpec { pressure: 1500.0, temperature: 300.0, exponent: 1.4, gas_constant: 287.0 },
        mass: None,
        inflow: None,
        ambient: 1000.0,
    }];
    document
}

struct Found {
    force: Vec<f64>,
    phi: f64,
}

struct Case {
    system: System,
    n: usize,
}

impl Case {
    fn new(document: &ModelSpec) -> Self {
        let model = Arc::new(Model::new(document, &[]).unwrap());
        let mut system = System::new(model.clone(), Mode::Dynamic, None, false);
        system.begin(0.0, model.initial_q());
        Self { system, n: model.coordinates() }
    }

    fn start(&self) -> Vec<f64> {
        self.system.model().initial_q().to_vec()
    }

    fn at(&mut self, q: &[f64], lambda_: f64) -> Found {
        let (mut force, mut phi) = (vec![0.0; self.n], vec![0.0]);
        let zero = vec![0.0; self.n];
        let at = Point { t: 0.0, q, v: &zero, a: &zero, lambda_: &[lambda_] };
        self.system.residual(at, &mut force, &mut phi).unwrap();
        Found { force, phi: phi[0] }
    }

    /// The matrix with these weights times `(x, mu)`.
    fn product(&mut self, q: &[f64], lambda_: f64, weights: [f64; 2], x: &[f64]) -> Vec<f64> {
        let zero = vec![0.0; self.n];
        let at = Point { t: 0.0, q, v: &zero, a: &zero, lambda_: &[lambda_] };
        let [stiffness, jacobian] = weights;
        let weights = Weights { mass: 0.0, damping: 0.0, stiffness, jacobian };
        let mut values = vec![0.0; self.system.structure().values()];
        self.system.tangent(at, weights, &mut values);
        let mut out = vec![0.0; self.n + 1];
        self.system.structure().multiply_add(&values, x, &mut out, false);
        out
    }
}

fn noise(n: usize, seed: f64) -> Vec<f64> {
    (0..n).map(|i| (1.7 * (i + 1) as f64 + 12.3 * seed).sin()).collect()
}

fn moved(x: &[f64], by: &[f64], factor: f64) -> Vec<f64> {
    x.iter().zip(by).map(|(x, d)| x + factor * d).collect()
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Along `by` from `q`: the force of the gas is `lambda_` times the slope of the volume, the tangent the slope of both.
fn check(case: &mut Case, q: &[f64], by: &[f64]) {
    let (lambda_, h) = (-430.0, 1e-5);
    let (plus, minus) = (case.at(&moved(q, by, h), lambda_), case.at(&moved(q, by, -h), lambda_));
    let slope = (plus.phi - minus.phi) / (2.0 * h);
    let gas = moved(&case.at(q, lambda_).force, &case.at(q, 0.0).force, -1.0);
    let work = dot(&gas, by);
    // Central differences of a cubic: h^2 of volumes of a tenth.
    assert!((work - lambda_ * slope).abs() < 1e-7 * work.abs().max(1.0), "{work}, {slope}");
    let mut x = by.to_vec();
    x.push(0.0);
    let stiffness = 0.7;
    let product = case.product(q, lambda_, [stiffness, 1.0], &x);
    assert!((product[case.n] - slope).abs() < 1e-8, "{} and {slope}", product[case.n]);
    let rates: Vec<f64> =
        plus.force.iter().zip(&minus.force).map(|(p, m)| (p - m) / (2.0 * h)).collect();
    let (found, expected) = (dot(&product[..case.n], by), stiffness * dot(&rates, by));
    assert!((found - expected).abs() < 1e-6 * expected.abs(), "{found} and {expected}");
}

#[test]
fn gas_under_a_lid_has_a_potential() {
    let all: Vec<[usize; 2]> = SIDES.concat();
    let mut case = Case::new(&document(vec![rim(&all, FREE)], [0.2, -0.1, 0.3]));
    for seed in [1.0, 2.0, 3.0] {
        let q = moved(&case.start(), &noise(case.n, seed), 0.05);
        let by = noise(case.n, seed + 10.0);
        check(&mut case, &q, &by);
        // Every row of the tangent, for there is nothing that moves may not do.
        let h = 1e-5;
        let mut x = by.clone();
        x.push(0.0);
        let product = case.product(&q, -430.0, [1.0, 1.0], &x);
        let (plus, minus) =
            (case.at(&moved(&q, &by, h), -430.0), case.at(&moved(&q, &by, -h), -430.0));
        for i in 0..case.n {
            let slope = (plus.force[i] - minus.force[i]) / (2.0 * h);
            assert!((slope - product[i]).abs() < 1e-5 * slope.abs().max(10.0), "row {i}");
        }
    }
}

/// Forces of a closed volume have no resultant and no moment, wherever it is counted from.
#[test]
fn closed_gas_moves_nothing() {
    let all: Vec<[usize; 2]> = SIDES.concat();
    for origin in [[0.0; 3], [3.0, -2.0, 5.0]] {
        let mut case = Case::new(&document(vec![rim(&all, FREE)], origin));
        let q = moved(&case.start(), &noise(case.n, 1.0), 0.05);
        let gas = moved(&case.at(&q, -430.0).force, &case.at(&q, 0.0).force, -1.0);
        let largest = gas.iter().fold(0.0_f64, |m, f| m.max(f.abs()));
        for axis in 0..3 {
            let shift: f64 = gas.chunks_exact(12).map(|node| node[axis]).sum();
            let (a, b) = ((axis + 1) % 3, (axis + 2) % 3);
            let turns = gas.chunks_exact(3).zip(q.chunks_exact(3));
            let turn: f64 = turns.map(|(f, x)| x[a] * f[b] - x[b] * f[a]).sum();
            // Rounding of about a hundred terms.
            assert!(shift.abs() < 1e-11 * largest, "{axis}: {shift:e}");
            assert!(turn.abs() < 1e-11 * largest, "{axis}: {turn:e}");
        }
    }
}

/// A rim in a plane of symmetry and one that is held: motions that keep both.
#[test]
fn gas_behind_held_rims_has_a_potential() {
    let plane = |apex: [f64; 3]| ClosureSpec::Plane { apex, normal: [1.0, 0.0, 0.0] };
    let held = ClosureSpec::Held { apex: [0.4, 0.5, 0.0] };
    for (apex, origin) in [([0.0, 0.4, 0.1], [0.0, 0.4, 0.1]), ([0.0, 0.5, 0.0], [0.3, 0.5, 0.0])] {
        let rims = vec![
            rim(&SIDES[0], plane(apex)),
            rim(&SIDES[1], held),
            rim(&SIDES[2], held),
            rim(&SIDES[3], held),
        ];
        let mut case = Case::new(&document(rims, origin));
        let keep = |x: &mut [f64]| {
            for (node, x) in x.chunks_exact_mut(12).enumerate() {
                let (i, j) = (node / (N[1] + 1), node % (N[1] + 1));
                if i == N[0] || j == 0 || j == N[1] {
                    // The position and the slope along the edge.
                    x[..3].fill(0.0);
                    let along = if i == N[0] { 6 } else { 3 };
                    x[along..along + 3].fill(0.0);
                    if i == N[0] && (j == 0 || j == N[1]) {
                        x[3..6].fill(0.0);
                    }
                }
                if i == 0 {
                    x[0] = 0.0;
                    x[6] = 0.0;
                }
            }
        };
        for seed in [1.0, 2.0] {
            let (mut by, mut shape) = (noise(case.n, seed + 10.0), noise(case.n, seed));
            keep(&mut by);
            keep(&mut shape);
            let q = moved(&case.start(), &shape, 0.05);
            check(&mut case, &q, &by);
        }
    }
}

/// Where the stiffness has no weight the row reads `d lambda_ = 0`, and the law gives the pressure.
#[test]
fn coordinates_determine_the_pressure() {
    let all: Vec<[usize; 2]> = SIDES.concat();
    let mut case = Case::new(&document(vec![rim(&all, FREE)], [0.0; 3]));
    let q = case.start();
    let mut lambda_ = [0.0];
    case.system.determine(0.0, &q, &mut lambda_);
    assert!((lambda_[0] + 500.0).abs() < 1e-9, "gauge pressure at the start");
    assert!(case.at(&q, lambda_[0]).phi.abs() < 1e-15);
    let q = moved(&q, &noise(case.n, 1.0), 0.05);
    case.system.determine(0.0, &q, &mut lambda_);
    assert!(case.at(&q, lambda_[0]).phi.abs() < 1e-15);
    let mut x = noise(case.n, 2.0);
    x.push(1.0);
    let row = case.product(&q, lambda_[0], [0.0, 1.0], &x);
    assert_eq!(row[case.n], -1.0);
    assert!(row[..case.n].iter().all(|x| *x == 0.0));
    // The diagonal is the derivative of phi by the multiplier, in units of the stiffness.
    let mut x = vec![0.0; case.n];
    x.push(1.0);
    let h = 1e-2;
    let at = |case: &mut Case, d: f64| case.at(&q, lambda_[0] + d).phi;
    let slope = (at(&mut case, h) - at(&mut case, -h)) / (2.0 * h);
    let row = case.product(&q, lambda_[0], [0.25, 1.0], &x);
    assert!((0.25 * row[case.n] / slope - 1.0).abs() < 1e-8);
}

#[test]
fn a_volume_below_zero_is_refused() {
    let all: Vec<[usize; 2]> = SIDES.concat();
    let mut document = document(vec![rim(&all, FREE)], [0.0; 3]);
    let Array::Inline(q) = &mut document.surfaces[0].q else { unreachable!() };
    for node in q.chunks_exact_mut(12) {
        node[2] = -node[2];
    }
    let error = Model::new(&document, &[]).err().unwrap().to_string();
    assert!(error.contains("chamber 'gas'") && error.contains("normals"), "{error}");
}
