"""Results as polylines: what the pictures and the page are drawn from."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from pliant import _check
from pliant.bodies import LineBody, hermite
from pliant.rigid import RigidBodyData
from pliant.shapes import Shape
from pliant.typing import FloatArray, IntArray

if TYPE_CHECKING:
    from pliant.result import Result

__all__ = ["COLORS", "Drawing", "draw", "frames_of"]

COLORS = {"strain": "axial strain", "axial_force": "axial force [N]", "speed": "speed [m/s]"}


@dataclass(frozen=True)
class Drawing:
    """One body as polylines.

    Attributes
    ----------
    points : (frames, p, 3)
        Points along the strands [m], one strand after the other; a single point for a mass.
    strands : (k,)
        Number of points of each strand.
    values : dict of (frames, p)
        Quantities by name.
    """

    name: str
    points: FloatArray
    strands: IntArray
    values: dict[str, FloatArray]
    radius: float


def frames_of(result: Result, most: int) -> IntArray:
    """Choose the outputs to draw: at most so many, the first and the last among them, even in time."""
    n = len(result.time)
    if n <= most:
        return np.arange(n)
    wanted = np.linspace(result.time[0], result.time[-1], most)
    return np.unique(np.clip(np.searchsorted(result.time, wanted - 1e-12), 0, n - 1))


def draw(result: Result, frames: IntArray, color: Any = None, points: int = 4000) -> list[Drawing]:
    """Every body at these outputs, with about so many points of lines in all.

    ``color`` may be a name, or (n, nodes) values of the only body; these come under the name ``"color"``.
    """
    if color is not None and not isinstance(color, str):
        lines = [name for name, body in result.model._bodies.items() if isinstance(body, LineBody)]
        if len(lines) != 1:
            _check.fail("color", color, f"an array colours a single cable, and the model has {len(lines)}")
        nodes = result.model._bodies[lines[0]].nodes  # type: ignore[union-attr]
        color = _check.array(color, "color", (len(result.time), nodes))
    elif color is not None:
        _check.choice(color, "color", COLORS)
    elements = sum(b.elements for b in result.model._bodies.values() if isinstance(b, LineBody))
    fine = int(np.clip(points // max(elements, 1), 1, 8))
    drawings = []
    for name, body in result.model._bodies.items():
        if isinstance(body, LineBody):
            drawings.append(_line(result, name, body, frames, fine, color))
        elif isinstance(body, RigidBodyData) and body.shape is not None:
            drawings.append(_rigid(result, name, body.shape, frames))
        else:
            place = result.positions(name)[frames]
            speed = np.linalg.norm(result.velocities(name)[frames], axis=2)
            drawings.append(Drawing(name, place, np.array([1]), {"speed": speed}, 0.0))
    return drawings


def _rigid(result: Result, name: str, shape: Shape, frames: IntArray) -> Drawing:
    """Outline of a rigid body."""
    outline = np.concatenate(shape.outline)
    weights = np.column_stack([np.ones(len(outline)), outline])
    index = result._offsets(name) + np.arange(3)
    points, speeds = (
        np.einsum("pi,nik->npk", weights, rows[frames][:, index])
        for rows in (result._records.q, result._records.v)
    )
    strands = np.array([len(line) for line in shape.outline])
    return Drawing(name, points, strands, {"speed": np.linalg.norm(speeds, axis=2)}, 0.0)


def _line(result: Result, name: str, body: LineBody, frames: IntArray, fine: int, color: Any) -> Drawing:
    """Polylines of a cable or a net, ``fine`` pieces an element."""
    offsets = result._offsets(name)[:, :, None] + np.arange(3)
    first = body.element_nodes
    x = np.arange(fine) / fine
    shape = hermite(x[None, :], body.lengths[:, None])
    ends = np.cumsum(body.strands + 1) - 1
    strands = body.strands * fine + 1
    last = np.cumsum(strands) - 1
    inner = np.setdiff1d(np.arange(int(strands.sum())), last)

    def spread(rows: FloatArray) -> FloatArray:
        values = sum(
            shape[k][None, :, :, None] * rows[:, offsets[first + k // 2, k % 2]][:, :, None, :]
            for k in range(4)
        )
        out = np.empty((len(rows), int(strands.sum()), 3))
        out[:, inner] = np.asarray(values).reshape(len(rows), -1, 3)
        out[:, last] = rows[:, offsets[ends, 0]]
        return out

    def by_element(rows: FloatArray) -> FloatArray:
        out = np.empty((len(rows), int(strands.sum())))
        out[:, inner] = np.repeat(rows, fine, axis=1)
        out[:, last] = rows[:, np.cumsum(body.strands) - 1]
        return out

    records = result._records
    force = result._system.axial_force(result._lowered.cables[name], records.q[frames])
    strain = result._system.strain(result._lowered.cables[name], records.q[frames])[0]
    values = {
        "strain": by_element(strain),
        "axial_force": by_element(force),
        "speed": np.linalg.norm(spread(records.v[frames]), axis=2),
    }
    if isinstance(color, np.ndarray):
        nodes = color[frames][:, body.users]
        out = np.empty((len(frames), int(strands.sum())))
        mixed = (1 - x) * nodes[:, first, None] + x * nodes[:, first + 1, None]
        out[:, inner] = mixed.reshape(len(frames), -1)
        out[:, last] = nodes[:, ends]
        values["color"] = out
    return Drawing(name, spread(records.q[frames]), strands, values, float(body.radius.mean()))
