//! Recombination: trias and quads become others by what happens along rows of elements.

pub mod chord_collapse;
pub mod chord_insertion;
pub mod strips;
pub mod tria_transport;
