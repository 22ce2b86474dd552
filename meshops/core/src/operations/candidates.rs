//! Candidates: many small edits of one mesh, each to be looked at on its own.

use crate::mesh::Element;
use crate::mesh::csr::CsrView;
use crate::vectors::Vector;

/// One small edit. Node rows from the mesh's node count on stand for its new points, in order.
#[derive(Clone, Copy, Debug)]
pub struct Candidate<'a> {
    /// Rows of the elements that go.
    pub removed: &'a [i32],
    /// Elements that come in their place.
    pub added: &'a [Element],
    /// New points.
    pub points: &'a [Vector],
    /// Nodes that get another place.
    pub moved: &'a [i32],
    /// Their places.
    pub moved_to: &'a [Vector],
}

/// Small edits, their lists one behind the other.
#[derive(Clone, Copy, Debug)]
pub struct Candidates<'a> {
    /// Rows of the elements that go.
    pub removed: CsrView<'a>,
    /// Where the elements that come start.
    pub added_start: &'a [i32],
    /// Elements that come.
    pub added: &'a [Element],
    /// Where the new points start.
    pub point_start: &'a [i32],
    /// New points.
    pub points: &'a [Vector],
    /// Nodes that get another place.
    pub moved: CsrView<'a>,
    /// Their places.
    pub moved_to: &'a [Vector],
}

impl<'a> Candidates<'a> {
    /// How many there are.
    pub fn len(&self) -> usize {
        self.removed.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Candidate `k`.
    #[inline]
    pub fn get(&self, k: usize) -> Candidate<'a> {
        Candidate {
            removed: self.removed.list(k),
            added: part(self.added_start, self.added, k),
            points: part(self.point_start, self.points, k),
            moved: self.moved.list(k),
            moved_to: part(self.moved.start, self.moved_to, k),
        }
    }

    /// One after the other.
    pub fn iter(self) -> impl Iterator<Item = Candidate<'a>> {
        (0..self.len()).map(move |k| self.get(k))
    }

    /// The most new points that one of them has.
    pub fn most_points(&self) -> usize {
        self.iter().map(|candidate| candidate.points.len()).max().unwrap_or(0)
    }
}

/// What belongs to candidate `k`.
#[inline]
fn part<'a, T>(start: &[i32], items: &'a [T], k: usize) -> &'a [T] {
    &items[start[k] as usize..start[k + 1] as usize]
}

/// Small edits that are being listed.
#[derive(Clone, Debug, PartialEq)]
pub struct CandidateList {
    /// Where the rows of the elements that go start.
    pub removed_start: Vec<i32>,
    /// Rows of the elements that go.
    pub removed: Vec<i32>,
    /// Where the elements that come start.
    pub added_start: Vec<i32>,
    /// Elements that come.
    pub added: Vec<Element>,
    /// Where the new points start.
    pub point_start: Vec<i32>,
    /// New points.
    pub points: Vec<Vector>,
    /// Where the nodes that get another place start.
    pub moved_start: Vec<i32>,
    /// Nodes that get another place.
    pub moved: Vec<i32>,
    /// Their places.
    pub moved_to: Vec<Vector>,
}

impl Default for CandidateList {
    fn default() -> Self {
        Self::with_capacity(0)
    }
}

impl CandidateList {
    /// No candidate, with room for some.
    pub fn with_capacity(candidates: usize) -> Self {
        let start = || {
            let mut start = Vec::with_capacity(candidates + 1);
            start.push(0);
            start
        };
        Self {
            removed_start: start(),
            removed: Vec::new(),
            added_start: start(),
            added: Vec::new(),
            point_start: start(),
            points: Vec::new(),
            moved_start: start(),
            moved: Vec::new(),
            moved_to: Vec::new(),
        }
    }

    /// End the candidate whose elements, points and nodes were pushed; empty if none was.
    pub fn end(&mut self) {
        self.removed_start.push(self.removed.len() as i32);
        self.added_start.push(self.added.len() as i32);
        self.point_start.push(self.points.len() as i32);
        self.moved_start.push(self.moved.len() as i32);
    }

    /// Borrow them.
    pub fn view(&self) -> Candidates<'_> {
        Candidates {
            removed: CsrView { start: &self.removed_start, items: &self.removed },
            added_start: &self.added_start,
            added: &self.added,
            point_start: &self.point_start,
            points: &self.points,
            moved: CsrView { start: &self.moved_start, items: &self.moved },
            moved_to: &self.moved_to,
        }
    }
}
