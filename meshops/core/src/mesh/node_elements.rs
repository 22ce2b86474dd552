//! The elements around each node.
//!
//! By counting: the cost grows with the number of elements and nodes.

use super::Element;
use super::csr::Csr;

/// Find the elements around each of some nodes, in ascending order.
///
/// Elements name no node beyond `nodes`.
pub fn elements_of_nodes(elements: &[Element], nodes: usize) -> Csr {
    let mut start = vec![0; nodes + 1];
    for node in elements.iter().flatten().filter(|node| **node >= 0) {
        start[*node as usize + 1] += 1;
    }
    for node in 0..nodes {
        start[node + 1] += start[node];
    }
    let mut fill = start.clone();
    let mut items = vec![0; start[nodes] as usize];
    for (row, element) in elements.iter().enumerate() {
        for node in element.iter().filter(|node| **node >= 0) {
            let place = &mut fill[*node as usize];
            items[*place as usize] = row as i32;
            *place += 1;
        }
    }
    Csr { start, items }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_elements_in_order() {
        let around = elements_of_nodes(&[[0, 1, 2, -1], [2, 1, 3, 4]], 6);
        assert_eq!(around.list(1), [0, 1]);
        assert_eq!(around.list(4), [1]);
        assert!(around.list(5).is_empty());
    }
}
