"""A rope slides round a capstan."""

from __future__ import annotations

import numpy as np
from scipy.spatial.transform import Rotation

from pliant.curves import Curve
from pliant.friction import LuGre
from pliant.model import Model
from pliant.result import Result
from pliant.scenes.scene import Expected, Scene, energy_drift, line
from pliant.shapes import Cylinder
from pliant.signals import Table

__all__ = ["capstan"]


def capstan(
    drum: float = 0.1,
    radius: float = 2e-3,
    wrap: float = 3 * np.pi,
    friction: float = 0.2,
    tension: float = 10.0,
    pull: float = 0.02,
    axial_stiffness: float = 1.25e4,
    bending_stiffness: float = 1e-6,
    mass: float = 0.015,
    retardation_time: float = 1e-3,
    tail: float = 0.1,
    pitch: float = 0.015,
    bristle_stiffness: float = 1e5,
    elements: int = 120,
    duration: float = 0.6,
    step: float = 1e-3,
) -> Scene:
    """Build the scene: a rope, wrapped round a drum, is pulled slowly against a force at its other end.

    Where it slides the tensions are as ``exp(mu phi)`` (Euler 1769, Eytelwein 1808); phi is the angle by
    which the rope turns, a little less than the wrap angle as it climbs along the drum.

    Parameters
    ----------
    drum, radius : float
        Radii of the drum and of the rope [m].
    wrap : float
        Wrap angle [rad].
    friction : float
        Coefficient of friction, static and dynamic alike.
    tension : float
        Force at the end that is drawn in [N].
    pull : float
        Way by which the other end is pulled, smoothly, in the whole run [m].
    axial_stiffness, bending_stiffness : float
        EA [N] and EI [N m^2] of the rope.
    mass : float
        Mass per length [kg/m].
    retardation_time : float
        Damping of the strains (Kelvin-Voigt) [s].
    tail : float
        Length of the straight parts at either end [m].
    pitch : float
        Advance along the drum in a turn [m].
    bristle_stiffness : float
        Stiffness of the bristles (LuGre), per normal force [1/m].
    elements : int
        Number of elements.
    duration, step : float
        Time to simulate and step [s].

    Returns
    -------
    Scene
        With ``model``, ``simulate()``, ``measure(result)`` and ``expected``.
    """
    around, climb = drum + radius, pitch / (2 * np.pi)
    speed = float(np.hypot(around, climb))
    wound = wrap * speed

    def position(s: float) -> tuple[float, float, float]:
        # Straight on beyond the wrap, along the tangents of the helix; it begins at -x going up.
        inside = min(max(s - tail, 0.0), wound)
        beyond = (s - tail - inside) / speed
        angle = np.pi - inside / speed
        x = around * np.cos(angle) + beyond * around * np.sin(angle)
        z = around * np.sin(angle) - beyond * around * np.cos(angle)
        return float(x), float(climb * (inside / speed + beyond - wrap / 2)), float(z)

    length = wound + 2 * tail
    low = np.subtract(position(0.0), position(tail)) / tail
    high = np.subtract(position(length), position(length - tail)) / tail
    model = Model()
    rope = model.add_cable(
        Curve(position, length=length),
        elements=elements,
        rest="straight",
        strain="biot",
        name="rope",
        **line(axial_stiffness, bending_stiffness, mass, radius, retardation_time),
    )
    cylinder = model.add_obstacle(
        Cylinder(drum, 2 * pitch * max(wrap / (2 * np.pi), 1.0)),
        orientation=Rotation.from_euler("x", 90, degrees=True),
        name="drum",
    )
    model.add_contact(rope, cylinder, friction=LuGre(friction, friction, bristle_stiffness=bristle_stiffness))
    begin = min(0.1, duration / 4)
    rise = np.array([0.0, 1.0, 1.0])[:, None] * (tension * low)
    model.add_force(rope.start, Table(np.array([0.0, begin, duration]), rise))
    times = np.linspace(0.0, duration, 61)
    share = np.clip((times - begin) / (duration - begin), 0.0, 1.0)
    way = pull * share**3 * (10 - 15 * share + 6 * share**2)
    model.drive(
        rope.end, position=Table(times, np.asarray(position(length)) + way[:, None] * high, smooth=True)
    )
    turned = wrap * around / speed

    def measures(result: Result) -> dict[str, float]:
        force = result.axial_force(rope)
        sliding = slice(3 * len(force) // 5, 4 * len(force) // 5)
        straight = max(int(elements * tail / length) // 2, 1)
        ratio = force[sliding, -straight:].mean() / force[sliding, :straight].mean()
        return {
            "ratio of tensions": float(ratio),
            "energy drift": energy_drift(result),
        }

    ratio = float(np.exp(friction * turned))
    expected = {
        "ratio of tensions": Expected(ratio, 0.02 * ratio, "exp(mu phi)"),
        "energy drift": Expected(0.0, 0.01, "work of both ends against friction and strain"),
    }
    return Scene(
        name="capstan",
        title="a rope slides round a capstan",
        model=model,
        settings={"duration": duration, "step": step},
        expected=expected,
        measures=measures,
        color="axial_force",
    )
