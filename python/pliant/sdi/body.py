"""A soft body: a bending stiffness over a length, and the cross sections behind it where they are known."""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from pliant import _check
from pliant.errors import ModelError
from pliant.sdi import index as _index
from pliant.sdi.index import BLEND, Distribution, Feature
from pliant.sdi.sampling import Along, Samples, along, find_jumps, positive, sample
from pliant.sdi.sections import Sections
from pliant.typing import ArrayLike, FloatArray

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from pliant.model import Model
    from pliant.points import Cable

__all__ = ["Body", "Notch", "features", "require_body"]

SLENDERNESS = 20.0
"""Length over height of the rectangle that stands in where a body's cross sections are not known."""
SAME = 1e-9
"""Breaks nearer than this are one [L]."""
SHALLOW = 0.98
"""A dip of the stiffness to less than this part of its surroundings is a notch."""


@dataclass(frozen=True)
class Notch:
    """Where a body is weakened: what a lumped model replaces by a spring.

    Attributes
    ----------
    start, end : float
        From where to where [m].
    coefficient : float or None
        Length of the equivalent flexure over that of the notch, where one is published for its shape.
    """

    start: float
    end: float
    coefficient: float | None = None


class Body:
    """A slender body that bends in a plane, clamped at x = 0.

    Parameters
    ----------
    length : float
        Length [m].
    stiffness : callable
        Bending stiffness E I over the arc length [N m^2]: a function of one number or of arrays.
    breakpoints : array_like, optional
        Places where the stiffness or its slope jumps [m]; jumps of the stiffness are also found by
        themselves.
    notches : sequence of (start, end), optional
        Where a lumped model puts its springs [m]; by default the dips of the stiffness.
    height : float or callable, optional
        Height of the cross section in the plane of bending [m], taken as rectangular; with ``youngs_modulus``
        it makes the body ready for finite elements (the width follows from the stiffness).
    youngs_modulus : float, optional
        Young's modulus [Pa].
    poisson_ratio : float
        Poisson's ratio.
    name : str
        What pictures and tables call it.

    Examples
    --------
    >>> body = Body(0.1, stiffness=lambda x: 1e-3 * (1 - 0.9 * np.sin(np.pi * x / 0.1) ** 2))
    >>> body.index
    (2.0+0.1j)
    """

    def __init__(
        self,
        length: float,
        stiffness: Any,
        *,
        breakpoints: ArrayLike = (),
        notches: Any = None,
        height: Any = None,
        youngs_modulus: float | None = None,
        poisson_ratio: float = 0.3,
        name: str = "body",
    ) -> None:
        length = _check.number(length, "length", above=0)
        if not callable(stiffness):
            _check.fail("stiffness", stiffness, "must be a callable of arc length; see pliant.sdi.uniform")
        if (height is None) != (youngs_modulus is None):
            raise ModelError("height, youngs_modulus: give both or none of them")
        k = along(stiffness, "stiffness")
        sections = None
        breaks = _index.inner_breaks(breakpoints, length)
        if height is not None:
            h = along(height, "height")
            positive(h, length, "height", breaks)
            E = _check.number(youngs_modulus, "youngs_modulus", above=0)
            sections = Sections(
                "rectangle",
                h,
                lambda x: 12.0 * k(x) / (E * h(x) ** 3),
                along(E, "youngs_modulus"),
                _check.number(poisson_ratio, "poisson_ratio", above=-1, below=0.5),
            )
        found = None if notches is None else tuple(_notch(n, i, length) for i, n in enumerate(notches))
        self._set(length, k, breaks, sections, found, _check.text(name, "name"))

    def _set(
        self,
        length: float,
        stiffness: Along,
        breaks: tuple[float, ...],
        sections: Sections | None,
        notches: tuple[Notch, ...] | None,
        name: str,
        jumps: tuple[float, ...] | None = None,
    ) -> None:
        positive(stiffness, length, "stiffness", breaks)
        self.length = length
        self.name = name
        self.sections = sections
        self._stiffness = stiffness
        self._notches = notches
        self.jumps = tuple(sorted(set(find_jumps(stiffness, length, breaks)))) if jumps is None else jumps
        # Breaks that coincide but for rounding are one; a jump is kept as it is.
        kept: list[float] = []
        for place in sorted({*breaks, *self.jumps}):
            if not SAME * length < place < (1.0 - SAME) * length:
                continue
            if kept and place - kept[-1] < SAME * length:
                if place in self.jumps:
                    kept[-1] = place
            else:
                kept.append(place)
        self.breakpoints = tuple(kept)

    @classmethod
    def of_sections(
        cls,
        length: float,
        sections: Sections,
        *,
        breakpoints: tuple[float, ...] = (),
        notches: tuple[Notch, ...] | None = None,
        jumps: tuple[float, ...] | None = None,
        name: str = "body",
    ) -> Body:
        """Make a body of its cross sections; None leaves notches and jumps to be found.

        Examples
        --------
        >>> same = lambda value: lambda x: np.full(np.shape(x), value)
        >>> strip = Sections("rectangle", same(0.01), same(0.02), same(1e6), 0.3)
        >>> round(float(Body.of_sections(0.1, strip).stiffness(0.05)), 6)
        0.001667
        """
        length = _check.number(length, "length", above=0)
        breaks = tuple(sorted(p for p in set(breakpoints) if 0 < p < length))
        positive(sections.height, length, "height", breaks)
        positive(sections.width, length, "width", breaks)
        body = cls.__new__(cls)
        body._set(length, sections.bending_stiffness, breaks, sections, notches, name, jumps)
        return body

    @classmethod
    def from_samples(
        cls,
        x: ArrayLike,
        k: ArrayLike,
        smooth: int | bool | None = None,
        *,
        breakpoints: ArrayLike = (),
        notches: Any = None,
        height: Any = None,
        youngs_modulus: float | None = None,
        poisson_ratio: float = 0.3,
        name: str = "samples",
    ) -> Body:
        """Make a body of samples of its stiffness.

        Parameters
        ----------
        x, k : array_like, shape (n,)
            Places from the clamp to the end [m], ascending, and the bending stiffness there [N m^2].
        smooth : int or bool, optional
            Window of a cubic Savitzky-Golay filter, an odd number of samples; True: a tenth of the samples.
        breakpoints : array_like, optional
            Places where the stiffness or its slope jumps [m].
        notches : sequence of (start, end), optional
            Where a lumped model puts its springs [m].
        height, youngs_modulus, poisson_ratio
            As for :class:`Body`.

        Examples
        --------
        >>> x = np.linspace(0, 0.1, 101)
        >>> Body.from_samples(x, 1e-3 * (1 + x)).index.real
        0.0
        """
        function, length, breaks = _index.sampled_function(x, k, smooth, breakpoints)
        return cls(
            length,
            function,
            breakpoints=breaks,
            notches=notches,
            height=height,
            youngs_modulus=youngs_modulus,
            poisson_ratio=poisson_ratio,
            name=name,
        )

    def __repr__(self) -> str:
        return f"Body({self.name!r}, length={self.length:g}, index={self.index:.4g})"

    # The stiffness

    def stiffness(self, x: ArrayLike) -> FloatArray:
        """Bending stiffness E I [N m^2] at places [m], of their shape."""
        return self._stiffness(np.asarray(x, dtype=np.float64))

    def axial_stiffness(self, x: ArrayLike) -> FloatArray:
        """Axial stiffness E A [N]; without known cross sections, that of a rectangle of height L/20."""
        places = np.asarray(x, dtype=np.float64)
        if self.sections is None:
            return self._stiffness(places) * (12.0 * (SLENDERNESS / self.length) ** 2)
        return self.sections.axial_stiffness(places)

    def half_height(self, x: ArrayLike) -> FloatArray:
        """Distance of the outermost fibre from the neutral axis [m]."""
        places = np.asarray(x, dtype=np.float64)
        if self.sections is None:
            return np.full(places.shape, 0.5 * self.length / SLENDERNESS)
        axis = self.sections.neutral_axis(places)
        return np.maximum(axis, self.sections.height(places) - axis)

    @cached_property
    def samples(self) -> Samples:
        """Fine samples of the stiffness as it is, steps included."""
        return sample(self._stiffness, self.length, self.breakpoints)

    # The index

    @cached_property
    def index(self) -> complex:
        """Softness distribution index L / (x_M - x_m) + i k_min / k_max.

        Warns with :class:`ProfileWarning` where the stiffness jumps: the index is then that of the blended
        profile.
        """
        if self.jumps:
            _index.warn_of_jumps(self.jumps, self._blend[1])
        return self.distribution.index

    @cached_property
    def distribution(self) -> Distribution:
        """Stiffness and slope along the body, and where they are extreme; jumps are blended over L/50."""
        return _index.distribution(self._blend[0], self.length)

    @cached_property
    def _blend(self) -> tuple[Samples, float]:
        if not self.jumps:
            return self.samples, 0.0
        # A step of a diameter is blended in the diameter; one of the material, in the stiffness.
        power = 1.0
        if self.sections is not None and not self.sections.layers:
            inside = 1e-9 * self.length
            h = [self.sections.height(np.array([j - inside, j + inside])) for j in self.jumps]
            power = self.sections.power if any(abs(a - b) > 1e-9 * a for a, b in h) else 1.0
        function, more, width = _index.blended(
            self._stiffness, self.length, self.jumps, BLEND * self.length, power
        )
        breaks = tuple(sorted({*self.breakpoints, *more} - set(self.jumps)))
        return sample(function, self.length, breaks), width

    @cached_property
    def notches(self) -> tuple[Notch, ...]:
        """Where a lumped model puts its springs."""
        if self._notches is not None:
            return self._notches
        x, k = self.samples.x, self.samples.value
        found = []
        minima = _index._minima(k, 1e-9 * float(k.max()))
        if not minima:
            return ()
        walls = [
            0,
            *(a + int(np.argmax(k[a:b])) for a, b in itertools.pairwise(minima)),
            len(k),
        ]
        for i, left, right in zip(minima, walls[:-1], walls[1:], strict=True):
            before, behind = k[left : i + 1], k[i:right]
            if k[i] >= SHALLOW * min(before.max(), behind.max()):
                continue
            start = left + int(np.flatnonzero(before >= SHALLOW * before.max())[-1])
            end = i + int(np.flatnonzero(behind >= SHALLOW * behind.max())[0])
            found.append(Notch(float(x[start]), float(x[end])))
        return tuple(found)

    # Use

    def add_to(
        self,
        model: Model,
        *,
        technique: str = "ancf",
        elements: int | None = None,
        start: ArrayLike = (0.0, 0.0, 0.0),
        direction: ArrayLike = (1.0, 0.0, 0.0),
        up: ArrayLike = (0.0, 0.0, 1.0),
        density: float = 1000.0,
        retardation_time: float = 0.0,
        name: str | None = None,
    ) -> Cable:
        """Add the body to a model, with its varying section.

        Parameters
        ----------
        model : Model
            The model.
        technique : {"ancf"}
            ``"ancf"``: a cable, with the bending stiffness about the notch axis in both planes. ``"rod"``,
            which would keep both, is refused: there are no rods.
        elements : int, optional
            Elements, finer where the stiffness changes; by default 24.
        start : array_like, shape (3,)
            Its clamped end [m].
        direction, up : array_like, shape (3,)
            Where the axis and the height of the sections point to.
        density : float
            Mass per volume [kg/m^3].
        retardation_time : float
            Kelvin-Voigt damping [s].

        Returns
        -------
        Cable
            Handle; nothing is clamped.

        Examples
        --------
        >>> import pliant as pl
        >>> model = pl.Model()
        >>> finger = pl.sdi.uniform(0.1, 0.01, 0.01, youngs_modulus=1e6).add_to(model)
        >>> root, tip = model.clamp(finger.start), model.add_moment(finger.end, (0, 0, 1e-3))
        >>> round(float(pl.solve_static(model).track(finger.end).position[-1, 1]), 5)
        0.00599
        """
        from pliant.sdi.techniques.ancf import add_cable

        return add_cable(
            self,
            model,
            technique=technique,
            elements=elements,
            start=start,
            direction=direction,
            up=up,
            density=density,
            retardation_time=retardation_time,
            name=name,
        )

    def plot(self) -> Figure:
        """Draw the outline, the stiffness and its slope with their extremes (matplotlib)."""
        from pliant.sdi.plots import plot_body

        return plot_body(self)


def _notch(value: Any, number: int, length: float) -> Notch:
    if isinstance(value, Notch):
        return value
    a, b = _check.array(value, f"notches[{number}]", (2,), "must be (start, end) in m")
    if not 0 <= a < b <= length:
        _check.fail(f"notches[{number}]", value, f"must be 0 <= start < end <= {length:g}")
    return Notch(float(a), float(b))


def features(body: Body) -> list[Feature]:
    """List the notches of a body, each with its own index.

    With unequal notches the index of the whole body may measure from one to another: this tells them apart.

    Parameters
    ----------
    body : Body
        The body.

    Returns
    -------
    list of Feature
        With ``center``, ``x_m``, ``x_M`` and ``index``; empty where the stiffness has no minimum inside.

    Examples
    --------
    >>> import pliant as pl
    >>> body = pl.sdi.notches(0.1, 0.01, 0.01, [(0.03, 0.02, 0.006), (0.07, 0.02, 0.003)], youngs_modulus=1e6)
    >>> [round(notch.index.imag, 3) for notch in pl.sdi.features(body)]
    [0.216, 0.027]
    """
    body = require_body(body)
    return _index.features(body._blend[0], body.length)


def require_body(body: Any) -> Body:
    """Return ``body`` if it is one."""
    if not isinstance(body, Body):
        _check.fail("body", body, "must be a body such as pliant.sdi.cosine_notch(...) makes")
    return body
