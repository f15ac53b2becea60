//! What touches at given coordinates.

use super::memory::{ProbeMemory, Spot};
use super::onto::Onto;
use super::skin::VECTORS;
use super::{Facing, Probes, Side, vectors_of};
use crate::contact_coupling::Segment;
use nalgebra::Vector3;
use pliant_contact::curve::Piece;
use pliant_contact::foot::Foot;
use pliant_contact::manifolds::meet;
use pliant_contact::probe::{Opposing, Pose, Probe, Slave};
use pliant_contact::shapes::{Distance, Placed, Shape};
use pliant_contact::touch::{Master, Patch, Point};

/// How the slave's vectors make up the probe.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Blend {
    /// A point of a face's rule.
    Rule(usize),
    /// Those of a line's element.
    Line([f64; 4]),
    /// Those of a mass.
    Mass,
    /// A rigid body's own, or none.
    Own,
}

/// How a probe is known again in the next step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Mark {
    /// By its number, and where that is none by its place on the body.
    Number(u64),
    /// By arc length: its own, its zone's, and whether it is a free end.
    Along { arc: f64, zone: [f64; 2], end: bool },
}

/// Where on a surface a foot lies.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ground {
    pub face: usize,
    /// Weights of the face's nodal vectors in r, r_u and r_v there.
    pub weights: [[f64; 3]; VECTORS],
    /// The place on the stress-free surface [m].
    pub place: Vector3<f64>,
}

/// What a probe faces.
// Copied in lists that are short beside all else: boxes would cost more than the room they save.
#[allow(clippy::large_enum_variant)]
#[derive(Clone, Copy, Debug)]
pub(crate) enum Meets {
    /// A shape.
    Shape(Probe),
    /// A face of a surface.
    Face(Foot, Ground),
}

/// A probe in contact.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Touch {
    pub facing: usize,
    pub part: usize,
    pub blend: Blend,
    pub mark: Mark,
    pub meets: Meets,
    /// Gap to report: of the deepest point of a zone the least in all of it [m].
    pub gap: f64,
}

impl Touch {
    /// The point, whatever it faces.
    pub(crate) fn point(&self) -> &dyn Opposing {
        match &self.meets {
            Meets::Shape(probe) => probe,
            Meets::Face(foot, _) => foot,
        }
    }
}

/// What was found, and where.
#[derive(Clone, Debug, Default)]
pub struct Found {
    touches: Vec<Touch>,
    at: Vec<f64>,
    onto: Onto,
}

impl Found {
    /// All probes in contact at `q`.
    pub(crate) fn touches(&mut self, probes: &Probes, q: &[f64]) -> &[Touch] {
        if self.at != q {
            self.touches.clear();
            for (number, facing) in probes.facings.iter().enumerate() {
                facing.find(number, q, &mut self.touches);
            }
            self.onto.find(probes, q, &mut self.touches);
            self.at.clear();
            self.at.extend_from_slice(q);
        }
        &self.touches
    }

    /// Learns where everything was at the last accepted step, `q`: what came from there has its sides from there.
    pub(crate) fn know(&mut self, probes: &Probes, q: &[f64], memory: &ProbeMemory) {
        if !probes.skins.is_empty() && self.onto.was != q {
            self.onto.was.clear();
            self.onto.was.extend_from_slice(q);
            self.onto.crossed.clone_from(&memory.crossed);
            self.at.clear();
        }
    }
}

impl Facing {
    /// Adds all its probes in contact with a shape at `q`.
    pub(crate) fn find(&self, number: usize, q: &[f64], out: &mut Vec<Touch>) {
        let Some((master, shape)) = self.master.shape(q) else { return };
        let moves = self.master.moves();
        let mut add = |part: usize, blend, mark, probe: Probe, gap: f64| {
            if probe.gap() < 0.0 && probe.weight > 0.0 {
                let meets = Meets::Shape(probe);
                out.push(Touch { facing: number, part, blend, mark, meets, gap });
            }
        };
        let facing = |slave: Slave, p: Vector3<f64>, radius: f64, weight: f64| {
            let distance = shape.distance(master.local(p));
            Probe { slave, p, radius, master, moves, distance, weight }
        };
        match &self.slave {
            Side::Sheet(faces) => {
                for (f, face) in faces.iter().enumerate() {
                    let (middle, reach) = face.ball(q);
                    if shape.value(master.local(middle)) > reach + face.radius {
                        continue;
                    }
                    for (k, &(_, area)) in face.rule.iter().enumerate() {
                        let p = face.probe(k, q);
                        if shape.value(master.local(p)) >= face.radius {
                            continue;
                        }
                        let probe = facing(Slave::Point, p, face.radius, area);
                        let mark = Mark::Number((f as u64) << 8 | k as u64);
                        add(f, Blend::Rule(k), mark, probe, probe.gap());
                    }
                }
            }
            Side::Mass(terms, radius) => {
                let p = terms.iter().map(|&(o, w)| Vector3::new(q[o], q[o + 1], q[o + 2]) * w);
                let probe = facing(Slave::Point, p.sum(), *radius, 1.0);
                add(0, Blend::Mass, Mark::Number(0), probe, probe.gap());
            }
            Side::Line(line) => {
                let placed =
                    Placed { shape: shape.clone(), origin: master.origin, axes: master.axes };
                for (e, segment) in line.iter().enumerate() {
                    let piece = segment.piece(q);
                    along(&placed, &piece, segment.free, |point, patch| {
                        let (xi, weight) = (point.xi, point.place.weight);
                        let blend = Blend::Line(piece.weights(xi));
                        let probe = facing(Slave::Point, piece.at(xi), segment.radius, weight);
                        add(e, blend, mark(segment, xi, patch), probe, patch.gap_at(point));
                    });
                }
            }
            Side::Rigid(..) | Side::Rest(..) => {
                let Some((pose, own)) = self.slave.shape(q) else { return };
                let far = shape.distance(master.local(pose.origin)).value;
                if far > own.half_extent().map(|x| x * x).iter().sum::<f64>().sqrt() {
                    return;
                }
                if self.meet {
                    for point in meet((shape, &master), (own, &pose)) {
                        let slave = carried(&self.slave, pose, point.second);
                        let p = pose.at(point.second);
                        // The other's face there is flat.
                        let distance = Distance {
                            value: point.normal.dot(&(master.local(p) - point.first)),
                            normal: point.normal,
                            hessian: nalgebra::Matrix3::zeros(),
                        };
                        let probe = Probe {
                            slave,
                            p,
                            radius: 0.0,
                            master,
                            moves,
                            distance,
                            weight: point.weight,
                        };
                        add(0, Blend::Own, Mark::Number(Spot::NEAREST), probe, probe.gap());
                    }
                    return;
                }
                if let Shape::Capsule { radius, half } = *own {
                    let placed =
                        Placed { shape: shape.clone(), origin: master.origin, axes: master.axes };
                    let axis = pose.axes.column(2).into_owned();
                    let ends = [-half, half].map(|z| pose.origin + axis * z);
                    let piece = Piece::new([ends[0], axis, ends[1], axis], 2.0 * half, radius);
                    along(&placed, &piece, [true; 2], |point, patch| {
                        let (xi, weight) = (point.xi, point.place.weight);
                        let local = Vector3::new(0.0, 0.0, (2.0 * xi - 1.0) * half);
                        let slave = carried(&self.slave, pose, local);
                        let probe = facing(slave, pose.at(local), radius, weight / radius);
                        let zone = [patch.zone.0, patch.zone.1].map(|xi| xi * 2.0 * half);
                        let arc = xi * 2.0 * half;
                        let mark = Mark::Along { arc, zone, end: patch.is_end() };
                        add(0, Blend::Own, mark, probe, patch.gap_at(point));
                    });
                    return;
                }
                let towards = pose.axes.transpose()
                    * (master.axes * -shape.distance(master.local(pose.origin)).normal);
                for (k, (local, radius)) in points(own, towards).into_iter().enumerate() {
                    let slave = carried(&self.slave, pose, local);
                    let probe = facing(slave, pose.at(local), radius, 1.0);
                    add(0, Blend::Own, Mark::Number(k as u64), probe, probe.gap());
                }
            }
        }
    }

    /// Calls `work` with number, coordinate and weight of the vectors that make up a thin slave's probe.
    pub(super) fn each_term(&self, touch: &Touch, mut work: impl FnMut(usize, usize, f64)) {
        match (&self.slave, touch.blend) {
            (Side::Sheet(faces), Blend::Rule(k)) => {
                let face = &faces[touch.part];
                for (i, (&o, &w)) in face.offsets.iter().zip(&face.rule[k].0).enumerate() {
                    work(i, o, w);
                }
            }
            (Side::Line(line), Blend::Line(weights)) => {
                for (i, (&o, w)) in line[touch.part].offsets.iter().zip(weights).enumerate() {
                    work(i, o, w);
                }
            }
            (Side::Mass(terms, _), Blend::Mass) => {
                for (i, &(o, w)) in terms.iter().enumerate() {
                    work(i, o, w);
                }
            }
            _ => {}
        }
    }

    /// Coordinates of a rigid slave and of a moving master.
    pub(super) fn bodies(&self) -> [Option<[usize; 4]>; 2] {
        [&self.slave, &self.master].map(|side| match side {
            Side::Rigid(first, _) => Some(vectors_of(*first)),
            _ => None,
        })
    }
}

pub(super) fn carried(side: &Side, pose: Pose, local: Vector3<f64>) -> Slave {
    match side {
        Side::Rigid(..) => Slave::Body(pose, local),
        _ => Slave::Rest,
    }
}

fn along(shape: &Placed, piece: &Piece, free: [bool; 2], mut work: impl FnMut(&Point, &Patch)) {
    let mut patches = Vec::new();
    Master::Shape(shape).touch(piece, free, &mut patches);
    for patch in &patches {
        for point in patch.points() {
            work(point, patch);
        }
    }
}

fn mark(segment: &Segment, xi: f64, patch: &Patch) -> Mark {
    let arc = |xi: f64| segment.start + xi * segment.length;
    let zone = [arc(patch.zone.0), arc(patch.zone.1)];
    Mark::Along { arc: arc(xi), zone, end: patch.is_end() }
}

/// Points of a shape that may touch what lies in the direction `towards`, and their radii.
pub(super) fn points(shape: &Shape, towards: Vector3<f64>) -> Vec<(Vector3<f64>, f64)> {
    match *shape {
        Shape::Ball { radius } => vec![(Vector3::zeros(), radius)],
        Shape::Box { half } => (0..8)
            .map(|i| {
                let sign = |k: usize| if i >> k & 1 == 1 { 1.0 } else { -1.0 };
                (Vector3::from_fn(|k, _| sign(k) * half[k]), 0.0)
            })
            .collect(),
        Shape::Cylinder { radius, half } => {
            // On each rim the lowest point, and those a quarter turn on: together they carry a cylinder that stands.
            let low = Vector3::new(towards.x, towards.y, 0.0);
            let low = low.try_normalize(1e-12).unwrap_or_else(Vector3::x);
            let turn = Vector3::new(-low.y, low.x, 0.0);
            [-half, half]
                .into_iter()
                .flat_map(|z| {
                    [low, turn, -low, -turn].map(|d| (d * radius + Vector3::z() * z, 0.0))
                })
                .collect()
        }
        Shape::Mesh(ref mesh) => mesh.vertices().into_iter().map(|v| (v, 0.0)).collect(),
        Shape::HalfSpace | Shape::Capsule { .. } | Shape::Bore(_) => Vec::new(),
    }
}
