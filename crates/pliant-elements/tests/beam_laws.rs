//! The laws that the beam obeys, with every remedy against locking, curved in space and twisted at rest.
#![allow(clippy::unwrap_used)]

mod common;

use common::Random;
use pliant_elements::{
    BeamBlock, BeamElement, BeamLaw, Block, Locking, Motion, Weights, Workspace, elements::KINDS,
    testing,
};
use pliant_math::Dual;
use pliant_math::check::{central_difference, dual_jacobian, relative_error};
use pliant_math::rotation::{self, Quaternion};

const E: f64 = 1e3;
const NU: f64 = 0.3;
const RHO: f64 = 5.0;
const WIDTH: f64 = 0.2;
const HEIGHT: f64 = 0.3;
const LENGTH: f64 = 0.5;
const K: f64 = 0.85;

const MASS: Weights = Weights { mass: 1.0, damping: 0.0, stiffness: 0.0 };
const DAMPING: Weights = Weights { mass: 0.0, damping: 1.0, stiffness: 0.0 };
const STIFFNESS: Weights = Weights { mass: 0.0, damping: 0.0, stiffness: 1.0 };

/// Area, I_y, I_z and torsion constant.
fn section() -> [f64; 4] {
    let (b, h) = (WIDTH, HEIGHT);
    [b * h, b * h.powi(3) / 12.0, h * b.powi(3) / 12.0, 6.0e-4]
}

fn law(locking: Locking) -> BeamLaw {
    let gauss = pliant_math::quadrature::GAUSS_3.pairs();
    let points = gauss.iter().flat_map(|&(a, u)| {
        gauss.map(|(b, v)| [WIDTH * (a - 0.5), HEIGHT * (b - 0.5), u * v * WIDTH * HEIGHT])
    });
    BeamLaw {
        youngs_modulus: E,
        poisson_ratio: NU,
        density: RHO,
        retardation_time: 0.0,
        locking,
        section_points: points.collect(),
    }
}

fn element(nodes: [u32; 2], reference: [[f64; 3]; 8], scale: f64) -> BeamElement {
    let [area, i_y, i_z, torsion] = section();
    BeamElement {
        nodes,
        length: LENGTH,
        reference,
        stretch: [[scale * area, K, K]; 3],
        bend: [[scale * i_y, scale * i_z, scale * torsion]; 3],
        mass: [[scale * area, scale * i_y, scale * i_z]; 5],
    }
}

/// Nodal vectors of a straight line, or of a helix whose sections twist along it, at arc length s.
fn node(curved: bool, s: f64) -> [[f64; 3]; 4] {
    if !curved {
        return [[s, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    }
    let (radius, pitch) = (0.8_f64, 0.6_f64);
    let w = 1.0 / radius.hypot(pitch);
    let (sin, cos) = (w * s).sin_cos();
    let tangent = [-radius * w * sin, radius * w * cos, pitch * w];
    let inward = [-cos, -sin, 0.0];
    let side: [f64; 3] = std::array::from_fn(|c| {
        let (i, j) = ((c + 1) % 3, (c + 2) % 3);
        tangent[i] * inward[j] - tangent[j] * inward[i]
    });
    let (sin, cos) = (0.9 * s).sin_cos();
    let mix = |a: f64, b: f64| std::array::from_fn(|c| a * inward[c] + b * side[c]);
    let r = [radius * (w * s).cos(), radius * (w * s).sin(), pitch * w * s];
    [r, tangent, mix(cos, sin), mix(-sin, cos)]
}

/// A chain of elements with its stress-free coordinates; `varied` gives each its own section.
fn chain(law: &BeamLaw, curved: bool, n: usize, varied: bool) -> (BeamBlock, Vec<f64>) {
    let at = |k: usize| node(curved, LENGTH * k as f64);
    let elements: Vec<BeamElement> = (0..n)
        .map(|e| {
            let [a, b] = [at(e), at(e + 1)];
            let reference = std::array::from_fn(|k| if k < 4 { a[k] } else { b[k - 4] });
            let scale = if varied { 1.0 + 0.1 * e as f64 } else { 1.0 };
            element([12 * e as u32, 12 * (e as u32 + 1)], reference, scale)
        })
        .collect();
    let q = (0..=n).flat_map(|k| at(k).into_iter().flatten().collect::<Vec<_>>()).collect();
    (BeamBlock::new(law.clone(), &elements).unwrap(), q)
}

/// Calls `check` with each case: its name, block, reference state, disturbed state and velocities.
fn each(mut check: impl FnMut(&str, &BeamBlock, [&[f64]; 3])) {
    for locking in [Locking::Enhanced, Locking::Poisson, Locking::None] {
        for curved in [false, true] {
            for retardation_time in [0.0, 0.01] {
                let law = BeamLaw { retardation_time, ..law(locking) };
                let (block, q) = chain(&law, curved, 3, true);
                let noise = Random(7).vector(q.len());
                let disturbed: Vec<f64> = q.iter().zip(&noise).map(|(q, n)| q + 0.05 * n).collect();
                let v = Random(11).vector(q.len());
                let name = format!("{locking:?} curved {curved} tau {retardation_time}");
                check(&name, &block, [&q, &disturbed, &v]);
            }
        }
    }
}

fn array<T: Copy>(x: &[T]) -> [T; 24] {
    std::array::from_fn(|k| x[k])
}

fn full(lower: &[f64]) -> Vec<Vec<f64>> {
    let entry = |i: usize, j: usize| lower[i.max(j) * (i.max(j) + 1) / 2 + i.min(j)];
    (0..24).map(|i| (0..24).map(|j| entry(i, j)).collect()).collect()
}

/// All vectors rotated, positions shifted as well.
fn moved(turn: Quaternion, x: &[f64], shift: [f64; 3]) -> Vec<f64> {
    let place = |(i, c): (usize, &[f64])| {
        let r = rotation::rotate(turn, [c[0], c[1], c[2]]);
        let s = f64::from(u8::from(i % 4 == 0));
        std::array::from_fn::<f64, 3, _>(|c| r[c] + s * shift[c])
    };
    x.chunks(3).enumerate().flat_map(place).collect()
}

/// Velocities of a rigid motion.
fn rigid_velocities(q: &[f64], omega: [f64; 3], translation: [f64; 3]) -> Vec<f64> {
    let speed = |(i, x): (usize, &[f64])| {
        let s = f64::from(u8::from(i % 4 == 0));
        std::array::from_fn::<f64, 3, _>(|c| {
            let (a, b) = ((c + 1) % 3, (c + 2) % 3);
            omega[a] * x[b] - omega[b] * x[a] + s * translation[c]
        })
    };
    q.chunks(3).enumerate().flat_map(speed).collect()
}

#[test]
fn the_beam_is_registered() {
    let kind = KINDS.iter().find(|kind| kind.name == "beam").unwrap();
    assert_eq!(kind.coordinates, 24);
}

#[test]
fn force_is_the_gradient_of_the_energy() {
    each(|name, block, [_, q, _]| {
        let local = block.local(1, q);
        let force = vec![testing::beam_force(block, 1, &local, &[0.0; 24]).to_vec()];
        let dual = dual_jacobian(&local, |q| vec![testing::beam_energy_dual(block, 1, &array(q))]);
        let error = relative_error(&dual, &force);
        assert!(error < 1e-12, "{name}: {error}");
        let difference =
            central_difference(&local, 1e-6, |q| vec![testing::beam_energy(block, 1, &array(q))]);
        assert!(relative_error(&difference, &force) < 1e-7, "{name}");
    });
}

#[test]
fn vectorised_force_and_tangent_are_the_scalar_ones() {
    for varied in [false, true] {
        for tau in [0.0, 0.02] {
            let law = BeamLaw { retardation_time: tau, ..law(Locking::Enhanced) };
            // One group is full, the other is not.
            let (block, q) = chain(&law, true, 11, varied);
            let noise = Random(5).vector(q.len());
            let q: Vec<f64> = q.iter().zip(&noise).map(|(q, n)| q + 0.05 * n).collect();
            let v = Random(6).vector(q.len());
            let motion = Motion { q: &q, v: &v, a: &noise };
            let gravity = [0.3, -9.81, 2.0];
            let mut force = vec![0.0; q.len()];
            block.residual(motion, gravity, &mut Workspace::default(), &mut force, false);
            let mut expected = vec![0.0; q.len()];
            let mut values = vec![0.0; block.values_len()];
            let weights = Weights { mass: 0.7, damping: 0.4, stiffness: 1.3 };
            block.tangent(motion, weights, &mut values, false);
            for e in 0..block.element_count() {
                for (k, f) in block.element_force(e, motion, gravity).into_iter().enumerate() {
                    expected[block.nodes_of(e)[k / 12] as usize + k % 12] += f;
                }
                let slot = block.slot_of(e);
                let stored: Vec<f64> =
                    (0..300).map(|k| values[slot.base + k * slot.stride]).collect();
                let scalar = block.element_tangent(e, motion, weights);
                assert!(relative_error(&[stored], &[scalar]) < 1e-13);
            }
            // Rounding of sums of 784 products.
            assert!(relative_error(&[force], &[expected]) < 1e-12);
        }
    }
}

#[test]
fn tangent_is_the_derivative_of_the_force() {
    each(|name, block, [_, q, _]| {
        let zero = vec![0.0; q.len()];
        let tangent = full(&block.element_tangent(1, Motion { q, v: &zero, a: &zero }, STIFFNESS));
        let rest = [Dual::new(0.0, 0.0); 24];
        let local = block.local(1, q);
        let dual = dual_jacobian(&local, |q| {
            testing::beam_force_dual(block, 1, &array(q), &rest).to_vec()
        });
        let error = relative_error(&tangent, &dual);
        assert!(error < 1e-12, "{name}: {error}");
        let difference = central_difference(&local, 1e-6, |q| {
            testing::beam_force(block, 1, &array(q), &[0.0; 24]).to_vec()
        });
        assert!(relative_error(&difference, &tangent) < 1e-6, "{name}");
    });
}

#[test]
fn damping_tangent_is_the_derivative_by_velocities() {
    each(|name, block, [_, q, v]| {
        let damping = full(&block.element_tangent(1, Motion { q, v, a: v }, DAMPING));
        let local = block.local(1, q).map(|c| Dual::new(c, 0.0));
        let dual = dual_jacobian(&block.local(1, v), |v| {
            testing::beam_force_dual(block, 1, &local, &array(v)).to_vec()
        });
        let error = relative_error(&damping, &dual);
        assert!(error < 1e-12, "{name}: {error}");
        let size = damping.iter().flatten().fold(0.0_f64, |m, c| m.max(*c));
        assert_eq!(block.has_damping(), size > 0.0);
    });
}

#[test]
fn mass_matrix_is_the_derivative_by_accelerations_and_positive_definite() {
    each(|name, block, [q, _, _]| {
        let zero = vec![0.0; q.len()];
        let at = |a: &[f64]| {
            let mut global = zero.clone();
            global[12..36].copy_from_slice(a);
            block.element_force(1, Motion { q, v: &zero, a: &global }, [0.0; 3]).to_vec()
        };
        let numerical = central_difference(&[0.0; 24], 1.0, at);
        let motion = Motion { q, v: &zero, a: &zero };
        let mass = full(&block.element_tangent(1, motion, MASS));
        // Against the forces of the stress-free state, which are rounding.
        assert!(relative_error(&numerical, &mass) < 1e-11, "{name}");
        let matrix = nalgebra::DMatrix::from_fn(24, 24, |i, j| mass[i][j]);
        assert!(matrix.symmetric_eigenvalues().min() > 0.0, "{name}");
    });
}

#[test]
fn reference_is_free_of_stress_and_energy_wherever_it_is() {
    let turn = rotation::exp([0.7, -1.9, 0.4]);
    each(|name, block, [q, _, _]| {
        for q in [q.to_vec(), moved(turn, q, [3.0, -2.0, 5.0])] {
            for e in 0..block.element_count() {
                let local = block.local(e, &q);
                for f in testing::beam_force(block, e, &local, &[0.0; 24]) {
                    // Thirteen digits of E A / L.
                    assert!(f.abs() < 1e-12 * E, "{name}: {f}");
                }
                let strain = block.strain(e, &q);
                let all = strain.curvature.iter().chain(&strain.shear).chain([&strain.axial]);
                assert!(all.fold(0.0_f64, |m, x| m.max(x.abs())) < 1e-13, "{name}: {strain:?}");
            }
            assert!(block.elastic_energy(&q) < 1e-20 * E, "{name}");
        }
    });
}

#[test]
fn energy_and_force_are_objective() {
    let turn = rotation::exp([1.1, 0.3, -2.0]);
    each(|name, block, [_, q, v]| {
        let (turned, rates) = (moved(turn, q, [1.0, 2.0, -1.0]), moved(turn, v, [0.0; 3]));
        let (before, after) = (block.elastic_energy(q), block.elastic_energy(&turned));
        assert!((before - after).abs() < 1e-12 * before, "{name}");
        let force = |q: &[f64], v: &[f64]| {
            testing::beam_force(block, 1, &block.local(1, q), &block.local(1, v)).to_vec()
        };
        let expected = moved(turn, &force(q, v), [0.0; 3]);
        assert!(relative_error(&[force(&turned, &rates)], &[expected]) < 1e-11, "{name}");
    });
}

#[test]
fn forces_and_moments_of_a_free_element_vanish() {
    each(|name, block, [_, q, v]| {
        let (q, v) = (block.local(1, q), block.local(1, v));
        let f = testing::beam_force(block, 1, &q, &v);
        let size = f.iter().fold(0.0_f64, |m, c| m.max(c.abs()));
        let (mut sum, mut moment) = ([0.0; 3], [0.0; 3]);
        for (k, (x, f)) in q.chunks(3).zip(f.chunks(3)).enumerate() {
            for c in 0..3 {
                let (i, j) = ((c + 1) % 3, (c + 2) % 3);
                moment[c] += x[i] * f[j] - x[j] * f[i];
                sum[c] += if k % 4 == 0 { f[c] } else { 0.0 };
            }
        }
        for c in 0..3 {
            assert!(sum[c].abs() < 1e-12 * size, "{name}: {sum:?}");
            assert!(moment[c].abs() < 1e-12 * size, "{name}: {moment:?}");
        }
    });
}

#[test]
fn damping_takes_energy_but_none_in_rigid_motion() {
    each(|name, block, [_, q, v]| {
        let loss = block.dissipation(q, v);
        assert_eq!(block.has_damping(), loss > 0.0, "{name}");
        let turning = rigid_velocities(q, [0.3, -2.0, 0.8], [1.0, -3.0, 0.5]);
        assert!(block.dissipation(q, &turning).abs() < 1e-12 * (1.0 + loss), "{name}");
    });
}

#[test]
fn mass_momentum_and_energy_are_those_of_a_prism() {
    let (block, q) = chain(&law(Locking::Enhanced), false, 4, false);
    let length = 4.0 * LENGTH;
    let [area, i_y, i_z, _] = section();
    let mass = RHO * area * length;
    assert!((block.mass() / mass - 1.0).abs() < 1e-12);
    for (m, center) in block.first_moment(&q).into_iter().zip([0.5 * length, 0.0, 0.0]) {
        assert!((m - mass * center).abs() < 1e-12);
    }
    // Spinning about each axis through the middle.
    let slender = mass * length * length / 12.0;
    let inertia =
        [RHO * length * (i_y + i_z), slender + RHO * length * i_y, slender + RHO * length * i_z];
    for k in 0..3 {
        let mut omega = [0.0; 3];
        omega[k] = 2.0;
        let center = [0.5 * length, 0.0, 0.0];
        let away = std::array::from_fn(|c| {
            let (i, j) = ((c + 1) % 3, (c + 2) % 3);
            -(omega[i] * center[j] - omega[j] * center[i])
        });
        let v = rigid_velocities(&q, omega, away);
        assert!((block.kinetic_energy(&v) / (2.0 * inertia[k]) - 1.0).abs() < 1e-12, "{k}");
        let momentum = block.momentum(&q, &v);
        assert!(momentum.linear.iter().all(|p| p.abs() < 1e-12));
        assert!((momentum.angular[k] / (2.0 * inertia[k]) - 1.0).abs() < 1e-12, "{k}");
    }
}

#[test]
fn only_rigid_motions_are_free_of_energy() {
    each(|name, block, [q, _, _]| {
        let zero = vec![0.0; q.len()];
        let motion = Motion { q, v: &zero, a: &zero };
        let matrix = |weights| {
            let rows = full(&block.element_tangent(1, motion, weights));
            nalgebra::DMatrix::from_fn(24, 24, |i, j| rows[i][j])
        };
        let inverse = matrix(MASS).cholesky().unwrap().l().try_inverse().unwrap();
        let reduced = &inverse * matrix(STIFFNESS) * inverse.transpose();
        let mut squares: Vec<f64> = reduced.symmetric_eigenvalues().iter().copied().collect();
        squares.sort_by(|a, b| a.abs().total_cmp(&b.abs()));
        let scale = squares[23];
        assert!(squares[5].abs() < 1e-11 * scale, "{name}: {squares:?}");
        assert!(squares[6] > 1e-7 * scale, "{name}: {squares:?}");
    });
}

/// Tip displacements of a clamped chain under a tip load, linear; the section's frame is held, the stretch is free.
fn tip(locking: Locking, n: usize, load: usize) -> Vec<f64> {
    let (block, q) = chain(&law(locking), false, n, false);
    let zero = vec![0.0; q.len()];
    let motion = Motion { q: &q, v: &zero, a: &zero };
    let size = q.len();
    let mut k = nalgebra::DMatrix::<f64>::zeros(size, size);
    for e in 0..n {
        let rows = full(&block.element_tangent(e, motion, STIFFNESS));
        for i in 0..24 {
            for j in 0..24 {
                k[(12 * e + i, 12 * e + j)] += rows[i][j];
            }
        }
    }
    // r, and of y and z what turns: y_x, z_x, and y_z - z_y by a penalty that nothing works against.
    for i in [0, 1, 2, 6, 9] {
        k[(i, i)] += 1e9;
    }
    for (i, j, c) in [(8, 8, 1.0), (10, 10, 1.0), (8, 10, -1.0), (10, 8, -1.0)] {
        k[(i, j)] += 1e9 * c;
    }
    let mut f = nalgebra::DVector::zeros(size);
    f[12 * n + load] = 1e-3;
    k.lu().solve(&f).unwrap().iter().map(|u| 1e3 * u).collect()
}

#[test]
fn one_element_bends_as_timoshenko_under_a_tip_load() {
    let [area, i_y, i_z, _] = section();
    let g = E / (2.0 * (1.0 + NU));
    for n in [1, 3] {
        let length = LENGTH * n as f64;
        for (load, inertia) in [(1, i_z), (2, i_y)] {
            let exact = length.powi(3) / (3.0 * E * inertia) + length / (K * g * area);
            let u = tip(Locking::Enhanced, n, load)[12 * n + load];
            // The penalty of the clamp, 1e9 against 3 E I/L^3.
            assert!((u / exact - 1.0).abs() < 1e-6, "{n} {load}: {}", u / exact);
        }
        let stretch = tip(Locking::Enhanced, n, 0)[12 * n];
        assert!((stretch * E * area / length - 1.0).abs() < 1e-6);
    }
}

#[test]
fn continuum_locks_by_the_confined_modulus_and_the_elastic_line_does_not() {
    let [area, i_y, _, _] = section();
    let g = E / (2.0 * (1.0 + NU));
    let n = 40;
    let length = LENGTH * n as f64;
    let exact = length.powi(3) / (3.0 * E * i_y) + length / (K * g * area);
    let ratio = |locking| tip(locking, n, 2)[12 * n + 2] / exact;
    let confined = (1.0 + NU) * (1.0 - 2.0 * NU) / (1.0 - NU);
    // 1/(4 n^2), and the shear correction, which the continuum does not have, at L/h = 67.
    assert!((ratio(Locking::None) / confined - 1.0).abs() < 2e-3);
    assert!((ratio(Locking::Poisson) - (1.0 - 0.25 / (n * n) as f64)).abs() < 2e-5);
}

/// Strain measures on states that are known: fourth order in the angle of an element bent to an arc, exact in twist up
/// to the sine, unchanged by an arc superposed on a rest shape of another curvature.
#[test]
fn strain_measures_are_their_definitions() {
    let (block, q) = chain(&law(Locking::Enhanced), false, 1, false);
    let arc = |angle: f64, about_z: bool| -> Vec<f64> {
        let radius = LENGTH / angle;
        let at = |phi: f64| -> Vec<[f64; 3]> {
            let (s, c) = phi.sin_cos();
            if about_z {
                vec![
                    [radius * s, radius * (1.0 - c), 0.0],
                    [c, s, 0.0],
                    [-s, c, 0.0],
                    [0.0, 0.0, 1.0],
                ]
            } else {
                vec![
                    [radius * s, 0.0, -radius * (1.0 - c)],
                    [c, 0.0, -s],
                    [0.0, 1.0, 0.0],
                    [s, 0.0, c],
                ]
            }
        };
        [at(0.0), at(angle)].concat().into_iter().flatten().collect()
    };
    for about_z in [false, true] {
        let mut errors = Vec::new();
        for angle in [0.4, 0.2] {
            let strain = block.strain(0, &arc(angle, about_z));
            let curvature = strain.curvature[1 + usize::from(about_z)];
            errors.push((curvature * LENGTH / angle - 1.0).abs());
            assert!(strain.shear.iter().all(|g| g.abs() < 1e-14));
            assert!(strain.curvature[0].abs() < 1e-14);
        }
        let order = (errors[0] / errors[1]).log2();
        assert!(errors[0] < 1e-4 && (order - 4.0).abs() < 0.1, "{errors:?}");
    }
    let angle: f64 = 0.3;
    let mut twisted = q;
    let (s, c) = angle.sin_cos();
    twisted[18..24].copy_from_slice(&[0.0, c, s, 0.0, -s, c]);
    let strain = block.strain(0, &twisted);
    assert!((strain.curvature[0] * LENGTH - s).abs() < 1e-14, "{strain:?}");
    let energy = block.elastic_energy(&twisted);
    let g = E / (2.0 * (1.0 + NU));
    let exact = 0.5 * g * section()[3] * s * s / LENGTH;
    assert!((energy / exact - 1.0).abs() < 1e-12);
}

#[test]
fn axial_force_is_that_of_uniaxial_tension() {
    let (block, mut q) = chain(&law(Locking::Enhanced), false, 1, false);
    // A prism stretched with the section free: E_yy = E_zz = -nu E_xx.
    let e: f64 = 0.02;
    let (stretch, across) = ((1.0 + 2.0 * e).sqrt(), (1.0 - 2.0 * NU * e).sqrt());
    q[12] *= stretch;
    for node in [0, 12] {
        q[node + 3] *= stretch;
        q[node + 7] *= across;
        q[node + 11] *= across;
    }
    let area = section()[0];
    assert!((block.axial_force(0, &q) / (E * area * e * stretch) - 1.0).abs() < 1e-12);
    assert!((block.elastic_energy(&q) / (0.5 * E * area * e * e * LENGTH) - 1.0).abs() < 1e-12);
}

/// Small torsion and bending of an arc of 0.5 at rest: each shows as itself and as nothing else, to fourth order.
#[test]
fn an_arc_twists_and_bends_as_it_should() {
    let angle: f64 = 0.5;
    let radius = LENGTH / angle;
    // Rotation field w(s) from its rate tau t + beta n + gamma z, and the displacement with r' = w x t; Simpson's rule.
    let state = |rates: [f64; 3], size: f64| -> (Vec<f64>, Vec<f64>) {
        let n = 2000;
        let (mut w, mut u) = ([0.0_f64; 3], [0.0_f64; 3]);
        let frame = |phi: f64| {
            let (s, c) = phi.sin_cos();
            [[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]]
        };
        let cross = |a: [f64; 3], b: [f64; 3]| -> [f64; 3] {
            std::array::from_fn(|c| {
                let (i, j) = ((c + 1) % 3, (c + 2) % 3);
                a[i] * b[j] - a[j] * b[i]
            })
        };
        let rate = |axes: [[f64; 3]; 3]| -> [f64; 3] {
            std::array::from_fn(|c| (0..3).map(|k| rates[k] * axes[k][c]).sum())
        };
        let h = LENGTH / f64::from(n);
        for k in 0..n {
            // Midpoint rule of the rotation at the middle of the step.
            let axes = frame(angle * (f64::from(k) + 0.5) / f64::from(n));
            let r = rate(axes);
            let middle: [f64; 3] = std::array::from_fn(|c| w[c] + 0.5 * h * r[c]);
            let slope = cross(middle, axes[0]);
            for c in 0..3 {
                u[c] += h * slope[c];
                w[c] += h * r[c];
            }
        }
        let (a, b) = (frame(0.0), frame(angle));
        let end = [radius * angle.sin(), radius * (1.0 - angle.cos()), 0.0];
        let mut rest = vec![[0.0; 3]];
        rest.extend(a);
        rest.push(end);
        rest.extend(b);
        let mut moved = rest.clone();
        for c in 0..3 {
            moved[4][c] += size * u[c];
        }
        for k in 5..8 {
            let turned = cross(w, rest[k]);
            for c in 0..3 {
                moved[k][c] += size * turned[c];
            }
        }
        (rest.concat(), moved.concat())
    };
    let size = 1e-5;
    for k in 0..3 {
        let mut rates = [0.0; 3];
        rates[k] = 1.0;
        let (rest, moved) = state(rates, size);
        let reference = std::array::from_fn(|i| [rest[3 * i], rest[3 * i + 1], rest[3 * i + 2]]);
        let block =
            BeamBlock::new(law(Locking::Enhanced), &[element([0, 12], reference, 1.0)]).unwrap();
        let strain = block.strain(0, &moved);
        for (i, found) in strain.curvature.into_iter().enumerate() {
            let expected = f64::from(u8::from(i == k));
            // The angle to the fourth power over some hundred, and what is quadratic in the size.
            assert!((found / size - expected).abs() < 1e-3, "{k} {i}: {}", found / size);
        }
        // Nothing else stores energy: the slope of curvature, shear, stretch.
        let [_, i_y, i_z, torsion] = section();
        let stiffness = [E / (2.0 * (1.0 + NU)) * torsion, E * i_y, E * i_z][k];
        let exact = 0.5 * stiffness * LENGTH * size * size;
        let energy = block.elastic_energy(&moved);
        assert!((energy / exact - 1.0).abs() < 3e-3, "{k}: {}", energy / exact);
    }
    // Half a turn of the sections in one element.
    let mut half = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    half.extend([[LENGTH, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, -1.0]]);
    let reference = std::array::from_fn(|k| half[k]);
    let refused = BeamBlock::new(law(Locking::Enhanced), &[element([0, 12], reference, 1.0)]);
    assert!(refused.unwrap_err().to_string().contains("take more elements"));
}

/// Threads do not change the bits.
#[test]
fn threads_do_not_change_the_bits() {
    let (block, q) = chain(&law(Locking::Enhanced), true, 200, true);
    let noise = Random(3).vector(q.len());
    let q: Vec<f64> = q.iter().zip(&noise).map(|(q, n)| q + 0.01 * n).collect();
    let motion = Motion { q: &q, v: &noise, a: &noise };
    let weights = Weights { mass: 1.0, damping: 0.5, stiffness: 0.3 };
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let mut force = vec![0.0; q.len()];
        let mut values = vec![0.0; block.values_len()];
        pool.install(|| {
            let parallel = threads > 1;
            let mut workspace = Workspace::default();
            block.residual(motion, [0.0, 0.0, -9.81], &mut workspace, &mut force, parallel);
            block.tangent(motion, weights, &mut values, parallel);
        });
        (force, values)
    };
    assert_eq!(run(1), run(2));
}

#[test]
fn wrong_numbers_are_named() {
    let good = law(Locking::Enhanced);
    let reference = std::array::from_fn(|k| node(false, LENGTH * (k / 4) as f64)[k % 4]);
    let one = element([0, 12], reference, 1.0);
    let refused =
        |law: BeamLaw, one: BeamElement| BeamBlock::new(law, &[one]).unwrap_err().to_string();
    let incompressible = BeamLaw { poisson_ratio: 0.5, ..good.clone() };
    assert!(refused(incompressible, one.clone()).contains("Poisson's ratio"));
    let bare = BeamLaw { locking: Locking::None, section_points: Vec::new(), ..good.clone() };
    assert!(refused(bare, one.clone()).contains("points of the section"));
    let short = BeamElement { length: 0.0, ..one };
    assert!(refused(good, short).contains("beam element 0: the length"));
}
