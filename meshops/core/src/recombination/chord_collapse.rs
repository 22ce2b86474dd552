//! Chord collapse: a row of quads is taken out of the mesh.
//!
//! A chord follows opposite sides of quads. It closes on itself or, as a strip, leads from one tria
//! to another (Borden, Benzley and Shepherd 2002). Where a part of a chord ends in a quad a tria is
//! left there: the tria has moved to that place (the paper's Figure 11). The cost grows with the
//! elements around the rungs, and with the mesh for the arrays.

use super::strips::{Rung, StripsView};
use crate::mesh::Element;
use crate::mesh::csr::CsrView;
use crate::mesh::lists::Lists;
use crate::operations::merging::merged_element;
use crate::vectors::{Vector, add, scale};

/// A node that gets another place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NodeMove {
    /// Its row.
    pub node: i32,
    /// The place.
    pub place: Vector,
}

/// What is left of the mesh; list `s` of each is of strip `s`, empty for what cannot be done.
#[derive(Clone, Debug, PartialEq)]
pub struct CollapsedChords {
    /// Rows of the elements that go.
    pub removed: Lists<i32>,
    /// Those that come.
    pub added: Lists<Element>,
    /// Where nodes move.
    pub moved: Lists<NodeMove>,
}

/// The mesh that chords are taken out of.
#[derive(Clone, Copy, Debug)]
pub struct ChordGround<'a> {
    /// Places of the nodes.
    pub points: &'a [Vector],
    /// The elements.
    pub elements: &'a [Element],
    /// Those around each node.
    pub around: CsrView<'a>,
    /// Which nodes may move and vanish.
    pub free: &'a [bool],
}

/// Merge the two nodes of every rung, half-way or at the one that cannot move.
///
/// The quads between two rungs vanish, a tria at the end vanishes, and a quad at the end becomes a
/// tria. Nothing is done where a node is on two rungs, or both nodes of a rung have to stay.
pub fn collapse_chords(strips: StripsView<'_>, ground: ChordGround<'_>) -> CollapsedChords {
    let mut merging = Merging {
        ground,
        target: (0..ground.points.len() as i32).collect(),
        marks: vec![u32::MAX; ground.points.len()],
        gone: vec![u32::MAX; ground.elements.len()],
        strip: 0,
    };
    let mut chords = CollapsedChords {
        removed: Lists::with_room(strips.len()),
        added: Lists::with_room(strips.len()),
        moved: Lists::with_room(strips.len()),
    };
    for (number, strip) in strips.iter().enumerate() {
        merging.strip = number as u32;
        merging.collapse(strip.rungs, &mut chords);
        chords.removed.close();
        chords.added.close();
        chords.moved.close();
    }
    chords
}

/// Nodes of one strip that are merged.
struct Merging<'a> {
    ground: ChordGround<'a>,
    /// The node that each one is merged into; itself for most.
    target: Vec<i32>,
    /// The strip that last had a node on a rung.
    marks: Vec<u32>,
    /// The strip that last took an element away.
    gone: Vec<u32>,
    /// The strip at hand.
    strip: u32,
}

impl Merging<'_> {
    fn collapse(&mut self, rungs: &[Rung], chords: &mut CollapsedChords) {
        if !self.can_merge(rungs) {
            return;
        }
        for rung in nodes_of(rungs) {
            let [goes, stays] = self.ends(rung);
            self.target[goes] = stays as i32;
        }
        for rung in nodes_of(rungs) {
            let [goes, stays] = self.ends(rung);
            self.merge_around(goes, chords);
            if self.ground.free[stays] {
                let sum = add(self.ground.points[goes], self.ground.points[stays]);
                chords.moved.push(NodeMove { node: stays as i32, place: scale(sum, 0.5) });
            }
        }
        for node in nodes_of(rungs).flatten() {
            self.target[node] = node as i32;
        }
    }

    /// Whether no node is on two rungs, and one of each rung is free.
    fn can_merge(&mut self, rungs: &[Rung]) -> bool {
        for rung in nodes_of(rungs) {
            for node in rung {
                let is_free = self.ground.free[rung[0]] || self.ground.free[rung[1]];
                if self.marks[node] == self.strip || !is_free {
                    return false;
                }
                self.marks[node] = self.strip;
            }
        }
        true
    }

    /// The node of a rung that vanishes, and the one that stays.
    #[inline]
    fn ends(&self, [a, b]: [usize; 2]) -> [usize; 2] {
        if self.ground.free[a] { [a, b] } else { [b, a] }
    }

    /// Take the elements around a node away, and put back what is left of them.
    fn merge_around(&mut self, node: usize, chords: &mut CollapsedChords) {
        for row in self.ground.around.list(node) {
            let gone = &mut self.gone[*row as usize];
            if *gone == self.strip {
                continue;
            }
            *gone = self.strip;
            chords.removed.push(*row);
            let element = self.ground.elements[*row as usize];
            if let Some(left) = merged_element(element, &self.target) {
                chords.added.push(left);
            }
        }
    }
}

/// The rungs that are there.
#[inline]
fn nodes_of(rungs: &[Rung]) -> impl Iterator<Item = [usize; 2]> {
    rungs.iter().filter(|rung| rung[0] >= 0).map(|rung| rung.map(|node| node as usize))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::node_elements::elements_of_nodes;

    /// Two trias between two quads.
    const ELEMENTS: [Element; 4] = [[0, 1, 2, -1], [2, 1, 3, -1], [4, 5, 1, 0], [2, 3, 6, 7]];
    const POINTS: [Vector; 8] = [
        [-1.0, 0.0, 0.0],
        [0.0, -1.0, 0.0],
        [0.0, 1.0, 0.0],
        [1.0, 0.0, 0.0],
        [-1.0, -2.0, 0.0],
        [0.0, -2.0, 0.0],
        [1.0, 2.0, 0.0],
        [0.0, 2.0, 0.0],
    ];
    const STRIP: StripsView<'_> =
        StripsView { start: &[0, 2], cells: &[0, 1], rungs: &[[1, 2], [-1, -1]] };

    fn collapsed(free: &[bool]) -> CollapsedChords {
        let around = elements_of_nodes(&ELEMENTS, 8);
        let ground =
            ChordGround { points: &POINTS, elements: &ELEMENTS, around: around.view(), free };
        collapse_chords(STRIP, ground)
    }

    #[test]
    fn both_trias_vanish_with_the_edge_between() {
        let chords = collapsed(&[true; 8]);
        assert_eq!(chords.removed.list(0), [0, 1, 2]);
        assert_eq!(chords.added.list(0), [[4, 5, 2, 0]]);
        assert_eq!(chords.moved.list(0), [NodeMove { node: 2, place: [0.0; 3] }]);
    }

    #[test]
    fn nodes_meet_at_the_one_that_cannot_move() {
        let mut free = [true; 8];
        free[1] = false;
        let chords = collapsed(&free);
        assert_eq!(chords.removed.list(0), [0, 1, 3]);
        assert_eq!(chords.added.list(0), [[1, 3, 6, 7]]);
        assert!(chords.moved.list(0).is_empty());
        assert!(collapsed(&[false; 8]).removed.list(0).is_empty());
    }
}
