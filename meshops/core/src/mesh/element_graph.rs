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

    /// Whether nothing leads out of it: edges are there, and are at the elements that have them.
    pub fn is_whole(&self) -> bool {
        let elements = self.len().min(i32::MAX as usize) as u32;
        let has_two = |edge: usize| {
            let [a, b] = self.edge_elements[edge];
            (a as u32) < elements && (b as u32) < elements
        };
        let are_two =
            (0..self.edge_elements.len()).all(|edge| !self.crossable[edge] || has_two(edge));
        are_two
            && self.element_edges.iter().zip(0..).all(|(edges, element)| {
                edges.iter().filter(|edge| **edge >= 0).all(|edge| {
                    let edge = *edge as usize;
                    match self.crossable.get(edge) {
                        Some(crossable) => {
                            !crossable || self.edge_elements[edge].contains(&element)
                        }
                        None => false,
                    }
                })
            })
    }

    /// The element across a side, if there is one and the edge may be crossed.
    #[inline(always)]
    pub fn across(&self, element: usize, side: usize) -> Option<usize> {
        self.across_edge(element, self.element_edges[element][side])
    }

    /// The elements across the sides of an element, in their order.
    #[inline(always)]
    pub fn neighbours(self, element: usize) -> impl Iterator<Item = usize> + use<'a> {
        let edges = self.element_edges[element];
        edges.into_iter().filter_map(move |edge| self.across_edge(element, edge))
    }

    #[inline(always)]
    fn across_edge(&self, element: usize, edge: i32) -> Option<usize> {
        // no edge, -1, is beyond all of them
        if !*self.crossable.get(edge as u32 as usize)? {
            return None;
        }
        let [a, b] = self.edge_elements[edge as usize];
        Some(if a == element as i32 { b } else { a } as usize)
    }

    /// The element across a side, and the first of its own sides that is the same edge.
    #[inline]
    pub fn enter(&self, element: usize, side: usize) -> Option<(usize, usize)> {
        let other = self.across(element, side)?;
        let edge = self.element_edges[element][side];
        let entered = self.element_edges[other].iter().position(|same| *same == edge)?;
        Some((other, entered))
    }
}
