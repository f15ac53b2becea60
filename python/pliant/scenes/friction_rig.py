"""A kilogram on a ground with friction, and the five experiments that tell laws of friction apart."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any

import numpy as np

from pliant import _check
from pliant.contacts import HalfSpace
from pliant.friction import Coulomb, Friction, LuGre
from pliant.model import Model
from pliant.points import Line
from pliant.result import Result
from pliant.scenes.scene import Expected, Scene
from pliant.signals import Table
from pliant.statics import solve_static
from pliant.typing import FloatArray

__all__ = ["friction_rig"]

CLASSIC = LuGre(
    1.5, 1.0, stribeck_velocity=1e-3, bristle_stiffness=1e5, bristle_damping=float(np.sqrt(1e5)), viscous=0.4
)
"""The data of Canudas de Wit et al. 1995: 1.5 N and 1 N."""
SLOPE = LuGre(0.4, 0.3, stribeck_velocity=1e-2, bristle_stiffness=1e5, bristle_damping=316.0)
EXPERIMENTS = ("stick_slip", "presliding", "break_away", "incline", "drift")
MASS, SIZE, SPRING, SPEED, GRAVITY = 1.0, 0.01, 2.0, 0.1, 9.81
SLIPS = 1e-3
"""Velocity beyond which a contact slips [m/s]."""
SLIDES = 0.02
"""Velocity at which it has broken away [m/s]."""


@dataclass(frozen=True)
class Motion:
    """What is read of an experiment, and of its equations."""

    time: FloatArray
    way: FloatArray
    velocity: FloatArray
    friction: FloatArray


@dataclass(frozen=True)
class Experiment:
    """One experiment: its force, what presses, and what is measured."""

    law: Friction
    duration: float
    step: float
    read: Callable[[Motion], dict[str, Any]]
    tolerances: dict[str, float]
    weight: float = 1.0
    force: Table | None = None
    """Along x [N]; None: the spring pulls."""
    knots: FloatArray = field(default_factory=lambda: np.zeros(0))
    """Times at which the force has kinks [s]."""
    smooth: Callable[[float], float] | None = None
    """The same force, without the table's own kinks."""

    def pull(self, t: float, x: float) -> float:
        """Force on the mass [N]."""
        if self.force is None:
            return SPRING * (SPEED * t - x)
        return float(self.force(t)[0]) if self.smooth is None else self.smooth(t)


def friction_rig(
    experiment: str = "stick_slip",
    law: Friction | None = None,
    rate: float = 1.0,
    angle: float = np.radians(20.0),
    rise: float = 0.0,
    duration: float | None = None,
    step: float | None = None,
) -> Scene:
    """Build the scene: a mass of 1 kg on a ground, pushed or pulled along it.

    ``"stick_slip"``: a spring of 2 N/m whose end moves at 0.1 m/s pulls it. ``"presliding"``: a force goes to
    1.425 N, a twentieth below what breaks it away, to -1.425 N and back, so slowly that nothing but friction
    resists. ``"break_away"``: a force grows at ``rate``. ``"incline"``: what its weight of 9.81 N has along a
    slope of ``angle`` comes suddenly, or within ``rise``. ``"drift"``: a force swings, 0.8 +- 0.5 N once a
    second. In all of them but the incline it is pressed on with 1 N.

    What is expected of it comes from the differential equations of the law (SciPy's LSODA), the mass on a
    line and the normal force given.

    Parameters
    ----------
    experiment : {"stick_slip", "presliding", "break_away", "incline", "drift"}
        Which.
    law : LuGre or Coulomb, optional
        Law of friction; stiffness, damping and viscosity of bristles are those of a force [N/m], [N s/m], as
        in :func:`pliant.lugre`. None: 1.5 and 1 N, 1e5 N/m, 316 N s/m, 0.4 N s/m, and 1 mm/s for the velocity
        of Stribeck; on the incline 0.4 and 0.3 of the normal force, 316 N s/m, 0 and 1 cm/s.
    rate : float
        Of the force that breaks it away [N/s].
    angle, rise : float, float
        Of the slope [rad], and time within which its pull comes [s].
    duration, step : float, optional
        Time to simulate and step [s]; None: what the experiment needs.

    Returns
    -------
    Scene
        With ``model`` (its body is "block"), ``simulate()``, ``measure(result)`` and ``expected``.
    """
    _check.choice(experiment, "experiment", EXPERIMENTS)
    if law is not None and not isinstance(law, (LuGre, Coulomb)):
        _check.fail("law", law, "must be a pliant.LuGre or pliant.Coulomb")
    _check.number(rate, "rate", above=0)
    _check.number(angle, "angle", above=0, below=np.pi / 2)
    _check.number(rise, "rise", at_least=0)
    case = {
        "stick_slip": lambda: stick_slip(law),
        "presliding": lambda: presliding(law),
        "break_away": lambda: break_away(law, rate),
        "incline": lambda: incline(law, angle, rise),
        "drift": lambda: drift(law),
    }[experiment]()
    until = case.duration if duration is None else _check.number(duration, "duration", above=0)
    model, bare = build(case)
    begun = solve_static(bare)
    if case.force is None:
        place = begun.track(bare["block"]).position[-1]
        moves = {"at": place + [1.0, 0, 0], "velocity": (SPEED, 0, 0), "name": "hook"}
        hooks = [each.add_point_mass(1.0, **moves) for each in (model, bare)]
        bare.pin(hooks[1])
        ahead = place + [[1.0, 0, 0], [1.0 + SPEED * until, 0, 0]]
        model.drive(hooks[0], position=Table(np.array([0.0, until]), ahead, smooth=True))
        model.add_spring(model["block"], hooks[0], stiffness=SPRING, name="spring")

    def measures(result: Result) -> dict[str, Any]:
        track = result.track(result.model["block"])
        force = -result.contact_force("block", "ground")[:, 0]
        return case.read(Motion(result.time, track.position[:, 0], track.velocity[:, 0], force))

    expected: dict[str, Expected] = {}
    if isinstance(case.law, LuGre):
        exact = case.read(integrated(case, until))
        for key, tolerance in case.tolerances.items():
            if key in exact:
                expected[key] = Expected(exact[key], tolerance, "the law's equations, LSODA")
    return Scene(
        name="friction_rig",
        title=f"a mass on a ground with friction: {experiment}",
        model=model,
        settings={"duration": until, "step": case.step if step is None else step},
        expected=expected,
        measures=measures,
        begin=lambda: solve_static(bare),
    )


def build(case: Experiment) -> tuple[Model, Model]:
    """Build the rig, and the same without friction and force, on a rail upwards: to find where it rests."""
    models = []
    for law in (of_a_contact(case.law, case.weight), None):
        model = Model(gravity=(0, 0, -case.weight / MASS))
        block = model.add_point_mass(MASS, at=(0, 0, SIZE), radius=SIZE, name="block")
        ground = model.add_obstacle(HalfSpace(), name="ground")
        model.add_contact(block, ground, friction=law, name="foot")
        models.append(model)
    models[1].slide_along(models[1]["block"], Line((0, 0, 0), (0, 0, 1)))
    if case.force is not None:
        along = np.outer(case.force.values, (1.0, 0.0, 0.0))
        models[0].add_force(models[0]["block"], Table(case.force.times, along, period=case.force.period))
    return models[0], models[1]


def of_a_contact(law: Friction, weight: float) -> Friction:
    """Give the law whose coefficients are those of a force the form that contacts take, per normal force."""
    if not isinstance(law, LuGre):
        return law
    if law.bristle_stiffness is None:
        _check.fail("law.bristle_stiffness", None, "must be given [N/m]")
    return LuGre(
        law.static,
        law.dynamic,
        law.stribeck_velocity,
        law.bristle_stiffness / weight,
        (law.bristle_damping or 0.0) / weight,
        law.viscous / weight,
        law.exponent,
        # The equations as printed: damping that does not fade.
        damping_velocity=1e6,
    )


def integrated(case: Experiment, duration: float) -> Motion:
    """Integrate the equations of the mass and its bristles, from kink to kink of the force."""
    from scipy.integrate import solve_ivp

    law, weight = case.law, case.weight
    assert isinstance(law, LuGre)

    def slope(v: float, z: float) -> float:
        fading = np.exp(-(abs(v / law.stribeck_velocity) ** law.exponent))
        steady = weight * (law.dynamic + (law.static - law.dynamic) * fading)
        return float(v - (law.bristle_stiffness or 0.0) * abs(v) / steady * z)

    def friction(v: float, z: float) -> float:
        bristles = (law.bristle_stiffness or 0.0) * z + (law.bristle_damping or 0.0) * slope(v, z)
        return float(bristles + law.viscous * v)

    def rates(t: float, y: FloatArray) -> list[float]:
        x, v, z = y
        return [v, (case.pull(t, x) - friction(v, z)) / MASS, slope(v, z)]

    state = np.zeros(3)
    times, states = [np.zeros(1)], [state[:, None]]
    borders = [0.0, *[float(t) for t in case.knots if 0 < t < duration], duration]
    for a, b in pairwise(borders):
        at = np.linspace(a, b, max(2, round((b - a) / case.step)) + 1)[1:]
        solved = solve_ivp(
            rates, (a, b), state, method="LSODA", t_eval=at, rtol=1e-9, atol=1e-12, max_step=0.05
        )
        times.append(solved.t)
        states.append(solved.y)
        state = solved.y[:, -1]
    time, (x, v, z) = np.concatenate(times), np.concatenate(states, axis=1)
    return Motion(time, x, v, np.array([friction(*pair) for pair in zip(v, z, strict=True)]))


# The experiments


def stick_slip(law: Friction | None) -> Experiment:
    """Pull by a spring: slips, their period, forces and velocity."""

    def read(motion: Motion) -> dict[str, Any]:
        fast = motion.velocity >= SLIPS
        begin = np.flatnonzero(~fast[:-1] & fast[1:]) + 1
        end = np.flatnonzero(fast[:-1] & ~fast[1:]) + 1
        spring = SPRING * (SPEED * motion.time - motion.way)
        found: dict[str, Any] = {"largest velocity [m/s]": float(motion.velocity.max())}
        if len(begin) and len(end):
            found["first slip [s]"] = float(motion.time[begin[0]])
            found["spring as it slips [N]"] = float(spring[begin].mean())
            found["spring as it sticks [N]"] = float(spring[end].mean())
            found["duration of a slip [s]"] = float(
                (motion.time[end] - motion.time[begin[: len(end)]]).mean()
            )
        if len(begin) > 1:
            found["period [s]"] = float(np.diff(motion.time[begin]).mean())
        return found

    # At a millisecond: half a per cent of the period, one of forces and velocity.
    tolerances = {
        "first slip [s]": 0.032,
        "period [s]": 0.032,
        "spring as it slips [N]": 0.015,
        "spring as it sticks [N]": 0.008,
        "duration of a slip [s]": 0.028,
        "largest velocity [m/s]": 0.0037,
    }
    return Experiment(law or CLASSIC, 29.0, 1e-3, read, tolerances)


def presliding(law: Friction | None) -> Experiment:
    """Push to and fro below break-away: the turning points of a loop."""
    knots = np.array([0.0, 14.25, 16.25, 44.75, 46.75, 75.25, 77.25, 91.5])
    force = 1.425 * np.array([0.0, 1.0, 1.0, -1.0, -1.0, 1.0, 1.0, 0.0])
    times = {"there": 14.25, "held": 16.25, "back": 44.75, "held back": 46.75, "there again": 75.25}

    def read(motion: Motion) -> dict[str, Any]:
        ways = np.interp(list(times.values()), motion.time, motion.way)
        found = {f"{name} [um]": float(1e6 * way) for name, way in zip(times, ways, strict=True)}
        return found

    # A hundredth of the loop.
    tolerances = {f"{name} [um]": 0.45 for name in times}
    return Experiment(law or CLASSIC, 91.5, 2e-3, read, tolerances, force=Table(knots, force), knots=knots)


def break_away(law: Friction | None, rate: float) -> Experiment:
    """Push harder and harder: the largest friction before it slides."""
    until = 1.6 / rate + 0.05

    def read(motion: Motion) -> dict[str, Any]:
        fast = motion.velocity >= SLIDES
        k = int(np.argmax(fast)) if fast.any() else len(fast) - 1
        return {
            "largest friction [N]": float(motion.friction[: k + 1].max()),
            "force as it slides [N]": float(rate * motion.time[k]),
        }

    tolerances = {"largest friction [N]": 0.01, "force as it slides [N]": 0.02}
    force = Table(np.array([0.0, 2 * until]), np.array([0.0, 2 * until * rate]))
    return Experiment(law or CLASSIC, until, min(1e-3, 5e-4 / rate), read, tolerances, force=force)


def incline(law: Friction | None, angle: float, rise: float) -> Experiment:
    """Put it on a slope, at once or gently: whether it slides, and how fast after 3 s."""
    pull = GRAVITY * MASS * np.sin(angle)
    begin = np.array([pull, pull]) if rise == 0.0 else np.array([0.0, pull])

    def read(motion: Motion) -> dict[str, Any]:
        return {"velocity [m/s]": float(motion.velocity[-1]), "way [m]": float(motion.way[-1])}

    # Two thousandths of what sliding freely gives.
    tolerances = {"velocity [m/s]": 6e-3 * pull, "way [m]": 0.02 * pull}
    return Experiment(
        law or SLOPE,
        3.0,
        5e-4,
        read,
        tolerances,
        weight=GRAVITY * MASS * float(np.cos(angle)),
        force=Table(np.array([0.0, rise or 1.0]), begin),
        knots=np.array([rise]),
    )


def drift(law: Friction | None) -> Experiment:
    """Swing a force below break-away: how far it creeps from where the mean force holds it."""
    begin = 8.0

    def read(motion: Motion) -> dict[str, Any]:
        ways = np.interp([begin, begin + 10.0, begin + 40.0], motion.time, motion.way)
        found = {"creep in 10 s [um]": float(1e6 * (ways[1] - ways[0]))}
        if motion.time[-1] >= begin + 40.0 - 1e-9:
            found["creep in 40 s [um]"] = float(1e6 * (ways[2] - ways[0]))
        return found

    def force(t: float) -> float:
        return 0.1 * t if t < begin else 0.8 + 0.5 * float(np.sin(2 * np.pi * (t - begin)))

    times = np.concatenate([[0.0], begin + np.linspace(0.0, 40.0, 40001)])
    table = Table(times, np.array([force(t) for t in times]))
    tolerances = {"creep in 10 s [um]": 10.0, "creep in 40 s [um]": 40.0}
    return Experiment(
        law or CLASSIC,
        begin + 40.0,
        1e-3,
        read,
        tolerances,
        force=table,
        knots=np.array([begin]),
        smooth=force,
    )
