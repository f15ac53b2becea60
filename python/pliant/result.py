"""Results: what was computed, as arrays, pictures and files."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from pliant import _check
from pliant._lower import BodyState, Lowered
from pliant.bodies import GAUSS_5, LineBody, MassBody, hermite
from pliant.errors import ModelError, translated
from pliant.joints import Hinge
from pliant.loads import Force, LineLoad
from pliant.points import Handle, Joint, Point, PointMass, RigidBody, WorldPoint, require_handle
from pliant.rigid import RigidBodyData
from pliant.signals import scaled
from pliant.typing import ArrayLike, FloatArray, IntArray, Json

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from scipy.spatial.transform import Rotation

    from pliant._core import System
    from pliant.model import Model

__all__ = ["Energy", "JointMotion", "Reaction", "Result", "State", "Statistics", "Strain", "Track"]


@dataclass(frozen=True)
class Track:
    """Motion of a point: position [m], velocity [m/s] and acceleration [m/s^2], each (n, 3).

    Attributes
    ----------
    axes : (n, 3, 3) or None
        Axes of the rigid body that holds the point, one a row.
    """

    position: FloatArray
    velocity: FloatArray
    acceleration: FloatArray
    axes: FloatArray | None = None

    @property
    def orientation(self) -> Rotation:
        """Orientation of a rigid body, n Rotations from body axes to the world."""
        if self.axes is None:
            raise AttributeError("orientation: only points of rigid bodies have one")
        from scipy.spatial.transform import Rotation

        return Rotation.from_matrix(np.swapaxes(self.axes, -1, -2))


@dataclass(frozen=True)
class JointMotion:
    """Freedom of a joint: angle [rad], unwrapped, or way [m], and its rate, each (n,)."""

    position: FloatArray
    velocity: FloatArray


@dataclass(frozen=True)
class Reaction:
    """What a joint exerts on its first body: force [N] and moment about its point [N m], each (n, 3)."""

    force: FloatArray
    moment: FloatArray


@dataclass(frozen=True)
class Strain:
    """Axial strain (n, elements) and curvature vector [1/m] (n, elements, 3) at mid-element."""

    axial: FloatArray
    curvature: FloatArray


@dataclass(frozen=True)
class Energy:
    """Energies [J], each (n,); ``total`` stays constant."""

    kinetic: FloatArray
    elastic: FloatArray
    gravitational: FloatArray
    dissipated: FloatArray
    work: FloatArray

    @property
    def total(self) -> FloatArray:
        """Kinetic + elastic + gravitational + dissipated - work [J], (n,)."""
        return self.kinetic + self.elastic + self.gravitational + self.dissipated - self.work


@dataclass(frozen=True)
class Statistics:
    """Counters of a run, seconds by part, and the largest memory of the process [bytes]."""

    steps: int = 0
    rejected: int = 0
    newton_iterations: int = 0
    factorizations: int = 0
    seconds: Mapping[str, float] = field(default_factory=dict)
    peak_memory: int = 0


@dataclass(frozen=True, eq=False)
class State:
    """State of the bodies at one time: a start for another run; ``saved`` is what a stepper goes back by."""

    model: Model
    bodies: Mapping[str, BodyState]
    static: bool
    time: float
    q: FloatArray
    lambda_: FloatArray
    saved: bytes | None = None

    def __reduce__(self) -> tuple[Any, ...]:
        # Callables of the model cannot be pickled, and a state needs only the bodies.
        document = self.model.to_document(keep_functions=False)
        rest = (dict(self.bodies), self.static, self.time, self.q, self.lambda_, self.saved)
        return _restored_state, (document, *rest)


def _restored_state(document: Any, *rest: Any) -> State:
    from pliant.model import Model

    return State(Model.from_document(document, "state"), *rest)


@dataclass(frozen=True, eq=False)
class Records:
    """Raw arrays of a run, one row an output."""

    time: FloatArray
    q: FloatArray
    v: FloatArray
    a: FloatArray
    lambda_: FloatArray
    energy: FloatArray
    inputs: FloatArray


class Result:
    """What :func:`pliant.simulate` or :func:`pliant.solve_static` computed.

    Attributes
    ----------
    time : ndarray, shape (n,)
        Times [s] (statics: load factors) of the outputs; entry 0 is the start.
    model : Model
        The model that was run.
    statistics : Statistics
        Steps, iterations, seconds.
    """

    def __init__(
        self,
        model: Model,
        lowered: Lowered,
        records: Records,
        *,
        static: bool,
        statistics: Statistics,
        system: System | None = None,
    ) -> None:
        self.model = model
        self.statistics = statistics
        self.time: FloatArray = records.time
        self.is_static = static
        self._records = records
        self._lowered = lowered
        self._built = system
        self._known_offsets: dict[str, IntArray] = {}

    def __repr__(self) -> str:
        kind = "load factor" if self.is_static else "s"
        last = f"{self.time[-1]:g}" if len(self.time) else "nothing"
        return f"<Result: {len(self.time)} outputs to {last} {kind}>"

    @property
    def load_factor(self) -> FloatArray:
        """Load factors (n,) of a static result; the last is full load."""
        if not self.is_static:
            raise AttributeError("load_factor: only the results of solve_static have one")
        return self.time

    # Motion

    def positions(self, body: Handle | str) -> FloatArray:
        """Positions of the nodes of a body [m], shape (n, nodes, 3)."""
        return self._nodes(body, self._records.q)

    def velocities(self, body: Handle | str) -> FloatArray:
        """Velocities of the nodes of a body [m/s], shape (n, nodes, 3)."""
        return self._nodes(body, self._records.v)

    def track(self, point: Point | PointMass | RigidBody) -> Track:
        """Motion of a material point, interpolated in its element.

        Parameters
        ----------
        point : Point
            Such as ``rope.end`` or ``rope.at(0.3)``.

        Returns
        -------
        Track
            ``position``, ``velocity``, ``acceleration``, each (n, 3); ``orientation`` on rigid bodies.
        """
        at = self.model._point(point, "point")
        records = self._records
        axes = None
        if at.local is not None:
            offsets = self._offsets(at.body)[1:] + np.arange(3)
            axes = np.ascontiguousarray(records.q[:, offsets])
        position, velocity, acceleration = (self._at(at, rows) for rows in (records.q, records.v, records.a))
        return Track(position, velocity, acceleration, axes)

    def joint(self, joint: Joint) -> JointMotion:
        """Motion of a joint along its freedom: the angle of a hinge, the way of a slider.

        Parameters
        ----------
        joint : Joint
            Handle that ``hinge`` or ``slider`` returned.

        Returns
        -------
        JointMotion
            ``position`` (zero at the model's start) and ``velocity`` of the first body against the second,
            each (n,).
        """
        plan = self._plan_of(joint)
        motion = None
        if plan["kind"] == "multiplier":
            with translated():
                motion = self._system.joint_motion(plan["index"], self._records.q, self._records.v)
        if motion is None:
            _check.fail("joint", joint, "must be a hinge or a slider, whose freedom is one number")
        if isinstance(self.model._joints[joint.name], Hinge):
            motion[:, 0] = np.unwrap(motion[:, 0])
        return JointMotion(*np.ascontiguousarray(motion.T))

    def state(self, i: int) -> State:
        """State at output ``i`` (negative numbers count from the end): a start for another run."""
        n = len(self.time)
        i = _check.count(i, "i", at_least=-n, at_most=n - 1)
        records = self._records
        bodies = {}
        for name in [*self._lowered.cables, *self._lowered.shared, *self._lowered.rigid]:
            offsets = self._offsets(name)
            rows = [
                vector[offsets[:, [column]] + np.arange(3)] if column < offsets.shape[1] else np.zeros((1, 3))
                for vector in (records.q[i], records.v[i])
                for column in (0, 1)
            ]
            bodies[name] = BodyState(*rows)
        return State(
            self.model, bodies, self.is_static, float(self.time[i]), records.q[i], records.lambda_[i]
        )

    # Forces

    def reaction(self, joint: Joint) -> Reaction:
        """Force and moment that a joint exerts on its first body.

        Parameters
        ----------
        joint : Joint
            Handle that ``pin``, ``hinge`` or another joint returned.

        Returns
        -------
        Reaction
            ``force`` [N] and ``moment`` [N m] about the joint's point, each (n, 3), in world axes. Of pins
            that close a loop of pins at one place, the last carries nothing.
        """
        plan = self._plan_of(joint)
        records = self._records
        zero = np.zeros((len(self.time), 3))
        if plan["kind"] == "redundant":
            return Reaction(zero, zero.copy())
        if plan["kind"] == "multiplier":
            with translated():
                force, moment = self._system.reaction(plan["index"], records.time, records.q, records.lambda_)
            return Reaction(force, moment)
        return Reaction(self._shared_force(plan), zero)

    def _plan_of(self, joint: object) -> Json:
        """Tell how a joint is realised."""
        if not isinstance(joint, Joint):
            _check.fail("joint", joint, "must be a joint of the model")
        require_handle(joint, "joint", self.model.identity)
        if joint.name not in self._lowered.plan:
            _check.fail("joint", joint, "the model that was run has no such joint")
        plan: Json = self._lowered.plan[joint.name]
        return plan

    def _shared_force(self, plan: dict[str, Any]) -> FloatArray:
        """Force of a pin that shares coordinates: what its first side needs beyond what else acts there."""
        records = self._records
        factor = self.time if self.is_static else np.ones_like(self.time)
        gravity = self.model.gravity * factor[:, None]
        total = np.zeros((len(self.time), 3))
        inner = [(name, int(node)) for name, node in plan["nodes"]]
        for name, node in inner:
            with translated():
                total += self._system.nodal_force(
                    self._lowered.cables[name], node, records.q, records.v, records.a
                )
        for name in plan["masses"]:
            mass = self.model._bodies[name]
            assert isinstance(mass, MassBody)
            assert mass.at is not None
            total += mass.mass * (self._at(mass.at, records.a) - gravity)
        for name, sign in plan["joints"]:
            total -= sign * self.reaction(Joint(name, self.model.identity)).force
        for load in self.model._loads.values():
            weight = 0.0
            for name, node in inner:
                if isinstance(load, LineLoad) and load.body == name:
                    weight += sum(self._body(name).lengths[e] / 2.0 for e, _ in self._ends(name, node))
                elif isinstance(load, Force) and load.at.body == name:
                    first, shape = self._body(name).shape(load.at.element, load.at.xi)
                    weight += float(shape[0] if first == node else shape[2] if first + 1 == node else 0.0)
            if weight != 0.0:
                values = [
                    scaled(load.value, float(t), float(f), self._held(i))
                    for i, (t, f) in enumerate(zip(self.time, factor, strict=True))
                ]
                total -= weight * np.array(values)
        if self.is_static:
            for name, node in inner:
                total += self._node_mass(name, node) * (self.model.gravity - gravity)
        return total

    def _held(self, i: int) -> dict[str, FloatArray]:
        """Give the inputs at output i by name."""
        rows = self._records.inputs
        return {
            name: rows[i, first : first + len(initial)] if rows.shape[1] else np.array(initial)
            for name, (first, initial) in self._lowered.held.items()
        }

    def _ends(self, name: str, node: int) -> list[tuple[int, int]]:
        """Elements that meet at a strand node, with the end (0 or 1) that lies there."""
        first = self._body(name).element_nodes
        return [(int(e), end) for end in (0, 1) for e in np.flatnonzero(first + end == node)]

    def _node_mass(self, name: str, node: int) -> float:
        """Share of a uniform acceleration's force that acts on a strand node's position [kg]."""
        body = self._body(name)
        return sum(
            float(_element_masses(body)[e] @ hermite(GAUSS_5, np.array(body.lengths[e]))[2 * end])
            for e, end in self._ends(name, node)
        )

    def axial_force(self, body: Handle | str) -> FloatArray:
        """Axial force [N] at mid-element, (n, elements); of a net the mean in each cable, (n, cables)."""
        data, name = self._line(body)
        with translated():
            force = self._system.axial_force(self._lowered.cables[name], self._records.q)
        if data.kind == "cable":
            return force
        starts = np.concatenate([[0], np.cumsum(data.strands)[:-1]])
        total = np.add.reduceat(force * data.lengths, starts, axis=1)
        mean: FloatArray = total / np.add.reduceat(data.lengths, starts)
        return mean

    def strain(self, body: Handle | str) -> Strain:
        """Axial strain (n, elements) and curvature vector [1/m] (n, elements, 3) at mid-element."""
        _, name = self._line(body)
        with translated():
            axial, curvature = self._system.strain(self._lowered.cables[name], self._records.q)
        return Strain(axial, curvature)

    # Balances

    @property
    def energy(self) -> Energy:
        """Energies [J], each (n,)."""
        return Energy(*np.ascontiguousarray(self._records.energy.T))

    @property
    def momentum(self) -> FloatArray:
        """Linear momentum [kg m/s], (n, 3)."""
        return self._momentum()[0]

    @property
    def angular_momentum(self) -> FloatArray:
        """Angular momentum about the world's origin [kg m^2/s], (n, 3)."""
        return self._momentum()[1]

    def center_of_mass(self, body: Handle | str | None = None) -> FloatArray:
        """Centre of mass of the model or of one body [m], shape (n, 3)."""
        if body is None:
            mass = self._system.masses()[0]
            center: FloatArray = self._momentum()[2] / mass
            return center
        name = self._name(body)
        data = self.model._bodies[name]
        if not isinstance(data, LineBody):
            return self._nodes(name, self._records.q)[:, 0]
        offsets = self._offsets(name)[:, :, None] + np.arange(3)
        weights = _element_masses(data)
        shapes = np.einsum("eg,keg->ek", weights, hermite(GAUSS_5[None, :], data.lengths[:, None]))
        index = np.stack([offsets[data.element_nodes + k // 2, k % 2] for k in range(4)], axis=1)
        total = np.zeros((len(self.time), 3))
        for k in range(4):
            total += np.einsum("e,nei->ni", shapes[:, k], self._records.q[:, index[:, k]])
        total /= weights.sum()
        return total

    # Pictures and files

    def plot(self, color: str | ArrayLike | None = None) -> Figure:
        """Draw the motion with matplotlib: the bodies at a few times, later ones stronger.

        Parameters
        ----------
        color : {"strain", "axial_force", "speed"} or array_like, shape (n, nodes), optional
            Quantity that colours the lines.

        Returns
        -------
        matplotlib.figure.Figure
            The figure; ``figure.savefig("motion.png")`` writes it.
        """
        from pliant.plotting import plot

        return plot(self, color)

    def export_html(self, path: str | os.PathLike[str], color: str | ArrayLike | None = None) -> None:
        """Write one self-contained interactive page: orbit, time slider, play, colours.

        Parameters
        ----------
        path : str or path
            File to write.
        color : {"strain", "axial_force", "speed"} or array_like, shape (n, nodes), optional
            Quantity that colours the lines at first; the page offers the three by name.
        """
        from pliant.export import export_html

        export_html(self, path, color)

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the result to an HDF5 file (layout: :mod:`pliant.storage`)."""
        from pliant.storage import save

        save(self, path)

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Result:
        """Read a result that :meth:`save` wrote; handles of its model serve it."""
        from pliant.storage import load

        return load(path)

    # Inside

    @property
    def _system(self) -> System:
        if self._built is None:
            from pliant import _core

            with translated():
                self._built = _core.System(self._lowered.spec, self._lowered.arrays)
        return self._built

    def _name(self, body: object) -> str:
        if isinstance(body, str):
            body = self.model[body]
        if not isinstance(body, Handle):
            _check.fail("body", body, "must be a body of the model, or its name")
        self.model._body(body, "body")
        return body.name

    def _body(self, name: str) -> LineBody:
        body = self.model._bodies[name]
        assert isinstance(body, LineBody)
        return body

    def _line(self, body: object) -> tuple[LineBody, str]:
        name = self._name(body)
        data = self.model._bodies[name]
        if not isinstance(data, LineBody):
            _check.fail("body", body, "must be a cable or a net of cables")
        return data, name

    def _offsets(self, name: str) -> IntArray:
        """Offsets in q: of strand nodes (n, 2), a free mass (1, 1), the vectors of a rigid body (4, 1)."""
        if name not in self._known_offsets:
            if name in self._lowered.cables:
                self._known_offsets[name] = self._system.cable_offsets(self._lowered.cables[name])
            elif name in self._lowered.rigid:
                first = self._system.rigid_offsets()[self._lowered.rigid[name]]
                self._known_offsets[name] = first + 3 * np.arange(4)[:, None]
            else:
                self._known_offsets[name] = self._system.shared_offsets()[self._lowered.shared[name]].reshape(
                    1, 1
                )
        return self._known_offsets[name]

    def _nodes(self, body: object, rows: FloatArray) -> FloatArray:
        name = self._name(body)
        data = self.model._bodies[name]
        if isinstance(data, LineBody):
            offsets = self._offsets(name)[data.first, 0]
        elif isinstance(data, RigidBodyData):
            offsets = self._offsets(name)[:1, 0]
        elif data.at is not None:
            return self._at(data.at, rows)[:, None]
        else:
            offsets = self._offsets(name)[:, 0]
        return np.ascontiguousarray(rows[:, offsets[:, None] + np.arange(3)])

    def _at(self, point: Point | WorldPoint, rows: FloatArray) -> FloatArray:
        assert isinstance(point, Point)
        data = self.model._bodies[point.body]
        if isinstance(data, RigidBodyData):
            vectors = rows[:, self._offsets(point.body) + np.arange(3)]
            place: FloatArray = np.einsum("i,nik->nk", data.weights(point), vectors)
            return place
        if not isinstance(data, LineBody):
            return np.ascontiguousarray(self._nodes(point.body, rows)[:, 0])
        offsets = self._offsets(point.body)[:, :, None] + np.arange(3)
        if point.node is not None:
            return np.ascontiguousarray(rows[:, offsets[data.first[point.node], 0]])
        first, weights = data.shape(point.element, point.xi)
        places = (offsets[first, 0], offsets[first, 1], offsets[first + 1, 0], offsets[first + 1, 1])
        value: FloatArray = sum(w * rows[:, place] for w, place in zip(weights, places, strict=True))
        return value

    def _momentum(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        with translated():
            return self._system.momentum(self._records.q, self._records.v)


def _element_masses(body: LineBody) -> FloatArray:
    """Mass at five Gauss points of each element [kg], (elements, 5)."""
    weights = np.polynomial.legendre.leggauss(5)[1] / 2.0
    return np.broadcast_to(body.mass_per_length, (body.elements, 5)) * weights * body.lengths[:, None]


def require_state(start: object, name: str, model: Model) -> State:
    """Return ``start`` as a state whose bodies are those of the model."""
    if isinstance(start, Result):
        start = start.state(-1)
    if not isinstance(start, State):
        _check.fail(name, start, "must be a Result or result.state(i)")
    ours, theirs = (
        {
            key: (body.kind, body.nodes, tuple(body.strands))
            if isinstance(body, LineBody)
            else ("mass", body.at)
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
