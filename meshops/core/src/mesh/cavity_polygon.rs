//! The polygon around a small group of adjacent elements: the cavity that they leave.
//!
//! All sides of a group are compared with each other, so the cost grows with the number of groups
//! alone: a group has three elements and [`MOST_SIDES`] sides at the most.

use super::{Element, following, size_of};

/// Elements of a group, at the most.
pub const MOST_ELEMENTS: usize = 3;

/// Sides of all elements of a group together, at the most.
pub const MOST_SIDES: usize = 12;

/// Rows of the elements of a group; less than 0 where a place is empty.
pub type Group = [i32; MOST_ELEMENTS];

/// A polygon on nodes of a mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CavityPolygon {
    /// Rows of its nodes, counter-clockwise; -1 beyond the last.
    pub nodes: [i32; MOST_SIDES],
    /// How many corners it has; 0: what is around the group is not one simple polygon.
    pub corners: usize,
}

impl CavityPolygon {
    /// There is no such polygon.
    const NONE: Self = Self { nodes: [-1; MOST_SIDES], corners: 0 };

    /// Walk around a group of elements.
    ///
    /// The first node is where the first element leaves a side that it shares with another, so
    /// that the order does not depend on how the nodes are numbered; the first node of an element
    /// alone.
    pub fn around(elements: &[Element], group: Group) -> Self {
        let sides = Sides::of(elements, group);
        let first = sides.first();
        let around = sides.outer_sides().count();
        let mut polygon = Self::NONE;
        let mut side = first;
        for place in 0..around {
            if !sides.outer[side] {
                return Self::NONE;
            }
            polygon.nodes[place] = sides.start[side];
            let Some(following) = sides.only_after(side) else {
                return Self::NONE;
            };
            if (following == first) != (place + 1 == around) {
                return Self::NONE;
            }
            side = following;
        }
        polygon.corners = around;
        polygon
    }
}

/// The sides of the elements of a group, one element after the other.
struct Sides {
    count: usize,
    /// Sides of the first element.
    of_first: usize,
    start: [i32; MOST_SIDES],
    end: [i32; MOST_SIDES],
    /// Those that no other side runs against.
    outer: [bool; MOST_SIDES],
}

impl Sides {
    fn of(elements: &[Element], group: Group) -> Self {
        let mut sides = Self {
            count: 0,
            of_first: 0,
            start: [-1; MOST_SIDES],
            end: [-1; MOST_SIDES],
            outer: [false; MOST_SIDES],
        };
        for row in group.into_iter().filter(|row| *row >= 0) {
            let element = elements[row as usize];
            for place in 0..size_of(element) {
                sides.start[sides.count] = element[place];
                sides.end[sides.count] = element[following(element, place)];
                sides.count += 1;
            }
            if sides.of_first == 0 {
                sides.of_first = sides.count;
            }
        }
        for side in 0..sides.count {
            let (start, end) = (sides.start[side], sides.end[side]);
            let runs_against =
                |other: usize| sides.end[other] == start && sides.start[other] == end;
            sides.outer[side] = !(0..sides.count).any(runs_against);
        }
        sides
    }

    fn outer_sides(&self) -> impl Iterator<Item = usize> {
        (0..self.count).filter(|side| self.outer[*side])
    }

    /// The side of the first element to begin with.
    fn first(&self) -> usize {
        let before = |side: usize| if side > 0 { side - 1 } else { self.of_first - 1 };
        let is_first = |side: &usize| self.outer[*side] && !self.outer[before(*side)];
        (0..self.of_first).find(is_first).unwrap_or(0)
    }

    /// The one outer side that begins where another ends, if it is the only one.
    fn only_after(&self, side: usize) -> Option<usize> {
        let mut after = self.outer_sides().filter(|other| self.start[*other] == self.end[side]);
        let found = after.next()?;
        after.next().is_none().then_some(found)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn two_quads_leave_a_hexagon() {
        let polygon = CavityPolygon::around(&[[0, 1, 2, 3], [2, 1, 4, 5]], [0, 1, -1]);
        assert_eq!(polygon.corners, 6);
        assert_eq!(polygon.nodes[..6], [2, 3, 0, 1, 4, 5]);
    }

    #[test]
    fn elements_that_touch_in_a_node_leave_no_polygon() {
        let polygon = CavityPolygon::around(&[[0, 1, 2, -1], [2, 3, 4, -1]], [0, 1, -1]);
        assert_eq!(polygon, CavityPolygon::NONE);
    }

    proptest! {
        #[test]
        fn a_polygon_is_simple_and_has_each_outer_side(
            elements in prop::array::uniform3(prop::array::uniform4(0i32..9)),
            trias in prop::array::uniform3(any::<bool>()),
        ) {
            let mut elements = elements;
            for (element, tria) in elements.iter_mut().zip(trias) {
                if tria {
                    element[3] = -1;
                }
            }
            let sides = Sides::of(&elements, [0, 1, 2]);
            let polygon = CavityPolygon::around(&elements, [0, 1, 2]);
            let mut nodes = polygon.nodes[..polygon.corners].to_vec();
            for (place, node) in nodes.iter().enumerate() {
                let next = nodes[(place + 1) % nodes.len()];
                let is_side = |side: usize| sides.start[side] == *node && sides.end[side] == next;
                prop_assert!(sides.outer_sides().any(is_side));
            }
            nodes.sort_unstable();
            prop_assert!(nodes.is_sorted_by(|a, b| a < b));
        }
    }
}
