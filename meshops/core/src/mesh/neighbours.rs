//! The element across each side.
//!
//! Sides are put into one bucket a node, that of their first end, so the cost grows with the number
//! of elements and nodes. A side has a neighbour where another element runs along it the other way;
//! of several the last one counts.

use super::csr::Csr;
use super::{Element, Facet, following, size_of};

/// The tria across side k of each tria, from its node k to the next one, or -1.
///
/// Trias name no node beyond `nodes`.
pub fn tria_neighbours(trias: &[Facet], nodes: usize) -> Vec<[i32; 3]> {
    let from = sides_from(trias.iter().map(|tria| &tria[..]), nodes);
    let mut neighbours = vec![[-1; 3]; trias.len()];
    for (tria, across) in trias.iter().zip(&mut neighbours) {
        for k in 0..3 {
            let (a, b) = (tria[k], tria[(k + 1) % 3]);
            let opposite = from.list(b as usize).iter().rev().find(|side| {
                let (other, place) = (**side as usize / 4, **side as usize % 4);
                trias[other][(place + 1) % 3] == a
            });
            across[k] = opposite.map_or(-1, |side| side / 4);
        }
    }
    neighbours
}

/// The element across side k of each element, from its node k to the next one, or -1.
///
/// Elements name no node beyond `nodes`; a tria has three sides.
pub fn element_neighbours(elements: &[Element], nodes: usize) -> Vec<[i32; 4]> {
    let from = sides_from(elements.iter().map(|element| &element[..size_of(*element)]), nodes);
    let mut neighbours = vec![[-1; 4]; elements.len()];
    for (element, across) in elements.iter().zip(&mut neighbours) {
        for k in 0..size_of(*element) {
            let (a, b) = (element[k], element[following(*element, k)]);
            let opposite = from.list(b as usize).iter().rev().find(|side| {
                let (other, place) = (elements[**side as usize / 4], **side as usize % 4);
                other[following(other, place)] == a
            });
            across[k] = opposite.map_or(-1, |side| side / 4);
        }
    }
    neighbours
}

/// The sides that begin at each node in ascending order: four times the element and the place.
fn sides_from<'a>(elements: impl Iterator<Item = &'a [i32]> + Clone, nodes: usize) -> Csr {
    let mut start = vec![0; nodes + 1];
    for node in elements.clone().flatten() {
        start[*node as usize + 1] += 1;
    }
    for node in 0..nodes {
        start[node + 1] += start[node];
    }
    let mut fill = start.clone();
    let mut items = vec![0; start[nodes] as usize];
    for (row, element) in elements.enumerate() {
        for (place, node) in element.iter().enumerate() {
            let next = &mut fill[*node as usize];
            items[*next as usize] = (4 * row + place) as i32;
            *next += 1;
        }
    }
    Csr { start, items }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn a_tria_and_a_quad_meet() {
        let neighbours = element_neighbours(&[[0, 1, 2, -1], [1, 3, 4, 2]], 5);
        assert_eq!(neighbours, [[-1, 1, -1, -1], [-1, -1, -1, 0]]);
    }

    proptest! {
        #[test]
        fn trias_are_elements(
            trias in prop::collection::vec(prop::array::uniform3(0i32..8), 0..20),
        ) {
            let elements: Vec<Element> = trias.iter().map(|t| [t[0], t[1], t[2], -1]).collect();
            let of_elements = element_neighbours(&elements, 8);
            for (row, across) in tria_neighbours(&trias, 8).iter().enumerate() {
                prop_assert_eq!(&of_elements[row][..3], across);
            }
        }
    }
}
