//! Rings of elements around others: breadth-first search across crossable edges.
//!
//! The cost grows with the elements that are visited, and with those of the mesh for the arrays.

use super::element_graph::ElementGraph;

/// Rings to an element that cannot be reached.
pub const FAR: i32 = 1 << 30;

/// The farthest ring that [`nearby`] looks at.
const MOST_RINGS: i32 = 64;

/// A breadth-first search through allowed elements.
struct ElementRings<'a> {
    graph: ElementGraph<'a>,
    allowed: &'a [bool],
    is_reached: Vec<bool>,
    visited: Vec<Visit>,
}

#[derive(Clone, Copy)]
struct Visit {
    element: i32,
    ring: i32,
}

impl<'a> ElementRings<'a> {
    fn new(graph: ElementGraph<'a>, allowed: &'a [bool]) -> Self {
        Self { graph, allowed, is_reached: vec![false; graph.len()], visited: Vec::new() }
    }

    /// Begin at some elements, allowed or not, and visit all others up to ring `most`.
    fn walk(&mut self, centres: impl IntoIterator<Item = usize>, most: i32) {
        for Visit { element, .. } in self.visited.drain(..) {
            self.is_reached[element as usize] = false;
        }
        for centre in centres {
            self.visit(centre, 0);
        }
        let mut head = 0;
        while let Some(Visit { element, ring }) = self.visited.get(head).copied() {
            if ring >= most {
                break;
            }
            head += 1;
            for other in self.graph.neighbours(element as usize) {
                if self.allowed[other] {
                    self.visit(other, ring + 1);
                }
            }
        }
    }

    #[inline(always)]
    fn visit(&mut self, element: usize, ring: i32) {
        if !self.is_reached[element] {
            self.is_reached[element] = true;
            self.visited.push(Visit { element: element as i32, ring });
        }
    }

    fn rings(&self) -> Vec<i32> {
        let mut rings = vec![FAR; self.graph.len()];
        for visit in &self.visited {
            rings[visit.element as usize] = visit.ring;
        }
        rings
    }
}

/// Crossable edges from each element to the nearest of the centres.
///
/// [`FAR`] where there is no way through allowed elements.
pub fn rings_around(
    graph: ElementGraph<'_>,
    allowed: &[bool],
    centres: impl IntoIterator<Item = usize>,
) -> Vec<i32> {
    let mut search = ElementRings::new(graph, allowed);
    search.walk(centres, FAR);
    search.rings()
}

/// Row of the element that is visited as number `shift` from a centre; 0 is the centre itself.
///
/// The last one where there are not so many.
pub fn nearby(graph: ElementGraph<'_>, allowed: &[bool], centre: usize, shift: usize) -> usize {
    let mut search = ElementRings::new(graph, allowed);
    let mut most = 0;
    search.walk([centre], most);
    while search.visited.len() <= shift && most < MOST_RINGS {
        most += 2;
        search.walk([centre], most);
    }
    search.visited[shift.min(search.visited.len() - 1)].element as usize
}

/// Which allowed elements are across at most `most` crossable edges from a centre.
pub fn disc(graph: ElementGraph<'_>, allowed: &[bool], centre: usize, most: i32) -> Vec<bool> {
    let mut search = ElementRings::new(graph, allowed);
    search.walk([centre], most);
    search.is_reached
}

/// Which elements are within `most` crossable edges from the shortest way between two.
///
/// A disc around the first where there is no way.
pub fn strip(graph: ElementGraph<'_>, allowed: &[bool], ends: [usize; 2], most: i32) -> Vec<bool> {
    let [first, last] = ends;
    let mut search = ElementRings::new(graph, allowed);
    search.walk([last], FAR);
    let rings = search.rings();
    let mut way = vec![first];
    let mut element = first;
    while rings[first] < FAR && rings[element] > 0 {
        let Some(nearer) = graph.neighbours(element).find(|other| rings[*other] < rings[element])
        else {
            break;
        };
        element = nearer;
        way.push(element);
    }
    search.walk(way, most);
    search.is_reached
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Five elements in a row.
    fn with_row<T>(work: impl FnOnce(ElementGraph<'_>) -> T) -> T {
        let element_edges: Vec<[i32; 4]> = (0..5).map(|i| [i - 1, i, -1, -1]).collect();
        let element_edges: Vec<[i32; 4]> = element_edges
            .iter()
            .map(|edges| edges.map(|edge| if edge > 3 { -1 } else { edge }))
            .collect();
        let edge_elements: Vec<[i32; 2]> = (0..4).map(|i| [i, i + 1]).collect();
        let crossable = [true; 4];
        work(ElementGraph {
            element_edges: &element_edges,
            edge_elements: &edge_elements,
            crossable: &crossable,
        })
    }

    #[test]
    fn rings_stop_at_what_is_not_allowed() {
        let allowed = [true, true, false, true, true];
        with_row(|graph| {
            assert!(graph.is_whole());
            assert_eq!(rings_around(graph, &allowed, [0]), [0, 1, FAR, FAR, FAR]);
            assert_eq!(disc(graph, &[true; 5], 2, 1), [false, true, true, true, false]);
            assert_eq!(strip(graph, &[true; 5], [1, 3], 0), [false, true, true, true, false]);
            assert_eq!(nearby(graph, &[true; 5], 0, 3), 3);
            assert_eq!(nearby(graph, &[true; 5], 0, 9), 4);
        });
    }
}
