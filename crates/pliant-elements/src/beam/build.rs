//! From the data of elements to a block.

use std::collections::HashMap;

use super::{BeamBlock, Group, LANES};
use crate::elements::beam::place;
use crate::error::ElementError;
use crate::integrals::beam::{Table, table};

/// How sections deform, and what is done against locking.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Locking {
    /// Section law on assumed strains: free of locking, fourth order in bending.
    #[default]
    Enhanced,
    /// The continuum with Poisson's ratio on the axis only: second order, constant curvature in an element.
    Poisson,
    /// The continuum: too stiff in bending by E over the confined modulus, whatever the mesh.
    None,
}

/// What the elements of a block have in common.
#[derive(Clone, Debug, PartialEq)]
pub struct BeamLaw {
    /// Young's modulus [Pa].
    pub youngs_modulus: f64,
    /// Poisson's ratio.
    pub poisson_ratio: f64,
    /// Mass per volume [kg/m^3].
    pub density: f64,
    /// Retardation time of the Kelvin-Voigt law [s]: every stress for the rate of its strain; 0: none.
    pub retardation_time: f64,
    /// Strains.
    pub locking: Locking,
    /// Points of the section (y, z, part of the area) [m, m, m^2]; only the laws of the continuum read them.
    pub section_points: Vec<[f64; 3]>,
}

impl BeamLaw {
    /// Shear modulus [Pa].
    #[must_use]
    pub fn shear_modulus(&self) -> f64 {
        0.5 * self.youngs_modulus / (1.0 + self.poisson_ratio)
    }
}

/// Rate of the measure of twist below which an element turns too far at rest.
const LEAST_RATE: f64 = 0.3;

/// One element.
#[derive(Clone, Debug, PartialEq)]
pub struct BeamElement {
    /// First coordinates of its nodes.
    pub nodes: [u32; 2],
    /// Length along the stress-free line [m].
    pub length: f64,
    /// Stress-free nodal vectors (r1, x1, y1, z1, r2, x2, y2, z2).
    pub reference: [[f64; 3]; 8],
    /// Area [m^2] and shear corrections along y and z at the start, in the middle and at the end.
    pub stretch: [[f64; 3]; 3],
    /// Second moments of area I_y, I_z and torsion constant [m^4] at three Gauss points.
    pub bend: [[f64; 3]; 3],
    /// Area [m^2], I_y and I_z [m^4] at five Gauss points, for the mass.
    pub mass: [[f64; 3]; 5],
}

impl BeamBlock {
    /// A block of elements.
    ///
    /// # Errors
    /// [`ElementError`] naming the element and the number that is wrong.
    pub fn new(law: BeamLaw, elements: &[BeamElement]) -> Result<Self, ElementError> {
        check_law(&law)?;
        let mut block = Self {
            law,
            tables: Vec::new(),
            table_of: Vec::with_capacity(elements.len()),
            groups: Vec::new(),
            nodes: elements.iter().map(|element| element.nodes).collect(),
            areas: elements.iter().map(|element| element.stretch[1][0]).collect(),
            extent: 0,
        };
        let mut known: HashMap<Vec<i64>, u32> = HashMap::new();
        for (e, element) in elements.iter().enumerate() {
            check_element(e, element)?;
            let numbers = table(&block.law, element);
            if numbers.iter().any(|x| !x.is_finite()) {
                let range = "frames that are right-handed and finite";
                let name = "the stress-free shape";
                return Err(ElementError::BeamOutOfRange {
                    element: e,
                    name,
                    value: f64::NAN,
                    range,
                });
            }
            let rate = numbers[place::TWIST];
            if rate < LEAST_RATE {
                let name = "the cosine of the turn of its sections at rest";
                let range = "above 0.3: take more elements";
                return Err(ElementError::BeamOutOfRange { element: e, name, value: rate, range });
            }
            let next = block.tables.len() as u32;
            let number = *known.entry(key(&numbers)).or_insert(next);
            if number == next {
                block.tables.push(numbers);
            }
            block.table_of.push(number);
        }
        for tables in block.table_of.chunks(LANES) {
            block.groups.push(if tables.iter().all(|&t| t == tables[0]) {
                Group::Shared(tables[0])
            } else {
                let mut own = Box::new([[0.0; LANES]; place::COUNT]);
                for lane in 0..LANES {
                    let table = &block.tables[tables[lane.min(tables.len() - 1)] as usize];
                    for (row, &x) in own.iter_mut().zip(table) {
                        row[lane] = x;
                    }
                }
                Group::Own(own)
            });
        }
        let last = block.nodes.iter().flatten().max();
        block.extent = last.map_or(0, |&node| node as usize + 12);
        Ok(block)
    }
}

/// Key under which equal tables are found: numbers to thirteen digits of the largest of their kind.
fn key(table: &Table) -> Vec<i64> {
    let mut key = Vec::with_capacity(table.len() + 4);
    for range in [place::H..place::G0, place::G0..place::MASS, place::MASS..place::COUNT] {
        let numbers = &table[range];
        let scale = numbers.iter().fold(f64::MIN_POSITIVE, |m, x| x.abs().max(m));
        key.push((scale.to_bits() >> 12) as i64);
        key.extend(numbers.iter().map(|&x| (x / scale * 1e13).round() as i64));
    }
    key
}

fn check_law(law: &BeamLaw) -> Result<(), ElementError> {
    let in_range = |ok: bool, name, value, range| {
        if ok { Ok(()) } else { Err(ElementError::LawOutOfRange { name, value, range }) }
    };
    let (e, nu) = (law.youngs_modulus, law.poisson_ratio);
    in_range(e > 0.0 && e.is_finite(), "Young's modulus", e, "positive and finite")?;
    in_range(nu > -1.0 && nu < 0.5, "Poisson's ratio", nu, "above -1 and below 0.5")?;
    let tau = law.retardation_time;
    in_range(tau >= 0.0 && tau.is_finite(), "the retardation time", tau, "finite, not negative")?;
    let rho = law.density;
    in_range(rho > 0.0 && rho.is_finite(), "the density", rho, "positive and finite")?;
    let points = law.section_points.len() as f64;
    let needed = law.locking != Locking::Enhanced && law.section_points.is_empty();
    in_range(!needed, "the number of points of the section", points, "at least 1 for this law")
}

fn check_element(e: usize, element: &BeamElement) -> Result<(), ElementError> {
    let check = |name, value: f64| {
        if value > 0.0 && value.is_finite() {
            Ok(())
        } else {
            let range = "positive and finite";
            Err(ElementError::BeamOutOfRange { element: e, name, value, range })
        }
    };
    check("the length", element.length)?;
    for numbers in element.stretch {
        for (name, value) in
            ["the area", "the shear correction", "the shear correction"].into_iter().zip(numbers)
        {
            check(name, value)?;
        }
    }
    for numbers in element.bend {
        let names =
            ["the second moment of area", "the second moment of area", "the torsion constant"];
        for (name, value) in names.into_iter().zip(numbers) {
            check(name, value)?;
        }
    }
    for numbers in element.mass {
        let names = ["the area", "the second moment of area", "the second moment of area"];
        for (name, value) in names.into_iter().zip(numbers) {
            check(name, value)?;
        }
    }
    Ok(())
}
