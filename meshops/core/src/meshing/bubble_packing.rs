//! Bubble packing: nodes push each other to even distances (Shimada and Gossard, Bubble mesh, 1995).
//!
//! Bubbles are as large as the edges wanted at their nodes; they start where Delaunay refinement
//! puts them. In rounds they push and pull their neighbours, those that overlap too much go, and
//! gaps are refined again. The cost of a sweep grows with the number of nodes.

use super::area::{Area, Filled};
use super::delaunay_refinement::{Refinement, move_by};
use super::triangulation::ahead;
use super::triangulation::plane::squared_distance;
use crate::math::greatest;

/// How often bubbles are pushed, thinned out and added.
const ROUNDS: usize = 3;

/// Sweeps over all nodes, in each round and in the end.
const SWEEPS: usize = 5;

/// Of the size: bubbles farther apart do not act on each other.
const REACH: f64 = 1.5;

/// Of the force: how far a bubble moves in a sweep.
const STEP: f64 = 0.2;

/// Overlap from which a bubble goes; 6 where those around it just touch it.
const CROWDED: f64 = 8.5;

/// Fill an area with trias of an edge length, with so many nodes at most.
///
/// None where the area cannot be triangulated on its border.
pub fn fill_by_bubbles(area: Area<'_>, size: f64, room: usize) -> Option<Filled> {
    let mut bubbles = Refinement::of(area, size, room)?;
    bubbles.refine();
    for _ in 0..ROUNDS {
        push_all(&mut bubbles);
        thin_out(&mut bubbles);
        bubbles.mesh.legalise();
        bubbles.refine();
    }
    push_all(&mut bubbles);
    Some(bubbles.filled())
}

/// Let all bubbles come nearer to rest.
fn push_all(bubbles: &mut Refinement) {
    for _ in 0..SWEEPS {
        push(bubbles);
        bubbles.mesh.legalise();
    }
}

/// Let neighbouring bubbles push and pull each other, by a force that is cubic in the distance.
fn push(bubbles: &mut Refinement) {
    let Refinement { mesh, sizes, border_nodes, .. } = bubbles;
    for node in *border_nodes..mesh.points.len() {
        let place = mesh.points[node];
        let (mut x, mut y) = (0.0, 0.0);
        for (t, k) in mesh.fan(node) {
            let other = mesh.trias[t][ahead(k)] as usize;
            let (dx, dy) = (place[0] - mesh.points[other][0], place[1] - mesh.points[other][1]);
            let distance = (dx * dx + dy * dy).sqrt();
            let w = 2.0 * distance / (sizes[node] + sizes[other]);
            if 0.0 < w && w < REACH {
                let force = 1.25 * (w * (w * w)) - 2.375 * (w * w) + 1.125;
                x += force * dx / distance;
                y += force * dy / distance;
            }
        }
        move_by(mesh, node, [STEP * sizes[node] * x, STEP * sizes[node] * y]);
    }
}

/// Take out bubbles that overlap too much; the last one takes the row of each.
fn thin_out(bubbles: &mut Refinement) {
    for node in (bubbles.border_nodes..bubbles.mesh.points.len()).rev() {
        if crowding(bubbles, node) <= CROWDED || !bubbles.mesh.remove(node) {
            continue;
        }
        let Refinement { mesh, sizes, .. } = bubbles;
        let last = mesh.points.len() - 1;
        if node != last {
            let around: Vec<(usize, usize)> = mesh.fan(last).collect();
            for (t, k) in around {
                mesh.trias[t][k] = node as i32;
            }
            mesh.tria_of[node] = mesh.tria_of[last];
        }
        mesh.points.swap_remove(node);
        sizes.swap_remove(node);
        mesh.tria_of.pop();
    }
}

/// By how much the bubbles around a node overlap its own.
fn crowding(bubbles: &Refinement, node: usize) -> f64 {
    let Refinement { mesh, sizes, .. } = bubbles;
    let mut total = 0.0;
    for (t, k) in mesh.fan(node) {
        let other = mesh.trias[t][ahead(k)];
        let distance = squared_distance(&mesh.points, node as i32, other).sqrt();
        let overlap = sizes[node] + 0.5 * sizes[other as usize] - distance;
        total += greatest(0.0, overlap / (0.5 * sizes[node]));
    }
    total
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::meshing::area::tests::square;

    #[test]
    fn bubbles_fill_a_large_square() {
        let (points, trias, border) = square(4);
        let area = Area { points: &points, trias: &trias, border: &border };
        let filled = fill_by_bubbles(area, 1.0, 100).unwrap();
        assert_eq!(filled.points[..16], points);
        assert!(filled.points.len() > 20);
        assert_eq!(filled.trias.len(), 2 * filled.points.len() - 18);
    }
}
