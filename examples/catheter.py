"""A catheter is pushed through a bent tube, and not all of the push arrives at its tip.

A rod of 2 mm lies in a tube of 6 mm, straight, bent by a quarter of a circle, straight again, and is pushed
against a spring. In the bend it lies on the outer wall and loses force as a rope on a drum gains it. In the
straight parts it is steady while the push is small; then it waves from side to side, winds itself up along
the wall, and takes more of the push the harder it is pushed.

Checked: in a tube that is little else than the bend, the ratio of forces against exp(mu pi/2) for several
coefficients; the work of the hand against friction, strain and spring.

    python examples/catheter.py
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pliant as pl
from _audit import Audited, audit
from _style import AMBER, BLUE, GREEN, GREY, INK, RED, new_figure, plain, save
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from pliant.scenes import catheter, helical_force, sinusoidal_force

DIAMETER, CLEARANCE, LEAD, BEND = 2e-3, 2e-3, 0.21, 0.05
STIFFNESS = 5e8 * np.pi * DIAMETER**4 / 64
WEIGHT = 1100.0 * 9.81 * np.pi * DIAMETER**2 / 4
# Nothing but a bend: heavy, for the same slow motion with softer contact in fewer steps.
SHORT: dict[str, Any] = {
    "tip": "force",
    "lead": 0.02,
    "gravity": 0.0,
    "density": 1e5,
    "stiffness": 1e6,
    "elements": 24,
    "settling": 0.1,
    "duration": 0.6,
    "step": 1e-3,
}


@dataclass(frozen=True)
class Pushed:
    """The catheter in the long tube, and ratios of forces at the bend of short ones."""

    audited: Audited
    lead: float
    frictions: np.ndarray
    ratios: np.ndarray
    expected: np.ndarray


def run(frictions: Sequence[float] = (0.05, 0.1, 0.2, 0.3), **sizes: Any) -> Pushed:
    """Push the catheter through the long tube, and through short ones."""
    shorts = [catheter(friction=mu, **SHORT) for mu in frictions]
    name = "ratio of forces at the bend"
    ratios = [scene.measure(scene.simulate())[name] for scene in shorts]
    return Pushed(
        audit(pl.scenes.catheter, **sizes),
        sizes.get("lead", LEAD),
        np.array(frictions),
        np.array(ratios),
        np.array([scene.expected[name].value for scene in shorts]),
    )


def draw_tube(axes: Axes, pushed: Pushed) -> None:
    """Draw tube and catheter from above, at the end, coloured by the force in it."""
    result, lead = pushed.audited.result, pushed.lead
    turn = np.linspace(0, np.pi / 2, 60)
    for offset in (-1, 1):
        r = BEND + offset * (DIAMETER / 2 + CLEARANCE)
        x = np.concatenate([[0], lead + r * np.sin(turn), [lead + r]])
        y = np.concatenate([[BEND - r], BEND - r * np.cos(turn), [BEND + lead]])
        axes.plot(1e3 * x, 1e3 * y, color=GREY, linewidth=1)
    line, force = 1e3 * result.positions("catheter")[-1], -result.axial_force("catheter")[-1]
    shade = Normalize(0, force.max())
    for k, value in enumerate(force):
        axes.plot(*line[k : k + 2, :2].T, color=colormaps["plasma"](shade(value)), linewidth=2.5)
    bar = axes.figure.colorbar(ScalarMappable(shade, "plasma"), ax=axes, shrink=0.8, pad=0.02)
    bar.set_label("compression [N]", fontsize=8.5)
    axes.set_aspect("equal")
    plain(axes, "x [mm]", "y [mm]", "From above, at the end")


def draw_forces(axes: Axes, pushed: Pushed) -> None:
    """Draw push and what arrives."""
    result = pushed.audited.result
    force = -result.axial_force("catheter")
    axes.plot(result.time, force[:, 1], color=RED, linewidth=1.5, label="push")
    axes.plot(result.time, force[:, -2], color=BLUE, linewidth=1.5, label="at the tip")
    for value, name in (
        (sinusoidal_force(STIFFNESS, WEIGHT, CLEARANCE), "waves"),
        (helical_force(STIFFNESS, WEIGHT, CLEARANCE), "helices"),
    ):
        axes.axhline(value, color=INK, linewidth=0.8, linestyle=":")
        axes.annotate(name, (0, value), xytext=(2, 2), textcoords="offset points", fontsize=8.5)
    axes.legend(frameon=False, fontsize=8.5, loc="upper left")
    plain(axes, "t [s]", "force [N]", "Forces; dotted: where an endless rod waves, winds")


def draw_sections(axes: Axes, pushed: Pushed) -> None:
    """Draw the tube's section with the nodes of both straight parts, at several times."""
    result = pushed.audited.result
    around = np.linspace(0, 2 * np.pi, 100)
    start = result.positions("catheter")[0]
    before = start[:, 0] < pushed.lead - 0.4 * BEND
    behind = start[:, 1] > 1.4 * BEND
    moments = np.linspace(0.2, 1.0, 5) * result.time[-1]
    for shift, name in ((-3.0, "before the bend"), (3.0, "behind it")):
        ring = 1e3 * CLEARANCE * np.array([np.cos(around), np.sin(around)])
        axes.plot(ring[0] + shift, ring[1], color=GREY, linewidth=1)
        axes.annotate(name, (shift, 2.3), ha="center", fontsize=9)
    for moment, color in zip(moments, (GREY, GREEN, AMBER, RED, INK), strict=True):
        line = 1e3 * result.positions("catheter")[np.argmin(np.abs(result.time - moment))]
        axes.plot(line[before, 1] - 3.0, line[before, 2], color=color, linewidth=1.2, label=f"{moment:.1f} s")
        aside = 1e3 * (pushed.lead + BEND) - line[behind, 0]
        axes.plot(aside + 3.0, line[behind, 2], color=color, linewidth=1.2)
    axes.set_ylim(-2.4, 4.4)
    axes.legend(frameon=False, fontsize=8.5, loc="upper center", ncols=5, columnspacing=1.0)
    axes.set_aspect("equal")
    axes.set_xticks([-5, -3, -1, 1, 3, 5], ["-2", "0", "2", "-2", "0", "2"])
    axes.set_yticks([-2, 0, 2])
    plain(axes, "to the left of the middle [mm]", "up [mm]", "Both straight parts seen along the tube")


def picture(pushed: Pushed) -> Figure:
    """Draw the catheter, its forces, how it winds, and what bends take."""
    figure = new_figure(11.5, 8.2)
    axes = figure.subplots(2, 2)
    draw_tube(axes[0, 0], pushed)
    draw_forces(axes[0, 1], pushed)
    draw_sections(axes[1, 0], pushed)
    fine = np.linspace(0, 1.1 * pushed.frictions.max(), 50)
    axes[1, 1].plot(fine, np.exp(fine * np.pi / 2), color=INK, linewidth=1, label="exp(mu pi/2)")
    axes[1, 1].plot(pushed.frictions, pushed.ratios, "o", color=BLUE, markersize=5, label="found")
    axes[1, 1].legend(frameon=False, fontsize=8.5)
    plain(axes[1, 1], "friction", "force before over force behind", "What a quarter of a circle takes")
    return figure


def main() -> None:
    """Print what is checked, and leave a picture."""
    pushed = run()
    print(pushed.audited.report())
    for name, value in pushed.audited.measured.items():
        print(f"  {name}: {value:.4f}")
    for mu, found, expected in zip(pushed.frictions, pushed.ratios, pushed.expected, strict=True):
        print(f"bend alone, friction {mu:.2f}: ratio {found:.4f}, exp(mu pi/2) = {expected:.4f}")
    print(f"look at {save(picture(pushed), 'catheter')}")


if __name__ == "__main__":
    main()
