//! Recombination: trias become quads, quads become trias, and rows of elements become others.
//!
//! Two trias that share a side make a quad. A matching of the trias says who does: good quads are
//! taken first, then the matching is made as large as can be; trias that stay alone are moved
//! through the quads until they meet.

pub mod chord_collapse;
pub mod chord_insertion;
pub mod greedy_matching;
pub mod maximum_matching;
pub mod merging;
pub mod quad_shape;
pub mod splitting;
pub mod strips;
pub mod transport_pairing;
pub mod tria_transport;
