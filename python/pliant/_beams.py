"""Methods of the model for beams."""

from __future__ import annotations

from typing import Any

from pliant._mechanism import Mechanism
from pliant.beams import Beam, make_beam
from pliant.materials import Material
from pliant.typing import ArrayLike

__all__ = ["Beams"]


class Beams(Mechanism):
    """Bodies that stretch, shear, bend and twist."""

    def add_beam(
        self,
        points: Any,
        *,
        elements: int,
        section: Any,
        material: Material,
        up: Any = (0.0, 0.0, 1.0),
        locking: str = "enhanced",
        initial: ArrayLike | None = None,
        velocity: Any = None,
        angular_velocity: ArrayLike = (0.0, 0.0, 0.0),
        name: str | None = None,
    ) -> Beam:
        """Add a beam: it stretches, shears, bends and twists, and its sections deform.

        Parameters
        ----------
        points : array_like, shape (n, 3), or Curve
            Points on a straight line [m], or a :class:`Curve`, in space as it likes: the stress-free shape.
        elements : int
            Number of elements.
        section
            One section, a list of one for each element, or a callable of arc length [m].
        material : LinearElastic or SaintVenantKirchhoff
            The material; both are one law here.
        up : array_like, shape (3,), or callable
            Direction nearest to the sections' z; a callable of arc length [m] twists the stress-free shape.
            Where it runs along a straight beam another axis is taken, with a warning.
        locking : {"enhanced", "poisson", "none"}
            ``"enhanced"``: law of sections on assumed strains, fourth order, no locking. ``"poisson"``: the
            continuum with Poisson's ratio on the axis only, second order. ``"none"``: the continuum, too
            stiff in bending however fine the mesh; for comparisons. The last two need one section of known
            shape.
        initial : array_like, shape (nodes, 3), optional
            Positions at the start [m], where they are not the stress-free ones; slopes follow smoothly,
            sections without twist.
        velocity : array_like, shape (3,) or (nodes, 3), or callable, optional
            Velocity at the start [m/s]; a callable takes the initial positions (n, 3) and returns (n, 3).
        angular_velocity : array_like, shape (3,)
            Angular velocity at the start about the world's origin [rad/s].
        name : str, optional
            Name; else ``beam1``, ``beam2``, ...

        Returns
        -------
        Beam
            Handle with ``start``, ``end``, ``at(s, offset=(y, z))`` and ``node(i)``.

        Examples
        --------
        >>> import pliant as pl
        >>> model = pl.Model()
        >>> steel = pl.LinearElastic(youngs_modulus=2.1e11, poisson_ratio=0.3, density=7850.0)
        >>> bar = pl.Rectangle(width=0.02, height=0.04)
        >>> arm = model.add_beam([(0, 0, 0), (1, 0, 0)], elements=4, section=bar, material=steel)
        >>> wall = model.clamp(arm.start)
        >>> load = model.add_force(arm.at(1.0, offset=(0.01, 0)), (0, 0, -100.0))
        >>> result = pl.solve_static(model)
        >>> print(f"{1e3 * (result.track(arm.end).position[-1, 2]):.3f} mm")
        -1.489 mm
        """
        body = make_beam(
            points,
            name=self._new_name(name, "beam"),
            elements=elements,
            section=section,
            material=material,
            up=up,
            locking=locking,
            initial=initial,
            velocity=velocity,
            angular_velocity=angular_velocity,
        )
        self._bodies[body.name] = body
        return Beam(body.name, self._identity, body)
