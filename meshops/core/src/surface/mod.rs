//! Surfaces of facets: the nearest point of one, and whether it is plane.

pub mod facet_tree;
pub mod nearest;
pub mod nearest_edges;
pub mod plane;

pub use facet_tree::FacetTree;
pub use nearest::{Foot, Surface};
