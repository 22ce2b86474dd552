//! Edges of a mesh and the elements at them.
//!
//! Sides are put into one bucket a node, that of the smaller end, and sorted within it, so the cost
//! grows with the number of elements and nodes and hardly faster.

use super::{Element, following, size_of};

/// The edges of a mesh, each once, ordered by their nodes.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Edges {
    /// Node rows of each edge, the smaller first.
    pub ends: Vec<[i32; 2]>,
    /// The edge of each side of each element; -1 fourth for a tria.
    pub of_elements: Vec<[i32; 4]>,
    /// The two elements of an edge that has exactly two; elsewhere -1.
    pub elements: Vec<[i32; 2]>,
    /// How many elements meet at each edge.
    pub uses: Vec<i32>,
    /// Edges of exactly two elements that run along them in opposite directions.
    pub opposed: Vec<bool>,
}

/// Find the edges of elements that name none but the first `nodes` nodes.
///
/// Elements are fewer than 2^29.
pub fn find_edges(elements: &[Element], nodes: usize) -> Edges {
    let mut start = vec![0u32; nodes + 1];
    for (low, _, _) in sides(elements) {
        start[low + 1] += 1;
    }
    for node in 0..nodes {
        start[node + 1] += start[node];
    }
    // the larger end above, the side below: sorting orders by both
    let mut sorted = vec![0u64; start[nodes] as usize];
    let mut fill = start.clone();
    for (low, high, side) in sides(elements) {
        let place = &mut fill[low];
        sorted[*place as usize] = ((high as u64) << 32) | side as u64;
        *place += 1;
    }
    let expected = sorted.len() / 2 + sorted.len() / 8;
    let mut edges = Edges {
        ends: Vec::with_capacity(expected),
        of_elements: vec![[-1; 4]; elements.len()],
        elements: Vec::with_capacity(expected),
        uses: Vec::with_capacity(expected),
        opposed: Vec::with_capacity(expected),
    };
    for low in 0..nodes {
        let bucket = &mut sorted[start[low] as usize..start[low + 1] as usize];
        bucket.sort_unstable();
        for same_edge in bucket.chunk_by(|a, b| a >> 32 == b >> 32) {
            add_edge(&mut edges, elements, low as i32, same_edge);
        }
    }
    edges
}

/// Smaller end, larger end and number of each side of each element.
fn sides(elements: &[Element]) -> impl Iterator<Item = (usize, usize, usize)> + '_ {
    elements.iter().enumerate().flat_map(|(row, element)| {
        (0..size_of(*element)).map(move |place| {
            let a = element[place] as usize;
            let b = element[following(*element, place)] as usize;
            (a.min(b), a.max(b), 4 * row + place)
        })
    })
}

/// Add the edge of some sides, each the larger end above and the side below.
fn add_edge(edges: &mut Edges, elements: &[Element], low: i32, sides: &[u64]) {
    let side_of = |key: u64| ((key as u32 / 4) as usize, (key as u32 % 4) as usize);
    let runs_up = |(element, place): (usize, usize)| {
        let nodes = elements[element];
        nodes[place] < nodes[following(nodes, place)]
    };
    for key in sides {
        let (element, place) = side_of(*key);
        edges.of_elements[element][place] = edges.ends.len() as i32;
    }
    edges.ends.push([low, (sides[0] >> 32) as i32]);
    edges.uses.push(sides.len() as i32);
    if let [first, second] = *sides {
        let (first, second) = (side_of(first), side_of(second));
        edges.elements.push([first.0 as i32, second.0 as i32]);
        edges.opposed.push(runs_up(first) != runs_up(second));
    } else {
        edges.elements.push([-1, -1]);
        edges.opposed.push(false);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn two_elements_share_an_edge() {
        let edges = find_edges(&[[0, 1, 2, -1], [1, 3, 4, 2]], 5);
        assert_eq!(edges.ends, [[0, 1], [0, 2], [1, 2], [1, 3], [2, 4], [3, 4]]);
        assert_eq!(edges.of_elements, [[0, 2, 1, -1], [3, 5, 4, 2]]);
        assert_eq!(edges.elements[2], [0, 1]);
        assert!(edges.opposed[2]);
    }

    proptest! {
        #[test]
        fn each_side_is_of_one_edge(
            elements in prop::collection::vec(prop::array::uniform4(0i32..8), 0..20),
            tria in prop::collection::vec(any::<bool>(), 20),
        ) {
            let elements: Vec<Element> = elements.iter().zip(tria)
                .map(|(e, tria)| if tria { [e[0], e[1], e[2], -1] } else { *e }).collect();
            let edges = find_edges(&elements, 8);
            let sides: usize = elements.iter().map(|e| size_of(*e)).sum();
            prop_assert_eq!(edges.uses.iter().sum::<i32>() as usize, sides);
            prop_assert!(edges.ends.is_sorted_by(|a, b| a < b));
            for (element, of_element) in elements.iter().zip(&edges.of_elements) {
                for place in 0..size_of(*element) {
                    let (a, b) = (element[place], element[following(*element, place)]);
                    prop_assert_eq!(edges.ends[of_element[place] as usize], [a.min(b), a.max(b)]);
                }
            }
        }
    }
}
