"""Finite elements: the body as a solid, in plane stress or in space; the reference of the other techniques.

Newton's method starts at the shape of the elastica, its sections kept plane; where that fails, the load grows
in steps. Saint Venant-Kirchhoff's law loses its stability under compression of 0.3: then there is no
equilibrium.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from pliant import _check
from pliant.errors import ConvergenceError, ModelError
from pliant.sdi.body import Body
from pliant.sdi.index import BLEND, blended
from pliant.sdi.sampling import INSIDE
from pliant.sdi.sections import Sections
from pliant.sdi.solid import Lattice, Solid, hexahedron, quadrilateral
from pliant.sdi.techniques import Loading, elastica
from pliant.typing import FloatArray

__all__ = ["columns", "solid_of", "solve"]

PLANE = (80, 6)
SPACE = (34, 4, 2)
SMALLEST = 1 / 16
"""Smallest step of the load, over the one asked for."""
IN_NOTCHES = 0.6
"""Share of the columns of elements that lie in the notches."""


def columns(body: Body, count: int, breaks: tuple[float, ...]) -> FloatArray:
    """Return the ends of columns of elements: at the breaks, and most of them in the notches."""
    edges = np.array([0.0, *breaks, body.length])
    lengths = np.diff(edges)
    middles = 0.5 * (edges[:-1] + edges[1:])
    inside = np.array([any(n.start < m < n.end for n in body.notches) for m in middles])
    share = lengths / body.length
    if inside.any() and not inside.all() and body.jumps == ():
        share = np.where(
            inside,
            IN_NOTCHES * lengths / lengths[inside].sum(),
            (1 - IN_NOTCHES) * lengths / lengths[~inside].sum(),
        )
    counts = np.maximum(1, np.floor(count * share + 1e-9)).astype(int)
    while counts.sum() < count:
        counts[np.argmax(count * share - counts)] += 1
    while counts.sum() > count and counts.max() > 1:
        counts[np.argmax(counts - count * share - 1e6 * (counts == 1))] -= 1
    pieces = [
        np.linspace(a, b, n, endpoint=False) for a, b, n in zip(edges[:-1], edges[1:], counts, strict=True)
    ]
    return np.append(np.concatenate(pieces), body.length)


def _rows(sections: Sections, rows: int) -> tuple[FloatArray, FloatArray, list[int]]:
    """Layer of each row, its bottom and top within the layer (0 to 1), and Young's modulus factors."""
    if not sections.layers:
        cuts = np.linspace(0.0, 1.0, rows + 1)
        return cuts[:-1], cuts[1:], [0] * rows
    origin = np.zeros(1)
    heights = np.array([float(layer.height(origin)[0]) for layer in sections.layers])
    counts = np.maximum(1, np.round(rows * heights / heights.sum())).astype(int)
    low = np.concatenate([np.arange(n) / n for n in counts])
    high = np.concatenate([np.arange(1, n + 1) / n for n in counts])
    return low, high, [i for i, n in enumerate(counts) for _ in range(n)]


def solid_of(body: Body, dimension: int, size: tuple[int, ...]) -> Solid:
    """Mesh a body."""
    sections = body.sections
    if sections is None:
        raise ModelError(
            f"body = {body.name}: its cross sections are not known; finite elements need height= and "
            "youngs_modulus="
        )
    if dimension == 2 and sections.shape == "circle":
        raise ModelError(
            "dimension = 2: plane stress is for rectangular sections; a round body takes dimension=3"
        )
    L, inside = body.length, INSIDE * body.length
    height, width, breaks = sections.height, sections.width, body.breakpoints
    steps = tuple(
        j for j in body.jumps if abs(float(np.diff(height(np.array([j - inside, j + inside])))[0])) > 1e-9 * L
    )
    if steps:  # rounded, since a mapped mesh cannot jump
        height, more, _ = blended(height, L, steps, BLEND * L, 1.0)
        if sections.shape == "circle":
            width = height
        breaks = tuple(sorted({*breaks, *more}))
    ends = columns(body, size[0], breaks)
    along = np.empty(2 * len(ends) - 1)
    along[::2], along[1::2] = ends, 0.5 * (ends[:-1] + ends[1:])
    low, high, layer = _rows(sections, size[1])
    count = len(layer)
    across = np.concatenate([[low[0]], np.stack([0.5 * (low + high), high], axis=1).ravel()])
    of_row = np.concatenate([[layer[0]], np.repeat(layer, 2)])

    def sheet(place: Any) -> FloatArray:
        x = along[place[:, 0]]
        clipped = np.clip(x, inside, L - inside)
        if sections.layers:
            tops = np.cumsum([one.height(clipped) for one in sections.layers], axis=0)
            bottoms = np.vstack([np.zeros((1, len(x))), tops[:-1]])
            number = of_row[place[:, 1]]
            here = np.arange(len(x))
            bottom, top = bottoms[number, here], tops[number, here]
            y = bottom + across[place[:, 1]] * (top - bottom) - sections.neutral_axis(clipped)
        else:
            y = (across[place[:, 1]] - 0.5) * height(clipped)
        if dimension == 2:
            return np.stack([x, y], axis=1)
        zeta = place[:, 2] / (2.0 * size[2])
        z = 0.5 * zeta * width(clipped)
        if sections.shape == "circle":
            eta = 2 * across[place[:, 1]] - 1
            y, z = y * np.sqrt(1 - 0.5 * zeta**2), z * np.sqrt(1 - 0.5 * eta**2)
        return np.stack([x, y, z], axis=1)

    kind = quadrilateral() if dimension == 2 else hexahedron()
    lattice = Lattice.of(kind, (len(ends) - 1, count, *size[2:]), sheet)
    x = np.einsum("qm,em->eq", kind.values, lattice.nodes[lattice.elements][:, :, 0]).clip(inside, L - inside)
    if sections.layers:
        moduli = np.array([one.youngs_modulus for one in sections.layers])[np.array(layer)[lattice.row]]
        E = np.broadcast_to(moduli[:, None], x.shape)
    else:
        E = sections.youngs_modulus(x)
    nu = sections.poisson_ratio
    lam = E * nu / (1 - nu**2) if dimension == 2 else E * nu / ((1 + nu) * (1 - 2 * nu))
    lame = np.stack([lam, E / (2 * (1 + nu))], axis=2)
    return Solid(lattice, lame, width(x) if dimension == 2 else np.full(x.shape, 2.0))


def solve(
    body: Body,
    load: Loading,
    *,
    dimension: int = 2,
    elements: tuple[int, ...] | None = None,
    steps: int = 1,
    tolerance: float = 1e-8,
) -> tuple[FloatArray, FloatArray, FloatArray, int, dict[str, Any]]:
    """Bend a solid; see the module."""
    if dimension not in (2, 3) or isinstance(dimension, bool):
        _check.fail("dimension", dimension, "must be 2 or 3")
    size: tuple[int, ...] = PLANE if dimension == 2 else SPACE
    if elements is not None:
        given = _check.integers(elements, "elements", (dimension,))
        if given.min() < 1 or given.max() > 4000:
            _check.fail("elements", elements, f"must be {dimension} whole numbers from 1 to 4000")
        size = tuple(int(n) for n in given)
    steps = _check.count(steps, "steps", at_most=10**4)
    tolerance = _check.number(tolerance, "tolerance", above=0, below=1e-3)
    solid = solid_of(body, dimension, size)
    nodes = solid.lattice.nodes
    u, master = np.zeros_like(nodes), np.zeros(3)
    full = np.array([*load.force, load.moment])
    iterations = 0
    reached = 0.0
    share = 1.0 / steps
    while reached < 1.0 - 1e-12:
        factor = min(1.0, reached + share)
        guess, end = _guess(body, load, factor, nodes) if reached == 0.0 else (u, master)
        if reached > 0.0:
            ahead, to = _guess(body, load, factor, nodes)
            back, since = _guess(body, load, reached, nodes)
            guess, end = u + ahead - back, master + to - since
        try:
            u, master, history = solid.solve(guess, end, factor * full, tolerance)
        except ConvergenceError as error:
            share *= 0.5
            if share < SMALLEST / steps:
                raise ConvergenceError(
                    f"finite_element: no equilibrium beyond {reached:.3g} of the load. Saint "
                    "Venant-Kirchhoff's law "
                    "loses its stability near a compression of 0.3: load less",
                    time=reached,
                    step=share,
                    residuals=error.residuals,
                ) from None
            continue
        iterations += len(history)
        reached = factor
    x, y, angle = _axis(solid, u, master)
    unknowns = len(solid.free) + 3
    strain = _largest_strain(solid, u)
    return (
        x,
        y,
        angle,
        unknowns,
        {"iterations": iterations, "solid": solid, "displacement": u, "strain": strain},
    )


def _guess(body: Body, load: Loading, factor: float, nodes: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Displacements of the elastica with plane sections, and those of the end."""
    part = Loading(factor * load.moment, (factor * load.force[0], factor * load.force[1]))
    x, y, angle, _, details = elastica.solve(body, part)
    s = nodes[:, 0]
    X, Y, theta = (np.interp(s, details["s"], values) for values in (x, y, angle))
    u = np.zeros_like(nodes)
    u[:, 0] = X - nodes[:, 1] * np.sin(theta) - s
    u[:, 1] = Y + nodes[:, 1] * (np.cos(theta) - 1.0)
    return u, np.array([x[-1] - body.length, y[-1], angle[-1]])


def _axis(solid: Solid, u: FloatArray, master: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Deformed neutral axis and rotation of the sections."""
    place, nodes = solid.lattice.place, solid.lattice.nodes
    here = nodes + u
    flat = np.ones(len(nodes), dtype=bool) if solid.d == 2 else place[:, 2] == 0
    x, y, angle = [], [], []
    for column in np.unique(place[:, 0]):
        held = np.flatnonzero(flat & (place[:, 0] == column))
        held = held[np.argsort(nodes[held, 1])]
        Y = nodes[held, 1]
        x.append(float(np.interp(0.0, Y, here[held, 0])))
        y.append(float(np.interp(0.0, Y, here[held, 1])))
        side = here[held[-1]] - here[held[0]]
        angle.append(np.arctan2(-side[0], side[1]))
    x[-1], y[-1] = solid.center[0] + master[0], master[1]
    slopes = np.unwrap(np.array(angle))
    slopes[-1] = master[2]
    return np.array(x), np.array(y), slopes


def _largest_strain(solid: Solid, u: FloatArray) -> float:
    """Largest Green strain along the body at the points of the elements."""
    H = np.einsum("emi,eqmj->eqij", u[solid.lattice.elements], solid.gradients, optimize=True)
    E = 0.5 * (H + H.swapaxes(-1, -2) + H.swapaxes(-1, -2) @ H)
    return float(np.abs(np.linalg.eigvalsh(E)).max())
