"""A minute of accuracy checks on the machine at hand: what is computed beside what is exact."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import NamedTuple

import numpy as np

from pliant.materials import LinearElastic
from pliant.model import Model
from pliant.modes import solve_modes
from pliant.sections import Circle
from pliant.shapes import Box
from pliant.simulation import simulate
from pliant.statics import solve_static

__all__ = ["CHECKS", "Check"]


class Check(NamedTuple):
    """A figure, what it must be, how far off it may be, and why it must be that."""

    name: str
    value: float
    exact: float
    tolerance: float
    source: str

    @property
    def passed(self) -> bool:
        """Whether the figure is near enough."""
        return bool(abs(self.value - self.exact) <= self.tolerance)


STEEL = LinearElastic(youngs_modulus=2.1e11, poisson_ratio=0.3, density=7850.0)


def statics() -> Iterator[Check]:
    """Roll a strip to a circle, hang a rope."""
    section = Circle(radius=1e-2)
    for elements, tolerance in ((8, 2e-3), (16, 1.3e-4)):
        model = Model()
        strip = model.add_cable([(0, 0, 0), (1, 0, 0)], elements=elements, section=section, material=STEEL)
        model.clamp(strip.start)
        moment = 2 * np.pi * STEEL.youngs_modulus * section.second_moments[0]
        model.add_moment(strip.end, lambda factor, moment=moment: (0, moment * factor, 0))
        rolled = solve_static(model, load_steps=8)
        gap = float(np.linalg.norm(rolled.track(strip.end).position[-1]))
        yield Check(
            f"strip rolled to a circle, gap, {elements} elements [m]", gap, 0.0, tolerance, "elastica"
        )
    model = Model(gravity=(0, 0, -9.81))
    rope = model.add_cable(
        [(0, 0, 0), (4, 0, 0)], elements=16, section=Circle(2e-3), material=STEEL, rest_length=4.4
    )
    hooks = [model.pin(rope.start), model.pin(rope.end)]
    hanging = solve_static(model)
    force = sum(float(hanging.reaction(hook).force[-1, 2]) for hook in hooks)
    # The mass is that of the line as given, 4 m.
    weight = STEEL.density * Circle(2e-3).area * 4.0 * 9.81
    yield Check("weight of a hanging rope [N]", force, weight, 1e-6 * weight, "equilibrium")


def vibration() -> Iterator[Check]:
    """Find the lowest frequency of a clamped bar."""
    radius, length = 1e-2, 1.0
    model = Model()
    bar = model.add_cable([(0, 0, 0), (length, 0, 0)], elements=12, section=Circle(radius), material=STEEL)
    model.clamp(bar.start)
    frequency = float(solve_modes(model, count=1).frequencies[0])
    wave = 1.8751040687 / length
    exact = wave**2 * (radius / 2) * np.sqrt(STEEL.youngs_modulus / STEEL.density) / (2 * np.pi)
    yield Check("lowest frequency of a clamped bar [Hz]", frequency, exact, 1e-4 * exact, "Euler-Bernoulli")


def motion() -> Iterator[Check]:
    """Swing a pendulum: period, order in the step, energy, gap of its joint."""
    length, gravity, start = 0.5, 9.81, np.radians(30.0)
    errors = []
    for steps in (50, 100):
        model = Model(gravity=(0, 0, -gravity))
        place = np.array([np.sin(start), 0.0, -np.cos(start)]) * length
        bob = model.add_rigid_body(
            mass=1.0, inertia=(1e-9, 1e-9, 1e-9), shape=Box((0.05, 0.05, 0.05)), position=place
        )
        axle = model.hinge(bob.at(-place), axis=(0, 1, 0))
        # Arithmetic-geometric mean: the period of the pendulum at any angle.
        a, g = 1.0, float(np.cos(start / 2))
        while abs(a - g) > 1e-15:
            a, g = (a + g) / 2, float(np.sqrt(a * g))
        period = 2 * np.pi * np.sqrt(length / gravity) / a
        result = simulate(model, duration=period / 4, step=period / 4 / steps, progress=False)
        errors.append(abs(float(result.track(bob.center).position[-1, 0])))
    yield Check("pendulum, place after a quarter [m]", errors[1], 0.0, 2e-5, "elliptic integral")
    yield Check("pendulum, order in the step", float(np.log2(errors[0] / errors[1])), 2.0, 0.2, "theory")
    far = np.abs(np.linalg.norm(result.track(bob.center).position, axis=1) - length).max()
    yield Check("pendulum, stretch of its arm [m]", float(far), 0.0, 1e-9, "constraint")
    drift = float(np.ptp(result.energy.total) / (gravity * length))
    yield Check("pendulum, drift of its energy", drift, 0.0, 1e-4, "conservation")
    force = result.reaction(axle).force[0]
    pull = gravity * np.cos(start)
    yield Check("pendulum, pull of its arm [N]", float(np.linalg.norm(force)), pull, 1e-6 * pull, "statics")


def bits() -> Iterator[Check]:
    """Compare the bits of one and two threads."""
    model = Model(gravity=(0, 0, -9.81))
    rubber = LinearElastic(youngs_modulus=1e7, poisson_ratio=0.45, density=1000.0)
    # A second thread is taken from 4,000 elements on.
    rope = model.add_cable([(0, 0, 0), (1, 0, 0)], elements=4000, section=Circle(5e-3), material=rubber)
    model.pin(rope.start)
    ends = [
        simulate(model, duration=0.01, step=1e-3, threads=threads, progress=False).positions(rope)[-1]
        for threads in (1, 2)
    ]
    different = float(np.count_nonzero(ends[0] != ends[1]))
    yield Check("numbers that differ between 1 and 2 threads", different, 0.0, 0.0, "fixed order of sums")


CHECKS: tuple[Callable[[], Iterator[Check]], ...] = (statics, vibration, motion, bits)
