"""What a scene is."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np

from pliant import _check
from pliant.drawing import COLORS
from pliant.materials import LinearElastic
from pliant.model import Model
from pliant.result import Result
from pliant.sections import Section
from pliant.simulation import simulate

__all__ = ["Expected", "Scene", "energy_drift", "line"]


class Expected(NamedTuple):
    """What a measure must be, within a tolerance, and why."""

    value: float
    tolerance: float
    source: str


@dataclass(frozen=True)
class Scene:
    """A model with the run that belongs to it and what the run must show.

    Attributes
    ----------
    name, title : str
        Name and one line about it.
    model : Model
        The model.
    settings : dict
        Arguments of :func:`pliant.simulate`.
    expected : dict of Expected
        What the measures must be.
    color : str or None
        Quantity that colours the pictures.
    begin : callable, optional
        Gives the state from which the run starts, an equilibrium for instance; called once, when needed.
    """

    name: str
    title: str
    model: Model
    settings: Mapping[str, Any]
    expected: Mapping[str, Expected]
    measures: Callable[[Result], dict[str, Any]]
    color: str | None = None
    begin: Callable[[], Result] | None = None
    _begun: list[Result] = field(default_factory=list, init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        if self.color is not None:
            _check.choice(self.color, "color", COLORS)

    @property
    def start(self) -> Result | None:
        """State from which the run starts; None: the model as it was built."""
        if self.begin is not None and not self._begun:
            self._begun.append(self.begin())
        return self._begun[0] if self._begun else None

    def simulate(self, **settings: Any) -> Result:
        """Run the scene; ``settings`` replace its own."""
        if "start" not in settings and self.begin is not None:
            settings["start"] = self.start
        return simulate(self.model, **{**self.settings, **settings})

    def measure(self, result: Result) -> dict[str, Any]:
        """Return the figures that ``expected`` speaks about, and what else is worth reading."""
        return self.measures(result)

    def failures(self, measured: Mapping[str, float]) -> list[str]:
        """Names of the measures that are not as expected."""
        wanted = self.expected.items()
        return [key for key, (value, tolerance, _) in wanted if not abs(measured[key] - value) <= tolerance]

    def report(self, measured: Mapping[str, float]) -> str:
        """Print measures beside what they must be, a line each."""
        failed = self.failures(measured)
        return "\n".join(
            f"  {'FAIL' if key in failed else 'ok  '} {key} = {measured[key]:.5g}, "
            f"expected {value:.5g} +- {tolerance:.2g} ({source})"
            for key, (value, tolerance, source) in self.expected.items()
        )


def energy_drift(result: Result) -> float:
    """Largest change of the sum of energies, over the largest amount that any of them exchanged."""
    energy = result.energy
    parts = (energy.kinetic, energy.elastic, energy.gravitational, energy.dissipated, energy.work)
    total = energy.total
    return float(np.abs(total - total[0]).max() / max(np.ptp(part) for part in parts))


def line(
    axial_stiffness: float,
    bending_stiffness: float,
    mass: float,
    radius: float,
    retardation_time: float = 0.0,
) -> dict[str, Any]:
    """Section and material of a line of given stiffness EA [N], EI [N m^2], and mass [kg/m].

    ``radius`` [m] is that of the outline, for contact, wind and pictures.
    """
    area = np.pi * radius**2
    modulus = axial_stiffness / area
    second = bending_stiffness / modulus
    return {
        "section": Section(area, second_moments=(second, second), torsion_constant=2 * second, radius=radius),
        "material": LinearElastic(modulus, 0.3, mass / area, retardation_time=retardation_time),
    }
