//! Meshing: elements that fill a place anew.

pub mod area;
pub mod border_collar;
pub mod bubble_packing;
pub mod cross_field;
pub mod delaunay_refinement;
pub mod ear_clipping;
pub mod lifting;
pub mod node_removal;
pub mod parallelogram_packing;
pub mod pillowing;
pub mod set_apart;
pub mod triangulation;
