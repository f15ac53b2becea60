"""Paths of equilibria through limit points and bifurcations, against closed forms and published loads."""

import numpy as np
import pliant as pl
import pytest
from scipy.optimize import brentq
from scipy.special import ellipe, ellipk
from verification.cables import cantilever, line


def dome(height: float, load: float):
    """Four bars to an apex, over a rhombus: with Green's strain P = sum EA z (h^2 - z^2) / L^3."""
    model = pl.Model()
    bars = [
        model.add_cable([foot, (0, 0, height)], elements=1, **line(1e4, 1e3))
        for foot in ((-1, 0, 0), (1, 0, 0), (0, -1.3, 0), (0, 1.3, 0))
    ]
    for bar in bars:
        model.pin(bar.start)
    for bar in bars[1:]:
        model.pin(bars[0].end, bar.end)
    push = model.add_force(bars[0].end, (0, 0, -load))
    return model, bars[0].end, push


def stiffness(height: float) -> float:
    return sum(1e4 / np.hypot(base, height) ** 3 for base in (1.0, 1.3))


def test_snap_through_of_a_dome(record):
    height = 0.3
    limit = stiffness(height) * height**3 * 2 / (3 * np.sqrt(3))
    model, apex, _ = dome(height, 1.5 * limit)
    path = pl.solve_static(model, arc_length=True)
    points = path.critical_points
    assert [point.kind for point in points] == ["limit", "limit"]
    # Located to rounding.
    record("dome, upper limit load", 1.5 * points[0].load_factor / 1.0, 1.0, 1e-9, unit="of it")
    record("dome, lower limit load", 1.5 * points[1].load_factor, -1.0, 1e-9, unit="of it")
    z = path.track(apex).position[:, 2]
    exact = stiffness(height) * z * (height**2 - z**2) / (1.5 * limit)
    assert record("dome, load factors along the path", path.load_factor, exact, 1e-9)
    assert path.load_factor[-1] == 1.0
    assert np.all(path.load_factor[:-1] < 1.0)
    # The motion at a limit point goes on along the path: the apex moves straight down.
    shape = points[0].shape / np.abs(points[0].shape).max()
    assert np.abs(shape).max() == 1.0
    assert path.load_factor[points[0].index] == points[0].load_factor


@pytest.mark.filterwarnings("ignore:the equilibrium is unstable")
def test_a_steep_dome_sways(record):
    # Sideways along one diagonal: sum of EA/L (eps + b^2/L^2) over two bars, of EA/L eps over the others.
    height = 2.0
    lengths = {base: np.hypot(base, height) for base in (1.0, 1.3)}
    limit = stiffness(height) * height**3 * 2 / (3 * np.sqrt(3))
    model, apex, _ = dome(height, 1.2 * limit)

    def sway(z, base):
        eps = {b: (z**2 - height**2) / (2 * length**2) for b, length in lengths.items()}
        return sum(eps[b] / length for b, length in lengths.items()) + base**2 / lengths[base] ** 3

    expected = []
    for base in (1.0, 1.3):
        z = brentq(sway, 1e-3, height, args=(base,))
        expected.append(stiffness(height) * z * (height**2 - z**2) / (1.2 * limit))
    path = pl.solve_static(model, arc_length=True, stable=False)
    found = [p.load_factor for p in path.critical_points if p.kind == "bifurcation"]
    # So close to the crossing the matrix is singular: Newton's method finds the point to about 1e-6.
    assert record("steep dome, loads at which it sways", sorted(found[:2]), sorted(expected), 2e-6)
    track = path.track(apex).position
    assert np.abs(track[:, :2]).max() < 1e-5
    # The stable way leaves to the side, where the load falls: the branch closes upon itself.
    with pytest.raises(pl.ConvergenceError, match="has not come to load factor 1") as failure:
        pl.solve_static(model, arc_length=True)
    side = failure.value.result
    first = side.critical_points[0]
    assert record("steep dome, first sway", first.load_factor, min(expected), 2e-6)
    assert np.abs(side.track(apex).position[first.index + 10 :, :2]).max() > 0.5


def test_buckling_and_elastica_of_a_strut(record):
    # EI = L = 1, EA = 1e6: Euler's load pi^2/4, and 2.5e-6 more: compressed, it is shorter.
    euler, ratio = np.pi**2 / 4, 1.5
    model, arm = cantilever(16, 1e6)
    push = model.add_force(arm.end, (-ratio * euler, 0, 0))
    with pytest.warns(UserWarning, match="unstable"):
        straight = pl.solve_static(model, arc_length=True)
    first = straight.critical_points[0]
    assert first.kind == "bifurcation"
    assert record("clamped strut, Euler's load", ratio * first.load_factor, 1.0, 5e-6, unit="of it")
    # After a nudge of 1e-6 of the load it follows the elastica P = (2 K(k) / pi)^2 of Euler's load.
    model.add_force(arm.end, (0, 1e-6 * euler, 0))
    bent = pl.solve_static(model, arc_length=True, scale=push)
    k = brentq(lambda k: (2 * ellipk(k**2) / np.pi) ** 2 - ratio, 1e-6, 0.999)
    tip = (2 * ellipe(k**2) / ellipk(k**2) - 1, 2 * k / ellipk(k**2), 0.0)
    # Elements of fourth order, 16 of them: 2e-5; the compression is 4e-6.
    assert record(
        "clamped strut, tip at 1.5 of Euler's load", bent.track(arm.end).position[-1], tip, 5e-5, "m"
    )
    assert bent.load_factor[-1] == 1.0


def arch(elements: int):
    """Deep circular arch of 215 degrees, hinged at one end and clamped at the other, R = 100, EI = 1e6."""
    half = np.radians(107.5)

    def position(s):
        angle = s / 100.0 - half
        return 100.0 * np.array([np.sin(angle), np.cos(angle), 0.0])

    model = pl.Model()
    curve = pl.Curve(position, length=200.0 * half)
    body = model.add_cable(curve, elements=elements, **line(1e8, 1e6))
    model.pin(body.start)
    model.clamp(body.end)
    return model, body, half


@pytest.mark.filterwarnings("ignore:the equilibrium is unstable")
def test_deep_arch(record):
    model, body, half = arch(32)
    model.add_force(body.at(100.0 * half), (0, -1000.0, 0))
    # Curved lines know bending in their plane only: sideways there is no stiffness, and none is asked for.
    path = pl.solve_static(model, arc_length=True, stable=False)
    limit = next(p for p in path.critical_points if p.kind == "limit")
    # DaDeppo & Schmidt 1975: 8.97 EI/R^2 for the inextensible arch, three digits.
    assert record(
        "deep arch, limit load", limit.load_factor * 10.0, 8.97, 0.02, "EI/R^2", source="DaDeppo & Schmidt"
    )


def test_what_grows_and_what_acts_in_full():
    model, arm = cantilever(4, 1e3)
    dead = model.add_force(arm.end, (10.0, 0, 0))
    model.add_force(arm.end, (20.0, 0, 0))
    both = pl.solve_static(model, load_steps=4)
    some = pl.solve_static(model, load_steps=4, scale=dead)
    np.testing.assert_allclose(both.axial_force(arm)[:, 0], 30 * both.load_factor, rtol=1e-9)
    np.testing.assert_allclose(some.axial_force(arm)[:, 0], 20 + 10 * some.load_factor, rtol=1e-9)
    # From a start everything acts in full, and what is out of balance fades.
    model.add_force(arm.end, (40.0, 0, 0))
    on = pl.solve_static(model, start=some, load_steps=4)
    np.testing.assert_allclose(on.axial_force(arm)[:, 0], 30 + 40 * on.load_factor, rtol=1e-9)
    weight = pl.Model(gravity=(0, 0, -10.0))
    rope = weight.add_cable([(0, 0, 0), (0, 0, -1)], elements=2, **line(1e4, 1.0))
    pin = weight.clamp(rope.start)
    weight.add_force(rope.end, (0, 0, -5.0))
    hung = pl.solve_static(weight, scale="gravity", load_steps=2)
    np.testing.assert_allclose(hung.reaction(pin).force[:, 2], 5 + 10 * hung.load_factor, rtol=1e-9)


def test_critical_points_survive_a_file(tmp_path):
    model, _, push = dome(0.3, 2000.0)
    path = pl.solve_static(model, arc_length=True, scale=[push])
    path.save(tmp_path / "path.h5")
    again = pl.Result.load(tmp_path / "path.h5")
    for a, b in zip(path.critical_points, again.critical_points, strict=True):
        assert (a.kind, a.index, a.load_factor) == (b.kind, b.index, b.load_factor)
        assert np.array_equal(a.shape, b.shape)
    assert again.state(-1).grows == (push.name,)
