//! Zones: where along a slave piece the gap is below zero. None is missed.
//!
//! The distance to any set changes no faster than the point moves, so on an interval whose image is at most `ell`
//! long `min g >= (g_a + g_b - ell)/2`; and it is semiconcave, `g'' <= M` with `M = v^2/d + |r''|`, so that
//! `min g >= min(g_a, g_b) - M (b - a)^2/8`. Intervals that can be neither dropped nor accepted are halved.

use crate::curve::root;

/// What bounds the gap along a slave piece.
#[derive(Clone, Copy, Debug)]
pub struct Bounds {
    /// Bound v of the speed `|dr/dxi|` of the slave [m].
    pub speed: f64,
    /// Bound of `|d^2r/dxi^2|` of the slave [m].
    pub bend: f64,
    /// Distance from the gap's zero to where the distance function has its kinks: the sum of the radii between lines,
    /// infinite before a plane [m].
    pub reach: f64,
    /// Length below which nothing is resolved further [m].
    pub floor: f64,
    /// Length below which a single change of sign is believed to be one [m].
    pub single: f64,
}

/// Place of a zone's end among the xi [1].
const END: f64 = 1e-13;

/// The zones in [a, b], in order: intervals where `gap` is below zero.
#[must_use]
pub fn zones(
    mut gap: impl FnMut(f64) -> f64,
    (a, b): (f64, f64),
    bounds: &Bounds,
) -> Vec<(f64, f64)> {
    let mut found = Vec::new();
    let (g_a, g_b) = (gap(a), gap(b));
    search(&mut gap, (a, g_a), (b, g_b), bounds, &mut found);
    found
}

fn search(
    gap: &mut impl FnMut(f64) -> f64,
    (a, g_a): (f64, f64),
    (b, g_b): (f64, f64),
    bounds: &Bounds,
    found: &mut Vec<(f64, f64)>,
) {
    let ell = bounds.speed * (b - a);
    let mean = 0.5 * (g_a + g_b);
    let (mut least, mut most) = (mean - 0.5 * ell, mean + 0.5 * ell);
    let distance = least + bounds.reach;
    if distance > 0.0 {
        let m = bounds.speed * bounds.speed / distance + bounds.bend;
        let dip = m * (b - a) * (b - a) / 8.0;
        least = least.max(g_a.min(g_b) - dip);
        most = most.min(g_a.max(g_b) + dip);
    }
    if least > 0.0 {
        return;
    }
    if most < 0.0 {
        return add(found, a, b);
    }
    if ell < bounds.single && g_a * g_b < 0.0 {
        let end = root(&mut *gap, (a, g_a), (b, g_b), END);
        return if g_a < 0.0 { add(found, a, end) } else { add(found, end, b) };
    }
    if ell < bounds.floor {
        if g_a < 0.0 || g_b < 0.0 {
            add(found, a, b);
        }
        return;
    }
    let c = 0.5 * (a + b);
    let g_c = gap(c);
    search(gap, (a, g_a), (c, g_c), bounds, found);
    search(gap, (c, g_c), (b, g_b), bounds, found);
}

fn add(found: &mut Vec<(f64, f64)>, a: f64, b: f64) {
    match found.last_mut() {
        Some(last) if a <= last.1 => last.1 = b,
        _ => found.push((a, b)),
    }
}
