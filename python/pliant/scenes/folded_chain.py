"""A chain hangs by both ends; one is let go."""

from __future__ import annotations

import numpy as np

from pliant.curves import Curve
from pliant.model import Model
from pliant.result import Result
from pliant.scenes.scene import Expected, Scene, energy_drift, line
from pliant.statics import solve_static

__all__ = ["folded_chain", "hairpin"]


def hairpin(length: float, width: float) -> Curve:
    """Line that hangs from (0, 0, 0), turns in a half circle and comes up to (width, 0, 0)."""
    radius = width / 2
    leg = (length - np.pi * radius) / 2

    def position(s: float) -> tuple[float, float, float]:
        if s < leg:
            return 0.0, 0.0, -s
        if s > length - leg:
            return width, 0.0, s - length
        angle = (s - leg) / radius
        return radius * (1 - float(np.cos(angle))), 0.0, -leg - radius * float(np.sin(angle))

    return Curve(position, length=length)


def folded_chain(
    length: float = 2.0,
    width: float = 0.1,
    mass: float = 0.1,
    axial_stiffness: float = 2e3,
    bending_stiffness: float = 1e-5,
    retardation_time: float = 1e-3,
    elements: int = 80,
    gravity: float = 9.81,
    duration: float = 0.52,
    step: float = 2.5e-4,
) -> Scene:
    """Build the scene: a folded chain falls, and its end outruns free fall.

    The leg that falls hands its energy over to less and less chain: with x the way of the end,
    ``v^2 = g x (2 L - x)/(L - x)`` for a thin fold that loses nothing (W. Tomaszewski, P. Pieranski,
    J.-C. Geminard, Am. J. Phys. 74, 776, 2006). The run ends before the end turns round and cracks.

    Parameters
    ----------
    length, width : float
        Length of the chain and distance of its ends [m].
    mass : float
        Mass per length [kg/m].
    axial_stiffness, bending_stiffness : float
        EA [N] and EI [N m^2]; an ideal chain has neither stretch nor bending stiffness.
    retardation_time : float
        Damping of the strains (Kelvin-Voigt) [s].
    elements : int
        Number of elements.
    gravity : float
        Gravity [m/s^2].
    duration, step : float
        Time to simulate and step [s].

    Returns
    -------
    Scene
        It starts from the equilibrium with both ends held.
    """
    model = Model(gravity=(0, 0, -gravity))
    chain = model.add_cable(
        hairpin(length, width),
        elements=elements,
        rest="straight",
        strain="biot",
        name="chain",
        **line(axial_stiffness, bending_stiffness, mass, 3e-3, retardation_time),
    )
    model.pin(chain.start)
    held = model.copy()
    held.pin(chain.end)
    places = np.array([0.5, 1.0, 1.5]) * length / 2
    speeds = np.sqrt(gravity * places * (2 * length - places) / (length - places))

    def measures(result: Result) -> dict[str, float]:
        motion = result.track(chain.end)
        way = motion.position[0, 2] - motion.position[:, 2]
        falling = slice(0, int(np.argmax(way)) + 1)
        numbers = {}
        for place in places:
            passed = float(np.interp(place, way[falling], result.time[falling]))
            numbers[f"speed at {place:g} m"] = -float(np.interp(passed, result.time, motion.velocity[:, 2]))
        numbers["ahead of free fall"] = float(way[-1] / (gravity * result.time[-1] ** 2 / 2))
        return {**numbers, "energy drift": energy_drift(result)}

    # The fold moves sideways, too: energy of the order of its share of the chain.
    share = width / length
    expected = {
        f"speed at {place:g} m": Expected(float(speed), float(0.2 * share * speed), "energy of a thin fold")
        for place, speed in zip(places, speeds, strict=True)
    }
    expected["energy drift"] = Expected(0.0, 0.01, "conserved but for what the strains dissipate")
    return Scene(
        name="folded_chain",
        title="a folded chain falls, faster than free fall",
        model=model,
        settings={"duration": duration, "step": step},
        expected=expected,
        measures=measures,
        color="speed",
        begin=lambda: solve_static(held),
    )
