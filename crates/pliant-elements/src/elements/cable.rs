//! Gradient-deficient ANCF cable with 12 coordinates (r1, t1, r2, t2), t = dr/dx.
//!
//! Gerstmayr & Shabana (2006); the three-vector form, the Lobatto rule and the curvature measures are derived in
//! docs/theory/cable.md. Everything here is written over [`Real`], so one source serves scalars, vector lanes and dual
//! numbers.
//!
//! The line is expressed in three translation-free vectors, with eta = 2 xi - 1:
//! `d = (r2 - r1)/L`, `h = (t1 + t2)/2`, `e = (t2 - t1)/2`,
//! `r' = p d + (1 - p) h + eta e` with `p = 3/2 (1 - eta^2)`, `L r'' = 2 e + 6 eta (h - d)`.
//! Below `v` is r' and `u` is L r''.

mod data;
mod energy;
mod flow;
mod force;
mod tangent;
mod wound;

pub use data::{
    Bending, Cable, CableElement, CableLaw, Integration, NodeOffsets, Reference, Section, Sections,
    Slack, Strain, Yielding,
};
pub(crate) use energy::{curvature, elastic_energy, mid_strain_and_force, plastic_work};
pub(crate) use flow::{Past, flow};
pub(crate) use force::{force, inertia};
pub(crate) use tangent::tangent;
pub(crate) use wound::{
    Scale, length_forces, wound_energy, wound_force, wound_plastic_work, wound_strains,
    wound_tangent,
};

use pliant_math::{Real, Vec3};

/// Places of the precomputed numbers of an element in its column.
pub(crate) mod place {
    /// 1/L.
    pub const INVERSE_LENGTH: usize = 0;
    /// 1 on bridges between cables, else 0: keeps |r'|^2 away from zero where nothing is.
    pub const GUARD: usize = 1;
    /// Scalar mass matrix, lower triangle (10).
    pub const MASS: usize = 2;
    /// Axial points: weight L J0 EA (3 or 5 used).
    pub const AXIAL: usize = 12;
    /// Axial points: 1/A0 (Green-Lagrange) or 1/J0 (Biot).
    pub const AXIAL_METRIC: usize = 17;
    /// Bending points: weight EI/(L J0) (exact) or weight EI/(L J0^3) (simplified, curved).
    pub const BENDING: usize = 22;
    /// Bending points: tau weight EI/(L J0).
    pub const BENDING_DAMPING: usize = 25;
    /// Simplified bending of straight cables: sum of weight EI eta^j / L, j = 0, 1, 2.
    pub const SIMPLIFIED: usize = 28;
    /// Retardation time.
    pub const TAU: usize = 31;
    /// Residual stiffness of the slack cable.
    pub const RESIDUAL: usize = 32;
    /// Width of the slack transition.
    pub const SMOOTHING: usize = 33;
    /// Curved reference: weight EI k0 (exact), or L times the smoothed |r0''| (simplified).
    pub const CURVATURE: usize = 34;
    /// Curved reference, simplified: square of the smoothing of |L r''|.
    pub const CURVATURE_SMOOTHING: usize = 37;
    /// Normal of the reference plane.
    pub const NORMAL: usize = 40;
    /// Elastic energy at the reference, as the terms without constants count it.
    pub const ENERGY: usize = 43;
    /// Length of a column.
    pub const COUNT: usize = 44;

    /// Gram form: Hc/4, lower triangle (21), then g0 (6).
    pub const GRAM_COUNT: usize = 27;
}

/// Access to an element's precomputed numbers, as the kind of number that the kernel runs on.
pub(crate) trait Column<T>: Copy {
    /// Number at `place`.
    fn get(self, place: usize) -> T;
    /// Number `k` of the Gram form.
    fn gram(self, k: usize) -> T;
    /// What axial point `k` remembers; asked for by plastic laws only.
    fn past(self, k: usize) -> Past<T>;
}

/// The law of a block: a value known at compile time for the common laws, else read at run time.
pub(crate) trait LawSource: Copy + Send + Sync {
    /// Whether winches change lengths, known at compile time: nothing else pays for it.
    const WOUND: bool = false;
    fn law(self) -> CableLaw;
}

/// The law of cables on winches.
#[derive(Clone, Copy)]
pub(crate) struct WoundLaw(pub CableLaw);

impl LawSource for WoundLaw {
    const WOUND: bool = true;
    #[inline(always)]
    fn law(self) -> CableLaw {
        CableLaw { plastic: false, ..self.0 }
    }
}

/// The law of cables that yield, on winches or not: with lengths that stay the same the result is that of the others.
#[derive(Clone, Copy)]
pub(crate) struct PlasticLaw(pub CableLaw);

impl LawSource for PlasticLaw {
    const WOUND: bool = true;
    #[inline(always)]
    fn law(self) -> CableLaw {
        CableLaw { plastic: true, ..self.0 }
    }
}

/// Any other law.
impl LawSource for CableLaw {
    #[inline(always)]
    fn law(self) -> CableLaw {
        Self { plastic: false, ..self }
    }
}

/// A law fixed at compile time, by its code.
#[derive(Clone, Copy)]
pub(crate) struct FixedLaw<const CODE: u8>;

impl<const CODE: u8> LawSource for FixedLaw<CODE> {
    #[inline(always)]
    fn law(self) -> CableLaw {
        CableLaw::from_code(CODE)
    }
}

/// Nodal vectors (r1, t1, r2, t2).
pub(crate) type Nodal<T> = [Vec3<T>; 4];

/// The three vectors of an element.
#[derive(Clone, Copy)]
pub(crate) struct Line<T> {
    pub d: Vec3<T>,
    pub h: Vec3<T>,
    pub e: Vec3<T>,
}

/// eta of the outer points of the three-point Gauss rule, sqrt(3/5).
pub(crate) const ETA: f64 = 0.774_596_669_241_483_4;

impl<T: Real> Line<T> {
    #[inline(always)]
    pub fn new(x: &Nodal<T>, inverse_length: T) -> Self {
        Self {
            d: (x[2] - x[0]).times(inverse_length),
            h: (x[1] + x[3]).scale(0.5),
            e: (x[3] - x[1]).scale(0.5),
        }
    }

    /// r' at the middle.
    #[inline(always)]
    pub fn middle(&self) -> Vec3<T> {
        self.d.scale(1.5).add_scaled(-0.5, self.h)
    }

    /// r' at `eta`.
    #[inline(always)]
    pub fn tangent(&self, eta: f64) -> Vec3<T> {
        let p = 1.5 * (1.0 - eta * eta);
        self.d.scale(p).add_scaled(1.0 - p, self.h).add_scaled(eta, self.e)
    }

    /// L r'' at `eta`.
    #[inline(always)]
    pub fn second(&self, eta: f64) -> Vec3<T> {
        self.e.scale(2.0).add_scaled(6.0 * eta, self.h - self.d)
    }
}

/// Axial force over EA at a strain, and its slopes.
#[derive(Clone, Copy)]
pub(crate) struct Axial<T> {
    pub force: T,
    /// Its derivative.
    pub slope: T,
    /// Factor of the viscosity: beside what yields, and none where the line is slack.
    pub viscous: T,
}

/// The axial law at point `k` and strain `eps`.
#[inline(always)]
pub(crate) fn axial_law<T: Real>(
    law: CableLaw,
    column: impl Column<T>,
    k: usize,
    eps: T,
) -> Axial<T> {
    if law.plastic {
        let flow = flow(law, column.past(k), eps);
        let (force, viscous) = elastic_law(law, column, flow.elastic);
        Axial { force, slope: viscous * flow.share, viscous }
    } else {
        let (force, slope) = elastic_law(law, column, eps);
        Axial { force, slope, viscous: slope }
    }
}

/// Axial force over EA and its slope at elastic strain `eps`; linear, or with slack.
#[inline(always)]
pub(crate) fn elastic_law<T: Real>(law: CableLaw, column: impl Column<T>, eps: T) -> (T, T) {
    if law.tension_only {
        let (rho, width) = (column.get(place::RESIDUAL), column.get(place::SMOOTHING));
        let half = (eps.constant(1.0) - rho).scale(0.5);
        let root = eps.mul_add(eps, width * width).sqrt();
        let force = half.mul_add(eps + root - width, rho * eps);
        let slope = half.mul_add(eps.constant(1.0) + eps / root, rho);
        (force, slope)
    } else {
        (eps, eps.constant(1.0))
    }
}

/// Strain and its gradient factor g at an axial point, `d eps/d r' = g r'`, from A = r'.r'.
#[inline(always)]
pub(crate) fn strain<T: Real>(law: CableLaw, column: impl Column<T>, k: usize, a: T) -> (T, T) {
    let one = a.constant(1.0);
    let metric = match law.reference {
        Reference::Straight => one,
        Reference::Planar => column.get(place::AXIAL_METRIC + k),
    };
    match law.strain {
        Strain::GreenLagrange => (a.mul_add(metric, -one).scale(0.5), metric),
        Strain::Biot => {
            let root = a.sqrt();
            (root.mul_add(metric, -one), metric / root)
        }
    }
}
