"""A finger of rubber bends when it is blown up.

How far, and at which pressure? The finger is a tube with bellows on its back and a smooth belly. The
bellows unfold, the belly does not, so it curls. It is clamped at its root and closed by a light lid at
its tip, and air is let in: nothing is prescribed but its mass.

Checked: a smooth tube that is thicker on one side, whose curvature at small pressure has a closed form;
what the wall stores against the work of the gas; and the force on the root, which is that of the pressure
on its section.

    python examples/inflated_finger.py
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pliant as pl
from _style import BLUE, GREY, RED, new_figure, plain, save
from matplotlib.figure import Figure
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

Floats = NDArray[np.float64]

RADIUS, LENGTH, WALL, FOLDS, DEPTH = 0.010, 0.100, 1.2e-3, 6, 0.32
RUBBER = pl.NeoHookean(youngs_modulus=4e5, poisson_ratio=0.45, density=1100.0)
ATMOSPHERE = 101325.0
SKY = "#8fbfe8"


@dataclass(frozen=True)
class Finger:
    """Equilibria as air flows in."""

    result: pl.Result
    across: int
    """Faces around half of the tube."""
    pressure: Floats
    """Gauge pressure [Pa]."""
    angle: Floats
    """Angle by which the tip has turned [rad]."""
    work: float
    """Work of the gas on the wall [J]."""
    stored: float
    """Energy of the wall [J]."""
    root: float
    """Force on half of the root along the finger [N]."""
    smooth: float
    """Curvature over pressure of the smooth tube [1/(Pa m)]."""
    expected: float
    """The same in closed form."""


def half(
    wall: pl.Model,
    shape: pl.Mesh,
    thickness: Floats,
    material: pl.SaintVenantKirchhoff | pl.NeoHookean = RUBBER,
) -> pl.Shell:
    """Add half of a tube, clamped at its root, in the plane of symmetry y = 0."""
    shell = wall.add_shell(shape, thickness=thickness, material=material, name="finger")
    wall.symmetry(shell.edge("u_min"), (0, 1, 0))
    wall.symmetry(shell.edge("u_max"), (0, 1, 0))
    wall.clamp(shell.edge("v_min"), name="root")
    return shell


def bellows(u: float, v: float) -> tuple[float, float, float]:
    """Back (u = 0) with folds, belly (u = pi) smooth; both ends round."""
    ends = np.sin(np.pi * v / LENGTH) ** 0.25 if 0 < v < LENGTH else 0.0
    fold = DEPTH * 0.5 * (1 + np.cos(u)) * ends * np.sin(2 * np.pi * FOLDS * v / LENGTH)
    radius = RADIUS * (1 + fold)
    return v, -radius * np.sin(u), radius * np.cos(u)


def run(around: int = 5, pieces: int = 4, steps: int = 10, inflow: float = 2.2e-5) -> Finger:
    """Let air in."""
    model = pl.Model()
    along = pieces * FOLDS
    mesh = pl.Mesh.surface(bellows, (0.0, np.pi), (0.0, LENGTH), divisions=(around, along))
    # The belly and the tip are thicker.
    u, v = np.meshgrid((np.arange(around) + 0.5) / around, (np.arange(along) + 0.5) / along, indexing="ij")
    thickness = WALL * np.where((u > 0.75) | (v > 1 - 1 / along), 2.5, 1.0).ravel()
    shell = half(model, mesh, thickness)
    chamber = model.add_chamber(shell, inflow=inflow, name="air")
    result = pl.solve_static(model, load_steps=steps)
    gas = result.chamber(chamber)
    pressure = np.concatenate([[0.0], gas.pressure - ATMOSPHERE])
    places = result.positions(shell).reshape(len(gas.mass), around + 1, along + 1, 3)
    tip = places[:, 0, -1] - places[:, -1, -1]
    angle = np.concatenate([[0.0], np.arctan2(tip[:, 0], tip[:, 2])])
    start = pl.Stepper(model, step=1e-3).chamber(chamber).volume
    volume = np.concatenate([[start], gas.volume])
    work = float(np.sum((pressure[1:] + pressure[:-1]) / 2 * np.diff(volume)))
    energy = float(result.energy.elastic[-1]) - gas_energy(gas)
    root = float(result.reaction(model["root"]).force[-1, 0])
    smooth, expected = smooth_tube()
    return Finger(result, around, pressure, angle, work, energy, root, smooth, expected)


def gas_energy(gas: pl.Chamber) -> float:
    """Energy of half of the isothermal air against the atmosphere, at the end [J]."""
    p, v = gas.pressure[-1], gas.volume[-1]
    return float(p * v * (np.log(p / ATMOSPHERE) - 1) + ATMOSPHERE * v)


def smooth_tube(around: int = 8, along: int = 16, pressure: float = 40.0) -> tuple[float, float]:
    """Curvature over pressure of a tube that is thin in front and thick behind, found and in closed form.

    Membrane theory: the hoop carries p R, the axial force p pi R^2 acts in the middle, plane sections
    stay plane. With a_k the integral of h cos^k over the circle, kappa = p pi (1 - 2 nu) a_1/(E (a_1^2 -
    a_0 a_2)).
    """
    radius, length, thin, thick = RADIUS, 2 * LENGTH, 0.3e-3, 0.45e-3
    soft = pl.SaintVenantKirchhoff(youngs_modulus=4e5, poisson_ratio=0.3, density=1100.0)

    def tube(u: float, v: float) -> tuple[float, float, float]:
        return v, -radius * np.sin(u), radius * np.cos(u)

    model = pl.Model()
    mesh = pl.Mesh.surface(tube, (0.0, np.pi), (0.0, length), divisions=(around, along))
    u = np.repeat(np.arange(around) + 0.5, along) / around
    thickness = np.where(u < 0.5, thin, thick)
    shell = half(model, mesh, thickness, soft)
    model.add_chamber(shell, pl.Gas(pressure=ATMOSPHERE + pressure), name="air")
    result = pl.solve_static(model)
    gas = result.chamber(model["air"])
    places = result.positions(shell)[-1].reshape(around + 1, along + 1, 3)
    middle = slice(along // 4, 3 * along // 4 + 1)
    axis = (places[0, middle] + places[-1, middle]) / 2
    bend = np.polyfit(axis[:, 0], axis[:, 2], 2)[0] * 2
    # cos u = 1 in front: integrals over the whole circle.
    a_0, a_1, a_2 = np.pi * (thin + thick), 2 * (thin - thick), np.pi / 2 * (thin + thick)
    expected = np.pi * (1 - 0.6) * a_1 / (4e5 * (a_1**2 - a_0 * a_2))
    return float(-bend / (gas.pressure[-1] - ATMOSPHERE)), float(expected)


def smoothly(nodes: Floats, fine: int = 4) -> Floats:
    """Points between the nodes of a grid (i, j, 3), on cubic splines through them."""
    shape = nodes.shape[:2]
    to = [np.linspace(0, n - 1, fine * (n - 1) + 1) for n in shape]
    along = CubicSpline(np.arange(shape[0]), nodes, axis=0)(to[0])
    return np.asarray(CubicSpline(np.arange(shape[1]), along, axis=1)(to[1]))


def picture(finger: Finger) -> Figure:
    """Draw the finger at three pressures, and its angle over the pressure."""
    figure = new_figure(11.5, 4.6)
    grid = figure.add_gridspec(1, 2, width_ratios=(1.5, 1))
    space = figure.add_subplot(grid[0], projection="3d")
    result, n = finger.result, finger.across + 1
    start = pl.Stepper(result.model, step=1e-3).positions("finger")
    half_way = result.positions("finger")[np.searchsorted(finger.angle, finger.angle[-1] / 2)]
    for color, alpha, shape in (
        (GREY, 0.5, start),
        (SKY, 0.7, half_way),
        (BLUE, 1.0, result.positions("finger")[-1]),
    ):
        x = smoothly(1e3 * shape.reshape(n, -1, 3))
        for side in (1, -1):
            space.plot_surface(
                x[..., 0],
                side * x[..., 1],
                x[..., 2],
                color=color,
                alpha=alpha,
                rcount=200,
                ccount=200,
                linewidth=0,
            )
    space.set_aspect("equal")
    space.locator_params(nbins=4)
    space.set(xlabel="x [mm]", ylabel="y [mm]", zlabel="z [mm]")
    space.view_init(elev=16, azim=-62)
    space.set_title("Bellows on the back, a thick belly", fontsize=10.5, loc="left")
    axes = figure.add_subplot(grid[1])
    axes.plot(finger.pressure / 1e3, np.degrees(finger.angle), "o-", color=RED, markersize=4)
    plain(axes, "gauge pressure [kPa]", "angle of the tip [degrees]", "How far it bends")
    return figure


def main() -> None:
    """Print the checks, and leave a picture."""
    finger = run()
    print(f"tip turns by {np.degrees(finger.angle[-1]):.0f} degrees at {finger.pressure[-1] / 1e3:.1f} kPa")
    off = finger.smooth / finger.expected - 1
    print(f"smooth tube: curvature over pressure {finger.smooth:.3e}/(Pa m), {off:+.1%} from closed form")
    print(f"the wall stores {2e3 * finger.stored:.2f} mJ, the gas did {2e3 * finger.work:.2f} mJ of work")
    pull = -finger.root / (finger.pressure[-1] * np.pi * RADIUS**2 / 2)
    print(f"the root holds {pull:.4f} times the pressure on its section")
    print(f"look at {save(picture(finger), 'inflated_finger')}")


if __name__ == "__main__":
    main()
