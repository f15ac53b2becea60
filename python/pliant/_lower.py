"""Lowering: a model becomes the document and the arrays that the core computes with."""

from __future__ import annotations

import dataclasses
import json
from collections import defaultdict
from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from pliant.bodies import LineBody, MassBody
from pliant.errors import ModelError
from pliant.joints import (
    Clamp,
    Cylindrical,
    Distance,
    Hinge,
    JointData,
    Pair,
    Pin,
    Slider,
    Universal,
    Weld,
)
from pliant.loads import Force, LineLoad, Moment
from pliant.points import Point, WorldPoint
from pliant.rigid import RigidBodyData
from pliant.signals import Function, Signal
from pliant.signals import Input as HeldInput
from pliant.typing import FloatArray, Json

if TYPE_CHECKING:
    from pliant.model import Model

VERSION = 1
INLINE = 12  # arrays up to this size are written into the document

EQUATIONS: dict[type, int] = {
    Pin: 3,
    Clamp: 6,
    Weld: 6,
    Hinge: 5,
    Slider: 5,
    Cylindrical: 4,
    Universal: 4,
    Distance: 1,
}

Node = tuple[str, int]


class BodyState(NamedTuple):
    """Strand nodes of one body, each (n, 3).

    A free mass has one row of positions, a rigid body four, centre and axes; both leave slopes unused.
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
    cables, shared, rigid : dict
        Number of the cable of each line body; of the shared point of each free mass; of each rigid body.
    plan : dict
        How each joint is realised: ``{"kind": "multiplier", "index": k}``, ``{"kind": "shared", ...}``
        with what acts on the first body's side, or ``{"kind": "redundant"}``.
    """

    document: Json
    arrays: list[FloatArray] = field(default_factory=list)
    inputs: list[Input] = field(default_factory=list)
    held: dict[str, tuple[int, list[float]]] = field(default_factory=dict)
    cables: dict[str, int] = field(default_factory=dict)
    shared: dict[str, int] = field(default_factory=dict)
    rigid: dict[str, int] = field(default_factory=dict)
    plan: dict[str, Json] = field(default_factory=dict)
    coordinates: int = 0
    multipliers: int = 0

    @property
    def spec(self) -> str:
        """The document as text."""
        return json.dumps(self.document)

    @property
    def held_values(self) -> FloatArray:
        """Initial values of all inputs, one after the other."""
        return np.array([x for _, initial in self.held.values() for x in initial])


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
        elif body.at is None:
            place, speed = (np.array([p.position]) for p in (body.position, body.velocity))
            states[name] = BodyState(place, np.zeros((1, 3)), speed, np.zeros((1, 3)))
    return states


def lower(model: Model, state: Mapping[str, BodyState] | None = None) -> Lowered:
    """Lower a model; ``state`` is the state that the run begins with, where it is not the model's own."""
    return _Lowering(model, state).run()


class _Lowering:
    def __init__(self, model: Model, state: Mapping[str, BodyState] | None) -> None:
        self.model = model
        self.moved = state is not None
        self.model_state = initial_state(model)
        self.state = dict(state) if state is not None else self.model_state
        self.size = model._size() if model._bodies else 1.0
        self.lowered = Lowered({})
        self.lines = {name: body for name, body in model._bodies.items() if isinstance(body, LineBody)}
        self.masses = {name: body for name, body in model._bodies.items() if isinstance(body, MassBody)}
        self.rigid = {name: body for name, body in model._bodies.items() if isinstance(body, RigidBodyData)}
        self.lowered.rigid = {name: k for k, name in enumerate(self.rigid)}
        self.lowered.cables = {name: k for k, name in enumerate(self.lines)}

    def run(self) -> Lowered:
        out = self.lowered
        self._number_inputs()
        self._share()
        relocated = self._relocated()
        places, speeds = self._shared_points(relocated)
        joints = self._joints()
        out.document = {
            "version": VERSION,
            "gravity": self.model.gravity.tolist(),
            "shared_points": self._array(places),
            "shared_velocities": self._array(speeds),
            "cables": [self._cable(body, body.name in relocated) for body in self.lines.values()],
            "rigid_bodies": [
                {
                    "name": body.name,
                    "mass": body.mass,
                    **{
                        key: getattr(body, key).tolist()
                        for key in ("inertia", "position", "axes", "velocity", "angular_velocity")
                    },
                }
                for body in self.rigid.values()
            ],
            "masses": [
                {
                    "name": m.name,
                    "mass": m.mass,
                    "at": {"shared": out.shared[m.name]} if m.at is None else self._point(m.at),
                }
                for m in self.masses.values()
            ],
            "joints": joints,
            "loads": [self._load(load) for load in self.model._loads.values()],
        }
        out.multipliers = 6 * len(self.rigid) + sum(
            self._equations(joint)
            for name, joint in self.model._joints.items()
            if out.plan[name]["kind"] == "multiplier"
        )
        nodes = sum(len(body.users) for body in self.lines.values())
        out.coordinates = (
            6 * nodes - 3 * sum(map(len, self.rows.values())) + 3 * len(places) + 12 * len(self.rigid)
        )
        return out

    def _equations(self, joint: JointData) -> int:
        """Count the equations of a joint; a cable has one direction, which cannot twist."""
        count = EQUATIONS[type(joint)]
        sides = (joint.a, joint.b) if isinstance(joint, Pair) else (joint.a,)
        for tangent in map(self.model._tangent, sides):
            if tangent is None:
                continue
            if isinstance(joint, (Clamp, Weld, Slider)):
                return count - 1
            if isinstance(joint, Hinge) and abs(tangent @ joint.axis) <= 1e-6:
                return count - 1
        return count

    def _number_inputs(self) -> None:
        """Give numbers to the inputs that are set by name, before any callable asks for its own."""
        held, first = self.lowered.held, 0
        for item in [*self.model._joints.values(), *self.model._loads.values()]:
            for given in (one for signal in signals_of(item) for one in signal.inputs()):
                initial = given(0.0).tolist()
                if given.name in held and held[given.name][1] != initial:
                    raise ModelError(
                        f"input '{given.name}' begins with {held[given.name][1]} in one load and with "
                        f"{initial} in '{item.name}': give all the same initial value"
                    )
                if given.name not in held:
                    held[given.name] = (first, initial)
                    first += given.size

    # Points that share coordinates

    def _share(self) -> None:
        """Find the nodes that pins join; ``self.tree`` holds the pins realised by sharing."""
        parent: dict[Node, Node] = {}

        def find(node: Node) -> Node:
            while parent.setdefault(node, node) != node:
                parent[node] = parent[parent[node]]
                node = parent[node]
            return node

        pins = [j for j in self.model._joints.values() if isinstance(j, Pin)]
        for pin in pins:
            if not pin.here:
                self._require_no_gap(pin)
        speed = max(
            (float(np.abs(self.state[name].v_r).max(initial=0.0)) for name in self.lines), default=0.0
        )
        awkward = self._awkward_nodes()
        candidates: dict[str, tuple[Node, Node]] = {}
        for pin in pins:
            a, b = self._line_node(pin.a), self._line_node(pin.b)
            if a is None or b is None:
                continue
            jump = np.abs(self._node_velocity(a) - self._node_velocity(b)).max()
            if jump <= 1e-6 * speed:
                candidates[pin.name] = (a, b)
        groups: dict[Node, set[Node]] = defaultdict(set)
        for a, b in candidates.values():
            parent[find(a)] = find(b)
        for node in list(parent):
            groups[find(node)].add(node)
        barred = {root for root, members in groups.items() if members & awkward}
        self.tree: dict[str, tuple[Node, Node]] = {}
        self.redundant: set[str] = set()
        roots = {node: find(node) for node in parent}
        parent.clear()
        for name, (a, b) in candidates.items():
            if roots[a] in barred:
                continue
            if find(a) == find(b):
                self.redundant.add(name)
            else:
                parent[find(a)] = find(b)
                self.tree[name] = (a, b)
        classes: dict[Node, list[Node]] = defaultdict(list)
        for node in parent:
            classes[find(node)].append(node)
        for name, body in self.lines.items():
            counts = np.bincount(body.users, minlength=body.nodes)
            for k in np.flatnonzero(counts > 1):
                node = (name, int(k))
                if node not in parent:
                    classes[node] = [node]
        self.classes = list(classes.values())

    def _shared_points(self, relocated: set[str]) -> tuple[FloatArray, FloatArray]:
        """Positions and velocities of the shared points; rows (strand node, point) of each cable."""
        rows: dict[str, list[tuple[int, int]]] = {name: [] for name in self.lines}
        places: list[FloatArray] = []
        speeds: list[FloatArray] = []
        order: dict[str, Any] = {}
        for name, body in self.lines.items():
            sort = np.argsort(body.users, kind="stable")
            order[name] = (sort, np.searchsorted(body.users[sort], np.arange(body.nodes + 1)))
        for number, nodes in enumerate(self.classes):
            name, k = nodes[0]
            first = self.lines[name].first[k]
            source = self.state if name in relocated else self.model_state
            places.append(source[name].r[first])
            speeds.append(self.state[name].v_r[first])
            for name, k in nodes:
                sort, starts = order[name]
                rows[name].extend((int(inner), number) for inner in sort[starts[k] : starts[k + 1]])
        for name, mass in self.masses.items():
            if mass.at is None:
                self.lowered.shared[name] = len(places)
                places.append(self.model_state[name].r[0])
                speeds.append(self.state[name].v_r[0])
        self.rows = rows
        return np.array(places).reshape(-1, 3), np.array(speeds).reshape(-1, 3)

    def _awkward_nodes(self) -> set[Node]:
        """Nodes where forces at the node do not tell a shared pin's reaction: these get multipliers."""
        inside: list[Point] = []
        for load in self.model._loads.values():
            if isinstance(load, Force) and load.follower:
                inside.append(load.at)
            if isinstance(load, Moment) and load.at.node is None:
                inside.append(load.at)
        for joint in self.model._joints.values():
            points = (joint.a, joint.b) if isinstance(joint, Pair) else (joint.a,)
            inside += [p for p in points if isinstance(p, Point) and p.node is None]
        inside += [m.at for m in self.masses.values() if m.at is not None and m.at.node is None]
        nodes: set[Node] = set()
        for point in inside:
            body = self.lines.get(point.body)
            if body is not None:
                nodes |= {(point.body, body.node_of(point.element, end)) for end in (0, 1)}
        return nodes

    def _line_node(self, point: object) -> Node | None:
        if isinstance(point, Point) and point.node is not None and point.body in self.lines:
            return point.body, point.node
        return None

    def _node_velocity(self, node: Node) -> FloatArray:
        velocity: FloatArray = self.state[node[0]].v_r[self.lines[node[0]].first[node[1]]]
        return velocity

    def _place(self, point: Point | WorldPoint) -> FloatArray:
        """Position of a point in the state that the run begins with."""
        if isinstance(point, WorldPoint):
            return np.array(point.position)
        state = self.state[point.body]
        if point.body in self.rigid:
            place: FloatArray = self.rigid[point.body].weights(point) @ state.r
            return place
        body = self.lines.get(point.body)
        if body is None:
            center: FloatArray = state.r[0]
            return center
        first, weights = body.shape(point.element, point.xi)
        place = weights @ np.stack([state.r[first], state.t[first], state.r[first + 1], state.t[first + 1]])
        return place

    def _require_no_gap(self, pin: Pin) -> None:
        gap = float(np.linalg.norm(self._place(pin.a) - self._place(pin.b)))
        if gap > 2e-6 * self.size:
            raise ModelError(
                f"joint '{pin.name}': its points must coincide at the start, but are {gap:.6g} m apart "
                f"({pin.a}; {pin.b})"
            )

    def _relocated(self) -> set[str]:
        """Bodies whose clamped points have moved before the run: clamps hold them where they are now."""
        bodies: set[str] = set()
        if not self.moved:
            return bodies
        for joint in self.model._joints.values():
            if not isinstance(joint, Clamp) or joint.a.body not in self.lines:
                continue
            name = joint.a.body
            body, state = self.lines[name], self.state[name]
            moved = self._place(joint.a) - self.model._position(joint.a)
            node = int(body.element_nodes[joint.a.element]) + round(joint.a.xi)
            turned = state.t[node] / np.linalg.norm(state.t[node]) - body.t[node] / np.linalg.norm(
                body.t[node]
            )
            if max(np.linalg.norm(moved) / self.size, np.linalg.norm(turned)) > 1e-6:
                bodies.add(name)
        for load in self.model._loads.values():
            if isinstance(load, Force) and load.follower and load.at.body in bodies:
                raise ModelError(
                    f"load '{load.name}': a follower force on cable '{load.at.body}' cannot be joined by a "
                    "clamp that holds it where another run left it; clamp it in both runs"
                )
        return bodies

    # Parts of the document

    def _array(self, values: Any) -> Any:
        values = np.ascontiguousarray(values, dtype=np.float64)
        if values.size <= INLINE:
            return values.ravel().tolist()
        self.lowered.arrays.append(values)
        return {"array": len(self.lowered.arrays) - 1}

    def _cable(self, body: LineBody, relocated: bool) -> Json:
        state = self.state[body.name] if relocated else BodyState(body.r, body.t, body.v_r, body.v_t)
        moving = bool(body.v_r.any() or body.v_t.any())
        empty = np.empty((0, 3))
        reference = None
        if body.normal is not None:
            reference = {
                "r": self._array(body.reference_r),
                "t": self._array(body.reference_t),
                "normal": body.normal.tolist(),
            }
        return {
            "name": body.name,
            "strands": self._array(body.strands),
            "r": self._array(state.r),
            "t": self._array(state.t),
            "v_r": self._array(body.v_r if moving else empty),
            "v_t": self._array(body.v_t if moving else empty),
            "lengths": self._array(body.lengths),
            "axial_stiffness": self._array(body.axial_stiffness),
            "bending_stiffness": self._array(body.bending_stiffness),
            "mass_per_length": self._array(body.mass_per_length),
            "strain": body.strain,
            "integration": body.integration,
            "bending": body.bending,
            "reference": reference,
            "tension_only": body.tension_only,
            "retardation_time": body.retardation_time,
            "shared": self._array(np.array(self.rows[body.name], dtype=np.float64).reshape(-1, 2)),
        }

    def _point(self, point: Point | WorldPoint) -> Json:
        if isinstance(point, WorldPoint):
            return {"world": list(point.position)}
        if point.local is not None:
            return {"rigid": self.lowered.rigid[point.body], "local": list(point.local)}
        if point.body in self.masses:
            return {"shared": self.lowered.shared[point.body]}
        return {"cable": self.lowered.cables[point.body], "element": point.element, "xi": point.xi}

    def _joints(self) -> list[Json]:
        documents: list[Json] = []
        plan = self.lowered.plan
        for name, joint in self.model._joints.items():
            if name in self.redundant:
                plan[name] = {"kind": "redundant"}
                continue
            if name in self.tree:
                continue
            plan[name] = {"kind": "multiplier", "index": len(documents)}
            if isinstance(joint, Clamp):
                documents.append(
                    {"kind": "clamp", "name": name, "a": self._point(joint.a), "direction": None}
                )
                continue
            b = joint.b
            if joint.here and isinstance(b, WorldPoint):
                here = self._place(joint.a)
                if np.linalg.norm(here - np.array(b.position)) > 2e-6 * self.size:
                    b = WorldPoint((float(here[0]), float(here[1]), float(here[2])))
            fields = {field.name: getattr(joint, field.name) for field in dataclasses.fields(joint)}
            del fields["here"]
            fields.update(a=self._point(joint.a), b=self._point(b))
            documents.append({"kind": type(joint).__name__.lower(), **fields})
        for name in self.tree:
            plan[name] = self._side(name)
        return documents

    def _side(self, name: str) -> Json:
        """Find what hangs on the first body's side of a shared pin: nodes, masses and joints."""
        side = {self.tree[name][0]}
        while True:
            more = {
                node
                for other, ends in self.tree.items()
                if other != name and (ends[0] in side or ends[1] in side)
                for node in ends
            }
            if more <= side:
                break
            side |= more
        model = self.model
        joints = []
        for other, joint in model._joints.items():
            if self.lowered.plan.get(other, {}).get("kind") != "multiplier":
                continue
            points = ((joint.a, 1.0), (joint.b, -1.0)) if isinstance(joint, Pair) else ((joint.a, 1.0),)
            joints += [[other, sign] for point, sign in points if self._line_node(point) in side]
        return {
            "kind": "shared",
            "nodes": [
                [body, int(inner)]
                for body, node in sorted(side)
                for inner in self.lines[body].inner_nodes(node)
            ],
            "masses": [m.name for m in self.masses.values() if self._line_node(m.at) in side],
            "joints": joints,
        }

    def _load(self, load: Any) -> Json:
        def register(signal: Function | HeldInput) -> int:
            lowered = self.lowered
            if isinstance(signal, HeldInput):
                return lowered.held[signal.name][0]
            last = lowered.inputs[-1] if lowered.inputs else None
            first = last.first + last.size if last else len(lowered.held_values)
            lowered.inputs.append(Input(load.name, signal, first, signal.size))
            return first

        value = load.value.document(register)
        if isinstance(load, LineLoad):
            return {
                "kind": "line",
                "name": load.name,
                "cable": self.lowered.cables[load.body],
                "value": value,
            }
        at = self._point(load.at)
        if isinstance(load, Moment):
            return {"kind": "moment", "name": load.name, "at": at, "value": value}
        return {"kind": "force", "name": load.name, "at": at, "value": value, "follower": load.follower}
