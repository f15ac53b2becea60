//! Where every node stands in the coordinates.
//!
//! Cables come first, node by node: position and slope (6), or the slope alone (3) where the position is a shared
//! point's; the shared points follow (3 each), the rigid bodies, centre and axes (12), the arc lengths of sliding joints,
//! then the surfaces, node by node, and the beams, node by node. Multipliers are numbered after all coordinates, joint by joint.

use crate::beam_map::{BeamMap, NODE};
use crate::document::Arrays;
use crate::error::ModelError;
use crate::joints::side::Frame;
use crate::point::Interpolation;
use crate::spec::{CableSpec, JointSpec, ModelSpec, PointSpec};
use crate::surface_map::SurfaceMap;
use pliant_dae::structure::Structure;
use pliant_elements::NodeOffsets;
use pliant_math::hermite;
use std::ops::Range;

/// Nodes of one cable.
#[derive(Clone, Debug)]
pub struct CableMap {
    /// Name of the body.
    pub name: String,
    /// Offsets of each node's position and slope.
    pub nodes: Vec<NodeOffsets>,
    /// Elements of each strand, counted through the cable. Strand k's element e joins nodes e + k and e + k + 1.
    pub strands: Vec<Range<usize>>,
    /// Stress-free length of each element [m].
    pub lengths: Vec<f64>,
}

impl CableMap {
    /// First of the two nodes of element `e`.
    #[must_use]
    pub fn first_node(&self, e: usize) -> usize {
        e + self.strands.partition_point(|s| s.end <= e)
    }

    /// Nodes of a strand.
    #[must_use]
    pub fn strand_nodes(&self, strand: usize) -> Range<usize> {
        let elements = &self.strands[strand];
        elements.start + strand..elements.end + strand + 1
    }

    /// Number of elements.
    #[must_use]
    pub fn elements(&self) -> usize {
        self.lengths.len()
    }

    /// Offsets of position and slope of both nodes of element `e`.
    #[must_use]
    pub fn offsets(&self, e: usize) -> [usize; 4] {
        let node = self.first_node(e);
        let (a, b) = (self.nodes[node], self.nodes[node + 1]);
        [a.r, a.t, b.r, b.t].map(|o| o as usize)
    }

    fn hermite(&self, e: usize, weights: [f64; 4]) -> Interpolation {
        Interpolation::weighted(self.offsets(e).into_iter().zip(weights))
    }

    /// Position at `xi` of element `e`.
    #[must_use]
    pub fn position(&self, e: usize, xi: f64) -> Interpolation {
        self.hermite(e, hermite::shape(xi, self.lengths[e]))
    }

    /// Tangent dr/ds there.
    #[must_use]
    pub fn tangent(&self, e: usize, xi: f64) -> Interpolation {
        self.hermite(e, hermite::shape_derivative(xi, self.lengths[e]))
    }
}

/// Places of all bodies.
#[derive(Clone, Debug)]
pub struct DofMap {
    /// Cables.
    pub cables: Vec<CableMap>,
    /// Shells and membranes.
    pub surfaces: Vec<SurfaceMap>,
    /// Beams.
    pub beams: Vec<BeamMap>,
    /// Offsets of the shared points.
    pub shared: Vec<usize>,
    /// Names of the rigid bodies.
    pub rigid_names: Vec<String>,
    /// Offsets of the centres of the rigid bodies; the axes follow.
    pub rigid: Vec<usize>,
    /// Offsets of the arc lengths of joints that slide along cables.
    pub slides: Vec<usize>,
    /// Number of coordinates.
    pub coordinates: usize,
    /// Number of the group of each coordinate, as entered by [`Self::add_groups`].
    pub group: Vec<usize>,
}

impl DofMap {
    /// Lays out the coordinates of a document.
    ///
    /// # Errors
    /// [`ModelError`] for strands, lengths or shared points that do not fit.
    pub fn new(spec: &ModelSpec, arrays: Arrays<'_>, shared: usize) -> Result<Self, ModelError> {
        let mut cables = Vec::with_capacity(spec.cables.len());
        let mut users: Vec<(usize, usize, u32)> = Vec::new();
        for (c, cable) in spec.cables.iter().enumerate() {
            let map = cable_map(cable, arrays)?;
            let place = format!("cable '{}', shared", cable.name);
            let pairs = arrays.whole(&cable.shared, &place)?;
            if pairs.len() % 2 == 1 {
                return Err(ModelError::Length {
                    place,
                    expected: "pairs (node, shared point)".to_owned(),
                    got: pairs.len(),
                });
            }
            for pair in pairs.chunks_exact(2) {
                let reference = |kind, index, count| {
                    Err(ModelError::Reference { place: place.clone(), kind, index, count })
                };
                if pair[0] >= map.nodes.len() {
                    return reference("node", pair[0], map.nodes.len());
                }
                if pair[1] >= shared {
                    return reference("shared point", pair[1], shared);
                }
                users.push((c, pair[0], pair[1] as u32));
            }
            cables.push(map);
        }
        let mut is_shared: Vec<Vec<Option<u32>>> =
            cables.iter().map(|c: &CableMap| vec![None; c.nodes.len()]).collect();
        for &(c, node, point) in &users {
            is_shared[c][node] = Some(point);
        }
        let mut next = 0;
        for (cable, is_shared) in cables.iter_mut().zip(&is_shared) {
            for (node, shared) in cable.nodes.iter_mut().zip(is_shared) {
                if shared.is_none() {
                    node.r = next as u32;
                    next += 3;
                }
                node.t = next as u32;
                next += 3;
            }
        }
        let offsets: Vec<usize> = (0..shared).map(|p| next + 3 * p).collect();
        for (cable, is_shared) in cables.iter_mut().zip(&is_shared) {
            for (node, shared) in cable.nodes.iter_mut().zip(is_shared) {
                if let Some(point) = shared {
                    node.r = offsets[*point as usize] as u32;
                }
            }
        }
        let rigid_names: Vec<String> =
            spec.rigid_bodies.iter().map(|body| body.name.clone()).collect();
        let first = next + 3 * shared;
        let rigid: Vec<usize> = (0..rigid_names.len()).map(|k| first + 12 * k).collect();
        let first = first + 12 * rigid.len();
        let slides =
            spec.joints.iter().filter(|j| matches!(j, JointSpec::SlideCable { .. })).count();
        let slides: Vec<usize> = (first..first + slides).collect();
        let mut coordinates = first + slides.len();
        let mut surfaces = Vec::with_capacity(spec.surfaces.len());
        for surface in &spec.surfaces {
            let map = SurfaceMap::new(surface, arrays, coordinates)?;
            coordinates += map.coordinates();
            surfaces.push(map);
        }
        let mut beams = Vec::with_capacity(spec.beams.len());
        for beam in &spec.beams {
            let map = BeamMap::new(beam, arrays, coordinates)?;
            coordinates = map.range().end;
            beams.push(map);
        }
        Ok(Self {
            cables,
            surfaces,
            beams,
            shared: offsets,
            rigid_names,
            rigid,
            slides,
            coordinates,
            group: Vec::new(),
        })
    }

    /// Enters the groups of unknowns of all nodes and shared points.
    pub fn add_groups(&mut self, structure: &mut Structure) {
        self.group = vec![0; self.coordinates];
        let mut add = |range: Range<usize>, group: &mut Vec<usize>| {
            group[range.clone()].fill(structure.add_group(range));
        };
        for cable in &self.cables {
            for node in &cable.nodes {
                let t = node.t as usize;
                let first = if node.r + 3 == node.t { node.r as usize } else { t };
                add(first..t + 3, &mut self.group);
            }
        }
        for &p in &self.shared {
            add(p..p + 3, &mut self.group);
        }
        for &p in &self.rigid {
            add(p..p + 12, &mut self.group);
        }
        for &s in &self.slides {
            add(s..s + 1, &mut self.group);
        }
        for surface in &self.surfaces {
            for node in 0..surface.nodes {
                let first = surface.offset(node, 0);
                add(first..first + 3 * surface.vectors, &mut self.group);
            }
        }
        for beam in &self.beams {
            for node in 0..beam.nodes() {
                let first = beam.offset(node, 0);
                add(first..first + NODE, &mut self.group);
            }
        }
    }

    /// A surface by its number.
    ///
    /// # Errors
    /// [`ModelError`] naming `place` where there is none.
    pub fn surface(&self, number: usize, place: &str) -> Result<&SurfaceMap, ModelError> {
        self.surfaces.get(number).ok_or_else(|| ModelError::Reference {
            place: place.to_owned(),
            kind: "surface",
            index: number,
            count: self.surfaces.len(),
        })
    }

    /// A beam by its number.
    ///
    /// # Errors
    /// [`ModelError`] naming `place` where there is none.
    pub fn beam(&self, number: usize, place: &str) -> Result<&BeamMap, ModelError> {
        self.beams.get(number).ok_or_else(|| ModelError::Reference {
            place: place.to_owned(),
            kind: "beam",
            index: number,
            count: self.beams.len(),
        })
    }

    /// Groups of the given coordinates' offsets, each once, in order of appearance.
    #[must_use]
    pub fn groups_of(&self, offsets: impl IntoIterator<Item = usize>) -> Vec<usize> {
        let mut groups = Vec::new();
        for offset in offsets {
            let group = self.group[offset];
            if !groups.contains(&group) {
                groups.push(group);
            }
        }
        groups
    }

    /// The axes of a rigid body.
    #[must_use]
    pub fn axes(&self, body: usize) -> [Interpolation; 3] {
        let first = self.rigid[body];
        [3, 6, 9].map(|k| Interpolation::weighted([(first + k, 1.0)]))
    }

    /// Position of a point and what turns there.
    ///
    /// # Errors
    /// [`ModelError`] naming `place` where the point does not exist.
    pub fn point(
        &self,
        point: &PointSpec,
        place: &str,
    ) -> Result<(Interpolation, Frame), ModelError> {
        let reference = |kind, index, count| ModelError::Reference {
            place: place.to_owned(),
            kind,
            index,
            count,
        };
        match *point {
            PointSpec::World { world } => Ok((Interpolation::fixed(world), Frame::World)),
            PointSpec::Shared { shared } => {
                let count = self.shared.len();
                let offset = self
                    .shared
                    .get(shared)
                    .ok_or_else(|| reference("shared point", shared, count))?;
                Ok((Interpolation::weighted([(*offset, 1.0)]), Frame::Point))
            }
            PointSpec::Rigid { rigid, local } => {
                let count = self.rigid.len();
                let first =
                    *self.rigid.get(rigid).ok_or_else(|| reference("rigid body", rigid, count))?;
                let terms = [0, 1, 2].map(|k| (first + 3 + 3 * k, local[k]));
                let terms = std::iter::once((first, 1.0)).chain(terms);
                Ok((Interpolation::weighted(terms), Frame::Body(self.axes(rigid))))
            }
            PointSpec::Surface { surface, face, at } => {
                let count = self.surfaces.len();
                let map = self
                    .surfaces
                    .get(surface)
                    .ok_or_else(|| reference("surface", surface, count))?;
                if face >= map.faces.len() {
                    return Err(reference("face", face, map.faces.len()));
                }
                if let Some(&value) = at.iter().find(|x| !(0.0..=1.0).contains(*x)) {
                    return Err(ModelError::Value {
                        place: place.to_owned(),
                        value,
                        allowed: "places in a face, from 0 to 1",
                    });
                }
                let [r, a, b] = map.point(face, at);
                let bends = map.faces[face].kind.bends();
                Ok((r, if bends { Frame::Sheet([a, b]) } else { Frame::Point }))
            }
            PointSpec::Beam { beam, element, xi, offset } => {
                let map = self.beam(beam, place)?;
                if element >= map.elements() {
                    return Err(reference("element", element, map.elements()));
                }
                let allowed = "xi from 0 to 1, and finite offsets";
                let wrong = |value| ModelError::Value { place: place.to_owned(), value, allowed };
                if !(0.0..=1.0).contains(&xi) {
                    return Err(wrong(xi));
                }
                if let Some(&value) = offset.iter().find(|x| !x.is_finite()) {
                    return Err(wrong(value));
                }
                let r = map.point(element, xi, offset);
                Ok((r, Frame::Section(map.section(element, xi))))
            }
            PointSpec::Cable { cable, element, xi } => {
                let count = self.cables.len();
                let map = self.cables.get(cable).ok_or_else(|| reference("cable", cable, count))?;
                if element >= map.elements() {
                    return Err(reference("element", element, map.elements()));
                }
                if !(0.0..=1.0).contains(&xi) {
                    return Err(ModelError::Value {
                        place: place.to_owned(),
                        value: xi,
                        allowed: "xi from 0 to 1",
                    });
                }
                Ok((map.position(element, xi), Frame::Line(map.tangent(element, xi))))
            }
        }
    }

    /// Name of a coordinate for messages.
    #[must_use]
    pub fn describe(&self, coordinate: usize) -> String {
        let component = |offset: usize| ["x", "y", "z"][(coordinate - offset).min(2)];
        for cable in &self.cables {
            for (i, node) in cable.nodes.iter().enumerate() {
                for (offset, what) in [(node.r as usize, "position"), (node.t as usize, "slope")] {
                    if (offset..offset + 3).contains(&coordinate) {
                        let c = component(offset);
                        return format!("cable '{}', node {i}, {what} {c}", cable.name);
                    }
                }
            }
        }
        if let Some(k) = self.slides.iter().position(|&s| s == coordinate) {
            return format!("place along the cable of sliding joint {k}");
        }
        if let Some(surface) = self.surfaces.iter().find(|s| s.range().contains(&coordinate)) {
            return surface.describe(coordinate);
        }
        if let Some(beam) = self.beams.iter().find(|b| b.range().contains(&coordinate)) {
            return beam.describe(coordinate);
        }
        if let Some(k) = self.rigid.iter().rposition(|&first| first <= coordinate) {
            let (place, c) = (coordinate - self.rigid[k], component(self.rigid[k]));
            return match place / 3 {
                0 => format!("rigid body '{}', position {c}", self.rigid_names[k]),
                axis => {
                    let c = ["x", "y", "z"][place % 3];
                    format!("rigid body '{}', axis {axis}, component {c}", self.rigid_names[k])
                }
            };
        }
        match self.shared.iter().position(|&p| (p..p + 3).contains(&coordinate)) {
            Some(p) => format!("point {p}, position {}", component(self.shared[p])),
            None => format!("coordinate {coordinate}"),
        }
    }
}

/// Strands and lengths of a cable; its nodes get their places afterwards.
fn cable_map(cable: &CableSpec, arrays: Arrays<'_>) -> Result<CableMap, ModelError> {
    let place = |what: &str| format!("cable '{}', {what}", cable.name);
    let strands = arrays.whole(&cable.strands, &place("strands"))?;
    if strands.is_empty() || strands.contains(&0) {
        return Err(ModelError::Value {
            place: place("strands"),
            value: 0.0,
            allowed: "at least one strand of at least one element",
        });
    }
    let elements: usize = strands.iter().sum();
    let positive: (fn(f64) -> bool, _) = (|x| x > 0.0, "lengths are above zero");
    let lengths = arrays.checked(&cable.lengths, &[elements], &place("lengths"), positive)?;
    let mut ranges = Vec::with_capacity(strands.len());
    let mut start = 0;
    for n in strands {
        ranges.push(start..start + n);
        start += n;
    }
    let nodes = vec![NodeOffsets { r: 0, t: 0 }; elements + ranges.len()];
    Ok(CableMap { name: cable.name.clone(), nodes, strands: ranges, lengths: lengths.to_vec() })
}
