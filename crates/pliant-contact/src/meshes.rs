//! Triangle meshes as shapes: the signed distance to an oriented surface, closed or open.
//!
//! The nearest point comes from parry; which side of the surface a point is on, from the pseudo-normal there (Baerentzen
//! & Aanaes 2005). Beside the rim of an open surface there is no inside.

use crate::shapes::Distance;
use nalgebra::{Matrix3, Vector3};
use parry3d_f64::math::Vector;
use parry3d_f64::query::PointQueryWithLocation;
use parry3d_f64::shape::{TriMesh, TriMeshFlags, TrianglePointLocation};
use std::collections::HashMap;
use std::sync::Arc;

/// A triangle mesh in its own frame.
#[derive(Clone)]
pub struct Mesh {
    tree: Arc<TriMesh>,
    /// Whether a vertex lies on the rim, and for each triangle whether its sides do.
    rim: Arc<(Vec<bool>, Vec<[bool; 3]>)>,
    half: [f64; 3],
    convex: bool,
}

impl PartialEq for Mesh {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.tree, &other.tree)
    }
}

impl std::fmt::Debug for Mesh {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Mesh of {} triangles", self.tree.indices().len())
    }
}

fn vector(v: Vector) -> Vector3<f64> {
    Vector3::new(v.x, v.y, v.z)
}

/// Products of triangles and vertices up to which a mesh is asked whether it is convex: some tenths of a second.
const ASKED: usize = 1 << 28;
/// Height over a face, in half extents, that is rounding.
const FLAT: f64 = 1e-13;

/// Whether no vertex of a closed mesh is above any of its faces, but for rounding of coordinates up to `size`.
fn is_convex(tree: &TriMesh, size: f64) -> bool {
    let (vertices, triangles) = (tree.vertices(), tree.indices());
    let asked = vertices.len().saturating_mul(triangles.len()) <= ASKED;
    asked
        && triangles.iter().all(|t| {
            let [a, b, c] = t.map(|k| vector(vertices[k as usize]));
            let (u, w) = (b - a, c - a);
            let n = u.cross(&w);
            // Rounding of the normal is that of a product of both sides.
            let slack = FLAT * size * (n.norm() + u.norm() * w.norm());
            vertices.iter().all(|&v| n.dot(&(vector(v) - a)) <= slack)
        })
}

impl Mesh {
    /// A mesh of `points` [m] and `triangles`, outwards where these go counter-clockwise; none where it has no
    /// triangles or one names a point that is not there.
    #[must_use]
    pub fn new(points: &[[f64; 3]], triangles: &[[u32; 3]]) -> Option<Self> {
        if triangles.iter().flatten().any(|&i| i as usize >= points.len()) {
            return None;
        }
        let vertices = points.iter().map(|&p| Vector::from_array(p)).collect();
        let flags = TriMeshFlags::ORIENTED;
        let tree = TriMesh::with_flags(vertices, triangles.to_vec(), flags).ok()?;
        let mut uses: HashMap<(u32, u32), u32> = HashMap::new();
        let sides = |t: &[u32; 3]| [0, 1, 2].map(|k| (t[k], t[(k + 1) % 3]));
        let key = |(a, b): (u32, u32)| (a.min(b), a.max(b));
        for side in tree.indices().iter().flat_map(sides) {
            *uses.entry(key(side)).or_default() += 1;
        }
        let mut vertex = vec![false; tree.vertices().len()];
        let mut edges = Vec::with_capacity(tree.indices().len());
        for t in tree.indices() {
            let open = sides(t).map(|side| uses[&key(side)] == 1);
            for (k, side) in sides(t).into_iter().enumerate() {
                if open[k] {
                    vertex[side.0 as usize] = true;
                    vertex[side.1 as usize] = true;
                }
            }
            edges.push(open);
        }
        let half = [0, 1, 2].map(|k| points.iter().fold(0.0, |m, p| f64::max(m, p[k].abs())));
        let closed = uses.values().all(|&count| count == 2);
        let convex = closed && is_convex(&tree, half.iter().fold(0.0, |m, x| f64::max(m, *x)));
        Some(Self { tree: Arc::new(tree), rim: Arc::new((vertex, edges)), half, convex })
    }

    /// Whether it is known to be the hull of a convex body.
    #[must_use]
    pub fn is_convex(&self) -> bool {
        self.convex
    }

    /// Its vertices [m].
    #[must_use]
    pub fn vertices(&self) -> Vec<Vector3<f64>> {
        self.tree.vertices().iter().map(|&v| vector(v)).collect()
    }

    /// Half of the edges of a box about the origin that holds it [m].
    #[must_use]
    pub fn half_extent(&self) -> [f64; 3] {
        self.half
    }

    /// Signed distance of `q`.
    #[must_use]
    pub fn distance(&self, q: Vector3<f64>) -> Distance {
        let point = Vector::new(q.x, q.y, q.z);
        let (near, (t, location)) = self.tree.project_local_point_and_get_location(point, false);
        let corners = self.tree.indices()[t as usize];
        let at = |k: usize| vector(self.tree.vertices()[corners[k] as usize]);
        let face = (at(1) - at(0)).cross(&(at(2) - at(0)));
        let d = q - vector(near.point);
        let length = d.norm();
        // What may vary while the nearest point stays on its edge or vertex.
        let (on_rim, space) = match location {
            TrianglePointLocation::OnVertex(k) => {
                (self.rim.0[corners[k as usize] as usize], Matrix3::identity())
            }
            TrianglePointLocation::OnEdge(k, _) => {
                let k = k as usize;
                let a = (at((k + 1) % 3) - at(k)).normalize();
                (self.rim.1[t as usize][k], Matrix3::identity() - a * a.transpose())
            }
            _ => (false, Matrix3::zeros()),
        };
        let scale = self.half.iter().fold(0.0_f64, |m, x| m.max(*x));
        if length <= 1e-14 * scale {
            let normal = face.try_normalize(0.0).unwrap_or_else(Vector3::z);
            return Distance { value: 0.0, normal, hessian: Matrix3::zeros() };
        }
        let sign = if near.is_inside && !on_rim { -1.0 } else { 1.0 };
        let normal = d * (sign / length);
        let hessian = if space == Matrix3::zeros() {
            space
        } else {
            (space - normal * normal.transpose()) * (sign / length)
        };
        Distance { value: sign * length, normal, hessian }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shapes::Shape;
    use proptest::prelude::*;

    fn cube() -> Mesh {
        let points: Vec<[f64; 3]> =
            (0..8).map(|i| [0, 1, 2].map(|k| if i >> k & 1 == 1 { 0.5 } else { -0.5 })).collect();
        let quads =
            [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let triangles: Vec<[u32; 3]> =
            quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
        Mesh::new(&points, &triangles).unwrap()
    }

    proptest! {
        #[test]
        fn a_cube_of_triangles_is_a_box(q in prop::array::uniform3(-1.0..1.0_f64)) {
            let q = Vector3::from(q);
            let (mesh, solid) = (cube().distance(q), Shape::Box { half: [0.5; 3] }.distance(q));
            // Rounding; where two faces are as near the normals may differ.
            prop_assert!((mesh.value - solid.value).abs() < 1e-12);
            let kink = (q.abs() - Vector3::repeat(q.amax())).map(f64::abs);
            if solid.value > 1e-3 || kink.iter().filter(|x| **x < 1e-3).count() == 1 {
                prop_assert!((mesh.normal - solid.normal).norm() < 1e-9);
                prop_assert!((mesh.hessian - solid.hessian).norm() < 1e-6);
            }
        }
    }

    #[test]
    fn only_hulls_are_convex() {
        assert!(cube().is_convex());
        // A tetrahedron, and the same with its face z = 0 pushed in, or open.
        let points = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
        assert!(Mesh::new(&points, &faces).unwrap().is_convex());
        assert!(!Mesh::new(&points, &faces[..3]).unwrap().is_convex());
        let dented: Vec<[f64; 3]> = points.into_iter().chain([[0.2, 0.2, 0.1]]).collect();
        let faces = [[0, 2, 4], [2, 1, 4], [1, 0, 4], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
        assert!(!Mesh::new(&dented, &faces).unwrap().is_convex());
        // Turned inside out its inside is all around.
        let faces = [[0, 1, 2], [0, 3, 1], [1, 3, 2], [2, 3, 0]];
        assert!(!Mesh::new(&points, &faces).unwrap().is_convex());
    }

    #[test]
    fn beside_a_rim_there_is_no_inside() {
        let sheet = Mesh::new(
            &[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]],
            &[[0, 1, 2], [0, 2, 3]],
        )
        .unwrap();
        assert!(sheet.distance(Vector3::new(0.3, 0.4, -0.1)).value < 0.0);
        assert!(sheet.distance(Vector3::new(1.5, 0.5, -0.1)).value > 0.0);
        assert!(Mesh::new(&[[0.0; 3]], &[[0, 1, 2]]).is_none());
    }
}
