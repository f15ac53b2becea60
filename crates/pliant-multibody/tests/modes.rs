//! Modes of slender lines.

#![allow(clippy::unwrap_used)]

mod support;

use pliant_multibody::model::Model;
use pliant_multibody::solve::{About, modes};
use pliant_multibody::spec::{Array, JointSpec, PointSpec};
use std::sync::Arc;

fn frequencies(ea: f64, count: usize) -> Vec<f64> {
    let mut cable = support::straight_cable("arm", 16, 1.0);
    cable.axial_stiffness = Array::Inline(vec![ea]);
    cable.bending_stiffness = Array::Inline(vec![1.0]);
    cable.mass_per_length = Array::Inline(vec![1.0]);
    let clamp = JointSpec::Clamp {
        name: "clamp1".to_owned(),
        a: PointSpec::Cable { cable: 0, element: 0, xi: 0.0 },
        direction: None,
    };
    let spec = support::document([0.0; 3], vec![cable], vec![clamp]);
    let model = Arc::new(Model::new(&spec, &[]).unwrap());
    let about = About { q: None, lambda_: None, t: 0.0, load_factor: false, chosen: None };
    let (squares, _) = modes(&model, count, &about, None).unwrap();
    squares.iter().map(|w2| w2.sqrt()).collect()
}

#[test]
fn stiffness_ratio_does_not_spoil_the_lowest_modes() {
    // Both planes alike; the iteration's relative tolerance is 1e-10, and bending stiffness stands in the entries of
    // the matrix beside the axial one: rounding of 2e-16 EA/EI.
    for ea in [1e4, 1e8, 1e10] {
        let found = frequencies(ea, 4);
        let exact = [3.516_015_728, 3.516_015_728, 22.034_604_114, 22.034_604_114];
        for (f, e) in found.iter().zip(exact) {
            assert!((f / e - 1.0).abs() < 1e-9, "EA {ea:e}: {found:?}");
        }
    }
}

#[test]
fn all_modes_of_a_small_system_can_be_had() {
    // 17 nodes with 6 coordinates less 5 constraints, minus nothing: every one has mass.
    let found = frequencies(1e4, 97);
    assert_eq!(found.len(), 97);
    assert!(found.windows(2).all(|w| w[0] <= w[1]));
}
