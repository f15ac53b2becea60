"""An end moment rolls a strip of shell elements up, once and twice around.

How many elements does each kind of shell take? The moment bends the strip everywhere alike, into an arc of
the curvature M/(EI). In the strains of the element, k = -h.n and E = (a.a - 1)/2, there is one thing more:
the strip gives way along its middle line by E = -(h kappa)^2/12, for k measures the turn of a stretched line.
With the stretch l = sqrt(1 + 2 E) the exact equilibrium is an arc that turns by kappa = M/(EI l^2) a length
of the flat strip. That arc, and not the circle, is what finer meshes come to; it differs from the circle by
(h kappa)^2/6 of the turn.

Checked: the order of convergence of each kind, once and twice around, down to the error of the statics.

    python examples/rolled_strip.py
"""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pliant as pl
from _style import AMBER, BLUE, GREEN, INK, RED, new_figure, plain, save, slope_triangle
from matplotlib.figure import Figure
from numpy.typing import NDArray
from scipy.optimize import brentq

Floats = NDArray[np.float64]

LENGTH, WIDTH, THICKNESS, YOUNG = 12.0, 1.0, 0.1, 1.2e6
KINDS = ("bicubic", "cylindrical", "plate", "triangle")
BENDING = YOUNG * THICKNESS**3 / 12
"""Bending stiffness for each width [N m]."""


@dataclass(frozen=True)
class Rolls:
    """Errors of the end, and the shapes of the strip with the most readable mesh."""

    elements: Sequence[int]
    turns: Sequence[int]
    errors: dict[tuple[str, int], list[float]]
    """Distance of the end from that of the exact arc [L], by kind and turns."""
    shapes: Floats
    """Nodes, (n, along, across, 3)."""
    factors: Floats
    """Moment over that of one turn."""

    def order(self, kind: str, turns: int) -> float:
        """Order of convergence between the two finest meshes."""
        errors, n = self.errors[kind, turns], self.elements
        return float(np.log(errors[-2] / errors[-1]) / np.log(n[-1] / n[-2]))


def arc(moment: float) -> tuple[float, float]:
    """Stretch, and turn for each length of the flat strip [1/m], under a moment for each width [N]."""

    def along(stretch: float) -> float:
        # The energy Eh E^2/2 + EI (l kappa)^2/2 - M kappa is stationary in kappa, and in l.
        turn = moment / (BENDING * stretch**2)
        return YOUNG * THICKNESS * (stretch**2 - 1) / 2 + BENDING * turn**2

    stretch = float(brentq(along, 0.9, 1.0, xtol=1e-15))
    return stretch, moment / (BENDING * stretch**2)


def exact_end(turns: float) -> Floats:
    """Place (x, z) of the end."""
    stretch, turn = arc(2 * np.pi * turns * BENDING / LENGTH)
    angle = turn * LENGTH
    return stretch / turn * np.array([np.sin(angle), 1 - np.cos(angle)])


def crossed(mesh: pl.Mesh) -> pl.Mesh:
    """Four triangles for each quadrilateral: mirrored in the middle of the strip, as the strip is."""
    corners = mesh.quads
    middles = len(mesh.points) + np.arange(len(corners))
    points = np.concatenate([mesh.points, mesh.points[corners].mean(axis=1)])
    sides = [np.stack([corners[:, k], corners[:, (k + 1) % 4], middles], axis=1) for k in range(4)]
    return pl.Mesh(points, triangles=np.concatenate(sides))


def across(elements: int) -> int:
    """Elements across the strip, so that they are about square: plates and triangles want that."""
    return max(1, round(elements * WIDTH / LENGTH))


def roll(kind: str, elements: int, turns: float, load_steps: int) -> tuple[pl.Result, pl.Shell]:
    """Roll a strip up."""
    model = pl.Model()
    material = pl.SaintVenantKirchhoff(youngs_modulus=YOUNG, poisson_ratio=0.0, density=1.0)
    mesh = pl.Mesh.rectangle(LENGTH, WIDTH, divisions=(elements, across(elements)))
    if kind == "triangle":
        mesh = crossed(mesh)
    strip = model.add_shell(mesh, thickness=THICKNESS, material=material, element=kind, name="strip")
    model.clamp(strip.edge([(0, 0, 0), (0, WIDTH, 0)]))
    # About the edge, which runs along y: against y it bends up.
    end = strip.edge([(LENGTH, 0, 0), (LENGTH, WIDTH, 0)])
    model.add_edge_moment(end, -2 * np.pi * turns * BENDING / LENGTH)
    with warnings.catch_warnings():
        # A roll gives way sideways in the end; the plane one is wanted.
        warnings.simplefilter("ignore", UserWarning)
        return pl.solve_static(model, load_steps=load_steps, stable=False), strip


def run(
    elements: Sequence[int] = (6, 12, 24, 48),
    kinds: Sequence[str] = KINDS,
    turns: Sequence[int] = (1, 2),
    shown: int = 48,
    load_steps: int = 8,
) -> Rolls:
    """Roll strips of each kind with several meshes."""
    errors: dict[tuple[str, int], list[float]] = {}
    for kind in kinds:
        for around in turns:
            exact = exact_end(around)
            for n in elements:
                result, strip = roll(kind, n, around, load_steps * around)
                end = result.track(strip.at((LENGTH, WIDTH / 2, 0))).position[-1, [0, 2]]
                errors.setdefault((kind, around), []).append(float(np.linalg.norm(end - exact)) / LENGTH)
    result, strip = roll("bicubic", shown, max(turns), load_steps * max(turns))
    places = result.positions(strip).reshape(len(result.load_factor), shown + 1, -1, 3)
    return Rolls(elements, turns, errors, places, max(turns) * result.load_factor)


def picture(rolls: Rolls) -> Figure:
    """Draw the strip as it rolls up, and the errors over the meshes."""
    from matplotlib import colormaps

    figure = new_figure(11.5, 4.8)
    grid = figure.add_gridspec(1, 2, width_ratios=(1.3, 1))
    space = figure.add_subplot(grid[0], projection="3d")
    flat = np.zeros((2, 2, 3))
    flat[1, :, 0], flat[:, 1, 1] = LENGTH, WIDTH
    chosen = [np.argmin(np.abs(rolls.factors - f)) for f in (0.25, 0.5, 1.0, 2.0)]
    for k, x in [(None, flat), *((k, rolls.shapes[k]) for k in chosen)]:
        factor = 0.0 if k is None else rolls.factors[k]
        color = colormaps["viridis"](0.85 * (factor / 2) ** 0.5)
        space.plot_surface(
            x[..., 0],
            x[..., 1],
            x[..., 2],
            color=color,
            alpha=0.75,
            edgecolor=color,
            linewidth=0.4,
            rcount=80,
            ccount=8,
            shade=False,
        )
        if k is not None:
            top = x[:, -1][np.argmax(x[:, -1, 2])]
            label = f"{factor:g} turn" + ("s" if factor > 1 else "")
            space.text(top[0], top[1], top[2] + 0.25, label, fontsize=9, color=INK, ha="center")
    space.set(xlim=(-3, 12.5), ylim=(0, 1), zlim=(0, 9))
    space.set_box_aspect((15.5, 1, 9), zoom=1.15)
    space.set_axis_off()
    space.view_init(elev=12, azim=-75)
    space.set_title("A strip under a growing end moment", fontsize=10.5, loc="left")

    axes = figure.add_subplot(grid[1])
    n = np.array(rolls.elements)
    looks = {
        "bicubic": (BLUE, "o"),
        "cylindrical": (RED, "x"),
        "plate": (GREEN, "s"),
        "triangle": (AMBER, "^"),
    }
    for (kind, turns), errors in rolls.errors.items():
        color, marker = looks[kind]
        style = "-" if turns == min(rolls.turns) else "--"
        label = f"{kind}, order {rolls.order(kind, turns):.1f}" if style == "-" else None
        axes.loglog(n, errors, marker + style, color=color, markersize=6, fillstyle="none", label=label)
    axes.loglog([], [], "k--", label="twice around")
    lowest = rolls.errors["bicubic", min(rolls.turns)]
    slope_triangle(axes, float(n[-2]) / 1.7, 0.25 * lowest[-2], -4)
    axes.set_xticks(n, [f"{k}" for k in n])
    axes.minorticks_off()
    axes.legend(frameon=False, fontsize=8.5)
    plain(axes, "elements along the strip", "distance of the end from the exact arc [L]", "Rolled up")
    return figure


def main() -> None:
    """Print the errors and leave a picture."""
    rolls = run()
    for (kind, turns), errors in rolls.errors.items():
        print(f"{kind:11s} {turns} around:", *(f"{error:9.2e}" for error in errors), end=" L, ")
        print(f"order {rolls.order(kind, turns):.2f}")
    print(f"end of the exact arc: {np.linalg.norm(exact_end(1)) / LENGTH:.1e} L from the clamp")
    print(f"look at {save(picture(rolls), 'rolled_strip')}")


if __name__ == "__main__":
    main()
