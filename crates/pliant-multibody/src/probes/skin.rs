//! A surface that probes touch: its faces as Bezier nets, where its rims are, and the feet of points on it.

use super::sheet::Face;
use crate::surface_map::SurfaceMap;
use crate::vector::vector;
use nalgebra::{DMatrix, Vector3};
use pliant_contact::broad_phase::Box3;
use pliant_contact::net::{EXPONENTS, Feature, Form, Jet, Nearest, Net, POINTS};
use pliant_elements::SurfaceKind;
use std::collections::HashMap;

/// Nodal vectors of a face, at most.
pub(crate) const VECTORS: usize = 16;
/// Part of a distance within which two are equal.
const SAME: f64 = 1e-9;

/// One net of a face, in terms of its nodal vectors.
#[derive(Clone, Debug)]
struct Patch {
    form: Form,
    /// Weights of the nodal vectors in each control point.
    rows: Vec<Vec<(usize, f64)>>,
    /// Which side of the face each of its own is; none: it lies inside.
    outer: [Option<usize>; 4],
}

#[derive(Clone, Debug)]
struct Plate {
    patches: Vec<Patch>,
    nodes: Vec<usize>,
    /// Sides and corners on a rim.
    rims: [[bool; 4]; 2],
}

/// All faces of a surface.
#[derive(Clone, Debug)]
pub(crate) struct Skin {
    /// Faces with their coordinates, thickness and probes.
    pub faces: Vec<Face>,
    plates: Vec<Plate>,
    /// First net of each face.
    first: Vec<usize>,
    /// Free of stress.
    pub reference: Posed,
    /// Stress-free places of the probes.
    pub places: Vec<Vec<Vector3<f64>>>,
}

/// The nets of a surface at some coordinates, face by face, and boxes that hold the faces.
#[derive(Clone, Debug, Default)]
pub(crate) struct Posed {
    pub nets: Vec<Net>,
    pub boxes: Vec<Box3>,
}

/// Where a foot lies among the faces.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Spot {
    /// Inside of a face.
    Inside,
    /// On a side between two nodes; whether it is a rim.
    Side([usize; 2], bool),
    /// On a node; whether at a rim.
    Corner(usize, bool),
}

/// A foot of a point.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Foot {
    pub face: usize,
    /// Number of its net among all.
    pub net: usize,
    pub at: [f64; 2],
    pub feature: Feature,
    pub spot: Spot,
    pub jet: Jet,
    /// How far the point is [m].
    pub distance: f64,
    /// Normal of the face, or the sum of those of all faces that meet there.
    pub upright: Vector3<f64>,
}

/// Whether a point is within a margin of a box.
pub(crate) fn holds(hull: &Box3, p: Vector3<f64>, margin: f64) -> bool {
    (0..3).all(|k| hull.low[k] - margin <= p[k] && p[k] <= hull.high[k] + margin)
}

/// Squared distance of a point from a box.
fn apart(hull: &Box3, p: Vector3<f64>) -> f64 {
    let out = |k: usize| (hull.low[k] - p[k]).max(p[k] - hull.high[k]).max(0.0);
    (0..3).map(|k| out(k).powi(2)).sum()
}

/// A net of an element: its form, the places in the element's parameters that its control points stand for, and which
/// side of the face each of its sides is, if any.
type Layout = (Form, Vec<[f64; 2]>, [Option<usize>; 4]);

/// The nets that make up an element.
fn layout(kind: SurfaceKind) -> Vec<Layout> {
    let all = |form: Form| (0..form.points()).map(|k| form.place(k)).collect::<Vec<_>>();
    match kind {
        SurfaceKind::Triangle => {
            let corners = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]];
            let center = [1.0 / 3.0; 2];
            let part = |k: usize| {
                let (a, b) = (corners[(k + 1) % 3], corners[(k + 2) % 3]);
                let places = EXPONENTS.iter().map(|e| {
                    let w = e.map(|e| e as f64 / 3.0);
                    [0, 1].map(|c| w[0] * a[c] + w[1] * b[c] + w[2] * center[c])
                });
                // Its side 0 lies between corners k + 1 and k + 2 of the face.
                (Form::Triangle, places.collect(), [Some((k + 1) % 3), None, None, None])
            };
            (0..3).map(part).collect()
        }
        SurfaceKind::TriangleMembrane => {
            vec![(Form::Triangle, all(Form::Triangle), [Some(0), Some(1), Some(2), None])]
        }
        _ => vec![(Form::Square, all(Form::Square), [Some(0), Some(1), Some(2), Some(3)])],
    }
}

/// Number of the node's corner in a net's own corner, on the sides that are the face's.
fn corner_of(
    outer: &[Option<usize>; 4],
    corner: usize,
    sides: usize,
    corners: usize,
) -> Option<usize> {
    match outer[corner] {
        Some(side) => Some(side),
        // Where the side before ends.
        None => outer[(corner + sides - 1) % sides].map(|side| (side + 1) % corners),
    }
}

impl Skin {
    /// The faces of a surface; `thickness` is one number or one for each.
    pub(crate) fn of(map: &SurfaceMap, thickness: &[f64]) -> Self {
        let faces = Face::all(map, thickness);
        let mut uses: HashMap<[usize; 2], usize> = HashMap::new();
        let key = |a: usize, b: usize| [a.min(b), a.max(b)];
        for face in &map.faces {
            let n = face.nodes.len();
            for k in 0..n {
                *uses.entry(key(face.nodes[k], face.nodes[(k + 1) % n])).or_default() += 1;
            }
        }
        let mut on_rim = vec![false; map.nodes];
        for ([a, b], count) in &uses {
            if *count == 1 {
                (on_rim[*a], on_rim[*b]) = (true, true);
            }
        }
        let mut plates = Vec::with_capacity(map.faces.len());
        for face in &map.faces {
            let patches = layout(face.kind).into_iter().map(|(form, places, outer)| {
                let n = form.points();
                let mut basis = DMatrix::zeros(n, n);
                let mut values = DMatrix::zeros(n, face.kind.vectors());
                for (row, &at) in places.iter().enumerate() {
                    let b = form.basis(form.place(row));
                    (0..n).for_each(|k| basis[(row, k)] = b[0][k]);
                    let jets = face.kind.shape(&face.chart, at);
                    jets.iter().enumerate().for_each(|(i, jet)| values[(row, i)] = jet.value);
                }
                let weights = basis.lu().solve(&values).unwrap_or(values);
                let rows = weights.row_iter().map(|row| {
                    let most = row.amax();
                    let terms = row.iter().copied().enumerate();
                    terms.filter(|(_, w)| w.abs() > 1e-14 * most).collect()
                });
                Patch { form, rows: rows.collect(), outer }
            });
            let n = face.nodes.len();
            let mut rims = [[false; 4]; 2];
            for k in 0..n {
                rims[0][k] = uses[&key(face.nodes[k], face.nodes[(k + 1) % n])] == 1;
                rims[1][k] = on_rim[face.nodes[k]];
            }
            plates.push(Plate { patches: patches.collect(), nodes: face.nodes.clone(), rims });
        }
        let mut first = Vec::with_capacity(plates.len());
        let mut count = 0;
        for plate in &plates {
            first.push(count);
            count += plate.patches.len();
        }
        let mut this =
            Self { faces, plates, first, reference: Posed::default(), places: Vec::new() };
        let vectors = |k: usize| -> Vec<Vector3<f64>> {
            map.reference_of(&map.faces[k]).into_iter().map(vector).collect()
        };
        let mut reference = Posed::default();
        this.pose(&mut reference, |face, i| vectors(face)[i]);
        this.reference = reference;
        this.places = (0..this.faces.len())
            .map(|k| {
                let x = vectors(k);
                let sum = |w: &[f64]| w.iter().zip(&x).map(|(w, x)| x * *w).sum();
                this.faces[k].rule.iter().map(|(w, _)| sum(w)).collect()
            })
            .collect();
        this
    }

    fn pose(&self, posed: &mut Posed, vector: impl Fn(usize, usize) -> Vector3<f64>) {
        posed.nets.clear();
        posed.boxes.clear();
        for (k, plate) in self.plates.iter().enumerate() {
            let mut hull = Box3 { low: [f64::INFINITY; 3], high: [f64::NEG_INFINITY; 3] };
            for patch in &plate.patches {
                let mut points = [Vector3::zeros(); POINTS];
                for (point, row) in points.iter_mut().zip(&patch.rows) {
                    *point = row.iter().map(|&(i, w)| vector(k, i) * w).sum();
                }
                let net = Net::new(patch.form, points);
                let own = net.hull(0.0);
                for c in 0..3 {
                    hull.low[c] = hull.low[c].min(own.low[c]);
                    hull.high[c] = hull.high[c].max(own.high[c]);
                }
                posed.nets.push(net);
            }
            posed.boxes.push(hull);
        }
    }

    /// Takes its nets to coordinates `q`.
    pub(crate) fn at(&self, q: &[f64], posed: &mut Posed) {
        self.pose(posed, |face, i| {
            let o = self.faces[face].offsets[i];
            Vector3::new(q[o], q[o + 1], q[o + 2])
        });
    }

    /// Nets of a face.
    pub(crate) fn nets_of(&self, face: usize) -> std::ops::Range<usize> {
        self.first[face]..self.first[face] + self.plates[face].patches.len()
    }

    /// Weights of the nodal vectors of a face in r, r_u and r_v at a place of one of its nets.
    pub(crate) fn weights(&self, face: usize, net: usize, at: [f64; 2]) -> [[f64; 3]; VECTORS] {
        let patch = &self.plates[face].patches[net - self.first[face]];
        let basis = patch.form.basis(at);
        let mut out = [[0.0; 3]; VECTORS];
        for (k, row) in patch.rows.iter().enumerate() {
            for &(i, w) in row {
                for d in 0..3 {
                    out[i][d] += basis[d][k] * w;
                }
            }
        }
        out
    }

    /// Faces that share a node with each face.
    pub(crate) fn neighbours(&self) -> Vec<Vec<usize>> {
        let mut at_node: HashMap<usize, Vec<usize>> = HashMap::new();
        for (k, plate) in self.plates.iter().enumerate() {
            for &node in &plate.nodes {
                at_node.entry(node).or_default().push(k);
            }
        }
        let around = |plate: &Plate| {
            let mut all: Vec<usize> =
                plate.nodes.iter().flat_map(|node| at_node[node].iter().copied()).collect();
            all.sort_unstable();
            all.dedup();
            all
        };
        self.plates.iter().map(around).collect()
    }

    fn spot(&self, face: usize, net: usize, feature: Feature) -> Spot {
        let plate = &self.plates[face];
        let patch = &plate.patches[net - self.first[face]];
        let (n, sides) = (plate.nodes.len(), if patch.form == Form::Square { 4 } else { 3 });
        match feature {
            Feature::Inside => Spot::Inside,
            Feature::Side(k) => patch.outer[k].map_or(Spot::Inside, |k| {
                Spot::Side([plate.nodes[k], plate.nodes[(k + 1) % n]], plate.rims[0][k])
            }),
            Feature::Corner(k) => corner_of(&patch.outer, k, sides, n)
                .map_or(Spot::Inside, |k| Spot::Corner(plate.nodes[k], plate.rims[1][k])),
        }
    }

    fn foot(&self, face: usize, net: usize, found: Nearest) -> Foot {
        Foot {
            face,
            net,
            at: found.at,
            feature: found.feature,
            spot: self.spot(face, net, found.feature),
            jet: found.jet,
            distance: found.square.sqrt(),
            upright: found.jet.normal(),
        }
    }

    /// The foot of `p` on one face.
    pub(crate) fn foot_on(&self, posed: &Posed, face: usize, p: Vector3<f64>) -> Option<Foot> {
        let nets = self.nets_of(face).map(|net| (net, posed.nets[net].nearest(p)));
        let nearest = nets.min_by(|a, b| a.1.square.total_cmp(&b.1.square));
        nearest.map(|(net, found)| self.foot(face, net, found))
    }

    /// The foot of a point at `p` that goes on from the nearest one where it `was`, on the same net, where that may be near
    /// it more than once. Which of two is nearer turns about as the point moves to and fro between them, and with it the
    /// direction of the force: within a step one counts.
    pub(crate) fn followed(
        &self,
        [before, now]: [&Posed; 2],
        [was, p]: [Vector3<f64>; 2],
        foot: &Foot,
    ) -> Option<Foot> {
        if foot.spot != Spot::Inside || !foot.jet.is_sharp(p) {
            return None;
        }
        let then = before.nets[foot.net].nearest(was);
        let here = now.nets[foot.net].nearest_from(p, then.at);
        let inside = then.feature == Feature::Inside && here.feature == Feature::Inside;
        inside.then(|| self.foot(foot.face, foot.net, here))
    }

    /// The foot of `p` on a face among the places that `wanted` says yes to, where one lies inside.
    pub(crate) fn other_foot(
        &self,
        posed: &Posed,
        face: usize,
        p: Vector3<f64>,
        wanted: impl Fn(Vector3<f64>) -> bool,
    ) -> Option<Foot> {
        const FINE: usize = 6;
        let mut best: Option<(f64, usize, [f64; 2])> = None;
        for net in self.nets_of(face) {
            let (now, free) = (&posed.nets[net], &self.reference.nets[net]);
            for i in 0..=FINE {
                let last = if now.form() == Form::Square { FINE } else { FINE - i };
                for j in 0..=last {
                    let at = [i as f64 / FINE as f64, j as f64 / FINE as f64];
                    let far = (now.jet(at).r - p).norm_squared();
                    if best.is_none_or(|b| far < b.0) && wanted(free.jet(at).r) {
                        best = Some((far, net, at));
                    }
                }
            }
        }
        let (_, net, at) = best?;
        let foot = self.foot(face, net, posed.nets[net].nearest_from(p, at));
        (foot.spot == Spot::Inside && wanted(self.place(&foot))).then_some(foot)
    }

    /// Where a foot lies on the stress-free surface.
    pub(crate) fn place(&self, foot: &Foot) -> Vector3<f64> {
        self.reference.nets[foot.net].jet(foot.at).r
    }

    fn has(&self, face: usize, nodes: &[usize]) -> bool {
        nodes.iter().all(|node| self.plates[face].nodes.contains(node))
    }

    /// All feet of `p` within a distance on some faces: places where the surface is nearer than around them. What lies on
    /// a side or corner counts where no face that meets there is nearer, and once.
    pub(crate) fn feet(
        &self,
        posed: &Posed,
        faces: &[usize],
        (p, range): (Vector3<f64>, f64),
        out: &mut Vec<Foot>,
    ) {
        out.clear();
        for &face in faces {
            if holds(&posed.boxes[face], p, range) {
                out.extend(self.foot_on(posed, face, p).filter(|foot| foot.distance <= range));
            }
        }
        if out.len() < 2 {
            return;
        }
        let all = std::mem::take(out);
        for (k, foot) in all.iter().enumerate() {
            let nodes: &[usize] = match &foot.spot {
                Spot::Inside => &[],
                Spot::Side(nodes, _) => nodes,
                Spot::Corner(node, _) => std::slice::from_ref(node),
            };
            let mut foot = *foot;
            let mut keep = true;
            if !nodes.is_empty() {
                let slack = SAME * (foot.distance + foot.jet.slopes[0].norm());
                for (l, other) in all.iter().enumerate() {
                    if l == k || !self.has(other.face, nodes) {
                        continue;
                    }
                    if other.distance < foot.distance - slack {
                        keep = false;
                    } else if (other.jet.r - foot.jet.r).norm() <= slack {
                        keep &= k < l && other.spot != Spot::Inside;
                        foot.upright += other.jet.normal();
                    }
                }
            }
            if keep {
                out.push(foot);
            }
        }
    }

    /// The foot nearest to `p` among some faces.
    pub(crate) fn nearest(&self, posed: &Posed, faces: &[usize], p: Vector3<f64>) -> Option<Foot> {
        let mut order: Vec<(f64, usize)> =
            faces.iter().map(|&face| (apart(&posed.boxes[face], p), face)).collect();
        order.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
        let mut best: Option<Foot> = None;
        let mut least = f64::INFINITY;
        let mut all = Vec::new();
        for (far, face) in order {
            if far > least * least * (1.0 + 2.0 * SAME) {
                break;
            }
            if let Some(foot) = self.foot_on(posed, face, p) {
                least = least.min(foot.distance);
                all.push(foot);
            }
        }
        for foot in &all {
            if best.is_none_or(|b| foot.distance < b.distance) {
                best = Some(*foot);
            }
        }
        if let Some(best) = &mut best
            && best.spot != Spot::Inside
        {
            let slack = SAME * (best.distance + best.jet.slopes[0].norm());
            for other in &all {
                if other.face != best.face && (other.jet.r - best.jet.r).norm() <= slack {
                    best.upright += other.jet.normal();
                }
            }
        }
        best
    }
}
