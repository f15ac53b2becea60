//! Model documents used by several tests and benchmarks.
#![allow(dead_code)]

use pliant_multibody::spec::{
    Array, BendingSpec, CableSpec, IntegrationSpec, JointSpec, ModelSpec, PointSpec, StrainSpec,
    VERSION,
};
use std::f64::consts::PI;

/// A straight cable along x from the origin.
pub fn straight_cable(name: &str, elements: usize, length: f64) -> CableSpec {
    let l = length / elements as f64;
    let nodes = elements + 1;
    let none = || Array::Inline(Vec::new());
    CableSpec {
        name: name.to_owned(),
        strands: Array::Inline(vec![elements as f64]),
        r: Array::Inline((0..nodes).flat_map(|i| [l * i as f64, 0.0, 0.0]).collect()),
        t: Array::Inline((0..nodes).flat_map(|_| [1.0, 0.0, 0.0]).collect()),
        v_r: none(),
        v_t: none(),
        lengths: Array::Inline(vec![l; elements]),
        axial_stiffness: Array::Inline(vec![1e7 * PI * 25e-6]),
        bending_stiffness: Array::Inline(vec![1e7 * PI * 625e-12 / 4.0]),
        mass_per_length: Array::Inline(vec![1000.0 * PI * 25e-6]),
        strain: StrainSpec::Biot,
        integration: IntegrationSpec::Lobatto,
        bending: BendingSpec::Exact,
        reference: None,
        rest_length: None,
        tension_only: false,
        retardation_time: 0.0,
        shared: none(),
    }
}

/// A document of the given cables and joints.
pub fn document(gravity: [f64; 3], cables: Vec<CableSpec>, joints: Vec<JointSpec>) -> ModelSpec {
    ModelSpec {
        version: VERSION,
        gravity,
        shared_points: Array::Inline(Vec::new()),
        shared_velocities: Array::Inline(Vec::new()),
        cables,
        surfaces: Vec::new(),
        rigid_bodies: Vec::new(),
        masses: Vec::new(),
        joints,
        latches: Vec::new(),
        loads: Vec::new(),
        forces: Vec::new(),
    }
}

/// The falling cable pendulum: length 1 m, radius 5 mm, E = 10 MPa, 1000 kg/m^3, horizontal, pinned at the origin.
pub fn pendulum(elements: usize) -> ModelSpec {
    let pin = JointSpec::Pin {
        name: "pin1".to_owned(),
        a: PointSpec::Cable { cable: 0, element: 0, xi: 0.0 },
        b: PointSpec::World { world: [0.0; 3] },
    };
    document([0.0, -9.81, 0.0], vec![straight_cable("rope", elements, 1.0)], vec![pin])
}
