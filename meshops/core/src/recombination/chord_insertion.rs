//! Chord insertion: a row of quads is split lengthwise.
//!
//! A chord follows opposite sides of quads. It closes on itself or, as a strip, leads from one tria
//! to another (Borden, Benzley and Shepherd 2002). A part of a chord that ends in a quad makes a
//! tria there: the tria has moved to that place (the paper's Figure 11). The cost grows with the
//! cells of the strips.

use super::strips::{Strip, StripsView};
use crate::mesh::lists::Lists;
use crate::mesh::{Element, NO_NODE, is_tria, size_of};
use crate::vectors::{Vector, add, scale};

/// What chords make of the mesh; list `s` of each is of strip `s`, empty for what cannot be done.
#[derive(Clone, Debug, PartialEq)]
pub struct InsertedChords {
    /// Rows of the elements that go.
    pub removed: Lists<i32>,
    /// Those that come. Rows of nodes from the mesh's number of them on are new, in order.
    pub added: Lists<Element>,
    /// Places of the new nodes.
    pub points: Lists<Vector>,
}

/// On which side of the strip the tria is that a quad at the end becomes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum End {
    /// At the first node of the last rung. The only way where the strip does not end in a quad.
    First,
    /// At the second one.
    Second,
}

/// Put a node on the middle of every rung and split each strip lengthwise.
///
/// The quads between two rungs become two, a tria at the end becomes a quad, and a quad at the end
/// a quad and a tria.
pub fn insert_chords(
    strips: StripsView<'_>,
    ends: &[End],
    points: &[Vector],
    elements: &[Element],
) -> InsertedChords {
    let mut chords = InsertedChords {
        removed: Lists::with_room(strips.len()),
        added: Lists::with_room(strips.len()),
        points: Lists::with_room(strips.len()),
    };
    for (strip, end) in strips.iter().zip(ends) {
        if can_be_done(strip, *end, elements) {
            chords.insert(strip, *end, points, elements);
        }
        chords.removed.close();
        chords.added.close();
        chords.points.close();
    }
    chords
}

/// Whether it is another way than the first.
fn can_be_done(strip: Strip<'_>, end: End, elements: &[Element]) -> bool {
    let Some(last) = strip.cells.last() else { return false };
    end == End::First || (!strip.is_closed() && !is_tria(elements[*last as usize]))
}

impl InsertedChords {
    fn insert(&mut self, strip: Strip<'_>, end: End, points: &[Vector], elements: &[Element]) {
        let nodes = points.len() as i32;
        for (i, (cell, rung)) in strip.cells.iter().zip(strip.rungs).enumerate() {
            self.removed.push(*cell);
            let has_rung = rung[0] >= 0;
            if has_rung {
                let [a, b] = rung.map(|node| points[node as usize]);
                self.points.push(scale(add(a, b), 0.5));
            }
            let element = elements[*cell as usize];
            if i == 0 && !strip.is_closed() {
                let [a, b] = *rung;
                self.added.push([a, nodes, b, element[corner_after(element, b)]]);
                continue;
            }
            // behind the rung with the nodes a and b this cell has x next to a, and y next to b
            let before = if i > 0 { i - 1 } else { strip.cells.len() - 1 };
            let [a, b] = strip.rungs[before];
            let middle = nodes + before as i32;
            let at = corner_after(element, a);
            let (x, y) = (element[at], element[(at + 1) % 4]);
            if is_tria(element) {
                self.added.push([b, middle, a, x]);
            } else if has_rung {
                let ahead = nodes + i as i32;
                self.added.push([middle, a, x, ahead]);
                self.added.push([b, middle, ahead, y]);
            } else if end == End::First {
                self.added.push([middle, a, x, NO_NODE]);
                self.added.push([b, middle, x, y]);
            } else {
                self.added.push([b, middle, y, NO_NODE]);
                self.added.push([middle, a, x, y]);
            }
        }
    }
}

/// Which corner of an element follows a node.
#[inline]
fn corner_after(element: Element, node: i32) -> usize {
    let size = size_of(element);
    let place = element[..size].iter().position(|same| *same == node);
    place.map_or(0, |place| (place + 1) % size)
}

#[cfg(test)]
mod tests {
    use super::*;

    const SQUARE: [Vector; 5] =
        [[-1.0, 0.5, 0.0], [0.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0]];

    #[test]
    fn a_quad_at_the_end_becomes_a_quad_and_a_tria() {
        let elements = [[0, 1, 2, -1], [2, 1, 3, 4]];
        let strips = StripsView {
            start: &[0, 2, 4],
            cells: &[0, 1, 0, 1],
            rungs: &[[1, 2], [-1, -1], [1, 2], [-1, -1]],
        };
        let chords = insert_chords(strips, &[End::First, End::Second], &SQUARE, &elements);
        assert_eq!(chords.points.list(0), [[0.0, 0.5, 0.0]]);
        assert_eq!(chords.added.list(0), [[1, 5, 2, 0], [5, 1, 3, -1], [2, 5, 3, 4]]);
        assert_eq!(chords.added.list(1), [[1, 5, 2, 0], [2, 5, 4, -1], [5, 1, 3, 4]]);
    }

    #[test]
    fn there_is_one_way_between_two_trias() {
        let elements = [[0, 1, 2, -1], [2, 1, 3, -1]];
        let strips = StripsView {
            start: &[0, 2, 4],
            cells: &[0, 1, 0, 1],
            rungs: &[[1, 2], [-1, -1], [1, 2], [-1, -1]],
        };
        let chords = insert_chords(strips, &[End::First, End::Second], &SQUARE, &elements);
        assert_eq!(chords.added.list(0), [[1, 5, 2, 0], [2, 5, 1, 3]]);
        assert!(chords.added.list(1).is_empty() && chords.removed.list(1).is_empty());
    }
}
