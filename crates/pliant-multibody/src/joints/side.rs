//! One side of a joint: its point, and the directions that turn with its body.

use super::arm::{Arm, Role};
use super::product::Product;
use crate::point::Interpolation;
use crate::vector::{normals, vector};
use nalgebra::{Matrix3, Vector3};

/// What turns at a joint's point.
#[derive(Clone, Debug)]
pub enum Frame {
    /// The world: nothing turns.
    World,
    /// The axes of a rigid body.
    Body([Interpolation; 3]),
    /// The tangent of a line, which has no twist.
    Line(Interpolation),
    /// The gradients r,y and r,z of a beam, which span its section.
    Section([Interpolation; 2]),
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
        matches!(self.frame, Frame::World | Frame::Body(_) | Frame::Section(_))
    }

    /// The axes of a section at the start: its normal and two across, as near to r,y and r,z as to each other.
    fn section(&self) -> Option<[Vector3<f64>; 3]> {
        match &self.frame {
            Frame::Section([y, z]) => section_axes(vector(y.at(self.q)), vector(z.at(self.q))),
            _ => None,
        }
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
        let role = if self.first { Role::OfFirst } else { Role::Other };
        let value = match &self.frame {
            Frame::Section([y, z]) => {
                let (y_0, z_0) = (vector(y.at(self.q)), vector(z.at(self.q)));
                let basis = Matrix3::from_columns(&[y_0.cross(&z_0), y_0, z_0]);
                let along = basis.try_inverse()? * axis;
                let part = |x: &Interpolation, c: f64| {
                    x.terms.iter().map(move |&(o, w)| (o, w * c)).collect::<Vec<_>>()
                };
                let across = part(y, along[1]).into_iter().chain(part(z, along[2]));
                let normal = (along[0], y.clone(), z.clone());
                return Some(Arm::with_cross(Interpolation::weighted(across), normal, role));
            }
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
        Some(Arm::new(value, role))
    }
}

/// Axes of the section that two gradients span: its normal and two orthonormal vectors in it, as near to the one as to
/// the other.
#[must_use]
pub fn section_axes(y: Vector3<f64>, z: Vector3<f64>) -> Option<[Vector3<f64>; 3]> {
    let normal = y.cross(&z).try_normalize(0.0)?;
    let across = (y + z.cross(&normal)).try_normalize(0.0)?;
    Some([normal, across, normal.cross(&across)])
}

/// The section of a beam keeps its angle in its plane, `y.z = y_0.z_0`: what joints hold by single directions need, for
/// a torque that enters by one gradient alone would shear the section where it enters.
#[must_use]
pub fn unsheared(side: &Side<'_>) -> Option<Product> {
    let Frame::Section([y, z]) = &side.frame else { return None };
    let constant = vector(y.at(side.q)).dot(&vector(z.at(side.q)));
    let arm = |x: &Interpolation| Arm::new(x.clone(), Role::Other);
    Some(Product { constant, ..Product::orthogonal(arm(y), arm(z)) })
}

/// `r_a - r_b`.
#[must_use]
pub fn gap(a: &Side<'_>, b: &Side<'_>) -> Arm {
    Arm::new(a.r.minus(&b.r), Role::Gap)
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
/// The section of a beam, which may shear in its plane, turns by `y_a.n_b = z_a.n_b = 0` and `y_a.z_b = z_a.y_b`, which
/// passes a torque without shear; between two sections all three equations are differences of that kind.
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
    if let Some(axes) = a.section().or(b.section()) {
        let (section, other) = if a.section().is_some() { (a, b) } else { (b, a) };
        let both = other.section().is_some();
        let of = |side: &Side<'_>, i: usize| side.direction(axes[i]);
        let equation = |(i, j, difference)| {
            let first = [of(section, i)?, of(other, j)?];
            Some(if difference {
                Product::equal(first, [of(section, j)?, of(other, i)?])
            } else {
                let [u, w] = first;
                Product::orthogonal(u, w)
            })
        };
        return [(1, 0, both), (2, 0, both), (1, 2, true)].into_iter().map(equation).collect();
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
