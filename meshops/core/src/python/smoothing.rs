//! Smoothing of nodes.

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use super::arrays::{
    Array, List, Rows, Table, check_elements, check_lists, check_rows, from_attributes, require,
    to_list, to_rows,
};
use super::candidates::{CandidateArrays, MeshArrays, SurfaceArrays};
use super::quality::PyScoring;
use crate::mesh::Element;
use crate::quality::node_score::Goal;
use crate::smoothing::laplace::Laplace;
use crate::smoothing::relax::Relaxation;
use crate::smoothing::slide_on_curves::{self, Curves};
use crate::smoothing::{Objective, optimise};
use crate::vectors::Vector;

type RelaxedArrays<'py> = (Table<'py, f64>, Array<'py, i32>, Array<'py, i32>, Table<'py, f64>);

/// What nodes move for, and what they must keep, as Python hands it over.
#[pyclass(frozen, name = "NodeSearch", module = "meshops._core")]
pub struct PyNodeSearch {
    goal: Goal,
    surface: Py<PyAny>,
    tolerance: f64,
    least_corner: f64,
    scoring: Py<PyScoring>,
}

/// A mesh, and which of its nodes move.
struct Movable<'a> {
    points: Vec<Vector>,
    elements: &'a [Element],
    nodes: &'a [i32],
}

impl<'a> Movable<'a> {
    fn of(
        points: &Rows<'_, f64, 3>,
        elements: &'a Rows<'_, i32, 4>,
        nodes: &'a List<'_, i32>,
    ) -> PyResult<Self> {
        let (points, elements, nodes) = (points.rows().to_vec(), elements.rows(), nodes.items());
        check_elements(elements, points.len())?;
        check_rows(nodes, points.len(), "a node is to move that is not there")?;
        Ok(Self { points, elements, nodes })
    }
}

impl PyNodeSearch {
    fn objective<'a>(&'a self, surface: &'a SurfaceArrays<'_>) -> PyResult<Objective<'a>> {
        Ok(Objective {
            goal: self.goal,
            surface: surface.target()?,
            tolerance: self.tolerance,
            least_corner: self.least_corner,
            scoring: &self.scoring.get().0,
        })
    }
}

/// Curves that nodes slide along, as Python has them.
pub struct CurveArrays<'py> {
    neighbours: Rows<'py, i32, 2>,
    segments: Rows<'py, f64, 6>,
    tolerance: f64,
}

from_attributes!(CurveArrays { neighbours, segments, tolerance });

/// What relaxation needs of a `Topology`.
struct FreeNodes<'py> {
    free_nodes: List<'py, bool>,
}

from_attributes!(FreeNodes { free_nodes });

/// What relaxation needs of a `Workpiece`.
struct RelaxationArrays<'py> {
    mesh: MeshArrays<'py>,
    topology: FreeNodes<'py>,
    around: (List<'py, i32>, List<'py, i32>),
    surface: SurfaceArrays<'py>,
}

from_attributes!(RelaxationArrays { mesh, topology, around, surface });

impl CurveArrays<'_> {
    fn curves(&self, nodes: usize) -> PyResult<Curves<'_>> {
        let neighbours = self.neighbours.rows();
        require(neighbours.len() == nodes, "each node needs a row of neighbours")?;
        let is_node = |row: i32| row >= 0 && (row as usize) < nodes;
        let fits = neighbours.iter().all(|[before, after]| {
            (*before < 0 && *after < 0) || (is_node(*before) && is_node(*after))
        });
        require(fits, "a node needs two neighbours that are there, or none")?;
        let places = self.segments.rows().as_flattened().as_chunks::<3>().0;
        Ok(Curves { neighbours, segments: places.as_chunks().0, tolerance: self.tolerance })
    }
}

#[pymethods]
impl PyNodeSearch {
    #[new]
    fn new(
        goal: &str,
        surface: Py<PyAny>,
        tolerance: f64,
        least_corner: f64,
        scoring: Py<PyScoring>,
    ) -> PyResult<Self> {
        let goal = match goal {
            "laplace" => Goal::Laplace,
            "worst" => Goal::Worst,
            "even" => Goal::Even,
            _ => return Err(PyValueError::new_err(format!("there is no goal {goal}"))),
        };
        Ok(Self { goal, surface, tolerance, least_corner, scoring })
    }

    fn optimise<'py>(
        &self,
        py: Python<'py>,
        points: Rows<'py, f64, 3>,
        elements: Rows<'py, i32, 4>,
        nodes: List<'py, i32>,
    ) -> PyResult<Table<'py, f64>> {
        let Movable { mut points, elements, nodes } = Movable::of(&points, &elements, &nodes)?;
        let surface: SurfaceArrays<'_> = self.surface.bind(py).extract()?;
        let objective = self.objective(&surface)?;
        py.detach(|| optimise::optimise(&mut points, elements, nodes, &objective));
        to_rows(py, points)
    }

    fn slide<'py>(
        &self,
        py: Python<'py>,
        points: Rows<'py, f64, 3>,
        elements: Rows<'py, i32, 4>,
        nodes: List<'py, i32>,
        curves: CurveArrays<'py>,
        shift: f64,
    ) -> PyResult<Table<'py, f64>> {
        let Movable { mut points, elements, nodes } = Movable::of(&points, &elements, &nodes)?;
        let curves = curves.curves(points.len())?;
        let surface: SurfaceArrays<'_> = self.surface.bind(py).extract()?;
        let objective = self.objective(&surface)?;
        py.detach(|| {
            slide_on_curves::slide(&mut points, elements, nodes, &curves, shift, &objective);
        });
        to_rows(py, points)
    }
}

#[pyfunction]
fn smooth_laplace<'py>(
    py: Python<'py>,
    points: Rows<'py, f64, 3>,
    elements: Rows<'py, i32, 4>,
    first_free: usize,
    sweeps: usize,
) -> PyResult<Table<'py, f64>> {
    let (mut points, elements) = (points.rows().to_vec(), elements.rows());
    check_elements(elements, points.len())?;
    py.detach(|| Laplace::default().smooth(&mut points, elements, first_free, sweeps));
    to_rows(py, points)
}

#[pyfunction]
fn project<'py>(
    py: Python<'py>,
    points: Rows<'py, f64, 3>,
    surface: SurfaceArrays<'py>,
) -> PyResult<Table<'py, f64>> {
    let mut points = points.rows().to_vec();
    if !points.is_empty() {
        let target = surface.target()?;
        py.detach(|| target.project(&mut points));
    }
    to_rows(py, points)
}

#[pyfunction]
fn relax_candidates<'py>(
    py: Python<'py>,
    candidates: CandidateArrays<'py>,
    workpiece: RelaxationArrays<'py>,
    most_elements: usize,
    sweeps: usize,
) -> PyResult<RelaxedArrays<'py>> {
    let (points, elements) = (workpiece.mesh.points.rows(), workpiece.mesh.elements.rows());
    check_elements(elements, points.len())?;
    let around = check_lists(&workpiece.around, points.len(), elements.len())?;
    let free = workpiece.topology.free_nodes.items();
    require(free.len() == points.len(), "each node is free or not")?;
    let candidates = candidates.candidates(elements.len(), points.len())?;
    for candidate in candidates.iter() {
        check_elements(candidate.added, points.len() + candidate.points.len())?;
    }
    let relaxation = Relaxation { points, elements, around, free, most_elements, sweeps };
    let target = workpiece.surface.target()?;
    let relaxed = py.detach(|| {
        let mut relaxed = relaxation.relax(candidates);
        target.project(&mut relaxed.points);
        target.project(&mut relaxed.moved_to);
        relaxed
    });
    Ok((
        to_rows(py, relaxed.points)?,
        to_list(py, relaxed.moved_start),
        to_list(py, relaxed.moved),
        to_rows(py, relaxed.moved_to)?,
    ))
}

/// Add what is here to the module.
pub fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_class::<PyNodeSearch>()?;
    module.add_function(wrap_pyfunction!(smooth_laplace, module)?)?;
    module.add_function(wrap_pyfunction!(project, module)?)?;
    module.add_function(wrap_pyfunction!(relax_candidates, module)?)
}
