"""The public face of shells and membranes."""

from __future__ import annotations

import numpy as np
import pliant as pl
import pytest

RUBBER = pl.SaintVenantKirchhoff(youngs_modulus=1e6, poisson_ratio=0.3, density=1000.0)


def sheet_model(divisions=(3, 2), **options):
    model = pl.Model(gravity=(0, 0, -9.81))
    mesh = pl.Mesh.rectangle(1.5, 1.0, divisions=divisions)
    return model, model.add_shell(mesh, thickness=0.01, material=RUBBER, name="sheet", **options)


def test_rectangle_numbers_its_nodes_as_documented():
    mesh = pl.Mesh.rectangle(2.0, 1.0, divisions=(4, 3))
    for i in range(5):
        for j in range(4):
            np.testing.assert_allclose(mesh.points[i * 4 + j], (0.5 * i, j / 3, 0), atol=1e-15)


def test_points_edges_and_faces():
    model, sheet = sheet_model()
    assert sheet.at((0.5, 0.5, 0)).node == 4
    inside = sheet.at((0.6, 0.1, 0.2))
    assert inside.node is None
    np.testing.assert_allclose(model._position(inside), (0.6, 0.1, 0), atol=1e-12)
    assert sheet.edge([(0, 0, 0), (0, 1, 0)]).nodes == (0, 1, 2)
    assert sheet.edge("u_min").nodes == (0, 1, 2)
    around = sheet.edge([(0, 0, 0), (1.5, 0, 0), (1.5, 1, 0)])
    assert around.nodes == (0, 3, 6, 9, 10, 11)
    assert len(sheet.edge("rim").sides) == 10
    assert sheet.faces().numbers == tuple(range(6))
    assert sheet.faces([1, 3]).numbers == (1, 3)
    assert sheet.faces(np.arange(6) > 3).numbers == (4, 5)
    assert model["sheet"] == sheet


def test_files_and_copies_keep_surfaces(tmp_path):
    model, sheet = sheet_model()
    model.clamp(sheet.edge("u_min"))
    model.add_pressure(sheet, 5.0)
    model.save(tmp_path / "model.json")
    again = pl.Model.load(tmp_path / "model.json")
    runs = [pl.simulate(m, duration=0.02, step=1e-3) for m in (model, again)]
    np.testing.assert_array_equal(runs[0].positions("sheet"), runs[1].positions(sheet))
    runs[0].save(tmp_path / "run.h5")
    loaded = pl.Result.load(tmp_path / "run.h5")
    np.testing.assert_array_equal(loaded.strain(sheet).membrane, runs[0].strain("sheet").membrane)
    assert "shell" in str(model)
    assert "edge" in str(model)


def test_a_run_goes_on_where_another_ended():
    model, sheet = sheet_model()
    model.pin(sheet.node(0))
    whole = pl.simulate(model, duration=0.04, step=1e-3)
    half = pl.simulate(model, duration=0.02, step=1e-3)
    rest = pl.simulate(model, duration=0.02, step=1e-3, start=half)
    # The start of the second half makes its own accelerations consistent: second order in the step.
    np.testing.assert_allclose(rest.positions(sheet)[-1], whole.positions(sheet)[-1], atol=2e-6)


def test_reactions_of_edges_carry_the_weight():
    for hold in ("clamp", "pin"):
        model, sheet = sheet_model()
        # A thin sheet that hangs from its upper edge.
        model._gravity[:] = (9.81, 0, 0)
        joint = getattr(model, hold)(sheet.edge("u_min"))
        result = pl.solve_static(model)
        weight = 1000.0 * 0.01 * 1.5 * 9.81
        reaction = result.reaction(joint)
        np.testing.assert_allclose(reaction.force[-1], (-weight, 0, 0), atol=1e-6 * weight)
        # About the first node of the edge: the weight pulls half a width away.
        np.testing.assert_allclose(reaction.moment[-1][2], 0.5 * weight, rtol=1e-6)


def test_a_sheet_hangs_on_a_cable_and_a_rigid_body():
    model, sheet = sheet_model()
    rope = model.add_cable([(0, 0, 1), (0, 0, 0)], elements=4, section=pl.Circle(1e-3), material=RUBBER)
    model.pin(rope.start)
    model.pin(rope.end, sheet.node(0))
    brick = model.add_rigid_body(mass=0.5, shape=pl.Box((0.1, 0.1, 0.1)), position=(1.5, 1.0, 0.05))
    joint = model.weld(brick.at((0, 0, -0.05)), sheet.node(-1))
    result = pl.simulate(model, duration=0.02, step=1e-3)
    gap = result.track(brick.at((0, 0, -0.05))).position - result.track(sheet.node(-1)).position
    assert np.abs(gap).max() < 1e-9
    assert result.reaction(joint).force.shape == (21, 3)


def test_clamped_faces_do_not_move():
    model, sheet = sheet_model()
    model.clamp(sheet.faces([0, 1]))
    result = pl.simulate(model, duration=0.02, step=1e-3)
    held = result.positions(sheet)[:, :6]
    assert np.abs(held - held[0]).max() < 1e-10
    assert np.abs(result.positions(sheet)[-1, -1, 2]) > 1e-4


@pytest.mark.parametrize("element", ["bicubic", "cylindrical", "plate", "triangle"])
def test_every_element_falls_freely(element):
    model, sheet = sheet_model(element=element)
    result = pl.simulate(model, duration=0.05, step=1e-2)
    drop = result.center_of_mass(sheet)[:, 2]
    np.testing.assert_allclose(drop, -0.5 * 9.81 * result.time**2, atol=1e-9)
    assert np.abs(result.strain(sheet).bending).max() < 1e-9


def test_meshes_of_meshio_bring_their_groups():
    class Cells:
        def __init__(self, kind, data):
            self.type, self.data = kind, np.array(data)

    class Foreign:
        def __init__(self):
            self.points = np.array([(0.0, 0), (1, 0), (2, 0), (0, 1), (1, 1), (2, 1)])
            self.cells = [
                Cells("line", [(0, 3)]),
                Cells("quad", [(0, 1, 4, 3)]),
                Cells("triangle", [(1, 2, 5), (1, 5, 4)]),
            ]
            self.cell_sets = {"left": [[0], [], []], "right": [[], [], [0, 1]]}

    model = pl.Model()
    sheet = model.add_shell(Foreign(), thickness=0.01, material=RUBBER)
    assert sheet.faces("right").numbers == (1, 2)
    assert sheet.edge("left").nodes == (0, 3)
    film = model.add_membrane(Foreign(), thickness=1e-5, material=RUBBER)
    assert film.faces().numbers == (0, 1, 2)
