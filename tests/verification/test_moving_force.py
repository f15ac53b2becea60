"""A force that moves along a line."""

import numpy as np
import pliant as pl
from verification.cables import line

LENGTH, STIFFNESS, MASS, FORCE, SPEED = 1.0, 1.0, 1.0, 1e-3, 1.2


def beam(elements: int):
    model = pl.Model()
    span = model.add_cable([(0, 0, 0), (LENGTH, 0, 0)], elements=elements, **line(1e4, STIFFNESS, MASS))
    model.pin(span.start)
    model.pin(span.end)
    return model, span


def closed_form(x, t):
    """Deflection of a simply supported beam under a constant force at x = SPEED t: the modal series."""
    w = np.zeros_like(t)
    for n in range(1, 60):
        omega = (n * np.pi / LENGTH) ** 2 * np.sqrt(STIFFNESS / MASS)
        big = n * np.pi * SPEED / LENGTH
        share = np.sin(big * t) - big / omega * np.sin(omega * t)
        w += 2 * FORCE / (MASS * LENGTH) / (omega**2 - big**2) * share * np.sin(n * np.pi * x / LENGTH)
    return w


def test_beam_under_a_moving_force(record):
    model, span = beam(16)
    model.add_moving_force(span, (0, 0, -FORCE), lambda t: SPEED * t)
    result = pl.simulate(model, duration=LENGTH / SPEED, step=1e-3)
    for node in (4, 8, 12):
        x = node / 16
        exact = closed_form(x, result.time)
        error = np.abs(-result.positions(span)[:, node, 2] - exact).max() / np.abs(exact).max()
        # Second order in time, 160 steps a period of the second mode; the span stretches by 1e-4.
        assert record(f"beam under a moving force, x = {x:g}", error, 0.0, 2e-3, source="modal series")
    energy = result.energy
    assert np.abs(energy.total).max() < 1e-3 * np.abs(energy.work).max()


def test_elsewhere_there_is_no_force():
    model, span = beam(4)
    model.add_moving_force(span, (0, 0, -FORCE), lambda t: SPEED * t - 0.1 if t < 0.05 else 1.01)
    result = pl.simulate(model, duration=0.1, step=1e-2)
    assert np.abs(result.positions(span)[:, :, 2]).max() < 1e-12


def test_statics_place_the_force_at_the_load_factor():
    """A weightless string under tension carries a force by two straight pieces."""
    model = pl.Model()
    string = model.add_cable(
        [(0, 0, 0), (4, 0, 0)], elements=8, pretension=100.0, strain="biot", **line(1e4, 1e-6)
    )
    left, right = model.pin(string.start), model.pin(string.end)
    model.add_moving_force(string, (0, 0, -1.0), string.length / 4)
    result = pl.solve_static(model)
    # The lever rule; the force moves by the strain along the string.
    assert np.isclose(result.reaction(left).force[-1, 2], 0.75, rtol=1e-4)
    assert np.isclose(result.reaction(right).force[-1, 2], 0.25, rtol=3e-4)
