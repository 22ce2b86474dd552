//! The quality sums of single elements, found out when they are asked for the first time.

use super::sums::QualitySums;
use super::{CRITERIA, Measures, Scoring};
use crate::mesh::{Element, is_tria};

/// Quality sums of the elements of a mesh, one by one.
#[derive(Clone, Debug)]
pub struct ElementSums<'a> {
    elements: &'a [Element],
    measures: &'a [[f64; CRITERIA]],
    scoring: &'a Scoring,
    /// Those that were asked for, and where that of each element is, from 1.
    known: Vec<QualitySums>,
    known_at: Vec<u32>,
}

impl<'a> ElementSums<'a> {
    /// Elements by their measures.
    pub fn new(
        elements: &'a [Element],
        measures: &'a [[f64; CRITERIA]],
        scoring: &'a Scoring,
    ) -> Self {
        Self { elements, measures, scoring, known: Vec::new(), known_at: vec![0; elements.len()] }
    }

    /// The sums of one element.
    #[inline]
    pub fn get(&mut self, row: i32) -> &QualitySums {
        let row = row as usize;
        if self.known_at[row] == 0 {
            let measures = Measures::from(self.measures[row]);
            let is_tria = is_tria(self.elements[row]);
            self.known.push(QualitySums::of_element(&measures, is_tria, self.scoring));
            self.known_at[row] = self.known.len() as u32;
        }
        &self.known[self.known_at[row] as usize - 1]
    }
}
