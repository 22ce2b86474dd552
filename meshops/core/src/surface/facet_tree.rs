//! Nearest points on a surface that is asked many times: a tree of boxes around its facets.
//!
//! A bounding volume hierarchy, halved at the median of the facets' centres along the longest side
//! of each box. Making it costs n log n; a query about log n where the place is near the surface,
//! and that without a guess. It finds what [`Surface::nearest`] finds: of equally near facets the
//! first counts.

use super::Surface;
use super::nearest::{Foot, closest_on_facet};
use crate::math::{greatest, least};
use crate::mesh::validity::unit_normal;
use crate::mesh::{Facet, as_element};
use crate::vectors::Vector;

/// Facets that are not divided any more.
const LEAF: usize = 4;

/// Of the largest coordinate: how much larger the boxes are made, so that rounding hides nothing.
const MARGIN: f64 = 1e-12;

/// A facet, by the places of its corners.
#[derive(Clone, Copy, Debug)]
struct Face {
    corners: [Vector; 3],
    row: usize,
}

/// A box around some facets, that have their places in the tree next to each other.
#[derive(Clone, Copy, Debug)]
struct Bounds {
    low: Vector,
    high: Vector,
}

/// A box, and either the facets in it or two smaller boxes.
#[derive(Clone, Copy, Debug)]
struct Branch {
    bounds: Bounds,
    first: usize,
    last: usize,
    /// The second of the two boxes, the first being the next one; 0 where there are facets.
    second: usize,
}

/// Facets of a surface in a tree of boxes.
#[derive(Clone, Debug)]
pub struct FacetTree {
    faces: Vec<Face>,
    branches: Vec<Branch>,
    /// Unit normals of the facets, by their rows.
    normals: Vec<Vector>,
}

impl Bounds {
    fn around(faces: &[Face], margin: f64) -> Self {
        let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        for corner in faces.iter().flat_map(|face| &face.corners) {
            for k in 0..3 {
                low[k] = least(low[k], corner[k]);
                high[k] = greatest(high[k], corner[k]);
            }
        }
        Self { low: low.map(|x| x - margin), high: high.map(|x| x + margin) }
    }

    /// The axis along which it is longest.
    fn longest(&self) -> usize {
        let [x, y, z] = [0, 1, 2].map(|k| self.high[k] - self.low[k]);
        if x >= y && x >= z { 0 } else { usize::from(z > y) + 1 }
    }

    /// Squared distance of a place from it, a little less than that.
    #[inline]
    fn squared_distance(&self, place: Vector) -> f64 {
        let mut squared = 0.0;
        for k in 0..3 {
            let below = greatest(self.low[k] - place[k], 0.0);
            let beyond = greatest(place[k] - self.high[k], 0.0);
            let away = greatest(below, beyond);
            squared += away * away;
        }
        squared * (1.0 - MARGIN)
    }
}

/// The nearest facet so far.
struct Best {
    squared: f64,
    point: Vector,
    row: usize,
}

impl FacetTree {
    /// Make the tree of a surface; None where it has no facet.
    pub fn new(surface: &Surface<'_>) -> Option<Self> {
        let corners = |facet: &Facet| facet.map(|node| surface.points[node as usize]);
        let facets = surface.facets.iter().map(corners).enumerate();
        let mut faces: Vec<Face> = facets.map(|(row, corners)| Face { corners, row }).collect();
        if faces.is_empty() {
            return None;
        }
        let coordinates = faces.iter().flat_map(|face| face.corners.as_flattened());
        let margin = MARGIN * coordinates.fold(0.0, |most, x| greatest(most, x.abs()));
        let mut branches = Vec::with_capacity(faces.len());
        grow(&mut faces, 0, margin, &mut branches);
        let normal = |facet: &Facet| unit_normal(surface.points, as_element(*facet));
        let normals = surface.facets.iter().map(normal).collect();
        Some(Self { faces, branches, normals })
    }

    /// Unit normal of a facet.
    #[inline]
    pub fn normal(&self, facet: usize) -> Vector {
        self.normals[facet]
    }

    /// Nearest point of the surface to a place.
    pub fn nearest(&self, place: Vector) -> Foot {
        let mut best = Best { squared: f64::INFINITY, point: place, row: usize::MAX };
        self.look(0, place, &mut best);
        if best.row == usize::MAX {
            // nothing is near to a place that is no number
            let face = self.faces.iter().find(|face| face.row == 0).unwrap_or(&self.faces[0]);
            let (point, squared) = closest_on_facet(place, face.corners);
            best = Best { squared, point, row: face.row };
        }
        Foot { point: best.point, distance: best.squared.sqrt(), facet: best.row }
    }

    /// Whether the surface is no farther away from a place than `distance`: faster than to look for
    /// the nearest point, as any that is near enough will do.
    pub fn is_within(&self, place: Vector, distance: f64) -> bool {
        // a little more than rounding can make of it
        let squared = distance * distance * (1.0 + 1e-9);
        distance >= 0.0 && self.is_near(0, place, distance, squared)
    }

    fn is_near(&self, at: usize, place: Vector, distance: f64, squared: f64) -> bool {
        let branch = &self.branches[at];
        if branch.second == 0 {
            return self.faces[branch.first..branch.last]
                .iter()
                .any(|face| closest_on_facet(place, face.corners).1.sqrt() <= distance);
        }
        let children = [at + 1, branch.second];
        let away = children.map(|child| self.branches[child].bounds.squared_distance(place));
        let nearer = usize::from(away[1] < away[0]);
        [nearer, 1 - nearer].into_iter().any(|child| {
            away[child] <= squared && self.is_near(children[child], place, distance, squared)
        })
    }

    fn look(&self, at: usize, place: Vector, best: &mut Best) {
        let branch = &self.branches[at];
        if branch.second == 0 {
            for face in &self.faces[branch.first..branch.last] {
                let (point, squared) = closest_on_facet(place, face.corners);
                if squared < best.squared || (squared == best.squared && face.row < best.row) {
                    *best = Best { squared, point, row: face.row };
                }
            }
            return;
        }
        let children = [at + 1, branch.second];
        let away = children.map(|child| self.branches[child].bounds.squared_distance(place));
        let nearer = usize::from(away[1] < away[0]);
        for child in [nearer, 1 - nearer] {
            if away[child] <= best.squared {
                self.look(children[child], place, best);
            }
        }
    }
}

/// Add the branch of some faces, whose first has the place `first` in the tree.
fn grow(faces: &mut [Face], first: usize, margin: f64, branches: &mut Vec<Branch>) {
    let (at, count) = (branches.len(), faces.len());
    let bounds = Bounds::around(faces, margin);
    branches.push(Branch { bounds, first, last: first + count, second: 0 });
    if count <= LEAF {
        return;
    }
    let axis = bounds.longest();
    let middle = |face: &Face| {
        let [a, b, c] = face.corners;
        a[axis] + b[axis] + c[axis]
    };
    let half = count / 2;
    faces.select_nth_unstable_by(half, |one, other| {
        middle(one).total_cmp(&middle(other)).then(one.row.cmp(&other.row))
    });
    let (near, far) = faces.split_at_mut(half);
    grow(near, first, margin, branches);
    branches[at].second = branches.len();
    grow(far, first + half, margin, branches);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::nearest::bounding_spheres;
    use proptest::prelude::*;

    /// Places on a lattice, so that many are equally near.
    fn places(count: std::ops::Range<usize>) -> impl Strategy<Value = Vec<Vector>> {
        let place = prop::array::uniform3((-4i32..4).prop_map(|x| f64::from(x) * 0.5));
        prop::collection::vec(place, count)
    }

    proptest! {
        #[test]
        fn finds_what_the_surface_finds(
            points in places(3..90), queries in places(1..20), noise in -0.3..0.3
        ) {
            let facets: Vec<Facet> =
                (0..points.len() as i32 / 3).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
            let spheres = bounding_spheres(&points, &facets);
            let surface = Surface { points: &points, facets: &facets, spheres: &spheres };
            let tree = FacetTree::new(&surface).expect("there are facets");
            for place in queries.into_iter().flat_map(|p| [p, p.map(|x| x + noise)]) {
                let (found, plain) = (tree.nearest(place), surface.nearest(place, 0));
                prop_assert_eq!(found.distance, plain.distance);
                // where rounding hides one of two equally near facets from the plain search
                prop_assert!(found.facet <= plain.facet);
                prop_assert!(tree.is_within(place, found.distance));
                let less = found.distance * (1.0 - 1e-15);
                prop_assert_eq!(tree.is_within(place, less), less >= found.distance);
            }
        }
    }

    #[test]
    fn a_place_that_is_no_number_finds_the_first_facet() {
        let points = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
        let surface = Surface { points: &points, facets: &[[0, 1, 2]], spheres: &[[0.0; 4]] };
        let tree = FacetTree::new(&surface).expect("there is a facet");
        assert_eq!(tree.nearest([f64::NAN; 3]).facet, 0);
        assert_eq!(tree.normal(0), [0.0, 0.0, 1.0]);
    }
}
