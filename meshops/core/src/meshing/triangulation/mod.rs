//! A triangulation of a plane area whose border stays: nodes go in and out, edges flip.
//!
//! No border edge is ever recovered, since none is ever lost: one begins with an older
//! triangulation of the area. It may even lap over itself, or have slits.
//!
//! Kept at all times in one that [`Triangulation::is_consistent`]: the corners of a tria are
//! different nodes, and who looks at a tria across a side is looked at by it. Node `i` and tria `t`
//! are rows; single steps cost the same however large the area is, but for walks to far places.

use crate::mesh::Facet;
use crate::mesh::neighbours::tria_neighbours;

pub mod border_triangulation;
pub mod delaunay;
pub mod node_insertion;
pub mod node_removal;
pub mod plane;

use plane::{Place, area_to};

/// Trias in the plane, counter-clockwise, and what lies across their sides.
#[derive(Clone, Debug)]
pub struct Triangulation {
    /// Places of the nodes.
    pub points: Vec<Place>,
    /// Nodes of each tria.
    pub trias: Vec<Facet>,
    /// The tria across side k, from node k to the next one; -1 on the border.
    pub neighbours: Vec<[i32; 3]>,
    /// A tria at each node; -1 for a node that is not there.
    pub tria_of: Vec<i32>,
}

impl Triangulation {
    /// Take over trias that name none but the given points.
    pub fn new(points: &[Place], trias: &[Facet]) -> Self {
        let mut tria_of = vec![-1; points.len()];
        for (t, tria) in trias.iter().enumerate() {
            for node in tria {
                tria_of[*node as usize] = t as i32;
            }
        }
        let neighbours = tria_neighbours(trias, points.len());
        Self { points: points.to_vec(), trias: trias.to_vec(), neighbours, tria_of }
    }

    /// Whether corners are different nodes, and neighbours look at each other.
    pub fn is_consistent(&self) -> bool {
        (0..self.trias.len()).all(|t| {
            let [a, b, c] = self.trias[t];
            let is_tria = a != b && b != c && c != a;
            is_tria
                && (0..3).all(|k| match self.across(t, k) {
                    Some((other, apex)) => self.neighbours[other][(apex + 1) % 3] == t as i32,
                    None => self.neighbours[t][k] < 0,
                })
        })
    }

    /// Twice the signed area of three nodes.
    #[inline]
    pub fn turn(&self, a: i32, b: i32, c: i32) -> f64 {
        plane::turn(&self.points, a, b, c)
    }

    /// Which corner of a tria a node is.
    #[inline]
    pub fn corner_of(&self, t: usize, node: usize) -> Option<usize> {
        self.trias[t].iter().position(|corner| *corner == node as i32)
    }

    /// The tria across side k of another, and its corner that is not on the side.
    ///
    /// Two trias may share two sides, so the corner is found by the nodes of the side.
    #[inline]
    pub fn across(&self, t: usize, k: usize) -> Option<(usize, usize)> {
        let other = self.neighbours[t][k];
        if other < 0 {
            return None;
        }
        let (a, b) = (self.trias[t][k], self.trias[t][ahead(k)]);
        let nodes = self.trias[other as usize];
        let side = (0..3).find(|side| nodes[*side] == b && nodes[ahead(*side)] == a)?;
        Some((other as usize, behind(side)))
    }

    /// The trias around a node that no border is at, each with the corner that the node is there.
    #[inline]
    pub fn fan(&self, node: usize) -> Fan<'_> {
        let first = self.tria_of[node];
        Fan { mesh: self, node, first, next: first }
    }

    /// Write the corners of a tria and its neighbours across ab, bc and ca.
    fn set(&mut self, t: usize, nodes: Facet, neighbours: [i32; 3]) {
        self.trias[t] = nodes;
        self.neighbours[t] = neighbours;
        for node in nodes {
            self.tria_of[node as usize] = t as i32;
        }
    }

    /// Let a tria, if any, look at `new` across its side from a to b.
    fn relink(&mut self, t: i32, a: i32, b: i32, new: usize) {
        if t >= 0 {
            let nodes = self.trias[t as usize];
            if let Some(k) = (0..3).find(|k| nodes[*k] == a && nodes[ahead(*k)] == b) {
                self.neighbours[t as usize][k] = new as i32;
            }
        }
    }

    /// Turn the edge at side k of a tria, across which lies `other`, to the other diagonal.
    fn flip(&mut self, t: usize, k: usize, other: usize, apex: usize) {
        let nodes = self.trias[t];
        let (a, b, c) = (nodes[k], nodes[ahead(k)], nodes[behind(k)]);
        let d = self.trias[other][apex];
        let (bc, ca) = (self.neighbours[t][ahead(k)], self.neighbours[t][behind(k)]);
        let (db, ad) = (self.neighbours[other][apex], self.neighbours[other][behind(apex)]);
        self.set(t, [a, d, c], [ad, other as i32, ca]);
        self.set(other, [d, b, c], [db, bc, t as i32]);
        self.relink(ad, d, a, t);
        self.relink(bc, c, b, other);
    }

    /// Tria that a place lies in: walk there from a first one, else look at all.
    pub fn locate(&self, start: i32, place: Place) -> Option<usize> {
        let mut t = start;
        for _ in 0..self.trias.len() {
            if t < 0 {
                break;
            }
            let nodes = self.trias[t as usize];
            let (mut out, mut worst) = (None, 0.0);
            for k in 0..3 {
                let area = area_to(&self.points, nodes[k], nodes[ahead(k)], place);
                if -area > worst {
                    (out, worst) = (Some(k), -area);
                }
            }
            let Some(k) = out else { return Some(t as usize) };
            t = self.neighbours[t as usize][k];
        }
        self.trias.iter().position(|nodes| {
            (0..3).all(|k| area_to(&self.points, nodes[k], nodes[ahead(k)], place) >= 0.0)
        })
    }
}

/// The trias around an inner node, see [`Triangulation::fan`].
pub struct Fan<'a> {
    mesh: &'a Triangulation,
    node: usize,
    first: i32,
    next: i32,
}

impl Iterator for Fan<'_> {
    type Item = (usize, usize);

    #[inline]
    fn next(&mut self) -> Option<Self::Item> {
        if self.next < 0 {
            return None;
        }
        let t = self.next as usize;
        let corner = self.mesh.corner_of(t, self.node)?;
        self.next = self.mesh.neighbours[t][behind(corner)];
        if self.next == self.first {
            self.next = -1;
        }
        Some((t, corner))
    }
}

/// The corner of a tria after another one.
#[inline]
pub fn ahead(k: usize) -> usize {
    if k == 2 { 0 } else { k + 1 }
}

/// The corner of a tria before another one.
#[inline]
pub fn behind(k: usize) -> usize {
    if k == 0 { 2 } else { k - 1 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_place_is_found_by_walking() {
        let points = [[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]];
        let mesh = Triangulation::new(&points, &[[0, 1, 2], [0, 2, 3]]);
        assert!(mesh.is_consistent());
        assert_eq!(mesh.locate(0, [0.5, 1.5]), Some(1));
        assert_eq!(mesh.locate(-1, [1.5, 0.5]), Some(0));
        assert_eq!(mesh.locate(0, [3.0, 3.0]), None);
    }

    #[test]
    fn trias_that_lap_over_an_edge_three_times_are_not_consistent() {
        let points = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [0.0, -1.0]];
        assert!(!Triangulation::new(&points, &[[0, 1, 2], [0, 1, 2], [1, 0, 3]]).is_consistent());
        assert!(!Triangulation::new(&points, &[[0, 1, 1]]).is_consistent());
    }
}
