"""Cross sections. Section axes: x along the tangent, z nearest to ``up``; I_y is the integral of z^2."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from pliant import _check
from pliant.errors import ModelError
from pliant.typing import FloatArray

__all__ = ["Circle", "CrossSection", "Rectangle", "Section", "Tube"]


class _Shape:
    """What every cross section can do."""

    if TYPE_CHECKING:

        @property
        def area(self) -> float: ...
        @property
        def second_moments(self) -> tuple[float, float]: ...
        @property
        def torsion_constant(self) -> float | None: ...

        def _shear_corrections(self, poisson_ratio: float) -> tuple[float, float]:
            """Shear area along y and z over the area."""

        def _outline(self) -> FloatArray:
            """Corners (k, 2) of the section in its y and z [m], for pictures."""

        def _points(self) -> FloatArray | None:
            """Rule over the section, (m, 3): y, z, part of the area; exact to degree four. None: no shape."""

    def summary(self) -> str:
        """Describe the section in a few lines.

        Examples
        --------
        >>> print(Circle(radius=5e-3).summary())
        Circle(radius=0.005)
          area             7.85398e-05 m^2
          I_y, I_z         4.90874e-10, 4.90874e-10 m^4
          torsion constant 9.81748e-10 m^4
        """
        i_y, i_z = self.second_moments
        torsion = self.torsion_constant
        return "\n".join(
            [
                repr(self),
                f"  area             {self.area:g} m^2",
                f"  I_y, I_z         {i_y:g}, {i_z:g} m^4",
                f"  torsion constant {'not given' if torsion is None else f'{torsion:g} m^4'}",
            ]
        )


def _ring(radius: float) -> FloatArray:
    """Corners of a circle, (24, 2)."""
    angle = np.arange(24) * (2.0 * math.pi / 24)
    return radius * np.column_stack([np.cos(angle), np.sin(angle)])


def _polar_points(outer: float, inner: float) -> FloatArray:
    """Rule over a ring: two Gauss points in the square of the radius, eight angles."""
    middle, half = (outer**2 + inner**2) / 2.0, (outer**2 - inner**2) / 2.0
    radii = np.sqrt(middle + half * np.array([-1.0, 1.0]) / math.sqrt(3.0))
    angle = (np.arange(8) + 0.5) * (math.pi / 4.0)
    y, z = (np.outer(radii, f(angle)).ravel() for f in (np.cos, np.sin))
    return np.column_stack([y, z, np.full(16, math.pi * (outer**2 - inner**2) / 16.0)])


def _set(section: _Shape, **values: object) -> None:
    for name, value in values.items():
        object.__setattr__(section, name, value)


@dataclass(frozen=True)
class Circle(_Shape):
    """Full circle.

    Parameters
    ----------
    radius : float
        Radius [m], above 0.

    Examples
    --------
    >>> round(Circle(radius=0.01).area, 8)
    0.00031416
    """

    radius: float

    def __post_init__(self) -> None:
        _set(self, radius=_check.number(self.radius, "radius", above=0))

    @property
    def area(self) -> float:
        """Area [m^2]."""
        return math.pi * self.radius**2

    @property
    def second_moments(self) -> tuple[float, float]:
        """Second moments of area (I_y, I_z) [m^4]."""
        i = math.pi * self.radius**4 / 4.0
        return i, i

    @property
    def torsion_constant(self) -> float:
        """Torsion constant [m^4]."""
        return math.pi * self.radius**4 / 2.0

    def _shear_corrections(self, poisson_ratio: float) -> tuple[float, float]:
        k = 6.0 * (1.0 + poisson_ratio) / (7.0 + 6.0 * poisson_ratio)
        return k, k

    def _outline(self) -> FloatArray:
        return _ring(self.radius)

    def _points(self) -> FloatArray:
        return _polar_points(self.radius, 0.0)


@dataclass(frozen=True)
class Tube(_Shape):
    """Ring.

    Parameters
    ----------
    outer_radius, inner_radius : float
        Radii [m], outer above inner, inner above 0.

    Examples
    --------
    >>> Tube(outer_radius=0.02, inner_radius=0.01).radius
    0.02
    """

    outer_radius: float
    inner_radius: float

    def __post_init__(self) -> None:
        outer = _check.number(self.outer_radius, "outer_radius", above=0)
        _set(self, outer_radius=outer)
        _set(self, inner_radius=_check.number(self.inner_radius, "inner_radius", above=0, below=outer))

    @property
    def area(self) -> float:
        """Area [m^2]."""
        return math.pi * (self.outer_radius**2 - self.inner_radius**2)

    @property
    def second_moments(self) -> tuple[float, float]:
        """Second moments of area (I_y, I_z) [m^4]."""
        i = math.pi * (self.outer_radius**4 - self.inner_radius**4) / 4.0
        return i, i

    @property
    def torsion_constant(self) -> float:
        """Torsion constant [m^4]."""
        return 2.0 * self.second_moments[0]

    def _shear_corrections(self, poisson_ratio: float) -> tuple[float, float]:
        nu, m = poisson_ratio, (self.inner_radius / self.outer_radius) ** 2
        k = 6.0 * (1 + nu) * (1 + m) ** 2 / ((7 + 6 * nu) * (1 + m) ** 2 + (20 + 12 * nu) * m)
        return k, k

    def _outline(self) -> FloatArray:
        return _ring(self.outer_radius)

    def _points(self) -> FloatArray:
        return _polar_points(self.outer_radius, self.inner_radius)

    @property
    def radius(self) -> float:
        """Radius for contact and pictures [m]."""
        return self.outer_radius


@dataclass(frozen=True)
class Rectangle(_Shape):
    """Rectangle.

    Parameters
    ----------
    width, height : float
        Edges [m], above 0; the height lies along ``up``.

    Examples
    --------
    >>> Rectangle(width=0.02, height=0.01).second_moments[0] < Rectangle(0.02, 0.01).second_moments[1]
    True
    """

    width: float
    height: float

    def __post_init__(self) -> None:
        _set(self, width=_check.number(self.width, "width", above=0))
        _set(self, height=_check.number(self.height, "height", above=0))

    @property
    def area(self) -> float:
        """Area [m^2]."""
        return self.width * self.height

    @property
    def second_moments(self) -> tuple[float, float]:
        """Second moments of area (I_y, I_z) [m^4]."""
        return self.width * self.height**3 / 12.0, self.height * self.width**3 / 12.0

    @property
    def torsion_constant(self) -> float:
        """Saint-Venant's series [m^4]."""
        long, short = max(self.width, self.height), min(self.width, self.height)
        series = sum(math.tanh(k * math.pi * long / (2.0 * short)) / k**5 for k in range(1, 40, 2))
        return long * short**3 / 3.0 * (1.0 - 192.0 * short / (math.pi**5 * long) * series)

    def _shear_corrections(self, poisson_ratio: float) -> tuple[float, float]:
        k = 10.0 * (1.0 + poisson_ratio) / (12.0 + 11.0 * poisson_ratio)
        return k, k

    def _outline(self) -> FloatArray:
        corners = np.array([(1.0, -1.0), (1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0)])
        return corners * (self.width / 2.0, self.height / 2.0)

    def _points(self) -> FloatArray:
        x = np.array([-1.0, 0.0, 1.0]) * math.sqrt(0.6) / 2.0
        weight = np.array([5.0, 8.0, 5.0]) / 18.0
        y, z = np.meshgrid(x * self.width, x * self.height, indexing="ij")
        return np.column_stack([y.ravel(), z.ravel(), np.outer(weight, weight).ravel() * self.area])

    @property
    def radius(self) -> float:
        """Radius for contact and pictures [m]."""
        return min(self.width, self.height) / 2.0


@dataclass(frozen=True)
class Section(_Shape):
    """Any section, by its constants.

    Parameters
    ----------
    area : float
        Area [m^2], above 0.
    second_moments : (float, float)
        Second moments of area (I_y, I_z) [m^4], 0 or more.
    torsion_constant : float, optional
        Torsion constant [m^4], above 0; beams need it.
    radius : float, optional
        Radius for contact and pictures [m], above 0.
    shear_corrections : (float, float)
        Area that carries shear along y and along z over the area, above 0; beams read it.

    Examples
    --------
    >>> Section(area=1e-4, second_moments=(1e-10, 1e-10)).area
    0.0001
    """

    area: float
    second_moments: tuple[float, float]
    torsion_constant: float | None = None
    radius: float | None = None
    shear_corrections: tuple[float, float] = (5.0 / 6.0, 5.0 / 6.0)

    def __post_init__(self) -> None:
        k_y, k_z = _check.array(self.shear_corrections, "shear_corrections", (2,))
        if min(k_y, k_z) <= 0:
            _check.fail("shear_corrections", self.shear_corrections, "must be above 0")
        _set(self, shear_corrections=(float(k_y), float(k_z)))
        moments = _check.array(self.second_moments, "second_moments", (2,))
        if moments.min() < 0:
            _check.fail("second_moments", self.second_moments, "must be 0 or more")
        _set(self, area=_check.number(self.area, "area", above=0))
        _set(self, second_moments=(float(moments[0]), float(moments[1])))
        if self.torsion_constant is not None:
            _set(self, torsion_constant=_check.number(self.torsion_constant, "torsion_constant", above=0))
        if self.radius is not None:
            _set(self, radius=_check.number(self.radius, "radius", above=0))

    def _shear_corrections(self, poisson_ratio: float) -> tuple[float, float]:
        return self.shear_corrections

    def _outline(self) -> FloatArray:
        return _ring(math.sqrt(self.area / math.pi) if self.radius is None else self.radius)

    def _points(self) -> None:
        return None


CrossSection = Circle | Tube | Rectangle | Section
"""Any of the cross sections."""


def require_isotropic(section: object, name: str) -> CrossSection:
    """Return the section if it bends alike about every axis."""
    if not isinstance(section, CrossSection):
        _check.fail(name, section, "must be a section such as pliant.Circle(radius=...)")
    i_y, i_z = section.second_moments
    if abs(i_y - i_z) > 1e-9 * max(i_y, i_z):
        raise ModelError(
            f"{name} = {section!r}: cables bend alike about every axis, but I_y = {i_y:g} and I_z = {i_z:g} "
            "m^4; take Circle, Tube, a square, or Section(area, second_moments=(I, I)) with the moment "
            "of the plane in which the cable bends"
        )
    return section
