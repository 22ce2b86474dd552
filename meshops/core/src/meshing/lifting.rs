//! Lifting places in the plane of a flattened surface back to the surface.
//!
//! A place is found by walking through the flattened trias, from where the last one was; its shares
//! in the corners of its tria are the same on the surface. Places that lie near one another in
//! their order cost little each.

use super::triangulation::plane::{Place, area_to, squared_distance};
use super::triangulation::{Triangulation, ahead, behind};
use crate::mesh::Facet;
use crate::vectors::{Vector, cross, edge};

/// Normals of trias, as long as twice their area.
pub fn area_normals(points: &[Vector], trias: &[Facet]) -> Vec<Vector> {
    let normal = |[a, b, c]: &Facet| cross(edge(points, *a, *b), edge(points, *a, *c));
    trias.iter().map(normal).collect()
}

/// Places on a surface of places in the plane of its flattened trias.
///
/// `flat` and `points` are the nodes in the plane and in space, one at least. Where a place lies in
/// no tria, the nearest node lends its own.
pub fn lift(flat: &[Place], trias: &[Facet], points: &[Vector], places: &[Place]) -> Vec<Vector> {
    let mesh = Triangulation::new(flat, trias);
    let mut t = if trias.is_empty() { -1 } else { 0 };
    let mut lift_one = |place: &Place| {
        let Some(found) = mesh.locate(t, *place) else {
            return points[nearest(flat, *place)];
        };
        t = found as i32;
        let tria = trias[found];
        let whole = mesh.turn(tria[0], tria[1], tria[2]);
        let mut lifted = [0.0; 3];
        for k in 0..3 {
            let share = area_to(flat, tria[ahead(k)], tria[behind(k)], *place) / whole;
            let corner = points[tria[k] as usize];
            for axis in 0..3 {
                lifted[axis] += share * corner[axis];
            }
        }
        lifted
    };
    places.iter().map(&mut lift_one).collect()
}

/// The node that is nearest to a place; of equals the first.
fn nearest(flat: &[Place], place: Place) -> usize {
    let (mut nearest, mut least) = (0, f64::INFINITY);
    for (node, there) in flat.iter().enumerate() {
        let squared = squared_distance(&[place, *there], 0, 1);
        if squared < least {
            (nearest, least) = (node, squared);
        }
    }
    nearest
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_place_has_the_same_shares_on_a_slope() {
        let flat = [[0.0, 0.0], [2.0, 0.0], [2.0, 2.0]];
        let points = [[0.0, 0.0, 0.0], [2.0, 0.0, 2.0], [2.0, 2.0, 2.0]];
        let lifted = lift(&flat, &[[0, 1, 2]], &points, &[[1.0, 0.5], [9.0, 0.0]]);
        assert_eq!(lifted, [[1.0, 0.5, 1.0], [2.0, 0.0, 2.0]]);
        assert_eq!(area_normals(&points, &[[0, 1, 2]]), [[-4.0, 0.0, 4.0]]);
    }
}
