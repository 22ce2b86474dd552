//! Annealing of patches.

use numpy::{PyReadonlyArray3, PyUntypedArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use super::arrays::{List, Rows, Table, check_elements, require, to_rows};
use super::ground::PyGround;
use super::quality::{PyScoring, exactly};
use crate::annealing::{Cooling, Prices, Site, SiteSurface, WantedSizes, anneal};
use crate::quality::node_score::Ground;
use crate::surface::FacetTree;
use crate::vectors::Vector;

/// What each lack costs.
#[pyclass(frozen, name = "AnnealingPrices", module = "meshops._core")]
pub struct PyPrices(Prices);

#[pymethods]
impl PyPrices {
    #[new]
    #[pyo3(signature = (*, shape, tria, irregular, invalid, size))]
    fn new(shape: f64, tria: f64, irregular: f64, invalid: f64, size: f64) -> Self {
        Self(Prices { shape, tria, irregular, invalid, size })
    }
}

/// How fast an annealing cools down.
#[pyclass(frozen, name = "Cooling", module = "meshops._core")]
pub struct PyCooling(Cooling);

#[pymethods]
impl PyCooling {
    #[new]
    #[pyo3(signature = (*, hot, cold, trials))]
    fn new(hot: f64, cold: f64, trials: usize) -> Self {
        Self(Cooling { hot, cold, trials })
    }
}

/// Edge lengths that are wanted, by the cubes of a grid.
#[pyclass(frozen, name = "WantedSizes", module = "meshops._core")]
pub struct PyWantedSizes {
    sizes: Vec<f64>,
    shape: [usize; 3],
    origin: Vector,
    cell: f64,
}

impl PyWantedSizes {
    fn wanted(&self) -> WantedSizes<'_> {
        WantedSizes { sizes: &self.sizes, shape: self.shape, origin: self.origin, cell: self.cell }
    }
}

#[pymethods]
impl PyWantedSizes {
    #[new]
    fn new(sizes: PyReadonlyArray3<'_, f64>, origin: List<'_, f64>, cell: f64) -> PyResult<Self> {
        require(!sizes.is_empty(), "there is no size that is wanted")?;
        Ok(Self {
            sizes: sizes.as_array().iter().copied().collect(),
            shape: exactly(sizes.shape())?,
            origin: exactly(origin.items())?,
            cell,
        })
    }
}

/// Where a patch lies.
#[pyclass(frozen, name = "AnnealingSite", module = "meshops._core")]
pub struct PySite {
    outside: Vec<i32>,
    fixed: i32,
    plane: Option<Vector>,
    ground: Py<PyGround>,
    wanted: Py<PyWantedSizes>,
}

#[pymethods]
impl PySite {
    #[new]
    #[pyo3(signature = (*, outside, fixed, plane, ground, wanted))]
    fn new(
        outside: List<'_, i32>,
        fixed: i32,
        plane: Option<List<'_, f64>>,
        ground: Py<PyGround>,
        wanted: Py<PyWantedSizes>,
    ) -> PyResult<Self> {
        let outside = outside.items().to_vec();
        let count = usize::try_from(fixed);
        require(count.is_ok_and(|fixed| fixed <= outside.len()), "more nodes stay than there are")?;
        let plane = plane.map(|normal| exactly(normal.items())).transpose()?;
        Ok(Self { outside, fixed, plane, ground, wanted })
    }
}

fn curved(ground: &Ground<'_>) -> PyResult<SiteSurface> {
    let facets = FacetTree::new(&ground.surface);
    let facets = facets.ok_or_else(|| PyValueError::new_err("there is no facet to be near to"))?;
    Ok(SiteSurface::Curved { facets, tolerance: ground.tolerance })
}

type Found<'py> = (Table<'py, f64>, Table<'py, i32>, f64, f64);

#[pyfunction(name = "anneal")]
fn anneal_patch<'py>(
    points: Rows<'py, f64, 3>,
    elements: Rows<'py, i32, 4>,
    site: &Bound<'py, PySite>,
    prices: &Bound<'py, PyPrices>,
    scoring: &Bound<'py, PyScoring>,
    cooling: &Bound<'py, PyCooling>,
    seed: i64,
) -> PyResult<Option<Found<'py>>> {
    let py = site.py();
    let (points, elements, place) = (points.rows(), elements.rows(), site.get());
    check_elements(elements, points.len())?;
    let outside = place.outside.as_slice();
    require(outside.len() == points.len(), "each node needs one number of elements outside")?;
    let ground = place.ground.get().rows(py)?;
    let surface = match place.plane {
        Some(normal) => SiteSurface::Plane { normal },
        None => curved(&ground.ground())?,
    };
    let wanted = place.wanted.get().wanted();
    let site = Site { surface, fixed: place.fixed, outside, wanted };
    let (prices, scoring, cooling) = (&prices.get().0, &scoring.get().0, cooling.get().0);
    let annealed = py.detach(|| anneal(points, elements, &site, prices, scoring, cooling, seed));
    let Some(annealed) = annealed else {
        return Ok(None);
    };
    let (points, elements) = (to_rows(py, annealed.points)?, to_rows(py, annealed.elements)?);
    Ok(Some((points, elements, annealed.before, annealed.after)))
}

/// Add what is here to the module.
pub fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_class::<PyPrices>()?;
    module.add_class::<PyCooling>()?;
    module.add_class::<PyWantedSizes>()?;
    module.add_class::<PySite>()?;
    module.add_function(wrap_pyfunction!(anneal_patch, module)?)
}
