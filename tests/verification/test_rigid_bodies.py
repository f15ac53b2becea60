"""Rigid bodies and joints against independent integrations and closed forms: orders, reactions, balances."""

import numpy as np
import pliant as pl
import pytest
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation
from verification.cables import line

# Heavy top: mass 15 kg at (0, 1, 0) m of the fixed point, inertia about the centre (0.234375, 0.46875,
# 0.234375) kg m^2, spin (0, 150, -4.61538) rad/s, gravity 9.81 m/s^2 along -z. Centre at 0.1 s and 0.25 s by
# an explicit Runge-Kutta method of order 8 on rotation matrix and angular velocity, tolerance 1e-13.
HEAVY_TOP = {
    0.1: (0.4212966589253569, 0.8945719743456237, -0.14916470056185438),
    0.25: (0.5488841430089402, 0.4069941523330493, -0.7301246178016743),
}


def heavy_top():
    spin, arm = np.array([0.0, 150.0, -4.61538]), np.array([0.0, 1.0, 0.0])
    model = pl.Model(gravity=(0, 0, -9.81))
    top = model.add_rigid_body(
        mass=15.0,
        inertia=(0.234375, 0.46875, 0.234375),
        position=arm,
        velocity=np.cross(spin, arm),
        angular_velocity=spin,
    )
    model.pin(top.at(-arm), (0, 0, 0))
    return model, top


@pytest.mark.parametrize("time", HEAVY_TOP)
def test_heavy_top(time, record):
    errors = []
    for step in (2e-4, 1e-4):
        model, top = heavy_top()
        result = pl.simulate(model, duration=time, step=step, spectral_radius=0.9, threads=1)
        place = result.track(top.center).position[-1]
        errors.append(np.linalg.norm(place - HEAVY_TOP[time]))
    # Second order; the spin turns 15 mrad a step, and the published error of the scheme at 0.1 s is 5.5e-6;
    # the errors of nutation and precession add up.
    tolerance = 6e-6 * (time / 0.1) ** 2
    assert record(f"heavy top, centre at {time:g} s", place, HEAVY_TOP[time], tolerance, "m")
    assert record(f"heavy top, order at {time:g} s", np.log2(errors[0] / errors[1]), 2.0, 0.1)
    # The axes stay orthonormal to Newton's tolerance.
    matrix = result.track(top.center).axes[-1]
    assert record("heavy top, axes orthonormal", matrix @ matrix.T, np.eye(3), 1e-9)


def test_torque_free_asymmetric_top(record):
    moments, spin = np.array([1.0, 2.0, 2.5]), np.array([0.3, 4.0, 0.2])

    def rate(_, y):
        matrix, omega = y[:9].reshape(3, 3), y[9:]
        hat = np.cross(np.eye(3), omega)  # rows e_k x omega: the matrix of omega x
        return np.concatenate([(matrix @ hat).ravel(), np.cross(moments * omega, omega) / moments])

    start = np.concatenate([np.eye(3).ravel(), spin])
    exact = solve_ivp(rate, (0, 3), start, method="DOP853", rtol=1e-12, atol=1e-12).y[:9, -1].reshape(3, 3)
    errors, drifts = [], []
    for step in (4e-3, 2e-3):
        model = pl.Model()
        body = model.add_rigid_body(mass=1.0, inertia=moments, angular_velocity=spin, velocity=(1, 2, 3))
        result = pl.simulate(model, duration=3.0, step=step, spectral_radius=0.9, threads=1)
        turned = result.track(body.center).orientation[-1].as_matrix()
        errors.append(np.abs(turned - exact).max())
        drifts.append(np.abs(result.angular_momentum - result.angular_momentum[0]).max())
        energy = result.energy.total
        drifts.append(np.abs(energy - energy[0]).max())
    assert record("asymmetric top, order", np.log2(errors[0] / errors[1]), 2.0, 0.1)
    assert record("asymmetric top, momentum", result.momentum[-1], (1, 2, 3), 1e-12, "kg m/s")
    # Second order at 4 rad/s and 2 ms: (8e-3)^2 of 9 kg m^2/s and of 17 J, with the constants of the scheme.
    assert record("asymmetric top, angular momentum's drift", drifts[2], 0.0, 2e-3, "kg m^2/s")
    assert record("asymmetric top, energy's drift", drifts[3], 0.0, 4e-3, "J")
    assert drifts[0] / drifts[2] > 3.5


def test_physical_pendulum_with_reactions(record):
    # Gravity leans out of the plane, so that the hinge carries a moment.
    gravity, mass, half = np.array([1.0, -9.81, 2.0]), 3.0, 0.5
    shape = pl.Box((1.0, 0.2, 0.1))
    inertia = mass * (shape.gyration[2] + half**2)

    def rate(_, y):
        arm = half * np.array([np.cos(y[0]), np.sin(y[0])])
        return y[1], mass * (arm[0] * gravity[1] - arm[1] * gravity[0]) / inertia

    exact = solve_ivp(rate, (0, 2), (0.0, 1.0), method="DOP853", rtol=1e-12, atol=1e-12).y[:, -1]
    angles = []
    for step in (4e-3, 2e-3, 1e-3):
        model = pl.Model(gravity=gravity)
        arm = model.add_rigid_body(
            mass=mass, shape=shape, position=(half, 0, 0), velocity=(0, half, 0), angular_velocity=(0, 0, 1)
        )
        pivot = model.hinge(arm.at((-half, 0, 0)))
        result = pl.simulate(model, duration=2.0, step=step, threads=1)
        angles.append(result.joint(pivot).position[-1])
    errors = np.abs(np.array(angles) - exact[0])
    assert record("physical pendulum, order", np.log2(errors[1] / errors[2]), 2.0, 0.1)
    # Second order: (3 rad/s * 1 ms)^2, growing over two seconds.
    assert record("physical pendulum, angle", angles[-1], exact[0], 2e-5, "rad")
    assert record("physical pendulum, rate", result.joint(pivot).velocity[-1], exact[1], 3e-4, "rad/s")
    angle, speed = exact
    out = np.array([np.cos(angle), np.sin(angle), 0.0])
    across = np.array([-out[1], out[0], 0.0])
    a = half * (rate(0, exact)[1] * across - speed**2 * out)
    reaction = result.reaction(pivot)
    assert record("physical pendulum, force", reaction.force[-1], mass * (a - gravity), 5e-3, "N")
    # The pivot holds the weight that leans out of the plane; about the axis it is free.
    moment = -np.cross(half * out, mass * gravity) * (1, 1, 0)
    assert record("physical pendulum, moment", reaction.moment[-1], moment, 1e-4, "N m")


def slider_crank(r, length, speed):
    """A crank along x that turns about z, a rod, and a slider along x; nothing redundant."""
    model = pl.Model()
    crank = model.add_rigid_body(
        mass=1.0,
        shape=pl.Box((r, 0.02, 0.02)),
        position=(r / 2, 0, 0),
        velocity=(0, speed * r / 2, 0),
        angular_velocity=(0, 0, speed),
    )
    turn = -speed * r / length
    rod = model.add_rigid_body(
        mass=2.0,
        shape=pl.Box((length, 0.02, 0.02)),
        position=(r + length / 2, 0, 0),
        velocity=(0, speed * r / 2, 0),
        angular_velocity=(0, 0, turn),
    )
    block = model.add_rigid_body(mass=3.0, shape=pl.Box((0.1, 0.1, 0.1)), position=(r + length, 0, 0))
    pivot = model.hinge(crank.at((-r / 2, 0, 0)))
    model.pin(rod.at((-length / 2, 0, 0)), crank.at((r / 2, 0, 0)))
    model.universal(rod, block.center, (0, 1, 0), (0, 0, 1))
    rail = model.slider(block, axis=(1, 0, 0))
    return model, crank, rod, block, pivot, rail


def test_slider_crank(record):
    r, length, speed = 0.3, 0.8, 6.0
    model, _, rod, block, pivot, rail = slider_crank(r, length, speed)
    assert (model.dof, model.constraints) == (36, 35)
    result = pl.simulate(model, duration=2.0, step=1e-3, threads=1)
    angle, rate = result.joint(pivot).position, result.joint(pivot).velocity
    assert angle[-1] > 2 * np.pi
    root = np.sqrt(length**2 - (r * np.sin(angle)) ** 2)
    way = r * np.cos(angle) + root - r - length
    # Constraints hold to Newton's tolerance in every step.
    assert record("slider-crank, way of the slider", result.joint(rail).position, way, 1e-8, "m")
    # No force does work: the kinetic energy and the crank's angle give its rate.
    dx = -r * np.sin(angle) - r**2 * np.sin(angle) * np.cos(angle) / root
    turn = -r * np.cos(angle) / root  # of the rod, by the crank's angle
    middle = np.stack([(-r * np.sin(angle) + dx) / 2, r * np.cos(angle) / 2])
    gyration = [pl.Box((x, 0.02, 0.02)).gyration[2] for x in (r, length)]
    inertia = (
        1.0 * (gyration[0] + (r / 2) ** 2)
        + 2.0 * (gyration[1] * turn**2 + (middle**2).sum(axis=0))
        + 3.0 * dx**2
    )
    exact = speed * np.sqrt(inertia[0] / inertia)
    # Second order: (6 rad/s * 1 ms)^2 of the rate, growing over two turns.
    assert record("slider-crank, rate of the crank", rate, exact, 2e-3, "rad/s")
    # Newton's law of the rod and the block: what the joints exert is what accelerates.
    joints = {joint.name: result.reaction(joint).force for joint in model.joints}
    a = result.track(rod.center).acceleration
    assert record("rod, Newton's law", joints["pin1"] + joints["universal1"], 2.0 * a, 1e-8, "N")
    a = result.track(block.center).acceleration
    assert record("block, Newton's law", joints["slider1"] - joints["universal1"], 3.0 * a, 1e-8, "N")


def test_double_pendulum_conserves_energy_and_reacts(record):
    drifts = []
    for step in (2e-3, 1e-3):
        model = pl.Model(gravity=(0, -9.81, 0))
        shape = pl.Capsule(0.05, 0.9)
        lie = Rotation.from_euler("y", 90, degrees=True)
        arms = [
            model.add_rigid_body(density=1000.0, shape=shape, position=(x, 0, 0), orientation=lie)
            for x in (0.5, 1.5)
        ]
        model.hinge(arms[0].at((0, 0, -0.5)))
        elbow = model.hinge(arms[1], arms[0].at((0, 0, 0.5)))
        result = pl.simulate(model, duration=1.0, step=step, threads=1)
        drifts.append(np.abs(result.energy.total - result.energy.total[0]).max())
    mass = 1000.0 * shape.volume
    assert record("double pendulum, order of the energy", np.log2(drifts[0] / drifts[1]), 2.0, 0.35)
    # Of 70 J that change hands.
    assert record("double pendulum, energy", drifts[1], 0.0, 5e-3, "J")
    force = result.reaction(elbow).force
    weight = mass * model.gravity
    a = [result.track(arm.center).acceleration for arm in arms]
    assert record("double pendulum, elbow", force + weight, mass * a[1], 1e-7, "N")
    shoulder = result.reaction(model.joints[0]).force
    assert record("double pendulum, shoulder", shoulder - force + weight, mass * a[0], 1e-7, "N")


def test_a_body_hanging_on_two_cables(record):
    model = pl.Model(gravity=(0, 0, -9.81))
    weight = 9.81 * 10.0
    beam = model.add_rigid_body(mass=10.0, inertia=(1, 1, 1), position=(0.3, 0, -1.1))
    pins = []
    for x in (0.0, 1.0):
        rope = model.add_cable(
            [(x, 0, 0), (x, 0, -1)], elements=4, rest="straight", **line(1e7, 1e-3, mass=1e-3)
        )
        model.pin(rope.start)
        pins.append(model.pin(beam.at((x - 0.3, 0, 0.1)), rope.end))
    result = pl.solve_static(model)
    forces = np.array([result.reaction(pin).force[-1] for pin in pins])
    # The ropes stretch by 1e-5 and the beam tilts by 4e-6: the lever rule to their square.
    assert record("body on two cables, lever rule", forces[:, 2], (0.7 * weight, 0.3 * weight), 1e-3, "N")
    assert record("body on two cables, sideways", forces[:, :2], np.zeros((2, 2)), 1e-3, "N")


def test_a_cable_welded_to_a_body_is_clamped(record):
    tips = []
    for welded in (False, True):
        model = pl.Model()
        arm = model.add_cable([(0, 0, 0), (1, 0, 0)], elements=8, **line(1e4, 1.0))
        model.add_force(arm.end, (0, 0, 2.0))
        if welded:
            base = model.add_rigid_body(mass=1.0, inertia=(1, 1, 1), position=(-0.2, 0.1, 0))
            wall = model.clamp(base.center)
            joint = model.weld(arm.start, base)
        else:
            joint = model.clamp(arm.start)
        result = pl.solve_static(model, load_steps=3)
        tips.append([*result.track(arm.end).position[-1], *result.reaction(joint).moment[-1]])
    # The same equations, solved to Newton's tolerance.
    assert record("weld to a held body against a clamp, tip and moment", tips[1], tips[0], 1e-7)
    held = result.reaction(wall)
    lever = result.track(arm.end).position[-1] - (-0.2, 0.1, 0)
    assert record("the wall's force", held.force[-1], (0, 0, -2.0), 1e-7, "N")
    assert record("the wall's moment", held.moment[-1], -np.cross(lever, (0, 0, 2.0)), 1e-6, "N m")


def test_conical_pendulum_on_a_distance(record):
    length, tilt = 2.0, 0.4
    speed = np.sqrt(9.81 / (length * np.cos(tilt)))
    radius, depth = length * np.sin(tilt), -length * np.cos(tilt)
    model = pl.Model(gravity=(0, 0, -9.81))
    bob = model.add_point_mass(1.5, at=(radius, 0, depth), velocity=(0, speed * radius, 0))
    rod = model.distance(bob, (0, 0, 0))
    result = pl.simulate(model, duration=2.0, step=1e-3, threads=1)
    circle = np.stack([np.cos(speed * result.time), np.sin(speed * result.time)], axis=1) * radius
    place = result.track(bob.center).position
    # Second order: 5 rad at (2.3e-3 rad)^2 a step.
    assert record("conical pendulum, place", place[:, :2], circle, 1e-5, "m")
    tension = np.linalg.norm(result.reaction(rod).force, axis=1)
    assert record("conical pendulum, tension", tension, 1.5 * 9.81 / np.cos(tilt), 1e-3, "N")


def test_a_ring_slides_and_spins_on_a_shaft(record):
    model = pl.Model(gravity=(2.0, 0, -9.81))
    ring = model.add_rigid_body(mass=2.0, shape=pl.Cylinder(0.1, 0.05), angular_velocity=(0, 0, 7.0))
    shaft = model.cylindrical(ring.center)
    result = pl.simulate(model, duration=1.0, step=1e-3, threads=1)
    track = result.track(ring.center)
    assert record("ring, fall", track.position[-1], (0, 0, -4.905), 1e-8, "m")
    turned = track.orientation[-1].as_rotvec()
    # 7 rad in 1000 steps, second order; a rotation vector is unique to whole turns.
    assert record("ring, spin", turned, (0, 0, 7.0 - 2 * np.pi), 1e-4, "rad")
    assert record("ring, force of the shaft", result.reaction(shaft).force[-1], (-4.0, 0, 0), 1e-8, "N")


def test_a_hinged_cable_turns_in_its_plane(record):
    # A stiff line hinged to the world about y falls like one that is pinned, but cannot leave the plane.
    model = pl.Model(gravity=(0, 0, -9.81))
    rod = model.add_cable([(0, 0, 0), (1, 0, 0)], elements=4, **line(1e4, 10.0))
    pivot = model.hinge(rod.start, axis=(0, 1, 0))
    result = pl.simulate(model, duration=0.2, step=1e-4, threads=1)
    assert model.constraints == 4
    # A stiff rod: angle'' = 3 g cos(angle) / (2 l); the line bends by 1e-2 of the fall.
    exact = solve_ivp(
        lambda _, y: (y[1], 1.5 * 9.81 * np.cos(y[0])), (0, 0.2), (0, 0), rtol=1e-10, atol=1e-10
    ).y[0, -1]
    tip = result.track(rod.end).position[-1]
    assert record("hinged line, angle of the chord", np.arctan2(-tip[2], tip[0]), exact, 1e-2, "rad")
    assert record("hinged line, angle of the joint", result.joint(pivot).position[-1], exact, 3e-2, "rad")


def test_moment_and_turning_force(record):
    model = pl.Model()
    body = model.add_rigid_body(mass=2.0, inertia=(1, 2, 2.5), angular_velocity=(0, 0, 3.0))
    model.add_force(body.center, (4.0, 0, 0), follower=True)
    result = pl.simulate(model, duration=1.0, step=1e-3, threads=1)
    exact = 2.0 / 3.0 * np.array([np.sin(3.0), 1 - np.cos(3.0), 0])
    # Second order: (3e-3 rad a step)^2.
    assert record("turning force, speed", result.track(body.center).velocity[-1], exact, 1e-5, "m/s")
    model = pl.Model()
    body = model.add_rigid_body(mass=2.0, inertia=(1, 2, 2.5), angular_velocity=(1, 2, 3.0))
    model.add_moment(body.center, (0.5, -1.0, 2.0))
    result = pl.simulate(model, duration=1.0, step=1e-3, threads=1)
    change = result.angular_momentum[-1] - result.angular_momentum[0]
    assert record("moment, angular momentum", change, (0.5, -1.0, 2.0), 1e-4, "kg m^2/s")
    total = result.energy.total
    assert record("moment, energy audit", total[-1], total[0], 1e-4, "J")


def test_a_run_continues_where_another_ended(record):
    model, top = heavy_top()
    whole = pl.simulate(model, duration=0.02, step=1e-4, threads=1)
    half = pl.simulate(model, duration=0.01, step=1e-4, threads=1)
    rest = pl.simulate(model, duration=0.01, step=1e-4, start=half, threads=1)
    places = [result.track(top.center).position[-1] for result in (rest, whole)]
    # The start is settled anew: second order.
    assert record("heavy top, continued", places[0], places[1], 1e-6, "m")


@pytest.mark.parametrize(
    ("shape", "volume", "moments"),
    [
        (pl.Sphere(1.0), 4 * np.pi / 3, (0.4, 0.4, 0.4)),
        (pl.Box((1, 2, 3)), 6.0, (13 / 12, 10 / 12, 5 / 12)),
        (pl.Cylinder(1.0, 2.0), 2 * np.pi, (7 / 12, 7 / 12, 0.5)),
    ],
)
def test_shapes(shape, volume, moments, record):
    assert record(f"volume, {shape}", shape.volume, volume, 1e-12, "m^3")
    assert record(f"moments, {shape}", shape.gyration, moments, 1e-12, "m^2")


def test_capsule_by_summing_slices(record):
    shape = pl.Capsule(0.7, 1.3)
    z, w = np.polynomial.legendre.leggauss(200)

    def slices(low, high, radius):
        x, dx = (low + high) / 2 + (high - low) / 2 * z, (high - low) / 2 * w
        area = np.pi * radius(x) ** 2
        parts = (area, area * (radius(x) ** 2 / 4 + x**2), area * radius(x) ** 2 / 2)
        return np.array([(part * dx).sum() for part in parts])

    half = 1.3 / 2
    total = slices(-half, half, lambda x: np.full_like(x, 0.7))
    total += 2 * slices(half, half + 0.7, lambda x: np.sqrt(0.7**2 - (x - half) ** 2))
    assert record("capsule, volume", shape.volume, total[0], 1e-12, "m^3")
    moments = np.array([total[1], total[1], total[2]]) / total[0]
    assert record("capsule, moments", shape.gyration, moments, 1e-12, "m^2")
