"""Tendons: pulleys, capstans, and an arm bent by a tendon."""

import numpy as np
import pliant as pl
import pytest
from verification.cables import line

GRAVITY = 9.81


def test_two_masses_over_a_pulley(record):
    """Atwood's machine: acceleration g (m1 - m2)/(m1 + m2)."""
    model = pl.Model(gravity=(0, 0, -GRAVITY))
    heavy = model.add_point_mass(3.0, at=(0.2, 0, -1))
    light = model.add_point_mass(2.0, at=(-0.2, 0, -1))
    points = [heavy, (0.2, 0, 0), (-0.2, 0, 0), light]
    stiffness = 1e7
    # Stretched from the start by its steady tension 2 m1 m2 g/(m1 + m2).
    stretch = 2.4 * (2 * 3.0 * 2.0 / 5.0 * GRAVITY) / stiffness
    tendon = model.add_tendon(points, length=2.4 - stretch, stiffness=stiffness)
    result = pl.simulate(model, duration=0.5, step=1e-3)
    way = -1.0 - result.track(heavy.center).position[-1, 2]
    # The stretch of the tendon, 6e-6 m.
    assert record("Atwood's machine, way", way, 0.5 * GRAVITY / 5.0 * 0.25, 2e-5, "m")
    assert np.allclose(result.tendon(tendon).tension[1:], 2.4 * GRAVITY, rtol=1e-3)


def test_block_and_tackle():
    """A load on a loose pulley hangs on two falls of the line."""
    model = pl.Model(gravity=(0, 0, -GRAVITY))
    load = model.add_point_mass(10.0, at=(0, 0, -2))
    tendon = model.add_tendon([(0, 0, 0), load, (0, 0, 0)], length=3.0, stiffness=1e5)
    result = pl.solve_static(model)
    # Newton's tolerance.
    assert np.isclose(result.tendon(tendon).tension[-1], 5.0 * GRAVITY, rtol=1e-8)
    assert np.isclose(result.tendon(tendon).length[-1], 3.0 * (1 + 5.0 * GRAVITY / 1e5), rtol=1e-8)


@pytest.mark.parametrize("velocity", [0.5, -0.5])
def test_capstan_at_steady_sliding(velocity, record):
    """A load that slides over a guide keeps its velocity where the tensions differ by exp(mu theta)."""
    friction, mass = 0.3, 4.0
    model = pl.Model(gravity=(0, 0, -GRAVITY))
    load = model.add_point_mass(mass, at=(0, 0, -2), velocity=(0, 0, velocity))
    # Two guides, each a quarter of a turn.
    wrap = np.pi
    tension = mass * GRAVITY * np.exp(np.sign(velocity) * friction * wrap)
    tendon = model.add_tendon(
        [(-1, 0, -1), (-1, 0, 0), (0, 0, 0), load], tension, friction=friction, slip_velocity=1e-3
    )
    result = pl.simulate(model, duration=1.0, step=1e-2)
    tensions = result.tendon(tendon).tensions[-1]
    direction = "hauled up" if velocity > 0 else "let down"
    ratio = tensions[0] / tensions[-1]
    # tanh(500) is one.
    assert record(
        f"capstan, {direction}, ratio of tensions",
        ratio,
        np.exp(np.sign(velocity) * friction * wrap),
        1e-9,
        source="Euler's formula",
    )
    assert np.allclose(result.velocities(load)[:, 0, 2], velocity, atol=1e-9)
    energy = result.energy
    # Exact for constant forces.
    assert np.allclose(energy.total, energy.total[0], atol=1e-9)
    lost = abs(tension - mass * GRAVITY) * abs(velocity) * 1.0
    assert np.isclose(energy.dissipated[-1], lost, rtol=1e-9)


def test_friction_holds_a_load_up_to_creep():
    """Between mg exp(-mu theta) and mg exp(mu theta) a load creeps at less than the slip velocity."""
    model = pl.Model(gravity=(0, 0, -GRAVITY))
    load = model.add_point_mass(4.0, at=(0, 0, -2))
    tendon = model.add_tendon(
        [(-1, 0, 0), (0, 0, 0), load], 1.1 * 4.0 * GRAVITY, friction=0.5, slip_velocity=1e-3
    )
    result = pl.simulate(model, duration=1.0, step=5e-3)
    speed = result.velocities(load)[-1, 0, 2]
    # tanh(w/w_s) mu theta = ln 1.1.
    expected = 1e-3 * np.arctanh(np.log(1.1) / (0.5 * np.pi / 2))
    assert np.isclose(speed, expected, rtol=1e-3)
    assert np.isclose(result.tendon(tendon).tensions[-1, 1], 4.0 * GRAVITY, rtol=1e-3)


def tendon_arm(discs: int, tension: float):
    """An arm of unit length and bending stiffness with a tendon through discs, 0.05 beside it."""
    model = pl.Model()
    arm = model.add_cable([(0, 0, 0), (1, 0, 0)], elements=discs, **line(1e6, 1.0))
    model.clamp(arm.start)
    guides = [(0.0, 0.05, 0.0)]
    for k in range(1, discs + 1):
        place = np.array([k / discs, 0.0, 0.0])
        disc = model.add_rigid_body(mass=1e-3, inertia=(1e-6, 1e-6, 1e-6), position=place)
        model.weld(disc, arm.node(k))
        guides.append(disc.at((0.0, 0.05, 0.0)))
    model.add_tendon(guides, tension)
    return model, arm


def test_arm_bent_by_a_tendon(record):
    """A tendon at a distance d exerts the constant moment T d: the arm becomes an arc of curvature T d/EI."""
    tension = 20.0
    errors = []
    for discs in (8, 16):
        model, arm = tendon_arm(discs, tension * pl.Ramp(1.0))
        result = pl.solve_static(model, load_steps=4)
        kappa = result.strain(arm).curvature[-1, :, 2]
        errors.append(abs(kappa.mean() - tension * 0.05))
        assert np.ptp(kappa) < 0.05 * kappa.mean()
    # The tendon spans chords between discs: second order in their distance.
    assert errors[0] / errors[1] > 3.0
    found = (4 * (tension * 0.05 + np.array(errors)[1]) - (tension * 0.05 + np.array(errors)[0])) / 3
    assert record("arm bent by a tendon, curvature", found, tension * 0.05, 1e-3, "1/m", source="T d/EI")


def test_motor_balance_with_damping_and_friction():
    drift = []
    for step in (4e-3, 2e-3):
        model = pl.Model(gravity=(0, 0, -GRAVITY))
        ball = model.add_point_mass(2.0, at=(0.7, 0, -1.5))
        s = np.linspace(0, 1, 101)
        length = pl.Table(s, 2.75 - 0.6 * s**3 * (10 - 15 * s + 6 * s**2), smooth=True)
        model.add_tendon(
            [(-1, 0, -0.5), (0, 0, 0), ball],
            length=length,
            stiffness=3e3,
            damping=20.0,
            friction=0.2,
            slip_velocity=0.2,
        )
        energy = pl.simulate(model, duration=1.5, step=step).energy
        drift.append(np.abs(energy.total - energy.total[0]).max())
        # Means over a step may miss a change of sign by a part of the step's own loss.
        assert np.all(np.diff(energy.dissipated) >= -1e-5)
    # Second order, of about ten joules.
    assert drift[0] / drift[1] > 3.0
    assert drift[1] < 2e-2
