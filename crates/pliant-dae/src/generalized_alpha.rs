//! Generalized-alpha for index-3 differential-algebraic equations, on vector spaces and on Lie groups.
//!
//! ```text
//! q1 = q (+) [h v + h^2 ((1/2 - beta) A + beta A1)]        v1 = v + h ((1 - gamma) A + gamma A1)
//! (1 - alpha_m) A1 + alpha_m A = (1 - alpha_f) a1 + alpha_f a
//! M a1 + f(t1, q1, v1) + phi_q^T lambda1 = 0               phi(t1, q1) = 0
//! ```
//! `a` is the true acceleration, `A` (here `a_alg`) the algorithmic one. Sources: Chung & Hulbert 1993;
//! Arnold & Bruls 2007; Bruls, Cardona & Arnold 2012; scaling by Bottasso, Bauchau & Cardona 2007.

use std::mem::swap;

use crate::error::{Error, Failure};
pub use crate::integrator::{Integrator, Options, StepReport};
use crate::newton::Verdict;
use crate::passes::vectorised;
use crate::problem::{Kinks, Point, Problem};
use crate::scaling::{first_not_finite, largest, magnitude, weighted_max, worst};
pub use crate::state::{FactorPoint, State};
use crate::statistics::Stopwatch;

/// Part of a slope that may be left over, with the other sign, before an increment is shortened.
const OVERSHOOT: f64 = 0.5;
/// Cost of a factorisation in iterations, where these search for what touches, over that where they do not.
const BESIDE_SEARCH: f64 = 0.4;
/// Evaluations of a line search at most.
const SEARCHES: usize = 8;

impl<P: Problem> Integrator<P> {
    /// One step to time `t`, `h` away; on failure the state is unchanged.
    pub(crate) fn step_to(&mut self, t: f64, h: f64) -> Result<StepReport, Error> {
        self.attempt(t, h, None)
    }

    /// The same; refused with [`Error::Accuracy`] where its local error is above `tolerance`.
    pub(crate) fn attempt(
        &mut self,
        t: f64,
        h: f64,
        tolerance: Option<f64>,
    ) -> Result<StepReport, Error> {
        let before = (self.statistics.newton_iterations, self.statistics.factorizations);
        let prepared_anew = self.state.h != h;
        if prepared_anew {
            self.prepare(h)?;
        }
        let mut watch = Stopwatch::start(self.options.timed);
        self.predict(t, h);
        let solved = self.iterate(h, &mut watch);
        let solved = match tolerance {
            Some(tolerance) => solved.and_then(|()| self.estimate(h, tolerance)),
            None => solved,
        };
        if let Err(error) = solved {
            if prepared_anew {
                self.undo_prepare();
            }
            return Err(error);
        }
        self.complete(h);
        let part = self.work.part;
        if let Err(source) = self.problem.judge(self.state.point(), self.work.next.point(), part) {
            if prepared_anew {
                self.undo_prepare();
            }
            return Err(Error::Evaluation { t, source });
        }
        self.accept();
        watch.lap(&mut self.statistics.seconds.other);
        Ok(StepReport {
            iterations: self.statistics.newton_iterations - before.0,
            factorizations: self.statistics.factorizations - before.1,
            steps: 1,
        })
    }

    /// Predicts `a1 = a`, `lambda1 = lambda`; positions and velocities follow.
    fn predict(&mut self, t: f64, h: f64) {
        let c = self.coefficients;
        let (old, next) = (&self.state, &mut self.work.next);
        let n = old.v.len();
        let (ca, cm) = (1.0 / (1.0 - c.alpha_m), c.alpha_m / (1.0 - c.alpha_m));
        let (q_old, q_new) = (h * h * (0.5 - c.beta), h * h * c.beta);
        let (v_old, v_new) = (h * (1.0 - c.gamma), h * c.gamma);
        let flat = self.problem.is_flat();
        let moved = if flat { &mut next.q } else { &mut self.work.delta };
        vectorised(|| {
            // Lengths known inside the pass let the compiler drop all checks of indices.
            let (v, a, a_alg) = (&old.v[..n], &old.a[..n], &old.a_alg[..n]);
            let (v1, a1) = (&mut next.v[..n], &mut next.a[..n]);
            let moved = &mut moved[..n];
            let q = if flat { &old.q[..n] } else { &self.work.zero[..n] };
            for i in 0..n {
                let guess = ca * a[i] - cm * a_alg[i];
                moved[i] = q[i] + (h * v[i] + (q_old * a_alg[i] + q_new * guess));
                v1[i] = v[i] + (v_old * a_alg[i] + v_new * guess);
                a1[i] = a[i];
            }
        });
        if !flat {
            self.problem.retract(&old.q, &self.work.delta, &mut next.q);
        }
        next.lambda_.copy_from_slice(&old.lambda_);
        next.t = t;
    }

    /// Newton's iteration for `(dq, beta h^2 dlambda)`.
    fn iterate(&mut self, h: f64, watch: &mut Stopwatch) -> Result<(), Error> {
        self.work.monitor.reset();
        let kinks = self.problem.kinks();
        let mut cost = self.solver.factor_cost();
        if kinks != Kinks::None {
            cost *= BESIDE_SEARCH;
        }
        if self.state.factor.h != h || self.state.factor.age.is_worn(cost) {
            watch.lap(&mut self.statistics.seconds.other);
            self.factor(h, watch)?;
        }
        let mut newton = self.options.newton;
        if kinks == Kinks::Many {
            // Shortened increments are many, and none is in vain.
            newton.max_iterations *= 3;
        }
        // Norm of the constraints where a search has left the residual.
        let mut known = None;
        loop {
            let floor = self.state.factor.floor;
            watch.lap(&mut self.statistics.seconds.other);
            let phi = match known.take() {
                Some(phi) => phi,
                None => self.residual(h, watch)?,
            };
            if kinks != Kinks::None {
                self.work.direction.clone_from(&self.work.x);
            }
            self.solver.correct(&mut self.work.x);
            watch.lap(&mut self.statistics.seconds.solve);
            let size = self.update(h);
            self.statistics.newton_iterations += 1;
            self.state.factor.age.iterations += 1;
            let mut verdict = self.work.monitor.judge(size, phi, (floor, cost), &newton);
            // What is rounding goes to and fro, however short; among many kinks the last increment may cross one, too.
            let searched = match kinks {
                Kinks::None => false,
                Kinks::Few => verdict != Verdict::Converged,
                Kinks::Many => true,
            };
            if searched && size > floor {
                let (part, phi) = self.shorten(h, watch)?;
                known = Some(phi);
                if part < 1.0 {
                    verdict = self.work.monitor.after_shortening(part, &newton);
                }
            }
            if verdict == Verdict::Stalled {
                known = None;
                verdict = if self.is_rounding_noise(size)? {
                    Verdict::Converged
                } else {
                    self.work.monitor.after_stall(floor, &newton)
                };
            }
            match verdict {
                Verdict::Converged => return Ok(()),
                Verdict::Refactor => {
                    watch.lap(&mut self.statistics.seconds.other);
                    self.factor(h, watch)?;
                }
                Verdict::Failed => {
                    if known.is_some() {
                        // Failures are told by increments.
                        swap(&mut self.work.direction, &mut self.work.x);
                    }
                    return Err(self.failure(h));
                }
                Verdict::Continue | Verdict::Stalled => {}
            }
        }
    }

    /// Line search along the increment `d` that was just made, `direction` holding the right-hand side r that it
    /// answers; returns the part of it that is kept, and leaves the right-hand side there with the constraints' norm.
    /// Where forces have a potential, `d.r` is minus its slope: it changes its sign where the increment goes too far.
    fn shorten(&mut self, h: f64, watch: &mut Stopwatch) -> Result<(f64, f64), Error> {
        swap(&mut self.work.direction, &mut self.work.x);
        let n = self.work.next.v.len();
        let dot =
            |a: &[f64], b: &[f64]| -> f64 { a[..n].iter().zip(&b[..n]).map(|(a, b)| a * b).sum() };
        let start = dot(&self.work.direction, &self.work.x);
        let mut slope = |this: &mut Self| -> Result<(f64, f64), Error> {
            let phi = this.residual(h, watch)?;
            Ok((dot(&this.work.direction, &this.work.x), phi))
        };
        let (full, mut phi) = slope(self)?;
        if start <= 0.0 || full >= -OVERSHOOT * start {
            return Ok((1.0, phi));
        }
        // Illinois' rule between the ends (0, start) and (1, full).
        let (mut low, mut high) = ((0.0, start), (1.0, full));
        let mut part = 1.0;
        for _ in 0..SEARCHES {
            let next = (low.0 * high.1 - high.0 * low.1) / (high.1 - low.1);
            for (x, d) in self.work.x.iter_mut().zip(&self.work.direction) {
                *x = (next - part) * d;
            }
            self.update(h);
            part = next;
            let here;
            (here, phi) = slope(self)?;
            if here.abs() <= OVERSHOOT * start {
                break;
            }
            if here > 0.0 {
                low = (next, here);
                high.1 *= 0.5;
            } else {
                high = (next, here);
                low.1 *= 0.5;
            }
        }
        Ok((part, phi))
    }

    /// Right-hand side `-(beta h^2 force, phi)`; returns the constraints' norm.
    fn residual(&mut self, h: f64, watch: &mut Stopwatch) -> Result<f64, Error> {
        let next = &self.work.next;
        let (force, phi) = self.work.x.split_at_mut(next.v.len());
        self.statistics.residuals += 1;
        self.problem
            .residual(next.point(), force, phi)
            .map_err(|source| Error::Evaluation { t: next.t, source })?;
        let norm = weighted_max(phi, &self.work.inverse_constraint_scale);
        let scale = -self.coefficients.beta * h * h;
        let size = vectorised(|| {
            force.iter_mut().fold(0, |size, f| {
                let here = magnitude(*f);
                *f *= scale;
                here.max(size)
            })
        });
        for p in phi {
            *p = -*p;
        }
        watch.lap(&mut self.statistics.seconds.residual);
        if f64::from_bits(size).is_finite() && norm.is_finite() {
            Ok(norm)
        } else {
            Err(self.not_finite(h))
        }
    }

    /// Adds the increments to the state aimed at; returns `max |dq_i| / scale_i`.
    fn update(&mut self, h: f64) -> f64 {
        let c = self.coefficients;
        let next = &mut self.work.next;
        let n = next.v.len();
        let (dq, dl) = self.work.x.split_at(n);
        let weight = &self.work.inverse_scale;
        let flat = self.problem.is_flat();
        let moved = if flat { &mut next.q } else { &mut self.work.delta };
        let a = &mut next.a;
        let rate = c.acceleration_rate(h);
        let size = vectorised(|| {
            let (dq, weight) = (&dq[..n], &weight[..n]);
            let (moved, a) = (&mut moved[..n], &mut a[..n]);
            let mut size = 0;
            for i in 0..n {
                moved[i] += dq[i];
                a[i] += rate * dq[i];
                size = magnitude(dq[i] * weight[i]).max(size);
            }
            size
        });
        if self.problem.has_damping() {
            let rate = c.velocity_rate(h);
            for (v, d) in next.v.iter_mut().zip(dq) {
                *v += rate * d;
            }
        }
        let unscale = 1.0 / (c.beta * h * h);
        for (lambda_, d) in next.lambda_.iter_mut().zip(dl) {
            *lambda_ += unscale * d;
        }
        if !flat {
            self.problem.retract(&self.state.q, &self.work.delta, &mut next.q);
        }
        f64::from_bits(size)
    }

    /// Computes what follows from the accelerations.
    fn complete(&mut self, h: f64) {
        let c = self.coefficients;
        let (old, next) = (&self.state, &mut self.work.next);
        let n = old.v.len();
        let inverse = 1.0 / (1.0 - c.alpha_m);
        let (c1, c0, cm) = ((1.0 - c.alpha_f) * inverse, c.alpha_f * inverse, c.alpha_m * inverse);
        let (v_old, v_new) = (h * (1.0 - c.gamma), h * c.gamma);
        vectorised(|| {
            let (v, a, a_alg) = (&old.v[..n], &old.a[..n], &old.a_alg[..n]);
            let (v1, a1, a1_alg) = (&mut next.v[..n], &next.a[..n], &mut next.a_alg[..n]);
            for i in 0..n {
                let new = c1 * a1[i] + (c0 * a[i] - cm * a_alg[i]);
                v1[i] = v[i] + (v_old * a_alg[i] + v_new * new);
                a1_alg[i] = new;
            }
        });
    }

    /// Hands over to the problem, and turns the buffers round.
    fn accept(&mut self) {
        let (old, next) = (&mut self.state, &mut self.work.next);
        self.problem.accept(old.point(), next.point());
        swap(&mut old.a_previous, &mut old.a);
        swap(&mut old.a, &mut next.a);
        swap(&mut old.q, &mut next.q);
        swap(&mut old.v, &mut next.v);
        swap(&mut old.a_alg, &mut next.a_alg);
        swap(&mut old.lambda_, &mut next.lambda_);
        old.t = next.t;
        old.factor.age.steps += 1;
        old.factor.age.last = self.work.monitor.increments.len();
        self.statistics.steps += 1;
    }

    /// Factorises the iteration matrix at the state aimed at, and remembers where.
    fn factor(&mut self, h: f64, watch: &mut Stopwatch) -> Result<(), Error> {
        let (kept, next) = (&mut self.state.factor, &self.work.next);
        kept.t = next.t;
        kept.q.clone_from(&next.q);
        kept.v.clone_from(&next.v);
        kept.a.clone_from(&next.a);
        kept.lambda_.clone_from(&next.lambda_);
        kept.age = kept.age.renewed(!self.work.monitor.increments.is_empty());
        kept.h = h;
        let weight = &self.work.inverse_scale;
        let coordinates = if self.problem.is_flat() {
            weighted_max(&next.q, weight)
        } else {
            largest(&next.q) * largest(weight)
        };
        kept.floor = 8.0 * f64::EPSILON * coordinates.max(1.0);
        let outcome = self.rebuild_factor();
        if outcome.is_err() {
            self.state.factor.h = 0.0;
        }
        *watch = Stopwatch::start(self.options.timed);
        outcome
    }

    /// Factorises the iteration matrix where the state says that it was made, if anywhere.
    pub(crate) fn rebuild_factor(&mut self) -> Result<(), Error> {
        let kept = &self.state.factor;
        if kept.h == 0.0 {
            return Ok(());
        }
        let mut watch = Stopwatch::start(self.options.timed);
        let at = Point { t: kept.t, q: &kept.q, v: &kept.v, a: &kept.a, lambda_: &kept.lambda_ };
        self.problem.tangent(at, self.coefficients.weights(kept.h), &mut self.work.values);
        watch.lap(&mut self.statistics.seconds.tangent);
        self.statistics.factorizations += 1;
        let outcome = self.solver.factor(self.problem.structure(), &self.work.values);
        watch.lap(&mut self.statistics.seconds.factor);
        outcome.map_err(|e| Error::from_factor(&self.problem, kept.t, &e))
    }

    /// Whether the last increment is rounding noise: 1e-14 of the coordinates, or the answer to a residual of
    /// 1e-12 of the forces that cancel in it (stiff problems cannot do better).
    fn is_rounding_noise(&mut self, size: f64) -> Result<bool, Error> {
        let next = &self.work.next;
        let (force, phi) = self.work.x.split_at_mut(next.v.len());
        self.statistics.residuals += 2;
        let t = next.t;
        let mut evaluate = |at: Point<'_>, phi: &mut [f64]| {
            let outcome = self.problem.residual(at, force, phi);
            outcome.map(|()| largest(force)).map_err(|source| Error::Evaluation { t, source })
        };
        let rest = evaluate(next.point(), phi)?;
        let gap = weighted_max(phi, &self.work.inverse_constraint_scale);
        let zero = &self.work.zero;
        let (a, lambda_) = (&zero[..next.v.len()], &zero[..next.lambda_.len()]);
        let forces = evaluate(Point { a, lambda_, ..next.point() }, phi)?;
        Ok(gap <= self.options.newton.constraint_tolerance
            && (size <= 8.0 * self.state.factor.floor || rest <= 1e-12 * forces))
    }

    /// The error of an iteration that was given up.
    fn failure(&self, h: f64) -> Error {
        let n = self.state.v.len();
        let unknown = worst(&self.work.x[..n], &self.work.inverse_scale);
        let finite = self.work.monitor.increments.last().is_none_or(|size| size.is_finite());
        let failure = Box::new(self.describe_failure(h, unknown));
        if finite { Error::NotConverged(failure) } else { Error::NotFinite(failure) }
    }

    /// The error of a residual with an entry that is not finite.
    fn not_finite(&self, h: f64) -> Error {
        let unknown = first_not_finite(&self.work.x).unwrap_or_default();
        Error::NotFinite(Box::new(self.describe_failure(h, unknown)))
    }

    fn describe_failure(&self, h: f64, unknown: usize) -> Failure {
        let increments = self.work.monitor.increments.clone();
        Failure {
            t: self.work.next.t,
            h,
            iterations: increments.len(),
            increments,
            unknown,
            name: self.problem.describe(unknown),
        }
    }
}
