"""The interactive page: one self-contained HTML file that opens offline."""

from __future__ import annotations

import base64
import html
import json
import os
from importlib import resources
from typing import TYPE_CHECKING, Any

import numpy as np

from pliant.drawing import COLORS, Drawing, Lines, Marker, Solid, Surface, arrows, draw, frames_of, up_of
from pliant.files import atomic
from pliant.scenery import Scenery, extent_of, scenery, spacing
from pliant.typing import FloatArray, IntArray, Json

if TYPE_CHECKING:
    from pliant.result import Result

__all__ = ["export_html"]

FRAMES = 400  # at most
NUMBERS = 1_500_000  # in the page, about: three coordinates and three quantities a point
ARROWS = 60  # at most
LABELS = {**COLORS, "regime": "taut 0, wrinkled 1, slack 2", "color": "given values"}


def export_html(result: Result, path: str | os.PathLike[str], color: Any = None) -> None:
    """Write the page; see :meth:`pliant.Result.export_html`."""
    frames = frames_of(result, FRAMES)
    points = int(np.clip(NUMBERS // (6 * len(frames)), 200, 4000))
    drawings = draw(result, frames, color, points)
    extent, obstacles = scenery(result, extent_of(drawings))
    bodies = [_body(drawing) for drawing in drawings]
    shown = color if isinstance(color, str) else "" if color is None else "color"
    data = {
        "time": result.time[frames].tolist(),
        "unit": "load factor" if result.is_static else "s",
        "labels": LABELS,
        "color": shown,
        "up": up_of(result).tolist(),
        "gravity": float(np.linalg.norm(result.model.gravity)),
        "bodies": bodies,
        "grid": spacing(extent),
        "scenery": [_obstacle(obstacle) for obstacle in obstacles],
        "arrows": [
            {
                "name": arrow.name,
                "kind": arrow.kind,
                "feet": _floats(arrow.feet),
                "vectors": _floats(arrow.vectors),
            }
            for arrow in arrows(result, frames)[:ARROWS]
        ],
    }
    template = resources.files("pliant").joinpath("_viewer.html").read_text(encoding="utf-8")
    names = ", ".join(body["name"] for body in bodies)
    page = template.replace("{{title}}", html.escape(f"pliant: {names}"))
    page = page.replace("{{data}}", json.dumps(data).replace("</", "<\\/"))
    with atomic(path) as temporary:
        temporary.write_text(page, encoding="utf-8")


def _body(drawing: Drawing) -> Json:
    """Write what a body looks like; the page's script reads it."""
    entry: Json = {"name": drawing.name, "values": {}}
    if isinstance(drawing, Solid):
        # The speed of each point follows from the twelve rates.
        speed = drawing.values["speed"]
        entry["values"]["speed"] = {"low": float(speed.min()), "high": float(speed.max())}
        return {
            **entry,
            "kind": "solid",
            "points": _floats(drawing.points),
            "normals": _floats(drawing.normals),
            "triangles": _indices(drawing.triangles),
            "place": _floats(drawing.place),
            "axes": _floats(drawing.axes),
            "rates": _floats(drawing.rates),
        }
    entry["values"] = {key: _packed(values) for key, values in drawing.values.items() if key in LABELS}
    entry["points"] = _packed(drawing.points)
    if isinstance(drawing, Lines):
        return {**entry, "kind": "lines", "strands": drawing.strands.tolist(), "radius": drawing.radius}
    if isinstance(drawing, Surface):
        return {**entry, "kind": "surface", "triangles": _indices(drawing.triangles)}
    assert isinstance(drawing, Marker)
    return {**entry, "kind": "marker"}


def _obstacle(obstacle: Scenery) -> Json:
    """Write what stands still."""
    return {
        "name": obstacle.name,
        "kind": obstacle.kind,
        "points": _floats(obstacle.points),
        "normals": _floats(obstacle.normals),
        "triangles": _indices(obstacle.triangles),
        "lines": _floats(obstacle.lines),
    }


def _packed(values: FloatArray) -> Json:
    """Sixteen bits a number, between the least and the largest: 1.5e-5 of the range is below a pixel."""
    low, high = float(values.min()), float(values.max())
    step = (high - low) / 65535.0
    steps = np.zeros(values.shape) if step == 0.0 else np.rint((values - low) / step)
    return {"low": low, "step": step, "data": _base64(steps.astype("<u2"))}


def _floats(values: FloatArray) -> str:
    return _base64(values.astype("<f4"))


def _indices(values: IntArray) -> str:
    return _base64(values.astype("<u4"))


def _base64(array: Any) -> str:
    return base64.b64encode(np.ascontiguousarray(array).tobytes()).decode("ascii")
