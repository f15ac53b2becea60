"""A rope slides round a capstan, and nobody knows its friction exactly.

How much more does it take to pull a rope over a drum than hangs on it? The rope, wrapped one and a half times
round a fixed drum, is pulled slowly against 10 N; where it slides, bristles (LuGre) hold with the full
coefficient of friction, and the tension grows exponentially along the wrap. Run once more for coefficients
drawn from what is known of them, the pull gets a band.

Checked: the ratio of tensions against Euler's exp(mu phi), for every coefficient; the work of both ends
against friction and strain.

    python examples/capstan.py
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import pliant as pl
from _audit import Audited, audit, draw_energies
from _style import AMBER, BLUE, GREY, INK, new_figure, plain, save
from matplotlib import colormaps
from matplotlib.figure import Figure
from scipy.stats import norm


@dataclass(frozen=True)
class Pulled:
    """The rope pulled once, and for many coefficients."""

    audited: Audited
    frictions: np.ndarray
    """Coefficients of friction, (n,)."""
    ratios: np.ndarray
    """Ratios of the tensions, (n,)."""
    expected: np.ndarray
    """The same by Euler, (n,)."""
    pulls: np.ndarray
    """Tension at the pulled end over time [N], (n, times)."""


def run(members: int = 5, mean: float = 0.2, spread: float = 0.02, **sizes: Any) -> Pulled:
    """Pull the rope; once more with coefficients at even quantiles of a normal distribution."""
    frictions = norm.ppf((np.arange(members) + 0.5) / members, mean, spread)
    scenes = [pl.scenes.capstan(friction=float(mu), **sizes) for mu in frictions]
    results = pl.simulate_many([scene.model for scene in scenes], **scenes[0].settings)
    name = "ratio of tensions"
    measured = [scene.measure(result)[name] for scene, result in zip(scenes, results, strict=True)]
    pulls = [result.axial_force("rope")[:, -1] for result in results]
    return Pulled(
        audit(pl.scenes.capstan, friction=mean, **sizes),
        frictions,
        np.array(measured),
        np.array([scene.expected[name].value for scene in scenes]),
        np.array(pulls),
    )


def picture(pulled: Pulled) -> Figure:
    """Draw the rope on its drum, the tension along it, the pull with its band, the energies."""
    scene, result = pulled.audited.scene, pulled.audited.result
    figure = new_figure(11, 7.2)
    grid = figure.add_gridspec(2, 2)
    space = figure.add_subplot(grid[0, 0], projection="3d")
    places, force = result.positions("rope")[-1], result.axial_force("rope")[-1]
    shades = force / force.max()
    colors = colormaps["viridis"](shades)
    for k, color in enumerate(colors):
        space.plot(*places[k : k + 2].T, color=color, linewidth=3)
    angle, height = np.meshgrid(np.linspace(0, 2 * np.pi, 49), np.array([-0.03, 0.03]))
    space.plot_surface(0.1 * np.cos(angle), height, 0.1 * np.sin(angle), color=GREY, alpha=0.35)
    space.set_aspect("equal")
    space.view_init(elev=18, azim=-50)
    space.set_axis_off()
    space.set_title("The rope, coloured by tension", fontsize=10.5, loc="left")

    along = figure.add_subplot(grid[0, 1])
    length = scene.model["rope"].length
    s = (np.arange(len(force)) + 0.5) * length / len(force)
    turned = np.clip((s - 0.1) / (length - 0.2), 0, 1)
    ratio = scene.expected["ratio of tensions"].value
    along.semilogy(s, force, "o", color=BLUE, markersize=3, label="elements")
    along.semilogy(s, force[0] * ratio**turned, color=INK, linewidth=1, label="Euler")
    along.legend(frameon=False, fontsize=8.5)
    along.yaxis.set_minor_formatter("{x:g}")
    along.yaxis.set_major_formatter("{x:g}")
    plain(
        along,
        "along the rope [m]",
        "tension [N]",
        f"Ratio {pulled.audited.measured['ratio of tensions']:.3f}",
    )

    band = figure.add_subplot(grid[1, 0])
    time = np.linspace(0, result.time[-1], pulled.pulls.shape[1])
    low, high = pulled.pulls.min(axis=0), pulled.pulls.max(axis=0)
    band.fill_between(time, low, high, color=AMBER, alpha=0.3, linewidth=0)
    for pull in pulled.pulls:
        band.plot(time, pull, color=AMBER, linewidth=0.8)
    band.plot(result.time, result.axial_force("rope")[:, -1], color=INK, linewidth=1.2)
    plain(band, "t [s]", "tension at the pulled end [N]", "Friction 0.20 (black), and known to +-0.02")
    draw_energies(figure.add_subplot(grid[1, 1]), result, "The work of both ends")
    return figure


def main() -> None:
    """Print what is checked, and leave a picture."""
    pulled = run()
    print(pulled.audited.report())
    worst = np.abs(pulled.ratios / pulled.expected - 1).max()
    print(f"{len(pulled.ratios)} coefficients: ratios {pulled.ratios.min():.3f} to {pulled.ratios.max():.3f}")
    print(f"every one is Euler's to {worst:.1e}")
    print(f"look at {save(picture(pulled), 'capstan')}")


if __name__ == "__main__":
    main()
