//! Places of border nodes along their border, found together with those of inner nodes.
//!
//! A border is where the mesh that a run began with has it, as segments, so that it does not creep
//! away however often its nodes slide. Inner nodes move as [`super::optimise`] moves them; a border
//! node polls a step to either side. The cost of that grows with the segments.

use super::node_search::{FIRST_STEP, NodeSearch};
use super::optimise::Objective;
use crate::math::{greatest, least};
use crate::mesh::node_elements::elements_of_nodes;
use crate::mesh::{Element, following, size_of};
use crate::quality::node_score::NodeScore;
use crate::vectors::{Vector, add, dot, length, scale, subtract, unit};

/// Parts into which an edge is divided to see whether it follows the border.
const SAMPLES: usize = 4;

/// Curves that nodes slide along.
#[derive(Clone, Copy, Debug)]
pub struct Curves<'a> {
    /// The node before and after each that slides, along its border; elsewhere -1.
    pub neighbours: &'a [[i32; 2]],
    /// What they slide along.
    pub segments: &'a [[Vector; 2]],
    /// How far from that a node and its border edges may be, of its shortest edge.
    pub tolerance: f64,
}

/// The surroundings of a border node.
struct Frame {
    /// Tangent along the border.
    along: Vector,
    /// Its shorter border edge.
    edge: f64,
    /// The shortest edge of the elements around it: that across where a part is narrow.
    shortest: f64,
}

/// Move nodes, those on a border along it, as [`super::optimise::optimise`] moves inner ones.
///
/// Along a border of which each element fails alike, no node can do anything alone: `shift`, of
/// its edges, is what all border nodes beside failing elements do at first.
pub fn slide(
    points: &mut [Vector],
    elements: &[Element],
    nodes: &[i32],
    curves: &Curves<'_>,
    shift: f64,
    objective: &Objective<'_>,
) {
    let around = elements_of_nodes(elements, points.len());
    let mut search = NodeSearch::new(points, elements, around.view(), objective);
    for node in nodes {
        // the others sleep until a neighbour has moved
        let fails = search.score(*node as usize).severity > 0.0;
        search.steps[*node as usize] = if fails { FIRST_STEP } else { 0.0 };
    }
    if shift != 0.0 {
        for node in nodes.iter().map(|node| *node as usize) {
            if search.steps[node] > 0.0 && curves.has(node) {
                let old = search.points[node];
                if curves.shift(&mut search, node, shift) {
                    search.keep(node);
                } else {
                    search.points[node] = old;
                }
            }
        }
    }
    search.sweep(nodes, |search, node, reach| {
        if curves.has(node) {
            curves.slide(search, node, reach)
        } else {
            search.move_freely(node, reach)
        }
    });
}

impl Curves<'_> {
    /// Whether a node slides.
    #[inline]
    fn has(&self, node: usize) -> bool {
        self.neighbours[node][0] >= 0
    }

    /// Move a border node to a better place along its border; whether one was found.
    ///
    /// Polls a step to either side, and once more on from the better one.
    fn slide(&self, search: &mut NodeSearch<'_>, node: usize, reach: f64) -> bool {
        let now = search.score(node);
        let frame = self.frame(search, node);
        let most = self.tolerance * frame.shortest;
        let old = search.points[node];
        let (mut place, mut best) = (old, now);
        for k in 0..3 {
            let trial = match k {
                0 => add(old, scale(frame.along, reach * frame.edge)),
                1 => add(old, scale(frame.along, -(reach * frame.edge))),
                _ if place == old => break,
                _ => add(place, subtract(place, old)),
            };
            let (trial, _) = nearest_on_segments(trial, self.segments);
            let score = search.try_place(node, trial, &best);
            if search.is_better(&score, &best) && self.follows(search.points, node, most) {
                (best, place) = (score, trial);
                search.note(node);
            }
        }
        search.points[node] = place;
        place != old && search.lies_on_surface(node)
    }

    /// Move a border node along its border, be that better or not; whether it may.
    fn shift(&self, search: &mut NodeSearch<'_>, node: usize, shift: f64) -> bool {
        let frame = self.frame(search, node);
        let trial = add(search.points[node], scale(frame.along, shift * frame.edge));
        let (trial, _) = nearest_on_segments(trial, self.segments);
        let score = search.try_place(node, trial, &NodeScore::REJECTED);
        if score.severity == f64::INFINITY {
            return false;
        }
        search.note(node);
        self.follows(search.points, node, self.tolerance * frame.shortest)
            && search.lies_on_surface(node)
    }

    /// Whether a node and its two border edges are nowhere farther than `most` from the segments.
    fn follows(&self, points: &[Vector], node: usize, most: f64) -> bool {
        let place = points[node];
        self.neighbours[node].iter().all(|other| {
            let way = subtract(points[*other as usize], place);
            (0..SAMPLES).all(|k| {
                let sample = add(place, scale(way, k as f64 / SAMPLES as f64));
                let (_, distance) = nearest_on_segments(sample, self.segments);
                // not `<=`: a distance that is NaN is not farther
                let farther = distance > most;
                !farther
            })
        })
    }

    fn frame(&self, search: &NodeSearch<'_>, node: usize) -> Frame {
        let points = &*search.points;
        let place = points[node];
        let [before, after] = self.neighbours[node].map(|other| points[other as usize]);
        let edge = least(length(subtract(place, before)), length(subtract(after, place)));
        let mut shortest = edge;
        for row in search.around(node) {
            let element = search.elements()[*row as usize];
            for k in 0..size_of(element) {
                let ends = [element[k], element[following(element, k)]];
                if ends.contains(&(node as i32)) {
                    let [start, end] = ends.map(|end| points[end as usize]);
                    shortest = least(shortest, length(subtract(end, start)));
                }
            }
        }
        Frame { along: unit(subtract(after, before)), edge, shortest }
    }
}

/// Nearest point of some segments to a place, and its distance; infinite where there is none.
pub fn nearest_on_segments(place: Vector, segments: &[[Vector; 2]]) -> (Vector, f64) {
    let (mut best, mut found) = (f64::INFINITY, place);
    for [start, end] in segments {
        let way = subtract(*end, *start);
        let square = dot(way, way);
        let along = if square > 0.0 { dot(subtract(place, *start), way) / square } else { 0.0 };
        let point = add(*start, scale(way, least(greatest(along, 0.0), 1.0)));
        let off = subtract(point, place);
        let squared = dot(off, off);
        if squared < best {
            (best, found) = (squared, point);
        }
    }
    (found, best.sqrt())
}
