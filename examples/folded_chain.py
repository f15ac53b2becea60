"""A chain hangs by both ends; one is let go, and falls faster than a stone.

How fast does the free end of a folded chain fall? The fold hands over chain from the leg that falls to the
one that hangs; nothing is lost, and less and less chain carries all the energy. Before it is stretched out
the end has left free fall far behind.

Checked: the speed at three heights against the energy of a thin fold; the sum of energies.

    python examples/folded_chain.py
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pliant as pl
from _audit import Audited, audit, draw_energies
from _style import BLUE, GREY, INK, RED, new_figure, plain, save
from matplotlib.figure import Figure

LENGTH, GRAVITY = 2.0, 9.81
"""Length of the chain [m], and gravity [m/s^2]."""


def run(**sizes: Any) -> Audited:
    """Let one end go."""
    return audit(pl.scenes.folded_chain, length=LENGTH, gravity=GRAVITY, **sizes)


def picture(fall: Audited) -> Figure:
    """Draw the chain beside a stone, the speed of its end, the energies."""
    result = fall.result
    chain = fall.scene.model["chain"]
    figure = new_figure(11, 4.6)
    space, speeds, energies = figure.subplots(1, 3, width_ratios=(1.1, 1, 1))
    places = result.positions(chain)
    for k, moment in enumerate(np.linspace(0, result.time[-1], 6)):
        shape = places[np.searchsorted(result.time, moment - 1e-9)]
        x = 0.3 * k
        space.plot(x + shape[:, 0], shape[:, 2], color=BLUE, linewidth=1.6)
        stone = -GRAVITY * moment**2 / 2
        space.plot(x + 0.17, stone, "o", color=RED, markersize=6)
        space.annotate(f"{moment:.2f} s", (x + 0.05, 0.04), ha="center", fontsize=8.5, color=INK)
    space.set_aspect("equal")
    space.set_xticks([])
    plain(space, "", "z [m]", "A folded chain and a stone (red)")

    motion = result.track(chain.end)
    way = motion.position[0, 2] - motion.position[:, 2]
    speeds.plot(way, -motion.velocity[:, 2], color=BLUE, linewidth=2.5, label="end of the chain")
    x = np.linspace(0, way[-1], 200)
    thin = np.sqrt(GRAVITY * x * (2 * LENGTH - x) / (LENGTH - x))
    speeds.plot(x, thin, "--", color=INK, linewidth=1.2, label="energy of a thin fold")
    speeds.plot(x, np.sqrt(2 * GRAVITY * x), color=GREY, label="free fall")
    speeds.legend(frameon=False, fontsize=8.5)
    plain(speeds, "way of the end [m]", "speed [m/s]", "Faster than free fall")
    draw_energies(energies, result, "Where the energy goes")
    return figure


def main() -> None:
    """Print what is checked, and leave a picture."""
    fall = run()
    print(fall.report())
    ahead = fall.measured["ahead of free fall"]
    print(f"at {fall.result.time[-1]:g} s the end has fallen {ahead:.3f} times as far as a stone")
    print(f"look at {save(picture(fall), 'folded_chain')}")


if __name__ == "__main__":
    main()
