"""Lowering: a model becomes the document and the arrays that the core computes with."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from pliant._closure import Closure
from pliant._crease import Crease
from pliant._edges import EdgeEquations, is_held
from pliant._lowered import BodyState, Input, Lowered, is_load, numbers_of, signals_of
from pliant._sharing import Sharing
from pliant._sides import document, is_of_lines
from pliant._stops import stops
from pliant.beams import BeamBody
from pliant.bodies import LineBody
from pliant.contacts import ContactData, arc, knots
from pliant.errors import ModelError
from pliant.forces import ON_FACES, ForceData, Wind
from pliant.gas import Chamber
from pliant.joints import (
    Clamp,
    Cylindrical,
    Distance,
    DriveAxis,
    DriveForce,
    DriveJoint,
    DrivePoint,
    EdgeJoint,
    Fold,
    Gear,
    Hinge,
    JointData,
    Pair,
    Pin,
    SlideCable,
    SlideLine,
    Slider,
    Sprung,
    Universal,
    Weld,
)
from pliant.loads import EdgeMoment, LineLoad, Moment, MovingForce, Pressure, SurfaceLoad
from pliant.points import Point, WorldPoint
from pliant.signals import Function, Signal
from pliant.signals import Input as HeldInput
from pliant.surfaces import SurfaceBody
from pliant.typing import FloatArray, Json

if TYPE_CHECKING:
    from pliant.model import Model

__all__ = ["lower"]

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
    SlideLine: 2,
    SlideCable: 3,
    DriveJoint: 1,
    DriveAxis: 1,
    Gear: 1,
}

KINDS: dict[type, str] = {SlideLine: "slide_line"}


def lower(
    model: Model,
    state: Mapping[str, BodyState] | None = None,
    gas: Mapping[str, float] | None = None,
    past: Mapping[str, FloatArray] | None = None,
) -> Lowered:
    """Lower a model.

    ``state`` is the state that the run begins with, where it is not the model's own, ``gas`` the masses in
    its chambers, ``past`` what the points of cables that yield remember.
    """
    lowering = _Lowering(model, state)
    lowering.gas, lowering.past = gas or {}, past or {}
    return lowering.run()


class _Lowering(Sharing):
    gas: Mapping[str, float]
    past: Mapping[str, FloatArray]

    def run(self) -> Lowered:
        out = self.lowered
        self._number_inputs()
        self._share()
        relocated = self._relocated()
        places, speeds = self._shared_points(relocated)
        joints = self._joints()
        contacts = list(self.model._contacts.values())
        of_lines = [contact.name for contact in contacts if self._is_of_lines(contact)]
        out.contacts = {name: k for k, name in enumerate(of_lines)}
        out.document = {
            "version": VERSION,
            "gravity": self.model.gravity.tolist(),
            "shared_points": self._array(places),
            "shared_velocities": self._array(speeds),
            "cables": [self._cable(body, body.name in relocated) for body in self.lines.values()],
            "surfaces": [self._surface(body) for body in self.surfaces.values()],
            "beams": [self._beam(body, body.name in relocated) for body in self.beams.values()],
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
            "latches": self._latches(),
            "loads": [self._load(load) for load in self.model._loads.values() if is_load(load)],
            "forces": self._forces(),
            "chambers": self._chambers(),
            "contacts": [self._contact(contact) for contact in contacts if contact.name in out.contacts],
            "probe_contacts": [
                document(contact, self) for contact in contacts if contact.name not in out.contacts
            ],
        }
        out.multipliers = 6 * len(self.rigid) + sum(
            self._equations(joint)
            for name, joint in self.model._joints.items()
            if out.plan[name]["kind"] == "multiplier"
        )
        out.multipliers += sum(plan.get("equations", 0) for plan in out.plan.values())
        nodes = sum(len(body.users) for body in self.lines.values())
        out.coordinates = (
            6 * nodes - 3 * sum(map(len, self.rows.values())) + 3 * len(places) + 12 * len(self.rigid)
        )
        out.coordinates += sum(isinstance(joint, SlideCable) for joint in self.model._joints.values())
        out.coordinates += sum(body.q.size for body in self.surfaces.values())
        out.coordinates += sum(body.q.size for body in self.beams.values())
        return out

    def _equations(self, joint: JointData) -> int:
        """Count the equations of a joint; a cable has one direction, which cannot twist."""
        if isinstance(joint, DrivePoint):
            return joint.equations
        count = EQUATIONS[type(joint)]
        if isinstance(joint, (Hinge, Cylindrical, Universal)):
            # The section of a beam keeps its shape where it is held by single directions.
            count += sum(isinstance(p, Point) and p.offset is not None for p in joint.points())
        for tangent in map(self.model._tangent, joint.points()):
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
        model = self.model
        for item in [*model._bodies.values(), *model._joints.values(), *model._loads.values()]:
            for given in (one for signal in signals_of(item) for one in signal.inputs()):
                initial = given(0.0).tolist()
                if given.name in held and held[given.name][1] != initial:
                    raise ModelError(
                        f"input '{given.name}' begins with {held[given.name][1]} in one place and with "
                        f"{initial} in '{item.name}': give all the same initial value"
                    )
                if given.name not in held:
                    held[given.name] = (first, initial)
                    first += given.size

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
        plastic = None
        if body.yield_strain is not None:
            plastic = {
                "yield_strain": body.yield_strain,
                "isotropic": body.isotropic_hardening,
                "kinematic": body.kinematic_hardening,
                "past": self._array(self.past.get(body.name, np.empty(0))),
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
            "rest_length": None if body.rest_length is None else self._signal(body.rest_length, body.name),
            "tension_only": body.tension_only,
            "plastic": plastic,
            "retardation_time": body.retardation_time,
            "radius": self._array(body.radius),
            "shared": self._array(np.array(self.rows[body.name], dtype=np.float64).reshape(-1, 2)),
        }

    def _surface(self, body: SurfaceBody) -> Json:
        law = {
            "kind": body.law,
            "youngs_modulus": body.youngs_modulus,
            "poisson_ratio": body.poisson_ratio,
        }
        if body.law == "tension_field":
            law["residual_stiffness"] = body.residual_stiffness
        empty = np.empty(0)
        return {
            "name": body.name,
            "vectors": body.vectors,
            "reference": self._array(body.reference),
            "q": self._array(empty if body.q is body.reference else body.q),
            "v": self._array(body.v if body.v.any() else empty),
            "quads": self._array(body.quads),
            "quad_sizes": self._array(body.quad_sizes),
            "triangles": self._array(body.triangles),
            "triangle_charts": self._array(body.triangle_charts),
            "turns": self._array(body.turns),
            "thickness": self._array(body.thickness),
            "material": law,
            "density": body.density,
            "retardation_time": body.retardation_time,
            "quadrature": body.quadrature,
            "bending": body.bending,
            "integrals": body.integrals,
        }

    def _beam(self, body: BeamBody, relocated: bool) -> Json:
        start = self.state[body.name].r if relocated else body.q
        empty = np.empty(0)
        arrays = {name: self._array(getattr(body, name)) for name in ("lengths", "reference", "stretch")}
        arrays |= {name: self._array(getattr(body, name)) for name in ("bend", "mass", "section_points")}
        numbers = ("youngs_modulus", "poisson_ratio", "density", "retardation_time", "locking")
        return {
            "name": body.name,
            **arrays,
            "q": self._array(empty if start is body.reference else start),
            "v": self._array(body.v if body.v.any() else empty),
            "radius": self._array(body.radius),
            **{name: getattr(body, name) for name in numbers},
        }

    def _point(self, point: Point | WorldPoint) -> Json:
        if isinstance(point, WorldPoint):
            return {"world": list(point.position)}
        if point.local is not None:
            return {"rigid": self.lowered.rigid[point.body], "local": list(point.local)}
        if point.offset is not None:
            place = {"element": point.element, "xi": point.xi, "offset": list(point.offset)}
            return {"beam": self.lowered.beams[point.body], **place}
        if point.at is not None:
            return {
                "surface": self.lowered.surfaces[point.body],
                "face": point.element,
                "at": list(point.at),
            }
        if point.body in self.masses:
            return {"shared": self.lowered.shared[point.body]}
        return {"cable": self.lowered.cables[point.body], "element": point.element, "xi": point.xi}

    def _joints(self) -> list[Json]:
        documents: list[Json] = []
        plan = self.lowered.plan
        slides = 0
        edges = EdgeEquations(self.model, self.lowered.rigid)
        for name, joint in self.model._joints.items():
            if isinstance(joint, EdgeJoint):
                if isinstance(joint, Fold):
                    held = self._crease(joint).documents(name, self.lowered.surfaces, self._meant(joint))
                else:
                    held = edges.of(joint, self.lowered.surfaces)
                plan[name] = {
                    "kind": "nodes",
                    "indices": list(range(len(documents), len(documents) + len(held))),
                    "nodes": [document["a"]["node"] for document in held],
                    "equations": sum(len(document["equations"]) for document in held),
                }
                documents += held
                if isinstance(joint, Fold) and joint.is_held:
                    plan[name]["drives"] = list(range(len(documents), len(documents) + len(held)))
                    documents += self._held_angles(joint)
                continue
            if name in self.redundant:
                plan[name] = {"kind": "redundant"}
                continue
            if name in self.tree:
                continue
            if isinstance(joint, DriveForce):
                plan[name] = {"kind": "force"}
                continue
            plan[name] = {"kind": "multiplier", "index": len(documents)}
            if not isinstance(joint, Pair | Clamp | SlideCable):
                documents.append(self._drive(joint))
                continue
            if isinstance(joint, Clamp):
                documents.append(
                    {"kind": "clamp", "name": name, "a": self._point(joint.a), "direction": None}
                )
                continue
            if isinstance(joint, SlideCable):
                cable, s = self.lowered.cables[joint.cable], self._arc_length(joint)
                slide, slides = slides, slides + 1
                place = {"a": self._point(joint.a), "cable": cable, "slide": slide, "s": s}
                documents.append({"kind": "slide_cable", "name": name, **place})
                continue
            b = joint.b
            if joint.here and isinstance(b, WorldPoint):
                here = self._place(joint.a)
                if np.linalg.norm(here - np.array(b.position)) > 2e-6 * self.size:
                    b = WorldPoint((float(here[0]), float(here[1]), float(here[2])))
            fields = {field.name: getattr(joint, field.name) for field in dataclasses.fields(joint)}
            for other in ("here", "stiffness", "damping", "rest", "limits"):
                fields.pop(other, None)
            fields.update(a=self._point(joint.a), b=self._point(b))
            documents.append({"kind": KINDS.get(type(joint), type(joint).__name__.lower()), **fields})
        plan.update(self._sides())
        return documents

    def _crease(self, joint: Fold) -> Crease:
        assert joint.other is not None
        return Crease(self.model, joint.edge, joint.other)

    def _rest(self, joint: Fold) -> FloatArray:
        """Angle of a fold without moment at each node, as far as it is constant."""
        if joint.angle is None:
            return self._crease(joint).angles(stress_free=True)
        constant = float(joint.angle(0.0)[0]) if joint.angle.constant else 0.0
        return np.full(len(joint.edge.nodes), constant)

    def _meant(self, joint: Fold) -> FloatArray:
        """Near which angle a fold starts, of those that differ by turns: between flat and its rest."""
        if joint.angle is not None:
            wanted = np.full(len(joint.edge.nodes), float(joint.angle(0.0)[0]))
            return wanted if joint.is_held else 0.5 * wanted
        return 0.5 * self._rest(joint)

    def _held_angles(self, joint: Fold) -> list[Json]:
        """Drives of the angles of a fold."""
        assert joint.angle is not None
        value = self._signal(joint.angle, joint.name)
        return [
            {"kind": "drive_joint", "name": joint.name, "joint": index, "value": value, "rate": False}
            for index in self.lowered.plan[joint.name]["indices"]
        ]

    def _sprung_angles(self, joint: Fold) -> list[Json]:
        """Springs and dampers of a fold at its nodes; a rest that moves is a drive: k (angle - theta)."""
        value = None
        if joint.angle is not None and not joint.angle.constant:
            value = self._signal(joint.angle, joint.name)
        documents: list[Json] = []
        nodes = zip(
            self.lowered.plan[joint.name]["indices"],
            self._crease(joint).lengths.tolist(),
            self._rest(joint).tolist(),
            strict=True,
        )
        for index, length, rest in nodes:
            k = joint.stiffness * length
            drive = None if value is None else {"product": [{"constant": [k]}, value]}
            along = {"stiffness": k, "damping": joint.damping * length, "rest": rest, "stops": None}
            documents.append({"kind": "joint", "name": joint.name, "joint": index, **along, "drive": drive})
        return documents

    def _arc_length(self, joint: SlideCable) -> float:
        """Arc length of a sliding point in the state that the run begins with."""
        state = self.state[joint.cable]
        body = dataclasses.replace(self.lines[joint.cable], r=state.r, t=state.t)
        at = body.nearest(self._place(joint.a), self.model.identity)
        return float(body.lengths[: at.element].sum() + at.xi * body.lengths[at.element])

    def _latches(self) -> list[Json]:
        """Joints that are released and engaged, or could be."""
        for name in self.model._joints:
            if not self.model._latch(name).is_permanent:
                self.model._require_free(name)
        return [
            {"joint": index, **latch.document(), "engaged": latch.holds_at_start}
            for name, latch in ((name, self.model._latch(name)) for name in self.model._joints)
            if latch.floats or not latch.is_permanent
            for index in numbers_of(self.lowered.plan[name])
        ]

    def _drive(self, joint: DrivePoint | DriveJoint | DriveAxis | DriveForce | Gear) -> Json:
        """Document of a drive or gear: names of joints become their numbers."""
        plan = self.lowered.plan
        kinds = {DrivePoint: "drive_point", DriveJoint: "drive_joint", DriveAxis: "drive_axis", Gear: "gear"}
        document: Json = {"kind": kinds[type(joint)]}
        for entry in dataclasses.fields(joint):
            value = getattr(joint, entry.name)
            if isinstance(value, Signal):
                value = self._signal(value, joint.name)
            elif isinstance(value, Point):
                value = self._point(value)
            elif entry.name.startswith("joint"):
                value = plan[value]["index"]
            document[entry.name] = value
        if isinstance(joint, DrivePoint):
            axes = [document.pop(f"axis_{k}") for k in "xyz"]
            document["orientation"] = axes if axes[0] is not None else None
        return document

    def _is_of_lines(self, contact: ContactData) -> bool:
        model = self.model
        a, b = (model._bodies.get(name) or model._obstacles[name] for name in (contact.a, contact.b))
        return is_of_lines(a, b)

    def _contact(self, contact: ContactData) -> Json:
        """Write a contact; the line of the finer mesh carries the points."""
        lines: dict[str, LineBody | BeamBody] = {**self.lines, **self.beams}
        a = lines[contact.a]
        other = lines.get(contact.b)
        slave, master = a, other
        if other is not None and other is not a and other.lengths.mean() < a.lengths.mean():
            slave, master = other, a
        document: Json = {
            "name": contact.name,
            "slave": self.lowered.line(slave.name),
            **contact.laws([slave] if master is None or master is slave else [slave, master]),
            # Closer than half a turn of the tightest bend a line cannot meet itself.
            "window": 1.05 * np.pi * float(slave.radius.max()) if master is slave else 0.0,
            "apart": self._array(self._apart(contact, slave, master)),
        }
        if master is None:
            document["master"] = self.model._obstacles[contact.b].document()
        else:
            document["master"] = {"kind": "line", "line": self.lowered.line(master.name)}
        return document

    def _apart(
        self, contact: ContactData, slave: LineBody | BeamBody, master: LineBody | BeamBody | None
    ) -> Any:
        """Arc lengths on both sides of what joins them, and how far around nothing touches, (k, 3)."""
        rows: list[tuple[float, float, float]] = []
        if master is None:
            return rows
        width = 3.0 * float(slave.radius.max() + master.radius.max())
        for joint in self.model._joints.values():
            given = (getattr(joint, "a", None), getattr(joint, "b", None))
            sides = {side.name: side for side in (slave, master)}
            ends = [p for p in given if isinstance(p, Point) and p.body in sides]
            places = {p.body: arc(sides[p.body], p) for p in ends}
            if slave is not master and {slave.name, master.name} == set(places):
                rows.append((places[slave.name], places[master.name], width))
            elif slave is master and len(ends) == 2 and set(places) == {slave.name}:
                rows.append((arc(slave, ends[0]), arc(slave, ends[1]), width))
        if slave is master and isinstance(slave, LineBody):
            rows += [(one, other, width) for one, other in knots(slave)]
        return rows

    def _forces(self) -> list[Json]:
        documents: list[Json] = []
        for name, force in self.model._loads.items():
            if not isinstance(force, ForceData):
                continue
            self.lowered.forces[name] = len(documents)
            entries = self._plain(force.entries(), name)
            if isinstance(force, Wind):
                entries["cable"] = self.lowered.cables[force.body]
                entries["diameters"] = (2.0 * self.lines[force.body].radius).tolist()
            if isinstance(force, ON_FACES):
                entries["surface"] = self.lowered.surfaces[force.faces.body]
                entries["faces"] = self._array(np.array(force.faces.numbers, dtype=np.float64))
            kind = getattr(force, "kind", type(force).__name__.lower())
            documents.append({"kind": kind, **entries})
        for name, joint in self.model._joints.items():
            along: Json
            if isinstance(joint, Fold):
                if joint.stiffness or joint.damping:
                    springs = self._sprung_angles(joint)
                    numbers = range(len(documents), len(documents) + len(springs))
                    self.lowered.plan[name]["springs"] = list(numbers)
                    documents += springs
                continue
            if isinstance(joint, Sprung) and joint.is_sprung:
                along = {key: getattr(joint, key) for key in ("stiffness", "damping", "rest")}
                along.update(joint=name, stops=stops(self.model, joint), drive=None)
            elif isinstance(joint, DriveForce):
                along = {"stiffness": 0.0, "damping": 0.0, "rest": 0.0, "joint": joint.joint, "stops": None}
                along["drive"] = self._signal(joint.value, name)
            else:
                continue
            along["joint"] = self.lowered.plan[along["joint"]]["index"]
            self.lowered.forces[name] = len(documents)
            documents.append({"kind": "joint", "name": name, **along})
        return documents

    def _chambers(self) -> list[Json]:
        documents: list[Json] = []
        for name, chamber in self.model._loads.items():
            if not isinstance(chamber, Chamber):
                continue
            closure = Closure(self.model, chamber.faces, name)
            closure.require_joined()
            self.lowered.chambers[name] = len(documents)
            documents.append(
                {
                    "name": name,
                    **closure.document(self.lowered.surfaces, self._array),
                    "gas": dataclasses.asdict(chamber.gas),
                    "mass": self.gas.get(name),
                    "inflow": self._signal(chamber.inflow, name) if chamber.flows else None,
                    "ambient": chamber.ambient,
                }
            )
        return documents

    def _plain(self, value: Any, name: str) -> Any:
        """Lower the points and signals within an entry of a document."""
        if isinstance(value, (Point, WorldPoint)):
            return self._point(value)
        if isinstance(value, Signal):
            return self._signal(value, name)
        if isinstance(value, dict):
            return {key: self._plain(item, name) for key, item in value.items()}
        if isinstance(value, tuple):
            return [self._plain(item, name) for item in value]
        return value

    def _signal(self, signal: Signal, name: str) -> Json:
        """Document of a signal of the load or joint of that name; its callables get their numbers."""

        def register(one: Function | HeldInput) -> int:
            lowered = self.lowered
            if isinstance(one, HeldInput):
                return lowered.held[one.name][0]
            last = lowered.inputs[-1] if lowered.inputs else None
            first = last.first + last.size if last else len(lowered.held_values)
            lowered.inputs.append(Input(name, one, first, one.size))
            return first

        return signal.document(register)

    def _load(self, load: Any) -> Json:
        if isinstance(load, EdgeMoment):
            body = self.surfaces[load.edge.body]
            sides, forwards = body.sides_running(list(load.edge.nodes))
            # The core's axis is the direction in which the sides of the faces run.
            value = self._signal(load.value if forwards else -load.value, load.name)
            surface = self.lowered.surfaces[load.edge.body]
            numbers = self._array(np.array(sides))
            return {
                "kind": "edge_moment",
                "name": load.name,
                "surface": surface,
                "value": value,
                "sides": numbers,
            }
        value = self._signal(load.value, load.name)
        if isinstance(load, MovingForce):
            return {
                "kind": "moving",
                "name": load.name,
                "cable": self.lowered.cables[load.body],
                "value": value,
                "position": self._signal(load.position, load.name),
            }
        if isinstance(load, LineLoad) and load.body in self.beams:
            beam = self.lowered.beams[load.body]
            return {"kind": "beam_line", "name": load.name, "beam": beam, "value": value}
        if isinstance(load, LineLoad):
            return {
                "kind": "line",
                "name": load.name,
                "cable": self.lowered.cables[load.body],
                "value": value,
            }
        if isinstance(load, SurfaceLoad):
            part = load.faces if isinstance(load, Pressure) else load.edge
            entries = {"name": load.name, "surface": self.lowered.surfaces[part.body], "value": value}
            if isinstance(load, Pressure):
                held = is_held(self.model, self.surfaces[part.body], load.faces.numbers)
                faces = self._array(np.array(load.faces.numbers))
                return {"kind": "pressure", **entries, "faces": faces, "conservative": held}
            return {"kind": "edge", **entries, "sides": self._array(np.array(load.edge.sides))}
        at = self._point(load.at)
        if isinstance(load, Moment):
            return {"kind": "moment", "name": load.name, "at": at, "value": value}
        return {"kind": "force", "name": load.name, "at": at, "value": value, "follower": load.follower}
