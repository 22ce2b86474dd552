//! Warpage: how far a quad is from plane.

use super::corners::QuadSides;
use crate::math::{atan2, degrees, greatest};
use crate::vectors::{Vector, cross, dot, length};

/// The larger angle between the two trias that one of its diagonals splits a quad into.
#[inline]
pub fn of_quad(sides: &QuadSides) -> f64 {
    let [na, nb, nc, nd] = sides.normals;
    greatest(angle_between(na, nc), angle_between(nb, nd))
}

/// Degrees between two vectors; 0 where one of them is nothing.
#[inline]
fn angle_between(u: Vector, v: Vector) -> f64 {
    degrees(atan2(length(cross(u, v)), dot(u, v)))
}
