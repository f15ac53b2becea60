//! Cubic pieces of a centre line, and the nearest point of one.

use nalgebra::Vector3;
use pliant_math::hermite;

/// A cubic piece `r(xi) = sum_k N_k(xi) x_k` over position and slope at both ends, `x = (r_i, t_i, r_j, t_j)`, with
/// `t = dr/ds` by the stress-free length, and a round section.
#[derive(Clone, Copy, Debug)]
pub struct Piece {
    x: [Vector3<f64>; 4],
    length: f64,
    radius: f64,
    /// `r = c_0 + c_1 xi + c_2 xi^2 + c_3 xi^3`.
    c: [Vector3<f64>; 4],
    /// Coefficients of `(r - c_0).r_xi` by powers of xi from the first on.
    own: [f64; 5],
    speed: f64,
    bend: f64,
}

/// Turns of Newton's iteration before bisection alone would have reached rounding.
const ITERATIONS: usize = 60;
/// Halvings after which two feet are one.
const DEPTH: usize = 40;

/// Part of a curvature, and of one over a length, by which its bound may exceed it.
const SHARP: f64 = 1e-6;
/// Length of a part of a piece in xi whose slope cannot be told from a vanishing one.
const CUSP: f64 = 1e-9;

impl Piece {
    /// The piece over `x`, of stress-free length `length` [m] and radius `radius` [m].
    #[must_use]
    pub fn new(x: [Vector3<f64>; 4], length: f64, radius: f64) -> Self {
        let chord = x[2] - x[0];
        let (t, u) = (x[1] * length, x[3] * length);
        let c = [x[0], t, chord * 3.0 - t * 2.0 - u, t + u - chord * 2.0];
        let own = [
            c[1].dot(&c[1]),
            3.0 * c[1].dot(&c[2]),
            2.0 * c[2].dot(&c[2]) + 4.0 * c[1].dot(&c[3]),
            5.0 * c[2].dot(&c[3]),
            3.0 * c[3].dot(&c[3]),
        ];
        let mut this = Self { x, length, radius, c, own, speed: 0.0, bend: 0.0 };
        let b = this.control();
        let legs = [b[1] - b[0], b[2] - b[1], b[3] - b[2]];
        this.speed = legs.iter().map(|l| 3.0 * l.norm()).fold(0.0, f64::max);
        this.bend = (0..2).map(|i| 6.0 * (legs[i + 1] - legs[i]).norm()).fold(0.0, f64::max);
        this
    }

    /// Positions and slopes at the ends.
    #[must_use]
    pub fn vectors(&self) -> &[Vector3<f64>; 4] {
        &self.x
    }

    /// Stress-free length l [m].
    #[must_use]
    pub fn length(&self) -> f64 {
        self.length
    }

    /// Radius R of the round line around it [m].
    #[must_use]
    pub fn radius(&self) -> f64 {
        self.radius
    }

    /// `r(xi)`.
    #[must_use]
    pub fn at(&self, xi: f64) -> Vector3<f64> {
        let c = &self.c;
        c[0] + (c[1] + (c[2] + c[3] * xi) * xi) * xi
    }

    /// `dr/dxi`.
    #[must_use]
    pub fn slope(&self, xi: f64) -> Vector3<f64> {
        let c = &self.c;
        c[1] + (c[2] * 2.0 + c[3] * (3.0 * xi)) * xi
    }

    /// `d^2r/dxi^2`.
    #[must_use]
    pub fn bend(&self, xi: f64) -> Vector3<f64> {
        self.c[2] * 2.0 + self.c[3] * (6.0 * xi)
    }

    /// `N(xi)`.
    #[must_use]
    pub fn weights(&self, xi: f64) -> [f64; 4] {
        hermite::shape(xi, self.length)
    }

    /// `dN/dxi`.
    #[must_use]
    pub fn weight_slopes(&self, xi: f64) -> [f64; 4] {
        hermite::shape_derivative(xi, self.length).map(|w| w * self.length)
    }

    /// Bernstein control points: the piece lies in their convex hull.
    #[must_use]
    pub fn control(&self) -> [Vector3<f64>; 4] {
        let [a, t, b, u] = self.x;
        let third = self.length / 3.0;
        [a, a + t * third, b - u * third, b]
    }

    /// Control points of the part between two xi.
    #[must_use]
    pub fn part(&self, a: f64, b: f64) -> [Vector3<f64>; 4] {
        let third = (b - a) / 3.0;
        let (first, last) = (self.at(a), self.at(b));
        [first, first + self.slope(a) * third, last - self.slope(b) * third, last]
    }

    /// Bound of `|dr/dxi|`.
    #[must_use]
    pub fn speed_bound(&self) -> f64 {
        self.speed
    }

    /// Bound of `|d^2r/dxi^2|`.
    #[must_use]
    pub fn bend_bound(&self) -> f64 {
        self.bend
    }

    /// Whether it turns by less than a right angle and never as sharply as `reach`: then the planes normal to its ends
    /// part the points within `reach` whose foot lies on it from those whose foot lies on its neighbours.
    #[must_use]
    pub fn is_tame(&self, reach: f64) -> bool {
        let b = self.control();
        let least = [self.c[1], self.slope(1.0)].map(|t| {
            let least =
                (0..3).map(|i| 3.0 * (b[i + 1] - b[i]).dot(&t)).fold(f64::INFINITY, f64::min);
            least / t.norm()
        });
        // Bounds of the speed from below.
        let least = least[0].min(least[1]);
        least > 0.0 && self.bend * reach < least * least
    }

    /// A bound of its curvature [1/m], where it turns by less than a right angle: then no two of its points face each
    /// other, and every point nearer than the radius of curvature has one foot.
    #[must_use]
    pub fn curvature_bound(&self) -> Option<f64> {
        let b = self.control();
        let legs = [b[1] - b[0], b[2] - b[1], b[3] - b[2]];
        // Slopes are mixtures of the legs: so are the products of any two of them.
        let pairs = [(0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2)];
        let products = pairs.map(|(i, j): (usize, usize)| 9.0 * legs[i].dot(&legs[j]));
        let least = products.into_iter().fold(f64::INFINITY, f64::min);
        (least > 0.0).then(|| self.bend / least)
    }

    /// Its largest curvature, or a millionth of it and of one over the length more [1/m]; infinite where it has a cusp.
    #[must_use]
    pub fn sharpest(&self) -> f64 {
        let turn = |xi: f64| self.slope(xi).cross(&self.bend(xi));
        let curvature = |xi: f64| turn(xi).norm() / self.slope(xi).norm().powi(3);
        let more = |found: f64| (1.0 + SHARP) * found + SHARP / self.speed;
        let mut found = curvature(0.0).max(curvature(1.0));
        let mut open = vec![(0.0, 1.0)];
        while let Some((low, high)) = open.pop() {
            let middle = 0.5 * (low + high);
            found = found.max(curvature(middle));
            let b = self.part(low, high);
            let legs = [0, 1, 2].map(|i| (b[i + 1] - b[i]) * (3.0 / (high - low)));
            let products = [(0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2)];
            let least = products.map(|(i, j): (usize, usize)| legs[i].dot(&legs[j]));
            let least = least.into_iter().fold(f64::INFINITY, f64::min).max(0.0);
            // Slope times bend is of second degree, and in the hull of its control points.
            let (first, last) = (turn(low), turn(high));
            let between = turn(middle) * 2.0 - (first + last) * 0.5;
            let most = [first, between, last].map(|w| w.norm()).into_iter().fold(0.0, f64::max);
            let bound = most / least.powf(1.5);
            if most > 0.0 && bound > more(found) {
                if high - low < CUSP {
                    return f64::INFINITY;
                }
                open.extend([(low, middle), (middle, high)]);
            }
        }
        more(found)
    }

    /// The xi in [0, 1] where the distance to `q` is least.
    ///
    /// `phi = (r - q).r_xi` is a polynomial of degree five: it has at most as many roots as its Bernstein coefficients
    /// change sign, and the distance is least at a root where it rises or at an end. None is missed.
    #[must_use]
    pub fn nearest(&self, q: Vector3<f64>) -> f64 {
        let w = q - self.c[0];
        let [p_1, p_2, p_3, p_4, p_5] = self.own;
        let phi = Quintic([
            -self.c[1].dot(&w),
            p_1 - 2.0 * self.c[2].dot(&w),
            p_2 - 3.0 * self.c[3].dot(&w),
            p_3,
            p_4,
            p_5,
        ]);
        let b = phi.bernstein();
        match changes(&b) {
            0 => {
                if b.iter().sum::<f64>() >= 0.0 {
                    0.0
                } else {
                    1.0
                }
            }
            1 if b[0] < 0.0 => phi.rise(0.0, 1.0),
            _ => self.nearest_of(&phi, &b, q),
        }
    }

    /// The nearest of both ends and all places where phi rises through zero.
    fn nearest_of(&self, phi: &Quintic, b: &[f64; 6], q: Vector3<f64>) -> f64 {
        let mut best = (f64::INFINITY, 0.0);
        let mut try_at = |xi: f64| {
            let distance = (self.at(xi) - q).norm_squared();
            if distance < best.0 {
                best = (distance, xi);
            }
        };
        try_at(0.0);
        try_at(1.0);
        phi.rises(b, 0.0, 1.0, DEPTH, &mut try_at);
        best.1
    }
}

/// A polynomial of degree five by its coefficients of powers.
struct Quintic([f64; 6]);

impl Quintic {
    fn value_and_slope(&self, x: f64) -> (f64, f64) {
        let (mut value, mut slope) = (0.0, 0.0);
        for c in self.0.iter().rev() {
            slope = slope * x + value;
            value = value * x + c;
        }
        (value, slope)
    }

    fn bernstein(&self) -> [f64; 6] {
        /// `C(j, i)/C(5, i)`.
        const PART: [[f64; 6]; 6] = [
            [1.0, 0.0, 0.0, 0.0, 0.0, 0.0],
            [1.0, 0.2, 0.0, 0.0, 0.0, 0.0],
            [1.0, 0.4, 0.1, 0.0, 0.0, 0.0],
            [1.0, 0.6, 0.3, 0.1, 0.0, 0.0],
            [1.0, 0.8, 0.6, 0.4, 0.2, 0.0],
            [1.0; 6],
        ];
        PART.map(|part| (0..6).map(|i| part[i] * self.0[i]).sum())
    }

    /// The root between a place where it is below zero and one where it is above: Newton's method in a bracket.
    fn rise(&self, mut low: f64, mut high: f64) -> f64 {
        let mut x = 0.5 * (low + high);
        for _ in 0..ITERATIONS {
            let (value, slope) = self.value_and_slope(x);
            let next = x - value / slope;
            if (next - x).abs() <= 2.0 * f64::EPSILON {
                return x;
            }
            if value < 0.0 {
                low = x;
            } else {
                high = x;
            }
            x = if next > low && next < high { next } else { 0.5 * (low + high) };
        }
        x
    }

    /// Calls `found` with all places in [low, high] where it rises through zero; `b` are its coefficients there.
    fn rises(&self, b: &[f64; 6], low: f64, high: f64, depth: usize, found: &mut impl FnMut(f64)) {
        match changes(b) {
            0 => {}
            1 if b[0] < 0.0 && b[5] > 0.0 => found(self.rise(low, high)),
            1 if b[0] > 0.0 && b[5] < 0.0 => {}
            _ if depth == 0 => found(0.5 * (low + high)),
            _ => {
                let (left, right) = halves(b);
                let middle = 0.5 * (low + high);
                self.rises(&left, low, middle, depth - 1, found);
                if left[5] == 0.0 {
                    found(middle);
                }
                self.rises(&right, middle, high, depth - 1, found);
            }
        }
    }
}

/// How often coefficients change sign.
fn changes<const N: usize>(b: &[f64; N]) -> usize {
    let mut last = 0.0;
    let mut count = 0;
    for &c in b {
        if c != 0.0 {
            if last * c < 0.0 {
                count += 1;
            }
            last = c;
        }
    }
    count
}

/// Bernstein coefficients on both halves of an interval, after de Casteljau.
fn halves<const N: usize>(b: &[f64; N]) -> ([f64; N], [f64; N]) {
    let (mut left, mut right) = (*b, *b);
    for k in 1..N {
        for i in 0..N - k {
            right[i] = 0.5 * (right[i] + right[i + 1]);
        }
        left[k] = right[0];
    }
    (left, right)
}

/// Roots in (0, 1) of the cubic with these Bernstein coefficients, in order; roots without a change of sign do not
/// count.
#[must_use]
pub fn sign_changes(coefficients: [f64; 4]) -> Vec<f64> {
    let mut roots = Vec::new();
    isolate(coefficients, 0.0, 1.0, &mut roots, 50);
    roots
}

/// Values of the polynomial are bounded by its coefficients, and it has at most as many roots as these change sign.
fn isolate(b: [f64; 4], low: f64, high: f64, roots: &mut Vec<f64>, depth: usize) {
    match changes(&b) {
        0 => {}
        1 if b[0] * b[3] < 0.0 => {
            let value = |x: f64| {
                let y = 1.0 - x;
                y * y * y * b[0]
                    + 3.0 * y * y * x * b[1]
                    + 3.0 * y * x * x * b[2]
                    + x * x * x * b[3]
            };
            roots.push(low + (high - low) * root(value, (0.0, b[0]), (1.0, b[3]), 1e-15));
        }
        _ if depth == 0 => {}
        _ => {
            let (left, right) = halves(&b);
            let half = 0.5 * (low + high);
            isolate(left, low, half, roots, depth - 1);
            if left[3] == 0.0 && b[0] * b[3] < 0.0 && changes(&left) == 0 {
                roots.push(half);
            }
            isolate(right, half, high, roots, depth - 1);
        }
    }
}

/// The root of a function between two places where it has opposite signs, (place, value), up to `tolerance`:
/// interpolation by the Illinois rule, and halving where it is slow.
#[must_use]
pub fn root(
    mut value: impl FnMut(f64) -> f64,
    (mut a, mut f_a): (f64, f64),
    (mut b, mut f_b): (f64, f64),
    tolerance: f64,
) -> f64 {
    for turn in 0..100 {
        if f_a == 0.0 {
            return a;
        }
        if f_b == 0.0 || (b - a).abs() <= tolerance {
            return b;
        }
        let slow = turn % 8 == 7;
        let x = if slow { 0.5 * (a + b) } else { b - f_b * (b - a) / (f_b - f_a) };
        let f = value(x);
        if f * f_b < 0.0 {
            (a, f_a) = (b, f_b);
        } else {
            f_a *= 0.5;
        }
        (b, f_b) = (x, f);
        if slow {
            // Illinois' halving is no value of the function: forget it.
            f_a = value(a);
        }
    }
    b
}
