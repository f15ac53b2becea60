"""A truck rolls over a cable that hangs between two supports."""

from __future__ import annotations

import numpy as np
from scipy.integrate import cumulative_trapezoid
from scipy.optimize import brentq, root

from pliant.curves import Curve
from pliant.model import Model
from pliant.result import Result
from pliant.scenes.scene import Expected, Scene, energy_drift, line
from pliant.signals import Table
from pliant.statics import solve_static

__all__ = ["bridge_catenary", "elastic_catenary", "loaded_catenary"]


def elastic_catenary(
    length: float, span: float, weight: float, axial_stiffness: float
) -> tuple[float, float, float]:
    """Horizontal force [N], largest tension [N] and sag [m] of an elastic catenary between level supports.

    ``length`` is stress-free [m], ``weight`` per stress-free length [N/m]. H. M. Irvine, Cable Structures,
    MIT Press 1981, section 1.4.
    """

    def surplus(force: float) -> float:
        stretch = force * length / axial_stiffness
        return float(2 * force / weight * np.arcsinh(weight * length / (2 * force)) + stretch - span)

    force = float(brentq(surplus, 1e-3 * weight * span, 1e3 * weight * span, xtol=1e-9, rtol=1e-14))
    end = weight * length / (2 * force)
    sag = force / weight * (np.sqrt(1 + end**2) - 1) + weight * length**2 / (8 * axial_stiffness)
    return force, float(force * np.sqrt(1 + end**2)), float(sag)


def loaded_catenary(
    length: float, span: float, weight: float, axial_stiffness: float, load: float, place: float
) -> tuple[float, float]:
    """Where a point load hangs in an elastic catenary between level supports: x from the left and depth [m].

    ``load`` [N] sits at the stress-free arc length ``place`` [m]. Each of the two pieces is a catenary.
    """

    def way(horizontal: float, vertical: float, piece: float) -> tuple[float, float]:
        """How far a piece leads whose upper end pulls by these forces, towards its lower end."""
        low = vertical - weight * piece
        x = horizontal * piece / axial_stiffness
        x += horizontal / weight * (np.arcsinh(vertical / horizontal) - np.arcsinh(low / horizontal))
        z = (vertical * piece - weight * piece**2 / 2) / axial_stiffness
        z += (np.hypot(horizontal, vertical) - np.hypot(horizontal, low)) / weight
        return x, z

    def gap(forces: np.ndarray) -> tuple[float, float]:
        left = way(forces[0], forces[1], place)
        right = way(forces[0], weight * length + load - forces[1], length - place)
        return left[0] + right[0] - span, left[1] - right[1]

    force, _, _ = elastic_catenary(length, span, weight, axial_stiffness)
    lever = load * (1 - place / length) + weight * length / 2
    found = root(gap, (force * (1 + 2 * load / (weight * length)), lever), tol=1e-12)
    x, depth = way(found.x[0], found.x[1], place)
    return float(x), float(depth)


def bridge_catenary(
    span: float = 200.0,
    length: float = 204.0,
    weight: float = 30.0,
    axial_stiffness: float = 6e7,
    bending_stiffness: float = 1.8e3,
    truck: float = 20e3,
    speed: float = 10.0,
    wheelbase: float = 5.0,
    elements: int = 80,
    gravity: float = 9.81,
    retardation_time: float = 1e-2,
    duration: float = 25.0,
    step: float = 5e-3,
) -> Scene:
    """Build the scene: a cable carries itself and a truck that rolls over it.

    The truck is a weight on two axles without mass of its own. It starts at the left support and has left the
    cable before the run ends.

    Parameters
    ----------
    span, length : float
        Distance of the level supports and stress-free length of the cable [m].
    weight : float
        Weight of the cable per length [N/m].
    axial_stiffness, bending_stiffness : float
        EA [N] and EI [N m^2]; the default is a strand whose wires bend as one.
    truck, speed, wheelbase : float
        Weight of the truck [N], its speed along the cable [m/s], distance of its axles [m].
    elements : int
        Number of elements.
    gravity : float
        Gravity [m/s^2].
    retardation_time : float
        Damping of the cable's strains (Kelvin-Voigt) [s].
    duration, step : float
        Time to simulate and step [s].

    Returns
    -------
    Scene
        It starts from the equilibrium without the truck.
    """
    sharpness = float(
        brentq(lambda a: 2 * a * np.sinh(span / (2 * a)) - length, span / 20, 1e3 * span, xtol=1e-12)
    )

    def hanging(s: float) -> tuple[float, float, float]:
        u = (s - length / 2) / sharpness
        drop = np.cosh(span / (2 * sharpness)) - np.sqrt(1 + u**2)
        return span / 2 + sharpness * float(np.arcsinh(u)), 0.0, -sharpness * float(drop)

    model = Model(gravity=(0, 0, -gravity))
    cable = model.add_cable(
        Curve(hanging, length=length),
        elements=elements,
        rest="straight",
        strain="biot",
        name="cable",
        **line(axial_stiffness, bending_stiffness, weight / gravity, 0.02, retardation_time),
    )
    supports = [model.pin(end) for end in (cable.start, cable.end)]
    empty = model.copy()
    times = np.array([0.0, duration])
    axle = np.array([0.0, 0.0, -truck / 2])
    for lag in (0.0, wheelbase):
        model.add_moving_force(cable, axle, Table(times, speed * times - lag))

    law = length, span, weight, axial_stiffness
    force, largest, sag = elastic_catenary(*law)
    _, depth = loaded_catenary(*law, truck, length / 4)

    def begin() -> Result:
        return solve_static(empty)

    def measures(result: Result) -> dict[str, float]:
        rest = begin()
        pull = rest.reaction(supports[0]).force[-1]
        loaded = empty.copy()
        loaded.add_force(cable.at(length / 4), (0, 0, -truck))
        parked = solve_static(loaded, start=rest)
        held = sum(result.reaction(support).force for support in supports)
        # Times that each axle has spent on the cable; integrals of steps, which trapezoids would smear.
        rolled = np.clip(result.time[:, None] - np.array([0.0, wheelbase]) / speed, 0, length / speed)
        down = weight * length * result.time + truck / 2 * rolled.sum(axis=1)
        impulse = cumulative_trapezoid(held, result.time, axis=0, initial=0) - down[:, None] * [0, 0, 1]
        missing = result.momentum - result.momentum[0] - impulse
        return {
            "horizontal force": float(abs(pull[0])),
            "largest tension": float(np.linalg.norm(pull)),
            "sag": float(-rest.track(cable.at(length / 2)).position[-1, 2]),
            "depth of the parked truck": float(-parked.track(cable.at(length / 4)).position[-1, 2]),
            "momentum balance": float(np.abs(missing).max() / np.abs(result.momentum).max()),
            "energy drift": energy_drift(result),
        }

    bending = np.sqrt(bending_stiffness / force) / length  # boundary layers, in lengths of the cable
    expected = {
        "horizontal force": Expected(force, 0.5 * bending * force, "elastic catenary; bending at the ends"),
        "largest tension": Expected(largest, 0.5 * bending * largest, "elastic catenary"),
        "sag": Expected(sag, 0.5 * bending * sag, "elastic catenary"),
        "depth of the parked truck": Expected(
            depth, 0.03 * length / elements, "two elastic catenaries; an element rounds the kink"
        ),
        "momentum balance": Expected(0.0, 0.02, "supports, weight and truck, integrated by trapezoids"),
        "energy drift": Expected(0.0, 0.01, "work of the truck against all energies"),
    }
    return Scene(
        name="bridge_catenary",
        title="a truck rolls over a hanging cable",
        model=model,
        settings={"duration": duration, "step": step},
        expected=expected,
        measures=measures,
        color="axial_force",
        begin=begin,
    )
