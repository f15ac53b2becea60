//! Hold: components of nodal vectors of a surface keep their value, or their difference from those of another node,
//! `phi_i = (q_a - q_b).d_i - c_i` (one equation for each direction d_i). Constant Jacobian, zero Hessian.
//!
//! Clamped edges, symmetry planes and welds of edges are made of it, node by node. Minus the multipliers are forces on
//! the nodal vectors along the directions: those on positions add up to the reaction, those on slopes are moments.

use super::product::{Arm, Product, Products, Role};
use crate::dof_map::DofMap;
use crate::error::ModelError;
use crate::point::Interpolation;
use crate::spec::{JointSpec, NodeSpec};
use crate::vector::vector;

/// The joint of a document with its name; it holds what it finds at the start.
///
/// # Errors
/// [`ModelError`] for nodes, vectors or directions that do not exist.
pub(crate) fn hold(
    joint: &JointSpec,
    map: &DofMap,
    q: &[f64],
) -> Result<(String, Products), ModelError> {
    let JointSpec::Hold { name, a, b, equations } = joint else {
        return Ok((String::new(), Products::default()));
    };
    let place = format!("joint '{name}'");
    let offset = |node: &NodeSpec, number: usize| {
        let surface = map.surface(node.surface, &place)?;
        let reference = |kind, index, count| {
            Err(ModelError::Reference { place: place.clone(), kind, index, count })
        };
        if node.node >= surface.nodes {
            return reference("node", node.node, surface.nodes);
        }
        if number >= surface.vectors {
            return reference("nodal vector", number, surface.vectors);
        }
        Ok(surface.offset(node.node, number))
    };
    let mut products = Vec::with_capacity(equations.len());
    for (number, direction) in equations {
        let mut terms = vec![(offset(a, *number)?, 1.0)];
        if let Some(b) = b {
            terms.push((offset(b, *number)?, -1.0));
        }
        let Some(direction) = vector(*direction).try_normalize(0.0) else {
            return Err(ModelError::Value {
                place: place.clone(),
                value: 0.0,
                allowed: "directions longer than zero",
            });
        };
        let mut value = Interpolation::weighted(terms);
        let here = value.at(q);
        value.constant = here.map(|x| -x);
        let role = match (number, b) {
            (0, _) => Role::Gap,
            (_, None) => Role::OfFirst,
            _ => Role::Other,
        };
        products.push(Product::orthogonal(Arm { value, role }, Arm::fixed(direction.into())));
    }
    Ok((name.clone(), Products::new(products, None)))
}
