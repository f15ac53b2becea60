"""Steppers, checkpoints and the ways to run: whichever way a run goes, its bits are the same."""

from __future__ import annotations

import json
import os
import pickle
import signal
import subprocess
import sys
import textwrap
import threading
import time
from collections.abc import Callable
from dataclasses import fields
from pathlib import Path

import numpy as np
import pliant as pl
import pytest

H = 1e-3


def machine(force: object = None) -> tuple[pl.Model, pl.Cable]:
    """A rope with a weight that swings, damped, under a force at its middle."""
    rubber = pl.LinearElastic(1e7, 0.45, 1000.0, retardation_time=1e-3)
    model = pl.Model(gravity=(0, 0, -9.81))
    rope = model.add_cable(
        [(0, 0, 0), (1, 0, 0)], elements=6, section=pl.Circle(5e-3), material=rubber, name="rope"
    )
    model.pin(rope.start, name="hook")
    model.pin(rope.end, model.add_point_mass(0.1, at=(1, 0, 0), name="weight"), name="knot")
    if force is not None:
        model.add_force(rope.node(3), force, name="push")
    return model, rope


def push(t: float) -> float:
    """A force that rests at the start: of a function the first step sees the slope, of an input not."""
    return float(0.3 * np.sin(20.0 * max(t - 0.005, 0.0)))


def same(one: pl.Result, other: pl.Result) -> None:
    for entry in fields(one._records):
        ours, theirs = (getattr(r._records, entry.name) for r in (one, other))
        np.testing.assert_array_equal(ours, theirs, err_msg=entry.name)


def test_a_stepper_takes_the_steps_of_simulate() -> None:
    model, rope = machine((0, 0.3, 0) * pl.Ramp(0.05))
    whole = pl.simulate(model, duration=0.1, step=H, output_every=4)
    stepper = pl.Stepper(model, step=0.1 / 100, record_every=4)
    for steps in (1, 1, 5, 13, 80):
        stepper.advance(steps)
    same(stepper.result, whole)
    assert stepper.statistics.steps == 100
    for name in ("positions", "axial_force", "center_of_mass"):
        assert np.array_equal(getattr(stepper, name)(rope), getattr(whole, name)(rope)[-1])
    for name in ("momentum", "angular_momentum"):
        assert np.array_equal(getattr(stepper, name), getattr(whole, name)[-1])
    track = whole.track(rope.at(0.3))
    assert np.array_equal(stepper.position(rope.at(0.3)), track.position[-1])
    assert np.array_equal(stepper.velocity(rope.at(0.3)), track.velocity[-1])
    assert np.array_equal(stepper.track(rope.at(0.3)).acceleration, track.acceleration[-1])
    for joint in ("hook", "knot"):
        assert np.array_equal(
            stepper.reaction(model[joint]).force,  # type: ignore[arg-type]
            whole.reaction(model[joint]).force[-1],  # type: ignore[arg-type]
        )
    assert np.array_equal(stepper.strain(rope).curvature, whole.strain(rope).curvature[-1])
    assert stepper.energy.total == whole.energy.total[-1]
    assert stepper.time == whole.time[-1]
    assert np.array_equal(stepper.coordinates, whole._records.q[-1])
    assert np.array_equal(stepper.velocities, whole._records.v[-1])


def test_nothing_is_recorded_unless_asked_for() -> None:
    stepper = pl.Stepper(machine()[0], step=H)
    stepper.advance(10)
    assert stepper.result.time.tolist() == [0.0]


@pytest.mark.parametrize("follower", [False, True])
def test_an_input_set_before_each_step_is_a_function_of_time(follower: bool) -> None:
    ends = []
    for force in (lambda t: (0, 0, push(t)), (0, 0, 1) * pl.Input("push")):
        model, rope = machine()
        model.add_force(rope.node(4), force, follower=follower)
        stepper = pl.Stepper(model, step=H, record_every=10)
        for n in range(60):
            if not callable(force) or isinstance(force, pl.signals.Signal):
                stepper.set_input("push", push((n + 1) * H))
            stepper.advance()
        ends.append((stepper.coordinates, stepper.result.energy.work, stepper.result))
    assert np.array_equal(ends[0][0], ends[1][0])
    assert np.array_equal(ends[0][1], ends[1][1])
    assert np.ptp(ends[0][1]) > 0


def test_inputs_are_vectors_too_and_add_to_others() -> None:
    model = pl.Model()
    ball = model.add_point_mass(2.0, at=(0, 0, 0))
    other = model.add_point_mass(1.0, at=(0, 0, 0))
    vector = pl.Input("vector", initial=(2, 0, 0))
    model.add_force(ball, vector + (0, 4, 0))
    model.add_force(other, 0.5 * vector)
    stepper = pl.Stepper(model, step=0.1)
    stepper.advance(10)
    np.testing.assert_allclose(stepper.velocity(ball.center), (1, 2, 0), rtol=1e-12)
    stepper.set_input("vector", (0, 0, 6))
    stepper.advance(10)
    # The input rises over one step of 0.1 s: some of that is missed.
    for point in (ball.center, other.center):
        assert 2.7 < stepper.velocity(point)[2] < 3.0
    assert pl.solve_static(machine((0, 0, 1) * pl.Input("push", 0.2))[0]).load_factor[-1] == 1.0
    # As a document the model keeps its inputs.
    again = pl.Model.from_document(json.loads(json.dumps(model.to_document())))
    pl.Stepper(again, step=0.1).set_input("vector", (1, 2, 3))


def test_reactions_know_the_inputs_of_their_time(tmp_path: Path) -> None:
    model, rope = machine()
    model.add_force(rope.end, (0, 0, 2.0) * pl.Input("lift"))
    stepper = pl.Stepper(model, step=H, record_every=1)
    for n in range(20):
        stepper.set_input("lift", 0.1 * n)
        stepper.advance()
    result = stepper.result
    mass = 0.1
    force = result.reaction(model["knot"]).force  # type: ignore[arg-type]
    # The knot carries the weight, its inertia, and what the force beside it does not.
    acceleration = result.track(model["weight"].center).acceleration  # type: ignore[union-attr]
    inertia = mass * (acceleration + np.array([0, 0, 9.81]))
    assert np.abs(np.abs(force) - np.abs(inertia)).max() < 2.0 * 2.0 * 20
    result.save(tmp_path / "run.h5")
    again = pl.Result.load(tmp_path / "run.h5")
    assert np.array_equal(again.reaction(model["knot"]).force, force)  # type: ignore[arg-type]


def test_reset_goes_back_bit_for_bit() -> None:
    model, _ = machine((0, 0, 1) * pl.Input("push"))
    stepper = pl.Stepper(model, step=H, record_every=1)
    stepper.advance(20)
    stepper.set_input("push", 0.5)
    stepper.advance(7)
    state = pickle.loads(pickle.dumps(stepper.state))
    stepper.advance(30)
    end = stepper.coordinates, stepper.energy
    stepper.reset(state)
    assert stepper.time == pytest.approx(27 * H)
    assert len(stepper.result.time) == 1
    stepper.advance(30)
    assert np.array_equal(stepper.coordinates, end[0])
    assert stepper.energy == end[1]
    other = pl.Stepper(model, step=H)
    other.reset(state)
    other.advance(30)
    assert np.array_equal(other.coordinates, end[0])
    stepper.reset()
    stepper.advance(20)
    stepper.set_input("push", 0.5)
    stepper.advance(37)
    assert np.array_equal(stepper.coordinates, end[0])
    started = pl.Stepper(model, step=H, start=state)
    assert started.time == 0.0
    assert np.array_equal(started.positions("rope"), state.bodies["rope"].r)


@pytest.mark.parametrize("kind", ["no force", "input", "callable"])
def test_saved_steppers_continue_with_the_same_bits(tmp_path: Path, kind: str) -> None:
    forces = {"input": (0, 0, 1) * pl.Input("push", 0.1), "callable": lambda t: (0, 0, push(t))}
    model, _ = machine(forces.get(kind))
    stepper = pl.Stepper(model, step=H, record_every=3)
    stepper.advance(25)
    if kind == "input":
        stepper.set_input("push", -0.2)
    stepper.save(tmp_path / "a")
    loaded = pl.Stepper.load(tmp_path / "a", model=model if kind == "callable" else None)
    for one in (stepper, loaded):
        one.advance(25)
    same(loaded.result, stepper.result)
    assert loaded.statistics.steps == stepper.statistics.steps
    fresh = pl.Stepper(model, step=H)
    loaded.reset()
    for one in (loaded, fresh):
        one.advance(5)
    assert np.array_equal(loaded.coordinates, fresh.coordinates)


def test_a_model_with_callables_must_be_given_again(tmp_path: Path) -> None:
    model, _ = machine(lambda t: (0, 0, push(t)))
    pl.Stepper(model, step=H).save(tmp_path / "a")
    with pytest.raises(pl.ModelError, match="give the model"):
        pl.Stepper.load(tmp_path / "a")
    with pytest.raises(pl.ModelError, match="not the model that was run"):
        pl.Stepper.load(tmp_path / "a", model=machine()[0])


class HaltError(Exception):
    """Ends a run in the middle."""


@pytest.mark.parametrize("options", [{}, {"output_every": 7}, {"output_times": [0.011, 0.05, 0.0723]}])
def test_resumed_runs_have_the_same_bits(tmp_path: Path, options: dict[str, object]) -> None:
    model, _ = machine((0, 0.3, 0) * pl.Ramp(0.05))
    plain = pl.simulate(model, duration=0.1, step=H, **options)  # type: ignore[arg-type]
    path = tmp_path / "run"
    saving = pl.simulate(model, duration=0.1, step=H, checkpoint=(path, 0.0), **options)  # type: ignore[arg-type]
    same(saving, plain)
    same(pl.resume(path), plain)
    for last in (0, 1, 30, 50, 98):
        calls = iter(range(1000))

        def halt(_: pl.Stepper, calls: object = calls, last: int = last) -> None:
            if next(calls) == last + 1:  # type: ignore[call-overload]
                raise HaltError

        with pytest.raises(HaltError):
            pl.simulate(model, duration=0.1, step=H, checkpoint=(path, 0.0), on_step=halt, **options)  # type: ignore[arg-type]
        same(pl.resume(path, on_step=lambda _: None), plain)
    assert [entry.name for entry in tmp_path.iterdir()] == ["run"]


def test_a_killed_run_resumes_with_the_same_bits(tmp_path: Path) -> None:
    path = tmp_path / "run"
    code = f"""
        import sys
        sys.path.insert(0, {str(Path(__file__).parent)!r})
        import pliant as pl
        from test_stepper import H, machine
        print("ready", flush=True)
        pl.simulate(machine()[0], duration=2.0, step=H, output_every=50, checkpoint=({str(path)!r}, 0.0))
    """
    for wait in (0.05, 0.2):
        process = subprocess.Popen([sys.executable, "-c", textwrap.dedent(code)], stdout=subprocess.PIPE)
        assert process.stdout is not None
        process.stdout.readline()
        while not path.exists():
            time.sleep(0.01)
        time.sleep(wait)
        process.kill()
        process.wait()
        process.stdout.close()
    whole = pl.simulate(machine()[0], duration=2.0, step=H, output_every=50)
    same(pl.resume(path), whole)


def test_damaged_checkpoints(tmp_path: Path) -> None:
    path = tmp_path / "run"
    stepper = pl.Stepper(machine()[0], step=H)
    stepper.advance(3)
    stepper.save(path)
    whole = path.read_bytes()
    damaged = [b"", b"hello", whole[:-1], whole[: len(whole) // 2], whole + b"x", whole[:19], whole[:40]]
    for at in (3, 18, 25, 60, 400, len(whole) // 2, len(whole) - 4):
        damaged.append(whole[:at] + bytes([whole[at] ^ 0x55]) + whole[at + 1 :])
    for contents in damaged:
        path.write_bytes(contents)
        for read in (pl.resume, pl.Stepper.load):
            with pytest.raises(pl.FileError, match="run"):
                read(path)  # type: ignore[operator]
    with pytest.raises(pl.FileError, match="no such file"):
        pl.resume(tmp_path / "none")
    with pytest.raises(pl.FileError, match="nowhere"):
        stepper.save(tmp_path / "nowhere" / "run")


def test_output_times_are_exact_and_keep_the_order() -> None:
    model, rope = machine()
    times = np.array([0.0, 0.0123, 1 / 30, 0.05, 0.0777, 0.1])
    assert np.array_equal(pl.simulate(model, duration=0.12, step=H, output_times=times).time, times)
    assert pl.simulate(model, duration=0.1, step=H, output_times=[0.05]).time.tolist() == [0.05]
    even = np.linspace(0.0, 0.1, 11)
    run = pl.simulate(model, duration=0.1, step=H, output_times=even)
    plain = pl.simulate(model, duration=0.1, step=H, output_every=10)
    # Equal legs are steps of one length: nothing is corrected or factorised between them.
    assert run.statistics.factorizations == plain.statistics.factorizations
    np.testing.assert_allclose(run.positions(rope), plain.positions(rope), atol=1e-12)

    def ends(step: float) -> np.ndarray:
        return pl.simulate(model, duration=0.1, step=step, output_times=times).positions(rope)

    fine = ends(H / 32)
    errors = [np.abs(ends(H / k) - fine).max() for k in (1, 2, 4)]
    # Second order: a quarter for half the step, with room for steps that are rounded to fit.
    assert errors[1] < 0.4 * errors[0]
    assert errors[2] < 0.4 * errors[1]


def test_on_step_sees_sets_and_ends() -> None:
    model, _ = machine((0, 0, 1) * pl.Input("push"))
    seen = []

    def control(stepper: pl.Stepper) -> bool:
        seen.append(stepper.time)
        stepper.set_input("push", 0.1)
        return stepper.time > 0.0195

    result = pl.simulate(model, duration=0.1, step=H, on_step=control, output_every=6)
    np.testing.assert_allclose(seen, np.arange(21) * H, atol=1e-12)
    np.testing.assert_allclose(result.time, np.array([0, 6, 12, 18, 20]) * H, atol=1e-12)
    assert result.energy.work[-1] != 0.0


def test_many_runs_have_the_bits_of_single_ones() -> None:
    models = [machine((0, 0.1 * k, 0))[0] for k in range(4)]
    results = pl.simulate_many(models, duration=0.05, step=H, threads=3)
    for model, result in zip(models, results, strict=True):
        same(result, pl.simulate(model, duration=0.05, step=H))
    assert pl.simulate_many([], duration=1.0, step=H) == []


def test_many_runs_are_all_finished_when_one_fails() -> None:
    models = [machine()[0], machine(lambda t: (0, 0, np.nan if t > 0.01 else 0.0))[0], machine()[0]]
    with pytest.raises(pl.ModelError, match="push") as caught:
        pl.simulate_many(models, duration=0.05, step=H, threads=2)
    results = caught.value.results  # type: ignore[attr-defined]
    assert [type(result) for result in results] == [pl.Result, pl.ModelError, pl.Result]


def test_steppers_in_threads_do_not_disturb_each_other() -> None:
    model, _ = machine((0, 0, 1) * pl.Input("push"))

    def work(value: float) -> np.ndarray:
        stepper = pl.Stepper(model, step=H)
        stepper.set_input("push", value)
        for _ in range(50):
            stepper.advance()
        return stepper.coordinates

    alone = [work(value) for value in (0.1, 0.2)]
    found: dict[int, np.ndarray] = {}

    def keep(k: int, job: Callable[[float], np.ndarray]) -> None:
        found[k] = job((0.1, 0.2)[k])

    threads = [threading.Thread(target=keep, args=(k, work)) for k in range(2)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    for k in range(2):
        assert np.array_equal(found[k], alone[k])


def test_interrupted_steppers_and_runs_keep_what_they_have(tmp_path: Path) -> None:
    model, _ = machine()
    stepper = pl.Stepper(model, step=1e-4, record_every=100)
    for run in (
        lambda: stepper.advance(10**7),
        lambda: pl.simulate(model, duration=1e3, step=1e-4, output_every=100, checkpoint=tmp_path / "run"),
    ):
        timer = threading.Timer(0.3, os.kill, (os.getpid(), signal.SIGINT))
        timer.start()
        with pytest.raises(KeyboardInterrupt) as caught:
            run()
        assert len(caught.value.result.time) > 1  # type: ignore[attr-defined]
    stepper.advance()
    assert pl.Stepper.load(tmp_path / "run")._steps == caught.value.result.statistics.steps  # type: ignore[attr-defined]


@pytest.mark.slow
@pytest.mark.timeout(3600)
def test_a_million_steps_neither_leak_nor_drift() -> None:
    import resource

    model = pl.Model(gravity=(0, 0, -9.81))
    rubber = pl.LinearElastic(1e7, 0.45, 1000.0, retardation_time=1e-3)
    rope = model.add_cable([(0, 0, 0), (0.5, 0, 0)], elements=2, section=pl.Circle(5e-3), material=rubber)
    model.pin(rope.start)
    model.add_force(rope.end, (0.2, 0, 0) * pl.Input("push"))
    stepper = pl.Stepper(model, step=H)
    stepper.advance(100_000)
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    for k in range(90):
        stepper.set_input("push", (-1.0) ** k)
        stepper.advance(10_000)
        # Newton leaves 1e-10 of the model's size, here 0.5 m, at every step; nothing adds up.
        assert np.abs(stepper.position(rope.start)).max() < 1e-10
    assert stepper.statistics.steps == 10**6
    grown = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before
    # Less than a byte a step [kB].
    assert grown < 900


def test_a_stepper_reads_rigid_bodies():
    model = pl.Model(gravity=(0, 0, -9.81))
    bar = model.add_rigid_body(mass=2.0, shape=pl.Box((1.0, 0.1, 0.1)), position=(0.5, 0, 0))
    hinge = model.hinge(bar.at((-0.5, 0, 0)), None, axis=(0, 1, 0))
    stepper = pl.Stepper(model, step=1e-3, threads=1)
    result = pl.simulate(model, duration=0.1, step=1e-3, threads=1)
    stepper.advance(100)
    assert np.array_equal(stepper.position(bar.center), result.track(bar.center).position[-1])
    ours = stepper.track(bar.center).orientation
    theirs = result.track(bar.center).orientation[-1]
    assert np.array_equal(ours.as_matrix(), theirs.as_matrix())
    assert np.array_equal(stepper.reaction(hinge).moment, result.reaction(hinge).moment[-1])
    before = stepper.state
    stepper.advance(50)
    once = stepper.coordinates.copy()
    stepper.reset(before)
    stepper.advance(50)
    assert np.array_equal(stepper.coordinates, once)


def test_places_that_a_stepper_keeps_are_those_of_its_own_points() -> None:
    rubber = pl.LinearElastic(1e7, 0.45, 1000.0)
    model = pl.Model(gravity=(0, 0, -9.81))
    twin = model.copy()
    line, section = [(0, 0, 0), (1, 0, 0)], pl.Circle(5e-3)
    rope = model.add_cable(line, elements=4, section=section, material=rubber, name="rope")
    ball = model.add_point_mass(1.0, at=rope.at(0.3))
    brick = model.add_rigid_body(
        mass=1.0, shape=pl.Box((0.1, 0.2, 0.3)), angular_velocity=(1, 2, 3), name="thing"
    )
    model.pin(rope.start)
    stepper = pl.Stepper(model, step=1e-2)
    points = [rope.end, rope.at(0.613), rope.at(0.3), ball, brick.at((0.1, -0.2, 0.3)), brick]
    start = [stepper.position(point) for point in points]
    for _ in range(3):
        stepper.advance()
        for point in points:
            # The same products, added in the same order.
            track = stepper.track(point if isinstance(point, pl.Point | pl.PointMass) else point.center)
            np.testing.assert_array_equal(stepper.position(point), track.position)
            np.testing.assert_array_equal(stepper.velocity(point), track.velocity)
            # What is given is a copy.
            stepper.position(point)[:] = np.nan
    assert all((stepper.position(p) != x).any() for p, x in zip(points, start, strict=True) if p is not brick)
    stepper.reset()
    for point, x in zip(points, start, strict=True):
        np.testing.assert_array_equal(stepper.position(point), x)
    # Points of other models, those that are equal in all but the model included, and of what is not there.
    other = pl.Model()
    stranger = other.add_cable(line, elements=4, section=section, material=rubber, name="rope")
    with pytest.raises(pl.ModelError, match="another model"):
        stepper.position(stranger.end)
    finer = twin.add_cable(line, elements=8, section=section, material=rubber, name="rope")
    thing = twin.add_cable(line, elements=1, section=section, material=rubber, name="thing")
    for wrong in (finer.end, thing.start, thing, rope, brick.at, None, [0.0, 0.0, 0.0], "rope"):
        with pytest.raises(pl.ModelError, match="point"):
            stepper.position(wrong)  # type: ignore[arg-type]


def test_a_stepper_keeps_few_places(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("pliant.stepper.KNOWN_PLACES", 4)
    model, rope = machine()
    stepper = pl.Stepper(model, step=H)
    places = np.linspace(0.05, 0.95, 11)
    # At the start the rope is straight: the place is the arc length.
    found = [stepper.position(rope.at(float(s)))[0] for s in places]
    np.testing.assert_allclose(found, places, atol=1e-12)
    assert len(stepper._places) <= 4
