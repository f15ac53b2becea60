"""The cantilever under a tip force: exact elastica, extensible rods, locking, orders."""

import numpy as np
import pliant as pl
import pytest
from verification.cables import cantilever, orders

# P L^2/EI: tip (x, y) of the inextensible elastica, elliptic integrals with 30 digits.
ELASTICA = {
    0.5: (0.9840810375291625, 0.1621435756583696),
    1.0: (0.9435667637166231, 0.3017207737998136),
    2.0: (0.8393582791748327, 0.4934574803967118),
    5.0: (0.6123716392755701, 0.7137915236119128),
    10.0: (0.4450044022462487, 0.8106090248802964),
}
# (EA, strain): tip of the extensible rod, P = 2, EI = L = 1; two-point boundary value problem to 1e-9.
EXTENSIBLE = {
    (1e2, "green_lagrange"): (0.8448015260917109, 0.502280017410936),
    (1e2, "biot"): (0.8448896348370178, 0.5024412566770783),
    (1e4, "green_lagrange"): (0.8394134665410904, 0.4935465969934669),
    (1e4, "biot"): (0.8394134755371425, 0.49354661329783),
}
# Tip errors of an independent implementation of the same element, n = 2, 4, 8, 16, P = 2.
LOCKING = {
    (1e8, "lobatto"): (
        7.966871485522195e-04,
        5.275112408372982e-05,
        3.3010234335570923e-06,
        2.06207922935e-07,
    ),
    (1e8, "full"): (0.1290047779867343, 0.010850605817564545, 0.0015584948887083759, 0.0003373793403971575),
    (1e4, "lobatto"): (
        7.962184522729969e-04,
        5.271739605891e-05,
        3.298949103037928e-06,
        2.0607996535296928e-07,
    ),
    (1e4, "full"): (
        0.016480686774339833,
        0.0009906082734107123,
        2.347852928461704e-05,
        4.656446916018209e-07,
    ),
}


def tip(elements: int, axial_stiffness: float, force: float, stable: bool = True, **options) -> np.ndarray:
    model, arm = cantilever(elements, axial_stiffness, **options)
    model.add_force(arm.end, (0, force, 0))
    result = pl.solve_static(model, load_steps=4, stable=stable)
    return result.track(arm.end).position[-1]


def error(achieved: np.ndarray, exact: tuple[float, float]) -> float:
    return float(np.hypot(achieved[0] - exact[0], achieved[1] - exact[1]))


def test_elastica_of_16_elements_is_within_1e_6_lengths_and_converges_with_order_4(record):
    errors = [error(tip(n, 1e8, 2.0), ELASTICA[2.0]) for n in (4, 8, 16)]
    assert record("elastica, 16 elements, EA L^2/EI = 1e8", errors[-1], 0.0, 1e-6, unit="L")
    # Asymptotic rate of a cubic element in the tip is 4.
    assert np.all(orders(errors) > 3.9)
    assert record("elastica, order of convergence", orders(errors)[-1], 4.0, 0.1)


@pytest.mark.parametrize("force", ELASTICA)
def test_elastica_under_all_loads(force, record):
    # 32 elements: 1.3e-8 at a load of 2, growing with the square of the curvature.
    achieved = error(tip(32, 1e8, force), ELASTICA[force])
    assert record(f"elastica, P L^2/EI = {force:g}, 32 elements", achieved, 0.0, 1e-6, unit="L")


@pytest.mark.parametrize(("stiffness", "strain"), EXTENSIBLE)
def test_extensible_rods_tell_the_strain_measures_apart(stiffness, strain, record):
    # 32 elements: discretisation error 1.3e-8.
    achieved = error(tip(32, stiffness, 2.0, strain=strain), EXTENSIBLE[stiffness, strain])
    assert record(f"extensible rod, EA = {stiffness:g}, {strain}", achieved, 0.0, 3e-8, unit="L")


@pytest.mark.filterwarnings("ignore:the equilibrium is unstable")
@pytest.mark.parametrize(("stiffness", "integration"), LOCKING)
def test_locking_study_is_reproduced(stiffness, integration, record):
    exact = ELASTICA[2.0] if stiffness == 1e8 else EXTENSIBLE[stiffness, "green_lagrange"]
    for n, published in zip((2, 4, 8, 16), LOCKING[stiffness, integration], strict=True):
        # The smooth shape of two locked elements is unstable: they kink.
        achieved = error(tip(n, stiffness, 2.0, stable=False, integration=integration), exact)
        # Same equations: agreement to the accuracy of the exact solutions (1e-9) and of the static solve.
        name = f"tip error, EA = {stiffness:g}, {integration}, {n} elements"
        assert record(name, achieved, published, 5e-9 + 1e-4 * published, unit="L")


@pytest.mark.parametrize("turns", [0.5, 1.0])
def test_end_moment_rolls_the_cantilever_up(turns, record):
    moment = 2 * np.pi * turns
    exact = (np.sin(moment) / moment, (1 - np.cos(moment)) / moment)
    errors = []
    for n in (8, 16, 32):
        model, arm = cantilever(n, 1e4)
        model.add_moment(arm.end, (0, 0, moment))
        result = pl.solve_static(model, load_steps=10)
        errors.append(error(result.track(arm.end).position[-1], exact))
    # Tip errors of an independent implementation of the same element, EA = 1e4 EI/L^2.
    published = {0.5: 7.501042733572357e-06, 1.0: 9.798536590218651e-05}[turns]
    name = f"rolled up by {turns:g} turns, tip error, 16 elements"
    assert record(name, errors[1], published, 1e-3 * published, unit="L")
    assert np.all(orders(errors) > 3.8)


def test_follower_force_keeps_its_angle_to_the_tangent(record):
    # A force along the tangent at the start stays along it: pure compression, no deflection below buckling;
    # one across it does not depend on rotating the model.
    tips = []
    for angle in (0.0, 0.7):
        c, s = np.cos(angle), np.sin(angle)
        model = pl.Model()
        arm = model.add_cable([(0, 0, 0), (c, s, 0)], elements=32, **_line())
        model.clamp(arm.start)
        model.add_force(arm.end, (-5 * s, 5 * c, 0), follower=True)
        position = pl.solve_static(model, load_steps=8).track(arm.end).position[-1]
        tips.append([c * position[0] + s * position[1], -s * position[0] + c * position[1]])
    assert np.allclose(tips[0], tips[1], atol=1e-9)
    # 32 elements: 2.3e-7, of order 4. Exact planar solution: th'' = P cos(...) of the follower elastica,
    # shot from the tip.
    exact = _follower_elastica(5.0)
    assert record("follower force P L^2/EI = 5, tip", error(np.array(tips[0]), exact), 0.0, 4e-7, unit="L")


def _line():
    from verification.cables import line

    return line(1e8, 1.0)


def _follower_elastica(p: float) -> tuple[float, float]:
    """Tip of an inextensible cantilever under a force p that stays across its tip."""
    from scipy.integrate import solve_ivp

    # In the frame of the tip, backwards: kappa(0) = 0, d kappa/ds = p cos(theta) from the tip inwards.
    sol = solve_ivp(
        lambda s, y: [-y[1], p * np.cos(y[0]), -np.cos(y[0]), -np.sin(y[0])],
        (0, 1),
        [0.0, 0.0, 0.0, 0.0],
        rtol=1e-12,
        atol=1e-13,
    )
    theta, _, x, y = sol.y[:, -1]
    # The clamp is at (x, y) with direction theta in the tip's frame: turn it onto the axis.
    c, s = np.cos(-theta), np.sin(-theta)
    dx, dy = -x, -y
    return float(c * dx - s * dy), float(s * dx + c * dy)
