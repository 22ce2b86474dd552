//! The surface that changed elements must stay on.

use pyo3::prelude::*;

use super::arrays::{Rows, check_facets, require};
use crate::quality::node_score::Ground;
use crate::surface::Surface;

/// A surface, and what elements on it must keep to. It has no facets where it is plane.
///
/// The arrays are not copied: a surface may be that of a large mesh, of which a patch sees little.
#[pyclass(frozen, name = "Ground", module = "meshops._core")]
pub struct PyGround {
    points: Py<PyAny>,
    facets: Py<PyAny>,
    spheres: Py<PyAny>,
    tolerance: f64,
    least_corner: f64,
}

/// A ground whose arrays have been looked at.
pub struct GroundRows<'py> {
    points: Rows<'py, f64, 3>,
    facets: Rows<'py, i32, 3>,
    spheres: Rows<'py, f64, 4>,
    tolerance: f64,
    least_corner: f64,
}

impl PyGround {
    /// Borrow the arrays, and see that they fit each other.
    pub fn rows<'py>(&self, py: Python<'py>) -> PyResult<GroundRows<'py>> {
        let rows = GroundRows {
            points: self.points.bind(py).extract()?,
            facets: self.facets.bind(py).extract()?,
            spheres: self.spheres.bind(py).extract()?,
            tolerance: self.tolerance,
            least_corner: self.least_corner,
        };
        let Surface { points, facets, spheres } = rows.ground().surface;
        check_facets(facets, points.len())?;
        require(facets.len() == spheres.len(), "each facet needs one sphere")?;
        Ok(rows)
    }
}

impl GroundRows<'_> {
    /// The ground as the core takes it.
    pub fn ground(&self) -> Ground<'_> {
        Ground {
            surface: Surface {
                points: self.points.rows(),
                facets: self.facets.rows(),
                spheres: self.spheres.rows(),
            },
            tolerance: self.tolerance,
            least_corner: self.least_corner,
        }
    }
}

#[pymethods]
impl PyGround {
    #[new]
    fn new(
        py: Python<'_>,
        points: Py<PyAny>,
        facets: Py<PyAny>,
        spheres: Py<PyAny>,
        tolerance: f64,
        least_corner: f64,
    ) -> PyResult<Self> {
        let ground = Self { points, facets, spheres, tolerance, least_corner };
        ground.rows(py)?;
        Ok(ground)
    }
}

/// Add what is here to the module.
pub fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_class::<PyGround>()
}
