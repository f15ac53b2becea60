"""The LuGre law alone, beside independent integrations of its differential equation."""

import numpy as np
import pliant as pl
import pytest
from scipy.integrate import solve_ivp

CLASSIC = pl.LuGre(
    1.5, 1.0, stribeck_velocity=1e-3, bristle_stiffness=1e5, bristle_damping=np.sqrt(1e5), viscous=0.4
)


def rate(z, v, normal):
    """z' of the bristles as printed."""
    law = CLASSIC
    g = normal * (
        law.dynamic + (law.static - law.dynamic) * np.exp(-(np.abs(v / law.stribeck_velocity) ** 2))
    )
    return v - law.bristle_stiffness * np.abs(v) / g * z


def rig(t, y):
    """A kilogram on a spring of 2 N/m whose end is pulled at 0.1 m/s."""
    x, v, z = y
    dz = rate(z, v, 1.0)
    friction = CLASSIC.bristle_stiffness * z + CLASSIC.bristle_damping * dz + CLASSIC.viscous * v
    return [v, 2.0 * (0.1 * t - x) - friction, dz]


@pytest.fixture(scope="module")
def stick_slip():
    time = np.linspace(0.0, 22.0, 22001)
    return time, solve_ivp(rig, (0, 22), [0, 0, 0], method="LSODA", t_eval=time, rtol=1e-9, atol=1e-12).y


def test_force_along_a_stick_slip_motion(stick_slip, record):
    time, (_, v, z) = stick_slip
    force, bristle = pl.lugre(CLASSIC, time, v, 1.0)
    expected = CLASSIC.bristle_stiffness * z + CLASSIC.bristle_damping * rate(z, v, 1.0) + CLASSIC.viscous * v
    error = np.abs(force - expected).max()
    # The rate of the bristles is that of the mean velocity, half a step late: sigma_1 h/2 times its change,
    # at the end of a slip 0.4 m/s^2, is 0.06 N.
    assert record(
        "LuGre, force in stick-slip, largest error", error, 0.0, 0.07, unit="N", source="LSODA at 1e-9"
    )
    stuck = CLASSIC.bristle_stiffness * np.abs(bristle - z).max()
    # The deflection itself is second order: 5e-3 N at 1 ms, where the velocity grows tenfold in a few steps.
    assert record(
        "LuGre, sigma_0 z in stick-slip, largest error", stuck, 0.0, 7e-3, unit="N", source="LSODA at 1e-9"
    )
    assert np.abs(bristle).max() * CLASSIC.bristle_stiffness <= 1.5


def test_rules_have_their_orders(record):
    def bristle(n, rule):
        time = np.linspace(0.0, 2.0, n + 1)
        v = 2e-3 * np.sin(3.0 * time) + 5e-4 * np.cos(17.0 * time)
        return pl.lugre(CLASSIC, time, v, 1.0, rule=rule)[1][-1]

    def z_rate(t, z):
        return rate(z, 2e-3 * np.sin(3.0 * t) + 5e-4 * np.cos(17.0 * t), 1.0)

    exact = solve_ivp(z_rate, (0, 2), [0.0], method="LSODA", rtol=1e-12, atol=1e-17).y[0, -1]
    errors = {rule: [abs(bristle(n, rule) - exact) for n in (16000, 32000)] for rule in ("midpoint", "end")}
    # Both are met to a few hundredths at these steps.
    assert record("LuGre, order of the end rule", np.log2(errors["end"][0] / errors["end"][1]), 1.0, 0.05)
    order = np.log2(errors["midpoint"][0] / errors["midpoint"][1])
    assert record("LuGre, order of the midpoint rule", order, 2.0, 0.05)


def test_force_follows_the_velocity_around():
    # The law is the same in every direction: a turned history gives a turned force.
    time = np.linspace(0.0, 1.0, 401)
    v = np.stack([np.sin(5 * time), np.cos(3 * time)], axis=1) * 1e-3
    turn = np.array([[0.6, -0.8], [0.8, 0.6]])
    load = 1.0 + 0.5 * np.sin(7 * time)
    plain, turned = (pl.lugre(CLASSIC, time, w, load)[0] for w in (v, v @ turn.T))
    # Rounding only.
    np.testing.assert_allclose(turned, plain @ turn.T, atol=1e-12)


def test_bristles_never_carry_more_than_the_contact():
    # Loaded by 2 N and bent, then the load drops to 0.1 N at rest: no more than 1.5 * 0.1 N are left.
    time = np.arange(0, 100) * 1e-3
    v = np.where(time < 0.05, 4e-4, 0.0)
    load = np.where(time < 0.05, 2.0, 0.1)
    force, _ = pl.lugre(CLASSIC, time, v, load)
    # At rest the force is that of the bristles' deflection: up to rounding on the limit.
    assert force[-1] == pytest.approx(0.15, rel=1e-12)
