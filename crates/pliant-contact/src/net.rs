//! Faces of surfaces as Bezier nets, and the point of one that is nearest to a place.
//!
//! A face is a bicubic patch over the unit square or a cubic one over the unit triangle: every surface element of a
//! model is one, or three of them (pieces of lower degree are raised). The patch lies in the hull of its control
//! points. The nearest point is where the gradient of `|p - r|^2/2` vanishes, or points out of the domain at an edge or
//! a corner: Newton's iteration with active bounds.

use crate::broad_phase::Box3;
use crate::curve::Piece;
use crate::zones::{Convexity, Sample};
use nalgebra::{Matrix2, Vector2, Vector3};

/// Control points of a patch, at most.
pub const POINTS: usize = 16;

/// What a patch is a map of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    /// The unit square: 4 x 4 control points, those along v follow each other.
    Square,
    /// The triangle `u, v >= 0`, `u + v <= 1`: 10 control points by exponents of (1 - u - v, u, v), in the order of
    /// [`EXPONENTS`].
    Triangle,
}

/// Exponents of the control points of a triangle.
pub const EXPONENTS: [[usize; 3]; 10] = [
    [3, 0, 0],
    [2, 1, 0],
    [2, 0, 1],
    [1, 2, 0],
    [1, 1, 1],
    [1, 0, 2],
    [0, 3, 0],
    [0, 2, 1],
    [0, 1, 2],
    [0, 0, 3],
];

/// Values of all basis functions and their derivatives: `[B, B_u, B_v, B_uu, B_uv, B_vv]`.
pub type Basis = [[f64; POINTS]; 6];

impl Form {
    /// Number of control points.
    #[must_use]
    pub fn points(self) -> usize {
        match self {
            Self::Square => 16,
            Self::Triangle => 10,
        }
    }

    /// Parameters that a control point stands for.
    #[must_use]
    pub fn place(self, point: usize) -> [f64; 2] {
        match self {
            Self::Square => [(point / 4) as f64 / 3.0, (point % 4) as f64 / 3.0],
            Self::Triangle => {
                let [_, j, k] = EXPONENTS[point];
                [j as f64 / 3.0, k as f64 / 3.0]
            }
        }
    }

    /// Bounds `n.x >= c` of the domain, by the normals n and c; the sides follow each other around it.
    fn bounds(self) -> &'static [([f64; 2], f64)] {
        match self {
            Self::Square => {
                &[([0.0, 1.0], 0.0), ([-1.0, 0.0], -1.0), ([0.0, -1.0], -1.0), ([1.0, 0.0], 0.0)]
            }
            Self::Triangle => &[([0.0, 1.0], 0.0), ([-1.0, -1.0], -1.0), ([1.0, 0.0], 0.0)],
        }
    }

    /// The basis functions at a place.
    #[must_use]
    pub fn basis(self, [u, v]: [f64; 2]) -> Basis {
        let mut out = [[0.0; POINTS]; 6];
        match self {
            Self::Square => {
                let (a, b) = (bernstein(u), bernstein(v));
                for i in 0..4 {
                    for j in 0..4 {
                        let k = 4 * i + j;
                        out[0][k] = a[0][i] * b[0][j];
                        out[1][k] = a[1][i] * b[0][j];
                        out[2][k] = a[0][i] * b[1][j];
                        out[3][k] = a[2][i] * b[0][j];
                        out[4][k] = a[1][i] * b[1][j];
                        out[5][k] = a[0][i] * b[2][j];
                    }
                }
            }
            Self::Triangle => {
                let power = |x: f64| {
                    [
                        [1.0, x, x * x, x * x * x],
                        [0.0, 1.0, 2.0 * x, 3.0 * x * x],
                        [0.0, 0.0, 2.0, 6.0 * x],
                    ]
                };
                let x = [1.0 - u - v, u, v].map(power);
                for (k, e) in EXPONENTS.iter().enumerate() {
                    const FACTORIAL: [f64; 4] = [1.0, 1.0, 2.0, 6.0];
                    let c = 6.0 / e.map(|e| FACTORIAL[e]).iter().product::<f64>();
                    // By how many derivatives of each of the three coordinates.
                    let d = |n: [usize; 3]| c * (0..3).map(|i| x[i][n[i]][e[i]]).product::<f64>();
                    let (w, by_u, by_v) = (d([1, 0, 0]), d([0, 1, 0]), d([0, 0, 1]));
                    let (ww, wu, wv) = (d([2, 0, 0]), d([1, 1, 0]), d([1, 0, 1]));
                    out[0][k] = d([0, 0, 0]);
                    out[1][k] = by_u - w;
                    out[2][k] = by_v - w;
                    out[3][k] = d([0, 2, 0]) - 2.0 * wu + ww;
                    out[4][k] = d([0, 1, 1]) - wu - wv + ww;
                    out[5][k] = d([0, 0, 2]) - 2.0 * wv + ww;
                }
            }
        }
        out
    }
}

/// Cubic Bernstein polynomials and two derivatives.
fn bernstein(x: f64) -> [[f64; 4]; 3] {
    let y = 1.0 - x;
    [
        [y * y * y, 3.0 * x * y * y, 3.0 * x * x * y, x * x * x],
        [-3.0 * y * y, 3.0 * y * (y - 2.0 * x), 3.0 * x * (2.0 * y - x), 3.0 * x * x],
        [6.0 * y, 6.0 * (x - 2.0 * y), 6.0 * (y - 2.0 * x), 6.0 * x],
    ]
}

/// Position and derivatives of a patch at a place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Jet {
    /// r.
    pub r: Vector3<f64>,
    /// r_u, r_v.
    pub slopes: [Vector3<f64>; 2],
    /// r_uu, r_uv, r_vv.
    pub bends: [Vector3<f64>; 3],
}

impl Jet {
    /// Unit normal `r_u x r_v`.
    #[must_use]
    pub fn normal(&self) -> Vector3<f64> {
        let n = self.slopes[0].cross(&self.slopes[1]);
        n.try_normalize(0.0).unwrap_or_else(Vector3::z)
    }

    /// `r_ab`.
    #[must_use]
    pub fn bend(&self, a: usize, b: usize) -> Vector3<f64> {
        self.bends[a + b]
    }

    /// Whether the surface bends there about as sharply towards `p` as around a centre at it, where distances from it
    /// hardly change: then it may be near p more than once.
    #[must_use]
    pub fn is_sharp(&self, p: Vector3<f64>) -> bool {
        let d = p - self.r;
        let metric = Matrix2::from_fn(|a, b| self.slopes[a].dot(&self.slopes[b]));
        let bend = Matrix2::from_fn(|a, b| d.dot(&self.bend(a, b)));
        // Its eigenvalues are curvatures times the distance.
        let Some(turn) = metric.try_inverse().map(|inverse| inverse * bend) else { return false };
        let mean = 0.5 * turn.trace();
        mean + (mean * mean - turn.determinant()).max(0.0).sqrt() > SHARP
    }
}

/// Where the nearest point may slide.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Feature {
    /// It lies inside, or looks straight up from a side.
    Inside,
    /// Along a side, by its number.
    Side(usize),
    /// It is a corner, where this side and the one before meet.
    Corner(usize),
}

/// The nearest point of a patch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Nearest {
    /// Parameters (u, v).
    pub at: [f64; 2],
    /// Where it may slide.
    pub feature: Feature,
    /// There.
    pub jet: Jet,
    /// Square of the distance [m^2].
    pub square: f64,
}

/// A patch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Net {
    form: Form,
    points: [Vector3<f64>; POINTS],
}

/// Control points of a derivative, as many as it has.
#[derive(Clone, Copy, Debug, Default)]
struct Points {
    points: [Vector3<f64>; 12],
    count: usize,
}

impl Points {
    fn push(&mut self, point: Vector3<f64>) {
        self.points[self.count] = point;
        self.count += 1;
    }

    fn mean(&self) -> Vector3<f64> {
        self.points[..self.count].iter().sum::<Vector3<f64>>() / self.count as f64
    }

    fn farthest(&self, from: Vector3<f64>) -> f64 {
        let far = self.points[..self.count].iter().map(|p| (p - from).norm_squared());
        far.fold(0.0, f64::max).sqrt()
    }
}

/// Points of a sharply bent net from which its nearest one is sought, and the distance over the radius of curvature from
/// which on it counts as one.
const STARTS: usize = 4;
const SHARP: f64 = 0.5;
/// Turns of the iteration; it takes three to six.
const TURNS: usize = 60;
/// Step in the parameters whose square is rounding.
const LAST: f64 = 1e-7;
/// Distance from a bound that is none.
const ON: f64 = 1e-12;
/// Cosine of what counts as a right angle at a side.
const UPRIGHT: f64 = 1e-9;

/// Direction along a side in the parameters.
#[must_use]
pub fn along(form: Form, side: usize) -> [f64; 2] {
    let ([x, y], _) = form.bounds()[side];
    [y, -x]
}

impl Net {
    /// The patch of a form with these control points.
    #[must_use]
    pub fn new(form: Form, points: [Vector3<f64>; POINTS]) -> Self {
        Self { form, points }
    }

    /// What it is a map of.
    #[must_use]
    pub fn form(&self) -> Form {
        self.form
    }

    /// Control points: the patch lies in their hull.
    #[must_use]
    pub fn points(&self) -> &[Vector3<f64>] {
        &self.points[..self.form.points()]
    }

    /// A box that holds it.
    #[must_use]
    pub fn hull(&self, margin: f64) -> Box3 {
        hull(self.points(), margin)
    }

    /// Control points of its first derivatives over 3, by u and by v, and of its second ones, by uu, uv and vv.
    fn differences(&self) -> ([Points; 2], [Points; 3]) {
        let p = &self.points;
        let (mut first, mut second) = ([Points::default(); 2], [Points::default(); 3]);
        match self.form {
            Form::Square => {
                let at = |i: usize, j: usize| p[4 * i + j];
                let bend =
                    |a: Vector3<f64>, b: Vector3<f64>, c: Vector3<f64>| (a - b * 2.0 + c) * 6.0;
                for i in 0..4 {
                    for j in 0..3 {
                        first[0].push(at(j + 1, i) - at(j, i));
                        first[1].push(at(i, j + 1) - at(i, j));
                    }
                    for j in 0..2 {
                        second[0].push(bend(at(j, i), at(j + 1, i), at(j + 2, i)));
                        second[2].push(bend(at(i, j), at(i, j + 1), at(i, j + 2)));
                    }
                }
                for i in 0..3 {
                    for j in 0..3 {
                        let twist = at(i + 1, j + 1) - at(i + 1, j) - at(i, j + 1) + at(i, j);
                        second[1].push(twist * 9.0);
                    }
                }
            }
            Form::Triangle => {
                // Points by their exponents of u and v; those of 1 - u - v follow.
                let at = |j: usize, k: usize| p[(j + k) * (j + k + 1) / 2 + k];
                for j in 0..3 {
                    for k in 0..3 - j {
                        first[0].push(at(j + 1, k) - at(j, k));
                        first[1].push(at(j, k + 1) - at(j, k));
                        if j + k < 2 {
                            let o = at(j, k);
                            let (u, v) = (at(j + 1, k), at(j, k + 1));
                            second[0].push((at(j + 2, k) - u * 2.0 + o) * 6.0);
                            second[1].push((at(j + 1, k + 1) - u - v + o) * 6.0);
                            second[2].push((at(j, k + 2) - v * 2.0 + o) * 6.0);
                        }
                    }
                }
            }
        }
        (first, second)
    }

    /// A kappa [1/m] such that every place nearer than `1/kappa` has one nearest point, where one is seen: then the Hessian
    /// of the distance d is nowhere below `-kappa/(1 - kappa d)`.
    ///
    /// In parameters stretched so that the mean slopes are unit vectors, of which `c` is the cosine, any two points
    /// `|delta|` apart there are `sigma |delta|` apart at least, `sigma = sqrt(1 - |c|) - (what slopes differ by from
    /// their means)`, and either is `beta |delta|^2/2` at most from what is tangent at the other, beta the largest bend:
    /// the reach after Federer (1959, theorem 4.18) is `sigma^2/beta`.
    #[must_use]
    pub fn curvature_bound(&self) -> Option<f64> {
        let (first, second) = self.differences();
        let means = [0, 1].map(|a| first[a].mean() * 3.0);
        let sizes = means.map(|mean| mean.norm());
        let apart = [0, 1].map(|a| first[a].farthest(means[a] / 3.0) * 3.0 / sizes[a]);
        let c = means[0].dot(&means[1]) / (sizes[0] * sizes[1]);
        let sigma = (1.0 - c.abs()).max(0.0).sqrt() - apart[0].hypot(apart[1]);
        let bend = |k: usize, size: f64| second[k].farthest(Vector3::zeros()) / size;
        let [u, v] = sizes;
        let beta = bend(0, u * u).max(bend(2, v * v)) + bend(1, u * v);
        (sigma > 0.0).then(|| beta / (sigma * sigma))
    }

    /// Where along a slave piece the distance is below `reach`, in order; none where the net bends too sharply for that
    /// to be found this way.
    #[must_use]
    pub fn zones(&self, slave: &Piece, reach: f64) -> Option<Vec<(f64, f64)>> {
        let mut found = Vec::new();
        let near = self.hull(reach);
        if near.meets(&hull(&slave.control(), 0.0)) {
            let facing = Facing { net: self, near, kappa: self.curvature_bound()?, reach };
            facing.zones(slave, (0.0, 1.0), HALVINGS, &mut found)?;
        }
        Some(found)
    }

    /// Position and derivatives at a place.
    #[must_use]
    pub fn jet(&self, at: [f64; 2]) -> Jet {
        if self.form == Form::Square {
            return self.square_jet(at);
        }
        let basis = self.form.basis(at);
        let sum = |k: usize| -> Vector3<f64> {
            self.points().iter().zip(&basis[k]).map(|(p, w)| p * *w).sum()
        };
        Jet { r: sum(0), slopes: [sum(1), sum(2)], bends: [sum(3), sum(4), sum(5)] }
    }

    /// The same of a square: sums along v, then along u.
    fn square_jet(&self, [u, v]: [f64; 2]) -> Jet {
        let (a, b) = (bernstein(u), bernstein(v));
        let mut rows = [[Vector3::zeros(); 4]; 3];
        for (d, row) in rows.iter_mut().enumerate() {
            for (i, sum) in row.iter_mut().enumerate() {
                let p = &self.points[4 * i..4 * i + 4];
                *sum = p[0] * b[d][0] + p[1] * b[d][1] + p[2] * b[d][2] + p[3] * b[d][3];
            }
        }
        let sum = |d: usize, e: usize| -> Vector3<f64> {
            let row = &rows[e];
            row[0] * a[d][0] + row[1] * a[d][1] + row[2] * a[d][2] + row[3] * a[d][3]
        };
        Jet {
            r: sum(0, 0),
            slopes: [sum(1, 0), sum(0, 1)],
            bends: [sum(2, 0), sum(1, 1), sum(0, 2)],
        }
    }

    /// The point nearest to `p`, from the control point that is; where the net may be near p more than once, also from
    /// the nearest of some of its own points.
    #[must_use]
    pub fn nearest(&self, p: Vector3<f64>) -> Nearest {
        let far = |k: usize| (self.points[k] - p).norm_squared();
        let start = (0..self.form.points()).min_by(|&a, &b| far(a).total_cmp(&far(b)));
        let found = self.nearest_from(p, self.form.place(start.unwrap_or(0)));
        if !found.jet.is_sharp(p) {
            return found;
        }
        let far = |at: [f64; 2]| (self.jet(at).r - p).norm_squared();
        let places = (0..self.form.points()).map(|k| self.form.place(k));
        let mut starts: Vec<(f64, [f64; 2])> = places.map(|at| (far(at), at)).collect();
        starts.sort_by(|a, b| a.0.total_cmp(&b.0));
        let others = starts.into_iter().take(STARTS).map(|(_, at)| self.nearest_from(p, at));
        others.fold(found, |best, other| if other.square < best.square { other } else { best })
    }

    /// The point nearest to `p` near a place.
    #[must_use]
    pub fn nearest_from(&self, p: Vector3<f64>, start: [f64; 2]) -> Nearest {
        let mut x = Vector2::from(start);
        let mut jet = self.jet(start);
        let mut square = (p - jet.r).norm_squared();
        for _ in 0..TURNS {
            let d = p - jet.r;
            let gradient = Vector2::from_fn(|a, _| -d.dot(&jet.slopes[a]));
            let held = self.held(x, gradient, &jet, d.norm());
            let Some(step) = self.step(x, gradient, &jet, d, held) else { break };
            let size = step.amax();
            let (mut part, mut better) = (1.0, None);
            for _ in 0..30 {
                let to = self.inside(x + step * part);
                let there = self.jet(to.into());
                let far = (p - there.r).norm_squared();
                // The last step is below what rounding lets the distance show.
                if far <= square || size * part < LAST {
                    better = Some((to, there, far));
                    break;
                }
                part *= 0.5;
            }
            let Some((to, there, far)) = better else { break };
            let moved = (to - x).amax();
            (x, jet, square) = (to, there, far);
            if moved < LAST {
                break;
            }
        }
        let d = p - jet.r;
        let gradient = Vector2::from_fn(|a, _| -d.dot(&jet.slopes[a]));
        let feature = match self.held(x, gradient, &jet, d.norm()) {
            [None, _] => Feature::Inside,
            [Some(side), None] => Feature::Side(side),
            [Some(one), Some(other)] => {
                // Sides follow each other; the corner is where the later one begins.
                let n = self.form.bounds().len();
                Feature::Corner(if (one + 1) % n == other { other } else { one })
            }
        };
        Nearest { at: x.into(), feature, jet, square }
    }

    /// Takes a place back into the domain.
    fn inside(&self, mut x: Vector2<f64>) -> Vector2<f64> {
        x = x.map(|x| x.clamp(0.0, 1.0));
        if self.form == Form::Triangle && x.x + x.y > 1.0 {
            let half = 0.5 * (x.x + x.y - 1.0);
            x = (x - Vector2::repeat(half)).map(|x| x.clamp(0.0, 1.0));
            x.y = x.y.min(1.0 - x.x);
        }
        x
    }

    /// Sides that hold back what wants to leave, at most two.
    fn held(&self, x: Vector2<f64>, g: Vector2<f64>, jet: &Jet, far: f64) -> [Option<usize>; 2] {
        let mut out = [None; 2];
        let size = jet.slopes[0].norm() + jet.slopes[1].norm();
        let slack = size * (UPRIGHT * far + 1e-14 * size);
        let at: Vec2Sides = self.sides_at(x);
        for &side in at.iter().flatten() {
            let (n, _) = self.form.bounds()[side];
            let pull = g.dot(&Vector2::from(n));
            if pull > slack {
                match out {
                    [None, _] => out[0] = Some(side),
                    [Some(_), None] => out[1] = Some(side),
                    _ => {}
                }
            }
        }
        // In the sharp corners of a triangle one side may hold what slides along the other.
        if let ([Some(side), None], [Some(a), Some(b)]) = (out, at) {
            let e = Vector2::from(along(self.form, side));
            let other = if a == side { b } else { a };
            let (n, _) = self.form.bounds()[other];
            let way = -g.dot(&e);
            if way * e.dot(&Vector2::from(n)) < 0.0 && way.abs() > slack {
                out[1] = Some(other);
            }
        }
        out
    }

    fn sides_at(&self, x: Vector2<f64>) -> Vec2Sides {
        let mut out = [None; 2];
        for (side, (n, c)) in self.form.bounds().iter().enumerate() {
            if x.dot(&Vector2::from(*n)) - c <= ON {
                if out[0].is_none() {
                    out[0] = Some(side);
                } else {
                    out[1] = Some(side);
                }
            }
        }
        out
    }

    /// Newton's step, along a side where one holds; none in a corner or at the end.
    fn step(
        &self,
        x: Vector2<f64>,
        g: Vector2<f64>,
        jet: &Jet,
        d: Vector3<f64>,
        held: [Option<usize>; 2],
    ) -> Option<Vector2<f64>> {
        let metric = Matrix2::from_fn(|a, b| jet.slopes[a].dot(&jet.slopes[b]));
        let full = metric - Matrix2::from_fn(|a, b| d.dot(&jet.bend(a, b)));
        let sliding = |side: usize| {
            let e = Vector2::from(along(self.form, side));
            let (stiff, safe) = (e.dot(&(full * e)).abs(), e.dot(&(metric * e)));
            let stiff = stiff.max(FLAT * safe);
            if stiff > 0.0 { e * (-g.dot(&e) / stiff) } else { Vector2::zeros() }
        };
        let step = match held {
            [Some(_), Some(_)] => return None,
            [Some(side), None] => sliding(side),
            _ => {
                let step = downhill(full, metric, g)?;
                // A step that a side bars at once goes along it, or straight down.
                let barred = self.sides_at(x).into_iter().flatten().find(|&side| {
                    step.dot(&Vector2::from(self.form.bounds()[side].0)) < -LAST * step.amax()
                });
                match barred {
                    None => step,
                    Some(side) => {
                        let along = sliding(side);
                        let down = g / -(metric.trace() + f64::MIN_POSITIVE);
                        if along.amax() > down.amax() { along } else { down }
                    }
                }
            }
        };
        (step.amax() > 1e-15).then_some(step)
    }
}

type Vec2Sides = [Option<usize>; 2];

/// Part of the metric above which the stiffness of a foot is kept in a step.
const FLAT: f64 = 1e-6;

/// Newton's step for the squared distance with the Hessian `full`, its curvatures by the metric taken as positive: where
/// the surface bends more sharply than towards a centre at p the point would run uphill else, and by the metric alone it
/// would hardly leave the crest between two feet.
fn downhill(full: Matrix2<f64>, metric: Matrix2<f64>, g: Vector2<f64>) -> Option<Vector2<f64>> {
    let root = metric.cholesky().and_then(|root| root.l().try_inverse());
    let Some(root) = root else {
        // A corner of the square that is none of the face: straight down.
        return (metric.trace() > 0.0).then(|| g / -metric.trace());
    };
    let eigen = (root * full * root.transpose()).symmetric_eigen();
    let along = eigen.eigenvectors.transpose() * (root * g);
    let by = along.zip_map(&eigen.eigenvalues, |g, stiff| -g / stiff.abs().max(FLAT));
    Some(root.transpose() * (eigen.eigenvectors * by))
}

/// The box around some points, grown by a margin.
#[must_use]
pub fn hull(points: &[Vector3<f64>], margin: f64) -> Box3 {
    let mut hull = Box3 { low: [f64::INFINITY; 3], high: [f64::NEG_INFINITY; 3] };
    for p in points {
        for k in 0..3 {
            hull.low[k] = hull.low[k].min(p[k] - margin);
            hull.high[k] = hull.high[k].max(p[k] + margin);
        }
    }
    hull
}

/// Halvings of a piece after which a net counts as too sharply bent.
const HALVINGS: usize = 5;

/// A net, the box around all that it may touch, how sharply it bends, and the distance of contact.
struct Facing<'a> {
    net: &'a Net,
    near: Box3,
    kappa: f64,
    reach: f64,
}

impl Facing<'_> {
    /// Appends where a part of a piece is within reach, in order: halves are looked at where the whole gets too far away
    /// to be judged.
    fn zones(
        &self,
        slave: &Piece,
        (a, b): (f64, f64),
        halvings: usize,
        found: &mut Vec<(f64, f64)>,
    ) -> Option<()> {
        if !self.near.meets(&hull(&slave.part(a, b), 0.0)) {
            return Some(());
        }
        let mut sample = |xi: f64| {
            let p = slave.at(xi);
            let foot = self.net.nearest(p);
            let distance = foot.square.sqrt();
            let way = (p - foot.jet.r).dot(&slave.slope(xi));
            let slope = if distance > 0.0 { way / distance } else { 0.0 };
            Sample { xi, gap: distance - self.reach, slope }
        };
        let [first, last] = [sample(a), sample(b)];
        let radii = (self.reach, slave.radius());
        if let Some(convexity) = Convexity::before(self.kappa, radii, slave, [&first, &last]) {
            convexity.zones(&mut sample, &first, &last, found);
            return Some(());
        }
        let middle = 0.5 * (a + b);
        let halvings = halvings.checked_sub(1)?;
        self.zones(slave, (a, middle), halvings, found)?;
        self.zones(slave, (middle, b), halvings, found)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn net(form: Form, numbers: &[f64], wild: f64) -> Net {
        let mut points = [Vector3::zeros(); POINTS];
        for (k, p) in points.iter_mut().enumerate().take(form.points()) {
            let [u, v] = form.place(k);
            *p = Vector3::new(u, v, 0.0)
                + Vector3::from_fn(|c, _| wild * numbers[(3 * k + c) % numbers.len()]);
        }
        Net::new(form, points)
    }

    proptest! {
        #[test]
        fn no_zone_before_a_net_is_missed(
            ends in prop::array::uniform4(prop::array::uniform3(-1.0..1.0_f64)),
            numbers in prop::collection::vec(-1.0..1.0_f64, 48), wild in 0.0..0.12_f64, low in -0.1..0.2_f64,
        ) {
            let [a, t, b, u] = ends.map(Vector3::from);
            let corner = |x: f64, y: f64, by: Vector3<f64>| Vector3::new(x, y, low) + by * 0.15;
            let on = Vector3::new(1.0, 0.3, 0.0);
            let x = [corner(-0.2, 0.1, a), on + t * 0.3, corner(0.9, 0.5, b), on + u * 0.3];
            let slave = Piece::new(x, 1.1, 0.03);
            for form in [Form::Square, Form::Triangle] {
                let net = net(form, &numbers, wild);
                // Those that bend too sharply are for the search that knows nothing of bends.
                let Some(zones) = net.zones(&slave, 0.05) else { continue };
                for i in 0..=300 {
                    let xi = f64::from(i) / 300.0;
                    let gap = net.nearest(slave.at(xi)).square.sqrt() - 0.05;
                    let inside = zones.iter().any(|&(a, b)| a <= xi && xi <= b);
                    // Grazing contact shorter than the search's floor, 1e-3 R, may be left out.
                    if gap.abs() > 1e-5 {
                        prop_assert_eq!(inside, gap < 0.0, "xi = {}, gap = {}, zones {:?}", xi, gap, zones);
                    }
                }
            }
        }

        #[test]
        fn chords_stray_from_tangents_by_no_more_than_the_bound(
            numbers in prop::collection::vec(-1.0..1.0_f64, 48), wild in 0.0..0.2_f64,
            ends in prop::array::uniform2(prop::array::uniform2(0.0..0.5_f64)),
        ) {
            for form in [Form::Square, Form::Triangle] {
                let net = net(form, &numbers, wild);
                let Some(kappa) = net.curvature_bound() else { continue };
                let [from, to] = ends;
                let (here, there) = (net.jet(from), net.jet(to));
                let chord = there.r - here.r;
                // Federer's condition, with the tangent that leads from the one to the other.
                let tangent = here.slopes[0] * (to[0] - from[0]) + here.slopes[1] * (to[1] - from[1]);
                let part = chord.dot(&tangent) / tangent.norm_squared().max(f64::MIN_POSITIVE);
                let stray = (chord - tangent * part.max(0.0)).norm();
                prop_assert!(stray <= 0.5 * kappa * chord.norm_squared() + 1e-12, "{} {}", stray, kappa);
            }
        }

        #[test]
        fn derivatives_are_those_of_the_place(at in prop::array::uniform2(0.05..0.45_f64), numbers in prop::collection::vec(-1.0..1.0_f64, 48)) {
            for form in [Form::Square, Form::Triangle] {
                let net = net(form, &numbers, 0.5);
                let (e, here) = (1e-5, net.jet(at));
                let shifted = |a: usize, by: f64| { let mut x = at; x[a] += by; net.jet(x) };
                for a in 0..2 {
                    let (up, down) = (shifted(a, e), shifted(a, -e));
                    // Second order in e of cubics, and rounding over e.
                    prop_assert!(((up.r - down.r) / (2.0 * e) - here.slopes[a]).norm() < 1e-8);
                    for b in 0..2 {
                        let bend = (up.slopes[b] - down.slopes[b]) / (2.0 * e);
                        prop_assert!((bend - here.bend(a, b)).norm() < 1e-7);
                    }
                }
            }
        }

        #[test]
        fn no_sample_is_nearer(numbers in prop::collection::vec(-1.0..1.0_f64, 48), p in prop::array::uniform3(-0.7..1.7_f64)) {
            for form in [Form::Square, Form::Triangle] {
                // Faces that turn by some tens of degrees, and places nearer than the radius of curvature.
                let net = net(form, &numbers, 0.06);
                let p = Vector3::new(p[0], p[1], 0.25 * p[2] - 0.1);
                let found = net.nearest(p);
                let n = 60;
                for i in 0..=n {
                    for j in 0..=n {
                        let at = [i as f64 / f64::from(n), j as f64 / f64::from(n)];
                        if form == Form::Triangle && at[0] + at[1] > 1.0 { continue; }
                        let square = (net.jet(at).r - p).norm_squared();
                        prop_assert!(found.square <= square + 1e-12, "{form:?} {found:?} {at:?} {square}");
                    }
                }
                let d = p - found.jet.r;
                match found.feature {
                    Feature::Inside => for slope in found.jet.slopes {
                        prop_assert!(d.dot(&slope).abs() < 2e-9 * (1.0 + d.norm()), "{found:?}");
                    },
                    Feature::Side(side) => {
                        let e = along(form, side);
                        let t = found.jet.slopes[0] * e[0] + found.jet.slopes[1] * e[1];
                        prop_assert!(d.dot(&t).abs() < 1e-9, "{found:?}");
                    }
                    Feature::Corner(_) => {}
                }
            }
        }
    }

    #[test]
    fn feet_leave_the_crest_between_two() {
        // z = a x^2 over [-1/2, 1/2]: seen from (0, 0, h), above the centre of curvature, the middle is farthest.
        let a = 2.0;
        let points = std::array::from_fn(|k| {
            let [u, v] = Form::Square.place(k);
            // Control points of (u - 1/2)^2.
            let height = [0.25, -1.0 / 12.0, -1.0 / 12.0, 0.25][(3.0 * u).round() as usize];
            Vector3::new(u - 0.5, v - 0.5, a * height)
        });
        let net = Net::new(Form::Square, points);
        for h in [0.2501, 0.26, 0.3, 0.4] {
            let p = Vector3::new(0.0, 0.1, h);
            let foot = ((h - 0.5 / a) / a).sqrt();
            for start in [0.5 + 1e-3, 0.5 - 1e-6, 0.6, 0.1] {
                let found = net.nearest_from(p, [start, 0.5]);
                assert!((found.at[0] - 0.5).abs() - foot < 1e-9, "{h} {start} {found:?} {foot}");
                assert!((found.at[0] - 0.5).abs() - foot > -1e-9, "{h} {start} {found:?} {foot}");
            }
        }
    }

    #[test]
    fn corners_have_the_number_of_the_side_that_begins_there() {
        let numbers = [0.0];
        let square = net(Form::Square, &numbers, 0.0);
        let triangle = net(Form::Triangle, &numbers, 0.0);
        let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        for (k, c) in corners.iter().enumerate() {
            let out = Vector3::new(3.0 * c[0] - 1.0, 3.0 * c[1] - 1.0, 0.1);
            assert_eq!(square.nearest(out).feature, Feature::Corner(k));
        }
        for (k, c) in [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]].iter().enumerate() {
            let out = Vector3::new(5.0 * c[0] - 1.0, 5.0 * c[1] - 1.0, 0.1);
            assert_eq!(triangle.nearest(out).feature, Feature::Corner(k));
        }
        let beside = [(0, [0.5, -1.0]), (1, [2.0, 0.5]), (2, [0.5, 2.0]), (3, [-1.0, 0.5])];
        for (side, [x, y]) in beside {
            assert_eq!(square.nearest(Vector3::new(x, y, 0.2)).feature, Feature::Side(side));
        }
        // Straight above a side there is nothing to hold.
        assert_eq!(square.nearest(Vector3::new(0.5, 0.0, 0.2)).feature, Feature::Inside);
    }
}
