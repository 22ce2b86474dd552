//! The constrained Delaunay triangulation of an area on its border nodes alone.

use super::Triangulation;
use super::plane::Place;
use crate::mesh::Facet;

/// Take all inner nodes out of an older triangulation of an area; border nodes come first.
///
/// None where one stays in, or where more than two trias meet at a side.
pub fn border_triangulation(
    points: &[Place],
    trias: &[Facet],
    border_nodes: usize,
) -> Option<Triangulation> {
    let mut mesh = Triangulation::new(points, trias);
    if !mesh.is_consistent() {
        return None;
    }
    mesh.legalise();
    for node in (border_nodes..points.len()).rev() {
        if mesh.tria_of[node] >= 0 && !mesh.remove(node) {
            return None;
        }
    }
    // a node at which two fans meet is still in one of them
    if mesh.trias.as_flattened().iter().any(|node| *node as usize >= border_nodes) {
        return None;
    }
    mesh.points.truncate(border_nodes);
    mesh.tria_of.truncate(border_nodes);
    mesh.legalise();
    Some(mesh)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_middle_of_a_square_goes() {
        let points = [[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0], [1.0, 1.2]];
        let trias = [[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]];
        let mesh = border_triangulation(&points, &trias, 4).unwrap();
        assert_eq!(mesh.points.len(), 4);
        assert_eq!(mesh.trias.len(), 2);
        assert!(mesh.is_consistent());
        assert!(border_triangulation(&points, &trias, 3).is_none());
    }
}
