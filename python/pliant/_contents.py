"""What a model holds, and the checks of what is added to it."""

from __future__ import annotations

import os
from itertools import islice
from typing import Any

import numpy as np

from pliant import _check
from pliant._sides import why_not
from pliant.beams import Beam, BeamBody
from pliant.bodies import Body, LineBody, MassBody
from pliant.contacts import ContactData, ObstacleData
from pliant.errors import ModelError
from pliant.forces import ON_FACES, ForceData, Wind
from pliant.gas import Chamber
from pliant.joints import Clamp, DriveForce, EdgeJoint, JointData, SlideCable, Sprung, acting_along
from pliant.latches import Latch
from pliant.loads import LineLoad, LoadData, MovingForce, Pressure, SurfaceLoad
from pliant.points import (
    Cable,
    CableNet,
    Contact,
    Handle,
    Joint,
    Load,
    Obstacle,
    Point,
    PointMass,
    RigidBody,
    WorldPoint,
    require_handle,
)
from pliant.rigid import RigidBodyData
from pliant.signals import Signal, Table
from pliant.surfaces import Edge, Faces, Membrane, Shell, SurfaceBody
from pliant.typing import ArrayLike, FloatArray

__all__ = ["Contents", "world_point"]


class Contents:
    """Bodies, joints and loads of a model by name."""

    def __init__(self, gravity: ArrayLike = (0.0, 0.0, 0.0)) -> None:
        self._gravity = _check.vector(gravity, "gravity")
        self._identity = os.urandom(16).hex()
        self._bodies: dict[str, Body] = {}
        self._joints: dict[str, JointData] = {}
        self._loads: dict[str, LoadData] = {}
        self._latches: dict[str, Latch] = {}
        # Things are added and stay as they are: what is known of the first of them remains true.
        self._numbers: dict[str, int] = {}
        self._box = (0, np.full(3, np.inf), np.full(3, -np.inf))
        self._obstacles: dict[str, ObstacleData] = {}
        self._contacts: dict[str, ContactData] = {}

    @property
    def gravity(self) -> FloatArray:
        """Acceleration of gravity [m/s^2], shape (3,)."""
        return self._gravity.copy()

    @property
    def identity(self) -> str:
        """What handles, copies, files and results of this model share."""
        return self._identity

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
        return [self[name] for name in self._contacts]

    def __getitem__(self, name: str) -> Any:
        """Handle of that name."""
        if isinstance(name, str):
            if name in self._joints:
                return Joint(name, self._identity, self)
            if name in self._loads:
                return Load(name, self._identity)
            if name in self._obstacles:
                return Obstacle(name, self._identity)
            if name in self._contacts:
                return Contact(name, self._identity)
            body = self._bodies.get(name)
            if isinstance(body, MassBody):
                return self._mass_handle(name)
            if isinstance(body, RigidBodyData):
                return RigidBody(name, self._identity)
            if isinstance(body, LineBody):
                return (Cable if body.kind == "cable" else CableNet)(name, self._identity, body)
            if isinstance(body, BeamBody):
                return Beam(name, self._identity, body)
            if isinstance(body, SurfaceBody):
                return (Shell if body.kind == "shell" else Membrane)(name, self._identity, body)
        names = ", ".join(self._names()) or "nothing"
        _check.fail("name", name, f"the model holds {names}")

    def _verify(self) -> None:
        """Check what points at what, after loading."""
        places: list[tuple[object, tuple[type, ...]]] = []
        for body in self._bodies.values():
            if isinstance(body, MassBody):
                places.append((body.at, (Point, type(None))))
        for joint in self._joints.values():
            for number, point in enumerate(joint.points()):
                places.append((point, (Point, WorldPoint) if number else (Point,)))
            if isinstance(joint, SlideCable) and not isinstance(self._bodies[joint.cable], LineBody):
                raise ModelError(f"joint '{joint.name}': '{joint.cable}' is no cable")
            if isinstance(joint, EdgeJoint):
                for edge in (joint.edge, joint.other):
                    self._verify_part(edge, joint.name)
            if isinstance(joint, Clamp):
                self._directed_point(joint.a, "point")
            for key in ("joint", "joint_a", "joint_b"):
                if hasattr(joint, key) and not isinstance(self._joints.get(getattr(joint, key)), Sprung):
                    raise ModelError(f"joint '{joint.name}': '{getattr(joint, key)}' is no hinge or slider")
        for load in self._loads.values():
            if isinstance(load, ForceData):
                places += [(point, (Point, WorldPoint)) for point in load.points()]
                if isinstance(load, ON_FACES):
                    self._verify_part(load.faces, load.name)
                if isinstance(load, Wind) and not isinstance(self._bodies[load.body], LineBody):
                    raise ModelError(f"load '{load.name}': '{load.body}' is no cable")
            elif isinstance(load, Chamber):
                for part in load.faces:
                    self._verify_part(part, load.name)
            elif isinstance(load, SurfaceLoad):
                self._verify_part(load.faces if isinstance(load, Pressure) else load.edge, load.name)
            elif not isinstance(load, (LineLoad, MovingForce)):
                places.append((load.at, (Point,)))
            elif not isinstance(self._bodies[load.body], LineBody) and not (
                isinstance(load, LineLoad) and isinstance(self._bodies[load.body], BeamBody)
            ):
                raise ModelError(f"load '{load.name}': '{load.body}' is no cable")
        for contact in self._contacts.values():
            sides = [self._bodies.get(name) or self._obstacles.get(name) for name in (contact.a, contact.b)]
            for name, side in zip((contact.a, contact.b), sides, strict=True):
                if side is None:
                    raise ModelError(f"contact '{contact.name}': there is no '{name}'")
            reason = why_not(*(side for side in sides if side is not None))
            if reason is not None:
                raise ModelError(f"contact '{contact.name}': {reason}")
        for place, kinds in places:
            if not isinstance(place, kinds):
                raise ModelError(f"{place!r} is no point")
            if isinstance(place, Point):
                self._point(place, "point")

    def _verify_part(self, part: Edge | Faces | None, name: str) -> None:
        if part is None:
            return
        body = self._bodies.get(part.body)
        if not isinstance(part, (Edge, Faces)) or not isinstance(body, SurfaceBody):
            raise ModelError(f"'{name}': '{part.body}' is no surface")
        last = max(part.nodes) if isinstance(part, Edge) else max(part.numbers)
        if last >= (body.nodes if isinstance(part, Edge) else body.elements):
            raise ModelError(f"'{name}': '{part.body}' has another mesh")

    def _names(self) -> list[str]:
        return [*self._bodies, *self._joints, *self._loads, *self._obstacles, *self._contacts]

    def _new_name(self, name: object, kind: str) -> str:
        if name is None:
            k = self._numbers.get(kind, 1)
            while self._is_taken(f"{kind}{k}"):
                k += 1
            self._numbers[kind] = k
            return f"{kind}{k}"
        name = _check.text(name, "name")
        if self._is_taken(name):
            _check.fail("name", name, "is taken in this model; choose another")
        return name

    def _is_taken(self, name: str) -> bool:
        kinds = (self._bodies, self._joints, self._loads, self._obstacles, self._contacts)
        return any(name in things for things in kinds)

    def _mass_handle(self, name: str) -> PointMass:
        body = self._bodies[name]
        at = body.at if isinstance(body, MassBody) else None
        return PointMass(
            name, self._identity, at if at is not None else Point(self._identity, name, 0, 0.0, 0)
        )

    def _add_joint(self, joint: JointData, engaged: object = True, *given: object) -> Joint:
        """Keep a joint; it floats where one of the points ``given`` is a bare body, or the world."""
        holds = _check.flag(engaged, "engaged")
        floats = any(one is None or isinstance(one, (Beam, Cable, CableNet, RigidBody)) for one in given)
        self._joints[joint.name] = joint
        self._latches[joint.name] = Latch(holds, floats)
        return Joint(joint.name, self._identity, self)

    def _add_load(self, load: LoadData) -> Load:
        self._loads[load.name] = load
        return Load(load.name, self._identity)

    def _require_latch(self, joint: str) -> None:
        """Refuse joints that cannot be released."""
        if isinstance(self._joints.get(joint), SlideCable):
            _check.fail("joint", joint, "slides along a cable: it cannot be released or engaged")
        if isinstance(self._joints.get(joint), DriveForce):
            _check.fail(
                "joint",
                joint,
                "is a torque or a force, which cannot be released or engaged: let its value go to zero, as a "
                "Table or an Input",
            )
        self._require_free(joint)

    def _require_free(self, joint: str) -> None:
        """Refuse to release or engage joints along which something acts."""
        along = acting_along(self._joints, joint)
        if along is not None:
            _check.fail(
                "joint",
                joint,
                f"what acts along it ('{along}') cannot be released: let the joint hold, or release a drive "
                "in its stead, or take add_spring between its bodies",
            )

    def _latch(self, joint: str) -> Latch:
        """Tell when a joint holds."""
        return self._latches.get(joint, Latch())

    def _body(self, handle: Any, name: str) -> Body:
        if not isinstance(handle, Handle) or isinstance(handle, (Joint, Load, Obstacle, Contact)):
            _check.fail(name, handle, "must be a body of this model")
        require_handle(handle, name, self._identity)
        if handle.name not in self._bodies:
            _check.fail(name, handle, f"this model has no body '{handle.name}'")
        return self._bodies[handle.name]

    def _one_part(self, body: Any, name: str) -> Faces:
        """Faces of one surface: of a body, or chosen."""
        if isinstance(body, (Shell, Membrane)):
            self._body(body, name)
            body = body.faces()
        if not isinstance(body, Faces):
            _check.fail(name, body, "must be a shell, a membrane or sheet.faces(...)")
        self._check_part(body, name)
        return body

    def _check_part(self, part: Edge | Faces, name: str) -> None:
        if part.identity != self._identity:
            raise ModelError(
                f"{name} = {part}: belongs to another model; model[name] gives the handle of this one"
            )
        body = self._bodies.get(part.body)
        if not isinstance(body, SurfaceBody):
            _check.fail(name, str(part), f"this model has no surface '{part.body}'")
        highest = max(part.nodes) if isinstance(part, Edge) else max(part.numbers)
        if highest >= (body.nodes if isinstance(part, Edge) else body.elements):
            _check.fail(name, str(part), f"'{part.body}' of this model has another mesh")

    def _point(self, value: Any, name: str) -> Point:
        if isinstance(value, (PointMass, RigidBody)):
            value = value.center
        if not isinstance(value, Point):
            _check.fail(name, value, "must be a point of a body, such as rope.end")
        require_handle(value, name, self._identity)
        body = self._bodies.get(value.body)
        if body is None:
            _check.fail(name, value, f"this model has no body '{value.body}'")
        elements, nodes = 1, 1
        if isinstance(body, (LineBody, SurfaceBody, BeamBody)):
            elements, nodes = body.elements, body.nodes
        if value.element >= elements or (value.node is not None and value.node >= nodes):
            _check.fail(name, value, f"body '{value.body}' of this model has {elements} elements")
        kinds = tuple(place is not None for place in (value.local, value.at, value.offset))
        if kinds != tuple(isinstance(body, kind) for kind in (RigidBodyData, SurfaceBody, BeamBody)):
            _check.fail(name, value, f"body '{value.body}' of this model is of another kind")
        return value

    def _directed_point(self, value: Any, name: str) -> Point:
        point = self._point(value, name)
        if isinstance(self._bodies[point.body], MassBody):
            _check.fail(
                name,
                value,
                "must be a point of a cable, a beam or a rigid body: a point mass has no directions",
            )
        if self._is_membrane(point):
            _check.fail(name, value, "a membrane has no directions at a point; pin it")
        return point

    def _is_membrane(self, point: Point) -> bool:
        body = self._bodies[point.body]
        return isinstance(body, SurfaceBody) and body.kind == "membrane"

    def _line_point(self, value: Any, name: str) -> Point:
        point = self._point(value, name)
        if not isinstance(self._bodies[point.body], LineBody):
            _check.fail(name, value, "must be a point of a cable")
        return point

    def _other(self, value: Any, name: str) -> Point | WorldPoint:
        if isinstance(value, (Point, PointMass, RigidBody)):
            return self._point(value, name)
        if isinstance(value, Handle):
            _check.fail(name, value, "must be a point, a body or three numbers")
        return world_point(_check.vector(value, name))

    def _nearest(self, handle: Any, name: str, target: FloatArray) -> Point:
        body = self._body(handle, name)
        if isinstance(body, MassBody):
            return self._point(handle, name)
        return body.nearest(target, self._identity)

    def _pair(
        self, a: Any, b: Any, names: tuple[str, str], *, anywhere: bool = False
    ) -> tuple[Point, Point | WorldPoint, bool]:
        """Points that a joint brings together; a bare body is its point at the other side's place.

        ``anywhere``: the joint is the same wherever its point lies on a rigid body, so that two bare ones do.
        """
        bare = (Beam, Cable, CableNet, RigidBody, Shell, Membrane)
        if not isinstance(a, (Point, Handle)):
            _check.fail(names[0], a, "must be a point of a body, such as rope.start")
        if anywhere and isinstance(a, RigidBody) and (b is None or isinstance(b, bare)):
            a = a.center
        if isinstance(a, bare) and isinstance(b, bare):
            _check.fail(names[1], b, "give a point of one of the two bodies, such as rope.end")
        if isinstance(a, bare) and b is None:
            _check.fail(names[0], a, "give the point of the body, such as rope.start or body.at((0, 0, 0))")
        other: Point | WorldPoint
        if isinstance(a, bare):
            other = self._other(b, names[1])
            point = self._nearest(a, names[0], self._position(other))
        else:
            point = self._point(a, names[0])
            here = self._position(point)
            if b is None:
                other = world_point(here)
            elif isinstance(b, bare):
                other = self._nearest(b, names[1], here)
            else:
                other = self._other(b, names[1])
        if point == other:
            _check.fail(names[1], b, "is the same point")
        return point, other, b is None

    def _require_together(
        self, a: Point, b: Point | WorldPoint, given: Any, name: str, engaged: object = True
    ) -> None:
        """Refuse two points that do not coincide at the start, where the joint holds from there."""
        gap = float(np.linalg.norm(self._position(a) - self._position(b)))
        if engaged is not False and gap > 1e-6 * self._size():
            _check.fail(
                name,
                given,
                f"the points must coincide at the start, but are {gap:.6g} m apart ({a}; {b}); move one "
                "body, or give engaged=False to a joint that engages later",
            )
        for one, other in ((a, b), (b, a)):
            if isinstance(one, Point) and isinstance(other, Point):
                self._require_same_plane(one, other)

    def _tangent(self, point: Point | WorldPoint) -> FloatArray | None:
        """Return the unit tangent at the start, on cables."""
        body = self._bodies[point.body] if isinstance(point, Point) else None
        if not isinstance(body, LineBody) or not isinstance(point, Point):
            return None
        tangent = body.tangent(point.element, point.xi)
        unit: FloatArray = tangent / np.linalg.norm(tangent)
        return unit

    def _position(self, point: Point | WorldPoint) -> FloatArray:
        """Position at the start."""
        if isinstance(point, WorldPoint):
            return np.array(point.position)
        body = self._bodies[point.body]
        if isinstance(body, MassBody):
            return self._position(body.at) if body.at is not None else np.array(body.position.position)
        if isinstance(body, RigidBodyData):
            center: FloatArray = body.weights(point) @ body.r
            return center
        if isinstance(body, (SurfaceBody, BeamBody)):
            return body.place(point)
        if point.node is not None:
            place: FloatArray = body.r[body.first[point.node]]
            return place.copy()
        first, weights = body.shape(point.element, point.xi)
        result: FloatArray = weights @ np.stack(
            [body.r[first], body.t[first], body.r[first + 1], body.t[first + 1]]
        )
        return result

    def _size(self) -> float:
        """Largest edge of the box around the model [m]."""
        known, low, high = self._box
        for body in islice(self._bodies.values(), known, None):
            places = _outline(body)
            low, high = np.minimum(low, places.min(axis=0)), np.maximum(high, places.max(axis=0))
        self._box = (len(self._bodies), low, high)
        size = float((high - low).max())
        return size if size > 0 else 1.0

    def _require_in_plane(self, body: Body, value: Any, name: str, along: bool = False) -> None:
        """Refuse vectors out of the plane of a line that is curved at rest (``along``: off its normal)."""
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
                f"cable '{confined.name}' is curved at rest and confined to a plane; '{free.name}' is not",
            )


def _outline(body: Body) -> FloatArray:
    """Points whose box holds the body at the start, (n, 3); rigid bodies have their radius of gyration."""
    if isinstance(body, RigidBodyData):
        gyration = float(np.sqrt(np.trace(body.inertia) / 2.0 / body.mass))
        cube: FloatArray = body.position + gyration * np.array([[-1.0], [1.0]])
        return cube
    return np.array([body.position.position]) if isinstance(body, MassBody) else body.r


def world_point(place: FloatArray) -> WorldPoint:
    return WorldPoint((float(place[0]), float(place[1]), float(place[2])))


def _samples(signal: Signal) -> FloatArray:
    """Values of a signal where it is certain to be asked."""
    times = [0.0, 1.0]
    if isinstance(signal, Table):
        return signal.values
    return np.array([signal(t) for t in times])
