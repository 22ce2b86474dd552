//! Strips: elements one behind the other, each across a crossable edge from the last.
//!
//! A strip has *cells*, the elements, and *rungs*, the edges between one cell and the next. It is
//! open, or closes on itself.

mod closed;
mod shortest;
mod straight;

pub use closed::closed_strips;
pub use shortest::{Limits, shortest_strips};
pub use straight::straight_strips;

use crate::mesh::element_graph::ElementGraph;
use crate::mesh::{Element, following};

/// The nodes of an edge between two cells, in the direction of the first.
pub type Rung = [i32; 2];

/// Stands behind the last cell of an open strip.
pub const NO_RUNG: Rung = [-1, -1];

/// Strips one behind the other: strip `s` has the places from `start[s]` to `start[s + 1]`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Strips {
    /// Where each strip starts, and last where the last one ends.
    pub start: Vec<i32>,
    /// Rows of the elements.
    pub cells: Vec<i32>,
    /// The edge between a cell and the next one. The last rung of a strip leads back to its first
    /// cell, or is [`NO_RUNG`] where the strip is open.
    pub rungs: Vec<Rung>,
}

impl Default for Strips {
    fn default() -> Self {
        Self { start: vec![0], cells: Vec::new(), rungs: Vec::new() }
    }
}

impl Strips {
    /// Borrow them.
    #[inline]
    pub fn view(&self) -> StripsView<'_> {
        StripsView { start: &self.start, cells: &self.cells, rungs: &self.rungs }
    }

    /// End a strip where the cells end.
    fn close(&mut self) {
        self.start.push(self.cells.len() as i32);
    }
}

/// Borrowed [`Strips`].
#[derive(Clone, Copy, Debug)]
pub struct StripsView<'a> {
    /// Where each strip starts, and last where the last one ends.
    pub start: &'a [i32],
    /// Rows of the elements.
    pub cells: &'a [i32],
    /// The edge between a cell and the next one.
    pub rungs: &'a [Rung],
}

/// One strip.
#[derive(Clone, Copy, Debug)]
pub struct Strip<'a> {
    /// Rows of the elements.
    pub cells: &'a [i32],
    /// The edge between a cell and the next one.
    pub rungs: &'a [Rung],
}

impl<'a> StripsView<'a> {
    /// How many strips there are.
    #[inline]
    pub fn len(&self) -> usize {
        self.start.len().saturating_sub(1)
    }

    /// Whether there is no strip.
    #[inline]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Strip `s`.
    #[inline]
    pub fn strip(&self, s: usize) -> Strip<'a> {
        let places = self.start[s] as usize..self.start[s + 1] as usize;
        Strip { cells: &self.cells[places.clone()], rungs: &self.rungs[places] }
    }

    /// One strip after the other.
    #[inline]
    pub fn iter(self) -> impl ExactSizeIterator<Item = Strip<'a>> {
        (0..self.len()).map(move |s| self.strip(s))
    }
}

impl Strip<'_> {
    /// Whether it closes on itself.
    #[inline]
    pub fn is_closed(&self) -> bool {
        self.rungs.last().is_some_and(|rung| rung[0] >= 0)
    }
}

/// Where strips may go.
#[derive(Clone, Copy, Debug)]
pub struct StripGround<'a> {
    /// The elements of the mesh.
    pub elements: &'a [Element],
    /// How they are joined.
    pub graph: ElementGraph<'a>,
    /// Which of them a strip may enter.
    pub editable: &'a [bool],
}

impl StripGround<'_> {
    /// The side of an element as a rung, in its direction.
    #[inline]
    fn rung(&self, element: usize, side: usize) -> Rung {
        let nodes = self.elements[element];
        [nodes[side], nodes[following(nodes, side)]]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::edges::{Edges, find_edges};
    use crate::mesh::is_tria;
    use proptest::prelude::*;

    /// A row of two quads between two trias.
    const ROW: [Element; 4] = [[0, 1, 2, -1], [2, 1, 3, 4], [4, 3, 5, 6], [6, 5, 7, -1]];

    fn graph(edges: &Edges) -> ElementGraph<'_> {
        ElementGraph {
            element_edges: &edges.of_elements,
            edge_elements: &edges.elements,
            crossable: &edges.opposed,
        }
    }

    #[test]
    fn both_ways_lead_from_tria_to_tria() {
        let edges = find_edges(&ROW, 8);
        let ground = StripGround { elements: &ROW, graph: graph(&edges), editable: &[true; 4] };
        let straight = straight_strips(ground, &[0], 2, 0);
        assert_eq!(straight.cells, [0, 1, 2, 3]);
        assert_eq!(straight.rungs, [[1, 2], [3, 4], [5, 6], NO_RUNG]);
        let limits = Limits { reach: 2, steps: 0, partners: 1 };
        assert_eq!(shortest_strips(ground, &[0], limits), straight);
        let near = Limits { reach: 1, ..limits };
        assert_eq!(shortest_strips(ground, &[0], near), Strips::default());
        assert_eq!(closed_strips(ground), Strips::default());
    }

    #[test]
    fn a_ring_closes_in_one_direction() {
        let ring = [[0, 1, 4, 3], [1, 2, 5, 4], [2, 0, 3, 5]];
        let edges = find_edges(&ring, 6);
        let ground = StripGround { elements: &ring, graph: graph(&edges), editable: &[true; 3] };
        let closed = closed_strips(ground);
        assert_eq!(closed.start, [0, 3]);
        assert_eq!(closed.cells, [0, 1, 2]);
        assert!(closed.view().strip(0).is_closed());
    }

    /// Whether an element has a side with these nodes, in either direction.
    fn has_side(element: Element, [a, b]: Rung) -> bool {
        (0..4).filter(|place| element[*place] >= 0).any(|place| {
            let (start, end) = (element[place], element[following(element, place)]);
            (start, end) == (a, b) || (start, end) == (b, a)
        })
    }

    proptest! {
        #[test]
        fn each_rung_is_a_side_of_both_cells(
            elements in prop::collection::vec(prop::array::uniform4(0i32..12), 1..30),
            tria in prop::collection::vec(any::<bool>(), 30),
            editable in prop::collection::vec(any::<bool>(), 30),
        ) {
            let elements: Vec<Element> = elements.iter().zip(tria)
                .map(|(e, tria)| if tria { [e[0], e[1], e[2], -1] } else { *e }).collect();
            let edges = find_edges(&elements, 12);
            let editable = &editable[..elements.len()];
            let ground = StripGround { elements: &elements, graph: graph(&edges), editable };
            let trias: Vec<i32> =
                (0..).zip(&elements).filter(|(_, e)| is_tria(**e)).map(|(row, _)| row).collect();
            let limits = Limits { reach: 5, steps: 2, partners: 3 };
            for strips in [
                straight_strips(ground, &trias, 5, 2),
                closed_strips(ground),
                shortest_strips(ground, &trias, limits),
            ] {
                for Strip { cells, rungs } in strips.view().iter() {
                    for (i, rung) in rungs.iter().enumerate().filter(|(_, rung)| rung[0] >= 0) {
                        let both = [cells[i], cells[(i + 1) % cells.len()]];
                        for cell in both {
                            prop_assert!(has_side(elements[cell as usize], *rung));
                        }
                    }
                }
            }
        }
    }
}
