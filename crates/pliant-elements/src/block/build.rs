//! From the data of cables to a block.

use std::collections::HashMap;

use super::{CHUNK, CableBlock, Core, Gram, LANES, Lengths, PastRows};
use crate::elements::cable::{Cable, CableElement, CableLaw, NodeOffsets, Reference, place};
use crate::error::ElementError;
use crate::integrals::cable::Numbers;

impl CableBlock {
    /// A block of cables.
    ///
    /// # Errors
    /// [`ElementError`] naming the cable, the element and the number that is wrong.
    pub fn new(law: CableLaw, cables: &[Cable]) -> Result<Self, ElementError> {
        let mut slots: Vec<NodeOffsets> = Vec::new();
        let mut ranges = Vec::with_capacity(cables.len());
        let mut is_bridge = Vec::new();
        let mut store = Store::default();
        for (number, cable) in cables.iter().enumerate() {
            let elements = cable.nodes.len().saturating_sub(1);
            if elements == 0 {
                return Err(ElementError::TooFewNodes { cable: number, nodes: cable.nodes.len() });
            }
            if cable.elements.len() != 1 && cable.elements.len() != elements {
                return Err(ElementError::ParameterCount {
                    cable: number,
                    elements,
                    found: cable.elements.len(),
                });
            }
            if number > 0 {
                is_bridge.push(true);
                store.push(&Numbers::BRIDGE);
            }
            let mut last: Option<(&CableElement, Numbers)> = None;
            for e in 0..elements {
                let element = &cable.elements[if cable.elements.len() == 1 { 0 } else { e }];
                let numbers = match &last {
                    Some((known, numbers)) if *known == element => *numbers,
                    _ => {
                        check(law, cable, element, number, e)?;
                        Numbers::new(law, element, cable.normal, cable.slack)
                    }
                };
                store.push(&numbers);
                is_bridge.push(false);
                last = Some((element, numbers));
            }
            let start = slots.len();
            slots.extend_from_slice(&cable.nodes);
            ranges.push(start..slots.len());
        }
        store.fill();
        if !law.uses_gram() {
            store.gram.clear();
        }
        let extent = slots.iter().map(|n| n.r.max(n.t) as usize + 3).max().unwrap_or(0);
        let contiguous = (0..is_bridge.len())
            .step_by(CHUNK)
            .map(|first| {
                let last = (first + CHUNK).min(is_bridge.len());
                let start = slots[first].r as usize;
                let follows = |(i, n): (usize, &NodeOffsets)| {
                    n.r as usize == start + 6 * i && n.t as usize == start + 6 * i + 3
                };
                slots[first..=last].iter().enumerate().all(follows)
            })
            .collect();
        let scaled = law.wound || law.plastic;
        let lengths = if scaled { Lengths::new(is_bridge.len()) } else { Lengths::default() };
        let mut past = PastRows::default();
        if law.plastic {
            past = PastRows::new(is_bridge.len());
            for (cable, range) in cables.iter().zip(&ranges) {
                past.begin(range.start..range.end - 1, cable.yielding);
            }
        }
        Ok(Self {
            law,
            slots,
            cables: ranges,
            is_bridge,
            contiguous,
            groups: store.groups,
            core: store.core,
            gram: store.gram,
            lengths,
            past,
            extent,
        })
    }
}

/// Collects the numbers of elements in groups of lanes, equal groups once.
#[derive(Default)]
struct Store {
    pending: Vec<Numbers>,
    known: HashMap<Vec<u64>, u32>,
    groups: Vec<u32>,
    core: Vec<Core>,
    gram: Vec<Gram>,
}

impl Store {
    fn push(&mut self, numbers: &Numbers) {
        self.pending.push(*numbers);
        if self.pending.len() == LANES {
            self.close();
        }
    }

    /// Fills the last group with bridges.
    fn fill(&mut self) {
        while !self.pending.is_empty() {
            self.push(&Numbers::BRIDGE);
        }
    }

    fn close(&mut self) {
        let key = self
            .pending
            .iter()
            .flat_map(|n| n.core.iter().chain(&n.gram))
            .map(|c| c.to_bits())
            .collect();
        let next = self.core.len() as u32;
        let group = *self.known.entry(key).or_insert(next);
        if group == next {
            let mut core = [[0.0; LANES]; place::COUNT];
            let mut gram = [[0.0; LANES]; place::GRAM_COUNT];
            for (lane, numbers) in self.pending.iter().enumerate() {
                for (row, c) in core.iter_mut().zip(numbers.core) {
                    row[lane] = c;
                }
                for (row, c) in gram.iter_mut().zip(numbers.gram) {
                    row[lane] = c;
                }
            }
            self.core.push(core);
            self.gram.push(gram);
        }
        self.groups.push(group);
        self.pending.clear();
    }
}

fn check(
    law: CableLaw,
    cable: &Cable,
    element: &CableElement,
    number: usize,
    e: usize,
) -> Result<(), ElementError> {
    let in_range = |ok: bool, name, value, range| {
        if ok {
            Ok(())
        } else {
            Err(ElementError::OutOfRange { cable: number, element: e, name, value, range })
        }
    };
    let positive =
        |name, x: f64| in_range(x > 0.0 && x.is_finite(), name, x, "positive and finite");
    let not_negative =
        |name, x: f64| in_range(x >= 0.0 && x.is_finite(), name, x, "finite and not negative");

    positive("the length", element.length)?;
    let sections = &element.sections;
    for s in sections.lobatto.iter().chain(&sections.gauss).chain(&sections.bending) {
        not_negative("the axial stiffness EA", s.axial_stiffness)?;
        not_negative("the bending stiffness EI", s.bending_stiffness)?;
        not_negative("the mass per length", s.mass_per_length)?;
    }
    not_negative("the retardation time", element.retardation_time)?;
    if !law.damped && element.retardation_time != 0.0 {
        return Err(ElementError::UnusedDamping {
            cable: number,
            element: e,
            value: element.retardation_time,
        });
    }
    if law.tension_only {
        let rho = cable.slack.residual_stiffness;
        in_range(
            rho > 0.0 && rho < 1.0,
            "the residual stiffness",
            rho,
            "between 0 and 1, exclusive",
        )?;
        positive("the smoothing of slack", cable.slack.smoothing)?;
    }
    if law.plastic {
        positive("the yield strain", cable.yielding.strain)?;
        not_negative("the isotropic hardening", cable.yielding.isotropic)?;
        not_negative("the kinematic hardening", cable.yielding.kinematic)?;
    }
    match (law.reference, element.reference) {
        (Reference::Planar, None) => {
            Err(ElementError::MissingReference { cable: number, element: e })
        }
        (Reference::Straight, Some(_)) => {
            Err(ElementError::UnusedReference { cable: number, element: e })
        }
        (Reference::Straight, None) => Ok(()),
        (Reference::Planar, Some(x)) => {
            let n = cable.normal;
            let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
            let norm = dot(n, n).sqrt();
            in_range((norm - 1.0).abs() < 1e-9, "the norm of the normal", norm, "1")?;
            for t in [x[1], x[3]] {
                let norm = dot(t, t).sqrt();
                in_range((norm - 1.0).abs() < 1e-6, "the norm of a reference slope", norm, "1")?;
            }
            let chord = std::array::from_fn(|c| (x[2][c] - x[0][c]) / element.length);
            for along in [chord, x[1], x[3]] {
                let distance = dot(n, along);
                if distance.is_nan() || distance.abs() >= 1e-9 {
                    return Err(ElementError::NotPlanar { cable: number, element: e, distance });
                }
            }
            Ok(())
        }
    }
}
