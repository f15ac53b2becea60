//! Beams: their elements in blocks, one for each body.

use crate::document::{Arrays, row};
use crate::dof_map::DofMap;
use crate::error::ModelError;
use crate::model::Placed;
use crate::spec::{Array, BeamSpec, LockingSpec, ModelSpec};
use pliant_dae::structure::Structure;
use pliant_elements::{BeamBlock, BeamElement, BeamLaw, Block, Locking};

/// Blocks of all beams.
pub(super) fn beam_blocks(
    spec: &ModelSpec,
    arrays: Arrays<'_>,
    map: &DofMap,
    structure: &mut Structure,
) -> Result<Vec<Placed<Box<BeamBlock>>>, ModelError> {
    let mut blocks = Vec::with_capacity(spec.beams.len());
    for (beam, map_of) in spec.beams.iter().zip(&map.beams) {
        let place = |what: &str| format!("beam '{}', {what}", beam.name);
        let n = map_of.elements();
        let sampled = |array, points: usize, what: &str| {
            arrays.sized(array, &[3 * points, 3 * points * n], &place(what))
        };
        let (stretch, bend, mass) = (
            sampled(&beam.stretch, 3, "stretch")?,
            sampled(&beam.bend, 3, "bend")?,
            sampled(&beam.mass, 5, "mass")?,
        );
        let reference = arrays.get(&beam.reference, &place("reference"))?;
        let elements: Vec<BeamElement> = (0..n)
            .map(|e| BeamElement {
                nodes: [e, e + 1].map(|node| map_of.offset(node, 0) as u32),
                length: map_of.lengths[e],
                reference: std::array::from_fn(|k| row(reference, 4 * e + k)),
                stretch: rows(stretch, e),
                bend: rows(bend, e),
                mass: rows(mass, e),
            })
            .collect();
        let points = points(&beam.section_points, arrays, &place("section_points"))?;
        let block = BeamBlock::new(law(beam, points), &elements)
            .map_err(|source| ModelError::Beam { beam: beam.name.clone(), source })?;
        let placed = Placed::new(Box::new(block), structure);
        for e in 0..n {
            let groups = [e, e + 1].map(|node| map.group[map_of.offset(node, 0)]);
            structure.add_element_at(&groups, placed.slot_of(e));
        }
        blocks.push(placed);
    }
    Ok(blocks)
}

fn law(beam: &BeamSpec, section_points: Vec<[f64; 3]>) -> BeamLaw {
    BeamLaw {
        youngs_modulus: beam.youngs_modulus,
        poisson_ratio: beam.poisson_ratio,
        density: beam.density,
        retardation_time: beam.retardation_time,
        locking: match beam.locking {
            LockingSpec::Enhanced => Locking::Enhanced,
            LockingSpec::Poisson => Locking::Poisson,
            LockingSpec::None => Locking::None,
        },
        section_points,
    }
}

fn points(array: &Array, arrays: Arrays<'_>, place: &str) -> Result<Vec<[f64; 3]>, ModelError> {
    let numbers = arrays.get(array, place)?;
    Ok((0..numbers.len() / 3).map(|k| row(numbers, k)).collect())
}

/// Numbers of element `e` at N points; one set serves for all.
fn rows<const N: usize>(samples: &[f64], e: usize) -> [[f64; 3]; N] {
    let first = if samples.len() == 3 * N { 0 } else { N * e };
    std::array::from_fn(|k| row(samples, first + k))
}

/// Energy at a strain of one [J], as a measure of rounding in elastic energies.
pub(super) fn stiffness_scale(blocks: &[Placed<Box<BeamBlock>>]) -> f64 {
    let each = |b: &BeamBlock| (0..b.element_count()).map(|e| b.stiffness_scale(e)).sum::<f64>();
    blocks.iter().map(|placed| each(&placed.block)).sum()
}
