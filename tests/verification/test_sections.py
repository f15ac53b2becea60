"""Curved, tapered, slack and simplified cables against exact beams."""

import numpy as np
import pliant as pl
import pytest
from verification.cables import cantilever, line, orders, rubber_pendulum

# Tip errors of an independent implementation with |r''| as curvature, P L^2/EI = 2, n = 4, 8, 16: the
# model's own
# error of EI/(EA L^2) stays; beyond 1e6 it is as good as the exact measure.
SIMPLIFIED = {
    1e2: (0.010648933523847354, 0.010566294731222975, 0.010561837901218113),
    1e8: (0.00014228731048737366, 8.991377844646681e-06, 5.700807364676485e-07),
}
TIP = {1e2: (0.8448015260917109, 0.502280017410936), 1e8: (0.8393582791748327, 0.4934574803967118)}


@pytest.mark.parametrize("stiffness", SIMPLIFIED)
def test_simplified_bending_keeps_the_models_own_error(stiffness, record):
    for n, published in zip((4, 8, 16), SIMPLIFIED[stiffness], strict=True):
        model, arm = cantilever(n, stiffness, bending="simplified")
        model.add_force(arm.end, (0, 2, 0))
        tip = pl.solve_static(model, load_steps=4).track(arm.end).position[-1]
        error = np.hypot(tip[0] - TIP[stiffness][0], tip[1] - TIP[stiffness][1])
        name = f"simplified bending, tip error, EA = {stiffness:g}, {n} elements"
        assert record(name, error, published, 1e-8 + 1e-4 * published, "L")


def arc(angle: float) -> pl.Curve:
    """An arc of unit length that starts along x and turns to the left by ``angle``."""
    return pl.Curve(lambda s: (np.sin(angle * s) / angle, (1 - np.cos(angle * s)) / angle, 0.0), length=1.0)


def test_a_curved_line_is_stress_free_as_given(record):
    model = pl.Model()
    arm = model.add_cable(arc(np.pi / 2), elements=8, **line(1e6, 1.0))
    model.clamp(arm.start)
    result = pl.simulate(model, duration=0.1, step=1e-3, threads=1)
    motion = result.positions(arm) - result.positions(arm)[0]
    assert record("quarter arc left alone, motion", np.abs(motion).max(), 0.0, 1e-12, "m")
    assert record("quarter arc left alone, elastic energy", result.energy.elastic.max(), 0.0, 1e-15, "J")


@pytest.mark.parametrize("turn", [0.0, -np.pi / 2])
def test_an_end_moment_bends_an_arc_into_another_arc(turn, record):
    # Curvature adds up: a quarter arc under M = EI (turn - pi/2)/L ends as the arc of `turn`; -pi/2 passes
    # through
    # the straight line, where an unsigned curvature would fail.
    exact = np.array([1.0, 0.0]) if turn == 0 else np.array([np.sin(turn) / turn, (1 - np.cos(turn)) / turn])
    errors = []
    for n in (4, 8, 16):
        model = pl.Model()
        arm = model.add_cable(arc(np.pi / 2), elements=n, **line(1e4, 1.0))
        model.clamp(arm.start)
        model.add_moment(arm.end, (0, 0, turn - np.pi / 2))
        tip = pl.solve_static(model, load_steps=4).track(arm.end).position[-1]
        errors.append(np.hypot(*(tip[:2] - exact)))
    assert record(f"quarter arc bent to {turn:.3g} rad, tip, 16 elements", errors[-1], 0.0, 1e-6, "L")
    assert np.all(orders(errors) > 3.5)


@pytest.mark.parametrize("integration", ["lobatto", "full"])
def test_a_tapered_cantilever_bends_as_the_integral_of_its_compliance(integration, record):
    # Radius from 10 mm to 5 mm, small tip load: w = int_0^L P (L - x)^2/(E I(x)) dx, in closed form for a
    # cone.
    young, length, force = 1e9, 1.0, 1e-3
    first, last = 10e-3, 5e-3

    def section(s):
        return pl.Circle(first + (last - first) * s / length)

    x = np.linspace(0, length, 200_001)
    inertia = np.pi / 4 * (first + (last - first) * x / length) ** 4
    exact = np.trapezoid(force * (length - x) ** 2 / (young * inertia), x)
    errors = []
    for n in (4, 8, 16):
        model = pl.Model()
        arm = model.add_cable(
            [(0, 0, 0), (length, 0, 0)],
            elements=n,
            section=section,
            material=pl.LinearElastic(young, 0.3, 1000.0),
            integration=integration,
        )
        model.clamp(arm.start)
        model.add_force(arm.end, (0, 0, -force))
        tip = pl.solve_static(model).track(arm.end).position[-1]
        errors.append(abs(-tip[2] / exact - 1))
    # Three Gauss points on a cubic element: fourth order in this smooth taper.
    assert record(
        f"tapered cantilever, {integration}, relative deflection, 16 elements", errors[-1], 0.0, 5e-6
    )
    assert orders(errors)[-1] > 3.5
    mass = np.pi * 1000.0 * (first**2 + first * last + last**2) / 3 * length
    weight = pl.Model(gravity=(0, 0, -10.0))
    hung = weight.add_cable(
        [(0, 0, 0), (0, 0, -length)],
        elements=8,
        section=section,
        material=pl.LinearElastic(young, 0.3, 1000.0),
    )
    pin = weight.pin(hung.start)
    reaction = pl.solve_static(weight).reaction(pin).force[-1]
    # Masses are integrated with five Gauss points: exact for a cone.
    assert record("weight of a cone", reaction[2], 10.0 * mass, 1e-9, "N")


def test_a_tension_only_line_pulls_but_does_not_push(record):
    stiffness = 1e4

    def end_force(move: float) -> float:
        model = pl.Model()
        thread = model.add_cable(
            [(0, 0, 0), (1, 0, 0)],
            elements=4,
            strain="biot",
            tension_only=True,
            **line(stiffness, 1e-3),
        )
        model.pin(thread.start)
        spot = model.add_point_mass(1.0, at=thread.end)
        model.add_force(spot.center, (move, 0, 0))
        model.pin(thread.end)
        return pl.solve_static(model).axial_force(thread)[-1].mean()

    # Held at both ends, nothing moves: a thread at its length carries nothing.
    assert record("thread at its length, axial force", end_force(1.0), 0.0, 1e-6, "N")
    for stretch, exact in ((1.01, stiffness * 0.01), (0.99, -1e-4 * stiffness * 0.01)):
        model = pl.Model()
        thread = model.add_cable(
            [(0, 0, 0), (stretch, 0, 0)],
            elements=4,
            rest_length=1.0,
            strain="biot",
            tension_only=True,
            **line(stiffness, 1e-3),
        )
        model.pin(thread.start)
        model.pin(thread.end)
        result = pl.simulate(model, duration=1e-3, step=1e-3, threads=1)
        # The slack law is smoothed over a strain of 1e-6: EA d/2 = 5e-3 N.
        name = f"thread stretched to {stretch:g}, axial force"
        assert record(name, result.axial_force(thread)[0].mean(), exact, 6e-3, "N")


def test_an_explicit_integration_of_eight_elements_and_the_step(record):
    # The same 8-element pendulum (there with two-point bending) by Runge-Kutta of order 8; errors of an
    # independent generalized-alpha at rho = 0.9 against it.
    exact = (0.7998630030708856, -0.4236994721062359)
    published = {2e-3: 2.9127231087849503e-05, 1e-3: 1.1855618696855642e-05, 5e-4: 4.874387882726471e-06}
    for step, error in published.items():
        model, cable = rubber_pendulum(8)
        steps = round(0.3 / step)
        result = pl.simulate(
            model, duration=0.3, step=step, spectral_radius=0.9, output_every=steps, threads=1
        )
        tip = result.track(cable.end).position[-1]
        achieved = np.hypot(tip[0] - exact[0], tip[1] - exact[1])
        # Unresolved axial waves: the start decides over a factor of two; the bending rules differ by 1.2e-6.
        name = f"eight elements, h = {1e3 * step:g} ms, tip error"
        assert record(name, achieved, 0.0, 2 * error + 1.2e-6, "m")
