//! Hold: components of nodal vectors of a surface keep their value, or their difference from those of another node,
//! `phi_i = (sum_k w_k q_k).d_i - c_i` over the nodal vectors q_k of one node or two (one equation for each direction
//! d_i). Constant Jacobian, zero Hessian.
//!
//! Against a rigid body slopes keep their components along directions that turn with the body: d_i moves, and the
//! equation is bilinear.
//!
//! Clamped edges, symmetry planes, welds and folds of edges are made of it, node by node; at a node of a fold the angle
//! between the sheets is the joint's freedom. Minus the multipliers are forces on the nodal vectors along the
//! directions: those on positions add up to the reaction, those on slopes are moments.

use super::arm::{Arm, Role};
use super::product::{Product, Products};
use super::side::Side;
use crate::dof_map::DofMap;
use crate::error::ModelError;
use crate::fold::Fold;
use crate::freedom::Freedom;
use crate::point::Interpolation;
use crate::spec::{FoldSpec, JointSpec, NodalSpec, NodeSpec};
use crate::vector::vector;

/// One equation.
#[derive(Clone, Debug)]
pub struct Equation {
    /// The sum of nodal vectors.
    pub value: Interpolation,
    /// How it moves with the joint's first body.
    pub role: Role,
    /// Direction of its component, of unit length.
    pub direction: Arm,
}

/// A joint that holds what it finds at the coordinates `q`.
#[must_use]
pub fn hold(equations: Vec<Equation>, q: &[f64], freedom: Option<Freedom>) -> Products {
    let products = equations.into_iter().map(|Equation { value, role, direction }| Product {
        constant: vector(value.at(q)).dot(&direction.at(q)),
        ..Product::orthogonal(Arm::new(value, role), direction)
    });
    Products::new(products.collect(), freedom)
}

/// The joint of a document.
///
/// # Errors
/// [`ModelError`] for nodes, vectors or directions that do not exist.
pub(crate) fn of_spec(joint: &JointSpec, map: &DofMap, q: &[f64]) -> Result<Products, ModelError> {
    let JointSpec::Hold { name, a, b, equations, rigid, fold } = joint else {
        return Ok(Products::default());
    };
    let place = format!("joint '{name}'");
    let rigid = rigid.as_ref().map(|point| map.point(point, &place)).transpose()?;
    let mut held = Vec::with_capacity(equations.len());
    for equation in equations {
        let mut all = terms(map, a, &equation.a, &place)?;
        if let Some(b) = b {
            all.extend(terms(map, b, &equation.b, &place)?);
        }
        let Some(direction) = vector(equation.direction).try_normalize(0.0) else {
            return Err(ModelError::Value {
                place,
                value: 0.0,
                allowed: "directions longer than zero",
            });
        };
        let moves = equation.a.first().is_some_and(|&w| w != 0.0);
        let (mut value, mut direction) =
            (Interpolation::weighted(all), Arm::fixed(direction.into()));
        let role = match (moves, b) {
            (true, _) => Role::Gap,
            (false, None) => Role::OfFirst,
            _ => Role::Other,
        };
        if let Some((r, frame)) = &rigid {
            if moves {
                value = value.minus(r);
            } else {
                let side = Side { r: r.clone(), frame: frame.clone(), first: false, q };
                direction =
                    side.direction(vector(direction.affine().constant)).ok_or_else(|| {
                        let reason = "slopes are held against rigid bodies only";
                        ModelError::Unsupported { place: place.clone(), reason }
                    })?;
            }
        }
        held.push(Equation { value, role, direction });
    }
    let freedom = fold.as_ref().map(|fold| angle(map, fold, &place)).transpose()?;
    Ok(hold(held, q, freedom))
}

/// Nodal vectors of a node with their weights.
fn terms(
    map: &DofMap,
    node: &NodeSpec,
    weights: &[f64],
    place: &str,
) -> Result<Vec<(usize, f64)>, ModelError> {
    let surface = map.surface(node.surface, place)?;
    let reference = |kind, index, count| {
        Err(ModelError::Reference { place: place.to_owned(), kind, index, count })
    };
    if node.node >= surface.nodes {
        return reference("node", node.node, surface.nodes);
    }
    if weights.len() > surface.vectors {
        return reference("nodal vector", weights.len() - 1, surface.vectors);
    }
    let offsets = (0..).map(|s| surface.offset(node.node, s));
    Ok(offsets.zip(weights.iter().copied()).collect())
}

/// The angle of a fold.
fn angle(map: &DofMap, fold: &FoldSpec, place: &str) -> Result<Freedom, ModelError> {
    let arm = |sum: &[NodalSpec], role| -> Result<Arm, ModelError> {
        let mut all = Vec::new();
        for NodalSpec { at, weights } in sum {
            all.extend(terms(map, at, weights, place)?);
        }
        Ok(Arm::new(Interpolation::weighted(all), role))
    };
    Ok(Freedom::Fold(Fold {
        t: arm(&fold.along, Role::OfFirst)?,
        u: arm(&fold.out, Role::OfFirst)?,
        w: arm(&fold.into, Role::Other)?,
        near: fold.near,
    }))
}
