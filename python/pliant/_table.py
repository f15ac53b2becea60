"""A model printed as a table."""

from __future__ import annotations

import dataclasses
import re
from collections.abc import Iterable
from typing import TYPE_CHECKING

import numpy as np

from pliant.beams import BeamBody
from pliant.bodies import LineBody
from pliant.forces import Curvature, ForceData, SheetWind, Wind
from pliant.gas import Chamber
from pliant.joints import EdgeJoint, JointData, SlideCable
from pliant.loads import Force, LineLoad, MovingForce, Pressure, SurfaceLoad
from pliant.redundancy import redundancies
from pliant.rigid import RigidBodyData
from pliant.signals import Constant, Signal
from pliant.surfaces import SurfaceBody

if TYPE_CHECKING:
    from pliant.model import Model

MOST = 60  # rows in a notebook


def _kind(entry: object) -> str:
    """Return the words of a class's name: `LineLoad` is a line load."""
    return re.sub(r"(?<!^)(?=[A-Z])", " ", type(entry).__name__).lower()


def describe(model: Model) -> str:
    """Bodies, joints and loads of a model, one a line."""
    head, rows = _contents(model)
    for name, obstacle in model._obstacles.items():
        place = "({:.6g}, {:.6g}, {:.6g})".format(*obstacle.position)
        rows.append((name, "obstacle", f"{type(obstacle.shape).__name__} at {place}"))
    for name, contact in model._contacts.items():
        law = "no friction" if contact.friction is None else str(contact.friction)
        other = "itself" if contact.a == contact.b else contact.b
        rows.append((name, "contact", f"{contact.a} with {other}, {law}"))
    widths = [max((len(row[k]) for row in rows), default=0) for k in (0, 1)]
    return "\n".join([head, *(f"  {a:<{widths[0]}}  {b:<{widths[1]}}  {c}" for a, b, c in rows)])


def table(head: str, rows: Iterable[Iterable[object]]) -> str:
    """Write a table for notebooks."""
    import html

    cell = "<td style='text-align:left;padding:2px 10px'>"
    lines = ("".join(f"{cell}{html.escape(str(item))}</td>" for item in row) for row in rows)
    return f"<p>{html.escape(head)}</p><table>{''.join(f'<tr>{line}</tr>' for line in lines)}</table>"


def describe_as_html(model: Model) -> str:
    """Bodies, joints and loads of a model as a table; of a long one the beginning."""
    head, rows = _contents(model)
    more = [("...", f"{len(rows) - MOST} more", "")] if len(rows) > MOST else []
    return table(head, [*rows[:MOST], *more])


def _contents(model: Model) -> tuple[str, list[tuple[str, str, str]]]:
    """Give the headline and the rows: name, kind, what there is to say."""
    from pliant._lower import lower

    lowered = lower(model)
    rows: list[tuple[str, str, str]] = []
    for name, body in model._bodies.items():
        if isinstance(body, LineBody):
            what = "cable" if body.kind == "cable" else f"net of {len(body.strands)} cables"
            mass = body.lengths * np.broadcast_to(
                body.mass_per_length if body.mass_per_length.ndim == 1 else body.mass_per_length[:, 2],
                body.lengths.shape,
            )
            size = f"{body.elements} elements, {body.lengths.sum():.6g} m, {mass.sum():.4g} kg"
            text = f"{size}, section {body.section}"
            rows.append((name, what, text))
        elif isinstance(body, RigidBodyData):
            place = "({:.6g}, {:.6g}, {:.6g})".format(*body.position)
            rows.append((name, "rigid body", f"{body.mass:.6g} kg at {place}"))
        elif isinstance(body, BeamBody):
            text = f"{body.elements} elements, {body.lengths.sum():.6g} m, section {body.section}"
            rows.append((name, "beam", text))
        elif isinstance(body, SurfaceBody):
            text = f"{body.elements} {body.element} elements, {body.thickness.mean():.4g} m thick"
            rows.append((name, body.kind, text))
        else:
            rows.append((name, "point mass", f"{body.mass:.6g} kg at {body.at or body.position}"))
    for name, joint in model._joints.items():
        text = " to ".join(str(point) for point in joint.points()) or _joined(joint)
        if isinstance(joint, SlideCable):
            text += f" along {joint.cable}"
        if isinstance(joint, EdgeJoint):
            rows.append((name, joint.kind, str(joint.edge)))
            continue
        how = {"shared": "shares coordinates", "redundant": "redundant", "multiplier": "", "force": ""}[
            lowered.plan[name]["kind"]
        ]
        rows.append((name, _kind(joint), text + (f" ({how})" if how else "")))
    names = {name: row for row, name in enumerate([*model._bodies, *model._joints])}
    for found in redundancies(model):
        name, what, text = rows[names[found.joint]]
        equations = "equation follows" if found.equations == 1 else "equations follow"
        text += f" ({found.equations} {equations} from {', '.join(found.follows_from)})"
        rows[names[found.joint]] = (name, what, text)
    for name, load in model._loads.items():
        if isinstance(load, SurfaceLoad):
            part = load.faces if isinstance(load, Pressure) else load.edge
            rows.append((name, _kind(load), f"{_value(load.value)} on {part}"))
            continue
        if isinstance(load, Chamber):
            enclosed = ", ".join(map(str, load.faces))
            rows.append((name, "chamber", f"{load.gas.pressure:g} Pa in {enclosed}"))
        elif isinstance(load, LineLoad):
            rows.append((name, "line load", f"{_value(load.value)} N/m on {load.body}"))
        elif isinstance(load, MovingForce):
            rows.append((name, "moving force", f"{_value(load.value)} N on {load.body}"))
        elif isinstance(load, Wind):
            rows.append((name, "wind", f"{_value(load.velocity)} m/s on {load.body}"))
        elif isinstance(load, SheetWind):
            rows.append((name, "wind", f"{_value(load.velocity)} m/s on {load.faces}"))
        elif isinstance(load, Curvature):
            rows.append((name, "rest curvature", f"{_value(load.value)} 1/m on {load.faces}"))
        elif isinstance(load, ForceData):
            numbers = (
                f"{entry.name} {getattr(load, entry.name):g}"
                for entry in dataclasses.fields(load)
                if isinstance(getattr(load, entry.name), float)
            )
            places = " to ".join(str(point) for point in load.points())
            rows.append((name, _kind(load), f"{', '.join(numbers)}, {places}"))
        elif isinstance(load, Force):
            rows.append(
                (name, "follower force" if load.follower else "force", f"{_value(load.value)} N at {load.at}")
            )
        else:
            rows.append((name, "moment", f"{_value(load.value)} N m at {load.at}"))
    head = (
        f"Model: gravity ({', '.join(f'{g:g}' for g in model.gravity)}) m/s^2, "
        f"{lowered.coordinates} coordinates, {lowered.multipliers} constraints"
    )
    return head, rows


def _joined(joint: JointData) -> str:
    """Names of the joints that a drive or gear acts on."""
    names = (getattr(joint, key, None) for key in ("joint", "joint_a", "joint_b"))
    return " to ".join(name for name in names if name is not None)


def _value(signal: Signal) -> str:
    if isinstance(signal, Constant):
        return f"({', '.join(f'{x:g}' for x in signal.value)})"
    return type(signal).__name__.lower() + " of time"
