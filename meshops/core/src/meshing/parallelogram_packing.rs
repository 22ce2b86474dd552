//! Packing of parallelograms: nodes are placed in rows that grow from the border inwards.
//!
//! After Remacle, Henrotte, Carrier Baudouin and others (A frontal Delaunay quad mesh generator
//! using the L-infinity norm, 2013), with the field taken from the border edges. Each node proposes
//! four places, one step away along its cross; those that are free become nodes. The cost grows
//! with the number of nodes times that of border edges.

use std::f64::consts::PI;

use super::area::{Area, Filled};
use super::cross_field::{Cross, CrossField};
use super::triangulation::border_triangulation::border_triangulation;
use super::triangulation::plane::{area_to, squared_distance};
use super::triangulation::{Triangulation, ahead, behind};
use crate::math::{atan2, cos, greatest, modulo, sin};

/// Of the local size: places nearer than this to a node that is there stay free.
pub const APART: f64 = 0.6;

/// Of the local size: the least distance of a node from a border edge.
const FROM_BORDER: f64 = 0.5;

/// A packing on its way.
struct Packing {
    mesh: Triangulation,
    field: CrossField,
    /// Of each node that was placed.
    crosses: Vec<Cross>,
    /// Most nodes that may be placed.
    room: usize,
}

/// Place nodes for quads of an edge length, up to so many, and triangulate.
///
/// None where the area cannot be triangulated on its border.
pub fn pack_parallelograms(area: Area<'_>, size: f64, room: usize) -> Option<Filled> {
    let border_nodes = area.border_nodes();
    let mut packing = Packing {
        mesh: border_triangulation(area.points, area.trias, border_nodes)?,
        field: CrossField::of(area.points, area.border, size),
        crosses: Vec::new(),
        room,
    };
    let loops = BorderLoops::of(area.border, border_nodes);
    for node in loops.order() {
        packing.propose_from_border(loops.behind[node], node, loops.ahead[node]);
    }
    let mut parent = 0;
    while parent < packing.crosses.len() {
        let cross = packing.crosses[parent];
        for quarter in 0..4 {
            let angle = cross.angle + 0.5 * PI * f64::from(quarter);
            packing.propose(border_nodes + parent, angle, cross.spacing);
        }
        parent += 1;
    }
    packing.mesh.legalise();
    Some(Filled { points: packing.mesh.points, trias: packing.mesh.trias })
}

impl Packing {
    /// Divide the angle at a border node evenly into nearly right ones, and go along each ray.
    fn propose_from_border(&mut self, behind: i32, node: usize, ahead: i32) {
        if behind < 0 || ahead < 0 {
            return;
        }
        let points = &self.mesh.points;
        let [x, y] = points[node];
        let angle_to = |other: i32| {
            let place = points[other as usize];
            atan2(place[1] - y, place[0] - x)
        };
        let first = angle_to(ahead);
        let mut opening = modulo(angle_to(behind) - first, 2.0 * PI);
        if opening < 1e-6 {
            // the end of a slit
            opening = 2.0 * PI;
        }
        let parts = (opening / (0.5 * PI) + 0.5) as i32;
        for i in 1..parts {
            let angle = first + opening * f64::from(i) / f64::from(parts);
            let near = 0.5 * self.field.size();
            let step = self.field.spacing_at([x + near * cos(angle), y + near * sin(angle)]);
            self.propose(node, angle, step);
        }
    }

    /// Place a node one step away from its parent, where that is inside and nothing is too near.
    fn propose(&mut self, parent: usize, angle: f64, step: f64) {
        if self.crosses.len() >= self.room {
            return;
        }
        let from = self.mesh.points[parent];
        let place = [from[0] + step * cos(angle), from[1] + step * sin(angle)];
        let Some(t) = self.mesh.locate(self.mesh.tria_of[parent], place) else { return };
        let least = 0.5 * APART * step;
        for corner in self.mesh.trias[t] {
            let [x, y] = self.mesh.points[corner as usize];
            let (dx, dy) = (x - place[0], y - place[1]);
            if dx * dx + dy * dy < least * least {
                return; // most proposals end here, before they cost anything
            }
        }
        let cross = self.field.at(place);
        let node = self.mesh.insert(t, place);
        self.crosses.push(cross);
        if !self.is_free(node, cross) && self.mesh.remove(node) {
            self.mesh.points.pop();
            self.mesh.tria_of.pop();
            self.crosses.pop();
        }
    }

    /// Whether an inner node is far enough from all around it and from the border.
    ///
    /// Distances are measured in the axes of the cross, by the larger coordinate: so the middle of
    /// a square is near to its corners.
    fn is_free(&self, node: usize, cross: Cross) -> bool {
        let points = &self.mesh.points;
        let least = APART * cross.spacing;
        let (cosine, sine) = (cos(cross.angle), sin(cross.angle));
        let place = points[node];
        self.mesh.fan(node).all(|(t, k)| {
            let (a, b) = (self.mesh.trias[t][ahead(k)], self.mesh.trias[t][behind(k)]);
            let (x, y) = (points[a as usize][0] - place[0], points[a as usize][1] - place[1]);
            if greatest((cosine * x + sine * y).abs(), (cosine * y - sine * x).abs()) < least {
                return false;
            }
            if self.mesh.neighbours[t][ahead(k)] >= 0 {
                return true;
            }
            let width = squared_distance(points, a, b).sqrt();
            // not `>=`: what is not a number is not too near
            let near = area_to(points, a, b, place) < FROM_BORDER * cross.spacing * width;
            !near
        })
    }
}

/// The border nodes along their loops.
struct BorderLoops {
    /// The next node of each, -1 for none.
    ahead: Vec<i32>,
    /// The previous node of each, -1 for none.
    behind: Vec<i32>,
}

impl BorderLoops {
    fn of(border: &[[i32; 2]], border_nodes: usize) -> Self {
        let mut loops = Self { ahead: vec![-1; border_nodes], behind: vec![-1; border_nodes] };
        for [a, b] in border {
            loops.ahead[*a as usize] = *b;
            loops.behind[*b as usize] = *a;
        }
        loops
    }

    /// Border nodes in the order of their loops.
    fn order(&self) -> Vec<usize> {
        let count = self.ahead.len();
        let mut order = Vec::with_capacity(count);
        let mut seen = vec![false; count];
        for first in 0..count {
            let mut node = first as i32;
            while node >= 0 && !seen[node as usize] {
                seen[node as usize] = true;
                order.push(node as usize);
                node = self.ahead[node as usize];
            }
        }
        order
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::meshing::area::tests::square;

    #[test]
    fn a_square_is_filled_by_rows() {
        let (points, trias, border) = square(4);
        let area = Area { points: &points, trias: &trias, border: &border };
        let filled = pack_parallelograms(area, 1.0, 100).unwrap();
        assert_eq!(filled.points.len(), 25);
        assert_eq!(filled.trias.len(), 32);
        assert_eq!(pack_parallelograms(area, 1.0, 5).unwrap().points.len(), 21);
    }
}
