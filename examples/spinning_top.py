"""A top spins, nods and wanders round: nutation, precession, and the spin below which it falls over.

Which way goes the axis of a top that is put down slanted? Let go with its axis at rest it falls, rises again
and draws cusps; pushed forward it draws waves, pushed back loops, and at one rate it goes round without
nodding at all. And how fast must a top spin to stand upright, to sleep? A disc on a massless pin, one rigid
body pinned at a point, answers both.

Checked: the axis against Lagrange's equations in Euler's angles, integrated by an explicit method of order 8;
it converges with order 2, and the energy audit closes at least as fast. Steady precession has the rate p that
solves A cos(theta) p^2 - C n p + m g l = 0. A sleeping top below n_c = 2 sqrt(A m g l)/C leans over to
theta = 2 arccos(n/n_c), by conservation of energy and angular momentum, and above it stays up.

    python examples/spinning_top.py
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pliant as pl
from _style import AMBER, BLUE, GREEN, GREY, INK, OUT, RED, new_figure, plain, save, seen_from, slope_triangle
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

GRAVITY = 9.81
MASS, ARM = 0.3, 0.04
"""Mass [kg]; distance of the disc from the tip [m]."""
DISC = pl.Cylinder(radius=0.04, length=0.012)
ACROSS = MASS * (DISC.gyration[0] + ARM**2)
ALONG = MASS * DISC.gyration[2]
"""Moments of inertia about the tip, A and C [kg m^2]."""
TIPPING = MASS * GRAVITY * ARM
"""m g l [N m]."""
SLEEPING = 2 * np.sqrt(ACROSS * TIPPING) / ALONG
"""Least spin of a sleeping top, n_c [rad/s]."""
SPIN, LEAN = 1.6 * SLEEPING, np.radians(40)
"""Of the top that is put down slanted [rad/s], [rad]."""
STEADY = 2 * TIPPING / (ALONG * SPIN + np.sqrt((ALONG * SPIN) ** 2 - 4 * ACROSS * TIPPING * np.cos(LEAN)))
"""Rate of its slow steady precession [rad/s]."""
STARTS = {"at rest": 0.0, "forward": 0.5 * STEADY, "back": -1.2 * STEADY, "steady": STEADY}
"""Rates of precession that the axis is let go with [rad/s]."""


@dataclass(frozen=True)
class Spinning:
    """What was found."""

    results: dict[str, pl.Result]
    """The finest run of each start."""
    axes: dict[str, np.ndarray]
    """Direction of the axis of each (n, 3)."""
    exact: dict[str, np.ndarray]
    """The same by Lagrange's equations."""
    steps: list[float]
    """Steps [s], each half of the one before."""
    errors: list[float]
    """Largest error of the axis let go at rest with each step [rad]."""
    gaps: list[float]
    """Gap of the energy audit of that, over m g l."""
    steady: tuple[float, float]
    """Of the steady start: rate found [rad/s], and largest change of the lean [rad]."""
    spins: Sequence[float]
    """Spins of tops put upright, over n_c."""
    leans: list[float]
    """How far they lean over [rad]."""

    @property
    def orders(self) -> tuple[float, float]:
        """Orders of the axis and of the energy audit."""
        found = [float(np.log2(e[-2] / e[-1])) for e in (self.errors, self.gaps)]
        return found[0], found[1]


def top(lean: float, precession: float, spin: float) -> tuple[pl.Model, pl.RigidBody]:
    """Model of a top that leans towards x, goes round at a rate, and turns about its axis by ``spin``."""
    model = pl.Model(gravity=(0, 0, -GRAVITY))
    axis = np.array([np.sin(lean), 0.0, np.cos(lean)])
    # spin = psi' + phi' cos(theta) is the component of the angular velocity along the axis.
    angular = np.array([0, 0, precession]) + (spin - precession * np.cos(lean)) * axis
    body = model.add_rigid_body(
        mass=MASS,
        shape=DISC,
        position=ARM * axis,
        orientation=Rotation.from_euler("y", lean),
        velocity=np.cross(angular, ARM * axis),
        angular_velocity=angular,
        name="top",
    )
    model.pin(body.at((0, 0, -ARM)), (0, 0, 0))
    return model, body


def lagrange(lean: float, precession: float, spin: float, times: np.ndarray) -> np.ndarray:
    """Direction of the axis (n, 3) by Lagrange's equations in the angles of nutation and precession."""
    moment = ACROSS * precession * np.sin(lean) ** 2 + ALONG * spin * np.cos(lean)

    def rates(_: float, y: np.ndarray) -> list[float]:
        sine, cosine = np.sin(y[0]), np.cos(y[0])
        round_ = (moment - ALONG * spin * cosine) / (ACROSS * sine**2)
        bend = round_**2 * cosine + (TIPPING - ALONG * spin * round_) / ACROSS
        return [y[1], bend * sine, round_]

    span = (times[0], times[-1])
    found = solve_ivp(rates, span, [lean, 0, 0], "DOP853", t_eval=times, rtol=1e-11, atol=1e-12).y
    return np.stack(
        [np.sin(found[0]) * np.cos(found[2]), np.sin(found[0]) * np.sin(found[2]), np.cos(found[0])], axis=1
    )


def run(
    duration: float = 1.0,
    step: float = 1e-3,
    halvings: int = 3,
    upright_step: float = 5e-4,
    spins: Sequence[float] = (0.3, 0.5, 0.7, 0.85, 0.95, 1.02, 1.15),
) -> Spinning:
    """Let the tops go, one with ever smaller steps, and put others upright."""
    steps = [step / 2**k for k in range(halvings + 1)]
    errors, gaps = [], []
    results, axes, exact = {}, {}, {}
    for name, precession in STARTS.items():
        model, body = top(LEAN, precession, SPIN)
        for h in steps if name == "at rest" else steps[-1:]:
            result = pl.simulate(model, duration=duration, step=h)
            axes[name] = result.track(body.center).position / ARM
            exact[name] = lagrange(LEAN, precession, SPIN, result.time)
            if name == "at rest":
                errors.append(float(np.linalg.norm(axes[name] - exact[name], axis=1).max()))
                gaps.append(float(np.abs(result.energy.total - result.energy.total[0]).max() / TIPPING))
        results[name] = result
    azimuth = np.unwrap(np.arctan2(axes["steady"][:, 1], axes["steady"][:, 0]))
    rate = float((azimuth[-1] - azimuth[0]) / duration)
    nod = float(np.abs(np.arccos(axes["steady"][:, 2]) - LEAN).max())
    leans = []
    for ratio in spins:
        model, body = top(1e-3, 0.0, ratio * SLEEPING)
        # It starts to lean like exp(sigma t), sigma = sqrt((1 - ratio^2) m g l/A).
        sigma = np.sqrt(max(1 - ratio**2, 0.05) * TIPPING / ACROSS)
        result = pl.simulate(model, duration=13 / sigma, step=upright_step)
        leans.append(float(np.arccos(result.track(body.center).position[:, 2].min() / ARM)))
    return Spinning(results, axes, exact, steps, errors, gaps, (rate, nod), spins, leans)


def draw_globe(axes: Axes, path: np.ndarray, color: str, name: str) -> None:
    """Draw the way of the axis on the sphere, with parallels and meridians, seen from above."""
    look = (-60, 62)
    around = np.linspace(0, 2 * np.pi, 200)
    for lean in np.radians((20, 40, 60, 80)):
        circle = np.stack(
            [np.sin(lean) * np.cos(around), np.sin(lean) * np.sin(around), np.full(200, np.cos(lean))], axis=1
        )
        axes.plot(*seen_from(circle, *look).T, color=GREY, linewidth=0.6, alpha=0.7)
    for azimuth in np.radians(np.arange(0, 360, 45)):
        lean = np.linspace(0, np.radians(80), 40)
        meridian = np.stack(
            [np.sin(lean) * np.cos(azimuth), np.sin(lean) * np.sin(azimuth), np.cos(lean)], axis=1
        )
        axes.plot(*seen_from(meridian, *look).T, color=GREY, linewidth=0.6, alpha=0.4)
    seen = seen_from(path, *look)
    axes.plot(*seen.T, color=color, linewidth=1.5)
    axes.plot(*seen[0], "o", color=INK, markersize=4)
    axes.set_title(name, fontsize=10, loc="left")
    axes.set_aspect("equal")
    axes.set_axis_off()


def picture(spinning: Spinning) -> Figure:
    """Draw the ways of the axis, its nodding, the errors, and the fate of sleeping tops."""
    figure = new_figure(12.5, 7.0)
    globes, graphs = figure.subfigures(2, 1, height_ratios=(1, 1.15))
    titles = ("let go at rest: cusps", "pushed forward: waves", "pushed back: loops", "steady precession")
    colors = (BLUE, GREEN, AMBER, RED)
    for axes, name, title, color in zip(globes.subplots(1, 4), STARTS, titles, colors, strict=True):
        draw_globe(axes, spinning.axes[name], color, title)
    nodding, errors, sleep = graphs.subplots(1, 3, width_ratios=(1.2, 0.9, 1))
    for name, color in zip(STARTS, colors, strict=True):
        time = spinning.results[name].time
        nodding.plot(
            time, np.degrees(np.arccos(spinning.exact[name][:, 2])), color=GREY, linewidth=4, alpha=0.5
        )
        nodding.plot(time, np.degrees(np.arccos(spinning.axes[name][:, 2])), color=color, linewidth=1.2)
    plain(nodding, "time [s]", "lean of the axis [°]", "Nutation; broad: Lagrange's equations")
    errors.loglog(spinning.steps, spinning.errors, "o-", color=BLUE, markersize=4, label="axis [rad]")
    errors.loglog(spinning.steps, spinning.gaps, "o-", color=RED, markersize=4, label="energy audit / mgl")
    slope_triangle(errors, spinning.steps[-1] * 1.6, min(spinning.errors[-1], spinning.gaps[-1]), 2)
    errors.set_xticks(spinning.steps, [f"{h:.3g}" for h in spinning.steps], minor=False)
    errors.set_xticks([], minor=True)
    errors.legend(frameon=False, fontsize=8.5)
    plain(errors, "step [s]", "largest error", "Axis: order 2; the audit closes faster")
    ratio = np.concatenate([np.linspace(0.2, 1, 200), [1.3]])
    curve = np.degrees(2 * np.arccos(np.minimum(ratio, 1)))
    sleep.plot(ratio, curve, color=GREY, linewidth=5, alpha=0.6, label=r"$2\,\arccos(n/n_c)$")
    sleep.plot(spinning.spins, np.degrees(spinning.leans), "o", color=BLUE, markersize=5, label="computed")
    sleep.legend(frameon=False, fontsize=8.5)
    plain(sleep, "spin over $n_c$", "largest lean [°]", "A top put upright sleeps, or leans over")
    return figure


def main() -> None:
    """Print what was found, and leave a picture and a page."""
    spinning = run()
    print(f"least spin of a sleeping top: {SLEEPING:.2f} rad/s; spin of the slanted one {SPIN:.2f} rad/s")
    for what, numbers, order in zip(
        ("axis [rad]", "energy audit"), (spinning.errors, spinning.gaps), spinning.orders, strict=True
    ):
        print(f"{what:12s} errors {', '.join(f'{e:.2e}' for e in numbers)}; order {order:.3f}")
    rate, nod = spinning.steady
    print(f"steady precession: {rate:.6f} rad/s (theory {STEADY:.6f}), nods by {nod:.1e} rad")
    for ratio, lean in zip(spinning.spins, spinning.leans, strict=True):
        theory = np.degrees(2 * np.arccos(min(ratio, 1)))
        print(
            f"put upright with {ratio:.2f} n_c: leans {np.degrees(lean):8.3f} degrees (theory {theory:8.3f})"
        )
    path = save(picture(spinning), "spinning_top")
    page = OUT / "spinning_top.html"
    spinning.results["at rest"].export_html(page)
    print(f"look at {path} and {page}")


if __name__ == "__main__":
    main()
