"""Winches: cables whose stress-free length changes in time."""

import numpy as np
import pliant as pl
import pytest
from scipy.integrate import solve_ivp
from verification.cables import line

GRAVITY = 9.81


def smooth(first: float, last: float, duration: float) -> pl.Table:
    """A length that goes from one value to another, at rest at both ends."""
    s = np.linspace(0.0, 1.0, 161)
    return pl.Table(duration * s, first + (last - first) * s**3 * (10 - 15 * s + 6 * s**2), smooth=True)


@pytest.mark.parametrize("integration", ["lobatto", "full"])
def test_hanging_rope_hauled_in(integration, record):
    length, stiffness, mass, load = 10.0, 1.0e4, 2.0, 30.0
    model = pl.Model(gravity=(0, 0, -GRAVITY))
    rope = model.add_cable(
        [(0, 0, 0), (0, 0, -length)],
        elements=16,
        strain="biot",
        integration=integration,
        rest_length=lambda factor: length - 4.0 * factor,
        **line(stiffness, 1e-3, mass),
    )
    model.pin(rope.start)
    model.add_point_mass(load, at=rope.end)
    result = pl.solve_static(model)
    # The mass stays on the rope: tensions at material points do not change, pieces are 0.6 of themselves.
    below = (load * length + mass * length**2 / 2) * GRAVITY / stiffness
    expected = 0.6 * (length + below)
    # The strain is linear along the rope, and so in reach of the elements.
    assert record(f"rope hauled in, {integration}", -result.positions(rope)[-1, -1, 2], expected, 1e-9, "m")
    x = length * (np.arange(16) + 0.5) / 16
    tension = (load + mass * (length - x)) * GRAVITY
    # One value of a tension that is linear in an element.
    assert np.allclose(result.axial_force(rope)[-1], tension, rtol=1e-8)


def test_curved_line_stays_similar():
    """A stress-free arc that is scaled has no stress: its curvature falls as its radius grows."""
    arc = pl.Curve(lambda s: (np.sin(s), 1 - np.cos(s), 0.0), length=1.5)
    model = pl.Model()
    strip = model.add_cable(arc, elements=8, rest_length=lambda factor: 1.5 + factor, **line(1e4, 1.0))
    model.clamp(strip.start)
    result = pl.solve_static(model)
    s = np.linspace(0.0, 1.5, 9)
    start = np.stack([np.sin(s), 1 - np.cos(s), 0 * s], axis=1)
    # Newton's tolerance.
    assert np.allclose(result.positions(strip)[-1], start * 2.5 / 1.5, atol=1e-9)
    curvature = result.strain(strip).curvature[-1, :, 2]
    # Interpolation of the arc by cubics.
    assert np.allclose(curvature, 1.5 / 2.5, rtol=2e-3)
    assert abs(result.energy.elastic[-1]) < 1e-12


def hoist(step: float, **options):
    """A mass on a rope almost without mass, hauled up."""
    model = pl.Model(gravity=(0, 0, -GRAVITY))
    rope = model.add_cable(
        [(0, 0, 0), (0, 0, -5)],
        elements=2,
        strain="biot",
        rest_length=smooth(5.0, 2.0, 4.0),
        **line(2.0e3, 1e-6, 1e-6),
        **options,
    )
    model.pin(rope.start)
    model.add_point_mass(3.0, at=rope.end)
    return rope, pl.simulate(model, duration=5.0, step=step)


def test_vertical_hoist_against_its_equation(record):
    rope, result = hoist(1e-3)
    table = smooth(5.0, 2.0, 4.0)

    def rates(t, state):
        z, speed = state
        length = table(min(t, 4.0))[0]
        return speed, 2.0e3 * (z / length - 1.0) / 3.0 * -1.0 + GRAVITY

    exact = solve_ivp(rates, (0, 5), (5.0, 0.0), rtol=1e-10, atol=1e-12, dense_output=True)
    depth = -result.positions(rope)[:, -1, 2]
    error = np.abs(depth - exact.sol(result.time)[0]).max()
    # Second order with 300 steps a period of the mass on its spring, which bounces by centimetres.
    assert record("mass hoisted by a winch, largest error", error, 0.0, 2e-4, "m", source="solve_ivp")
    tension = result.axial_force(rope)[:, 0]
    expected = 2.0e3 * (exact.sol(result.time)[0] / np.array([table(min(t, 4))[0] for t in result.time]) - 1)
    # The same error times the stiffness EA/length.
    assert np.abs(tension - expected).max() < 0.3


def test_work_of_the_winch_closes_the_balance():
    drift = []
    for step in (8e-3, 4e-3):
        _, result = hoist(step)
        energy = result.energy
        drift.append(np.abs(energy.total - energy.total[0]).max())
        # The mass rises by three metres.
        assert abs(energy.work[-1] - 3.0 * GRAVITY * 3.0) < 3.0
    # Second order, of 88 J.
    assert drift[0] / drift[1] > 3.4
    assert drift[1] < 1e-2


def variable_pendulum(length, duration, theta):
    """Angle of a pendulum of prescribed length."""

    def rates(t, state):
        angle, momentum = state
        long = length(t)[0]
        return momentum / long**2, -GRAVITY * long * np.sin(angle)

    return solve_ivp(rates, (0, duration), (theta, 0.0), rtol=1e-10, atol=1e-12, dense_output=True).sol


def test_lorentz_pendulum(record):
    """A pendulum hauled in slowly keeps energy over frequency: its angle grows as length^(-3/4)."""
    first, last, duration, theta = 2.0, 1.0, 30.0, 0.05
    table = smooth(first, last, duration)
    model = pl.Model(gravity=(0, 0, -GRAVITY))
    end = (first * np.sin(theta), 0.0, -first * np.cos(theta))
    rope = model.add_cable(
        [(0, 0, 0), end],
        elements=1,
        strain="biot",
        rest_length=table,
        **line(1e6, 1e-6, 1e-6),
    )
    model.pin(rope.start)
    model.add_point_mass(1.0, at=rope.end)
    result = pl.simulate(model, duration=40.0, step=2.5e-3, output_every=8)
    place = result.positions(rope)[:, -1]
    angle = np.arctan2(place[:, 0], -place[:, 2])
    exact = variable_pendulum(lambda t: table(min(t, duration)), 40.0, theta)(result.time)[0]
    # Second order: 800 steps a period leave 5e-6 of a period each period; the rope stretches by 1e-5.
    assert record(
        "Lorentz pendulum, largest error of the angle", np.abs(angle - exact).max(), 0.0, 1e-4, "rad"
    )
    after = np.abs(angle[result.time > 30.0]).max()
    # Adiabatic up to the square of how much the length changes in a period, for small angles.
    expected = theta * (first / last) ** 0.75
    assert record("Lorentz pendulum, amplitude", after, expected, 2e-4, "rad", source="adiabatic invariant")


def test_axial_frequency_about_the_hauled_state():
    model = pl.Model(gravity=(0, 0, -GRAVITY))
    rope = model.add_cable(
        [(0, 0, 0), (0, 0, -5)],
        elements=1,
        strain="biot",
        rest_length=lambda factor: 5.0 - 3.0 * factor,
        **line(2.0e3, 1.0, 1e-6),
    )
    model.pin(rope.start)
    model.add_point_mass(3.0, at=rope.end)
    about = pl.solve_static(model)
    modes = pl.solve_modes(model, count=3, about=about)
    expected = np.sqrt(2.0e3 / 2.0 / 3.0) / (2 * np.pi)
    assert np.abs(modes.frequencies / expected - 1).min() < 1e-6


def swinging(rest_length, **options):
    """A damped rope that swings while it is hauled in."""
    model = pl.Model(gravity=(0, 0, -GRAVITY))
    material = pl.LinearElastic(1e6, 0.4, 1000.0, retardation_time=2e-2)
    rope = model.add_cable(
        [(0, 0, 0), (2, 0, 0)],
        elements=8,
        section=pl.Circle(1e-2),
        material=material,
        rest_length=rest_length,
        **options,
    )
    model.pin(rope.start)
    return model, rope


@pytest.mark.parametrize("options", [{}, {"tension_only": True}, {"strain": "biot", "integration": "full"}])
def test_balance_of_a_damped_swinging_rope(options):
    drift = []
    for step in (4e-3, 2e-3):
        model, _ = swinging(smooth(2.0, 1.3, 1.0), **options)
        energy = pl.simulate(model, duration=1.2, step=step).energy
        if not options.get("tension_only"):
            # Means over a step, which slack meets with kinks.
            assert np.all(np.diff(energy.dissipated) > -1e-6)
        drift.append(np.abs(energy.total - energy.total[0]).max())
    # Second order, of some joules; slack is passed with kinks.
    assert drift[0] / drift[1] > 3.0 or drift[1] < 1e-4
    assert drift[1] < 2e-2


def test_a_winch_set_by_an_input_is_one_given_by_its_values(tmp_path):
    """A controller that sets the values of a table goes its way; saved and loaded, with the same bits."""
    table = smooth(2.0, 1.3, 0.4)
    model, rope = swinging(table)
    given = pl.simulate(model, duration=0.5, step=2e-3)
    model, winched = swinging(pl.Input("winch", initial=2.0))
    stepper = pl.Stepper(model, step=2e-3, record_every=1)
    for k in range(1, 251):
        stepper.set_input("winch", float(table(2e-3 * k)[0]))
        stepper.advance()
        if k == 100:
            stepper.save(tmp_path / "half.h5")
    found = stepper.positions(winched)
    # Rates of an input are differences of second order: 1.1e-5 m, a quarter of that with half the step.
    assert np.allclose(found, given.positions(rope)[-1], atol=2e-5)
    again = pl.Stepper.load(tmp_path / "half.h5")
    for k in range(101, 251):
        again.set_input("winch", float(table(2e-3 * k)[0]))
        again.advance()
    assert np.array_equal(again.positions(winched), found)
    stepper.result.save(tmp_path / "result.h5")
    loaded = pl.Result.load(tmp_path / "result.h5")
    assert np.array_equal(loaded.axial_force(winched), stepper.result.axial_force(winched))
    # The table has what the input has not: exact rates; forces differ by the damping of that.
    assert np.allclose(given.axial_force(rope)[-1], loaded.axial_force(winched)[-1], rtol=1e-2, atol=1e-2)


def test_a_length_that_reaches_zero_is_told():
    model, _ = swinging(lambda t: 2.0 - 40.0 * t)
    with pytest.raises((pl.ConvergenceError, pl.ModelError), match=r"rest_length is .* must stay above zero"):
        pl.simulate(model, duration=0.1, step=1e-2)
