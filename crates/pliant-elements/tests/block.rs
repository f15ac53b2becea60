//! Blocks: lanes, threads, bridges, shared nodes, errors.

mod common;

use common::{Random, cable, element, example, laws, nodes, perturbed, section, worked};
use pliant_elements::{
    Block, Cable, CableBlock, CableElement, CableLaw, ElementError, Motion, Parameter, Reference,
    Section, Sections, Weights, Workspace, testing,
};
use pliant_math::Dual;
use pliant_math::check::{dual_jacobian, relative_error};
use proptest::prelude::*;

const GRAVITY: [f64; 3] = [0.3, -9.81, 1.0];
const WEIGHTS: Weights = Weights { mass: 3.0, damping: 0.7, stiffness: 0.2 };

struct State {
    q: Vec<f64>,
    v: Vec<f64>,
    a: Vec<f64>,
}

impl State {
    /// A wavy line of `nodes` nodes in motion.
    fn wavy(nodes: usize, seed: u64) -> Self {
        let n = 6 * nodes;
        let mut q = common::line(nodes - 1);
        for (q, e) in q.iter_mut().zip(Random(seed).vector(n)) {
            *q += 0.05 * e;
        }
        Self { q, v: Random(seed + 1).vector(n), a: Random(seed + 2).vector(n) }
    }

    fn motion(&self) -> Motion<'_> {
        Motion { q: &self.q, v: &self.v, a: &self.a }
    }
}

fn residual(block: &CableBlock, motion: Motion<'_>, parallel: bool) -> Vec<f64> {
    let mut force = vec![0.25; motion.q.len()];
    block.residual(motion, GRAVITY, &mut Workspace::default(), &mut force, parallel);
    force
}

fn tangent(block: &CableBlock, motion: Motion<'_>, parallel: bool) -> Vec<f64> {
    let mut values = vec![f64::NAN; block.values_len()];
    block.tangent(motion, WEIGHTS, &mut values, parallel);
    values
}

fn entry(block: &CableBlock, values: &[f64], e: usize, k: usize) -> f64 {
    let slot = block.slot_of(e);
    values[slot.base + k * slot.stride]
}

#[test]
fn lanes_are_the_scalar_elements() {
    for law in laws() {
        let block = worked(law);
        let q = perturbed(&block, 0.1, 20);
        let v = Random(21).vector(q.len());
        let a = Random(22).vector(q.len());
        let motion = Motion { q: &q, v: &v, a: &a };
        let mut expected = vec![0.25; q.len()];
        let values = tangent(&block, motion, false);
        for (e, _) in block.real_elements() {
            let force = block.element_force(e, motion, GRAVITY);
            for (i, f) in block.indices_of(e).into_iter().zip(force) {
                expected[i] += f;
            }
            let matrix = block.element_tangent(e, motion, WEIGHTS);
            let lanes: Vec<f64> = (0..78).map(|k| entry(&block, &values, e, k)).collect();
            let error = relative_error(&[lanes], &[matrix.to_vec()]);
            assert!(error < 1e-14, "{law:?}: {error}");
        }
        let error = relative_error(&[residual(&block, motion, false)], &[expected]);
        assert!(error < 1e-14, "{law:?}: {error}");
        assert!(values.iter().all(|c| c.is_finite()), "{law:?}");
    }
}

#[test]
fn any_number_of_threads_gives_the_same_bits() {
    for code in [0, 16 + 1, 32 + 2, 128] {
        let law = CableLaw::from_code(code);
        for elements in [1, 64, 1024, 2500] {
            let block = CableBlock::new(law, &[cable(law, elements)]).unwrap();
            let state = State::wavy(elements + 1, 30);
            let serial = residual(&block, state.motion(), false);
            let matrices = tangent(&block, state.motion(), false);
            assert!(serial.iter().chain(&matrices).all(|c| c.is_finite()));
            for threads in [1, 2, 3] {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
                pool.install(|| {
                    assert_eq!(residual(&block, state.motion(), true), serial);
                    assert_eq!(tangent(&block, state.motion(), true), matrices);
                });
            }
        }
    }
}

/// Cables of `elements` each, with nodes one after the other.
fn cables(law: CableLaw, elements: &[usize]) -> Vec<Cable> {
    let mut first = 0;
    elements
        .iter()
        .map(|&n| {
            let cable = Cable { nodes: nodes(first, n + 1), ..cable(law, n) };
            first += n + 1;
            cable
        })
        .collect()
}

#[test]
fn bridges_contribute_exactly_nothing() {
    for law in laws().filter(|law| law.reference == Reference::Straight) {
        let cables = cables(law, &[3, 1, 70, 9]);
        let together = CableBlock::new(law, &cables).unwrap();
        let mut state = State::wavy(87, 40);
        // The worst bridge: its two nodes at one place, slopes that cancel in the middle.
        let (end, start) = (6 * 3, 6 * 4);
        for c in 0..3 {
            state.q[start + c] = state.q[end + c];
            state.q[start + 3 + c] = -state.q[end + 3 + c];
        }
        let mut expected = vec![0.25; state.q.len()];
        for cable in &cables {
            let alone = CableBlock::new(law, std::slice::from_ref(cable)).unwrap();
            let mut workspace = Workspace::default();
            alone.residual(state.motion(), GRAVITY, &mut workspace, &mut expected, false);
        }
        assert_eq!(residual(&together, state.motion(), false), expected, "{law:?}");
        let values = tangent(&together, state.motion(), false);
        let bridges: Vec<usize> =
            (0..together.element_count()).filter(|&e| together.is_bridge(e)).collect();
        assert_eq!(bridges, [3, 5, 76]);
        for e in bridges {
            for k in 0..78 {
                assert_eq!(entry(&together, &values, e, k), 0.0, "{law:?}");
            }
        }
        assert_eq!(together.real_elements().count(), 83);
        assert_eq!(together.elements_of(2), 6..76);
    }
}

#[test]
fn shared_positions_collect_both_cables() {
    let law = CableLaw::default();
    let plain = cables(law, &[2, 2]);
    let mut shared = plain.clone();
    // The second cable starts where the first ends; its own first three coordinates are unused.
    let joint = shared[0].nodes[2].r;
    shared[1].nodes[0].r = joint;
    let block = CableBlock::new(law, &shared).unwrap();
    let mut state = State::wavy(6, 50);
    let (unused, joint) = (plain[1].nodes[0].r as usize, joint as usize);
    for x in [&mut state.q, &mut state.v, &mut state.a] {
        for c in 0..3 {
            x[unused + c] = x[joint + c];
        }
    }
    let apart = residual(&CableBlock::new(law, &plain).unwrap(), state.motion(), false);
    let joined = residual(&block, state.motion(), false);
    for i in 0..apart.len() {
        let expected = if (joint..joint + 3).contains(&i) {
            apart[i] + apart[i - joint + unused] - 0.25
        } else if (unused..unused + 3).contains(&i) {
            0.25
        } else {
            apart[i]
        };
        assert!((joined[i] - expected).abs() < 1e-12 * expected.abs().max(1.0));
    }
    assert_eq!(block.elements_at(joint as u32).count(), 2);
}

#[test]
fn mass_moment_momentum_and_energies() {
    let law = CableLaw::default();
    let block = CableBlock::new(law, &cables(law, &[3, 2])).unwrap();
    let mut q = common::line(6);
    q[3] = 1.0;
    let total = 5.0 * common::MASS * common::LENGTH;
    assert!((block.mass() / total - 1.0).abs() < 1e-14);
    // Straight along x: cables from 0 to 3 L and from 4 L to 6 L.
    let moment = common::MASS * common::LENGTH.powi(2) * (4.5 + 10.0);
    let found = block.first_moment(&q);
    assert!((found[0] / moment - 1.0).abs() < 1e-13 && found[1].abs() < 1e-13);
    assert!(
        (block.gravitational_energy(&q, [-2.0, 5.0, 0.0]) / (2.0 * moment) - 1.0).abs() < 1e-13
    );
    // Turning about z: kinetic energy and angular momentum are those of the line's inertia about z.
    let omega = 1.7;
    let v = common::local_velocities(&q, [0.0, 0.0, omega], [0.0; 3]);
    let inertia = common::MASS * common::LENGTH.powi(3) * (27.0 + 216.0 - 64.0) / 3.0;
    assert!((block.kinetic_energy(&v) / (0.5 * inertia * omega * omega) - 1.0).abs() < 1e-13);
    let momentum = block.momentum(&q, &v);
    assert!((momentum.angular[2] / (inertia * omega) - 1.0).abs() < 1e-13);
    assert!((momentum.linear[1] / (moment * omega) - 1.0).abs() < 1e-13);
    // Free fall: no force but EA times the rounding of the nodes' places, 1e-15 relative to L.
    let a: Vec<f64> = (0..q.len()).map(|i| if i % 6 < 3 { GRAVITY[i % 6] } else { 0.0 }).collect();
    let motion = Motion { q: &q, v: &v, a: &a };
    for f in residual(&block, motion, false) {
        assert!((f - 0.25).abs() < 1e-11, "{f}");
    }
}

#[test]
fn curvature_of_a_circle() {
    let law = CableLaw::default();
    let block = example(law);
    let curvature = block.curvature(2, &common::reference());
    let expected = common::ANGLE / common::LENGTH;
    assert!((curvature[2] / expected - 1.0).abs() < 1e-2 && curvature[0] == 0.0);
}

/// Forces are linear in the stiffnesses and the mass: the derivatives are differences without error.
#[test]
fn parameter_derivatives_are_differences_of_blocks() {
    for law in laws() {
        let block = |ea: f64, ei: f64, mass: f64| {
            let base = section();
            let element = CableElement {
                sections: Sections::constant(Section {
                    axial_stiffness: ea * base.axial_stiffness,
                    bending_stiffness: ei * base.bending_stiffness,
                    mass_per_length: mass * base.mass_per_length,
                }),
                ..element(law, 0)
            };
            common::one(law, element, 1)
        };
        let base = block(1.0, 1.0, 1.0);
        let state = State::wavy(2, 60);
        let before = residual(&base, state.motion(), false);
        let cases = [
            (Parameter::AxialStiffness, block(2.0, 1.0, 1.0)),
            (Parameter::BendingStiffness, block(1.0, 2.0, 1.0)),
            (Parameter::MassPerLength, block(1.0, 1.0, 2.0)),
        ];
        for (parameter, changed) in cases {
            let after = residual(&changed, state.motion(), false);
            let mut derivative = vec![0.0; 12];
            base.add_parameter_derivative(
                parameter,
                Some(0),
                state.motion(),
                GRAVITY,
                &mut derivative,
            );
            let expected: Vec<f64> = after.iter().zip(&before).map(|(a, b)| a - b).collect();
            let error = relative_error(&[derivative], &[expected]);
            assert!(error < 1e-10, "{law:?} {parameter:?}: {error}");
        }
    }
}

#[test]
fn bad_data_is_refused_with_the_number() {
    let law = CableLaw::default();
    let with = |change: &dyn Fn(&mut Cable)| {
        let mut bad = cable(law, 2);
        change(&mut bad);
        CableBlock::new(law, &[cable(law, 1), bad]).unwrap_err()
    };
    let few = with(&|c| c.nodes.truncate(1));
    assert_eq!(few, ElementError::TooFewNodes { cable: 1, nodes: 1 });
    let count = with(&|c| c.elements = vec![element(law, 0); 3]);
    assert!(matches!(count, ElementError::ParameterCount { found: 3, elements: 2, .. }));
    for length in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let error = with(&|c| c.elements[0].length = length);
        assert!(matches!(error, ElementError::OutOfRange { name: "the length", .. }));
    }
    let error = with(&|c| c.elements[0].retardation_time = 0.1);
    assert!(error.to_string().contains("0.1 s"), "{error}");
    let planar = CableLaw { reference: Reference::Planar, ..law };
    let missing = CableBlock::new(planar, &[cable(law, 1)]).unwrap_err();
    assert!(matches!(missing, ElementError::MissingReference { .. }));
    let mut tilted = cable(planar, 1);
    tilted.normal = [0.0, 0.6, 0.8];
    let error = CableBlock::new(planar, &[tilted]).unwrap_err();
    assert!(matches!(error, ElementError::NotPlanar { .. }));
    assert!(CableBlock::new(law, &[]).unwrap().element_count() == 0);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// Force = dU/dq for any uniform element in any sane state.
    #[test]
    fn force_is_the_gradient_for_any_parameters(
        code in 0..8u8,
        length in 1e-3..1e2f64,
        ea in 1e-2..1e9f64,
        ratio in 1e-8..1e-1f64,
        seed in any::<u64>(),
    ) {
        let law = CableLaw::from_code(code);
        let element = CableElement {
            length,
            sections: Sections::constant(Section {
                axial_stiffness: ea,
                bending_stiffness: ea * ratio * length * length,
                mass_per_length: 1.0,
            }),
            retardation_time: 0.0,
            reference: None,
        };
        let block = common::one(law, element, 1);
        let noise = Random(seed).vector(12);
        let q: [f64; 12] = std::array::from_fn(|k| {
            let straight = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0, 0.0][k];
            (straight + 0.2 * noise[k]) * if (k / 3) % 2 == 0 { length } else { 1.0 }
        });
        let dual = dual_jacobian(&q, |q| {
            let q: [Dual; 12] = std::array::from_fn(|k| q[k]);
            vec![testing::energy_dual(&block, 0, &q)]
        });
        let f = testing::force(&block, 0, &q, &[0.0; 12]);
        // Forces on positions and on slopes differ by a length.
        for rows in [[0, 6], [3, 9]] {
            let pick = |x: &[f64]| vec![rows.iter().flat_map(|&r| x[r..r + 3].to_vec()).collect::<Vec<f64>>()];
            prop_assert!(relative_error(&pick(&dual[0]), &pick(&f)) < 1e-11);
        }
    }
}
