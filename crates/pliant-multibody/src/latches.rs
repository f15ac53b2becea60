//! Joints that are released and engaged during a run.
//!
//! A joint that is off keeps its place in the structure: its rows read `lambda_ = 0`. A joint that engages is made
//! from the pose at that moment, as others are made from the start: directions and lengths are those found there.
//! Points that were given must lie close together; a point that a body or the world lends is the one found there.

use crate::dof_map::DofMap;
use crate::error::ModelError;
use crate::joints::hold;
use crate::joints::side::{Frame, Side};
use crate::joints::slide_cable::SlideCable;
use crate::joints::{Draft, Joint, of_spec};
use crate::model::Model;
use crate::point::Interpolation;
use crate::spec::JointSpec;
use crate::vector::vector;
use serde::{Deserialize, Serialize};

/// What a joint was made to do at a time.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Switch {
    /// Time [s].
    pub t: f64,
    /// Number of the joint.
    pub joint: usize,
    /// Engaged, or released.
    pub engaged: bool,
    /// Largest gap between its points that is closed up, as [`Scheduled::gap`].
    pub gap: f64,
    /// The joint's coordinates at that moment, from which an engaged one was made.
    pub pose: Vec<f64>,
}

/// What is going to happen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scheduled {
    /// Time [s].
    pub t: f64,
    /// Number of the joint.
    pub joint: usize,
    /// Engage, or release.
    pub engage: bool,
    /// Largest gap between the joint's points [m] that engaging accepts; none: a part of the model's size.
    pub gap: Option<f64>,
}

/// Gap between points that counts as none, in units of the model's size.
pub const CLOSE: f64 = 1e-6;

/// Makes a joint from coordinates `q`: of the start, or, with `latch`, of the moment when it engages.
pub(crate) fn draft(
    joint: &JointSpec,
    map: &DofMap,
    q: &[f64],
    latch: Option<Latch>,
) -> Result<Box<dyn Draft>, ModelError> {
    if let JointSpec::Hold { .. } = joint {
        return Ok(Box::new(hold::of_spec(joint, map, q)?));
    }
    let (name, a, b) = joint.points();
    let place = format!("joint '{name}'");
    let refuse = |reason| ModelError::Unsupported { place: place.clone(), reason };
    let a = a.ok_or_else(|| refuse("it has no points of its own"))?;
    let (r, frame) = map.point(a, &place)?;
    if let JointSpec::SlideCable { cable, slide, .. } = joint {
        if latch.is_some() {
            return Err(refuse("a joint that slides along a cable cannot be engaged"));
        }
        let Some((path, &s)) = map.cables.get(*cable).zip(map.slides.get(*slide)) else {
            return Err(refuse("its cable does not exist"));
        };
        return Ok(Box::new(SlideCable::new(r, path, s)));
    }
    let here = r.at(q);
    let mut a = Side { r, frame, first: true, q };
    let (r, frame) = match b {
        Some(b) => map.point(b, &place)?,
        None => (Interpolation::fixed(here), Frame::World),
    };
    let mut b = Side { r, frame, first: false, q };
    if a.r.terms.is_empty() && b.r.terms.is_empty() {
        return Err(refuse("both its points are fixed in the world"));
    }
    let mut joint = joint.clone();
    if let Some(latch) = latch {
        let gap = (vector(a.r.at(q)) - vector(b.r.at(q))).norm();
        if let JointSpec::Distance { length, .. } = &mut joint {
            *length = gap;
        } else if latch.floats || gap <= latch.gap {
            close(&mut a, &mut b);
        } else {
            let allowed = latch.gap;
            return Err(ModelError::Apart { place, gap, allowed });
        }
    }
    let draft = of_spec(&joint, &a, &b)
        .ok_or_else(|| refuse("its points do not have the directions it needs"))?;
    Ok(Box::new(draft))
}

/// How a joint engages.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Latch {
    /// Whether one of its points is wherever the other is found.
    pub floats: bool,
    /// Largest gap between its points otherwise [m].
    pub gap: f64,
}

/// Moves a point to where the other is: on the second body, or on the first where only that one has axes.
fn close<'q>(a: &mut Side<'q>, b: &mut Side<'q>) {
    let (target, moved) =
        if !matches!(b.frame, Frame::World | Frame::Body(_)) && matches!(a.frame, Frame::Body(_)) {
            (b, a)
        } else {
            (a, b)
        };
    let q = target.q;
    let gap = vector(target.r.at(q)) - vector(moved.r.at(q));
    if let Frame::Body(e) = &moved.frame {
        for e in e {
            let weight = vector(e.at(q)).dot(&gap);
            moved.r.terms.extend(e.terms.iter().map(|&(offset, w)| (offset, w * weight)));
        }
    } else {
        for k in 0..3 {
            moved.r.constant[k] += gap[k];
        }
    }
}

impl Model {
    /// Number of coordinates that tell how joint `k` engaged; none where there is no such joint.
    #[must_use]
    pub fn pose_size(&self, k: usize) -> Option<usize> {
        self.latches.get(k).map(|_| self.joints[k].joint.support().unknowns.len())
    }

    /// Joint `k` as it engages at coordinates `q`.
    pub(crate) fn engaged(
        &self,
        k: usize,
        q: &[f64],
        gap: f64,
    ) -> Result<Box<dyn Joint>, ModelError> {
        let spec = &self.joint_specs[k];
        let placed = &self.joints[k];
        let latch = Latch { floats: self.latches[k].floats, gap };
        let joint = draft(spec, &self.map, q, Some(latch))?;
        if joint.count() != placed.joint.equations() {
            let reason = "the directions it finds are of another kind than those of the start";
            return Err(ModelError::Unsupported {
                place: format!("joint '{}'", placed.name),
                reason,
            });
        }
        Ok(joint.placed(placed.joint.support().clone()))
    }

    /// The same from the joint's own coordinates.
    pub(crate) fn posed(&self, switch: &Switch) -> Result<Box<dyn Joint>, ModelError> {
        let mut q = vec![0.0; self.coordinates()];
        for (&u, x) in self.joints[switch.joint].joint.support().unknowns.iter().zip(&switch.pose) {
            q[u] = *x;
        }
        self.engaged(switch.joint, &q, switch.gap)
    }
}

/// The joints of one run: which hold, how those were made that engaged in it, which of their equations follow from
/// others.
#[derive(Default)]
pub(crate) struct Joints {
    engaged: Vec<bool>,
    posed: Vec<Option<Box<dyn Joint>>>,
    /// For each multiplier whether its row reads `lambda_ = 0`.
    off: Vec<bool>,
}

impl Joints {
    /// Those of a run with this history, in which these equations are redundant (empty: none).
    pub(crate) fn new(model: &Model, history: &[Switch], redundant: &[bool]) -> Self {
        let mut joints = Self {
            engaged: model.joints.iter().map(|_| true).collect(),
            posed: model.joints.iter().map(|_| None).collect(),
            off: Vec::new(),
        };
        for (engaged, latch) in joints.engaged.iter_mut().zip(&model.latches) {
            *engaged = latch.engaged;
        }
        for (k, switch) in history.iter().enumerate() {
            joints.engaged[switch.joint] = switch.engaged;
            let last = !history[k + 1..].iter().any(|s| s.joint == switch.joint && s.engaged);
            if switch.engaged && last {
                joints.posed[switch.joint] = model.posed(switch).ok();
            }
        }
        joints.set_redundant(model, redundant);
        joints
    }

    /// Notes which equations are redundant.
    pub(crate) fn set_redundant(&mut self, model: &Model, redundant: &[bool]) {
        self.off.clear();
        self.off.resize(model.multipliers, false);
        for (joint, engaged) in model.joints.iter().zip(&self.engaged) {
            self.off[joint.first..joint.first + joint.joint.equations()].fill(!engaged);
        }
        for (off, redundant) in self.off.iter_mut().zip(redundant) {
            *off |= redundant;
        }
    }

    /// Joint `k`.
    pub(crate) fn get<'a>(&'a self, model: &'a Model, k: usize) -> &'a dyn Joint {
        match self.posed.get(k) {
            Some(Some(joint)) => joint.as_ref(),
            _ => model.joints[k].joint.as_ref(),
        }
    }

    /// Whether joint `k` holds.
    pub(crate) fn is_engaged(&self, k: usize) -> bool {
        self.engaged[k]
    }

    /// For each multiplier whether its row reads `lambda_ = 0`.
    pub(crate) fn off(&self) -> &[bool] {
        &self.off
    }
}
