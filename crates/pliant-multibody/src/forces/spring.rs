//! Spring and damper between two points: `F_a = -(k (l - l_0) + c l') d/l`, d = r_a - r_b, l = |d|; stored energy
//! `k (l - l_0)^2 / 2`.
//!
//! Where the points meet, d/l has no limit: l is `sqrt(d.d + epsilon^2)` with epsilon a billionth of l_0, smooth
//! everywhere and the same number elsewhere. A spring of stress-free length zero pulls by `k d`, whatever the direction,
//! and damps by `c d'`, in all directions: a bushing.

use super::{At, Context, ForceElement, Part, add_outer};
use crate::error::ModelError;
use crate::point::{Interpolation, Support};
use crate::spec::ForceSpec;
use crate::vector::vector;
use nalgebra::{Matrix3, Vector3};
use pliant_dae::structure::Storage;

/// Length below which the direction fades, in units of the stress-free length.
const FADE: f64 = 1e-9;

/// A spring and damper.
#[derive(Clone, Debug)]
pub struct Spring {
    /// `r_a - r_b`, local.
    d: Interpolation,
    stiffness: f64,
    damping: f64,
    length: f64,
    support: Support,
    parts: Vec<Part>,
}

/// Length, its rate, and the vectors they are made of.
struct Stretch {
    d: Vector3<f64>,
    rate: Vector3<f64>,
    l: f64,
    l_rate: f64,
}

impl Spring {
    /// A spring along `d`, which is local to the support.
    #[must_use]
    pub fn new(d: Interpolation, [stiffness, damping, length]: [f64; 3], support: Support) -> Self {
        let parts = [(stiffness, Part::Stored), (damping, Part::Dissipated)];
        let parts = parts.into_iter().filter(|(x, _)| *x != 0.0).map(|(_, part)| part).collect();
        Self { d, stiffness, damping, length, support, parts }
    }

    pub(super) fn of_spec(force: &ForceSpec, context: &Context<'_>) -> Result<Self, ModelError> {
        let ForceSpec::Spring { name, a, b, stiffness, damping, length } = force else {
            return Err(super::other_kind("spring"));
        };
        let place = format!("spring '{name}'");
        let numbers = [*stiffness, *damping, *length];
        if let Some(&value) = numbers.iter().find(|x| !(**x >= 0.0 && x.is_finite())) {
            let allowed = "stiffness, damping and length from zero on";
            return Err(ModelError::Value { place, value, allowed });
        }
        let (r_a, _) = context.map.point(a, &place)?;
        let (r_b, _) = context.map.point(b, &place)?;
        let d = r_a.minus(&r_b);
        if d.terms.is_empty() {
            let reason = "both its points are fixed in the world";
            return Err(ModelError::Unsupported { place, reason });
        }
        let support = (context.support)(&[&d]);
        Ok(Self::new(support.localize(&d), numbers, support))
    }

    fn stretch(&self, at: At<'_>) -> Stretch {
        let (d, rate) = (vector(self.d.at(at.x)), vector(self.d.rate(at.v)));
        let l = (d.norm_squared() + (FADE * self.length).powi(2)).sqrt();
        let l_rate = if l > 0.0 { d.dot(&rate) / l } else { rate.norm() };
        Stretch { d, rate, l, l_rate }
    }
}

impl ForceElement for Spring {
    fn support(&self) -> &Support {
        &self.support
    }

    fn parts(&self) -> &[Part] {
        &self.parts
    }

    fn add_force(&self, part: Part, at: At<'_>, factor: f64, out: &mut [f64]) {
        let s = self.stretch(at);
        let f = match part {
            _ if self.length == 0.0 && part == Part::Stored => s.d * -self.stiffness,
            _ if self.length == 0.0 && part == Part::Dissipated => s.rate * -self.damping,
            Part::Stored => s.d * (-self.stiffness * (1.0 - self.length / s.l)),
            Part::Dissipated => s.d * (-self.damping * s.l_rate / s.l),
            Part::Work => return,
        };
        self.d.add_force((f * factor).into(), out);
    }

    fn add_tangent(&self, at: At<'_>, stiffness: f64, damping: f64, out: &mut [f64]) {
        let (s, one) = (self.stretch(at), Matrix3::identity());
        let (k, c) = (self.stiffness, self.damping);
        let matrix: Matrix3<f64> = if self.length == 0.0 {
            one * (stiffness * k + damping * c)
        } else {
            // n = d/l, with l' = n.d': dn/dd = (1 - n n^T)/l, dl'/dd = d'^T (1 - n n^T)/l
            let n = s.d / s.l;
            let across = (one - n * n.transpose()) / s.l;
            let k_d = one * (k * (1.0 - self.length / s.l))
                + n * n.transpose() * (k * self.length / s.l)
                + (n * (across * s.rate).transpose() + across * s.l_rate) * c;
            k_d * stiffness + n * n.transpose() * (damping * c)
        };
        add_outer(&self.d, &self.d, &matrix, at.x.len(), out);
    }

    /// A damper that turns while it shortens is not symmetric.
    fn storage(&self) -> Storage {
        if self.damping == 0.0 || self.length == 0.0 { Storage::Symmetric } else { Storage::Full }
    }

    fn energy(&self, at: At<'_>) -> f64 {
        0.5 * self.stiffness * (self.stretch(at).l - self.length).powi(2)
    }

    fn output_count(&self) -> usize {
        3
    }

    /// Length [m], its rate [m/s], and the force by which it pulls [N].
    fn outputs(&self, at: At<'_>, out: &mut [f64]) {
        let s = self.stretch(at);
        let pull = self.stiffness * (s.l - self.length) + self.damping * s.l_rate;
        out.copy_from_slice(&[s.l, s.l_rate, pull]);
    }
}
