"""A gantry crane: a trolley on its rail, and a load on the rope of its winch.

How does a crane move its load without leaving it swinging, and how well must it know the rope for that? A
smooth move from here to there sets the load swinging like any push. An input shaper makes two moves of half
the size out of one, the second half a period later: what the second sets swinging cancels what the first
left (Singer and Seering 1990). It needs the period. Made of three moves, of a quarter, a half and a quarter,
it forgives a wrong one. Then the crane lifts the load while it drives, so that no period is the right one.

Checked: the swing left over for ropes of other lengths than the shaper believes, against theory: of an
undamped pendulum the spectrum of the acceleration at its frequency, times cos or cos^2 of a quarter of the
period believed times that frequency; the swing of the load that is lifted on its way, and the pull of its
rope, against the equation of a pendulum of changing length, by an independent integration; and the energy
audit, with the work of the motors of trolley and winch.

    python examples/gantry_crane.py
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pliant as pl
from _style import AMBER, BLUE, GREY, INK, OUT, RED, new_figure, plain, save, scale_bar
from matplotlib.axes import Axes
from scipy.integrate import quad, solve_ivp

GRAVITY = 9.81
LOAD, TROLLEY = 500.0, 200.0
"""Masses [kg]."""
STEEL = pl.LinearElastic(1.0e11, poisson_ratio=0.3, density=7850.0, retardation_time=5e-3)
ROPE = pl.Circle(radius=3e-3)
TAUT = 1 + LOAD * GRAVITY / (STEEL.youngs_modulus * ROPE.area)
"""Length of the rope that carries the load, over its stress-free length."""
LENGTH = 5.0
"""Length of the rope that the shapers believe [m]."""
WAY, MOVE = 4.0, 5.0
"""Way of the trolley [m], and duration of the move that is to be shaped [s]."""
PERIOD = 2 * np.pi * np.sqrt(LENGTH / GRAVITY)
SHAPERS = {
    "unshaped": [(1.0, 0.0)],
    "two moves": [(0.5, 0.0), (0.5, PERIOD / 2)],
    "three moves": [(0.25, 0.0), (0.5, PERIOD / 2), (0.25, PERIOD)],
}
"""Parts of the way, and when they begin [s]."""
COLORS = {"unshaped": RED, "two moves": AMBER, "three moves": BLUE}
LOW, HIGH, LIFT = 6.5, 3.5, 8.0
"""Length of the rope before and after lifting [m], and duration of that [s]."""


@dataclass(frozen=True)
class Crane:
    """A model of the crane."""

    model: pl.Model
    trolley: pl.RigidBody
    rope: pl.Cable
    load: pl.PointMass
    motor: pl.Joint


@dataclass(frozen=True)
class Lifted:
    """A load lifted on its way."""

    crane: Crane
    result: pl.Result
    swing: np.ndarray
    """Of the load beside the trolley [m]."""
    expected: np.ndarray
    """The same by the pendulum's equation [m]."""
    pull: np.ndarray
    """Of the rope on the load by the pendulum's equation [N]."""
    tension: np.ndarray
    """Of the rope [N]."""


@dataclass(frozen=True)
class Moved:
    """What was found."""

    lengths: np.ndarray
    """Of the ropes [m]."""
    swings: dict[str, np.ndarray]
    """Amplitude of the swing left over for each, by shaper [m]."""
    theory: dict[str, np.ndarray]
    """The same of a pendulum with small angles [m]."""
    lifted: dict[str, Lifted]
    gaps: list[float]
    """Gap of the energy audit over the largest kinetic energy, for a step and half of it."""

    @property
    def order(self) -> float:
        """Order with which the audit closes."""
        return float(np.log2(self.gaps[0] / self.gaps[1]))


def smooth(x: float) -> float:
    """Rise from 0 to 1 between 0 and 1 without jumps of slope and curvature."""
    x = min(max(x, 0.0), 1.0)
    return x**3 * (10 - 15 * x + 6 * x**2)


def place(t: float, shaper: str) -> float:
    """Return the place of the trolley on its rail [m]."""
    return WAY * sum(part * smooth((t - begin) / MOVE) for part, begin in SHAPERS[shaper])


def push(t: float, shaper: str) -> float:
    """Return the acceleration of the trolley [m/s^2]."""
    total = 0.0
    for part, begin in SHAPERS[shaper]:
        x = min(max((t - begin) / MOVE, 0.0), 1.0)
        total += part * 60 * x * (1 - x) * (1 - 2 * x)
    return WAY / MOVE**2 * total


def rope_length(t: float) -> float:
    """Return the length of the rope that is hauled in [m]."""
    return LOW + (HIGH - LOW) * smooth(t / LIFT)


def build(length: float, shaper: str, elements: int, lift: bool = False) -> Crane:
    """Model of the crane whose trolley moves as a shaper says."""
    model = pl.Model(gravity=(0, 0, -GRAVITY))
    trolley = model.add_rigid_body(mass=TROLLEY, shape=pl.Box((0.8, 0.5, 0.3)), name="trolley")
    rail = model.slider(trolley, axis=(1, 0, 0), name="rail")
    motor = model.drive(rail, position=lambda t: place(t, shaper), name="motor")
    rope = model.add_cable(
        [(0, 0, 0), (0, 0, -length)],
        elements=elements,
        section=ROPE,
        material=STEEL,
        strain="biot",
        rest_length=(lambda t: rope_length(t) / TAUT) if lift else length / TAUT,
        name="rope",
    )
    model.pin(rope.start, trolley)
    load = model.add_point_mass(LOAD, at=rope.end, name="load")
    return Crane(model, trolley, rope, load, motor)


def beside(crane: Crane, result: pl.Result) -> np.ndarray:
    """Return how far the load is beside the trolley [m]."""
    return result.track(crane.load).position[:, 0] - result.track(crane.trolley).position[:, 0]


def left_over(length: float, shaper: str) -> float:
    """Amplitude of the swing [m] that small angles leave of a pendulum, by the spectrum of the move."""
    omega = float(np.sqrt(GRAVITY / length))
    parts = [quad(lambda t, f=f: push(t, "unshaped") * f(omega * t), 0, MOVE)[0] for f in (np.cos, np.sin)]
    moves = len(SHAPERS[shaper]) - 1
    return float(np.hypot(*parts)) / omega * abs(np.cos(omega * PERIOD / 4)) ** moves


def pendulum(shaper: str, time: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Swing [m] and pull [N] of a mass on a rope without mass and stretch that is hauled in on its way."""
    h = 1e-4

    def rates(t: float, y: np.ndarray) -> tuple[float, float]:
        length = rope_length(t)
        hauled = (rope_length(t + h) - rope_length(t - h)) / (2 * h)
        turn = -(2 * hauled * y[1] + GRAVITY * np.sin(y[0]) + push(t, shaper) * np.cos(y[0])) / length
        return y[1], turn

    angle, spin = solve_ivp(
        rates, (0, time[-1]), (0, 0), t_eval=time, method="DOP853", rtol=1e-10, atol=1e-12, max_step=0.1
    ).y
    length = np.array([rope_length(t) for t in time])
    bend = np.array([(rope_length(t + h) - 2 * rope_length(t) + rope_length(t - h)) / h**2 for t in time])
    pushes = np.array([push(t, shaper) for t in time])
    pull = LOAD * (length * spin**2 - bend + GRAVITY * np.cos(angle) - pushes * np.sin(angle))
    return length * np.sin(angle), pull


def lift(shaper: str, elements: int, step: float, every: int = 1) -> Lifted:
    """Lift the load on its way."""
    crane = build(LOW, shaper, elements, lift=True)
    result = pl.simulate(
        crane.model, duration=MOVE + 2 * PERIOD, step=step, output_every=every, spectral_radius=0.9
    )
    tension = result.axial_force(crane.rope)[:, -1]
    return Lifted(crane, result, beside(crane, result), *pendulum(shaper, result.time), tension)


def run(
    lengths: tuple[float, ...] = (3.0, 4.0, 5.0, 6.0, 7.0), elements: int = 3, step: float = 1e-2
) -> Moved:
    """Move with ropes of several lengths, and lift on the way."""
    swings: dict[str, list[float]] = {shaper: [] for shaper in SHAPERS}
    for shaper, found in swings.items():
        for length in lengths:
            crane = build(length, shaper, elements)
            end = MOVE + SHAPERS[shaper][-1][1]
            period = 2 * np.pi * np.sqrt(length / GRAVITY)
            result = pl.simulate(crane.model, duration=end + 1.2 * period, step=step, spectral_radius=0.9)
            swing = np.abs(beside(crane, result)[result.time >= end]).max()
            # Of an arc, as angles are.
            found.append(float(length * np.arcsin(swing / length)))
    lifted = {shaper: lift(shaper, elements, step) for shaper in ("unshaped", "three moves")}
    finer = lift("three moves", elements, step / 2, 2)
    gaps = []
    for one in (lifted["three moves"], finer):
        energy = one.result.energy
        gaps.append(float(np.abs(energy.total - energy.total[0]).max() / energy.kinetic.max()))
    theory = {shaper: np.array([left_over(length, shaper) for length in lengths]) for shaper in SHAPERS}
    return Moved(
        np.array(lengths), {name: np.array(found) for name, found in swings.items()}, theory, lifted, gaps
    )


def draw_scene(axes: Axes, moved: Moved) -> None:
    """Draw where load and trolley are from second to second, unshaped above and shaped below."""
    for name, drop in (("unshaped", 0.0), ("three moves", -8.0)):
        one = moved.lifted[name]
        axes.plot([-0.8, WAY + 0.8], [drop + 0.25, drop + 0.25], color=GREY, linewidth=3)
        load = one.result.track(one.crane.load).position
        axes.plot(load[:, 0], load[:, 2] + drop, color=COLORS[name], linewidth=1)
        for t in np.arange(0, one.result.time[-1], 1.0):
            i = int(np.argmin(np.abs(one.result.time - t)))
            line = one.result.positions(one.crane.rope)[i]
            axes.plot(line[:, 0], line[:, 2] + drop, color=INK, linewidth=0.7)
            axes.plot(*load[i, ::2] + (0, drop), "o", color=COLORS[name], markersize=6)
            axes.plot(line[0, 0], drop, "s", color=INK, markersize=6)
    axes.set_title("every second: one move, three moves", fontsize=10.5, loc="left")
    scale_bar(axes, 0.0, -15.4, 2.0, "2 m")


def main() -> None:
    """Run, report, draw."""
    moved = run()
    print("length [m]", moved.lengths)
    for shaper in SHAPERS:
        print(
            f"{shaper}: swing left [mm]",
            np.round(moved.swings[shaper] * 1e3, 1),
            "theory",
            np.round(moved.theory[shaper] * 1e3, 1),
        )
    for name, one in moved.lifted.items():
        off = np.abs(one.swing - one.expected).max(), np.abs(one.tension - one.pull).max()
        end = one.result.time >= MOVE + SHAPERS[name][-1][1]
        print(
            f"lifted on its way, {name}: swings {np.abs(one.swing).max():.4f} m, "
            f"in the end {np.abs(one.swing[end]).max():.4f} m; pull up to {one.pull.max():.0f} N; "
            f"off the pendulum by {off[0] * 1e3:.2f} mm and {off[1]:.1f} N"
        )
    print(f"audit: gaps {moved.gaps[0]:.2e}, {moved.gaps[1]:.2e}, order {moved.order:.2f}")
    figure = new_figure(12, 4.6)
    scene, way, left = figure.subplots(1, 3, width_ratios=(1, 1.1, 1.1))
    draw_scene(scene, moved)
    for name, one in moved.lifted.items():
        way.plot(one.result.time, one.swing, color=COLORS[name])
        way.plot(one.result.time[::40], one.expected[::40], ".", color=INK, markersize=3)
    plain(way, "time [s]", "load beside the trolley [m]", "lifted on its way; dots: pendulum")
    lengths = np.linspace(moved.lengths[0] - 0.3, moved.lengths[-1] + 0.3, 60)
    for shaper in SHAPERS:
        left.plot(lengths, [left_over(length, shaper) for length in lengths], color=COLORS[shaper])
        left.plot(moved.lengths, moved.swings[shaper], "o", color=COLORS[shaper], markersize=5)
        left.annotate(
            shaper, (7.3, left_over(7.3, shaper)), ha="right", xytext=(0, 6), textcoords="offset points"
        )
    plain(left, "length of the rope [m]", "swing left over [m]", "shaped for 5 m; lines: theory")
    path = save(figure, "gantry_crane")
    page = OUT / "gantry_crane.html"
    moved.lifted["three moves"].result.export_html(page)
    print(f"look at {path} and {page}")


if __name__ == "__main__":
    main()
