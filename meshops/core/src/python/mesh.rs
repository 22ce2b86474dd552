//! Topology of meshes and validity of elements.

use pyo3::prelude::*;

use super::arrays::{Array, Rows, Table, check_elements, require, to_list, to_rows};
use crate::mesh::{edges, node_elements, validity};

type FoundEdges<'py> =
    (Table<'py, i32>, Table<'py, i32>, Table<'py, i32>, Array<'py, i32>, Array<'py, bool>);

#[pyfunction]
fn find_edges<'py>(
    py: Python<'py>,
    elements: Rows<'py, i32, 4>,
    nodes: usize,
) -> PyResult<FoundEdges<'py>> {
    let elements = elements.rows();
    check_elements(elements, nodes)?;
    let edges = py.detach(|| edges::find_edges(elements, nodes));
    Ok((
        to_rows(py, edges.ends)?,
        to_rows(py, edges.of_elements)?,
        to_rows(py, edges.elements)?,
        to_list(py, edges.uses),
        to_list(py, edges.opposed),
    ))
}

#[pyfunction]
fn elements_of_nodes<'py>(
    py: Python<'py>,
    elements: Rows<'py, i32, 4>,
    nodes: usize,
) -> PyResult<(Array<'py, i32>, Array<'py, i32>)> {
    let elements = elements.rows();
    check_elements(elements, nodes)?;
    let around = py.detach(|| node_elements::elements_of_nodes(elements, nodes));
    Ok((to_list(py, around.start), to_list(py, around.items)))
}

#[pyfunction]
fn unit_normals<'py>(
    py: Python<'py>,
    points: Rows<'py, f64, 3>,
    elements: Rows<'py, i32, 4>,
) -> PyResult<Table<'py, f64>> {
    let (points, elements) = (points.rows(), elements.rows());
    check_elements(elements, points.len())?;
    let normals = py.detach(|| validity::unit_normals(points, elements));
    to_rows(py, normals)
}

#[pyfunction]
fn valid_elements<'py>(
    py: Python<'py>,
    points: Rows<'py, f64, 3>,
    elements: Rows<'py, i32, 4>,
    least_corner: f64,
) -> PyResult<Array<'py, bool>> {
    let (points, elements) = (points.rows(), elements.rows());
    check_elements(elements, points.len())?;
    let valid = py.detach(|| validity::valid_elements(points, elements, least_corner));
    Ok(to_list(py, valid))
}

#[pyfunction]
fn all_facing(
    py: Python<'_>,
    points: Rows<'_, f64, 3>,
    elements: Rows<'_, i32, 4>,
    normals: Rows<'_, f64, 3>,
) -> PyResult<bool> {
    let (points, elements, normals) = (points.rows(), elements.rows(), normals.rows());
    check_elements(elements, points.len())?;
    require(normals.len() == elements.len(), "each element needs one normal")?;
    Ok(py.detach(|| validity::all_facing(points, elements, normals)))
}

#[pyfunction]
fn has_doubles(py: Python<'_>, elements: Rows<'_, i32, 4>, nodes: usize) -> PyResult<bool> {
    let elements = elements.rows();
    check_elements(elements, nodes)?;
    Ok(py.detach(|| validity::has_doubles(elements, nodes)))
}

/// Add what is here to the module.
pub fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_function(wrap_pyfunction!(find_edges, module)?)?;
    module.add_function(wrap_pyfunction!(elements_of_nodes, module)?)?;
    module.add_function(wrap_pyfunction!(unit_normals, module)?)?;
    module.add_function(wrap_pyfunction!(valid_elements, module)?)?;
    module.add_function(wrap_pyfunction!(all_facing, module)?)?;
    module.add_function(wrap_pyfunction!(has_doubles, module)?)
}
