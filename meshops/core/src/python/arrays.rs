//! NumPy arrays as slices and back, and checks of what they hold.
//!
//! Arrays that lie in memory row by row are borrowed, others copied.

use numpy::ndarray::Array2;
use numpy::{Element as Item, IntoPyArray, PyArray1, PyArray2};
use numpy::{PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::conversion::FromPyObjectOwned;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::mesh::csr::CsrView;
use crate::mesh::{Element, Facet};

/// A NumPy array of one dimension, as it is returned.
pub type Array<'py, T> = Bound<'py, PyArray1<T>>;

/// A NumPy array of two dimensions, as it is returned.
pub type Table<'py, T> = Bound<'py, PyArray2<T>>;

/// An array of one dimension.
pub enum List<'py, T: Item> {
    /// As it lies in memory.
    Borrowed(PyReadonlyArray1<'py, T>),
    /// Brought together.
    Copied(Vec<T>),
}

/// An array of rows of `W` items.
pub enum Rows<'py, T: Item, const W: usize> {
    /// As it lies in memory.
    Borrowed(PyReadonlyArray2<'py, T>),
    /// Brought together.
    Copied(Vec<T>),
}

impl<T: Item + Copy> List<'_, T> {
    /// The items.
    pub fn items(&self) -> &[T] {
        match self {
            // contiguous, or it would have been copied
            Self::Borrowed(array) => array.as_slice().unwrap_or_default(),
            Self::Copied(items) => items,
        }
    }
}

impl<T: Item + Copy, const W: usize> Rows<'_, T, W> {
    /// The rows.
    pub fn rows(&self) -> &[[T; W]] {
        let items = match self {
            Self::Borrowed(array) => array.as_slice().unwrap_or_default(),
            Self::Copied(items) => items,
        };
        items.as_chunks().0
    }
}

/// An array of rows of as many items as it happens to have.
pub struct Grid<'py, T: Item> {
    items: List<'py, T>,
    shape: [usize; 2],
}

/// The rows of a [`Grid`].
#[derive(Clone, Copy)]
pub struct GridRows<'a, T> {
    /// All items, row by row.
    pub items: &'a [T],
    /// How many rows there are.
    pub count: usize,
    /// How many items a row has.
    pub width: usize,
}

impl<T: Item + Copy> Grid<'_, T> {
    /// The rows.
    pub fn rows(&self) -> GridRows<'_, T> {
        let [count, width] = self.shape;
        GridRows { items: self.items.items(), count, width }
    }
}

impl<'a, T> GridRows<'a, T> {
    /// Row by row.
    pub fn iter(self) -> impl Iterator<Item = &'a [T]> {
        (0..self.count).map(move |row| &self.items[row * self.width..(row + 1) * self.width])
    }
}

impl<'a, 'py, T: Item + Copy> FromPyObject<'a, 'py> for Grid<'py, T> {
    type Error = PyErr;

    fn extract(object: Borrowed<'a, 'py, PyAny>) -> PyResult<Self> {
        let array = object.cast::<PyArray2<T>>()?;
        let shape = [array.shape()[0], array.shape()[1]];
        let items = if array.is_c_contiguous() {
            List::Borrowed(array.reshape([shape[0] * shape[1]])?.try_readonly()?)
        } else {
            List::Copied(array.try_readonly()?.as_array().iter().copied().collect())
        };
        Ok(Self { items, shape })
    }
}

impl<'a, 'py, T: Item + Copy> FromPyObject<'a, 'py> for List<'py, T> {
    type Error = PyErr;

    fn extract(object: Borrowed<'a, 'py, PyAny>) -> PyResult<Self> {
        let array = object.cast::<PyArray1<T>>()?.try_readonly()?;
        if array.is_c_contiguous() {
            Ok(Self::Borrowed(array))
        } else {
            Ok(Self::Copied(array.as_array().iter().copied().collect()))
        }
    }
}

impl<'a, 'py, T: Item + Copy, const W: usize> FromPyObject<'a, 'py> for Rows<'py, T, W> {
    type Error = PyErr;

    fn extract(object: Borrowed<'a, 'py, PyAny>) -> PyResult<Self> {
        let array = object.cast::<PyArray2<T>>()?.try_readonly()?;
        if array.shape()[1] != W {
            let shape = array.shape();
            let message = format!("an array of shape {shape:?} where rows of {W} are needed");
            return Err(PyValueError::new_err(message));
        }
        if array.is_c_contiguous() {
            Ok(Self::Borrowed(array))
        } else {
            let view = array.as_array();
            let mut items = Vec::with_capacity(view.len());
            for row in view.rows() {
                items.extend((0..W).map(|k| row[k]));
            }
            Ok(Self::Copied(items))
        }
    }
}

/// Take something from an object by the name of the attribute.
pub fn attribute<'py, T: FromPyObjectOwned<'py>>(
    object: &Borrowed<'_, 'py, PyAny>,
    name: &str,
) -> PyResult<T> {
    object.getattr(name)?.extract().map_err(Into::into)
}

/// Take a struct from an object whose attributes are called like its fields; errors of a field, as
/// of an array that does not fit, stay what they are.
macro_rules! from_attributes {
    ($name:ident { $($field:ident),+ }) => {
        impl<'a, 'py> FromPyObject<'a, 'py> for $name<'py> {
            type Error = PyErr;

            fn extract(object: Borrowed<'a, 'py, PyAny>) -> PyResult<Self> {
                Ok(Self { $($field: super::arrays::attribute(&object, stringify!($field))?),+ })
            }
        }
    };
}
pub(super) use from_attributes;

/// Rows as an array (n, W).
pub fn to_rows<T: Item, const W: usize>(
    py: Python<'_>,
    rows: Vec<[T; W]>,
) -> PyResult<Table<'_, T>> {
    let shape = (rows.len(), W);
    let array = Array2::from_shape_vec(shape, rows.into_flattened());
    let array = array.map_err(|error| PyValueError::new_err(error.to_string()))?;
    Ok(array.into_pyarray(py))
}

/// Items as an array (n,).
pub fn to_list<T: Item>(py: Python<'_>, items: Vec<T>) -> Array<'_, T> {
    items.into_pyarray(py)
}

/// Say that something is not as it must be.
pub fn require(holds: bool, message: &str) -> PyResult<()> {
    if holds { Ok(()) } else { Err(PyValueError::new_err(message.to_owned())) }
}

/// Elements name three or four of some nodes.
pub fn check_elements(elements: &[Element], nodes: usize) -> PyResult<()> {
    // not a loop that ends early: this one is done several elements at once
    let nodes = nodes.min(i32::MAX as usize) as u32;
    let missing = elements.iter().fold(false, |missing, [a, b, c, d]| {
        // -1 becomes 0, below which nothing is
        let fourth = (*d as u32).wrapping_add(1) > nodes;
        missing | (*a as u32 >= nodes) | (*b as u32 >= nodes) | (*c as u32 >= nodes) | fourth
    });
    require(!missing, "an element names a node that is not there")
}

/// Elements in some rows are there, and name three or four of some nodes.
pub fn check_elements_at(rows: &[i32], elements: &[Element], nodes: usize) -> PyResult<()> {
    check_rows(rows, elements.len(), "there is no such element")?;
    rows.iter().try_for_each(|row| check_elements(&elements[*row as usize..][..1], nodes))
}

/// Facets name three of some points.
pub fn check_facets(facets: &[Facet], points: usize) -> PyResult<()> {
    let all = facets.as_flattened();
    check_rows(all, points, "a facet names a point that is not there")
}

/// All are rows of something that has so many.
pub fn check_rows(rows: &[i32], count: usize, message: &str) -> PyResult<()> {
    let count = count.min(i32::MAX as usize) as u32;
    let missing = rows.iter().fold(false, |missing, row| missing | (*row as u32 >= count));
    require(!missing, message)
}

/// The lists of some nodes, for each node one, are of elements that name nodes.
///
/// Other lists are not looked at, so the cost grows with those that are.
pub fn check_elements_around<'a>(
    (start, items): &'a (List<'_, i32>, List<'_, i32>),
    asked: impl IntoIterator<Item = i32>,
    elements: &[Element],
    nodes: usize,
) -> PyResult<CsrView<'a>> {
    let (start, items) = (start.items(), items.items());
    require(start.len() == nodes + 1, "each node needs one list")?;
    for node in asked {
        check_rows(&[node], nodes, "there is no such node")?;
        let ends = [start[node as usize], start[node as usize + 1]];
        let range = ends.map(|end| usize::try_from(end).unwrap_or(usize::MAX));
        let list = items.get(range[0]..range[1]);
        require(list.is_some(), "lists do not lie one behind the other")?;
        check_elements_at(list.unwrap_or_default(), elements, nodes)?;
    }
    Ok(CsrView { start, items })
}

/// Lists, so many, of rows of something.
pub fn check_lists<'a>(
    (start, items): &'a (List<'_, i32>, List<'_, i32>),
    lists: usize,
    count: usize,
) -> PyResult<CsrView<'a>> {
    check_csr(CsrView { start: start.items(), items: items.items() }, lists, count)
}

/// Lists, so many, of rows of something that has `count` of them.
pub fn check_csr(csr: CsrView<'_>, lists: usize, count: usize) -> PyResult<CsrView<'_>> {
    let CsrView { start, items } = csr;
    require(start.len() == lists + 1, "there is not the right number of lists")?;
    check_starts(start, items.len())?;
    check_rows(items, count, "a list names a row that is not there")?;
    Ok(csr)
}

/// Lists of so many items in all lie one behind the other.
pub fn check_starts(start: &[i32], items: usize) -> PyResult<()> {
    let rises = start.windows(2).fold(true, |rises, pair| rises & (pair[0] <= pair[1]));
    let fits = rises
        && start.first() == Some(&0)
        && start.last().is_some_and(|end| *end as usize == items);
    require(fits, "lists do not lie one behind the other")
}
