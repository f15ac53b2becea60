"""Flow across lines: terminal velocity, shapes in a current, galloping."""

import numpy as np
import pliant as pl
import pytest
from scipy.integrate import solve_ivp
from verification.cables import line

GRAVITY, DENSITY, DRAG = 9.81, 1.2, 1.1


def rope(model, points, elements=8, **options):
    material = pl.LinearElastic(youngs_modulus=1e8, poisson_ratio=0.3, density=1000.0)
    return model.add_cable(points, elements=elements, section=pl.Circle(5e-3), material=material, **options)


def test_a_rope_that_falls_broadside(record):
    """Velocity v_T tanh(g t/v_T), with the weight rho_w A g = rho/2 C_D D v_T^2."""
    model = pl.Model(gravity=(0, 0, -GRAVITY))
    line_ = rope(model, [(0, 0, 0), (2, 0, 0)])
    model.add_wind(line_, (0, 0, 0), DENSITY, DRAG)
    result = pl.simulate(model, duration=8.0, step=1e-2)
    terminal = np.sqrt(1000.0 * np.pi * 25e-6 * GRAVITY / (0.5 * DENSITY * DRAG * 1e-2))
    speed = -result.velocities(line_)[:, :, 2]
    exact = terminal * np.tanh(GRAVITY * result.time / terminal)
    assert record("falling rope, final velocity", speed[-1].mean(), exact[-1], 1e-4, "m/s", source="tanh")
    # Second order, 100 steps a second.
    assert np.abs(speed - exact[:, None]).max() < 1e-3
    energy = result.energy
    assert np.allclose(energy.total, energy.total[0], atol=1e-3 * energy.dissipated[-1])
    # Air at rest does no work.
    assert np.all(np.diff(energy.dissipated) > 0)
    assert np.abs(energy.work).max() < 1e-3 * energy.dissipated[-1]


@pytest.mark.parametrize("strain", ["green_lagrange", "biot"])
def test_towed_line_in_a_current(strain, record):
    """A line with a weight at its lower end in a uniform flow: N' = -(weight + drag) from the lower end."""
    length, mass, load, ea, flow = 20.0, 0.08, 2.0, 5.0e4, np.array([9.0, 0.0, 0.0])
    model = pl.Model(gravity=(0, 0, -GRAVITY))
    data = line(ea, 1e-4, mass)
    section = pl.Section(ea, (1e-4, 1e-4), torsion_constant=1e-4, radius=0.01)
    towed = model.add_cable(
        [(0, 0, 0), (0, 0, -length)], elements=20, strain=strain, **{**data, "section": section}
    )
    model.pin(towed.start)
    model.add_point_mass(load, at=towed.end)
    model.add_wind(towed, flow, DENSITY, DRAG)
    result = pl.solve_static(model, load_steps=4)

    def rates(s, state):
        pull = state[:3]
        tension = np.linalg.norm(pull)
        t = pull / tension
        across = flow - t * (t @ flow)
        drag = 0.5 * DENSITY * DRAG * 0.02 * np.linalg.norm(across) * across
        stretch = 1 + tension / ea
        return np.concatenate([mass * GRAVITY * np.array([0, 0, 1.0]) - drag * stretch, t * stretch])

    start = np.concatenate([load * GRAVITY * np.array([0, 0, 1.0]), np.zeros(3)])
    exact = solve_ivp(rates, (0, length), start, rtol=1e-10, atol=1e-12)
    end = -exact.y[3:, -1]
    found = result.positions(towed)[-1, -1]
    # The bending stiffness turns the end over sqrt(EI/T) = 2 mm; strains of 1e-3 differ by their squares.
    for k, name in ((0, "drift"), (2, "depth")):
        assert record(f"towed line ({strain}), {name}", found[k], end[k], 2e-3, "m", source="solve_ivp")


def test_galloping_by_den_hartog(record):
    """A line that moves across the wind feels the damping rho U D/2 (C_D + dC_L/dalpha)."""
    speed, flow, slope = 1e-3, 10.0, -3.0
    model = pl.Model()
    wire = rope(model, [(0, 0, 0), (2, 0, 0)], velocity=(0, 0, speed))
    model.add_wind(wire, (0, flow, 0), DENSITY, DRAG, lift=lambda alpha: slope * np.sin(alpha))
    result = pl.simulate(model, duration=1e-3, step=1e-3)
    found = result.track(wire.at(1.0)).acceleration[0, 2]
    expected = -0.5 * DENSITY * flow * 1e-2 * (DRAG + slope) * speed / (1000.0 * np.pi * 25e-6)
    # Second order in speed over flow, and the table's cubics.
    assert record(
        "galloping, acceleration across the wind", found, expected, 1e-6, "m/s^2", source="Den Hartog"
    )


def test_balance_of_a_line_in_gusts():
    drift = []
    for step in (8e-3, 4e-3):
        model = pl.Model(gravity=(0, 0, -GRAVITY))
        wire = rope(model, [(0, 0, 0), (2, 0, 0)])
        model.pin(wire.start)
        model.pin(wire.end)
        model.add_wind(wire, lambda t: (0, 20 * np.sin(3 * t), 2.0), DENSITY, DRAG, lift=0.4)
        energy = pl.simulate(model, duration=1.0, step=step).energy
        assert np.all(np.diff(energy.dissipated) >= 0)
        drift.append(np.abs(energy.total - energy.total[0]).max())
    # Second order, of about a joule.
    assert drift[0] / drift[1] > 3.0
    assert drift[1] < 1e-2
