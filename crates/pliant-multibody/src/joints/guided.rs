//! Drives of a point: it follows a path, `phi = r - u(t)` (3 equations); the tangent t of a line there a direction,
//! `phi = t.n_k(t)` (2); the axes of a rigid body there an orientation, `phi = a_i.b_j(t)` (3), or the section of a beam,
//! `phi = (y.b_1, z.b_1, y.b_3 - z.b_2)` (3).
//!
//! Every equation is a sum of `phi = u.w(t) - c(t)`, u affine in the coordinates: Jacobian `w du/dq`, Hessian zero,
//! `phi_t = u.w' - c'`, second derivative without accelerations `2 u'.w' + u.w'' - c''`, third at zero jerk
//! `3 u''.w' + 3 u'.w'' + u.w''' - c'''`.
//!
//! The normals n_k are carried along with the direction from step to step on the shortest way, so that it may turn as
//! far as it likes. Minus the multipliers are the force on the point and on what turns there.

use super::arm::{Arm, Role};
use super::side::{Frame, Side, gap};
use super::{Draft, Joint};
use crate::error::ModelError;
use crate::jet::{self, VectorJet};
use crate::point::{Interpolation, Support};
use crate::signal::{Moment, Value, first_break};
use crate::spec::Signal;
use crate::vector::{normals, vector};
use nalgebra::Vector3;

/// One equation.
#[derive(Clone, Debug)]
enum Equation {
    /// Component k of a position.
    Place { r: Arm, axis: usize },
    /// The tangent along normal k of the direction.
    Normal { t: Arm, number: usize },
    /// An axis of the body along axis j of the orientation.
    Axis { a: Arm, j: usize },
    /// The gradients of a section against its second and third axis, `y.b_3 - z.b_2`.
    Spin { y: Arm, z: Arm },
}

impl Equation {
    fn arms(&mut self) -> Vec<&mut Arm> {
        match self {
            Self::Place { r: u, .. } | Self::Normal { t: u, .. } | Self::Axis { a: u, .. } => {
                vec![u]
            }
            Self::Spin { y, z } => vec![y, z],
        }
    }
}

/// What a point is driven to, each where it is driven.
#[derive(Clone, Debug, Default)]
struct Course {
    position: Option<Value>,
    direction: Option<Value>,
    orientation: Option<[Value; 3]>,
}

/// A driven point.
#[derive(Clone, Debug)]
pub struct Guided {
    equations: Vec<Equation>,
    course: Course,
    support: Support,
}

/// The drive of a point by what is given.
///
/// # Errors
/// [`ModelError`] for signals that are wrong, or directions that the point does not have.
pub fn guided(
    a: &Side<'_>,
    place: &str,
    position: Option<&Signal>,
    direction: Option<&Signal>,
    orientation: Option<&[Signal; 3]>,
) -> Result<Guided, ModelError> {
    let refuse = |reason| ModelError::Unsupported { place: place.to_owned(), reason };
    let value = |signal: &Signal| Value::new(signal, place);
    let mut equations = Vec::new();
    let mut course = Course::default();
    if let Some(signal) = position {
        let world =
            Side { r: Interpolation::fixed([0.0; 3]), frame: Frame::World, first: false, q: a.q };
        equations.extend((0..3).map(|axis| Equation::Place { r: gap(a, &world), axis }));
        course.position = Some(value(signal)?);
    }
    if let Some(signal) = direction {
        let Frame::Line(t) = &a.frame else {
            return Err(refuse("only a cable has a direction that can be driven"));
        };
        let tangent = || Arm::new(t.clone(), Role::OfFirst);
        equations.extend([0, 1].map(|number| Equation::Normal { t: tangent(), number }));
        course.direction = Some(value(signal)?);
    }
    if let Some(signals) = orientation {
        let arm = |x: &Interpolation| Arm::new(x.clone(), Role::OfFirst);
        match &a.frame {
            Frame::Body(e) => {
                equations.extend((0..3).map(|i| Equation::Axis { a: arm(&e[i]), j: (i + 1) % 3 }))
            }
            Frame::Section([y, z]) => {
                equations.extend([y, z].map(|x| Equation::Axis { a: arm(x), j: 0 }));
                equations.push(Equation::Spin { y: arm(y), z: arm(z) });
            }
            _ => {
                let reason = "only a rigid body or a beam has an orientation that can be driven";
                return Err(refuse(reason));
            }
        }
        let [x, y, z] = signals;
        course.orientation = Some([value(x)?, value(y)?, value(z)?]);
    }
    Ok(Guided { equations, course, support: Support::default() })
}

fn vectors(value: &Value, now: Moment<'_>) -> VectorJet {
    value.jet(now).map(Vector3::from)
}

impl Guided {
    /// The time that drives see: constants are not scaled in statics.
    fn plain(now: Moment<'_>) -> Moment<'_> {
        Moment { constants: 1.0, ..now }
    }

    /// Direction and normals.
    fn triad(&self, now: Moment<'_>) -> Option<[VectorJet; 3]> {
        let d = jet::unit(&vectors(self.course.direction.as_ref()?, Self::plain(now)));
        let [d_0, n1, n2] = [0, 3, 6].map(|k| match now.memory.get(k..k + 3) {
            Some(x) => Vector3::new(x[0], x[1], x[2]),
            None => Vector3::zeros(),
        });
        let carry = |n| jet::carried(n, d_0, &d);
        Some([d, carry(n1), carry(n2)])
    }

    /// Calls `work` with each term's equation, its vector u, and w(t) and c(t).
    fn each(&self, now: Moment<'_>, mut work: impl FnMut(usize, &Arm, &VectorJet, [f64; 4])) {
        let position = self.course.position.as_ref().map(|p| vectors(p, Self::plain(now)));
        let triad = self.triad(now);
        let axes = self.course.orientation.as_ref();
        let axes = axes.map(|b| b.each_ref().map(|b| vectors(b, Self::plain(now))));
        for (i, equation) in self.equations.iter().enumerate() {
            match (equation, &position, &triad, &axes) {
                (Equation::Place { r, axis }, Some(position), _, _) => {
                    let unit = Vector3::ith(*axis, 1.0);
                    work(i, r, &jet::fixed(unit), position.map(|u| u[*axis]));
                }
                (Equation::Normal { t, number }, _, Some(triad), _) => {
                    work(i, t, &triad[1 + number], [0.0; 4]);
                }
                (Equation::Axis { a, j }, _, _, Some(axes)) => work(i, a, &axes[*j], [0.0; 4]),
                (Equation::Spin { y, z }, _, _, Some([_, b_2, b_3])) => {
                    work(i, y, b_3, [0.0; 4]);
                    work(i, z, &b_2.map(|b| -b), [0.0; 4]);
                }
                _ => {}
            }
        }
    }
}

impl Draft for Guided {
    fn count(&self) -> usize {
        self.equations.len()
    }

    fn interpolations(&self) -> Vec<&Interpolation> {
        let arms = self.equations.iter().flat_map(|equation| match equation {
            Equation::Place { r: u, .. }
            | Equation::Normal { t: u, .. }
            | Equation::Axis { a: u, .. } => vec![u],
            Equation::Spin { y, z } => vec![y, z],
        });
        arms.flat_map(Arm::interpolations).collect()
    }

    fn placed(mut self: Box<Self>, support: Support) -> Box<dyn Joint> {
        for equation in &mut self.equations {
            for arm in equation.arms() {
                *arm = arm.placed(&support);
            }
        }
        self.support = support;
        self
    }
}

impl Joint for Guided {
    fn equations(&self) -> usize {
        self.equations.len()
    }

    fn support(&self) -> &Support {
        &self.support
    }

    fn scale(&self, length: f64, out: &mut [f64]) {
        for (out, equation) in out.iter_mut().zip(&self.equations) {
            *out = if matches!(equation, Equation::Place { .. }) { length } else { 1.0 };
        }
    }

    fn residual(&self, now: Moment<'_>, x: &[f64], phi: &mut [f64]) {
        phi.fill(0.0);
        self.each(now, |i, u, w, c| phi[i] += u.at(x).dot(&w[0]) - c[0]);
    }

    fn jacobian(&self, now: Moment<'_>, x: &[f64], out: &mut [f64]) {
        out.fill(0.0);
        let n = x.len();
        self.each(now, |i, u, w, _| {
            u.add_force(x, w[0], &mut out[i * n..(i + 1) * n]);
        });
    }

    fn rate(&self, now: Moment<'_>, x: &[f64], out: &mut [f64]) {
        out.fill(0.0);
        self.each(now, |i, u, w, c| out[i] += u.at(x).dot(&w[1]) - c[1]);
    }

    fn acceleration(&self, now: Moment<'_>, x: &[f64], v: &[f64], out: &mut [f64]) {
        out.fill(0.0);
        self.each(now, |i, u, w, c| {
            out[i] += 2.0 * u.rate(x, v).dot(&w[1]) + u.at(x).dot(&w[2]) - c[2];
        });
    }

    fn jerk(&self, now: Moment<'_>, x: &[f64], v: &[f64], a: &[f64], out: &mut [f64]) {
        out.fill(0.0);
        self.each(now, |i, u, w, c| {
            let mixed = u.rate(x, a).dot(&w[1]) + u.rate(x, v).dot(&w[2]);
            out[i] += 3.0 * mixed + u.at(x).dot(&w[3]) - c[3];
        });
    }

    fn reaction(&self, now: Moment<'_>, x: &[f64], lambda_: &[f64]) -> ([f64; 3], [f64; 3]) {
        let (mut force, mut moment) = (Vector3::zeros(), Vector3::zeros());
        self.each(now, |i, u, w, _| {
            let f = w[0] * -lambda_[i];
            if u.role == Role::Gap {
                force += f;
            } else {
                moment += u.at(x).cross(&f);
            }
        });
        (force.into(), moment.into())
    }

    fn next_break(&self, t: f64) -> Option<f64> {
        let Course { position, direction, orientation } = &self.course;
        first_break(position.iter().chain(direction).chain(orientation.iter().flatten()), t)
    }

    fn is_driven(&self) -> bool {
        true
    }

    fn memory(&self) -> usize {
        if self.course.direction.is_some() { 9 } else { 0 }
    }

    fn begin(&self, now: Moment<'_>, memory: &mut [f64]) {
        if let Some(direction) = &self.course.direction {
            let d = vector(direction.at(Self::plain(now))).normalize();
            let (n1, n2) = normals(d);
            for (slot, vector) in memory.chunks_exact_mut(3).zip([d, n1, n2]) {
                slot.copy_from_slice(vector.as_slice());
            }
        }
    }

    fn remember(&self, now: Moment<'_>, memory: &mut [f64]) {
        if let Some(triad) = self.triad(now) {
            for (slot, vector) in memory.chunks_exact_mut(3).zip(triad) {
                slot.copy_from_slice(vector[0].as_slice());
            }
        }
    }
}
