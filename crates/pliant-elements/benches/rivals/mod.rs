//! Two other ways to evaluate the same element, for comparison only.

use pliant_elements::Section;
use pliant_math::hermite;
use pliant_math::quadrature::{GAUSS_3, GAUSS_5};

type Vector = [f64; 12];
type Matrix = [[f64; 12]; 12];

/// Quadrature with dense 3x12 matrices of shape functions, as textbooks write it.
pub struct Textbook {
    section: Section,
    /// Weight times length, S'.
    axial: Vec<(f64, [Vector; 3])>,
    /// Weight times length, S', S''.
    bending: Vec<(f64, [Vector; 3], [Vector; 3])>,
}

fn dense(n: [f64; 4]) -> [Vector; 3] {
    std::array::from_fn(|c| std::array::from_fn(|k| if k % 3 == c { n[k / 3] } else { 0.0 }))
}

fn apply(s: &[Vector; 3], q: &Vector) -> [f64; 3] {
    std::array::from_fn(|c| (0..12).map(|k| s[c][k] * q[k]).sum())
}

fn apply_transposed(s: &[Vector; 3], x: [f64; 3]) -> Vector {
    std::array::from_fn(|k| (0..3).map(|c| s[c][k] * x[c]).sum())
}

/// `k += w s^T t`.
fn add_gram(k: &mut Matrix, w: f64, s: &[Vector; 3], t: &[Vector; 3]) {
    for c in 0..3 {
        add_outer(k, w, &s[c], &t[c]);
    }
}

/// `k += w a b^T`.
fn add_outer(k: &mut Matrix, w: f64, a: &Vector, b: &Vector) {
    for (row, a) in k.iter_mut().zip(a) {
        let wa = w * a;
        for (k, b) in row.iter_mut().zip(b) {
            *k += wa * b;
        }
    }
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

impl Textbook {
    pub fn new(length: f64, section: Section) -> Self {
        Self {
            section,
            axial: (0..5)
                .map(|k| {
                    let s = dense(hermite::shape_derivative(GAUSS_5.xi[k], length));
                    (GAUSS_5.weight[k] * length, s)
                })
                .collect(),
            bending: (0..3)
                .map(|k| {
                    let xi = GAUSS_3.xi[k];
                    let v = dense(hermite::shape_derivative(xi, length));
                    let u = dense(hermite::shape_second_derivative(xi, length));
                    (GAUSS_3.weight[k] * length, v, u)
                })
                .collect(),
        }
    }

    pub fn force(&self, q: &Vector) -> Vector {
        let mut f = [0.0; 12];
        let mut add = |w: f64, g: Vector| (0..12).for_each(|k| f[k] += w * g[k]);
        for (w, s) in &self.axial {
            let v = apply(s, q);
            let eps = 0.5 * (dot(v, v) - 1.0);
            add(w * self.section.axial_stiffness * eps, apply_transposed(s, v));
        }
        for (w, sv, su) in &self.bending {
            let (v, u) = (apply(sv, q), apply(su, q));
            let (a, b, c) = (dot(v, v), dot(u, u), dot(v, u));
            let w = w * self.section.bending_stiffness;
            let ka = w * (2.0 * c * c / a - b) / (a * a);
            let (kb, kc) = (w / a, -w * c / (a * a));
            add(ka, apply_transposed(sv, v));
            add(kc, apply_transposed(sv, u));
            add(kc, apply_transposed(su, v));
            add(kb, apply_transposed(su, u));
        }
        f
    }

    pub fn force_and_jacobian(&self, q: &Vector) -> (Vector, Matrix) {
        let mut k = [[0.0; 12]; 12];
        for (w, s) in &self.axial {
            let v = apply(s, q);
            let w = w * self.section.axial_stiffness;
            let g = apply_transposed(s, v);
            add_outer(&mut k, w, &g, &g);
            add_gram(&mut k, w * 0.5 * (dot(v, v) - 1.0), s, s);
        }
        for (w, sv, su) in &self.bending {
            let (v, u) = (apply(sv, q), apply(su, q));
            let (a, b, c) = (dot(v, v), dot(u, u), dot(v, u));
            let w = 0.5 * w * self.section.bending_stiffness;
            // Gradients and second derivatives of A, B, C, and the chain rule of (A B - C^2)/A^2.
            let twice = |x: Vector| x.map(|c| 2.0 * c);
            let ga = twice(apply_transposed(sv, v));
            let gb = twice(apply_transposed(su, u));
            let (p, r) = (apply_transposed(sv, u), apply_transposed(su, v));
            let gc: Vector = std::array::from_fn(|i| p[i] + r[i]);
            let (ka, kb, kc) =
                (-b / (a * a) + 2.0 * c * c / (a * a * a), 1.0 / a, -2.0 * c / (a * a));
            let kaa = 2.0 * b / a.powi(3) - 6.0 * c * c / a.powi(4);
            let (kab, kac, kcc) = (-1.0 / (a * a), 4.0 * c / a.powi(3), -2.0 / (a * a));
            add_gram(&mut k, 2.0 * w * ka, sv, sv);
            add_gram(&mut k, 2.0 * w * kb, su, su);
            add_gram(&mut k, w * kc, sv, su);
            add_gram(&mut k, w * kc, su, sv);
            add_outer(&mut k, w * kaa, &ga, &ga);
            add_outer(&mut k, w * kab, &ga, &gb);
            add_outer(&mut k, w * kab, &gb, &ga);
            add_outer(&mut k, w * kac, &ga, &gc);
            add_outer(&mut k, w * kac, &gc, &ga);
            add_outer(&mut k, w * kcc, &gc, &gc);
        }
        (self.force(q), k)
    }
}

/// Precomputed stiffness tensor over the ten products of the four nodal vectors: `f = K1(q) q`, `K = K1 + K2(q)`.
pub struct Tensor {
    /// dU/dG = constant + quadratic G over the 10 products.
    linear: [f64; 10],
    quadratic: [[f64; 10]; 10],
}

fn pair(i: usize, j: usize) -> usize {
    let (i, j) = (i.max(j), i.min(j));
    i * (i + 1) / 2 + j
}

impl Tensor {
    pub fn new(length: f64, section: Section) -> Self {
        let mut linear = [0.0; 10];
        let mut quadratic = [[0.0; 10]; 10];
        let products = |n: [f64; 4]| {
            let mut a = [0.0; 10];
            for i in 0..4 {
                for j in 0..4 {
                    a[pair(i, j)] += n[i] * n[j];
                }
            }
            a
        };
        for k in 0..5 {
            let a = products(hermite::shape_derivative(GAUSS_5.xi[k], length));
            let b = products(hermite::shape_second_derivative(GAUSS_5.xi[k], length));
            let w = GAUSS_5.weight[k] * length;
            for i in 0..10 {
                linear[i] += w
                    * (0.5 * section.bending_stiffness * b[i]
                        - 0.25 * section.axial_stiffness * a[i]);
                for j in 0..10 {
                    quadratic[i][j] += 0.25 * w * section.axial_stiffness * a[i] * a[j];
                }
            }
        }
        Self { linear, quadratic }
    }

    /// dU/dG.
    fn gradient(&self, q: &Vector) -> [f64; 10] {
        let mut g = [0.0; 10];
        for i in 0..4 {
            for j in 0..=i {
                g[pair(i, j)] = (0..3).map(|c| q[3 * i + c] * q[3 * j + c]).sum();
            }
        }
        std::array::from_fn(|i| {
            self.linear[i] + (0..10).map(|j| self.quadratic[i][j] * g[j]).sum::<f64>()
        })
    }

    fn contract(s: &[f64; 10], q: &Vector) -> Vector {
        std::array::from_fn(|k| {
            let (i, c) = (k / 3, k % 3);
            (0..4)
                .map(|j| {
                    let twice = if i == j { 2.0 } else { 1.0 };
                    twice * s[pair(i, j)] * q[3 * j + c]
                })
                .sum()
        })
    }

    pub fn force(&self, q: &Vector) -> Vector {
        Self::contract(&self.gradient(q), q)
    }

    pub fn force_and_jacobian(&self, q: &Vector) -> (Vector, Matrix) {
        let s = self.gradient(q);
        // J = dG/dq, 10 x 12.
        let mut j = [[0.0; 12]; 10];
        for i in 0..4 {
            for l in 0..=i {
                for c in 0..3 {
                    j[pair(i, l)][3 * i + c] += q[3 * l + c];
                    j[pair(i, l)][3 * l + c] += q[3 * i + c];
                }
            }
        }
        let mut hj = [[0.0; 12]; 10];
        for a in 0..10 {
            for b in 0..10 {
                for k in 0..12 {
                    hj[a][k] += self.quadratic[a][b] * j[b][k];
                }
            }
        }
        let mut k = [[0.0; 12]; 12];
        for a in 0..10 {
            for r in 0..12 {
                for c in 0..12 {
                    k[r][c] += j[a][r] * hj[a][c];
                }
            }
        }
        for i in 0..4 {
            for l in 0..4 {
                let twice = if i == l { 2.0 } else { 1.0 };
                for c in 0..3 {
                    k[3 * i + c][3 * l + c] += twice * s[pair(i, l)];
                }
            }
        }
        (Self::contract(&s, q), k)
    }
}
