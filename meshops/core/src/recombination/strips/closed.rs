//! Rows of quads that close on themselves (closed chords).
//!
//! The graph of elements is whole. Each edge is crossed once, so the cost grows with the mesh.

use super::{StripGround, Strips};
use crate::mesh::is_tria;

/// All closed rows of quads, except those that cross themselves.
pub fn closed_strips(ground: StripGround<'_>) -> Strips {
    let StripGround { elements, graph, editable } = ground;
    let mut strips = Strips::default();
    let mut crossed = vec![false; graph.crossable.len()];
    let mut seen = vec![0u32; elements.len()];
    // the other two sides of a quad are opposite to these
    for number in 0..2 * elements.len() {
        let mark = number as u32 + 1;
        let first = strips.cells.len();
        let (mut is_whole, mut is_closed) = (true, false);
        let mut at = Some((number / 2, number % 2));
        while let Some((cell, side)) = at {
            if !editable[cell] || is_tria(elements[cell]) {
                break;
            }
            let Ok(edge) = usize::try_from(graph.element_edges[cell][side]) else { break };
            if crossed[edge] {
                let has_begun = strips.cells.get(first) == Some(&(cell as i32));
                is_closed = has_begun && side == number % 2;
                break;
            }
            crossed[edge] = true;
            is_whole &= seen[cell] != mark;
            seen[cell] = mark;
            strips.cells.push(cell as i32);
            strips.rungs.push(ground.rung(cell, side));
            at = graph.enter(cell, side).map(|(other, entry)| (other, (entry + 2) % 4));
        }
        if is_closed && is_whole {
            strips.close();
        } else {
            strips.cells.truncate(first);
            strips.rungs.truncate(first);
        }
    }
    strips
}
