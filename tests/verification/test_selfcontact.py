"""A clamped strip whose ends are brought together: where it touches itself, and how hard after that."""

from __future__ import annotations

import numpy as np
import pliant as pl
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import root

# A cable does not twist: only symmetry keeps one that is bent so far in its plane.
pytestmark = pytest.mark.filterwarnings("ignore:the equilibrium is unstable")

START = 0.8  # end shortening at which no such strip touches itself
STIFF = 1e8  # EA L^2/EI: shortens by a millionth


def half(unknowns, places=None):
    """Angle, curvature, x and y of half an inextensible strip, EI = L = 1, at the pinch and in the middle.

    The ends push with P along x; at s its other half pushes it back with N. By symmetry there is no force
    across.
    """
    push, curvature, s, pinch = unknowns

    def along(force):
        return lambda _, y: [y[1], -force * np.sin(y[0]), np.cos(y[0]), np.sin(y[0])]

    accuracy = {"rtol": 1e-11, "atol": 1e-12}
    first = solve_ivp(along(push), (0, s), [0, curvature, 0, 0], dense_output=places is not None, **accuracy)
    rest = solve_ivp(
        along(push - pinch), (s, 0.5), first.y[:, -1], dense_output=places is not None, **accuracy
    )
    if places is not None:
        return np.where(places < s, first.sol(places), rest.sol(places))
    return first.y[:, -1], rest.y[:, -1]


def solved(residual, guess):
    solution = root(residual, guess, tol=1e-12)
    assert np.abs(solution.fun).max() < 1e-9
    return solution.x


def first_touch(radius):
    """Push, curvature at the clamp and place of the touch, and the end shortening."""

    def residual(unknowns):
        neck, middle = half([*unknowns, 0.0])
        return [neck[0] - np.pi / 2, middle[0], middle[2] - neck[2] - radius]

    found = solved(residual, (72.0, 14.5, 0.13))
    return found, 1 - 2 * half([*found, 0.0])[1][2]


def pressed(shortening, radius, guess):
    """Push, curvature at the clamp, place and force of the pinch."""

    def residual(unknowns):
        neck, middle = half(unknowns)
        over = middle[2] - neck[2] - radius
        return [neck[0] - np.pi / 2, middle[0], over, middle[2] - (1 - shortening) / 2]

    return solved(residual, guess)


def strip(elements, radius, shortening, begin=START):
    """Build the strip, drawn together on from where its state is."""

    def residual(unknowns):
        _, middle = half([*unknowns, 0.25, 0.0])
        return [middle[0], middle[2] - (1 - START) / 2]

    free = solved(residual, (68.7, 13.8))
    left = half([*free, 0.25, 0.0], np.linspace(0, 0.5, elements // 2 + 1))[2:].T
    right = (left * [-1, 1] + [1 - START, 0])[::-1]
    shape = np.pad(np.concatenate([left, right[1:]]), [(0, 0), (0, 1)])
    model = pl.Model()
    section = pl.Section(area=STIFF, second_moments=(1.0, 1.0), torsion_constant=1.0, radius=radius)
    cable = model.add_cable(
        [(0, 0, 0), (1, 0, 0)],
        elements=elements,
        section=section,
        material=pl.LinearElastic(youngs_modulus=1.0, poisson_ratio=0.3, density=1.0),
        initial=shape,
        strain="biot",
        name="strip",
    )
    model.drive(cable.start, position=(0, 0, 0), direction=(1, 0, 0))
    model.drive(
        cable.end,
        position=lambda f: (1 - begin - (shortening - begin) * f, 0, 0),
        direction=(1, 0, 0),
        name="end",
    )
    # It might turn about the line of its ends: a spring too soft to bend it keeps it upright.
    model.add_spring(cable.node(elements // 2), shape[elements // 2], 1e-3, length=0.0)
    model.add_contact(cable)
    return model


def push_of(state):
    return -state.reaction(state.model["end"]).force[-1, 0]


def touching(elements, radius, accuracy):
    """End shortening at which contact sets in, and the last state before."""
    state = pl.solve_static(strip(elements, radius, START), stable=False)
    assert not state.contacts[-1]
    low, high = START, 0.86
    while high - low > accuracy:
        middle = (low + high) / 2
        trial = pl.solve_static(strip(elements, radius, middle, low), start=state, stable=False)
        if trial.contacts[-1]:
            high = middle
        else:
            low, state = middle, trial
    return low, state


def test_a_thin_strip_touches_itself_first_where_the_elastica_does(record):
    # What the thickness takes off goes with the thickness: two thin strips tell of none.
    found = [touching(40, radius, 1e-7) for radius in (4e-4, 2e-4)]
    (thick, first), (thin, state) = found
    source = "inextensible elastica, elliptic integrals"
    # Five digits are known; 40 elements leave 6e-7, the next order in the radius 1e-7.
    assert record(
        "clamped strip, end shortening at first touch", 2 * thin - thick, 0.84865, 5e-6, "L", source
    )
    # 40 elements: 3e-5 of it.
    push = 2 * push_of(state) - push_of(first)
    assert record("clamped strip, push at first touch", push, 72.188, 3e-3, "EI/L^2", source)
    # Where the sides are upright; the turning point of x along the line is found to the square of a piece.
    line = pl.scenes.centre_line(state, "strip", [-1])[0]
    left = np.argmax(line[: len(line) // 3, 0])
    a, b, _ = np.polyfit(np.arange(-2, 3), line[left - 2 : left + 3, 0], 2)
    place = (left - b / (2 * a)) / (len(line) - 1)
    exact = first_touch(2e-4)[0][2]
    assert exact == pytest.approx(0.12944, abs=1e-4)
    assert record("clamped strip, place of first touch", place, exact, 1e-4, "L", source)


@pytest.mark.parametrize("radius", [5e-3, 1e-3])
def test_a_strip_that_touches_itself_is_pinched(radius, record):
    guess, onset = first_touch(radius)
    reached, state = touching(80, radius, 1e-6)
    name, source = (
        f"clamped strip of r = {radius:g} L",
        "inextensible elastica with a pinch, shot from the clamp",
    )
    # Of 80 elements the strip touches where it should to 1e-7; halving stops at 1e-6.
    assert record(f"{name}, end shortening at first touch", reached, onset, 1.5e-6, "L", source)
    assert push_of(state) == pytest.approx(guess[0], rel=2e-5)
    known = [*guess, 0.0]
    for shortening in (0.86, 0.88, 0.9):
        model = strip(80, radius, shortening, reached)
        state = pl.solve_static(model, start=state, load_steps=4, stable=False)
        reached = shortening
        known = pressed(shortening, radius, known)
        pinch = sum(patch.normal_force for patch in state.contacts[-1])
        # The pinch acts at a point, where the curvature has a corner that no cubic follows: 4e-4 at 80
        # elements.
        title = f"{name}, shortened by {shortening:g} L"
        assert record(f"{title}, push over exact", push_of(state) / known[0], 1.0, 1e-3, "", source)
        assert record(f"{title}, pinch over exact", pinch / known[3], 1.0, 1e-3, "", source)
        assert state.positions("strip")[-1, 40, 1] == pytest.approx(half(known)[1][3], abs=1e-5)
        # The two sides meet midway between the ends, upright.
        points = np.array([patch.point for patch in state.contacts[-1]])
        assert np.abs(points[:, 0] - (1 - shortening) / 2).max() < 1e-6
        assert np.abs(points[:, 1] - half(known)[0][3]).max() < 1e-3


def test_the_gap_beside_a_knot_is_that_of_what_presses():
    # Two ropes of a net close in a narrow V: what lies within three sums of the radii of their knot does not
    # count, in the force or in the gap, which at the knot itself would be minus two radii.
    rope = pl.LinearElastic(5e8, 0.4, 950.0, retardation_time=1e-3)
    radius = 1.5e-3
    model = pl.Model()
    net = model.add_cable_net(
        [(0, 0, 0), (0.2, 0.04, 0), (0.2, -0.04, 0)],
        [(0, 1), (0, 2)],
        elements=4,
        section=pl.Circle(radius),
        material=rope,
        velocity=lambda x: np.stack([0 * x[:, 0], -x[:, 0] / 0.2 * np.sign(x[:, 1]), 0 * x[:, 0]], 1),
    )
    model.add_contact(net)
    result = pl.simulate(model, duration=0.02, step=1e-3, threads=1)
    gaps = [patch.gap for row in result.contacts for patch in row]
    assert len(gaps) > 5
    assert min(gaps) > -0.4 * radius
