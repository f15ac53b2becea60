"""Steps chosen by an error tolerance: errors at the end against independent integrations."""

import numpy as np
import pliant as pl
from scipy.integrate import solve_ivp
from verification.cables import line, rubber_pendulum
from verification.test_rigid_bodies import HEAVY_TOP, heavy_top


def power(tolerances, errors) -> float:
    """Exponent of the error over the tolerance."""
    return float(np.polyfit(np.log(tolerances), np.log(errors), 1)[0])


def test_heavy_top(record):
    tolerances = np.array([1e-6, 1e-7, 1e-8, 1e-9])
    errors = []
    for rtol in tolerances:
        model, top = heavy_top()
        result = pl.simulate(model, duration=0.1, step="auto", rtol=rtol, spectral_radius=0.9, threads=1)
        errors.append(np.linalg.norm(result.track(top.center).position[-1] - HEAVY_TOP[0.1]))
        assert result.time[-1] == 0.1
    # Steps change by a third at once: over three decades the exponent is uncertain by hundredths.
    assert record("heavy top, power of the tolerance", power(tolerances, errors), 2 / 3, 0.06)
    # A thousand steps of a local error of 1e-9 of 0.5 m.
    assert record("heavy top at rtol 1e-9, error of the centre", errors[-1], 0.0, 2e-6, "m")


def hardening(amplitude=0.5, axial_stiffness=400.0):
    """A mass between two lines without stress when straight: x'' = -EA x^3 with Green's strain."""
    model = pl.Model()
    data = line(axial_stiffness, 1e-7, mass=1e-7)
    sides = [
        model.add_cable([(end, 0, 0), (0, amplitude, 0)], elements=1, rest_length=1.0, **data)
        for end in (-1, 1)
    ]
    for side in sides:
        model.pin(side.start)
    model.pin(sides[0].end, sides[1].end)
    model.add_point_mass(1.0, at=sides[0].end)
    return model, sides[0].end


def test_stiffness_that_changes(record):
    # The frequency goes from nothing to 10 rad/s within each swing.
    tolerances = np.array([1e-5, 1e-6, 1e-7, 1e-8])
    exact = solve_ivp(
        lambda _, y: (y[1], -400.0 * y[0] ** 3), (0, 2), (0.5, 0.0), method="DOP853", rtol=1e-12, atol=1e-12
    ).y[:, -1]
    errors = []
    for rtol in tolerances:
        model, middle = hardening()
        result = pl.simulate(model, duration=2.0, step="auto", rtol=rtol, threads=1)
        track = result.track(middle)
        errors.append([abs(track.position[-1, 1] - exact[0]), abs(track.velocity[-1, 1] - exact[1])])
        # Lines far too stiff and light for the step do not drive it: a step errs by |c| h^3 j, so that 2 s of
        # motion at (12 rad/s)^3 x 0.5 m take about 2 (0.09 x 860 / rtol)^(1/3) steps.
        assert result.statistics.steps < 3 * 2 * (0.09 * 860 / rtol) ** (1 / 3)
    # As above; the errors of position and velocity swap signs with the phase.
    errors = np.array(errors)
    assert record("hardening spring, power in position", power(tolerances, errors[:, 0]), 2 / 3, 0.08)
    assert record("hardening spring, power in velocity", power(tolerances, errors[:, 1]), 2 / 3, 0.08)


def struck_cable():
    """A falling cable that is hit for 5 ms."""
    model, cable = rubber_pendulum(12, retardation_time=2e-3)
    blow = pl.Table([0.2, 0.2025, 0.205], [(0, 0, 0), (0, 40, 10), (0, 0, 0)])
    model.add_force(cable.at(0.5), blow)
    return model, cable


def test_a_blow_on_a_cable(record):
    grid = np.linspace(0.1, 0.4, 4)

    def run(**steps):
        model, cable = struck_cable()
        result = pl.simulate(model, duration=0.4, output_times=grid, threads=1, **steps)
        return result, result.track(cable.at(0.5)).position

    reference = run(step=2e-5)[1]
    tolerances = np.array([1e-5, 1e-6, 1e-7])
    errors, steps = [], []
    for rtol in tolerances:
        result, position = run(step="auto", rtol=rtol)
        assert np.array_equal(result.time, grid)
        errors.append(np.abs(position - reference).max())
        steps.append(result.statistics.steps)
    # A few points of a blow of 5 ms: the power is a rough one.
    assert record("blow on a cable, power of the tolerance", power(tolerances, errors), 2 / 3, 0.25)
    # Equal steps of the same number resolve the blow by a handful of steps.
    equal = np.abs(run(step=0.4 / steps[0])[1] - reference).max()
    assert record("blow on a cable, error against equal steps", min(errors[0] / equal, 1.0), 0.0, 0.7)


def test_kinks_are_met():
    model, _ = struck_cable()
    result = pl.simulate(model, duration=0.4, step="auto", rtol=1e-4, threads=1)
    assert {0.2, 0.2025, 0.205} <= set(result.time.tolist())


def test_kinks_are_met_wherever_values_are_given():
    """Of torques, tensions, lengths, places of moving forces, wind, rates and courses."""

    def table(time):
        return pl.Table([0.0, time / 2, time, 1.0], [1.0, 1.0, 1.1, 1.1])

    model, cable = rubber_pendulum(4)
    model.add_moving_force(cable, (0, 0, -0.1), table(0.11))
    model.add_wind(cable, (1, 0, 0) * table(0.12), density=1.2, drag=1.0)
    ball = pl.Sphere(0.1)
    wheels = [model.add_rigid_body(mass=1.0, shape=ball, position=(k, 2, 0)) for k in range(3)]
    shafts = [model.hinge(wheel.center) for wheel in wheels]
    model.drive(shafts[0], torque=table(0.13))
    model.drive(shafts[1], rate=table(0.14) - 1.0)
    model.drive(shafts[2], angle=pl.Ramp(0.15))
    balls = [model.add_point_mass(1.0, at=(k, 4, 0)) for k in range(3)]
    model.add_tendon([(0, 5, 0), balls[0]], table(0.16))
    model.add_tendon([(1, 5, 0), balls[1]], length=table(0.17), stiffness=10.0)
    model.drive(balls[2].center, position=np.array([2, 4, 0]) + np.array([1, 0, 0]) * pl.Ramp(0.18))
    rubber = pl.LinearElastic(youngs_modulus=1e6, poisson_ratio=0.4, density=1000.0)
    section = pl.Circle(5e-3)
    model.add_cable(
        [(0, 6, 0), (1, 6, 0)], elements=1, section=section, material=rubber, rest_length=table(0.19)
    )
    result = pl.simulate(model, duration=0.25, step="auto", rtol=1e-3, threads=1)
    assert {0.11, 0.12, 0.13, 0.14, 0.15, 0.16, 0.17, 0.18, 0.19} <= set(result.time.tolist())
