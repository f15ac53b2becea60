"""A robot that moves its platform by eight cables on winches.

How well does it follow a path in position and orientation, if its controller knows neither the load that it
carries nor how stiff its cables have become? The controller turns drums, by what it believes: lengths
between drum and platform at the pose that is wanted, shortened by the strain of tensions that would move the
platform as the path asks (of all such tensions those next to a mean one, by the pseudoinverse). That is the
feed-forward. It also reads the pose of the platform, 200 times a second, and aims beside the path by what is
missing: in proportion, by the rate, and by the sum over time.

Checked: at rest, without feedback, the platform hangs beside its place as eight springs without mass say, by
an equilibrium written down again with SciPy alone; the feedback brings it to its place; no cable gets slack;
and the energy audit closes with the work of the winches.

    python examples/cable_robot.py
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pliant as pl
from _style import BLUE, GREY, INK, OUT, RED, new_figure, plain, save, scale_bar, seen_from
from matplotlib.axes import Axes
from scipy.optimize import root
from scipy.spatial.transform import Rotation

FRAME = np.array([3.0, 2.0, 1.5])
"""Half the edges of the frame, with a drum in each corner [m]."""
PLATFORM = pl.Box((0.1, 0.9, 0.3))
"""A panel [m]."""
MASS = 20.0
"""Mass of the platform [kg], evenly spread."""
LOAD, PLACE = 3.0, (0.0, 0.3, 0.15)
"""Mass [kg] and place on the platform [m] of a load that the controller does not know."""
SECTION, MODULUS = pl.Circle(1.5e-3), 5e9
POLYESTER = pl.LinearElastic(0.93 * MODULUS, poisson_ratio=0.3, density=1380.0, retardation_time=4e-3)
"""The cables are 7 per cent softer than the modulus [Pa] that the controller takes."""
BELIEVED = MODULUS * SECTION.area
"""Stiffness EA of a cable as the controller believes [N]."""
MEAN = 250.0
"""Tension that the controller keeps the cables near [N]."""
DRUM = 0.05
"""Radius of the drums [m]."""
PERIOD = 5e-3
"""Time from one command to the next [s]; drums turn evenly between."""
PROPORTIONAL, RATE, INTEGRAL = 0.5, 0.025, 6.0
"""Gains of the feedback: 1, s, 1/s."""
REST, TURN = 0.5, 7.0
"""Time before the path starts, and duration of the path [s]."""
GRAVITY = 9.81
VIEW = (-65.0, 18.0)
"""Where the picture is taken from: azimuth and elevation [degrees]."""

SIGNS = np.array([(x, y, z) for z in (1, -1) for y in (1, -1) for x in (1, -1)])
DRUMS = FRAME * SIGNS
"""Where the cables leave the drums [m], (8, 3): four above, four below."""
# Those from above hold the lower corners of the panel, those from below its upper edges, which steadies it
# against tilting; and lines that do not meet the vertical through the middle, against turning about it.
CORNERS = np.where(SIGNS[:, 2:] > 0, (0.05, 0.45, -0.15), (0.05, 0.15, -0.15)) * SIGNS
"""Where they hold the platform [m], (8, 3), in its axes."""


@dataclass(frozen=True)
class Pose:
    """Where the platform is and how it is turned."""

    position: np.ndarray
    rotation: Rotation

    def beside(self, other: Pose) -> np.ndarray:
        """How it lies beside another one: distance [m] and turn [rad], (6,)."""
        turn = (self.rotation * other.rotation.inv()).as_rotvec()
        return np.concatenate([self.position - other.position, turn])

    def cables(self) -> np.ndarray:
        """From the platform to the drums [m], (8, 3)."""
        return DRUMS - self.position - self.rotation.apply(CORNERS)

    def wrenches(self) -> np.ndarray:
        """Force and moment about the centre of each cable with a tension of one, (6, 8)."""
        cables = self.cables()
        unit = cables / np.linalg.norm(cables, axis=1)[:, None]
        return np.concatenate([unit, np.cross(self.rotation.apply(CORNERS), unit)], axis=1).T


@dataclass(frozen=True)
class Robot:
    """A model of the robot."""

    model: pl.Model
    platform: pl.RigidBody
    cables: list[pl.Cable]


@dataclass(frozen=True)
class Followed:
    """What was found."""

    robot: Robot
    blind: pl.Result
    result: pl.Result
    errors: dict[str, np.ndarray]
    """Distance [m] and angle [rad] from the path, (n, 2), of the run without feedback and of that with it."""
    sag: np.ndarray
    """Place where the platform hangs without feedback, seen from where it should [m]."""
    springs: np.ndarray
    """The same of eight springs without mass."""
    tensions: np.ndarray
    """Of the cables with feedback [N], (n, 8)."""
    gaps: list[float]
    """Gap of the energy audit over the largest kinetic energy, for a step and half of it."""

    @property
    def order(self) -> float:
        """Order with which the audit closes."""
        return float(np.log2(self.gaps[0] / self.gaps[1]))


def path(t: float) -> Pose:
    """Return the pose wanted at a time: a lemniscate that rises and falls, with turns about all axes."""
    s = np.clip((t - REST) / TURN, 0, 1)
    a = 2 * np.pi * s**4 * (35 - 84 * s + 70 * s**2 - 20 * s**3)
    place = np.array([1.3 * np.sin(a), 0.55 * np.sin(2 * a), 0.35 * (1 - np.cos(a)) - 0.2])
    turn = np.array([0.25 * np.sin(2 * a), 0.2 * np.sin(a), 0.35 * np.sin(a)])
    return Pose(place, Rotation.from_rotvec(turn))


def motion(t: float, h: float = 1e-4) -> tuple[np.ndarray, np.ndarray]:
    """Velocities and accelerations of the path, those of turning below, each (6,)."""
    before, now, after = path(t - h), path(t), path(t + h)
    steps = [later.beside(earlier) for later, earlier in ((now, before), (after, now))]
    return (steps[0] + steps[1]) / (2 * h), (steps[1] - steps[0]) / h**2


def tensions(t: float) -> np.ndarray:
    """Tensions [N] that move the platform on its path as the controller knows it."""
    now = path(t)
    rates, accelerations = motion(t)
    turned = now.rotation.as_matrix()
    x, y, z = np.array(PLATFORM.size) ** 2
    inertia = turned @ np.diag(MASS / 12 * np.array([y + z, z + x, x + y])) @ turned.T
    spin = rates[3:]
    force = MASS * (accelerations[:3] + (0, 0, GRAVITY))
    moment = inertia @ accelerations[3:] + np.cross(spin, inertia @ spin)
    wrenches = now.wrenches()
    wanted = np.concatenate([force, moment]) - wrenches @ np.full(8, MEAN)
    return MEAN + np.linalg.pinv(wrenches) @ wanted


def lengths(t: float, correction: np.ndarray) -> np.ndarray:
    """Stress-free lengths [m] for the pose wanted at a time, moved and turned by the correction (6,)."""
    wanted = path(t)
    aim = Pose(wanted.position + correction[:3], Rotation.from_rotvec(correction[3:]) * wanted.rotation)
    return np.linalg.norm(aim.cables(), axis=1) / (1 + tensions(t) / BELIEVED)


def build(elements: int) -> Robot:
    """Model of the robot at the start of the path."""
    model = pl.Model(gravity=(0, 0, -GRAVITY))
    start = path(0.0)
    platform = model.add_rigid_body(
        mass=MASS, shape=PLATFORM, position=start.position, orientation=start.rotation, name="platform"
    )
    model.add_point_mass(LOAD, at=platform.at(PLACE), name="load")
    cables = []
    for k, (drum, corner, length) in enumerate(zip(DRUMS, CORNERS, lengths(0.0, np.zeros(6)), strict=True)):
        cable = model.add_cable(
            [drum, start.position + start.rotation.apply(corner)],
            elements=elements,
            section=SECTION,
            material=POLYESTER,
            rest_length=length - DRUM * pl.Input(f"drum {k}"),
            tension_only=True,
            strain="biot",
            name=f"cable {k}",
        )
        model.pin(cable.start)
        model.pin(cable.end, platform.at(corner))
        cables.append(cable)
    return Robot(model, platform, cables)


def follow(robot: Robot, statics: pl.Result, feedback: bool, duration: float, substeps: int) -> pl.Result:
    """Follow the path, with or without feedback."""
    stepper = pl.Stepper(
        robot.model, step=PERIOD / substeps, start=statics, record_every=substeps, spectral_radius=0.9
    )
    start = lengths(0.0, np.zeros(6))
    angles, sums, last = np.zeros(8), np.zeros(6), None
    for period in range(round(duration / PERIOD)):
        t = period * PERIOD
        correction = np.zeros(6)
        if feedback:
            seen = stepper.track(robot.platform.center)
            error = path(t).beside(Pose(seen.position, seen.orientation))
            sums += error * PERIOD
            change = np.zeros(6) if last is None else (error - last) / PERIOD
            correction, last = PROPORTIONAL * error + RATE * change + INTEGRAL * sums, error
        # The drums are where they were told to be when the next command comes.
        command = (start - lengths(t + PERIOD, correction)) / DRUM
        for substep in range(1, substeps + 1):
            for k, angle in enumerate(angles + (command - angles) * substep / substeps):
                stepper.set_input(f"drum {k}", angle)
            stepper.advance()
        angles = command
    return stepper.result


def hanging() -> np.ndarray:
    """Where the platform hangs on eight springs without mass that have the lengths of the start [m]."""
    wanted, rest = path(0.0), lengths(0.0, np.zeros(6))
    stiffness = POLYESTER.youngs_modulus * SECTION.area
    # Half the weight of each cable hangs on the platform.
    own = POLYESTER.density * SECTION.area * np.linalg.norm(wanted.cables(), axis=1) * GRAVITY / 2

    def lacking(x: np.ndarray) -> np.ndarray:
        pose = Pose(wanted.position + x[:3], Rotation.from_rotvec(x[3:]) * wanted.rotation)
        pull = pose.wrenches() @ (stiffness * (np.linalg.norm(pose.cables(), axis=1) / rest - 1))
        arms = np.concatenate([pose.rotation.apply(CORNERS), [pose.rotation.apply(PLACE), np.zeros(3)]])
        weights = np.zeros((10, 3))
        weights[:, 2] = -np.concatenate([own, [LOAD * GRAVITY, MASS * GRAVITY]])
        return pull + np.concatenate([weights.sum(axis=0), np.cross(arms, weights).sum(axis=0)])

    return np.asarray(root(lacking, np.zeros(6), tol=1e-12).x[:3])


def distance(robot: Robot, result: pl.Result) -> np.ndarray:
    """Distance [m] and angle [rad] from the path at each time, (n, 2)."""
    seen = result.track(robot.platform.center)
    poses = [Pose(*pose) for pose in zip(seen.position, seen.orientation, strict=True)]
    error = np.array([path(t).beside(pose) for t, pose in zip(result.time, poses, strict=True)])
    return np.linalg.norm(error.reshape(-1, 2, 3), axis=2)


def run(elements: int = 3, duration: float = 8.0) -> Followed:
    """Follow the path without and with feedback."""
    robot = build(elements)
    statics = pl.solve_static(robot.model)
    blind = follow(robot, statics, False, duration, 1)
    results = [follow(robot, statics, True, duration, substeps) for substeps in (1, 2)]
    gaps = []
    for result in results:
        energy = result.energy
        gaps.append(float(np.abs(energy.total - energy.total[0]).max() / energy.kinetic.max()))
    return Followed(
        robot,
        blind,
        results[1],
        {"blind": distance(robot, blind), "feedback": distance(robot, results[1])},
        statics.track(robot.platform.center).position[-1] - path(0.0).position,
        hanging(),
        np.stack([results[1].axial_force(cable).mean(axis=1) for cable in robot.cables], axis=1),
        gaps,
    )


def draw_robot(axes: Axes, followed: Followed) -> None:
    """Draw the frame, the path, and the robot at three times."""
    for pair in edges(FRAME):
        axes.plot(*seen_from(pair, *VIEW).T, color=GREY, linewidth=0.8)
    robot, result = followed.robot, followed.result
    seen = result.track(robot.platform.center)
    axes.plot(*seen_from(seen.position, *VIEW).T, color=RED, linewidth=1.2)
    for part, color in ((0.36, GREY), (0.64, GREY), (0.47, INK)):
        i = int(np.argmin(np.abs(result.time - REST - part * TURN)))
        for pair in edges(np.array(PLATFORM.size) / 2):
            edge = seen.position[i] + seen.orientation[i].apply(pair)
            axes.plot(*seen_from(edge, *VIEW).T, color=color, linewidth=1.6)
        for cable in robot.cables if color == INK else []:
            axes.plot(*seen_from(result.positions(cable)[i], *VIEW).T, color=BLUE, linewidth=1)
    axes.set_title("the robot, its path, and two more of its places", fontsize=10.5, loc="left")
    scale_bar(axes, -1.0, -2.75, 1.0, "1 m")


def edges(half: np.ndarray) -> list[np.ndarray]:
    """Edges of a box about the origin with these half lengths, (2, 3) each."""
    corners = half * SIGNS
    return [
        corners[[i, j]] for i in range(8) for j in range(i) if np.count_nonzero(SIGNS[i] != SIGNS[j]) == 1
    ]


def main() -> None:
    """Run, report, draw."""
    found = run()
    blind, fed = found.errors["blind"], found.errors["feedback"]
    on_path = found.result.time >= REST
    print(
        f"hangs {found.sag[2] * 1e3:.4f} mm beside its place, {found.sag[1] * 1e3:.4f} mm aside; springs: "
        f"{found.springs[2] * 1e3:.4f} mm, {found.springs[1] * 1e3:.4f} mm"
    )
    for name, error in (("without", blind), ("with", fed)):
        print(
            f"{name} feedback: at most {error[on_path, 0].max() * 1e3:.2f} mm and "
            f"{np.degrees(error[on_path, 1].max()):.3f} degrees off the path, "
            f"{error[-1, 0] * 1e3:.4f} mm at the end"
        )
    print(f"tensions from {found.tensions.min():.0f} N to {found.tensions.max():.0f} N")
    print(f"audit: gaps {found.gaps[0]:.2e}, {found.gaps[1]:.2e}, order {found.order:.2f}")
    figure = new_figure(12, 4.2)
    scene, off, pull = figure.subplots(1, 3, width_ratios=(1.5, 1, 1))
    draw_robot(scene, found)
    time = found.result.time
    for error, color in ((blind, GREY), (fed, BLUE)):
        off.plot(time, error[:, 0] * 1e3, color=color)
        off.plot(time, np.degrees(error[:, 1]) * 10, color=color, linestyle=":")
    plain(off, "time [s]", "mm, tenths of a degree (dotted)", "off the path, blue with feedback")
    for k in range(8):
        pull.plot(time, found.tensions[:, k], color=RED if k < 4 else BLUE, linewidth=1)
    pull.set_ylim(0, None)
    plain(pull, "time [s]", "tension [N]", "from above (red), from below (blue)")
    path_ = save(figure, "cable_robot")
    page = OUT / "cable_robot.html"
    found.result.export_html(page)
    print(f"look at {path_} and {page}")


if __name__ == "__main__":
    main()
