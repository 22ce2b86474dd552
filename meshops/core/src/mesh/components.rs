//! Connected components of the elements of a mesh.

use super::element_graph::ElementGraph;

/// Number the components of the selected elements across crossable edges; elsewhere -1.
///
/// Components are numbered in the order of their first element. The cost grows with the number of
/// elements.
pub fn label_components(graph: ElementGraph<'_>, selected: &[bool]) -> Vec<i32> {
    let mut label = vec![-1; graph.len()];
    let mut left = selected.to_vec();
    let mut stack = Vec::new();
    let mut components = 0;
    for seed in 0..graph.len() {
        if !left[seed] {
            continue;
        }
        left[seed] = false;
        stack.push(seed);
        while let Some(element) = stack.pop() {
            label[element] = components;
            for other in graph.neighbours(element) {
                if left[other] {
                    left[other] = false;
                    stack.push(other);
                }
            }
        }
        components += 1;
    }
    label
}
