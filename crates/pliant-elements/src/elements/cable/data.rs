//! Data of cables: law, section, elements.

/// Axial strain measure.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Strain {
    /// `eps = (|r'|^2/|r0'|^2 - 1)/2`.
    #[default]
    GreenLagrange,
    /// `eps = |r'|/|r0'| - 1`.
    Biot,
}

/// Quadrature of the axial energy.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Integration {
    /// Lobatto, 3 points: fourth order uniformly in EA/EI, no locking.
    #[default]
    Lobatto,
    /// Gauss, 5 points: exact for Green-Lagrange strain; locks in slender cables.
    Full,
}

/// Curvature measure; bending is integrated with 3 Gauss points.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Bending {
    /// Material curvature `|r' x r''|/|r'|^2/J0`, conjugate to the moment.
    #[default]
    Exact,
    /// `|r''|/J0^2`: right where |r'| stays near 1. With a planar reference it knows no sign of curvature and
    /// no stiffness out of the plane.
    Simplified,
}

/// Stress-free shape.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Reference {
    /// Straight.
    #[default]
    Straight,
    /// Curved in a plane with fixed normal, signed curvature.
    Planar,
}

/// What the elements of a block have in common.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct CableLaw {
    /// Axial strain measure.
    pub strain: Strain,
    /// Axial quadrature.
    pub integration: Integration,
    /// Curvature measure.
    pub bending: Bending,
    /// Stress-free shape.
    pub reference: Reference,
    /// Whether compression is (almost) without force.
    pub tension_only: bool,
    /// Whether there is Kelvin-Voigt damping.
    pub damped: bool,
    /// Whether winches change the stress-free lengths.
    pub wound: bool,
    /// Whether the line yields where it is stretched too far; bending stays elastic.
    pub plastic: bool,
}

impl CableLaw {
    /// Number of different laws.
    pub const COUNT: usize = 256;

    /// The law of a code.
    #[must_use]
    #[inline(always)]
    pub const fn from_code(code: u8) -> Self {
        Self {
            strain: if code & 1 == 0 { Strain::GreenLagrange } else { Strain::Biot },
            integration: if code & 2 == 0 { Integration::Lobatto } else { Integration::Full },
            bending: if code & 4 == 0 { Bending::Exact } else { Bending::Simplified },
            reference: if code & 8 == 0 { Reference::Straight } else { Reference::Planar },
            tension_only: code & 16 != 0,
            damped: code & 32 != 0,
            wound: code & 64 != 0,
            plastic: code & 128 != 0,
        }
    }

    /// The code of the law.
    #[must_use]
    pub const fn code(self) -> u8 {
        self.strain as u8
            | (self.integration as u8) << 1
            | (self.bending as u8) << 2
            | (self.reference as u8) << 3
            | (self.tension_only as u8) << 4
            | (self.damped as u8) << 5
            | (self.wound as u8) << 6
            | (self.plastic as u8) << 7
    }

    /// Whether the axial part is evaluated from the precomputed Gram form.
    #[inline(always)]
    pub(crate) const fn uses_gram(self) -> bool {
        matches!(self.integration, Integration::Full)
            && matches!(self.strain, Strain::GreenLagrange)
            && !self.tension_only
            && !self.plastic
    }
}

/// Stiffness and mass of a cross section, per unit of reference length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Section {
    /// EA [N].
    pub axial_stiffness: f64,
    /// EI [N m^2].
    pub bending_stiffness: f64,
    /// rho A [kg/m].
    pub mass_per_length: f64,
}

/// Sections along one element, sampled where the rules need them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sections {
    /// At the 3 Lobatto points.
    pub(crate) lobatto: [Section; 3],
    /// At the 5 Gauss points.
    pub(crate) gauss: [Section; 5],
    /// At the 3 Gauss points.
    pub(crate) bending: [Section; 3],
}

impl Sections {
    /// The same section all along.
    #[must_use]
    pub const fn constant(section: Section) -> Self {
        Self { lobatto: [section; 3], gauss: [section; 5], bending: [section; 3] }
    }

    /// Samples a section that depends on xi in [0, 1] of the element.
    #[must_use]
    pub fn sample(section: impl Fn(f64) -> Section) -> Self {
        use pliant_math::quadrature::{GAUSS_3, GAUSS_5, LOBATTO_3};
        Self {
            lobatto: LOBATTO_3.xi.map(&section),
            gauss: GAUSS_5.xi.map(&section),
            bending: GAUSS_3.xi.map(&section),
        }
    }
}

/// Parameters of one element.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CableElement {
    /// Length of the stress-free line L [m]. The initial shape may be stretched.
    pub length: f64,
    /// Sections along the element.
    pub sections: Sections,
    /// Retardation time of the Kelvin-Voigt law tau [s]; 0 in laws without damping.
    pub retardation_time: f64,
    /// Stress-free (r1, t1, r2, t2) for laws with a planar reference: unit t, L the arc length.
    pub reference: Option<[[f64; 3]; 4]>,
}

/// How a cable without compression goes slack.
///
/// `N = EA [(1 - rho)/2 (eps + sqrt(eps^2 + d^2) - d) + rho eps]` with the residual stiffness rho and the width d.
/// The shift by d keeps the reference free of stress; in tension it lowers N by `(1 - rho) EA d/2`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slack {
    /// rho: stiffness in compression over stiffness in tension; keeps a slack cable regular.
    pub residual_stiffness: f64,
    /// d: strain over which the cable goes slack.
    pub smoothing: f64,
}

impl Default for Slack {
    fn default() -> Self {
        Self { residual_stiffness: 1e-4, smoothing: 1e-6 }
    }
}

/// When a line yields and how it hardens, bilinear: stresses over Young's modulus.
///
/// With the plastic strain eps_p and its path alpha (what it has gone through, to and fro) the stress is
/// `sigma = E (eps - eps_p)`, and the line yields where `|sigma - K eps_p| = sigma_y + H alpha`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Yielding {
    /// Strain at which a new line yields, sigma_y / E.
    pub strain: f64,
    /// Isotropic hardening H / E: the elastic range grows.
    pub isotropic: f64,
    /// Kinematic hardening K / E: the elastic range moves.
    pub kinematic: f64,
}

impl Yielding {
    /// Of a law without any; bridges between cables have it, too.
    pub const NONE: Self = Self { strain: 1.0, isotropic: 0.0, kinematic: 0.0 };
}

/// Where a node's coordinates are in the global vectors.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NodeOffsets {
    /// First of the three position coordinates; may be shared with other cables.
    pub r: u32,
    /// First of the three slope coordinates.
    pub t: u32,
}

/// One cable of a block.
#[derive(Clone, Debug, PartialEq)]
pub struct Cable {
    /// Nodes along the cable.
    pub nodes: Vec<NodeOffsets>,
    /// Parameters: one set for all elements, or one set for each.
    pub elements: Vec<CableElement>,
    /// Unit normal of the plane of a planar reference; unused otherwise.
    pub normal: [f64; 3],
    /// How the cable goes slack; used by tension-only laws.
    pub slack: Slack,
    /// When it yields; used by plastic laws.
    pub yielding: Yielding,
}
