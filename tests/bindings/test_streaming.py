"""Results that grow on disk: the same rows, readable at every moment, whatever happens to the run."""

from __future__ import annotations

import gc
import os
import re
import signal
import subprocess
import sys
import textwrap
import threading
import time
from dataclasses import fields
from pathlib import Path

import numpy as np
import pliant as pl
import pytest
from pliant import streams

h5py = pytest.importorskip("h5py")

H = 1e-3
DOCS = Path(__file__).parents[2] / "docs"


def machine() -> tuple[pl.Model, pl.Cable]:
    rubber = pl.LinearElastic(1e7, 0.45, 1000.0)
    model = pl.Model(gravity=(0, 0, -9.81))
    rope = model.add_cable(
        [(0, 0, 0), (1, 0, 0)], elements=6, section=pl.Circle(5e-3), material=rubber, name="rope"
    )
    model.pin(rope.start, name="hook")
    plate = model.add_rigid_body(mass=0.1, shape=pl.Box((0.1, 0.1, 0.02)), position=(1, 0, 0), name="plate")
    model.hinge(rope.end, plate, axis=(0, 1, 0), name="axle")
    return model, rope


@pytest.fixture
def on_disk(monkeypatch: pytest.MonkeyPatch) -> None:
    """Small blocks, and no file small enough to be read whole."""
    monkeypatch.setattr(streams, "BLOCK", 20_000)
    monkeypatch.setattr(streams, "IN_MEMORY", 0)


def same(one: pl.Result, other: pl.Result) -> None:
    for entry in fields(one._records):
        ours, theirs = (getattr(r._records, entry.name)[:] for r in (one, other))
        np.testing.assert_array_equal(ours, theirs, err_msg=entry.name)


@pytest.mark.usefixtures("on_disk")
def test_a_streamed_result_reads_like_one_in_memory(tmp_path: Path) -> None:
    model, rope = machine()
    path = tmp_path / "run.h5"
    plain = pl.simulate(model, duration=0.3, step=H)
    streamed = pl.simulate(model, duration=0.3, step=H, output=path)
    loaded = pl.Result.load(path)
    with h5py.File(path) as file:
        assert len(file["blocks/end"]) > 1
    for result in (streamed, loaded):
        assert not isinstance(result._records.q, np.ndarray)
        same(result, plain)
        assert result.statistics.steps == 300
        for read in (
            lambda r: r.positions(rope),
            lambda r: r.velocities("plate"),
            lambda r: r.track(rope.at(0.3)).acceleration,
            lambda r: r.reaction(r.model["hook"]).force,
            lambda r: r.reaction(r.model["axle"]).moment,
            lambda r: r.axial_force(rope),
            lambda r: r.strain(rope).curvature,
            lambda r: r.energy.total,
            lambda r: r.angular_momentum,
            lambda r: r.center_of_mass(rope),
            lambda r: r.center_of_mass(),
            lambda r: r.state(-1).q,
            lambda r: r.state(17).lambda_,
        ):
            np.testing.assert_array_equal(read(result), read(plain))
    # A result of rows on disk saves itself as any other, also over its own file.
    loaded.save(path)
    same(pl.Result.load(path), plain)


def test_rows_are_indexed_as_numpy_does(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(streams, "BLOCK", 20_000)
    model, _ = machine()
    kept = pl.simulate(model, duration=0.1, step=H)._records.q
    pl.simulate(model, duration=0.1, step=H, output=tmp_path / "run.h5")
    monkeypatch.setattr(streams, "IN_MEMORY", 0)
    rows = pl.Result.load(tmp_path / "run.h5")._records.q
    columns = np.array([[3, 4, 5], [0, 1, 2]])
    for key in (
        3,
        -1,
        slice(None),
        slice(5, 60),
        slice(60, 5),
        slice(-3, None),
        slice(None, None, 7),
        np.array([4, 99, 0]),
        (slice(None), columns),
        (slice(10, 20), columns),
        (7, columns),
    ):
        np.testing.assert_array_equal(rows[key], kept[key])  # type: ignore[index]
    with pytest.raises(IndexError):
        rows[101]


def test_a_file_that_grows_is_read_at_any_time(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(streams, "SECONDS", 0.0)
    model, rope = machine()
    path = tmp_path / "run.h5"
    stepper = pl.Stepper(model, step=H, record_every=1, output=path)
    counts = []
    for _ in range(4):
        stepper.advance(10)
        counts.append(len(pl.Result.load(path).time))
    assert counts == [11, 21, 31, 41]
    assert stepper.result.positions(rope).shape == (41, 7, 3)
    stepper.reset()
    stepper.advance(5)
    assert len(stepper.result.time) == 6
    # Forgotten, the stepper closes its file: any reader opens it.
    del stepper
    gc.collect()
    with h5py.File(path) as file:
        assert file["records/time"].shape == (6,)
        assert file["records/q"].attrs["unit"] == "m, 1"


def test_ctrl_c_leaves_a_closed_file(tmp_path: Path) -> None:
    model, _ = machine()
    path = tmp_path / "run.h5"
    threading.Timer(0.4, os.kill, (os.getpid(), signal.SIGINT)).start()
    with pytest.raises(KeyboardInterrupt) as caught:
        pl.simulate(model, duration=1000.0, step=H, output_every=10, output=path)
    result = caught.value.result  # type: ignore[attr-defined]
    with h5py.File(path) as file:
        assert len(file["records/time"]) == len(result.time) > 1


def test_a_run_that_fails_leaves_what_it_had(tmp_path: Path) -> None:
    model, rope = machine()
    model.add_force(rope.end, lambda t: (0, 0, 1.0 if t < 0.05 else np.nan))
    with pytest.raises((pl.ModelError, pl.ConvergenceError)) as caught:
        pl.simulate(model, duration=1.0, step=H, output=tmp_path / "run.h5")
    assert len(caught.value.result.time) > 40  # type: ignore[union-attr]
    assert len(pl.Result.load(tmp_path / "run.h5").time) > 40


KILLED = """
    import sys
    sys.path.insert(0, sys.argv[1])
    import pliant as pl
    from pliant import streams
    from test_streaming import H, machine
    streams.SECONDS = 0.1
    model, rope = machine()
    save = (sys.argv[3], 0.3)
    pl.simulate(model, duration=60.0, step=H, output_every=5, output=sys.argv[2], checkpoint=save)
"""


def test_a_killed_run_leaves_a_result_and_goes_on_with_the_same_bits(tmp_path: Path) -> None:
    result, checkpoint = tmp_path / "run.h5", tmp_path / "run.checkpoint"
    command = [sys.executable, "-c", textwrap.dedent(KILLED), str(Path(__file__).parent), result, checkpoint]
    process = subprocess.Popen(command)
    try:
        deadline = time.monotonic() + 60
        while not checkpoint.exists() and time.monotonic() < deadline:
            time.sleep(0.05)
        time.sleep(0.3)
    finally:
        process.kill()
        process.wait()
    left = pl.Result.load(result)
    assert 10 < len(left.time) < 12000
    # What the killed run wrote is what a run writes that nothing happens to.
    model, _ = machine()
    n = len(left.time) - 1
    whole = pl.simulate(model, duration=5 * n * H, step=60.0 / 60000, output_every=5)
    same(left, whole)
    # It goes on in the file from the checkpoint on, whose rows are not more than the file's.
    stepper = pl.Stepper.load(checkpoint)
    assert len(stepper.result.time) <= len(left.time)
    while stepper._steps < 5 * n:
        stepper._take(5 * n - stepper._steps, 60.0 / 60000, 5)
    same(stepper.result, whole)
    stepper._finish()
    same(pl.Result.load(result), whole)


def test_a_run_resumes_in_its_file(tmp_path: Path) -> None:
    model, _ = machine()
    result, checkpoint = tmp_path / "run.h5", tmp_path / "run.checkpoint"
    whole = pl.simulate(model, duration=0.2, step=H)

    def stop(stepper: pl.Stepper) -> None:
        if stepper._steps == 120:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        pl.simulate(model, duration=0.2, step=H, on_step=stop, output=result, checkpoint=checkpoint)
    assert len(pl.Result.load(result).time) == 121
    same(pl.resume(checkpoint, on_step=lambda _: None), whole)
    same(pl.Result.load(result), whole)
    result.unlink()
    with pytest.raises(pl.FileError, match=r"run\.h5"):
        pl.resume(checkpoint, on_step=lambda _: None)


def test_files_are_starts(tmp_path: Path) -> None:
    model, rope = machine()
    result, checkpoint = tmp_path / "run.h5", tmp_path / "run.checkpoint"
    first = pl.simulate(model, duration=0.1, step=H, output=result, checkpoint=checkpoint)
    wanted = pl.simulate(model, duration=0.1, step=H, start=first)
    for start in (result, str(checkpoint), checkpoint):
        again = pl.simulate(model, duration=0.1, step=H, start=start)
        np.testing.assert_array_equal(again.positions(rope), wanted.positions(rope))
    assert pl.solve_modes(model, count=1, about=checkpoint).frequencies.shape == (1,)
    with pytest.raises(pl.FileError, match="no such file"):
        pl.simulate(model, duration=0.1, step=H, start=tmp_path / "nothing")


@pytest.mark.usefixtures("on_disk")
def test_damaged_rows_are_recognised_when_read(tmp_path: Path) -> None:
    model, rope = machine()
    path = tmp_path / "run.h5"
    pl.simulate(model, duration=0.1, step=H, output=path)
    with h5py.File(path) as file:
        marked = file["records/q"][50].tobytes()
    data = bytearray(path.read_bytes())
    place = data.index(marked)
    data[place + 9] ^= 16
    path.write_bytes(data)
    result = pl.Result.load(path)
    with pytest.raises(pl.FileError, match=r"rows .* of q do not match their digest"):
        result.positions(rope)
    assert result.velocities(rope).shape == (101, 7, 3)


def test_bad_outputs_are_refused(tmp_path: Path) -> None:
    model, _ = machine()
    for bad in (3, "", tmp_path / "nowhere" / "run.h5"):
        with pytest.raises((pl.ModelError, pl.FileError), match=r"output|nowhere"):
            pl.simulate(model, duration=0.1, step=H, output=bad)  # type: ignore[arg-type]
    with pytest.raises(pl.ModelError, match="output"):
        pl.simulate_many([model], duration=0.1, step=H, output=tmp_path / "run.h5")


def test_memory_stays_bounded(tmp_path: Path) -> None:
    # 100,000 rows of 3 x 84 numbers are 200 MB, and may not stay in memory.
    code = f"""
    import resource, sys
    sys.path.insert(0, {str(Path(__file__).parent)!r})
    import pliant as pl
    from test_streaming import machine
    def peak():
        return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024
    model, rope = machine()
    pl.simulate(model, duration=2e-2, step=1e-4, output={str(tmp_path / "a.h5")!r})
    before = peak()
    result = pl.simulate(model, duration=3.0, step=1e-4, output={str(tmp_path / "b.h5")!r})
    print(peak() - before, len(result.time), result.track(rope.end).position.shape, peak() - before)
    """
    run = subprocess.run(
        [sys.executable, "-c", textwrap.dedent(code)], check=True, capture_output=True, text=True
    )
    writing, rows, *_, reading = run.stdout.split()
    size = (tmp_path / "b.h5").stat().st_size
    assert int(rows) == 30_001
    # Blocks of 4 MB, a few copies of them, and the buffers of HDF5.
    assert int(writing) < 40e6 < size
    assert int(reading) < 60e6


def test_the_layout_is_that_of_the_page(tmp_path: Path) -> None:
    model, _ = machine()
    pl.simulate(model, duration=0.1, step=H, output=tmp_path / "run.h5")
    page = (DOCS / "files.md").read_text(encoding="utf-8")
    rows = re.findall(r"^\| (`.*?) \| (.*?) \| (.*?) ?\| (.*?) \|$", page, re.M)
    documented = {name: row for row in rows for name in re.findall(r"`([^`]+)`", row[0])}
    found = {}
    with h5py.File(tmp_path / "run.h5") as file:
        file.visititems(
            lambda name, item: (
                found.update({name: item.attrs.get("unit", "")}) if isinstance(item, h5py.Dataset) else None
            )
        )
        general = {
            re.sub(r"^offsets/.*", "offsets/<body>", re.sub(r"arrays/\d+", "arrays/<k>", name)): unit
            for name, unit in found.items()
        }
        assert set(general) == {name for name in documented if "/" in name or name in general}
        for name, unit in general.items():
            assert documented[name][2] == unit, name
        for name in documented:
            if name.startswith("records/"):
                assert documented[name][3] == file[name].attrs["meaning"]
        assert set(file.attrs) == {"format", "version", "kind", "digest"}
        assert f'"{file.attrs["format"]}", version {file.attrs["version"]}' in page
