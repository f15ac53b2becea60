//! What contact adds to the iteration matrix: one element matrix for each pair that touches.
//!
//! Two lines that touch couple up to four nodes. Before a shape at rest the matrix of a contact lies within that of the
//! slave's own elements: all of these get one at once, and chains stay chains. A pair stays for some steps after it
//! has come apart, for zones move over the borders of elements all the time; the structure changes only where a new
//! pair comes in, or an idle one goes.

use super::memory::{ContactMemory, Pair};
use super::run::{At, PATIENCE, Search, Touch, pair_of};
use super::{Contacts, Master};
use crate::dof_map::DofMap;
use crate::probes::couple::Coupling;
use nalgebra::Matrix3;
use pliant_contact::point::{Laws, Motion};
use pliant_dae::structure::{Mark, Storage, Structure, entries, entry_number};

/// An element matrix of a pair of elements.
#[derive(Clone, Debug)]
struct Placed {
    slave: usize,
    master: usize,
    contact: usize,
    /// Where it begins among the element values, its size and storage.
    base: usize,
    size: usize,
    storage: Storage,
    /// Place of the eight vectors in it.
    local: [usize; 8],
    /// Place of the directions of both sections, of lines that have some.
    sections: [usize; 8],
}

impl Placed {
    /// Adds a block at row and column.
    fn add(&self, (i, j): (usize, usize), block: &Matrix3<f64>, values: &mut [f64]) {
        let symmetric = self.storage == Storage::Symmetric;
        for a in 0..3 {
            for b in 0..3 {
                if symmetric && i + a < j + b {
                    continue;
                }
                let number = entry_number(self.size, i + a, j + b, self.storage);
                values[self.base + number] += block[(a, b)];
            }
        }
    }

    /// Adds what friction does to sections that turn, and they to friction.
    fn add_turning<'m>(
        &self,
        contacts: &Contacts,
        touch: &Touch,
        (at, motion): (At<'_>, &(dyn Fn(usize) -> Motion<'m> + 'm)),
        laws: &Laws,
        factors: (f64, f64),
        values: &mut [f64],
    ) {
        for (number, point) in touch.patch.points().iter().enumerate() {
            let place = &point.place;
            let (tangent, [whole, friction]) =
                place.linearise_friction(laws, &motion(number), factors);
            let arms = contacts.arms(touch, point, at.q);
            for k in (0..8).filter(|&k| arms.beta[k] != 0.0) {
                let (arm, row) = (arms.beta[k], self.sections[k]);
                for l in 0..8 {
                    let (alpha, base) = (place.alpha[l], self.local[l]);
                    self.add((row, base), &(place.column(&tangent, l) * arm), values);
                    let turned = whole * (-place.weight * alpha * arm);
                    self.add((base, row), &turned, values);
                    let both = friction * (-place.weight * arm * arms.beta[l]);
                    if arms.beta[l] != 0.0 {
                        self.add((row, self.sections[l]), &both, values);
                    }
                }
            }
        }
    }
}

/// The structure of a model with what touches.
#[derive(Clone, Debug)]
pub struct Coupled {
    /// That of the model, and the pairs' elements after it.
    pub structure: Structure,
    mark: Mark,
    pairs: Vec<Pair>,
    placed: Vec<Placed>,
    /// What touches surfaces.
    probes: Coupling,
}

impl Coupled {
    /// That of a model where nothing touches.
    #[must_use]
    pub fn new(structure: &Structure) -> Self {
        Self {
            mark: structure.mark(),
            structure: structure.clone(),
            pairs: Vec::new(),
            placed: Vec::new(),
            probes: Coupling::default(),
        }
    }

    /// Notes which pairs touch at `q`, and changes the structure where that asks for it.
    pub fn follow(
        &mut self,
        contacts: &Contacts,
        map: &DofMap,
        search: &mut Search,
        memory: &mut ContactMemory,
        q: &[f64],
    ) {
        memory.coupled.retain(|&(_, idle)| idle <= PATIENCE);
        for touch in search.touches(contacts, q) {
            let pair = pair_of(touch);
            if let Err(at) = memory.coupled.binary_search_by_key(&pair, |&(p, _)| p) {
                memory.coupled.insert(at, (pair, 0));
            }
        }
        let same = memory.coupled.iter().map(|&(p, _)| p).eq(self.pairs.iter().copied());
        let ContactMemory { probes, q: was, .. } = memory;
        let new =
            self.probes.notes(&contacts.probes, &mut search.probes, (probes, PATIENCE), (was, q));
        if same && !new {
            return;
        }
        self.pairs = memory.coupled.iter().map(|&(p, _)| p).collect();
        self.structure.truncate(self.mark);
        self.placed.clear();
        for k in 0..self.pairs.len() {
            let Pair { contact, slave, master } = self.pairs[k];
            let line = contacts.list[contact as usize].slave;
            if slave == u32::MAX {
                for e in 0..contacts.lines[line].len() {
                    self.place(contacts, map, contact as usize, e, usize::MAX);
                }
            } else {
                self.place(contacts, map, contact as usize, slave as usize, master as usize);
            }
        }
        self.placed.sort_by_key(|p| (p.contact, p.slave, p.master));
        self.probes.place(&contacts.probes, map, &memory.probes, &mut self.structure);
    }

    fn place(
        &mut self,
        contacts: &Contacts,
        map: &DofMap,
        contact: usize,
        slave: usize,
        master: usize,
    ) {
        let this = &contacts.list[contact];
        let slave_segment = &contacts.lines[this.slave][slave];
        let own = slave_segment.offsets;
        let other = match this.master {
            Master::Line(line) => contacts.lines[line][master].offsets,
            Master::Shape(_) => own,
        };
        let groups = map.groups_of(other.into_iter().chain(own));
        let unknowns: Vec<usize> =
            groups.iter().flat_map(|&g| self.structure.groups()[g].clone()).collect();
        let place = |offset: usize| unknowns.iter().position(|&u| u == offset).unwrap_or(0);
        let local = std::array::from_fn(|k| place(if k < 4 { other[k] } else { own[k - 4] }));
        let none = [usize::MAX; 4];
        let [other, own] = match this.master {
            Master::Line(line) => [Some(&contacts.lines[line][master]), Some(slave_segment)],
            Master::Shape(_) => [None, Some(slave_segment)],
        }
        .map(|segment| segment.and_then(|s| s.section).unwrap_or(none));
        let sections = std::array::from_fn(|k| place(if k < 4 { other[k] } else { own[k - 4] }));
        let storage = if this.laws.friction.is_some() { Storage::Full } else { Storage::Symmetric };
        let element = self.structure.add_element(&groups, storage);
        let base = self.structure.slot(element).base;
        self.placed.push(Placed {
            slave,
            master,
            contact,
            base,
            size: unknowns.len(),
            storage,
            local,
            sections,
        });
    }

    /// Writes the element matrices of all pairs.
    pub fn tangents(
        &self,
        contacts: &Contacts,
        search: &mut Search,
        memory: &ContactMemory,
        at: At<'_>,
        (stiffness, damping, at_rest): (f64, f64, bool),
        values: &mut [f64],
    ) {
        for placed in &self.placed {
            values[placed.base..placed.base + entries(placed.size, placed.storage)].fill(0.0);
        }
        let factors = (stiffness, damping, at_rest);
        contacts.probes.tangents(&mut search.probes, memory, at, factors, (&self.probes, values));
        if stiffness == 0.0 && damping == 0.0 {
            return;
        }
        for touch in search.touches(contacts, at.q) {
            let Some(placed) = self.of(touch) else { continue };
            let laws = contacts.laws(touch.contact, at_rest);
            let symmetric = placed.storage == Storage::Symmetric;
            let mut blocks = [[Matrix3::zeros(); 8]; 8];
            contacts.with_motion(touch, memory, at, |motion| {
                let factors = (stiffness, damping);
                touch.patch.add_tangent(&laws, motion, factors, symmetric, &mut blocks);
            });
            for k in 0..8 {
                for l in 0..8 {
                    placed.add((placed.local[k], placed.local[l]), &blocks[k][l], values);
                }
            }
            if !at_rest && contacts.turns(touch) {
                contacts.with_motion(touch, memory, at, |motion| {
                    let factors = (stiffness, damping);
                    placed.add_turning(contacts, touch, (at, motion), &laws, factors, values);
                });
            }
        }
    }

    fn of(&self, touch: &Touch) -> Option<&Placed> {
        let key = (touch.contact, touch.slave, touch.master);
        let at = self.placed.binary_search_by_key(&key, |p| (p.contact, p.slave, p.master)).ok()?;
        self.placed.get(at)
    }
}
