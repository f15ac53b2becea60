"""Running models."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING, Any, Literal

from pliant import _check
from pliant._plan import Plan
from pliant._running import (
    require_model,
    thread_count,
)
from pliant._steps import Steps
from pliant.checkpoints import read
from pliant.errors import ConvergenceError, ModelError
from pliant.model import Model
from pliant.progress import progress_bar
from pliant.records import State
from pliant.result import Result
from pliant.stepper import Stepper
from pliant.typing import ArrayLike

if TYPE_CHECKING:
    from threading import Event

__all__ = ["resume", "simulate", "simulate_many"]

PathLike = str | os.PathLike[str]


def simulate(
    model: Model,
    *,
    duration: float,
    step: float | Literal["auto"],
    rtol: float | None = None,
    atol: float | None = None,
    max_step: float | None = None,
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
    step : float or "auto"
        Step [s]. Where ``duration`` is not a whole number of steps, the step is made a little smaller so that
        it is. ``"auto"``: as long as the local error allows; kinks of loads (rows of a Table that is not
        smooth, ends of a Ramp) and ``output_times`` are met exactly.
    rtol, atol : float, optional
        For ``step="auto"``: largest error of any position in one step, ``rtol`` times the size of the model
        (1e-6 by default) plus ``atol`` [m] (0 by default); errors at the end fall with the power 2/3 of it.
    max_step : float, optional
        For ``step="auto"``: longest step [s], by default a twentieth of the duration. Callables of time that
        act briefly are seen only where a step ends inside.
    start : Result, State or path, optional
        The run begins at the last state of a result, at ``result.state(i)``, or where the file of a result or
        a checkpoint ends, at time 0. Bodies must be the same, loads and joints may differ. A static result
        gives the positions; the velocities are those of the bodies. What friction remembers begins anew: what
        was held by it slips until the bristles have bent again (:func:`pliant.resume` goes on with them).
    spectral_radius : float, optional
        Numerical damping: 1 damps nothing, 0 most; 0.8 by default, 0.5 with contact. At most 0.98 with
        constraints.
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
    duration = _check.number(duration, "duration", above=0)
    steps = Steps.checked(step, rtol, atol, max_step, duration)
    plan = Plan.checked(duration, steps, output_every, output_times, checkpoint, on_step is not None)
    _check_on_step(on_step)
    progress = None if progress is None else _check.flag(progress, "progress")
    stepper = _begin(
        model,
        plan,
        steps,
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
        with progress_bar(progress, plan.ticks) as report:
            before = 0
            for leg in plan.legs:
                while not plan.is_done(stepper, leg):
                    if stop is not None and stop.is_set():
                        raise KeyboardInterrupt
                    if on_step is not None and on_step(stepper) is True:
                        plan.finish(stepper)
                        stepper._finish()
                        return stepper.result
                    plan.take(stepper, leg, single=on_step is not None)
                    if plan.is_done(stepper, leg):
                        plan.reach(stepper, leg)
                    plan.save(stepper)
                    now = plan.tick(stepper)
                    report(now - before)
                    before = now
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
    from concurrent.futures import ThreadPoolExecutor
    from concurrent.futures import wait as wait_for
    from threading import Event

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
    step: float | Literal["auto"],
    rtol: float | None = None,
    atol: float | None = None,
    max_step: float | None = None,
    output_every: int = 1,
    output_times: ArrayLike | None = None,
    **options: Any,
) -> Result:
    duration = _check.number(duration, "duration", above=0)
    steps = Steps.checked(step, rtol, atol, max_step, duration)
    plan = Plan.checked(duration, steps, output_every, output_times, None, False)
    return _drive(_begin(model, plan, steps, **{**options, "threads": 1}), plan, None, False, stop)


def _begin(model: Model, plan: Plan, steps: Steps, **options: Any) -> Stepper:
    if steps.step is None:
        how: dict[str, Any] = {
            "step": "auto",
            "rtol": steps.rtol,
            "atol": steps.atol,
            "max_step": steps.max_step,
        }
    else:
        how = {"step": plan.legs[0].step}
    stepper = Stepper(model, **how, **options)
    if not plan.keeps_start:
        stepper._forget()
    return stepper
