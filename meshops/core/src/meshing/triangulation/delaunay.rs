//! Constrained Delaunay triangulation by flipping edges (Lawson, Software for C1 surface
//! interpolation, 1977).
//!
//! An edge is turned where the circle of one of its trias holds the corner of the other and the
//! two make a convex quad. Sweeps go on until nothing turns; on the whole as many flips are made
//! as there are edges to turn.

use super::plane::{Place, turn};
use super::{Triangulation, ahead, behind};
use crate::math::greatest_of;

/// Of squared areas: in-circle tests below this are taken for zero.
const ROUND: f64 = 1e-12;

/// Whether d, beyond side ab of tria abc, lies in its circle, so that edge cd is better.
fn wants_flip(points: &[Place], [a, b, c]: [i32; 3], d: i32) -> bool {
    let is_convex = turn(points, a, d, c) > 0.0 && turn(points, d, b, c) > 0.0;
    if !is_convex {
        return false;
    }
    let place = points[d as usize];
    let from_d = |node: i32| {
        let [x, y] = points[node as usize];
        (x - place[0], y - place[1])
    };
    let ((ax, ay), (bx, by), (cx, cy)) = (from_d(a), from_d(b), from_d(c));
    let (a2, b2, c2) = (ax * ax + ay * ay, bx * bx + by * by, cx * cx + cy * cy);
    let inside = a2 * (bx * cy - by * cx) + b2 * (cx * ay - cy * ax) + c2 * (ax * by - ay * bx);
    let farthest = greatest_of([a2, b2, c2]);
    inside > ROUND * (farthest * farthest)
}

impl Triangulation {
    /// Flip edges until the triangulation is the constrained Delaunay one.
    pub fn legalise(&mut self) {
        for _ in 0..self.trias.len() + 8 {
            let mut changed = false;
            for t in 0..self.trias.len() {
                for k in 0..3 {
                    changed |= self.legalise_side(t, k);
                }
            }
            if !changed {
                return;
            }
        }
    }

    /// Flip the edge at side k of a tria if that is better; whether it was.
    #[inline]
    fn legalise_side(&mut self, t: usize, k: usize) -> bool {
        let Some((other, apex)) = self.across(t, k) else { return false };
        let nodes = self.trias[t];
        let tria = [nodes[k], nodes[ahead(k)], nodes[behind(k)]];
        let wanted = wants_flip(&self.points, tria, self.trias[other][apex]);
        if wanted {
            self.flip(t, k, other, apex);
        }
        wanted
    }

    /// Make the edges opposite an inner node Delaunay, and those that flips bring to face it.
    pub(super) fn legalise_around(&mut self, node: usize) {
        let mut first = self.tria_of[node];
        let mut t = first;
        // each flip brings an edge to the node, and none takes one away
        let mut most = self.trias.len();
        while t >= 0 {
            let Some(corner) = self.corner_of(t as usize, node) else { return };
            if most > 0 && self.legalise_side(t as usize, ahead(corner)) {
                // both trias of the flipped edge are at the node: go on with the earlier one
                first = t;
                most -= 1;
            } else {
                t = self.neighbours[t as usize][behind(corner)];
                if t == first {
                    return;
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn no_circle_holds_a_node(places in prop::collection::vec((0.0f64..1.0, 0.0f64..1.0), 3..25)) {
            let corners = [[-1.0, -1.0], [2.0, -1.0], [2.0, 2.0], [-1.0, 2.0]];
            let mut mesh = Triangulation::new(&corners, &[[0, 1, 2], [0, 2, 3]]);
            for (x, y) in &places {
                let t = mesh.locate(0, [*x, *y]).unwrap();
                mesh.insert(t, [*x, *y]);
            }
            prop_assert!(mesh.is_consistent());
            prop_assert_eq!(mesh.trias.len(), 2 + 2 * places.len());
            for tria in &mesh.trias {
                for node in (0..mesh.points.len() as i32).filter(|node| !tria.contains(node)) {
                    prop_assert!(mesh.turn(tria[0], tria[1], tria[2]) >= 0.0);
                    prop_assert!(!wants_flip(&mesh.points, *tria, node));
                }
            }
        }
    }
}
