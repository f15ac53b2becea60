"""How long steps are: given, or chosen by an error tolerance."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass
from typing import Any

from pliant import _check
from pliant.typing import Json

__all__ = ["RTOL", "Steps"]

SMALLEST = 1e-12
RTOL = 1e-6  # of the model's size: a pendulum keeps its place to 5e-4 of its length over a swing


@dataclass(frozen=True)
class Steps:
    """Steps of the length ``step`` [s]; None: of any that keeps to the tolerances."""

    step: float | None
    rtol: float = RTOL
    atol: float = 0.0
    max_step: float = math.inf

    @classmethod
    def checked(
        cls, step: object, rtol: object, atol: object, max_step: object, duration: float | None = None
    ) -> Steps:
        """Make them of the arguments of ``simulate`` or a stepper."""
        if isinstance(step, str) and step == "auto":
            longest = duration / 20 if duration is not None else math.inf
            relative = RTOL if rtol is None else _check.number(rtol, "rtol", at_least=0, below=1)
            absolute = 0.0 if atol is None else _check.number(atol, "atol", at_least=0)
            if absolute == 0.0 and relative < SMALLEST:
                _check.fail("rtol", rtol, f"must be at least {SMALLEST:g} where atol is 0: less is rounding")
            if max_step is not None and max_step != math.inf:
                longest = _check.number(max_step, "max_step", above=0)
            elif max_step is not None:
                longest = math.inf
            return cls(None, relative, absolute, longest)
        for name, value in (("rtol", rtol), ("atol", atol), ("max_step", max_step)):
            if value is not None:
                _check.fail(name, value, 'goes with step="auto" only')
        if isinstance(step, str):
            _check.fail("step", step, 'must be a number of seconds or "auto"')
        return cls(_check.number(step, "step", above=0))

    def document(self) -> Json:
        """Write them for a file."""
        return asdict(self)

    @classmethod
    def read(cls, document: Any) -> Steps:
        """Read what :meth:`document` wrote."""
        return cls(**document)
