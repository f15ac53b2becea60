//! Contact of everything but lines with lines: points of one side, probes, face the distance function of the other.
//!
//! | side | its probes | its distance function |
//! | --- | --- | --- |
//! | shell, membrane | points of a rule on each face, on its corners and edges, too | none |
//! | cable | fitted to the zones where it is inside the other | none here |
//! | ball, mass | the centre | exact |
//! | capsule | zones of its axis | exact |
//! | box, cylinder | corners; on each rim the points that lie lowest and across | exact; between two of them, parry's points |
//! | half-space | none | exact |
//! | triangle mesh | its vertices | nearest point |
//!
//! [`find`] says what touches at given coordinates, [`act`] what follows from it: forces, tangents, energy, memory.

pub mod act;
pub mod find;
pub mod memory;
mod sheet;
pub mod spec;

use crate::contact_coupling::{Segment, laws_of, line_of};
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
use spec::{SideSpec, shape_of};

/// A side of a contact.
#[derive(Clone, Debug)]
pub(crate) enum Side {
    /// Faces of a shell or membrane.
    Sheet(Vec<Face>),
    /// A rigid body: its first coordinate, and its shape.
    Rigid(usize, Shape),
    /// A mass: weights of coordinates, and its radius.
    Mass(Vec<(usize, f64)>, f64),
    /// Elements of a cable.
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
    /// One for each part of the slave.
    pub placed: Vec<Placed>,
}

/// A contact.
#[derive(Clone, Debug)]
pub(crate) struct Contact {
    pub laws: Laws,
    /// Length by which its bristles and zones are measured [m].
    pub size: f64,
}

/// All contacts of this kind.
#[derive(Clone, Debug, Default)]
pub struct Probes {
    pub(crate) contacts: Vec<Contact>,
    pub(crate) facings: Vec<Facing>,
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
                    this.frequency = this.frequency.max((contact.stiffness / mass).sqrt());
                }
            }
            this.radius = this.radius.max(contact.size);
            this.contacts.push(Contact { laws, size: contact.size });
            let facings = facings(number, &sides);
            if facings.is_empty() {
                return Err(unknown(&place));
            }
            for mut facing in facings {
                facing.place(map, structure, laws.friction.as_ref());
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

/// All ways in which two sides face each other.
fn facings(contact: usize, sides: &[Side; 2]) -> Vec<Facing> {
    let facing = |slave: usize, meet: bool| Facing {
        contact,
        slave: sides[slave].clone(),
        master: sides[1 - slave].clone(),
        sign: if slave == 0 { 1.0 } else { -1.0 },
        meet,
        placed: Vec::new(),
    };
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
            SideSpec::Line { cable } => Side::Line(line_of(spec, arrays, map, *cable, place)?),
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
            SideSpec::Line { cable } => {
                let cable = &self.spec.cables[*cable];
                Some(least(self.arrays.get(&cable.mass_per_length, self.place)?))
            }
            SideSpec::Rest { .. } => None,
        })
    }
}
