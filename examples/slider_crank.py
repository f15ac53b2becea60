"""A motor turns the crank of a piston: the torque that it takes, found and put to the test.

Crank, rod and piston of a small compressor are joined by three hinges and a slider: a planar loop, three of
whose constraints follow from the others. They are found and solved through. A motor brings the crank from
rest to 120 turns a minute, against the weights, the friction of the bearing, and a spring and damper that
hold the piston in place of the gas. Which torque does that take?

Checked: the motor's torque against inverse dynamics in closed form, with the crank's angle as the only
coordinate. Then the other way round: a second model gets that torque as a function of time, and its crank and
piston must move as prescribed. Torque, positions and velocities converge with order 2, as does the energy
audit, in which the motor's work stands against what the bodies and the spring hold and the damper takes.

    python examples/slider_crank.py
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pliant as pl
from _style import AMBER, BLUE, GREEN, GREY, INK, OUT, RED, new_figure, plain, save, slope_triangle
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from scipy.spatial.transform import Rotation

GRAVITY = 9.81
CRANK, ROD = 0.1, 0.28
"""Lengths [m]."""
MASSES = (0.8, 0.5, 0.7)
"""Of crank, rod and piston [kg]."""
STIFFNESS, DAMPING = 400.0, 6.0
"""Of spring [N/m] and damper [N s/m] that hold the piston."""
FRICTION = 0.05
"""Of the shaft's bearing [N m s/rad]."""
SPEED, RISE = 4 * np.pi, 0.6
"""Rate of the crank in the end [rad/s], and the time to get there [s]."""
START = np.pi / 3
"""Angle of the crank at the start [rad]."""
QUANTITIES = ("torque of the motor", "way of the piston", "velocity of the piston", "energy audit")


@dataclass(frozen=True)
class Compressor:
    """A model with its parts."""

    model: pl.Model
    crank: pl.RigidBody
    rod: pl.RigidBody
    piston: pl.RigidBody
    shaft: pl.Joint
    rail: pl.Joint
    motor: pl.Joint


@dataclass(frozen=True)
class Turning:
    """What was found."""

    driven: Compressor
    result: pl.Result
    """The finest run with the rate prescribed."""
    steps: list[float]
    """Steps [s], each half of the one before."""
    errors: dict[str, list[float]]
    """For each of QUANTITIES the largest error with each step, over its largest value."""

    @property
    def orders(self) -> dict[str, float]:
        """Order of convergence of each quantity."""
        return {key: float(np.log2(e[-2] / e[-1])) for key, e in self.errors.items()}


def course(t: np.ndarray | float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Angle of the crank, its rate and acceleration, as the motor prescribes them."""
    s, beyond = np.clip(np.asarray(t) / RISE, 0, 1), np.maximum(np.asarray(t) - RISE, 0)
    angle = START + SPEED * (RISE * (2.5 * s**4 - 3 * s**5 + s**6) + beyond)
    return angle, SPEED * (10 * s**3 - 15 * s**4 + 6 * s**5), SPEED * 30 * s**2 * (1 - s) ** 2 / RISE


def piston_way(a: np.ndarray | float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Place of the piston x at a crank angle [m], with its first two derivatives by the angle."""
    sine, cosine = CRANK * np.sin(a), CRANK * np.cos(a)
    root = np.sqrt(ROD**2 - sine**2)
    first = -sine - sine * cosine / root
    second = -cosine - (cosine**2 - sine**2) / root - (sine * cosine) ** 2 / root**3
    return cosine + root, first, second


def inverse_dynamics(a: np.ndarray, rate: np.ndarray, acceleration: np.ndarray) -> np.ndarray:
    """Torque of the motor [N m]: J a'' + J' a'^2/2 + V' + D a', the kinetic energy being J(a) a'^2/2."""
    crank, rod, piston = MASSES
    gyration = [pl.Box((CRANK, 0.03, 0.02)).gyration[2], pl.Box((ROD, 0.02, 0.02)).gyration[2]]
    sine, cosine = CRANK * np.sin(a), CRANK * np.cos(a)
    x, dx, ddx = piston_way(a)
    root = np.sqrt(ROD**2 - sine**2)
    # The rod: its direction turns by -asin(sine/ROD), its middle lies between pin and piston.
    turn, dturn = -cosine / root, sine / root - sine * cosine**2 / root**3
    middle, bend = np.stack([(dx - sine) / 2, cosine / 2]), np.stack([(ddx - cosine) / 2, -sine / 2])
    inertia = (
        crank * (gyration[0] + CRANK**2 / 4)
        + rod * (gyration[1] * turn**2 + (middle**2).sum(axis=0))
        + piston * dx**2
    )
    half_slope = rod * (gyration[1] * turn * dturn + (middle * bend).sum(axis=0)) + piston * dx * ddx
    weight = (crank + rod) * GRAVITY * cosine / 2
    spring = STIFFNESS * (x - piston_way(START)[0]) * dx
    friction = DAMPING * dx**2 + FRICTION
    return inertia * acceleration + half_slope * rate**2 + weight + spring + friction * rate


def about_z(angle: float) -> Rotation:
    """Rotation about the z axis."""
    return Rotation.from_euler("z", angle)


def build(**drive: object) -> Compressor:
    """Model of the compressor, the shaft driven by ``rate`` or ``torque``."""
    model = pl.Model(gravity=(0, -GRAVITY, 0))
    knee = CRANK * np.array([np.cos(START), np.sin(START), 0])
    head = np.array([piston_way(START)[0], 0, 0])
    along = (head - knee) / ROD
    crank = model.add_rigid_body(
        mass=MASSES[0],
        shape=pl.Box((CRANK, 0.03, 0.02)),
        position=knee / 2,
        orientation=about_z(START),
        name="crank",
    )
    rod = model.add_rigid_body(
        mass=MASSES[1],
        shape=pl.Box((ROD, 0.02, 0.02)),
        position=(knee + head) / 2,
        orientation=about_z(np.arctan2(along[1], along[0])),
        name="rod",
    )
    piston = model.add_rigid_body(
        mass=MASSES[2], shape=pl.Box((0.06, 0.08, 0.08)), position=head, name="piston"
    )
    shaft = model.hinge(crank.at((-CRANK / 2, 0, 0)), damping=FRICTION, name="shaft")
    model.hinge(rod.at((-ROD / 2, 0, 0)), crank.at((CRANK / 2, 0, 0)), name="crank pin")
    model.hinge(rod.at((ROD / 2, 0, 0)), piston.center, name="piston pin")
    rail = model.slider(piston, axis=(1, 0, 0), stiffness=STIFFNESS, damping=DAMPING, name="rail")
    return Compressor(model, crank, rod, piston, shaft, rail, model.drive(shaft, **drive, name="motor"))


def run(duration: float = 1.2, step: float = 2e-3, halvings: int = 2) -> Turning:
    """Turn the crank at the given rate, then by the torque that this takes, with ever smaller steps."""
    driven = build(rate=SPEED * pl.Ramp(RISE))
    pushed = build(torque=lambda t: float(inverse_dynamics(*course(t))))
    steps = [step / 2**k for k in range(halvings + 1)]
    errors: dict[str, list[float]] = {key: [] for key in QUANTITIES}
    for h in steps:
        result = pl.simulate(driven.model, duration=duration, step=h)
        turned = pl.simulate(pushed.model, duration=duration, step=h)
        angle, rate, acceleration = course(result.time)
        x, dx, _ = piston_way(angle)
        torque = inverse_dynamics(angle, rate, acceleration)
        moved = turned.joint(pushed.rail)
        way = x - x[0]
        energy = turned.energy
        for key, error, exact in (
            (QUANTITIES[0], result.reaction(driven.motor).moment[:, 2] - torque, torque),
            (QUANTITIES[1], moved.position - way, way),
            (QUANTITIES[2], moved.velocity - dx * rate, dx * rate),
            (QUANTITIES[3], energy.total - energy.total[0], energy.kinetic),
        ):
            errors[key].append(float(np.abs(error).max() / np.abs(exact).max()))
    return Turning(driven, result, steps, errors)


def draw_mechanism(axes: Axes, turning: Turning) -> None:
    """Draw crank, rod and piston at four angles, the last one strong."""
    result, parts = turning.result, turning.driven
    angle = course(result.time)[0]
    turns = [np.searchsorted(angle, angle[-1] - back) for back in (np.pi * 1.5, np.pi, np.pi / 2, 0)]
    for i, strength in zip(turns, (0.2, 0.3, 0.45, 1.0), strict=True):
        i = min(int(i), len(angle) - 1)
        knee, head = (
            result.track(body.at((half, 0, 0))).position[i, :2]
            for body, half in ((parts.crank, CRANK / 2), (parts.rod, ROD / 2))
        )
        axes.fill(
            *(head + np.array([(-0.03, -0.04), (0.03, -0.04), (0.03, 0.04), (-0.03, 0.04)])).T,
            facecolor="white",
            edgecolor=INK,
            alpha=strength,
        )
        axes.plot(*np.stack([knee, head]).T, color=BLUE, linewidth=4, alpha=strength)
        axes.plot(*np.stack([(0, 0), knee]).T, color=RED, linewidth=5, alpha=strength)
        axes.plot(*np.stack([knee, head]).T, "o", color=INK, markersize=4, alpha=strength)
    around = np.linspace(0, 2 * np.pi, 100)
    axes.plot(CRANK * np.cos(around), CRANK * np.sin(around), color=GREY, linewidth=0.8, linestyle=":")
    axes.plot(0, 0, "o", color=INK, markersize=7)
    for side in (-0.043, 0.043):
        axes.plot([0.13, 0.43], [side, side], color=GREY, linewidth=2)
    axes.set_aspect("equal")
    plain(axes, "x [m]", "y [m]", "The last turn, quarter by quarter")


def picture(turning: Turning) -> Figure:
    """Draw the mechanism, the torque over time, and the errors over the step."""
    figure = new_figure(12.5, 4.2)
    mechanism, torque, errors = figure.subplots(1, 3, width_ratios=(1.25, 1.15, 1))
    draw_mechanism(mechanism, turning)
    result = turning.result
    exact = inverse_dynamics(*course(result.time))
    torque.plot(result.time, exact, color=GREY, linewidth=5, alpha=0.6, label="inverse dynamics")
    found = result.reaction(turning.driven.motor).moment[:, 2]
    torque.plot(result.time, found, color=BLUE, linewidth=1.3, label="drive")
    torque.axvline(RISE, color=GREY, linewidth=0.8, linestyle=":")
    torque.legend(frameon=False, fontsize=8.5)
    plain(torque, "time [s]", "torque [N m]", "Torque: 120 turns a minute from 0.6 s")
    for key, color in zip(QUANTITIES, (BLUE, GREEN, AMBER, RED), strict=True):
        errors.loglog(
            turning.steps, turning.errors[key], "o-", color=color, label=key, linewidth=1.3, markersize=4
        )
    finest = min(e[-1] for e in turning.errors.values())
    slope_triangle(errors, turning.steps[-1] * 1.6, finest, 2)
    errors.set_xticks(turning.steps, [f"{h:.3g}" for h in turning.steps], minor=False)
    errors.set_xticks([], minor=True)
    errors.legend(frameon=False, fontsize=8.5)
    plain(errors, "step [s]", "largest error / largest value", "Order 2")
    return figure


def main() -> None:
    """Print what was found, and leave a picture and a page."""
    turning = run()
    print(f"constraints that follow from others: {turning.driven.model.redundant}")
    for key in QUANTITIES:
        found = ", ".join(f"{e:.2e}" for e in turning.errors[key])
        print(f"{key:22s} errors {found}; order {turning.orders[key]:.3f}")
    peak = np.abs(turning.result.reaction(turning.driven.motor).moment[:, 2]).max()
    print(f"largest torque {peak:.3f} N m")
    path = save(picture(turning), "slider_crank")
    page = OUT / "slider_crank.html"
    turning.result.export_html(page)
    print(f"look at {path} and {page}")


if __name__ == "__main__":
    main()
