"""Bits of runs with contact: alike with one and two threads, and over a stop on the way."""

from __future__ import annotations

import numpy as np
import pliant as pl
import pytest

STEP = 2e-4
STEPS = 40


def touching_all_over(radius=4e-3) -> pl.Model:
    """Nine crossings, a hairpin that closes and a rope thrown at a ball, with friction.

    Of 4,040 elements, for a second thread is only taken from 4,000 on.
    """
    model = pl.Model()
    law = pl.LuGre(0.5, 0.4)
    kind = {
        "section": pl.Circle(radius),
        "material": pl.LinearElastic(2e7, 0.45, 1100.0, retardation_time=1e-3),
    }
    places, top = (-0.35, 0.0, 0.35), 2 * radius + 1e-4
    low = [model.add_cable([(-0.5, y, 0), (0.5, y, 0)], elements=660, **kind) for y in places]
    for x in places:
        ends = [(x, -0.5, top), (x, 0.5, top)]
        high = model.add_cable(ends, elements=660, velocity=(0.5, 0, -1), **kind)
        for rope in low:
            model.add_contact(high, rope, friction=law)
    leg, bend = 0.15, 1.3 * radius

    def hairpin(s):
        turn = np.clip((s - leg) / bend, 0.0, np.pi)
        straight = leg - min(s, leg) + max(s - leg - np.pi * bend, 0.0)
        return straight - bend * np.sin(turn), -bend * np.cos(turn), -0.3

    loop = model.add_cable(
        pl.Curve(hairpin, length=2 * leg + np.pi * bend),
        elements=40,
        velocity=lambda r: np.outer(-np.sign(r[:, 1]) * np.clip(r[:, 0] / leg, 0, 1), [0, 1, 0]),
        name="loop",
        **kind,
    )
    model.add_contact(loop, friction=law)
    ball = model.add_rigid_body(mass=0.2, position=(0, 0, -0.6), shape=pl.Sphere(0.05), name="ball")
    height = -0.55 + radius + 1e-4
    rope = model.add_cable(
        [(-0.2, 0, height), (0.2, 0, height)], elements=40, velocity=(0.3, 0, -1), name="rope", **kind
    )
    model.add_contact(rope, ball, friction=law)
    return model


def run(threads: int, steps: int = STEPS) -> pl.Stepper:
    stepper = pl.Stepper(touching_all_over(), step=STEP, threads=threads, record_every=1)
    stepper.advance(steps)
    return stepper


@pytest.fixture(scope="module")
def alone() -> pl.Stepper:
    return run(1)


def different(one: pl.Stepper, other: pl.Stepper) -> int:
    """Numbers in which two runs differ: their last states, and the forces of all zones on the way."""
    count = 0
    for mine, theirs in ((one.coordinates, other.coordinates), (one.velocities, other.velocities)):
        count += np.count_nonzero(mine != theirs)
    for mine, theirs in zip(one.result.contacts, other.result.contacts, strict=True):
        for patch, same in zip(mine, theirs, strict=True):
            count += (patch.gap, patch.normal_force) != (same.gap, same.normal_force)
            count += np.count_nonzero(patch.friction_force != same.friction_force)
    return count


def test_two_threads_give_the_bits_of_one(alone, record):
    touched = {patch.bodies for patches in alone.result.contacts for patch in patches}
    assert {("loop", "loop"), ("rope", "ball")} < touched
    assert len(touched) == 9 + 2
    count = different(alone, run(2))
    assert record("contact with two threads, numbers unlike with one", count, 0, 0, source="the same run")


def test_a_stop_amid_contact_leaves_no_trace(alone, tmp_path, record):
    parts = run(2, 17)
    # Where loop, ball and crossings touch at once.
    assert {patch.bodies for patch in parts.contacts} >= {("loop", "loop"), ("rope", "ball")}
    parts.save(tmp_path / "run")
    again = pl.Stepper.load(tmp_path / "run")
    again.advance(STEPS - 17)
    count = different(alone, again)
    assert record("contact saved and resumed, numbers unlike in one run", count, 0, 0, source="the same run")
    state = parts.state
    parts.advance(5)
    parts.reset(state)
    parts.advance(STEPS - 17)
    np.testing.assert_array_equal(parts.coordinates, alone.coordinates)
    np.testing.assert_array_equal(parts.velocities, alone.velocities)
