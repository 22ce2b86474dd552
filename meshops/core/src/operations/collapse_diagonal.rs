//! Collapsing diagonals: two opposite nodes of a quad become one and the quad vanishes.
//!
//! Daniels, Silva, Shepherd, Cohen: Quadrilateral mesh simplification (2008).

use super::candidates::CandidateList;
use super::node_fan::MOST_AROUND;
use crate::mesh::csr::CsrView;
use crate::mesh::{Element, is_tria};
use crate::vectors::Vector;

/// Make the opposite nodes of each quad one; a candidate for each of its two diagonals.
///
/// A node that is free goes to the other, and both to the middle where both are free. Empty where
/// that cannot be.
pub fn collapse_diagonals(
    quads: &[i32],
    points: &[Vector],
    elements: &[Element],
    around: CsrView<'_>,
    free: &[bool],
) -> CandidateList {
    let mut list = CandidateList::with_capacity(2 * quads.len());
    for quad in quads {
        let element = elements[*quad as usize];
        for way in 0..2 {
            if !is_tria(element) {
                let (mut goes, mut stays) = (element[way], element[way + 2]);
                if !free[goes as usize] {
                    (goes, stays) = (stays, goes);
                }
                let users = around.list(goes as usize);
                if free[goes as usize] && users.len() <= MOST_AROUND {
                    list.removed.extend(users);
                    for row in users.iter().filter(|row| *row != quad) {
                        let merged = |node| if node == goes { stays } else { node };
                        list.added.push(elements[*row as usize].map(merged));
                    }
                    if free[stays as usize] {
                        let (one, two) = (points[goes as usize], points[stays as usize]);
                        list.moved.push(stays);
                        list.moved_to.push([0, 1, 2].map(|k| 0.5 * (one[k] + two[k])));
                    }
                }
            }
            list.end();
        }
    }
    list
}
