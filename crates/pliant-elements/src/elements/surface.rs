//! What the surface elements share: their registry, and the shape functions at a point.
//!
//! An element is a list of n nodal vectors q_i (positions, slopes, twists) with scalar shape functions N_i of the
//! parameters (u, v) of the mesh: `r = sum_i N_i q_i`. Everything else, kinematics, materials, mass, is common to all
//! kinds (docs/theory/shell.md).

use super::{bicubic, cylindrical, membrane, plate, triangle};
use pliant_math::quadrature::{GAUSS_2, GAUSS_3, GAUSS_4, GAUSS_7};

/// Kind of a surface element.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum SurfaceKind {
    /// Bicubic, r, r_u, r_v and r_uv at four nodes: 48 coordinates.
    Bicubic,
    /// Cubic along u, linear along v, r and r_u at four nodes: 24 coordinates.
    Cylindrical,
    /// Incomplete quartic, r, r_u and r_v at four nodes: 36 coordinates.
    Plate,
    /// Reduced Hsieh-Clough-Tocher triangle, r, r_u and r_v at three nodes: 27 coordinates.
    Triangle,
    /// Bilinear, r at four nodes: 12 coordinates; no bending.
    QuadMembrane,
    /// Linear, r at three nodes: 9 coordinates; no bending.
    TriangleMembrane,
}

/// Every kind, for tests.
pub const SURFACE_KINDS: [SurfaceKind; 6] = [
    SurfaceKind::Bicubic,
    SurfaceKind::Cylindrical,
    SurfaceKind::Plate,
    SurfaceKind::Triangle,
    SurfaceKind::QuadMembrane,
    SurfaceKind::TriangleMembrane,
];

/// A shape function's value and its derivatives by the parameters u and v.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Jet {
    /// N.
    pub value: f64,
    /// dN/du.
    pub u: f64,
    /// dN/dv.
    pub v: f64,
    /// d2N/du2.
    pub uu: f64,
    /// d2N/dv2.
    pub vv: f64,
    /// d2N/du dv.
    pub uv: f64,
}

/// Functions of one variable with two derivatives each, `[N, N', N'']`.
pub(crate) type Line<const N: usize> = [[f64; 3]; N];

impl Jet {
    /// `a x + b y`
    fn sum(a: f64, x: &Self, b: f64, y: &Self) -> Self {
        Self {
            value: a * x.value + b * y.value,
            u: a * x.u + b * y.u,
            v: a * x.v + b * y.v,
            uu: a * x.uu + b * y.uu,
            vv: a * x.vv + b * y.vv,
            uv: a * x.uv + b * y.uv,
        }
    }

    /// The product of a function of u and one of v.
    pub(crate) fn product(a: [f64; 3], b: [f64; 3]) -> Self {
        Self {
            value: a[0] * b[0],
            u: a[1] * b[0],
            v: a[0] * b[1],
            uu: a[2] * b[0],
            vv: a[0] * b[2],
            uv: a[1] * b[1],
        }
    }
}

/// Corners of a quadrilateral in the order of its nodes.
pub(crate) const CORNERS: [[usize; 2]; 4] = [[0, 0], [1, 0], [1, 1], [0, 1]];

/// Cubic Hermite functions of (r1, r1', r2, r2') on [0, length].
pub(crate) fn hermite(xi: f64, length: f64) -> Line<4> {
    use pliant_math::hermite::{shape, shape_derivative, shape_second_derivative};
    let (n, d, dd) =
        (shape(xi, length), shape_derivative(xi, length), shape_second_derivative(xi, length));
    std::array::from_fn(|k| [n[k], d[k], dd[k]])
}

/// Linear functions on [0, length].
pub(crate) fn linear(xi: f64, length: f64) -> Line<2> {
    [[1.0 - xi, -1.0 / length, 0.0], [xi, 1.0 / length, 0.0]]
}

/// The parameters (u, v) of an element.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Chart {
    /// Where the corners lie; triangles have three.
    pub corners: [[f64; 2]; 4],
    /// Slopes along the element's parameters at its corners in terms of the nodal ones, where these belong to other
    /// parameters: `r_b = sum_a turns[corner][a][b] r_a`. On curved surfaces every element has parameters of its own.
    pub turns: Option<[[[f64; 2]; 2]; 4]>,
}

impl From<[[f64; 2]; 4]> for Chart {
    /// Parameters common to the whole mesh.
    fn from(corners: [[f64; 2]; 4]) -> Self {
        Self { corners, turns: None }
    }
}

impl Chart {
    /// Extent of a quadrilateral.
    pub(crate) fn extent(&self) -> [f64; 2] {
        let [origin, right, _, up] = self.corners;
        [right[0] - origin[0], up[1] - origin[1]]
    }
}

/// Quadrature of an element: places in it and weights that sum to one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Quadrature {
    /// What is adequate for the kind.
    #[default]
    Standard,
    /// Fewer points for the membrane, against locking of coarse curved shells; stabilised where that is needed to keep
    /// the rigid motions the only ones free of energy.
    Reduced,
    /// More points than are needed.
    Full,
}

/// How the membrane's energy is integrated.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Integrals {
    /// At the points of the rule.
    #[default]
    Quadrature,
    /// Exactly, from integrals of products of shape functions computed once (Saint Venant-Kirchhoff only).
    Precomputed,
}

/// A point of a quadrature rule.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct QuadraturePoint {
    /// Place in the element: [0, 1] x [0, 1], or the first two area coordinates' weights of corners 1 and 2.
    pub at: [f64; 2],
    /// Weight of the membrane part, over the parameter area.
    pub membrane: f64,
    /// Weight of the bending part.
    pub bending: f64,
}

/// Part of the finer rule that keeps the reduced membrane free of spurious modes.
const STABILISATION: f64 = 0.02;

impl SurfaceKind {
    /// Its name, as in model files.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Bicubic => "bicubic",
            Self::Cylindrical => "cylindrical",
            Self::Plate => "plate",
            Self::Triangle => "triangle",
            Self::QuadMembrane => "quad_membrane",
            Self::TriangleMembrane => "triangle_membrane",
        }
    }

    /// The kind of a name.
    #[must_use]
    pub fn of_name(name: &str) -> Option<Self> {
        SURFACE_KINDS.into_iter().find(|kind| kind.name() == name)
    }

    /// Number of corners.
    #[must_use]
    pub fn corners(self) -> usize {
        match self {
            Self::Triangle | Self::TriangleMembrane => 3,
            _ => 4,
        }
    }

    /// Nodal vectors at each corner, the position first.
    #[must_use]
    pub fn vectors_per_node(self) -> usize {
        match self {
            Self::Bicubic => 4,
            Self::Cylindrical => 2,
            Self::Plate | Self::Triangle => 3,
            Self::QuadMembrane | Self::TriangleMembrane => 1,
        }
    }

    /// Number of nodal vectors.
    #[must_use]
    pub fn vectors(self) -> usize {
        self.corners() * self.vectors_per_node()
    }

    /// Whether the element resists bending.
    #[must_use]
    pub fn bends(self) -> bool {
        !matches!(self, Self::QuadMembrane | Self::TriangleMembrane)
    }

    /// The shape functions at a place of the element.
    #[must_use]
    pub fn shape(self, chart: &Chart, at: [f64; 2]) -> Vec<Jet> {
        let mut jets = match self {
            Self::Bicubic => bicubic::shape(chart.extent(), at),
            Self::Cylindrical => cylindrical::shape(chart.extent(), at),
            Self::Plate => plate::shape(chart.extent(), at),
            Self::Triangle => triangle::shape(&chart.corners, at),
            Self::QuadMembrane => membrane::quad(at),
            Self::TriangleMembrane => membrane::triangle(at),
        };
        if let (Some(turns), 3) = (&chart.turns, self.vectors_per_node()) {
            for (node, turn) in jets.chunks_exact_mut(3).zip(turns) {
                let (u, v) = (node[1], node[2]);
                node[1] = Jet::sum(turn[0][0], &u, turn[0][1], &v);
                node[2] = Jet::sum(turn[1][0], &u, turn[1][1], &v);
            }
        }
        jets
    }

    /// Area of the element in the parameters of its shape functions.
    #[must_use]
    pub fn parameter_area(self, chart: &Chart) -> f64 {
        match self {
            Self::QuadMembrane => 1.0,
            Self::TriangleMembrane => 0.5,
            Self::Triangle => triangle::area(&chart.corners),
            _ => chart.extent().iter().product(),
        }
    }

    /// The rule of the elastic energy.
    #[must_use]
    pub fn rule(self, quadrature: Quadrature) -> Vec<QuadraturePoint> {
        let (two, three, four) = (GAUSS_2.pairs(), GAUSS_3.pairs(), GAUSS_4.pairs());
        match (self, quadrature) {
            (Self::Bicubic, Quadrature::Standard) => tensor(&three, &three, 1.0, 1.0),
            (Self::Bicubic, Quadrature::Full) => tensor(&four, &four, 1.0, 1.0),
            (Self::Bicubic, Quadrature::Reduced) => {
                stabilised(tensor(&two, &two, 1.0, 1.0), tensor(&three, &three, 1.0, 1.0))
            }
            (Self::Cylindrical, Quadrature::Standard) => tensor(&three, &two, 1.0, 1.0),
            (Self::Cylindrical, Quadrature::Reduced) => {
                stabilised(tensor(&two, &two, 1.0, 1.0), tensor(&three, &two, 1.0, 1.0))
            }
            (Self::Cylindrical, Quadrature::Full) => tensor(&four, &three, 1.0, 1.0),
            (Self::Plate, Quadrature::Reduced) => tensor(&three, &three, 1.0, 1.0),
            (Self::Plate, _) => tensor(&four, &four, 1.0, 1.0),
            (Self::Triangle, Quadrature::Standard) => triangle::rule(),
            (Self::Triangle, Quadrature::Reduced) => triangle::reduced_rule(),
            (Self::Triangle, Quadrature::Full) => triangle::mass_rule(),
            (Self::QuadMembrane, Quadrature::Full) => tensor(&three, &three, 1.0, 1.0),
            (Self::QuadMembrane, _) => tensor(&two, &two, 1.0, 1.0),
            (Self::TriangleMembrane, _) => membrane::triangle_rule(),
        }
    }

    /// A rule that is exact for the membrane energy of flat elements, where integrals are computed in advance.
    #[must_use]
    pub fn exact_rule(self) -> Option<Vec<QuadraturePoint>> {
        let (three, seven) = (GAUSS_3.pairs(), GAUSS_7.pairs());
        match self {
            Self::Cylindrical => Some(tensor(&seven, &three, 1.0, 1.0)),
            Self::Plate => Some(tensor(&seven, &seven, 1.0, 1.0)),
            Self::QuadMembrane => Some(tensor(&three, &three, 1.0, 1.0)),
            Self::TriangleMembrane => Some(membrane::triangle_rule()),
            // Far dearer than their rules.
            Self::Triangle | Self::Bicubic => None,
        }
    }

    /// The rule of the mass matrix, exact for flat elements.
    #[must_use]
    pub fn mass_rule(self) -> Vec<QuadraturePoint> {
        let (two, four) = (GAUSS_2.pairs(), GAUSS_4.pairs());
        match self {
            Self::Bicubic | Self::Plate => tensor(&four, &four, 1.0, 1.0),
            Self::Cylindrical => tensor(&four, &two, 1.0, 1.0),
            Self::Triangle => triangle::mass_rule(),
            Self::QuadMembrane => tensor(&two, &two, 1.0, 1.0),
            Self::TriangleMembrane => membrane::triangle_mass_rule(),
        }
    }

    /// The middle of the element.
    #[must_use]
    pub fn middle(self) -> [f64; 2] {
        if self.corners() == 3 { [1.0 / 3.0, 1.0 / 3.0] } else { [0.5, 0.5] }
    }
}

fn tensor(u: &[(f64, f64)], v: &[(f64, f64)], membrane: f64, bending: f64) -> Vec<QuadraturePoint> {
    let point = |&(x, a): &(f64, f64), &(y, b): &(f64, f64)| QuadraturePoint {
        at: [x, y],
        membrane: membrane * a * b,
        bending: bending * a * b,
    };
    u.iter().flat_map(|x| v.iter().map(move |y| point(x, y))).collect()
}

/// A coarse rule for the membrane with a small part of the fine one, which keeps spurious modes away and integrates
/// bending.
fn stabilised(coarse: Vec<QuadraturePoint>, fine: Vec<QuadraturePoint>) -> Vec<QuadraturePoint> {
    let scaled = |point: QuadraturePoint, membrane: f64, bending: f64| QuadraturePoint {
        membrane: membrane * point.membrane,
        bending: bending * point.bending,
        ..point
    };
    let coarse = coarse.into_iter().map(|point| scaled(point, 1.0 - STABILISATION, 0.0));
    coarse.chain(fine.into_iter().map(|point| scaled(point, STABILISATION, 1.0))).collect()
}
