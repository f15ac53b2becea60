"""The error map: bodies in the complex plane of the index, and where each technique is good enough."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from itertools import product
from typing import TYPE_CHECKING, Any

import numpy as np

from pliant import _check
from pliant.errors import ConvergenceError, ModelError
from pliant.progress import progress_bar
from pliant.sdi.body import Body, require_body
from pliant.sdi.shapes import cosine_notch
from pliant.sdi.techniques import TECHNIQUES, bend
from pliant.typing import FloatArray

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["NOTCHED", "ErrorMap", "Region", "error_map", "notched_bodies"]

LEVELS = (0.1, 0.2)


@dataclass(frozen=True)
class Region:
    """Where in the complex plane a technique is good enough: inside or outside of a rectangle.

    Attributes
    ----------
    re, im : (float, float)
        Limits of the real and of the imaginary part; infinite where the bodies set none.
    accuracy : float
        Part of the bodies of the map that it tells right.
    inside : bool
        The technique is good enough inside; False: everywhere else.
    """

    re: tuple[float, float]
    im: tuple[float, float]
    accuracy: float
    inside: bool = True

    def holds(self, index: complex) -> bool:
        """Tell whether the technique is good enough at an index.

        Examples
        --------
        >>> Region(re=(0.0, 3.0), im=(0.0, 0.1), accuracy=1.0).holds(2.4 + 0.03j)
        True
        """
        within = self.re[0] <= index.real <= self.re[1] and self.im[0] <= index.imag <= self.im[1]
        return within == self.inside


ANY = (-np.inf, np.inf)
_STEEP_AND_SOFT = Region(re=(6.598, np.inf), im=(-np.inf, 0.05906), accuracy=0.978, inside=False)
_EVERYWHERE = Region(ANY, ANY, accuracy=1.0)
NOTCHED: dict[tuple[str, float], Region] = {
    ("lumped", 0.1): Region(re=(2.070, np.inf), im=(0.0175, np.inf), accuracy=0.913, inside=False),
    ("lumped", 0.2): Region(re=(2.588, np.inf), im=(0.0175, np.inf), accuracy=0.957, inside=False),
    **{(name, 0.1): _STEEP_AND_SOFT for name in ("constant_curvature", "matrix", "hybrid", "elastica")},
    **{(name, 0.2): _EVERYWHERE for name in ("constant_curvature", "matrix", "hybrid", "elastica")},
}
"""Regions of the techniques with their default options, from 46 strips with a cosine notch, turned by 1 rad
(7 lengths and 7 depths; height a tenth of the length): what the map says without being computed again."""
COVERED = (1.3, 15.5)
"""Real parts of its bodies: outside, the map says nothing about lumped models."""


@dataclass(frozen=True)
class ErrorMap:
    """Errors of techniques over the complex plane.

    Attributes
    ----------
    bodies : tuple of Body
        The bodies that have a reference.
    index : (n,) complex
        Their indices.
    errors : dict of (n,)
        Error of each technique: distance of the end from that of the reference, over the reference's
        displacement. Infinite where a technique cannot.
    regions : dict
        For (technique, level) the best rectangle.
    failed : tuple of str
        Bodies without a reference, and why.
    """

    bodies: tuple[Body, ...]
    index: np.ndarray[Any, np.dtype[np.complex128]]
    errors: dict[str, FloatArray]
    regions: dict[tuple[str, float], Region]
    failed: tuple[str, ...] = ()

    def table(self) -> str:
        """Return the errors as a text table.

        Examples
        --------
        >>> bodies = notched_bodies(lengths=(0.02, 0.06), depths=(0.3,))
        >>> print(error_map(bodies, techniques=("elastica",), progress=False).table())
        body                                           Re      Im elastica
        cosine notch 20 mm, 3 of 10 mm left         7.240   0.027    11.0%
        cosine notch 60 mm, 3 of 10 mm left         2.413   0.027     2.0%
        """
        head = f"{'body':42s} {'Re':>6s} {'Im':>7s} " + " ".join(f"{t:>8s}" for t in self.errors)
        lines = [head]
        for i, body in enumerate(self.bodies):
            values = " ".join(f"{100 * e[i]:{max(8, len(t)) - 1}.1f}%" for t, e in self.errors.items())
            lines.append(f"{body.name:42s} {self.index[i].real:6.3f} {self.index[i].imag:7.3f} {values}")
        return "\n".join(lines)

    def only(self, labels: Sequence[str]) -> ErrorMap:
        """Return the map of some of its techniques.

        Examples
        --------
        >>> bodies = notched_bodies(lengths=(0.06,), depths=(0.3,))
        >>> list(error_map(bodies, progress=False).only(["elastica"]).errors)
        ['elastica']
        """
        errors = {label: self.errors[label] for label in labels}
        regions = {key: region for key, region in self.regions.items() if key[0] in errors}
        return replace(self, errors=errors, regions=regions)

    def plot(self, together: bool = False) -> Figure:
        """Draw the complex plane with the regions of each technique, or of all together (matplotlib)."""
        from pliant.sdi.plots import plot_map

        return plot_map(self, together)


def notched_bodies(
    lengths: Iterable[float] = (0.02, 0.03, 0.04, 0.05, 0.06, 0.08, 0.1),
    depths: Iterable[float] = (0.3, 0.45, 0.75),
    *,
    length: float = 0.1,
    height: float = 0.01,
    width: float = 0.01,
    youngs_modulus: float = 1e6,
) -> list[Body]:
    """Make strips with a cosine notch, by default 21.

    Parameters
    ----------
    lengths : iterable of float
        Lengths of the notch [m].
    depths : iterable of float
        Height left over the full one.
    length, height, width, youngs_modulus : float
        Of the strip.

    Examples
    --------
    >>> len(notched_bodies())
    21
    """
    return [
        cosine_notch(length, height, width, w, share * height, youngs_modulus)
        for w, share in product(lengths, depths)
    ]


def error_map(
    bodies: Sequence[Body] | None = None,
    *,
    rotation: float = 1.0,
    moment: float | None = None,
    techniques: Sequence[str] = ("lumped", "matrix", "elastica"),
    options: dict[str, dict[str, Any]] | None = None,
    reference: str = "finite_element",
    levels: Sequence[float] = LEVELS,
    progress: bool | None = None,
) -> ErrorMap:
    """Compute the errors of techniques on many bodies and the rectangles where they are good enough.

    Parameters
    ----------
    bodies : sequence of Body, optional
        By default :func:`notched_bodies`.
    rotation : float
        Each body gets the end moment that turns its elastica by so much [rad].
    moment : float, optional
        One end moment for all bodies instead [N m].
    techniques : sequence of str
        Which are compared. A technique may come with a label: ``"matrix paper"`` is ``"matrix"`` with the
        options of that label.
    options : dict, optional
        Options of a technique or a label: ``{"matrix paper": {"variant": "paper"}}``.
    reference : str
        Technique that errors are measured against; round bodies take ``dimension=3``.
    levels : sequence of float
        Errors that are good enough.
    progress : bool, optional
        Show a progress bar; by default on a terminal.

    Returns
    -------
    ErrorMap
        With ``plot()`` and ``table()``.

    Examples
    --------
    >>> bodies = notched_bodies(lengths=(0.03, 0.06), depths=(0.3, 0.75))
    >>> found = error_map(bodies, techniques=("lumped", "elastica"), progress=False)
    >>> [bool(good) for good in found.errors["elastica"] < 0.1]
    [True, True, True, True]
    """
    given = notched_bodies() if bodies is None else [require_body(b) for b in bodies]
    if not given:
        _check.fail("bodies", bodies, "must not be empty")
    rotation = _check.number(rotation, "rotation", above=0)
    options = options or {}
    for label in techniques:
        _check.choice(str(label).split(" ")[0], "techniques", TECHNIQUES)
    limits = [_check.number(level, "levels", above=0) for level in levels]
    kept: list[Body] = []
    failed: list[str] = []
    errors: dict[str, list[float]] = {label: [] for label in techniques}
    with progress_bar(progress, len(given)) as advance:
        for body in given:
            load = rotation / bend(body, moment=1.0).tip_angle if moment is None else moment
            extra = dict(options.get(reference, {}))
            if (
                reference == "finite_element"
                and body.sections is not None
                and body.sections.shape == "circle"
            ):
                extra.setdefault("dimension", 3)
            try:
                truth = bend(body, moment=load, technique=reference, **extra)
            except ConvergenceError as error:
                failed.append(f"{body.name}: {error}")
                advance(1)
                continue
            kept.append(body)
            for label in techniques:
                try:
                    shape = bend(body, moment=load, technique=label.split(" ")[0], **options.get(label, {}))
                    errors[label].append(shape.error(truth))
                except (ModelError, ConvergenceError):
                    errors[label].append(float("inf"))
            advance(1)
    index = np.array([body.index for body in kept])
    found = {label: np.array(values) for label, values in errors.items()}
    regions = {
        (label, level): best_rectangle(index, values < level)
        for label, values in found.items()
        for level in limits
        if len(values)
    }
    return ErrorMap(tuple(kept), index, found, regions, tuple(failed))


def best_rectangle(index: Any, good: Any) -> Region:
    """Return the rectangle, or what is outside of one, that tells most bodies right, the largest of equals.

    Examples
    --------
    >>> best_rectangle(np.array([1 + 0.1j, 2 + 0.1j, 5 + 0.1j]), np.array([True, True, False])).re
    (-inf, 3.5)
    """
    index, good = np.asarray(index), np.asarray(good, dtype=bool)
    inside = _rectangle(index, good)
    if good.all() or not good.any():
        return inside
    around = _rectangle(index, ~good, prefer=-1e-6)
    if around.accuracy <= inside.accuracy + 1e-9:
        return inside
    region = Region(around.re, around.im, around.accuracy, inside=False)
    # Where no body contradicts, what is bad stays bad.
    for re, im in (
        ((region.re[0], np.inf), region.im),
        ((-np.inf, region.re[1]), region.im),
        (region.re, (region.im[0], np.inf)),
        (region.re, (-np.inf, region.im[1])),
    ):
        wider = Region(re, im, region.accuracy, inside=False)
        if np.mean([wider.holds(z) == g for z, g in zip(index, good, strict=True)]) >= region.accuracy:
            region = wider
            break
    return region


def _rectangle(index: Any, good: Any, prefer: float = 1e-6) -> Region:
    """Return the best rectangle around the good, of equals the largest (or the smallest)."""
    if not good.any():
        return Region((np.inf, -np.inf), (np.inf, -np.inf), 1.0)

    def cuts(values: FloatArray) -> FloatArray:
        unique = np.unique(np.round(values, 9))
        return np.concatenate([[-np.inf], 0.5 * (unique[:-1] + unique[1:]), [np.inf]])

    re, im = cuts(index.real), cuts(index.imag)
    x, y = np.searchsorted(re, index.real) - 1, np.searchsorted(im, index.imag) - 1
    # Right answers of a rectangle: the good inside and the bad outside, from two-dimensional running sums.
    score = np.zeros((len(re) - 1, len(im) - 1))
    np.add.at(score, (x, y), np.where(good, 1.0, -1.0))
    sums = np.zeros((len(re), len(im)))
    sums[1:, 1:] = score.cumsum(axis=0).cumsum(axis=1)
    best, corners = -np.inf, (0, 0, 0, 0)
    for a, b in product(range(len(re) - 1), range(1, len(re))):
        if a >= b:
            continue
        strip = sums[b] - sums[a]
        gain = strip[None, :] - strip[:, None]
        below, above = np.triu_indices(len(im), 1)
        size = gain[below, above] + prefer * (b - a) * (above - below)
        i = int(np.argmax(size))
        if size[i] > best:
            best, corners = float(size[i]), (a, b, int(below[i]), int(above[i]))
    a, b, c, d = corners
    region = Region((float(re[a]), float(re[b])), (float(im[c]), float(im[d])), 0.0)
    right = np.mean([region.holds(z) == g for z, g in zip(index, good, strict=True)])
    return Region(region.re, region.im, float(right))
