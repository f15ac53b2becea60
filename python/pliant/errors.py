"""The exceptions of pliant. Each message names what is wrong, the value it has and what to do about it."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from pliant.result import Result

__all__ = ["ConvergenceError", "FileError", "ModelError"]


class ModelError(ValueError):
    """The model, or the call that builds or runs it, is wrong.

    Attributes
    ----------
    result : Result or None
        What was computed before the fault showed (a load that became non-finite during a run), else None.
    """

    result: Result | None = None
    records: Any = None  # the core's, before they become the result


class FileError(OSError):
    """A file is missing, unreadable, truncated or not what it claims to be."""


class ConvergenceError(RuntimeError):
    """A step failed.

    Attributes
    ----------
    time : float
        Time [s] (statics: load factor) at which the step failed.
    step : float
        Its size [s].
    residuals : list of float
        Residual norms of its iterations.
    error_estimate : float or None
        With ``step="auto"``: local error of the smallest step tried, in units of the tolerance.
    body : str or None
        Name of the worst body.
    node : int or None
        Its worst node.
    result : Result or None
        What was computed so far.
    """

    def __init__(
        self,
        message: str,
        *,
        time: float = float("nan"),
        step: float = float("nan"),
        residuals: Sequence[float] = (),
        error_estimate: float | None = None,
        body: str | None = None,
        node: int | None = None,
        result: Result | None = None,
    ) -> None:
        super().__init__(message)
        self.time = time
        self.step = step
        self.residuals = list(residuals)
        self.error_estimate = error_estimate
        self.body = body
        self.node = node
        self.result = result
        self.records: Any = None  # the core's, before they become the result

    @classmethod
    def from_core(cls, message: str, facts: dict[str, Any]) -> ConvergenceError:
        """Translate what the compiled core reports."""
        unknown = str(facts.get("unknown") or "")
        body = re.search(r"'([^']*)'", unknown)
        node = re.search(r"node (\d+)", unknown)
        return cls(
            message,
            time=float(facts.get("time", float("nan"))),
            step=float(facts.get("step", float("nan"))),
            residuals=[float(x) for x in facts.get("residuals", ())],
            error_estimate=facts.get("error_estimate"),
            body=body.group(1) if body else None,
            node=int(node.group(1)) if node else None,
        )


@contextmanager
def translated() -> Iterator[None]:
    """Turn the errors of the compiled core into those of this module."""
    from pliant import _core

    try:
        yield
    except _core.ModelError as error:
        wrong = ModelError(str(error))
        wrong.records = getattr(error, "records", None)
        raise wrong from None
    except _core.ConvergenceError as error:
        facts = error.args[1] if len(error.args) > 1 and isinstance(error.args[1], dict) else {}
        failure = ConvergenceError.from_core(str(error.args[0]), facts)
        failure.records = getattr(error, "records", None)
        raise failure from None
