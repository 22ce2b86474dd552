//! Size of an element, and its aspect ratio.

use super::corners::{QuadSides, TriaSides};
use crate::math::{greatest, least_of};
use crate::vectors::length;

/// Shortest edge of a tria, or its least height over that of an equilateral one.
#[inline]
pub fn of_tria(sides: &TriaSides, normalised: bool) -> f64 {
    if !normalised {
        sides.shortest
    } else if sides.longest > 0.0 {
        2.0 / f64::sqrt(3.0) * sides.twice_area / sides.longest
    } else {
        0.0
    }
}

/// Shortest edge of a quad, or its least height.
#[inline]
pub fn of_quad(sides: &QuadSides, normalised: bool) -> f64 {
    if !(normalised && sides.shortest > 0.0) {
        return sides.shortest;
    }
    let [lab, lbc, lcd, lda] = sides.lengths;
    let [na, nb, nc, nd] = sides.normals;
    least_of([
        sides.shortest,
        length(na) / greatest(lda, lab),
        length(nb) / greatest(lab, lbc),
        length(nc) / greatest(lbc, lcd),
        length(nd) / greatest(lcd, lda),
    ])
}

/// Longest edge over the size.
#[inline]
pub fn aspect_ratio(longest: f64, size: f64) -> f64 {
    if size > 0.0 { longest / size } else { f64::INFINITY }
}
