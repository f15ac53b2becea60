"""The softness distribution index of soft bodies, and the choice of a technique to model them with.

>>> import pliant as pl
>>> body = pl.sdi.cosine_notch(0.1, 0.01, 0.01, notch_length=0.02, notch_height=0.003, youngs_modulus=1e6)
>>> print(f"{body.index:.3f}")
7.240+0.027j
>>> pl.sdi.recommend(body, moment=5e-4, tolerance=0.1).technique
'matrix'
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING

from pliant.sdi.body import Body, features
from pliant.sdi.index import ProfileWarning, softness_index
from pliant.sdi.indices import axial_index, criteria, squeezing_index, torsion_index
from pliant.sdi.map import ErrorMap, error_map, notched_bodies
from pliant.sdi.recommend import Recommendation, recommend
from pliant.sdi.shapes import (
    bump,
    cone,
    cosine_notch,
    cosine_taper,
    elliptic_notch,
    exponential,
    layered,
    notches,
    stepped,
    uniform,
)
from pliant.sdi.techniques import TECHNIQUES, Shape, bend

if TYPE_CHECKING:
    from pliant.sdi import design, study

__all__ = [
    "TECHNIQUES",
    "Body",
    "ErrorMap",
    "ProfileWarning",
    "Recommendation",
    "Shape",
    "axial_index",
    "bend",
    "bump",
    "cone",
    "cosine_notch",
    "cosine_taper",
    "criteria",
    "design",
    "elliptic_notch",
    "error_map",
    "exponential",
    "features",
    "layered",
    "notched_bodies",
    "notches",
    "recommend",
    "softness_index",
    "squeezing_index",
    "stepped",
    "study",
    "torsion_index",
    "uniform",
]


def __getattr__(name: str) -> object:
    if name in ("design", "study"):
        return importlib.import_module(f"pliant.sdi.{name}")
    raise AttributeError(f"module 'pliant.sdi' has no attribute '{name}'")
