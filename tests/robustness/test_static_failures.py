"""A static search that fails keeps what it reached."""

import math

import pliant as pl
import pytest


def bent(force) -> pl.Model:
    model = pl.Model()
    rubber = pl.LinearElastic(youngs_modulus=1e7, poisson_ratio=0.45, density=1000.0)
    arm = model.add_cable([(0, 0, 0), (1, 0, 0)], elements=4, section=pl.Circle(radius=5e-3), material=rubber)
    model.clamp(arm.start)
    model.add_force(arm.end, force)
    return model


def test_equilibria_before_a_failing_load_are_kept():
    model = bent(lambda factor: (0, 0, 1e-3 if factor < 0.6 else math.nan))
    with pytest.raises(pl.ModelError, match="force1") as caught:
        pl.solve_static(model, load_steps=4)
    assert list(caught.value.result.load_factor) == [0.25, 0.5]


def test_nothing_reached_is_no_result():
    with pytest.raises(pl.ModelError) as caught:
        pl.solve_static(bent(lambda factor: (0, 0, math.nan)))
    assert caught.value.result is None


def test_a_search_without_convergence_keeps_its_result():
    # The far end is let go and pushed without anything to hold it.
    model = pl.Model()
    rubber = pl.LinearElastic(youngs_modulus=1e7, poisson_ratio=0.45, density=1000.0)
    free = model.add_cable(
        [(0, 0, 0), (1, 0, 0)], elements=4, section=pl.Circle(radius=5e-3), material=rubber
    )
    model.add_force(free.end, (0, 0, 1.0))
    with pytest.raises(pl.ConvergenceError) as caught:
        pl.solve_static(model)
    assert caught.value.result is None
