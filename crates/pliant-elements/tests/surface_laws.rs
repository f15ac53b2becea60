//! The laws that every kind of surface element obeys, with every material, damping and rule.

mod common;
mod surfaces;

use common::Random;
use pliant_elements::{
    Bending, Block, Integrals, Motion, Quadrature, SURFACE_KINDS, SurfaceBlock, SurfaceKind,
    SurfaceLaw, Weights, Workspace, elements::KINDS, materials::PlaneStress, testing,
};
use pliant_math::Dual;
use pliant_math::check::{central_difference, dual_jacobian, relative_error};
use pliant_math::rotation;
use surfaces::{cases, example, moved, perturbed, rigid_velocities, symmetric_full};

/// Strains of about a tenth: large, and within the domain of every law.
const SIZE: f64 = 0.06;
const ELEMENT: usize = 1;

const MASS: Weights = Weights { mass: 1.0, damping: 0.0, stiffness: 0.0 };
const DAMPING: Weights = Weights { mass: 0.0, damping: 1.0, stiffness: 0.0 };
const STIFFNESS: Weights = Weights { mass: 0.0, damping: 0.0, stiffness: 1.0 };

/// Calls `check` with each case, its block, reference state, disturbed state and velocities.
fn each(mut check: impl FnMut(SurfaceKind, SurfaceLaw, &SurfaceBlock, [&[f64]; 3])) {
    for (number, (kind, law)) in cases().into_iter().enumerate() {
        let (block, q) = example(kind, law);
        let noise = Random(number as u64).vector(q.len());
        let v = Random(1000 + number as u64).vector(q.len());
        check(kind, law, &block, [&q, &perturbed(kind, &q, &noise, SIZE), &v]);
    }
}

fn constants(x: &[f64]) -> Vec<Dual> {
    x.iter().map(|&c| Dual::new(c, 0.0)).collect()
}

#[test]
fn every_registered_surface_is_here() {
    let surfaces: Vec<&str> = SURFACE_KINDS.iter().map(|kind| kind.name()).collect();
    for kind in KINDS.iter().filter(|kind| !["beam", "cable"].contains(&kind.name)) {
        assert!(surfaces.contains(&kind.name), "write the laws of {}", kind.name);
        let surface = SurfaceKind::of_name(kind.name).unwrap();
        assert_eq!(3 * surface.vectors(), kind.coordinates);
    }
}

#[test]
fn force_is_the_gradient_of_the_energy() {
    each(|kind, law, block, [_, q, _]| {
        let local = block.local(ELEMENT, q);
        let rest = vec![0.0; local.len()];
        let force = vec![testing::surface_force(block, ELEMENT, &local, &rest)];
        let dual = dual_jacobian(&local, |q| vec![testing::surface_energy_dual(block, ELEMENT, q)]);
        let error = relative_error(&dual, &force);
        assert!(error < 1e-12, "{kind:?} {law:?}: {error}");
        let difference =
            central_difference(&local, 1e-6, |q| vec![testing::surface_energy(block, ELEMENT, q)]);
        assert!(relative_error(&difference, &force) < 1e-7, "{kind:?} {law:?}");
    });
}

#[test]
fn vectorised_force_is_the_scalar_one() {
    each(|kind, law, block, [_, q, v]| {
        let rest = vec![0.0; q.len()];
        let motion = Motion { q, v, a: &rest };
        let mut force = vec![0.0; q.len()];
        block.residual(motion, [0.0; 3], &mut Workspace::default(), &mut force, false);
        let mut expected = vec![0.0; q.len()];
        for e in 0..block.element_count() {
            let f = testing::surface_force(block, e, &block.local(e, q), &block.local(e, v));
            for (&o, f) in block.vectors_of(e).iter().zip(f.chunks(3)) {
                for c in 0..3 {
                    expected[o as usize + c] += f[c];
                }
            }
        }
        let error = relative_error(&[force], &[expected]);
        assert!(error < 1e-13, "{kind:?} {law:?}: {error}");
    });
}

#[test]
fn tangent_is_the_derivative_of_the_force() {
    each(|kind, law, block, [_, q, _]| {
        let zero = vec![0.0; q.len()];
        let motion = Motion { q, v: &zero, a: &zero };
        let tangent = symmetric_full(&block.element_tangent(ELEMENT, motion, STIFFNESS));
        let dual = block.element_jacobian(ELEMENT, motion);
        let error = relative_error(&tangent, &dual);
        assert!(error < 1e-12, "{kind:?} {law:?}: {error}");
        let local = block.local(ELEMENT, q);
        let rest = vec![0.0; local.len()];
        let difference =
            central_difference(&local, 1e-6, |q| testing::surface_force(block, ELEMENT, q, &rest));
        assert!(relative_error(&difference, &tangent) < 1e-6, "{kind:?} {law:?}");
    });
}

#[test]
fn predicted_tangent_differs_by_the_square_of_the_increment() {
    each(|kind, law, block, [_, q, direction]| {
        let rest = vec![0.0; q.len()];
        let mut tangent = vec![0.0; block.values_len()];
        block.tangent(Motion { q, v: &rest, a: &rest }, STIFFNESS, &mut tangent, false);
        let gap = |size: f64| {
            let increment: Vec<f64> = direction.iter().map(|d| size * d).collect();
            let mut predicted = vec![0.0; tangent.len()];
            let motion = Motion { q, v: &increment, a: &rest };
            block.predicted_tangent(motion, STIFFNESS, &mut predicted, false);
            predicted.iter().zip(&tangent).map(|(p, t)| (p - t).abs()).fold(0.0, f64::max)
        };
        // The forces that a linearisation misses are of second order.
        let (far, near) = (gap(2e-5), gap(1e-5));
        assert!(far > 0.0 && (near / far - 0.25).abs() < 0.02, "{kind:?} {law:?}: {near}/{far}");
    });
}

#[test]
fn damping_tangent_is_the_derivative_by_velocities() {
    each(|kind, law, block, [_, q, v]| {
        let motion = Motion { q, v, a: v };
        let damping = symmetric_full(&block.element_tangent(ELEMENT, motion, DAMPING));
        let local = constants(&block.local(ELEMENT, q));
        let dual = dual_jacobian(&block.local(ELEMENT, v), |v| {
            testing::surface_force_dual(block, ELEMENT, &local, v)
        });
        let error = relative_error(&damping, &dual);
        assert!(error < 1e-12, "{kind:?} {law:?}: {error}");
        let size = damping.iter().flatten().fold(0.0_f64, |m, c| m.max(*c));
        assert_eq!(law.retardation_time > 0.0, size > 0.0);
    });
}

#[test]
fn mass_matrix_is_the_derivative_by_accelerations_and_positive_definite() {
    each(|kind, law, block, [q, _, _]| {
        let zero = vec![0.0; q.len()];
        let local = block.local(ELEMENT, q);
        let at = |a: &[f64]| {
            let mut global = zero.clone();
            for (&o, a) in block.vectors_of(ELEMENT).iter().zip(a.chunks(3)) {
                global[o as usize..o as usize + 3].copy_from_slice(a);
            }
            block.element_force(ELEMENT, Motion { q, v: &zero, a: &global }, [0.0; 3])
        };
        let numerical = central_difference(&vec![0.0; local.len()], 1.0, at);
        let motion = Motion { q, v: &zero, a: &zero };
        let mass = symmetric_full(&block.element_tangent(ELEMENT, motion, MASS));
        assert!(relative_error(&numerical, &mass) < 1e-12, "{kind:?} {law:?}");
        let n = local.len();
        let matrix = nalgebra::DMatrix::from_fn(n, n, |i, j| mass[i][j]);
        assert!(matrix.symmetric_eigenvalues().min() > 0.0, "{kind:?}");
    });
}

#[test]
fn reference_is_free_of_stress_and_energy() {
    each(|kind, law, block, [q, disturbed, _]| {
        let rest = vec![0.0; q.len()];
        for e in 0..block.element_count() {
            let local = block.local(e, q);
            for f in testing::surface_force(block, e, &local, &rest[..local.len()]) {
                assert!(f.abs() < 1e-12 * surfaces::E, "{kind:?} {law:?}: {f}");
            }
        }
        assert!(block.elastic_energy(q).abs() < 1e-12 * surfaces::E, "{kind:?} {law:?}");
        assert!(block.elastic_energy(disturbed) > 0.0);
    });
}

#[test]
fn energy_and_force_are_objective() {
    let turn = rotation::exp([0.4, -1.2, 0.7]);
    each(|kind, law, block, [_, q, v]| {
        let (turned, rates) =
            (moved(kind, turn, q, [3.0, -2.0, 5.0]), moved(kind, turn, v, [0.0; 3]));
        let (before, after) = (block.elastic_energy(q), block.elastic_energy(&turned));
        assert!((before - after).abs() < 1e-12 * before, "{kind:?} {law:?}");
        let force = |q: &[f64], v: &[f64]| {
            testing::surface_force(
                block,
                ELEMENT,
                &block.local(ELEMENT, q),
                &block.local(ELEMENT, v),
            )
        };
        let expected = moved(kind, turn, &force(q, v), [0.0; 3]);
        let error = relative_error(&[force(&turned, &rates)], &[expected]);
        assert!(error < 1e-11, "{kind:?} {law:?}: {error}");
    });
}

#[test]
fn forces_and_moments_of_a_free_element_vanish() {
    each(|kind, law, block, [_, q, v]| {
        let (q, v) = (block.local(ELEMENT, q), block.local(ELEMENT, v));
        let f = testing::surface_force(block, ELEMENT, &q, &v);
        let size = f.iter().fold(0.0_f64, |m, c| m.max(c.abs()));
        let (mut sum, mut moment) = ([0.0; 3], [0.0; 3]);
        for (k, (x, f)) in q.chunks(3).zip(f.chunks(3)).enumerate() {
            for c in 0..3 {
                let (i, j) = ((c + 1) % 3, (c + 2) % 3);
                moment[c] += x[i] * f[j] - x[j] * f[i];
                if k % kind.vectors_per_node() == 0 {
                    sum[c] += f[c];
                }
            }
        }
        for c in 0..3 {
            assert!(sum[c].abs() < 1e-12 * size, "{kind:?} {law:?}: {sum:?}");
            assert!(moment[c].abs() < 1e-12 * size, "{kind:?} {law:?}: {moment:?}");
        }
    });
}

#[test]
fn damping_takes_energy_but_none_in_rigid_motion() {
    each(|kind, law, block, [_, q, v]| {
        let loss = block.dissipation(q, v);
        assert_eq!(law.retardation_time > 0.0, loss > 0.0, "{kind:?} {law:?}");
        let turning = rigid_velocities(kind, q, [0.3, -2.0, 0.8], [1.0, -3.0, 0.5]);
        assert!(block.dissipation(q, &turning).abs() < 1e-12 * (1.0 + loss), "{kind:?} {law:?}");
    });
}

#[test]
fn mass_momentum_and_energy_are_those_of_the_surface() {
    for kind in SURFACE_KINDS {
        let (block, q) = surfaces::mesh(kind, surfaces::svk(), surfaces::flat, [3, 2], [0.5, 0.4]);
        let mass = surfaces::RHO * surfaces::H * 1.5 * 0.8;
        assert!((block.mass() / mass - 1.0).abs() < 1e-12, "{kind:?}");
        let moment = block.first_moment(&q);
        for (m, center) in moment.into_iter().zip([0.75, 0.4, 0.0]) {
            assert!((m - mass * center).abs() < 1e-12, "{kind:?}");
        }
        // Spinning about its middle: I = m (a^2 + b^2)/12.
        let omega = 2.0;
        let v = rigid_velocities(kind, &q, [0.0, 0.0, omega], [0.4 * omega, -0.75 * omega, 0.0]);
        let inertia = mass * (1.5 * 1.5 + 0.8 * 0.8) / 12.0;
        assert!((block.kinetic_energy(&v) / (0.5 * inertia * omega * omega) - 1.0).abs() < 1e-12);
        let momentum = block.momentum(&q, &v);
        assert!(momentum.linear.iter().all(|p| p.abs() < 1e-12), "{kind:?}");
        assert!((momentum.angular[2] / (inertia * omega) - 1.0).abs() < 1e-12, "{kind:?}");
    }
}

#[test]
fn pressure_tangent_is_the_derivative_and_volume_its_potential() {
    each(|kind, law, block, [_, q, _]| {
        if law.retardation_time > 0.0 {
            return;
        }
        let local = block.local(ELEMENT, q);
        let global = |x: &[f64]| {
            let mut q = q.to_vec();
            for (&o, x) in block.vectors_of(ELEMENT).iter().zip(x.chunks(3)) {
                q[o as usize..o as usize + 3].copy_from_slice(x);
            }
            q
        };
        let difference =
            central_difference(&local, 1e-6, |x| block.pressure_force(ELEMENT, &global(x)));
        let n = local.len();
        let mut out = vec![0.0; n * n];
        block.add_pressure_jacobian(ELEMENT, q, 1.0, &mut out);
        let tangent: Vec<Vec<f64>> = out.chunks(n).map(<[f64]>::to_vec).collect();
        assert!(relative_error(&difference, &tangent) < 1e-7, "{kind:?}");
    });
}

/// Threads do not change the bits: blocks above the size of a task, in pools of one and two threads.
#[test]
fn threads_do_not_change_the_bits() {
    for kind in SURFACE_KINDS {
        let (block, q) =
            surfaces::mesh(kind, surfaces::svk(), surfaces::curved, [12, 12], [0.1, 0.1]);
        let noise = Random(3).vector(q.len());
        let q = perturbed(kind, &q, &noise, 0.01);
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
        assert_eq!(run(1), run(2), "{kind:?}");
    }
}

/// Precomputed integrals are those of quadrature, to what the rule leaves out.
#[test]
fn precomputed_integrals_are_those_of_quadrature() {
    let gap = |kind: SurfaceKind, quadrature: Quadrature| {
        let force = |law: SurfaceLaw| {
            let (block, q) = example(kind, law);
            let q = perturbed(kind, &q, &Random(7).vector(q.len()), SIZE);
            let local = block.local(ELEMENT, &q);
            testing::surface_force(&block, ELEMENT, &local, &vec![0.0; local.len()])
        };
        let law = SurfaceLaw { quadrature, ..surfaces::svk() };
        let exact = force(SurfaceLaw { integrals: Integrals::Precomputed, ..law });
        relative_error(&[force(law)], &[exact])
    };
    // Exact rules: degree 4 a direction, and constant strain.
    assert!(gap(SurfaceKind::QuadMembrane, Quadrature::Full) < 1e-13);
    assert!(gap(SurfaceKind::TriangleMembrane, Quadrature::Standard) < 1e-13);
    // Degree 12: one point more along u leaves less than a tenth of the error.
    let coarse = gap(SurfaceKind::Cylindrical, Quadrature::Standard);
    let fine = gap(SurfaceKind::Cylindrical, Quadrature::Full);
    assert!(coarse < 0.02 && fine < 0.1 * coarse && fine > 1e-8, "{coarse} {fine}");
    // 4 x 4 points of 7 x 7.
    let plate = gap(SurfaceKind::Plate, Quadrature::Standard);
    assert!(plate < 0.01 && plate > 1e-6, "{plate}");
}

/// Simplified bending is that of the exact curvature as long as nothing turns or stretches.
#[test]
fn simplified_bending_is_the_linearised_one() {
    for kind in SURFACE_KINDS.into_iter().filter(|kind| kind.bends()) {
        let stiffness = |bending: Bending| {
            let law = SurfaceLaw { bending, quadrature: Quadrature::Full, ..surfaces::svk() };
            let (block, q) = surfaces::mesh(kind, law, surfaces::flat, [1, 1], [0.5, 0.4]);
            let zero = vec![0.0; q.len()];
            let motion = Motion { q: &q, v: &zero, a: &zero };
            let all = symmetric_full(&block.element_tangent(0, motion, STIFFNESS));
            // Across the surface; along it the simplified form knows gradients of stretch, too.
            let across = all.iter().skip(2).step_by(3);
            across
                .map(|row| row.iter().skip(2).step_by(3).copied().collect())
                .collect::<Vec<Vec<_>>>()
        };
        let error = relative_error(&stiffness(Bending::Simplified), &stiffness(Bending::Exact));
        assert!(error < 1e-12, "{kind:?}: {error}");
    }
}

#[test]
fn options_that_a_kind_does_not_have_are_refused() {
    let (precomputed, simplified) = (
        SurfaceLaw { integrals: Integrals::Precomputed, ..surfaces::svk() },
        SurfaceLaw { bending: Bending::Simplified, ..surfaces::svk() },
    );
    let rubber = surfaces::materials(SurfaceKind::Cylindrical)[1];
    let refused = |kind, law| SurfaceBlock::new(kind, law, &[]).is_err();
    assert!(refused(SurfaceKind::Bicubic, precomputed));
    assert!(refused(SurfaceKind::Triangle, precomputed));
    assert!(refused(SurfaceKind::Cylindrical, SurfaceLaw { material: rubber, ..precomputed }));
    assert!(refused(SurfaceKind::Bicubic, SurfaceLaw { material: rubber, ..simplified }));
    assert!(refused(SurfaceKind::Bicubic, SurfaceLaw { retardation_time: 0.1, ..simplified }));
    let bent = pliant_elements::SurfaceElement {
        vectors: (0..16).map(|k| 3 * k).collect(),
        chart: [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].into(),
        reference: [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]
            .iter()
            .flat_map(|&[u, v]| surfaces::nodal(SurfaceKind::Bicubic, surfaces::curved, u, v))
            .collect(),
        thickness: 0.1,
    };
    let error = SurfaceBlock::new(SurfaceKind::Bicubic, simplified, &[bent]).unwrap_err();
    assert!(error.to_string().contains("curved"), "{error}");
}

/// The tension field is the elastic law in tension and carries nothing across wrinkles.
#[test]
fn film_is_elastic_where_taut_and_uniaxial_where_wrinkled() {
    let kind = SurfaceKind::QuadMembrane;
    let [elastic, _, _, film] = surfaces::materials(kind)[..] else { panic!("four materials") };
    let none = [0.0; 3];
    let taut = [0.02, 0.01, 0.004];
    let [expected, _] = elastic.resultants(0.1, taut, none);
    let [n, _] = film.resultants(0.1, taut, none);
    for k in 0..3 {
        assert!((n[k] / expected[k] - 1.0).abs() < 1e-13);
    }
    let PlaneStress::TensionField(mut ideal) = film else { panic!("a film") };
    ideal.residual_stiffness = 0.0;
    let ideal = PlaneStress::TensionField(ideal);
    // Pure shear g: S11 = S22 = S12 = E g/4, W = h E g^2/8.
    let (h, g) = (0.1, 0.03);
    let shear = [0.0, 0.0, g];
    let [n, _] = ideal.resultants(h, shear, none);
    for n in n {
        assert!((n / (h * surfaces::E * g / 4.0) - 1.0).abs() < 1e-12, "{n}");
    }
    let w: f64 = ideal.energy(h, shear, none);
    assert!((w / (h * surfaces::E * g * g / 8.0) - 1.0).abs() < 1e-12);
    let [n, _] = ideal.resultants(h, [-0.01, -0.02, 0.001], none);
    assert_eq!(n, [0.0; 3]);
}

/// Patch tests: fields of constant strain or curvature leave inner nodes without force, in every rule.
#[test]
fn constant_strain_and_curvature_are_equilibria() {
    for kind in SURFACE_KINDS {
        let rules = [Quadrature::Standard, Quadrature::Reduced, Quadrature::Full];
        let rules = rules.map(|quadrature| SurfaceLaw { quadrature, ..surfaces::svk() });
        for law in rules.into_iter().chain(surfaces::options(kind)) {
            let (block, q) = surfaces::mesh(kind, law, surfaces::flat, [3, 2], [0.5, 0.4]);
            let per_node = 3 * kind.vectors_per_node();
            // Nodes (1, 1) and (2, 1) of 4 x 3.
            let inner = |f: &[f64]| {
                let at = |node: usize| f[node * per_node..(node + 1) * per_node].iter();
                at(4).chain(at(7)).fold(0.0_f64, |m, f| m.max(f.abs()))
            };
            let size = |f: &[f64]| f.iter().fold(0.0_f64, |m, f| m.max(f.abs()));
            let rest = vec![0.0; q.len()];
            let stretched: Vec<f64> = q
                .chunks(3)
                .flat_map(|x| {
                    [1.05 * x[0] + 0.02 * x[1], 0.97 * x[1] - 0.03 * x[0], 0.1 * x[0] + 0.2 * x[1]]
                })
                .collect();
            let mut force = vec![0.0; q.len()];
            let motion = Motion { q: &stretched, v: &rest, a: &rest };
            block.residual(motion, [0.0; 3], &mut Workspace::default(), &mut force, false);
            assert!(inner(&force) < 1e-13 * size(&force), "{kind:?} {law:?}: {}", inner(&force));
            if !kind.bends() {
                continue;
            }
            let motion = Motion { q: &q, v: &rest, a: &rest };
            let stiffness = surfaces::assembled(&block, motion, STIFFNESS);
            let fields: [surfaces::Surface; 3] = [
                |u, _| [[0.0, 0.0, u * u], [0.0, 0.0, 2.0 * u], [0.0; 3], [0.0; 3]],
                |_, v| [[0.0, 0.0, v * v], [0.0; 3], [0.0, 0.0, 2.0 * v], [0.0; 3]],
                |u, v| [[0.0, 0.0, u * v], [0.0, 0.0, v], [0.0, 0.0, u], [0.0, 0.0, 1.0]],
            ];
            // Cylindrical elements have no curvature across u.
            let across = kind != SurfaceKind::Cylindrical;
            for (number, field) in fields.into_iter().enumerate().filter(|&(k, _)| across || k != 1)
            {
                let moved: Vec<f64> = (0..12)
                    .flat_map(|node| {
                        let (u, v) = (0.5 * (node / 3) as f64, 0.4 * (node % 3) as f64);
                        surfaces::nodal(kind, field, u, v)
                    })
                    .flatten()
                    .collect();
                let force = &stiffness * nalgebra::DVector::from_vec(moved);
                let (inner, size) = (inner(force.as_slice()), size(force.as_slice()));
                assert!(
                    inner < 1e-12 * size,
                    "{kind:?} {law:?}, field {number}: {inner} of {size}"
                );
            }
        }
    }
}

/// No modes but the six of rigid motion are free of energy, flat and curved, in every rule.
#[test]
fn only_rigid_motions_are_free_of_energy() {
    for kind in SURFACE_KINDS.into_iter().filter(|kind| kind.bends()) {
        let rules = [Quadrature::Standard, Quadrature::Reduced, Quadrature::Full];
        let rules = rules.map(|quadrature| SurfaceLaw { quadrature, ..surfaces::svk() });
        for law in rules.into_iter().chain(surfaces::options(kind)) {
            let all = [surfaces::flat as surfaces::Surface, surfaces::curved];
            let flat_only = law.bending == Bending::Simplified;
            for surface in all.into_iter().take(if flat_only { 1 } else { 2 }) {
                let (block, q) = surfaces::mesh(kind, law, surface, [3, 2], [0.5, 0.4]);
                let zero = vec![0.0; q.len()];
                let motion = Motion { q: &q, v: &zero, a: &zero };
                let stiffness = surfaces::assembled(&block, motion, STIFFNESS);
                // Against the mass, so that slopes and twists count as what they move.
                let mass = surfaces::assembled(&block, motion, MASS);
                let Some(root) = mass.cholesky() else { panic!("{kind:?}: singular mass") };
                let inverse = root.l().try_inverse().unwrap();
                let reduced = &inverse * stiffness * inverse.transpose();
                let mut squares: Vec<f64> =
                    reduced.symmetric_eigenvalues().iter().copied().collect();
                squares.sort_by(f64::total_cmp);
                let scale = squares[squares.len() - 1];
                let free = squares.iter().filter(|&&w| w.abs() < 1e-11 * scale).count();
                // A flat mesh of cylindrical elements folds along the line where its two rows meet, as documented.
                let hinges = usize::from(kind == SurfaceKind::Cylindrical);
                assert!((6..=6 + hinges).contains(&free), "{kind:?} {law:?}: {squares:?}");
            }
        }
    }
}

#[test]
fn volume_has_its_gradient_and_second_derivative() {
    each(|kind, law, block, [_, q, _]| {
        let alone = block.alone(ELEMENT);
        let q = block.local(ELEMENT, q);
        let origin = [0.3, -0.2, 0.5];
        let volume = central_difference(&q, 1e-5, |q| vec![alone.volume(0, q, origin)]);
        let gradient = alone.volume_gradient(0, &q, origin);
        // Differences of a cubic: h^2, and rounding over h.
        assert!(relative_error(&volume, &[gradient]) < 1e-8, "{kind:?} {law:?}");
        let n = q.len();
        let mut hessian = vec![0.0; n * n];
        alone.add_volume_hessian(0, &q, origin, 2.0, &mut hessian);
        let rows: Vec<Vec<f64>> = hessian.chunks_exact(n).map(<[f64]>::to_vec).collect();
        let slope = central_difference(&q, 1e-3, |q| {
            alone.volume_gradient(0, q, origin).iter().map(|g| 2.0 * g).collect()
        });
        // Differences of a quadratic are exact.
        assert!(relative_error(&rows, &slope) < 1e-11, "{kind:?} {law:?}");
    });
}

#[test]
fn rest_curvature_has_its_gradient_and_second_derivative() {
    let kappa = [0.8, -0.5, 0.3];
    each(|kind, law, block, [_, q, _]| {
        let alone = block.alone(ELEMENT);
        let q = block.local(ELEMENT, q);
        let energy = |q: &[f64]| vec![alone.curvature_energy(0, q, kappa)];
        let gradient = vec![alone.curvature_gradient(0, &q, kappa)];
        if !kind.bends() {
            assert!(gradient[0].iter().all(|g| *g == 0.0) && energy(&q) == [0.0]);
            return;
        }
        let difference = central_difference(&q, 1e-6, energy);
        assert!(relative_error(&difference, &gradient) < 1e-6, "{kind:?} {law:?}");
        let n = q.len();
        let mut hessian = vec![0.0; n * n];
        alone.add_curvature_hessian(0, &q, kappa, 1.0, &mut hessian);
        let rows: Vec<Vec<f64>> = hessian.chunks_exact(n).map(<[f64]>::to_vec).collect();
        let slope = central_difference(&q, 1e-6, |q| alone.curvature_gradient(0, q, kappa));
        // Where a film is at the border of two regimes differences see both.
        assert!(relative_error(&rows, &slope) < 1e-6, "{kind:?} {law:?}");
    });
}

/// Damping of a film: the linear law's where it is taut, none where it hangs slack, never a gain. The energy of a film
/// without residual stiffness is convex in the strain.
#[test]
fn film_is_damped_where_it_pulls() {
    let kind = SurfaceKind::QuadMembrane;
    let [_, _, _, film] = surfaces::materials(kind)[..] else { panic!("four materials") };
    let PlaneStress::TensionField(mut ideal) = film else { panic!("a film") };
    ideal.residual_stiffness = 0.0;
    let material = PlaneStress::TensionField(ideal);
    let none = [0.0; 3];
    for number in 0..200 {
        let x = Random(number).vector(6);
        let (e, rate) = ([x[0], x[1], x[2]], [x[3], x[4], x[5]]);
        let [at_rest, _] = material.resultants(0.1, e, none);
        let moved = [0, 1, 2].map(|k| e[k] + 0.3 * rate[k]);
        let [moving, _] = material.resultants(0.1, moved, none);
        let power: f64 = (0..3).map(|k| (moving[k] - at_rest[k]) * rate[k]).sum();
        assert!(power >= -1e-12 * surfaces::E, "{e:?} {rate:?}: {power}");
    }
    let tau = 0.01;
    let damped = |material| SurfaceLaw { material, retardation_time: tau, ..surfaces::svk() };
    let elastic = PlaneStress::SaintVenantKirchhoff(ideal.elastic);
    let (film, q) = example(kind, damped(material));
    let (sheet, _) = example(kind, damped(elastic));
    for (stretch, rate, pulls) in [(1.05, 0.5, true), (0.9, -0.5, false), (0.9, 0.5, false)] {
        let x: Vec<f64> = q.iter().map(|q| stretch * q).collect();
        let v: Vec<f64> = q.iter().map(|q| rate * q).collect();
        let loss = film.dissipation(&x, &v);
        let expected = if pulls { sheet.dissipation(&x, &v) } else { 0.0 };
        assert!((loss - expected).abs() <= 1e-12 * expected, "{stretch}: {loss} {expected}");
    }
}
