"""How the pictures of the examples look, and where they go."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.figure import Figure
from PIL import Image

if TYPE_CHECKING:
    from matplotlib.axes import Axes

OUT = Path("out/examples")
INK, BLUE, RED, GREEN, AMBER, GREY = "#22313f", "#2166ac", "#c0392b", "#2a8f5b", "#d98a00", "#9aa5ad"


def new_figure(width: float, height: float) -> Figure:
    """Make a figure of so many inches that lays itself out."""
    return Figure(figsize=(width, height), layout="constrained")


def plain(axes: Axes, xlabel: str, ylabel: str, title: str) -> None:
    """Give axes labels, a title and a quiet look."""
    axes.set_xlabel(xlabel)
    axes.set_ylabel(ylabel)
    axes.set_title(title, fontsize=10.5, loc="left")
    axes.grid(alpha=0.25, linewidth=0.6)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)


def seen_from(points: np.ndarray, azimuth: float, elevation: float) -> np.ndarray:
    """Project points (..., 3) along a line of sight, angles in degrees; to the right and up, (..., 2)."""
    a, e = np.radians((azimuth, elevation))
    right = (-np.sin(a), np.cos(a), 0.0)
    up = (-np.sin(e) * np.cos(a), -np.sin(e) * np.sin(a), np.cos(e))
    return points @ np.stack([right, up], axis=1)


def scale_bar(axes: Axes, x: float, y: float, length: float, label: str) -> None:
    """Draw a length into axes that show no numbers, and hide their frame."""
    axes.plot([x, x + length], [y, y], color=INK, linewidth=2, solid_capstyle="butt")
    axes.annotate(label, (x + length / 2, y), xytext=(0, -12), textcoords="offset points", ha="center")
    axes.set_aspect("equal")
    axes.set_axis_off()


def slope_triangle(axes: Axes, x: float, y: float, order: float) -> None:
    """Draw the slope of an order of convergence into double logarithmic axes, from (x, y) to twice x."""
    axes.plot([x, 2 * x, 2 * x, x], [y, y * 2.0**order, y, y], color=GREY, linewidth=1)
    axes.annotate(f"{abs(order):g}", (2.1 * x, y * 2.0 ** (order / 2)), color=INK, va="center")


def save(figure: Figure, name: str, **options: Any) -> Path:
    """Write a picture to ``out/examples/``, in few colours to keep it small, and return its path."""
    OUT.mkdir(parents=True, exist_ok=True)
    path = OUT / f"{name}.png"
    figure.savefig(path, **{"dpi": 130, **options})
    with Image.open(path) as picture:
        few = picture.convert("RGB").quantize()
    few.save(path, optimize=True)
    return path
