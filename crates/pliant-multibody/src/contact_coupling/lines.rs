//! The lines that may touch: elements of cables, and of the centre lines of beams.

use super::Segment;
use crate::beam_map::BeamMap;
use crate::document::Arrays;
use crate::dof_map::DofMap;
use crate::error::ModelError;
use crate::spec::{Array, ModelSpec};
use std::collections::HashMap;

/// The elements of line number `line`: cables count first, then beams.
pub(crate) fn line_of(
    spec: &ModelSpec,
    arrays: Arrays<'_>,
    map: &DofMap,
    line: usize,
    place: &str,
) -> Result<Vec<Segment>, ModelError> {
    let beam = line.checked_sub(spec.cables.len()).and_then(|beam| spec.beams.get(beam));
    match (beam, map.beams.get(line.wrapping_sub(spec.cables.len()))) {
        (Some(beam), Some(map)) => of_beam(&beam.radius, arrays, map, place),
        _ => of_cable(spec, arrays, map, line, place),
    }
}

/// Least mass per length of a line [kg/m].
pub(crate) fn mass_per_length(
    spec: &ModelSpec,
    arrays: Arrays<'_>,
    line: usize,
    place: &str,
) -> Result<f64, ModelError> {
    let least = |x: f64, y: &f64| x.min(*y);
    if let Some(cable) = spec.cables.get(line) {
        return Ok(arrays.get(&cable.mass_per_length, place)?.iter().fold(f64::INFINITY, least));
    }
    let count = spec.cables.len() + spec.beams.len();
    let beam = spec.beams.get(line - spec.cables.len()).ok_or_else(|| none(line, count, place))?;
    let areas = arrays.get(&beam.mass, place)?.iter().step_by(3);
    Ok(beam.density * areas.fold(f64::INFINITY, least))
}

fn none(index: usize, count: usize, place: &str) -> ModelError {
    ModelError::Reference { place: place.to_owned(), kind: "line", index, count }
}

/// Radii of elements, one or one for each.
fn radii<'a>(
    radius: &'a Option<Array>,
    arrays: Arrays<'a>,
    elements: usize,
    place: &str,
) -> Result<&'a [f64], ModelError> {
    let none =
        || ModelError::Unsupported { place: place.to_owned(), reason: "its line has no radius" };
    let radius = radius.as_ref().ok_or_else(none)?;
    let positive: (fn(f64) -> bool, _) = (|x| x > 0.0, "radii are above zero");
    arrays.checked(radius, &[1, elements], place, positive)
}

/// The centre line of a beam: one strand, nothing follows at its ends.
fn of_beam(
    radius: &Option<Array>,
    arrays: Arrays<'_>,
    map: &BeamMap,
    place: &str,
) -> Result<Vec<Segment>, ModelError> {
    let elements = map.elements();
    let radius = radii(radius, arrays, elements, place)?;
    let mut start = 0.0;
    let segments = (0..elements).map(|e| {
        let ends = [e == 0, e + 1 == elements];
        let length = map.lengths[e];
        start += length;
        Segment {
            offsets: map.offsets(e),
            section: Some(
                [(e, 2), (e, 3), (e + 1, 2), (e + 1, 3)].map(|(node, k)| map.offset(node, k)),
            ),
            length,
            radius: radius[if radius.len() == 1 { 0 } else { e }],
            start: start - length,
            strand: [f64::NEG_INFINITY, f64::INFINITY],
            last: ends[1],
            round: ends,
            free: ends,
        }
    });
    Ok(segments.collect())
}

/// The elements of a cable. Of several strands that end at one point, one has the round end there.
fn of_cable(
    spec: &ModelSpec,
    arrays: Arrays<'_>,
    map: &DofMap,
    cable: usize,
    place: &str,
) -> Result<Vec<Segment>, ModelError> {
    let count = spec.cables.len() + spec.beams.len();
    let (Some(cable_map), Some(cable_spec)) = (map.cables.get(cable), spec.cables.get(cable))
    else {
        return Err(none(cable, count, place));
    };
    let elements = cable_map.elements();
    let radius = radii(&cable_spec.radius, arrays, elements, place)?;
    let mut users: HashMap<u32, usize> = HashMap::new();
    let ends = |strand: usize| {
        let nodes = cable_map.strand_nodes(strand);
        [nodes.start, nodes.end - 1].map(|n| cable_map.nodes[n].r)
    };
    for strand in 0..cable_map.strands.len() {
        for r in ends(strand) {
            *users.entry(r).or_default() += 1;
        }
    }
    let mut rounded = HashMap::new();
    let mut segments = Vec::with_capacity(elements);
    let mut start = 0.0;
    for (strand, range) in cable_map.strands.iter().enumerate() {
        let [first, last] = ends(strand);
        let whole: f64 = range.clone().map(|e| cable_map.lengths[e]).sum();
        let along = [start, start + whole];
        for e in range.clone() {
            let node = cable_map.first_node(e);
            let (a, b) = (cable_map.nodes[node], cable_map.nodes[node + 1]);
            let mut round = [false; 2];
            let mut free = [false; 2];
            for (end, (r, here)) in
                [(first, e == range.start), (last, e + 1 == range.end)].into_iter().enumerate()
            {
                if here {
                    round[end] = rounded.insert((r, end), ()).is_none()
                        && (end == 0 || !rounded.contains_key(&(r, 0)));
                    free[end] = users[&r] == 1;
                }
            }
            let length = cable_map.lengths[e];
            segments.push(Segment {
                offsets: [a.r, a.t, b.r, b.t].map(|o| o as usize),
                section: None,
                length,
                radius: radius[if radius.len() == 1 { 0 } else { e }],
                start,
                strand: along,
                last: e + 1 == range.end,
                round,
                free,
            });
            start += length;
        }
    }
    Ok(segments)
}
