"""A footbridge hangs from two cables; a vehicle crosses it.

How does it carry its weight, at which frequencies does it vibrate, and what does the vehicle set going? Two
main cables of 100 m span lie in inclined planes; hangers run from them, A-shaped, to one deck girder. The
stress-free lengths follow from a string polygon with the weights at its corners; statics finds the
equilibrium, modes are taken about it, and from it starts the motion while 20 kN travel over the deck at 36
km/h.

Checked: the supports carry the weight to rounding; one main cable by itself hangs as the elastic catenary
says; the lowest vertical mode is the one that goes on ringing when the vehicle has left.

    python examples/catenary_bridge.py
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pliant as pl
from _style import AMBER, BLUE, GREEN, GREY, INK, OUT, RED, new_figure, plain, save, scale_bar, seen_from
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from scipy.optimize import brentq

GRAVITY = 9.81
SPAN, SAG, LOWEST = 100.0, 10.0, 2.0
"""Distance of the towers, sag of the main cables, their height over the deck at mid-span [m]."""
HALF_WIDTH = 4.0
"""Distance of a tower's top from the bridge's axis [m]."""
DECK_MASS = 300.0
"""Mass of the deck per length [kg/m]."""
VEHICLE, SPEED = 20e3, 10.0
"""Weight of the vehicle [N] and its speed [m/s]."""

STEEL = pl.LinearElastic(youngs_modulus=1.6e11, poisson_ratio=0.3, density=7850.0)
DECK_AREA, DECK_SECOND_MOMENT = 0.02, 4e-4
DECK = pl.LinearElastic(youngs_modulus=2.1e11, poisson_ratio=0.3, density=DECK_MASS / DECK_AREA)


def strand(radius: float, wires: int = 127) -> pl.Section:
    """Section of a strand whose wires bend one by one."""
    area = np.pi * radius**2
    bending = area**2 / (4 * np.pi * wires)
    return pl.Section(area, second_moments=(bending, bending), torsion_constant=2 * bending, radius=radius)


MAIN, HANGER = strand(0.03), strand(0.01)


@dataclass(frozen=True)
class Bridge:
    """The model and its handles."""

    model: pl.Model
    main: pl.CableNet
    hangers: pl.CableNet
    deck: pl.Cable
    supports: list[pl.Joint]
    weight: float
    """Weight of everything, from the lengths of its parts [N]."""
    free_length: float
    """Stress-free length of one main cable [m]."""
    panels: int
    """Panels of the deck, two elements each."""
    edges: np.ndarray
    """Points that the pieces of the main cables join, (m, 2)."""
    hanger_edges: np.ndarray
    """The same of the hangers, in their own net, (k, 2)."""


@dataclass(frozen=True)
class Crossing:
    """What was computed, and its numbers."""

    bridge: Bridge
    rest: pl.Result
    modes: pl.Modes
    ride: pl.Result
    imbalance: float
    """Sum of the reactions against the weight, relative."""
    sag: float
    """Sag of one main cable that hangs by itself [m]."""
    catenary_sag: float
    """The same by the elastic catenary [m]."""
    mode: int
    """Number of the lowest vertical mode, from 0."""
    frequency: float
    """Its frequency [Hz]."""
    ringing: float
    """Frequency with which the deck rings when the vehicle has left [Hz]."""


def catenary(length: float, span: float, weight: float, axial_stiffness: float) -> tuple[float, float]:
    """Horizontal force [N] and sag [m] of an elastic catenary of this stress-free length, its ends level."""

    def surplus(force: float) -> float:
        stretch = force * length / axial_stiffness
        return 2 * force / weight * np.arcsinh(weight * length / (2 * force)) + stretch - span

    force = float(brentq(surplus, 1e-3 * weight * span, 1e3 * weight * span, xtol=1e-9, rtol=1e-14))
    end = weight * length / (2 * force)
    sag = force / weight * (np.sqrt(1 + end**2) - 1) + weight * length**2 / (8 * axial_stiffness)
    return force, float(sag)


def free_cable_sag(length: float, elements: int) -> float:
    """Sag of a main cable of this stress-free length that hangs by itself [m]."""
    depth = np.sqrt(length**2 - SPAN**2) / 2
    model = pl.Model(gravity=(0, 0, -GRAVITY))
    corners = [(-SPAN / 2, 0, 0), (0, 0, -depth), (SPAN / 2, 0, 0)]
    cable = model.add_cable(corners, elements=elements, section=MAIN, material=STEEL, strain="biot")
    model.pin(cable.start)
    model.pin(cable.end)
    hanging = pl.solve_static(model)
    return -float(hanging.track(cable.at(cable.length / 2)).position[-1, 2])


def build(panels: int = 20) -> Bridge:
    """Put the bridge together, its main cables a string polygon under the weights at their corners."""
    x = np.linspace(-SPAN / 2, SPAN / 2, panels + 1)
    height = LOWEST + SAG * (2 * x / SPAN) ** 2
    side = height * HALF_WIDTH / (LOWEST + SAG)
    width, inner, row = SPAN / panels, np.arange(1, panels), panels + 1

    # Main cables: pieces between panel points; the horizontal force is that of the parabola.
    points = np.concatenate([np.stack([x, s * side, height], axis=1) for s in (1, -1)])
    edges = np.array([(s * row + i, s * row + i + 1) for s in (0, 1) for i in range(panels)])
    lengths = np.linalg.norm(points[edges[:, 1]] - points[edges[:, 0]], axis=1)
    main_weight = STEEL.density * MAIN.area * GRAVITY * lengths.sum()
    corner_weight = (DECK_MASS * GRAVITY * SPAN + main_weight) / panels / 2
    horizontal = corner_weight * SPAN**2 / (8 * SAG * width)
    tension = horizontal * lengths / width

    # Hangers: from the inner points of both main cables to the deck's.
    tops = np.concatenate([inner, row + inner])
    feet = np.stack([x[inner], 0 * x[inner], 0 * x[inner]], axis=1)
    knots = np.concatenate([points[tops], feet])
    hanger_edges = np.stack([np.arange(len(tops)), len(tops) + np.tile(np.arange(len(inner)), 2)], axis=1)
    hanger_lengths = np.linalg.norm(knots[hanger_edges[:, 1]] - knots[hanger_edges[:, 0]], axis=1)
    pull = DECK_MASS * GRAVITY * width / 2 * hanger_lengths / points[tops, 2]

    model = pl.Model(gravity=(0, 0, -GRAVITY))
    main = model.add_cable_net(
        points,
        edges,
        elements=2,
        section=MAIN,
        material=STEEL,
        pretension=tension,
        strain="biot",
        name="main cables",
    )
    hangers = model.add_cable_net(
        knots, hanger_edges, elements=1, section=HANGER, material=STEEL, pretension=pull, name="hangers"
    )
    deck = model.add_cable(
        [(-SPAN / 2, 0, 0), (SPAN / 2, 0, 0)],
        elements=2 * panels,
        section=pl.Section(
            DECK_AREA, second_moments=(DECK_SECOND_MOMENT, DECK_SECOND_MOMENT), torsion_constant=8e-4
        ),
        material=DECK,
        name="deck",
    )
    ends = [main.node(i) for i in (0, panels, row, row + panels)] + [deck.start, deck.end]
    supports = [model.pin(end) for end in ends]
    for k, top in enumerate(tops):
        model.pin(hangers.node(k), main.node(int(top)))
    for k in range(len(inner)):
        model.pin(hangers.node(len(tops) + k), deck.node(2 * (k + 1)))

    hanger_weight = STEEL.density * HANGER.area * GRAVITY * hanger_lengths.sum()
    weight = main_weight + hanger_weight + DECK_MASS * GRAVITY * SPAN
    stiffness = STEEL.youngs_modulus * MAIN.area
    free_length = float((lengths / (1 + tension / stiffness))[:panels].sum())
    return Bridge(
        model, main, hangers, deck, supports, float(weight), free_length, panels, edges, hanger_edges
    )


def drive_over(bridge: Bridge) -> pl.Model:
    """Copy of the model with the vehicle's weight handed from node to node of the deck."""
    model = bridge.model.copy()
    nodes = 2 * bridge.panels + 1
    place = np.linspace(0, SPAN, nodes)
    width = place[1]
    for k in range(1, nodes - 1):
        times = (place[k] + np.array([-width, 0.0, width])) / SPEED
        model.add_force(bridge.deck.node(k), pl.Table(times, [(0, 0, 0), (0, 0, -VEHICLE), (0, 0, 0)]))
    return model


def ringing(time: np.ndarray, signal: np.ndarray) -> float:
    """Mean frequency [Hz] between the first and the last upward passage through zero."""
    k = np.flatnonzero((signal[:-1] < 0) & (signal[1:] >= 0))
    passages = time[k] + (time[k + 1] - time[k]) * signal[k] / (signal[k] - signal[k + 1])
    return float((len(passages) - 1) / (passages[-1] - passages[0]))


def vertical(modes: pl.Modes, bridge: Bridge) -> np.ndarray:
    """Tell for each mode whether its deck moves up and down rather than sideways, (count,)."""
    largest = np.abs(modes.positions(bridge.deck)).max(axis=1)
    return largest[:, 2] > 10 * largest[:, 1]


def run(panels: int = 20, duration: float = 50.0, step: float = 0.02, count: int = 8) -> Crossing:
    """Find the bridge at rest, its modes about that, and the motion while and after the vehicle crosses."""
    bridge = build(panels)
    rest = pl.solve_static(bridge.model)
    carried = sum(rest.reaction(support).force[-1] for support in bridge.supports)
    imbalance = float(np.linalg.norm(carried - [0, 0, bridge.weight])) / bridge.weight

    line_weight = STEEL.density * MAIN.area * GRAVITY
    _, catenary_sag = catenary(bridge.free_length, SPAN, line_weight, STEEL.youngs_modulus * MAIN.area)
    sag = free_cable_sag(bridge.free_length, elements=2 * panels)

    modes = pl.solve_modes(bridge.model, count=count, about=rest)
    mode = int(np.argmax(vertical(modes, bridge)))

    ride = pl.simulate(drive_over(bridge), duration=duration, step=step, start=rest)
    quarters = [ride.track(bridge.deck.at(share * SPAN)).position[:, 2] for share in (0.25, 0.75)]
    left = ride.time > SPAN / SPEED + 2.0
    heard = ringing(ride.time[left], (quarters[0] - quarters[1])[left])
    frequency = float(modes.frequencies[mode])
    return Crossing(bridge, rest, modes, ride, imbalance, sag, catenary_sag, mode, frequency, heard)


def picture(crossing: Crossing) -> Figure:
    """Draw the bridge with its forces, the deck while and after the vehicle crosses, modes and spectrum."""
    figure = new_figure(12, 7.0)
    rows = figure.subfigures(2, 1, height_ratios=(1, 1.1))
    draw_bridge(rows[0].subplots(), crossing)
    sinking, shapes, spectrum = rows[1].subplots(1, 3, width_ratios=(1.3, 1, 1))

    bridge, ride, modes = crossing.bridge, crossing.ride, crossing.modes
    rest = crossing.rest.positions(bridge.deck)[-1]
    along = rest[:, 0] + SPAN / 2
    moved = 1e3 * (ride.positions(bridge.deck)[:, :, 2] - rest[:, 2])
    quarter = [int(np.searchsorted(along, share * SPAN - 1e-6)) for share in (0.25, 0.75)]
    for k, color, name in zip(quarter, (BLUE, RED), ("1/4", "3/4"), strict=True):
        sinking.plot(ride.time, moved[:, k], color=color, linewidth=1.2, label=f"{name} of the span")
    sinking.axvspan(0, SPAN / SPEED, color=GREY, alpha=0.2, linewidth=0)
    sinking.annotate("vehicle on the deck", (0.4, 148), fontsize=8.5, color=INK)
    sinking.set_xlim(0, min(ride.time[-1], 30))
    sinking.set_ylim(-175, 170)
    sinking.legend(frameon=False, fontsize=8.5, loc="lower right")
    plain(sinking, "time [s]", "deck moves up [mm]", "A vehicle crosses; the deck goes on ringing")

    upright = vertical(modes, bridge)
    chosen = [np.flatnonzero(upright)[0], np.flatnonzero(upright)[1], np.flatnonzero(~upright)[0]]
    for k, color, dashes in zip(chosen, (BLUE, GREEN, AMBER), ("-", "-", "--"), strict=True):
        shape = modes.positions(bridge.deck)[k][:, 2 if upright[k] else 1]
        shape = shape / shape[np.argmax(np.abs(shape))]
        kind = "vertical" if upright[k] else "sideways"
        shapes.plot(along, shape, dashes, color=color, label=f"{modes.frequencies[k]:.3f} Hz, {kind}")
    shapes.set_ylim(-1.15, 2.2)
    shapes.legend(frameon=False, fontsize=8.5, loc="upper left")
    plain(shapes, "along the deck [m]", "deck, largest = 1", "Modes of the loaded bridge")

    free = ride.time > SPAN / SPEED + 2.0
    signal = moved[free, quarter[0]] - moved[free, quarter[0]].mean()
    padded = 8 * len(signal)
    heights = np.abs(np.fft.rfft(signal * np.hanning(len(signal)), padded)) / len(signal) * 4
    pitch = np.fft.rfftfreq(padded, ride.time[1] - ride.time[0])
    shown = pitch < 1.25
    spectrum.plot(pitch[shown], heights[shown], color=BLUE)
    for frequency in modes.frequencies[upright]:
        spectrum.axvline(frequency, color=RED, linewidth=0.9, linestyle=":")
    spectrum.annotate("vertical\nmodes", (0.42, 0.86), xycoords="axes fraction", color=RED)
    spectrum.set_ylim(0, 1.15 * heights[shown].max())
    spectrum.set_xlim(0, 1.25)
    title = f"It rings with {crossing.ringing:.4f} Hz (mode: {crossing.frequency:.4f})"
    plain(spectrum, "frequency [Hz]", "deck at 1/4 [mm]", title)
    return figure


def draw_bridge(axes: Axes, crossing: Crossing) -> None:
    """Draw the bridge at rest, coloured by axial force."""
    from matplotlib.cm import ScalarMappable
    from matplotlib.collections import LineCollection
    from matplotlib.colors import LogNorm

    sight = {"azimuth": -82.0, "elevation": 16.0}
    bridge, rest = crossing.bridge, crossing.rest
    ground, top = -5.0, LOWEST + SAG
    for x in (-SPAN / 2, SPAN / 2):
        gate = [
            (x, -HALF_WIDTH, ground),
            (x, -HALF_WIDTH, top),
            (x, HALF_WIDTH, top),
            (x, HALF_WIDTH, ground),
        ]
        axes.plot(*seen_from(np.array(gate), **sight).T, color=GREY, linewidth=4, zorder=1)
    axes.plot(*seen_from(rest.positions(bridge.deck)[-1], **sight).T, color=INK, linewidth=5, zorder=2)
    nets = ((bridge.main, bridge.edges, 3.2), (bridge.hangers, bridge.hanger_edges, 1.3))
    forces = [rest.axial_force(net)[-1] / 1e3 for net, _, _ in nets]
    norm = LogNorm(min(map(np.min, forces)), max(map(np.max, forces)))
    for (net, edges, width), force in zip(nets, forces, strict=True):
        ends = seen_from(rest.positions(net)[-1][edges], **sight)
        lines = LineCollection(ends, linewidths=width, cmap="viridis", norm=norm, capstyle="round", zorder=3)
        lines.set_array(force)
        axes.add_collection(lines)
    scale_bar(axes, -32.0, -8.5, 10.0, "10 m")
    axes.set_xlim(-53, 53)
    axes.set_ylim(-13, 21)
    axes.set_title("A footbridge at rest: two main cables in inclined planes, hangers, a deck", fontsize=10.5)
    bar = axes.figure.colorbar(ScalarMappable(norm, "viridis"), ax=axes, shrink=0.7, pad=0.01)
    bar.set_label("axial force [kN]")


def main() -> None:
    """Print the numbers, leave a picture and an interactive page."""
    crossing = run()
    bridge, rest = crossing.bridge, crossing.rest
    print(f"weight {bridge.weight / 1e3:.3f} kN, carried but for {crossing.imbalance:.0e} of it")
    print(f"main cables: up to {rest.axial_force(bridge.main)[-1].max() / 1e3:.1f} kN;", end=" ")
    print(f"deck level to {1e3 * np.abs(rest.positions(bridge.deck)[-1][:, 2]).max():.1f} mm")
    print(f"a main cable by itself: sag {crossing.sag:.4f} m, elastic catenary {crossing.catenary_sag:.4f} m")
    upright = vertical(crossing.modes, bridge)
    for frequency, up in zip(crossing.modes.frequencies, upright, strict=True):
        print(f"  {frequency:.4f} Hz {'vertical' if up else 'sideways'}")
    down = crossing.ride.positions(bridge.deck)[:, :, 2].min() - rest.positions(bridge.deck)[-1][:, 2].min()
    print(f"the vehicle presses the deck down by up to {-1e3 * down:.0f} mm and leaves it ringing", end=" ")
    print(f"with {crossing.ringing:.4f} Hz: mode {crossing.mode + 1} ({crossing.frequency:.4f} Hz)")
    path = save(picture(crossing), "catenary_bridge")
    crossing.ride.export_html(OUT / "catenary_bridge.html", color="axial_force")
    print(f"look at {path} and {path.with_suffix('.html')}")


if __name__ == "__main__":
    main()
