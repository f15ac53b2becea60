"""What all solvers share: building a system, its inputs and its start, and reading what the core answers."""

from __future__ import annotations

import os
import re
import sys
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from pliant import _check
from pliant._lower import lower
from pliant._lowered import Lowered
from pliant.beams import BeamBody
from pliant.bodies import LineBody, MassBody
from pliant.checkpoints import read
from pliant.contacts import ContactData
from pliant.errors import ConvergenceError, FileError, ModelError, translated
from pliant.model import Model
from pliant.readings import Statistics
from pliant.records import Records, State
from pliant.result import Result
from pliant.storage import is_result, load
from pliant.surfaces import SurfaceBody
from pliant.typing import FloatArray

if TYPE_CHECKING:
    from pliant._core import Integrator, System

__all__ = [
    "CallableInputs",
    "as_records",
    "as_statistics",
    "build",
    "multipliers",
    "name_contact",
    "name_node",
    "output_path",
    "require_model",
    "require_state",
    "start_vectors",
    "thread_count",
    "warn_of_overlap",
    "warn_of_projection",
]


def require_model(model: object) -> Model:
    if not isinstance(model, Model):
        _check.fail("model", model, "must be a pliant.Model")
    if not model._bodies:
        _check.fail("model", model, "has no bodies; add one, such as model.add_cable(...)")
    return model


def output_path(output: object) -> Path | None:
    """Return the path of a result file that is to be written."""
    if output is None:
        return None
    if not isinstance(output, (str, os.PathLike)) or not os.fspath(output):
        _check.fail("output", output, "must be the path of a result file, such as 'run.h5'")
    path = Path(os.fsdecode(output))
    if not path.parent.is_dir():
        raise FileError(f"{path}: cannot be written: there is no such folder")
    return path


def thread_count(threads: int | None) -> int:
    if threads is not None:
        return _check.count(threads, "threads", at_most=1024)
    available = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    return min(available, 16)


def build(model: Model, state: State | None) -> tuple[Lowered, System]:
    from pliant import _core

    bodies = None
    if state is not None:
        bodies = dict(state.bodies)
        if state.static:
            fresh = _initial(model)
            bodies = {
                name: b._replace(v_r=fresh[name].v_r, v_t=fresh[name].v_t) for name, b in bodies.items()
            }
    lowered = lower(model, bodies, *((None, None) if state is None else (state.gas, _past(model, state))))
    with translated():
        return lowered, _core.System(lowered.spec, lowered.arrays)


def _past(model: Model, state: State) -> dict[str, FloatArray]:
    """Give what cables remember of having yielded, where this model's cables can."""
    kept = {}
    for name, past in state.past.items():
        body = model._bodies[name]
        assert isinstance(body, LineBody)
        if body.yield_strain is not None and past.size == 2 * body.axial_points * body.elements:
            kept[name] = past
        elif past.any():
            raise ModelError(
                f"start: '{name}' has yielded there: here, too, its material must be a BilinearPlastic, with "
                "the same integration"
            )
    return kept


def _initial(model: Model) -> Any:
    from pliant._lowered import initial_state

    return initial_state(model)


def start_vectors(
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
        if name in lowered.surfaces:
            first, nodes, vectors = system.surface_offsets()[lowered.surfaces[name]]
            index = first + np.arange(3 * nodes * vectors)
            q[index], v[index] = body.r.ravel(), moving.v_r.ravel()
            continue
        if name in lowered.beams:
            first, nodes = system.beam_offsets()[lowered.beams[name]]
            index = first + np.arange(12 * nodes)
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


def multipliers(state: State | None, system: System, q: FloatArray | None) -> FloatArray | None:
    """Multipliers of the state where they are those of the system, else None."""
    if state is None or q is None or len(q) != len(state.q) or len(state.lambda_) != system.multipliers:
        return None
    return state.lambda_


class CallableInputs:
    """Callables of the loads, gathered into one function of time; keeps the error that one of them raised.

    ``held`` are values that stand before theirs: those of inputs, where the core does not hold them itself.
    """

    def __init__(self, lowered: Lowered, held: FloatArray | None = None) -> None:
        self._inputs = lowered.inputs
        self._held = np.empty(0) if held is None else held
        self._error: BaseException | None = None
        self.callback: Callable[[float], FloatArray] | None = (
            self._evaluate if self._inputs or len(self._held) else None
        )

    def _evaluate(self, t: float) -> FloatArray:
        values = [self._held]
        for item in self._inputs:
            assert item.function is not None
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
            error, self._error = self._error, None
            if error is not None:
                raise error from error.__cause__
            raise


def warn_of_projection(
    integrator: Integrator, system: System, lowered: Lowered, v: FloatArray, state: State | None
) -> None:
    """Tell by how much joints changed the velocities of points; a restart's roundoff is not worth a word."""
    firsts = [system.cable_offsets(k)[:, 0] for k in lowered.cables.values()]
    firsts += [system.shared_offsets(), system.rigid_offsets()]
    index = np.concatenate(firsts)[:, None] + np.arange(3)
    axes = system.rigid_offsets()[:, None] + np.arange(3, 12)
    small = 1e-9 if state is None else 1e-3
    for places, unit in ((index, "m/s"), (axes, "rad/s")):
        wanted = v[places]
        change = float(np.linalg.norm(integrator.v[places] - wanted, axis=1).max(initial=0.0))
        speed = float(np.linalg.norm(wanted, axis=1).max(initial=0.0))
        if change > 1e-3 * speed and integrator.projection > small * speed and change > 1e-9:
            if unit == "rad/s":
                change /= np.sqrt(2.0)  # |omega x e_i| over the three axes
            warnings.warn(
                "initial velocities contradict joints or drives; they were projected, by up to "
                f"{change:.3g} {unit}",
                stacklevel=_levels_to_the_caller(),
            )
            return


SHOWN = 3
"""Overlaps that are told one by one."""


def warn_of_overlap(system: System, model: Model, q: FloatArray | None) -> None:
    """Tell which bodies are in each other at the start by more than any load would press them."""
    found = sorted(system.overlaps(q), key=lambda one: one[1] / one[2], reverse=True)
    if not found:
        return
    told = [
        f"{_sides_of(model._contacts[name])} by {depth:.3g} m ('{name}'; half the thinner one's thickness is "
        f"{half:.3g} m)"
        for name, depth, half in found[:SHOWN]
    ]
    if len(found) > SHOWN:
        told.append(f"{len(found) - SHOWN} more")
    warnings.warn(
        f"bodies overlap at the start: {'; '.join(told)}. Contact will throw them apart; place them beside "
        "each other, or leave out their contact",
        stacklevel=_levels_to_the_caller(),
    )


def _sides_of(contact: ContactData) -> str:
    return f"'{contact.a}' itself" if contact.a == contact.b else f"'{contact.a}' and '{contact.b}'"


def _levels_to_the_caller() -> int:
    """Levels of the stack from who asks to the line outside of pliant."""
    level, frame = 0, sys._getframe(1)
    while frame.f_back is not None and frame.f_globals.get("__name__", "").startswith("pliant."):
        level, frame = level + 1, frame.f_back
    return level + 1


def name_contact(error: BaseException, model: Model) -> None:
    """Add the bodies to a contact that the core blames."""
    if isinstance(error, ConvergenceError):
        text = re.sub(
            r"contact '([^']*)'",
            lambda found: (
                f"{found[0]} of {_sides_of(model._contacts[found[1]])}"
                if found[1] in model._contacts
                else found[0]
            ),
            str(error),
        )
        error.args = (text, *error.args[1:])


def name_node(error: BaseException, model: Model) -> None:
    """Turn the strand node that the core blames into the node of the body."""
    if isinstance(error, ConvergenceError) and error.node is not None:
        body = model._bodies.get(error.body or "")
        if isinstance(body, LineBody) and error.node < len(body.users):
            error.node = int(body.users[error.node])


def as_records(raw: Any) -> Records:
    return Records(**{key: np.asarray(value) for key, value in raw.items()})


def as_statistics(raw: dict[str, Any]) -> Statistics:
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


def require_state(start: object, name: str, model: Model) -> State:
    """Return ``start`` as a state whose bodies are those of the model; a path is that of a file of a run."""
    if isinstance(start, (str, os.PathLike)):
        start = load(start) if is_result(start) else read(start).state
    if isinstance(start, Result):
        if not len(start.time):
            _check.fail(name, start, "holds no state")
        start = start.state(-1)
    if not isinstance(start, State):
        _check.fail(name, start, "must be a Result, result.state(i), or the path of a result or checkpoint")
    ours, theirs = (
        {
            key: (body.kind, body.nodes, tuple(body.strands))
            if isinstance(body, LineBody)
            else (body.element, body.quads.tobytes(), body.triangles.tobytes())
            if isinstance(body, SurfaceBody)
            else ("beam", body.nodes)
            if isinstance(body, BeamBody)
            else ("mass", body.at and replace(body.at, identity=""))
            if isinstance(body, MassBody)
            else ("rigid", body.mass)
            for key, body in m._bodies.items()
        }
        for m in (model, start.model)
    )
    for key in {**theirs, **ours}:
        if ours.get(key) != theirs.get(key):
            raise ModelError(
                f"{name}: bodies must be the same in both models, but '{key}' "
                + (
                    "is missing in one"
                    if key not in ours or key not in theirs
                    else "differs in kind or in elements"
                )
            )
    return start
