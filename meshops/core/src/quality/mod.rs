//! How good a mesh is: measures of its elements, penalties, quality sums, indices and fitness.
//!
//! Criterion `c` is row `c` of every array that has one place a criterion. The first twelve are
//! measured on each element, the last is of the mesh.

pub mod element_quality;
pub mod element_sums;
pub mod fitness;
pub mod index;
pub mod measures;
pub mod node_score;
pub mod penalty;
pub mod scoring;
pub mod sums;

pub use element_sums::ElementSums;
pub use measures::{Corners, Measures};
pub use scoring::{Levels, Scoring, Sizing};
pub use sums::QualitySums;

/// How many criteria are measured on each element.
pub const CRITERIA: usize = 12;

/// The criterion of the mesh: trias in percent of the elements.
pub const PERCENT_TRIAS: usize = 12;

/// The last of the criteria of size, which are the first three; the others are of shape.
pub const ASPECT_RATIO: usize = 2;

/// Penalty beyond that of the fail level that is rounding, not failure.
pub const SLACK: f64 = 1e-9;
