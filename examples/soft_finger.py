"""A soft finger with two notches is bent and let go.

Which model of it is good enough, and how does it move? How few parameters describe the bending of a soft
body depends on how its softness is distributed. Here a technique is recommended, and the advice is checked
against finite elements. Then the same body swings in a simulation, as a cable with its varying section.

Checked: the predicted error of every technique is that against finite elements within a point; the cable's
end at rest is that of the elastica; the finger swings with the frequency of its first mode, and its energy
audit closes.

    python examples/soft_finger.py
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pliant as pl
from _style import AMBER, BLUE, GREEN, GREY, INK, RED, new_figure, plain, save
from matplotlib.figure import Figure

MOMENT = 4e-3
DAMPING = 2e-3
"""Retardation time of the silicone [s]."""
TECHNIQUES = ("lumped", "matrix", "hybrid", "elastica", "finite_element")
COLORS = dict(zip(TECHNIQUES, (RED, GREEN, AMBER, BLUE, GREY), strict=True))
NAMES = {
    "lumped": "lumped: two springs",
    "matrix": "matrix analysis: 6 beams",
    "hybrid": "hybrid: springs in a beam",
    "elastica": "elastica",
    "finite_element": "finite elements",
}


def finger() -> pl.sdi.Body:
    """Make a silicone finger of 10 cm with two notches, the softer one towards the clamp."""
    cuts = [(0.035, 0.04, 0.0035), (0.075, 0.03, 0.0045)]
    return pl.sdi.notches(0.1, height=0.01, width=0.015, notches=cuts, youngs_modulus=1e6)


@dataclass(frozen=True)
class Finger:
    """The finger bent by each technique, the advice, and its swing after the moment is let go."""

    body: pl.sdi.Body
    advice: pl.sdi.Recommendation
    shapes: dict[str, pl.sdi.Shape]
    errors: dict[str, float]
    """Error of each technique against finite elements."""
    time: np.ndarray
    shown: np.ndarray
    """Nodes of the finger at a few times while it swings back [m], (k, nodes, 2)."""
    height: np.ndarray
    """Height of its end over the time [m]."""
    at_rest: float
    """Distance of the cable's end, bent by the moment, from that of the elastica [m]."""
    frequency: float
    """First mode [Hz]."""
    swing: float
    """Frequency of the small swing [Hz]."""
    audit: float
    """Largest change of the total energy, over the energy that the moment had stored."""


def swing(
    body: pl.sdi.Body, moment: float, duration: float, step: float
) -> tuple[pl.Result, pl.Result, pl.Cable]:
    """Bend the finger by a moment, then let it go."""
    bent = pl.Model()
    cable = body.add_to(bent, elements=20, density=1100.0, retardation_time=DAMPING, name="finger")
    bent.clamp(cable.start)
    bent.add_moment(cable.end, (0, 0, moment))
    rest = pl.solve_static(bent, load_steps=4)
    free = pl.Model()
    cable = body.add_to(free, elements=20, density=1100.0, retardation_time=DAMPING, name="finger")
    free.clamp(cable.start)
    return rest, pl.simulate(free, duration=duration, step=step, start=rest), cable


def period(time: np.ndarray, height: np.ndarray) -> float:
    """Mean time between passages upwards through zero [s]."""
    up = np.flatnonzero((height[:-1] < 0) & (height[1:] >= 0))
    crossing = time[up] - height[up] * (time[up + 1] - time[up]) / (height[up + 1] - height[up])
    return float(np.diff(crossing).mean())


def run(mesh: tuple[int, int] = (80, 6), duration: float = 1.6, step: float = 1e-3) -> Finger:
    """Choose a technique for the finger, check the choice, and let the finger swing."""
    body = finger()
    advice = pl.sdi.recommend(body, moment=MOMENT, tolerance=0.05, techniques=TECHNIQUES)
    shapes = {name: pl.sdi.bend(body, moment=MOMENT, technique=name) for name in TECHNIQUES[:-1]}
    truth = pl.sdi.bend(body, moment=MOMENT, technique="finite_element", elements=mesh)
    shapes["finite_element"] = truth
    errors = {name: shape.error(truth) for name, shape in shapes.items()}

    rest, result, cable = swing(body, MOMENT, duration, step)
    end = rest.track(rest.model["finger"].end).position[-1, :2]
    energy = result.energy
    # A small swing has the frequency of the first mode.
    _, small, _ = swing(body, 0.005 * MOMENT, duration, step)
    height = small.track(small.model["finger"].end).position[:, 1]
    modes = pl.solve_modes(result.model, count=1)
    positions = result.positions(cable)
    return Finger(
        body,
        advice,
        shapes,
        errors,
        result.time,
        positions[:: max(1, int(0.02 / step)), :, :2][:9],
        positions[:, -1, 1],
        float(np.hypot(*(end - shapes["elastica"].tip))),
        float(modes.frequencies[0]),
        1.0 / period(small.time, height - height.mean()),
        float(np.abs(energy.total - energy.total[0]).max() / energy.elastic[0]),
    )


def picture(found: Finger) -> Figure:
    """Draw the bent finger by each technique, predicted and found errors, and the swing."""
    figure = new_figure(12.4, 4.4)
    bent, errors, moving = figure.subplots(1, 3, width_ratios=(1.15, 0.9, 1.15))
    for name in reversed(TECHNIQUES):
        shape, solid = found.shapes[name], name == "finite_element"
        marker = "o-" if len(shape.x) < 12 else "-"
        width = 7.0 if solid else 1.7
        look = {"linewidth": width, "alpha": 0.45 if solid else 1.0, "markersize": 4}
        bent.plot(1e3 * shape.x, 1e3 * shape.y, marker, color=COLORS[name], label=NAMES[name], **look)
    bent.plot([0, 0], [-7, 7], color=INK, linewidth=4, solid_capstyle="butt")
    bent.set_aspect("equal")
    bent.legend(frameon=False, fontsize=8.5, loc="upper left")
    index = found.body.index
    plain(bent, "x [mm]", "y [mm]", f"SDI = {index.real:.2f} + {index.imag:.3f} i")

    places = np.arange(len(TECHNIQUES) - 1)
    rows = {row.technique: row.error for row in found.advice.table}
    for shift, values, color, label in (
        (-0.2, rows, GREY, "predicted, in milliseconds"),
        (0.2, found.errors, BLUE, "against finite elements"),
    ):
        bars = errors.bar(
            places + shift, [100 * values[t] for t in TECHNIQUES[:-1]], 0.36, color=color, label=label
        )
        errors.bar_label(bars, fmt="%.1f", fontsize=8)
    errors.axhline(100 * found.advice.tolerance, color=RED, linewidth=1.2, linestyle="--")
    errors.annotate(
        "wanted", (len(places) - 1.4, 100 * found.advice.tolerance + 0.15), color=RED, fontsize=8.5
    )
    errors.set_xticks(places, TECHNIQUES[:-1])
    errors.legend(frameon=False, fontsize=8.5)
    plain(errors, "", "error of the end [% of the displacement]", f"recommended: {found.advice.technique}")

    for i, nodes in enumerate(found.shown):
        strength = 1.0 - 0.85 * i / max(1, len(found.shown) - 1)
        moving.plot(1e3 * nodes[:, 0], 1e3 * nodes[:, 1], color=BLUE, alpha=strength, linewidth=2)
    moving.plot([0, 0], [-7, 7], color=INK, linewidth=4, solid_capstyle="butt")
    moving.set_aspect("equal")
    plain(moving, "x [mm]", "y [mm]", f"let go, every 20 ms; first mode {found.frequency:.2f} Hz")
    return figure


def main() -> None:
    """Print the advice and the errors, and leave a picture."""
    found = run()
    print(found.advice)
    print("\nerror against finite elements:")
    for name in TECHNIQUES[:-1]:
        print(f"{name:20s} {100 * found.errors[name]:5.1f} %")
    for part in pl.sdi.features(found.body):
        print(f"notch at {1e3 * part.center:.0f} mm: index {part.index.real:.2f} + {part.index.imag:.4f} i")
    print(f"cable against elastica: {1e6 * found.at_rest:.1f} um")
    print(f"first mode {found.frequency:.3f} Hz, small swing {found.swing:.3f} Hz")
    print(f"energy audit {found.audit:.1e}")
    print(f"look at {save(picture(found), 'soft_finger')}")


if __name__ == "__main__":
    main()
