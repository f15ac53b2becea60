"""The plan of a run: which steps are taken, which times are kept, when it saves itself."""

from __future__ import annotations

import math
import os
import time
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from pliant import _check
from pliant._steps import Steps
from pliant.errors import FileError
from pliant.typing import Json

if TYPE_CHECKING:
    from pliant.stepper import Stepper

__all__ = ["Leg", "Plan"]

SECONDS = 60.0  # between checkpoints
THOUSAND = 1000


@dataclass(frozen=True)
class Leg:
    """Equal steps up to step number ``last``, which ends at the time ``end`` and is kept or not.

    Where the accuracy decides on the steps, their number is not known: ``last`` and ``step`` are zero.
    """

    last: int
    step: float
    end: float | None = None
    kept: bool = False


@dataclass
class Plan:
    """Legs, one after the other, and how often to keep and to save."""

    legs: list[Leg]
    output_every: int
    keeps_start: bool
    has_on_step: bool
    path: Path | None
    seconds: float
    saved_at: float = field(default_factory=time.monotonic)

    @classmethod
    def checked(
        cls,
        length: float,
        steps: Steps,
        output_every: object,
        output_times: object,
        checkpoint: object,
        has_on_step: bool,
    ) -> Plan:
        """Make a plan of the arguments of ``simulate``."""
        size = steps.step
        if size is not None and length / size > _check.LARGEST_COUNT:
            least = length / _check.LARGEST_COUNT
            _check.fail("step", size, f"must be at least {least:g} s: at most 1e8 steps")
        every = _check.count(output_every, "output_every")
        path, seconds = _checked_checkpoint(checkpoint)
        if output_times is None:
            if size is None:
                whole = Leg(0, 0.0, length)
            else:
                count = _steps(length, size)
                whole = Leg(count, length / count)
            return cls([whole], every, True, has_on_step, path, seconds)
        if every != 1:
            _check.fail("output_every", every, "cannot go with output_times")
        times = _check.array(output_times, "output_times", (None,))
        if not len(times) or times[0] < 0 or np.any(np.diff(times) <= 0) or times[-1] > length:
            _check.fail("output_times", output_times, f"must ascend from 0 to {length:g} s")
        ends = [float(t) for t in times if t > 0]
        kept = [True] * len(ends)
        if not ends or ends[-1] < length:
            ends, kept = [*ends, length], [*kept, False]
        if size is None:
            legs = [Leg(0, 0.0, end, keep) for end, keep in zip(ends, kept, strict=True)]
        else:
            legs = _legs(ends, kept, size)
        return cls(legs, 0, bool(times[0] == 0.0), has_on_step, path, seconds)

    @property
    def ticks(self) -> int:
        """Length of the progress bar: all steps, or thousandths of the time."""
        return self.legs[-1].last or THOUSAND

    def tick(self, stepper: Stepper) -> int:
        """How far the run has come on the progress bar."""
        last = self.legs[-1]
        if last.last or last.end is None:
            return stepper._steps
        return int(THOUSAND * stepper.time / last.end)

    @staticmethod
    def is_done(stepper: Stepper, leg: Leg) -> bool:
        """Whether a leg lies behind."""
        if leg.last or leg.end is None:
            return stepper._steps >= leg.last
        return stepper.time >= leg.end

    def take(self, stepper: Stepper, leg: Leg, single: bool) -> None:
        """Take some steps of a leg, or a single one."""
        if leg.last or leg.end is None:
            left = leg.last - stepper._steps
            stepper._take(1 if single else left, leg.step, self.output_every, leg.end, left)
        else:
            stepper._take_freely(leg.end, 1 if single else None, self.output_every)

    def reach(self, stepper: Stepper, leg: Leg) -> None:
        """Keep the end of a leg."""
        if leg.kept:
            stepper._record()

    def finish(self, stepper: Stepper) -> None:
        """Keep the last state, unless certain times were asked for, and save."""
        if self.output_every:
            stepper._record(again=False)
        self.save(stepper, now=True)

    def save(self, stepper: Stepper, now: bool = False) -> None:
        """Save the run where it is time."""
        if self.path is None or not (now or time.monotonic() - self.saved_at >= self.seconds):
            return
        stepper._write(self.path, self.document())
        self.saved_at = time.monotonic()

    def document(self) -> Json:
        """Write the plan for a file."""
        return {
            "legs": [[leg.last, leg.step, leg.end, leg.kept] for leg in self.legs],
            "output_every": self.output_every,
            "keeps_start": self.keeps_start,
            "has_on_step": self.has_on_step,
            "seconds": self.seconds,
        }

    @classmethod
    def read(cls, document: Any, path: str | os.PathLike[str]) -> Plan:
        """Read what :meth:`document` wrote."""
        try:
            fields = {**document, "legs": [Leg(*leg) for leg in document["legs"]]}
            return cls(path=Path(path), **fields)
        except (TypeError, KeyError, ValueError) as error:
            raise FileError(f"{path}: is damaged: {error}") from error


def _steps(length: float, size: float) -> int:
    return max(1, math.ceil(length / size * (1 - 1e-9)))


def _legs(ends: list[float], kept: list[bool], size: float) -> list[Leg]:
    """Whole steps between times; lengths that differ by rounding are made equal: changes cost time."""
    legs: list[Leg] = []
    last, begin = 0, 0.0
    for end, keep in zip(ends, kept, strict=True):
        gap = end - begin
        steps = _steps(gap, size)
        step = gap / steps
        if legs and abs(legs[-1].step * steps - gap) <= 4 * np.finfo(float).eps * end:
            step = legs[-1].step
        last, begin = last + steps, end
        legs.append(Leg(last, step, end, keep))
    return legs


def _checked_checkpoint(checkpoint: object) -> tuple[Path | None, float]:
    if checkpoint is None:
        return None, SECONDS
    seconds = SECONDS
    path = checkpoint
    if isinstance(checkpoint, tuple) and len(checkpoint) == 2:
        path = checkpoint[0]
        seconds = _check.number(checkpoint[1], "checkpoint[1]", at_least=0)
    if not isinstance(path, (str, os.PathLike)) or not os.fspath(path):
        _check.fail("checkpoint", checkpoint, "must be a path, or a path and the seconds between two savings")
    target = Path(os.fsdecode(path))
    if not target.parent.is_dir():
        raise FileError(f"{target}: cannot be written: there is no such folder")
    return target, seconds
