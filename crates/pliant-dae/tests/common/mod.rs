//! Small problems with known solutions.
#![allow(dead_code, missing_docs, clippy::unwrap_used)]

use pliant_dae::linear_solver::{self, LinearSolver};
use pliant_dae::problem::{EvaluationError, Kinks, Point, Problem, Weights};
use pliant_dae::structure::{Storage, Structure};

/// The solver that this structure gets by default.
pub fn solver(problem: &impl Problem) -> Box<dyn LinearSolver> {
    linear_solver::analyze(problem.structure(), linear_solver::Options::default()).unwrap()
}

/// Slope of `log error` over `log h` by least squares.
pub fn order(h: &[f64], error: &[f64]) -> f64 {
    let n = h.len() as f64;
    let (x, y): (Vec<f64>, Vec<f64>) = h.iter().zip(error).map(|(h, e)| (h.ln(), e.ln())).unzip();
    let (mx, my) = (x.iter().sum::<f64>() / n, y.iter().sum::<f64>() / n);
    let xy: f64 = x.iter().zip(&y).map(|(x, y)| (x - mx) * (y - my)).sum();
    let xx: f64 = x.iter().map(|x| (x - mx) * (x - mx)).sum();
    xy / xx
}

/// Where a comparison belongs in the report: the test's file and a line about it.
pub struct Chapter {
    pub file: &'static str,
    pub about: &'static str,
}

impl Chapter {
    /// Asserts `|achieved - reference| <= tolerance`, and prints the comparison as the line of JSON that
    /// `docs/build_validation.py` reads.
    pub fn record(&self, name: &str, achieved: f64, reference: f64, tolerance: f64, unit: &str) {
        let error = (achieved - reference).abs();
        let passed = error <= tolerance;
        println!(
            "validation: {{\"name\": \"{name}\", \"achieved\": {achieved:e}, \"reference\": {reference:e}, \
             \"error\": {error:e}, \"tolerance\": {tolerance:e}, \"unit\": \"{unit}\", \"source\": \"\", \
             \"passed\": {passed}, \"test\": \"{}\", \"about\": \"{}\"}}",
            self.file, self.about
        );
        assert!(passed, "{name}: {achieved} instead of {reference}, off by {error:e}");
    }
}

/// Writes a dense matrix, row by row, into the only element of a structure.
pub fn one_element(velocities: usize, multipliers: usize, storage: Storage) -> Structure {
    let mut structure = Structure::new(velocities, multipliers);
    let mut groups = vec![structure.add_group(0..velocities)];
    if multipliers > 0 {
        groups.push(structure.add_group(velocities..velocities + multipliers));
    }
    structure.add_element(&groups, storage);
    structure
}

/// A point mass of 1 kg on a rigid massless rod of 1 m in a plane: `phi = (|q|^2 - 1)/2`, so that `lambda_` is the
/// tension in N/m.
pub struct Pendulum {
    pub structure: Structure,
    pub calls: usize,
    /// The force is not finite from this time on.
    pub broken_from: f64,
    /// The evaluation fails, recoverably, for steps longer than this.
    pub last_t: f64,
    pub longest_step: f64,
}

pub const G: f64 = 9.81;

impl Pendulum {
    pub fn new() -> Self {
        Self {
            structure: one_element(2, 1, Storage::Full),
            calls: 0,
            broken_from: f64::INFINITY,
            last_t: 0.0,
            longest_step: f64::INFINITY,
        }
    }

    pub fn energy(q: &[f64], v: &[f64]) -> f64 {
        0.5 * (v[0] * v[0] + v[1] * v[1]) + G * q[1]
    }

    /// Angle below the horizontal, its rate, and the multiplier at time `t` after a horizontal start at rest, by
    /// the classical Runge-Kutta scheme in the angle with 20,000 steps a second (error below 1e-13).
    pub fn exact(times: &[f64]) -> Vec<[f64; 5]> {
        let (mut angle, mut rate, mut done) = (0.0_f64, 0.0_f64, 0_usize);
        let dt = 5e-5;
        let f = |angle: f64| -G * angle.cos();
        let mut out = Vec::new();
        for &t in times {
            let target = (t / dt).round() as usize;
            while done < target {
                let k1 = (rate, f(angle));
                let k2 = (rate + 0.5 * dt * k1.1, f(angle + 0.5 * dt * k1.0));
                let k3 = (rate + 0.5 * dt * k2.1, f(angle + 0.5 * dt * k2.0));
                let k4 = (rate + dt * k3.1, f(angle + dt * k3.0));
                angle += dt / 6.0 * (k1.0 + 2.0 * k2.0 + 2.0 * k3.0 + k4.0);
                rate += dt / 6.0 * (k1.1 + 2.0 * k2.1 + 2.0 * k3.1 + k4.1);
                done += 1;
            }
            let (s, c) = angle.sin_cos();
            out.push([c, s, -s * rate, c * rate, rate * rate - G * s]);
        }
        out
    }
}

impl Problem for Pendulum {
    fn coordinates(&self) -> usize {
        2
    }
    fn velocities(&self) -> usize {
        2
    }
    fn multipliers(&self) -> usize {
        1
    }
    fn structure(&self) -> &Structure {
        &self.structure
    }
    fn scale(&self) -> &[f64] {
        &[1.0, 1.0]
    }
    fn constraint_scale(&self) -> &[f64] {
        &[1.0]
    }
    fn has_damping(&self) -> bool {
        false
    }
    fn residual(
        &mut self,
        at: Point<'_>,
        force: &mut [f64],
        phi: &mut [f64],
    ) -> Result<(), EvaluationError> {
        self.calls += 1;
        if at.t - self.last_t > self.longest_step {
            return Err(EvaluationError { message: "too far".into(), recoverable: true });
        }
        force[0] = at.a[0] + at.q[0] * at.lambda_[0];
        force[1] = at.a[1] + G + at.q[1] * at.lambda_[0];
        if at.t >= self.broken_from {
            force[1] = f64::NAN;
        }
        phi[0] = 0.5 * (at.q[0] * at.q[0] + at.q[1] * at.q[1] - 1.0);
        Ok(())
    }
    fn tangent(&mut self, at: Point<'_>, w: Weights, values: &mut Vec<f64>) {
        let d = w.mass + w.stiffness * at.lambda_[0];
        let (x, y) = (w.jacobian * at.q[0], w.jacobian * at.q[1]);
        values.copy_from_slice(&[d, 0.0, x, 0.0, d, y, x, y, 0.0]);
    }
    fn constraint_acceleration(&mut self, at: Point<'_>, out: &mut [f64]) {
        out[0] = at.v[0] * at.v[0] + at.v[1] * at.v[1];
    }
    fn constraint_jerk(&mut self, at: Point<'_>, out: &mut [f64]) {
        out[0] = 3.0 * (at.v[0] * at.a[0] + at.v[1] * at.a[1]);
    }
    fn accept(&mut self, _: Point<'_>, after: Point<'_>) {
        self.last_t = after.t;
    }
    fn describe(&self, unknown: usize) -> String {
        ["x of the bob", "y of the bob", "length of the rod"][unknown].into()
    }
}

/// Nodes in a plane with unit masses, bars of Green's strain, rotation springs, dead loads in proportion to time,
/// and nodes held by constraints. Parameter 0 is the stiffness EA of all bars.
pub struct Truss {
    pub structure: Structure,
    pub start: Vec<f64>,
    pub ea: f64,
    pub masses: Vec<f64>,
    /// Ends, reference length, group of the element in order.
    bars: Vec<(usize, usize, f64)>,
    /// Middle node and stiffness: energy `k/2 sin^2`-like, `k (1 - cos(angle))` of unit-length links.
    hinges: Vec<(usize, f64)>,
    loads: Vec<(usize, [f64; 2])>,
    fixed: Vec<usize>,
    scale: Vec<f64>,
    ones: Vec<f64>,
    /// Force of a cubic spring to the ground at every node.
    pub cubic: f64,
    /// Whether bars are strings, which pull and do not push.
    pub strings: bool,
    /// Whether the integrator is told.
    pub tells_kinks: bool,
    /// Height below which a search for equilibria takes no node.
    pub floor: Option<f64>,
}

impl Truss {
    pub fn new(nodes: Vec<[f64; 2]>, ea: f64) -> Self {
        let n = nodes.len();
        let mut truss = Self {
            structure: Structure::default(),
            start: nodes.into_iter().flatten().collect(),
            ea,
            masses: vec![1.0; n],
            bars: Vec::new(),
            hinges: Vec::new(),
            loads: Vec::new(),
            fixed: Vec::new(),
            scale: vec![1.0; 2 * n],
            ones: Vec::new(),
            cubic: 0.0,
            strings: false,
            floor: None,
            tells_kinks: false,
        };
        truss.build();
        truss
    }

    /// Elements: masses, bars, hinges, supports, in this order.
    fn build(&mut self) {
        let n = self.masses.len();
        let mut s = Structure::new(2 * n, 2 * self.fixed.len());
        let nodes: Vec<_> = (0..n).map(|i| s.add_group(2 * i..2 * i + 2)).collect();
        for &g in &nodes {
            s.add_element(&[g], Storage::Full);
        }
        for &(i, j, _) in &self.bars {
            s.add_element(&[nodes[i], nodes[j]], Storage::Full);
        }
        for &(i, _) in &self.hinges {
            s.add_element(&[nodes[i - 1], nodes[i], nodes[i + 1]], Storage::Full);
        }
        for (k, &i) in self.fixed.iter().enumerate() {
            let g = s.add_group(2 * n + 2 * k..2 * n + 2 * k + 2);
            s.add_element(&[nodes[i], g], Storage::Full);
        }
        self.structure = s;
        self.ones = vec![1.0; 2 * self.fixed.len()];
    }

    pub fn fix(&mut self, node: usize) {
        self.fixed.push(node);
        self.build();
    }

    pub fn bar(&mut self, i: usize, j: usize) {
        let (dx, dy) =
            (self.start[2 * j] - self.start[2 * i], self.start[2 * j + 1] - self.start[2 * i + 1]);
        self.bar_of_length(i, j, dx.hypot(dy));
    }

    pub fn bar_of_length(&mut self, i: usize, j: usize, length: f64) {
        self.bars.push((i, j, length));
        self.build();
    }

    /// Energy `k/2 |u2 - u1|^2` of the two links at a node, u being the link vectors over their length.
    pub fn hinge(&mut self, node: usize, k: f64) {
        self.hinges.push((node, k));
        self.build();
    }

    pub fn load(&mut self, node: usize, force: [f64; 2]) {
        self.loads.push((node, force));
    }
}

impl Problem for Truss {
    fn coordinates(&self) -> usize {
        self.start.len()
    }
    fn velocities(&self) -> usize {
        self.start.len()
    }
    fn multipliers(&self) -> usize {
        2 * self.fixed.len()
    }
    fn structure(&self) -> &Structure {
        &self.structure
    }
    fn scale(&self) -> &[f64] {
        &self.scale
    }
    fn constraint_scale(&self) -> &[f64] {
        &self.ones
    }
    fn kinks(&self) -> Kinks {
        if self.tells_kinks { Kinks::Many } else { Kinks::None }
    }
    fn has_damping(&self) -> bool {
        false
    }
    fn way(&mut self, q: &[f64], increment: &[f64]) -> (f64, Option<String>) {
        let Some(floor) = self.floor else { return (1.0, None) };
        let parts = q
            .iter()
            .zip(increment)
            .skip(1)
            .step_by(2)
            .map(|(y, d)| if y + d < floor { (floor - y) / d } else { 1.0 });
        let part = parts.fold(1.0, f64::min);
        (part, (part < 1.0).then(|| "the floor".to_owned()))
    }
    fn residual(
        &mut self,
        at: Point<'_>,
        force: &mut [f64],
        phi: &mut [f64],
    ) -> Result<(), EvaluationError> {
        for (i, m) in self.masses.iter().enumerate() {
            for c in [2 * i, 2 * i + 1] {
                force[c] = m * at.a[c] + self.cubic * at.q[c].powi(3);
            }
        }
        for &(i, j, l0) in &self.bars {
            let d = [at.q[2 * j] - at.q[2 * i], at.q[2 * j + 1] - at.q[2 * i + 1]];
            let strain = 0.5 * (d[0] * d[0] + d[1] * d[1] - l0 * l0) / (l0 * l0);
            let strain = if self.strings { strain.max(0.0) } else { strain };
            for c in 0..2 {
                force[2 * i + c] -= self.ea * strain * d[c] / l0;
                force[2 * j + c] += self.ea * strain * d[c] / l0;
            }
        }
        for &(i, k) in &self.hinges {
            let s = self.start[2 * i] - self.start[2 * i - 2];
            for c in 0..2 {
                let at = |n: usize| at.q[2 * n + c];
                let f = k / (s * s) * (at(i + 1) - 2.0 * at(i) + at(i - 1));
                force[2 * (i - 1) + c] += f;
                force[2 * i + c] -= 2.0 * f;
                force[2 * (i + 1) + c] += f;
            }
        }
        for &(i, f) in &self.loads {
            force[2 * i] -= at.t * f[0];
            force[2 * i + 1] -= at.t * f[1];
        }
        for (k, &i) in self.fixed.iter().enumerate() {
            for c in 0..2 {
                force[2 * i + c] += at.lambda_[2 * k + c];
                phi[2 * k + c] = at.q[2 * i + c] - self.start[2 * i + c];
            }
        }
        Ok(())
    }
    fn tangent(&mut self, at: Point<'_>, w: Weights, values: &mut Vec<f64>) {
        let mut rest = values.as_mut_slice();
        let mut next = |n: usize| {
            let (now, later) = std::mem::take(&mut rest).split_at_mut(n * n);
            rest = later;
            now.fill(0.0);
            now
        };
        for (i, m) in self.masses.iter().enumerate() {
            let k = next(2);
            for c in 0..2 {
                k[3 * c] = w.mass * m + w.stiffness * 3.0 * self.cubic * at.q[2 * i + c].powi(2);
            }
        }
        for &(i, j, l0) in &self.bars {
            let k = next(4);
            let d = [at.q[2 * j] - at.q[2 * i], at.q[2 * j + 1] - at.q[2 * i + 1]];
            let strain = 0.5 * (d[0] * d[0] + d[1] * d[1] - l0 * l0) / (l0 * l0);
            if self.strings && strain <= 0.0 {
                continue;
            }
            for a in 0..2 {
                for b in 0..2 {
                    let unit = if a == b { 1.0 } else { 0.0 };
                    let x = w.stiffness * self.ea / l0 * (strain * unit + d[a] * d[b] / (l0 * l0));
                    k[4 * a + b] = x;
                    k[4 * a + b + 2] = -x;
                    k[4 * (a + 2) + b] = -x;
                    k[4 * (a + 2) + b + 2] = x;
                }
            }
        }
        for &(i, stiffness) in &self.hinges {
            let k = next(6);
            let s = self.start[2 * i] - self.start[2 * i - 2];
            let second = [1.0, -2.0, 1.0];
            for a in 0..3 {
                for b in 0..3 {
                    for c in 0..2 {
                        k[6 * (2 * a + c) + 2 * b + c] =
                            w.stiffness * stiffness / (s * s) * second[a] * second[b];
                    }
                }
            }
        }
        for _ in &self.fixed {
            let k = next(4);
            for c in 0..2 {
                k[4 * c + 2 + c] = w.jacobian;
                k[4 * (2 + c) + c] = w.jacobian;
            }
        }
    }
    fn constraint_acceleration(&mut self, _: Point<'_>, out: &mut [f64]) {
        out.fill(0.0);
    }
    fn constraint_jerk(&mut self, _: Point<'_>, out: &mut [f64]) {
        out.fill(0.0);
    }
    fn parameters(&self) -> usize {
        1
    }
    fn parameter_derivative(
        &mut self,
        at: Point<'_>,
        _: usize,
        force: &mut [f64],
        phi: &mut [f64],
    ) {
        force.fill(0.0);
        phi.fill(0.0);
        for &(i, j, l0) in &self.bars {
            let d = [at.q[2 * j] - at.q[2 * i], at.q[2 * j + 1] - at.q[2 * i + 1]];
            let strain = 0.5 * (d[0] * d[0] + d[1] * d[1] - l0 * l0) / (l0 * l0);
            for c in 0..2 {
                force[2 * i + c] -= strain * d[c] / l0;
                force[2 * j + c] += strain * d[c] / l0;
            }
        }
    }
    fn describe(&self, unknown: usize) -> String {
        let n = self.start.len();
        if unknown < n {
            format!("{} of node {}", ["x", "y"][unknown % 2], unknown / 2)
        } else {
            format!("support of node {}", self.fixed[(unknown - n) / 2])
        }
    }
}
