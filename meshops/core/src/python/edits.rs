//! Local edits: merging nodes, what candidates are made of, and selections.

use pyo3::prelude::*;

use super::arrays::{
    Array, Grid, List, Rows, Table, check_elements, check_elements_around, check_elements_at,
    check_rows, from_attributes, require, to_list, to_rows,
};
use super::candidates::{ListedCandidates, MeshArrays, NO_MESH, to_candidates};
use super::quality::{PyScoring, exactly};
use crate::mesh::valence::Valences;
use crate::operations::node_fan::MOST_AROUND;
use crate::operations::replace_node::{MergeEvaluator, MergeSite, NodePair};
use crate::operations::{self, merging};
use crate::quality::{CRITERIA, QualitySums};

type Rewired<'py> = (Array<'py, i32>, Array<'py, i32>, Table<'py, i32>);

/// What merging nodes needs of a `Workpiece`.
struct MergeArrays<'py> {
    mesh: MeshArrays<'py>,
    around: (List<'py, i32>, List<'py, i32>),
    outside: List<'py, i32>,
    values: Rows<'py, f64, CRITERIA>,
    tally: List<'py, f64>,
}

from_attributes!(MergeArrays { mesh, around, outside, values, tally });

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
    let pool = node_pairs(pairs.rows(), on_border.items(), points.len())?;
    let ends = pairs.rows().iter().flat_map(|[goes, stays, _]| [*goes, *stays]);
    let around = check_elements_around(&workpiece.around, ends, elements, points.len())?;
    let outside = workpiece.outside.items();
    require(outside.len() == points.len(), "each node needs one number of elements outside")?;
    let (normals, measures) = (normals.rows(), workpiece.values.rows());
    require(normals.len() == elements.len(), "each element needs one normal")?;
    require(measures.len() == elements.len(), "each element needs one row of measures")?;
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
    check_rows(target, target.len(), "a node is merged into one that is not there")?;
    let rewiring = py.detach(|| merging::rewire(elements, target));
    Ok((
        to_list(py, rewiring.removed),
        to_list(py, rewiring.changed),
        to_rows(py, rewiring.elements)?,
    ))
}

#[pyfunction]
fn join_trias<'py>(
    py: Python<'py>,
    elements: Rows<'py, i32, 4>,
    pairs: Rows<'py, i32, 2>,
) -> PyResult<ListedCandidates<'py>> {
    let (elements, pairs) = (elements.rows(), pairs.rows());
    check_rows(pairs.as_flattened(), elements.len(), "there is no such element")?;
    to_candidates(py, py.detach(|| operations::join_trias::join_trias(elements, pairs)))
}

#[pyfunction]
fn swap_edges<'py>(
    py: Python<'py>,
    elements: Rows<'py, i32, 4>,
    pairs: Rows<'py, i32, 2>,
) -> PyResult<ListedCandidates<'py>> {
    let (elements, pairs) = (elements.rows(), pairs.rows());
    check_rows(pairs.as_flattened(), elements.len(), "there is no such element")?;
    to_candidates(py, py.detach(|| operations::swap_edge::swap_edges(elements, pairs)))
}

#[pyfunction]
fn collapse_diagonals<'py>(
    py: Python<'py>,
    quads: List<'py, i32>,
    points: Rows<'py, f64, 3>,
    elements: Rows<'py, i32, 4>,
    around: (List<'py, i32>, List<'py, i32>),
    free: List<'py, bool>,
) -> PyResult<ListedCandidates<'py>> {
    let (quads, points, elements) = (quads.items(), points.rows(), elements.rows());
    check_elements_at(quads, elements, points.len())?;
    let corners = quads.iter().flat_map(|row| elements[*row as usize]).filter(|node| *node >= 0);
    let around = check_elements_around(&around, corners, elements, points.len())?;
    let free = free.items();
    require(free.len() == points.len(), "each node is free or not")?;
    let list = py.detach(|| {
        operations::collapse_diagonal::collapse_diagonals(quads, points, elements, around, free)
    });
    to_candidates(py, list)
}

#[pyfunction]
fn open_diagonals<'py>(
    py: Python<'py>,
    nodes: List<'py, i32>,
    variants: usize,
    points: Rows<'py, f64, 3>,
    elements: Rows<'py, i32, 4>,
    around: (List<'py, i32>, List<'py, i32>),
) -> PyResult<ListedCandidates<'py>> {
    let (nodes, points, elements) = (nodes.items(), points.rows(), elements.rows());
    let asked = nodes.iter().copied();
    let around = check_elements_around(&around, asked, elements, points.len())?;
    require(variants <= MOST_AROUND, "a node has no more than 12 edges to open at")?;
    let list = py.detach(|| {
        operations::open_diagonal::open_diagonals(nodes, variants, points, elements, around)
    });
    to_candidates(py, list)
}

#[pyfunction]
fn select_ranges<'py>(
    py: Python<'py>,
    ranges: Rows<'py, i32, 2>,
    count: usize,
) -> PyResult<Array<'py, bool>> {
    require(i32::try_from(count).is_ok(), "there are not so many elements")?;
    let ranges = ranges.rows();
    Ok(to_list(py, py.detach(|| operations::selection::select_ranges(ranges, count))))
}

/// Add what is here to the module.
pub fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_function(wrap_pyfunction!(evaluate_merges, module)?)?;
    module.add_function(wrap_pyfunction!(rewire, module)?)?;
    module.add_function(wrap_pyfunction!(join_trias, module)?)?;
    module.add_function(wrap_pyfunction!(swap_edges, module)?)?;
    module.add_function(wrap_pyfunction!(collapse_diagonals, module)?)?;
    module.add_function(wrap_pyfunction!(open_diagonals, module)?)?;
    module.add_function(wrap_pyfunction!(select_ranges, module)?)
}
