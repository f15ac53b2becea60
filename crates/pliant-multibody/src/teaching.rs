//! Single elements laid open, for tests and teaching.

use crate::error::ModelError;
use crate::model::Model;
use crate::spec::{Array, CableSpec, ModelSpec, VERSION};
use pliant_elements::{Block, Chart, Motion, SurfaceKind, Weights};

/// What one element answers at given coordinates.
#[derive(Clone, Debug, PartialEq)]
pub struct Element {
    /// Elastic energy [J].
    pub energy: f64,
    /// Inner force, elastic and viscous, (12,).
    pub force: Vec<f64>,
    /// Elastic tangent, (12, 12) row by row.
    pub tangent: Vec<f64>,
    /// Damping matrix, (12, 12) row by row.
    pub damping: Vec<f64>,
    /// Mass matrix, (12, 12) row by row.
    pub mass: Vec<f64>,
}

/// The only element of a cable with two nodes, at coordinates `q = (r1, t1, r2, t2)` and their rates `v`.
///
/// # Errors
/// [`ModelError`] where the cable is wrong, or has more than one element.
pub fn cable_element(cable: &CableSpec, q: &[f64], v: &[f64]) -> Result<Element, ModelError> {
    let empty = || Array::Inline(Vec::new());
    let spec = ModelSpec {
        version: VERSION,
        gravity: [0.0; 3],
        shared_points: empty(),
        shared_velocities: empty(),
        cables: vec![cable.clone()],
        surfaces: Vec::new(),
        beams: Vec::new(),
        rigid_bodies: Vec::new(),
        masses: Vec::new(),
        joints: Vec::new(),
        latches: Vec::new(),
        loads: Vec::new(),
        forces: Vec::new(),
        contacts: Vec::new(),
        chambers: Vec::new(),
        probe_contacts: Vec::new(),
    };
    let model = Model::new(&spec, &[])?;
    for (what, array) in
        [("nodes' coordinates of the cable", model.initial_q.as_slice()), ("q", q), ("v", v)]
    {
        if array.len() != 12 {
            return Err(ModelError::Length {
                place: what.to_owned(),
                expected: "12".to_owned(),
                got: array.len(),
            });
        }
    }
    let block = &model.blocks.cables[0].block;
    let rest = [0.0; 12];
    let matrix = |v: &[f64], mass: f64, damping: f64, stiffness: f64| {
        let motion = Motion { q, v, a: &rest };
        let triangle = block.element_tangent(0, motion, Weights { mass, damping, stiffness });
        let entry = |i: usize, j: usize| triangle[i.max(j) * (i.max(j) + 1) / 2 + i.min(j)];
        (0..144).map(|k| entry(k / 12, k % 12)).collect()
    };
    Ok(Element {
        energy: block.elastic_energy(q),
        force: block.element_force(0, Motion { q, v, a: &rest }, [0.0; 3]).to_vec(),
        tangent: matrix(&rest, 0.0, 0.0, 1.0),
        damping: matrix(v, 0.0, 1.0, 0.0),
        mass: matrix(&rest, 1.0, 0.0, 0.0),
    })
}

/// Shape functions of a surface element at a place: rows (N, N_u, N_v, N_uu, N_vv, N_uv), one a nodal vector.
///
/// # Errors
/// [`ModelError`] for an unknown kind.
pub fn surface_shape(kind: &str, chart: &Chart, at: [f64; 2]) -> Result<Vec<[f64; 6]>, ModelError> {
    let kind = SurfaceKind::of_name(kind).ok_or_else(|| ModelError::Unsupported {
        place: format!("kind '{kind}'"),
        reason: "there is no such surface element",
    })?;
    let rows = kind.shape(chart, at);
    Ok(rows.iter().map(|j| [j.value, j.u, j.v, j.uu, j.vv, j.uv]).collect())
}
