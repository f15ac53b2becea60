"""A coil spring of wire carries a weight: how far, how fast, and why its end turns.

Is a spring more than its constant? A steel wire wound to a helix, a beam curved in space at rest, hangs from
a clamp. Its lower end holds a weight that may slide along the axis and turn about it. Stretching twists the
wire, and a little of it unwinds the coil: the weight turns as it sinks, and when it is let go it bounces.

Checked: the deflection and the turn against those of a thin helix under an axial force, torsion and bending
of the wire together; the lowest frequency against the constant with a third of the spring's mass; energies.

    python examples/coil_spring.py
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pliant as pl
from _style import AMBER, BLUE, GREEN, INK, RED, new_figure, plain, save
from matplotlib.figure import Figure

STEEL = pl.LinearElastic(youngs_modulus=2.06e11, poisson_ratio=0.3, density=7850.0)
WIRE = pl.Circle(radius=3e-3)
RADIUS, PITCH, TURNS = 0.05, 0.02, 5.0
MASS, GRAVITY = 1.0, 9.81


@dataclass(frozen=True)
class Spring:
    """What the spring does, and what is expected of it."""

    static: pl.Result
    bounce: pl.Result
    sink: float
    """Static deflection over that of the thin helix."""
    turn: float
    """Turn of the weight over that of the thin helix."""
    frequency: float
    """Frequency of the bounce over sqrt(k/(m + m_s/3))/(2 pi)."""
    drift: float
    """Largest change of the sum of energies over the largest kinetic energy."""


def helix() -> pl.Curve:
    """Return the wire's line: down from the clamp, five turns about the z axis."""
    rise = PITCH / (2 * np.pi)
    w = 1 / np.hypot(RADIUS, rise)

    def place(s: float) -> tuple[float, float, float]:
        return RADIUS * np.cos(w * s), RADIUS * np.sin(w * s), -rise * w * s

    return pl.Curve(place, length=2 * np.pi * TURNS / w)


def build(elements: int) -> tuple[pl.Model, pl.Beam, pl.RigidBody]:
    """Wire, weight and the guide that keeps the weight on the axis."""
    model = pl.Model(gravity=(0, 0, -GRAVITY))
    wire = model.add_beam(helix(), elements=elements, section=WIRE, material=STEEL, name="wire")
    bob = pl.Cylinder(0.04, 0.03)
    weight = model.add_rigid_body(mass=MASS, shape=bob, position=(0, 0, -PITCH * TURNS), name="weight")
    model.clamp(wire.start)
    model.weld(weight, wire.end)
    model.cylindrical(weight.center, axis=(0, 0, 1))
    return model, wire, weight


def thin_helix(force: float) -> tuple[float, float]:
    """Deflection [m] and turn [rad] of a thin helix whose end slides along its axis and turns about it.

    The wire carries the torque F R cos(alpha) and the moment F R sin(alpha), alpha the angle of pitch.
    """
    twist = STEEL.shear_modulus * WIRE.torsion_constant
    bend = STEEL.youngs_modulus * WIRE.second_moments[0]
    alpha = np.arctan2(PITCH, 2 * np.pi * RADIUS)
    sine, cosine = np.sin(alpha), np.cos(alpha)
    length = helix().length
    sink = force * RADIUS**2 * length * (cosine**2 / twist + sine**2 / bend)
    turn = force * RADIUS * length * sine * cosine * (1 / twist - 1 / bend)
    return float(sink), float(turn)


def load() -> float:
    """Weight at the end, and half of the wire's."""
    return GRAVITY * (MASS + STEEL.density * WIRE.area * helix().length / 2)


def run(elements: int = 160, duration: float = 0.5, step: float = 2e-3) -> Spring:
    """Let the weight sink slowly, then let it go."""
    model, _, weight = build(elements)
    static = pl.solve_static(model)
    track = static.track(weight)
    spring_mass = STEEL.density * WIRE.area * helix().length
    sink, turn = thin_helix(load())
    frequency = pl.solve_modes(model, count=1, about=static).frequencies[0]
    expected = np.sqrt(load() / sink / (MASS + spring_mass / 3)) / (2 * np.pi)
    bounce = pl.simulate(model, duration=duration, step=step)
    energy = bounce.energy
    return Spring(
        static,
        bounce,
        (-PITCH * TURNS - track.position[-1, 2]) / sink,
        abs(track.orientation[-1].as_rotvec()[2]) / turn,
        frequency / expected,
        float(np.abs(energy.total - energy.total[0]).max() / energy.kinetic.max()),
    )


def picture(spring: Spring) -> Figure:
    """Draw the spring at rest and at its lowest, the bounce and the energies."""
    figure = new_figure(11, 4.6)
    grid = figure.add_gridspec(2, 2, width_ratios=(1, 1.35))
    space = figure.add_subplot(grid[:, 0], projection="3d")
    result = spring.bounce
    height = result.track(result.model["weight"]).position[:, 2]
    lowest = int(np.argmin(height))
    for frame, color, name in ((0, BLUE, "let go"), (lowest, RED, f"lowest, {result.time[lowest]:.2f} s")):
        x, y, z = result.positions("wire")[frame].T
        space.plot(x, y, z, color=color, linewidth=2.5, label=name)
        space.plot([x[-1], 0], [y[-1], 0], [z[-1], height[frame]], color=color, linewidth=1)
        space.plot(0, 0, height[frame], "o", color=color, markersize=9)
    space.plot(RADIUS, 0, 0, "s", color=INK)
    space.set_aspect("equal")
    space.locator_params(nbins=4)
    space.set_zlabel("z [m]")
    space.legend(frameon=False, fontsize=9, loc="upper left")
    space.view_init(elev=14, azim=-60)
    axes = figure.add_subplot(grid[0, 1])
    turn = np.degrees(result.track(result.model["weight"]).orientation.as_rotvec()[:, 2])
    axes.plot(result.time, 1e3 * (height - height[0]), color=BLUE, linewidth=1.6)
    axes.axhline(-1e3 * thin_helix(load())[0], color=INK, linewidth=0.8, linestyle="--")
    other = axes.twinx()
    other.plot(result.time, turn, color=AMBER, linewidth=1.4)
    other.set_ylabel("turn [degrees]", color=AMBER)
    plain(axes, "t [s]", "weight [mm]", "The weight sinks and turns; dashed: the thin helix at rest")
    axes = figure.add_subplot(grid[1, 1])
    energy = result.energy
    for values, color, name in (
        (energy.kinetic, BLUE, "kinetic"),
        (energy.elastic, AMBER, "elastic"),
        (energy.gravitational - energy.gravitational[0], GREEN, "gravitational"),
        (energy.total - energy.total[0], INK, "sum"),
    ):
        axes.plot(result.time, values, color=color, linewidth=1.6, label=name)
    axes.legend(frameon=False, fontsize=8, loc="upper right", ncols=2)
    plain(axes, "t [s]", "energy [J]", "Where the energy goes")
    return figure


def main() -> None:
    """Print what the spring does beside what is expected of it, and leave a picture."""
    spring = run()
    sink, turn = thin_helix(load())
    print(f"thin helix: sinks by {1e3 * sink:.2f} mm and turns by {np.degrees(turn):.3f} degrees")
    print(f"the beam, of it: {spring.sink:.4f} and {spring.turn:.4f}")
    print(f"frequency over that of the constant with a third of the spring's mass: {spring.frequency:.4f}")
    print(f"the sum of energies drifts by {spring.drift:.1e} of the kinetic energy")
    print(f"look at {save(picture(spring), 'coil_spring')}")


if __name__ == "__main__":
    main()
