"""The soft quadruped: what walks is decided by symmetry, and the ground's impulses add up."""

import numpy as np
import pliant as pl
import pytest
from pliant.scenes import quadruped


def test_the_plus_has_24_faces_in_one_chart():
    scene = quadruped()

    # 4 nodal vectors at 39 nodes.
    assert scene.model.dof == 3 * 4 * 39
    assert quadruped(refinement=2).model.dof > 3 * scene.model.dof


def test_wrong_gaits_are_refused():
    for changes in ({"gait": "trot"}, {"actuation": "springs"}, {"cycles": 2}, {"refinement": 0}):
        with pytest.raises(pl.ModelError):
            quadruped(**changes)


@pytest.mark.parametrize("how", ["curvature", "pressure"])
def test_a_stroke_keeps_the_balance(how, record):
    scene = quadruped(actuation=how, cycles=1, settling=0, period=0.3, step=2e-3)
    result = scene.simulate(duration=0.15, output_every=1)
    weight = float(scene.model.gravity[2]) * -1070.0 * 8e-3 * 24 * 0.135 * 0.13 / 48
    impulse = result.contact_impulse("robot", "ground")[-1] - [0, 0, weight * result.time[-1]]
    gap = np.abs(result.momentum[-1] - result.momentum[0] - impulse).max() / (weight * result.time[-1])
    # The impulse is the trapezoid rule of the force at the ends of steps; the scheme weighs them otherwise,
    # which leaves a step's worth of what the force is at the end.
    assert record(f"quadruped, stroke by {how}, momentum against impulses", gap, 0.0, 0.02)
    energy = result.energy
    # What actuation does from within, friction and damping lose, or is still in motion. In its first steps
    # it sinks to where the ground carries it; they are long beside the contact's period, and lose that.
    assert np.ptp(energy.total[5:]) < 0.05 * energy.dissipated[-1]
    # It is its own mirror image across its way.
    assert np.abs(result.momentum[:, 1]).max() < 1e-9


@pytest.fixture(scope="module")
def walks():
    """Settled gaits by actuation, and by lag, step or friction."""
    changes = {
        "forward": {"lag": 0.25},
        "back": {"lag": -0.25},
        "mirrored": {"lag": 0.5},
        "halved": {"step": 1e-3},
        **{mu: {"friction": mu} for mu in FRICTIONS},
    }
    return {how: {name: _walk(actuation=how, **change) for name, change in changes.items()} for how in INSIDE}


INSIDE = ("curvature", "pressure")
FRICTIONS = (0.3, 0.45, 0.8, 1.0)


def _walk(**changes):
    scene = quadruped(**{"cycles": 6, "step": 2e-3, **changes})
    result = scene.simulate()
    measured = scene.measure(result)
    assert scene.failures(measured) == []
    return {**measured, "result": result}


@pytest.mark.slow
@pytest.mark.parametrize("how", INSIDE)
def test_symmetry_decides_who_walks(how, walks, record):
    travel = {name: measured["travel per cycle [mm]"] for name, measured in walks[how].items()}
    forward = travel["forward"]
    assert forward > 0.1
    name = f"quadruped by {how}, "
    scatter = walks[how]["forward"]["scatter of the travel"]
    # Asked for: travel repeats to 5 %, opposite lags give opposite travel to 5 %, the mirrored gait less than
    # 2 % of it.
    assert record(f"{name}scatter of the travel from cycle to cycle", scatter, 0.0, 0.05)
    assert record(f"{name}opposite lag, travel over the forward one", travel["back"] / forward, -1.0, 0.05)
    assert record(f"{name}mirrored, travel over the forward one", travel["mirrored"] / forward, 0.0, 0.02)
    # And half the step changes it by less than 5 %.
    assert record(f"{name}half the step, travel over the other", travel["halved"] / forward, 1.0, 0.05)


@pytest.mark.slow
@pytest.mark.parametrize("how", INSIDE)
def test_friction_does_not_decide_which_way(how, walks, record):
    travels = np.array([walks[how][mu]["travel per cycle [mm]"] for mu in FRICTIONS])
    middle = walks[how]["forward"]["travel per cycle [mm]"]
    assert np.all(travels > 0)
    # From 0.3 to 1.0: less than a factor of 1.6 up or down from what 0.6 gives.
    name = f"quadruped by {how}, log_1.6 of travel on grounds of friction 0.3 to 1 over that on 0.6"
    assert record(name, np.log(travels / middle) / np.log(1.6), np.zeros(len(travels)), 1.0)


@pytest.mark.slow
@pytest.mark.parametrize("how", INSIDE)
def test_the_ground_carries_and_does_not_pull(how, walks, record):
    for name in ("forward", "back"):
        measured = walks[how][name]
        label = f"quadruped by {how} {name}, "
        assert record(f"{label}support over weight", measured["support over weight"], 1.0, 0.01)
        pull = measured["horizontal force over weight"]
        assert record(f"{label}mean pull of the ground over weight", pull, 0.0, 0.01)


@pytest.mark.slow
@pytest.mark.parametrize("how", INSIDE)
def test_feet_of_opposite_gaits_are_mirror_images(how, walks, record):
    """Where the nodes of the middle line are in the air, stick and slip, in the last cycle."""
    maps = {}
    for name in ("forward", "back"):
        result = walks[how][name]["result"]
        r, v = result.positions("robot"), result.velocities("robot")
        middle = np.flatnonzero(np.abs(r[0, :, 1]) < 1e-9)
        middle = middle[np.argsort(r[0, middle, 0])]
        down = r[-60:, middle, 2] < r[0, 0, 2] + 2e-5
        slips = np.abs(v[-60:, middle, 0]) > 1e-3
        maps[name] = np.where(down, np.where(slips, 2, 1), 0)
        # Both feet stick for a part of the cycle, slip for another, and something always holds.
        for foot in (0, -1):
            assert {1, 2} <= set(maps[name][:, foot])
        assert np.all(np.any(maps[name] > 0, axis=1))
    # The back half of the one does what the front half of the other did a quarter of a period ago.
    other = np.roll(maps["back"][:, ::-1], 15, axis=0)
    differ = np.mean(maps["forward"] != other)
    # Outputs are a sixtieth of a period apart: states that last to the next one differ there.
    assert record(f"quadruped by {how}, share of the maps of feet that differ", differ, 0.0, 0.05)


@pytest.mark.slow
def test_a_crawl_turned_by_half_a_turn_goes_the_other_way(record):
    ways = {lag: _walk(gait="crawl", lag=lag) for lag in (0.25, -0.25, 0.5)}
    keys = ("travel per cycle [mm]", "sideways per cycle [mm]")
    forward, back, still = (np.array([ways[lag][key] for key in keys]) for lag in (0.25, -0.25, 0.5))
    size = np.linalg.norm(forward)
    assert size > 0.1
    assert record("quadruped, crawl with the opposite lag over the other", back / size, -forward / size, 0.05)
    assert record("quadruped, crawl half a period apart over the other", still / size, np.zeros(2), 0.02)


@pytest.mark.slow
def test_forces_from_outside_alternate_and_go_nowhere(record):
    inside = _walk(actuation="pressure")["travel per cycle [mm]"]
    outside = _walk(actuation="forces", force=0.4, lag=0.5)["travel per cycle [mm]"]
    name = "quadruped, mirrored forces from outside, travel over that by chambers"
    assert record(name, outside / inside, 0.0, 0.02)
