"""Springs and drives, as methods of the model."""

from __future__ import annotations

from typing import Any

import numpy as np

from pliant import _check
from pliant._mechanism import Mechanism
from pliant.forces import Spring
from pliant.points import Load

__all__ = ["Drives"]


class Drives(Mechanism):
    """Springs and drives."""

    def add_spring(
        self,
        a: Any,
        b: Any,
        stiffness: float,
        damping: float = 0.0,
        length: float | None = None,
        *,
        name: str | None = None,
    ) -> Load:
        """Add a spring and damper between two points.

        Parameters
        ----------
        a : Point or RigidBody
            First point; of a bare rigid body its centre.
        b : Point, RigidBody or array_like, shape (3,)
            Second point, or a point fixed in the world.
        stiffness : float
            Force per stretch [N/m], from 0 on.
        damping : float
            Force per rate of the length [N s/m], from 0 on.
        length : float, optional
            Stress-free length [m]; None: the distance at the start. A spring of length 0 pulls by
            ``stiffness`` times the distance and damps motion in all directions alike: a bushing.

        Returns
        -------
        Load
            Handle for ``result.spring``.

        Examples
        --------
        >>> import pliant as pl
        >>> model = pl.Model(gravity=(0, 0, -9.81))
        >>> ball = model.add_point_mass(2.0, at=(0, 0, -1))
        >>> spring = model.add_spring(ball, (0, 0, 0), stiffness=100.0)
        >>> result = pl.solve_static(model)
        >>> print(f"{result.spring(spring).force[-1]:.2f}")
        19.62
        """
        first = self._point(a, "a")
        second = self._other(b, "b")
        if first == second:
            _check.fail("b", b, "is the same point")
        if length is None:
            length = float(np.linalg.norm(self._position(first) - self._position(second)))
        return self._add_load(
            Spring(
                self._new_name(name, "spring"),
                first,
                second,
                _check.number(stiffness, "stiffness", at_least=0),
                _check.number(damping, "damping", at_least=0),
                _check.number(length, "length", at_least=0),
            )
        )
