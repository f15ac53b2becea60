"""A scene run with a step and half of it: what it shows, and how well its energies add up."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import pliant as pl
from _style import AMBER, BLUE, GREEN, INK, RED, plain

if TYPE_CHECKING:
    from matplotlib.axes import Axes


@dataclass(frozen=True)
class Audited:
    """A scene and its runs."""

    scene: pl.scenes.Scene
    result: pl.Result
    """The run with the shorter steps."""
    measured: dict[str, float]
    """What it shows, as ``scene.expected`` has it."""
    steps: tuple[float, float]
    """Lengths of the steps [s]."""
    drifts: tuple[float, float]
    """Largest changes of the sum of energies over the largest that was exchanged."""

    def report(self) -> str:
        """Print what was measured beside what is expected, and the drifts."""
        said = [f"{self.scene.title}:", self.scene.report(self.measured)]
        for step, drift in zip(self.steps, self.drifts, strict=True):
            said.append(f"  steps of {1e3 * step:g} ms: the sum of energies drifts by {drift:.1e}")
        return "\n".join(said)


def audit(build: Callable[..., pl.scenes.Scene], **sizes: Any) -> Audited:
    """Run a scene with its step and with half of that."""
    scene = build(**sizes)
    step = scene.settings["step"]
    coarse = pl.scenes.energy_drift(scene.simulate())
    finer = build(**{**sizes, "step": step / 2})
    result = finer.simulate()
    drifts = (coarse, pl.scenes.energy_drift(result))
    return Audited(finer, result, finer.measure(result), (step, step / 2), drifts)


def draw_energies(axes: Axes, result: pl.Result, title: str, unit: str = "J", scale: float = 1.0) -> None:
    """Draw the energies that take part, from their start on, and their sum."""
    energy = result.energy
    parts = (
        (energy.kinetic, BLUE, "kinetic"),
        (energy.elastic - energy.elastic[0], AMBER, "elastic"),
        (energy.gravitational - energy.gravitational[0], GREEN, "gravitational"),
        (energy.dissipated, RED, "dissipated"),
        (-energy.work, "#7b5ea7", "work, negative"),
    )
    largest = max(abs(values).max() for values, _, _ in parts)
    for values, color, name in parts:
        if abs(values).max() > 5e-3 * largest:
            axes.plot(result.time, values / scale, color=color, linewidth=1.2, label=name)
    total = energy.total - energy.total[0]
    axes.plot(result.time, total / scale, color=INK, linewidth=1.4, label="sum")
    axes.legend(frameon=False, fontsize=8.5)
    plain(axes, "t [s]", f"energy [{unit}]", title)
