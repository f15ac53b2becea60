"""Nodes that pins join share their position: which they are, and what is left to multipliers."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from pliant._lowered import BodyState, Lowered, initial_state
from pliant.beams import BeamBody
from pliant.bodies import LineBody, MassBody
from pliant.errors import ModelError
from pliant.forces import ForceData, Wind
from pliant.joints import Clamp, Pin, SlideCable
from pliant.loads import Force, Moment, MovingForce
from pliant.points import Point, WorldPoint
from pliant.rigid import RigidBodyData
from pliant.surfaces import SurfaceBody
from pliant.typing import FloatArray, IntArray, Json

if TYPE_CHECKING:
    from pliant.model import Model

__all__ = ["Sharing"]

Node = tuple[str, int]


class Sharing:
    """A model in the state that a run begins with, and the points that share coordinates."""

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
        self.users: dict[str, tuple[IntArray, IntArray]] = {}
        self.lowered.rigid = {name: k for k, name in enumerate(self.rigid)}
        self.surfaces = {name: body for name, body in model._bodies.items() if isinstance(body, SurfaceBody)}
        self.lowered.surfaces = {name: k for k, name in enumerate(self.surfaces)}
        self.beams = {name: body for name, body in model._bodies.items() if isinstance(body, BeamBody)}
        self.lowered.beams = {name: k for k, name in enumerate(self.beams)}
        self.lowered.cables = {name: k for k, name in enumerate(self.lines)}

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
            if not pin.here and self.model._latch(pin.name).holds_at_start:
                self._require_no_gap(pin)
        speed = max(
            (float(np.abs(self.state[name].v_r).max(initial=0.0)) for name in self.lines), default=0.0
        )
        awkward = self._awkward_nodes()
        candidates: dict[str, tuple[Node, Node]] = {}
        for pin in pins:
            a, b = self._line_node(pin.a), self._line_node(pin.b)
            if a is None or b is None or not self.model._latch(pin.name).is_permanent:
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
        for name, body in self.lines.items():
            sort = np.argsort(body.users, kind="stable")
            self.users[name] = (sort, np.searchsorted(body.users[sort], np.arange(body.nodes + 1)))
        for number, nodes in enumerate(self.classes):
            name, k = nodes[0]
            first = self.lines[name].first[k]
            source = self.state if name in relocated else self.model_state
            places.append(source[name].r[first])
            speeds.append(self.state[name].v_r[first])
            for name, k in nodes:
                rows[name].extend((int(inner), number) for inner in self._inner(name, k))
        for name, mass in self.masses.items():
            if mass.at is None:
                self.lowered.shared[name] = len(places)
                places.append(self.model_state[name].r[0])
                speeds.append(self.state[name].v_r[0])
        self.rows = rows
        return np.array(places).reshape(-1, 3), np.array(speeds).reshape(-1, 3)

    def _inner(self, name: str, node: int) -> IntArray:
        """Strand nodes that a node of a body stands for, ascending."""
        sort, starts = self.users[name]
        return sort[starts[node] : starts[node + 1]]

    def _awkward_nodes(self) -> set[Node]:
        """Nodes where forces at the node do not tell a shared pin's reaction: these get multipliers."""
        inside: list[Point] = []
        for load in self.model._loads.values():
            if isinstance(load, ForceData):
                inside += [point for point in load.points() if isinstance(point, Point)]
            if isinstance(load, Force) and load.follower:
                inside.append(load.at)
            if isinstance(load, Moment) and load.at.node is None:
                inside.append(load.at)
        for joint in self.model._joints.values():
            inside += [p for p in joint.points() if isinstance(p, Point) and p.node is None]
        slid = {j.cable for j in self.model._joints.values() if isinstance(j, SlideCable)}
        on_path = {(name, node) for name in slid for node in range(self.lines[name].nodes)}
        inside += [m.at for m in self.masses.values() if m.at is not None and m.at.node is None]
        nodes: set[Node] = on_path
        for load in self.model._loads.values():
            if isinstance(load, (MovingForce, Wind)):
                nodes |= {(load.body, k) for k in range(self.lines[load.body].nodes)}
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
        if point.body in self.surfaces:
            surface = self.surfaces[point.body]
            return surface.place(point, state.r.reshape(surface.q.shape))
        if point.body in self.beams:
            beam = self.beams[point.body]
            return beam.place(point, state.r.reshape(beam.q.shape))
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
            if not isinstance(joint, Clamp):
                continue
            name = joint.a.body
            if name in self.beams and self._has_moved(self.beams[name], joint.a):
                bodies.add(name)
            if name not in self.lines:
                continue
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
                    f"load '{load.name}': a follower force on '{load.at.body}' cannot be joined by a "
                    "clamp that holds it where another run left it; clamp it in both runs"
                )
        return bodies

    def _has_moved(self, beam: BeamBody, point: Point) -> bool:
        """Whether the position or the section of a point of a beam has moved before the run."""
        q = self.state[beam.name].r.reshape(beam.q.shape)
        node = point.element + round(point.xi)
        moved = beam.place(point, q) - beam.place(point)
        turned = q[node, 2:] - beam.q[node, 2:]
        return max(float(np.linalg.norm(moved)) / self.size, float(np.abs(turned).max())) > 1e-6

    def _sides(self) -> dict[str, Json]:
        """Find what hangs on the first body's side of each shared pin: nodes, masses and joints."""
        linked: dict[Node, list[Node]] = defaultdict(list)
        for a, b in self.tree.values():
            linked[a].append(b)
            linked[b].append(a)
        acting: dict[Node, list[tuple[int, str, float]]] = defaultdict(list)
        for number, (name, joint) in enumerate(self.model._joints.items()):
            if self.lowered.plan.get(name, {}).get("kind") == "multiplier":
                for point, sign in zip(joint.points(), (1.0, -1.0), strict=False):
                    node = self._line_node(point)
                    if node is not None:
                        acting[node].append((number, name, sign))
        carrying: dict[Node, list[tuple[int, str]]] = defaultdict(list)
        for number, mass in enumerate(self.masses.values()):
            node = self._line_node(mass.at)
            if node is not None:
                carrying[node].append((number, mass.name))
        sides = {}
        for name, (first, second) in self.tree.items():
            # A tree: without this pin the second node cannot be reached from the first.
            side, open_nodes = {first}, [first]
            while open_nodes:
                here = open_nodes.pop()
                for node in linked[here]:
                    if node not in side and (here, node) != (first, second):
                        side.add(node)
                        open_nodes.append(node)
            joints = sorted((entry for node in side for entry in acting.get(node, ())), key=_order)
            masses = sorted(entry for node in side for entry in carrying.get(node, ()))
            sides[name] = {
                "kind": "shared",
                "nodes": [[body, int(k)] for body, node in sorted(side) for k in self._inner(body, node)],
                "masses": [mass for _, mass in masses],
                "joints": [[joint, sign] for _, joint, sign in joints],
            }
        return sides


def _order(entry: tuple[int, str, float]) -> tuple[int, float]:
    """Joints as in the model, the first point before the second."""
    number, _, sign = entry
    return number, -sign
