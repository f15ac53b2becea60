"""A rope, pinned at one end, falls from the horizontal."""

from __future__ import annotations

import numpy as np

from pliant.materials import LinearElastic
from pliant.model import Model
from pliant.result import Result
from pliant.scenes.scene import Expected, Scene
from pliant.sections import Circle

__all__ = ["falling_rope"]


def falling_rope(
    length: float = 1.0,
    radius: float = 5e-3,
    elements: int = 40,
    youngs_modulus: float = 1e7,
    density: float = 1000.0,
    gravity: float = 9.81,
    duration: float = 1.0,
    step: float = 1e-3,
) -> Scene:
    """Build the scene: a rubber rope, pinned at one end, released from the horizontal.

    Parameters
    ----------
    length, radius : float
        Size of the rope [m].
    elements : int
        Number of elements.
    youngs_modulus, density : float
        Material [Pa], [kg/m^3].
    gravity : float
        Gravity, downwards [m/s^2].
    duration, step : float
        Time to simulate and step [s].

    Returns
    -------
    Scene
        With ``model``, ``simulate()``, ``measure(result)`` and ``expected``.
    """
    model = Model(gravity=(0, 0, -gravity))
    rubber = LinearElastic(youngs_modulus=youngs_modulus, poisson_ratio=0.45, density=density)
    rope = model.add_cable(
        [(0, 0, 0), (length, 0, 0)], elements=elements, section=Circle(radius), material=rubber, name="rope"
    )
    pin = model.pin(rope.start, name="hook")
    weight = density * np.pi * radius**2 * length * gravity

    def measures(result: Result) -> dict[str, float]:
        total = result.energy.total
        acceleration = np.gradient(result.momentum, result.time, axis=0, edge_order=2)
        balance = acceleration - result.reaction(pin).force - [0.0, 0.0, -weight]
        inside = slice(2, -2)
        return {
            "energy drift": float(np.abs(total - total[0]).max() / (weight * length)),
            "momentum balance": float(np.sqrt((balance[inside] ** 2).mean()) / weight),
            "hook gap": float(np.abs(result.track(rope.start).position).max() / length),
        }

    expected = {
        "energy drift": Expected(0.0, 2e-4, "conserved; the scheme damps fast axial waves a little"),
        "momentum balance": Expected(0.0, 2e-3, "d(momentum)/dt = hook's force + weight, by differences"),
        "hook gap": Expected(0.0, 1e-9, "a pin holds its point"),
    }
    return Scene(
        name="falling_rope",
        title="a rubber rope, pinned at one end, falls from the horizontal",
        model=model,
        settings={"duration": duration, "step": step},
        expected=expected,
        measures=measures,
        color="speed",
    )
