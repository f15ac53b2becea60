"""When joints hold: what a model keeps of releasing and engaging them."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

from pliant import _check
from pliant.errors import ModelError
from pliant.typing import Json

__all__ = ["Latch", "LatchEvent"]


@dataclass(frozen=True)
class LatchEvent:
    """A joint is engaged or released at a time [s]; ``gap`` [m] is what may lie between its points."""

    at: float
    engage: bool
    gap: float | None = None


@dataclass(frozen=True)
class Latch:
    """Whether a joint holds at first, and what happens to it, in the order of time.

    ``floats``: one of its points is lent by a body or by the world, wherever the other is when it engages.
    """

    engaged: bool = True
    floats: bool = False
    events: tuple[LatchEvent, ...] = ()

    @property
    def holds_at_start(self) -> bool:
        """Whether it holds at first: a joint whose first event is to engage is free before."""
        return self.engaged and not (self.events and self.events[0].engage)

    @property
    def is_permanent(self) -> bool:
        """Whether it always holds."""
        return self.engaged and not self.events

    def with_event(self, event: LatchEvent) -> Latch:
        """Add an event."""
        for other in self.events:
            if other.at == event.at:
                doing = "engaged" if other.engage else "released"
                _check.fail("at", event.at, f"the joint is {doing} at that time already")
        events = tuple(sorted((*self.events, event), key=lambda one: one.at))
        return replace(self, events=events)

    def document(self) -> Json:
        """Write it for a file; the core reads the same."""
        events = [{"t": one.at, "engage": one.engage, "gap": one.gap} for one in self.events]
        return {"engaged": self.engaged, "floats": self.floats, "events": events}

    @classmethod
    def read(cls, document: Any) -> Latch:
        """Read what :meth:`document` wrote."""
        latch = cls(_check.flag(document["engaged"], "engaged"), _check.flag(document["floats"], "floats"))
        for one in document["events"]:
            latch = latch.with_event(event(one["t"], _check.flag(one["engage"], "engage"), one["gap"]))
        return latch


def event(at: object, engage: bool, gap: object = None) -> LatchEvent:
    """Check the arguments of an event."""
    return LatchEvent(_check.number(at, "at", at_least=0), engage, None if gap is None else checked_gap(gap))


def checked_gap(gap: object) -> float:
    """Return a gap [m]."""
    return _check.number(gap, "gap", at_least=0)


def require_known(latches: dict[str, Latch], name: str) -> Latch:
    """Find the latch of a joint."""
    if name not in latches:
        raise ModelError(f"joint = '{name}': this model has no such joint")
    return latches[name]
