//! Arrays of Python as numbers of our own: a copy, which no other thread of Python can change meanwhile.

use crate::errors::input;
use numpy::{
    Element, IntoPyArray, PyArray1, PyArray2, PyArray3, PyArrayMethods, PyReadonlyArrayDyn,
    PyUntypedArrayMethods,
};
use pyo3::prelude::*;

/// Numbers beside each other, of Python.
pub type Numbers<'py, T> = Bound<'py, PyArray1<T>>;

/// Rows of numbers.
#[derive(Clone, Debug)]
pub struct Table<T> {
    /// How many rows.
    pub count: usize,
    /// Row after row.
    pub numbers: Vec<T>,
}

impl<T: Copy> Table<T> {
    /// The row of this number; of a table of one row that row.
    pub fn row(&self, k: usize) -> &[T] {
        let width = self.numbers.len().checked_div(self.count).unwrap_or(0);
        let k = if self.count == 1 { 0 } else { k };
        self.numbers.get(k * width..(k + 1) * width).unwrap_or_default()
    }
}

/// The rows of an array whose last axes have these lengths, all axes before them being one.
pub fn table<T: Element + Copy>(
    what: &str,
    array: &PyReadonlyArrayDyn<T>,
    last: &[usize],
) -> PyResult<Table<T>> {
    let shape = array.shape();
    let split = shape.len().checked_sub(last.len()).filter(|split| shape[*split..] == *last);
    let Some(split) = split else {
        return Err(input(format!("{what} has the shape {shape:?}; its last axes must be {last:?}")));
    };
    // Of an array in another order the numbers go by its axes, not as they lie in memory.
    let numbers = match array.as_slice() {
        Ok(numbers) if array.is_c_contiguous() => numbers.to_vec(),
        _ => array.as_array().iter().copied().collect(),
    };
    Ok(Table { count: shape[..split].iter().product(), numbers })
}

/// An array of rows.
pub fn rows<T: Element>(
    py: Python<'_>,
    numbers: Vec<T>,
    [count, width]: [usize; 2],
) -> PyResult<Bound<'_, PyArray2<T>>> {
    numbers.into_pyarray(py).reshape([count, width])
}

/// An array of tables.
pub fn tables<T: Element>(
    py: Python<'_>,
    numbers: Vec<T>,
    shape: [usize; 3],
) -> PyResult<Bound<'_, PyArray3<T>>> {
    numbers.into_pyarray(py).reshape(shape)
}
