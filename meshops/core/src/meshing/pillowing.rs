//! Pillowing: sets of elements are shrunk, and a ring of quads is put around each.
//!
//! The outline of a set stays, so nothing around it changes (Mitchell and Tautges 1995). The cost
//! grows with the elements of the sets, and with the mesh for the arrays.

use crate::mesh::csr::CsrView;
use crate::mesh::element_graph::ElementGraph;
use crate::mesh::lists::Lists;
use crate::mesh::{Element, following, size_of};
use crate::vectors::{Vector, add, scale};

/// What comes for each set; list `k` of each is of set `k`.
#[derive(Clone, Debug, PartialEq)]
pub struct Pillows {
    /// The elements: first the ring. Rows of nodes from the mesh's number of them on are new, in
    /// order.
    pub added: Lists<Element>,
    /// Places of the new nodes.
    pub points: Lists<Vector>,
}

/// Shrink sets of elements and put a ring of quads around each.
///
/// Lists of `sets` are rows of the elements. The border of a set is made of all edges that have not
/// two of its elements and no other; whether an edge may be crossed does not count.
pub fn pillow(
    sets: CsrView<'_>,
    points: &[Vector],
    elements: &[Element],
    graph: ElementGraph<'_>,
) -> Pillows {
    let mut pillows =
        Pillows { added: Lists::with_room(sets.len()), points: Lists::with_room(sets.len()) };
    pillows.added.items.reserve(5 * sets.items.len());
    pillows.points.items.reserve(4 * sets.items.len());
    let mut shrinking = Shrinking {
        points,
        elements,
        graph,
        chosen: vec![u32::MAX; elements.len()],
        inner: vec![None; points.len()],
    };
    for set in 0..sets.len() {
        let members = sets.list(set);
        for row in members {
            shrinking.chosen[*row as usize] = set as u32;
        }
        let new = shrinking.add_ring(members, set as u32, &mut pillows.added);
        shrinking.add_shrunk(members, new, &mut pillows);
        pillows.added.close();
        pillows.points.close();
    }
    pillows
}

/// Sets on their mesh.
struct Shrinking<'a> {
    points: &'a [Vector],
    elements: &'a [Element],
    graph: ElementGraph<'a>,
    /// The set that last had an element.
    chosen: Vec<u32>,
    /// The number of the new node inside each border node of the set at hand, none elsewhere.
    inner: Vec<Option<u32>>,
}

impl Shrinking<'_> {
    /// Add a quad inside each border side of a set; how many nodes are new.
    fn add_ring(&mut self, members: &[i32], set: u32, added: &mut Lists<Element>) -> u32 {
        let mut new = 0;
        for row in members {
            let row = *row as usize;
            let element = self.elements[row];
            for side in 0..size_of(element) {
                if self.is_inside(row, side, set) {
                    continue;
                }
                let ends = [element[side], element[following(element, side)]];
                let inner = ends.map(|node| {
                    let number = self.inner[node as usize].get_or_insert_with(|| {
                        new += 1;
                        new - 1
                    });
                    (self.points.len() as u32 + *number) as i32
                });
                added.push([ends[0], ends[1], inner[1], inner[0]]);
            }
        }
        new
    }

    /// Whether the other element of a side is of the set too.
    #[inline]
    fn is_inside(&self, row: usize, side: usize, set: u32) -> bool {
        let Ok(edge) = usize::try_from(self.graph.element_edges[row][side]) else { return false };
        let [a, b] = self.graph.edge_elements[edge];
        let other = if a == row as i32 { b } else { a };
        let chosen = usize::try_from(other).ok().and_then(|other| self.chosen.get(other));
        a >= 0 && chosen == Some(&set)
    }

    /// Add the elements of a set on the new nodes, and the places of these.
    ///
    /// A new node is half-way from the old one to the middle of the elements of the set around it.
    fn add_shrunk(&mut self, members: &[i32], new: u32, pillows: &mut Pillows) {
        let first = pillows.points.items.len();
        pillows.points.items.resize(first + new as usize, [0.0; 3]);
        let places = &mut pillows.points.items[first..];
        let mut weights = vec![0.0; new as usize];
        for row in members {
            let element = self.elements[*row as usize];
            let mut shrunk = element;
            for corner in 0..size_of(element) {
                let Some(number) = self.inner[element[corner] as usize] else { continue };
                shrunk[corner] = (self.points.len() as u32 + number) as i32;
                let at = number as usize;
                for other in &element[..size_of(element)] {
                    places[at] = add(places[at], self.points[*other as usize]);
                    weights[at] += 1.0;
                }
            }
            pillows.added.push(shrunk);
        }
        for row in members {
            let element = self.elements[*row as usize];
            for node in &element[..size_of(element)] {
                if let Some(number) = self.inner[*node as usize].take() {
                    let (old, at) = (self.points[*node as usize], number as usize);
                    let middle = places[at].map(|sum| sum / weights[at]);
                    places[at] = scale(add(old, middle), 0.5);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::edges::find_edges;

    #[test]
    fn a_quad_becomes_five() {
        let points = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [4.0, 4.0, 0.0], [0.0, 4.0, 0.0]];
        let elements = [[0, 1, 2, 3]];
        let edges = find_edges(&elements, 4);
        let graph = ElementGraph {
            element_edges: &edges.of_elements,
            edge_elements: &edges.elements,
            crossable: &edges.opposed,
        };
        let sets = CsrView { start: &[0, 1], items: &[0] };
        let pillows = pillow(sets, &points, &elements, graph);
        assert_eq!(
            pillows.added.list(0),
            [[0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7], [4, 5, 6, 7]]
        );
        assert_eq!(pillows.points.list(0)[0], [1.0, 1.0, 0.0]);
        assert_eq!(pillows.points.list(0)[2], [3.0, 3.0, 0.0]);
    }
}
