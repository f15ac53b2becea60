"""Popular benchmark problems of thin shells: models, and the published tables.

K. Y. Sze, X. H. Liu, S. H. Lo, "Popular benchmark problems for geometric nonlinear analysis of shells",
Finite Elements in Analysis and Design 40 (2004) 1551-1569. The tables are in ``sze_tables.csv``.
"""

from __future__ import annotations

import csv
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pliant as pl

TABLES = Path(__file__).with_name("sze_tables.csv")

Reading = tuple[str, pl.Point, int, float]  # label, point, axis, sign
Built = tuple[pl.Model, list[Reading]]


@dataclass(frozen=True)
class Problem:
    """A benchmark: how it is built from a number of elements, and how its path is followed."""

    title: str
    build: Callable[[int], Built]
    elements: int
    load_steps: int = 20
    arc_length: bool = False


@dataclass(frozen=True)
class Curve:
    """Deflections over the load."""

    load: np.ndarray
    deflections: dict[str, np.ndarray]
    result: pl.Result

    def at(self, load: np.ndarray, number: int) -> np.ndarray:
        """Deflection of that number at loads, where these grow along the path."""
        values = list(self.deflections.values())[number]
        return np.interp(load, self.load, values)

    def distance(self, load: np.ndarray, deflection: np.ndarray, scale: float) -> np.ndarray:
        """Distance of points to the path in the plane of load and deflection / scale."""
        path = np.column_stack([self.load, next(iter(self.deflections.values())) / scale])
        points = np.column_stack([load, deflection / scale])
        start, step = path[:-1], np.diff(path, axis=0)
        found = np.empty(len(points))
        for k, point in enumerate(points):
            along = ((point - start) * step).sum(1) / np.maximum((step * step).sum(1), 1e-300)
            nearest = start + np.clip(along, 0, 1)[:, None] * step
            found[k] = np.linalg.norm(nearest - point, axis=1).min()
        return found


def table(name: str) -> np.ndarray:
    """Rows of the published table: load, deflections."""
    with TABLES.open() as file:
        rows = csv.DictReader(line for line in file if not line.startswith("#"))
        columns = ("load", "first", "second", "third")
        found = [[float(row[c]) for c in columns if row[c]] for row in rows if row["problem"] == name]
    return np.array(found)


def solve(
    name: str, elements: int | None = None, build: Callable[[int], Built] | None = None, **options: object
) -> Curve:
    """Follow the path of a problem to its full load, as it stands or built otherwise."""
    problem = PROBLEMS[name]
    model, readings = (build or problem.build)(elements or problem.elements)
    given = {"load_steps": problem.load_steps, "arc_length": problem.arc_length, "stable": False, **options}
    result = pl.solve_static(model, **given)  # type: ignore[arg-type]
    start = np.append(0.0, result.load_factor) if result.load_factor[0] > 0 else result.load_factor
    deflections = {}
    for label, point, axis, sign in readings:
        moved = sign * (result.track(point).position[:, axis] - model_place(model, point)[axis])
        deflections[label] = np.append(0.0, moved) if len(start) > len(moved) else moved
    return Curve(start, deflections, result)


def model_place(model: pl.Model, point: pl.Point) -> np.ndarray:
    """Place of a point at the start."""
    return model._bodies[point.body].place(point)


def material(youngs_modulus: float, poisson_ratio: float) -> pl.SaintVenantKirchhoff:
    """Density does not count."""
    return pl.SaintVenantKirchhoff(youngs_modulus=youngs_modulus, poisson_ratio=poisson_ratio, density=1.0)


def strip(length: float, elements: int) -> tuple[pl.Model, pl.Shell]:
    """A clamped strip of width 1 and thickness 0.1, without Poisson's effect."""
    model = pl.Model()
    mesh = pl.Mesh.rectangle(length, 1.0, divisions=(elements, 1))
    shell = model.add_shell(mesh, thickness=0.1, material=material(1.2e6, 0.0))
    model.clamp(shell.edge("u_min"))
    return model, shell


def end_shear(n: int) -> Built:
    """3.1: a cantilever under a shear force at its end."""
    model, shell = strip(10.0, n)
    model.add_line_load(shell.edge("u_max"), (0, 0, 4.0))
    tip = shell.at((10, 0.5, 0))
    return model, [("-u of the tip", tip, 0, -1), ("w of the tip", tip, 2, 1)]


def end_moment(n: int) -> Built:
    """3.2: a cantilever rolled up by a moment at its end."""
    model, shell = strip(12.0, n)
    # About the edge, which runs along y: down.
    model.add_edge_moment(shell.edge("u_max"), 50 * np.pi / 3)
    tip = shell.at((12, 0.5, 0))
    return model, [("-u of the tip", tip, 0, -1), ("-w of the tip", tip, 2, -1)]


def slit_annulus(n: int) -> Built:
    """3.3: an annular plate slit on one side, one lip clamped and the other lifted; n elements around."""
    model = pl.Model()

    def ring(u: float, v: float) -> tuple[float, float, float]:
        return v * np.cos(u), v * np.sin(u), 0.0

    mesh = pl.Mesh.surface(ring, (0, 2 * np.pi), (6, 10), divisions=(n, max(2, n // 12)))
    plate = model.add_shell(mesh, thickness=0.03, material=material(21e6, 0.0), quadrature="full")
    model.clamp(plate.edge("u_max"))
    model.add_line_load(plate.edge("u_min"), (0, 0, 0.8))
    # Both lips lie at one place: the free one has the first nodes.
    inner, outer = plate.node(0), plate.node(max(2, n // 12))
    return model, [("w inside", inner, 2, 1), ("w outside", outer, 2, 1)]


def hemisphere(n: int) -> Built:
    """3.4: a hemisphere with a hole of 18 degrees, pulled and pinched at four points; a quarter."""
    radius, model = 10.0, pl.Model()

    def dome(u: float, v: float) -> tuple[float, float, float]:
        return radius * np.cos(v) * np.cos(u), radius * np.cos(v) * np.sin(u), radius * np.sin(v)

    mesh = pl.Mesh.surface(dome, (0, np.pi / 2), (0, np.radians(72)), divisions=(n, n))
    shell = model.add_shell(mesh, thickness=0.04, material=material(6.825e7, 0.3), quadrature="reduced")
    model.symmetry(shell.edge("u_min"), (0, 1, 0))
    model.symmetry(shell.edge("u_max"), (1, 0, 0))
    out, into = shell.at((radius, 0, 0)), shell.at((0, radius, 0))
    model.pin(out, directions=(0, 0, 1))
    # Half of the force on the whole shell: the other half acts on the mirror image.
    model.add_force(out, (200, 0, 0))
    model.add_force(into, (0, -200, 0))
    return model, [("outward", out, 0, 1), ("inward", into, 1, -1)]


def octant(radius: float, half: float, n: int, m: int) -> pl.Mesh:
    """An eighth of a tube along y, from its crest down to its side."""

    def tube(u: float, v: float) -> tuple[float, float, float]:
        return radius * np.sin(u), v, radius * np.cos(u)

    return pl.Mesh.surface(tube, (0, np.pi / 2), (0, half), divisions=(n, m))


def pull_out(n: int) -> Built:
    """3.5: an open tube pulled apart at two points; an eighth."""
    radius, length, model = 4.953, 10.35, pl.Model()
    mesh = octant(radius, length / 2, n, max(2, 3 * n // 4))
    shell = model.add_shell(mesh, thickness=0.094, material=material(10.5e6, 0.3125))
    model.symmetry(shell.edge("u_min"), (1, 0, 0))
    model.symmetry(shell.edge("u_max"), (0, 0, 1))
    model.symmetry(shell.edge("v_min"), (0, 1, 0))
    top = shell.at((0, 0, radius))
    model.add_force(top, (0, 0, 10000.0))
    side, end = shell.at((radius, 0, 0)), shell.at((radius, length / 2, 0))
    return model, [("w at A", top, 2, 1), ("-u at B", side, 0, -1), ("-u at C", end, 0, -1)]


def pinched(n: int, **element: str) -> Built:
    """3.6: a tube with rigid diaphragms at its ends, pinched in the middle; an eighth."""
    radius, length, model = 100.0, 200.0, pl.Model()
    shell = model.add_shell(
        octant(radius, length / 2, n, n),
        thickness=1.0,
        material=material(3e4, 0.3),
        **(element or {"quadrature": "reduced"}),
    )
    model.symmetry(shell.edge("u_min"), (1, 0, 0))
    model.symmetry(shell.edge("u_max"), (0, 0, 1))
    model.symmetry(shell.edge("v_min"), (0, 1, 0))
    model.pin(shell.edge("v_max"), directions=[(1, 0, 0), (0, 0, 1)])
    top, side = shell.at((0, 0, radius)), shell.at((radius, 0, 0))
    model.add_force(top, (0, 0, -3000.0))
    return model, [("-w at A", top, 2, -1), ("u at B", side, 0, 1)]


def semi_cylinder(n: int) -> Built:
    """3.7: half a tube, clamped at one end and pushed down at the crest of the other; a half."""
    radius, length, model = 1.016, 3.048, pl.Model()

    def half(u: float, v: float) -> tuple[float, float, float]:
        return radius * np.sin(u), v, radius * np.cos(u)

    mesh = pl.Mesh.surface(half, (0, np.pi / 2), (0, length), divisions=(n, n))
    shell = model.add_shell(mesh, thickness=0.03, material=material(2.0685e7, 0.3))
    model.symmetry(shell.edge("u_min"), (1, 0, 0))
    # The straight edges stay level and do not turn about themselves: a plane of symmetry.
    model.symmetry(shell.edge("u_max"), (0, 0, 1))
    model.clamp(shell.edge("v_max"))
    top = shell.at((0, 0, radius))
    model.add_force(top, (0, 0, -1000.0))
    return model, [("-w", top, 2, -1)]


def roof(thickness: float) -> Callable[[int], Built]:
    """3.8: a shallow roof on hinges along its straight edges, pushed down in the middle; a quarter."""

    def build(n: int) -> Built:
        radius, length, half, model = 2540.0, 508.0, 0.1, pl.Model()

        def crown(u: float, v: float) -> tuple[float, float, float]:
            return radius * np.sin(u), v, radius * np.cos(u)

        mesh = pl.Mesh.surface(crown, (0, half), (0, length / 2), divisions=(n, n))
        shell = model.add_shell(mesh, thickness=thickness, material=material(3102.75, 0.3))
        model.symmetry(shell.edge("u_min"), (1, 0, 0))
        model.symmetry(shell.edge("v_min"), (0, 1, 0))
        model.pin(shell.edge("u_max"))
        top = shell.at((0, 0, radius))
        model.add_force(top, (0, 0, -750.0))
        return model, [("-w", top, 2, -1)]

    return build


PROBLEMS = {
    "end_shear": Problem("3.1 cantilever, end shear", end_shear, 8),
    "end_moment": Problem("3.2 cantilever, end moment", end_moment, 16),
    "slit_annulus": Problem("3.3 slit annulus", slit_annulus, 36),
    "hemisphere": Problem("3.4 hemisphere", hemisphere, 12),
    "pull_out": Problem("3.5 pull-out of a tube", pull_out, 12, 40),
    "pinched": Problem("3.6 pinched tube", pinched, 24, 20, arc_length=True),
    "semi_cylinder": Problem("3.7 half tube", semi_cylinder, 12),
    "roof_12.7": Problem("3.8 hinged roof, 12.7", roof(12.7), 8, 20, arc_length=True),
    "roof_6.35": Problem("3.8 hinged roof, 6.35", roof(6.35), 8, 20, arc_length=True),
}
