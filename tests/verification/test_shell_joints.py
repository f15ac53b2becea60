"""Shells on rigid bodies and cables: edges and nodes pinned, welded and hinged."""

from __future__ import annotations

import numpy as np
import pliant as pl

SHEET = pl.SaintVenantKirchhoff(youngs_modulus=1e7, poisson_ratio=0.3, density=1000.0)


def test_a_pinned_edge_turns_about_itself(record):
    """An edge pinned to a body is a hinge along it: the strip falls as a pendulum."""
    model = pl.Model(gravity=(0, 0, -9.81))
    stiff = pl.SaintVenantKirchhoff(youngs_modulus=1e12, poisson_ratio=0.0, density=1000.0)
    sheet = model.add_shell(pl.Mesh.rectangle(1.0, 0.2, divisions=(2, 1)), thickness=0.01, material=stiff)
    block = model.add_rigid_body(mass=2.0, shape=pl.Box((0.2, 0.2, 0.1)), position=(-0.1, 0.1, 0))
    model.weld(block)
    model.pin(sheet.edge("u_min"), block)
    result = pl.simulate(model, duration=0.3, step=2e-3)
    from scipy.integrate import solve_ivp

    exact = solve_ivp(lambda t, y: (y[1], 14.715 * np.cos(y[0])), (0, 0.3), (0, 0), rtol=1e-10).y[0, -1]
    tip = result.track(sheet.at((1, 0.1, 0))).position[-1]
    found = float(np.arctan2(-tip[2], tip[0]))
    # Second order in the step.
    assert record("strip falling about a pinned edge", found, exact, 2e-4, unit="rad", source="pendulum")


def test_cables_carry_a_sheet(record):
    """A stiff sheet hangs level from four cables pinned at its corners: each carries a quarter."""
    model = pl.Model(gravity=(0, 0, -9.81))
    stiff = pl.SaintVenantKirchhoff(youngs_modulus=1e11, poisson_ratio=0.3, density=1000.0)
    sheet = model.add_shell(pl.Mesh.rectangle(1.0, 0.5, divisions=(2, 2)), thickness=0.02, material=stiff)
    steel = pl.LinearElastic(youngs_modulus=2e11, poisson_ratio=0.3, density=7850.0)
    pins = []
    for x, y in ((0, 0), (1, 0), (1, 0.5), (0, 0.5)):
        line = [(x, y, 1.0), (x, y, 0.0)]
        cable = model.add_cable(line, elements=2, section=pl.Circle(radius=1e-3), material=steel)
        model.pin(cable.start)
        pins.append(model.pin(sheet.at((x, y, 0)), cable.end))
    result = pl.solve_static(model, load_steps=4)
    share = 1.0 * 0.5 * 0.02 * 1000 * 9.81 / 4
    for number, pin in enumerate(pins):
        found = float(result.reaction(pin).force[-1, 2])
        name = f"sheet on four cables, force of cable {number}"
        assert record(name, found, share, 1e-5 * share, unit="N", source="statics")


def test_hinge_and_weld_of_a_node(record):
    """At one node: a weld holds the tangent plane, a hinge lets it turn about an axis in it."""
    for joint in ("weld", "hinge"):
        model = pl.Model()
        sheet = model.add_shell(pl.Mesh.rectangle(1.0, 1.0, divisions=(2, 2)), thickness=0.02, material=SHEET)
        block = model.add_rigid_body(mass=1.0, shape=pl.Sphere(0.1), position=(0.5, 0.5, 0))
        model.weld(block)
        middle = sheet.at((0.5, 0.5, 0))
        if joint == "weld":
            model.weld(middle, block)
        else:
            model.hinge(middle, block, axis=(1, 0, 0), stiffness=0.5)
        lowest = pl.solve_modes(model, 1).frequencies[0]
        if joint == "hinge":
            # The sheet rocks about x on the spring: omega^2 = k/(m b^2/12), the sheet being far stiffer.
            exact = np.sqrt(0.5 / (20.0 / 12)) / (2 * np.pi)
            assert record(
                "sheet on a sprung hinge", lowest, exact, 0.02 * exact, unit="Hz", source="closed form"
            )
        else:
            assert lowest > 0.5
