"""A rod in a tube: when it waves, when it winds, and what a bend takes of its push."""

import numpy as np
import pliant as pl
import pytest
from pliant.scenes import catheter, helical_force, sinusoidal_force

YOUNGS_MODULUS, RADIUS, CLEARANCE, WEIGHT, GRAVITY = 5e8, 1e-3, 2e-3, 0.03390092632488746, 9.81
STIFFNESS = YOUNGS_MODULUS * np.pi * RADIUS**4 / 4
WAVE = (WEIGHT / (STIFFNESS * CLEARANCE)) ** 0.25
"""Wave number of the first wave of an endless rod [1/m]."""


def rod(model, line, elements):
    """Add a rod of these sizes."""
    material = pl.LinearElastic(YOUNGS_MODULUS, 0.4, WEIGHT / (GRAVITY * np.pi * RADIUS**2))
    return model.add_cable(
        line, elements=elements, section=pl.Circle(RADIUS), material=material, rest="straight"
    )


def test_closed_forms(record):
    found = [force(STIFFNESS, WEIGHT, CLEARANCE) for force in (sinusoidal_force, helical_force)]
    # Rounding.
    assert record("rod in a tube, forces of waves and helices", found, [0.163174, 0.230763], 1e-6, unit="N")


def aside(force, waves, elements=32, halves=4, push=2e-4):
    """How far a rod on the floor of a straight tube gives way to a load aside of so many half waves [m]."""
    length = halves * np.pi / WAVE
    model = pl.Model(gravity=(0, 0, -GRAVITY))
    line = rod(model, [(0, 0, 0), (length, 0, 0)], elements)
    tube = model.add_obstacle(pl.Bore([(0, 0, CLEARANCE), (length, 0, CLEARANCE)], RADIUS + CLEARANCE))
    model.add_contact(line, tube, stiffness=1e5)
    model.pin(line.start)
    model.slide_along(line.end, pl.Line((length, 0, 0), (1, 0, 0)))
    model.add_force(line.end, (-force, 0, 0))
    shape = np.sin(waves * np.pi * np.arange(elements + 1) / elements)
    for node in range(1, elements):
        model.add_force(line.node(node), (0, push * shape[node] * length / elements, 0))
    y = pl.solve_static(model).positions(line)[-1][:, 1]
    return y @ shape / (shape @ shape)


@pytest.mark.parametrize(
    "waves", [pytest.param(3, marks=pytest.mark.slow), 4, pytest.param(5, marks=pytest.mark.slow)]
)
def test_a_straight_rod_waves_at_paslays_force(waves, record):
    # What it gives way to a small load grows as 1/(F_c - F) (Southwell): two forces tell F_c, a third checks.
    forces = np.array([0.0, 0.05, 0.1])
    softness = np.array([aside(force, waves) for force in forces])
    slope, offset = np.polyfit(forces, 1 / softness, 1)
    assert np.allclose((offset + slope * forces) * softness, 1.0, atol=1e-4)
    k = waves * WAVE / 4
    exact = STIFFNESS * k**2 + WEIGHT / (CLEARANCE * k**2)
    # Eight elements a half wave of the shortest, and 0.3 um of penetration.
    name = f"rod in a tube, {waves} half waves, force at which it waves"
    assert record(name, -offset / slope, exact, 2e-3 * exact, unit="N", source="Paslay & Bogy 1964")


def test_winding_a_rod_into_a_helix_takes_chens_force(record):
    """The work of the mean force is the energy of bending and lifting, whatever the pitch."""
    means = []
    for part in (0.8, 1.0, 1.25):
        k = part * 2**0.25 * WAVE
        speed = np.hypot(1.0, CLEARANCE * k)
        turns = 3
        length = turns * 2 * np.pi / k * speed

        def helix(s, k=k, speed=speed):
            x = s / speed
            return x, CLEARANCE * np.sin(k * x), CLEARANCE * (1 - np.cos(k * x))

        model = pl.Model(gravity=(0, 0, -GRAVITY))
        line = rod(model, pl.Curve(helix, length=length), 24 * turns)
        tube = pl.Bore([(0, 0, CLEARANCE), (length, 0, CLEARANCE)], RADIUS + CLEARANCE)
        model.add_contact(line, model.add_obstacle(tube))
        energy = pl.Stepper(model, step=1e-6).energy
        shorter = length - length / speed
        means.append(float(energy.elastic + energy.gravitational) / shorter)
    # The wound rod is on average as high as the middle of the tube; it lay on the floor, at height zero.
    exact = helical_force(STIFFNESS, WEIGHT, CLEARANCE)
    # Slopes of r k = 0.03: their squares. Least where theory says.
    assert record("rod in a tube, mean force of a helix", means[1], exact, 2e-3 * exact, unit="N")
    assert means[1] < min(means[0], means[2])


@pytest.mark.parametrize(
    "friction", [pytest.param(0.1, marks=pytest.mark.slow), 0.2, pytest.param(0.3, marks=pytest.mark.slow)]
)
def test_a_bend_takes_its_share_of_the_push(friction, record):
    # Heavy, for the same slow motion with softer contact in fewer steps; without gravity.
    scene = catheter(
        friction=friction,
        tip="force",
        lead=0.02,
        gravity=0.0,
        density=1e5,
        stiffness=1e6,
        elements=24,
        settling=0.1,
        duration=0.6,
        step=1e-3,
    )
    result = scene.simulate()
    found = scene.measure(result)
    exact = np.exp(friction * np.pi / 2)
    # Where it enters and leaves the rod's own stiffness pushes with EI/R^2, 3 % of the force at the tip.
    name = f"catheter pushed through a bend, ratio of forces at mu = {friction}"
    ratio = found["ratio of forces at the bend"]
    assert record(name, ratio, exact, 0.03 * exact, source="exp(mu phi)")
    assert record(f"catheter in a bend, energy drift at mu = {friction}", found["energy drift"], 0.0, 1e-4)


def test_a_rod_keeps_to_its_bore(record):
    scene = catheter(tip="force", tip_force=0.05, lead=0.05, elements=32, duration=0.2, settling=0.1)
    result = scene.simulate()
    line = result.positions("catheter")[-1]
    # Nodes stay within the clearance from the middle line but for their penetration.
    bend = np.array([0.05, 0.05])
    turned = np.arctan2(line[:, 0] - bend[0], bend[1] - line[:, 1])
    inside = (turned > 0.1) & (turned < np.pi / 2 - 0.1)
    off = np.hypot(np.hypot(*(line[inside, :2] - bend).T) - 0.05, line[inside, 2])
    assert off.max() < 2e-3 * 1.05
    # Wall and hand carry it.
    carried = result.contact_force("catheter", "tube") + result.reaction(scene.model["hand"]).force
    weight = WEIGHT * scene.model["catheter"].length
    name = "rod in a bent tube, wall and hand less the rate of momentum over weight"
    carried -= result.momentum_rate
    # What Newton's iteration leaves over.
    assert record(name, carried[-1, 2] / weight, 1.0, 1e-3, source="balance of momentum")


def test_wrong_tubes_are_refused():
    for changes in ({"tip": "wall"}, {"settling": 5.0}, {"bend": 2e-3}):
        with pytest.raises(pl.ModelError):
            catheter(**changes)
