//! Annealing a patch: many small random changes, which settle where it lacks least.
//!
//! [`undoable_patch`] is what changes, [`reconnection`] and [`node_moves`] are the changes,
//! [`energy`] says what a patch lacks, and [`simulated_annealing`] which changes stay.

pub mod books;
pub mod energy;
pub mod node_moves;
pub mod reconnection;
pub mod simulated_annealing;
pub mod undoable_patch;

pub use energy::{Prices, Site, SiteSurface, WantedSizes};
pub use simulated_annealing::{Annealed, Cooling, anneal};
pub use undoable_patch::UndoablePatch;

#[cfg(test)]
mod tests;
