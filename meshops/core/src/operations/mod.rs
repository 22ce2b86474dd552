//! Local edits of a mesh: what they make, whether the mesh stays whole, and how good it is then.

pub mod candidates;
pub mod cavity;
pub mod collapse_diagonal;
pub mod conflicts;
pub mod evaluation;
pub mod join_trias;
pub mod merging;
pub mod node_fan;
pub mod open_diagonal;
pub mod pair_polygon;
pub mod replace_node;
pub mod selection;
mod sides;
pub mod swap_edge;
