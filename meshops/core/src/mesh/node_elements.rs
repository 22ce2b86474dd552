//! The elements around each node.
//!
//! By counting: the cost grows with the number of elements and nodes.

use super::Element;
use super::csr::Csr;

/// Find the elements around each of some nodes, in ascending order.
///
/// Elements name no node beyond `nodes`.
pub fn elements_of_nodes(elements: &[Element], nodes: usize) -> Csr {
    // where node n ends is counted two places on, and grows from n's start as it is filled
    let mut start = vec![0i32; nodes + 2];
    for node in elements.as_flattened() {
        if *node >= 0 {
            start[*node as usize + 2] += 1;
        }
    }
    let mut total = 0;
    for count in &mut start {
        total += *count;
        *count = total;
    }
    let mut items = vec![0; total as usize];
    for (row, element) in elements.iter().enumerate() {
        for node in element {
            if *node >= 0 {
                let place = &mut start[*node as usize + 1];
                items[*place as usize] = row as i32;
                *place += 1;
            }
        }
    }
    start.pop();
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
