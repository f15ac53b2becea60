//! Where the nodes and faces of a surface stand.

use crate::chambers::volume::RimPoint;
use crate::document::{Arrays, row};
use crate::error::ModelError;
use crate::loads::edge_moment::EdgePoint;
use crate::point::Interpolation;
use crate::spec::{Array, SurfaceSpec};
use crate::vector::vector;
use nalgebra::Vector3;
use pliant_elements::{Chart, Jet, SurfaceKind};
use pliant_math::quadrature::GAUSS_4;
use std::ops::Range;

/// A face: its kind, its corners and where they lie in the parameters.
#[derive(Clone, Debug)]
pub struct Face {
    /// Kind of its element.
    pub kind: SurfaceKind,
    /// Nodes; triangles have three.
    pub nodes: Vec<usize>,
    /// Parameters (u, v) of the corners.
    pub chart: Chart,
}

/// Nodes and faces of one surface.
#[derive(Clone, Debug)]
pub struct SurfaceMap {
    /// Name of the body.
    pub name: String,
    /// First coordinate.
    pub first: usize,
    /// Nodal vectors at each node.
    pub vectors: usize,
    /// Number of nodes.
    pub nodes: usize,
    /// Faces: quadrilaterals, then triangles.
    pub faces: Vec<Face>,
    /// Stress-free nodal vectors, node by node.
    pub reference: Vec<[f64; 3]>,
    /// Typical size of an element [m].
    pub size: f64,
}

/// Kinds of quadrilaterals and triangles with so many vectors at a node.
fn kinds(vectors: usize) -> Option<(SurfaceKind, Option<SurfaceKind>)> {
    Some(match vectors {
        4 => (SurfaceKind::Bicubic, None),
        3 => (SurfaceKind::Plate, Some(SurfaceKind::Triangle)),
        2 => (SurfaceKind::Cylindrical, None),
        1 => (SurfaceKind::QuadMembrane, Some(SurfaceKind::TriangleMembrane)),
        _ => return None,
    })
}

impl SurfaceMap {
    /// Reads the mesh of a surface whose coordinates begin at `first`.
    ///
    /// # Errors
    /// [`ModelError`] naming the array that does not fit.
    pub fn new(spec: &SurfaceSpec, arrays: Arrays<'_>, first: usize) -> Result<Self, ModelError> {
        let place = |what: &str| format!("surface '{}', {what}", spec.name);
        let refuse = |what: &str, value: f64, allowed| {
            Err(ModelError::Value { place: place(what), value, allowed })
        };
        let Some((quad, triangle)) = kinds(spec.vectors) else {
            return refuse("vectors", spec.vectors as f64, "1 to 4 nodal vectors at a node");
        };
        let reference = arrays.get(&spec.reference, &place("reference"))?;
        let nodes = reference.len() / (3 * spec.vectors);
        if nodes == 0 || reference.len() != 3 * spec.vectors * nodes {
            return refuse("reference", reference.len() as f64, "nodes, vectors, 3");
        }
        let corners = |array: &Array,
                       n: usize,
                       what: &str|
         -> Result<Vec<Vec<usize>>, ModelError> {
            let flat = arrays.whole(array, &place(what))?;
            if let Some(&node) = flat.iter().find(|&&node| node >= nodes) {
                return Err(ModelError::Reference {
                    place: place(what),
                    kind: "node",
                    index: node,
                    count: nodes,
                });
            }
            if flat.len() % n != 0 {
                let expected = format!("{n} for each face");
                return Err(ModelError::Length { place: place(what), expected, got: flat.len() });
            }
            Ok(flat.chunks_exact(n).map(<[usize]>::to_vec).collect())
        };
        let quads = corners(&spec.quads, 4, "quads")?;
        let triangles = corners(&spec.triangles, 3, "triangles")?;
        let bends = quad.bends();
        let charted = |n: usize| if bends { n } else { 0 };
        let sizes =
            arrays.sized(&spec.quad_sizes, &[charted(2 * quads.len())], &place("quad_sizes"))?;
        let charts = arrays.sized(
            &spec.triangle_charts,
            &[charted(6 * triangles.len())],
            &place("triangle_charts"),
        )?;
        if sizes.iter().any(|&h| h <= 0.0) {
            return refuse("quad_sizes", 0.0, "sizes above zero");
        }
        let mut faces = Vec::with_capacity(quads.len() + triangles.len());
        let unit = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        for (k, nodes) in quads.into_iter().enumerate() {
            let [a, b] = if bends { [sizes[2 * k], sizes[2 * k + 1]] } else { [1.0, 1.0] };
            let corners = unit.map(|[x, y]| [a * x, b * y]);
            faces.push(Face { kind: quad, nodes, chart: corners.into() });
        }
        for (k, nodes) in triangles.into_iter().enumerate() {
            let Some(kind) = triangle else {
                return refuse("triangles", k as f64, "no triangles among elements of this kind");
            };
            let mut corners = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [0.0, 0.0]];
            if bends {
                for (c, corner) in corners.iter_mut().enumerate().take(3) {
                    *corner = [charts[6 * k + 2 * c], charts[6 * k + 2 * c + 1]];
                }
            }
            faces.push(Face { kind, nodes, chart: corners.into() });
        }
        let own: usize = faces.iter().map(|face| 4 * face.nodes.len()).sum();
        let turns = arrays.sized(&spec.turns, &[0, own], &place("turns"))?;
        if !turns.is_empty() {
            if spec.vectors != 3 {
                return refuse("turns", spec.vectors as f64, "3 nodal vectors at a node");
            }
            let mut rows = turns.chunks_exact(4).map(|t| [[t[0], t[1]], [t[2], t[3]]]);
            for face in &mut faces {
                let mut own = [[[1.0, 0.0], [0.0, 1.0]]; 4];
                for (to, turn) in own.iter_mut().take(face.nodes.len()).zip(&mut rows) {
                    *to = turn;
                }
                face.chart.turns = Some(own);
            }
        }
        if faces.is_empty() {
            return refuse("faces", 0.0, "at least one face");
        }
        let reference: Vec<[f64; 3]> =
            (0..nodes * spec.vectors).map(|i| row(reference, i)).collect();
        let mut map = Self {
            name: spec.name.clone(),
            first,
            vectors: spec.vectors,
            nodes,
            faces,
            reference,
            size: 0.0,
        };
        let edge = |face: &Face| {
            let at = |c: usize| vector(map.reference[map.vectors * face.nodes[c]]);
            (at(1) - at(0)).norm()
        };
        map.size = map.faces.iter().map(edge).sum::<f64>() / map.faces.len() as f64;
        Ok(map)
    }

    /// Number of coordinates.
    #[must_use]
    pub fn coordinates(&self) -> usize {
        3 * self.vectors * self.nodes
    }

    /// Its coordinates.
    #[must_use]
    pub fn range(&self) -> Range<usize> {
        self.first..self.first + self.coordinates()
    }

    /// First coordinate of a nodal vector.
    #[must_use]
    pub fn offset(&self, node: usize, vector: usize) -> usize {
        self.first + 3 * (node * self.vectors + vector)
    }

    /// First coordinates of the nodes of a face.
    pub fn groups(&self, face: usize) -> impl Iterator<Item = usize> + '_ {
        self.faces[face].nodes.iter().map(|&node| self.offset(node, 0))
    }

    /// First coordinates of the nodal vectors of a face.
    #[must_use]
    pub fn vectors_of(&self, face: &Face) -> Vec<usize> {
        face.nodes
            .iter()
            .flat_map(|&node| (0..self.vectors).map(move |s| self.offset(node, s)))
            .collect()
    }

    /// Stress-free nodal vectors of a face.
    #[must_use]
    pub fn reference_of(&self, face: &Face) -> Vec<[f64; 3]> {
        let of = |node: usize| self.reference[self.vectors * node..][..self.vectors].iter();
        face.nodes.iter().flat_map(|&node| of(node).copied()).collect()
    }

    /// Sum of nodal vectors with a part of the shape functions as weights.
    fn sum(&self, face: &Face, jets: &[Jet], part: impl Fn(&Jet) -> f64) -> Interpolation {
        Interpolation::weighted(self.vectors_of(face).into_iter().zip(jets.iter().map(part)))
    }

    /// Position and the two tangents by the parameters at a place of a face.
    #[must_use]
    pub fn point(&self, face: usize, at: [f64; 2]) -> [Interpolation; 3] {
        let face = &self.faces[face];
        let jets = face.kind.shape(&face.chart, at);
        [
            self.sum(face, &jets, |j| j.value),
            self.sum(face, &jets, |j| j.u),
            self.sum(face, &jets, |j| j.v),
        ]
    }

    /// Sets the typical sizes of increments: slopes of order 1, twists 1 over the size of an element.
    pub fn add_scale(&self, scale: &mut [f64]) {
        for node in 0..self.nodes {
            for s in 1..self.vectors {
                let at = self.offset(node, s);
                scale[at..at + 3].fill(if s < 3 { 1.0 } else { 1.0 / self.size });
            }
        }
    }

    /// Rows (face, side) of a document.
    ///
    /// # Errors
    /// [`ModelError`] naming what does not exist.
    pub fn sides(
        &self,
        arrays: Arrays<'_>,
        sides: &Array,
        place: &str,
    ) -> Result<Vec<[usize; 2]>, ModelError> {
        let flat = arrays.whole(sides, place)?;
        let pairs: Vec<[usize; 2]> = flat.chunks_exact(2).map(|pair| [pair[0], pair[1]]).collect();
        let reference = |kind, index, count| {
            Err(ModelError::Reference { place: place.to_owned(), kind, index, count })
        };
        for &[face, side] in &pairs {
            if face >= self.faces.len() {
                return reference("face", face, self.faces.len());
            }
            let corners = self.faces[face].kind.corners();
            if side >= corners {
                return reference("side", side, corners);
            }
        }
        Ok(pairs)
    }

    /// Calls `work` at the points of a rule along sides: the face, its shape functions, the direction of the side in
    /// the parameters, the side's derivative of the reference position, the weight and the place on the side.
    fn along(
        &self,
        sides: &[[usize; 2]],
        mut work: impl FnMut(&Face, &[Jet], [f64; 2], Vector3<f64>, [f64; 2], usize),
    ) {
        for &[face, side] in sides {
            let face = &self.faces[face];
            let n = face.kind.corners();
            let places = corner_places(n);
            let next = (side + 1) % n;
            let corners = &face.chart.corners;
            let direction = [0, 1].map(|c| corners[next][c] - corners[side][c]);
            let reference = self.reference_of(face);
            for (t, weight) in GAUSS_4.pairs() {
                let at = [0, 1].map(|c| (1.0 - t) * places[side][c] + t * places[next][c]);
                let jets = face.kind.shape(&face.chart, at);
                let speed = jets
                    .iter()
                    .zip(&reference)
                    .map(|(j, &x)| vector(x) * (direction[0] * j.u + direction[1] * j.v));
                work(face, &jets, direction, speed.sum(), [weight, t], side);
            }
        }
    }

    /// Integral of the position along sides, by stress-free length.
    #[must_use]
    pub fn edge_weights(&self, sides: &[[usize; 2]]) -> Interpolation {
        let mut total = vec![0.0; self.nodes * self.vectors];
        self.along(sides, |face, jets, _, speed, [weight, _], _| {
            for (&offset, jet) in self.vectors_of(face).iter().zip(jets) {
                total[(offset - self.first) / 3] += weight * speed.norm() * jet.value;
            }
        });
        let terms = total.into_iter().enumerate();
        Interpolation::weighted(terms.map(|(i, w)| (self.first + 3 * i, w)))
    }

    /// Points of a rule along sides, for moments; `q` is the start.
    ///
    /// Slopes across the sides of plates agree at nodes only. What they have beyond a line from node to node cancels
    /// in each element with that of the opposite side as long as the moments inside are constant, so a moment on the
    /// edge must not see it either.
    #[must_use]
    pub fn edge_points(&self, sides: &[[usize; 2]], q: &[f64]) -> Vec<EdgePoint> {
        let mut points = Vec::new();
        self.along(sides, |face, jets, direction, speed, [weight, t], side| {
            // The slope normal to the side in the parameters; what it has along the side does not count.
            let normal = [-direction[1], direction[0]];
            let slope = |j: &Jet| normal[0] * j.u + normal[1] * j.v;
            let across = if face.kind == SurfaceKind::Plate {
                let places = corner_places(4);
                let [start, end] = [side, (side + 1) % 4]
                    .map(|corner| face.kind.shape(&face.chart, places[corner]));
                let both = start.iter().zip(&end);
                let weights = both.map(|(a, b)| (1.0 - t) * slope(a) + t * slope(b));
                Interpolation::weighted(self.vectors_of(face).into_iter().zip(weights))
            } else {
                self.sum(face, jets, slope)
            };
            let here = self.sum(face, jets, |j| direction[0] * j.u + direction[1] * j.v);
            let tangent = vector(here.at(q));
            if let Some(direction) = tangent.try_normalize(0.0) {
                let length = weight * speed.norm();
                points.push(EdgePoint { across, direction: direction.into(), length });
            }
        });
        points
    }

    /// Points of a rule along a side, with the derivative of the position by the side's parameter.
    #[must_use]
    pub fn rim_points(&self, side: [usize; 2]) -> Vec<RimPoint> {
        let mut points = Vec::new();
        self.along(&[side], |face, jets, direction, _, [weight, _], _| {
            let r = self.sum(face, jets, |j| j.value);
            let d = self.sum(face, jets, |j| direction[0] * j.u + direction[1] * j.v);
            points.push(RimPoint { r, d, weight });
        });
        points
    }

    /// Name of a coordinate for messages.
    #[must_use]
    pub fn describe(&self, coordinate: usize) -> String {
        let local = coordinate - self.first;
        let (node, vector) = (local / 3 / self.vectors, local / 3 % self.vectors);
        let what = ["position", "slope along u", "slope along v", "twist"][vector];
        let c = ["x", "y", "z"][local % 3];
        format!("surface '{}', node {node}, {what} {c}", self.name)
    }
}

/// Where the corners of a face with so many lie in its own parameters.
fn corner_places(corners: usize) -> &'static [[f64; 2]] {
    if corners == 3 {
        &[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]
    } else {
        &[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]
    }
}
