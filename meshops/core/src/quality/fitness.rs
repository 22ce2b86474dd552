//! Fitness: faults of shape first, then trias, then how good what passes is; harm costs most.

use super::scoring::Scoring;
use super::sums::QualitySums;
use crate::math::{greatest, least};

/// Severity by shape of an element that no solver takes, concave or folded: beyond the worst level
/// by three limits. One tria may come where such a one goes.
const DIRE: f64 = 30.0;

/// What a harm costs over the least fault of shape: more than mending any one element gains.
const HARM: f64 = 60.0;

/// More than the severity by size that any element can have.
const WORST_SIZE: f64 = 31.0;

/// Fitness of an individual that makes no valid mesh.
pub const INVALID: f64 = f64::NEG_INFINITY;

/// What must not be exceeded; infinite: anything may.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// Severity of faults of shape.
    pub shape: f64,
    /// Trias.
    pub trias: f64,
    /// Severity of faults of size.
    pub size: f64,
}

/// How meshes are ordered.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fitness {
    /// Of the mesh that the search started from.
    pub limits: Limits,
    /// What comes second is divided by it: one more than the elements that the run started from.
    pub share: f64,
    /// What an irregular node costs.
    pub irregularity: f64,
    /// Trias and faults of shape change places.
    pub trias_first: bool,
}

impl Fitness {
    /// Fitness of a mesh by its quality sums; `price` is what the operations cost that made it.
    pub fn of(&self, sums: &QualitySums, price: f64, scoring: &Scoring) -> f64 {
        if !sums.elements.is_finite() {
            return INVALID;
        }
        let QualitySums { shape, size, trias, .. } = *sums;
        let limits = self.limits;
        let dire = (greatest(limits.shape - shape, 0.0) / DIRE).floor();
        let mut harm = greatest(trias - limits.trias - dire, 0.0);
        harm += greatest(size - limits.size - WORST_SIZE * dire, 0.0);
        let (mut first, mut second) = (shape, trias);
        if self.trias_first {
            harm += greatest(shape - limits.shape, 0.0);
            (first, second) = (trias, shape / self.share);
        }
        // not the compound Q.I.: what fails adds so much to it that nothing else counts any more
        let index = sums.passing_index(scoring) + self.irregularity * sums.irregular / self.share;
        let mut finish = (index / (1.0 + index) + least(price / self.share, 1.0)) / 2.0;
        finish += size / (WORST_SIZE * self.share);
        100.0 - first - HARM * harm - (second + finish) / self.share
    }
}
