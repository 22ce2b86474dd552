//! Quality of elements and meshes.

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use super::arrays::{Array, List, Rows, Table, check_elements, require, to_list, to_rows};
use crate::quality::element_quality::ElementFaults;
use crate::quality::fitness::{Fitness, Limits};
use crate::quality::measures;
use crate::quality::penalty;
use crate::quality::sums::SUMS;
use crate::quality::{CRITERIA, Levels, QualitySums, Scoring, Sizing};

/// Criteria at one target element size, as Python hands them over.
#[pyclass(frozen, name = "Scoring", module = "meshops._core")]
pub struct PyScoring(pub Scoring);

#[pymethods]
impl PyScoring {
    #[new]
    fn new(
        levels: Rows<'_, f64, 6>,
        weights: List<'_, f64>,
        active: List<'_, bool>,
        penalties: List<'_, f64>,
        sizing: List<'_, f64>,
    ) -> PyResult<Self> {
        let levels: [[f64; 6]; CRITERIA + 1] = exactly(levels.rows())?;
        let sizing: [f64; 7] = exactly(sizing.items())?;
        Ok(Self(Scoring {
            levels: levels.map(Levels::from),
            weights: exactly(weights.items())?,
            active: exactly(active.items())?,
            penalties: exactly(penalties.items())?,
            sizing: Sizing::from(sizing),
        }))
    }
}

/// How meshes are ordered.
#[pyclass(frozen, name = "Fitness", module = "meshops._core")]
pub struct PyFitness(pub Fitness);

#[pymethods]
impl PyFitness {
    #[new]
    fn new(limits: [f64; 3], share: f64, irregularity: f64, trias_first: bool) -> Self {
        let [shape, trias, size] = limits;
        Self(Fitness { limits: Limits { shape, trias, size }, share, irregularity, trias_first })
    }

    fn of<'py>(
        &self,
        py: Python<'py>,
        sums: Rows<'py, f64, SUMS>,
        prices: List<'py, f64>,
        scoring: &Bound<'py, PyScoring>,
    ) -> PyResult<Array<'py, f64>> {
        let (rows, prices, scoring) = (sums.rows(), prices.items(), &scoring.get().0);
        require(rows.len() == prices.len(), "each mesh needs one price")?;
        let fitness = py.detach(|| {
            let each = rows.iter().zip(prices);
            each.map(|(row, price)| self.0.of(&row.into(), *price, scoring)).collect()
        });
        Ok(to_list(py, fitness))
    }
}

/// Items of which there are as many as are needed.
pub fn exactly<T: Copy, const N: usize>(items: &[T]) -> PyResult<[T; N]> {
    items
        .try_into()
        .map_err(|_| PyValueError::new_err(format!("{} values where {N} are needed", items.len())))
}

#[pyfunction]
fn measure_elements<'py>(
    py: Python<'py>,
    points: Rows<'py, f64, 3>,
    elements: Rows<'py, i32, 4>,
    sizing: List<'py, f64>,
) -> PyResult<Table<'py, f64>> {
    let (points, elements) = (points.rows(), elements.rows());
    let sizing = Sizing::from(exactly::<_, 7>(sizing.items())?);
    check_elements(elements, points.len())?;
    let values = py.detach(|| measures::measure_elements(points, elements, &sizing));
    to_rows(py, values)
}

#[pyfunction]
fn element_faults<'py>(
    py: Python<'py>,
    points: Rows<'py, f64, 3>,
    elements: Rows<'py, i32, 4>,
    scoring: &Bound<'py, PyScoring>,
) -> PyResult<Table<'py, f64>> {
    let (points, elements, scoring) = (points.rows(), elements.rows(), &scoring.get().0);
    check_elements(elements, points.len())?;
    let faults = py.detach(|| {
        let each = elements.iter().map(|element| ElementFaults::of(points, *element, scoring));
        each.map(|found| [found.shape, found.size, found.index]).collect()
    });
    to_rows(py, faults)
}

#[pyfunction]
fn penalise<'py>(
    py: Python<'py>,
    values: Rows<'py, f64, CRITERIA>,
    scoring: &Bound<'py, PyScoring>,
) -> PyResult<Table<'py, f64>> {
    let (values, scoring) = (values.rows(), &scoring.get().0);
    let penalties =
        py.detach(|| values.iter().map(|row| penalty::penalise(row, scoring)).collect());
    to_rows(py, penalties)
}

#[pyfunction]
fn penalty_of(value: f64, criterion: usize, scoring: &Bound<'_, PyScoring>) -> PyResult<f64> {
    let scoring = &scoring.get().0;
    require(criterion <= CRITERIA, "there is no such criterion")?;
    Ok(penalty::penalty(value, &scoring.levels[criterion], &scoring.penalties))
}

#[pyfunction]
fn sum_measures<'py>(
    py: Python<'py>,
    values: Rows<'py, f64, CRITERIA>,
    is_tria: List<'py, bool>,
    scoring: &Bound<'py, PyScoring>,
) -> PyResult<Array<'py, f64>> {
    let (values, is_tria, scoring) = (values.rows(), is_tria.items(), &scoring.get().0);
    require(values.len() == is_tria.len(), "is_tria needs one value an element")?;
    let sums = py.detach(|| QualitySums::of_measures(values, is_tria, scoring));
    Ok(to_list(py, sums.to_array().to_vec()))
}

#[pyfunction]
fn sum_elements<'py>(
    py: Python<'py>,
    points: Rows<'py, f64, 3>,
    elements: Rows<'py, i32, 4>,
    scoring: &Bound<'py, PyScoring>,
) -> PyResult<Array<'py, f64>> {
    let (points, elements, scoring) = (points.rows(), elements.rows(), &scoring.get().0);
    check_elements(elements, points.len())?;
    let sums = py.detach(|| QualitySums::of_elements(points, elements, scoring));
    Ok(to_list(py, sums.to_array().to_vec()))
}

#[pyfunction]
fn criterion_indices<'py>(py: Python<'py>, sums: List<'py, f64>) -> PyResult<Array<'py, f64>> {
    let sums = QualitySums::from(&exactly(sums.items())?);
    Ok(to_list(py, sums.criteria.iter().map(|criterion| criterion.index()).collect()))
}

#[pyfunction]
fn percent_trias(sums: List<'_, f64>) -> PyResult<f64> {
    Ok(QualitySums::from(&exactly(sums.items())?).percent_trias())
}

#[pyfunction]
fn compound_index(sums: List<'_, f64>, scoring: &Bound<'_, PyScoring>) -> PyResult<f64> {
    Ok(QualitySums::from(&exactly(sums.items())?).compound_index(&scoring.get().0))
}

#[pyfunction]
fn compound_indices<'py>(
    py: Python<'py>,
    sums: Rows<'py, f64, SUMS>,
    scoring: &Bound<'py, PyScoring>,
) -> PyResult<Array<'py, f64>> {
    let (rows, scoring) = (sums.rows(), &scoring.get().0);
    let indices = py.detach(|| {
        let each = rows.iter().map(QualitySums::from);
        each.map(
            |sums| {
                if sums.elements.is_nan() { f64::NAN } else { sums.compound_index(scoring) }
            },
        )
        .collect()
    });
    Ok(to_list(py, indices))
}

/// Add what is here to the module.
pub fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_class::<PyScoring>()?;
    module.add_class::<PyFitness>()?;
    module.add_function(wrap_pyfunction!(measure_elements, module)?)?;
    module.add_function(wrap_pyfunction!(element_faults, module)?)?;
    module.add_function(wrap_pyfunction!(penalise, module)?)?;
    module.add_function(wrap_pyfunction!(penalty_of, module)?)?;
    module.add_function(wrap_pyfunction!(sum_measures, module)?)?;
    module.add_function(wrap_pyfunction!(sum_elements, module)?)?;
    module.add_function(wrap_pyfunction!(criterion_indices, module)?)?;
    module.add_function(wrap_pyfunction!(percent_trias, module)?)?;
    module.add_function(wrap_pyfunction!(compound_index, module)?)?;
    module.add_function(wrap_pyfunction!(compound_indices, module)?)
}
