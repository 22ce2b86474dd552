//! The nearest of some edges to each point.
//!
//! Every edge is looked at for every point.

use crate::math::{greatest, least};
use crate::vectors::{Vector, dot, length, scale, subtract};

/// The nearest edge to a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NearestEdge {
    /// How far away it is; infinite where there is none.
    pub distance: f64,
    /// Its row.
    pub edge: usize,
    /// Place of the nearest point on it, from 0 at its start to 1 at its end.
    pub along: f64,
}

/// Find the nearest of some edges to each point; of equally near ones the first.
pub fn nearest_edges(points: &[Vector], starts: &[Vector], ends: &[Vector]) -> Vec<NearestEdge> {
    points
        .iter()
        .map(|point| {
            let mut nearest = NearestEdge { distance: f64::INFINITY, edge: 0, along: 0.0 };
            for (edge, (start, end)) in starts.iter().zip(ends).enumerate() {
                let (way, away) = (subtract(*end, *start), subtract(*point, *start));
                let square = dot(way, way);
                let along = if square > 0.0 {
                    least(greatest(dot(away, way) / square, 0.0), 1.0)
                } else {
                    0.0
                };
                let distance = length(subtract(away, scale(way, along)));
                if distance < nearest.distance {
                    nearest = NearestEdge { distance, edge, along };
                }
            }
            nearest
        })
        .collect()
}
