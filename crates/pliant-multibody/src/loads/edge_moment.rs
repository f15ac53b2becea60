//! A moment per length on an edge, about the direction e that the edge has at the start.
//!
//! Of the slope c across the edge the part normal to e turns by `d theta = e.(c x dc)/|c_n|^2`, so the force on it is
//! `m (e x c)/|c_n|^2`. It derives from the angle, and its tangent `m ([e]x/|c_n|^2 - 2 (e x c) c_n^T/|c_n|^4)` is
//! symmetric. Where the edge itself turns out of its direction, the axis of the moment stays.

use super::Load;
use super::force::add_outer;
use crate::point::{Interpolation, Support};
use crate::signal::Moment;
use crate::vector::vector;
use nalgebra::Vector3;
use pliant_dae::structure::Storage;

/// A point of the rule along an edge.
#[derive(Clone, Debug)]
pub struct EdgePoint {
    /// Slope across the edge.
    pub across: Interpolation,
    /// Direction of the edge at the start, of unit length.
    pub direction: [f64; 3],
    /// Length that the point stands for [m].
    pub length: f64,
}

/// A moment per length [N].
#[derive(Clone, Debug)]
pub struct EdgeMoment {
    points: Vec<EdgePoint>,
    supports: Vec<Support>,
}

impl EdgeMoment {
    /// A moment on the points of an edge, with the support of each.
    #[must_use]
    pub fn new(points: Vec<EdgePoint>, supports: Vec<Support>) -> Self {
        Self { points, supports }
    }
}

/// `e x c`, and the part of c normal to e.
fn parts(point: &EdgePoint, q: &[f64]) -> (Vector3<f64>, Vector3<f64>) {
    let (e, c) = (vector(point.direction), vector(point.across.at(q)));
    (e.cross(&c), c - e * e.dot(&c))
}

impl Load for EdgeMoment {
    fn add_force(
        &self,
        _now: Moment<'_>,
        value: [f64; 3],
        q: &[f64],
        factor: f64,
        force: &mut [f64],
    ) {
        for point in &self.points {
            let (turned, normal) = parts(point, q);
            let f = turned * (factor * value[0] * point.length / normal.norm_squared());
            point.across.add_force(f.into(), force);
        }
    }

    fn supports(&self) -> &[Support] {
        &self.supports
    }

    fn storage(&self) -> Storage {
        Storage::Symmetric
    }

    fn has_potential(&self) -> bool {
        true
    }

    fn jacobian(&self, part: usize, value: [f64; 3], q: &[f64], factor: f64, out: &mut [f64]) {
        out.fill(0.0);
        let point = &self.points[part];
        let (turned, normal) = parts(point, q);
        let square = normal.norm_squared();
        let k = vector(point.direction).cross_matrix() / square
            - turned * normal.transpose() * (2.0 / (square * square));
        let k = k * (factor * value[0] * point.length);
        add_outer(&self.supports[part], &point.across, &point.across, &k, out);
    }
}
