//! Shape of the quads that pairs of trias make.

use crate::math::least;
use crate::mesh::Facet;
use crate::vectors::{Vector, cross, dot, length, subtract};

/// Shape of a side without a neighbour.
pub const NO_PAIR: f64 = -2.0;

/// Shape of a quad in [-1, 1]: the sine of its worst corner, 1 for a rectangle.
///
/// The corners are seen along the normal of its diagonals; -1 where there is none or a side has no
/// length.
pub fn quad_shape(points: &[Vector], quad: [i32; 4]) -> f64 {
    let corners = quad.map(|node| points[node as usize]);
    let [p, q, r, s] = corners;
    let normal = cross(subtract(r, p), subtract(s, q));
    let size = length(normal);
    if size <= 0.0 {
        return -1.0;
    }
    let mut worst = 1.0;
    for k in 0..4 {
        let here = corners[k];
        let ahead = subtract(corners[(k + 1) % 4], here);
        let behind = subtract(corners[(k + 3) % 4], here);
        let area = dot(cross(ahead, behind), normal) / size;
        let lengths = (dot(ahead, ahead) * dot(behind, behind)).sqrt();
        if lengths <= 0.0 {
            return -1.0;
        }
        worst = least(worst, area / lengths);
    }
    worst
}

/// Shape of the quad that each tria makes with its neighbour across each side, or [`NO_PAIR`].
///
/// `neighbours` are those of [`crate::mesh::neighbours::tria_neighbours`]. The two sides of a pair
/// have the same shape.
pub fn pair_shapes(points: &[Vector], trias: &[Facet], neighbours: &[[i32; 3]]) -> Vec<[f64; 3]> {
    let mut shapes = vec![[NO_PAIR; 3]; trias.len()];
    for (t, tria) in trias.iter().enumerate() {
        for k in 0..3 {
            let other = neighbours[t][k];
            if other < t as i32 {
                continue;
            }
            let (a, b, opposite) = (tria[k], tria[(k + 1) % 3], tria[(k + 2) % 3]);
            let other = other as usize;
            for side in 0..3 {
                if neighbours[other][side] == t as i32 && trias[other][side] == b {
                    let apex = trias[other][(side + 2) % 3];
                    let shape = quad_shape(points, [a, apex, b, opposite]);
                    shapes[t][k] = shape;
                    shapes[other][side] = shape;
                }
            }
        }
    }
    shapes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_worst_corner_counts() {
        let points = [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [2.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
        assert_eq!(quad_shape(&points, [0, 1, 2, 3]), 1.0);
        assert_eq!(quad_shape(&points, [0, 1, 2, 0]), -1.0);
        assert_eq!(quad_shape(&points, [0, 2, 1, 3]), -1.0);
    }
}
