//! From a model document to a [`Model`]: coordinates, blocks, masses, joints, loads and the sparsity of it all.

mod beams;
mod cables;
mod chambers;
mod joints;
mod surfaces;

use crate::altered::Altered;
use crate::contact_coupling::Contacts;
use crate::document::{Arrays, row};
use crate::dof_map::{CableMap, DofMap};
use crate::error::ModelError;
use crate::forces;
use crate::joints::Draft;
use crate::joints::side::Frame;
use crate::latches::Scheduled;
use crate::loads::Load;
use crate::loads::edge_moment::{EdgeMoment, EdgePoint};
use crate::loads::force::{BodyForce, DeadForce, FollowerForce};
use crate::loads::line::LineLoad;
use crate::loads::moment::{BodyMoment, Moment};
use crate::loads::moving::MovingForce;
use crate::loads::pressure::{Face, Pressure};
use crate::loads::section::{SectionForce, SectionMoment};
use crate::model::{
    Blocks, FacePlace, LatchState, Mass, Model, Placed, PlacedForce, PlacedFreedom, PlacedJoint,
    PlacedLoad,
};
use crate::point::{Interpolation, Support};
use crate::rigid::RigidBody;
use crate::signal::Value;
use crate::spec::{Array, CableSpec, ForceSpec, JointSpec, LoadSpec, ModelSpec, VERSION};
use crate::vector::vector;
use crate::winch::Winch;
use beams::beam_blocks;
use cables::{axial_energy, blocks, cable_mass};
use nalgebra::{Matrix3, Vector3};
use pliant_dae::structure::{Storage, Structure};
use pliant_elements::SurfaceBlock;
use std::sync::Arc;
use surfaces::{stiffness_scale, surface_blocks};

/// Makes a model ready.
pub(crate) fn build(spec: &ModelSpec, arrays: &[Vec<f64>]) -> Result<Model, ModelError> {
    if spec.version != VERSION {
        return Err(ModelError::Version { found: spec.version, expected: VERSION });
    }
    let arrays = Arrays(arrays);
    if let Some(&value) = spec.gravity.iter().find(|g| !g.is_finite()) {
        return Err(ModelError::Value {
            place: "gravity".to_owned(),
            value,
            allowed: "finite numbers",
        });
    }
    let points = arrays.get(&spec.shared_points, "shared points")?;
    if points.len() % 3 != 0 {
        return Err(ModelError::Length {
            place: "shared points".to_owned(),
            expected: "three for each point".to_owned(),
            got: points.len(),
        });
    }
    let mut map = DofMap::new(spec, arrays, points.len() / 3)?;
    let (initial_q, initial_v) = initial(spec, arrays, &map, points)?;
    let mut drafts = joints::draft_joints(spec, &map, &initial_q)?;
    let in_joints = drafts.joints.iter().map(|(_, joint)| joint.count()).sum::<usize>();
    let multipliers = in_joints + spec.chambers.len();
    let mut structure = Structure::new(map.coordinates, multipliers);
    map.add_groups(&mut structure);
    let (cables, strands) = blocks(spec, arrays, &map, &mut structure)?;
    let (surfaces, faces) = surface_blocks(spec, arrays, &map, &mut structure)?;
    let beams = beam_blocks(spec, arrays, &map, &mut structure)?;
    let length = model_length(spec, &map, &initial_q);
    let mut scale = vec![length; map.coordinates];
    for node in map.cables.iter().flat_map(|c| &c.nodes) {
        scale[node.t as usize..node.t as usize + 3].fill(1.0);
    }
    for &first in &map.rigid {
        scale[first + 3..first + 12].fill(1.0);
    }
    for surface in &map.surfaces {
        surface.add_scale(&mut scale);
    }
    for beam in &map.beams {
        for node in 0..beam.nodes() {
            scale[beam.offset(node, 1)..beam.offset(node + 1, 0)].fill(1.0);
        }
    }
    let mut builder = Builder {
        map: &map,
        structure: &mut structure,
        q: &initial_q,
        arrays,
        surfaces: &surfaces,
        faces: &faces,
    };
    let masses = builder.masses(spec)?;
    let cable_masses = spec
        .cables
        .iter()
        .zip(&map.cables)
        .map(|(cable, cable_map)| cable_mass(cable, arrays, &cable_map.lengths))
        .collect::<Result<_, _>>()?;
    let axial_energy = spec
        .cables
        .iter()
        .zip(&map.cables)
        .map(|(cable, cable_map)| axial_energy(cable, arrays, &cable_map.lengths))
        .sum::<Result<f64, _>>()?;
    let rigid_bodies = builder.rigid_bodies(spec)?;
    let (joints, mut constraint_scale) = builder.joints(drafts.joints, length);
    let joint_memory = joints.last().map_or(0, |joint| joint.memory.end);
    let (latches, schedule) = latches(spec)?;
    let loads = spec.loads.iter().map(|l| builder.load(l)).collect::<Result<_, _>>()?;
    let forces = builder.forces(&spec.forces, &drafts.freedoms)?;
    let chambers = builder.chambers(spec, in_joints, &mut drafts.integrals)?;
    constraint_scale.extend(chambers.iter().map(|chamber| chamber.scale));
    let mut winches = Vec::new();
    for ((cable, cable_map), strands) in spec.cables.iter().zip(&map.cables).zip(&strands) {
        winches.extend(Winch::of_cable(cable, &cable_map.lengths, strands)?);
    }
    let plastic = cables::plastic(spec, &map, &strands, &cables);
    let initial_past = cables::initial_past(spec, arrays, &plastic)?;
    let has_transit = forces.iter().any(|f| f.force.has_transit());
    let damped = |cable: &CableSpec| cable.rest_length.is_some() && cable.retardation_time != 0.0;
    let uses_rates = has_transit || spec.cables.iter().any(damped);
    let mut contacts = Contacts::of_spec(spec, arrays, &map, &mut structure)?;
    let weight = vector(spec.gravity).norm();
    let mut model = Model {
        map,
        axial_energy: axial_energy + stiffness_scale(&surfaces) + beams::stiffness_scale(&beams),
        blocks: Blocks { cables, surfaces, beams },
        strands,
        faces,
        cable_masses,
        masses,
        rigid_bodies,
        joints,
        joint_specs: spec.joints.clone(),
        latches,
        schedule,
        length,
        loads,
        winches,
        plastic,
        initial_past,
        uses_rates,
        has_transit,
        forces,
        compliant: chambers.iter().map(|chamber| chamber.multiplier).collect(),
        chambers,
        freedoms: drafts.freedoms,
        integrals: drafts.integrals,
        joint_memory,
        contacts: Contacts::default(),
        gravity: spec.gravity,
        structure,
        multipliers,
        scale,
        constraint_scale,
        initial_q,
        initial_v,
    };
    let mass = model.masses(&model.initial_q).0;
    let [kinetic, elastic, _] =
        model.energy_of_bodies(&Altered::new(&model), &model.initial_q, &model.initial_v);
    contacts.energy_floor = 1e-3 * mass * weight * contacts.radius + 1e-6 * (kinetic + elastic);
    model.contacts = contacts;
    Ok(model)
}

/// Positions, slopes and their velocities at the start.
fn initial(
    spec: &ModelSpec,
    arrays: Arrays<'_>,
    map: &DofMap,
    points: &[f64],
) -> Result<(Vec<f64>, Vec<f64>), ModelError> {
    let (mut q, mut v) = (vec![0.0; map.coordinates], vec![0.0; map.coordinates]);
    for (cable, cable_map) in spec.cables.iter().zip(&map.cables) {
        let n = 3 * cable_map.nodes.len();
        let place = |what: &str| format!("cable '{}', {what}", cable.name);
        let r = arrays.sized(&cable.r, &[n], &place("r"))?;
        let t = arrays.sized(&cable.t, &[n], &place("t"))?;
        let v_r = arrays.sized(&cable.v_r, &[0, n], &place("v_r"))?;
        let v_t = arrays.sized(&cable.v_t, &[0, n], &place("v_t"))?;
        for (i, node) in cable_map.nodes.iter().enumerate() {
            let copy = |offset: u32, from: &[f64], to: &mut [f64]| {
                if !from.is_empty() {
                    to[offset as usize..offset as usize + 3].copy_from_slice(&row(from, i));
                }
            };
            copy(node.r, r, &mut q);
            copy(node.t, t, &mut q);
            copy(node.r, v_r, &mut v);
            copy(node.t, v_t, &mut v);
        }
    }
    let velocities =
        arrays.sized(&spec.shared_velocities, &[0, points.len()], "shared velocities")?;
    for (i, &offset) in map.shared.iter().enumerate() {
        q[offset..offset + 3].copy_from_slice(&row(points, i));
        if !velocities.is_empty() {
            v[offset..offset + 3].copy_from_slice(&row(velocities, i));
        }
    }
    for (body, &first) in spec.rigid_bodies.iter().zip(&map.rigid) {
        let omega = vector(body.angular_velocity);
        q[first..first + 3].copy_from_slice(&body.position);
        v[first..first + 3].copy_from_slice(&body.velocity);
        for (k, &axis) in body.axes.iter().enumerate() {
            let at = first + 3 * (k + 1);
            q[at..at + 3].copy_from_slice(&axis);
            v[at..at + 3].copy_from_slice(omega.cross(&vector(axis)).as_slice());
        }
    }
    let mut slides = map.slides.iter();
    for joint in &spec.joints {
        if let (JointSpec::SlideCable { s, .. }, Some(&offset)) = (joint, slides.as_slice().first())
        {
            slides.next();
            q[offset] = *s;
        }
    }
    for (surface, surface_map) in spec.surfaces.iter().zip(&map.surfaces) {
        let range = surface_map.range();
        let place = |what: &str| format!("surface '{}', {what}", surface.name);
        let own = arrays.sized(&surface.q, &[0, range.len()], &place("q"))?;
        let own =
            if own.is_empty() { arrays.get(&surface.reference, &place("reference"))? } else { own };
        q[range.clone()].copy_from_slice(own);
        let speeds = arrays.sized(&surface.v, &[0, range.len()], &place("v"))?;
        if !speeds.is_empty() {
            v[range].copy_from_slice(speeds);
        }
    }
    for (beam, beam_map) in spec.beams.iter().zip(&map.beams) {
        let range = beam_map.range();
        let place = |what: &str| format!("beam '{}', {what}", beam.name);
        let own = arrays.sized(&beam.q, &[0, range.len()], &place("q"))?;
        let own =
            if own.is_empty() { arrays.get(&beam.reference, &place("reference"))? } else { own };
        q[range.clone()].copy_from_slice(own);
        let speeds = arrays.sized(&beam.v, &[0, range.len()], &place("v"))?;
        if !speeds.is_empty() {
            v[range].copy_from_slice(speeds);
        }
    }
    let finite = |x: &f64| x.is_finite();
    if let Some(&value) = q.iter().chain(&v).find(|&x| !finite(x)) {
        return Err(ModelError::Value {
            place: "initial state".to_owned(),
            value,
            allowed: "finite numbers",
        });
    }
    Ok((q, v))
}

/// Which joints hold at the start, and what happens to them in the order of time.
fn latches(spec: &ModelSpec) -> Result<(Vec<LatchState>, Vec<Scheduled>), ModelError> {
    let count = spec.joints.len();
    let mut states = vec![LatchState { engaged: true, floats: false }; count];
    let mut schedule = Vec::new();
    for latch in &spec.latches {
        let joint = latch.joint;
        let place = || "latches".to_owned();
        let state = states.get_mut(joint).ok_or_else(|| ModelError::Reference {
            place: place(),
            kind: "joint",
            index: joint,
            count,
        })?;
        *state = LatchState { engaged: latch.engaged, floats: latch.floats };
        for event in &latch.events {
            for value in [Some(event.t), event.gap].into_iter().flatten() {
                if !(value >= 0.0 && value.is_finite()) {
                    let allowed = "finite numbers of at least zero";
                    return Err(ModelError::Value { place: place(), value, allowed });
                }
            }
            schedule.push(Scheduled { t: event.t, joint, engage: event.engage, gap: event.gap });
        }
    }
    schedule.sort_by(|a: &Scheduled, b: &Scheduled| a.t.total_cmp(&b.t));
    Ok((states, schedule))
}

/// Diagonal of the box around all positions: the size by which increments are judged.
fn model_length(spec: &ModelSpec, map: &DofMap, q: &[f64]) -> f64 {
    let nodes = map.cables.iter().flat_map(|c| c.nodes.iter().map(|n| n.r as usize));
    let nodes = nodes
        .chain(map.surfaces.iter().flat_map(|s| (0..s.nodes).map(move |node| s.offset(node, 0))));
    let nodes =
        nodes.chain(map.beams.iter().flat_map(|b| (0..b.nodes()).map(move |i| b.offset(i, 0))));
    let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    for offset in nodes.chain(map.shared.iter().copied()) {
        for k in 0..3 {
            low[k] = low[k].min(q[offset + k]);
            high[k] = high[k].max(q[offset + k]);
        }
    }
    for (body, &first) in spec.rigid_bodies.iter().zip(&map.rigid) {
        let trace: f64 = (0..3).map(|k| body.inertia[k][k]).sum();
        let gyration = (0.5 * trace / body.mass).max(0.0).sqrt();
        for k in 0..3 {
            low[k] = low[k].min(q[first + k] - gyration);
            high[k] = high[k].max(q[first + k] + gyration);
        }
    }
    let diagonal = (vector(high) - vector(low)).norm();
    let rest: f64 = map.cables.iter().flat_map(|c| &c.lengths).sum();
    if diagonal > 0.0 && diagonal.is_finite() {
        diagonal
    } else if rest > 0.0 {
        rest
    } else {
        1.0
    }
}

/// Masses, joints and loads over the nodes of a map.
struct Builder<'a> {
    map: &'a DofMap,
    structure: &'a mut Structure,
    q: &'a [f64],
    arrays: Arrays<'a>,
    surfaces: &'a [Placed<Arc<SurfaceBlock>>],
    faces: &'a [Vec<FacePlace>],
}

impl Builder<'_> {
    fn support<'p>(&self, points: impl IntoIterator<Item = &'p Interpolation>) -> Support {
        let offsets = points.into_iter().flat_map(|p| p.terms.iter().map(|&(offset, _)| offset));
        let groups = self.map.groups_of(offsets);
        let unknowns = groups.iter().flat_map(|&g| self.structure.groups()[g].clone()).collect();
        Support { groups, unknowns }
    }

    fn masses(&mut self, spec: &ModelSpec) -> Result<Vec<Mass>, ModelError> {
        let mut masses = Vec::with_capacity(spec.masses.len());
        for mass in &spec.masses {
            let place = format!("mass '{}'", mass.name);
            if !(mass.mass > 0.0 && mass.mass.is_finite()) {
                return Err(ModelError::Value {
                    place,
                    value: mass.mass,
                    allowed: "masses above zero",
                });
            }
            let (r, _) = self.map.point(&mass.at, &place)?;
            if r.terms.is_empty() {
                let reason = "a mass cannot be fixed to the world";
                return Err(ModelError::Unsupported { place, reason });
            }
            let support = self.support([&r]);
            let element = self.structure.add_element(&support.groups, Storage::Symmetric);
            masses.push(Mass { name: mass.name.clone(), mass: mass.mass, r, support, element });
        }
        Ok(masses)
    }

    /// Gives each joint its multipliers and its element matrix.
    fn joints(
        &mut self,
        drafts: Vec<(String, Box<dyn Draft>)>,
        length: f64,
    ) -> (Vec<PlacedJoint>, Vec<f64>) {
        let mut joints = Vec::with_capacity(drafts.len());
        let mut scale = Vec::new();
        let mut remembered = 0;
        for (name, draft) in drafts {
            let support = self.support(draft.interpolations());
            let windows: Vec<Support> =
                draft.windows().into_iter().map(|points| self.support(points)).collect();
            let local = |window: &Support| -> Vec<usize> {
                window.unknowns.iter().map(|&u| support.local(u)).collect()
            };
            let locals = windows.iter().map(local).collect();
            let joint = draft.placed(support);
            let (first, m) = (scale.len(), joint.equations());
            scale.resize(first + m, 0.0);
            joint.scale(length, &mut scale[first..]);
            let unknowns = self.structure.velocities() + first;
            let multipliers = self.structure.add_group(unknowns..unknowns + m);
            let mut add = |support: &Support| {
                let mut groups = support.groups.clone();
                groups.push(multipliers);
                self.structure.add_element(&groups, Storage::Symmetric)
            };
            let mut elements = windows.iter().map(&mut add).collect::<Vec<_>>();
            if elements.is_empty() {
                elements.push(add(joint.support()));
            }
            let memory = remembered..remembered + joint.memory();
            remembered = memory.end;
            let (element, windows) = (elements[0], locals);
            joints.push(PlacedJoint { name, joint, first, element, windows, memory });
        }
        (joints, scale)
    }

    fn rigid_bodies(&mut self, spec: &ModelSpec) -> Result<Vec<RigidBody>, ModelError> {
        let mut bodies = Vec::with_capacity(spec.rigid_bodies.len());
        for (body, &first) in spec.rigid_bodies.iter().zip(&self.map.rigid) {
            let value = |value, allowed| ModelError::Value {
                place: format!("rigid body '{}'", body.name),
                value,
                allowed,
            };
            if !(body.mass > 0.0 && body.mass.is_finite()) {
                return Err(value(body.mass, "masses above zero"));
            }
            let euler = RigidBody::euler_tensor(&Matrix3::from(body.inertia).transpose());
            // Rounding of a flat body's inertia may leave its Euler tensor slightly below zero.
            let least = euler.symmetric_eigenvalues().min();
            if !(least >= -1e-9 * euler.norm() && euler.trace() > 0.0 && euler.norm().is_finite()) {
                return Err(value(least, "inertias that satisfy the triangle inequality"));
            }
            let groups = self.map.groups_of([first]);
            let element = self.structure.add_element(&groups, Storage::Symmetric);
            bodies.push(RigidBody { mass: body.mass, euler, first, element });
        }
        Ok(bodies)
    }

    fn forces(
        &mut self,
        specs: &[ForceSpec],
        freedoms: &[PlacedFreedom],
    ) -> Result<Vec<PlacedForce>, ModelError> {
        let mut first_output = 0;
        let mut placed = Vec::with_capacity(specs.len());
        for (number, spec) in specs.iter().enumerate() {
            let support = |points: &[&Interpolation]| self.support(points.iter().copied());
            let faces = |surface, faces: &Array, place: &str| self.faces_of(surface, faces, place);
            let context =
                forces::Context { map: self.map, support: &support, freedoms, faces: &faces };
            for force in forces::of_spec(spec, &context)? {
                let groups = &force.support().groups;
                let element = self.structure.add_element(groups, force.storage());
                let outputs = force.output_count();
                placed.push(PlacedForce { number, force, element, first_output });
                first_output += outputs;
            }
        }
        Ok(placed)
    }

    fn load(&mut self, load: &LoadSpec) -> Result<PlacedLoad, ModelError> {
        let (load, value): (Box<dyn Load>, Value) = match load {
            LoadSpec::Force { name, at, value, follower } => {
                let place = format!("load '{name}'");
                let value = Value::new(value, &place)?;
                let force: Box<dyn Load> = match (follower, self.map.point(at, &place)?) {
                    (false, (r, _)) => Box::new(DeadForce { r }),
                    (true, (r, Frame::Line(t))) => {
                        let t_0 = unit(vector(t.at(self.q)), &place)?;
                        let support = self.support([&r, &t]);
                        Box::new(FollowerForce::new(r, t, t_0, support))
                    }
                    (true, (r, Frame::Body(e))) => {
                        let support = self.support([&r, &e[0]]);
                        let start = e.each_ref().map(|e| vector(e.at(self.q)));
                        Box::new(BodyForce::new(r, e, start, support))
                    }
                    (true, (r, Frame::Section(gradients))) => {
                        let support = self.support([&r, &gradients[0], &gradients[1]]);
                        let force = SectionForce::new(r, gradients, self.q, support);
                        let reason = "its section is degenerate at the start";
                        Box::new(force.ok_or(ModelError::Unsupported { place, reason })?)
                    }
                    _ => {
                        let reason = "a follower force needs a point that has a direction";
                        return Err(ModelError::Unsupported { place, reason });
                    }
                };
                (force, value)
            }
            LoadSpec::Moment { name, at, value } => {
                let place = format!("load '{name}'");
                let value = Value::new(value, &place)?;
                match self.map.point(at, &place)?.1 {
                    Frame::Line(t) => {
                        let support = self.support([&t]);
                        (Box::new(Moment::new(t, support)), value)
                    }
                    Frame::Body(e) => {
                        let support = self.support([&e[0]]);
                        (Box::new(BodyMoment::new(e, support)), value)
                    }
                    Frame::Section(gradients) => {
                        let support = self.support(&gradients);
                        (Box::new(SectionMoment::new(gradients, support)), value)
                    }
                    _ => {
                        let reason = "a moment needs a point of a cable, a beam or a rigid body";
                        return Err(ModelError::Unsupported { place, reason });
                    }
                }
            }
            LoadSpec::Pressure { name, surface, faces, value, conservative } => {
                let place = format!("load '{name}'");
                let value = Value::new(value, &place)?;
                let parts = self.faces_of(*surface, faces, &place)?;
                (Box::new(Pressure::new(parts, *conservative)), value)
            }
            LoadSpec::Edge { name, surface, sides, value } => {
                let place = format!("load '{name}'");
                let map = self.map.surface(*surface, &place)?;
                let sides = map.sides(self.arrays, sides, &place)?;
                (
                    Box::new(LineLoad { weights: map.edge_weights(&sides) }),
                    Value::new(value, &place)?,
                )
            }
            LoadSpec::EdgeMoment { name, surface, sides, value } => {
                let place = format!("load '{name}'");
                let map = self.map.surface(*surface, &place)?;
                let sides = map.sides(self.arrays, sides, &place)?;
                let points = map.edge_points(&sides, self.q);
                let support = |p: &EdgePoint| self.support([&p.across]);
                let supports = points.iter().map(support).collect();
                (Box::new(EdgeMoment::new(points, supports)), Value::new(value, &place)?)
            }
            LoadSpec::Moving { name, cable, value, position } => {
                let place = format!("load '{name}'");
                let position = Value::new(position, &place)?;
                let load = self.moving_force(*cable, position, &place)?;
                (Box::new(load), Value::new(value, &place)?)
            }
            LoadSpec::BeamLine { name, beam, value } => {
                let place = format!("load '{name}'");
                let weights = self.map.beam(*beam, &place)?.line_weights();
                (Box::new(LineLoad { weights }), Value::new(value, &place)?)
            }
            LoadSpec::Line { name, cable, value } => {
                let place = format!("load '{name}'");
                (Box::new(self.line_load(*cable, &place)?), Value::new(value, &place)?)
            }
        };
        let storage = load.storage();
        let element = |support: &Support| self.structure.add_element(&support.groups, storage);
        let elements = load.supports().iter().map(element).collect();
        Ok(PlacedLoad { load, value, elements })
    }

    /// Faces of a surface with their coordinates, in the order of their nodal vectors.
    fn faces_of(
        &self,
        surface: usize,
        faces: &Array,
        place: &str,
    ) -> Result<Vec<(Face, Support)>, ModelError> {
        let map = self.map.surface(surface, place)?;
        let numbers = self.arrays.whole(faces, place)?;
        let mut parts = Vec::with_capacity(numbers.len());
        for &number in &numbers {
            let Some(at) = self.faces[surface].get(number) else {
                return Err(ModelError::Reference {
                    place: place.to_owned(),
                    kind: "face",
                    index: number,
                    count: map.faces.len(),
                });
            };
            let block = self.surfaces[at.block].block.clone();
            let unknowns =
                block.vectors_of(at.element).iter().flat_map(|&o| o as usize..o as usize + 3);
            let support = Support {
                groups: map.groups(number).map(|offset| self.map.group[offset]).collect(),
                unknowns: unknowns.collect(),
            };
            parts.push((Face { block, element: at.element }, support));
        }
        Ok(parts)
    }

    fn cable(&self, cable: usize, place: &str) -> Result<&CableMap, ModelError> {
        let count = self.map.cables.len();
        self.map.cables.get(cable).ok_or_else(|| ModelError::Reference {
            place: place.to_owned(),
            kind: "cable",
            index: cable,
            count,
        })
    }

    fn moving_force(
        &self,
        cable: usize,
        position: Value,
        place: &str,
    ) -> Result<MovingForce, ModelError> {
        let map = self.cable(cable, place)?;
        let nodes = |e: usize| {
            let (a, b) = (map.nodes[map.first_node(e)], map.nodes[map.first_node(e) + 1]);
            [a.r, a.t, b.r, b.t].map(|o| o as usize)
        };
        let nodes = (0..map.elements()).map(nodes).collect();
        Ok(MovingForce::new(position, &map.lengths, nodes))
    }

    fn line_load(&self, cable: usize, place: &str) -> Result<LineLoad, ModelError> {
        let map = self.cable(cable, place)?;
        let mut weights = vec![[0.0; 2]; map.nodes.len()];
        for (e, &l) in map.lengths.iter().enumerate() {
            let i = map.first_node(e);
            weights[i][0] += 0.5 * l;
            weights[i][1] += l * l / 12.0;
            weights[i + 1][0] += 0.5 * l;
            weights[i + 1][1] -= l * l / 12.0;
        }
        let terms = map
            .nodes
            .iter()
            .zip(&weights)
            .flat_map(|(node, w)| [(node.r as usize, w[0]), (node.t as usize, w[1])]);
        Ok(LineLoad { weights: Interpolation::weighted(terms) })
    }
}

fn unit(direction: Vector3<f64>, place: &str) -> Result<Vector3<f64>, ModelError> {
    direction.try_normalize(1e-300).filter(|d| d.iter().all(|x| x.is_finite())).ok_or_else(|| {
        ModelError::Value {
            place: place.to_owned(),
            value: direction.norm(),
            allowed: "directions longer than zero",
        }
    })
}
