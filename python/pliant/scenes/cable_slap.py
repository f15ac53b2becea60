"""A plucked cable slaps a post."""

from __future__ import annotations

import numpy as np
from scipy.integrate import cumulative_trapezoid

from pliant.model import Model
from pliant.modes import solve_modes
from pliant.result import Result
from pliant.scenes.scene import Expected, Scene, energy_drift, line
from pliant.shapes import Cylinder
from pliant.statics import solve_static
from pliant.typing import FloatArray

__all__ = ["cable_slap", "string_and_post"]


def string_and_post(
    time: FloatArray, length: float, speed: float, impedance: float, pluck: float, place: float, gap: float
) -> tuple[FloatArray, FloatArray]:
    """Deflection of a plucked string at its middle, where it meets a post, and the post's impulse on it.

    The free string is a sum of two travelling waves (d'Alembert). The post's force F sends waves
    ``F/(2 Z)`` to both sides, which come back reversed from the ends after ``L/c``, and is what keeps the
    string from passing; the string does not rebound of its own, only when waves take it away.

    Parameters
    ----------
    time : array_like, shape (n,)
        Times from the release on, evenly spaced and fine [s].
    length, speed, impedance : float
        Length L [m], wave speed c [m/s], impedance Z = tension/c [kg/s].
    pluck, place : float
        Deflection [m] and the share of the length where it is plucked.
    gap : float
        How far behind the string's middle at rest the post stands [m].

    Returns
    -------
    deflection, impulse : ndarray, shape (n,)
        [m], [N s].
    """
    corner = place * length

    def start(x: FloatArray) -> FloatArray:
        # Odd and periodic: the ends do not move.
        inside = np.mod(x, 2 * length)
        mirrored = np.where(inside > length, 2 * length - inside, inside)
        shape = np.where(mirrored < corner, mirrored / corner, (length - mirrored) / (length - corner))
        return np.asarray(pluck * np.where(inside > length, -1.0, 1.0) * shape)

    middle = length / 2
    free = (start(middle - speed * time) + start(middle + speed * time)) / 2
    period = round(length / speed / (time[1] - time[0]))
    impulse = np.zeros(len(time))
    for i in range(1, len(time)):
        echoes = sum((-1) ** k * impulse[i - k * period] for k in range(1, i // period + 1))
        needed = 2 * impedance * (-gap - free[i]) - 2 * echoes
        impulse[i] = max(impulse[i - 1], needed)
    echo = impulse.copy()
    for k in range(1, len(time) // period + 1):
        echo[k * period :] += 2 * (-1) ** k * impulse[: len(time) - k * period]
    return free + echo / (2 * impedance), impulse


def cable_slap(
    length: float = 12.0,
    tension: float = 200.0,
    mass: float = 0.06,
    pluck: float = 0.3,
    place: float = 1 / 3,
    gap: float = 0.02,
    post: float = 0.02,
    radius: float = 3e-3,
    axial_stiffness: float = 2e3,
    bending_stiffness: float = 1e-3,
    retardation_time: float = 1e-5,
    elements: int = 120,
    duration: float = 0.45,
    step: float = 2.5e-4,
) -> Scene:
    """Build the scene: a taut cable, plucked and let go, slaps a post that stands behind its middle.

    Parameters
    ----------
    length, tension, mass : float
        Length between the ends [m], tension [N], mass per length [kg/m].
    pluck, place : float
        Deflection at the start [m], and where along the length.
    gap : float
        Clearance between the cable at rest and the post [m].
    post, radius : float
        Radii of the post and of the cable [m].
    axial_stiffness, bending_stiffness : float
        EA [N] and EI [N m^2]; a soft cable keeps its tension when it is plucked.
    retardation_time : float
        Damping of the strains (Kelvin-Voigt) [s].
    elements : int
        Number of elements.
    duration, step : float
        Time to simulate and step [s].

    Returns
    -------
    Scene
        It starts from the equilibrium of the plucked cable.
    """
    model = Model()
    cable = model.add_cable(
        [(0, 0, 0), (length, 0, 0)],
        elements=elements,
        pretension=tension,
        strain="biot",
        name="cable",
        **line(axial_stiffness, bending_stiffness, mass, radius, retardation_time),
    )
    ends = [model.pin(cable.start), model.pin(cable.end)]
    plucked = model.copy()
    sides = tension * pluck / length * (1 / place + 1 / (1 - place))
    plucked.add_force(cable.at(place * cable.length), (0, sides, 0))
    pole = model.add_obstacle(
        Cylinder(post, 1.0), position=(length / 2, -gap - post - radius, 0), name="post"
    )
    model.add_contact(cable, pole)
    speed = np.sqrt(tension / mass)
    fine = np.linspace(0.0, duration, 20 * round(duration / step) + 1)
    _, pushed = string_and_post(fine, length, speed, tension / speed, pluck, place, gap)

    def measures(result: Result) -> dict[str, float]:
        force = result.contact_force(cable, pole)[:, 1]
        impulse = result.contact_impulse(cable, pole)[:, 1]
        arrival = result.time[int(np.argmax(force > 0))]
        held = sum(result.reaction(end).force for end in ends) + result.contact_force(cable, pole)
        missing = (
            result.momentum - result.momentum[0] - cumulative_trapezoid(held, result.time, axis=0, initial=0)
        )
        return {
            "lowest frequency": float(solve_modes(model, count=1).frequencies[0]),
            "arrival": float(arrival),
            "impulse": float(impulse[-1] / pushed[-1]),
            "momentum balance": float(np.abs(missing).max() / np.abs(result.momentum).max()),
            "energy drift": energy_drift(result),
        }

    def begin() -> Result:
        return solve_static(plucked)

    frequency = float(speed / (2 * length))
    arrival = float(fine[int(np.argmax(pushed > 0))])
    # The pluck stretches the cable and raises its tension.
    slopes = pluck / length / np.array([place, 1 - place])
    stiffer = axial_stiffness / tension * float(np.dot(slopes**2 / 2, [place, 1 - place]))
    bending = 4 * float(np.sqrt(bending_stiffness / tension)) / length
    expected = {
        "lowest frequency": Expected(frequency, (bending + 1e-4) * frequency, "taut string, c/(2 L)"),
        "arrival": Expected(arrival, arrival * stiffer + 2 * step, "d'Alembert"),
        "impulse": Expected(1.0, 0.05, "string against a post without rebound, waves summed"),
        "momentum balance": Expected(0.0, 0.02, "ends and post, integrated by trapezoids"),
        "energy drift": Expected(0.0, 0.01, "conserved but for the contact's damping"),
    }
    return Scene(
        name="cable_slap",
        title="a plucked cable slaps a post",
        model=model,
        settings={"duration": duration, "step": step, "spectral_radius": 0.8},
        expected=expected,
        measures=measures,
        color="speed",
        begin=begin,
    )
