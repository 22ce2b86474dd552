//! What Python sees: arrays are checked and borrowed, and the GIL is released around the work.

use pyo3::prelude::*;

mod annealing;
pub mod arrays;
mod candidates;
mod cavities;
mod edits;
mod ground;
mod mesh;
mod meshing;
mod quality;
mod recombination;
mod smoothing;
mod strips;
mod surface;

/// Add all that Python sees to the module.
pub fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    annealing::register(module)?;
    candidates::register(module)?;
    cavities::register(module)?;
    edits::register(module)?;
    ground::register(module)?;
    mesh::register(module)?;
    meshing::register(module)?;
    quality::register(module)?;
    recombination::register(module)?;
    strips::register(module)?;
    smoothing::register(module)?;
    surface::register(module)
}
