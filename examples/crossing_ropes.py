"""Two ropes are thrown across each other and slide, and the answer converges.

How long do they touch, what passes between them, and how much of that is the mesh's or the step's? Two
free ropes without gravity, one at rest, the other coming down across it and along it, with LuGre friction.

Checked: momentum is kept to what Newton's iteration leaves, the energy audit closes within 1 % and closes
better with half the step, and the impulse converges with step and mesh.

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
    """Impulse on the lower rope [N s], (meshes, 3)."""
    steps: tuple[float, ...]
    by_step: np.ndarray
    """The same, (steps, 3)."""
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


def run(
    elements: Sequence[int] = (10, 20, 40, 80),
    steps: Sequence[float] = (1e-3, 5e-4, 2.5e-4, 1.25e-4),
    duration: float = 0.1,
) -> Crossing:
    """Refine the mesh at the shortest step, and the step with the finest mesh but one."""
    meshes = [simulate(n, steps[-1], duration) for n in elements]
    times = [simulate(elements[-2], h, duration) for h in steps]

    def impulses(results: list[pl.Result]) -> np.ndarray:
        return np.array([r.contact_impulse("low")[-1] for r in results])

    gaps = [np.ptp(r.energy.total) / r.energy.kinetic[0] for r in times]
    finest = meshes[-1]
    drift = np.abs(finest.momentum - finest.momentum[0]).max() / np.abs(finest.momentum[0]).max()
    return Crossing(
        finest,
        tuple(elements),
        impulses(meshes),
        tuple(steps),
        impulses(times),
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
    plain(force, "time [ms]", "force on the lower rope [N]", "They bounce, touch again, and slide")
    force.legend(frameon=False)

    def errors(values: np.ndarray) -> np.ndarray:
        return np.linalg.norm(values[:-1] - values[-1], axis=1) / np.linalg.norm(values[-1])

    mesh.loglog(crossing.elements[:-1], errors(crossing.by_elements), "o-", color=BLUE, label="mesh")
    scale = np.array(crossing.steps[:-1]) / crossing.steps[0]
    mesh.loglog(crossing.elements[0] / scale, errors(crossing.by_step), "s-", color=RED, label="step")
    plain(mesh, "elements, or steps in the same proportion", "error of the impulse", "Against the finest")
    mesh.legend(frameon=False)
    audit.loglog(1e3 * np.array(crossing.steps), crossing.gaps, "o-", color=INK)
    audit.axhline(0.01, color=GREY, linewidth=1)
    plain(audit, "step [ms]", "drift of the energy audit", "Energy that the audit cannot place")
    return figure


def main() -> None:
    """Run, report, draw."""
    crossing = run()
    path = save(draw(crossing), "crossing_ropes")
    for n, impulse in zip(crossing.elements, crossing.by_elements, strict=True):
        print(f"{n:3d} elements: impulse on the lower rope {1e3 * impulse} mN s")
    for h, impulse, gap in zip(crossing.steps, crossing.by_step, crossing.gaps, strict=True):
        print(f"{1e3 * h:.3f} ms: {1e3 * impulse} mN s, energy drift {gap:.1e}")
    print(f"momentum drifts by {crossing.momentum:.1e}")
    print(f"look at {path}")


if __name__ == "__main__":
    main()
