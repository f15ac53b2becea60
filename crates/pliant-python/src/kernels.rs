//! Single elements, for tests and teaching.

use crate::arrays::{row, table};
use crate::errors::{PyModelError, model_error};
use numpy::{PyArray1, PyReadonlyArray1};
use pliant_multibody::teaching;
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// Energy, force and matrices of one cable element.
#[pyfunction]
pub fn cable_element<'py>(
    py: Python<'py>,
    cable: &str,
    q: PyReadonlyArray1<'py, f64>,
    v: PyReadonlyArray1<'py, f64>,
) -> PyResult<Bound<'py, PyDict>> {
    let (q, v) = (row(&q, "q", 12)?, row(&v, "v", 12)?);
    let cable = serde_json::from_str(cable)
        .map_err(|error| PyModelError::new_err(format!("the cable cannot be read: {error}")))?;
    let element = teaching::cable_element(&cable, &q, &v).map_err(|error| model_error(&error))?;
    let dict = PyDict::new(py);
    dict.set_item("energy", element.energy)?;
    dict.set_item("force", PyArray1::from_vec(py, element.force))?;
    dict.set_item("tangent", table(py, element.tangent, 12)?)?;
    dict.set_item("damping", table(py, element.damping, 12)?)?;
    dict.set_item("mass", table(py, element.mass, 12)?)?;
    Ok(dict)
}
