"""Pictures, films, files for ParaView and what notebooks show: made from the same drawings."""

from __future__ import annotations

import base64
import re
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import matplotlib.animation
import numpy as np
import pliant as pl
import pytest
from matplotlib.image import imread
from pliant import drawing
from scipy.spatial.transform import Rotation

STEEL = pl.LinearElastic(2.1e11, 0.3, 7850.0)


def machine() -> pl.Model:
    """A rope with a weight of every shape at points of it, a mass, a jet that follows."""
    model = pl.Model(gravity=(0, 0, -9.81))
    rubber = pl.LinearElastic(1e7, 0.45, 1000.0)
    rope = model.add_cable(
        [(0, 0, 0), (1, 0, 0)], elements=4, section=pl.Circle(5e-3), material=rubber, name="rope"
    )
    model.pin(rope.start, name="hook")
    shapes = (pl.Sphere(0.05), pl.Box((0.1, 0.08, 0.06)), pl.Cylinder(0.03, 0.1), pl.Capsule(0.03, 0.1))
    for k, shape in enumerate(shapes, start=1):
        body = model.add_rigid_body(
            density=300.0,
            shape=shape,
            position=(k / 4, 0, 0),
            orientation=Rotation.from_rotvec((0.3 * k, 0, 0.2)),
            name=f"body{k}",
        )
        model.pin(rope.node(k), body, name=f"knot{k}")
    model.add_force(model["body2"].at((0.05, 0, 0)), (0, 0.5, 0), follower=True, name="jet")
    model.add_rigid_body(mass=1.0, inertia=(1, 1, 1), position=(0, 1, 0), name="bare")
    model.add_point_mass(0.1, at=(0.5, 0.5, 0), velocity=(0, 0, 2), name="ball")
    return model


@pytest.fixture(scope="module")
def result() -> pl.Result:
    return pl.simulate(machine(), duration=0.2, step=2e-3, output_every=10)


def test_solids_are_drawn_where_their_points_are(result: pl.Result) -> None:
    frames = np.array([0, 5, 10])
    drawings = {d.name: d for d in drawing.draw(result, frames)}
    assert [type(d).__name__ for d in drawings.values()] == ["Lines", *["Solid"] * 4, "Marker", "Marker"]
    for k in range(1, 5):
        solid = drawings[f"body{k}"]
        assert isinstance(solid, drawing.Solid)
        for corner in (0, -1):
            track = result.track(result.model[f"body{k}"].at(solid.points[corner]))  # type: ignore[union-attr]
            for frame, output in enumerate(frames):
                np.testing.assert_allclose(solid.at(frame)[corner], track.position[output], atol=1e-12)
                np.testing.assert_allclose(
                    solid.values["velocity"][frame, corner], track.velocity[output], atol=1e-12
                )


def test_arrows_are_reactions_and_forces(result: pl.Result) -> None:
    frames = np.arange(11)
    found = {arrow.name: arrow for arrow in drawing.arrows(result, frames)}
    for name in ("hook", "knot3"):
        reaction = result.reaction(result.model[name])  # type: ignore[arg-type]
        np.testing.assert_array_equal(found[name].vectors, reaction.force)
        assert found[name].kind == "reaction"
    body = result.model["body2"]
    turn = result.track(body.center).orientation  # type: ignore[union-attr]
    expected = (turn * turn[0].inv()).apply((0, 0.5, 0))
    np.testing.assert_allclose(found["jet"].vectors, expected, atol=1e-9)
    place = result.track(body.at((0.05, 0, 0))).position  # type: ignore[union-attr]
    np.testing.assert_allclose(found["jet"].feet, place, atol=1e-12)


def test_a_follower_of_a_cable_stays_normal_to_it() -> None:
    model = pl.Model()
    arm = model.add_cable([(0, 0, 0), (1, 0, 0)], elements=4, section=pl.Circle(5e-3), material=STEEL)
    model.clamp(arm.start)
    model.add_force(arm.end, (0, 0, 40.0), follower=True)
    bent = pl.solve_static(model, load_steps=4)
    vectors = drawing.arrows(bent, np.arange(len(bent.time)))[0].vectors
    np.testing.assert_allclose(np.linalg.norm(vectors, axis=1), 40.0 * bent.time, rtol=1e-12)
    # The last piece of the drawn line is a chord of the end: its angle is off by its length times curvature.
    line = drawing.draw(bent, np.array([-1]))[0].points[0]  # type: ignore[union-attr]
    chord = (line[-1] - line[-2]) / np.linalg.norm(line[-1] - line[-2])
    assert abs(chord @ vectors[-1]) < 0.02 * 40.0
    assert vectors[-1, 0] < -1.0


@pytest.mark.parametrize("color", [None, "speed", "axial_force"])
def test_pictures_show_every_body(result: pl.Result, color: str | None, tmp_path: Path) -> None:
    figure = result.plot(color=color)
    figure.savefig(tmp_path / "picture.png", dpi=50)
    image = imread(tmp_path / "picture.png")[:, :, :3]
    assert (np.ptp(image, axis=2) > 0.3).sum() > 300
    labels = [axes.get_ylabel() for axes in figure.axes]
    assert (drawing.COLORS.get(color or "", "y [m]")) in labels


def test_flat_motion_is_drawn_flat(tmp_path: Path) -> None:
    model = pl.Model(gravity=(0, 0, -9.81))
    rope = model.add_cable([(0, 0, 0), (1, 0, 0)], elements=4, section=pl.Circle(5e-3), material=STEEL)
    model.pin(rope.start)
    run = pl.simulate(model, duration=0.1, step=1e-3)
    (axes,) = run.plot().axes
    assert axes.get_xlabel() == "x [m]"
    assert axes.get_ylabel() == "z [m]"
    assert axes.get_aspect() == 1.0


def test_films(result: pl.Result, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = result.animate(tmp_path / "film.gif", color="speed", speed=0.2, fps=5)
    # 0.2 s at a fifth of the speed are a second: five images and the last.
    with pytest.importorskip("PIL.Image").open(path) as image:
        assert image.n_frames == 6
    monkeypatch.setattr(matplotlib.animation.writers, "is_available", lambda name: name == "pillow")
    with pytest.warns(UserWarning, match="no ffmpeg"):
        path = result.animate(tmp_path / "other.mp4", speed=0.2, fps=2)
    assert path == tmp_path / "other.gif"
    monkeypatch.setattr(matplotlib.animation.writers, "is_available", lambda name: False)
    with pytest.raises(ImportError, match="Pillow"):
        result.animate(tmp_path / "film.gif")
    assert sorted(p.name for p in tmp_path.iterdir()) == ["film.gif", "other.gif"]
    for wrong in ({"path": "film.avi"}, {"path": "film.gif", "speed": 0}, {"path": "film.gif", "fps": -1}):
        with pytest.raises(pl.ModelError):
            result.animate(**wrong)  # type: ignore[arg-type]
    with pytest.raises(pl.ModelError, match="100,000"):
        result.animate(tmp_path / "film.gif", speed=1e-9)


def test_films_with_ffmpeg(result: pl.Result, tmp_path: Path) -> None:
    if not matplotlib.animation.writers.is_available("ffmpeg"):
        pytest.skip("needs ffmpeg on the PATH")
    path = result.animate(tmp_path / "film.mp4", speed=0.2, fps=5)
    assert path.read_bytes()[4:8] == b"ftyp"
    assert [p.name for p in tmp_path.iterdir()] == ["film.mp4"]


def test_paraview_files_hold_all_fields(result: pl.Result, tmp_path: Path) -> None:
    meshio = pytest.importorskip("meshio")
    index = result.export_vtk(tmp_path / "out")
    entries = list(ElementTree.parse(index).getroot().iter("DataSet"))
    assert {entry.get("name") for entry in entries} == {"lines", "solids", "points", "forces"}
    times = sorted({float(entry.get("timestep", "nan")) for entry in entries})
    np.testing.assert_array_equal(times, result.time)
    last = {e.get("name"): meshio.read(index.parent / e.get("file", "")) for e in entries[-4:]}
    rope = last["lines"]
    np.testing.assert_array_equal(rope.points[-1], result.track(result.model["rope"].end).position[-1])  # type: ignore[union-attr]
    assert {"velocity", "strain", "axial_force", "curvature", "radius", "speed"} <= set(rope.point_data)
    assert rope.point_data["axial_force"][-1] == result.axial_force("rope")[-1, -1]
    assert rope.cells_dict["line"].shape[1] == 2
    solids = last["solids"]
    first = solids.point_data["body"] == 1.0
    track = result.track(result.model["body1"].center)  # type: ignore[union-attr]
    # A sphere's points lie about its centre.
    np.testing.assert_allclose(
        np.linalg.norm(solids.points[first] - track.position[-1], axis=1), 0.05, rtol=1e-9
    )
    np.testing.assert_allclose(solids.point_data["axis_y"][first][0], track.axes[-1, 1], atol=1e-12)  # type: ignore[index]
    forces = last["forces"]
    names = [arrow.name for arrow in drawing.arrows(result, np.array([0]))]
    hook = result.reaction(result.model["hook"])  # type: ignore[arg-type]
    np.testing.assert_array_equal(forces.point_data["force"][names.index("hook")], hook.force[-1])
    for wrong in (3, ""):
        with pytest.raises(pl.ModelError, match="folder"):
            result.export_vtk(wrong)  # type: ignore[arg-type]
    (tmp_path / "file").write_text("")
    with pytest.raises(pl.FileError, match="file"):
        result.export_vtk(tmp_path / "file")


def test_notebooks_show_tables_and_pictures(result: pl.Result) -> None:
    model = result.model
    text = model._repr_html_()
    assert text.count("<tr>") == len(model.bodies) + len(model.joints) + len(model.loads)
    assert "hook" in text
    odd = pl.Model()
    odd.add_point_mass(1.0, at=(0, 0, 0), name="<b>")
    assert "<b>" not in odd._repr_html_()
    shown = result._repr_html_()
    picture = re.search(r"base64,([^']+)'", shown)
    assert picture
    assert base64.b64decode(picture.group(1))[:4] == b"\x89PNG"
    assert "11 outputs to 0.2 s" in shown
    bar = pl.Model()
    arm = bar.add_cable([(0, 0, 0), (1, 0, 0)], elements=4, section=pl.Circle(5e-3), material=STEEL)
    bar.clamp(arm.start)
    modes = pl.solve_modes(bar, count=3)
    assert modes._repr_html_().count("<tr>") == 3
    assert "Hz" in repr(modes)
