//! Swapping edges: the edge between two elements is turned within the polygon around them.

use super::candidates::CandidateList;
use super::pair_polygon::PairPolygon;
use crate::mesh::{Element, NO_NODE};

/// Ways to turn an edge.
pub const TURNS: usize = 2;

/// Two elements as places of a polygon, -1 for none.
type Turn = [[i32; 4]; 2];

/// Turns between two quads, to the other long diagonals of their hexagon.
const HEXAGON: [Turn; 2] = [[[1, 2, 3, 4], [4, 5, 0, 1]], [[2, 3, 4, 5], [5, 0, 1, 2]]];

/// Turns between a quad and a tria, which changes its place in their pentagon.
const PENTAGON: [Turn; 2] = [[[4, 0, 1, -1], [1, 2, 3, 4]], [[2, 3, 4, -1], [4, 0, 1, 2]]];

/// The turn between two trias, to the other diagonal.
const QUAD: [Turn; 1] = [[[1, 2, 3, -1], [3, 0, 1, -1]]];

/// The turns of the edge between each pair of elements; those that there are not are empty.
pub fn swap_edges(elements: &[Element], pairs: &[[i32; 2]]) -> CandidateList {
    let mut list = CandidateList::with_capacity(TURNS * pairs.len());
    for pair in pairs {
        let [one, other] = pair.map(|row| elements[row as usize]);
        let polygon = PairPolygon::around(one, other);
        let turns: &[Turn] = match polygon.size {
            6 => &HEXAGON,
            5 => &PENTAGON,
            4 => &QUAD,
            _ => &[],
        };
        for variant in 0..TURNS {
            if let Some(turn) = turns.get(variant) {
                list.removed.extend(pair);
                list.added.extend(turn.map(|places| places.map(|place| at(&polygon, place))));
            }
            list.end();
        }
    }
    list
}

/// The node at a place of a polygon.
fn at(polygon: &PairPolygon, place: i32) -> i32 {
    if place < 0 { NO_NODE } else { polygon.nodes[place as usize] }
}
