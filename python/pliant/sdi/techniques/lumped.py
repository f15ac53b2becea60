"""Lumped parameters: each notch is a flexure of length l and stiffness k_min, the rest is rigid.

    l = c w,   c = k_min / w  int_notch ds / k   (or a published number)
    theta = M l / k + F_n l^2 / (2 k),   v = M l^2 / (2 k) + F_n l^3 / (3 k)

with the moment M and the transverse force F_n at the far end of the flexure, in the frame of its near end.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from pliant import _check
from pliant.errors import ConvergenceError, ModelError
from pliant.sdi.body import Body, Notch
from pliant.sdi.techniques import Loading
from pliant.sdi.techniques.elastica import Line
from pliant.typing import FloatArray

__all__ = ["Flexure", "flexures", "integrate", "solve"]


class Flexure:
    """The equivalent flexure of a notch: centred on it, ``length`` long, of stiffness ``k``."""

    def __init__(self, start: float, length: float, k: float) -> None:
        self.start, self.length, self.k = start, length, k

    def displaced(self, moment: float, force: float, kind: str) -> tuple[float, float, float]:
        """Displacement of the far end along and across [m], and its rotation."""
        span, k = self.length, self.k
        theta = moment * span / k + force * span**2 / (2 * k)
        if kind == "pivot":
            return 0.5 * span * (1 + np.cos(theta)), 0.5 * span * np.sin(theta), theta
        if kind == "arc":
            half = 0.5 * theta
            chord = span * float(np.sinc(half / np.pi))
            return chord * np.cos(half), chord * np.sin(half), theta
        slope = np.arctan(moment * span / (2 * k) + force * span**2 / (3 * k))
        return span * np.cos(slope), span * np.sin(slope), theta


def integrate(body: Body, start: float, end: float, panels: int = 8) -> float:
    """Integral of 1/k from start to end [1/(N m)]."""
    breaks = tuple(b - start for b in body.breakpoints if start < b < end)
    line = Line(end - start, breaks, panels)
    return float(line.weights @ (1.0 / body.stiffness(np.clip(start + line.s, 0.0, body.length))))


def lowest(body: Body, notch: Notch) -> float:
    """Lowest stiffness inside a notch [N m^2]."""
    x, k = body.samples.x, body.samples.value
    slack = 1e-12 * body.length
    inside = (x > notch.start - slack) & (x < notch.end + slack)
    places = np.linspace(notch.start, notch.end, 129)[1:-1]
    return float(min(k[inside].min(initial=np.inf), body.stiffness(places).min()))


def flexures(body: Body, coefficient: float | str | None) -> list[Flexure]:
    """Return the equivalent flexures of a body's notches; None takes the published coefficients."""
    if not body.notches:
        raise ModelError(
            f"body = {body.name}: has no notch to lump; take another technique, or a Body with "
            "notches=[(a, b)]"
        )
    found = []
    for notch in body.notches:
        w, k = notch.end - notch.start, lowest(body, notch)
        c = coefficient if coefficient is not None else notch.coefficient
        span = k * integrate(body, notch.start, notch.end) if c is None or isinstance(c, str) else c * w
        found.append(Flexure(0.5 * (notch.start + notch.end - span), span, k))
    return found


def solve(
    body: Body,
    load: Loading,
    *,
    variant: str = "consistent",
    coefficient: float | str | None = None,
    flexure: str | None = None,
    equilibrium: bool | None = None,
) -> tuple[FloatArray, FloatArray, FloatArray, int, dict[str, Any]]:
    """Bend a chain of rigid links and flexures.

    ``variant="paper"``: published coefficients, chords, moments of the undeformed body; ``"consistent"``:
    integral coefficients, arcs, equilibrium of the deformed chain. The other options overrule it.
    """
    paper = _check.choice(variant, "variant", ("consistent", "paper")) == "paper"
    kind = _check.choice(flexure or ("chord" if paper else "arc"), "flexure", ("arc", "chord", "pivot"))
    deformed = (not paper) if equilibrium is None else _check.flag(equilibrium, "equilibrium")
    if isinstance(coefficient, str):
        _check.choice(coefficient, "coefficient", ("integral",))
    elif coefficient is not None:
        coefficient = _check.number(coefficient, "coefficient", above=0, at_most=1)
    elif not paper:
        coefficient = "integral"
    springs = flexures(body, coefficient)
    x, y, angle = chain(body.length, springs, load, kind, deformed)
    details = {"flexures": [(f.start, f.length, f.k) for f in springs]}
    return x, y, angle, len(springs), details


def chain(
    length: float, springs: list[Flexure], load: Loading, kind: str, deformed: bool
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Place the corners of a chain in equilibrium."""
    F = np.array(load.force)
    far = np.array([f.start + f.length for f in springs])
    moments = load.moment + F[1] * (length - far)

    def place(m: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        r, phi, s = np.zeros(2), 0.0, 0.0
        points, slopes, ends = [r], [0.0], []
        for f, moment in zip(springs, m, strict=True):
            t = np.array([np.cos(phi), np.sin(phi)])
            r = r + (f.start - s) * t
            # Undeformed: the transverse force is that on the straight body.
            normal = float(F @ (-t[1], t[0])) if deformed else F[1]
            along, across, turn = f.displaced(float(moment), normal, kind)
            points.append(r)
            slopes.append(phi)
            r = r + along * t + across * np.array([-t[1], t[0]])
            phi += turn
            s = f.start + f.length
            points.append(r)
            slopes.append(phi)
            ends.append(r)
        points.append(r + (length - s) * np.array([np.cos(phi), np.sin(phi)]))
        slopes.append(phi)
        return np.array(points), np.array(slopes), np.array(ends)

    if deformed and F.any():
        from scipy.optimize import root

        def out_of_balance(factor: float, m: FloatArray) -> FloatArray:
            points, _, ends = place(m)
            arm = points[-1] - ends
            balance: FloatArray = m - factor * load.moment - factor * (arm[:, 0] * F[1] - arm[:, 1] * F[0])
            return balance

        full = F
        for factor in (0.25, 0.5, 0.75, 1.0):
            F = factor * full
            found = root(
                lambda m: out_of_balance(1.0, m) + (1.0 - factor) * load.moment,  # noqa: B023
                factor * moments,
                tol=1e-13 * max(float(np.abs(moments).max()), 1e-300),
            )
            moments = found.x / factor
        if np.abs(found.fun).max() > 1e-7 * max(float(np.abs(moments).max()), 1e-300):
            raise ConvergenceError(f"lumped: no equilibrium of the chain found ({found.message})")
    points, slopes, _ = place(moments)
    return points[:, 0], points[:, 1], slopes
