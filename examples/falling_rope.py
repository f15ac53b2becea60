"""A rope, pinned at one end, falls from the horizontal.

How fast is its free end at the lowest place, and where does the energy go? A rubber rope of one metre is
held level and let go. The end of a rigid rod would pass its lowest place with sqrt(3 g L) = 5.42 m/s. The
rope does not stay straight: while its inner part already swings up again, the outer part still falls, and
the energy gathers in the end, as in a whip.

Checked: the energy audit (kinetic + elastic + gravitational + dissipated = what there was) closes with the
order of the time integration, two: half the step leaves a quarter of the gap.

    python examples/falling_rope.py
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pliant as pl
from _style import AMBER, BLUE, GREEN, INK, OUT, RED, new_figure, plain, save, slope_triangle
from matplotlib.figure import Figure

GRAVITY = 9.81
LENGTH = 1.0
RADIUS = 5e-3
DENSITY = 1000.0


@dataclass(frozen=True)
class Fall:
    """A fall and its numbers."""

    result: pl.Result
    rope: pl.Cable
    lowest_time: float
    """Time at which the free end is lowest [s]."""
    lowest_speed: float
    """Speed of the free end then [m/s]."""
    rod_speed: float
    """Speed of a rigid rod's end at its lowest [m/s]."""
    steps: list[float]
    """Steps [s], each half of the one before."""
    gaps: list[float]
    """Largest gap of the energy audit for each step, relative to m g L/2."""

    @property
    def order(self) -> float:
        """Order with which the audit closes."""
        return float(np.log2(self.gaps[-2] / self.gaps[-1]))


def run(elements: int = 40, step: float = 1e-3, duration: float = 1.0, halvings: int = 2) -> Fall:
    """Let the rope fall, and again with smaller steps for the audit."""
    model = pl.Model(gravity=(0, 0, -GRAVITY))
    # Two milliseconds of Kelvin-Voigt damping: rubber is not a bell.
    rubber = pl.LinearElastic(1e7, poisson_ratio=0.45, density=DENSITY, retardation_time=2e-3)
    rope = model.add_cable(
        [(0, 0, 0), (LENGTH, 0, 0)],
        elements=elements,
        section=pl.Circle(RADIUS),
        material=rubber,
        name="rope",
    )
    model.pin(rope.start, name="hook")

    mass = DENSITY * np.pi * RADIUS**2 * LENGTH
    released = mass * GRAVITY * LENGTH / 2
    steps = [step / 2**k for k in range(halvings + 1)]
    results = [pl.simulate(model, duration=duration, step=h) for h in steps]
    totals = [result.energy.total for result in results]
    gaps = [float(np.abs(total - total[0]).max()) / released for total in totals]

    lowest_time, lowest_speed = lowest(results[-1], rope)
    return Fall(results[-1], rope, lowest_time, lowest_speed, np.sqrt(3 * GRAVITY * LENGTH), steps, gaps)


def lowest(result: pl.Result, rope: pl.Cable) -> tuple[float, float]:
    """Time and speed of the free end where it first stops sinking, between the outputs."""
    velocity = result.track(rope.end).velocity
    k = int(np.argmax(velocity[1:, 2] > 0))
    share = velocity[k, 2] / (velocity[k, 2] - velocity[k + 1, 2])
    there = velocity[k] + share * (velocity[k + 1] - velocity[k])
    time = result.time[k] + share * (result.time[k + 1] - result.time[k])
    return float(time), float(np.linalg.norm(there))


def picture(fall: Fall, shapes: int = 21) -> Figure:
    """Draw the shapes at equal times, the energies, and how the audit closes."""
    from matplotlib import colormaps
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import Normalize
    from matplotlib.ticker import NullLocator

    result, rope = fall.result, fall.rope
    figure = new_figure(11, 4.4)
    grid = figure.add_gridspec(2, 2, width_ratios=(1.3, 1))
    strobe, energies, audit = (figure.add_subplot(cell) for cell in (grid[:, 0], grid[0, 1], grid[1, 1]))

    positions = result.positions(rope)
    norm, colors = Normalize(0, result.time[-1]), colormaps["viridis"]
    for k in np.linspace(0, len(result.time) - 1, shapes).astype(int):
        line = positions[k]
        strobe.plot(line[:, 0], line[:, 2], color=colors(norm(result.time[k])), linewidth=1.6)
    trace = result.track(rope.end).position
    strobe.plot(trace[:, 0], trace[:, 2], ":", color=RED, linewidth=1.1)
    now = int(np.searchsorted(result.time, fall.lowest_time))
    strobe.plot(*trace[now, [0, 2]], "o", color=RED, markersize=5)
    strobe.annotate(
        f"lowest: {fall.lowest_speed:.2f} m/s\n(rigid rod: {fall.rod_speed:.2f} m/s)",
        trace[now, [0, 2]],
        xytext=(0.42, -1.07),
        color=RED,
        arrowprops={"arrowstyle": "-", "color": RED, "linewidth": 0.7},
    )
    strobe.plot(0, 0, "o", color=INK, markersize=6)
    strobe.set_aspect("equal")
    strobe.set_ylim(-1.12, 0.18)
    every = 1e3 * result.time[-1] / (shapes - 1)
    plain(strobe, "x [m]", "z [m]", f"A rope falls: its shape every {every:.0f} ms, the path of its free end")
    scale = strobe.inset_axes((0.035, 0.17, 0.19, 0.03))
    figure.colorbar(ScalarMappable(norm, colors), cax=scale, orientation="horizontal", label="time [s]")

    energy = result.energy
    curves = {
        "given by gravity": (energy.gravitational[0] - energy.gravitational, INK),
        "kinetic": (energy.kinetic, BLUE),
        "elastic": (energy.elastic, GREEN),
        "dissipated": (energy.dissipated, AMBER),
        "gap of the audit": (np.abs(energy.total - energy.total[0]), RED),
    }
    for name, (values, color) in curves.items():
        energies.semilogy(result.time[1:], values[1:], color=color, linewidth=1.4, label=name)
    energies.legend(frameon=False, fontsize=8, loc="upper left", bbox_to_anchor=(1.0, 1.0))
    energies.set_xlim(0, result.time[-1])
    energies.set_ylim(1e-8, 1.0)
    plain(energies, "time [s]", "energy [J]", "Where the energy goes")

    milliseconds = [1e3 * h for h in fall.steps]
    audit.loglog(milliseconds, fall.gaps, "o-", color=BLUE)
    slope_triangle(audit, milliseconds[-1] * 1.1, fall.gaps[-1] * 0.6, 2)
    audit.set_xticks(milliseconds, [f"{h:g}" for h in milliseconds])
    audit.set_ylim(0.4 * fall.gaps[-1], 2.5 * fall.gaps[0])
    audit.xaxis.set_minor_locator(NullLocator())
    plain(audit, "step [ms]", "gap / energy set free", f"The energy audit closes with order {fall.order:.2f}")
    return figure


def main() -> None:
    """Print the numbers, leave a picture and an interactive page."""
    fall = run()
    energy = fall.result.energy
    print(f"lowest after {fall.lowest_time:.4f} s with {fall.lowest_speed:.3f} m/s", end=" ")
    print(f"(a rigid rod: {fall.rod_speed:.3f} m/s)")
    print(f"largest kinetic energy {energy.kinetic.max():.4f} J, dissipated {energy.dissipated[-1]:.4f} J")
    for step, gap in zip(fall.steps, fall.gaps, strict=True):
        print(f"step {1e3 * step:5.3f} ms: energy audit closes to {gap:.1e}")
    print(f"order {fall.order:.3f}")
    path = save(picture(fall), "falling_rope")
    fall.result.export_html(OUT / "falling_rope.html", color="speed")
    print(f"look at {path} and {path.with_suffix('.html')}")


if __name__ == "__main__":
    main()
