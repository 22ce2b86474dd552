//! The measures of one element: lengths, angles and ratios that the criteria look at.
//!
//! Definitions: Altair's element checks for HyperMesh and OptiStruct.

mod angles;
mod corners;
mod jacobian;
mod size;
mod skew;
mod warpage;

pub use corners::Corners;
use corners::{QuadSides, TriaSides};

use super::CRITERIA;
use super::scoring::Sizing;
use crate::math::exp;
use crate::mesh::Element;
use crate::vectors::Vector;

/// Twice the area over the longest edge squared at which an element has no normal.
pub const FLAT: f64 = 1e-12;

/// What is measured on an element: lengths in the unit of the points, angles in degrees.
///
/// NaN where a criterion does not apply (angles of the other kind) or is not measured here (chordal
/// deviation). An element without area or with an edge of no length gets the worst there is where
/// a measure is undefined.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measures {
    /// Shortest edge, or minimal normalised height.
    pub min_size: f64,
    /// Longest edge.
    pub max_length: f64,
    /// Longest edge over `min_size`.
    pub aspect_ratio: f64,
    /// Angle between the halves of a quad.
    pub warpage: f64,
    /// Largest angle of a quad.
    pub max_angle_quad: f64,
    /// Smallest angle of a quad.
    pub min_angle_quad: f64,
    /// Largest angle of a tria.
    pub max_angle_tria: f64,
    /// Smallest angle of a tria.
    pub min_angle_tria: f64,
    /// 90 degrees less the smallest angle between mid-side lines, or a tria's medians and sides.
    pub skew: f64,
    /// Smallest Jacobian over the largest at the Gauss points.
    pub jacobian: f64,
    /// Distance of the surface from the edges.
    pub chordal_deviation: f64,
    /// How much less area than the mean a corner of a quad has.
    pub taper: f64,
}

impl Measures {
    /// Measure an element.
    #[inline]
    pub fn of(corners: &Corners, sizing: &Sizing) -> Self {
        let mut measures = match corners {
            Corners::Tria(corners) => tria(&TriaSides::of(corners), sizing.normalised),
            Corners::Quad(corners) => quad(&QuadSides::of(corners), sizing.normalised),
        };
        if sizing.gradient != [0.0; 3] {
            let growth = growth_at(corners.centre(), sizing);
            measures.min_size *= exp(-growth);
            measures.max_length *= exp(-growth);
        }
        measures
    }

    /// One number a criterion, in their order.
    #[inline]
    pub fn to_array(&self) -> [f64; CRITERIA] {
        [
            self.min_size,
            self.max_length,
            self.aspect_ratio,
            self.warpage,
            self.max_angle_quad,
            self.min_angle_quad,
            self.max_angle_tria,
            self.min_angle_tria,
            self.skew,
            self.jacobian,
            self.chordal_deviation,
            self.taper,
        ]
    }
}

impl From<[f64; CRITERIA]> for Measures {
    #[inline]
    fn from(values: [f64; CRITERIA]) -> Self {
        Self {
            min_size: values[0],
            max_length: values[1],
            aspect_ratio: values[2],
            warpage: values[3],
            max_angle_quad: values[4],
            min_angle_quad: values[5],
            max_angle_tria: values[6],
            min_angle_tria: values[7],
            skew: values[8],
            jacobian: values[9],
            chordal_deviation: values[10],
            taper: values[11],
        }
    }
}

/// Measures of elements, as [`Measures::to_array`] has them.
pub fn measure_elements(
    points: &[Vector],
    elements: &[Element],
    sizing: &Sizing,
) -> Vec<[f64; CRITERIA]> {
    let measure = |element| Measures::of(&Corners::of(points, element), sizing).to_array();
    elements.iter().map(|element| measure(*element)).collect()
}

/// Logarithm of the target size in a place over that of the levels.
#[inline]
fn growth_at(place: Vector, sizing: &Sizing) -> f64 {
    let mut growth = 0.0;
    for k in 0..3 {
        growth += sizing.gradient[k] * (place[k] - sizing.origin[k]);
    }
    growth
}

#[inline]
fn tria(sides: &TriaSides, normalised: bool) -> Measures {
    let size = size::of_tria(sides, normalised);
    let mut measures = Measures {
        min_size: size,
        max_length: sides.longest,
        aspect_ratio: size::aspect_ratio(sides.longest, size),
        warpage: 0.0,
        max_angle_quad: f64::NAN,
        min_angle_quad: f64::NAN,
        max_angle_tria: 180.0,
        min_angle_tria: 0.0,
        skew: 90.0,
        jacobian: 1.0,
        chordal_deviation: f64::NAN,
        taper: 0.0,
    };
    if !is_flat(sides.shortest, sides.longest, sides.twice_area) {
        let angles = angles::of_tria(sides);
        measures.max_angle_tria = angles.largest;
        measures.min_angle_tria = angles.smallest;
        measures.skew = skew::of_tria(sides);
    }
    measures
}

#[inline]
fn quad(sides: &QuadSides, normalised: bool) -> Measures {
    let size = size::of_quad(sides, normalised);
    let mut measures = Measures {
        min_size: size,
        max_length: sides.longest,
        aspect_ratio: size::aspect_ratio(sides.longest, size),
        warpage: 180.0,
        max_angle_quad: 180.0,
        min_angle_quad: 0.0,
        max_angle_tria: f64::NAN,
        min_angle_tria: f64::NAN,
        skew: 90.0,
        jacobian: 0.0,
        chordal_deviation: f64::NAN,
        taper: 1.0,
    };
    if !is_flat(sides.shortest, sides.longest, sides.twice_area) {
        let jacobians = jacobian::at_corners(sides);
        let angles = angles::of_quad(sides, jacobians);
        measures.warpage = warpage::of_quad(sides);
        measures.jacobian = jacobian::ratio(sides, jacobians);
        measures.taper = jacobian::taper(sides, jacobians);
        measures.max_angle_quad = angles.largest;
        measures.min_angle_quad = angles.smallest;
        measures.skew = skew::of_quad(sides);
    }
    measures
}

/// Whether an element has no area, or an edge no length; also where a place is NaN.
#[inline]
fn is_flat(shortest: f64, longest: f64, twice_area: f64) -> bool {
    !(shortest > FLAT * longest && twice_area > FLAT * longest * longest)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn measures_of(corners: &Corners) -> Measures {
        Measures::of(corners, &Sizing::default())
    }

    #[test]
    fn a_square_is_ideal() {
        let corners = Corners::Quad([[0.0; 3], [2.0, 0.0, 0.0], [2.0, 2.0, 0.0], [0.0, 2.0, 0.0]]);
        let found = measures_of(&corners);
        assert_eq!((found.min_size, found.max_length, found.aspect_ratio), (2.0, 2.0, 1.0));
        assert_eq!((found.warpage, found.skew, found.taper), (0.0, 0.0, 0.0));
        assert_eq!((found.min_angle_quad, found.max_angle_quad, found.jacobian), (90.0, 90.0, 1.0));
    }

    #[test]
    fn a_place_that_is_nan_is_the_worst() {
        let corners = Corners::Tria([[f64::NAN; 3], [2.0, 0.0, 0.0], [2.0, 2.0, 0.0]]);
        let found = measures_of(&corners);
        assert_eq!((found.min_angle_tria, found.max_angle_tria, found.skew), (0.0, 180.0, 90.0));
    }

    proptest! {
        #[test]
        fn turning_an_element_changes_no_angle(
            corners in prop::array::uniform4(prop::array::uniform3(-2.0..2.0))
        ) {
            let [a, b, c, d] = corners;
            let first = measures_of(&Corners::Quad(corners));
            let turned = measures_of(&Corners::Quad([b, c, d, a]));
            prop_assert!((first.max_angle_quad - turned.max_angle_quad).abs() < 1e-3);
            prop_assert_eq!(first.max_length, turned.max_length);
        }
    }
}
