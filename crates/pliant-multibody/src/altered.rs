//! What alters elements during a run: lengths that winches set, and plastic strains.
//!
//! A model never changes during a run, so the run has copies of the blocks that do: it sets their lengths to each time
//! that it asks about, and what their points remember to that of the last accepted step. What winches had let out and
//! how cables had yielded at a recorded time stands in the outputs of that time.

use crate::error::ModelError;
use crate::model::{Blocks, Model, StrandPlace};
use crate::spec::PlasticSpec;
use crate::winch::OUTPUTS;
use pliant_elements::{Block, CableBlock, Motion, PAST, Yielding};
use std::ops::Range;

/// Part of the yield stress below which a tangent counts what grows in statics as flowing.
pub(crate) const LEAD: f64 = 1e-9;

/// A cable that yields.
pub(crate) struct Plastic {
    /// Number of the cable.
    pub cable: usize,
    /// Where what its points remember stands among that of all cables: element after element, plastic strain and path
    /// of each point.
    pub range: Range<usize>,
    /// Numbers of one element.
    pub width: usize,
    /// Number of its winch.
    pub winch: Option<usize>,
    pub strands: Vec<(StrandPlace, usize)>,
}

impl Plastic {
    /// Block, number in it and numbers of each of its elements.
    fn elements(&self) -> impl Iterator<Item = (usize, usize, Range<usize>)> + '_ {
        let elements = self
            .strands
            .iter()
            .flat_map(|&(place, count)| (0..count).map(move |i| (place.block, place.element + i)));
        elements.enumerate().map(move |(i, (block, e))| {
            let first = self.range.start + i * self.width;
            (block, e, first..first + self.width)
        })
    }
}

impl PlasticSpec {
    /// The law.
    pub(crate) fn law(&self) -> Yielding {
        Yielding { strain: self.yield_strain, isotropic: self.isotropic, kinematic: self.kinematic }
    }
}

/// Refuses what no cable can remember: paths are no shorter than the strains that they led to.
pub(crate) fn check_past(past: &[f64], place: &str) -> Result<(), ModelError> {
    let bad = past.chunks_exact(PAST).find(|point| point[1] < point[0].abs() * (1.0 - 1e-9));
    match bad {
        None => Ok(()),
        Some(point) => Err(ModelError::Value {
            place: place.to_owned(),
            value: point[1],
            allowed: "paths no shorter than their plastic strains",
        }),
    }
}

/// Blocks as a run has altered them, by their numbers; none where nothing does.
#[derive(Clone, Debug, Default)]
pub struct Altered {
    cables: Vec<Option<CableBlock>>,
    /// Factor and rate of each winch.
    pub(crate) lengths: Vec<[f64; OUTPUTS]>,
    /// What the points of all cables that yield remember.
    pub(crate) past: Vec<f64>,
}

impl Altered {
    /// Copies of the blocks that winches or plastic strains alter, at the start.
    #[must_use]
    pub fn new(model: &Model) -> Self {
        if model.winches.is_empty() && model.plastic.is_empty() {
            return Self::default();
        }
        let alters = |block: &CableBlock| block.law().wound || block.law().plastic;
        let copy = |block: &CableBlock| alters(block).then(|| block.clone());
        let cables = model.blocks.cables.iter().map(|placed| copy(&placed.block)).collect();
        let mut altered =
            Self { cables, lengths: vec![[1.0, 0.0]; model.winches.len()], past: Vec::new() };
        altered.set_past(model, &model.initial_past);
        altered
    }

    /// Sets what the recorded outputs of a time say.
    pub fn show(&mut self, model: &Model, outputs: &[f64]) {
        let first = model.first_length_output();
        let n = OUTPUTS * model.winches.len();
        if let Some(rows) = outputs.get(first..first + n) {
            for (k, row) in rows.chunks_exact(OUTPUTS).enumerate() {
                self.set(model, k, [row[0], row[1]]);
            }
        }
        if let Some(past) = outputs.get(first + n..first + n + model.initial_past.len()) {
            self.set_past(model, past);
        }
    }

    /// Sets factor and rate of a winch.
    pub(crate) fn set(&mut self, model: &Model, winch: usize, length: [f64; OUTPUTS]) {
        if self.lengths[winch] == length {
            return;
        }
        self.lengths[winch] = length;
        for strand in &model.winches[winch].strands {
            if let Some(Some(block)) = self.cables.get_mut(strand.block) {
                block.set_length(strand.cable, length[0], length[1]);
            }
        }
    }

    /// Lets all winches stand still where they are.
    pub(crate) fn stop(&mut self, model: &Model) {
        for winch in 0..self.lengths.len() {
            let [factor, _] = self.lengths[winch];
            self.set(model, winch, [factor, 0.0]);
        }
    }

    /// Forces on the factors of the lengths [J], elastic and of damping, one for each winch.
    pub(crate) fn forces(&self, model: &Model, motion: Motion<'_>) -> Vec<[f64; 2]> {
        let on = |strands: &[StrandPlace]| {
            let mut sum = [0.0; 2];
            for strand in strands {
                let block = model.blocks.cable(strand.block, self);
                let forces = block.length_forces(strand.cable, motion);
                sum[0] += forces[0];
                sum[1] += forces[1];
            }
            sum
        };
        model.winches.iter().map(|winch| on(&winch.strands)).collect()
    }

    /// Sets what the points of all cables remember; anything of another length is left alone.
    pub(crate) fn set_past(&mut self, model: &Model, past: &[f64]) {
        if past.len() != model.initial_past.len() || self.past == past {
            return;
        }
        self.past.clear();
        self.past.extend_from_slice(past);
        for (block, e, range) in model.plastic.iter().flat_map(Plastic::elements) {
            if let Some(Some(block)) = self.cables.get_mut(block) {
                block.set_past(e, &past[range]);
            }
        }
    }

    /// What the points will remember after a step to coordinates `q`.
    pub(crate) fn flowed(&self, model: &Model, q: &[f64]) -> Vec<f64> {
        let mut past = Vec::with_capacity(model.initial_past.len());
        for (block, e, _) in model.plastic.iter().flat_map(Plastic::elements) {
            model.blocks.cable(block, self).flowed(e, q, &mut past);
        }
        past
    }

    /// Work on plastic flow in a step to coordinates `q` [J], with the lengths of its end, one number for each cable
    /// that yields.
    pub(crate) fn plastic_work(&self, model: &Model, q: &[f64]) -> Vec<f64> {
        let of_cable = |plastic: &Plastic| {
            let work = |(block, e, _)| model.blocks.cable(block, self).plastic_work(e, q);
            plastic.elements().map(work).sum()
        };
        model.plastic.iter().map(of_cable).collect()
    }

    /// How near to yielding a tangent counts as flowing, see [`CableBlock::set_lead`].
    pub(crate) fn set_lead(&mut self, lead: f64) {
        for block in self.cables.iter_mut().flatten() {
            block.set_lead(lead);
        }
    }
}

impl Blocks {
    /// A block of cables.
    pub fn cable<'a>(&'a self, number: usize, altered: &'a Altered) -> &'a CableBlock {
        match altered.cables.get(number) {
            Some(Some(block)) => block,
            _ => &self.cables[number].block,
        }
    }

    /// Every block as the run has altered it, and where its matrices lie. The order never changes.
    pub fn iter_as<'a>(
        &'a self,
        altered: &'a Altered,
    ) -> impl Iterator<Item = (&'a dyn Block, &'a Range<usize>)> {
        self.iter().enumerate().map(|(number, (block, values))| match altered.cables.get(number) {
            Some(Some(block)) => (block as &dyn Block, values),
            _ => (block, values),
        })
    }
}
