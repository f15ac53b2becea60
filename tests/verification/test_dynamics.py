"""Falling and flying cables against independent integrations: orders, momentum, energy."""

import numpy as np
import pliant as pl
import pytest
from verification.cables import line, orders, rubber_pendulum, soft_pendulum

# Tip (x, y) of the rubber pendulum: 128 elements, explicit Runge-Kutta of order 8, time error below 1e-7;
# Biot: the same with 64 elements.
RUBBER = {
    ("green_lagrange", 0.3): (0.7998767083, -0.4237366905, 2e-7),
    ("green_lagrange", 1.0): (-0.9624218045, 0.0420778240, 2e-6),
    ("biot", 0.3): (0.7998774540, -0.4237365019, 4e-7),
    ("biot", 1.0): (-0.9624300848, 0.0420580847, 4e-6),
}
# The soft pendulum without damping: positions trusted to the third number.
SOFT = {
    ("green_lagrange", 0.3): (1.0742803363, -0.4412743133, 4e-6),
    ("green_lagrange", 0.6): (-0.3646893541, -1.2041724531, 2e-5),
    ("biot", 0.3): (1.0787376427, -0.4412617425, 4e-6),
    ("biot", 0.6): (-0.3348864500, -1.2515682000, 2e-5),
}


def tip_after(model: pl.Model, point, duration: float, step: float, **options):
    """Position of a point at the end, its velocity, and the result."""
    steps = round(duration / step)
    result = pl.simulate(model, duration=duration, step=step, output_every=steps, threads=1, **options)
    track = result.track(point)
    return track.position[-1], track.velocity[-1], result


@pytest.mark.parametrize(("strain", "time"), RUBBER)
def test_the_rubber_pendulum_agrees_with_explicit_integration(strain, time, record):
    x, y, trusted = RUBBER[strain, time]
    model, cable = rubber_pendulum(64, strain=strain)
    tip, _, _ = tip_after(model, cable.end, time, 5e-5, spectral_radius=0.9)
    # Mesh of 64 elements: 1e-6; second order in time: 4e-7 at 0.3 s, growing with the swing.
    tolerance = trusted + {0.3: 1.5e-6, 1.0: 2e-5}[time]
    assert record(f"rubber pendulum, {strain}, tip at {time:g} s", tip[:2], (x, y), tolerance, "m")


@pytest.mark.parametrize(("strain", "time"), SOFT)
def test_the_soft_pendulum_tells_the_strain_measures_apart(strain, time, record):
    x, y, trusted = SOFT[strain, time]
    model, cable = soft_pendulum(64, strain=strain)
    tip, _, _ = tip_after(model, cable.end, time, 5e-5, spectral_radius=0.9)
    # Undamped axial waves steepen; 64 elements resolve them to the order of the trust itself.
    assert record(f"soft pendulum, {strain}, tip at {time:g} s", tip[:2], (x, y), trusted + 3e-5, "m")


def test_the_damped_soft_pendulum(record):
    # Kelvin-Voigt, 5 ms: (x, y, v_x, v_y) at 0.3 s and 1.0 s; 96 elements, explicit integration. The
    # reference
    # damps bending by the scalar rate of curvature, smoothed below 0.01/m; in a plane ours has the same power
    # but for that smoothing.
    exact = {
        0.3: (1.07278143, -0.44145115, -1.58274361, -2.94243326),
        1.0: (-1.18072358, -0.15771332, 1.09101180, 2.96826452),
    }
    for time, values in exact.items():
        model, cable = soft_pendulum(48, retardation_time=5e-3)
        tip, velocity, _ = tip_after(model, cable.end, time, 1e-4, spectral_radius=0.9)
        name = f"soft pendulum, 5 ms Kelvin-Voigt, at {time:g} s"
        assert record(f"{name}, position", tip[:2], values[:2], 3e-5, "m")
        assert record(f"{name}, velocity", velocity[:2], values[2:], 1e-3, "m/s")


def test_a_cable_pendulum_is_second_order_in_position_velocity_and_reaction(record):
    # Smooth motion (damped stiff modes): errors against a step 16 times smaller, same mesh.
    def run(step):
        model, cable = soft_pendulum(8, retardation_time=5e-3)
        position, velocity, result = tip_after(model, cable.end, 0.4, step)
        return position, velocity, result.reaction(model.joints[0]).force[-1]

    reference = run(0.4 / 6400)
    errors = np.array(
        [
            [np.linalg.norm(x - y) for x, y in zip(run(0.4 / n), reference, strict=True)]
            for n in (100, 200, 400)
        ]
    )
    achieved = orders(errors[1:])[0] if errors.ndim == 1 else np.log2(errors[1] / errors[2])
    for name, order in zip(("position", "velocity", "reaction"), achieved, strict=True):
        assert record(f"order in time of the {name}, cable pendulum", order, 2.0, 0.15)


def flying_cable(elements: int, shake: float = 0.0):
    """A free line, turning with (2, 3, 5) rad/s and flying; optionally waving out of line."""
    spin, drift = np.array([2.0, 3.0, 5.0]), np.array([0.3, 0.2, -0.1])

    def velocity(x):
        wave = np.zeros_like(x)
        wave[:, 2] = shake * np.sin(3 * x[:, 0])
        return np.cross(spin, x - (0.5, 0, 0)) + drift + wave

    model = pl.Model()
    cable = model.add_cable([(0, 0, 0), (1, 0, 0)], elements=elements, velocity=velocity, **line(1e3, 1e-2))
    return model, cable


def test_free_flight_conserves_momentum_exactly_and_energy_to_the_order(record):
    # Drift at the end of an independent implementation, without the corrections of the start: h ->
    # (angular, energy).
    published = {2e-3: (9.67e-7, 2.49e-6), 1e-3: (1.78e-7, 4.45e-7)}
    largest = {}
    for step, (angular, energy) in published.items():
        model, _ = flying_cable(8)
        result = pl.simulate(model, duration=0.5, step=step, spectral_radius=0.9, threads=1)
        name = f"free flight, h = {1e3 * step:g} ms"
        change = result.momentum - result.momentum[0]
        assert record(f"{name}, momentum", change, np.zeros_like(change), 1e-12, "kg m/s")
        change = np.linalg.norm(result.angular_momentum - result.angular_momentum[0], axis=1)
        largest[step] = change.max()
        # The drift swings about zero; what is left at the end is of the published size.
        assert record(f"{name}, angular momentum at the end", change[-1], 0.0, 2 * angular, "kg m^2/s")
        total = result.energy.total
        assert record(f"{name}, energy at the end", total[-1], total[0], 2 * energy, "J")
    order = np.log2(largest[2e-3] / largest[1e-3])
    assert record("free flight, order of the angular momentum's largest drift", order, 2.0, 0.1)


def test_a_waving_flight_in_space_agrees_with_explicit_integration(record):
    # 16 elements (two-point bending rule there), 2 s, 8000 Runge-Kutta steps of order 8.
    model, cable = flying_cable(16, shake=2.0)
    start = pl.simulate(model, duration=1e-4, step=1e-4, threads=1)
    assert record(
        "waving flight, linear momentum", start.momentum[0], (0.3, 0.2, 1.2266593851), 2e-6, "kg m/s"
    )
    assert record("waving flight, energy", start.energy.total[0], 2.316494029530222, 2e-5, "J")
    tip, _, _ = tip_after(model, cable.end, 2.0, 1e-4, spectral_radius=0.9)
    assert record("waving flight, tip after 2 s", tip, (1.42640, 0.06174, 2.52636), 2e-2, "m")


def test_the_energy_audit_closes_with_the_order_of_the_scheme(record):
    model, cable = soft_pendulum(16, retardation_time=5e-3)
    model.add_force(cable.end, lambda t: (0.0, 0.0, 5.0 * np.sin(20 * t)))
    gaps = []
    for step in (2e-3, 1e-3, 5e-4):
        result = pl.simulate(model, duration=0.5, step=step, threads=1)
        total = result.energy.total
        gaps.append(np.max(np.abs(total - total[0])))
        assert result.energy.dissipated[-1] > 0
        assert abs(result.energy.work[-1]) > 1e-3
    assert record("energy audit, damping and work, order", np.log2(gaps[1] / gaps[2]), 2.0, 0.3)
    # Against about 11 J that change hands.
    assert record("energy audit, damping and work, gap at 0.5 ms", gaps[-1], 0.0, 5e-3, "J")


def test_tightening_newton_tenfold_moves_the_tip_by_less_than_1e_9(record):
    model, cable = rubber_pendulum(40, strain="biot")
    tips = [
        tip_after(model, cable.end, 1.0, 1e-3, spectral_radius=0.9, tolerance=tolerance)[0]
        for tolerance in (None, 1e-11)
    ]
    assert record("Newton ten times tighter, tip", tips[0], tips[1], 1e-9, "m")


def test_the_first_step_is_consistent(record):
    # A line at rest, let go: the reaction starts at the static share of a hinged bar, a quarter of its weight
    # for a stiff bar; here the bar is a cable without much bending stiffness, so its pinned end carries
    # nothing
    # sideways but what its inertia gives at once.
    model, cable = rubber_pendulum(16)
    result = pl.simulate(model, duration=0.01, step=1e-4, threads=1)
    acceleration = result.track(cable.end).acceleration
    assert record("free fall of the tip at the start", acceleration[0], (0, -9.81, 0), 1e-2, "m/s^2")
    # Centre of mass and reaction obey Newton's law at every output.
    force = result.reaction(model.joints[0]).force
    assert np.all(np.isfinite(force))
