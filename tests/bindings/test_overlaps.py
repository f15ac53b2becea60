"""Bodies that overlap at the start are named."""

from __future__ import annotations

import warnings

import numpy as np
import pliant as pl
import pytest

RUBBER = pl.LinearElastic(youngs_modulus=5e6, poisson_ratio=0.45, density=1100.0)
RADIUS = 0.01


def crossing(height):
    """Two ropes that cross, at a distance of their middles."""
    model = pl.Model()
    kind = {"elements": 4, "section": pl.Circle(RADIUS), "material": RUBBER}
    low = model.add_cable([(-0.2, 0.013, 0), (0.2, 0.013, 0)], name="low", **kind)
    high = model.add_cable([(0.017, -0.2, height), (0.017, 0.2, height)], name="high", **kind)
    for end in (low.start, low.end, high.start, high.end):
        model.pin(end)
    model.add_contact(low, high, name="knock")
    return model


def begun(model):
    """Each way of beginning a run."""
    return {
        "simulate": lambda: pl.simulate(model, duration=1e-6, step=1e-6),
        "Stepper": lambda: pl.Stepper(model, step=1e-6),
        "solve_static": lambda: pl.solve_static(model),
    }


@pytest.mark.parametrize("way", ["simulate", "Stepper", "solve_static"])
def test_overlap_at_the_start_is_warned_of_once(way):
    with pytest.warns(UserWarning, match="overlap at the start") as caught:
        begun(crossing(8e-3))[way]()
    assert len(caught) == 1
    text = str(caught[0].message)
    # Two radii less the distance.
    assert "'low' and 'high' by 0.012 m ('knock'" in text
    assert "0.01 m)" in text
    assert caught[0].filename == __file__


@pytest.mark.parametrize("way", ["simulate", "Stepper", "solve_static"])
def test_what_touches_lightly_is_not(way):
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        begun(crossing(16e-3))[way]()
    assert not caught


def test_the_worst_are_told_and_the_others_counted():
    model = pl.Model()
    ground = model.add_obstacle(pl.HalfSpace(), name="ground")
    for k in range(5):
        line = [(0, k, 5e-4 * k - 5e-3), (1, k, 5e-4 * k - 5e-3)]
        rope = model.add_cable(line, elements=1, section=pl.Circle(RADIUS), material=RUBBER, name=f"r{k}")
        model.add_contact(rope, ground)
    with pytest.warns(UserWarning, match="overlap at the start") as caught:
        pl.Stepper(model, step=1e-4)
    text = str(caught[0].message)
    order = [text.index(f"'r{k}' and 'ground' by {0.015 - 5e-4 * k:.3g} m") for k in range(3)]
    assert order == sorted(order)
    assert "; 2 more." in text


@pytest.mark.parametrize("kind", ["shell", "membrane"])
def test_a_sheet_in_a_ball_and_in_a_sheet(kind):
    model = pl.Model()
    u, v = np.meshgrid(np.linspace(-0.1, 0.1, 5), np.linspace(-0.1, 0.1, 5), indexing="ij")

    def sheet(z, name):
        mesh = pl.Mesh.grid(np.stack([u, v, np.full_like(u, z)], -1))
        return getattr(model, f"add_{kind}")(mesh, thickness=2e-3, material=RUBBER, name=name)

    one, other = sheet(0.0, "one"), sheet(0.5e-3, "other")
    ball = model.add_rigid_body(mass=1.0, shape=pl.Sphere(0.05), position=(0, 0, 0.07), name="ball")
    model.add_contact(one, other)
    model.add_contact(other, ball)
    with pytest.warns(UserWarning, match="overlap at the start") as caught:
        pl.Stepper(model, step=1e-4)
    text = str(caught[0].message)
    assert "'one' and 'other' by 0.0015 m" in text
    assert "ball" not in text


def test_a_start_given_counts():
    still = crossing(0.05)
    state = pl.solve_static(still)
    moved = crossing(8e-3)
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        pl.Stepper(moved, step=1e-6, start=state)
    assert not caught
