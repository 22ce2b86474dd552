//! Cutting patches out of a mesh.

use super::element_graph::ElementGraph;
use super::{Element, following, size_of};

/// Elements out of how many, for each of the patch, are few.
const FEW: usize = 16;

/// Connected elements on nodes of their own.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Patch {
    /// The elements on patch nodes; border nodes come first.
    pub elements: Vec<Element>,
    /// The mesh node of each patch node.
    pub nodes: Vec<i32>,
    /// Border edges on patch nodes, in the direction of their element.
    pub border: Vec<[i32; 2]>,
}

/// Cut connected elements out along every barrier, also those that end inside the patch.
///
/// Two corners are the same patch node only where a crossable edge inside the patch joins them, so
/// the patch is manifold even where the mesh around it is not, and a node on a slit appears once
/// on either side. `rows` ascend. The cost grows with the patch, not with the mesh.
pub fn cut(rows: &[i32], elements: &[Element], graph: ElementGraph<'_>) -> Patch {
    let places = Places::of(rows);
    let mut corners = Corners::new(rows.len());
    let mut border_sides = Vec::new();
    for (i, row) in rows.iter().enumerate() {
        let row = *row as usize;
        let element = elements[row];
        for side in 0..size_of(element) {
            let other = graph.across(row, side).and_then(|other| places.find(other));
            let Some(other) = other else {
                border_sides.push((i, side));
                continue;
            };
            if other > i {
                let neighbour = elements[rows[other] as usize];
                let ahead = following(element, side);
                for (k, node) in neighbour.iter().enumerate() {
                    if *node == element[side] {
                        corners.join(4 * other + k, 4 * i + side);
                    } else if *node == element[ahead] {
                        corners.join(4 * other + k, 4 * i + ahead);
                    }
                }
            }
        }
    }

    let mut patch = Patch {
        elements: vec![[-1; 4]; rows.len()],
        nodes: Vec::new(),
        border: Vec::with_capacity(border_sides.len()),
    };
    for (i, side) in border_sides {
        let element = elements[rows[i] as usize];
        let ends = [side, following(element, side)];
        let number = |corner| corners.number(4 * i + corner, element[corner], &mut patch.nodes);
        let edge = ends.map(number);
        patch.border.push(edge);
    }
    for (i, row) in rows.iter().enumerate() {
        let element = elements[*row as usize];
        for corner in 0..size_of(element) {
            patch.elements[i][corner] =
                corners.number(4 * i + corner, element[corner], &mut patch.nodes);
        }
    }
    patch
}

/// Finds an element's place among ascending rows.
enum Places<'a> {
    /// By the rows from a first one on: the place and 1, or 0.
    Listed(usize, Vec<u32>),
    /// By the rows themselves, where they are few of many.
    Sought(&'a [i32]),
}

impl<'a> Places<'a> {
    fn of(rows: &'a [i32]) -> Self {
        let (Some(first), Some(last)) = (rows.first(), rows.last()) else {
            return Self::Sought(rows);
        };
        let span = (last - first) as usize + 1;
        if span > FEW * rows.len() {
            return Self::Sought(rows);
        }
        let mut listed = vec![0; span];
        for (row, place) in rows.iter().zip(1..) {
            listed[(row - first) as usize] = place;
        }
        Self::Listed(*first as usize, listed)
    }

    #[inline]
    fn find(&self, element: usize) -> Option<usize> {
        match self {
            Self::Listed(first, listed) => {
                let place = *listed.get(element.wrapping_sub(*first))?;
                (place as usize).checked_sub(1)
            }
            Self::Sought(rows) => rows.binary_search(&(element as i32)).ok(),
        }
    }
}

/// Corners of elements that are the same node (disjoint sets).
struct Corners {
    parent: Vec<u32>,
    number: Vec<i32>,
}

impl Corners {
    fn new(elements: usize) -> Self {
        Self { parent: (0..4 * elements as u32).collect(), number: vec![-1; 4 * elements] }
    }

    fn root(&mut self, corner: usize) -> usize {
        let mut corner = corner as u32;
        while self.parent[corner as usize] != corner {
            let above = self.parent[self.parent[corner as usize] as usize];
            self.parent[corner as usize] = above;
            corner = above;
        }
        corner as usize
    }

    fn join(&mut self, corner: usize, other: usize) {
        let (root, above) = (self.root(corner), self.root(other));
        self.parent[root] = above as u32;
    }

    /// The patch node of a corner; a new one of mesh node `node` where it has none yet.
    fn number(&mut self, corner: usize, node: i32, nodes: &mut Vec<i32>) -> i32 {
        let root = self.root(corner);
        if self.number[root] < 0 {
            self.number[root] = nodes.len() as i32;
            nodes.push(node);
        }
        self.number[root]
    }
}
