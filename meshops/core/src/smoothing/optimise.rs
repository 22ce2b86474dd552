//! Places of nodes that make the elements around them better, found by a local pattern search.
//!
//! See `node_search` for the search and its sources. No element is turned over, gets a corner below
//! the least or leaves the surface; none that does already gets worse. Of the elements around a node
//! that moves no more fail than before, and their highest Q.I. does not rise, but for
//! [`Goal::Even`], which lowers their sum. The cost grows with the number of nodes that move, as
//! those that find nothing soon sleep.

use super::node_search::{FIRST_STEP, NodeSearch};
use super::project::Target;
use crate::mesh::Element;
use crate::mesh::node_elements::elements_of_nodes;
use crate::quality::Scoring;
use crate::quality::node_score::Goal;
use crate::vectors::Vector;

/// What nodes move for, and what they must keep.
#[derive(Clone, Copy, Debug)]
pub struct Objective<'a> {
    /// What they move for.
    pub goal: Goal,
    /// The surface that they stay on.
    pub surface: Target<'a>,
    /// How far from it the centre of an element may be.
    pub tolerance: f64,
    /// The worst corner that an element may get.
    pub least_corner: f64,
    /// The criteria.
    pub scoring: &'a Scoring,
}

/// Move nodes to places where the elements around them are better.
///
/// The mesh may be the part of another that is all elements around these nodes. They close around
/// each of them.
pub fn optimise(
    points: &mut [Vector],
    elements: &[Element],
    nodes: &[i32],
    objective: &Objective<'_>,
) {
    let around = elements_of_nodes(elements, points.len());
    let mut search = NodeSearch::new(points, elements, around.view(), objective);
    for node in nodes {
        search.steps[*node as usize] = FIRST_STEP;
    }
    search.sweep(nodes, NodeSearch::move_freely);
}
