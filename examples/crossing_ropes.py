"""Two ropes are thrown across each other and slide, and the answer converges.

How long do they touch, what passes between them, and how much of that is the mesh's or the step's? Two
free ropes without gravity, one at rest, the other coming down across it and along it, with LuGre friction.

Checked: momentum is kept to what Newton's iteration leaves, the energy audit closes within 1 % and closes
better with half the step, and where the ropes are in the end converges with step and mesh.

    python examples/crossing_ropes.py
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pliant as pl
from _style import BLUE, GREEN, GREY, INK, RED, new_figure, plain, save, scale_bar, seen_from
from matplotlib.figure import Figure

RADIUS = 5e-3
LENGTH = 0.6
SPEED = np.array([0.8, 0.0, -1.5])


@dataclass(frozen=True)
class Crossing:
    """Runs at several steps and meshes."""

    finest: pl.Result
    elements: tuple[int, ...]
    by_elements: np.ndarray
    """Ends and middles of both ropes at the end [m], (meshes, 6, 3)."""
    steps: tuple[float, ...]
    by_step: np.ndarray
    """The same, (steps, 6, 3)."""
    gaps: np.ndarray
    """Drift of the energy audit over the energy of the blow, one a step."""
    momentum: float
    """Drift of the momentum over that of the thrown rope."""


def simulate(elements: int, step: float, duration: float) -> pl.Result:
    """Throw one rope across the other."""
    model = pl.Model()
    soft = pl.LinearElastic(youngs_modulus=5e6, poisson_ratio=0.4, density=1200.0, retardation_time=1e-3)
    kind = {"elements": elements, "section": pl.Circle(radius=RADIUS), "material": soft}
    low = model.add_cable([(-LENGTH / 2, 0, 0), (LENGTH / 2, 0.02, 0)], **kind, name="low")
    z = 2 * RADIUS + 2e-3
    high = model.add_cable(
        [(0.03, -LENGTH / 2, z), (0.01, LENGTH / 2, z)], **kind, velocity=SPEED, name="high"
    )
    model.add_contact(low, high, friction=pl.LuGre(static=0.5, dynamic=0.4))
    return pl.simulate(model, duration=duration, step=step, progress=False)


def places(result: pl.Result) -> np.ndarray:
    """Find ends and middles of both ropes at the end, (6, 3)."""
    ropes = [result.model[name] for name in ("low", "high")]
    return np.array(
        [result.track(rope.at(x * rope.length)).position[-1] for rope in ropes for x in (0.0, 0.5, 1.0)]
    )


def errors(refined: np.ndarray) -> np.ndarray:
    """Largest distance of a point from where the finest run has it, for all coarser ones [m]."""
    apart: np.ndarray = np.linalg.norm(refined[:-1] - refined[-1], axis=2).max(axis=1)
    return apart


def run(
    elements: Sequence[int] = (10, 20, 40, 80),
    steps: Sequence[float] = (1e-3, 5e-4, 2.5e-4, 1.25e-4, 6.25e-5),
    duration: float = 0.1,
) -> Crossing:
    """Refine the mesh at the shortest step, and the step with the finest mesh but one."""
    meshes = [simulate(n, steps[-1], duration) for n in elements]
    times = [simulate(elements[-2], h, duration) for h in steps]

    gaps = [np.ptp(r.energy.total) / r.energy.kinetic[0] for r in times]
    finest = meshes[-1]
    drift = np.abs(finest.momentum - finest.momentum[0]).max() / np.abs(finest.momentum[0]).max()
    return Crossing(
        finest,
        tuple(elements),
        np.array([places(r) for r in meshes]),
        tuple(steps),
        np.array([places(r) for r in times]),
        np.array(gaps),
        float(drift),
    )


def draw(crossing: Crossing) -> Figure:
    """Draw the blow, its force, the refinement."""
    figure = new_figure(10.5, 6.4)
    scene, force, mesh, audit = figure.subplots(2, 2).flat
    result = crossing.finest
    moments = np.linspace(0, len(result.time) - 1, 5).astype(int)
    for k, shade in zip(moments, np.linspace(0.25, 1.0, len(moments)), strict=True):
        for name, colour in (("low", BLUE), ("high", RED)):
            x, y = seen_from(result.positions(name)[k], 35.0, 20.0).T
            scene.plot(x, y, color=colour, alpha=shade, linewidth=2)
    scale_bar(scene, -0.3, -0.25, 0.1, "0.1 m")
    scene.set_title("Every 25 ms: the red rope comes down on the blue one", fontsize=10.5, loc="left")
    f = result.contact_force("low")
    for axis, colour, label in ((2, INK, "down"), (0, GREEN, "along the lower rope")):
        force.plot(1e3 * result.time, -f[:, axis] if axis == 2 else f[:, axis], color=colour, label=label)
    plain(force, "time [ms]", "force on the lower rope [N]", "They hit, press on each other, and slide")
    force.legend(frameon=False)

    mesh.loglog(crossing.elements[:-1], 1e6 * errors(crossing.by_elements), "o-", color=BLUE, label="mesh")
    scale = np.array(crossing.steps[:-1]) / crossing.steps[0]
    mesh.loglog(crossing.elements[0] / scale, 1e6 * errors(crossing.by_step), "s-", color=RED, label="step")
    title = f"Ends and middles after {1e3 * result.time[-1]:.0f} ms, against the finest"
    plain(mesh, f"elements, or {crossing.elements[0]} times 1 ms over the step", "error [µm]", title)
    mesh.legend(frameon=False)
    audit.loglog(1e3 * np.array(crossing.steps), crossing.gaps, "o-", color=INK)
    audit.axhline(0.01, color=GREY, linewidth=1)
    plain(audit, "step [ms]", "drift of the energy audit", "Energy that the audit cannot place")
    return figure


def main() -> None:
    """Run, report, draw."""
    crossing = run()
    path = save(draw(crossing), "crossing_ropes")
    for n, error in zip(crossing.elements, errors(crossing.by_elements), strict=False):
        print(f"{n:3d} elements: ends and middles within {1e6 * error:.2f} um of the finest mesh's")
    for h, error, gap in zip(crossing.steps, errors(crossing.by_step), crossing.gaps, strict=False):
        print(f"{1e3 * h:.4f} ms: within {1e6 * error:.2f} um of the shortest step's, energy drift {gap:.1e}")
    impulse = crossing.finest.contact_impulse("low")[-1]
    print(f"impulse on the lower rope {1e3 * impulse} mN s")
    print(f"momentum drifts by {crossing.momentum:.1e}")
    print(f"look at {path}")


if __name__ == "__main__":
    main()
