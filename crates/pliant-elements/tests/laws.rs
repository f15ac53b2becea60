//! The laws that every kind of line element obeys, for every combination of its options.

mod common;

use common::{
    Random, example, hauled, laws, local_velocities, perturbed, reference, rotate_all,
    symmetric_full,
};
use pliant_elements::{
    Bending, Block, CableLaw, Integration, Motion, Reference, Strain, Weights, elements::KINDS,
    testing,
};
use pliant_math::Dual;
use pliant_math::check::{central_difference, dual_jacobian, relative_error};
use pliant_math::rotation;

/// The elements below are numbers of the example's four.
const ELEMENT: usize = 1;

fn array<T: Copy>(x: &[T]) -> [T; 12] {
    std::array::from_fn(|k| x[k])
}

fn only(which: &str) -> Weights {
    Weights {
        mass: f64::from(u8::from(which == "mass")),
        damping: f64::from(u8::from(which == "damping")),
        stiffness: f64::from(u8::from(which == "stiffness")),
    }
}

#[test]
fn every_law_is_here() {
    assert!(KINDS.iter().any(|kind| kind.name == "cable"));
    assert_eq!(laws().count(), CableLaw::COUNT);
    for law in laws() {
        assert_eq!(CableLaw::from_code(law.code()), law);
    }
}

/// With the work spent on plastic flow since the last step, which a law without plasticity has none of.
#[test]
fn force_is_the_gradient_of_the_energy() {
    for law in laws() {
        let block = example(law);
        let q = perturbed(&block, 0.1, 1);
        let local = block.local(ELEMENT, &q);
        let force = vec![testing::force(&block, ELEMENT, &local, &[0.0; 12]).to_vec()];
        let potential = |q: &[Dual]| {
            let mut potential = testing::energy_dual(&block, ELEMENT, &array(q));
            if law.plastic {
                potential = potential + testing::plastic_work_dual(&block, ELEMENT, &array(q));
            }
            vec![potential]
        };
        let dual = dual_jacobian(&local, potential);
        // The work of a flow through the passage to slack, wide in the example, is left to five Gauss points.
        let tolerance = if law.plastic && law.tension_only { 1e-7 } else { 1e-12 };
        let error = relative_error(&dual, &force);
        assert!(error < tolerance, "{law:?}: {error}");
        let difference = central_difference(&local, 1e-6, |q| {
            let mut potential = testing::energy(&block, ELEMENT, &array(q));
            if law.plastic {
                potential += testing::plastic_work(&block, ELEMENT, &array(q));
            }
            vec![potential]
        });
        assert!(relative_error(&difference, &force) < 1e-7, "{law:?}");
    }
}

#[test]
fn tangent_is_the_derivative_of_the_force() {
    for law in laws() {
        let block = example(law);
        let q = perturbed(&block, 0.1, 2);
        let zero = vec![0.0; q.len()];
        let motion = Motion { q: &q, v: &zero, a: &zero };
        let tangent = symmetric_full(&block.element_tangent(ELEMENT, motion, only("stiffness")));
        let dual: Vec<Vec<f64>> =
            block.element_jacobian(ELEMENT, motion).iter().map(|row| row.to_vec()).collect();
        let error = relative_error(&tangent, &dual);
        assert!(error < 1e-12, "{law:?}: {error}");
        let local = block.local(ELEMENT, &q);
        let difference = central_difference(&local, 1e-6, |q| {
            testing::force(&block, ELEMENT, &array(q), &[0.0; 12]).to_vec()
        });
        assert!(relative_error(&difference, &tangent) < 1e-7, "{law:?}");
    }
}

#[test]
fn damping_tangent_is_the_derivative_by_velocities() {
    for law in laws() {
        let block = hauled(law);
        let q = perturbed(&block, 0.1, 3);
        let v = Random(4).vector(q.len());
        let motion = Motion { q: &q, v: &v, a: &v };
        let damping = symmetric_full(&block.element_tangent(ELEMENT, motion, only("damping")));
        let local = block.local(ELEMENT, &q).map(|c| Dual::new(c, 0.0));
        let dual = dual_jacobian(&block.local(ELEMENT, &v), |v| {
            testing::force_dual(&block, ELEMENT, &local, &array(v)).to_vec()
        });
        let error = relative_error(&damping, &dual);
        assert!(error < 1e-12, "{law:?}: {error}");
        let size = damping.iter().flatten().fold(0.0_f64, |m, c| m.max(*c));
        assert_eq!(law.damped, size > 0.0);
    }
}

/// Where there is damping, the tangent at a moving state differs from the complete derivative only by what it
/// leaves out, of first order in the retardation time.
#[test]
fn tangent_of_moving_state_is_symmetric_and_near_the_complete_one() {
    // In the slack transition the slope of N varies by its own size: what is left out there is not small.
    for law in laws().filter(|law| law.damped && !law.tension_only) {
        let block = hauled(law);
        let q = perturbed(&block, 0.05, 5);
        let v: Vec<f64> = Random(6).vector(q.len()).iter().map(|v| 0.3 * v).collect();
        let motion = Motion { q: &q, v: &v, a: &v };
        let tangent = symmetric_full(&block.element_tangent(ELEMENT, motion, only("stiffness")));
        let complete: Vec<Vec<f64>> =
            block.element_jacobian(ELEMENT, motion).iter().map(|row| row.to_vec()).collect();
        let error = relative_error(&tangent, &complete);
        assert!(error < 0.2, "{law:?}: {error}");
        let local = block.local(ELEMENT, &q);
        let rates = block.local(ELEMENT, &v);
        let difference = central_difference(&local, 1e-6, |q| {
            testing::force(&block, ELEMENT, &array(q), &rates).to_vec()
        });
        assert!(relative_error(&difference, &complete) < 1e-7, "{law:?}");
    }
}

#[test]
fn mass_matrix_is_the_derivative_by_accelerations_and_positive_definite() {
    let block = example(CableLaw::default());
    let q = reference();
    let zero = vec![0.0; q.len()];
    let at = |a: &[f64]| {
        let mut global = zero.clone();
        for (i, c) in block.indices_of(ELEMENT).into_iter().zip(a) {
            global[i] = *c;
        }
        let motion = Motion { q: &q, v: &zero, a: &global };
        block.element_force(ELEMENT, motion, [0.0; 3]).to_vec()
    };
    let numerical = central_difference(&[0.0; 12], 1.0, at);
    let motion = Motion { q: &q, v: &zero, a: &zero };
    let mass = symmetric_full(&block.element_tangent(ELEMENT, motion, only("mass")));
    assert!(relative_error(&numerical, &mass) < 1e-12);
    let matrix = nalgebra::DMatrix::from_fn(12, 12, |i, j| mass[i][j]);
    assert!(matrix.symmetric_eigenvalues().min() > 0.0);
}

#[test]
fn reference_is_free_of_stress_and_energy() {
    for law in laws() {
        let block = example(law);
        let q = if law.reference == Reference::Planar { reference() } else { common::straight() };
        let factor = if law.wound { common::FACTOR } else { 1.0 };
        let q: Vec<f64> = q.iter().map(|x| factor * x).collect();
        let scale = 1e3;
        for e in 0..4 {
            let force = testing::force(&block, e, &block.local(e, &q), &[0.0; 12]);
            for f in force {
                assert!(f.abs() < 1e-12 * scale, "{law:?}: {f}");
            }
        }
        assert!(block.elastic_energy(&q).abs() < 1e-12 * scale, "{law:?}");
        assert!(block.elastic_energy(&perturbed(&block, 0.1, 7)) > 0.0);
    }
}

/// A planar reference with exact bending has its plane fixed in space: rotations about the normal only.
fn rigid_rotation(law: CableLaw) -> rotation::Quaternion {
    if law.reference == Reference::Planar && law.bending == Bending::Exact {
        rotation::exp([0.0, 0.0, 1.1])
    } else {
        rotation::exp([0.4, -1.2, 0.7])
    }
}

#[test]
fn energy_and_force_are_objective() {
    for law in laws() {
        let block = hauled(law);
        let q = perturbed(&block, 0.1, 8);
        let v = Random(9).vector(q.len());
        let turn = rigid_rotation(law);
        let (turned, rates) =
            (rotate_all(turn, &q, [3.0, -2.0, 5.0]), rotate_all(turn, &v, [0.0; 3]));
        let (before, after) = (block.elastic_energy(&q), block.elastic_energy(&turned));
        assert!((before - after).abs() < 1e-12 * before, "{law:?}");
        let local = |x: &[f64]| block.local(ELEMENT, x);
        let force = testing::force(&block, ELEMENT, &local(&q), &local(&v));
        let expected = rotate_all(turn, &force, [0.0; 3]);
        let found = testing::force(&block, ELEMENT, &local(&turned), &local(&rates));
        let error = relative_error(&[found.to_vec()], &[expected]);
        assert!(error < 1e-12, "{law:?}: {error}");
    }
}

/// With damping in the plane only: the vector form resists the spin of a curved line about its own tangent, see below.
#[test]
fn forces_and_moments_of_a_free_element_vanish() {
    for law in laws() {
        let block = example(law);
        let mut q = perturbed(&block, 0.1, 10);
        let mut v = Random(11).vector(q.len());
        if law.damped {
            q = common::perturbed_in_plane(0.1, 10);
            v.iter_mut().skip(2).step_by(3).for_each(|z| *z = 0.0);
        }
        let (q, v) = (block.local(ELEMENT, &q), block.local(ELEMENT, &v));
        let f = testing::force(&block, ELEMENT, &q, &v);
        let size = f.iter().fold(0.0_f64, |m, c| m.max(c.abs()));
        let mut moment = [0.0; 3];
        for node in 0..4 {
            let (x, f) = (&q[3 * node..], &f[3 * node..]);
            for c in 0..3 {
                let (i, j) = ((c + 1) % 3, (c + 2) % 3);
                moment[c] += x[i] * f[j] - x[j] * f[i];
            }
        }
        let fixed_plane = law.reference == Reference::Planar && law.bending == Bending::Exact;
        for c in 0..3 {
            // Exact by construction: the two position forces are one number with two signs.
            assert_eq!(f[c] + f[6 + c], 0.0, "{law:?}");
            if c == 2 || !fixed_plane {
                assert!(moment[c].abs() < 1e-13 * size, "{law:?}: {moment:?}");
            }
        }
    }
}

#[test]
fn damping_takes_energy_but_none_in_rigid_motion() {
    for law in laws() {
        let block = example(law);
        let flat = common::perturbed_in_plane(0.1, 12);
        let v = Random(13).vector(flat.len());
        let loss = block.dissipation(&perturbed(&block, 0.1, 14), &v);
        assert_eq!(law.damped, loss > 0.0, "{law:?}");
        // A plane line turning in its plane, and a straight one turning about any axis.
        let turning = local_velocities(&flat, [0.0, 0.0, 2.0], [1.0, -3.0, 0.5]);
        assert!(block.dissipation(&flat, &turning).abs() < 1e-12 * (1.0 + loss));
        let straight = common::straight();
        let turning = local_velocities(&straight, [0.3, -2.0, 0.8], [0.0; 3]);
        assert!(block.dissipation(&straight, &turning).abs() < 1e-12 * (1.0 + loss));
    }
}

/// The documented exception: a curved line spinning about its own tangent is damped by tau EI kappa^2 omega_t^2.
#[test]
fn spin_of_a_curved_line_about_its_tangent_is_damped_as_documented() {
    let law = CableLaw { damped: true, ..CableLaw::default() };
    let block = common::uniform(law, 1, 0.05);
    // An arc with small angle: spin about the chord is spin about the tangent to second order.
    let (kappa, length, omega) = (0.02, common::LENGTH, 3.0);
    let half = 0.5 * kappa * length;
    let end = |sign: f64| {
        [
            sign * half.sin() / kappa,
            (1.0 - half.cos()) / kappa,
            0.0,
            half.cos(),
            sign * half.sin(),
            0.0,
        ]
    };
    let q: Vec<f64> = end(-1.0).into_iter().chain(end(1.0)).collect();
    let v = local_velocities(&q, [omega, 0.0, 0.0], [0.0; 3]);
    let expected = 0.05 * common::EI * (kappa * omega).powi(2) * length;
    let found = block.dissipation(&q, &v);
    assert!((found / expected - 1.0).abs() < 1e-3, "{found} {expected}");
}

#[test]
fn damping_power_of_pure_bending_is_the_textbook_one() {
    let law = CableLaw { damped: true, ..CableLaw::default() };
    let (tau, rate) = (0.05, 0.7);
    let block = common::uniform(law, 1, tau);
    let q = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, common::LENGTH, 0.0, 0.0, 1.0, 0.0, 0.0];
    // y = rate/2 x (x - L): curvature rate `rate` everywhere.
    let slope = 0.5 * rate * common::LENGTH;
    let v = [0.0, 0.0, 0.0, 0.0, -slope, 0.0, 0.0, 0.0, 0.0, 0.0, slope, 0.0];
    let expected = tau * common::EI * rate * rate * common::LENGTH;
    assert!((block.dissipation(&q, &v) / expected - 1.0).abs() < 1e-12);
    // And of pure stretching: tau EA rate^2 L.
    let v = [0.0, 0.0, 0.0, rate, 0.0, 0.0, rate * common::LENGTH, 0.0, 0.0, rate, 0.0, 0.0];
    let expected = tau * common::EA * rate * rate * common::LENGTH;
    assert!((block.dissipation(&q, &v) / expected - 1.0).abs() < 1e-12);
}

/// The closed form of the full rule for straight uniform cables in Legendre modes of the strain.
#[test]
fn precomputed_axial_energy_is_the_exact_integral() {
    let law = CableLaw { integration: Integration::Full, ..CableLaw::default() };
    let mut soft = common::element(law, 0);
    soft.sections = pliant_elements::Sections::constant(pliant_elements::Section {
        bending_stiffness: 0.0,
        ..common::section()
    });
    let block = common::one(law, soft, 1);
    let q: [f64; 12] = array(&perturbed(&block, 0.2, 15));
    let l = common::LENGTH;
    let d = |c: usize| (q[6 + c] - q[c]) / l;
    let legendre: [[f64; 3]; 3] = [
        std::array::from_fn(d),
        std::array::from_fn(|c| 0.5 * (q[9 + c] - q[3 + c])),
        std::array::from_fn(|c| 0.5 * (q[9 + c] + q[3 + c]) - d(c)),
    ];
    let g = |i: usize, j: usize| -> f64 { (0..3).map(|c| legendre[i][c] * legendre[j][c]).sum() };
    let modes = [
        0.5 * (g(0, 0) + g(1, 1) / 3.0 + g(2, 2) / 5.0 - 1.0),
        g(0, 1) + 0.4 * g(1, 2),
        g(0, 2) + g(1, 1) / 3.0 + g(2, 2) / 7.0,
        0.6 * g(1, 2),
        9.0 / 35.0 * g(2, 2),
    ];
    let sum: f64 = (0..5).map(|k| modes[k] * modes[k] / (2 * k + 1) as f64).sum();
    let expected = 0.5 * common::EA * l * sum;
    assert!((block.elastic_energy(&q) / expected - 1.0).abs() < 1e-13);
    // The force comes from the precomputed form and does the work of that energy.
    let scaled = |s: f64| -> [f64; 12] { std::array::from_fn(|k| q[k] * s) };
    let f = testing::force(&block, 0, &q, &[0.0; 12]);
    let power: f64 = (0..12).map(|k| f[k] * q[k]).sum();
    let h = 1e-4;
    // The energy is a polynomial of degree 4 in the scale: differences of fourth order are exact.
    let u = |s: f64| testing::energy(&block, 0, &scaled(s));
    let slope =
        (8.0 * (u(1.0 + h) - u(1.0 - h)) - (u(1.0 + 2.0 * h) - u(1.0 - 2.0 * h))) / (12.0 * h);
    assert!((power / slope - 1.0).abs() < 1e-9);
}

#[test]
fn strain_measures_are_their_definitions() {
    for strain in [Strain::GreenLagrange, Strain::Biot] {
        let law = CableLaw { strain, ..CableLaw::default() };
        let block = common::uniform(law, 2, 0.0);
        let stretch = 1.3;
        let q: Vec<f64> = common::line(2).iter().map(|c| c * stretch).collect();
        let (eps, slope) = match strain {
            Strain::GreenLagrange => (0.5 * (stretch * stretch - 1.0), stretch),
            Strain::Biot => (stretch - 1.0, 1.0),
        };
        assert!((block.axial_strain(0, &q) - eps).abs() < 1e-14);
        assert!((block.axial_force(1, &q) / (common::EA * eps) - 1.0).abs() < 1e-14);
        // The end's reaction is N d eps/d stretch.
        let f = testing::force(&block, 1, &block.local(1, &q), &[0.0; 12]);
        assert!((f[6] / (common::EA * eps * slope) - 1.0).abs() < 1e-12, "{f:?}");
    }
}

#[test]
fn slack_cable_carries_next_to_nothing_and_tight_one_all() {
    for strain in [Strain::GreenLagrange, Strain::Biot] {
        for integration in [Integration::Lobatto, Integration::Full] {
            let law = CableLaw { strain, integration, tension_only: true, ..CableLaw::default() };
            let mut cable = common::cable(law, 1);
            cable.slack = pliant_elements::Slack::default();
            let block = pliant_elements::CableBlock::new(law, &[cable]).unwrap();
            let force = |stretch: f64| {
                let q: Vec<f64> = common::line(1).iter().map(|c| c * stretch).collect();
                (block.axial_force(0, &q), block.axial_strain(0, &q) * common::EA)
            };
            let (tight, linear) = force(1.1);
            assert!((tight / linear - 1.0).abs() < 1e-4);
            let (slack, linear) = force(0.9);
            assert!(slack < 0.0 && slack > 1.1e-4 * linear);
            assert_eq!(force(1.0).0, 0.0);
        }
    }
}

/// A wound cable is an ordinary one of the scaled length, with slopes by the scaled arc length.
#[test]
fn wound_cable_is_an_ordinary_one_of_another_length() {
    for law in laws().filter(|law| law.wound) {
        let block = hauled(law);
        let factor = common::FACTOR;
        let scaled = |q: &[f64]| -> [f64; 12] {
            std::array::from_fn(|k| if k / 3 % 2 == 1 { q[k] / factor } else { q[k] })
        };
        let shape = |x: [f64; 3], s: f64| x.map(|x| s * x);
        let section = |xi: f64| {
            let s = ELEMENT as f64 + xi;
            pliant_elements::Section {
                axial_stiffness: common::EA * (1.0 + 0.2 * s),
                bending_stiffness: common::EI * (1.0 + 0.1 * s * s),
                mass_per_length: 1.0,
            }
        };
        let element = common::element(law, ELEMENT);
        let element = pliant_elements::CableElement {
            length: factor * element.length,
            sections: pliant_elements::Sections::sample(section),
            reference: element
                .reference
                .map(|[r1, t1, r2, t2]| [shape(r1, factor), t1, shape(r2, factor), t2]),
            ..element
        };
        let other = common::one(CableLaw { wound: false, ..law }, element, 1);
        let q = block.local(ELEMENT, &perturbed(&block, 0.1, 16));
        let v = block.local(ELEMENT, &Random(17).vector(30));
        // Rates of strain are those of nodes that do not follow the scaling of the length.
        let mu = common::RATE / factor;
        let moving: [f64; 12] = std::array::from_fn(|k| v[k] - mu * q[k]);
        let energy = testing::energy(&block, ELEMENT, &q);
        let expected = testing::energy(&other, 0, &scaled(&q));
        assert!((energy / expected - 1.0).abs() < 1e-12, "{law:?}");
        let force = testing::force(&block, ELEMENT, &q, &v).to_vec();
        let expected = testing::force(&other, 0, &scaled(&q), &scaled(&moving));
        let error = relative_error(&[force], &[scaled(&expected).to_vec()]);
        assert!(error < 1e-12, "{law:?}: {error}");
    }
}

#[test]
fn winch_does_work_by_the_derivative_of_the_energy_by_the_length() {
    for law in laws().filter(|law| law.wound) {
        let mut block = hauled(law);
        let q = perturbed(&block, 0.1, 18);
        if law.plastic {
            // Plastic strains stay while the length changes.
            common::harden(&mut block, &q);
        }
        let v = Random(19).vector(q.len());
        let motion = Motion { q: &q, v: &v, a: &v };
        let [elastic, _] = block.length_forces(0, motion);
        let mut energy = |factor: f64| {
            block.set_length(0, factor, 0.0);
            block.elastic_energy(&q)
        };
        let h = 1e-5;
        let slope = (energy(common::FACTOR + h) - energy(common::FACTOR - h)) / (2.0 * h);
        // Central differences: h^2 times a third derivative a few hundred times the first.
        assert!((elastic / slope - 1.0).abs() < 1e-6, "{law:?}: {elastic} {slope}");
    }
}

#[test]
fn line_that_shrinks_with_its_stress_free_length_dissipates_nothing() {
    for law in laws().filter(|law| law.wound && law.damped) {
        let block = hauled(law);
        let q = perturbed(&block, 0.1, 20);
        let mu = common::RATE / common::FACTOR;
        let v: Vec<f64> = q.iter().map(|x| mu * x).collect();
        let other = Random(21).vector(q.len());
        let loss = block.dissipation(&q, &other);
        assert!(loss > 0.0, "{law:?}");
        assert!(block.dissipation(&q, &v).abs() < 1e-12 * loss, "{law:?}");
        // Held nodes of a shrinking line resist the winch.
        assert!(block.dissipation(&q, &vec![0.0; q.len()]) > 0.0, "{law:?}");
    }
}

/// Pure stretch of a straight line, held while its stress-free length shrinks.
#[test]
fn damping_power_of_a_winch_is_the_textbook_one() {
    let law = CableLaw { damped: true, wound: true, strain: Strain::Biot, ..CableLaw::default() };
    let tau = 0.05;
    let mut block = common::uniform(law, 2, tau);
    let (factor, rate, stretch) = (0.9, -0.4, 1.1);
    block.set_length(0, factor, rate);
    let q: Vec<f64> = common::line(2).iter().map(|c| c * stretch).collect();
    // eps = stretch/lambda - 1: its rate, squared, over the scaled length.
    let eps_rate = -stretch * rate / (factor * factor);
    let expected = tau * common::EA * eps_rate * eps_rate * factor * 2.0 * common::LENGTH;
    let found = block.dissipation(&q, &[0.0; 18]);
    assert!((found / expected - 1.0).abs() < 1e-12, "{found} {expected}");
}
