"""Dynamics of soft machines: cables by the absolute nodal coordinate formulation and generalized-alpha.

>>> import pliant as pl
>>> model = pl.Model(gravity=(0, 0, -9.81))
>>> rubber = pl.LinearElastic(youngs_modulus=1e7, poisson_ratio=0.45, density=1000.0)
>>> round_bar = pl.Circle(radius=5e-3)
>>> rope = model.add_cable([(0, 0, 0), (1, 0, 0)], elements=8, section=round_bar, material=rubber)
>>> pin = model.pin(rope.start)
>>> result = pl.simulate(model, duration=0.1, step=1e-3)
>>> result.track(rope.end).position.shape
(101, 3)
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from pliant.beams import Beam
from pliant.contacts import Bore, HalfSpace, TriangleMesh
from pliant.curves import Curve
from pliant.errors import ConvergenceError, FileError, ModelError
from pliant.friction import Coulomb, LuGre, lugre
from pliant.gas import Gas
from pliant.materials import (
    BilinearPlastic,
    LinearElastic,
    NeoHookean,
    SaintVenantKirchhoff,
    youngs_modulus_from_shore_a,
)
from pliant.mesh import Mesh
from pliant.model import Model
from pliant.points import (
    Cable,
    CableNet,
    Contact,
    Joint,
    Line,
    Load,
    Obstacle,
    Point,
    PointMass,
    RigidBody,
)
from pliant.sections import Circle, Rectangle, Section, Tube
from pliant.shapes import Box, Capsule, Cylinder, Sphere
from pliant.signals import Input, Ramp, Table
from pliant.surfaces import Edge, Faces, Membrane, Shell

if TYPE_CHECKING:
    from pliant import scenes, sdi
    from pliant.modes import Modes, solve_modes
    from pliant.result import Result
    from pliant.simulation import resume, simulate, simulate_many
    from pliant.statics import solve_static
    from pliant.stepper import Stepper

__all__ = [
    "Beam",
    "BilinearPlastic",
    "Bore",
    "Box",
    "Cable",
    "CableNet",
    "Capsule",
    "Circle",
    "Contact",
    "ConvergenceError",
    "Coulomb",
    "Curve",
    "Cylinder",
    "Edge",
    "Faces",
    "FileError",
    "Gas",
    "HalfSpace",
    "Input",
    "Joint",
    "Line",
    "LinearElastic",
    "Load",
    "LuGre",
    "Membrane",
    "Mesh",
    "Model",
    "ModelError",
    "Modes",
    "NeoHookean",
    "Obstacle",
    "Point",
    "PointMass",
    "Ramp",
    "Rectangle",
    "Result",
    "RigidBody",
    "SaintVenantKirchhoff",
    "Section",
    "Shell",
    "Sphere",
    "Stepper",
    "Table",
    "TriangleMesh",
    "Tube",
    "lugre",
    "resume",
    "scenes",
    "sdi",
    "simulate",
    "simulate_many",
    "solve_modes",
    "solve_static",
    "youngs_modulus_from_shore_a",
]


# What runs models is imported when it is asked for first: describing one takes much less.
_HOMES = {
    "Modes": "pliant.modes",
    "Result": "pliant.result",
    "Stepper": "pliant.stepper",
    "__version__": "pliant._core",
    "resume": "pliant.simulation",
    "simulate": "pliant.simulation",
    "simulate_many": "pliant.simulation",
    "solve_modes": "pliant.modes",
    "solve_static": "pliant.statics",
}


def __getattr__(name: str) -> object:
    import importlib

    if name in ("scenes", "sdi"):
        return importlib.import_module(f"pliant.{name}")
    if name not in _HOMES:
        raise AttributeError(f"module 'pliant' has no attribute '{name}'")
    value = globals()[name] = getattr(importlib.import_module(_HOMES[name]), name)
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
