"""Joints released and engaged: exact times, impacts, balances, order, and continuation with the same bits."""

import itertools

import numpy as np
import pliant as pl
import pytest
from scipy.integrate import solve_ivp

BAR = pl.Box((1.0, 0.1, 0.1))
G = 9.81


def two_bodies(**options):
    model = pl.Model(**options)
    one = model.add_rigid_body(
        density=500.0, shape=BAR, position=(0, 0.3, 0), velocity=(1, -0.4, 0.2), angular_velocity=(0.3, 2, -1)
    )
    other = model.add_rigid_body(
        density=900.0, shape=pl.Box((0.2, 0.3, 0.4)), position=(0.7, 0, 0.4), angular_velocity=(-1, 0.5, 3)
    )
    return model, one, other


@pytest.mark.parametrize("kind", ["weld", "pin", "hinge", "distance"])
def test_engaging_free_bodies_conserves_momentum_and_accounts_for_energy(kind, record):
    model, one, other = two_bodies()
    joint = {
        "weld": lambda: model.weld(one, other),
        "pin": lambda: model.pin(one.at((0.5, 0, 0)), other),
        "hinge": lambda: model.hinge(one.at((0.5, 0, 0)), other, axis=(0, 1, 0)),
        "distance": lambda: model.distance(one.center, other.at((0.1, 0, 0))),
    }[kind]().engage(at=0.0123)
    stepper = pl.Stepper(model, step=1e-3, record_every=1, threads=1)
    stepper.advance(12)
    before = stepper.momentum, stepper.angular_momentum
    kinetic = stepper.energy.kinetic
    stepper.advance()
    after = stepper.momentum, stepper.angular_momentum
    # The impulse of engaging is internal; the scheme itself keeps linear momentum to rounding and turns
    # angular momentum by its error of second order over the one step.
    assert record(f"{kind} engages, linear momentum", after[0], before[0], 1e-12)
    assert record(f"{kind} engages, angular momentum", after[1], before[1], 2e-7)
    assert stepper.energy.kinetic < 0.99 * kinetic
    stepper.advance(300)
    total = stepper.result.energy.total
    # Second order in the step, with spins of 4 rad/s.
    assert np.ptp(total) < 2e-5 * kinetic
    assert np.linalg.norm(stepper.reaction(joint).force) > 0


def test_the_impulse_itself_is_exact():
    model, one, other = two_bodies()
    joint = model.weld(one, other, engaged=False)
    stepper = pl.Stepper(model, step=1e-3, threads=1)
    before = stepper.momentum, stepper.angular_momentum, stepper.energy.total
    stepper.engage(joint)
    after = stepper.momentum, stepper.angular_momentum, stepper.energy.total
    # No time passes: rounding.
    for a, b in zip(after, before, strict=True):
        np.testing.assert_allclose(a, b, rtol=0, atol=1e-12 * max(1.0, float(np.abs(b).max())))
    # Two bodies that move as one: the velocity of a point of the seam is the same in both.
    seam = np.array([0.5, 0.3, 0.1])
    v = [
        stepper.velocity(body.at(seam - centre))
        for body, centre in ((one, (0, 0.3, 0)), (other, (0.7, 0, 0.4)))
    ]
    np.testing.assert_allclose(v[0], v[1], atol=1e-12)


def rope(model, start, end, elements):
    rubber = pl.LinearElastic(youngs_modulus=1e7, poisson_ratio=0.45, density=1000.0)
    return model.add_cable([start, end], elements=elements, section=pl.Circle(5e-3), material=rubber)


def pendulum(release):
    """A bar hinged at its end; let go, it flies on."""
    model = pl.Model(gravity=(0, 0, -G))
    bar = model.add_rigid_body(density=1000.0, shape=BAR, position=(0.5, 0, 0))
    pivot = model.hinge(bar.at((-0.5, 0, 0)), axis=(0, 1, 0)).release(at=release)
    return model, bar, pivot


def flight(release, end):
    """Centre of the bar at the end, from the pendulum's own equation: angle below the horizontal."""
    mass, inertia = 10.0, 10.0 * (1 + 0.01) / 12 + 10.0 * 0.25
    swing = solve_ivp(
        lambda _, y: (y[1], mass * G * 0.5 * np.cos(y[0]) / inertia),
        (0, release),
        (0.0, 0.0),
        rtol=1e-12,
        atol=1e-14,
    ).y[:, -1]
    angle, rate = swing
    place = 0.5 * np.array([np.cos(angle), 0, -np.sin(angle)])
    speed = 0.5 * rate * np.array([-np.sin(angle), 0, -np.cos(angle)])
    t = end - release
    return place + speed * t + 0.5 * t * t * np.array([0, 0, -G]), angle + rate * t


def test_release_is_of_second_order(record):
    release, end = np.sqrt(0.1), 0.7  # no step ends there by itself
    exact, _ = flight(release, end)
    errors = []
    for step in (4e-3, 2e-3, 1e-3):
        model, bar, pivot = pendulum(release)
        result = pl.simulate(model, duration=end, step=step, threads=1)
        errors.append(np.linalg.norm(result.track(bar.center).position[-1] - exact))
        free = result.time > release
        assert np.all(result.reaction(pivot).force[free] == 0)
        assert np.all(result.reaction(pivot).force[~free].any(axis=1))
    # The scheme's error on the swing before, of second order.
    assert errors[-1] < 1e-5
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert record("order across a release", orders, [2.0, 2.0], 0.25)


def caught(step, end=0.9, catch=1 / 3):
    """A bar falls, turning, and is caught at a point of it by the world; q, v and the reaction at the end."""
    model = pl.Model(gravity=(0, 0, -G))
    bar = model.add_rigid_body(
        density=1000.0, shape=BAR, velocity=(0.5, 0, 2.0), angular_velocity=(0, 1.0, 0)
    )
    pivot = model.hinge(bar.at((-0.5, 0, 0)), axis=(0, 1, 0)).engage(at=catch)
    result = pl.simulate(model, duration=end, step=step, threads=1)
    track = result.track(bar.center)
    return result, np.concatenate([track.position[-1], track.velocity[-1]]), result.reaction(pivot).force


def test_engaging_is_of_second_order(record):
    catch, end = 1 / 3, 0.9
    # Before: free flight. The impulse at the point keeps the angular momentum about it; then a pendulum.
    mass, own = 10.0, 10.0 * (1 + 0.01) / 12
    angle, rate = catch * 1.0, 1.0
    velocity = np.array([0.5, 2.0 - G * catch])
    centre = np.array([0.5 * catch, 2.0 * catch - 0.5 * G * catch**2])
    arm = 0.5 * np.array([np.cos(angle), -np.sin(angle)])  # turning about y takes x to -z
    pivot = centre - arm
    inertia = own + mass * 0.25
    # About y: (arm x p)_y = arm_z p_x - arm_x p_z.
    rate = (own * rate + mass * (arm[1] * velocity[0] - arm[0] * velocity[1])) / inertia

    def swing(_, y):
        return y[1], mass * G * 0.5 * np.cos(y[0]) / inertia

    last = solve_ivp(swing, (0, end - catch), (angle, rate), rtol=1e-12, atol=1e-14).y[:, -1]
    out = 0.5 * np.array([np.cos(last[0]), -np.sin(last[0])])
    exact_r = pivot + out
    exact_v = last[1] * np.array([out[1], -out[0]])
    alpha = mass * G * 0.5 * np.cos(last[0]) / inertia
    a = alpha * np.array([out[1], -out[0]]) - last[1] ** 2 * out
    force = mass * (a + np.array([0, G]))
    errors = []
    for step in (4e-3, 2e-3, 1e-3):
        result, state, forces = caught(step)
        got = np.concatenate([state[[0, 2]], state[[3, 5]], forces[-1][[0, 2]] / (mass * G)])
        errors.append(np.abs(got - np.concatenate([exact_r, exact_v, force / (mass * G)])).max())
        assert np.ptp(result.energy.total) < 40.0 * step**2 * mass * G
        assert np.all(forces[result.time < catch] == 0)
    assert errors[-1] < 2e-5
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert record("order across an engagement, with multipliers", orders, [2.0, 2.0], 0.25)


def test_steps_end_at_events_to_the_bit_and_the_grid_goes_on():
    def times(*events):
        model, _bar, pivot = pendulum(events[0])
        seen = []
        for at, doing in zip(events[1:], itertools.cycle((pivot.engage, pivot.release)), strict=False):
            doing(at=at)
        result = pl.simulate(model, duration=1.0, step=0.01, on_step=lambda s: seen.append(s.time), threads=1)
        return result, seen

    plain, _ = times(5.0)
    # Off the grid: the output times stay those of a run without events.
    result, _ = times(0.1234567, 0.1235, 0.77)
    np.testing.assert_array_equal(result.time, plain.time)
    # At a time of the grid up to rounding: the step ends at the event's time.
    near = float(np.nextafter(plain.time[30], 1.0))
    result, seen = times(near)
    assert near in result.time
    assert seen[30] == near
    np.testing.assert_allclose(result.time, plain.time, rtol=1e-15)
    # Certain output times are kept to the bit.
    model, *_ = pendulum(0.25 + 1e-12)
    result = pl.simulate(model, duration=1.0, step=0.01, output_times=[0.25, 0.5], threads=1)
    assert result.time.tolist() == [0.25, 0.5]


def chain():
    """A hanging cable whose ends are let go and caught in turn."""
    model = pl.Model(gravity=(0, 0, -G))
    strand = rope(model, (0, 0, 0), (1, 0, 0), 6)
    left = model.pin(strand.start)
    right = model.clamp(strand.end).release(at=0.0305).engage(at=0.0611)
    bob = model.add_rigid_body(density=1000.0, shape=pl.Sphere(0.05), position=(0.5, 0, -0.1))
    hook = model.pin(strand.at(0.5), bob).engage(at=0.045)
    return model, left, right, hook, bob


def test_continuing_has_the_same_bits(tmp_path):
    model, _left, right, hook, bob = chain()
    whole = pl.simulate(model, duration=0.1, step=2e-3, threads=1)
    # A checkpoint after each step; the last but some is continued.
    for kept in (10, 20, 30, 40):
        path = tmp_path / f"run{kept}"

        def stop(stepper, kept=kept, path=path):
            if stepper._steps == kept:
                stepper.save(path)

        pl.simulate(model, duration=0.1, step=2e-3, on_step=stop, threads=1)
        stepper = pl.Stepper.load(path)
        stepper.advance(50 - kept)
        np.testing.assert_array_equal(stepper.coordinates, whole._records.q[-1])
        assert stepper.energy.total == whole.energy.total[-1]
        np.testing.assert_array_equal(stepper.reaction(hook).force, whole.reaction(hook).force[-1])
        np.testing.assert_array_equal(stepper.reaction(right).moment, whole.reaction(right).moment[-1])
    stepper = pl.Stepper(model, step=2e-3, threads=1)
    stepper.advance(25)
    middle = stepper.state
    stepper.advance(25)
    end = stepper.coordinates
    for state in (middle, None):
        stepper.reset(state)
        stepper.advance(25 if state else 50)
        np.testing.assert_array_equal(stepper.coordinates, end)
    np.testing.assert_array_equal(stepper.position(bob.center), whole.track(bob.center).position[-1])


def test_results_read_joints_as_they_were_engaged(tmp_path):
    model, _left, right, hook, _bob = chain()
    result = pl.simulate(model, duration=0.1, step=2e-3, threads=1)
    result.save(tmp_path / "run.h5")
    for read in (result, pl.Result.load(tmp_path / "run.h5")):
        force, moment = read.reaction(right).force, read.reaction(right).moment
        free = (read.time > 0.0305) & (read.time < 0.0611)
        assert np.all(force[free] == 0)
        assert np.all(np.linalg.norm(force[~free], axis=1) > 0)
        assert np.all(read.reaction(hook).force[read.time < 0.045] == 0)
        np.testing.assert_array_equal(force, result.reaction(right).force)
        np.testing.assert_array_equal(moment, result.reaction(right).moment)
    total = result.energy.total
    # Caught at 0.3 m/s and less; the rest is the scheme's own, which damps what shakes faster than its step.
    assert result.energy.dissipated[-1] > 1e-4
    assert np.ptp(total) < 0.2 * result.energy.dissipated[-1]


def test_hinge_measures_from_where_it_engaged():
    model = pl.Model()
    bar = model.add_rigid_body(density=1000.0, shape=BAR, angular_velocity=(0, 0, 1.0))
    pivot = model.hinge(bar.center).engage(at=0.5).release(at=1.0).engage(at=1.5)
    result = pl.simulate(model, duration=2.0, step=0.01, threads=1)
    angle = result.joint(pivot).position
    # Turning on through all of it; the angle counts from where the joint took hold.
    assert angle[100] == pytest.approx(0.5, abs=1e-4)
    assert angle[-1] == pytest.approx(0.5, abs=1e-4)
    assert result.energy.dissipated[-1] == pytest.approx(0.0, abs=1e-9)


def test_controller_drops_and_catches():
    model = pl.Model(gravity=(0, 0, -G))
    load = model.add_rigid_body(mass=2.0, shape=pl.Sphere(0.1))
    grip = model.weld(load)
    heights = []

    def control(stepper):
        height = stepper.position(load.center)[2]
        heights.append(height)
        if stepper.time > 0.1 and height > -0.2:
            stepper.release(grip)
        if height <= -0.2:
            stepper.engage(grip)

    result = pl.simulate(model, duration=0.6, step=1e-3, on_step=control, threads=1)
    place = result.track(load.center).position[:, 2]
    # Caught at the first step below 0.2 m, at 2 m/s.
    assert -0.2 - 2.1e-3 < place[-1] < -0.2
    assert np.ptp(place[-100:]) < 1e-12
    # What falls 0.2 m loses its weight times that; the last step tells by how much more.
    assert result.energy.dissipated[-1] == pytest.approx(2.0 * G * -place[-1], rel=1e-3)
    np.testing.assert_allclose(result.reaction(grip).force[-1], (0, 0, 2 * G), atol=1e-6)


def test_points_that_are_apart_are_refused_with_the_gap():
    model, one, other = two_bodies()
    apart = model.pin(one.at((0.5, 0, 0)), other.at((0, 0, 0)), engaged=False)
    stepper = pl.Stepper(model, step=1e-3, threads=1)
    before = stepper.coordinates
    with pytest.raises(
        pl.ModelError, match=r"joint 'pin1': its points are 5.38\d+e-1 m apart where it engages"
    ):
        stepper.engage(apart)
    # Nothing has changed.
    np.testing.assert_array_equal(stepper.coordinates, before)
    stepper.advance(3)
    stepper.engage(apart, gap=0.6)
    gap = stepper.position(one.at((0.5, 0, 0))) - stepper.position(other.center)
    stepper.advance(200)
    later = stepper.position(one.at((0.5, 0, 0))) - stepper.position(other.center)
    # The gap is kept, and turns with the second body.
    assert np.linalg.norm(later) == pytest.approx(np.linalg.norm(gap), rel=1e-9)
    apart.engage(at=0.1)
    with pytest.raises(pl.ConvergenceError, match="m apart where it engages") as caught:
        pl.simulate(model, duration=1.0, step=0.01, threads=1)
    # What was computed before is kept.
    assert caught.value.result.time[-1] == pytest.approx(0.09)


def test_shared_pins_get_multipliers_of_their_own():
    model = pl.Model(gravity=(0, 0, -G))
    one = rope(model, (0, 0, 0), (1, 0, 0), 4)
    other = rope(model, (1, 0, 0), (2, 0, 0), 4)
    model.pin(one.start)
    model.pin(other.end)
    knot = model.pin(one.end, other.start)
    assert model.constraints == 6
    with pytest.raises(pl.ModelError, match="share coordinates"):
        pl.Stepper(model, step=1e-3).release(knot)
    knot.release(at=0.1)
    assert model.constraints == 9
    result = pl.simulate(model, duration=0.2, step=1e-3, threads=1)
    gap = np.linalg.norm(result.track(one.end).position - result.track(other.start).position, axis=1)
    assert gap[100] < 1e-9
    assert gap[-1] > 0.01


def test_latches_are_kept_in_files(tmp_path):
    model, *_ = chain()
    model.save(tmp_path / "model.json")
    loaded = pl.Model.load(tmp_path / "model.json")
    runs = [pl.simulate(m, duration=0.1, step=2e-3, threads=1) for m in (model, loaded, model.copy())]
    for run in runs[1:]:
        np.testing.assert_array_equal(run._records.q, runs[0]._records.q)
    model["pin1"].release(at=0.02)
    assert not np.array_equal(pl.simulate(model, duration=0.1, step=2e-3)._records.q, runs[0]._records.q)


@pytest.mark.parametrize("way", ["stiffness", "damping", "limits", "torque", "rate", "angle", "gear"])
def test_joints_are_held_while_something_acts_along_them(way):
    """A spring, drive or gear along a joint that is free would push against nothing."""

    def build():
        model = pl.Model()
        discs = [model.add_rigid_body(mass=1.0, shape=pl.Sphere(0.1), position=(x, 0, 0)) for x in (0, 1)]
        on_joint = {"stiffness": 2.0, "damping": 0.5, "limits": (-1.0, 1.0)}
        options = {way: on_joint[way]} if way in on_joint else {}
        axle, other = model.hinge(discs[0].center, **options), model.hinge(discs[1].center)
        if way == "gear":
            model.gear(axle, other, ratio=2.0)
        elif way not in on_joint:
            model.drive(axle, **{way: 0.0})
        return model, axle, other

    model, axle, other = build()
    stepper = pl.Stepper(model, step=0.01)
    for switch in (stepper.release, stepper.engage):
        with pytest.raises(pl.ModelError, match=r"joint = 'hinge1': what acts along it"):
            switch(axle)
    with pytest.raises(pl.ModelError, match=r"joint = 'hinge1': what acts along it"):
        axle.release(at=0.5)
    # Nothing has changed: the run goes on, and a joint without such things can go.
    stepper.advance(2)
    if way != "gear":
        stepper.release(other)
        stepper.advance(2)
    # What is added after the release was scheduled is found when the run begins.
    if way in ("torque", "rate"):
        model = pl.Model()
        axle = model.hinge(model.add_rigid_body(mass=1.0, shape=pl.Sphere(0.1)).center).release(at=0.5)
        model.drive(axle, **{way: 0.0})
        with pytest.raises(pl.ModelError, match="what acts along it"):
            pl.simulate(model, duration=1.0, step=0.1)


def test_motors_are_released_and_torques_refused():
    model = pl.Model()
    shaft = model.hinge(model.add_rigid_body(mass=1.0, shape=pl.Sphere(0.1)).center)
    motor = model.drive(shaft, angle=4.0 * pl.Ramp(1.0)).release(at=0.5)
    result = pl.simulate(model, duration=1.0, step=0.01)
    # Ramps are fastest in the middle, 15/8; the disc keeps that rate.
    np.testing.assert_allclose(result.joint(shaft).velocity[51:], 7.5, atol=1e-2)
    assert np.all(result.reaction(motor).moment[51:] == 0)
    push = model.drive(shaft, torque=1.0)
    with pytest.raises(pl.ModelError, match="value go to zero"):
        push.release(at=0.5)
    with pytest.raises(pl.ModelError, match="value go to zero"):
        pl.Stepper(model, step=0.01).release(push)
