"""The public face of beams."""

from __future__ import annotations

import matplotlib.pyplot as plt
import numpy as np
import pliant as pl
import pytest
from scipy.spatial.transform import Rotation

STEEL = pl.LinearElastic(youngs_modulus=2.1e11, poisson_ratio=0.3, density=7850.0)
RUBBER = pl.LinearElastic(youngs_modulus=1e7, poisson_ratio=0.3, density=1000.0, retardation_time=1e-3)
BAR = pl.Rectangle(width=0.02, height=0.04)


def beam_model(**options):
    model = pl.Model(gravity=(0, 0, -9.81))
    given = {"elements": 4, "section": BAR, "material": RUBBER, "name": "arm", **options}
    return model, model.add_beam([(0, 0, 0), (1, 0, 0)], **given)


def test_points_are_where_they_are_said_to_be():
    model, arm = beam_model()
    assert arm.length == 1.0
    assert arm.at(0.5).node == 2
    np.testing.assert_allclose(model._position(arm.at(0.6, offset=(0.01, 0.02))), (0.6, 0.01, 0.02))
    np.testing.assert_allclose(model._position(arm.end), (1, 0, 0))
    assert str(arm.at(1.0, offset=(0, 0.02))) == "arm, element 3 at 1, offset (0, 0.02)"
    assert model["arm"].end == arm.end
    assert model.dof == 60


def test_up_sets_the_axes_of_the_section():
    for up, y, z in (((0, 0, 1), (0, 1, 0), (0, 0, 1)), ((0, 1, 0), (0, 0, -1), (0, 1, 0))):
        model, arm = beam_model(up=up)
        np.testing.assert_allclose(model._position(arm.at(1.0, offset=(1, 0))) - (1, 0, 0), y, atol=1e-15)
        np.testing.assert_allclose(model._position(arm.at(1.0, offset=(0, 1))) - (1, 0, 0), z, atol=1e-15)
        axes = pl.simulate(model, duration=0.01, step=0.01).track(arm.start).orientation[0].as_matrix()
        np.testing.assert_allclose(axes, np.column_stack([(1, 0, 0), y, z]), atol=1e-15)


def test_up_along_the_beam_takes_another_axis_and_says_so():
    with pytest.warns(UserWarning, match="runs along the beam"):
        model, arm = beam_model(up=(1, 0, 0))
    np.testing.assert_allclose(model._position(arm.at(0.0, offset=(0, 1))), (0, 1, 0), atol=1e-15)


def test_initial_shape_turns_sections_without_twist():
    s = np.linspace(0, 1, 9)
    places = np.column_stack([np.sin(s), 1 - np.cos(s), 0 * s])
    model, arm = beam_model(elements=8, initial=places)
    model.clamp(arm.start)
    result = pl.simulate(model, duration=1e-4, step=1e-4)
    curvature = result.strain(arm).curvature[0]
    # Slopes of a cubic spline, worst at its ends.
    np.testing.assert_allclose(curvature, np.tile((0, 0, 1.0), (8, 1)), atol=0.1)
    turned = result.track(arm.end).orientation[0].as_rotvec()
    np.testing.assert_allclose(turned, (0, 0, 1.0), atol=0.02)


@pytest.mark.parametrize("kind", ["vector", "nodes", "callable"])
def test_velocities(kind):
    omega, speed = np.array([0.5, -1.0, 2.0]), np.array([1.0, 2.0, 3.0])
    places = np.column_stack([np.linspace(0, 1, 5), np.zeros((5, 2))])
    given = {
        "vector": {"velocity": speed, "angular_velocity": omega},
        "nodes": {"velocity": speed + np.cross(omega, places)},
        "callable": {"velocity": lambda x: speed + np.cross(omega, x)},
    }[kind]
    model, arm = beam_model(**given)
    result = pl.simulate(model, duration=1e-3, step=1e-3)
    expected = speed + np.cross(omega, places)
    np.testing.assert_allclose(result.velocities(arm)[0], expected, atol=1e-12)
    axis = result.track(arm.at(0.4, offset=(0.01, 0.02))).velocity[0]
    if kind != "nodes":
        # Velocities of nodes say nothing about spin.
        np.testing.assert_allclose(axis, speed + np.cross(omega, (0.4, 0.01, 0.02)), atol=1e-10)


def test_sections_may_vary():
    taper = [pl.Circle(0.02), pl.Circle(0.018), pl.Circle(0.016), pl.Circle(0.014)]
    model, arm = beam_model(section=taper, material=STEEL)
    model.clamp(arm.start)
    model.add_force(arm.end, (1.0, 0, 0))
    strain = pl.solve_static(model).strain(arm).axial[-1]
    # A node has one slope, where the strain jumps: 2 % at jumps of a quarter.
    np.testing.assert_allclose(strain, [1 / (2.1e11 * c.area) for c in taper], rtol=0.02)

    def section(s):
        return pl.Rectangle(0.02, 0.04 * (1 - 0.5 * s))

    light = pl.Model()
    arm = light.add_beam([(0, 0, 0), (1, 0, 0)], elements=16, section=section, material=STEEL)
    light.clamp(arm.start)
    light.add_force(arm.end, (0, 0, 1.0))
    tip = pl.solve_static(light).track(arm.end).position[-1, 2]
    x = np.linspace(0, 1, 4001)
    inertia = 0.02 * (0.04 * (1 - 0.5 * x)) ** 3 / 12
    exact = np.trapezoid((1 - x) ** 2 / (2.1e11 * inertia), x)
    # Shear adds 1e-3 at this slenderness.
    assert abs(tip / exact - 1) < 2e-3


def test_everything_is_kept_in_files(tmp_path):
    model, arm = beam_model()
    model.clamp(arm.start)
    model.add_force(arm.at(0.9, offset=(0.01, 0)), (0, 0, -0.1), follower=True)
    model.add_moment(arm.end, (0.01, 0, 0))
    model.add_line_load(arm, (0, 0.1, 0))
    model.save(tmp_path / "model.json")
    loaded = pl.Model.load(tmp_path / "model.json")
    assert str(loaded) == str(model)
    first, second = (pl.simulate(m, duration=0.02, step=1e-3) for m in (model, loaded))
    np.testing.assert_array_equal(first.positions(arm), second.positions(arm))
    first.save(tmp_path / "run.h5")
    back = pl.Result.load(tmp_path / "run.h5")
    np.testing.assert_array_equal(back.strain(arm).curvature, first.strain(arm).curvature)
    np.testing.assert_array_equal(back.axial_force("arm"), first.axial_force(arm))
    orientation = [r.track(arm.end).orientation[-1].as_quat() for r in (first, back)]
    np.testing.assert_array_equal(*orientation)


def test_runs_continue_bit_for_bit(tmp_path):
    model, arm = beam_model()
    model.clamp(arm.start)
    whole = pl.Stepper(model, step=1e-3)
    whole.advance(20)
    part = pl.Stepper(model, step=1e-3)
    part.advance(10)
    part.save(tmp_path / "half")
    again = pl.Stepper.load(tmp_path / "half")
    again.advance(10)
    np.testing.assert_array_equal(again.coordinates, whole.coordinates)
    np.testing.assert_array_equal(again.position(arm.end), whole.position(arm.end))


def test_a_run_begins_where_another_ended():
    model, arm = beam_model(material=STEEL)
    place = (0.1, 0, 0) * pl.Ramp(1.0)
    drive = model.drive(arm.start, position=place, orientation=Rotation.identity())
    moved = pl.simulate(model, duration=1.0, step=0.01)
    held = pl.Model(gravity=(0, 0, -9.81))
    other = held.add_beam([(0, 0, 0), (1, 0, 0)], elements=4, section=BAR, material=STEEL, name="arm")
    held.clamp(other.start)
    result = pl.simulate(held, duration=0.1, step=0.01, start=moved)
    # The clamp holds the section where the drive has brought it.
    np.testing.assert_allclose(result.track(other.start).position[-1], (0.1, 0, 0), atol=1e-9)
    assert abs(moved.reaction(drive).force[-1, 0]) > 0


def test_statics_balance_weight():
    model, arm = beam_model(material=STEEL)
    wall = model.clamp(arm.start)
    result = pl.solve_static(model)
    weight = 7850 * BAR.area * 9.81
    np.testing.assert_allclose(result.reaction(wall).force[-1], (0, 0, weight), rtol=1e-6, atol=1e-6)
    np.testing.assert_allclose(result.reaction(wall).moment[-1, 1], -weight / 2, rtol=1e-4)
    np.testing.assert_allclose(result.center_of_mass(arm)[-1, 0], 0.5, rtol=1e-4)


def test_a_stiff_joint_holds_other_bodies():
    model, arm = beam_model(material=STEEL)
    model.clamp(arm.start)
    ball = model.add_rigid_body(mass=2.0, shape=pl.Sphere(0.05), position=(1, 0, 0))
    rope = model.add_cable([(1, 0, 0), (1, 0, -1)], elements=4, section=pl.Circle(2e-3), material=STEEL)
    model.weld(arm.end, ball)
    model.pin(rope.start, arm.end)
    result = pl.solve_static(model)
    load = 2.0 * 9.81 + 7850 * (np.pi * 4e-6) * 9.81
    weight = 7850 * BAR.area * 9.81
    exact = -(load / 3 + weight / 8) / (2.1e11 * BAR.second_moments[0])
    # Shear adds 2e-3.
    np.testing.assert_allclose(result.track(arm.end).position[-1, 2], exact, rtol=5e-3)


def test_pictures_pages_and_files_for_paraview(tmp_path):
    model, arm = beam_model(section=pl.Tube(0.03, 0.02))
    model.clamp(arm.start)
    square = model.add_beam([(0, 1, 0), (1, 1, 0)], elements=2, section=BAR, material=RUBBER)
    model.clamp(square.start)
    model.add_force(arm.end, (0, 0, -1), follower=True)
    result = pl.simulate(model, duration=0.05, step=5e-3)
    for color in (None, "strain", "axial_force", "speed"):
        figure = result.plot(color=color)
        assert figure is not None
        plt.close("all")
    result.export_html(tmp_path / "beam.html")
    assert (tmp_path / "beam.html").stat().st_size > 10_000
    meshio = pytest.importorskip("meshio")
    result.export_vtk(tmp_path / "vtk")
    piece = meshio.read(next((tmp_path / "vtk").glob("surfaces_*.vtu")))
    assert {"strain", "speed", "velocity"} <= set(piece.point_data)
    assert (np.abs(piece.points[:, 2]).max() > 0.03) or (piece.points[:, 2].min() < -0.02)


def test_surface_of_a_beam_is_closed_and_has_its_volume():
    from pliant.drawing import draw

    for section in (BAR, pl.Circle(0.02), pl.Section(1e-3, (1e-8, 1e-8), torsion_constant=1e-8)):
        model, arm = beam_model(section=section)
        model.clamp(arm.start)
        result = pl.simulate(model, duration=1e-3, step=1e-3)
        (look,) = draw(result, np.array([0]))
        p = look.points[0][look.triangles]
        volume = np.einsum("ti,ti->t", p[:, 0], np.cross(p[:, 1], p[:, 2])).sum() / 6
        # A polygon of 24 corners has 1.1 % less than its circle.
        assert 0.985 < volume / section.area < 1.0001, section


def test_table_names_the_beam():
    model, _ = beam_model()
    assert "4 elements, 1 m, section Rectangle(width=0.02, height=0.04)" in str(model)
