"""A knot in a wire is pulled tight."""

from __future__ import annotations

from typing import Any, Literal

import numpy as np
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicSpline

from pliant import _check
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

__all__ = ["knot_tightening", "loop_radius", "loose_figure_eight", "loose_knot"]

# The figure-eight knot of an infinitely thin line, EI = T = 1: how far from its middle a lobe hooks into an
# end, and the other end is hooked into; angles to the pull in the middle and at the hook; the force there;
# how much line the knot takes.
HOOKS, LEAVES = 1.008070181957, 4.159341368446
ANGLE_IN_MIDDLE, ANGLE_AT_HOOK = -2.486696471413, -3.462751635654
PINCH, EXCESS = 1.082412848454, 6.546493277350
# Determinant, bending over EI/(2 R^2), and how far strands slide past each other over how far the ends part.
KNOTS = {
    "trefoil": (3, 1.0, 1.0),
    "cinquefoil": (5, 1.0, 1.0),
    "figure_eight": (5, EXCESS**2 / (2 * np.pi**2), (LEAVES - HOOKS) / EXCESS),
}


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
    return _by_length(points)


def loose_figure_eight(loop: float, radius: float, length: float) -> Curve:
    """Lay a line into a loose figure-eight knot, whose ends leave along x.

    Parameters
    ----------
    loop, radius : float
        Radius of a circle that takes as much line as the knot does, and radius of the line [m]; the strands
        start a little apart.
    length : float
        Length before the strands are laid round each other, which takes a little more [m].

    Returns
    -------
    Curve
        In the plane of x and y but for the crossings: two lobes, each hooked into the end that leaves on the
        other side. Reflected in its middle it is the same, the right-handed clasp for the left-handed one.
    """
    scale = 2 * np.pi * loop / EXCESS
    far = length / (2 * scale)
    if far < LEAVES + 1.0:
        _check.fail("length", length, f"must be {2 * scale * (LEAVES + 1.0):.3g} m or more for such a loop")
    along = np.linspace(0.0, far, 10001)
    points = scale * np.pad(figure_eight_elastica(along)[2:].T, [(0, 0), (0, 1)])
    # Beside the clasp the strands part like parabolas; either makes way by half of what they are to be apart.
    theta, bend = figure_eight_elastica(np.array([HOOKS, LEAVES]))[:2]
    normal = np.array([-np.sin(theta[0]), np.cos(theta[0])])
    apart, parting = 2.2 * radius, bend.sum() / scale
    reach = np.sqrt(2 * apart / abs(parting))
    for place in (HOOKS, LEAVES):
        strand = scale * (along - place)
        u = np.clip((strand / reach + 1) / 2, 0.0, 1.0)
        turned = 2 * np.pi * u * u * (3 - 2 * u)
        open_ = parting * strand**2 / 2
        offset = (
            np.sign(parting)
            * np.hypot(apart, open_)[:, None]
            * np.stack([np.cos(turned), np.sin(turned)], axis=1)
        )
        offset[:, 0] -= open_
        fading = np.exp(-((strand / (2 * reach)) ** 8))[:, None] / 2
        points[:, :2] += fading * offset[:, :1] * normal
        points[:, 2:] += fading * offset[:, 1:]
    return _by_length(np.concatenate([-points[:0:-1], points]))


def figure_eight_elastica(along: FloatArray) -> FloatArray:
    """Half a figure-eight knot of an infinitely thin line, EI = T = 1, from its middle on.

    Angle to the pull, curvature, and place along and across it, (4, n).
    """
    direction = ANGLE_AT_HOOK
    pinch = PINCH * np.array([-np.sin(direction), np.cos(direction)])

    def bent(start: FloatArray, begin: float, stop: float, force: FloatArray) -> Any:
        def rates(_: float, y: FloatArray) -> list[float]:
            cos, sin = np.cos(y[0]), np.sin(y[0])
            return [y[1], force[0] * sin - force[1] * cos, cos, sin]

        return solve_ivp(rates, (begin, stop), start, dense_output=True, rtol=1e-10, atol=1e-12)

    pull = np.array([1.0, 0.0])
    lobe = bent(np.array([ANGLE_IN_MIDDLE, 0.0, 0.0, 0.0]), 0.0, HOOKS, pull + 2 * pinch)
    back = bent(lobe.y[:, -1], HOOKS, LEAVES, pull + pinch)
    # Where nothing touches it any more it fades to the line of the pull.
    theta, _, x, y = back.y[:, -1]
    left = theta + 2 * np.pi
    u = np.maximum(along - LEAVES, 0.0)
    rest = 4 * np.arctan(np.tan(left / 4) * np.exp(-u))
    fading = np.stack(
        [
            rest - 2 * np.pi,
            -2 * np.sin(rest / 2),
            x + u - 2 * (np.cos(rest / 2) - np.cos(left / 2)),
            y - 2 * (np.sin(rest / 2) - np.sin(left / 2)),
        ]
    )
    inner = np.where(along < HOOKS, lobe.sol(along), back.sol(np.minimum(along, LEAVES)))
    return np.asarray(np.where(along < LEAVES, inner, fading))


def _by_length(points: FloatArray) -> Curve:
    """Lay a curve through closely spaced points, by its length."""
    lengths = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])
    node, weight = np.polynomial.legendre.leggauss(5)
    spline = CubicSpline(lengths, points)
    for _ in range(3):
        even = np.linspace(0.0, lengths[-1], len(points))
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
    knot: Literal["trefoil", "cinquefoil", "figure_eight"] = "trefoil",
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

    A loose figure-eight knot has two lobes, each hooked into the end that leaves on the other side. With the
    length d that it takes, R = d/(2 pi), it is the plane elastica whose halves press on each other where they
    touch; the same work is

        T = 2.1711 EI/(2 R^2) + 0.4814 mu P

    for its energy is T d as in every loose knot without friction, and strands slide past each other by less
    than the ends part.

    Parameters
    ----------
    diameter, length : float
        Diameter and length of the wire [m].
    loop : float
        Radius of the loop at the start, about [m]; of a circle as long as what a figure-eight knot takes.
    speed : float
        How fast the ends part [m/s].
    friction : float
        Coefficient of friction of the wire on itself.
    knot : {"trefoil", "cinquefoil", "figure_eight"}
        The trefoil is the overhand knot.
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
    if knot not in KNOTS:
        _check.fail("knot", knot, f"must be one of {', '.join(map(repr, KNOTS))}")
    determinant, bending, sliding = KNOTS[knot]
    eight = knot == "figure_eight"
    line = (
        loose_figure_eight(loop, radius, length) if eight else loose_knot(loop, radius, length, determinant)
    )
    begin = min(0.5, duration / 4)

    def build(law: LuGre | None) -> tuple[Model, Cable]:
        model = Model()
        wire = model.add_cable(
            line,
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
    # The top of the loop, the outside of a lobe.
    aloft = line.length / 2 + (2 * loop if eight else 0.0)
    low, top, high = line.sample(np.array([0.0, aloft, line.length]))
    ends = [
        model.drive(wire.start, position=lambda t: low - np.array([way(t), 0.0, 0.0])),
        model.drive(wire.end, position=lambda t: high + np.array([way(t), 0.0, 0.0])),
    ]

    def begins() -> Result:
        rest, same = build(None)
        for end in (same.start, same.end):
            rest.pin(end)
        # The knot might turn about the line of its ends; a spring too soft to bend it keeps it upright.
        rest.add_spring(same.at(aloft), top, 1e-4 * stiffness / loop**3, length=0.0)
        return solve_static(rest)

    def measures(result: Result) -> dict[str, Any]:
        pull = (result.reaction(ends[1]).force - result.reaction(ends[0]).force)[:, 0] / 2
        ends_apart = np.linalg.norm(result.positions(wire)[:, -1] - result.positions(wire)[:, 0], axis=1)
        taken = (line.length - ends_apart) / (2 * np.pi)
        radii = taken if eight else loop_radius(result, wire)
        pressed = np.array([sum(patch.normal_force for patch in patches) for patches in result.contacts])
        # Once the strands slide, and the start has settled.
        moving = result.time > min(2 * begin, result.time[-1] / 2)
        predicted = bending * stiffness / (2 * radii**2) + sliding * friction * pressed
        chosen = np.unique(np.linspace(0, len(result.time) - 1, 12).astype(int))
        lines = centre_line(result, wire, chosen)
        knots = [knot_determinant(x) for x in lines]
        return {
            "radius of the loop": radii,
            "pull": pull,
            "normal force": pressed,
            "pull over bending and friction": float(np.median(pull[moving] / predicted[moving])),
            "determinant of the knot": float(max(knots, key=lambda d: abs(d - determinant))),
            "nearest approach": min(nearest_approach(x, 3 * np.pi * radius) for x in lines) / diameter,
            "energy drift": energy_drift(result),
        }

    work = "virtual work: 2.1711 EI/(2 R^2) + 0.4814 mu P" if eight else "virtual work: EI/(2 R^2) + mu P"
    expected = {
        "pull over bending and friction": Expected(1.0, 0.05, work),
        "determinant of the knot": Expected(float(determinant), 0.0, "a knot stays what it is"),
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
