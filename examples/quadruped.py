"""A soft quadruped walks, and when it does not.

A plus of 24 shell elements lies on a ground with LuGre friction; its halves arch in turn. Who decides
whether it travels? Symmetry. If the back half repeats half a period later what the front half did,
mirroring the motion and waiting half a period changes nothing: a settled gait travels nowhere, however hard
it works. A lag of a quarter period walks, the opposite lag walks back. And it matters where the work comes
from: pressure in chambers or a changing rest curvature, which act from within, walk on any ground; the same
turns of two vertical forces from outside hardly do.

Checked: opposite lags give opposite travel, the mirrored gait none; the ground carries the weight, and pulls
nowhere on average; half the step gives the same travel; the sign of the travel does not depend on friction,
and how much it does is told by robots on grounds that are drawn at random.

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
from matplotlib.patches import Patch
from pliant.scenes import Scene, quadruped

PERIOD, LENGTH, SPAN = 0.6, 0.135, 0.13
CASES: dict[str, dict[str, Any]] = {
    "chambers, lag 1/4": {"actuation": "pressure", "lag": 0.25},
    "chambers, lag -1/4": {"actuation": "pressure", "lag": -0.25},
    "chambers, mirrored": {"actuation": "pressure", "lag": 0.5},
    "curvature, lag 1/4": {"lag": 0.25},
    "curvature, crawl": {"gait": "crawl"},
    "forces of 0.4 N, lag 1/4": {"actuation": "forces", "force": 0.4},
    "forces of 0.4 N, mirrored": {"actuation": "forces", "force": 0.4, "lag": 0.5},
}
COLORS = dict(zip(CASES, (BLUE, RED, INK, "#6aa5de", GREEN, AMBER, GREY), strict=True))
AIR, STICKS, SLIPS = 0, 1, 2


@dataclass(frozen=True)
class Study:
    """Runs of the robot."""

    scenes: dict[str, Scene]
    results: dict[str, pl.Result]
    measured: dict[str, dict[str, float]]
    halved: dict[str, float]
    """The first case with steps half as long."""
    laws: list[pl.LuGre]
    """Laws of friction of the ensemble."""
    ensemble: list[pl.Result]
    travels: np.ndarray
    """Travel in a settled cycle of each of the ensemble [mm]."""


def grounds(members: int, seed: int = 7) -> list[pl.LuGre]:
    """Draw grounds: nobody measures four coefficients of rubber on a floor."""
    rng = np.random.default_rng(seed)
    static = rng.uniform(0.3, 1.0, members)
    dynamic = static * rng.uniform(0.7, 1.0, members)
    stribeck = np.exp(rng.uniform(np.log(3e-3), np.log(3e-2), members))
    stiffness = np.exp(rng.uniform(np.log(2e4), np.log(2e5), members))
    rows = zip(static, dynamic, stribeck, stiffness, strict=True)
    return [pl.LuGre(s, d, stribeck_velocity=v, bristle_stiffness=k) for s, d, v, k in rows]


def run(
    cycles: int = 5,
    settling: int = 3,
    step: float = 2e-3,
    members: int = 24,
    cases: Sequence[str] = tuple(CASES),
) -> Study:
    """Run all gaits, and the first on many grounds."""
    settings: dict[str, Any] = {"cycles": cycles, "settling": settling, "step": step}
    scenes = {name: quadruped(**CASES[name], **settings) for name in cases}
    results = {name: scene.simulate() for name, scene in scenes.items()}
    measured = {name: scenes[name].measure(result) for name, result in results.items()}
    first = CASES[cases[0]]
    finer = quadruped(**{**first, **settings, "step": step / 2})
    laws = grounds(members)
    others = [quadruped(**first, **settings, friction=law) for law in laws]
    ensemble = pl.simulate_many([scene.model for scene in others], **others[0].settings)
    travels = [
        scene.measure(result)["travel per cycle [mm]"] for scene, result in zip(others, ensemble, strict=True)
    ]
    halved = finer.measure(finer.simulate())
    return Study(scenes, results, measured, halved, laws, ensemble, np.array(travels))


def middle_line(result: pl.Result) -> np.ndarray:
    """Nodes of the middle line, from back to front."""
    start = result.positions("robot")[0]
    middle = np.flatnonzero(np.abs(start[:, 1]) < 1e-9)
    return np.asarray(middle[np.argsort(start[middle, 0])])


def frame_at(result: pl.Result, moment: float) -> int:
    """Return the number of the output nearest to a time."""
    return int(np.argmin(np.abs(result.time - moment)))


def draw_strip(axes: Axes, result: pl.Result, period: float = PERIOD) -> None:
    """Draw the robot from the side at five moments, and what it does until the next."""
    nodes = middle_line(result)
    r = 1e3 * result.positions("robot")[:, nodes]
    moments = [t for t in (0.0, 0.6, 1.2, 1.8, 2.4) if t <= result.time[-1] + 1e-9]
    center = 1e3 * result.center_of_mass()[:, 0]
    for k, moment in enumerate(moments):
        ground = -34.0 * k
        axes.plot([-76, 84], [ground, ground], color=GREY, linewidth=0.8)
        for later, alpha in ((0.5, 0.18), (0.25, 0.3)):
            line = r[frame_at(result, moment + later * period)]
            axes.plot(line[:, 0], line[:, 2] + ground, color=BLUE, linewidth=3.5, alpha=alpha)
        now = frame_at(result, moment)
        axes.plot(r[now, :, 0], r[now, :, 2] + ground, color=BLUE, linewidth=5, solid_capstyle="butt")
        axes.plot(center[now], ground - 4.5, "^", color=RED, markersize=5)
        axes.annotate(f"{moment:.1f} s", (-78, ground + 2), ha="right", fontsize=9)
        axes.annotate(f"{center[now]:+.1f} mm", (86, ground + 2), color=RED, fontsize=9)
    axes.plot([0, 0], [-34.0 * len(moments) + 26, 18], color=RED, linewidth=0.6, linestyle=":")
    axes.set_aspect("equal")
    axes.set_axis_off()
    axes.set_title("From the side; faint: a quarter, a half period later", fontsize=10.5, loc="left")


def feet(result: pl.Result) -> np.ndarray:
    """Tell what the nodes of the middle line do over time, (n, nodes)."""
    r, v = result.positions("robot"), result.velocities("robot")
    nodes = middle_line(result)
    down = r[:, nodes, 2] < r[0, 0, 2] + 2e-5
    slips = np.linalg.norm(v[:, nodes, :2], axis=2) > 1e-3
    return np.where(down, np.where(slips, SLIPS, STICKS), AIR)


def draw_feet(axes: Axes, result: pl.Result, since: float) -> None:
    """Draw which nodes of the middle line are in the air, stick and slip."""
    from matplotlib.colors import ListedColormap

    late = result.time >= since - 1e-9
    x = 1e3 * result.positions("robot")[0, middle_line(result), 0]
    colors = ListedColormap(["#eef1f3", GREEN, AMBER])
    axes.pcolormesh(result.time[late], x, feet(result)[late].T, cmap=colors, vmin=0, vmax=2, rasterized=True)
    names = (("in the air", "#eef1f3"), ("sticks", GREEN), ("slips", AMBER))
    axes.legend(
        handles=[Patch(facecolor=color, edgecolor=GREY, linewidth=0.4, label=name) for name, color in names],
        fontsize=7.5,
        loc="center left",
        framealpha=1.0,
    )
    plain(axes, "t [s]", "along the robot [mm]", "The middle line: feet are its ends")


def draw_ways(axes: Axes, study: Study) -> None:
    """Draw who travels."""
    for name, result in study.results.items():
        way = 1e3 * (result.center_of_mass() - result.center_of_mass()[0])
        along = way[:, 0] if "crawl" not in name else (way[:, 0] + way[:, 1]) / np.sqrt(2)
        mean = study.measured[name]["travel per cycle [mm]"]
        axes.plot(result.time, along, color=COLORS[name], linewidth=1.5, label=f"{name}: {mean:+.2f} mm")
    low, high = axes.get_ylim()
    axes.set_ylim(low, high + 0.62 * (high - low))
    axes.legend(frameon=False, fontsize=8, loc="upper left")
    plain(axes, "t [s]", "way [mm]", "Who walks, and how far in a cycle")


def draw_ensemble(axes: Axes, study: Study) -> None:
    """Draw the band of ways on grounds that are drawn at random."""
    ways = np.array([1e3 * (r.center_of_mass()[:, 0] - r.center_of_mass()[0, 0]) for r in study.ensemble])
    time = study.ensemble[0].time
    low, half, high = np.quantile(ways, (0.05, 0.5, 0.95), axis=0)
    axes.plot(time, ways.T, color=GREY, linewidth=0.4, alpha=0.35)
    axes.fill_between(time, low, high, color=BLUE, alpha=0.25, label="5 to 95 %")
    axes.plot(time, half, color=BLUE, linewidth=1.8, label="median")
    axes.legend(frameon=False, fontsize=8, loc="upper left")
    plain(axes, "t [s]", "way [mm]", f"{len(ways)} grounds, four coefficients drawn")


def draw_grounds(axes: Axes, study: Study) -> None:
    """Draw travel over the coefficients of the ground."""
    static = np.array([law.static for law in study.laws])
    share = np.array([law.dynamic / law.static for law in study.laws])
    drawn = axes.scatter(static, study.travels, c=share, cmap="viridis", s=28)
    bar = axes.figure.colorbar(drawn, ax=axes, pad=0.02)
    bar.set_label("dynamic over static", fontsize=8.5)
    axes.set_ylim(0, 1.15 * study.travels.max())
    plain(axes, "static friction", "travel a cycle [mm]", "Forwards on every one of them")


def draw_ground_forces(axes: Axes, study: Study, since: float) -> None:
    """Draw what the ground does to the first robot, over its weight."""
    name = next(iter(study.results))
    result, scene = study.results[name], study.scenes[name]
    force = result.contact_force("robot", "ground")
    late = result.time >= since - 1e-9
    weight = 1070.0 * 8e-3 * LENGTH * SPAN / 2 * -float(scene.model.gravity[2])
    for axis, color, label in ((2, BLUE, "upwards"), (0, RED, "forwards")):
        axes.plot(result.time[late], force[late, axis] / weight, color=color, linewidth=1.2, label=label)
        mean = force[late, axis].mean() / weight
        axes.axhline(mean, color=color, linewidth=0.8, linestyle=":")
    axes.legend(frameon=False, fontsize=8, loc="center right")
    plain(axes, "t [s]", "force over weight", "The ground carries, and pulls nowhere on average")


def picture(study: Study) -> Figure:
    """Draw the robot at five moments, its travels, its feet, and grounds of other friction."""
    figure = new_figure(15, 8)
    axes = figure.subplots(2, 3)
    first = study.results[next(iter(study.results))]
    since = max(first.time[-1] - 2 * PERIOD, 0.0)
    draw_strip(axes[0, 0], first)
    draw_ways(axes[0, 1], study)
    draw_feet(axes[0, 2], first, since)
    draw_ensemble(axes[1, 0], study)
    draw_grounds(axes[1, 1], study)
    draw_ground_forces(axes[1, 2], study, since)
    return figure


def main() -> None:
    """Print who walks how far, and leave a picture, a film and a page."""
    study = run()
    for name, values in study.measured.items():
        print(
            f"{name}: {values['travel per cycle [mm]']:+.4f} mm a cycle, sideways "
            f"{values['sideways per cycle [mm]']:+.4f}, turn {values['turn per cycle [degrees]']:+.3f} "
            f"degrees, scatter {values['scatter of the travel']:.1%}, "
            f"support {values['support over weight']:.5f} and horizontal force "
            f"{values['horizontal force over weight']:.1e} of the weight"
        )
    first = next(iter(study.results))
    print(f"{first}, steps half as long: {study.halved['travel per cycle [mm]']:+.4f} mm a cycle")
    low, half, high = np.quantile(study.travels, (0.05, 0.5, 0.95))
    print(
        f"{len(study.travels)} grounds: {half:.3f} mm a cycle, 5 to 95 % {low:.3f} to {high:.3f}, "
        f"all {study.travels.min():.3f} to {study.travels.max():.3f}"
    )
    path = save(picture(study), "quadruped")
    page = Path(OUT / "quadruped.html")
    study.results[first].export_html(page, color="speed")
    film = study.results[first].animate(OUT / "quadruped.gif", color="speed", fps=10)
    print(f"look at {path} and {page} and {film}")


if __name__ == "__main__":
    main()
