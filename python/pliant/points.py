"""Handles: what ``add_*`` returns, and the material points that joints, loads and tracks take."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from pliant import _check
from pliant.errors import ModelError
from pliant.latches import LatchEvent, event, require_known
from pliant.typing import ArrayLike

if TYPE_CHECKING:
    from pliant._contents import Contents
    from pliant.bodies import LineBody

__all__ = [
    "Cable",
    "CableNet",
    "Handle",
    "Joint",
    "Line",
    "Load",
    "Point",
    "PointMass",
    "RigidBody",
    "WorldPoint",
]


@dataclass(frozen=True)
class Point:
    """A material point of a body. Made by handles: ``rope.end``, ``rope.at(0.3)``, ``net.node(5)``.

    Attributes
    ----------
    identity : str
        Identity of the model.
    body : str
        Name of the body.
    element : int
        Element that holds the point, counted through the body.
    xi : float
        Place in the element, 0 to 1.
    node : int or None
        Number of the node, if the point is one.
    local : tuple of float or None
        Place from the centre of mass in the axes of a rigid body [m].
    at : tuple of float or None
        Place in the face of a surface.
    offset : tuple of float or None
        Distance from the centre line of a beam along y and z of the section [m].
    """

    identity: str
    body: str
    element: int
    xi: float
    node: int | None = None
    local: tuple[float, float, float] | None = None
    at: tuple[float, float] | None = None
    offset: tuple[float, float] | None = None

    def __post_init__(self) -> None:
        _check.text(self.body, "body")
        _check.count(self.element, "element", at_least=0)
        _check.number(self.xi, "xi", at_least=0, at_most=1)
        if self.node is not None:
            _check.count(self.node, "node", at_least=0)
        if self.local is not None:
            object.__setattr__(self, "local", _check.triple(self.local, "local"))
        if self.at is not None:
            u, v = (float(c) for c in _check.array(self.at, "at", (2,)))
            object.__setattr__(self, "at", (u, v))
        if self.offset is not None:
            y, z = (float(c) for c in _check.array(self.offset, "offset", (2,)))
            object.__setattr__(self, "offset", (y, z))

    def __str__(self) -> str:
        if self.local is not None:
            return f"{self.body} at " + "({:.6g}, {:.6g}, {:.6g})".format(*self.local)
        if self.at is not None and self.node is None:
            return f"{self.body}, face {self.element} at ({self.at[0]:.6g}, {self.at[1]:.6g})"
        place = f"node {self.node}" if self.node is not None else f"element {self.element} at {self.xi:.6g}"
        if self.offset is not None and any(self.offset):
            place += ", offset ({:.6g}, {:.6g})".format(*self.offset)
        return f"{self.body}, {place}"


@dataclass(frozen=True)
class WorldPoint:
    """A point fixed in the world [m]."""

    position: tuple[float, float, float]

    def __post_init__(self) -> None:
        object.__setattr__(self, "position", _check.triple(self.position, "position"))

    def __str__(self) -> str:
        return "world ({:.6g}, {:.6g}, {:.6g})".format(*self.position)


@dataclass(frozen=True)
class Line:
    """A straight line, for :meth:`Model.slide_along`.

    Parameters
    ----------
    point : Point, RigidBody or array_like, shape (3,)
        A point of the line: of a rigid body, with which it moves and turns, or of the world [m].
    direction : array_like, shape (3,)
        Its direction at the start, in world axes.

    Examples
    --------
    >>> import pliant as pl
    >>> pl.Line((0, 0, 1), (1, 0, 0)).direction
    (1, 0, 0)
    """

    point: Any
    direction: Any


@dataclass(frozen=True)
class Handle:
    """A name in a model and the model's identity, which copies, files and results keep."""

    name: str
    identity: str

    def __repr__(self) -> str:
        return f"{type(self).__name__}({self.name!r})"


@dataclass(frozen=True)
class Joint(Handle):
    """A joint of a model; ``result.reaction(joint)`` tells its force.

    Examples
    --------
    Two bodies dock after half a second, and part again.

    >>> import pliant as pl
    >>> model = pl.Model()
    >>> ball = pl.Sphere(0.1)
    >>> slow = model.add_rigid_body(mass=1.0, shape=ball)
    >>> fast = model.add_rigid_body(mass=1.0, shape=ball, position=(-1, 0, 0), velocity=(1, 0, 0))
    >>> dock = model.weld(fast, slow).engage(at=0.5).release(at=1.0)
    >>> result = pl.simulate(model, duration=2.0, step=0.01)
    >>> print(result.track(slow.center).position[-1].round(3), result.energy.dissipated[-1].round(3))
    [0.75 0.   0.  ] 0.25
    """

    _model: Contents | None = field(default=None, compare=False, repr=False)

    def release(self, at: float) -> Joint:
        """Let go at a time; the run goes on without the joint.

        Parameters
        ----------
        at : float
            Time [s]; a step ends there exactly.

        Returns
        -------
        Joint
            This handle.
        """
        return self._schedule(event(at, False))

    def engage(self, at: float, *, gap: float | None = None) -> Joint:
        """Engage at a time; where this comes before any release the joint is free until then.

        What engages takes the directions and the pose of that moment, as other joints take those of the
        start, and velocities jump as in an inelastic impact, whose loss of energy counts as dissipated.

        Parameters
        ----------
        at : float
            Time [s]; a step ends there exactly.
        gap : float, optional
            Distance [m] up to which points that the joint was given may be apart at that time; by default a
            millionth of the model's size. They are joined as they are. A body, or the world, given in the
            place of a point lends the one that is found there.

        Returns
        -------
        Joint
            This handle.
        """
        return self._schedule(event(at, True, gap))

    def _schedule(self, one: LatchEvent) -> Joint:
        if self._model is None:
            raise ModelError(f"joint = {self.name!r}: take the handle of a model: model[name] gives it")
        self._model._require_latch(self.name)
        latches = self._model._latches
        latches[self.name] = require_known(latches, self.name).with_event(one)
        return self


@dataclass(frozen=True)
class Load(Handle):
    """A load of a model."""


@dataclass(frozen=True, repr=False)
class Obstacle(Handle):
    """A fixed shape that bodies may touch."""


@dataclass(frozen=True, repr=False)
class Contact(Handle):
    """A pair of a model that may touch."""


@dataclass(frozen=True)
class _LineHandle(Handle):
    _body: LineBody

    def __repr__(self) -> str:
        return f"{type(self).__name__}({self.name!r})"

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Handle) and (self.name, self.identity) == (other.name, other.identity)

    def __hash__(self) -> int:
        return hash((self.name, self.identity))

    def node(self, i: int) -> Point:
        """Node ``i``, counted from 0; negative numbers count from the end.

        Parameters
        ----------
        i : int
            Number of the node; row ``i`` of ``result.positions(body)``. In a net, the first are its points.
        """
        n = self._body.nodes
        i = _check.count(i, "i", at_least=-n, at_most=n - 1)
        return self._body.node_point(self.identity, i % n)


class Cable(_LineHandle):
    """A cable of a model.

    Examples
    --------
    >>> import pliant as pl
    >>> model = pl.Model()
    >>> rubber = pl.LinearElastic(youngs_modulus=1e7, poisson_ratio=0.45, density=1000.0)
    >>> thin = pl.Circle(radius=5e-3)
    >>> rope = model.add_cable([(0, 0, 0), (1, 0, 0)], elements=4, section=thin, material=rubber)
    >>> print(rope.end, "|", rope.at(0.6))
    cable1, node 4 | cable1, element 2 at 0.4
    """

    @property
    def start(self) -> Point:
        """First end."""
        return self.node(0)

    @property
    def end(self) -> Point:
        """Last end (of a closed cable: the first)."""
        return self.node(0 if self._body.closed else -1)

    @property
    def length(self) -> float:
        """Stress-free length [m]."""
        return float(self._body.lengths.sum())

    def at(self, s: float) -> Point:
        """Point at an arc length of the stress-free line.

        Parameters
        ----------
        s : float
            Arc length from the start [m], from 0 to ``length``.
        """
        ends = np.concatenate([[0.0], np.cumsum(self._body.lengths)])
        total = float(ends[-1])
        s = _check.number(s, "s", at_least=0, at_most=total * (1 + 1e-12))
        element = min(max(int(np.searchsorted(ends, s, side="right")) - 1, 0), len(ends) - 2)
        xi = float((s - ends[element]) / self._body.lengths[element])
        for end in (0, 1):
            if abs(xi - end) < 1e-9:
                return self.node(int(self._body.node_of(element, end)))
        return Point(self.identity, self.name, element, xi)


class CableNet(_LineHandle):
    """A net of cables; ``net.node(i)`` is ``points[i]``."""


@dataclass(frozen=True)
class PointMass(Handle):
    """A lumped mass."""

    _center: Point

    @property
    def center(self) -> Point:
        """The point where the mass sits."""
        return self._center


class RigidBody(Handle):
    """A rigid body of a model.

    Examples
    --------
    >>> import pliant as pl
    >>> model = pl.Model()
    >>> brick = model.add_rigid_body(density=2000.0, shape=pl.Box((0.2, 0.1, 0.05)))
    >>> print(brick.at((0.1, 0, 0)))
    rigid_body1 at (0.1, 0, 0)
    """

    def __repr__(self) -> str:
        return f"RigidBody({self.name!r})"

    @property
    def center(self) -> Point:
        """The centre of mass."""
        return self.at((0.0, 0.0, 0.0))

    def at(self, local_point: ArrayLike) -> Point:
        """Point at a place in the body's axes.

        Parameters
        ----------
        local_point : array_like, shape (3,)
            Place from the centre of mass [m].
        """
        local = _check.triple(local_point, "local_point")
        return Point(self.identity, self.name, 0, 0.0, local=local)


def require_handle(value: object, name: str, identity: str) -> None:
    """Refuse handles and points of other models."""
    if isinstance(value, (Handle, Point)) and value.identity != identity:
        raise ModelError(
            f"{name} = {value}: belongs to another model; take the handle of this one: model[name] gives it"
        )
