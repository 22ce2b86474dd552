//! A patch that changes element by element and can take each change back.
//!
//! It knows the elements around each node at all times, and has room for some nodes and elements
//! more. An element with no node first is an empty row; a node that no element uses is one to come.
//! Each change costs the same, however large the patch is; finding an empty row or an unused node
//! costs little unless there is hardly any left.
//!
//! A change that says [`NotDone`] may have been begun: it must be taken back before anything else.

use crate::mesh::{Element, NO_NODE, following, is_tria, preceding};
use crate::vectors::Vector;

/// Elements around a node at the most.
pub const MOST_AROUND: usize = 10;

/// Changes of elements, and of places of nodes, between two settlements at the most.
pub const MOST_CHANGES: usize = 64;

/// A row without an element.
pub const EMPTY: Element = [NO_NODE; 4];

/// A change cannot be done, or not wholly.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NotDone;

/// Whether a change was done.
pub type Done = Result<(), NotDone>;

/// The elements around a node, in any order.
#[derive(Clone, Copy, Debug, Default)]
pub struct Ring {
    count: u32,
    rows: [i32; MOST_AROUND],
}

impl Ring {
    /// Their rows.
    #[inline]
    pub fn rows(&self) -> &[i32] {
        &self.rows[..self.count as usize]
    }

    #[inline]
    fn push(&mut self, row: i32) -> Done {
        *self.rows.get_mut(self.count as usize).ok_or(NotDone)? = row;
        self.count += 1;
        Ok(())
    }

    #[inline]
    fn take(&mut self, row: i32) {
        if let Some(last) = self.rows().len().checked_sub(1) {
            if let Some(place) = self.rows[..last].iter().position(|other| *other == row) {
                self.rows[place] = self.rows[last];
            }
            self.count = last as u32;
        }
    }
}

/// The elements around a node in order, each beginning where the one before ends.
#[derive(Clone, Copy, Debug)]
pub struct Fan {
    ring: Ring,
    /// Whether they close around the node.
    pub closed: bool,
}

impl Fan {
    /// Their rows.
    #[inline]
    pub fn rows(&self) -> &[i32] {
        self.ring.rows()
    }

    /// The row in a place, counted on around the node.
    #[inline]
    pub fn row(&self, place: usize) -> usize {
        self.rows()[place % self.rows().len()] as usize
    }
}

/// What a row of elements was.
#[derive(Clone, Copy, Debug)]
pub struct ElementChange {
    /// The row.
    pub row: usize,
    /// What was in it.
    pub before: Element,
}

/// Where a node was.
#[derive(Clone, Copy, Debug)]
pub struct NodeMove {
    /// The node.
    pub node: i32,
    /// Where it was.
    pub before: Vector,
}

/// A patch whose last changes can be taken back.
#[derive(Clone, Debug)]
pub struct UndoablePatch {
    points: Vec<Vector>,
    elements: Vec<Element>,
    rings: Vec<Ring>,
    element_changes: Vec<ElementChange>,
    node_moves: Vec<NodeMove>,
    element_cursor: usize,
    node_cursor: usize,
}

impl UndoablePatch {
    /// Make a patch to which `room` nodes and elements may come.
    ///
    /// None where more elements meet at a node than there is room for. Elements name no node beyond
    /// the points.
    pub fn new(points: &[Vector], elements: &[Element], room: usize) -> Option<Self> {
        let mut patch = Self {
            points: points.to_vec(),
            elements: elements.to_vec(),
            rings: vec![Ring::default(); points.len() + room],
            element_changes: Vec::with_capacity(MOST_CHANGES),
            node_moves: Vec::with_capacity(MOST_CHANGES),
            element_cursor: elements.len(),
            node_cursor: points.len(),
        };
        patch.points.resize(points.len() + room, [0.0; 3]);
        patch.elements.resize(elements.len() + room, EMPTY);
        for (row, element) in elements.iter().enumerate() {
            for node in element.iter().filter(|node| **node >= 0) {
                patch.rings[*node as usize].push(row as i32).ok()?;
            }
        }
        Some(patch)
    }

    /// Places of all nodes, also of those to come.
    #[inline]
    pub fn points(&self) -> &[Vector] {
        &self.points
    }

    /// All rows of elements, also the empty ones.
    #[inline]
    pub fn elements(&self) -> &[Element] {
        &self.elements
    }

    /// Place of a node.
    #[inline]
    pub fn point(&self, node: i32) -> Vector {
        self.points[node as usize]
    }

    /// Elements around a node.
    #[inline]
    pub fn around(&self, node: i32) -> &[i32] {
        self.rings[node as usize].rows()
    }

    /// Corners of an element: 3 or 4; 0 of an empty row.
    #[inline]
    pub fn size(&self, row: usize) -> usize {
        let element = self.elements[row];
        match element {
            [NO_NODE, ..] => 0,
            _ if is_tria(element) => 3,
            _ => 4,
        }
    }

    /// Which corner of an element a node is.
    #[inline]
    pub fn corner(&self, row: usize, node: i32) -> Option<usize> {
        self.elements[row].iter().position(|other| *other == node)
    }

    /// Node that follows a corner of an element.
    #[inline]
    pub fn ahead(&self, row: usize, corner: usize) -> i32 {
        let element = self.elements[row];
        element[following(element, corner)]
    }

    /// Node before a corner of an element.
    #[inline]
    pub fn behind(&self, row: usize, corner: usize) -> i32 {
        let element = self.elements[row];
        element[preceding(element, corner)]
    }

    /// Element in which node `b` follows node `a`.
    #[inline]
    pub fn element_with_side(&self, a: i32, b: i32) -> Option<usize> {
        let rows = self.around(a).iter().map(|row| *row as usize);
        let follows = |row: &usize| self.corner(*row, a).is_some_and(|k| self.ahead(*row, k) == b);
        rows.into_iter().find(follows)
    }

    /// The elements around a node in order; of a fan that is open the first has none before it.
    pub fn fan(&self, node: i32) -> Fan {
        let mut fan = Fan { ring: Ring::default(), closed: true };
        let around = self.around(node);
        let Some(start) = around.first().map(|row| *row as usize) else {
            return fan;
        };
        let mut first = start;
        for _ in around {
            // the element before shares the edge to the node that follows
            let edge = self.corner(first, node).map(|k| self.ahead(first, k));
            match edge.and_then(|other| self.element_with_side(other, node)) {
                None => {
                    fan.closed = false;
                    break;
                }
                Some(before) if before == start => break,
                Some(before) => first = before,
            }
        }
        let mut row = Some(first);
        while let Some(at) = row
            && fan.rows().len() < around.len()
            && fan.ring.push(at as i32).is_ok()
        {
            let edge = self.corner(at, node).map(|k| self.behind(at, k));
            row = edge.and_then(|other| self.element_with_side(node, other));
        }
        fan
    }

    /// Changes of elements since the last settlement.
    #[inline]
    pub fn element_changes(&self) -> &[ElementChange] {
        &self.element_changes
    }

    /// Nodes that moved since the last settlement, once for each move.
    #[inline]
    pub fn node_moves(&self) -> &[NodeMove] {
        &self.node_moves
    }

    /// Give a row other nodes; [`EMPTY`] removes the element, and an empty row gets one.
    pub fn rewrite(&mut self, row: usize, element: Element) -> Done {
        if self.element_changes.len() == MOST_CHANGES {
            return Err(NotDone);
        }
        self.element_changes.push(ElementChange { row, before: self.elements[row] });
        self.write(row, element)
    }

    /// Empty a row.
    pub fn remove(&mut self, row: usize) -> Done {
        self.rewrite(row, EMPTY)
    }

    /// Put another node in the place of one.
    pub fn rename(&mut self, row: usize, node: i32, other: i32) -> Done {
        let renamed = self.elements[row].map(|old| if old == node { other } else { old });
        self.rewrite(row, renamed)
    }

    /// Move a node.
    pub fn put(&mut self, node: i32, place: Vector) -> Done {
        if self.node_moves.len() == MOST_CHANGES {
            return Err(NotDone);
        }
        let point = &mut self.points[node as usize];
        self.node_moves.push(NodeMove { node, before: *point });
        *point = place;
        Ok(())
    }

    /// Find a row without an element, the next one after that found before.
    pub fn empty_row(&mut self) -> Option<usize> {
        for _ in 0..self.elements.len() {
            self.element_cursor = next(self.element_cursor, self.elements.len());
            if self.elements[self.element_cursor][0] < 0 {
                return Some(self.element_cursor);
            }
        }
        None
    }

    /// Find a node from `first` on that no element uses, the next one after that found before.
    pub fn unused_node(&mut self, first: i32) -> Option<i32> {
        for _ in 0..self.rings.len() {
            self.node_cursor = next(self.node_cursor, self.rings.len());
            let node = self.node_cursor as i32;
            if node >= first && self.around(node).is_empty() {
                return Some(node);
            }
        }
        None
    }

    /// Keep all changes.
    pub fn settle(&mut self) {
        self.element_changes.clear();
        self.node_moves.clear();
    }

    /// Undo all changes since the last settlement.
    pub fn take_back(&mut self) {
        while let Some(ElementChange { row, before }) = self.element_changes.pop() {
            let written = self.write(row, before);
            debug_assert_eq!(written, Ok(()), "there was room before");
        }
        while let Some(NodeMove { node, before }) = self.node_moves.pop() {
            self.points[node as usize] = before;
        }
    }

    /// Write a row and keep the elements around nodes; a node without room for one is left out.
    fn write(&mut self, row: usize, element: Element) -> Done {
        for node in self.elements[row].into_iter().filter(|node| *node >= 0) {
            self.rings[node as usize].take(row as i32);
        }
        let mut done = Ok(());
        let mut written = element;
        for node in written.iter_mut().filter(|node| **node >= 0) {
            if self.rings[*node as usize].push(row as i32).is_err() {
                *node = NO_NODE;
                done = Err(NotDone);
            }
        }
        self.elements[row] = written;
        done
    }
}

#[inline]
fn next(cursor: usize, count: usize) -> usize {
    if cursor + 1 < count { cursor + 1 } else { 0 }
}
