//! A mesh as slices: places of nodes and rows of nodes around each element.
//!
//! Node `i` is row `i` of the points. An element names three or four of them, in order around it.

use crate::vectors::Vector;

pub mod border_loops;
pub mod cavity_polygon;
pub mod components;
pub mod csr;
pub mod edges;
pub mod element_graph;
pub mod element_rings;
pub mod lists;
pub mod neighbours;
pub mod node_elements;
pub mod patch;
pub mod subdomain;
pub mod valence;
pub mod validity;

/// Rows of an element's nodes; a tria has [`NO_NODE`] last.
pub type Element = [i32; 4];

/// Rows of the nodes of a facet of a surface.
pub type Facet = [i32; 3];

/// Stands in the fourth place of a tria.
pub const NO_NODE: i32 = -1;

/// Whether an element is a tria.
#[inline]
pub fn is_tria(element: Element) -> bool {
    element[3] < 0
}

/// How many nodes an element has.
#[inline]
pub fn size_of(element: Element) -> usize {
    if is_tria(element) { 3 } else { 4 }
}

/// The element of a facet.
#[inline]
pub fn as_element(facet: Facet) -> Element {
    [facet[0], facet[1], facet[2], NO_NODE]
}

/// The place among an element's nodes after another one, around the element.
#[inline]
pub fn following(element: Element, place: usize) -> usize {
    if place + 1 < size_of(element) { place + 1 } else { 0 }
}

/// The place among an element's nodes before another one, around the element.
#[inline]
pub fn preceding(element: Element, place: usize) -> usize {
    if place > 0 { place - 1 } else { size_of(element) - 1 }
}

/// Mean of an element's nodes.
#[inline]
pub fn centre(points: &[Vector], element: Element) -> Vector {
    let size = size_of(element);
    let mut total = [0.0; 3];
    for node in &element[..size] {
        total = crate::vectors::add(total, points[*node as usize]);
    }
    crate::vectors::scale(total, 1.0 / size as f64)
}
