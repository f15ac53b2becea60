//! Hold: components of nodal vectors of a surface keep their value, or their difference from those of another node,
//! `phi_i = (sum_k w_k q_k).d_i - c_i` over the nodal vectors q_k of one node or two (one equation for each direction d_i). Constant Jacobian, zero Hessian.
//!
//! Clamped edges, symmetry planes and welds of edges are made of it, node by node. Minus the multipliers are forces on
//! the nodal vectors along the directions: those on positions add up to the reaction, those on slopes are moments.

use super::arm::{Arm, Role};
use super::product::{Product, Products};
use crate::dof_map::DofMap;
use crate::error::ModelError;
use crate::point::Interpolation;
use crate::spec::{JointSpec, NodeSpec};
use crate::vector::vector;

/// The joint of a document; it holds what it finds at the start.
///
/// # Errors
/// [`ModelError`] for nodes, vectors or directions that do not exist.
pub(crate) fn hold(joint: &JointSpec, map: &DofMap, q: &[f64]) -> Result<Products, ModelError> {
    let JointSpec::Hold { name, a, b, equations } = joint else {
        return Ok(Products::default());
    };
    let place = format!("joint '{name}'");
    let terms = |node: &NodeSpec, weights: &[f64]| {
        let surface = map.surface(node.surface, &place)?;
        let reference = |kind, index, count| {
            Err(ModelError::Reference { place: place.clone(), kind, index, count })
        };
        if node.node >= surface.nodes {
            return reference("node", node.node, surface.nodes);
        }
        if weights.len() > surface.vectors {
            return reference("nodal vector", weights.len() - 1, surface.vectors);
        }
        let offsets = (0..).map(|s| surface.offset(node.node, s));
        Ok(offsets.zip(weights.iter().copied()).collect::<Vec<_>>())
    };
    let mut products = Vec::with_capacity(equations.len());
    for equation in equations {
        let mut all = terms(a, &equation.a)?;
        if let Some(b) = b {
            all.extend(terms(b, &equation.b)?);
        }
        let Some(direction) = vector(equation.direction).try_normalize(0.0) else {
            return Err(ModelError::Value {
                place: place.clone(),
                value: 0.0,
                allowed: "directions longer than zero",
            });
        };
        let mut value = Interpolation::weighted(all);
        let here = value.at(q);
        value.constant = here.map(|x| -x);
        let moves = equation.a.first().is_some_and(|&w| w != 0.0);
        let role = match (moves, b) {
            (true, _) => Role::Gap,
            (false, None) => Role::OfFirst,
            _ => Role::Other,
        };
        products.push(Product::orthogonal(Arm::new(value, role), Arm::fixed(direction.into())));
    }
    Ok(Products::new(products, None))
}
