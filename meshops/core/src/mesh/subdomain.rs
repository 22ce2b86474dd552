//! Partition of a mesh into subdomains around bad places.

use super::element_graph::ElementGraph;

/// How far a subdomain reaches.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Reach {
    /// Most crossable edges from the bad element.
    pub rings: i32,
    /// Most elements.
    pub elements: usize,
}

/// Subdomain of each element; -1 for an element that is in none.
///
/// Each bad element that is in no subdomain yet starts one: all free elements around it, ring by
/// ring. Beyond the array of labels the cost grows with the elements in subdomains, not with the
/// mesh.
pub fn partition(
    graph: ElementGraph<'_>,
    editable: &[bool],
    bad: impl IntoIterator<Item = usize>,
    reach: Reach,
) -> Vec<i32> {
    let mut label = vec![-1; graph.len()];
    let mut queue: Vec<(usize, i32)> = Vec::new();
    let mut found = 0;
    for centre in bad {
        if label[centre] >= 0 || !editable[centre] {
            continue;
        }
        label[centre] = found;
        queue.clear();
        queue.push((centre, 0));
        let mut head = 0;
        while head < queue.len() {
            let (element, depth) = queue[head];
            head += 1;
            if depth >= reach.rings {
                break;
            }
            for other in graph.neighbours(element) {
                if label[other] < 0 && editable[other] && queue.len() < reach.elements {
                    label[other] = found;
                    queue.push((other, depth + 1));
                }
            }
        }
        found += 1;
    }
    label
}
