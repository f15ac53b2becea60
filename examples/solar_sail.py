"""A spinning hub throws out a folded solar sail, and wrinkles decide how it opens.

How does a sail open that nothing but its spin unfolds? Four films with masses at the corners start as a cross
around a hub that a motor keeps at 20 revolutions a minute. They fly out as the tips' inertia wills, tethers
tauten, and the motor gives the angular momentum that the larger sail takes. A film that carries compression,
wrinkles left out, keeps its creases apart and opens another way.

Checked: the motor's torque is the rate of the angular momentum, and none before the tethers tauten; the
momentum of the folded sail; the forces through the flat sail in steady spin.

    python examples/solar_sail.py
"""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import Any

import numpy as np
import pliant as pl
from _style import AMBER, BLUE, GREEN, INK, RED, new_figure, plain, save
from matplotlib.figure import Figure
from mpl_toolkits.mplot3d.art3d import Poly3DCollection

TIMES = (0.0, 0.1, 0.25, 0.35, 0.5, 10.0)
"""When the sail is looked at [s]."""


@dataclass(frozen=True)
class Opening:
    """Two sails that open, and one that is open."""

    scene: pl.scenes.Scene
    """Of the film that wrinkles."""
    result: pl.Result
    """Its motion."""
    wrinkling: dict[str, Any]
    """What is measured of it."""
    elastic: dict[str, Any]
    """The same of a film that carries compression."""
    steady: dict[str, Any]
    """The same of the flat sail in steady spin."""
    sizes: pl.scenes.SailSizes
    """Sizes of all."""


def shrinkings(area: np.ndarray, part: float = 0.9) -> int:
    """Count how often the area falls below a part of what it had reached."""
    count, highest, below = 0, area[0], False
    for value in area:
        if below and value > part * highest:
            below, highest = False, value
        elif not below and value < part * highest:
            count, below = count + 1, True
        if not below:
            highest = max(highest, value)
    return count


def run(fine: int = 1, duration: float = 10.0, step: float = 5e-3, softer: float = 1000.0) -> Opening:
    """Open sails of cells of 0.1 m over ``fine``, of a film so many times softer than polyimide."""
    cells = {"cell": 0.1 / fine, "base_cells": 8 * fine, "rows": 4 * fine, "arc_cells": 2 * fine}
    sizes = pl.scenes.SailSizes(**cells, youngs_modulus=2.5e9 / softer)
    measured = []
    for wrinkling in (False, 1e-4):
        scene = pl.scenes.solar_sail(sizes, wrinkling=wrinkling, duration=duration, step=step)
        result = scene.simulate(output_every=max(1, round(0.05 / step)))
        measured.append(scene.measure(result))
    # Steady spin, reached soon by a stiff and damped film; its forces do not depend on either.
    stiff = dataclasses.replace(sizes, youngs_modulus=2.5e9)
    flat = pl.scenes.solar_sail(stiff, start="flat", retardation_time=3e-3, duration=0.06)
    return Opening(scene, result, measured[1], measured[0], flat.measure(flat.simulate()), sizes)


def draw(axes: Any, places: list[np.ndarray], faces: tuple[np.ndarray, ...], half: float) -> None:
    """Draw four films from above."""
    for corners, color in zip(places, (BLUE, AMBER, GREEN, RED), strict=True):
        for kind in faces:
            axes.add_collection3d(
                Poly3DCollection(corners[kind], facecolor=color, edgecolor=INK, linewidth=0.15, alpha=0.75)
            )
    axes.set_xlim(-1.4 * half, 1.4 * half)
    axes.set_ylim(-1.4 * half, 1.4 * half)
    axes.set_zlim(-0.7 * half, 0.7 * half)
    axes.set_box_aspect((1, 1, 0.5), zoom=1.45)
    axes.view_init(elev=50, azim=-70)
    axes.set_axis_off()


def picture(opening: Opening) -> Figure:
    """Draw the sail at six times, and its area and the motor's torque over time."""
    figure = new_figure(11, 5.4)
    rows = figure.add_gridspec(2, 1, height_ratios=(1, 1.5))
    strip = rows[0].subgridspec(1, len(TIMES), wspace=0.0)
    turn = np.linspace(0, 2 * np.pi, 60)
    result, sizes = opening.result, opening.sizes
    faces = sizes.grid()[2:]
    for k, time in enumerate(TIMES):
        i = int(np.argmin(np.abs(result.time - time)))
        axes = figure.add_subplot(strip[k], projection="3d")
        places = [result.positions(f"petal{j + 1}")[i] for j in range(4)]
        draw(axes, places, faces, sizes.half)
        hub = sizes.hub_radius * np.array([np.cos(turn), np.sin(turn)])
        axes.plot(*hub, 0 * turn, color=INK, linewidth=1.0)
        axes.set_title(f"{result.time[i]:g} s", fontsize=10.5, y=0.98)
    lower = rows[1].subgridspec(1, 2)
    axes = figure.add_subplot(lower[0])
    for found, color, name in (
        (opening.wrinkling, BLUE, "film that wrinkles"),
        (opening.elastic, RED, "film that carries compression"),
    ):
        axes.plot(found["time"], found["area"], color=color, linewidth=1.4, label=name)
    axes.axhline(1.0, color=INK, linewidth=0.8, linestyle=":")
    axes.legend(frameon=False, fontsize=9, loc="lower right")
    plain(axes, "t [s]", "projected area over that of the film", "How it opens")
    axes = figure.add_subplot(lower[1])
    found = opening.wrinkling
    axes.plot(found["time"], 1e3 * found["angular momentum"], color=BLUE, linewidth=1.4)
    closed = 1e3 * sizes.inertia * sizes.spin
    axes.axhline(closed, color=INK, linewidth=0.8, linestyle=":")
    middle = (0.525 * found["time"][-1], 1.01 * closed)
    axes.annotate("flat, turning\nwith the hub", middle, va="bottom", ha="center", fontsize=9)
    plain(axes, "t [s]", "angular momentum of the sail [g m$^2$/s]", "What the motor has given")
    return figure


def main() -> None:
    """Print the checks, and leave a picture and a page."""
    opening = run()
    found, sizes = opening.wrinkling, opening.sizes
    print(
        f"torque and rate of angular momentum differ by {found['momentum balance']:.1e} of the largest torque"
    )
    hanging = np.logical_and.accumulate(found["tether tension"].max(axis=1) == 0.0)
    print(f"tethers hang until {found['time'][hanging][-1]:.2f} s; the angular momentum is", end=" ")
    print(f"{found['angular momentum'][0]:.5f} kg m^2/s, then {found['angular momentum'][hanging][-1]:.5f}")
    for place, c in (("base", sizes.base), ("middle", 0.5 * (sizes.base + sizes.half))):
        force = opening.steady[f"tension at the {place}"]
        print(f"steady spin, force at the {place}: {force:.5f} N, closed form {sizes.tension(c):.5f} N")
    for name, one in (("wrinkles", found), ("carries compression", opening.elastic)):
        late = one["area"][one["time"] > 0.5 * one["time"][-1]]
        print(f"a film that {name} opens to {late.mean():.2f} of its area; it shrinks", end=" ")
        print(f"below 0.9 of what it had reached {shrinkings(one['area'])} times")
    path = save(picture(opening), "solar_sail", dpi=100)
    opening.result.export_html(path.with_suffix(".html"), color="speed")
    print(f"turn and play {path.with_suffix('.html')}")
    print(f"look at {path}")


if __name__ == "__main__":
    main()
