"""A jump on an elastic cord, and waves in a cord that stops a weight.

How far does a jumper of 80 kg stretch a cord of 6 m, and what does the anchor feel? The cord hangs in a loop
beside the jumper until it is stretched out; then it stops the fall. Where the cord is straight at that
moment, the stop runs through it as a wave, which the anchor throws back doubled.

Checked: the lowest point by energy, with the cord's mass and damping; the tension at the anchor against
d'Alembert's waves; the sum of energies.

    python examples/bungee.py
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import pliant as pl
from _audit import Audited, audit, draw_energies
from _style import BLUE, GREY, INK, RED, new_figure, plain, save
from matplotlib.figure import Figure


@dataclass(frozen=True)
class Stops:
    """Both falls."""

    jump: Audited
    drop: Audited


def run(jump: Mapping[str, Any] | None = None, drop: Mapping[str, Any] | None = None) -> Stops:
    """Jump, and drop the weight; the sizes of both scenes."""
    return Stops(audit(pl.scenes.bungee, **(jump or {})), audit(pl.scenes.drop_test, **(drop or {})))


def picture(stops: Stops) -> Figure:
    """Draw the jump, its depth and energies, and the tension at the anchor."""
    figure = new_figure(11, 6.6)
    grid = figure.add_gridspec(2, 2, width_ratios=(1, 1.15))
    space = figure.add_subplot(grid[0, 0])
    result = stops.jump.result
    cord = stops.jump.scene.model["cord"]
    places = result.positions(cord)
    for k, moment in enumerate((0.0, 0.5, 1.0, 1.5, 2.0, 2.5, 3.0, 3.5, 4.0)):
        shape = places[np.searchsorted(result.time, moment - 1e-9)]
        x = 2.5 * k
        space.plot(x + shape[:, 0], shape[:, 2], color=BLUE, linewidth=1.3)
        space.plot(x + shape[-1, 0], shape[-1, 2], "o", color=RED, markersize=6)
        space.annotate(f"{moment:g} s", (x, 1.0), ha="center", fontsize=8.5, color=INK)
    bottom = -6.0 - stops.jump.scene.expected["stretch"].value
    space.axhline(bottom, color=GREY, linewidth=1, linestyle="--")
    space.annotate("lowest point by energy", (0, bottom), xytext=(0, 4), textcoords="offset points")
    space.set_ylim(bottom - 1.5, 3.5)
    space.set_xticks([])
    plain(space, "", "z [m]", "The jump")
    draw_energies(figure.add_subplot(grid[0, 1]), result, "Energies of the jump", "kJ", 1e3)

    waves = figure.add_subplot(grid[1, :])
    drop = stops.drop.result
    _, exact = pl.scenes.stopping_tension(drop.time, np.sqrt(2 * 9.81 * 6.0), 80.0, 120.0, 3.0)
    pull = drop.reaction(stops.drop.scene.model["anchor"]).force[:, 2]
    waves.plot(drop.time, pull, color=BLUE, linewidth=0.9, label="100 elements")
    waves.plot(drop.time, exact, color=INK, linewidth=1.2, linestyle="--", label="d'Alembert's waves")
    waves.legend(frameon=False, fontsize=8.5)
    plain(
        waves,
        "t [s]",
        "tension at the anchor [N]",
        "A straight cord stops a weight: the wave goes to and fro",
    )
    return figure


def main() -> None:
    """Print what is checked, and leave a picture."""
    stops = run()
    print(stops.jump.report())
    print(stops.drop.report())
    print(f"look at {save(picture(stops), 'bungee')}")


if __name__ == "__main__":
    main()
