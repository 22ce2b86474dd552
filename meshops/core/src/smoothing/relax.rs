//! Relaxation: the nodes of each of many small edits move to where its elements are better.
//!
//! New elements of another shape need another place for their nodes: without that, few changes of
//! the topology are worth it. The new points, the moved nodes and the free nodes of the elements
//! that come are smoothed ([`super::laplace`], Freitag 1997), each candidate on its own, so that
//! the cost grows with the elements around these nodes; and once with the nodes of the mesh.

use super::laplace::Laplace;
use crate::mesh::Element;
use crate::mesh::csr::CsrView;
use crate::operations::candidates::{Candidate, Candidates};
use crate::vectors::Vector;

/// The mesh that candidates are edits of, and how far each is relaxed.
#[derive(Clone, Copy, Debug)]
pub struct Relaxation<'a> {
    /// Places of nodes.
    pub points: &'a [Vector],
    /// Elements.
    pub elements: &'a [Element],
    /// Those around each node.
    pub around: CsrView<'a>,
    /// Which nodes may move.
    pub free: &'a [bool],
    /// A candidate that moves nodes of more elements than this stays as it is.
    pub most_elements: usize,
    /// Sweeps over its nodes.
    pub sweeps: usize,
}

/// Candidates after relaxation; what they remove and add stays.
#[derive(Clone, Debug, PartialEq)]
pub struct Relaxed {
    /// New points.
    pub points: Vec<Vector>,
    /// Where the nodes that get another place start.
    pub moved_start: Vec<i32>,
    /// Nodes that get another place.
    pub moved: Vec<i32>,
    /// Their places.
    pub moved_to: Vec<Vector>,
}

/// Rows are marked by the number of the last candidate that saw them; this one saw none.
const NEVER: i32 = -1;

/// What is used again for each candidate.
struct Scratch {
    /// Places of nodes and, behind them, of the candidate's new points.
    places: Vec<Vector>,
    /// The last candidate that removed an element, and that gathered it.
    gone: Vec<i32>,
    seen: Vec<i32>,
    /// The last candidate that chose a node to move, and that numbered it.
    chosen: Vec<i32>,
    numbered: Vec<i32>,
    /// The number of each node within a candidate.
    rows: Vec<i32>,
    /// Nodes that move: those of the mesh first, then new points.
    mobile: Vec<i32>,
    /// The elements around them, by mesh rows and then by numbers.
    local: Vec<Element>,
    /// The mesh row of each number.
    nodes: Vec<i32>,
    /// Its place.
    points: Vec<Vector>,
    laplace: Laplace,
}

impl Relaxation<'_> {
    /// Smooth the nodes around each candidate.
    ///
    /// Its elements name nodes of the mesh and its own points only.
    pub fn relax(&self, candidates: Candidates<'_>) -> Relaxed {
        let nodes = self.points.len();
        let mut scratch = Scratch::of(self, candidates.most_points());
        let mut relaxed = Relaxed {
            points: candidates.points.to_vec(),
            moved_start: vec![0],
            moved: Vec::new(),
            moved_to: Vec::new(),
        };
        for (k, candidate) in candidates.iter().enumerate() {
            let of_mesh = self.choose(k as i32, candidate, &mut scratch);
            if self.gather(k as i32, candidate, &mut scratch) {
                self.smooth(k as i32, &mut scratch);
            }
            for node in &scratch.mobile[..of_mesh] {
                let place = &mut scratch.places[*node as usize];
                relaxed.moved.push(*node);
                relaxed.moved_to.push(*place);
                *place = self.points[*node as usize];
            }
            let first = candidates.point_start[k] as usize;
            let own = &scratch.places[nodes..nodes + candidate.points.len()];
            relaxed.points[first..first + own.len()].copy_from_slice(own);
            relaxed.moved_start.push(relaxed.moved.len() as i32);
        }
        relaxed
    }

    /// Find the nodes that move, and place them; how many of them are of the mesh.
    fn choose(&self, k: i32, candidate: Candidate<'_>, scratch: &mut Scratch) -> usize {
        let nodes = self.points.len();
        let Scratch { places, gone, chosen, mobile, .. } = scratch;
        let own = candidate.points.len();
        places[nodes..nodes + own].copy_from_slice(candidate.points);
        for row in candidate.removed {
            gone[*row as usize] = k;
        }
        mobile.clear();
        for (node, place) in candidate.moved.iter().zip(candidate.moved_to) {
            places[*node as usize] = *place;
            chosen[*node as usize] = k;
            mobile.push(*node);
        }
        for node in candidate.added.as_flattened() {
            let row = *node as usize;
            if *node >= 0 && row < nodes && self.free[row] && chosen[row] != k {
                chosen[row] = k;
                mobile.push(*node);
            }
        }
        let of_mesh = mobile.len();
        mobile.extend((nodes..nodes + own).map(|row| row as i32));
        of_mesh
    }

    /// Find the elements around the nodes that move, as they are after the edit.
    ///
    /// Whether there are not too many.
    fn gather(&self, k: i32, candidate: Candidate<'_>, scratch: &mut Scratch) -> bool {
        let Scratch { gone, seen, mobile, local, .. } = scratch;
        local.clear();
        local.extend(candidate.added);
        for node in
            mobile.iter().map(|node| *node as usize).filter(|node| *node < self.around.len())
        {
            for row in self.around.list(node).iter().map(|row| *row as usize) {
                if gone[row] != k && seen[row] != k {
                    seen[row] = k;
                    local.push(self.elements[row]);
                }
            }
            if local.len() > self.most_elements {
                return false;
            }
        }
        local.len() <= self.most_elements
    }

    /// Smooth the nodes that move.
    fn smooth(&self, k: i32, scratch: &mut Scratch) {
        let fixed = scratch.number(k);
        let Scratch { places, local, nodes, points, laplace, .. } = scratch;
        points.clear();
        points.extend(nodes.iter().map(|node| places[*node as usize]));
        laplace.smooth(points, local, fixed, self.sweeps);
        for (node, place) in nodes.iter().zip(points).skip(fixed) {
            places[*node as usize] = *place;
        }
    }
}

impl Scratch {
    fn of(relaxation: &Relaxation<'_>, most_points: usize) -> Self {
        let (nodes, elements) = (relaxation.points.len(), relaxation.elements.len());
        let mut places = relaxation.points.to_vec();
        places.resize(nodes + most_points, [0.0; 3]);
        Self {
            places,
            gone: vec![NEVER; elements],
            seen: vec![NEVER; elements],
            chosen: vec![NEVER; nodes],
            numbered: vec![NEVER; nodes + most_points],
            rows: vec![0; nodes + most_points],
            mobile: Vec::new(),
            local: Vec::new(),
            nodes: Vec::new(),
            points: Vec::new(),
            laplace: Laplace::default(),
        }
    }

    /// Renumber the nodes of the local elements, those that move last; how many stay in place.
    fn number(&mut self, k: i32) -> usize {
        let Self { numbered, rows, mobile, local, nodes, .. } = self;
        for node in mobile.iter() {
            numbered[*node as usize] = k;
        }
        nodes.clear();
        for node in local.as_flattened().iter().filter(|node| **node >= 0) {
            let row = *node as usize;
            if numbered[row] != k {
                numbered[row] = k;
                rows[row] = nodes.len() as i32;
                nodes.push(*node);
            }
        }
        let fixed = nodes.len();
        for node in mobile.iter() {
            rows[*node as usize] = nodes.len() as i32;
            nodes.push(*node);
        }
        for node in local.as_flattened_mut().iter_mut().filter(|node| **node >= 0) {
            *node = rows[*node as usize];
        }
        fixed
    }
}
