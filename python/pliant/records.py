"""What a run leaves behind: raw rows, one an output, and states to start from."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from pliant._lowered import BodyState
from pliant.model import Model
from pliant.typing import FloatArray

__all__ = ["Records", "State"]


@dataclass(frozen=True, eq=False)
class Records:
    """Raw arrays of a run, one row an output.

    ``history`` has a row for each time a joint was engaged or released, ``switches`` tells how many of them
    lie before each output.
    """

    time: FloatArray
    q: FloatArray
    v: FloatArray
    a: FloatArray
    lambda_: FloatArray
    energy: FloatArray
    inputs: FloatArray
    outputs: FloatArray
    switches: FloatArray = field(default_factory=lambda: np.zeros(0))
    history: FloatArray = field(default_factory=lambda: np.zeros((0, 5)))


@dataclass(frozen=True, eq=False)
class State:
    """State of the bodies at one time: a start for another run.

    ``saved`` is what a stepper goes back by, ``grows`` what the load factor of a static state acted on.
    """

    model: Model
    bodies: Mapping[str, BodyState]
    static: bool
    time: float
    q: FloatArray
    lambda_: FloatArray
    saved: bytes | None = None
    grows: tuple[str, ...] | None = None

    def __reduce__(self) -> tuple[Any, ...]:
        # Callables of the model cannot be pickled, and a state needs only the bodies.
        document = self.model.to_document(keep_functions=False)
        rest = (dict(self.bodies), self.static, self.time, self.q, self.lambda_, self.saved, self.grows)
        return _restored_state, (document, *rest)


def _restored_state(document: Any, *rest: Any) -> State:
    return State(Model.from_document(document, "state"), *rest)
