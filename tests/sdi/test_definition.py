"""The softness distribution index: every sentence of the publication that constrains its lost definition."""

import numpy as np
import pliant as pl
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from sdi.bodies import CASES, body_of, notched

# Samples of 1.25e-5 L, second order, around extrema refined by a parabola: 1e-4 is what the reference grants.
TOLERANCE = 1e-4
L, H, B, E = 0.1, 0.01, 0.01, 1e6


def real_part_of_a_notch(w, left, height=H, n=3):
    """Closed form of the real part for a cosine notch or bump, k ~ h^n."""
    d, A = height - left, (height + left) / 2
    c = (A - np.sqrt(A**2 + n * (n - 1) * d**2)) / (n * d)
    return np.sign(d) * np.pi * L / (w * np.arccos(c))


@pytest.mark.parametrize("case", CASES.values(), ids=CASES)
def test_reference(case, record):
    body = body_of(case)
    assert record(f"SDI, {case['name']}", abs(body.index - complex(*case["sdi"])), 0.0, TOLERANCE)
    if case["x_m"] is not None:
        found = body.distribution
        assert found.x_m == pytest.approx(case["x_m"], abs=1e-5 * body.length)
        assert found.x_M == pytest.approx(case["x_M"], abs=1e-5 * body.length)


@pytest.mark.parametrize("w", [0.01, 0.02, 0.06, 0.1])
@pytest.mark.parametrize("left", [0.001, 0.003, 0.006, 0.009, 0.0099])
def test_notch_has_its_closed_form(w, left):
    body = notched(w, left)
    assert body.index.real == pytest.approx(real_part_of_a_notch(w, left), rel=TOLERANCE)
    assert body.index.imag == pytest.approx((left / H) ** 3, rel=TOLERANCE)


def test_limits_of_a_shallow_and_of_a_deep_notch(record):
    # d -> 0: 2 L/w, to first order in d; h_m -> 0: c = -2/3.
    assert record("SDI, shallow notch", notched(0.02, H * (1 - 1e-4)).index.real, 10.0, 2e-3)
    deep = np.pi / np.arccos(-2 / 3) * L / 0.02
    assert record("SDI, deep notch", notched(0.02, H * 1e-3).index.real, deep, 2e-2)


def test_closed_form_of_a_taper():
    for end in (0.006, 0.009):
        mean, D = (H + end) / 2, H - end
        c = (-mean + np.sqrt(mean**2 + 6 * D**2)) / (3 * D)
        taper = pl.sdi.cosine_taper(L, H, end, B, E)
        assert taper.index.real == pytest.approx(-np.pi / np.arccos(c), rel=TOLERANCE)


def mirrored(body):
    """The body seen from its end."""
    breaks = [body.length - b for b in body.breakpoints]
    return pl.sdi.Body(body.length, lambda x: body.stiffness(body.length - x), breakpoints=breaks)


MIRRORED = [
    notched(0.02, 0.003),
    notched(0.03, 0.004, center=0.025),
    pl.sdi.elliptic_notch(L, H, B, (0.01, 0.02), 0.004, E),
    pl.sdi.bump(L, 0.006, B, 0.04, 0.01, E, center=0.035),
    pl.sdi.cosine_taper(L, H, 0.006, B, E),
    pl.sdi.cone(0.2, 0.03, 0.01, E),
    pl.sdi.exponential(0.2, 0.03, 0.01, E),
    pl.sdi.uniform(L, H, B, E),
    pl.sdi.notches(L, H, B, [(0.03, 0.02, 0.005), (0.07, 0.02, 0.005)], E),
    pl.sdi.notches(L, H, B, [(0.03, 0.02, 0.006), (0.07, 0.03, 0.003)], E),
]


@pytest.mark.parametrize("body", MIRRORED, ids=lambda body: body.name)
def test_appendix_a_the_index_does_not_change_when_the_axis_is_inverted(body):
    assert mirrored(body).index == pytest.approx(body.index, rel=TOLERANCE)


@settings(max_examples=20, deadline=None)
@given(st.floats(1e-6, 1e6), st.floats(0.01, 100.0))
def test_the_index_is_dimensionless(stiffer, longer):
    body = notched(0.03, 0.004)
    scaled = pl.sdi.Body(
        L * longer,
        lambda x: stiffer * body.stiffness(x / longer),
        breakpoints=[0.035 * longer, 0.065 * longer],
    )
    assert scaled.index == pytest.approx(body.index, rel=TOLERANCE)


@pytest.mark.parametrize("places", [(0.03, 0.07), (0.04, 0.06), (0.035, 0.0551)])
def test_section_8_two_equal_notches_have_the_index_of_one(places):
    one = notched(0.02, 0.004)
    two = pl.sdi.notches(L, H, B, [(x, 0.02, 0.004) for x in places], E)
    assert two.index == pytest.approx(one.index, rel=TOLERANCE)


def test_section_8_a_long_arm_with_a_narrow_notch_has_a_great_real_and_a_small_imaginary_part():
    index = [pl.sdi.cosine_notch(length, H, B, 0.02, 0.003, E).index for length in (0.2, 0.4, 0.8)]
    assert index[0].real > 10
    # The real part grows in proportion to the length; the imaginary part does not know it.
    assert [z.real / index[0].real for z in index] == pytest.approx([1, 2, 4], rel=TOLERANCE)
    assert all(z.imag == pytest.approx(0.027, rel=TOLERANCE) for z in index)


def test_sections_6_2_and_6_3_the_real_part_is_zero_where_the_slope_is_constant():
    assert pl.sdi.uniform(L, H, B, E).index == 1j
    linear = pl.sdi.Body(L, lambda x: 1e-3 * (1 - 5 * x))
    assert linear.index == pytest.approx(0.5j, abs=TOLERANCE)


@pytest.mark.parametrize("make", [pl.sdi.cone, pl.sdi.exponential])
@pytest.mark.parametrize("ratio", [0.17, 0.5, 0.9])
def test_section_6_4_cones_and_exponentials_are_characterised_by_one_real_part(make, ratio):
    for start, end in ((0.03, 0.03 * ratio), (0.03 * ratio, 0.03)):
        index = make(0.2, start, end, E).index
        assert index == pytest.approx(1 + 1j * ratio**4, rel=TOLERANCE)


def test_section_6_5_a_bump_and_a_decreasing_height_have_a_negative_real_part():
    bump = pl.sdi.bump(L, 0.006, B, 0.04, 0.01, E).index
    assert bump.real == pytest.approx(real_part_of_a_notch(0.04, 0.01, height=0.006), rel=TOLERANCE)
    assert bump == pytest.approx(-6.69587 + 0.216j, rel=TOLERANCE)
    assert pl.sdi.cosine_taper(L, H, 0.006, B, E).index.real < 0
    assert pl.sdi.cosine_taper(L, 0.006, H, B, E).index.real < 0


def test_pairs_at_one_distance_are_decided_by_the_positive_sign():
    # k' is smallest in the middle and zero at both ends: both pairs are L/2 apart.
    falling = pl.sdi.Body(1.0, lambda x: 1 - 0.4 * (x - np.sin(2 * np.pi * x) / (2 * np.pi)))
    assert falling.index == pytest.approx(2 + 0.6j, rel=TOLERANCE)
    assert mirrored(falling).index == pytest.approx(2 + 0.6j, rel=TOLERANCE)


def test_section_5_1_a_longer_notch_has_a_smaller_real_part_and_a_deeper_one_a_smaller_imaginary_part():
    real = [notched(w, 0.003).index.real for w in (0.01, 0.02, 0.05, 0.1)]
    assert real == sorted(real, reverse=True)
    imaginary = [notched(0.03, left).index.imag for left in (0.001, 0.003, 0.006, 0.009)]
    assert imaginary == sorted(imaginary)
    # Width and place of the notch leave the imaginary part alone.
    assert notched(0.08, 0.003).index.imag == pytest.approx(
        notched(0.02, 0.003, center=0.03).index.imag, rel=1e-4
    )


def test_an_ellipse_has_its_steepest_places_at_its_edges():
    body = pl.sdi.elliptic_notch(L, H, B, (0.01, 0.015), 0.004, E)
    assert body.index.real == pytest.approx(L / 0.025, rel=TOLERANCE)


def test_section_6_1_transformed_section(record):
    from sdi.bodies import REFERENCE

    for case in REFERENCE["bilayer"]:
        body = pl.sdi.layered(L, case["b"], [(case["h1"], case["E1"]), (case["h2"], case["E2"])])
        axis = float(body.sections.neutral_axis(np.array(0.0)))
        # Closed forms: rounding only.
        assert record("layers, neutral axis", axis, case["ybar"], 1e-15, unit="m")
        assert record("layers, EI", float(body.stiffness(0.0)), case["EI"], 1e-15, unit="N m^2")
    # One material in two layers is one material.
    split = pl.sdi.layered(L, B, [(0.004, E), (0.006, E)])
    assert float(split.stiffness(0.02)) == pytest.approx(
        float(pl.sdi.uniform(L, H, B, E).stiffness(0.02)), rel=1e-12
    )


def test_unequal_notches_have_one_index_each():
    body = pl.sdi.notches(L, H, B, [(0.03, 0.02, 0.006), (0.07, 0.03, 0.003)], E)
    first, second = pl.sdi.features(body)
    assert first.index.real == pytest.approx(notched(0.02, 0.006).index.real, rel=1e-3)
    assert second.index.real == pytest.approx(notched(0.03, 0.003).index.real, rel=1e-3)
    assert (first.index.imag, second.index.imag) == pytest.approx((0.216, 0.027), rel=1e-4)
    assert first.center == pytest.approx(0.03, abs=1e-5)


def test_global_extremes_of_unequal_notches_may_lie_in_different_ones():
    # The weakness of the definition: the steepest descent of one notch, the steepest ascent of another.
    def height(x):
        first, second = np.abs(x - 0.03), np.abs(x - 0.07)
        return (
            H
            - 0.005 * np.exp(-((first / np.where(x < 0.03, 0.004, 0.01)) ** 2))
            - 0.005 * np.exp(-((second / np.where(x < 0.07, 0.01, 0.004)) ** 2))
        )

    body = pl.sdi.Body(L, lambda x: height(x) ** 3)
    assert 2.0 < body.index.real < 2.5
    assert all(part.index.real > 5 for part in pl.sdi.features(body))


# Steps, samples and noise


def test_a_step_is_blended_and_said():
    step = pl.sdi.stepped((0.05, 0.05), (0.01, 0.006), E)
    with pytest.warns(pl.sdi.ProfileWarning, match="non-smooth"):
        index = step.index
    # Blended in the diameter over L/50: a half cosine of k ~ d^4, which has a closed form.
    mean, D = 0.008, 0.004
    c = (-mean + np.sqrt(mean**2 + 12 * D**2)) / (4 * D)
    assert index.real == pytest.approx(-50 * np.pi / np.arccos(c), rel=TOLERANCE)
    with pytest.warns(pl.sdi.ProfileWarning):
        assert mirrored(step).index.imag == pytest.approx(index.imag, rel=1e-6)


def test_steps_are_found_in_a_callable():
    body = pl.sdi.Body(L, lambda x: np.where(x < 0.0314159, 1e-3, 4e-4))
    assert body.jumps == pytest.approx((0.0314159,), abs=1e-12)
    assert notched(0.01, 0.001).jumps == ()
    assert pl.sdi.Body(L, lambda x: 1e-3 * np.sqrt(np.abs(x - 0.05) + 1e-6)).jumps == ()


def test_links_of_the_optimisation_have_the_index_of_their_blended_diameter(record):
    link = pl.sdi.stepped((0.02948, 0.02816, 0.04236), (0.01, 0.003921, 0.01), E)
    with pytest.warns(pl.sdi.ProfileWarning):
        # Independent computation to four digits.
        assert record("SDI, link A", link.index.real, 3.445, 2e-3)
    assert link.distribution.index.imag == pytest.approx(0.0236, abs=1e-4)


EXACT = 4.957


def samples(n, noise=0.0):
    x = np.linspace(0, L, n)
    k = notched(0.03, 0.004).stiffness(x)
    return x, k * (1 + noise * np.random.default_rng(1).standard_normal(n))


@pytest.mark.parametrize(("n", "tolerance"), [(21, 0.1), (41, 0.02), (101, 2e-3)])
def test_samples_converge(n, tolerance):
    # Measured: 21 samples 5.33, 41 samples 4.88, 101 samples 4.953.
    assert pl.sdi.softness_index(*samples(n)).real == pytest.approx(EXACT, rel=tolerance)


def test_rough_samples_are_refused_their_derivative_in_a_warning_and_smoothed_on_demand():
    x, k = samples(401, noise=0.01)
    with pytest.warns(pl.sdi.ProfileWarning, match="smooth="):
        raw = pl.sdi.softness_index(x, k)
    assert abs(raw.real - EXACT) > 1
    # 1 % of noise leaves 4 % of the real part with a window of a tenth of the samples.
    assert pl.sdi.softness_index(x, k, smooth=41).real == pytest.approx(EXACT, rel=0.06)
    assert pl.sdi.softness_index(x, k, smooth=True) == pl.sdi.softness_index(x, k, smooth=41)


def test_samples_with_a_declared_break_are_not_differentiated_across_it():
    x = np.linspace(0, L, 201)
    k = np.where(x < 0.05, 1e-3, 5e-4) * (1 + 2 * x)
    with pytest.warns(pl.sdi.ProfileWarning, match="non-smooth"):
        index = pl.sdi.softness_index(x, k, breakpoints=[0.04999])
    # A blended step: half a width between the steepest place and the plateau, or its edge.
    assert index.imag == pytest.approx(5e-4 / 1e-3 * 1.1 / 1.1, rel=0.1)


def test_body_of_samples_agrees_with_the_callable():
    x, k = samples(201)
    body = pl.sdi.Body.from_samples(x, k)
    assert body.index == pytest.approx(notched(0.03, 0.004).index, rel=2e-3)
    (notch,) = body.notches
    assert notch.start == pytest.approx(0.035, abs=0.004)
    assert notch.end == pytest.approx(0.065, abs=0.004)


# Analogues, ours


def test_analogues_have_the_closed_forms_of_their_powers():
    # EA ~ h^1: c = 0 at the steepest places of a cosine: a quarter of the notch on both sides.
    assert pl.sdi.axial_index(notched(0.02, 0.005)) == pytest.approx(10 + 0.5j, rel=TOLERANCE)
    cone = pl.sdi.cone(0.2, 0.03, 0.015, E)
    # GJ ~ d^4 as EI; EA ~ d^2.
    assert pl.sdi.torsion_index(cone) == pytest.approx(cone.index, rel=TOLERANCE)
    assert pl.sdi.axial_index(cone) == pytest.approx(1 + 0.25j, rel=TOLERANCE)
    assert pl.sdi.squeezing_index(notched(0.02, 0.005)).imag == pytest.approx(0.5, rel=TOLERANCE)
    assert pl.sdi.axial_index(pl.sdi.uniform(L, H, B, E)) == 1j


def test_torsion_constant_of_rectangles_agrees_with_the_series(record):
    for width in (0.01, 0.02, 0.05):
        strip = pl.sdi.uniform(L, H, width, E)
        G = E / 2.6
        exact = pl.Rectangle(width, H).torsion_constant
        # The usual closed approximation is good to half a per cent.
        found = float(strip.sections.torsional_stiffness(np.array(0.0))) / G
        assert record(f"torsion constant, {width:g} x 0.01 m", found / exact, 1.0, 5e-3)


def test_slope_of_the_stiffness_bounds_what_constant_curvature_misses():
    from pliant.sdi.techniques.ancf import graded_nodes

    for body in (notched(0.04, 0.004), pl.sdi.cone(0.2, 0.03, 0.01, E)):
        moment = 1.0 / pl.sdi.bend(body, moment=1.0).tip_angle
        exact = pl.sdi.bend(body, moment=moment)
        for tolerance in (0.2, 0.05):
            n = pl.sdi.criteria(body).segments(tolerance)
            arcs = pl.sdi.bend(
                body, moment=moment, technique="constant_curvature", nodes=graded_nodes(body, n)
            )
            assert arcs.error(exact) < tolerance
    assert pl.sdi.criteria(pl.sdi.uniform(L, H, B, E)).variation == pytest.approx(0.0, abs=1e-12)
