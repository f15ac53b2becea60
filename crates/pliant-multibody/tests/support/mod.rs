//! Model documents used by several tests and benchmarks.
#![allow(dead_code)]

use pliant_multibody::spec::{
    Array, BendingSpec, CableSpec, ContactSpec, FrictionSpec, IntegralsSpec, IntegrationSpec,
    JointSpec, MasterSpec, ModelSpec, PointSpec, QuadratureSpec, StrainSpec, SurfaceMaterialSpec,
    SurfaceSpec, VERSION,
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
        plastic: None,
        retardation_time: 0.0,
        shared: none(),
        radius: Some(Array::Inline(vec![5e-3])),
    }
}

/// A flat bicubic sheet of `n` faces of the given size in the xy plane, of the soft material E and the thickness h.
pub fn sheet([nu, nv]: [usize; 2], [a, b]: [f64; 2], e: f64, h: f64) -> SurfaceSpec {
    let none = || Array::Inline(Vec::new());
    let mut reference = Vec::new();
    for i in 0..=nu {
        for j in 0..=nv {
            reference.extend([a * i as f64, b * j as f64, 0.0]);
            reference.extend([1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0]);
        }
    }
    let mut quads = Vec::new();
    for i in 0..nu {
        for j in 0..nv {
            let at = |i: usize, j: usize| (i * (nv + 1) + j) as f64;
            quads.extend([at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]);
        }
    }
    SurfaceSpec {
        name: "sheet".to_owned(),
        vectors: 4,
        reference: Array::Inline(reference),
        q: none(),
        v: none(),
        quad_sizes: Array::Inline([a, b].repeat(nu * nv)),
        quads: Array::Inline(quads),
        triangles: none(),
        triangle_charts: none(),
        thickness: Array::Inline(vec![h]),
        material: SurfaceMaterialSpec::SaintVenantKirchhoff {
            youngs_modulus: e,
            poisson_ratio: 0.3,
        },
        density: 10.0,
        retardation_time: 0.0,
        quadrature: QuadratureSpec::Standard,
        bending: BendingSpec::Exact,
        integrals: IntegralsSpec::Quadrature,
        turns: none(),
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
        beams: Vec::new(),
        rigid_bodies: Vec::new(),
        masses: Vec::new(),
        joints,
        latches: Vec::new(),
        loads: Vec::new(),
        forces: Vec::new(),
        contacts: Vec::new(),
        chambers: Vec::new(),
        probe_contacts: Vec::new(),
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

/// A free cable of 1 m thrown at 1 m/s across another one that is held at both ends, with LuGre friction; 5 mm radius,
/// E = 10 MPa, 40 mm apart at the start.
pub fn thrown_across(elements: usize) -> ModelSpec {
    let low = CableSpec { retardation_time: 1e-3, ..straight_cable("low", elements, 1.0) };
    let mut high = CableSpec { retardation_time: 1e-3, ..straight_cable("high", elements, 1.0) };
    let l = 1.0 / elements as f64;
    let rows =
        |row: &dyn Fn(usize) -> [f64; 3]| Array::Inline((0..=elements).flat_map(row).collect());
    high.r = rows(&|i| [0.47, l * i as f64 - 0.52, 0.05]);
    high.t = rows(&|_| [0.0, 1.0, 0.0]);
    high.v_r = rows(&|_| [0.3, 0.0, -1.0]);
    let end = |name: &str, element: usize, xi: f64| JointSpec::Pin {
        name: name.to_owned(),
        a: PointSpec::Cable { cable: 0, element, xi },
        b: PointSpec::World { world: [xi, 0.0, 0.0] },
    };
    let pins = vec![end("pin1", 0, 0.0), end("pin2", elements - 1, 1.0)];
    let mut spec = document([0.0, 0.0, -9.81], vec![low, high], pins);
    spec.contacts.push(ContactSpec {
        name: "contact1".to_owned(),
        slave: 1,
        master: MasterSpec::Line { line: 0 },
        stiffness: 3e6,
        ramp: 2.5e-5,
        damping: 3.0,
        friction: Some(FrictionSpec::Lugre {
            mu_s: 0.5,
            mu_d: 0.4,
            v_s: 1e-2,
            alpha: 2.0,
            sigma_0: 1e5,
            sigma_1: 20.0,
            sigma_2: 0.0,
            v_d: 5e-2,
            scaled: true,
        }),
        window: 0.0,
        apart: Array::Inline(Vec::new()),
    });
    spec
}
