"""Equilibria are stable: slack ropes hang, struts buckle, arches snap; what starts there stays at rest."""

import warnings

import numpy as np
import pliant as pl
import pytest
from scipy.optimize import brentq
from scipy.special import ellipe, ellipk
from verification.cables import cantilever, line


def rests(model: pl.Model, static: pl.Result) -> float:
    """Largest kinetic energy within 0.2 s after the start at an equilibrium."""
    return float(pl.simulate(model, duration=0.2, step=2e-3, start=static).energy.kinetic.max())


def slack_rope(stiffness: float, bending: float) -> tuple[pl.Model, object]:
    """4.2 m of rope given straight between pins 4 m apart: in equilibrium, but not for long."""
    model = pl.Model(gravity=(0, 0, -9.81))
    rope = model.add_cable(
        [(0, 0, 0), (4, 0, 0)], elements=24, rest_length=4.2, strain="biot", **line(stiffness, bending, 0.1)
    )
    model.pin(rope.start), model.pin(rope.end)
    return model, rope


def test_a_slack_rope_given_straight_hangs_in_the_catenary(record):
    model, rope = slack_rope(1e6, 1e-4)
    result = pl.solve_static(model)
    # Inextensible catenary; stretch 4e-6, and a bending length sqrt(EI/H) of 5 mm at the pins.
    a = brentq(lambda a: 2 * a * np.sinh(2 / a) - 4.2, 1.0, 50.0)
    sag = a * (np.cosh(2 / a) - 1)
    assert record("slack rope given straight, sag", -result.positions(rope)[-1, 12, 2], sag, 1e-4, unit="m")
    # The mass is that of the line as it is given: 4 m.
    half = 0.5 * 0.1 * 4.0 * 9.81
    for joint in model.joints:
        assert record(
            "slack rope, vertical reaction", result.reaction(joint).force[-1, 2], half, 1e-6, unit="N"
        )
    assert np.all(result.axial_force(rope)[-1] > 0)
    assert pl.solve_modes(model, count=3, about=result).stable
    assert rests(model, result) < 1e-16


def test_a_steel_rope_hangs():
    model = pl.Model(gravity=(0, 0, -9.81))
    steel = pl.LinearElastic(youngs_modulus=2.1e11, poisson_ratio=0.3, density=7850.0)
    rope = model.add_cable(
        [(0, 0, 0), (4, 0, 0)], elements=24, section=pl.Circle(radius=2e-3), material=steel, rest_length=4.2
    )
    model.pin(rope.start), model.pin(rope.end)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        result = pl.solve_static(model)
    assert result.positions(rope)[-1, :, 2].min() < -0.5
    assert np.all(result.axial_force(rope)[-1] > 0)
    assert rests(model, result) < 1e-16


def test_an_unstable_equilibrium_can_be_kept():
    model, rope = slack_rope(1e6, 1e-4)
    with pytest.warns(UserWarning, match="unstable at load factor 1"):
        result = pl.solve_static(model, stable=False)
    assert np.all(result.axial_force(rope)[-1] < 0)


@pytest.mark.parametrize("ratio", [0.98, 1.05, 1.5, 2.5])
def test_a_strut_buckles_into_the_elastica(ratio, record):
    model, arm = cantilever(32, 1e6)
    model.add_force(arm.end, (-ratio * np.pi**2 / 4, 0, 0))
    result = pl.solve_static(model)
    tip = result.track(arm.end).position[-1]
    deflection, length = 0.0, 1.0
    if ratio > 1:
        # K(k) = pi/2 sqrt(P/P_cr); tip at ((2 E - K)/K, 2 k/K).
        k = np.pi / 2 * np.sqrt(ratio)
        m = brentq(lambda m: ellipk(m) - k, 1e-12, 1 - 1e-9)
        length, deflection = (2 * ellipe(m) - k) / k, 2 * np.sqrt(m) / k
    # Axial strain P/EA: 2.5e-6 at the critical load; near it the deflection is sensitive to it.
    name = f"strut at {ratio:g} of the critical load"
    assert record(f"{name}, deflection", np.hypot(tip[1], tip[2]), deflection, 3e-5, unit="L")
    assert record(f"{name}, height", tip[0], length, 3e-5, unit="L")
    assert rests(model, result) < 1e-14


def test_an_arch_of_two_bars_snaps_to_a_stable_branch():
    model = pl.Model()
    bars = model.add_cable_net(
        [(-1, 0, 0), (0, 0, 0.2), (1, 0, 0)], [(0, 1), (1, 2)], elements=1, **line(1e4, 1.0)
    )
    model.pin(bars.node(0)), model.pin(bars.node(2))
    model.add_force(bars.node(1), (0, 0, -100.0))
    result = pl.solve_static(model, load_steps=4)
    assert np.all(result.track(bars.node(1)).position[:, 2] < -0.2)
    assert pl.solve_modes(model, count=3, about=result).stable
    assert rests(model, result) < 1e-14


def test_a_net_of_cables_without_tension_hangs():
    model = pl.Model(gravity=(0, 0, -9.81))
    corners = [(1, 0, 0), (0, 1, 0), (-1, 0, 0), (0, -1, 0)]
    net = model.add_cable_net(
        [(0, 0, 0), *corners],
        [(0, i) for i in range(1, 5)],
        elements=4,
        tension_only=True,
        **line(1e5, 1e-3, 0.1),
    )
    for i in range(1, 5):
        model.pin(net.node(i))
    result = pl.solve_static(model)
    middle = result.track(net.node(0)).position[-1]
    # Taut strings under their weight: EA s^3 balances it, a slope s of 2 %.
    assert -0.03 < middle[2] < -0.01
    assert np.hypot(middle[0], middle[1]) < 1e-6
    assert pl.solve_modes(model, count=3, about=result).stable
    assert rests(model, result) < 1e-14
