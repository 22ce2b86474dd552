//! Jacobian and taper: how evenly a quad's area is spread over its corners.

use super::corners::QuadSides;
use crate::math::{greatest_of, least_of};
use crate::vectors::dot;

/// Jacobians of a quad's corners along its normal.
#[inline]
pub fn at_corners(sides: &QuadSides) -> [f64; 4] {
    sides.normals.map(|normal| dot(normal, sides.normal) / sides.twice_area)
}

/// Smallest Jacobian over the largest, at the Gauss points.
#[inline]
pub fn ratio(sides: &QuadSides, jacobians: [f64; 4]) -> f64 {
    let mean = 0.5 * sides.twice_area;
    let at_gauss = 1.0 / f64::sqrt(3.0);
    (mean + (least_of(jacobians) - mean) * at_gauss)
        / (mean + (greatest_of(jacobians) - mean) * at_gauss)
}

/// How much less than the mean the smallest corner has.
#[inline]
pub fn taper(sides: &QuadSides, jacobians: [f64; 4]) -> f64 {
    let mean = 0.5 * sides.twice_area;
    1.0 - least_of(jacobians) / mean
}
