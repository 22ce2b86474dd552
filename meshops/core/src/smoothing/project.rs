//! Back to the surface: points that have moved off it come to the nearest place on it.
//!
//! The cost grows with the points, and with the logarithm of the facets of a curved surface.

use crate::surface::FacetTree;
use crate::vectors::{Vector, dot, scale, subtract};

/// What points come back to.
#[derive(Clone, Copy, Debug)]
pub enum Target<'a> {
    /// A plane.
    Plane {
        /// A point of it.
        origin: Vector,
        /// Its unit normal.
        normal: Vector,
    },
    /// Facets.
    Facets(&'a FacetTree),
}

impl Target<'_> {
    /// Bring points to it.
    pub fn project(&self, points: &mut [Vector]) {
        match self {
            Self::Plane { origin, normal } => {
                for point in points {
                    let height = dot(subtract(*point, *origin), *normal);
                    *point = subtract(*point, scale(*normal, height));
                }
            }
            Self::Facets(facets) => {
                for point in points {
                    *point = facets.nearest(*point).point;
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn a_point_on_the_plane_stays(x in -9.0..9.0, y in -9.0..9.0, z in -9.0..9.0) {
            let target = Target::Plane { origin: [1.0, 2.0, 3.0], normal: [0.6, 0.0, 0.8] };
            let mut points = [[x, y, z]];
            target.project(&mut points);
            let [once] = points;
            target.project(&mut points);
            let moved = subtract(points[0], once);
            prop_assert!(dot(moved, moved).sqrt() < 1e-14);
        }
    }
}
