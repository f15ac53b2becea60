//! Surfaces: their elements in blocks, one for each body and kind.

use crate::document::Arrays;
use crate::dof_map::DofMap;
use crate::error::ModelError;
use crate::model::{FacePlace, Placed};
use crate::spec::{
    BendingSpec, IntegralsSpec, ModelSpec, QuadratureSpec, SurfaceMaterialSpec, SurfaceSpec,
};
use pliant_dae::structure::Structure;
use pliant_elements::materials::{NeoHookean, PlaneStress, SaintVenantKirchhoff, TensionField};
use pliant_elements::{
    Bending, Block, Integrals, Quadrature, SurfaceBlock, SurfaceElement, SurfaceLaw,
};
use std::sync::Arc;

fn law(surface: &SurfaceSpec, bends: bool) -> SurfaceLaw {
    let material = match surface.material {
        SurfaceMaterialSpec::SaintVenantKirchhoff { youngs_modulus, poisson_ratio } => {
            PlaneStress::SaintVenantKirchhoff(SaintVenantKirchhoff {
                youngs_modulus,
                poisson_ratio,
            })
        }
        SurfaceMaterialSpec::NeoHookean { youngs_modulus, poisson_ratio } => {
            PlaneStress::NeoHookean(NeoHookean::new(youngs_modulus, poisson_ratio, bends))
        }
        SurfaceMaterialSpec::TensionField { youngs_modulus, poisson_ratio, residual_stiffness } => {
            PlaneStress::TensionField(TensionField {
                elastic: SaintVenantKirchhoff { youngs_modulus, poisson_ratio },
                residual_stiffness,
            })
        }
    };
    SurfaceLaw {
        material,
        retardation_time: surface.retardation_time,
        density: surface.density,
        quadrature: match surface.quadrature {
            QuadratureSpec::Standard => Quadrature::Standard,
            QuadratureSpec::Reduced => Quadrature::Reduced,
            QuadratureSpec::Full => Quadrature::Full,
        },
        bending: match surface.bending {
            BendingSpec::Exact => Bending::Exact,
            BendingSpec::Simplified => Bending::Simplified,
        },
        integrals: match surface.integrals {
            IntegralsSpec::Quadrature => Integrals::Quadrature,
            IntegralsSpec::Precomputed => Integrals::Precomputed,
        },
    }
}

type SurfaceBlocks = (Vec<Placed<Arc<SurfaceBlock>>>, Vec<Vec<FacePlace>>);

/// Blocks of all surfaces, and the place of each face.
pub(super) fn surface_blocks(
    spec: &ModelSpec,
    arrays: Arrays<'_>,
    map: &DofMap,
    structure: &mut Structure,
) -> Result<SurfaceBlocks, ModelError> {
    let mut blocks: Vec<Placed<Arc<SurfaceBlock>>> = Vec::new();
    let mut places = Vec::with_capacity(spec.surfaces.len());
    for (surface, map_of) in spec.surfaces.iter().zip(&map.surfaces) {
        let place = format!("surface '{}', thickness", surface.name);
        let thickness = arrays.sized(&surface.thickness, &[1, map_of.faces.len()], &place)?;
        let mut own = Vec::with_capacity(map_of.faces.len());
        let mut start = 0;
        // Faces of one kind follow each other.
        for faces in map_of.faces.chunk_by(|a, b| a.kind == b.kind) {
            let kind = faces[0].kind;
            let elements: Vec<SurfaceElement> = faces
                .iter()
                .enumerate()
                .map(|(k, face)| SurfaceElement {
                    vectors: map_of.vectors_of(face).into_iter().map(|o| o as u32).collect(),
                    chart: face.chart,
                    reference: map_of.reference_of(face),
                    thickness: if thickness.len() == 1 {
                        thickness[0]
                    } else {
                        thickness[start + k]
                    },
                })
                .collect();
            let block = SurfaceBlock::new(kind, law(surface, kind.bends()), &elements);
            let block = block
                .map_err(|source| ModelError::Surface { surface: surface.name.clone(), source })?;
            let placed = Placed::new(Arc::new(block), structure);
            for (element, face) in faces.iter().enumerate() {
                let offsets = face.nodes.iter().map(|&node| map_of.offset(node, 0));
                let groups: Vec<usize> = offsets.map(|offset| map.group[offset]).collect();
                structure.add_element_at(&groups, placed.slot_of(element));
                own.push(FacePlace { block: blocks.len(), element });
            }
            blocks.push(placed);
            start += faces.len();
        }
        places.push(own);
    }
    Ok((blocks, places))
}

/// Energy at a strain of one [J], as a measure of rounding in elastic energies.
pub(super) fn stiffness_scale(blocks: &[Placed<Arc<SurfaceBlock>>]) -> f64 {
    let each = |b: &SurfaceBlock| (0..b.element_count()).map(|e| b.stiffness_scale(e)).sum::<f64>();
    blocks.iter().map(|placed| each(&placed.block)).sum()
}
