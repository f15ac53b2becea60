"""Springs, drives, stops and gears against closed forms and independent integrations."""

import numpy as np
import pliant as pl
import pytest
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation


def slope(errors):
    """Order of convergence of errors at steps h, h/2, ..."""
    return np.log2(np.array(errors[:-1]) / np.array(errors[1:]))


def disc(model, inertia=0.4, **options):
    return model.add_rigid_body(mass=2.0, inertia=(0.3, 0.3, inertia), **options)


def test_damped_oscillator(record):
    m, k, c = 2.0, 50.0, 1.5
    model = pl.Model(gravity=(0, 0, -9.81))
    ball = model.add_point_mass(m, at=(0, 0, -1.0))
    spring = model.add_spring(ball, (0, 0, 0), stiffness=k, damping=c)
    decay, omega = c / (2 * m), np.sqrt(k / m - (c / (2 * m)) ** 2)
    sag = m * 9.81 / k

    def exact(t):
        return 1 + sag - np.exp(-decay * t) * sag * (np.cos(omega * t) + decay / omega * np.sin(omega * t))

    errors = []
    for h in (4e-3, 2e-3, 1e-3):
        result = pl.simulate(model, duration=2.0, step=h, spectral_radius=0.9)
        errors.append(np.abs(result.spring(spring).length - exact(result.time)).max())
    assert record("damped oscillator, order", slope(errors).min(), 2.0, 0.05, source="closed form")
    # 2000 steps, second order: (omega h)^2 of the amplitude.
    assert errors[-1] < 1e-4
    assert np.ptp(result.energy.total) < 1e-4
    assert result.energy.dissipated[-1] > 2.0
    force = result.spring(spring).force
    z = result.track(ball.center).acceleration[:, 2]
    np.testing.assert_allclose(force, m * (z + 9.81), atol=1e-9)


def test_a_spring_of_no_length_is_isotropic():
    model = pl.Model()
    ball = model.add_point_mass(2.0, at=(0, 0, 0), velocity=(1.0, 2.0, 0.0))
    model.add_spring(ball, (0, 0, 0), stiffness=200.0, length=0.0)
    result = pl.simulate(model, duration=np.pi / 10, step=np.pi / 1e4)
    # Half a period of omega = 10: back at the centre, velocity reversed; (omega h)^2/10 of the amplitude.
    np.testing.assert_allclose(result.track(ball.center).position[-1], 0, atol=1e-6)
    np.testing.assert_allclose(result.track(ball.center).velocity[-1], (-1, -2, 0), atol=1e-5)
    assert np.ptp(result.energy.total) < 1e-5


def test_torsion_spring_counts_turns(tmp_path):
    k, inertia = 0.05, 0.4
    model = pl.Model()
    wheel = disc(model, inertia, angular_velocity=(0, 0, 8.0))
    shaft = model.hinge(wheel.center, stiffness=k, damping=0.01, rest=0.5)
    decay = 0.01 / (2 * inertia)
    omega = np.sqrt(k / inertia - decay**2)

    def exact(t):
        envelope = np.exp(-decay * t)
        return 0.5 + envelope * (-0.5 * np.cos(omega * t) + (8.0 - 0.5 * decay) / omega * np.sin(omega * t))

    # Outputs a turn and more apart: the turns are counted in the run, not afterwards.
    # (omega h)^2/12 of 22 rad at 8 rad/s.
    result = pl.simulate(model, duration=8.0, step=1e-3, output_every=2000)
    motion = result.joint(shaft)
    assert motion.position.max() > 3 * 2 * np.pi
    np.testing.assert_allclose(motion.position, exact(result.time), atol=2e-3)
    np.testing.assert_allclose(
        motion.force, -k * (motion.position - 0.5) - 0.01 * motion.velocity, atol=1e-10
    )
    np.testing.assert_allclose(result.reaction(shaft).moment[:, 2], motion.force, atol=1e-10)
    # A checkpoint keeps the turns, too: the same bits.
    first = pl.Stepper(model, step=5e-3)
    first.advance(800)
    first.save(tmp_path / "wheel.ckpt")
    second = pl.Stepper.load(tmp_path / "wheel.ckpt")
    first.advance(200)
    second.advance(200)
    assert np.array_equal(first.coordinates, second.coordinates)
    assert first.joint(shaft).position == second.joint(shaft).position
    assert first.joint(shaft).position > 4 * np.pi


def test_torsion_spring_in_statics_turns_more_than_once():
    model = pl.Model()
    wheel = disc(model)
    shaft = model.hinge(wheel.center, stiffness=0.5)
    model.drive(shaft, torque=5.0)
    result = pl.solve_static(model, load_steps=5)
    assert result.joint(shaft).position[-1] == pytest.approx(10.0, abs=1e-9)


def test_stops_hold_and_take_energy():
    model = pl.Model(gravity=(0, -9.81, 0))
    arm = model.add_rigid_body(mass=1.0, shape=pl.Box((1.0, 0.1, 0.1)), position=(0.5, 0, 0))
    pivot = model.hinge(arm.at((-0.5, 0, 0)), limits=(-0.8, 0.5), damping=0.05)
    result = pl.simulate(model, duration=6.0, step=5e-4)
    motion = result.joint(pivot)
    # The stop gives way by about a hundredth of the range, 1.3 rad.
    assert -0.8 - 0.02 < motion.position.min() < -0.8
    # It pushes back only and holds the weight in the end.
    assert (motion.force + 0.05 * motion.velocity).min() >= -1e-12
    assert abs(motion.velocity[-2000:]).max() < 0.2
    # What is left bounces by less than a milliradian, and bears the weight on average.
    weight = 9.81 * 0.5 * np.cos(0.8)
    assert motion.force[-2000:].mean() == pytest.approx(weight, rel=0.03)
    energy = result.energy
    assert np.all(np.diff(energy.dissipated) >= -1e-12)
    # Of the 3.4 J that fall: a dozen contacts of 15 steps each.
    assert np.ptp(energy.total) < 0.05


@pytest.mark.parametrize("value", ["callable", "ramp"])
def test_driven_point_needs_the_inverse_dynamics(record, value):
    """A mass on a path: its acceleration tells the force of the drive; order 2 for q, v and lambda."""
    m = 1.5

    def path(t):
        return np.array([0.2 * np.sin(3 * t), 0.1 * t**3, 0.3 * np.cos(2 * t)])

    def acceleration(t):
        return np.stack([-1.8 * np.sin(3 * t), 0.6 * t, -1.2 * np.cos(2 * t)], axis=-1)

    if value == "ramp":
        given = np.array([0, 0, 0.3]) + np.array([1.0, 2.0, 0.0]) * pl.Ramp(1.0)

        def acceleration(t):
            bend = 60 * t - 180 * t**2 + 120 * t**3
            return bend[:, None] * np.array([1.0, 2.0, 0.0])

    else:
        given = path
    errors = []
    for h in (2e-2, 1e-2, 5e-3):
        model = pl.Model(gravity=(0, 0, -9.81))
        ball = model.add_point_mass(m, at=(0, 0, 0.3), velocity=(0.0 if value == "ramp" else 0.6, 0, 0))
        spring = model.add_spring(ball, (0, 0, 0), stiffness=20.0)
        drive = model.drive(ball.center, position=given)
        result = pl.simulate(model, duration=1.0, step=h)
        r = result.track(ball.center).position
        pull = result.spring(spring).force[:, None] * r / np.linalg.norm(r, axis=1)[:, None]
        exact = m * (acceleration(result.time) + np.array([0, 0, 9.81])) + pull
        errors.append(np.abs(result.reaction(drive).force - exact).max())
    assert record(
        f"force of a driven mass ({value}), order", slope(errors)[-1], 2.0, 0.25, source="inverse dynamics"
    )
    # Of 17 N: 200 steps, h^2 times fourth derivatives of 360 m/s^4.
    assert errors[-1] < 1e-2
    # Work of the drive closes the balance.
    assert np.ptp(result.energy.total) < 2e-3
    assert np.ptp(result.energy.work) > 1.0


def test_hinge_driven_by_angle_rate_and_torque_agree():
    inertia, runs = 0.4, {}
    ramp = pl.Ramp(2.0)
    for key, value in {
        "angle": 10.0 * ramp,
        "rate": lambda t: 10.0 * 30 * (t / 2) ** 2 * (1 - t / 2) ** 2 / 2,
        "torque": lambda t: inertia * 10.0 * 60 * (t / 2) * (1 - t / 2) * (1 - t) / 4,
    }.items():
        model = pl.Model()
        wheel = disc(model, inertia)
        shaft = model.hinge(wheel.center)
        drive = model.drive(shaft, **{key: value})
        result = pl.simulate(model, duration=2.0, step=2e-3)
        motion = result.joint(shaft)
        np.testing.assert_allclose(result.reaction(drive).moment[:, 2], motion.force, atol=1e-9)
        # Of 18 J at (omega h)^2/12, omega up to 9.4/s.
        assert np.ptp(result.energy.total) < 5e-3
        runs[key] = motion
    # The turn and a half is counted; the motor's torque is that of the inverse dynamics. Errors of h^2 y'''.
    for motion in runs.values():
        assert motion.position[-1] == pytest.approx(10.0, abs=1e-3)
        np.testing.assert_allclose(motion.force, runs["torque"].force, atol=2e-3)


def test_an_input_sets_a_rate():
    model = pl.Model()
    shaft = model.hinge(disc(model, angular_velocity=(0, 0, 2.0)).center)
    model.drive(shaft, rate=pl.Input("speed", 2.0))
    stepper = pl.Stepper(model, step=0.01)
    stepper.advance(50)
    assert stepper.joint(shaft).position == pytest.approx(1.0, abs=1e-12)
    stepper.set_input("speed", 4.0)
    stepper.advance(50)
    # Over one step the rate goes from 2 to 4.
    assert stepper.joint(shaft).position == pytest.approx(1.0 + 49 * 0.04 + 0.03, abs=1e-10)


def test_slider_force_and_position():
    model = pl.Model(gravity=(0, 0, -9.81))
    lift = model.add_rigid_body(mass=2.0, inertia=(1, 1, 1))
    rail = model.slider(lift, axis=(0, 0, 1))
    model.drive(rail, position=lambda t: 0.5 * t**2)
    result = pl.simulate(model, duration=1.0, step=1e-2)
    np.testing.assert_allclose(result.joint(rail).position, 0.5 * result.time**2, atol=1e-12)
    np.testing.assert_allclose(result.joint(rail).force, 2.0 * 10.81, atol=1e-6)
    free = pl.Model(gravity=(0, 0, -9.81))
    lift = free.add_rigid_body(mass=2.0, inertia=(1, 1, 1))
    rail = free.slider(lift, axis=(0, 0, 1), stiffness=100.0, rest=-0.3)
    free.drive(rail, force=2.0 * 9.81)
    result = pl.simulate(free, duration=0.5, step=1e-3)
    omega = np.sqrt(50.0)
    np.testing.assert_allclose(
        result.joint(rail).position, -0.3 * (1 - np.cos(omega * result.time)), atol=1e-5
    )


def test_body_driven_in_all_six_freedoms(record):
    model = pl.Model(gravity=(0, 0, -9.81))
    body = model.add_rigid_body(mass=2.0, inertia=(0.1, 0.2, 0.25), angular_velocity=(0.6, 1.0, 0.3))
    turn = np.array([0.6, 1.0, 0.3])
    drive = model.drive(
        body,
        position=lambda t: (0.0, 0.2 * t**2, 0.0),
        orientation=lambda t: Rotation.from_rotvec(turn * t),
    )
    assert model.constraints == 12
    result = pl.simulate(model, duration=1.0, step=5e-3)
    # A steady turn about a fixed axis: moment omega x (I omega) about the centre, turning with the body.
    body_moment = np.cross(turn, np.diag([0.1, 0.2, 0.25]) @ turn)
    expected = Rotation.from_rotvec(turn[None] * result.time[:, None]).apply(body_moment)
    reaction = result.reaction(drive)
    np.testing.assert_allclose(reaction.force, np.tile([0, 0.8, 19.62], (len(result.time), 1)), atol=1e-5)
    worst = np.abs(reaction.moment - expected).max()
    assert record("moment of a driven body", worst, 0.0, 1e-4, unit="N m", source="Euler's equations")


def test_rotation_driven_beside_a_hinge():
    model = pl.Model(gravity=(0, -9.81, 0))
    arm = model.add_rigid_body(mass=1.0, shape=pl.Box((1.0, 0.1, 0.1)), position=(0.5, 0, 0))
    pivot = model.hinge(arm.at((-0.5, 0, 0)))
    drive = model.drive(arm, axis=(0, 0, 1), rate=lambda t: 3 * t**2)
    result = pl.simulate(model, duration=2.5, step=5e-3)
    angle = result.joint(pivot).position
    # Two and a half turns.
    np.testing.assert_allclose(angle, result.time**3, atol=1e-9)
    inertia = 1.0 * (1.0 + 0.01) / 12 + 0.25
    moment = inertia * 6 * result.time + 9.81 * 0.5 * np.cos(angle)
    # Errors of (omega h)^2 with omega up to 19/s.
    np.testing.assert_allclose(result.reaction(drive).moment[:, 2], moment, atol=0.1)


def test_direction_of_a_cable_end_turns_twice():
    model = pl.Model()
    rubber = pl.LinearElastic(youngs_modulus=1e6, poisson_ratio=0.4, density=1000.0, retardation_time=1e-2)
    strip = model.add_cable(
        [(0, 0, 0), (0.2, 0, 0)], elements=4, section=pl.Circle(radius=5e-3), material=rubber
    )

    def direction(t):
        angle = 4 * np.pi * t**2
        return np.array([np.cos(angle), 0.8 * np.sin(angle), 0.6 * np.sin(angle)])

    model.drive(strip.start, position=(0, 0, 0), direction=direction)
    result = pl.simulate(model, duration=1.0, step=2e-3)
    first = result.positions(strip)[:, 1] - result.positions(strip)[:, 0]
    # The strip lags behind, but it has turned twice and points along x again.
    turned = np.unwrap(np.arctan2(first @ [0, 0.8, 0.6], first[:, 0]))
    assert turned[-1] == pytest.approx(4 * np.pi, abs=0.8)
    assert np.abs(result.positions(strip) @ [0, 0.6, -0.8]).max() < 1e-6
    # Of 0.2 J in play.
    assert np.ptp(result.energy.total) < 1e-3


def test_gear_and_rack():
    """A wheel under a torque drives another and a rack: one freedom with the sum of the inertias."""
    model = pl.Model()
    wheels = [disc(model, inertia, position=(k, 0, 0)) for k, inertia in enumerate((0.4, 0.5))]
    rack = model.add_rigid_body(mass=3.0, inertia=(1, 1, 1), position=(0, 2, 0))
    one, two = (model.hinge(wheel.center) for wheel in wheels)
    rail = model.slider(rack, axis=(1, 0, 0))
    model.gear(two, one, ratio=-0.5)
    model.gear(one, rail, ratio=4.0)
    model.drive(one, torque=2.0)
    result = pl.simulate(model, duration=3.0, step=5e-3)
    inertia = 0.4 + 0.5 * 0.25 + 3.0 / 16
    angle = 0.5 * 2.0 / inertia * result.time**2
    # Two turns, at (omega h)^2/12 of relative error; the gears themselves are exact.
    turned = result.joint(one).position
    np.testing.assert_allclose(turned, angle, rtol=1e-3)
    np.testing.assert_allclose(result.joint(two).position, -0.5 * turned, atol=1e-9)
    np.testing.assert_allclose(result.joint(rail).position, 0.25 * turned, atol=1e-9)
    assert angle[-1] > 4 * np.pi
    np.testing.assert_allclose(result.joint(two).force, 0.5 * -0.5 * 2.0 / inertia, rtol=2e-3)
    # Of 25 J.
    assert np.ptp(result.energy.total) < 2e-2


def test_velocities_against_a_drive_are_projected_with_a_warning():
    model = pl.Model()
    shaft = model.hinge(disc(model).center)
    model.drive(shaft, rate=2.0)
    with pytest.warns(UserWarning, match=r"contradict joints or drives.*2 rad/s"):
        result = pl.simulate(model, duration=0.1, step=1e-2)
    # The velocity differs from the rate of the position by (omega h)^2.
    np.testing.assert_allclose(result.joint(shaft).velocity, 2.0, atol=4e-4)


def test_statics_see_drives_at_the_load_factor():
    model = pl.Model()
    rubber = pl.LinearElastic(youngs_modulus=1e7, poisson_ratio=0.45, density=1000.0)
    rope = model.add_cable(
        [(0, 0, 0), (1, 0, 0)], elements=4, section=pl.Circle(radius=5e-3), material=rubber, strain="biot"
    )
    model.clamp(rope.start)
    drive = model.drive(rope.end, position=lambda s: (1.0 + 0.01 * s, 0, 0))
    result = pl.solve_static(model, load_steps=4)
    stiffness = 1e7 * np.pi * 25e-6
    np.testing.assert_allclose(result.reaction(drive).force[:, 0], 0.01 * stiffness * result.time, atol=1e-6)


def test_flyball_governor(record):
    """A shaft under a torque, two arms on hinges, a spring between their ends.

    With the angles a of the arms and p of the shaft, J = J_0 + 2 (m l^2 sin^2 a + I), d = 2 l sin a and the
    pull S = k (d - d_0) + c d' of the spring: (J p')' = M,
    2 (m l^2 + I) a'' = m l^2 p'^2 sin 2a - 2 m g l sin a - 2 S l cos a.
    """
    m, length, g, k, torque, small, shaft_inertia = 1.2, 0.5, 9.81, 60.0, 0.8, 0.02, 0.3
    start = 0.5
    rest = 2 * length * np.sin(start)
    model = pl.Model(gravity=(0, 0, -g))
    shaft = model.add_rigid_body(mass=2.0, inertia=(1, 1, shaft_inertia), angular_velocity=(0, 0, 2.0))
    spin = model.hinge(shaft.center, axis=(0, 0, 1))
    balls, hinges = [], []
    for side in (1, -1):
        place = side * length * np.array([np.sin(start), 0, 0]) - np.array([0, 0, length * np.cos(start)])
        ball = model.add_rigid_body(
            mass=m,
            inertia=(small, small, small),
            position=place,
            velocity=np.cross((0, 0, 2.0), place),
            angular_velocity=(0, 0, 2.0),
        )
        balls.append(ball)
        hinges.append(model.hinge(ball.at(-place), shaft, axis=(0, -side, 0)))
    spring = model.add_spring(balls[0], balls[1], stiffness=k, damping=2.0)
    model.drive(spin, torque=torque)

    def rates(t, y):
        a, a1, _, p1 = y
        inertia = shaft_inertia + 2 * (m * (length * np.sin(a)) ** 2 + small)
        p2 = (torque - 2 * m * length**2 * np.sin(2 * a) * a1 * p1) / inertia
        d, d1 = 2 * length * np.sin(a), 2 * length * np.cos(a) * a1
        pull = k * (d - rest) + 2.0 * d1
        moment = m * length**2 * p1**2 * np.sin(2 * a) - 2 * m * g * length * np.sin(a)
        moment -= pull * 2 * length * np.cos(a)
        return [a1, moment / (2 * (m * length**2 + small)), p1, p2]

    times = np.linspace(0, 2, 11)
    exact = solve_ivp(rates, (0, 2), [start, 0, 0, 2.0], t_eval=times, rtol=1e-11, atol=1e-12).y
    errors = []
    for h in (4e-3, 2e-3):
        result = pl.simulate(model, duration=2.0, step=h, output_every=round(0.2 / h))
        sine = result.spring(spring).length / (2 * length)
        errors.append(
            max(np.abs(sine - np.sin(exact[0])).max(), np.abs(result.joint(spin).position - exact[2]).max())
        )
    assert record("flyball governor, order", slope(errors)[0], 2.0, 0.1, source="minimal coordinates, DOP853")
    # 1000 steps over some three periods.
    assert errors[-1] < 2e-3
    # The arms open alike, about axes that mirror each other.
    one, two = (result.joint(h).position for h in hinges)
    np.testing.assert_allclose(one, two, atol=1e-9)
    assert np.ptp(result.energy.total) < 2e-3
