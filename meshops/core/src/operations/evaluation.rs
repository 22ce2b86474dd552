//! Candidate evaluation: whether each small edit leaves a mesh valid, and how good it is then.
//!
//! First the cavity is looked at, places left aside; then whether all elements that come or whose
//! nodes move are sound, and whether new places are on the surface; then what they add to the
//! quality sums. A candidate is seen on its own: the mesh is as it was before the next one.
//!
//! The cost grows with the elements that a candidate touches; scratch grows with the mesh, but is
//! made once.

use super::candidates::{Candidate, Candidates};
use super::cavity::{CavityChecker, CavityMesh};
use crate::math::least;
use crate::mesh::valence::Valences;
use crate::mesh::validity::{FACING, unit_normal};
use crate::mesh::{Element, is_tria, size_of};
use crate::quality::{CRITERIA, ElementSums, QualitySums, Scoring};
use crate::surface::FacetTree;
use crate::vectors::{Vector, add, area_vector, corner_jacobian_min, dot, length, subtract, unit};

/// `corner_jacobian_min` from which a new element counts as sound.
///
/// One that was worse before may stay so where only its nodes move, but may not get worse still.
const LEAST_CORNER: f64 = 0.04;

/// How far a new place, or the centre of a new element, may be from the surface.
#[derive(Clone, Copy, Debug)]
pub enum SurfaceBound<'a> {
    /// A plane.
    Plane {
        /// A point of it.
        origin: Vector,
        /// Its unit normal.
        normal: Vector,
        /// The distance that places may have.
        tolerance: f64,
    },
    /// Facets.
    Facets {
        /// They.
        facets: &'a FacetTree,
        /// The distance over the edge length of the elements there.
        tolerance: f64,
    },
}

/// A mesh that candidates are of, and how good it is.
#[derive(Clone, Copy, Debug)]
pub struct EvaluationMesh<'a> {
    /// Places.
    pub points: &'a [Vector],
    /// The elements and how they are joined.
    pub cavity: CavityMesh<'a>,
    /// Elements at each node that are not of the mesh, -1 where any number may be.
    pub outside: &'a [i32],
    /// Measures of the elements as they are.
    pub measures: &'a [[f64; CRITERIA]],
    /// The sums of the whole mesh.
    pub sums: &'a QualitySums,
    /// The criteria.
    pub scoring: &'a Scoring,
    /// What the mesh lies on.
    pub surface: SurfaceBound<'a>,
}

/// Sums of the mesh after each candidate alone.
///
/// None for a candidate that does nothing, or that would not leave the mesh whole, its new elements
/// sound and its new places on the surface.
pub fn evaluate_candidates(
    mesh: &EvaluationMesh<'_>,
    candidates: Candidates<'_>,
) -> Vec<Option<QualitySums>> {
    let mut evaluator = Evaluator::new(*mesh, candidates.most_points());
    candidates.iter().map(|candidate| evaluator.evaluate(&candidate)).collect()
}

/// An element as it is before the edit.
#[derive(Clone, Copy, Debug)]
struct Known {
    area: Vector,
    size: f64,
    corner: f64,
}

/// Scratch for candidates of one mesh.
struct Evaluator<'a> {
    mesh: EvaluationMesh<'a>,
    cavity: CavityChecker<'a>,
    /// Places with the candidate at hand done, its new points last.
    places: Vec<Vector>,
    /// Number of the candidate at hand, from 1, and the one that last moved a node of an element.
    candidate: u32,
    seen: Vec<u32>,
    /// Elements that stay and have a node that moves.
    affected: Vec<i32>,
    /// What elements are like, as far as it was asked for, and where each one is there, from 1.
    known: Vec<Known>,
    known_at: Vec<u32>,
    /// What each element adds to the sums of the mesh.
    of_elements: ElementSums<'a>,
    counts: Vec<i32>,
}

impl<'a> Evaluator<'a> {
    /// Make ready for candidates that have up to so many new points.
    fn new(mesh: EvaluationMesh<'a>, most_points: usize) -> Self {
        let (nodes, elements) = (mesh.points.len(), mesh.cavity.elements.len());
        let mut places = Vec::with_capacity(nodes + most_points);
        places.extend_from_slice(mesh.points);
        Self {
            mesh,
            cavity: CavityChecker::new(mesh.cavity, most_points),
            places,
            candidate: 0,
            seen: vec![0; elements],
            affected: Vec::new(),
            known: Vec::new(),
            known_at: vec![0; elements],
            of_elements: ElementSums::new(mesh.cavity.elements, mesh.measures, mesh.scoring),
            counts: vec![0; nodes + most_points],
        }
    }

    /// Sums of the mesh after one candidate; none where that is not valid.
    fn evaluate(&mut self, candidate: &Candidate<'_>) -> Option<QualitySums> {
        if !self.cavity.is_whole(candidate) {
            return None;
        }
        self.move_nodes(candidate);
        let is_valid = self.all_sound(candidate) && self.is_on_surface(candidate);
        let sums = if is_valid { Some(self.sums(candidate)) } else { None };
        for node in candidate.moved {
            self.places[*node as usize] = self.mesh.points[*node as usize];
        }
        sums
    }

    /// Bring nodes to their new places, and list the elements around them that stay.
    fn move_nodes(&mut self, candidate: &Candidate<'_>) {
        self.places.truncate(self.mesh.points.len());
        self.places.extend_from_slice(candidate.points);
        self.candidate += 1;
        self.affected.clear();
        for (node, place) in candidate.moved.iter().zip(candidate.moved_to) {
            self.places[*node as usize] = *place;
            for row in self.mesh.cavity.around.list(*node as usize) {
                let seen = &mut self.seen[*row as usize];
                if *seen != self.candidate && !self.cavity.is_gone(*row) {
                    *seen = self.candidate;
                    self.affected.push(*row);
                }
            }
        }
        for row in candidate.removed.iter().chain(&self.affected) {
            let at = &mut self.known_at[*row as usize];
            if *at == 0 {
                let element = self.mesh.cavity.elements[*row as usize];
                self.known.push(Known::of(self.mesh.points, element));
                *at = self.known.len() as u32;
            }
        }
    }

    /// What an element is like that goes or is affected.
    #[inline]
    fn known(&self, row: i32) -> &Known {
        &self.known[self.known_at[row as usize] as usize - 1]
    }

    /// Whether the elements that come or whose nodes move are sound at their new places.
    fn all_sound(&self, candidate: &Candidate<'_>) -> bool {
        for element in candidate.added {
            let normal = self.normal_under(*element, candidate.removed);
            if !is_sound(&self.places, *element, normal, LEAST_CORNER) {
                return false;
            }
        }
        for row in &self.affected {
            let element = self.mesh.cavity.elements[*row as usize];
            let known = self.known(*row);
            let normal = if known.corner < LEAST_CORNER {
                // that of an element that is not sound says little: those around it say more
                self.normal_under(element, &self.affected)
            } else {
                unit(known.area)
            };
            if !is_sound(&self.places, element, normal, least(LEAST_CORNER, known.corner)) {
                return false;
            }
        }
        true
    }

    /// Mean normal of those of some elements that share a node with one; of all, if none does.
    ///
    /// A long cavity may bend, so that its far end says nothing about this element.
    fn normal_under(&self, element: Element, rows: &[i32]) -> Vector {
        let (mut near, mut everything) = ([0.0; 3], [0.0; 3]);
        for row in rows {
            let area = self.known(*row).area;
            everything = add(everything, area);
            if shares_a_node(element, self.mesh.cavity.elements[*row as usize]) {
                near = add(near, area);
            }
        }
        if length(near) > 0.0 { unit(near) } else { unit(everything) }
    }

    /// Whether new places and the centres of new elements are on the surface.
    fn is_on_surface(&self, candidate: &Candidate<'_>) -> bool {
        let centres = candidate.added.iter().map(|element| centre(&self.places, *element));
        let mut places = candidate.points.iter().chain(candidate.moved_to).copied().chain(centres);
        match self.mesh.surface {
            SurfaceBound::Plane { origin, normal, tolerance } => {
                places.all(|place| dot(subtract(place, origin), normal).abs() <= tolerance)
            }
            SurfaceBound::Facets { facets, tolerance } => {
                let limit = tolerance * self.edge_length(candidate);
                places.all(|place| facets.is_within(place, limit))
            }
        }
    }

    /// Edge of a square of the mean area of what the candidate touches, a tria counting as half.
    fn edge_length(&self, candidate: &Candidate<'_>) -> f64 {
        let (mut area, mut count) = (0.0, 0.0);
        for row in candidate.removed.iter().chain(&self.affected) {
            area += self.known(*row).size;
            let is_tria = is_tria(self.mesh.cavity.elements[*row as usize]);
            count += if is_tria { 0.5 } else { 1.0 };
        }
        (area / count).sqrt()
    }

    /// Sums of the mesh with the candidate done.
    fn sums(&mut self, candidate: &Candidate<'_>) -> QualitySums {
        let elements = self.mesh.cavity.elements;
        let mut sums = *self.mesh.sums;
        for row in candidate.removed {
            sums.take_away(self.of_elements.get(*row));
        }
        for element in candidate.added {
            self.put_in(&mut sums, *element);
        }
        let valences =
            Valences { elements, around: self.mesh.cavity.around, outside: self.mesh.outside };
        let (goes, comes) = (candidate.removed, candidate.added);
        sums.irregular += valences.irregular_change(goes, comes, &mut self.counts) as f64;
        for row in &self.affected {
            sums.take_away(self.of_elements.get(*row));
            self.put_in(&mut sums, elements[*row as usize]);
        }
        sums
    }

    /// Add an element to the sums as it will be; not inlined, so that it is compiled in once.
    #[inline(never)]
    fn put_in(&self, sums: &mut QualitySums, element: Element) {
        sums.add_element(&self.places, element, 1.0, self.mesh.scoring);
    }
}

impl Known {
    /// Look at an element.
    fn of(points: &[Vector], element: Element) -> Self {
        let area = area_vector(points, element);
        let corner = corner_jacobian_min(points, element, unit(area));
        Self { area, size: length(area), corner }
    }
}

/// Whether an element faces the way of a unit normal and no corner is worse than `least_corner`.
#[inline]
fn is_sound(points: &[Vector], element: Element, normal: Vector, least_corner: f64) -> bool {
    let own = unit_normal(points, element);
    dot(own, normal) >= FACING && corner_jacobian_min(points, element, own) >= least_corner
}

/// Whether two elements have a node in common.
#[inline]
fn shares_a_node(one: Element, other: Element) -> bool {
    let mut shares = false;
    for node in one {
        for same in other {
            shares |= node >= 0 && node == same;
        }
    }
    shares
}

/// Mean of an element's nodes, added up share by share.
#[inline]
fn centre(points: &[Vector], element: Element) -> Vector {
    let size = size_of(element);
    let mut centre = [0.0; 3];
    for node in &element[..size] {
        for k in 0..3 {
            centre[k] += points[*node as usize][k] / size as f64;
        }
    }
    centre
}
