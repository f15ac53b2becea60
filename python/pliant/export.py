"""The interactive page: one self-contained HTML file that opens offline."""

from __future__ import annotations

import base64
import html
import json
import os
from importlib import resources
from typing import TYPE_CHECKING, Any

import numpy as np

from pliant.drawing import COLORS, draw, frames_of
from pliant.files import atomic
from pliant.typing import FloatArray

if TYPE_CHECKING:
    from pliant.result import Result

__all__ = ["export_html"]

FRAMES = 400  # at most
NUMBERS = 1_500_000  # in the page, about: three coordinates and three quantities a point


def export_html(result: Result, path: str | os.PathLike[str], color: Any = None) -> None:
    """Write the page; see :meth:`pliant.Result.export_html`."""
    frames = frames_of(result, FRAMES)
    points = int(np.clip(NUMBERS // (6 * len(frames)), 200, 4000))
    bodies = []
    for drawing in draw(result, frames, color, points):
        bodies.append(
            {
                "name": drawing.name,
                "strands": drawing.strands.tolist(),
                "points": _packed(drawing.points),
                "values": {name: _packed(values) for name, values in drawing.values.items()},
                "radius": drawing.radius,
            }
        )
    shown = color if isinstance(color, str) else "" if color is None else "color"
    data = {
        "time": result.time[frames].tolist(),
        "unit": "load factor" if result.is_static else "s",
        "labels": {**COLORS, "color": "given values"},
        "color": shown,
        "up": [0, 0, 1],
        "bodies": bodies,
    }
    template = resources.files("pliant").joinpath("_viewer.html").read_text(encoding="utf-8")
    names = ", ".join(body["name"] for body in bodies)
    page = template.replace("{{title}}", html.escape(f"pliant: {names}"))
    page = page.replace("{{data}}", json.dumps(data).replace("</", "<\\/"))
    with atomic(path) as temporary:
        temporary.write_text(page, encoding="utf-8")


def _packed(values: FloatArray) -> str:
    """Little-endian float32 in base64."""
    return base64.b64encode(values.astype("<f4").tobytes()).decode("ascii")
