//! Nearest points on a surface of facets.
//!
//! The facets are looked at one by one; those whose bounding sphere is too far away are left out,
//! so the cost grows with their number, but little. Of equally near facets the first counts.

use crate::math::greatest;
use crate::mesh::validity::unit_normal;
use crate::mesh::{Facet, as_element};
use crate::vectors::{Vector, dot, subtract};

/// Facets on points, with a sphere around each.
#[derive(Clone, Copy, Debug)]
pub struct Surface<'a> {
    /// Places.
    pub points: &'a [Vector],
    /// Rows of three points each.
    pub facets: &'a [Facet],
    /// Centre and radius of a sphere around each facet, as [`bounding_spheres`] makes them.
    pub spheres: &'a [[f64; 4]],
}

/// A point of a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Foot {
    /// Where it is.
    pub point: Vector,
    /// How far away it is.
    pub distance: f64,
    /// Row of the facet that it lies on.
    pub facet: usize,
}

impl Surface<'_> {
    /// Whether there is no facet.
    #[inline]
    pub fn is_empty(&self) -> bool {
        self.facets.is_empty()
    }

    /// Nearest point to a place. There is a facet; `guess`, a row of one, is looked at first.
    pub fn nearest(&self, place: Vector, guess: usize) -> Foot {
        let (mut point, mut best) = self.closest_on(guess, place);
        let mut facet = guess;
        let mut reach = best.sqrt();
        for (row, sphere) in self.spheres.iter().enumerate() {
            let away = subtract([sphere[0], sphere[1], sphere[2]], place);
            let limit = reach + sphere[3];
            if dot(away, away) > limit * limit {
                continue;
            }
            let (candidate, squared) = self.closest_on(row, place);
            if squared < best || (squared == best && row < facet) {
                (best, reach, point, facet) = (squared, squared.sqrt(), candidate, row);
            }
        }
        Foot { point, distance: reach, facet }
    }

    /// Nearest points to some places; a place near the one before it is found faster.
    pub fn nearest_to_each(&self, places: &[Vector]) -> Vec<Foot> {
        let mut guess = 0;
        let mut found = Vec::with_capacity(places.len());
        for place in places {
            let foot = self.nearest(*place, guess);
            guess = foot.facet;
            found.push(foot);
        }
        found
    }

    /// Nearest point to a place, and the unit normal of the surface there. There is a facet.
    pub fn foot(&self, place: Vector) -> (Foot, Vector) {
        let foot = self.nearest(place, 0);
        let normal = unit_normal(self.points, as_element(self.facets[foot.facet]));
        (foot, normal)
    }

    #[inline]
    fn closest_on(&self, facet: usize, place: Vector) -> (Vector, f64) {
        let corners = self.facets[facet].map(|node| self.points[node as usize]);
        closest_on_facet(place, corners)
    }
}

/// Closest point of a facet to a place, and its squared distance.
///
/// Ericson, Real-Time Collision Detection (2005), 5.1.5.
#[inline]
pub fn closest_on_facet(p: Vector, corners: [Vector; 3]) -> (Vector, f64) {
    let [a, b, c] = corners;
    let (ab, ac, ap) = (subtract(b, a), subtract(c, a), subtract(p, a));
    let (d1, d2) = (dot(ab, ap), dot(ac, ap));
    let (mut v, mut w) = (0.0, 0.0);
    // d1 - d3 and d2 - d6 are squared lengths: 0 where a side has none
    if !(d1 <= 0.0 && d2 <= 0.0) {
        let bp = subtract(p, b);
        let (d3, d4) = (dot(ab, bp), dot(ac, bp));
        let cp = subtract(p, c);
        let (d5, d6) = (dot(ab, cp), dot(ac, cp));
        let (va, vb, vc) = (d3 * d6 - d5 * d4, d5 * d2 - d1 * d6, d1 * d4 - d3 * d2);
        if d3 >= 0.0 && d4 <= d3 {
            v = 1.0;
        } else if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 && d1 > d3 {
            v = d1 / (d1 - d3);
        } else if d6 >= 0.0 && d5 <= d6 {
            w = 1.0;
        } else if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 && d2 > d6 {
            w = d2 / (d2 - d6);
        } else if va <= 0.0 && d4 >= d3 && d5 >= d6 {
            w = (d4 - d3) / ((d4 - d3) + (d5 - d6));
            v = 1.0 - w;
        } else {
            let total = va + vb + vc;
            (v, w) = (vb / total, vc / total);
        }
    }
    let mut point = [0.0; 3];
    for k in 0..3 {
        point[k] = a[k] + v * ab[k] + w * ac[k];
    }
    let away = subtract(p, point);
    (point, dot(away, away))
}

/// Centre and radius of a sphere around each facet.
pub fn bounding_spheres(points: &[Vector], facets: &[Facet]) -> Vec<[f64; 4]> {
    facets
        .iter()
        .map(|facet| {
            let corners = facet.map(|node| points[node as usize]);
            let [a, b, c] = corners;
            let centre = [0, 1, 2].map(|k| (a[k] + b[k] + c[k]) / 3.0);
            let mut radius = 0.0;
            for corner in corners {
                let away = subtract(corner, centre);
                radius = greatest(radius, dot(away, away));
            }
            [centre[0], centre[1], centre[2], f64::sqrt(radius)]
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn vector() -> impl Strategy<Value = Vector> {
        prop::array::uniform3(-4.0..4.0)
    }

    proptest! {
        #[test]
        fn no_point_of_the_facet_is_nearer(
            p in vector(), corners in prop::array::uniform3(vector()), v in 0.0..1.0, w in 0.0..1.0
        ) {
            let (_, squared) = closest_on_facet(p, corners);
            let (v, w): (f64, f64) = if v + w > 1.0 { (1.0 - v, 1.0 - w) } else { (v, w) };
            let [a, b, c] = corners;
            let other = [0, 1, 2].map(|k: usize| a[k] + v * (b[k] - a[k]) + w * (c[k] - a[k]));
            let away = subtract(p, other);
            prop_assert!(squared <= dot(away, away) + 1e-9);
        }

        #[test]
        fn the_guess_changes_nothing(
            points in prop::collection::vec(vector(), 12), place in vector(), guess in 0usize..4
        ) {
            let facets: Vec<Facet> = (0..4).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
            let spheres = bounding_spheres(&points, &facets);
            let surface = Surface { points: &points, facets: &facets, spheres: &spheres };
            prop_assert_eq!(surface.nearest(place, guess), surface.nearest(place, 0));
        }
    }
}
