"""A kilogram on a ground, and what LuGre knows that Coulomb does not.

What is there to know about friction besides its coefficient? Four experiments tell. Pulled by a soft spring,
a mass sticks and slips; pushed below break-away it moves by micrometres, on loops that remember; pushed
harder and harder it breaks away the earlier the faster the force grows; and put on a slope suddenly it slides
where one that was loaded gently stays. Coulomb's law, one coefficient and an elastic deflection, has none of
the four.

Checked: every experiment against the law's differential equations, integrated by SciPy.

    python examples/friction_rig.py
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pliant as pl
from _style import AMBER, BLUE, GREY, INK, RED, new_figure, plain, save
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from pliant.scenes import Scene, energy_drift, friction_rig

COULOMB = pl.Coulomb(1.5)


@dataclass(frozen=True)
class Study:
    """Runs of the rig."""

    pulled: tuple[Scene, pl.Result]
    pulled_coulomb: pl.Result
    pushed: tuple[Scene, pl.Result]
    pushed_coulomb: pl.Result
    rates: np.ndarray
    """Rates of loading [N/s]."""
    peaks: np.ndarray
    """Largest friction at each rate [N]."""
    peaks_expected: np.ndarray
    peaks_coulomb: np.ndarray
    angles: np.ndarray
    """Slopes [degrees]."""
    slid: dict[str, np.ndarray]
    """Velocity after 3 s on each slope [m/s], put on it suddenly and gently."""
    slid_expected: dict[str, np.ndarray]
    slopes_law: pl.LuGre
    drift: float
    """Energy that the audit of stick-slip leaves over, of the largest exchanged."""


def run(
    pull: float = 29.0,
    push: float = 91.5,
    rates: Sequence[float] = (0.1, 0.3, 1.0, 3.0, 10.0, 20.0, 50.0),
    angles: Sequence[float] = (15, 16, 17, 18, 19, 20, 21, 22, 23, 24, 25),
) -> Study:
    """Run all experiments, with LuGre and with Coulomb."""

    def both(name: str, duration: float) -> tuple[Scene, pl.Result, pl.Result]:
        scene = friction_rig(name, duration=duration)
        other = friction_rig(name, law=COULOMB, duration=duration)
        return scene, scene.simulate(), other.simulate()

    pulled, pulled_result, pulled_coulomb = both("stick_slip", pull)
    pushed, pushed_result, pushed_coulomb = both("presliding", push)
    found, expected, plain_law = [], [], []
    for rate in rates:
        scene = friction_rig("break_away", rate=rate)
        found.append(scene.measure(scene.simulate())["largest friction [N]"])
        expected.append(scene.expected["largest friction [N]"].value)
        scene = friction_rig("break_away", law=COULOMB, rate=rate)
        plain_law.append(scene.measure(scene.simulate())["largest friction [N]"])
    law = pl.LuGre(0.4, 0.3, stribeck_velocity=1e-3, bristle_stiffness=1e5, bristle_damping=316.0)
    slid, slid_expected = {}, {}
    for how, rise in (("suddenly", 0.0), ("within a second", 1.0)):
        scenes = [friction_rig("incline", law=law, angle=float(np.radians(a)), rise=rise) for a in angles]
        slid[how] = np.array([scene.measure(scene.simulate())["velocity [m/s]"] for scene in scenes])
        slid_expected[how] = np.array([scene.expected["velocity [m/s]"].value for scene in scenes])
    return Study(
        (pulled, pulled_result),
        pulled_coulomb,
        (pushed, pushed_result),
        pushed_coulomb,
        np.array(rates),
        np.array(found),
        np.array(expected),
        np.array(plain_law),
        np.array(angles, dtype=float),
        slid,
        slid_expected,
        law,
        energy_drift(pulled_result),
    )


def spring(result: pl.Result) -> np.ndarray:
    """Force of the spring [N]."""
    return 2.0 * (0.1 * result.time - result.track(result.model["block"]).position[:, 0])


def draw_slopes(axes: Axes, study: Study) -> None:
    """Draw how fast the block is after 3 s on each slope."""
    for (how, found), color in zip(study.slid.items(), (BLUE, RED), strict=True):
        axes.plot(study.angles, study.slid_expected[how], color=color, linewidth=1.2)
        axes.plot(study.angles, found, "o", color=color, markersize=4, label=f"put on it {how}")
    law = study.slopes_law
    a = np.radians(np.linspace(study.angles.min(), study.angles.max(), 400))
    slides = np.tan(a) > law.static
    coulomb = np.where(slides, 3.0 * 9.81 * (np.sin(a) - law.static * np.cos(a)), 0.0)
    axes.plot(np.degrees(a), coulomb, color=GREY, linewidth=1.2, label=f"Coulomb, {law.static:g}")
    axes.axvline(np.degrees(np.arctan(law.static)), color=INK, linewidth=0.8, linestyle=":")
    axes.annotate(
        "atan 0.4",
        (np.degrees(np.arctan(law.static)), 0.12),
        xytext=(-4, 0),
        textcoords="offset points",
        fontsize=8.5,
        ha="right",
    )
    axes.legend(frameon=False, fontsize=8.5, loc="upper left")
    plain(axes, "slope [degrees]", "velocity after 3 s [m/s]", "Who slides depends on how it was loaded")


def picture(study: Study) -> Figure:
    """Draw stick-slip, the presliding loop, break-away over the rate, and slopes."""
    figure = new_figure(11, 7.4)
    axes = figure.subplots(2, 2)
    for result, color, name in (
        (study.pulled_coulomb, GREY, "Coulomb"),
        (study.pulled[1], BLUE, "LuGre"),
    ):
        axes[0, 0].plot(result.time, spring(result), color=color, linewidth=1.4, label=name)
    axes[0, 0].legend(frameon=False, fontsize=8.5, loc="lower right")
    plain(axes[0, 0], "t [s]", "force of the spring [N]", "Pulled over a soft spring: stick-slip")

    for result, color, name in (
        (study.pushed_coulomb, GREY, "Coulomb"),
        (study.pushed[1], BLUE, "LuGre"),
    ):
        force = -result.contact_force("block", "ground")[:, 0]
        way = 1e6 * result.track(result.model["block"]).position[:, 0]
        axes[0, 1].plot(way, force, color=color, linewidth=1.4, label=name)
    expected = study.pushed[0].expected
    turning = {"there [um]": 1.425, "held [um]": 1.425, "back [um]": -1.425, "held back [um]": -1.425}
    axes[0, 1].axhline(0.0, color=GREY, linewidth=0.6)
    axes[0, 1].plot(
        [expected[key].value for key in turning if key in expected],
        [force for key, force in turning.items() if key in expected],
        "o",
        color=INK,
        markersize=4,
        fillstyle="none",
        label="LSODA",
    )
    axes[0, 1].legend(frameon=False, fontsize=8.5, loc="lower right")
    plain(axes[0, 1], "way [um]", "friction [N]", "Pushed to and fro, 5 % below break-away")

    axes[1, 0].semilogx(study.rates, study.peaks_coulomb, "s-", color=GREY, markersize=4, label="Coulomb")
    axes[1, 0].semilogx(study.rates, study.peaks_expected, color=INK, linewidth=1, label="LSODA")
    axes[1, 0].semilogx(study.rates, study.peaks, "o", color=BLUE, markersize=5, label="LuGre")
    axes[1, 0].axhline(1.0, color=AMBER, linewidth=1, linestyle="--", label="dynamic friction")
    axes[1, 0].set_ylim(0.9, 1.6)
    axes[1, 0].xaxis.set_major_formatter("{x:g}")
    axes[1, 0].legend(frameon=False, fontsize=8.5, loc="lower left")
    plain(axes[1, 0], "rate of the load [N/s]", "largest friction [N]", "Pushed harder and harder")
    draw_slopes(axes[1, 1], study)
    return figure


def main() -> None:
    """Print what is checked, and leave a picture."""
    study = run()
    for scene, result in (study.pulled, study.pushed):
        print(f"{scene.title}:")
        print(scene.report(scene.measure(result)))
    print(f"stick-slip: the sum of energies drifts by {study.drift:.1e}")
    off = np.abs(study.peaks / study.peaks_expected - 1).max()
    print(f"largest friction, {study.rates[0]:g} to {study.rates[-1]:g} N/s: ", end="")
    print(f"{study.peaks[0]:.3f} to {study.peaks[-1]:.3f} N, the equations' to {off:.1e}; ", end="")
    print(f"Coulomb {study.peaks_coulomb.min():.3f} to {study.peaks_coulomb.max():.3f} N")
    for how, found in study.slid.items():
        slides = study.angles[found > 1e-3]
        off = np.abs(found - study.slid_expected[how]).max()
        first = f"from {slides.min():g} degrees on" if len(slides) else "nowhere"
        print(f"put on a slope {how}, it slides {first}; velocities are the equations' to {off:.1e} m/s")
    print(f"look at {save(picture(study), 'friction_rig')}")


if __name__ == "__main__":
    main()
