//! Wind on a face of a surface: drag along the flow and lift across it.
//!
//! Per current area, with the velocity relative to the surface `w = W - r_t`, the unit normal n, `s = w.n` and the
//! density rho: drag `rho/2 C_D s^2 w/|w|` and lift `rho/2 C_L s (|w| n - s w/|w|)`, of coefficients `C_D sin^2 alpha` and
//! `C_L sin alpha cos alpha` at the angle alpha between flow and surface. Where both are one number the flow presses along
//! the normal alone, `rho/2 C |w| s n`. With the vector area `N = a_1 x a_2` per reference area:
//! `f = k_1 |w| (w.N) N/|N| + k_2 (w.N)^2 w/(|w| |N|)`, `k_1 = rho/2 C_L`, `k_2 = rho/2 (C_D - C_L)`.
//!
//! Of the power `f.W` that the wind gives, `f.r_t` moves the surface and `f.w >= 0` is lost: lift has none of that.

use super::{At, Context, ForceElement, Part};
use crate::error::ModelError;
use crate::loads::pressure::Face;
use crate::point::Support;
use crate::signal::Value;
use crate::spec::ForceSpec;
use crate::vector::vector;
use nalgebra::{Matrix3, Vector3};
use pliant_elements::RulePoint;

/// Wind on one face.
pub struct SheetWind {
    points: Vec<RulePoint>,
    velocity: Value,
    /// `k_1` and `k_2` [kg/m^3].
    factors: [f64; 2],
    support: Support,
}

/// The flow at a point: relative velocity, its amount and direction, vector area, its amount, `w.N`, a_1 and a_2.
struct Flow {
    w: Vector3<f64>,
    speed: f64,
    along: Vector3<f64>,
    area: Vector3<f64>,
    size: f64,
    through: f64,
    a: [Vector3<f64>; 2],
}

impl SheetWind {
    /// Wind on each face.
    pub(super) fn of_spec(
        force: &ForceSpec,
        context: &Context<'_>,
    ) -> Result<Vec<Self>, ModelError> {
        let ForceSpec::SheetWind { name, surface, faces, velocity, density, drag, lift } = force
        else {
            return Err(super::other_kind("wind on a surface"));
        };
        let place = format!("wind '{name}'");
        for x in [density, drag, lift] {
            if !(*x >= 0.0 && x.is_finite()) {
                let allowed = "density and coefficients from zero on";
                return Err(ModelError::Value { place, value: *x, allowed });
            }
        }
        let velocity = Value::new(velocity, &place)?;
        let factors = [0.5 * density * lift, 0.5 * density * (drag - lift)];
        let each = |(Face { block, element }, support)| Self {
            points: block.rule_points(element),
            velocity: velocity.clone(),
            factors,
            support,
        };
        Ok((context.faces)(*surface, faces, &place)?.into_iter().map(each).collect())
    }

    fn flow(&self, point: &RulePoint, at: At<'_>) -> Flow {
        let sum = |row: &[f64], x: &[f64]| {
            let terms = row.iter().zip(x.chunks_exact(3));
            terms.fold(Vector3::zeros(), |sum, (w, x)| sum + vector([x[0], x[1], x[2]]) * *w)
        };
        let w = vector(self.velocity.at(at.now)) - sum(&point.rows[0], at.v);
        let a = [sum(&point.rows[1], at.x), sum(&point.rows[2], at.x)];
        let area = a[0].cross(&a[1]);
        let speed = w.norm();
        let along = if speed > 0.0 { w / speed } else { w };
        Flow { w, speed, along, area, size: area.norm(), through: w.dot(&area), a }
    }

    /// Force per reference area [Pa].
    fn force(&self, flow: &Flow) -> Vector3<f64> {
        let [k_1, k_2] = self.factors;
        let s = flow.through / flow.size;
        flow.area * (k_1 * flow.speed * s) + flow.along * (k_2 * flow.through * s)
    }
}

/// Adds `sum_ij left_i right_j k` to the n x n matrix `out`.
fn add_rows(left: &[f64], right: &[f64], k: &Matrix3<f64>, out: &mut [f64]) {
    let n = 3 * left.len();
    for (i, l) in left.iter().enumerate() {
        for (j, r) in right.iter().enumerate() {
            for c in 0..3 {
                for d in 0..3 {
                    out[(3 * i + c) * n + 3 * j + d] += l * r * k[(c, d)];
                }
            }
        }
    }
}

impl ForceElement for SheetWind {
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
            let f = self.force(&self.flow(point, at)) * (factor * point.area);
            for (to, n) in out.chunks_exact_mut(3).zip(&point.rows[0]) {
                for c in 0..3 {
                    to[c] += n * f[c];
                }
            }
        }
    }

    fn add_tangent(&self, at: At<'_>, stiffness: f64, damping: f64, out: &mut [f64]) {
        let [k_1, k_2] = self.factors;
        for point in &self.points {
            let flow = self.flow(point, at);
            let Flow { w, speed, along, area, size, through, a } = flow;
            let (normal, s) = (area / size, through / size);
            // df/dw and df/dN.
            let across = Matrix3::identity() - along * along.transpose();
            let slip = if speed > 0.0 { s * through / speed } else { 0.0 };
            let by_w = (area * along.transpose() * s + normal * area.transpose() * speed) * k_1
                + (along * area.transpose() * (2.0 * s) + across * slip) * k_2;
            let level = Matrix3::identity() - normal * normal.transpose();
            let by_area = (normal * w.transpose() + level * s) * (k_1 * speed)
                + along * (w * (2.0 * s) - normal * (s * s)).transpose() * k_2;
            // w = W - r_t, N = a_1 x a_2.
            let [shape, b_1, b_2] = &point.rows;
            add_rows(shape, shape, &(by_w * (damping * point.area)), out);
            let by_a_1 = by_area * -a[1].cross_matrix();
            let by_a_2 = by_area * a[0].cross_matrix();
            add_rows(shape, b_1, &(by_a_1 * (-stiffness * point.area)), out);
            add_rows(shape, b_2, &(by_a_2 * (-stiffness * point.area)), out);
        }
    }

    fn has_potential(&self) -> bool {
        false
    }

    fn transit(&self, at: At<'_>) -> f64 {
        let power = |point: &RulePoint| {
            let flow = self.flow(point, at);
            point.area * self.force(&flow).dot(&flow.w)
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
