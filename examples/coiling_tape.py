"""A flat tape coils up by itself: two layers, one of which shrinks.

How tightly does it coil? The tape wants the curvature c along and across, but a sheet cannot have both
without being stretched. A narrow tape takes c both ways, free edges let it. A wide one gives up the
curvature across, and bends as if its sections were held, plane strain: by (1 + nu) c, for what is not given
across comes along. Between the two, only a strip along each edge of the width sqrt(R h) curls up. A section
w(y) of a long tape minimises

    U = int E h (K w)^2/2 + D/2 ((K - c)^2 + (w'' - c)^2 + 2 nu (K - c)(w'' - c)) dy,

so that D w'''' + E h K^2 w = 0 with w'' - c + nu (K - c) = 0 and w''' = 0 at its edges (Lamb 1891), a sum of
products of hyperbolic and trigonometric functions; and K, the curvature along, minimises U as well.

Checked: tapes of several widths at rest against that closed form; a whole tape that coils up from flat, free
in space, ends with that curvature, keeps its momenta at zero, and its energy audit closes.

    python examples/coiling_tape.py
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import _audit
import numpy as np
import pliant as pl
from _style import BLUE, GREY, INK, RED, new_figure, plain, save
from matplotlib.figure import Figure
from numpy.typing import NDArray
from scipy.optimize import brentq

Floats = NDArray[np.float64]

LENGTH, WIDTH, THICKNESS = 0.3, 0.03, 0.4e-3
TURNS = 0.7
"""Of the whole tape, if it took the curvature that its layers want."""
CURVATURE = 2 * np.pi * TURNS / LENGTH
NU = 0.4
POLYMER = pl.SaintVenantKirchhoff(youngs_modulus=1e9, poisson_ratio=NU, density=1200.0, retardation_time=2e-2)
SHRINKING = 0.1
"""Time in which the layer shrinks along, and then across [s]."""


@dataclass(frozen=True)
class Coiling:
    """Tapes at rest, and one that moves."""

    widths: Floats
    """Widths of the tapes at rest [sqrt(h/c)]."""
    found: Floats
    """Their curvatures along [c]."""
    expected: Floats
    """The same by the closed form."""
    result: pl.Result
    across: int
    """Faces across the tape that moves."""
    curvature: Floats
    """Curvature in the middle of its length over time [c]."""
    drifts: tuple[float, float]
    """Largest changes of the sum of energies over the work, with a step and half of it."""

    @property
    def final(self) -> float:
        """Closed form of the curvature of the tape that moves [c]."""
        return lamb(WIDTH * np.sqrt(CURVATURE / THICKNESS))

    @property
    def momentum(self) -> float:
        """Largest linear momentum over the mass and the largest speed of a node."""
        result = self.result
        speed = np.linalg.norm(result.velocities("tape"), axis=2).max()
        mass = POLYMER.density * LENGTH * WIDTH * THICKNESS
        return float(np.abs(result.momentum).max() / (mass * speed))


def lamb(width: float) -> float:
    """Curvature along [c] of a long tape, its width in sqrt(h/c)."""
    # Lengths in sqrt(h/c), curvatures in c: 4 g^4 = E h K^2/D.
    b = width / 2

    def unbalanced(k: float) -> float:
        g = (3 * (1 - NU**2)) ** 0.25 * np.sqrt(k)
        x = g * b
        c, s, ch, sh = np.cos(x), np.sin(x), np.cosh(x), np.sinh(x)
        # w = p cosh gy cos gy + q sinh gy sin gy; second and third derivatives at the edge.
        second = 2 * g**2 * np.array([-sh * s, ch * c])
        third = 2 * g**3 * np.array([-(ch * s + sh * c), sh * c - ch * s])
        p, q = np.linalg.solve([second, third], [1 + NU - NU * k, 0.0])
        y = np.linspace(0, b, 2001)
        u = g * y
        w = p * np.cosh(u) * np.cos(u) + q * np.sinh(u) * np.sin(u)
        bent = 2 * g**2 * (q * np.cosh(u) * np.cos(u) - p * np.sinh(u) * np.sin(u))
        # dU/dK at the same w.
        return float(np.trapezoid(12 * (1 - NU**2) * k * w**2 + (k - 1) + NU * (bent - 1), y))

    return float(brentq(unbalanced, 0.5, 1.5 + NU, xtol=1e-12))


def middle_curvature(bending: Floats, along: int, across: int) -> Floats:
    """Mean over the width of the curvature along [c], in the faces in the middle of the length."""
    faces = bending[..., 0].reshape(-1, along, across)
    half = along // 2
    return np.asarray(-faces[:, half - 1 : half + 1].mean(axis=(1, 2)) / CURVATURE)


def resting(width: float, along: int, across: int) -> float:
    """Curvature along [c] in the middle of a tape at rest, its width in sqrt(h/c); a quarter of it."""
    half = width * np.sqrt(THICKNESS / CURVATURE) / 2
    model = pl.Model()
    mesh = pl.Mesh.rectangle(4 * half, half, divisions=(along, across))
    tape = model.add_shell(mesh, thickness=THICKNESS, material=POLYMER)
    model.symmetry(tape.edge("u_min"), (1, 0, 0))
    model.symmetry(tape.edge("v_min"), (0, 1, 0))
    model.pin(tape.node(0), directions=(0, 0, 1))
    # Rolled up along first, so that it does not roll up across.
    model.add_curvature(tape, lambda t: (CURVATURE * min(2 * t, 1.0), CURVATURE * max(2 * t - 1, 0.0), 0.0))
    bending = pl.solve_static(model, load_steps=8).strain(tape).bending[-1]
    faces = bending[:, 0].reshape(along, across)
    return float(-faces[0].mean() / CURVATURE)


def wanted(t: float) -> tuple[float, float, float]:
    """Curvature that the layers want at a time: first along, then across.

    Both at once, the flat tape would roll up about its long axis, and stay so.
    """
    along, across = (3 * x**2 - 2 * x**3 for x in np.clip([t / SHRINKING, t / SHRINKING - 1], 0, 1))
    return CURVATURE * along, CURVATURE * across, 0.0


def coil(along: int, across: int, duration: float, step: float) -> pl.Result:
    """Let a flat tape coil up."""
    model = pl.Model()
    places = pl.Mesh.rectangle(LENGTH, WIDTH, divisions=(along, across))
    tape = model.add_shell(places, thickness=THICKNESS, material=POLYMER, name="tape")
    model.add_curvature(tape, wanted)
    return pl.simulate(model, duration=duration, step=step)


def run(
    widths: Sequence[float] = (0.5, 1, 1.5, 2, 3, 4, 6, 8, 12),
    along: int = 36,
    across: int = 6,
    duration: float = 1.0,
    step: float = 2e-3,
) -> Coiling:
    """Find the curvatures at rest, and let a whole tape coil up."""
    found = np.array([resting(width, 12, across) for width in widths])
    expected = np.array([lamb(width) for width in widths])
    drifts = []
    for divided in (1, 2):
        result = coil(along, across, duration, step / divided)
        energy = result.energy
        drifts.append(float(np.abs(energy.total - energy.total[0]).max() / np.abs(energy.work).max()))
    bending = result.strain("tape").bending
    curvature = middle_curvature(bending, along, across)
    return Coiling(np.array(widths), found, expected, result, across, curvature, (drifts[0], drifts[1]))


def picture(coiling: Coiling) -> Figure:
    """Draw the tape as it coils up, curvatures over the width, and the energies."""
    from matplotlib import colormaps

    figure = new_figure(12.5, 4.9)
    grid = figure.add_gridspec(1, 3, width_ratios=(1.35, 1, 1))
    space = figure.add_subplot(grid[0], projection="3d")
    result = coiling.result
    places = result.positions("tape") * 1e3
    turned = coiling.curvature
    for share in (0.0, 0.25, 0.55, 1.0):
        k = int(np.argmax(turned >= share * turned[-1])) if share < 1 else -1
        x = places[k].reshape(-1, coiling.across + 1, 3)
        color = colormaps["viridis"](0.85 * share)
        space.plot_surface(
            x[..., 0],
            x[..., 1],
            x[..., 2],
            color=color,
            alpha=0.8,
            edgecolor=color,
            linewidth=0.3,
            rcount=80,
            ccount=20,
        )
        end = x[-1, 0] if share else x[len(x) // 8, 0]
        label = f"{1e3 * result.time[k]:.0f} ms"
        space.text(end[0], end[1], end[2] + (5 if share else 14), label, fontsize=8.5, color=INK, ha="center")
    low, high = places.reshape(-1, 3).min(axis=0), places.reshape(-1, 3).max(axis=0)
    space.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), zlim=(low[2], high[2]))
    # In perspective what is near is larger than the box: room for it.
    space.set_box_aspect(high - low, zoom=0.95)
    space.set_axis_off()
    space.view_init(elev=20, azim=-75)
    space.set_title(f"A free tape of {LENGTH * 1e3:.0f} mm coils up", fontsize=10.5, loc="left")

    axes = figure.add_subplot(grid[1])
    widths = np.linspace(0.05, coiling.widths[-1] * 1.05, 200)
    axes.plot(widths, [lamb(w) for w in widths], color=GREY, linewidth=4, alpha=0.6, label="closed form")
    axes.plot(coiling.widths, coiling.found, "o", color=BLUE, markersize=5, label="shells at rest")
    width = WIDTH * np.sqrt(CURVATURE / THICKNESS)
    axes.plot(width, coiling.curvature[-1], "D", color=RED, markersize=6, label="the tape on the left")
    for level, name in ((1.0, "free edges"), (1 + NU, "plane strain")):
        axes.axhline(level, color=INK, linewidth=0.8, linestyle=":")
        axes.annotate(
            name, (coiling.widths[-1], level), xytext=(0, 4), textcoords="offset points", ha="right"
        )
    axes.set_ylim(0.88, 1.05 + NU)
    axes.legend(frameon=False, fontsize=8.5, loc="center right")
    plain(axes, "width / $\\sqrt{h/c}$", "curvature along / c", "How tightly it coils")
    _audit.draw_energies(figure.add_subplot(grid[2]), result, "Where the work of the layers goes", "mJ", 1e-3)
    return figure


def main() -> None:
    """Print the checks, and leave a picture."""
    found = run()
    for width, k, exact in zip(found.widths, found.found, found.expected, strict=True):
        print(f"width {width:4.1f} sqrt(h/c): curvature {k:.4f} c, closed form {exact:.4f} c")
    print(f"tape that coiled up: {found.curvature[-1]:.4f} c, closed form {found.final:.4f} c")
    print(f"momentum {found.momentum:.1e} of its mass times its largest speed")
    print(f"energy audit: {found.drifts[0]:.1e} of the work, with half the step {found.drifts[1]:.1e}")
    print(f"look at {save(picture(found), 'coiling_tape')}")


if __name__ == "__main__":
    main()
