//! Areas of a surface, and whether it is plane.

use crate::math::{greatest, least};
use crate::mesh::{Facet, as_element};
use crate::vectors::{Vector, add, area_vector, dot, length, subtract};

/// The area of a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Area {
    /// Sum of the area vectors of the facets.
    pub vector: Vector,
    /// Sum of their areas.
    pub size: f64,
}

/// What a surface looks like as a whole.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plane {
    /// Its area.
    pub area: Area,
    /// Unit normal; 0 where there is none.
    pub normal: Vector,
    /// Whether it is plane.
    pub is_plane: bool,
}

/// Add up the areas of facets.
pub fn areas_of(points: &[Vector], facets: &[Facet]) -> Area {
    let mut area = Area { vector: [0.0; 3], size: 0.0 };
    for facet in facets {
        let v = area_vector(points, as_element(*facet));
        area.vector = add(area.vector, v);
        area.size += length(v);
    }
    area
}

/// Find the plane of a surface.
///
/// It is plane where all points are nearer to one plane than `tolerance` times their extent, and
/// all facets look the same way.
pub fn plane_of(points: &[Vector], facets: &[Facet], tolerance: f64) -> Plane {
    let area = areas_of(points, facets);
    let size = length(area.vector);
    if size <= 0.0 {
        return Plane { area, normal: area.vector, is_plane: false };
    }
    let normal = area.vector.map(|x| x / size);
    let limit = tolerance * extent(points);
    let is_flat = points.iter().all(|point| {
        let offset = dot(subtract(*point, points[0]), normal);
        // not `<=`: a place that is NaN is nowhere beyond
        let beyond = offset.abs() > limit;
        !beyond
    });
    let is_facing = facets.iter().all(|facet| {
        let against = dot(area_vector(points, as_element(*facet)), normal) <= 0.0;
        !against
    });
    Plane { area, normal, is_plane: is_flat && is_facing }
}

/// Longest side of the box around some points; there is one.
pub fn extent(points: &[Vector]) -> f64 {
    let (mut low, mut high, mut is_nan) = (points[0], points[0], [false; 3]);
    for point in points {
        for k in 0..3 {
            low[k] = least(low[k], point[k]);
            high[k] = greatest(high[k], point[k]);
            is_nan[k] |= point[k].is_nan();
        }
    }
    let mut extent = 0.0;
    for k in 0..3 {
        // an axis with a place that is NaN has none
        if !is_nan[k] {
            extent = greatest(extent, high[k] - low[k]);
        }
    }
    extent
}
