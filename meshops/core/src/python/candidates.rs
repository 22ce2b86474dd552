//! Candidates: their arrays, their evaluation, and conflicts between them.

use numpy::PyArrayMethods;
use pyo3::prelude::*;

use super::arrays::{
    Array, Grid, List, Rows, Table, attribute, check_elements, check_elements_around,
    check_elements_at, check_lists, check_rows, check_starts, from_attributes, require, to_list,
    to_rows,
};
use super::mesh::PyElementGraph;
use super::quality::{PyScoring, exactly};
use super::surface::PyFacetTree;
use crate::mesh::Element;
use crate::mesh::csr::CsrView;
use crate::operations::candidates::{CandidateList, Candidates};
use crate::operations::cavity::CavityMesh;
use crate::operations::conflicts::Claims;
use crate::operations::evaluation::{self, EvaluationMesh, SurfaceBound};
use crate::quality::sums::SUMS;
use crate::quality::{CRITERIA, QualitySums};
use crate::smoothing::project::Target;
use crate::surface::plane::extent;

/// How many elements of a mesh are looked at as fast as one that is touched.
const MANY: usize = 16;

/// A mesh as Python has it.
pub struct MeshArrays<'py> {
    pub points: Rows<'py, f64, 3>,
    pub elements: Rows<'py, i32, 4>,
}

from_attributes!(MeshArrays { points, elements });

/// What candidates need of a `Topology`.
struct TopologyArrays<'py> {
    graph: Bound<'py, PyElementGraph>,
    zones: List<'py, i32>,
    free_nodes: List<'py, bool>,
}

from_attributes!(TopologyArrays { graph, zones, free_nodes });

/// What the evaluation of candidates needs of a `Workpiece`.
struct EvaluationArrays<'py> {
    mesh: MeshArrays<'py>,
    topology: TopologyArrays<'py>,
    around: (List<'py, i32>, List<'py, i32>),
    outside: List<'py, i32>,
    values: Rows<'py, f64, CRITERIA>,
    tally: List<'py, f64>,
    surface: SurfaceArrays<'py>,
}

from_attributes!(EvaluationArrays { mesh, topology, around, outside, values, tally, surface });

/// What the core needs of a `PatchSurface`.
pub enum SurfaceArrays<'py> {
    Plane { points: Rows<'py, f64, 3>, normal: List<'py, f64> },
    Facets(Bound<'py, PyFacetTree>),
}

impl<'a, 'py> FromPyObject<'a, 'py> for SurfaceArrays<'py> {
    type Error = PyErr;

    fn extract(surface: Borrowed<'a, 'py, PyAny>) -> PyResult<Self> {
        match attribute(&surface, "plane")? {
            Some(normal) => Ok(Self::Plane { points: attribute(&surface, "points")?, normal }),
            // only asked for where it is needed: it is made then
            None => Ok(Self::Facets(attribute(&surface, "tree")?)),
        }
    }
}

impl SurfaceArrays<'_> {
    /// What points come back to.
    pub fn target(&self) -> PyResult<Target<'_>> {
        match self {
            Self::Plane { points, normal } => {
                let points = points.rows();
                require(!points.is_empty(), "a plane needs a point")?;
                Ok(Target::Plane { origin: points[0], normal: exactly(normal.items())? })
            }
            Self::Facets(tree) => Ok(Target::Facets(&tree.get().0)),
        }
    }

    fn bound(&self, plane_tolerance: f64, tolerance: f64) -> PyResult<SurfaceBound<'_>> {
        let tolerance = match self {
            Self::Plane { points, .. } => plane_tolerance * extent(points.rows()),
            Self::Facets(_) => tolerance,
        };
        Ok(match self.target()? {
            Target::Plane { origin, normal } => SurfaceBound::Plane { origin, normal, tolerance },
            Target::Facets(facets) => SurfaceBound::Facets { facets, tolerance },
        })
    }
}

/// A `Candidates`.
pub struct CandidateArrays<'py> {
    removed_start: List<'py, i32>,
    removed: List<'py, i32>,
    added_start: List<'py, i32>,
    added: Rows<'py, i32, 4>,
    point_start: List<'py, i32>,
    points: Rows<'py, f64, 3>,
    moved_start: List<'py, i32>,
    moved: List<'py, i32>,
    moved_to: Rows<'py, f64, 3>,
}

from_attributes!(CandidateArrays {
    removed_start,
    removed,
    added_start,
    added,
    point_start,
    points,
    moved_start,
    moved,
    moved_to
});

impl CandidateArrays<'_> {
    /// The candidates, all rows of elements and nodes that they name being those of a mesh.
    ///
    /// The nodes of elements that come are not looked at.
    pub fn candidates(&self, elements: usize, nodes: usize) -> PyResult<Candidates<'_>> {
        let candidates = Candidates {
            removed: CsrView { start: self.removed_start.items(), items: self.removed.items() },
            added_start: self.added_start.items(),
            added: self.added.rows(),
            point_start: self.point_start.items(),
            points: self.points.rows(),
            moved: CsrView { start: self.moved_start.items(), items: self.moved.items() },
            moved_to: self.moved_to.rows(),
        };
        let count = candidates.removed.start.len();
        for (start, items) in [
            (candidates.removed.start, candidates.removed.items.len()),
            (candidates.added_start, candidates.added.len()),
            (candidates.point_start, candidates.points.len()),
            (candidates.moved.start, candidates.moved.items.len()),
        ] {
            require(start.len() == count, "all lists of candidates are as many")?;
            check_starts(start, items)?;
        }
        let places = candidates.moved_to.len();
        require(places == candidates.moved.items.len(), "each node that moves needs one place")?;
        check_rows(candidates.removed.items, elements, "an element goes that is not there")?;
        check_rows(candidates.moved.items, nodes, "a node moves that is not there")?;
        Ok(candidates)
    }
}

/// All elements that candidates have to do with name nodes, and the lists around nodes are sound.
///
/// Of a large mesh only what is touched is looked at.
fn check_touched<'a>(
    candidates: &Candidates<'_>,
    elements: &[Element],
    around: &'a (List<'_, i32>, List<'_, i32>),
    nodes: usize,
) -> PyResult<CsrView<'a>> {
    let (removed, moved) = (candidates.removed.items, candidates.moved.items);
    if MANY * (removed.len() + moved.len()) > elements.len() {
        check_elements(elements, nodes)?;
        return check_lists(around, nodes, elements.len());
    }
    check_elements_at(removed, elements, nodes)?;
    let corners = removed.iter().flat_map(|row| elements[*row as usize]);
    let corners = corners.filter(|node| *node >= 0);
    check_elements_around(around, corners.chain(moved.iter().copied()), elements, nodes)
}

/// Candidates as the arrays of a `Candidates`, in their order.
pub type ListedCandidates<'py> = (
    Array<'py, i32>,
    Array<'py, i32>,
    Array<'py, i32>,
    Table<'py, i32>,
    Array<'py, i32>,
    Table<'py, f64>,
    Array<'py, i32>,
    Array<'py, i32>,
    Table<'py, f64>,
);

/// Hand candidates to Python.
pub fn to_candidates(py: Python<'_>, list: CandidateList) -> PyResult<ListedCandidates<'_>> {
    Ok((
        to_list(py, list.removed_start),
        to_list(py, list.removed),
        to_list(py, list.added_start),
        to_rows(py, list.added)?,
        to_list(py, list.point_start),
        to_rows(py, list.points)?,
        to_list(py, list.moved_start),
        to_list(py, list.moved),
        to_rows(py, list.moved_to)?,
    ))
}

/// The sums of what is no mesh.
pub const NO_MESH: [f64; SUMS] = [f64::NAN; SUMS];

#[pyfunction]
fn evaluate_candidates<'py>(
    py: Python<'py>,
    candidates: CandidateArrays<'py>,
    workpiece: EvaluationArrays<'py>,
    scoring: &Bound<'py, PyScoring>,
    plane_tolerance: f64,
    surface_tolerance: f64,
) -> PyResult<Table<'py, f64>> {
    let (points, elements) = (workpiece.mesh.points.rows(), workpiece.mesh.elements.rows());
    let candidates = candidates.candidates(elements.len(), points.len())?;
    let around = check_touched(&candidates, elements, &workpiece.around, points.len())?;
    let topology = &workpiece.topology;
    let (zones, free) = (topology.zones.items(), topology.free_nodes.items());
    let graph = topology.graph.get().view();
    require(graph.len() == elements.len(), "the graph is not that of the elements")?;
    require(zones.len() == elements.len(), "each element needs one zone")?;
    require(free.len() == points.len(), "each node is free or not")?;
    let (outside, measures) = (workpiece.outside.items(), workpiece.values.rows());
    require(outside.len() == points.len(), "each node needs one number of elements outside")?;
    require(measures.len() == elements.len(), "each element needs one row of measures")?;
    let mesh = EvaluationMesh {
        points,
        cavity: CavityMesh { elements, around, graph, zones, free },
        outside,
        measures,
        sums: &QualitySums::from(&exactly(workpiece.tally.items())?),
        scoring: &scoring.get().0,
        surface: workpiece.surface.bound(plane_tolerance, surface_tolerance)?,
    };
    let sums = py.detach(|| {
        let each = evaluation::evaluate_candidates(&mesh, candidates).into_iter();
        each.map(|sums| sums.map_or(NO_MESH, |sums| sums.to_array())).collect()
    });
    to_rows(py, sums)
}

/// What each of some candidates needs for itself.
#[pyclass(frozen, name = "Claims", module = "meshops._core")]
struct PyClaims(Claims);

#[pymethods]
impl PyClaims {
    #[new]
    fn new(
        py: Python<'_>,
        candidates: CandidateArrays<'_>,
        elements: Rows<'_, i32, 4>,
        around: (List<'_, i32>, List<'_, i32>),
    ) -> PyResult<Self> {
        let (elements, nodes) = (elements.rows(), around.0.items().len().saturating_sub(1));
        let candidates = candidates.candidates(elements.len(), nodes)?;
        let around = check_touched(&candidates, elements, &around, nodes)?;
        Ok(Self(py.detach(|| Claims::of(candidates, elements, around))))
    }

    fn combine<'py>(
        &self,
        py: Python<'py>,
        genomes: Grid<'py, i64>,
        changes: Rows<'py, f64, SUMS>,
    ) -> PyResult<(Table<'py, f64>, Table<'py, bool>)> {
        let (genomes, changes) = (genomes.rows(), changes.rows());
        let candidates = self.0.claimed.len();
        require(changes.len() == candidates, "each candidate needs one row of changes")?;
        require(genomes.items.iter().all(|gene| *gene >= 0), "a gene is less than 0")?;
        let combined = py.detach(|| self.0.combine(genomes.iter(), changes));
        let taken = to_list(py, combined.taken).reshape([genomes.count, genomes.width])?;
        Ok((to_rows(py, combined.sums)?, taken))
    }
}

/// Add what is here to the module.
pub fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_class::<PyClaims>()?;
    module.add_function(wrap_pyfunction!(evaluate_candidates, module)?)
}
