//! Example cables and states.
#![allow(dead_code, clippy::unwrap_used)]

use pliant_elements::{
    Cable, CableBlock, CableElement, CableLaw, NodeOffsets, PAST, Reference, Section, Sections,
    Slack, Yielding,
};
use pliant_math::rotation::{Quaternion, rotate};

pub const LENGTH: f64 = 0.3;
pub const EA: f64 = 1e3;
pub const EI: f64 = 2.0;
pub const MASS: f64 = 0.8;
/// Of the plastic laws: both kinds of hardening at once.
pub const YIELDING: Yielding = Yielding { strain: 0.04, isotropic: 0.1, kinematic: 0.15 };
/// Turning angle of one element of the curved reference.
pub const ANGLE: f64 = 0.4;

/// Every law.
pub fn laws() -> impl Iterator<Item = CableLaw> {
    (0..=u8::MAX).map(CableLaw::from_code)
}

pub fn section() -> Section {
    Section { axial_stiffness: EA, bending_stiffness: EI, mass_per_length: MASS }
}

/// Six coordinates of node `k` of the curved reference, an arc in the plane z = 0.
fn arc_node(k: usize) -> [f64; 6] {
    let radius = LENGTH / ANGLE;
    let phi = k as f64 * ANGLE;
    [radius * phi.sin(), radius * (1.0 - phi.cos()), 0.0, phi.cos(), phi.sin(), 0.0]
}

/// The curved reference of five nodes.
pub fn reference() -> Vec<f64> {
    (0..5).flat_map(arc_node).collect()
}

/// A straight line of `elements` unstretched elements along x.
pub fn line(elements: usize) -> Vec<f64> {
    (0..=elements).flat_map(|k| [k as f64 * LENGTH, 0.0, 0.0, 1.0, 0.0, 0.0]).collect()
}

/// The straight reference of five nodes, in a general direction.
pub fn straight() -> Vec<f64> {
    let turn = pliant_math::rotation::exp([0.3, 0.5, -0.2]);
    rotate_all(turn, &line(4), [0.1, 0.2, -0.4])
}

/// Element `k` of the curved example, or any of a straight one.
pub fn element(law: CableLaw, k: usize) -> CableElement {
    let (a, b) = (arc_node(k), arc_node(k + 1));
    CableElement {
        length: LENGTH,
        sections: Sections::constant(section()),
        retardation_time: if law.damped { 0.01 } else { 0.0 },
        reference: (law.reference == Reference::Planar).then_some([
            [a[0], a[1], a[2]],
            [a[3], a[4], a[5]],
            [b[0], b[1], b[2]],
            [b[3], b[4], b[5]],
        ]),
    }
}

pub fn nodes(first: usize, count: usize) -> Vec<NodeOffsets> {
    (first..first + count).map(|k| NodeOffsets { r: 6 * k as u32, t: 6 * k as u32 + 3 }).collect()
}

/// A cable of `elements` equal elements; curved laws allow one element only.
pub fn cable(law: CableLaw, elements: usize) -> Cable {
    Cable {
        nodes: nodes(0, elements + 1),
        elements: vec![element(law, 0)],
        normal: [0.0, 0.0, 1.0],
        slack: Slack { residual_stiffness: 0.05, smoothing: 0.03 },
        yielding: YIELDING,
    }
}

pub fn one(law: CableLaw, element: CableElement, elements: usize) -> CableBlock {
    let cable = Cable { elements: vec![element], ..cable(law, elements) };
    CableBlock::new(law, &[cable]).unwrap()
}

pub fn uniform(law: CableLaw, elements: usize, retardation_time: f64) -> CableBlock {
    let element = CableElement { retardation_time, ..element(law, 0) };
    one(law, element, elements)
}

/// Four elements with sections that vary along the line.
pub fn example(law: CableLaw) -> CableBlock {
    let elements = (0..4)
        .map(|k| CableElement {
            sections: Sections::sample(|xi| {
                let s = k as f64 + xi;
                Section {
                    axial_stiffness: EA * (1.0 + 0.2 * s),
                    bending_stiffness: EI * (1.0 + 0.1 * s * s),
                    mass_per_length: MASS * (2.0 - 0.3 * s),
                }
            }),
            ..element(law, k)
        })
        .collect();
    let cable = Cable { nodes: nodes(0, 5), elements, ..cable(law, 4) };
    let mut block = CableBlock::new(law, &[cable]).unwrap();
    block.set_length(0, FACTOR, 0.0);
    block
}

/// Lets all elements flow to coordinates `q`, as an accepted step does.
pub fn settle(block: &mut CableBlock, q: &[f64]) {
    let elements: Vec<usize> = block.real_elements().map(|(e, _)| e).collect();
    for e in elements {
        let mut past = Vec::new();
        block.flowed(e, q, &mut past);
        block.set_past(e, &past);
    }
}

/// Lets plastic strains have gone a longer way: by isotropic hardening nothing yields nearby.
pub fn harden(block: &mut CableBlock, q: &[f64]) {
    let elements: Vec<usize> = block.real_elements().map(|(e, _)| e).collect();
    for e in elements {
        let mut past = Vec::new();
        block.flowed(e, q, &mut past);
        past.iter_mut().skip(1).step_by(PAST).for_each(|path| *path += 1.0);
        block.set_past(e, &past);
    }
}

/// The example after it has yielded to and fro.
pub fn worked(law: CableLaw) -> CableBlock {
    let mut block = example(law);
    if law.plastic {
        for seed in [70, 71, 72] {
            let q = perturbed(&block, 0.15, seed);
            settle(&mut block, &q);
        }
    }
    block
}

/// The same while its winches haul.
pub fn hauled(law: CableLaw) -> CableBlock {
    let mut block = example(law);
    block.set_length(0, FACTOR, RATE);
    block
}

/// What winches make of the length of the example, and its rate where it is hauled.
pub const FACTOR: f64 = 0.85;
pub const RATE: f64 = 0.3;

/// A small generator of numbers in [-1, 1].
pub struct Random(pub u64);

impl Random {
    pub fn next(&mut self) -> f64 {
        self.0 =
            self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }

    pub fn vector(&mut self, n: usize) -> Vec<f64> {
        for _ in 0..8 {
            self.next();
        }
        (0..n).map(|_| self.next()).collect()
    }
}

/// The example's curved line, disturbed in space: positions by `size` of an element's length, slopes by `size`.
pub fn perturbed(block: &CableBlock, size: f64, seed: u64) -> Vec<f64> {
    let mut q = reference();
    q.truncate(6 * block.slots().len());
    let noise = Random(seed).vector(q.len());
    for (k, (q, n)) in q.iter_mut().zip(noise).enumerate() {
        *q += size * n * if k % 6 < 3 { LENGTH } else { 1.0 };
    }
    q
}

/// The same, disturbed within its plane.
pub fn perturbed_in_plane(size: f64, seed: u64) -> Vec<f64> {
    let mut q = reference();
    let noise = Random(seed).vector(q.len());
    for (k, (q, n)) in q.iter_mut().zip(noise).enumerate() {
        if k % 3 != 2 {
            *q += size * n * if k % 6 < 3 { LENGTH } else { 1.0 };
        }
    }
    q
}

/// All vectors rotated, positions shifted as well.
pub fn rotate_all(turn: Quaternion, x: &[f64], shift: [f64; 3]) -> Vec<f64> {
    x.chunks(3)
        .enumerate()
        .flat_map(|(k, c)| {
            let r = rotate(turn, [c[0], c[1], c[2]]);
            let s = if k % 2 == 0 { 1.0 } else { 0.0 };
            std::array::from_fn::<f64, 3, _>(|c| r[c] + s * shift[c])
        })
        .collect()
}

/// Velocities of a rigid motion.
pub fn local_velocities(q: &[f64], omega: [f64; 3], translation: [f64; 3]) -> Vec<f64> {
    q.chunks(3)
        .enumerate()
        .flat_map(|(k, x)| {
            let s = if k % 2 == 0 { 1.0 } else { 0.0 };
            std::array::from_fn::<f64, 3, _>(|c| {
                let (i, j) = ((c + 1) % 3, (c + 2) % 3);
                omega[i] * x[j] - omega[j] * x[i] + s * translation[c]
            })
        })
        .collect()
}

/// The matrix of a lower triangle stored by rows.
pub fn symmetric_full(lower: &[f64; 78]) -> Vec<Vec<f64>> {
    (0..12)
        .map(|i: usize| {
            (0..12)
                .map(|j: usize| {
                    let (a, b) = (i.max(j), i.min(j));
                    lower[a * (a + 1) / 2 + b]
                })
                .collect()
        })
        .collect()
}
