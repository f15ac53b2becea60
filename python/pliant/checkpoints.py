"""Checkpoints: a run in a file, from which it continues with the same bits.

A line that names format and version, the SHA-256 of the rest, and a NumPy archive of the model and the core's
document (JSON text), the bytes of the core's state, the present row, and what was recorded, or the result
file and the number of its rows that hold it. Files are written beside and then put in place: whenever a run
is killed, the last whole checkpoint stays.
"""

from __future__ import annotations

import dataclasses
import io
import json
import os
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from pliant._lowered import Input, Lowered
from pliant.errors import FileError, ModelError
from pliant.files import atomic
from pliant.model import Model
from pliant.readings import Statistics
from pliant.records import Records, State
from pliant.result import Result
from pliant.storage import load_records
from pliant.typing import Json

__all__ = ["Checkpoint", "read", "write"]

FORMAT, VERSION = b"pliant-checkpoint", b"2"


@dataclass
class Checkpoint:
    """What a file holds: the run, the saved state of the core at the start and now, and what was recorded.

    ``options`` are those of the stepper, ``run`` the plan of ``simulate`` or None, ``output`` the file that
    holds what was recorded, and how many rows, where it is not here.
    """

    model: Model
    lowered: Lowered
    options: Json
    run: Json | None
    start: bytes
    saved: bytes
    present: Records
    records: Records
    output: tuple[str, int] | None = None

    @property
    def state(self) -> State:
        """State from which another run can begin."""
        here = Result(self.model, self.lowered, self.present, static=False, statistics=Statistics())
        return dataclasses.replace(here.state(0), saved=self.saved)

    def recorded(self) -> Records:
        """Return what was recorded, here or in the result file."""
        return self.records if self.output is None else load_records(*self.output)


def write(path: str | os.PathLike[str], checkpoint: Checkpoint) -> None:
    """Write a checkpoint."""
    lowered = checkpoint.lowered
    facts = {
        "model": checkpoint.model.to_document(keep_functions=False),
        "options": checkpoint.options,
        "run": checkpoint.run,
        "output": checkpoint.output,
        "document": lowered.document,
        "map": lowered.to_map(),
        "inputs": [[one.load, one.first, one.size] for one in lowered.inputs],
    }
    arrays: dict[str, Any] = {
        "facts": np.frombuffer(json.dumps(facts).encode(), dtype=np.uint8),
        "start": np.frombuffer(checkpoint.start, dtype=np.uint8),
        "saved": np.frombuffer(checkpoint.saved, dtype=np.uint8),
    }
    arrays |= {f"array{k}": array for k, array in enumerate(lowered.arrays)}
    for place in ("present", "records"):
        rows: Records = getattr(checkpoint, place)
        arrays |= {f"{place}.{name}": np.asarray(column) for name, column in rows.columns()}
        arrays[f"{place}.history"] = rows.history
        arrays[f"{place}.patches"] = np.asarray(rows.patches)
    from hashlib import sha256

    buffer = io.BytesIO()
    np.savez(buffer, **arrays)
    contents = buffer.getbuffer()
    with atomic(path) as temporary, temporary.open("wb") as file:
        file.write(FORMAT + b" " + VERSION + b"\n" + sha256(contents).digest())
        file.write(contents)


def read(path: str | os.PathLike[str]) -> Checkpoint:
    """Read a checkpoint."""
    from hashlib import sha256
    from zipfile import BadZipFile

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
    if sha256(rest[32:]).digest() != rest[:32]:
        raise FileError(f"{path}: is damaged: its contents do not match their digest")
    try:
        with np.load(io.BytesIO(rest[32:]), allow_pickle=False) as archive:
            facts = json.loads(archive["facts"].tobytes().decode())

            def rows(place: str) -> Records:
                names = [entry.name for entry in dataclasses.fields(Records)]
                return Records(**{name: archive[f"{place}.{name}"] for name in names})

            count = sum(name.startswith("array") for name in archive.files)
            return Checkpoint(
                Model.from_document(facts["model"], str(path)),
                Lowered.from_map(
                    facts["map"],
                    facts["document"],
                    [archive[f"array{k}"] for k in range(count)],
                    [Input(load, None, first, size) for load, first, size in facts["inputs"]],
                ),
                facts["options"],
                facts["run"],
                archive["start"].tobytes(),
                archive["saved"].tobytes(),
                rows("present"),
                rows("records"),
                None if facts["output"] is None else (str(facts["output"][0]), int(facts["output"][1])),
            )
    except (OSError, KeyError, ValueError, TypeError, ModelError, BadZipFile) as error:
        raise FileError(f"{path}: is damaged: {error}") from error
