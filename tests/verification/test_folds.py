"""Folds between surfaces: free, sprung, held; against closed forms, with energy."""

from __future__ import annotations

from itertools import product

import numpy as np
import pliant as pl
import pytest

STIFF = pl.SaintVenantKirchhoff(youngs_modulus=2e11, poisson_ratio=0.0, density=1000.0)
ELEMENTS = ("bicubic", "plate", "triangle", "cylindrical")


def panel(start, element, divisions=(2, 2), turn=0.0, size=(1.0, 1.0)):
    """A rectangle from a corner at ``start``, u along x, turned up about its edge along y."""
    flat = pl.Mesh.rectangle(*size, divisions=divisions)
    c, s = np.cos(turn), np.sin(turn)
    rotation = np.array([(c, 0, s), (0, 1, 0), (-s, 0, c)])
    points = flat.points @ rotation + start
    if element == "triangle":
        halves = np.concatenate([flat.quads[:, [0, 1, 2]], flat.quads[:, [0, 2, 3]]])
        return pl.Mesh(points, triangles=halves)
    if element == "plate":
        return pl.Mesh(points, flat.quads)
    slopes = flat.slopes @ rotation
    return pl.Mesh(points, flat.quads, slopes=slopes, sizes=flat.sizes)


def add(model, mesh, element, thickness=0.01):
    if element == "membrane":
        return model.add_membrane(mesh, thickness=thickness, material=STIFF, wrinkling=False)
    return model.add_shell(mesh, thickness=thickness, material=STIFF, element=element)


def pair(elements=("bicubic", "bicubic"), turn=0.0, model=None, thickness=0.01, **fold):
    """A clamped panel and one folded to it, about the y axis at x = 1."""
    model = pl.Model() if model is None else model
    first = add(model, panel((0, 0, 0), elements[0]), elements[0], thickness)
    second = add(model, panel((1, 0, 0), elements[1], turn=turn), elements[1], thickness)
    model.clamp(first.faces())
    edge_a, edge_b = first.edge([(1, 0, 0), (1, 1, 0)]), second.edge([(1, 0, 0), (1, 1, 0)])
    return model, first, second, model.fold(edge_a, edge_b, **fold)


@pytest.mark.parametrize("elements", list(product(ELEMENTS, repeat=2)))
def test_a_sprung_panel_swings_as_a_rigid_one(record, elements):
    stiffness = 2.0
    model, *_ = pair(elements, stiffness=stiffness)
    found = pl.solve_modes(model, 1).frequencies[0]
    # omega^2 = k L / (rho h L a^3 / 3).
    exact = np.sqrt(3 * stiffness / (1000.0 * 0.01)) / (2 * np.pi)
    # The panel is a million times stiffer than the crease; its mass is integrated exactly.
    name = f"sprung panel of {elements[1]} on {elements[0]} elements, frequency"
    assert record(name, found, exact, 1e-4 * exact, unit="Hz", source="closed form")


def test_a_sprung_triangle_of_film(record):
    model = pl.Model()
    first = add(model, pl.Mesh.rectangle(1, 1, divisions=(2, 1)), "bicubic")
    model.clamp(first.faces())
    film = pl.Mesh([(1, 0, 0), (2, 0.5, 0), (1, 1, 0)], triangles=[(0, 1, 2)])
    second = add(model, film, "membrane")
    model.fold(first.edge("u_max"), second.edge([(1, 0, 0), (1, 1, 0)]), stiffness=2.0)
    found = pl.solve_modes(model, 1).frequencies[0]
    # omega^2 = k L / (rho h L a^3 / 12), rigid as a film of one triangle is out of its plane.
    exact = np.sqrt(12 * 2.0 / (1000.0 * 0.01)) / (2 * np.pi)
    # Rounding: the film is 1e9 times stiffer in its plane.
    assert record("sprung triangle of film, frequency", found, exact, 1e-7, unit="Hz", source="closed form")


def test_angle_under_gravity(record):
    # A panel hangs sprung from a crease: k theta = m g a/2 cos(theta), turned down from the horizontal.
    stiffness = 300.0
    model = pl.Model(gravity=(0, 0, -9.81))
    model, _, _, crease = pair(model=model, thickness=0.05, stiffness=stiffness)
    result = pl.solve_static(model)
    motion = result.joint(crease)
    theta = -float(motion.position[-1])
    weight = 1000.0 * 0.05 * 9.81
    exact = 0.5
    for _ in range(50):
        residual = stiffness * exact - 0.5 * weight * np.cos(exact)
        exact -= residual / (stiffness + 0.5 * weight * np.sin(exact))
    # The panel itself sags by 1e-5.
    assert record("sprung crease under gravity, angle", theta, exact, 2e-5, unit="rad", source="closed form")
    assert motion.force[-1] == pytest.approx(stiffness * theta, rel=1e-9)


@pytest.mark.parametrize("turn", [0.7, -0.9])
def test_rest_angle_is_that_of_the_stress_free_meshes(turn):
    model, _, _, crease = pair(turn=turn, stiffness=3.0)
    result = pl.solve_static(model)
    # Positive to the side of the first normal, which is up; nothing moves.
    assert result.joint(crease).position[-1] == pytest.approx(turn, abs=1e-12)
    assert np.abs(result.joint(crease).force).max() < 1e-9


@pytest.mark.parametrize("elements", [("bicubic", "bicubic"), ("plate", "triangle"), ("triangle", "bicubic")])
def test_energy_of_a_crease_is_accounted_for(elements):
    model, _, second, crease = pair(elements, stiffness=20.0, damping=0.4)
    model.add_force(second.at((2, 0, 0)), (0, 0, 40.0) * pl.Ramp(0.2))
    errors = []
    for step in (4e-3, 2e-3):
        result = pl.simulate(model, duration=0.4, step=step, output_every=1)
        energy = result.energy
        total = energy.total
        errors.append(float(np.abs(total - total[0]).max()))
        assert energy.dissipated[-1] > 0
        moved = np.abs(result.joint(crease).position).max()
    # The panel turned far, and the balance is second order in the step.
    assert moved > 0.3
    assert errors[1] < 2e-3 * energy.elastic.max()
    assert errors[1] < 0.4 * errors[0]


def test_a_held_crease_turns_as_it_is_told(record):
    model, _, second, crease = pair(angle=1.2 * pl.Ramp(0.5))
    result = pl.simulate(model, duration=0.6, step=5e-3)
    motion = result.joint(crease)
    told = np.array([1.2 * pl.Ramp(0.5)(t)[0] for t in result.time])
    np.testing.assert_allclose(motion.position, told, atol=1e-9)
    tip = result.track(second.at((2, 0.5, 0))).position[-1]
    # A rigid panel, but for the vibrations that the drive leaves: 1e-4.
    np.testing.assert_allclose(tip, (1 + np.cos(1.2), 0.5, np.sin(1.2)), atol=2e-4)
    # Its work is what the panel has.
    energy = result.energy
    balance = energy.kinetic + energy.elastic - energy.work
    assert np.abs(balance).max() < 1e-3 * energy.kinetic.max()


def test_an_actuated_spring_folds_the_panel_and_does_work():
    stiffness, angle = 30.0, 1.0
    model, _, _, crease = pair(stiffness=stiffness, damping=15.0, angle=angle * pl.Ramp(0.5))
    result = pl.simulate(model, duration=4.0, step=1e-2)
    motion = result.joint(crease)
    assert motion.position[-1] == pytest.approx(angle, abs=1e-3)
    energy = result.energy
    total = energy.total
    # Second order: a hundredth of the period.
    assert np.abs(total).max() < 2e-3 * energy.work.max() + 1e-6


def test_folding_shut_and_back_passes_a_half_turn():
    # A rest angle of half a turn: the panel folds flat onto the other from either side of the branch.
    model, _, _, crease = pair(stiffness=5.0, damping=8.0, angle=np.pi)
    result = pl.simulate(model, duration=8.0, step=2e-2)
    position = result.joint(crease).position
    assert position[0] == pytest.approx(0.0, abs=1e-12)
    assert position[-1] == pytest.approx(np.pi, abs=2e-2)
    assert np.abs(np.diff(position)).max() < 0.5


def test_within_one_body_and_without_spring():
    # Two panels in one mesh with double points along the crease; the free one falls as a hinged plate.
    left, right = panel((0, 0, 0), "plate"), panel((1, 0, 0), "plate")
    n = len(left.points)
    rims = {
        "left": np.flatnonzero(np.abs(left.points[:, 0] - 1) < 1e-9),
        "right": n + np.flatnonzero(np.abs(right.points[:, 0] - 1) < 1e-9),
    }
    points, quads = np.vstack([left.points, right.points]), np.vstack([left.quads, right.quads + n])
    model = pl.Model(gravity=(0, 0, -9.81))
    mesh = pl.Mesh(points, quads, edges=rims)
    sheet = model.add_shell(mesh, thickness=0.01, material=STIFF, element="plate")
    model.clamp(sheet.faces(np.arange(4)))
    crease = model.fold(sheet.edge("left"), sheet.edge("right"))
    result = pl.simulate(model, duration=0.3, step=2e-3)
    # theta'' = 3 g/(2 a) cos(theta), from rest.
    from scipy.integrate import solve_ivp

    exact = solve_ivp(lambda t, y: (y[1], 14.715 * np.cos(y[0])), (0, 0.3), (0, 0), rtol=1e-10).y[0, -1]
    # Second order in the step: 2e-5.
    assert -result.joint(crease).position[-1] == pytest.approx(exact, abs=1e-4)


def test_reaction_of_a_clamped_edge_has_its_moment(record):
    model = pl.Model()
    strip = add(model, pl.Mesh.rectangle(2.0, 0.5, divisions=(4, 1)), "bicubic", thickness=0.02)
    hold = model.clamp(strip.edge("u_min"))
    model.add_line_load(strip.edge("u_max"), (0, 0, 10.0))
    reaction = pl.solve_static(model).reaction(hold)
    # Statics: 5 N at an arm of 2 m, and of 0.25 m from the first node.
    assert record("clamped edge, force", float(reaction.force[-1, 2]), -5.0, 1e-9, unit="N", source="statics")
    moment = reaction.moment[-1]
    assert record("clamped edge, moment", float(moment[1]), 10.0, 1e-6, unit="N m", source="statics")
    assert moment[0] == pytest.approx(-1.25, abs=1e-6)
