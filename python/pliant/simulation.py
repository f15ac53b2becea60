"""Running models: dynamics, statics and modes."""

from __future__ import annotations

import math
import os
import sys
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from pliant import _check
from pliant._lower import Lowered, lower
from pliant.bodies import LineBody
from pliant.errors import ConvergenceError, ModelError, translated
from pliant.model import Model
from pliant.points import Handle
from pliant.result import Records, Result, State, Statistics, require_state
from pliant.typing import FloatArray

if TYPE_CHECKING:
    from pliant._core import Integrator, System

__all__ = ["Modes", "simulate", "solve_modes", "solve_static"]


def simulate(
    model: Model,
    *,
    duration: float,
    step: float,
    start: Result | State | None = None,
    spectral_radius: float | None = None,
    output_every: int = 1,
    tolerance: float | None = None,
    threads: int | None = None,
    progress: bool | None = None,
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
    start : Result or State, optional
        The run begins at the last state of a result, or at ``result.state(i)``, at time 0. Bodies must be the
        same, loads and joints may differ. A static result gives the positions; the velocities are those of
        the bodies.
    spectral_radius : float, optional
        Numerical damping: 1 damps nothing, 0 most; 0.8 by default. At most 0.98 where there are constraints.
    output_every : int
        Keep every so manieth step; the last one is always kept.
    tolerance : float, optional
        Newton's tolerance, relative to the size of the model.
    threads : int, optional
        Threads; the result does not depend on it.
    progress : bool, optional
        Show a progress bar; by default on a terminal.

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
    model = _require_model(model)
    duration = _check.number(duration, "duration", above=0)
    step = _check.number(step, "step", above=0)
    if duration / step > _check.LARGEST_COUNT:
        _check.fail(
            "step", step, f"must be at least {duration / _check.LARGEST_COUNT:g} s: at most 1e8 steps"
        )
    steps = max(1, math.ceil(duration / step * (1 - 1e-9)))
    output_every = _check.count(output_every, "output_every")
    rho = (
        0.8
        if spectral_radius is None
        else _check.number(spectral_radius, "spectral_radius", at_least=0, at_most=1)
    )
    tolerance = None if tolerance is None else _check.number(tolerance, "tolerance", above=0, below=1)
    threads = _threads(threads)
    progress = None if progress is None else _check.flag(progress, "progress")
    state = None if start is None else require_state(start, "start", model)
    model = model.copy()
    lowered, system = _build(model, state)
    if rho > 0.98 and system.multipliers > 0:
        _check.fail(
            "spectral_radius",
            rho,
            "must be at most 0.98 in a model with constraints: undamped, they oscillate and blow up",
        )
    q, v = _start_vectors(lowered, system, state, model)
    inputs = _Inputs(lowered)
    with inputs.guarded(), translated():
        integrator = system.integrator(
            step=duration / steps,
            spectral_radius=rho,
            tolerance=tolerance,
            threads=threads,
            q=q,
            v=v,
            inputs=inputs.callback,
        )
    _warn_of_projection(integrator, system, lowered, v if v is not None else system.initial_v, state)

    def collect() -> Result:
        with translated():
            records = _records(integrator.records())
        return Result(
            model,
            lowered,
            records,
            static=False,
            statistics=_statistics(integrator.statistics()),
            system=system,
        )

    try:
        with _progress_bar(progress, steps) as report, inputs.guarded(), translated():
            taken = 0
            while taken < steps - 1:
                now = integrator.advance(steps - 1 - taken, output_every=output_every)
                taken += now
                report(now)
            report(integrator.advance(1, output_every=steps))
    except (KeyboardInterrupt, ConvergenceError, ModelError) as error:
        _name_node(error, model)
        error.result = collect()  # type: ignore[union-attr]
        raise
    return collect()


def solve_static(
    model: Model,
    *,
    start: Result | State | None = None,
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
    model = _require_model(model)
    load_steps = _check.count(load_steps, "load_steps")
    tolerance = None if tolerance is None else _check.number(tolerance, "tolerance", above=0, below=1)
    stable = _check.flag(stable, "stable")
    progress = None if progress is None else _check.flag(progress, "progress")
    state = None if start is None else require_state(start, "start", model)
    model = model.copy()
    lowered, system = _build(model, state)
    q, _ = _start_vectors(lowered, system, state, model)
    inputs = _Inputs(lowered)
    reached = 0.0

    def collect(raw: Any) -> Result:
        records = _records({key: value for key, value in raw.items() if key != "unstable"})
        return Result(model, lowered, records, static=True, statistics=Statistics(), system=system)

    with _progress_bar(progress, 100) as report, inputs.guarded():

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
            _name_node(error, model)
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

    def positions(self, body: Handle | str) -> FloatArray:
        """Shapes as displacements of the nodes of a body, (count, nodes, 3)."""
        return self._result._nodes(body, self.shapes)


def solve_modes(model: Model, count: int = 10, about: Result | State | None = None) -> Modes:
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
    model = _require_model(model)
    count = _check.count(count, "count")
    state = None if about is None else require_state(about, "about", model)
    model = model.copy()
    lowered, system = _build(model, state)
    freedoms = system.velocities - system.multipliers
    if count > freedoms:
        _check.fail("count", count, f"the model has {freedoms} degrees of freedom")
    q, _ = _start_vectors(lowered, system, state, model)
    lambda_ = None
    if (
        state is not None
        and len(state.lambda_) == system.multipliers
        and q is not None
        and len(q) == len(state.q)
    ):
        lambda_ = state.lambda_
    inputs = _Inputs(lowered)
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
        np.zeros(1), here[None], empty, empty, np.zeros((1, system.multipliers)), np.zeros((1, 5))
    )
    return Modes(
        np.sqrt(np.maximum(squares, 0.0)) / (2 * np.pi),
        eigenvalues,
        shapes,
        bool(squares.min(initial=0.0) >= -floor),
        Result(model, lowered, records, static=True, statistics=Statistics(), system=system),
    )


def _require_model(model: object) -> Model:
    if not isinstance(model, Model):
        _check.fail("model", model, "must be a pliant.Model")
    if not model._bodies:
        _check.fail("model", model, "has no bodies; add one, such as model.add_cable(...)")
    return model


def _threads(threads: int | None) -> int:
    if threads is not None:
        return _check.count(threads, "threads", at_most=1024)
    available = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    return min(available, 16)


def _build(model: Model, state: State | None) -> tuple[Lowered, System]:
    from pliant import _core

    bodies = None
    if state is not None:
        bodies = dict(state.bodies)
        if state.static:
            fresh = _initial(model)
            bodies = {
                name: b._replace(v_r=fresh[name].v_r, v_t=fresh[name].v_t) for name, b in bodies.items()
            }
    lowered = lower(model, bodies)
    with translated():
        return lowered, _core.System(lowered.spec, lowered.arrays)


def _initial(model: Model) -> Any:
    from pliant._lower import initial_state

    return initial_state(model)


def _start_vectors(
    lowered: Lowered, system: System, state: State | None, model: Model
) -> tuple[FloatArray | None, FloatArray | None]:
    """Coordinates and velocities of the state that the run begins with; None: the document's."""
    if state is None:
        return None, None
    q, v = system.initial_q.copy(), system.initial_v.copy()
    fresh = _initial(model)
    shared = system.shared_offsets()
    for name, body in state.bodies.items():
        moving = fresh[name] if state.static else body
        if name in lowered.rigid:
            index = system.rigid_offsets()[lowered.rigid[name]] + np.arange(12)
            q[index], v[index] = body.r.ravel(), moving.v_r.ravel()
            continue
        columns: list[tuple[int, FloatArray, FloatArray]] = [(0, body.r, moving.v_r)]
        if name in lowered.cables:
            offsets = system.cable_offsets(lowered.cables[name])
            columns.append((1, body.t, moving.v_t))
        else:
            offsets = shared[[lowered.shared[name]]].reshape(1, 1)
        for column, place, speed in columns:
            index = offsets[:, [column]] + np.arange(3)
            q[index], v[index] = place, speed
    return q, v


class _Inputs:
    """Callables of the loads, gathered into one function of time; keeps the error that one of them raised."""

    def __init__(self, lowered: Lowered) -> None:
        self._inputs = lowered.inputs
        self._error: BaseException | None = None
        self.callback: Callable[[float], FloatArray] | None = self._evaluate if self._inputs else None

    def _evaluate(self, t: float) -> FloatArray:
        values = []
        for item in self._inputs:
            try:
                values.append(item.function(t))
            except Exception as error:
                self._error = ModelError(f"load '{item.load}' at t = {t:g} s: {error}")
                self._error.__cause__ = error
                raise self._error from error
            except BaseException as error:
                self._error = error
                raise
        return np.concatenate(values)

    @contextmanager
    def guarded(self) -> Iterator[None]:
        """Raise the callable's own error, whatever the core made of it."""
        try:
            yield
        except BaseException:
            if self._error is not None:
                raise self._error from self._error.__cause__
            raise


@contextmanager
def _progress_bar(progress: bool | None, total: int) -> Iterator[Callable[[int], object]]:
    if progress or (progress is None and sys.stderr is not None and sys.stderr.isatty()):
        try:
            from tqdm import tqdm
        except ImportError as error:
            if progress:
                raise ImportError('the progress bar needs tqdm: pip install "pliant[progress]"') from error
        else:
            with tqdm(total=total, leave=False, file=sys.stderr) as bar:
                yield bar.update
            return
    yield lambda _: None


def _warn_of_projection(
    integrator: Integrator, system: System, lowered: Lowered, v: FloatArray, state: State | None
) -> None:
    """Tell by how much joints changed the velocities of points; a restart's roundoff is not worth a word."""
    firsts = [system.cable_offsets(k)[:, 0] for k in lowered.cables.values()] + [system.shared_offsets()]
    index = np.concatenate(firsts)[:, None] + np.arange(3)
    wanted = v[index]
    change = float(np.linalg.norm(integrator.v[index] - wanted, axis=1).max(initial=0.0))
    speed = float(np.linalg.norm(wanted, axis=1).max(initial=0.0))
    if change > 1e-3 * speed and integrator.projection > (1e-9 if state is None else 1e-3) * speed:
        warnings.warn(
            f"initial velocities contradict joints; they were projected, by up to {change:.3g} m/s",
            stacklevel=3,
        )


def _name_node(error: BaseException, model: Model) -> None:
    """Turn the strand node that the core blames into the node of the body."""
    if isinstance(error, ConvergenceError) and error.node is not None:
        body = model._bodies.get(error.body or "")
        if isinstance(body, LineBody) and error.node < len(body.users):
            error.node = int(body.users[error.node])


def _records(raw: Any) -> Records:
    return Records(**{key: np.asarray(value) for key, value in raw.items()})


def _statistics(raw: dict[str, Any]) -> Statistics:
    try:
        import resource

        memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * (
            1 if sys.platform == "darwin" else 1024
        )
    except ImportError:
        memory = 0
    known = {
        key: raw[key] for key in ("steps", "rejected", "newton_iterations", "factorizations") if key in raw
    }
    return Statistics(**known, seconds=dict(raw.get("seconds", {})), peak_memory=memory)
