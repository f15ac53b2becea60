"""A catheter is pushed through a bent tube."""

from __future__ import annotations

from typing import Any

import numpy as np

from pliant import _check
from pliant.contacts import Bore
from pliant.curves import Curve
from pliant.friction import LuGre
from pliant.materials import LinearElastic
from pliant.model import Model
from pliant.result import Result
from pliant.scenes.scene import Expected, Scene, energy_drift
from pliant.sections import Circle
from pliant.signals import Table
from pliant.statics import solve_static
from pliant.typing import FloatArray

__all__ = ["catheter", "helical_force", "sinusoidal_force"]


def sinusoidal_force(bending_stiffness: float, weight: float, clearance: float) -> float:
    """Give the force at which a rod that lies in a tube begins to wave from side to side [N].

    A wave of wave number k is held by bending and by the wall it must climb, and driven by the force:
    ``F = EI k^2 + w/(r k^2)``, least at ``2 sqrt(EI w/r)`` (Paslay & Bogy 1964).

    Parameters
    ----------
    bending_stiffness : float
        EI [N m^2].
    weight : float
        Weight per length w [N/m].
    clearance : float
        Radial clearance r [m].

    Examples
    --------
    >>> round(sinusoidal_force(3.927e-4, 0.0339, 2e-3), 4)
    0.1632
    """
    return 2.0 * float(np.sqrt(bending_stiffness * weight / clearance))


def helical_force(bending_stiffness: float, weight: float, clearance: float) -> float:
    """Give the least mean force that winds such a rod into a helix along the wall [N].

    The work of the force is the energy of bending and of being lifted by r on average: ``2 sqrt(2 EI w/r)``
    (Chen, Lin & Cheatham 1990). Arguments as for :func:`sinusoidal_force`.

    Examples
    --------
    >>> round(helical_force(3.927e-4, 0.0339, 2e-3), 4)
    0.2308
    """
    return float(np.sqrt(2.0)) * sinusoidal_force(bending_stiffness, weight, clearance)


def catheter(
    diameter: float = 2e-3,
    clearance: float = 2e-3,
    lead: float = 0.21,
    bend: float = 0.05,
    angle: float = np.pi / 2,
    youngs_modulus: float = 5e8,
    density: float = 1100.0,
    friction: float = 0.2,
    speed: float = 5e-3,
    tip: str = "spring",
    tip_stiffness: float = 50.0,
    tip_force: float = 5.0,
    gravity: float = 9.81,
    retardation_time: float = 2e-2,
    stiffness: float = 1e5,
    settling: float = 0.2,
    elements: int = 100,
    duration: float = 2.7,
    step: float = 2e-3,
) -> Scene:
    """Build the scene: a rod lies in a tube, straight, bent, straight again, and is pushed at one end.

    The tube lies flat, the rod, straight by itself, in it as it would without friction. Its end is pushed
    on along the tube. In the bend it is pressed to the outer wall and loses force to friction as a rope on a
    drum gains it; in the straight parts it waves and winds itself along the wall, once the force is high
    enough, and loses more.

    Parameters
    ----------
    diameter, clearance : float
        Of the rod, and between rod and wall where it is in the middle [m].
    lead, bend, angle : float
        Length of the straight parts, radius of the bend [m], and its angle [rad].
    youngs_modulus, density, retardation_time : float
        Material of the rod [Pa], [kg/m^3], [s].
    friction : float
        Coefficient of friction, static and dynamic alike.
    speed : float
        Of the end that is pushed [m/s], reached within half a second or a quarter of the run.
    tip : {"spring", "force"}
        What the other end pushes against.
    tip_stiffness, tip_force : float
        Of the spring [N/m], and the force [N].
    gravity : float
        Downwards [m/s^2].
    stiffness : float
        Of the contact [N/m^2].
    settling : float
        Time before it is pushed [s].
    elements : int
        Number of elements.
    duration, step : float
        Time to simulate and step [s].

    Returns
    -------
    Scene
        With ``model``, ``simulate()``, ``measure(result)`` and ``expected``.
    """
    _check.choice(tip, "tip", ("spring", "force"))
    _check.number(settling, "settling", above=0, below=duration)
    radius, arc = diameter / 2, bend * angle
    length = 2 * lead + arc
    ahead = np.array([np.cos(angle), np.sin(angle), 0.0])

    def middle(s: float) -> FloatArray:
        turned = float(np.clip((s - lead) / bend, 0.0, angle))
        round_it = np.array([bend * np.sin(turned), bend * (1.0 - np.cos(turned)), 0.0])
        place: FloatArray = np.array([min(s, lead), 0.0, 0.0]) + round_it
        place += max(s - lead - arc, 0.0) * ahead
        return place

    floor = np.array([0.0, 0.0, -clearance if gravity > 0.0 else 0.0])
    times = np.linspace(0.0, duration, 241)
    pushed, start = np.clip(times - settling, 0.0, None), min(0.5, duration / 4)
    way = speed * np.where(pushed < start, pushed**2 / (2 * start), pushed - start / 2)
    places = middle(0.0) + floor + way[:, None] * [1.0, 0.0, 0.0]

    def build(law: LuGre | None, hand: FloatArray) -> Model:
        model = Model(gravity=(0, 0, -gravity))
        rod = model.add_cable(
            Curve(lambda s: middle(s) + floor, length=length),
            elements=elements,
            section=Circle(radius),
            material=LinearElastic(youngs_modulus, 0.4, density, retardation_time=retardation_time),
            rest="straight",
            strain="biot",
            name="catheter",
        )
        bore = Bore(Curve(middle, length=length), radius + clearance, pieces=96)
        tube = model.add_obstacle(bore, name="tube")
        model.add_contact(rod, tube, friction=law, stiffness=stiffness)
        model.drive(rod.start, position=Table(times, hand, smooth=True), direction=(1, 0, 0), name="hand")
        if tip == "spring":
            wall = middle(length) + floor + 0.1 * ahead
            model.add_spring(rod.end, wall, stiffness=tip_stiffness, length=0.1, name="tip")
        else:
            model.add_force(rod.end, -tip_force * ahead, name="tip")
        return model

    model = build(LuGre(friction, friction, stribeck_velocity=1e-3), places)
    rod = model["catheter"]
    # Where it lies without friction, held by the hand.
    bare = build(None, np.repeat(places[:1], len(times), axis=0))

    # Elements in the straight parts beside the bend, a twentieth of the bend off its ends.
    middles = (np.arange(elements) + 0.5) * length / elements
    before = int(np.searchsorted(middles, lead)) - 1
    after = int(np.searchsorted(middles, lead + arc))
    along = np.linspace(0.0, length, elements + 1)
    straight = np.abs(along - length / 2) >= min(arc / 2 + 0.5 * bend, length / 2)

    def measures(result: Result) -> dict[str, Any]:
        force = -result.axial_force(rod)
        late = result.time > duration - 0.2 * (duration - settling)
        height = result.positions(rod)[:, straight, 2].max(axis=1)
        top = np.flatnonzero(height > 0.9 * clearance)
        push = force[:, 1]
        found = {
            "push at the end [N]": float(push[late].mean()),
            "force at the tip [N]": float(force[late, -2].mean()),
            "ratio of forces at the bend": float((force[late, before] / force[late, after]).mean()),
            "energy drift": energy_drift(result),
        }
        if gravity > 0.0 and len(top):
            found["push when it has climbed to the top [N]"] = float(push[top[0]])
        return found

    expected = {"energy drift": Expected(0.0, 1e-3, "work of the hand against friction, strain and spring")}
    if tip == "force":
        ratio = float(np.exp(friction * angle))
        expected["ratio of forces at the bend"] = Expected(ratio, 0.03 * ratio, "exp(mu angle)")
    return Scene(
        name="catheter",
        title="a catheter is pushed through a bent tube",
        model=model,
        settings={"duration": duration, "step": step, "output_every": max(1, round(0.01 / step))},
        expected=expected,
        measures=measures,
        color="axial_force",
        begin=lambda: solve_static(bare),
    )
