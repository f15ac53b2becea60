//! The volume of a chamber in parts: its faces, and what closes their rims.
//!
//! Faces count from a reference point o, `V = 1/3 sum (r - o).n dA` ([`pliant_elements::SurfaceBlock::volume`]). A rim is
//! closed by the cone from its apex c: `V = 1/3 (c - o).A`, `A = -1/2 sum (r - c) x dr` along the faces' sides. Its line
//! integral `b = 1/3 sum dr x (r - o)` is what the gradient of the faces' volume has beyond the pressure on the faces.
//!
//! - Held rims: the cap is part of the world, its volume constant; b is taken out, so that reactions are right.
//! - Rims in planes of symmetry: c lies in the plane, A changes; the part of b normal to the plane is taken out.
//! - Other rims: a light lid, whose apex is the middle of the rim, hands its pressure on to the rim. The force and the
//!   moment on a rigid rim do not depend on the lid's shape.

use crate::point::{Interpolation, Support};
use crate::vector::vector;
use nalgebra::{Matrix3, Vector3};
use pliant_elements::SurfaceBlock;
use std::sync::Arc;

/// A point of the rule along the sides of a rim: position, its derivative along the side, weight.
#[derive(Clone, Debug)]
pub struct RimPoint {
    /// Position.
    pub r: Interpolation,
    /// Derivative by the side's parameter in [0, 1].
    pub d: Interpolation,
    /// Weight.
    pub weight: f64,
}

/// A part of the volume.
#[derive(Clone, Debug)]
pub enum Part {
    /// A face.
    Face {
        /// Its block.
        block: Arc<SurfaceBlock>,
        /// Its number there.
        element: usize,
    },
    /// Sides of a rim that is held, and the volume that closes them [m^3].
    Held {
        /// Points along the sides.
        points: Vec<RimPoint>,
        /// The volume.
        volume: f64,
    },
    /// Sides of a rim in a plane of symmetry.
    Plane {
        /// Points along the sides.
        points: Vec<RimPoint>,
        /// Where the cone's tip is.
        apex: Vector3<f64>,
        /// Unit normal of the plane.
        normal: Vector3<f64>,
    },
    /// Sides of any other rim, closed by a lid.
    Lid {
        /// Points along the sides.
        points: Vec<RimPoint>,
        /// The apex is this matrix times the middle of the rim, plus the shift.
        projection: Matrix3<f64>,
        /// Shift of the apex.
        shift: Vector3<f64>,
    },
}

fn mean(points: &[RimPoint], of: impl Fn(&RimPoint) -> Vector3<f64>) -> Vector3<f64> {
    let total: f64 = points.iter().map(|p| p.weight).sum();
    points.iter().map(|p| of(p) * p.weight).sum::<Vector3<f64>>() / total
}

fn at(x: &Interpolation, q: &[f64]) -> Vector3<f64> {
    vector(x.at(q))
}

/// `A = -1/2 sum (r - c) x d`.
pub(crate) fn area(points: &[RimPoint], apex: Vector3<f64>, q: &[f64]) -> Vector3<f64> {
    let each = |p: &RimPoint| (at(&p.r, q) - apex).cross(&at(&p.d, q)) * (-0.5 * p.weight);
    points.iter().map(each).sum()
}

/// Adds the derivative of `k.A` at a fixed apex.
fn add_area_gradient(
    points: &[RimPoint],
    (apex, k): (Vector3<f64>, Vector3<f64>),
    q: &[f64],
    out: &mut [f64],
) {
    for p in points {
        let (r, d) = (at(&p.r, q), at(&p.d, q));
        p.r.add_force((d.cross(&k) * (-0.5 * p.weight)).into(), out);
        p.d.add_force((k.cross(&(r - apex)) * (-0.5 * p.weight)).into(), out);
    }
}

impl Part {
    /// Its volume at coordinates `q` from the point `o` [m^3].
    #[must_use]
    pub fn volume(&self, q: &[f64], o: Vector3<f64>) -> f64 {
        match self {
            Self::Face { block, element } => block.volume(*element, q, o.into()),
            Self::Held { volume, .. } => *volume,
            Self::Plane { points, apex, .. } => (apex - o).dot(&area(points, *apex, q)) / 3.0,
            Self::Lid { points, projection, shift } => {
                let apex = projection * mean(points, |p| at(&p.r, q)) + shift;
                (apex - o).dot(&area(points, apex, q)) / 3.0
            }
        }
    }

    /// Adds `factor` times the force of a unit pressure on it to `force`, over all coordinates: the derivative of the
    /// volume along every motion that keeps the rims where they are held.
    pub fn add_force(&self, q: &[f64], o: Vector3<f64>, factor: f64, force: &mut [f64]) {
        match self {
            Self::Face { block, element } => {
                let gradient = block.volume_gradient(*element, q, o.into());
                for (&offset, g) in block.vectors_of(*element).iter().zip(gradient.chunks_exact(3))
                {
                    for c in 0..3 {
                        force[offset as usize + c] += factor * g[c];
                    }
                }
            }
            Self::Held { points, .. } => {
                take_out(points, |b| b, q, o, factor, force);
            }
            Self::Plane { points, apex, normal } => {
                add_area_gradient(points, (*apex, (apex - o) * (factor / 3.0)), q, force);
                take_out(points, |b| normal * normal.dot(&b), q, o, factor, force);
            }
            Self::Lid { points, projection, shift } => {
                let apex = projection * mean(points, |p| at(&p.r, q)) + shift;
                let k = (apex - o) * (factor / 3.0);
                add_area_gradient(points, (apex, k), q, force);
                // The apex moves with the rim: dc.(A/3 + 1/2 D x k), D = sum d.
                let d: Vector3<f64> = points.iter().map(|p| at(&p.d, q) * p.weight).sum();
                let on = area(points, apex, q) * (factor / 3.0) + d.cross(&k) * 0.5;
                let on = projection.transpose() * on;
                let total: f64 = points.iter().map(|p| p.weight).sum();
                for p in points {
                    p.r.add_force((on * (p.weight / total)).into(), force);
                }
            }
        }
    }

    /// `out = factor` times the derivative of the force by the coordinates of `support`, row by row, its symmetric part:
    /// what the rest says is about motions that there are not.
    pub fn hessian(
        &self,
        q: &[f64],
        o: Vector3<f64>,
        factor: f64,
        support: &Support,
        out: &mut [f64],
    ) {
        out.fill(0.0);
        let n = support.unknowns.len();
        match self {
            Self::Face { block, element } => {
                block.add_volume_hessian(*element, q, o.into(), factor, out);
            }
            Self::Held { .. } => {}
            Self::Plane { points, apex, .. } => {
                let k = ((apex - o) * (factor / 6.0)).cross_matrix();
                for p in points {
                    let (r, d) = (support.localize(&p.r), support.localize(&p.d));
                    crate::forces::add_outer(&r, &d, &(k * p.weight), n, out);
                    crate::forces::add_outer(&d, &r, &(k * -p.weight), n, out);
                }
            }
            Self::Lid { points, projection, shift } => {
                let local = |p: &RimPoint| RimPoint {
                    r: support.localize(&p.r),
                    d: support.localize(&p.d),
                    weight: p.weight,
                };
                let points = points.iter().map(local).collect();
                let lid = Self::Lid { points, projection: *projection, shift: *shift };
                let mut x: Vec<f64> = support.unknowns.iter().map(|&u| q[u]).collect();
                // Quadratic in the coordinates: differences over any distance are exact.
                let step = x.iter().fold(0.0_f64, |m, x| m.max(x.abs())).max(f64::MIN_POSITIVE);
                let mut column = vec![0.0; n];
                for j in 0..n {
                    let here = x[j];
                    column.fill(0.0);
                    for sign in [1.0, -1.0] {
                        x[j] = here + sign * step;
                        lid.add_force(&x, o, sign * factor / (2.0 * step), &mut column);
                    }
                    x[j] = here;
                    for i in 0..n {
                        out[i * n + j] = column[i];
                    }
                }
            }
        }
    }
}

/// Takes a part of `b = 1/3 sum d x (r - o)` out of the force.
fn take_out(
    points: &[RimPoint],
    part: impl Fn(Vector3<f64>) -> Vector3<f64>,
    q: &[f64],
    o: Vector3<f64>,
    factor: f64,
    force: &mut [f64],
) {
    for p in points {
        let b = at(&p.d, q).cross(&(at(&p.r, q) - o)) / 3.0;
        p.r.add_force((part(b) * (-factor * p.weight)).into(), force);
    }
}
