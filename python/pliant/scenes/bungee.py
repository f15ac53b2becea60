"""A jumper on an elastic cord; a weight that a straight cord stops."""

from __future__ import annotations

import numpy as np

from pliant.model import Model
from pliant.result import Result
from pliant.scenes.folded_chain import hairpin
from pliant.scenes.scene import Expected, Scene, energy_drift, line
from pliant.typing import FloatArray

__all__ = ["bungee", "drop_test", "stopping_tension"]


def bungee(
    mass: float = 80.0,
    fall: float = 6.0,
    stiffness: float = 120.0,
    cord_mass: float = 3.0,
    width: float = 0.6,
    bending_stiffness: float = 1e-2,
    retardation_time: float = 1e-3,
    elements: int = 40,
    gravity: float = 9.81,
    duration: float = 6.0,
    step: float = 2e-3,
) -> Scene:
    """Build the scene: a jumper falls beside the folded cord, which then stops the fall.

    By energy, with the cord at rest and evenly stretched by x at the lowest point:
    ``k x^2/2 = m g (l + x) + m_c g (l/4 + x/2)``.

    Parameters
    ----------
    mass : float
        Mass of the jumper [kg].
    fall : float
        Length of the cord, and of the free fall from the height of its upper end [m].
    stiffness : float
        Force over stretch of the whole cord [N/m].
    cord_mass : float
        Mass of the cord [kg].
    width : float
        Distance of the jumper from the upper end at the start [m].
    bending_stiffness : float
        EI of the cord [N m^2].
    retardation_time : float
        Damping of its strains (Kelvin-Voigt) [s].
    elements : int
        Number of elements.
    gravity : float
        Gravity [m/s^2].
    duration, step : float
        Time to simulate and step [s].

    Returns
    -------
    Scene
        With ``model``, ``simulate()``, ``measure(result)`` and ``expected``.
    """
    model = Model(gravity=(0, 0, -gravity))
    cord = model.add_cable(
        hairpin(fall, width),
        elements=elements,
        rest="straight",
        strain="biot",
        name="cord",
        **line(stiffness * fall, bending_stiffness, cord_mass / fall, 0.015, retardation_time),
    )
    anchor = model.pin(cord.start, name="anchor")
    model.add_point_mass(mass, at=cord.end, name="jumper")

    weight = (mass + cord_mass / 2) * gravity
    height = (mass + cord_mass / 4) * gravity * fall
    stretch = (weight + np.sqrt(weight**2 + 2 * stiffness * height)) / stiffness

    def measures(result: Result) -> dict[str, float]:
        depth = -result.track(cord.end).position[:, 2]
        lowest = int(np.argmax(depth))
        lost = result.energy.dissipated[lowest]
        # What the cord's damping took until then was not there to stretch it.
        kept = (weight + np.sqrt(weight**2 + 2 * stiffness * (height - lost))) / stiffness
        pull = np.linalg.norm(result.reaction(anchor).force[max(lowest - 5, 0) : lowest + 6], axis=1)
        return {
            "stretch": float(depth[lowest] - fall),
            "stretch, damping considered": float((depth[lowest] - fall) / kept),
            "tension at the lowest point": float(pull.mean()),
            "energy drift": energy_drift(result),
        }

    # What the cord keeps as motion across and along itself.
    share = 0.1 * cord_mass / mass + 1e-3
    expected = {
        "stretch": Expected(
            stretch, 0.01 * stretch + share * stretch, "energy; the cord dissipates a little"
        ),
        "stretch, damping considered": Expected(1.0, share, "energy less what the cord dissipated"),
        "tension at the lowest point": Expected(
            stiffness * stretch,
            2 * cord_mass / mass * stiffness * stretch + 0.01 * stiffness * stretch,
            "k x; waves run through a heavy cord",
        ),
        "energy drift": Expected(0.0, 0.01, "closes"),
    }
    return Scene(
        name="bungee",
        title="a jump on an elastic cord",
        model=model,
        settings={"duration": duration, "step": step},
        expected=expected,
        measures=measures,
        color="axial_force",
    )


def stopping_tension(
    time: FloatArray, speed: float, mass: float, stiffness: float, cord_mass: float, gravity: float = 9.81
) -> tuple[FloatArray, FloatArray]:
    """Tension at the weight and at the anchor of a straight elastic cord that stops a weight [N], each (n,).

    The cord hangs straight and unstretched when the weight at its end has this ``speed`` downwards [m/s]. Its
    waves go with ``c = sqrt(k/m_c)`` lengths per second and carry ``Z = sqrt(k m_c)`` times the velocity as
    tension; in the frame that falls freely, ``R = w_t - c w_X`` goes down unchanged, ``w_t + c w_X`` up, and
    the weight obeys ``m w_tt = -Z (w_t - R)``, which is solved exactly between samples.

    Parameters
    ----------
    time : array_like, shape (n,)
        Times since then [s].
    speed, mass, stiffness, cord_mass, gravity : float
        Speed [m/s], mass of the weight [kg], stiffness [N/m] and mass [kg] of the whole cord, gravity
        [m/s^2].
    """
    impedance, delay = np.sqrt(stiffness * cord_mass), np.sqrt(cord_mass / stiffness)
    samples = 500  # in one passage of the cord
    h = delay / samples
    count = int(np.ceil(np.max(time) / h)) + 2
    fade = np.exp(-impedance / mass * h)
    # Down: sent by the anchor; up: sent by the weight.
    down, up, motion = np.zeros(count), np.zeros(count), np.zeros(count)
    motion[0], up[0] = speed, 2 * speed
    for i in range(count):
        # The frame falls: the anchor moves up in it.
        down[i] = 2 * -gravity * i * h - (up[i - samples] if i >= samples else 0.0)
        if i > 0:
            k = i - samples
            before, arriving = (down[k - 1] if k > 0 else 0.0), (down[k] if k >= 0 else 0.0)
            mean = (before + arriving) / 2
            motion[i] = mean + (motion[i - 1] - mean) * fade
            up[i] = 2 * motion[i] - arriving
    t = h * np.arange(count)
    arrived = np.concatenate([np.zeros(samples), down])[:count]
    at_weight = impedance * (motion - arrived)
    at_anchor = impedance * (-gravity * t - down)
    return np.interp(time, t, at_weight), np.interp(time, t, at_anchor)


def drop_test(
    mass: float = 80.0,
    fall: float = 6.0,
    stiffness: float = 120.0,
    cord_mass: float = 3.0,
    elements: int = 100,
    gravity: float = 9.81,
    duration: float = 2.0,
    step: float = 5e-4,
) -> Scene:
    """Build the scene: a straight cord stops a weight that has fallen along it; waves run to and fro.

    Parameters
    ----------
    mass : float
        Mass of the weight [kg].
    fall : float
        Length of the cord, and of the free fall before [m].
    stiffness : float
        Force over stretch of the whole cord [N/m].
    cord_mass : float
        Mass of the cord [kg].
    elements : int
        Number of elements.
    gravity : float
        Gravity [m/s^2].
    duration, step : float
        Time to simulate and step [s].

    Returns
    -------
    Scene
        It starts with the cord straight and the weight at the speed of the fall.
    """
    speed = np.sqrt(2 * gravity * fall)
    model = Model(gravity=(0, 0, -gravity))
    start = np.zeros((elements + 1, 3))
    start[-1, 2] = -speed
    cord = model.add_cable(
        [(0, 0, 0), (0, 0, -fall)],
        elements=elements,
        strain="biot",
        velocity=start,
        name="cord",
        **line(stiffness * fall, 1e-3, cord_mass / fall, 0.015),
    )
    anchor = model.pin(cord.start, name="anchor")
    model.add_point_mass(mass, at=cord.end, name="weight")
    law = speed, mass, stiffness, cord_mass, gravity
    weight = mass * gravity
    massless = (weight + np.sqrt(weight**2 + 2 * stiffness * weight * fall)) / stiffness
    delay = np.sqrt(cord_mass / stiffness)

    def measures(result: Result) -> dict[str, float]:
        t = result.time
        _, exact = stopping_tension(t, *law)
        pull = result.reaction(anchor).force[:, 2]
        first = (t > delay) & (t < 3 * delay)
        arrival = t[np.argmax(pull > np.sqrt(stiffness * cord_mass) * speed)]
        return {
            "arrival at the anchor": float(arrival / delay),
            "mean of the first wave": float(pull[first].mean() / exact[first].mean()),
            "tension at the anchor": float(np.sqrt(np.mean((pull - exact) ** 2)) / exact.max()),
            "stretch": float(-result.track(cord.end).position[:, 2].min() - fall),
            "energy drift": energy_drift(result),
        }

    expected = {
        "arrival at the anchor": Expected(1.0, 2 / elements, "sqrt(m_c/k), within two elements"),
        "mean of the first wave": Expected(1.0, 0.01, "2 Z v, decaying"),
        "tension at the anchor": Expected(0.0, 0.05, "waves summed exactly; fronts ring in any mesh"),
        "stretch": Expected(float(massless), float(cord_mass / mass * massless), "energy, cord without mass"),
        "energy drift": Expected(0.0, 0.01, "conserved but for the front"),
    }
    return Scene(
        name="drop_test",
        title="a straight cord stops a falling weight",
        model=model,
        settings={"duration": duration, "step": step},
        expected=expected,
        measures=measures,
        color="axial_force",
    )
