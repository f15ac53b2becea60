"""Folds, as methods of the model."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np

from pliant import _check
from pliant._crease import Crease
from pliant._sheets import Sheets
from pliant.joints import Fold
from pliant.points import Joint
from pliant.signals import as_signal
from pliant.surfaces import Edge

__all__ = ["Folds"]

CLOSE = 1e-6  # largest difference of an angle from where it is held at the start [rad]


class Folds(Sheets):
    """What joins surfaces at an angle."""

    def fold(
        self,
        edge_a: Edge,
        edge_b: Edge,
        stiffness: float = 0.0,
        angle: Any = None,
        *,
        damping: float = 0.0,
        name: str | None = None,
    ) -> Joint:
        """Join two edges by a crease: they keep one position, the surfaces turn about it.

        Parameters
        ----------
        edge_a, edge_b : Edge
            Edges on the rims of surfaces, of one body or two, whose nodes coincide at the start.
        stiffness : float
            Moment about the crease per length and angle [N/rad], from 0 on.
        angle : float, callable, Table or product with a Ramp, optional
            Angle [rad] where the crease has no moment; without ``stiffness`` the angle that it is held at,
            from the start on. None: as in the stress-free meshes; without ``stiffness`` the crease is free.
            The angle is 0 where the second surface continues the first, positive where it turns to the side
            of the first one's normal.
        damping : float
            Moment about the crease per length and rate of the angle [N s/rad], from 0 on.

        Returns
        -------
        Joint
            Handle for ``result.reaction`` and ``result.joint``: mean angle along the crease, and its moment.

        Examples
        --------
        >>> import pliant as pl
        >>> model = pl.Model()
        >>> card = pl.SaintVenantKirchhoff(youngs_modulus=4e9, poisson_ratio=0.3, density=800.0)
        >>> left = pl.Mesh.rectangle(1, 1, divisions=(2, 2))
        >>> right = pl.Mesh(left.points + (1, 0, 0), left.quads)
        >>> a, b = (model.add_shell(mesh, thickness=1e-3, material=card) for mesh in (left, right))
        >>> crease = model.fold(a.edge("u_max"), b.edge([(1, 0, 0), (1, 1, 0)]), stiffness=0.1)
        >>> model.constraints
        18
        """
        stiffness = _check.number(stiffness, "stiffness", at_least=0)
        damping = _check.number(damping, "damping", at_least=0)
        course = None if angle is None else as_signal(angle, "angle", 1)
        edge_a, edge_b = self._matching(edge_a, edge_b, ("edge_a", "edge_b"))
        for key, edge in (("edge_a", edge_a), ("edge_b", edge_b)):
            body = self._surface(edge.body)
            inner = any(len(body.sides[min(p), max(p)]) > 1 for p in pairwise(edge.nodes))
            if not edge.sides or inner or edge.nodes[0] == edge.nodes[-1]:
                _check.fail(key, str(edge), "must lie on the rim of its surface and not close on itself")
        crease = Crease(self, edge_a, edge_b)
        if course is not None and stiffness == 0.0:
            off = crease.angles(float(course(0.0)[0])) - float(course(0.0)[0])
            if np.abs(off).max() > CLOSE:
                allowed = f"must begin at the angle that the crease has, {crease.angles()[0]:.6g}"
                _check.fail("angle", float(course(0.0)[0]), allowed)
        point = self._surface(edge_a.body).node_point(self._identity, edge_a.nodes[0])
        joint = Fold(
            self._new_name(name, "fold"),
            point,
            "fold",
            edge_a,
            edge_b,
            stiffness=stiffness,
            damping=damping,
            angle=course,
        )
        return self._add_joint(joint)
