//! Border edges of a patch as closed loops.

use super::csr::Csr;

/// Order border edges, each from node to node, into closed loops.
///
/// List `k` has the rows of the edges of loop `k`, along its edges from its first row on. Each node
/// that an edge leads to is one that an edge leaves; of several that leave it the last is taken.
/// A loop that is left by no edge ends there.
pub fn trace_loops(border: &[[i32; 2]]) -> Csr {
    let nodes = border.iter().flatten().max().map_or(0, |node| *node as usize + 1);
    let mut leaving = vec![-1; nodes];
    for (row, edge) in border.iter().enumerate() {
        leaving[edge[0] as usize] = row as i32;
    }
    let mut loops = Csr { start: vec![0], items: Vec::with_capacity(border.len()) };
    let mut seen = vec![false; border.len()];
    for first in 0..border.len() {
        let mut edge = first as i32;
        let placed = loops.items.len();
        while edge >= 0 && !seen[edge as usize] {
            seen[edge as usize] = true;
            loops.items.push(edge);
            edge = leaving[border[edge as usize][1] as usize];
        }
        if loops.items.len() > placed {
            loops.start.push(loops.items.len() as i32);
        }
    }
    loops
}
