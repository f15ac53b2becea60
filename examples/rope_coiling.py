"""A rope let down onto the ground coils.

How large are the coils into which a rope lays itself? Fed slowly, its weight bends it, and the only length
made of the two is (EI/w)^(1/3), w the weight per length. The coils are a multiple of it, which grows a little
with the height: here from the equilibrium of a heavy line that comes down upright, and meets the ground along
the circle on which it lies, without twist and inertia. The rope of the run swings, rubs on the ground, and
climbs onto the turns that lie there already.

Checked: the angle laid against that theory; the momentum against weight, hand and ground; the distance of
the turns, which touch and do not pass through each other; the sum of energies.

    python examples/rope_coiling.py
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pliant as pl
from _audit import Audited, audit, draw_energies
from _style import BLUE, GREY, INK, RED, new_figure, plain, save, seen_from
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.figure import Figure

MASS = 0.014
"""Of the rope, per length [kg/m]."""
SIGHT = (-60, 22)
"""From where the rope is seen: azimuth and elevation [degrees]."""


def run(**sizes: Any) -> Audited:
    """Let the rope down."""
    return audit(pl.scenes.rope_coiling, mass=MASS, **sizes)


def draw_ground(axes: Axes, points: np.ndarray, beyond: float = 15.0, step: float = 20.0) -> None:
    """Draw a piece of the ground under points (n, 3), with a grid [mm]."""
    low, high = points[:, :2].min(axis=0) - beyond, points[:, :2].max(axis=0) + beyond
    corners = np.array([(low[0], low[1]), (high[0], low[1]), (high[0], high[1]), (low[0], high[1])])
    axes.fill(*seen_from(np.column_stack([corners, np.zeros(4)]), *SIGHT).T, color=GREY, alpha=0.25)
    for axis in (0, 1):
        for place in np.arange(np.ceil(low[axis] / step) * step, high[axis], step):
            line = np.zeros((2, 3))
            line[:, axis], line[:, 1 - axis] = place, (low[1 - axis], high[1 - axis])
            axes.plot(*seen_from(line, *SIGHT).T, color=GREY, linewidth=0.6, alpha=0.7)


def picture(coiled: Audited) -> Figure:
    """Draw the rope at the end and from above, the angle laid, the ground's force, the energies."""
    result, measured = coiled.result, coiled.measured
    rope = coiled.scene.model["rope"]
    lines = 1e3 * pl.scenes.centre_line(result, rope, [len(result.time) // 2, -1], pieces=4)
    figure = new_figure(11, 7.4)
    grid = figure.add_gridspec(2, 3, width_ratios=[0.6, 1, 1])
    space = figure.add_subplot(grid[:, 0])
    draw_ground(space, lines[-1])
    for points, shade in zip(lines, (0.65, 0.2), strict=True):
        space.plot(*seen_from(points, *SIGHT).T, color=colormaps["viridis"](shade), linewidth=1.8)
    space.set_aspect("equal")
    space.set_axis_off()
    space.set_title("Half way and at the end", fontsize=10.5, loc="left")

    above = figure.add_subplot(grid[0, 1])
    points = lines[-1]
    lies = points[:, 2] < 30
    above.plot(*points[lies, :2].T, color=BLUE, linewidth=4, alpha=0.55)
    above.plot(*points[lies, :2].T, color=INK, linewidth=0.6)
    above.set_aspect("equal")
    plain(above, "x [mm]", "y [mm]", "From above, as wide as it is")

    turns = figure.add_subplot(grid[0, 2])
    laid = np.asarray(measured["length laid"])
    turns.plot(1e3 * laid, np.asarray(measured["angle laid"]) / (2 * np.pi), color=BLUE, label="run")
    turns.plot(
        1e3 * laid,
        np.asarray(measured["angle of theory"]) / (2 * np.pi),
        color=INK,
        linewidth=1,
        label="theory",
    )
    turns.legend(frameon=False, fontsize=8.5)
    plain(turns, "length laid [mm]", "turns", "Laid as theory has it")

    ground = figure.add_subplot(grid[1, 1])
    force = result.contact_force(rope, "ground")[:, 2]
    ground.plot(result.time, force, color=GREY, linewidth=0.8, label="force on the ground")
    lying = np.pi * measured["first radius"] + laid
    ground.plot(result.time, 9.81 * MASS * lying, color=RED, linewidth=1.4, label="weight of what lies there")
    ground.legend(frameon=False, fontsize=8.5)
    ground.set_ylim(bottom=0, top=1.6 * 9.81 * MASS * lying.max())
    plain(ground, "t [s]", "N", "The ground bears more than lies on it")
    draw_energies(figure.add_subplot(grid[1, 2]), result, "Energies", unit="mJ", scale=1e-3)
    return figure


def main() -> None:
    """Print what is checked, and leave a picture."""
    coiled = run()
    print(coiled.report())
    print(f"look at {save(picture(coiled), 'rope_coiling')}")


if __name__ == "__main__":
    main()
