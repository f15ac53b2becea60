//! The joints of a document, then the rigidity of each rigid body, over all coordinates.

use crate::dof_map::DofMap;
use crate::error::ModelError;
use crate::freedom::Freedom;
use crate::joints::coupled::{Coupled, Term};
use crate::joints::guided::guided;
use crate::joints::rigidity::rigidity;
use crate::joints::side::{Frame, Side};
use crate::joints::{Draft, hinge};
use crate::latches::draft;
use crate::model::{Beginning, PlacedFreedom, PlacedIntegral};
use crate::point::Interpolation;
use crate::signal::Value;
use crate::spec::{JointSpec, ModelSpec, Signal};
use crate::vector::vector;

/// Joints whose places in the equations are not known yet.
pub(super) struct Drafts {
    /// Names and joints.
    pub joints: Vec<(String, Box<dyn Draft>)>,
    /// What they leave free.
    pub freedoms: Vec<PlacedFreedom>,
    /// Integrals that they ask for.
    pub integrals: Vec<PlacedIntegral>,
}

/// The joints of a document.
pub(super) fn draft_joints(
    spec: &ModelSpec,
    map: &DofMap,
    q: &[f64],
) -> Result<Drafts, ModelError> {
    let mut drawn: Vec<Option<Box<dyn Draft>>> = Vec::with_capacity(spec.joints.len());
    let mut freedoms = Vec::new();
    for (number, joint) in spec.joints.iter().enumerate() {
        let found = between_points(joint, map, q)?;
        if let Some(y) = found.as_ref().and_then(|draft| draft.freedom()) {
            freedoms.push(PlacedFreedom { joint: Some(number), y: y.clone() });
        }
        drawn.push(found);
    }
    let mut integrals = Vec::new();
    let mut joints = Vec::with_capacity(spec.joints.len() + map.rigid.len());
    for (joint, found) in spec.joints.iter().zip(drawn) {
        let found = match found {
            Some(found) => found,
            None => along_freedoms(joint, map, q, &freedoms, &mut integrals)?,
        };
        joints.push((joint.points().0.to_owned(), found));
    }
    for (k, name) in map.rigid_names.iter().enumerate() {
        let rigid: Box<dyn Draft> = Box::new(rigidity(&map.axes(k)));
        joints.push((format!("rigidity of '{name}'"), rigid));
    }
    Ok(Drafts { joints, freedoms, integrals })
}

/// A joint between points, or the drive of a point.
fn between_points(
    joint: &JointSpec,
    map: &DofMap,
    q: &[f64],
) -> Result<Option<Box<dyn Draft>>, ModelError> {
    if let JointSpec::Hold { .. } = joint {
        return Ok(Some(draft(joint, map, q, None)?));
    }
    let (name, a, _) = joint.points();
    let Some(a) = a else { return Ok(None) };
    let place = format!("joint '{name}'");
    match joint {
        JointSpec::DrivePoint { position, direction, orientation, .. } => {
            let (r, frame) = map.point(a, &place)?;
            let a = Side { r, frame, first: true, q };
            if a.r.terms.is_empty() {
                let reason = "a point fixed in the world cannot be driven";
                return Err(ModelError::Unsupported { place, reason });
            }
            let (position, direction) = (position.as_ref(), direction.as_ref());
            let drive = guided(&a, &place, position, direction, orientation.as_deref())?;
            Ok(Some(Box::new(drive)))
        }
        JointSpec::DriveAxis { .. } => Ok(None),
        _ => Ok(Some(draft(joint, map, q, None)?)),
    }
}

/// A drive or gear along freedoms.
fn along_freedoms(
    joint: &JointSpec,
    map: &DofMap,
    q: &[f64],
    freedoms: &[PlacedFreedom],
    integrals: &mut Vec<PlacedIntegral>,
) -> Result<Box<dyn Draft>, ModelError> {
    let place = format!("joint '{}'", joint.points().0);
    let refuse = |reason| ModelError::Unsupported { place: place.clone(), reason };
    let freedom = |joint: usize| {
        let found = freedoms.iter().position(|f| f.joint == Some(joint));
        found.ok_or_else(|| refuse("it needs hinges or sliders, whose freedom is one number"))
    };
    let mut driven = |y: Freedom, value: &Signal, rate: bool| {
        let mut value = Value::new(value, &place)?;
        if rate {
            let (rate, from) = (value.clone(), Beginning::Freedom(y.clone()));
            integrals.push(PlacedIntegral { rate, from, in_statics: false });
            value = Value::Integral(integrals.len() - 1, Box::new(value));
        }
        let term = Term { y, factor: 1.0, number: None };
        let drive: Box<dyn Draft> = Box::new(Coupled::new(vec![term], Some(value)));
        Ok(drive)
    };
    match joint {
        JointSpec::DriveJoint { joint, value, rate, .. } => {
            driven(freedoms[freedom(*joint)?].y.clone(), value, *rate)
        }
        JointSpec::DriveAxis { a, axis, value, rate, .. } => {
            let (r, frame) = map.point(a, &place)?;
            let a = Side { r: r.clone(), frame, first: true, q };
            let b = Side { r: Interpolation::fixed(r.at(q)), frame: Frame::World, first: false, q };
            let axis = super::unit(vector(*axis), &place)?;
            let y = hinge::angle(&a, &b, axis);
            driven(y.ok_or_else(|| refuse("it needs a rigid body"))?, value, *rate)
        }
        JointSpec::Gear { joint_a, joint_b, ratio, .. } => {
            if !(ratio.is_finite() && *ratio != 0.0) {
                let allowed = "ratios unlike zero";
                return Err(ModelError::Value { place: place.clone(), value: *ratio, allowed });
            }
            let mut terms = Vec::new();
            for (joint, factor) in [(*joint_a, 1.0), (*joint_b, -ratio)] {
                let number = freedom(joint)?;
                let y = freedoms[number].y.clone();
                terms.push(Term { y, factor, number: Some(number) });
            }
            Ok(Box::new(Coupled::new(terms, None)))
        }
        _ => Err(refuse("it is no drive")),
    }
}
