//! Merging pairs of trias to quads.
//!
//! Good quads first by a greedy matching, then as many as can be by a maximum matching (as in
//! Remacle, Lambrechts and others, Blossom-Quad, 2012, but for the number of quads alone). The cost
//! is that of the maximum matching.

use super::greedy_matching::greedy_matching;
use super::maximum_matching::maximum_matching;
use super::quad_shape::pair_shapes;
use crate::mesh::neighbours::tria_neighbours;
use crate::mesh::{Element, Facet, as_element};
use crate::vectors::Vector;

/// Merge trias as completely as can be, good quads first.
///
/// No quad is of a shape below `least`, which is above -2; those down to `good` are taken greedily.
pub fn recombine(points: &[Vector], trias: &[Facet], least: f64, good: f64) -> Vec<Element> {
    debug_assert!(least > super::quad_shape::NO_PAIR);
    let neighbours = tria_neighbours(trias, points.len());
    let shapes = pair_shapes(points, trias, &neighbours);
    let mut allowed = neighbours.clone();
    for (across, shapes) in allowed.iter_mut().zip(&shapes) {
        for k in 0..3 {
            if shapes[k] < least {
                across[k] = -1;
            }
        }
    }
    let greedy = greedy_matching(&allowed, &shapes, good);
    merge_pairs(trias, &neighbours, &maximum_matching(&allowed, &shapes, greedy))
}

/// A quad for each pair, in the place of its first tria, and each tria that is alone.
///
/// Mates share a side.
pub fn merge_pairs(trias: &[Facet], neighbours: &[[i32; 3]], mate: &[i32]) -> Vec<Element> {
    let mut elements = Vec::with_capacity(trias.len());
    for (t, tria) in trias.iter().enumerate() {
        let other = mate[t];
        if other < 0 {
            elements.push(as_element(*tria));
        } else if other as usize > t {
            elements.push(merged(*tria, neighbours[t], other, trias[other as usize]));
        }
    }
    elements
}

/// The quad of two trias; without nodes where they share no side.
fn merged(tria: Facet, neighbours: [i32; 3], other: i32, nodes: Facet) -> Element {
    for k in 0..3 {
        if neighbours[k] == other {
            let (a, b) = (tria[k], tria[(k + 1) % 3]);
            for side in (0..3).rev() {
                if nodes[side] == b && nodes[(side + 1) % 3] == a {
                    return [a, nodes[(side + 2) % 3], b, tria[(k + 2) % 3]];
                }
            }
            break;
        }
    }
    [-1; 4]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_trias_become_a_square_and_the_third_stays() {
        let points =
            [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0], [0.5, 3.0, 0.0]];
        let trias = [[0, 1, 2], [3, 2, 4], [0, 2, 3]];
        let elements = recombine(&points, &trias, 0.05, 0.5);
        assert_eq!(elements, [[2, 3, 0, 1], [3, 2, 4, -1]]);
        assert_eq!(recombine(&points, &trias, 1.5, 1.5).len(), 3);
    }
}
