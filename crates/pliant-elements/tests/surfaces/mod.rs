//! Example surfaces and states.
#![allow(dead_code, clippy::unwrap_used)]

use pliant_elements::materials::{NeoHookean, PlaneStress, SaintVenantKirchhoff, TensionField};
use pliant_elements::{
    Bending, Integrals, Quadrature, SURFACE_KINDS, SurfaceBlock, SurfaceElement, SurfaceKind,
    SurfaceLaw,
};

/// Young's modulus and thickness at which stretching and bending weigh alike.
pub const E: f64 = 1e3;
pub const NU: f64 = 0.3;
pub const H: f64 = 0.2;
pub const RHO: f64 = 5.0;

/// A surface with its derivatives X, X,u, X,v, X,uv.
pub type Surface = fn(f64, f64) -> [[f64; 3]; 4];

pub fn flat(u: f64, v: f64) -> [[f64; 3]; 4] {
    [[u, v, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0; 3]]
}

/// Doubly curved, skew and stretched.
pub fn curved(u: f64, v: f64) -> [[f64; 3]; 4] {
    [
        [u + 0.1 * v * v, v + 0.2 * u, 0.3 * u * u - 0.2 * v * v + 0.25 * u * v],
        [1.0, 0.2, 0.6 * u + 0.25 * v],
        [0.2 * v, 1.0, -0.4 * v + 0.25 * u],
        [0.0, 0.0, 0.25],
    ]
}

/// Nodal vectors of a kind at a node.
pub fn nodal(kind: SurfaceKind, surface: Surface, u: f64, v: f64) -> Vec<[f64; 3]> {
    surface(u, v)[..kind.vectors_per_node()].to_vec()
}

/// A rectangle of elements: nodes (i, j) at (a i, b j), number i (m + 1) + j. Triangles halve the rectangles.
pub fn mesh(
    kind: SurfaceKind,
    law: SurfaceLaw,
    surface: Surface,
    [n, m]: [usize; 2],
    [a, b]: [f64; 2],
) -> (SurfaceBlock, Vec<f64>) {
    let k = kind.vectors_per_node();
    let place = |node: usize| [a * (node / (m + 1)) as f64, b * (node % (m + 1)) as f64];
    let mut elements = Vec::new();
    let mut add = |nodes: &[usize]| {
        let mut corners = [[0.0; 2]; 4];
        for (to, &node) in corners.iter_mut().zip(nodes) {
            *to = place(node);
        }
        elements.push(SurfaceElement {
            vectors: nodes
                .iter()
                .flat_map(|&node| (0..k).map(move |s| 3 * (node * k + s) as u32))
                .collect(),
            chart: corners.into(),
            reference: nodes
                .iter()
                .flat_map(|&node| nodal(kind, surface, place(node)[0], place(node)[1]))
                .collect(),
            thickness: H,
        });
    };
    for i in 0..n {
        for j in 0..m {
            let corner = |di: usize, dj: usize| (i + di) * (m + 1) + j + dj;
            let quad = [corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)];
            if kind.corners() == 3 {
                add(&[quad[0], quad[1], quad[2]]);
                add(&[quad[0], quad[2], quad[3]]);
            } else {
                add(&quad);
            }
        }
    }
    let q = (0..(n + 1) * (m + 1))
        .flat_map(|node| nodal(kind, surface, place(node)[0], place(node)[1]))
        .flatten()
        .collect();
    (SurfaceBlock::new(kind, law, &elements).unwrap(), q)
}

pub fn elastic() -> SaintVenantKirchhoff {
    SaintVenantKirchhoff { youngs_modulus: E, poisson_ratio: NU }
}

pub fn law(material: PlaneStress) -> SurfaceLaw {
    SurfaceLaw {
        material,
        retardation_time: 0.0,
        density: RHO,
        quadrature: Quadrature::Standard,
        integrals: Integrals::Quadrature,
        bending: Bending::Exact,
    }
}

pub fn svk() -> SurfaceLaw {
    law(PlaneStress::SaintVenantKirchhoff(elastic()))
}

/// Every material that a kind can be made of.
pub fn materials(kind: SurfaceKind) -> Vec<PlaneStress> {
    let rubber = |nu| PlaneStress::NeoHookean(NeoHookean::new(E, nu, kind.bends()));
    vec![
        PlaneStress::SaintVenantKirchhoff(elastic()),
        rubber(0.3),
        rubber(0.5),
        PlaneStress::TensionField(TensionField { elastic: elastic(), residual_stiffness: 0.01 }),
    ]
}

/// Every kind with every law.
pub fn cases() -> Vec<(SurfaceKind, SurfaceLaw)> {
    let mut cases = Vec::new();
    for kind in SURFACE_KINDS {
        for material in materials(kind) {
            for retardation_time in [0.0, 0.01] {
                cases.push((kind, SurfaceLaw { retardation_time, ..law(material) }));
            }
        }
        for quadrature in [Quadrature::Reduced, Quadrature::Full] {
            cases.push((kind, SurfaceLaw { quadrature, ..svk() }));
        }
        cases.extend(options(kind).into_iter().map(|law| (kind, law)));
    }
    cases
}

/// Laws with precomputed integrals and simplified bending, where the kind has them.
pub fn options(kind: SurfaceKind) -> Vec<SurfaceLaw> {
    let bendings: &[Bending] =
        if kind.bends() { &[Bending::Exact, Bending::Simplified] } else { &[Bending::Exact] };
    let integrals: &[Integrals] = match kind.exact_rule() {
        Some(_) => &[Integrals::Quadrature, Integrals::Precomputed],
        None => &[Integrals::Quadrature],
    };
    let mut laws = Vec::new();
    for &bending in bendings {
        for &integrals in integrals {
            for retardation_time in [0.0, 0.01] {
                let plain = integrals == Integrals::Quadrature && bending == Bending::Exact;
                if !(plain || bending == Bending::Simplified && retardation_time > 0.0) {
                    laws.push(SurfaceLaw { bending, integrals, retardation_time, ..svk() });
                }
            }
        }
    }
    laws
}

/// Two curved elements (or four triangles); flat ones for simplified bending.
pub fn example(kind: SurfaceKind, law: SurfaceLaw) -> (SurfaceBlock, Vec<f64>) {
    let curved = if law.bending == Bending::Simplified { flat } else { curved };
    mesh(kind, law, curved, [2, 1], [0.5, 0.4])
}

/// A state disturbed by `size`: positions by that part of an element, slopes by as much, twists by more.
pub fn perturbed(kind: SurfaceKind, q: &[f64], noise: &[f64], size: f64) -> Vec<f64> {
    let k = kind.vectors_per_node();
    q.iter()
        .zip(noise)
        .enumerate()
        .map(|(i, (q, n))| q + size * n * [0.4, 1.0, 1.0, 2.0][i / 3 % k])
        .collect()
}

/// All vectors rotated, positions shifted as well.
pub fn moved(
    kind: SurfaceKind,
    turn: pliant_math::rotation::Quaternion,
    x: &[f64],
    shift: [f64; 3],
) -> Vec<f64> {
    let k = kind.vectors_per_node();
    x.chunks(3)
        .enumerate()
        .flat_map(|(i, c)| {
            let r = pliant_math::rotation::rotate(turn, [c[0], c[1], c[2]]);
            let s = f64::from(u8::from(i % k == 0));
            std::array::from_fn::<f64, 3, _>(|c| r[c] + s * shift[c])
        })
        .collect()
}

/// Velocities of a rigid motion.
pub fn rigid_velocities(
    kind: SurfaceKind,
    q: &[f64],
    omega: [f64; 3],
    translation: [f64; 3],
) -> Vec<f64> {
    let k = kind.vectors_per_node();
    q.chunks(3)
        .enumerate()
        .flat_map(|(i, x)| {
            let s = f64::from(u8::from(i % k == 0));
            std::array::from_fn::<f64, 3, _>(|c| {
                let (a, b) = ((c + 1) % 3, (c + 2) % 3);
                omega[a] * x[b] - omega[b] * x[a] + s * translation[c]
            })
        })
        .collect()
}

/// The matrix of a lower triangle stored by rows.
pub fn symmetric_full(lower: &[f64]) -> Vec<Vec<f64>> {
    let n = (0..).find(|n| n * (n + 1) / 2 >= lower.len()).unwrap();
    (0..n)
        .map(|i: usize| {
            (0..n).map(|j: usize| lower[i.max(j) * (i.max(j) + 1) / 2 + i.min(j)]).collect()
        })
        .collect()
}

/// The matrix of all elements.
pub fn assembled(
    block: &SurfaceBlock,
    motion: pliant_elements::Motion<'_>,
    weights: pliant_elements::Weights,
) -> nalgebra::DMatrix<f64> {
    use pliant_elements::Block;
    let n = motion.q.len();
    let mut matrix = nalgebra::DMatrix::zeros(n, n);
    for e in 0..block.element_count() {
        let element = symmetric_full(&block.element_tangent(e, motion, weights));
        let unknowns: Vec<usize> =
            block.vectors_of(e).iter().flat_map(|&o| (0..3).map(move |c| o as usize + c)).collect();
        for (i, &row) in unknowns.iter().enumerate() {
            for (j, &column) in unknowns.iter().enumerate() {
                matrix[(row, column)] += element[i][j];
            }
        }
    }
    matrix
}
