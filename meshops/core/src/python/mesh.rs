//! Topology of meshes and validity of elements.

use pyo3::prelude::*;

use super::arrays::{
    Array, List, Rows, Table, check_elements, check_rows, require, to_list, to_rows,
};
use crate::mesh::csr::CsrView;
use crate::mesh::element_graph::ElementGraph;
use crate::mesh::subdomain::{self, Reach};
use crate::mesh::valence::{self, Valences};
use crate::mesh::{
    Element, border_loops, components, edges, element_rings, node_elements, patch, validity,
};

type FoundEdges<'py> =
    (Table<'py, i32>, Table<'py, i32>, Table<'py, i32>, Array<'py, i32>, Array<'py, bool>);

type CutOut<'py> = (Table<'py, i32>, Array<'py, i32>, Table<'py, i32>);

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

/// Elements of a mesh, joined across the edges that may be crossed: checked once, never changed.
#[pyclass(frozen, name = "ElementGraph", module = "meshops._core")]
pub struct PyElementGraph {
    element_edges: Vec<[i32; 4]>,
    edge_elements: Vec<[i32; 2]>,
    crossable: Vec<bool>,
}

impl PyElementGraph {
    /// What is joined.
    pub fn view(&self) -> ElementGraph<'_> {
        ElementGraph {
            element_edges: &self.element_edges,
            edge_elements: &self.edge_elements,
            crossable: &self.crossable,
        }
    }

    fn check_flags(&self, flags: &[bool]) -> PyResult<()> {
        require(flags.len() == self.element_edges.len(), "each element needs one value")
    }

    fn check_element(&self, element: usize) -> PyResult<()> {
        require(element < self.element_edges.len(), "there is no such element")
    }
}

#[pymethods]
impl PyElementGraph {
    #[new]
    fn new(
        py: Python<'_>,
        element_edges: Rows<'_, i32, 4>,
        edge_elements: Rows<'_, i32, 2>,
        crossable: List<'_, bool>,
    ) -> PyResult<Self> {
        let graph = Self {
            element_edges: element_edges.rows().to_vec(),
            edge_elements: edge_elements.rows().to_vec(),
            crossable: crossable.items().to_vec(),
        };
        require(graph.crossable.len() == graph.edge_elements.len(), "each edge needs one value")?;
        let is_whole = py.detach(|| graph.view().is_whole());
        require(is_whole, "an element has an edge that is not there, or that is not at it")?;
        Ok(graph)
    }

    fn label_components<'py>(
        &self,
        py: Python<'py>,
        selected: List<'py, bool>,
    ) -> PyResult<Array<'py, i32>> {
        let selected = selected.items();
        self.check_flags(selected)?;
        Ok(to_list(py, py.detach(|| components::label_components(self.view(), selected))))
    }

    fn rings_around<'py>(
        &self,
        py: Python<'py>,
        allowed: List<'py, bool>,
        centres: List<'py, i32>,
    ) -> PyResult<Array<'py, i32>> {
        let (allowed, centres) = (allowed.items(), centres.items());
        self.check_flags(allowed)?;
        check_rows(centres, self.element_edges.len(), "there is no such element")?;
        let centres = centres.iter().map(|row| *row as usize);
        Ok(to_list(py, py.detach(|| element_rings::rings_around(self.view(), allowed, centres))))
    }

    fn nearby(
        &self,
        py: Python<'_>,
        allowed: List<'_, bool>,
        centre: usize,
        shift: usize,
    ) -> PyResult<usize> {
        let allowed = allowed.items();
        self.check_flags(allowed)?;
        self.check_element(centre)?;
        Ok(py.detach(|| element_rings::nearby(self.view(), allowed, centre, shift)))
    }

    fn disc<'py>(
        &self,
        py: Python<'py>,
        allowed: List<'py, bool>,
        centre: usize,
        most: i32,
    ) -> PyResult<Array<'py, bool>> {
        let allowed = allowed.items();
        self.check_flags(allowed)?;
        self.check_element(centre)?;
        Ok(to_list(py, py.detach(|| element_rings::disc(self.view(), allowed, centre, most))))
    }

    fn strip<'py>(
        &self,
        py: Python<'py>,
        allowed: List<'py, bool>,
        first: usize,
        last: usize,
        most: i32,
    ) -> PyResult<Array<'py, bool>> {
        let allowed = allowed.items();
        self.check_flags(allowed)?;
        self.check_element(first)?;
        self.check_element(last)?;
        let ends = [first, last];
        Ok(to_list(py, py.detach(|| element_rings::strip(self.view(), allowed, ends, most))))
    }

    fn partition<'py>(
        &self,
        py: Python<'py>,
        editable: List<'py, bool>,
        bad: List<'py, i32>,
        rings: i32,
        elements: usize,
    ) -> PyResult<Array<'py, i32>> {
        let (editable, bad) = (editable.items(), bad.items());
        self.check_flags(editable)?;
        check_rows(bad, self.element_edges.len(), "there is no such element")?;
        let bad = bad.iter().map(|row| *row as usize);
        let reach = Reach { rings, elements };
        Ok(to_list(py, py.detach(|| subdomain::partition(self.view(), editable, bad, reach))))
    }

    fn cut<'py>(
        &self,
        py: Python<'py>,
        rows: List<'py, i32>,
        elements: Rows<'py, i32, 4>,
    ) -> PyResult<CutOut<'py>> {
        let (rows, elements) = (rows.items(), elements.rows());
        require(elements.len() == self.element_edges.len(), "these are not the elements of it")?;
        check_rows(rows, elements.len(), "there is no such element")?;
        require(rows.is_sorted_by(|a, b| a < b), "the rows of a patch must ascend")?;
        let patch = py.detach(|| patch::cut(rows, elements, self.view()));
        Ok((to_rows(py, patch.elements)?, to_list(py, patch.nodes), to_rows(py, patch.border)?))
    }
}

#[pyfunction]
fn trace_loops<'py>(
    py: Python<'py>,
    border: Rows<'py, i32, 2>,
) -> (Array<'py, i32>, Array<'py, i32>) {
    let border = border.rows();
    let loops = py.detach(|| border_loops::trace_loops(border));
    (to_list(py, loops.items), to_list(py, loops.start))
}

#[pyfunction]
fn irregular_nodes<'py>(
    py: Python<'py>,
    start: List<'py, i32>,
    outside: List<'py, i32>,
) -> PyResult<Array<'py, bool>> {
    let (start, outside) = (start.items(), outside.items());
    require(start.len() == outside.len() + 1, "start needs one value more than outside")?;
    let around = CsrView { start, items: &[] };
    Ok(to_list(py, py.detach(|| valence::irregular_nodes(around, outside))))
}

#[pyfunction]
fn irregular_change<'py>(
    py: Python<'py>,
    goes: List<'py, i32>,
    comes: Rows<'py, i32, 4>,
    elements: Rows<'py, i32, 4>,
    start: List<'py, i32>,
    outside: List<'py, i32>,
) -> PyResult<i64> {
    let (goes, comes, elements) = (goes.items(), comes.rows(), elements.rows());
    let (start, outside) = (start.items(), outside.items());
    require(start.len() == outside.len() + 1, "start needs one value more than outside")?;
    check_rows(goes, elements.len(), "there is no such element")?;
    let gone: Vec<Element> = goes.iter().map(|row| elements[*row as usize]).collect();
    check_elements(&gone, outside.len())?;
    let new = comes.as_flattened().iter().max().map_or(0, |node| *node as i64 + 1);
    let nodes = outside.len().max(new.max(0) as usize);
    check_elements(comes, nodes)?;
    let valences = Valences { elements, around: CsrView { start, items: &[] }, outside };
    Ok(py.detach(|| valences.irregular_change(goes, comes, &mut vec![0; nodes])))
}

/// Add what is here to the module.
pub fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_class::<PyElementGraph>()?;
    module.add_function(wrap_pyfunction!(find_edges, module)?)?;
    module.add_function(wrap_pyfunction!(elements_of_nodes, module)?)?;
    module.add_function(wrap_pyfunction!(unit_normals, module)?)?;
    module.add_function(wrap_pyfunction!(valid_elements, module)?)?;
    module.add_function(wrap_pyfunction!(all_facing, module)?)?;
    module.add_function(wrap_pyfunction!(has_doubles, module)?)?;
    module.add_function(wrap_pyfunction!(trace_loops, module)?)?;
    module.add_function(wrap_pyfunction!(irregular_nodes, module)?)?;
    module.add_function(wrap_pyfunction!(irregular_change, module)?)
}
