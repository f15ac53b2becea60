"""Constraints that follow from others: planar loops of hinges, a door on two hinges."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from pliant.errors import translated

if TYPE_CHECKING:
    from pliant.model import Model

__all__ = ["Redundancy", "redundancies"]


@dataclass(frozen=True)
class Redundancy:
    """Equations of a joint that follow from those of other joints at the start.

    Attributes
    ----------
    joint : str
        Name of the joint.
    equations : int
        How many of its equations follow from others.
    follows_from : tuple of str
        Names of the joints that they follow from.
    """

    joint: str
    equations: int
    follows_from: tuple[str, ...]


def redundancies(model: Model) -> tuple[Redundancy, ...]:
    """Find the equations that follow from others."""
    from pliant import _core
    from pliant._lower import lower

    if not model._bodies or not model._joints:
        return ()
    lowered = lower(model)
    with translated():
        found = _core.System(lowered.spec, lowered.arrays).redundant()
    known = model._joints
    return tuple(
        Redundancy(joint, count, tuple(name for name in others if name in known))
        for joint, count, others in found
    )
