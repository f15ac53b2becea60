"""Small motions about loaded states: flutter, damping, buckling, pendulums."""

import numpy as np
import pliant as pl
import pytest
from verification.cables import cantilever, line


def pushed(load: float, elements: int = 12, **options):
    model, arm = cantilever(elements, 1e6)
    model.add_force(arm.end, (-load, 0, 0), **options)
    state = pl.solve_static(model, stable=False)
    return pl.solve_modes(model, count=4, about=state)


def test_becks_column_flutters(record):
    # The two lowest frequencies in each of two planes meet: the square of the difference of their squares
    # vanishes with the distance from the load, 20.05 EI/L^2.
    loads = np.array([19.7, 19.8, 19.9])
    gaps, mean = [], []
    for load in loads:
        modes = pushed(load, follower=True)
        assert modes.stable
        squares = np.unique(np.round((2 * np.pi * modes.frequencies) ** 2, 5))
        gaps.append((squares[-1] - squares[0]) ** 2)
        mean.append(0.5 * (squares[-1] + squares[0]))
    roots = np.roots(np.polyfit(loads, gaps, 2))
    flutter = float(roots[np.argmin(abs(roots - 20))])
    omega = np.sqrt(np.polyval(np.polyfit(loads, mean, 2), flutter))
    # The published figures have four digits.
    assert record("Beck's column, flutter load", flutter, 20.05, 0.01, "EI/L^2", source="Beck 1952")
    assert record("Beck's column, frequency", omega, 11.02, 0.01, "sqrt(EI/m)/L^2", source="Bolotin 1963")
    above = pushed(20.2, follower=True)
    assert not above.stable
    assert above.eigenvalues.real.max() > 0.1
    # Flutter, not divergence: it swings as it grows.
    assert abs(above.eigenvalues[np.argmax(above.eigenvalues.real)].imag) > 10


@pytest.mark.filterwarnings("ignore:the equilibrium is unstable")
def test_a_dead_load_stops_the_lowest_frequency(record):
    # Clamped strut: omega^2 falls with the load, nearly straight, to zero at Euler's load.
    euler = np.pi**2 / 4
    loads = np.array([0.997, 0.998, 0.999])
    squares = [(2 * np.pi * pushed(load * euler).frequencies[0]) ** 2 for load in loads]
    zero = np.roots(np.polyfit(loads, squares, 1))[0]
    assert record("strut, load at which it stops swinging", zero, 1.0, 2e-5, "of Euler's")
    assert not pushed(1.01 * euler).stable


def test_kelvin_voigt_damping(record):
    # Of each mode zeta = omega tau / 2.
    tau = 1e-3
    data = line(1e6, 1.0)
    data["material"] = pl.LinearElastic(1.0, 0.3, 1e-6, retardation_time=tau)
    found = []
    for elements in (10, 40):
        model = pl.Model()
        arm = model.add_cable([(0, 0, 0), (1, 0, 0)], elements=elements, **data)
        model.clamp(arm.start)
        modes = pl.solve_modes(model, count=6)
        assert modes.stable
        found.append(modes)
        size = np.abs(modes.eigenvalues)
        assert record("damped beam, damping ratios", modes.damping_ratios, size * tau / 2, 1e-8)
    # Lowest of the clamped beam, 1.8751^2; fourth order in the mesh.
    assert record("damped beam, omega", size[:2], [3.51602, 3.51602], 1e-4, "1/s")
    # 40 elements are solved by Arnoldi's method, 10 densely.
    coarse = np.abs(found[0].eigenvalues)
    assert record("damped beam, both solvers", size[:4], coarse[:4], 1e-3, "1/s")


def rod(direction: float):
    model = pl.Model(gravity=(0, 0, -9.81))
    body = model.add_rigid_body(mass=2.0, inertia=(0.1, 0.1, 0.1), position=(0, 0, direction * 0.5))
    pin = model.hinge(body.at((0, 0, -direction * 0.5)), axis=(0, 1, 0))
    return model, body, pin


@pytest.mark.filterwarnings("ignore:the equilibrium is unstable")
def test_pendulum_and_inverted_pendulum(record):
    # omega^2 = m g l / (I + m l^2); the hinge's force acts through its own stiffness.
    square = 2.0 * 9.81 * 0.5 / (0.1 + 2.0 * 0.25)
    for direction, stable in ((-1, True), (1, False)):
        model, _, _ = rod(direction)
        state = pl.solve_static(model, stable=False)
        modes = pl.solve_modes(model, count=1, about=state)
        assert modes.stable == stable
        # A problem of one freedom: rounding.
        got = -(modes.eigenvalues[0] ** 2).real
        assert record(f"pendulum {direction:+d}, omega^2", got, -direction * square, 1e-8, "1/s^2")


def test_a_body_that_floats_free_is_neither_stable_nor_lost():
    data = line(1e4, 1.0)
    data["material"] = pl.LinearElastic(1.0, 0.3, 1e-4, retardation_time=1e-3)
    model = pl.Model()
    model.add_cable([(0, 0, 0), (1, 0, 0)], elements=6, **data)
    modes = pl.solve_modes(model, count=8)
    # Three translations, two rotations (a line has no twist); then free-free bending, 22.37.
    assert np.abs(modes.eigenvalues[:5]).max() < 1e-2
    np.testing.assert_allclose(np.abs(modes.eigenvalues[5:7]), 22.373, rtol=2e-3)
    assert modes.stable
