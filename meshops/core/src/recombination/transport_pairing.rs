//! Pairing by tria transport: trias that a matching left alone move through the quads and meet.
//!
//! A tria and the quad next to it have five corners. These can be cut into a quad and a tria in
//! other ways, so that the tria comes out on any other side of the quad. Long ways of good quads
//! are taken before short ways of poor ones. The cost grows with the number of lone trias times
//! that of elements; a way is looked for among so many steps at most.

use super::quad_shape::quad_shape;
use crate::mesh::neighbours::element_neighbours;
use crate::mesh::{Element, Facet, following, is_tria, size_of};
use crate::vectors::Vector;

/// Least shape of the quads that are made, one round after the other.
pub const SHAPES: [f64; 5] = [0.8, 0.6, 0.4, 0.2, 0.1];

/// Quads that a tria moves through at most.
pub const LONGEST: usize = 24;

/// Steps looked at before a tria stays alone.
const MOST: usize = 4095;

/// A step of a way: a tria that leaves an element, and what is made of the rest.
struct Step {
    /// The tria that leaves.
    tria: Facet,
    /// The element that it is cut from.
    element: usize,
    /// The step before.
    before: Option<usize>,
    /// How many steps lie before.
    depth: usize,
    /// What the element becomes.
    made: Element,
}

/// The end of a way: two trias that become one quad.
struct Meeting {
    last: usize,
    met: usize,
    made: Element,
}

/// A search by breadth for the shortest way from a tria to another one.
struct Search<'a> {
    points: &'a [Vector],
    elements: &'a [Element],
    neighbours: &'a [[i32; 4]],
    least: f64,
}

/// Let trias that are alone meet in pairs; elements on the same nodes.
///
/// The trias are taken in the order of their rows, each on its shortest way to another. Elements
/// name no node beyond the points.
pub fn unite_trias(points: &[Vector], elements: &[Element]) -> Vec<Element> {
    let mut elements = elements.to_vec();
    let mut neighbours = element_neighbours(&elements, points.len());
    let mut seen = vec![false; 8 * elements.len()];
    let mut steps = Vec::new();
    for least in SHAPES {
        let mut stuck = 0;
        loop {
            let alone = elements.iter().enumerate().filter(|(_, element)| is_tria(**element));
            let alone: Vec<usize> = alone.map(|(row, _)| row).collect();
            if alone.len() < 2 || stuck >= alone.len() {
                break;
            }
            let first = alone[stuck];
            let search = Search { points, elements: &elements, neighbours: &neighbours, least };
            let Some(meeting) = search.find_way(first, &mut steps, &mut seen) else {
                stuck += 1;
                continue;
            };
            if meeting.met < first {
                stuck -= 1;
            }
            elements[meeting.met] = meeting.made;
            let mut step = &steps[meeting.last];
            while let Some(before) = step.before {
                elements[step.element] = step.made;
                step = &steps[before];
            }
            elements.remove(first);
            neighbours = element_neighbours(&elements, points.len());
        }
    }
    elements
}

impl Search<'_> {
    /// Find the shortest way from a tria to another one.
    ///
    /// `seen` is false everywhere, before and after.
    fn find_way(&self, first: usize, steps: &mut Vec<Step>, seen: &mut [bool]) -> Option<Meeting> {
        let [a, b, c, _] = self.elements[first];
        steps.clear();
        steps.push(Step { tria: [a, b, c], element: first, before: None, depth: 0, made: [-1; 4] });
        let mut visited = Vec::new();
        let mut head = 0;
        let mut meeting = None;
        while meeting.is_none() && head < steps.len() {
            meeting = self.leave(head, steps, seen, &mut visited);
            head += 1;
        }
        for state in visited {
            seen[state] = false;
        }
        meeting
    }

    /// Let the tria of a step leave over its sides, into a quad or to another tria.
    fn leave(
        &self,
        step: usize,
        steps: &mut Vec<Step>,
        seen: &mut [bool],
        visited: &mut Vec<usize>,
    ) -> Option<Meeting> {
        let Step { tria, element, depth, .. } = steps[step];
        for k in 0..3 {
            let (a, b, c) = (tria[k], tria[(k + 1) % 3], tria[(k + 2) % 3]);
            // the diagonal along which the quad was cut is no side of it
            let Some(out) = side_of(self.elements[element], a, b) else { continue };
            let other = self.neighbours[element][out];
            if other < 0 || is_on_way(steps, step, other as usize) {
                continue;
            }
            let other = other as usize;
            let nodes = self.elements[other];
            let Some(side) = side_of(nodes, b, a) else { continue };
            let size = size_of(nodes);
            for choice in 0..size - 2 {
                // the tria takes side ba of the other element and one more corner of it
                let apex = nodes[(side + 2 + choice) % size];
                let made = [a, apex, b, c];
                let state = 8 * other + 2 * side + choice;
                if seen[state] || quad_shape(self.points, made) < self.least {
                    continue;
                }
                if size == 3 {
                    return Some(Meeting { last: step, met: other, made });
                }
                if depth >= LONGEST || steps.len() >= MOST {
                    continue;
                }
                seen[state] = true;
                visited.push(state);
                let corner = if choice == 0 { b } else { a };
                let tria = [corner, nodes[(side + 2) % 4], nodes[(side + 3) % 4]];
                let (before, depth) = (Some(step), depth + 1);
                steps.push(Step { tria, element: other, before, depth, made });
            }
        }
        None
    }
}

/// The side of an element that runs from one node to another.
fn side_of(element: Element, a: i32, b: i32) -> Option<usize> {
    (0..size_of(element)).find(|k| element[*k] == a && element[following(element, *k)] == b)
}

/// Whether the way that leads to a step goes through an element.
fn is_on_way(steps: &[Step], last: usize, element: usize) -> bool {
    let mut step = Some(last);
    while let Some(row) = step {
        if steps[row].element == element {
            return true;
        }
        step = steps[row].before;
    }
    false
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_trias_meet_through_a_row_of_quads() {
        let points: Vec<Vector> =
            (0..8).map(|i| [f64::from(i / 2), f64::from(i % 2), 0.0]).collect();
        let row = [[0, 2, 1, -1], [2, 4, 3, 1], [4, 6, 5, 3], [6, 7, 5, -1]];
        let alone = [[0, 2, 3, -1], [0, 3, 1, -1], [2, 4, 5, 3], [4, 6, 7, 5]];
        assert_eq!(unite_trias(&points, &row), [[2, 3, 1, 0], [4, 5, 3, 2], [6, 7, 5, 4]]);
        assert_eq!(unite_trias(&points, &alone).len(), 3);
    }
}
