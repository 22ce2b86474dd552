//! Skew: 90 degrees less the smallest angle between lines through an element.

use super::corners::{QuadSides, TriaSides};
use crate::math::{asin, degrees, greatest_of, least};
use crate::vectors::{Vector, dot, length, subtract};

/// Of a tria: between the median of a corner and the line of its mid-sides.
#[inline]
pub fn of_tria(sides: &TriaSides) -> f64 {
    let TriaSides { ab, bc, ca, .. } = *sides;
    let [lab, lbc, lca] = sides.lengths;
    let cosine = greatest_of([
        median_cosine(ca, ab, bc, lbc),
        median_cosine(ab, bc, ca, lca),
        median_cosine(bc, ca, ab, lab),
    ]);
    degrees(asin(least(1.0, cosine)))
}

/// Of a quad: between the lines of its mid-sides.
#[inline]
pub fn of_quad(sides: &QuadSides) -> f64 {
    // twice the mid-side lines
    let (along, across) = (subtract(sides.ab, sides.cd), subtract(sides.bc, sides.da));
    let lengths = length(along) * length(across);
    let cosine = if lengths > 0.0 { dot(along, across).abs() / lengths } else { 1.0 };
    degrees(asin(least(1.0, cosine)))
}

/// Cosine between a corner's median and the line of its mid-sides, parallel to the far edge.
#[inline]
fn median_cosine(into: Vector, out: Vector, opposite: Vector, far_length: f64) -> f64 {
    let median = subtract(out, into);
    dot(median, opposite).abs() / (length(median) * far_length)
}
