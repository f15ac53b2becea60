"""Contact of shells and membranes with cables, masses, balls, each other and themselves."""

import numpy as np
import pliant as pl
import pytest
from scipy.interpolate import LinearNDInterpolator

GRAVITY = 9.81
RUBBER = pl.LinearElastic(3e5, 0.45, 1070.0, retardation_time=5e-3)
ROPE = pl.LinearElastic(5e6, 0.4, 1200.0, retardation_time=1e-3)


def sheet(model, *, n=4, size=0.12, center=(0, 0, 0), slope=0.0, thickness=4e-3, kind="shell", **options):
    """A square, tilted about y by a slope, by the middle of its mid-surface."""
    x = np.linspace(-size / 2, size / 2, n + 1)
    u, v = np.meshgrid(x, x, indexing="ij")
    c, s = np.cos(slope), np.sin(slope)
    grid = np.stack([c * u, v, -s * u], -1) + np.asarray(center)
    add = model.add_shell if kind == "shell" else model.add_membrane
    return add(pl.Mesh.grid(grid), thickness=thickness, material=RUBBER, **options)


def hold(model, body, sides):
    """Clamp a square by its named edges."""
    for side in sides:
        model.clamp(body.edge(side))


def carried(result, body, other, mass):
    """Impulse that a body got, less the momentum that it has, over that of its weight."""
    v = np.gradient(result.center_of_mass(body)[:, 2], result.time, edge_order=2)[-1]
    impulse = result.contact_impulse(body, other)[-1, 2]
    return (impulse - mass * v) / (mass * GRAVITY * result.time[-1])


def drift(values):
    """Largest change of a momentum over its largest value at the start."""
    return float(np.abs(values - values[0]).max() / np.abs(values[0]).max())


@pytest.mark.parametrize("kind", ["shell", "membrane"])
def test_a_sheet_rests_on_a_clamped_sheet(kind, record):
    model = pl.Model(gravity=(0, 0, -GRAVITY))
    below = sheet(model, n=3, size=0.15, thickness=6e-3)
    hold(model, below, ("rim",))
    above = sheet(model, n=2, size=0.09, center=(0.004, -0.003, 5e-3), kind=kind)
    model.add_contact(above, below, damping=50.0)
    result = pl.simulate(model, duration=0.5, step=2e-3)
    mass = 1070.0 * 4e-3 * 0.09**2
    force = result.contact_force(above, below)
    # The impulse is a sum of trapezoids.
    share = carried(result, above, below, mass)
    assert record(f"{kind} on a clamped sheet, impulse over weight", share, 1.0, 1e-3, source="momentum")
    # The lower sheet swings with what lies on it, and comes to rest.
    assert np.abs(force[-20:, 2] / (mass * GRAVITY) - 1.0).max() < 0.05
    np.testing.assert_array_equal(force, -result.contact_force(below, above))


@pytest.mark.parametrize("kind", ["shell", "membrane"])
def test_two_free_sheets_exchange_momentum(kind, record):
    model = pl.Model()
    one = sheet(model, n=2, thickness=4e-3, kind=kind, angular_velocity=(0, 0, 2.0))
    two = sheet(model, n=3, size=0.1, center=(0.02, 0.01, 8e-3), slope=0.03, velocity=(0.3, 0.1, -1.0))
    model.add_contact(one, two, friction=pl.LuGre(0.4, 0.3))
    result = pl.simulate(model, duration=0.03, step=5e-4)
    assert result.contact_impulse(two)[-1, 2] > 1e-3
    np.testing.assert_array_equal(result.contact_impulse(one), -result.contact_impulse(two))
    # Newton's tolerance.
    assert record(f"{kind} and shell thrown at it, drift of momentum", drift(result.momentum), 0.0, 1e-10)


@pytest.mark.parametrize("kind", ["shell", "membrane"])
def test_a_ball_dropped_on_a_free_sheet_gives_it_its_impulse(kind, record):
    model = pl.Model()
    below = sheet(model, n=3, kind=kind)
    ball = model.add_rigid_body(
        mass=0.02, shape=pl.Sphere(0.02), position=(0.011, 0.007, 0.024), velocity=(0.1, 0, -1.0)
    )
    model.add_contact(ball, below, friction=pl.LuGre(0.4, 0.3))
    result = pl.simulate(model, duration=0.03, step=5e-4)
    impulse = result.contact_impulse(ball, below)
    assert impulse[-1, 2] > 1e-3
    np.testing.assert_array_equal(impulse, -result.contact_impulse(below, ball))
    # Newton's tolerance.
    assert record(f"ball on a free {kind}, drift of momentum", drift(result.momentum), 0.0, 1e-9)


@pytest.mark.parametrize("kind", ["cable", "beam"])
def test_a_rope_lies_over_a_sheet(kind, record):
    model = pl.Model(gravity=(0, 0, -GRAVITY))
    table = sheet(model, n=3, size=0.15, thickness=6e-3)
    hold(model, table, ("rim",))
    line = [(-0.06, 0.01, 8.1e-3), (0.06, -0.02, 8.1e-3)]
    add = model.add_cable if kind == "cable" else model.add_beam
    rope = add(line, elements=6, section=pl.Circle(5e-3), material=ROPE)
    model.add_contact(rope, table, damping=20.0)
    result = pl.simulate(model, duration=0.5, step=2e-3)
    mass = np.pi * 25e-6 * 1200.0 * np.hypot(0.12, 0.03)
    force = result.contact_force(rope, table)
    share = carried(result, rope, table, mass)
    # The impulse is a sum of trapezoids.
    assert record(f"{kind} on a clamped sheet, impulse over weight", share, 1.0, 1e-3, source="momentum")
    assert np.abs(force[-20:, 2] / (mass * GRAVITY) - 1.0).max() < 0.05
    # Where it presses the records say as much.
    patches = [p for p in result.contacts[-1] if set(p.bodies) == {rope.name, "shell1"}]
    assert sum(p.normal_force * p.normal[2] for p in patches) == pytest.approx(force[-1, 2], rel=1e-3)


@pytest.mark.parametrize("damping", [1.0, 20.0])
def test_a_wavy_rope_settles_on_a_sheet(damping):
    model = pl.Model(gravity=(0, 0, -GRAVITY))
    table = sheet(model, n=3, size=0.15, thickness=6e-3)
    hold(model, table, ("rim",))
    x = np.linspace(0.0, 0.12, 9)
    z = 8.1e-3 + 2e-3 * (1.0 - np.cos(4.0 * np.pi * x / 0.12))
    line = np.stack([x - 0.06, 0.01 - 0.25 * x, z], -1)
    rope = model.add_cable(line, elements=8, section=pl.Circle(5e-3), material=ROPE)
    model.add_contact(rope, table, damping=damping)
    # Zones grow under the waves: with three points in each Newton's iteration stopped for good. Steps are cut
    # for the energy of the blows alone.
    result = pl.simulate(model, duration=0.3, step=2e-3)
    assert result.statistics.rejected < 0.5 * result.statistics.steps
    mass = np.pi * 25e-6 * 1200.0 * np.linalg.norm(np.diff(line, axis=0), axis=1).sum()
    # The impulse is a sum of trapezoids through blows; with little damping the rope bounces all the time.
    assert carried(result, rope, table, mass) == pytest.approx(1.0, abs=1e-2)


def test_a_sheet_slides_on_a_sloping_sheet(record):
    angle = np.radians(30.0)
    model = pl.Model(gravity=(GRAVITY * np.sin(angle), 0, -GRAVITY * np.cos(angle)))
    slope = sheet(model, n=4, size=0.3, thickness=8e-3)
    model.clamp(slope.faces())
    slider = sheet(model, n=2, size=0.08, thickness=6e-3, center=(-0.06, 0.0, 7e-3))
    model.add_contact(slider, slope, friction=pl.LuGre(0.4, 0.4), damping=50.0)
    result = pl.simulate(model, duration=0.2, step=2e-3)
    v = np.gradient(result.center_of_mass(slider)[:, 0], result.time)
    acceleration = (v[-2] - v[40]) / (result.time[-2] - result.time[40])
    exact = GRAVITY * (np.sin(angle) - 0.4 * np.cos(angle))
    # Friction acts on the mid-surfaces; the hum of the normal force remains.
    assert record("sheet sliding on a sheet, acceleration", acceleration, exact, 0.02, unit="m/s^2")


def test_statics_lays_a_sheet_and_a_rope_on_a_sheet(record):
    model = pl.Model(gravity=(0, 0, -GRAVITY))
    table = sheet(model, n=3, size=0.15, thickness=6e-3)
    hold(model, table, ("u_min", "u_max"))
    cloth = sheet(model, n=2, size=0.1, center=(0, 0, 5e-3 - 1e-5))
    line = [(0, -0.04, 12e-3 - 2e-5), (0, 0.04, 12e-3 - 2e-5)]
    rope = model.add_cable(line, elements=4, section=pl.Circle(5e-3), material=ROPE)
    model.add_contact(cloth, table)
    model.add_contact(rope, cloth)
    hooks = [model.pin(cloth.node(0)), model.pin(rope.start), model.pin(rope.end)]
    result = pl.solve_static(model, load_steps=2)
    held = sum(result.reaction(pin).force[-1] for pin in hooks)
    held = held + result.contact_force(cloth, table)[-1]
    weight = (1070.0 * 4e-3 * 0.1**2 + np.pi * 25e-6 * 1200.0 * 0.08) * GRAVITY
    # Equilibrium, up to the solver's tolerance.
    assert record("rope on a cloth on a sheet, forces over weight", held[2] / weight, 1.0, 1e-6)


def test_a_run_with_surfaces_resumes_with_the_same_bits(tmp_path):
    def make():
        model = pl.Model(gravity=(0, 0, -GRAVITY))
        below = sheet(model, n=2)
        model.pin(below.edge("rim"))
        above = sheet(model, n=2, size=0.08, center=(0.01, 0, 4.5e-3), velocity=(0.1, 0, -0.4))
        line = [(-0.04, 0.01, 11.6e-3), (0.05, -0.01, 11.6e-3)]
        rope = model.add_cable(
            line, elements=3, section=pl.Circle(5e-3), material=ROPE, velocity=(0, 0.2, -0.4)
        )
        model.add_contacts([below, above, rope], friction=pl.LuGre(0.4, 0.3))
        return pl.Stepper(model, step=1e-3)

    whole = make()
    whole.advance(24)
    parts = make()
    parts.advance(13)
    parts.save(tmp_path / "run")
    again = pl.Stepper.load(tmp_path / "run")
    again.advance(11)
    np.testing.assert_array_equal(again.coordinates, whole.coordinates)
    np.testing.assert_array_equal(again.velocities, whole.velocities)


def folded(model, *, radius=0.02, leg=0.12, length=0.3, width=0.04, thickness=3e-3, n=16, **options):
    """A strip whose one half lies over the other, bent with a radius, by its stress-free length along x."""
    s = np.linspace(0, length, n + 1)
    turn = np.clip((s - leg) / radius, 0, np.pi)
    x = np.where(s < leg, leg - s, -radius * np.sin(turn))
    x = np.where(turn >= np.pi, s - leg - np.pi * radius, x)
    z = radius * (1 - np.cos(turn))
    y = np.linspace(0, width, 3)
    flat = np.stack([*np.meshgrid(s, y, indexing="ij"), np.zeros((n + 1, 3))], -1)
    bent = np.stack([np.repeat(x[:, None], 3, 1), flat[..., 1], np.repeat(z[:, None], 3, 1)], -1)
    return model.add_shell(
        pl.Mesh.grid(flat),
        thickness=thickness,
        material=RUBBER,
        initial=bent.reshape(-1, 3),
        **options,
    )


@pytest.mark.slow
def test_a_folded_strip_comes_to_lie_on_itself(record):
    model = pl.Model(gravity=(0, 0, -GRAVITY))
    strip = folded(model)
    # Six of sixteen along the strip, two across.
    model.clamp(strip.faces(np.arange(12)))
    model.add_contact(strip, damping=20.0)
    result = pl.simulate(model, duration=0.4, step=2e-3)
    r = result.positions(strip)[-1].reshape(17, 3, 3)[:, 1]
    upper = r[10:]
    over = upper[(upper[:, 0] > 0.005) & (upper[:, 0] < 0.11)]
    assert len(over) >= 3
    # It has come down: one thickness between mid-surfaces, but for the ramp and what the weight presses in.
    assert over[:, 2].min() == pytest.approx(3e-3, abs=1.5e-4)
    weight = 1070.0 * 3e-3 * 0.04 * GRAVITY * (0.3 - 0.12)
    pressed = sum(p.normal_force for p in result.contacts[-1])
    # The bend hangs from the clamped half, which carries the rest.
    assert 0.1 * weight < pressed < weight
    np.testing.assert_array_equal(result.contact_force(strip), 0.0)


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["shell", "membrane"])
def test_nothing_passes_through_a_film(kind):
    rng = np.random.default_rng(20)
    for _ in range(10):
        model = pl.Model()
        film = sheet(model, n=3, thickness=1e-3, kind=kind)
        model.pin(film.edge("rim"))
        place = rng.uniform(-0.03, 0.03, 3)
        place[2] = 0.012
        speed = rng.uniform(1.0, 20.0)
        velocity = (*rng.uniform(-0.3, 0.3, 2) * speed, -speed)
        mass = model.add_point_mass(2e-3, at=place, velocity=velocity)
        model.add_contact(mass, film)
        result = pl.simulate(model, duration=8e-3, step=1e-3)
        end = result.track(mass.center).position[-1]
        x = np.linspace(-0.058, 0.058, 24)
        points = [film.at((u, v, 0)) for u in x for v in x]
        r = np.array([result.track(point).position[-1] for point in points])
        below = LinearNDInterpolator(r[:, :2], r[:, 2])(end[:2])[0]
        # A step of up to twenty thicknesses carries over the film, and the contact back; samples of it are
        # 5 mm apart.
        assert end[2] > below - 5e-4, (place, velocity)


def test_a_strip_that_claps_keeps_its_momenta(record):
    model = pl.Model()
    strip = folded(
        model, radius=0.012, n=12, velocity=lambda r: np.outer(r[:, 2] / 0.012 - 1.0, (0.0, 0.0, -1.0))
    )
    model.add_contact(strip)
    result = pl.simulate(model, duration=0.04, step=5e-4)
    assert any(len(patches) for patches in result.contacts)
    energy = result.energy
    scale = np.sqrt(2 * energy.kinetic[0] * 1070.0 * 3e-3 * 0.04 * 0.3)
    # Newton's tolerance.
    drifted = np.abs(result.momentum - result.momentum[0]).max() / scale
    assert record("strip that claps, drift of momentum", drifted, 0.0, 1e-9)
    turned = np.abs(result.angular_momentum - result.angular_momentum[0]).max() / (0.1 * scale)
    # The scheme keeps it to second order.
    assert record("strip that claps, drift of angular momentum", turned, 0.0, 1e-3)


def test_a_cloth_folds_over_a_line_with_friction_on_both_slopes():
    # The line has a foot on each slope of the fold: each slope remembers its own bristles.
    model = pl.Model(gravity=(0, 0, -GRAVITY))
    x = np.linspace(-0.1, 0.1, 7)
    u, v = np.meshgrid(x, x, indexing="ij")
    grid = np.stack([u + 0.003, v, np.full_like(u, 9.5e-3)], -1)
    cotton = pl.LinearElastic(5e6, 0.3, 400.0, retardation_time=2e-3)
    cloth = model.add_membrane(pl.Mesh.grid(grid), thickness=1e-3, material=cotton)
    nylon = pl.LinearElastic(1e9, 0.4, 1150.0, retardation_time=1e-4)
    line = model.add_cable(
        [(0, -0.2, 0), (0, 0.2, 0)], elements=12, section=pl.Circle(4e-3), material=nylon, pretension=30.0
    )
    model.pin(line.start)
    model.pin(line.end)
    model.add_contact(cloth, line, friction=pl.Coulomb(0.4))
    result = pl.simulate(model, duration=0.12, step=1e-3)
    # Steps are cut where cloth and line strike, never to parts that the jump of a force would ask for.
    assert result.statistics.steps < 400
    energy = result.energy.total
    assert np.ptp(energy) < 0.01 * result.energy.kinetic.max()
