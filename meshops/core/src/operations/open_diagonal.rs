//! Opening diagonals: a node becomes two, with a new quad between them.
//!
//! The inverse of collapsing a diagonal (vertex rotation and face opening: Canann, Muthukrishnan,
//! Phillips: Topological improvement procedures for quadrilateral finite element meshes, 1998).

use super::candidates::CandidateList;
use super::node_fan::NodeFan;
use crate::mesh::Element;
use crate::mesh::csr::CsrView;
use crate::vectors::{Vector, add, area_vector, cross, edge, length, scale, subtract, unit};

/// Of the edge length: how far the two nodes that one is split into move from its place.
const OFFSET: f64 = 0.25;

/// Split each node along two of its edges and put a quad between, in so many variants.
///
/// Variant `i` opens at edge `i` of the node and at the one half of the elements further on; those
/// that there are not are empty.
pub fn open_diagonals(
    nodes: &[i32],
    variants: usize,
    points: &[Vector],
    elements: &[Element],
    around: CsrView<'_>,
) -> CandidateList {
    let mut list = CandidateList::with_capacity(variants * nodes.len());
    for node in nodes {
        let fan = NodeFan::around(*node, elements, around).filter(|fan| fan.count >= 4);
        let ways = fan.map_or(0, |fan| if fan.count % 2 == 0 { fan.count / 2 } else { fan.count });
        for way in 0..variants {
            if let Some(fan) = fan
                && way < ways
            {
                open(*node, way, &fan, points, elements, &mut list);
            }
            list.end();
        }
    }
    list
}

/// Add the candidate that opens a node at edge `way`, and end no candidate.
fn open(
    node: i32,
    way: usize,
    fan: &NodeFan,
    points: &[Vector],
    elements: &[Element],
    list: &mut CandidateList,
) {
    let new = points.len() as i32;
    let side = fan.count / 2;
    let (first, last) = (fan.ends[way], fan.ends[(way + side) % fan.count]);
    for i in 0..side {
        let row = fan.rows[(way + i) % fan.count];
        let split = |old| if old == node { new } else { old };
        list.removed.push(row);
        list.added.push(elements[row as usize].map(split));
    }
    list.added.push([node, first, new, last]);

    let mut normal = [0.0; 3];
    for row in &fan.rows[..fan.count] {
        normal = add(normal, area_vector(points, elements[*row as usize]));
    }
    // the side that is cut off lies to the right of the way from first to last
    let along = edge(points, first, last);
    let step = scale(unit(cross(along, normal)), 0.5 * OFFSET * length(along));
    let here = points[node as usize];
    list.points.push(add(here, step));
    list.moved.push(node);
    list.moved_to.push(subtract(here, step));
}
