//! From the data of elements to a block.

use std::collections::HashMap;

use super::{SurfaceBlock, SurfaceLaw};
use crate::elements::cable::Bending;
use crate::elements::surface::{Chart, Integrals, SurfaceKind};
use crate::error::ElementError;
use crate::integrals::surface::{Table, place};
use crate::materials::PlaneStress;

/// One element.
#[derive(Clone, Debug, PartialEq)]
pub struct SurfaceElement {
    /// First coordinate of each nodal vector, node by node.
    pub vectors: Vec<u32>,
    /// Parameters (u, v) of the corners; quadrilaterals are rectangles there.
    pub chart: Chart,
    /// Stress-free nodal vectors.
    pub reference: Vec<[f64; 3]>,
    /// Thickness [m].
    pub thickness: f64,
}

impl SurfaceBlock {
    /// A block of elements.
    ///
    /// # Errors
    /// [`ElementError`] naming the element and the number that is wrong.
    pub fn new(
        kind: SurfaceKind,
        law: SurfaceLaw,
        elements: &[SurfaceElement],
    ) -> Result<Self, ElementError> {
        check_law(kind, &law)?;
        let n = kind.vectors();
        let mut block = Self {
            kind,
            law,
            linear: law.material.linear(),
            density: law.density,
            tables: Vec::new(),
            table_of: Vec::with_capacity(elements.len()),
            thickness: Vec::with_capacity(elements.len()),
            offsets: Vec::with_capacity(n * elements.len()),
            extent: 0,
        };
        let width = block.width();
        let mut known: HashMap<Vec<i64>, u32> = HashMap::new();
        for (e, element) in elements.iter().enumerate() {
            let out_of_range =
                |name, value, range| ElementError::FaceOutOfRange { face: e, name, value, range };
            for count in [element.vectors.len(), element.reference.len()] {
                if count != n {
                    return Err(out_of_range(
                        "the number of nodal vectors",
                        count as f64,
                        "that of its kind",
                    ));
                }
            }
            let h = element.thickness;
            if !(h > 0.0 && h.is_finite()) {
                return Err(out_of_range("the thickness", h, "positive and finite"));
            }
            let table = Table::new(kind, &law, &element.chart, &element.reference, width);
            let table = table.ok_or(ElementError::Degenerate { face: e })?;
            if law.bending == Bending::Simplified {
                let curved = kind.bends() && !is_flat(kind, element);
                if curved {
                    return Err(ElementError::Curved { face: e });
                }
            }
            let next = block.tables.len() as u32;
            let number = *known.entry(table.key()).or_insert(next);
            if number == next {
                block.tables.push(table);
            }
            block.table_of.push(number);
            block.thickness.push(h);
            block.offsets.extend_from_slice(&element.vectors);
        }
        block.extent = block.offsets.iter().map(|&o| o as usize + 3).max().unwrap_or(0);
        Ok(block)
    }
}

/// Whether the stress-free surface has no curvature, to rounding.
fn is_flat(kind: SurfaceKind, element: &SurfaceElement) -> bool {
    kind.mass_rule().iter().all(|point| {
        let Some(here) = place(kind, &element.chart, &element.reference, point.at) else {
            return false;
        };
        let size = (here.density * kind.parameter_area(&element.chart)).sqrt();
        here.curvature.iter().all(|b| b.abs() * size < 1e-9)
    })
}

fn check_law(kind: SurfaceKind, law: &SurfaceLaw) -> Result<(), ElementError> {
    let linear = matches!(law.material, PlaneStress::SaintVenantKirchhoff(_));
    if law.integrals == Integrals::Precomputed && !(linear && kind.exact_rule().is_some()) {
        return Err(ElementError::NotPrecomputed { kind: kind.name() });
    }
    let rubber = matches!(law.material, PlaneStress::NeoHookean(_));
    let damped = law.retardation_time != 0.0;
    if kind.bends() && law.bending == Bending::Simplified && (rubber || damped) {
        return Err(ElementError::NotSimplified { kind: kind.name() });
    }
    let linear = law.material.linear();
    let in_range = |ok: bool, name, value, range| {
        if ok { Ok(()) } else { Err(ElementError::LawOutOfRange { name, value, range }) }
    };
    let (e, nu) = (linear.youngs_modulus, linear.poisson_ratio);
    in_range(e > 0.0 && e.is_finite(), "Young's modulus", e, "positive and finite")?;
    in_range(nu > -1.0 && nu <= 0.5, "Poisson's ratio", nu, "above -1 and at most 0.5")?;
    let tau = law.retardation_time;
    in_range(tau >= 0.0 && tau.is_finite(), "the retardation time", tau, "finite, not negative")?;
    let rho = law.density;
    in_range(rho > 0.0 && rho.is_finite(), "the density", rho, "positive and finite")?;
    if let PlaneStress::TensionField(field) = law.material {
        let eta = field.residual_stiffness;
        in_range((0.0..=1.0).contains(&eta), "the residual stiffness", eta, "from 0 to 1")?;
    }
    Ok(())
}
