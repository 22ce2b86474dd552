//! Valence: how many elements meet at a node. An inner node is regular where it is four.

use super::Element;
use super::csr::CsrView;

/// Elements that meet at a regular inner node.
pub const REGULAR: i32 = 4;

/// Whether a node is used and has other than four elements.
///
/// `outside` is how many of them are not of the mesh; -1: any number may meet at the node.
#[inline]
pub fn is_irregular(valence: i32, outside: i32) -> bool {
    (outside >= 0) & (valence > 0) & (valence.wrapping_add(outside) != REGULAR)
}

/// Which nodes are irregular; `outside` has one value a node.
pub fn irregular_nodes(around: CsrView<'_>, outside: &[i32]) -> Vec<bool> {
    let ends = around.start.get(1..).unwrap_or_default();
    let counts = around.start.iter().zip(ends).map(|(start, end)| end.wrapping_sub(*start));
    counts.zip(outside).map(|(count, outside)| is_irregular(count, *outside)).collect()
}

/// What the valence of a mesh's nodes follows from.
#[derive(Clone, Copy, Debug)]
pub struct Valences<'a> {
    /// The mesh.
    pub elements: &'a [Element],
    /// The elements around each node.
    pub around: CsrView<'a>,
    /// Elements at each node that are not of the mesh, -1 where any number may be.
    pub outside: &'a [i32],
}

impl Valences<'_> {
    /// How many more nodes are irregular once some elements have come for those in some rows.
    ///
    /// Nodes beyond those of the mesh are new. `counts` is scratch, one a node and new node, all 0
    /// before and after. The cost grows with the elements that come and go alone.
    pub fn irregular_change(&self, goes: &[i32], comes: &[Element], counts: &mut [i32]) -> i64 {
        let gone = goes.iter().map(|row| self.elements[*row as usize]);
        for node in gone.clone().flatten().filter(|node| *node >= 0) {
            counts[node as usize] -= 1;
        }
        for node in comes.iter().flatten().filter(|node| **node >= 0) {
            counts[*node as usize] += 1;
        }
        let nodes = self.around.len();
        let mut change = 0;
        for node in gone.chain(comes.iter().copied()).flatten() {
            if node < 0 || counts[node as usize] == 0 {
                continue;
            }
            let node = node as usize;
            let had = self.around.count(node);
            let free = if node < nodes { self.outside[node] } else { 0 };
            change += i64::from(is_irregular(had + counts[node], free));
            change -= i64::from(is_irregular(had, free));
            counts[node] = 0;
        }
        change
    }
}
