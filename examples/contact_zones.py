"""A wavy rope falls on a straight one, and the distance along it tells where they touch.

Along the wave the distance of the surfaces is a function with many minima. Zones of contact are where it lies
below zero; the core finds them without a grid and without a miss, whatever the elements.

Checked: the zones, their smallest gaps and their number against the distance sampled at thousands of points,
at every time; and the momentum that the straight rope got against the impulse of the contact.

    python examples/contact_zones.py
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pliant as pl
from _style import BLUE, GREY, INK, RED, new_figure, plain, save
from matplotlib.figure import Figure
from scipy.integrate import cumulative_simpson
from scipy.interpolate import CubicSpline

RADIUS = 4e-3
LENGTH = 1.0
WAVES = 3


@dataclass(frozen=True)
class Zones:
    """The run, and the distance of the surfaces along the wave at every output."""

    result: pl.Result
    along: np.ndarray
    """Places on the wave, as parts of its length, (p,)."""
    gaps: np.ndarray
    """Distance of the surfaces there [m], (n, p)."""
    places: np.ndarray
    """Their positions [m], (n, p, 3)."""
    found: list[list[float]]
    """Smallest gaps of the zones that the core found [m], sorted, for every output."""
    sampled: list[list[float]]
    """The same from the samples."""
    balance: float
    """Impulse of the contact on the straight rope less its momentum, over it."""


def simulate(elements: int = 30, duration: float = 0.02, step: float = 5e-4) -> pl.Result:
    """Throw a wave on a straight rope, without gravity."""
    model = pl.Model()
    soft = pl.LinearElastic(youngs_modulus=5e6, poisson_ratio=0.4, density=1200.0, retardation_time=1e-3)
    kind = {"section": pl.Circle(radius=RADIUS), "material": soft}
    line = [(-0.1, 0, 0), (LENGTH + 0.1, 0, 0)]
    low = model.add_cable(line, elements=elements // 2, name="straight", **kind)
    # It comes down a little aslant: the crossings touch one after the other.
    x = np.linspace(0, LENGTH, 4001)
    points = np.stack([x, 0.05 * np.cos(2 * np.pi * WAVES * x), 2 * RADIUS + 1e-3 + 4e-3 * x], axis=1)
    speed = np.linalg.norm(CubicSpline(x, points)(x, 1), axis=1)
    s = cumulative_simpson(speed, x=x, initial=0)
    wave = pl.Curve(CubicSpline(s, points), length=s[-1])
    high = model.add_cable(
        wave, elements=elements, velocity=(0, 0, -1.0), name="wave", rest="straight", **kind
    )
    model.add_contact(high, low, friction=pl.LuGre(static=0.4, dynamic=0.3))
    return pl.simulate(model, duration=duration, step=step, progress=False)


def positions(result: pl.Result, name: str, parts: np.ndarray) -> np.ndarray:
    """Places of a rope at parts of its length, (n, p, 3)."""
    rope = result.model[name]
    length = rope.length
    return np.stack([result.track(rope.at(float(x) * length)).position for x in parts], axis=1)


def distance(points: np.ndarray, line: np.ndarray) -> np.ndarray:
    """Distance of points (p, 3) from a fine polyline (k, 3), (p,)."""
    a, along = line[:-1], np.diff(line, axis=0)
    part = np.einsum("pki,ki->pk", points[:, None] - a, along) / (along**2).sum(axis=1)
    feet = a + np.clip(part, 0, 1)[..., None] * along
    return np.linalg.norm(points[:, None] - feet, axis=2).min(axis=1)


def minima(gaps: np.ndarray) -> list[float]:
    """Smallest gaps of the stretches below zero, sorted."""
    below = np.flatnonzero(gaps < 0)
    stretches = np.split(below, np.flatnonzero(np.diff(below) > 1) + 1)
    return sorted(float(gaps[part].min()) for part in stretches if len(part))


def run(elements: int = 30, samples: int = 3000, duration: float = 0.02) -> Zones:
    """Run, sample the distance, compare."""
    result = simulate(elements, duration)
    along = np.linspace(0, 1, samples)
    places = positions(result, "wave", along)
    line = positions(result, "straight", np.linspace(0, 1, 600))
    gaps = np.array([distance(p, q) for p, q in zip(places, line, strict=True)]) - 2 * RADIUS
    mass = 1200.0 * np.pi * RADIUS**2 * result.model["straight"].length
    momentum = mass * (result.center_of_mass("straight")[-1] - result.center_of_mass("straight")[-2])
    momentum = momentum[2] / (result.time[-1] - result.time[-2])
    impulse = result.contact_impulse("straight")[:, 2]
    balance = 0.5 * (impulse[-1] + impulse[-2]) / momentum - 1.0
    return Zones(
        result,
        along,
        gaps,
        places,
        [sorted(patch.gap for patch in row) for row in result.contacts],
        [minima(row) for row in gaps],
        float(balance),
    )


def draw(zones: Zones) -> Figure:
    """Draw the ropes from above with the forces, and the distance along the wave with its zones."""
    figure = new_figure(10.5, 6.2)
    above, distances = figure.subplots(2, 1)
    result = zones.result
    # The time at which most zones touch.
    frame = int(np.argmax([len(row) for row in zones.found]))
    patches = result.contacts[frame]
    x, y, _ = zones.places[frame].T
    straight = result.positions("straight")[frame]
    above.plot(straight[:, 0], straight[:, 1], color=BLUE, linewidth=3, label="straight rope")
    above.plot(x, y, color=RED, linewidth=3, label="wave")
    size = max(patch.normal_force for patch in patches)
    for patch in patches:
        above.plot(*patch.point[:2], "o", color=INK, markersize=4 + 8 * patch.normal_force / size, alpha=0.8)
    above.set_ylim(-0.09, 0.12)
    above.legend(frameon=False, ncols=2, loc="upper right")
    moment = 1e3 * result.time[frame]
    title = f"From above at {moment:.1f} ms; dots are as large as the forces, {size:.1f} N at most"
    plain(above, "x [m]", "y [m]", title)
    gaps = 1e3 * zones.gaps[frame]
    distances.plot(zones.along, gaps, color=INK)
    distances.axhline(0, color=GREY, linewidth=1)
    distances.fill_between(zones.along, gaps, 0, where=gaps < 0, color=RED)
    for patch in patches:
        at = zones.along[np.linalg.norm(zones.places[frame] - patch.point, axis=1).argmin()]
        distances.annotate(
            f"{1e6 * -patch.gap:.0f} µm", (at, 0), (at, 9), ha="center", color=RED, fontsize=9,
            arrowprops={"arrowstyle": "-", "color": RED, "linewidth": 0.8},
        )  # fmt: skip
    distances.set_ylim(-2, 48)
    title = "The distance along the wave, and how deep its zones are"
    plain(distances, "part of the wave's length", "distance of the surfaces [mm]", title)
    return figure


def main() -> None:
    """Run, report, draw."""
    zones = run()
    path = save(draw(zones), "contact_zones")
    pairs = [(f, s) for f, s in zip(zones.found, zones.sampled, strict=True)]
    most = max(len(f) for f, _ in pairs)
    apart = max((abs(np.subtract(f, s)).max() for f, s in pairs if f and len(f) == len(s)), default=0.0)
    same = sum(len(f) == len(s) for f, s in pairs)
    print(f"up to {most} zones; their number is the sampled one at {same} of {len(pairs)} outputs")
    print(f"smallest gaps differ from the sampled ones by {1e6 * apart:.3f} um at most")
    print(f"impulse of the contact over momentum of the straight rope - 1 = {zones.balance:.1e}")
    print(f"look at {path}")


if __name__ == "__main__":
    main()
