//! One side of a joint: its point, and the directions that turn with its body.

use super::product::{Arm, Product, Role};
use crate::point::Interpolation;
use crate::vector::{normals, vector};
use nalgebra::Vector3;

/// What turns at a joint's point.
#[derive(Clone, Debug)]
pub enum Frame {
    /// The world: nothing turns.
    World,
    /// The axes of a rigid body.
    Body([Interpolation; 3]),
    /// The tangent of a line, which has no twist.
    Line(Interpolation),
    /// Two tangents of a shell, by stress-free arc length.
    Sheet([Interpolation; 2]),
    /// Nothing is known of directions: a point mass.
    Point,
}

/// A side of a joint; directions are named by where they stand at the start.
#[derive(Clone, Debug)]
pub struct Side<'a> {
    /// The joint's point.
    pub r: Interpolation,
    /// What turns there.
    pub frame: Frame,
    /// Whether it is the joint's first side.
    pub first: bool,
    /// Coordinates at the start.
    pub q: &'a [f64],
}

/// Sine of the angle below which two directions count as parallel.
const PARALLEL: f64 = 1e-6;

impl Side<'_> {
    /// Whether every direction is carried along.
    #[must_use]
    pub fn is_frame(&self) -> bool {
        matches!(self.frame, Frame::World | Frame::Body(_))
    }

    /// The direction of the tangent at the start, on lines.
    fn tangent(&self) -> Option<Vector3<f64>> {
        match &self.frame {
            Frame::Line(t) => vector(t.at(self.q)).try_normalize(0.0),
            _ => None,
        }
    }

    /// The unit vector that starts as `axis` and turns with the body; none where nothing here points that way.
    #[must_use]
    pub fn direction(&self, axis: Vector3<f64>) -> Option<Arm> {
        let value = match &self.frame {
            Frame::World => Interpolation::fixed(axis.into()),
            Frame::Body(e) => {
                let components = e.iter().map(|e| (e, vector(e.at(self.q)).dot(&axis)));
                Interpolation::weighted(
                    components.flat_map(|(e, x)| e.terms.iter().map(move |&(o, w)| (o, w * x))),
                )
            }
            Frame::Line(t) => {
                let along = vector(t.at(self.q));
                if along.cross(&axis).norm() > PARALLEL * along.norm() {
                    return None;
                }
                let factor = along.dot(&axis).signum() / along.norm();
                Interpolation::weighted(t.terms.iter().map(|&(o, w)| (o, w * factor)))
            }
            Frame::Sheet(tangents) => {
                let [a, b] = tangents.each_ref().map(|t| vector(t.at(self.q)));
                // The axis in terms of the two tangents, where it lies in their plane.
                let (aa, ab, bb) = (a.dot(&a), a.dot(&b), b.dot(&b));
                let (ra, rb) = (a.dot(&axis), b.dot(&axis));
                let d = aa * bb - ab * ab;
                let (x, y) = ((ra * bb - rb * ab) / d, (rb * aa - ra * ab) / d);
                if (a * x + b * y - axis).norm() > PARALLEL {
                    return None;
                }
                let part = |t: &Interpolation, x: f64| {
                    t.terms.iter().map(move |&(o, w)| (o, w * x)).collect::<Vec<_>>()
                };
                Interpolation::weighted(
                    part(&tangents[0], x).into_iter().chain(part(&tangents[1], y)),
                )
            }
            Frame::Point => return None,
        };
        Some(Arm { value, role: if self.first { Role::OfFirst } else { Role::Other } })
    }
}

/// `r_a - r_b`.
#[must_use]
pub fn gap(a: &Side<'_>, b: &Side<'_>) -> Arm {
    Arm { value: a.r.minus(&b.r), role: Role::Gap }
}

/// The points coincide: `(r_a - r_b).e_k = 0`, minus the multipliers are the force on a.
#[must_use]
pub fn coincident(a: &Side<'_>, b: &Side<'_>) -> Vec<Product> {
    let unit = |k: usize| std::array::from_fn(|i| f64::from(u8::from(i == k)));
    (0..3).map(|k| Product::orthogonal(gap(a, b), Arm::fixed(unit(k)))).collect()
}

/// An axis of one side stays normal to two directions of the other: the two turn about it only.
#[must_use]
pub fn parallel(a: &Side<'_>, b: &Side<'_>, axis: Vector3<f64>) -> Option<Vec<Product>> {
    let (frame, other) = if b.is_frame() { (b, a) } else { (a, b) };
    if !frame.is_frame() {
        return None;
    }
    let (n1, n2) = normals(axis);
    let equation = |n| Some(Product::orthogonal(other.direction(axis)?, frame.direction(n)?));
    [n1, n2].into_iter().map(equation).collect()
}

/// The shell among two sides, and the frame that it meets.
fn sheet_and_frame<'a, 'q>(
    a: &'a Side<'q>,
    b: &'a Side<'q>,
) -> Option<(&'a Side<'q>, &'a Side<'q>, &'a [Interpolation; 2])> {
    match (&a.frame, &b.frame) {
        (Frame::Sheet(t), _) if b.is_frame() => Some((a, b, t)),
        (_, Frame::Sheet(t)) if a.is_frame() => Some((b, a, t)),
        _ => None,
    }
}

/// The two turn together. Between frames `a_1.b_2 = a_2.b_3 = a_3.b_1 = 0`, the axes those of the world at the start;
/// a line, which has no twist, keeps the direction of its tangent, a shell its normal and the direction of one tangent.
#[must_use]
pub fn locked(a: &Side<'_>, b: &Side<'_>) -> Option<Vec<Product>> {
    if let Some((sheet, frame, tangents)) = sheet_and_frame(a, b) {
        let [t, s] = tangents.each_ref().map(|t| vector(t.at(sheet.q)));
        let normal = t.cross(&s).try_normalize(0.0)?;
        let t = t.try_normalize(0.0)?;
        let across = normal.cross(&t);
        return [(t, normal), (across, normal), (t, across)]
            .into_iter()
            .map(|(of, to)| Some(Product::orthogonal(sheet.direction(of)?, frame.direction(to)?)))
            .collect();
    }
    if let Some(tangent) = a.tangent().or(b.tangent()) {
        return parallel(a, b, tangent);
    }
    let axes = [Vector3::x(), Vector3::y(), Vector3::z()];
    let equation = |i: usize| {
        Some(Product::orthogonal(a.direction(axes[i])?, b.direction(axes[(i + 1) % 3])?))
    };
    (0..3).map(equation).collect()
}

/// The two turn about an axis only, or, where the tangent of a line is normal to the axis, the tangent stays so.
#[must_use]
pub fn turning(a: &Side<'_>, b: &Side<'_>, axis: Vector3<f64>) -> Option<Vec<Product>> {
    let Some(tangent) = a.tangent().or(b.tangent()) else { return parallel(a, b, axis) };
    if tangent.dot(&axis).abs() > PARALLEL {
        return parallel(a, b, axis);
    }
    let (line, frame) = if a.tangent().is_some() { (a, b) } else { (b, a) };
    let equation = Product::orthogonal(line.direction(tangent)?, frame.direction(axis)?);
    Some(vec![equation])
}
