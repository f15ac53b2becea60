"""A plucked cable slaps a post.

When does a cable, plucked aside and let go, strike a post behind its middle, and how hard? The kinks of the
pluck travel to both sides; as they pass the middle it moves with constant speed, strikes, and lies on the
post until waves from the ends take it away. A string does not rebound of its own: what the post gives back is
a kink that runs off.

Checked: the lowest frequency, the arrival and the impulse against d'Alembert's waves with the post's force as
their source; momentum; the sum of energies.

    python examples/cable_slap.py
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pliant as pl
from _audit import Audited, audit, draw_energies
from _style import BLUE, GREY, INK, RED, new_figure, plain, save
from matplotlib.figure import Figure

GAP = 0.02
"""Between the cable at rest and the post [m]."""


def run(**sizes: Any) -> Audited:
    """Let the cable go."""
    return audit(pl.scenes.cable_slap, gap=GAP, **sizes)


def picture(slap: Audited) -> Figure:
    """Draw the cable at times, its middle and the post's impulse, the energies."""
    result = slap.result
    cable = slap.scene.model["cable"]
    figure = new_figure(11, 6.6)
    grid = figure.add_gridspec(2, 2)
    space = figure.add_subplot(grid[0, :])
    places = result.positions(cable)
    moments = {0.0: GREY, 0.05: "#9ecae1", 0.1: "#6baed6", 0.14: RED, 0.2: "#3182bd", 0.26: INK}
    for moment, color in moments.items():
        shape = places[min(np.searchsorted(result.time, moment - 1e-9), len(places) - 1)]
        space.plot(shape[:, 0], shape[:, 1], color=color, linewidth=1.4, label=f"{1e3 * moment:g} ms")
    space.plot(6.0, -GAP - 0.006, "v", color=INK, markersize=9)
    space.legend(frameon=False, fontsize=8.5, ncols=6, loc="upper right")
    space.set_ylim(top=0.4)
    plain(space, "x [m]", "y [m]", "A plucked cable and a post (triangle); it lies on the post at 140 ms")

    speed = np.sqrt(200.0 / 0.06)
    fine = np.linspace(0, result.time[-1], 9001)
    way, pushed = pl.scenes.string_and_post(fine, 12.0, speed, 200.0 / speed, 0.3, 1 / 3, GAP)
    axes = figure.add_subplot(grid[1, 0])
    middle = result.track(cable.at(cable.length / 2)).position[:, 1]
    axes.plot(1e3 * result.time, middle, color=BLUE, linewidth=2.2, label="middle [m]")
    impulse = result.contact_impulse(cable)[:, 1]
    axes.plot(1e3 * result.time, impulse / 10, color=RED, linewidth=2.2, label="impulse of the post [10 N s]")
    for values in (way, pushed / 10):
        axes.plot(1e3 * fine, values, "--", color=INK, linewidth=0.9)
    axes.legend(frameon=False, fontsize=8.5)
    plain(axes, "t [ms]", "", "Middle and impulse; d'Alembert's waves dashed")
    draw_energies(figure.add_subplot(grid[1, 1]), result, "Energies")
    return figure


def main() -> None:
    """Print what is checked, and leave a picture."""
    slap = run()
    print(slap.report())
    print(f"look at {save(picture(slap), 'cable_slap')}")


if __name__ == "__main__":
    main()
