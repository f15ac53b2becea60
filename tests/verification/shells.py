"""Shells that several verification tests share."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np
import pliant as pl


def reference(name: str, **keys: float) -> dict[str, np.ndarray]:
    """Columns of the rows of a table beside this file that have these values; nan where nothing is known."""
    with Path(__file__).with_name(name).open() as file:
        rows = csv.DictReader(line for line in file if not line.startswith("#"))
        read = [{column: float(text or "nan") for column, text in row.items()} for row in rows]
    chosen = [row for row in read if all(row[key] == value for key, value in keys.items())]
    return {column: np.array([row[column] for row in chosen]) for column in chosen[0]}


def falling_sheet(n: int, **options: object) -> tuple[pl.Model, pl.Shell]:
    """A square sheet of n x n elements, horizontal at rest, one corner pinned."""
    model = pl.Model(gravity=(0, 0, -9.81))
    rubber = pl.SaintVenantKirchhoff(youngs_modulus=1e6, poisson_ratio=0.3, density=1000.0)
    square = pl.Mesh.rectangle(1, 1, divisions=(n, n))
    sheet = model.add_shell(square, thickness=0.01, material=rubber, **options)  # type: ignore[arg-type]
    model.pin(sheet.node(0))
    return model, sheet


def unit_plate(n: int, thickness: float = 1e-3, **options: object) -> tuple[pl.Model, pl.Shell]:
    """A free square plate of side 1 with nu = 0.3 and rho h = 1, D = 1, so that lambda is omega."""
    # E h^3/(12 (1 - nu^2)) = 1 and rho h = 1.
    steel = pl.LinearElastic(
        youngs_modulus=12 * (1 - 0.3**2) / thickness**3, poisson_ratio=0.3, density=1 / thickness
    )
    model = pl.Model()
    mesh = pl.Mesh.rectangle(1, 1, divisions=(n, n))
    return model, model.add_shell(mesh, thickness=thickness, material=steel, **options)  # type: ignore[arg-type]


def frequencies(model: pl.Model, count: int) -> np.ndarray:
    """Angular frequencies above those of rigid motion."""
    return 2 * np.pi * pl.solve_modes(model, count).frequencies
