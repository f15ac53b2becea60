"""A flat square cushion is filled with air.

Where does its film wrinkle, and how thick does it become? Two square films, 1.2 m from corner to corner,
are joined at their edges and filled. No film can become doubly curved without gathering: most of it
wrinkles, with tension along one direction and none across. The tension field knows that without a wrinkle
in the mesh. Filled by the mass of air, the cushion is soft until it is full, and then its pressure rises
steeply.

Checked: its height at 5 kPa, published by several authors for this airbag, and the same filling as a
motion in a fraction of a second, whose sum of energies must not change but by the work of the pump.

    python examples/inflated_cushion.py
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pliant as pl
from _style import AMBER, BLUE, GREEN, GREY, INK, RED, new_figure, plain, save
from matplotlib.figure import Figure
from mpl_toolkits.mplot3d.art3d import Poly3DCollection

FILM = pl.SaintVenantKirchhoff(
    youngs_modulus=5.88e8, poisson_ratio=0.4, density=1400.0, retardation_time=1e-3
)
THICKNESS, DIAGONAL, PRESSURE, PUBLISHED = 6e-4, 1.2, 5000.0, 0.2165
ATMOSPHERE = 101325.0
COLORS = np.array([BLUE, AMBER, GREY])
"""Of taut, wrinkled and slack faces."""


@dataclass(frozen=True)
class Filling:
    """The cushion filled slowly, to the published pressure and beyond, and at once."""

    slow: pl.Result
    gas: pl.Chamber
    height: float
    """Height of its middle above its rim at 5 kPa [m]."""
    quick: pl.Result
    quick_gas: pl.Chamber


def cushion(elements: int) -> tuple[pl.Model, pl.Membrane]:
    """Build an eighth of it, in three planes of symmetry."""
    side = DIAGONAL / np.sqrt(2) / 2
    model = pl.Model()
    mesh = pl.Mesh.rectangle(side, side, divisions=(elements, elements))
    film = model.add_membrane(mesh, thickness=THICKNESS, material=FILM, name="film")
    model.symmetry(film.edge("u_min"), (1, 0, 0))
    model.symmetry(film.edge("v_min"), (0, 1, 0))
    for edge in ("u_max", "v_max"):
        model.pin(film.edge(edge), directions=(0, 0, 1))
    return model, film


def run(elements: int = 12, steps: int = 12, duration: float = 0.1, step: float = 2e-4) -> Filling:
    """Fill it in steps of equilibrium, press it with 5 kPa, and fill it as a motion."""
    model, film = cushion(elements)
    model.add_pressure(film, PRESSURE)
    height = float(pl.solve_static(model).positions(film)[-1, 0, 2])
    air = pl.Gas()
    mass = air.density * 0.0168
    model, film = cushion(elements)
    chamber = model.add_chamber(film, air, inflow=mass, name="air")
    slow = pl.solve_static(model, load_steps=steps)
    gas = slow.chamber(chamber)
    # The motion begins from the cushion when it has just got some volume.
    model, film = cushion(elements)
    rate = (gas.mass[-1] - gas.mass[0]) / duration
    chamber = model.add_chamber(film, air, inflow=2 * rate * pl.Ramp(duration), name="air")
    quick = pl.simulate(model, duration=duration, step=step, start=slow.state(0), output_every=4)
    return Filling(slow, gas, height, quick, quick.chamber(chamber))


def mirrored(points: np.ndarray) -> list[np.ndarray]:
    """Give the whole cushion from its eighth."""
    signs = np.array([(x, y, z) for x in (1, -1) for y in (1, -1) for z in (1, -1)])
    return [points * sign for sign in signs]


def picture(filling: Filling) -> Figure:
    """Draw the full cushion by the regimes of its film, its pressure over its volume, and the energies."""
    figure = new_figure(12.5, 4.4)
    grid = figure.add_gridspec(1, 3, width_ratios=(1.5, 1, 1))
    space = figure.add_subplot(grid[0], projection="3d")
    slow, gas = filling.slow, filling.gas
    quads = slow.model._bodies["film"].quads
    regime = slow.strain("film").regime[-1]
    for points in mirrored(slow.positions("film")[-1]):
        space.add_collection3d(
            Poly3DCollection(points[quads], facecolors=COLORS[regime], edgecolor="white", linewidth=0.2)
        )
    reach = 0.48
    space.set(xlim=(-reach, reach), ylim=(-reach, reach), zlim=(-reach / 2, reach / 2))
    space.set_box_aspect((1, 1, 0.5), zoom=1.5)
    space.view_init(elev=32, azim=-60)
    space.set_axis_off()
    shares = np.bincount(regime, minlength=3) / len(regime)
    for k, (name, share) in enumerate(zip(("taut", "wrinkled", "slack"), shares, strict=True)):
        space.text2D(0.04 + 0.2 * k, 0.02, f"{name} {share:.0%}", color=COLORS[k], transform=space.transAxes)
    space.set_title("Full: regimes of the film", fontsize=10.5, loc="left")
    axes = figure.add_subplot(grid[1])
    axes.semilogy(8e3 * gas.volume, gas.pressure - ATMOSPHERE, "o-", color=BLUE, markersize=4)
    axes.axhline(PRESSURE, color=INK, linewidth=0.8, linestyle="--")
    plain(axes, "volume [l]", "gauge pressure [Pa]", "Soft until it is full")
    axes = figure.add_subplot(grid[2])
    energy = filling.quick.energy
    for values, color, name in (
        (energy.kinetic, BLUE, "kinetic"),
        (energy.elastic - energy.elastic[0], AMBER, "film and air"),
        (energy.dissipated, RED, "dissipated"),
        (energy.work, GREEN, "work of the pump"),
        (energy.total - energy.total[0], INK, "sum without it"),
    ):
        axes.plot(1e3 * filling.quick.time, 8 * values, color=color, linewidth=1.6, label=name)
    axes.legend(frameon=False, fontsize=9, loc="upper left")
    plain(axes, "t [ms]", "energy [J]", "Filled at once")
    return figure


def main() -> None:
    """Print the height and the balance, and leave a picture."""
    filling = run()
    print(f"height at 5 kPa: {filling.height:.4f} m, published {PUBLISHED:.4f} m")
    gas, energy = filling.gas, filling.quick.energy
    print(f"full: {8e3 * gas.volume[-1]:.1f} l at {(gas.pressure[-1] - ATMOSPHERE) / 1e3:.1f} kPa")
    drift = np.ptp(energy.total) / energy.work[-1]
    print(f"filled at once: the sum of the energies drifts by {drift:.1e} of the work of the pump")
    print(f"look at {save(picture(filling), 'inflated_cushion')}")


if __name__ == "__main__":
    main()
