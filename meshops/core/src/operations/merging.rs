//! Merging nodes: what is left of the elements that have them.
//!
//! A quad that loses one node is a tria; one that loses two, or whose opposite nodes meet, and a
//! tria that loses one, vanish (Figures 9 and 11 of the paper that `ReplaceNode` is from). The cost
//! grows with the elements that are looked at.

use crate::mesh::{Element, NO_NODE, size_of};

/// The nodes that an element has after merging; none where it vanishes.
///
/// `target` has for each node the one that it is merged into, for most the node itself.
#[inline]
pub fn merged_element(element: Element, target: &[i32]) -> Option<Element> {
    without_doubles(element.map(|node| if node < 0 { node } else { target[node as usize] }))
}

/// An element whose nodes may be the same without the doubles; none where too few are left.
#[inline]
pub fn without_doubles(element: Element) -> Option<Element> {
    let mut out = [NO_NODE; 4];
    let mut count = 0;
    for node in &element[..size_of(element)] {
        if count == 0 || out[count - 1] != *node {
            out[count] = *node;
            count += 1;
        }
    }
    if count > 1 && out[0] == out[count - 1] {
        count -= 1;
    }
    if count < 3 || (count == 4 && (out[0] == out[2] || out[1] == out[3])) {
        return None;
    }
    if count == 3 {
        out[3] = NO_NODE;
    }
    Some(out)
}

/// What merging does to the elements of a mesh.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Rewiring {
    /// Rows of the elements that vanish.
    pub removed: Vec<i32>,
    /// Rows of those that stay with other nodes.
    pub changed: Vec<i32>,
    /// The nodes that these get.
    pub elements: Vec<Element>,
}

/// Find which elements vanish by merging, which change, and to what nodes.
pub fn rewire(elements: &[Element], target: &[i32]) -> Rewiring {
    let mut rewiring = Rewiring::default();
    for (row, element) in elements.iter().enumerate() {
        match merged_element(*element, target) {
            None => rewiring.removed.push(row as i32),
            Some(after) if after != *element => {
                rewiring.changed.push(row as i32);
                rewiring.elements.push(after);
            }
            Some(_) => {}
        }
    }
    rewiring
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn a_quad_becomes_a_tria_or_vanishes() {
        assert_eq!(merged_element([0, 1, 2, 3], &[1, 1, 2, 3]), Some([1, 2, 3, -1]));
        assert_eq!(merged_element([0, 1, 2, 3], &[0, 1, 2, 0]), Some([0, 1, 2, -1]));
        assert_eq!(merged_element([0, 1, 2, 3], &[0, 1, 0, 3]), None);
        assert_eq!(merged_element([0, 1, 2, 3], &[0, 0, 2, 2]), None);
        assert_eq!(merged_element([0, 1, 2, -1], &[0, 1, 1]), None);
    }

    proptest! {
        #[test]
        fn what_is_left_has_no_node_twice(
            target in prop::array::uniform4(0i32..4), tria in any::<bool>()
        ) {
            let element = if tria { [0, 1, 2, NO_NODE] } else { [0, 1, 2, 3] };
            if let Some(after) = merged_element(element, &target) {
                let nodes = &after[..size_of(after)];
                prop_assert!((1..nodes.len()).all(|k| !nodes[..k].contains(&nodes[k])));
            }
        }
    }
}
