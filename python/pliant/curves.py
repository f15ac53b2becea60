"""Lines of cables: polylines and curves become strands of nodes and slopes."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from pliant import _check
from pliant.errors import ModelError
from pliant.typing import ArrayLike, FloatArray, IntArray

__all__ = ["Curve", "Line", "divide"]

# Seven-point one-sided first difference, 6th order: exact tangents also where the curvature jumps at a node.
_ONE_SIDED = np.array([-147.0, 360.0, -450.0, 400.0, -225.0, 72.0, -10.0]) / 60.0


@dataclass(frozen=True)
class Curve:
    """A smooth line, by its position over arc length.

    Parameters
    ----------
    position : callable
        ``position(s)`` for s from 0 to ``length`` [m], shape (3,) [m]: unit speed, continuous tangent.
    length : float
        Length [m], above 0.

    Examples
    --------
    >>> arc = Curve(lambda s: (np.sin(s), 0.0, 1.0 - np.cos(s)), length=np.pi / 2)
    >>> bool(np.allclose(arc.sample(np.array([0.0])), 0.0))
    True
    """

    position: Callable[[float], ArrayLike]
    length: float

    def __post_init__(self) -> None:
        if not callable(self.position):
            _check.fail("position", self.position, "must be a callable of arc length")
        object.__setattr__(self, "length", _check.number(self.length, "length", above=0))

    def sample(self, s: FloatArray) -> FloatArray:
        """Positions [m] at arc lengths (n,), shape (n, 3)."""
        return np.array(
            [_check.vector(self.position(float(x)), f"position({x:g})") for x in s.ravel()]
        ).reshape(*s.shape, 3)

    def tangents(self, s: FloatArray, spacing: float) -> FloatArray:
        """Return unit tangents at arc lengths (n,), by differences a fiftieth of ``spacing`` apart."""
        step = 0.02 * spacing
        steps = step * np.arange(7)
        forward = np.where(s[:, None] + steps[-1] <= self.length, s[:, None] + steps, s[:, None] - steps)
        backward = np.where(s[:, None] - steps[-1] >= 0.0, s[:, None] - steps, s[:, None] + steps)
        best = np.empty((len(s), 3))
        error = np.full(len(s), np.inf)
        for places in (forward, backward):
            direction = np.sign(places[:, 1] - places[:, 0])
            tangent = np.einsum("k,nkj->nj", _ONE_SIDED, self.sample(places)) * (direction / step)[:, None]
            off = np.abs(np.linalg.norm(tangent, axis=1) - 1.0)
            better = off < error
            best[better], error[better] = tangent[better], off[better]
        worst = int(np.argmax(error))
        if error[worst] > 1e-6:
            speed = float(np.linalg.norm(best[worst]))
            raise ModelError(
                f"position: has speed {speed:.9g} at s = {s[worst]:g} m, must be 1 to within 1e-6 "
                "(parametrise the curve by its arc length)"
            )
        best /= np.linalg.norm(best, axis=1, keepdims=True)
        return best


@dataclass(frozen=True)
class Line:
    """Strands of nodes along a line.

    Attributes
    ----------
    strands : (k,)
        Number of elements of each strand.
    users : (n,)
        Node of the body for each node of a strand; strands that meet share one.
    r, t : (n, 3)
        Positions [m] and unit tangents.
    lengths : (elements,)
        Lengths of the elements along the line [m].
    normal : (3,) or None
        Normal of the plane of a line that is curved at rest.
    """

    strands: IntArray
    users: IntArray
    r: FloatArray
    t: FloatArray
    lengths: FloatArray
    normal: FloatArray | None = None


def first_nodes(strands: IntArray) -> IntArray:
    """Return the number of each strand's first node, with the number of nodes at the end, shape (k + 1,)."""
    return np.concatenate([[0], np.cumsum(strands + 1)])


def element_nodes(strands: IntArray) -> IntArray:
    """First node of each element, shape (elements,)."""
    before = np.repeat(np.arange(len(strands)), strands)
    first: IntArray = before + np.arange(int(strands.sum()))
    return first


def divide(lengths: FloatArray, elements: int) -> IntArray:
    """Elements of each piece: at least one, in proportion to length, ``elements`` in all.

    Examples
    --------
    >>> divide(np.array([1.0, 3.0]), 8)
    array([2, 6])
    """
    n: IntArray = np.maximum(1, np.floor(elements * lengths / lengths.sum() * (1 + 1e-12))).astype(np.int64)
    while n.sum() > elements:
        n[np.argmin(np.where(n > 1, lengths / np.maximum(n - 1, 1), np.inf))] -= 1
    while n.sum() < elements:
        n[np.argmax(lengths / n)] += 1
    return n


def polyline(points: FloatArray, elements: int, closed: bool) -> Line:
    """Straight pieces through the points (n, 3); pieces that go straight on are one strand."""
    if closed:
        if len(points) < 3:
            _check.fail("points", points, "a closed cable needs three points or more")
        points = np.vstack([points, points[:1]])
    pieces = np.diff(points, axis=0)
    lengths = np.linalg.norm(pieces, axis=1)
    size = float(np.abs(points - points[0]).max())
    short = int(np.argmin(lengths))
    if lengths[short] <= 1e-9 * size or size == 0.0:
        following = (short + 1) % (len(points) - 1 if closed else len(points))
        _check.fail(
            f"points[{following}]",
            points[short + 1],
            f"coincides with points[{short}]; leave one of them out",
        )
    if elements < len(pieces):
        _check.fail("elements", elements, f"must be at least {len(pieces)}, one for each straight piece")
    directions = pieces / lengths[:, None]
    straight_on = np.linalg.norm(directions[1:] - directions[:-1], axis=1) < 1e-9
    if closed and np.linalg.norm(directions[0] - directions[-1]) < 1e-9:
        _check.fail(
            "points[0]", points[0], "a closed cable must start at a corner; begin the points at another one"
        )
    counts = divide(lengths, elements)
    strands: list[int] = []
    users: list[int] = []
    r: list[FloatArray] = []
    t: list[FloatArray] = []
    node = 0
    for k, n in enumerate(int(c) for c in counts):
        places = points[k] + np.linspace(0.0, 1.0, n + 1)[:, None] * pieces[k]
        places[-1] = points[k + 1]
        skip = 1 if k > 0 and straight_on[k - 1] else 0
        if skip:
            strands[-1] += n
        else:
            strands.append(n)
        r.append(places[skip:])
        t.append(np.repeat(directions[k][None], n + 1 - skip, axis=0))
        users.extend(range(node + skip, node + n + 1))
        node += n
    ids = np.array(users, dtype=np.int64)
    if closed:
        ids[-1] = 0
    return Line(
        np.array(strands, dtype=np.int64),
        ids,
        np.vstack(r),
        np.vstack(t),
        np.repeat(lengths / counts, counts),
    )


def smooth(curve: Curve, elements: int, closed: bool, rest: str) -> Line:
    """One strand along a curve."""
    spacing = curve.length / elements
    s = np.linspace(0.0, curve.length, elements + 1)
    r = curve.sample(s)
    t = curve.tangents(s, spacing)
    users = np.arange(elements + 1)
    if closed:
        if np.linalg.norm(r[-1] - r[0]) > 1e-6 * curve.length:
            _check.fail("closed", True, f"the curve ends {np.linalg.norm(r[-1] - r[0]):.3g} m from its start")
        if np.linalg.norm(t[-1] - t[0]) < 1e-6:
            _check.fail(
                "closed",
                True,
                "a ring whose tangent runs on through the seam cannot be built yet; leave a corner there, "
                "or leave closed=False",
            )
        r[-1] = r[0]
        users[-1] = 0
    normal = None
    if rest == "given":
        between = np.linspace(0.0, curve.length, 4 * elements + 1)
        normal = _plane(
            curve.sample(between), np.vstack([t, curve.tangents(between[2::4], spacing)]), curve.length
        )
    return Line(np.array([elements]), users, r, t, np.full(elements, spacing), normal)


def _plane(r: FloatArray, t: FloatArray, length: float) -> FloatArray | None:
    """Return the normal of the plane of a line, None if it is straight; refuses a line curved in space."""
    if np.abs(t - t[0]).max() < 1e-8:
        return None
    normal: FloatArray = np.linalg.svd(t, full_matrices=True)[2][-1]
    off = max(float(np.abs((r - r[0]) @ normal).max()) / length, float(np.abs(t @ normal).max()))
    if off > 1e-7:
        raise ModelError(
            f"points: the curve leaves its plane by {off:.3g} of its length; cannot be curved in space "
            'at rest. Take rest="straight" (free of axial strain at the start, straight when unloaded), or a '
            "body that twists"
        )
    normal[np.abs(normal) < 1e-12] = 0.0
    first = int(np.argmax(np.abs(normal)))
    normal *= np.sign(normal[first]) / np.linalg.norm(normal)
    return normal
