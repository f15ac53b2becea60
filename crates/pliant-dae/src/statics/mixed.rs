//! Newton's method with predicted forces.
//!
//! A step of Newton's method that turns a thin sheet stretches it in second order, and the forces of that false
//! stretch, far stiffer than bending, spoil the next tangent: damped, the method creeps, undamped it may diverge. The
//! cure is to build the tangent's geometric part with the forces which the linearisation at the last iterate predicts
//! here; residuals stay those of the model. That is Newton's method for the model with its stresses as unknowns of
//! their own, eliminated (Magisano, Leonetti & Garcea 2017, mixed integration points): a handful of iterations where the
//! other takes tens, at load increments many times as long.

use super::{Goal, NOISE, Outcome, Place, Search};
use crate::error::Error;
use crate::problem::Problem;
use crate::scaling::{weighted_max, worst};

/// Iterations after which the method has failed, and increments cut to the longest that is allowed.
const ITERATIONS: usize = 30;
const CUT: usize = 12;

impl<P: Problem + ?Sized> Search<'_, P> {
    /// Whichever of Newton's methods is meant for the problem.
    pub(super) fn search(
        &mut self,
        load: f64,
        step: f64,
        place: &mut Place,
        goal: Goal,
    ) -> Result<Outcome, Error> {
        if self.problem.predicts() {
            self.mixed(load, step, place, goal)
        } else {
            self.newton(load, step, place, goal)
        }
    }

    fn mixed(
        &mut self,
        load: f64,
        step: f64,
        place: &mut Place,
        goal: Goal,
    ) -> Result<Outcome, Error> {
        let n = self.zero.len();
        let mut increments: Vec<f64> = Vec::new();
        let (mut worst_unknown, mut cut) = (0, 0);
        let mut last: Option<Vec<f64>> = None;
        while increments.len() < goal.iterations.min(ITERATIONS) && cut < CUT {
            if (self.poll)() {
                return Err(Error::Interrupted { t: load });
            }
            let mut dx = match self.correction(load, place, goal.mu, last.as_deref()) {
                Ok(dx) => dx,
                Err(error) if error.is_recoverable() => return Ok(Outcome::Failed(error)),
                Err(error) => return Err(error),
            };
            let size = weighted_max(&dx[..n], &self.inverse_scale);
            worst_unknown = worst(&dx[..n], &self.inverse_scale);
            let previous = increments.last().copied().unwrap_or(f64::INFINITY);
            increments.push(size);
            let part = self.part(&place.q, &dx, (self.options.max_increment / size).min(1.0));
            self.add(place, &dx, part);
            let noise = size > 0.5 * previous && size <= NOISE * self.options.tolerance;
            if size <= goal.tolerance || noise {
                let iterations = increments.len();
                return Ok(Outcome::Equilibrium { last_increment: size, iterations });
            }
            cut += usize::from(part < 1.0);
            dx.truncate(n);
            dx.iter_mut().for_each(|d| *d *= part);
            last = Some(dx);
        }
        Ok(Outcome::Failed(self.failure(load, step, &increments, worst_unknown)))
    }
}
