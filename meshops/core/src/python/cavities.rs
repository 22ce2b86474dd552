//! Polygons around small groups of elements, and places that are filled anew.

use pyo3::prelude::*;

use super::arrays::{
    Array, List, Rows, Table, check_elements_around, check_elements_at, check_lists, check_rows,
    require, to_list, to_rows,
};
use super::mesh::PyElementGraph;
use crate::mesh::cavity_polygon::{CavityPolygon, MOST_ELEMENTS};
use crate::meshing::node_removal::{self, FILLINGS, Removal};
use crate::meshing::pillowing;

type FoundPolygons<'py> = (Table<'py, i32>, Array<'py, i32>);
type Replaced<'py> = (Array<'py, i32>, Array<'py, i32>, Array<'py, i32>, Table<'py, i32>);
type Pillows<'py> = (Array<'py, i32>, Table<'py, i32>, Array<'py, i32>, Table<'py, f64>);

#[pyfunction]
fn cavity_polygons<'py>(
    py: Python<'py>,
    elements: Rows<'py, i32, 4>,
    groups: Rows<'py, i32, MOST_ELEMENTS>,
) -> PyResult<FoundPolygons<'py>> {
    let (elements, groups) = (elements.rows(), groups.rows());
    let fits = |row: &i32| *row < 0 || (*row as usize) < elements.len();
    require(groups.as_flattened().iter().all(fits), "there is no such element")?;
    let polygons: Vec<_> =
        py.detach(|| groups.iter().map(|group| CavityPolygon::around(elements, *group)).collect());
    let corners = polygons.iter().map(|polygon| polygon.corners as i32).collect();
    let nodes = polygons.iter().map(|polygon| polygon.nodes).collect();
    Ok((to_rows(py, nodes)?, to_list(py, corners)))
}

#[pyfunction]
fn pillow<'py>(
    py: Python<'py>,
    sets: (List<'py, i32>, List<'py, i32>),
    points: Rows<'py, f64, 3>,
    elements: Rows<'py, i32, 4>,
    graph: &Bound<'py, PyElementGraph>,
) -> PyResult<Pillows<'py>> {
    let (points, elements, graph) = (points.rows(), elements.rows(), graph.get().view());
    require(elements.len() == graph.len(), "these are not the elements of it")?;
    let lists = sets.0.items().len().saturating_sub(1);
    let sets = check_lists(&sets, lists, elements.len())?;
    check_elements_at(sets.items, elements, points.len())?;
    let pillows = py.detach(|| pillowing::pillow(sets, points, elements, graph));
    Ok((
        to_list(py, pillows.added.start),
        to_rows(py, pillows.added.items)?,
        to_list(py, pillows.points.start),
        to_rows(py, pillows.points.items)?,
    ))
}

#[pyfunction]
fn remove_nodes<'py>(
    py: Python<'py>,
    nodes: List<'py, i32>,
    ways: List<'py, i32>,
    elements: Rows<'py, i32, 4>,
    around: (List<'py, i32>, List<'py, i32>),
) -> PyResult<Replaced<'py>> {
    let (nodes, ways, elements) = (nodes.items(), ways.items(), elements.rows());
    require(nodes.len() == ways.len(), "each node needs one way")?;
    let count = around.0.items().len().saturating_sub(1);
    let around = check_elements_around(&around, nodes.iter().copied(), elements, count)?;
    check_rows(ways, FILLINGS, "there is no such way")?;
    let each = nodes.iter().zip(ways);
    let removals: Vec<_> =
        each.map(|(node, way)| Removal { node: *node as usize, way: *way as usize }).collect();
    let found = py.detach(|| node_removal::remove_nodes(&removals, elements, around));
    Ok((
        to_list(py, found.removed.start),
        to_list(py, found.removed.items),
        to_list(py, found.added.start),
        to_rows(py, found.added.items)?,
    ))
}

/// Add what is here to the module.
pub fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("FILLINGS", FILLINGS)?;
    module.add_function(wrap_pyfunction!(cavity_polygons, module)?)?;
    module.add_function(wrap_pyfunction!(pillow, module)?)?;
    module.add_function(wrap_pyfunction!(remove_nodes, module)?)
}
