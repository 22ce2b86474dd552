//! The polygon around two elements that share an edge.

use crate::mesh::{Element, NO_NODE, size_of};

/// Nodes of the polygon around two elements, counter-clockwise.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PairPolygon {
    /// The nodes, [`NO_NODE`] beyond the last. The first is an end of the shared edge; those of the
    /// larger element come first, up to the other end.
    pub nodes: [i32; 6],
    /// How many there are: 4 to 6, or 0 where the elements share no edge.
    pub size: usize,
}

impl PairPolygon {
    /// Walk around two elements; of several edges that they share the first counts.
    pub fn around(one: Element, other: Element) -> Self {
        let (one, other) = if size_of(one) == 3 { (other, one) } else { (one, other) };
        let (size, other_size) = (size_of(one), size_of(other));
        let mut polygon = Self { nodes: [NO_NODE; 6], size: 0 };
        for side in 0..size {
            let (u, v) = (one[side], one[(side + 1) % size]);
            for k in 0..other_size {
                if other[k] != v || other[(k + 1) % other_size] != u {
                    continue;
                }
                for step in 0..size {
                    // from v around the one to u
                    polygon.nodes[step] = one[(side + 1 + step) % size];
                }
                for step in 2..other_size {
                    // from u around the other, back to v
                    polygon.nodes[size - 2 + step] = other[(k + step) % other_size];
                }
                polygon.size = size + other_size - 2;
                return polygon;
            }
        }
        polygon
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_larger_element_comes_first() {
        let polygon = PairPolygon::around([1, 4, 2, -1], [0, 1, 2, 3]);
        assert_eq!(polygon, PairPolygon { nodes: [2, 3, 0, 1, 4, -1], size: 5 });
        assert_eq!(PairPolygon::around([0, 1, 2, -1], [0, 1, 2, -1]).size, 0);
    }
}
