//! Vectors of three numbers, and what corners of an element say with them.
//!
//! Sums are written out from left to right, so that they are rounded in the same order everywhere.

use crate::math::{greatest_of, least_of};
use crate::mesh::{Element, is_tria};

/// A place or a direction.
pub type Vector = [f64; 3];

/// Vector from one point to another, by their rows.
#[inline(always)]
pub fn edge(points: &[Vector], from: i32, to: i32) -> Vector {
    subtract(points[to as usize], points[from as usize])
}

/// Sum.
#[inline(always)]
pub fn add(u: Vector, v: Vector) -> Vector {
    [u[0] + v[0], u[1] + v[1], u[2] + v[2]]
}

/// Difference.
#[inline(always)]
pub fn subtract(u: Vector, v: Vector) -> Vector {
    [u[0] - v[0], u[1] - v[1], u[2] - v[2]]
}

/// Inner product.
#[inline(always)]
pub fn dot(u: Vector, v: Vector) -> f64 {
    u[0] * v[0] + u[1] * v[1] + u[2] * v[2]
}

/// Outer product.
#[inline(always)]
pub fn cross(u: Vector, v: Vector) -> Vector {
    [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]
}

/// Euclidean length.
#[inline(always)]
pub fn length(u: Vector) -> f64 {
    dot(u, u).sqrt()
}

/// Multiple.
#[inline(always)]
pub fn scale(u: Vector, factor: f64) -> Vector {
    [u[0] * factor, u[1] * factor, u[2] * factor]
}

/// Vector of length 1 in the same direction; 0 for a vector without length.
#[inline(always)]
pub fn unit(u: Vector) -> Vector {
    let size = length(u);
    if size <= 0.0 {
        return [0.0; 3];
    }
    scale(u, 1.0 / size)
}

/// Area of an element times its mean unit normal.
#[inline(always)]
pub fn area_vector(points: &[Vector], element: Element) -> Vector {
    area_vector_of(&corners_of(points, element))
}

/// Smallest corner Jacobian against a unit normal, over the longest edge squared.
///
/// At most 1 (a square: 1, an equilateral tria: 0.87); 0 or less for an element that is concave,
/// flat or turned over as seen from the normal.
#[inline(always)]
pub fn corner_jacobian_min(points: &[Vector], element: Element, normal: Vector) -> f64 {
    corner_jacobian_min_of(&corners_of(points, element), is_tria(element), normal)
}

/// Places of an element's nodes; the third again as the fourth of a tria.
#[inline(always)]
pub fn corners_of(points: &[Vector], element: Element) -> [Vector; 4] {
    let [a, b, c, d] = element;
    let last = if d < 0 { c } else { d };
    // one by one: what is made by a loop stays in memory
    [points[a as usize], points[b as usize], points[c as usize], points[last as usize]]
}

/// [`area_vector`] by [`corners_of`] an element.
#[inline(always)]
pub fn area_vector_of(corners: &[Vector; 4]) -> Vector {
    let [a, b, c, last] = *corners;
    scale(cross(subtract(c, a), subtract(last, b)), 0.5)
}

/// [`corner_jacobian_min`] by [`corners_of`] an element.
#[inline(always)]
pub fn corner_jacobian_min_of(corners: &[Vector; 4], is_tria: bool, normal: Vector) -> f64 {
    let [a, b, c, d] = *corners;
    let (ab, bc) = (subtract(b, a), subtract(c, b));
    if is_tria {
        let ca = subtract(a, c);
        let longest = greatest_of([dot(ab, ab), dot(bc, bc), dot(ca, ca)]);
        return if longest > 0.0 { dot(cross(ab, bc), normal) / longest } else { 0.0 };
    }
    let (cd, da) = (subtract(d, c), subtract(a, d));
    let longest = greatest_of([dot(ab, ab), dot(bc, bc), dot(cd, cd), dot(da, da)]);
    if longest > 0.0 {
        // within the branch: compilers pair the two searches otherwise, to the harm of both
        let lowest = least_of([
            dot(cross(da, ab), normal),
            dot(cross(ab, bc), normal),
            dot(cross(bc, cd), normal),
            dot(cross(cd, da), normal),
        ]);
        lowest / longest
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_square_has_corners_of_one() {
        let points = [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [2.0, 2.0, 0.0], [0.0, 2.0, 0.0]];
        assert_eq!(area_vector(&points, [0, 1, 2, 3]), [0.0, 0.0, 4.0]);
        assert_eq!(corner_jacobian_min(&points, [0, 1, 2, 3], [0.0, 0.0, 1.0]), 1.0);
        assert_eq!(corner_jacobian_min(&points, [0, 1, 2, -1], [0.0, 0.0, -1.0]), -0.5);
        assert_eq!(corner_jacobian_min(&points, [0, 0, 0, 0], [0.0, 0.0, 1.0]), 0.0);
    }

    #[test]
    fn a_concave_corner_is_below_zero() {
        let points = [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.5, 0.5, 0.0], [0.0, 2.0, 0.0]];
        assert!(corner_jacobian_min(&points, [0, 1, 2, 3], [0.0, 0.0, 1.0]) < 0.0);
    }
}
