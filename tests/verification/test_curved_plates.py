"""Plates and triangles on curved surfaces, with parameters of their own: closed forms and convergence."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
import pliant as pl
import pytest

HALF = np.radians(40)


def roof_mesh(n: int, kind: str) -> pl.Mesh:
    """A quarter of the roof of Scordelis and Lo, of points without slopes."""

    def crown(u, v):
        return 25 * np.sin(u), v, 25 * np.cos(u)

    smooth = pl.Mesh.surface(crown, (0, HALF), (0, 25), divisions=(n, n))
    if kind == "bicubic":
        return smooth
    halved = {"plate": 0, "triangle": len(smooth.quads), "mixed": len(smooth.quads) // 3}[kind]
    # Scattered, not in a row.
    mixed = np.argsort((np.arange(len(smooth.quads)) * 0.618034) % 1.0)
    triangles = smooth.quads[mixed[:halved]][:, [0, 1, 2, 0, 2, 3]].reshape(-1, 3)
    return pl.Mesh(smooth.points, smooth.quads[mixed[halved:]], triangles)


def roof_sag(n: int, kind: str) -> float:
    """Sag of the middle of the free edge under weight, for small loads, in units of the load."""
    model = pl.Model(gravity=(0, 0, -1e-3))
    material = pl.SaintVenantKirchhoff(youngs_modulus=4.32e8, poisson_ratio=0.0, density=360.0)
    shell = model.add_shell(roof_mesh(n, kind), thickness=0.25, material=material)
    crest, eave = (0, 0, 25), (25 * np.sin(HALF), 0, 25 * np.cos(HALF))
    model.symmetry(shell.edge([crest, (0, 25, 25)]), (1, 0, 0))
    model.symmetry(shell.edge([crest, eave]), (0, 1, 0))
    end = shell.edge([(0, 25, 25), (eave[0], 25, eave[2])])
    model.pin(end, directions=[(1, 0, 0), (0, 0, 1)])
    result = pl.solve_static(model)
    return float(eave[2] - result.track(shell.at(eave)).position[-1, 2]) * 1e3


@pytest.mark.parametrize(
    ("kind", "coarse", "fine"), [("plate", 3e-3, 2e-3), ("triangle", 0.13, 0.02), ("mixed", 0.06, 5e-3)]
)
def test_scordelis_lo_roof(record, kind, coarse, fine):
    # Bicubic elements converge to 0.3005, splines to 0.3006.
    exact = 0.3006
    # Second order: eight times eight elements have a quarter of the error of four times four.
    found = [roof_sag(n, kind) for n in (4, 8)]
    for n, sag, part in zip((4, 8), found, (coarse, fine), strict=True):
        name = f"Scordelis-Lo roof of {n} x {n} {kind} elements, sag"
        assert record(name, sag, exact, part * exact, unit="ft", source="isogeometric Kirchhoff-Love shells")


def sphere_mesh(level: int) -> pl.Mesh:
    """An octant of the unit sphere of 4^level triangles."""
    n = 2**level
    number = {(i, j): k for k, (i, j) in enumerate((i, j) for i in range(n + 1) for j in range(n + 1 - i))}
    points = np.array([(i, j, n - i - j) for i, j in number], dtype=float)
    points /= np.linalg.norm(points, axis=1)[:, None]
    triangles = []
    for i, j in number:
        if i + j < n:
            triangles.append((number[i, j], number[i + 1, j], number[i, j + 1]))
        if i + j < n - 1:
            triangles.append((number[i + 1, j], number[i + 1, j + 1], number[i, j + 1]))
    return pl.Mesh(points, triangles=triangles)


def test_a_sphere_of_triangles_under_pressure(record):
    """An arbitrary triangulation of a doubly curved surface, its normals fitted."""
    thickness, pressure, young, nu = 0.01, 1.0, 1e6, 0.3
    exact = pressure * (1 - nu) / (2 * young * thickness)
    errors = []
    for level in (2, 3):
        model = pl.Model()
        material = pl.SaintVenantKirchhoff(youngs_modulus=young, poisson_ratio=nu, density=1.0)
        shell = model.add_shell(sphere_mesh(level), thickness=thickness, material=material)
        x, y, z = np.eye(3)
        for a, b, normal in ((x, y, z), (y, z, x), (z, x, y)):
            model.symmetry(shell.edge([a, a + b, b] / np.sqrt([[1], [2], [1]])), normal)
        model.add_pressure(shell, pressure)
        result = pl.solve_static(model)
        r = result.positions(shell)[-1]
        errors.append(float(np.abs(np.linalg.norm(r, axis=1) - 1 - exact).max()) / exact)
        mean = float(np.linalg.norm(r, axis=1).mean() - 1)
    name = "sphere of 64 triangles an octant under pressure, radial displacement"
    # Second order or better in the size of the triangles.
    assert record(name, mean, exact, 0.02 * exact, unit="m", source="closed form")
    assert errors[1] < 0.5 * errors[0]


@pytest.mark.parametrize("kind", ["plate", "triangle", "mixed"])
def test_only_rigid_motions_are_free(kind):
    model = pl.Model()
    material = pl.SaintVenantKirchhoff(youngs_modulus=4.32e8, poisson_ratio=0.3, density=360.0)
    model.add_shell(roof_mesh(3, kind), thickness=0.25, material=material)
    squares = pl.solve_modes(model, 7).frequencies ** 2
    assert squares[5] < 1e-7 * squares[6]


@pytest.mark.parametrize("kind", ["plate", "mixed"])
def test_skewed_plates_in_a_plane_have_the_frequencies_of_the_plate(record, kind):
    # The unit square in parallelograms, nearly, with triangles among them: hinged around, D = rho h = 1.
    thickness, n = 1e-3, 8
    steel = pl.SaintVenantKirchhoff(
        youngs_modulus=12 * 0.91 / thickness**3, poisson_ratio=0.3, density=1 / thickness
    )
    flat = pl.Mesh.rectangle(1, 1, divisions=(n, n))
    points = flat.points.copy()
    inner = np.sin(np.pi * points[:, 0]) * np.sin(np.pi * points[:, 1])
    points[:, 0] += 0.02 * inner
    quads = flat.quads
    whole = np.ones(len(quads), dtype=bool)
    if kind == "mixed":
        whole[::3] = False
    triangles = quads[~whole][:, [0, 1, 2, 0, 2, 3]].reshape(-1, 3)
    model = pl.Model()
    plate = model.add_shell(pl.Mesh(points, quads[whole], triangles), thickness=thickness, material=steel)
    model.pin(plate.edge("rim"))
    found = 2 * np.pi * pl.solve_modes(model, 1).frequencies[0]
    # One to two per cent at eight elements a side, as on squares: plates low, triangles high.
    name = f"hinged square of distorted {kind} elements, lambda"
    assert record(name, found, 2 * np.pi**2, 0.02 * 2 * np.pi**2, source="closed form")


@dataclass
class Cells:
    """A block of cells, as meshio has them."""

    type: str
    data: Any


@dataclass
class FromFile:
    """What meshio returns of a file of gmsh, as far as it counts."""

    points: Any
    cells: list[Cells]
    cell_sets: dict[str, Any] = field(default_factory=dict)
    cell_data: dict[str, Any] = field(default_factory=dict)
    field_data: dict[str, Any] = field(default_factory=dict)


def test_sets_of_cells_survive_when_quadrilaterals_are_halved():
    flat = pl.Mesh.rectangle(2, 1, divisions=(2, 1))
    points = flat.points.copy()
    points[3] += (0.3, 0.1, 0.0)  # no parallelograms
    arch = points + np.array([0, 0, 1]) * 0.1 * points[:, :1] ** 2
    triangle = np.array([(4, 6, 5)])
    arch = np.vstack([arch, [(3.0, 0.0, 0.9)]])
    mesh = FromFile(
        arch,
        [Cells("quad", flat.quads), Cells("triangle", triangle), Cells("line", np.array([(0, 1)]))],
        {"left": [np.array([0]), np.array([], dtype=int), None], "tip": [None, np.array([0]), None]},
        {"gmsh:physical": [np.array([1, 1]), np.array([2]), np.array([7])]},
        {"skin": np.array([1, 2]), "root": np.array([7, 1])},
    )
    model = pl.Model()
    material = pl.SaintVenantKirchhoff(youngs_modulus=1e6, poisson_ratio=0.3, density=1.0)
    shell = model.add_shell(mesh, thickness=0.01, material=material)
    assert shell.faces("left").numbers == (0, 1)
    assert shell.faces("skin").numbers == (0, 1, 2, 3)
    assert shell.faces("tip").numbers == (4,)
    model.clamp(shell.edge("root"))
    model.add_pressure(shell.faces("tip"), 1e-3)
    assert np.isfinite(pl.solve_static(model).positions(shell)).all()


def test_a_sharp_edge_is_refused():
    points = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (0, 1, 1)]
    mesh = pl.Mesh(points, quads=[(0, 1, 2, 3), (4, 0, 3, 5)])
    material = pl.SaintVenantKirchhoff(youngs_modulus=1e6, poisson_ratio=0.3, density=1.0)
    with pytest.raises(pl.ModelError, match=r"sharp edge here .* model.fold"):
        pl.Model().add_shell(mesh, thickness=0.01, material=material)
