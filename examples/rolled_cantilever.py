"""An end moment rolls a clamped strip into a full circle.

Into what shapes, and how many elements does that take? The moment bends the strip everywhere alike: it
becomes an arc of the curvature M/(EI), and 2 pi EI/L closes it, its end back at the clamp. Nothing else in
bending is as large and as exactly known, and elements whose stretching and bending disagree lock in it: the
more, the thinner the strip.

Checked: the end meets the clamp with the error of a cubic element, order four in its length, however thin
the strip; 16 elements leave 9.8e-5 L, the figure of an independent implementation of this element with EA
L^2/(EI) = 1e4.

    python examples/rolled_cantilever.py
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pliant as pl
from _style import BLUE, GREEN, GREY, INK, RED, new_figure, plain, save, slope_triangle
from matplotlib.figure import Figure

LENGTH = 1.0
BENDING_STIFFNESS = 1.0
THICK, THIN = 1e4, 1e8
"""Axial stiffness EA L^2/(EI): strips of thickness L/29 and L/2900."""
PUBLISHED = 9.798536590218651e-05
"""Error of the end with 16 elements [L]."""


@dataclass(frozen=True)
class Rolling:
    """A strip at growing moments, and the error of its end at the full circle."""

    factors: np.ndarray
    """Moment over that of the full circle, (n,)."""
    shapes: np.ndarray
    """Nodes of the strip with the most readable mesh [m], (n, nodes, 3)."""
    elements: Sequence[int]
    errors: list[float]
    """Distance of the end from where it belongs, for these numbers of elements [L]."""
    thin: list[float]
    """The same for the thin strip."""
    locking: list[float]
    """The same for the thin strip with the axial energy integrated exactly."""

    @property
    def order(self) -> float:
        """Order of convergence between the two finest meshes."""
        fine, coarse = self.elements[-1], self.elements[-2]
        return float(np.log(self.errors[-2] / self.errors[-1]) / np.log(fine / coarse))


def arc(factor: float, at: np.ndarray) -> np.ndarray:
    """Exact places (n, 2) [m] of the arc lengths ``at`` when the end turned by ``factor`` times 2 pi."""
    curvature = 2 * np.pi * factor / LENGTH
    if curvature == 0.0:
        return np.stack([at, np.zeros_like(at)], axis=1)
    return np.stack([np.sin(curvature * at), 1 - np.cos(curvature * at)], axis=1) / curvature


def roll(
    elements: int, load_steps: int, axial_stiffness: float = THICK, integration: str = "lobatto"
) -> tuple[pl.Result, pl.Cable]:
    """Roll a strip of so many elements into a full circle."""
    model = pl.Model()
    strip = model.add_cable(
        [(0, 0, 0), (LENGTH, 0, 0)],
        elements=elements,
        section=pl.Section(
            area=axial_stiffness, second_moments=(BENDING_STIFFNESS, BENDING_STIFFNESS), torsion_constant=1.0
        ),
        material=pl.LinearElastic(youngs_modulus=1.0, poisson_ratio=0.3, density=1.0),
        integration=integration,
        name="strip",
    )
    model.clamp(strip.start)
    model.add_moment(strip.end, (0, 0, 2 * np.pi * BENDING_STIFFNESS / LENGTH))
    return pl.solve_static(model, load_steps=load_steps), strip


def run(elements: Sequence[int] = (4, 8, 16, 32, 64), shown: int = 16, load_steps: int = 12) -> Rolling:
    """Roll the strip up with several meshes; keep the shapes of the one with ``shown`` elements."""
    cases = ((THICK, "lobatto"), (THIN, "lobatto"), (THIN, "full"))
    errors = [[end_error(n, load_steps, *case) for n in elements] for case in cases]
    result, strip = roll(shown, load_steps)
    return Rolling(result.load_factor, result.positions(strip), elements, *errors)


def end_error(elements: int, load_steps: int, axial_stiffness: float, integration: str) -> float:
    """Distance of the end from where it belongs at the full circle [L]."""
    result, strip = roll(elements, load_steps, axial_stiffness, integration)
    gap = result.track(strip.end).position[-1, :2] - arc(1.0, np.array([LENGTH]))[0]
    return float(np.linalg.norm(gap)) / LENGTH


def picture(rolling: Rolling) -> Figure:
    """Draw the shapes over the exact arcs, and the errors over the meshes."""
    from matplotlib import colormaps

    figure = new_figure(11, 4.6)
    shapes, errors = figure.subplots(1, 2, width_ratios=(1.15, 1))
    along = np.linspace(0, LENGTH, 400)
    for factor, nodes in zip(rolling.factors, rolling.shapes, strict=True):
        shapes.plot(*arc(float(factor), along).T, color=GREY, linewidth=1.0, zorder=1)
        color = colormaps["viridis"](0.9 * factor)
        shapes.plot(nodes[:, 0], nodes[:, 1], "o", color=color, markersize=3.6, zorder=2)
    for factor, place in ((1 / 4, (0.66, 0.66)), (1 / 2, (0.02, 0.655)), (1.0, (-0.075, 0.225))):
        shapes.annotate(f"{factor:g} turn", place, color=INK, fontsize=9)
    shapes.plot([0, 0], [-0.09, 0.09], color=INK, linewidth=4, solid_capstyle="butt")
    shapes.set_aspect("equal")
    nodes = len(rolling.shapes[0])
    title = f"A strip rolls up: nodes of {nodes - 1} elements on the exact arcs"
    plain(shapes, "x [L]", "y [L]", title)

    n = np.array(rolling.elements)
    label = f"axial energy exact, thickness L/{np.sqrt(THIN / 12):.0f}: locks"
    errors.loglog(n, rolling.locking, "s--", color=RED, markersize=4.5, label=label)
    label = f"Lobatto rule (default), thickness L/{np.sqrt(THIN / 12):.0f}"
    errors.loglog(n, rolling.thin, "o", color=GREEN, markersize=9, fillstyle="none", label=label)
    label = f"Lobatto rule (default), thickness L/{np.sqrt(THICK / 12):.0f}"
    errors.loglog(n, rolling.errors, "o-", color=BLUE, markersize=5, label=label)
    errors.loglog(16, PUBLISHED, "x", color=INK, markersize=10, label="independent implementation")
    slope_triangle(errors, float(n[-2]) / 2.6, 1.2 * rolling.errors[-2], -4)
    errors.set_xticks(n, [f"{k}" for k in n])
    errors.minorticks_off()
    errors.set_ylim(top=50)
    errors.legend(frameon=False, fontsize=8.5)
    plain(errors, "elements", "error of the end [L]", f"Full circle: order {rolling.order:.2f}")
    return figure


def main() -> None:
    """Print the errors and leave a picture."""
    rolling = run()
    print(
        "distance of the end from the clamp [L]: thick, thin, thin with the axial energy integrated exactly"
    )
    for n, *errors in zip(rolling.elements, rolling.errors, rolling.thin, rolling.locking, strict=True):
        print(f"{n:3d} elements:", *(f"{error:9.2e}" for error in errors))
    print(f"order {rolling.order:.3f}; independent implementation, 16 elements: {PUBLISHED:.2e} L")
    print(f"look at {save(picture(rolling), 'rolled_cantilever')}")


if __name__ == "__main__":
    main()
