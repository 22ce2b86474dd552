//! The elements around a node in order.

use crate::mesh::csr::CsrView;
use crate::mesh::{Element, following, preceding, size_of};

/// Nodes with more elements are not collapsed or split.
pub const MOST_AROUND: usize = 12;

/// Elements around a node, counter-clockwise.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct NodeFan {
    /// How many there are; the rest of the arrays is not used.
    pub count: usize,
    /// Rows of the elements.
    pub rows: [i32; MOST_AROUND],
    /// Edge `i` runs from the node to `ends[i]`, between elements `i - 1` and `i`.
    pub ends: [i32; MOST_AROUND],
}

impl NodeFan {
    /// Walk around a node; none where its elements do not close around it, or are too many.
    pub fn around(node: i32, elements: &[Element], around: CsrView<'_>) -> Option<Self> {
        let users = around.list(node as usize);
        if users.len() > MOST_AROUND || users.len() < 2 {
            return None;
        }
        let mut fan = Self { count: users.len(), ..Self::default() };
        let mut row = users[0];
        for i in 0..fan.count {
            let element = elements[row as usize];
            let place = element[..size_of(element)].iter().rposition(|other| *other == node)?;
            fan.rows[i] = row;
            fan.ends[i] = element[following(element, place)];
            let before = element[preceding(element, place)];
            let starts_there = |other: &&i32| {
                let other = elements[**other as usize];
                (0..size_of(other))
                    .any(|k| other[k] == node && other[following(other, k)] == before)
            };
            let next = *users.iter().rev().find(starts_there)?;
            if (next == fan.rows[0]) != (i + 1 == fan.count) {
                return None;
            }
            row = next;
        }
        Some(fan)
    }
}
