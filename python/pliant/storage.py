"""Results as HDF5 files.

Layout (format "pliant-result", version 3)::

    /                     attributes format, version, kind ("dynamic" or "static"), digest
    /model                the model as a JSON document (text)
    /lowered/spec         the document of the core (text); /lowered/map how it maps to the model (JSON text)
    /lowered/arrays/<k>   the arrays that the document points at
    /records/time         (n,) [s] or load factors
    /records/q, v, a      (n, coordinates); /records/lambda (n, constraints); /records/energy (n, 5): kinetic,
                          elastic, gravitational, dissipated, work [J]; /records/inputs (n, inputs);
                          /records/outputs (n, numbers): what springs and other forces show
    /offsets/<body>       (nodes,) first of the three columns of q that hold each node's position; the name
                          of the body is percent-encoded
    /statistics           JSON text

``digest`` is the SHA-256 of all data sets in the order of their names: an altered file is refused.
"""

from __future__ import annotations

import dataclasses
import hashlib
import json
import os
from types import ModuleType
from typing import Any
from urllib.parse import quote

import numpy as np

from pliant._lowered import Lowered
from pliant.bodies import LineBody
from pliant.errors import FileError
from pliant.files import atomic
from pliant.model import Model
from pliant.readings import CriticalPoint, Statistics
from pliant.records import Records
from pliant.result import Result

__all__ = ["load", "save"]

VERSION = 3


def _h5py() -> ModuleType:
    try:
        import h5py
    except ImportError as error:
        raise ImportError('result files need h5py: pip install "pliant[files]"') from error
    return h5py  # type: ignore[no-any-return]


def save(result: Result, path: str | os.PathLike[str]) -> None:
    """Write a result."""
    h5py = _h5py()
    lowered, records = result._lowered, result._records
    texts = {
        "model": json.dumps(result.model.to_document(keep_functions=False)),
        "lowered/spec": lowered.spec,
        "lowered/map": json.dumps(
            {
                "cables": lowered.cables,
                "shared": lowered.shared,
                "rigid": lowered.rigid,
                "plan": lowered.plan,
                "forces": lowered.forces,
                "held": lowered.held,
                "grows": lowered.grows,
                "critical": [
                    [c.kind, c.index, c.load_factor, c.shape.tolist()] for c in result.critical_points
                ],
            }
        ),
        "statistics": json.dumps(dataclasses.asdict(result.statistics)),
    }
    arrays: dict[str, Any] = {f"lowered/arrays/{k}": a for k, a in enumerate(lowered.arrays)}
    for field in dataclasses.fields(records):
        arrays[f"records/{field.name.rstrip('_')}"] = getattr(records, field.name)
    for name in [*lowered.cables, *lowered.shared, *lowered.rigid]:
        body = result.model._bodies[name]
        offsets = result._offsets(name)[:, 0]
        arrays[f"offsets/{quote(name, safe='').replace('.', '%2E')}"] = (
            offsets[body.first] if isinstance(body, LineBody) else offsets[:1]
        )
    with atomic(path) as temporary, h5py.File(temporary, "w") as file:
        for name, text in texts.items():
            file[name] = np.frombuffer(text.encode(), dtype=np.uint8)
        for name, array in arrays.items():
            file[name] = array
        file.attrs["format"] = "pliant-result"
        file.attrs["version"] = VERSION
        file.attrs["kind"] = "static" if result.is_static else "dynamic"
        file.attrs["digest"] = _digest(h5py, file)


def _digest(h5py: Any, file: Any) -> str:
    names: list[str] = []
    file.visititems(lambda name, item: names.append(name) if isinstance(item, h5py.Dataset) else None)
    digest = hashlib.sha256()
    for name in sorted(names):
        digest.update(name.encode())
        digest.update(np.ascontiguousarray(file[name][()]).tobytes())
    return digest.hexdigest()


def load(path: str | os.PathLike[str]) -> Result:
    """Read a result."""
    h5py = _h5py()
    try:
        with h5py.File(path, "r") as file:
            if file.attrs.get("format") != "pliant-result":
                raise FileError(f"{path}: is not a pliant result")
            if file.attrs.get("version") != VERSION:
                raise FileError(
                    f"{path}: has version {file.attrs.get('version')}, this pliant reads {VERSION}"
                )
            if file.attrs.get("digest") != _digest(h5py, file):
                raise FileError(f"{path}: is damaged: its contents do not match their digest")

            def text(name: str) -> Any:
                return json.loads(bytes(file[name][()]).decode())

            mapping = text("lowered/map")
            lowered = Lowered(
                document=text("lowered/spec"),
                arrays=[file[f"lowered/arrays/{k}"][()] for k in range(len(file.get("lowered/arrays", ())))],
                cables=mapping["cables"],
                shared=mapping["shared"],
                rigid=mapping.get("rigid", {}),
                plan=mapping["plan"],
                forces=mapping["forces"],
                grows=mapping.get("grows"),
                held={name: (first, initial) for name, (first, initial) in mapping["held"].items()},
            )
            records = Records(
                **{
                    field.name: file[f"records/{field.name.rstrip('_')}"][()]
                    for field in dataclasses.fields(Records)
                }
            )
            result = Result(
                Model.from_document(text("model"), str(path)),
                lowered,
                records,
                static=file.attrs["kind"] == "static",
                statistics=Statistics(**text("statistics")),
            )
            result.critical_points = tuple(
                CriticalPoint(kind, index, factor, np.array(shape))
                for kind, index, factor, shape in mapping.get("critical", ())
            )
            return result
    except FileError:
        raise
    except FileNotFoundError as error:
        raise FileError(f"{path}: there is no such file") from error
    except (OSError, KeyError, ValueError, TypeError, RuntimeError) as error:
        raise FileError(f"{path}: cannot be read: {error}") from error
