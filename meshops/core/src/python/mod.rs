//! What Python sees: arrays are checked and borrowed, and the GIL is released around the work.

use pyo3::prelude::*;

pub mod arrays;
mod edits;
mod ground;
mod mesh;
mod quality;
mod surface;

/// Add all that Python sees to the module.
pub fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    edits::register(module)?;
    ground::register(module)?;
    mesh::register(module)?;
    quality::register(module)?;
    surface::register(module)
}
