"""The model: a description of bodies, joints and loads, no numerics."""

from __future__ import annotations

import json
import os
import uuid
from pathlib import Path
from typing import Any

import numpy as np

from pliant import _check
from pliant._document import VERSION, decode, encode
from pliant.bodies import Body, LineBody, MassBody, line_of, line_of_net, make_line_body
from pliant.errors import FileError, ModelError
from pliant.files import atomic
from pliant.joints import Clamp, JointData, Pin
from pliant.loads import Force, LineLoad, LoadData, Moment
from pliant.materials import Material
from pliant.points import Cable, CableNet, Handle, Joint, Load, Point, PointMass, WorldPoint, require_handle
from pliant.signals import Signal, Table, as_signal
from pliant.typing import ArrayLike, FloatArray, Json

__all__ = ["Model"]


class Model:
    """A collection of bodies, joints and loads.

    Parameters
    ----------
    gravity : array_like, shape (3,)
        Acceleration of gravity [m/s^2].

    Examples
    --------
    >>> import pliant as pl
    >>> model = pl.Model(gravity=(0, 0, -9.81))
    >>> rubber = pl.LinearElastic(youngs_modulus=1e7, poisson_ratio=0.45, density=1000.0)
    >>> rope = model.add_cable(
    ...     [(0, 0, 0), (1, 0, 0)], elements=40, section=pl.Circle(radius=5e-3), material=rubber, name="rope"
    ... )
    >>> _ = model.pin(rope.start)
    >>> model.dof, model.constraints
    (246, 3)
    """

    def __init__(self, gravity: ArrayLike = (0.0, 0.0, 0.0)) -> None:
        self._gravity = _check.vector(gravity, "gravity")
        self._identity = uuid.uuid4().hex
        self._bodies: dict[str, Body] = {}
        self._joints: dict[str, JointData] = {}
        self._loads: dict[str, LoadData] = {}

    @property
    def gravity(self) -> FloatArray:
        """Acceleration of gravity [m/s^2], shape (3,)."""
        return self._gravity.copy()

    @property
    def identity(self) -> str:
        """What handles, copies, files and results of this model share."""
        return self._identity

    # Bodies

    def add_cable(
        self,
        points: Any,
        *,
        elements: int,
        section: Any,
        material: Material,
        rest: str = "given",
        rest_length: float | None = None,
        pretension: float | None = None,
        closed: bool = False,
        tension_only: bool = False,
        strain: str = "green_lagrange",
        integration: str = "lobatto",
        bending: str = "exact",
        initial: ArrayLike | None = None,
        velocity: Any = None,
        angular_velocity: ArrayLike = (0.0, 0.0, 0.0),
        name: str | None = None,
    ) -> Cable:
        """Add a cable: it stretches and bends, and does not twist.

        Parameters
        ----------
        points : array_like, shape (n, 3), or Curve
            Two or more points [m], joined by straight pieces: an interior corner shares the position, not the
            tangent (a moment-free hinge). Or a :class:`Curve`.
        elements : int
            Number of elements, spread over the pieces in proportion to length, at least one each.
        section
            One section, a list of one for each element, or a callable of arc length [m]. Alike in bending about
            every axis.
        material : LinearElastic or SaintVenantKirchhoff
            The material.
        rest : {"given", "straight"}
            ``"given"``: stress-free as given, straight or curved in a plane and then confined to it.
            ``"straight"``: free of axial strain as given, straight when unloaded; any line in space.
        rest_length : float, optional
            Stress-free length [m]; ``points`` are then the line at the start. The mass stays that of the line as
            given by ``points``.
        pretension : float, optional
            Axial force [N] at the start, 0 or more; instead of ``rest_length``. The mass stays likewise.
        closed : bool
            A ring: the last piece goes back to the first point.
        tension_only : bool
            No compression.
        strain : {"green_lagrange", "biot"}
            Strain measure of the axial law.
        integration : {"lobatto", "full"}
            Rule of the axial energy; ``"lobatto"`` does not lock.
        bending : {"exact", "simplified"}
            Measure of curvature.
        initial : array_like, shape (nodes, 3), optional
            Positions at the start [m], where they are not the stress-free line; slopes follow smoothly.
        velocity : array_like, shape (3,) or (nodes, 3), or callable, optional
            Velocity at the start [m/s]; a callable takes the initial positions (n, 3) and returns (n, 3).
        angular_velocity : array_like, shape (3,)
            Angular velocity at the start about the world's origin [rad/s].
        name : str, optional
            Name; else ``cable1``, ``cable2``, ...

        Returns
        -------
        Cable
            Handle with ``start``, ``end``, ``at(s)`` and ``node(i)``.

        Examples
        --------
        >>> import pliant as pl
        >>> model = pl.Model()
        >>> steel = pl.LinearElastic(youngs_modulus=2.1e11, poisson_ratio=0.3, density=7850.0)
        >>> wire = model.add_cable(
        ...     [(0, 0, 0), (10, 0, 0)], elements=8, section=pl.Circle(radius=1e-3), material=steel, pretension=100.0
        ... )
        >>> round(wire.length, 5)
        9.99848
        """
        rest = _check.choice(rest, "rest", ("given", "straight"))
        closed = _check.flag(closed, "closed")
        line = line_of(points, elements, closed, rest)
        if rest_length is not None and pretension is not None:
            _check.fail("pretension", pretension, "give rest_length or pretension, not both")
        if callable(rest_length) or isinstance(rest_length, Signal):
            _check.fail(
                "rest_length", rest_length, "must be a constant number; one that changes in time is not there"
            )
        given = float(line.lengths.sum())
        lengths = None
        if rest_length is not None:
            rest_length = _check.number(rest_length, "rest_length", above=0)
            strand = np.add.reduceat(line.lengths, np.concatenate([[0], np.cumsum(line.strands)[:-1]]))
            lengths = strand * (rest_length / given)
        tension = None
        if pretension is not None:
            tension = np.full(len(line.strands), _check.number(pretension, "pretension", at_least=0))
        body = make_line_body(
            line,
            name=self._new_name(name, "cable"),
            kind="cable",
            closed=closed,
            section=section,
            material=material,
            stretch_lengths=lengths,
            pretension=tension,
            tension_only=tension_only,
            strain=strain,
            integration=integration,
            bending=bending,
            initial=initial,
            velocity=velocity,
            angular_velocity=angular_velocity,
        )
        self._require_in_plane(body, self._gravity, "gravity")
        self._bodies[body.name] = body
        return Cable(body.name, self._identity, body)

    def add_cable_net(
        self,
        points: ArrayLike,
        edges: ArrayLike,
        *,
        elements: Any,
        section: Any,
        material: Material,
        rest_lengths: Any = None,
        pretension: Any = None,
        tension_only: bool = True,
        strain: str = "green_lagrange",
        integration: str = "lobatto",
        bending: str = "exact",
        initial: ArrayLike | None = None,
        velocity: Any = None,
        angular_velocity: ArrayLike = (0.0, 0.0, 0.0),
        name: str | None = None,
    ) -> CableNet:
        """Add a net of cables between points. Cables that end at one point share its position; slopes are private.

        Parameters
        ----------
        points : array_like, shape (n, 3)
            Knots [m].
        edges : array_like of int, shape (m, 2)
            Points that each cable joins.
        elements : int or array_like of int, shape (m,)
            Elements of each cable.
        section, material, tension_only, strain, integration, bending, initial, velocity, angular_velocity, name
            As for :meth:`add_cable`.
        rest_lengths : float or array_like, shape (m,), optional
            Stress-free lengths [m].
        pretension : float or array_like, shape (m,), optional
            Axial forces at the start [N], 0 or more; instead of ``rest_lengths``.

        Returns
        -------
        CableNet
            Handle; ``net.node(i)`` is ``points[i]``.

        Examples
        --------
        >>> import pliant as pl
        >>> model = pl.Model()
        >>> steel = pl.LinearElastic(youngs_modulus=2.1e11, poisson_ratio=0.3, density=7850.0)
        >>> corners = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)]
        >>> net = model.add_cable_net(
        ...     corners, [(0, 1), (1, 2), (2, 3), (3, 0)], elements=2, section=pl.Circle(radius=1e-3), material=steel
        ... )
        >>> model.dof
        60
        """
        line, given = line_of_net(points, edges, elements)
        if rest_lengths is not None and pretension is not None:
            _check.fail("pretension", pretension, "give rest_lengths or pretension, not both")
        lengths = _one_or_each(rest_lengths, "rest_lengths", len(given), zero=False)
        tension = _one_or_each(pretension, "pretension", len(given), zero=True)
        body = make_line_body(
            line,
            name=self._new_name(name, "net"),
            kind="net",
            closed=False,
            section=section,
            material=material,
            stretch_lengths=lengths,
            pretension=tension,
            tension_only=tension_only,
            strain=strain,
            integration=integration,
            bending=bending,
            initial=initial,
            velocity=velocity,
            angular_velocity=angular_velocity,
        )
        self._bodies[body.name] = body
        return CableNet(body.name, self._identity, body)

    def add_point_mass(
        self,
        mass: float,
        *,
        at: Any,
        velocity: ArrayLike = (0.0, 0.0, 0.0),
        name: str | None = None,
    ) -> PointMass:
        """Add a lumped mass.

        Parameters
        ----------
        mass : float
            Mass [kg], above 0.
        at : Point or array_like, shape (3,)
            A material point, or where a free mass starts [m].
        velocity : array_like, shape (3,)
            Velocity of a free mass at the start [m/s].

        Returns
        -------
        PointMass
            Handle with ``center``.

        Examples
        --------
        >>> import pliant as pl
        >>> model = pl.Model()
        >>> ball = model.add_point_mass(0.5, at=(0, 0, 2), velocity=(1, 0, 0))
        >>> model.dof
        3
        """
        mass = _check.number(mass, "mass", above=0)
        speed = _check.vector(velocity, "velocity")
        name = self._new_name(name, "point_mass")
        point: Point | None = None
        if isinstance(at, (Point, Handle)):
            point = self._point(at, "at")
            if speed.any():
                _check.fail(
                    "velocity", velocity, "a mass at a material point moves with it; leave velocity out"
                )
            place = self._position(point)
        else:
            place = _check.vector(at, "at")
        self._bodies[name] = MassBody(name, mass, point, _world(place), _world(speed))
        return self._mass_handle(name)

    # Joints

    def clamp(self, point: Any, *, name: str | None = None) -> Joint:
        """Hold a point of a cable: its position and the direction of its tangent (the stretch is free).

        Parameters
        ----------
        point : Point
            A point of a cable or a net.

        Returns
        -------
        Joint
            Handle for ``result.reaction``.
        """
        at = self._line_point(point, "point")
        return self._add_joint(Clamp(self._new_name(name, "clamp"), at))

    def pin(self, point: Any, to: Any = None, *, name: str | None = None) -> Joint:
        """Hold a point's position.

        Parameters
        ----------
        point : Point or body
            First point.
        to : Point, body or array_like, shape (3,), optional
            Second point, at the same place; None: the world, where the point starts.

        Returns
        -------
        Joint
            Handle for ``result.reaction``: the force on the first body.
        """
        if not isinstance(point, (Point, Handle)):
            _check.fail("point", point, "must be a point of a body, such as rope.start")
        bare = (Cable, CableNet)
        if isinstance(point, bare) and isinstance(to, bare):
            _check.fail("to", to, "give a point of one of the two bodies, such as rope.end")
        if isinstance(point, bare) and to is None:
            _check.fail("point", point, "give the point of the body, such as rope.start")
        b: Point | WorldPoint
        if isinstance(point, bare):
            b = self._other(to, "to")
            a = self._nearest(point, "point", self._position(b))
        else:
            a = self._point(point, "point")
            here = self._position(a)
            if to is None:
                b = _world(here)
            elif isinstance(to, bare):
                b = self._nearest(to, "to", here)
            else:
                b = self._other(to, "to")
        if a == b:
            _check.fail("to", to, "is the same point")
        gap = float(np.linalg.norm(self._position(a) - self._position(b)))
        if gap > 1e-6 * self._size():
            _check.fail(
                "to",
                to,
                f"the points must coincide at the start, but are {gap:.6g} m apart ({a}; {b}); move one body",
            )
        for one, other in ((a, b), (b, a)):
            if isinstance(one, Point) and isinstance(other, Point):
                self._require_same_plane(one, other)
        return self._add_joint(Pin(self._new_name(name, "pin"), a, b, here=to is None))

    # Loads

    def add_force(self, point: Any, force: Any, follower: bool = False, *, name: str | None = None) -> Load:
        """Add a force at a point.

        Parameters
        ----------
        point : Point
            Where.
        force : array_like, shape (3,), callable, Table or product with a Ramp
            Force [N].
        follower : bool
            Turns with the tangent of the cable, in the plane of tangent and force at the start.
        """
        at = self._point(point, "point")
        value = as_signal(force, "force", 3)
        follower = _check.flag(follower, "follower")
        body = self._bodies[at.body]
        if follower and not isinstance(body, LineBody):
            _check.fail("follower", follower, "a point mass has no direction to follow")
        self._require_in_plane(body, value, "force")
        return self._add_load(Force(self._new_name(name, "force"), at, value, follower))

    def add_moment(self, point: Any, moment: Any, *, name: str | None = None) -> Load:
        """Add a moment at a point of a cable; its part along the tangent does nothing.

        Parameters
        ----------
        point : Point
            Where.
        moment : array_like, shape (3,), callable, Table or product with a Ramp
            Moment [N m], with fixed axis.
        """
        at = self._line_point(point, "point")
        value = as_signal(moment, "moment", 3)
        self._require_in_plane(self._bodies[at.body], value, "moment", along=True)
        return self._add_load(Moment(self._new_name(name, "moment"), at, value))

    def add_line_load(self, cable: Any, force_per_length: Any, *, name: str | None = None) -> Load:
        """Add a force per stress-free length on all of a cable or net.

        Parameters
        ----------
        cable : Cable or CableNet
            The body.
        force_per_length : array_like, shape (3,), callable, Table or product with a Ramp
            Force per length [N/m].
        """
        body = self._body(cable, "cable")
        if not isinstance(body, LineBody):
            _check.fail("cable", cable, "must be a cable or a net of cables")
        value = as_signal(force_per_length, "force_per_length", 3)
        self._require_in_plane(body, value, "force_per_length")
        return self._add_load(LineLoad(self._new_name(name, "line_load"), body.name, value))

    # What is in it

    @property
    def bodies(self) -> list[Handle]:
        """Handles of the bodies."""
        return [self[name] for name in self._bodies]

    @property
    def joints(self) -> list[Handle]:
        """Handles of the joints."""
        return [self[name] for name in self._joints]

    @property
    def loads(self) -> list[Handle]:
        """Handles of the loads."""
        return [self[name] for name in self._loads]

    @property
    def contacts(self) -> list[Handle]:
        """Handles of the contacts."""
        return []

    def __getitem__(self, name: str) -> Any:
        """Handle of that name."""
        if isinstance(name, str):
            if name in self._joints:
                return Joint(name, self._identity)
            if name in self._loads:
                return Load(name, self._identity)
            body = self._bodies.get(name)
            if isinstance(body, MassBody):
                return self._mass_handle(name)
            if isinstance(body, LineBody):
                return (Cable if body.kind == "cable" else CableNet)(name, self._identity, body)
        names = ", ".join([*self._bodies, *self._joints, *self._loads]) or "nothing"
        _check.fail("name", name, f"the model holds {names}")

    @property
    def dof(self) -> int:
        """Number of coordinates, after points that coincide and are pinned together share theirs."""
        from pliant._lower import lower

        return lower(self).coordinates

    @property
    def constraints(self) -> int:
        """Number of constraint equations."""
        from pliant._lower import lower

        return lower(self).multipliers

    def __repr__(self) -> str:
        return f"<Model: {len(self._bodies)} bodies, {len(self._joints)} joints, {len(self._loads)} loads>"

    def __str__(self) -> str:
        from pliant._table import describe

        return describe(self)

    # Copies and files

    def copy(self) -> Model:
        """Copy of the model; handles of one serve the other."""
        other = Model(self._gravity)
        other._identity = self._identity
        other._bodies, other._joints, other._loads = dict(self._bodies), dict(self._joints), dict(self._loads)
        return other

    __copy__ = copy

    def __deepcopy__(self, memo: object) -> Model:
        return self.copy()

    def to_document(self, *, keep_functions: bool = True) -> Json:
        """The model as a JSON document; refuses callables, or leaves markers for them."""
        lists = {"bodies": self._bodies, "joints": self._joints, "loads": self._loads}
        return {
            "format": "pliant-model",
            "version": VERSION,
            "identity": self._identity,
            "gravity": self._gravity.tolist(),
            **{
                key: [encode(item, f"{key[:-1]} '{name}'", keep_functions) for name, item in items.items()]
                for key, items in lists.items()
            },
        }

    @classmethod
    def from_document(cls, document: Any, source: str = "document") -> Model:
        """Read a document that :meth:`to_document` wrote."""
        if not isinstance(document, dict) or document.get("format") != "pliant-model":
            raise FileError(f"{source}: is not a pliant model")
        if document.get("version") != VERSION:
            raise FileError(f"{source}: has version {document.get('version')!r}, this pliant reads {VERSION}")
        try:
            model = cls(document["gravity"])
            model._identity = _check.text(document["identity"], "identity")
            for key, items, kinds in (
                ("bodies", model._bodies, (LineBody, MassBody)),
                ("joints", model._joints, (Pin, Clamp)),
                ("loads", model._loads, (Force, Moment, LineLoad)),
            ):
                for entry in document[key]:
                    item = decode(entry)
                    if not isinstance(item, kinds):
                        raise ModelError(f"{key}: {type(item).__name__} does not belong here")
                    items[item.name] = item  # type: ignore[index]
            model._verify()
        except (KeyError, TypeError, ValueError, AttributeError, IndexError) as error:
            raise FileError(f"{source}: is damaged: {error}") from error
        return model

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the model to a JSON file.

        Parameters
        ----------
        path : str or path
            File, ``model.json`` by custom. Python callables are refused; ``Table.sample`` makes tables of them.
        """
        text = json.dumps(self.to_document())
        with atomic(path) as temporary:
            temporary.write_text(text)

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Model:
        """Read a model from a JSON file; handles of the saved model serve it."""
        try:
            document = json.loads(Path(path).read_text())
        except OSError as error:
            raise FileError(f"{path}: cannot be read: {error.strerror}") from error
        except ValueError as error:
            raise FileError(f"{path}: is not a pliant model: {error}") from error
        return cls.from_document(document, str(path))

    # Inside

    def _verify(self) -> None:
        """Check what points at what, after loading."""
        places: list[object] = []
        for body in self._bodies.values():
            places.append(getattr(body, "at", None))
        for joint in self._joints.values():
            places += [joint.a, getattr(joint, "b", None)]
        for load in self._loads.values():
            if isinstance(load, LineLoad):
                self._bodies[load.body]
            else:
                places.append(load.at)
        for place in places:
            if isinstance(place, Point):
                self._point(place, "point")
            elif not (place is None or isinstance(place, WorldPoint)):
                raise ModelError(f"{place!r} is no point")

    def _new_name(self, name: object, kind: str) -> str:
        taken = {*self._bodies, *self._joints, *self._loads}
        if name is None:
            k = 1
            while f"{kind}{k}" in taken:
                k += 1
            return f"{kind}{k}"
        name = _check.text(name, "name")
        if name in taken:
            _check.fail("name", name, "is taken in this model; choose another")
        return name

    def _mass_handle(self, name: str) -> PointMass:
        body = self._bodies[name]
        at = body.at if isinstance(body, MassBody) else None
        return PointMass(
            name, self._identity, at if at is not None else Point(self._identity, name, 0, 0.0, 0)
        )

    def _add_joint(self, joint: JointData) -> Joint:
        self._joints[joint.name] = joint
        return Joint(joint.name, self._identity)

    def _add_load(self, load: LoadData) -> Load:
        self._loads[load.name] = load
        return Load(load.name, self._identity)

    def _body(self, handle: Any, name: str) -> Body:
        if not isinstance(handle, Handle) or isinstance(handle, (Joint, Load)):
            _check.fail(name, handle, "must be a body of this model")
        require_handle(handle, name, self._identity)
        if handle.name not in self._bodies:
            _check.fail(name, handle, f"this model has no body '{handle.name}'")
        return self._bodies[handle.name]

    def _point(self, value: Any, name: str) -> Point:
        if isinstance(value, PointMass):
            value = value.center
        if not isinstance(value, Point):
            _check.fail(name, value, "must be a point of a body, such as rope.end")
        require_handle(value, name, self._identity)
        body = self._bodies.get(value.body)
        if body is None:
            _check.fail(name, value, f"this model has no body '{value.body}'")
        elements = body.elements if isinstance(body, LineBody) else 1
        if not (0 <= value.element < elements and 0.0 <= value.xi <= 1.0):
            _check.fail(name, value, f"body '{value.body}' of this model has {elements} elements")
        return value

    def _line_point(self, value: Any, name: str) -> Point:
        point = self._point(value, name)
        if not isinstance(self._bodies[point.body], LineBody):
            _check.fail(name, value, "must be a point of a cable")
        return point

    def _other(self, value: Any, name: str) -> Point | WorldPoint:
        if isinstance(value, (Point, PointMass)):
            return self._point(value, name)
        if isinstance(value, Handle):
            _check.fail(name, value, "must be a point, a body or three numbers")
        return _world(_check.vector(value, name))

    def _nearest(self, handle: Any, name: str, target: FloatArray) -> Point:
        body = self._body(handle, name)
        if not isinstance(body, LineBody):
            return self._point(handle, name)
        return body.nearest(target, self._identity)

    def _position(self, point: Point | WorldPoint) -> FloatArray:
        """Position at the start."""
        if isinstance(point, WorldPoint):
            return np.array(point.position)
        body = self._bodies[point.body]
        if isinstance(body, MassBody):
            return self._position(body.at) if body.at is not None else np.array(body.position.position)
        if point.node is not None:
            return body.r[body.first[point.node]].copy()
        first, weights = body.shape(point.element, point.xi)
        result: FloatArray = weights @ np.stack(
            [body.r[first], body.t[first], body.r[first + 1], body.t[first + 1]]
        )
        return result

    def _size(self) -> float:
        """Largest edge of the box around the model [m]."""
        places = [body.r for body in self._bodies.values() if isinstance(body, LineBody)]
        places += [np.array([b.position.position]) for b in self._bodies.values() if isinstance(b, MassBody)]
        size = float(np.ptp(np.vstack(places), axis=0).max())
        return size if size > 0 else 1.0

    def _require_in_plane(self, body: Body, value: Any, name: str, along: bool = False) -> None:
        """Refuse vectors out of the plane of a line that is curved at rest (``along``: not along its normal)."""
        normal = body.normal if isinstance(body, LineBody) else None
        if normal is None:
            return
        rows = np.atleast_2d(value) if isinstance(value, np.ndarray) else _samples(value)
        off = np.cross(rows, normal) if along else rows @ normal
        if np.abs(off).max(initial=0.0) > 1e-9 * np.abs(rows).max(initial=0.0):
            place = "along the normal" if along else "in the plane"
            _check.fail(
                name,
                rows[0],
                f"cable '{body.name}' is curved at rest and confined to its plane: must lie {place}, "
                f'normal {normal.tolist()}; for motion in space take rest="straight"',
            )

    def _require_same_plane(self, one: Point, other: Point) -> None:
        """Refuse a joint of a line confined to a plane with a body that leaves it."""
        confined, free = self._bodies[one.body], self._bodies[other.body]
        if not isinstance(confined, LineBody) or confined.normal is None or not isinstance(free, LineBody):
            return
        origin = confined.r[0]
        off = np.concatenate([(free.r - origin) @ confined.normal, free.v_r @ confined.normal])
        if np.abs(off).max() > 1e-6 * self._size():
            _check.fail(
                "to",
                str(other),
                f"cable '{confined.name}' is curved at rest and confined to its plane, which '{free.name}' leaves",
            )


def _world(place: FloatArray) -> WorldPoint:
    return WorldPoint((float(place[0]), float(place[1]), float(place[2])))


def _samples(signal: Signal) -> FloatArray:
    """Values of a signal where it is certain to be asked."""
    times = [0.0, 1.0]
    if isinstance(signal, Table):
        return signal.values
    return np.array([signal(t) for t in times])


def _one_or_each(value: Any, name: str, n: int, *, zero: bool) -> FloatArray | None:
    """One number or one for each edge, above 0 (or at least 0)."""
    if value is None:
        return None
    if callable(value) or isinstance(value, Signal):
        _check.fail(name, value, "must be constant numbers; values that change in time are not there")
    if np.ndim(value) == 0:
        return np.full(n, _check.number(value, name, **({"at_least": 0.0} if zero else {"above": 0.0})))
    values = _check.array(value, name, (n,))
    if values.min() < 0 or (values.min() == 0 and not zero):
        row = int(np.argmin(values))
        _check.fail(f"{name}[{row}]", float(values[row]), "must be " + ("0 or more" if zero else "above 0"))
    return values
