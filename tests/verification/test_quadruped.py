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


def test_a_stroke_keeps_the_balance(record):
    scene = quadruped(cycles=1, settling=0, period=0.3, step=2e-3)
    result = scene.simulate(duration=0.15, output_every=1)
    weight = float(scene.model.gravity[2]) * -1070.0 * 8e-3 * 24 * 0.135 * 0.13 / 48
    impulse = result.contact_impulse("robot", "ground")[-1] - [0, 0, weight * result.time[-1]]
    gap = np.abs(result.momentum[-1] - result.momentum[0] - impulse).max() / (weight * result.time[-1])
    # The impulse is the trapezoid rule of the force at the ends of steps; the scheme weighs them otherwise,
    # which leaves a step's worth of what the force is at the end.
    assert record("quadruped, stroke, momentum against impulses", gap, 0.0, 0.02)
    energy = result.energy
    # What actuation does from within, friction and damping lose, or is still in motion. In its first steps
    # it sinks to where the ground carries it; they are long beside the contact's period, and lose that.
    assert np.ptp(energy.total[5:]) < 0.05 * energy.dissipated[-1]
    # It is its own mirror image across its way.
    assert np.abs(result.momentum[:, 1]).max() < 1e-9


@pytest.fixture(scope="module")
def walks():
    """Settled gaits by lag, friction and step."""
    return {
        "forward": _walk(lag=0.25),
        "back": _walk(lag=-0.25),
        "mirrored": _walk(lag=0.5),
        "slippery": _walk(friction=0.3),
        "rough": _walk(friction=1.0),
        "halved": _walk(step=1e-3),
    }


def _walk(**changes):
    scene = quadruped(**{"cycles": 6, "step": 2e-3, **changes})
    return scene.measure(scene.simulate())


@pytest.mark.slow
def test_symmetry_decides_who_walks(walks, record):
    travel = {name: measured["travel per cycle [mm]"] for name, measured in walks.items()}
    forward = travel["forward"]
    assert abs(forward) > 0.1
    assert record(
        "quadruped, opposite lag, travel over the forward one", travel["back"] / forward, -1.0, 0.05
    )
    assert record(
        "quadruped, mirrored gait, travel over the forward one", travel["mirrored"] / forward, 0.0, 0.02
    )
    assert record(
        "quadruped, half the step, travel over the forward one", travel["halved"] / forward, 1.0, 0.05
    )
    assert walks["forward"]["scatter of the travel"] < 0.05
    for name in ("slippery", "rough"):
        assert travel[name] * forward > 0


@pytest.mark.slow
def test_the_ground_carries_and_does_not_pull(walks, record):
    for name in ("forward", "back"):
        measured = walks[name]
        assert record(f"quadruped {name}, support over weight", measured["support over weight"], 1.0, 0.01)
        pull = measured["horizontal force over weight"]
        assert record(f"quadruped {name}, mean pull of the ground over weight", pull, 0.0, 0.01)
