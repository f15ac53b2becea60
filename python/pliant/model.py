"""The model: a description of bodies, joints and loads, no numerics."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any

import numpy as np

from pliant import _check
from pliant._beams import Beams
from pliant._contents import world_point
from pliant._document import VERSION, decode, encode
from pliant._folds import Folds
from pliant._pneumatics import Pneumatics
from pliant._touching import Touching
from pliant.beams import BeamBody
from pliant.bodies import LineBody, MassBody, line_of, line_of_net, make_line_body
from pliant.contacts import ContactData, ObstacleData
from pliant.errors import FileError, ModelError
from pliant.files import atomic
from pliant.forces import FORCES
from pliant.gas import Chamber
from pliant.joints import JOINTS, Clamp, Pin
from pliant.latches import Latch
from pliant.loads import EdgeLoad, EdgeMoment, Force, LineLoad, Moment, MovingForce, Pressure
from pliant.materials import Material
from pliant.points import Cable, CableNet, Handle, Joint, Load, Point, PointMass, RigidBody
from pliant.rigid import RigidBodyData
from pliant.signals import Signal, as_signal
from pliant.surfaces import Edge, Faces, SurfaceBody
from pliant.typing import ArrayLike, FloatArray, Json

if TYPE_CHECKING:
    from pliant.redundancy import Redundancy

__all__ = ["Model"]

LOADS = (Force, Moment, LineLoad, MovingForce, EdgeLoad, EdgeMoment, Pressure, Chamber, *FORCES)


LATER = ("obstacles", "contacts")
"""Lists that a document may lack."""


class Model(Beams, Folds, Pneumatics, Touching):
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

    # Bodies

    def add_cable(
        self,
        points: Any,
        *,
        elements: int,
        section: Any,
        material: Material,
        rest: str = "given",
        rest_length: Any = None,
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
            One section, a list of one for each element, or a callable of arc length [m]. Alike in bending
            about every axis.
        material : LinearElastic, SaintVenantKirchhoff or BilinearPlastic
            The material; the first two are one law here.
        rest : {"given", "straight"}
            ``"given"``: stress-free as given, straight or curved in a plane and then confined to it.
            ``"straight"``: free of axial strain as given, straight when unloaded; any line in space.
        rest_length : float, callable, Table, product with a Ramp, or Input, optional
            Stress-free length [m]; ``points`` are then the line at the start. The mass stays that of the
            line as given by ``points``. Where it changes in time, a winch hauls in or pays out: the
            stress-free length of the whole line scales (a curved one stays similar), and the work of the
            winch enters the balance of energy. In statics it is evaluated at the load factor, not scaled.
        pretension : float, optional
            Axial force [N] at the start, 0 or more; instead of ``rest_length``. The mass stays likewise.
            Where the material yields, a line pulled so far has done so before the run begins.
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
        >>> thin = pl.Circle(radius=1e-3)
        >>> wire = model.add_cable(
        ...     [(0, 0, 0), (10, 0, 0)], elements=8, section=thin, material=steel, pretension=100.0
        ... )
        >>> round(wire.length, 5)
        9.99848
        """
        rest = _check.choice(rest, "rest", ("given", "straight"))
        closed = _check.flag(closed, "closed")
        line = line_of(points, elements, closed, rest)
        if rest_length is not None and pretension is not None:
            _check.fail("pretension", pretension, "give rest_length or pretension, not both")
        winch: Signal | None = None
        if callable(rest_length) or isinstance(rest_length, Signal):
            winch = as_signal(rest_length, "rest_length", 1)
            rest_length = float(winch(0.0)[0])
            winch = None if winch.constant else winch
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
            rest_length=winch,
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
        """Add a net of cables between points; those that end at one point share its position, not slopes.

        Parameters
        ----------
        points : array_like, shape (n, 3)
            Knots [m].
        edges : array_like of int, shape (m, 2)
            Points that each cable joins.
        elements : int or array_like of int, shape (m,)
            Elements of each cable.
        section, material, tension_only, strain, integration, bending, initial, velocity, angular_velocity,
        name
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
        >>> edges = [(0, 1), (1, 2), (2, 3), (3, 0)]
        >>> net = model.add_cable_net(
        ...     corners, edges, elements=2, section=pl.Circle(radius=1e-3), material=steel
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
        radius: float = 0.0,
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
        radius : float
            Radius for contact [m]; 0: a point.

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
        radius = _check.number(radius, "radius", at_least=0)
        self._bodies[name] = MassBody(name, mass, point, world_point(place), world_point(speed), radius)
        return self._mass_handle(name)

    # Joints

    def clamp(self, point: Any, *, engaged: bool = True, name: str | None = None) -> Joint:
        """Hold a point of a cable, its position and the direction of its tangent, or a rigid body.

        The stretch of a cable is free. Of a beam the position and the section's orientation are held, its
        stretch and the deformation of the section are free.

        Parameters
        ----------
        point : Point, RigidBody, Edge or Faces
            A point of a cable, a net or a shell, a rigid body, an edge of a surface (its positions and the
            direction in which the surface leaves it), or faces of one.
        engaged : bool
            Whether it holds from the start; else it is free until :meth:`Joint.engage` or
            :meth:`Stepper.engage`, and its points may be apart.

        Returns
        -------
        Joint
            Handle for ``result.reaction``.

        Examples
        --------
        >>> import pliant as pl
        >>> model = pl.Model()
        >>> rubber = pl.LinearElastic(youngs_modulus=1e7, poisson_ratio=0.45, density=1000.0)
        >>> thin = pl.Circle(radius=5e-3)
        >>> rope = model.add_cable([(0, 0, 0), (1, 0, 0)], elements=4, section=thin, material=rubber)
        >>> wall = model.clamp(rope.start)
        >>> model.constraints
        5
        """
        if isinstance(point, (Edge, Faces)):
            return self._hold("clamp", point, name)
        at = self._directed_point(point, "point")
        return self._add_joint(Clamp(self._new_name(name, "clamp"), at), engaged, None)

    def pin(
        self,
        point: Any,
        to: Any = None,
        *,
        directions: ArrayLike | None = None,
        engaged: bool = True,
        name: str | None = None,
    ) -> Joint:
        """Hold a point's position.

        Parameters
        ----------
        point : Point, body or Edge
            First point; or an edge of a surface, held all along: it may turn about itself.
        to : Point, body or array_like, shape (3,), optional
            Second point, at the same place; None: the world, where the point starts.
        directions : array_like, shape (3,) or (k, 3), optional
            Directions that are held at a node or an edge of a surface; by default all.
        engaged : bool
            Whether it holds from the start; else it is free until :meth:`Joint.engage` or
            :meth:`Stepper.engage`, and its points may be apart.

        Returns
        -------
        Joint
            Handle for ``result.reaction``: the force on the first body.

        Examples
        --------
        >>> import pliant as pl
        >>> model = pl.Model()
        >>> rubber = pl.LinearElastic(youngs_modulus=1e7, poisson_ratio=0.45, density=1000.0)
        >>> thin = pl.Circle(radius=5e-3)
        >>> rope = model.add_cable([(0, 0, 0), (1, 0, 0)], elements=4, section=thin, material=rubber)
        >>> hook = model.pin(rope.start)
        >>> model.constraints
        3
        """
        if isinstance(point, Edge) or directions is not None:
            if isinstance(point, Edge) and isinstance(to, RigidBody) and directions is None:
                return self._pin_to_body(point, to, name)
            if to is not None:
                _check.fail(
                    "to", to, "edges are pinned to the world or to a rigid body; weld joins two edges"
                )
            return self._pin_directions(point, directions, name)
        a, b, here = self._pair(point, to, ("point", "to"))
        self._require_together(a, b, to, "to", engaged)
        return self._add_joint(Pin(self._new_name(name, "pin"), a, b, here), engaged, point, to)

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
            Turns with the tangent of the cable, in the plane of tangent and force at the start, or with the
            rigid body or the section of the beam.

        Examples
        --------
        >>> import pliant as pl
        >>> model = pl.Model()
        >>> rubber = pl.LinearElastic(youngs_modulus=1e7, poisson_ratio=0.45, density=1000.0)
        >>> thin = pl.Circle(radius=5e-3)
        >>> rope = model.add_cable([(0, 0, 0), (1, 0, 0)], elements=4, section=thin, material=rubber)
        >>> steady = model.add_force(rope.end, (0, 0, 1.0))
        >>> rising = model.add_force(rope.end, (0, 1.0, 0) * pl.Ramp(0.5), name="rising")
        >>> [load.name for load in model.loads]
        ['force1', 'rising']
        """
        at = self._point(point, "point")
        value = as_signal(force, "force", 3)
        follower = _check.flag(follower, "follower")
        body = self._bodies[at.body]
        if follower and isinstance(body, MassBody):
            _check.fail("follower", follower, "a point mass has no direction to follow")
        self._require_in_plane(body, value, "force")
        return self._add_load(Force(self._new_name(name, "force"), at, value, follower))

    def add_moment(self, point: Any, moment: Any, *, name: str | None = None) -> Load:
        """Add a moment at a point of a cable or a beam, or on a rigid body.

        On a cable the part along the tangent does nothing.

        Parameters
        ----------
        point : Point
            Where.
        moment : array_like, shape (3,), callable, Table or product with a Ramp
            Moment [N m], with fixed axis.

        Examples
        --------
        >>> import pliant as pl
        >>> model = pl.Model()
        >>> rubber = pl.LinearElastic(youngs_modulus=1e7, poisson_ratio=0.45, density=1000.0)
        >>> thin = pl.Circle(radius=5e-3)
        >>> rope = model.add_cable([(0, 0, 0), (1, 0, 0)], elements=4, section=thin, material=rubber)
        >>> model.add_moment(rope.end, (0, 0, 0.1)).name
        'moment1'
        """
        at = self._directed_point(point, "point")
        value = as_signal(moment, "moment", 3)
        self._require_in_plane(self._bodies[at.body], value, "moment", along=True)
        return self._add_load(Moment(self._new_name(name, "moment"), at, value))

    def add_line_load(self, cable: Any, force_per_length: Any, *, name: str | None = None) -> Load:
        """Add a force per stress-free length on all of a cable, net or beam, or on an edge of a surface.

        Parameters
        ----------
        cable : Cable, CableNet, Beam or Edge
            The body (of a beam its centre line), or ``sheet.edge(points)``.
        force_per_length : array_like, shape (3,), callable, Table or product with a Ramp
            Force per length [N/m].

        Examples
        --------
        >>> import pliant as pl
        >>> model = pl.Model()
        >>> rubber = pl.LinearElastic(youngs_modulus=1e7, poisson_ratio=0.45, density=1000.0)
        >>> thin = pl.Circle(radius=5e-3)
        >>> rope = model.add_cable([(0, 0, 0), (1, 0, 0)], elements=4, section=thin, material=rubber)
        >>> model.add_line_load(rope, lambda t: (0, 0.2 * t, 0)).name
        'line_load1'
        """
        if isinstance(cable, Edge):
            return self._edge_load(cable, force_per_length, name)
        body = self._body(cable, "cable")
        if not isinstance(body, (LineBody, BeamBody)):
            _check.fail("cable", cable, "must be a cable, a net, a beam or an edge of a surface")
        value = as_signal(force_per_length, "force_per_length", 3)
        self._require_in_plane(body, value, "force_per_length")
        return self._add_load(LineLoad(self._new_name(name, "line_load"), body.name, value))

    # What is in it

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

    @property
    def redundant(self) -> tuple[Redundancy, ...]:
        """Joints with equations that follow from those of others at the start, which runs leave out.

        The motion is that of all equations; of the multipliers, which they do not determine, the smallest are
        found: the least sum of squares of forces times the size of the model, and moments.

        Examples
        --------
        >>> import pliant as pl
        >>> model = pl.Model()
        >>> door = model.add_rigid_body(density=500.0, shape=pl.Box((0.8, 0.04, 2.0)), position=(0.4, 0, 0))
        >>> upper = model.hinge(door.at((-0.4, 0, 0.8)), name="upper")
        >>> lower = model.hinge(door.at((-0.4, 0, -0.8)), name="lower")
        >>> model.redundant
        (Redundancy(joint='lower', equations=5, follows_from=('upper',)),)
        """
        from pliant.redundancy import redundancies

        return redundancies(self)

    def __repr__(self) -> str:
        return f"<Model: {len(self._bodies)} bodies, {len(self._joints)} joints, {len(self._loads)} loads>"

    def __str__(self) -> str:
        from pliant._table import describe

        return describe(self)

    def _repr_html_(self) -> str:
        from pliant._table import describe_as_html

        return describe_as_html(self)

    # Copies and files

    def copy(self) -> Model:
        """Copy of the model; handles of one serve the other."""
        other = Model(self._gravity)
        other._identity = self._identity
        other._bodies, other._joints, other._loads = dict(self._bodies), dict(self._joints), dict(self._loads)
        other._latches = dict(self._latches)
        other._obstacles, other._contacts = dict(self._obstacles), dict(self._contacts)
        return other

    __copy__ = copy

    def __deepcopy__(self, memo: object) -> Model:
        return self.copy()

    def to_document(self, *, keep_functions: bool = True) -> Json:
        """Write the model as a JSON document; refuses callables, or leaves markers for them."""
        lists: dict[str, dict[str, Any]] = {
            "bodies": self._bodies,
            "joints": self._joints,
            "loads": self._loads,
            "obstacles": self._obstacles,
            "contacts": self._contacts,
        }
        return {
            "format": "pliant-model",
            "version": VERSION,
            "identity": self._identity,
            "gravity": self._gravity.tolist(),
            **{
                key: [encode(item, f"{key[:-1]} '{name}'", keep_functions) for name, item in items.items()]
                for key, items in lists.items()
            },
            "latches": {name: latch.document() for name, latch in self._latches.items()},
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
            lists: list[tuple[str, dict[str, Any], tuple[type, ...]]] = [
                ("bodies", model._bodies, (LineBody, MassBody, RigidBodyData, SurfaceBody, BeamBody)),
                ("joints", model._joints, JOINTS),
                ("loads", model._loads, LOADS),
                ("obstacles", model._obstacles, (ObstacleData,)),
                ("contacts", model._contacts, (ContactData,)),
            ]
            for key, items, kinds in lists:
                for entry in document.get(key, []) if key in LATER else document[key]:
                    item = decode(entry)
                    if type(item) not in kinds:
                        raise ModelError(f"{key}: {type(item).__name__} does not belong here")
                    items[item.name] = item
            latches = document.get("latches", {})
            model._latches = {name: Latch.read(latches[name]) for name in model._joints if name in latches}
            model._latches |= {name: Latch() for name in model._joints if name not in latches}
            model._verify()
        except (KeyError, TypeError, ValueError, AttributeError, IndexError) as error:
            raise FileError(f"{source}: is damaged: {error}") from error
        return model

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the model to a JSON file.

        Parameters
        ----------
        path : str or path
            File, ``model.json`` by custom. Python callables are refused; ``Table.sample`` makes tables of
            them.
        """
        import json

        text = json.dumps(self.to_document())
        with atomic(path) as temporary:
            temporary.write_text(text)

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Model:
        """Read a model from a JSON file; handles of the saved model serve it."""
        import json
        from pathlib import Path

        try:
            document = json.loads(Path(path).read_text())
        except OSError as error:
            raise FileError(f"{path}: cannot be read: {error.strerror}") from error
        except ValueError as error:
            raise FileError(f"{path}: is not a pliant model: {error}") from error
        return cls.from_document(document, str(path))


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
