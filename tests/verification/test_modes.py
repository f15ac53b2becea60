"""Frequencies of straight beams against Euler-Bernoulli, and of a taut string."""

import numpy as np
import pliant as pl
import pytest
from verification.cables import line, orders

# omega for EI = rho A = L = 1; (beta L)^2 of the frequency equations.
BEAM = {
    "clamped-free": (3.516015268500151, 22.034491564666773, 61.697214413549105),
    "pinned-pinned": (9.869604401089358, 39.47841760435743, 88.82643960980423),
    "clamped-clamped": (22.37328544806132, 61.67282286792025, 120.90339172712379),
    "free-free": (22.37328544806132, 61.67282286792025, 120.90339172712379),
}


def frequencies(kind: str, elements: int, count: int) -> np.ndarray:
    """Distinct bending frequencies [rad/s] (each occurs in both planes)."""
    model = pl.Model()
    arm = model.add_cable([(0, 0, 0), (1, 0, 0)], elements=elements, **line(1e8, 1.0))
    for end, point in zip(kind.split("-"), (arm.start, arm.end), strict=True):
        if end == "clamped":
            model.clamp(point)
        elif end == "pinned":
            model.pin(point)
    rigid = 5 if kind == "free-free" else 0
    modes = pl.solve_modes(model, count=2 * count + rigid)
    omega = 2 * np.pi * np.asarray(modes.frequencies)
    if rigid:
        # 3 translations and 2 rotations: the line has no twist.
        assert np.all(omega[:rigid] < 1e-3 * omega[rigid])
    bending = omega[rigid:]
    assert np.allclose(bending[0::2], bending[1::2], rtol=1e-6)
    return bending[::2][:count]


@pytest.mark.parametrize("kind", BEAM)
def test_bending_frequencies_converge_with_order_4(kind, record):
    exact = np.array(BEAM[kind])
    errors = np.array([np.abs(frequencies(kind, n, 3) / exact - 1) for n in (4, 8, 16)])
    assert np.all(orders(errors[:, 0]) > 3.7)
    # Relative error of mode k of a cubic element: (beta h)^4/720 at leading order.
    assert record(f"first frequency, {kind}, 16 elements", errors[-1, 0], 0.0, 6e-6)
    assert record(f"third frequency, {kind}, 16 elements", errors[-1, 2], 0.0, 3e-4)


def test_a_taut_string_vibrates_at_its_wave_speed(record):
    tension, mass, n = 100.0, 0.1, 32
    model = pl.Model()
    string = model.add_cable(
        [(0, 0, 0), (1, 0, 0)], elements=n, strain="biot", pretension=tension, **line(1e5, 1e-7, mass)
    )
    model.pin(string.start), model.pin(string.end)
    static = pl.solve_static(model)
    assert np.allclose(static.axial_force(string)[-1], tension, rtol=1e-9)
    modes = pl.solve_modes(model, count=6, about=static)
    exact = 0.5 * np.sqrt(tension / mass) * np.array([1, 1, 2, 2, 3, 3])
    # Fourth order: (k pi/n)^4/720 = 1e-5 for k = 3; the bending stiffness adds pi^2 EI/(2 N) < 1e-8.
    worst = np.max(np.abs(modes.frequencies / exact - 1))
    assert record("taut string, first three frequencies", worst, 0.0, 2e-5)


def test_what_touches_takes_part_in_modes(record):
    # A rope and a ball rest on the ground by their weight. The law is a ramp, p = k d^2/(2 d_0): its
    # slope at the depth that carries the weight is k d/d_0. Friction holds nothing.
    rest, radius, stiffness = 9.81, 5e-3, 1e6
    model = pl.Model(gravity=(0, 0, -rest))
    ground = model.add_obstacle(pl.HalfSpace())
    rubber = pl.LinearElastic(5e6, 0.4, 1200.0)
    line = [(0, 0, radius), (1, 0, radius)]
    rope = model.add_cable(line, elements=10, section=pl.Circle(radius), material=rubber)
    model.add_contact(rope, ground, stiffness=stiffness, friction=pl.LuGre(0.5, 0.4))
    source = "slope of the normal force under the weight"

    def rate(mass: float, depth_0: float, k: float) -> float:
        depth = np.sqrt(2 * depth_0 * mass * rest / k)
        return float(np.sqrt(k * depth / (depth_0 * mass)) / (2 * np.pi))

    about = pl.simulate(model, duration=2.0, step=1e-3, output_every=2000)
    modes = pl.solve_modes(model, about=about, count=40).frequencies
    exact = rate(1200.0 * np.pi * radius**2, 0.005 * radius, stiffness)
    # Without bending all of the rope would go up and down at this rate: the stiffer the shape, the faster.
    bouncing = modes[(modes > 0.99 * exact) & (modes < 1.01 * exact)]
    assert len(bouncing) >= 5
    assert record("a rope on the ground, heaving", bouncing[0], exact, 1e-3 * exact, "Hz", source)
    # Across and along it slides; no mode of bending up and down is as slow as those across.
    assert np.all(modes[:3] < 1e-3)
    assert np.diff(modes[3:9]).min() > 0.5

    mass, k = 0.5, 2e4
    model.add_rigid_body(
        mass=mass, inertia=(5e-4,) * 3, shape=pl.Sphere(0.05), position=(0, 1, 0.05), name="ball"
    )
    model.add_contact(model["ball"], ground, stiffness=k)
    about = pl.simulate(model, duration=6.0, step=1e-3, output_every=6000)
    modes = pl.solve_modes(model, about=about, count=40)
    # Pressed far beyond the ramp; the default damping, 3 s/m, of the normal force.
    ratio = 3.0 * mass * rest / (2 * np.sqrt(k * mass))
    exact = float(np.sqrt(k / mass * (1 - ratio**2)) / (2 * np.pi))
    nearest = np.argmin(np.abs(modes.frequencies - exact))
    frequency, damping = modes.frequencies[nearest], modes.damping_ratios[nearest]
    assert record("a ball on the ground, heaving", frequency, exact, 1e-4 * exact, "Hz", source)
    assert record("a ball on the ground, damping ratio", damping, ratio, 1e-3 * ratio, "", source)
