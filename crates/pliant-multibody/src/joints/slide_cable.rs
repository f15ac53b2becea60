//! Sliding along a cable: a point stays on the line, `phi = P - r(s)` (3 equations), s the arc length of the
//! stress-free line, a coordinate of its own without mass.
//!
//! Jacobian: `dP/dq`, `-N_i` at the nodes of the element that holds s, `-r'` at s. The equation of s reads
//! `lambda_.r' = 0`: no friction. Hessian: `-N_i' lambda_` between the nodes and s, `-lambda_.r''` at s. Minus the
//! multiplier is the force on the point. From element to element r' is continuous, and r'' jumps as the line's does.

use super::{Draft, Joint};
use crate::dof_map::CableMap;
use crate::point::{Interpolation, Support};
use crate::signal::Moment;
use crate::vector::vector;
use nalgebra::Vector3;
use pliant_math::hermite;

/// A point slides along a cable.
#[derive(Clone, Debug)]
pub struct SlideCable {
    point: Interpolation,
    /// Offsets of position and slope of both nodes of each element.
    nodes: Vec<[usize; 4]>,
    lengths: Vec<f64>,
    /// Arc length at the start of each element.
    starts: Vec<f64>,
    /// Offset of the arc length.
    s: usize,
    spans: Vec<[Interpolation; 2]>,
    support: Support,
}

impl SlideCable {
    /// A point slides along a cable; coordinate `s` is the arc length.
    #[must_use]
    pub fn new(point: Interpolation, cable: &CableMap, s: usize) -> Self {
        let mut starts = Vec::with_capacity(cable.elements());
        let mut total = 0.0;
        for length in &cable.lengths {
            starts.push(total);
            total += length;
        }
        let spans = |e| [cable.position(e, 0.5), Interpolation::weighted([(s, 1.0)])];
        Self {
            point,
            nodes: (0..cable.elements()).map(|e| cable.offsets(e)).collect(),
            lengths: cable.lengths.clone(),
            starts,
            s,
            spans: (0..cable.elements()).map(spans).collect(),
            support: Support::default(),
        }
    }

    /// Element that holds an arc length, and the place in it.
    fn place(&self, s: f64) -> (usize, f64) {
        let e = self.starts.partition_point(|start| *start <= s).max(1) - 1;
        (e, (s - self.starts[e]) / self.lengths[e])
    }

    /// Sum of the element's nodal vectors in `x` by weights.
    fn sum(&self, e: usize, weights: [f64; 4], x: &[f64]) -> Vector3<f64> {
        let mut sum = Vector3::zeros();
        for (&offset, w) in self.nodes[e].iter().zip(weights) {
            sum += Vector3::new(x[offset], x[offset + 1], x[offset + 2]) * w;
        }
        sum
    }

    /// Shape functions at an arc length: values, first, second and third derivatives, and the element.
    fn shapes(&self, s: f64) -> (usize, [[f64; 4]; 4]) {
        let (e, xi) = self.place(s);
        let length = self.lengths[e];
        let third = [12.0 / length, 6.0, -12.0 / length, 6.0].map(|d| d / (length * length));
        let shapes = [
            hermite::shape(xi, length),
            hermite::shape_derivative(xi, length),
            hermite::shape_second_derivative(xi, length),
            third,
        ];
        (e, shapes)
    }
}

impl Draft for SlideCable {
    fn count(&self) -> usize {
        3
    }

    fn interpolations(&self) -> Vec<&Interpolation> {
        std::iter::once(&self.point).chain(self.spans.iter().flatten()).collect()
    }

    fn windows(&self) -> Vec<Vec<&Interpolation>> {
        self.spans.iter().map(|[r, s]| vec![&self.point, r, s]).collect()
    }

    fn placed(self: Box<Self>, support: Support) -> Box<dyn Joint> {
        let nodes = self.nodes.iter().map(|nodes| nodes.map(|offset| support.local(offset)));
        let placed = Self {
            point: support.localize(&self.point),
            nodes: nodes.collect(),
            s: support.local(self.s),
            spans: Vec::new(),
            support,
            lengths: self.lengths,
            starts: self.starts,
        };
        Box::new(placed)
    }
}

impl Joint for SlideCable {
    fn equations(&self) -> usize {
        3
    }

    fn support(&self) -> &Support {
        &self.support
    }

    fn scale(&self, length: f64, out: &mut [f64]) {
        out.fill(length);
    }

    fn residual(&self, _now: Moment<'_>, x: &[f64], phi: &mut [f64]) {
        let (e, shapes) = self.shapes(x[self.s]);
        let gap = vector(self.point.at(x)) - self.sum(e, shapes[0], x);
        phi.copy_from_slice(gap.as_slice());
    }

    fn jacobian(&self, _now: Moment<'_>, x: &[f64], out: &mut [f64]) {
        out.fill(0.0);
        let n = x.len();
        let (e, shapes) = self.shapes(x[self.s]);
        let tangent = self.sum(e, shapes[1], x);
        for k in 0..3 {
            let row = &mut out[k * n..(k + 1) * n];
            for &(offset, w) in &self.point.terms {
                row[offset + k] += w;
            }
            for (&offset, w) in self.nodes[e].iter().zip(shapes[0]) {
                row[offset + k] -= w;
            }
            row[self.s] -= tangent[k];
        }
    }

    fn hessian_entries(&self, x: &[f64], lambda_: &[f64], out: &mut Vec<(usize, usize, f64)>) {
        let (e, shapes) = self.shapes(x[self.s]);
        let second = self.sum(e, shapes[2], x);
        for k in 0..3 {
            for (&offset, slope) in self.nodes[e].iter().zip(shapes[1]) {
                let entry = -slope * lambda_[k];
                out.push((offset + k, self.s, entry));
                out.push((self.s, offset + k, entry));
            }
        }
        let here = -(0..3).map(|k| lambda_[k] * second[k]).sum::<f64>();
        out.push((self.s, self.s, here));
    }

    fn add_hessian(
        &self,
        _now: Moment<'_>,
        x: &[f64],
        lambda_: &[f64],
        stiffness: f64,
        out: &mut [f64],
    ) {
        let mut entries = Vec::new();
        self.hessian_entries(x, lambda_, &mut entries);
        for (i, j, entry) in entries {
            out[i * x.len() + j] += stiffness * entry;
        }
    }

    fn acceleration(&self, _now: Moment<'_>, x: &[f64], v: &[f64], out: &mut [f64]) {
        let (e, shapes) = self.shapes(x[self.s]);
        let rate = v[self.s];
        let turning = self.sum(e, shapes[1], v) * (2.0 * rate);
        let bending = self.sum(e, shapes[2], x) * (rate * rate);
        out.copy_from_slice((-turning - bending).as_slice());
    }

    fn jerk(&self, _now: Moment<'_>, x: &[f64], v: &[f64], a: &[f64], out: &mut [f64]) {
        let (e, [_, first, second, third]) = self.shapes(x[self.s]);
        let (rate, growth) = (v[self.s], a[self.s]);
        let sum = self.sum(e, first, a) * (3.0 * rate)
            + self.sum(e, first, v) * (3.0 * growth)
            + self.sum(e, second, v) * (3.0 * rate * rate)
            + self.sum(e, second, x) * (3.0 * rate * growth)
            + self.sum(e, third, x) * rate.powi(3);
        out.copy_from_slice((-sum).as_slice());
    }

    fn reaction(&self, _now: Moment<'_>, _x: &[f64], lambda_: &[f64]) -> ([f64; 3], [f64; 3]) {
        ([0, 1, 2].map(|k| -lambda_[k]), [0.0; 3])
    }

    fn motion(&self, x: &[f64], v: &[f64]) -> Option<[f64; 2]> {
        Some([x[self.s], v[self.s]])
    }

    fn window(&self, x: &[f64]) -> usize {
        self.place(x[self.s]).0
    }

    fn strayed(&self, x: &[f64]) -> Option<String> {
        let s = x[self.s];
        let total = self.starts.iter().zip(&self.lengths).fold(0.0, |m, (a, b)| f64::max(m, a + b));
        let slack = 1e-9 * total;
        if (-slack..=total + slack).contains(&s) {
            return None;
        }
        let end = if s < 0.0 { "start" } else { "end" };
        Some(format!(
            "its point has come to the {end} of the cable, arc length {s:.6} m of {total:.6} m"
        ))
    }
}
