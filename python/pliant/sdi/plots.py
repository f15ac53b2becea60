"""Pictures of bodies, maps and landscapes with matplotlib."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from pliant.sdi.body import Body
    from pliant.sdi.design import Design, Landscape
    from pliant.sdi.map import ErrorMap, Region
    from pliant.sdi.techniques import Shape

__all__ = ["draw_map", "draw_outline", "draw_shapes", "new_figure", "plot_body", "plot_landscape", "plot_map"]

INK, BLUE, RED, GREEN, AMBER, GREY = "#22313f", "#2166ac", "#c0392b", "#2a8f5b", "#d98a00", "#9aa5ad"
COLORS = {
    "lumped": RED,
    "matrix": GREEN,
    "elastica": BLUE,
    "constant_curvature": AMBER,
    "hybrid": "#7b4ea3",
    "ancf": "#008b8b",
    "finite_element": INK,
}
NAMES = {
    "lumped": "lumped (LPM)",
    "matrix": "matrix analysis (NMSA)",
    "elastica": "elastica (EA)",
    "constant_curvature": "constant curvature (PCC)",
    "hybrid": "hybrid",
    "ancf": "ANCF",
    "finite_element": "finite elements (FEA)",
}


def new_figure(width: float, height: float) -> Figure:
    """Make a figure of so many inches that lays itself out."""
    try:
        from matplotlib.figure import Figure
    except ImportError as error:
        raise ImportError('pictures need matplotlib: pip install "pliant[plot]"') from error
    return Figure(figsize=(width, height), layout="constrained")


def _plain(axes: Axes, xlabel: str, ylabel: str, title: str = "") -> None:
    axes.set_xlabel(xlabel)
    axes.set_ylabel(ylabel)
    axes.set_title(title, fontsize=10.5, loc="left")
    axes.grid(alpha=0.25, linewidth=0.6)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)


def draw_outline(axes: Axes, body: Body, color: str = BLUE) -> None:
    """Fill the outline of a body, in millimetres."""
    x = body.samples.x
    inside = 1e-12 * body.length
    places = x.clip(inside, body.length - inside)
    if body.sections is None:
        low, high = -body.half_height(places), body.half_height(places)
    else:
        low = -body.sections.neutral_axis(places)
        high = low + body.sections.height(places)
    axes.fill_between(1e3 * x, 1e3 * low, 1e3 * high, color=color, alpha=0.25, linewidth=0)
    axes.plot(1e3 * x, 1e3 * high, color=color, linewidth=1.2)
    axes.plot(1e3 * x, 1e3 * low, color=color, linewidth=1.2)
    axes.plot([0, 0], [1.3e3 * low.min(), 1.3e3 * high.max()], color=INK, linewidth=4, solid_capstyle="butt")


def plot_body(body: Body) -> Figure:
    """Draw the outline, the stiffness and its slope with their extremes."""
    found = body.distribution
    figure = new_figure(7.0, 6.0)
    top, middle, bottom = figure.subplots(3, 1, sharex=True, height_ratios=(0.8, 1, 1))
    draw_outline(top, body)
    top.set_aspect("equal", adjustable="datalim")
    _plain(top, "", "y [mm]", f"{body.name}: SDI = {found.index.real:.3f} {found.index.imag:+.4f} i")
    middle.plot(1e3 * found.x, 1e3 * found.stiffness, color=BLUE)
    middle.set_ylim(bottom=0)
    _plain(middle, "", "k [10$^{-3}$ N m$^2$]", "bending stiffness")
    bottom.plot(1e3 * found.x, 1e3 * found.slope, color=BLUE)
    bottom.axhline(0, color=GREY, linewidth=0.8)
    if found.x_m is not None and found.x_M is not None:
        for place, name in ((found.x_m, "$x_m$"), (found.x_M, "$x_M$")):
            i = int(np.argmin(np.abs(found.x - place)))
            bottom.plot(1e3 * place, 1e3 * found.slope[i], "o", color=RED)
            at = (1e3 * place, 1e3 * found.slope[i])
            bottom.annotate(name, at, xytext=(7, 4), textcoords="offset points", color=RED)
    bottom.margins(y=0.15)
    _plain(bottom, "x [mm]", "k' [N mm]", "its slope, steepest descent and ascent")
    return figure


def draw_shapes(axes: Axes, shapes: list[Shape], labels: list[str] | None = None) -> None:
    """Draw bent bodies over each other, in millimetres."""
    for shape, label in zip(shapes, labels or [NAMES[s.technique] for s in shapes], strict=True):
        solid = shape.technique == "finite_element"
        few = len(shape.x) <= 12
        axes.plot(
            1e3 * shape.x,
            1e3 * shape.y,
            "o-" if few else "-",
            color=COLORS[shape.technique],
            linewidth=5 if solid else 1.6,
            alpha=0.3 if solid else 1.0,
            markersize=4,
            label=label,
        )
    axes.set_aspect("equal")
    axes.legend(frameon=False, fontsize=8.5)
    _plain(axes, "x [mm]", "y [mm]")


def _patch(region: Region, limits: tuple[float, float, float, float]) -> Any:
    """Outline of a region within the limits, as a path."""
    from matplotlib.path import Path

    x0, x1, y0, y1 = limits

    def box(re: tuple[float, float], im: tuple[float, float]) -> Any:
        a, b = np.clip(re, x0, x1)
        c, d = np.clip(im, y0, y1)
        return [(a, c), (b, c), (b, d), (a, d), (a, c)]

    codes = [Path.MOVETO, Path.LINETO, Path.LINETO, Path.LINETO, Path.CLOSEPOLY]
    if region.inside:
        return Path(box(region.re, region.im), codes)
    around = box((x0, x1), (y0, y1))
    return Path(around + box(region.re, region.im)[::-1], codes + codes)


def draw_map(axes: Axes, found: ErrorMap, labels: list[str], title: str = "") -> None:
    """Draw the regions of some techniques into the complex plane, and the bodies."""
    from matplotlib.patches import PathPatch

    z = found.index
    x0, x1 = min(0.0, float(z.real.min()) - 0.5), 1.12 * float(z.real.max())
    low = 0.6 * float(z.imag.min())
    limits = (x0, x1, low, 1.4)
    levels = sorted({level for _, level in found.regions})
    crowded = len(labels) > 1
    for label in labels:
        color = COLORS[label.split(" ")[0]]
        for level in levels[::-1]:
            region = found.regions[label, level]
            if region.re[0] > region.re[1]:
                continue
            first = level == levels[0]
            axes.add_patch(
                PathPatch(
                    _patch(region, limits),
                    facecolor=(color, 0.28) if first else "none",
                    edgecolor=color,
                    linewidth=2.0 if crowded and first else 1.4,
                    linestyle="-" if first else (0, (5, 3)),
                    hatch=None if first or crowded else "///",
                    alpha=None if first or crowded else 0.45,
                )
            )
    errors = np.stack([found.errors[label] for label in labels])
    best = errors.min(axis=0)
    for level, marker, face in ((levels[0], "o", INK), (levels[-1], "o", "white"), (np.inf, "x", INK)):
        chosen = best < level
        best = np.where(chosen, np.inf, best)
        look: dict[str, Any] = {"markerfacecolor": face} if marker == "o" else {}
        axes.plot(z.real[chosen], z.imag[chosen], marker, color=INK, markersize=4.5, zorder=3, **look)
    axes.set_yscale("log")
    axes.set_xlim(x0, x1)
    axes.set_ylim(low, 1.4)
    _plain(axes, "Re SDI = $L\\,/\\,(x_M - x_m)$", "Im SDI = $k_{min}\\,/\\,k_{max}$", title)


def _name(label: str) -> str:
    """Write out a label such as "matrix paper"."""
    technique, _, variant = label.partition(" ")
    return NAMES[technique] + (f", {variant}" if variant else "")


def plot_map(found: ErrorMap, together: bool = False) -> Figure:
    """Draw a complex plane for each technique, or one for all, with the regions of small error."""
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    labels = list(found.errors)
    levels = sorted({level for _, level in found.regions})
    if together:
        figure = new_figure(7.4, 5.4)
        axes = figure.subplots()
        # The elastica is good nearly everywhere: the others lie upon it.
        order = sorted(labels, key=lambda label: -int(np.count_nonzero(found.errors[label] < min(levels))))
        draw_map(axes, found, order, "techniques over the complex plane of the softness distribution index")
        small, large = (f"{100 * level:g} %" for level in (min(levels), max(levels)))
        handles: list[Any] = [
            Patch(
                facecolor=(COLORS[t.split(" ")[0]], 0.28), edgecolor=COLORS[t.split(" ")[0]], label=_name(t)
            )
            for t in labels
        ]
        handles += [
            Line2D([], [], color=GREY, linewidth=2.0, label=f"error below {small}"),
            Line2D([], [], color=GREY, linestyle="--", label=f"below {large}"),
            Line2D([], [], marker="o", color=INK, linestyle="", label=f"best one below {small}"),
            Line2D(
                [], [], marker="o", color=INK, markerfacecolor="white", linestyle="", label=f"below {large}"
            ),
        ]
        figure.legend(handles=handles, loc="outside lower center", ncols=3, frameon=False, fontsize=8.5)
        return figure
    columns = min(3, len(labels))
    rows = -(-len(labels) // columns)
    figure = new_figure(4.1 * columns, 3.7 * rows + 0.4)
    grid = np.atleast_1d(figure.subplots(rows, columns, sharex=True, sharey=True, squeeze=False)).ravel()
    levels = sorted({level for _, level in found.regions})
    for axes, label in zip(grid, labels, strict=False):
        right = ", ".join(f"{found.regions[label, level].accuracy:.2f}" for level in levels)
        draw_map(axes, found, [label], f"{_name(label)}\ntells {right} of the bodies right")
    for axes in grid[len(labels) :]:
        axes.set_axis_off()
    small, large = (f"{100 * level:g} %" for level in (levels[0], levels[-1]))
    marks: list[Any] = [
        Patch(facecolor=(GREY, 0.4), edgecolor=GREY, label=f"region: error below {small}"),
        Patch(facecolor="none", edgecolor=GREY, hatch="///", linestyle="--", label=f"below {large}"),
        Line2D([], [], marker="o", color=INK, linestyle="", label=f"body: error below {small}"),
        Line2D([], [], marker="o", color=INK, markerfacecolor="white", linestyle="", label=f"below {large}"),
        Line2D([], [], marker="x", color=INK, linestyle="", label="above"),
    ]
    figure.legend(handles=marks, loc="outside lower center", ncols=5, frameon=False, fontsize=8.5)
    return figure


def plot_landscape(valley: Landscape, solutions: list[Design], bounds: tuple[float, float] | None) -> Figure:
    """Draw the objective of a notch and the predicted error along its valley."""
    from matplotlib.colors import LogNorm
    from matplotlib.lines import Line2D

    figure = new_figure(10.4, 4.8)
    left, right = figure.subplots(1, 2, sharex=True, sharey=True)
    w, depth = 1e3 * valley.lengths, valley.depths
    distance = np.sqrt(valley.objective.T)
    shown = left.pcolormesh(w, depth, distance, norm=LogNorm(max(distance.min(), 1e-3), 1), cmap="viridis")
    figure.colorbar(shown, ax=left, label="distance from the wanted height [L]")
    errors = right.contourf(
        w, depth, 100 * valley.error.T, levels=[0, 1, 2, 3, 5, 10, 20, 50], cmap="magma_r"
    )
    figure.colorbar(errors, ax=right, label="predicted error of the elastica [%]")
    for axes, title in (
        (left, "the objective is a valley"),
        (right, "and its floor is not equally trustworthy"),
    ):
        axes.contour(w, depth, valley.tip.T - valley.height, levels=[0.0], colors=[INK], linewidths=1.6)
        if bounds is not None:
            axes.contour(
                w, depth, valley.index.real.T, levels=[bounds[0]], colors=["#00a0a0"], linewidths=1.4
            )
            axes.contour(
                w, depth, valley.index.imag.T, levels=[bounds[1]], colors=["#00a0a0"], linestyles="--"
            )
        for number, design in enumerate(solutions, 1):
            u, v = 1e3 * design.variables["notch_length"], design.variables["depth"]
            axes.plot(u, v, "o", color=RED, markeredgecolor="white", markersize=8, zorder=4)
            axes.annotate(
                str(number),
                (u, v),
                xytext=(6, 6),
                textcoords="offset points",
                color=INK,
                weight="bold",
                bbox={"boxstyle": "round,pad=0.15", "facecolor": "white", "edgecolor": "none", "alpha": 0.8},
            )
        _plain(axes, "length of the notch [mm]", "height left / height", title)
        axes.grid(visible=False)
    handles = [Line2D([], [], color=INK, linewidth=1.6, label="the wanted height is reached")]
    if bounds is not None:
        handles += [
            Line2D([], [], color="#00a0a0", label=f"Re SDI = {bounds[0]:g}: allowed to the right"),
            Line2D([], [], color="#00a0a0", linestyle="--", label=f"Im SDI = {bounds[1]:g}: allowed above"),
        ]
    if solutions:
        handles.append(Line2D([], [], marker="o", color=RED, linestyle="", label="solutions"))
    figure.legend(handles=handles, loc="outside lower center", ncols=4, frameon=False, fontsize=8.5)
    return figure
