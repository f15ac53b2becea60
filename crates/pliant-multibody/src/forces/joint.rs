//! What acts along the freedom y of a joint: spring, damper, stops and a drive,
//! `F = -k (y - y_0) - c y' - S + u(t)`.
//!
//! A stop that is passed by p pushes back with `S = K p max(0, 1 + chi p')` (Hunt & Crossley 1975, linear in p): it
//! takes energy as it is pressed and as it is left, and never pulls. Angles count whole turns.

use super::{At, Context, ForceElement, Part};
use crate::error::ModelError;
use crate::freedom::Freedom;
use crate::point::Support;
use crate::signal::{Moment, Value, first_break};
use crate::spec::{ForceSpec, StopSpec};

/// Spring, damper, stops and drive along a freedom.
#[derive(Clone, Debug)]
pub struct JointForce {
    y: Freedom,
    number: usize,
    stiffness: f64,
    damping: f64,
    rest: f64,
    stops: Option<StopSpec>,
    drive: Option<Value>,
    support: Support,
    parts: Vec<Part>,
}

/// Forces along y of one kind, and their derivatives by y and y'.
#[derive(Clone, Copy, Default)]
struct Force {
    stored: f64,
    lost: f64,
    by_y: f64,
    by_rate: f64,
}

impl JointForce {
    pub(super) fn of_spec(force: &ForceSpec, context: &Context<'_>) -> Result<Self, ModelError> {
        let ForceSpec::Joint { name, joint, stiffness, damping, rest, stops, drive } = force else {
            let (place, reason) = ("force".to_owned(), "it does not act along a joint");
            return Err(ModelError::Unsupported { place, reason });
        };
        let place = format!("force '{name}'");
        let numbers = [*stiffness, *damping];
        let stop_numbers = stops.as_ref().map_or([0.0; 2], |s| [s.stiffness, s.damping]);
        let wrong = |x: &&f64| !(**x >= 0.0 && x.is_finite());
        if let Some(&value) = numbers.iter().chain(&stop_numbers).find(wrong) {
            let allowed = "stiffness and damping from zero on";
            return Err(ModelError::Value { place, value, allowed });
        }
        let found = context.freedoms.iter().position(|f| f.joint == Some(*joint));
        let Some(number) = found else {
            let reason = "its joint leaves no single freedom";
            return Err(ModelError::Unsupported { place, reason });
        };
        let y = &context.freedoms[number].y;
        let support = (context.support)(&y.interpolations());
        let drive = drive.as_ref().map(|signal| Value::new(signal, &place)).transpose()?;
        let has_stops = stops.is_some();
        let parts = [
            (*stiffness != 0.0 || has_stops, Part::Stored),
            (*damping != 0.0 || has_stops, Part::Dissipated),
            (drive.is_some(), Part::Work),
        ];
        Ok(Self {
            y: y.placed(&support),
            number,
            stiffness: *stiffness,
            damping: *damping,
            rest: *rest,
            stops: stops.clone(),
            drive,
            support,
            parts: parts.into_iter().filter(|(has, _)| *has).map(|(_, part)| part).collect(),
        })
    }

    /// y and y'.
    fn motion(&self, at: At<'_>) -> [f64; 2] {
        let reference = at.now.angles.get(self.number).copied().unwrap_or(0.0);
        let mut gradient = vec![0.0; at.x.len()];
        self.y.add_gradient(at.x, 1.0, &mut gradient);
        let rate = gradient.iter().zip(at.v).map(|(g, v)| g * v).sum();
        [self.y.near(at.x, reference), rate]
    }

    fn spring(&self, [y, rate]: [f64; 2]) -> Force {
        Force {
            stored: -self.stiffness * (y - self.rest),
            lost: -self.damping * rate,
            by_y: -self.stiffness,
            by_rate: -self.damping,
        }
    }

    /// How far a stop is passed, and the direction in which.
    fn passed(stops: &StopSpec, y: f64) -> Option<(f64, f64)> {
        let above = stops.upper.map_or(0.0, |upper| y - upper);
        let below = stops.lower.map_or(0.0, |lower| lower - y);
        if above > 0.0 { Some((above, 1.0)) } else { (below > 0.0).then_some((below, -1.0)) }
    }

    fn stop(&self, [y, rate]: [f64; 2]) -> Force {
        let Some(stops) = &self.stops else { return Force::default() };
        let Some((p, side)) = Self::passed(stops, y) else { return Force::default() };
        let (k, damping) = (stops.stiffness, stops.damping * side * rate);
        let stored = -side * k * p;
        if damping > -1.0 {
            Force {
                stored,
                lost: stored * damping,
                by_y: -k * (1.0 + damping),
                by_rate: -k * p * stops.damping,
            }
        } else {
            Force { stored, lost: -stored, ..Force::default() }
        }
    }

    fn drive(&self, now: Moment<'_>) -> f64 {
        self.drive.as_ref().map_or(0.0, |drive| drive.at(now)[0])
    }

    fn along(&self, part: Part, at: At<'_>) -> f64 {
        let (spring, stop) = (self.spring(self.motion(at)), self.stop(self.motion(at)));
        match part {
            Part::Stored => spring.stored + stop.stored,
            Part::Dissipated => spring.lost + stop.lost,
            Part::Work => self.drive(at.now),
        }
    }
}

impl ForceElement for JointForce {
    fn support(&self) -> &Support {
        &self.support
    }

    fn parts(&self) -> &[Part] {
        &self.parts
    }

    fn add_force(&self, part: Part, at: At<'_>, factor: f64, out: &mut [f64]) {
        self.y.add_gradient(at.x, factor * self.along(part, at), out);
    }

    fn add_tangent(&self, at: At<'_>, stiffness: f64, damping: f64, out: &mut [f64]) {
        // F = f(y, y') y_x with y' = y_x.v: dF/dx = y_x (f_y y_x + f_y' y_xx v)^T + f y_xx, dF/dv = f_y' y_x y_x^T
        let n = at.x.len();
        let (spring, stop) = (self.spring(self.motion(at)), self.stop(self.motion(at)));
        let f = spring.stored + spring.lost + stop.stored + stop.lost + self.drive(at.now);
        let (by_y, by_rate) = (spring.by_y + stop.by_y, spring.by_rate + stop.by_rate);
        let mut y_x = vec![0.0; n];
        self.y.add_gradient(at.x, 1.0, &mut y_x);
        self.y.add_hessian(at.x, -stiffness * f, out);
        let mut turned = vec![0.0; n];
        if by_rate != 0.0 && stiffness != 0.0 {
            let mut y_xx = vec![0.0; n * n];
            self.y.add_hessian(at.x, 1.0, &mut y_xx);
            for (turned, row) in turned.iter_mut().zip(y_xx.chunks_exact(n)) {
                *turned = row.iter().zip(at.v).map(|(h, v)| h * v).sum();
            }
        }
        for i in 0..n {
            for j in 0..n {
                let column =
                    stiffness * (by_y * y_x[j] + by_rate * turned[j]) + damping * by_rate * y_x[j];
                out[i * n + j] -= y_x[i] * column;
            }
        }
    }

    fn storage(&self) -> pliant_dae::structure::Storage {
        if self.has_damping() {
            pliant_dae::structure::Storage::Full
        } else {
            pliant_dae::structure::Storage::Symmetric
        }
    }

    fn energy(&self, at: At<'_>) -> f64 {
        let y = self.motion(at)[0];
        let mut energy = 0.5 * self.stiffness * (y - self.rest).powi(2);
        if let Some(stops) = &self.stops
            && let Some((p, _)) = Self::passed(stops, y)
        {
            energy += 0.5 * stops.stiffness * p * p;
        }
        energy
    }

    fn next_break(&self, t: f64) -> Option<f64> {
        first_break(&self.drive, t)
    }

    fn output_count(&self) -> usize {
        7
    }

    /// All that acts along the freedom [N] or [N m], then force and moment on the first body.
    fn outputs(&self, at: At<'_>, out: &mut [f64]) {
        let all = [Part::Stored, Part::Dissipated, Part::Work];
        let f: f64 = all.into_iter().map(|part| self.along(part, at)).sum();
        let (force, moment) = self.y.wrench(at.x);
        out[0] = f;
        out[1..4].copy_from_slice((force * f).as_slice());
        out[4..7].copy_from_slice((moment * f).as_slice());
    }
}
