"""Result files that grow: rows go to disk in blocks, and are read back a block at a time.

The file is HDF5, written in its single-writer mode ("SWMR"): what was flushed can be read at any time, by
another process, too, and after the writing one was killed. docs/files.md tells the layout. A block of rows
counts from the moment its end and its digests stand in ``/blocks``; rows behind the last block are ignored.
"""

from __future__ import annotations

import json
import os
import time
from collections.abc import Iterator, Mapping
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np

from pliant.errors import FileError
from pliant.files import atomic
from pliant.records import PATCH, Records, Rows
from pliant.typing import FloatArray, IntArray

__all__ = ["FORMAT", "SIGNATURE", "VERSION", "Stream", "h5py_module", "open_result", "read_records"]

FORMAT, VERSION = "pliant-result", 6
SIGNATURE = b"\x89HDF\r\n\x1a\n"
BLOCK = 1 << 22  # bytes of rows in memory before they go to disk
SECONDS = 2.0  # or the time after which they do
IN_MEMORY = 1 << 25  # bytes of rows below which a file is read whole
NOTES = 4096  # bytes of the statistics
DIGEST = 16  # bytes

COLUMNS: Mapping[str, tuple[str, str]] = {
    "time": ("time, or load factor of a static result", "s"),
    "q": ("coordinates: positions [m], slopes and axes of rigid bodies [1]", "m, 1"),
    "v": ("rates of the coordinates", "m/s, 1/s"),
    "a": ("second rates of the coordinates", "m/s^2, 1/s^2"),
    "lambda_": ("multipliers of the constraints", "N, N m"),
    "energy": ("kinetic, elastic, gravitational, dissipated energy and work", "J"),
    "inputs": ("values of the inputs", ""),
    "outputs": ("what springs and other forces show", ""),
    "switches": ("rows of history before each output", ""),
    "touching": ("rows of patches of each output", ""),
}


def h5py_module() -> ModuleType:
    """Import h5py, or say how to get it."""
    try:
        import h5py
    except ImportError as error:
        raise ImportError('result files need h5py: pip install "pliant[files]"') from error
    return h5py  # type: ignore[no-any-return]


def open_result(path: str | os.PathLike[str]) -> Any:
    """Open a file for reading; one that is being written, or whose writer was killed, says so in its head."""
    h5py = h5py_module()
    with Path(path).open("rb") as file:
        head = file.read(12)
    if len(head) < 12 or head[:8] != SIGNATURE:
        raise FileError(f"{path}: is not a pliant result")
    growing = head[8] >= 3 and bool(head[11] & 4)
    return h5py.File(path, "r", libver="latest", swmr=growing, locking="best-effort")


def _digest(rows: FloatArray) -> bytes:
    import hashlib

    return hashlib.blake2b(np.ascontiguousarray(rows).tobytes(), digest_size=DIGEST).digest()


class Stream:
    """A result file that is written row by row.

    Parameters
    ----------
    path : str or path
        The file; what stood there is replaced at once.
    fixed : dict
        Attributes (``"@name"``) and data sets of the file beside its rows.
    first : Records
        First rows: they tell the widths.
    """

    def __init__(self, path: str | os.PathLike[str], fixed: Mapping[str, Any], first: Records) -> None:
        self.path = Path(path)
        self._fixed = fixed
        self._widths = {name: rows.shape[1:] for name, rows in first.columns()}
        self._waiting: list[Records] = []
        self._bytes = 0
        self._flushed_at = time.monotonic()
        self._file: Any = None
        self.rows = self.patches = 0
        self._begin()
        self.add(first)

    def _begin(self) -> None:
        with atomic(self.path) as temporary, h5py_module().File(temporary, "w", libver="latest") as file:
            self._create(file)
        self._append_to_file()

    def _create(self, file: Any) -> None:
        for name, value in self._fixed.items():
            if name.startswith("@"):
                file.attrs[name[1:]] = value
            else:
                file[name] = value
        for name, tail in self._widths.items():
            width = 8 * max(int(np.prod(tail)), 1)
            rows = int(np.clip((1 << 18) // width, 1, 4096))
            columns = tuple(min(max(size, 1), 1 << 17) for size in tail)
            data = file.create_dataset(
                f"records/{name.rstrip('_')}",
                shape=(0, *tail),
                # HDF5 wants chunks of at least one number, even where there is no column.
                maxshape=(None, *(size or None for size in tail)),
                chunks=(rows, *columns),
                dtype="<f8",
            )
            data.attrs["meaning"], data.attrs["unit"] = COLUMNS[name]
        count = len(self._widths)
        file.create_dataset("blocks/end", shape=(0,), maxshape=(None,), chunks=(512,), dtype="<i8")
        file.create_dataset(
            "blocks/digest",
            shape=(0, count, DIGEST),
            maxshape=(None, count, DIGEST),
            chunks=(64, count, DIGEST),
            dtype="u1",
        )
        # Joints that were engaged or released: few rows, which may become wider.
        file.create_dataset(
            "history", shape=(0, 0), maxshape=(None, None), chunks=(16, 16), dtype="<f8", fletcher32=True
        )
        file.create_dataset(
            "patches",
            shape=(0, PATCH),
            maxshape=(None, PATCH),
            chunks=(512, PATCH),
            dtype="<f8",
            fletcher32=True,
        )
        file["statistics"] = _padded("{}")

    def _append_to_file(self) -> None:
        try:
            self._file = h5py_module().File(self.path, "r+", libver="latest", locking="best-effort")
            self._file.swmr_mode = True
        except OSError as error:
            raise FileError(f"{self.path}: cannot be written: {error}") from error

    @classmethod
    def continued(cls, path: str | os.PathLike[str], fixed: Mapping[str, Any], records: Records) -> Stream:
        """Write a file anew with these rows, which may be those of the file itself, and go on from there."""
        with atomic(path) as temporary:
            stream = cls(temporary, fixed, records[:0])
            for k in range(0, len(records.time), 64):
                stream.add(records[k : k + 64])
            stream.close()
        stream.path = Path(path)
        stream._append_to_file()
        return stream

    def add(self, rows: Records) -> None:
        """Take rows, and write them where enough has gathered."""
        if not len(rows.time):
            return
        self._waiting.append(rows)
        self._bytes += sum(8 * int(np.prod(column.shape)) for _, column in rows.columns())
        if self._bytes >= BLOCK or time.monotonic() - self._flushed_at >= SECONDS:
            self.flush()

    def flush(self, statistics: Mapping[str, Any] | None = None) -> None:
        """Put on disk what was taken."""
        if self._file is None:
            return
        try:
            if self._waiting:
                self._write_block()
            if statistics is not None:
                self._file["statistics"][...] = _padded(json.dumps(statistics))
            self._file.flush()
        except (OSError, RuntimeError, ValueError) as error:
            raise FileError(f"{self.path}: cannot be written: {error}") from error
        self._flushed_at = time.monotonic()

    def _write_block(self) -> None:
        digests = []
        for name in self._widths:
            parts = [np.asarray(getattr(rows, name)) for rows in self._waiting]
            joined = parts[0] if len(parts) == 1 else np.concatenate(parts)
            data = self._file[f"records/{name.rstrip('_')}"]
            data.resize(self.rows + len(joined), axis=0)
            if joined.size:
                data[self.rows :] = joined
            digests.append(_digest(joined))
        history = self._waiting[-1].history
        if len(history) > len(self._file["history"]):
            self._file["history"].resize(history.shape)
            self._file["history"][...] = history
        patches = np.concatenate([np.asarray(rows.patches) for rows in self._waiting])
        if len(patches):
            # What a writer that was killed had left behind its last block is written over.
            self._file["patches"].resize(self.patches + len(patches), axis=0)
            self._file["patches"][self.patches :] = patches
        self._file.flush()
        self.rows += len(joined)
        self.patches += len(patches)
        end, digest = (self._file[f"blocks/{name}"] for name in ("end", "digest"))
        k = len(end)
        digest.resize(k + 1, axis=0)
        digest[k] = np.frombuffer(b"".join(digests), dtype=np.uint8).reshape(digest.shape[1:])
        self._file.flush()
        end.resize(k + 1, axis=0)
        end[k] = self.rows
        self._waiting, self._bytes = [], 0

    def restart(self) -> None:
        """Forget all rows."""
        self._waiting, self._bytes, self.rows, self.patches = [], 0, 0, 0
        self.close()
        self._begin()

    def close(self) -> None:
        """Write what is left and close the file: any reader of HDF5 opens it from then on."""
        if self._file is not None:
            try:
                self.flush()
            finally:
                self._file.close()
                self._file = None


def _padded(text: str) -> Any:
    """Text in an array of a fixed size: the file is not laid out anew while it grows."""
    return np.frombuffer(text.encode()[:NOTES].ljust(NOTES), dtype=np.uint8)


class FileRows:
    """Rows of one column of a result file, read and checked when asked for."""

    def __init__(self, path: Path, name: str, number: int, width: int, ends: IntArray, digests: Any) -> None:
        self._path, self._name, self._number = path, name, number
        self._ends, self._digests = ends, digests
        self._checked = np.zeros(len(ends), dtype=bool)
        self.shape = (int(ends[-1]) if len(ends) else 0, width)

    def __len__(self) -> int:
        return self.shape[0]

    def __getitem__(self, key: Any) -> FloatArray:
        rows, rest = (key[0], key[1:]) if isinstance(key, tuple) else (key, ())
        index = np.arange(len(self))[rows]
        if np.ndim(index) == 0:
            one: FloatArray = self._read(int(index), int(index) + 1)[0][rest]
            return one
        if not len(index):
            return np.zeros((0, self.shape[1]))[(slice(None), *rest)]
        first, last = int(index.min()), int(index.max()) + 1
        if np.all(np.diff(index) == 1):
            parts = [part[(slice(None), *rest)] for part in self._pieces(first, last)]
            return parts[0] if len(parts) == 1 else np.concatenate(parts)
        blocks = np.searchsorted(self._ends, index, side="right")
        parts = []
        for block in np.unique(blocks):
            here = index[blocks == block]
            part = self._read(int(here.min()), int(here.max()) + 1)
            parts.append(part[here - here.min()][(slice(None), *rest)])
        out = np.empty((len(index), *parts[0].shape[1:]))
        out[np.argsort(blocks, kind="stable")] = np.concatenate(parts)
        return out

    def _pieces(self, first: int, last: int) -> Iterator[FloatArray]:
        """Rows first to last, block by block."""
        cuts = self._ends[(self._ends > first) & (self._ends < last)].tolist()
        for i, j in zip([first, *cuts], [*cuts, last], strict=True):
            yield self._read(i, j)

    def _read(self, first: int, last: int) -> FloatArray:
        """Rows first to last of one block."""
        block = int(np.searchsorted(self._ends, first, side="right"))
        try:
            with open_result(self._path) as file:
                data = file[f"records/{self._name.rstrip('_')}"]
                if not self._checked[block]:
                    begin = int(self._ends[block - 1]) if block else 0
                    rows: FloatArray = data[begin : int(self._ends[block])]
                    if _digest(rows) != self._digests[block, self._number].tobytes():
                        raise FileError(
                            f"{self._path}: is damaged: rows {begin} to {int(self._ends[block]) - 1} of "
                            f"{self._name.rstrip('_')} do not match their digest"
                        )
                    self._checked[block] = True
                    return rows[first - begin : last - begin]
                rows = data[first:last]
                return rows
        except FileError:
            raise
        except FileNotFoundError as error:
            raise FileError(f"{self._path}: there is no such file") from error
        except (OSError, KeyError, ValueError, RuntimeError) as error:
            raise FileError(f"{self._path}: cannot be read: {error}") from error


class FilePatches:
    """Rows of the table of patches of a result file, read when asked for."""

    def __init__(self, path: Path, rows: int) -> None:
        self._path = path
        self.shape = (rows, PATCH)

    def __len__(self) -> int:
        return self.shape[0]

    def __getitem__(self, key: Any) -> FloatArray:
        try:
            with open_result(self._path) as file:
                rows: FloatArray = file["patches"][key]
                return rows
        except (OSError, KeyError, ValueError, RuntimeError) as error:
            raise FileError(f"{self._path}: cannot be read: {error}") from error


def read_records(path: str | os.PathLike[str], file: Any, rows: int | None = None) -> Records:
    """Rows of an open file, at most so many: in memory where they are few, else read when asked for."""
    ends, digests = file["blocks/end"][()], file["blocks/digest"][()]
    whole = 0
    while whole < len(ends) and ends[whole] > (ends[whole - 1] if whole else 0):
        whole += 1
    ends, digests = ends[:whole], digests[:whole]
    columns: dict[str, Any] = {}
    place = Path(os.fsdecode(path)).absolute()
    size = 0
    for number, name in enumerate(COLUMNS):
        data = file[f"records/{name.rstrip('_')}"]
        if len(ends) and len(data) < ends[-1]:
            raise FileError(f"{path}: is damaged: {name.rstrip('_')} has {len(data)} rows, not {ends[-1]}")
        width = data.shape[1] if data.ndim > 1 else 0
        columns[name] = FileRows(place, name, number, width, ends, digests)
        size += 8 * width * len(columns[name])
    n = int(ends[-1]) if len(ends) else 0
    if rows is not None:
        if rows > n:
            raise FileError(f"{path}: has {n} rows, not {rows}: it is not what the run wrote")
        n = rows
    for name in ("time", "switches", "touching"):
        pieces = columns[name]._pieces(0, n) if n else ()
        columns[name] = np.concatenate([np.zeros(0), *pieces])
    history = file["history"][()]
    if size <= IN_MEMORY or rows == 0:
        columns = {name: column[:n] for name, column in columns.items()}
    elif rows is not None:
        for column in columns.values():
            if isinstance(column, FileRows):
                column.shape = (n, column.shape[1])
    count = int(columns["touching"].sum())
    if count > len(file["patches"]):
        raise FileError(f"{path}: is damaged: there are {len(file['patches'])} patches, not {count}")
    patches: Rows = FilePatches(place, count)
    if 8 * PATCH * count <= IN_MEMORY:
        patches = file["patches"][:count]
    return Records(**columns, history=history if history.size else np.zeros((0, 5)), patches=patches)
