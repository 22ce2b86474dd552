//! Joining trias: two trias that share an edge become a quad.

use super::candidates::CandidateList;
use super::pair_polygon::PairPolygon;
use crate::mesh::{Element, is_tria};

/// One quad of each pair of elements; nothing comes where these are not two trias with an edge.
pub fn join_trias(elements: &[Element], pairs: &[[i32; 2]]) -> CandidateList {
    let mut list = CandidateList::with_capacity(pairs.len());
    for [one, other] in pairs {
        let trias = [elements[*one as usize], elements[*other as usize]];
        let polygon = PairPolygon::around(trias[0], trias[1]);
        if trias.into_iter().all(is_tria) && polygon.size == 4 {
            let [a, b, c, d, ..] = polygon.nodes;
            list.removed.extend([one, other]);
            list.added.push([a, b, c, d]);
        }
        list.end();
    }
    list
}
