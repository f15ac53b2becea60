"""What a scene is."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

from pliant.model import Model
from pliant.result import Result
from pliant.simulation import simulate

__all__ = ["Expected", "Scene"]


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
    """

    name: str
    title: str
    model: Model
    settings: Mapping[str, Any]
    expected: Mapping[str, Expected]
    measures: Callable[[Result], dict[str, float]]
    color: str | None = None

    def simulate(self, **settings: Any) -> Result:
        """Run the scene; ``settings`` replace its own."""
        return simulate(self.model, **{**self.settings, **settings})

    def measure(self, result: Result) -> dict[str, float]:
        """Return the figures that ``expected`` speaks about."""
        return self.measures(result)
