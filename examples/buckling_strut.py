"""A clamped strut buckles: a bifurcation, and what imperfections make of it.

How much does a slender strut carry, and what happens beyond? Straight, it is in equilibrium under any
load; from Euler's load pi^2 EI/(4 L^2) on it is unstable, and a bent shape branches off, the elastica. Real
struts are pushed a little to one side: their paths of load and deflection bend smoothly over to the elastica.
The path is followed by arc length, the push to the side stays the same (``scale``).

Checked: the bifurcation lies at Euler's load and 2.5e-6 above, for the strut is shorter when it buckles; the
strut pushed least meets Euler's elastica, in elliptic integrals, at one and a half times the load with an
error of 1e-6 L.

    python examples/buckling_strut.py
"""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pliant as pl
from _style import AMBER, BLUE, GREEN, GREY, INK, RED, new_figure, plain, save
from matplotlib.figure import Figure
from scipy.optimize import brentq
from scipy.special import ellipe, ellipk

EULER = np.pi**2 / 4
"""Critical load of the clamped strut, EI = L = 1."""
HIGHEST = 1.5
"""Full load over Euler's."""
AXIAL_STIFFNESS = 1e6


@dataclass(frozen=True)
class Buckling:
    """The straight strut, and struts pushed to the side."""

    critical: float
    """Load of the bifurcation over Euler's."""
    pushes: Sequence[float]
    """Forces to the side over Euler's load."""
    loads: list[np.ndarray]
    """Load over Euler's along each path, each (n,)."""
    tips: list[np.ndarray]
    """Places of the end along each path [L], each (n, 3)."""
    shapes: np.ndarray
    """Nodes along the path of the strut pushed least [L], (n, nodes, 3)."""

    @property
    def error(self) -> float:
        """Distance of the end of the strut pushed least from the elastica's at the full load [L]."""
        return float(np.linalg.norm(self.tips[-1][-1, :2] - elastica(HIGHEST)))


def elastica(load: float) -> np.ndarray:
    """End (2,) [L] of Euler's elastica under so many times the critical load, from (2 K(k)/pi)^2 = load."""
    if load <= 1.0:
        return np.array([1.0, 0.0])
    k = brentq(lambda k: (2 * ellipk(k**2) / np.pi) ** 2 - load, 1e-9, 1 - 1e-12)
    return np.array([2 * ellipe(k**2) / ellipk(k**2) - 1, 2 * k / ellipk(k**2)])


def strut(elements: int, push: float) -> tuple[pl.Model, pl.Cable, pl.Load]:
    """Make a strut along x, pressed at its end, and pushed to the side there."""
    model = pl.Model()
    section = pl.Section(area=AXIAL_STIFFNESS, second_moments=(1.0, 1.0), torsion_constant=1.0)
    material = pl.LinearElastic(youngs_modulus=1.0, poisson_ratio=0.3, density=1 / AXIAL_STIFFNESS)
    body = model.add_cable([(0, 0, 0), (1, 0, 0)], elements=elements, section=section, material=material)
    model.clamp(body.start)
    press = model.add_force(body.end, (-HIGHEST * EULER, 0, 0))
    if push:
        model.add_force(body.end, (0, push * EULER, 0))
    return model, body, press


def run(elements: int = 20, pushes: Sequence[float] = (3e-2, 1e-2, 1e-3, 1e-6)) -> Buckling:
    """Follow the straight strut and those pushed to the side up to the full load."""
    model, body, _ = strut(elements, 0.0)
    with warnings.catch_warnings():
        # The straight strut stays straight; that it is unstable in the end is the point.
        warnings.simplefilter("ignore")
        straight = pl.solve_static(model, arc_length=True)
    critical = HIGHEST * straight.critical_points[0].load_factor
    loads, tips = [], []
    for push in pushes:
        model, body, press = strut(elements, push)
        path = pl.solve_static(model, arc_length=True, scale=press, load_steps=40)
        loads.append(HIGHEST * path.load_factor)
        tips.append(path.track(body.end).position)
    return Buckling(critical, pushes, loads, tips, path.positions(body))


def picture(buckling: Buckling) -> Figure:
    """Draw load over deflection, and the shapes."""
    figure = new_figure(11, 4.6)
    path, shapes = figure.subplots(1, 2, width_ratios=(1.2, 1))
    exact = np.array([[*elastica(load), load] for load in 1 + (HIGHEST - 1) * np.linspace(0, 1, 200) ** 2])
    path.plot(exact[:, 1], exact[:, 2], color=GREY, linewidth=5, alpha=0.6, label="Euler's elastica")
    path.plot([0, 0], [0, 1], color=INK, linewidth=1.5)
    path.plot(
        [0, 0], [1, HIGHEST], color=INK, linewidth=1.5, linestyle=":", label="straight, unstable above 1"
    )
    path.plot(0, buckling.critical, "o", color=INK, markersize=6)
    for push, loads, tips, color in zip(
        buckling.pushes, buckling.loads, buckling.tips, (RED, AMBER, GREEN, BLUE), strict=False
    ):
        path.plot(
            tips[:, 1], loads, ".-", color=color, linewidth=1, markersize=4, label=f"pushed by {push:g}"
        )
    path.set_xlim(-0.02, 0.85)
    path.set_ylim(0, 1.08 * HIGHEST)
    path.legend(frameon=False, fontsize=8.5, loc="lower right")
    plain(path, "deflection of the end [L]", "load / Euler's load", "A bifurcation, and imperfect struts")

    bent = [k for k in range(len(buckling.shapes)) if buckling.tips[-1][k, 1] > 1e-3]
    places = np.linspace(0, buckling.tips[-1][-1, 1], 9)
    chosen = sorted({0, *(min(bent, key=lambda k: abs(buckling.tips[-1][k, 1] - y)) for y in places[1:])})
    for k in chosen:
        nodes = buckling.shapes[k]
        shapes.plot(
            nodes[:, 1], nodes[:, 0], "-", color=BLUE, linewidth=1.6, alpha=0.25 + 0.75 * k / chosen[-1]
        )
        shapes.plot(nodes[-1, 1], nodes[-1, 0], "o", color=INK, markersize=3)
    shapes.plot([-0.06, 0.06], [0, 0], color=INK, linewidth=4, solid_capstyle="butt")
    shapes.set_aspect("equal")
    plain(shapes, "y [L]", "x [L]", f"Shapes up to {HIGHEST:g} times Euler's load")
    return figure


def main() -> None:
    """Print the loads and the error, and leave a picture."""
    buckling = run()
    print(f"bifurcation at {buckling.critical:.7f} of Euler's load")
    for push, tips in zip(buckling.pushes, buckling.tips, strict=True):
        print(
            f"pushed by {push:7.0e}: {len(tips):3d} points, end at ({tips[-1, 0]:.5f}, {tips[-1, 1]:.5f}) L"
        )
    x, y = elastica(HIGHEST)
    print(f"elastica:               end at ({x:.5f}, {y:.5f}) L; error {buckling.error:.1e} L")
    print(f"look at {save(picture(buckling), 'buckling_strut')}")


if __name__ == "__main__":
    main()
