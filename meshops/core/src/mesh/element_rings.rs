//! Rings of elements around others: breadth-first search across crossable edges.
//!
//! The cost grows with the elements that are visited, and with those of the mesh for the arrays.

use super::element_graph::ElementGraph;

/// Rings to an element that cannot be reached.
pub const FAR: i32 = 1 << 30;

/// The farthest ring that [`nearby`] looks at.
const MOST_RINGS: i32 = 64;

/// A breadth-first search through allowed elements.
#[derive(Clone, Debug)]
pub struct ElementRings<'a> {
    graph: ElementGraph<'a>,
    allowed: &'a [bool],
    rings: Vec<i32>,
    visited: Vec<i32>,
}

impl<'a> ElementRings<'a> {
    /// Begin at some elements, allowed or not.
    pub fn around(
        graph: ElementGraph<'a>,
        allowed: &'a [bool],
        centres: impl IntoIterator<Item = usize>,
    ) -> Self {
        let mut search =
            Self { graph, allowed, rings: vec![FAR; graph.len()], visited: Vec::new() };
        for centre in centres {
            search.begin(centre);
        }
        search
    }

    fn begin(&mut self, centre: usize) {
        if self.rings[centre] == FAR {
            self.rings[centre] = 0;
            self.visited.push(centre as i32);
        }
    }

    /// Visit all elements up to ring `most`.
    pub fn walk(&mut self, most: i32) {
        let mut head = 0;
        while head < self.visited.len() {
            let element = self.visited[head] as usize;
            head += 1;
            if self.rings[element] >= most {
                break;
            }
            for other in self.graph.neighbours(element) {
                if self.rings[other] == FAR && self.allowed[other] {
                    self.rings[other] = self.rings[element] + 1;
                    self.visited.push(other as i32);
                }
            }
        }
    }

    fn restart(&mut self, centres: &[usize]) {
        self.rings.fill(FAR);
        self.visited.clear();
        for centre in centres {
            self.begin(*centre);
        }
    }

    fn is_reached(&self) -> Vec<bool> {
        self.rings.iter().map(|ring| *ring < FAR).collect()
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
    let mut search = ElementRings::around(graph, allowed, centres);
    search.walk(FAR);
    search.rings
}

/// Row of the element that is visited as number `shift` from a centre; 0 is the centre itself.
///
/// The last one where there are not so many.
pub fn nearby(graph: ElementGraph<'_>, allowed: &[bool], centre: usize, shift: usize) -> usize {
    let mut search = ElementRings::around(graph, allowed, [centre]);
    let mut most = 0;
    while search.visited.len() <= shift && most < MOST_RINGS {
        search.restart(&[centre]);
        most += 2;
        search.walk(most);
    }
    search.visited[shift.min(search.visited.len() - 1)] as usize
}

/// Which allowed elements are across at most `most` crossable edges from a centre.
pub fn disc(graph: ElementGraph<'_>, allowed: &[bool], centre: usize, most: i32) -> Vec<bool> {
    let mut search = ElementRings::around(graph, allowed, [centre]);
    search.walk(most);
    search.is_reached()
}

/// Which elements are within `most` crossable edges from the shortest way between two.
///
/// A disc around the first where there is no way.
pub fn strip(graph: ElementGraph<'_>, allowed: &[bool], ends: [usize; 2], most: i32) -> Vec<bool> {
    let [first, last] = ends;
    let mut search = ElementRings::around(graph, allowed, [last]);
    search.walk(FAR);
    let mut way = vec![first];
    let mut element = first;
    while search.rings[first] < FAR && search.rings[element] > 0 {
        let ring = search.rings[element];
        match graph.neighbours(element).find(|other| search.rings[*other] < ring) {
            Some(nearer) => element = nearer,
            None => break,
        }
        way.push(element);
    }
    search.restart(&way);
    search.walk(most);
    search.is_reached()
}
