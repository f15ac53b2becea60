"""The softness distribution index of soft bodies, and the choice of a technique to model them with."""

from __future__ import annotations

from pliant.sdi.body import Body, features
from pliant.sdi.index import ProfileWarning, softness_index
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
