//! Contact of everything but lines with lines: points of one side, probes, face the distance function of the other.
//!
//! | side | its probes | its distance function |
//! | --- | --- | --- |
//! | shell, membrane | points of a rule on each face, on its corners and edges, too | none |
//! | cable, beam | fitted to the zones where it is inside the other | none here |
//! | ball, mass | the centre | exact |
//! | capsule | zones of its axis | exact |
//! | box, cylinder | corners; on each rim the points that lie lowest and across | exact; between two of them, parry's points |
//! | half-space | none | exact |
//! | triangle mesh | its vertices | nearest point |
//!
//! Before a surface they face its mid-surface ([`onto`]): cables, masses, corners, and of two surfaces the points of each
//! the faces of the other, with half of their areas.
//!
//! [`find`] says what touches at given coordinates, [`act`] what follows from it: forces, tangents, energy, memory.

pub mod act;
pub mod couple;
pub mod find;
pub mod memory;
mod onto;
mod sheet;
mod skin;
pub mod spec;

use crate::contact_coupling::lines::{line_of, mass_per_length};
use crate::contact_coupling::{Segment, laws_of};
use crate::document::Arrays;
use crate::dof_map::DofMap;
use crate::error::ModelError;
use crate::spec::ModelSpec;
use nalgebra::{Matrix3, Vector3};
use pliant_contact::friction::Friction;
use pliant_contact::manifolds::has_faces;
use pliant_contact::point::Laws;
use pliant_contact::probe::Pose;
use pliant_contact::shapes::Shape;
use pliant_dae::structure::{Storage, Structure};
use sheet::Face;
use skin::Skin;
use spec::{ProbeContactSpec, SideSpec, shape_of};
use std::collections::HashMap;

/// A side of a contact.
#[derive(Clone, Debug)]
pub(crate) enum Side {
    /// Faces of a shell or membrane.
    Sheet(Vec<Face>),
    /// A rigid body: its first coordinate, and its shape.
    Rigid(usize, Shape),
    /// A mass: weights of coordinates, and its radius.
    Mass(Vec<(usize, f64)>, f64),
    /// Elements of a cable or a beam.
    Line(Vec<Segment>),
    /// A shape at rest.
    Rest(Pose, Shape),
}

impl Side {
    /// Its shape and where that is at coordinates `q`.
    pub(crate) fn shape(&self, q: &[f64]) -> Option<(Pose, &Shape)> {
        match self {
            Self::Rigid(first, shape) => Some((pose_of(*first, q), shape)),
            Self::Rest(pose, shape) => Some((*pose, shape)),
            _ => None,
        }
    }

    fn moves(&self) -> bool {
        !matches!(self, Self::Rest(..))
    }

    /// How deep inside of it its middle lies [m].
    fn depth(&self) -> f64 {
        match self {
            Self::Sheet(faces) => faces.iter().map(|f| f.radius).fold(f64::INFINITY, f64::min),
            Self::Line(line) => line.iter().map(|s| s.radius).fold(f64::INFINITY, f64::min),
            Self::Mass(_, radius) => *radius,
            Self::Rigid(_, shape) | Self::Rest(_, shape) => shape.depth(),
        }
    }

    /// Coordinates of the vectors of each part: a face, an element, or the whole.
    fn parts(&self) -> Vec<Vec<usize>> {
        match self {
            Self::Sheet(faces) => faces.iter().map(|face| face.offsets.clone()).collect(),
            Self::Rigid(first, _) => vec![vectors_of(*first).to_vec()],
            Self::Mass(terms, _) => vec![terms.iter().map(|&(offset, _)| offset).collect()],
            Self::Line(line) => line.iter().map(|segment| segment.offsets.to_vec()).collect(),
            Self::Rest(..) => vec![Vec::new()],
        }
    }
}

/// Offsets of centre and axes of a rigid body.
pub(crate) fn vectors_of(first: usize) -> [usize; 4] {
    [0, 3, 6, 9].map(|k| first + k)
}

/// Where a rigid body is.
pub(crate) fn pose_of(first: usize, q: &[f64]) -> Pose {
    let [r, a, b, c] = vectors_of(first).map(|o| Vector3::new(q[o], q[o + 1], q[o + 2]));
    Pose { origin: r, axes: Matrix3::from_columns(&[a, b, c]) }
}

/// The element matrix of a part of a slave before its master.
#[derive(Clone, Debug)]
pub(crate) struct Placed {
    pub base: usize,
    pub size: usize,
    pub storage: Storage,
    /// Places of the slave's vectors in it.
    pub slave: Vec<usize>,
    /// Places of the master's.
    pub master: [usize; 4],
}

/// One way in which two sides face each other.
#[derive(Clone, Debug)]
pub(crate) struct Facing {
    /// Number of the contact.
    pub contact: usize,
    pub slave: Side,
    pub master: Side,
    /// 1 where the slave is the contact's first side, -1 where it is the second.
    pub sign: f64,
    /// Whether both have flat faces, whose points come in pairs.
    pub meet: bool,
    /// One for each part of the slave; none before a surface, whose couples follow what touches.
    pub placed: Vec<Placed>,
    /// The master's number among the skins where it is a surface, and the slave's.
    pub skin: Option<usize>,
    pub own_skin: Option<usize>,
    /// Part of each probe that counts: a half where both sides have some.
    pub share: f64,
    /// Largest sum of the slave's radius and half of the surface's thickness, typical size of a face [m].
    pub reach: f64,
    pub size: f64,
    /// Of a surface that touches itself.
    pub own: Option<Own>,
    /// Places on the stress-free surface around which nothing touches, for a joint is there, and how far [m].
    pub apart: Vec<(Vector3<f64>, f64)>,
}

/// What lies too near on one surface to touch.
#[derive(Clone, Debug)]
pub(crate) struct Own {
    /// Distance on the stress-free surface below which points of neighbours do not touch [m].
    pub width: f64,
    /// Faces that begin nearer than that to each face along the surface, sorted.
    pub near: Vec<Vec<usize>>,
}

impl Own {
    fn of(skin: &Skin, width: f64) -> Self {
        let beside = skin.neighbours();
        let boxes = &skin.reference.boxes;
        let near = |face: usize| {
            let mut all = vec![face];
            let mut next = 0;
            while let Some(&at) = all.get(next) {
                next += 1;
                for &other in &beside[at] {
                    let gap = (0..3).map(|k| {
                        let (a, b) = (&boxes[face], &boxes[other]);
                        (a.low[k] - b.high[k]).max(b.low[k] - a.high[k])
                    });
                    if gap.fold(f64::NEG_INFINITY, f64::max) < width && !all.contains(&other) {
                        all.push(other);
                    }
                }
            }
            all.sort_unstable();
            all
        };
        Self { width, near: (0..beside.len()).map(near).collect() }
    }
}

/// A contact.
#[derive(Clone, Debug)]
pub(crate) struct Contact {
    /// Name for messages.
    pub name: String,
    pub laws: Laws,
    /// Length by which its bristles and zones are measured [m].
    pub size: f64,
}

/// All contacts of this kind.
#[derive(Clone, Debug, Default)]
pub struct Probes {
    pub(crate) contacts: Vec<Contact>,
    pub(crate) facings: Vec<Facing>,
    /// Surfaces that probes touch.
    pub(crate) skins: Vec<Skin>,
    /// Highest angular frequency of a body on its contact [1/s].
    pub(crate) frequency: f64,
    /// Largest radius, or penetration that counts as small [m].
    pub(crate) radius: f64,
}

impl Probes {
    /// Reads the contacts of a document, and adds their element matrices to the structure.
    ///
    /// # Errors
    /// [`ModelError`] naming the contact that is wrong.
    pub(crate) fn of_spec(
        spec: &ModelSpec,
        arrays: Arrays<'_>,
        map: &DofMap,
        structure: &mut Structure,
    ) -> Result<Self, ModelError> {
        let mut this = Self::default();
        let mut numbers = HashMap::new();
        for (number, contact) in spec.probe_contacts.iter().enumerate() {
            let place = format!("contact '{}'", contact.name);
            let read = Reading { spec, arrays, map, place: &place };
            let sides = [read.side(&contact.a)?, read.side(&contact.b)?];
            let laws = laws_of(
                contact.stiffness,
                contact.ramp,
                contact.damping,
                &contact.friction,
                &place,
            )?;
            for side in [&contact.a, &contact.b] {
                if let Some(mass) = read.mass(side)? {
                    let mass = mass * width_of(&sides, side);
                    this.frequency = this.frequency.max((contact.stiffness / mass).sqrt());
                }
            }
            this.radius = this.radius.max(contact.size);
            this.contacts.push(Contact { name: contact.name.clone(), laws, size: contact.size });
            let of_surface = |side: &SideSpec| match side {
                SideSpec::Surface { surface } => Some(*surface),
                _ => None,
            };
            let surfaces = [of_surface(&contact.a), of_surface(&contact.b)];
            let mut found = Vec::new();
            // Solids before themselves and before thin bodies, then what touches surfaces.
            if surfaces.iter().any(Option::is_none) {
                found.extend(facings(number, &sides));
            }
            let is_self = surfaces[0].is_some() && surfaces[0] == surfaces[1];
            for slave in 0..if is_self { 1 } else { 2 } {
                let Some(surface) = surfaces[1 - slave] else { continue };
                if !has_points(&sides[slave]) {
                    continue;
                }
                let mut facing = facing(number, &sides, slave, false);
                let mut skin = |surface: usize| -> Result<usize, ModelError> {
                    read.skin(surface, &mut numbers, &mut this.skins)
                };
                facing.skin = Some(skin(surface)?);
                facing.own_skin = surfaces[slave].map(&mut skin).transpose()?;
                facing.lie(&this.skins, contact, is_self);
                if !found.is_empty() && facing.is_broad() {
                    continue;
                }
                facing.apart = read.apart(contact, 1 - slave)?;
                found.push(facing);
            }
            if found.is_empty() {
                return Err(unknown(&place));
            }
            for mut facing in found {
                if facing.skin.is_none() {
                    facing.place(map, structure, laws.friction.as_ref());
                }
                this.facings.push(facing);
            }
        }
        Ok(this)
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.contacts.is_empty()
    }
}

fn unknown(place: &str) -> ModelError {
    ModelError::Unsupported {
        place: place.to_owned(),
        reason: "no way is known in which these two touch",
    }
}

/// How wide what presses is, where a force per length of a line meets a surface's mass per area.
fn width_of(sides: &[Side; 2], side: &SideSpec) -> f64 {
    let line = sides.iter().find_map(|side| match side {
        Side::Line(line) => Some(line),
        _ => None,
    });
    match (line, side) {
        (Some(line), SideSpec::Surface { .. }) => {
            2.0 * line.iter().map(|s| s.radius).fold(f64::INFINITY, f64::min)
        }
        _ => 1.0,
    }
}

/// Whether a side has probes that surfaces feel.
fn has_points(side: &Side) -> bool {
    match side {
        Side::Sheet(_) | Side::Line(_) | Side::Mass(..) => true,
        Side::Rigid(_, shape) | Side::Rest(_, shape) => {
            matches!(shape, Shape::Ball { .. } | Shape::Box { .. })
        }
    }
}

fn facing(contact: usize, sides: &[Side; 2], slave: usize, meet: bool) -> Facing {
    Facing {
        contact,
        slave: sides[slave].clone(),
        master: sides[1 - slave].clone(),
        sign: if slave == 0 { 1.0 } else { -1.0 },
        meet,
        placed: Vec::new(),
        skin: None,
        own_skin: None,
        share: 1.0,
        reach: 0.0,
        size: 0.0,
        own: None,
        apart: Vec::new(),
    }
}

/// All ways in which two sides, not both surfaces, face each other, one of them with a shape.
fn facings(contact: usize, sides: &[Side; 2]) -> Vec<Facing> {
    let facing = |slave: usize, meet: bool| facing(contact, sides, slave, meet);
    let shape = |side: &Side| match side {
        Side::Rigid(_, shape) | Side::Rest(_, shape) => Some(shape.clone()),
        _ => None,
    };
    match sides.each_ref().map(shape) {
        [None, None] => Vec::new(),
        [None, Some(_)] => vec![facing(0, false)],
        [Some(_), None] => vec![facing(1, false)],
        [Some(a), Some(b)] => {
            if has_faces(&a) && has_faces(&b) {
                return vec![facing(1, true)];
            }
            if let Some(slave) = rounder(&a, &b) {
                return vec![facing(slave, false)];
            }
            // Points of both, where both have some.
            let wide = |s: &Shape| matches!(s, Shape::HalfSpace | Shape::Bore(_));
            (0..2)
                .filter(|&k| !wide([&a, &b][k]) && !wide([&a, &b][1 - k]))
                .chain((0..2).filter(|&k| wide([&a, &b][1 - k])))
                .map(|k| facing(k, false))
                .collect()
        }
    }
}

/// The side that a ball, or a capsule, is on: its own points tell all.
fn rounder(a: &Shape, b: &Shape) -> Option<usize> {
    let rank = |s: &Shape| match s {
        Shape::Ball { .. } => 2,
        Shape::Capsule { .. } => 1,
        _ => 0,
    };
    match (rank(a), rank(b)) {
        (0, 0) => None,
        (x, y) => Some(usize::from(y > x)),
    }
}

impl Facing {
    /// Enters what the search on a surface needs.
    fn lie(&mut self, skins: &[Skin], contact: &ProbeContactSpec, is_self: bool) {
        let Some(skin) = self.skin.map(|number| &skins[number]) else { return };
        let most = |x: &mut dyn Iterator<Item = f64>| x.fold(0.0, f64::max);
        let radius = match &self.slave {
            Side::Sheet(faces) => most(&mut faces.iter().map(|face| face.radius)),
            Side::Line(line) => most(&mut line.iter().map(|segment| segment.radius)),
            Side::Mass(_, radius)
            | Side::Rigid(_, Shape::Ball { radius })
            | Side::Rest(_, Shape::Ball { radius }) => *radius,
            _ => 0.0,
        };
        self.reach = radius + most(&mut skin.faces.iter().map(|face| face.radius));
        let sizes = skin
            .reference
            .boxes
            .iter()
            .map(|hull| (0..3).map(|k| hull.high[k] - hull.low[k]).fold(0.0, f64::max));
        self.size = sizes.sum::<f64>() / skin.faces.len() as f64;
        match &self.slave {
            // Both sides' points see the same force.
            Side::Sheet(_) => self.share = 0.5,
            // A corner stands for as much as a point of the surface does, of which there is none just there.
            Side::Rigid(..) | Side::Rest(..) => {
                let areas = skin.faces.iter().flat_map(|face| face.rule.iter().map(|r| r.1));
                let count = skin.faces.iter().map(|face| face.rule.len()).sum::<usize>();
                self.share = areas.sum::<f64>() / count as f64;
            }
            _ => {}
        }
        if is_self {
            self.own = Some(Own::of(skin, contact.window));
        }
    }

    /// Whether the slave is a ball broader than the surface's faces, whose own points feel it everywhere. Its centre
    /// would have another nearest point on each face of a fold, and push where they change by turns.
    fn is_broad(&self) -> bool {
        match self.slave {
            Side::Rigid(_, Shape::Ball { radius }) | Side::Rest(_, Shape::Ball { radius }) => {
                radius > self.size
            }
            _ => false,
        }
    }

    /// How deep the two are in each other where their middles meet [m]; infinite before a surface, which is not passed
    /// through.
    pub(crate) fn middle(&self) -> f64 {
        if self.skin.is_some() {
            return f64::INFINITY;
        }
        self.slave.depth() + self.master.depth()
    }

    /// Half of the thickness of the thinner one [m].
    pub(crate) fn thinner(&self) -> f64 {
        self.slave.depth().min(self.master.depth())
    }

    /// A bound of how far any two points of both sides have moved against each other, halved [m].
    pub(crate) fn moved(&self, from: &[f64], to: &[f64]) -> f64 {
        let change = |o: usize| -> f64 {
            (0..3).map(|c| (to[o + c] - from[o + c]).powi(2)).sum::<f64>().sqrt()
        };
        let of = |side: &Side| match side {
            Side::Sheet(faces) => faces.iter().map(|face| face.moved(change)).fold(0.0, f64::max),
            Side::Line(line) => {
                let of = |s: &Segment| {
                    let [r, t, r_2, t_2] = s.offsets.map(change);
                    r.max(r_2) + s.length / 3.0 * t.max(t_2)
                };
                line.iter().map(of).fold(0.0, f64::max)
            }
            Side::Mass(terms, _) => terms.iter().map(|&(o, w)| w.abs() * change(o)).sum(),
            Side::Rigid(first, shape) => {
                let [r, axes @ ..] = vectors_of(*first).map(change);
                let arms = axes.iter().zip(shape.half_extent());
                // What is infinite does not turn, or is not asked for.
                r + arms.filter(|(d, _)| **d > 0.0).map(|(d, half)| d * half).sum::<f64>()
            }
            Side::Rest(..) => 0.0,
        };
        0.5 * (of(&self.slave) + of(&self.master))
    }

    /// Whether the two may touch where each moves by at most `moved`.
    pub(crate) fn may_meet(&self, q: &[f64], moved: f64) -> bool {
        let Some((master, shape)) = self.master.shape(q) else { return false };
        let within = |place: Vector3<f64>, reach: f64| {
            shape.distance(master.local(place)).value <= reach + 2.0 * moved
        };
        match &self.slave {
            Side::Sheet(faces) => faces.iter().any(|face| {
                let (middle, reach) = face.ball(q);
                within(middle, reach + face.radius)
            }),
            Side::Line(line) => line.iter().any(|segment| {
                let piece = segment.piece(q);
                within(piece.at(0.5), 0.5 * piece.speed_bound() + segment.radius)
            }),
            Side::Mass(..) => true,
            Side::Rigid(..) | Side::Rest(..) => self.slave.shape(q).is_some_and(|(pose, own)| {
                let reach = own.half_extent().map(|x| x * x).iter().sum::<f64>().sqrt();
                within(pose.origin, reach)
            }),
        }
    }

    /// Adds an element matrix for each part of the slave.
    fn place(&mut self, map: &DofMap, structure: &mut Structure, friction: Option<&Friction>) {
        let master = match &self.master {
            Side::Rigid(first, _) => Some(vectors_of(*first)),
            _ => None,
        };
        let thin = !matches!(self.slave, Side::Rigid(..));
        // What moves with a rigid body's axes has no symmetric tangent.
        let plain = thin && master.is_none() && friction.is_none();
        let storage = if plain { Storage::Symmetric } else { Storage::Full };
        for offsets in self.slave.parts() {
            let all = offsets.iter().copied().chain(master.into_iter().flatten());
            let groups = map.groups_of(all);
            let unknowns: Vec<usize> =
                groups.iter().flat_map(|&g| structure.groups()[g].clone()).collect();
            let local = |o: usize| unknowns.iter().position(|&u| u == o).unwrap_or(0);
            let element = structure.add_element(&groups, storage);
            self.placed.push(Placed {
                base: structure.slot(element).base,
                size: unknowns.len(),
                storage,
                slave: offsets.iter().map(|&o| local(o)).collect(),
                master: master.map_or([0; 4], |m| m.map(local)),
            });
        }
    }
}

struct Reading<'a> {
    spec: &'a ModelSpec,
    arrays: Arrays<'a>,
    map: &'a DofMap,
    place: &'a str,
}

impl Reading<'_> {
    /// Number of the skin of a surface.
    fn skin(
        &self,
        surface: usize,
        numbers: &mut HashMap<usize, usize>,
        skins: &mut Vec<Skin>,
    ) -> Result<usize, ModelError> {
        if let Some(&number) = numbers.get(&surface) {
            return Ok(number);
        }
        let map = self.map.surface(surface, self.place)?;
        let thickness = &self.spec.surfaces[surface].thickness;
        let thickness = self.arrays.sized(thickness, &[1, map.faces.len()], self.place)?;
        skins.push(Skin::of(map, thickness));
        numbers.insert(surface, skins.len() - 1);
        Ok(skins.len() - 1)
    }

    /// Places on a side around which nothing touches, and how far.
    fn apart(
        &self,
        contact: &ProbeContactSpec,
        side: usize,
    ) -> Result<Vec<(Vector3<f64>, f64)>, ModelError> {
        let rows = self.arrays.get(&contact.apart, self.place)?;
        let rows = rows.chunks_exact(5).filter(|row| row[0] == side as f64);
        Ok(rows.map(|row| (Vector3::new(row[1], row[2], row[3]), row[4])).collect())
    }

    fn side(&self, side: &SideSpec) -> Result<Side, ModelError> {
        let Self { spec, arrays, map, place } = *self;
        Ok(match side {
            SideSpec::Surface { surface } => {
                let surface_map = map.surface(*surface, place)?;
                let faces = surface_map.faces.len();
                let thickness =
                    arrays.sized(&spec.surfaces[*surface].thickness, &[1, faces], place)?;
                Side::Sheet(Face::all(surface_map, thickness))
            }
            SideSpec::Rigid { rigid, shape } => {
                let first = *map.rigid.get(*rigid).ok_or_else(|| ModelError::Reference {
                    place: place.to_owned(),
                    kind: "rigid body",
                    index: *rigid,
                    count: map.rigid.len(),
                })?;
                Side::Rigid(first, shape_of(shape, arrays, place)?)
            }
            SideSpec::Mass { at, radius, .. } => {
                let (point, _) = map.point(at, place)?;
                Side::Mass(point.terms, *radius)
            }
            SideSpec::Line { line } => Side::Line(line_of(spec, arrays, map, *line, place)?),
            SideSpec::Rest { origin, axes, shape } => {
                let axes = Matrix3::from_columns(&axes.map(Vector3::from));
                let pose = Pose { origin: Vector3::from(*origin), axes };
                Side::Rest(pose, shape_of(shape, arrays, place)?)
            }
        })
    }

    /// Mass that a stiffness of one acts on: of a body, per area of a surface, per length of a line.
    fn mass(&self, side: &SideSpec) -> Result<Option<f64>, ModelError> {
        let least = |x: &[f64]| x.iter().fold(f64::INFINITY, |m, x| m.min(*x));
        Ok(match side {
            SideSpec::Surface { surface } => {
                let surface = &self.spec.surfaces[*surface];
                let thickness = self.arrays.get(&surface.thickness, self.place)?;
                Some(surface.density * least(thickness))
            }
            SideSpec::Rigid { rigid, .. } => Some(self.spec.rigid_bodies[*rigid].mass),
            SideSpec::Mass { mass, .. } => Some(*mass),
            SideSpec::Line { line } => {
                Some(mass_per_length(self.spec, self.arrays, *line, self.place)?)
            }
            SideSpec::Rest { .. } => None,
        })
    }
}
