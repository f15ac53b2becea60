"""Runs whose steps the accuracy decides: what is kept, bits, errors that teach."""

import math

import numpy as np
import pliant as pl
import pytest
from verification.cables import rubber_pendulum


def pendulum():
    return rubber_pendulum(6)


OPTIONS = {"duration": 0.3, "step": "auto", "rtol": 1e-5, "threads": 1}


def test_times_asked_for_are_met_exactly():
    times = [0.0, 0.013, 0.1, 0.3]
    result = pl.simulate(pendulum()[0], output_times=times, **OPTIONS)
    assert result.time.tolist() == times


def test_every_accepted_step_is_kept_and_counted():
    result = pl.simulate(pendulum()[0], **OPTIONS)
    assert len(result.time) == result.statistics.steps + 1
    assert result.time[[0, -1]].tolist() == [0.0, 0.3]
    assert np.diff(result.time).max() > 1.5 * np.diff(result.time).min()
    third = pl.simulate(pendulum()[0], output_every=3, **OPTIONS)
    kept = [*result.time[::3].tolist(), 0.3]
    assert third.time.tolist() == sorted(set(kept))


def test_tolerances_in_metres_and_relative_ones_agree():
    # The model is 1 m long.
    relative = pl.simulate(pendulum()[0], **OPTIONS)
    absolute = pl.simulate(pendulum()[0], **{**OPTIONS, "rtol": 0.0, "atol": 1e-5})
    assert np.array_equal(relative.time, absolute.time)


def test_no_step_is_longer_than_allowed():
    result = pl.simulate(pendulum()[0], max_step=2e-3, **OPTIONS)
    assert np.diff(result.time).max() <= 2e-3 * (1 + 1e-12)


def test_a_checkpoint_continues_with_the_same_bits(tmp_path):
    file = tmp_path / "run.checkpoint"
    whole = pl.simulate(pendulum()[0], **OPTIONS)

    def stop(stepper):
        if stepper.time > 0.1:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        pl.simulate(pendulum()[0], checkpoint=file, on_step=stop, **OPTIONS)
    rest = pl.resume(file, on_step=lambda _: None)
    assert np.array_equal(rest.time, whole.time)
    assert np.array_equal(rest.positions("cable1"), whole.positions("cable1"))


def test_a_stepper_goes_back_bit_for_bit():
    model, cable = pendulum()
    stepper = pl.Stepper(model, step="auto", rtol=1e-5, threads=1)
    stepper.advance(10)
    state, times = stepper.state, []
    for _ in range(2):
        stepper.advance(until=0.2)
        assert stepper.time == 0.2
        times.append((stepper.statistics.steps, stepper.position(cable.end).tobytes()))
        stepper.reset(state)
    assert times[0][1] == times[1][1]


def test_fixed_steps_can_end_at_a_time():
    model, _ = pendulum()
    stepper = pl.Stepper(model, step=1e-3, threads=1)
    stepper.advance(until=0.0105)
    assert stepper.time == 0.0105
    assert stepper.statistics.steps == 11
    stepper.advance(until=0.0105)
    assert stepper.statistics.steps == 11


def test_what_cannot_be_met_is_said():
    model, cable = pendulum()
    model.add_force(cable.end, lambda t: (0, 0, math.nan if t > 0.1 else 0.0))
    with pytest.raises(pl.ModelError, match="finite") as failure:
        pl.simulate(model, **OPTIONS)
    # What was computed stays.
    assert 0.0 < failure.value.result.time[-1] <= 0.1


def test_a_load_without_bound_ends_the_run_with_reasons():
    model, cable = pendulum()
    model.add_force(cable.end, lambda t: (0, 0, 0.1 / (0.1 - t) ** 2 if t != 0.1 else 1e30))
    with pytest.raises((pl.ConvergenceError, pl.ModelError)) as failure:
        pl.simulate(model, **OPTIONS)
    error = failure.value
    assert error.time == pytest.approx(0.1, abs=1e-3)
    assert error.body == "cable1"
    assert error.step < 1e-4
    assert error.result.time[-1] < 0.1
