"""What a run leaves behind: raw rows, one an output, and states to start from."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, fields
from typing import Any, Protocol

import numpy as np

from pliant._lowered import BodyState
from pliant.model import Model
from pliant.typing import FloatArray, IntArray

__all__ = ["PATCH", "Records", "Rows", "State", "StoredRows", "by_blocks"]

BLOCK = 1 << 25  # bytes of stored rows that are in memory at a time
PATCH = 12  # numbers of a patch
TABLES = ("history", "patches")  # what has not one row an output


class StoredRows(Protocol):
    """Rows that are not in memory: an index reads them, as NumPy would give them."""

    @property
    def shape(self) -> tuple[int, int]:
        """Rows and columns."""

    def __len__(self) -> int: ...

    def __getitem__(self, key: Any) -> FloatArray: ...


Rows = FloatArray | StoredRows


@dataclass(frozen=True, eq=False)
class Records:
    """Raw rows of a run, one an output: in memory, or read from a file when asked for.

    ``history`` has a row for each time a joint was engaged or released, ``switches`` tells how many of them
    lie before each output. ``patches`` has a row for each place that touches at an output: number of the
    contact, point, normal, gap, normal force, friction force; ``touching`` tells how many each output has.
    """

    time: FloatArray
    q: Rows
    v: Rows
    a: Rows
    lambda_: Rows
    energy: Rows
    inputs: Rows
    outputs: Rows
    switches: FloatArray = field(default_factory=lambda: np.zeros(0))
    touching: FloatArray = field(default_factory=lambda: np.zeros(0))
    history: FloatArray = field(default_factory=lambda: np.zeros((0, 5)))
    patches: Rows = field(default_factory=lambda: np.zeros((0, PATCH)))

    def __post_init__(self) -> None:
        for name in ("switches", "touching"):
            if len(getattr(self, name)) != len(self.time):
                object.__setattr__(self, name, np.zeros(len(self.time)))

    def columns(self) -> Iterator[tuple[str, Rows]]:
        """Give names and rows of all that has one row an output."""
        return ((entry.name, getattr(self, entry.name)) for entry in fields(self) if entry.name not in TABLES)

    def __getitem__(self, rows: slice | IntArray) -> Records:
        """Read some of the rows."""
        columns = {name: column[rows] for name, column in self.columns()}
        return Records(**columns, history=self.history, patches=self.patches_of(rows))

    def patches_of(self, rows: slice | IntArray) -> FloatArray:
        """Read the patches of some of the rows, one row after the other."""
        ends = np.cumsum(self.touching).astype(np.int64)
        index = np.arange(len(self.time))[rows]
        if not len(index) or not len(ends) or not ends[-1]:
            return np.zeros((0, PATCH))
        first = ends[index] - self.touching[index].astype(np.int64)
        if np.all(np.diff(index) == 1):
            return self.patches[int(first[0]) : int(ends[index[-1]])]
        pieces = [self.patches[int(i) : int(j)] for i, j in zip(first, ends[index], strict=True)]
        return np.concatenate(pieces)

    @classmethod
    def joined(cls, parts: Sequence[Records]) -> Records:
        """Join records that follow each other."""
        if len(parts) == 1:
            return parts[0]
        names = [name for name, _ in parts[0].columns()] + ["patches"]
        columns = {name: np.concatenate([getattr(part, name) for part in parts]) for name in names}
        return cls(**columns, history=parts[-1].history)


def by_blocks(function: Callable[..., Any], *columns: Rows, rows: slice | IntArray = slice(None)) -> Any:
    """Apply a function that works row by row; rows that are not in memory come a block at a time.

    ``function`` takes arrays of so many of the ``rows`` and returns an array of as many, or a tuple of them.

    Examples
    --------
    >>> by_blocks(lambda q, v: q.sum(axis=1) + v[:, 0], np.ones((3, 2)), np.zeros((3, 1)))
    array([2., 2., 2.])
    """
    if all(isinstance(one, np.ndarray) for one in columns):
        return function(*(one[rows] for one in columns))
    index = np.arange(len(columns[0]))[rows]
    width = 8 * sum(one.shape[1] if len(one.shape) > 1 else 1 for one in columns)
    step = max(1, BLOCK // max(width, 1))
    cuts = range(0, max(len(index), 1), step)
    parts = [function(*(one[index[k : k + step]] for one in columns)) for k in cuts]
    if isinstance(parts[0], tuple):
        return tuple(np.concatenate(part) for part in zip(*parts, strict=True))
    return np.concatenate(parts)


@dataclass(frozen=True, eq=False)
class State:
    """State of the bodies at one time: a start for another run.

    ``saved`` is what a stepper goes back by, ``grows`` what the load factor of a static state acted on,
    ``gas`` the mass in each chamber [kg], ``past`` what the points of each cable that yields remember:
    plastic strain and its path, element by element and point by point, (elements * points * 2,).
    """

    model: Model
    bodies: Mapping[str, BodyState]
    static: bool
    time: float
    q: FloatArray
    lambda_: FloatArray
    saved: bytes | None = None
    grows: tuple[str, ...] | None = None
    gas: Mapping[str, float] = field(default_factory=dict)
    past: Mapping[str, FloatArray] = field(default_factory=dict)

    def __reduce__(self) -> tuple[Any, ...]:
        # Callables of the model cannot be pickled, and a state needs only the bodies.
        document = self.model.to_document(keep_functions=False)
        rest = (self.static, self.time, self.q, self.lambda_, self.saved, self.grows)
        return _restored_state, (document, dict(self.bodies), *rest, dict(self.gas), dict(self.past))


def _restored_state(document: Any, *rest: Any) -> State:
    return State(Model.from_document(document, "state"), *rest)
