"""A soft quadruped crawls: a plus of 24 shell elements on a ground with LuGre friction."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from pliant import _check
from pliant.contacts import HalfSpace
from pliant.friction import LuGre
from pliant.materials import LinearElastic
from pliant.mesh import Mesh
from pliant.model import Model
from pliant.result import Result
from pliant.scenes.scene import Expected, Scene
from pliant.signals import Table
from pliant.surfaces import Edge, Shell
from pliant.typing import FloatArray, IntArray

__all__ = ["quadruped"]

COLUMNS, ROWS = 8, 6
"""Cells of the rectangle the plus is cut from: 2 x 2 in the middle, legs of 3 x 2, and beside of 2 x 2."""
PULSE = 24
"""Points that a smooth table of a pulse needs in a period."""
DIRECTIONS = {"undulation": (1.0, 0.0, 0.0), "crawl": (np.sqrt(0.5), np.sqrt(0.5), 0.0)}


def quadruped(
    gait: str = "undulation",
    actuation: str = "curvature",
    lag: float = 0.25,
    curvature: float = -20.0,
    pressure: float = 4e4,
    force: float = 0.3,
    period: float = 0.6,
    cycles: int = 6,
    settling: int = 3,
    friction: float | LuGre = 0.6,
    refinement: int = 1,
    length: float = 0.135,
    span: float = 0.13,
    thickness: float = 8e-3,
    youngs_modulus: float = 3e5,
    density: float = 1070.0,
    retardation_time: float = 5e-3,
    gravity: float = 9.81,
    step: float = 1e-3,
) -> Scene:
    """Build the scene: a plus-shaped elastomer sheet with four legs, driven in two halves that take turns.

    Whether it walks is decided by symmetry. Robot and ground are mirror images of themselves, front against
    back. Where the front half does what the back half did half a period ago (``lag=0.5``), mirroring and
    waiting half a period changes nothing, so that a settled motion travels nowhere: alternating equal loads
    cannot walk. A lag of a quarter breaks the symmetry, and ``lag=-0.25`` walks the other way. Loads from
    outside, vertical forces as in the published model, do it badly; what acts from within does it well: rest
    curvature, or chambers under pressure. Chambers fill the upper half of the thickness h of a half of the
    robot; their pressure p on the walls that end them, h/2 high and h/4 above the middle, makes couples of
    p h^2/8 per width, which cancel over the robot. The stretch that comes with them, p/(2 E), is left out.

    Parameters
    ----------
    gait : {"undulation", "crawl"}
        Undulation: front and back half of body and legs arch in turn, it travels along x. Crawl: the front
        and the left leg, then the other two. No mirror keeps it on the diagonal between them: it travels
        aside, too, and may turn.
    actuation : {"curvature", "pressure", "forces"}
        From within: the rest curvature of a half pulses, or the pressure in its chambers. From outside:
        vertical forces on the halves do.
    lag : float
        By how much the front half comes later, in periods.
    curvature : float
        Peak of the rest curvature [1/m]; below zero the middle rises.
    pressure : float
        Peak of the pressure in the chambers [Pa].
    force : float
        Peak of each of the two forces, upwards [N].
    period, cycles, settling : float, int, int
        Period of the gait [s], how many are simulated, and how many of these are left to settle it.
    friction : float or LuGre
        Coefficient of static and dynamic friction, or the law.
    refinement : int
        Elements along each side of a cell: 1 makes 24 in all.
    length, span, thickness : float
        Size along x and y, and thickness [m].
    youngs_modulus, density, retardation_time : float
        Material [Pa], [kg/m^3], [s].
    gravity, step : float
        Gravity, downwards [m/s^2], and step [s].

    Returns
    -------
    Scene
        With ``model`` (its body is "robot", its obstacle "ground"), ``simulate()``, ``measure(result)`` and
        ``expected``.
    """
    _check.choice(gait, "gait", DIRECTIONS)
    _check.choice(actuation, "actuation", ("curvature", "pressure", "forces"))
    settling = _check.count(settling, "settling", at_least=0)
    cycles = _check.count(cycles, "cycles", at_least=settling + 1)
    refinement = _check.count(refinement, "refinement", at_least=1)
    mesh, centers = plus(length, span, 0.5 * thickness, refinement)
    model = Model(gravity=(0, 0, -gravity))
    rubber = LinearElastic(
        youngs_modulus=youngs_modulus, poisson_ratio=0.45, density=density, retardation_time=retardation_time
    )
    robot = model.add_shell(mesh, thickness=thickness, material=rubber, name="robot")
    ground = model.add_obstacle(HalfSpace(), name="ground")
    law = friction if isinstance(friction, LuGre) else LuGre(friction, friction)
    model.add_contact(robot, ground, friction=law, name="feet")

    front, back = halves(gait, centers, length, span)
    for faces, delay in ((back, 0.0), (front, lag)):
        if actuation != "forces":
            along = along_x(gait, centers[faces], length, span)
            for axis, share in enumerate((along, ~along)):
                if share.any() and actuation == "curvature":
                    value = pulse(curvature, period, delay) * np.eye(3)[axis]
                    model.add_curvature(robot.faces(faces[share]), value)
                elif share.any():
                    couple = pulse(pressure * thickness**2 / 8, period, delay)
                    for edge, sign in chamber_ends(robot, mesh, faces[share], axis):
                        model.add_edge_moment(edge, sign * couple)
        else:
            middle = centers[faces].mean(axis=0)
            lift = pulse(force, period, delay) * np.array([0.0, 0.0, 1.0])
            model.add_force(robot.at((middle[0], middle[1], 0.5 * thickness)), lift)

    direction = np.array(DIRECTIONS[gait])
    weight = (
        gravity * density * thickness * float(len(centers)) * length * span / (COLUMNS * ROWS * refinement**2)
    )
    every = max(1, round(0.01 / step))

    def measures(result: Result) -> dict[str, float]:
        travel = travels(result, period) @ direction
        settled = travel[settling:]
        impulse = result.contact_impulse("robot", "ground")
        time = result.time
        begin = int(np.searchsorted(time, settling * period - 1e-9))
        change = result.momentum[-1] - result.momentum[begin]
        mean = (impulse[-1] - impulse[begin]) / (time[-1] - time[begin])
        # Two pulses from outside, whose mean is half their peak.
        pull = np.array([0.0, 0.0, force if actuation == "forces" else 0.0])
        balance = mean + pull + [0.0, 0.0, -weight] - change / (time[-1] - time[begin])
        size = max(float(np.abs(settled).max()), 1e-12)
        return {
            "travel per cycle [mm]": float(1e3 * settled.mean()),
            "scatter of the travel": float(np.ptp(settled) / size),
            "sideways per cycle [mm]": float(
                1e3 * (travels(result, period)[settling:] @ np.cross([0, 0, 1], direction)).mean()
            ),
            "turn per cycle [degrees]": turn(result, period, settling),
            "support over weight": float((mean[2] + pull[2]) / weight),
            "horizontal force over weight": float(np.abs(mean[:2] + pull[:2]).max() / weight),
            "impulse balance": float(np.abs(balance).max() / weight),
        }

    expected = {
        "support over weight": Expected(1.0, 0.01, "a settled motion neither rises nor falls"),
        "impulse balance": Expected(0.0, 0.01, "change of momentum = impulse of ground, loads and weight"),
    }
    if actuation != "forces":
        expected["horizontal force over weight"] = Expected(0.0, 0.01, "nothing pulls from outside")
    if abs(lag) == 0.5:
        expected["travel per cycle [mm]"] = Expected(0.0, 0.05, "mirror image half a period later")
    return Scene(
        name="quadruped",
        title=f"a soft quadruped, {gait} by {actuation}",
        model=model,
        settings={"duration": cycles * period, "step": step, "output_every": every},
        expected=expected,
        measures=measures,
        color="speed",
    )


def plus(length: float, span: float, height: float, refinement: int) -> tuple[Mesh, FloatArray]:
    """Mesh of the plus about the origin, and the centres of its faces (n, 2)."""
    columns, rows = COLUMNS * refinement, ROWS * refinement
    i, j = np.meshgrid(np.arange(columns), np.arange(rows), indexing="ij")
    cell = np.stack([i, j], axis=-1) // refinement
    inside = ((cell[..., 1] >= 2) & (cell[..., 1] < 4)) | ((cell[..., 0] >= 3) & (cell[..., 0] < 5))
    i, j = i[inside], j[inside]
    corners = np.stack([(i + a) * (rows + 1) + j + b for a, b in ((0, 0), (1, 0), (1, 1), (0, 1))], axis=1)
    used, quads = np.unique(corners, return_inverse=True)
    x = (used // (rows + 1) / columns - 0.5) * length
    y = (used % (rows + 1) / rows - 0.5) * span
    points = np.column_stack([x, y, np.full(len(used), height)])
    quads = quads.reshape(corners.shape)
    return Mesh(points, quads=quads), points[quads].mean(axis=1)[:, :2]


def halves(gait: str, centers: FloatArray, length: float, span: float) -> tuple[IntArray, IntArray]:
    """Faces of the front half and of the back half."""
    ahead = centers @ np.array([1.0, 0.0] if gait == "undulation" else [1.0 / length, 1.0 / span])
    legs = np.ones(len(centers), dtype=bool)
    if gait == "crawl":
        legs = np.maximum(np.abs(centers[:, 0]) / length * COLUMNS, np.abs(centers[:, 1]) / span * ROWS) > 1.0
    return np.flatnonzero(legs & (ahead > 0)), np.flatnonzero(legs & (ahead <= 0))


def along_x(gait: str, centers: FloatArray, length: float, span: float) -> NDArray[np.bool_]:
    """Whether faces bend along x; legs beside the body bend along y."""
    if gait == "undulation":
        return np.ones(len(centers), dtype=bool)
    return np.abs(centers[:, 1]) / span * ROWS < 1.0


def chamber_ends(robot: Shell, mesh: Mesh, faces: IntArray, axis: int) -> list[tuple[Edge, float]]:
    """Edges that end the chambers of faces along an axis, running so that 1.0 bends the far end down.

    Where one face follows another, the pressure on both sides of the wall between them cancels.
    """
    # Sides of a face, from corner to corner: those at its near and at its far end.
    near, far = ((0, 3), (1, 2)) if axis == 0 else ((1, 0), (2, 3))
    walls: dict[tuple[int, int], float] = {}
    for corners in mesh.quads[faces]:
        for (a, b), sign in ((near, -1.0), (far, 1.0)):
            side = (int(corners[a]), int(corners[b]))
            walls[side] = walls.get(side, 0.0) + sign
    left = {side: sign for side, sign in walls.items() if sign != 0.0}
    runs: list[tuple[list[int], float]] = []
    while left:
        starts = {a for a, _ in left} - {b for (_, b) in left}
        (a, b), sign = next((side, sign) for side, sign in left.items() if side[0] in starts)
        run = [a]
        while left.get((a, b)) == sign:
            del left[a, b]
            run.append(b)
            a, b = b, next((d for c, d in left if c == b), -1)
        runs.append((run, sign))
    return [(robot.edge(mesh.points[run]), sign) for run, sign in runs]


def pulse(peak: float, period: float, delay: float) -> Table:
    """Make a smooth pulse sin^2 in every period, ``delay`` periods late."""
    phase = np.arange(PULSE + 1) / PULSE
    values = peak * np.sin(np.pi * (phase - delay)) ** 2
    values[-1] = values[0]
    return Table(phase * period, values, period=period, smooth=True)


def turn(result: Result, period: float, settling: int) -> float:
    """Mean angle by which it turns to the left in a settled cycle [degrees]."""
    r = result.positions("robot")
    axis = r[:, np.argmax(r[0, :, 0])] - r[:, np.argmin(r[0, :, 0])]
    angle = np.unwrap(np.arctan2(axis[:, 1], axis[:, 0]))
    count = round(float(result.time[-1]) / period)
    at = np.interp(np.array([settling, count]) * period, result.time, angle)
    return float(np.degrees(at[1] - at[0]) / (count - settling))


def travels(result: Result, period: float) -> FloatArray:
    """Displacement of the centre of mass in each cycle [m], (cycles, 3)."""
    center = result.center_of_mass()
    count = round(float(result.time[-1]) / period)
    at = [np.interp(np.arange(count + 1) * period, result.time, center[:, k]) for k in range(3)]
    return np.diff(np.stack(at, axis=1), axis=0)
