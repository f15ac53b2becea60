//! Between numpy arrays and slices. Inputs are copied before the interpreter is released.

use crate::errors::PyModelError;
use numpy::{PyArray2, PyArray3, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;

/// A row of numbers of known length.
pub fn row(array: &PyReadonlyArray1<'_, f64>, what: &str, expected: usize) -> PyResult<Vec<f64>> {
    let numbers: Vec<f64> = array.as_array().iter().copied().collect();
    if numbers.len() == expected {
        Ok(numbers)
    } else {
        Err(PyModelError::new_err(format!(
            "{what} must hold {expected} numbers, got {}",
            numbers.len()
        )))
    }
}

/// Rows of numbers of known length, one after the other, and their number.
pub fn rows(
    array: &PyReadonlyArray2<'_, f64>,
    what: &str,
    expected: usize,
) -> PyResult<(Vec<f64>, usize)> {
    let view = array.as_array();
    if view.ncols() == expected {
        Ok((view.iter().copied().collect(), view.nrows()))
    } else {
        Err(PyModelError::new_err(format!(
            "{what} must have {expected} columns, got {}",
            view.ncols()
        )))
    }
}

/// An array of shape (n, columns).
pub fn table(
    py: Python<'_>,
    numbers: Vec<f64>,
    columns: usize,
) -> PyResult<Bound<'_, PyArray2<f64>>> {
    let n = numbers.len().checked_div(columns).unwrap_or(0);
    numpy::PyArray1::from_vec(py, numbers).reshape([n, columns])
}

/// An array of shape (n, rows, 3).
pub fn vectors(
    py: Python<'_>,
    numbers: Vec<f64>,
    rows: usize,
) -> PyResult<Bound<'_, PyArray3<f64>>> {
    let n = numbers.len().checked_div(3 * rows).unwrap_or(0);
    numpy::PyArray1::from_vec(py, numbers).reshape([n, rows, 3])
}
