//! Laws of friction: derivatives by differences, limits, invariance, exactness for steady slip.

use nalgebra::{Matrix3, Rotation3, Vector3};
use pliant_contact::friction::{Coulomb, Friction, LuGre, Slip, transport};
use proptest::prelude::*;

fn lugre(scaled: bool) -> LuGre {
    LuGre {
        mu_s: 0.5,
        mu_d: 0.3,
        v_s: 1e-2,
        alpha: 2.0,
        sigma_0: 1e4,
        sigma_1: 12.0,
        sigma_2: 0.2,
        scaled,
        v_d: 0.05,
    }
}

fn laws() -> [Friction; 3] {
    let coulomb = Coulomb { mu: 0.4, sigma_0: 1e4, sigma_1: 3.0 };
    [Friction::LuGre(lugre(true)), Friction::LuGre(lugre(false)), Friction::Coulomb(coulomb)]
}

fn in_plane() -> impl Strategy<Value = Vector3<f64>> {
    (-1.0..1.0, -1.0..1.0).prop_map(|(x, y): (f64, f64)| Vector3::new(x, y, 0.0))
}

prop_compose! {
    fn slips()(z in in_plane(), v in in_plane(), w in in_plane(), speed in -6.0..0.5_f64, normal in 0.2..30.0_f64)
        -> Slip {
        let s = 10_f64.powf(speed);
        Slip { z: z * 3e-5, mean: v * s, end: w * s, normal, h: 1e-3 }
    }
}

proptest! {
    #[test]
    fn derivatives_are_those_of_the_force(slip in slips()) {
        for law in laws() {
            let answer = law.respond(&slip);
            let scale = 1e-6 * (slip.mean.norm() + 1e-5);
            let by = |change: &dyn Fn(&mut Slip, f64), d: f64| {
                let mut up = slip;
                let mut down = slip;
                change(&mut up, d);
                change(&mut down, -d);
                (law.respond(&up).force - law.respond(&down).force) / (2.0 * d)
            };
            let (mut mean, mut end) = (Matrix3::zeros(), Matrix3::zeros());
            for k in 0..3 {
                mean.set_column(k, &by(&|s, d| s.mean[k] += d, scale));
                end.set_column(k, &by(&|s, d| s.end[k] += d, 1e-6));
            }
            let normal = by(&|s, d| s.normal += d, 1e-5 * slip.normal);
            // Central differences over a kink (clipping, onset of slip) show a mean of both sides: leave those out.
            let size = mean.norm().max(answer.by_mean.norm());
            let one_sided = {
                let mut up = slip;
                up.mean *= 1.0 + 1e-5;
                (law.respond(&up).by_mean - answer.by_mean).norm() < 1e-3 * size
            };
            prop_assume!(one_sided);
            // Differences of second order with a relative step of 1e-6, and rounding of the force over it.
            let rounding = 1e-15 * answer.force.norm() / scale;
            prop_assert!((mean - answer.by_mean).norm() < 1e-4 * size + 10.0 * rounding, "{law:?}: {mean} {}", answer.by_mean);
            prop_assert!((end - answer.by_end).norm() < 1e-8 * slip.normal + 1e-8 * answer.force.norm() / 1e-6);
            prop_assert!((normal - answer.by_normal).norm() < 1e-6 * (1.0 + answer.by_normal.norm()), "{law:?}");
        }
    }

    #[test]
    fn deflection_stays_within_what_the_contact_carries(slip in slips(), factor in 0.0..1.0_f64) {
        for law in laws() {
            let loose = Slip { normal: factor * slip.normal, ..slip };
            let answer = law.respond(&loose);
            let limit = match law {
                Friction::LuGre(l) if l.scaled => l.mu_s / l.sigma_0,
                Friction::LuGre(l) => l.mu_s * loose.normal / l.sigma_0,
                Friction::Coulomb(l) => l.mu / l.sigma_0,
            };
            prop_assert!(answer.z.norm() <= limit * (1.0 + 1e-14));
            if let Friction::Coulomb(l) = law {
                prop_assert!(answer.force.norm() <= l.mu * loose.normal * (1.0 + 1e-14));
            }
        }
    }

    #[test]
    fn laws_turn_with_the_plane(slip in slips(), axis in prop::array::uniform3(-1.0..1.0_f64), angle in -3.0..3.0_f64) {
        let axis = Vector3::from(axis);
        prop_assume!(axis.norm() > 0.1);
        let turn = Rotation3::from_scaled_axis(axis.normalize() * angle);
        let turned = Slip { z: turn * slip.z, mean: turn * slip.mean, end: turn * slip.end, ..slip };
        for law in laws() {
            let (a, b) = (law.respond(&slip), law.respond(&turned));
            // Rounding of the rotation, in units of the force.
            prop_assert!((turn * a.force - b.force).norm() <= 1e-10 * (a.force.norm() + 1e-10));
        }
    }

    #[test]
    fn transport_keeps_length_and_tangency(a in prop::array::uniform3(-1.0..1.0_f64), b in prop::array::uniform3(-1.0..1.0_f64), z in prop::array::uniform3(-1.0..1.0_f64)) {
        let (a, b) = (Vector3::from(a), Vector3::from(b));
        prop_assume!(a.norm() > 0.1 && b.norm() > 0.1);
        let (a, b) = (a.normalize(), b.normalize());
        prop_assume!(a.dot(&b) > -0.99);
        let z = Vector3::from(z);
        let z = z - a * a.dot(&z);
        let carried = transport(z, a, b);
        // Rounding, amplified by 1/(1 + a.b) <= 100.
        prop_assert!((carried.norm() - z.norm()).abs() < 1e-13);
        prop_assert!(carried.dot(&b).abs() < 1e-13);
    }
}

#[test]
fn two_half_steps_are_one_step_at_steady_slip() {
    // The update is the exact flow of z' = v - f z for a frozen velocity.
    let law = lugre(true);
    let v = Vector3::new(3e-3, -4e-3, 0.0);
    let z = Vector3::new(1e-5, 1e-5, 0.0);
    let step = |z, h| law.respond(&Slip { z, mean: v, end: v, normal: 2.0, h }).z;
    let once = step(z, 2e-3);
    let twice = step(step(z, 1e-3), 1e-3);
    // Rounding only.
    assert!((once - twice).norm() < 1e-18, "{once} {twice}");
}

#[test]
fn steady_slip_carries_the_stribeck_force() {
    let law = LuGre { sigma_2: 0.0, ..lugre(true) };
    for s in [1e-4_f64, 1e-2, 1.0] {
        let v = Vector3::new(s, 0.0, 0.0);
        let answer =
            law.respond(&Slip { z: Vector3::zeros(), mean: v, end: v, normal: 7.0, h: 1e6 });
        let mu = 0.3 + 0.2 * (-(s / 1e-2).powi(2)).exp();
        // After a step of 1e6 s the bristles are at rest up to rounding.
        assert!((answer.force.x / 7.0 - mu).abs() < 1e-12);
    }
}
