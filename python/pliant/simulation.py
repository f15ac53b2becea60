"""Running models: dynamics, statics and modes."""

from __future__ import annotations

import os
import warnings
from collections.abc import Callable, Iterable
from concurrent.futures import ThreadPoolExecutor
from concurrent.futures import wait as wait_for
from dataclasses import dataclass
from threading import Event
from typing import Any

import numpy as np

from pliant import _check
from pliant._plan import Plan
from pliant._running import (
    CallableInputs,
    as_records,
    build,
    name_node,
    require_model,
    require_state,
    start_vectors,
    thread_count,
)
from pliant._table import table
from pliant.checkpoints import read
from pliant.errors import ConvergenceError, ModelError, translated
from pliant.model import Model
from pliant.points import Handle
from pliant.progress import progress_bar
from pliant.readings import Statistics
from pliant.records import Records, State
from pliant.result import Result
from pliant.stepper import Stepper
from pliant.typing import ArrayLike, FloatArray

__all__ = ["Modes", "resume", "simulate", "simulate_many", "solve_modes", "solve_static"]

PathLike = str | os.PathLike[str]


def simulate(
    model: Model,
    *,
    duration: float,
    step: float,
    start: Result | State | PathLike | None = None,
    spectral_radius: float | None = None,
    output_every: int = 1,
    output_times: ArrayLike | None = None,
    on_step: Callable[[Stepper], object] | None = None,
    tolerance: float | None = None,
    threads: int | None = None,
    progress: bool | None = None,
    checkpoint: PathLike | tuple[PathLike, float] | None = None,
    output: PathLike | None = None,
) -> Result:
    """Integrate the motion of a model by generalized-alpha.

    Parameters
    ----------
    model : Model
        The model; it is not changed.
    duration : float
        Time to simulate [s].
    step : float
        Step [s]. Where ``duration`` is not a whole number of steps, the step is made a little smaller so that
        it is.
    start : Result, State or path, optional
        The run begins at the last state of a result, at ``result.state(i)``, or where the file of a result or
        a checkpoint ends, at time 0. Bodies must be the same, loads and joints may differ. A static result
        gives the positions; the velocities are those of the bodies.
    spectral_radius : float, optional
        Numerical damping: 1 damps nothing, 0 most; 0.8 by default. At most 0.98 where there are constraints.
    output_every : int
        Keep every so manieth step; the last one is always kept.
    output_times : array_like, shape (n,), optional
        Keep exactly these times [s], ascending: the step between them is made a little smaller so that a
        whole number of steps fits.
    on_step : callable, optional
        ``on_step(stepper)`` is called before each step with a :class:`pliant.Stepper`, to look and to set
        inputs; the run ends when it returns True.
    tolerance : float, optional
        Newton's tolerance, relative to the size of the model.
    threads : int, optional
        Threads; the result does not depend on it.
    progress : bool, optional
        Show a progress bar; by default on a terminal.
    checkpoint : str, path or (path, float), optional
        Save the run in this file every minute, or every so many seconds, when it is interrupted, and at its
        end; :func:`pliant.resume` continues it with the same bits.
    output : str or path, optional
        Write the result to this file as it comes: memory stays bounded, and what was written can be read by
        ``Result.load`` at any time, from elsewhere, too, and after the run was killed.

    Returns
    -------
    Result
        What was computed. After Ctrl-C, ``KeyboardInterrupt.result`` holds what there is.

    Examples
    --------
    >>> import pliant as pl
    >>> model = pl.Model(gravity=(0, 0, -9.81))
    >>> ball = model.add_point_mass(1.0, at=(0, 0, 0))
    >>> result = pl.simulate(model, duration=1.0, step=0.01)
    >>> print(f"{result.track(ball.center).position[-1, 2]:.3f}")
    -4.905
    """
    model = require_model(model)
    plan = Plan.checked(duration, step, output_every, output_times, checkpoint, on_step is not None)
    _check_on_step(on_step)
    progress = None if progress is None else _check.flag(progress, "progress")
    stepper = _begin(
        model,
        plan,
        start=start,
        spectral_radius=spectral_radius,
        tolerance=tolerance,
        threads=threads,
        output=output,
    )
    return _drive(stepper, plan, on_step, progress)


def _check_on_step(on_step: object) -> None:
    if on_step is not None and not callable(on_step):
        _check.fail("on_step", on_step, "must be a callable of the stepper")


def _drive(
    stepper: Stepper,
    plan: Plan,
    on_step: Callable[[Stepper], object] | None,
    progress: bool | None,
    stop: Event | None = None,
) -> Result:
    """Take the steps of the plan that are left."""
    try:
        with progress_bar(progress, plan.steps) as report:
            report(stepper._steps)
            for leg in plan.legs:
                while (left := leg.last - stepper._steps) > 0:
                    if stop is not None and stop.is_set():
                        raise KeyboardInterrupt
                    if on_step is not None and on_step(stepper) is True:
                        plan.finish(stepper)
                        stepper._finish()
                        return stepper.result
                    report(stepper._take(1 if on_step else left, leg.step, plan.output_every, leg.end, left))
                    if left == 1 or stepper._steps == leg.last:
                        plan.reach(stepper, leg)
                    plan.save(stepper)
        plan.finish(stepper)
    except (KeyboardInterrupt, ConvergenceError, ModelError) as error:
        stepper._finish()
        error.result = stepper.result  # type: ignore[union-attr]
        if isinstance(error, KeyboardInterrupt):
            plan.save(stepper, now=True)
        raise
    stepper._finish()
    return stepper.result


def resume(
    checkpoint: PathLike,
    model: Model | None = None,
    *,
    on_step: Callable[[Stepper], object] | None = None,
    threads: int | None = None,
    progress: bool | None = None,
) -> Result:
    """Continue a run that ``simulate(..., checkpoint=...)`` saved, with the bits of one that never stopped.

    Parameters
    ----------
    checkpoint : str or path
        The file; the run goes on saving itself there.
    model : Model, optional
        The model that was run, needed where loads are Python callables: files cannot hold those.
    on_step : callable, optional
        That of the run, if it had one.
    threads : int, optional
        Threads; the result does not depend on it.
    progress : bool, optional
        Show a progress bar; by default on a terminal.

    Returns
    -------
    Result
        That of the whole run.

    Examples
    --------
    >>> import pliant as pl
    >>> from pathlib import Path
    >>> from tempfile import TemporaryDirectory
    >>> model = pl.Model(gravity=(0, 0, -9.81))
    >>> ball = model.add_point_mass(1.0, at=(0, 0, 0))
    >>> with TemporaryDirectory() as folder:
    ...     saved = Path(folder) / "fall.checkpoint"
    ...     whole = pl.simulate(model, duration=1.0, step=0.01, checkpoint=saved)
    ...     again = pl.resume(saved)
    >>> len(again.time) == len(whole.time)
    True
    """
    _check_on_step(on_step)
    progress = None if progress is None else _check.flag(progress, "progress")
    saved = read(checkpoint)
    if saved.run is None:
        _check.fail("checkpoint", str(checkpoint), "was saved by a stepper: use pliant.Stepper.load")
    plan = Plan.read(saved.run, checkpoint)
    if plan.has_on_step and on_step is None:
        _check.fail("on_step", None, "the run had one: give it again")
    return _drive(Stepper._restored(saved, model, threads), plan, on_step, progress)


def simulate_many(
    models: Iterable[Model], *, threads: int | None = None, progress: bool | None = None, **options: Any
) -> list[Result]:
    """Run models independently of each other, several at a time, each with the bits of a single run.

    All runs are finished, even if one fails; then the error of the first that failed is raised, whose
    attribute ``results`` lists what came of each: a Result or an exception.

    Parameters
    ----------
    models : iterable of Model
        The models; they are not changed.
    threads : int, optional
        Number of runs at a time.
    progress : bool, optional
        Show a progress bar; by default on a terminal.
    **options
        Those of :func:`pliant.simulate`: ``duration``, ``step`` and so on, the same for all.

    Returns
    -------
    list of Result
        In the order of the models.

    Examples
    --------
    >>> import pliant as pl
    >>> def fall(gravity):
    ...     model = pl.Model(gravity=(0, 0, -gravity))
    ...     model.add_point_mass(1.0, at=(0, 0, 0), name="ball")
    ...     return model
    >>> results = pl.simulate_many([fall(9.81), fall(1.62)], duration=1.0, step=0.01)
    >>> print([f"{result.positions('ball')[-1, 0, 2]:.3f}" for result in results])
    ['-4.905', '-0.810']
    """
    if isinstance(models, Model) or not isinstance(models, Iterable):
        _check.fail("models", models, "must be several models")
    queue = list(models)
    for k, model in enumerate(queue):
        if not isinstance(model, Model):
            _check.fail(f"models[{k}]", model, "must be a pliant.Model")
    for name in ("checkpoint", "on_step", "output"):
        if options.get(name) is not None:
            _check.fail(name, options[name], "belongs to one run: use pliant.simulate")
    for name in ("duration", "step"):
        if name not in options:
            _check.fail(name, None, "must be given")
    progress = None if progress is None else _check.flag(progress, "progress")
    stop = Event()

    def run(model: Model) -> Result:
        return _simulate_one(model, stop, **options)

    with (
        ThreadPoolExecutor(thread_count(threads)) as pool,
        progress_bar(progress, len(queue)) as report,
    ):
        runs = [pool.submit(run, model) for model in queue]
        try:
            open_runs = set(runs)
            while open_runs:
                done, open_runs = wait_for(open_runs, timeout=0.1)
                report(len(done))
        except KeyboardInterrupt as interrupt:
            stop.set()
            wait_for(runs)
            interrupt.results = [r.exception() or r.result() for r in runs]  # type: ignore[attr-defined]
            raise
    outcomes = [r.exception() or r.result() for r in runs]
    for outcome in outcomes:
        if isinstance(outcome, BaseException):
            outcome.results = outcomes  # type: ignore[attr-defined]
            raise outcome
    return [r.result() for r in runs]


def _simulate_one(
    model: Model,
    stop: Event,
    *,
    duration: float,
    step: float,
    output_every: int = 1,
    output_times: ArrayLike | None = None,
    **options: Any,
) -> Result:
    plan = Plan.checked(duration, step, output_every, output_times, None, False)
    return _drive(_begin(model, plan, **{**options, "threads": 1}), plan, None, False, stop)


def _begin(model: Model, plan: Plan, **options: Any) -> Stepper:
    stepper = Stepper(model, step=plan.legs[0].step, **options)
    if not plan.keeps_start:
        stepper._forget()
    return stepper


def solve_static(
    model: Model,
    *,
    start: Result | State | PathLike | None = None,
    load_steps: int = 1,
    tolerance: float | None = None,
    stable: bool = True,
    progress: bool | None = None,
) -> Result:
    """Find the equilibrium of a model under its loads.

    Parameters
    ----------
    model : Model
        The model; it is not changed.
    start : Result or State, optional
        Where the search begins; bodies must be the same.
    load_steps : int
        Constants, gravity included, grow in so many steps; callables and Tables are evaluated at the load
        factor. Steps are cut when they fail.
    tolerance : float, optional
        Newton's tolerance, relative to the size of the model.
    stable : bool
        Leave unstable equilibria (a rope straight under compression, a strut above its critical load) for
        stable ones. False keeps whatever equilibrium comes first, with a warning where it is unstable. Under
        loads that follow the motion stability is not tested.
    progress : bool, optional
        Show a progress bar; by default on a terminal.

    Returns
    -------
    Result
        Equilibria at the load factors ``result.load_factor``; the last is full load. Where there is none,
        ``ConvergenceError.result`` holds those reached before.

    Examples
    --------
    >>> import pliant as pl
    >>> model = pl.Model()
    >>> steel = pl.LinearElastic(youngs_modulus=2e11, poisson_ratio=0.3, density=7850.0)
    >>> thick = pl.Circle(radius=1e-2)
    >>> bar = model.add_cable([(0, 0, 0), (0, 0, -1)], elements=1, section=thick, material=steel)
    >>> pin, load = model.clamp(bar.start), model.add_force(bar.end, (0, 0, -1e4))
    >>> result = pl.solve_static(model)
    >>> print(f"{result.axial_force(bar)[-1, 0]:.0f}")
    10000
    """
    model = require_model(model)
    load_steps = _check.count(load_steps, "load_steps")
    tolerance = None if tolerance is None else _check.number(tolerance, "tolerance", above=0, below=1)
    stable = _check.flag(stable, "stable")
    progress = None if progress is None else _check.flag(progress, "progress")
    state = None if start is None else require_state(start, "start", model)
    model = model.copy()
    lowered, system = build(model, state)
    q, _ = start_vectors(lowered, system, state, model)
    inputs = CallableInputs(lowered, lowered.held_values)
    reached = 0.0

    def collect(raw: Any) -> Result:
        records = as_records({key: value for key, value in raw.items() if key != "unstable"})
        return Result(model, lowered, records, static=True, statistics=Statistics(), system=system)

    with progress_bar(progress, 100) as report, inputs.guarded():

        def poll(factor: float) -> None:
            nonlocal reached
            report(round(100 * factor) - round(100 * reached))
            reached = factor

        try:
            with translated():
                raw: Any = system.solve_static(
                    load_steps=load_steps,
                    tolerance=tolerance,
                    stable=stable,
                    q=q,
                    inputs=inputs.callback,
                    poll=poll,
                )
        except (ConvergenceError, ModelError) as error:
            name_node(error, model)
            if error.records is not None and len(error.records["time"]):
                error.result = collect(error.records)
            raise
    if len(raw["unstable"]):
        factors = ", ".join(f"{factor:g}" for factor in raw["unstable"])
        warnings.warn(f"the equilibrium is unstable at load factor {factors}", stacklevel=2)
    return collect(raw)


@dataclass(frozen=True, eq=False)
class Modes:
    """Modes of free vibration.

    Attributes
    ----------
    frequencies : ndarray, shape (count,)
        Frequencies [Hz], ascending (0 for motions that nothing restores).
    eigenvalues : ndarray of complex, shape (count,)
        Eigenvalues [1/s]: i times the angular frequency, real and positive where the state is unstable.
    shapes : ndarray, shape (count, coordinates)
        Shapes in the coordinates of the model, mass-normalised; :meth:`positions` gives them by body.
    stable : bool
        Whether no motion grows.
    """

    frequencies: FloatArray
    eigenvalues: Any
    shapes: FloatArray
    stable: bool
    _result: Result

    def __repr__(self) -> str:
        lowest = ", ".join(f"{f:.4g}" for f in self.frequencies[:4])
        more = ", ..." if len(self.frequencies) > 4 else ""
        return f"<Modes: {lowest}{more} Hz, {'stable' if self.stable else 'unstable'}>"

    def _repr_html_(self) -> str:
        pairs = zip(self.frequencies, self.eigenvalues, strict=True)
        rows = [(k, f"{f:.6g} Hz", f"{value:.6g} 1/s") for k, (f, value) in enumerate(pairs)]
        return table("Modes, stable" if self.stable else "Modes, unstable", rows)

    def positions(self, body: Handle | str) -> FloatArray:
        """Shapes as displacements of the nodes of a body, (count, nodes, 3)."""
        return self._result._nodes(body, self.shapes)


def solve_modes(model: Model, count: int = 10, about: Result | State | PathLike | None = None) -> Modes:
    """Find the lowest modes of free vibration.

    Parameters
    ----------
    model : Model
        The model; it is not changed.
    count : int
        Number of modes.
    about : Result or State, optional
        State to linearise at, such as an equilibrium; by default the start.

    Returns
    -------
    Modes
        ``frequencies`` [Hz], ``shapes``, ``eigenvalues`` [1/s], ``stable``.

    Examples
    --------
    >>> import pliant as pl
    >>> model = pl.Model()
    >>> steel = pl.LinearElastic(youngs_modulus=2e11, poisson_ratio=0.3, density=7850.0)
    >>> thick = pl.Circle(radius=1e-2)
    >>> arm = model.add_cable([(0, 0, 0), (1, 0, 0)], elements=8, section=thick, material=steel)
    >>> wall = model.clamp(arm.start)
    >>> print(f"{pl.solve_modes(model, count=2).frequencies[0]:.2f} Hz")
    14.12 Hz
    """
    model = require_model(model)
    count = _check.count(count, "count")
    state = None if about is None else require_state(about, "about", model)
    model = model.copy()
    lowered, system = build(model, state)
    freedoms = system.velocities - system.multipliers
    if count > freedoms:
        freedoms += sum(equations for _, equations, _ in system.redundant())
        offsets = system.joint_offsets()
        free = (one["joint"] for one in lowered.document["latches"] if not one["engaged"])
        freedoms += int(sum(offsets[joint, 1] for joint in free))
    if count > freedoms:
        _check.fail("count", count, f"the model has {freedoms} degrees of freedom")
    q, _ = start_vectors(lowered, system, state, model)
    lambda_ = None
    if (
        state is not None
        and len(state.lambda_) == system.multipliers
        and q is not None
        and len(q) == len(state.q)
    ):
        lambda_ = state.lambda_
    inputs = CallableInputs(lowered, lowered.held_values)
    with inputs.guarded(), translated():
        squares, shapes = system.solve_modes(
            count,
            q=q,
            lambda_=lambda_,
            t=state.time if state is not None else 0.0,
            load_factor=state is not None and state.static,
            inputs=inputs.callback,
        )
    eigenvalues = np.sqrt(-squares.astype(complex))
    floor = 1e-9 * float(np.abs(squares).max(initial=0.0))
    here = q if q is not None else system.initial_q
    empty = np.zeros((1, len(here)))
    records = Records(
        np.zeros(1),
        here[None],
        empty,
        empty,
        np.zeros((1, system.multipliers)),
        np.zeros((1, 5)),
        np.zeros((1, 0)),
        np.zeros((1, 0)),
    )
    return Modes(
        np.sqrt(np.maximum(squares, 0.0)) / (2 * np.pi),
        eigenvalues,
        shapes,
        bool(squares.min(initial=0.0) >= -floor),
        Result(model, lowered, records, static=True, statistics=Statistics(), system=system),
    )
