//! Reconnection: small changes of the topology of a patch, each drawn by a few numbers.
//!
//! What is begun and not done is to be taken back. None of them looks at places of nodes, except to
//! say where a new one begins. Nodes below `fixed` are those of the border: they neither move nor
//! vanish. Whether a change leaves a surface is for [`is_whole`] to say. The cost is that of
//! looking at the elements around a few nodes.

use super::undoable_patch::{Done, EMPTY, Fan, MOST_AROUND, NotDone, UndoablePatch};
use crate::mesh::NO_NODE;
use crate::vectors::{add, scale, subtract};

/// Elements that may meet at a node.
const MOST_VALENCE: i64 = 8;

/// Of the way to the nodes around it: where the second node begins that one is split into.
const OPENING: f64 = 0.3;

/// Divide the outline of two neighbours another way: by a turned edge, or as one quad.
///
/// Two quads have two other ways, a quad and a tria four, two trias two: a turned edge or a quad.
pub fn swap_side(patch: &mut UndoablePatch, row: usize, side: usize, choice: usize) -> Done {
    let element = patch.elements()[row];
    let (a, b) = (element[side], patch.ahead(row, side));
    let other = patch.element_with_side(b, a).ok_or(NotDone)?;
    let (size, other_size) = (patch.size(row), patch.size(other));
    let k = patch.corner(other, a).ok_or(NotDone)?;
    let neighbour = patch.elements()[other];
    // from b all around to a, and on to before b
    let ours = (1..size).map(|i| element[(side + i) % size]);
    let theirs = (0..other_size - 1).map(|i| neighbour[(k + i) % other_size]);
    let mut outline = [NO_NODE; 6];
    let mut count = 0;
    for node in ours.chain(theirs) {
        outline[count] = node;
        count += 1;
    }
    let outline = &mut outline[..count];
    match count {
        6 => {
            // b c d a f g: the edge in the middle runs from the first to the fourth
            outline.rotate_left(1 + choice % 2);
            let [p, q, r, s, t, u] = [0, 1, 2, 3, 4, 5].map(|i| outline[i]);
            patch.rewrite(row, [p, q, r, s])?;
            patch.rewrite(other, [s, t, u, p])
        }
        5 => {
            outline.rotate_left(choice % 5);
            let [p, q, r, s, t] = [0, 1, 2, 3, 4].map(|i| outline[i]);
            patch.rewrite(row, [p, q, r, NO_NODE])?;
            patch.rewrite(other, [r, s, t, p])
        }
        _ => {
            let [p, q, r, s] = [0, 1, 2, 3].map(|i| outline[i]);
            if choice % 2 == 1 {
                patch.remove(other)?;
                return patch.rewrite(row, [p, q, r, s]);
            }
            patch.rewrite(row, [q, r, s, NO_NODE])?;
            patch.rewrite(other, [s, p, q, NO_NODE])
        }
    }
}

/// Divide a quad into two trias.
pub fn split_row(patch: &mut UndoablePatch, row: usize, choice: usize) -> Done {
    let other = patch.empty_row();
    let Some(other) = other.filter(|_| patch.size(row) == 4) else {
        return Err(NotDone);
    };
    let mut quad = patch.elements()[row];
    quad.rotate_left(choice % 2);
    let [a, b, c, d] = quad;
    patch.rewrite(row, [a, b, c, NO_NODE])?;
    patch.rewrite(other, [a, c, d, NO_NODE])
}

/// Merge a corner of a quad with the opposite one; the quad vanishes.
pub fn collapse_diagonal(patch: &mut UndoablePatch, row: usize, corner: usize, fixed: i32) -> Done {
    if patch.size(row) < 4 {
        return Err(NotDone);
    }
    let quad = patch.elements()[row];
    let (gone, stays) = (quad[corner % 4], quad[(corner + 2) % 4]);
    let (gone, stays) = if gone < fixed { (stays, gone) } else { (gone, stays) };
    if gone < fixed {
        return Err(NotDone);
    }
    patch.remove(row)?;
    merge_nodes(patch, gone, stays, fixed)
}

/// Merge the ends of a side: quads beside it become trias, trias vanish.
pub fn collapse_side(patch: &mut UndoablePatch, row: usize, side: usize, fixed: i32) -> Done {
    let (gone, stays) = (patch.elements()[row][side], patch.ahead(row, side));
    let other = patch.element_with_side(stays, gone).ok_or(NotDone)?;
    let (gone, stays) = if gone < fixed { (stays, gone) } else { (gone, stays) };
    if gone < fixed {
        return Err(NotDone);
    }
    for row in [row, other] {
        if patch.size(row) == 3 {
            patch.remove(row)?;
            continue;
        }
        let k = patch.corner(row, gone).ok_or(NotDone)?;
        let quad = patch.elements()[row];
        let [a, b, c] = [1, 2, 3].map(|i| quad[(k + i) % 4]);
        patch.rewrite(row, [a, b, c, NO_NODE])?;
    }
    merge_nodes(patch, gone, stays, fixed)
}

/// Put node `stays` in the place of node `gone`; half-way between the two if it may move.
///
/// The elements of both must have been dealt with.
fn merge_nodes(patch: &mut UndoablePatch, gone: i32, stays: i32, fixed: i32) -> Done {
    if stays >= fixed {
        let half = scale(add(patch.point(gone), patch.point(stays)), 0.5);
        patch.put(stays, half)?;
    }
    while let Some(row) = patch.around(gone).first().map(|row| *row as usize) {
        if patch.corner(row, stays).is_some() {
            return Err(NotDone);
        }
        patch.rename(row, gone, stays)?;
    }
    Ok(())
}

/// A node is split: one part of the elements around it gets a new node.
struct Split {
    node: i32,
    fresh: i32,
    fan: Fan,
}

impl Split {
    /// Put the new node into the elements from `first` to before `last`.
    fn rename(&self, patch: &mut UndoablePatch, first: usize, last: usize) -> Done {
        (first..last).try_for_each(|i| patch.rename(self.fan.row(i), self.node, self.fresh))
    }

    /// Put the new node a part of the way to the middle of elements around the old one.
    fn place(&self, patch: &mut UndoablePatch, first: usize, last: usize) -> Done {
        let place = patch.point(self.node);
        let (mut total, mut count) = ([0.0; 3], 0);
        for row in (first..last).map(|i| self.fan.row(i)) {
            for node in &patch.elements()[row][..patch.size(row)] {
                total = add(total, patch.point(*node));
                count += 1;
            }
        }
        let step = subtract(scale(total, 1.0 / f64::from(count)), place);
        patch.put(self.fresh, add(place, scale(step, OPENING)))
    }
}

/// Split a node along two of its edges, drawn by i and j: a quad opens between them.
pub fn open_node(patch: &mut UndoablePatch, node: i32, i: usize, j: usize, fixed: i32) -> Done {
    let fan = patch.fan(node);
    let count = fan.rows().len();
    let (fresh, row) = (patch.unused_node(fixed), patch.empty_row());
    let (Some(fresh), Some(row)) = (fresh, row) else {
        return Err(NotDone);
    };
    // of an open fan the first and the last edge are of the border
    if fan.closed != (node >= fixed) || count < if fan.closed { 4 } else { 3 } {
        return Err(NotDone);
    }
    let (first, part) = if fan.closed {
        (i % count, 2 + j % (count - 3))
    } else {
        let first = 1 + i % (count - 2);
        (first, 1 + j % (count - 1 - first))
    };
    let last = first + part;
    let (begin, end) = (fan.row(first), fan.row(last - 1));
    let a = patch.ahead(begin, patch.corner(begin, node).ok_or(NotDone)?);
    let b = patch.behind(end, patch.corner(end, node).ok_or(NotDone)?);
    let split = Split { node, fresh, fan };
    split.place(patch, first, last)?;
    split.rename(patch, first, last)?;
    patch.rewrite(row, [node, a, fresh, b])
}

/// Split a node so that an edge comes through two of its trias, which become quads.
pub fn open_trias(patch: &mut UndoablePatch, node: i32, i: usize, j: usize, fixed: i32) -> Done {
    let fan = patch.fan(node);
    let fresh = patch.unused_node(fixed).ok_or(NotDone)?;
    if fan.closed != (node >= fixed) {
        return Err(NotDone);
    }
    let mut trias = [0; MOST_AROUND];
    let mut found = 0;
    for (place, row) in fan.rows().iter().enumerate() {
        if patch.size(*row as usize) == 3 {
            trias[found] = place;
            found += 1;
        }
    }
    if found < 2 {
        return Err(NotDone);
    }
    let one = i % found;
    let two = (one + 1 + j % (found - 1)) % found;
    let (mut first, mut last) = (trias[one], trias[two]);
    if !fan.closed && first > last {
        (first, last) = (last, first);
    }
    if last < first {
        last += fan.rows().len();
    }
    if last - first <= 1 {
        return Err(NotDone);
    }
    // the elements between the two trias get the new node; each tria gets both
    let (begin, end) = (fan.row(first), fan.row(last));
    let k = patch.corner(begin, node).ok_or(NotDone)?;
    let m = patch.corner(end, node).ok_or(NotDone)?;
    let (from, to) = (patch.elements()[begin], patch.elements()[end]);
    let [p, q] = [1, 2].map(|i| from[(k + i) % 3]);
    let [r, s] = [1, 2].map(|i| to[(m + i) % 3]);
    let split = Split { node, fresh, fan };
    split.place(patch, first, last + 1)?;
    split.rename(patch, first + 1, last)?;
    patch.rewrite(begin, [node, p, q, fresh])?;
    patch.rewrite(end, [fresh, r, s, node])
}

/// Whether the elements that changed leave a surface: each side once, each node well used.
///
/// `outside` says how many elements outside of the patch meet at a node, -1 where any may.
pub fn is_whole(patch: &UndoablePatch, outside: impl Fn(i32) -> i32, fixed: i32) -> bool {
    patch.element_changes().iter().all(|change| {
        // a node that has lost elements
        let lost = change.before.iter().filter(|node| **node >= 0);
        lost.into_iter().all(|node| keeps_enough(patch, *node, fixed))
            && is_well_connected(patch, change.row, &outside, fixed)
    })
}

/// Whether a node has enough elements: one on the border, three or none within.
fn keeps_enough(patch: &UndoablePatch, node: i32, fixed: i32) -> bool {
    match patch.around(node).len() {
        0 => node >= fixed,
        count => node < fixed || count >= 3,
    }
}

/// Whether an element has its nodes once each, its sides alone, and no node too many elements.
fn is_well_connected(
    patch: &UndoablePatch,
    row: usize,
    outside: impl Fn(i32) -> i32,
    fixed: i32,
) -> bool {
    let element = patch.elements()[row];
    let size = patch.size(row);
    if element == EMPTY {
        return true;
    }
    (0..size).all(|k| {
        let (a, b) = (element[k], patch.ahead(row, k));
        if a == b || (size == 4 && k < 2 && a == element[k + 2]) {
            return false;
        }
        let around = patch.around(a);
        let valence = around.len() as i64 + i64::from(outside(a).max(0));
        if valence > MOST_VALENCE || (a >= fixed && valence < 3) {
            return false;
        }
        let (mut same, mut opposed) = (0, 0);
        for other in around.iter().map(|other| *other as usize) {
            let Some(c) = patch.corner(other, a) else { continue };
            same += i32::from(patch.ahead(other, c) == b);
            opposed += i32::from(patch.behind(other, c) == b);
        }
        same == 1 && opposed <= 1
    })
}
