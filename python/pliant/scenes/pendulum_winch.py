"""A pendulum is hauled in while it swings."""

from __future__ import annotations

import numpy as np
from scipy.integrate import solve_ivp

from pliant.model import Model
from pliant.result import Result
from pliant.scenes.scene import Expected, Scene, energy_drift, line
from pliant.signals import Table
from pliant.typing import FloatArray

__all__ = ["pendulum_winch"]


def pendulum_winch(
    first: float = 10.0,
    last: float = 5.0,
    haul: float = 150.0,
    angle: float = 0.05,
    load: float = 100.0,
    mass: float = 1e-3,
    axial_stiffness: float = 1e6,
    retardation_time: float = 1e-2,
    gravity: float = 9.81,
    duration: float = 170.0,
    step: float = 1e-2,
) -> Scene:
    """Build the scene: a winch shortens a pendulum slowly, and its swing grows.

    Energy over frequency stays, the adiabatic invariant of Lorentz and Einstein: the angle grows as
    ``length^(-3/4)``. The length goes smoothly from one value to the other.

    Parameters
    ----------
    first, last : float
        Lengths of the cable [m].
    haul : float
        Time that hauling takes [s]; the faster, the less is the invariant one.
    angle : float
        Angle from which the pendulum is let go [rad].
    load, mass : float
        Mass at the end [kg], mass per length of the cable [kg/m].
    axial_stiffness : float
        EA of the cable [N].
    retardation_time : float
        Damping of its stretch (Kelvin-Voigt) [s].
    gravity : float
        Gravity [m/s^2].
    duration, step : float
        Time to simulate and step [s].

    Returns
    -------
    Scene
        With ``model``, ``simulate()``, ``measure(result)`` and ``expected``.
    """

    def length(t: FloatArray | float) -> FloatArray:
        share = np.minimum(np.asarray(t) / haul, 1.0)
        return np.asarray(first + (last - first) * share**3 * (10 - 15 * share + 6 * share**2))

    times = np.linspace(0.0, haul, 161)
    lengths = Table(times, length(times), smooth=True)
    model = Model(gravity=(0, 0, -gravity))
    cable = model.add_cable(
        [(0, 0, 0), (first * np.sin(angle), 0, -first * np.cos(angle))],
        elements=1,
        strain="biot",
        rest_length=lengths,
        name="cable",
        **line(axial_stiffness, 1e-6, mass, 5e-3, retardation_time),
    )
    model.pin(cable.start)
    model.add_point_mass(load, at=cable.end, name="load")

    stretch = 1 + load * gravity / axial_stiffness

    def rates(t: float, state: np.ndarray) -> tuple[float, float]:
        """Move a point on a line of given length: angle, and angular momentum per mass."""
        long = stretch * float(length(t))
        return state[1] / long**2, -gravity * long * float(np.sin(state[0]))

    def measures(result: Result) -> dict[str, float]:
        place = result.track(cable.end).position
        found = np.arctan2(place[:, 0], -place[:, 2])
        exact = solve_ivp(
            rates, (0, result.time[-1]), (angle, 0.0), rtol=1e-9, atol=1e-11, t_eval=result.time
        )
        after = np.abs(found[result.time > haul]).max()
        return {
            "amplitude ratio": float(after / angle),
            "angle": float(np.abs(found - exact.y[0]).max() / angle),
            "energy drift": energy_drift(result),
        }

    ratio = (first / last) ** 0.75
    # The fastest swing, the last one; errors of phase (omega h)^2/12 add up over all of them.
    omega = np.sqrt(gravity / last)
    late = omega * duration * (omega * step) ** 2 / 6
    expected = {
        "amplitude ratio": Expected(ratio, 0.01 * ratio, "adiabatic invariant E/omega"),
        "angle": Expected(0.0, float(ratio * late) + 0.01, "point on a line of given length, solve_ivp"),
        "energy drift": Expected(0.0, 0.01, "work of the winch against all energies"),
    }
    return Scene(
        name="pendulum_winch",
        title="a swinging pendulum is hauled in",
        model=model,
        settings={"duration": duration, "step": step},
        expected=expected,
        measures=measures,
    )
