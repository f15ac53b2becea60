"""Contact of shells, membranes, rigid bodies, masses and cables with shapes that rest or move."""

import numpy as np
import pliant as pl
import pytest
from scipy.optimize import brentq
from scipy.spatial.transform import Rotation

GRAVITY = 9.81
RUBBER = pl.LinearElastic(3e5, 0.45, 1070.0, retardation_time=5e-3)


def on_the_ground(shape, *, angle=0.0, velocity=(0, 0, 0), omega=(0, 0, 0), lift=None, turn=None, **contact):
    """A rigid body of 1 kg on a plane that is tilted about y by an angle."""
    a = np.radians(angle)
    model = pl.Model(gravity=(GRAVITY * np.sin(a), 0, -GRAVITY * np.cos(a)))
    low = {"Sphere": 0.1, "Box": 0.05, "Cylinder": 0.1, "Capsule": 0.1}[type(shape).__name__]
    body = model.add_rigid_body(
        mass=1.0,
        shape=shape,
        position=(0, 0, low if lift is None else lift),
        velocity=velocity,
        angular_velocity=omega,
        orientation=turn,
    )
    ground = model.add_obstacle(pl.HalfSpace())
    model.add_contact(body, ground, **contact)
    return model, body


@pytest.mark.parametrize(
    ("shape", "turn", "factor"),
    [
        (pl.Sphere(0.1), None, 2 / 5),
        (pl.Cylinder(0.1, 0.3), Rotation.from_euler("x", 90, degrees=True), 1 / 2),
        (pl.Capsule(0.1, 0.3), Rotation.from_euler("x", 90, degrees=True), None),
    ],
)
def test_a_sliding_body_comes_to_roll(shape, turn, factor, record):
    model, body = on_the_ground(shape, velocity=(1, 0, 0), turn=turn, friction=pl.LuGre(0.3, 0.3))
    result = pl.simulate(model, duration=0.4, step=5e-4)
    v = result.track(body.center).velocity
    if factor is None:
        factor = shape.gyration[2] / 0.1**2
    # v = v_0/(1 + I/(m R^2)), whatever the law of friction: momentum about the ground. It stands a 3e-4 of
    # the radius deep in the ground, and bristles give way by as much as the normal force hums.
    name = type(shape).__name__.lower()
    assert record(
        f"{name}, sliding to rolling, v/v_0", v[-1, 0], 1 / (1 + factor), 5e-4, source="closed form"
    )
    # The ground's impulse is what is left of the motion (a sum of trapezoids: not across steps that are cut).
    impulse = result.contact_impulse(body)[-1, 0]
    assert impulse == pytest.approx(v[-1, 0] - 1.0, abs=1e-5)


def test_a_ball_rolls_down_a_slope(record):
    model, body = on_the_ground(pl.Sphere(0.1), angle=20, friction=pl.LuGre(0.6, 0.5))
    result = pl.simulate(model, duration=0.5, step=1e-3)
    v = result.track(body.center).velocity[:, 0]
    acceleration = (v[-1] - v[-251]) / 0.25
    exact = 5 / 7 * GRAVITY * np.sin(np.radians(20))
    # Presliding and the vertical hum leave a few parts in ten thousand.
    assert record("ball rolling down 20 degrees, acceleration", acceleration, exact, 2e-3, unit="m/s^2")


@pytest.mark.parametrize(("angle", "slides"), [(20, False), (30, True), (40, True)])
def test_a_box_sticks_or_slides_by_its_coefficient(angle, slides, record):
    # tan 26.6 degrees = 0.5.
    model, body = on_the_ground(
        pl.Box((0.2, 0.2, 0.1)), angle=angle, friction=pl.LuGre(0.5, 0.5), damping=50.0
    )
    result = pl.simulate(model, duration=0.5, step=1e-3)
    track = result.track(body.center)
    if slides:
        acceleration = (track.velocity[-1, 0] - track.velocity[-251, 0]) / 0.25
        exact = GRAVITY * (np.sin(np.radians(angle)) - 0.5 * np.cos(np.radians(angle)))
        # The hum of the normal force, carried by friction.
        assert record(f"box on {angle} degrees, acceleration", acceleration, exact, 2e-3, unit="m/s^2")
    else:
        # Bristles of a thousandth of the size hold it.
        assert track.position[-1, 0] < 5e-4
        assert np.abs(track.velocity[-1]).max() < 1e-4


@pytest.mark.parametrize("c", [0.1, 0.5, 1.0])
def test_a_ball_bounces_as_hunt_and_crossley_say(c, record):
    model, body = on_the_ground(pl.Sphere(0.1), lift=0.2, damping=c)
    result = pl.simulate(model, duration=0.2, step=2e-4)
    v = result.track(body.center).velocity[:, 2]
    touching = np.flatnonzero(result.contact_force(body)[:, 2] > 0)
    first, last = touching[0] - 1, touching[-1] + 1
    v_0 = -v[first]

    def law(e):
        return np.log((1 + c * v_0) / (1 - c * v_0 * e)) - c * v_0 * (1 + e)

    exact = brentq(law, 0, min(1.0, 0.999 / (c * v_0)))
    # Weight acts during the blow of 10 ms, 0.1 m/s in 1.4; half of it each way.
    gained = GRAVITY * (result.time[last] - result.time[first])
    e = (v[last] + 0.5 * gained) / (v_0 + 0.5 * gained)
    assert record(
        f"ball on the ground, restitution at c = {c}", e, exact, 0.01, source="Hunt & Crossley 1975"
    )


@pytest.mark.parametrize(("restitution", "c_v"), [(0.9, 0.167), (0.5, 1.433), (0.2, 4.919)])
def test_damping_for_a_restitution_is_that_of_the_table(restitution, c_v, record):
    v_0 = 2.0
    model, body = on_the_ground(
        pl.Sphere(0.1), lift=0.1, velocity=(0, 0, -v_0), stiffness=1e6, damping=c_v / v_0
    )
    result = pl.simulate(model, duration=0.02, step=5e-5)
    # Weight acts during the blow of 3 ms: 0.015 of the speed, half of it each way.
    v = result.track(body.center).velocity[:, 2]
    e = v[np.argmax(result.contact_force(body)[1:, 2] == 0) + 1] / v_0
    assert record(f"damping for a restitution of {restitution}", e, restitution, 0.015, source="closed form")


@pytest.mark.parametrize(("height", "step"), [(0.125, 2e-3), (0.16, 1e-3)])
def test_an_elastic_ball_keeps_its_energy(height, step, record):
    model, body = on_the_ground(pl.Sphere(0.02), lift=height, damping=0.0)
    result = pl.simulate(model, duration=2.0, step=step)
    energy = result.energy.total / result.energy.kinetic.max()
    flies = result.contact_force(body)[:, 2] == 0
    # A step may leave out 3e-3 of what changes hands, which in a blow is twice the energy of the ball.
    change = np.abs(np.diff(energy[flies])).max()
    assert record(f"elastic ball let go at {height} m, steps of {step} s, energy", 1 + change, 1.0, 0.01)


def test_boxes_with_flush_sides_stand_as_those_beside_each_other():
    def stairs(aside):
        model = pl.Model(gravity=(0, 0, -GRAVITY))
        ground = model.add_obstacle(pl.HalfSpace())
        boxes = [
            model.add_rigid_body(
                density=500.0,
                shape=pl.Box((0.2, 0.2, 0.1)),
                position=(0.01 * k, aside * k, 0.051 + 0.101 * k),
            )
            for k in range(3)
        ]
        model.add_contacts([*boxes, ground], friction=pl.Coulomb(0.5))
        result = pl.simulate(model, duration=0.15, step=2e-3)
        return np.array([result.center_of_mass(box)[-1] for box in boxes])

    # Moved aside by a ten-thousandth of their width.
    away = stairs(2e-5) - stairs(0.0)
    assert np.abs(away - np.outer(range(3), (0, 2e-5, 0))).max() < 1e-5


def test_a_stack_of_blocks_rests(record):
    model = pl.Model(gravity=(0, 0, -GRAVITY))
    ground = model.add_obstacle(pl.HalfSpace())
    cube = pl.Box((0.2, 0.2, 0.2))
    blocks = [
        model.add_rigid_body(mass=1.0, shape=cube, position=(0.01 * k, 0, 0.1 + 0.2 * k)) for k in range(3)
    ]
    model.add_contacts([ground, *blocks], friction=pl.LuGre(0.5, 0.4), damping=200.0)
    result = pl.simulate(model, duration=1.0, step=1e-3)
    for k, block in enumerate(blocks):
        # It sinks in by at most a thousandth of half an edge for each block above it, and does not move
        # aside.
        np.testing.assert_allclose(
            result.track(block.center).position[-1], [0.01 * k, 0, 0.1 + 0.2 * k], atol=5e-4
        )
    held = [
        result.contact_force(block, below)[-1, 2]
        for block, below in zip(blocks, [ground, *blocks[:-1]], strict=True)
    ]
    for k, force in enumerate(held):
        # The hum after a second.
        assert record(f"stack of three, force under block {k}", force, (3 - k) * GRAVITY, 0.3, unit="N")


def test_crossed_planks_carry_each_other():
    model = pl.Model(gravity=(0, 0, -GRAVITY))
    low = model.add_obstacle(pl.Box((1.0, 0.1, 0.05)))
    plank = model.add_rigid_body(mass=1.0, shape=pl.Box((0.1, 1.0, 0.05)), position=(0, 0, 0.05))
    model.add_contact(plank, low, friction=pl.LuGre(0.5, 0.4), damping=100.0)
    result = pl.simulate(model, duration=0.5, step=1e-3)
    # Corners of neither are near the other.
    assert np.abs(result.track(plank.center).position[-1] - [0, 0, 0.05]).max() < 1e-3


def test_colliding_bodies_keep_momenta(record):
    model = pl.Model()
    one = model.add_rigid_body(
        mass=1.0, shape=pl.Capsule(0.05, 0.3), position=(0, 0.02, 0.16), velocity=(0.3, 0, -1.0)
    )
    two = model.add_rigid_body(
        mass=2.0, shape=pl.Box((0.3, 0.2, 0.1)), position=(0.05, 0, -0.2), angular_velocity=(0, 1.0, 0)
    )
    model.add_contact(one, two, friction=pl.LuGre(0.4, 0.3))
    result = pl.simulate(model, duration=0.4, step=5e-4)
    assert np.abs(result.contact_impulse(one)[-1]).max() > 0.1
    np.testing.assert_array_equal(result.contact_force(one, two), -result.contact_force(two))
    size = np.abs(result.momentum[0]).max()
    drift = np.abs(result.momentum - result.momentum[0]).max() / size
    assert record("capsule on box, drift of momentum", drift, 0.0, 1e-9)
    turned = np.abs(result.angular_momentum - result.angular_momentum[0]).max()
    # Forces act at one place on both bodies; the scheme keeps the rest to second order.
    assert record("capsule on box, drift of angular momentum", turned, 0.0, 1e-4, unit="kg m^2/s")


def sheet(model, *, n=4, size=0.12, thickness=8e-3, height=0.0, kind="shell", velocity=(0, 0, 0)):
    """A square about the origin whose lower side is at a height."""
    x = np.linspace(-size / 2, size / 2, n + 1)
    grid = np.stack([*np.meshgrid(x, x, indexing="ij"), np.full((n + 1, n + 1), height + thickness / 2)], -1)
    add = model.add_shell if kind == "shell" else model.add_membrane
    return add(pl.Mesh.grid(grid), thickness=thickness, material=RUBBER, velocity=velocity)


@pytest.mark.parametrize("kind", ["shell", "membrane"])
def test_a_sheet_rests_on_the_ground(kind, record):
    model = pl.Model(gravity=(0, 0, -GRAVITY))
    body = sheet(model, n=2, kind=kind)
    model.add_contact(body, model.add_obstacle(pl.HalfSpace()), friction=pl.LuGre(0.5, 0.4))
    result = pl.simulate(model, duration=0.3, step=2e-3)
    weight = 1070.0 * 8e-3 * 0.12**2 * GRAVITY
    force = result.contact_force(body)[-1]
    # Nothing damps a flat sheet on its contact but the scheme.
    assert record(
        f"{kind} at rest, ground force over weight", force[2] / weight, 1.0, 5e-3, source="equilibrium"
    )
    assert np.abs(force[:2]).max() < 1e-6 * weight


def test_a_sheet_slides_as_coulomb_says(record):
    a = np.radians(35.0)
    model = pl.Model(gravity=(GRAVITY * np.sin(a), 0, -GRAVITY * np.cos(a)))
    body = sheet(model, n=2)
    model.add_contact(body, model.add_obstacle(pl.HalfSpace()), friction=pl.LuGre(0.4, 0.4))
    result = pl.simulate(model, duration=0.3, step=2e-3)
    v = np.gradient(result.center_of_mass(body)[:, 0], result.time)
    acceleration = (v[-2] - v[75]) / (result.time[-2] - result.time[75])
    exact = GRAVITY * (np.sin(a) - 0.4 * np.cos(a))
    # Friction acts on the mid-surface: no couple tips the sheet; the hum of the normal force remains.
    assert record("sheet sliding on 35 degrees, acceleration", acceleration, exact, 0.02, unit="m/s^2")


@pytest.mark.parametrize(
    "shape", [pl.Sphere(0.05), pl.Box((0.08, 0.08, 0.1)), pl.Cylinder(0.04, 0.1), pl.Capsule(0.04, 0.02)]
)
def test_a_sheet_and_a_solid_exchange_momentum(shape, record):
    model = pl.Model()
    body = sheet(model, n=2, kind="shell", velocity=(0.1, 0, -0.5))
    solid = model.add_rigid_body(mass=0.05, shape=shape, position=(0.01, 0.005, -0.055))
    model.add_contact(body, solid, friction=pl.LuGre(0.4, 0.3))
    result = pl.simulate(model, duration=0.03, step=5e-4)
    assert np.abs(result.contact_impulse(body)[-1, 2]) > 1e-3
    drift = np.abs(result.momentum - result.momentum[0]).max() / np.abs(result.momentum[0]).max()
    assert record(f"sheet on {type(shape).__name__.lower()}, drift of momentum", drift, 0.0, 1e-7)


def test_a_cable_and_a_ball_exchange_momentum(record):
    model = pl.Model()
    soft = pl.LinearElastic(5e6, 0.4, 1200.0, retardation_time=1e-3)
    line = [(-0.3, 0, 0.058), (0.3, 0.01, 0.058)]
    rope = model.add_cable(
        line, elements=8, section=pl.Circle(5e-3), material=soft, velocity=(0.2, 0, -1.0), name="rope"
    )
    ball = model.add_rigid_body(mass=0.1, shape=pl.Sphere(0.05))
    model.add_contact(rope, ball, friction=pl.LuGre(0.4, 0.3))
    result = pl.simulate(model, duration=0.03, step=5e-4)
    assert result.contact_impulse(rope)[-1, 2] > 1e-3
    drift = np.abs(result.momentum - result.momentum[0]).max() / np.abs(result.momentum[0]).max()
    assert record("cable on a free ball, drift of momentum", drift, 0.0, 1e-7)


def terrain():
    """A roof with a ridge along y, 30 degrees steep."""
    z = np.tan(np.radians(30))
    points = [(-1, -1, -z), (0, -1, 0), (1, -1, -z), (-1, 1, -z), (0, 1, 0), (1, 1, -z)]
    return pl.TriangleMesh(points, [(0, 1, 4), (0, 4, 3), (1, 2, 5), (1, 5, 4)])


def test_a_ball_slides_down_a_mesh(record):
    model = pl.Model(gravity=(0, 0, -GRAVITY))
    roof = model.add_obstacle(terrain())
    start = np.array([0.2, 0, -0.2 * np.tan(np.radians(30))])
    normal = np.array([np.sin(np.radians(30)), 0, np.cos(np.radians(30))])
    ball = model.add_rigid_body(mass=1.0, shape=pl.Sphere(0.05), position=start + 0.05 * normal)
    model.add_contact(ball, roof)
    result = pl.simulate(model, duration=0.3, step=1e-3)
    v = result.track(ball.center).velocity[-1]
    along = v @ [np.cos(np.radians(30)), 0, -np.sin(np.radians(30))]
    # Without friction it slides; edges within the plane leave no mark.
    assert record("ball sliding down a mesh, speed", along, GRAVITY * 0.5 * 0.3, 1e-4, unit="m/s")


def test_cables_and_sheets_hang_over_a_mesh():
    model = pl.Model(gravity=(0, 0, -GRAVITY))
    roof = model.add_obstacle(terrain())
    soft = pl.LinearElastic(5e5, 0.4, 1200.0, retardation_time=5e-3)
    rope = model.add_cable(
        [(-0.2, 0.3, 0.02), (0.2, 0.3, 0.02)], elements=8, section=pl.Circle(1e-2), material=soft
    )
    cloth = sheet(model, n=4, height=0.005, thickness=4e-3)
    for body in (rope, cloth):
        model.add_contact(body, roof, friction=pl.LuGre(0.8, 0.7))
    result = pl.simulate(model, duration=0.25, step=1e-3)
    weights = [np.pi * 1e-4 * 1200 * 0.4 * GRAVITY, 1070 * 4e-3 * 0.12**2 * GRAVITY]
    for body, weight in zip((rope, cloth), weights, strict=True):
        # On their way down, most of the weight is carried by the ridge and the slopes.
        carried = result.contact_impulse(body, roof)[-1, 2] / (weight * 0.25)
        assert 0.5 < carried < 1.2
        # They bend over the ridge, and lie above the roof.
        r = result.positions(body)[-1]
        assert (r[:, 2] + np.tan(np.radians(30)) * np.abs(r[:, 0])).min() > 0.0


def test_a_mass_stops_on_a_box_and_a_fast_one_does_not_pass(record):
    model = pl.Model(gravity=(0, 0, -GRAVITY))
    mass = model.add_point_mass(0.5, at=(0, 0, 0.1), radius=0.02)
    table = model.add_obstacle(pl.Box((1, 1, 0.1)))
    model.add_contact(mass, table, damping=20.0)
    result = pl.simulate(model, duration=1.0, step=1e-3)
    force = result.contact_force(mass, table)[-1, 2]
    assert record(
        "mass on a box, force over weight", force / (0.5 * GRAVITY), 1.0, 0.02, source="equilibrium"
    )
    fast = pl.Model()
    wall = fast.add_obstacle(pl.Box((1, 1, 0.1)))
    bullet = fast.add_rigid_body(
        mass=1.0, shape=pl.Sphere(0.02), position=(0, 0, 0.08), velocity=(0, 0, -100.0)
    )
    fast.add_contact(bullet, wall, stiffness=1e7)
    # A tenth of a metre in each step: the first would end beyond the middle of the wall.
    result = pl.simulate(fast, duration=4e-3, step=1e-3)
    assert result.statistics.rejected > 0
    assert result.track(bullet.center).position[-1, 2] > 0.05


def test_a_run_with_probes_resumes_with_the_same_bits(tmp_path):
    def make():
        model = pl.Model(gravity=(0, 0, -GRAVITY))
        ground = model.add_obstacle(pl.HalfSpace())
        ball = model.add_rigid_body(
            mass=0.2, shape=pl.Sphere(0.05), position=(0, 0, 0.06), velocity=(0.3, 0, 0)
        )
        rod = model.add_rigid_body(
            mass=0.2,
            shape=pl.Capsule(0.02, 0.2),
            position=(0.3, 0, 0.03),
            orientation=Rotation.from_euler("y", 90, degrees=True),
            velocity=(-0.3, 0, 0),
        )
        cloth = sheet(model, n=2, height=0.14, velocity=(0, 0, -0.5))
        model.add_contacts([ground, ball, rod], friction=pl.LuGre(0.4, 0.3))
        for other in (ground, ball):
            model.add_contact(cloth, other, friction=pl.LuGre(0.4, 0.3))
        return pl.Stepper(model, step=1e-3)

    whole = make()
    whole.advance(80)
    parts = make()
    parts.advance(37)
    parts.save(tmp_path / "run")
    again = pl.Stepper.load(tmp_path / "run")
    again.advance(43)
    np.testing.assert_array_equal(again.coordinates, whole.coordinates)
    np.testing.assert_array_equal(again.velocities, whole.velocities)


def test_statics_lays_a_sheet_on_a_ball(record):
    model = pl.Model(gravity=(0, 0, -GRAVITY))
    cloth = sheet(model, n=4, height=-1e-4)
    ball = model.add_obstacle(pl.Sphere(0.1), position=(0, 0, -0.1))
    model.add_contact(cloth, ball)
    hook = model.pin(cloth.node(0))
    other = model.pin(cloth.node(4))
    result = pl.solve_static(model, load_steps=4)
    held = sum(result.reaction(pin).force[-1] for pin in (hook, other)) + result.contact_force(cloth)[-1]
    weight = 1070.0 * 8e-3 * 0.12**2 * GRAVITY
    # Equilibrium, up to the solver's tolerance.
    assert record("sheet on a ball between pins, forces over weight", held[2] / weight, 1.0, 1e-6)


def test_models_with_meshes_travel_in_files(tmp_path):
    model = pl.Model(gravity=(0, 0, -GRAVITY))
    ball = model.add_rigid_body(mass=1.0, shape=pl.Sphere(0.05), position=(0.3, 0, 0.1), name="ball")
    model.add_contact(ball, model.add_obstacle(terrain()), friction=pl.Coulomb(0.3))
    model.save(tmp_path / "model.json")
    again = pl.Model.load(tmp_path / "model.json")
    one, other = (pl.simulate(m, duration=0.1, step=1e-3) for m in (model, again))
    np.testing.assert_array_equal(one.positions("ball"), other.positions("ball"))
    one.save(tmp_path / "run.h5")
    loaded = pl.Result.load(tmp_path / "run.h5")
    np.testing.assert_array_equal(loaded.contact_force("ball"), one.contact_force(ball))
