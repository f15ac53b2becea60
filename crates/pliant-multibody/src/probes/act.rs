//! What follows where probes touch: forces, tangents, energy, and what is remembered.

use super::couple::Coupling;
use super::find::{Blend, Found, Mark, Meets, Touch};
use super::memory::{Crossed, Patch, Spot};
use super::onto::key;
use super::{Facing, Probes, Side};
use crate::contact_coupling::memory::{Bristle, ContactMemory, bristle};
use crate::contact_coupling::run::{At, Part};
use nalgebra::{Matrix3, Vector3};
use pliant_contact::point::{Laws, Motion};
use pliant_contact::probe::{Blocks, Force, Slave};
use pliant_dae::structure::{Storage, entries, entry_number};

/// Points of a way through a shape that are looked at.
const SAMPLES: usize = 8;
/// Part of a body's size within which a point without a number is the one of the last step.
const SAME: f64 = 0.5;

type Vectors = [Vector3<f64>; 8];

fn vector(x: &[f64], o: usize) -> Vector3<f64> {
    Vector3::new(x[o], x[o + 1], x[o + 2])
}

impl Facing {
    /// The eight vectors of a probe, of coordinates or velocities: those of a thin slave are one.
    fn gather(&self, touch: &Touch, x: &[f64]) -> Vectors {
        let mut out = [Vector3::zeros(); 8];
        let [slave, master] = self.bodies();
        match slave {
            Some(own) => (0..4).for_each(|k| out[k] = vector(x, own[k])),
            None => self.each_term(touch, |_, o, w| out[0] += vector(x, o) * w),
        }
        if let Some(other) = master {
            (0..4).for_each(|k| out[4 + k] = vector(x, other[k]));
        }
        self.each_nodal(touch, |_, o, w| {
            let x = vector(x, o);
            (0..3).for_each(|d| out[4 + d] += x * w[d]);
        });
        out
    }

    /// Calls `work` with number, coordinate and weights in r, r_u and r_v of the nodal vectors of the face touched.
    pub(super) fn each_nodal(&self, touch: &Touch, mut work: impl FnMut(usize, usize, &[f64; 3])) {
        if let (Meets::Face(_, ground), Side::Sheet(faces)) = (&touch.meets, &self.master) {
            let offsets = &faces[ground.face].offsets;
            for (i, (&o, w)) in offsets.iter().zip(&ground.weights).enumerate() {
                work(i, o, w);
            }
        }
    }

    /// Whether a point of the slave has been inside the master on its way and left on another side. Of rigid bodies the
    /// centre stands for all.
    fn has_passed(&self, before: &[f64], after: &[f64]) -> bool {
        let (Some((old, shape)), Some((new, _))) =
            (self.master.shape(before), self.master.shape(after))
        else {
            return false;
        };
        let jumped = |p: Vector3<f64>, q: Vector3<f64>| {
            let (start, end) = (old.local(p), new.local(q));
            let way = end - start;
            let last = shape.distance(end);
            if last.value > way.norm() {
                return false;
            }
            let first = shape.distance(start);
            let least = first.value.min(last.value).min(0.0);
            first.normal.dot(&last.normal) < 0.0
                && (1..SAMPLES).any(|k| {
                    let part = k as f64 / SAMPLES as f64;
                    shape.distance(start + way * part).value < least
                })
        };
        match &self.slave {
            Side::Sheet(faces) => faces.iter().any(|face| {
                let ((was, _), (middle, reach)) = (face.ball(before), face.ball(after));
                let way = (new.local(middle) - old.local(was)).norm() + reach;
                shape.distance(new.local(middle)).value < way
                    && (0..face.rule.len())
                        .any(|k| jumped(face.probe(k, before), face.probe(k, after)))
            }),
            Side::Line(line) => line
                .iter()
                .flat_map(|segment| [segment.offsets[0], segment.offsets[2]])
                .any(|o| jumped(vector(before, o), vector(after, o))),
            Side::Mass(terms, _) => {
                let at = |q: &[f64]| terms.iter().map(|&(o, w)| vector(q, o) * w).sum();
                jumped(at(before), at(after))
            }
            Side::Rigid(..) | Side::Rest(..) => {
                match (self.slave.shape(before), self.slave.shape(after)) {
                    (Some((one, _)), Some((other, _))) => jumped(one.origin, other.origin),
                    _ => false,
                }
            }
        }
    }

    fn scatter(&self, touch: &Touch, share: &Vectors, out: &mut [f64]) {
        let mut add = |o: usize, f: Vector3<f64>| {
            for c in 0..3 {
                out[o + c] += f[c];
            }
        };
        let [slave, master] = self.bodies();
        match slave {
            Some(own) => (0..4).for_each(|k| add(own[k], share[k])),
            None => self.each_term(touch, |_, o, w| add(o, share[0] * w)),
        }
        if let Some(other) = master {
            (0..4).for_each(|k| add(other[k], share[4 + k]));
        }
        // The force acts at the foot; slopes feel none.
        self.each_nodal(touch, |_, o, w| add(o, share[4] * w[0]));
    }

    /// Adds the blocks of a probe to the element matrix of its part.
    fn scatter_blocks(&self, touch: &Touch, blocks: &Blocks, values: &mut [f64]) {
        let placed = &self.placed[touch.part];
        let mut places: Vec<(usize, usize, f64)> = Vec::with_capacity(20);
        if touch.blend == Blend::Own {
            places.extend(placed.slave.iter().enumerate().map(|(k, &at)| (k, at, 1.0)));
        } else {
            self.each_term(touch, |i, _, w| places.push((0, placed.slave[i], w)));
        }
        if self.bodies()[1].is_some() {
            places.extend(placed.master.iter().enumerate().map(|(k, &at)| (4 + k, at, 1.0)));
        }
        let symmetric = placed.storage == Storage::Symmetric;
        for &(k, i, w) in &places {
            for &(l, j, u) in &places {
                let (block, factor) = (&blocks[k][l], w * u);
                if factor == 0.0 {
                    continue;
                }
                for a in 0..3 {
                    for b in 0..3 {
                        if symmetric && i + a < j + b {
                            continue;
                        }
                        let number = entry_number(placed.size, i + a, j + b, placed.storage);
                        values[placed.base + number] += factor * block[(a, b)];
                    }
                }
            }
        }
    }
}

impl Probes {
    fn laws(&self, touch: &Touch, at_rest: bool) -> Laws {
        let laws = self.contacts[self.facings[touch.facing].contact].laws;
        if at_rest { Laws { friction: None, ..laws } } else { laws }
    }

    /// Number under which the bristles of a facing along a line are kept; lines among themselves have the first.
    fn line_number(&self, facing: usize) -> u32 {
        u32::MAX - facing as u32
    }

    /// Calls `work` with the motion of a probe over the present step.
    fn with_motion<T>(
        &self,
        touch: &Touch,
        memory: &ContactMemory,
        at: At<'_>,
        work: impl FnOnce(&Motion<'_>) -> T,
    ) -> T {
        let facing = &self.facings[touch.facing];
        let v = facing.gather(touch, at.v);
        let (mut moved, mut h) = ([Vector3::zeros(); 8], 0.0);
        if memory.q.len() == at.q.len() && at.t > memory.t {
            h = at.t - memory.t;
            let (before, now) = (facing.gather(touch, &memory.q), facing.gather(touch, at.q));
            moved = std::array::from_fn(|k| now[k] - before[k]);
        }
        let contact = &self.contacts[facing.contact];
        let mut z = Vector3::zeros();
        if contact.laws.friction.is_some() {
            let n = touch.point().normal();
            z = match touch.mark {
                Mark::Along { arc, end, .. } => {
                    let number = self.line_number(touch.facing);
                    bristle(memory.bristles_of(number, end), (arc, 0.0), n, contact.size)
                }
                Mark::Number(id) => {
                    let reach = match (id, &touch.meets) {
                        (Spot::NEAREST, _) => SAME * contact.size,
                        // On another layer of the surface there were others.
                        (_, Meets::Face(..)) => NEIGHBOURS * contact.size,
                        _ => f64::INFINITY,
                    };
                    memory.probes.bristle(touch.facing as u32, id, place_of(touch), n, reach)
                }
            };
        }
        work(&Motion { v: &v, moved: &moved, h, z })
    }

    fn force_at(&self, touch: &Touch, memory: &ContactMemory, at: At<'_>, at_rest: bool) -> Force {
        let laws = self.laws(touch, at_rest);
        self.with_motion(touch, memory, at, |motion| touch.point().force(&laws, motion))
    }

    /// Adds what contact adds to the inner forces.
    pub fn add_forces(
        &self,
        found: &mut Found,
        memory: &ContactMemory,
        at: At<'_>,
        (part, at_rest): (Part, bool),
        out: &mut [f64],
    ) {
        found.know(self, &memory.q, &memory.probes);
        for touch in found.touches(self, at.q) {
            let laws = self.laws(touch, at_rest);
            let mut total = self.force_at(touch, memory, at, at_rest).total;
            if part == Part::Dissipated {
                total -= touch.point().normal() * laws.normal.elastic(-touch.point().gap()).0;
            }
            let mut share = [Vector3::zeros(); 8];
            touch.point().add_force(total, &mut share);
            self.facings[touch.facing].scatter(touch, &share, out);
        }
    }

    /// Writes the element matrices.
    pub fn tangents(
        &self,
        found: &mut Found,
        memory: &ContactMemory,
        at: At<'_>,
        (stiffness, damping, at_rest): (f64, f64, bool),
        (coupling, values): (&Coupling, &mut [f64]),
    ) {
        coupling.clear(values);
        for placed in self.facings.iter().flat_map(|facing| &facing.placed) {
            values[placed.base..placed.base + entries(placed.size, placed.storage)].fill(0.0);
        }
        if stiffness == 0.0 && damping == 0.0 {
            return;
        }
        found.know(self, &memory.q, &memory.probes);
        for touch in found.touches(self, at.q) {
            let laws = self.laws(touch, at_rest);
            if let Meets::Face(..) = touch.meets {
                let Some(symmetric) = coupling.is_symmetric(touch) else { continue };
                let mut blocks = [[Matrix3::zeros(); 8]; 8];
                self.with_motion(touch, memory, at, |motion| {
                    let factors = (stiffness, damping);
                    touch.point().add_tangent(&laws, motion, factors, symmetric, &mut blocks);
                });
                coupling.add(&self.facings[touch.facing], touch, &blocks, values);
                continue;
            }
            let placed = &self.facings[touch.facing].placed[touch.part];
            let (factors, symmetric) = ((stiffness, damping), placed.storage == Storage::Symmetric);
            let mut blocks = [[Matrix3::zeros(); 8]; 8];
            self.with_motion(touch, memory, at, |motion| {
                touch.point().add_tangent(&laws, motion, factors, symmetric, &mut blocks);
            });
            self.facings[touch.facing].scatter_blocks(touch, &blocks, values);
        }
    }

    /// Energy stored where bodies press [J].
    pub fn energy(&self, found: &mut Found, q: &[f64]) -> f64 {
        let of = |touch: &Touch| {
            touch.point().weight() * self.laws(touch, true).normal.energy(-touch.point().gap())
        };
        found.touches(self, q).iter().map(of).sum()
    }

    /// Whether a probe is beyond the mid-surface of what it touches at `q`.
    pub fn have_crossed(&self, found: &mut Found, q: &[f64]) -> bool {
        found.touches(self, q).iter().any(Touch::has_crossed)
    }

    /// Whether anything touches at `q`.
    pub fn touch(&self, found: &mut Found, q: &[f64]) -> bool {
        !found.touches(self, q).is_empty()
    }

    /// Whether a body has jumped through a shape between two places: what pushes it now would push it on.
    #[must_use]
    pub fn have_passed(&self, before: &[f64], after: &[f64]) -> bool {
        self.facings.iter().any(|facing| facing.has_passed(before, after))
    }

    /// Commits a step: bristles, forces and their impulse, patches. Before the lines' own memory, which the returned
    /// bristles belong to then.
    pub fn accept(
        &self,
        found: &mut Found,
        memory: &mut ContactMemory,
        at: At<'_>,
        at_rest: bool,
    ) -> Vec<Bristle> {
        let h = if memory.q.is_empty() { 0.0 } else { at.t - memory.t };
        let before = std::mem::take(&mut memory.probes.totals);
        let mut totals = vec![[0.0; 6]; self.contacts.len()];
        let (mut spots, mut bristles) = (Vec::new(), Vec::new());
        let (mut crossed, mut couples) = (Vec::new(), Vec::new());
        found.know(self, &memory.q, &memory.probes);
        let mut patches: Vec<Patch> = Vec::new();
        for touch in found.touches(self, at.q) {
            let facing = &self.facings[touch.facing];
            let force = self.force_at(touch, memory, at, at_rest);
            let (n, weight) = (touch.point().normal(), touch.point().weight());
            let push = force.total * (weight * facing.sign);
            for c in 0..3 {
                totals[facing.contact][c] += push[c];
            }
            couples.extend(touch.couple());
            if let (true, Meets::Face(_, ground)) = (touch.has_crossed(), &touch.meets) {
                let (facing, place) = (touch.facing as u32, ground.place.into());
                crossed.push(Crossed { facing, key: key(&touch.mark), place });
            }
            if force.pressure.p <= 0.0 {
                continue;
            }
            let normal_force = force.pressure.p * weight;
            let patch = Patch {
                contact: facing.contact as u32,
                point: (touch.point().place() * normal_force).into(),
                normal: (n * (facing.sign * normal_force)).into(),
                gap: touch.gap,
                normal_force,
                friction_force: (push - n * (facing.sign * normal_force)).into(),
            };
            let size = self.contacts[facing.contact].size;
            join(&mut patches, patch, (size, facing.own.is_some()));
            if self.laws(touch, at_rest).friction.is_none() {
                continue;
            }
            let (z, n) = (force.friction.z.into(), n.into());
            match touch.mark {
                Mark::Number(id) => {
                    let at = place_of(touch).into();
                    spots.push(Spot { facing: touch.facing as u32, id, at, z, n });
                }
                Mark::Along { arc, zone, end } => {
                    let contact = self.line_number(touch.facing);
                    bristles.push(Bristle { contact, end, slave: arc, master: 0.0, zone, z, n });
                }
            }
        }
        for (number, totals) in totals.iter_mut().enumerate() {
            let last = before.get(number).copied().unwrap_or_default();
            for c in 0..3 {
                totals[3 + c] = last[3 + c] + 0.5 * h * (last[c] + totals[c]);
            }
        }
        spots.sort_by_key(|s| (s.facing, s.id));
        for patch in &mut patches {
            patch.point = (Vector3::from(patch.point) / patch.normal_force).into();
            let n = Vector3::from(patch.normal);
            patch.normal = n.try_normalize(0.0).unwrap_or(n).into();
        }
        couples.sort_unstable();
        for (couple, idle) in &mut memory.probes.coupled {
            let touches = couples.binary_search(couple).is_ok();
            *idle = if touches { 0 } else { idle.saturating_add(1) };
        }
        memory.probes.crossed = crossed;
        memory.probes.spots = spots;
        memory.probes.totals = totals;
        memory.probes.patches = patches;
        bristles
    }
}

/// Place on the rigid body that carries a probe, or of its foot on the stress-free surface.
fn place_of(touch: &Touch) -> Vector3<f64> {
    match &touch.meets {
        Meets::Face(_, ground) => ground.place,
        Meets::Shape(probe) => match probe.slave {
            Slave::Body(_, local) => local,
            _ => Vector3::zeros(),
        },
    }
}

/// Adds a probe, its point and normal times its force, to a patch near it with a normal like its own, or as a new one.
/// A surface that touches itself does so with two probes of opposite normals, of which the first counts.
fn join(patches: &mut Vec<Patch>, mut one: Patch, (size, is_self): (f64, bool)) {
    let middle = |p: &Patch| Vector3::from(p.point) / p.normal_force;
    let along = |p: &Patch| Vector3::from(p.normal).dot(&Vector3::from(one.normal));
    let near = patches.iter_mut().find(|p| {
        p.contact == one.contact
            && (is_self || along(p) > 0.0)
            && (middle(p) - middle(&one)).norm() < NEIGHBOURS * size
    });
    let Some(patch) = near else {
        patches.push(one);
        return;
    };
    if along(patch) < 0.0 {
        one.normal = one.normal.map(|x| -x);
        one.friction_force = one.friction_force.map(|x| -x);
    }
    for c in 0..3 {
        patch.point[c] += one.point[c];
        patch.normal[c] += one.normal[c];
        patch.friction_force[c] += one.friction_force[c];
    }
    patch.normal_force += one.normal_force;
    patch.gap = patch.gap.min(one.gap);
}

/// Distance, over the size of what touches, within which probes are one patch.
const NEIGHBOURS: f64 = 10.0;
