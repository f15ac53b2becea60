//! Python binding of pliant: registration only.

mod arrays;
mod errors;
mod friction;
mod kernels;
mod run;
mod system;

use pyo3::prelude::*;

/// The compiled module `pliant._core`.
#[pymodule]
fn _core(module: &Bound<'_, PyModule>) -> PyResult<()> {
    let py = module.py();
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add("ModelError", py.get_type::<errors::PyModelError>())?;
    module.add("ConvergenceError", py.get_type::<errors::PyConvergenceError>())?;
    module.add_class::<system::PySystem>()?;
    module.add_class::<run::PyIntegrator>()?;
    module.add_function(wrap_pyfunction!(kernels::cable_element, module)?)?;
    module.add_function(wrap_pyfunction!(kernels::surface_shape, module)?)?;
    module.add_function(wrap_pyfunction!(friction::lugre_history, module)?)?;
    Ok(())
}
