//! Cables: their elements in blocks, one for each law, and their masses.

use crate::altered::{Plastic, check_past};
use crate::document::{Arrays, row};
use crate::dof_map::DofMap;
use crate::error::ModelError;
use crate::model::{Placed, StrandPlace};
use crate::spec::{BendingSpec, CableSpec, IntegrationSpec, ModelSpec, PlasticSpec, StrainSpec};
use pliant_dae::structure::Structure;
use pliant_elements::{
    Bending, Cable, CableBlock, CableElement, CableLaw, ElementError, Integration, PAST, Reference,
    Section, Sections, Slack, Strain, Yielding,
};
use pliant_math::quadrature::{GAUSS_3, GAUSS_5, LOBATTO_3};

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
        wound: cable.rest_length.is_some(),
        plastic: cable.plastic.is_some(),
    }
}

type CableBlocks = (Vec<Placed<Box<CableBlock>>>, Vec<Vec<StrandPlace>>);

/// One block for each law; every strand is a cable of its block.
pub(super) fn blocks(
    spec: &ModelSpec,
    arrays: Arrays<'_>,
    map: &DofMap,
    structure: &mut Structure,
) -> Result<CableBlocks, ModelError> {
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
                yielding: cable.plastic.as_ref().map_or(Yielding::NONE, PlasticSpec::law),
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
        blocks.push(Placed::new(Box::new(block), structure));
    }
    for (cable_map, strands) in map.cables.iter().zip(&places) {
        for (k, place) in strands.iter().enumerate() {
            let placed = &blocks[place.block];
            for (i, pair) in cable_map.nodes[cable_map.strand_nodes(k)].windows(2).enumerate() {
                let offsets = [pair[0].r, pair[0].t, pair[1].r, pair[1].t];
                let groups = map.groups_of(offsets.map(|o| o as usize));
                structure.add_element_at(&groups, placed.slot_of(place.element + i));
            }
        }
    }
    Ok((blocks, places))
}

/// Where the cables that yield keep what their points remember.
pub(super) fn plastic(
    spec: &ModelSpec,
    map: &DofMap,
    strands: &[Vec<StrandPlace>],
    blocks: &[Placed<Box<CableBlock>>],
) -> Vec<Plastic> {
    let mut found = Vec::new();
    let (mut next, mut winches) = (0, 0);
    for (cable, spec) in spec.cables.iter().enumerate() {
        let winch = spec.rest_length.is_some().then_some(winches);
        winches += usize::from(winch.is_some());
        if spec.plastic.is_none() {
            continue;
        }
        let places = &strands[cable];
        let width = PAST * places.first().map_or(0, |p| blocks[p.block].block.axial_points());
        let counts = map.cables[cable].strands.iter().map(ExactSizeIterator::len);
        let end = next + width * map.cables[cable].elements();
        found.push(Plastic {
            cable,
            range: next..end,
            width,
            winch,
            strands: places.iter().copied().zip(counts).collect(),
        });
        next = end;
    }
    found
}

/// What the points of cables that yield remember at the start.
pub(super) fn initial_past(
    spec: &ModelSpec,
    arrays: Arrays<'_>,
    plastic: &[Plastic],
) -> Result<Vec<f64>, ModelError> {
    let mut past = Vec::new();
    for place in plastic {
        let cable = &spec.cables[place.cable];
        let Some(law) = &cable.plastic else { continue };
        let what = format!("cable '{}', past", cable.name);
        let given = arrays.sized(&law.past, &[0, place.range.len()], &what)?;
        check_past(given, &what)?;
        past.extend_from_slice(given);
        past.resize(place.range.end, 0.0);
    }
    Ok(past)
}

/// Energy at a strain of one, EA times the length [J], as a measure of rounding in elastic energies.
pub(super) fn axial_energy(
    cable: &CableSpec,
    arrays: Arrays<'_>,
    lengths: &[f64],
) -> Result<f64, ModelError> {
    let samples = arrays.get(&cable.axial_stiffness, "axial_stiffness")?;
    let largest = samples.iter().copied().fold(0.0, f64::max);
    Ok(largest * lengths.iter().sum::<f64>())
}

/// Mass of a cable [kg].
pub(super) fn cable_mass(
    cable: &CableSpec,
    arrays: Arrays<'_>,
    lengths: &[f64],
) -> Result<f64, ModelError> {
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
        _ => None,
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
