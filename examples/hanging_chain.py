"""A hanging chain swings in its first three modes at once.

With which frequencies does a chain swing that hangs by one end? Daniel Bernoulli found them in 1732, with the
functions that later got Bessel's name. Here they come from the eigenvalues about the hanging chain, and once
more from its motion, which starts with the velocities of three modes together.

Checked: three frequencies from either way against the zeros of J0; the sum of energies.

    python examples/hanging_chain.py
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pliant as pl
from _audit import Audited, audit, draw_energies
from _style import BLUE, GREEN, INK, RED, new_figure, plain, save
from matplotlib.figure import Figure
from scipy.special import j0, jn_zeros


def run(**sizes: Any) -> Audited:
    """Let the chain swing."""
    return audit(pl.scenes.hanging_chain, **sizes)


def picture(swing: Audited) -> Figure:
    """Draw the modes over Bernoulli's, the way of the free end, the energies."""
    scene, result = swing.scene, swing.result
    chain = scene.model["chain"]
    figure = new_figure(11, 4.2)
    shapes, way, energies = figure.subplots(1, 3, width_ratios=(0.8, 1.3, 1))
    modes = pl.solve_modes(scene.model, count=6, about=scene.start)
    z = np.linspace(0, chain.length, 200)
    for n, color in enumerate((BLUE, RED, GREEN)):
        # Every frequency belongs to two directions; the shape of both together.
        shape = modes.positions(chain)[2 * n][:, :2]
        shape = shape @ shape[-1] / (shape[-1] @ shape[-1])
        nodes = np.linspace(chain.length, 0, len(shape))
        shapes.plot(j0(jn_zeros(0, 3)[n] * np.sqrt(z / chain.length)), z, color=color, linewidth=1.2)
        shapes.plot(shape[::3], nodes[::3], "o", color=color, markersize=3.5)
    plain(shapes, "deflection over that of the end", "height above the end [m]", "Modes, and J0 (lines)")
    end = 1e3 * result.track(chain.end).position[:, 0]
    way.plot(result.time, end, color=INK, linewidth=1)
    text = "\n".join(f"{swing.measured[f'swing {n}']:.4f} rad/s" for n in (1, 2, 3))
    way.annotate(
        "heard:\n" + text, (0.98, 0.98), xycoords="axes fraction", ha="right", va="top", fontsize=8.5
    )
    way.set_ylim(end.min() * 1.1, end.max() * 1.9)
    plain(way, "t [s]", "free end [mm]", "Three modes together")
    draw_energies(energies, result, "Energies", "µJ", 1e-6)
    energies.set_xlim(0, 3)
    energies.set_ylim(top=2e6 * result.energy.kinetic.max())
    return figure


def main() -> None:
    """Print what is checked, and leave a picture."""
    swing = run()
    print(swing.report())
    print(f"look at {save(picture(swing), 'hanging_chain')}")


if __name__ == "__main__":
    main()
