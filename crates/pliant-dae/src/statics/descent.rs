//! The way down from where Newton's method fails or finds an unstable equilibrium.
//!
//! The flow of steepest descent in the mass, `M dq/dtau = -f` on the constraints, by implicit Euler steps: each is the
//! minimum of the energy plus `mu/2 |q - q_n|_M^2`, found by the damped Newton method that finds equilibria. They cannot
//! gain energy, however stiff the model is, and they grow as the flow settles. (Kelley & Keyes 1998; Rockafellar 1976
//! for the point of view of minimisation.)

use super::stability::{self, Stability, dot};
use super::{Goal, Outcome, Place, Search, WEIGHTS_MASS};
use crate::error::Error;
use crate::problem::{Point, Problem};
use crate::scaling::{largest, weighted_max};

/// Most steps of the flow, for each iteration allowed to Newton's method.
const STEPS: usize = 5;
/// Iterations for each step, and their tolerance in units of the scale.
const ITERATIONS: usize = 20;
const TOLERANCE: f64 = 1e-5;
/// Changes of `mu` after a quick step, a slow one, and one that failed.
const QUICK: f64 = 0.15;
const SLOW: f64 = 0.6;
const FAILED: f64 = 8.0;
/// Range of `mu`, relative to the stiffest motion.
const SMALLEST: f64 = 1e-14;
const LARGEST: f64 = 1e4;
/// First displacement along an unstable direction, and how often it is halved.
const PUSH: f64 = 1e-2;
const HALVINGS: usize = 20;

impl<P: Problem + ?Sized> Search<'_, P> {
    /// Whether the equilibrium at `place` is stable.
    pub(super) fn stability(&mut self, load: f64, place: &Place) -> Result<Stability, Error> {
        let favoured = self.growing_load(load, place)?;
        let at =
            Point { t: load, q: &place.q, v: &self.zero, a: &self.zero, lambda_: &place.lambda_ };
        stability::test(self.problem, self.solver, at, &favoured)
    }

    /// The load that came since the start of the increments.
    fn growing_load(&mut self, load: f64, place: &Place) -> Result<Vec<f64>, Error> {
        let n = self.zero.len();
        let mut now = self.right_hand_side(load, place, 0.0)?;
        let before = self.right_hand_side(self.options.from, place, 0.0)?;
        now.iter_mut().zip(&before).for_each(|(now, before)| *now -= before);
        now.truncate(n);
        Ok(now)
    }

    /// Moves along `x`, to the side that the load favours, so far that the energy falls.
    pub(super) fn leave(&mut self, load: f64, place: &mut Place, x: &[f64]) -> Result<(), Error> {
        let n = self.zero.len();
        let favoured = self.growing_load(load, place)?;
        let mut dx = vec![0.0; n + place.lambda_.len()];
        dx[..n].copy_from_slice(x);
        let side = if dot(&favoured, x) < 0.0 { -1.0 } else { 1.0 };
        let size = side * PUSH / weighted_max(x, &self.inverse_scale);
        let mut size = self.part(&place.q, x, size);
        for _ in 0..HALVINGS {
            let mut trial = place.clone();
            self.add(&mut trial, &dx, size);
            match self.right_hand_side(load, &trial, 0.0) {
                Ok(r) if size * dot(&r[..n], x) > 0.0 => {
                    *place = trial;
                    return Ok(());
                }
                Err(error) if !error.is_recoverable() => return Err(error),
                _ => size *= 0.5,
            }
        }
        self.add(place, &dx, size);
        Ok(())
    }

    /// Follows the flow until it settles; `growth` is the rate at which an unstable motion grows.
    pub(super) fn descend(
        &mut self,
        load: f64,
        step: f64,
        place: &mut Place,
        growth: Option<f64>,
    ) -> Result<(), Error> {
        let mass = self.largest_value(load, &place.q, &place.lambda_, WEIGHTS_MASS);
        let stiffest = if mass > 0.0 { 1.0 / (self.force_scale * mass) } else { 0.0 };
        // Above the rate of growth the first step has one minimum.
        let mut mu = growth.map_or(stiffest, |growth| 4.0 * growth);
        for _ in 0..STEPS * self.options.max_iterations {
            let before = self.right_hand_side(load, place, 0.0)?;
            let mut trial = place.clone();
            trial.moved.fill(0.0);
            let goal = Goal { mu, tolerance: TOLERANCE, iterations: ITERATIONS };
            let iterations = match self.search(load, step, &mut trial, goal)? {
                // Downhill on average, or up onto the constraints.
                Outcome::Equilibrium { iterations, .. } if self.falls(load, &before, &trial)? => {
                    iterations
                }
                _ => {
                    mu *= FAILED;
                    if mu > LARGEST * stiffest {
                        return Ok(());
                    }
                    continue;
                }
            };
            *place = trial;
            if mu < SMALLEST * stiffest {
                return Ok(());
            }
            mu *= if 2 * iterations <= ITERATIONS { QUICK } else { SLOW };
        }
        Ok(())
    }

    /// Whether forces did work on the way.
    fn falls(&mut self, load: f64, before: &[f64], trial: &Place) -> Result<bool, Error> {
        let n = self.zero.len();
        let after = self.right_hand_side(load, trial, 0.0)?;
        let violated = largest(&before[n..]) > largest(&after[n..]);
        Ok(violated || dot(&before[..n], &trial.moved) + dot(&after[..n], &trial.moved) >= 0.0)
    }
}
