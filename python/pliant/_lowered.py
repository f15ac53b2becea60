"""What lowering gives: the core's document, and how to read the core's answers."""

from __future__ import annotations

import json
from dataclasses import dataclass, field, fields
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from pliant.beams import BeamBody
from pliant.bodies import LineBody
from pliant.forces import ForceData
from pliant.gas import Chamber
from pliant.rigid import RigidBodyData
from pliant.signals import Function, Signal
from pliant.surfaces import SurfaceBody
from pliant.typing import FloatArray, Json

if TYPE_CHECKING:
    from pliant.model import Model

__all__ = ["BodyState", "Input", "Lowered", "initial_state", "is_load", "numbers_of", "signals_of"]


class BodyState(NamedTuple):
    """Strand nodes of one body, each (n, 3).

    A free mass has one row of positions, a rigid body four, centre and axes, a surface its nodal vectors;
    these leave slopes unused.
    """

    r: FloatArray
    t: FloatArray
    v_r: FloatArray
    v_t: FloatArray


@dataclass
class Input:
    """A callable among the inputs of a run; None where it was lost in a file."""

    load: str
    function: Function | None
    first: int
    size: int


@dataclass
class Lowered:
    """What the core gets, and how to read its answers.

    Attributes
    ----------
    document, arrays
        The core's document and the arrays beside it.
    inputs : list of Input
        Callables.
    held : dict
        First number and initial value of each :class:`pliant.Input`; all come before the callables.
    cables, shared, rigid, surfaces, beams : dict
        Number of the cable of each line body; of the shared point of each free mass; of each rigid body;
        of each surface; of each beam.
    forces : dict
        Number of the core's force of each spring.
    chambers : dict
        Number of each chamber.
    contacts : dict
        Number of the core's contact of lines of each; the others follow in their order.
    grows : list of str or None
        What the load factor of a static run acted on: loads, "gravity"; None: everything.
    critical : list
        Critical points of a static path: kind, output, load factor, shape.
    plan : dict
        How each joint is realised: ``{"kind": "multiplier", "index": k}``, ``{"kind": "shared", ...}``
        with what acts on the first body's side, ``{"kind": "nodes", ...}`` with a core's joint for each
        node of an edge, or ``{"kind": "redundant"}``.
    """

    document: Json
    arrays: list[FloatArray] = field(default_factory=list)
    inputs: list[Input] = field(default_factory=list)
    held: dict[str, tuple[int, list[float]]] = field(default_factory=dict)
    cables: dict[str, int] = field(default_factory=dict)
    shared: dict[str, int] = field(default_factory=dict)
    rigid: dict[str, int] = field(default_factory=dict)
    surfaces: dict[str, int] = field(default_factory=dict)
    beams: dict[str, int] = field(default_factory=dict)
    forces: dict[str, int] = field(default_factory=dict)
    chambers: dict[str, int] = field(default_factory=dict)
    contacts: dict[str, int] = field(default_factory=dict)
    plan: dict[str, Json] = field(default_factory=dict)
    coordinates: int = 0
    multipliers: int = 0
    grows: list[str] | None = None
    critical: list[tuple[str, int, float, list[float]]] = field(default_factory=list)

    @property
    def spec(self) -> str:
        """The document as text."""
        return json.dumps(self.document)

    def to_map(self) -> Json:
        """Write as JSON how the core's answers are read: all but the document and what stands beside it."""
        beside = ("document", "arrays", "inputs")
        return {entry.name: getattr(self, entry.name) for entry in fields(self) if entry.name not in beside}

    @classmethod
    def from_map(
        cls, mapping: Json, document: Json, arrays: list[FloatArray], inputs: list[Input]
    ) -> Lowered:
        """Read what :meth:`to_map` wrote."""
        held = {name: (first, initial) for name, (first, initial) in mapping["held"].items()}
        return cls(**{**mapping, "held": held}, document=document, arrays=arrays, inputs=inputs)

    @property
    def bodies(self) -> list[str]:
        """Names of the bodies that have coordinates."""
        return [*self.cables, *self.shared, *self.rigid, *self.surfaces, *self.beams]

    def line(self, name: str) -> int:
        """Count a cable or beam among the lines that touch: cables first, then beams."""
        number = self.cables.get(name)
        return len(self.cables) + self.beams[name] if number is None else number

    @property
    def held_values(self) -> FloatArray:
        """Initial values of all inputs, one after the other."""
        return np.array([x for _, initial in self.held.values() for x in initial])


def is_load(item: Any) -> bool:
    """Whether the core has a load for it: neither a force with a state of its own nor a chamber."""
    return not isinstance(item, (ForceData, Chamber))


def numbers_of(plan: Json) -> list[int]:
    """Numbers of the core's joints that realise a joint."""
    return [plan["index"]] if plan["kind"] == "multiplier" else plan.get("indices", [])


def signals_of(item: Any) -> list[Signal]:
    """Signals among the fields of a load or joint."""
    values = (getattr(item, entry.name) for entry in fields(item))
    return [value for value in values if isinstance(value, Signal)]


def initial_state(model: Model) -> dict[str, BodyState]:
    """State at the start as the model describes it."""
    states = {}
    for name, body in model._bodies.items():
        if isinstance(body, LineBody):
            states[name] = BodyState(body.r, body.t, body.v_r, body.v_t)
        elif isinstance(body, RigidBodyData):
            none = np.zeros((1, 3))
            states[name] = BodyState(body.r, none, body.v_r, none)
        elif isinstance(body, (SurfaceBody, BeamBody)):
            none = np.zeros((1, 3))
            states[name] = BodyState(body.q.reshape(-1, 3), none, body.v.reshape(-1, 3), none)
        elif body.at is None:
            place, speed = (np.array([p.position]) for p in (body.position, body.velocity))
            states[name] = BodyState(place, np.zeros((1, 3)), speed, np.zeros((1, 3)))
    return states
