//! The graph of elements that are joined across edges (the dual graph of the mesh).

/// Elements of a mesh, joined across the edges that may be crossed.
#[derive(Clone, Copy, Debug)]
pub struct ElementGraph<'a> {
    /// The edge of each side of each element; -1 fourth for a tria.
    pub element_edges: &'a [[i32; 4]],
    /// The two elements of an edge that has exactly two; elsewhere -1.
    pub edge_elements: &'a [[i32; 2]],
    /// Which edges may be crossed; each has two elements.
    pub crossable: &'a [bool],
}

impl<'a> ElementGraph<'a> {
    /// How many elements there are.
    #[inline]
    pub fn len(&self) -> usize {
        self.element_edges.len()
    }

    /// Whether there is no element.
    #[inline]
    pub fn is_empty(&self) -> bool {
        self.element_edges.is_empty()
    }

    /// The element across a side, if there is one and the edge may be crossed.
    #[inline]
    pub fn across(&self, element: usize, side: usize) -> Option<usize> {
        let edge = self.element_edges[element][side];
        if edge < 0 || !self.crossable[edge as usize] {
            return None;
        }
        let [a, b] = self.edge_elements[edge as usize];
        Some((a + b - element as i32) as usize)
    }

    /// The elements across the sides of an element, in their order.
    #[inline]
    pub fn neighbours(self, element: usize) -> impl Iterator<Item = usize> + use<'a> {
        (0..4).filter_map(move |side| self.across(element, side))
    }
}
