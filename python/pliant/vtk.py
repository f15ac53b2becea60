"""Files for ParaView, written by meshio: one ``.pvd`` lists a ``.vtu`` for each time and kind of thing."""

from __future__ import annotations

import os
import xml.etree.ElementTree as ElementTree
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, Any

import numpy as np

from pliant import _check
from pliant.drawing import Drawing, Lines, Marker, Solid, Surface, arrows, draw
from pliant.errors import FileError
from pliant.files import atomic
from pliant.scenery import Scenery, scenery
from pliant.typing import FloatArray, IntArray

if TYPE_CHECKING:
    from pliant.result import Result

__all__ = ["export_vtk"]

BLOCK = 64  # outputs in memory at a time
PARTS: dict[str, type[Drawing]] = {"lines": Lines, "surfaces": Surface, "solids": Solid, "points": Marker}


def _meshio() -> ModuleType:
    try:
        import meshio
    except ImportError as error:
        raise ImportError('files for ParaView need meshio: pip install "pliant[vtk]"') from error
    return meshio  # type: ignore[no-any-return]


def export_vtk(result: Result, folder: str | os.PathLike[str]) -> Path:
    """Write the files; see :meth:`pliant.Result.export_vtk`."""
    _meshio()
    if not isinstance(folder, (str, os.PathLike)) or not os.fspath(folder):
        _check.fail("folder", folder, "must be the path of a folder")
    place = Path(os.fsdecode(folder))
    try:
        place.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise FileError(f"{place}: cannot be written: {error}") from error
    root = ElementTree.Element("VTKFile", type="Collection", version="1.0", byte_order="LittleEndian")
    collection = ElementTree.SubElement(root, "Collection")
    digits = len(str(max(len(result.time) - 1, 1)))
    obstacles = scenery(result)[1] if result.model._obstacles else []
    if obstacles:
        _write(place / "obstacles.vtu", _standing(obstacles, list(result.model._obstacles)))
    numbers = {name: k for k, name in enumerate(result.model._bodies)}
    for first in range(0, len(result.time), BLOCK):
        frames = np.arange(first, min(first + BLOCK, len(result.time)))
        drawings = draw(result, frames, points=1)
        vectors = arrows(result, frames)
        for k, output in enumerate(frames):
            parts = {part: [d for d in drawings if isinstance(d, kind)] for part, kind in PARTS.items()}
            pieces = {part: _joined(some, k, numbers) for part, some in parts.items() if some}
            if any(one.kind != "contact" or one.vectors[k].any() for one in vectors):
                pieces["forces"] = _forces(vectors, k)
            names = {part: f"{part}_{int(output):0{digits}d}.vtu" for part in pieces}
            for part, piece in pieces.items():
                _write(place / names[part], piece)
            # The obstacles stand in a single file, which belongs to every time.
            names |= {"obstacles": "obstacles.vtu"} if obstacles else {}
            for number, (part, name) in enumerate(names.items()):
                entry = {"timestep": repr(float(result.time[output])), "part": str(number), "file": name}
                ElementTree.SubElement(collection, "DataSet", {**entry, "group": "", "name": part})
    ElementTree.indent(root)
    target = place / "result.pvd"
    with atomic(target) as temporary:
        ElementTree.ElementTree(root).write(temporary, encoding="utf-8", xml_declaration=True)
    return target


def _write(path: Path, piece: dict[str, Any]) -> None:
    """Write one mesh."""
    meshio = _meshio()
    with atomic(path) as temporary:
        meshio.write(temporary, meshio.Mesh(**piece), file_format="vtu")


def _standing(obstacles: list[Scenery], names: list[str]) -> dict[str, Any]:
    """Join obstacles to one mesh; ``obstacle`` numbers them in the order of the model."""
    sizes = [len(one.points) for one in obstacles]
    starts = np.cumsum([0, *sizes[:-1]])
    triangles = [one.triangles + start for one, start in zip(obstacles, starts, strict=True)]
    numbers = np.repeat([float(names.index(one.name)) for one in obstacles], sizes)
    fields = {"obstacle": numbers, "Normals": np.concatenate([one.normals for one in obstacles])}
    points = np.concatenate([one.points for one in obstacles])
    return {"points": points, "cells": [("triangle", np.concatenate(triangles))], "point_data": fields}


def _joined(drawings: list[Any], frame: int, numbers: dict[str, int]) -> dict[str, Any]:
    """Join bodies of one kind to one mesh; ``body`` numbers them in the order of the model."""
    points: list[FloatArray] = []
    cells: list[IntArray] = []
    fields: dict[str, list[FloatArray]] = {}
    count = 0
    for drawing in drawings:
        here = drawing.at(frame) if isinstance(drawing, Solid) else drawing.points[frame]
        n = len(here)
        if isinstance(drawing, Lines):
            corners = np.stack([drawing.pieces, drawing.pieces + 1], axis=1)
        elif isinstance(drawing, Marker):
            corners = np.arange(n)[:, None]
        else:
            corners = drawing.triangles
        values = {key: rows[frame] for key, rows in drawing.values.items()}
        values["body"] = np.full(n, float(numbers[drawing.name]))
        if isinstance(drawing, Lines):
            values["radius"] = np.full(n, drawing.radius)
        if isinstance(drawing, Solid):
            for axis, name in enumerate(("axis_x", "axis_y", "axis_z")):
                values[name] = np.tile(drawing.axes[frame, axis], (n, 1))
        for key, rows in values.items():
            fields.setdefault(key, []).append(rows)
        points.append(here)
        cells.append(corners + count)
        count += n
    kind = {1: "vertex", 2: "line", 3: "triangle"}[cells[0].shape[1]]
    # Every point of a file has the same fields: those that all its bodies have.
    shared = {key: np.concatenate(rows) for key, rows in fields.items() if len(rows) == len(drawings)}
    return {"points": np.concatenate(points), "cells": [(kind, np.concatenate(cells))], "point_data": shared}


def _forces(vectors: list[Any], frame: int) -> dict[str, Any]:
    """Give forces and reactions as vectors at points."""
    # Of contact only what presses at this time.
    vectors = [one for one in vectors if one.kind != "contact" or one.vectors[frame].any()]
    data = {
        "force": np.array([one.vectors[frame] for one in vectors]).reshape(-1, 3),
        "moment": np.array([one.moments[frame] for one in vectors]).reshape(-1, 3),
        "is_reaction": np.array([float(one.kind == "reaction") for one in vectors]),
        "is_contact": np.array([float(one.kind == "contact") for one in vectors]),
    }
    feet = np.array([one.feet[frame] for one in vectors]).reshape(-1, 3)
    return {"points": feet, "cells": [("vertex", np.arange(len(feet))[:, None])], "point_data": data}
