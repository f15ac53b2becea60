//! Systems: models made ready to compute with.

use crate::arrays::{row, rows, table, vectors};
use crate::errors::{PyModelError, model_error, solve_error};
use crate::run::{CallbackFailure, PyIntegrator, raise, records};
use numpy::{PyArray1, PyArray2, PyReadonlyArray1, PyReadonlyArray2, PyReadonlyArrayDyn};
use pliant_dae::generalized_alpha::Options;
use pliant_multibody::altered::Altered;
use pliant_multibody::checkpoint::Saved;
use pliant_multibody::latches::Switch;
use pliant_multibody::model::Model;
use pliant_multibody::run::{Run, RunOptions, Start};
use pliant_multibody::solve::{self, StaticOptions};
use pliant_multibody::system::{Chosen, Inputs};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::sync::{Arc, Mutex};

type Row<'py> = PyReadonlyArray1<'py, f64>;
type Rows<'py> = PyReadonlyArray2<'py, f64>;
type Table<'py> = Bound<'py, PyArray2<f64>>;

/// A model made ready to compute with.
#[pyclass(name = "System", module = "pliant._core", frozen)]
pub struct PySystem {
    model: Arc<Model>,
}

impl PySystem {
    fn sizes(&self) -> [usize; 3] {
        [self.model.coordinates(), self.model.coordinates(), self.model.multipliers()]
    }

    fn option_row(
        &self,
        array: Option<Row<'_>>,
        what: &str,
        n: usize,
    ) -> PyResult<Option<Vec<f64>>> {
        array.map(|array| row(&array, what, n)).transpose()
    }

    fn states(&self, q: &Rows<'_>) -> PyResult<Vec<f64>> {
        Ok(rows(q, "q", self.model.coordinates())?.0)
    }

    /// What forces and winches showed, row after row, and the length of a row.
    fn outputs(&self, outputs: &Rows<'_>, n: usize) -> PyResult<(Vec<f64>, usize)> {
        let width = outputs.as_array().ncols();
        let (numbers, found) = rows(outputs, "outputs", width)?;
        if found == n {
            return Ok((numbers, width));
        }
        Err(PyModelError::new_err(format!("outputs: {found} rows, but there are {n} states")))
    }

    /// `work` on each row of `q`, with the lengths that winches had let out, the results one after the other.
    fn each(
        &self,
        py: Python<'_>,
        q: &[f64],
        (outputs, width): &(Vec<f64>, usize),
        work: impl Fn(&Altered, &[f64], &mut Vec<f64>) + Sync,
    ) -> Vec<f64> {
        py.detach(|| {
            let mut out = Vec::new();
            let mut altered = Altered::new(&self.model);
            for (i, q) in q.chunks_exact(self.model.coordinates().max(1)).enumerate() {
                altered.show(&self.model, &outputs[i * width..(i + 1) * width]);
                work(&altered, q, &mut out);
            }
            out
        })
    }

    /// The same where winches do not matter.
    fn each_state(
        &self,
        py: Python<'_>,
        q: &[f64],
        work: impl Fn(&[f64], &mut Vec<f64>) + Sync,
    ) -> Vec<f64> {
        py.detach(|| {
            let mut out = Vec::new();
            for q in q.chunks_exact(self.model.coordinates().max(1)) {
                work(q, &mut out);
            }
            out
        })
    }

    fn check_cable(&self, cable: usize) -> PyResult<()> {
        let count = self.model.map().cables.len();
        if cable < count {
            return Ok(());
        }
        Err(PyModelError::new_err(format!("there is no cable number {cable} (there are {count})")))
    }
}

impl PySystem {
    /// Number of faces of a surface.
    fn faces(&self, surface: usize) -> PyResult<usize> {
        let surfaces = &self.model.map().surfaces;
        let found = surfaces.get(surface).ok_or_else(|| {
            let count = surfaces.len();
            PyModelError::new_err(format!(
                "there is no surface number {surface} (there are {count})"
            ))
        })?;
        Ok(found.faces.len())
    }

    /// Number of elements of a beam.
    fn beam_elements(&self, beam: usize) -> PyResult<usize> {
        let map = self.model.map().beam(beam, "beam");
        Ok(map.map_err(|error| PyModelError::new_err(error.to_string()))?.elements())
    }

    fn check_joint(&self, joint: usize) -> PyResult<()> {
        let count = self.model.joint_multipliers().len();
        if joint < count {
            return Ok(());
        }
        Err(PyModelError::new_err(format!("there is no joint number {joint} (there are {count})")))
    }

    /// Reads a row of a run's history that belongs to this joint.
    fn switch(&self, joint: usize, row: Option<Row<'_>>) -> PyResult<Option<Switch>> {
        let Some(row) = row else { return Ok(None) };
        let wrong = || PyModelError::new_err("switch: must be a row of the history of this joint");
        let row = row.as_slice()?;
        let &[t, number, engaged, gap, size, ref rest @ ..] = row else { return Err(wrong()) };
        let expected = self.model.pose_size(joint).ok_or_else(wrong)?;
        if number != joint as f64 || size != expected as f64 || rest.len() < expected {
            return Err(wrong());
        }
        let pose = rest[..expected].to_vec();
        Ok(Some(Switch { t, joint, engaged: engaged != 0.0, gap, pose }))
    }
}

/// Coordinates, multipliers, time or load factor, which of the two, and what grows with it.
type AboutArguments<'py> =
    (Option<Row<'py>>, Option<Row<'py>>, f64, bool, Option<(bool, Vec<usize>)>);

impl PySystem {
    /// `work` about a state, with functions of time.
    fn about<T: Send>(
        &self,
        py: Python<'_>,
        (q, lambda_, t, load_factor, growing): AboutArguments<'_>,
        inputs: Option<Py<PyAny>>,
        work: impl Fn(&solve::About<'_>, Option<Inputs>) -> Result<T, pliant_dae::error::Error> + Sync,
    ) -> PyResult<T> {
        let q = self.option_row(q, "q", self.model.coordinates())?;
        let lambda_ = self.option_row(lambda_, "lambda_", self.model.multipliers())?;
        let failure = CallbackFailure::default();
        let callback = crate::run::inputs(inputs, &failure);
        let chosen = growing.map(chosen);
        let done = py.detach(|| {
            let about = solve::About {
                q: q.as_deref(),
                lambda_: lambda_.as_deref(),
                t,
                load_factor,
                chosen: chosen.as_ref(),
            };
            work(&about, callback)
        });
        done.map_err(|error| raise(py, &failure, &error))
    }
}

/// What grows with the load factor, from Python's words.
fn chosen((gravity, mut loads): (bool, Vec<usize>)) -> Chosen {
    loads.sort_unstable();
    Chosen { gravity, loads }
}

#[pymethods]
impl PySystem {
    #[new]
    fn new(py: Python<'_>, spec: &str, arrays: Vec<PyReadonlyArrayDyn<'_, f64>>) -> PyResult<Self> {
        let arrays: Vec<Vec<f64>> =
            arrays.iter().map(|a| a.as_array().iter().copied().collect()).collect();
        let model = py.detach(|| Model::from_json(spec, &arrays));
        Ok(Self { model: Arc::new(model.map_err(|error| model_error(&error))?) })
    }

    #[getter]
    fn coordinates(&self) -> usize {
        self.model.coordinates()
    }

    #[getter]
    fn velocities(&self) -> usize {
        self.model.coordinates()
    }

    #[getter]
    fn multipliers(&self) -> usize {
        self.model.multipliers()
    }

    #[getter]
    fn initial_q<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, self.model.initial_q())
    }

    #[getter]
    fn initial_v<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, self.model.initial_v())
    }

    fn cable_offsets<'py>(
        &self,
        py: Python<'py>,
        cable: usize,
    ) -> PyResult<Bound<'py, PyArray2<i64>>> {
        self.check_cable(cable)?;
        let nodes = &self.model.map().cables[cable].nodes;
        let flat: Vec<Vec<i64>> =
            nodes.iter().map(|n| vec![i64::from(n.r), i64::from(n.t)]).collect();
        Ok(PyArray2::from_vec2(py, &flat)?)
    }

    fn shared_offsets<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<i64>> {
        PyArray1::from_iter(py, self.model.map().shared.iter().map(|&o| o as i64))
    }

    fn rigid_offsets<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<i64>> {
        PyArray1::from_iter(py, self.model.map().rigid.iter().map(|&o| o as i64))
    }

    /// First coordinate of each surface, its nodes, and the nodal vectors at each.
    fn surface_offsets<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<i64>>> {
        use numpy::PyArrayMethods;
        let surfaces = &self.model.map().surfaces;
        let flat = surfaces.iter().flat_map(|s| [s.first, s.nodes, s.vectors]).map(|x| x as i64);
        PyArray1::from_iter(py, flat).reshape([surfaces.len(), 3])
    }

    /// First coordinate of each beam and its nodes.
    fn beam_offsets<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<i64>>> {
        use numpy::PyArrayMethods;
        let beams = &self.model.map().beams;
        let flat = beams.iter().flat_map(|b| [b.first, b.nodes()]).map(|x| x as i64);
        PyArray1::from_iter(py, flat).reshape([beams.len(), 2])
    }

    fn joint_offsets<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<i64>>> {
        use numpy::PyArrayMethods;
        let joints = self.model.joint_multipliers();
        let flat = joints.iter().flatten().map(|&x| x as i64);
        PyArray1::from_iter(py, flat).reshape([joints.len(), 2])
    }

    fn force_offsets<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<i64>>> {
        use numpy::PyArrayMethods;
        let forces = self.model.force_outputs();
        let flat = forces.iter().flatten().map(|&x| x as i64);
        PyArray1::from_iter(py, flat).reshape([forces.len(), 2])
    }

    /// First number among the outputs of what the points of each cable remember, and the number of them in an element.
    fn past_outputs<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<i64>>> {
        use numpy::PyArrayMethods;
        let places = self.model.past_outputs();
        let flat = places.iter().flatten().map(|&x| x as i64);
        PyArray1::from_iter(py, flat).reshape([places.len(), 2])
    }

    /// First of the three numbers among the outputs of each chamber.
    fn chamber_outputs<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<i64>> {
        PyArray1::from_iter(py, self.model.chamber_outputs().into_iter().map(|k| k as i64))
    }

    /// Joints with equations that follow from others at the start: joint, how many, the joints that they follow from.
    fn redundant(&self, py: Python<'_>) -> Vec<(String, usize, Vec<String>)> {
        py.detach(|| solve::redundant(&self.model))
    }

    /// Contacts whose sides overlap by much: name, depth [m], half the thickness of the thinner side [m].
    #[pyo3(signature = (q=None))]
    fn overlaps(
        &self,
        py: Python<'_>,
        q: Option<PyReadonlyArray1<'_, f64>>,
    ) -> PyResult<Vec<(String, f64, f64)>> {
        let q = q.map(|q| Ok::<_, PyErr>(q.as_slice()?.to_vec())).transpose()?;
        let found = py.detach(|| solve::overlaps(&self.model, q.as_deref()));
        Ok(found.into_iter().map(|o| (o.contact, o.depth, o.thinner)).collect())
    }

    fn joint_outputs<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<i64>>> {
        use numpy::PyArrayMethods;
        let joints = self.model.joint_outputs();
        PyArray1::from_iter(py, joints.iter().flatten().copied()).reshape([joints.len(), 2])
    }

    fn describe_solver(&self, py: Python<'_>) -> PyResult<String> {
        match self.model.solver(false) {
            Ok(solver) => Ok(solver.describe()),
            Err(error) => Err(solve_error(py, &error)),
        }
    }

    fn masses<'py>(&self, py: Python<'py>) -> (f64, Bound<'py, PyArray1<f64>>) {
        let (mass, moment) = self.model.masses(self.model.initial_q());
        (mass, PyArray1::from_slice(py, &moment))
    }

    fn cable_mass(&self, cable: usize) -> PyResult<f64> {
        self.check_cable(cable)?;
        Ok(self.model.cable_mass(cable))
    }

    #[pyo3(signature = (*, spectral_radius, tolerance = None, threads = 1, q = None, v = None, held = Vec::new(), inputs = None, saved = None))]
    fn integrator(
        &self,
        py: Python<'_>,
        spectral_radius: f64,
        tolerance: Option<f64>,
        threads: usize,
        q: Option<Row<'_>>,
        v: Option<Row<'_>>,
        held: Vec<f64>,
        inputs: Option<Py<PyAny>>,
        saved: Option<&[u8]>,
    ) -> PyResult<PyIntegrator> {
        let n = self.model.coordinates();
        let (q, v) = (self.option_row(q, "q", n)?, self.option_row(v, "v", n)?);
        let saved = saved.map(Saved::from_bytes).transpose();
        let saved = saved.map_err(|error| model_error(&error))?;
        let failure = CallbackFailure::default();
        let inputs = crate::run::inputs(inputs, &failure);
        let mut options = Options { spectral_radius, timed: true, ..Options::default() };
        if let Some(tolerance) = tolerance {
            options.newton.tolerance = tolerance;
        }
        let options = RunOptions { integrator: options, threads };
        let model = self.model.clone();
        let run = py.detach(|| match saved {
            Some(saved) => Ok((Run::resume(model, &options, saved, inputs)?, 0.0)),
            None => {
                let start = Start { q: q.as_deref(), v: v.as_deref(), held: &held, inputs };
                let (run, start) = Run::new(model, &options, start)?;
                Ok((run, start.velocity_correction))
            }
        });
        let (run, projection) = run.map_err(|error| raise(py, &failure, &error))?;
        Ok(PyIntegrator { run: Mutex::new(run), failure, sizes: self.sizes(), projection })
    }

    #[pyo3(signature = (*, load_steps = 1, tolerance = None, stable = true, arc_length = false, growing = None,
        fade = false, q = None, lambda_ = None, inputs = None, poll = None))]
    #[expect(clippy::too_many_arguments, reason = "keyword arguments of Python")]
    fn solve_static<'py>(
        &self,
        py: Python<'py>,
        load_steps: usize,
        tolerance: Option<f64>,
        stable: bool,
        arc_length: bool,
        growing: Option<(bool, Vec<usize>)>,
        fade: bool,
        q: Option<Row<'py>>,
        lambda_: Option<Row<'py>>,
        inputs: Option<Py<PyAny>>,
        poll: Option<Py<PyAny>>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let q = self.option_row(q, "q", self.model.coordinates())?;
        let lambda_ = self.option_row(lambda_, "lambda_", self.model.multipliers())?;
        let failure = CallbackFailure::default();
        let callback = crate::run::inputs(inputs, &failure);
        let stop = failure.clone();
        let mut poll = move |factor: f64| -> bool {
            Python::attach(|py| {
                let outcome = match &poll {
                    Some(poll) => poll.bind(py).call1((factor,)).map(|_| ()),
                    None => py.check_signals(),
                };
                match (outcome, stop.lock()) {
                    (Err(error), Ok(mut slot)) => {
                        *slot = Some(error);
                        false
                    }
                    (Err(_), Err(_)) => false,
                    (Ok(()), _) => true,
                }
            })
        };
        let options = StaticOptions {
            load_steps,
            tolerance,
            stable,
            arc_length,
            chosen: growing.map(chosen),
            fade,
        };
        let (path, outcome) = py.detach(|| {
            let start = (q.as_deref(), lambda_.as_deref());
            solve::statics(&self.model, &options, start, callback, &mut poll)
        });
        let unstable = PyArray1::from_vec(py, path.unstable);
        let critical: Vec<_> = path
            .critical
            .into_iter()
            .map(|c| (c.record, c.bifurcation, PyArray1::from_vec(py, c.shape)))
            .collect();
        let path = records(py, path.records, self.sizes())?;
        path.set_item("unstable", unstable)?;
        path.set_item("critical", critical)?;
        match outcome {
            Ok(()) => Ok(path),
            Err(error) => {
                let raised = raise(py, &failure, &error);
                raised.value(py).setattr("records", path)?;
                Err(raised)
            }
        }
    }

    #[pyo3(signature = (count, *, q = None, lambda_ = None, t = 0.0, load_factor = false, growing = None, inputs = None))]
    #[expect(clippy::too_many_arguments, reason = "keyword arguments of Python")]
    fn solve_modes<'py>(
        &self,
        py: Python<'py>,
        count: usize,
        q: Option<Row<'py>>,
        lambda_: Option<Row<'py>>,
        t: f64,
        load_factor: bool,
        growing: Option<(bool, Vec<usize>)>,
        inputs: Option<Py<PyAny>>,
    ) -> PyResult<(Bound<'py, PyArray1<f64>>, Table<'py>)> {
        let modes =
            |about: &solve::About<'_>, inputs| solve::modes(&self.model, count, about, inputs);
        let about = (q, lambda_, t, load_factor, growing);
        let (squares, shapes) = self.about(py, about, inputs, modes)?;
        let shapes = table(py, shapes, self.model.coordinates())?;
        Ok((PyArray1::from_vec(py, squares), shapes))
    }

    fn is_conservative(&self) -> bool {
        solve::is_conservative(&self.model)
    }

    #[pyo3(signature = (*, q = None, lambda_ = None, t = 0.0, load_factor = false, growing = None, inputs = None))]
    #[expect(clippy::too_many_arguments, reason = "keyword arguments of Python")]
    fn linear<'py>(
        &self,
        py: Python<'py>,
        q: Option<Row<'py>>,
        lambda_: Option<Row<'py>>,
        t: f64,
        load_factor: bool,
        growing: Option<(bool, Vec<usize>)>,
        inputs: Option<Py<PyAny>>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let linear = |about: &solve::About<'_>, inputs| solve::linear(&self.model, about, inputs);
        let linear = self.about(py, (q, lambda_, t, load_factor, growing), inputs, linear)?;
        let dict = PyDict::new(py);
        dict.set_item("rows", PyArray1::from_vec(py, linear.rows))?;
        dict.set_item("columns", PyArray1::from_vec(py, linear.columns))?;
        dict.set_item("borders", PyArray1::from_vec(py, linear.borders))?;
        for (name, values) in
            ["mass", "damping", "stiffness", "jacobian"].into_iter().zip(linear.values)
        {
            dict.set_item(name, PyArray1::from_vec(py, values))?;
        }
        Ok(dict)
    }

    fn axial_force<'py>(
        &self,
        py: Python<'py>,
        cable: usize,
        q: Rows<'py>,
        outputs: Rows<'py>,
    ) -> PyResult<Table<'py>> {
        self.check_cable(cable)?;
        let (q, n) = rows(&q, "q", self.model.coordinates())?;
        let outputs = self.outputs(&outputs, n)?;
        let forces =
            self.each(py, &q, &outputs, |w, q, out| self.model.axial_force(cable, w, q, out));
        table(py, forces, self.model.map().cables[cable].elements())
    }

    fn strain<'py>(
        &self,
        py: Python<'py>,
        cable: usize,
        q: Rows<'py>,
        outputs: Rows<'py>,
    ) -> PyResult<(Table<'py>, Bound<'py, numpy::PyArray3<f64>>)> {
        self.check_cable(cable)?;
        let (q, n) = rows(&q, "q", self.model.coordinates())?;
        let outputs = self.outputs(&outputs, n)?;
        let elements = self.model.map().cables[cable].elements();
        let axial =
            self.each(py, &q, &outputs, |w, q, out| self.model.axial_strain(cable, w, q, out));
        let curvature =
            self.each(py, &q, &outputs, |w, q, out| self.model.curvature(cable, w, q, out));
        Ok((table(py, axial, elements)?, vectors(py, curvature, elements)?))
    }

    fn beam_strain<'py>(
        &self,
        py: Python<'py>,
        beam: usize,
        q: Rows<'py>,
    ) -> PyResult<Bound<'py, numpy::PyArray3<f64>>> {
        use numpy::PyArrayMethods;
        let elements = self.beam_elements(beam)?;
        let q = self.states(&q)?;
        let rows = self.each_state(py, &q, |q, out| self.model.beam_strain(beam, q, out));
        let n = rows.len() / (7 * elements);
        PyArray1::from_vec(py, rows).reshape([n, elements, 7])
    }

    fn beam_center<'py>(&self, py: Python<'py>, beam: usize, q: Rows<'py>) -> PyResult<Table<'py>> {
        self.beam_elements(beam)?;
        let q = self.states(&q)?;
        let mass = self.model.beam_mass(beam);
        let rows = self.each_state(py, &q, |q, out| {
            out.extend(self.model.beam_moment(beam, q).map(|m| m / mass));
        });
        table(py, rows, 3)
    }

    fn beam_mass(&self, beam: usize) -> PyResult<f64> {
        self.beam_elements(beam)?;
        Ok(self.model.beam_mass(beam))
    }

    fn surface_strain<'py>(
        &self,
        py: Python<'py>,
        surface: usize,
        q: Rows<'py>,
    ) -> PyResult<Bound<'py, numpy::PyArray3<f64>>> {
        use numpy::PyArrayMethods;
        let faces = self.faces(surface)?;
        let q = self.states(&q)?;
        let rows = self.each_state(py, &q, |q, out| self.model.surface_strain(surface, q, out));
        let n = rows.len() / (7 * faces);
        PyArray1::from_vec(py, rows).reshape([n, faces, 7])
    }

    #[pyo3(signature = (surface, chosen, gravity, q, v, a))]
    fn cut_force<'py>(
        &self,
        py: Python<'py>,
        surface: usize,
        chosen: Vec<bool>,
        gravity: Rows<'py>,
        q: Rows<'py>,
        v: Rows<'py>,
        a: Rows<'py>,
    ) -> PyResult<Table<'py>> {
        let faces = self.faces(surface)?;
        if chosen.len() != faces {
            let message = format!("chosen must have one flag for each of the {faces} faces");
            return Err(PyModelError::new_err(message));
        }
        let (gravity, count) = rows(&gravity, "gravity", 3)?;
        let [q, v, a] = [&q, &v, &a].map(|x| self.states(x));
        let (q, v, a) = (q?, v?, a?);
        let n = self.model.coordinates();
        if [&q, &v, &a].iter().any(|x| x.len() != n * count) {
            return Err(PyModelError::new_err("gravity must have one row for each state"));
        }
        let forces = py.detach(|| {
            let mut out = Vec::new();
            for (i, g) in gravity.chunks_exact(3).enumerate() {
                let state = [&q, &v, &a].map(|x| &x[n * i..n * (i + 1)]);
                out.extend(self.model.cut_force(surface, &chosen, state, [g[0], g[1], g[2]]));
            }
            out
        });
        table(py, forces, 3)
    }

    fn surface_center<'py>(
        &self,
        py: Python<'py>,
        surface: usize,
        q: Rows<'py>,
    ) -> PyResult<Table<'py>> {
        self.faces(surface)?;
        let q = self.states(&q)?;
        let mass = self.model.surface_mass(surface);
        let rows = self.each_state(py, &q, |q, out| {
            out.extend(self.model.surface_moment(surface, q).map(|m| m / mass));
        });
        table(py, rows, 3)
    }

    fn surface_mass(&self, surface: usize) -> PyResult<f64> {
        self.faces(surface)?;
        Ok(self.model.surface_mass(surface))
    }

    #[pyo3(signature = (joint, time, q, lambda_, switch = None))]
    fn reaction<'py>(
        &self,
        py: Python<'py>,
        joint: usize,
        time: Row<'py>,
        q: Rows<'py>,
        lambda_: Rows<'py>,
        switch: Option<Row<'py>>,
    ) -> PyResult<(Table<'py>, Table<'py>)> {
        let switch = self.switch(joint, switch)?;
        let (q, n) = rows(&q, "q", self.model.coordinates())?;
        let (lambda_, _) = rows(&lambda_, "lambda_", self.model.multipliers())?;
        let time = row(&time, "time", n)?;
        self.check_joint(joint)?;
        let (nq, nl) = (self.model.coordinates(), self.model.multipliers());
        let (mut forces, mut moments) = (Vec::new(), Vec::new());
        for ((t, q), lambda_) in time.iter().zip(q.chunks_exact(nq)).zip(lambda_.chunks_exact(nl)) {
            let (force, moment) = self.model.reaction(joint, *t, q, lambda_, switch.as_ref());
            forces.extend(force);
            moments.extend(moment);
        }
        Ok((table(py, forces, 3)?, table(py, moments, 3)?))
    }

    #[pyo3(signature = (joint, q, v, switch = None))]
    fn joint_motion<'py>(
        &self,
        py: Python<'py>,
        joint: usize,
        q: Rows<'py>,
        v: Rows<'py>,
        switch: Option<Row<'py>>,
    ) -> PyResult<Option<Table<'py>>> {
        self.check_joint(joint)?;
        let switch = self.switch(joint, switch)?;
        let (q, v) = (self.states(&q)?, self.states(&v)?);
        let n = self.model.coordinates().max(1);
        let motion: Option<Vec<[f64; 2]>> = q
            .chunks_exact(n)
            .zip(v.chunks_exact(n))
            .map(|(q, v)| self.model.joint_motion(joint, q, v, switch.as_ref()))
            .collect();
        motion.map(|rows| table(py, rows.into_flattened(), 2)).transpose()
    }

    fn nodal_force<'py>(
        &self,
        py: Python<'py>,
        cable: usize,
        node: usize,
        q: Rows<'py>,
        v: Rows<'py>,
        a: Rows<'py>,
        outputs: Rows<'py>,
    ) -> PyResult<Table<'py>> {
        self.check_cable(cable)?;
        let nodes = self.model.map().cables[cable].nodes.len();
        if node >= nodes {
            return Err(PyModelError::new_err(format!(
                "there is no node number {node} (there are {nodes})"
            )));
        }
        let (v, a) = (self.states(&v)?, self.states(&a)?);
        let (q, count) = rows(&q, "q", self.model.coordinates())?;
        let (outputs, width) = self.outputs(&outputs, count)?;
        let n = self.model.coordinates();
        let forces = py.detach(|| {
            let mut out = Vec::new();
            let mut altered = Altered::new(&self.model);
            for i in 0..count {
                altered.show(&self.model, &outputs[i * width..(i + 1) * width]);
                let state = [&q, &v, &a].map(|x| &x[i * n..(i + 1) * n]);
                out.extend(self.model.nodal_force(cable, node, &altered, state));
            }
            out
        });
        table(py, forces, 3)
    }

    fn momentum<'py>(
        &self,
        py: Python<'py>,
        q: Rows<'py>,
        v: Rows<'py>,
    ) -> PyResult<(Table<'py>, Table<'py>, Table<'py>)> {
        let (q, v) = (self.states(&q)?, self.states(&v)?);
        let n = self.model.coordinates().max(1);
        let (mut linear, mut angular, mut first) = (Vec::new(), Vec::new(), Vec::new());
        for (q, v) in q.chunks_exact(n).zip(v.chunks_exact(n)) {
            let (p, l) = self.model.momentum(q, v);
            linear.extend(p);
            angular.extend(l);
            first.extend(self.model.masses(q).1);
        }
        Ok((table(py, linear, 3)?, table(py, angular, 3)?, table(py, first, 3)?))
    }
}
