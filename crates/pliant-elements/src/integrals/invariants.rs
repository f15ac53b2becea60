//! Integrals of products of shape functions, for elements whose forces need no quadrature.
//!
//! Membrane, Saint Venant-Kirchhoff: with `G_p = q_i.q_j` for the pairs p = (i <= j) of nodal vectors the strain at a point
//! is `E_v = sum_p b_vp (G_p - G0_p)`, G0 those of the stress-free surface, and for unit thickness
//! `U = 1/2 (G - G0)^T KK (G - G0)`, `KK = int b^T C b dA`. Forces are `f = Q S`, `S_ii = 2 dU/dG_ii`, `S_ij = dU/dG_ij`.
//!
//! Bending, simplified: `U = h^3/24 sum_ij Kb_ij q_i.q_j`, `Kb = int C_ijkl H_ij^T H_kl dA`. It is bending of flat
//! surfaces whose membrane strains stay small: `k_ij = -h_ij.n`, and the parts of h_ij along the surface are gradients of
//! membrane strains.

use super::surface::place;
use crate::elements::surface::{Chart, QuadraturePoint, SurfaceKind};
use crate::materials::SaintVenantKirchhoff;

/// Number of the pair i <= j.
pub(crate) fn pair(i: usize, j: usize) -> usize {
    j * (j + 1) / 2 + i
}

/// Integrals of the membrane, for unit thickness.
#[derive(Clone, Debug)]
pub(crate) struct Membrane {
    /// Number of pairs, padded to a multiple of 8.
    pub stride: usize,
    /// KK, row by row, padded.
    pub quadratic: Vec<f64>,
    /// G0 with positions from the first one on, padded.
    pub reference: Vec<f64>,
    /// Derivatives of S: `KK_pq/(m_p m_q)` with m = 1 for squares, 2 for products, row (i, j) by row over (k, l), the
    /// latter padded to the width.
    pub tensor: Vec<f64>,
}

impl Membrane {
    /// Integrals over an element; none where its reference surface is degenerate.
    pub fn new(
        kind: SurfaceKind,
        law: &SaintVenantKirchhoff,
        rule: &[QuadraturePoint],
        chart: &Chart,
        reference: &[[f64; 3]],
        width: usize,
    ) -> Option<Self> {
        let n = kind.vectors();
        let pairs = n * (n + 1) / 2;
        let stride = pairs.next_multiple_of(8);
        let mut quadratic = vec![0.0; stride * stride];
        let c = law.matrix();
        for &QuadraturePoint { at, membrane, .. } in rule {
            let here = place(kind, chart, reference, at)?;
            let area = membrane * here.density * kind.parameter_area(chart);
            let [b1, b2, ..] = &here.rows;
            let mut strains = vec![[0.0; 3]; stride];
            for j in 0..n {
                for i in 0..=j {
                    let twice = if i == j { 1.0 } else { 2.0 };
                    strains[pair(i, j)] = [
                        0.5 * twice * b1[i] * b1[j],
                        0.5 * twice * b2[i] * b2[j],
                        0.5 * twice * (b1[i] * b2[j] + b1[j] * b2[i]),
                    ];
                }
            }
            for p in 0..pairs {
                let stress = c.map(|row| dot(row, strains[p]));
                for q in 0..pairs {
                    quadratic[p * stride + q] += area * dot(stress, strains[q]);
                }
            }
        }
        let mut tensor = vec![0.0; n * n * n * width];
        let number = |i: usize, j: usize| pair(i.min(j), i.max(j));
        let weight = |i: usize, j: usize| if i == j { 1.0 } else { 0.5 };
        for i in 0..n {
            for j in 0..n {
                for k in 0..n {
                    for l in 0..n {
                        tensor[((i * n + j) * n + k) * width + l] = weight(i, j)
                            * weight(k, l)
                            * quadratic[number(i, j) * stride + number(k, l)];
                    }
                }
            }
        }
        let mut products = vec![0.0; stride];
        let mut local = reference.to_vec();
        for i in (0..n).step_by(kind.vectors_per_node()) {
            local[i] = std::array::from_fn(|c| reference[i][c] - reference[0][c]);
        }
        for j in 0..n {
            for i in 0..=j {
                products[pair(i, j)] = dot(local[i], local[j]);
            }
        }
        Some(Self { stride, quadratic, reference: products, tensor })
    }
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Kb without its factor h^3/12, row by row, padded to the width; none where the reference is degenerate.
pub(crate) fn bending(
    kind: SurfaceKind,
    law: &SaintVenantKirchhoff,
    chart: &Chart,
    reference: &[[f64; 3]],
    width: usize,
) -> Option<Vec<f64>> {
    let n = kind.vectors();
    let c = law.matrix();
    let mut out = vec![0.0; width * width];
    // Second derivatives of flat elements are of lower degree than the functions: the rule of the mass is exact.
    for QuadraturePoint { at, bending, .. } in kind.mass_rule() {
        let here = place(kind, chart, reference, at)?;
        let area = bending * here.density * kind.parameter_area(chart);
        let [_, _, h11, h22, h12] = &here.rows;
        let h = |i: usize| [h11[i], h22[i], 2.0 * h12[i]];
        for i in 0..n {
            let moment = c.map(|row| area * dot(row, h(i)));
            for j in 0..n {
                out[i * width + j] += dot(moment, h(j));
            }
        }
    }
    Some(out)
}
