//! Surfaces.

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use super::arrays::{Array, Rows, Table, check_facets, require, to_list, to_rows};
use crate::surface::{FacetTree, Foot, Surface, nearest, nearest_edges as edges, plane};

type Found<'py> = (Table<'py, f64>, Array<'py, f64>, Array<'py, i32>);
type Along<'py> = (Array<'py, f64>, Array<'py, i32>, Array<'py, f64>);

#[pyfunction]
fn bounding_spheres<'py>(
    py: Python<'py>,
    points: Rows<'py, f64, 3>,
    facets: Rows<'py, i32, 3>,
) -> PyResult<Table<'py, f64>> {
    let (points, facets) = (points.rows(), facets.rows());
    check_facets(facets, points.len())?;
    let spheres = py.detach(|| nearest::bounding_spheres(points, facets));
    to_rows(py, spheres)
}

#[pyfunction(name = "nearest")]
fn nearest_on_surface<'py>(
    py: Python<'py>,
    queries: Rows<'py, f64, 3>,
    points: Rows<'py, f64, 3>,
    facets: Rows<'py, i32, 3>,
    spheres: Rows<'py, f64, 4>,
) -> PyResult<Found<'py>> {
    let (queries, points) = (queries.rows(), points.rows());
    let (facets, spheres) = (facets.rows(), spheres.rows());
    check_facets(facets, points.len())?;
    require(facets.len() == spheres.len(), "each facet needs one sphere")?;
    require(queries.is_empty() || !facets.is_empty(), "there is no facet to be near to")?;
    let surface = Surface { points, facets, spheres };
    let found = py.detach(|| surface.nearest_to_each(queries));
    to_found(py, &found)
}

/// Facets of a surface that is asked many times.
#[pyclass(frozen, name = "FacetTree", module = "meshops._core")]
pub struct PyFacetTree(pub FacetTree);

#[pymethods]
impl PyFacetTree {
    #[new]
    fn new(py: Python<'_>, points: Rows<'_, f64, 3>, facets: Rows<'_, i32, 3>) -> PyResult<Self> {
        let (points, facets) = (points.rows(), facets.rows());
        check_facets(facets, points.len())?;
        let tree = py.detach(|| FacetTree::new(&Surface { points, facets, spheres: &[] }));
        let missing = || PyValueError::new_err("there is no facet to be near to");
        tree.map(Self).ok_or_else(missing)
    }

    fn nearest<'py>(&self, py: Python<'py>, queries: Rows<'py, f64, 3>) -> PyResult<Found<'py>> {
        let queries = queries.rows();
        let found: Vec<_> =
            py.detach(|| queries.iter().map(|place| self.0.nearest(*place)).collect());
        to_found(py, &found)
    }
}

fn to_found<'py>(py: Python<'py>, found: &[Foot]) -> PyResult<Found<'py>> {
    Ok((
        to_rows(py, found.iter().map(|foot| foot.point).collect())?,
        to_list(py, found.iter().map(|foot| foot.distance).collect()),
        to_list(py, found.iter().map(|foot| foot.facet as i32).collect()),
    ))
}

#[pyfunction]
fn areas_of<'py>(
    py: Python<'py>,
    points: Rows<'py, f64, 3>,
    facets: Rows<'py, i32, 3>,
) -> PyResult<(Array<'py, f64>, f64)> {
    let (points, facets) = (points.rows(), facets.rows());
    check_facets(facets, points.len())?;
    let area = py.detach(|| plane::areas_of(points, facets));
    Ok((to_list(py, area.vector.to_vec()), area.size))
}

#[pyfunction]
fn plane_of<'py>(
    py: Python<'py>,
    points: Rows<'py, f64, 3>,
    facets: Rows<'py, i32, 3>,
    tolerance: f64,
) -> PyResult<(Array<'py, f64>, f64, Array<'py, f64>, bool)> {
    let (points, facets) = (points.rows(), facets.rows());
    check_facets(facets, points.len())?;
    let found = py.detach(|| plane::plane_of(points, facets, tolerance));
    Ok((
        to_list(py, found.area.vector.to_vec()),
        found.area.size,
        to_list(py, found.normal.to_vec()),
        found.is_plane,
    ))
}

#[pyfunction]
fn nearest_edges<'py>(
    py: Python<'py>,
    points: Rows<'py, f64, 3>,
    starts: Rows<'py, f64, 3>,
    ends: Rows<'py, f64, 3>,
) -> PyResult<Along<'py>> {
    let (points, starts, ends) = (points.rows(), starts.rows(), ends.rows());
    require(starts.len() == ends.len(), "each edge needs a start and an end")?;
    let found = py.detach(|| edges::nearest_edges(points, starts, ends));
    Ok((
        to_list(py, found.iter().map(|nearest| nearest.distance).collect()),
        to_list(py, found.iter().map(|nearest| nearest.edge as i32).collect()),
        to_list(py, found.iter().map(|nearest| nearest.along).collect()),
    ))
}

/// Add what is here to the module.
pub fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_class::<PyFacetTree>()?;
    module.add_function(wrap_pyfunction!(bounding_spheres, module)?)?;
    module.add_function(wrap_pyfunction!(nearest_on_surface, module)?)?;
    module.add_function(wrap_pyfunction!(areas_of, module)?)?;
    module.add_function(wrap_pyfunction!(plane_of, module)?)?;
    module.add_function(wrap_pyfunction!(nearest_edges, module)?)
}
