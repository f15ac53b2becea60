"""Runs that cannot be right stop and keep what they have."""

import numpy as np
import pliant as pl
import pytest


def string_hit_by_a_ball(step: float) -> pl.Result:
    """A taut, undamped string with a ball thrown at its middle, to which it sticks."""
    model = pl.Model()
    string = model.add_cable(
        [(-1, 0, 0), (1, 0, 0)],
        elements=20,
        section=pl.Circle(4e-3),
        material=pl.LinearElastic(1e9, 0.4, 1100.0),
        pretension=150.0,
    )
    model.pin(string.start)
    model.pin(string.end)
    ball = model.add_point_mass(2.0, at=(0, 0, 0), velocity=(2, 12, 3), name="ball")
    model.pin(ball, string.node(10))
    with pytest.warns(UserWarning, match="projected"):
        return pl.simulate(model, duration=0.05, step=step, threads=1)


def test_energy_from_nowhere_is_an_error_that_keeps_the_result():
    # The step is far too long for the waves of the blow: megajoules come out of 157 J, and Newton converges.
    with pytest.raises(pl.ConvergenceError, match=r"nowhere|no convergence") as caught:
        string_hit_by_a_ball(1e-3)
    assert len(caught.value.result.time) >= 1
    assert np.all(np.isfinite(caught.value.result.energy.total))


def test_the_same_blow_in_short_steps_keeps_its_energy():
    total = string_hit_by_a_ball(5e-5).energy.total
    assert np.ptp(total) < 0.02 * abs(total[0])


def test_damping_accounts_for_a_blow():
    # Kelvin-Voigt cords take the jump of a blow up within a fraction of a step: what they dissipate is force
    # times way, not power times step.
    gaps = []
    for step in (4e-4, 2e-4):
        model = pl.Model()
        cord = model.add_cable(
            [(-1, 0, 0), (1, 0, 0)],
            elements=8,
            section=pl.Circle(4e-3),
            material=pl.LinearElastic(1e8, 0.4, 1100.0, retardation_time=4e-3),
            pretension=50.0,
        )
        model.pin(cord.start)
        model.pin(cord.end)
        ball = model.add_point_mass(2.0, at=(0, 0, 0), velocity=(0, 12, 0), name="ball")
        model.pin(ball, cord.node(4))
        with pytest.warns(UserWarning, match="projected"):
            energy = pl.simulate(model, duration=0.05, step=step, threads=1).energy
        gaps.append(np.abs(energy.total - energy.total[0]).max() / energy.kinetic[0])
    assert gaps[0] < 0.03
    assert gaps[1] < 0.6 * gaps[0]


def test_what_floats_free_is_named():
    model = pl.Model(gravity=(0, 0, -9.81))
    model.add_point_mass(1.0, at=(0, 0, 0), name="ball")
    with pytest.raises(pl.ConvergenceError, match="ball"):
        pl.solve_static(model)
