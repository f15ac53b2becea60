"""Wind on surfaces and rest curvature that changes: terminal velocity, flat plates, strips that roll up."""

from __future__ import annotations

import numpy as np
import pliant as pl
import pytest

RUBBER = pl.SaintVenantKirchhoff(youngs_modulus=1e6, poisson_ratio=0.0, density=1000.0)
STIFF = pl.SaintVenantKirchhoff(youngs_modulus=1e9, poisson_ratio=0.3, density=500.0)


def test_plate_that_falls_flat(record):
    """Velocity v_T tanh(g t/v_T), with the weight per area rho h g = rho_air/2 C v_T^2."""
    model = pl.Model(gravity=(0, 0, -9.81))
    mesh = pl.Mesh.rectangle(1, 1, divisions=(2, 2))
    plate = model.add_shell(mesh, thickness=2e-3, material=STIFF)
    model.add_wind(plate, (0, 0, 0), density=1.2, drag=1.2)
    result = pl.simulate(model, duration=3.0, step=1e-2)
    terminal = np.sqrt(500.0 * 2e-3 * 9.81 / (0.5 * 1.2 * 1.2))
    exact = -terminal * np.tanh(9.81 * result.time / terminal)
    speed = result.velocities(plate)[:, :, 2]
    # Second order in time, 100 steps a second.
    assert record("falling plate, velocity", speed[-1], exact[-1], 1e-5, "m/s", source="tanh")
    assert np.abs(speed - exact[:, None]).max() < 1e-3
    energy = result.energy
    assert np.ptp(energy.total) < 1e-4 * energy.dissipated[-1]
    # Air at rest does no work.
    assert np.abs(energy.work).max() < 1e-4 * energy.dissipated[-1]


@pytest.mark.parametrize("lift", [None, 0.0, 3.0])
@pytest.mark.parametrize("degrees", [10.0, 40.0, 90.0, 150.0])
def test_plate_at_an_angle_to_the_flow(degrees, lift, record):
    """Drag C_D sin^2 and lift C_L sin cos; with one coefficient a pressure along the normal."""
    speed, density, drag = 8.0, 1.2, 1.1
    alpha = np.radians(degrees)
    model = pl.Model()
    # The flow is along x, the plate turned about y: its normal is (sin, 0, cos).
    along, across = np.array([np.cos(alpha), 0, -np.sin(alpha)]), np.array([0.0, 1.0, 0.0])
    u, v = np.meshgrid([0.0, 0.5, 1.0], [0.0, 0.5, 1.0], indexing="ij")
    grid = u[..., None] * along + v[..., None] * across
    plate = model.add_shell(pl.Mesh.grid(grid), thickness=1e-3, material=STIFF)
    model.add_wind(plate, (speed, 0, 0), density=density, drag=drag, lift=lift)
    found = pl.simulate(model, duration=1e-6, step=1e-6).momentum[-1] / 1e-6
    pressure = 0.5 * density * speed**2
    force_drag = drag * np.sin(alpha) ** 2
    coefficient = drag if lift is None else lift
    force_lift = coefficient * np.sin(alpha) * np.cos(alpha)
    expected = pressure * np.array([force_drag, 0.0, force_lift])
    # The plate moves by a millionth of the flow's speed.
    name = f"plate at {degrees:g} degrees, lift {'normal' if lift is None else lift}"
    assert record(name, found, expected, 1e-4 * pressure, "N", source="closed form")


def test_balance_of_a_sheet_in_gusts():
    """A film that is held at a corner and blown about: work of the wind, and what it loses."""
    drift = []
    for step in (4e-3, 2e-3):
        model = pl.Model(gravity=(0, 0, -9.81))
        mesh = pl.Mesh.rectangle(1, 1, divisions=(2, 2))
        sheet = model.add_shell(mesh, thickness=0.01, material=RUBBER)
        model.pin(sheet.node(0))
        model.add_wind(sheet, lambda t: (0, 6 * np.sin(9 * t), 4.0), density=1.2, drag=1.1, lift=2.0)
        energy = pl.simulate(model, duration=0.4, step=step).energy
        assert np.all(np.diff(energy.dissipated) >= 0)
        assert energy.work[-1] > 1.0
        drift.append(np.ptp(energy.total))
    # Second order, of some joules.
    assert drift[0] / drift[1] > 3.0
    assert drift[1] < 1e-2


@pytest.mark.parametrize("element", ["bicubic", "cylindrical", "plate"])
def test_strip_rolls_up(element, record):
    """A constant rest curvature makes a circle of a free strip, without stress."""
    length, curvature = 1.0, 2 * np.pi
    model = pl.Model()
    mesh = pl.Mesh.rectangle(length, 0.1, divisions=(12, 1))
    strip = model.add_shell(mesh, thickness=5e-3, material=RUBBER, element=element)
    model.clamp(strip.edge("u_min"))
    model.add_curvature(strip, curvature)
    result = pl.solve_static(model, load_steps=4)
    points = result.positions(strip)[-1]
    s = np.linspace(0, length, 13)
    circle = np.stack([np.sin(curvature * s), 0 * s, 1 - np.cos(curvature * s)], axis=1) / curvature
    line = points[::2] - np.array([0.0, points[0, 1], 0.0])
    # Cubics for arcs of 30 degrees stretch by 1e-4 of their length.
    name = f"strip rolled up by its rest curvature ({element})"
    assert record(name, line[:, [0, 2]], circle[:, [0, 2]], 3e-3, "m", source="circle")
    # Next to the energy of the flat strip, E I kappa^2/2.
    flat = 1e6 * 0.1 * 5e-3**3 / 12 * curvature**2 / 2
    assert result.energy.elastic[-1] < 2e-3 * flat


def test_curvature_by_components():
    """Along v, and a twist: the strains (22, 12) are those that were asked for."""
    model = pl.Model()
    sheet = model.add_shell(pl.Mesh.rectangle(0.5, 0.5, divisions=(4, 4)), thickness=5e-3, material=RUBBER)
    model.pin(sheet.at((0.25, 0.25, 0)))
    model.pin(sheet.node(0), directions=[(0, 0, 1), (0, 1, 0)])
    model.pin(sheet.node(4), directions=(0, 0, 1))
    model.add_curvature(sheet, (0.0, 0.8, 0.0))
    result = pl.solve_static(model)
    bending = result.strain(sheet).bending[-1]
    # k = B0 - b: the surface bends towards its normal, into a cylinder without stress.
    assert np.allclose(bending[:, 1], -0.8, atol=1e-3)
    assert np.abs(bending[:, [0, 2]]).max() < 1e-3


def test_work_of_a_muscle(record):
    """A strip that bends up under a weight: the rest curvature does the work, and the audit closes."""
    drift = []
    for step in (4e-3, 2e-3):
        model = pl.Model(gravity=(0, 0, -9.81))
        mesh = pl.Mesh.rectangle(0.5, 0.05, divisions=(6, 1))
        soft = pl.SaintVenantKirchhoff(
            youngs_modulus=1e6, poisson_ratio=0.3, density=1000.0, retardation_time=2e-3
        )
        strip = model.add_shell(mesh, thickness=5e-3, material=soft)
        model.clamp(strip.edge("u_min"))
        model.add_curvature(strip, lambda t: (4.0 * np.sin(6 * t), 0.0, 0.5 * t))
        energy = pl.simulate(model, duration=0.8, step=step).energy
        drift.append(np.ptp(energy.total))
    assert np.ptp(energy.work) > 0.005
    assert drift[0] / drift[1] > 3.0, "second order"
    assert drift[1] < 1e-3 * np.ptp(energy.gravitational)
    # Slowly, the work is the energy: E I (kappa L)^2/(2 L) of a strip whose ends are held.
    model = pl.Model()
    strip = model.add_shell(mesh, thickness=5e-3, material=RUBBER)
    for edge in ("u_min", "u_max"):
        model.clamp(strip.edge(edge))
    model.add_curvature(strip, 0.3 * pl.Ramp(1.0))
    energy = pl.simulate(model, duration=1.0, step=0.02).energy
    expected = 1e6 * 0.05 * 5e-3**3 / 12 * 0.3**2 / 2 * 0.5
    # A clamped strip stays flat; steps of the trapezoidal rule.
    assert record("work of a held muscle", energy.work[-1], expected, 1e-3 * expected, "J", "closed form")
