"""A net catches a ball that floats free.

What holds a piece of debris that nobody can grip? A square net of thin rope with a mass at each corner is
thrown at a ball twenty times its weight. The ropes that meet it stop, the rest of the net flies on, and the
masses swing round behind the ball.

Checked: linear and angular momentum, which nothing from outside changes; energy, which contact, friction and
strain rates may only take; how far the corners have closed.

    python examples/net_capture.py
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pliant as pl
from _audit import Audited, audit, draw_energies
from _style import AMBER, BLUE, GREY, INK, new_figure, plain, save, seen_from
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure

SIGHT = (-60, 14)
"""From where the net is seen: azimuth and elevation [degrees]."""


def run(**sizes: Any) -> Audited:
    """Throw the net."""
    return audit(pl.scenes.net_capture, **sizes)


def ropes(result: pl.Result, frame: int) -> np.ndarray:
    """Straight pieces of all ropes at an output, (pieces, 2, 3)."""
    strands = np.asarray(result.model._bodies["net"].strands)
    points = pl.scenes.centre_line(result, "net", [frame], pieces=3)[0]
    lines = np.split(points, np.cumsum(3 * strands + 1)[:-1])
    return np.concatenate([np.stack([line[:-1], line[1:]], axis=1) for line in lines])


def picture(caught: Audited) -> Figure:
    """Draw the net four times, how it closes, what the ball gets, the energies."""
    result, measured = caught.result, caught.measured
    figure = new_figure(11, 7.0)
    grid = figure.add_gridspec(2, 4, height_ratios=[1.25, 1])
    last = len(result.time) - 1
    turn = np.linspace(0, 2 * np.pi, 73)
    for k, part in enumerate((0.0, 0.4, 0.7, 1.0)):
        frame = round(part * last)
        axes = figure.add_subplot(grid[0, k])
        centre = seen_from(result.track(result.model["ball"].center).position[frame], *SIGHT)
        axes.fill(*(centre[:, None] + 0.5 * np.stack([np.cos(turn), np.sin(turn)])), color=GREY, alpha=0.55)
        axes.add_collection(
            LineCollection(list(seen_from(ropes(result, frame), *SIGHT)), colors=BLUE, linewidths=0.5)
        )
        for corner in range(1, 5):
            axes.plot(
                *seen_from(result.track(result.model[f"corner{corner}"].center).position[frame], *SIGHT),
                "o",
                color=INK,
                ms=4,
            )
        axes.set_xlim(-2.9, 2.9)
        axes.set_ylim(-3.7, 1.3)
        axes.set_aspect("equal")
        axes.set_axis_off()
        axes.set_title(f"{result.time[frame]:.2f} s", fontsize=10.5)
    closing = figure.add_subplot(grid[1, 0])
    closing.plot(result.time, measured["closing index"], color=BLUE)
    closing.set_ylim(0, 1.05)
    plain(closing, "t [s]", "distance of corners / side", "The corners close")
    pushed = figure.add_subplot(grid[1, 1])
    pushed.plot(result.time, -measured["ball velocity"][:, 2], color=AMBER)
    pushed.set_ylim(bottom=0)
    plain(pushed, "t [s]", "m/s", "The ball is carried along")
    draw_energies(figure.add_subplot(grid[1, 2:]), result, "Energies")
    return figure


def main() -> None:
    """Print what is checked, and leave a picture."""
    caught = run()
    print(caught.report())
    print(f"corners closed to {np.asarray(caught.measured['closing index'])[-1]:.2f} of the side")
    print(f"look at {save(picture(caught), 'net_capture')}")


if __name__ == "__main__":
    main()
