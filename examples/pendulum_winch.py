"""A pendulum is hauled in while it swings.

How much does the swing of a load grow while a winch hauls it up from 10 to 5 m? Slowly changed, a pendulum
keeps its energy over its frequency, said Einstein at the first Solvay conference, asked by Lorentz: the angle
grows as the length to the power of -3/4.

Checked: the growth against that power, every swing against the pendulum of prescribed length, the work of the
winch.

    python examples/pendulum_winch.py
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pliant as pl
from _audit import Audited, audit, draw_energies
from _style import BLUE, RED, new_figure, plain, save
from matplotlib.figure import Figure


def run(**sizes: Any) -> Audited:
    """Haul the pendulum in."""
    return audit(pl.scenes.pendulum_winch, **sizes)


def picture(haul: Audited) -> Figure:
    """Draw the way of the load, its angle, and the energies."""
    result = haul.result
    place = result.track(haul.scene.model["cable"].end).position
    length = np.hypot(place[:, 0], place[:, 2])
    angle = np.arctan2(place[:, 0], -place[:, 2])
    figure = new_figure(11, 4.4)
    space, swing, energies = figure.subplots(1, 3, width_ratios=(0.6, 1.4, 1))
    space.plot(place[:, 0], place[:, 2], color=BLUE, linewidth=0.5)
    space.set_ylim(-10.5, 0)
    plain(space, "x [m]", "z [m]", "Way of the load")
    swing.plot(result.time, np.degrees(angle), color=BLUE, linewidth=0.8)
    envelope = np.degrees(angle[0]) * (length / length[0]) ** -0.75
    for side in (1, -1):
        label = "length to the power of -3/4" if side > 0 else None
        swing.plot(result.time, side * envelope, color=RED, linewidth=1.2, label=label)
    swing.legend(frameon=False, fontsize=8.5, loc="upper left")
    swing.set_ylim(-6.2, 7.4)
    plain(swing, "t [s]", "angle [degrees]", "The swing grows")
    draw_energies(energies, result, "The winch's work", "kJ", 1e3)
    return figure


def main() -> None:
    """Print what is checked, and leave a picture."""
    haul = run()
    print(haul.report())
    print(f"look at {save(picture(haul), 'pendulum_winch')}")


if __name__ == "__main__":
    main()
