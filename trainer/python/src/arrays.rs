//! Conversion of Python arrays: each is copied, so that no other Python thread can change it meanwhile.

use crate::errors::input;
use numpy::{
    Element, IntoPyArray, PyArray1, PyArray2, PyArray3, PyArrayMethods, PyReadonlyArrayDyn,
    PyUntypedArrayMethods,
};
use pyo3::prelude::*;

/// A one-dimensional Python array.
pub type Numbers<'py, T> = Bound<'py, PyArray1<T>>;

/// Rows of numbers.
#[derive(Clone, Debug)]
pub struct Table<T> {
    /// Number of rows.
    pub count: usize,
    /// Numbers, row by row.
    pub numbers: Vec<T>,
}

impl<T: Copy> Table<T> {
    /// Row `k`; a table with a single row gives that row for every `k`.
    pub fn row(&self, k: usize) -> &[T] {
        let width = self.numbers.len().checked_div(self.count).unwrap_or(0);
        let k = if self.count == 1 { 0 } else { k };
        self.numbers.get(k * width..(k + 1) * width).unwrap_or_default()
    }
}

/// The rows of an array whose last axes have these lengths; all axes before them are merged.
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
    // Numbers of an array in another memory order are taken in the order of its axes.
    let numbers = match array.as_slice() {
        Ok(numbers) if array.is_c_contiguous() => numbers.to_vec(),
        _ => array.as_array().iter().copied().collect(),
    };
    Ok(Table { count: shape[..split].iter().product(), numbers })
}

/// A two-dimensional array of rows.
pub fn rows<T: Element>(
    py: Python<'_>,
    numbers: Vec<T>,
    [count, width]: [usize; 2],
) -> PyResult<Bound<'_, PyArray2<T>>> {
    numbers.into_pyarray(py).reshape([count, width])
}

/// A three-dimensional array.
pub fn tables<T: Element>(
    py: Python<'_>,
    numbers: Vec<T>,
    shape: [usize; 3],
) -> PyResult<Bound<'_, PyArray3<T>>> {
    numbers.into_pyarray(py).reshape(shape)
}
