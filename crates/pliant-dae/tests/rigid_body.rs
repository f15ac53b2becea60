//! A free rigid body with a unit quaternion: seven coordinates, six velocities, and the same body held at a point.
#![allow(missing_docs, clippy::unwrap_used)]

mod common;

use common::{Chapter, one_element, order, solver};
use pliant_dae::generalized_alpha::{Integrator, Options, State};
use pliant_dae::problem::{EvaluationError, Point, Problem, Weights};
use pliant_dae::structure::{Storage, Structure};

const CHAPTER: Chapter = Chapter {
    file: "crates/pliant-dae/tests/rigid_body.rs",
    about: "A rigid body with a unit quaternion, free and held at a point, against a fine Runge-Kutta integration.",
};

type V3 = [f64; 3];

fn cross(a: V3, b: V3) -> V3 {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// Rotates a vector by a quaternion (w, x, y, z).
fn rotate(p: &[f64], x: V3) -> V3 {
    let u = [p[1], p[2], p[3]];
    let t = cross(u, x);
    let t2 = cross(u, t);
    std::array::from_fn(|i| x[i] + 2.0 * (p[0] * t[i] + t2[i]))
}

fn back(p: &[f64], x: V3) -> V3 {
    rotate(&[p[0], -p[1], -p[2], -p[3]], x)
}

fn product(p: &[f64], r: [f64; 4]) -> [f64; 4] {
    [
        p[0] * r[0] - p[1] * r[1] - p[2] * r[2] - p[3] * r[3],
        p[0] * r[1] + p[1] * r[0] + p[2] * r[3] - p[3] * r[2],
        p[0] * r[2] - p[1] * r[3] + p[2] * r[0] + p[3] * r[1],
        p[0] * r[3] + p[1] * r[2] - p[2] * r[1] + p[3] * r[0],
    ]
}

/// Position of the centre of mass in space, quaternion from body to space; velocity in space, angular velocity in
/// the body. If held, the body's point `-arm` stays at the origin.
struct Body {
    structure: Structure,
    mass: f64,
    inertia: V3,
    gravity: f64,
    arm: V3,
    held: bool,
}

impl Body {
    fn new(mass: f64, inertia: V3, gravity: f64, arm: V3, held: bool) -> Self {
        let structure = one_element(6, if held { 3 } else { 0 }, Storage::Full);
        Self { structure, mass, inertia, gravity, arm, held }
    }

    fn gyroscopic(&self, w: V3) -> V3 {
        cross(w, std::array::from_fn(|i| self.inertia[i] * w[i]))
    }
}

fn three(x: &[f64]) -> V3 {
    [x[0], x[1], x[2]]
}

impl Problem for Body {
    fn coordinates(&self) -> usize {
        7
    }
    fn velocities(&self) -> usize {
        6
    }
    fn multipliers(&self) -> usize {
        if self.held { 3 } else { 0 }
    }
    fn structure(&self) -> &Structure {
        &self.structure
    }
    fn scale(&self) -> &[f64] {
        &[1.0; 6]
    }
    fn constraint_scale(&self) -> &[f64] {
        if self.held { &[1.0; 3] } else { &[] }
    }
    fn is_flat(&self) -> bool {
        false
    }
    fn has_damping(&self) -> bool {
        true
    }
    fn retract(&self, q: &[f64], increment: &[f64], out: &mut [f64]) {
        for i in 0..3 {
            out[i] = q[i] + increment[i];
        }
        let d = three(&increment[3..]);
        let angle = d.iter().map(|x| x * x).sum::<f64>().sqrt();
        let half = 0.5 * angle;
        let s = if angle < 1e-4 { 0.5 - angle * angle / 48.0 } else { half.sin() / angle };
        let p = product(&q[3..7], [half.cos(), s * d[0], s * d[1], s * d[2]]);
        let norm = p.iter().map(|x| x * x).sum::<f64>().sqrt();
        for i in 0..4 {
            out[3 + i] = p[i] / norm;
        }
    }
    fn commutator(&self, v: &[f64], w: &[f64], out: &mut [f64]) {
        out[..3].fill(0.0);
        out[3..].copy_from_slice(&cross(three(&v[3..]), three(&w[3..])));
    }
    fn residual(
        &mut self,
        at: Point<'_>,
        force: &mut [f64],
        phi: &mut [f64],
    ) -> Result<(), EvaluationError> {
        let (p, w) = (&at.q[3..7], three(&at.v[3..]));
        let gyroscopic = self.gyroscopic(w);
        for i in 0..3 {
            force[i] = self.mass * at.a[i];
            force[3 + i] = self.inertia[i] * at.a[3 + i] + gyroscopic[i];
        }
        force[2] += self.mass * self.gravity;
        if self.held {
            // phi = x - R arm, phi_dot = x_dot - R (w x arm): the row of w is R arm^, transposed -arm x R^T.
            let lever = rotate(p, self.arm);
            let l = three(at.lambda_);
            let moment = cross(self.arm, back(p, l));
            for i in 0..3 {
                phi[i] = at.q[i] - lever[i];
                force[i] += l[i];
                force[3 + i] -= moment[i];
            }
        }
        Ok(())
    }
    fn tangent(&mut self, at: Point<'_>, k: Weights, values: &mut Vec<f64>) {
        let n = 6 + self.multipliers();
        values.fill(0.0);
        let (p, w) = (&at.q[3..7], three(&at.v[3..]));
        for j in 0..3 {
            let e: V3 = std::array::from_fn(|i| if i == j { 1.0 } else { 0.0 });
            values[n * j + j] = k.mass * self.mass;
            values[n * (3 + j) + 3 + j] = k.mass * self.inertia[j];
            let jw: V3 = std::array::from_fn(|i| self.inertia[i] * w[i]);
            let je: V3 = std::array::from_fn(|i| self.inertia[i] * e[i]);
            let (c1, c2) = (cross(e, jw), cross(w, je));
            for i in 0..3 {
                values[n * (3 + i) + 3 + j] += k.damping * (c1[i] + c2[i]);
            }
            if self.held {
                // d(R^T l) = (R^T l) x d.
                let s = cross(self.arm, cross(back(p, three(at.lambda_)), e));
                let row = rotate(p, cross(e, self.arm));
                values[n * (6 + j) + j] = k.jacobian;
                values[n * j + 6 + j] = k.jacobian;
                for i in 0..3 {
                    values[n * (3 + i) + 3 + j] -= k.stiffness * s[i];
                    values[n * (6 + i) + 3 + j] = -k.jacobian * row[i];
                    values[n * (3 + j) + 6 + i] = -k.jacobian * row[i];
                }
            }
        }
    }
    fn constraint_acceleration(&mut self, at: Point<'_>, out: &mut [f64]) {
        if self.held {
            let w = three(&at.v[3..]);
            let x = rotate(&at.q[3..7], cross(w, cross(w, self.arm)));
            (0..3).for_each(|i| out[i] = -x[i]);
        }
    }
    fn constraint_jerk(&mut self, at: Point<'_>, out: &mut [f64]) {
        if self.held {
            // Third derivative of R c without R (w'' x c): R (w x (w' x c) + ...), all in the body.
            let (w, a, c) = (three(&at.v[3..]), three(&at.a[3..]), self.arm);
            let (wc, ac) = (cross(w, c), cross(a, c));
            let x = rotate(
                &at.q[3..7],
                std::array::from_fn(|i| {
                    cross(w, cross(w, wc))[i] + 2.0 * cross(w, ac)[i] + cross(a, wc)[i]
                }),
            );
            (0..3).for_each(|i| out[i] = -x[i]);
        }
    }
}

fn run(body: Body, q: &[f64], v: &[f64], h: f64, end: f64, rho: f64) -> Vec<State> {
    let linear = solver(&body);
    let options = Options { spectral_radius: rho, ..Options::default() };
    let mut integrator = Integrator::new(body, linear, options, 0.0, q, v).unwrap().0;
    (0..(end / h).round() as usize)
        .map(|_| {
            integrator.advance(h).unwrap();
            integrator.state().clone()
        })
        .collect()
}

/// Quaternion and angular velocity by the classical Runge-Kutta scheme, under a moment about the origin.
fn reference(inertia: V3, w: V3, end: f64, moment: impl Fn(&[f64]) -> V3) -> [f64; 7] {
    let n = (end / 2e-5).round() as usize;
    let h = end / n as f64;
    let mut y = [1.0, 0.0, 0.0, 0.0, w[0], w[1], w[2]];
    let f = |y: &[f64; 7]| -> [f64; 7] {
        let w = three(&y[4..]);
        let p = product(&y[..4], [0.0, 0.5 * w[0], 0.5 * w[1], 0.5 * w[2]]);
        let g = cross(w, std::array::from_fn(|i| inertia[i] * w[i]));
        let m = moment(&y[..4]);
        let a: V3 = std::array::from_fn(|i| (m[i] - g[i]) / inertia[i]);
        [p[0], p[1], p[2], p[3], a[0], a[1], a[2]]
    };
    let plus = |y: &[f64; 7], k: &[f64; 7], h: f64| -> [f64; 7] {
        std::array::from_fn(|i| y[i] + h * k[i])
    };
    for _ in 0..n {
        let k1 = f(&y);
        let k2 = f(&plus(&y, &k1, 0.5 * h));
        let k3 = f(&plus(&y, &k2, 0.5 * h));
        let k4 = f(&plus(&y, &k3, h));
        y = std::array::from_fn(|i| y[i] + h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]));
    }
    y
}

const START: [f64; 7] = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0];

#[test]
fn a_free_body_tumbles_to_second_order() {
    let inertia = [1.0, 2.0, 3.0];
    let w = [0.3, 5.0, -0.2];
    let exact = reference(inertia, w, 1.0, |_| [0.0; 3]);
    let h = [0.01, 0.005, 0.0025];
    let (mut angle, mut momentum) = (Vec::new(), Vec::new());
    for h in h {
        let v = [0.4, -0.1, 0.2, w[0], w[1], w[2]];
        let body = Body::new(2.0, inertia, 0.0, [0.0; 3], false);
        let states = run(body, &START, &v, h, 1.0, 0.9);
        let s = states.last().unwrap();
        let l = |s: &State| rotate(&s.q[3..7], std::array::from_fn(|i| inertia[i] * s.v[3 + i]));
        let l0: V3 = std::array::from_fn(|i| inertia[i] * w[i]);
        angle.push((0..4).map(|i| (s.q[3 + i] - exact[i]).powi(2)).sum::<f64>().sqrt());
        let drift = |s: &State| (0..3).map(|i| (l(s)[i] - l0[i]).abs()).fold(0.0, f64::max);
        momentum.push(states.iter().map(drift).fold(0.0, f64::max));
        for s in &states {
            // A retraction keeps unit length; rounding.
            let norm: f64 = s.q[3..7].iter().map(|x| x * x).sum();
            assert!((norm - 1.0).abs() < 1e-12);
        }
        // Uniform motion of the centre; rounding of a thousand steps.
        assert!((s.q[0] - 0.4).abs() < 1e-12 && (s.q[2] - 0.2).abs() < 1e-12);
    }
    for (what, e) in [("orientation", angle), ("angular momentum", momentum)] {
        // The next term of the expansion adds to the order at these steps.
        CHAPTER.record(&format!("free body, order of the {what}"), order(&h, &e), 2.0, 0.2, "");
    }
}

#[test]
fn a_heavy_top_converges_to_second_order_in_the_multipliers_too() {
    // Mass 15, centre at (0, 1, 0), inertia about it diag(.234375, .46875, .234375), spin 150 rad/s.
    let (mass, arm, inertia) = (15.0, [0.0, 1.0, 0.0], [0.234_375, 0.468_75, 0.234_375]);
    let w = [0.0, 150.0, -4.61538];
    let about_point = [inertia[0] + mass, inertia[1], inertia[2] + mass];
    let moment = |p: &[f64]| cross(arm, back(p, [0.0, 0.0, -mass * 9.81]));
    let exact = reference(about_point, w, 0.1, moment);
    let x = rotate(&exact[..4], arm);
    // Independent integration of rotation matrix and angular velocity by DOP853 at 1e-13, trusted to 1e-9.
    let published = [0.421_296_658_925_356_9, 0.894_571_974_345_623_7, -0.149_164_700_561_854_38];
    for ((own, other), axis) in x.iter().zip(published).zip(["x", "y", "z"]) {
        let name = format!("heavy top, the tests' own integration, {axis} at 0.1 s");
        CHAPTER.record(&name, *own, other, 2e-9, "m");
    }
    let start = [arm[0], arm[1], arm[2], 1.0, 0.0, 0.0, 0.0];
    let velocity = cross(w, arm);
    let v = [velocity[0], velocity[1], velocity[2], w[0], w[1], w[2]];
    let h = [5e-4, 2.5e-4, 1.25e-4];
    let (mut tip, mut reaction) = (Vec::new(), Vec::new());
    for h in h {
        let body = Body::new(mass, inertia, 9.81, arm, true);
        let states = run(body, &start, &v, h, 0.1, 0.9);
        let s = states.last().unwrap();
        tip.push((0..3).map(|i| (s.q[i] - x[i]).powi(2)).sum::<f64>().sqrt());
        // Exact reaction at 0.01 s: m (x'' + g), x'' from the rigid motion, early enough to see the start.
        let early = reference(about_point, w, 0.01, moment);
        let (p, w) = (&early[..4], three(&early[4..]));
        let g = cross(w, std::array::from_fn(|i| about_point[i] * w[i]));
        let m = moment(p);
        let a: V3 = std::array::from_fn(|i| (m[i] - g[i]) / about_point[i]);
        let local: V3 = std::array::from_fn(|i| cross(a, arm)[i] + cross(w, cross(w, arm))[i]);
        let mut force = rotate(p, local).map(|x| -mass * x);
        force[2] -= mass * 9.81;
        let s = &states[(0.01 / h).round() as usize - 1];
        reaction.push((0..3).map(|i| (s.lambda_[i] - force[i]).powi(2)).sum::<f64>().sqrt());
    }
    for (what, e) in [("position", tip), ("reaction", reaction)] {
        CHAPTER.record(&format!("heavy top, order of the {what}"), order(&h, &e), 2.0, 0.2, "");
    }
}
