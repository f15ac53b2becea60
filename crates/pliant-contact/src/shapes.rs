//! Shapes: signed distance of a point, below zero inside, with its gradient and Hessian. Axis z, centre at the origin of
//! the shape's own frame.

use crate::bore::Bore;
use crate::meshes::Mesh;
use nalgebra::{Matrix3, Vector3};
use std::borrow::Cow;

/// A shape in its own frame.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// All below z = 0.
    HalfSpace,
    /// A ball.
    Ball {
        /// Radius [m].
        radius: f64,
    },
    /// A box.
    Box {
        /// Half of its edges [m].
        half: [f64; 3],
    },
    /// A cylinder with flat ends.
    Cylinder {
        /// Radius [m].
        radius: f64,
        /// Half of its length [m].
        half: f64,
    },
    /// A cylinder with half balls on its ends.
    Capsule {
        /// Radius [m].
        radius: f64,
        /// Half of the distance between the balls' centres [m].
        half: f64,
    },
    /// A surface of triangles.
    Mesh(Mesh),
    /// A channel along a line, touched from inside.
    Bore(Bore),
}

/// Signed distance, its gradient (a unit vector, outwards) and its Hessian.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Distance {
    /// Signed distance [m].
    pub value: f64,
    /// Gradient.
    pub normal: Vector3<f64>,
    /// Hessian [1/m].
    pub hessian: Matrix3<f64>,
}

/// Distance to a point d away from `q`, less `radius`: the Hessian is `(E - n n^T)/|d|` in the directions of `d`'s space.
fn round(d: Vector3<f64>, space: Matrix3<f64>, radius: f64) -> Distance {
    let l = d.norm();
    let n = if l > 0.0 { d / l } else { Vector3::x() };
    let hessian = if l > 0.0 { (space - n * n.transpose()) / l } else { Matrix3::zeros() };
    Distance { value: l - radius, normal: n, hessian }
}

impl Shape {
    /// Signed distance of `q`, in the shape's frame.
    #[must_use]
    pub fn distance(&self, q: Vector3<f64>) -> Distance {
        let across = Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, 0.0));
        match *self {
            Self::Mesh(ref mesh) => mesh.distance(q),
            Self::Bore(ref bore) => bore.distance(q),
            Self::HalfSpace => {
                Distance { value: q.z, normal: Vector3::z(), hessian: Matrix3::zeros() }
            }
            Self::Ball { radius } => round(q, Matrix3::identity(), radius),
            Self::Capsule { radius, half } => {
                let beyond = q.z - q.z.clamp(-half, half);
                let space = if beyond == 0.0 { across } else { Matrix3::identity() };
                round(Vector3::new(q.x, q.y, beyond), space, radius)
            }
            Self::Box { half } => {
                let excess = Vector3::from_fn(|k, _| q[k].abs() - half[k]);
                let sign = q.map(|x| if x < 0.0 { -1.0 } else { 1.0 });
                corner(excess, |k| Vector3::ith(k, sign[k]), |_| Matrix3::zeros())
            }
            Self::Cylinder { radius, half } => {
                let flat = round(Vector3::new(q.x, q.y, 0.0), across, radius);
                let top = Vector3::new(0.0, 0.0, if q.z < 0.0 { -1.0 } else { 1.0 });
                let excess = Vector3::new(flat.value, q.z.abs() - half, f64::NEG_INFINITY);
                let bend = |k| if k == 0 { flat.hessian } else { Matrix3::zeros() };
                corner(excess, |k| if k == 0 { flat.normal } else { top }, bend)
            }
        }
    }

    /// Signed distance of `q` alone.
    #[must_use]
    pub fn value(&self, q: Vector3<f64>) -> f64 {
        match *self {
            Self::HalfSpace => q.z,
            Self::Ball { radius } => q.norm() - radius,
            Self::Capsule { radius, half } => {
                Vector3::new(q.x, q.y, q.z - q.z.clamp(-half, half)).norm() - radius
            }
            _ => self.distance(q).value,
        }
    }

    /// How far outside of its surface, less than zero for inside, the distance has its kinks: infinitely far inside a
    /// plane.
    #[must_use]
    pub fn reach(&self) -> f64 {
        match *self {
            Self::HalfSpace => f64::INFINITY,
            Self::Ball { radius } | Self::Capsule { radius, .. } => radius,
            Self::Box { .. } | Self::Cylinder { .. } | Self::Mesh(_) => 0.0,
            Self::Bore(ref bore) => bore.reach(),
        }
    }

    /// How deep inside of it its middle lies [m]: infinitely deep where it has no other side. What triangles enclose is
    /// not known; they count as a skin.
    #[must_use]
    pub fn depth(&self) -> f64 {
        match *self {
            Self::HalfSpace | Self::Bore(_) => f64::INFINITY,
            Self::Ball { radius } | Self::Capsule { radius, .. } => radius,
            Self::Cylinder { radius, half } => radius.min(half),
            Self::Box { half } => half.into_iter().fold(f64::INFINITY, f64::min),
            Self::Mesh(_) => 0.0,
        }
    }

    /// Whether it is a convex body: then the signed distance is a convex function.
    #[must_use]
    pub fn is_convex(&self) -> bool {
        match *self {
            Self::Mesh(ref mesh) => mesh.is_convex(),
            Self::Bore(_) => false,
            _ => true,
        }
    }

    /// Half of the edges of its box in its own frame; infinite for the half-space and what is around a bore.
    #[must_use]
    pub fn half_extent(&self) -> [f64; 3] {
        match *self {
            Self::HalfSpace | Self::Bore(_) => [f64::INFINITY; 3],
            Self::Ball { radius } => [radius; 3],
            Self::Box { half } => half,
            Self::Cylinder { radius, half } => [radius, radius, half],
            Self::Capsule { radius, half } => [radius, radius, half + radius],
            Self::Mesh(ref mesh) => mesh.half_extent(),
        }
    }
}

/// Distance to what lies behind several surfaces at right angles, from the signed distances, normals and Hessians of
/// each: to the highest from inside, to their edge from outside.
fn corner(
    excess: Vector3<f64>,
    normal: impl Fn(usize) -> Vector3<f64>,
    hessian: impl Fn(usize) -> Matrix3<f64>,
) -> Distance {
    let out = || (0..3).filter(|&k| excess[k] > 0.0);
    if out().count() < 2 {
        let k = excess.imax();
        return Distance { value: excess[k], normal: normal(k), hessian: hessian(k) };
    }
    let d: Vector3<f64> = out().map(|k| normal(k) * excess[k]).sum();
    let space: Matrix3<f64> = out().map(|k| normal(k) * normal(k).transpose()).sum();
    let mut distance = round(d, space, 0.0);
    for k in out() {
        distance.hessian += hessian(k) * (excess[k] / distance.value);
    }
    distance
}

/// A shape that stands somewhere.
#[derive(Clone, Debug, PartialEq)]
pub struct Placed {
    /// The shape.
    pub shape: Shape,
    /// Where its origin is [m].
    pub origin: Vector3<f64>,
    /// Its axes, one a column.
    pub axes: Matrix3<f64>,
}

impl Placed {
    /// As much of it as matters to points within `reach` of `q`, which has the same distances there.
    #[must_use]
    pub fn near(&self, q: Vector3<f64>, reach: f64) -> Cow<'_, Self> {
        match self.shape {
            Shape::Bore(ref bore) => {
                let near = bore.near(self.axes.transpose() * (q - self.origin), reach);
                Cow::Owned(Self { shape: Shape::Bore(near), origin: self.origin, axes: self.axes })
            }
            _ => Cow::Borrowed(self),
        }
    }

    /// Signed distance of a point of the world alone.
    #[must_use]
    pub fn value(&self, q: Vector3<f64>) -> f64 {
        self.shape.value(self.axes.transpose() * (q - self.origin))
    }

    /// Signed distance of a point of the world and its gradient.
    #[must_use]
    pub fn value_and_normal(&self, q: Vector3<f64>) -> (f64, Vector3<f64>) {
        let own = self.shape.distance(self.axes.transpose() * (q - self.origin));
        (own.value, self.axes * own.normal)
    }

    /// Signed distance of a point of the world.
    #[must_use]
    pub fn distance(&self, q: Vector3<f64>) -> Distance {
        let own = self.shape.distance(self.axes.transpose() * (q - self.origin));
        Distance {
            value: own.value,
            normal: self.axes * own.normal,
            hessian: self.axes * own.hessian * self.axes.transpose(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn shapes() -> Vec<Shape> {
        vec![
            Shape::HalfSpace,
            Shape::Ball { radius: 0.4 },
            Shape::Box { half: [0.3, 0.5, 0.2] },
            Shape::Cylinder { radius: 0.3, half: 0.4 },
            Shape::Capsule { radius: 0.25, half: 0.3 },
            Shape::Bore(crate::bore::tests::quarter().0),
        ]
    }

    proptest! {
        #[test]
        fn gradient_and_hessian_are_those_of_the_distance(q in prop::array::uniform3(-1.0..1.0_f64)) {
            let q = Vector3::from(q);
            for shape in shapes() {
                let here = shape.distance(q);
                prop_assert!((here.normal.norm() - 1.0).abs() < 1e-12);
                let e = 1e-5;
                for k in 0..3 {
                    let step = Vector3::ith(k, e);
                    let (up, down) = (shape.distance(q + step), shape.distance(q - step));
                    // Kinks inside are where the nearest surface changes.
                    if (up.normal - down.normal).norm() > 1e-2 {
                        continue;
                    }
                    let slope = (up.value - down.value) / (2.0 * e);
                    // Second differences of distances of order one: e^2 over the least radius cubed.
                    prop_assert!((slope - here.normal[k]).abs() < 1e-5, "{shape:?} {q}");
                    let bend = (up.normal - down.normal) / (2.0 * e);
                    let size = 1.0 + here.hessian.norm().powi(3);
                    if size < 1e4 {
                        prop_assert!((bend - here.hessian.column(k)).norm() < 1e-4 * size, "{shape:?} {q}");
                    }
                }
            }
        }
    }
}
