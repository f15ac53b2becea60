//! Wind on an element of a line: the drag and lift of its flow across the line.
//!
//! Per current length, with the velocity relative to the line `w = W - r_t`, its part `n = w - t (t.w)` normal to the
//! unit tangent t, density rho and diameter D: drag `rho/2 C_D D |n| n` and lift `rho/2 C_L D |n| t x n`. Flow along the
//! line does nothing (the independence principle of slender bodies). The lift coefficient may depend on the angle of
//! attack alpha, from the wind's direction at the start to n, both seen along t, positive about t: a section that keeps
//! its orientation in the world, for a line has no twist. Three Gauss points.
//!
//! Of the power `F.W` that the wind gives, `F.r_t` moves the line and `F.w >= 0` is lost: lift has none of that.

use super::{At, Context, ForceElement, Part, add_outer};
use crate::error::ModelError;
use crate::point::{Interpolation, Support};
use crate::signal::{Table, Value};
use crate::spec::{ForceSpec, LiftSpec, PointSpec};
use crate::vector::vector;
use nalgebra::{Matrix3, Vector3};
use pliant_math::quadrature::GAUSS_3;

/// Wind on one element.
#[derive(Clone, Debug)]
pub struct Wind {
    points: Vec<Point>,
    velocity: Value,
    /// Direction of the wind at the start.
    direction: Vector3<f64>,
    /// `rho/2 C_D D` [kg/m^2].
    drag: f64,
    lift: Lift,
    support: Support,
}

/// `rho/2 C_L D`, which may depend on the angle of attack.
#[derive(Clone, Debug)]
enum Lift {
    Constant(f64),
    Angle(f64, Table),
}

/// An integration point: weight [m], position and tangent.
#[derive(Clone, Debug)]
struct Point {
    weight: f64,
    r: Interpolation,
    t: Interpolation,
}

/// The flow at a point.
struct Flow {
    /// Unit tangent, and the stretch |r'|.
    t: Vector3<f64>,
    stretch: f64,
    /// Relative velocity along the line, and across it with its amount.
    along: f64,
    n: Vector3<f64>,
    speed: f64,
    /// Lift over |n| t x n, and its derivative by the angle of attack.
    lift: f64,
    lift_slope: f64,
    /// Derivative of the angle of attack by the tangent, at a fixed n.
    angle_by_t: Vector3<f64>,
}

impl Wind {
    /// Wind on each element of a cable.
    pub(super) fn of_spec(
        force: &ForceSpec,
        context: &Context<'_>,
    ) -> Result<Vec<Self>, ModelError> {
        let ForceSpec::Wind { name, cable, velocity, direction, density, drag, lift, diameters } =
            force
        else {
            return Err(super::other_kind("wind"));
        };
        let place = format!("wind '{name}'");
        let bad = |value, allowed| ModelError::Value { place: place.clone(), value, allowed };
        for x in [density, drag].into_iter().chain(diameters) {
            if !(*x >= 0.0 && x.is_finite()) {
                return Err(bad(*x, "density, drag and diameters from zero on"));
            }
        }
        let count = context.map.cables.len();
        let map = context.map.cables.get(*cable).ok_or_else(|| ModelError::Reference {
            place: place.clone(),
            kind: "cable",
            index: *cable,
            count,
        })?;
        if diameters.len() != map.elements() {
            let expected = format!("{} diameters", map.elements());
            return Err(ModelError::Length { place, expected, got: diameters.len() });
        }
        let velocity = Value::new(velocity, &place)?;
        let mut elements = Vec::with_capacity(diameters.len());
        for (element, diameter) in diameters.iter().enumerate() {
            let half = 0.5 * density * diameter;
            let lift = match lift {
                LiftSpec::Constant(c) if c.is_finite() => Lift::Constant(half * c),
                LiftSpec::Constant(c) => return Err(bad(*c, "finite lift coefficients")),
                LiftSpec::Angle { angles, coefficients } => {
                    let period = Some(std::f64::consts::TAU);
                    Lift::Angle(half, Table::new(angles, coefficients, period, true, &place)?)
                }
            };
            let mut points = Vec::with_capacity(3);
            for (xi, weight) in GAUSS_3.xi.iter().zip(GAUSS_3.weight) {
                let at = PointSpec::Cable { cable: *cable, element, xi: *xi };
                let (r, _) = context.map.point(&at, &place)?;
                let t = map.tangent(element, *xi);
                points.push(Point { weight: weight * map.lengths[element], r, t });
            }
            let support = (context.support)(&[&points[0].r, &points[0].t]);
            for point in &mut points {
                (point.r, point.t) = (support.localize(&point.r), support.localize(&point.t));
            }
            elements.push(Self {
                points,
                velocity: velocity.clone(),
                direction: vector(*direction),
                drag: half * drag,
                lift,
                support,
            });
        }
        Ok(elements)
    }

    fn flow(&self, point: &Point, at: At<'_>) -> Flow {
        let slope = vector(point.t.at(at.x));
        let stretch = slope.norm().max(f64::MIN_POSITIVE);
        let t = slope / stretch;
        let w = vector(self.velocity.at(at.now)) - vector(point.r.rate(at.v));
        let along = t.dot(&w);
        let n = w - t * along;
        let speed = n.norm();
        let mut flow = Flow {
            t,
            stretch,
            along,
            n,
            speed,
            lift: 0.0,
            lift_slope: 0.0,
            angle_by_t: Vector3::zeros(),
        };
        match &self.lift {
            Lift::Constant(c) => flow.lift = *c,
            Lift::Angle(half, table) => {
                let ahead = self.direction.dot(&t);
                let zero = self.direction - t * ahead;
                let alpha = t.dot(&zero.cross(&n)).atan2(zero.dot(&n));
                let (coefficient, slope) = table.with_slope(alpha);
                flow.lift = half * coefficient[0];
                flow.lift_slope = half * slope[0];
                // The zero direction turns with t; where it ends along t, the angle is nobody's.
                let square = zero.norm_squared();
                if square > 0.0 {
                    flow.angle_by_t = t.cross(&zero) * (ahead / square);
                }
            }
        }
        flow
    }

    fn force(&self, flow: &Flow) -> Vector3<f64> {
        (flow.n * self.drag + flow.t.cross(&flow.n) * flow.lift) * (flow.speed * flow.stretch)
    }
}

impl ForceElement for Wind {
    fn support(&self) -> &Support {
        &self.support
    }

    fn parts(&self) -> &[Part] {
        &[Part::Work]
    }

    fn add_force(&self, part: Part, at: At<'_>, factor: f64, out: &mut [f64]) {
        if part != Part::Work {
            return;
        }
        for point in &self.points {
            let f = self.force(&self.flow(point, at)) * (factor * point.weight);
            point.r.add_force(f.into(), out);
        }
    }

    fn add_tangent(&self, at: At<'_>, stiffness: f64, damping: f64, out: &mut [f64]) {
        let size = at.x.len();
        for point in &self.points {
            let flow = self.flow(point, at);
            let Flow { t, stretch, along, n, speed, lift, lift_slope, angle_by_t } = flow;
            let unit = if speed > 0.0 { n / speed } else { n };
            // f = |r'| |n| A n with A = drag + lift [t]x; by n, the angle of attack included.
            let a = Matrix3::from_diagonal_element(self.drag) + t.cross_matrix() * lift;
            let side = t.cross(&n);
            let angle_by_n = if speed > 0.0 { side / (speed * speed) } else { side };
            let by_n = (a * speed
                + a * n * unit.transpose()
                + side * angle_by_n.transpose() * (lift_slope * speed))
                * stretch;
            let across = Matrix3::identity() - t * t.transpose();
            // n = (1 - t t^T) w: by w, and by r' through t.
            let by_v = by_n * across * (-damping);
            let n_by_slope = -(across * along + t * n.transpose()) / stretch;
            let by_slope = by_n * n_by_slope
                + (a * n) * t.transpose() * speed
                + (-n.cross_matrix() * across * lift
                    + side * (across * angle_by_t).transpose() * lift_slope)
                    * speed;
            add_outer(&point.r, &point.r, &(by_v * -point.weight), size, out);
            let by_slope = by_slope * (-stiffness * point.weight);
            add_outer(&point.r, &point.t, &by_slope, size, out);
        }
    }

    fn has_potential(&self) -> bool {
        false
    }

    fn transit(&self, at: At<'_>) -> f64 {
        let power = |p: &Point| {
            let flow = self.flow(p, at);
            p.weight * self.force(&flow).dot(&flow.n)
        };
        self.points.iter().map(power).sum()
    }

    fn has_transit(&self) -> bool {
        true
    }

    fn has_damping(&self) -> bool {
        true
    }

    fn next_break(&self, t: f64) -> Option<f64> {
        self.velocity.next_break(t)
    }

    fn output_count(&self) -> usize {
        0
    }

    fn outputs(&self, _at: At<'_>, _out: &mut [f64]) {}
}
