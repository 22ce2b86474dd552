//! Quality sums: what a mesh's Q.I. and fitness follow from, added up over its elements.
//!
//! Elements can be added and taken away, so an edit is scored by the elements that it touches.
//! Irregular nodes do not follow from elements one by one: the functions here leave that sum as it
//! is, and who knows the mesh fills it.

use super::measures::{Corners, Measures};
use super::penalty::{penalty, severity};
use super::scoring::Scoring;
use super::{ASPECT_RATIO, CRITERIA};
use crate::mesh::{Element, is_tria};
use crate::vectors::Vector;

/// How many numbers quality sums are in Python.
pub const SUMS: usize = 56;

/// What elements add up to by one criterion.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CriterionSums {
    /// Penalties of the elements that pass.
    pub passing: f64,
    /// How many pass.
    pub passed: f64,
    /// Penalties of the elements that fail.
    pub failing: f64,
    /// How many fail.
    pub failed: f64,
}

/// What elements add up to. Counts are whole numbers; all is NaN for no mesh at all.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct QualitySums {
    /// By each criterion of elements.
    pub criteria: [CriterionSums; CRITERIA],
    /// Elements.
    pub elements: f64,
    /// Quads.
    pub quads: f64,
    /// Trias.
    pub trias: f64,
    /// Elements that fail.
    pub failed: f64,
    /// Irregular nodes.
    pub irregular: f64,
    /// Elements that fail by shape.
    pub shape_failed: f64,
    /// Severity of faults of shape: the penalties beyond the fail level, 1 for what is just beyond
    /// its bound.
    pub shape: f64,
    /// Severity of faults of size.
    pub size: f64,
}

impl QualitySums {
    /// Sums of elements, chordal deviation left out.
    pub fn of_elements(points: &[Vector], elements: &[Element], scoring: &Scoring) -> Self {
        let mut sums = Self::default();
        for element in elements {
            sums.add_element(points, *element, 1.0, scoring);
        }
        sums
    }

    /// Sums of elements by their measures.
    pub fn of_measures(values: &[[f64; CRITERIA]], is_tria: &[bool], scoring: &Scoring) -> Self {
        let mut sums = Self::default();
        for (row, is_tria) in values.iter().zip(is_tria) {
            sums.add(&Measures::from(*row), *is_tria, 1.0, scoring);
        }
        sums
    }

    /// Add (`sign` +1) or take away (-1) an element.
    ///
    /// Taking away needs the points as they were when the element was added.
    #[inline]
    pub fn add_element(
        &mut self,
        points: &[Vector],
        element: Element,
        sign: f64,
        scoring: &Scoring,
    ) {
        let measures = Measures::of(&Corners::of(points, element), &scoring.sizing);
        self.add(&measures, is_tria(element), sign, scoring);
    }

    /// Add (`sign` +1) or take away (-1) an element by its measures.
    #[inline]
    pub fn add(&mut self, measures: &Measures, is_tria: bool, sign: f64, scoring: &Scoring) {
        let limit = scoring.limit();
        let (mut failed, mut failed_by_shape) = (false, false);
        let values = measures.to_array();
        for c in 0..CRITERIA {
            if !scoring.active[c] {
                continue;
            }
            let levels = &scoring.levels[c];
            let p = penalty(values[c], levels, &scoring.penalties);
            if p.is_nan() {
                continue;
            }
            let fault = severity(values[c], p, levels, limit);
            if fault != 0.0 {
                let severities = if c > ASPECT_RATIO { &mut self.shape } else { &mut self.size };
                *severities += sign * fault;
            }
            let sums = &mut self.criteria[c];
            if p > limit {
                failed = true;
                failed_by_shape = failed_by_shape || c > ASPECT_RATIO;
                sums.failing += sign * p;
                sums.failed += sign;
            } else {
                sums.passing += sign * p;
                sums.passed += sign;
            }
        }
        self.elements += sign;
        if is_tria {
            self.trias += sign;
        } else {
            self.quads += sign;
        }
        if failed {
            self.failed += sign;
        }
        if failed_by_shape {
            self.shape_failed += sign;
        }
    }

    /// Sums of one element by its measures.
    pub fn of_element(measures: &Measures, is_tria: bool, scoring: &Scoring) -> Self {
        let mut sums = Self::default();
        sums.add(measures, is_tria, 1.0, scoring);
        sums
    }

    /// Take away what an element added: the same bits as taking it away by its measures, as sums
    /// of severities are exact.
    #[inline]
    pub fn take_away(&mut self, element: &Self) {
        for (sums, less) in self.criteria.iter_mut().zip(&element.criteria) {
            sums.passing -= less.passing;
            sums.passed -= less.passed;
            sums.failing -= less.failing;
            sums.failed -= less.failed;
        }
        self.elements -= element.elements;
        self.quads -= element.quads;
        self.trias -= element.trias;
        self.failed -= element.failed;
        self.shape_failed -= element.shape_failed;
        self.shape -= element.shape;
        self.size -= element.size;
    }

    /// Trias in percent of the elements; 0 for no elements.
    #[inline]
    pub fn percent_trias(&self) -> f64 {
        if self.elements > 0.5 { 100.0 * self.trias / self.elements } else { 0.0 }
    }

    /// As Python has them: four numbers a criterion, then the others in their order here.
    #[inline]
    pub fn to_array(&self) -> [f64; SUMS] {
        let mut array = [0.0; SUMS];
        for (four, sums) in array.chunks_exact_mut(4).zip(&self.criteria) {
            four.copy_from_slice(&[sums.passing, sums.passed, sums.failing, sums.failed]);
        }
        array[4 * CRITERIA..].copy_from_slice(&[
            self.elements,
            self.quads,
            self.trias,
            self.failed,
            self.irregular,
            self.shape_failed,
            self.shape,
            self.size,
        ]);
        array
    }
}

impl From<&[f64; SUMS]> for QualitySums {
    #[inline]
    fn from(array: &[f64; SUMS]) -> Self {
        let mut criteria = [CriterionSums::default(); CRITERIA];
        for (sums, four) in criteria.iter_mut().zip(array.as_chunks::<4>().0) {
            let [passing, passed, failing, failed] = *four;
            *sums = CriterionSums { passing, passed, failing, failed };
        }
        Self {
            criteria,
            elements: array[48],
            quads: array[49],
            trias: array[50],
            failed: array[51],
            irregular: array[52],
            shape_failed: array[53],
            shape: array[54],
            size: array[55],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quality::scoring::{Levels, Sizing};
    use proptest::prelude::*;

    /// Criteria under which about half of all elements fail.
    fn scoring() -> Scoring {
        let rising = |worst: f64| Levels::from([0.0, 0.1, 0.4, 0.5, 1.0, 0.3].map(|x| x * worst));
        let falling = |best: f64| Levels::from([1.0, 0.9, 0.6, 0.5, 0.1, 0.7].map(|x| x * best));
        Scoring {
            levels: [
                falling(1.0),
                rising(4.0),
                rising(9.0),
                rising(60.0),
                rising(300.0),
                falling(90.0),
                rising(240.0),
                falling(60.0),
                rising(90.0),
                falling(1.0),
                rising(1.0),
                rising(1.0),
                rising(50.0),
            ],
            weights: [1.0; CRITERIA + 1],
            active: [true; CRITERIA + 1],
            penalties: [0.0, 0.1, 0.8, 1.0, 10.0],
            sizing: Sizing::default(),
        }
    }

    #[test]
    fn arrays_go_there_and_back() {
        let array: [f64; SUMS] = std::array::from_fn(|i| i as f64);
        assert_eq!(QualitySums::from(&array).to_array(), array);
    }

    proptest! {
        #[test]
        fn sums_kept_up_are_the_sums_of_what_is_left(
            points in prop::collection::vec(prop::array::uniform3(-2.0..2.0), 8),
            elements in prop::collection::vec(prop::array::uniform3(0i32..8), 12),
            steps in prop::collection::vec(0usize..12, 0..60),
        ) {
            let scoring = scoring();
            let fourth = |row: usize| if row.is_multiple_of(3) { -1 } else { row as i32 % 8 };
            let elements: Vec<Element> =
                elements.iter().enumerate().map(|(i, e)| [e[0], e[1], e[2], fourth(i)]).collect();
            let mut sums = QualitySums::default();
            let mut is_there = [false; 12];
            for row in steps {
                let sign = if is_there[row] { -1.0 } else { 1.0 };
                sums.add_element(&points, elements[row], sign, &scoring);
                is_there[row] = !is_there[row];
            }
            let left: Vec<Element> = (0..12).filter(|i| is_there[*i]).map(|i| elements[i]).collect();
            let expected = QualitySums::of_elements(&points, &left, &scoring);
            for (found, expected) in sums.to_array().iter().zip(expected.to_array()) {
                prop_assert!((found - expected).abs() < 1e-9);
            }
            prop_assert!((sums.compound_index(&scoring) - expected.compound_index(&scoring)).abs() < 1e-9);
            prop_assert_eq!((sums.shape, sums.size), (expected.shape, expected.size));
        }
    }
}
