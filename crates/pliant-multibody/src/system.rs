//! A run of a model: the [`Problem`] that the integrator sees.

mod chambers;
mod contact;
mod forces;
mod growth;
mod judge;
mod lengths;
mod plastic;
mod time;
mod window;

use crate::altered::{Altered, LEAD};
use crate::contact_coupling::coupled::Coupled;
use crate::contact_coupling::run::Search;
use crate::error::ModelError;
use crate::forces::Part;
use crate::joints::Joint;
use crate::latches::{CLOSE, Joints, Scheduled, Switch};
use crate::memory::Memory;
use crate::model::{Model, PlacedForce};
use crate::signal::Moment;
use forces::{Room, gather};
pub use growth::{Chosen, Growth};
pub use judge::Liveliest;
use pliant_dae::error::Error;
use pliant_dae::linear_solver::LinearSolver;
use pliant_dae::problem::{EvaluationError, Kinks, Point, Problem, Weights};
use pliant_dae::redundancy::smallest_multipliers;
use pliant_dae::structure::{Storage, Structure, entries, entry_number};
use pliant_elements::{self as elements, Motion, Parameter, Workspace};
use std::sync::Arc;
use window::Window;

/// What the caller's functions of time return at a time, all components one after the other.
pub type Inputs = Box<dyn FnMut(f64) -> Result<Vec<f64>, String> + Send>;

/// What time means.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mode {
    /// Time [s].
    Dynamic,
    /// The load factor, by which gravity and constant loads are scaled.
    Static,
}

/// Scratch memory for small dense work.
#[derive(Default)]
struct Scratch {
    x: Vec<f64>,
    phi: Vec<f64>,
    jacobian: Vec<f64>,
    hessian: Vec<f64>,
    /// Zeros.
    rest: Vec<f64>,
}

/// A run of a model: its inputs, scratch memory and integrals over time.
pub struct System {
    model: Arc<Model>,
    inputs: Option<Inputs>,
    mode: Mode,
    growth: Growth,
    parallel: bool,
    memory: Memory,
    workspaces: Vec<Workspace>,
    input_time: Option<f64>,
    input_values: Vec<f64>,
    /// Their derivatives, where they were last asked for.
    input_rates: Vec<Vec<f64>>,
    /// Integrals of signals up to that time.
    integrals: Vec<f64>,
    scratch: Scratch,
    room: Room,
    joints: Joints,
    altered: Altered,
    /// Rates of the inputs.
    rates: Vec<f64>,
    /// Generalized forces at the next accepted point.
    forces: Vec<f64>,
    /// Who touches whom, and the structure that follows it.
    search: Search,
    coupled: Coupled,
    /// Time and energy of the last accepted point.
    noted_energy: Option<(f64, [f64; 3])>,
    judged: judge::Judged,
    /// Whether bodies in contact slide freely.
    frictionless: bool,
}

impl System {
    /// A run of `model`: with `inputs` for functions of time, a meaning of time, and blocks worked on by all
    /// threads of the present rayon pool where `parallel`.
    #[must_use]
    pub fn new(model: Arc<Model>, mode: Mode, inputs: Option<Inputs>, parallel: bool) -> Self {
        let workspaces = model.blocks.iter().map(|_| Workspace::default()).collect();
        let joints = Joints::new(&model, &[], &[]);
        let mut altered = Altered::new(&model);
        if mode == Mode::Static {
            altered.set_lead(LEAD);
        }
        let coupled = Coupled::new(&model.structure);
        Self {
            model,
            joints,
            inputs,
            mode,
            growth: Growth::default(),
            parallel,
            memory: Memory::default(),
            workspaces,
            input_time: None,
            input_values: Vec::new(),
            input_rates: Vec::new(),
            integrals: Vec::new(),
            scratch: Scratch::default(),
            room: Room::default(),
            altered,
            rates: Vec::new(),
            forces: Vec::new(),
            search: Search::default(),
            coupled,
            noted_energy: None,
            judged: judge::Judged::default(),
            frictionless: false,
        }
    }

    /// The model.
    #[must_use]
    pub fn model(&self) -> &Arc<Model> {
        &self.model
    }

    /// Tells what the load factor acts on; everything unless told.
    pub fn set_growth(&mut self, growth: Growth) {
        self.growth = growth;
    }

    /// What a continuation needs beside the state.
    #[must_use]
    pub fn memory(&self) -> &Memory {
        &self.memory
    }

    /// Goes back to what was remembered.
    pub fn set_memory(&mut self, memory: Memory) {
        self.joints = Joints::new(&self.model, &memory.history, &memory.redundant);
        self.memory = memory;
        self.altered.set_past(&self.model, &self.memory.past);
        self.noted_energy = None;
        self.show_held();
    }

    /// Engages or releases a joint at coordinates `q`; returns whether that changes anything. The integrator must
    /// restart then.
    ///
    /// # Errors
    /// Points too far apart, or directions that the joint cannot take.
    pub fn switch(&mut self, event: Scheduled, q: &[f64]) -> Result<bool, ModelError> {
        let Scheduled { t, joint, engage, gap } = event;
        if self.joints.is_engaged(joint) == engage {
            return Ok(false);
        }
        let gap = gap.unwrap_or(CLOSE * self.model.length);
        if engage && !self.model.joint_specs[joint].is_drive() {
            self.model.engaged(joint, q, gap)?;
        }
        let unknowns = &self.model.joints[joint].joint.support().unknowns;
        let pose = unknowns.iter().map(|&u| q[u]).collect();
        self.memory.history.push(Switch { t, joint, engaged: engage, gap, pose });
        self.memory.redundant.clear();
        self.joints = Joints::new(&self.model, &self.memory.history, &[]);
        // Dissipation begins anew: velocities jump.
        self.memory.damping.clear();
        self.noted_energy = None;
        self.memory.transit = None;
        Ok(true)
    }

    /// The first joint that has left what it moves on, and how.
    #[must_use]
    pub fn strayed(&self, q: &[f64]) -> Option<String> {
        if self.model.map.slides.is_empty() {
            return None;
        }
        let mut x = Vec::new();
        self.model.joints.iter().filter(|placed| !placed.windows.is_empty()).find_map(|placed| {
            gather(placed.joint.support(), q, &mut x);
            let how = placed.joint.strayed(&x)?;
            Some(format!("joint '{}': {how}", placed.name))
        })
    }

    /// Adds an impact to the audit: velocities jump by `dv` to `after`. What is lost is the energy of the jump; the
    /// rest of the change is the work of joints that move by themselves.
    pub fn note_impact(&mut self, q: &[f64], before: &[f64], after: &[f64]) {
        let dv: Vec<f64> = after.iter().zip(before).map(|(a, b)| a - b).collect();
        let kinetic = |v: &[f64]| self.model.energy(&self.altered, q, v)[0];
        let lost = kinetic(&dv);
        let gained = kinetic(after) - kinetic(before);
        self.memory.audit.dissipated += lost;
        self.memory.audit.work += gained + lost;
    }

    /// The next scheduled event.
    #[must_use]
    pub fn next_event(&self) -> Option<Scheduled> {
        self.model.schedule.get(self.memory.events).copied()
    }

    /// Whether an event changes nothing.
    pub(crate) fn is_already(&self, event: &Scheduled) -> bool {
        self.joints.is_engaged(event.joint) == event.engage
    }

    /// A scheduled event is over.
    pub(crate) fn skip_event(&mut self) {
        self.memory.events += 1;
    }

    /// The smallest multipliers that act as `lambda_` does, see
    /// [`pliant_dae::redundancy::smallest_multipliers`]; `solver` is the caller's own.
    pub(crate) fn smallest_multipliers(
        &mut self,
        solver: &mut dyn LinearSolver,
        t: f64,
        q: &[f64],
        lambda_: &mut [f64],
    ) {
        let kept = self.memory.clone();
        let pressures: Vec<f64> = self.model.compliant.iter().map(|&k| lambda_[k]).collect();
        // Where it fails the multipliers stay as they are: they are right, too.
        let _ = smallest_multipliers(self, solver, t, q, lambda_, &kept.redundant);
        for (&k, pressure) in self.model.compliant.iter().zip(pressures) {
            lambda_[k] = pressure;
        }
        self.set_memory(kept);
    }

    /// Largest residual, in units of its scale, of an equation that is left out because it follows from others.
    #[must_use]
    pub fn drift(&self, t: f64, q: &[f64]) -> f64 {
        let mut drift: f64 = 0.0;
        let (mut x, mut phi) = (Vec::new(), Vec::new());
        if self.memory.redundant.is_empty() {
            return drift;
        }
        for (k, placed) in self.model.joints.iter().enumerate() {
            let joint = self.joints.get(&self.model, k);
            let rows = placed.first..placed.first + joint.equations();
            if !self.joints.is_engaged(k) || !self.memory.redundant[rows.clone()].contains(&true) {
                continue;
            }
            gather(joint.support(), q, &mut x);
            phi.resize(rows.len(), 0.0);
            let now = Moment { memory: self.memory.of(placed), ..self.moment(t) };
            joint.residual(now, &x, &mut phi);
            for (i, phi) in rows.zip(&phi) {
                if self.memory.redundant[i] {
                    drift = drift.max(phi.abs() / self.model.constraint_scale[i]);
                }
            }
        }
        drift
    }

    /// Sets inputs from number `first` on: they hold at the end of the next step and from there on.
    ///
    /// # Errors
    /// As many as the inputs there are after `first`, where `values` are more.
    pub fn set_held(&mut self, first: usize, values: &[f64]) -> Result<(), Error> {
        let count = self.memory.held.len();
        match self.memory.held.get_mut(first..first + values.len()) {
            Some(slots) => slots.copy_from_slice(values),
            None => {
                let (got, expected) = (values.len(), count.saturating_sub(first));
                return Err(Error::Length { what: "values of inputs", expected, got });
            }
        }
        self.show_held();
        Ok(())
    }

    /// Makes the held values those that signals see, until the caller's functions are asked again.
    fn show_held(&mut self) {
        self.input_values.clear();
        self.input_values.extend_from_slice(&self.memory.held);
        self.input_time = None;
    }

    /// The moment that the constants of a load see.
    fn moment_of(&self, load: usize, t: f64) -> Moment<'_> {
        match self.mode {
            Mode::Dynamic => self.moment(t),
            Mode::Static => Moment { constants: self.growth.of_load(load, t), ..self.moment(t) },
        }
    }

    fn gravity_at(&self, t: f64) -> [f64; 3] {
        match self.mode {
            Mode::Dynamic => self.model.gravity,
            Mode::Static => self.model.gravity.map(|g| self.growth.of_gravity(t) * g),
        }
    }

    /// Begins to gather work: notes the loads at the start.
    pub fn note_loads(&mut self, at: Point<'_>) {
        self.note_given(at);
        self.begin_contact(at);
        if !self.model.has_work() {
            return;
        }
        let mut force = vec![0.0; at.q.len()];
        // Functions of time that fail here fail in the step itself.
        if self.refresh(at.t).is_ok() {
            self.working_forces(at, &mut force);
            self.memory.potential = self.changing_energy(at.t, at.q, at.v);
        }
        self.memory.loads = force;
    }

    /// Adds what does work from outside: loads, drives, and forces whose stored energy changes in time.
    fn working_forces(&mut self, at: Point<'_>, force: &mut [f64]) {
        self.load_forces(at.t, at.q, 1.0, force);
        self.drive_forces(at, force);
        self.flowing_forces(at, force);
        let chosen = |placed: &PlacedForce, part| match part {
            Part::Stored => placed.force.is_rheonomic(),
            Part::Dissipated => false,
            Part::Work => true,
        };
        self.add_forces((at.t, at.q, at.v), 1.0, chosen, force);
    }

    /// Kinetic, elastic and gravitational energy at the last accepted point [J].
    #[must_use]
    pub fn energy(&self, t: f64, q: &[f64], v: &[f64]) -> [f64; 3] {
        if let Some((noted, energy)) = self.noted_energy
            && noted == t
        {
            return energy;
        }
        let contact = &self.memory.contact;
        let known = !contact.totals.is_empty() || !contact.probes.totals.is_empty();
        let apart = known && !contact.has_touched();
        let mut energy = if apart || self.model.contacts.is_empty() {
            self.model.energy_of_bodies(&self.altered, q, v)
        } else {
            self.model.energy(&self.altered, q, v)
        };
        energy[1] += self.model.stored_energy(self.moment(t), q, v);
        energy[1] += self.model.gas_energy(self.moment(t), q, false);
        energy
    }

    /// Makes sure that the inputs are those of a time, before energy and outputs are read there.
    pub fn look_at(&mut self, t: f64) {
        // Functions of time that fail here have failed in the step itself.
        let _ = self.refresh(t);
    }

    fn load_forces(&self, t: f64, q: &[f64], factor: f64, force: &mut [f64]) {
        for (number, load) in self.model.loads.iter().enumerate() {
            let now = self.moment_of(number, t);
            load.load.add_force(now, load.value.at(now), q, factor, force);
        }
    }

    /// What damping adds to the inner forces.
    fn damping_forces(&mut self, t: f64, q: &[f64], v: &[f64], force: &mut [f64]) {
        self.add_forces((t, q, v), -1.0, |_, part| part == Part::Dissipated, force);
        self.add_contact((t, q, v), contact::Part::Dissipated, force);
        let mut rest = std::mem::take(&mut self.scratch.rest);
        rest.resize(v.len(), 0.0);
        // What is left at rest, winches included, is elastic.
        let lengths = self.altered.lengths.clone();
        self.altered.stop(&self.model);
        for f in force.iter_mut() {
            *f = -*f;
        }
        self.damped_blocks(Motion { q, v: &rest, a: &rest }, force);
        for f in force.iter_mut() {
            *f = -*f;
        }
        for (winch, length) in lengths.into_iter().enumerate() {
            self.altered.set(&self.model, winch, length);
        }
        self.damped_blocks(Motion { q, v, a: &rest }, force);
        self.scratch.rest = rest;
    }

    /// Adds the inner forces of blocks with damping.
    fn damped_blocks(&mut self, motion: Motion<'_>, force: &mut [f64]) {
        let blocks = self.model.blocks.iter_as(&self.altered).zip(&mut self.workspaces);
        for ((block, _), workspace) in blocks.filter(|((block, _), _)| block.has_damping()) {
            block.residual(motion, [0.0; 3], workspace, force, self.parallel);
        }
    }

    /// Calls `work` with each joint that holds, the time it sees, its local coordinates and its range of equations.
    fn each_joint(
        &mut self,
        t: f64,
        q: &[f64],
        mut work: impl FnMut(&dyn Joint, Moment<'_>, &[f64], std::ops::Range<usize>),
    ) {
        let mut x = std::mem::take(&mut self.scratch.x);
        let now = self.moment(t);
        for (k, placed) in self.model.joints.iter().enumerate() {
            if self.joints.is_engaged(k) {
                let joint = self.joints.get(&self.model, k);
                gather(joint.support(), q, &mut x);
                let now = Moment { memory: self.memory.of(placed), ..now };
                work(joint, now, &x, placed.first..placed.first + joint.equations());
            }
        }
        self.scratch.x = x;
    }

    /// Clears the rows that read `lambda_ = 0`.
    fn clear_idle(&self, out: &mut [f64]) {
        for (out, off) in out.iter_mut().zip(self.joints.off()) {
            if *off {
                *out = 0.0;
            }
        }
    }

    /// Tangents of all but the blocks.
    fn other_tangents(&mut self, at: Point<'_>, weights: Weights, values: &mut [f64]) {
        self.mass_tangents(weights.mass, values);
        self.rigid_tangents(weights.mass, values);
        self.joint_tangents(at, weights, values);
        self.load_tangents(at, weights.stiffness, values);
        self.force_tangents(at, weights, values);
        self.contact_tangents(at, weights, values);
        self.chamber_tangents(at, weights, values);
    }

    /// Clears the rows of compliant equations, which ask for no velocities or accelerations.
    fn clear_compliant(&self, out: &mut [f64]) {
        for &k in &self.model.compliant {
            out[k] = 0.0;
        }
    }

    /// Tangents of the blocks; where `predicted`, `at.v` is an increment, and velocities are zero.
    fn block_tangents(
        &mut self,
        at: Point<'_>,
        weights: Weights,
        predicted: bool,
        values: &mut [f64],
    ) {
        let motion = Motion { q: at.q, v: at.v, a: at.a };
        let rest = if predicted { at.a } else { at.v };
        let weights = elements::Weights {
            mass: weights.mass,
            damping: weights.damping,
            stiffness: weights.stiffness,
        };
        for (block, range) in self.model.blocks.iter_as(&self.altered) {
            let values = &mut values[range.clone()];
            if predicted && block.predicts() {
                block.predicted_tangent(motion, weights, values, self.parallel);
            } else {
                block.tangent(Motion { v: rest, ..motion }, weights, values, self.parallel);
            }
        }
    }

    fn mass_tangents(&self, weight: f64, values: &mut [f64]) {
        for mass in &self.model.masses {
            let n = mass.support.unknowns.len();
            let slot = self.model.structure.slot(mass.element);
            for number in 0..n * (n + 1) / 2 {
                values[slot.base + number * slot.stride] = 0.0;
            }
            for &(o_i, w_i) in &mass.r.terms {
                for &(o_j, w_j) in &mass.r.terms {
                    let (i, j) = (mass.support.local(o_i), mass.support.local(o_j));
                    for k in 0..3 {
                        if i >= j {
                            let number = entry_number(n, i + k, j + k, Storage::Symmetric);
                            values[slot.base + number * slot.stride] +=
                                weight * mass.mass * w_i * w_j;
                        }
                    }
                }
            }
        }
    }

    fn rigid_tangents(&self, weight: f64, values: &mut [f64]) {
        for body in &self.model.rigid_bodies {
            let slot = self.model.structure.slot(body.element);
            for i in 0..12 {
                for j in 0..=i {
                    let same = f64::from(u8::from(i % 3 == j % 3));
                    let number = entry_number(12, i, j, Storage::Symmetric);
                    values[slot.base + number * slot.stride] =
                        weight * same * body.weight(i / 3, j / 3);
                }
            }
        }
    }

    fn joint_tangents(&mut self, at: Point<'_>, weights: Weights, values: &mut [f64]) {
        let mut x = std::mem::take(&mut self.scratch.x);
        let mut jacobian = std::mem::take(&mut self.scratch.jacobian);
        let mut hessian = std::mem::take(&mut self.scratch.hessian);
        let (now, off) = (self.moment(at.t), self.joints.off());
        for (k, placed) in self.model.joints.iter().enumerate() {
            let joint = self.joints.get(&self.model, k);
            gather(joint.support(), at.q, &mut x);
            let (n, m) = (x.len(), joint.equations());
            if !placed.windows.is_empty() {
                let window = Window { placed, joint, off: &off[placed.first..placed.first + m] };
                window.tangents(
                    &self.model.structure,
                    (at, now, &x),
                    weights,
                    &mut jacobian,
                    values,
                );
                continue;
            }
            jacobian.clear();
            jacobian.resize(n * m, 0.0);
            hessian.clear();
            hessian.resize(n * n, 0.0);
            if self.joints.is_engaged(k) {
                let now = Moment { memory: self.memory.of(placed), ..now };
                joint.jacobian(now, &x, &mut jacobian);
                let lambda_ = &at.lambda_[placed.first..placed.first + m];
                joint.add_hessian(now, &x, lambda_, weights.stiffness, &mut hessian);
            }
            let slot = self.model.structure.slot(placed.element);
            let mut set = |i: usize, j: usize, value: f64| {
                let number = entry_number(n + m, i, j, Storage::Symmetric);
                values[slot.base + number * slot.stride] = value;
            };
            for i in 0..n {
                for j in 0..=i {
                    set(i, j, hessian[i * n + j]);
                }
            }
            for i in 0..m {
                let idle = off[placed.first + i];
                for j in 0..n {
                    set(n + i, j, if idle { 0.0 } else { weights.jacobian * jacobian[i * n + j] });
                }
                for j in 0..=i {
                    set(n + i, n + j, if idle && j == i { -weights.jacobian } else { 0.0 });
                }
            }
        }
        self.scratch.x = x;
        self.scratch.jacobian = jacobian;
        self.scratch.hessian = hessian;
    }

    fn load_tangents(&self, at: Point<'_>, weight: f64, values: &mut [f64]) {
        let mut full = Vec::new();
        for (number, load) in self.model.loads.iter().enumerate() {
            let value = load.value.at(self.moment_of(number, at.t));
            let parts = load.elements.iter().zip(load.load.supports());
            for (part, (&element, support)) in parts.enumerate() {
                let slot = self.model.structure.slot(element);
                let n = support.unknowns.len();
                let out = &mut values[slot.base..slot.base + entries(n, slot.storage)];
                if slot.storage == Storage::Full {
                    load.load.jacobian(part, value, at.q, -weight, out);
                    continue;
                }
                full.resize(n * n, 0.0);
                load.load.jacobian(part, value, at.q, -weight, &mut full);
                for i in 0..n {
                    for j in 0..=i {
                        let mean = 0.5 * (full[i * n + j] + full[j * n + i]);
                        out[entry_number(n, i, j, Storage::Symmetric)] = mean;
                    }
                }
            }
        }
    }
}

impl Problem for System {
    fn coordinates(&self) -> usize {
        self.model.map.coordinates
    }

    fn velocities(&self) -> usize {
        self.model.map.coordinates
    }

    fn multipliers(&self) -> usize {
        self.model.multipliers
    }

    fn structure(&self) -> &Structure {
        &self.coupled.structure
    }

    fn scale(&self) -> &[f64] {
        &self.model.scale
    }

    fn error_scale(&self) -> Vec<f64> {
        self.model.error_scale()
    }

    fn constraint_scale(&self) -> &[f64] {
        &self.model.constraint_scale
    }

    /// Follower forces and moments have none.
    fn has_potential(&self) -> bool {
        self.model.loads.iter().all(|l| l.load.has_potential())
            && self.model.forces.iter().all(|f| f.force.has_potential())
    }

    fn has_damping(&self) -> bool {
        !self.model.contacts.is_empty()
            || self.model.blocks.iter().any(|(block, _)| block.has_damping())
            || self.model.forces.iter().any(|f| f.force.has_damping())
    }

    /// Films that wrinkle, and cables that yield; contact.
    fn kinks(&self) -> Kinks {
        let mut surfaces = self.model.blocks.surfaces.iter();
        if !self.model.plastic.is_empty() || surfaces.any(|p| p.block.law().material.is_one_sided())
        {
            Kinks::Many
        } else if self.model.contacts.is_empty() {
            Kinks::None
        } else {
            Kinks::Few
        }
    }

    fn residual(
        &mut self,
        at: Point<'_>,
        force: &mut [f64],
        phi: &mut [f64],
    ) -> Result<(), EvaluationError> {
        self.refresh(at.t)?;
        self.refuse_wild(at.q)?;
        force.fill(0.0);
        let gravity = self.gravity_at(at.t);
        let motion = Motion { q: at.q, v: at.v, a: at.a };
        for ((block, _), workspace) in
            self.model.blocks.iter_as(&self.altered).zip(&mut self.workspaces)
        {
            block.residual(motion, gravity, workspace, force, self.parallel);
        }
        for mass in &self.model.masses {
            let a = mass.r.rate(at.a);
            let f = [0, 1, 2].map(|k| mass.mass * (a[k] - gravity[k]));
            mass.r.add_force(f, force);
        }
        for body in &self.model.rigid_bodies {
            body.add_residual(at.a, gravity, force);
        }
        for (f, fading) in force.iter_mut().zip(&self.growth.fading) {
            *f -= (1.0 - at.t) * fading;
        }
        self.load_forces(at.t, at.q, -1.0, force);
        self.add_forces((at.t, at.q, at.v), -1.0, |_, _| true, force);
        self.add_contact((at.t, at.q, at.v), contact::Part::All, force);
        let mut jacobian = std::mem::take(&mut self.scratch.jacobian);
        self.each_joint(at.t, at.q, |joint, now, x, equations| {
            joint.residual(now, x, &mut phi[equations.clone()]);
            let n = x.len();
            jacobian.resize(n * equations.len(), 0.0);
            joint.jacobian(now, x, &mut jacobian);
            for (i, row) in equations.zip(jacobian.chunks_exact(n)) {
                for (&u, entry) in joint.support().unknowns.iter().zip(row) {
                    force[u] += entry * at.lambda_[i];
                }
            }
        });
        self.scratch.jacobian = jacobian;
        self.chamber_residuals(at, force, phi);
        self.clear_idle(phi);
        Ok(())
    }

    fn tangent(&mut self, at: Point<'_>, weights: Weights, values: &mut Vec<f64>) {
        // A failing function of time fails in the residual, too.
        let _ = self.refresh(at.t);
        self.follow_contact(at.q);
        values.resize(self.structure().values(), 0.0);
        self.memory.note_tangent();
        self.block_tangents(at, weights, false, values);
        self.other_tangents(at, weights, values);
    }

    fn predicts(&self) -> bool {
        self.model.blocks.iter().any(|(block, _)| block.predicts())
    }

    /// At rest the accelerations are zeros as long as the velocities.
    fn predicted_tangent(&mut self, at: Point<'_>, weights: Weights, values: &mut Vec<f64>) {
        let _ = self.refresh(at.t);
        self.follow_contact(at.q);
        values.resize(self.structure().values(), 0.0);
        self.memory.note_tangent();
        self.block_tangents(at, weights, true, values);
        self.other_tangents(Point { v: at.a, ..at }, weights, values);
    }

    /// Bodies must not have passed through each other, nor may the step have made energy.
    fn judge(
        &mut self,
        before: Point<'_>,
        after: Point<'_>,
        part: f64,
    ) -> Result<(), EvaluationError> {
        self.judge_step(before, after, part)
    }

    fn way(&mut self, q: &[f64], increment: &[f64]) -> (f64, Option<String>) {
        self.way_of_contact(q, increment)
    }

    fn constraint_acceleration(&mut self, at: Point<'_>, out: &mut [f64]) {
        self.refresh_rates(at.t);
        let mut v = std::mem::take(&mut self.scratch.phi);
        self.each_joint(at.t, at.q, |joint, now, x, equations| {
            gather(joint.support(), at.v, &mut v);
            joint.acceleration(now, x, &v, &mut out[equations]);
        });
        self.scratch.phi = v;
        self.clear_compliant(out);
        self.clear_idle(out);
    }

    fn constraint_jerk(&mut self, at: Point<'_>, out: &mut [f64]) {
        self.refresh_rates(at.t);
        let mut v = std::mem::take(&mut self.scratch.phi);
        let mut a = std::mem::take(&mut self.scratch.jacobian);
        self.each_joint(at.t, at.q, |joint, now, x, equations| {
            gather(joint.support(), at.v, &mut v);
            gather(joint.support(), at.a, &mut a);
            joint.jerk(now, x, &v, &a, &mut out[equations]);
        });
        self.scratch.phi = v;
        self.scratch.jacobian = a;
        self.clear_compliant(out);
        self.clear_idle(out);
    }

    fn constraint_rate(&mut self, t: f64, q: &[f64], out: &mut [f64]) {
        self.refresh_rates(t);
        self.each_joint(t, q, |joint, now, x, equations| joint.rate(now, x, &mut out[equations]));
        self.clear_compliant(out);
        self.clear_idle(out);
    }

    fn idle(&self) -> &[bool] {
        self.joints.off()
    }

    fn compliant(&self) -> &[usize] {
        &self.model.compliant
    }

    fn determine(&mut self, t: f64, q: &[f64], lambda_: &mut [f64]) {
        if !self.model.chambers.is_empty() {
            self.determine_pressures(t, q, lambda_);
        }
    }

    fn leave_out(&mut self, equations: &[bool]) {
        self.memory.redundant.clear();
        if equations.contains(&true) {
            self.memory.redundant.extend_from_slice(equations);
        }
        self.joints.set_redundant(&self.model, &self.memory.redundant);
    }

    /// Rigidity first: what a joint asks for beyond it may be redundant.
    fn constraint_order(&self) -> Vec<usize> {
        let rigidity = self.model.joints.get(self.model.latches.len()).map_or(0, |j| j.first);
        let all = self.model.multipliers;
        let rigid = if self.model.rigid_bodies.is_empty() { all..all } else { rigidity..all };
        rigid.clone().chain(0..rigid.start).collect()
    }

    fn owner(&self, multiplier: usize) -> String {
        match self.model.joint_of(multiplier) {
            Some(k) => format!("joint '{}'", self.model.joints[k].name),
            None => match self.model.chambers.iter().find(|c| c.multiplier == multiplier) {
                Some(chamber) => format!("chamber '{}'", chamber.name),
                None => format!("multiplier {multiplier}"),
            },
        }
    }

    /// Work of loads and dissipation: mean of the forces at both ends of the step times its displacement. Second
    /// order, and exact also where damping brings a jump of velocity to rest within the step, whose power at the
    /// ends says nothing about the time between.
    fn accept(&mut self, before: Point<'_>, after: Point<'_>) {
        self.memory.audit.dissipated += self.plastic_work(after);
        if self.has_damping() {
            let known = self.judged.loss.take().filter(|&(t, ..)| t == after.t);
            let noted = std::mem::take(&mut self.memory.damping);
            let (_, lost, noted) = known.unwrap_or_else(|| self.loss_of_step(noted, before, after));
            self.memory.audit.dissipated += lost;
            self.memory.damping = noted;
        }
        if self.model.has_work() {
            let known = self.judged.work.take().filter(|&(t, ..)| t == after.t);
            let noted = std::mem::take(&mut self.memory.loads);
            let (_, work, noted) = known.unwrap_or_else(|| self.work_of_step(noted, before, after));
            self.memory.audit.work += work;
            self.memory.loads = noted;
            let potential = self.changing_energy(after.t, after.q, after.v);
            self.memory.audit.work += potential - self.memory.potential;
            self.memory.potential = potential;
        }
        self.accept_given(before, after);
        self.remember(after);
        self.accept_contact(after);
        self.flow_to(after.t, after.q);
    }

    fn equilibrium(&mut self, at: Point<'_>) {
        self.remember(at);
        self.flow_to(at.t, at.q);
        self.begin_contact(at);
    }

    /// Three for each cable: factors of its axial stiffness, bending stiffness and mass per length; then one for each
    /// load: a factor of its value; then one for each force: a factor of all that it exerts.
    fn parameters(&self) -> usize {
        3 * self.model.strands.len() + self.model.loads.len() + self.model.forces.len()
    }

    fn parameter_derivative(
        &mut self,
        at: Point<'_>,
        p: usize,
        force: &mut [f64],
        phi: &mut [f64],
    ) {
        force.fill(0.0);
        phi.fill(0.0);
        if let Some(strands) = self.model.strands.get(p / 3) {
            let parameter =
                [Parameter::AxialStiffness, Parameter::BendingStiffness, Parameter::MassPerLength]
                    [p % 3];
            let motion = Motion { q: at.q, v: at.v, a: at.a };
            for strand in strands {
                let block = self.model.blocks.cable(strand.block, &self.altered);
                let gravity = self.gravity_at(at.t);
                let cable = Some(strand.cable);
                block.add_parameter_derivative(parameter, cable, motion, gravity, force);
            }
            return;
        }
        let p = p - 3 * self.model.strands.len();
        if let Some(load) = self.model.loads.get(p) {
            let now = self.moment(at.t);
            load.load.add_force(now, load.value.at(now), at.q, -1.0, force);
        } else if let Some(chosen) = self.model.forces.get(p - self.model.loads.len()) {
            let element = chosen.element;
            let only = |placed: &PlacedForce, _| placed.element == element;
            self.add_forces((at.t, at.q, at.v), -1.0, only, force);
        }
    }

    fn describe(&self, unknown: usize) -> String {
        if unknown < self.model.map.coordinates {
            return self.model.describe(unknown);
        }
        let multiplier = unknown - self.model.map.coordinates;
        let joint = self.model.joint_of(multiplier).map(|k| &self.model.joints[k]);
        match joint {
            Some(joint) => format!("joint '{}', equation {}", joint.name, multiplier - joint.first),
            None => self.owner(multiplier),
        }
    }
}
