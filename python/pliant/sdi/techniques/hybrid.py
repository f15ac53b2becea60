"""Hybrid: an elastica between the notches, each of which is lumped into its equivalent flexure."""

from __future__ import annotations

from typing import Any

import numpy as np

from pliant import _check
from pliant.sdi.body import Body
from pliant.sdi.sampling import INSIDE
from pliant.sdi.techniques import Loading
from pliant.sdi.techniques.elastica import POINTS, Line, solve_line
from pliant.sdi.techniques.lumped import flexures
from pliant.typing import FloatArray

__all__ = ["solve"]


def solve(
    body: Body, load: Loading, *, coefficient: float | str = "integral", panels: int = 2
) -> tuple[FloatArray, FloatArray, FloatArray, int, dict[str, Any]]:
    """Bend a body whose notches are rigid but for a flexure each, and which bends as it is elsewhere.

    ``coefficient``: length of the flexure over that of its notch, or ``"integral"``.
    """
    if isinstance(coefficient, str):
        _check.choice(coefficient, "coefficient", ("integral",))
    else:
        coefficient = _check.number(coefficient, "coefficient", above=0, at_most=1)
    panels = _check.count(panels, "panels", at_most=400)
    springs = flexures(body, coefficient)
    edges = {b for b in body.breakpoints if not any(n.start < b < n.end for n in body.notches)}
    edges |= {e for n in body.notches for e in (n.start, n.end)}
    edges |= {e for f in springs for e in (f.start, f.start + f.length)}
    slack = 1e-9 * body.length
    breaks: list[float] = []
    for edge in sorted(edges):
        if slack < edge < body.length - slack and (not breaks or edge > breaks[-1] + slack):
            breaks.append(float(edge))
    line = Line(body.length, tuple(breaks), panels)
    inside = INSIDE * body.length
    s = np.clip(line.s, inside, body.length - inside)
    compliance = 1.0 / body.stiffness(s)
    for notch, f in zip(body.notches, springs, strict=True):
        compliance[(s > notch.start) & (s < notch.end)] = 0.0
        compliance[(s > f.start) & (s < f.start + f.length)] = 1.0 / f.k
    x, y, angle, _, details = solve_line(line, compliance, load)
    # A panel of constant or no compliance is one unknown; only panels outside notches need all their points.
    lumped = np.zeros(len(s), dtype=bool)
    for notch in body.notches:
        lumped |= (s > notch.start) & (s < notch.end)
    unknowns = int(np.count_nonzero(~lumped)) + len(springs)
    return x, y, angle, unknowns, {**details, "points_of_a_panel": POINTS}
