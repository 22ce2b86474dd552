//! Meshing: elements that fill a place anew.

pub mod node_removal;
pub mod pillowing;
