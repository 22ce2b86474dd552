//! Smoothing: nodes move to better places, elements stay as they are.
//!
//! By the mean of the neighbours ([`laplace`]), for many small edits at once ([`relax`]), or by what
//! the criteria say of the elements around ([`optimise`], and [`slide_on_curves`] where nodes of a
//! border take part).

pub mod laplace;
mod node_search;
pub mod optimise;
pub mod project;
pub mod relax;
pub mod slide_on_curves;

pub use optimise::Objective;
