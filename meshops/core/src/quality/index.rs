//! Quality indices (Q.I.) of a mesh by its quality sums.
//!
//! Altair's definitions for HyperMesh: what passes counts by its mean, what fails adds up.

use super::penalty::penalty;
use super::scoring::Scoring;
use super::sums::{CriterionSums, QualitySums};
use super::{CRITERIA, PERCENT_TRIAS};

impl CriterionSums {
    /// Q.I. of a criterion: mean penalty that passes plus the sum of those that fail.
    #[inline]
    pub fn index(&self) -> f64 {
        let passing = if self.passed > 0.5 { self.passing / self.passed } else { 0.0 };
        let failing = if self.failed > 0.5 { self.failing } else { 0.0 };
        passing + failing
    }
}

impl QualitySums {
    /// Compound Q.I.: weighted mean over the criteria that pass plus the weighted sum of the rest.
    ///
    /// A criterion passes when no element fails it, also when it applies to none: its Q.I. is 0
    /// then. So the mean is not taken over fewer criteria, and higher, once the last tria has gone.
    pub fn compound_index(&self, scoring: &Scoring) -> f64 {
        let (mut passing, mut passing_weight, mut failing) = (0.0, 0.0, 0.0);
        for c in 0..CRITERIA {
            if !scoring.active[c] {
                continue;
            }
            let index = scoring.weights[c] * self.criteria[c].index();
            if self.criteria[c].failed > 0.5 {
                failing += index;
            } else {
                passing += index;
                passing_weight += scoring.weights[c];
            }
        }
        if scoring.active[PERCENT_TRIAS] {
            let levels = &scoring.levels[PERCENT_TRIAS];
            let weight = scoring.weights[PERCENT_TRIAS];
            let index = penalty(self.percent_trias(), levels, &scoring.penalties);
            if index > scoring.limit() {
                failing += weight * index;
            } else {
                passing += weight * index;
                passing_weight += weight;
            }
        }
        failing + if passing_weight > 0.0 { passing / passing_weight } else { 0.0 }
    }

    /// Weighted mean over the criteria of the mean penalty of the elements that pass.
    pub fn passing_index(&self, scoring: &Scoring) -> f64 {
        let (mut total, mut weight) = (0.0, 0.0);
        for c in 0..CRITERIA {
            if scoring.active[c] {
                weight += scoring.weights[c];
                let sums = &self.criteria[c];
                if sums.passed > 0.5 {
                    total += scoring.weights[c] * sums.passing / sums.passed;
                }
            }
        }
        if weight > 0.0 { total / weight } else { 0.0 }
    }
}
