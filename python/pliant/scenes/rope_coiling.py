"""A rope paid out onto the ground coils."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
from scipy.integrate import cumulative_trapezoid, solve_bvp
from scipy.interpolate import CubicHermiteSpline

from pliant.contacts import HalfSpace
from pliant.curves import Curve
from pliant.friction import LuGre
from pliant.model import Model
from pliant.result import Result
from pliant.scenes.scene import Expected, Scene, energy_drift, line
from pliant.scenes.topology import centre_line, nearest_approach
from pliant.typing import FloatArray

__all__ = ["rope_coiling", "steady_coil"]


@cache
def steady_coil(height: float) -> tuple[FloatArray, FloatArray, float, float]:
    """Shape of a heavy, elastic line that is fed slowly from a height and coils on the ground.

    It leaves the nozzle straight down, and meets the ground along the circle on which it comes to lie, with
    that circle's curvature: there moments are continuous, forces are not, for the ground holds the line.
    It resists bending and not twist, and is carried round without inertia (Habibi, Ribe and Bonn 2007, with
    these left out). Everything in units of the length (EI/w)^(1/3), w the weight per length.

    Parameters
    ----------
    height : float
        Of the nozzle, at least 2.

    Returns
    -------
    points, tangents : ndarray, shape (n, 3)
        From the nozzle, at (0, 0, height), to the ground at (R, 0, 0), evenly along the line.
    length, radius : float
        Of the line above the ground, and of the coil.
    """

    def slopes(_: FloatArray, y: FloatArray, p: FloatArray) -> FloatArray:
        tangent, moment, force = y[3:6], y[6:9], y[9:]
        weight = np.zeros_like(force)
        weight[2] = 1.0
        turn = np.cross(moment, tangent, axis=0)
        return np.asarray(p[0] * np.vstack([tangent, turn, -np.cross(tangent, force, axis=0), weight]))

    def ends(a: FloatArray, b: FloatArray, p: FloatArray) -> FloatArray:
        top = [a[0], a[1], a[2] - tall, a[3], a[4], a[5] + 1, a[6:9] @ a[3:6]]
        return np.array([*top, b[2], b[1], b[0] - p[1], b[3], b[5], b[6], b[8] - 1 / p[1]])

    tall = min(height, 3.0)
    x = np.linspace(0.0, 1.0, 200)
    guess = np.zeros((12, len(x)))
    bent = np.clip((x * (tall + 1) - (tall - 1)) / 2, 0.0, 1.0)
    tangents = np.stack([0.3 * np.sin(np.pi * bent), np.sin(np.pi / 2 * bent), -np.cos(np.pi / 2 * bent)])
    guess[3:6] = tangents / np.linalg.norm(tangents, axis=0)
    guess[:3] = cumulative_trapezoid(guess[3:6], x * (tall + 1), axis=1, initial=0)
    guess[:3] -= guess[:3, -1:]
    guess[0] += 1.0
    guess[8], guess[11] = bent, (x - 1) * (tall + 1) + 0.5
    parameters = np.array([tall + 1, 1.0])
    while True:
        solution = solve_bvp(slopes, ends, x, guess, p=parameters, tol=1e-6, max_nodes=20000)
        if solution.status != 0:
            raise ArithmeticError(f"height = {height:g}: {solution.message}")
        x, guess, parameters = solution.x, solution.y, solution.p
        if tall >= height:
            break
        tall = min(1.4 * tall, height)
    even = solution.sol(np.linspace(0.0, 1.0, 400))
    return even[:3].T, even[3:6].T, float(parameters[0]), float(parameters[1])


def _laid(lines: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Angle [rad] and length [m] laid so far, where lines (n, points, 3) that come from above lie down."""
    ways = np.diff(lines, axis=1)
    lengths = np.linalg.norm(ways, axis=2)
    level = np.abs(ways[:, :, 2]) < 0.15 * lengths
    # The first level piece from above.
    down = level.shape[1] - 1 - np.argmax(level[:, ::-1], axis=1)
    rows = np.arange(len(lines))
    heading = ways[rows, down]
    turned = np.unwrap(np.arctan2(heading[:, 1], heading[:, 0]))
    laid = np.array([lengths[i, : down[i]].sum() for i in rows])
    return np.abs(turned - turned[0]), laid - laid[0]


def rope_coiling(
    bending_length: float = 0.03,
    height: float = 20.0,
    radius: float = 2e-3,
    mass: float = 0.014,
    axial_stiffness: float = 50.0,
    speed: float = 0.12,
    turns: float = 1.6,
    friction: float = 0.5,
    retardation_time: float = 5e-3,
    element: float = 0.01,
    step: float = 4e-3,
) -> Scene:
    """Build the scene: a soft rope is let down slowly onto the ground, where it lays itself into coils.

    Slowly fed, a rope coils with a radius that bending and weight decide, a multiple of (EI/w)^(1/3). That
    multiple grows slowly with the height of the fall, here from the solution of :func:`steady_coil`. The run
    begins from it, half a turn laid on the ground; then the rope's upper end is lowered, upright.

    Parameters
    ----------
    bending_length : float
        (EI/w)^(1/3) [m], w the weight per length.
    height : float
        Of the upper end above the ground at the start, in bending lengths.
    radius, mass : float
        Radius of the rope [m], mass per length [kg/m].
    axial_stiffness : float
        EA [N].
    speed : float
        How fast the rope comes down [m/s].
    turns : float
        Turns to lay, about.
    friction : float
        Coefficient of friction on the ground and of the rope on itself.
    retardation_time : float
        Damping of the strains (Kelvin-Voigt) [s].
    element : float
        Length of an element [m].
    step : float
        Step [s].

    Returns
    -------
    Scene
        With ``model``, ``simulate()``, ``measure(result)`` and ``expected``.
    """
    weight = mass * 9.81
    shape, tangents, hanging, turn = steady_coil(height)
    points = bending_length * shape
    above, coil = bending_length * hanging, bending_length * turn
    laid = np.pi * coil
    along = np.linspace(0.0, above, len(points))
    spline = CubicHermiteSpline(along, points, tangents)

    # From the end on the ground, along the circle, and up.
    s = np.linspace(0.0, laid + above, 8001)
    angle = np.maximum(laid - s, 0.0) / coil
    up = np.maximum(s - laid, 0.0)
    lies = (s <= laid)[:, None]
    where = np.where(lies, coil * np.stack([np.cos(angle), np.sin(angle), 0 * s], axis=1), spline(above - up))
    where[:, 2] += radius
    ahead = np.where(lies, np.stack([np.sin(angle), -np.cos(angle), 0 * s], axis=1), -spline(above - up, 1))
    ahead /= np.linalg.norm(ahead, axis=1, keepdims=True)
    ahead[-1] = (0.0, 0.0, 1.0)
    length = float(np.linalg.norm(np.diff(where, axis=0), axis=1).sum())
    even = CubicHermiteSpline(s * (length / s[-1]), where, ahead)
    duration = 2 * np.pi * turns * coil / speed
    elements = round(length / element)
    curve = Curve(lambda s: np.asarray(even(s)), length=length)
    model = Model(gravity=(0.0, 0.0, -9.81))
    rope = model.add_cable(
        curve,
        elements=elements,
        rest="straight",
        strain="biot",
        name="rope",
        **line(axial_stiffness, weight * bending_length**3, mass, radius, retardation_time),
    )
    ground = model.add_obstacle(HalfSpace(), name="ground")
    law = LuGre(friction, friction)
    model.add_contact(rope, ground, friction=law)
    model.add_contact(rope, friction=law)
    begin = min(0.2, duration / 4)

    def way(t: float) -> float:
        share = np.clip(t / begin, 0.0, 1.0)
        return float(speed * (begin * share**4 * (2.5 - 3 * share + share**2) + max(t - begin, 0.0)))

    top = where[-1]
    hand = model.drive(
        rope.end,
        position=lambda t: top - np.array([0.0, 0.0, way(t)]),
        direction=curve.tangents(np.array([length]), length / elements)[0],
    )

    heights = np.geomspace(max(height - 2 * np.pi * turns * turn, 2.0), height, 6)
    radii = [bending_length * steady_coil(float(h))[3] for h in heights]

    def measures(result: Result) -> dict[str, Any]:
        lines = centre_line(result, rope, pieces=4)
        turned, length_laid = _laid(lines)
        fall = (lines[:, -1, 2] - radius) / bending_length
        # Turn by turn as the theory has it, for the height at which it was laid.
        pace = np.interp(fall, heights, 1 / np.array(radii))
        theory = cumulative_trapezoid(pace, length_laid, initial=0)
        later = slice(len(turned) // 8, None)
        weighed = mass * 9.81 * length
        held = result.reaction(hand).force + result.contact_force(rope, ground)
        held[:, 2] -= weighed
        missing = result.momentum - result.momentum[0]
        missing = missing - cumulative_trapezoid(held, result.time, axis=0, initial=0)
        some = lines[:: max(len(lines) // 20, 1)]
        return {
            "angle laid": turned,
            "angle of theory": theory,
            "first radius": coil,
            "length laid": length_laid,
            "coil radius over theory": float(np.ptp(theory[later]) / np.ptp(turned[later])),
            "momentum balance": float(np.abs(missing).max() / (weighed * result.time[-1])),
            "nearest approach": min(nearest_approach(x, 3 * np.pi * radius) for x in some) / (2 * radius),
            "energy drift": energy_drift(result),
        }

    expected = {
        # The rope swings as it is laid, and settles on what lies there already.
        "coil radius over theory": Expected(
            1.0, 0.1, "heavy elastica that coils steadily, without twist and inertia"
        ),
        "momentum balance": Expected(0.0, 0.01, "weight, hand and ground, integrated by trapezoids"),
        "nearest approach": Expected(1.0, 0.05, "the rope does not pass through itself"),
        "energy drift": Expected(0.0, 0.01, "work of weight and hand against friction and bending"),
    }
    return Scene(
        name="rope_coiling",
        title="a rope coils on the ground",
        model=model,
        settings={"duration": duration, "step": step, "output_every": 5},
        expected=expected,
        measures=measures,
        color="axial_force",
    )
