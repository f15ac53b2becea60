"""A line that is meant to yield arrests a falling weight.

How hard is the jerk when a line catches a falling weight, and what does it take to make it gentle? A weight
of 100 kg falls 2 m into a line of 4 m, half of it wire rope, half a rod. One rod only stretches and throws
the weight back up; the other is of a soft metal that yields, stays longer by what it took, and holds. It is
drawn through strains to and fro as well, as a testing machine would do it.

Checked: the largest forces and the drawn length against the energy balance of a weight on a spring, the loops
against the return mapping of one point, and the energy audit.

    python examples/fall_arrester.py
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import _audit
import numpy as np
import pliant as pl
from _style import BLUE, GREY, INK, RED, new_figure, plain, save
from matplotlib.axes import Axes

WEIGHT, FALL, GRAVITY = 100.0, 2.0, 9.81
"""Mass [kg], height of the fall [m], gravity [m/s^2]."""
ROPE_LENGTH, PIECE_LENGTH = 2.0, 2.0
"""Of the rope and of the piece that may yield [m]."""
DAMPING = 1e-5
"""Retardation time of all of it [s]."""
ROPE = pl.LinearElastic(1e11, poisson_ratio=0.3, density=5000.0, retardation_time=DAMPING)
ROPE_SECTION, PIECE_SECTION = pl.Circle(4e-3), pl.Circle(6e-3)
SPEED = float(np.sqrt(2 * GRAVITY * FALL))
"""Of the weight when the line gets taut [m/s]."""
MODULUS, YIELD, TANGENT = 1e11, 1.2e8, 2e8
"""Young's modulus, yield stress and tangent modulus of annealed copper, roughly [Pa]."""
STRAINS = (0.02, -0.02, 0.03, 0.0, 0.04)
"""Strains that the piece is drawn through."""


def copper(hardening: str = "isotropic") -> pl.BilinearPlastic:
    """Give the metal of the piece."""
    return pl.BilinearPlastic(
        MODULUS, 0.34, 8900.0, YIELD, TANGENT, hardening=hardening, retardation_time=DAMPING
    )


@dataclass(frozen=True)
class Caught:
    """A catch."""

    result: pl.Result
    peak: float
    """Largest force on the weight [N]."""
    expected: float
    """The same by the energy balance of a weight on a line without mass [N]."""
    anchor: float
    """Largest force at the anchor [N], where waves in the rope arrive, too."""
    drawn: float
    """Length by which the piece stays longer [m]."""
    expected_drawn: float
    gaps: list[float]
    """Gap of the energy audit over the energy of the fall, for a step and half of it."""

    @property
    def order(self) -> float:
        """Order with which the audit closes."""
        return float(np.log2(self.gaps[0] / self.gaps[1]))


@dataclass(frozen=True)
class Study:
    """What was found."""

    elastic: Caught
    yielding: Caught
    loops: dict[str, tuple[np.ndarray, np.ndarray]]
    """Strains and stresses [Pa] of the piece drawn to and fro, for each hardening."""
    closed: dict[str, tuple[np.ndarray, np.ndarray]]
    """The same of one point, densely."""

    @property
    def largest_gap(self) -> float:
        """Largest difference of the loops from those of one point, over the yield stress."""
        gaps = []
        for name, (strain, stress) in self.loops.items():
            x, y = self.closed[name]
            places = [np.flatnonzero(np.isclose(x, s, rtol=0, atol=1e-9)) for s in strain]
            gaps += [np.abs(y[i] - s).min() for i, s in zip(places, stress, strict=True)]
        return float(max(gaps) / YIELD)


def falling(x: np.ndarray) -> np.ndarray:
    """Velocities of the line when it gets taut (n, 3): of equal force all along."""
    part = (
        ROPE_LENGTH
        / ROPE_SECTION.area
        / (ROPE_LENGTH / ROPE_SECTION.area + PIECE_LENGTH / PIECE_SECTION.area)
    )
    places, speeds = (0.0, ROPE_LENGTH, ROPE_LENGTH + PIECE_LENGTH), (0.0, part * SPEED, SPEED)
    return -np.interp(-x[:, 2], places, speeds)[:, None] * (0.0, 0.0, 1.0)


def build(material: pl.LinearElastic | pl.BilinearPlastic, elements: int) -> tuple[pl.Model, pl.Joint]:
    """Weight on rope and piece, taut, with the speed of its fall."""
    model = pl.Model(gravity=(0, 0, -GRAVITY))
    ends = (0.0, -ROPE_LENGTH, -ROPE_LENGTH - PIECE_LENGTH)
    rope, piece = (
        model.add_cable(
            [(0, 0, a), (0, 0, b)],
            elements=elements,
            section=section,
            material=of,
            strain="biot",
            tension_only=True,
            velocity=falling,
            name=name,
        )
        for a, b, section, of, name in (
            (ends[0], ends[1], ROPE_SECTION, ROPE, "rope"),
            (ends[1], ends[2], PIECE_SECTION, material, "piece"),
        )
    )
    anchor = model.pin(rope.start)
    model.pin(rope.end, piece.start)
    weight = model.add_rigid_body(
        mass=WEIGHT,
        shape=pl.Sphere(0.14),
        position=(0, 0, ends[2]),
        velocity=(0, 0, -SPEED),
        name="weight",
    )
    model.pin(piece.end, weight.center)
    return model, anchor


def expected(yields: bool) -> tuple[float, float]:
    """Largest force [N] and drawn length [m] of a weight on a line without mass, by its energy."""
    area = PIECE_SECTION.area
    softness = ROPE_LENGTH / (ROPE.youngs_modulus * ROPE_SECTION.area) + PIECE_LENGTH / (MODULUS * area)
    hardening = area * MODULUS * TANGENT / (MODULUS - TANGENT) / PIECE_LENGTH
    load = WEIGHT * GRAVITY
    line = ROPE.density * ROPE_SECTION.area * ROPE_LENGTH + copper().density * area * PIECE_LENGTH
    # A third of the mass of a line moves with its end.
    given = (WEIGHT + line / 3) * SPEED**2 / 2
    if not yields:
        # given + m g c F = c F^2/2.
        return load + np.sqrt(load**2 + 2 * given / softness), 0.0
    # given + m g (c F + d) = c F^2/2 + (F_y + F) d/2, with F = F_y + k d, quadratic in d.
    start = YIELD * area
    a = softness * hardening**2 / 2 + hardening / 2
    b = softness * hardening * (start - load) + start - load
    c = softness * start * (start / 2 - load) - given
    drawn = (-b + np.sqrt(b * b - 4 * a * c)) / (2 * a)
    return start + hardening * drawn, drawn


def catch(yields: bool, elements: int, duration: float, step: float) -> Caught:
    """Catch the weight, with a step and half of it."""
    material = copper() if yields else pl.LinearElastic(MODULUS, 0.34, 8900.0, retardation_time=DAMPING)
    gaps = []
    for h in (step, step / 2):
        model, anchor = build(material, elements)
        result = pl.simulate(model, duration=duration, step=h)
        energy = result.energy
        gaps.append(float(np.abs(energy.total - energy.total[0]).max() / energy.kinetic[0]))
    peak = float(result.axial_force("piece")[:, -1].max())
    held = float(np.linalg.norm(result.reaction(anchor).force, axis=1).max())
    drawn = float(result.strain("piece").plastic[-1].mean() * PIECE_LENGTH)
    force, length = expected(yields)
    return Caught(result, peak, force, held, drawn, length, gaps)


def draw_to_and_fro(hardening: str, load_steps: int) -> tuple[np.ndarray, np.ndarray]:
    """Strain and stress of a stout piece whose end is driven."""
    model = pl.Model()
    section = pl.Circle(0.05)
    piece = model.add_cable(
        [(0, 0, 0), (PIECE_LENGTH, 0, 0)],
        elements=2,
        section=section,
        material=copper(hardening),
        strain="biot",
        name="piece",
    )
    model.clamp(piece.start)
    turns = np.array([0.0, *STRAINS])
    times = np.linspace(0, 1, len(turns))
    model.drive(piece.end, position=lambda t: (PIECE_LENGTH * (1 + np.interp(t, times, turns)), 0, 0))
    result = pl.solve_static(model, load_steps=load_steps * len(STRAINS))
    return result.strain(piece).axial[:, 0], result.axial_force(piece)[:, 0] / section.area


def point(hardening: str, strains: np.ndarray) -> np.ndarray:
    """Stress [Pa] of one point, by return mapping."""
    modulus = MODULUS * TANGENT / (MODULUS - TANGENT)
    kinematic = hardening == "kinematic"
    plastic, way, stress = 0.0, 0.0, []
    for strain in strains:
        trial = MODULUS * (strain - plastic) - (modulus * plastic if kinematic else 0.0)
        bound = YIELD + (0.0 if kinematic else modulus * way)
        flow = max(abs(trial) - bound, 0.0) / (MODULUS + modulus)
        plastic, way = plastic + flow * np.sign(trial), way + flow
        stress.append(MODULUS * (strain - plastic))
    return np.array(stress)


def run(
    elements: int = 4, duration: float = 0.2, step: float = 2e-4, load_steps: int = 8, fine: int = 400
) -> Study:
    """Catch the weight by both lines, and draw the piece to and fro."""
    names = ("isotropic", "kinematic")
    turns = np.array([0.0, *STRAINS])
    ways = [np.linspace(a, b, fine + 1)[1:] for a, b in pairwise(turns)]
    strains = np.concatenate([[0.0], *ways])
    return Study(
        catch(False, elements, duration, step),
        catch(True, elements, duration, step),
        {name: draw_to_and_fro(name, load_steps) for name in names},
        {name: (strains, point(name, strains)) for name in names},
    )


def draw_forces(axes: Axes, study: Study) -> None:
    """Draw the force in the piece over time."""
    for caught, color, name in ((study.elastic, GREY, "elastic"), (study.yielding, RED, "yields")):
        force = caught.result.axial_force("piece").mean(axis=1)
        axes.plot(caught.result.time, force / 1e3, color=color, linewidth=1.4, label=name)
    axes.legend(frameon=False, fontsize=8.5)
    plain(axes, "t [s]", "force in the line [kN]", "The jerk")


def main() -> None:
    """Run, report, draw."""
    study = run()
    for name, caught in (("elastic", study.elastic), ("yields", study.yielding)):
        print(
            f"{name}: largest force {caught.peak:.0f} N (energy balance {caught.expected:.0f}), longer by "
            f"{1e3 * caught.drawn:.2f} mm ({1e3 * caught.expected_drawn:.2f}), {caught.anchor:.0f} N at the "
            f"anchor; audit closes to "
            f"{caught.gaps[0]:.1e}, {caught.gaps[1]:.1e}, order {caught.order:.2f}"
        )
    print(f"loops: within {study.largest_gap:.1e} of the yield stress of those of one point")
    figure = new_figure(11, 6.4)
    grid = figure.subplots(2, 2)
    draw_forces(grid[0, 0], study)
    axes = grid[0, 1]
    for caught, color, name in ((study.elastic, GREY, "elastic"), (study.yielding, RED, "yields")):
        place = caught.result.track(caught.result.model["weight"].center).position[:, 2]
        axes.plot(
            caught.result.time, place + ROPE_LENGTH + PIECE_LENGTH, color=color, linewidth=1.4, label=name
        )
    axes.legend(frameon=False, fontsize=8.5)
    plain(axes, "t [s]", "height [m]", "The weight, from where the line gets taut")
    _audit.draw_energies(grid[1, 0], study.yielding.result, "Energies, the line that yields", "kJ", 1e3)
    axes = grid[1, 1]
    for name, color in (("isotropic", BLUE), ("kinematic", RED)):
        axes.plot(
            1e2 * study.closed[name][0], study.closed[name][1] / 1e6, color=color, linewidth=1, label=name
        )
        strain, stress = study.loops[name]
        axes.plot(1e2 * strain, stress / 1e6, ".", color=color, markersize=5)
    axes.axhline(0, color=INK, linewidth=0.6)
    axes.legend(frameon=False, fontsize=8.5, loc="lower right")
    plain(axes, "strain [%]", "stress [MPa]", "The piece drawn to and fro, and the law of one point (lines)")
    print(f"look at {save(figure, 'fall_arrester', dpi=110)}")


if __name__ == "__main__":
    main()
