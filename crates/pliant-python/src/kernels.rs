//! Single elements, for tests and teaching.

use crate::arrays::{row, table};
use crate::errors::{PyModelError, model_error};
use numpy::{PyArray1, PyReadonlyArray1, PyReadonlyArray2};
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

/// Shape functions of a surface element with their derivatives, (nodal vectors, 6).
#[pyfunction]
pub fn surface_shape<'py>(
    py: Python<'py>,
    kind: &str,
    chart: PyReadonlyArray2<'py, f64>,
    at: [f64; 2],
) -> PyResult<Bound<'py, numpy::PyArray2<f64>>> {
    let (flat, n) = crate::arrays::rows(&chart, "chart", 2)?;
    let mut corners = [[0.0; 2]; 4];
    for (k, corner) in corners.iter_mut().enumerate().take(n) {
        *corner = [flat[2 * k], flat[2 * k + 1]];
    }
    let rows =
        teaching::surface_shape(kind, &corners.into(), at).map_err(|error| model_error(&error))?;
    table(py, rows.into_flattened(), 6)
}
