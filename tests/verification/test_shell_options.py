"""Options of shell elements: quadrature, simplified bending, integrals computed in advance."""

from __future__ import annotations

import numpy as np
import pliant as pl
import pytest
from verification.test_shell_statics import strip

KINDS = ("bicubic", "cylindrical", "plate", "triangle")


@pytest.mark.parametrize("elements", [8, 16])
def test_simplified_bending_of_a_cantilever(record, elements):
    tips = {}
    for bending in ("exact", "simplified"):
        model, shell = strip(10.0, elements, bending=bending, quadrature="full")
        model.add_line_load(shell.edge("u_max"), (0, 0, 4.0))
        tip = pl.solve_static(model, load_steps=2).track(shell.at((10, 0.5, 0))).position[-1]
        tips[bending] = (10 - tip[0], tip[2])
    # The prototype of the same equations; its quadrature is not told: a tenth of the error of the mesh.
    expected = {8: (3.28603, 6.69447), 16: (3.28952, 6.69979)}[elements]
    for k, name in enumerate(("-u", "w")):
        title = f"end shear, {elements} elements, simplified bending, {name}"
        assert record(title, float(tips["simplified"][k]), expected[k], 3e-4, source="prototype")
        # What differs are gradients of the membrane strain, 1e-3 at most, and they change their sign.
        gap = float(tips["simplified"][k] - tips["exact"][k])
        assert record(f"{title}, less that of exact bending", gap, 0.0, 2e-4, source="exact bending")


@pytest.mark.parametrize("element", ["cylindrical", "plate"])
def test_precomputed_integrals_follow_quadrature(record, element):
    tips = {}
    for integrals, quadrature in (("precomputed", "standard"), ("quadrature", "full")):
        model, shell = strip(10.0, 8, element=element, integrals=integrals, quadrature=quadrature)
        model.add_line_load(shell.edge("u_max"), (0, 0, 1.0))
        tips[integrals] = pl.solve_static(model).track(shell.at((10, 0.5, 0))).position[-1]
    gap = float(np.abs(tips["precomputed"] - tips["quadrature"]).max())
    # Elements turn by a fifth: four points along u leave a thousandth of the membrane's locking.
    assert record(f"precomputed integrals, {element}", gap, 0.0, 2e-2, unit="m", source="full quadrature")


@pytest.mark.parametrize("quadrature", ["standard", "reduced", "full"])
@pytest.mark.parametrize("element", KINDS)
def test_every_rule_of_every_kind_bends(record, element, quadrature):
    model, shell = strip(10.0, 16, element=element, quadrature=quadrature)
    model.add_line_load(shell.edge("u_max"), (0, 0, 0.01))
    w = float(pl.solve_static(model).track(shell.at((10, 0.5, 0))).position[-1, 2])
    # A beam, F L^3/(3 E I): triangles are stiff, by 1 per cent at this mesh; the load turns the tip by 0.05.
    expected = 0.01 * 1000.0 / (3 * 1.2e6 * 0.1**3 / 12)
    tolerance = 0.015 if element == "triangle" else 2e-3
    title = f"small bending of a strip, {element}, {quadrature}"
    assert record(title, w, expected, tolerance * expected, unit="m", source="beam theory")


def test_simplified_bending_takes_no_curvature_at_rest():
    model, shell = strip(1.0, 2, bending="simplified")
    with pytest.raises(pl.ModelError, match="bending"):
        model.add_curvature(shell, 1.0)
