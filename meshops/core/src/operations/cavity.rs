//! Cavity validity: whether a mesh stays whole where some elements go and others come.
//!
//! Places are left aside. The border of what comes must be that of the cavity that opens where
//! elements go. From this follows that no hole opens and no edge gets a third element; and, where
//! all elements face the same way on a plane, that the area stays. As the border and the Euler
//! number are the same, so is the surface, and nowhere is it pinched.
//!
//! The mesh is taken to be whole where it is not touched. The cost grows with the elements that go
//! and come and with those around their nodes; scratch grows with the mesh, but is made once.

use super::candidates::Candidate;
use super::sides::{NodeMarks, Sides};
use crate::mesh::csr::CsrView;
use crate::mesh::element_graph::ElementGraph;
use crate::mesh::{Element, following, size_of};

/// A mesh in which cavities are opened.
#[derive(Clone, Copy, Debug)]
pub struct CavityMesh<'a> {
    /// The elements.
    pub elements: &'a [Element],
    /// Those around each node.
    pub around: CsrView<'a>,
    /// How they are joined.
    pub graph: ElementGraph<'a>,
    /// The zone of each element; -1 where it may not go.
    pub zones: &'a [i32],
    /// Which nodes may move or vanish.
    pub free: &'a [bool],
}

/// Scratch for candidates of one mesh.
pub struct CavityChecker<'a> {
    mesh: CavityMesh<'a>,
    /// Number of the candidate at hand, from 1.
    candidate: u32,
    /// The candidate that last took out an element.
    gone: Vec<u32>,
    /// Nodes of the elements that go, and of those that come.
    leaving: NodeMarks,
    coming: NodeMarks,
    /// The candidate that last moved a node.
    moving: Vec<u32>,
    /// The border of what goes, and all sides of what comes.
    outline: Sides,
    sides: Sides,
}

impl<'a> CavityChecker<'a> {
    /// Make ready for candidates that have up to so many new points.
    pub fn new(mesh: CavityMesh<'a>, most_points: usize) -> Self {
        let nodes = mesh.around.len();
        Self {
            mesh,
            candidate: 0,
            gone: vec![0; mesh.elements.len()],
            leaving: NodeMarks::new(nodes),
            coming: NodeMarks::new(nodes + most_points),
            moving: vec![0; nodes],
            outline: Sides::default(),
            sides: Sides::default(),
        }
    }

    /// Whether the candidate at hand takes out an element.
    #[inline]
    pub fn is_gone(&self, element: i32) -> bool {
        self.gone[element as usize] == self.candidate
    }

    /// Whether the mesh stays whole; also makes a candidate the one at hand.
    ///
    /// What goes may be taken out and is of one zone, and no barrier runs inside; the border of what
    /// comes is that of what goes; nodes that move or vanish are free; no edge and no element comes
    /// twice. A candidate that does nothing is none.
    pub fn is_whole(&mut self, candidate: &Candidate<'_>) -> bool {
        self.candidate += 1;
        if candidate.removed.is_empty()
            && (!candidate.added.is_empty() || candidate.moved.is_empty())
        {
            return false;
        }
        self.outline.clear();
        self.sides.clear();
        let Some(leaving) = self.take_out(candidate.removed) else { return false };
        let Some(coming) = self.put_in(candidate) else { return false };
        if !self.may_move(candidate.moved) {
            return false;
        }
        let Some(inner_before) = self.trace_outline(candidate.removed) else { return false };
        let Some(inner) = self.match_sides(candidate.added) else { return false };
        // nodes - edges + elements stays what it was
        let nodes = coming as i64 - leaving as i64;
        let edges = inner as i64 - inner_before as i64;
        let elements = candidate.added.len() as i64 - candidate.removed.len() as i64;
        nodes - edges + elements == 0
            && !self.has_doubles(candidate.added)
            && self.others_vanish(candidate.removed)
    }

    /// Mark the elements that go and their nodes; how many nodes these are.
    fn take_out(&mut self, removed: &[i32]) -> Option<usize> {
        let mut nodes = 0;
        for row in removed {
            let zone = self.mesh.zones[*row as usize];
            let gone = &mut self.gone[*row as usize];
            if zone < 0 || zone != self.mesh.zones[removed[0] as usize] || *gone == self.candidate {
                return None;
            }
            *gone = self.candidate;
            let element = self.mesh.elements[*row as usize];
            for node in &element[..size_of(element)] {
                nodes += usize::from(self.leaving.add(*node, self.candidate));
            }
        }
        Some(nodes)
    }

    /// Mark the nodes of the elements that come and list their sides; how many nodes these are.
    fn put_in(&mut self, candidate: &Candidate<'_>) -> Option<usize> {
        let old = self.mesh.around.len();
        let mut nodes = 0;
        for (row, element) in candidate.added.iter().enumerate() {
            let size = size_of(*element);
            for corner in 0..size {
                let node = element[corner];
                if node < 0
                    || node as usize >= old + candidate.points.len()
                    || ((node as usize) < old && !self.leaving.has(node, self.candidate))
                    || element[..corner].contains(&node)
                {
                    return None;
                }
                nodes += usize::from(self.coming.add(node, self.candidate));
                let end = element[following(*element, corner)];
                self.sides.push(&mut self.coming, node, end, row);
            }
        }
        Some(nodes)
    }

    /// Whether nodes may move: they are free, they stay, and none is named twice.
    fn may_move(&mut self, moved: &[i32]) -> bool {
        moved.iter().all(|node| {
            let moving = &mut self.moving[*node as usize];
            let is_first = *moving != self.candidate;
            *moving = self.candidate;
            let vanishes =
                self.leaving.has(*node, self.candidate) && !self.coming.has(*node, self.candidate);
            is_first && self.mesh.free[*node as usize] && !vanishes
        })
    }

    /// List the border sides of the elements that go, and count the edges inside.
    ///
    /// None where a barrier runs between two of them.
    fn trace_outline(&mut self, removed: &[i32]) -> Option<usize> {
        let ElementGraph { element_edges, edge_elements, crossable } = self.mesh.graph;
        let mut inner = 0;
        for row in removed {
            let element = self.mesh.elements[*row as usize];
            for side in 0..size_of(element) {
                let edge = element_edges[*row as usize][side] as usize;
                let other = match edge_elements.get(edge) {
                    Some([a, b]) if a == row => *b,
                    Some([a, _]) => *a,
                    None => -1,
                };
                if self.gone.get(other as usize) == Some(&self.candidate) {
                    if crossable.get(edge) != Some(&true) {
                        return None;
                    }
                    inner += 1;
                    continue;
                }
                let (start, end) = (element[side], element[following(element, side)]);
                self.outline.push(&mut self.leaving, start, end, 0);
            }
        }
        Some(inner / 2)
    }

    /// Count the edges inside what comes.
    ///
    /// None where its border is not the outline, where two sides run in the same direction, or where
    /// an element that stays has an edge that is new inside.
    fn match_sides(&self, added: &[Element]) -> Option<usize> {
        let nodes = self.mesh.around.len();
        let (mut inner, mut on_border) = (0, 0);
        for element in added {
            for corner in 0..size_of(*element) {
                let (start, end) = (element[corner], element[following(*element, corner)]);
                if self.sides.count(&self.coming, start, end) != 1 {
                    return None;
                }
                if self.sides.count(&self.coming, end, start) > 0 {
                    // seen from either side
                    inner += 1;
                    if start < end && !self.is_new(start, end) {
                        return None;
                    }
                } else {
                    let is_old = (start as usize) < nodes;
                    if !is_old || self.outline.count(&self.leaving, start, end) != 1 {
                        return None;
                    }
                    on_border += 1;
                }
            }
        }
        if on_border == self.outline.len() { Some(inner / 2) } else { None }
    }

    /// Whether no element that stays has the edge between two nodes.
    fn is_new(&self, start: i32, end: i32) -> bool {
        let nodes = self.mesh.around.len() as i32;
        if start >= nodes || end >= nodes {
            return true;
        }
        self.mesh.around.list(start as usize).iter().all(|row| {
            let element = self.mesh.elements[*row as usize];
            self.is_gone(*row) || !has_edge(element, start, end)
        })
    }

    /// Whether an element that comes is a double of one that stays, or of another that comes.
    fn has_doubles(&self, added: &[Element]) -> bool {
        added.iter().enumerate().any(|(row, element)| {
            // a double misses at most one corner
            element[..2].iter().any(|node| {
                let coming = self.sides.leaving(&self.coming, *node);
                let mut others = coming.map(|side| side.element as usize);
                if others.any(|other| other != row && is_double(*element, added[other])) {
                    return true;
                }
                let is_old = (*node as usize) < self.mesh.around.len();
                is_old
                    && self.mesh.around.list(*node as usize).iter().any(|other| {
                        let stays = !self.is_gone(*other);
                        stays && is_double(*element, self.mesh.elements[*other as usize])
                    })
            })
        })
    }

    /// Whether the nodes that no new element has may go: they are free, and nothing else uses them.
    fn others_vanish(&self, removed: &[i32]) -> bool {
        removed.iter().all(|row| {
            let element = self.mesh.elements[*row as usize];
            element[..size_of(element)].iter().all(|node| {
                let users = self.mesh.around.list(*node as usize);
                self.coming.has(*node, self.candidate)
                    || (self.mesh.free[*node as usize]
                        && users.iter().all(|other| self.is_gone(*other)))
            })
        })
    }
}

/// Whether an element has the edge between two nodes.
#[inline]
fn has_edge(element: Element, start: i32, end: i32) -> bool {
    (0..size_of(element)).any(|corner| {
        let (a, b) = (element[corner], element[following(element, corner)]);
        (a == start && b == end) || (a == end && b == start)
    })
}

/// Whether one element has all nodes of the other.
#[inline]
fn is_double(one: Element, other: Element) -> bool {
    let mut shared = 0;
    for node in one {
        for same in other {
            shared += usize::from(node >= 0 && node == same);
        }
    }
    shared >= size_of(one).min(size_of(other))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::edges::find_edges;
    use crate::mesh::node_elements::elements_of_nodes;
    use proptest::prelude::*;

    const NODES: usize = 16;

    /// Three rows of three quads.
    fn lattice() -> Vec<Element> {
        let corner = |i: i32| 4 * (i / 3) + i % 3;
        (0..9).map(corner).map(|a| [a, a + 1, a + 5, a + 4]).collect()
    }

    fn is_whole(removed: &[i32], added: &[Element], moved: &[i32], points: usize) -> bool {
        let elements = lattice();
        let edges = find_edges(&elements, NODES);
        let around = elements_of_nodes(&elements, NODES);
        let free: Vec<bool> = (0..NODES).map(|node| [5, 6, 9, 10].contains(&node)).collect();
        let mesh = CavityMesh {
            elements: &elements,
            around: around.view(),
            graph: ElementGraph {
                element_edges: &edges.of_elements,
                edge_elements: &edges.elements,
                crossable: &edges.opposed,
            },
            zones: &[0; 9],
            free: &free,
        };
        let (points, moved_to) = (vec![[0.0; 3]; points], vec![[0.0; 3]; moved.len()]);
        let candidate = Candidate { removed, added, points: &points, moved, moved_to: &moved_to };
        let mut checker = CavityChecker::new(mesh, points.len());
        // the one before leaves no trace
        checker.is_whole(&Candidate { removed: &[0, 1, 2, 4], added: &lattice(), ..candidate });
        checker.is_whole(&candidate)
    }

    #[test]
    fn a_cavity_may_be_filled_in_another_way() {
        assert!(is_whole(&[4], &[[5, 6, 10, -1], [5, 10, 9, -1]], &[5], 0));
        let around_a_new_node = [[5, 6, 16, -1], [6, 10, 16, -1], [10, 9, 16, -1], [9, 5, 16, -1]];
        assert!(is_whole(&[4], &around_a_new_node, &[], 1));
        assert!(is_whole(&[], &[], &[5, 6], 0));
    }

    #[test]
    fn what_would_tear_or_lap_is_refused() {
        assert!(!is_whole(&[4], &[], &[], 0));
        assert!(!is_whole(&[4], &[[5, 6, 10, -1]], &[], 0));
        assert!(!is_whole(&[4], &[[6, 5, 9, 10]], &[], 0));
        assert!(!is_whole(&[], &[[5, 6, 10, 9]], &[], 0));
        assert!(!is_whole(&[4, 4], &[[5, 6, 10, 9]], &[], 0));
        assert!(!is_whole(&[4], &[[5, 6, 10, 16]], &[], 0));
        assert!(!is_whole(&[], &[], &[0], 0));
        assert!(!is_whole(&[], &[], &[5, 5], 0));
    }

    proptest! {
        #[test]
        fn nonsense_is_refused_and_what_was_there_may_stay(
            rows in prop::collection::vec(0i32..9, 1..4),
            added in prop::collection::vec(prop::array::uniform4(-2i32..19), 0..5),
            moved in prop::collection::vec(0i32..16, 0..3),
        ) {
            if is_whole(&rows, &added, &moved, 2) {
                let nodes: usize = added.iter().map(|element| size_of(*element)).sum();
                prop_assert!(nodes >= 4);
            }
            let same: Vec<Element> = rows.iter().map(|row| lattice()[*row as usize]).collect();
            let distinct = (1..rows.len()).all(|k| !rows[..k].contains(&rows[k]));
            prop_assert_eq!(is_whole(&rows, &same, &[], 0), distinct);
        }
    }
}
