//! Contact in a model: lines over the coordinates, who may touch whom, and with which laws.
//!
//! What is found and remembered during a run is in [`run`] and [`memory`]; the sparsity that follows it in [`coupled`].

pub mod coupled;
pub(crate) mod lines;
pub mod memory;
mod passing;
mod report;
pub mod run;
mod turning;
pub mod way;

use crate::document::Arrays;
use crate::dof_map::DofMap;
use crate::error::ModelError;
use crate::probes::Probes;
use crate::probes::spec::shape_of;
use crate::spec::{FrictionSpec, MasterSpec, ModelSpec};
use lines::{line_of, mass_per_length};
use nalgebra::{Matrix3, Vector3};
use pliant_contact::curve::Piece;
use pliant_contact::friction::{Coulomb, Friction, LuGre};
use pliant_contact::normal::Normal;
use pliant_contact::point::Laws;
use pliant_contact::shapes::Placed;
use pliant_contact::zones::step;
use pliant_dae::structure::Structure;
use std::collections::HashMap;

/// One element of a line.
#[derive(Clone, Debug)]
pub struct Segment {
    /// Offsets of its four vectors.
    pub offsets: [usize; 4],
    /// Those of the directions across the section, y and z at both ends, where there are: of a beam.
    pub section: Option<[usize; 4]>,
    /// Stress-free length [m].
    pub length: f64,
    /// Radius [m].
    pub radius: f64,
    /// Arc length at its beginning [m].
    pub start: f64,
    /// Arc lengths at which its strand begins and ends [m]: where it ends another one may begin, elsewhere.
    pub strand: [f64; 2],
    /// Whether no element follows on the same strand.
    pub last: bool,
    /// Whether its ends are round where it is a master: nothing follows there.
    pub round: [bool; 2],
    /// Whether its ends are free where it is a slave.
    pub free: [bool; 2],
}

impl Segment {
    /// The piece at coordinates `q`.
    #[must_use]
    pub fn piece(&self, q: &[f64]) -> Piece {
        Piece::new(self.vectors(q), self.length, self.radius)
    }

    /// Its control points.
    pub(super) fn control(&self, q: &[f64]) -> [Vector3<f64>; 4] {
        let [a, t, b, u] = self.vectors(q);
        let third = self.length / 3.0;
        [a, a + t * third, b - u * third, b]
    }

    /// Its four vectors at coordinates (or velocities) `q`.
    #[must_use]
    pub fn vectors(&self, q: &[f64]) -> [Vector3<f64>; 4] {
        self.offsets.map(|o| Vector3::new(q[o], q[o + 1], q[o + 2]))
    }
}

/// What a line may touch.
#[derive(Clone, Debug)]
pub enum Master {
    /// A line, by its number.
    Line(usize),
    /// A shape at rest.
    Shape(Box<Placed>),
}

/// A pair that may touch.
#[derive(Clone, Debug)]
pub struct Contact {
    /// Name for messages.
    pub name: String,
    /// Number of the slave line.
    pub slave: usize,
    /// The other.
    pub master: Master,
    /// Laws.
    pub laws: Laws,
    /// On one line: points closer than this along it do not touch [m].
    pub window: f64,
    /// Neighbourhoods of joints: arc lengths on slave and master, inside of their strands, and how far from both nothing
    /// touches [m]; ascending.
    apart: Vec<[f64; 3]>,
    /// How far from any joint contact is less than full [m].
    reach: f64,
}

/// A node, or a joint, at which an element of the slave and one of the master meet end to end; no other joint near them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Corner {
    /// Whether it is at their second ends: of the slave's element, of the master's.
    at_end: [bool; 2],
    /// How far from it nothing touches [m].
    width: f64,
}

impl Corner {
    /// Whether the two are further apart than their radii wherever they may touch: a plane through the corner keeps
    /// them apart, and they leave it fast enough.
    fn parts(&self, [slave, master]: [&Segment; 2], q: &[f64]) -> bool {
        let from_corner = |segment: &Segment, at_end: bool| {
            let mut control = segment.control(q);
            if at_end {
                control.reverse();
            }
            control
        };
        let (a, b) = (from_corner(slave, self.at_end[0]), from_corner(master, self.at_end[1]));
        let Some(u) = ((a[1] - a[0]).normalize() - (b[1] - b[0]).normalize()).try_normalize(1e-2)
        else {
            return false;
        };
        // Distance from the plane is x times a quadratic, which its Bernstein coefficients bound.
        let leaves = |c: &[Vector3<f64>; 4], sign: f64| {
            let away = |k: usize| sign * (c[k] - c[0]).dot(&u) * 3.0 / k as f64;
            away(1).min(away(2)).min(away(3))
        };
        let needed = slave.radius + master.radius + (a[0] - b[0]).norm();
        leaves(&a, 1.0) * self.width >= needed * slave.length
            && leaves(&b, -1.0) * self.width >= needed * master.length
    }
}

impl Contact {
    /// Whether a line touches itself.
    #[must_use]
    pub fn is_self(&self) -> bool {
        matches!(self.master, Master::Line(line) if line == self.slave)
    }

    /// Which share of the force acts between points at these arc lengths: none beside a joint, from half as far again
    /// all of it, and a smooth step between. Where a line folds at a joint, points that enter or leave all at once would
    /// make the force jump; how the share changes with the foot is left out of the tangent.
    #[must_use]
    pub fn share(&self, [slave, master]: [f64; 2], strands: [[f64; 2]; 2]) -> f64 {
        if self.is_self() && (slave - master).abs() < self.window {
            return 0.0;
        }
        let beyond = |[s, m, width]: &[f64; 3]| {
            let way = (slave - s).abs().max((master - m).abs()) / width;
            step(way, SETS_IN)
        };
        self.joints([slave; 2], strands).map(beyond).fold(1.0, f64::min)
    }

    /// Joints of two strands, near a part of the slave's.
    fn joints(
        &self,
        [from, to]: [f64; 2],
        strands: [[f64; 2]; 2],
    ) -> impl Iterator<Item = &[f64; 3]> {
        let begin = self.apart.partition_point(|[s, ..]| *s < from - self.reach);
        let near = self.apart[begin..].iter().take_while(move |[s, ..]| *s <= to + self.reach);
        let on = |at: f64, [from, to]: [f64; 2]| from < at && at < to;
        near.filter(move |[s, m, _]| on(*s, strands[0]) && on(*m, strands[1]))
    }

    /// Where two elements meet.
    pub(super) fn corner(&self, slave: &Segment, master: &Segment) -> Option<Corner> {
        let ends = |segment: &Segment| [segment.start, segment.start + segment.length];
        let of_master = ends(master);
        let near = |[_, m, _]: &&[f64; 3]| {
            (of_master[0] - self.reach..=of_master[1] + self.reach).contains(m)
        };
        let mut joints = self.joints(ends(slave), [slave.strand, master.strand]).filter(near);
        let (first, second) = (joints.next(), joints.next());
        if second.is_some() {
            return None;
        }
        let Some(&[s, m, width]) = first else {
            let follows = |a: &Segment, b: &Segment| {
                self.is_self() && !a.last && (a.start + a.length - b.start).abs() <= 1e-9 * a.length
            };
            let at_end = [follows(slave, master), follows(master, slave)];
            return (at_end[0] != at_end[1]).then_some(Corner { at_end, width: self.window });
        };
        let end = |segment: &Segment, at: f64| -> Option<bool> {
            let close = NUDGED * segment.length;
            let [start, stop] = ends(segment);
            if (at - start).abs() <= close {
                Some(false)
            } else {
                ((at - stop).abs() <= close).then_some(true)
            }
        };
        Some(Corner { at_end: [end(slave, s)?, end(master, m)?], width })
    }
}

/// Way from a joint, over the size of its neighbourhood, along which contact sets in.
const SETS_IN: (f64, f64) = (1.0, 1.5);

/// Part of an element by which joints at the ends of strands may lie inside of them.
const NUDGED: f64 = 1e-5;

/// All lines and contacts of a model.
#[derive(Clone, Debug, Default)]
pub struct Contacts {
    /// Lines by number, element by element.
    pub lines: Vec<Vec<Segment>>,
    /// Pairs that may touch.
    pub list: Vec<Contact>,
    /// Largest radius [m].
    pub radius: f64,
    /// Smallest radius of a line [m].
    pub thinnest: f64,
    /// Energy below which a gain is rounding [J].
    pub energy_floor: f64,
    /// Numbers of the contacts by their lines, the lower number first.
    by_lines: HashMap<(usize, usize), usize>,
    /// Highest angular frequency of a line on its contact, `sqrt(k/(rho A))` [1/s].
    pub frequency: f64,
    /// Contacts of bodies other than lines.
    pub probes: Probes,
}

impl Contacts {
    /// Reads the contacts of a document.
    ///
    /// # Errors
    /// [`ModelError`] naming the contact that is wrong.
    pub(crate) fn of_spec(
        spec: &ModelSpec,
        arrays: Arrays<'_>,
        map: &DofMap,
        structure: &mut Structure,
    ) -> Result<Self, ModelError> {
        let mut this = Self::default();
        let mut numbers = HashMap::new();
        for contact in &spec.contacts {
            let place = format!("contact '{}'", contact.name);
            let mut line = |given: usize| -> Result<usize, ModelError> {
                if let Some(&number) = numbers.get(&given) {
                    return Ok(number);
                }
                this.lines.push(line_of(spec, arrays, map, given, &place)?);
                numbers.insert(given, this.lines.len() - 1);
                Ok(this.lines.len() - 1)
            };
            let slave = line(contact.slave)?;
            let master = match &contact.master {
                MasterSpec::Line { line: other } => Master::Line(line(*other)?),
                MasterSpec::Shape { origin, axes, shape } => Master::Shape(Box::new(Placed {
                    shape: shape_of(shape, arrays, &place)?,
                    origin: Vector3::from(*origin),
                    axes: Matrix3::from_columns(&axes.map(Vector3::from)),
                })),
            };
            let lines = match contact.master {
                MasterSpec::Line { line } => vec![contact.slave, line],
                MasterSpec::Shape { .. } => vec![contact.slave],
            };
            for line in lines {
                let least = mass_per_length(spec, arrays, line, &place)?;
                this.frequency = this.frequency.max((contact.stiffness / least).sqrt());
            }
            let apart = arrays.get(&contact.apart, &place)?;
            let mut apart: Vec<[f64; 3]> =
                (0..apart.len() / 3).map(|i| crate::document::row(apart, i)).collect();
            apart.sort_unstable_by(|a, b| a[0].total_cmp(&b[0]));
            let reach = apart.iter().fold(0.0, |most, a| f64::max(most, a[2])) * SETS_IN.1;
            if let Master::Line(other) = master {
                this.by_lines.insert((slave.min(other), slave.max(other)), this.list.len());
            }
            this.list.push(Contact {
                name: contact.name.clone(),
                slave,
                master,
                laws: laws_of(
                    contact.stiffness,
                    contact.ramp,
                    contact.damping,
                    &contact.friction,
                    &place,
                )?,
                window: contact.window,
                apart,
                reach,
            });
        }
        let radii = this.lines.iter().flatten().map(|s| s.radius);
        (this.thinnest, this.radius) =
            radii.fold((f64::INFINITY, 0.0), |(low, high), r| (low.min(r), f64::max(high, r)));
        this.probes = Probes::of_spec(spec, arrays, map, structure)?;
        this.radius = this.radius.max(this.probes.radius);
        this.frequency = this.frequency.max(this.probes.frequency);
        Ok(this)
    }

    /// Number of the contact of two lines, if they may touch.
    #[must_use]
    pub fn of_lines(&self, a: usize, b: usize) -> Option<usize> {
        self.by_lines.get(&(a.min(b), a.max(b))).copied()
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.list.is_empty() && self.probes.is_empty()
    }
}

pub(crate) fn laws_of(
    stiffness: f64,
    ramp: f64,
    damping: f64,
    friction: &Option<FrictionSpec>,
    place: &str,
) -> Result<Laws, ModelError> {
    let numbers = [stiffness, ramp, damping];
    if let Some(&value) = numbers.iter().find(|x| !(x.is_finite() && **x >= 0.0)) {
        let allowed = "stiffness, ramp and damping of zero or more";
        return Err(ModelError::Value { place: place.to_owned(), value, allowed });
    }
    let friction = friction.as_ref().map(|friction| match *friction {
        FrictionSpec::Lugre { mu_s, mu_d, v_s, alpha, sigma_0, sigma_1, sigma_2, v_d, scaled } => {
            Friction::LuGre(LuGre {
                mu_s,
                mu_d,
                v_s,
                alpha,
                sigma_0,
                sigma_1,
                sigma_2,
                scaled,
                v_d,
            })
        }
        FrictionSpec::Coulomb { mu, sigma_0, sigma_1 } => {
            Friction::Coulomb(Coulomb { mu, sigma_0, sigma_1 })
        }
    });
    let normal = Normal { k: stiffness, d_0: ramp, c: damping };
    Ok(Laws { normal, friction })
}
