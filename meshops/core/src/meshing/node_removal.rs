//! Node removal: inner nodes are taken out, and the ring around each is filled with fewer elements.
//!
//! A ring is the polygon around the elements of a node. It is filled with quads without a node
//! inside, and a tria where it has an odd number of sides. The cost grows with the number of nodes
//! that are taken out.

use crate::mesh::csr::CsrView;
use crate::mesh::lists::Lists;
use crate::mesh::{Element, NO_NODE, following, preceding, size_of};

/// Sides of a ring, at the most.
pub const MOST_SIDES: usize = 10;

/// Ways to fill a ring of [`MOST_SIDES`] sides at the most: an octagon has this many.
pub const FILLINGS: usize = 12;

/// One node to take out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Removal {
    /// Its row.
    pub node: usize,
    /// The way to fill its ring, below [`FILLINGS`].
    pub way: usize,
}

/// What goes and comes for each node; list `k` of each is of removal `k`, empty where there is no
/// such way, or where it is the same as another.
#[derive(Clone, Debug, PartialEq)]
pub struct RemovedNodes {
    /// Rows of the elements that go.
    pub removed: Lists<i32>,
    /// Those that come.
    pub added: Lists<Element>,
}

/// Take inner nodes out, each on its own. `around` are the elements of the nodes.
pub fn remove_nodes(
    removals: &[Removal],
    elements: &[Element],
    around: CsrView<'_>,
) -> RemovedNodes {
    let mut found = RemovedNodes {
        removed: Lists::with_room(removals.len()),
        added: Lists::with_room(removals.len()),
    };
    for Removal { node, way } in removals {
        let fan = around.list(*node);
        if let Some(ring) = Ring::around(*node as i32, elements, fan) {
            ring.fill(*way, &mut found.added);
        }
        if !found.added.open().is_empty() {
            found.removed.items.extend_from_slice(fan);
        }
        found.removed.close();
        found.added.close();
    }
    found
}

/// The nodes around an inner node.
struct Ring {
    nodes: [i32; MOST_SIDES],
    sides: usize,
}

impl Ring {
    /// Walk through the elements around a node; none for too many sides or too few.
    fn around(node: i32, elements: &[Element], fan: &[i32]) -> Option<Self> {
        let place_in = |element: Element| element.iter().position(|same| *same == node);
        let mut ring = Self { nodes: [NO_NODE; MOST_SIDES], sides: 0 };
        let mut element = elements[*fan.first()? as usize];
        for _ in fan {
            let size = size_of(element);
            let place = place_in(element)?;
            for step in 1..size - 1 {
                *ring.nodes.get_mut(ring.sides)? = element[(place + step) % size];
                ring.sides += 1;
            }
            let last = element[preceding(element, place)];
            let begins = |row: &&i32| {
                let other = elements[**row as usize];
                (0..size_of(other)).any(|k| other[k] == node && other[following(other, k)] == last)
            };
            // of several the last, as everywhere
            if let Some(row) = fan.iter().rfind(begins) {
                element = elements[*row as usize];
            }
        }
        (ring.sides >= 3).then_some(ring)
    }

    /// The node at a place, counted on around the ring.
    #[inline]
    fn at(&self, place: usize) -> i32 {
        self.nodes[place % self.sides]
    }

    /// Add the elements that fill it.
    ///
    /// Ways below the number of sides: all elements share the node of that number. The ways of an
    /// octagon beyond that: three quads in a row. Nothing for a way that is the same as another.
    fn fill(&self, way: usize, added: &mut Lists<Element>) {
        if self.sides == 8 && way >= 8 {
            for quad in [[0, 1, 2, 3], [0, 3, 4, 7], [4, 5, 6, 7]] {
                added.push(quad.map(|corner| self.at(way - 8 + corner)));
            }
            return;
        }
        let ways = match self.sides {
            ..=4 => 1,
            6 => 3,
            sides => sides,
        };
        if way >= ways {
            return;
        }
        for place in (1..self.sides - 1).step_by(2) {
            let fourth = if place + 2 < self.sides { self.at(way + place + 2) } else { NO_NODE };
            let [second, third] = [place, place + 1].map(|place| self.at(way + place));
            added.push([self.at(way), second, third, fourth]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::node_elements::elements_of_nodes;

    fn removed(elements: &[Element], node: usize, way: usize) -> RemovedNodes {
        let around = elements_of_nodes(elements, 12);
        remove_nodes(&[Removal { node, way }], elements, around.view())
    }

    #[test]
    fn four_trias_become_a_quad() {
        let fan = [[0, 1, 4, -1], [1, 2, 4, -1], [2, 3, 4, -1], [3, 0, 4, -1]];
        let found = removed(&fan, 4, 0);
        assert_eq!(found.removed.items, [0, 1, 2, 3]);
        assert_eq!(found.added.items, [[0, 1, 2, 3]]);
        assert!(removed(&fan, 4, 1).removed.items.is_empty());
    }

    #[test]
    fn an_octagon_has_twelve_fillings_that_differ() {
        let fan = [[8, 0, 1, 2], [8, 2, 3, 4], [8, 4, 5, 6], [8, 6, 7, 0]];
        let mut fillings: Vec<Vec<Element>> = (0..FILLINGS)
            .map(|way| {
                let mut added = removed(&fan, 8, way).added.items;
                added.iter_mut().for_each(|quad| quad.sort_unstable());
                added.sort_unstable();
                added
            })
            .collect();
        fillings.sort_unstable();
        fillings.dedup();
        assert_eq!(fillings.len(), FILLINGS);
        assert!(fillings.iter().all(|filling| filling.len() == 3));
    }

    #[test]
    fn a_node_without_elements_stays() {
        assert!(removed(&[[0, 1, 2, 3]], 5, 0).added.items.is_empty());
    }
}
