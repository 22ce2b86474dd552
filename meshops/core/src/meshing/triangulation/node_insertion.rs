//! Insertion of a node: its tria becomes three, then edges around it are flipped (Lawson 1977).

use super::Triangulation;
use super::plane::Place;

impl Triangulation {
    /// Put a node at a place in a tria, and flip to Delaunay; the row of the node.
    pub fn insert(&mut self, t: usize, place: Place) -> usize {
        let node = self.points.len();
        let ([a, b, c], [ab, bc, ca]) = (self.trias[t], self.neighbours[t]);
        let (u, v) = (self.trias.len(), self.trias.len() + 1);
        self.points.push(place);
        self.tria_of.push(t as i32);
        self.trias.extend([[0; 3]; 2]);
        self.neighbours.extend([[-1; 3]; 2]);
        let apex = node as i32;
        self.set(t, [a, b, apex], [ab, u as i32, v as i32]);
        self.set(u, [b, c, apex], [bc, v as i32, t as i32]);
        self.set(v, [c, a, apex], [ca, t as i32, u as i32]);
        self.relink(bc, c, b, u);
        self.relink(ca, a, c, v);
        self.legalise_around(node);
        node
    }
}
