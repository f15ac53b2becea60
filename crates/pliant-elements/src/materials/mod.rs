//! Laws of materials for surfaces in plane stress: membrane strain and change of curvature to resultants.
//!
//! One file a law; this is their registry. Strains and resultants are in Voigt order (11, 22, 12) in the local
//! Cartesian frame of the reference surface: `e = (E11, E22, 2 E12)`, `k = (k11, k22, 2 k12)`, strain
//! `E + z k` at the height z above the middle surface. Energies are per reference area.

pub mod neo_hookean;
pub mod saint_venant_kirchhoff;
pub mod tension_field;

use pliant_math::Real;

pub use neo_hookean::NeoHookean;
pub use saint_venant_kirchhoff::SaintVenantKirchhoff;
pub use tension_field::TensionField;

/// Three numbers in Voigt order (11, 22, 12).
pub type Voigt<T> = [T; 3];

/// Derivatives of the resultants (N, M) by the strains (e, k).
pub type Stiffness = [[f64; 6]; 6];

/// Part of the surface in one of the regimes of a tension field.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Regime {
    /// Tension in every direction.
    Taut,
    /// Tension in one direction, wrinkles along it.
    Wrinkled,
    /// No tension.
    Slack,
}

/// A law of plane stress.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PlaneStress {
    /// Stress linear in the Green-Lagrange strain.
    SaintVenantKirchhoff(SaintVenantKirchhoff),
    /// Rubber.
    NeoHookean(NeoHookean),
    /// A film that wrinkles instead of carrying compression.
    TensionField(TensionField),
}

/// Calls a method of whichever law it is.
macro_rules! dispatch {
    ($self:expr, $law:ident => $call:expr) => {
        match $self {
            PlaneStress::SaintVenantKirchhoff($law) => $call,
            PlaneStress::NeoHookean($law) => $call,
            PlaneStress::TensionField($law) => $call,
        }
    };
}

impl PlaneStress {
    /// Energy per reference area at thickness `h`.
    #[inline(always)]
    pub fn energy<T: Real>(&self, h: f64, e: Voigt<T>, k: Voigt<T>) -> T {
        dispatch!(self, law => law.energy(h, e, k))
    }

    /// Membrane forces N and moments M, the derivatives of the energy by e and k.
    #[inline(always)]
    pub fn resultants<T: Real>(&self, h: f64, e: Voigt<T>, k: Voigt<T>) -> [Voigt<T>; 2] {
        dispatch!(self, law => law.resultants(h, e, k))
    }

    /// Derivatives of the resultants.
    #[inline(always)]
    #[must_use]
    pub fn stiffness(&self, h: f64, e: Voigt<f64>, k: Voigt<f64>) -> Stiffness {
        dispatch!(self, law => law.stiffness(h, e, k))
    }

    /// The law for small strains, by which Kelvin-Voigt damping is measured.
    #[must_use]
    pub fn linear(&self) -> SaintVenantKirchhoff {
        match self {
            Self::SaintVenantKirchhoff(law) => *law,
            Self::NeoHookean(law) => law.linear(),
            Self::TensionField(law) => law.elastic,
        }
    }

    /// Whether damping acts inside the law, `N = N(E + tau E')`, and not beside it, `N(E) + tau h C E'`.
    ///
    /// A film must not push, however fast it is folded. Where W is convex, `(N(E + tau E') - N(E)) : tau E' >= 0`:
    /// what damping takes is never negative, and where the film is taut it is the linear law's.
    #[must_use]
    pub fn is_one_sided(&self) -> bool {
        matches!(self, Self::TensionField(_))
    }

    /// Whether membrane forces depend on curvature.
    #[must_use]
    pub fn is_coupled(&self) -> bool {
        matches!(self, Self::NeoHookean(_))
    }

    /// Regime at a membrane strain.
    #[must_use]
    pub fn regime(&self, e: Voigt<f64>) -> Regime {
        match self {
            Self::TensionField(law) => law.regime(e),
            _ => Regime::Taut,
        }
    }
}
