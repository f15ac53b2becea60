"""Blows of stiff ropes and cloth with the defaults: energy only falls, whatever the step."""

from __future__ import annotations

import numpy as np
import pliant as pl
import pytest

GRAVITY = (0.0, 0.0, -9.81)
NYLON = pl.LinearElastic(youngs_modulus=1.2e9, poisson_ratio=0.4, density=1140.0)
WIRE = pl.LinearElastic(youngs_modulus=1e11, poisson_ratio=0.3, density=6000.0)
CLOTH = pl.LinearElastic(youngs_modulus=5e7, poisson_ratio=0.3, density=400.0)


def rises(result):
    """Return the sum of all rises of mechanical energy less work, over the energy that there was to lose."""
    energy = result.energy
    held = energy.kinetic + energy.elastic + energy.gravitational - energy.work
    change = np.diff(held)
    return change[change > 0.0].sum() / (held[0] - held.min())


def thrown(material, *, driven=False):
    """Make a rope that hits the ground at 3 m/s, and where `driven` a body far off that is moved slowly."""
    model = pl.Model(gravity=GRAVITY)
    line = [(-0.5, 0.0, 0.02), (0.5, 0.0, 0.05)]
    section = pl.Circle(radius=5e-3)
    rope = model.add_cable(line, elements=16, section=section, material=material, velocity=(0, 0, -3.0))
    ground = model.add_obstacle(pl.HalfSpace())
    model.add_contact(rope, ground, friction=pl.Coulomb(0.3))
    if driven:
        inertia = 1e-3 * np.eye(3)
        body = model.add_rigid_body(mass=1.0, inertia=inertia, position=(0, 5, 5), velocity=(1e-3, 0, 0))
        times = np.linspace(0.0, 1.0, 5)
        way = [(1e-3 * t, 5.0, 5.0) for t in times]
        model.drive(body.center, position=pl.Table(times, way, smooth=True))
    return model


@pytest.mark.parametrize("step", [1e-3, 2e-4])
@pytest.mark.parametrize("driven", [False, True])
@pytest.mark.parametrize("material", [NYLON, WIRE], ids=["nylon", "wire"])
def test_stiff_ropes_lose_energy_on_the_ground(material, driven, step):
    result = pl.simulate(thrown(material, driven=driven), duration=0.05, step=step)
    # The energy of a driven model counts against all that moves: its balance is as good as the work is known.
    assert rises(result) < (0.05 if driven else 0.01)


def test_long_steps_after_the_short_ones_of_a_blow_make_no_energy():
    # A wire falls on its end: the blow is over within a few hundredths of a step.
    model = pl.Model(gravity=GRAVITY)
    line = [(0.0, 0.0, 0.05), (0.0, 0.02, 1.05)]
    rope = model.add_cable(line, elements=30, section=pl.Circle(radius=4e-3), material=WIRE)
    ground = model.add_obstacle(pl.HalfSpace())
    model.add_contact(rope, ground)
    result = pl.simulate(model, duration=0.12, step=5e-4)
    assert result.contact_force(rope)[:, 2].max() > 0.0
    assert rises(result) < 1e-3


def test_cloth_falls_on_a_ball():
    # The middle of the cloth meets the top of the ball: the nearest of four faces changes by rounding.
    model = pl.Model(gravity=GRAVITY)
    mesh = pl.Mesh.rectangle(0.3, 0.3, (8, 8))
    points = np.array(mesh.points) - [0.15, 0.15, 0.0]
    mesh = pl.Mesh(points, mesh.quads)
    cloth = model.add_membrane(mesh, thickness=5e-4, material=CLOTH, initial=points + [0, 0, 0.11])
    ball = model.add_obstacle(pl.Sphere(radius=0.1))
    model.add_contact(cloth, ball, friction=pl.Coulomb(0.4))
    result = pl.simulate(model, duration=0.08, step=1e-3)
    force = result.contact_force(cloth)[:, 2]
    assert force.max() > 0.0
    # Nothing of the cloth is farther inside the ball than it is thick.
    apart = np.linalg.norm(result.positions(cloth)[-1], axis=-1) - 0.1
    assert apart.min() > -5e-4


def test_what_touches_at_the_start_is_told():
    model = pl.Model(gravity=GRAVITY)
    section = pl.Circle(radius=0.01)
    soft = pl.LinearElastic(youngs_modulus=5e6, poisson_ratio=0.4, density=1200.0, retardation_time=2e-3)
    line = [(0.0, 0.0, 0.01), (1.0, 0.0, 0.01)]
    rope = model.add_cable(line, elements=10, section=section, material=soft)
    ground = model.add_obstacle(pl.HalfSpace())
    model.add_contact(rope, ground)
    weight = 1200.0 * np.pi * 0.01**2 * 9.81
    rest = pl.solve_static(model)
    assert rest.contact_force(rope)[-1, 2] == pytest.approx(weight, rel=1e-9)
    result = pl.simulate(model, duration=2e-3, step=1e-3, start=rest)
    assert result.contact_force(rope)[:, 2] == pytest.approx(weight, rel=1e-6)
    assert all(result.contacts)
    stepper = pl.Stepper(model, step=1e-3, start=rest)
    assert stepper.contact_force(rope)[2] == pytest.approx(weight, rel=1e-6)


@pytest.mark.parametrize("law", [pl.LuGre(0.5, 0.4), pl.Coulomb(0.5)])
def test_friction_acts_from_the_start(law):
    # A rope lies on the ground and slides at once: no step is cut for what friction takes in the first.
    def lying(height, velocity, friction):
        model = pl.Model(gravity=GRAVITY)
        soft = pl.LinearElastic(youngs_modulus=5e6, poisson_ratio=0.4, density=1200.0, retardation_time=2e-3)
        line = [(0.0, 0.0, height), (1.0, 0.0, height)]
        section = pl.Circle(radius=0.01)
        rope = model.add_cable(line, elements=10, section=section, material=soft, velocity=velocity)
        ground = model.add_obstacle(pl.HalfSpace())
        model.add_contact(rope, ground, friction=friction)
        return model, rope

    model, rope = lying(0.01, (0, 0, 0), None)
    height = pl.solve_static(model).track(rope.at(0.5)).position[-1, 2]
    model, rope = lying(height, (0.05, 0, 0), law)
    result = pl.simulate(model, duration=2e-4, step=1e-4)
    assert result.statistics.rejected == 0
    weight = 1200.0 * np.pi * 0.01**2 * 9.81
    force = result.contact_force(rope)[0]
    assert force[2] == pytest.approx(weight, rel=0.05)
    # Bristles that are not bent yet resist by their damping, 0.2 sqrt(1e3 mu/(R g)) v of the normal force;
    # LuGre's fades as exp(-(v/5 v_s)^2) with v_s = 1e-2 m/s, Coulomb's is cut off at mu.
    damping = 0.2 * np.sqrt(1e3 * 0.5 / (0.01 * 9.81)) * 0.05
    expected = damping * np.exp(-1.0) if isinstance(law, pl.LuGre) else 0.5
    assert -force[0] / force[2] == pytest.approx(expected, rel=1e-3)
    lost = result.energy.dissipated[1]
    assert lost > 0.0
    assert abs(result.energy.total[1] - result.energy.total[0]) < 0.02 * lost
