"""A tensegrity prism: three rigid struts that touch nowhere, held up by cables.

Which form does it take, how stiff is that form, and does it survive a fall? Three struts stand on joints, a
vertical cable runs from the foot of each to the head of another, three cables join the heads. The cables are
shorter than their places, and none knows what form is wanted: the struts are put down untwisted and turn
into the one form that can hold prestress. Then the prism is let go, falls, and is caught by slack lines.

Checked: a prism of n struts can be prestressed at one twist only, pi/2 + pi/n, 150 degrees for three,
whatever cables and prestress; force densities (tension over length) of vertical and horizontal cables stand
there in the ratio 2 sin(pi/n), times that of the radii above and below. The lowest frequencies are those of
three rods on springs, by an energy written down again with NumPy alone. In the fall the energy audit closes.

    python examples/tensegrity.py
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pliant as pl
from _style import AMBER, BLUE, GREY, INK, OUT, RED, new_figure, plain, save, scale_bar, seen_from
from matplotlib.axes import Axes
from scipy.linalg import eigh
from scipy.spatial.transform import Rotation

RADIUS, HEIGHT, TWIST = 0.5, 1.0, 5 * np.pi / 6
"""Of the prism: radius [m] and height [m] that it is designed for, and the twist that it can only have."""
STRAIN = 0.01
"""Strain of the cables in the form designed."""
MASS = 0.6
"""Mass of a strut [kg]."""
CORD = pl.LinearElastic(2e9, poisson_ratio=0.4, density=1150.0, retardation_time=1e-3)
SECTION = pl.Circle(1.5e-3)
STRUT = float(np.hypot(HEIGHT, 2 * RADIUS * np.sin(TWIST / 2)))
"""Length of a strut [m]."""
HORIZONTAL = np.sqrt(3) * RADIUS / (1 + STRAIN)
VERTICAL = float(np.hypot(HEIGHT, 2 * RADIUS * np.sin(np.pi / 12))) / (1 + STRAIN)
"""Stress-free lengths of the cables [m]."""


@dataclass(frozen=True)
class Prism:
    """A model of the prism with its parts."""

    model: pl.Model
    struts: list[pl.Handle]
    heads: list[pl.Point]
    cables: dict[str, list[pl.Handle]]
    lines: list[pl.Handle]


@dataclass(frozen=True)
class Found:
    """What was found."""

    start: Prism
    statics: pl.Result
    dropped: Prism
    fall: pl.Result
    twist: float
    """Twist of the form found [rad]."""
    ratio: float
    """Force density of the vertical cables over that of the horizontal ones."""
    expected: float
    """The same in theory: 2 sin(pi/n) times the radius of the heads over that of the feet."""
    frequencies: np.ndarray
    """Lowest of the prism on its feet [Hz]."""
    rods: np.ndarray
    """The same of three rods on springs [Hz]."""
    gaps: list[float]
    """Gap of the energy audit of the fall over the largest kinetic energy, for a step and half of it."""

    @property
    def order(self) -> float:
        """Order with which the audit closes."""
        return float(np.log2(self.gaps[0] / self.gaps[1]))


def ends(twist: float) -> tuple[np.ndarray, np.ndarray]:
    """Feet and heads of the struts (3, 3) at a twist, with struts of the right length."""
    angle = 2 * np.pi * np.arange(3) / 3
    height = np.sqrt(STRUT**2 - (2 * RADIUS * np.sin(twist / 2)) ** 2)
    feet = RADIUS * np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1)
    heads = RADIUS * np.stack([np.cos(angle + twist), np.sin(angle + twist), 0 * angle], axis=1)
    return feet, heads + (0, 0, height)


def build(elements: int, free: bool) -> Prism:
    """Model of the prism on joints, or ``free`` under the slack lines that catch it."""
    model = pl.Model(gravity=(0, 0, -9.81) if free else (0, 0, 0))
    feet, heads = ends(2 * np.pi / 3)
    struts, tops, bottoms = [], [], []
    for k in range(3):
        along = (heads[k] - feet[k]) / STRUT
        across = np.cross((0, 0, 1), along)
        across /= np.linalg.norm(across)
        axes = np.stack([across, np.cross(along, across), along], axis=1)
        strut = model.add_rigid_body(
            mass=MASS,
            shape=pl.Cylinder(radius=0.01, length=STRUT),
            position=(feet[k] + heads[k]) / 2,
            orientation=Rotation.from_matrix(axes),
            name=f"strut {k}",
        )
        bottoms.append(strut.at((0, 0, -STRUT / 2)))
        tops.append(strut.at((0, 0, STRUT / 2)))
        struts.append(strut)
        if not free:
            model.universal(bottoms[k], None, axes[:, 0], axes[:, 1])

    def cord(name: str, a: pl.Point, b: pl.Point, from_: np.ndarray, to: np.ndarray, length: float):
        cable = model.add_cable(
            [from_, to],
            elements=elements,
            section=SECTION,
            material=CORD,
            rest_length=length,
            tension_only=True,
            name=name,
        )
        model.pin(cable.start, a)
        model.pin(cable.end, b)
        return cable

    cables: dict[str, list[pl.Handle]] = {"top": [], "vertical": [], "bottom": []}
    for k in range(3):
        j = (k + 1) % 3
        # At the twist of 150 degrees the head of strut k - 1 is 30 degrees ahead of the foot of strut k.
        i = (k - 1) % 3
        cables["top"].append(cord(f"top {k}", tops[k], tops[j], heads[k], heads[j], HORIZONTAL))
        cables["vertical"].append(cord(f"vertical {k}", bottoms[k], tops[i], feet[k], heads[i], VERTICAL))
        cables["bottom"].append(cord(f"bottom {k}", bottoms[k], bottoms[j], feet[k], feet[j], HORIZONTAL))
    lines = []
    if free:
        for k, (top, head) in enumerate(zip(tops, heads, strict=True)):
            hook = 2.2 * head / (1, 1, head[2]) * (1, 1, 0) + (0, 0, 2.2)
            line = model.add_tendon([hook, top], length=1.85, stiffness=600.0, damping=4.0, name=f"line {k}")
            lines.append(line)
    return Prism(model, struts, tops, cables, lines)


def rods(heads: np.ndarray) -> np.ndarray:
    """Frequencies [Hz] of three rods on fixed feet, their heads joined by springs, in equilibrium."""
    feet = ends(TWIST)[0]
    stiffness = CORD.youngs_modulus * SECTION.area
    pairs = [(k, (k + 1) % 3) for k in range(3)]

    def spring(length: float, free: float) -> float:
        # Green-Lagrange strain, as in the model.
        return stiffness * free / 2 * (((length / free) ** 2 - 1) / 2) ** 2

    along = (heads - feet) / STRUT
    first = np.cross(along, (0, 0, 1))
    first /= np.linalg.norm(first, axis=1)[:, None]
    second = np.cross(along, first)

    def energy(x: np.ndarray) -> float:
        a, b = x.reshape(2, 3, 1)
        u = along + a * first + b * second
        tops = feet + STRUT * u / np.linalg.norm(u, axis=1)[:, None]
        total = sum(spring(float(np.linalg.norm(tops[i] - tops[j])), HORIZONTAL) for i, j in pairs)
        return total + sum(spring(float(np.linalg.norm(tops[i - 1] - feet[i])), VERTICAL) for i in range(3))

    h, unit = 1e-3, np.eye(6)
    hessian = np.array(
        [
            [
                sum(s * r * energy(h * (s * unit[i] + r * unit[j])) for s in (1, -1) for r in (1, -1))
                / (4 * h * h)
                for j in range(6)
            ]
            for i in range(6)
        ]
    )
    # Uniform rods about their feet, and cords that move as straight lines.
    per_length = CORD.density * SECTION.area
    directions = np.concatenate([first, second])

    def mass(i: int, j: int) -> float:
        turning = (MASS * (STRUT**2 / 3 + 1e-4 / 4) + per_length * VERTICAL * STRUT**2 / 3) * (i == j)
        a, b = i % 3, j % 3
        share = 2 / 3 if a == b else 1 / 6
        return turning + per_length * HORIZONTAL * STRUT**2 * share * float(directions[i] @ directions[j])

    inertia = np.array([[mass(i, j) for j in range(6)] for i in range(6)])
    return np.sqrt(np.abs(eigh(hessian, inertia, eigvals_only=True))) / (2 * np.pi)


def run(elements: int = 2, duration: float = 1.5, step: float = 1e-3) -> Found:
    """Find the form, its frequencies, and let it fall."""
    start = build(elements, free=False)
    statics = pl.solve_static(start.model)
    heads = np.array([statics.track(head).position[-1] for head in start.heads])
    feet = ends(TWIST)[0]
    angle = np.arctan2(heads[:, 1], heads[:, 0]) - np.arctan2(feet[:, 1], feet[:, 0])
    twist = float(np.mean(np.mod(angle, 2 * np.pi)))

    def density(kind: str) -> float:
        force = np.mean([statics.axial_force(cable)[-1].mean() for cable in start.cables[kind]])
        place = statics.positions(start.cables[kind][0])[-1]
        return float(force / np.linalg.norm(place[-1] - place[0]))

    modes = pl.solve_modes(start.model, count=6, about=statics)
    dropped = build(elements, free=True)
    falls = [
        pl.simulate(dropped.model, duration=duration, step=h, start=statics, output_every=round(step / h))
        for h in (step, step / 2)
    ]
    gaps = []
    for fall in falls:
        energy = fall.energy
        gaps.append(float(np.abs(energy.total - energy.total[0]).max() / energy.kinetic.max()))
    return Found(
        start,
        statics,
        dropped,
        falls[1],
        twist,
        density("vertical") / density("top"),
        2 * np.sin(np.pi / 3) * float(np.hypot(*heads[0, :2])) / RADIUS,
        modes.frequencies,
        rods(heads),
        gaps,
    )


def draw_prism(axes: Axes, prism: Prism, result: pl.Result, i: int, shift: float = 0.0) -> None:
    """Draw struts and cables at output i."""
    move = np.array([shift, 0.0])
    for kind, color in (("bottom", GREY), ("vertical", RED), ("top", BLUE)):
        for cable in prism.cables[kind]:
            x = seen_from(result.positions(cable)[i], 20, 12) + move
            axes.plot(*x.T, color=color, linewidth=1.2)
    for strut in prism.struts:
        places = [result.track(strut.at((0, 0, s * STRUT / 2))).position[i] for s in (-1, 1)]
        x = seen_from(np.array(places), 20, 12) + move
        axes.plot(*x.T, color=INK, linewidth=4, solid_capstyle="round")


def main() -> None:
    """Run, report, draw."""
    found = run()
    print(
        f"twist {np.degrees(found.twist):.6f} degrees (theory 150), force densities {found.ratio:.6f} "
        f"(theory {found.expected:.6f})"
    )
    print("frequencies [Hz]", np.round(found.frequencies, 3), "of rods on springs", np.round(found.rods, 3))
    print(f"audit of the fall: gaps {found.gaps[0]:.2e}, {found.gaps[1]:.2e}, order {found.order:.2f}")
    figure = new_figure(11, 4.6)
    form, drop, pull = figure.subplots(1, 3, width_ratios=(1.1, 1.2, 1.2))
    first = pl.simulate(found.start.model, duration=1e-3, step=1e-3)
    draw_prism(form, found.start, first, 0)
    draw_prism(form, found.start, found.statics, -1, 1.4)
    form.set_title("put down at 120°, and the form found: 150°", fontsize=10.5, loc="left")
    scale_bar(form, -0.4, -0.35, 0.5, "0.5 m")
    heights = found.fall.time
    low = int(np.argmin(found.fall.track(found.dropped.heads[0]).position[:, 2]))
    for place, i in enumerate((0, low, len(heights) - 1)):
        draw_prism(drop, found.dropped, found.fall, i, 1.4 * place)
        drop.annotate(f"{heights[i]:.2f} s", (1.4 * place, -1.35), ha="center", color=INK)
    drop.set_title("let go, caught, hanging on its lines", fontsize=10.5, loc="left")
    scale_bar(drop, -0.4, -1.55, 0.5, "0.5 m")
    for kind, color in (("vertical", RED), ("top", BLUE)):
        pull.plot(heights, found.fall.axial_force(found.dropped.cables[kind][0]).mean(axis=1), color=color)
    pull.plot(heights, found.fall.tendon(found.dropped.lines[0]).tension, color=AMBER)
    plain(pull, "time [s]", "tension [N]", "vertical (red), top (blue), catching line (amber)")
    path = save(figure, "tensegrity")
    page = OUT / "tensegrity.html"
    found.fall.export_html(page)
    print(f"look at {path} and {page}")


if __name__ == "__main__":
    main()
