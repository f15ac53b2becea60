"""Checkpoints: a run in a file, from which it continues with the same bits.

A line that names format and version, the SHA-256 of the rest, and a NumPy archive of the model and the core's
document (JSON text), the bytes of the core's state, and what was recorded. Files are written beside and then
put in place: whenever a run is killed, the last whole checkpoint stays.
"""

from __future__ import annotations

import dataclasses
import hashlib
import io
import json
import os
import zipfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from pliant._lowered import Input, Lowered
from pliant.errors import FileError, ModelError
from pliant.files import atomic
from pliant.model import Model
from pliant.records import Records
from pliant.typing import Json

__all__ = ["Checkpoint", "read", "write"]

FORMAT, VERSION = b"pliant-checkpoint", b"1"


@dataclass
class Checkpoint:
    """What a file holds: the run, the saved state of the core at the start and now, and what was recorded.

    ``options`` are those of the stepper, ``run`` the plan of ``simulate`` or None.
    """

    model: Model
    lowered: Lowered
    options: Json
    run: Json | None
    start: bytes
    saved: bytes
    records: Records


def write(path: str | os.PathLike[str], checkpoint: Checkpoint) -> None:
    """Write a checkpoint."""
    lowered = checkpoint.lowered
    facts = {
        "model": checkpoint.model.to_document(keep_functions=False),
        "options": checkpoint.options,
        "run": checkpoint.run,
        "lowered": {
            "document": lowered.document,
            "inputs": [[one.load, one.first, one.size] for one in lowered.inputs],
            "held": lowered.held,
            "cables": lowered.cables,
            "shared": lowered.shared,
            "plan": lowered.plan,
            "coordinates": lowered.coordinates,
            "multipliers": lowered.multipliers,
        },
    }
    arrays: dict[str, Any] = {
        "facts": np.frombuffer(json.dumps(facts).encode(), dtype=np.uint8),
        "start": np.frombuffer(checkpoint.start, dtype=np.uint8),
        "saved": np.frombuffer(checkpoint.saved, dtype=np.uint8),
    }
    arrays |= {f"array{k}": array for k, array in enumerate(lowered.arrays)}
    arrays |= {f.name: getattr(checkpoint.records, f.name) for f in dataclasses.fields(Records)}
    buffer = io.BytesIO()
    np.savez(buffer, **arrays)
    contents = buffer.getbuffer()
    with atomic(path) as temporary, temporary.open("wb") as file:
        file.write(FORMAT + b" " + VERSION + b"\n" + hashlib.sha256(contents).digest())
        file.write(contents)


def read(path: str | os.PathLike[str]) -> Checkpoint:
    """Read a checkpoint."""
    if not isinstance(path, (str, os.PathLike)):
        raise FileError(f"{path!r}: must be the path of a checkpoint")
    try:
        contents = Path(os.fsdecode(path)).read_bytes()
    except FileNotFoundError as error:
        raise FileError(f"{path}: there is no such file") from error
    except (OSError, ValueError) as error:
        raise FileError(f"{path}: cannot be read: {error}") from error
    head, _, rest = contents.partition(b"\n")
    kind, _, version = head.partition(b" ")
    if kind != FORMAT:
        raise FileError(f"{path}: is not a checkpoint of pliant")
    if version != VERSION:
        raise FileError(f"{path}: has version {version[:20]!r}, this pliant reads {VERSION!r}")
    if hashlib.sha256(rest[32:]).digest() != rest[:32]:
        raise FileError(f"{path}: is damaged: its contents do not match their digest")
    try:
        with np.load(io.BytesIO(rest[32:]), allow_pickle=False) as archive:
            facts = json.loads(archive["facts"].tobytes().decode())
            lowered = facts["lowered"]
            count = sum(name.startswith("array") for name in archive.files)
            return Checkpoint(
                Model.from_document(facts["model"], str(path)),
                Lowered(
                    **{
                        **lowered,
                        "arrays": [archive[f"array{k}"] for k in range(count)],
                        "inputs": [Input(load, None, first, size) for load, first, size in lowered["inputs"]],
                        "held": {
                            name: (first, initial) for name, (first, initial) in lowered["held"].items()
                        },
                    }
                ),
                facts["options"],
                facts["run"],
                archive["start"].tobytes(),
                archive["saved"].tobytes(),
                Records(**{f.name: archive[f.name] for f in dataclasses.fields(Records)}),
            )
    except (OSError, KeyError, ValueError, TypeError, ModelError, zipfile.BadZipFile) as error:
        raise FileError(f"{path}: is damaged: {error}") from error
