//! Strips of elements, and what is done along them.

use pyo3::prelude::*;

use super::arrays::{
    Array, List, Rows, Table, check_csr, check_elements_around, check_elements_at, check_rows,
    require, to_list, to_rows,
};
use super::mesh::PyElementGraph;
use crate::mesh::Element;
use crate::mesh::csr::CsrView;
use crate::mesh::lists::Lists;
use crate::recombination::chord_collapse::{self, ChordGround};
use crate::recombination::chord_insertion::{self, End};
use crate::recombination::strips::{self, Limits, StripGround, Strips, StripsView};
use crate::recombination::tria_transport::{self, Way};

type FoundStrips<'py> = (Array<'py, i32>, Array<'py, i32>, Table<'py, i32>);
type ElementLists<'py> = (Array<'py, i32>, Table<'py, i32>);
type PlaceLists<'py> = (Array<'py, i32>, Table<'py, f64>);
type MoveLists<'py> = (Array<'py, i32>, Array<'py, i32>, Table<'py, f64>);
type Replaced<'py> = (Array<'py, i32>, Array<'py, i32>, Array<'py, i32>, Table<'py, i32>);

/// What Python knows of where strips may go, a `Topology`.
#[derive(FromPyObject)]
struct TopologyArrays<'py> {
    graph: Bound<'py, PyElementGraph>,
    editable: List<'py, bool>,
}

impl TopologyArrays<'_> {
    /// Where strips may go from some trias.
    fn ground<'a>(&'a self, elements: &'a [Element], trias: &[i32]) -> PyResult<StripGround<'a>> {
        let (graph, editable) = (self.graph.get().view(), self.editable.items());
        require(elements.len() == graph.len(), "these are not the elements of it")?;
        require(elements.len() == editable.len(), "each element needs one value")?;
        check_rows(trias, elements.len(), "there is no such element")?;
        Ok(StripGround { elements, graph, editable })
    }
}

/// Strips as Python has them.
#[derive(FromPyObject)]
struct StripArrays<'py> {
    start: List<'py, i32>,
    cells: List<'py, i32>,
    rungs: Rows<'py, i32, 2>,
}

impl StripArrays<'_> {
    /// The strips; their elements name some of so many nodes.
    fn view(&self, elements: &[Element], nodes: usize) -> PyResult<StripsView<'_>> {
        let cells = CsrView { start: self.start.items(), items: self.cells.items() };
        check_csr(cells, cells.len(), elements.len())?;
        check_elements_at(cells.items, elements, nodes)?;
        let rungs = self.rungs.rows();
        require(rungs.len() == cells.items.len(), "each cell needs one rung")?;
        let is_node = |node: i32| node >= 0 && (node as usize) < nodes;
        let is_rung = |[a, b]: [i32; 2]| (is_node(a) && is_node(b)) || (a == -1 && b == -1);
        require(rungs.iter().all(|rung| is_rung(*rung)), "a rung names a node that is not there")?;
        Ok(StripsView { start: cells.start, cells: cells.items, rungs })
    }
}

fn to_strips(py: Python<'_>, strips: Strips) -> PyResult<FoundStrips<'_>> {
    Ok((to_list(py, strips.start), to_list(py, strips.cells), to_rows(py, strips.rungs)?))
}

fn to_elements(py: Python<'_>, lists: Lists<Element>) -> PyResult<ElementLists<'_>> {
    Ok((to_list(py, lists.start), to_rows(py, lists.items)?))
}

fn to_replaced(
    py: Python<'_>,
    removed: Lists<i32>,
    added: Lists<Element>,
) -> PyResult<Replaced<'_>> {
    let (added_start, added) = to_elements(py, added)?;
    Ok((to_list(py, removed.start), to_list(py, removed.items), added_start, added))
}

#[pyfunction]
fn straight_strips<'py>(
    py: Python<'py>,
    elements: Rows<'py, i32, 4>,
    topology: TopologyArrays<'py>,
    trias: List<'py, i32>,
    reach: usize,
    steps: usize,
) -> PyResult<FoundStrips<'py>> {
    let trias = trias.items();
    let elements = elements.rows();
    let ground = topology.ground(elements, trias)?;
    let found = py.detach(|| strips::straight_strips(ground, trias, reach, steps));
    to_strips(py, found)
}

#[pyfunction]
fn closed_strips<'py>(
    py: Python<'py>,
    elements: Rows<'py, i32, 4>,
    topology: TopologyArrays<'py>,
) -> PyResult<FoundStrips<'py>> {
    let ground = topology.ground(elements.rows(), &[])?;
    let found = py.detach(|| strips::closed_strips(ground));
    to_strips(py, found)
}

#[pyfunction]
fn shortest_strips<'py>(
    py: Python<'py>,
    elements: Rows<'py, i32, 4>,
    topology: TopologyArrays<'py>,
    trias: List<'py, i32>,
    reach: usize,
    steps: usize,
    partners: usize,
) -> PyResult<FoundStrips<'py>> {
    let trias = trias.items();
    let ground = topology.ground(elements.rows(), trias)?;
    let limits = Limits { reach, steps, partners };
    let found = py.detach(|| strips::shortest_strips(ground, trias, limits));
    to_strips(py, found)
}

#[pyfunction]
fn transport_trias<'py>(
    py: Python<'py>,
    strips: StripArrays<'py>,
    ways: List<'py, i32>,
    points: Rows<'py, f64, 3>,
    elements: Rows<'py, i32, 4>,
) -> PyResult<ElementLists<'py>> {
    let (points, elements) = (points.rows(), elements.rows());
    let strips = strips.view(elements, points.len())?;
    let ways = ways.items().iter().map(|way| match way {
        0 => Ok(Way::Right),
        1 => Ok(Way::Left),
        2 => Ok(Way::Best),
        _ => Err(no_such_way()),
    });
    let ways = ways.collect::<PyResult<Vec<_>>>()?;
    require(ways.len() == strips.len(), "each strip needs one way")?;
    to_elements(py, py.detach(|| tria_transport::transport_trias(strips, &ways, points, elements)))
}

#[pyfunction]
fn insert_chords<'py>(
    py: Python<'py>,
    strips: StripArrays<'py>,
    ends: List<'py, i32>,
    points: Rows<'py, f64, 3>,
    elements: Rows<'py, i32, 4>,
) -> PyResult<(Replaced<'py>, PlaceLists<'py>)> {
    let (points, elements) = (points.rows(), elements.rows());
    let strips = strips.view(elements, points.len())?;
    let ends = ends.items().iter().map(|end| match end {
        0 => Ok(End::First),
        1 => Ok(End::Second),
        _ => Err(no_such_way()),
    });
    let ends = ends.collect::<PyResult<Vec<_>>>()?;
    require(ends.len() == strips.len(), "each strip needs one end")?;
    let chords = py.detach(|| chord_insertion::insert_chords(strips, &ends, points, elements));
    let places = (to_list(py, chords.points.start), to_rows(py, chords.points.items)?);
    Ok((to_replaced(py, chords.removed, chords.added)?, places))
}

#[pyfunction]
fn collapse_chords<'py>(
    py: Python<'py>,
    strips: StripArrays<'py>,
    points: Rows<'py, f64, 3>,
    elements: Rows<'py, i32, 4>,
    around: (List<'py, i32>, List<'py, i32>),
    free: List<'py, bool>,
) -> PyResult<(Replaced<'py>, MoveLists<'py>)> {
    let (points, elements, free) = (points.rows(), elements.rows(), free.items());
    let strips = strips.view(elements, points.len())?;
    let on_rungs = strips.rungs.as_flattened().iter().copied().filter(|node| *node >= 0);
    let around = check_elements_around(&around, on_rungs, elements, points.len())?;
    require(free.len() == points.len(), "each node is free or not")?;
    let ground = ChordGround { points, elements, around, free };
    let chords = py.detach(|| chord_collapse::collapse_chords(strips, ground));
    let nodes = chords.moved.items.iter().map(|moved| moved.node).collect();
    let places = chords.moved.items.iter().map(|moved| moved.place).collect();
    let moves = (to_list(py, chords.moved.start), to_list(py, nodes), to_rows(py, places)?);
    Ok((to_replaced(py, chords.removed, chords.added)?, moves))
}

fn no_such_way() -> PyErr {
    pyo3::exceptions::PyValueError::new_err("there is no such way")
}

/// Add what is here to the module.
pub fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_function(wrap_pyfunction!(straight_strips, module)?)?;
    module.add_function(wrap_pyfunction!(closed_strips, module)?)?;
    module.add_function(wrap_pyfunction!(shortest_strips, module)?)?;
    module.add_function(wrap_pyfunction!(transport_trias, module)?)?;
    module.add_function(wrap_pyfunction!(insert_chords, module)?)?;
    module.add_function(wrap_pyfunction!(collapse_chords, module)?)
}
