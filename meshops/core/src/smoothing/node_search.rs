//! One node after another looks for a better place; sweeps over all that may move.
//!
//! A node tries the mean of its neighbours (Freitag 1997), or polls eight directions (Hooke and
//! Jeeves, "Direct search" solution of numerical and statistical problems, 1961): no derivative is
//! taken, as Q.I. has kinks and plains. What elements are like is kept, so that the cost of a visit
//! grows with the trials times the elements around the node. Nodes that found nothing search more
//! and more closely until they sleep; one that moves wakes those around it.

use super::optimise::Objective;
use super::project::Target;
use crate::math::{greatest, least};
use crate::mesh::csr::CsrView;
use crate::mesh::validity::corner_on_surface;
use crate::mesh::{Element, centre, following, size_of};
use crate::quality::element_quality::ElementQuality;
use crate::quality::node_score::{ElementGround, Goal, NodeScore, NodeScores};
use crate::vectors::{Vector, add, cross, dot, length, scale, subtract, unit};

/// Sweeps over all nodes, at the most.
const SWEEPS: usize = 16;

/// The first step of the search, of the mean edge at a node.
pub const FIRST_STEP: f64 = 0.25;

/// The step once a neighbour has moved.
const WAKING_STEP: f64 = 0.06;

/// A step below this one is not worth a trial, so that the node sleeps.
const LEAST_STEP: f64 = 0.01;

/// Marks a node that never moves in place of its step.
const HELD: f64 = -1.0;

/// Trials on the way to the mean of the neighbours: each goes half as far as the one before.
const LAPLACE_TRIALS: usize = 3;

/// Square root of a half.
const HALF: f64 = std::f64::consts::FRAC_1_SQRT_2;

/// Where a search polls, by the two tangents at a node.
const DIRECTIONS: [[f64; 2]; 8] = [
    [1.0, 0.0],
    [-1.0, 0.0],
    [0.0, 1.0],
    [0.0, -1.0],
    [HALF, HALF],
    [-HALF, -HALF],
    [-HALF, HALF],
    [HALF, -HALF],
];

/// A mesh whose nodes look for better places.
pub struct NodeSearch<'a> {
    pub points: &'a mut [Vector],
    scores: NodeScores<'a>,
    objective: Objective<'a>,
    /// The step of each node, or [`HELD`].
    pub steps: Vec<f64>,
    /// Of all elements as they are.
    quality: Vec<ElementQuality>,
    /// What all elements lie on.
    under: Vec<ElementGround>,
    /// Quality in the trial at hand, by the row of the element.
    trial: Vec<ElementQuality>,
    /// Quality of the elements around a node at the best place so far, in their order.
    found: Vec<ElementQuality>,
    /// What these elements lie on there.
    found_under: Vec<ElementGround>,
}

/// The surroundings of a node.
struct Frame {
    /// Tangents. The first points along an edge, so that the search turns with the mesh.
    along: Vector,
    across: Vector,
    /// The way to the mean of the neighbours, within the tangent plane.
    to_mean: Vector,
    /// Mean length of the edges.
    edge: f64,
}

impl<'a> NodeSearch<'a> {
    /// Look at all elements; all nodes are held.
    pub fn new(
        points: &'a mut [Vector],
        elements: &'a [Element],
        around: CsrView<'a>,
        objective: &Objective<'a>,
    ) -> Self {
        let Objective { goal, scoring, .. } = *objective;
        let quality: Vec<ElementQuality> =
            elements.iter().map(|element| ElementQuality::of(points, *element, scoring)).collect();
        let under = elements
            .iter()
            .map(|element| {
                let (normal, distance) = match objective.surface {
                    Target::Plane { normal, .. } => (normal, 0.0),
                    Target::Facets(facets) => {
                        let foot = facets.nearest(centre(points, *element));
                        (facets.normal(foot.facet), foot.distance)
                    }
                };
                let corner = corner_on_surface(points, *element, normal);
                let least_corner = least(objective.least_corner, corner);
                ElementGround { normal, distance, least_corner }
            })
            .collect();
        Self {
            steps: vec![HELD; points.len()],
            points,
            scores: NodeScores { elements, around, scoring, goal },
            objective: *objective,
            trial: quality.clone(),
            quality,
            under,
            found: Vec::new(),
            found_under: Vec::new(),
        }
    }

    /// The rows of the elements around a node.
    #[inline]
    pub fn around(&self, node: usize) -> &'a [i32] {
        self.scores.around.list(node)
    }

    /// All elements.
    #[inline]
    pub fn elements(&self) -> &'a [Element] {
        self.scores.elements
    }

    /// Score of a node as it is.
    #[inline]
    pub fn score(&self, node: usize) -> NodeScore {
        self.scores.score(node, &self.quality)
    }

    /// Score of a node in another place, where it is put; rejected where it cannot be better.
    #[inline]
    pub fn try_place(&mut self, node: usize, place: Vector, best: &NodeScore) -> NodeScore {
        self.points[node] = place;
        self.scores.score_trial(
            self.points,
            node,
            best,
            &self.quality,
            &self.under,
            &mut self.trial,
        )
    }

    /// Whether a score is better than another.
    #[inline]
    pub fn is_better(&self, new: &NodeScore, old: &NodeScore) -> bool {
        new.is_better(old, self.scores.goal)
    }

    /// Note the quality of the elements around a node in the last trial.
    #[inline]
    pub fn note(&mut self, node: usize) {
        self.found.clear();
        for row in self.scores.around.list(node) {
            self.found.push(self.trial[*row as usize]);
        }
    }

    /// Sweep over nodes, the worst first, until all sleep.
    ///
    /// `visit` moves a node, by a step of its mean edge, to a better place, whose quality is noted;
    /// or says that it found none.
    pub fn sweep(&mut self, nodes: &[i32], mut visit: impl FnMut(&mut Self, usize, f64) -> bool) {
        let mut order: Vec<(f64, usize)> = Vec::with_capacity(nodes.len());
        for _ in 0..SWEEPS {
            if nodes.iter().all(|node| self.steps[*node as usize] < LEAST_STEP) {
                break;
            }
            order.clear();
            order.extend(
                nodes
                    .iter()
                    .map(|node| *node as usize)
                    .map(|node| (self.score(node).highest, node)),
            );
            // the highest first, and in the order given where they are equal; none is NaN
            order.sort_by(|(one, _), (other, _)| other.total_cmp(one));
            for (_, node) in &order {
                self.visit(*node, &mut visit);
            }
        }
    }

    #[inline]
    fn visit(&mut self, node: usize, visit: &mut impl FnMut(&mut Self, usize, f64) -> bool) {
        let step = self.steps[node];
        if step < LEAST_STEP {
            return;
        }
        let old = self.points[node];
        if !self.around(node).is_empty() && visit(self, node, step) {
            self.keep(node);
            return;
        }
        self.points[node] = old;
        self.steps[node] *= if self.scores.goal == Goal::Laplace { 0.0 } else { 0.5 };
    }

    /// Move a node to a better place on the surface; whether one was found.
    pub fn move_freely(&mut self, node: usize, reach: f64) -> bool {
        let now = self.score(node);
        let found = if self.scores.goal == Goal::Laplace {
            self.relax(node, &now)
        } else {
            now.sum > 0.0 && self.poll(node, reach, &now)
        };
        let (true, Target::Facets(facets)) = (found, self.objective.surface) else {
            return found;
        };
        let place = facets.nearest(self.points[node]).point;
        let score = self.try_place(node, place, &now);
        self.note(node);
        self.is_better(&score, &now) && self.lies_on_surface(node)
    }

    /// Go to the mean of the neighbours, or half or a quarter of the way.
    fn relax(&mut self, node: usize, now: &NodeScore) -> bool {
        let Frame { to_mean: mut step, edge, .. } = self.frame(node);
        let old = self.points[node];
        for _ in 0..LAPLACE_TRIALS {
            if length(step) < LEAST_STEP * edge {
                return false;
            }
            let score = self.try_place(node, add(old, step), now);
            if self.is_better(&score, now) {
                self.note(node);
                return true;
            }
            step = scale(step, 0.5);
        }
        false
    }

    /// Poll eight directions, going on from each better place, then once more all the way.
    fn poll(&mut self, node: usize, reach: f64, now: &NodeScore) -> bool {
        let Frame { along, across, edge, .. } = self.frame(node);
        let old = self.points[node];
        let (mut place, mut best) = (old, *now);
        for [x, y] in DIRECTIONS {
            let (x, y) = (reach * edge * x, reach * edge * y);
            let trial = add(place, add(scale(along, x), scale(across, y)));
            let score = self.try_place(node, trial, &best);
            if self.is_better(&score, &best) {
                (best, place) = (score, trial);
                self.note(node);
            }
        }
        if place == old {
            return false;
        }
        let trial = add(place, subtract(place, old));
        let score = self.try_place(node, trial, &best);
        if self.is_better(&score, &best) {
            place = trial;
            self.note(node);
        }
        self.points[node] = place;
        place != old
    }

    fn frame(&self, node: usize) -> Frame {
        let place = self.points[node];
        let (mut normal, mut total, mut along) = ([0.0; 3], [0.0; 3], [0.0; 3]);
        let (mut edges, mut count) = (0.0, 0);
        for row in self.around(node) {
            let element = self.scores.elements[*row as usize];
            normal = add(normal, self.under[*row as usize].normal);
            for k in 0..size_of(element) {
                if element[k] == node as i32 {
                    // the element's next corner: each edge of a closed fan comes once
                    let other = element[following(element, k)];
                    along = subtract(self.points[other as usize], place);
                    total = add(total, along);
                    edges += length(along);
                    count += 1;
                }
            }
        }
        let normal = unit(normal);
        let along = unit(subtract(along, scale(normal, dot(along, normal))));
        let step = scale(total, 1.0 / f64::from(count));
        let to_mean = subtract(step, scale(normal, dot(step, normal)));
        Frame { along, across: cross(normal, along), to_mean, edge: edges / f64::from(count) }
    }

    /// Whether the elements around a node lie on the surface; if so, notes where.
    pub fn lies_on_surface(&mut self, node: usize) -> bool {
        let Target::Facets(facets) = self.objective.surface else {
            return true;
        };
        self.found_under.clear();
        for row in self.scores.around.list(node) {
            let (element, was) = (self.scores.elements[*row as usize], self.under[*row as usize]);
            let foot = facets.nearest(centre(self.points, element));
            if foot.distance > greatest(self.objective.tolerance, was.distance) {
                return false;
            }
            let normal = facets.normal(foot.facet);
            if corner_on_surface(self.points, element, normal) < was.least_corner {
                return false;
            }
            self.found_under.push(ElementGround { normal, distance: foot.distance, ..was });
        }
        for (row, under) in self.scores.around.list(node).iter().zip(&self.found_under) {
            self.under[*row as usize] = *under;
        }
        true
    }

    /// Make what is noted the quality of the elements around a node, and wake the nodes around it.
    pub fn keep(&mut self, node: usize) {
        for (row, found) in self.scores.around.list(node).iter().zip(&self.found) {
            let row = *row as usize;
            let element = self.scores.elements[row];
            self.quality[row] = *found;
            let corner = corner_on_surface(self.points, element, self.under[row].normal);
            self.under[row].least_corner = least(self.objective.least_corner, corner);
            for other in &element[..size_of(element)] {
                let step = &mut self.steps[*other as usize];
                if *step >= 0.0 {
                    *step = greatest(*step, WAKING_STEP);
                }
            }
        }
    }
}
