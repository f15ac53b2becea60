"""Surfaces of shapes: closed, outward, of the volume and inertia that the shapes state."""

from __future__ import annotations

import numpy as np
import pliant as pl
import pytest

SHAPES = [pl.Sphere(0.3), pl.Box((0.2, 0.5, 0.9)), pl.Cylinder(0.2, 0.7), pl.Capsule(0.2, 0.5)]


@pytest.mark.parametrize("shape", SHAPES, ids=lambda shape: type(shape).__name__)
def test_triangles_enclose_the_volume(shape: pl.shapes.Shape) -> None:
    surface = shape.surface
    a, b, c = (surface.points[surface.triangles[:, k]] for k in range(3))
    volume = np.einsum("ti,ti->", a, np.cross(b, c)) / 6.0
    # 32 facets around leave 1 - sin(2 pi/32)/(2 pi/32) = 0.64 % of a circle, 16 along a meridian 0.6 % more.
    assert volume == pytest.approx(shape.volume, rel=0.02 if not isinstance(shape, pl.Box) else 1e-12)
    normal = np.cross(b - a, c - a)
    mean = sum(surface.normals[surface.triangles[:, k]] for k in range(3))
    real = np.linalg.norm(normal, axis=1) > 1e-9
    assert np.all(np.einsum("ti,ti->t", normal, mean)[real] > 0)
    np.testing.assert_allclose(np.linalg.norm(surface.normals, axis=1), 1.0, rtol=1e-12)
