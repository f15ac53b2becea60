"""A shallow shell snaps through: the load that it takes, and how long it hesitates.

How much does a shallow shell bear before it snaps, and how long does the snap take? A strip out of a long
cylindrical shell, shaped and pressed like half a sine wave, its straight ends on hinges that do not move.
Its path of load and deflection has a closed form in the theory of shallow shells (Marguerre; Fung & Kaplan
1952): with heights in radii of gyration h/sqrt(12) and loads in EI (pi/L)^4 times that,
q = (a - e) + e (a^2 - e^2)/4 from the rise a. A shell with a > 4.69 does not get that far: it tips over to
one side, and on that branch, where the thrust stays four times Euler's, the load is q = a + 3 e.

At the limit point nothing pushes: just above it the shell hesitates before it snaps, and the longer the less
the load exceeds its limit. With the first natural frequency w of the flat strip, eps the excess of the load
over its limit q, and e the height there, the snap takes

    w T = Gamma(1/4)^2/(2 sqrt(pi)) / (eps q e)^(1/4) + O(1),

the law of all snaps without damping: the time of y'' = eps q + 3/4 e y^2 from rest to infinity.

Checked: limit point and bifurcation against the closed forms; a high shell, pushed a little to one side,
along the whole branch; the motion against the equation of its one mode; how much longer it hesitates at a
tenth of the excess against that law; and the energy audit.

    python examples/snapping_shell.py
"""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from dataclasses import dataclass

import _audit
import numpy as np
import pliant as pl
from _style import AMBER, BLUE, GREEN, GREY, INK, RED, new_figure, plain, save
from matplotlib.figure import Figure
from numpy.typing import NDArray
from scipy.integrate import solve_ivp
from scipy.special import gamma

Floats = NDArray[np.float64]

LENGTH, WIDTH, THICKNESS = 0.1, 0.03, 0.5e-3
STEEL = pl.SaintVenantKirchhoff(youngs_modulus=2.1e11, poisson_ratio=0.3, density=7850.0)
GYRATION = THICKNESS / np.sqrt(12)
"""Radius of gyration [m]."""
WAVE = np.pi / LENGTH
# The strip cannot contract across: plane strain.
UNIT = STEEL.youngs_modulus / (1 - STEEL.poisson_ratio**2) * THICKNESS**3 / 12 * WAVE**4 * GYRATION
"""Unit of the load [Pa]."""
RATE = float(np.sqrt(UNIT / (STEEL.density * THICKNESS * GYRATION)))
"""First natural frequency of the flat strip [rad/s]."""
LOW, HIGH = 3.5, 8.0
"""Rises of the two shells [radii of gyration]."""
PUSH = 0.3
"""Push to the side of the shell that tips over [UNIT]."""


@dataclass(frozen=True)
class Path:
    """A path of equilibria."""

    rise: float
    height: Floats
    """First mode of the shape [radii of gyration], (n,)."""
    load: Floats
    """[UNIT], (n,)."""
    shapes: Floats
    """Nodes of one long edge [m], (n, nodes, 3)."""
    critical: tuple[str, float, float]
    """First critical point: its kind, its height and its load."""
    state: pl.State
    """The shell there."""


@dataclass(frozen=True)
class Snap:
    """A snap at a load that exceeds the limit by a small part."""

    excess: float
    result: pl.Result
    height: Floats
    """First mode over time [radii of gyration]."""
    mode: Floats
    """The same by the equation of one mode."""

    @property
    def duration(self) -> float:
        """Time until the shell is as far below its supports as it was above [1/RATE]."""
        return crossing(self.result.time, self.height, -limit(LOW)[0]) * RATE


@dataclass(frozen=True)
class Snapping:
    """Paths and snaps."""

    low: Path
    high: Path
    """The high shell up to its bifurcation."""
    tipped: Path
    """The same, pushed a little to one side, until it has snapped."""
    snaps: Sequence[Snap]
    drifts: tuple[float, float]
    """Changes of the sum of energies over the largest kinetic energy, with a step and half of it."""

    @property
    def branch(self) -> float:
        """Largest distance of the tipped shell's path from the closed form, over rise and critical load."""
        scale = np.array([HIGH, bifurcation(HIGH)[1]])
        exact = np.concatenate(tipped_path()) / scale
        path = np.column_stack([self.tipped.height, self.tipped.load]) / scale
        return float(np.linalg.norm(path[:, None] - exact, axis=2).min(axis=1).max())

    @property
    def hesitation(self) -> float:
        """How much longer the snap takes under the first load than under the second, over the law's."""
        first, second = self.snaps[:2]
        return (first.duration - second.duration) / (law(first.excess) - law(second.excess))


def load_at(rise: float, height: Floats | float) -> Floats | float:
    """Load of the symmetric equilibria [UNIT]."""
    return (rise - height) + height * (rise**2 - height**2) / 4


def limit(rise: float) -> tuple[float, float]:
    """Height and load of the upper limit point."""
    height = float(np.sqrt((rise**2 - 4) / 3))
    return height, float(load_at(rise, height))


def bifurcation(rise: float) -> tuple[float, float]:
    """Height and load where the thrust is that of two half waves, four times Euler's."""
    height = float(np.sqrt(rise**2 - 16))
    return height, float(load_at(rise, height))


def tipped_path() -> list[Floats]:
    """Heights and loads of the pushed shell, (n, 2) before and after it has snapped.

    Its second mode is 4 p/pi over 16 - 4 P, with the thrust P = (a^2 - e^2 - 4 a_2^2)/4 in Euler's.
    """
    thrust = 4 - np.geomspace(8.0, 1e-3, 20_000)
    second = 4 * PUSH / np.pi / (16 - 4 * thrust)
    square = HIGH**2 - 4 * second**2 - 4 * thrust
    thrust, height = thrust[square > 0], np.sqrt(square[square > 0])
    return [np.column_stack([e, HIGH - e + thrust * e]) for e in (height, -height)]


def law(excess: float) -> float:
    """Time of the snap [1/RATE] for a small excess."""
    height, load = limit(LOW)
    return float(gamma(0.25) ** 2 / (2 * np.sqrt(np.pi)) / (excess * load * height) ** 0.25)


def shell(
    rise: float, load: float, elements: int, push: float = 0.0
) -> tuple[pl.Model, pl.Shell, list[pl.Load]]:
    """Make a shell of that rise under that load, half of it pushed up and half down by ``push`` [UNIT]."""

    def form(u: float, v: float) -> tuple[float, float, float]:
        return u, v, rise * GYRATION * np.sin(WAVE * u)

    model = pl.Model()
    mesh = pl.Mesh.surface(form, (0, LENGTH), (0, WIDTH), divisions=(elements, 1))
    strip = model.add_shell(mesh, thickness=THICKNESS, material=STEEL, name="shell")
    for edge in ("u_min", "u_max"):
        model.pin(strip.edge(edge))
    for edge in ("v_min", "v_max"):
        model.symmetry(strip.edge(edge), (0, 1, 0))
    loads = []
    # Half a sine wave in steps, with the work of the wave in its first mode; half on each long edge.
    x = np.linspace(0, LENGTH, elements + 1)
    shares = np.sin(WAVE * (x[:-1] + x[1:]) / 2) / np.sinc(0.5 / elements)
    for start, end, share in zip(x[:-1], x[1:], shares, strict=True):
        # For each length of the curved edge.
        share *= (end - start) / np.linalg.norm(np.subtract(form(end, 0), form(start, 0)))
        for v in (0.0, WIDTH):
            edge = strip.edge([form(start, v), form(end, v)])
            loads.append(model.add_line_load(edge, (0, 0, -load * UNIT * share * WIDTH / 2)))
            if push:
                side = 1.0 if start < 0.499 * LENGTH else -1.0
                model.add_line_load(edge, (0, 0, side * push * UNIT * WIDTH / 2))
    return model, strip, loads


def first_mode(places: Floats) -> Floats:
    """Amplitude of the first mode [radii of gyration] of nodes (n, nodes, 3) along the strip."""
    edge = places[:, ::2]
    x = np.linspace(0, LENGTH, edge.shape[1])
    return np.asarray(2 * (edge[..., 2] * np.sin(WAVE * x)).sum(axis=1) / (len(x) - 1) / GYRATION)


def crossing(time: Floats, height: Floats, level: float) -> float:
    """Time at which the height first falls below the level, between outputs on a line."""
    below = np.flatnonzero(height < level)
    if not len(below):
        return np.inf
    k = int(below[0])
    share = (height[k - 1] - level) / (height[k - 1] - height[k])
    return float(time[k - 1] + share * (time[k] - time[k - 1]))


def follow(rise: float, elements: int, load: float, push: float = 0.0) -> Path:
    """Follow the path of a shell up to the load [UNIT], pushed to a side or symmetric."""
    model, strip, loads = shell(rise, load, elements, push)
    with warnings.catch_warnings():
        # The symmetric path of a high shell ends unstable: that is the point.
        warnings.simplefilter("ignore")
        result = pl.solve_static(model, arc_length=True, load_steps=30, scale=loads, stable=False)
    places = result.positions(strip)
    height = first_mode(places)
    point = result.critical_points[0]
    critical = (point.kind, float(height[point.index]), load * point.load_factor)
    at = result.state(point.index)
    return Path(rise, height, load * result.load_factor, places[:, ::2], critical, at)


def snap(path: Path, excess: float, elements: int, step: float) -> Snap:
    """Let the low shell go where it stands at the limit, under a load a little higher."""
    load = path.critical[2] * (1 + excess)
    model, strip, _ = shell(path.rise, load, elements)
    duration = (1.15 * law(excess) + 6.0) / RATE
    # From the very limit: velocities are zero.
    result = pl.simulate(model, duration=duration, step=step / RATE, start=path.state, spectral_radius=0.9)
    start, limit_load = limit(path.rise)

    def rates(t: float, y: Floats) -> list[float]:
        return [y[1], float(load_at(path.rise, y[0])) - limit_load * (1 + excess)]

    mode = solve_ivp(
        rates, (0, duration * RATE), [start, 0.0], t_eval=result.time * RATE, rtol=1e-10, atol=1e-12
    )
    return Snap(excess, result, first_mode(result.positions(strip)), mode.y[0])


def run(
    elements: int = 24,
    excesses: Sequence[float] = (1e-4, 1e-3, 1e-2, 1e-1),
    step: float = 0.02,
) -> Snapping:
    """Follow both shells, and let the low one snap under several loads; steps in 1/RATE."""
    low = follow(LOW, elements, 1.3 * limit(LOW)[1])
    highest = bifurcation(HIGH)[1]
    high = follow(HIGH, elements, 1.1 * highest)
    tipped = follow(HIGH, elements, 1.1 * highest, push=PUSH)
    snaps = [snap(low, excess, elements, step) for excess in excesses]
    drifts = []
    for divided in (1, 2):
        energy = snap(low, excesses[-1], elements, step / divided).result.energy
        drifts.append(float(np.abs(energy.total - energy.total[0]).max() / energy.kinetic.max()))
    return Snapping(low, high, tipped, snaps, (drifts[0], drifts[1]))


def picture(snapping: Snapping) -> Figure:
    """Draw the paths, the shapes, the snaps and the energies."""
    figure = new_figure(12, 7.6)
    (paths, shapes), (motion, energies) = figure.subplots(2, 2)
    for path, critical, color, name in (
        (snapping.low, snapping.low.critical, BLUE, "low shell"),
        (snapping.tipped, snapping.high.critical, RED, "high shell, pushed a little to one side"),
    ):
        e = np.linspace(-1.15 * path.rise, path.rise, 400)
        paths.plot(path.rise - e, load_at(path.rise, e), color=GREY, linewidth=4, alpha=0.5)
        label = f"{name}, rise {path.rise * GYRATION / THICKNESS:.2f} h"
        paths.plot(
            path.rise - path.height, path.load, ".-", color=color, linewidth=1, markersize=4, label=label
        )
        kind, height, load = critical
        paths.plot(path.rise - height, load, "o", color=INK, markersize=7, fillstyle="none")
        paths.annotate(kind, (path.rise - height, load), xytext=(7, 5), textcoords="offset points")
    for part, label in zip(tipped_path(), ("closed forms", None), strict=True):
        paths.plot(HIGH - part[:, 0], part[:, 1], color=GREY, linewidth=4, alpha=0.5, label=label)
    paths.set_ylim(-25, 85)
    paths.legend(frameon=False, fontsize=8.5, loc="upper right")
    plain(
        paths,
        "first mode, downwards [radii of gyration]",
        "load [EI (pi/L)$^4$ h/$\\sqrt{12}$]",
        "Equilibria",
    )

    for path, color, offset in ((snapping.tipped, RED, 0.0), (snapping.low, BLUE, -1.35)):
        chosen = np.linspace(path.height[0], path.height[-1], 7)
        for k, height in enumerate(chosen):
            edge = path.shapes[int(np.abs(path.height - height).argmin())]
            z = edge[:, 2] / THICKNESS * 0.25
            shapes.plot(edge[:, 0] / LENGTH, z + offset, color=color, alpha=0.3 + 0.7 * k / 6, linewidth=1.5)
        shapes.plot([0, 1], [offset, offset], "o", color=INK, markersize=4)
    shapes.set_yticks([])
    plain(shapes, "x [L]", "", "Shapes along the paths, heights exaggerated: the high shell tips over")

    colors = (INK, BLUE, GREEN, AMBER)
    for one, color in zip(snapping.snaps, colors, strict=False):
        t = one.result.time * RATE
        motion.plot(t, one.mode, color=GREY, linewidth=4, alpha=0.5)
        motion.plot(t, one.height, color=color, linewidth=1.3, label=f"{one.excess:g} above the limit")
        motion.axvline(law(one.excess), color=color, linewidth=0.8, linestyle=":")
    motion.legend(frameon=False, fontsize=8.5, loc="upper right")
    motion.set_ylim(top=2.2 * LOW)
    title = "The low shell snaps; grey: equation of one mode; dotted: time by the law"
    plain(motion, "t [1/w]", "first mode [radii of gyration]", title)
    _audit.draw_energies(
        energies, snapping.snaps[-1].result, "The last of them: where the work goes", "mJ", 1e-3
    )
    energies.set_xlabel("t [s]")
    return figure


def main() -> None:
    """Print the checks, and leave a picture."""
    found = run()
    for path, expected in ((found.low, limit(LOW)), (found.high, bifurcation(HIGH))):
        kind, height, load = path.critical
        print(f"rise {path.rise:g}: {kind} at {load:.4f} and height {height:.4f}; ", end="")
        print(f"closed form {expected[1]:.4f}, {expected[0]:.4f}")
    print(f"path of the high shell pushed to one side: {found.branch:.1e} off the closed form")
    for one in found.snaps:
        off = np.abs(one.height - one.mode).max() / LOW
        print(f"{one.excess:g} above: snap takes {one.duration:.3f}/w, law {law(one.excess):.3f}; ", end="")
        print(f"largest distance from the equation of one mode {off:.1e} of the rise")
    print(f"hesitates longer at a tenth of the excess: {found.hesitation:.4f} times what the law says")
    print(f"energy audit: {found.drifts[0]:.1e}, with half the step {found.drifts[1]:.1e}")
    print(f"look at {save(picture(found), 'snapping_shell')}")


if __name__ == "__main__":
    main()
