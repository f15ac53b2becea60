//! The tree of boxes that finds pairs of neighbours. parry is named here, in `meshes` and `manifolds`; what crosses is
//! `[f64; 3]`: its vectors are of another crate than ours.

use parry3d_f64::bounding_volume::Aabb;
use parry3d_f64::math::Vector;
use parry3d_f64::partitioning::{Bvh, BvhBuildStrategy};

/// A box along the axes: its lowest and its highest corner [m].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Box3 {
    /// Lowest coordinates.
    pub low: [f64; 3],
    /// Highest coordinates.
    pub high: [f64; 3],
}

impl Box3 {
    /// The box of some points, grown by `margin` on all sides.
    #[must_use]
    pub fn around(points: &[[f64; 3]], margin: f64) -> Self {
        let mut this = Self { low: [f64::INFINITY; 3], high: [f64::NEG_INFINITY; 3] };
        for p in points {
            for k in 0..3 {
                this.low[k] = this.low[k].min(p[k] - margin);
                this.high[k] = this.high[k].max(p[k] + margin);
            }
        }
        this
    }

    /// Whether the two share a point.
    #[must_use]
    pub fn meets(&self, other: &Self) -> bool {
        (0..3).all(|k| self.low[k] <= other.high[k] && other.low[k] <= self.high[k])
    }

    fn aabb(&self) -> Aabb {
        Aabb::new(Vector::from_array(self.low), Vector::from_array(self.high))
    }
}

/// All pairs i < j of boxes that meet and that `wanted` asks for, sorted.
pub fn pairs(boxes: &[Box3], mut wanted: impl FnMut(u32, u32) -> bool) -> Vec<(u32, u32)> {
    let mut found = Vec::new();
    if boxes.len() < 2 {
        return found;
    }
    let leaves: Vec<Aabb> = boxes.iter().map(Box3::aabb).collect();
    let tree = Bvh::from_leaves(BvhBuildStrategy::Binned, &leaves);
    for (i, leaf) in leaves.iter().enumerate() {
        let i = i as u32;
        found.extend(tree.intersect_aabb(leaf).filter(|&j| i < j && wanted(i, j)).map(|j| (i, j)));
    }
    found.sort_unstable();
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn all_pairs_are_found(points in prop::collection::vec(prop::array::uniform3(-1.0..1.0_f64), 2..60), size in 0.01..0.4_f64) {
            let boxes: Vec<Box3> = points.iter().map(|&p| Box3::around(&[p], size)).collect();
            let mut expected = Vec::new();
            for i in 0..boxes.len() {
                for j in i + 1..boxes.len() {
                    if boxes[i].meets(&boxes[j]) {
                        expected.push((i as u32, j as u32));
                    }
                }
            }
            prop_assert_eq!(pairs(&boxes, |_, _| true), expected);
        }
    }
}
