"""Hanging cables against Irvine's elastic catenary, N = EA (stretch - 1)."""

import numpy as np
import pliant as pl
import pytest
from verification.cables import line, orders

# w = 1 N/m, length 10, span 8, ends level: EA -> horizontal force, sag, tension at the ends.
CATENARY = {
    1e3: (3.335480861979454, 2.6874627639629103, 6.010443625942365),
    1e7: (3.3820140196157085, 2.6543784394492906, 6.036391209064999),
}


def hang(elements: int, axial_stiffness: float):
    """Two straight pieces of the stress-free length, hung by their ends; almost no bending stiffness."""
    depth = 3.0
    model = pl.Model(gravity=(0, 0, -1))
    rope = model.add_cable(
        [(-4, 0, 0), (0, 0, -depth), (4, 0, 0)],
        elements=elements,
        strain="biot",
        **line(axial_stiffness, 1e-8),
    )
    model.pin(rope.start), model.pin(rope.end)
    return model, rope


@pytest.mark.parametrize("stiffness", CATENARY)
def test_sag_and_tension_of_the_elastic_catenary(stiffness, record):
    horizontal, sag, tension = CATENARY[stiffness]
    errors = []
    for n in (8, 16, 32):
        model, rope = hang(n, stiffness)
        left, right = model.joints
        result = pl.solve_static(model)
        middle = result.positions(rope)[-1, n // 2]
        errors.append(abs(-middle[2] - sag))
        reaction = result.reaction(left).force[-1]
        if n == 32:
            # Reactions converge with the same order as the sag.
            assert record(
                f"catenary EA = {stiffness:g}, horizontal force", -reaction[0], horizontal, 3e-5, "N"
            )
            force = np.linalg.norm(reaction)
            assert record(f"catenary EA = {stiffness:g}, end tension", force, tension, 3e-5, "N")
            assert record(f"catenary EA = {stiffness:g}, sag", -middle[2], sag, 1e-6, "m")
        total = result.reaction(left).force[-1] + result.reaction(right).force[-1]
        assert np.allclose(total, (0, 0, 10), atol=1e-8)
    assert orders(errors)[-1] > 3.5
