r"""Elastica: an inextensible line whose curvature is the bending moment over the stiffness.

    x' = cos theta,  y' = sin theta,  theta' = m / k(s),  m = M + F_y (x_L - x) - F_x (y_L - y)

An end moment alone leaves a quadrature. With an end force the slope obeys an integral equation, solved by
Newton's method for its values at Gauss points: with S the integrals from 0 to each point, T those from each
point to L,

    theta = S [(M + F_y T x' - F_x T y') / k].

With shear, r' = t + gamma n, gamma = V / (kappa G A), V = F . n.
"""

from __future__ import annotations

import itertools
import warnings
from functools import cache
from typing import Any

import numpy as np

from pliant import _check
from pliant.errors import ConvergenceError, ModelError
from pliant.sdi.body import Body
from pliant.sdi.sampling import INSIDE, Along
from pliant.sdi.techniques import Loading
from pliant.typing import FloatArray

__all__ = ["Line", "solve", "solve_line"]

POINTS = 6
"""Gauss points of a panel."""


@cache
def _rule(points: int) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Gauss points and weights on [0, 1], and the integrals from 0 to each point of what they interpolate."""
    z, w = np.polynomial.legendre.leggauss(points)
    powers = np.arange(points)
    vandermonde = np.polynomial.legendre.legvander(z, points - 1)
    integrals = np.stack(
        [
            np.polynomial.legendre.legval(z, np.polynomial.legendre.legint(np.eye(points)[p], lbnd=-1))
            for p in powers
        ],
        axis=1,
    )
    return 0.5 + 0.5 * z, 0.5 * w, 0.5 * integrals @ np.linalg.inv(vandermonde)


class Line:
    """Panels of Gauss points between breaks, finer towards them, and integrals over them."""

    def __init__(self, length: float, breaks: tuple[float, ...], panels: int) -> None:
        z, w, inner = _rule(POINTS)
        edges = np.array([0.0, *breaks, length])
        share = 0.5 - 0.5 * np.cos(np.pi * np.arange(panels + 1) / panels)
        ends = np.concatenate([a + (b - a) * share[:-1] for a, b in itertools.pairwise(edges)])
        self.ends = np.append(ends, length)
        self.widths = np.diff(self.ends)
        self.s = (self.ends[:-1, None] + self.widths[:, None] * z).ravel()
        self.weights = (self.widths[:, None] * w).ravel()
        self._inner = inner

    def integral(self, values: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Integrals from 0 to each point and to each end of a panel."""
        panels = values.reshape(-1, POINTS)
        whole = np.concatenate([[0.0], np.cumsum((self.weights * values).reshape(-1, POINTS).sum(axis=1))])
        inside = self.widths[:, None] * (panels @ self._inner.T)
        return (whole[:-1, None] + inside).ravel(), whole

    def onward(self, values: FloatArray) -> FloatArray:
        """Integrals from each point to the end."""
        inner, ends = self.integral(values)
        rest: FloatArray = ends[-1] - inner
        return rest


def solve(
    body: Body, load: Loading, *, panels: int = 12, shear: bool = False
) -> tuple[FloatArray, FloatArray, FloatArray, int, dict[str, Any]]:
    """Bend a body as an elastica; ``shear`` adds the compliance of its sections in shear."""
    give: Along | None = None
    if _check.flag(shear, "shear"):
        sections = body.sections
        if sections is None:
            raise ModelError(
                "shear: the body's cross sections are not known; make it with them, or shear=False"
            )

        def give(s: FloatArray) -> FloatArray:
            return 1.0 / sections.shear_stiffness(s)

    panels = _check.count(panels, "panels", at_most=400)
    line = Line(body.length, body.breakpoints, panels)
    inside = INSIDE * body.length
    places = np.clip(line.s, inside, body.length - inside)
    compliance = 1.0 / body.stiffness(places)
    return solve_line(line, compliance, load, None if give is None else give(places))


def solve_line(
    line: Line, compliance: FloatArray, load: Loading, shear_compliance: FloatArray | None = None
) -> tuple[FloatArray, FloatArray, FloatArray, int, dict[str, Any]]:
    """Bend a line of given compliance 1/k at its points; 0 is rigid."""
    Fx, Fy = load.force
    n = len(line.s)
    if Fx == 0.0 and Fy == 0.0:
        theta, ends = line.integral(load.moment * compliance)
    else:
        theta = _shoot(line, compliance, load, shear_compliance)
        if shear_compliance is None and not _stable(line, theta, compliance, load):
            warnings.warn(
                "elastica: this equilibrium is unstable, the force is above that of buckling; a small moment "
                "or inclination of the force leads to the stable one",
                RuntimeWarning,
                stacklevel=4,
            )
        _, ends = line.integral(_curvature(line, theta, compliance, load, shear_compliance))
    dx, dy = _tangent(theta, load, shear_compliance)[:2]
    (x, x_ends), (y, y_ends) = line.integral(dx), line.integral(dy)
    order = np.argsort(np.concatenate([line.s, line.ends]), kind="stable")

    def pick(inner: FloatArray, outer: FloatArray) -> FloatArray:
        return np.concatenate([inner, outer])[order]

    moment = _moment(line, theta, load, shear_compliance)
    details = {
        "s": pick(line.s, line.ends),
        "points": line.s,
        "weights": line.weights,
        "curvature": moment * compliance,
    }
    return pick(x, x_ends), pick(y, y_ends), pick(theta, ends), n, details


def _tangent(
    theta: FloatArray, load: Loading, shear: FloatArray | None
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Return x', y' and their derivatives by theta."""
    c, s = np.cos(theta), np.sin(theta)
    if shear is None:
        return c, s, -s, c
    Fx, Fy = load.force
    gamma, rate = shear * (Fy * c - Fx * s), shear * (-Fy * s - Fx * c)
    return c - gamma * s, s + gamma * c, -s - gamma * c - rate * s, c - gamma * s + rate * c


def _moment(line: Line, theta: FloatArray, load: Loading, shear: FloatArray | None) -> FloatArray:
    """Bending moment at the points [N m]."""
    Fx, Fy = load.force
    dx, dy = _tangent(theta, load, shear)[:2]
    (x, x_ends), (y, y_ends) = line.integral(dx), line.integral(dy)
    moment: FloatArray = load.moment + Fy * (x_ends[-1] - x) - Fx * (y_ends[-1] - y)
    return moment


def _curvature(
    line: Line, theta: FloatArray, compliance: FloatArray, load: Loading, shear: FloatArray | None
) -> FloatArray:
    return compliance * _moment(line, theta, load, shear)


def _stable(line: Line, theta: FloatArray, compliance: FloatArray, load: Loading) -> bool:
    """Tell whether the second variation int k phi'^2 + (F . t) phi^2 ds is positive: Jacobi's criterion.

    The solution of (k phi')' = (F . t) phi with phi = 1, phi' = 0 at the free end must have no zero.
    """
    Fx, Fy = load.force
    pull = Fx * np.cos(theta) + Fy * np.sin(theta)
    phi, bend = 1.0, 0.0
    for h, c, p in zip(
        line.weights[::-1].tolist(), compliance[::-1].tolist(), pull[::-1].tolist(), strict=True
    ):
        bend -= 0.5 * h * p * phi
        phi -= h * c * bend
        bend -= 0.5 * h * p * phi
        if phi <= 0.0:
            return False
    return True


def _shoot(line: Line, compliance: FloatArray, load: Loading, shear: FloatArray | None) -> FloatArray:
    """Slope at the points, by Newton's method along a growing load."""
    from scipy.sparse.linalg import LinearOperator, gmres

    n = len(line.s)
    theta = np.zeros(n)
    reached, step = 0.0, 0.5
    before = theta
    while reached < 1.0:
        factor = min(1.0, reached + step)
        now = Loading(factor * load.moment, (factor * load.force[0], factor * load.force[1]))
        Fx, Fy = now.force
        # The last two equilibria foretell the next.
        guess = theta + (theta - before) if reached > 0 else theta
        residuals: list[float] = []
        for _ in range(25):
            dx, dy, ddx, ddy = _tangent(guess, now, shear)
            moment = now.moment + line.onward(Fy * dx - Fx * dy)
            residual = guess - line.integral(compliance * moment)[0]
            residuals.append(float(np.abs(residual).max()))
            slope = Fy * ddx - Fx * ddy

            # The operator is the identity plus a compact one: a few iterations solve it.
            def tangent(v: FloatArray, slope: FloatArray = slope) -> FloatArray:
                return v - line.integral(compliance * line.onward(slope * v))[0]

            operator = LinearOperator((n, n), matvec=tangent, dtype=np.float64)
            step_of_theta, _ = gmres(operator, residual, rtol=1e-10, restart=60, maxiter=5)
            guess = guess - step_of_theta
            if residuals[-1] < 1e-10 or not np.isfinite(residuals[-1]) or residuals[-1] > 1e3:
                break
        if residuals[-1] < 1e-8:
            before, theta, reached = theta, guess, factor
            step = min(1.0 - reached, 1.5 * step) or step
        else:
            step *= 0.4
            if step < 1e-4:
                raise ConvergenceError(
                    f"elastica: no equilibrium found beyond {reached:.3g} of the load; the force may be "
                    "above "
                    "that of buckling",
                    time=reached,
                    step=step,
                    residuals=residuals,
                )
    return theta
