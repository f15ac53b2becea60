"""Beams: Timoshenko's solutions, large bends and twists, rest shapes in space, frequencies, motion."""

from __future__ import annotations

import itertools

import numpy as np
import pliant as pl
import pytest
from scipy.spatial.transform import Rotation

STEEL = pl.LinearElastic(youngs_modulus=2.07e11, poisson_ratio=0.3, density=7850.0)
BAR = pl.Rectangle(width=0.02, height=0.04)
ALONG_X = [(0, 0, 0), (1, 0, 0)]


def shear_modulus(material: pl.LinearElastic) -> float:
    return material.youngs_modulus / (2 * (1 + material.poisson_ratio))


def bar(elements: int, points=ALONG_X, section=BAR, material=STEEL, gravity=(0, 0, 0), **options):
    model = pl.Model(gravity=gravity)
    return model, model.add_beam(points, elements=elements, section=section, material=material, **options)


def orders(errors) -> np.ndarray:
    return np.log2(np.array(errors[:-1]) / errors[1:])


# Bending, shear and torsion by Timoshenko


@pytest.mark.parametrize("thickness", [0.5, 0.005])
def test_one_element_is_a_timoshenko_cantilever_under_a_tip_load(record, thickness):
    section = pl.Rectangle(width=0.6 * thickness, height=thickness)
    model, arm = bar(1, section=section)
    k = 10 * 1.3 / (12 + 11 * 0.3)
    bend = 1 / (3 * 2.07e11 * section.second_moments[0])
    exact = bend + 1 / (k * shear_modulus(STEEL) * section.area)
    model.clamp(arm.start)
    # A load so small that what is quadratic in it does not show.
    model.add_force(arm.end, (0, 0, 1e-6 / exact))
    tip = pl.solve_static(model).track(arm.end).position[-1, 2] / 1e-6
    name = f"Timoshenko cantilever, tip load, 1 element, L/h = {1 / thickness:g}"
    # Rounding of the shear and stretch against the deflection, up to (L/h)^2 1e-16 / 1e-6.
    assert record(name, tip, 1.0, 1e-6, unit="w/w_T", source="closed form")


def test_uniform_load_is_exact_at_nodes_and_of_order_4_between(record):
    section, place = pl.Rectangle(0.05, 0.1), 0.3
    e, i_y = STEEL.youngs_modulus, section.second_moments[0]
    shear = 10 * 1.3 / (12 + 11 * 0.3) * shear_modulus(STEEL) * section.area

    def exact(x: float) -> float:
        return x**2 * (6 - 4 * x + x**2) / (24 * e * i_y) + (x - x**2 / 2) / shear

    load = 1e-6 / exact(1.0)
    errors = []
    for n in (1, 2, 4):
        model, arm = bar(n, section=section)
        model.clamp(arm.start)
        model.add_line_load(arm, (0, 0, load))
        result = pl.solve_static(model)
        errors.append(abs(result.track(arm.at(place)).position[-1, 2] / (load * exact(place)) - 1))
    tip = result.track(arm.end).position[-1, 2] / 1e-6
    # What is quadratic in a deflection of 1e-6.
    assert record(
        "Timoshenko cantilever, uniform load, tip", tip, 1.0, 1e-6, unit="w/w_T", source="closed form"
    )
    # Within its elements the line is cubic: 1/384 of w h^4/EI is missed.
    assert record("beam, order within elements", orders(errors).mean(), 4.0, 0.6, unit="order")


@pytest.mark.parametrize("section", [BAR, pl.Circle(0.02), pl.Tube(0.02, 0.015), pl.Rectangle(0.04, 0.04)])
def test_torsion_is_saint_venants(record, section):
    model, arm = bar(3, section=section)
    model.clamp(arm.start)
    torque = 1e-6 * shear_modulus(STEEL) * section.torsion_constant
    model.add_moment(arm.end, (torque, 0, 0))
    result = pl.solve_static(model)
    angle = result.track(arm.end).orientation[-1].as_rotvec()
    assert np.abs(angle[1:]).max() < 1e-12
    # A twist of 1e-6: the sine of a third of it is its third.
    assert record(f"torsion of {section}", angle[0] / 1e-6, 1.0, 1e-8, unit="theta/theta_SV")
    # Rounding of a state of size 1 against strains of 1e-6.
    np.testing.assert_allclose(result.strain(arm).curvature[-1], [[1e-6, 0, 0]] * 3, atol=1e-13)


# w/w_Timoshenko of a cantilever, L/h = 20, n = 1, 2, 4, 8, 16: an independent implementation.
CONTINUUM = {
    "none": (0.5577011757095719, 0.6967210705099444, 0.7314760469058127, 0.7401647877331902),
    "poisson": (0.7504769590030397, 0.9376192345470273, 0.9844048123199388, 0.9961011960179335),
}


@pytest.mark.parametrize("locking", CONTINUUM)
def test_laws_of_the_continuum_lock_as_in_the_reference(record, locking):
    for n, expected in zip((1, 2, 4, 8), CONTINUUM[locking], strict=True):
        model, arm = bar(n, [(0, 0, 0), (2, 0, 0)], pl.Rectangle(0.1, 0.1), locking=locking)
        model.clamp(arm.start)
        exact = 8 / (3 * 2.07e11 * 1e-4 / 12) + 2 / (10 * 1.3 / 15.3 * shear_modulus(STEEL) * 0.01)
        model.add_force(arm.end, (0, 0, 1e-7 / exact))
        achieved = pl.solve_static(model).track(arm.end).position[-1, 2] / 1e-7
        # The reference clamps all coordinates, here the section may deform: 4e-4 at one element.
        assert record(f"beam, locking={locking}, {n} elements", achieved, expected, 1e-3, unit="w/w_T")


# Large displacements

# P L^2/EI: tip (x, y) of the inextensible elastica, elliptic integrals with 30 digits.
ELASTICA = {1.0: (0.9435667637166231, 0.3017207737998136), 5.0: (0.6123716392755701, 0.7137915236119128)}
# EI = 1, and so stiff in stretch and shear that these are below 1e-6.
THIN = pl.Section(area=1e7, second_moments=(1.0, 1.0), torsion_constant=0.5, radius=0.01)
UNIT = pl.LinearElastic(youngs_modulus=1.0, poisson_ratio=0.0, density=1e-7)


def refinement(tips) -> float:
    """Order by three meshes, each twice as fine: free of what does not vanish with the mesh."""
    steps = [np.linalg.norm(a - b) for a, b in itertools.pairwise(tips)]
    return float(np.log2(steps[0] / steps[1]))


def test_elastica_converges_with_order_4(record):
    for force, exact in ELASTICA.items():
        tips = []
        for n in (4, 8, 16):
            model, arm = bar(n, section=THIN, material=UNIT)
            model.clamp(arm.start)
            model.add_force(arm.end, (0, force, 0))
            tips.append(pl.solve_static(model, load_steps=4).track(arm.end).position[-1])
        error = float(np.hypot(tips[-1][0] - exact[0], tips[-1][1] - exact[1]))
        # 16 elements turn by up to 0.1 each.
        assert record(f"beam, elastica P = {force:g}, 16 elements", error, 0.0, 2e-5, unit="L")
        name = f"beam, order on elastica P = {force:g}"
        assert record(name, refinement(tips), 4.0, 0.5, unit="order")


def test_end_moment_rolls_a_beam_to_a_circle_with_order_4(record):
    # L/h = 90. The curvature r'.y' scales with the stretch, and a moment compresses the centre line.
    section = pl.Section(area=1e5, second_moments=(1.0, 1.0), torsion_constant=0.5, radius=0.01)
    thickness = 8 * (2 * np.pi) ** 2 / 1e5
    tips = []
    for n in (8, 16, 32):
        model, arm = bar(n, section=section, material=UNIT)
        model.clamp(arm.start)
        model.add_moment(arm.end, (0, 0, 2 * np.pi))
        tips.append(pl.solve_static(model, load_steps=10).track(arm.end).position[-1])
    gap = float(np.linalg.norm(tips[-1]))
    assert record("beam rolled to a circle, L/h = 90, gap", gap, 0.0, 1.1 * thickness, unit="L")
    assert record("beam rolled to a circle, order", refinement(tips), 4.0, 0.4, unit="order")


def rod(force, section, material, curvature, length):
    """Tip of Reissner's rod, an arc in the plane xy clamped along x, under a dead force, by shooting."""
    from scipy.integrate import solve_ivp
    from scipy.optimize import fsolve

    e, g = material.youngs_modulus, shear_modulus(material)
    k_y, k_z = section._shear_corrections(material.poisson_ratio)
    stretch = np.array([e, k_y * g, k_z * g]) * section.area
    bend = np.array([g * section.torsion_constant, *(e * i for i in section.second_moments)])
    rest = np.array([0, 0, curvature])

    def end(moment, part):
        dead = part * np.array(force)

        def slope(s, y):
            axes = y[3:12].reshape(3, 3)
            along = axes @ (np.array([1.0, 0, 0]) + axes.T @ dead / stretch)
            kappa = rest + axes.T @ y[12:] / bend
            spin = np.cross(np.eye(3), kappa)
            return np.concatenate([along, (axes @ spin).ravel(), -np.cross(along, dead)])

        start = np.concatenate([np.zeros(3), np.eye(3).ravel(), moment])
        return solve_ivp(slope, (0, length), start, rtol=1e-9, atol=1e-9).y[:, -1]

    moment, steps = np.zeros(3), 10
    for k in range(1, steps + 1):
        guess = moment * k / max(k - 1, 1)
        moment = fsolve(lambda m, k=k: end(m, k / steps)[12:], guess)
    return end(moment, 1.0)[:3]


# Simo & Vu-Quoc (1986), in the axes of the paper: the arc leaves along y, its centre is on the x axis.
BEND = {300.0: (22.33, 58.84, 40.08), 600.0: (15.79, 47.23, 53.37)}


def test_45_degree_bend_of_bathe_and_bolourchi(record):
    arc = pl.Curve(lambda s: (100 * np.sin(s / 100), 100 * (1 - np.cos(s / 100)), 0), length=25 * np.pi)
    material = pl.LinearElastic(youngs_modulus=1e7, poisson_ratio=0.0, density=1.0)
    section = pl.Rectangle(1, 1)
    model, arm = bar(16, arc, section, material)
    model.clamp(arm.start)
    model.add_force(arm.end, (0, 0, 600.0))
    result = pl.solve_static(model, load_steps=6)
    for force, published in BEND.items():
        row = int(np.argmin(np.abs(result.load_factor - force / 600.0)))
        assert abs(result.load_factor[row] - force / 600.0) < 1e-12
        tip = result.track(arm.end).position[row]
        exact = rod((0, 0, force), section, material, 0.01, arc.length)
        gap = float(np.linalg.norm(tip - exact))
        # Second order: 16 elements that each turn by 0.05 at rest and 0.08 more.
        name = f"45 degree bend, P = {force:g}, 16 elements, against the exact rod"
        assert record(name, gap, 0.0, 0.15, unit="m", source="Reissner's rod, shooting")
        for axis, value in zip("xyz", published, strict=True):
            # Eight straight elements of the paper are 0.35 m from the exact rod.
            own = tip[[1, 0, 2]]["xyz".index(axis)]
            name = f"45 degree bend, P = {force:g}, {axis}"
            assert record(name, own, value, 0.5, unit="m", source="Simo & Vu-Quoc 1986")


# Degrees: u_y, u_z at 8.896 N, then at 13.345 N [m]; beam elements of a commercial program.
PRINCETON = {
    0: (0.010714176, 0.0, 0.016064237, 0.0),
    15: (0.010613287, 0.042082321, 0.016458258, 0.064358129),
    30: (0.010111696, 0.079394829, 0.016658732, 0.117735994),
    45: (0.008837226, 0.108987937, 0.015186184, 0.156467239),
    60: (0.006604665, 0.129887616, 0.011578375, 0.181861627),
    75: (0.003538889, 0.14219437, 0.006248967, 0.196097131),
    90: (0.0, 0.146245978, 0.0, 0.200677707),
}


@pytest.mark.parametrize("degrees", PRINCETON)
def test_princeton_beam(record, degrees):
    aluminium = pl.LinearElastic(youngs_modulus=71.7e9, poisson_ratio=0.31, density=2700.0)
    # The section's y is the stiff direction.
    section = pl.Rectangle(width=12.3777e-3, height=3.2024e-3)
    angle = np.deg2rad(degrees)
    for column, force in ((0, 8.896), (2, 13.345)):
        model, arm = bar(8, [(0, 0, 0), (0.508, 0, 0)], section, aluminium)
        model.clamp(arm.start)
        model.add_force(arm.end, (0, force * np.cos(angle), force * np.sin(angle)))
        tip = pl.solve_static(model, load_steps=4).track(arm.end).position[-1]
        for axis, expected in zip((1, 2), PRINCETON[degrees][column : column + 2], strict=True):
            name = f"Princeton beam, {degrees} degrees, {force} N, u_{'xyz'[axis]}"
            # 0.3 % of the largest deflection there; torsion constant and strain measure differ that much.
            assert record(name, tip[axis], expected, 6e-4, unit="m", source="Obrezkov et al. 2022")


def frame(n: int):
    """A cantilever along x with an arm along y welded to its end, both 1 m."""
    model = pl.Model()
    options = {"elements": n, "section": BAR, "material": STEEL}
    first = model.add_beam([(0, 0, 0), (1, 0, 0)], **options)
    second = model.add_beam([(1, 0, 0), (1, 1, 0)], **options)
    model.clamp(first.start)
    weld = model.weld(first.end, second.start)
    return model, first, second, weld


def test_weld_passes_bending_and_torque_round_a_corner(record):
    model, _, second, weld = frame(1)
    e, g = STEEL.youngs_modulus, shear_modulus(STEEL)
    i_y, area = BAR.second_moments[0], BAR.area
    k = 10 * 1.3 / (12 + 11 * 0.3)
    exact = 2 / (3 * e * i_y) + 1 / (g * BAR.torsion_constant) + 2 / (k * g * area)
    model.add_force(second.end, (0, 0, 1e-5 / exact))
    result = pl.solve_static(model)
    tip = result.track(second.end).position[-1, 2] / 1e-5
    # What is quadratic in a deflection of 1e-5.
    assert record("bent frame, load out of its plane", tip, 1.0, 1e-6, unit="w/w_T", source="closed form")
    reaction = result.reaction(weld)
    # The weld carries the load, and its moment about the corner, on the first beam.
    np.testing.assert_allclose(reaction.force[-1], (0, 0, 1e-5 / exact), rtol=1e-6, atol=1e-12)
    np.testing.assert_allclose(reaction.moment[-1], (1e-5 / exact, 0, 0), rtol=1e-6, atol=1e-6)


def test_torque_of_a_driven_section(record):
    model, arm = bar(16)
    model.clamp(arm.start)
    angle = 0.5
    drive = model.drive(
        arm.end,
        position=(1, 0, 0),
        orientation=lambda t: Rotation.from_rotvec((angle * t, 0, 0)),
    )
    result = pl.solve_static(model, load_steps=2)
    torque = result.reaction(drive).moment[-1, 0]
    exact = shear_modulus(STEEL) * BAR.torsion_constant * angle
    # Sine of a sixteenth of the angle and its derivative: 2/3 of 0.03^2.
    assert record("torque of a beam twisted by half a radian", torque / exact, 1.0, 1e-3, unit="M/M_SV")
    turned = result.track(arm.at(0.5)).orientation[-1].as_rotvec()
    np.testing.assert_allclose(turned, (0.25, 0, 0), atol=1e-9)


def test_tendon_beside_the_axis_bends_the_beam(record):
    model, arm = bar(8)
    model.clamp(arm.start)
    pull, offset = 1e-2, 0.02
    places = [arm.at(s, offset=(0, offset)) for s in np.linspace(0, 1, 9)]
    model.add_tendon(places, tension=pull)
    result = pl.solve_static(model)
    tip = result.track(arm.end).position[-1, 2]
    exact = pull * offset / (2 * STEEL.youngs_modulus * BAR.second_moments[0])
    # The tendon pulls the sections between its points: linear theory, deflections of 1e-8.
    assert record("beam bent by a tendon beside its axis", tip / exact, 1.0, 1e-5, unit="w/w_T")


def test_force_beside_the_axis_is_a_force_and_a_torque():
    model, arm = bar(4)
    wall = model.clamp(arm.start)
    model.add_force(arm.at(1.0, offset=(0.01, 0)), (0, 0, -1.0))
    reaction = pl.solve_static(model).reaction(wall)
    np.testing.assert_allclose(reaction.force[-1], (0, 0, 1.0), atol=1e-9)
    # Against (1, 0.01, 0) x (0, 0, -1); the deflections are below 1e-5.
    np.testing.assert_allclose(reaction.moment[-1], (0.01, -1.0, 0), atol=1e-5)


def test_follower_force_stays_with_the_section(record):
    # Elastica under a follower force normal to the tip: theta'' = -P cos(theta - theta_L), by shooting.
    from scipy.integrate import solve_ivp
    from scipy.optimize import brentq

    force = 2.0

    def wall(end: float):
        def slope(s, y):
            return [y[1], -force * np.cos(y[0] - end), np.cos(y[0]), np.sin(y[0])]

        # y: theta, theta', x, y from the wall; the curvature there is what shooting finds.
        def tip(curvature):
            return solve_ivp(slope, (0, 1), [0, curvature, 0, 0], rtol=1e-11, atol=1e-13).y[:, -1]

        found = brentq(lambda c: tip(c)[1], 0.1, 6)
        return tip(found)

    end = brentq(lambda e: wall(e)[0] - e, 0.3, 1.5)
    expected = wall(end)[2:]
    model, arm = bar(12, section=THIN, material=UNIT)
    model.clamp(arm.start)
    model.add_force(arm.end, (0, force, 0), follower=True)
    tip = pl.solve_static(model, load_steps=4).track(arm.end).position[-1, :2]
    error = float(np.linalg.norm(tip - expected))
    assert record("beam under a follower force, 12 elements", error, 0.0, 3e-5, unit="L", source="shooting")


# Rest shapes in space


def helix(turns: float = 1.0, radius: float = 0.5, pitch: float = 0.4) -> pl.Curve:
    w = 1 / np.hypot(radius, pitch / (2 * np.pi))
    rise = pitch / (2 * np.pi)

    def place(s: float):
        return radius * np.cos(w * s), radius * np.sin(w * s), rise * w * s

    return pl.Curve(place, length=2 * np.pi * turns / w)


def twisted(s: float):
    """Sections of a helix that turn along it: inward, turned about the tangent."""
    curve = helix()
    h = 1e-4
    s = min(max(s, h), curve.length - h)
    a, b = np.array(curve.position(s - h)), np.array(curve.position(s + h))
    tangent = (b - a) / np.linalg.norm(b - a)
    inward = -np.array([a[0] + b[0], a[1] + b[1], 0.0])
    return Rotation.from_rotvec(2.0 * s * tangent).apply(inward / np.linalg.norm(inward))


@pytest.mark.parametrize("up", [(0, 0, 1), twisted])
def test_helix_is_free_of_stress_and_moves_rigidly(up):
    options = {"velocity": (0.3, -1.0, 2.0), "angular_velocity": (1.0, 2.0, 3.0), "up": up}
    # So stiff that centrifugal forces do not bend it.
    stiff = pl.LinearElastic(youngs_modulus=2e13, poisson_ratio=0.3, density=7850.0)
    model, spring = bar(12, helix(), pl.Rectangle(0.01, 0.02), stiff, **options)
    result = pl.simulate(model, duration=0.2, step=0.002, output_every=20)
    kinetic = result.energy.kinetic[0]
    # Rounding: E A times the square of 1e-16.
    assert result.energy.elastic[0] < 1e-12 * kinetic
    # Steel would store a hundredth.
    assert result.energy.elastic.max() < 3e-4 * kinetic
    np.testing.assert_allclose(result.momentum, result.momentum[:1].repeat(len(result.time), 0), rtol=1e-8)
    drift = result.angular_momentum - result.angular_momentum[0]
    # Second order in the step: (3.7 * 0.002)^2 / 12.
    assert np.abs(drift).max() < 1e-4 * np.linalg.norm(result.angular_momentum[0])
    axes = result.track(spring.start).orientation
    turned = (axes[-1] * axes[0].inv()).as_rotvec()
    # Not about a principal axis: the axis wanders by the angle squared.
    np.testing.assert_allclose(turned, 0.2 * np.array([1.0, 2.0, 3.0]), atol=0.1)


def test_free_helix_has_six_rigid_modes_and_no_more():
    model, _ = bar(6, helix(), pl.Rectangle(0.01, 0.02), up=twisted)
    squares = (2 * np.pi * pl.solve_modes(model, count=8).frequencies) ** 2
    # Rounding of the largest eigenvalue, of a section's thickness modes: 1e-15 (c/h)^2.
    assert np.abs(squares[:6]).max() < 1e-3 * squares[6]


def test_uneven_elements_carry_constant_strains_exactly():
    # Patch test: pieces of very different lengths.
    places = [(0, 0, 0), (0.05, 0, 0), (0.6, 0, 0), (0.75, 0, 0), (1, 0, 0)]
    e, g = STEEL.youngs_modulus, shear_modulus(STEEL)
    i_y, i_z = BAR.second_moments
    wrench = {
        "stretch": ((1.0, 0, 0), (0, 0, 0), (1 / (e * BAR.area), 0, 0, 0)),
        "twist": ((0, 0, 0), (1.0, 0, 0), (0, 1 / (g * BAR.torsion_constant), 0, 0)),
        "about y": ((0, 0, 0), (0, 1.0, 0), (0, 0, 1 / (e * i_y), 0)),
        "about z": ((0, 0, 0), (0, 0, 1.0), (0, 0, 0, 1 / (e * i_z))),
    }
    for name, (force, moment, expected) in wrench.items():
        model, arm = bar(6, places)
        model.clamp(arm.start)
        model.add_force(arm.end, 1e-3 * np.array(force))
        model.add_moment(arm.end, 1e-3 * np.array(moment))
        strain = pl.solve_static(model).strain(arm)
        found = np.column_stack([strain.axial[-1], strain.curvature[-1]]) / 1e-3
        # Rounding of coordinates of 1 over strains of 1e-9.
        np.testing.assert_allclose(found, [expected] * arm._body.elements, rtol=1e-4, atol=1e-9, err_msg=name)


# Frequencies


def test_frequencies_of_bending_torsion_and_stretch(record):
    section = pl.Rectangle(width=0.06, height=0.1)
    model, arm = bar(16, section=section)
    model.hinge(arm.start, axis=(0, 1, 0))
    model.hinge(arm.end, axis=(0, 1, 0))
    frequencies = pl.solve_modes(model, count=30).frequencies
    e, g, rho = STEEL.youngs_modulus, shear_modulus(STEEL), STEEL.density
    area, (i_y, i_z) = section.area, section.second_moments
    k = 10 * 1.3 / (12 + 11 * 0.3)

    def nearest(value: float) -> float:
        return float(frequencies[np.argmin(np.abs(frequencies - value))])

    for n in (1, 2, 3):
        # Timoshenko: rho^2 I/(k G) w^4 - (rho A + rho I (1 + E/(k G)) p^2) w^2 + E I p^4 = 0.
        p = n * np.pi
        a, c = rho**2 * i_y / (k * g), e * i_y * p**4
        b = rho * area + rho * i_y * (1 + e / (k * g)) * p**2
        omega = np.sqrt((b - np.sqrt(b * b - 4 * a * c)) / (2 * a))
        exact = omega / (2 * np.pi)
        name = f"beam, bending frequency {n}, both ends hinged, L/h = 10"
        # Linear rotations and shears in elements: (p h)^2/12 of their share p^2 (I/A)(1 + E/(k G)).
        bound = (p / 16) ** 2 / 12 * p**2 * i_y / area * (1 + e / (k * g)) + 1e-5
        assert record(name, nearest(exact) / exact, 1.0, bound, unit="f/f_T", source="Timoshenko")
    for n in (1, 2):
        # Linear twist in elements: 1 + (n pi/16)^2/24.
        exact = n / 2 * np.sqrt(g * section.torsion_constant / (rho * (i_y + i_z)))
        bound = 1.5 * (n * np.pi / 16) ** 2 / 24
        name = f"beam, torsion frequency {n}, both ends held"
        assert record(name, nearest(exact) / exact, 1.0, bound, unit="f/f_SV", source="Saint-Venant")
    exact = 0.5 * np.sqrt(e / rho)
    # Lateral inertia, which the rod has not and the beam has: (nu pi)^2 (i_y + i_z)/(2 A) = 5e-4.
    name = "beam, axial frequency 1, both ends held"
    assert record(name, nearest(exact) / exact, 1.0, 1e-3, unit="f/f_rod", source="closed form")


# Motion


def test_pendulum_falls_as_the_cable_of_the_reference(record):
    # Tip of a cable of the same stiffness (E = 10 MPa, r = 5 mm, L = 1 m) at 0.3 s, an independent solution;
    # shear and rotary inertia, which a cable has not, are (r/L)^2 = 3e-5.
    rubber = pl.LinearElastic(youngs_modulus=1e7, poisson_ratio=0.3, density=1000.0)
    model, arm = bar(24, section=pl.Circle(5e-3), material=rubber, gravity=(0, -9.81, 0))
    model.hinge(arm.start, axis=(0, 0, 1))
    result = pl.simulate(model, duration=0.3, step=1e-3, spectral_radius=0.9, output_every=10)
    tip = result.track(arm.end).position[-1]
    for axis, expected in enumerate(PENDULUM):
        name = f"falling beam pendulum at 0.3 s, {'xyz'[axis]}"
        assert record(name, tip[axis], expected, 3e-4, unit="m", source="independent cable solution")
    total = result.energy.total
    # What the scheme takes of high frequencies, of the energy that has been converted.
    assert np.abs(total - total[0]).max() < 2e-3 * result.energy.kinetic.max()


PENDULUM = (0.7998767084511049, -0.4237366907696046, 0.0)


def test_flexible_spin_up_conserves_what_it_must(record):
    # A free, damped beam in a tumbling throw: momenta stay, energy goes where the audit says.
    rubber = pl.LinearElastic(youngs_modulus=1e7, poisson_ratio=0.3, density=1000.0, retardation_time=2e-3)
    spin = {"velocity": lambda x: np.cross((0, 0, 8.0), x) + np.cross((6.0, 3.0, 0), x * x)}
    model, _ = bar(10, section=pl.Rectangle(0.02, 0.03), material=rubber, **spin)
    result = pl.simulate(model, duration=0.4, step=5e-4, output_every=20)
    energy = result.energy
    scale = energy.kinetic[0]
    assert energy.dissipated[-1] > 1e-3 * scale
    drift = np.abs(energy.total - energy.total[0]).max() / scale
    # Second order in the step.
    assert record("thrown damped beam, energy audit", drift, 0.0, 2e-3, unit="of the kinetic energy")
    momentum = np.abs(result.momentum - result.momentum[0]).max() / np.abs(result.momentum[0]).max()
    assert record("thrown damped beam, momentum", momentum, 0.0, 1e-10, unit="relative")
    spin_drift = np.linalg.norm(result.angular_momentum - result.angular_momentum[0], axis=1).max()
    spin_drift /= np.linalg.norm(result.angular_momentum[0])
    assert record("thrown damped beam, angular momentum", spin_drift, 0.0, 1e-3, unit="relative")
