"""Techniques that bend a soft body, against an independent implementation, exact solutions and each other."""

import numpy as np
import pliant as pl
import pytest
from pliant.sdi.solid import Lattice, Solid, hexahedron, quadrilateral
from pliant.sdi.techniques import options_of
from sdi.bodies import CASES, HEIGHT, LENGTH, MODULUS, WIDTH, body_of, loads_of, notched

STRIP = (LENGTH, HEIGHT, WIDTH, MODULUS)
STIFFNESS = MODULUS * WIDTH * HEIGHT**3 / 12


def distance(shape, tip):
    """Distance of the end from a place, over the length."""
    return np.hypot(shape.tip[0] - tip[0], shape.tip[1] - tip[1]) / shape.details["length"]


def turning(body, rotation=1.0):
    return rotation / pl.sdi.bend(body, moment=1.0).tip_angle


def cases_with(key):
    """Parametrise over the cases of the reference that have a number of this technique."""
    chosen = {name: case for name, case in CASES.items() if key in case}
    return pytest.mark.parametrize("case", chosen.values(), ids=chosen)


class TestReference:
    """Numbers of an independent implementation."""

    @cases_with("ea")
    def test_elastica(self, case, record):
        shape = pl.sdi.bend(body_of(case), **loads_of(case))
        # The reference integrates with a relative tolerance of 1e-10.
        assert record(f"elastica, {case['name']}", distance(shape, case["ea"]), 0.0, 1e-7, unit="L")
        assert shape.tip_angle == pytest.approx(case["ea"][2], abs=1e-7)

    @cases_with("nmsa_mid")
    @pytest.mark.parametrize("sampling", ["mid", "mean", "harmonic"])
    def test_matrix_as_published(self, case, sampling, record):
        options = {"variant": "paper", "sampling": sampling}
        shape = pl.sdi.bend(body_of(case), technique="matrix", **options, **loads_of(case))
        # Deterministic: quadratures of the stiffness and rounding.
        assert record(
            f"matrix {sampling}, {case['name']}",
            distance(shape, case[f"nmsa_{sampling}"]),
            0.0,
            1e-9,
            unit="L",
        )
        assert shape.tip_angle == pytest.approx(case[f"nmsa_{sampling}"][2], abs=1e-8)

    @cases_with("nmsa_geo_harmonic_6_100")
    def test_matrix_with_geometric_terms(self, case, record):
        shape = pl.sdi.bend(body_of(case), technique="matrix", geometric=True, **loads_of(case))
        error = distance(shape, case["nmsa_geo_harmonic_6_100"])
        assert record(f"matrix with geometric terms, {case['name']}", error, 0.0, 1e-9, unit="L")

    @cases_with("lpm_coef")
    @pytest.mark.parametrize("flexure", ["pivot", "chord", "arc"])
    def test_lumped(self, case, flexure, record):
        options = {"coefficient": case["lpm_coef"], "flexure": flexure}
        shape = pl.sdi.bend(body_of(case), technique="lumped", **options, **loads_of(case))
        # Closed formulas: rounding.
        assert record(
            f"lumped {flexure}, {case['name']}", distance(shape, case[f"lpm_{flexure}"]), 0.0, 1e-10, unit="L"
        )

    @cases_with("fea2d")
    def test_plane_finite_elements(self, case, record):
        shape = pl.sdi.bend(body_of(case), technique="finite_element", **loads_of(case))
        # The same mesh; both stop at residuals of 1e-8.
        assert record(f"finite elements, {case['name']}", distance(shape, case["fea2d"]), 0.0, 1e-4, unit="L")
        assert shape.tip_angle == pytest.approx(case["fea2d"][2], abs=2e-5)

    @cases_with("ancf24")
    def test_ancf(self, case, record):
        shape = pl.sdi.bend(body_of(case), technique="ancf", **loads_of(case))
        # The cable is extensible, the elastica not: (h/L)^2/12 times the load's scale.
        assert record(
            f"ANCF against the elastica, {case['name']}", distance(shape, case["ea"]), 0.0, 1e-3, unit="L"
        )
        assert shape.tip_angle == pytest.approx(case["ea"][2], abs=2e-3)


# Elastica


@pytest.mark.parametrize("angle", [0.1, 1.5, 6.0])
def test_an_end_moment_bends_a_uniform_arm_into_an_arc(angle):
    shape = pl.sdi.bend(pl.sdi.uniform(*STRIP), moment=angle * STIFFNESS / LENGTH)
    assert shape.x[-1] == pytest.approx(LENGTH * np.sin(angle) / angle, abs=1e-12)
    assert shape.y[-1] == pytest.approx(LENGTH * (1 - np.cos(angle)) / angle, abs=1e-12)


@pytest.mark.parametrize(
    ("load", "x", "y", "angle"),
    [(1, 0.943567, 0.301721, 0.461352), (2, 0.839358, 0.493457, 0.781750), (4, 0.671059, 0.669964, 1.121239)],
)
def test_end_force(load, x, y, angle, record):
    shape = pl.sdi.bend(pl.sdi.uniform(*STRIP), force=(0, load * STIFFNESS / LENGTH**2))
    # The tabulated values have six digits.
    found = (*np.array(shape.tip) / LENGTH, shape.tip_angle)
    assert record(f"elastica, F L^2/k = {load}", found, (x, y, angle), 1e-6, source="elliptic integrals")


@pytest.mark.parametrize(("share", "stable"), [(0.98, True), (1.02, False)])
def test_buckling_is_noticed(share, stable, recwarn):
    euler = np.pi**2 / 4 * STIFFNESS / LENGTH**2
    pl.sdi.bend(pl.sdi.uniform(*STRIP), force=(-share * euler, 0.0))
    assert (len(recwarn) == 0) == stable
    if not stable:
        assert "unstable" in str(recwarn[0].message)


def test_equilibrium_holds_at_every_point():
    body = notched(0.03, 0.004)
    shape = pl.sdi.bend(body, moment=2e-4, force=(-0.01, 0.02))
    curvature = shape.details["curvature"]
    s = shape.details["points"]
    inside = np.isin(shape.details["s"], s)
    x, y = shape.x[inside], shape.y[inside]
    m = 2e-4 + 0.02 * (shape.x[-1] - x) + 0.01 * (shape.y[-1] - y)
    assert np.abs(m - body.stiffness(s) * curvature).max() < 1e-12


def test_more_panels_change_nothing():
    body = pl.sdi.elliptic_notch(LENGTH, HEIGHT, WIDTH, (0.01, 0.02), 0.002, MODULUS)
    moment = turning(body)
    coarse, fine = (pl.sdi.bend(body, moment=moment, panels=n) for n in (12, 48))
    # The square roots at the edges of an ellipse leave an algebraic error.
    assert coarse.error(fine) < 1e-6


def test_shear_makes_short_bodies_softer_as_timoshenko_says(record):
    body = pl.sdi.uniform(0.02, HEIGHT, WIDTH, MODULUS)
    force = 1e-4
    deflection = {shear: pl.sdi.bend(body, force=(0, force), shear=shear).tip[1] for shear in (False, True)}
    coefficient = 10 * 1.3 / (12 + 11 * 0.3)
    exact = force * 0.02 / (coefficient * MODULUS / 2.6 * HEIGHT * WIDTH)
    # Small displacements: the next terms are (v/L)^2 of it.
    assert record("shear deflection", deflection[True] - deflection[False], exact, 1e-4 * exact, unit="m")
    solid = pl.sdi.bend(body, force=(0, force), technique="finite_element").tip[1]
    # The clamped end hinders warping; a length of twice the height is far from slender.
    assert abs(deflection[True] / solid - 1) < 0.025 < abs(deflection[False] / solid - 1)
    matrix = pl.sdi.bend(body, force=(0, force), technique="matrix", shear=True).tip[1]
    assert matrix == pytest.approx(deflection[True], rel=1e-4)


# Matrix structural analysis


def test_published_scheme_is_consistent_with_moments_and_not_with_forces(record):
    body = pl.sdi.uniform(*STRIP)
    fine = {"technique": "matrix", "variant": "paper", "elements": 24, "steps": 2000}
    force = (0, 2 * STIFFNESS / LENGTH**2)
    wrong = pl.sdi.bend(body, force=force, **fine)
    # Four digits were tabulated.
    assert record("matrix as published, end force", np.array(wrong.tip) / LENGTH, (0.7949, 0.5485), 1e-3)
    right = pl.sdi.bend(body, force=force, **fine, geometric=True)
    assert record(
        "matrix with geometric terms, end force", np.array(right.tip) / LENGTH, (0.84003, 0.49417), 1e-4
    )
    assert (
        right.error(pl.sdi.bend(body, force=force))
        < 2.5e-3
        < 0.1
        < wrong.error(pl.sdi.bend(body, force=force))
    )
    moment = 1.5 * STIFFNESS / LENGTH
    assert pl.sdi.bend(body, moment=moment, **fine).error(pl.sdi.bend(body, moment=moment)) < 1e-3


def test_tapered_element_of_one_stiffness_is_the_beam():
    from pliant.sdi.techniques.matrix import local_stiffness, tapered_stiffness

    body = pl.sdi.uniform(*STRIP)
    nodes = np.array([0.0, 0.03, LENGTH])
    spans, one = np.diff(nodes), np.ones(2)
    plain = local_stiffness(spans, STIFFNESS * one, one, np.zeros(2))
    assert tapered_stiffness(body, nodes, one) == pytest.approx(plain, rel=1e-10, abs=1e-12)


def test_tapered_elements_are_exact_where_displacements_are_small():
    body = pl.sdi.cone(0.2, 0.03, 0.005, MODULUS)
    moment = turning(body, 1e-3)
    exact = pl.sdi.bend(body, moment=moment)
    errors = {
        s: pl.sdi.bend(body, moment=moment, technique="matrix", sampling=s).error(exact)
        for s in ("exact", "harmonic")
    }
    assert errors["exact"] < 1e-3 < 0.05 < errors["harmonic"]


# Lumped, hybrid, constant curvature


def test_integral_coefficient_and_the_published_one_agree_for_the_notch_it_was_made_for():
    # c = 0.267 is the integral's value at 0.303 of the height, whatever the length of the notch.
    for w in (0.02, 0.06):
        body = notched(w, 0.303 * HEIGHT)
        (start, length, _), *_ = pl.sdi.bend(body, moment=1e-4, technique="lumped").details["flexures"]
        assert length / w == pytest.approx(0.267, abs=1e-3)
        assert start + length / 2 == pytest.approx(LENGTH / 2, abs=1e-9)
    for share, c in ((0.1, 0.1277), (0.2, 0.1968), (0.45, 0.3780), (0.6, 0.5112), (0.9, 0.857)):
        (_, length, _), *_ = pl.sdi.bend(
            notched(0.04, share * HEIGHT), moment=1e-4, technique="lumped"
        ).details["flexures"]
        assert length / 0.04 == pytest.approx(c, abs=1e-3)


def test_flexure_with_an_end_force_is_the_beam_for_small_loads():
    link = pl.sdi.stepped((0.04, 0.02, 0.04), (0.01, 0.002, 0.01), MODULUS)
    for technique in ("lumped", "hybrid"):
        load = {"moment": 1e-8, "force": (0, 1e-6)}
        shape = pl.sdi.bend(link, technique=technique, **load)
        # The thick parts are 625 times stiffer.
        assert shape.tip[1] == pytest.approx(pl.sdi.bend(link, **load).tip[1], rel=2e-2)


def test_two_notches_are_two_springs():
    body = pl.sdi.notches(LENGTH, HEIGHT, WIDTH, [(0.03, 0.02, 0.002), (0.07, 0.02, 0.002)], MODULUS)
    shape = pl.sdi.bend(body, moment=turning(body), technique="lumped", variant="paper")
    assert shape.parameters == 2
    single = pl.sdi.bend(notched(0.02, 0.002), moment=turning(body), technique="lumped", variant="paper")
    assert shape.tip_angle == pytest.approx(2 * single.tip_angle, rel=1e-9)


def test_hybrid_keeps_the_rotation_and_needs_few_unknowns():
    body = notched(0.02, 0.003)
    exact = pl.sdi.bend(body, moment=turning(body))
    hybrid = pl.sdi.bend(body, moment=turning(body), technique="hybrid")
    assert hybrid.tip_angle == pytest.approx(exact.tip_angle, rel=1e-6)
    assert hybrid.error(exact) < 0.005
    assert hybrid.parameters < exact.parameters / 5


def test_arcs_are_exact_where_the_stiffness_is_uniform_and_converge_with_order_2_elsewhere(record):
    load = {"moment": 0.002, "force": (-0.02, 0.05)}
    body = notched(0.1, 0.006)
    exact = pl.sdi.bend(body, **load)
    errors = [
        pl.sdi.bend(body, technique="constant_curvature", segments=n, **load).error(exact) for n in (16, 32)
    ]
    # Fourth-order terms are worth (1/16)^2.
    assert record("constant curvature, order", np.log2(errors[0] / errors[1]), 2.0, 0.05)
    uniform = pl.sdi.uniform(*STRIP)
    arc = pl.sdi.bend(uniform, moment=0.02, technique="constant_curvature", segments=3)
    assert arc.error(pl.sdi.bend(uniform, moment=0.02)) < 1e-12


def test_arcs_with_a_force_are_in_equilibrium():
    # The total potential is stationary: any change of the curvatures costs at second order only.
    from pliant.sdi.techniques.constant_curvature import _arcs, _rates

    rng = np.random.default_rng(2)
    spans, kappa = rng.uniform(0.01, 0.03, 5), rng.normal(0, 20, 5)
    numeric = np.array(
        [(_arcs(kappa + d, spans)[0][-1] - _arcs(kappa - d, spans)[0][-1]) / 2e-5 for d in 1e-5 * np.eye(5)]
    )
    assert _rates(kappa, spans) == pytest.approx(numeric, abs=1e-9)


# ANCF


def test_a_mesh_graded_by_the_slope_of_the_stiffness_needs_fewer_elements(record):
    body = notched(0.02, 0.003)
    moment = turning(body)
    exact = pl.sdi.bend(body, moment=moment)
    even, graded = (
        pl.sdi.bend(body, moment=moment, technique="ancf", elements=12, graded=g).error(exact)
        for g in (False, True)
    )
    # Another implementation of the element, with five points instead of three, has 15.6 % and 0.07 %.
    assert record("ANCF, 12 elements, even", 100 * even, 15.6, 1.0, unit="%")
    assert record("ANCF, 12 elements, graded", 100 * graded, 0.07, 0.2, unit="%")
    assert graded < even / 50


def test_ancf_converges_with_order_4_on_a_uniform_arm(record):
    body = pl.sdi.uniform(*STRIP)
    exact = pl.sdi.bend(body, moment=0.0125)
    errors = [pl.sdi.bend(body, moment=0.0125, technique="ancf", elements=n).error(exact) for n in (4, 8)]
    assert record("ANCF, order", np.log2(errors[0] / errors[1]), 4.0, 0.7)


def test_a_body_of_a_model_bends_like_the_technique():
    body = pl.sdi.elliptic_notch(LENGTH, HEIGHT, WIDTH, (0.02, 0.02), 0.004, MODULUS)
    moment = turning(body, 0.5)
    model = pl.Model()
    finger = body.add_to(
        model, start=(0, 0, 1), direction=(0, 0, -2), up=(1, 0, 0), elements=30, name="finger"
    )
    model.clamp(finger.start)
    model.add_moment(finger.end, (0, moment, 0))
    end = pl.solve_static(model).track(finger.end).position[-1]
    expected = pl.sdi.bend(body, moment=moment).tip
    assert end == pytest.approx([-expected[1], 0, 1 - expected[0]], abs=1e-4 * LENGTH)


def test_the_mass_of_a_body_is_that_of_its_sections():
    strong = pl.sdi.stepped((0.05, 0.05), (0.01, 0.01), (1e6, 5e6))
    for body, area in ((notched(0.1, 0.003), WIDTH * 0.0065), (strong, np.pi * 0.01**2 / 4)):
        model = pl.Model(gravity=(0, 0, -9.81))
        finger = body.add_to(model, density=1200.0)
        clamp = model.clamp(finger.start)
        weight = pl.solve_static(model).reaction(clamp).force[-1, 2]
        # Five Gauss points an element integrate the mass.
        assert weight == pytest.approx(1200 * area * LENGTH * 9.81, rel=1e-4)


# Finite elements


@pytest.mark.parametrize(("kind", "size", "d"), [(quadrilateral(), (3, 2), 2), (hexahedron(), (3, 2, 2), 3)])
class TestSolid:
    """The elements by themselves, on a distorted lattice."""

    def solid(self, kind, size, d):
        bend = np.array([0.03, -0.05, 0.04])[:d]

        def position(place):
            x = place / 2.0
            x = x * np.array([1.0, 0.4, 0.5])[:d] - np.array([0.0, 0.4, 0.0])[:d]
            # The outside stays as it is.
            shift = (
                np.sin(np.pi * x[:, :1] / 3) * np.sin(2 * x[:, 1:2] + 1) * (1 - (x[:, 1:2] / 0.4) ** 2) * bend
            )
            if d == 3:
                shift *= 4 * x[:, 2:] * (1 - x[:, 2:])
            return x + shift

        lattice = Lattice.of(kind, size, position)
        points = (len(lattice.elements), len(kind.weights))
        return Solid(lattice, np.full((*points, 2), (1.3, 0.8)), np.ones(points))

    def test_stiffness_is_the_derivative_of_the_force(self, kind, size, d):
        solid = self.solid(kind, size, d)
        rng = np.random.default_rng(3)
        u = 0.05 * rng.standard_normal(solid.lattice.nodes.shape)
        v = rng.standard_normal(u.shape)
        _, K = solid.internal(u, tangent=True)
        local = v.ravel()[solid.dofs]
        product = np.bincount(solid.dofs.ravel(), np.einsum("eij,ej->ei", K, local).ravel(), u.size)
        h = 1e-6
        numeric = (solid.internal(u + h * v, False)[0] - solid.internal(u - h * v, False)[0]) / (2 * h)
        # Central differences: h^2 and rounding over h.
        assert product == pytest.approx(numeric.ravel(), abs=1e-8 * np.abs(numeric).max())
        assert np.abs(K - K.swapaxes(1, 2)).max() < 1e-12 * np.abs(K).max()

    def test_rigid_motion_costs_nothing_and_forces_balance(self, kind, size, d):
        solid = self.solid(kind, size, d)
        c, s = np.cos(0.7), np.sin(0.7)
        R = np.eye(d)
        R[:2, :2] = [[c, -s], [s, c]]
        turned = solid.lattice.nodes @ R.T - solid.lattice.nodes + 0.3
        assert np.abs(solid.internal(turned, False)[0]).max() < 1e-13
        u = 0.05 * np.random.default_rng(4).standard_normal(turned.shape)
        assert np.abs(solid.internal(u, False)[0].sum(axis=0)).max() < 1e-13

    def test_patch(self, kind, size, d):
        # A homogeneous strain is reproduced: stresses of the closed form on the end.
        solid = self.solid(kind, size, d)
        F = np.eye(d)
        F[0, 0] = 1.1
        forces, _ = solid.internal(solid.lattice.nodes @ (F - np.eye(d)).T, False)
        green = (1.1**2 - 1) / 2
        first_piola = 1.1 * (1.3 + 1.6) * green
        # The reduced points of the hexahedra leave an error on distorted elements.
        assert forces[solid.end_nodes, 0].sum() == pytest.approx(
            first_piola * 0.8, rel=1e-12 if d == 2 else 1e-3
        )

    def test_volume(self, kind, size, d):
        assert self.solid(kind, size, d).weights.sum() == pytest.approx(
            3 * 0.8, rel=1e-12 if d == 2 else 1e-3
        )


def test_the_free_end_moves_rigidly_and_its_derivatives_are_right():
    solid = pl.sdi.bend(
        pl.sdi.uniform(*STRIP), moment=1e-3, technique="finite_element", elements=(4, 2)
    ).details["solid"]
    q = np.array([0.01, -0.02, 0.4])
    _, rate, bend = solid.end(q)
    h = 1e-6
    numeric = np.stack([(solid.end(q + e)[0] - solid.end(q - e)[0]) / (2 * h) for e in h * np.eye(3)], axis=2)
    assert rate == pytest.approx(numeric, abs=1e-9)
    turn = np.array([0, 0, h])
    assert bend == pytest.approx(
        (solid.end(q + turn)[1] - solid.end(q - turn)[1])[..., 2] / (2 * h), abs=1e-9
    )


def test_finite_elements_do_not_depend_on_the_way_there():
    body = notched(0.03, 0.004)
    moment = turning(body)
    direct, stepwise = (
        pl.sdi.bend(body, moment=moment, technique="finite_element", elements=(40, 4), steps=n)
        for n in (1, 4)
    )
    assert stepwise.error(direct) < 1e-8


@pytest.mark.parametrize(
    ("coarse", "fine", "moved"),
    [((40, 4), (80, 6), 1e-3), pytest.param((80, 6), (120, 10), 1e-4, marks=pytest.mark.slow)],
)
def test_finite_elements_converge(coarse, fine, moved):
    body = notched(0.06, 0.003)
    moment = turning(body)
    angles = [
        pl.sdi.bend(body, moment=moment, technique="finite_element", elements=n).tip_angle
        for n in (coarse, fine)
    ]
    # Measured elsewhere: 5e-4 and 4e-5.
    assert abs(angles[1] - angles[0]) < moved


def test_plane_stress_is_within_a_per_cent_of_the_solid():
    body = notched(0.06, 0.003)
    moment = turning(body)
    plane = pl.sdi.bend(body, moment=moment, technique="finite_element")
    solid = pl.sdi.bend(body, moment=moment, technique="finite_element", dimension=3, elements=(20, 2, 1))
    assert plane.error(solid) < 0.015
    assert abs(plane.tip_angle / solid.tip_angle - 1) < 0.012


def test_hexahedra_without_lateral_contraction_are_plane():
    body = notched(0.06, 0.005, poisson_ratio=0.0)
    moment = turning(body, 0.5)
    plane = pl.sdi.bend(body, moment=moment, technique="finite_element")
    solid = pl.sdi.bend(body, moment=moment, technique="finite_element", dimension=3, elements=(24, 4, 1))
    # Reduced points and fewer columns.
    assert plane.error(solid) < 2e-3


@pytest.mark.slow
def test_the_published_mesh(record):
    # 68 x 12 x 7 hexahedra have the published 5712 elements and 27,151 nodes; half the width here.
    body = notched(0.06, 0.003)
    moment = turning(body)
    fine = pl.sdi.bend(body, moment=moment, technique="finite_element", dimension=3, elements=(68, 6, 3))
    coarse = pl.sdi.bend(body, moment=moment, technique="finite_element", dimension=3)
    assert record("hexahedra, finer mesh", coarse.error(fine), 0.0, 5e-4)
    place = fine.details["solid"].lattice.place
    assert len(fine.details["solid"].lattice.elements) == 68 * 6 * 3
    assert place[:, 0].max() == 136


def test_the_published_number_of_nodes_is_that_of_68_x_12_x_7():
    def nodes(a, b, c):
        corners = (a + 1) * (b + 1) * (c + 1)
        return corners + a * (b + 1) * (c + 1) + b * (a + 1) * (c + 1) + c * (a + 1) * (b + 1)

    found = [
        (a, b, 5712 // (a * b))
        for a in range(1, 5713)
        if 5712 % a == 0
        for b in range(1, a + 1)
        if 5712 % (a * b) == 0 and 5712 // (a * b) <= b and nodes(a, b, 5712 // (a * b)) == 27151
    ]
    assert found == [(68, 12, 7)]


def test_a_cone_in_space_agrees_with_the_elastica():
    body = pl.sdi.cone(0.2, 0.03, 0.015, MODULUS)
    moment = turning(body)
    solid = pl.sdi.bend(body, moment=moment, technique="finite_element", dimension=3, elements=(12, 4, 2))
    # Sections of 3 cm on 20 cm: the elastica is good to half a per cent.
    assert pl.sdi.bend(body, moment=moment).error(solid) < 0.007
    volume = np.pi * 0.2 / 12 * (0.03**2 + 0.015**2 + 0.03 * 0.015)
    # Parabolas for circles.
    assert solid.details["solid"].weights.sum() == pytest.approx(volume, rel=1e-3)


def test_two_materials_bend_as_their_transformed_section():
    body = pl.sdi.layered(LENGTH, WIDTH, [(0.004, MODULUS), (0.002, 5 * MODULUS)])
    moment = turning(body, 0.2)
    solid = pl.sdi.bend(body, moment=moment, technique="finite_element")
    # The full clamp hinders the lateral contraction at one end.
    assert pl.sdi.bend(body, moment=moment).error(solid) < 0.012
    # The section about its middle would be wrong by far.
    naive = (MODULUS * 0.004 + 5 * MODULUS * 0.002) * WIDTH * 0.006**2 / 12
    assert abs(float(body.stiffness(0.0)) / naive - 1) > 0.1


def test_overload_says_what_fails():
    with pytest.raises(pl.ConvergenceError, match="loses its stability"):
        pl.sdi.bend(notched(0.01, 0.003), moment=5e-3, technique="finite_element", elements=(20, 2))


# The interface


@pytest.mark.parametrize("technique", list(pl.sdi.TECHNIQUES))
def test_every_technique_answers_alike(technique):
    body = notched(0.06, 0.003)
    options = {"elements": (24, 4)} if technique == "finite_element" else {}
    for load in ({"moment": 7e-4}, {"moment": 3e-4, "force": (-0.002, 0.004)}):
        shape = pl.sdi.bend(body, technique=technique, **options, **load)
        assert shape.x.shape == shape.y.shape == shape.angle.shape
        assert (shape.x[0], shape.y[0], shape.angle[0]) == pytest.approx((0, 0, 0), abs=1e-9)
        assert shape.tip == (shape.x[-1], shape.y[-1])
        assert shape.technique == technique
        assert shape.parameters >= 1
        assert shape.seconds > 0
        assert np.isfinite(shape.angle).all()
        # All of them know this body; the lumped one leaves out a tenth of its bending.
        assert shape.error(pl.sdi.bend(body, **load)) < 0.12
    back = pl.sdi.bend(body, technique=technique, moment=-7e-4, **options)
    there = pl.sdi.bend(body, technique=technique, moment=7e-4, **options)
    assert back.tip == pytest.approx((there.tip[0], -there.tip[1]), abs=1e-8)


@pytest.mark.parametrize("technique", list(pl.sdi.TECHNIQUES))
def test_options_are_documented(technique):
    text = pl.sdi.bend.__doc__
    line = text[text.index(f"- {technique}:") :]
    for option in options_of(technique):
        assert option in line, option
