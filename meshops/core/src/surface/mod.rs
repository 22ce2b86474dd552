//! Surfaces of facets: the nearest point of one, and whether it is plane.

pub mod nearest;
pub mod nearest_edges;
pub mod plane;

pub use nearest::{Foot, Surface};
