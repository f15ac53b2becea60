"""Bodies of known shape. Notches are cut on both faces: the neutral axis stays straight."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from pliant import _check
from pliant.errors import ModelError
from pliant.sdi.body import Body, Notch
from pliant.sdi.sampling import Along, along, positive
from pliant.sdi.sections import Layer, Sections
from pliant.typing import ArrayLike, FloatArray

__all__ = [
    "bump",
    "cone",
    "cosine_notch",
    "cosine_taper",
    "elliptic_notch",
    "exponential",
    "layered",
    "notches",
    "stepped",
    "uniform",
]

COSINE_COEFFICIENT = 0.267
"""Published equivalent length of a cosine notch over its length."""
ELLIPSE_COEFFICIENT = 0.2
"""The same of an elliptic notch."""


def _strip(height: Along, width: float, youngs_modulus: float, poisson_ratio: float) -> Sections:
    return Sections(
        "rectangle",
        height,
        along(_check.number(width, "width", above=0), "width"),
        along(_check.number(youngs_modulus, "youngs_modulus", above=0), "youngs_modulus"),
        _check.number(poisson_ratio, "poisson_ratio", above=-1, below=0.5),
    )


def _round(diameter: Along, youngs_modulus: float, poisson_ratio: float) -> Sections:
    return Sections(
        "circle",
        diameter,
        diameter,
        along(_check.number(youngs_modulus, "youngs_modulus", above=0), "youngs_modulus"),
        _check.number(poisson_ratio, "poisson_ratio", above=-1, below=0.5),
    )


def _place(center: float | None, extent: float, length: float, name: str) -> float:
    """Return the centre of a notch that lies inside the body."""
    c = 0.5 * length if center is None else _check.number(center, name, above=0, below=length)
    slack = 1e-9 * length
    if c - 0.5 * extent < -slack or c + 0.5 * extent > length + slack:
        raise ModelError(
            f"{name} = {c:g}: a notch of length {extent:g} m there leaves the body, 0 to {length:g} m"
        )
    return c


def cosine_notch(
    length: float,
    height: float,
    width: float,
    notch_length: float,
    notch_height: float,
    youngs_modulus: float,
    *,
    center: float | None = None,
    poisson_ratio: float = 0.3,
) -> Body:
    """Strip with a notch whose depth follows one period of a cosine.

    Parameters
    ----------
    length, height, width : float
        Of the strip [m].
    notch_length : float
        Length of the notch [m].
    notch_height : float
        Height left at its deepest point [m], below ``height``.
    youngs_modulus : float
        [Pa].
    center : float, optional
        Place of the notch [m]; by default half the length.
    poisson_ratio : float
        Poisson's ratio.

    Examples
    --------
    >>> body = cosine_notch(
    ...     length=0.1, height=0.01, width=0.01, notch_length=0.02, notch_height=0.003, youngs_modulus=1e6
    ... )
    >>> print(f"{body.index:.3f}")
    7.240+0.027j
    """
    height = _check.number(height, "height", above=0)
    _check.number(notch_height, "notch_height", above=0, below=height)
    length = _check.number(length, "length", above=0)
    center = _place(center, _check.number(notch_length, "notch_length", above=0), length, "center")
    body = notches(
        length,
        height,
        width,
        [(center, notch_length, notch_height)],
        youngs_modulus,
        poisson_ratio=poisson_ratio,
    )
    body.name = f"cosine notch {1e3 * notch_length:g} mm, {1e3 * notch_height:g} of {1e3 * height:g} mm left"
    return body


def bump(
    length: float,
    height: float,
    width: float,
    bump_length: float,
    bump_height: float,
    youngs_modulus: float,
    *,
    center: float | None = None,
    poisson_ratio: float = 0.3,
) -> Body:
    """Strip with a bump whose height follows one period of a cosine.

    Parameters
    ----------
    length, height, width : float
        Of the strip [m].
    bump_length, bump_height : float
        Length of the bump, and height at its top [m], above ``height``.
    youngs_modulus : float
        [Pa].
    center : float, optional
        Place of the bump [m]; by default half the length.

    Examples
    --------
    >>> print(f"{bump(0.1, 0.006, 0.01, 0.04, 0.01, youngs_modulus=1e6).index:.3f}")
    -6.696+0.216j
    """
    height = _check.number(height, "height", above=0)
    _check.number(bump_height, "bump_height", above=height)
    length = _check.number(length, "length", above=0)
    extent = _check.number(bump_length, "bump_length", above=0)
    center = _place(center, extent, length, "center")
    sections = _strip(_waves(height, [(center, extent, bump_height)]), width, youngs_modulus, poisson_ratio)
    breaks = (center - 0.5 * extent, center + 0.5 * extent)
    return Body.of_sections(length, sections, breakpoints=breaks, notches=(), jumps=(), name="bump")


def _waves(height: float, waves: Sequence[tuple[float, float, float]]) -> Along:
    """Height of a strip with cosine notches or bumps (center, length, height there)."""

    def function(x: FloatArray) -> FloatArray:
        h = np.full(np.shape(x), height)
        for c, w, left in waves:
            t = np.asarray(x) - c
            h = h - np.where(
                np.abs(t) <= 0.5 * w, 0.5 * (height - left) * (1 + np.cos(2 * np.pi * t / w)), 0.0
            )
        return h

    return function


def notches(
    length: float,
    height: float,
    width: float,
    notches: Any,
    youngs_modulus: float,
    *,
    poisson_ratio: float = 0.3,
) -> Body:
    """Strip with several cosine notches.

    Parameters
    ----------
    length, height, width : float
        Of the strip [m].
    notches : array_like, shape (n, 3)
        Centre, length and height left of each [m]; they do not overlap.
    youngs_modulus : float
        [Pa].

    Examples
    --------
    >>> body = notches(0.1, 0.01, 0.01, [(0.03, 0.02, 0.005), (0.07, 0.02, 0.005)], youngs_modulus=1e6)
    >>> print(f"{body.index:.3f}")
    7.678+0.125j
    """
    length = _check.number(length, "length", above=0)
    height = _check.number(height, "height", above=0)
    rows = _check.array(notches, "notches", (None, 3), "must be rows of (center, length, height left) in m")
    rows = rows[np.argsort(rows[:, 0])]
    waves: list[tuple[float, float, float]] = []
    places: list[Notch] = []
    for i, (c, w, left) in enumerate(rows.tolist()):
        _check.number(w, f"notches[{i}] length", above=0)
        _check.number(left, f"notches[{i}] height left", above=0, below=height)
        c = _place(c, w, length, f"notches[{i}] center")
        if places and c - 0.5 * w < places[-1].end - 1e-9 * length:
            raise ModelError(f"notches[{i}]: begins at {c - 0.5 * w:g} m, where the one before has not ended")
        waves.append((c, w, left))
        places.append(Notch(max(0.0, c - 0.5 * w), min(length, c + 0.5 * w), COSINE_COEFFICIENT))
    sections = _strip(_waves(height, waves), width, youngs_modulus, poisson_ratio)
    breaks = tuple(edge for n in places for edge in (n.start, n.end))
    name = f"{len(waves)} cosine notches"
    return Body.of_sections(length, sections, breakpoints=breaks, notches=tuple(places), jumps=(), name=name)


def elliptic_notch(
    length: float,
    height: float,
    width: float,
    semi_axes: ArrayLike,
    notch_height: float,
    youngs_modulus: float,
    *,
    center: float | None = None,
    poisson_ratio: float = 0.3,
) -> Body:
    """Strip with a notch of two quarter ellipses that share the semi-axis across the strip.

    Parameters
    ----------
    length, height, width : float
        Of the strip [m].
    semi_axes : (a1, a2)
        Semi-axes along the strip, towards the clamp and towards the end [m].
    notch_height : float
        Height left at the deepest point [m], below ``height``.
    youngs_modulus : float
        [Pa].
    center : float, optional
        Place of the deepest point [m]; by default half the length.

    Examples
    --------
    >>> body = elliptic_notch(0.1, 0.01, 0.01, (0.01, 0.015), 0.004, youngs_modulus=1e6)
    >>> print(f"{body.index:.3f}")
    4.000+0.064j
    """
    length = _check.number(length, "length", above=0)
    height = _check.number(height, "height", above=0)
    left = _check.number(notch_height, "notch_height", above=0, below=height)
    a1, a2 = (float(a) for a in _check.array(semi_axes, "semi_axes", (2,)))
    if min(a1, a2) <= 0:
        _check.fail("semi_axes", semi_axes, "must be above 0")
    center = 0.5 * length if center is None else _check.number(center, "center", above=0, below=length)
    start, end = center - a1, center + a2
    if start < -1e-9 * length or end > length * (1 + 1e-9):
        raise ModelError(f"center = {center:g}: a notch from {start:g} to {end:g} m leaves the body")

    def outline(x: FloatArray) -> FloatArray:
        t = np.asarray(x) - center
        u = np.where(t < 0, -t / a1, t / a2)
        return np.asarray(height - (height - left) * np.sqrt(np.clip(1 - u**2, 0.0, None)))

    sections = _strip(outline, width, youngs_modulus, poisson_ratio)
    return Body.of_sections(
        length,
        sections,
        breakpoints=(start, center, end),
        notches=(Notch(max(0.0, start), min(length, end), ELLIPSE_COEFFICIENT),),
        jumps=(),
        name=f"elliptic notch {1e3 * a1:g} + {1e3 * a2:g} mm",
    )


def cosine_taper(
    length: float,
    start_height: float,
    end_height: float,
    width: float,
    youngs_modulus: float,
    *,
    poisson_ratio: float = 0.3,
) -> Body:
    """Strip whose height goes from start to end along half a period of a cosine.

    Parameters
    ----------
    length, start_height, end_height, width : float
        Of the strip [m].
    youngs_modulus : float
        [Pa].

    Examples
    --------
    >>> print(f"{cosine_taper(0.1, 0.01, 0.006, 0.01, youngs_modulus=1e6).index:.3f}")
    -2.678+0.216j
    """
    length = _check.number(length, "length", above=0)
    a = _check.number(start_height, "start_height", above=0)
    b = _check.number(end_height, "end_height", above=0)
    sections = _strip(
        lambda x: 0.5 * (a + b) + 0.5 * (a - b) * np.cos(np.pi * np.asarray(x) / length),
        width,
        youngs_modulus,
        poisson_ratio,
    )
    return Body.of_sections(length, sections, notches=(), jumps=(), name="cosine taper")


def cone(
    length: float,
    start_diameter: float,
    end_diameter: float,
    youngs_modulus: float,
    *,
    poisson_ratio: float = 0.3,
) -> Body:
    """Cone of circular cross section.

    Parameters
    ----------
    length, start_diameter, end_diameter : float
        [m].
    youngs_modulus : float
        [Pa].

    Examples
    --------
    >>> print(f"{cone(0.2, 0.03, 0.015, youngs_modulus=1e6).index:.4f}")
    1.0000+0.0625j
    """
    length = _check.number(length, "length", above=0)
    a = _check.number(start_diameter, "start_diameter", above=0)
    b = _check.number(end_diameter, "end_diameter", above=0)
    sections = _round(lambda x: a + (b - a) * np.asarray(x) / length, youngs_modulus, poisson_ratio)
    return Body.of_sections(length, sections, notches=(), jumps=(), name=f"cone to {b / a:.3g}")


def exponential(
    length: float,
    start_diameter: float,
    end_diameter: float,
    youngs_modulus: float,
    *,
    poisson_ratio: float = 0.3,
) -> Body:
    """Body of circular cross section whose diameter changes exponentially.

    Parameters
    ----------
    length, start_diameter, end_diameter : float
        [m].
    youngs_modulus : float
        [Pa].

    Examples
    --------
    >>> print(f"{exponential(0.2, 0.03, 0.01, youngs_modulus=1e6).index:.4f}")
    1.0000+0.0123j
    """
    length = _check.number(length, "length", above=0)
    a = _check.number(start_diameter, "start_diameter", above=0)
    b = _check.number(end_diameter, "end_diameter", above=0)
    rate = np.log(b / a) / length
    sections = _round(lambda x: a * np.exp(rate * np.asarray(x)), youngs_modulus, poisson_ratio)
    return Body.of_sections(length, sections, notches=(), jumps=(), name=f"exponential to {b / a:.3g}")


def uniform(
    length: float, height: float, width: float, youngs_modulus: float, *, poisson_ratio: float = 0.3
) -> Body:
    """Strip of one cross section.

    Parameters
    ----------
    length, height, width : float
        [m].
    youngs_modulus : float
        [Pa].

    Examples
    --------
    >>> uniform(0.1, 0.01, 0.01, youngs_modulus=1e6).index
    1j
    """
    height = _check.number(height, "height", above=0)
    sections = _strip(along(height, "height"), width, youngs_modulus, poisson_ratio)
    return Body.of_sections(length, sections, notches=(), jumps=(), name="uniform")


def stepped(
    lengths: ArrayLike,
    diameters: ArrayLike | None = None,
    youngs_modulus: Any = None,
    *,
    heights: ArrayLike | None = None,
    width: float | None = None,
    poisson_ratio: float = 0.3,
) -> Body:
    """Body of pieces, each of one diameter or height and one modulus.

    Parameters
    ----------
    lengths : array_like, shape (n,)
        Lengths of the pieces from the clamp on [m].
    diameters : array_like, shape (n,), optional
        Diameters of circular pieces [m].
    youngs_modulus : float or array_like, shape (n,)
        One, or one for each piece [Pa].
    heights : array_like, shape (n,), optional
        Heights of rectangular pieces [m], with ``width``, instead of ``diameters``.
    width : float, optional
        [m].

    Notes
    -----
    The stiffness jumps; its index is that of a profile whose steps are blended over L/50, and reading it
    warns.

    Examples
    --------
    >>> link = stepped((0.03, 0.02, 0.05), (0.01, 0.004, 0.01), youngs_modulus=1e6)
    >>> link.jumps
    (0.03, 0.05)
    """
    pieces = _check.array(lengths, "lengths", (None,))
    if len(pieces) == 0 or pieces.min() <= 0:
        _check.fail("lengths", lengths, "must be one or more lengths above 0")
    if (diameters is None) == (heights is None):
        raise ModelError("diameters, heights: give one of them")
    if (heights is None) != (width is None):
        raise ModelError("width: goes with heights")
    sizes = _check.array(
        heights if diameters is None else diameters,
        "heights" if diameters is None else "diameters",
        (len(pieces),),
    )
    if np.ndim(youngs_modulus) == 0:
        moduli = np.full(len(pieces), _check.number(youngs_modulus, "youngs_modulus", above=0))
    else:
        moduli = _check.array(youngs_modulus, "youngs_modulus", (len(pieces),))
        if moduli.min() <= 0:
            _check.fail("youngs_modulus", youngs_modulus, "must be above 0")
    if sizes.min() <= 0:
        _check.fail("heights" if diameters is None else "diameters", sizes, "must be above 0")
    edges = np.concatenate([[0.0], np.cumsum(pieces)])
    steps = edges[1:-1]

    def piecewise(values: FloatArray) -> Along:
        return lambda x: values[np.searchsorted(steps, x, side="right")]

    nu = _check.number(poisson_ratio, "poisson_ratio", above=-1, below=0.5)
    if diameters is not None:
        sections = Sections("circle", piecewise(sizes), piecewise(sizes), piecewise(moduli), nu)
    else:
        across = along(_check.number(width, "width", above=0), "width")
        sections = Sections("rectangle", piecewise(sizes), across, piecewise(moduli), nu)
    k = sections.bending_stiffness(0.5 * (edges[:-1] + edges[1:]))
    soft = tuple(
        Notch(float(edges[i]), float(edges[i + 1]))
        for i in range(1, len(k) - 1)
        if k[i] < k[i - 1] and k[i] < k[i + 1]
    )
    jumps = tuple(float(s) for i, s in enumerate(steps) if abs(k[i] - k[i + 1]) > 1e-9 * k[i])
    breaks = tuple(float(s) for s in steps)
    return Body.of_sections(
        float(edges[-1]), sections, breakpoints=breaks, notches=soft, jumps=jumps, name="stepped"
    )


def layered(
    length: float,
    width: float,
    layers: Sequence[tuple[Any, float]],
    *,
    poisson_ratio: float = 0.3,
    breakpoints: ArrayLike = (),
) -> Body:
    """Strip of several materials, one upon the other, by the transformed section.

    Parameters
    ----------
    length, width : float
        [m].
    layers : sequence of (height, youngs_modulus)
        From the bottom: height [m], a number or a callable of arc length, and Young's modulus [Pa].
    poisson_ratio : float
        Of all layers.
    breakpoints : array_like, optional
        Places where a height or its slope jumps [m].

    Notes
    -----
    E I = sum E_i (I_i + A_i (y_i - y)^2) about the neutral axis y = sum E_i A_i y_i / sum E_i A_i. The body
    is built around its neutral axis, which is straight.

    Examples
    --------
    >>> body = layered(0.1, 0.01, [(0.004, 1e6), (0.002, 5e6)])
    >>> round(float(body.stiffness(0.0)), 9), round(float(body.sections.neutral_axis(np.array(0.0))), 6)
    (0.00034381, 0.004143)
    """
    length = _check.number(length, "length", above=0)
    across = along(_check.number(width, "width", above=0), "width")
    if not isinstance(layers, (list, tuple)) or len(layers) == 0:
        _check.fail("layers", layers, "must be a list of (height, youngs_modulus)")
    rows = []
    for i, row in enumerate(layers):
        if not isinstance(row, (list, tuple)) or len(row) != 2:
            _check.fail(f"layers[{i}]", row, "must be (height, youngs_modulus)")
        height = along(row[0], f"layers[{i}] height")
        positive(height, length, f"layers[{i}] height")
        rows.append(Layer(height, _check.number(row[1], f"layers[{i}] youngs_modulus", above=0)))

    def total(x: FloatArray) -> FloatArray:
        return sum((layer.height(x) for layer in rows), np.zeros(np.shape(x)))

    sections = Sections(
        "rectangle",
        total,
        across,
        along(rows[0].youngs_modulus, "youngs_modulus"),
        _check.number(poisson_ratio, "poisson_ratio", above=-1, below=0.5),
        tuple(rows),
    )
    from pliant.sdi.index import inner_breaks

    breaks = inner_breaks(breakpoints, length)
    return Body.of_sections(length, sections, breakpoints=breaks, name=f"{len(rows)} layers")
