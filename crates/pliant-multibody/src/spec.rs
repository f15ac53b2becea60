//! The lowered model document: what the Python face writes and every run starts from.
//!
//! Points, curves and sections of the user's model have become nodes, elements and stiffness at quadrature points;
//! names stay, for messages. Large arrays travel beside the document: `{"array": k}` points at number k.

mod beam;

use crate::probes::spec::ProbeContactSpec;
pub use beam::{BeamSpec, LockingSpec};
use serde::{Deserialize, Serialize};

/// The version of the document that this crate reads and writes.
pub const VERSION: u32 = 1;

/// Numbers of any shape, row by row: in the document itself or beside it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Array {
    /// Number of an array that travels beside the document.
    Beside {
        /// Which one.
        array: usize,
    },
    /// The numbers themselves.
    Inline(Vec<f64>),
}

pub(crate) fn default_array() -> Array {
    Array::Inline(Vec::new())
}

/// A model.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ModelSpec {
    /// [`VERSION`].
    pub version: u32,
    /// Acceleration of gravity [m/s^2].
    pub gravity: [f64; 3],
    /// Points whose position several cables share, or free point masses, (p, 3) [m].
    pub shared_points: Array,
    /// Their velocities, (p, 3) [m/s].
    pub shared_velocities: Array,
    /// Cables and nets of cables.
    pub cables: Vec<CableSpec>,
    /// Shells and membranes.
    #[serde(default)]
    pub surfaces: Vec<SurfaceSpec>,
    /// Beams.
    #[serde(default)]
    pub beams: Vec<BeamSpec>,
    /// Rigid bodies.
    #[serde(default)]
    pub rigid_bodies: Vec<RigidBodySpec>,
    /// Lumped masses.
    pub masses: Vec<MassSpec>,
    /// Joints.
    pub joints: Vec<JointSpec>,
    /// Joints that are released and engaged.
    #[serde(default)]
    pub latches: Vec<LatchSpec>,
    /// Loads.
    pub loads: Vec<LoadSpec>,
    /// Pairs that may touch.
    #[serde(default)]
    pub contacts: Vec<ContactSpec>,
    /// Pairs that may touch, other than lines with lines or shapes at rest.
    #[serde(default)]
    pub probe_contacts: Vec<ProbeContactSpec>,
    /// Forces that depend on positions and velocities.
    #[serde(default)]
    pub forces: Vec<ForceSpec>,
    /// Enclosed gas.
    #[serde(default)]
    pub chambers: Vec<ChamberSpec>,
}

/// Gas enclosed by faces of surfaces, whose normals point out of it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ChamberSpec {
    /// Name.
    pub name: String,
    /// Faces.
    pub faces: Vec<FacesSpec>,
    /// What closes their rims.
    pub rims: Vec<RimSpec>,
    /// Point from which volumes count, in all planes of symmetry if there is one [m].
    pub origin: [f64; 3],
    /// The gas at the start.
    pub gas: GasSpec,
    /// Mass of the gas at the start [kg]; none: as much as fills the volume.
    #[serde(default)]
    pub mass: Option<f64>,
    /// Mass that flows in per time [kg/s]; none: nothing ever does.
    pub inflow: Option<Signal>,
    /// Absolute pressure of the surroundings [Pa].
    pub ambient: f64,
}

/// Faces of one surface.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FacesSpec {
    /// Number of the surface.
    pub surface: usize,
    /// Numbers of the faces.
    pub faces: Array,
}

/// Sides of faces of one surface.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SidesSpec {
    /// Number of the surface.
    pub surface: usize,
    /// Rows (face, side); side k runs from corner k to the next, (s, 2), whole numbers.
    pub sides: Array,
}

/// Sides at the rim of a chamber, and what closes them.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RimSpec {
    /// The sides.
    pub sides: Vec<SidesSpec>,
    /// How they are closed.
    pub closure: ClosureSpec,
}

/// How a rim is closed: by the cone from its apex.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub enum ClosureSpec {
    /// By the world: the rim is held.
    Held {
        /// The apex [m].
        apex: [f64; 3],
    },
    /// By the rest of a symmetric surface.
    Plane {
        /// The apex, in the plane [m].
        apex: [f64; 3],
        /// Unit normal of the plane.
        normal: [f64; 3],
    },
    /// By a light lid, whose apex is `projection` times the middle of the rim plus `shift`.
    Lid {
        /// Rows of the matrix.
        projection: [[f64; 3]; 3],
        /// The shift [m].
        shift: [f64; 3],
    },
}

/// A gas: `p = p_0 (rho/rho_0)^exponent`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GasSpec {
    /// Absolute pressure [Pa].
    pub pressure: f64,
    /// Temperature at this pressure [K].
    pub temperature: f64,
    /// 1: isothermal.
    pub exponent: f64,
    /// Specific gas constant [J/(kg K)].
    pub gas_constant: f64,
}

/// A rigid body: the position of its centre of mass and three axes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RigidBodySpec {
    /// Name of the body.
    pub name: String,
    /// Mass [kg].
    pub mass: f64,
    /// Inertia about the centre of mass in body axes, row by row [kg m^2].
    pub inertia: [[f64; 3]; 3],
    /// Centre of mass at the start [m].
    pub position: [f64; 3],
    /// Body axes at the start, one a row.
    pub axes: [[f64; 3]; 3],
    /// Velocity of the centre of mass at the start [m/s].
    pub velocity: [f64; 3],
    /// Angular velocity at the start, in world axes [rad/s].
    pub angular_velocity: [f64; 3],
}

/// Strands of one law; nodes and elements of all strands one after the other. Strand k with n_k elements has
/// n_k + 1 nodes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CableSpec {
    /// Name of the body.
    pub name: String,
    /// Number of elements of each strand, (strands,), whole numbers.
    pub strands: Array,
    /// Node positions at the start, (nodes, 3) [m].
    pub r: Array,
    /// Slopes dr/ds at the start by stress-free arc length, (nodes, 3).
    pub t: Array,
    /// Velocities of the positions at the start, (nodes, 3) [m/s], or empty for none.
    pub v_r: Array,
    /// Velocities of the slopes at the start, (nodes, 3) [1/s], or empty for none.
    pub v_t: Array,
    /// Stress-free lengths of the elements, (elements,) [m].
    pub lengths: Array,
    /// Axial stiffness EA [N]: (1,), or at the rule's axial points, (elements, m): m = 3 for Lobatto (start, middle,
    /// end), 5 for full (Gauss).
    pub axial_stiffness: Array,
    /// Bending stiffness EI [N m^2]: (1,), or at the three Gauss points, (elements, 3).
    pub bending_stiffness: Array,
    /// Mass per stress-free length [kg/m]: (1,), or at five Gauss points, (elements, 5).
    pub mass_per_length: Array,
    /// `green_lagrange` or `biot`.
    pub strain: StrainSpec,
    /// `lobatto` or `full`.
    pub integration: IntegrationSpec,
    /// `exact` or `simplified`.
    pub bending: BendingSpec,
    /// Stress-free line curved in a plane; none: straight elements.
    pub reference: Option<ReferenceSpec>,
    /// Stress-free length of the whole cable over time [m], which begins with the sum of `lengths`.
    #[serde(default)]
    pub rest_length: Option<Signal>,
    /// No compression.
    pub tension_only: bool,
    /// When it yields; none: never.
    #[serde(default)]
    pub plastic: Option<PlasticSpec>,
    /// Kelvin-Voigt retardation time [s].
    pub retardation_time: f64,
    /// Rows (node, shared point): nodes whose position is a shared point's, (k, 2), whole numbers.
    pub shared: Array,
    /// Radius for contact [m]: (1,) or (elements,); none where it touches nothing.
    #[serde(default)]
    pub radius: Option<Array>,
}

/// When a cable yields and how it hardens; stresses over Young's modulus.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PlasticSpec {
    /// Strain at which it yields first, above 0.
    pub yield_strain: f64,
    /// Growth of the elastic range with the path of the plastic strain, at least 0.
    pub isotropic: f64,
    /// Shift of the elastic range with the plastic strain, at least 0.
    pub kinematic: f64,
    /// Plastic strain and its path at each axial point at the start, (elements, points, 2); empty: none.
    #[serde(default = "default_array")]
    pub past: Array,
}

/// A pair that may touch.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ContactSpec {
    /// Name of the contact.
    pub name: String,
    /// Number of the line whose zones carry the force: cables count first, then beams.
    pub slave: usize,
    /// What it touches.
    pub master: MasterSpec,
    /// Stiffness k, force per penetration and length [N/m^2].
    pub stiffness: f64,
    /// Penetration at which the full stiffness is reached [m].
    pub ramp: f64,
    /// Damping c [s/m].
    pub damping: f64,
    /// Friction; none: none.
    pub friction: Option<FrictionSpec>,
    /// Of a line with itself: points closer than this along it do not touch [m].
    pub window: f64,
    /// Neighbourhoods of joints where nothing touches, (k, 3): arc lengths on slave and master, and width [m].
    pub apart: Array,
}

/// What a line may touch.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub enum MasterSpec {
    /// A line.
    Line {
        /// Its number, cables first, then beams.
        line: usize,
    },
    /// A shape at rest.
    Shape {
        /// Its centre [m].
        origin: [f64; 3],
        /// Its axes, one a row.
        axes: [[f64; 3]; 3],
        /// The shape.
        shape: ShapeSpec,
    },
}

/// A shape in its own frame.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub enum ShapeSpec {
    /// All below z = 0.
    HalfSpace,
    /// A ball.
    Sphere {
        /// Radius [m].
        radius: f64,
    },
    /// A box.
    Box {
        /// Edges [m].
        size: [f64; 3],
    },
    /// A cylinder along z.
    Cylinder {
        /// Radius [m].
        radius: f64,
        /// Length [m].
        length: f64,
    },
    /// A cylinder along z with half balls on its ends.
    Capsule {
        /// Radius [m].
        radius: f64,
        /// Length between the centres of the balls [m].
        length: f64,
    },
    /// A surface of triangles, outwards where they go counter-clockwise.
    Mesh {
        /// Its points (n, 3) [m].
        points: Array,
        /// Rows of three points (m, 3).
        triangles: Array,
    },
    /// A channel along a line of cubic pieces, touched from inside.
    Bore {
        /// Radius [m].
        radius: f64,
        /// Points of the line (n + 1, 3) [m].
        points: Array,
        /// Its unit tangents there (n + 1, 3).
        tangents: Array,
        /// Lengths of the pieces (n,) [m].
        lengths: Array,
    },
}

/// A law of friction, all coefficients given.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "law", rename_all = "snake_case", deny_unknown_fields)]
#[allow(missing_docs)] // named as in pliant_contact::friction
pub enum FrictionSpec {
    /// LuGre.
    Lugre {
        mu_s: f64,
        mu_d: f64,
        v_s: f64,
        alpha: f64,
        sigma_0: f64,
        sigma_1: f64,
        sigma_2: f64,
        v_d: f64,
        scaled: bool,
    },
    /// Coulomb.
    Coulomb { mu: f64, sigma_0: f64, sigma_1: f64 },
}

/// A shell or membrane. Nodal vectors come node by node, the position first; faces are the quadrilaterals, then the
/// triangles.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SurfaceSpec {
    /// Name of the body.
    pub name: String,
    /// Nodal vectors at each node: 4 (r, r_u, r_v, r_uv), 3 (r, r_u, r_v), 2 (r, r_u) or 1 (r).
    pub vectors: usize,
    /// Stress-free nodal vectors, (nodes, vectors, 3).
    pub reference: Array,
    /// Nodal vectors at the start, (nodes, vectors, 3), or empty where they are stress-free.
    pub q: Array,
    /// Their velocities, (nodes, vectors, 3), or empty for none.
    pub v: Array,
    /// Nodes of the quadrilaterals, counter-clockwise, (m, 4), whole numbers.
    pub quads: Array,
    /// Their extent in the parameters u and v, (m, 2); empty for membranes.
    pub quad_sizes: Array,
    /// Nodes of the triangles, counter-clockwise, (k, 3), whole numbers.
    pub triangles: Array,
    /// Parameters (u, v) of their corners, (k, 3, 2); empty for membranes.
    pub triangle_charts: Array,
    /// Slopes along each face's own parameters at its corners in terms of the nodal ones, (corners of all faces, 2, 2);
    /// empty where the parameters are common to all faces.
    pub turns: Array,
    /// Thickness [m]: (1,) or (faces,).
    pub thickness: Array,
    /// Law of the material.
    pub material: SurfaceMaterialSpec,
    /// Mass per volume [kg/m^3].
    pub density: f64,
    /// Kelvin-Voigt retardation time [s].
    pub retardation_time: f64,
    /// Quadrature of the elastic energy.
    pub quadrature: QuadratureSpec,
    /// Measure of curvature.
    pub bending: BendingSpec,
    /// How the membrane's energy is integrated.
    pub integrals: IntegralsSpec,
}

/// Law of plane stress of a surface.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub enum SurfaceMaterialSpec {
    /// Stress linear in the Green-Lagrange strain.
    SaintVenantKirchhoff {
        /// E [Pa].
        youngs_modulus: f64,
        /// nu.
        poisson_ratio: f64,
    },
    /// Rubber; a Poisson's ratio of 0.5 is incompressible.
    NeoHookean {
        /// E [Pa].
        youngs_modulus: f64,
        /// nu.
        poisson_ratio: f64,
    },
    /// Saint Venant-Kirchhoff in tension; wrinkles instead of carrying compression.
    TensionField {
        /// E [Pa].
        youngs_modulus: f64,
        /// nu.
        poisson_ratio: f64,
        /// Part of the elastic law that is kept where the film is not taut.
        residual_stiffness: f64,
    },
}

/// How the membrane's energy of surfaces is integrated.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum IntegralsSpec {
    /// By quadrature.
    Quadrature,
    /// Exactly, from integrals computed once.
    Precomputed,
}

/// Quadrature of the elastic energy of surfaces.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum QuadratureSpec {
    /// What is adequate for the kind.
    Standard,
    /// Fewer points for the membrane, stabilised.
    Reduced,
    /// One more point a direction.
    Full,
}

/// Strain measure of the axial law.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum StrainSpec {
    /// (r'.r' - 1) / 2.
    GreenLagrange,
    /// |r'| - 1.
    Biot,
}

/// Quadrature of the axial energy.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum IntegrationSpec {
    /// Three Lobatto points: free of locking.
    Lobatto,
    /// Five Gauss points: exact for Green-Lagrange.
    Full,
}

/// Measure of curvature.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum BendingSpec {
    /// Rotation of the tangent per stress-free length, |r' x r''| / |r'|^2.
    Exact,
    /// |r''|.
    Simplified,
}

/// A stress-free line curved in a plane.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ReferenceSpec {
    /// Node positions, (nodes, 3) [m].
    pub r: Array,
    /// Slopes, (nodes, 3).
    pub t: Array,
    /// Unit normal of the plane.
    pub normal: [f64; 3],
}

/// A material point, a shared point or a point of the world.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged, deny_unknown_fields)]
pub enum PointSpec {
    /// Point of a cable.
    Cable {
        /// Number of the cable.
        cable: usize,
        /// Number of the element, counted through all strands.
        element: usize,
        /// Place in the element, 0 to 1.
        xi: f64,
    },
    /// Point of a surface.
    Surface {
        /// Number of the surface.
        surface: usize,
        /// Number of the face.
        face: usize,
        /// Place in the face: in the unit square, or the weights of the second and third corner.
        at: [f64; 2],
    },
    /// Point of a beam.
    Beam {
        /// Number of the beam.
        beam: usize,
        /// Number of the element.
        element: usize,
        /// Place in the element, 0 to 1.
        xi: f64,
        /// Distance from the centre line along the section's y and z [m].
        offset: [f64; 2],
    },
    /// Point of a rigid body.
    Rigid {
        /// Number of the body.
        rigid: usize,
        /// Place from the centre of mass in body axes [m].
        local: [f64; 3],
    },
    /// A shared point.
    Shared {
        /// Its number.
        shared: usize,
    },
    /// A point fixed in the world [m].
    World {
        /// Its position.
        world: [f64; 3],
    },
}

/// A lumped mass.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MassSpec {
    /// Name.
    pub name: String,
    /// Mass [kg].
    pub mass: f64,
    /// Where it sits.
    pub at: PointSpec,
}

/// A joint.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub enum JointSpec {
    /// Two points coincide (3 equations).
    Pin {
        /// Name.
        name: String,
        /// First point.
        a: PointSpec,
        /// Second point.
        b: PointSpec,
    },
    /// A point of a cable keeps its position and the direction of its tangent (5 equations; the stretch is free), a
    /// rigid body or the section of a beam its place (6).
    Clamp {
        /// Name.
        name: String,
        /// The point.
        a: PointSpec,
        /// Direction of the tangent; none: that at the start.
        direction: Option<[f64; 3]>,
    },
    /// Two bodies move as one (6 equations, 5 where one is a cable).
    Weld {
        /// Name.
        name: String,
        /// First point.
        a: PointSpec,
        /// Second point.
        b: PointSpec,
    },
    /// Two bodies share a point and an axis (5 equations).
    Hinge {
        /// Name.
        name: String,
        /// First point.
        a: PointSpec,
        /// Second point.
        b: PointSpec,
        /// Axis at the start.
        axis: [f64; 3],
    },
    /// Two bodies slide along an axis without turning (5 equations).
    Slider {
        /// Name.
        name: String,
        /// First point.
        a: PointSpec,
        /// Second point.
        b: PointSpec,
        /// Axis at the start.
        axis: [f64; 3],
    },
    /// Two bodies slide along an axis and turn about it (4 equations).
    Cylindrical {
        /// Name.
        name: String,
        /// First point.
        a: PointSpec,
        /// Second point.
        b: PointSpec,
        /// Axis at the start.
        axis: [f64; 3],
    },
    /// Two bodies share a point, an axis of each stays normal to that of the other (4 equations).
    Universal {
        /// Name.
        name: String,
        /// First point.
        a: PointSpec,
        /// Second point.
        b: PointSpec,
        /// Axis of the first at the start.
        axis_a: [f64; 3],
        /// Axis of the second at the start.
        axis_b: [f64; 3],
    },
    /// A point slides along a straight line (2 equations).
    SlideLine {
        /// Name.
        name: String,
        /// The point.
        a: PointSpec,
        /// A point of the line.
        b: PointSpec,
        /// Direction at the start.
        axis: [f64; 3],
    },
    /// A point slides along a cable (3 equations, and the arc length as a coordinate).
    SlideCable {
        /// Name.
        name: String,
        /// The point.
        a: PointSpec,
        /// Number of the cable.
        cable: usize,
        /// Number of the joint among those of its kind.
        slide: usize,
        /// Arc length at the start [m].
        s: f64,
    },
    /// Nodal vectors of surfaces keep components of their differences, as at the start (one equation each).
    Hold {
        /// Name.
        name: String,
        /// First node.
        a: NodeSpec,
        /// Second node; none: the world.
        b: Option<NodeSpec>,
        /// What is held.
        equations: Vec<HoldSpec>,
        /// A point of a rigid body in place of the second node: positions are held against it, slopes against the
        /// body's axes, each in the direction that it has at the start.
        #[serde(default)]
        rigid: Option<PointSpec>,
        /// The angle that two sheets make there, as the joint's freedom.
        #[serde(default)]
        fold: Option<Box<FoldSpec>>,
    },
    /// A point follows a path (3 equations), the tangent of a cable there a direction (2), a rigid body an orientation
    /// (3).
    DrivePoint {
        /// Name.
        name: String,
        /// The point.
        a: PointSpec,
        /// Three components [m].
        position: Option<Signal>,
        /// Three components, of any length.
        direction: Option<Signal>,
        /// The body axes, three components each.
        orientation: Option<Box<[Signal; 3]>>,
    },
    /// The freedom of a hinge or slider follows a course (1 equation).
    DriveJoint {
        /// Name.
        name: String,
        /// Number of the joint.
        joint: usize,
        /// Angle [rad] or way [m], or its rate.
        value: Signal,
        /// Whether the value is the rate, from where the run begins.
        rate: bool,
    },
    /// A rigid body turns about an axis of the world by a given angle (1 equation).
    DriveAxis {
        /// Name.
        name: String,
        /// A point of the body.
        a: PointSpec,
        /// The axis.
        axis: [f64; 3],
        /// Angle [rad], or its rate.
        value: Signal,
        /// Whether the value is the rate.
        rate: bool,
    },
    /// The freedoms of two hinges or sliders are proportional (1 equation).
    Gear {
        /// Name.
        name: String,
        /// Number of the joint whose freedom is `ratio` times the other's.
        joint_a: usize,
        /// Number of the other joint.
        joint_b: usize,
        /// The ratio.
        ratio: f64,
    },
    /// Two points stay a length apart (1 equation).
    Distance {
        /// Name.
        name: String,
        /// First point.
        a: PointSpec,
        /// Second point.
        b: PointSpec,
        /// The length [m].
        length: f64,
    },
}

/// One component of a sum of nodal vectors, with a weight for each at the nodes of a joint.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HoldSpec {
    /// Weights at the first node.
    pub a: Vec<f64>,
    /// Weights at the second node; empty where it is the world.
    #[serde(default)]
    pub b: Vec<f64>,
    /// Direction of the component.
    pub direction: [f64; 3],
}

/// The angle between two sheets at a point of their crease, by three vectors.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FoldSpec {
    /// Along the crease.
    pub along: Vec<NodalSpec>,
    /// Out of the first sheet, across the crease.
    pub out: Vec<NodalSpec>,
    /// Into the second sheet, across the crease.
    pub into: Vec<NodalSpec>,
    /// Of the angles that differ by whole turns the start's is nearest to this [rad].
    #[serde(default)]
    pub near: f64,
}

/// A weighted sum of the nodal vectors of a node.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct NodalSpec {
    /// The node.
    pub at: NodeSpec,
    /// A weight for each nodal vector.
    pub weights: Vec<f64>,
}

/// A node of a surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct NodeSpec {
    /// Number of the surface.
    pub surface: usize,
    /// Number of the node.
    pub node: usize,
}

impl JointSpec {
    /// Whether it is a drive or gear, which is the same whenever it engages.
    #[must_use]
    pub fn is_drive(&self) -> bool {
        matches!(
            self,
            Self::DrivePoint { .. }
                | Self::DriveAxis { .. }
                | Self::DriveJoint { .. }
                | Self::Gear { .. }
        )
    }

    /// Name and points; a clamp's second is where its first starts. Drives and gears between joints, and joints between
    /// nodes, have none.
    #[must_use]
    pub fn points(&self) -> (&str, Option<&PointSpec>, Option<&PointSpec>) {
        match self {
            Self::Hold { name, .. } | Self::DriveJoint { name, .. } | Self::Gear { name, .. } => {
                (name, None, None)
            }
            Self::Clamp { name, a, .. }
            | Self::SlideCable { name, a, .. }
            | Self::DrivePoint { name, a, .. }
            | Self::DriveAxis { name, a, .. } => (name, Some(a), None),
            Self::Pin { name, a, b }
            | Self::Weld { name, a, b }
            | Self::Hinge { name, a, b, .. }
            | Self::Slider { name, a, b, .. }
            | Self::Cylindrical { name, a, b, .. }
            | Self::Universal { name, a, b, .. }
            | Self::SlideLine { name, a, b, .. }
            | Self::Distance { name, a, b, .. } => (name, Some(a), Some(b)),
        }
    }
}

/// A joint that is released and engaged.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LatchSpec {
    /// Number of the joint.
    pub joint: usize,
    /// Whether it holds at the start.
    pub engaged: bool,
    /// Whether one of its points is wherever the other is found when it engages.
    pub floats: bool,
    /// What happens to it.
    pub events: Vec<EventSpec>,
}

/// A joint is released or engaged.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EventSpec {
    /// Time [s].
    pub t: f64,
    /// Engage, or release.
    pub engage: bool,
    /// Largest gap between the points [m]; none: 1e-6 of the model's size.
    pub gap: Option<f64>,
}

/// A load.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub enum LoadSpec {
    /// A force at a point [N].
    Force {
        /// Name.
        name: String,
        /// Where.
        at: PointSpec,
        /// Three components.
        value: Signal,
        /// Turns with the tangent, in the plane of the starting tangent and the starting force, or with the body.
        follower: bool,
    },
    /// A moment at a point of a cable or of a beam, or on a rigid body [N m].
    Moment {
        /// Name.
        name: String,
        /// Where.
        at: PointSpec,
        /// Three components.
        value: Signal,
    },
    /// A pressure on faces of a surface, along the normal of the vertex order [Pa].
    Pressure {
        /// Name.
        name: String,
        /// Number of the surface.
        surface: usize,
        /// Numbers of the faces.
        faces: Array,
        /// One component.
        value: Signal,
        /// The faces are closed, or their rim is held: the pressure has a potential.
        conservative: bool,
    },
    /// A force per stress-free length on sides of faces [N/m].
    Edge {
        /// Name.
        name: String,
        /// Number of the surface.
        surface: usize,
        /// Rows (face, side); side k runs from corner k to the next, (s, 2), whole numbers.
        sides: Array,
        /// Three components.
        value: Signal,
    },
    /// A moment per stress-free length about the direction that each side has at the start [N].
    EdgeMoment {
        /// Name.
        name: String,
        /// Number of the surface.
        surface: usize,
        /// Rows (face, side), (s, 2), whole numbers.
        sides: Array,
        /// One component, about the direction in which the side runs.
        value: Signal,
    },
    /// A force that moves along a cable [N].
    Moving {
        /// Name.
        name: String,
        /// Number of the cable.
        cable: usize,
        /// Three components.
        value: Signal,
        /// Arc length of the stress-free line, one component [m].
        position: Signal,
    },
    /// A force per stress-free length on the centre line of a beam [N/m].
    BeamLine {
        /// Name.
        name: String,
        /// Number of the beam.
        beam: usize,
        /// Three components.
        value: Signal,
    },
    /// A force per stress-free length on all of a cable [N/m].
    Line {
        /// Name.
        name: String,
        /// Number of the cable.
        cable: usize,
        /// Three components.
        value: Signal,
    },
}

/// A force that depends on positions and velocities.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub enum ForceSpec {
    /// A spring and damper between two points.
    Spring {
        /// Name.
        name: String,
        /// First point.
        a: PointSpec,
        /// Second point.
        b: PointSpec,
        /// Stiffness [N/m].
        stiffness: f64,
        /// Damping [N s/m].
        damping: f64,
        /// Stress-free length [m].
        length: f64,
    },
    /// A line without mass through points, pulled at the first and fastened at the last.
    Tendon {
        /// Name.
        name: String,
        /// Two points or more.
        points: Vec<PointSpec>,
        /// What pulls.
        pull: PullSpec,
        /// Coefficient of friction at the points between the ends.
        friction: f64,
        /// Velocity by which friction is smoothed [m/s].
        slip_velocity: f64,
    },
    /// Flow across all elements of a cable.
    Wind {
        /// Name.
        name: String,
        /// Number of the cable.
        cable: usize,
        /// Velocity of the wind, three components [m/s].
        velocity: Signal,
        /// Its direction at the start, from which angles of attack count.
        direction: [f64; 3],
        /// Density of the air [kg/m^3].
        density: f64,
        /// Drag coefficient.
        drag: f64,
        /// Lift coefficient.
        lift: LiftSpec,
        /// Diameter of each element [m].
        diameters: Vec<f64>,
    },
    /// Flow by faces of a surface.
    SheetWind {
        /// Name.
        name: String,
        /// Number of the surface.
        surface: usize,
        /// Numbers of the faces.
        faces: Array,
        /// Velocity of the wind, three components [m/s].
        velocity: Signal,
        /// Density of the fluid [kg/m^3].
        density: f64,
        /// Drag coefficient of flow along the normal.
        drag: f64,
        /// Slope of the lift coefficient over the angle between flow and surface.
        lift: f64,
    },
    /// A rest curvature of faces of a shell that changes in time.
    Curvature {
        /// Name.
        name: String,
        /// Number of the surface.
        surface: usize,
        /// Numbers of the faces.
        faces: Array,
        /// Components (11, 22, 12) in the frame whose first axis is along u [1/m].
        value: Signal,
        /// Whether it never changes.
        steady: bool,
    },
    /// Spring, damper, stops and drive along the freedom of a hinge or slider.
    Joint {
        /// Name.
        name: String,
        /// Number of the joint.
        joint: usize,
        /// Stiffness [N m/rad] or [N/m].
        stiffness: f64,
        /// Damping [N m s/rad] or [N s/m].
        damping: f64,
        /// Angle or way without force of the spring.
        rest: f64,
        /// Stops.
        stops: Option<StopSpec>,
        /// Torque [N m] or force [N].
        drive: Option<Signal>,
    },
}

/// What pulls a tendon.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub enum PullSpec {
    /// A force; below zero it is none.
    Force {
        /// One component [N].
        tension: Signal,
    },
    /// A motor that leaves a stress-free length.
    Motor {
        /// One component [m].
        length: Signal,
        /// Stiffness EA [N].
        stiffness: f64,
        /// Damping [N s/m].
        damping: f64,
    },
}

/// A lift coefficient.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum LiftSpec {
    /// The same at all angles.
    Constant(f64),
    /// By the angle of attack, over a turn.
    Angle {
        /// Angles, ascending [rad].
        angles: Vec<f64>,
        /// Coefficients there.
        coefficients: Vec<f64>,
    },
}

/// Stops of a joint: beyond a limit they push back by `stiffness p max(0, 1 + damping p')`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StopSpec {
    /// Lower limit, if any.
    pub lower: Option<f64>,
    /// Upper limit, if any.
    pub upper: Option<f64>,
    /// Stiffness [N m/rad] or [N/m].
    pub stiffness: f64,
    /// Damping [s/rad] or [s/m].
    pub damping: f64,
}

/// A value over time. Scalars (one number) multiply and add to vectors.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Signal {
    /// The same at all times; scaled by the load factor in statics.
    Constant(Vec<f64>),
    /// Components `first..first + size` of what the caller's function of time returns.
    Input {
        /// First component.
        first: usize,
        /// Number of components.
        size: usize,
    },
    /// Interpolated between rows.
    Table {
        /// Times, (k,), ascending [s].
        times: Vec<f64>,
        /// Values, (k, m), row by row.
        values: Vec<f64>,
        /// Repeats with this period [s].
        period: Option<f64>,
        /// Without jumps of slope (cubic) instead of linear.
        smooth: bool,
    },
    /// 0 before 0, 1 after `duration`, without jumps of slope between.
    Ramp {
        /// Duration [s].
        duration: f64,
    },
    /// Sum of the terms.
    Sum(Vec<Signal>),
    /// Product of the factors.
    Product(Vec<Signal>),
}
