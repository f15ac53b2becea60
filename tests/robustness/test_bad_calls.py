"""Wrong calls fail at once, with an error that names the argument and the value it got."""

from __future__ import annotations

import contextlib
import json
import math
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pliant as pl
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pliant.typing import FloatArray

NAN, INF = math.nan, math.inf


def scenery() -> SimpleNamespace:
    """A model with one of each, and a stranger."""
    rubber = pl.LinearElastic(youngs_modulus=1e7, poisson_ratio=0.45, density=1000.0)
    section = pl.Circle(radius=5e-3)
    model = pl.Model(gravity=(0, 0, -9.81))
    rope = model.add_cable([(0, 0, 0), (1, 0, 0)], elements=4, section=section, material=rubber, name="rope")
    net = model.add_cable_net(
        [(5, 0, 0), (6, 0, 0), (6, 1, 0)], [(0, 1), (1, 2)], elements=2, section=section, material=rubber
    )
    ball = model.add_point_mass(1.0, at=(0, 0, 5))
    other = pl.Model()
    ground = model.add_obstacle(pl.HalfSpace(), position=(0, 0, -9), name="ground")
    model.add_contact(rope)
    stranger = other.add_cable([(0, 0, 0), (1, 0, 0)], elements=4, section=section, material=rubber)
    kinds = {"elements": 4, "section": section, "material": rubber}
    line = [(0, 0, 0), (1, 0, 0)]
    brick = model.add_rigid_body(mass=1.0, shape=pl.Box((0.2, 0.1, 0.1)), position=(2, 0, 0), name="brick")
    square = pl.Mesh.rectangle(1, 1, divisions=(2, 2))
    sheet = model.add_shell(square, thickness=0.01, material=rubber, name="sheet")
    film = model.add_membrane(square, thickness=1e-4, material=rubber, name="film")
    cart = model.add_rigid_body(mass=1.0, shape=pl.Box((0.2, 0.1, 0.1)), position=(3, 0, 0), name="cart")
    wheel = model.add_rigid_body(mass=1.0, shape=pl.Sphere(0.1), position=(4, 0, 0), name="wheel")
    post = model.add_rigid_body(mass=1.0, shape=pl.Sphere(0.1), position=(7, 0, 0), name="post")
    bare = model.add_rigid_body(mass=1.0, inertia=(1, 1, 1), position=(8, 0, 0))
    beside = pl.Mesh(square.points - (1, 0, 0), square.quads)
    arc = pl.Curve(lambda s: (np.sin(s), 0.0, 1.0 - np.cos(s)), length=1.5)
    return SimpleNamespace(
        m=model,
        rope=rope,
        net=net,
        ball=ball,
        brick=brick,
        bare=bare,
        sheet=sheet,
        film=film,
        square=square,
        beside=model.add_shell(beside, thickness=0.01, material=rubber, name="beside"),
        arm=model.add_beam(line, elements=4, section=section, material=rubber, name="arm"),
        rail=model.slider(cart),
        axle=model.hinge(wheel.center),
        grip=model.clamp(post),
        ground=ground,
        stranger=stranger,
        k=kinds,
        line=line,
        arc=arc,
        section=section,
    )


def cable(s: SimpleNamespace, points: Any = None, **changes: Any) -> Any:
    return s.m.add_cable(s.line if points is None else points, **{**s.k, **changes})


def net(s: SimpleNamespace, points: Any, edges: Any, **changes: Any) -> Any:
    return s.m.add_cable_net(points, edges, **{**s.k, **changes})


def fold(s: SimpleNamespace, **options: Any) -> object:
    return s.m.fold(s.sheet.edge("u_min"), s.beside.edge([(0, 0, 0), (0, 1, 0)]), **options)


def shell(s: SimpleNamespace, mesh: Any = None, **changes: Any) -> Any:
    given = {"thickness": 0.01, "material": s.k["material"], **changes}
    return s.m.add_shell(s.square if mesh is None else mesh, **given)


def beam(s: SimpleNamespace, points: Any = None, **changes: Any) -> Any:
    return s.m.add_beam(s.line if points is None else points, **{**s.k, **changes})


def rigid(s: SimpleNamespace, **changes: Any) -> Any:
    return s.m.add_rigid_body(**{"mass": 1.0, "shape": pl.Sphere(0.1), **changes})


def elastic(**changes: Any) -> Any:
    return pl.LinearElastic(**{"youngs_modulus": 1e7, "poisson_ratio": 0.3, "density": 1e3, **changes})


def plastic(**changes: Any) -> Any:
    given = {"youngs_modulus": 2e11, "poisson_ratio": 0.3, "density": 7850.0}
    return pl.BilinearPlastic(**{**given, "yield_stress": 2.5e8, "tangent_modulus": 2e10, **changes})


def tough() -> Any:
    return elastic(retardation_time=0.1)


def gum() -> Any:
    return pl.NeoHookean(youngs_modulus=1e6, poisson_ratio=0.5, density=1e3)


def arch() -> Any:
    return pl.Mesh.surface(lambda u, v: (np.sin(u), v, np.cos(u)), (0, 1), (0, 1), divisions=(2, 1))


def strip(**changes: Any) -> Any:
    sizes = {"length": 0.1, "height": 0.01, "width": 0.01, "notch_length": 0.02, "notch_height": 0.004}
    return pl.sdi.cosine_notch(**{**sizes, "youngs_modulus": 1e6, **changes})


def two_cuts(rows: Any) -> Any:
    return pl.sdi.notches(0.1, 0.01, 0.01, rows, 1e6)


def arm() -> Any:
    return pl.sdi.cone(0.2, 0.03, 0.02, 1e6)


def rubbing() -> Any:
    model = scenery().m
    model.add_contact(model["rope"], model["net1"], friction=pl.Coulomb(0.3))
    return model


def bare() -> Any:
    return pl.sdi.Body(0.1, lambda x: 1e-3 * (1 + x))


def samples(x: Any, k: Any = None, **options: Any) -> Any:
    places = np.array(list(x), dtype=float)
    return pl.sdi.Body.from_samples(places, np.ones(len(places)) if k is None else k, **options)


def run(s: SimpleNamespace, **changes: Any) -> Any:
    return pl.simulate(s.m, **{"duration": 1.0, "step": 0.1, **changes})


def stepper(s: SimpleNamespace, **changes: Any) -> pl.Stepper:
    model = s.m.copy()
    model.add_force(s.ball, (0, 0, 1) * pl.Input("jet"))
    return pl.Stepper(model, **{"step": 0.1, **changes})


def two_jets(s: SimpleNamespace) -> Any:
    model = s.m.copy()
    model.add_force(s.ball, (0, 0, 1) * pl.Input("jet", initial=1.0))
    return stepper(SimpleNamespace(m=model, ball=s.ball))


def pinned(s: SimpleNamespace) -> pl.Joint:
    joint: pl.Joint = s.m.copy().pin(s.rope.end)
    return joint


def released_along(s: SimpleNamespace, **drive: float) -> Any:
    model = s.m.copy()
    model.drive(s.axle, name="motor", **drive)
    return model[s.axle.name].release(at=1.0)


def tendon(s: SimpleNamespace, points: Any = None, tension: Any = 1.0, **changes: Any) -> Any:
    points = [(0, 0, 1), s.rope.end] if points is None else points
    return s.m.add_tendon(points, tension, **changes)


def one_ball() -> pl.Model:
    model = pl.Model()
    model.add_point_mass(1.0, at=(0, 0, 0), name="other ball")
    return model


def helix(s: float) -> tuple[float, float, float]:
    x = s / math.sqrt(2)
    return math.cos(x), math.sin(x), x


LAW = pl.LuGre(0.4, 0.3, bristle_stiffness=1e5)
INNER = [(0.5, 0, 0), (0.5, 0.5, 0), (0.5, 1, 0)]
ARC = pl.Curve(lambda s: (np.sin(s), 1 - np.cos(s), 0.0), length=1.0)
TRIANGLE = [(0, 0, 0), (1, 0, 0), (0, 1, 0)]
SQUARE = [*TRIANGLE, (1, 1, 0)]
# A hook between two of its nine equidistant places.
HOOK = [(0, 0, 0), (1, 0, 0)], 0.03, [(1, 0, 0), (-np.cos(0.5), np.sin(0.5), 0)]
HAIRPIN = [(0, 0, 0), (1, 0, 0), (1, 0.1, 0), (0, 0.1, 0)]


def moebius() -> tuple[FloatArray, list[tuple[int, int, int]]]:
    """A band with half a turn: points of one rim, then of the other."""
    n = 12
    phi = np.arange(n) * 2 * np.pi / n
    out = np.stack([np.cos(phi), np.sin(phi), 0 * phi], axis=1)
    wide = 0.3 * (np.cos(phi / 2)[:, None] * out + np.sin(phi / 2)[:, None] * np.array((0, 0, 1)))
    faces = [(k, k + n, k + 1, k + 1 + n) for k in range(n - 1)] + [(n - 1, 2 * n - 1, n, 0)]
    triangles = [corners for a, b, c, d in faces for corners in ((a, b, c), (c, b, d))]
    return np.concatenate([out + wide, out - wide]), triangles


CATALOGUE: list[tuple[str, str, Callable[[SimpleNamespace], Any]]] = [
    # argument, value as it must appear in the message, call
    ("gravity", "(0, 0)", lambda s: pl.Model(gravity=(0, 0))),
    ("gravity", "nan", lambda s: pl.Model(gravity=(0, 0, NAN))),
    ("gravity", "down", lambda s: pl.Model(gravity="down")),
    ("gravity", "None", lambda s: pl.Model(gravity=None)),
    ("gravity", "True", lambda s: pl.Model(gravity=(0, 0, True))),
    # surfaces
    ("thickness", "0", lambda s: shell(s, thickness=0)),
    ("thickness", "nan", lambda s: shell(s, thickness=NAN)),
    ("thickness", "[1, 2]", lambda s: shell(s, thickness=[1, 2])),
    ("mesh", "'square'", lambda s: shell(s, "square")),
    ("material", "None", lambda s: shell(s, material=None)),
    ("element", "'brick'", lambda s: shell(s, element="brick")),
    ("quadrature", "'gauss'", lambda s: shell(s, quadrature="gauss")),
    ("bending", "'exakt'", lambda s: shell(s, bending="exakt")),
    ("bending", "retardation_time", lambda s: shell(s, bending="simplified", material=tough())),
    ("bending", "NeoHookean", lambda s: shell(s, bending="simplified", material=gum())),
    ("bending", "flat", lambda s: shell(s, bending="simplified", mesh=arch())),
    ("integrals", "'gauss'", lambda s: shell(s, integrals="gauss")),
    ("integrals", "cylindrical", lambda s: shell(s, integrals="precomputed")),
    ("integrals", "NeoHookean", lambda s: shell(s, integrals="precomputed", material=gum())),
    ("initial", "(8, 3)", lambda s: shell(s, initial=np.zeros((8, 3)))),
    ("velocity", "(1, 2)", lambda s: shell(s, velocity=(1, 2))),
    (
        "wrinkling",
        "-1",
        lambda s: s.m.add_membrane(s.square, thickness=1, material=s.k["material"], wrinkling=-1),
    ),
    ("faces", "'film'", lambda s: stepper(s).cut_force("film")),
    ("faces", "film, 4 faces", lambda s: stepper(s).cut_force(s.film.faces())),
    ("sizes", "'moon'", lambda s: pl.scenes.solar_sail("moon")),
    ("sizes", "14.0", lambda s: pl.scenes.solar_sail(14.0)),
    ("changes", "{'rows': 4}", lambda s: pl.scenes.solar_sail(pl.scenes.SailSizes(), rows=4)),
    ("start", "'open'", lambda s: pl.scenes.solar_sail(start="open")),
    ("base_cells", "10", lambda s: pl.scenes.SailSizes(base_cells=10)),
    ("arc_cells", "9", lambda s: pl.scenes.SailSizes(arc_cells=9)),
    ("tip_mass", "0.0", lambda s: pl.scenes.SailSizes(tip_mass=0.0)),
    ("width", "0", lambda s: pl.Mesh.rectangle(0, 1, divisions=(1, 1))),
    ("divisions", "3", lambda s: pl.Mesh.rectangle(1, 1, divisions=3)),
    ("divisions[1]", "0", lambda s: pl.Mesh.rectangle(1, 1, divisions=(1, 0))),
    ("points", "(2, 3)", lambda s: pl.Mesh.grid(np.zeros((2, 3)))),
    ("position", "1.0", lambda s: pl.Mesh.surface(1.0, (0, 1), (0, 1), (1, 1))),
    ("u", "(1, 0)", lambda s: pl.Mesh.surface(lambda u, v: (u, v, 0), (1, 0), (0, 1), (1, 1))),
    ("quads[0]", "[0, 1, 2, 9]", lambda s: pl.Mesh([*TRIANGLE, (1, 1, 0)], quads=[(0, 1, 2, 9)])),
    ("points[3]", "[2., 2., 2.]", lambda s: pl.Mesh([*TRIANGLE, (2, 2, 2)], triangles=[(0, 1, 2)])),
    ("i", "9", lambda s: s.sheet.node(9)),
    ("points", "'left'", lambda s: s.sheet.edge("left")),
    ("points[0]", "5", lambda s: s.sheet.edge([(5, 5, 5), (0, 0, 0)])),
    ("select", "'wing'", lambda s: s.sheet.faces("wing")),
    ("select", "[7]", lambda s: s.sheet.faces([7])),
    ("surface", "brick", lambda s: s.m.add_pressure(s.brick, 1.0)),
    ("pressure", "'high'", lambda s: s.m.add_pressure(s.sheet, "high")),
    ("edge", "sheet", lambda s: s.m.add_edge_moment(s.sheet, 1.0)),
    ("edge", "film", lambda s: s.m.add_edge_moment(s.film.edge("u_min"), 1.0)),
    ("normal", "(0, 1, 0)", lambda s: s.m.symmetry(s.sheet.edge("u_min"), normal=(0, 1, 0))),
    ("point", "Point", lambda s: s.m.clamp(s.film.node(0))),
    ("to", "(0, 0, 0)", lambda s: s.m.pin(s.sheet.edge("u_min"), to=(0, 0, 0))),
    ("b", "film", lambda s: s.m.weld(s.sheet.edge("u_min"), s.film.edge("rim"))),
    # beams
    ("points[1]", "corners", lambda s: beam(s, TRIANGLE)),
    ("points", "function", lambda s: beam(s, helix)),
    ("elements", "0", lambda s: beam(s, elements=0)),
    ("section", "7", lambda s: beam(s, section=7)),
    ("section", "torsion_constant", lambda s: beam(s, section=pl.Section(1e-4, (1e-9, 1e-9)))),
    ("section[0]", "None", lambda s: beam(s, section=[None, s.section, s.section, s.section])),
    ("section", "4 elements", lambda s: beam(s, section=[s.section] * 3)),
    (
        "section",
        "second moments",
        lambda s: beam(s, section=pl.Section(1e-4, (1e-9, 0), torsion_constant=1e-9)),
    ),
    ("material", "'wood'", lambda s: beam(s, material="wood")),
    ("material", "NeoHookean", lambda s: beam(s, material=pl.NeoHookean(1e6, 0.5, 1e3))),
    ("material", "for cables and nets", lambda s: beam(s, material=plastic())),
    ("material", "for cables and nets", lambda s: shell(s, material=plastic())),
    ("material", "for shells and membranes", lambda s: cable(s, material=gum())),
    ("youngs_modulus", "0", lambda s: plastic(youngs_modulus=0)),
    ("poisson_ratio", "0.5", lambda s: plastic(poisson_ratio=0.5)),
    ("yield_stress", "0", lambda s: plastic(yield_stress=0)),
    ("yield_stress", "nan", lambda s: plastic(yield_stress=NAN)),
    ("yield_stress", "inf", lambda s: plastic(yield_stress=INF)),
    ("tangent_modulus", "-1", lambda s: plastic(tangent_modulus=-1)),
    ("tangent_modulus", "below youngs_modulus", lambda s: plastic(tangent_modulus=2e11)),
    ("tangent_modulus", "'soft'", lambda s: plastic(tangent_modulus="soft")),
    ("hardening", "'mixed'", lambda s: plastic(hardening="mixed")),
    ("retardation_time", "-1", lambda s: plastic(retardation_time=-1)),
    ("pretension", "19635 N", lambda s: cable(s, material=plastic(tangent_modulus=0), pretension=2e4)),
    ("up", "(0, 0)", lambda s: beam(s, up=(0, 0))),
    ("up", "(0, 0, 0)", lambda s: beam(s, up=(0, 0, 0))),
    ("up", "callable", lambda s: beam(s, up=lambda x: (1, 0, 0))),
    ("up(0)", "nan", lambda s: beam(s, up=lambda x: (0, 0, NAN))),
    ("locking", "'reduced'", lambda s: beam(s, locking="reduced")),
    ("locking", "none", lambda s: beam(s, locking="none", section=lambda x: pl.Circle(0.01 + 0.001 * x))),
    ("initial", "(2, 3)", lambda s: beam(s, initial=np.zeros((2, 3)))),
    ("initial", "apart", lambda s: beam(s, initial=np.zeros((5, 3)))),
    ("velocity", "(1, 2)", lambda s: beam(s, velocity=(1, 2))),
    ("offset", "0.1", lambda s: s.arm.at(0.5, offset=0.1)),
    ("offset", "nan", lambda s: s.arm.at(0.5, offset=(NAN, 0))),
    ("s", "2", lambda s: s.arm.at(2)),
    ("i", "9", lambda s: s.arm.node(9)),
    ("direction", "(0, 0, 1)", lambda s: s.m.drive(s.arm.end, direction=(0, 0, 1))),
    ("orientation", "'up'", lambda s: s.m.drive(s.arm.end, orientation="up")),
    ("b", "point mass and a beam", lambda s: s.m.add_contact(s.ball, s.arm)),
    ("shear_corrections", "(0, 1)", lambda s: pl.Section(1, (1, 1), shear_corrections=(0, 1))),
    ("edge_b", "film", lambda s: s.m.fold(s.sheet.edge("u_min"), s.film.edge("rim"))),
    (
        "edge_b",
        "as many nodes",
        lambda s: s.m.fold(s.sheet.edge("u_min"), s.film.edge([(0, 0, 0), (0, 0.5, 0)])),
    ),
    ("edge_b", "1 m apart", lambda s: s.m.fold(s.sheet.edge("u_min"), s.film.edge("u_max"))),
    ("edge_a", "rope", lambda s: s.m.fold(s.rope, s.film.edge("u_min"))),
    (
        "edge_a",
        "rim",
        lambda s: s.m.fold(s.sheet.edge(INNER), s.film.edge(INNER)),
    ),
    ("stiffness", "-1", lambda s: fold(s, stiffness=-1.0)),
    ("damping", "nan", lambda s: fold(s, damping=NAN)),
    ("angle", "0.3", lambda s: fold(s, angle=0.3)),
    ("angle", "(1, 2, 3)", lambda s: fold(s, angle=(1, 2, 3))),
    ("to", "world or to a rigid body", lambda s: s.m.pin(s.sheet.edge("u_min"), s.rope.end)),
    # sections
    ("radius", "0", lambda s: pl.Circle(radius=0)),
    ("radius", "-1", lambda s: pl.Circle(radius=-1)),
    ("radius", "nan", lambda s: pl.Circle(radius=NAN)),
    ("radius", "True", lambda s: pl.Circle(radius=True)),
    ("radius", "'5 mm'", lambda s: pl.Circle(radius="5 mm")),
    ("radius", "inf", lambda s: pl.Circle(radius=INF)),
    ("radius", "1j", lambda s: pl.Circle(radius=1j)),
    ("inner_radius", "0.02", lambda s: pl.Tube(outer_radius=0.01, inner_radius=0.02)),
    ("outer_radius", "-1", lambda s: pl.Tube(outer_radius=-1, inner_radius=0.02)),
    ("height", "0", lambda s: pl.Rectangle(width=1, height=0)),
    ("width", "[1]", lambda s: pl.Rectangle(width=[1], height=1)),
    ("second_moments", "(1, -1)", lambda s: pl.Section(area=1, second_moments=(1, -1))),
    ("second_moments", "1", lambda s: pl.Section(area=1, second_moments=1)),
    ("area", "0", lambda s: pl.Section(area=0, second_moments=(1, 1))),
    ("torsion_constant", "0", lambda s: pl.Section(area=1, second_moments=(1, 1), torsion_constant=0)),
    # materials
    ("youngs_modulus", "0", lambda s: elastic(youngs_modulus=0)),
    ("youngs_modulus", "'1e7'", lambda s: elastic(youngs_modulus="1e7")),
    ("poisson_ratio", "0.5", lambda s: elastic(poisson_ratio=0.5)),
    ("poisson_ratio", "-1", lambda s: elastic(poisson_ratio=-1)),
    ("density", "-1000", lambda s: elastic(density=-1000)),
    ("density", "False", lambda s: elastic(density=False)),
    ("retardation_time", "-0.1", lambda s: elastic(retardation_time=-0.1)),
    ("hardness", "100", lambda s: pl.youngs_modulus_from_shore_a(100)),
    # friction and contact
    ("static", "0", lambda s: pl.LuGre(0, 0)),
    ("dynamic", "0.5", lambda s: pl.LuGre(0.4, 0.5)),
    ("stribeck_velocity", "-1", lambda s: pl.LuGre(0.4, 0.3, stribeck_velocity=-1)),
    ("bristle_stiffness", "None", lambda s: pl.LuGre(0.4, 0.3, form="per_length")),
    ("form", "'total'", lambda s: pl.LuGre(0.4, 0.3, form="total")),
    ("coefficient", "'high'", lambda s: pl.Coulomb("high")),
    ("law", "Coulomb", lambda s: pl.lugre(pl.Coulomb(0.3), [0, 1], [0, 0], 1.0)),
    ("law.bristle_stiffness", "None", lambda s: pl.lugre(pl.LuGre(0.3, 0.2), [0, 1], [0, 0], 1.0)),
    ("time", "[1, 0]", lambda s: pl.lugre(LAW, [1, 0], [0, 0], 1.0)),
    ("velocity", "[0, 0, 0]", lambda s: pl.lugre(LAW, [0, 1], [0, 0, 0], 1.0)),
    ("normal_force", "-1.0", lambda s: pl.lugre(LAW, [0, 1], [0, 0], -1.0)),
    ("rule", "'start'", lambda s: pl.lugre(LAW, [0, 1], [0, 0], 1.0, rule="start")),
    ("normal", "(0, 0, 0)", lambda s: pl.HalfSpace(normal=(0, 0, 0))),
    ("shape", "'floor'", lambda s: s.m.add_obstacle("floor")),
    ("position", "(0, 0)", lambda s: s.m.add_obstacle(pl.HalfSpace(), position=(0, 0))),
    ("orientation", "(0, 0, 1)", lambda s: s.m.add_obstacle(pl.Sphere(1.0), orientation=(0, 0, 1))),
    ("a", "(0, 0, 0)", lambda s: s.m.add_contact((0, 0, 0))),
    ("a", "PointMass", lambda s: s.m.add_contact(s.ball)),
    ("a", "does not touch itself", lambda s: s.m.add_contact(s.brick)),
    ("b", "point mass and a cable", lambda s: s.m.add_contact(s.ball, s.rope)),
    ("b", "has no shape", lambda s: s.m.add_contact(s.rope, s.bare)),
    ("radius", "-1", lambda s: s.m.add_point_mass(1.0, at=(9, 9, 9), radius=-1)),
    ("points", "(0, 0)", lambda s: pl.TriangleMesh([(0, 0)], [(0, 0, 0)])),
    ("triangles", "0 to 2", lambda s: pl.TriangleMesh(TRIANGLE, [(0, 1, 3)])),
    ("triangles", "no area", lambda s: pl.TriangleMesh([*TRIANGLE, (2, 0, 0)], [(0, 1, 3)])),
    ("triangles", "0.5", lambda s: pl.TriangleMesh(TRIANGLE, [(0, 1, 0.5)])),
    ("triangles", "0 and 1 are neighbours", lambda s: pl.TriangleMesh(SQUARE, [(0, 1, 2), (1, 2, 3)])),
    ("triangles", "turn [1]", lambda s: pl.TriangleMesh(SQUARE, [(0, 1, 2), (1, 2, 3)])),
    ("triangles", "one side only", lambda s: pl.TriangleMesh(*moebius())),
    ("line", "two points", lambda s: pl.Bore([(0, 0, 0)], 0.1)),
    ("line[1]", "coincides", lambda s: pl.Bore([(0, 0, 0), (0, 0, 0), (1, 0, 0)], 0.1)),
    ("tangents", "not vanish", lambda s: pl.Bore([(0, 0, 0), (1, 0, 0)], 0.1, [(0, 0, 0), (1, 0, 0)])),
    ("tangents", "leave them out", lambda s: pl.Bore(ARC, 0.1, [(1, 0, 0)])),
    ("radius", "radius of curvature", lambda s: pl.Bore(ARC, 1.1)),
    ("radius", "radius of curvature", lambda s: pl.Bore(*HOOK)),
    ("radius", "runs into itself", lambda s: pl.Bore(HAIRPIN, 0.2)),
    ("radius", "-1", lambda s: pl.Bore(ARC, -1)),
    ("damping_velocity", "above 0", lambda s: pl.LuGre(0.4, 0.3, damping_velocity=0.0)),
    ("b", "another model", lambda s: s.m.add_contact(s.rope, s.stranger)),
    ("a", "ground", lambda s: s.m.add_contact(s.ground, s.ground)),
    ("b", "contact1", lambda s: s.m.add_contact(s.rope)),
    ("stiffness", "0", lambda s: s.m.add_contact(s.rope, s.net, stiffness=0)),
    ("damping", "-1", lambda s: s.m.add_contact(s.rope, s.net, damping=-1)),
    ("model", "simulate", lambda s: pl.solve_static(rubbing())),
    ("friction", "0.3", lambda s: s.m.add_contact(s.rope, s.net, friction=0.3)),
    ("bodies", "Cable", lambda s: s.m.add_contacts(s.rope)),
    ("bodies[1]", "3", lambda s: s.m.add_contacts([s.rope, 3])),
    # signals
    ("times", "[1.0, 0.0]", lambda s: pl.Table([1.0, 0.0], [0.0, 1.0])),
    ("times", "[0.0]", lambda s: pl.Table([0.0], [0.0])),
    ("values", "[0.0]", lambda s: pl.Table([0.0, 1.0], [0.0])),
    ("period", "0.5", lambda s: pl.Table([0.0, 1.0], [0.0, 1.0], period=0.5)),
    ("smooth", "1", lambda s: pl.Table([0.0, 1.0], [0.0, 1.0], smooth=1)),
    ("function", "5", lambda s: pl.Table.sample(5, times=[0.0, 1.0])),
    ("duration", "0", lambda s: pl.Ramp(0)),
    ("components", "[2, 3]", lambda s: (1, 2) * pl.Ramp(1) + pl.Table([0, 1], [(0, 0, 0), (1, 1, 1)])),
    # cables
    ("points", "[(0, 0, 0)]", lambda s: cable(s, [(0, 0, 0)])),
    ("points", "[(0, 0), (1, 0)]", lambda s: cable(s, [(0, 0), (1, 0)])),
    ("points[1, 0]", "nan", lambda s: cable(s, [(0, 0, 0), (NAN, 0, 0)])),
    ("points[2]", "[1., 0., 0.]", lambda s: cable(s, [(0, 0, 0), (1, 0, 0), (1, 0, 0)])),
    ("points[1]", "[0., 0., 0.]", lambda s: cable(s, [(0, 0, 0), (0, 0, 0)])),
    ("points", "'line'", lambda s: cable(s, "line")),
    ("points", "function", lambda s: cable(s, helix)),
    ("points", "plane", lambda s: cable(s, pl.Curve(helix, length=3.0))),
    ("position", "speed 2", lambda s: cable(s, pl.Curve(lambda x: (2 * x, 0, 0), length=1.0))),
    ("length", "-1", lambda s: pl.Curve(helix, length=-1)),
    ("position", "3", lambda s: pl.Curve(3, length=1)),
    ("position(0)", "(0, 0)", lambda s: cable(s, pl.Curve(lambda x: (0, 0), length=1))),
    ("elements", "0", lambda s: cable(s, elements=0)),
    ("elements", "2.5", lambda s: cable(s, elements=2.5)),
    ("elements", "True", lambda s: cable(s, elements=True)),
    ("elements", "200000000", lambda s: cable(s, elements=200_000_000)),
    ("elements", "1", lambda s: cable(s, TRIANGLE, elements=1)),
    ("section", "0.01", lambda s: cable(s, section=0.01)),
    ("section", "Rectangle(width=0.01, height=0.02)", lambda s: cable(s, section=pl.Rectangle(0.01, 0.02))),
    ("section", "4 elements", lambda s: cable(s, section=[s.section] * 3)),
    ("section[1]", "None", lambda s: cable(s, section=[s.section, None, s.section, s.section])),
    ("section(0)", "7", lambda s: cable(s, section=lambda x: 7)),
    ("material", "'steel'", lambda s: cable(s, material="steel")),
    ("rest", "'bent'", lambda s: cable(s, rest="bent")),
    ("rest_length", "0", lambda s: cable(s, rest_length=0)),
    ("rest_length(0.0)", "[1, 2]", lambda s: cable(s, rest_length=lambda t: (1, 2))),
    ("rest_length", "0", lambda s: cable(s, rest_length=lambda t: 0.0)),
    ("rest_length", "-1", lambda s: cable(s, rest_length=pl.Input("winch", initial=-1.0))),
    ("pretension", "-5", lambda s: cable(s, pretension=-5)),
    ("pretension", "5", lambda s: cable(s, pretension=5, rest_length=1)),
    ("closed", "1", lambda s: cable(s, TRIANGLE, closed=1)),
    ("points", "closed", lambda s: cable(s, closed=True)),
    ("closed", "True", lambda s: cable(s, s.arc, closed=True)),
    ("tension_only", "'yes'", lambda s: cable(s, tension_only="yes")),
    ("strain", "'log'", lambda s: cable(s, strain="log")),
    ("integration", "'gauss'", lambda s: cable(s, integration="gauss")),
    ("bending", "None", lambda s: cable(s, bending=None)),
    ("initial", "(2, 3)", lambda s: cable(s, initial=np.zeros((2, 3)))),
    ("velocity", "(1, 2)", lambda s: cable(s, velocity=(1, 2))),
    ("velocity", "(4, 3)", lambda s: cable(s, velocity=np.zeros((4, 3)))),
    ("velocity", "fast", lambda s: cable(s, velocity="fast")),
    ("velocity", "normal", lambda s: cable(s, s.arc, velocity=(0, 1, 0))),
    ("velocity(positions)", "(3,)", lambda s: cable(s, velocity=lambda x: x[0])),
    ("angular_velocity", "5", lambda s: cable(s, angular_velocity=5)),
    ("name", "'rope'", lambda s: cable(s, name="rope")),
    ("name", "''", lambda s: cable(s, name="")),
    ("name", "7", lambda s: cable(s, name=7)),
    # nets
    ("edges", "[]", lambda s: net(s, TRIANGLE, np.empty((0, 2)))),
    ("edges[1]", "[1, 3]", lambda s: net(s, TRIANGLE, [(0, 1), (1, 3)])),
    ("edges[0]", "[1, 1]", lambda s: net(s, TRIANGLE, [(1, 1)])),
    ("edges", "0.5", lambda s: net(s, TRIANGLE, [(0, 0.5)])),
    ("points[2]", "[0., 1., 0.]", lambda s: net(s, TRIANGLE, [(0, 1)])),
    ("elements", "0", lambda s: net(s, TRIANGLE, [(0, 1), (1, 2)], elements=0)),
    ("elements", "[1, 2, 3]", lambda s: net(s, TRIANGLE, [(0, 1), (1, 2)], elements=[1, 2, 3])),
    ("rest_lengths[1]", "-1", lambda s: net(s, TRIANGLE, [(0, 1), (1, 2)], rest_lengths=[1, -1])),
    ("pretension", "'5 N'", lambda s: net(s, TRIANGLE, [(0, 1), (1, 2)], pretension="5 N")),
    # masses and points
    ("mass", "0", lambda s: s.m.add_point_mass(0, at=(0, 0, 0))),
    ("at", "'here'", lambda s: s.m.add_point_mass(1, at="here")),
    ("at", "Cable", lambda s: s.m.add_point_mass(1, at=s.rope)),
    ("velocity", "(1, 0, 0)", lambda s: s.m.add_point_mass(1, at=s.rope.end, velocity=(1, 0, 0))),
    ("s", "1.5", lambda s: s.rope.at(1.5)),
    ("s", "-0.1", lambda s: s.rope.at(-0.1)),
    ("s", "nan", lambda s: s.rope.at(NAN)),
    ("i", "5", lambda s: s.rope.node(5)),
    ("i", "1.0", lambda s: s.rope.node(1.0)),
    ("i", "99", lambda s: s.net.node(99)),
    ("name", "'chain'", lambda s: s.m["chain"]),
    ("name", "3", lambda s: s.m[3]),
    # joints
    ("point", "(0, 0, 0)", lambda s: s.m.pin((0, 0, 0))),
    ("point", "Cable", lambda s: s.m.pin(s.rope)),
    ("point", "another model", lambda s: s.m.pin(s.stranger.end)),
    ("to", "another model", lambda s: s.m.pin(s.rope.end, s.stranger.end)),
    ("to", "4 m apart", lambda s: s.m.pin(s.rope.end, s.net.node(0))),
    ("to", "(0, 0, 0)", lambda s: s.m.pin(s.rope.end, (0, 0, 0))),
    ("to", "same point", lambda s: s.m.pin(s.rope.end, s.rope.end)),
    ("to", "'wall'", lambda s: s.m.pin(s.rope.end, "wall")),
    ("point", "point of a cable", lambda s: s.m.clamp(s.ball.center)),
    ("point", "(1, 0, 0)", lambda s: s.m.clamp((1, 0, 0))),
    # loads
    ("force", "(1, 2)", lambda s: s.m.add_force(s.rope.end, (1, 2))),
    ("force", "inf", lambda s: s.m.add_force(s.rope.end, (0, 0, INF))),
    ("force", "5", lambda s: s.m.add_force(s.rope.end, 5)),
    ("force(0.0)", "[1, 2]", lambda s: s.m.add_force(s.rope.end, lambda t: (1, 2))),
    ("force(0.0)", "nan", lambda s: s.m.add_force(s.rope.end, lambda t: (0, 0, NAN))),
    ("force", "failed", lambda s: s.m.add_force(s.rope.end, lambda t: 1 / 0)),
    ("force", "components", lambda s: s.m.add_force(s.rope.end, pl.Ramp(1))),
    ("follower", "0", lambda s: s.m.add_force(s.rope.end, (0, 0, 1), follower=0)),
    ("follower", "True", lambda s: s.m.add_force(s.ball, (0, 0, 1), follower=True)),
    ("point", "'tip'", lambda s: s.m.add_force("tip", (0, 0, 1))),
    ("force", "plane", lambda s: s.m.add_force(cable(s, s.arc).end, (0, 1, 0))),
    ("moment", "normal", lambda s: s.m.add_moment(cable(s, s.arc).end, (1, 0, 0))),
    ("moment", "'big'", lambda s: s.m.add_moment(s.rope.end, "big")),
    ("point", "point of a cable", lambda s: s.m.add_moment(s.ball.center, (1, 0, 0))),
    ("cable", "PointMass", lambda s: s.m.add_line_load(s.ball, (0, 0, 1))),
    ("cable", "'rope'", lambda s: s.m.add_line_load("rope", (0, 0, 1))),
    ("force_per_length", "None", lambda s: s.m.add_line_load(s.rope, None)),
    # tendons, moving forces, wind
    ("points", "Point", lambda s: tendon(s, s.rope.end)),
    ("points", "[(0, 0, 1)]", lambda s: tendon(s, [(0, 0, 1)])),
    ("points", "point of a body", lambda s: tendon(s, [(0, 0, 1), (0, 0, 2)])),
    ("points[1]", "'end'", lambda s: tendon(s, [s.rope.end, "end"])),
    ("points[1]", "point before", lambda s: tendon(s, [s.rope.end, s.rope.end])),
    ("points[0]", "another model", lambda s: tendon(s, [s.stranger.end, (0, 0, 2)])),
    ("length", "one of them", lambda s: tendon(s, tension=None)),
    ("length", "one of them", lambda s: tendon(s, length=1.0, stiffness=1.0)),
    ("tension", "-2", lambda s: tendon(s, tension=-2.0)),
    ("tension", "(1, 2)", lambda s: tendon(s, tension=(1, 2))),
    ("stiffness", "goes with length", lambda s: tendon(s, stiffness=5.0)),
    ("stiffness", "None", lambda s: tendon(s, tension=None, length=1.0)),
    ("length", "0", lambda s: tendon(s, tension=None, length=lambda t: 0.0, stiffness=1.0)),
    ("damping", "goes with length", lambda s: tendon(s, damping=1.0)),
    ("damping", "-1", lambda s: tendon(s, damping=-1.0)),
    ("friction", "nan", lambda s: tendon(s, friction=NAN)),
    ("slip_velocity", "0", lambda s: tendon(s, slip_velocity=0)),
    ("cable", "CableNet", lambda s: s.m.add_moving_force(s.net, (0, 0, 1), 0.5)),
    ("cable", "PointMass", lambda s: s.m.add_moving_force(s.ball, (0, 0, 1), 0.5)),
    ("force", "5", lambda s: s.m.add_moving_force(s.rope, 5, 0.5)),
    ("position", "(0, 1)", lambda s: s.m.add_moving_force(s.rope, (0, 0, 1), (0, 1))),
    ("position(0.0)", "[0, 1]", lambda s: s.m.add_moving_force(s.rope, (0, 0, 1), lambda t: (0, 1))),
    ("lift", "-1", lambda s: s.m.add_wind(s.sheet, (1, 0, 0), 1.2, 1.0, lift=-1)),
    ("lift", "function", lambda s: s.m.add_wind(s.film, (1, 0, 0), 1.2, 1.0, lift=lambda a: a)),
    ("density", "0", lambda s: s.m.add_wind(s.sheet, (1, 0, 0), 0, 1.0)),
    ("faces", "brick", lambda s: s.m.add_chamber(s.brick)),
    ("faces", "[]", lambda s: s.m.add_chamber([])),
    ("faces", "'sheet'", lambda s: s.m.add_chamber("sheet")),
    ("gas", "'air'", lambda s: s.m.add_chamber(s.film, gas="air")),
    ("pressure", "0", lambda s: pl.Gas(pressure=0)),
    ("exponent", "-1", lambda s: pl.Gas(exponent=-1)),
    ("temperature", "nan", lambda s: pl.Gas(temperature=NAN)),
    ("inflow", "(1, 2)", lambda s: s.m.add_chamber(s.film, inflow=(1, 2))),
    ("ambient", "-1", lambda s: s.m.add_chamber(s.film, ambient=-1)),
    ("chamber", "rope", lambda s: pl.Stepper(s.m, step=1e-3).chamber(s.rope)),
    ("body", "film", lambda s: s.m.add_curvature(s.film, 1.0)),
    ("body", "rope", lambda s: s.m.add_curvature(s.rope, 1.0)),
    ("curvature", "(1, 2)", lambda s: s.m.add_curvature(s.sheet, (1, 2))),
    ("curvature", "nan", lambda s: s.m.add_curvature(s.sheet, NAN)),
    ("body", "shells and membranes", lambda s: s.m.add_wind(s.brick, (1, 0, 0), 1.2, 1.0)),
    ("body", "'rope'", lambda s: s.m.add_wind("rope", (1, 0, 0), 1.2, 1.0)),
    ("velocity", "5", lambda s: s.m.add_wind(s.rope, 5, 1.2, 1.0)),
    ("density", "0", lambda s: s.m.add_wind(s.rope, (1, 0, 0), 0, 1.0)),
    ("drag", "-1", lambda s: s.m.add_wind(s.rope, (1, 0, 0), 1.2, -1)),
    ("lift", "'up'", lambda s: s.m.add_wind(s.rope, (1, 0, 0), 1.2, 1.0, lift="up")),
    ("lift(-3.14159)", "nan", lambda s: s.m.add_wind(s.rope, (1, 0, 0), 1.2, 1.0, lift=lambda a: NAN)),
    # runs
    ("model", "3", lambda s: pl.simulate(3, duration=1.0, step=0.1)),
    ("model", "no bodies", lambda s: pl.simulate(pl.Model(), duration=1.0, step=0.1)),
    ("step", "'fast'", lambda s: run(s, step="fast")),
    ("rtol", "0.001", lambda s: run(s, rtol=1e-3)),
    ("rtol", "0", lambda s: run(s, step="auto", rtol=0)),
    ("rtol", "1e-15", lambda s: run(s, step="auto", rtol=1e-15)),
    ("rtol", "2", lambda s: run(s, step="auto", rtol=2)),
    ("atol", "-1", lambda s: run(s, step="auto", atol=-1)),
    ("atol", "nan", lambda s: run(s, step="auto", atol=NAN)),
    ("max_step", "0", lambda s: run(s, step="auto", max_step=0)),
    ("max_step", "1", lambda s: run(s, max_step=1)),
    ("until", "-1", lambda s: pl.Stepper(s.m, step="auto").advance(until=-1)),
    ("steps", "5", lambda s: pl.Stepper(s.m, step="auto").advance(5, until=1)),
    # rigid bodies
    ("size", "(1, 1)", lambda s: pl.Box(size=(1, 1))),
    ("size[1]", "0", lambda s: pl.Box(size=(1, 0, 1))),
    ("radius", "-2", lambda s: pl.Sphere(radius=-2)),
    ("length", "nan", lambda s: pl.Cylinder(radius=1, length=NAN)),
    ("length", "0", lambda s: pl.Capsule(radius=1, length=0)),
    ("mass", "None", lambda s: s.m.add_rigid_body()),
    ("mass", "-1", lambda s: rigid(s, mass=-1)),
    ("mass", "True", lambda s: rigid(s, mass=True)),
    ("density", "7850", lambda s: rigid(s, density=7850)),
    ("density", "0", lambda s: s.m.add_rigid_body(density=0, shape=pl.Sphere(1))),
    ("density", "1000", lambda s: s.m.add_rigid_body(density=1000)),
    ("inertia", "None", lambda s: s.m.add_rigid_body(mass=1)),
    ("inertia", "3", lambda s: rigid(s, inertia=(1, 1, 3))),
    ("inertia", "-1", lambda s: rigid(s, inertia=(-1, 1, 1))),
    ("inertia", "0", lambda s: rigid(s, inertia=(0, 0, 0))),
    ("inertia", "(1, 1)", lambda s: rigid(s, inertia=(1, 1))),
    ("inertia", "'round'", lambda s: rigid(s, inertia="round")),
    ("inertia", "0.5", lambda s: rigid(s, inertia=[[1, 0.5, 0], [0, 1, 0], [0, 0, 1]])),
    ("position", "inf", lambda s: rigid(s, position=(INF, 0, 0))),
    ("orientation", "(1, 0, 0)", lambda s: rigid(s, orientation=(1, 0, 0))),
    ("velocity", "'fast'", lambda s: rigid(s, velocity="fast")),
    ("angular_velocity", "1.0", lambda s: rigid(s, angular_velocity=1.0)),
    ("shape", "Circle", lambda s: rigid(s, shape=pl.Circle(1.0))),
    ("name", "brick", lambda s: rigid(s, name="brick")),
    ("local_point", "(1, 0)", lambda s: s.brick.at((1, 0))),
    # joints
    ("b", "1 m apart", lambda s: s.m.weld(s.rope.end, s.brick.center)),
    ("b", "rope", lambda s: s.m.weld(s.rope.end, s.rope)),
    ("a", "PointMass", lambda s: s.m.weld(s.ball)),
    ("a", "another model", lambda s: s.m.weld(s.stranger.start)),
    ("a", "(0, 0, 0)", lambda s: s.m.hinge((0, 0, 0))),
    ("a", "brick", lambda s: s.m.hinge(s.brick)),
    ("axis", "(0, 0, 0)", lambda s: s.m.hinge(s.brick.center, axis=(0, 0, 0))),
    ("path", "rope", lambda s: s.m.slide_along(s.ball, "rope")),
    ("path", "must be on it at the start", lambda s: s.m.slide_along(s.ball, s.rope)),
    ("path", "must be on it at the start", lambda s: s.m.slide_along(s.ball, pl.Line((0, 1, 0), (1, 0, 0)))),
    ("path", "CableNet", lambda s: s.m.slide_along(s.ball, s.net)),
    ("point", "path itself", lambda s: s.m.slide_along(s.rope.end, s.rope)),
    ("direction", "(0, 0, 0)", lambda s: s.m.slide_along(s.ball, pl.Line((0, 0, 5), (0, 0, 0)))),
    ("path", "rigid body or of the world", lambda s: s.m.slide_along(s.ball, pl.Line(s.rope.end, (1, 0, 0)))),
    # release and engage
    ("at", "-1", lambda s: pinned(s).release(at=-1.0)),
    ("at", "nan", lambda s: pinned(s).engage(at=NAN)),
    ("at", "'soon'", lambda s: pinned(s).engage(at="soon")),
    ("at", "released at that time", lambda s: pinned(s).release(at=1.0).engage(at=1.0)),
    ("gap", "-0.1", lambda s: pinned(s).engage(at=1.0, gap=-0.1)),
    ("gap", "True", lambda s: pinned(s).engage(at=1.0, gap=True)),
    ("engaged", "None", lambda s: s.m.pin(s.rope.end, engaged=None)),
    ("to", "engaged=False", lambda s: s.m.pin(s.rope.end, s.net.node(0))),
    ("joint", "take the handle of a model", lambda s: pl.Joint("pin1", "").release(at=1.0)),
    ("joint", "'pin1'", lambda s: stepper(s).release("pin1")),
    ("gap", "-1", lambda s: stepper(s).engage(pinned(s), gap=-1)),
    ("joint", "along it ('motor')", lambda s: released_along(s, torque=1.0)),
    ("joint", "along it ('motor')", lambda s: released_along(s, rate=1.0)),
    ("joint", "cannot be released", lambda s: s.m.copy().drive(s.axle, torque=1.0).release(at=1.0)),
    ("axis", "'z'", lambda s: s.m.hinge(s.brick.center, axis="z")),
    ("axis", "tangent", lambda s: s.m.hinge(s.rope.end, axis=(1, 1, 0))),
    ("stiffness", "-1", lambda s: s.m.hinge(s.brick.center, stiffness=-1.0)),
    ("damping", "nan", lambda s: s.m.hinge(s.brick.center, damping=NAN)),
    ("rest", "'a'", lambda s: s.m.slider(s.brick.center, rest="a")),
    ("limits", "(1, -1)", lambda s: s.m.hinge(s.brick.center, limits=(1, -1))),
    ("limits", "0.5", lambda s: s.m.slider(s.brick.center, limits=0.5)),
    ("limits", "(0.2, 0.5)", lambda s: s.m.slider(s.brick.center, limits=(0.2, 0.5))),
    ("b", "is the same point", lambda s: s.m.add_spring(s.ball, s.ball, 1.0)),
    ("stiffness", "-1", lambda s: s.m.add_spring(s.ball, (0, 0, 0), -1.0)),
    ("length", "inf", lambda s: s.m.add_spring(s.ball, (0, 0, 0), 1.0, length=INF)),
    ("target", "'x'", lambda s: s.m.drive("x", position=(0, 0, 0))),
    ("position", "one or both of", lambda s: s.m.drive(s.rope.end)),
    ("position", "shape (3,)", lambda s: s.m.drive(s.rope.end, position=(0, 0))),
    ("orientation", "Rotation", lambda s: s.m.drive(s.brick, orientation=(0, 0, 1))),
    ("direction", "one of position", lambda s: s.m.drive(s.ball.center, direction=(0, 0, 1))),
    ("angle", "one of position, rate", lambda s: s.m.drive(s.rail, angle=1.0)),
    ("angle and torque", "one of", lambda s: s.m.drive(s.axle, angle=1.0, torque=1.0)),
    ("angle", "smooth=True", lambda s: s.m.drive(s.axle, angle=pl.Table([0, 1], [0, 1]))),
    ("angle", "jumps", lambda s: s.m.drive(s.axle, angle=pl.Input("a"))),
    ("torque", "'much'", lambda s: s.m.drive(s.axle, torque="much")),
    ("target", "hinge or a slider", lambda s: s.m.drive(s.grip, rate=1.0)),
    ("axis", "must be given", lambda s: s.m.drive(s.brick, rate=1.0)),
    ("axis", "longer than zero", lambda s: s.m.drive(s.brick, axis=(0, 0, 0), rate=1.0)),
    ("joint_a", "hinge or a slider", lambda s: s.m.gear(s.grip, s.rail, 1.0)),
    ("ratio", "0", lambda s: s.m.gear(s.rail, s.axle, 0.0)),
    ("axis", "nan", lambda s: s.m.slider(s.brick, axis=(NAN, 0, 1))),
    ("axis", "tangent", lambda s: s.m.cylindrical(s.rope.end, axis=(0, 0, 1))),
    ("axis_b", "normal", lambda s: s.m.universal(s.brick.center, None, (1, 0, 0), (1, 0, 0))),
    ("axis_a", "tangent", lambda s: s.m.universal(s.rope.end, None, (0, 0, 1), (0, 1, 0))),
    ("b", "pin", lambda s: s.m.distance(s.brick, (2, 0, 0))),
    ("length", "3", lambda s: s.m.distance(s.brick, s.rope.end, length=3)),
    ("length", "-1", lambda s: s.m.distance(s.brick, s.rope.end, length=-1)),
    ("b", "(0, 1)", lambda s: s.m.distance(s.brick, (0, 1))),
    ("point", "PointMass", lambda s: s.m.clamp(s.ball)),
    ("duration", "0", lambda s: run(s, duration=0)),
    ("duration", "inf", lambda s: run(s, duration=INF)),
    ("step", "-0.1", lambda s: run(s, step=-0.1)),
    ("step", "1e-12", lambda s: run(s, step=1e-12)),
    ("spectral_radius", "1.5", lambda s: run(s, spectral_radius=1.5)),
    ("output_every", "0", lambda s: run(s, output_every=0)),
    ("tolerance", "0", lambda s: run(s, tolerance=0)),
    ("threads", "0", lambda s: run(s, threads=0)),
    ("threads", "True", lambda s: run(s, threads=True)),
    ("progress", "'bar'", lambda s: run(s, progress="bar")),
    ("start", "5", lambda s: run(s, start=5)),
    ("output", "3", lambda s: run(s, output=3)),
    ("output", "3", lambda s: stepper(s, output=3)),
    ("speed", "0", lambda s: run(s).animate("film.gif", speed=0)),
    ("fps", "-1", lambda s: run(s).animate("film.gif", fps=-1)),
    ("path", "film.avi", lambda s: run(s).animate("film.avi")),
    ("folder", "3", lambda s: run(s).export_vtk(3)),
    ("color", "'rainbow'", lambda s: run(s).export_html("page.html", color="rainbow")),
    ("output_times", "[0.5, 0.2]", lambda s: run(s, output_times=[0.5, 0.2])),
    ("output_times", "[0.5, 2.0]", lambda s: run(s, output_times=[0.5, 2.0])),
    ("output_times", "[-0.1]", lambda s: run(s, output_times=[-0.1])),
    ("output_times", "[]", lambda s: run(s, output_times=[])),
    ("output_times", "nan", lambda s: run(s, output_times=[0.1, NAN])),
    ("output_times", "'all'", lambda s: run(s, output_times="all")),
    ("output_every", "2", lambda s: run(s, output_times=[0.5], output_every=2)),
    ("on_step", "3", lambda s: run(s, on_step=3)),
    ("checkpoint", "3", lambda s: run(s, checkpoint=3)),
    ("checkpoint", "''", lambda s: run(s, checkpoint="")),
    ("checkpoint", "-1", lambda s: run(s, checkpoint=("file", -1))),
    ("checkpoint", "('file',)", lambda s: run(s, checkpoint=("file",))),
    # steppers
    ("model", "'rope'", lambda s: pl.Stepper("rope", step=0.1)),
    ("step", "0", lambda s: stepper(s, step=0)),
    ("step", "nan", lambda s: stepper(s, step=NAN)),
    ("record_every", "0", lambda s: stepper(s, record_every=0)),
    ("record_every", "1.5", lambda s: stepper(s, record_every=1.5)),
    ("spectral_radius", "-1", lambda s: stepper(s, spectral_radius=-1)),
    ("tolerance", "1", lambda s: stepper(s, tolerance=1)),
    ("threads", "0", lambda s: stepper(s, threads=0)),
    ("start", "3", lambda s: stepper(s, start=3)),
    ("steps", "0", lambda s: stepper(s).advance(0)),
    ("steps", "True", lambda s: stepper(s).advance(True)),
    ("steps", "2.0", lambda s: stepper(s).advance(2.0)),
    ("name", "'thrust'", lambda s: stepper(s).set_input("thrust", 1.0)),
    ("name", "None", lambda s: stepper(s).set_input(None, 1.0)),
    ("value", "nan", lambda s: stepper(s).set_input("jet", NAN)),
    ("value", "(1, 2, 3)", lambda s: stepper(s).set_input("jet", (1, 2, 3))),
    ("value", "True", lambda s: stepper(s).set_input("jet", True)),
    ("state", "'start'", lambda s: stepper(s).reset("start")),
    ("state", "stepper", lambda s: stepper(s).reset(stepper(s).result.state(0))),
    ("bodies", "ball", lambda s: stepper(s).reset(pl.Stepper(one_ball(), step=0.1).state)),
    ("point", "'end'", lambda s: stepper(s).position("end")),
    ("initial", "(1, 2)", lambda s: pl.Input("jet", initial=(1, 2))),
    ("initial", "inf", lambda s: pl.Input("jet", initial=INF)),
    ("name", "''", lambda s: pl.Input("")),
    ("jet", "same initial", lambda s: two_jets(s)),
    ("models", "pliant.Model", lambda s: pl.simulate_many([s.m, 3], duration=1.0, step=0.1)),
    ("models", "several", lambda s: pl.simulate_many(s.m, duration=1.0, step=0.1)),
    ("duration", "None", lambda s: pl.simulate_many([s.m], step=0.1)),
    ("checkpoint", "'a'", lambda s: pl.simulate_many([s.m], duration=1.0, step=0.1, checkpoint="a")),
    ("scale", "'wind'", lambda s: pl.solve_static(s.m, scale="wind")),
    ("scale", "3", lambda s: pl.solve_static(s.m, scale=3)),
    ("scale", "None", lambda s: pl.solve_static(s.m, scale=[None])),
    ("arc_length", "1", lambda s: pl.solve_static(s.m, arc_length=1)),
    ("load_steps", "0", lambda s: pl.solve_static(s.m, load_steps=0)),
    ("count", "0", lambda s: pl.solve_modes(s.m, count=0)),
    ("about", "7", lambda s: pl.solve_modes(s.m, about=7)),
    # Soft bodies
    ("length", "0", lambda s: strip(length=0)),
    ("notch_height", "0.02", lambda s: strip(notch_height=0.02)),
    ("center", "0.005", lambda s: strip(center=0.005)),
    ("youngs_modulus", "'soft'", lambda s: strip(youngs_modulus="soft")),
    ("poisson_ratio", "0.5", lambda s: strip(poisson_ratio=0.5)),
    ("semi_axes", "(0.01, 0)", lambda s: pl.sdi.elliptic_notch(0.1, 0.01, 0.01, (0.01, 0), 0.004, 1e6)),
    ("notches[1]", "before has not ended", lambda s: two_cuts([(0.03, 0.03, 0.005), (0.05, 0.03, 0.005)])),
    ("notches", "(center, length, height left)", lambda s: two_cuts([(0.03, 0.02)])),
    ("bump_height", "0.005", lambda s: pl.sdi.bump(0.1, 0.01, 0.01, 0.02, 0.005, 1e6)),
    ("end_diameter", "0", lambda s: pl.sdi.cone(0.2, 0.03, 0, 1e6)),
    ("diameters", "give one", lambda s: pl.sdi.stepped((0.1,), None, 1e6)),
    ("lengths", "(0.1, 0)", lambda s: pl.sdi.stepped((0.1, 0), (0.01, 0.01), 1e6)),
    ("layers[0]", "0.004", lambda s: pl.sdi.layered(0.1, 0.01, [0.004])),
    ("stiffness", "0.001", lambda s: pl.sdi.Body(0.1, stiffness=1e-3)),
    ("stiffness(0.07", "above 0", lambda s: pl.sdi.Body(0.1, lambda x: 1e-3 * (0.07 - x))),
    ("stiffness(0.05", "nan", lambda s: pl.sdi.Body(0.1, lambda x: 1e-3 + 0 * np.where(x < 0.05, 0, NAN))),
    ("stiffness", "one number", lambda s: pl.sdi.Body(0.1, lambda x: "soft")),
    ("height, youngs_modulus", "both", lambda s: pl.sdi.Body(0.1, lambda x: 1e-3, height=0.01)),
    ("breakpoints[0]", "0.2", lambda s: pl.sdi.Body(0.1, lambda x: 1e-3, breakpoints=[0.2])),
    ("notches[0]", "(0.06, 0.04)", lambda s: pl.sdi.Body(0.1, lambda x: 1e-3, notches=[(0.06, 0.04)])),
    ("x", "at least 9", lambda s: samples(np.linspace(0, 0.1, 8))),
    ("x[4]", "sort the samples", lambda s: samples([0, 1, 2, 4, 3, 5, 6, 7, 8, 9])),
    ("k[3]", "above 0", lambda s: samples(range(12), [1, 1, 1, -1, 1, 1, 1, 1, 1, 1, 1, 1])),
    ("k[2]", "nan", lambda s: samples(range(12), [1, 1, NAN, 1, 1, 1, 1, 1, 1, 1, 1, 1])),
    ("k", "(12,)", lambda s: samples(range(12), [1, 1, 1])),
    ("smooth", "40", lambda s: samples(range(60), smooth=40)),
    ("smooth", "101", lambda s: samples(range(60), smooth=101)),
    ("falls to", "between", lambda s: samples(range(10), [1, 1, 1, 1, 0.01, 0.01, 1, 1, 1, 1])),
    ("body", "0.1", lambda s: pl.sdi.bend(0.1, moment=1)),
    ("technique", "'fem'", lambda s: pl.sdi.bend(strip(), moment=1e-3, technique="fem")),
    ("moment, force", "one of them", lambda s: pl.sdi.bend(strip())),
    ("moment", "nan", lambda s: pl.sdi.bend(strip(), moment=NAN)),
    ("force", "(1, 2, 3)", lambda s: pl.sdi.bend(strip(), force=(1, 2, 3))),
    ("elements", "coefficient", lambda s: pl.sdi.bend(strip(), moment=1, technique="lumped", elements=3)),
    ("coefficient", "2", lambda s: pl.sdi.bend(strip(), moment=1, technique="lumped", coefficient=2)),
    ("variant", "'best'", lambda s: pl.sdi.bend(strip(), moment=1, technique="matrix", variant="best")),
    ("nodes", "ascend", lambda s: pl.sdi.bend(strip(), moment=1, technique="matrix", nodes=(0, 0.05))),
    ("elements", "0", lambda s: pl.sdi.bend(strip(), moment=1, technique="ancf", elements=0)),
    ("dimension", "4", lambda s: pl.sdi.bend(strip(), moment=1, technique="finite_element", dimension=4)),
    ("dimension", "round", lambda s: pl.sdi.bend(arm(), moment=1, technique="finite_element")),
    ("body", "no notch", lambda s: pl.sdi.bend(arm(), moment=1, technique="lumped")),
    ("shear", "cross sections", lambda s: pl.sdi.bend(bare(), moment=1, shear=True)),
    ("body", "youngs_modulus=", lambda s: pl.sdi.bend(bare(), moment=1, technique="finite_element")),
    ("body", "mass", lambda s: bare().add_to(s.m)),
    ("technique", "'rod'", lambda s: strip().add_to(s.m, technique="rod")),
    ("model", "'m'", lambda s: strip().add_to("m")),
    ("up", "along direction", lambda s: strip().add_to(s.m, direction=(0, 0, 1))),
    ("density", "0", lambda s: strip().add_to(s.m, density=0)),
    ("tolerance", "0", lambda s: pl.sdi.recommend(strip(), moment=1e-3, tolerance=0)),
    ("techniques", "'fem'", lambda s: pl.sdi.recommend(strip(), moment=1e-3, techniques=("fem",))),
    ("moment, force", "does not move", lambda s: pl.sdi.recommend(strip(), moment=0)),
    ("bodies", "empty", lambda s: pl.sdi.error_map([])),
    ("target", "away", lambda s: pl.sdi.design.link((0.2, 0), moment=1e-4)),
    (
        "diameters",
        "(0.01, 0.01)",
        lambda s: pl.sdi.design.link((0.07, 0.05), moment=1, diameters=(0.01, 0.01)),
    ),
    ("start", "'width'", lambda s: pl.sdi.design.link((0.07, 0.05), moment=1e-4, start={"width": 1.0})),
    ("depths", "(0.9, 0.2)", lambda s: pl.sdi.design.notch(0.03, moment=1e-3, depths=(0.9, 0.2))),
]


@pytest.mark.parametrize(
    ("argument", "value", "call"), CATALOGUE, ids=[f"{k}-{entry[0]}" for k, entry in enumerate(CATALOGUE)]
)
def test_bad_call(argument: str, value: str, call: Callable[[SimpleNamespace], Any]) -> None:
    s = scenery()
    with pytest.raises(pl.ModelError) as caught:
        call(s)
    assert argument in str(caught.value)
    assert value in str(caught.value)


def test_the_catalogue_is_long_enough() -> None:
    assert len(CATALOGUE) >= 150


def test_a_bad_call_leaves_the_model_as_it_was() -> None:
    s = scenery()
    before = s.m.to_document()
    for _, _, call in CATALOGUE:
        if call.__code__.co_names and "arc" not in call.__code__.co_names:
            with pytest.raises(pl.ModelError):
                call(s)
    assert s.m.to_document() == before


@pytest.mark.parametrize(
    "text",
    [
        "",
        "[]",
        "{}",
        '{"format": "pliant-model", "version": 99}',
        '{"format": "pliant-model", "version": 1}',
        "\0",
    ],
)
def test_damaged_model_files(tmp_path: Path, text: str) -> None:
    path = tmp_path / "model.json"
    path.write_text(text)
    with pytest.raises(pl.FileError, match=r"model\.json"):
        pl.Model.load(path)


def test_missing_model_file(tmp_path: Path) -> None:
    with pytest.raises(pl.FileError, match=r"none\.json"):
        pl.Model.load(tmp_path / "none.json")
    with pytest.raises(pl.FileError, match="nowhere"):
        pl.Model().save(tmp_path / "nowhere" / "model.json")


def _leaves(node: Any, path: tuple[Any, ...] = ()) -> list[tuple[Any, ...]]:
    if isinstance(node, dict):
        return [leaf for key, item in node.items() for leaf in _leaves(item, (*path, key))]
    if isinstance(node, list) and node and not isinstance(node[0], (int, float)):
        return [leaf for key, item in enumerate(node) for leaf in _leaves(item, (*path, key))]
    return [path]


@settings(deadline=None, max_examples=200)
@given(data=st.data())
def test_altered_model_documents_are_refused_or_valid(data: st.DataObject) -> None:
    s = scenery()
    s.m.pin(s.rope.start)
    s.m.hinge(s.brick.at((0.1, 0, 0)), axis=(0, 1, 0))
    s.m.add_force(s.rope.end, (0, 0, 1) * pl.Ramp(1))
    document = json.loads(json.dumps(s.m.to_document()))
    path = data.draw(st.sampled_from(_leaves(document)))
    value = data.draw(st.sampled_from([None, -1, 1e300, "x", [], {}, [[1]], True, {"type": "Point"}, 10**9]))
    node = document
    for key in path[:-1]:
        node = node[key]
    node[path[-1]] = value
    with contextlib.suppress(pl.FileError):
        assert str(pl.Model.from_document(document))


def test_a_film_stiffer_slack_than_taut_is_refused_in_documents() -> None:
    document = scenery().m.to_document()
    film = next(body for body in document["bodies"] if "residual_stiffness" in body)
    film["residual_stiffness"] = 1.5
    with pytest.raises(pl.FileError, match="residual_stiffness"):
        pl.Model.from_document(document)


ANYTHING = st.one_of(
    st.none(),
    st.booleans(),
    st.text(max_size=5),
    st.floats(),
    st.integers(),
    st.complex_numbers(),
    st.lists(st.floats()),
)


@settings(deadline=None)
@given(value=ANYTHING)
def test_constructors_take_positive_numbers_only(value: Any) -> None:
    good = isinstance(value, (int, float)) and not isinstance(value, bool) and 0 < value < math.inf
    for build in (pl.Circle, pl.Ramp, lambda x: pl.Rectangle(x, 1.0), lambda x: elastic(youngs_modulus=x)):
        if good:
            try:
                build(value)
            except pl.ModelError:
                assert value > 1e300
        else:
            with pytest.raises(pl.ModelError):
                build(value)


@settings(deadline=None)
@given(value=st.one_of(ANYTHING, st.lists(st.lists(st.floats(), max_size=4), max_size=4)))
def test_points_are_checked(value: Any) -> None:
    s = scenery()
    try:
        s.m.add_cable(value, **s.k)
    except pl.ModelError:
        return
    assert np.asarray(value).shape[1] == 3
    assert np.isfinite(np.asarray(value)).all()
