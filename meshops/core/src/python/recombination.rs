//! Recombination of trias to quads, and quads to trias.

use pyo3::prelude::*;

use super::arrays::{
    Array, List, Rows, Table, check_elements, check_facets, require, to_list, to_rows,
};
use crate::mesh::neighbours;
use crate::recombination::{
    greedy_matching as greedy, maximum_matching as maximum, merging, quad_shape, splitting,
    transport_pairing,
};

#[pyfunction]
fn tria_neighbours<'py>(
    py: Python<'py>,
    trias: Rows<'py, i32, 3>,
    nodes: usize,
) -> PyResult<Table<'py, i32>> {
    let trias = trias.rows();
    check_facets(trias, nodes)?;
    let found = py.detach(|| neighbours::tria_neighbours(trias, nodes));
    to_rows(py, found)
}

#[pyfunction]
fn pair_shapes<'py>(
    py: Python<'py>,
    points: Rows<'py, f64, 3>,
    trias: Rows<'py, i32, 3>,
    neighbours: Rows<'py, i32, 3>,
) -> PyResult<Table<'py, f64>> {
    let (points, trias, neighbours) = (points.rows(), trias.rows(), neighbours.rows());
    check_facets(trias, points.len())?;
    check_neighbours(neighbours, trias.len())?;
    let shapes = py.detach(|| quad_shape::pair_shapes(points, trias, neighbours));
    to_rows(py, shapes)
}

#[pyfunction]
fn greedy_matching<'py>(
    py: Python<'py>,
    neighbours: Rows<'py, i32, 3>,
    shapes: Rows<'py, f64, 3>,
    least: f64,
) -> PyResult<Array<'py, i32>> {
    let (neighbours, shapes) = (neighbours.rows(), shapes.rows());
    check_neighbours(neighbours, shapes.len())?;
    let mate = py.detach(|| greedy::greedy_matching(neighbours, shapes, least));
    Ok(to_list(py, mate))
}

#[pyfunction]
fn maximum_matching<'py>(
    py: Python<'py>,
    neighbours: Rows<'py, i32, 3>,
    shapes: Rows<'py, f64, 3>,
    mate: List<'py, i32>,
) -> PyResult<Array<'py, i32>> {
    let (neighbours, shapes, mate) = (neighbours.rows(), shapes.rows(), mate.items());
    check_neighbours(neighbours, shapes.len())?;
    let knows = |t: usize, other: i32| neighbours[other as usize].contains(&(t as i32));
    let mutual = neighbours
        .iter()
        .enumerate()
        .all(|(t, across)| across.iter().all(|other| *other < 0 || knows(t, *other)));
    require(mutual, "neighbours are not mutual")?;
    require(mate.len() == neighbours.len(), "each tria needs a mate or -1")?;
    let is_mate = |t: usize, other: i32| {
        other == -1
            || (neighbours[t].contains(&other) && other >= 0 && mate[other as usize] == t as i32)
    };
    let matched = mate.iter().enumerate().all(|(t, other)| is_mate(t, *other));
    require(matched, "mates are not mutual, or no neighbours")?;
    let mate = py.detach(|| maximum::maximum_matching(neighbours, shapes, mate.to_vec()));
    Ok(to_list(py, mate))
}

#[pyfunction]
fn merge_pairs<'py>(
    py: Python<'py>,
    trias: Rows<'py, i32, 3>,
    neighbours: Rows<'py, i32, 3>,
    mate: List<'py, i32>,
) -> PyResult<Table<'py, i32>> {
    let (trias, neighbours, mate) = (trias.rows(), neighbours.rows(), mate.items());
    check_neighbours(neighbours, trias.len())?;
    require(mate.len() == trias.len(), "each tria needs a mate or -1")?;
    require(are_rows(mate, trias.len()), "a mate is not there")?;
    let elements = py.detach(|| merging::merge_pairs(trias, neighbours, mate));
    to_rows(py, elements)
}

#[pyfunction]
fn recombine<'py>(
    py: Python<'py>,
    points: Rows<'py, f64, 3>,
    trias: Rows<'py, i32, 3>,
    least: f64,
    good: f64,
) -> PyResult<Table<'py, i32>> {
    let (points, trias) = (points.rows(), trias.rows());
    check_facets(trias, points.len())?;
    require(least > quad_shape::NO_PAIR, "the least shape must be above -2")?;
    let elements = py.detach(|| merging::recombine(points, trias, least, good));
    to_rows(py, elements)
}

#[pyfunction]
fn as_trias<'py>(
    py: Python<'py>,
    points: Rows<'py, f64, 3>,
    elements: Rows<'py, i32, 4>,
) -> PyResult<Table<'py, i32>> {
    let (points, elements) = (points.rows(), elements.rows());
    check_elements(elements, points.len())?;
    let trias = py.detach(|| splitting::as_trias(points, elements));
    to_rows(py, trias)
}

#[pyfunction]
fn split_quads<'py>(
    py: Python<'py>,
    points: Rows<'py, f64, 3>,
    elements: Rows<'py, i32, 4>,
    chosen: List<'py, bool>,
) -> PyResult<Table<'py, i32>> {
    let (points, elements, chosen) = (points.rows(), elements.rows(), chosen.items());
    check_elements(elements, points.len())?;
    require(chosen.len() == elements.len(), "each element is chosen or not")?;
    let elements = py.detach(|| splitting::split_quads(points, elements, chosen));
    to_rows(py, elements)
}

#[pyfunction]
fn unite_trias<'py>(
    py: Python<'py>,
    points: Rows<'py, f64, 3>,
    elements: Rows<'py, i32, 4>,
) -> PyResult<Table<'py, i32>> {
    let (points, elements) = (points.rows(), elements.rows());
    check_elements(elements, points.len())?;
    let elements = py.detach(|| transport_pairing::unite_trias(points, elements));
    to_rows(py, elements)
}

/// Each tria has three neighbours or -1, and there are as many trias as asked for.
fn check_neighbours(neighbours: &[[i32; 3]], trias: usize) -> PyResult<()> {
    require(neighbours.len() == trias, "each tria needs a row of neighbours")?;
    require(are_rows(neighbours.as_flattened(), trias), "a neighbour is not there")
}

/// Whether all are rows of something that has so many, or -1.
fn are_rows(rows: &[i32], count: usize) -> bool {
    rows.iter().all(|row| *row == -1 || (*row >= 0 && (*row as usize) < count))
}

/// Add what is here to the module.
pub fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_function(wrap_pyfunction!(tria_neighbours, module)?)?;
    module.add_function(wrap_pyfunction!(pair_shapes, module)?)?;
    module.add_function(wrap_pyfunction!(greedy_matching, module)?)?;
    module.add_function(wrap_pyfunction!(maximum_matching, module)?)?;
    module.add_function(wrap_pyfunction!(merge_pairs, module)?)?;
    module.add_function(wrap_pyfunction!(recombine, module)?)?;
    module.add_function(wrap_pyfunction!(as_trias, module)?)?;
    module.add_function(wrap_pyfunction!(split_quads, module)?)?;
    module.add_function(wrap_pyfunction!(unite_trias, module)?)
}
