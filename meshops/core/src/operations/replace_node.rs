//! ReplaceNode: merging pairs of nodes, for many choices of pairs at once.
//!
//! A pair of nodes becomes one, at the place of one of them or half-way (section 3.1 of the paper).
//! A choice is scored by the elements around the nodes that vanish or move, so the cost grows with
//! these alone; the scratch grows with the mesh, but is made once.
//!
//! The mesh is taken to be sound where it is not touched. What merging would invert, tear or join
//! to itself is refused.

use super::merging::{merged_element, without_doubles};
use crate::mesh::valence::Valences;
use crate::mesh::validity::{FACING, unit_normal};
use crate::mesh::{Element, is_tria, size_of};
use crate::quality::{CRITERIA, ElementSums, QualitySums, Scoring};
use crate::vectors::{Vector, corner_jacobian_min, dot};

/// `corner_jacobian_min` from which a merged element counts as sound.
pub const LEAST_CORNER: f64 = 0.02;

/// Neighbours of a merged node, two for each of its elements; no pair with more is merged.
const MOST_NEIGHBOURS: usize = 128;

/// A pair of nodes that may be merged.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NodePair {
    /// The node that vanishes.
    pub goes: i32,
    /// The node that stays.
    pub stays: i32,
    /// Whether they meet half-way, or at the one that stays.
    pub half_way: bool,
    /// Whether the edge between them is on the border.
    pub on_border: bool,
}

/// A mesh whose nodes may be merged, and how good it is.
#[derive(Clone, Copy, Debug)]
pub struct MergeSite<'a> {
    /// Places.
    pub points: &'a [Vector],
    /// The elements, those around each node, and those that are not of the mesh.
    pub valences: Valences<'a>,
    /// Unit normals of the elements.
    pub normals: &'a [Vector],
    /// Measures of the elements.
    pub measures: &'a [[f64; CRITERIA]],
    /// The sums of the whole mesh.
    pub sums: &'a QualitySums,
    /// The criteria; none: elements are counted and not measured.
    pub scoring: Option<&'a Scoring>,
}

/// Scratch for choices of pairs on one mesh.
pub struct MergeEvaluator<'a> {
    site: MergeSite<'a>,
    pool: &'a [NodePair],
    /// Places with the pairs at hand merged; as they were between choices.
    points: Vec<Vector>,
    /// Where each node goes; itself between choices.
    target: Vec<i32>,
    /// The choice that last named a node, and that last touched an element.
    node_seen: Vec<u32>,
    element_seen: Vec<u32>,
    choice: u32,
    /// Elements around the nodes of the choice at hand, and what they are after merging.
    touched: Vec<i32>,
    merged: Vec<Option<Element>>,
    comes: Vec<Element>,
    /// What each element adds to the sums of the mesh.
    of_elements: Option<ElementSums<'a>>,
    counts: Vec<i32>,
    before: Vec<i32>,
    after: Vec<i32>,
}

impl<'a> MergeEvaluator<'a> {
    /// Make ready for choices out of a pool.
    pub fn new(site: MergeSite<'a>, pool: &'a [NodePair]) -> Self {
        let (nodes, elements) = (site.points.len(), site.valences.elements);
        let of_elements =
            site.scoring.map(|scoring| ElementSums::new(elements, site.measures, scoring));
        Self {
            site,
            pool,
            points: site.points.to_vec(),
            target: (0..nodes as i32).collect(),
            node_seen: vec![0; nodes],
            element_seen: vec![0; elements.len()],
            choice: 0,
            touched: Vec::new(),
            merged: Vec::new(),
            comes: Vec::new(),
            of_elements,
            counts: vec![0; nodes],
            before: Vec::new(),
            after: Vec::new(),
        }
    }

    /// Sums of the mesh after merging the pairs of a genome, rows of the pool, all at once.
    ///
    /// A row beyond the pool merges nothing. None where two pairs share a node, or where merging
    /// would invert an element, tear the mesh or join it to itself.
    pub fn evaluate(&mut self, genome: &[i64]) -> Option<QualitySums> {
        let pool = self.pool;
        let chosen = move || {
            genome.iter().filter_map(move |gene| pool.get(usize::try_from(*gene).ok()?).copied())
        };
        self.choice += 1;
        for pair in chosen() {
            for node in [pair.goes, pair.stays] {
                if self.node_seen[node as usize] == self.choice {
                    return None;
                }
            }
            for node in [pair.goes, pair.stays] {
                self.node_seen[node as usize] = self.choice;
            }
        }
        self.touched.clear();
        for pair in chosen() {
            self.merge(pair);
        }
        let keeps_shape = self.merge_elements(chosen());
        let is_valid = keeps_shape && chosen().all(|pair| self.is_manifold(pair));
        let sums = if is_valid { Some(self.sums()) } else { None };
        for pair in chosen() {
            self.target[pair.goes as usize] = pair.goes;
            self.points[pair.stays as usize] = self.site.points[pair.stays as usize];
        }
        sums
    }

    /// Merge one pair, and list the elements that this touches.
    fn merge(&mut self, pair: NodePair) {
        let (goes, stays) = (pair.goes as usize, pair.stays as usize);
        self.target[goes] = pair.stays;
        for node in &[goes, stays][..1 + usize::from(pair.half_way)] {
            for row in self.site.valences.around.list(*node) {
                let seen = &mut self.element_seen[*row as usize];
                if *seen != self.choice {
                    *seen = self.choice;
                    self.touched.push(*row);
                }
            }
        }
        if pair.half_way {
            for k in 0..3 {
                self.points[stays][k] = 0.5 * (self.points[goes][k] + self.points[stays][k]);
            }
        }
    }

    /// Merge the touched elements; whether they are sound and the surface stays what it was.
    fn merge_elements(&mut self, chosen: impl Iterator<Item = NodePair>) -> bool {
        // twice the change of nodes - edges + elements
        let mut euler = 0;
        for pair in chosen {
            euler -= 2 - i64::from(pair.on_border);
        }
        self.merged.clear();
        for row in &self.touched {
            let element = self.site.valences.elements[*row as usize];
            let after = merged_element(element, &self.target);
            self.merged.push(after);
            match after {
                Some(after) => euler += size_of(element) as i64 - size_of(after) as i64,
                None => euler += size_of(element) as i64 - 2,
            }
        }
        euler == 0 && self.all_sound()
    }

    /// Whether what is left of the touched elements has sound corners and faces the way it did.
    fn all_sound(&self) -> bool {
        for (row, after) in self.touched.iter().zip(&self.merged) {
            let Some(after) = *after else { continue };
            let normal = unit_normal(&self.points, after);
            // what is NaN counts as sound here, and fails the criteria
            if dot(normal, self.site.normals[*row as usize]) < FACING
                || corner_jacobian_min(&self.points, after, normal) < LEAST_CORNER
            {
                return false;
            }
        }
        true
    }

    /// Sums of the mesh with the merged elements for the touched ones.
    fn sums(&mut self) -> QualitySums {
        let Valences { elements, .. } = self.site.valences;
        let mut sums = *self.site.sums;
        self.comes.clear();
        for (row, after) in self.touched.iter().zip(&self.merged) {
            match &mut self.of_elements {
                Some(of_elements) => sums.take_away(of_elements.get(*row)),
                None => count(&mut sums, is_tria(elements[*row as usize]), -1.0),
            }
            let Some(after) = *after else { continue };
            self.comes.push(after);
            match self.site.scoring {
                Some(scoring) => sums.add_element(&self.points, after, 1.0, scoring),
                None => count(&mut sums, is_tria(after), 1.0),
            }
        }
        if self.site.scoring.is_some() {
            let valences = &self.site.valences;
            let change = valences.irregular_change(&self.touched, &self.comes, &mut self.counts);
            sums.irregular += change as f64;
        }
        sums
    }

    /// Whether the edges at a merged node have as many elements as they may have.
    ///
    /// That is two for an edge that was not there, and for any other at most as many as it had.
    fn is_manifold(&mut self, pair: NodePair) -> bool {
        let Valences { elements, around, .. } = self.site.valences;
        let (goes, stays) = (pair.goes, pair.stays);
        self.before.clear();
        self.after.clear();
        for row in around.list(stays as usize) {
            let element = elements[*row as usize];
            if let Some(element) = without_doubles(element) {
                push_neighbours(element, stays, &mut self.before);
            }
            if let Some(element) = merged_element(element, &self.target) {
                push_neighbours(element, stays, &mut self.after);
            }
        }
        for row in around.list(goes as usize) {
            let element = elements[*row as usize];
            if element.contains(&stays) {
                continue;
            }
            if let Some(element) = merged_element(element, &self.target) {
                push_neighbours(element, stays, &mut self.after);
            }
        }
        if self.before.len().max(self.after.len()) > MOST_NEIGHBOURS {
            return false;
        }
        let uses_of = |node: i32, found: &[i32]| found.iter().filter(|one| **one == node).count();
        self.after.iter().all(|node| {
            let had = uses_of(*node, &self.before);
            uses_of(*node, &self.after) <= if had == 0 { 2 } else { had }
        })
    }
}

/// Append the two neighbours that a node has in an element.
#[inline]
fn push_neighbours(element: Element, node: i32, found: &mut Vec<i32>) {
    let size = size_of(element);
    if let Some(k) = element[..size].iter().position(|other| *other == node) {
        found.push(element[(k + 1) % size]);
        found.push(element[(k + size - 1) % size]);
    }
}

/// Count an element without measuring it.
#[inline]
fn count(sums: &mut QualitySums, is_tria: bool, sign: f64) {
    sums.elements += sign;
    if is_tria {
        sums.trias += sign;
    } else {
        sums.quads += sign;
    }
}
