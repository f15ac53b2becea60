"""Running a model step by step."""

from __future__ import annotations

import dataclasses
import math
import os
import weakref
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, NoReturn, TypeVar, cast

from pliant import _check
from pliant._lowered import Lowered, numbers_of, signals_of
from pliant._running import (
    CallableInputs,
    as_records,
    as_statistics,
    build,
    name_node,
    output_path,
    require_model,
    require_state,
    start_vectors,
    thread_count,
    warn_of_overlap,
    warn_of_projection,
)
from pliant._steps import Steps
from pliant.checkpoints import Checkpoint, read, write
from pliant.errors import ConvergenceError, FileError, ModelError, translated
from pliant.latches import checked_gap
from pliant.model import Model
from pliant.points import Handle, Joint, Load, Point, PointMass
from pliant.readings import (
    BeamStrain,
    ChamberGas,
    ContactPatch,
    Energy,
    JointMotion,
    Reaction,
    SpringForce,
    Statistics,
    Strain,
    SurfaceStrain,
    TendonForce,
    Track,
)
from pliant.records import Records, State
from pliant.result import Result
from pliant.signals import Function
from pliant.storage import facts, load_records
from pliant.streams import Stream
from pliant.surfaces import Faces
from pliant.typing import ArrayLike, FloatArray, IntArray, Json

if TYPE_CHECKING:
    from pliant._core import System

__all__ = ["Stepper"]

KNOWN_PLACES = 1024  # points whose place in the coordinates a stepper keeps

T = TypeVar("T")


class Stepper:
    """A run in progress: take steps, look at the present state, set inputs, go back.

    Functions that read the state are those of :class:`pliant.Result`, for one time: shapes lack the first n.

    Parameters
    ----------
    model : Model
        The model; it is not changed.
    step : float or "auto"
        Step [s]; ``"auto"``: as long as the local error allows, within ``rtol``, ``atol`` and ``max_step`` as
        in :func:`pliant.simulate` (``max_step`` is unbounded here unless given).
    start : Result or State, optional
        The run begins there, at time 0, as in :func:`pliant.simulate`.
    record_every : int, optional
        Keep every so manieth step in ``result``; by default the start only.
    spectral_radius : float, optional
        Numerical damping: 1 damps nothing, 0 most; 0.8 by default, 0.5 with contact. At most 0.98 with
        constraints.
    tolerance : float, optional
        Newton's tolerance, relative to the size of the model.
    threads : int, optional
        Threads; the result does not depend on it.
    output : str or path, optional
        Write what is recorded to this result file as it comes, instead of keeping it in memory.

    Examples
    --------
    >>> import pliant as pl
    >>> model = pl.Model(gravity=(0, 0, -9.81))
    >>> ball = model.add_point_mass(2.0, at=(0, 0, 0))
    >>> jet = model.add_force(ball, (0, 0, 1) * pl.Input("jet", initial=2.0 * 9.81))
    >>> stepper = pl.Stepper(model, step=0.01)
    >>> while stepper.time < 1.0:
    ...     error = 0.5 - stepper.position(ball.center)[2]
    ...     speed = stepper.velocity(ball.center)[2]
    ...     stepper.set_input("jet", 2.0 * 9.81 + 100.0 * error - 25.0 * speed)
    ...     stepper.advance()
    >>> print(f"{stepper.position(ball.center)[2]:.2f}")
    0.50
    """

    def __init__(
        self,
        model: Model,
        *,
        step: float | Literal["auto"],
        rtol: float | None = None,
        atol: float | None = None,
        max_step: float | None = None,
        start: Result | State | str | os.PathLike[str] | None = None,
        record_every: int | None = None,
        spectral_radius: float | None = None,
        tolerance: float | None = None,
        threads: int | None = None,
        output: str | os.PathLike[str] | None = None,
    ) -> None:
        model = require_model(model)
        path = output_path(output)
        options: dict[str, Any] = {
            "steps": Steps.checked(step, rtol, atol, max_step).document(),
            "record_every": 0 if record_every is None else _check.count(record_every, "record_every"),
            "spectral_radius": (0.5 if model.contacts else 0.8)
            if spectral_radius is None
            else _check.number(spectral_radius, "spectral_radius", at_least=0, at_most=1),
            "tolerance": None
            if tolerance is None
            else _check.number(tolerance, "tolerance", above=0, below=1),
        }
        threads = thread_count(threads)
        state = None if start is None else require_state(start, "start", model)
        model = model.copy()
        lowered, system = build(model, state)
        if options["spectral_radius"] > 0.98 and system.multipliers > 0:
            _check.fail(
                "spectral_radius",
                options["spectral_radius"],
                "must be at most 0.98 in a model with constraints: undamped, they oscillate and blow up",
            )
        q, v = start_vectors(lowered, system, state, model)
        warn_of_overlap(system, model, q)
        self._set_up(model, lowered, system, options, threads, q=q, v=v, held=lowered.held_values.tolist())
        wanted = v if v is not None else system.initial_v
        warn_of_projection(self._integrator, system, lowered, wanted, state)
        self._start = self._integrator.save()
        self._record()
        if path is not None:
            self._stream_to(path)

    def _set_up(
        self,
        model: Model,
        lowered: Lowered,
        system: System,
        options: Json,
        threads: int,
        **state: Any,
    ) -> None:
        self.model = model
        self._lowered = lowered
        self._system = system
        self._options = options
        self._lengths = Steps.read(options["steps"])
        self._record_every: int = options["record_every"]
        self._inputs = CallableInputs(lowered)
        self._chunks: list[Records] = []
        self._stream: Stream | None = None
        self._recorded_to: float | None = None
        self._present: Result | None = None
        self._reader: Result | None = None
        self._places: dict[Point, tuple[list[int], list[float]]] = {}
        self._offsets: dict[str, IntArray] = {}
        with self._inputs.guarded(), translated():
            self._integrator = system.integrator(
                spectral_radius=options["spectral_radius"],
                tolerance=options["tolerance"],
                threads=threads,
                inputs=self._inputs.callback,
                **state,
            )

    def __repr__(self) -> str:
        return f"<Stepper: {self._steps} steps to {self.time:g} s>"

    # Steps

    @property
    def time(self) -> float:
        """Time reached [s]."""
        return self._integrator.time

    def advance(self, steps: int = 1, *, until: float | None = None) -> None:
        """Take steps.

        Parameters
        ----------
        steps : int
            Their number. On failure or Ctrl-C the exception's ``result`` holds what was recorded, and the
            stepper stays at the last step that it reached.
        until : float, optional
            Instead of their number the time that the last one ends at exactly [s]; fixed steps are made a
            little smaller so that a whole number of them fits.

        Examples
        --------
        >>> import pliant as pl
        >>> model = pl.Model(gravity=(0, 0, -9.81))
        >>> ball = model.add_point_mass(1.0, at=(0, 0, 0))
        >>> stepper = pl.Stepper(model, step="auto", rtol=1e-8)
        >>> stepper.advance(until=0.5)
        >>> print(f"{stepper.time} s: {stepper.position(ball.center)[2]:.4f} m")
        0.5 s: -1.2263 m
        """
        if until is not None:
            self._advance_until(steps, _check.number(until, "until", at_least=self.time))
            return
        if steps != 1 or steps is True:
            steps = _check.count(steps, "steps")
        step = self._lengths.step
        while steps > 0:
            if step is None:
                steps -= self._take_freely(math.inf, steps, self._record_every)
            else:
                steps -= self._take(steps, step, self._record_every)

    def _advance_until(self, steps: int, end: float) -> None:
        if steps != 1:
            _check.fail("steps", steps, "cannot go with until")
        length = self._lengths.step
        if length is None:
            while self.time < end:
                self._take_freely(end, None, self._record_every)
        elif end > self.time:
            rest = end - self.time
            left = max(1, math.ceil(rest / length * (1 - 1e-9)))
            step = rest / left
            while left > 0:
                left -= self._take(left, step, self._record_every, end, left)

    def set_input(self, name: str, value: ArrayLike) -> None:
        """Set a :class:`pliant.Input`; over the next step it goes from what it was to this value.

        Parameters
        ----------
        name : str
            Name of the input.
        value : float or array_like, shape (3,)
            As many numbers as its initial value.
        """
        slot = self._lowered.held.get(name) if isinstance(name, str) else None
        if slot is None:
            known = ", ".join(self._lowered.held) or "there are none"
            _check.fail("name", name, f"must be an input of the model ({known})")
        first, initial = slot
        if len(initial) == 1:
            values = [_check.number(value, "value")]
        else:
            values = _check.vector(value, "value").tolist()
        self._present = None
        self._integrator.set_inputs(first, values)

    def release(self, joint: Joint) -> None:
        """Let a joint go now.

        Parameters
        ----------
        joint : Joint
            A joint that holds; one that is free already stays so.
        """
        self._switch(joint, False, None)

    def engage(self, joint: Joint, *, gap: float | None = None) -> None:
        """Engage a joint now, see :meth:`Joint.engage`.

        Parameters
        ----------
        joint : Joint
            A joint that was released, or made with ``engaged=False``; one that holds already stays as it is.
        gap : float, optional
            Distance [m] up to which points that the joint was given may be apart; by default a millionth of
            the model's size.
        """
        self._switch(joint, True, None if gap is None else checked_gap(gap))

    def _switch(self, joint: Joint, engage: bool, gap: float | None) -> None:
        plan = self._now._plan_of(joint)
        self.model._require_latch(joint.name)
        numbers = numbers_of(plan)
        if not numbers:
            _check.fail(
                "joint",
                joint,
                "pins that always hold share coordinates: make one that is to be released while stepping "
                "with engaged=False, and engage it at 0: pin.engage(at=0.0)",
            )
        self._present = None
        try:
            with self._inputs.guarded(), translated():
                for number in numbers:
                    self._integrator.switch(number, engage, gap)
        except ConvergenceError as error:
            # Nothing has been computed: what was asked for cannot be.
            raise ModelError(f"joint = '{joint.name}': {error}") from error

    def reset(self, state: State | None = None) -> None:
        """Go back, bit for bit, and forget what was recorded.

        Parameters
        ----------
        state : State, optional
            What :attr:`state` was, of this stepper or of one of the same model; by default the start.
        """
        saved = self._start
        if state is not None:
            if not isinstance(state, State):
                _check.fail("state", state, "must be the state of a stepper")
            state = require_state(state, "state", self.model)
            if state.saved is None:
                _check.fail("state", state, "must be the state of a stepper")
            saved = state.saved
        with self._inputs.guarded(), translated():
            self._integrator.reset(saved)
        self._forget()
        self._record()

    # What it is now

    @property
    def state(self) -> State:
        """Present state: for :meth:`reset`, or as a start; it can be pickled."""
        return dataclasses.replace(self._now.state(0), saved=self._integrator.save())

    @property
    def coordinates(self) -> FloatArray:
        """Coordinates of the whole model, one array."""
        return self._integrator.q

    @property
    def velocities(self) -> FloatArray:
        """Velocities of the whole model, one array."""
        return self._integrator.v

    @property
    def statistics(self) -> Statistics:
        """Steps, iterations, seconds so far."""
        return as_statistics(self._integrator.statistics())

    @property
    def result(self) -> Result:
        """What was recorded."""
        return self._as_result(self._recorded(), self.statistics)

    def position(self, point: Point | PointMass) -> FloatArray:
        """Position of a material point [m], (3,)."""
        return self._read(point, velocities=False)

    def velocity(self, point: Point | PointMass) -> FloatArray:
        """Velocity of a material point [m/s], (3,)."""
        return self._read(point, velocities=True)

    def positions(self, body: Handle | str) -> FloatArray:
        """Positions of the nodes of a body [m], (nodes, 3)."""
        return _only(self._now.positions(body))

    def track(self, point: Point | PointMass) -> Track:
        """Position, velocity and acceleration of a material point, each (3,)."""
        return _only(self._now.track(point))

    def joint(self, joint: Joint) -> JointMotion:
        """Position, velocity and force along the freedom of a joint, numbers."""
        return _only(self._now.joint(joint))

    def spring(self, spring: Load) -> SpringForce:
        """Length, rate and force of a spring, numbers."""
        return _only(self._now.spring(spring))

    def reaction(self, joint: Joint) -> Reaction:
        """Force and moment that a joint exerts on its first body, each (3,)."""
        return _only(self._now.reaction(joint))

    def tendon(self, tendon: Load) -> TendonForce:
        """Length and tension of a tendon, and the tensions of its spans (spans,)."""
        return _only(self._now.tendon(tendon))

    def chamber(self, chamber: Load) -> ChamberGas:
        """Pressure, volume, mass and temperature of the gas in a chamber, numbers."""
        return _only(self._now.chamber(chamber))

    def axial_force(self, body: Handle | str) -> FloatArray:
        """Axial force [N] at mid-element, (elements,); of a net the mean in each cable, (cables,)."""
        return _only(self._now.axial_force(body))

    def cut_force(self, faces: Faces) -> FloatArray:
        """Force [N] through a cut of a surface, (3,); see :meth:`pliant.Result.cut_force`."""
        return _only(self._now.cut_force(faces))

    def strain(self, body: Handle | str) -> Strain | BeamStrain | SurfaceStrain:
        """Strains in the middle of elements; see :meth:`pliant.Result.strain`."""
        return _only(self._now.strain(body))

    @property
    def energy(self) -> Energy:
        """Energies [J]."""
        return _only(self._now.energy)

    def contact_force(self, a: Handle | str, b: Handle | str | None = None) -> FloatArray:
        """Force that contact exerts on a body, from another or from all it touches [N], (3,)."""
        return _only(self._now.contact_force(a, b))

    def contact_impulse(self, a: Handle | str, b: Handle | str | None = None) -> FloatArray:
        """Integral of :meth:`contact_force` over every step so far [N s], (3,)."""
        return _only(self._now.contact_impulse(a, b))

    @property
    def contacts(self) -> list[ContactPatch]:
        """Where bodies touch, and the forces there; see :attr:`pliant.Result.contacts`."""
        return self._now.contacts[0]

    @property
    def momentum(self) -> FloatArray:
        """Linear momentum [kg m/s], (3,)."""
        return _only(self._now.momentum)

    @property
    def angular_momentum(self) -> FloatArray:
        """Angular momentum about the world's origin [kg m^2/s], (3,)."""
        return _only(self._now.angular_momentum)

    @property
    def momentum_rate(self) -> FloatArray:
        """Rate of the linear momentum [N], (3,)."""
        return _only(self._now.momentum_rate)

    @property
    def angular_momentum_rate(self) -> FloatArray:
        """Rate of the angular momentum about the world's origin [N m], (3,)."""
        return _only(self._now.angular_momentum_rate)

    def center_of_mass(self, body: Handle | str | None = None) -> FloatArray:
        """Centre of mass of the model or of one body [m], (3,)."""
        return _only(self._now.center_of_mass(body))

    # Files

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the run to a file, with what was recorded; :meth:`load` continues it with the same bits."""
        self._write(path, None)

    @classmethod
    def load(cls, path: str | os.PathLike[str], model: Model | None = None) -> Stepper:
        """Continue a run that :meth:`save` or ``simulate(..., checkpoint=...)`` wrote.

        Parameters
        ----------
        path : str or path
            The file.
        model : Model, optional
            The model that was run, needed where loads are Python callables: files cannot hold those.
        """
        return cls._restored(read(path), model, None)

    # Inside

    @property
    def _steps(self) -> int:
        return self._integrator.steps

    def _read(self, point: Point | PointMass, *, velocities: bool) -> FloatArray:
        """Read a point; where it is found, which model it belongs to included, does not change with time."""
        # Points alone: handles of different kinds may be equal, those of copies of the model for instance.
        place = self._places.get(point) if type(point) is Point else None
        if place is None:
            checked = self.model._point(point, "point")
            if self._reader is None:
                self._reader = self._now
            offsets, weights = self._reader._where(checked)
            place = (offsets.tolist(), weights.tolist())
            if len(self._places) >= KNOWN_PLACES:
                self._places.clear()
            self._places[checked] = place
        return self._integrator.combine(*place, velocities)

    @property
    def _now(self) -> Result:
        """The present state as a result of one row."""
        if self._present is None:
            self._present = self._as_result(as_records(self._integrator.present()), Statistics())
        return self._present

    def _as_result(self, records: Records, statistics: Statistics) -> Result:
        result = Result(
            self.model, self._lowered, records, static=False, statistics=statistics, system=self._system
        )
        result._known_offsets = self._offsets
        return result

    def _take(self, steps: int, step: float, every: int, end: float | None = None, left: int = 0) -> int:
        """Take steps for about a tenth of a second; the last of those ``left`` lands on the time ``end``."""
        self._present = None
        try:
            return self._integrator.advance(steps, step, every, end=end if steps == left else None)
        except BaseException as error:
            self._fail(error)
        finally:
            if self._stream is not None:
                self._drain(self._stream)

    def _take_freely(self, end: float, steps: int | None, every: int) -> int:
        """Take steps as long as the accuracy allows, up to the time ``end``, for a tenth of a second."""
        self._present = None
        lengths = self._lengths
        limit = {} if steps is None else {"steps": steps}
        try:
            return self._integrator.advance_freely(
                end,
                rtol=lengths.rtol,
                atol=lengths.atol,
                max_step=lengths.max_step,
                output_every=every,
                **limit,
            )
        except BaseException as error:
            self._fail(error)
        finally:
            if self._stream is not None:
                self._drain(self._stream)

    def _fail(self, error: BaseException) -> NoReturn:
        """Raise the error in the words of pliant, with the result so far."""
        try:
            with self._inputs.guarded(), translated():
                raise error
        except (KeyboardInterrupt, ConvergenceError, ModelError) as clear:
            name_node(clear, self.model)
            clear.result = self.result  # type: ignore[union-attr]
            raise

    def _record(self, again: bool = True) -> None:
        """Keep the present state; with ``again`` off only where it was not kept already."""
        if not again:
            if self._stream is not None:
                self._drain(self._stream)
                last = self._recorded_to
            else:
                times = self._recorded().time
                last = float(times[-1]) if len(times) else None
            if last == self.time:
                return
        try:
            self._integrator.record()
        except BaseException as error:
            self._fail(error)

    def _stream_to(self, path: Path) -> None:
        """Write what is recorded to a file from here on."""
        records = self._recorded()
        here = self._as_result(records, Statistics())
        self._stream = Stream.continued(path, facts(here, static=False), records)
        self._chunks.clear()
        # What is left goes to disk when the stepper is forgotten, or Python ends.
        weakref.finalize(self, self._stream.close)

    def _drain(self, stream: Stream) -> None:
        """Hand what was recorded to the file."""
        rows = as_records(self._integrator.records())
        if len(rows.time):
            self._recorded_to = float(rows.time[-1])
            stream.add(rows)

    def _finish(self) -> None:
        """Close the file."""
        if self._stream is not None:
            self._drain(self._stream)
            self._stream.flush(dataclasses.asdict(self.statistics))
            self._stream.close()

    def _recorded(self) -> Records:
        if self._stream is not None:
            self._drain(self._stream)
            self._stream.flush(dataclasses.asdict(self.statistics))
            return load_records(self._stream.path)
        chunks = [*self._chunks, as_records(self._integrator.records())]
        chunks = [chunk for chunk in chunks if len(chunk.time)] or chunks[-1:]
        self._chunks = [Records.joined(chunks)]
        return self._chunks[0]

    def _forget(self) -> None:
        self._integrator.records()
        self._chunks.clear()
        self._present = self._recorded_to = None
        if self._stream is not None:
            self._stream.restart()

    def _write(self, path: str | os.PathLike[str], run: Json | None) -> None:
        saved = self._integrator.save()
        present = as_records(self._integrator.present())
        output = None
        if self._stream is None:
            records = self._recorded()
        else:
            self._drain(self._stream)
            self._stream.flush()
            records, output = present[:0], (str(self._stream.path.absolute()), self._stream.rows)
        write(
            path,
            Checkpoint(
                self.model, self._lowered, self._options, run, self._start, saved, present, records, output
            ),
        )

    @classmethod
    def _restored(cls, saved: Checkpoint, model: Model | None, threads: int | None) -> Stepper:
        from pliant import _core

        if model is not None:
            _require_same(require_model(model), saved.model)
            _give_functions(saved.lowered, model)
        elif saved.lowered.inputs:
            _check.fail("model", None, "loads of this run are Python callables: give the model that was run")
        stepper = cls.__new__(cls)
        try:
            with translated():
                system = _core.System(saved.lowered.spec, saved.lowered.arrays)
            used = saved.model if model is None else model.copy()
            threads = thread_count(threads)
            stepper._set_up(used, saved.lowered, system, saved.options, threads, saved=saved.saved)
        except (KeyError, TypeError, ModelError) as error:
            raise FileError(f"the checkpoint cannot be used: {error}") from error
        stepper._start = saved.start
        stepper._chunks = [saved.recorded()]
        times = stepper._chunks[0].time
        stepper._recorded_to = float(times[-1]) if len(times) else None
        if saved.output is not None:
            stepper._stream_to(Path(saved.output[0]))
        return stepper


def _only(rows: T) -> T:
    """Give the only row of what a result reads."""
    only: Any = rows
    if dataclasses.is_dataclass(only) and not isinstance(only, type):
        columns = {entry.name: getattr(only, entry.name) for entry in dataclasses.fields(only)}
        # A line has no orientation, say.
        only = dataclasses.replace(only, **{k: rows[0] for k, rows in columns.items() if rows is not None})
    else:
        only = only[0]
    return cast("T", only)


def _require_same(model: Model, saved: Model) -> None:
    """Refuse a model other than the one that was run."""
    ours, theirs = (m.to_document(keep_functions=False) for m in (model, saved))
    for key in ours:
        if key != "identity" and ours[key] != theirs[key]:
            _check.fail("model", model, f"is not the model that was run: its {key} differ")


def _give_functions(lowered: Lowered, model: Model) -> None:
    """Put the callables of a model where they are missing, in the order of their numbers."""
    found: dict[str, list[Function]] = {}
    for item in [*model._bodies.values(), *model._joints.values(), *model._loads.values()]:
        found[item.name] = [one for signal in signals_of(item) for one in signal.functions()]
    for entry in lowered.inputs:
        entry.function = found[entry.load].pop(0)
