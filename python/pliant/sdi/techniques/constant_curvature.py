"""Piecewise constant curvature: a chain of arcs, each with the stiffness of its piece.

    l_i k_i kappa_i = M l_i + F . dr_L / dkappa_i

is the equilibrium of the chain: with an end moment alone kappa_i = M / k_i.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from pliant import _check
from pliant.errors import ConvergenceError
from pliant.sdi.body import Body
from pliant.sdi.techniques import Loading
from pliant.sdi.techniques.matrix import node_places, sampled
from pliant.typing import ArrayLike, FloatArray

__all__ = ["solve"]


def _arcs(kappa: FloatArray, spans: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the ends of the arcs, (n + 1, 2), and the slopes there, (n + 1,)."""
    angle = np.concatenate([[0.0], np.cumsum(kappa * spans)])
    half = 0.5 * kappa * spans
    chord = spans * np.sinc(half / np.pi)
    steps = chord[:, None] * np.stack([np.cos(angle[:-1] + half), np.sin(angle[:-1] + half)], axis=1)
    return np.concatenate([np.zeros((1, 2)), np.cumsum(steps, axis=0)]), angle


def _rates(kappa: FloatArray, spans: FloatArray) -> FloatArray:
    """Return the derivatives of the end's place by each curvature, (n, 2)."""
    r, angle = _arcs(kappa, spans)
    half = 0.5 * kappa * spans
    # d(arc's chord)/d kappa beside the rotation of all that follows.
    size = np.where(
        np.abs(half) > 1e-4, (np.cos(half) - np.sinc(half / np.pi)) / np.where(half == 0, 1, half), -half / 3
    )
    mid = angle[:-1] + half
    t, n = np.stack([np.cos(mid), np.sin(mid)], axis=1), np.stack([-np.sin(mid), np.cos(mid)], axis=1)
    chord = spans * np.sinc(half / np.pi)
    own = (0.5 * spans * spans * size)[:, None] * t + (0.5 * spans * chord)[:, None] * n
    rest = r[-1] - r[1:]
    return np.asarray(own + spans[:, None] * np.stack([-rest[:, 1], rest[:, 0]], axis=1))


def solve(
    body: Body,
    load: Loading,
    *,
    segments: int = 6,
    sampling: str = "harmonic",
    nodes: ArrayLike | None = None,
) -> tuple[FloatArray, FloatArray, FloatArray, int, dict[str, Any]]:
    """Bend a chain of arcs, equally long or between ``nodes`` [m]; ``sampling`` as for "matrix"."""
    from scipy.optimize import root

    rule = _check.choice(sampling, "sampling", ("harmonic", "mean", "mid"))
    places = node_places(nodes, _check.count(segments, "segments", at_most=10**4), body.length)
    n = len(places) - 1
    spans, k = np.diff(places), sampled(body, places, rule)
    F = np.array(load.force)
    kappa = load.moment / k
    if F.any():
        scale = max(abs(load.moment), float(np.abs(F).max()) * body.length)

        def out_of_balance(kappa: FloatArray, factor: float) -> FloatArray:
            rates = _rates(kappa, spans) @ F / spans
            balance: FloatArray = (k * kappa - factor * (load.moment + rates)) / scale
            return balance

        kappa = np.zeros(n)
        for factor in (0.25, 0.5, 0.75, 1.0):
            # The curvature is scaled, so that the unknowns are of one size.
            found = root(
                lambda u, part=factor: out_of_balance(u / body.length, part), kappa * body.length, tol=1e-12
            )
            kappa = found.x / body.length
        if np.abs(found.fun).max() > 1e-8:
            raise ConvergenceError(f"constant_curvature: no equilibrium of the chain found ({found.message})")
    r, angle = _arcs(kappa, spans)
    return r[:, 0], r[:, 1], angle, n, {"curvature": kappa, "nodes": places}
