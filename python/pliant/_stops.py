"""Stops of joints: how stiff and how lossy they are, from the quantities of the model."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from pliant.bodies import LineBody, element_masses
from pliant.joints import Hinge, Sprung
from pliant.points import Point
from pliant.rigid import RigidBodyData
from pliant.typing import Json

if TYPE_CHECKING:
    from pliant.model import Model

__all__ = ["stops"]

PASSED = 0.01  # part of the range that the stop gives way, or radians where there is one stop only


def stops(model: Model, joint: Sprung) -> Json | None:
    """Limits of a joint with stiffness and damping of the stops; None where there are none.

    Both bodies count with their inertia J along the freedom (mass of a slider, moment of inertia about the
    axis of a hinge), the lighter one moves. The energy that a stop must be able to take is estimated by

        E = m |g| l + J y'^2 / 2 + k (range)^2 / 2,

    l the distance of the centre of mass from the axis of a hinge (of a slider the range) and y' the rate
    at the start; where that is zero by J (range / 1 s)^2 / 2. The stop then gives way by a hundredth of the
    range where it takes E, ``K = 2 E / (range / 100)^2``, and about half of the speed at which it does is
    lost: Hunt-Crossley damping ``chi = sqrt(J / (2 E))``.
    """
    if joint.limits is None:
        return None
    lower, upper = joint.limits
    both = lower is not None and upper is not None
    turns = isinstance(joint, Hinge)
    span = upper - lower if lower is not None and upper is not None else (1.0 if turns else model._size())
    weight, inertia, energy = np.inf, np.inf, 0.0
    for point in joint.points():
        body = model._bodies[point.body] if isinstance(point, Point) else None
        if body is None:
            continue
        mass, arm, moment, rate = _inertia(model, joint, body, turns)
        if moment < inertia:
            inertia = moment
            lever = arm if turns else span
            weight = mass * float(np.linalg.norm(model.gravity)) * lever
        energy = max(energy, 0.5 * moment * rate**2)
    energy += weight + 0.5 * joint.stiffness * span**2
    if energy <= 0:
        energy = 0.5 * inertia * span**2
    way = PASSED * span if both or not turns else PASSED
    return {
        "lower": lower,
        "upper": upper,
        "stiffness": 2.0 * energy / way**2,
        "damping": float(np.sqrt(inertia / (2.0 * energy))),
    }


def _inertia(model: Model, joint: Sprung, body: object, turns: bool) -> tuple[float, float, float, float]:
    """Mass, distance of its centre from the axis, inertia along the freedom, rate at the start."""
    axis, place = np.array(joint.axis), model._position(joint.a)
    if isinstance(body, RigidBodyData):
        offset = np.asarray(body.position) - place
        across = offset - axis * (offset @ axis)
        turned = np.asarray(body.axes) @ axis
        moment = float(turned @ body.inertia @ turned + body.mass * (across @ across))
        rate = float(np.asarray(body.angular_velocity if turns else body.velocity) @ axis)
        return body.mass, float(np.linalg.norm(across)), moment if turns else body.mass, rate
    if isinstance(body, LineBody):
        mass = float(element_masses(body).sum())
        across = body.r - place - np.outer((body.r - place) @ axis, axis)
        square = float(np.mean(np.sum(across**2, axis=1)))
        return mass, square**0.5, mass * square if turns else mass, 0.0
    return 0.0, 0.0, np.inf, 0.0
