"""Where lines touch and how hard, against closed forms: many zones, crossings in rest, a rope over a drum."""

from __future__ import annotations

import numpy as np
import pliant as pl
import pytest
from scipy.integrate import cumulative_simpson, quad
from scipy.interpolate import CubicSpline
from scipy.spatial.transform import Rotation

GRAVITY = 9.81


def line_pressure(delta, stiffness, ramp):
    """Normal force per length at a penetration."""
    if delta <= 0:
        return 0.0
    return 0.5 * stiffness * delta**2 / ramp if delta < ramp else stiffness * (delta - 0.5 * ramp)


def test_a_sine_across_a_line_presses_in_eleven_zones(record):
    # Five periods of 50 mm, 4 mm above the axis, radii of 3 mm: ten crossings and both ends on the axis.
    radius, height, stiffness = 3e-3, 4e-3, 1e6
    model = pl.Model()
    soft = pl.LinearElastic(youngs_modulus=5e6, poisson_ratio=0.4, density=1200.0)
    kind = {"section": pl.Circle(radius=radius), "material": soft}
    low = model.add_cable([(-0.02, 0, 0), (1.02, 0, 0)], elements=20, **kind)
    x = np.linspace(0, 1, 8001)
    y = 0.05 * np.sin(10 * np.pi * x)
    slope = 0.5 * np.pi * np.cos(10 * np.pi * x)
    s = cumulative_simpson(np.hypot(1.0, slope), x=x, initial=0)
    wave = pl.Curve(CubicSpline(s, np.stack([x, y, np.full_like(x, height)], axis=1)), length=s[-1])
    high = model.add_cable(wave, elements=80, rest="straight", **kind)
    model.add_contact(high, low, stiffness=stiffness, damping=0.0)
    result = pl.simulate(model, duration=2e-7, step=1e-7)
    patches = [patch for patch in result.contacts[-1] if 0.02 < patch.point[0] < 0.98]
    # The free ends, which lie in the first and the last zone, have records of their own.
    zones = {round(patch.point[0], 2) for patch in result.contacts[-1]}
    places = np.sort([patch.point[0] for patch in patches])
    np.testing.assert_allclose(places, np.arange(1, 10) / 10, atol=1e-4)
    assert record("sine across a line, zones", len(zones), 11, 0, source="closed form")

    def force(t):
        d = np.hypot(0.05 * np.sin(10 * np.pi * t), height)
        pressure = line_pressure(2 * radius - d, stiffness, 0.005 * radius)
        return pressure * np.hypot(1.0, 0.5 * np.pi * np.cos(10 * np.pi * t))

    half = 0.002850859971839599
    exact = 2 * quad(lambda t: force(0.5 + t), 0.0, half, limit=200)[0]
    middle = min(patches, key=lambda patch: abs(patch.point[0] - 0.5))
    # Three points of a zone miss parts of the ramp; the mesh bends the sine by less than a per mille.
    assert record("sine across a line, force of a zone", middle.normal_force, exact, 5e-3 * exact, unit="N")
    assert record("sine across a line, deepest gap", middle.gap, height - 2 * radius, 2e-6, unit="m")


@pytest.mark.parametrize("degrees", [90, 30])
def test_crossing_ropes_press_as_the_integral_says(degrees, record):
    radius, depth, stiffness = 1e-3, 1e-4, 1e7
    model = pl.Model()
    soft = pl.LinearElastic(youngs_modulus=5e6, poisson_ratio=0.4, density=1200.0)
    kind = {"elements": 3, "section": pl.Circle(radius=radius), "material": soft}
    low = model.add_cable([(-0.05, 0, 0), (0.05, 0, 0)], **kind)
    along = 0.05 * np.array([np.cos(np.radians(degrees)), np.sin(np.radians(degrees)), 0.0])
    top = np.array([0.0, 0.0, 2 * radius - depth])
    high = model.add_cable([top - along, top + along], **kind)
    model.add_contact(high, low, stiffness=stiffness, damping=0.0)
    result = pl.simulate(model, duration=2e-8, step=1e-8)
    force = result.contact_force(high)[-1, 2]
    exact = {90: 0.8283805390846981, 30: 1.6567610781693966}[degrees]
    # The reference has no ramp, which takes off d_0/2, 2.5 % of the depth; Gauss' rule leaves 5e-4.
    ramp = 0.005 * radius

    def pressed(s):
        d = np.hypot(s * np.sin(np.radians(degrees)), 2 * radius - depth)
        return line_pressure(2 * radius - d, stiffness, ramp)

    half = np.sqrt(4 * radius * depth - depth**2) / np.sin(np.radians(degrees))
    with_ramp = 2 * quad(pressed, 0.0, half, limit=200)[0]
    lean = (2 * radius - depth) / (2 * radius)
    assert abs(with_ramp / exact - 1.0) < 0.05
    # The normals lean along the zone: their sum is shorter, by less than the lean at its ends.
    assert lean * with_ramp * 0.99 < force < with_ramp * 1.005
    pressure = result.contacts[-1][0].normal_force
    assert record(
        f"ropes crossing at {degrees} degrees, force", pressure, with_ramp, 5e-3 * with_ramp, unit="N"
    )


def test_a_mat_of_ropes_rests(record):
    # Three ropes lie on the ground, three others across them.
    radius = 5e-3
    model = pl.Model(gravity=(0, 0, -GRAVITY))
    soft = pl.LinearElastic(youngs_modulus=5e6, poisson_ratio=0.4, density=1200.0, retardation_time=2e-3)
    kind = {"elements": 5, "section": pl.Circle(radius=radius), "material": soft}
    places = (0.033, 0.1, 0.167)
    low = [model.add_cable([(0, y, radius), (0.2, y, radius)], **kind) for y in places]
    high = [model.add_cable([(x, 0, 3 * radius), (x, 0.2, 3 * radius)], **kind) for x in places]
    ground = model.add_obstacle(pl.HalfSpace())
    for rope in low:
        model.add_contact(rope, ground, friction=pl.LuGre(0.5, 0.4))
        for other in high:
            model.add_contact(other, rope, friction=pl.LuGre(0.5, 0.4))
    result = pl.simulate(model, duration=0.4, step=1e-3)
    weight = 3 * np.pi * radius**2 * 1200.0 * 0.2 * GRAVITY
    force = sum(result.contact_force(rope)[-1] for rope in high)
    # At rest but for what has not died out in 0.4 s.
    assert record("mat of ropes, force between the layers over weight", force[2] / weight, 1.0, 1e-3)
    assert np.abs(force[:2]).max() < 1e-3 * weight
    below = sum(result.contact_force(rope, ground)[-1, 2] for rope in low)
    assert record("mat of ropes, force on the ground over both weights", below / (2 * weight), 1.0, 1e-3)
    depth = max(-patch.gap for patch in result.contacts[-1]) / radius
    assert record("mat of ropes, deepest penetration over radius", depth, 0.0, 0.05)
    assert result.energy.kinetic[-1] < 1e-6 * weight * radius


def test_a_rope_hangs_over_a_drum(record):
    # Without friction the tension is that of hydrostatics: w times the height above the ends.
    radius, tail, thin, weight = 0.1, 0.3, 2e-3, 0.5 * GRAVITY
    arc = np.pi * radius
    length = arc + 2 * tail

    def line(s):
        if s < tail:
            return (-radius, 0.0, s - tail)
        if s > tail + arc:
            return (radius, 0.0, tail + arc - s)
        angle = np.pi - (s - tail) / radius
        return (radius * np.cos(angle), 0.0, radius * np.sin(angle))

    area = np.pi * thin**2
    section = pl.Section(area=area, second_moments=(1e-15, 1e-15), torsion_constant=2e-15, radius=thin)
    stiff = pl.LinearElastic(youngs_modulus=1e9, poisson_ratio=0.4, density=0.5 / area, retardation_time=1e-3)
    model = pl.Model(gravity=(0, 0, -GRAVITY))
    rope = model.add_cable(
        pl.Curve(line, length=length), elements=36, section=section, material=stiff, rest="straight"
    )
    drum = model.add_obstacle(
        pl.Cylinder(radius=radius - thin, length=0.1), orientation=Rotation.from_euler("x", 90, degrees=True)
    )
    model.add_contact(rope, drum, stiffness=1e7)
    result = pl.simulate(model, duration=0.2, step=1e-3)
    tension = result.axial_force(rope)[-1]
    r = result.positions(rope)[-1]
    top = 0.5 * (tension[17] + tension[18])
    # The two elements beside the top lie w R (1 - cos) lower, 1e-3 of it.
    exact = weight * (tail + radius)
    assert record(
        "rope over a drum, tension on top", top, exact, 0.01 * exact, unit="N", source="closed form"
    )
    side = np.interp(0.0, 0.5 * (r[:18, 2] + r[1:19, 2]), tension[:18])
    assert record(
        "rope over a drum, tension at its side", side, weight * tail, 0.015 * weight * tail, unit="N"
    )
    force = result.contact_force(rope)[-1, 2]
    assert record("rope over a drum, force on the drum over weight", force / (weight * length), 1.0, 1e-3)
