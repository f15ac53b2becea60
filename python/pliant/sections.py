"""Cross sections. Section axes: x along the tangent, z nearest to ``up``; I_y is the integral of z^2."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from pliant import _check
from pliant.errors import ModelError

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
        Torsion constant [m^4], above 0.
    radius : float, optional
        Radius for contact and pictures [m], above 0.

    Examples
    --------
    >>> Section(area=1e-4, second_moments=(1e-10, 1e-10)).area
    0.0001
    """

    area: float
    second_moments: tuple[float, float]
    torsion_constant: float | None = None
    radius: float | None = None

    def __post_init__(self) -> None:
        moments = _check.array(self.second_moments, "second_moments", (2,))
        if moments.min() < 0:
            _check.fail("second_moments", self.second_moments, "must be 0 or more")
        _set(self, area=_check.number(self.area, "area", above=0))
        _set(self, second_moments=(float(moments[0]), float(moments[1])))
        if self.torsion_constant is not None:
            _set(self, torsion_constant=_check.number(self.torsion_constant, "torsion_constant", above=0))
        if self.radius is not None:
            _set(self, radius=_check.number(self.radius, "radius", above=0))


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
