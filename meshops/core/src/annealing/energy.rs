//! The annealing energy: what a patch lacks, by its elements and nodes.
//!
//! Of an element that is its Q.I., and more where it fails, is a tria, is not valid or off its
//! size; of an inner node, whether it is irregular, that is whether other than four elements meet
//! there. An element looks at its own nodes alone, and at the surface under it: the cost is that of
//! its measures, and on a curved surface that of finding the nearest point.

use super::undoable_patch::UndoablePatch;
use crate::math::{greatest, least, ln};
use crate::mesh::valence::REGULAR;
use crate::mesh::validity::corner_on_surface;
use crate::mesh::{Element, centre, is_tria};
use crate::quality::Scoring;
use crate::quality::element_quality::ElementFaults;
use crate::surface::FacetTree;
use crate::vectors::{Vector, area_vector, length};

/// The worst corner from which an element is valid.
pub const VALID_CORNER: f64 = 0.05;

/// What each element too many or too few at a node costs beyond the first, over what that costs.
const FAR_FROM_REGULAR: f64 = 1.5;

/// Of the price of a fault: what the least fault costs.
const LEAST_FAULT: f64 = 0.6;

/// Of the price of a fault: what the worst fault costs.
///
/// What barely fails costs more than a tria, and what fails by far has a way back.
const MOST_FAULT: f64 = 1.2;

/// Of the price of a fault: what each more severity adds.
const FAULT_SLOPE: f64 = 0.1;

/// What a tria with a side on a border costs beyond any other tria, over what that costs.
const AT_BORDER: f64 = 0.1;

/// What an element costs that has e times the area that is wanted there, or an e-th of it.
const OFF_SIZE: f64 = 0.25;

/// What each lack costs, over an element whose Q.I. is higher by 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Prices {
    /// A fault of shape.
    pub shape: f64,
    /// A tria.
    pub tria: f64,
    /// An irregular node.
    pub irregular: f64,
    /// An element that is not valid.
    pub invalid: f64,
    /// A fault of size.
    pub size: f64,
}

/// Edge lengths that are wanted, each for a cube of a grid. There is at least one cube.
#[derive(Clone, Copy, Debug)]
pub struct WantedSizes<'a> {
    /// One for each cube, those along the third axis next to each other.
    pub sizes: &'a [f64],
    /// How many cubes there are along each axis.
    pub shape: [usize; 3],
    /// Corner of the first cube.
    pub origin: Vector,
    /// Edge of a cube.
    pub cell: f64,
}

impl WantedSizes<'_> {
    /// The edge that is wanted in a place; outside of the grid that of the nearest cube.
    #[inline]
    pub fn at(&self, place: Vector) -> f64 {
        let mut row = 0;
        for k in 0..3 {
            // what is below 0 becomes 0
            let cube = ((place[k] - self.origin[k]) / self.cell) as usize;
            row = row * self.shape[k] + cube.min(self.shape[k] - 1);
        }
        self.sizes[row]
    }
}

/// The surface that a patch lies on.
#[derive(Clone, Debug)]
pub enum SiteSurface {
    /// A plane.
    Plane {
        /// Its normal.
        normal: Vector,
    },
    /// One that is curved.
    Curved {
        /// Its facets.
        facets: FacetTree,
        /// How far from it the centre of an element may be.
        tolerance: f64,
    },
}

/// Where a patch lies.
#[derive(Clone, Debug)]
pub struct Site<'a> {
    /// What it lies on.
    pub surface: SiteSurface,
    /// How many nodes, the first ones, stay where they are: those of the border.
    pub fixed: i32,
    /// How many elements outside of the patch meet at each of its first nodes, -1 where any number
    /// may. There are none at the others.
    pub outside: &'a [i32],
    /// Edge lengths that are wanted.
    pub wanted: WantedSizes<'a>,
}

impl Site<'_> {
    /// How many elements outside of the patch meet at a node; -1: any number may.
    #[inline]
    pub fn outside(&self, node: i32) -> i32 {
        self.outside.get(node as usize).copied().unwrap_or(0)
    }

    /// Whether a node stays where it is.
    #[inline]
    pub fn is_fixed(&self, node: i32) -> bool {
        node < self.fixed
    }

    /// Bring a place to the surface.
    #[inline]
    pub fn onto(&self, place: Vector) -> Vector {
        match &self.surface {
            SiteSurface::Plane { .. } => place,
            SiteSurface::Curved { facets, .. } => facets.nearest(place).point,
        }
    }
}

/// How the energy of a patch is counted.
#[derive(Clone, Copy, Debug)]
pub struct Energy<'a> {
    /// Where it lies.
    pub site: &'a Site<'a>,
    /// What each lack costs.
    pub prices: &'a Prices,
    /// The criteria.
    pub scoring: &'a Scoring,
    /// Mean area of a quad at the start, a tria being half of one.
    pub mean_area: f64,
}

impl Energy<'_> {
    /// Energy of an element; 0 of an empty row.
    pub fn of_element(&self, patch: &UndoablePatch, row: usize) -> f64 {
        if patch.size(row) == 0 {
            return 0.0;
        }
        let (points, element) = (patch.points(), patch.elements()[row]);
        let (site, prices) = (self.site, self.prices);
        let faults = ElementFaults::of(points, element, self.scoring);
        let area = length(area_vector(points, element));
        let tria = is_tria(element);
        let middle = centre(points, element);
        // by area, so that a mesh does not get better by having fewer elements
        let away = size_off(if tria { 2.0 * area } else { area }, site.wanted.at(middle));
        let share = area / self.mean_area;
        let mut cost = share * OFF_SIZE * away * away;
        cost += prices.shape * fault_cost(faults.shape) + prices.size * fault_cost(faults.size);
        if faults.shape + faults.size == 0.0 {
            cost += share * faults.index;
        }
        if tria {
            let surcharge = if self.is_at_border(element) { 1.0 + AT_BORDER } else { 1.0 };
            cost += prices.tria * surcharge;
        }
        let normal = match &site.surface {
            SiteSurface::Plane { normal } => *normal,
            SiteSurface::Curved { facets, tolerance } => {
                let foot = facets.nearest(middle);
                if foot.distance > *tolerance {
                    cost += prices.invalid;
                }
                facets.normal(foot.facet)
            }
        };
        let lowest = corner_on_surface(points, element, normal);
        if lowest < VALID_CORNER {
            cost += prices.invalid * (1.0 + VALID_CORNER - lowest);
        }
        cost
    }

    /// Energy of a node.
    #[inline]
    pub fn of_node(&self, patch: &UndoablePatch, node: i32) -> f64 {
        let (around, outside) = (patch.around(node).len() as i32, self.site.outside(node));
        if outside < 0 || around == 0 {
            return 0.0;
        }
        let away = (i64::from(around) + i64::from(outside) - i64::from(REGULAR)).abs();
        if away == 0 {
            return 0.0;
        }
        self.prices.irregular * (1.0 + FAR_FROM_REGULAR * (away - 1) as f64)
    }

    /// Whether a tria has two nodes on the border.
    #[inline]
    fn is_at_border(&self, tria: Element) -> bool {
        tria[..3].iter().filter(|node| self.site.outside(**node) < 0).count() > 1
    }
}

/// Mean area of a quad, a tria being half of one.
pub fn mean_area(points: &[Vector], elements: &[Element]) -> f64 {
    let (mut area, mut quads) = (0.0, 0.0);
    for element in elements {
        area += length(area_vector(points, *element));
        quads += if is_tria(*element) { 0.5 } else { 1.0 };
    }
    area / quads
}

/// Logarithm of a quad's area over the one that is wanted.
#[inline]
fn size_off(area: f64, size: f64) -> f64 {
    ln(greatest(area, 1e-12 * size * size) / (size * size))
}

/// Of its price: what a fault costs.
#[inline]
fn fault_cost(severity: f64) -> f64 {
    if severity > 0.0 { least(LEAST_FAULT + FAULT_SLOPE * severity, MOST_FAULT) } else { 0.0 }
}
