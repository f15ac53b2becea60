"""The softness distribution index of a bending stiffness k(x) over the length L of a body.

    SDI = L / (x_M - x_m) + i k_min / k_max,   x_m = argmin k', x_M = argmax k'

A reconstruction: the equations of the publication are lost, its sentences are not. docs/theory/sdi.md lays
the evidence beside the alternatives; tests/sdi/test_definition.py computes it.
"""

from __future__ import annotations

import itertools
import warnings
from dataclasses import dataclass
from typing import Any

import numpy as np

from pliant import _check
from pliant.errors import ModelError
from pliant.sdi.sampling import Along, Samples, find_jumps, sample
from pliant.typing import ArrayLike, FloatArray

__all__ = ["Distribution", "Feature", "ProfileWarning", "distribution", "softness_index"]

CONSTANT = 1e-7
"""Range of k' below which it counts as constant [k_max / L]."""
TIED = 1e-6
"""Values of k' so near to the extreme one count as equal to it [range of k']."""
PLATEAU = 0.02
"""A run of tied samples shorter than this is an isolated extremum [L]."""
COMPARED = 1e-4
"""Distances of pairs are compared in this unit [L]."""
BLEND = 0.02
"""Default width over which a jump of the stiffness is blended [L]."""
FEWEST = 9
"""Samples of a profile, at least."""


class ProfileWarning(UserWarning):
    """The stiffness is rough or jumps: the index depends on how that was smoothed."""


@dataclass(frozen=True)
class Distribution:
    """How the stiffness is distributed, and the index that follows.

    Attributes
    ----------
    x, stiffness, slope : (n,)
        Fine samples [m], [N m^2], [N m]; steps are blended.
    x_m, x_M : float or None
        Where the slope is smallest and largest, the closest such pair [m]; None where it is constant.
    index : complex
        L / (x_M - x_m) + i k_min / k_max.
    """

    x: FloatArray
    stiffness: FloatArray
    slope: FloatArray
    x_m: float | None
    x_M: float | None  # noqa: N815
    index: complex


@dataclass(frozen=True)
class Feature:
    """One notch of a body: a local minimum of the stiffness between its steepest descent and ascent.

    Attributes
    ----------
    center : float
        Place of the minimum [m].
    x_m, x_M : float
        Steepest descent before it and steepest ascent behind it [m].
    index : complex
        L / (x_M - x_m) + i (stiffness at the minimum) / k_max.
    """

    center: float
    x_m: float
    x_M: float  # noqa: N815
    index: complex


@dataclass(frozen=True)
class _Run:
    """Samples of the slope that are tied for an extreme value."""

    start: float
    end: float


def _runs(samples: Samples, sign: float, length: float) -> list[_Run]:
    """Return the runs where ``sign * slope`` is largest; isolated extrema are refined by a parabola."""
    x, y = samples.x, sign * samples.slope
    span = float(np.ptp(y))
    # Samples beside an isolated extremum miss it by O(h^2): gather with a margin, decide when refined.
    near = y >= y.max() - 100 * TIED * span
    edges = np.flatnonzero(np.diff(np.concatenate([[False], near, [False]]).astype(int)))
    found: list[tuple[_Run, float]] = []
    for a, b in zip(edges[::2], edges[1::2] - 1, strict=True):
        i = a + int(np.argmax(y[a : b + 1]))
        if x[b] - x[a] >= PLATEAU * length:
            tied = a + np.flatnonzero(y[a : b + 1] >= y[i] - TIED * span)
            found.append((_Run(float(x[tied[0]]), float(x[tied[-1]])), float(y[i])))
            continue
        place, value = float(x[i]), float(y[i])
        same = 0 < i < len(x) - 1 and samples.segment[i - 1] == samples.segment[i + 1]
        bend = y[i - 1] - 2 * y[i] + y[i + 1] if same else 0.0
        if bend < 0:
            offset = 0.5 * (y[i - 1] - y[i + 1]) / bend
            value -= 0.25 * (y[i - 1] - y[i + 1]) * offset
            place += offset * (x[i + 1] - x[i])
        found.append((_Run(place, place), value))
    best = max(value for _, value in found)
    return [run for run, value in found if value >= best - TIED * span]


def _closest(descents: list[_Run], ascents: list[_Run], notch: bool, length: float) -> tuple[float, float]:
    """Tie rule: a true notch first, then the closest pair, then the positive sign."""
    pairs: list[tuple[bool, int, bool, float, float]] = []
    for m in descents:
        for M in ascents:
            x_m, x_M = (m.end, M.start) if M.start >= m.end else (m.start, M.end)
            far = round(abs(x_M - x_m) / (COMPARED * length))
            pairs.append((not (notch and x_M > x_m), far, x_M < x_m, x_m, x_M))
    return min(pairs)[3:]


def distribution(samples: Samples, length: float) -> Distribution:
    """Find the steepest descent and ascent of a sampled stiffness, and its index."""
    k, slope = samples.value, samples.slope
    softest = float(k.min() / k.max())
    if np.ptp(slope) <= CONSTANT * k.max() / length:
        return Distribution(samples.x, k, slope, None, None, complex(0.0, softest))
    rounding = TIED * float(np.ptp(slope))
    notch = bool(slope.min() < -rounding and slope.max() > rounding)
    x_m, x_M = _closest(_runs(samples, -1.0, length), _runs(samples, 1.0, length), notch, length)
    return Distribution(samples.x, k, slope, x_m, x_M, complex(length / (x_M - x_m), softest))


def features(samples: Samples, length: float) -> list[Feature]:
    """Return the notches of a sampled stiffness."""
    x, k, slope = samples.x, samples.value, samples.slope
    noise = 1e-9 * k.max()
    inner = _minima(k, noise)
    if not inner:
        return []
    walls = [0, *(a + int(np.argmax(k[a:b])) for a, b in itertools.pairwise(inner)), len(k) - 1]
    found = []
    for i, left, right in zip(inner, walls[:-1], walls[1:], strict=True):
        m = left + int(np.argmin(slope[left : i + 1]))
        M = i + int(np.argmax(slope[i : right + 1]))
        re = length / (x[M] - x[m])
        found.append(Feature(float(x[i]), float(x[m]), float(x[M]), complex(re, k[i] / k.max())))
    return found


def _minima(k: FloatArray, noise: float) -> list[int]:
    """Return the middles of the strict local minima of k inside the body, plateaus included."""
    found, falling, bottom = [], False, 0
    for i in range(1, len(k)):
        if k[i] < k[bottom] - noise:
            falling, bottom = True, i
        elif k[i] > k[bottom] + noise:
            if falling:
                found.append((bottom + i) // 2 if k[bottom:i].max() - k[bottom] < noise else bottom)
            falling, bottom = False, i
    return found


def blended(
    function: Along, length: float, jumps: tuple[float, ...], width: float, power: float
) -> tuple[Along, tuple[float, ...], float]:
    """Replace each jump by a raised cosine in k^(1/power); return function, its breaks and the width used."""
    places = np.array([0.0, *jumps, length])
    width = min(width, 0.999 * float(np.diff(places).min()))
    inside = INSIDE_OF_A_JUMP * length
    sides = [function(np.array([j - inside, j + inside])) ** (1.0 / power) for j in jumps]

    def smooth(x: FloatArray) -> FloatArray:
        y = function(x)
        for j, (before, behind) in zip(jumps, sides, strict=True):
            near = np.abs(x - j) < 0.5 * width
            if near.any():
                u, own = x[near], y[near] ** (1.0 / power)
                left, right = np.where(u < j, own, before), np.where(u < j, behind, own)
                share = 0.5 - 0.5 * np.cos(np.pi * (u - j + 0.5 * width) / width)
                y[near] = (left + (right - left) * share) ** power
        return y

    breaks = tuple(float(j + side * width) for j in jumps for side in (-0.5, 0.5))
    return smooth, breaks, width


INSIDE_OF_A_JUMP = 1e-12
"""Distance from a jump at which its two sides are read [L]."""


def sampled_function(
    x: ArrayLike, k: ArrayLike, smooth: int | bool | None, breakpoints: Any = ()
) -> tuple[Along, float, tuple[float, ...]]:
    """Return a function through samples, its length and breaks: cubic splines between breaks.

    ``smooth`` is the window of a cubic Savitzky-Golay filter, in samples; True takes a tenth of them.
    """
    from scipy.interpolate import CubicSpline
    from scipy.signal import savgol_filter

    places, values = _checked_samples(x, k)
    length = float(places[-1] - places[0])
    places = places - places[0]
    breaks = inner_breaks(breakpoints, length)
    window = _window(smooth, len(places))
    pieces = []
    for a, b in zip((0.0, *breaks), (*breaks, length), strict=True):
        held = (places >= a - 1e-12 * length) & (places <= b + 1e-12 * length)
        u, v = places[held], values[held]
        if len(u) < 4:
            raise ModelError(
                f"breakpoints: only {len(u)} samples from {a:g} to {b:g} m; a piece needs at least 4"
            )
        if window is None:
            _warn_where_rough(u, v)
        else:
            even = np.linspace(u[0], u[-1], len(u))
            size = min(window, (len(u) - 1) | 1 if len(u) % 2 else len(u) - 1)
            v = savgol_filter(np.interp(even, u, v), size, 3) if size > 3 else v
            u = even
        pieces.append(CubicSpline(u, v))

    def function(at: FloatArray) -> FloatArray:
        at = np.asarray(at, dtype=np.float64)
        number = np.searchsorted(np.array(breaks), at, side="right")
        result = np.empty(at.shape)
        for i, piece in enumerate(pieces):
            result[number == i] = piece(at[number == i])
        return result

    fine = function(np.linspace(0.0, length, 4001))
    if fine.min() <= 0:
        raise ModelError(
            f"k: the curve through the samples falls to {fine.min():.3g} between them; give more samples, "
            "name the breakpoints of steps, or smooth"
        )
    return function, length, breaks


def _checked_samples(given_x: ArrayLike, given_k: ArrayLike) -> tuple[FloatArray, FloatArray]:
    """Return samples that ascend and are above 0."""
    x = _check.array(given_x, "x", (None,))
    k = _check.array(given_k, "k", x.shape)
    if len(x) < FEWEST:
        _check.fail("x", x, f"must have at least {FEWEST} samples, not {len(x)}")
    falls = np.flatnonzero(np.diff(x) <= 0)
    if len(falls):
        i = int(falls[0]) + 1
        _check.fail(f"x[{i}]", float(x[i]), f"must be above x[{i - 1}] = {x[i - 1]:g}: sort the samples")
    if k.min() <= 0:
        i = int(np.argmin(k))
        _check.fail(f"k[{i}]", float(k[i]), "must be above 0: a stiffness")
    return x, k


def _window(smooth: Any, samples: int) -> int | None:
    if smooth is None or smooth is False:
        return None
    if smooth is True:
        return max(5, (samples // 10) | 1)
    window = _check.count(smooth, "smooth", at_least=5)
    if window % 2 == 0 or window > samples:
        _check.fail("smooth", smooth, f"must be odd and at most the number of samples, {samples}")
    return window


def _warn_where_rough(x: FloatArray, k: FloatArray) -> None:
    """Warn of noise: second differences that change sign like those of random numbers."""
    slope = np.diff(k) / np.diff(x)
    bend = np.diff(slope)
    noticeable = 1e-6 * max(float(np.ptp(slope)), 1e-3 * float(k.max() / (x[-1] - x[0])))
    bend = bend[np.abs(bend) > noticeable]
    changes = int(np.count_nonzero(bend[1:] * bend[:-1] < 0))
    if len(bend) > 12 and changes > len(bend) / 3:
        warnings.warn(
            f"k: the samples look rough (their curvature changes sign {changes} times in {len(x)} samples); "
            f"their derivative, hence the index, is noise. Give smooth=, for example {(len(x) // 10) | 1}",
            ProfileWarning,
            stacklevel=4,
        )


def inner_breaks(breakpoints: Any, length: float) -> tuple[float, ...]:
    """Return break points as an ascending tuple strictly inside the body."""
    if isinstance(breakpoints, (tuple, list)) and len(breakpoints) == 0:
        return ()
    places = _check.array(breakpoints, "breakpoints", (None,))
    outside = (places <= 0) | (places >= length)
    if outside.any():
        i = int(np.argmax(outside))
        _check.fail(f"breakpoints[{i}]", float(places[i]), f"must lie between 0 and the length {length:g}")
    return tuple(float(p) for p in np.unique(places))


def softness_index(
    x: ArrayLike,
    k: ArrayLike,
    *,
    smooth: int | bool | None = None,
    breakpoints: ArrayLike = (),
) -> complex:
    """Softness distribution index of a sampled bending stiffness.

    Parameters
    ----------
    x : array_like, shape (n,)
        Places along the body [m], ascending, from its clamp to its end; at least 9.
    k : array_like, shape (n,)
        Bending stiffness E I there [N m^2], above 0.
    smooth : int or bool, optional
        Window of a cubic Savitzky-Golay filter, an odd number of samples, for measured data; True takes a
        tenth of the samples. The derivative of rough data is noise, and so is the index.
    breakpoints : array_like, optional
        Places where the slope of k jumps; nothing is differentiated across them.

    Returns
    -------
    complex
        L / (x_M - x_m) + i k_min / k_max, with x_m and x_M where k' is smallest and largest. The real part is
        0 where k' is constant.

    Examples
    --------
    >>> x = np.linspace(0.0, 0.2, 101)
    >>> softness_index(x, 1e-3 * np.exp(-8 * x)).real
    1.0
    """
    function, length, breaks = sampled_function(x, k, smooth, breakpoints)
    jumps = tuple(find_jumps(function, length, breaks)) if breaks else ()
    if jumps:
        function, more, width = blended(function, length, jumps, BLEND * length, 1.0)
        breaks = tuple(sorted({*breaks, *more} - set(jumps)))
        warn_of_jumps(jumps, width)
    return distribution(sample(function, length, breaks), length).index


def warn_of_jumps(jumps: tuple[float, ...], width: float) -> None:
    """Say that the index is that of a blended profile."""
    at = ", ".join(f"{j:.4g}" for j in jumps[:4]) + (", ..." if len(jumps) > 4 else "")
    warnings.warn(
        f"non-smooth: the stiffness jumps at x = {at} m; each jump was blended over {width:.3g} m, "
        "and the real part of the index depends on that width",
        ProfileWarning,
        stacklevel=3,
    )
