"""How lines lie beside each other: distances, linking and knots, from points along them alone."""

from __future__ import annotations

import numpy as np

from pliant.bodies import LineBody
from pliant.drawing import Lines, draw
from pliant.points import Handle
from pliant.result import Result
from pliant.typing import ArrayLike, FloatArray, IntArray

__all__ = ["centre_line", "knot_determinant", "linking_number", "nearest_approach", "pieces_apart"]


def centre_line(
    result: Result, cable: Handle | str, frames: ArrayLike | None = None, pieces: int = 8
) -> FloatArray:
    """Points along a cable, several an element.

    Parameters
    ----------
    result : Result
        The run.
    cable : Cable or str
        A cable, or a net: then the points of one strand after the other.
    frames : array_like of int, optional
        Outputs; None: all.
    pieces : int
        Pieces an element, at most 8.

    Returns
    -------
    ndarray, shape (frames, points, 3)
        [m].
    """
    name = cable if isinstance(cable, str) else cable.name
    which = np.arange(len(result.time)) if frames is None else np.asarray(frames, dtype=np.int64)
    elements = sum(body.elements for body in result.model._bodies.values() if isinstance(body, LineBody))
    drawings = draw(result, which, points=pieces * elements)
    return next(drawn.points for drawn in drawings if isinstance(drawn, Lines) and drawn.name == name)


def pieces_apart(a: FloatArray, b: FloatArray) -> FloatArray:
    """Distances of straight pieces: from a[..., 0, :] to a[..., 1, :], and the same of b [m], (...)."""
    u, v, w = a[..., 1, :] - a[..., 0, :], b[..., 1, :] - b[..., 0, :], a[..., 0, :] - b[..., 0, :]
    uu, uv, vv = (u * u).sum(-1), (u * v).sum(-1), (v * v).sum(-1)
    uw, vw = (u * w).sum(-1), (v * w).sum(-1)
    tiny = np.finfo(float).tiny
    # The nearest of: where the lines face each other, and each end before the other piece.
    det = uu * vv - uv * uv
    s = np.clip((uv * vw - vv * uw) / np.maximum(det, tiny), 0.0, 1.0)
    nearest = np.full(np.broadcast_shapes(s.shape), np.inf)
    for start in (s, np.zeros_like(s), np.ones_like(s)):
        t = np.clip((uv * start + vw) / np.maximum(vv, tiny), 0.0, 1.0)
        # Once more along the first, whose parameter the clipping of the second may have moved.
        again = np.clip((uv * t - uw) / np.maximum(uu, tiny), 0.0, 1.0)
        gap = w + again[..., None] * u - t[..., None] * v
        nearest = np.minimum(nearest, np.linalg.norm(gap, axis=-1))
    return nearest


def nearest_approach(points: FloatArray, apart: float) -> float:
    """Smallest distance of a line to itself between places further apart along it than ``apart`` [m].

    Parameters
    ----------
    points : ndarray, shape (n, 3)
        Points along the line [m].
    apart : float
        Length along the line within which places do not count [m].

    Returns
    -------
    float
        Distance of the centre lines [m].
    """
    pieces = np.stack([points[:-1], points[1:]], axis=1)
    lengths = np.linalg.norm(np.diff(points, axis=0), axis=1)
    ends = np.concatenate([[0.0], np.cumsum(lengths)])
    middles = pieces.mean(axis=1)
    best, longest = np.inf, float(lengths.max())
    for i in range(len(pieces)):
        later = int(np.searchsorted(ends[:-1], ends[i + 1] + apart))
        away = np.linalg.norm(middles[later:] - middles[i], axis=1)
        close = later + np.flatnonzero(away < best + longest)
        if len(close):
            best = min(best, float(pieces_apart(pieces[i][None], pieces[close]).min()))
    return best


def linking_number(a: FloatArray, b: FloatArray) -> float:
    """How often two closed lines go through each other (Gauss' integral, summed exactly over the pieces).

    Parameters
    ----------
    a, b : ndarray, shape (n, 3), (m, 3)
        Corners of the closed polygons; the last is joined to the first.

    Returns
    -------
    float
        A whole number to rounding, unless the two meet.

    Examples
    --------
    >>> turn = 2 * np.pi * np.arange(24) / 24
    >>> ring = np.stack([np.cos(turn), np.sin(turn), 0 * turn], axis=1)
    >>> other = ring[:, [0, 2, 1]] + [1.0, 0.0, 0.0]
    >>> abs(round(linking_number(ring, other), 9)), abs(round(linking_number(ring, other + 5.0), 9))
    (1.0, 0.0)
    """
    a_1, b_1 = np.roll(a, -1, axis=0), np.roll(b, -1, axis=0)
    corners = [b[None, :] - a[:, None], b[None, :] - a_1[:, None], b_1[None, :] - a_1[:, None]]
    corners.append(b_1[None, :] - a[:, None])
    lengths = [np.linalg.norm(r, axis=-1) for r in corners]
    total = 0.0
    # The solid angle of the parallelogram that the differences span, as two triangles.
    for i, j, k in ((0, 1, 2), (0, 2, 3)):
        p, q, r = corners[i], corners[j], corners[k]
        volume = (p * np.cross(q, r)).sum(-1)
        below = lengths[i] * lengths[j] * lengths[k] + (p * q).sum(-1) * lengths[k]
        below += (q * r).sum(-1) * lengths[i] + (r * p).sum(-1) * lengths[j]
        total += float(2.0 * np.arctan2(volume, below).sum())
    return total / (4 * np.pi)


def knot_determinant(points: FloatArray, along: ArrayLike = (0.3, 0.2, 1.0)) -> int:
    """Tell knots apart by their determinant: 1 no knot, 3 trefoil, 5 figure-eight and cinquefoil.

    The Alexander polynomial at -1, from the crossings seen along a direction, of a line whose ends point away
    from it. Lines that can be moved into each other without passing through themselves have the same.

    Parameters
    ----------
    points : ndarray, shape (n, 3)
        Points along the line [m].
    along : array_like, shape (3,)
        Line of sight: the ends must not be hidden within the knot.

    Returns
    -------
    int
        The determinant.

    Examples
    --------
    >>> t = np.linspace(-2.9, 2.9, 200)
    >>> knot = np.stack([t**3 - 3 * t, t**4 - 4 * t**2, t**5 / 5 - 2 * t], axis=1)
    >>> rising = np.stack([knot[:, 0], knot[:, 1], t], axis=1)
    >>> knot_determinant(knot, (0, 0, 1)), knot_determinant(rising, (0, 0, 1))
    (3, 1)
    """
    sight = np.asarray(along, dtype=float)
    sight = sight / np.linalg.norm(sight)
    right = np.cross(sight, np.eye(3)[np.argmin(np.abs(sight))])
    right /= np.linalg.norm(right)
    flat = points @ np.stack([right, np.cross(sight, right)], axis=1)
    height = points @ sight
    crossings = _crossings(flat, height)
    unders = np.sort(crossings[:, 1])
    n = len(unders)
    if n < 2:
        return 1
    # Arcs run from one crossing below to the next; the ends of the line belong to one arc.
    rows = np.zeros((n, n))
    for row, (over, under) in enumerate(crossings):
        k = int(np.searchsorted(unders, under))
        rows[row, int(np.searchsorted(unders, over)) % n] += 2.0
        rows[row, k] -= 1.0
        rows[row, (k + 1) % n] -= 1.0
    return int(np.rint(abs(np.linalg.det(rows[1:, 1:]))))


def _crossings(flat: FloatArray, height: FloatArray) -> FloatArray:
    """Where a flat line crosses itself: places above and below, in numbers of pieces, (n, 2)."""
    start, way = flat[:-1], np.diff(flat, axis=0)
    i, j = _overlapping(flat)
    off = start[j] - start[i]
    det = way[i, 0] * way[j, 1] - way[i, 1] * way[j, 0]
    with np.errstate(divide="ignore", invalid="ignore"):
        s = (off[:, 0] * way[j, 1] - off[:, 1] * way[j, 0]) / det
        t = (off[:, 0] * way[i, 1] - off[:, 1] * way[i, 0]) / det
    meet = (s >= 0) & (s < 1) & (t >= 0) & (t < 1)
    i, j, s, t = i[meet], j[meet], s[meet], t[meet]
    rise = np.diff(height)
    first = height[i] + s * rise[i] > height[j] + t * rise[j]
    places = np.stack([i + s, j + t], axis=1)
    return np.where(first[:, None], places, places[:, ::-1])


def _overlapping(flat: FloatArray) -> tuple[IntArray, IntArray]:
    """Pairs of pieces, not neighbours, whose rectangles overlap."""
    low, high = np.minimum(flat[:-1], flat[1:]), np.maximum(flat[:-1], flat[1:])
    first, second = [], []
    for i in range(len(low) - 2):
        apart = (low[i + 2 :] > high[i]) | (high[i + 2 :] < low[i])
        found = i + 2 + np.flatnonzero(~apart.any(axis=1))
        first.append(np.full(len(found), i))
        second.append(found)
    return np.concatenate(first), np.concatenate(second)
