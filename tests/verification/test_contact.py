"""Contact and friction of cables: rest, slopes, blows, crossings, the capstan, and what must be conserved."""

from __future__ import annotations

import itertools

import numpy as np
import pliant as pl
import pytest
from scipy.integrate import cumulative_simpson
from scipy.interpolate import CubicSpline
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
    # The suggested bound: bending and the ends of the wrap cost less than 1.5 %.
    assert record("capstan, ratio of tensions", ratio, 2.566332, 0.015 * 2.566332, source="exp(mu phi)")


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


def test_statics_refuses_friction():
    model, *_ = crossing(friction=pl.Coulomb(0.3), duration=1e-3)
    with pytest.raises(pl.ModelError, match="'contact1' has friction"):
        pl.solve_static(model)


def test_records_of_contact_add_up(tmp_path):
    _, low, high, result = crossing(friction=pl.LuGre(0.5, 0.4), along=0.7)
    contacts = result.contacts
    assert len(contacts) == len(result.time)
    assert not contacts[0]
    touching = [k for k, patches in enumerate(contacts) if patches]
    force = result.contact_force(low)
    np.testing.assert_array_equal(touching, np.flatnonzero(np.abs(force).sum(axis=1)))
    for k in touching:
        [patch] = contacts[k]
        assert patch.bodies == ("low", "high")
        assert patch.gap < 0.0
        assert np.linalg.norm(patch.normal) == pytest.approx(1.0)
        # The normal turns along the zone, by a tenth: friction need not be normal to the mean.
        assert abs(patch.friction_force @ patch.normal) < 0.02 * patch.normal_force
        # Pressures along the zone lean apart by as much: their sum is shorter, by a tenth squared over two.
        np.testing.assert_allclose(patch.force, force[k], atol=0.01 * patch.normal_force)
        # Friction is at most the static part of the normal force, but for bristles' damping at the blow.
        assert np.linalg.norm(patch.friction_force) <= 0.55 * patch.normal_force
        # The point lies between both centre lines, a radius from each, less half of the penetration.
        for body in (low, high):
            line = result.positions(body)[k]
            a, b = line[:-1], line[1:]
            part = np.clip(np.einsum("ij,ij->i", patch.point - a, b - a) / ((b - a) ** 2).sum(1), 0, 1)
            distance = np.linalg.norm(a + part[:, None] * (b - a) - patch.point, axis=1).min()
            assert distance == pytest.approx(5e-3, abs=1e-3)
    path = tmp_path / "run.h5"
    result.save(path)
    for again in (pl.Result.load(path), result._part(result._records[np.arange(len(result.time))])):
        for ours, theirs in zip(contacts, again.contacts, strict=True):
            assert [patch.normal_force for patch in ours] == [patch.normal_force for patch in theirs]
    np.testing.assert_array_equal(result._records[3:9].touching, result._records.touching[3:9])
    assert result._part(result._records[touching[-3:]]).contacts[-1][0].gap == contacts[touching[-1]][0].gap


def test_records_of_contact_stream_and_resume(tmp_path):
    model, *_ = crossing(friction=pl.LuGre(0.5, 0.4), duration=1e-3)
    whole = pl.simulate(model, duration=0.03, step=5e-4)
    pl.simulate(model, duration=0.03, step=5e-4, output=tmp_path / "run.h5")
    streamed = pl.Result.load(tmp_path / "run.h5")
    stepper = pl.Stepper(model, step=5e-4, record_every=1)
    stepper.advance(30)
    stepper.save(tmp_path / "half")
    again = pl.Stepper.load(tmp_path / "half")
    again.advance(30)
    assert sum(map(len, whole.contacts)) > 10
    for other in (streamed, again.result):
        assert [[p.normal_force for p in row] for row in other.contacts] == [
            [p.normal_force for p in row] for row in whole.contacts
        ]
    assert [p.gap for p in again.contacts] == [p.gap for p in whole.contacts[-1]]


def test_a_long_zone_is_one_record(record):
    result, rope, weight = on_a_slope()
    patch = max(result.contacts[-1], key=lambda patch: patch.normal_force)
    # A zone that runs over ten elements, and the two ends, which count apart.
    assert sum(p.normal_force > 0.5 * weight for p in result.contacts[-1]) == 1
    total = sum(p.normal_force for p in result.contacts[-1])
    assert record("rope at rest, sum of contact records over weight", total / weight, 1.0, 1e-6)
    assert patch.bodies == (rope.name, "obstacle1")
    # The middle of the rope, on the ground.
    np.testing.assert_allclose(patch.point, [0.5, 0.0, 0.0], atol=1e-3)


def test_contact_is_drawn(tmp_path):
    _, _, _, result = crossing(duration=0.02)
    figure = result.plot()
    from mpl_toolkits.mplot3d.art3d import Line3DCollection

    plain = len([c for c in figure.axes[0].collections if isinstance(c, Line3DCollection)])
    # Two ropes at each time, and an arrow wherever they touch.
    assert plain > 2 * 9
    result.export_html(tmp_path / "page.html")
    assert '"kind": "contact"' in (tmp_path / "page.html").read_text()
    pytest.importorskip("meshio")
    result.export_vtk(tmp_path / "vtk")
    assert list((tmp_path / "vtk").glob("forces_*.vtu"))


def test_several_zones_of_one_pair():
    # A wave lies across a straight rope.
    model = pl.Model(gravity=(0, 0, -GRAVITY))
    soft = pl.LinearElastic(youngs_modulus=5e6, poisson_ratio=0.4, density=1200.0, retardation_time=2e-3)
    thin = pl.Circle(radius=5e-3)
    low = model.add_cable([(0, 0, 0), (1, 0, 0)], elements=20, section=thin, material=soft)
    for end in (low.start, low.end):
        model.clamp(end)
    x = np.linspace(0, 1, 4001)
    speed = np.hypot(1.0, 0.3 * np.pi * np.cos(6 * np.pi * x))
    s = cumulative_simpson(speed, x=x, initial=0)
    points = np.stack([x, 0.05 * np.sin(6 * np.pi * x), np.full_like(x, 0.0099)], axis=1)
    wave = pl.Curve(CubicSpline(s, points), length=s[-1])
    high = model.add_cable(wave, elements=40, section=thin, material=soft, rest="straight")
    model.add_contact(low, high)
    # The overlap of 0.1 mm drives them apart: a look before it has.
    result = pl.simulate(model, duration=1e-4, step=5e-5)
    # Five crossings inside; the ends lie on the axis, too.
    zones = [patch.point[0] for patch in result.contacts[-1]]
    inner = [x for x in zones if 0.05 < x < 0.95]
    np.testing.assert_allclose(np.sort(inner), np.arange(1, 6) / 6, atol=5e-3)


def test_parallel_ropes_share_the_load(record):
    # One rope lies along another: the zone is as long as both, and the line load is the weight.
    model = pl.Model(gravity=(0, 0, -GRAVITY))
    soft = pl.LinearElastic(youngs_modulus=5e6, poisson_ratio=0.4, density=1200.0, retardation_time=2e-3)
    kind = {"section": pl.Circle(radius=5e-3), "material": soft}
    low = model.add_cable([(0, 0, 5e-3), (0.4, 0, 5e-3)], elements=5, **kind)
    high = model.add_cable([(0, 0, 15e-3), (0.4, 0, 15e-3)], elements=4, **kind)
    ground = model.add_obstacle(pl.HalfSpace())
    model.add_contact(low, ground)
    model.add_contact(low, high)
    result = pl.simulate(model, duration=0.4, step=1e-3)
    weight = np.pi * 25e-6 * 1200.0 * 0.4 * GRAVITY
    # In an unstable equilibrium exactly on top of each other, at rest but for what still hums.
    force = result.contact_force(high, low)[-1, 2]
    assert record("parallel ropes, force over weight", force / weight, 1.0, 1e-4)
    assert record(
        "parallel ropes, force on the ground over weights",
        result.contact_force(low, ground)[-1, 2] / (2 * weight),
        1.0,
        1e-4,
    )


@pytest.mark.parametrize("degrees", [90.0, 40.0])
def test_an_end_hits_head_on(degrees):
    # The free end of a rope flies at the ground.
    angle = np.radians(degrees)
    model = pl.Model()
    soft = pl.LinearElastic(youngs_modulus=5e6, poisson_ratio=0.4, density=1200.0, retardation_time=1e-3)
    along = np.array([np.cos(angle), 0.0, np.sin(angle)])
    low = np.array([0.0, 0.0, 5.5e-3])
    rope = model.add_cable(
        [low, low + 0.2 * along],
        elements=8,
        section=pl.Circle(radius=5e-3),
        material=soft,
        velocity=(0, 0, -0.5),
    )
    ground = model.add_obstacle(pl.HalfSpace())
    model.add_contact(rope, ground)
    result = pl.simulate(model, duration=0.03, step=2.5e-4)
    assert result.positions(rope)[:, 0, 2].min() > 0.5 * 5e-3
    assert result.contact_impulse(rope)[-1, 2] > 0.0
    energy = result.energy
    # The audit of a blow closes as everywhere.
    assert np.ptp(energy.total) < 0.01 * energy.kinetic[0]


def test_a_bundle_holds_together(record):
    # Seven ropes in a hexagonal bundle fall on the ground; nothing passes through anything, momentum is kept.
    model = pl.Model(gravity=(0, 0, -GRAVITY))
    soft = pl.LinearElastic(youngs_modulus=5e6, poisson_ratio=0.4, density=1200.0, retardation_time=2e-3)
    radius = 5e-3
    ropes = []
    for k in range(7):
        angle = np.pi / 3 * k
        place = np.zeros(2) if k == 6 else 2.02 * radius * np.array([np.cos(angle), np.sin(angle)])
        y, z = place + [0.0, 3.2 * radius]
        ropes.append(
            model.add_cable(
                [(0, y, z), (0.2, y, z)], elements=4, section=pl.Circle(radius=radius), material=soft
            )
        )
    ground = model.add_obstacle(pl.HalfSpace())
    model.add_contacts([*ropes, ground], friction=pl.LuGre(0.6, 0.5))
    result = pl.simulate(model, duration=0.3, step=1e-3)
    middles = np.array([result.track(rope.at(0.1)).position[-1] for rope in ropes])
    apart = np.linalg.norm(middles[:, None] - middles[None], axis=2)[np.triu_indices(7, 1)]
    assert apart.min() > 1.7 * radius
    weight = 7 * np.pi * radius**2 * 1200.0 * 0.2 * GRAVITY
    impulse = sum(result.contact_impulse(ground, rope)[-1] for rope in ropes)
    momentum = result.momentum[-1] - result.momentum[0]
    # Impulses of ground and gravity are the change of momentum: trapezoid over steps of 1 ms through blows.
    gap = momentum[2] + impulse[2] + weight * 0.3
    assert record("bundle, impulse balance over the weight's", gap / (weight * 0.3), 0.0, 0.01)


@pytest.mark.parametrize("friction", [None, pl.LuGre(static=0.5, dynamic=0.4), pl.Coulomb(0.4)])
@pytest.mark.parametrize("lifted", [0.0, 0.03])
def test_a_rope_that_has_come_to_rest_takes_an_iteration_a_step(friction, lifted):
    # A gap that is the same all along is largest anywhere: zones cut there would shake the rope by friction,
    # for ever, and Newton's iteration cycle among them.
    model = pl.Model(gravity=(0, 0, -9.81))
    rubber = pl.LinearElastic(5e6, 0.4, 1200.0, retardation_time=1e-3)
    line = [(0, 0, 0.006), (1, 0, 0.006 + lifted)]
    rope = model.add_cable(line, elements=20, section=pl.Circle(5e-3), material=rubber)
    model.add_contact(rope, model.add_obstacle(pl.HalfSpace()), friction=friction)
    stepper = pl.Stepper(model, step=1e-3, threads=1)
    stepper.advance(900)
    before = stepper.statistics
    stepper.advance(100)
    after = stepper.statistics
    assert stepper.energy.kinetic < (1e-26 if friction else 1e-18)
    assert after.newton_iterations - before.newton_iterations <= 220
    assert after.factorizations - before.factorizations <= 10
    assert after.rejected == before.rejected
