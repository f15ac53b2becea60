"""Points that slide along cables and lines: closed forms, order, energy, the path's end."""

import numpy as np
import pliant as pl
import pytest
from scipy.integrate import solve_ivp

G = 9.81
STEEL = pl.LinearElastic(youngs_modulus=2e11, poisson_ratio=0.3, density=7850.0)
RUBBER = pl.LinearElastic(youngs_modulus=1e7, poisson_ratio=0.45, density=1000.0)


def test_bead_on_a_rotating_line(record):
    # A rotor about z with a bead on a spoke: r'' = r w^2 with (J + m r^2) w constant.
    inertia, mass, start, spin, end = 0.5, 2.0, 0.3, 3.0, 0.5
    momentum = (inertia + mass * start**2) * spin

    def rate(_, y):
        w = momentum / (inertia + mass * y[0] ** 2)
        return y[1], y[0] * w**2, w

    exact = solve_ivp(rate, (0, end), (start, 0, 0), rtol=1e-12, atol=1e-12).y[:, -1]
    errors = []
    for step in (4e-3, 2e-3):
        model = pl.Model()
        hub = model.add_rigid_body(mass=1.0, inertia=(0.4, 0.4, inertia), angular_velocity=(0, 0, spin))
        axle = model.hinge(hub.center)
        bead = model.add_rigid_body(
            mass=mass, inertia=(0.1, 0.1, 0.1), position=(start, 0, 0), velocity=(0, start * spin, 0)
        )
        spoke = model.slide_along(bead, pl.Line(hub, (1, 0, 0)))
        result = pl.simulate(model, duration=end, step=step, threads=1)
        got = (
            result.joint(spoke).position[-1],
            result.joint(spoke).velocity[-1],
            result.joint(axle).position[-1],
        )
        errors.append(np.abs(np.subtract(got, exact)).max())
    assert errors[-1] < 1e-4
    assert record("bead on a rotating line, order", np.log2(errors[0] / errors[1]), 2.0, 0.2)
    momenta = result.angular_momentum[:, 2]
    # Turned by the scheme's error of second order.
    assert record("bead on a rotating line, angular momentum", momenta, np.full_like(momenta, momentum), 1e-4)
    # The force on the bead is normal to the spoke: m (2 r' w + r w').
    w = momentum / (inertia + mass * exact[0] ** 2)
    dw = -2 * mass * exact[0] * exact[1] * momentum / (inertia + mass * exact[0] ** 2) ** 2
    size = np.linalg.norm(result.reaction(spoke).force[-1])
    assert record(
        "bead on a rotating line, force", size, mass * (2 * exact[1] * w + exact[0] * dw), 1e-2, "N"
    )


def ring(elements, angle=-2.0):
    """A bead on half a ring of radius 1 m, every node of which is held: a pendulum."""
    model = pl.Model(gravity=(0, 0, -G))
    arc = pl.Curve(lambda s: (np.cos(s - np.pi), 0.0, np.sin(s - np.pi)), length=np.pi)
    wire = model.add_cable(arc, elements=elements, section=pl.Circle(5e-3), material=STEEL)
    for i in range(elements + 1):
        model.clamp(wire.node(i))
    place = model._position(wire.at(np.pi + angle))
    bead = model.add_point_mass(0.5, at=place)
    slide = model.slide_along(bead, wire)
    return model, wire, bead, slide, place


def test_bead_on_a_ring_is_a_pendulum(record):
    end, angle = 1.2, -2.0
    exact = solve_ivp(
        lambda _, y: (y[1], -G * np.cos(y[0])), (0, end), (angle, 0.0), rtol=1e-12, atol=1e-12
    ).y[:, -1]
    errors = []
    for step in (8e-3, 4e-3):
        model, _, bead, slide, _ = ring(48)
        assert model.constraints == 49 * 5 + 3
        result = pl.simulate(model, duration=end, step=step, threads=1)
        # The arc length crosses several elements; slopes of clamped nodes are those of the ring.
        s = result.joint(slide).position
        errors.append(abs(s[-1] - (exact[0] + np.pi)))
    assert np.ptp(s) > 0.8
    # Fourth order in space: 48 elements leave 3e-7.
    assert errors[-1] < 1e-4
    assert record("bead on a ring, order", np.log2(errors[0] / errors[1]), 2.0, 0.3)
    centre = result.track(bead.center)
    force = result.reaction(slide).force[-1]
    speed = np.linalg.norm(centre.velocity[-1])
    # Towards the centre: m v^2 / R + m g sin; the ring's elements are cubic, their curvature of second order.
    expected = 0.5 * (speed**2 - G * np.sin(exact[0]))
    assert record("bead on a ring, force", np.linalg.norm(force), expected, 0.03, "N")
    assert np.ptp(result.energy.total) < 2e-3


def hanging(elements=16):
    model = pl.Model(gravity=(0, 0, -G))
    wire = model.add_cable(
        [(0, 0, 0), (1, 0, -0.3)],
        elements=elements,
        section=pl.Circle(5e-3),
        material=RUBBER,
    )
    model.pin(wire.start)
    model.pin(wire.end)
    bead = model.add_point_mass(0.05, at=model._position(wire.at(0.25)))
    return model, wire, bead, model.slide_along(bead, wire)


def test_bead_on_a_hanging_wire_keeps_energy_and_does_not_rub(record):
    model, wire, bead, slide = hanging()
    ranges = []
    for step in (2e-3, 1e-3):
        result = pl.simulate(model, duration=0.4, step=step, threads=1)
        ranges.append(np.ptp(result.energy.total))
    s = result.joint(slide).position
    assert np.ptp(s) > 0.15
    # Of 0.04 J that change hands; second order.
    assert ranges[-1] < 2e-5
    assert record("bead on a hanging wire, order of the energy", np.log2(ranges[0] / ranges[1]), 2.0, 0.2)
    force = result.reaction(slide).force
    for i in (50, 150, 300):
        at = result.track(wire.at(s[i] - 1e-4)).position[i], result.track(wire.at(s[i] + 1e-4)).position[i]
        tangent = (at[1] - at[0]) / np.linalg.norm(at[1] - at[0])
        # Newton's tolerance; the difference of places tells the tangent to 1e-8.
        assert abs(force[i] @ tangent) < 1e-5 * np.linalg.norm(force[i])
        middle = result.track(wire.at(s[i])).position[i]
        assert record("bead on its wire", result.track(bead.center).position[i], middle, 1e-9, "m")


def test_bead_comes_to_rest_at_the_lowest_point():
    model = pl.Model(gravity=(0, 0, -G))
    wire = model.add_cable(
        [(0, 0, 0), (1, 0, 0)], elements=12, section=pl.Circle(5e-3), material=RUBBER, pretension=5.0
    )
    model.pin(wire.start)
    model.pin(wire.end)
    bead = model.add_point_mass(0.2, at=(0.4, 0, 0))
    slide = model.slide_along(bead, wire)
    result = pl.solve_static(model)
    # In the middle, up to what elements of 0.1 m make of the kink below the bead.
    assert result.joint(slide).position[-1] == pytest.approx(0.5 * wire.length, abs=0.01)
    np.testing.assert_allclose(result.reaction(slide).force[-1], (0, 0, 0.2 * G), atol=1e-6)


def test_the_end_of_the_cable_is_told(record):
    fast = pl.Model(gravity=(0, 0, 0))
    wire = fast.add_cable([(0, 0, 0), (1, 0, 0)], elements=4, section=pl.Circle(5e-3), material=STEEL)
    for i in range(5):
        fast.clamp(wire.node(i))
    bead = fast.add_rigid_body(mass=1.0, shape=pl.Sphere(0.01), position=(0.4, 0, 0), velocity=(1.0, 0, 0))
    slide = fast.slide_along(bead, wire)
    with pytest.raises(pl.ConvergenceError, match=r"joint 'slide1': its point has come to the end") as caught:
        pl.simulate(fast, duration=1.0, step=0.01, threads=1)
    result = caught.value.result
    # 0.6 m at 1 m/s; what was computed up to there is kept.
    assert result.time[-1] == pytest.approx(0.6, abs=0.011)
    assert record(
        "bead on a straight wire", result.joint(slide).position[-1], 0.4 + result.time[-1], 1e-9, "m"
    )
