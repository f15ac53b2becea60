//! From a model document to a [`Model`]: coordinates, blocks, masses, joints, loads and the sparsity of it all.

use crate::document::{Arrays, row};
use crate::dof_map::DofMap;
use crate::error::ModelError;
use crate::joints::Joint;
use crate::joints::clamp::Clamp;
use crate::joints::pin::Pin;
use crate::loads::Load;
use crate::loads::force::{DeadForce, FollowerForce};
use crate::loads::line::LineLoad;
use crate::loads::moment::Moment;
use crate::model::{Mass, Model, PlacedBlock, PlacedJoint, PlacedLoad, StrandPlace};
use crate::point::{Interpolation, Support};
use crate::signal::Value;
use crate::spec::{
    BendingSpec, CableSpec, IntegrationSpec, JointSpec, LoadSpec, ModelSpec, PointSpec, StrainSpec,
    VERSION,
};
use crate::vector::vector;
use nalgebra::Vector3;
use pliant_dae::structure::{self, Storage, Structure};
use pliant_elements::{
    Bending, Block, Cable, CableBlock, CableElement, CableLaw, ElementError, Integration,
    Reference, Section, Sections, Slack, Strain,
};
use pliant_math::quadrature::{GAUSS_3, GAUSS_5, LOBATTO_3};

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
    let multipliers = spec.joints.iter().map(joint_equations).sum();
    let mut structure = Structure::new(map.coordinates, multipliers);
    map.add_groups(&mut structure);
    let (blocks, strands) = blocks(spec, arrays, &map, &mut structure)?;
    let length = model_length(&map, &initial_q);
    let mut scale = vec![length; map.coordinates];
    for node in map.cables.iter().flat_map(|c| &c.nodes) {
        scale[node.t as usize..node.t as usize + 3].fill(1.0);
    }
    let mut builder = Builder { map: &map, structure: &mut structure, q: &initial_q };
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
        .sum::<Result<_, _>>()?;
    let (joints, constraint_scale) = builder.joints(spec, length)?;
    let loads = spec.loads.iter().map(|l| builder.load(l)).collect::<Result<_, _>>()?;
    Ok(Model {
        map,
        blocks,
        strands,
        cable_masses,
        axial_energy,
        masses,
        joints,
        loads,
        gravity: spec.gravity,
        structure,
        multipliers,
        scale,
        constraint_scale,
        initial_q,
        initial_v,
    })
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
    Ok((q, v))
}

/// Diagonal of the box around all positions: the size by which increments are judged.
fn model_length(map: &DofMap, q: &[f64]) -> f64 {
    let nodes = map.cables.iter().flat_map(|c| c.nodes.iter().map(|n| n.r as usize));
    let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    for offset in nodes.chain(map.shared.iter().copied()) {
        for k in 0..3 {
            low[k] = low[k].min(q[offset + k]);
            high[k] = high[k].max(q[offset + k]);
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

fn law(cable: &CableSpec) -> CableLaw {
    CableLaw {
        strain: match cable.strain {
            StrainSpec::GreenLagrange => Strain::GreenLagrange,
            StrainSpec::Biot => Strain::Biot,
        },
        integration: match cable.integration {
            IntegrationSpec::Lobatto => Integration::Lobatto,
            IntegrationSpec::Full => Integration::Full,
        },
        bending: match cable.bending {
            BendingSpec::Exact => Bending::Exact,
            BendingSpec::Simplified => Bending::Simplified,
        },
        reference: match cable.reference {
            None => Reference::Straight,
            Some(_) => Reference::Planar,
        },
        tension_only: cable.tension_only,
        damped: cable.retardation_time != 0.0,
    }
}

type Blocks = (Vec<PlacedBlock>, Vec<Vec<StrandPlace>>);

/// One block for each law; every strand is a cable of its block.
fn blocks(
    spec: &ModelSpec,
    arrays: Arrays<'_>,
    map: &DofMap,
    structure: &mut Structure,
) -> Result<Blocks, ModelError> {
    struct Pending {
        law: CableLaw,
        strands: Vec<Cable>,
        names: Vec<String>,
        elements: usize,
    }
    let mut pending: Vec<Pending> = Vec::new();
    let mut places = Vec::with_capacity(spec.cables.len());
    for (cable, cable_map) in spec.cables.iter().zip(&map.cables) {
        let law = law(cable);
        let found = pending.iter().position(|p| p.law == law);
        let block = found.unwrap_or(pending.len());
        if found.is_none() {
            pending.push(Pending { law, strands: Vec::new(), names: Vec::new(), elements: 0 });
        }
        let into = &mut pending[block];
        let elements = elements(cable, arrays, &cable_map.lengths, law)?;
        let mut strands = Vec::with_capacity(cable_map.strands.len());
        for (k, range) in cable_map.strands.iter().enumerate() {
            strands.push(StrandPlace { block, cable: into.strands.len(), element: into.elements });
            let nodes = cable_map.nodes[cable_map.strand_nodes(k)].to_vec();
            // Between two strands of a block lies one bridge.
            into.elements += nodes.len();
            let parameters = match elements.len() {
                1 => elements.clone(),
                _ => elements[range.clone()].to_vec(),
            };
            let normal = cable.reference.as_ref().map_or([0.0, 0.0, 1.0], |r| r.normal);
            into.names.push(cable.name.clone());
            into.strands.push(Cable {
                nodes,
                elements: parameters,
                normal,
                slack: Slack::default(),
            });
        }
        places.push(strands);
    }
    let mut blocks = Vec::with_capacity(pending.len());
    for Pending { law, strands, names, .. } in pending {
        let block = CableBlock::new(law, &strands).map_err(|source| ModelError::Element {
            cable: element_error_cable(&source)
                .and_then(|c| names.get(c))
                .cloned()
                .unwrap_or_default(),
            source,
        })?;
        let base = structure.reserve(block.values_len());
        blocks.push(PlacedBlock { values: base..base + block.values_len(), block });
    }
    for (cable_map, strands) in map.cables.iter().zip(&places) {
        for (k, place) in strands.iter().enumerate() {
            let placed = &blocks[place.block];
            for (i, pair) in cable_map.nodes[cable_map.strand_nodes(k)].windows(2).enumerate() {
                let offsets = [pair[0].r, pair[0].t, pair[1].r, pair[1].t];
                let groups = map.groups_of(offsets.map(|o| o as usize));
                let slot = placed.block.slot_of(place.element + i);
                structure.add_element_at(
                    &groups,
                    structure::Slot {
                        base: placed.values.start + slot.base,
                        stride: slot.stride,
                        storage: Storage::Symmetric,
                    },
                );
            }
        }
    }
    Ok((blocks, places))
}

/// Energy at a strain of one, EA times the length [J], as a measure of rounding in elastic energies.
fn axial_energy(cable: &CableSpec, arrays: Arrays<'_>, lengths: &[f64]) -> Result<f64, ModelError> {
    let samples = arrays.get(&cable.axial_stiffness, "axial_stiffness")?;
    let largest = samples.iter().copied().fold(0.0, f64::max);
    Ok(largest * lengths.iter().sum::<f64>())
}

/// Mass of a cable [kg].
fn cable_mass(cable: &CableSpec, arrays: Arrays<'_>, lengths: &[f64]) -> Result<f64, ModelError> {
    let samples = arrays.get(&cable.mass_per_length, "mass_per_length")?;
    Ok((0..lengths.len())
        .map(|e| {
            let mean: f64 = (0..5)
                .map(|k| GAUSS_5.weight[k] * nearest(samples, &GAUSS_5.xi, e, GAUSS_5.xi[k]))
                .sum();
            mean * lengths[e]
        })
        .sum())
}

fn element_error_cable(error: &ElementError) -> Option<usize> {
    match *error {
        ElementError::TooFewNodes { cable, .. }
        | ElementError::ParameterCount { cable, .. }
        | ElementError::OutOfRange { cable, .. }
        | ElementError::MissingReference { cable, .. }
        | ElementError::UnusedReference { cable, .. }
        | ElementError::NotPlanar { cable, .. }
        | ElementError::UnusedDamping { cable, .. } => Some(cable),
    }
}

/// Parameters of all elements of a cable; one set where all are equal.
fn elements(
    cable: &CableSpec,
    arrays: Arrays<'_>,
    lengths: &[f64],
    law: CableLaw,
) -> Result<Vec<CableElement>, ModelError> {
    let n = lengths.len();
    let place = |what: &str| format!("cable '{}', {what}", cable.name);
    let positive: (fn(f64) -> bool, _) = (|x| x > 0.0, "numbers above zero");
    let axial_points: &[f64] = match law.integration {
        Integration::Lobatto => &LOBATTO_3.xi,
        Integration::Full => &GAUSS_5.xi,
    };
    let sampled = |array, points: usize, what: &str, allowed| {
        arrays.checked(array, &[1, n * points], &place(what), allowed)
    };
    let axial = sampled(&cable.axial_stiffness, axial_points.len(), "axial_stiffness", positive)?;
    let not_negative: (fn(f64) -> bool, _) = (|x| x >= 0.0, "numbers from zero");
    let bending = sampled(&cable.bending_stiffness, 3, "bending_stiffness", not_negative)?;
    let mass = sampled(&cable.mass_per_length, 5, "mass_per_length", positive)?;
    let tau = cable.retardation_time;
    if !(tau >= 0.0 && tau.is_finite()) {
        return Err(ModelError::Value {
            place: place("retardation_time"),
            value: tau,
            allowed: "numbers from zero",
        });
    }
    let reference = match &cable.reference {
        None => None,
        Some(reference) => {
            let nodes = n + arrays.get(&cable.strands, &place("strands"))?.len();
            Some((
                arrays.sized(&reference.r, &[3 * nodes], &place("reference r"))?,
                arrays.sized(&reference.t, &[3 * nodes], &place("reference t"))?,
            ))
        }
    };
    let uniform = axial.len() == 1 && bending.len() == 1 && mass.len() == 1 && reference.is_none();
    let first = lengths[0];
    let count = if uniform && lengths.iter().all(|&l| l == first) { 1 } else { n };
    let strands = arrays.whole(&cable.strands, &place("strands"))?;
    let mut node = 0;
    let mut ends = strands.iter().scan(0, |end, &n| {
        *end += n;
        Some(*end)
    });
    let mut end = ends.next().unwrap_or(n);
    let mut out = Vec::with_capacity(count);
    for e in 0..count {
        if e == end {
            node += 1;
            end = ends.next().unwrap_or(n);
        }
        let sections = Sections::sample(|xi| Section {
            axial_stiffness: nearest(axial, axial_points, e, xi),
            bending_stiffness: nearest(bending, &GAUSS_3.xi, e, xi),
            mass_per_length: nearest(mass, &GAUSS_5.xi, e, xi),
        });
        let reference = reference
            .map(|(r, t)| [row(r, node), row(t, node), row(r, node + 1), row(t, node + 1)]);
        out.push(CableElement { length: lengths[e], sections, retardation_time: tau, reference });
        node += 1;
    }
    Ok(out)
}

/// The sample of element `e` at the point nearest to `xi`; one number serves for all.
fn nearest(samples: &[f64], points: &[f64], e: usize, xi: f64) -> f64 {
    if let [x] = samples {
        return *x;
    }
    let distance = |k: usize| (points[k] - xi).abs();
    let best =
        (0..points.len()).fold(0, |best, k| if distance(k) < distance(best) { k } else { best });
    samples[e * points.len() + best]
}

fn joint_equations(joint: &JointSpec) -> usize {
    match joint {
        JointSpec::Pin { .. } => 3,
        JointSpec::Clamp { .. } => 5,
    }
}

/// Masses, joints and loads over the nodes of a map.
struct Builder<'a> {
    map: &'a DofMap,
    structure: &'a mut Structure,
    q: &'a [f64],
}

impl Builder<'_> {
    fn support<'p>(&self, points: impl IntoIterator<Item = &'p Interpolation>) -> Support {
        let offsets = points.into_iter().flat_map(|p| p.terms.iter().map(|&(offset, _)| offset));
        let groups = self.map.groups_of(offsets);
        let unknowns = groups.iter().flat_map(|&g| self.structure.groups()[g].clone()).collect();
        Support { groups, unknowns }
    }

    /// Position and tangent of a point that must lie on a cable.
    fn cable_point(
        &self,
        point: &PointSpec,
        place: &str,
        reason: &'static str,
    ) -> Result<(Interpolation, Interpolation), ModelError> {
        match self.map.point(point, place)? {
            (r, Some(t)) => Ok((r, t)),
            _ => Err(ModelError::Unsupported { place: place.to_owned(), reason }),
        }
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

    fn joints(
        &mut self,
        spec: &ModelSpec,
        length: f64,
    ) -> Result<(Vec<PlacedJoint>, Vec<f64>), ModelError> {
        let mut joints = Vec::with_capacity(spec.joints.len());
        let mut scale = Vec::new();
        for joint in &spec.joints {
            let (name, joint) = self.joint(joint)?;
            let (first, m) = (scale.len(), joint.equations());
            scale.resize(first + m, 0.0);
            joint.scale(length, &mut scale[first..]);
            let unknowns = self.structure.velocities() + first;
            let mut groups = joint.support().groups.clone();
            groups.push(self.structure.add_group(unknowns..unknowns + m));
            let element = self.structure.add_element(&groups, Storage::Symmetric);
            joints.push(PlacedJoint { name, joint, first, element });
        }
        Ok((joints, scale))
    }

    fn joint(&self, joint: &JointSpec) -> Result<(String, Box<dyn Joint>), ModelError> {
        match joint {
            JointSpec::Pin { name, a, b } => {
                let place = format!("joint '{name}'");
                let (r_a, _) = self.map.point(a, &place)?;
                let (r_b, _) = self.map.point(b, &place)?;
                let support = self.support([&r_a, &r_b]);
                if support.groups.is_empty() {
                    let reason = "both its points are fixed in the world";
                    return Err(ModelError::Unsupported { place, reason });
                }
                Ok((name.clone(), Box::new(Pin::new(&r_a, &r_b, support))))
            }
            JointSpec::Clamp { name, a, direction } => {
                let place = format!("joint '{name}'");
                let reason = "a clamp needs a point of a cable, which has a tangent";
                let (r, t) = self.cable_point(a, &place, reason)?;
                let direction = match direction {
                    Some(direction) => vector(*direction),
                    None => vector(t.at(self.q)),
                };
                let direction = unit(direction, &place)?;
                let support = self.support([&r, &t]);
                let position = r.at(self.q);
                Ok((name.clone(), Box::new(Clamp::new(&r, &t, position, direction, support))))
            }
        }
    }

    fn load(&mut self, load: &LoadSpec) -> Result<PlacedLoad, ModelError> {
        let (load, value): (Box<dyn Load>, Value) = match load {
            LoadSpec::Force { name, at, value, follower } => {
                let place = format!("load '{name}'");
                let value = Value::new(value, &place)?;
                if *follower {
                    let reason = "a follower force needs a point of a cable, which has a tangent";
                    let (r, t) = self.cable_point(at, &place, reason)?;
                    let t_0 = unit(vector(t.at(self.q)), &place)?;
                    let support = self.support([&r, &t]);
                    (Box::new(FollowerForce::new(r, t, t_0, support)), value)
                } else {
                    (Box::new(DeadForce { r: self.map.point(at, &place)?.0 }), value)
                }
            }
            LoadSpec::Moment { name, at, value } => {
                let place = format!("load '{name}'");
                let reason = "a moment needs a point of a cable, which has a tangent";
                let (_, t) = self.cable_point(at, &place, reason)?;
                let support = self.support([&t]);
                (Box::new(Moment::new(t, support)), Value::new(value, &place)?)
            }
            LoadSpec::Line { name, cable, value } => {
                let place = format!("load '{name}'");
                (Box::new(self.line_load(*cable, &place)?), Value::new(value, &place)?)
            }
        };
        let element = load.support().map(|s| s.groups.clone());
        let element = element.map(|groups| self.structure.add_element(&groups, Storage::Full));
        Ok(PlacedLoad { load, value, element })
    }

    fn line_load(&self, cable: usize, place: &str) -> Result<LineLoad, ModelError> {
        let count = self.map.cables.len();
        let map = self.map.cables.get(cable).ok_or_else(|| ModelError::Reference {
            place: place.to_owned(),
            kind: "cable",
            index: cable,
            count,
        })?;
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
