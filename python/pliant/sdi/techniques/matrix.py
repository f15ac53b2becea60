"""Nonlinear matrix structural analysis: steps of the load, each linear, in frames that turn with the chords.

    K(alpha) du = f / n,   alpha = atan2 of the chords, the lengths kept

Each element has the stiffness of an Euler-Bernoulli beam. As published, K has no geometric terms: with an end
moment the scheme is consistent, with an end force it converges to a wrong shape. ``geometric=True`` adds

    K_g = N/l z z' - V/l (r z' + z r'),  r = (-1, 0, 0, 1, 0, 0),  z = (0, -1, 0, 0, 1, 0)

with the accumulated forces N and V at the end of the element.
"""

from __future__ import annotations

import itertools
from typing import Any

import numpy as np

from pliant import _check
from pliant.errors import ModelError
from pliant.sdi.body import Body
from pliant.sdi.techniques import Loading
from pliant.sdi.techniques.elastica import Line
from pliant.typing import ArrayLike, FloatArray

__all__ = ["local_stiffness", "march", "node_places", "sampled", "solve", "tapered_stiffness"]

PANELS = 8
"""Panels of the quadrature over an element."""

ALONG = np.array([-1.0, 0, 0, 1, 0, 0])
ACROSS = np.array([0, -1.0, 0, 0, 1, 0])


def sampled(body: Body, nodes: FloatArray, sampling: str, quantity: str = "stiffness") -> FloatArray:
    """Stiffness of each element between nodes: in its middle, its mean, or its harmonic mean."""
    function = getattr(body, quantity)
    if sampling == "mid":
        return np.asarray(function(0.5 * (nodes[:-1] + nodes[1:])))
    values = []
    for a, b in itertools.pairwise(nodes):
        breaks = tuple(p - a for p in body.breakpoints if a < p < b)
        line = Line(b - a, breaks, PANELS)
        k = function(np.clip(a + line.s, 0.0, body.length))
        values.append(
            (b - a) / (line.weights @ (1.0 / k)) if sampling == "harmonic" else line.weights @ k / (b - a)
        )
    return np.array(values)


def solve(
    body: Body,
    load: Loading,
    *,
    variant: str = "consistent",
    elements: int = 6,
    steps: int = 100,
    sampling: str | None = None,
    geometric: bool | None = None,
    shear: bool = False,
    nodes: ArrayLike | None = None,
) -> tuple[FloatArray, FloatArray, FloatArray, int, dict[str, Any]]:
    """Bend a chain of beam elements.

    ``variant="paper"``: the stiffness in mid-element, no geometric terms; ``"consistent"``: harmonic means
    and geometric terms. The other options overrule it. ``sampling="exact"``: the stiffness matrix of the
    tapered element, from its compliances. ``nodes``: their places [m], instead of ``elements`` equal ones.
    """
    paper = _check.choice(variant, "variant", ("consistent", "paper")) == "paper"
    rule = _check.choice(
        sampling or ("mid" if paper else "harmonic"), "sampling", ("harmonic", "mean", "mid", "exact")
    )
    turning = (not paper) if geometric is None else _check.flag(geometric, "geometric")
    steps = _check.count(steps, "steps", at_most=10**6)
    places = node_places(nodes, _check.count(elements, "elements", at_most=10**4), body.length)
    mean = "harmonic" if rule == "exact" else rule
    k = sampled(body, places, mean)
    EA = sampled(body, places, mean, "axial_stiffness")
    phi = np.zeros(len(k))
    shear = _check.flag(shear, "shear")
    if shear and rule == "exact":
        raise ModelError('shear: goes with a sampled stiffness; take sampling="harmonic"')
    if shear:
        if body.sections is None:
            raise ModelError(
                "shear: the body's cross sections are not known; make it with them, or shear=False"
            )
        middles = 0.5 * (places[:-1] + places[1:])
        phi = 12.0 * k / (body.sections.shear_stiffness(middles) * np.diff(places) ** 2)
    lengths = np.diff(places)
    local = tapered_stiffness(body, places, EA) if rule == "exact" else local_stiffness(lengths, k, EA, phi)
    x, y, angle = march(lengths, local, load, steps, turning)
    return x, y, angle, 3 * len(k), {"element_stiffness": k, "nodes": places}


def node_places(nodes: Any, count: int, length: float) -> FloatArray:
    """Return the given places of nodes, or ``count`` equal pieces."""
    if nodes is None:
        return np.linspace(0.0, length, count + 1)
    places = _check.array(nodes, "nodes", (None,))
    ascending = len(places) > 1 and bool(np.all(np.diff(places) > 0))
    if not ascending or places[0] != 0.0 or abs(places[-1] - length) > 1e-9 * length:
        _check.fail("nodes", nodes, f"must ascend from 0 to the length {length:g}")
    return places


def local_stiffness(spans: FloatArray, k: FloatArray, EA: FloatArray, phi: FloatArray) -> FloatArray:
    """Stiffness matrices (n, 6, 6) of beam elements; ``phi`` is 12 k / (kappa G A l^2), 0 without shear."""
    K = np.zeros((len(spans), 6, 6))
    c = k / (1.0 + phi)
    entries = {
        (1, 1): 12 * c / spans**3,
        (1, 2): 6 * c / spans**2,
        (1, 5): 6 * c / spans**2,
        (2, 2): (4 + phi) * c / spans,
        (2, 5): (2 - phi) * c / spans,
        (5, 5): (4 + phi) * c / spans,
        (4, 4): 12 * c / spans**3,
        (1, 4): -12 * c / spans**3,
        (2, 4): -6 * c / spans**2,
        (4, 5): -6 * c / spans**2,
        (0, 0): EA / spans,
        (3, 3): EA / spans,
        (0, 3): -EA / spans,
    }
    for (i, j), value in entries.items():
        K[:, i, j] = K[:, j, i] = value
    return K


def tapered_stiffness(body: Body, nodes: FloatArray, EA: FloatArray) -> FloatArray:
    """Stiffness matrices (n, 6, 6) of elements whose stiffness varies inside.

    The compliance of the far end against the near one, int (1, u, u^2)/k with u the distance from the far
    end, is exact; its inverse and equilibrium make the rest.
    """
    K = np.zeros((len(nodes) - 1, 6, 6))
    for e, (a, b) in enumerate(itertools.pairwise(nodes)):
        line = Line(b - a, tuple(p - a for p in body.breakpoints if a < p < b), PANELS)
        give = line.weights / body.stiffness(np.clip(a + line.s, 0.0, body.length))
        u = (b - a) - line.s
        one, first, second = float(give.sum()), float(give @ u), float(give @ u**2)
        far = np.linalg.inv(np.array([[second, first], [first, one]]))
        # Forces of the near end follow from those of the far end: V1 = -V2, M1 = -M2 - V2 l.
        lever = np.array([[-1.0, 0.0], [-(b - a), -1.0], [1.0, 0.0], [0.0, 1.0]])
        bending = [1, 2, 4, 5]
        K[e][np.ix_(bending, bending)] = lever @ far @ lever.T
        K[e, 0, 0] = K[e, 3, 3] = EA[e] / (b - a)
        K[e, 0, 3] = K[e, 3, 0] = -EA[e] / (b - a)
    return K


def march(
    spans: FloatArray, local: FloatArray, load: Loading, steps: int, geometric: bool
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Apply the load in steps to elements of stiffnesses (n, 6, 6); return places and slopes of nodes."""
    n = len(spans)
    along = np.outer(ACROSS, ACROSS)
    across = np.outer(ALONG, ACROSS) + np.outer(ACROSS, ALONG)
    position = np.zeros((n + 1, 3))
    position[1:, 0] = np.cumsum(spans)
    step = np.zeros(3 * n)
    step[-3:] = np.array([*load.force, load.moment]) / steps
    forces = np.zeros((n, 6))
    # Where the entries of each element go in a matrix that still has the clamped node.
    dofs = 3 * np.arange(n)[:, None] + np.arange(6)
    rows, columns = np.repeat(dofs, 6, axis=1).ravel(), np.tile(dofs, (1, 6)).ravel()
    size = 3 * (n + 1)
    places = rows * size + columns
    for _ in range(steps):
        chord = np.diff(position[:, :2], axis=0)
        alpha = np.arctan2(chord[:, 1], chord[:, 0])
        R = np.zeros((n, 6, 6))
        c, s = np.cos(alpha), np.sin(alpha)
        for o in (0, 3):
            R[:, o, o], R[:, o, o + 1] = c, s
            R[:, o + 1, o], R[:, o + 1, o + 1] = -s, c
            R[:, o + 2, o + 2] = 1.0
        K = local
        if geometric:
            N, V = forces[:, 3] / spans, forces[:, 4] / spans
            K = local + N[:, None, None] * along - V[:, None, None] * across
        whole = np.bincount(places, (R.transpose(0, 2, 1) @ K @ R).ravel(), size * size).reshape(size, size)
        du = np.zeros(size)
        du[3:] = np.linalg.solve(whole[3:, 3:], step)
        position += du.reshape(n + 1, 3)
        if geometric:
            forces += (local @ (R @ du[dofs][..., None]))[..., 0]
    return position[:, 0], position[:, 1], position[:, 2]
