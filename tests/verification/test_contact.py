"""Contact and friction of cables: rest, slopes, blows, crossings, the capstan, and what must be conserved."""

from __future__ import annotations

import itertools

import numpy as np
import pliant as pl
import pytest
from scipy.spatial.transform import Rotation

GRAVITY = 9.81


def on_a_slope(degrees=0.0, *, drop=0.0, step=1e-3, duration=0.6, friction=None, damping=None):
    """A rope of 1 m and 10 mm radius on a plane; its middle, and the weight normal to the plane."""
    angle = np.radians(degrees)
    model = pl.Model(gravity=(GRAVITY * np.sin(angle), 0.0, -GRAVITY * np.cos(angle)))
    soft = pl.LinearElastic(youngs_modulus=5e6, poisson_ratio=0.4, density=1200.0, retardation_time=2e-3)
    line = [(0, 0, 0.01 + drop), (1, 0, 0.01 + drop)]
    rope = model.add_cable(line, elements=10, section=pl.Circle(radius=0.01), material=soft)
    ground = model.add_obstacle(pl.HalfSpace())
    model.add_contact(rope, ground, friction=friction, damping=damping)
    result = pl.simulate(model, duration=duration, step=step)
    weight = np.pi * 0.01**2 * 1200.0 * GRAVITY * np.cos(angle)
    return result, rope, weight


def test_a_rope_rests_on_the_ground(record):
    result, rope, weight = on_a_slope()
    force = result.contact_force(rope)[-1]
    # At rest after 0.6 s: equilibrium up to what has not died out.
    assert record(
        "rope at rest, ground force over weight", force[2] / weight, 1.0, 1e-6, source="equilibrium"
    )
    assert np.abs(force[:2]).max() < 1e-9 * weight
    assert np.abs(result.velocities(rope)[-1]).max() < 1e-6
    # The ground carries the whole impulse of gravity: trapezoid over steps against the scheme's own mean.
    impulse = result.contact_impulse(rope)[-1, 2]
    assert record("rope at rest, impulse over weight and time", impulse / (weight * 0.6), 1.0, 2e-3)


@pytest.mark.parametrize("law", [pl.LuGre(0.5, 0.4), pl.Coulomb(0.5)])
def test_a_rope_sticks_on_a_gentle_slope(law):
    result, rope, weight = on_a_slope(12.0, friction=law)
    middle = result.track(rope.at(0.5))
    # Bristles of 1/(1000 R) bend by less than a thousandth of the radius before they hold.
    assert 0.0 < middle.position[-1, 0] - 0.5 < 1e-4
    assert np.abs(middle.velocity[-1]).max() < 1e-6
    force = result.contact_force(rope)[-1]
    # Friction carries the weight along the slope; 1e-5 is left of the ringing.
    assert force[0] == pytest.approx(-weight * np.tan(np.radians(12.0)), rel=1e-4)


def test_a_rope_slides_down_a_steep_slope(record):
    result, rope, _ = on_a_slope(35.0, friction=pl.LuGre(0.5, 0.4))
    v = result.track(rope.at(0.5)).velocity[:, 0]
    achieved = (v[-1] - v[-301]) / (result.time[-1] - result.time[-301])
    exact = GRAVITY * (np.sin(np.radians(35)) - 0.4 * np.cos(np.radians(35)))
    # Beyond the Stribeck velocity the law is Coulomb's; the last of the ringing is left, 1e-5 m/s.
    assert record("rope sliding on 35 degrees, acceleration", achieved, exact, 1e-5, unit="m/s^2")


def test_the_audit_of_a_blow_closes(record):
    gaps = []
    for step in (1e-3, 5e-4):
        result, _, _ = on_a_slope(drop=0.02, step=step, duration=0.3)
        energy = result.energy
        gaps.append(np.ptp(energy.total) / energy.kinetic.max())
    # Steps are cut until each leaves at most 1e-4 of the energy out of the balance.
    assert record("rope dropped flat, energy drift at 1 ms over the energy of the blow", gaps[0], 0.0, 0.01)
    assert gaps[1] < gaps[0]


def crossing(*, elements=12, step=5e-4, duration=0.06, friction=None, speed=1.0, along=0.0, radius=5e-3):
    """A free rope thrown across another, without gravity."""
    model = pl.Model()
    soft = pl.LinearElastic(youngs_modulus=5e6, poisson_ratio=0.4, density=1200.0, retardation_time=1e-3)
    kind = {"elements": elements, "section": pl.Circle(radius=radius), "material": soft}
    low = model.add_cable([(-0.3, 0, 0), (0.3, 0.01, 0)], **kind, name="low")
    z = 2 * radius + 0.01
    high = model.add_cable(
        [(0.05, -0.3, z), (0.02, 0.3, z)], **kind, velocity=(along, 0, -speed), name="high"
    )
    model.add_contact(low, high, friction=friction)
    return model, low, high, pl.simulate(model, duration=duration, step=step)


def test_crossing_ropes_keep_their_momentum(record):
    _, low, high, result = crossing(friction=pl.LuGre(0.5, 0.4), along=0.7)
    force = result.contact_force(low)
    assert np.abs(force[:, 2]).max() > 1.0
    np.testing.assert_array_equal(force, -result.contact_force(high, low))
    size = np.abs(result.momentum[0]).max()
    drift = np.abs(result.momentum - result.momentum[0]).max() / size
    # Weights of both sides' points sum to zero: only what Newton's iteration leaves is lost.
    assert record("crossing ropes, drift of momentum", drift, 0.0, 1e-7)
    energy = result.energy
    # Steps are cut at the blow.
    assert record("crossing ropes, energy drift", np.ptp(energy.total) / energy.kinetic[0], 0.0, 0.01)
    assert np.all(np.diff(energy.dissipated) > -1e-3 * energy.kinetic[0])


def height_at_crossing(high, low):
    """How far one polyline (n, 3) lies above another where they cross, seen from above."""
    for a, b in itertools.pairwise(high):
        for c, d in itertools.pairwise(low):
            matrix = np.column_stack([(b - a)[:2], (c - d)[:2]])
            s, t = np.linalg.solve(matrix, (c - a)[:2])
            if 0 <= s <= 1 and 0 <= t <= 1:
                return (a + s * (b - a) - c - t * (d - c))[2]
    raise AssertionError("they do not cross")


def test_ropes_do_not_pass_through_each_other():
    # Ten metres a second by two milliseconds is ten times the radius: the first step would jump over.
    _, low, high, result = crossing(elements=24, radius=2e-3, speed=10.0, step=2e-3, duration=6e-3)
    assert result.statistics.rejected > 0
    for k in range(len(result.time)):
        # Chords cut the bulge off by some millimetres; ropes that met no resistance would be 46 mm apart.
        assert height_at_crossing(result.positions(high)[k], result.positions(low)[k]) > -5e-3
    assert np.abs(result.contact_impulse(low)[-1, 2]) > 0.0


def test_capstan(record):
    radius, wrap, mu, tail, pull = 0.102, np.pi, 0.3, 0.1, 50.0
    length = radius * wrap + 2 * tail

    def line(s):
        if s < tail:
            return (-radius, 0.0, s - tail)
        if s > tail + radius * wrap:
            return (radius, 0.0, tail + radius * wrap - s)
        angle = np.pi - (s - tail) / radius
        return (radius * np.cos(angle), 0.0, radius * np.sin(angle))

    model = pl.Model()
    # Nearly limp: EI/(T R^2) = 2e-6.
    stiff = pl.LinearElastic(youngs_modulus=1e9, poisson_ratio=0.4, density=1200.0, retardation_time=1e-4)
    section = pl.Section(
        area=np.pi * 4e-6, second_moments=(1e-15, 1e-15), torsion_constant=2e-15, radius=2e-3
    )
    rope = model.add_cable(
        pl.Curve(line, length=length), elements=40, section=section, material=stiff, rest="straight"
    )
    drum = model.add_obstacle(
        pl.Cylinder(radius=0.1, length=0.2), orientation=Rotation.from_euler("x", 90, degrees=True)
    )
    model.add_contact(rope, drum, friction=pl.LuGre(mu, mu, stribeck_velocity=1e-3))
    for end, force in ((rope.start, pull), (rope.end, 1.05 * pull * np.exp(mu * wrap))):
        model.add_point_mass(1.0, at=end)
        model.add_force(end, (0, 0, -force) * pl.Ramp(0.02))
    result = pl.simulate(model, duration=0.12, step=1e-3)
    tension = result.axial_force(rope)[-1]
    ratio = tension[-1] / tension[0]
    # The suggested bound: bending and the ends of the wrap cost less than 2 %.
    assert record("capstan, ratio of tensions", ratio, np.exp(mu * wrap), 0.02 * np.exp(mu * wrap))


def test_a_loop_touches_itself():
    # The legs of a hairpin fly at each other; they stay two radii apart but for the penetration.
    model = pl.Model()
    soft = pl.LinearElastic(youngs_modulus=5e6, poisson_ratio=0.4, density=1200.0, retardation_time=1e-3)
    bend = 0.05

    def line(s):
        leg, arc = 0.3, np.pi * bend
        if s < leg:
            return (leg - s, -bend, 0.0)
        if s > leg + arc:
            return (s - leg - arc, bend, 0.0)
        angle = -np.pi / 2 - (s - leg) / bend
        return (bend * np.cos(angle), bend * np.sin(angle), 0.0)

    rope = model.add_cable(
        pl.Curve(line, length=0.6 + np.pi * bend),
        elements=24,
        section=pl.Circle(radius=5e-3),
        material=soft,
        velocity=lambda r: np.stack([0 * r[:, 0], -2.0 * np.sign(r[:, 1]) * (r[:, 0] > 0.1), 0 * r[:, 0]], 1),
    )
    model.add_contact(rope, friction=pl.Coulomb(0.3))
    result = pl.simulate(model, duration=0.1, step=5e-4)
    r = result.positions(rope)
    ends = r[:, :8, 1].max(axis=1) - r[:, -8:, 1].min(axis=1)
    # They come close (two radii and a half) and do not pass.
    assert -ends.min() > 0.0
    apart = np.array([np.linalg.norm(q[:8, None] - q[None, -8:], axis=2).min() for q in r])
    assert 0.006 < apart.min() < 0.0125
    # Forces within a body cancel.
    drift = np.abs(result.momentum - result.momentum[0]).max()
    assert drift < 1e-6


def test_a_run_with_friction_resumes_with_the_same_bits(tmp_path):
    def make():
        model, *_ = crossing(friction=pl.LuGre(0.5, 0.4), along=0.7, duration=1e-3)
        return pl.Stepper(model, step=5e-4)

    whole = make()
    whole.advance(60)
    parts = make()
    parts.advance(27)
    parts.save(tmp_path / "run")
    state = parts.state
    parts.advance(10)
    parts.reset(state)
    parts.advance(33)
    again = pl.Stepper.load(tmp_path / "run")
    again.advance(33)
    for other in (parts, again):
        np.testing.assert_array_equal(other.coordinates, whole.coordinates)
        np.testing.assert_array_equal(other.velocities, whole.velocities)


def test_statics_finds_a_rope_on_the_ground(record):
    model = pl.Model(gravity=(0, 0, -GRAVITY))
    soft = pl.LinearElastic(youngs_modulus=5e6, poisson_ratio=0.4, density=1200.0)
    rope = model.add_cable(
        [(0, 0, 0.03), (1, 0, 0.03)], elements=20, section=pl.Circle(radius=5e-3), material=soft
    )
    ground = model.add_obstacle(pl.HalfSpace())
    pins = [model.pin(rope.start), model.pin(rope.end)]
    model.add_contact(rope, ground)
    result = pl.solve_static(model)
    held = sum(result.reaction(pin).force[-1] for pin in pins) + result.contact_force(rope)[-1]
    weight = np.pi * 25e-6 * 1200.0 * GRAVITY
    # Equilibrium, up to the solver's tolerance.
    assert record("rope between pins on the ground, forces over weight", held[2] / weight, 1.0, 1e-6)
    assert result.contact_force(rope)[-1, 2] > 0.1 * weight
    assert result.positions(rope)[-1, :, 2].min() > 0.9 * 5e-3


def test_contacts_travel_with_copies_and_files(tmp_path):
    model, *_ = crossing(friction=pl.LuGre(0.5, 0.4), duration=1e-3)
    ground = model.add_obstacle(pl.HalfSpace((0, 1, 1)), position=(0, 0, -1), name="ground")
    model.add_contact(model["low"], ground, damping=0.0)
    model.save(tmp_path / "model.json")
    again = pl.Model.load(tmp_path / "model.json")
    assert [c.name for c in again.contacts] == ["contact1", "contact2"]
    one, other = (pl.simulate(m, duration=0.01, step=5e-4) for m in (model.copy(), again))
    np.testing.assert_array_equal(one.positions("high"), other.positions("high"))
    assert "low with ground, no friction" in str(model)
