//! Tria transport: a tria walks through quads along a strip.
//!
//! A step changes the sides of the tria and the quad behind one of its edges: the two make a
//! pentagon, and its diagonal is moved. At a tria in the end the two become a quad. The strips begin
//! at a tria and lead through quads. The cost grows with the cells of the strips.

use super::strips::{Rung, Strip, StripsView};
use crate::math::least;
use crate::mesh::lists::Lists;
use crate::mesh::validity::own_corner;
use crate::mesh::{Element, NO_NODE, is_tria};
use crate::vectors::Vector;

/// Where a step goes that crosses a quad straight.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Way {
    /// Always to the corner ahead on the right.
    Right,
    /// Always to that on the left.
    Left,
    /// Where it gives the better elements.
    Best,
}

/// Make the elements after the tria at the beginning of each strip has walked to its end.
///
/// List `s` takes the place of the cells of strip `s`. Rungs are nodes of the mesh.
pub fn transport_trias(
    strips: StripsView<'_>,
    ways: &[Way],
    points: &[Vector],
    elements: &[Element],
) -> Lists<Element> {
    let mut added = Lists::with_room(strips.len());
    added.items.reserve(strips.cells.len());
    for (strip, way) in strips.iter().zip(ways) {
        transport(strip, *way, points, elements, &mut added);
        added.close();
    }
    added
}

fn transport(
    strip: Strip<'_>,
    way: Way,
    points: &[Vector],
    elements: &[Element],
    added: &mut Lists<Element>,
) {
    let (Some(first), Some(rung)) = (strip.cells.first(), strip.rungs.first()) else { return };
    if rung[0] < 0 {
        return;
    }
    let [mut a, mut b] = *rung;
    let mut apex = third(elements[*first as usize], *rung);
    for (cell, ahead) in strip.cells.iter().zip(strip.rungs).skip(1) {
        let element = elements[*cell as usize];
        if is_tria(element) {
            added.push([apex, a, third(element, [a, b]), b]);
            return;
        }
        let [x, y] = far_side(element, a);
        let step = Step { apex, a, b, x, y };
        let left_over = if step.goes_right(way, points, *ahead) {
            added.push([apex, a, y, b]);
            [a, x, y, NO_NODE]
        } else {
            added.push([apex, a, x, b]);
            [x, y, b, NO_NODE]
        };
        if ahead[0] < 0 {
            added.push(left_over);
        } else {
            apex = third(left_over, *ahead);
            [a, b] = *ahead;
        }
    }
}

/// A tria `apex`, `a`, `b` before a quad `b`, `a`, `x`, `y`.
#[derive(Clone, Copy)]
struct Step {
    apex: i32,
    a: i32,
    b: i32,
    x: i32,
    y: i32,
}

impl Step {
    /// Whether the tria goes to corner x, on the right of the step, and not to y.
    ///
    /// `ahead` is the next edge crossed, if any: a way to the side leaves no choice.
    #[inline]
    fn goes_right(self, way: Way, points: &[Vector], ahead: Rung) -> bool {
        let Self { apex, a, b, x, y } = self;
        let [p, q] = ahead;
        if p == a || (p == x && q == a) {
            return true;
        }
        if q == b {
            return false;
        }
        match way {
            Way::Right => true,
            Way::Left => false,
            Way::Best => {
                let worst = |tria, quad| least(own_corner(points, tria), own_corner(points, quad));
                let right = worst([a, x, y, NO_NODE], [apex, a, y, b]);
                let left = worst([x, y, b, NO_NODE], [apex, a, x, b]);
                right >= left
            }
        }
    }
}

/// The node of a tria that is neither of two.
#[inline]
fn third(tria: Element, [a, b]: Rung) -> i32 {
    let [first, second, third, _] = tria;
    if first != a && first != b {
        first
    } else if second != a && second != b {
        second
    } else {
        third
    }
}

/// The two nodes that follow one of a quad.
#[inline]
fn far_side(quad: Element, node: i32) -> Rung {
    let place = quad.iter().position(|same| *same == node).unwrap_or(0);
    [quad[(place + 1) % 4], quad[(place + 2) % 4]]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_trias_with_a_quad_between_become_two_quads() {
        let elements = [[0, 1, 2, -1], [2, 1, 3, 4], [4, 3, 5, -1]];
        let strips =
            StripsView { start: &[0, 3], cells: &[0, 1, 2], rungs: &[[1, 2], [3, 4], [-1, -1]] };
        let right = transport_trias(strips, &[Way::Right], &[], &elements);
        assert_eq!(right.list(0), [[0, 1, 4, 2], [1, 3, 5, 4]]);
        let left = transport_trias(strips, &[Way::Left], &[], &elements);
        assert_eq!(left.list(0), [[0, 1, 3, 2], [2, 3, 5, 4]]);
    }

    #[test]
    fn a_step_moves_the_diagonal_of_the_pentagon() {
        let elements = [[0, 1, 2, -1], [2, 1, 3, 4]];
        let strips = StripsView { start: &[0, 2], cells: &[0, 1], rungs: &[[1, 2], [-1, -1]] };
        let after = transport_trias(strips, &[Way::Right], &[], &elements);
        assert_eq!(after.list(0), [[0, 1, 4, 2], [1, 3, 4, -1]]);
    }
}
