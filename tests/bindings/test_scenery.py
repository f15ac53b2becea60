"""Obstacles in pictures, pages and files: where they are, cut off at what the bodies move through."""

from __future__ import annotations

import json
import re
import xml.etree.ElementTree as ElementTree
from pathlib import Path
from typing import Any

import numpy as np
import pliant as pl
import pytest
from mpl_toolkits.mplot3d import proj3d
from pliant.plotting import Picture
from pliant.scenery import Extent, scenery, spacing
from scipy.spatial.transform import Rotation

MOTION = Extent(np.array([0.0, -0.5, 0.1]), np.array([2.0, 0.5, 1.1]))
TURNED = Rotation.from_rotvec((0.4, -0.3, 0.8))
ROUNDING = 1e-12  # coordinates are of order 1, and a few operations on doubles away from exact


def rest(*obstacles: tuple[Any, dict[str, Any]]) -> pl.Result:
    """A ball that hangs still over obstacles."""
    model = pl.Model()
    model.add_point_mass(1.0, at=(0, 0, 1), name="ball")
    for shape, where in obstacles:
        model.add_obstacle(shape, **where)
    return pl.simulate(model, duration=1e-3, step=1e-3)


def inside(points: np.ndarray, extent: Extent) -> bool:
    """Whether points keep to a box, but for rounding."""
    return bool((points >= extent.low - ROUNDING).all() and (points <= extent.high + ROUNDING).all())


def facing(surface: Any) -> np.ndarray:
    """How far triangles face the way of their normals: above zero where they run counter-clockwise."""
    a, b, c = surface.points[surface.triangles].transpose(1, 0, 2)
    turned = np.cross(b - a, c - a)
    area = np.linalg.norm(turned, axis=1)
    large = area > 1e-9 * area.max()
    along: np.ndarray = np.einsum("ti,ti->t", turned, surface.normals[surface.triangles].mean(axis=1))
    return along[large]


def test_a_ground_is_a_piece_of_its_plane_as_large_as_the_picture() -> None:
    extent, (ground,) = scenery(rest((pl.HalfSpace(), {"name": "ground"})), MOTION)
    # The bodies stay 0.1 above the ground: the box is drawn down to it, and a margin of 2 % goes round it.
    np.testing.assert_allclose(extent.low, (-0.04, -0.52, -0.022), atol=ROUNDING)
    np.testing.assert_allclose(extent.high, (2.04, 0.52, 1.122), atol=ROUNDING)
    assert (ground.name, ground.kind) == ("ground", "plane")
    np.testing.assert_allclose(ground.points[:, 2], 0.0, atol=ROUNDING)
    for axis in (0, 1):
        found = ground.points[:, axis].min(), ground.points[:, axis].max()
        np.testing.assert_allclose(found, (extent.low[axis], extent.high[axis]), atol=ROUNDING)
    np.testing.assert_allclose(ground.normals, np.tile([0, 0, 1.0], (len(ground.points), 1)), atol=ROUNDING)
    # Its grid goes through the obstacle's place, in steps that people count in.
    assert spacing(extent) == 0.2
    np.testing.assert_allclose(ground.lines[..., 2], 0.0, atol=ROUNDING)
    along_y = np.ptp(ground.lines[..., 0], axis=1) < ROUNDING
    np.testing.assert_allclose(np.sort(ground.lines[along_y, 0, 0]), 0.2 * np.arange(11), atol=ROUNDING)


def test_a_slope_is_cut_off_at_the_picture() -> None:
    slope = pl.HalfSpace(normal=(-0.3, 0.1, 1.0))
    where = {"position": (1.0, 0.0, 0.5), "orientation": TURNED}
    extent, (piece,) = scenery(rest((slope, where)), MOTION)
    normal = TURNED.apply(slope.normal)
    for points in (piece.points, piece.lines.reshape(-1, 3)):
        np.testing.assert_allclose((points - (1.0, 0.0, 0.5)) @ normal, 0.0, atol=ROUNDING)
        assert inside(points, extent)
    # It goes through the middle of the box and is no smaller than the smallest cut there.
    a, b, c = piece.points[piece.triangles].transpose(1, 0, 2)
    assert np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2 >= 1.0
    assert facing(piece).min() > 0


SHAPES = {
    "sphere": (pl.Sphere(0.2), lambda x: np.linalg.norm(x, axis=1) - 0.2),
    "box": (pl.Box((0.2, 0.3, 0.4)), lambda x: np.max(np.abs(x) - (0.1, 0.15, 0.2), axis=1)),
    "capsule": (
        pl.Capsule(0.1, 0.2),
        lambda x: np.linalg.norm(x - np.clip(x, (0, 0, -0.1), (0, 0, 0.1)), axis=1) - 0.1,
    ),
    "mesh": (
        pl.TriangleMesh([(0, 0, 0), (0.4, 0, 0.1), (0.4, 0.3, 0.1), (0, 0.3, 0)], [(0, 1, 2), (0, 2, 3)]),
        lambda x: x[:, 2] - 0.25 * x[:, 0],
    ),
    "bore": (pl.Bore([(-3, 0, 0), (3, 0, 0)], radius=0.1), lambda x: np.hypot(x[:, 1], x[:, 2]) - 0.1),
}


@pytest.mark.parametrize("name", SHAPES)
def test_shapes_are_drawn_where_they_stand(name: str) -> None:
    shape, distance = SHAPES[name]
    where = {"position": (1.0, 0.1, 0.6), "orientation": TURNED}
    extent, (drawn,) = scenery(rest((shape, where)), MOTION)
    assert drawn.kind == (name if name in ("mesh", "bore") else "solid")
    if name == "bore":
        # Cut off where it leaves the box: what is cut lies on chords, of 32 round the circle.
        sagitta = 0.1 * (1 - np.cos(np.pi / 32))
        own = TURNED.inv().apply(drawn.points - where["position"])
        assert distance(own).min() >= -sagitta - ROUNDING
        assert distance(own).max() <= ROUNDING
        assert np.ptp(own[:, 0]) > 1.0
        # Its wall is seen from inside.
        assert np.einsum("pi,pi->p", own[:, 1:], TURNED.inv().apply(drawn.normals)[:, 1:]).max() < 0
        # It is longer than the picture, which grows by a quarter of its size and the margin.
        assert (MOTION.low - extent.low).max() <= 0.5 + 0.02 * 3 + ROUNDING
    else:
        own = TURNED.inv().apply(drawn.points - where["position"])
        np.testing.assert_allclose(distance(own), 0.0, atol=ROUNDING)
        # All of it lies amid the bodies: the picture is not larger for it.
        np.testing.assert_allclose(extent.low, MOTION.low - 0.02 * np.array([2, 1, 1]), atol=ROUNDING)
    np.testing.assert_allclose(np.linalg.norm(drawn.normals, axis=1), 1.0, atol=ROUNDING)
    assert facing(drawn).min() > 0
    assert inside(drawn.points, extent)
    assert inside(drawn.lines.reshape(-1, 3), extent)


def test_a_bore_may_close_and_wind_without_running_into_itself() -> None:
    pl.Bore(pl.Curve(lambda s: (np.cos(s), np.sin(s), 0.0), length=2 * np.pi), radius=0.9)
    rise = 0.1
    speed = np.hypot(1.0, rise)
    coil = pl.Curve(
        lambda s: (np.cos(s / speed), np.sin(s / speed), rise * s / speed), length=6 * np.pi * speed
    )
    # Turns lie 0.628 m apart.
    assert pl.Bore(coil, radius=0.3, pieces=48).radius == 0.3
    with pytest.raises(pl.ModelError, match="runs into itself"):
        pl.Bore(coil, radius=0.35, pieces=48)


def test_a_bent_bore_keeps_to_its_line_and_goes_on_straight() -> None:
    arc = pl.Curve(
        lambda s: (0.8 * np.sin(s / 0.8), 0.8 * (1 - np.cos(s / 0.8)), 0.0), length=0.8 * np.pi / 2
    )
    bore = pl.Bore(arc, radius=0.05)
    motion = Extent(np.array([-0.5, -0.02, -0.02]), np.array([0.82, 1.3, 0.02]))
    extent, (wall,) = scenery(rest((bore, {})), motion)
    x, y, z = wall.points.T
    bend = (x > 1e-6) & (y < 0.8 - 1e-6)
    before, behind = (x <= 0) & (y < 0.4), (y >= 0.8) & (x > 0.4)
    off = [
        np.hypot(0.8 - np.hypot(x, y - 0.8), z)[bend],
        np.hypot(y, z)[before],
        np.hypot(x - 0.8, z)[behind],
    ]
    for part in off:
        assert len(part) > 100
        # Points cut off lie on chords of the 32 sides of the section and of the 64 pieces along the arc.
        slack = 0.05 * (1 - np.cos(np.pi / 32)) + 0.85 * (1 - np.cos(np.pi / 256))
        np.testing.assert_allclose(part, 0.05, atol=slack)
    # Beyond both ends it goes on as far as the picture does.
    np.testing.assert_allclose((x.min(), y.max()), (extent.low[0], extent.high[1]), atol=ROUNDING)


def test_large_and_far_obstacles_do_not_blow_up_the_picture() -> None:
    planet = (pl.Sphere(50.0), {"position": (1.0, 0.0, -50.0)})
    extent, (piece,) = scenery(rest(planet), MOTION)
    # A quarter of two metres more on every side, and the margin.
    assert ((MOTION.low - extent.low) <= 0.5 + 0.02 * 3 + ROUNDING).all()
    assert ((extent.high - MOTION.high) <= 0.5 + 0.02 * 3 + ROUNDING).all()
    assert inside(piece.points, extent)
    assert inside(piece.lines.reshape(-1, 3), extent)
    # On the sphere, but for its flat facets of a sixteenth of half a turn.
    off = np.linalg.norm(piece.points - (1.0, 0.0, -50.0), axis=1) - 50.0
    assert off.max() <= 1e-9
    assert off.min() >= -50.0 * (1 - np.cos(np.pi / 32) ** 2)
    far = [
        (pl.Box((1, 1, 1)), {"position": (9.0, 0, 0)}),
        (pl.HalfSpace(), {"position": (0, 0, -3.0)}),
        (pl.Bore([(0, 4, 0), (1, 4, 0)], radius=0.1), {}),
    ]
    extent, shown = scenery(rest(*far), MOTION)
    assert shown == []
    np.testing.assert_allclose(extent.high, MOTION.high + 0.02 * np.array([2, 1, 1]), atol=ROUNDING)


def falling() -> pl.Result:
    """A rope in the plane y = 0 over ground and drum, a wall beside it; flat to rounding."""
    model = pl.Model(gravity=(0, 0, -9.81))
    rubber = pl.LinearElastic(1e7, 0.45, 1000.0)
    rope = model.add_cable(
        [(0, 0, 0.5), (1, 0, 0.5)], elements=8, section=pl.Circle(8e-3), material=rubber, name="rope"
    )
    ground = model.add_obstacle(pl.HalfSpace(), name="ground")
    upright = Rotation.from_euler("x", 90, degrees=True)
    drum = model.add_obstacle(pl.Cylinder(0.1, 0.3), position=(0.5, 0, 0.2), orientation=upright, name="drum")
    model.add_obstacle(pl.Bore([(0, 0, 0.5), (1, 0, 0.5)], radius=0.1), name="guide")
    model.add_contacts([rope, ground, drum])
    return pl.simulate(model, duration=0.3, step=2e-3, output_every=10)


@pytest.fixture(scope="module")
def result() -> pl.Result:
    return falling()


def test_pictures_put_obstacles_under_bodies(result: pl.Result) -> None:
    frames = np.arange(len(result.time))
    picture = Picture(result, frames, None)
    assert [obstacle.name for obstacle in picture.scenery] == ["ground", "drum", "guide"]
    assert not picture.in_space
    still = {id(artist) for artist in picture.axes.collections}
    assert len(still) == 2 * 3  # faces and lines of each
    limits = picture.axes.get_xlim(), picture.axes.get_ylim()
    picture.add(0)
    above = [artist for artist in picture.axes.collections if id(artist) not in still]
    assert above
    lowest = min(artist.get_zorder() for artist in above)
    assert all(a.get_zorder() < lowest for a in picture.axes.collections if id(a) in still)
    # Neither the obstacles nor the bodies move the limits; the next image of a film keeps the obstacles.
    picture.figure.canvas.draw()
    width, height = (np.ptp(span) for span in (picture.axes.get_xlim(), picture.axes.get_ylim()))
    assert width <= max(np.ptp(limits[0]), 1.5 * height) + ROUNDING
    picture.clear()
    assert {id(artist) for artist in picture.axes.collections} == still
    # Of the ground a strip below its plane is shown, of the drum its circle.
    ground, drum = (picture.axes.collections[k].get_paths()[0].vertices for k in (0, 2))
    np.testing.assert_allclose(
        (ground[:, 1].min(), ground[:, 1].max()), (-0.03 * picture.size, 0), atol=ROUNDING
    )
    np.testing.assert_allclose(np.hypot(drum[:, 0] - 0.5, drum[:, 1] - 0.2), 0.1, atol=ROUNDING)


def test_pictures_in_space_end_where_the_bodies_do() -> None:
    model = pl.Model()
    for k, place in enumerate([(0, 0, 0.1), (1, 2, 0.5)]):
        model.add_point_mass(1.0, at=place, name=f"ball{k}")
    model.add_obstacle(pl.HalfSpace())
    model.add_obstacle(pl.Sphere(30.0), position=(0, 0, -30.0))
    picture = Picture(pl.simulate(model, duration=1e-3, step=1e-3), np.array([0]), None)
    assert picture.in_space
    picture.add(0)
    limits = np.array([picture.axes.get_xlim(), picture.axes.get_ylim(), picture.axes.get_zlim()])
    np.testing.assert_allclose(limits.T, np.array(picture.extent), atol=ROUNDING)
    # Two metres of motion, a quarter of it more on each side, the margin.
    assert np.ptp(limits, axis=1).max() <= 2.0 * 1.5 * 1.04 + ROUNDING


@pytest.mark.parametrize("far", [(1, 1, 0.1), (0.1, 0.1, 1), (1, 0.1, 0.1), (1, 1, 1)])
def test_pictures_in_space_fill_their_axes(far: tuple[float, float, float]) -> None:
    model = pl.Model()
    for k, place in enumerate([(0, 0, 0), far]):
        model.add_point_mass(1.0, at=place, name=f"ball{k}")
    picture = Picture(pl.simulate(model, duration=1e-3, step=1e-3), np.array([0]), None)
    corners = np.array(np.meshgrid(*np.transpose(picture.extent))).reshape(3, -1)
    seen = np.array(proj3d.proj_transform(*corners, picture.axes.get_proj())[:2]).T
    window = picture.axes.viewLim
    share = np.abs(2 * (seen - (window.min + window.max) / 2) / window.size).max(axis=0)
    # Room for labels, more above and below; what scaling a perspective leaves after two rounds is below 2 %.
    assert (share / (0.9, 0.74)).max() == pytest.approx(1.0, abs=0.02)


def page_data(path: Path) -> Any:
    """Read what a page draws."""
    text = path.read_text(encoding="utf-8")
    found = re.search(r'<script id="data" type="application/json">(.*?)</script>', text, re.S)
    assert found
    return json.loads(found.group(1))


def test_pages_hold_the_obstacles(result: pl.Result, tmp_path: Path) -> None:
    result.export_html(tmp_path / "page.html")
    data = page_data(tmp_path / "page.html")
    assert [(one["name"], one["kind"]) for one in data["scenery"]] == [
        ("ground", "plane"),
        ("drum", "solid"),
        ("guide", "bore"),
    ]
    assert data["grid"] == 0.1


def test_pages_have_a_name_for_every_colour(tmp_path: Path) -> None:
    model = pl.Model()
    rubber = pl.LinearElastic(1e6, 0.45, 1000.0)
    film = model.add_membrane(pl.Mesh.rectangle(1.0, 1.0, divisions=(2, 2)), thickness=1e-3, material=rubber)
    line = [(0, 0, 1), (1, 0, 1)]
    model.add_cable(line, elements=2, section=pl.Circle(5e-3), material=rubber, name="rope")
    pl.simulate(model, duration=1e-3, step=1e-3).export_html(tmp_path / "page.html")
    data = page_data(tmp_path / "page.html")
    offered = {body["name"]: set(body["values"]) for body in data["bodies"]}
    assert offered == {film.name: {"strain", "regime", "speed"}, "rope": {"strain", "axial_force", "speed"}}
    assert set.union(*offered.values()) <= set(data["labels"])


def test_files_for_paraview_hold_the_obstacles_once(result: pl.Result, tmp_path: Path) -> None:
    meshio = pytest.importorskip("meshio")
    index = result.export_vtk(tmp_path)
    entries = [e for e in ElementTree.parse(index).getroot().iter("DataSet") if e.get("name") == "obstacles"]
    np.testing.assert_array_equal([float(e.get("timestep", "nan")) for e in entries], result.time)
    assert {e.get("file") for e in entries} == {"obstacles.vtu"}
    mesh = meshio.read(tmp_path / "obstacles.vtu")
    numbers = mesh.point_data["obstacle"]
    assert set(numbers) == {0.0, 1.0, 2.0}
    np.testing.assert_array_equal(mesh.points[numbers == 0.0][:, 2], 0.0)
    shown = scenery(result)[1]
    assert len(mesh.cells_dict["triangle"]) == sum(len(one.triangles) for one in shown)
    drum = mesh.points[mesh.cells_dict["triangle"][numbers[mesh.cells_dict["triangle"][:, 0]] == 1.0]]
    np.testing.assert_allclose(np.hypot(drum[..., 0] - 0.5, drum[..., 2] - 0.2).max(), 0.1, atol=ROUNDING)
