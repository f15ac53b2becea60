"""Results as HDF5 files: what stands in them beside the rows, saving, loading. Layout: docs/files.md."""

from __future__ import annotations

import dataclasses
import json
import os
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any
from urllib.parse import quote

import numpy as np

from pliant._lookup import Lookup
from pliant._lowered import Lowered
from pliant.beams import BeamBody
from pliant.bodies import LineBody
from pliant.errors import FileError
from pliant.files import atomic
from pliant.model import Model
from pliant.readings import Statistics
from pliant.records import Records
from pliant.result import Result
from pliant.streams import FORMAT, SIGNATURE, VERSION, Stream, h5py_module, open_result, read_records
from pliant.surfaces import SurfaceBody

__all__ = ["facts", "is_result", "load", "load_records", "save"]

ROWS = ("records/", "blocks/", "history", "patches", "statistics")


def facts(rows: Lookup, *, static: bool) -> dict[str, Any]:
    """Everything of a result file but its rows: attributes (``"@name"``) and data sets by name."""
    lowered = rows._lowered
    texts = {
        "model": json.dumps(rows.model.to_document(keep_functions=False)),
        "lowered/spec": lowered.spec,
        "lowered/map": json.dumps(lowered.to_map()),
    }
    data: dict[str, Any] = {
        name: np.frombuffer(text.encode(), dtype=np.uint8) for name, text in texts.items()
    }
    data |= {f"lowered/arrays/{k}": array for k, array in enumerate(lowered.arrays)}
    for name in lowered.bodies:
        body = rows.model._bodies[name]
        offsets = rows._offsets(name)[:, 0]
        data[f"offsets/{quote(name, safe='').replace('.', '%2E')}"] = (
            offsets[body.first]
            if isinstance(body, LineBody)
            else offsets[:: body.vectors]
            if isinstance(body, SurfaceBody)
            else offsets[::4]
            if isinstance(body, BeamBody)
            else offsets[:1]
        )
    return {
        **data,
        "@format": FORMAT,
        "@version": VERSION,
        "@kind": "static" if static else "dynamic",
        "@digest": _digest(data.items()),
    }


def _digest(data: Any) -> str:
    import hashlib

    digest = hashlib.sha256()
    for name, array in sorted(data, key=lambda item: str(item[0])):
        digest.update(name.encode())
        digest.update(np.ascontiguousarray(array).tobytes())
    return digest.hexdigest()


def save(result: Result, path: str | os.PathLike[str]) -> None:
    """Write a result."""
    fixed = facts(result, static=result.is_static)
    records = result._records
    with atomic(path) as temporary:
        stream = Stream(temporary, fixed, records[:0])
        step = max(1, (1 << 22) // max(8 * records.q.shape[1], 1))
        for k in range(0, len(records.time), step):
            stream.add(records[k : k + step])
        stream.flush(dataclasses.asdict(result.statistics))
        stream.close()


def _fixed(h5py: Any, file: Any) -> Iterator[tuple[str, Any]]:
    names: list[str] = []
    file.visititems(lambda name, item: names.append(name) if isinstance(item, h5py.Dataset) else None)
    return ((name, file[name][()]) for name in names if not name.startswith(ROWS))


def is_result(path: str | os.PathLike[str]) -> bool:
    """Tell whether a file begins as HDF5 does."""
    try:
        with Path(path).open("rb") as file:
            return file.read(8) == SIGNATURE
    except (OSError, ValueError):
        return False


def load(path: str | os.PathLike[str]) -> Result:
    """Read a result; its rows at once where they are few, else when asked for."""

    def read(file: Any) -> Result:
        def text(name: str) -> Any:
            return json.loads(bytes(file[name][()]).decode())

        count = len(file.get("lowered/arrays", ()))
        arrays = [file[f"lowered/arrays/{k}"][()] for k in range(count)]
        lowered = Lowered.from_map(text("lowered/map"), text("lowered/spec"), arrays, [])
        return Result(
            Model.from_document(text("model"), str(path)),
            lowered,
            read_records(path, file),
            static=file.attrs["kind"] == "static",
            statistics=Statistics(**text("statistics")),
        )

    result: Result = _reading(path, read)
    return result


def load_records(path: str | os.PathLike[str], rows: int | None = None) -> Records:
    """Read the rows of a result alone, at most so many."""
    records: Records = _reading(path, lambda file: read_records(path, file, rows))
    return records


def _reading(path: str | os.PathLike[str], read: Any) -> Any:
    """Open a file, check it, and read something of it."""
    if not isinstance(path, (str, os.PathLike)):
        raise FileError(f"{path!r}: must be the path of a result")
    h5py = h5py_module()
    try:
        with open_result(path) as file:
            attributes: Mapping[str, Any] = file.attrs
            if attributes.get("format") != FORMAT:
                raise FileError(f"{path}: is not a pliant result")
            if attributes.get("version") != VERSION:
                raise FileError(
                    f"{path}: has version {attributes.get('version')}, this pliant reads {VERSION}"
                )
            if attributes.get("digest") != _digest(_fixed(h5py, file)):
                raise FileError(f"{path}: is damaged: its contents do not match their digest")
            return read(file)
    except FileError:
        raise
    except FileNotFoundError as error:
        raise FileError(f"{path}: there is no such file") from error
    except (OSError, KeyError, ValueError, TypeError, RuntimeError, AttributeError) as error:
        raise FileError(f"{path}: cannot be read: {error}") from error
