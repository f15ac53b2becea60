"""Equilibria are reached without passing through anything: what lies in the way carries, or is gone round."""

from __future__ import annotations

import numpy as np
import pliant as pl
import pytest
from scipy.spatial.transform import Rotation

GRAVITY = 9.81
RADIUS = 5e-3
LENGTH = 1.0
DENSITY = 1100.0
WEIGHT = np.pi * RADIUS**2 * LENGTH * DENSITY * GRAVITY
BAR = 0.02
HEIGHT = 0.03
ACROSS = Rotation.from_euler("x", 90, degrees=True)


def rope_of(model, modulus, elements=20, z=HEIGHT):
    material = pl.LinearElastic(youngs_modulus=modulus, poisson_ratio=0.45, density=DENSITY)
    line = [(-LENGTH / 2, 0, z), (LENGTH / 2, 0, z)]
    return model.add_cable(line, elements=elements, section=pl.Circle(RADIUS), material=material)


def bars_at(model, body, places, radius=BAR):
    shape = pl.Cylinder(radius, 0.3)
    bars = [model.add_obstacle(shape, position=(x, 0, 0), orientation=ACROSS) for x in places]
    for bar in bars:
        model.add_contact(body, bar)
    return bars


def hang(model, hooks, stiffness):
    """Hold points by soft springs, and return those: of each the point and the anchor; half a metre long."""
    for point, anchor in hooks:
        model.add_spring(point, anchor, stiffness, length=0.5)
    return [(point, np.array(anchor, dtype=float), stiffness) for point, anchor in hooks]


def by_ends(rope):
    """Hooks for both ends, outwards and to the sides."""
    return [
        (end, (side * x, y, HEIGHT))
        for end, side in ((rope.start, -1), (rope.end, 1))
        for x, y in ((1.5, 0.0), (0.5, 1.0), (0.5, -1.0))
    ]


def by_the_middle(rope):
    return [(rope.at(LENGTH / 2), (x, y, HEIGHT)) for x, y in ((0.5, 0), (-0.5, 0), (0, 0.5), (0, -0.5))]


def pulls(result, springs):
    """Force of each spring on what it holds, and where it acts."""
    found = []
    for point, anchor, stiffness in springs:
        here = result.track(point).position[-1]
        way = anchor - here
        length = np.linalg.norm(way)
        # Springs push as they pull.
        found.append((stiffness * (length - 0.5) * way / length, here))
    return found


def out_of_balance(result, rope, obstacles, springs):
    """What is left of all forces on the rope, over its weight."""
    total = np.array([0.0, 0.0, -WEIGHT])
    for bar in obstacles:
        total += result.contact_force(rope, bar)[-1]
    return np.linalg.norm(total + sum(force for force, _ in pulls(result, springs))) / WEIGHT


@pytest.mark.parametrize(("modulus", "stiffness"), [(1.2e9, 1.0), (1.2e9, 0.1), (5e7, 1.0)])
def test_a_rope_comes_to_lie_on_the_bars_below_it(record, modulus, stiffness):
    model = pl.Model(gravity=(0, 0, -GRAVITY))
    rope = rope_of(model, modulus)
    bars = bars_at(model, rope, (-0.3, 0.25))
    springs = hang(model, by_ends(rope), stiffness)
    result = pl.solve_static(model)
    forces = np.array([result.contact_force(rope, bar)[-1] for bar in bars])
    left, right = (patch.point for patch in sorted(result.contacts[-1], key=lambda patch: patch.point[0]))
    # Moments about where it lies on the left: the right bar carries what the springs leave it of the weight.
    loads = [*pulls(result, springs), (np.array([0, 0, -WEIGHT]), result.center_of_mass(rope)[-1])]
    moment = sum(np.cross(here - left, force)[1] for force, here in loads)
    achieved = np.cross(left - right, forces[1])[1] / (0.55 * WEIGHT)
    title = f"rope of {modulus:g} Pa on two bars, springs of {stiffness:g} N/m, moment over weight and span"
    # Pressure is spread over some of the bar.
    assert record(title, achieved, moment / (0.55 * WEIGHT), 1e-5, source="balance of moments")
    # Loads on straight, level ropes: 0.25/0.55 and 0.3/0.55 of what springs leave.
    rest = WEIGHT - sum(force[2] for force, _ in loads[:-1])
    np.testing.assert_allclose(forces[:, 2] / rest, (0.4545, 0.5455), atol=0.03)
    assert out_of_balance(result, rope, bars, springs) < 1e-8


@pytest.mark.parametrize(("modulus", "stiffness"), [(5e6, 1.0), (5e6, 0.01), (5e7, 0.1)])
def test_a_rope_that_slides_off_its_bars_is_found_below_them(modulus, stiffness):
    # It has no equilibrium on them: limp, it slips through between them; soft springs let it slide.
    model = pl.Model(gravity=(0, 0, -GRAVITY))
    rope = rope_of(model, modulus)
    bars = bars_at(model, rope, (-0.3, 0.25))
    springs = hang(model, by_the_middle(rope), stiffness)
    result = pl.solve_static(model)
    assert result.positions(rope)[-1, :, 2].max() < -0.1
    assert all(not result.contact_force(rope, bar)[-1].any() for bar in bars)
    assert out_of_balance(result, rope, bars, springs) < 1e-8


@pytest.mark.parametrize("modulus", [5e6, 5e7])
def test_a_rope_lies_on_a_rope(modulus):
    model = pl.Model(gravity=(0, 0, -GRAVITY))
    high = rope_of(model, modulus, elements=15)
    material = pl.LinearElastic(youngs_modulus=modulus, poisson_ratio=0.45, density=DENSITY)
    section = pl.Circle(RADIUS)
    low = model.add_cable([(0, -0.5, 0), (0, 0.5, 0)], elements=15, section=section, material=material)
    clamps = [model.clamp(low.start), model.clamp(low.end)]
    model.add_contact(high, low)
    springs = hang(model, by_ends(high), 1.0)
    result = pl.solve_static(model)
    above = result.track(high.at(0.5)).position[-1, 2]
    below = result.track(low.at(0.5)).position[-1, 2]
    # Pressed by less than a twentieth of the radius.
    assert 1.95 * RADIUS < above - below < 2.0 * RADIUS
    assert out_of_balance(result, high, [low], springs) < 1e-8
    held = sum(result.reaction(clamp).force[-1] for clamp in clamps)
    np.testing.assert_allclose(held[2], WEIGHT + result.contact_force(high, low)[-1, 2], rtol=1e-6)


@pytest.mark.parametrize(("kind", "places"), [("shell", (-0.1, 0.12)), ("membrane", (0.0,))])
def test_a_sheet_lies_on_bars(kind, places):
    model = pl.Model(gravity=(0, 0, -GRAVITY))
    u, v = np.meshgrid(np.linspace(-0.2, 0.2, 9), np.linspace(-0.05, 0.05, 3), indexing="ij")
    mesh = pl.Mesh.grid(np.stack([u, v, np.full_like(u, BAR + 2e-3)], -1))
    material = pl.LinearElastic(youngs_modulus=1e8, poisson_ratio=0.3, density=1000.0)
    sheet = getattr(model, f"add_{kind}")(mesh, thickness=1e-3, material=material)
    bars = bars_at(model, sheet, places)
    hooks = []
    for node, x, y in ((0, -1, -1), (2, -1, 1), (24, 1, -1), (26, 1, 1)):
        hooks += [(sheet.node(node), (1.2 * x, 0.05 * y, BAR)), (sheet.node(node), (0.2 * x, 1.05 * y, BAR))]
    springs = hang(model, hooks, 1.0)
    result = pl.solve_static(model)
    weight = 0.4 * 0.1 * 1e-3 * 1000.0 * GRAVITY
    forces = [result.contact_force(sheet, bar)[-1] for bar in bars]
    total = sum(forces) + sum(force for force, _ in pulls(result, springs))
    np.testing.assert_allclose(total, (0, 0, weight), rtol=0, atol=1e-6 * weight)
    assert min(force[2] for force in forces) > 0.3 * weight
    # Nothing of it lies as deep as where it would hang without bars.
    assert result.positions(sheet)[-1, ..., 2].min() > 0.0


def test_a_rope_slips_off_the_bar_at_its_end(record):
    # The tip goes round the bar, which lies on the straight way of what is above it.
    model = pl.Model(gravity=(0, 0, -GRAVITY))
    material = pl.LinearElastic(youngs_modulus=5e7, poisson_ratio=0.45, density=DENSITY)
    line = [(0, 0, 0.026), (LENGTH, 0, 0.026)]
    rope = model.add_cable(line, elements=20, section=pl.Circle(RADIUS), material=material)
    pin = model.pin(rope.start)
    (bar,) = bars_at(model, rope, (0.98,))
    result = pl.solve_static(model)
    assert not result.contact_force(rope, bar)[-1].any()
    tip = result.track(rope.end).position[-1]
    # It hangs straight, and is longer by its weight, W L/(2 EA).
    stretch = WEIGHT * LENGTH / (2 * 5e7 * np.pi * RADIUS**2)
    assert record("rope off its bar, length", 0.026 - tip[2], LENGTH + stretch, 1e-6, unit="m")
    np.testing.assert_allclose(result.reaction(pin).force[-1], (0, 0, WEIGHT), atol=1e-8)
