//! Local edits: merging nodes, candidates and what they do.

use pyo3::prelude::*;

use super::arrays::{
    Array, Grid, List, Rows, Table, check_elements, check_lists, check_rows, require, to_list,
    to_rows,
};
use super::quality::{PyScoring, exactly};
use crate::mesh::valence::Valences;
use crate::operations::merging;
use crate::operations::replace_node::{MergeEvaluator, MergeSite, NodePair};
use crate::quality::sums::SUMS;
use crate::quality::{CRITERIA, QualitySums};

type Rewired<'py> = (Array<'py, i32>, Array<'py, i32>, Table<'py, i32>);

/// A mesh as Python has it.
#[derive(FromPyObject)]
struct MeshArrays<'py> {
    points: Rows<'py, f64, 3>,
    elements: Rows<'py, i32, 4>,
}

/// What Python knows of a mesh and its criteria, a `Workpiece`.
#[derive(FromPyObject)]
struct MergeArrays<'py> {
    mesh: MeshArrays<'py>,
    around: (List<'py, i32>, List<'py, i32>),
    outside: List<'py, i32>,
    values: Rows<'py, f64, CRITERIA>,
    tally: List<'py, f64>,
}

#[pyfunction]
fn evaluate_merges<'py>(
    py: Python<'py>,
    genomes: Grid<'py, i64>,
    pairs: Rows<'py, i32, 3>,
    on_border: List<'py, bool>,
    normals: Rows<'py, f64, 3>,
    workpiece: MergeArrays<'py>,
    scoring: Option<&Bound<'py, PyScoring>>,
) -> PyResult<Table<'py, f64>> {
    let (points, elements) = (workpiece.mesh.points.rows(), workpiece.mesh.elements.rows());
    check_elements(elements, points.len())?;
    let around = check_lists(&workpiece.around, points.len(), elements.len())?;
    let outside = workpiece.outside.items();
    require(outside.len() == points.len(), "each node needs one number of elements outside")?;
    let (normals, measures) = (normals.rows(), workpiece.values.rows());
    require(normals.len() == elements.len(), "each element needs one normal")?;
    require(measures.len() == elements.len(), "each element needs one row of measures")?;
    let pool = node_pairs(pairs.rows(), on_border.items(), points.len())?;
    let genomes = genomes.rows();
    require(genomes.items.iter().all(|gene| *gene >= 0), "a gene is less than 0")?;
    let site = MergeSite {
        points,
        valences: Valences { elements, around, outside },
        normals,
        measures,
        sums: &QualitySums::from(&exactly(workpiece.tally.items())?),
        scoring: scoring.map(|scoring| &scoring.get().0),
    };
    let sums = py.detach(|| {
        let mut evaluator = MergeEvaluator::new(site, &pool);
        let each = genomes.iter().map(|genome| evaluator.evaluate(genome));
        each.map(|sums| sums.map_or(NO_MESH, |sums| sums.to_array())).collect()
    });
    to_rows(py, sums)
}

/// The sums of what is no mesh.
const NO_MESH: [f64; SUMS] = [f64::NAN; SUMS];

/// Pairs of nodes, and whether they meet half-way.
fn node_pairs(pairs: &[[i32; 3]], on_border: &[bool], nodes: usize) -> PyResult<Vec<NodePair>> {
    require(on_border.len() == pairs.len(), "each pair is on the border or not")?;
    let mut pool = Vec::with_capacity(pairs.len());
    for ([goes, stays, half_way], on_border) in pairs.iter().copied().zip(on_border) {
        check_rows(&[goes, stays], nodes, "a pair names a node that is not there")?;
        require(half_way == 0 || half_way == 1, "a pair meets half-way or not: 1 or 0")?;
        pool.push(NodePair { goes, stays, half_way: half_way == 1, on_border: *on_border });
    }
    Ok(pool)
}

#[pyfunction]
fn rewire<'py>(
    py: Python<'py>,
    elements: Rows<'py, i32, 4>,
    target: List<'py, i32>,
) -> PyResult<Rewired<'py>> {
    let (elements, target) = (elements.rows(), target.items());
    check_elements(elements, target.len())?;
    let rewiring = py.detach(|| merging::rewire(elements, target));
    Ok((
        to_list(py, rewiring.removed),
        to_list(py, rewiring.changed),
        to_rows(py, rewiring.elements)?,
    ))
}

/// Add what is here to the module.
pub fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_function(wrap_pyfunction!(evaluate_merges, module)?)?;
    module.add_function(wrap_pyfunction!(rewire, module)?)
}
