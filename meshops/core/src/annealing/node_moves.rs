//! Moves of the nodes of a patch that anneals: to where they relax, or anywhere near.
//!
//! A node relaxes to between the mean of its neighbours and that of the parallelograms around it
//! (Herrmann, Laplacian-isoparametric grid generation scheme, 1976). Each move looks at the elements
//! around one node; on a curved surface the cost is that of finding the nearest point.

use super::energy::Site;
use super::undoable_patch::{Done, NotDone, UndoablePatch};
use crate::mesh::is_tria;
use crate::rng::Xorshift;
use crate::vectors::{Vector, add, cross, dot, length, scale, subtract, unit};

/// Sweeps of relaxation after a change.
const SWEEPS: usize = 2;

/// Weight of the far node of a quad in the place that a node relaxes to.
const OPPOSITE: f64 = 0.4;

/// Share of the moves that go to where the node relaxes.
const PULLED: f64 = 0.3;

/// Of the mean edge at a node: the farthest that it is moved in a trial.
const FARTHEST: f64 = 0.3;

/// What a node's neighbours make of it.
struct Relaxed {
    /// Where it relaxes to.
    place: Vector,
    /// The mean edge at it.
    edge: f64,
}

/// Relax the free ones of some nodes, one after the other.
pub fn relax_nodes(patch: &mut UndoablePatch, site: &Site<'_>, nodes: &[i32]) -> Done {
    for _ in 0..SWEEPS {
        for node in nodes {
            if !site.is_fixed(*node) && !patch.around(*node).is_empty() {
                let place = relaxed(patch, *node).place;
                patch.put(*node, site.onto(place))?;
            }
        }
    }
    Ok(())
}

/// Move a node: a part of the way to where it relaxes, or anywhere near.
pub fn move_node(
    patch: &mut UndoablePatch,
    site: &Site<'_>,
    node: i32,
    random: &mut Xorshift,
) -> Done {
    let first = patch.around(node).first().map(|row| *row as usize);
    let Some(row) = first.filter(|_| !site.is_fixed(node)) else {
        return Err(NotDone);
    };
    let here = patch.point(node);
    let Relaxed { place, edge } = relaxed(patch, node);
    if random.draw() < PULLED {
        let pull = scale(subtract(place, here), random.draw());
        return patch.put(node, site.onto(add(here, pull)));
    }
    let k = patch.corner(row, node).ok_or(NotDone)?;
    let p = subtract(patch.point(patch.ahead(row, k)), here);
    let q = subtract(patch.point(patch.behind(row, k)), here);
    let normal = unit(cross(p, q));
    let along = unit(subtract(p, scale(normal, dot(p, normal))));
    let across = cross(normal, along);
    let reach = FARTHEST * edge * random.draw();
    let x = reach * (2.0 * random.draw() - 1.0);
    let y = reach * (2.0 * random.draw() - 1.0);
    patch.put(node, site.onto(add(here, add(scale(along, x), scale(across, y)))))
}

/// Where a node relaxes to. There are elements around it.
fn relaxed(patch: &UndoablePatch, node: i32) -> Relaxed {
    let here = patch.point(node);
    let around = patch.around(node);
    let (mut total, mut weight, mut edges) = ([0.0; 3], 0.0, 0.0);
    for row in around.iter().map(|row| *row as usize) {
        let Some(k) = patch.corner(row, node) else { continue };
        let p = patch.point(patch.ahead(row, k));
        let q = patch.point(patch.behind(row, k));
        edges += 0.5 * (length(subtract(p, here)) + length(subtract(q, here)));
        total = add(total, add(p, q));
        weight += 2.0;
        let element = patch.elements()[row];
        if !is_tria(element) {
            let opposite = element[(k + 2) % 4];
            total = subtract(total, scale(patch.point(opposite), OPPOSITE));
            weight -= OPPOSITE;
        }
    }
    Relaxed { place: scale(total, 1.0 / weight), edge: edges / around.len() as f64 }
}
