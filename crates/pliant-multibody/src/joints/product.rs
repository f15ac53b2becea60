//! The form that the joints share: every equation is `phi = sum factor u.w - constant`, u and w vectors of
//! [`super::arm`], one product in the sum or two.
//!
//! A linear equation has a constant w. The Jacobian is `factor (w du/dq + u dw/dq)`; of affine vectors the Hessian
//! `factor (du/dq^T dw/dq + dw/dq^T du/dq)` is constant.

use super::arm::{self, Arm, Role};
use super::{Draft, Joint};
use crate::freedom::Freedom;
use crate::point::{Interpolation, Support};
use crate::signal::Moment;
use nalgebra::Vector3;

/// One equation, `factor u.w - constant`.
#[derive(Clone, Debug, PartialEq)]
pub struct Product {
    /// First vector.
    pub u: Arm,
    /// Second vector.
    pub w: Arm,
    /// Factor of their product.
    pub factor: f64,
    /// What the sum must be.
    pub constant: f64,
    /// Another product of the sum.
    pub and: Option<Box<Product>>,
}

impl Product {
    /// `u.w = 0`.
    #[must_use]
    pub fn orthogonal(u: Arm, w: Arm) -> Self {
        Self { u, w, factor: 1.0, constant: 0.0, and: None }
    }

    /// `u.w = s.t`
    #[must_use]
    pub fn equal([u, w]: [Arm; 2], [s, t]: [Arm; 2]) -> Self {
        let other = Self { factor: -1.0, ..Self::orthogonal(s, t) };
        Self { and: Some(Box::new(other)), ..Self::orthogonal(u, w) }
    }

    /// The products of the sum.
    fn terms(&self) -> impl Iterator<Item = &Self> {
        std::iter::once(self).chain(self.and.as_deref())
    }

    fn placed(self, support: &Support) -> Self {
        let and = self.and.map(|other| Box::new(other.placed(support)));
        Self { u: self.u.placed(support), w: self.w.placed(support), and, ..self }
    }

    /// Sum of what each product gives.
    fn sum(&self, each: impl Fn(&Self) -> f64) -> f64 {
        self.terms().map(|p| p.factor * each(p)).sum()
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

    /// The same joint with further equations.
    #[must_use]
    pub fn with(mut self, more: impl IntoIterator<Item = Product>) -> Self {
        self.equations.extend(more);
        self
    }
}

impl Products {
    /// The same joint over the coordinates of `support`.
    #[must_use]
    pub fn over(mut self, support: Support) -> Self {
        self.equations = self.equations.into_iter().map(|p| p.placed(&support)).collect();
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
        let arms = self.equations.iter().flat_map(Product::terms).flat_map(|p| [&p.u, &p.w]);
        let of_freedom = self.freedom.iter().flat_map(Freedom::interpolations);
        arms.flat_map(Arm::interpolations).chain(of_freedom).collect()
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
            *phi = p.sum(|p| p.u.at(x).dot(&p.w.at(x))) - p.constant;
        }
    }

    fn jacobian(&self, _now: Moment<'_>, x: &[f64], out: &mut [f64]) {
        out.fill(0.0);
        for (row, p) in out.chunks_exact_mut(x.len()).zip(&self.equations) {
            for p in p.terms() {
                arm::add_gradient(&p.u, &p.w, x, p.factor, row);
            }
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
            for p in p.terms() {
                arm::add_hessian(&p.u, &p.w, x, stiffness * lambda_ * p.factor, out);
            }
        }
    }

    fn acceleration(&self, _now: Moment<'_>, x: &[f64], v: &[f64], out: &mut [f64]) {
        let rest = vec![0.0; v.len()];
        for (out, p) in out.iter_mut().zip(&self.equations) {
            *out = p.sum(|p| arm::motion(&p.u, &p.w, x, v, &rest)[2]);
        }
    }

    fn jerk(&self, _now: Moment<'_>, x: &[f64], v: &[f64], a: &[f64], out: &mut [f64]) {
        for (out, p) in out.iter_mut().zip(&self.equations) {
            *out = p.sum(|p| arm::motion(&p.u, &p.w, x, v, a)[3]);
        }
    }

    fn reaction(&self, _now: Moment<'_>, x: &[f64], lambda_: &[f64]) -> ([f64; 3], [f64; 3]) {
        // A vector u that turns with a body by d theta changes by d theta x u: a force f on it is the moment u x f.
        let (mut force, mut moment) = (Vector3::zeros(), Vector3::zeros());
        for (lambda_, p) in lambda_.iter().zip(&self.equations) {
            for p in p.terms() {
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
        }
        (force.into(), moment.into())
    }

    fn motion(&self, x: &[f64], v: &[f64]) -> Option<[f64; 2]> {
        let [y, rate, ..] = self.freedom.as_ref()?.motion(x, v, v);
        Some([y, rate])
    }
}
