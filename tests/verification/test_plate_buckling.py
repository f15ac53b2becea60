"""Buckling and snapping of plates and shells: critical loads, paths beyond, stable starts."""

from __future__ import annotations

import numpy as np
import pliant as pl
import pytest
from scipy.optimize import brentq
from scipy.special import ellipe, ellipk


def compressed_plate(n: int, load: float) -> tuple[pl.Model, pl.Shell]:
    """A unit square, hinged around, its sides u straight and pushed together: a quarter."""
    thickness, young, nu = 0.01, 1e9, 0.3
    model = pl.Model()
    material = pl.SaintVenantKirchhoff(youngs_modulus=young, poisson_ratio=nu, density=1000.0)
    mesh = pl.Mesh.rectangle(0.5, 0.5, divisions=(n, n))
    plate = model.add_shell(mesh, thickness=thickness, material=material)
    model.symmetry(plate.edge("u_max"), (1, 0, 0))
    model.symmetry(plate.edge("v_max"), (0, 1, 0))
    for edge in ("u_min", "v_min"):
        model.pin(plate.edge(edge), directions=(0, 0, 1))
    model.add_line_load(plate.edge("u_min"), (load, 0, 0))
    return model, plate


def critical() -> float:
    """4 pi^2 D / a^2 [N/m]."""
    return 4 * np.pi**2 * 1e9 * 0.01**3 / (12 * (1 - 0.3**2))


def test_a_plate_buckles_at_its_critical_load(record):
    model, plate = compressed_plate(4, 1.3 * critical())
    path = pl.solve_static(model, arc_length=True, load_steps=13)
    found = [point for point in path.critical_points if point.kind == "bifurcation"]
    load = 1.3 * found[0].load_factor
    # 4 x 4 bicubic elements a quarter: 1e-4; compression before it buckles: 4e-4.
    assert record("hinged square plate, critical load / closed form", load, 1.0, 1e-3, source="closed form")
    # Beyond, the branch is stable: it rises, and the middle goes aside.
    middle = path.track(plate.at((0.5, 0.5, 0))).position[:, 2]
    beyond = path.load_factor > found[0].load_factor * 1.001
    assert np.abs(middle[beyond]).min() > 0
    assert path.load_factor[-1] == 1.0
    # Edges free to pull in, uniform load: w^2/h^2 grows linearly with the load beyond the critical one.
    w2 = middle[beyond] ** 2
    excess = 1.3 * path.load_factor[beyond] - load
    order = np.polyfit(np.log(excess[:5]), np.log(np.abs(w2[:5])), 1)[0]
    assert order == pytest.approx(1.0, abs=0.1)


def test_load_steps_leave_the_flat_plate():
    """Without arc length: above the critical load the flat plate is unstable, and left for a buckled one."""
    model, plate = compressed_plate(3, 1.2 * critical())
    result = pl.solve_static(model, load_steps=6)
    w = result.track(plate.at((0.5, 0.5, 0))).position[:, 2]
    assert np.abs(w[result.load_factor * 1.2 < 0.97]).max() < 1e-9
    assert np.abs(w[-1]) > 2e-3
    flat = pl.solve_static(compressed_plate(3, 1.2 * critical())[0], load_steps=6, stable=True)
    assert flat.load_factor[-1] == 1.0
    with pytest.warns(UserWarning, match="unstable"):
        pl.solve_static(compressed_plate(3, 1.2 * critical())[0], load_steps=6, stable=False)


def test_a_spherical_cap_snaps_through(record):
    """Rise over thickness 2.4 (lambda = 4), clamped, pushed at the crown; a quarter, arc length."""
    radius, thickness, young, nu = 4.76, 0.01576, 1e7, 0.3
    half = 0.9 / radius
    model = pl.Model()
    material = pl.SaintVenantKirchhoff(youngs_modulus=young, poisson_ratio=nu, density=1.0)
    x = np.linspace(0, 0.9, 7)
    assert half < 0.2
    # A square grid pressed into the round: concentric squares become circles.
    u, v = np.meshgrid(x, x, indexing="ij")
    reach = np.maximum(u, v)
    length = np.hypot(u, v)
    factor = np.where(length > 0, reach / np.where(length > 0, length, 1), 1.0)
    blend = (reach / 0.9) ** 2
    factor = (1 - blend) + blend * factor
    a, b = u * factor, v * factor
    points = np.stack([a, b, np.sqrt(radius**2 - a**2 - b**2)], axis=-1).reshape(-1, 3)
    quads = pl.Mesh.rectangle(1, 1, divisions=(6, 6)).quads
    triangles = quads[:, [0, 1, 2, 0, 2, 3]].reshape(-1, 3)
    cap = model.add_shell(pl.Mesh(points, triangles=triangles), thickness=thickness, material=material)
    rim = [points[6 * 7], points[-1], points[6]]
    model.clamp(cap.edge(rim))
    model.symmetry(cap.edge([(0, 0, radius), points[6]]), (1, 0, 0))
    model.symmetry(cap.edge([(0, 0, radius), points[6 * 7]]), (0, 1, 0))
    crown = cap.at((0, 0, radius))
    model.add_force(crown, (0, 0, -100.0 / 4))
    path = pl.solve_static(model, arc_length=True, stable=False)
    w = radius - path.track(crown).position[:, 2]
    # Through or around: the crown ends below the rim, and energy balances the work done on the path.
    rise = radius - np.sqrt(radius**2 - 0.9**2)
    assert w[-1] > rise
    load = 25.0 * path.load_factor
    work = np.concatenate([[0], np.cumsum(0.5 * (load[1:] + load[:-1]) * np.diff(w))])
    elastic = path.energy.elastic
    # The trapezoidal rule over some fifty points of the path: half a per cent.
    name = "spherical cap, elastic energy against work along the path"
    assert record(name, float(elastic[-1] / work[-1]), 1.0, 5e-3, source="energy theorem")


@pytest.mark.parametrize("arc_length", [False, True])
@pytest.mark.parametrize("thickness", [1e-3, 1e-4])
def test_thin_strips_buckle_into_the_elastica(record, thickness, arc_length):
    """Clamped at one end, 1.2 times Euler's load at the other, lengths of 1000 and 10,000 thicknesses."""
    width, young = 0.1, 1e9
    model = pl.Model()
    material = pl.SaintVenantKirchhoff(youngs_modulus=young, poisson_ratio=0.0, density=1000.0)
    mesh = pl.Mesh.rectangle(1.0, width, divisions=(8, 2))
    strip = model.add_shell(mesh, thickness=thickness, material=material)
    model.clamp(strip.edge("u_min"))
    euler = np.pi**2 / 4 * young * thickness**3 / 12
    model.add_line_load(strip.edge("u_max"), (-1.2 * euler, 0, 0))
    result = pl.solve_static(model, arc_length=arc_length, load_steps=10)
    tip = result.track(strip.at((1.0, width / 2, 0))).position[-1]
    k = brentq(lambda k: (2 * ellipk(k**2) / np.pi) ** 2 - 1.2, 1e-9, 0.999)
    exact = [2 * ellipe(k**2) / ellipk(k**2) - 1, 2 * k / ellipk(k**2)]
    name = f"strip of L/h = {1 / thickness:g} at 1.2 Euler loads, {'path' if arc_length else 'load steps'}"
    # Eight cubic elements; 16 leave 7e-4. Near the critical load a little too stiff counts several times.
    found = [tip[0], abs(tip[2])]
    assert record(name, found, exact, 6e-3, unit="m", source="elastica")
    assert result.load_factor[-1] == 1.0
    for point in result.critical_points:
        # Cubic elements of the buckled quarter wave: (pi/16)^4/720.
        assert record(f"{name}, bifurcation", 1.2 * point.load_factor, 1.0, 1e-5, source="Euler")
    assert arc_length <= len(result.critical_points)
