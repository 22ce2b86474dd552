//! The core of meshipelago: what runs for each element, candidate and individual.
//!
//! Pure functions on structs: no clock, no files, no global state, and the same bits on every
//! machine. This file says what Python sees.

pub mod annealing;
pub mod math;
pub mod mesh;
pub mod meshing;
pub mod operations;
pub mod quality;
pub mod recombination;
pub mod rng;
pub mod smoothing;
pub mod surface;
pub mod vectors;

#[cfg(feature = "python")]
mod python;

#[cfg(feature = "python")]
#[pyo3::pymodule]
fn _core(module: &pyo3::Bound<'_, pyo3::types::PyModule>) -> pyo3::PyResult<()> {
    python::register(module)
}
