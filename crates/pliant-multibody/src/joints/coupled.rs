//! Drives and gears along the freedoms y of joints: `phi = y - u(t)`, `phi = y_a - ratio y_b` (1 equation).
//!
//! Jacobian, Hessian and time derivatives are those of the freedoms ([`crate::freedom`]). Angles count whole turns; that
//! of a drive is the one nearest to u(t). The multiplier is minus the force along y, or y_a.

use super::{Draft, Joint};
use crate::freedom::Freedom;
use crate::point::{Interpolation, Support};
use crate::signal::{Moment, Value, first_break};
use nalgebra::Vector3;

/// One freedom of the equation.
#[derive(Clone, Debug)]
pub struct Term {
    /// The freedom.
    pub y: Freedom,
    /// Its factor.
    pub factor: f64,
    /// Its number, where whole turns are counted.
    pub number: Option<usize>,
}

/// A sum of freedoms that follows a course.
#[derive(Clone, Debug)]
pub struct Coupled {
    terms: Vec<Term>,
    course: Option<Value>,
    support: Support,
}

impl Coupled {
    /// `sum factor y = course`, 0 where there is none.
    #[must_use]
    pub fn new(terms: Vec<Term>, course: Option<Value>) -> Self {
        Self { terms, course, support: Support::default() }
    }

    fn course(&self, now: Moment<'_>) -> [f64; 4] {
        let now = Moment { constants: 1.0, ..now };
        self.course.as_ref().map_or([0.0; 4], |u| u.jet(now).map(|u| u[0]))
    }

    fn sum(&self, x: &[f64], v: &[f64], a: &[f64], order: usize) -> f64 {
        self.terms.iter().map(|term| term.factor * term.y.motion(x, v, a)[order]).sum()
    }
}

impl Draft for Coupled {
    fn count(&self) -> usize {
        1
    }

    fn interpolations(&self) -> Vec<&Interpolation> {
        self.terms.iter().flat_map(|term| term.y.interpolations()).collect()
    }

    fn placed(mut self: Box<Self>, support: Support) -> Box<dyn Joint> {
        for term in &mut self.terms {
            term.y = term.y.placed(&support);
        }
        self.support = support;
        self
    }
}

impl Joint for Coupled {
    fn equations(&self) -> usize {
        1
    }

    fn support(&self) -> &Support {
        &self.support
    }

    fn scale(&self, length: f64, out: &mut [f64]) {
        let angle = self.terms.first().is_none_or(|term| term.y.is_angle());
        out.fill(if angle { 1.0 } else { length });
    }

    fn residual(&self, now: Moment<'_>, x: &[f64], phi: &mut [f64]) {
        let u = self.course(now)[0];
        let value = |term: &Term| {
            let reference = term.number.and_then(|k| now.angles.get(k).copied()).unwrap_or(u);
            term.factor * term.y.near(x, reference)
        };
        phi[0] = self.terms.iter().map(value).sum::<f64>() - u;
    }

    fn jacobian(&self, _now: Moment<'_>, x: &[f64], out: &mut [f64]) {
        out.fill(0.0);
        for term in &self.terms {
            term.y.add_gradient(x, term.factor, out);
        }
    }

    fn add_hessian(
        &self,
        _now: Moment<'_>,
        x: &[f64],
        lambda_: &[f64],
        stiffness: f64,
        out: &mut [f64],
    ) {
        for term in &self.terms {
            term.y.add_hessian(x, stiffness * lambda_[0] * term.factor, out);
        }
    }

    fn rate(&self, now: Moment<'_>, _x: &[f64], out: &mut [f64]) {
        out[0] = -self.course(now)[1];
    }

    fn acceleration(&self, now: Moment<'_>, x: &[f64], v: &[f64], out: &mut [f64]) {
        out[0] = self.sum(x, v, &vec![0.0; x.len()], 2) - self.course(now)[2];
    }

    fn jerk(&self, now: Moment<'_>, x: &[f64], v: &[f64], a: &[f64], out: &mut [f64]) {
        out[0] = self.sum(x, v, a, 3) - self.course(now)[3];
    }

    /// On the first body of the first freedom's joint.
    fn reaction(&self, _now: Moment<'_>, x: &[f64], lambda_: &[f64]) -> ([f64; 3], [f64; 3]) {
        let wrench = self.terms.first().map(|term| (term.y.wrench(x), -lambda_[0] * term.factor));
        let zero = (Vector3::zeros(), Vector3::zeros());
        let ((force, moment), f) = wrench.unwrap_or((zero, 0.0));
        ((force * f).into(), (moment * f).into())
    }

    fn next_break(&self, t: f64) -> Option<f64> {
        first_break(&self.course, t)
    }

    fn is_driven(&self) -> bool {
        self.course.is_some()
    }
}
