//! Maximum matching: Edmonds' blossom algorithm (Paths, trees, and flowers, 1965).
//!
//! From each tria that is alone a tree of alternating paths grows by breadth, better shapes first;
//! odd cycles in it are shrunk to their base. A path to another tria that is alone makes one pair
//! more. The graph has three links a node at most. The cost grows with the number of trias that are
//! alone at first times the size of the trees that they grow.

/// A tree of alternating paths, with its odd cycles shrunk.
struct Tree<'a> {
    neighbours: &'a [[i32; 3]],
    /// Sides of each tria, the best shape first.
    order: Vec<[usize; 3]>,
    mate: Vec<i32>,
    /// The node that stands for the odd cycle that each is in.
    base: Vec<i32>,
    parent: Vec<i32>,
    in_tree: Vec<bool>,
    in_blossom: Vec<bool>,
    mark: Vec<bool>,
    queue: Vec<usize>,
    /// Nodes that the tree has reached, which are all that a next one must forget.
    reached: Vec<usize>,
}

/// Augment a matching to one of greatest cardinality; the mate of each or -1.
///
/// Who has a mate at first has one in the end. The graph is undirected: who is a neighbour of
/// another has it as a neighbour; each is the mate of its mate, which is its neighbour.
pub fn maximum_matching(neighbours: &[[i32; 3]], shapes: &[[f64; 3]], mate: Vec<i32>) -> Vec<i32> {
    let count = neighbours.len();
    let mut tree = Tree {
        neighbours,
        order: shapes.iter().map(sides_by_shape).collect(),
        mate,
        base: (0..count as i32).collect(),
        parent: vec![-1; count],
        in_tree: vec![false; count],
        in_blossom: vec![false; count],
        mark: vec![false; count],
        queue: Vec::new(),
        reached: Vec::new(),
    };
    for root in 0..count {
        if tree.mate[root] < 0
            && let Some(end) = tree.grow(root)
        {
            tree.augment(end);
        }
    }
    tree.mate
}

/// Sides of a tria, the best shape first; of equals the first.
fn sides_by_shape(shapes: &[f64; 3]) -> [usize; 3] {
    let [mut first, mut second, mut third] = [0, 1, 2];
    if shapes[second] > shapes[first] {
        (first, second) = (second, first);
    }
    if shapes[third] > shapes[second] {
        (second, third) = (third, second);
        if shapes[second] > shapes[first] {
            (first, second) = (second, first);
        }
    }
    [first, second, third]
}

impl Tree<'_> {
    /// Grow a tree from a root until it reaches another one that is alone, which is returned.
    fn grow(&mut self, root: usize) -> Option<usize> {
        for t in self.reached.drain(..) {
            self.mark[t] = false;
            self.base[t] = t as i32;
            self.parent[t] = -1;
            self.in_tree[t] = false;
        }
        self.reached.push(root);
        self.in_tree[root] = true;
        self.queue.clear();
        self.queue.push(root);
        let mut head = 0;
        while head < self.queue.len() {
            let v = self.queue[head];
            head += 1;
            for side in self.order[v] {
                let next = self.neighbours[v][side];
                if next < 0 {
                    continue;
                }
                let to = next as usize;
                if self.base[v] == self.base[to] || self.mate[v] == next {
                    continue;
                }
                let mate = self.mate[to];
                if to == root || (mate >= 0 && self.parent[mate as usize] >= 0) {
                    self.shrink(v, to);
                } else if self.parent[to] < 0 {
                    self.parent[to] = v as i32;
                    self.reached.push(to);
                    if mate < 0 {
                        return Some(to);
                    }
                    self.reached.push(mate as usize);
                    self.in_tree[mate as usize] = true;
                    self.queue.push(mate as usize);
                }
            }
        }
        None
    }

    /// Shrink the odd cycle that the link between two nodes of the tree closes.
    fn shrink(&mut self, v: usize, to: usize) {
        let stem = self.base_of_both(v, to);
        self.mark_path(v, stem, to);
        self.mark_path(to, stem, v);
        let first = self.queue.len();
        for t in &self.reached {
            if self.in_blossom[self.base[*t] as usize] {
                self.base[*t] = stem;
                if !self.in_tree[*t] {
                    self.in_tree[*t] = true;
                    self.queue.push(*t);
                }
            }
        }
        self.queue[first..].sort_unstable();
        for t in &self.reached {
            self.in_blossom[*t] = false;
        }
    }

    /// The first base that the ways of two nodes to the root have in common.
    fn base_of_both(&mut self, a: usize, b: usize) -> i32 {
        for t in &self.reached {
            self.mark[*t] = false;
        }
        let mut node = a;
        loop {
            node = self.base[node] as usize;
            self.mark[node] = true;
            if self.mate[node] < 0 {
                break;
            }
            node = self.parent[self.mate[node] as usize] as usize;
        }
        let mut node = b;
        loop {
            node = self.base[node] as usize;
            if self.mark[node] {
                return node as i32;
            }
            node = self.parent[self.mate[node] as usize] as usize;
        }
    }

    /// Mark one side of an odd cycle, from a node down to the base, and link it the other way too.
    fn mark_path(&mut self, from: usize, stem: i32, across: usize) {
        let (mut v, mut child) = (from, across);
        while self.base[v] != stem {
            let mate = self.mate[v] as usize;
            self.in_blossom[self.base[v] as usize] = true;
            self.in_blossom[self.base[mate] as usize] = true;
            self.parent[v] = child as i32;
            child = mate;
            v = self.parent[mate] as usize;
        }
    }

    /// Swap pairs and gaps along the path from an end to the root.
    fn augment(&mut self, end: usize) {
        let mut end = end as i32;
        while end >= 0 {
            let before = self.parent[end as usize];
            let following = self.mate[before as usize];
            self.mate[end as usize] = before;
            self.mate[before as usize] = end;
            end = following;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Most pairs that can be made of a few nodes, by trying all.
    fn greatest(neighbours: &[[i32; 3]], alone: &mut Vec<bool>) -> usize {
        let Some(first) = alone.iter().position(|alone| *alone) else { return 0 };
        alone[first] = false;
        let mut most = greatest(neighbours, alone);
        for other in neighbours[first].iter().filter(|other| **other >= 0) {
            if alone[*other as usize] {
                alone[*other as usize] = false;
                most = most.max(1 + greatest(neighbours, alone));
                alone[*other as usize] = true;
            }
        }
        alone[first] = true;
        most
    }

    proptest! {
        #[test]
        fn no_matching_is_larger(links in prop::collection::vec((0usize..10, 0usize..10), 0..25)) {
            let mut neighbours = vec![[-1; 3]; 10];
            for (a, b) in links {
                let free = |row: [i32; 3]| row.iter().position(|other| *other < 0);
                let (at_a, at_b) = (free(neighbours[a]), free(neighbours[b]));
                if let (Some(at_a), Some(at_b)) = (at_a, at_b)
                    && a != b && !neighbours[a].contains(&(b as i32))
                {
                    neighbours[a][at_a] = b as i32;
                    neighbours[b][at_b] = a as i32;
                }
            }
            let mate = maximum_matching(&neighbours, &[[0.0; 3]; 10], vec![-1; 10]);
            for (t, other) in mate.iter().enumerate().filter(|(_, other)| **other >= 0) {
                prop_assert_eq!(mate[*other as usize], t as i32);
                prop_assert!(neighbours[t].contains(other));
            }
            let paired = mate.iter().filter(|other| **other >= 0).count();
            prop_assert_eq!(paired, 2 * greatest(&neighbours, &mut vec![true; 10]));
        }
    }
}
