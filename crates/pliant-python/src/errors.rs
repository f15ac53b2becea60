//! The one mapping from Rust errors to Python exceptions.

use pliant_dae::error::Error;
use pliant_multibody::error::ModelError;
use pyo3::create_exception;
use pyo3::exceptions::{PyRuntimeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyDict;

create_exception!(_core, PyModelError, PyValueError, "A model document is wrong.");
create_exception!(_core, PyConvergenceError, PyRuntimeError, "A solve failed.");

/// A wrong model, or bytes that are no saved run.
pub fn model_error(error: &ModelError) -> PyErr {
    PyModelError::new_err(error.to_string())
}

/// A failed solve: wrong options and starts are the caller's, the rest is a matter of convergence.
pub fn solve_error(py: Python<'_>, error: &Error) -> PyErr {
    match error {
        Error::SpectralRadius { .. }
        | Error::UndampedConstraints { .. }
        | Error::Length { .. }
        | Error::Value { .. }
        | Error::Contradictory { .. }
        | Error::ConstraintViolated { .. } => PyModelError::new_err(error.to_string()),
        _ => match details(py, error) {
            Ok(details) => PyConvergenceError::new_err((error.to_string(), details.unbind())),
            Err(error) => error,
        },
    }
}

fn details<'py>(py: Python<'py>, error: &Error) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    match error {
        Error::NotConverged(failure)
        | Error::NotFinite(failure)
        | Error::Barred { failure, .. } => {
            dict.set_item("time", failure.t)?;
            dict.set_item("step", failure.h)?;
            dict.set_item("iterations", failure.iterations)?;
            dict.set_item("residuals", failure.increments.clone())?;
            dict.set_item("unknown", &failure.name)?;
        }
        Error::Accuracy(what) => {
            dict.set_item("time", what.t)?;
            dict.set_item("step", what.h)?;
            dict.set_item("error_estimate", what.estimate)?;
            dict.set_item("unknown", &what.name)?;
        }
        Error::Singular { t, name, .. } | Error::Unstable { t, name, .. } => {
            dict.set_item("time", t)?;
            dict.set_item("unknown", name)?;
        }
        Error::Evaluation { t, .. } | Error::Interrupted { t } => dict.set_item("time", t)?,
        _ => {}
    }
    Ok(dict)
}
