//! A model made ready to compute with; it never changes during a run.

use crate::altered::Plastic;
use crate::chambers::{self, Chamber};
use crate::contact_coupling::Contacts;
use crate::dof_map::DofMap;
use crate::error::ModelError;
use crate::forces::ForceElement;
use crate::freedom::Freedom;
use crate::joints::Joint;
use crate::latches::Scheduled;
use crate::loads::Load;
use crate::point::{Interpolation, Support};
use crate::rigid::RigidBody;
use crate::signal::Value;
use crate::spec::{JointSpec, ModelSpec};
use crate::winch::{self, Winch};
use pliant_dae::error::Error;
use pliant_dae::linear_solver::{self, LinearSolver};
use pliant_dae::structure::{self, Storage, Structure};
use pliant_elements::{BeamBlock, Block, CableBlock, SurfaceBlock};
use std::ops::{Deref, Range};
use std::sync::Arc;

/// A block of elements and where its matrices lie among the element values.
pub(crate) struct Placed<B> {
    pub block: B,
    pub values: Range<usize>,
}

impl<B: Deref<Target: Block>> Placed<B> {
    /// Reserves room for the matrices of a block.
    pub fn new(block: B, structure: &mut Structure) -> Self {
        let base = structure.reserve(block.values_len());
        Self { values: base..base + block.values_len(), block }
    }

    /// Where the matrix of element `e` lies.
    pub fn slot_of(&self, e: usize) -> structure::Slot {
        let slot = self.block.slot_of(e);
        structure::Slot {
            base: self.values.start + slot.base,
            stride: slot.stride,
            storage: Storage::Symmetric,
        }
    }
}

/// All blocks: one list for each kind, for what only that kind can tell.
#[derive(Default)]
pub(crate) struct Blocks {
    pub cables: Vec<Placed<Box<CableBlock>>>,
    /// Loads on faces share the block.
    pub surfaces: Vec<Placed<Arc<SurfaceBlock>>>,
    /// One for each beam.
    pub beams: Vec<Placed<Box<BeamBlock>>>,
}

impl Blocks {
    /// Every block, whatever its kind, and where its matrices lie. The order never changes.
    pub fn iter(&self) -> impl Iterator<Item = (&dyn Block, &Range<usize>)> {
        let cables = self.cables.iter().map(|p| (&*p.block as &dyn Block, &p.values));
        let surfaces = self.surfaces.iter().map(|p| (&*p.block as &dyn Block, &p.values));
        let beams = self.beams.iter().map(|p| (&*p.block as &dyn Block, &p.values));
        cables.chain(surfaces).chain(beams)
    }
}

/// Where the elements of one strand are found.
#[derive(Clone, Copy, Debug)]
pub(crate) struct StrandPlace {
    /// Number of the block.
    pub block: usize,
    /// Number in the block.
    pub cable: usize,
    /// Number in the block of its first element.
    pub element: usize,
}

/// Where a face of a surface is found.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FacePlace {
    /// Number of the block.
    pub block: usize,
    /// Number in the block.
    pub element: usize,
}

/// A lumped mass `m r_q^T r_q`.
pub(crate) struct Mass {
    pub name: String,
    pub mass: f64,
    pub r: Interpolation,
    pub support: Support,
    pub element: usize,
}

/// A joint, its first multiplier and its element matrix.
pub(crate) struct PlacedJoint {
    pub name: String,
    pub joint: Box<dyn Joint>,
    pub first: usize,
    /// The first of one element for each window, or the only one.
    pub element: usize,
    /// For each window the local numbers of its unknowns.
    pub windows: Vec<Vec<usize>>,
    /// Where its numbers are among those that joints remember.
    pub memory: Range<usize>,
}

/// The freedom of a joint, over all coordinates.
pub(crate) struct PlacedFreedom {
    /// Number of the joint; none where a drive alone knows it.
    pub joint: Option<usize>,
    pub y: Freedom,
}

/// A signal whose integral is asked for.
pub(crate) struct PlacedIntegral {
    pub rate: Value,
    pub from: Beginning,
    /// Whether the load factor of statics stands for time; else the integral stays where it began.
    pub in_statics: bool,
}

/// What an integral begins at.
pub(crate) enum Beginning {
    /// The value of a freedom.
    Freedom(Freedom),
    /// The mass of the gas in a chamber, by its number.
    Mass(usize),
}

/// How a joint is released and engaged.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LatchState {
    /// Whether it holds at the start.
    pub engaged: bool,
    /// Whether one of its points is wherever the other is found when it engages.
    pub floats: bool,
}

/// A load, its value over time and its element matrices (none for dead loads).
pub(crate) struct PlacedLoad {
    pub load: Box<dyn Load>,
    pub value: Value,
    pub elements: Vec<usize>,
}

/// A force or a piece of one, its element matrix and its first number among the outputs.
pub(crate) struct PlacedForce {
    /// Number of the force in the document.
    pub number: usize,
    pub force: Box<dyn ForceElement>,
    pub element: usize,
    pub first_output: usize,
}

/// A model made ready to compute with.
pub struct Model {
    pub(crate) map: DofMap,
    pub(crate) blocks: Blocks,
    /// Strands of each cable.
    pub(crate) strands: Vec<Vec<StrandPlace>>,
    /// Faces of each surface.
    pub(crate) faces: Vec<Vec<FacePlace>>,
    /// Mass of each cable [kg].
    pub(crate) cable_masses: Vec<f64>,
    /// Elastic energy of all cables at a strain of one [J].
    pub(crate) axial_energy: f64,
    pub(crate) masses: Vec<Mass>,
    pub(crate) rigid_bodies: Vec<RigidBody>,
    pub(crate) joints: Vec<PlacedJoint>,
    /// Descriptions of the joints of the document, the first of `joints`.
    pub(crate) joint_specs: Vec<JointSpec>,
    /// One for each joint of the document.
    pub(crate) latches: Vec<LatchState>,
    /// What happens to joints, in the order of time.
    pub(crate) schedule: Vec<Scheduled>,
    /// Size of the model [m].
    pub(crate) length: f64,
    pub(crate) loads: Vec<PlacedLoad>,
    pub(crate) winches: Vec<Winch>,
    /// Cables that yield.
    pub(crate) plastic: Vec<Plastic>,
    /// What their points remember at the start.
    pub(crate) initial_past: Vec<f64>,
    /// Whether rates of signals are asked for, which takes a memory of their values.
    pub(crate) uses_rates: bool,
    /// Whether power passes forces from outside into loss.
    pub(crate) has_transit: bool,
    pub(crate) forces: Vec<PlacedForce>,
    pub(crate) chambers: Vec<Chamber>,
    /// Numbers of their multipliers.
    pub(crate) compliant: Vec<usize>,
    pub(crate) freedoms: Vec<PlacedFreedom>,
    pub(crate) integrals: Vec<PlacedIntegral>,
    /// How many numbers joints remember.
    pub(crate) joint_memory: usize,
    /// Who may touch whom.
    pub(crate) contacts: Contacts,
    pub(crate) gravity: [f64; 3],
    pub(crate) structure: Structure,
    pub(crate) multipliers: usize,
    pub(crate) scale: Vec<f64>,
    pub(crate) constraint_scale: Vec<f64>,
    pub(crate) initial_q: Vec<f64>,
    pub(crate) initial_v: Vec<f64>,
}

impl Model {
    /// Reads a model document and the arrays that travel beside it.
    ///
    /// # Errors
    /// [`ModelError`] naming the place that is wrong.
    pub fn from_json(document: &str, arrays: &[Vec<f64>]) -> Result<Self, ModelError> {
        Self::new(&serde_json::from_str(document)?, arrays)
    }

    /// Makes a model ready.
    ///
    /// # Errors
    /// [`ModelError`] naming the place that is wrong.
    pub fn new(spec: &ModelSpec, arrays: &[Vec<f64>]) -> Result<Self, ModelError> {
        crate::build::build(spec, arrays)
    }

    /// Number of coordinates, and of velocities.
    #[must_use]
    pub fn coordinates(&self) -> usize {
        self.map.coordinates
    }

    /// Number of multipliers.
    #[must_use]
    pub fn multipliers(&self) -> usize {
        self.multipliers
    }

    /// Coordinates at the start.
    #[must_use]
    pub fn initial_q(&self) -> &[f64] {
        &self.initial_q
    }

    /// Velocities at the start.
    #[must_use]
    pub fn initial_v(&self) -> &[f64] {
        &self.initial_v
    }

    /// Where every node stands in the coordinates.
    #[must_use]
    pub fn map(&self) -> &DofMap {
        &self.map
    }

    /// Name of a coordinate for messages.
    pub(crate) fn describe(&self, coordinate: usize) -> String {
        let free = |mass: &&Mass| match mass.r.terms[..] {
            [(offset, _)] => {
                self.map.shared.contains(&offset) && (offset..offset + 3).contains(&coordinate)
            }
            _ => false,
        };
        match self.masses.iter().find(free) {
            Some(mass) => {
                let axis = ["x", "y", "z"][coordinate - mass.r.terms[0].0];
                format!("mass '{}', position {axis}", mass.name)
            }
            None => self.map.describe(coordinate),
        }
    }

    /// First multiplier and number of multipliers of each joint; the rigidity of rigid bodies comes last.
    #[must_use]
    pub fn joint_multipliers(&self) -> Vec<[usize; 2]> {
        self.joints.iter().map(|j| [j.first, j.joint.equations()]).collect()
    }

    /// For each joint the first of six numbers among the outputs (force and moment of a drive) and the number of its
    /// freedom's value, -1 where there is none.
    #[must_use]
    pub fn joint_outputs(&self) -> Vec<[i64; 2]> {
        let mut next = self.forces.iter().map(|f| f.force.output_count() as i64).sum::<i64>();
        let mut places = vec![[-1, -1]; self.joints.len()];
        for (place, joint) in places.iter_mut().zip(&self.joints) {
            if joint.joint.is_driven() {
                place[0] = next;
                next += 6;
            }
        }
        for (number, freedom) in self.freedoms.iter().enumerate() {
            if let Some(joint) = freedom.joint {
                places[joint][1] = next + number as i64;
            }
        }
        places
    }

    /// First number among the outputs of each chamber: absolute pressure, volume, mass.
    #[must_use]
    pub fn chamber_outputs(&self) -> Vec<usize> {
        let forces = self.forces.iter().map(|f| f.force.output_count()).sum::<usize>();
        let drives = 6 * self.joints.iter().filter(|j| j.joint.is_driven()).count();
        let first = forces + drives + self.freedoms.len();
        (0..self.chambers.len()).map(|k| first + chambers::OUTPUTS * k).collect()
    }

    /// First number among the outputs of what winches show; what cables that yield remember follows.
    pub(crate) fn first_length_output(&self) -> usize {
        let forces = self.forces.iter().map(|f| f.force.output_count()).sum::<usize>();
        let drives = 6 * self.joints.iter().filter(|j| j.joint.is_driven()).count();
        forces + drives + self.freedoms.len() + chambers::OUTPUTS * self.chambers.len()
    }

    /// For each cable the first number among the outputs of what its points remember, plastic strain and path of each,
    /// and how many numbers each of its elements has: none where it does not yield.
    #[must_use]
    pub fn past_outputs(&self) -> Vec<[usize; 2]> {
        let mut places = vec![[0, 0]; self.map.cables.len()];
        let first = self.first_length_output() + winch::OUTPUTS * self.winches.len();
        for plastic in &self.plastic {
            places[plastic.cable] = [first + plastic.range.start, plastic.width];
        }
        places
    }

    /// First number and number of numbers among the outputs of each force.
    #[must_use]
    pub fn force_outputs(&self) -> Vec<[usize; 2]> {
        let mut places: Vec<[usize; 2]> = Vec::new();
        for f in &self.forces {
            if f.number == places.len() {
                places.push([f.first_output, f.force.output_count()]);
            }
        }
        places
    }

    /// The joint that a multiplier belongs to.
    pub(crate) fn joint_of(&self, multiplier: usize) -> Option<usize> {
        let k = self.joints.partition_point(|j| j.first <= multiplier).checked_sub(1)?;
        let joint = &self.joints[k];
        (multiplier < joint.first + joint.joint.equations()).then_some(k)
    }

    /// A linear solver for the model's structure.
    ///
    /// # Errors
    /// [`Error::Solver`] if the analysis runs out of memory or index range.
    pub fn solver(&self, parallel: bool) -> Result<Box<dyn LinearSolver>, Error> {
        let options = linear_solver::Options { parallel, ..linear_solver::Options::default() };
        linear_solver::analyze(&self.structure, options)
            .map_err(|source| Error::Solver { t: 0.0, source })
    }

    /// The first time after `t` at which anything given over time has a kink: steps that are free to choose end there.
    #[must_use]
    pub fn next_break(&self, t: f64) -> f64 {
        let values = self.loads.iter().filter_map(|l| l.value.next_break(t));
        let loads = self.loads.iter().filter_map(|l| l.load.next_break(t));
        let forces = self.forces.iter().filter_map(|f| f.force.next_break(t));
        let joints = self.joints.iter().filter_map(|j| j.joint.next_break(t));
        let winches = self.winches.iter().filter_map(|w| w.next_break(t));
        let inflows = self.chambers.iter().map(|c| &self.integrals[c.mass].rate);
        let inflows = inflows.filter_map(|rate| rate.next_break(t));
        let given = values.chain(winches).chain(inflows);
        given.chain(loads).chain(forces).chain(joints).fold(f64::INFINITY, f64::min)
    }

    /// The size that errors of positions are measured against [m].
    #[must_use]
    pub fn size(&self) -> f64 {
        let all = self.scale.iter().copied().fold(0.0, f64::max);
        if all > 0.0 { all } else { 1.0 }
    }

    /// Errors that count as much as one of the model's size: of slopes, what moves their elements' ends as far.
    pub(crate) fn error_scale(&self) -> Vec<f64> {
        let mut scale = self.scale.clone();
        let size = self.size();
        for cable in &self.map.cables {
            for (e, &length) in cable.lengths.iter().enumerate() {
                let first = cable.first_node(e);
                for node in &cable.nodes[first..=first + 1] {
                    let slope = node.t as usize..node.t as usize + 3;
                    scale[slope].fill(size / length);
                }
            }
        }
        for beam in &self.map.beams {
            for (e, &length) in beam.lengths.iter().enumerate() {
                for node in [e, e + 1] {
                    let slope = beam.offset(node, 1);
                    scale[slope..slope + 3].fill(size / length);
                }
            }
        }
        scale
    }

    /// Number of elements, those that bridge two cables of a block included.
    #[must_use]
    pub fn elements(&self) -> usize {
        self.blocks.iter().map(|(block, _)| block.element_count()).sum()
    }
}
