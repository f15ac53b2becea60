"""Shells, kind by kind and rule by rule: motions without energy, constant curvature and strain."""

from __future__ import annotations

import numpy as np
import pliant as pl
import pytest

RULES = ("standard", "reduced", "full")
SOFT = pl.SaintVenantKirchhoff(youngs_modulus=1e6, poisson_ratio=0.3, density=1000.0)


def panel(shape: str, divisions: tuple[int, int], kind: str) -> pl.Mesh:
    """A rectangle, flat or bent to an arc of one radian; of triangles for these."""

    def place(u: float, v: float) -> tuple[float, float, float]:
        return (u, v, 0.0) if shape == "flat" else (np.sin(u), v, np.cos(u))

    mesh = pl.Mesh.surface(place, (0, 1), (0, 0.8), divisions=divisions)
    if kind == "triangle":
        return pl.Mesh(mesh.points, triangles=mesh.quads[:, [0, 1, 2, 0, 2, 3]].reshape(-1, 3))
    # Plates on curved surfaces have parameters of their own.
    return pl.Mesh(mesh.points, mesh.quads) if kind == "plate" else mesh


@pytest.mark.parametrize("quadrature", RULES)
@pytest.mark.parametrize("kind", ["bicubic", "cylindrical", "plate", "triangle"])
def test_only_rigid_motions_are_free_of_energy(record, kind, quadrature):
    # Cylindrical elements side by side fold along the line that they share: strips of them.
    divisions = [(3, 1)] if kind == "cylindrical" else [(3, 1), (2, 2)]
    for shape in ("flat", "curved"):
        for count in divisions:
            model = pl.Model()
            mesh = panel(shape, count, kind)
            model.add_shell(mesh, thickness=0.05, material=SOFT, element=kind, quadrature=quadrature)
            squares = pl.solve_modes(model, count=8).frequencies ** 2
            # Of a free surface: motions that cost nothing are of the size of rounding, 1e-12 of the others.
            free = int((squares < 1e-9 * squares[-1]).sum())
            name = f"motions without energy, {kind}, {quadrature}, {shape}, {count[0]} x {count[1]}"
            assert record(name, free, 6, 0, source="rigid motions")


@pytest.mark.parametrize("quadrature", RULES)
@pytest.mark.parametrize("kind", ["bicubic", "plate", "triangle"])
def test_constant_curvature_is_exact(record, kind, quadrature):
    """Patch test: unequal elements, a free plate bent alike to both sides by moments on its rim."""
    x, y = np.array([0.0, 0.17, 0.5, 0.62, 1.0]), np.array([0.0, 0.3, 0.45, 0.8])
    u, v = np.meshgrid(x, y, indexing="ij")
    mesh = pl.Mesh.grid(np.stack([u, v, 0 * u], axis=-1))
    if kind == "triangle":
        mesh = pl.Mesh(mesh.points, triangles=mesh.quads[:, [0, 1, 2, 0, 2, 3]].reshape(-1, 3))
    model, thickness = pl.Model(), 0.05
    plate = model.add_shell(mesh, thickness=thickness, material=SOFT, element=kind, quadrature=quadrature)
    corners = [(0, 0, 0), (1, 0, 0), (1, 0.8, 0), (0, 0.8, 0)]
    # So small that what is quadratic in it does not show.
    curvature = 1e-6
    moment = curvature * 1e6 * thickness**3 / (12 * (1 - 0.3))
    for start, end in zip(corners, corners[1:] + corners[:1], strict=True):
        model.add_edge_moment(plate.edge([start, end]), moment)
    model.pin(plate.at(corners[0]))
    model.pin(plate.at(corners[1]), directions=[(0, 1, 0), (0, 0, 1)])
    model.pin(plate.at(corners[3]), directions=(0, 0, 1))
    bending = pl.solve_static(model).strain(plate).bending[-1]
    sign = np.sign(bending[0, 0])
    expected = np.tile([sign * curvature, sign * curvature, 0.0], (len(bending), 1))
    # Rounding of membrane forces, (L/h)^2 times that of moments, and the square of the deflection.
    gap = float(np.abs(bending - expected).max() / curvature)
    assert record(f"patch of constant curvature, {kind}, {quadrature}", gap, 0.0, 1e-5, source="closed form")


@pytest.mark.parametrize("kind", ["bicubic", "cylindrical", "plate", "triangle", "membrane"])
def test_constant_strain_is_exact(record, kind):
    """Patch test: unequal elements, stretched and sheared alike, carry no force at inner nodes."""
    x, y = np.array([0.0, 0.17, 0.5, 0.62, 1.0]), np.array([0.0, 0.3, 0.45, 0.8])
    u, v = np.meshgrid(x, y, indexing="ij")
    mesh = pl.Mesh.grid(np.stack([u, v, 0 * u], axis=-1))
    if kind == "triangle":
        mesh = pl.Mesh(mesh.points, triangles=mesh.quads[:, [0, 1, 2, 0, 2, 3]].reshape(-1, 3))
    stretch = np.array([[1.05, 0.02], [0.01, 0.97]])
    places = np.column_stack([mesh.points[:, :2] @ stretch.T, np.zeros(len(mesh.points))])
    model = pl.Model()
    if kind == "membrane":
        model.add_membrane(mesh, thickness=0.05, material=SOFT, wrinkling=False, initial=places, name="sheet")
    else:
        model.add_shell(mesh, thickness=0.05, material=SOFT, element=kind, initial=places, name="sheet")
    strain = pl.Stepper(model, step=1e-9).strain("sheet").membrane
    green = 0.5 * (stretch.T @ stretch - np.eye(2))
    expected = np.tile([green[0, 0], green[1, 1], green[0, 1]], (len(strain), 1))
    # Triangles have axes along their first side: invariants of the strain instead.
    for name, of in (("trace", lambda e: e[:, 0] + e[:, 1]), ("determinant", determinant)):
        title = f"patch of constant strain, {kind}, {name}"
        # The functions hold linear fields: rounding.
        assert record(title, of(strain), of(expected), 1e-12, source="closed form")


def determinant(strain: np.ndarray) -> np.ndarray:
    """Determinants of strains (n, 3)."""
    return np.asarray(strain[:, 0] * strain[:, 1] - strain[:, 2] ** 2)
