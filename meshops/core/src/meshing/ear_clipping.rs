//! Triangulating a polygon with holes by clipping ears (Meisters, Polygons have ears, 1975; holes
//! as in Eberly, Triangulation by ear clipping, 1998).
//!
//! Each hole is joined to the outer loop by the shortest bridge from its rightmost point, the holes
//! from right to left. Then the ear of the best shape is clipped, again and again. The cost is the
//! cube of the number of points at worst.

use super::triangulation::plane::{Place, area_to, squared_distance, turn};
use crate::math::{greatest, least, least_of};
use crate::mesh::Facet;
use crate::mesh::csr::CsrView;

/// Signed areas of closed loops of points.
///
/// Loop `i` has the points `start[i]..start[i + 1]`; `start` ascends and ends within the points.
pub fn loop_areas(points: &[Place], start: &[i32]) -> Vec<f64> {
    let area_of = |ends: &[i32]| {
        let mut area = 0.0;
        for j in ends[0] + 2..ends[1] {
            area += 0.5 * turn(points, ends[0], j - 1, j);
        }
        area
    };
    start.windows(2).map(area_of).collect()
}

/// Triangulate the area within closed loops; none where the loops do not bound an area.
///
/// Loop `i` has the points `start[i]..start[i + 1]`: one runs counter-clockwise around the area,
/// all others clockwise around a hole in it. `start` ascends and ends within the points.
pub fn clip_ears(points: &[Place], start: &[i32]) -> Option<Vec<Facet>> {
    let areas = loop_areas(points, start);
    let outer = areas.iter().position(|area| *area > 0.0)?;
    let others_are_holes = areas.iter().enumerate().all(|(i, area)| i == outer || *area < 0.0);
    if !others_are_holes {
        return None;
    }
    let items: Vec<i32> = (0..points.len() as i32).collect();
    let loops = CsrView { start, items: &items };
    let mut polygon = Polygon {
        points,
        loops,
        ring: loops.list(outer).to_vec(),
        joined: vec![false; areas.len()],
    };
    polygon.joined[outer] = true;
    for hole in from_right_to_left(points, loops) {
        if hole != outer && !polygon.join_hole(hole) {
            return None;
        }
    }
    polygon.clip()
}

/// Loops by their rightmost point; of equals the first.
fn from_right_to_left(points: &[Place], loops: CsrView<'_>) -> Vec<usize> {
    let reach = |i: usize| {
        let xs = loops.list(i).iter().map(|node| points[*node as usize][0]);
        // adding 0 makes the two zeros one
        xs.fold(f64::NEG_INFINITY, greatest) + 0.0
    };
    let mut order: Vec<(usize, f64)> = (0..loops.len()).map(|i| (i, reach(i))).collect();
    order.sort_by(|a, b| b.1.total_cmp(&a.1));
    order.into_iter().map(|(i, _)| i).collect()
}

/// An area that is being triangulated.
struct Polygon<'a> {
    points: &'a [Place],
    loops: CsrView<'a>,
    /// Its border as one ring, counter-clockwise; a node comes twice at a bridge.
    ring: Vec<i32>,
    /// Which loops are part of the ring.
    joined: Vec<bool>,
}

impl Polygon<'_> {
    /// The nodes before, at and after a place of the ring.
    #[inline]
    fn corner(&self, i: usize) -> [i32; 3] {
        let last = self.ring.len() - 1;
        let before = self.ring[if i == 0 { last } else { i - 1 }];
        let after = self.ring[if i == last { 0 } else { i + 1 }];
        [before, self.ring[i], after]
    }

    /// Join a hole to the ring by the shortest bridge from its rightmost point.
    ///
    /// False where no point of the ring can be seen from there.
    fn join_hole(&mut self, hole: usize) -> bool {
        let nodes = self.loops.list(hole);
        let x = |node: i32| self.points[node as usize][0];
        let mut rightmost = 0;
        for i in 0..nodes.len() {
            if x(nodes[i]) > x(nodes[rightmost]) {
                rightmost = i;
            }
        }
        let tip = nodes[rightmost];
        let (mut at, mut nearest) = (None, f64::INFINITY);
        for i in 0..self.ring.len() {
            let distance = squared_distance(self.points, tip, self.ring[i]);
            let near = distance < nearest;
            if near && self.opens_to(i, tip) && self.sees(tip, self.ring[i]) {
                (at, nearest) = (Some(i), distance);
            }
        }
        let Some(at) = at else { return false };
        // there, around the hole, back to the tip, and back again
        let around = nodes[rightmost..].iter().chain(&nodes[..rightmost]).copied();
        let bridge: Vec<i32> = around.chain([tip, self.ring[at]]).collect();
        self.ring.splice(at + 1..at + 1, bridge);
        self.joined[hole] = true;
        true
    }

    /// Whether the direction to a target lies inside the angle of the ring at a place.
    fn opens_to(&self, i: usize, target: i32) -> bool {
        let [before, node, after] = self.corner(i);
        let left = turn(self.points, before, node, target) > 0.0;
        let right = turn(self.points, node, after, target) > 0.0;
        if turn(self.points, before, node, after) > 0.0 { left && right } else { left || right }
    }

    /// Whether no edge of the ring or of a hole that is not yet part of it lies between two nodes.
    fn sees(&self, a: i32, b: i32) -> bool {
        let others = (0..self.loops.len()).filter(|i| !self.joined[*i]);
        let mut rings = std::iter::once(&self.ring[..]).chain(others.map(|i| self.loops.list(i)));
        !rings.any(|ring| {
            (0..ring.len()).any(|i| {
                let (c, d) = (ring[i], ring[if i + 1 < ring.len() { i + 1 } else { 0 }]);
                c != a && c != b && d != a && d != b && crosses(self.points, [a, b], [c, d])
            })
        })
    }

    /// Clip ears until three nodes are left.
    fn clip(mut self) -> Option<Vec<Facet>> {
        let mut trias = Vec::with_capacity(self.ring.len());
        while self.ring.len() > 3 {
            let (mut best, mut at) = (0.0, None);
            for i in 0..self.ring.len() {
                let shape = self.shape(self.corner(i));
                if shape > best && self.is_ear(self.corner(i)) {
                    (best, at) = (shape, Some(i));
                }
            }
            let at = at?;
            trias.push(self.corner(at));
            self.ring.remove(at);
        }
        let last = [self.ring[0], self.ring[1], self.ring[2]];
        trias.push(last);
        (turn(self.points, last[0], last[1], last[2]) > 0.0).then_some(trias)
    }

    /// Area of a corner over its squared sides.
    fn shape(&self, [a, b, c]: [i32; 3]) -> f64 {
        let sides = squared_distance(self.points, a, c)
            + squared_distance(self.points, a, b)
            + squared_distance(self.points, b, c);
        if sides > 0.0 { turn(self.points, a, b, c) / sides } else { 0.0 }
    }

    /// Whether a corner can be clipped: it is convex and holds no other corner.
    fn is_ear(&self, [a, b, c]: [i32; 3]) -> bool {
        let points = self.points;
        turn(points, a, b, c) > 0.0
            && !self.ring.iter().any(|p| {
                // a node may come twice: at a bridge, or where the border touches itself
                let nearest = least_of([a, b, c].map(|node| squared_distance(points, *p, node)));
                let place = points[*p as usize];
                nearest != 0.0
                    && area_to(points, a, b, place) >= 0.0
                    && area_to(points, b, c, place) >= 0.0
                    && area_to(points, c, a, place) >= 0.0
            })
    }
}

/// Whether two segments, which share no end, have a point in common.
fn crosses(points: &[Place], [a, b]: [i32; 2], [c, d]: [i32; 2]) -> bool {
    let (ab_c, ab_d) = (turn(points, a, b, c), turn(points, a, b, d));
    let (cd_a, cd_b) = (turn(points, c, d, a), turn(points, c, d, b));
    greatest(ab_c, ab_d) >= 0.0
        && least(ab_c, ab_d) <= 0.0
        && greatest(cd_a, cd_b) >= 0.0
        && least(cd_a, cd_b) <= 0.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_square_with_a_hole_has_eight_trias() {
        let outer = [[0.0, 0.0], [3.0, 0.0], [3.0, 3.0], [0.0, 3.0]];
        let hole = [[1.0, 1.0], [1.0, 2.0], [2.0, 2.0], [2.0, 1.0]];
        let points = [outer, hole].concat();
        assert_eq!(loop_areas(&points, &[0, 4, 8]), [9.0, -1.0]);
        let trias = clip_ears(&points, &[0, 4, 8]).unwrap();
        assert_eq!(trias.len(), 8);
        let area: f64 = trias.iter().map(|[a, b, c]| 0.5 * turn(&points, *a, *b, *c)).sum();
        assert_eq!(area, 8.0);
    }

    #[test]
    fn loops_that_bound_no_area_have_none() {
        let points = [[0.0, 0.0], [0.0, 1.0], [1.0, 1.0]];
        assert!(clip_ears(&points, &[0, 3]).is_none());
        assert!(clip_ears(&points, &[0]).is_none());
    }
}
