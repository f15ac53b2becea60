"""Equilibria, and paths of them."""

from __future__ import annotations

import os
import warnings
from collections.abc import Iterable
from typing import Any

from pliant import _check
from pliant._lowered import is_load
from pliant._running import (
    CallableInputs,
    as_records,
    build,
    multipliers,
    name_contact,
    name_node,
    require_model,
    require_state,
    start_vectors,
    warn_of_overlap,
)
from pliant.errors import ConvergenceError, ModelError, translated
from pliant.forces import ForceData
from pliant.gas import Chamber
from pliant.model import Model
from pliant.points import Load, require_handle
from pliant.progress import progress_bar
from pliant.readings import Statistics
from pliant.records import State
from pliant.result import Result

__all__ = ["solve_static"]

PathLike = str | os.PathLike[str]

ARC_STEPS = 20  # least number of steps of a path


def solve_static(
    model: Model,
    *,
    start: Result | State | PathLike | None = None,
    load_steps: int | None = None,
    arc_length: bool = False,
    scale: Load | str | Iterable[Load | str] | None = None,
    tolerance: float | None = None,
    stable: bool = True,
    progress: bool | None = None,
) -> Result:
    """Find the equilibrium of a model under its loads.

    Bodies with contact do not pass through each other on the way there: each increment of the search ends
    where they press, and what slides off its support is found where it comes to rest.

    Parameters
    ----------
    model : Model
        The model; it is not changed.
    start : Result or State, optional
        Where the search begins; bodies must be the same. All constants act in full from there, and the force
        by which the start is out of balance fades as the load factor goes to 1.
    load_steps : int, optional
        Constants, gravity included, grow in so many steps, 1 by default; callables, Tables and drives are
        evaluated at the load factor. Steps are cut when they fail. Along a path the least number of steps, 20
        by default.
    arc_length : bool
        Follow the path of equilibria through limit points, where the load falls again (Riks' method). All its
        points are kept, ``result.load_factor`` may fall and be negative; limit points and bifurcations are
        found and kept as ``result.critical_points``. The last point is full load, reached for the first time.
        Signals are evaluated a little outside of the factors reached, too.
    scale : Load, "gravity" or several of them, optional
        What grows with the load factor; constants of other loads act in full. By default everything grows.
    tolerance : float, optional
        Newton's tolerance, relative to the size of the model.
    stable : bool
        Leave unstable equilibria (a rope straight under compression, a strut above its critical load) for
        stable ones. A path goes over to the branch that crosses where it loses its stability, to the side
        that the loads favour, if there is only one; a round strut, which buckles to all sides alike, stays
        straight: let a small load push it to one (``scale`` keeps that in full). Load steps that come to no
        stable equilibrium, as of very thin sheets just above a critical load, give way to a path with all its
        points. False keeps whatever equilibrium comes first and stays on the path. An unstable end is warned
        of. Under loads that follow the motion stability is not tested.
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

    Four bars that snap through; the load falls after the first limit point, and ends where it is full again:

    >>> arch, stout = pl.Model(), pl.Circle(radius=0.02)
    >>> feet = [(-1, 0, 0), (1, 0, 0), (0, -1, 0), (0, 1, 0)]
    >>> lines = [[foot, (0, 0, 0.02)] for foot in feet]
    >>> bars = [arch.add_cable(line, elements=1, section=stout, material=steel) for line in lines]
    >>> pins = [arch.pin(bar.start) for bar in bars] + [arch.pin(bars[0].end, bar.end) for bar in bars[1:]]
    >>> push = arch.add_force(bars[0].end, (0, 0, -3000))
    >>> path = pl.solve_static(arch, arc_length=True)
    >>> [point.kind for point in path.critical_points]
    ['limit', 'limit']
    """
    model = require_model(model)
    for contact in model._contacts.values():
        if contact.friction is not None:
            # What friction carries at rest depends on how the rest was reached, and a search passes through
            # states that no motion would.
            fault = (
                f"contact '{contact.name}' has friction: many equilibria are possible then, and only the way "
                "there tells which. Let the model come to rest with simulate, or solve one without friction "
                "and start from it"
            )
            _check.fail("model", model, fault)
    arc_length = _check.flag(arc_length, "arc_length")
    load_steps = (
        (ARC_STEPS if arc_length else 1) if load_steps is None else _check.count(load_steps, "load_steps")
    )
    tolerance = None if tolerance is None else _check.number(tolerance, "tolerance", above=0, below=1)
    stable = _check.flag(stable, "stable")
    progress = None if progress is None else _check.flag(progress, "progress")
    grows = None if scale is None else _scaled(model, scale)
    state = None if start is None else require_state(start, "start", model)
    if state is not None and grows is None:
        grows = ()
    model = model.copy()
    lowered, system = build(model, state)
    q, _ = start_vectors(lowered, system, state, model)
    warn_of_overlap(system, model, q)
    inputs = CallableInputs(lowered, lowered.held_values)
    lowered.grows = None if grows is None else list(grows)
    reached = 0.0

    def collect(raw: Any) -> Result:
        rest = ("unstable", "critical")
        records = as_records({key: value for key, value in raw.items() if key not in rest})
        lowered.critical = [
            ("bifurcation" if bifurcation else "limit", index, float(records.time[index]), shape.tolist())
            for index, bifurcation, shape in raw["critical"]
        ]
        return Result(model, lowered, records, static=True, statistics=Statistics(), system=system)

    with progress_bar(progress, 100) as report, inputs.guarded():

        def poll(factor: float) -> None:
            nonlocal reached
            if factor > reached:
                report(round(100 * factor) - round(100 * reached))
                reached = factor

        def search(load_steps: int, arc_length: bool) -> Any:
            with translated():
                return system.solve_static(
                    load_steps=load_steps,
                    tolerance=tolerance,
                    stable=stable,
                    arc_length=arc_length,
                    growing=growing(model, grows),
                    fade=state is not None,
                    q=q,
                    lambda_=multipliers(state, system, q),
                    inputs=inputs.callback,
                    poll=poll,
                )

        try:
            try:
                raw = search(load_steps, arc_length)
            except ConvergenceError as error:
                if arc_length or not stable or not _has_lost_stability(error):
                    raise
                # A load step cannot get round the corner; the path can.
                try:
                    raw = search(max(load_steps, ARC_STEPS), True)
                except (ConvergenceError, ModelError):
                    raise error from None
                arc_length = True
        except (ConvergenceError, ModelError) as error:
            name_node(error, model)
            name_contact(error, model)
            if error.records is not None and len(error.records["time"]):
                error.result = collect(error.records)
            raise
    unstable = raw["unstable"]
    if arc_length:
        # A path passes unstable equilibria; it should not end in one.
        unstable = [factor for factor in unstable[-1:] if factor == raw["time"][-1]]
    if len(unstable):
        factors = ", ".join(f"{factor:g}" for factor in unstable)
        warnings.warn(f"the equilibrium is unstable at load factor {factors}", stacklevel=2)
    return collect(raw)


def _has_lost_stability(error: ConvergenceError) -> bool:
    """Whether load steps came to where stable equilibria bend away, from others before."""
    before = error.records is not None and len(error.records["time"])
    return bool(before) and ("unstable equilibria" in str(error) or "undetermined" in str(error))


def _scaled(model: Model, scale: object) -> tuple[str, ...]:
    """Names of what grows: loads, and "gravity"."""
    several = [scale] if isinstance(scale, (Load, str)) or not isinstance(scale, Iterable) else list(scale)
    names = []
    for one in several:
        if isinstance(one, str) and one == "gravity":
            names.append(one)
            continue
        if not isinstance(one, Load):
            _check.fail("scale", one, 'must be loads of the model or "gravity"')
        require_handle(one, "scale", model.identity)
        if one.name not in model._loads:
            _check.fail("scale", one, "the model has no such load")
        if isinstance(model._loads[one.name], Chamber):
            _check.fail("scale", one, "is a chamber, whose inflow follows the load factor in any case")
        if isinstance(model._loads[one.name], ForceData):
            _check.fail("scale", one, "is a spring, which does not grow: scale a load")
        names.append(one.name)
    return tuple(names)


def growing(model: Model, grows: Iterable[str] | None) -> tuple[bool, list[int]] | None:
    """Whether gravity grows and the core's numbers of the loads that do."""
    if grows is None:
        return None
    loads = [name for name, load in model._loads.items() if is_load(load)]
    chosen = set(grows)
    return "gravity" in chosen, [k for k, name in enumerate(loads) if name in chosen]
