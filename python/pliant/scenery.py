"""What stands still in a scene: grounds, walls and other obstacles, as far as the bodies get."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from pliant.centreline import hermite
from pliant.contacts import Bore, HalfSpace, ObstacleData, TriangleMesh, frame
from pliant.drawing import Drawing, Solid, draw, frames_of
from pliant.shapes import RING, Shape, Surface
from pliant.typing import FloatArray, IntArray

if TYPE_CHECKING:
    from pliant.result import Result

__all__ = ["Extent", "Scenery", "extent_of", "scenery", "spacing"]

BEYOND = 0.25  # obstacles are shown so far beyond the bodies, over the size of all motion
LEAST = 0.15  # edge of the box across flat motion, over the size
MARGIN = 0.02  # of the box on each side
FRAMES = 60  # outputs, at most, that tell how far bodies get


class Extent(NamedTuple):
    """Lowest and highest corner of a box along the axes of the world, (3,) each [m]."""

    low: FloatArray
    high: FloatArray

    @property
    def size(self) -> float:
        """Longest edge [m]."""
        return float((self.high - self.low).max())

    def grown(self, by: float) -> Extent:
        """Give the box with every side moved outwards [m]."""
        return Extent(self.low - by, self.high + by)


@dataclass(frozen=True, eq=False)
class Scenery:
    """A fixed obstacle in the world, cut off at the edge of the picture.

    Attributes
    ----------
    kind : {"plane", "solid", "mesh", "bore"}
        What it is: a half-space is drawn as a piece of its plane with a grid, a bore as its wall.
    points, normals : (p, 3)
        Points [m] and unit normals towards the bodies.
    triangles : (t, 3)
        Corners, counter-clockwise seen from the bodies.
    lines : (k, 2, 3)
        Straight pieces of edges, outlines, or the grid [m].
    """

    name: str
    kind: str
    points: FloatArray
    normals: FloatArray
    triangles: IntArray
    lines: FloatArray


def extent_of(drawings: Sequence[Drawing]) -> Extent:
    """Give the box that the bodies keep to in these drawings."""
    places = [_places(drawing) for drawing in drawings]
    return Extent(
        np.min([one.min(axis=0) for one in places], axis=0),
        np.max([one.max(axis=0) for one in places], axis=0),
    )


def _places(drawing: Drawing) -> FloatArray:
    """Points of a body at all times, (n, 3)."""
    if isinstance(drawing, Solid):
        corners = np.concatenate(drawing.outline)
        world = drawing.place[:, None] + np.einsum("pk,nki->npi", corners, drawing.axes)
        return np.asarray(world.reshape(-1, 3))
    return np.asarray(drawing.points.reshape(-1, 3))


def scenery(result: Result, motion: Extent | None = None) -> tuple[Extent, list[Scenery]]:
    """Find the obstacles near the bodies, cut off at a box around both.

    Parameters
    ----------
    result : Result
        Its model has the obstacles.
    motion : Extent, optional
        How far the bodies get; None: looked up at 60 outputs, or all.

    Returns
    -------
    extent : Extent
        What a picture shows: the box of the bodies, grown by what obstacles reach beyond it, at most by a
        quarter of its size, and by a margin.
    scenery : list of Scenery
        The obstacles that are in it.
    """
    if motion is None:
        motion = extent_of(draw(result, frames_of(result, FRAMES), points=1))
    reach = BEYOND * max(motion.size, 1e-9)
    obstacles = list(result.model._obstacles.values())
    low, high = motion
    for obstacle in obstacles:
        if isinstance(obstacle.shape, HalfSpace):
            # The box is drawn out until the plane touches it.
            normal = _normal(obstacle, obstacle.shape)
            gap = float((np.where(normal > 0, motion.low, motion.high) - obstacle.position) @ normal)
            if 0.0 < gap <= reach:
                low = np.minimum(low, motion.low - gap * normal)
                high = np.maximum(high, motion.high - gap * normal)
        else:
            points = _clipped(_look(obstacle, obstacle.shape)[1], motion.grown(reach)).points
            low, high = np.min([low, *points], axis=0), np.max([high, *points], axis=0)
    middle, edges = (low + high) / 2, high - low
    half = (0.5 + MARGIN) * np.maximum(edges, LEAST * max(float(edges.max()), 1e-9))
    extent = Extent(middle - half, middle + half)
    shown = []
    for obstacle in obstacles:
        if isinstance(obstacle.shape, HalfSpace):
            kind, surface, lines = _plane(obstacle, obstacle.shape, extent)
        else:
            kind, surface, lines = _look(obstacle, obstacle.shape, beyond=4 * extent.size)
        surface = _clipped(surface, extent)
        if len(surface.triangles):
            shown.append(Scenery(obstacle.name, kind, *surface, _cut(lines, extent)))
    return extent, shown


def spacing(extent: Extent) -> float:
    """Distance of the lines of a grid [m]: 1, 2 or 5 times a power of ten."""
    rough = extent.size / 10
    power = 10.0 ** np.floor(np.log10(rough))
    return float(power * max(k for k in (1, 2, 5) if k * power <= rough * (1 + 1e-9)))


def _normal(obstacle: ObstacleData, shape: HalfSpace) -> FloatArray:
    """Turn the normal of a half-space into the world."""
    normal: FloatArray = obstacle.axes.T @ shape.normal
    return normal


def _plane(obstacle: ObstacleData, shape: HalfSpace, extent: Extent) -> tuple[str, Surface, FloatArray]:
    """Give a square piece of a plane that goes beyond the box, with a grid through the obstacle's place."""
    axes = frame(_normal(obstacle, shape))
    step = spacing(extent)
    middle = np.rint(axes[:2] @ ((extent.low + extent.high) / 2 - obstacle.position) / step)
    n = int(np.ceil(2 * extent.size / step))
    across = np.arange(-n, n + 1)[:, None] * [1, 1]
    along = np.broadcast_to([-n, n], across.shape)
    grid = np.stack([np.stack([across, along], axis=-1), np.stack([along, across], axis=-1)]).reshape(
        -1, 2, 2
    )
    square = n * np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)])
    points, lines = (obstacle.position + step * (middle + x) @ axes[:2] for x in (square, grid))
    return "plane", Surface(points, np.tile(axes[2], (4, 1)), np.array([(0, 1, 2), (0, 2, 3)])), lines


def _look(
    obstacle: ObstacleData, shape: Shape | TriangleMesh | Bore, beyond: float = 0.0
) -> tuple[str, Surface, FloatArray]:
    """Give kind, surface and lines of a shape; a bore goes on straight ``beyond`` its ends [m]."""
    if isinstance(shape, Bore):
        kind, (surface, lines) = "bore", _bore(shape, beyond)
    elif isinstance(shape, TriangleMesh):
        kind, (surface, lines) = "mesh", _mesh(shape)
    else:
        kind, surface = "solid", shape.surface
        lines = np.concatenate([_pieces(line) for line in shape.outline])
    points, lines = (obstacle.position + x @ obstacle.axes for x in (surface.points, lines))
    return kind, Surface(points, surface.normals @ obstacle.axes, surface.triangles), lines


def _pieces(line: FloatArray) -> FloatArray:
    """Straight pieces (k - 1, 2, 3) of a line (k, 3)."""
    return np.stack([line[:-1], line[1:]], axis=1)


def _mesh(mesh: TriangleMesh) -> tuple[Surface, FloatArray]:
    """Give triangles, each with its own normal, and all their edges."""
    corners = mesh.points[mesh.triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    own = np.arange(3 * len(corners)).reshape(-1, 3)
    edges = np.unique(np.sort(mesh.triangles[:, [(0, 1), (1, 2), (2, 0)]].reshape(-1, 2), axis=1), axis=0)
    return Surface(corners.reshape(-1, 3), np.repeat(normals, 3, axis=0), own), mesh.points[edges]


def _bore(bore: Bore, beyond: float) -> tuple[Surface, FloatArray]:
    """Give the wall of a channel, seen from inside, with four lines along it and the rims at its ends."""
    fine = max(1, 64 // bore.pieces)
    element = np.append(np.repeat(np.arange(bore.pieces), fine), bore.pieces - 1)
    xi = np.append(np.tile(np.arange(fine) / fine, bore.pieces), 1.0)
    nodes = [bore.line[element], bore.tangents[element], bore.line[element + 1], bore.tangents[element + 1]]
    line = np.einsum("kn,kni->ni", hermite(xi, bore.lengths[element]), nodes)
    start, end = bore.tangents[0], bore.tangents[-1]
    tangents = np.concatenate([[start], line[2:] - line[:-2], [end]])
    if beyond:
        line = np.concatenate([[line[0] - beyond * start], line, [line[-1] + beyond * end]])
        tangents = np.concatenate([[start], tangents, [end]])
    tangents /= np.linalg.norm(tangents, axis=1, keepdims=True)
    sides = [frame(start)[0]]
    for tangent in tangents[1:]:
        # Carried along without a twist.
        side = sides[-1] - (sides[-1] @ tangent) * tangent
        sides.append(side / np.linalg.norm(side))
    across = np.stack([sides, np.cross(tangents, sides)])
    outwards = np.einsum("jk,kni->nji", RING[:-1, :2], across)
    points = line[:, None] + bore.radius * outwards
    around = outwards.shape[1]
    k, j = np.meshgrid(np.arange(len(line) - 1) * around, np.arange(around), indexing="ij")
    a, b = k + j, k + (j + 1) % around
    triangles = np.stack([a, a + around, b + around, a, b + around, b], axis=-1).reshape(-1, 3)
    rims = points[[1, -2] if beyond else [0, -1]][:, [*range(around), 0]]
    lines = [_pieces(one) for one in [*points[:, :: around // 4].transpose(1, 0, 2), *rims]]
    return Surface(points.reshape(-1, 3), -outwards.reshape(-1, 3), triangles), np.concatenate(lines)


def _clipped(surface: Surface, extent: Extent) -> Surface:
    """Cut off what is outside of a extent."""
    points, normals, triangles = surface
    if (points >= extent.low).all() and (points <= extent.high).all():
        return surface
    soup = np.concatenate([points, normals], axis=1)[triangles]  # (t, 3, 6)
    for axis in range(3):
        for bound, sign in ((extent.low, 1.0), (extent.high, -1.0)):
            depth = sign * (soup[:, :, axis] - bound[axis])
            inside = depth >= 0.0
            count = inside.sum(axis=1)
            kept = [soup[count == 3]]
            for alone, corners in ((1, (0, 3, 4)), (2, None)):
                # Turned so that the corner alone on its side comes first.
                some = count == alone
                odd = np.argmax(inside[some] == (alone == 1), axis=1)
                order = (odd[:, None] + np.arange(3)) % 3
                turned = np.take_along_axis(soup[some], order[:, :, None], axis=1)
                d = np.take_along_axis(depth[some], order, axis=1)
                share = d[:, :1] / (d[:, :1] - d[:, 1:])
                cut = turned[:, :1] + share[:, :, None] * (turned[:, 1:] - turned[:, :1])
                five = np.concatenate([turned, cut], axis=1)
                kept += [five[:, list(corners)]] if corners else [five[:, [3, 1, 2]], five[:, [3, 2, 4]]]
            soup = np.concatenate(kept)
    flat = soup.reshape(-1, 6)
    lengths = np.maximum(np.linalg.norm(flat[:, 3:], axis=1, keepdims=True), 1e-300)
    return Surface(flat[:, :3], flat[:, 3:] / lengths, np.arange(len(flat)).reshape(-1, 3))


def _cut(lines: FloatArray, extent: Extent) -> FloatArray:
    """Cut straight pieces (k, 2, 3) off at a extent."""
    start, way = lines[:, 0], lines[:, 1] - lines[:, 0]
    with np.errstate(divide="ignore", invalid="ignore"):
        enter, leave = ((side - start) / way for side in extent)
    level = way == 0.0
    outside = (level & ((start < extent.low) | (start > extent.high))).any(axis=1)
    first = np.where(level, 0.0, np.minimum(enter, leave)).max(axis=1).clip(min=0.0)
    last = np.where(level, 1.0, np.maximum(enter, leave)).min(axis=1).clip(max=1.0)
    kept = ~outside & (first < last)
    ends = np.stack([first, last], axis=1)[kept]
    cut: FloatArray = start[kept, None] + ends[:, :, None] * way[kept, None]
    return cut
