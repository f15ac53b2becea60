"""Thin shells at rest: large bending at few load increments."""

from __future__ import annotations

import numpy as np
import pliant as pl
import pytest


def strip(length: float, elements: int, **options: object) -> tuple[pl.Model, pl.Shell]:
    """A clamped strip of width 1 and thickness 0.1, without Poisson's effect."""
    material = pl.SaintVenantKirchhoff(youngs_modulus=1.2e6, poisson_ratio=0.0, density=1.0)
    model = pl.Model()
    mesh = pl.Mesh.rectangle(length, 1.0, divisions=(elements, 1))
    shell = model.add_shell(mesh, thickness=0.1, material=material, **options)  # type: ignore[arg-type]
    model.clamp(shell.edge("u_min"))
    return model, shell


def test_whole_load_at_once(record):
    tips = []
    for load_steps in (1, 5):
        model, shell = strip(10.0, 8)
        model.add_line_load(shell.edge("u_max"), (0, 0, 4.0))
        result = pl.solve_static(model, load_steps=load_steps)
        # No increment was cut: two thirds of the length sideways are one step.
        np.testing.assert_allclose(result.load_factor, np.arange(1, load_steps + 1) / load_steps)
        tips.append(result.track(shell.at((10, 0.5, 0))).position[-1])
    # Both at the rounding of a stiffness 1e8 times that of bending the strip.
    gap = float(np.abs(tips[0] - tips[1]).max())
    assert record(
        "end shear at once and in five steps", gap, 0.0, 1e-8, unit="m", source="the same equations"
    )


def test_a_strip_rolls_up_in_four_steps(record):
    model, shell = strip(12.0, 16)
    model.add_edge_moment(shell.edge("u_max"), 50 * np.pi / 3)
    # The roll is unstable against sideways motion in the end; the plane path is wanted.
    with pytest.warns(UserWarning, match="unstable"):
        result = pl.solve_static(model, load_steps=4, stable=False)
    assert len(result.load_factor) == 4
    tip = result.track(shell.at((12, 0.5, 0))).position[-1]
    # A full circle; the prototype with this mesh closes it to 4e-3.
    assert record("roll-up in four steps, -u", float(12 - tip[0]), 12.0, 6e-3, source="closed form")
    assert record("roll-up in four steps, w", float(tip[2]), 0.0, 1e-3, source="closed form")


@pytest.mark.parametrize("end", ["u_min", "u_max"])
def test_the_axis_of_a_moment_runs_as_its_edge_does(end, record):
    """Two couples that cancel bend what lies between them, whichever way the sides of the faces run."""
    length, width, thickness, moment = 0.12, 0.04, 8e-3, 0.2
    rubber = pl.SaintVenantKirchhoff(youngs_modulus=3e5, poisson_ratio=0.0, density=1000.0)
    model = pl.Model()
    mesh = pl.Mesh.rectangle(length, width, divisions=(12, 2))
    shell = model.add_shell(mesh, thickness=thickness, material=rubber)
    held, free, sign = ("u_max", 0.0, -1.0) if end == "u_min" else ("u_min", length, 1.0)
    clamp = model.clamp(shell.edge(held))
    for x, size in ((free, sign), (length / 2, -sign)):
        line = [(x, y, 0.0) for y in (0.0, width / 2, width)]
        model.add_edge_moment(shell.edge(line), size * moment)
    result = pl.solve_static(model, load_steps=4)
    curvature = moment * 12 / (3e5 * thickness**3)
    tip = result.track(shell.at((free, 0.0, 0.0))).position[-1]
    deep = (1 - np.cos(curvature * length / 2)) / curvature
    # Fourth order: six elements on an arc of 0.94 rad.
    assert record(f"couples on a strip held at {held}, depth of its end", -tip[2], deep, 1e-4, unit="m")
    # Nothing is left for the clamp.
    assert np.abs(result.reaction(clamp).moment[-1]).max() < 1e-6 * moment * width
