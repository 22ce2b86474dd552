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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn subdomains_are_disjoint_and_no_larger_than_allowed() {
        // ten elements in a ring
        let element_edges: Vec<[i32; 4]> = (0..10).map(|i| [(i + 9) % 10, i, -1, -1]).collect();
        let edge_elements: Vec<[i32; 2]> = (0..10).map(|i| [i, (i + 1) % 10]).collect();
        let graph = ElementGraph {
            element_edges: &element_edges,
            edge_elements: &edge_elements,
            crossable: &[true; 10],
        };
        let reach = Reach { rings: 2, elements: 4 };
        let label = partition(graph, &[true; 10], [0, 3, 1], reach);
        assert_eq!(label, [0, 0, 1, 1, 1, 1, -1, -1, 0, 0]);
    }
}
