//! Probes before faces of surfaces: action is reaction, the tangent is that of the force, the force that of the energy.

mod common;

use common::{LOCAL, laws};
use nalgebra::{Matrix3, Rotation3, Vector3};
use pliant_contact::foot::Foot;
use pliant_contact::net::{Feature, Form, Net, POINTS};
use pliant_contact::point::{Laws, Motion};
use pliant_contact::probe::{Blocks, Opposing, Pose, Slave};
use proptest::prelude::*;

const RADIUS: f64 = 0.03;
const HALF: f64 = 0.01;

/// Slave vectors (one or four), then control points.
struct Case {
    form: Form,
    body: bool,
    side: f64,
    x: Vec<Vector3<f64>>,
    v: Vec<Vector3<f64>>,
    moved: Vec<Vector3<f64>>,
    z: Vector3<f64>,
}

impl Case {
    fn own(&self) -> usize {
        if self.body { 4 } else { 1 }
    }

    fn net(&self, x: &[Vector3<f64>]) -> Net {
        let mut points = [Vector3::zeros(); POINTS];
        let from = self.own();
        points[..x.len() - from].copy_from_slice(&x[from..]);
        Net::new(self.form, points)
    }

    /// Foot, with the basis there.
    fn foot(&self, x: &[Vector3<f64>]) -> (Foot, pliant_contact::net::Basis, Feature) {
        let (slave, p) = if self.body {
            let pose = Pose { origin: x[0], axes: Matrix3::from_columns(&[x[1], x[2], x[3]]) };
            let local = Vector3::from(LOCAL);
            (Slave::Body(pose, local), pose.at(local))
        } else {
            (Slave::Point, x[0])
        };
        let near = self.net(x).nearest(p);
        let side = if near.feature == Feature::Inside { self.side } else { 1.0 };
        let foot =
            Foot::new((slave, p, RADIUS), (near.jet, HALF), (self.form, near.feature), side, 1.3);
        (foot, self.form.basis(near.at), near.feature)
    }

    fn gather(&self, x: &[Vector3<f64>], basis: &pliant_contact::net::Basis) -> [Vector3<f64>; 8] {
        let mut out = [Vector3::zeros(); 8];
        let own = self.own();
        out[..own].copy_from_slice(&x[..own]);
        for (k, x) in x[own..].iter().enumerate() {
            for row in 0..3 {
                out[4 + row] += x * basis[row][k];
            }
        }
        out
    }

    fn force(&self, laws: &Laws, x: &[Vector3<f64>], v: &[Vector3<f64>]) -> Vec<Vector3<f64>> {
        let (foot, basis, _) = self.foot(x);
        let moved: Vec<Vector3<f64>> =
            (0..x.len()).map(|k| self.moved[k] + x[k] - self.x[k]).collect();
        let (v, moved) = (self.gather(v, &basis), self.gather(&moved, &basis));
        let motion = Motion { v: &v, moved: &moved, h: 2e-3, z: self.z };
        let mut share = [Vector3::zeros(); 8];
        foot.add_force(foot.force(laws, &motion).total, &mut share);
        let own = self.own();
        let mut out = vec![Vector3::zeros(); x.len()];
        out[..own].copy_from_slice(&share[..own]);
        for k in 0..x.len() - own {
            out[own + k] = (0..3).map(|row| share[4 + row] * basis[row][k]).sum();
        }
        out
    }

    fn tangent(&self, laws: &Laws, factors: (f64, f64)) -> Vec<Vec<Matrix3<f64>>> {
        let (foot, basis, _) = self.foot(&self.x);
        let (v, moved) = (self.gather(&self.v, &basis), self.gather(&self.moved, &basis));
        let motion = Motion { v: &v, moved: &moved, h: 2e-3, z: self.z };
        let mut blocks: Blocks = [[Matrix3::zeros(); 8]; 8];
        foot.add_tangent(laws, &motion, factors, false, &mut blocks);
        let (own, n) = (self.own(), self.x.len());
        let mut weights = vec![[0.0; 8]; n];
        for k in 0..n {
            if k < own {
                weights[k][k] = 1.0;
            } else {
                (0..3).for_each(|row| weights[k][4 + row] = basis[row][k - own]);
            }
        }
        let mut out = vec![vec![Matrix3::zeros(); n]; n];
        for (k, row) in out.iter_mut().enumerate() {
            for (l, entry) in row.iter_mut().enumerate() {
                for a in 0..8 {
                    for b in 0..8 {
                        *entry += blocks[a][b] * (weights[k][a] * weights[l][b]);
                    }
                }
            }
        }
        out
    }
}

/// A curved face, and a probe some millimetres inside its thickness; above its inside, or beside a rim.
fn case(form: Form, body: bool, beside: bool, numbers: &[f64]) -> Case {
    let wild = |from: usize, size: f64| {
        Vector3::from_fn(|c, _| size * numbers[(from + c) % numbers.len()])
    };
    let mut points = [Vector3::zeros(); POINTS];
    for (k, p) in points.iter_mut().enumerate().take(form.points()) {
        let [u, v] = form.place(k);
        *p = Vector3::new(u, v, 0.0) + wild(3 * k, 0.08);
    }
    let net = Net::new(form, points);
    let at = if beside { [0.4 + 0.1 * numbers[0], 0.0] } else { [0.3 + 0.1 * numbers[1], 0.3] };
    let jet = net.jet(at);
    let side = if numbers[2] > 0.0 { 1.0 } else { -1.0 };
    let mut n = jet.normal() * side;
    if beside {
        let t = jet.slopes[0].normalize();
        let out = t.cross(&jet.normal());
        n = (n + out * 1.5).normalize();
    }
    let p = jet.r + n * (RADIUS + HALF - 4e-3);
    let own = Rotation3::new(wild(4, 1.0));
    let mut x = if body {
        let axes = [0, 1, 2].map(|k| own * Vector3::ith(k, 1.0));
        vec![p - own * Vector3::from(LOCAL), axes[0], axes[1], axes[2]]
    } else {
        vec![p]
    };
    x.extend_from_slice(&points[..form.points()]);
    let v = (0..x.len()).map(|k| wild(5 * k, 0.5)).collect();
    let moved = (0..x.len()).map(|k| wild(7 * k + 3, 1e-3)).collect();
    let z = wild(2, 0.01);
    Case { form, body, side, x, v, moved, z: z - n * n.dot(&z) }
}

fn cases(numbers: &[f64]) -> Vec<Case> {
    let mut all = Vec::new();
    for form in [Form::Square, Form::Triangle] {
        for body in [false, true] {
            for beside in [false, true] {
                all.push(case(form, body, beside, numbers));
            }
        }
    }
    all
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn tangent_is_the_derivative_of_the_force(numbers in prop::collection::vec(-1.0..1.0_f64, 51)) {
        for case in cases(&numbers) {
            let (here, _, feature) = case.foot(&case.x);
            prop_assert!(here.gap() < 0.0);
            for (friction, factors) in [(false, (1.0, 0.0)), (true, (1.0, 0.0)), (true, (0.0, 1.0))] {
                let laws = laws(friction);
                let blocks = case.tangent(&laws, factors);
                let size = blocks.iter().flatten().map(|b| b.amax()).fold(1.0, f64::max);
                let e = 1e-7;
                for l in 0..case.x.len() {
                    for c in 0..3 {
                        let shifted = |sign: f64| {
                            let (mut x, mut v) = (case.x.clone(), case.v.clone());
                            if factors.0 == 0.0 { v[l][c] += sign * e } else { x[l][c] += sign * e }
                            (case.force(&laws, &x, &v), case.foot(&x).2)
                        };
                        let ((up, one), (down, two)) = (shifted(1.0), shifted(-1.0));
                        if one != feature || two != feature { continue; }
                        for k in 0..case.x.len() {
                            let expected = (up[k] - down[k]) / (2.0 * e);
                            let got: Vector3<f64> = blocks[k][l].column(c).into();
                            // Differences: e^2 times third derivatives (1/ramp^2), and rounding over e.
                            prop_assert!((expected - got).amax() < 2e-5 * size,
                                "{:?} {feature:?} body {} {friction} ({k}, {l}, {c}): {expected} {got}", case.form, case.body);
                        }
                    }
                }
            }
        }
    }

    #[test]
    fn momenta_are_kept(numbers in prop::collection::vec(-1.0..1.0_f64, 51)) {
        for case in cases(&numbers) {
            for friction in [false, true] {
                let f = case.force(&laws(friction), &case.x, &case.v);
                let size = f.iter().map(|f| f.norm()).fold(1e-12, f64::max);
                let own = if case.body { 1 } else { case.own() };
                let points = &f[case.own()..];
                let sum: Vector3<f64> = f[..own].iter().sum::<Vector3<f64>>() + points.iter().sum::<Vector3<f64>>();
                // Rounding.
                prop_assert!(sum.norm() < 1e-12 * size, "{sum}");
                if !friction {
                    let moment: Vector3<f64> = case.x.iter().zip(&f).map(|(x, f)| x.cross(f)).sum();
                    // The foot is found to 1e-9 of the distance where the probe looks straight up from a side.
                    prop_assert!(moment.norm() < 1e-9 * size, "{moment}");
                }
            }
        }
    }

    #[test]
    fn force_is_the_slope_of_the_energy(numbers in prop::collection::vec(-1.0..1.0_f64, 51)) {
        for case in cases(&numbers) {
            let mut laws = laws(false);
            laws.normal.c = 0.0;
            let feature = case.foot(&case.x).2;
            let mut case = case;
            if case.body {
                // Its axes turn.
                let spin = case.v[1];
                (1..4).for_each(|k| case.v[k] = spin.cross(&case.x[k]));
            }
            let f = case.force(&laws, &case.x, &case.v);
            let power: f64 = f.iter().zip(&case.v).map(|(f, v)| f.dot(v)).sum();
            let e = 1e-6;
            let energy = |sign: f64| {
                let x: Vec<Vector3<f64>> = case.x.iter().zip(&case.v).map(|(x, v)| x + v * (sign * e)).collect();
                let (foot, _, feature) = case.foot(&x);
                (laws.normal.energy(-foot.gap()) * 1.3, feature)
            };
            let ((up, one), (down, two)) = (energy(1.0), energy(-1.0));
            if one != feature || two != feature { continue; }
            let rate = (up - down) / (2.0 * e);
            // Second order in e.
            prop_assert!((power - rate).abs() < 1e-5 * (1.0 + power.abs()), "{power} {rate}");
        }
    }
}
