"""A truck rolls over a cable that hangs between two supports.

How deep does a truck of 2 t push a cable that weighs a third of it, and how does the cable answer when the
truck has gone? The cable, 204 m over a span of 200 m, hangs as an elastic catenary; two axles of 10 kN roll
along it at 36 km/h, and the deepest point rolls with them.

Checked: force, sag and the place of a parked truck against catenaries in closed form; momentum against the
reactions; the work of the truck against all energies, with a step and half of it.

    python examples/moving_truck.py
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pliant as pl
from _audit import Audited, audit, draw_energies
from _style import BLUE, GREY, INK, RED, new_figure, plain, save
from matplotlib.figure import Figure

SPEED, WHEELBASE = 10.0, 5.0
"""Of the truck [m/s], [m]."""


def run(**sizes: Any) -> Audited:
    """Let the truck roll over."""
    return audit(pl.scenes.bridge_catenary, speed=SPEED, wheelbase=WHEELBASE, **sizes)


def picture(crossing: Audited) -> Figure:
    """Draw the cable under the truck, the pull at the supports, the energies."""
    result = crossing.result
    cable = crossing.scene.model["cable"]
    figure = new_figure(11, 6.4)
    grid = figure.add_gridspec(2, 2, height_ratios=(1.1, 1))
    space = figure.add_subplot(grid[0, :])
    places = result.positions(cable)
    along = np.linspace(0, cable.length, places.shape[1])
    for moment in (0.0, 4.0, 8.0, 12.0, 16.0, 20.0):
        shape = places[np.searchsorted(result.time, moment)]
        begun = moment == 0.0
        space.plot(
            shape[:, 0], shape[:, 2], color=GREY if begun else BLUE, linewidth=1.6 if begun else 1.1, zorder=1
        )
        if begun:
            continue
        for front in (SPEED * moment, SPEED * moment - WHEELBASE):
            x, z = (np.interp(front, along, shape[:, k]) for k in (0, 2))
            space.plot(x, z, "o", color=RED, markersize=4, zorder=2)
        space.annotate(f"{moment:g} s", (x, z), xytext=(0, -16), textcoords="offset points", color=INK)
    space.set_ylim(places[..., 2].min() - 4, 2)
    plain(space, "x [m]", "z [m]", "The cable without the truck (grey) and under its two axles")

    pulls = figure.add_subplot(grid[1, 0])
    for joint, color, side in zip(crossing.scene.model.joints, (BLUE, RED), ("left", "right"), strict=True):
        force = np.linalg.norm(result.reaction(joint).force, axis=1)
        pulls.plot(result.time, force / 1e3, color=color, linewidth=0.9, label=f"{side} support")
    pulls.legend(frameon=False, fontsize=8.5)
    plain(pulls, "t [s]", "tension [kN]", "Pull at the supports")
    draw_energies(figure.add_subplot(grid[1, 1]), result, "What the truck's work becomes", "kJ", 1e3)
    return figure


def main() -> None:
    """Print what is checked, and leave a picture."""
    crossing = run()
    print(crossing.report())
    print(f"look at {save(picture(crossing), 'moving_truck')}")


if __name__ == "__main__":
    main()
