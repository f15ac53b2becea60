//! What the tests of probes share.

use pliant_contact::friction::{Friction, LuGre};
use pliant_contact::normal::Normal;
use pliant_contact::point::Laws;

/// Where the probe sits in the body that carries it [m].
pub const LOCAL: [f64; 3] = [0.05, -0.03, 0.08];

/// A normal law with damping, and friction where wanted.
pub fn laws(friction: bool) -> Laws {
    let lugre = LuGre {
        mu_s: 0.5,
        mu_d: 0.4,
        v_s: 0.3,
        alpha: 2.0,
        sigma_0: 40.0,
        sigma_1: 0.3,
        sigma_2: 0.05,
        scaled: true,
        v_d: 2.0,
    };
    Laws {
        normal: Normal { k: 3e4, d_0: 1e-3, c: 2.0 },
        friction: friction.then_some(Friction::LuGre(lugre)),
    }
}
