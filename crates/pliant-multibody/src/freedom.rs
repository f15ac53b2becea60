//! The freedom that a joint leaves, as a number y(q): an angle or a way, with its derivatives.
//!
//! Both are made of products u.w of vectors ([`crate::joints::arm`]). A way is one product. An angle is
//! `Im log z`, `z = c + i s` with two of them, so that with `w_k = z^(k)/z` its time derivatives are `Im w_1`,
//! `Im (w_2 - w_1^2)`, `Im (w_3 - 3 w_1 w_2 + 2 w_1^3)`. That of a fold, of three vectors, has a file of its own.

use crate::fold::Fold;
use crate::joints::arm::{self, Arm, Role, add_gradient};
use crate::point::{Interpolation, Support};
use nalgebra::{Complex, Vector3};
use std::f64::consts::TAU;

/// The freedom that a joint leaves, as a number.
#[derive(Clone, Debug, PartialEq)]
pub enum Freedom {
    /// The angle of u in the plane (cosine, sine), times a sign.
    Angle {
        /// The vector that turns.
        u: Arm,
        /// Where the angle is zero.
        cosine: Arm,
        /// Where it is a right angle.
        sine: Arm,
        /// 1, or -1 where u belongs to the second body.
        sign: f64,
    },
    /// The product u.w.
    Length {
        /// The gap.
        u: Arm,
        /// The direction.
        w: Arm,
    },
    /// The angle between two sheets along a crease.
    Fold(Fold),
}

/// The argument of `c + i s` and its first three time derivatives.
fn argument(c: [f64; 4], s: [f64; 4]) -> [f64; 4] {
    let z: [Complex<f64>; 4] = std::array::from_fn(|k| Complex::new(c[k], s[k]));
    let [w1, w2, w3] = [1, 2, 3].map(|k| z[k] / z[0]);
    let third = w3 - w1 * w2 * 3.0 + w1 * w1 * w1 * 2.0;
    [z[0].arg(), w1.im, (w2 - w1 * w1).im, third.im]
}

impl Freedom {
    /// Whether it is an angle, known up to whole turns.
    #[must_use]
    pub fn is_angle(&self) -> bool {
        matches!(self, Self::Angle { .. } | Self::Fold(_))
    }

    /// Its vectors.
    #[must_use]
    pub fn interpolations(&self) -> Vec<&Interpolation> {
        match self {
            Self::Angle { u, cosine, sine, .. } => {
                [u, cosine, sine].into_iter().flat_map(Arm::interpolations).collect()
            }
            Self::Length { u, w } => [u, w].into_iter().flat_map(Arm::interpolations).collect(),
            Self::Fold(fold) => fold.interpolations(),
        }
    }

    /// The same over the coordinates of a support.
    #[must_use]
    pub fn placed(&self, support: &Support) -> Self {
        let local = |arm: &Arm| arm.placed(support);
        match self {
            Self::Angle { u, cosine, sine, sign } => {
                Self::Angle { u: local(u), cosine: local(cosine), sine: local(sine), sign: *sign }
            }
            Self::Length { u, w } => Self::Length { u: local(u), w: local(w) },
            Self::Fold(fold) => Self::Fold(fold.placed(support)),
        }
    }

    /// y, y', y'' and y''' at zero jerk; angles up to whole turns.
    #[must_use]
    pub fn motion(&self, x: &[f64], v: &[f64], a: &[f64]) -> [f64; 4] {
        match self {
            Self::Angle { u, cosine, sine, sign } => {
                let (c, s) = (arm::motion(u, cosine, x, v, a), arm::motion(u, sine, x, v, a));
                argument(c, s).map(|y| sign * y)
            }
            Self::Length { u, w } => arm::motion(u, w, x, v, a),
            Self::Fold(fold) => {
                let (c, s) = fold.pair(x, v, a);
                let [y, y1, y2, y3] = argument(c.0, s.0);
                [fold.meant(y), y1, y2, y3]
            }
        }
    }

    /// y, angles up to whole turns.
    #[must_use]
    pub fn value(&self, x: &[f64]) -> f64 {
        match self {
            Self::Angle { u, cosine, sine, sign } => {
                let u = u.at(x);
                sign * u.dot(&sine.at(x)).atan2(u.dot(&cosine.at(x)))
            }
            Self::Length { u, w } => u.at(x).dot(&w.at(x)),
            Self::Fold(fold) => fold.value(x),
        }
    }

    /// y; of angles the one nearest to `reference`.
    #[must_use]
    pub fn near(&self, x: &[f64], reference: f64) -> f64 {
        let y = self.value(x);
        if self.is_angle() { y + TAU * ((reference - y) / TAU).round() } else { y }
    }

    /// `out += factor dy/dx`
    pub fn add_gradient(&self, x: &[f64], factor: f64, out: &mut [f64]) {
        match self {
            Self::Angle { u, cosine, sine, sign } => {
                // d theta = (c ds - s dc)/|z|^2
                let (c, s) = (u.at(x).dot(&cosine.at(x)), u.at(x).dot(&sine.at(x)));
                let f = sign * factor / (c * c + s * s);
                add_gradient(u, sine, x, f * c, out);
                add_gradient(u, cosine, x, -f * s, out);
            }
            Self::Length { u, w } => add_gradient(u, w, x, factor, out),
            Self::Fold(fold) => fold.add_gradient(x, factor, out),
        }
    }

    /// `out += factor d2y/dx2`, n x n row by row.
    pub fn add_hessian(&self, x: &[f64], factor: f64, out: &mut [f64]) {
        let n = x.len();
        match self {
            Self::Angle { u, cosine, sine, sign } => {
                // Im of z_xx/z - z_x z_x^T/z^2
                let (c, s) = (u.at(x).dot(&cosine.at(x)), u.at(x).dot(&sine.at(x)));
                let square = c * c + s * s;
                let f = sign * factor / square;
                arm::add_hessian(u, sine, x, f * c, out);
                arm::add_hessian(u, cosine, x, -f * s, out);
                let (mut c_x, mut s_x) = (vec![0.0; n], vec![0.0; n]);
                add_gradient(u, cosine, x, 1.0, &mut c_x);
                add_gradient(u, sine, x, 1.0, &mut s_x);
                let (same, mixed) = (2.0 * c * s * f / square, (c * c - s * s) * f / square);
                for i in 0..n {
                    for j in 0..n {
                        out[i * n + j] += same * (c_x[i] * c_x[j] - s_x[i] * s_x[j])
                            - mixed * (c_x[i] * s_x[j] + s_x[i] * c_x[j]);
                    }
                }
            }
            Self::Length { u, w } => arm::add_hessian(u, w, x, factor, out),
            Self::Fold(fold) => fold.add_hessian(x, factor, out),
        }
    }

    /// Force and moment on the first body, about the joint's point, of a force of one along the freedom.
    #[must_use]
    pub fn wrench(&self, x: &[f64]) -> (Vector3<f64>, Vector3<f64>) {
        let (mut force, mut moment) = (Vector3::zeros(), Vector3::zeros());
        let mut on = |arm: &Arm, f: Vector3<f64>| match arm.role {
            Role::Gap => force += f,
            Role::OfFirst => moment += arm.at(x).cross(&f),
            Role::Other => {}
        };
        match self {
            Self::Angle { u, cosine, sine, sign } => {
                let (c, s) = (u.at(x).dot(&cosine.at(x)), u.at(x).dot(&sine.at(x)));
                let f = sign / (c * c + s * s);
                on(u, (sine.at(x) * c - cosine.at(x) * s) * f);
                on(sine, u.at(x) * (f * c));
                on(cosine, u.at(x) * (-f * s));
            }
            Self::Length { u, w } => {
                on(u, w.at(x));
                on(w, u.at(x));
            }
            Self::Fold(fold) => {
                for (arm, g) in fold.arms().into_iter().zip(fold.gradient(x)) {
                    on(arm, g);
                }
            }
        }
        (force, moment)
    }
}
