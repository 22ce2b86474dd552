//! Meshing of plane areas, and collars around patches.

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use super::arrays::{
    Array, List, Rows, Table, check_facets, check_rows, require, to_list, to_rows,
};
use crate::mesh::Facet;
use crate::meshing::area::{Area, Filled};
use crate::meshing::border_collar::{self, Collar, Fault, Trias};
use crate::meshing::{
    bubble_packing, delaunay_refinement, ear_clipping, lifting, parallelogram_packing,
};

type Meshed<'py> = (Table<'py, f64>, Table<'py, i32>);
type Fill = fn(Area<'_>, f64, usize) -> Option<Filled>;

#[pyfunction]
fn clip_ears<'py>(
    py: Python<'py>,
    points: Rows<'py, f64, 2>,
    start: List<'py, i32>,
) -> PyResult<Option<Table<'py, i32>>> {
    let (points, start) = (points.rows(), start.items());
    let ascends = start.iter().all(|s| *s >= 0) && start.windows(2).all(|s| s[0] <= s[1]);
    require(ascends && !start.is_empty(), "the starts of loops do not ascend from 0")?;
    let within = start.iter().all(|s| *s as usize <= points.len());
    require(within, "a loop ends beyond the points")?;
    let trias = py.detach(|| ear_clipping::clip_ears(points, start));
    trias.map(|trias| to_rows(py, trias)).transpose()
}

#[pyfunction]
fn pack_parallelograms<'py>(
    py: Python<'py>,
    points: Rows<'py, f64, 2>,
    trias: Rows<'py, i32, 3>,
    border: Rows<'py, i32, 2>,
    size: f64,
    room: usize,
) -> PyResult<Option<Meshed<'py>>> {
    let area = area_of(&points, &trias, &border)?;
    fill(py, area, size, room, parallelogram_packing::pack_parallelograms)
}

#[pyfunction]
fn fill_by_refinement<'py>(
    py: Python<'py>,
    points: Rows<'py, f64, 2>,
    trias: Rows<'py, i32, 3>,
    border: Rows<'py, i32, 2>,
    size: f64,
    room: usize,
) -> PyResult<Option<Meshed<'py>>> {
    let area = area_of(&points, &trias, &border)?;
    fill(py, area, size, room, delaunay_refinement::fill_by_refinement)
}

#[pyfunction]
fn fill_by_bubbles<'py>(
    py: Python<'py>,
    points: Rows<'py, f64, 2>,
    trias: Rows<'py, i32, 3>,
    border: Rows<'py, i32, 2>,
    size: f64,
    room: usize,
) -> PyResult<Option<Meshed<'py>>> {
    let area = area_of(&points, &trias, &border)?;
    fill(py, area, size, room, bubble_packing::fill_by_bubbles)
}

#[pyfunction]
fn lift<'py>(
    py: Python<'py>,
    flat: Rows<'py, f64, 2>,
    trias: Rows<'py, i32, 3>,
    points: Rows<'py, f64, 3>,
    places: Rows<'py, f64, 2>,
) -> PyResult<Table<'py, f64>> {
    let (flat, trias, points, places) = (flat.rows(), trias.rows(), points.rows(), places.rows());
    check_facets(trias, flat.len())?;
    require(flat.len() == points.len(), "each node needs a place in the plane and in space")?;
    require(places.is_empty() || !points.is_empty(), "there is no surface to lift to")?;
    let lifted = py.detach(|| lifting::lift(flat, trias, points, places));
    to_rows(py, lifted)
}

#[pyfunction]
fn area_normals<'py>(
    py: Python<'py>,
    points: Rows<'py, f64, 3>,
    trias: Rows<'py, i32, 3>,
) -> PyResult<Table<'py, f64>> {
    let (points, trias) = (points.rows(), trias.rows());
    check_facets(trias, points.len())?;
    let normals = py.detach(|| lifting::area_normals(points, trias));
    to_rows(py, normals)
}

#[pyfunction]
fn extents(py: Python<'_>, points: Rows<'_, f64, 3>) -> (f64, f64) {
    let points = points.rows();
    py.detach(|| border_collar::extents(points))
}

#[pyfunction]
fn collar_apexes<'py>(
    py: Python<'py>,
    points: Rows<'py, f64, 3>,
    trias: Rows<'py, i32, 3>,
    border: Rows<'py, i32, 2>,
) -> PyResult<Table<'py, f64>> {
    let (points, trias, border) = (points.rows(), trias.rows(), border.rows());
    check_facets(trias, points.len())?;
    check_border(border, points.len())?;
    let apexes = py.detach(|| border_collar::collar_apexes(points, trias, border));
    to_rows(py, apexes)
}

/// A patch of trias with one more tria outside each border edge.
#[pyclass(name = "BorderCollar", module = "meshops._core", frozen)]
struct PyBorderCollar(Collar);

#[pymethods]
impl PyBorderCollar {
    #[new]
    fn new(
        py: Python<'_>,
        points: Rows<'_, f64, 3>,
        trias: Rows<'_, i32, 3>,
        border: Rows<'_, i32, 2>,
        nudge: f64,
    ) -> PyResult<Self> {
        let (points, trias, border) = (points.rows(), trias.rows(), border.rows());
        check_facets(trias, points.len())?;
        check_border(border, points.len())?;
        Ok(Self(py.detach(|| Collar::put_on(points, trias, border, nudge))))
    }

    #[getter]
    fn points<'py>(&self, py: Python<'py>) -> PyResult<Table<'py, f64>> {
        to_rows(py, self.0.with_collar.points.clone())
    }

    #[getter]
    fn trias<'py>(&self, py: Python<'py>) -> PyResult<Table<'py, i32>> {
        to_rows(py, self.0.with_collar.trias.clone())
    }

    #[getter]
    fn inside<'py>(&self, py: Python<'py>) -> Array<'py, f64> {
        to_list(py, self.0.inside.clone())
    }

    fn take_off<'py>(
        &self,
        py: Python<'py>,
        points: Rows<'py, f64, 3>,
        trias: Rows<'py, i32, 3>,
        inside: List<'py, f64>,
    ) -> PyResult<Meshed<'py>> {
        let (points, trias, inside) = (points.rows(), trias.rows(), inside.items());
        check_facets(trias, points.len())?;
        require(inside.len() == trias.len(), "each tria is inside or not")?;
        let patch = py.detach(|| self.0.take_off(points, trias, inside));
        let Trias { points, trias } = patch.map_err(|fault| {
            PyValueError::new_err(match fault {
                Fault::NotFinite => "remeshing left the finite numbers",
                Fault::BorderChanged => "remeshing changed the border",
                Fault::BorderMoved => "remeshing moved the border",
            })
        })?;
        Ok((to_rows(py, points)?, to_rows(py, trias)?))
    }
}

/// What is to be meshed anew, checked.
fn area_of<'a>(
    points: &'a Rows<'_, f64, 2>,
    trias: &'a Rows<'_, i32, 3>,
    border: &'a Rows<'_, i32, 2>,
) -> PyResult<Area<'a>> {
    let (points, trias, border): (_, &[Facet], _) = (points.rows(), trias.rows(), border.rows());
    check_facets(trias, points.len())?;
    check_border(border, points.len())?;
    require(points.as_flattened().iter().all(|x| x.is_finite()), "a place is not finite")?;
    Ok(Area { points, trias, border })
}

/// Fill an area by a method; None where it cannot be triangulated on its border.
fn fill<'py>(
    py: Python<'py>,
    area: Area<'_>,
    size: f64,
    room: usize,
    method: Fill,
) -> PyResult<Option<Meshed<'py>>> {
    require(size > 0.0 && size.is_finite(), "the size must be a finite number above 0")?;
    let filled = py.detach(|| method(area, size, room));
    let Some(Filled { points, trias }) = filled else { return Ok(None) };
    Ok(Some((to_rows(py, points)?, to_rows(py, trias)?)))
}

/// Border edges name points.
fn check_border(border: &[[i32; 2]], points: usize) -> PyResult<()> {
    let ends = border.as_flattened();
    check_rows(ends, points, "a border edge names a point that is not there")
}

/// Add what is here to the module.
pub fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_class::<PyBorderCollar>()?;
    module.add_function(wrap_pyfunction!(clip_ears, module)?)?;
    module.add_function(wrap_pyfunction!(pack_parallelograms, module)?)?;
    module.add_function(wrap_pyfunction!(fill_by_refinement, module)?)?;
    module.add_function(wrap_pyfunction!(fill_by_bubbles, module)?)?;
    module.add_function(wrap_pyfunction!(lift, module)?)?;
    module.add_function(wrap_pyfunction!(area_normals, module)?)?;
    module.add_function(wrap_pyfunction!(extents, module)?)?;
    module.add_function(wrap_pyfunction!(collar_apexes, module)?)
}
