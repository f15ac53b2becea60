"""Runs through the compiled core: dynamics, statics, modes, restarts, reactions, files."""

from __future__ import annotations

import json
import os
import re
import signal
import threading
import time
from pathlib import Path

import numpy as np
import pliant as pl
import pytest

SECTION = pl.Circle(radius=5e-3)
DOWN = np.array([0, 0, -9.81])


def hanging(rubber: pl.LinearElastic, parts: int = 1, **options: object) -> tuple[pl.Model, list[pl.Cable]]:
    """A vertical rope of 1 m in equal parts pinned together, hung up at the top."""
    model = pl.Model(gravity=DOWN)
    ropes = [
        model.add_cable(
            [(0, 0, -k / parts), (0, 0, -(k + 1) / parts)],
            elements=6 // parts,
            section=SECTION,
            material=rubber,
            **options,  # type: ignore[arg-type]
        )
        for k in range(parts)
    ]
    model.pin(ropes[0].start, name="hook")
    for k in range(1, parts):
        model.pin(ropes[k - 1].end, ropes[k].start, name=f"knot{k}")
    return model, ropes


def test_free_fall_is_exact(rubber: pl.LinearElastic) -> None:
    model = pl.Model(gravity=DOWN)
    rope = model.add_cable(
        [(0, 0, 0), (1, 0, 0), (1, 1, 0)], elements=6, section=SECTION, material=rubber, velocity=(1, 0, 0)
    )
    ball = model.add_point_mass(2.0, at=(0, 0, 5), velocity=(0, 1, 0))
    result = pl.simulate(model, duration=1.0, step=0.01)
    t = result.time[:, None]
    start = result.positions(rope)[0]
    expected = start + t[..., None] * np.array([1, 0, 0]) + 0.5 * DOWN * t[..., None] ** 2
    np.testing.assert_allclose(result.positions(rope), expected, atol=1e-10)
    np.testing.assert_allclose(result.track(ball.center).position[-1], (0, 1, 5 - 4.905), atol=1e-10)
    mass = 2.0 + 2.0 * SECTION.area * 1000.0
    np.testing.assert_allclose(
        result.momentum[-1], mass * DOWN + [2.0 * SECTION.area * 1000.0, 2.0, 0], rtol=1e-10
    )
    np.testing.assert_allclose(result.energy.total, result.energy.total[0], atol=1e-9)
    np.testing.assert_allclose(result.center_of_mass(rope)[0], (0.75, 0.25, 0), atol=1e-12)
    assert result.statistics.steps == 100
    assert result.statistics.peak_memory > 0


def test_rotation_keeps_its_momentum(rubber: pl.LinearElastic) -> None:
    model = pl.Model()
    rope = model.add_cable(
        [(-0.5, 0, 0), (0.5, 0, 0)],
        elements=4,
        section=SECTION,
        material=rubber,
        angular_velocity=(0, 0, 2.0),
    )
    result = pl.simulate(model, duration=0.1, step=1e-3)
    inertia = SECTION.area * 1000.0 / 12.0
    np.testing.assert_allclose(result.angular_momentum[:, 2], 2.0 * inertia, rtol=1e-5)
    np.testing.assert_allclose(result.velocities(rope)[0, -1], (0, 1, 0), atol=1e-12)


@pytest.mark.parametrize("parts", [1, 2, 3])
def test_statics_and_reactions_of_a_hanging_rope(rubber: pl.LinearElastic, parts: int) -> None:
    model, ropes = hanging(rubber, parts)
    model.add_point_mass(0.2, at=ropes[-1].end)
    if parts > 1:
        model.add_point_mass(0.1, at=ropes[0].end)
        model.add_force(ropes[0].end, (0, 0, -0.5))
    model.add_line_load(ropes[0], (0, 0, -0.3))
    result = pl.solve_static(model, load_steps=2)
    weight = SECTION.area * 1000.0 * 9.81
    rest = 0.2 * 9.81
    top = weight + rest + 0.3 / parts + (0.1 * 9.81 + 0.5 if parts > 1 else 0.0)
    np.testing.assert_allclose(
        result.reaction(model["hook"]).force, np.outer(result.load_factor, (0, 0, top)), atol=1e-9 * top
    )
    for k in range(1, parts):
        below = weight * (1 - k / parts) + rest
        # What the knot exerts on the upper rope; what hangs at its end is not in it.
        knot = result.reaction(model[f"knot{k}"]).force
        np.testing.assert_allclose(knot[-1], (0, 0, -below), atol=1e-8)
        np.testing.assert_allclose(knot, np.outer(result.load_factor, knot[-1]), atol=1e-8)
    assert result.load_factor[-1] == 1.0


def test_pretension_is_the_axial_force(rubber: pl.LinearElastic) -> None:
    for strain in ("green_lagrange", "biot"):
        model = pl.Model()
        line = [(0, 0, 0), (2, 0, 0)]
        rope = model.add_cable(
            line, elements=4, section=SECTION, material=rubber, pretension=40.0, strain=strain
        )
        model.pin(rope.start)
        model.pin(rope.end)
        result = pl.solve_static(model)
        np.testing.assert_allclose(result.axial_force(rope), 40.0, rtol=1e-12)
        assert result.reaction(model["pin2"]).force[-1, 0] == pytest.approx(40.0)


def test_tapers_under_pretension_are_in_equilibrium(rubber: pl.LinearElastic) -> None:
    model = pl.Model()
    sections = [pl.Circle(5e-3 * (1 + 0.1 * k)) for k in range(4)]
    rope = model.add_cable(
        [(0, 0, 0), (2, 0, 0)], elements=4, section=sections, material=rubber, pretension=40.0
    )
    model.pin(rope.start)
    model.pin(rope.end)
    np.testing.assert_allclose(pl.solve_static(model).axial_force(rope), 40.0, rtol=0.05)


def test_modes_of_a_string(steel: pl.LinearElastic) -> None:
    model = pl.Model()
    wire = model.add_cable(
        [(0, 0, 0), (1, 0, 0)], elements=20, section=pl.Circle(1e-4), material=steel, pretension=10.0
    )
    model.pin(wire.start)
    model.pin(wire.end)
    modes = pl.solve_modes(model, count=4, about=pl.solve_static(model))
    first = 0.5 * np.sqrt(10.0 / (7850.0 * np.pi * 1e-8))
    np.testing.assert_allclose(modes.frequencies, [first, first, 2 * first, 2 * first], rtol=1e-3)
    assert modes.stable
    assert modes.positions(wire).shape == (4, 21, 3)
    assert modes.eigenvalues.dtype == complex


def test_statics_then_dynamics_rests(rubber: pl.LinearElastic) -> None:
    model, ropes = hanging(rubber, 2)
    rest = pl.solve_static(model)
    result = pl.simulate(model, duration=0.05, step=1e-3, start=rest)
    np.testing.assert_allclose(result.positions(ropes[1])[-1], rest.positions(ropes[1])[-1], atol=1e-9)
    np.testing.assert_allclose(
        result.reaction(model["knot1"]).force[-1], rest.reaction(model["knot1"]).force[-1], atol=1e-5
    )


def test_dynamic_knots_balance_momentum(rubber: pl.LinearElastic) -> None:
    model, ropes = hanging(rubber, 2, velocity=lambda x: 3.0 * x[:, 2:] * np.array([[1.0, 0, 0]]))
    model.add_point_mass(0.05, at=ropes[1].end)
    model.add_point_mass(0.05, at=ropes[1].start)
    result = pl.simulate(model, duration=0.2, step=2e-4)
    mass = SECTION.area * 1000.0 / 2
    lower = mass * result.center_of_mass(ropes[1])
    for point in (ropes[1].start, ropes[1].end):
        lower = lower + 0.05 * result.track(point).position
    h = result.time[1]
    needed = (lower[2:] - 2 * lower[1:-1] + lower[:-2]) / h**2 - (mass + 0.1) * DOWN
    knot = result.reaction(model["knot1"]).force[1:-1]
    scale = np.abs(needed).max()
    assert np.sqrt(((knot + needed) ** 2).mean()) < 2e-2 * scale


def test_a_run_continues_where_another_stopped(rubber: pl.LinearElastic) -> None:
    model, ropes = hanging(rubber, 1, velocity=lambda x: 3.0 * x[:, 2:] * np.array([[1.0, 0, 0]]))
    whole = pl.simulate(model, duration=0.2, step=2e-4)
    half = pl.simulate(model, duration=0.1, step=2e-4)
    rest = pl.simulate(model, duration=0.1, step=2e-4, start=half)
    middle = pl.simulate(model, duration=0.1, step=2e-4, start=whole.state(500))
    for run in (rest, middle):
        assert run.time[0] == 0.0
        np.testing.assert_allclose(run.positions(ropes[0])[-1], whole.positions(ropes[0])[-1], atol=1e-5)


def test_a_released_knot_lets_the_rope_fall(rubber: pl.LinearElastic) -> None:
    held, ropes = hanging(rubber, 2)
    free = pl.Model.from_document(held.to_document())
    del free._joints["knot1"]
    result = pl.simulate(free, duration=0.1, step=1e-3, start=pl.solve_static(held))
    fallen = result.center_of_mass(ropes[1])
    assert fallen[-1, 2] - fallen[0, 2] == pytest.approx(-0.5 * 9.81 * 0.01, rel=1e-6)


def test_a_catch_projects_velocities_and_warns(rubber: pl.LinearElastic) -> None:
    model = pl.Model()
    ball = model.add_point_mass(1.0, at=(0, 0, 0), velocity=(2, 0, 0))
    other = model.add_point_mass(3.0, at=(0.2, 0, 0))
    flying = pl.simulate(model, duration=0.1, step=0.01)
    caught = model.copy()
    caught.add_force(ball, (0, 0, 0))
    with pytest.raises(pl.ModelError, match="apart"):
        caught.pin(ball, other)
    caught._joints["catch"] = pl.joints.Pin("catch", ball.center, other.center)
    with pytest.warns(UserWarning, match="projected"):
        result = pl.simulate(caught, duration=0.1, step=0.01, start=flying)
    np.testing.assert_allclose(result.velocities(other)[-1, 0], (0.5, 0, 0), atol=1e-9)


def test_bodies_must_be_the_same(rubber: pl.LinearElastic) -> None:
    model, _ = hanging(rubber)
    other, _ = hanging(rubber, 2)
    with pytest.raises(pl.ModelError, match="cable"):
        pl.simulate(other, duration=0.1, step=0.01, start=pl.solve_static(model))


def test_callables_and_tables_agree(rubber: pl.LinearElastic) -> None:
    ends = []
    ramp = (0, 0.2, 0) * pl.Ramp(0.1)
    forces = [ramp, lambda t: ramp(t), pl.Table([0.0, 0.2], [(0, 0.1, 0), (0, 0.1, 0)]), (0, 0.1, 0)]
    for force in forces:
        model, ropes = hanging(rubber)
        model.add_force(ropes[0].end, force)
        result = pl.simulate(model, duration=0.2, step=1e-3)
        ends.append(result.track(ropes[0].end).position[-1])
    np.testing.assert_allclose(ends[0], ends[1], atol=1e-9)
    np.testing.assert_allclose(ends[2], ends[3], atol=1e-12)


def test_smooth_tables_are_those_of_the_core(rubber: pl.LinearElastic) -> None:
    times, values = [0.0, 0.03, 0.07, 0.1], [(0, 0, 0), (0, 0.3, 0), (0, -0.1, 0), (0, 0.2, 0)]
    table = pl.Table(times, values, smooth=True)
    ends = []
    for force in (table, lambda t: table(t)):
        model = pl.Model()
        ball = model.add_point_mass(1.0, at=(0, 0, 0))
        model.add_force(ball, force)
        ends.append(pl.simulate(model, duration=0.1, step=1e-3).positions(ball)[-1, 0])
    np.testing.assert_allclose(ends[0], ends[1], atol=1e-12)


def test_a_load_that_breaks_names_itself_and_keeps_the_result(rubber: pl.LinearElastic) -> None:
    model, ropes = hanging(rubber)
    model.add_force(ropes[0].end, lambda t: (0, 0, 0 if t < 0.05 else np.nan), name="gust")
    with pytest.raises(pl.ModelError, match=r"'gust' at t = 0\.05") as caught:
        pl.simulate(model, duration=0.1, step=1e-3)
    assert caught.value.result is not None
    assert 0.04 < caught.value.result.time[-1] < 0.0501


def test_a_velocity_that_a_joint_contradicts_is_projected_with_a_warning(rubber: pl.LinearElastic) -> None:
    model, _ = hanging(rubber, 1, velocity=(1, 0, 0))
    with pytest.warns(UserWarning, match="projected, by up to 1"):
        pl.simulate(model, duration=0.01, step=1e-3)


def test_failures_tell_when_and_where(rubber: pl.LinearElastic) -> None:
    model, ropes = hanging(rubber)
    model.add_force(ropes[0].end, lambda t: (1e14 * (t > 0.02), 0, 0))
    with pytest.raises(pl.ConvergenceError) as caught:
        pl.simulate(model, duration=0.1, step=1e-3)
    error = caught.value
    assert 0.01 < error.time < 0.03
    assert error.step > 0
    assert error.residuals
    assert error.body == ropes[0].name
    assert error.node is None or 0 <= error.node <= 6
    assert error.result is not None
    assert len(error.result.time) > 10


def test_the_last_step_is_always_kept(rubber: pl.LinearElastic) -> None:
    model, _ = hanging(rubber)
    for steps, every, expected in ((10, 3, [0, 3, 6, 9, 10]), (9, 3, [0, 3, 6, 9]), (5, 100, [0, 5])):
        result = pl.simulate(model, duration=steps * 0.01, step=0.01, output_every=every)
        np.testing.assert_allclose(result.time, np.array(expected) * 0.01, atol=1e-12)
    assert pl.simulate(model, duration=0.1, step=0.03).time[-1] == pytest.approx(0.1)


def test_spectral_radius_is_limited_with_constraints(rubber: pl.LinearElastic) -> None:
    model, _ = hanging(rubber)
    with pytest.raises(pl.ModelError, match="spectral_radius = 1"):
        pl.simulate(model, duration=0.1, step=0.01, spectral_radius=1.0)


def test_threads_do_not_change_bits(steel: pl.LinearElastic) -> None:
    model = pl.Model(gravity=DOWN)
    points = [(i, j, 0.0) for i in range(4) for j in range(4)]
    edges = [(4 * i + j, 4 * i + j + 1) for i in range(4) for j in range(3)]
    edges += [(4 * i + j, 4 * i + 4 + j) for i in range(3) for j in range(4)]
    # 8,160 elements: threads are taken for 2,000 each.
    net = model.add_cable_net(points, edges, elements=340, section=SECTION, material=steel, pretension=5.0)
    for corner in (0, 3, 12, 15):
        model.pin(net.node(corner))
    runs = [pl.simulate(model, duration=0.02, step=1e-3, threads=k) for k in (1, 2, 4)]
    for run in runs[1:]:
        assert np.array_equal(run.positions(net), runs[0].positions(net))
    assert runs[0].positions(net).shape == (21, 16 + 24 * 339, 3)
    np.testing.assert_allclose(runs[0].positions(net)[0, :16], points, atol=1e-15)
    assert runs[0].axial_force(net).shape == (21, 24)
    np.testing.assert_allclose(runs[0].axial_force(net)[0], 5.0, rtol=1e-7)


def test_results_survive_files(tmp_path: Path, rubber: pl.LinearElastic) -> None:
    model, ropes = hanging(rubber, 2)
    model.add_force(ropes[0].end, lambda t: (0.1, 0, 0))
    model.add_point_mass(1.0, at=(1, 1, 1), name="ball")
    result = pl.simulate(model, duration=0.05, step=1e-3)
    path = tmp_path / "run.h5"
    result.save(path)
    again = pl.Result.load(path)
    for rope in ropes:
        assert np.array_equal(again.positions(rope), result.positions(rope))
        assert np.array_equal(again.strain(rope).curvature, result.strain(rope).curvature)
    assert np.array_equal(again.positions("ball"), result.positions("ball"))
    assert np.array_equal(again.reaction(model["hook"]).force, result.reaction(model["hook"]).force)
    assert np.array_equal(again.energy.total, result.energy.total)
    assert again.statistics == result.statistics
    assert again.model["cable1"] == ropes[0]
    assert [entry.name for entry in tmp_path.iterdir()] == ["run.h5"]
    with pytest.raises(pl.ModelError, match="not kept"):
        pl.simulate(again.model, duration=0.1, step=0.01)


def test_damaged_result_files(tmp_path: Path, rubber: pl.LinearElastic) -> None:
    model, _ = hanging(rubber)
    path = tmp_path / "run.h5"
    pl.simulate(model, duration=0.05, step=1e-3).save(path)
    whole = path.read_bytes()
    for damaged in (b"", whole[: len(whole) // 2], b"hello", whole[:-1]):
        path.write_bytes(damaged)
        with pytest.raises(pl.FileError, match=r"run\.h5"):
            pl.Result.load(path)
    at = (
        whole.index(np.float64(0.049).tobytes()[:6])
        if np.float64(0.049).tobytes()[:6] in whole
        else len(whole) - 2000
    )
    altered = bytearray(whole)
    altered[at] ^= 0xFF
    path.write_bytes(altered)
    with pytest.raises(pl.FileError, match=r"run\.h5"):
        pl.Result.load(path)
    with pytest.raises(pl.FileError, match="no such file"):
        pl.Result.load(tmp_path / "none.h5")
    with pytest.raises(pl.FileError, match="nowhere"):
        pl.simulate(model, duration=0.01, step=1e-3).save(tmp_path / "nowhere" / "run.h5")


def test_pictures_and_page(tmp_path: Path, rubber: pl.LinearElastic) -> None:
    model, _ = hanging(rubber, 2, velocity=lambda x: x[:, 2:] * np.array([[1.0, 0.5, 0]]))
    model.add_point_mass(1.0, at=(1, 1, 1))
    result = pl.simulate(model, duration=0.05, step=1e-3)
    for color in (None, "strain", "axial_force", "speed"):
        figure = result.plot(color=color)
        figure.savefig(tmp_path / "picture.png")
    page = tmp_path / "page.html"
    result.export_html(page, color="speed")
    text = page.read_text()
    assert not re.search(r"(src|href)\s*=|https?://|@import|fetch\(", text)
    data = json.loads(text[text.index('json">') + 6 : text.index("</script>", text.index('json">'))])
    assert [body["name"] for body in data["bodies"]] == ["cable1", "cable2", "point_mass1"]
    assert len(data["time"]) == 51
    with pytest.raises(pl.ModelError, match="rainbow"):
        result.plot(color="rainbow")
    single, _ = hanging(rubber)
    run = pl.simulate(single, duration=0.05, step=1e-2)
    run.plot(color=np.linalg.norm(run.velocities("cable1"), axis=2))
    with pytest.raises(pl.ModelError, match="color"):
        run.plot(color=np.zeros((2, 2)))


def test_interrupts_keep_the_result(rubber: pl.LinearElastic) -> None:
    model, _ = hanging(rubber, 1, velocity=(0, 0, 0))
    timer = threading.Timer(0.3, os.kill, (os.getpid(), signal.SIGINT))
    timer.start()
    begin = time.perf_counter()
    with pytest.raises(KeyboardInterrupt) as caught:
        pl.simulate(model, duration=1000.0, step=1e-4, output_every=100)
    assert time.perf_counter() - begin < 5.0
    result = caught.value.result  # type: ignore[attr-defined]
    assert len(result.time) > 1
    assert result.statistics.steps > 100


def test_no_progress_bar_when_piped(capfd: pytest.CaptureFixture[str], rubber: pl.LinearElastic) -> None:
    model, _ = hanging(rubber)
    pl.simulate(model, duration=0.01, step=1e-3)
    assert capfd.readouterr() == ("", "")
    pl.simulate(model, duration=0.01, step=1e-3, progress=True)
    assert "0/10" in capfd.readouterr().err


def test_two_runs_at_once_do_not_disturb_each_other(rubber: pl.LinearElastic) -> None:
    model, ropes = hanging(rubber, 1, velocity=lambda x: 3.0 * x[:, 2:] * np.array([[1.0, 0, 0]]))
    alone = pl.simulate(model, duration=0.2, step=1e-3).positions(ropes[0])
    found: list[np.ndarray] = []
    threads = [
        threading.Thread(
            target=lambda: found.append(pl.simulate(model, duration=0.2, step=1e-3).positions(ropes[0]))
        )
        for _ in range(3)
    ]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(found) == 3
    assert all(np.array_equal(alone, other) for other in found)


def test_arcs_are_stress_free_and_stay_in_their_plane(steel: pl.LinearElastic) -> None:
    arc = pl.Curve(lambda s: (np.sin(s), 0.0, 1.0 - np.cos(s)), length=1.5)
    model = pl.Model(gravity=DOWN)
    rib = model.add_cable(arc, elements=8, section=SECTION, material=steel)
    model.clamp(rib.start)
    weightless = pl.Model()
    weightless.add_cable(arc, elements=8, section=SECTION, material=steel)
    rest = pl.simulate(weightless, duration=0.01, step=1e-3)
    assert np.abs(rest.positions("cable1")[-1] - rest.positions("cable1")[0]).max() < 1e-9
    result = pl.simulate(model, duration=0.1, step=1e-3)
    assert np.abs(result.positions(rib)[:, :, 1]).max() < 1e-12
    assert result.track(rib.end).position[-1, 2] < result.track(rib.end).position[0, 2] - 1e-4


def test_rings_hold_together(rubber: pl.LinearElastic) -> None:
    model = pl.Model(gravity=DOWN)
    square = [(0, 0, 0), (1, 0, 0), (1, 0, 1), (0, 0, 1)]
    ring = model.add_cable(square, elements=12, section=SECTION, material=rubber, closed=True)
    model.pin(ring.node(7))
    result = pl.simulate(model, duration=0.2, step=1e-3)
    assert result.positions(ring).shape == (201, 12, 3)
    total = result.energy.total
    assert np.abs(total - total[0]).max() < 1e-3 * np.ptp(result.energy.gravitational)


def test_clamps_and_pins_hold_where_another_run_left_the_rope(rubber: pl.LinearElastic) -> None:
    model = pl.Model(gravity=DOWN)
    rope = model.add_cable([(0, 0, 0), (1, 0, 0)], elements=8, section=SECTION, material=rubber)
    model.pin(rope.start, name="hook")
    fallen = pl.simulate(model, duration=0.2, step=1e-3)
    for grab in (pl.Model.clamp, pl.Model.pin):
        held = model.copy()
        joint = grab(held, rope.end)
        with pytest.warns(UserWarning, match="projected"):
            result = pl.simulate(held, duration=0.2, step=1e-3, start=fallen)
        assert np.array_equal(result.positions(rope)[0], fallen.positions(rope)[-1])
        np.testing.assert_allclose(
            result.track(rope.end).position, np.tile(fallen.track(rope.end).position[-1], (201, 1)), atol=1e-9
        )
        assert np.abs(result.reaction(joint).force[-1]).max() > 0.01
    again = pl.Model.from_document(held.to_document())
    assert len(again.joints) == 2


def test_names_with_odd_characters_survive_files(tmp_path: Path, rubber: pl.LinearElastic) -> None:
    model = pl.Model()
    for name in ("a/b", "a_b", ".", "c d%"):
        model.add_point_mass(1.0, at=(0, 0, 0), name=name)
    result = pl.simulate(model, duration=0.01, step=1e-3)
    result.save(tmp_path / "run.h5")
    assert [body.name for body in pl.Result.load(tmp_path / "run.h5").model.bodies] == [
        "a/b",
        "a_b",
        ".",
        "c d%",
    ]


def test_a_state_of_another_model_with_a_mass_at_a_point_is_a_start(rubber: pl.LinearElastic) -> None:
    def build() -> tuple[pl.Model, pl.PointMass]:
        model = pl.Model(gravity=(0, 0, -9.81))
        rope = model.add_cable([(0, 0, 0), (0, 0, -1)], elements=2, section=pl.Circle(5e-3), material=rubber)
        model.pin(rope.start)
        return model, model.add_point_mass(0.1, at=rope.end)

    start = pl.solve_static(build()[0])
    model, load = build()
    result = pl.simulate(model, duration=0.1, step=1e-2, start=start)
    # It hangs at rest, to Newton's tolerance.
    assert np.ptp(result.track(load).position[:, 2]) < 1e-6
