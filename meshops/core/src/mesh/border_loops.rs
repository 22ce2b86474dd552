//! Border edges of a patch as closed loops.

use super::csr::Csr;

/// Order border edges, each from node to node, into closed loops.
///
/// List `k` has the rows of the edges of loop `k`, along its edges from its first row on. Of several
/// edges that leave a node the last is taken; where none does the loop ends. Edges are sorted by
/// their nodes, which the cost grows with.
pub fn trace_loops(border: &[[i32; 2]]) -> Csr {
    let mut by_start: Vec<(i32, i32)> =
        border.iter().zip(0..).map(|(edge, row)| (edge[0], row)).collect();
    by_start.sort_unstable();
    let leaving = |node: i32| {
        let beyond = by_start.partition_point(|(start, _)| *start <= node);
        match beyond.checked_sub(1).map(|place| by_start[place]) {
            Some((start, row)) if start == node => Some(row as usize),
            _ => None,
        }
    };
    let mut loops = Csr { start: vec![0], items: Vec::with_capacity(border.len()) };
    let mut seen = vec![false; border.len()];
    for first in 0..border.len() {
        let placed = loops.items.len();
        let mut edge = Some(first);
        while let Some(row) = edge.filter(|row| !seen[*row]) {
            seen[row] = true;
            loops.items.push(row as i32);
            edge = leaving(border[row][1]);
        }
        if loops.items.len() > placed {
            loops.start.push(loops.items.len() as i32);
        }
    }
    loops
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn follows_each_loop_from_its_first_edge() {
        let loops = trace_loops(&[[0, 1], [5, 6], [2, 0], [1, 2], [6, 5]]);
        assert_eq!((loops.list(0), loops.list(1)), (&[0, 3, 2][..], &[1, 4][..]));
    }
}
