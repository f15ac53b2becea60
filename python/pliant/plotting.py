"""Pictures with matplotlib."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from pliant.bodies import LineBody
from pliant.drawing import COLORS, draw, frames_of

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from pliant.result import Result

__all__ = ["plot"]

SHOWN = 9  # times in one picture
SHOWN_OF_NETS = 3  # where there are many strands


def plot(result: Result, color: Any = None) -> Figure:
    """Draw the bodies at a few times, later ones stronger; see :meth:`pliant.Result.plot`."""
    try:
        from matplotlib.collections import LineCollection
        from matplotlib.colors import Normalize
        from matplotlib.figure import Figure as NewFigure
        from matplotlib.lines import Line2D
    except ImportError as error:
        raise ImportError('pictures need matplotlib: pip install "pliant[plot]"') from error
    import matplotlib as mpl
    from mpl_toolkits.mplot3d.art3d import Line3DCollection  # type: ignore[import-untyped]

    strands = sum(len(b.strands) for b in result.model._bodies.values() if isinstance(b, LineBody))
    frames = frames_of(result, SHOWN if strands <= 8 else SHOWN_OF_NETS)
    drawings = draw(result, frames, color)
    key = color if isinstance(color, str) else "color"
    spans = np.concatenate([d.points.reshape(-1, 3) for d in drawings])
    low, high = spans.min(axis=0), spans.max(axis=0)
    size = max(float((high - low).max()), 1e-9)
    flat = [k for k in range(3) if high[k] - low[k] < 1e-6 * size]
    figure = NewFigure(figsize=(7.2, 5.4), layout="constrained")
    axes: Any
    if flat:
        shown = [k for k in range(3) if k != flat[0]]
        axes = figure.add_subplot()
        axes.set_aspect("equal", adjustable="datalim")
        axes.grid(alpha=0.25)
    else:
        shown = [0, 1, 2]
        axes = figure.add_subplot(projection="3d")
        extent = np.maximum(high - low, 0.15 * size)
        middle = (high + low) / 2
        for k, name in enumerate("xyz"):
            getattr(axes, f"set_{name}lim")(middle[k] - 0.52 * extent[k], middle[k] + 0.52 * extent[k])
        axes.set_box_aspect(extent)
    for k, name in zip(shown, "xyz", strict=False):
        getattr(axes, f"set_{name}label")(f"{'xyz'[k]} [m]")
    values = [d.values[key] for d in drawings if color is not None and key in d.values]
    norm = Normalize(min(v.min() for v in values), max(v.max() for v in values)) if values else None
    cycle = mpl.rcParams["axes.prop_cycle"].by_key()["color"]
    for number, drawing in enumerate(drawings):
        plain = cycle[number % len(cycle)]
        for frame in range(len(frames)):
            strength = 0.18 + 0.82 * (frame / max(len(frames) - 1, 1)) ** 1.5
            if drawing.points.shape[1] == 1:
                axes.plot(*drawing.points[frame][:, shown].T, "o", color=plain, alpha=strength, markersize=6)
                continue
            points = drawing.points[frame][:, shown]
            pieces = np.stack([points[:-1], points[1:]], axis=1)
            inside = np.setdiff1d(np.arange(len(pieces)), np.cumsum(drawing.strands)[:-1] - 1)
            kind: Any = LineCollection if flat else Line3DCollection
            look: dict[str, Any] = {"linewidths": 1.8, "alpha": strength, "capstyle": "round"}
            if norm is not None and key in drawing.values:
                lines = kind(pieces[inside], norm=norm, cmap="viridis", **look)
                lines.set_array(drawing.values[key][frame][:-1][inside])
            else:
                lines = kind(pieces[inside], colors=plain, **look)
            axes.add_collection(lines)
    if flat:
        axes.autoscale_view()
    if norm is not None:
        label = COLORS.get(color, "") if isinstance(color, str) else ""
        figure.colorbar(mpl.cm.ScalarMappable(norm, "viridis"), ax=axes, label=label, shrink=0.75)
    marks = [Line2D([], [], color=cycle[k % len(cycle)], label=d.name) for k, d in enumerate(drawings)]
    if norm is None and 1 < len(marks) <= 8:
        axes.legend(handles=marks, frameon=False)
    times = result.time[frames]
    what = "load factor" if result.is_static else "t ="
    unit = "" if result.is_static else " s"
    title = f"{what} {times[0]:.4g} (light) to {times[-1]:.4g}{unit} (strong)" if len(times) > 1 else ""
    axes.set_title(title, fontsize=10)
    return figure
