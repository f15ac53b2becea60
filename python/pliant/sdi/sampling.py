"""Functions along the axis of a body: as the user gives them, where they jump, and fine samples of them."""

from __future__ import annotations

import itertools
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from pliant import _check
from pliant.errors import ModelError
from pliant.typing import FloatArray

__all__ = ["Along", "Samples", "along", "find_jumps", "positive", "sample"]

Along = Callable[[FloatArray], FloatArray]
"""A quantity over the arc length [m]: takes and returns arrays of one shape."""

INSIDE = 1e-13
"""Distance from a break at which its two sides are told apart [L]."""
POINTS = 8001
"""Samples of a body, at least."""
POINTS_OF_A_SEGMENT = 801
"""Samples between two breaks, at least."""
JUMPS_SOUGHT = 64
"""Steepest intervals that are searched for a jump."""


def along(value: Any, name: str) -> Along:
    """Return a number or a callable of arc length, scalar or vectorised, as a vectorised function."""
    if not callable(value):
        number = _check.number(value, name)
        return lambda x: np.full(np.shape(x), number)
    given: Callable[[Any], Any] = value

    def function(x: FloatArray) -> FloatArray:
        x = np.asarray(x, dtype=np.float64)
        try:
            result = np.asarray(given(x), dtype=np.float64)
            if result.shape == x.shape:
                return result
        except (TypeError, ValueError):
            pass  # a function of one number
        flat = []
        for place in x.ravel():
            try:
                flat.append(float(given(float(place))))
            except (TypeError, ValueError) as error:
                raise ModelError(f"{name}({place:g}): must return one number ({error})") from error
        return np.array(flat).reshape(x.shape)

    return function


def positive(function: Along, length: float, name: str, breaks: tuple[float, ...] = ()) -> None:
    """Refuse a function that is not finite and above 0 everywhere on [0, length]."""
    edges = np.array([0.0, *breaks, length])
    inside = INSIDE * length
    x = np.unique(np.concatenate([np.linspace(0.0, length, 1001), edges[:-1] + inside, edges[1:] - inside]))
    value = function(x)
    wrong = ~(np.isfinite(value) & (value > 0))
    if wrong.any():
        i = int(np.argmax(wrong))
        _check.fail(f"{name}({x[i]:.6g})", float(value[i]), "must be finite and above 0 all along the body")


def find_jumps(function: Along, length: float, known: tuple[float, ...] = ()) -> list[float]:
    """Return the places [m] where a function jumps: steps between samples that bisection does not shrink."""
    edges = np.array([0.0, *known, length])
    inside = INSIDE * length
    found: list[float] = []
    for a, b in itertools.pairwise(edges):
        if a > 0:
            # A vertical tangent is no jump: its step grows with the distance it is taken over.
            left, right, far_left, far_right = function(a + inside * np.array([-1.0, 1.0, -100.0, 100.0]))
            step_here, step_around = abs(right - left), abs(far_right - far_left)
            if step_here > 1e-6 * max(abs(left), abs(right)) and step_here > 0.5 * step_around:
                found.append(float(a))
        n = max(POINTS_OF_A_SEGMENT, int(POINTS * (b - a) / length))
        x = np.linspace(a + inside, b - inside, n)
        y = function(x)
        step = np.abs(np.diff(y))
        noticeable = 1e-3 * max(float(np.ptp(y)), 1e-9 * float(np.abs(y).max()))
        steepest = [int(i) for i in np.argsort(step)[-JUMPS_SOUGHT:] if step[i] > noticeable]
        for i in sorted(steepest):
            low, high, before = float(x[i]), float(x[i + 1]), float(step[i])
            y_low, y_high = float(y[i]), float(y[i + 1])
            while high - low > 1e-14 * length:
                middle = 0.5 * (low + high)
                y_middle = float(function(np.array([middle]))[0])
                if abs(y_middle - y_low) > abs(y_high - y_middle):
                    high, y_high = middle, y_middle
                else:
                    low, y_low = middle, y_middle
                if abs(y_high - y_low) < 0.3 * before:
                    break
            else:
                found.append(0.5 * (low + high))
    return found


@dataclass(frozen=True)
class Samples:
    """Fine samples of a function and its derivative; each break occurs twice, with its two sides.

    Attributes
    ----------
    x : (n,)
        Places [m], ascending.
    value, slope : (n,)
        The function and its derivative by x.
    segment : (n,)
        Number of the smooth piece that a sample belongs to.
    """

    x: FloatArray
    value: FloatArray
    slope: FloatArray
    segment: FloatArray


def sample(function: Along, length: float, breaks: tuple[float, ...] = ()) -> Samples:
    """Sample a function piece by piece; slopes by differences of second order, one-sided at breaks."""
    edges = np.array([0.0, *breaks, length])
    inside = INSIDE * length
    rows = []
    for i, (a, b) in enumerate(itertools.pairwise(edges)):
        n = max(POINTS_OF_A_SEGMENT, int(POINTS * (b - a) / length)) | 1
        x = np.linspace(a, b, n)
        y = function(np.clip(x, a + inside, b - inside))
        rows.append((x, y, np.gradient(y, x[1] - x[0], edge_order=2), np.full(n, float(i))))
    return Samples(*(np.concatenate(column) for column in zip(*rows, strict=True)))
