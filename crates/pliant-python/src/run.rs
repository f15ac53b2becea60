//! Runs in progress.

use crate::arrays::table;
use crate::errors::{model_error, solve_error};
use numpy::{PyArray1, PyArray2};
use pliant_dae::step_control::StepControl;
use pliant_multibody::checkpoint::Saved;
use pliant_multibody::contact_coupling::memory::PATCH;
use pliant_multibody::latches::Switch;
use pliant_multibody::run::{FreeLeg, Leg, Records, Run};
use pliant_multibody::system::Inputs;
use pyo3::exceptions::PyIndexError;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

/// A run in progress.
#[pyclass(name = "Integrator", module = "pliant._core")]
pub struct PyIntegrator {
    /// A run may move between threads but not be shared: the lock, never contended, says so.
    pub run: Mutex<Run>,
    pub failure: CallbackFailure,
    pub sizes: [usize; 3],
    /// By how much joints changed the initial velocities.
    pub projection: f64,
}

/// The exception that the caller's function of time raised, kept until the solve has returned.
pub type CallbackFailure = Arc<Mutex<Option<PyErr>>>;

/// Wraps a Python function of time.
pub fn inputs(callback: Option<Py<PyAny>>, failure: &CallbackFailure) -> Option<Inputs> {
    let callback = callback?;
    let failure = failure.clone();
    Some(Box::new(move |t| {
        Python::attach(|py| callback.bind(py).call1((t,))?.extract::<Vec<f64>>()).map_err(
            |error: PyErr| {
                let message = error.to_string();
                if let Ok(mut slot) = failure.lock() {
                    *slot = Some(error);
                }
                message
            },
        )
    }))
}

/// The exception to raise for a failed solve: the caller's own where one of its functions failed.
pub fn raise(py: Python<'_>, failure: &CallbackFailure, error: &pliant_dae::error::Error) -> PyErr {
    match failure.lock().ok().and_then(|mut slot| slot.take()) {
        Some(raised) => raised,
        None => solve_error(py, error),
    }
}

/// Records as arrays.
pub fn records<'py>(
    py: Python<'py>,
    records: Records,
    [nq, nv, nl]: [usize; 3],
) -> PyResult<Bound<'py, PyDict>> {
    let n = records.time.len();
    let dict = PyDict::new(py);
    dict.set_item("time", PyArray1::from_vec(py, records.time))?;
    dict.set_item("q", table(py, records.q, nq)?)?;
    dict.set_item("v", table(py, records.v, nv)?)?;
    dict.set_item("a", table(py, records.a, nv)?)?;
    let some = |numbers: Vec<f64>, columns: usize| {
        if columns == 0 || n == 0 {
            Ok(PyArray2::zeros(py, [n, columns], false))
        } else {
            table(py, numbers, columns)
        }
    };
    let held = records.inputs.len().checked_div(n).unwrap_or(0);
    dict.set_item("lambda_", some(records.lambda_, nl)?)?;
    dict.set_item("energy", table(py, records.energy, 5)?)?;
    dict.set_item("switches", PyArray1::from_vec(py, records.switches))?;
    dict.set_item("history", history(py, &records.history)?)?;
    dict.set_item("inputs", some(records.inputs, held)?)?;
    let shown = records.outputs.len().checked_div(n).unwrap_or(0);
    dict.set_item("outputs", some(records.outputs, shown)?)?;
    dict.set_item("touching", PyArray1::from_vec(py, records.touching))?;
    let patches = records.patches.into_flattened();
    dict.set_item("patches", some(patches, PATCH)?)?;
    Ok(dict)
}

/// What joints were made to do, one a row: time, joint, engaged, gap, size of the pose, pose, zeros.
fn history<'py>(py: Python<'py>, history: &[Switch]) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let width = history.iter().map(|s| s.pose.len()).max().unwrap_or(0);
    let mut flat = Vec::with_capacity(history.len() * (5 + width));
    for s in history {
        let head =
            [s.t, s.joint as f64, f64::from(u8::from(s.engaged)), s.gap, s.pose.len() as f64];
        flat.extend(head);
        flat.extend(s.pose.iter().copied().chain(std::iter::repeat(0.0)).take(width));
    }
    if history.is_empty() {
        return Ok(PyArray2::zeros(py, [0, 5], false));
    }
    table(py, flat, 5 + width)
}

impl PyIntegrator {
    fn run(&mut self) -> &mut Run {
        self.run.get_mut().unwrap_or_else(PoisonError::into_inner)
    }
}

#[pymethods]
impl PyIntegrator {
    #[getter]
    fn time(&mut self) -> f64 {
        self.run().state().t
    }

    #[getter]
    fn steps(&mut self) -> u64 {
        self.run().steps()
    }

    #[getter]
    fn projection(&self) -> f64 {
        self.projection
    }

    #[pyo3(signature = (steps, step, output_every = 0, *, end = None, seconds = 0.1))]
    fn advance(
        &mut self,
        py: Python<'_>,
        steps: u64,
        step: f64,
        output_every: u64,
        end: Option<f64>,
        seconds: f64,
    ) -> PyResult<u64> {
        let limit = Duration::try_from_secs_f64(seconds).unwrap_or(Duration::MAX);
        let run = self.run();
        let leg = Leg { steps, step, end, output_every };
        let taken = py.detach(|| run.advance(leg, limit));
        taken.map_err(|error| raise(py, &self.failure, &error))
    }

    #[getter]
    fn next_event(&mut self) -> Option<f64> {
        self.run().next_event()
    }

    #[pyo3(signature = (joint, engage, gap = None))]
    fn switch(
        &mut self,
        py: Python<'_>,
        joint: usize,
        engage: bool,
        gap: Option<f64>,
    ) -> PyResult<()> {
        let run = self.run();
        let outcome = py.detach(|| run.switch(joint, engage, gap));
        outcome.map_err(|error| raise(py, &self.failure, &error))
    }

    #[pyo3(signature = (end, *, rtol, atol, max_step, steps = u64::MAX, output_every = 0, seconds = 0.1))]
    #[expect(clippy::too_many_arguments, reason = "keyword arguments of Python")]
    fn advance_freely(
        &mut self,
        py: Python<'_>,
        end: f64,
        rtol: f64,
        atol: f64,
        max_step: f64,
        steps: u64,
        output_every: u64,
        seconds: f64,
    ) -> PyResult<u64> {
        let limit = Duration::try_from_secs_f64(seconds).unwrap_or(Duration::MAX);
        let run = self.run();
        let tolerance = rtol + atol / run.size();
        let control = StepControl { tolerance, max_step, first_step: None };
        let leg = FreeLeg { end, steps, control, output_every };
        let taken = py.detach(|| run.advance_freely(leg, limit));
        taken.map_err(|error| raise(py, &self.failure, &error))
    }

    fn set_inputs(&mut self, py: Python<'_>, first: usize, values: Vec<f64>) -> PyResult<()> {
        let outcome = self.run().set_inputs(first, &values);
        outcome.map_err(|error| solve_error(py, &error))
    }

    fn save<'py>(&mut self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let bytes = self.run().save().to_bytes().map_err(|error| model_error(&error))?;
        Ok(PyBytes::new(py, &bytes))
    }

    fn reset(&mut self, py: Python<'_>, saved: &[u8]) -> PyResult<()> {
        let saved = Saved::from_bytes(saved).map_err(|error| model_error(&error))?;
        let run = self.run();
        let outcome = py.detach(|| run.reset(saved));
        outcome.map_err(|error| raise(py, &self.failure, &error))
    }

    fn record(&mut self, py: Python<'_>) -> PyResult<()> {
        let outcome = self.run().record();
        outcome.map_err(|error| raise(py, &self.failure, &error))
    }

    fn present<'py>(&mut self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let sizes = self.sizes;
        records(py, self.run().present(), sizes)
    }

    fn records<'py>(&mut self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let sizes = self.sizes;
        records(py, self.run().take_records(), sizes)
    }

    #[getter]
    fn q<'py>(&mut self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, &self.run().state().q)
    }

    #[getter]
    fn v<'py>(&mut self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, &self.run().state().v)
    }

    /// Sum of three neighbouring coordinates (or velocities) each, from the offsets, with weights.
    fn combine<'py>(
        &mut self,
        py: Python<'py>,
        offsets: Vec<usize>,
        weights: Vec<f64>,
        velocities: bool,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let state = self.run().state();
        let from = if velocities { &state.v } else { &state.q };
        let mut sum = [0.0; 3];
        for (&offset, weight) in offsets.iter().zip(weights) {
            let three = offset.checked_add(3).and_then(|end| from.get(offset..end));
            let three = three.ok_or_else(|| PyIndexError::new_err(offset))?;
            for (sum, x) in sum.iter_mut().zip(three) {
                *sum += weight * x;
            }
        }
        Ok(PyArray1::from_slice(py, &sum))
    }

    fn statistics<'py>(&mut self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let run = self.run();
        let solver = run.describe_solver();
        let statistics = run.statistics();
        let dict = PyDict::new(py);
        dict.set_item("steps", statistics.steps)?;
        dict.set_item("rejected", statistics.rejected)?;
        dict.set_item("newton_iterations", statistics.newton_iterations)?;
        dict.set_item("factorizations", statistics.factorizations)?;
        dict.set_item("solver", solver)?;
        let parts = PyDict::new(py);
        parts.set_item("residual", statistics.seconds.residual)?;
        parts.set_item("tangent", statistics.seconds.tangent)?;
        parts.set_item("factor", statistics.seconds.factor)?;
        parts.set_item("solve", statistics.seconds.solve)?;
        parts.set_item("other", statistics.seconds.other)?;
        dict.set_item("seconds", parts)?;
        Ok(dict)
    }
}
