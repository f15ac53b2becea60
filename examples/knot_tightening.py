"""A knot is pulled tight, and holds.

What does it take to pull a knot tight? A steel wire of 1 mm with a loose overhand knot is drawn apart by
1 cm/s. Its loop is a circle of radius R, and the pull T bends it further and rubs the strands that lie
round each other: T = EI/(2 R^2) + mu P. In a loose knot P = 0.492 EI/(sqrt(r) R^(3/2)) (Audoly, Clauvelin and
Neukirch, 2007), so that friction outweighs bending where mu sqrt(R/r) is above one.

When does a knot hold? A soft rope is tied, pulled by a force, and let go to the force that it began with.
Without friction its loop would open as far as it was, that is its equilibrium; with friction it stays tied.

Checked: the pull against virtual work; the determinant of the knot, which would change if the wire passed
through itself; the distance of its centre lines; the work of both ends; the slip of the tied rope.

    python examples/knot_tightening.py
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import pliant as pl
from _audit import Audited, audit, draw_energies
from _style import AMBER, BLUE, GREY, INK, RED, new_figure, plain, save
from matplotlib import colormaps
from matplotlib.figure import Figure

WIRE, STIFFNESS, FRICTION = 0.5e-3, 2e11 * np.pi * 0.5e-3**4 / 4, 0.1
"""Radius [m], bending stiffness [N m^2] and friction of the wire."""
PULL, TIMES = 5.0, np.array([0.0, 0.2, 0.4, 0.6, 1.0])
"""Force that ties the rope [N]; when it begins, is reached, ends and has gone, over the duration."""


@dataclass(frozen=True)
class Tied:
    """A rope that was tied and let go."""

    result: pl.Result
    loose: float
    """Force in the equilibrium at the start [N]."""
    loop: np.ndarray
    """Radius of the loop over time [m]."""
    determinants: tuple[int, int]
    """Of the knot at the start and at the end."""

    @property
    def kept(self) -> float:
        """How much of what the loop was drawn tight it keeps after the force has gone."""
        return float((self.loop[0] - self.loop[-1]) / (self.loop[0] - self.loop.min()))

    @property
    def slip(self) -> float:
        """How much the loop moves in the last quarter of the run, over its radius."""
        rest = self.loop[3 * len(self.loop) // 4 :]
        return float(np.ptp(rest) / rest[-1])


@dataclass(frozen=True)
class Study:
    """The wire, and a rope with friction."""

    wire: Audited
    rope: Tied


def tie(friction: float = 0.5, elements: int = 100, step: float = 2e-3, duration: float = 3.0) -> Tied:
    """Pull a rope with a knot by 5 N and let it go to the force at which it was in equilibrium."""
    radius, loop = 4e-3, 0.04
    rubber = pl.LinearElastic(5e6, 0.45, 1100.0, retardation_time=5e-3)
    knot = pl.scenes.loose_knot(loop, radius, 0.8)

    def build(law: pl.LuGre | None) -> pl.Model:
        model = pl.Model()
        section = pl.Circle(radius)
        rope = model.add_cable(
            knot,
            elements=elements,
            section=section,
            material=rubber,
            rest="straight",
            strain="biot",
            name="rope",
        )
        model.add_contact(rope, friction=law)
        return model

    rest = build(None)
    ends = [rest.pin(rest["rope"].start), rest.pin(rest["rope"].end)]
    # The knot might turn about the line of its ends.
    rest.add_spring(rest["rope"].at(knot.length / 2), knot.position(knot.length / 2), 1e-4, length=0.0)
    equilibrium = pl.solve_static(rest)
    loose = -float(equilibrium.reaction(ends[0]).force[-1, 0])
    model = build(pl.LuGre(friction, friction) if friction > 0 else None)
    times = duration * TIMES
    pull = np.array([loose, PULL, PULL, loose, loose])[:, None]
    rope = model["rope"]
    model.add_force(rope.end, pl.Table(times, pull * [1.0, 0.0, 0.0]))
    model.add_force(rope.start, pl.Table(times, pull * [-1.0, 0.0, 0.0]))
    result = pl.simulate(model, duration=duration, step=step, start=equilibrium, output_every=5)
    first, last = pl.scenes.centre_line(result, rope, [0, -1])
    found = pl.scenes.knot_determinant(first), pl.scenes.knot_determinant(last)
    return Tied(result, loose, pl.scenes.loop_radius(result, rope), found)


def run(rope: dict[str, Any] | None = None, **sizes: Any) -> Study:
    """Draw the wire apart; tie a rope."""
    wire = audit(pl.scenes.knot_tightening, friction=FRICTION, diameter=2 * WIRE, **sizes)
    return Study(wire, tie(**(rope or {})))


def picture(study: Study) -> Figure:
    """Draw the wire at three times, the pull over the radius, the ropes, the energies."""
    result, measured = study.wire.result, study.wire.measured
    figure = new_figure(11, 7.4)
    grid = figure.add_gridspec(2, 2)
    space = figure.add_subplot(grid[0, 0])
    frames = [0, len(result.time) // 2, -1]
    for k, points in enumerate(pl.scenes.centre_line(result, "wire", frames)):
        up = points[len(points) // 2, 1:] / np.linalg.norm(points[len(points) // 2, 1:])
        shown = 1e3 * np.stack([points[:, 0], points[:, 1:] @ up], axis=1)
        color = colormaps["viridis"](k / 2.4)
        space.plot(*shown.T, color=color, linewidth=1.3, label=f"{result.time[frames[k]]:.0f} s")
    space.set_xlim(-120, 120)
    space.set_aspect("equal")
    space.legend(frameon=False, fontsize=8.5)
    plain(space, "x [mm]", "mm", "A steel wire of 1 mm, drawn apart by 1 cm/s")

    law = figure.add_subplot(grid[0, 1])
    radii = np.asarray(measured["radius of the loop"])
    pressed = np.asarray(measured["normal force"])
    bent = STIFFNESS / (2 * radii**2)
    law.plot(
        1e3 * radii[5:], np.asarray(measured["pull"])[5:], color=BLUE, linewidth=3, alpha=0.6, label="pull"
    )
    law.plot(
        1e3 * radii[5:], (bent + FRICTION * pressed)[5:], color=INK, linewidth=1, label=r"$EI/2R^2 + \mu P$"
    )
    loose = bent + FRICTION * 0.492 * STIFFNESS / (np.sqrt(WIRE) * radii**1.5)
    law.plot(1e3 * radii, loose, "--", color=RED, linewidth=1, label="the same with $P$ of a loose knot")
    law.plot(1e3 * radii, bent, ":", color=GREY, linewidth=1.5, label="$EI/2R^2$")
    law.legend(frameon=False, fontsize=8.5)
    law.set_ylim(bottom=0)
    plain(law, "radius of the loop [mm]", "N", "Friction takes more than bending")

    ropes = figure.add_subplot(grid[1, 0])
    tied = study.rope
    ropes.axhline(1e3 * tied.loop[0], color=GREY, linewidth=1, linestyle="--")
    ropes.annotate(
        "where it would open to without friction",
        (0.3 * tied.result.time[-1], 1e3 * tied.loop[0] - 2),
        fontsize=8.5,
    )
    ropes.plot(tied.result.time, 1e3 * tied.loop, color=BLUE, linewidth=1.8)
    force = ropes.twinx()
    levels = [tied.loose, PULL, PULL, tied.loose, tied.loose]
    pull = np.interp(tied.result.time, TIMES * tied.result.time[-1], levels)
    force.plot(tied.result.time, pull, color=AMBER, linewidth=1)
    force.set_ylim(0, 2.5 * PULL)
    force.set_ylabel("pull [N]", color=AMBER)
    ropes.set_ylim(bottom=0)
    plain(ropes, "t [s]", "radius of the loop [mm]", "A rope of 8 mm, friction 0.5, pulled and let go")
    draw_energies(figure.add_subplot(grid[1, 1]), result, "The work of pulling the wire")
    return figure


def main() -> None:
    """Print what is checked, and leave a picture."""
    study = run()
    print(study.wire.report())
    tied = study.rope
    print(f"rope: drawn to {1e3 * tied.loop.min():.1f} mm, keeps {100 * tied.kept:.0f} % of that")
    print(f"  and slips by {tied.slip:.1e} of it; determinants of the knot {tied.determinants}")
    print(f"look at {save(picture(study), 'knot_tightening')}")


if __name__ == "__main__":
    main()
