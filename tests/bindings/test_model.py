"""Models as descriptions: names, handles, copies, files, lowering."""

from __future__ import annotations

import copy
import json
import subprocess
import sys
from itertools import pairwise
from pathlib import Path

import numpy as np
import pliant as pl
import pytest
from pliant._lower import lower
from pliant.bodies import stretch_of_force
from pliant.curves import divide

SECTION = pl.Circle(radius=5e-3)


def test_nodes_of_a_line_with_a_corner(rubber: pl.LinearElastic) -> None:
    model = pl.Model()
    rope = model.add_cable([(0, 0, 0), (1, 0, 0), (1, 3, 0)], elements=8, section=SECTION, material=rubber)
    document = lower(model).document
    assert document["cables"][0]["strands"] == [2.0, 6.0]
    assert document["shared_points"] == [1.0, 0.0, 0.0]
    assert document["cables"][0]["shared"] == [2.0, 0.0, 3.0, 0.0]
    assert model.dof == 10 * 6 - 3
    assert (rope.node(2).element, rope.node(2).xi) == (1, 1.0)
    assert rope.at(1.0).node == 2
    assert rope.end.node == 8


def test_pieces_that_go_straight_on_are_one_strand(rubber: pl.LinearElastic) -> None:
    model = pl.Model()
    rope = model.add_cable([(0, 0, 0), (1, 0, 0), (4, 0, 0)], elements=8, section=SECTION, material=rubber)
    assert lower(model).document["cables"][0]["strands"] == [8.0]
    assert rope.at(1.0).node == 2


def test_a_ring_shares_its_ends(rubber: pl.LinearElastic) -> None:
    model = pl.Model()
    square = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)]
    ring = model.add_cable(square, elements=8, section=SECTION, material=rubber, closed=True)
    assert ring.end == ring.start
    assert model.dof == 12 * 6 - 4 * 3
    with pytest.raises(pl.ModelError, match="i = 8"):
        ring.node(8)


def test_elements_follow_length() -> None:
    assert divide(np.array([1.0, 1e-6]), 10).tolist() == [9, 1]
    assert divide(np.array([1.0, 1.0, 1.0]), 3).tolist() == [1, 1, 1]
    assert divide(np.full(7, 0.1), 11).sum() == 11


def test_pinned_nodes_share_coordinates_and_loops_are_redundant(rubber: pl.LinearElastic) -> None:
    model = pl.Model()
    a, b, c = (
        model.add_cable([(0, 0, 0), end], elements=2, section=SECTION, material=rubber)
        for end in ((1, 0, 0), (0, 1, 0), (0, 0, 1))
    )
    pins = [model.pin(a.start, b.start), model.pin(b.start, c.start), model.pin(c.start, a.start)]
    lowered = lower(model)
    assert [lowered.plan[p.name]["kind"] for p in pins] == ["shared", "shared", "redundant"]
    assert model.dof == 9 * 6 - 6
    assert model.constraints == 0


def test_pins_with_a_jump_of_velocity_get_multipliers(rubber: pl.LinearElastic) -> None:
    model = pl.Model()
    a = model.add_cable(
        [(0, 0, 0), (1, 0, 0)], elements=2, section=SECTION, material=rubber, velocity=(0, 0, 1)
    )
    b = model.add_cable([(1, 0, 0), (2, 0, 0)], elements=2, section=SECTION, material=rubber)
    model.pin(a.end, b.start)
    assert (model.dof, model.constraints) == (36, 3)


def test_a_body_stands_for_its_nearest_point(rubber: pl.LinearElastic) -> None:
    model = pl.Model()
    a = model.add_cable([(0, 0, 0), (1, 0, 0)], elements=3, section=SECTION, material=rubber)
    b = model.add_cable([(0.4, 0, 0), (0.4, 0, 1)], elements=2, section=SECTION, material=rubber)
    pin = model.pin(b.start, a)
    point = model._joints[pin.name].b  # type: ignore[union-attr]
    assert isinstance(point, pl.Point)
    assert point.element == 1
    assert point.xi == pytest.approx(0.2, abs=1e-8)


@pytest.mark.parametrize("strain", ["green_lagrange", "biot"])
def test_pretension_is_exact(strain: str) -> None:
    load = np.array([0.0, 1.0, 50.0, 2000.0])
    stretch = stretch_of_force(load, np.full(4, 1000.0), strain)
    force = stretch * (stretch**2 - 1) / 2 if strain == "green_lagrange" else stretch - 1
    np.testing.assert_allclose(1000.0 * force, load, rtol=1e-14, atol=1e-12)


def test_the_mass_stays_when_the_rest_length_changes(rubber: pl.LinearElastic) -> None:
    model = pl.Model()
    rope = model.add_cable(
        [(0, 0, 0), (1, 0, 0)], elements=2, section=SECTION, material=rubber, rest_length=0.8
    )
    body = model._bodies["cable1"]
    assert rope.length == pytest.approx(0.8)
    assert isinstance(body, pl.bodies.LineBody)
    assert (body.lengths * body.mass_per_length).sum() == pytest.approx(SECTION.area * 1000.0)


def test_an_arc_is_exact_and_planar(rubber: pl.LinearElastic) -> None:
    model = pl.Model()
    arc = pl.Curve(lambda s: (np.sin(s), 0.0, 1.0 - np.cos(s)), length=1.5)
    model.add_cable(arc, elements=6, section=SECTION, material=rubber)
    body = model._bodies["cable1"]
    s = np.linspace(0, 1.5, 7)
    np.testing.assert_allclose(body.t, np.stack([np.cos(s), 0 * s, np.sin(s)], axis=1), atol=1e-11)
    np.testing.assert_allclose(body.normal, (0, 1, 0), atol=1e-11)


def test_tangents_stay_exact_where_the_curvature_jumps(rubber: pl.LinearElastic) -> None:
    def stadium(s: float) -> tuple[float, float, float]:
        return (s, 0.0, 0.0) if s < 1 else (1 + np.sin(s - 1), 1 - np.cos(s - 1), 0.0)

    model = pl.Model()
    model.add_cable(pl.Curve(stadium, length=2.0), elements=4, section=SECTION, material=rubber)
    np.testing.assert_allclose(model._bodies["cable1"].t[2], (1, 0, 0), atol=1e-11)


def test_a_helix_takes_rest_straight(rubber: pl.LinearElastic) -> None:
    model = pl.Model()
    x = 1 / np.sqrt(2)
    helix = pl.Curve(lambda s: (np.cos(x * s), np.sin(x * s), x * s), length=6.0)
    rope = model.add_cable(helix, elements=20, section=SECTION, material=rubber, rest="straight")
    assert model._bodies["cable1"].normal is None
    assert rope.length == pytest.approx(6.0)


def test_tapers_are_sampled_at_the_rules_points(rubber: pl.LinearElastic) -> None:
    model = pl.Model()
    model.add_cable(
        [(0, 0, 0), (2, 0, 0)], elements=1, section=lambda s: pl.Circle(1e-2 * (1 + s)), material=rubber
    )
    body = model._bodies["cable1"]
    expected = 1e7 * np.pi * 1e-4 * np.array([[1.0, 4.0, 9.0]])
    np.testing.assert_allclose(body.axial_stiffness, expected)
    assert body.bending_stiffness.shape == (1, 3)
    assert body.mass_per_length.shape == (1, 5)


def test_names_handles_and_copies(rubber: pl.LinearElastic) -> None:
    model = pl.Model(gravity=(0, 0, -9.81))
    rope = model.add_cable([(0, 0, 0), (1, 0, 0)], elements=2, section=SECTION, material=rubber)
    other = copy.deepcopy(model)
    hook = other.pin(rope.start, name="hook")
    assert (model["cable1"], other["hook"]) == (rope, hook)
    assert [len(m.joints) for m in (model, other)] == [0, 1]
    assert model.contacts == []
    assert "hook" in str(other)
    assert "cable1" in str(model)
    with pytest.raises(pl.ModelError, match="hook"):
        model["hook"]


def test_models_survive_files(tmp_path: Path, rubber: pl.LinearElastic) -> None:
    model = pl.Model(gravity=(0, 0, -9.81))
    rope = model.add_cable([(0, 0, 0), (1, 0, 0), (1, 1, 0)], elements=5, section=SECTION, material=rubber)
    model.pin(rope.start)
    ball = model.add_point_mass(0.3, at=rope.end)
    model.add_point_mass(0.3, at=(0, 0, 3))
    model.add_force(rope.at(0.33), (0, 0, 1) * pl.Ramp(2.0) + pl.Table([0, 1], [(0, 0, 0), (1, 0, 0)]))
    model.save(tmp_path / "model.json")
    again = pl.Model.load(tmp_path / "model.json")
    assert lower(again).document == lower(model).document
    assert again["point_mass1"].center == ball.center
    again.clamp(rope.end)
    assert [path.name for path in tmp_path.iterdir()] == ["model.json"]


def test_callables_are_not_saved(tmp_path: Path, rubber: pl.LinearElastic) -> None:
    model = pl.Model()
    rope = model.add_cable([(0, 0, 0), (1, 0, 0)], elements=2, section=SECTION, material=rubber)
    model.add_force(rope.end, lambda t: (0, 0, t), name="lift")
    with pytest.raises(pl.ModelError, match=r"'lift'.*Table\.sample"):
        model.save(tmp_path / "model.json")


def test_signals_combine() -> None:
    signal = np.array([1.0, 2.0, 3.0]) * pl.Ramp(1.0) * (lambda t: 2.0) - (1, 1, 1)
    np.testing.assert_allclose(signal(1.0), (1, 3, 5))
    table = pl.Table([0.0, 1.0, 2.0], [0.0, 1.0, 0.0], period=2.0)
    np.testing.assert_allclose([table(t)[0] for t in (-0.5, 0.5, 2.5, 5.0)], (0.5, 0.5, 0.5, 1.0))


def test_what_is_not_there_is_absent() -> None:
    assert not hasattr(pl, "sweep")


def test_plastic_material_is_its_arguments() -> None:
    steel = pl.BilinearPlastic(2e11, 0.3, 7850.0, 2.5e8, 2e10)
    assert (steel.hardening, steel.retardation_time) == ("isotropic", 0.0)
    assert steel.yield_strain == 1.25e-3
    assert steel.hardening_modulus == pytest.approx(2e11 / 9, rel=1e-15)
    model = pl.Model()
    line = [(0, 0, 0), (1, 0, 0)]
    kinds = {"elements": 2, "section": SECTION}
    model.add_cable(line, material=steel, **kinds)
    moved = pl.BilinearPlastic(2e11, 0.3, 7850.0, 2.5e8, 2e10, "kinematic", retardation_time=1e-3)
    model.add_cable_net([*line, (1, 1, 0)], [(0, 1), (1, 2)], material=moved, **kinds)
    cable, net = model._bodies.values()
    assert (cable.isotropic_hardening, cable.kinematic_hardening) == (pytest.approx(1 / 9), 0.0)
    assert (net.isotropic_hardening, net.kinematic_hardening) == (0.0, pytest.approx(1 / 9))
    assert (cable.yield_strain, net.retardation_time) == (1.25e-3, 1e-3)
    again = pl.Model.from_document(model.to_document())
    assert lower(again).document == lower(model).document


def test_bodies_tell_which_of_them_can_yield() -> None:
    steel = pl.BilinearPlastic(2e11, 0.3, 7850.0, 2.5e8, 2e10)
    model, mesh = pl.Model(), pl.Mesh.rectangle(1, 1, divisions=(1, 1))
    line = [(0, 0, 0), (1, 0, 0)]
    told = "BilinearPlastic is for cables and nets of cables"
    with pytest.raises(pl.ModelError, match=rf"material = .*a beam takes .*{told}"):
        model.add_beam(line, elements=2, section=SECTION, material=steel)
    with pytest.raises(pl.ModelError, match=rf"material = .*a surface takes .*{told}"):
        model.add_shell(mesh, thickness=1e-3, material=steel)
    with pytest.raises(pl.ModelError, match=rf"material = .*a surface takes .*{told}"):
        model.add_membrane(mesh, thickness=1e-3, material=steel)
    gum = pl.NeoHookean(1e6, 0.5, 1000.0)
    with pytest.raises(pl.ModelError, match=r"a cable takes .*NeoHookean is for shells and membranes"):
        model.add_cable(line, elements=2, section=SECTION, material=gum)


def test_import_is_light() -> None:
    code = "import sys, json; import pliant; print(json.dumps(sorted(sys.modules)))"
    modules = json.loads(subprocess.check_output([sys.executable, "-c", code]))
    for heavy in ("scipy", "matplotlib", "h5py", "tqdm", "pliant._core"):
        assert heavy not in modules


def test_numbers_of_names_are_the_lowest_that_are_free(rubber: pl.LinearElastic) -> None:
    model = pl.Model()
    line = [(0, 0, 0), (1, 0, 0)]

    def add(to: pl.Model, name: str | None = None) -> str:
        return to.add_cable(line, elements=1, section=SECTION, material=rubber, name=name).name

    assert [add(model), add(model, "cable3"), add(model), add(model)] == [
        "cable1",
        "cable3",
        "cable2",
        "cable4",
    ]
    # Names are shared with joints and loads, and each copy counts on for itself.
    model.pin(model["cable1"].start, name="cable5")
    twin, read = model.copy(), pl.Model.from_document(model.to_document())
    assert [add(model), add(model), add(twin), add(read)] == ["cable6", "cable7", "cable6", "cable6"]


def test_the_size_grows_with_every_body(rubber: pl.LinearElastic) -> None:
    model = pl.Model()
    cable = model.add_cable([(0, 0, 0), (1, 0, 0)], elements=1, section=SECTION, material=rubber)
    assert model._size() == 1.0
    twin = model.copy()
    model.add_point_mass(1.0, at=(0, -3, 0))
    assert model._size() == 3.0
    twin.add_rigid_body(mass=1.0, inertia=(2.0, 2.0, 2.0), position=(0, 0, 10))
    gyration = np.sqrt(3.0)
    assert twin._size() == pytest.approx(10.0 + gyration, rel=1e-15)
    assert pl.Model.from_document(twin.to_document())._size() == twin._size()
    # A pin accepts gaps of a millionth of the size: what was too far apart is not in a larger model.
    gap = (5e-6, 0, 0)
    with pytest.raises(pl.ModelError, match="coincide"):
        model.pin(cable.start, gap)
    model.add_point_mass(1.0, at=(0, 0, 10))
    model.pin(cable.start, gap)
    assert model._size() == 10.0


@pytest.mark.parametrize("value", [np.nan, np.inf, True, "1", 10**400, None, np.array([1.0]), 1j])
def test_numbers_are_finite_and_real(value: object) -> None:
    with pytest.raises(pl.ModelError, match=r"mass = .* must be a finite number above 0"):
        pl.Model().add_point_mass(value, at=(0, 0, 0))  # type: ignore[arg-type]


@pytest.mark.parametrize("value", [2, 2.0, np.float32(2), np.int64(2), np.array(2.0)])
def test_numbers_of_any_kind_become_floats(value: object) -> None:
    model = pl.Model()
    model.add_point_mass(value, at=(0, 0, 0), name="ball")  # type: ignore[arg-type]
    assert type(model._bodies["ball"].mass) is float  # type: ignore[union-attr]


@pytest.mark.parametrize("place", [(1.0, 2.0, 3.0), [1, 2, 3], np.array([1.0, 2.0, 3.0])])
def test_places_on_a_body_are_plain_numbers(place: object) -> None:
    body = pl.Model().add_rigid_body(mass=1.0, shape=pl.Sphere(0.1))
    point = body.at(place)  # type: ignore[arg-type]
    assert point.local == (1.0, 2.0, 3.0)
    assert [type(x) for x in point.local] == [float] * 3
    for wrong in ((np.inf, -np.inf, 0.0), (np.nan, 0.0, 0.0), (1.0, 2.0)):
        with pytest.raises(pl.ModelError, match="local_point"):
            body.at(wrong)


def test_sides_of_pins_that_share_coordinates(rubber: pl.LinearElastic) -> None:
    # Five cables meet; each pin hangs a cable on the one before it, and a mass and a joint on some.
    model = pl.Model()
    cables = [
        model.add_cable([(0, 0, 0), (np.cos(k), np.sin(k), 0)], elements=2, section=SECTION, material=rubber)
        for k in range(5)
    ]
    pins = [model.pin(b.start, a.start) for a, b in pairwise(cables)]
    model.add_point_mass(1.0, at=cables[3].start, name="late")
    model.add_point_mass(1.0, at=cables[1].start, name="early")
    wall = model.pin(cables[4].start)
    plan = lower(model).plan
    for k, pin in enumerate(pins):
        side = plan[pin.name]
        beyond = range(k + 1, 5)
        assert side["nodes"] == [[cables[j].name, 0] for j in beyond]
        assert side["masses"] == [name for name, j in (("late", 3), ("early", 1)) if j in beyond]
        assert side["joints"] == [[wall.name, 1.0]]
