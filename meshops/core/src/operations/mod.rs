//! Local edits of a mesh: what they make, whether the mesh stays whole, and how good it is then.

pub mod merging;
pub mod replace_node;
