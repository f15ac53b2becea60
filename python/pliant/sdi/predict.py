"""Errors of the techniques, predicted without finite elements.

A solid is softer than its beam where its outline is steep and where it is strained:

    k_solid = k / (1 + a (h'/2)^2 + b (kappa h/2)^2)

The elastica of k_solid stands in for the finite elements. a and b were fitted to the elastica's error on 46
bodies with a cosine notch (docs/theory/sdi.md), and hold on the others: a reconstruction of none of the
published equations.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from pliant.errors import ConvergenceError, ModelError
from pliant.sdi.body import Body
from pliant.sdi.sampling import INSIDE
from pliant.sdi.techniques import Loading, Shape, bend, elastica
from pliant.sdi.techniques.matrix import sampled
from pliant.typing import FloatArray

__all__ = ["Measures", "measures", "predicted_errors", "solid_elastica"]

STEEP = 1.13
"""a, compliance that the slope of the outline adds."""
STRAINED = 2.31
"""b, compliance that the strain of the surface adds."""
STEEPEST = 1.0
"""(h'/2)^2 is cut here: beyond 45 degrees the flanks of a notch carry nothing more."""
PANELS = 24


@dataclass(frozen=True)
class Measures:
    """What quadratures over a bent body tell about the assumptions of the techniques.

    Attributes
    ----------
    outside : float
        Part of the bending outside the notches: 1 - int_notches |kappa| / int |kappa|. What a lumped model
        leaves out.
    coarse : float
        |sum l_e kappa_e / int kappa - 1| of six elements of the stiffness in their middles: what such a mesh
        misses.
    steepness : float
        Mean (h'/2)^2, weighted by the curvature: what plane sections leave out.
    strain : float
        Largest strain of the surface, kappa h/2.
    """

    outside: float
    coarse: float
    steepness: float
    strain: float


def _state(body: Body, load: Loading) -> tuple[elastica.Line, FloatArray, FloatArray, FloatArray]:
    """Line, curvature, (h'/2)^2 and half height at its points."""
    line = elastica.Line(body.length, body.breakpoints, PANELS)
    inside = INSIDE * body.length
    s = np.clip(line.s, inside, body.length - inside)
    *_, details = elastica.solve_line(line, 1.0 / body.stiffness(s), load)
    half = body.half_height(s)
    slope = np.zeros(len(s))
    if body.sections is not None:
        # Differences that stay on their side of every break.
        edges = np.array([0.0, *body.breakpoints, body.length])
        piece = np.clip(np.searchsorted(edges, s, side="right") - 1, 0, len(edges) - 2)
        step = 1e-6 * body.length
        low = np.maximum(s - step, edges[piece] + inside)
        high = np.minimum(s + step, edges[piece + 1] - inside)
        slope = (body.half_height(high) - body.half_height(low)) / (high - low)
    return line, details["curvature"], np.minimum(slope**2, STEEPEST), half


def solid_elastica(body: Body, load: Loading) -> tuple[float, float]:
    """End of the elastica that stands in for the solid [m]."""
    line, kappa, steep, half = _state(body, load)
    inside = INSIDE * body.length
    s = np.clip(line.s, inside, body.length - inside)
    compliance = (1.0 + STEEP * steep + STRAINED * (kappa * half) ** 2) / body.stiffness(s)
    x, y, *_ = elastica.solve_line(line, compliance, load)
    return float(x[-1]), float(y[-1])


def measures(body: Body, load: Loading) -> Measures:
    """Compute what quadratures tell."""
    line, kappa, steep, half = _state(body, load)
    size = np.abs(kappa)
    total = float(line.weights @ size)
    if total == 0.0:
        return Measures(0.0, 0.0, 0.0, 0.0)
    lumped = np.zeros(len(line.s), dtype=bool)
    for notch in body.notches:
        lumped |= (line.s > notch.start) & (line.s < notch.end)
    nodes = np.linspace(0.0, body.length, 7)
    soft = sampled(body, nodes, "harmonic") / sampled(body, nodes, "mid")
    within = np.searchsorted(nodes, line.s, side="right") - 1
    rotation = np.bincount(within, line.weights * size, 6)
    return Measures(
        outside=1.0 - float(line.weights[lumped] @ size[lumped]) / total,
        coarse=abs(float(soft @ rotation) / total - 1.0),
        steepness=float(line.weights @ (size * steep)) / total,
        strain=float((size * half).max()),
    )


def predicted_errors(
    body: Body, load: Loading, techniques: list[str], options: dict[str, dict[str, Any]]
) -> dict[str, tuple[float, Shape | None, str]]:
    """Predict the error of each technique: (error, its shape if it was cheap to compute, why it cannot)."""
    end = solid_elastica(body, load)
    moved = float(np.hypot(end[0] - body.length, end[1]))
    if moved == 0.0:
        raise ModelError("moment, force: the body does not move; give a load")
    found: dict[str, tuple[float, Shape | None, str]] = {}
    for name in techniques:
        if name == "finite_element":
            found[name] = (0.0, None, "")
            continue
        # The engine's cable converges to the elastica: no need to run it.
        standing_in = "elastica" if name == "ancf" else name
        try:
            shape = bend(
                body,
                moment=load.moment,
                force=load.force,
                technique=standing_in,
                **({} if name == "ancf" else options.get(name, {})),
            )
        except (ModelError, ConvergenceError) as failure:
            found[name] = (float("inf"), None, str(failure))
            continue
        error = float(np.hypot(shape.tip[0] - end[0], shape.tip[1] - end[1])) / moved
        found[name] = (error, None if name == "ancf" else shape, "")
    return found
