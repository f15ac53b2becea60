"""Redundant constraints: found, named, solved through; contradictory ones refused."""

import time

import numpy as np
import pliant as pl
import pytest
from scipy.integrate import solve_ivp
from scipy.interpolate import make_interp_spline
from scipy.optimize import least_squares
from scipy.spatial.transform import Rotation

G = 9.81


def door(hinges=2, **options):
    model = pl.Model(gravity=(0, 0, -G))
    leaf = model.add_rigid_body(
        density=500.0,
        shape=pl.Box((0.8, 0.04, 2.0)),
        position=(0.4, 0, 0),
        velocity=(0, 0.4, 0),
        angular_velocity=(0, 0, 1.0),
    )
    heights = {1: (0.0,), 2: (0.8, -0.8), 3: (0.8, 0.0, -0.8)}[hinges]
    return model, leaf, [model.hinge(leaf.at((-0.4, 0, z)), **options) for z in heights]


@pytest.mark.parametrize("hinges", [2, 3])
def test_a_door_on_several_hinges_moves_as_on_one(hinges, record):
    results = []
    for count in (1, hinges):
        model, leaf, joints = door(count)
        result = pl.simulate(model, duration=1.0, step=1e-2, threads=1)
        about = [result.reaction(j) for j in joints]
        force = sum(r.force for r in about)
        # About the origin: the hinges stand on the axis.
        place = [result.track(leaf.at((-0.4, 0, z))).position for z in (0.8, 0.0, -0.8)]
        place = {1: place[1:2], 2: place[::2], 3: place}[count]
        moment = sum(r.moment + np.cross(p, r.force) for r, p in zip(about, place, strict=True))
        results.append((result.track(leaf.center).position, force, moment, about))
        assert model.constraints == 6 + 5 * count
        assert len(model.redundant) == count - 1
        assert all(r.equations == 5 for r in model.redundant)
    one, several = results
    # The same equations, solved in another order: rounding, amplified by the stiffest division by h^2.
    assert record(f"door on {hinges} hinges, motion", several[0][-1], one[0][-1], 1e-10, "m")
    assert record(f"door on {hinges} hinges, sum of forces", several[1][-1], one[1][-1], 1e-6, "N")
    assert record(f"door on {hinges} hinges, sum of moments", several[2][-1], one[2][-1], 1e-6, "N m")
    # The smallest multipliers share the weight evenly.
    for reaction in several[3]:
        np.testing.assert_allclose(reaction.force[-1, 2], 32.0 * G / hinges, rtol=1e-9)


def test_multipliers_are_the_smallest():
    model, _, joints = door(2)
    result = pl.simulate(model, duration=0.1, step=1e-2, threads=1)
    before = np.concatenate([result.reaction(j).force[-1] for j in joints])
    # What pulls the two hinges apart changes nothing else: the smallest multipliers have none of it.
    assert before[2] == pytest.approx(before[5], rel=1e-9)
    lambda_ = result._records.lambda_[-1]
    from pliant import _core
    from pliant._lower import lower

    lowered = lower(model)
    system = _core.System(lowered.spec, lowered.arrays)
    first, count = system.joint_offsets()[0]
    assert (first, count) == (0, 5)
    np.testing.assert_allclose(lambda_[2], lambda_[7], rtol=1e-9)


def four_bars(n):
    """n windows of a ladder of rods 1 m long, 1 kg each, standing; the upper ends move at 1 m/s (IFToMM)."""
    model = pl.Model(gravity=(0, -G, 0))
    thin = 1e-4
    posts, feet = [], []
    for i in range(n + 1):
        post = model.add_rigid_body(
            mass=1.0,
            inertia=(1 / 12, thin, 1 / 12),
            position=(i, 0.5, 0),
            velocity=(0.5, 0, 0),
            angular_velocity=(0, 0, -1.0),
        )
        posts.append(post)
        feet.append(model.hinge(post.at((0, -0.5, 0)), name=f"foot{i}"))
    for i in range(n):
        bar = model.add_rigid_body(
            mass=1.0, inertia=(thin, 1 / 12, 1 / 12), position=(i + 0.5, 1, 0), velocity=(1.0, 0, 0)
        )
        model.hinge(bar.at((-0.5, 0, 0)), posts[i].at((0, 0.5, 0)), name=f"left{i}")
        model.hinge(bar.at((0.5, 0, 0)), posts[i + 1].at((0, 0.5, 0)), name=f"right{i}")
    return model, posts, feet


@pytest.mark.parametrize("n", [1, 3])
def test_n_four_bars_through_their_singular_positions(n, record):
    # All posts turn alike: one equation for their angle from the vertical.
    inertia, arm = (n + 1) / 3 + n, 0.5 * (n + 1) + n
    end = 1.6  # twice through the singular positions, all rods in one line
    exact = solve_ivp(
        lambda _, y: (y[1], G * arm * np.sin(y[0]) / inertia), (0, end), (0, 1), rtol=1e-12, atol=1e-12
    ).y[:, -1]
    assert exact[0] > 1.5 * np.pi
    errors = []
    for step in (2e-3, 1e-3):
        model, posts, feet = four_bars(n)
        result = pl.simulate(model, duration=end, step=step, threads=1)
        errors.append(np.abs([-result.joint(foot).position[-1] - exact[0] for foot in feet]).max())
    assert sum(r.equations for r in model.redundant) == 3 * n
    assert {r.joint for r in model.redundant} == {f"right{i}" for i in range(n)}
    assert errors[-1] < 2e-4
    assert record(f"{n} four-bars, order", np.log2(errors[0] / errors[1]), 2.0, 0.2)
    # Drift: the upper ends stay where the bars hold them.
    tops = np.array([result.track(post.at((0, 0.5, 0))).position for post in posts])
    gaps = np.linalg.norm(np.diff(tops, axis=0), axis=2)
    assert record(f"{n} four-bars, drift of the bars' lengths", gaps, np.ones_like(gaps), 1e-8, "m")
    # Of the energy in play, 20 J for each window, the scheme's own order.
    assert np.ptp(result.energy.total) < 1e-4 * 20 * n


EDGES = np.array([[1, 0, 0], [0, -1, 0], [0, 0, 1], [-1, 0, 0], [0, 1, 0], [0, 0, -1]], dtype=float)
CORNERS = np.vstack([np.zeros(3), np.cumsum(EDGES, axis=0)[:-1]])
AXES = np.cross(EDGES[[5, 0, 1, 2, 3, 4]], EDGES)
SPREAD = np.array(
    [1 / 12, 1e-3, 1e-3]
)  # mean square distances of a rod from its middle, along itself and across


def bricard():
    """Bricard's mechanism: six edges of a cube, one of them the ground, hinges normal to both edges."""
    model = pl.Model(gravity=(0, -G, 0))
    rods = []
    for k in range(5):
        across = AXES[k]
        axes = np.stack([EDGES[k], across, np.cross(EDGES[k], across)], axis=1)
        j = SPREAD
        rods.append(
            model.add_rigid_body(
                mass=1.0,
                inertia=(j[1] + j[2], j[0] + j[2], j[0] + j[1]),
                position=CORNERS[k] + 0.5 * EDGES[k],
                orientation=Rotation.from_matrix(axes),
            )
        )
    joints = [model.hinge(rods[0].at((-0.5, 0, 0)), axis=AXES[0])]
    joints += [
        model.hinge(rods[k].at((-0.5, 0, 0)), rods[k - 1].at((0.5, 0, 0)), axis=AXES[k]) for k in range(1, 5)
    ]
    joints.append(model.hinge(rods[4].at((0.5, 0, 0)), axis=AXES[5]))
    return model, rods, joints


def bricard_path(step, count):
    """Angles of the first hinge, middles and axes of the five rods along the path that the loop leaves."""

    def poses(turns):
        turn, at, out = np.eye(3), np.zeros(3), []
        for k in range(5):
            turn = turn @ Rotation.from_rotvec(turns[k] * AXES[k]).as_matrix()
            start = np.stack([EDGES[k], AXES[k], np.cross(EDGES[k], AXES[k])], axis=1)
            out.append(np.concatenate([(at + 0.5 * turn @ EDGES[k])[None], (turn @ start).T]))
            at = at + turn @ EDGES[k]
        return np.array(out), at, turn

    def gap(turns):
        _, end, turn = poses(turns)
        return np.concatenate([end - CORNERS[5], turn @ AXES[5] - AXES[5]])

    def along(turns, before, tangent):
        return np.concatenate([gap(turns), [tangent @ (turns - before) - step]])

    turns = np.zeros(5)
    ahead = np.array([1.0, -1.0, 1.0, -1.0, 1.0]) / np.sqrt(5) * np.sign(step)
    rows = [np.concatenate([[0.0], poses(turns)[0].ravel()])]
    for _ in range(count):
        tangent = ahead * np.sign(step)
        fit = least_squares(
            along,
            turns + step * tangent,
            args=(turns, tangent),
            jac="3-point",
            xtol=1e-15,
            ftol=1e-15,
            gtol=1e-15,
        )
        assert np.abs(gap(fit.x)).max() < 1e-9
        ahead = (fit.x - turns) / np.linalg.norm(fit.x - turns)
        turns = fit.x
        rows.append(np.concatenate([turns[:1], poses(turns)[0].ravel()]))
    return np.array(rows)


def test_bricard(record):
    end = 1.0
    step, count = 0.02, 150
    rows = np.concatenate([bricard_path(-step, count)[:0:-1], bricard_path(step, count)])
    path = make_interp_spline(step * np.arange(-count, count + 1), rows, k=5)
    turn, curve = (lambda u: path(u)[0]), (lambda u, k: path(u, k)[1:].reshape(20, 3))
    weights = np.tile(np.concatenate([[1.0], SPREAD]), 5)

    def rate(_, y):
        first, second = curve(y[0], 1), curve(y[0], 2)
        mass = np.einsum("i,ik,ik->", weights, first, first)
        slope = np.einsum("i,ik,ik->", weights, first, second)
        return y[1], -(slope * y[1] ** 2 + G * first[::4, 1].sum()) / mass

    exact = solve_ivp(rate, (0, end), (0.0, 0.0), rtol=1e-10, atol=1e-10)
    assert np.abs(exact.y[0]).max() < step * count
    last = turn(exact.y[0, -1])
    errors = []
    for step in (4e-3, 2e-3):
        model, rods, joints = bricard()
        result = pl.simulate(model, duration=end, step=step, threads=1)
        errors.append(abs(result.joint(joints[0]).position[-1] - last))
    assert sum(r.equations for r in model.redundant) == 1
    # Motion of about a radian; second order, until the spline's error of 1e-7.
    assert record("Bricard, angle", result.joint(joints[0]).position[-1], last, 1e-4, "rad")
    assert record("Bricard, order", np.log2(errors[0] / errors[1]), 2.0, 0.3)
    gap = result.track(rods[4].at((0.5, 0, 0))).position - CORNERS[5]
    assert record("Bricard, drift of the last hinge", gap, np.zeros_like(gap), 1e-9, "m")
    assert np.ptp(result.energy.total) < 1e-3
    # Where one hinge more is made, nothing changes but the reactions.
    assert np.isfinite(result.reaction(joints[3]).force).all()


def test_statics_and_modes_go_through():
    for count in (1, 2):
        model, leaf, joints = door(count)
        spring = model.add_spring(leaf.at((0.4, 0, 0)), (0.8, 1.0, 0.0), 50.0, length=0.1)
        static = pl.solve_static(model)
        modes = pl.solve_modes(model, count=1, about=static)
        force = sum(static.reaction(j).force[-1] for j in joints)
        place = static.track(leaf.center).position[-1]
        if count == 1:
            expected = force, place, modes.frequencies
        del spring
    np.testing.assert_allclose(force, expected[0], atol=1e-6)
    np.testing.assert_allclose(place, expected[1], atol=1e-9)
    np.testing.assert_allclose(modes.frequencies, expected[2], rtol=1e-6)


def test_a_cable_clamped_twice_at_one_end():
    model = pl.Model(gravity=(0, 0, -G))
    rubber = pl.LinearElastic(youngs_modulus=1e7, poisson_ratio=0.45, density=1000.0)
    strand = model.add_cable([(0, 0, 0), (1, 0, 0)], elements=80, section=pl.Circle(5e-3), material=rubber)
    wall = model.clamp(strand.start)
    again = model.pin(strand.start, (0, 0, 0))
    assert [(r.joint, r.equations, r.follows_from) for r in model.redundant] == [("pin1", 3, ("clamp1",))]
    assert "3 equations follow from clamp1" in str(model)
    static = pl.solve_static(model)
    total = static.reaction(wall).force[-1] + static.reaction(again).force[-1]
    np.testing.assert_allclose(total, (0, 0, 1000.0 * np.pi * 25e-6 * G), rtol=1e-7, atol=1e-9)
    # Both hold the same thing: half each.
    np.testing.assert_allclose(static.reaction(again).force[-1], 0.5 * total, rtol=1e-6, atol=1e-8)


def test_steppers_go_through_with_the_same_bits():
    model, *_ = four_bars(2)
    whole = pl.simulate(model, duration=0.2, step=2e-3, threads=1)
    stepper = pl.Stepper(model, step=2e-3, threads=1)
    stepper.advance(40)
    middle = stepper.state
    stepper.advance(60)
    np.testing.assert_array_equal(stepper.coordinates, whole._records.q[-1])
    stepper.reset(middle)
    stepper.advance(60)
    np.testing.assert_array_equal(stepper.coordinates, whole._records.q[-1])


def test_releasing_what_others_follow_from():
    model, leaf, (upper, lower) = door(2)
    upper.release(at=0.101)
    result = pl.simulate(model, duration=0.3, step=1e-2, threads=1)
    reference, leaf_1, _ = door(1)
    same = pl.simulate(reference, duration=0.3, step=1e-2, threads=1)
    # One hinge is enough; the weight is all on the other.
    np.testing.assert_allclose(
        result.track(leaf.center).position[-1], same.track(leaf_1.center).position[-1], atol=1e-7
    )
    assert np.all(result.reaction(upper).force[-1] == 0)
    np.testing.assert_allclose(result.reaction(lower).force[-1, 2], 32.0 * G, rtol=1e-6)


def test_a_thousand_doors_are_quickly_found():
    model = pl.Model()
    for k in range(1000):
        leaf = model.add_rigid_body(mass=1.0, shape=pl.Box((0.8, 0.04, 2.0)), position=(0, k, 0))
        model.hinge(leaf.at((-0.4, 0, 0.8)))
        model.hinge(leaf.at((-0.4, 0, -0.8)))
    begin = time.perf_counter()
    found = model.redundant
    assert sum(r.equations for r in found) == 5000
    # No dense matrix of 16,000 rows, which would take minutes.
    assert time.perf_counter() - begin < 60


def test_a_static_model_that_floats_is_named():
    model = pl.Model(gravity=(0, 0, -G))
    model.add_rigid_body(mass=1.0, shape=pl.Sphere(0.1), name="fixed")
    model.weld(model["fixed"])
    model.add_rigid_body(mass=1.0, shape=pl.Sphere(0.1), position=(1, 0, 0), name="balloon")
    with pytest.raises(pl.ConvergenceError, match="balloon"):
        pl.solve_static(model)


@pytest.mark.parametrize("spin", [2.0, 0.0])
def test_a_parallelogram_starts_in_its_singular_position(spin, record):
    # All rods in one line: the instantaneous freedoms branch, and one equation more depends on the others.
    end, gravity = 0.5, 9.81
    inertia, arm = 2 / 3 + 1, 2.0
    exact = solve_ivp(
        lambda _, y: (y[1], -gravity * arm * np.cos(y[0]) / inertia), (0, end), (0, spin), rtol=1e-12
    ).y[0, -1]
    errors = []
    for step in (1e-2, 5e-3):
        model = pl.Model(gravity=(0, -gravity, 0))
        cranks, feet = [], []
        for i in range(2):
            crank = model.add_rigid_body(
                mass=1.0,
                inertia=(1e-4, 1 / 12, 1 / 12),
                position=(i + 0.5, 0, 0),
                velocity=(0, 0.5 * spin, 0),
                angular_velocity=(0, 0, spin),
            )
            feet.append(model.hinge(crank.at((-0.5, 0, 0))))
            cranks.append(crank)
        bar = model.add_rigid_body(
            mass=1.0, inertia=(1e-4, 1 / 12, 1 / 12), position=(1.5, 0, 0), velocity=(0, spin, 0)
        )
        model.hinge(bar.at((-0.5, 0, 0)), cranks[0].at((0.5, 0, 0)))
        model.hinge(bar.at((0.5, 0, 0)), cranks[1].at((0.5, 0, 0)))
        assert sum(r.equations for r in model.redundant) == 4
        result = pl.simulate(model, duration=end, step=step, threads=1)
        errors.append(np.abs([result.joint(foot).position[-1] - exact for foot in feet]).max())
    # Second order, the step in which the fourth equation is taken in again included.
    assert errors[-1] < 1e-3
    assert record(f"parallelogram from its singular position, spin {spin:g}", errors[0] / errors[1], 4.0, 1.0)


def test_drives_that_disagree_are_refused_by_name():
    model = pl.Model()
    ball = model.add_point_mass(1.0, at=(0, 0, 0))
    model.drive(ball.center, position=(1.0, 0, 0) * pl.Ramp(1.0), name="one way")
    model.drive(ball.center, position=(2.0, 0, 0) * pl.Ramp(1.0), name="another")
    with pytest.raises((pl.ModelError, pl.ConvergenceError)) as caught:
        pl.simulate(model, duration=1.0, step=1e-2, threads=1)
    assert "'one way'" in str(caught.value)
    assert "'another'" in str(caught.value)
