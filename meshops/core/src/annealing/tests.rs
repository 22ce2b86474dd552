//! What holds of a patch whatever is changed.

use std::collections::BTreeSet;

use proptest::prelude::*;

use super::reconnection::{
    collapse_diagonal, collapse_side, is_whole, open_node, open_trias, split_row, swap_side,
};
use super::undoable_patch::{Done, EMPTY, MOST_CHANGES, NotDone, UndoablePatch};
use crate::mesh::{Element, NO_NODE};
use crate::vectors::Vector;

/// A patch whose first nodes are those of its border.
#[derive(Clone, Debug)]
struct Sheet {
    points: Vec<Vector>,
    elements: Vec<Element>,
    fixed: i32,
}

/// Unit squares, each turned by some corners, and split where that is 4 or more.
fn sheet(columns: usize, rows: usize, turns: &[usize]) -> Sheet {
    let places = (0..=rows).flat_map(|y| (0..=columns).map(move |x| (x, y)));
    let is_inner = |(x, y): &(usize, usize)| *x > 0 && *x < columns && *y > 0 && *y < rows;
    let (inner, border): (Vec<_>, Vec<_>) = places.partition(is_inner);
    let fixed = border.len() as i32;
    let nodes: Vec<_> = border.into_iter().chain(inner).collect();
    let node = |x, y| nodes.iter().position(|place| *place == (x, y)).map_or(NO_NODE, |i| i as i32);
    let mut elements = Vec::new();
    for (i, turn) in turns.iter().take(columns * rows).enumerate() {
        let (x, y) = (i % columns, i / columns);
        let mut quad = [node(x, y), node(x + 1, y), node(x + 1, y + 1), node(x, y + 1)];
        quad.rotate_left(turn % 4);
        let [a, b, c, d] = quad;
        if *turn < 4 {
            elements.push(quad);
        } else {
            elements.extend([[a, b, c, NO_NODE], [a, c, d, NO_NODE]]);
        }
    }
    let points = nodes.iter().map(|(x, y)| [*x as f64, *y as f64, 0.0]).collect();
    Sheet { points, elements, fixed }
}

fn sheets() -> impl Strategy<Value = Sheet> {
    let turns = prop::collection::vec(0usize..8, 36);
    (1usize..7, 1usize..7, turns).prop_map(|(columns, rows, turns)| sheet(columns, rows, &turns))
}

/// A change, by the numbers that it is drawn by.
#[derive(Clone, Copy, Debug)]
struct Asked {
    kind: usize,
    which: usize,
    i: usize,
    j: usize,
}

impl Asked {
    fn make(self, patch: &mut UndoablePatch, fixed: i32) -> Done {
        let rows: Vec<_> = (0..patch.elements().len()).filter(|e| patch.size(*e) > 0).collect();
        if rows.is_empty() {
            return Err(NotDone);
        }
        let row = rows[self.which % rows.len()];
        let side = self.i % patch.size(row);
        let node = patch.elements()[row][side];
        match self.kind {
            0 => swap_side(patch, row, side, self.j),
            1 => split_row(patch, row, self.j),
            2 => collapse_diagonal(patch, row, self.i, fixed),
            3 => collapse_side(patch, row, side, fixed),
            4 => open_node(patch, node, self.i, self.j, fixed),
            _ => open_trias(patch, node, self.i, self.j, fixed),
        }
    }
}

fn changes() -> impl Strategy<Value = Vec<Asked>> {
    let asked = (0usize..6, 0usize..1_000_000, 0usize..1000, 0usize..1000);
    prop::collection::vec(asked.prop_map(|(kind, which, i, j)| Asked { kind, which, i, j }), 1..60)
}

/// Every directed side of the elements.
fn sides_of(patch: &UndoablePatch) -> Vec<(i32, i32)> {
    let corners = |row: usize| (0..patch.size(row)).map(move |k| (row, k));
    let all = (0..patch.elements().len()).flat_map(corners);
    all.map(|(row, k)| (patch.elements()[row][k], patch.ahead(row, k))).collect()
}

/// The sides that no element has the other way round.
fn border_of(patch: &UndoablePatch) -> BTreeSet<(i32, i32)> {
    let sides: BTreeSet<_> = sides_of(patch).into_iter().collect();
    sides.iter().copied().filter(|(a, b)| !sides.contains(&(*b, *a))).collect()
}

/// The elements around each node, in ascending order.
fn rings_of(patch: &UndoablePatch) -> Vec<Vec<i32>> {
    let sorted = |node: usize| {
        let mut rows = patch.around(node as i32).to_vec();
        rows.sort_unstable();
        rows
    };
    (0..patch.points().len()).map(sorted).collect()
}

proptest! {
    #[test]
    fn a_change_is_whole_or_taken_back(sheet in sheets(), asked in changes()) {
        let Sheet { points, elements, fixed } = sheet;
        let mut patch = UndoablePatch::new(&points, &elements, 60).expect("few elements meet");
        let outside = |node: i32| if node < fixed { -1 } else { 0 };
        let border = border_of(&patch);
        for change in asked {
            let before = patch.clone();
            if change.make(&mut patch, fixed).is_ok() && is_whole(&patch, outside, fixed) {
                patch.settle();
            } else {
                patch.take_back();
                prop_assert_eq!(patch.elements(), before.elements());
                prop_assert_eq!(patch.points(), before.points());
                prop_assert_eq!(rings_of(&patch), rings_of(&before));
            }
            let sides = sides_of(&patch);
            prop_assert_eq!(sides.iter().collect::<BTreeSet<_>>().len(), sides.len());
            prop_assert_eq!(border_of(&patch), border.clone());
            for (node, rows) in rings_of(&patch).iter().enumerate() {
                let has = |row: &i32| patch.corner(*row as usize, node as i32).is_some();
                let count = patch.elements().iter().flatten().filter(|n| **n == node as i32).count();
                prop_assert!(rows.iter().all(has) && rows.len() == count);
            }
            prop_assert_eq!(&patch.points()[..fixed as usize], &points[..fixed as usize]);
        }
    }

    #[test]
    fn any_rewriting_is_taken_back(
        sheet in sheets(),
        rows in prop::collection::vec((0usize..20, prop::array::uniform4(0i32..6)), 1..80),
    ) {
        let mut patch = UndoablePatch::new(&sheet.points, &sheet.elements, 20).expect("few meet");
        let before = patch.clone();
        for (row, element) in rows {
            let done = patch.rewrite(row, element).and_then(|()| patch.put(element[0], [9.0; 3]));
            if done.is_err() {
                break;
            }
        }
        prop_assert!(patch.element_changes().len() <= MOST_CHANGES);
        patch.take_back();
        prop_assert_eq!(patch.elements(), before.elements());
        prop_assert_eq!(patch.points(), before.points());
        prop_assert_eq!(rings_of(&patch), rings_of(&before));
    }
}

#[test]
fn every_change_is_possible_somewhere() {
    let Sheet { points, elements, fixed } =
        sheet(4, 4, &[0, 5, 2, 7, 1, 6, 3, 4, 0, 5, 2, 7, 1, 6, 3, 4]);
    let patch = UndoablePatch::new(&points, &elements, 60).expect("few elements meet");
    for kind in 0..6 {
        let all = (0..elements.len()).flat_map(|which| (0..16).map(move |i| (which, i)));
        let works = |(which, i): (usize, usize)| {
            let mut patch = patch.clone();
            let done = Asked { kind, which, i, j: i / 4 }.make(&mut patch, fixed);
            done.is_ok() && is_whole(&patch, |_| -1, fixed)
        };
        assert!(all.into_iter().any(works), "kind {kind}");
    }
}

#[test]
fn a_fan_goes_around_its_node_in_order() {
    let Sheet { points, elements, fixed } = sheet(4, 4, &[0; 16]);
    let patch = UndoablePatch::new(&points, &elements, 1).expect("few elements meet");
    let fan = patch.fan(fixed);
    assert!(fan.closed && fan.rows().len() == 4);
    for place in 0..4 {
        let (row, next) = (fan.row(place), fan.row(place + 1));
        let k = patch.corner(row, fixed).expect("it is around the node");
        let m = patch.corner(next, fixed).expect("it is around the node");
        assert_eq!(patch.behind(row, k), patch.ahead(next, m));
    }
    let corner = patch.fan(0);
    assert!(!corner.closed && corner.rows() == [0]);
}

#[test]
fn rows_and_nodes_run_out() {
    let Sheet { points, elements, .. } = sheet(2, 2, &[0; 4]);
    let mut patch = UndoablePatch::new(&points, &elements, 1).expect("few elements meet");
    assert_eq!((patch.empty_row(), patch.unused_node(0)), (Some(4), Some(9)));
    patch.rewrite(4, [0, 1, 9, NO_NODE]).expect("there is room");
    assert_eq!((patch.empty_row(), patch.unused_node(0)), (None, None));
    patch.take_back();
    assert_eq!(patch.elements()[4], EMPTY);
    assert_eq!(patch.empty_row(), Some(4));
}
