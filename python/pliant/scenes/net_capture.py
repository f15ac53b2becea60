"""A net is thrown at a free ball, and closes round it."""

from __future__ import annotations

from itertools import combinations
from typing import Any

import numpy as np

from pliant import _check
from pliant.friction import LuGre
from pliant.materials import LinearElastic
from pliant.model import Model
from pliant.result import Result
from pliant.scenes.scene import Expected, Scene
from pliant.sections import Circle
from pliant.shapes import Sphere

__all__ = ["net_capture"]


def net_capture(
    side: float = 4.0,
    cells: int = 10,
    radius: float = 0.75e-3,
    corner_mass: float = 0.5,
    speed: float = 10.0,
    ball_radius: float = 0.5,
    ball_mass: float = 50.0,
    distance: float = 0.01,
    friction: float = 0.3,
    touches_itself: bool = True,
    stiffness: float | None = 1e7,
    material: LinearElastic | None = None,
    elements: int = 1,
    duration: float = 0.5,
    step: float = 5e-4,
    output_every: int = 10,
) -> Scene:
    """Build the scene: a square net with masses at its corners flies at a ball that floats free of weight.

    The net wraps the ball, the corners swing round and meet behind it. Nothing acts from outside: linear
    and angular momentum are what they were, and energy only falls. (With friction angular momentum keeps to
    friction times the radius of a rope, for ropes do not twist and feel friction on their middle.)

    Parameters
    ----------
    side : float
        Side of the net [m].
    cells : int
        Cells along a side; twice as many take many times as long.
    radius : float
        Of the ropes [m].
    corner_mass : float
        Mass at each corner [kg].
    speed : float
        Of net and masses at the start [m/s].
    ball_radius, ball_mass : float
        A solid ball [m], [kg].
    distance : float
        Between net and ball at the start [m].
    friction : float
        Static coefficient; the dynamic one is 0.85 of it.
    touches_itself : bool
        Whether ropes of the net touch each other.
    stiffness : float, optional
        Of the contact [N/m^2]; None: as stiff as nylon, a hundred times more, which takes longer.
    material : LinearElastic, optional
        None: nylon.
    elements : int
        Elements of each rope from knot to knot.
    duration, step : float
        Time to simulate and step [s].
    output_every : int
        Steps between outputs.

    Returns
    -------
    Scene
        With ``model``, ``simulate()``, ``measure(result)`` and ``expected``; bodies are ``net``, ``ball`` and
        ``corner1`` to ``corner4``.

    Notes
    -----
    ``measure`` returns over the times of the result: ``"closing index"``, the least distance of two corners
    over the side, and ``"ball velocity"`` (n, 3) [m/s]; and the numbers of ``expected``.
    """
    cells, elements = _check.count(cells, "cells"), _check.count(elements, "elements")
    nylon = LinearElastic(2e9, 0.3, 1140.0, retardation_time=1e-3)
    places = np.linspace(-side / 2, side / 2, cells + 1)
    knots = np.array([(x, y, 0.0) for y in places for x in places])
    number = np.arange((cells + 1) ** 2).reshape(cells + 1, cells + 1)
    along = np.stack([number[:, :-1], number[:, 1:]], axis=-1).reshape(-1, 2)
    across = np.stack([number[:-1], number[1:]], axis=-1).reshape(-1, 2)
    model = Model()
    net = model.add_cable_net(
        knots,
        np.concatenate([along, across]),
        elements=elements,
        section=Circle(radius),
        material=nylon if material is None else material,
        tension_only=False,
        velocity=(0.0, 0.0, -speed),
        name="net",
    )
    corners = [net.node(int(k)) for k in number[[0, 0, -1, -1], [0, -1, 0, -1]]]
    for k, corner in enumerate(corners):
        model.add_point_mass(corner_mass, at=corner, name=f"corner{k + 1}")
    ball = model.add_rigid_body(
        mass=ball_mass,
        inertia=(0.4 * ball_mass * ball_radius**2,) * 3,
        shape=Sphere(ball_radius),
        position=(0.0, 0.0, -ball_radius - radius - distance),
        name="ball",
    )
    law = LuGre(friction, 0.85 * friction) if friction > 0 else None
    model.add_contact(net, ball, friction=law, stiffness=stiffness)
    if touches_itself:
        model.add_contact(net, friction=law, stiffness=stiffness)

    def measures(result: Result) -> dict[str, Any]:
        tips = [result.track(corner).position for corner in corners]
        apart = [np.linalg.norm(a - b, axis=1) for a, b in combinations(tips, 2)]
        momentum, spin = result.momentum, result.angular_momentum
        given = np.linalg.norm(momentum[0])
        energy = result.energy
        gained = energy.kinetic + energy.elastic
        return {
            "closing index": np.min(apart, axis=0) / side,
            "ball velocity": result.track(ball.center).velocity,
            "momentum": float(np.linalg.norm(momentum - momentum[0], axis=1).max() / given),
            "angular momentum": float(np.linalg.norm(spin - spin[0], axis=1).max() / (given * side)),
            "energy drift": float(np.abs(energy.total - energy.total[0]).max() / energy.total.max()),
            "energy gained": float((gained - np.minimum.accumulate(gained)).max() / gained[0]),
        }

    # Ropes do not twist: friction acts on their middle, and a couple of it over the radius is missing.
    source = "nothing acts from outside, but for friction over the radius of a rope"
    expected = {
        "momentum": Expected(0.0, 1e-8, "nothing acts from outside"),
        "angular momentum": Expected(0.0, max(1e-8, friction * radius / side), source),
        "energy drift": Expected(0.0, 0.01, "kinetic and elastic energy against friction and strain rates"),
        "energy gained": Expected(0.0, 1e-3, "contact gives no energy"),
    }
    return Scene(
        name="net_capture",
        title="a net closes round a free ball",
        model=model,
        settings={"duration": duration, "step": step, "output_every": output_every},
        expected=expected,
        measures=measures,
        color="axial_force",
    )
