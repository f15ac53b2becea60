//! What is read from a state after the solve: energies, momenta, strains, forces.

use crate::altered::Altered;
use crate::contact_coupling::run::Search;
use crate::joints::Joint;
use crate::latches::Switch;
use crate::model::{FacePlace, Model};
use crate::signal::Moment;
use crate::vector::vector;
use pliant_elements::materials::Regime;
use pliant_elements::{Block, CableBlock, Motion, Strain};
use std::collections::HashSet;

/// Part of energies that cancel which is rounding.
const CANCELLED: f64 = 1e-9;
/// Square of strains that are rounding.
const HUM: f64 = 1e-20;

impl Model {
    /// Kinetic, elastic and gravitational energy [J]; the last is zero at the origin.
    #[must_use]
    pub fn energy(&self, altered: &Altered, q: &[f64], v: &[f64]) -> [f64; 3] {
        let mut energy = self.energy_of_bodies(altered, q, v);
        if !self.contacts.is_empty() {
            energy[1] += self.contacts.energy(&mut Search::default(), q);
        }
        energy
    }

    /// The same without what is stored where bodies press on each other.
    pub(crate) fn energy_of_bodies(&self, altered: &Altered, q: &[f64], v: &[f64]) -> [f64; 3] {
        let mut energy = [0.0; 3];
        for (block, _) in self.blocks.iter_as(altered) {
            energy[0] += block.kinetic_energy(v);
            energy[1] += block.elastic_energy(q);
            energy[2] += block.gravitational_energy(q, self.gravity);
        }
        for mass in &self.masses {
            energy[0] += 0.5 * mass.mass * vector(mass.r.rate(v)).norm_squared();
            energy[2] -= mass.mass * vector(mass.r.at(q)).dot(&vector(self.gravity));
        }
        for body in &self.rigid_bodies {
            energy[0] += body.kinetic_energy(v);
            energy[2] += body.gravitational_energy(q, self.gravity);
        }
        energy
    }

    /// What is rounding in sums of energies that hold so much elastic and gravitational energy [J]: large ones cancel, and
    /// stiff lines at rest hum.
    pub(crate) fn rounding_of_energy(&self, elastic: f64, gravitational: f64) -> f64 {
        CANCELLED * (elastic.abs() + gravitational.abs()) + HUM * self.axial_energy
    }

    /// Linear momentum [kg m/s] and angular momentum about the origin [kg m^2/s].
    #[must_use]
    pub fn momentum(&self, q: &[f64], v: &[f64]) -> ([f64; 3], [f64; 3]) {
        let (mut linear, mut angular) = (vector([0.0; 3]), vector([0.0; 3]));
        for (block, _) in self.blocks.iter() {
            let momentum = block.momentum(q, v);
            linear += vector(momentum.linear);
            angular += vector(momentum.angular);
        }
        for mass in &self.masses {
            let p = vector(mass.r.rate(v)) * mass.mass;
            linear += p;
            angular += vector(mass.r.at(q)).cross(&p);
        }
        for body in &self.rigid_bodies {
            let (p, l) = body.momentum(q, v);
            linear += p;
            angular += l;
        }
        (linear.into(), angular.into())
    }

    /// Total mass [kg] and first moment about the origin [kg m].
    #[must_use]
    pub fn masses(&self, q: &[f64]) -> (f64, [f64; 3]) {
        let (mut total, mut moment) = (0.0, vector([0.0; 3]));
        for (block, _) in self.blocks.iter() {
            total += block.mass();
            moment += vector(block.first_moment(q));
        }
        for mass in &self.masses {
            total += mass.mass;
            moment += vector(mass.r.at(q)) * mass.mass;
        }
        for body in &self.rigid_bodies {
            total += body.mass;
            moment += body.first_moment(q);
        }
        (total, moment.into())
    }

    /// Mass of a cable [kg].
    #[must_use]
    pub fn cable_mass(&self, cable: usize) -> f64 {
        self.cable_masses[cable]
    }

    /// Block and number in it of each element of a cable.
    fn elements_of<'a>(
        &'a self,
        cable: usize,
        altered: &'a Altered,
    ) -> impl Iterator<Item = (&'a CableBlock, usize)> {
        let map = &self.map.cables[cable];
        self.strands[cable].iter().zip(&map.strands).flat_map(|(place, range)| {
            let block = self.blocks.cable(place.block, altered);
            (0..range.len()).map(move |i| (block, place.element + i))
        })
    }

    /// Appends the axial force at the middle of each element [N]: the elastic force along the tangent, per
    /// Green-Lagrange strain times the stretch.
    pub fn axial_force(&self, cable: usize, altered: &Altered, q: &[f64], out: &mut Vec<f64>) {
        out.extend(self.elements_of(cable, altered).map(|(block, e)| {
            let conjugate = block.axial_force(e, q);
            match block.law().strain {
                Strain::Biot => conjugate,
                Strain::GreenLagrange => {
                    conjugate * (1.0 + 2.0 * block.axial_strain(e, q)).max(0.0).sqrt()
                }
            }
        }));
    }

    /// Appends the axial strain at the middle of each element.
    pub fn axial_strain(&self, cable: usize, altered: &Altered, q: &[f64], out: &mut Vec<f64>) {
        out.extend(self.elements_of(cable, altered).map(|(block, e)| block.axial_strain(e, q)));
    }

    /// Appends the material curvature vector at the middle of each element [1/m].
    pub fn curvature(&self, cable: usize, altered: &Altered, q: &[f64], out: &mut Vec<f64>) {
        out.extend(self.elements_of(cable, altered).flat_map(|(block, e)| block.curvature(e, q)));
    }

    /// Appends membrane strain (E11, E22, E12), change of curvature (k11, k22, k12) [1/m] and regime (0 taut, 1
    /// wrinkled, 2 slack) at the middle of each face, seven numbers each.
    pub fn surface_strain(&self, surface: usize, q: &[f64], out: &mut Vec<f64>) {
        for place in &self.faces[surface] {
            let block = &self.blocks.surfaces[place.block].block;
            out.extend(block.membrane_strain(place.element, q));
            out.extend(block.bending_strain(place.element, q));
            out.push(match block.regime(place.element, q) {
                Regime::Taut => 0.0,
                Regime::Wrinkled => 1.0,
                Regime::Slack => 2.0,
            });
        }
    }

    /// Force [N] that the rest of a surface exerts on the faces that are `chosen`: what their inertia, weight and inner
    /// forces leave over at the nodes that they share with other faces.
    #[must_use]
    pub fn cut_force(
        &self,
        surface: usize,
        chosen: &[bool],
        [q, v, a]: [&[f64]; 3],
        gravity: [f64; 3],
    ) -> [f64; 3] {
        let positions = |place: &FacePlace| {
            let block = &self.blocks.surfaces[place.block].block;
            let step = block.surface_kind().vectors_per_node();
            block.vectors_of(place.element).iter().copied().step_by(step)
        };
        let faces = || self.faces[surface].iter().zip(chosen);
        let others: HashSet<u32> = faces()
            .filter(|&(_, chosen)| !chosen)
            .flat_map(|(place, _)| positions(place))
            .collect();
        let mut sum = [0.0; 3];
        for (place, _) in faces().filter(|&(place, &chosen)| {
            chosen && positions(place).any(|offset| others.contains(&offset))
        }) {
            let block = &self.blocks.surfaces[place.block].block;
            let force = block.element_force(place.element, Motion { q, v, a }, gravity);
            let vectors = force.chunks_exact(3).step_by(block.surface_kind().vectors_per_node());
            for (f, _) in vectors.zip(positions(place)).filter(|(_, o)| others.contains(o)) {
                for k in 0..3 {
                    sum[k] += f[k];
                }
            }
        }
        sum
    }

    /// Mass of a surface [kg].
    #[must_use]
    pub fn surface_mass(&self, surface: usize) -> f64 {
        let mass = |p: &FacePlace| self.blocks.surfaces[p.block].block.element_mass(p.element);
        self.faces[surface].iter().map(mass).sum()
    }

    /// First moment of mass of a surface about the origin [kg m].
    #[must_use]
    pub fn surface_moment(&self, surface: usize, q: &[f64]) -> [f64; 3] {
        let mut sum = [0.0; 3];
        for place in &self.faces[surface] {
            let moment =
                self.blocks.surfaces[place.block].block.element_first_moment(place.element, q);
            for k in 0..3 {
                sum[k] += moment[k];
            }
        }
        sum
    }

    /// Appends axial strain, shear along y and z, twist and curvature about y and z [1/m] of a beam and its axial force
    /// [N], in the middle of each element, seven numbers each.
    pub fn beam_strain(&self, beam: usize, q: &[f64], out: &mut Vec<f64>) {
        let block = &self.blocks.beams[beam].block;
        for e in 0..block.element_count() {
            let strain = block.strain(e, q);
            out.push(strain.axial);
            out.extend(strain.shear);
            out.extend(strain.curvature);
            out.push(block.axial_force(e, q));
        }
    }

    /// Mass of a beam [kg].
    #[must_use]
    pub fn beam_mass(&self, beam: usize) -> f64 {
        self.blocks.beams[beam].block.mass()
    }

    /// First moment of mass of a beam about the origin [kg m].
    #[must_use]
    pub fn beam_moment(&self, beam: usize, q: &[f64]) -> [f64; 3] {
        self.blocks.beams[beam].block.first_moment(q)
    }

    /// Force [N] and moment [N m] that a joint exerts on its first point; `switch` is what it engaged by, if it has.
    #[must_use]
    pub fn reaction(
        &self,
        joint: usize,
        t: f64,
        q: &[f64],
        lambda_: &[f64],
        switch: Option<&Switch>,
    ) -> ([f64; 3], [f64; 3]) {
        let placed = &self.joints[joint];
        let x: Vec<f64> = placed.joint.support().unknowns.iter().map(|&u| q[u]).collect();
        let m = placed.joint.equations();
        let posed = switch.and_then(|switch| self.posed(switch).ok());
        let joint: &dyn Joint = posed.as_deref().unwrap_or(placed.joint.as_ref());
        joint.reaction(Moment::at(t), &x, &lambda_[placed.first..placed.first + m])
    }

    /// The freedom of a joint and its rate (angle or way), if it leaves a single one.
    #[must_use]
    pub fn joint_motion(
        &self,
        joint: usize,
        q: &[f64],
        v: &[f64],
        switch: Option<&Switch>,
    ) -> Option<[f64; 2]> {
        let posed = switch.and_then(|switch| self.posed(switch).ok());
        let placed = self.joints[joint].joint.as_ref();
        let joint: &dyn Joint = posed.as_deref().unwrap_or(placed);
        let local = |x: &[f64]| joint.support().unknowns.iter().map(|&u| x[u]).collect::<Vec<_>>();
        joint.motion(&local(q), &local(v))
    }

    /// Force [N] that everything else exerts on a node of a cable: what its own elements' inertia, weight and
    /// inner forces leave over.
    #[must_use]
    pub fn nodal_force(
        &self,
        cable: usize,
        node: usize,
        altered: &Altered,
        [q, v, a]: [&[f64]; 3],
    ) -> [f64; 3] {
        let map = &self.map.cables[cable];
        let motion = Motion { q, v, a };
        let mut force = [0.0; 3];
        for (k, place) in self.strands[cable].iter().enumerate() {
            let nodes = map.strand_nodes(k);
            if !nodes.contains(&node) {
                continue;
            }
            let local = node - nodes.start;
            let block = self.blocks.cable(place.block, altered);
            let after = (node + 1 < nodes.end).then_some((local, 0));
            let before = local.checked_sub(1).map(|e| (e, 6));
            for (e, first) in [before, after].into_iter().flatten() {
                let f = block.element_force(place.element + e, motion, self.gravity);
                for k in 0..3 {
                    force[k] += f[first + k];
                }
            }
        }
        force
    }
}
