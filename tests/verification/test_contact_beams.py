"""Contact of beams: they rest, press, roll and touch what cables touch."""

from __future__ import annotations

import numpy as np
import pliant as pl
import pytest
from scipy.optimize import brentq

GRAVITY = 9.81
SOFT = pl.LinearElastic(youngs_modulus=5e6, poisson_ratio=0.4, density=1200.0, retardation_time=2e-3)
RADIUS = 0.01
WEIGHT = np.pi * RADIUS**2 * 1200.0 * GRAVITY
"""Of a metre of the beams here [N/m]."""


def resting(*, elements=6, angle=0.0, friction=None, duration=0.5, step=1e-3, length=0.6):
    """A beam along y on a plane that falls along x; its slope in degrees."""
    slope = np.radians(angle)
    model = pl.Model(gravity=(GRAVITY * np.sin(slope), 0.0, -GRAVITY * np.cos(slope)))
    beam = model.add_beam(
        [(0, 0, RADIUS), (0, length, RADIUS)],
        elements=elements,
        section=pl.Circle(radius=RADIUS),
        material=SOFT,
        name="beam",
    )
    ground = model.add_obstacle(pl.HalfSpace())
    model.add_contact(beam, ground, friction=friction)
    return model, beam, pl.simulate(model, duration=duration, step=step)


def test_a_beam_rests_on_the_ground(record):
    _, beam, result = resting()
    force = result.contact_force(beam)[-1, 2]
    # At rest but for what has not died out in half a second.
    assert record("beam at rest, ground force over weight", force / (0.6 * WEIGHT), 1.0, 1e-6)
    patch = max(result.contacts[-1], key=lambda patch: patch.normal_force)
    assert patch.bodies == ("beam", "obstacle1")


def test_a_beam_rolls_down_a_slope(record):
    # Friction acts on the surface, a radius off the line: the beam turns, and falls slower than it slides.
    _, beam, result = resting(angle=10.0, friction=pl.LuGre(0.6, 0.5))
    motion = result.track(beam.at(0.3))
    v = motion.velocity[:, 0]
    achieved = (v[-1] - v[200]) / (result.time[-1] - result.time[200])
    exact = 2.0 / 3.0 * GRAVITY * np.sin(np.radians(10.0))
    # Bristles creep by their length over the way, and the section yields to its load: per milles.
    assert record("beam rolling down 10 degrees, acceleration", achieved, exact, 0.01 * exact, unit="m/s^2")
    # It turns by its way over the radius: no slip but the bristles' and the first touch's.
    up = np.array([turn.apply((0.0, 0.0, 1.0)) for turn in motion.orientation])
    angle = np.unwrap(np.arctan2(up[:, 0], up[:, 2]))
    way = motion.position[-1, 0] - motion.position[0, 0]
    assert record("beam rolling, turn by the radius over the way", angle[-1] * RADIUS / way, 1.0, 0.01)


def test_a_beam_slides_down_a_steep_slope(record):
    # Steeper than three times the friction it slides, too: the line falls as Coulomb says.
    _, beam, result = resting(angle=50.0, friction=pl.LuGre(0.2, 0.2), duration=0.3)
    v = result.track(beam.at(0.3)).velocity[:, 0]
    achieved = (v[-1] - v[100]) / (result.time[-1] - result.time[100])
    exact = GRAVITY * (np.sin(np.radians(50)) - 0.2 * np.cos(np.radians(50)))
    # The ringing of the touch is left.
    assert record("beam sliding down 50 degrees, acceleration", achieved, exact, 2e-3 * exact, unit="m/s^2")


def crossing(kinds, *, friction=None, speed=0.5, duration=0.05, step=5e-4):
    """Two lines in free flight, the upper thrown at the lower."""
    model = pl.Model()
    common = {"elements": 8, "section": pl.Circle(radius=5e-3), "material": SOFT}
    z = 10e-3 + 2e-3
    lines = ([(-0.2, 0, 0), (0.2, 0.01, 0)], [(0.03, -0.2, z), (0.01, 0.2, z)])
    speeds = ((0, 0, 0), (0.3, 0, -speed))
    bodies = []
    for name, kind, line, velocity in zip(("low", "high"), kinds, lines, speeds, strict=True):
        add = model.add_beam if kind == "beam" else model.add_cable
        bodies.append(add(line, **common, velocity=velocity, name=name))
    model.add_contact(*bodies, friction=friction)
    return model, *bodies, pl.simulate(model, duration=duration, step=step)


@pytest.mark.parametrize("kinds", [("beam", "beam"), ("beam", "cable"), ("cable", "beam")])
def test_lines_of_both_kinds_keep_momentum_and_energy(kinds, record):
    _, low, high, result = crossing(kinds, friction=pl.LuGre(0.5, 0.4))
    force = result.contact_force(low)
    assert np.abs(force[:, 2]).max() > 1.0
    np.testing.assert_array_equal(force, -result.contact_force(high, low))
    size = np.abs(result.momentum[0]).max()
    drift = np.abs(result.momentum - result.momentum[0]).max() / size
    # Weights of both sides' points sum to zero: only what Newton's iteration leaves is lost.
    assert record(f"crossing {kinds[0]} and {kinds[1]}, drift of momentum", drift, 0.0, 1e-7)
    energy = result.energy
    # Steps are cut at the blow.
    gap = np.ptp(energy.total) / energy.kinetic[0]
    assert record(f"crossing {kinds[0]} and {kinds[1]}, energy drift", gap, 0.0, 0.01)
    if kinds == ("beam", "beam"):
        turning = np.abs(result.angular_momentum - result.angular_momentum[0]).max()
        arm = np.abs(result.momentum[0]).max() * 0.2
        # Both forces act in one place, but for the strain of the sections, per milles of a radius.
        assert record("crossing beams, drift of angular momentum", turning / arm, 0.0, 1e-4)


def test_a_run_of_beams_resumes_with_the_same_bits(tmp_path):
    model, *_ = crossing(("beam", "cable"), friction=pl.LuGre(0.5, 0.4), duration=1e-3)
    whole = pl.Stepper(model, step=5e-4)
    whole.advance(40)
    parts = pl.Stepper(model, step=5e-4)
    parts.advance(17)
    parts.save(tmp_path / "run")
    again = pl.Stepper.load(tmp_path / "run")
    again.advance(23)
    np.testing.assert_array_equal(again.coordinates, whole.coordinates)


def test_crossing_clamped_beams_press_as_statics_says(record):
    # Two clamped beams cross; the upper one's supports are lower by e than where the two just touch.
    length, radius, pressed = 0.4, 5e-3, 5e-4
    material = pl.LinearElastic(youngs_modulus=5e6, poisson_ratio=0.4, density=1200.0)
    model = pl.Model()
    common = {"elements": 32, "section": pl.Circle(radius=radius), "material": material}
    half = length / 2
    low = model.add_beam([(-half, 0, 0), (half, 0, 0)], **common)
    z = 2 * radius - pressed
    bump = 1.2 * pressed
    s = np.linspace(-half, half, 33)
    # It begins bent out of the way.
    shape = z + bump * np.cos(np.pi * s / length) ** 2
    start = np.stack([0 * s, s, shape], axis=1)
    high = model.add_beam([(0, -half, z), (0, half, z)], **common, initial=start)
    for point in (low.start, low.end, high.start, high.end):
        model.clamp(point)
    model.add_contact(low, high)
    result = pl.solve_static(model)
    force = result.contact_force(high)[-1, 2]
    inertia = np.pi * radius**4 / 4
    area = np.pi * radius**2
    shear = 5e6 / 2.8 * area * 6 * 1.4 / (7 + 6 * 0.4)
    # A clamped beam with shear: L^3/(192 EI) + L/(4 k GA).
    give = length**3 / (192 * 5e6 * inertia) + length / (4 * shear)
    k = 0.5 * 5e6 / (2 * (1 - 0.4**2))
    ramp = 5e-3 * radius

    def rest(f):
        depth = pressed - 2 * give * f
        if depth <= 0:
            return f
        half_zone = np.sqrt(4 * radius * depth - depth**2)
        x = np.linspace(0.0, half_zone, 20001)
        delta = 2 * radius - np.hypot(x, 2 * radius - depth)
        p = np.where(delta < ramp, 0.5 * k * delta**2 / ramp, k * (delta - 0.5 * ramp))
        return f - 2 * np.trapezoid(np.clip(p, 0.0, None), x)

    exact = brentq(rest, 0.0, pressed / (2 * give))
    # A quarter of a span is a cantilever of n = 8 elements: 1/(4 n^2) = 4e-3; stretching is a per mille.
    assert record("crossing clamped beams, force", force, exact, 0.01 * exact, unit="N", source="statics")


def test_a_block_rests_on_a_beam(record):
    # The beam lies on the ground, the block across it.
    model = pl.Model(gravity=(0, 0, -GRAVITY))
    beam = model.add_beam(
        [(0, 0, RADIUS), (0.2, 0, RADIUS)], elements=2, section=pl.Circle(radius=RADIUS), material=SOFT
    )
    block = model.add_rigid_body(shape=pl.Box(size=(0.1, 0.1, 0.02)), mass=0.05, position=(0.1, 0, 0.03))
    ground = model.add_obstacle(pl.HalfSpace())
    model.add_contact(beam, ground, friction=pl.Coulomb(0.5))
    model.add_contact(beam, block, friction=pl.Coulomb(0.5), damping=100.0)
    result = pl.simulate(model, duration=0.2, step=1e-3)
    on_block = result.contact_force(block, beam)[-1, 2]
    # At rest but for a hum.
    assert record("block on a beam, force over weight", on_block / (0.05 * GRAVITY), 1.0, 1e-2)


def test_a_beam_touches_itself_and_is_drawn(tmp_path):
    model, _, _, result = crossing(("beam", "beam"), duration=0.02)
    model.add_contact(model["low"])
    assert len(model.contacts) == 2
    assert len(pl.simulate(model, duration=1e-3, step=5e-4).time) == 3
    model.save(tmp_path / "model.json")
    assert len(pl.Model.load(tmp_path / "model.json").contacts) == 2
    result.plot()
    result.export_html(tmp_path / "page.html")
    assert '"kind": "contact"' in (tmp_path / "page.html").read_text()
