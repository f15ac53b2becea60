"""A knot in a wire is pulled tight."""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.interpolate import CubicSpline

from pliant.curves import Curve
from pliant.friction import LuGre
from pliant.materials import LinearElastic
from pliant.model import Model
from pliant.points import Cable
from pliant.result import Result
from pliant.scenes.scene import Expected, Scene, energy_drift
from pliant.scenes.topology import centre_line, knot_determinant, nearest_approach
from pliant.sections import Circle
from pliant.statics import solve_static
from pliant.typing import FloatArray

__all__ = ["knot_tightening", "loop_radius", "loose_knot"]


def loose_knot(loop: float, radius: float, length: float, crossings: int = 3) -> Curve:
    """Lay a line into a loop whose ends go round each other, and leave along x.

    Parameters
    ----------
    loop, radius : float
        Radii of the loop and of the line [m]; the strands start a little apart.
    length : float
        Length before the strands are laid round each other, which takes a little more [m].
    crossings : int
        How often the strands cross, odd: 3 a trefoil (an overhand knot), 5 a cinquefoil.

    Returns
    -------
    Curve
        In the plane of x and y but for the crossings.
    """
    # Along the line from the top of the loop; either strand along itself from where they meet.
    along = np.linspace(-length / 2, length / 2, 20001)
    first = along < 0
    half = np.pi * loop
    angle = np.minimum(np.abs(along), half) / loop
    tail = np.maximum(np.abs(along) - half, 0.0)
    side = np.sign(along)
    points = np.stack([side * (tail - loop * np.sin(angle)), loop * (1 + np.cos(angle)), 0 * along], axis=1)
    strand = along + np.where(first, half, -half)
    apart = 2.6 * radius
    bent = strand**2 / (2 * loop)
    reach = 0.4 * crossings * np.sqrt(2 * loop * apart)
    u = np.clip((strand / reach + 1) / 2, 0.0, 1.0)
    turned = np.pi * (crossings * u * u * (3 - 2 * u) - 0.5)
    offset = np.hypot(apart, bent)[:, None] * np.stack([np.sin(turned), np.cos(turned)], axis=1)
    offset[:, 0] -= np.sign(strand) * bent
    fading = np.exp(-((strand / min(4 * reach, half / 2.5)) ** 8))
    points[:, 1:] += (np.where(first, 0.5, -0.5) * fading)[:, None] * offset
    lengths = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])
    node, weight = np.polynomial.legendre.leggauss(5)
    spline = CubicSpline(lengths, points)
    for _ in range(3):
        even = np.linspace(0.0, lengths[-1], len(along))
        inner = even[:-1, None] + (even[1] - even[0]) * (node + 1) / 2
        pieces = np.linalg.norm(spline(inner, 1), axis=2) @ weight / 2 * (even[1] - even[0])
        lengths = np.concatenate([[0.0], np.cumsum(pieces)])
        spline = CubicSpline(lengths, spline(even))
    return Curve(lambda s: np.asarray(spline(s)), length=float(lengths[-1]))


def loop_radius(result: Result, wire: Cable) -> FloatArray:
    """Half the height of the loop over where its strands cross [m], (n,); the ends lie on the x axis."""
    across = result.positions(wire)[:, :, 1:]
    up = across[:, across.shape[1] // 2]
    height = np.einsum("ijk,ik->ij", across, up / np.linalg.norm(up, axis=1, keepdims=True))
    return np.asarray(np.ptp(height, axis=1) / 2)


def knot_tightening(
    diameter: float = 1e-3,
    length: float = 1.0,
    loop: float = 0.05,
    speed: float = 0.01,
    friction: float = 0.1,
    crossings: int = 3,
    material: LinearElastic | None = None,
    elements: int = 160,
    duration: float = 12.0,
    step: float = 0.02,
) -> Scene:
    """Build the scene: both ends of a wire with a loose knot are drawn apart slowly.

    A loose knot is a circle of radius R whose strands lie round each other along sqrt(2 r R). The work of
    the pull T bends the circle further and rubs the strands against each other, which press with P, r the
    wire's radius:

        T = EI/(2 R^2) + mu P,    P = sigma EI/(sqrt(r) R^(3/2))

    with sigma = 0.492 for the trefoil (Audoly, Clauvelin and Neukirch, 2007) where R is large beside r; at a
    finite R the strands press more, by the order sqrt(r/R).

    Parameters
    ----------
    diameter, length : float
        Diameter and length of the wire [m].
    loop : float
        Radius of the loop at the start, about [m].
    speed : float
        How fast the ends part [m/s].
    friction : float
        Coefficient of friction of the wire on itself.
    crossings : int
        3: trefoil (overhand knot), 5: cinquefoil.
    material : LinearElastic, optional
        None: steel.
    elements : int
        Number of elements.
    duration, step : float
        Time to simulate and step [s].

    Returns
    -------
    Scene
        It starts from the equilibrium of the knot without friction.
    """
    if material is None:
        material = LinearElastic(2e11, 0.3, 7850.0, retardation_time=1e-4)
    radius = diameter / 2
    stiffness = material.youngs_modulus * np.pi * radius**4 / 4
    knot = loose_knot(loop, radius, length, crossings)
    begin = min(0.5, duration / 4)

    def build(law: LuGre | None) -> tuple[Model, Cable]:
        model = Model()
        wire = model.add_cable(
            knot,
            elements=elements,
            section=Circle(radius),
            material=material,
            rest="straight",
            strain="biot",
            name="wire",
        )
        model.add_contact(wire, friction=law)
        return model, wire

    def way(t: float) -> float:
        share = np.clip(t / begin, 0.0, 1.0)
        return float(speed / 2 * (begin * share**4 * (2.5 - 3 * share + share**2) + max(t - begin, 0.0)))

    model, wire = build(LuGre(friction, friction) if friction > 0 else None)
    low, top, high = knot.sample(np.array([0.0, knot.length / 2, knot.length]))
    ends = [
        model.drive(wire.start, position=lambda t: low - np.array([way(t), 0.0, 0.0])),
        model.drive(wire.end, position=lambda t: high + np.array([way(t), 0.0, 0.0])),
    ]

    def begins() -> Result:
        rest, same = build(None)
        for end in (same.start, same.end):
            rest.pin(end)
        # The knot might turn about the line of its ends; a spring too soft to bend it keeps it upright.
        rest.add_spring(same.at(knot.length / 2), top, 1e-6 * stiffness / loop**3, length=0.0)
        return solve_static(rest)

    def measures(result: Result) -> dict[str, Any]:
        pull = (result.reaction(ends[1]).force - result.reaction(ends[0]).force)[:, 0] / 2
        radii = loop_radius(result, wire)
        pressed = np.array([sum(patch.normal_force for patch in patches) for patches in result.contacts])
        # Once the strands slide, and the start has settled.
        moving = result.time > min(2 * begin, result.time[-1] / 2)
        predicted = stiffness / (2 * radii**2) + friction * pressed
        chosen = np.unique(np.linspace(0, len(result.time) - 1, 12).astype(int))
        lines = centre_line(result, wire, chosen)
        knots = [knot_determinant(x) for x in lines]
        return {
            "radius of the loop": radii,
            "pull": pull,
            "normal force": pressed,
            "pull over bending and friction": float(np.median(pull[moving] / predicted[moving])),
            "determinant of the knot": float(max(knots, key=lambda d: abs(d - crossings))),
            "nearest approach": min(nearest_approach(x, 3 * np.pi * radius) for x in lines) / diameter,
            "energy drift": energy_drift(result),
        }

    expected = {
        "pull over bending and friction": Expected(1.0, 0.05, "virtual work: EI/(2 R^2) + mu P"),
        "determinant of the knot": Expected(float(crossings), 0.0, "a knot stays what it is"),
        "nearest approach": Expected(1.0, 0.05, "the wire does not pass through itself"),
        "energy drift": Expected(0.0, 0.01, "work of both ends against bending and friction"),
    }
    return Scene(
        name="knot_tightening",
        title="a knot is pulled tight",
        model=model,
        settings={"duration": duration, "step": step, "output_every": 4},
        expected=expected,
        measures=measures,
        color="axial_force",
        begin=begins,
    )
