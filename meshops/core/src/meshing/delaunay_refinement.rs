//! Delaunay refinement: circumcentres are inserted until no tria is too large (Chew, Guaranteed-
//! quality triangular meshes, 1989; the border is left alone), then nodes are smoothed.
//!
//! The largest trias go first, in passes. The cost grows with the number of nodes times that of
//! border edges, whose spacing each new node asks for.

use super::area::{Area, Filled};
use super::cross_field::CrossField;
use super::triangulation::border_triangulation::border_triangulation;
use super::triangulation::plane::{Place, area_to, squared_distance};
use super::triangulation::{Triangulation, ahead, behind};

/// Circumradius of a regular tria over its edge: the root of a third.
const REGULAR: f64 = 0.577_350_269_189_625_8;

/// Circumradius over that of the regular tria from which each pass refines: the largest first.
const PASSES: [f64; 4] = [4.0, 2.4, 1.7, 1.35];

/// Of the local size: the least distance of a node from a border edge and from other nodes.
const FROM_BORDER: f64 = 0.6;

/// Laplace sweeps over all nodes in the end.
const SWEEPS: usize = 3;

/// Fill an area with trias of an edge length, with so many nodes at most.
///
/// None where the area cannot be triangulated on its border.
pub fn fill_by_refinement(area: Area<'_>, size: f64, room: usize) -> Option<Filled> {
    let mut refinement = Refinement::of(area, size, room)?;
    refinement.refine();
    for _ in 0..SWEEPS {
        refinement.laplace();
        refinement.mesh.legalise();
    }
    Some(refinement.filled())
}

/// An area that is being refined.
pub(super) struct Refinement {
    pub mesh: Triangulation,
    /// Edge length wanted at each node.
    pub sizes: Vec<f64>,
    pub border_nodes: usize,
    field: CrossField,
    /// Most nodes that may be there in the end.
    most: usize,
}

impl Refinement {
    /// The triangulation of an area on its border; None where there is none.
    pub fn of(area: Area<'_>, size: f64, room: usize) -> Option<Self> {
        let border_nodes = area.border_nodes();
        let mesh = border_triangulation(area.points, area.trias, border_nodes)?;
        let field = CrossField::of(area.points, area.border, size);
        let sizes = field.sizes_on_border(area.border, border_nodes);
        Some(Self { mesh, sizes, border_nodes, field, most: border_nodes.saturating_add(room) })
    }

    /// What came out.
    pub fn filled(self) -> Filled {
        Filled { points: self.mesh.points, trias: self.mesh.trias }
    }

    /// Insert circumcentres until no tria is too large.
    pub fn refine(&mut self) {
        for limit in PASSES {
            let mut t = 0;
            while t < self.mesh.trias.len() && self.mesh.points.len() < self.most {
                t = self.refine_tria(t, limit);
            }
        }
    }

    /// Insert the circumcentre of a tria that is too large; the tria to go on with.
    fn refine_tria(&mut self, t: usize, limit: f64) -> usize {
        let nodes = self.mesh.trias[t];
        let [a, b, c] = nodes.map(|node| self.sizes[node as usize]);
        let here = (a + b + c) / 3.0;
        let (centre, radius) = circumcircle(&self.mesh.points, nodes);
        if radius <= limit * REGULAR * here {
            return t + 1;
        }
        let Some(inside) = self.mesh.locate(t as i32, centre) else { return t + 1 };
        let before = self.mesh.trias.len();
        let node = self.mesh.insert(inside, centre);
        self.sizes.push(self.field.spacing_at(centre));
        if self.is_clear(node) {
            return t.min(before);
        }
        if self.mesh.remove(node) {
            self.mesh.points.pop();
            self.mesh.tria_of.pop();
            self.sizes.pop();
        }
        t + 1
    }

    /// Whether an inner node keeps its distance from all around it and from the border.
    fn is_clear(&self, node: usize) -> bool {
        let points = &self.mesh.points;
        let least = FROM_BORDER * self.sizes[node];
        self.mesh.fan(node).all(|(t, k)| {
            let (a, b) = (self.mesh.trias[t][ahead(k)], self.mesh.trias[t][behind(k)]);
            if squared_distance(points, node as i32, a) < least * least {
                return false;
            }
            if self.mesh.neighbours[t][ahead(k)] >= 0 {
                return true;
            }
            let width = squared_distance(points, a, b).sqrt();
            // not `>=`: what is not a number is not too near
            let near = area_to(points, a, b, points[node]) < least * width;
            !near
        })
    }

    /// Move every inner node to the mean of its neighbours.
    fn laplace(&mut self) {
        for node in self.border_nodes..self.mesh.points.len() {
            let (mut x, mut y, mut valence) = (0.0, 0.0, 0.0);
            for (t, k) in self.mesh.fan(node) {
                let other = self.mesh.points[self.mesh.trias[t][ahead(k)] as usize];
                x += other[0];
                y += other[1];
                valence += 1.0;
            }
            let place = self.mesh.points[node];
            move_by(&mut self.mesh, node, [x / valence - place[0], y / valence - place[1]]);
        }
    }
}

/// Move an inner node by a step, or half of it and so on, as far as its trias stay upright.
pub(super) fn move_by(mesh: &mut Triangulation, node: usize, step: Place) {
    let [x, y] = mesh.points[node];
    let [mut dx, mut dy] = step;
    for _ in 0..4 {
        mesh.points[node] = [x + dx, y + dy];
        let is_upright = mesh.fan(node).all(|(t, _)| {
            let [a, b, c] = mesh.trias[t];
            mesh.turn(a, b, c) > 0.0
        });
        if is_upright {
            return;
        }
        (dx, dy) = (0.5 * dx, 0.5 * dy);
    }
    mesh.points[node] = [x, y];
}

/// Centre and radius of the circle through three nodes; radius 0 where they are in line.
fn circumcircle(points: &[Place], [a, b, c]: [i32; 3]) -> (Place, f64) {
    let [a, b, c] = [a, b, c].map(|node| points[node as usize]);
    let (bx, by) = (b[0] - a[0], b[1] - a[1]);
    let (cx, cy) = (c[0] - a[0], c[1] - a[1]);
    let double = 2.0 * (bx * cy - by * cx);
    if double <= 0.0 {
        return (a, 0.0);
    }
    let (b2, c2) = (bx * bx + by * by, cx * cx + cy * cy);
    let (x, y) = ((cy * b2 - by * c2) / double, (bx * c2 - cx * b2) / double);
    ([a[0] + x, a[1] + y], (x * x + y * y).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::meshing::area::tests::square;

    #[test]
    fn the_circle_of_a_right_angle_is_around_the_middle() {
        let points = [[0.0, 0.0], [2.0, 0.0], [0.0, 2.0], [4.0, 0.0]];
        assert_eq!(circumcircle(&points, [0, 1, 2]), ([1.0, 1.0], 2f64.sqrt()));
        assert_eq!(circumcircle(&points, [0, 1, 3]), ([0.0, 0.0], 0.0));
        assert_eq!(REGULAR, 1.0 / 3f64.sqrt());
    }

    #[test]
    fn a_large_square_is_filled() {
        let (points, trias, border) = square(4);
        let area = Area { points: &points, trias: &trias, border: &border };
        let filled = fill_by_refinement(area, 1.0, 100).unwrap();
        assert_eq!(filled.points[..16], points);
        assert!(filled.points.len() > 20);
        assert_eq!(filled.trias.len(), 2 * filled.points.len() - 18);
        assert_eq!(fill_by_refinement(area, 1.0, 1).unwrap().points.len(), 17);
    }
}
