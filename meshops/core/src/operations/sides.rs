//! Directed sides of a few elements of a mesh, found by the node that they leave.
//!
//! Nodes are marked by the candidate that the sides are of, so that nothing has to be wiped out
//! between candidates.

/// Ends a list of sides.
const NONE: u32 = u32::MAX;

/// Which candidate last marked each node, and the first of its sides that leaves the node.
#[derive(Clone, Debug)]
pub struct NodeMarks {
    candidate: Vec<u32>,
    first_side: Vec<u32>,
}

impl NodeMarks {
    /// No node is marked by a candidate from 1 on.
    pub fn new(nodes: usize) -> Self {
        // apart, as zeros alone cost nothing until they are looked at
        Self { candidate: vec![0; nodes], first_side: vec![0; nodes] }
    }

    /// Whether a candidate has marked a node.
    #[inline]
    pub fn has(&self, node: i32, candidate: u32) -> bool {
        self.candidate[node as usize] == candidate
    }

    /// Mark a node; whether it was not marked yet.
    #[inline]
    pub fn add(&mut self, node: i32, candidate: u32) -> bool {
        let is_new = !self.has(node, candidate);
        if is_new {
            self.candidate[node as usize] = candidate;
            self.first_side[node as usize] = NONE;
        }
        is_new
    }
}

/// Directed sides of elements; those that leave the same node are chained.
#[derive(Clone, Debug, Default)]
pub struct Sides {
    sides: Vec<Side>,
}

/// A side.
#[derive(Clone, Copy, Debug)]
pub struct Side {
    /// Where it leads to.
    pub end: i32,
    /// The element that it is of.
    pub element: u32,
    /// The next side that leaves the same node.
    next: u32,
}

impl Sides {
    /// Take all sides out.
    pub fn clear(&mut self) {
        self.sides.clear();
    }

    /// How many sides there are.
    pub fn len(&self) -> usize {
        self.sides.len()
    }

    /// Add a side that leaves a marked node.
    pub fn push(&mut self, marks: &mut NodeMarks, start: i32, end: i32, element: usize) {
        let first = &mut marks.first_side[start as usize];
        let side = Side { end, element: element as u32, next: *first };
        *first = self.sides.len() as u32;
        self.sides.push(side);
    }

    /// Sides that leave a marked node.
    #[inline]
    pub fn leaving(&self, marks: &NodeMarks, start: i32) -> impl Iterator<Item = &Side> {
        let mut at = marks.first_side[start as usize];
        std::iter::from_fn(move || {
            let side = self.sides.get(at as usize)?;
            at = side.next;
            Some(side)
        })
    }

    /// How many sides lead from a marked node to another one.
    #[inline]
    pub fn count(&self, marks: &NodeMarks, start: i32, end: i32) -> usize {
        self.leaving(marks, start).filter(|side| side.end == end).count()
    }
}
