"""An iced line gallops in the wind.

From which wind on does a line with ice on it start to gallop, and how far does it go? Ice turns a round line
into a bad wing: lift that falls with the angle of attack drives what moves across the wind. The line's own
damping holds that down to a certain wind; above, the motion grows until lift gives out.

Checked: the wind at which an eigenvalue of the line in the wind crosses zero, and its growth above, against
Den Hartog; the amplitude at last against one mode under quasi-steady forces; the work of the wind.

    python examples/galloping_line.py
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pliant as pl
from _audit import Audited, audit, draw_energies
from _style import BLUE, GREY, INK, RED, new_figure, plain, save
from matplotlib.figure import Figure


@dataclass(frozen=True)
class Galloping:
    """The line in one wind, and how its motion grows in others."""

    audited: Audited
    winds: Sequence[float]
    """Velocities [m/s]."""
    rates: Sequence[float]
    """Fastest growth of small motions [1/s]."""


def run(winds: Sequence[float] = (0.3, 0.8, 1.3, 1.8, 2.3, 2.8), **sizes: Any) -> Galloping:
    """Let the line gallop, and look at its small motions in other winds."""
    rates = []
    for wind in winds:
        scene = pl.scenes.galloping_line(wind=wind, **sizes)
        values = pl.solve_modes(scene.model, count=2, about=scene.start).eigenvalues
        rates.append(float(values.real.max()))
    return Galloping(audit(pl.scenes.galloping_line, **sizes), winds, rates)


def picture(found: Galloping) -> Figure:
    """Draw growth over wind, the motion of mid-span, the energies."""
    scene, result = found.audited.scene, found.audited.result
    line = scene.model["line"]
    figure = new_figure(11, 6.2)
    grid = figure.add_gridspec(2, 2, width_ratios=(1, 1.25))
    growth = figure.add_subplot(grid[0, 0])
    onset, rate = (scene.expected[key].value for key in ("onset", "growth rate"))
    still = -rate * onset / (3.0 - onset)
    growth.plot((0, 3), (still, rate), color=GREY, label="Den Hartog")
    growth.plot(found.winds, found.rates, "o", color=BLUE, label="eigenvalues")
    growth.axhline(0, color=INK, linewidth=0.7)
    growth.annotate(f"onset\n{found.audited.measured['onset']:.4f} m/s", (onset + 0.1, -0.004), fontsize=8.5)
    growth.legend(frameon=False, fontsize=8.5)
    plain(growth, "wind [m/s]", "growth [1/s]", "Small motions grow above a certain wind")

    way = figure.add_subplot(grid[0, 1])
    middle = result.track(line.at(line.length / 2)).position
    way.plot(result.time, middle[:, 2], color=BLUE, linewidth=0.3)
    early = result.time < 150
    start = np.abs(middle[result.time < 5, 2]).max()
    way.plot(result.time[early], start * np.exp(rate * result.time[early]), color=RED, linewidth=1.2)
    plain(way, "t [s]", "mid-span, up [m]", "It grows (red: linear theory) into a limit cycle")

    orbit = figure.add_subplot(grid[1, 0])
    late = result.time > result.time[-1] - 6.0
    orbit.plot(1e3 * middle[late, 1], middle[late, 2], color=BLUE)
    plain(orbit, "with the wind [mm]", "up [m]", "Way of mid-span at last")
    draw_energies(figure.add_subplot(grid[1, 1]), result, "The wind's work and where it goes", "kJ", 1e3)
    return figure


def main() -> None:
    """Print what is checked, and leave a picture."""
    found = run()
    print(found.audited.report())
    print(f"look at {save(picture(found), 'galloping_line')}")


if __name__ == "__main__":
    main()
