"""A soft quadruped walks, and when it does not.

A plus of 24 shell elements lies on a ground with LuGre friction; its halves arch in turn. Who decides
whether it travels? Symmetry. If the back half repeats half a period later what the front half did,
mirroring the motion and waiting half a period changes nothing: a settled gait travels nowhere, however hard
it works. A lag of a quarter period walks, the opposite lag walks back. And it matters where the work comes
from: curvature from within, as pneumatic chambers make it, walks on any ground; the same turns of two
vertical forces from outside hardly do.

Checked: opposite lags give opposite travel, the mirrored gait none; the ground carries the weight, and pulls
nowhere on average; half the step gives the same travel; the sign of the travel does not depend on friction.

    python examples/quadruped.py
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pliant as pl
from _style import AMBER, BLUE, GREEN, GREY, INK, OUT, RED, new_figure, plain, save
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from pliant.scenes import Scene, quadruped

CASES = {
    "walks: lag of a quarter": {"lag": 0.25},
    "walks back: opposite lag": {"lag": -0.25},
    "mirrored: lag of a half": {"lag": 0.5},
    "crawl": {"gait": "crawl"},
    "forces, lag of a quarter": {"actuation": "forces"},
    "forces, mirrored": {"actuation": "forces", "lag": 0.5},
}
COLORS = dict(zip(CASES, (BLUE, RED, INK, GREEN, AMBER, GREY), strict=True))


@dataclass(frozen=True)
class Study:
    """Runs of the robot."""

    scenes: dict[str, Scene]
    results: dict[str, pl.Result]
    measured: dict[str, dict[str, float]]
    halved: dict[str, float]
    """The first case with steps half as long."""
    frictions: np.ndarray
    """Coefficients of friction of the ensemble."""
    ensemble: list[pl.Result]
    travels: np.ndarray
    """Travel in a settled cycle of each of the ensemble [mm]."""


def run(
    cycles: int = 5,
    settling: int = 3,
    step: float = 2e-3,
    frictions: Sequence[float] = (0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0),
    cases: Sequence[str] = tuple(CASES),
) -> Study:
    """Run all gaits, and the first on grounds of other friction."""
    settings: dict[str, Any] = {"cycles": cycles, "settling": settling, "step": step}
    scenes = {name: quadruped(**CASES[name], **settings) for name in cases}
    results = {name: scene.simulate() for name, scene in scenes.items()}
    measured = {name: scenes[name].measure(result) for name, result in results.items()}
    finer = quadruped(**{**settings, "step": step / 2})
    grounds = [quadruped(friction=mu, **settings) for mu in frictions]
    ensemble = [scene.simulate() for scene in grounds]
    travels = [
        scene.measure(result)["travel per cycle [mm]"]
        for scene, result in zip(grounds, ensemble, strict=True)
    ]
    halved = finer.measure(finer.simulate())
    return Study(scenes, results, measured, halved, np.array(frictions), ensemble, np.array(travels))


def profile(result: pl.Result, moment: float) -> np.ndarray:
    """Nodes of the middle line at a time, from back to front, (x, z) [m]."""
    frame = int(np.argmin(np.abs(result.time - moment)))
    start, now = result.positions("robot")[[0, frame]]
    middle = np.flatnonzero(np.abs(start[:, 1]) < 1e-9)
    middle = middle[np.argsort(start[middle, 0])]
    return now[middle][:, [0, 2]]


def draw_strip(axes: Axes, result: pl.Result) -> None:
    """Draw the robot from the side at five moments, ten millimetres of paper apart."""
    for k, moment in enumerate((0.0, 0.6, 1.2, 1.8, 2.4)):
        line = 1e3 * profile(result, moment)
        height = -30.0 * k
        axes.plot([-80, 90], [height, height], color=GREY, linewidth=0.8)
        axes.plot(line[:, 0], line[:, 1] + height, color=BLUE, linewidth=6, solid_capstyle="butt", alpha=0.8)
        axes.plot(line[:, 0].mean(), height - 3, "^", color=RED, markersize=5)
        axes.annotate(f"{moment:.1f} s", (-82, height + 3), ha="right")
    axes.plot([0, 0], [-30.0 * 4 - 6, 18], color=RED, linewidth=0.6, linestyle=":")
    axes.set_aspect("equal")
    axes.set_axis_off()
    axes.set_title("The robot from the side", fontsize=10.5, loc="left")


def feet(result: pl.Result) -> tuple[np.ndarray, np.ndarray]:
    """Nodes of the middle line, x at the start [mm], and what they do: 0 in the air, 1 stick, 2 slip."""
    r, v = result.positions("robot"), result.velocities("robot")
    middle = np.flatnonzero(np.abs(r[0, :, 1]) < 1e-9)
    middle = middle[np.argsort(r[0, middle, 0])]
    down = r[:, middle, 2] < r[0, 0, 2] + 2e-5
    slips = np.linalg.norm(v[:, middle, :2], axis=2) > 1e-3
    return 1e3 * r[0, middle, 0], np.where(down, np.where(slips, 2, 1), 0)


def picture(study: Study) -> Figure:
    """Draw the robot at five moments, its travels, what friction does to them, and its feet."""
    figure = new_figure(12, 7.2)
    grid = figure.add_gridspec(2, 2)
    first = next(iter(study.results))
    draw_strip(figure.add_subplot(grid[0, 0]), study.results[first])
    axes = figure.add_subplot(grid[0, 1])
    for name, result in study.results.items():
        way = 1e3 * (result.center_of_mass() - result.center_of_mass()[0])
        along = way[:, 0] if name != "crawl" else (way[:, 0] + way[:, 1]) / np.sqrt(2)
        axes.plot(result.time, along, color=COLORS[name], linewidth=1.5, label=name)
    axes.legend(frameon=False, fontsize=8, loc="upper left")
    plain(axes, "t [s]", "way [mm]", "Who walks")
    axes = figure.add_subplot(grid[1, 0])
    ways = np.array([1e3 * (r.center_of_mass()[:, 0] - r.center_of_mass()[0, 0]) for r in study.ensemble])
    time = study.ensemble[0].time
    axes.fill_between(time, ways.min(axis=0), ways.max(axis=0), color=BLUE, alpha=0.2, label="all of them")
    low, high = np.quantile(ways, (0.25, 0.75), axis=0)
    axes.fill_between(time, low, high, color=BLUE, alpha=0.35, label="middle half")
    axes.plot(time, np.median(ways, axis=0), color=BLUE, linewidth=1.5, label="median")
    axes.legend(frameon=False, fontsize=8, loc="upper left")
    inset = axes.inset_axes((0.7, 0.07, 0.29, 0.27))
    inset.plot(study.frictions, study.travels, "o-", color=RED, markersize=3, linewidth=1)
    inset.set_ylim(0, 1.15 * study.travels.max())
    inset.set_title("mm per cycle against friction", fontsize=8)
    inset.tick_params(labelsize=7)
    plain(axes, "t [s]", "way [mm]", "Grounds of friction 0.3 to 1")
    axes = figure.add_subplot(grid[1, 1])
    x, state = feet(study.results[first])
    from matplotlib.colors import ListedColormap

    axes.pcolormesh(
        study.results[first].time, x, state.T, cmap=ListedColormap(["white", GREEN, AMBER]), vmin=0, vmax=2
    )
    plain(axes, "t [s]", "node at x [mm]", "The middle line: in the air, sticking (green), slipping (amber)")
    return figure


def main() -> None:
    """Print who walks how far, and leave a picture, a film and a page."""
    study = run()
    for name, values in study.measured.items():
        print(
            f"{name}: {values['travel per cycle [mm]']:+.3f} mm a cycle, scatter "
            f"{values['scatter of the travel']:.1%}, horizontal force "
            f"{values['horizontal force over weight']:.1e} of the weight"
        )
    first = next(iter(study.results))
    print(f"{first}, steps half as long: {study.halved['travel per cycle [mm]']:+.3f} mm a cycle")
    for mu, travel in zip(study.frictions, study.travels, strict=True):
        print(f"friction {mu:.1f}: {travel:+.3f} mm a cycle")
    path = save(picture(study), "quadruped")
    page = Path(OUT / "quadruped.html")
    study.results[first].export_html(page, color="speed")
    film = study.results[first].animate(OUT / "quadruped.gif", color="speed", fps=10)
    print(f"look at {path} and {page} and {film}")


if __name__ == "__main__":
    main()
