"""Contact and obstacles, as methods of the model."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np

from pliant import _check
from pliant._actuation import Actuation
from pliant._sides import LINES, why_not
from pliant.contacts import Bore, ContactData, HalfSpace, ObstacleData, TriangleMesh
from pliant.points import Contact, Handle, Obstacle, require_handle
from pliant.shapes import Shape
from pliant.typing import ArrayLike

__all__ = ["Touching"]


class Touching(Actuation):
    """Contact and obstacles."""

    def add_obstacle(
        self,
        shape: Any,
        *,
        position: ArrayLike = (0.0, 0.0, 0.0),
        orientation: Any = None,
        name: str | None = None,
    ) -> Obstacle:
        """Add a fixed shape that bodies may touch; :meth:`add_contact` says which do.

        Parameters
        ----------
        shape : HalfSpace, Sphere, Box, Cylinder, Capsule, TriangleMesh or Bore
            The shape; a half-space lies below the plane through ``position``.
        position : array_like, shape (3,)
            Its centre [m].
        orientation : scipy.spatial.transform.Rotation, optional
            Axes of the shape to world; None: the axes of the world.

        Returns
        -------
        Obstacle
            Handle.

        Examples
        --------
        >>> import pliant as pl
        >>> model = pl.Model(gravity=(0, 0, -9.81))
        >>> ground = model.add_obstacle(pl.HalfSpace())
        >>> drum = model.add_obstacle(pl.Cylinder(radius=0.1, length=0.3), position=(0, 0, 1))
        >>> drum.name
        'obstacle2'
        """
        if not isinstance(shape, (Shape, HalfSpace, TriangleMesh, Bore)):
            _check.fail(
                "shape",
                shape,
                "must be a HalfSpace, Sphere, Box, Cylinder, Capsule, TriangleMesh or Bore",
            )
        place = _check.vector(position, "position")
        axes = np.eye(3)
        if orientation is not None:
            from scipy.spatial.transform import Rotation

            if not isinstance(orientation, Rotation) or not orientation.single:
                _check.fail("orientation", orientation, "must be one scipy.spatial.transform.Rotation")
            axes = orientation.as_matrix().T
        name = self._new_name(name, "obstacle")
        self._obstacles[name] = ObstacleData(name, shape, place, axes)
        return Obstacle(name, self._identity)

    def add_contact(
        self,
        a: Any,
        b: Any = None,
        *,
        stiffness: float | None = None,
        damping: float | None = None,
        friction: Any = None,
        name: str | None = None,
    ) -> Contact:
        """Let two bodies touch, or a body and an obstacle, or a body itself.

        Where a joint holds the two together, and near it, they do not touch.

        Parameters
        ----------
        a : Cable, CableNet, Beam, Shell, Membrane, RigidBody or PointMass
            A body; a rigid body must have a shape.
        b : body or Obstacle, optional
            The other; None: ``a`` itself, a cable, beam, shell or membrane. Cables, beams, shells and
            membranes touch each other, obstacles and rigid bodies; point masses obstacles, rigid bodies,
            shells and membranes. Friction against lines and obstacles turns a beam about its line; a cable
            cannot twist.
        stiffness : float, optional
            Force per penetration: per length of a cable or beam [N/m^2], per area of a shell or membrane
            [N/m^3], at a point of a rigid body or mass [N/m]. None: of lines, also on surfaces, as stiff as
            two round bars of these materials that cross; of surfaces E/t, a layer of the material, E no more
            than 20 MPa; of a mass on a surface as stiff as the layer under it; of rigid bodies such that the
            lighter one sinks in by a thousandth of its size under its weight.
        damping : float, optional
            Hunt-Crossley [s/m]: the force times 1 + damping x approach speed, never pulling; None: 3.
        friction : LuGre or Coulomb, optional
            None: none.

        Returns
        -------
        Contact
            Handle.

        Examples
        --------
        >>> import pliant as pl
        >>> model = pl.Model(gravity=(0, 0, -9.81))
        >>> rubber = pl.LinearElastic(youngs_modulus=1e7, poisson_ratio=0.45, density=1000.0)
        >>> thin = pl.Circle(radius=5e-3)
        >>> rope = model.add_cable([(0, 0, 1), (1, 0, 1)], elements=8, section=thin, material=rubber)
        >>> ground = model.add_obstacle(pl.HalfSpace())
        >>> touch = model.add_contact(rope, ground, friction=pl.LuGre(static=0.6, dynamic=0.5))
        >>> [contact.name for contact in model.contacts]
        ['contact1']
        """
        names = [self._partner(a, "a"), self._partner(a if b is None else b, "b")]
        if names[0] in self._obstacles:
            names.reverse()
        reason = why_not(*(self._obstacles.get(name) or self._bodies[name] for name in names))
        if reason is not None:
            _check.fail(
                "a" if b is None or names[0] in self._obstacles else "b", a if b is None else b, reason
            )
        for other in self._contacts.values():
            if {other.a, other.b} == set(names):
                _check.fail("b", b, f"the two touch already in '{other.name}'")
        data = ContactData(self._new_name(name, "contact"), names[0], names[1], stiffness, damping, friction)
        self._contacts[data.name] = data
        return Contact(data.name, self._identity)

    def add_contacts(
        self,
        bodies: Any,
        *,
        stiffness: float | None = None,
        damping: float | None = None,
        friction: Any = None,
    ) -> list[Contact]:
        """Let all of these bodies touch each other, lines also themselves, and the obstacles among them.

        Shells and membranes touch themselves where :meth:`add_contact` says so: that costs a search.

        Parameters
        ----------
        bodies : sequence of bodies and Obstacles
            At least one body.
        stiffness, damping, friction
            As for :meth:`add_contact`.

        Returns
        -------
        list of Contact
            Handles, one a pair.

        Examples
        --------
        >>> import pliant as pl
        >>> model = pl.Model()
        >>> rubber = pl.LinearElastic(youngs_modulus=1e7, poisson_ratio=0.45, density=1000.0)
        >>> kind = {"elements": 8, "section": pl.Circle(radius=5e-3), "material": rubber}
        >>> ropes = [model.add_cable([(0, y, 0), (1, y, 0)], **kind) for y in (0.0, 0.1)]
        >>> len(model.add_contacts(ropes, friction=pl.Coulomb(0.3)))
        3
        """
        if isinstance(bodies, Handle) or not isinstance(bodies, Iterable):
            _check.fail("bodies", bodies, "must be a list of bodies and obstacles")
        items = list(bodies)
        for k, item in enumerate(items):
            self._partner(item, f"bodies[{k}]")
        pairs = [
            (one, other)
            for k, one in enumerate(items)
            for other in items[k:]
            if not (isinstance(one, Obstacle) and isinstance(other, Obstacle))
            and (one is not other or isinstance(self._body(one, "bodies"), LINES))
        ]
        if not pairs:
            _check.fail("bodies", bodies, "must hold a cable, or two that may touch")
        options = {"stiffness": stiffness, "damping": damping, "friction": friction}
        return [self.add_contact(one, other, **options) for one, other in pairs]

    def _partner(self, value: Any, name: str) -> str:
        """Name of a body or obstacle."""
        if isinstance(value, Obstacle):
            require_handle(value, name, self._identity)
            if value.name not in self._obstacles:
                _check.fail(name, value, f"this model has no obstacle '{value.name}'")
            return value.name
        return self._body(value, name).name
