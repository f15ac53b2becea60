//! Laws of friction alone.

use crate::arrays::{row, rows, table};
use crate::errors::PyModelError;
use numpy::{PyArray2, PyReadonlyArray1, PyReadonlyArray2};
use pliant_contact::friction::{LuGre, lugre};
use pyo3::prelude::*;

/// Force and deflection along a history; see `pliant.lugre`.
#[pyfunction]
#[pyo3(name = "lugre")]
#[allow(clippy::type_complexity)]
pub fn lugre_history<'py>(
    py: Python<'py>,
    coefficients: PyReadonlyArray1<'py, f64>,
    time: PyReadonlyArray1<'py, f64>,
    velocity: PyReadonlyArray2<'py, f64>,
    normal: PyReadonlyArray1<'py, f64>,
    end_rule: bool,
) -> PyResult<(Bound<'py, PyArray2<f64>>, Bound<'py, PyArray2<f64>>)> {
    let c = row(&coefficients, "coefficients", 7)?;
    let (velocity, n) = rows(&velocity, "velocity", 3)?;
    let (time, normal) = (row(&time, "time", n)?, row(&normal, "normal_force", n)?);
    let [mu_s, mu_d, v_s, alpha, sigma_0, sigma_1, sigma_2] =
        <[f64; 7]>::try_from(c).map_err(|_| PyModelError::new_err("seven coefficients"))?;
    let law = LuGre {
        mu_s,
        mu_d,
        v_s,
        alpha,
        sigma_0,
        sigma_1,
        sigma_2,
        scaled: false,
        v_d: f64::INFINITY,
    };
    let velocity: Vec<[f64; 3]> = velocity.chunks_exact(3).map(|v| [v[0], v[1], v[2]]).collect();
    let (force, bristle) = py.detach(|| lugre::history(&law, &time, &velocity, &normal, end_rule));
    let flat = |rows: Vec<[f64; 3]>| rows.into_iter().flatten().collect();
    Ok((table(py, flat(force), 3)?, table(py, flat(bristle), 3)?))
}
