"""A soft cable held by two grippers, let go by one of them, and caught again.

What does it take to catch the loose end of a cable, and into which shape do the grippers bring the cable
then? One gripper keeps its end, in place and direction. The other one moves in, lets go, and the end swings
down. A run without the catch tells where the end will be a little later; the gripper goes there, closes on
the end in passing, whose motion stops at once, and carries it to where it shall be.

Checked: at rest the cable has the shape of a heavy elastica between two clamps, and pulls with its force, by
an independent solution of the equations of a thin rod that can stretch (SciPy's solve_bvp); and the energy
audit closes through grips, the blow of the catch, and the damping of cable and air.

    python examples/regrasped_cable.py
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pliant as pl
from _style import AMBER, BLUE, GREEN, GREY, INK, OUT, RED, new_figure, plain, save, scale_bar
from matplotlib.axes import Axes
from scipy.integrate import solve_bvp
from scipy.spatial.transform import Rotation

GRAVITY = 9.81
LENGTH = 1.0
"""Of the cable [m]."""
SECTION = pl.Circle(radius=4e-3)
SILICONE = pl.LinearElastic(5e6, poisson_ratio=0.49, density=1100.0, retardation_time=0.08)
ELEMENTS = 24
"""Of the cable."""
APART = 0.6
"""Distance of the grippers when they let go [m]."""
LET_GO, CATCH, THERE = 1.0, 1.6, 2.8
"""When the gripper lets go, catches the end, and is where it shall be [s]."""
GOAL = np.array([-0.5, 0.0, -0.05])
"""Where it shall be, seen from the other one [m]."""
TILT = np.radians(50.0)
"""By how much it turns after the catch [rad]."""


@dataclass(frozen=True)
class Held:
    """A model of the cable and of its grippers."""

    model: pl.Model
    cable: pl.Cable
    gripper: pl.RigidBody
    clamp: pl.Joint


@dataclass(frozen=True)
class Caught:
    """What was found."""

    held: Held
    result: pl.Result
    loss: float
    """Energy lost in the catch [J]."""
    speed: float
    """Of the end when it is caught [m/s]."""
    at_rest: np.ndarray
    """Nodes in the end [m], (n, 3)."""
    elastica: np.ndarray
    """The same by the equations of a rod [m], (n, 3)."""
    force: np.ndarray
    """Of the grip on the end caught [N], (3,)."""
    expected: np.ndarray
    """The same by the equations of a rod [N], (3,)."""
    gaps: list[float]
    """Gap of the energy audit over the range of the gravitational energy, for a step and half of it."""

    @property
    def order(self) -> float:
        """Order with which the audit closes."""
        return float(np.log2(self.gaps[0] / self.gaps[1]))


def smooth(x: float) -> float:
    """Rise from 0 to 1 between 0 and 1 without jumps of slope and curvature."""
    x = min(max(x, 0.0), 1.0)
    return x**3 * (10 - 15 * x + 6 * x**2)


def build(catch_at: np.ndarray | None = None) -> Held:
    """Model whose gripper catches the end at a place, or does not catch it."""
    model = pl.Model(gravity=(0, 0, -GRAVITY))
    cable = model.add_cable(
        [(0, 0, 0), (LENGTH, 0, 0)], elements=ELEMENTS, section=SECTION, material=SILICONE, name="cable"
    )
    model.drive(cable.start, position=(0, 0, 0), direction=(1, 0, 0), name="holding gripper")
    model.add_wind(cable, (0, 0, 0), density=1.2, drag=1.2, name="air")
    goes = np.zeros(3) if catch_at is None else catch_at - (APART, 0, 0)
    comes = np.zeros(3) if catch_at is None else GOAL - catch_at

    def place(t: float) -> np.ndarray:
        moved_in = (APART + (LENGTH - APART) * (1 - smooth(t / LET_GO)), 0.0, 0.0)
        # It waits for the end for a tenth of a second, and holds it for another one before it moves on.
        going = smooth((t - LET_GO - 0.1) / (CATCH - LET_GO - 0.2))
        return moved_in + goes * going + comes * smooth((t - CATCH - 0.1) / (THERE - CATCH - 0.1))

    def turn(t: float) -> Rotation:
        return Rotation.from_rotvec([0, TILT * smooth((t - CATCH - 0.1) / (THERE - CATCH - 0.1)), 0])

    gripper = model.add_rigid_body(
        mass=0.05, shape=pl.Box((0.08, 0.04, 0.03)), position=(LENGTH, 0, 0), name="gripper"
    )
    model.drive(gripper, position=place, orientation=turn, name="arm")
    clamp = model.weld(cable.end, gripper.center, name="clamp").release(at=LET_GO)
    if catch_at is not None:
        clamp.engage(at=CATCH, gap=1e-3)
    return Held(model, cable, gripper, clamp)


def elastica(shape: np.ndarray, direction: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Shape of a heavy rod in the x-z plane (n, 3) between clamps, and the force on its end (3,).

    With the force (H, V + w s) across a section that the part behind exerts, the angle a from x towards z and
    the stretch 1 + e: M' = (1 + e) (H sin a - (V + w s) cos a), a' = M/EI, (x, z)' = (1 + e) (cos a, sin a).
    The shape given is where the iteration starts, and its last point where the clamp is.
    """
    stretch = SILICONE.youngs_modulus * SECTION.area
    bend = SILICONE.youngs_modulus * SECTION.second_moments[0]
    weight = SILICONE.density * SECTION.area * GRAVITY
    s = np.linspace(0, LENGTH, len(shape))
    slope = np.gradient(shape, s, axis=0)
    angle = np.unwrap(np.arctan2(slope[:, 2], slope[:, 0]))
    last = np.arctan2(direction[2], direction[0])
    last += 2 * np.pi * np.round((angle[-1] - last) / (2 * np.pi))

    def rates(s: np.ndarray, y: np.ndarray, p: np.ndarray) -> np.ndarray:
        _, _, a, moment = y
        along, up = p[0], p[1] + weight * s
        longer = 1 + (along * np.cos(a) + up * np.sin(a)) / stretch
        turning = longer * (along * np.sin(a) - up * np.cos(a))
        return np.stack([longer * np.cos(a), longer * np.sin(a), moment / bend, turning])

    def ends(left: np.ndarray, right: np.ndarray, p: np.ndarray) -> np.ndarray:
        return np.array([*left[:3], right[0] - shape[-1, 0], right[1] - shape[-1, 2], right[2] - last])

    start = np.stack([shape[:, 0], shape[:, 2], angle, bend * np.gradient(angle, s)])
    found = solve_bvp(rates, ends, s, start, p=[0.0, -weight * LENGTH / 2], tol=1e-9, max_nodes=20000)
    if not found.success:
        raise RuntimeError(found.message)
    x, z = found.sol(s)[:2]
    return np.stack([x, 0 * x, z], axis=1), np.array([found.p[0], 0.0, found.p[1] + weight * LENGTH])


def advance(model: pl.Model, duration: float, step: float, parts: int) -> pl.Result:
    """Run with steps that are tiny after the catch, whose blow relaxes within microseconds; each in parts."""
    stepper = pl.Stepper(model, step=step / parts, record_every=parts, spectral_radius=0.9)
    stepper.advance(until=LET_GO)
    stepper.advance(until=min(CATCH, duration))
    small = 1e-6
    while small < step and stepper.time < duration:
        begin = stepper.time
        for part in range(1, parts + 1):
            stepper.advance(until=begin + small * part / parts)
        small *= 1.3
    if stepper.time < duration:
        stepper.advance(until=duration)
    return stepper.result


def tangent(held: Held, result: pl.Result) -> np.ndarray:
    """Direction of the end, (3,): in an element the line is a cubic, and four points tell its slope."""
    places = [result.track(held.cable.at(LENGTH - k * LENGTH / ELEMENTS / 3)).position[-1] for k in range(4)]
    slope = np.array([5.5, -9.0, 4.5, -1.0]) @ np.array(places)
    return np.asarray(slope / np.linalg.norm(slope))


def run(step: float = 4e-3, duration: float = 8.0) -> Caught:
    """See where the end will be, catch it there, carry it away, and come to rest."""
    results, gaps = [], []
    for parts in (1, 2):
        free = build()
        fall = advance(free.model, CATCH, step, parts)
        held = build(fall.track(free.cable.end).position[-1])
        results.append(advance(held.model, duration, step, parts))
        energy = results[-1].energy
        gaps.append(float(np.abs(energy.total - energy.total[0]).max() / np.ptp(energy.gravitational)))
    result, energy = results[-1], results[-1].energy
    i = int(np.searchsorted(result.time, CATCH - 1e-9))
    at_rest = result.positions(held.cable)[-1]
    direction = Rotation.from_rotvec([0, TILT, 0]).apply(tangent(free, fall))
    shape, force = elastica(at_rest, direction)
    return Caught(
        held,
        result,
        float(energy.dissipated[i] - fall.energy.dissipated[-1]),
        float(np.linalg.norm(fall.track(free.cable.end).velocity[-1])),
        at_rest,
        shape,
        result.reaction(held.clamp).force[-1],
        force,
        gaps,
    )


def main() -> None:
    """Run, report, draw."""
    caught = run()
    off = np.linalg.norm(caught.at_rest - caught.elastica, axis=1).max()
    print(f"caught at {caught.speed:.3f} m/s, which costs {caught.loss * 1e3:.4f} mJ")
    print(f"at rest off the elastica by {off * 1e3:.4f} mm; force [N] {caught.force}, rod {caught.expected}")
    print(f"audit: gaps {caught.gaps[0]:.2e}, {caught.gaps[1]:.2e}, order {caught.order:.2f}")
    figure = new_figure(12, 4.4)
    scene, power, pull = figure.subplots(1, 3, width_ratios=(1.3, 1, 1))
    draw_scene(scene, caught)
    result, energy = caught.result, caught.result.energy
    # The gripper has its share of the motion, and of the work.
    for values, color in (
        (energy.work, GREEN),
        (energy.gravitational - energy.gravitational[0], GREY),
        (energy.elastic, AMBER),
        (energy.dissipated, RED),
        (energy.kinetic, BLUE),
    ):
        power.plot(result.time, values, color=color)
    plain(power, "time [s]", "energy [J]", "motion (blue), work (green), lost (red)")
    force = result.reaction(caught.held.clamp).force
    pull.plot(result.time, force[:, 0], color=BLUE)
    pull.plot(result.time, force[:, 2], color=RED)
    for value, color in zip(caught.expected[[0, 2]], (BLUE, RED), strict=True):
        pull.axhline(value, color=color, linestyle=":")
    pull.set_ylim(-0.2, 0.6)
    plain(pull, "time [s]", "force [N]", "grip: along (blue), up (red); dots: rod")
    path = save(figure, "regrasped_cable")
    page = OUT / "regrasped_cable.html"
    result.export_html(page)
    print(f"look at {path} and {page}")


def draw_scene(axes: Axes, caught: Caught) -> None:
    """Draw the cable before it is let go, in its fall, and carried away."""
    result = caught.result
    for t in (0.0, LET_GO, LET_GO + 0.2, LET_GO + 0.3, LET_GO + 0.4, CATCH, CATCH + 0.6, result.time[-1]):
        i = int(np.argmin(np.abs(result.time - t)))
        color = AMBER if t <= LET_GO else GREY if t < CATCH else BLUE if t < result.time[-1] else INK
        x = result.positions(caught.held.cable)[i]
        axes.plot(x[:, 0], x[:, 2], color=color, linewidth=2.2 if color == INK else 1.4)
        axes.plot(x[-1, 0], x[-1, 2], "o" if color == GREY else "s", color=color, markersize=5)
    axes.plot(caught.elastica[::2, 0], caught.elastica[::2, 2], ".", color=RED, markersize=5)
    axes.plot(0, 0, "s", color=INK, markersize=8)
    axes.set_title("held (amber), falling, carried (blue), at rest; dots: rod", fontsize=10.5, loc="left")
    scale_bar(axes, 0.6, -0.85, 0.2, "0.2 m")


if __name__ == "__main__":
    main()
