//! A rest curvature that changes by kappa: what the energy `W(E, k + kappa) - W(E, k)` of an element adds, for any law.

use super::SurfaceBlock;
use super::kernel::WIDEST;
use super::point::{Frame, Hessian, PAIRS, Vectors, hessian};
use super::precomputed::Blocks;
use super::scalar::{local, vectors_at};
use crate::materials::Voigt;
use pliant_math::Vec3;
use pulp::Arch;

/// A point of the rule with its strains.
struct Here<'a> {
    x: Vectors<f64>,
    frame: Frame<f64>,
    /// Areas of the membrane and the bending part [m^2].
    areas: [f64; 2],
    /// Membrane strain, and changes of curvature without and with kappa.
    strains: [Voigt<f64>; 3],
    rows: &'a [f64],
}

impl SurfaceBlock {
    /// Calls `work` with each point; kappa are the components (11, 22, 12) [1/m].
    fn each_actuated(&self, e: usize, q: &[f64], kappa: [f64; 3], mut work: impl FnMut(Here<'_>)) {
        // Simplified bending knows no curvature.
        if self.rows() != 5 {
            return;
        }
        let (table, _, _) = self.element(e);
        let q = local(&self.local(e, q));
        for p in 0..table.points {
            let x = vectors_at(self, table, p, &q);
            let frame = Frame::new(&x, table.curvature[p]);
            let k = frame.bending;
            let after = [k[0] + kappa[0], k[1] + kappa[1], k[2] + 2.0 * kappa[2]];
            let areas = table.areas[p];
            // Where membrane and bending have rules of their own, the law does not couple them.
            let membrane = if areas[0] == areas[1] { frame.membrane } else { [0.0; 3] };
            let rows = &table.rows[5 * p * self.width()..5 * (p + 1) * self.width()];
            work(Here { x, frame, areas, strains: [membrane, k, after], rows });
        }
    }

    /// Energy that kappa adds to element `e` [J].
    #[must_use]
    pub fn curvature_energy(&self, e: usize, q: &[f64], kappa: [f64; 3]) -> f64 {
        let (h, material) = (self.thickness[e], &self.law.material);
        let mut sum = 0.0;
        self.each_actuated(e, q, kappa, |here| {
            let [membrane, k, after] = here.strains;
            let change = material.energy(h, membrane, after) - material.energy(h, membrane, k);
            sum += here.areas[1] * change;
        });
        sum
    }

    /// What kappa adds to the resultants of a point, times its areas.
    fn added_resultants(&self, h: f64, here: &Here<'_>) -> [Voigt<f64>; 2] {
        let [membrane, k, after] = here.strains;
        let [n_1, m_1] = self.law.material.resultants(h, membrane, after);
        let [n_0, m_0] = self.law.material.resultants(h, membrane, k);
        let difference = |a: Voigt<f64>, b: Voigt<f64>, area: f64| {
            [area * (a[0] - b[0]), area * (a[1] - b[1]), area * (a[2] - b[2])]
        };
        let shared = if here.areas[0] == here.areas[1] { here.areas[0] } else { 0.0 };
        [difference(n_1, n_0, shared), difference(m_1, m_0, here.areas[1])]
    }

    /// Derivative of that energy by the coordinates of element `e`, nodal vector by nodal vector.
    #[must_use]
    pub fn curvature_gradient(&self, e: usize, q: &[f64], kappa: [f64; 3]) -> Vec<f64> {
        let mut out = vec![0.0; 3 * self.kind.vectors()];
        self.each_actuated(e, q, kappa, |here| {
            let [n, m] = self.added_resultants(self.thickness[e], &here);
            let on = here.frame.gradient(&here.x, n, m);
            let on = [on.a[0], on.a[1], on.h[0], on.h[1], on.h[2]];
            for (i, to) in out.chunks_exact_mut(3).enumerate() {
                let sum = (0..5).fold(Vec3::zero(0.0), |sum, s| {
                    sum.add_times(here.rows[s * self.width() + i], on[s])
                });
                to.iter_mut().zip(sum.array()).for_each(|(to, f)| *to += f);
            }
        });
        out
    }

    /// Adds `factor` times its second derivative to `out`, row by row.
    pub fn add_curvature_hessian(
        &self,
        e: usize,
        q: &[f64],
        kappa: [f64; 3],
        factor: f64,
        out: &mut [f64],
    ) {
        let (n, width, h) = (self.kind.vectors(), self.width(), self.thickness[e]);
        let mut second: Hessian = [[[0.0; 5]; 5]; 6];
        let mut rows = [[0.0; WIDEST]; 5];
        let mut blocks: Blocks = [[[0.0; WIDEST]; WIDEST]; 6];
        let arch = Arch::new();
        self.each_actuated(e, q, kappa, |here| {
            let [membrane, k, after] = here.strains;
            let mut stiffness = self.law.material.stiffness(h, membrane, after);
            let before = self.law.material.stiffness(h, membrane, k);
            let shared = if here.areas[0] == here.areas[1] { here.areas[0] } else { 0.0 };
            for i in 0..6 {
                for j in 0..6 {
                    let area = if i < 3 || j < 3 { shared } else { here.areas[1] };
                    stiffness[i][j] = area * (stiffness[i][j] - before[i][j]);
                }
            }
            let [n_r, m_r] = self.added_resultants(h, &here);
            hessian(&here.frame, &here.x, n_r, m_r, &stiffness, &mut second);
            for (s, to) in rows.iter_mut().enumerate() {
                to[..width].copy_from_slice(&here.rows[s * width..(s + 1) * width]);
                if s >= 2 {
                    // Covariant second derivative: W_ij = H_ij - G^c_ij B_c.
                    for (c, dual) in here.frame.dual.iter().enumerate() {
                        let christoffel = dual.dot(here.x.h[s - 2]);
                        for (to, b) in to.iter_mut().zip(&here.rows[c * width..(c + 1) * width]) {
                            *to -= christoffel * b;
                        }
                    }
                }
            }
            arch.dispatch(|| add_products(&second, &rows, &mut blocks));
        });
        for (block, (c, d)) in blocks.iter().zip(PAIRS) {
            for (i, row) in block.iter().enumerate().take(n) {
                for (j, value) in row.iter().enumerate().take(n) {
                    out[(3 * i + c) * 3 * n + 3 * j + d] += factor * value;
                    if c != d {
                        out[(3 * j + d) * 3 * n + 3 * i + c] += factor * value;
                    }
                }
            }
        }
    }
}

/// Adds `rows^T second rows` to the blocks between components.
#[inline(always)]
fn add_products(second: &Hessian, rows: &[[f64; WIDEST]; 5], blocks: &mut Blocks) {
    for (block, second) in blocks.iter_mut().zip(second) {
        let mut products = [[0.0; WIDEST]; 5];
        for (product, factors) in products.iter_mut().zip(second) {
            for (row, factor) in rows.iter().zip(factors) {
                for (to, from) in product.iter_mut().zip(row) {
                    *to += factor * from;
                }
            }
        }
        for (i, to) in block.iter_mut().enumerate() {
            for (row, product) in rows.iter().zip(&products) {
                for (to, from) in to.iter_mut().zip(product) {
                    *to += row[i] * from;
                }
            }
        }
    }
}
