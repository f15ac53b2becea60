//! A force that moves along a cable: at the arc length s(t) of the stress-free line it acts through the shape functions
//! there, so that it passes from element to element without a jump of force or of its rate. Off the cable there is none.

use super::Load;
use crate::point::Interpolation;
use crate::signal::{Moment, Value};

/// A force fixed in space that moves along a cable.
#[derive(Clone, Debug)]
pub struct MovingForce {
    /// Arc length over time [m]. In statics constants are not scaled.
    position: Value,
    /// Arc length at which each element ends [m].
    ends: Vec<f64>,
    /// Position in the element of each: by functions of xi.
    nodes: Vec<[usize; 4]>,
}

impl MovingForce {
    /// A force at `position` of elements with these lengths, whose nodes' coordinates (r1, t1, r2, t2) begin at `nodes`.
    #[must_use]
    pub fn new(position: Value, lengths: &[f64], nodes: Vec<[usize; 4]>) -> Self {
        let mut end = 0.0;
        let ends = lengths.iter().map(|l| {
            end += l;
            end
        });
        Self { position, ends: ends.collect(), nodes }
    }

    fn place(&self, now: Moment<'_>) -> Option<Interpolation> {
        let s = self.position.at(Moment { constants: 1.0, ..now })[0];
        let last = *self.ends.last()?;
        if !(0.0..=last).contains(&s) {
            return None;
        }
        let e = self.ends.partition_point(|&end| end <= s).min(self.ends.len() - 1);
        let start = if e == 0 { 0.0 } else { self.ends[e - 1] };
        let length = self.ends[e] - start;
        let weights = pliant_math::hermite::shape((s - start) / length, length);
        Some(Interpolation::weighted(self.nodes[e].into_iter().zip(weights)))
    }
}

impl Load for MovingForce {
    fn add_force(
        &self,
        now: Moment<'_>,
        value: [f64; 3],
        _q: &[f64],
        factor: f64,
        force: &mut [f64],
    ) {
        if let Some(r) = self.place(now) {
            r.add_force(value.map(|f| factor * f), force);
        }
    }

    fn next_break(&self, t: f64) -> Option<f64> {
        self.position.next_break(t)
    }
}
