//! Removal of an inner node: its edges are flipped away until three are left.
//!
//! The edge goes first whose tria that stays behind has the best shape (as ears are clipped, after
//! Devillers, On deletion in Delaunay triangulations, 1999). The cost is the square of the number
//! of edges at the node.

use super::plane::squared_distance;
use super::{Triangulation, ahead, behind};

impl Triangulation {
    /// Take an inner node out; false where that fails, then some of its edges are flipped.
    ///
    /// The row of the node stays.
    pub fn remove(&mut self, node: usize) -> bool {
        loop {
            let mut valence = 0;
            let mut best = 0.0;
            let mut found = None;
            for (t, k) in self.fan(node) {
                let Some((other, apex)) = self.across(t, k) else { return false };
                if self.neighbours[t][behind(k)] < 0 {
                    return false;
                }
                let (b, c) = (self.trias[t][ahead(k)], self.trias[t][behind(k)]);
                let d = self.trias[other][apex];
                // the edge from the node to b goes: tria dbc stays behind, and must not hold it
                let ear = self.turn(d, b, c);
                if ear > 0.0 && self.turn(node as i32, d, c) >= 0.0 {
                    let sides =
                        squared_distance(&self.points, b, c) + squared_distance(&self.points, b, d);
                    if ear / sides > best {
                        best = ear / sides;
                        found = Some((t, k, other, apex));
                    }
                }
                valence += 1;
            }
            if valence == 3 {
                return self.join_three(node);
            }
            match found {
                Some((t, k, other, apex)) if valence > 3 => self.flip(t, k, other, apex),
                _ => return false,
            }
        }
    }

    /// Make one tria of the three around a node, which is gone then.
    fn join_three(&mut self, node: usize) -> bool {
        let mut fan = self.fan(node);
        let (Some((t, k)), Some((v, j)), Some((u, i))) = (fan.next(), fan.next(), fan.next())
        else {
            return false;
        };
        let (a, b, c) =
            (self.trias[t][ahead(k)], self.trias[t][behind(k)], self.trias[u][ahead(i)]);
        let (ab, bc, ca) = (
            self.neighbours[t][ahead(k)],
            self.neighbours[v][ahead(j)],
            self.neighbours[u][ahead(i)],
        );
        self.set(t, [a, b, c], [ab, bc, ca]);
        self.relink(bc, c, b, t);
        self.relink(ca, a, c, t);
        self.tria_of[node] = -1;
        self.drop_tria(u.max(v));
        self.drop_tria(u.min(v));
        true
    }

    /// Let the last tria take the row of one that nothing looks at any more.
    fn drop_tria(&mut self, t: usize) {
        let (Some(nodes), Some(across)) = (self.trias.pop(), self.neighbours.pop()) else { return };
        if t == self.trias.len() {
            return;
        }
        self.set(t, nodes, across);
        for k in 0..3 {
            self.relink(across[k], nodes[ahead(k)], nodes[k], t);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn what_is_put_in_comes_out(places in prop::collection::vec((0.0f64..1.0, 0.0f64..1.0), 1..25)) {
            let corners = [[-1.0, -1.0], [2.0, -1.0], [2.0, 2.0], [-1.0, 2.0]];
            let mut mesh = Triangulation::new(&corners, &[[0, 1, 2], [0, 2, 3]]);
            for (x, y) in &places {
                let t = mesh.locate(0, [*x, *y]).unwrap();
                mesh.insert(t, [*x, *y]);
            }
            for node in (4..mesh.points.len()).rev() {
                prop_assert!(mesh.remove(node));
                prop_assert!(mesh.is_consistent());
            }
            prop_assert_eq!(mesh.trias.len(), 2);
        }
    }
}
