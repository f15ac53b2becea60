//! The chambers of a document: faces and rims become parts of a volume, with a multiplier and elements of their own.

use super::Builder;
use crate::chambers::volume::{Part, RimPoint, area};
use crate::chambers::{Chamber, PlacedPart};
use crate::error::ModelError;
use crate::loads::pressure::Face;
use crate::model::{Beginning, PlacedIntegral};
use crate::point::Support;
use crate::signal::Value;
use crate::spec::{ChamberSpec, ClosureSpec, ModelSpec, RimSpec};
use crate::vector::vector;
use nalgebra::Matrix3;
use pliant_dae::structure::Storage;

impl Builder<'_> {
    /// The chambers, whose multipliers begin at `first`, and the integrals that are their masses.
    pub(super) fn chambers(
        &mut self,
        spec: &ModelSpec,
        first: usize,
        integrals: &mut Vec<PlacedIntegral>,
    ) -> Result<Vec<Chamber>, ModelError> {
        let mut chambers = Vec::with_capacity(spec.chambers.len());
        for (number, chamber) in spec.chambers.iter().enumerate() {
            let place = format!("chamber '{}'", chamber.name);
            let multiplier = self.structure.velocities() + first + number;
            let group = self.structure.add_group(multiplier..multiplier + 1);
            let mut parts = Vec::new();
            for (part, support) in self.parts(chamber, &place)? {
                let mut groups = support.groups.clone();
                groups.push(group);
                let element = self.structure.add_element(&groups, Storage::Symmetric);
                parts.push(PlacedPart { part, support, element });
            }
            let rate = match &chamber.inflow {
                Some(signal) => Value::new(signal, &place)?,
                None => Value::Constant([0.0; 3]),
            };
            let from = Beginning::Mass(number);
            let numbers = (first + number, integrals.len());
            integrals.push(PlacedIntegral { rate, from, in_statics: true });
            chambers.push(Chamber::new(chamber, parts, numbers, self.q)?);
        }
        Ok(chambers)
    }

    fn parts(&self, spec: &ChamberSpec, place: &str) -> Result<Vec<(Part, Support)>, ModelError> {
        let mut parts = Vec::new();
        for faces in &spec.faces {
            for (Face { block, element }, support) in
                self.faces_of(faces.surface, &faces.faces, place)?
            {
                parts.push((Part::Face { block, element }, support));
            }
        }
        for rim in &spec.rims {
            parts.extend(self.rim(rim, spec, place)?);
        }
        Ok(parts)
    }

    /// A part for each side; for all sides together where a lid closes them.
    fn rim(
        &self,
        rim: &RimSpec,
        spec: &ChamberSpec,
        place: &str,
    ) -> Result<Vec<(Part, Support)>, ModelError> {
        let mut sides: Vec<Vec<RimPoint>> = Vec::new();
        for on in &rim.sides {
            let map = self.map.surface(on.surface, place)?;
            for side in map.sides(self.arrays, &on.sides, place)? {
                sides.push(map.rim_points(side));
            }
        }
        let support = |points: &[RimPoint]| self.support(points.iter().flat_map(|p| [&p.r, &p.d]));
        if let ClosureSpec::Lid { projection, shift } = rim.closure {
            let points: Vec<RimPoint> = sides.concat();
            let support = support(&points);
            let projection = Matrix3::from(projection).transpose();
            return Ok(vec![(Part::Lid { points, projection, shift: vector(shift) }, support)]);
        }
        let part = |points: Vec<RimPoint>| match rim.closure {
            ClosureSpec::Plane { apex, normal } => {
                Part::Plane { points, apex: vector(apex), normal: vector(normal) }
            }
            ClosureSpec::Held { apex } | ClosureSpec::Lid { shift: apex, .. } => {
                let (apex, o) = (vector(apex), vector(spec.origin));
                let volume = (apex - o).dot(&area(&points, apex, self.q)) / 3.0;
                Part::Held { points, volume }
            }
        };
        Ok(sides
            .into_iter()
            .map(|points| (support(&points), points))
            .map(|(s, p)| (part(p), s))
            .collect())
    }
}
