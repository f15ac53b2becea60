"""A kilogram on a ground with LuGre friction: whole simulations beside the law's own equations."""

import numpy as np
import pliant as pl
import pytest
from pliant.scenes import friction_rig

LSODA = "independent integration of the law's equations (LSODA at 1e-9)"
ANGLES = (15.0, 18.0, 20.0, 21.0, 21.5, 22.0, 25.0)


def measured(experiment, **changes):
    """Run an experiment; what it must show by the scene's own integration is asserted, too."""
    scene = friction_rig(experiment, **changes)
    found = scene.measure(scene.simulate())
    assert scene.failures(found) == []
    return found


def test_stick_slip(record):
    found = measured("stick_slip")
    # At h = 1 ms half a per cent of the period and one of forces and of the velocity are asked for.
    for key, value, tolerance, unit in (
        ("first slip [s]", 7.4376, 0.032, "s"),
        ("period [s]", 6.3627, 0.032, "s"),
        ("duration of a slip [s]", 2.8251, 0.028, "s"),
        ("spring as it slips [N]", 1.48736, 0.015, "N"),
        ("spring as it sticks [N]", 0.77997, 0.0078, "N"),
        ("largest velocity [m/s]", 0.36982, 0.0037, "m/s"),
    ):
        name = f"friction rig, stick-slip, {key.split(' [')[0]}"
        assert record(name, found[key], value, tolerance, unit=unit, source=LSODA)


def test_presliding_loop(record):
    found = measured("presliding")
    ways = [found[f"{key} [um]"] for key in ("there", "held", "back", "held back", "there again")]
    # A hundredth of the loop's size.
    assert record(
        "friction rig, presliding loop",
        ways,
        [44.8782, 45.194, -9.70172, -10.0174, 44.8782],
        0.45,
        unit="um",
        source=LSODA,
    )
    # It closes to six digits in the reference; steps of 5 ms leave a thousandth of a micrometre.
    assert record("friction rig, presliding loop, where it closes", ways[4] - ways[0], 0.0, 1e-2, unit="um")


@pytest.mark.parametrize(
    ("rate", "friction", "force"),
    [
        (0.1, 1.48521, 1.49633),
        (1.0, 1.43242, 1.50249),
        (2.0, 1.39442, 1.5203),
        (5.0, 1.31321, 1.58711),
        (10.0, 1.21995, 1.70159),
        (20.0, 1.09861, 1.9047),
        (50.0, 1.008, 2.36105),
    ],
)
def test_break_away_falls_with_the_rate_of_loading(rate, friction, force, record):
    found = measured("break_away", rate=rate)
    name = f"friction rig, {rate:g} N/s, "
    # One per cent is asked for.
    assert record(
        f"{name}largest friction",
        found["largest friction [N]"],
        friction,
        0.01 * friction,
        unit="N",
        source=LSODA,
    )
    assert record(
        f"{name}force at 2 cm/s", found["force as it slides [N]"], force, 0.01 * force, unit="N", source=LSODA
    )


@pytest.mark.slow
@pytest.mark.parametrize(
    ("stribeck", "rise", "ways", "expected"),
    [
        # Ways of those who stick [um], and velocities after 3 s at 15, 18, 20, 21, 21.5, 22 and 25 degrees;
        # atan 0.4 is 21.80 degrees.
        (1e-3, 0.0, (120.308,), (0.0, 0.703684, 1.773817, 2.308303, 2.575320, 2.842156, 4.438175)),
        (1e-2, 0.0, (60.867, 130.244), (0.0, 0.0, 1.767627, 2.304949, 2.572613, 2.839901, 4.437131)),
        (1e-3, 1.0, (42.250, 63.552), (0.0, 0.0, 1.170737, 1.565770, 1.764463, 1.964267, 3.181587)),
        (
            1e-2,
            1.0,
            (42.220, 63.200, 91.820, 129.087, 208.610),
            (0.0, 0.0, 0.0, 0.0, 0.0, 1.869825, 3.100024),
        ),
    ],
)
def test_slopes_stick_or_slide(stribeck, rise, ways, expected, record):
    law = pl.LuGre(0.4, 0.3, stribeck_velocity=stribeck, bristle_stiffness=1e5, bristle_damping=316.0)
    scenes = [friction_rig("incline", law=law, angle=np.radians(a), rise=rise) for a in ANGLES]
    found = [scene.measure(scene.simulate()) for scene in scenes]
    velocities = np.array([values["velocity [m/s]"] for values in found])
    how = f"stribeck velocity {1e3 * stribeck:g} mm/s, {'sudden' if rise == 0 else 'within 1 s'}"
    slides = np.array(expected) > 0
    # Who slides is decided, not measured.
    assert record(f"friction rig, slope, {how}, who slides", velocities > 1e-3, slides, 0.0, source=LSODA)
    # 200 um are asked for; the bristles' ringing after the sudden load is twenty steps long.
    stuck = [1e6 * values["way [m]"] for values, moves in zip(found, slides, strict=True) if not moves]
    name = f"friction rig, slope, {how}, way of who sticks"
    assert record(name, stuck, ways, 3.0, unit="um", source=LSODA)
    # 0.2 per cent of the velocity is asked for.
    assert record(
        f"friction rig, slope, {how}, velocity of who slides",
        velocities[slides],
        np.array(expected)[slides],
        2e-3 * np.array(expected)[slides],
        unit="m/s",
        source=LSODA,
    )


@pytest.mark.slow
def test_a_parked_mass_creeps(record):
    found = measured("drift")
    # A twentieth is asked for.
    for key, value in (("creep in 10 s [um]", 204.765), ("creep in 40 s [um]", 819.714)):
        name = f"friction rig, swinging load, {key.split(' [')[0]}"
        assert record(name, found[key], value, 0.05 * value, unit="um", source=LSODA)


def test_coulomb_knows_nothing_of_rates_and_history(record):
    law = pl.Coulomb(1.5)
    scenes = [friction_rig("break_away", law=law, rate=rate) for rate in (1.0, 10.0)]
    peaks = [scene.measure(scene.simulate())["largest friction [N]"] for scene in scenes]
    # Its friction is its coefficient; damping of the elastic deflection adds up to a per cent.
    assert record("Coulomb, largest friction at 1 and 10 N/s", peaks, [1.5, 1.5], 0.02, unit="N")


@pytest.mark.parametrize(
    ("c", "restitution"),
    [(0.05, 0.967739), (0.1, 0.937476), (0.2, 0.88219), (0.5, 0.748435), (1.0, 0.593624), (2.0, 0.41072)],
)
def test_blows_as_hunt_and_crossley_say(c, restitution, record):
    model = pl.Model()
    mass = model.add_point_mass(1.0, at=(0, 0, 0.0101), velocity=(0, 0, -1.0), radius=0.01)
    model.add_contact(mass, model.add_obstacle(pl.HalfSpace()), stiffness=1e4, damping=c)
    result = pl.simulate(model, duration=0.05, step=1e-4)
    e = result.track(mass).velocity[-1, 2]
    # At 1 m/s. Order two: the contact's period is 600 steps; the scheme takes 1e-4 of the motion.
    assert record(
        f"mass on the ground at c v = {c:g}, restitution", e, restitution, 1e-3, source="Hunt & Crossley 1975"
    )


def test_wrong_experiments_are_refused():
    for changes in (
        {"experiment": "rolling"},
        {"law": 0.3},
        {"law": pl.LuGre(0.4, 0.3)},
        {"experiment": "incline", "angle": 2.0},
        {"experiment": "break_away", "rate": 0.0},
    ):
        with pytest.raises(pl.ModelError):
            friction_rig(**changes)
