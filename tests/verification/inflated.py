"""Inflated bodies that several verification tests share."""

from __future__ import annotations

import numpy as np
import pliant as pl

ATMOSPHERE = 101325.0


def ball(n: int, radius: float, *, whole: bool = False) -> pl.Mesh:
    """A sphere, or its octant of positive coordinates: a cube's faces of n x n squares (2n x 2n if whole)."""
    known: dict[tuple[int, ...], int] = {}
    points: list[np.ndarray] = []
    quads = []
    reach = range(-n, n + 1) if whole else range(n + 1)
    angles = {i: np.tan(np.pi / 4 * i / n) for i in reach}

    def node(axis: int, side: int, i: int, j: int) -> int:
        place = np.zeros(3)
        place[[axis, (axis + 1) % 3, (axis + 2) % 3]] = side, angles[i], angles[j]
        place *= radius / np.linalg.norm(place)
        key = tuple(np.round(place / radius * 1e8).astype(int))
        if key not in known:
            known[key] = len(points)
            points.append(place)
        return known[key]

    for axis in range(3):
        for side in (1, -1) if whole else (1,):
            for i in reach[:-1]:
                for j in reach[:-1]:
                    corners = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)][::side]
                    quads.append([node(axis, side, *corner) for corner in corners])
    return pl.Mesh(np.array(points), np.array(quads))


def balloon(
    n: int, radius: float, thickness: float, material: pl.NeoHookean, **options: object
) -> tuple[pl.Model, pl.Membrane]:
    """An octant of a balloon in three planes of symmetry."""
    model = pl.Model()
    skin = model.add_membrane(
        ball(n, radius), thickness=thickness, material=material, wrinkling=False, **options
    )  # type: ignore[arg-type]
    for axis in np.eye(3):
        first, second = np.roll(axis, 1), np.roll(axis, 2)
        middle = (first + second) / np.sqrt(2)
        model.symmetry(skin.edge(radius * np.array([first, middle, second])), axis)
    return model, skin


def cushion(n: int, wrinkling: bool | float = True) -> tuple[pl.Model, pl.Membrane]:
    """A quarter of the upper half of a flat square airbag, 1.2 m from corner to corner."""
    side = 1.2 / np.sqrt(2) / 2
    film = pl.SaintVenantKirchhoff(youngs_modulus=5.88e8, poisson_ratio=0.4, density=1400.0)
    model = pl.Model()
    sheet = model.add_membrane(
        pl.Mesh.rectangle(side, side, divisions=(n, n)), thickness=6e-4, material=film, wrinkling=wrinkling
    )
    model.symmetry(sheet.edge("u_min"), (1, 0, 0))
    model.symmetry(sheet.edge("v_min"), (0, 1, 0))
    for edge in ("u_max", "v_max"):
        model.pin(sheet.edge(edge), directions=(0, 0, 1))
    return model, sheet
