//! Beams in a document.

use super::{Array, default_array};
use serde::{Deserialize, Serialize};

/// A beam; nodal vectors r, r,x r,y and r,z come node by node.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BeamSpec {
    /// Name of the body.
    pub name: String,
    /// Stress-free nodal vectors, (nodes, 4, 3).
    pub reference: Array,
    /// Nodal vectors at the start, (nodes, 4, 3), or empty where they are stress-free.
    pub q: Array,
    /// Their velocities, (nodes, 4, 3), or empty for none.
    pub v: Array,
    /// Lengths of the elements along the stress-free line, (elements,) [m].
    pub lengths: Array,
    /// Area [m^2] and shear corrections along y and z at the start, in the middle and at the end of each element,
    /// (elements, 3, 3), or the same for all, (1, 3, 3).
    pub stretch: Array,
    /// Second moments I_y, I_z and torsion constant [m^4] at three Gauss points, (elements, 3, 3) or (1, 3, 3).
    pub bend: Array,
    /// Area [m^2], I_y and I_z [m^4] at five Gauss points, for the mass, (elements, 5, 3) or (1, 5, 3).
    pub mass: Array,
    /// Young's modulus [Pa].
    pub youngs_modulus: f64,
    /// Poisson's ratio.
    pub poisson_ratio: f64,
    /// Mass per volume [kg/m^3].
    pub density: f64,
    /// Kelvin-Voigt retardation time [s].
    pub retardation_time: f64,
    /// Strains.
    pub locking: LockingSpec,
    /// Points of the section (y, z, part of the area) [m, m, m^2], (points, 3), for the laws of the continuum.
    #[serde(default = "default_array")]
    pub section_points: Array,
    /// Radius for contact [m]: (1,) or (elements,); none where it touches nothing.
    #[serde(default)]
    pub radius: Option<Array>,
}

/// Remedy against locking.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum LockingSpec {
    /// Section law on assumed strains.
    Enhanced,
    /// The continuum with Poisson's ratio on the axis only.
    Poisson,
    /// The continuum.
    None,
}
