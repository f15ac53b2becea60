"""Models as JSON documents."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from typing import Any

import numpy as np

from pliant.beams import BeamBody
from pliant.bodies import LineBody, MassBody
from pliant.contacts import Bore, ContactData, HalfSpace, ObstacleData, TriangleMesh
from pliant.errors import ModelError
from pliant.forces import FORCES
from pliant.friction import Coulomb, LuGre
from pliant.gas import Chamber, Gas
from pliant.joints import JOINTS
from pliant.loads import EdgeLoad, EdgeMoment, Force, LineLoad, Moment, MovingForce, Pressure
from pliant.points import Point, WorldPoint
from pliant.rigid import RigidBodyData
from pliant.shapes import SHAPES
from pliant.signals import Combination, Constant, Function, Input, LostFunction, Ramp, Table
from pliant.surfaces import Edge, Faces, SurfaceBody

VERSION = 1
KINDS: Mapping[str, type[Any]] = {
    kind.__name__: kind
    for kind in (
        LineBody,
        SurfaceBody,
        BeamBody,
        Edge,
        Faces,
        EdgeLoad,
        EdgeMoment,
        Pressure,
        Chamber,
        Gas,
        MassBody,
        RigidBodyData,
        *SHAPES,
        *JOINTS,
        *FORCES,
        ContactData,
        ObstacleData,
        HalfSpace,
        TriangleMesh,
        Bore,
        LuGre,
        Coulomb,
        Force,
        Moment,
        LineLoad,
        MovingForce,
        Point,
        WorldPoint,
        Constant,
        Table,
        Ramp,
        Input,
        Combination,
        LostFunction,
    )
}


def encode(value: Any, place: str, keep_functions: bool = True) -> Any:
    """Write a value as JSON; refuses callables, or leaves markers where ``keep_functions`` is off."""
    if isinstance(value, Function):
        if keep_functions:
            raise ModelError(
                f"{place}: a Python callable cannot be saved; "
                "pliant.Table.sample(function, times) makes a table of it"
            )
        return {"type": "LostFunction", "components": value.components}
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        fields = {
            field.name: encode(getattr(value, field.name), place, keep_functions)
            for field in dataclasses.fields(value)
        }
        return {"type": type(value).__name__, **fields}
    if isinstance(value, np.ndarray):
        return value.tolist()
    if isinstance(value, (list, tuple)):
        return [encode(item, place, keep_functions) for item in value]
    if value is None or isinstance(value, (bool, int, float, str)):
        return value
    raise ModelError(f"{place}: {type(value).__name__} cannot be saved")


def decode(value: Any) -> Any:
    """Read what :func:`encode` wrote; KeyError, TypeError or ValueError where it is something else."""
    if isinstance(value, dict):
        fields = {name: decode(item) for name, item in value.items() if name != "type"}
        return KINDS[value["type"]](**fields)
    if isinstance(value, list):
        return [decode(item) for item in value]
    return value
