//! The form that the joints share: every equation is `phi = factor u.w - constant`, u and w affine in the coordinates.
//!
//! A linear equation has a constant w. The Jacobian is `factor (w du/dq + u dw/dq)`; the Hessian
//! `factor (du/dq^T dw/dq + dw/dq^T du/dq)` is constant. With it `phi_qq(v, v) = 2 factor u'.w'`, and the third
//! derivative at zero jerk is `3 factor (u''.w' + u'.w'')`.

use super::{Draft, Joint};
use crate::freedom::{Freedom, add_product_hessian};
use crate::point::{Interpolation, Support};
use crate::signal::Moment;
use crate::vector::vector;
use nalgebra::Vector3;

/// How a vector of a joint moves with the joint's first body: what the reaction is read from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// From the second point to the first.
    Gap,
    /// Turns with the first body.
    OfFirst,
    /// Does neither.
    Other,
}

/// A vector of a joint.
#[derive(Clone, Debug, PartialEq)]
pub struct Arm {
    /// Its value.
    pub value: Interpolation,
    /// How it moves.
    pub role: Role,
}

impl Arm {
    /// A vector fixed in the world.
    #[must_use]
    pub fn fixed(value: [f64; 3]) -> Self {
        Self { value: Interpolation::fixed(value), role: Role::Other }
    }

    pub(crate) fn at(&self, x: &[f64]) -> Vector3<f64> {
        vector(self.value.at(x))
    }

    pub(crate) fn rate(&self, v: &[f64]) -> Vector3<f64> {
        vector(self.value.rate(v))
    }
}

/// One equation, `factor u.w - constant`.
#[derive(Clone, Debug, PartialEq)]
pub struct Product {
    /// First vector.
    pub u: Arm,
    /// Second vector.
    pub w: Arm,
    /// Factor of their product.
    pub factor: f64,
    /// What the product must be.
    pub constant: f64,
}

impl Product {
    /// `u.w = 0`.
    #[must_use]
    pub fn orthogonal(u: Arm, w: Arm) -> Self {
        Self { u, w, factor: 1.0, constant: 0.0 }
    }
}

/// A joint made of products.
#[derive(Clone, Debug, Default)]
pub struct Products {
    equations: Vec<Product>,
    freedom: Option<Freedom>,
    support: Support,
}

impl Products {
    /// A joint over all coordinates.
    #[must_use]
    pub fn new(equations: Vec<Product>, freedom: Option<Freedom>) -> Self {
        Self { equations, freedom, support: Support::default() }
    }
}

impl Products {
    /// The same joint over the coordinates of `support`.
    #[must_use]
    pub fn over(mut self, support: Support) -> Self {
        for p in &mut self.equations {
            p.u.value = support.localize(&p.u.value);
            p.w.value = support.localize(&p.w.value);
        }
        self.freedom = self.freedom.map(|y| y.placed(&support));
        self.support = support;
        self
    }
}

impl Draft for Products {
    fn count(&self) -> usize {
        self.equations.len()
    }

    fn interpolations(&self) -> Vec<&Interpolation> {
        self.equations.iter().flat_map(|p| [&p.u.value, &p.w.value]).collect()
    }

    fn freedom(&self) -> Option<&Freedom> {
        self.freedom.as_ref()
    }

    fn placed(self: Box<Self>, support: Support) -> Box<dyn Joint> {
        Box::new(self.over(support))
    }
}

impl Joint for Products {
    fn equations(&self) -> usize {
        self.equations.len()
    }

    fn support(&self) -> &Support {
        &self.support
    }

    fn scale(&self, length: f64, out: &mut [f64]) {
        for (out, p) in out.iter_mut().zip(&self.equations) {
            *out = if p.u.role == Role::Gap { length } else { 1.0 };
        }
    }

    fn residual(&self, _now: Moment<'_>, x: &[f64], phi: &mut [f64]) {
        for (phi, p) in phi.iter_mut().zip(&self.equations) {
            *phi = p.factor * p.u.at(x).dot(&p.w.at(x)) - p.constant;
        }
    }

    fn jacobian(&self, _now: Moment<'_>, x: &[f64], out: &mut [f64]) {
        out.fill(0.0);
        for (row, p) in out.chunks_exact_mut(x.len()).zip(&self.equations) {
            p.w.value.add_force((p.u.at(x) * p.factor).into(), row);
            p.u.value.add_force((p.w.at(x) * p.factor).into(), row);
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
        for (lambda_, p) in lambda_.iter().zip(&self.equations) {
            add_product_hessian(&p.u, &p.w, x.len(), stiffness * lambda_ * p.factor, out);
        }
    }

    fn acceleration(&self, _now: Moment<'_>, _x: &[f64], v: &[f64], out: &mut [f64]) {
        for (out, p) in out.iter_mut().zip(&self.equations) {
            *out = 2.0 * p.factor * p.u.rate(v).dot(&p.w.rate(v));
        }
    }

    fn jerk(&self, _now: Moment<'_>, _x: &[f64], v: &[f64], a: &[f64], out: &mut [f64]) {
        for (out, p) in out.iter_mut().zip(&self.equations) {
            let mixed = p.u.rate(a).dot(&p.w.rate(v)) + p.u.rate(v).dot(&p.w.rate(a));
            *out = 3.0 * p.factor * mixed;
        }
    }

    fn reaction(&self, _now: Moment<'_>, x: &[f64], lambda_: &[f64]) -> ([f64; 3], [f64; 3]) {
        // A vector u that turns with a body by d theta changes by d theta x u: a force f on it is the moment u x f.
        let (mut force, mut moment) = (Vector3::zeros(), Vector3::zeros());
        for (lambda_, p) in lambda_.iter().zip(&self.equations) {
            let (u, w) = (p.u.at(x), p.w.at(x));
            for (arm, on, by) in [(&p.u, u, w), (&p.w, w, u)] {
                let f = by * (-lambda_ * p.factor);
                match arm.role {
                    Role::Gap => force += f,
                    Role::OfFirst => moment += on.cross(&f),
                    Role::Other => {}
                }
            }
        }
        (force.into(), moment.into())
    }

    fn motion(&self, x: &[f64], v: &[f64]) -> Option<[f64; 2]> {
        let [y, rate, ..] = self.freedom.as_ref()?.motion(x, v, v);
        Some([y, rate])
    }
}
