//! What probes on surfaces add to the iteration matrix: one element matrix for each part of a slave and each face that
//! it touches. A couple stays for some steps after it has come apart, as between lines.

use super::Facing;
use super::find::{Blend, Found, Meets, Touch};
use super::memory::{Couple, ProbeMemory};
use super::{Probes, Side, vectors_of};
use crate::dof_map::DofMap;
use nalgebra::Matrix3;
use pliant_contact::probe::Blocks;
use pliant_dae::structure::{Storage, Structure, entries, entry_number};

/// The element matrix of a couple.
#[derive(Clone, Debug)]
struct Placed {
    couple: Couple,
    base: usize,
    size: usize,
    storage: Storage,
    /// Places of the slave's vectors and of the master's in it.
    slave: Vec<usize>,
    master: Vec<usize>,
}

/// All of them, sorted.
#[derive(Clone, Debug, Default)]
pub struct Coupling {
    placed: Vec<Placed>,
}

impl Touch {
    /// Who is coupled here, on a surface.
    pub(crate) fn couple(&self) -> Option<Couple> {
        let Meets::Face(_, ground) = &self.meets else { return None };
        let (facing, part) = (self.facing as u32, self.part as u32);
        Some(Couple { facing, part, face: ground.face as u32 })
    }

    /// Whether the probe is beyond the mid-surface.
    pub(crate) fn has_crossed(&self) -> bool {
        matches!(&self.meets, Meets::Face(foot, _) if foot.distance() < 0.0)
    }
}

impl Coupling {
    /// Notes which couples touch at `q`; whether the structure must change.
    pub fn notes(
        &self,
        probes: &Probes,
        found: &mut Found,
        (memory, patience): (&mut ProbeMemory, u32),
        (was, q): (&[f64], &[f64]),
    ) -> bool {
        if probes.skins.is_empty() {
            return false;
        }
        memory.coupled.retain(|&(_, idle)| idle <= patience);
        found.know(probes, was, memory);
        for touch in found.touches(probes, q) {
            let Some(couple) = touch.couple() else { continue };
            if let Err(at) = memory.coupled.binary_search_by_key(&couple, |&(c, _)| c) {
                memory.coupled.insert(at, (couple, 0));
            }
        }
        !memory.coupled.iter().map(|&(c, _)| c).eq(self.placed.iter().map(|p| p.couple))
    }

    /// Adds the element matrices of all couples to a structure.
    pub fn place(
        &mut self,
        probes: &Probes,
        map: &DofMap,
        memory: &ProbeMemory,
        structure: &mut Structure,
    ) {
        self.placed.clear();
        for &(couple, _) in &memory.coupled {
            let facing = &probes.facings[couple.facing as usize];
            let own = match &facing.slave {
                Side::Sheet(faces) => faces[couple.part as usize].offsets.clone(),
                Side::Line(line) => line[couple.part as usize].offsets.to_vec(),
                Side::Mass(terms, _) => terms.iter().map(|&(o, _)| o).collect(),
                Side::Rigid(first, _) => vectors_of(*first).to_vec(),
                Side::Rest(..) => Vec::new(),
            };
            let Side::Sheet(faces) = &facing.master else { continue };
            let other = &faces[couple.face as usize].offsets;
            let groups = map.groups_of(own.iter().chain(other).copied());
            let unknowns: Vec<usize> =
                groups.iter().flat_map(|&g| structure.groups()[g].clone()).collect();
            let local = |o: &usize| unknowns.iter().position(|u| u == o).unwrap_or(0);
            let plain = !matches!(facing.slave, Side::Rigid(..));
            let rubs = probes.contacts[facing.contact].laws.friction.is_some();
            let storage = if plain && !rubs { Storage::Symmetric } else { Storage::Full };
            let element = structure.add_element(&groups, storage);
            self.placed.push(Placed {
                couple,
                base: structure.slot(element).base,
                size: unknowns.len(),
                storage,
                slave: own.iter().map(local).collect(),
                master: other.iter().map(local).collect(),
            });
        }
    }

    /// Sets all of them to zero.
    pub(crate) fn clear(&self, values: &mut [f64]) {
        for placed in &self.placed {
            values[placed.base..placed.base + entries(placed.size, placed.storage)].fill(0.0);
        }
    }

    fn of(&self, touch: &Touch) -> Option<&Placed> {
        let couple = touch.couple()?;
        let at = self.placed.binary_search_by_key(&couple, |p| p.couple).ok()?;
        self.placed.get(at)
    }

    /// Whether the matrix of a touch is stored so; none where it has none.
    pub(crate) fn is_symmetric(&self, touch: &Touch) -> Option<bool> {
        self.of(touch).map(|placed| placed.storage == Storage::Symmetric)
    }

    /// Adds the blocks of a probe over its own vectors and (r, r_u, r_v) of the face.
    pub(crate) fn add(&self, facing: &Facing, touch: &Touch, blocks: &Blocks, values: &mut [f64]) {
        let Some(placed) = self.of(touch) else { return };
        // Each nodal vector's place in the matrix, and its weights in the eight vectors from the first on.
        let mut terms: Vec<(usize, usize, [f64; 3], usize)> = Vec::with_capacity(32);
        if touch.blend == Blend::Own {
            let own = placed.slave.iter().enumerate();
            terms.extend(own.map(|(k, &at)| (at, k, [1.0, 0.0, 0.0], 1)));
        } else {
            facing.each_term(touch, |i, _, w| terms.push((placed.slave[i], 0, [w, 0.0, 0.0], 1)));
        }
        facing.each_nodal(touch, |i, _, w| terms.push((placed.master[i], 4, *w, 3)));
        let symmetric = placed.storage == Storage::Symmetric;
        for &(i, k, w, count) in &terms {
            // The row of this vector, by the eight.
            let mut row = [Matrix3::zeros(); 8];
            for (d, w) in w.iter().enumerate().take(count) {
                if *w != 0.0 {
                    (0..8).for_each(|l| row[l] += blocks[k + d][l] * *w);
                }
            }
            for &(j, l, u, count) in &terms {
                let mut block = row[l] * u[0];
                for d in 1..count {
                    block += row[l + d] * u[d];
                }
                for a in 0..3 {
                    for b in 0..3 {
                        if symmetric && i + a < j + b {
                            continue;
                        }
                        let number = entry_number(placed.size, i + a, j + b, placed.storage);
                        values[placed.base + number] += block[(a, b)];
                    }
                }
            }
        }
    }
}
