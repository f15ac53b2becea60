"""A net strung like a spider's web catches a ball.

How far does it give way, what does the catch itself cost, and where does the energy go? Elastic cords,
twelve radial ones and a spiral, are strung in a ring of 4 m. A ball of 2 kg flies at 12.5 m/s to a knot off
the middle and sticks to it. Two models share the bodies: in one the ball flies by itself, in the other it
is pinned to the knot; the second run starts from the last state of the first. Its start contradicts the
pin, and the velocities are projected mass-orthogonally: a perfectly inelastic blow. A warning tells of it,
here awaited.

Checked: the blow keeps the momentum of ball and net, and costs the energy of Carnot's theorem, half the
impulse times the velocity lost between ball and knot; afterwards the energy audit closes with the order of
the time integration.

    python examples/spider_net.py
"""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import pliant as pl
from _style import AMBER, BLUE, GREEN, INK, OUT, RED, new_figure, plain, save, scale_bar, seen_from
from matplotlib.axes import Axes
from matplotlib.figure import Figure

GRAVITY = np.array([0.0, 0.0, -9.81])
RADIUS = 2.0
"""Radius of the ring that holds the net [m]."""
BALL = 2.0
"""Mass of the ball [kg]."""
FLIGHT = 0.1
"""Duration of the flight [s]."""
SETTLING = 1e-3
"""Time in which the damping of the cords takes up the jump of the blow [s]: in steps 80 times smaller."""
RADIAL_CORD = pl.LinearElastic(1e8, poisson_ratio=0.4, density=1100.0, retardation_time=4e-3)
SPIRAL_CORD = pl.LinearElastic(2e7, poisson_ratio=0.4, density=1100.0, retardation_time=8e-3)


@dataclass(frozen=True)
class Web:
    """Knots and cords of a web in the plane of x and z."""

    points: np.ndarray
    radials: np.ndarray
    spiral: np.ndarray
    ring: list[int]
    """Knots at the ring."""
    target: int
    """Knot that the ball flies to."""


@dataclass(frozen=True)
class Catch:
    """The runs and their numbers."""

    web: Web
    flight: pl.Result
    settling: pl.Result
    swing: pl.Result
    momentum_error: float
    """Change of the momentum of ball and net in the blow, relative."""
    loss: float
    """Kinetic energy that the blow costs [J]."""
    carnot: float
    """The same from impulse and velocities [J]."""
    depth: float
    """Largest displacement of the ball after the catch [m]."""
    depth_time: float
    """When [s]."""
    gaps: list[float]
    """Gap of the energy audit after the blow, relative to the kinetic energy, for a step and half of it."""

    @property
    def order(self) -> float:
        """Order with which the audit closes."""
        return float(np.log2(self.gaps[0] / self.gaps[1]))


def spin(spokes: int, turns: int) -> Web:
    """Lay out the knots: a hub, the spiral from knot to knot over the spokes, the ring."""
    angle = 2 * np.pi * np.arange(spokes) / spokes
    rays = np.stack([np.cos(angle), 0 * angle, np.sin(angle)], axis=1)
    along = np.arange(spokes * turns)
    inner, outer = 0.17 * RADIUS, 0.85 * RADIUS
    distance = inner + (outer - inner) * along / len(along)
    knots = distance[:, None] * rays[along % spokes]
    points = np.concatenate([np.zeros((1, 3)), knots, RADIUS * rays])
    ring = [1 + len(along) + k for k in range(spokes)]
    spokes_of = [[0, *range(1 + k, 1 + len(along), spokes), ring[k]] for k in range(spokes)]
    radials = [pair for chain in spokes_of for pair in pairwise(chain)]
    spiral = [(k, k + 1) for k in range(1, len(along))]
    return Web(points, np.array(radials), np.array(spiral), ring, 3 + spokes * (turns // 3))


def build(web: Web, elements: int, at: np.ndarray, velocity: np.ndarray) -> pl.Model:
    """Model of the net in its ring and of the free ball."""
    model = pl.Model(gravity=GRAVITY)
    radials = model.add_cable_net(
        web.points,
        web.radials,
        elements=elements,
        section=pl.Circle(4e-3),
        material=RADIAL_CORD,
        pretension=150.0,
        tension_only=True,
        name="radials",
    )
    first, last = web.spiral.min(), web.spiral.max()
    spiral = model.add_cable_net(
        web.points[first : last + 1],
        web.spiral - first,
        elements=elements,
        section=pl.Circle(3e-3),
        material=SPIRAL_CORD,
        pretension=15.0,
        tension_only=True,
        name="spiral",
    )
    for knot in range(first, last + 1):
        model.pin(spiral.node(knot - first), radials.node(knot))
    for knot in web.ring:
        model.pin(radials.node(knot))
    model.add_point_mass(BALL, at=at, velocity=velocity, name="ball")
    return model


def at_rest(web: Web, elements: int, at: np.ndarray) -> pl.Result:
    """Equilibrium of the net while the ball is held somewhere."""
    model = build(web, elements, at, np.zeros(3))
    model.pin(model["ball"])
    return pl.solve_static(model)


def knot(result: pl.Result, web: Web) -> pl.Point:
    """Material point that the ball flies to."""
    return result.model["radials"].node(web.target)


def run(
    spokes: int = 12,
    turns: int = 7,
    elements: int = 1,
    velocity: tuple[float, float, float] = (2.0, 12.0, 3.0),
    duration: float = 0.4,
    step: float = 4e-4,
) -> Catch:
    """Throw the ball, catch it, let the net swing; the last twice, with ``step`` and with half of it."""
    web, arrival = spin(spokes, turns), np.array(velocity)
    anywhere = np.array([0.0, -1.0, 0.0])
    rest = at_rest(web, elements, anywhere)
    aim = rest.track(knot(rest, web)).position[-1]

    # Backwards along the parabola of the throw.
    thrown_at, thrown = aim - arrival * FLIGHT + GRAVITY * FLIGHT**2 / 2, arrival - GRAVITY * FLIGHT
    free = build(web, elements, thrown_at, thrown)
    flight = pl.simulate(free, duration=FLIGHT, step=1e-3, start=at_rest(web, elements, thrown_at))

    caught = build(web, elements, web.points[web.target], thrown)
    caught.pin(caught["ball"], caught["radials"].node(web.target), name="catch")
    runs, gaps = [], []
    for h in (step, step / 2):
        with warnings.catch_warnings():
            warnings.filterwarnings("ignore", message=".*were projected")
            settling = pl.simulate(caught, duration=SETTLING, step=h / 80, start=flight)
        swing = pl.simulate(caught, duration=duration - SETTLING, step=h, start=settling)
        runs.append((settling, swing))
        gap = sum(np.abs(part.energy.total - part.energy.total[0]).max() for part in (settling, swing))
        gaps.append(float(gap / flight.energy.kinetic[-1]))
    settling, swing = runs[-1]

    momentum = settling.momentum[0] - flight.momentum[-1]
    before, after = flight.velocities("ball")[-1, 0], settling.velocities("ball")[0, 0]
    impulse, struck = BALL * (before - after), flight.track(knot(flight, web)).velocity[-1]
    moved = np.linalg.norm(swing.positions("ball")[:, 0] - aim, axis=1)
    deepest = first_peak(moved)
    return Catch(
        web,
        flight,
        settling,
        swing,
        momentum_error=float(np.linalg.norm(momentum) / np.linalg.norm(flight.momentum[-1])),
        loss=float(flight.energy.kinetic[-1] - settling.energy.kinetic[0]),
        carnot=float(impulse @ (before - struck) / 2),
        depth=float(moved[deepest]),
        depth_time=float(SETTLING + swing.time[deepest]),
        gaps=gaps,
    )


def first_peak(values: np.ndarray) -> int:
    """Index of the first value that the next does not exceed."""
    return int(np.argmax(np.diff(values, append=-np.inf) <= 0))


def picture(caught: Catch) -> Figure:
    """Draw the net at four instants, the way of the ball and the energies."""
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import LogNorm

    flight, swing, settling = caught.flight, caught.swing, caught.settling
    back = first_peak(-swing.positions("ball")[:, 0, 1][np.searchsorted(swing.time, caught.depth_time) :])
    deepest = int(np.searchsorted(swing.time, caught.depth_time - SETTLING))
    instants = [
        ("flying", flight, len(flight.time) // 2, -FLIGHT / 2),
        ("caught", settling, 0, 0.0),
        ("deepest", swing, deepest, caught.depth_time),
        ("back", swing, deepest + back, SETTLING + swing.time[deepest + back]),
    ]
    figure = new_figure(11, 6.4)
    rows = figure.subfigures(2, 1, height_ratios=(1.15, 1))
    webs = rows[0].subplots(1, len(instants), sharex=True, sharey=True)
    forces = np.concatenate([swing.axial_force(net) for net in ("radials", "spiral")], axis=1)
    norm = LogNorm(forces.min(), forces.max())
    for axes, (name, result, k, time) in zip(webs, instants, strict=True):
        draw_net(axes, caught.web, result, k, norm)
        axes.set_title(f"{name}, t = {1e3 * time:.0f} ms", fontsize=10.5)
        axes.set(xlim=(-1.75, 1.55), ylim=(-2.15, 2.15))
    bar = rows[0].colorbar(ScalarMappable(norm, "viridis"), ax=webs, shrink=0.75, pad=0.01)
    bar.set_label("axial force [N]")

    way, energies = rows[1].subplots(1, 2)
    start = settling.positions("ball")[0, 0]
    times = [flight.time - FLIGHT, settling.time, SETTLING + swing.time]
    ways = [part.positions("ball")[:, 0] - start for part in (flight, settling, swing)]
    for k, (color, name) in enumerate(((BLUE, "sideways, x"), (RED, "through the net, y"), (GREEN, "up, z"))):
        joined = np.concatenate([part[:, k] for part in ways])
        way.plot(np.concatenate(times), joined, color=color, label=name)
    way.axvline(0, color=INK, linewidth=0.8, linestyle=":")
    way.plot(caught.depth_time, ways[2][deepest, 1], "o", color=RED, markersize=5)
    way.annotate(
        f"{caught.depth:.3f} m after {1e3 * caught.depth_time:.0f} ms",
        (caught.depth_time, ways[2][deepest, 1]),
        xytext=(6, 4),
        textcoords="offset points",
        color=RED,
    )
    way.set_ylim(-1.3, 0.85)
    way.legend(frameon=False, fontsize=8.5, loc="lower right")
    plain(way, "time since the catch [s]", "ball from the catch [m]", "The way of the ball")

    late = [settling, swing]
    time = np.concatenate(times[1:])
    kinetic = np.concatenate([part.energy.kinetic for part in late])
    elastic = np.concatenate([part.energy.elastic for part in late]) - settling.energy.elastic[0]
    before = np.concatenate(
        [np.zeros(len(settling.time)), np.full(len(swing.time), settling.energy.dissipated[-1])]
    )
    dissipated = np.concatenate([part.energy.dissipated for part in late]) + before
    names = ("kinetic", "elastic, beyond the prestress", "dissipated in the cords")
    energies.stackplot(
        time, kinetic, elastic, dissipated, colors=(BLUE, GREEN, AMBER), labels=names, alpha=0.85
    )
    energies.axhline(kinetic[0], color=INK, linewidth=0.9, linestyle=":", label="after the blow")
    energies.set(xlim=(0, time[-1]), ylim=(0, 1.4 * kinetic[0]))
    energies.legend(frameon=False, fontsize=8.5, ncols=2, loc="upper left")
    title = f"Energy: audit closes to {caught.gaps[-1]:.0e}; the blow cost {caught.loss:.3f} J"
    plain(energies, "time since the catch [s]", "energy [J]", title)
    return figure


def draw_net(axes: Axes, web: Web, result: pl.Result, k: int, norm: object) -> None:
    """Draw cords coloured by axial force, and the ball."""
    from matplotlib.collections import LineCollection

    sight = {"azimuth": -28.0, "elevation": 14.0}
    nets = (("spiral", web.spiral - web.spiral.min(), 1.1), ("radials", web.radials, 1.7))
    for name, edges, width in nets:
        ends = seen_from(result.positions(name)[k][edges], **sight)
        lines = LineCollection(ends, cmap="viridis", norm=norm, linewidths=width, capstyle="round")
        lines.set_array(result.axial_force(name)[k])
        axes.add_collection(lines)
    turn = np.linspace(0, 2 * np.pi, 120)
    hoop = RADIUS * np.stack([np.cos(turn), 0 * turn, np.sin(turn)], axis=1)
    axes.plot(*seen_from(hoop, **sight).T, color=INK, linewidth=2.2, zorder=0)
    axes.plot(*seen_from(result.positions("ball")[k, 0], **sight), "o", color=RED, markersize=8)
    scale_bar(axes, -1.7, -1.8, 1.0, "1 m")


def main() -> None:
    """Print the numbers, leave a picture and an interactive page."""
    caught = run()
    speed = [
        np.linalg.norm(part.velocities("ball")[k, 0])
        for part, k in ((caught.flight, -1), (caught.settling, 0))
    ]
    print(f"the ball arrives with {speed[0]:.3f} m/s and goes on with {speed[1]:.3f} m/s;", end=" ")
    print(f"momentum of ball and net kept to {caught.momentum_error:.0e}")
    print(f"the blow costs {caught.loss:.6f} J; by Carnot's theorem {caught.carnot:.6f} J")
    print(f"deepest after {1e3 * caught.depth_time:.1f} ms: {caught.depth:.4f} m;", end=" ")
    print(f"cords carry up to {caught.swing.axial_force('radials').max():.0f} N")
    coarse, fine = caught.gaps
    print(f"energy audit after the blow closes to {coarse:.1e}, with half the step to {fine:.1e}", end=" ")
    print(f"(order {caught.order:.2f})")
    path = save(picture(caught), "spider_net")
    caught.swing.export_html(OUT / "spider_net.html", color="axial_force")
    print(f"look at {path} and {path.with_suffix('.html')}")


if __name__ == "__main__":
    main()
