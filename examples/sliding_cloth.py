"""A cloth falls over a rope, slides off, and a film catches it.

Who carries the cloth, and when? It comes down off its middle on a taut rope, hangs over it, slides off on its
heavier side, and lands on a film that is held at its rim. Cable on shell, shell on membrane, both with
friction.

Checked: what rope and film give the cloth is what its momentum gains beside its weight, the momenta that the
three exchange sum to nothing, and the energy audit closes better with half the step.

    python examples/sliding_cloth.py
"""

from __future__ import annotations

from dataclasses import dataclass

import _audit
import numpy as np
import pliant as pl
from _style import AMBER, BLUE, GREEN, INK, new_figure, plain, save
from matplotlib.figure import Figure

GRAVITY = 9.81
SIZE, THICKNESS = 0.2, 4e-3
SHIFT = 0.045
"""How far the cloth's middle is from the rope [m]."""
CLOTH = pl.LinearElastic(youngs_modulus=1e6, poisson_ratio=0.3, density=800.0, retardation_time=5e-3)
FILM = pl.LinearElastic(youngs_modulus=2e6, poisson_ratio=0.3, density=1000.0, retardation_time=2e-3)
ROPE = pl.LinearElastic(youngs_modulus=2e7, poisson_ratio=0.4, density=1200.0, retardation_time=1e-3)


@dataclass(frozen=True)
class Slide:
    """The slide, with its balances."""

    result: pl.Result
    """The run with the shorter steps."""
    nodes: tuple[int, int]
    """Nodes along each side of cloth and film."""
    steps: tuple[float, float]
    """Lengths of the steps [s]."""
    drifts: tuple[float, float]
    """Largest change of the sum of energies over the largest kinetic energy."""
    unexplained: float
    """Momentum of the cloth that weight and impulses do not explain, over its largest."""

    @property
    def weight(self) -> float:
        """Weight of the cloth [N]."""
        return CLOTH.density * THICKNESS * SIZE**2 * GRAVITY


def square(size: float, n: int, center: tuple[float, float, float]) -> pl.Mesh:
    """Mesh a level square by its centre."""
    x = np.linspace(-size / 2, size / 2, n + 1)
    u, v = np.meshgrid(x, x, indexing="ij")
    return pl.Mesh.grid(np.stack([u, v, np.zeros_like(u)], -1) + np.array(center))


def build(cloth: int, film: int) -> pl.Model:
    """Make rope, film, and the cloth above them."""
    model = pl.Model(gravity=(0, 0, -GRAVITY))
    line = [(0, -0.16, 0), (0, 0.16, 0)]
    rope = model.add_cable(line, elements=2 * film, section=pl.Circle(4e-3), material=ROPE, name="rope")
    model.clamp(rope.start)
    model.clamp(rope.end)
    below = model.add_membrane(
        square(0.4, film, (0.09, 0, -0.2)), thickness=2e-3, material=FILM, wrinkling=False, name="film"
    )
    model.pin(below.edge("rim"))
    above = model.add_shell(
        square(SIZE, cloth, (SHIFT, 0, 0.013)), thickness=THICKNESS, material=CLOTH, name="cloth"
    )
    for other in (rope, below):
        model.add_contact(above, other, friction=pl.LuGre(static=0.15, dynamic=0.1))
    return model


def run(cloth: int = 5, film: int = 5, step: float = 1e-3, duration: float = 0.4) -> Slide:
    """Let the cloth fall with a step and half of it."""
    results = [
        pl.simulate(build(cloth, film), duration=duration, step=h, progress=False) for h in (step, step / 2)
    ]
    drifts = [float(np.ptp(r.energy.total) / r.energy.kinetic.max()) for r in results]
    result = results[-1]
    mass = CLOTH.density * THICKNESS * SIZE**2
    gained = mass * np.gradient(result.center_of_mass("cloth"), result.time, axis=0, edge_order=2)
    given = result.contact_impulse("cloth").copy()
    given[:, 2] -= mass * GRAVITY * result.time
    # Differences of places blur the blows; the ends of the run are quiet.
    apart = np.abs((gained - given)[-1]).max()
    return Slide(
        result,
        (cloth + 1, film + 1),
        (step, step / 2),
        (drifts[0], drifts[1]),
        float(apart / np.abs(gained).max()),
    )


def draw(slide: Slide) -> Figure:
    """Draw the cloth at some times, the forces on it, the energies."""
    figure = new_figure(11, 6.2)
    grid = figure.add_gridspec(2, 2, width_ratios=(1.35, 1))
    space = figure.add_subplot(grid[:, 0], projection="3d")
    result = slide.result
    count = len(result.time)
    moments = [round(share * (count - 1)) for share in (0.0, 0.35, 0.65, 1.0)]
    n, m = slide.nodes
    x = result.positions("film")[-1].reshape(m, m, 3)
    space.plot_surface(*np.moveaxis(x, -1, 0), color=GREEN, edgecolor=INK, linewidth=0.3, alpha=0.35)
    for k, shade in zip(moments, (0.15, 0.3, 0.5, 0.85), strict=True):
        x = result.positions("cloth")[k].reshape(n, n, 3)
        space.plot_surface(*np.moveaxis(x, -1, 0), color=BLUE, edgecolor=INK, linewidth=0.3, alpha=shade)
    space.plot(*result.positions("rope")[-1].T, color=AMBER, linewidth=3)
    space.set_aspect("equal")
    space.locator_params(nbins=4)
    space.set_xlabel("x [m]")
    space.set_ylabel("y [m]")
    space.set_zlabel("z [m]")
    space.view_init(elev=12, azim=-75)
    space.set_title(f"The cloth from 0 to {result.time[-1]:g} s", fontsize=10.5, loc="left")
    force = figure.add_subplot(grid[0, 1])
    for name, colour in (("rope", AMBER), ("film", GREEN)):
        f = result.contact_force("cloth", name)[:, 2] / slide.weight
        force.plot(result.time, f, color=colour, linewidth=1.2, label=f"of the {name}")
    force.axhline(1.0, color=INK, linewidth=0.8, linestyle=":")
    force.legend(frameon=False, fontsize=8.5)
    plain(force, "t [s]", "force up, over weight", "Who carries the cloth")
    _audit.draw_energies(figure.add_subplot(grid[1, 1]), result, "Where the energy goes", "mJ", 1e-3)
    return figure


def main() -> None:
    """Run, report, draw."""
    slide = run()
    for step, drift in zip(slide.steps, slide.drifts, strict=True):
        print(f"steps of {1e3 * step:g} ms: the sum of energies drifts by {drift:.1e} of the kinetic energy")
    for name in ("rope", "film"):
        impulse = 1e3 * slide.result.contact_impulse("cloth", name)[-1]
        print(f"impulse of the {name} on the cloth {np.round(impulse, 2)} mN s")
    print(f"momentum left unexplained: {slide.unexplained:.1e} of its largest")
    print(f"look at {save(draw(slide), 'sliding_cloth')}")


if __name__ == "__main__":
    main()
