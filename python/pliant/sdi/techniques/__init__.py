"""Techniques that bend a body, behind one call. One file a technique; ``TECHNIQUES`` lists them."""

from __future__ import annotations

import importlib
import inspect
import time
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from pliant import _check
from pliant.errors import ModelError
from pliant.sdi.body import Body, require_body
from pliant.typing import ArrayLike, FloatArray

__all__ = ["TECHNIQUES", "Loading", "Shape", "bend", "options_of"]

TECHNIQUES = {
    "lumped": "one spring a notch, rigid in between",
    "constant_curvature": "a chain of arcs",
    "matrix": "a chain of beam elements whose frames turn with them",
    "hybrid": "an elastica whose notches are lumped",
    "elastica": "a line whose curvature is M/(EI)",
    "ancf": "cubic elements of the library's engine, finer where the stiffness changes",
    "finite_element": "a solid, plane or in space",
}
"""Techniques by name, about in the order of their cost."""


@dataclass(frozen=True)
class Loading:
    """Loads on the free end: they keep their direction.

    Attributes
    ----------
    moment : float
        About the axis across the plane, turning x to y [N m].
    force : (float, float)
        Along x and y [N].
    """

    moment: float
    force: tuple[float, float]


@dataclass(frozen=True)
class Shape:
    """A bent body.

    Attributes
    ----------
    x, y, angle : (n,)
        Points of the neutral axis from the clamp to the end [m], and the slope there [rad].
    technique : str
        Which made it.
    parameters : int
        Number of unknowns that the technique solves for.
    seconds : float
        Time it took.
    details : dict
        What the technique tells besides.
    """

    x: FloatArray
    y: FloatArray
    angle: FloatArray
    technique: str
    parameters: int
    seconds: float = 0.0
    details: dict[str, Any] = field(default_factory=dict)

    @property
    def tip(self) -> tuple[float, float]:
        """Place of the free end [m]."""
        return float(self.x[-1]), float(self.y[-1])

    @property
    def tip_angle(self) -> float:
        """Slope of the free end [rad]."""
        return float(self.angle[-1])

    def error(self, reference: Shape) -> float:
        """Distance of the end from that of a reference, relative to the reference's displacement.

        Examples
        --------
        >>> import pliant as pl
        >>> body = pl.sdi.uniform(0.1, 0.01, 0.01, youngs_modulus=1e6)
        >>> exact = pl.sdi.bend(body, moment=0.01)
        >>> exact.error(exact)
        0.0
        """
        moved = np.hypot(reference.x[-1] - reference.details["length"], reference.y[-1])
        off = np.hypot(self.x[-1] - reference.x[-1], self.y[-1] - reference.y[-1])
        return float(off / moved)


def loading(moment: Any, force: Any) -> Loading:
    """Check the loads of a call."""
    if moment is None and force is None:
        raise ModelError("moment, force: give one of them, or both")
    m = 0.0 if moment is None else _check.number(moment, "moment")
    f = np.zeros(2) if force is None else _check.array(force, "force", (2,), "must be two finite numbers")
    return Loading(m, (float(f[0]), float(f[1])))


def options_of(technique: str) -> list[str]:
    """Name the options of a technique.

    Examples
    --------
    >>> options_of("lumped")
    ['variant', 'coefficient', 'flexure', 'equilibrium']
    """
    name = _check.choice(technique, "technique", TECHNIQUES)
    solve = importlib.import_module(f"pliant.sdi.techniques.{name}").solve
    return [p.name for p in inspect.signature(solve).parameters.values() if p.kind is p.KEYWORD_ONLY]


def bend(
    body: Body,
    *,
    moment: float | None = None,
    force: ArrayLike | None = None,
    technique: str = "elastica",
    **options: Any,
) -> Shape:
    """Bend a clamped body by loads on its free end.

    Parameters
    ----------
    body : Body
        Clamped at x = 0, straight along x.
    moment : float, optional
        Moment on the end [N m], positive from x to y.
    force : array_like, shape (2,), optional
        Force on the end along x and y [N]; it keeps its direction.
    technique : str
        ``"lumped"``, ``"constant_curvature"``, ``"matrix"``, ``"hybrid"``, ``"elastica"``, ``"ancf"`` or
        ``"finite_element"``.
    **options
        Of the technique:

        - lumped: ``coefficient``, the length of the equivalent flexure over that of its notch, or
          ``"integral"`` (default: that with the compliance of the notch); ``flexure``, how it displaces
          (``"arc"``, ``"chord"``, ``"pivot"``); ``equilibrium=False`` for moments of the undeformed body;
          ``variant="paper"``: as published.
        - constant_curvature: ``segments=6``, ``sampling``.
        - matrix: ``elements=6``, ``steps=100``, ``sampling`` of the stiffness of an element (``"harmonic"``,
          ``"mid"``, ``"mean"``, or ``"exact"``: that of the tapered element), ``geometric=True``,
          ``shear=False``, ``nodes``; ``variant="paper"``: as published, without geometric terms and with the
          stiffness in mid-element.
        - hybrid: ``coefficient``.
        - elastica: ``panels=12`` a smooth piece, ``shear=False``.
        - ancf: ``elements=24``, ``graded=True``, ``load_steps``.
        - finite_element: ``dimension=2`` (plane stress) or 3, ``elements`` along, across (and over half the
          width), ``steps``, ``tolerance``.

    Returns
    -------
    Shape
        With ``x``, ``y``, ``angle``, ``tip``, ``seconds`` and ``parameters``.

    Raises
    ------
    ConvergenceError
        Where the technique finds no equilibrium.

    Examples
    --------
    >>> import pliant as pl
    >>> body = pl.sdi.cosine_notch(0.1, 0.01, 0.01, 0.02, 0.006, youngs_modulus=1e6)
    >>> [round(pl.sdi.bend(body, moment=6e-3, technique=name).tip[1], 4) for name in ("lumped", "elastica")]
    [0.0167, 0.0423]
    """
    body = require_body(body)
    name = _check.choice(technique, "technique", TECHNIQUES)
    load = loading(moment, force)
    allowed = options_of(name)
    for option, value in options.items():
        if option not in allowed:
            _check.fail(option, value, f'is no option of "{name}"; it has {", ".join(allowed)}')
    solve = importlib.import_module(f"pliant.sdi.techniques.{name}").solve
    before = time.perf_counter()
    x, y, angle, parameters, details = solve(body, load, **options)
    seconds = time.perf_counter() - before
    details = {"length": body.length, **details}
    return Shape(np.asarray(x), np.asarray(y), np.asarray(angle), name, int(parameters), seconds, details)
