//! Tendon: a line without mass through points P_0 ... P_n of any bodies, pulled at P_0 and fastened at P_n.
//!
//! Spans have lengths `l_k = |P_(k+1) - P_k|`, and tensions T_k that pull their ends together. The tension of the first
//! is a given force T >= 0, or that of a motor which has left the stress-free length L to the tendon,
//! `T_0 = max(0, EA (l - L)/L + c (l' - L'))`, l the sum of all l_k; the damper fades in over a thousandth of strain.
//! At each guide between the ends the tendon slides with the velocity `w_k = -d/dt (l_k + ... + l_(n-1))` towards P_0, a
//! stretch of the tendon itself neglected, and turns by the wrap angle theta_k: Euler's (capstan) formula
//! `T_k = T_(k-1) exp(-mu theta_k s(w_k))` with `s = tanh(w/w_s)` in place of the sign of w.
//!
//! The regularisation: above three slip velocities w_s friction is full to half a per cent; at stick the tendon creeps,
//! so that a difference of tensions fades with the way w_s t, and at rest (in statics, too) all tensions are equal.
//! Friction takes the power `sum (T_(k-1) - T_k) w_k >= 0`, never less: the sign of the difference is that of w_k.

use super::{At, Context, ForceElement, Part};
use crate::error::ModelError;
use crate::point::{Interpolation, Support};
use crate::signal::{Moment, Value};
use crate::spec::{ForceSpec, PullSpec};
use crate::vector::vector;
use nalgebra::{DVector, Vector3};

/// Strain over which the damper of a tendon fades in.
const FADE: f64 = 1e-3;

/// What pulls a tendon.
#[derive(Clone, Debug)]
enum Pull {
    /// A force [N].
    Force(Value),
    /// A motor: the stress-free length it leaves [m], stiffness EA [N] and damping [N s/m].
    Motor { length: Value, stiffness: f64, damping: f64 },
}

/// A tendon.
#[derive(Clone, Debug)]
pub struct Tendon {
    /// `P_(k+1) - P_k`, local.
    spans: Vec<Interpolation>,
    pull: Pull,
    friction: f64,
    slip_velocity: f64,
    support: Support,
    parts: Vec<Part>,
}

/// A span at a state.
struct Span {
    /// Direction.
    u: Vector3<f64>,
    l: f64,
    l_rate: f64,
    /// Rate of the vector along it.
    d_rate: Vector3<f64>,
}

/// Tension at the pulled end, and its derivatives by the length of the tendon and its rate.
struct Tension {
    elastic: f64,
    damping: f64,
    by_length: f64,
    by_rate: f64,
}

/// A guide at a state: `mu theta s(w)` and its derivatives by the directions on both sides and by w.
struct Guide {
    exponent: f64,
    by_before: Vector3<f64>,
    by_after: Vector3<f64>,
    by_slip: f64,
}

impl Tendon {
    pub(super) fn of_spec(force: &ForceSpec, context: &Context<'_>) -> Result<Self, ModelError> {
        let ForceSpec::Tendon { name, points, pull, friction, slip_velocity } = force else {
            return Err(super::other_kind("tendon"));
        };
        let place = format!("tendon '{name}'");
        let bad = |value, allowed| ModelError::Value { place: place.clone(), value, allowed };
        if !(*friction >= 0.0 && friction.is_finite()) {
            return Err(bad(*friction, "friction from zero on"));
        }
        if !(*slip_velocity > 0.0 && slip_velocity.is_finite()) {
            return Err(bad(*slip_velocity, "slip velocities above zero"));
        }
        let pull = match pull {
            PullSpec::Force { tension } => Pull::Force(Value::new(tension, &place)?),
            PullSpec::Motor { length, stiffness, damping } => {
                if !(*stiffness > 0.0 && stiffness.is_finite()) {
                    return Err(bad(*stiffness, "stiffness above zero"));
                }
                if !(*damping >= 0.0 && damping.is_finite()) {
                    return Err(bad(*damping, "damping from zero on"));
                }
                let length = Value::new(length, &place)?;
                Pull::Motor { length, stiffness: *stiffness, damping: *damping }
            }
        };
        let points: Vec<Interpolation> = points
            .iter()
            .map(|point| Ok(context.map.point(point, &place)?.0))
            .collect::<Result<_, ModelError>>()?;
        let spans: Vec<Interpolation> = points.windows(2).map(|p| p[1].minus(&p[0])).collect();
        if spans.iter().all(|d| d.terms.is_empty()) {
            let reason = "all its points are fixed in the world";
            return Err(ModelError::Unsupported { place, reason });
        }
        let support = (context.support)(&spans.iter().collect::<Vec<_>>());
        let mut parts = vec![match pull {
            Pull::Force(_) => Part::Work,
            Pull::Motor { .. } => Part::Stored,
        }];
        let damped = matches!(pull, Pull::Motor { damping, .. } if damping > 0.0);
        if damped || (*friction > 0.0 && spans.len() > 1) {
            parts.push(Part::Dissipated);
        }
        let spans = spans.iter().map(|d| support.localize(d)).collect();
        let (friction, slip_velocity) = (*friction, *slip_velocity);
        Ok(Self { spans, pull, friction, slip_velocity, support, parts })
    }

    fn at(&self, at: At<'_>) -> Vec<Span> {
        let span = |d: &Interpolation| {
            let (way, d_rate) = (vector(d.at(at.x)), vector(d.rate(at.v)));
            let l = way.norm().max(f64::MIN_POSITIVE);
            let u = way / l;
            Span { u, l, l_rate: u.dot(&d_rate), d_rate }
        };
        self.spans.iter().map(span).collect()
    }

    /// The motor's length is none of the loads that grow with the load factor of statics.
    fn motor_length(length: &Value, now: Moment<'_>) -> f64 {
        length.at(Moment { constants: 1.0, ..now })[0]
    }

    fn tension(&self, at: At<'_>, spans: &[Span]) -> Tension {
        let none = Tension { elastic: 0.0, damping: 0.0, by_length: 0.0, by_rate: 0.0 };
        match &self.pull {
            Pull::Force(tension) => Tension { elastic: tension.at(at.now)[0].max(0.0), ..none },
            Pull::Motor { length, stiffness, damping } => {
                let free = Self::motor_length(length, at.now);
                let excess = spans.iter().map(|s| s.l).sum::<f64>() - free;
                if excess <= 0.0 {
                    return none;
                }
                let rate = spans.iter().map(|s| s.l_rate).sum::<f64>() - at.now.rate(length);
                let k = stiffness / free;
                let strain = excess / (FADE * free);
                let (fade, slope) =
                    if strain < 1.0 { (strain, 1.0 / (FADE * free)) } else { (1.0, 0.0) };
                let (elastic, push) = (k * excess, damping * rate * fade);
                if elastic + push <= 0.0 {
                    return Tension { elastic, damping: -elastic, ..none };
                }
                let by_length = k + damping * rate * slope;
                Tension { elastic, damping: push, by_length, by_rate: damping * fade }
            }
        }
    }

    /// The guides between the spans.
    fn guides(&self, spans: &[Span]) -> Vec<Guide> {
        let mut slip = -spans.iter().map(|s| s.l_rate).sum::<f64>();
        spans
            .windows(2)
            .map(|pair| {
                let (a, b) = (pair[0].u, pair[1].u);
                slip += pair[0].l_rate;
                let (sine, cosine) = (a.cross(&b).norm(), a.dot(&b));
                let theta = sine.atan2(cosine);
                let s = (slip / self.slip_velocity).tanh();
                let factor = self.friction * s;
                // cos theta = a.b: theta falls with a by b's part normal to a, over its length. A straight passage
                // has no direction of wrap.
                let turn = if sine > 1e-12 { factor / sine } else { 0.0 };
                Guide {
                    exponent: factor * theta,
                    by_before: (a * cosine - b) * turn,
                    by_after: (b * cosine - a) * turn,
                    by_slip: self.friction * theta * (1.0 - s * s) / self.slip_velocity,
                }
            })
            .collect()
    }

    /// Factors of the tension in each span.
    fn shares(&self, guides: &[Guide]) -> Vec<f64> {
        let mut sum = 0.0;
        let after = guides.iter().map(|g| {
            sum += g.exponent;
            (-sum).exp()
        });
        std::iter::once(1.0).chain(after).collect()
    }
}

impl ForceElement for Tendon {
    fn support(&self) -> &Support {
        &self.support
    }

    fn parts(&self) -> &[Part] {
        &self.parts
    }

    fn add_force(&self, part: Part, at: At<'_>, factor: f64, out: &mut [f64]) {
        let spans = self.at(at);
        let tension = self.tension(at, &spans);
        let shares = match part {
            Part::Dissipated if self.friction > 0.0 => self.shares(&self.guides(&spans)),
            _ => vec![1.0; spans.len()],
        };
        let total = tension.elastic + tension.damping;
        for ((d, span), share) in self.spans.iter().zip(&spans).zip(shares) {
            let pull = match part {
                Part::Stored | Part::Work => tension.elastic,
                // Damping, and what friction leaves out of the tension at the pulled end.
                Part::Dissipated => total * share - tension.elastic,
            };
            d.add_force((span.u * (-factor * pull)).into(), out);
        }
    }

    fn add_tangent(&self, at: At<'_>, stiffness: f64, damping: f64, out: &mut [f64]) {
        let n = at.x.len();
        let spans = self.at(at);
        let tension = self.tension(at, &spans);
        let guides = self.guides(&spans);
        let shares = self.shares(&guides);
        let total = tension.elastic + tension.damping;
        let row = |d: &Interpolation, w: Vector3<f64>| {
            let mut row = DVector::zeros(n);
            d.add_force(w.into(), row.as_mut_slice());
            row
        };
        // Of each span: derivatives of its length and of its rate by coordinates; those of the rate by velocities are
        // those of the length.
        let by_x: Vec<_> = self.spans.iter().zip(&spans).map(|(d, s)| row(d, s.u)).collect();
        let across = |s: &Span, w: Vector3<f64>| (w - s.u * s.u.dot(&w)) / s.l;
        let rate_by_x: Vec<_> =
            self.spans.iter().zip(&spans).map(|(d, s)| row(d, across(s, s.d_rate))).collect();
        let sum = |rows: &[DVector<f64>]| rows.iter().fold(DVector::zeros(n), |sum, row| sum + row);
        let (length_by_x, all_rates_by_x) = (sum(&by_x), sum(&rate_by_x));
        // Of the tension at the pulled end, with the weights of the tangent.
        let change = &length_by_x * (stiffness * tension.by_length + damping * tension.by_rate)
            + &all_rates_by_x * (stiffness * tension.by_rate);
        // Of the sum of exponents up to a span, and of minus the slip at its guide.
        let mut exponent = DVector::zeros(n);
        let mut downstream = &length_by_x * damping + &all_rates_by_x * stiffness;
        for k in 0..spans.len() {
            if let Some(guide) = k.checked_sub(1).map(|g| &guides[g]) {
                downstream -= &by_x[k - 1] * damping + &rate_by_x[k - 1] * stiffness;
                exponent -= &downstream * guide.by_slip;
                let before = across(&spans[k - 1], guide.by_before) * stiffness;
                let after = across(&spans[k], guide.by_after) * stiffness;
                exponent += row(&self.spans[k - 1], before) + row(&self.spans[k], after);
            }
            let t_k = total * shares[k];
            let gradient = &change * shares[k] - &exponent * t_k;
            // F = -sum T_k dl_k/dx: minus its derivative is the geometric part and the outer product below.
            for i in (0..n).filter(|&i| by_x[k][i] != 0.0) {
                for j in 0..n {
                    out[i * n + j] += by_x[k][i] * gradient[j];
                }
            }
            let (u, l) = (spans[k].u, spans[k].l);
            let geometric = (nalgebra::Matrix3::identity() - u * u.transpose()) / l;
            let geometric = geometric * (t_k * stiffness);
            super::add_outer(&self.spans[k], &self.spans[k], &geometric, n, out);
        }
    }

    /// Friction at rest is none; tension by force depends on time alone.
    fn has_potential(&self) -> bool {
        true
    }

    fn energy(&self, at: At<'_>) -> f64 {
        let Pull::Motor { length, stiffness, .. } = &self.pull else { return 0.0 };
        let free = Self::motor_length(length, at.now);
        let excess = self.at(at).iter().map(|s| s.l).sum::<f64>() - free;
        0.5 * stiffness / free * excess.max(0.0).powi(2)
    }

    fn is_rheonomic(&self) -> bool {
        matches!(self.pull, Pull::Motor { .. })
    }

    /// What the motor gives to the damper.
    fn transit(&self, at: At<'_>) -> f64 {
        match &self.pull {
            Pull::Motor { length, damping, .. } if *damping > 0.0 => {
                -self.tension(at, &self.at(at)).damping * at.now.rate(length)
            }
            _ => 0.0,
        }
    }

    fn has_transit(&self) -> bool {
        matches!(self.pull, Pull::Motor { damping, .. } if damping > 0.0)
    }

    fn next_break(&self, t: f64) -> Option<f64> {
        match &self.pull {
            Pull::Force(value) | Pull::Motor { length: value, .. } => value.next_break(t),
        }
    }

    fn output_count(&self) -> usize {
        1 + self.spans.len()
    }

    /// Length [m], and the tension of each span from the pulled end on [N].
    fn outputs(&self, at: At<'_>, out: &mut [f64]) {
        let spans = self.at(at);
        let tension = self.tension(at, &spans);
        out[0] = spans.iter().map(|s| s.l).sum();
        for (out, share) in out[1..].iter_mut().zip(self.shares(&self.guides(&spans))) {
            *out = (tension.elastic + tension.damping) * share;
        }
    }
}
