//! Precomputed integrals of cable elements: mass, weights of the points, and the axial energy's Gram form.
//!
//! With the Legendre vectors D_k of `r' = sum D_k P_k(eta)` and their products g = (G00, G01, G02, G11, G12, G22),
//! `|r'|^2 = a(eta).g`, so that the Green-Lagrange energy of any quadrature rule is
//! `U = (g - g0)^T Hc (g - g0)/8` with the constant 6x6 matrix `Hc = sum w EA A0^(-3/2) a a^T`: the sums over points,
//! varying stiffness and curved reference lines cost nothing at run time.

use pliant_math::Vec3;
use pliant_math::hermite;
use pliant_math::quadrature::{GAUSS_3, GAUSS_5, LOBATTO_3};

use crate::elements::cable::{
    Bending, CableElement, CableLaw, Integration, Reference, Strain, place,
};
use crate::elements::cable::{Column, Line, Past, Slack, Yielding, elastic_energy};

/// Precomputed numbers of one element, placed as [`place`] tells, and its Gram form.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Numbers {
    pub core: [f64; place::COUNT],
    pub gram: [f64; place::GRAM_COUNT],
}

impl Numbers {
    /// A bridge between two cables: contributes exactly nothing, whatever the nodes do.
    pub const BRIDGE: Self = {
        let mut core = [0.0; place::COUNT];
        core[place::INVERSE_LENGTH] = 1.0;
        core[place::GUARD] = 1.0;
        core[place::SMOOTHING] = 1.0;
        let mut k = 0;
        while k < 5 {
            core[place::AXIAL_METRIC + k] = 1.0;
            k += 1;
        }
        k = 0;
        while k < 3 {
            core[place::CURVATURE_SMOOTHING + k] = 1.0;
            k += 1;
        }
        Self { core, gram: [0.0; place::GRAM_COUNT] }
    };

    /// Integrals of one element.
    pub fn new(law: CableLaw, element: &CableElement, normal: [f64; 3], slack: Slack) -> Self {
        let length = element.length;
        let mut core = [0.0; place::COUNT];
        core[place::INVERSE_LENGTH] = 1.0 / length;
        core[place::TAU] = element.retardation_time;
        core[place::RESIDUAL] = slack.residual_stiffness;
        core[place::SMOOTHING] = slack.smoothing;
        core[place::NORMAL..place::NORMAL + 3].copy_from_slice(&normal);
        for (k, m) in mass(element).into_iter().enumerate() {
            core[place::MASS + k] = m;
        }
        let reference = reference_line(element);

        let mut axial = |k: usize, xi: f64, weight: f64, stiffness: f64| {
            let v = reference.tangent(2.0 * xi - 1.0);
            let a0 = metric(law, v);
            core[place::AXIAL + k] = weight * length * a0.sqrt() * stiffness;
            core[place::AXIAL_METRIC + k] = match law.strain {
                Strain::GreenLagrange => 1.0 / a0,
                Strain::Biot => 1.0 / a0.sqrt(),
            };
        };
        match law.integration {
            Integration::Lobatto => {
                for k in 0..3 {
                    let ea = element.sections.lobatto[k].axial_stiffness;
                    axial(k, LOBATTO_3.xi[k], LOBATTO_3.weight[k], ea);
                }
            }
            Integration::Full => {
                for k in 0..5 {
                    let ea = element.sections.gauss[k].axial_stiffness;
                    axial(k, GAUSS_5.xi[k], GAUSS_5.weight[k], ea);
                }
            }
        }

        for k in 0..3 {
            let eta = 2.0 * GAUSS_3.xi[k] - 1.0;
            let stiffness = GAUSS_3.weight[k] * element.sections.bending[k].bending_stiffness;
            let (v, u) = (reference.tangent(eta), reference.second(eta));
            let a0 = metric(law, v);
            let j0 = a0.sqrt();
            core[place::BENDING_DAMPING + k] = element.retardation_time * stiffness / (length * j0);
            for j in 0..3 {
                core[place::SIMPLIFIED + j] += stiffness / length * eta.powi(j as i32);
            }
            let n = Vec3::from(normal);
            match law.bending {
                Bending::Exact => {
                    core[place::BENDING + k] = stiffness / (length * j0);
                    // -EI k0 k_s J0 L with k_s = n.(r' x L r'')/(L A J0).
                    let k0 = n.dot(v.cross(u)) / (length * a0 * j0);
                    core[place::CURVATURE + k] = stiffness * k0;
                }
                Bending::Simplified => {
                    core[place::BENDING + k] = stiffness / (length * a0 * j0);
                    // Smoothed over a hundredth of the reference curvature; the reference stays free of stress.
                    let b0 = u.dot(u);
                    let smoothing = 1e-4 * b0;
                    let curved = b0 > 0.0;
                    core[place::CURVATURE + k] = (b0 + smoothing).sqrt();
                    core[place::CURVATURE_SMOOTHING + k] = if curved { smoothing } else { 1.0 };
                }
            }
        }
        let gram = if law.uses_gram() { gram(&core, &reference) } else { [0.0; place::GRAM_COUNT] };
        let mut numbers = Self { core, gram };
        if let Some(x) = element.reference {
            numbers.core[place::ENERGY] = elastic_energy(law, &numbers, &x.map(Vec3::from));
        }
        numbers
    }
}

impl Column<f64> for &Numbers {
    fn get(self, place: usize) -> f64 {
        self.core[place]
    }
    fn gram(self, k: usize) -> f64 {
        self.gram[k]
    }
    /// At the reference nothing has yielded.
    fn past(self, _: usize) -> Past<f64> {
        let Yielding { strain, isotropic, kinematic } = Yielding::NONE;
        Past { yield_strain: strain, isotropic, kinematic, strain: 0.0, path: 0.0, lead: 0.0 }
    }
}

/// `|r0'|^2`: exactly 1 where the reference is straight.
fn metric(law: CableLaw, v: Vec3<f64>) -> f64 {
    match law.reference {
        Reference::Straight => 1.0,
        Reference::Planar => v.dot(v),
    }
}

fn reference_line(element: &CableElement) -> Line<f64> {
    match element.reference {
        Some(x) => Line::new(&x.map(Vec3::from), 1.0 / element.length),
        None => {
            let x = Vec3::new(1.0, 0.0, 0.0);
            Line { d: x, h: x, e: Vec3::zero(0.0) }
        }
    }
}

/// Scalar mass matrix `int rho A N N^T dx`, lower triangle.
fn mass(element: &CableElement) -> [f64; 10] {
    let mut m = [0.0; 10];
    for k in 0..5 {
        let n = hermite::shape(GAUSS_5.xi[k], element.length);
        let w = GAUSS_5.weight[k] * element.length * element.sections.gauss[k].mass_per_length;
        for i in 0..4 {
            for j in 0..=i {
                m[i * (i + 1) / 2 + j] += w * n[i] * n[j];
            }
        }
    }
    m
}

/// `a(eta)` of `|r'|^2 = a.g`.
fn products(eta: f64) -> [f64; 6] {
    let p2 = 1.5 * eta * eta - 0.5;
    [1.0, 2.0 * eta, 2.0 * p2, eta * eta, 2.0 * eta * p2, p2 * p2]
}

/// Hc/4 (lower triangle) and g0, from the 5 axial points.
fn gram(core: &[f64; place::COUNT], reference: &Line<f64>) -> [f64; place::GRAM_COUNT] {
    let mut out = [0.0; place::GRAM_COUNT];
    for k in 0..5 {
        let a = products(2.0 * GAUSS_5.xi[k] - 1.0);
        let metric = core[place::AXIAL_METRIC + k];
        let w = 0.25 * core[place::AXIAL + k] * metric * metric;
        for i in 0..6 {
            for j in 0..=i {
                out[i * (i + 1) / 2 + j] += w * a[i] * a[j];
            }
        }
    }
    let d = [reference.d, reference.e, reference.h - reference.d];
    let pairs = [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)];
    for (k, (i, j)) in pairs.into_iter().enumerate() {
        out[21 + k] = d[i].dot(d[j]);
    }
    out
}
