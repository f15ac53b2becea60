"""The examples at small sizes: they run, the numbers they promise hold, and they draw."""

import importlib
import sys
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import cumulative_trapezoid

EXAMPLES = Path(__file__).parents[2] / "examples"
NAMES = sorted(path.stem for path in EXAMPLES.glob("[!_]*.py"))
SMALL = {
    "quadruped": {
        "cycles": 1,
        "settling": 0,
        "step": 4e-3,
        "members": 2,
        "cases": ("chambers, lag 1/4",),
    },
    "bungee": {"jump": {"elements": 20, "step": 4e-3}, "drop": {"elements": 50, "step": 2e-3}},
    "contact_zones": {"elements": 24, "samples": 1500, "duration": 0.01},
    "crossing_ropes": {"elements": (6, 12, 24), "steps": (1e-3, 5e-4, 2.5e-4), "duration": 0.05},
    "buckling_strut": {"elements": 10, "pushes": (1e-2, 1e-6)},
    "cable_robot": {"elements": 2, "duration": 2.5},
    "cable_slap": {"elements": 60, "step": 5e-4, "duration": 0.3},
    "capstan": {"members": 1, "wrap": 2.0, "elements": 40, "duration": 0.3},
    "catheter": {
        "frictions": (0.2,),
        "lead": 0.04,
        "elements": 24,
        "duration": 0.4,
        "settling": 0.1,
        "step": 8e-3,
    },
    "catenary_bridge": {"panels": 8, "duration": 30.0, "step": 0.04},
    "coiling_tape": {"widths": (1, 6), "along": 20, "across": 4, "duration": 0.3, "step": 4e-3},
    "coil_spring": {"elements": 80, "duration": 0.04, "step": 4e-3},
    "fall_arrester": {"elements": 2, "duration": 0.07, "step": 4e-4, "load_steps": 4},
    "falling_rope": {"elements": 12, "step": 2e-3},
    "flag": {"elements": 4, "duration": 0.2, "steps": (4e-3, 2e-3)},
    "folded_chain": {"elements": 60, "step": 5e-4, "duration": 0.51},
    "friction_rig": {"pull": 11.0, "push": 15.0, "rates": (1.0, 50.0), "angles": (16, 20, 23)},
    "galloping_line": {
        "winds": (1.0, 2.0),
        "elements": 8,
        "amplitude": 0.8,
        "duration": 200.0,
        "step": 8e-2,
    },
    "gantry_crane": {"lengths": (4.0, 5.0), "elements": 2, "step": 2e-2},
    "inflated_cushion": {"elements": 5, "steps": 5, "duration": 0.05, "step": 5e-4},
    "inflated_finger": {"around": 3, "pieces": 3, "steps": 4, "inflow": 1e-5},
    "hanging_chain": {"elements": 50, "step": 1e-2},
    "knot_tightening": {
        "elements": 120,
        "loop": 0.04,
        "length": 0.7,
        "duration": 2.0,
        "rope": {"duration": 2.0, "step": 4e-3},
    },
    "moving_truck": {"elements": 20, "step": 5e-3},
    "net_capture": {"cells": 4, "elements": 2, "duration": 0.45},
    "pendulum_winch": {"haul": 80.0, "duration": 90.0, "step": 2e-2},
    "regrasped_cable": {"step": 8e-3, "duration": 6.0},
    "rolled_cantilever": {"elements": (8, 16)},
    "rolled_strip": {"elements": (6, 12, 24), "kinds": ("bicubic", "cylindrical"), "shown": 12},
    "sliding_cloth": {"cloth": 3, "film": 3, "step": 2e-3, "duration": 0.12},
    "rope_coiling": {"height": 10.0, "turns": 0.8, "step": 4e-3},
    "slider_crank": {"duration": 0.8, "step": 4e-3, "halvings": 1},
    "snapping_shell": {"elements": 12, "excesses": (1e-3, 1e-2), "step": 0.04},
    "soft_finger": {"mesh": (40, 4), "duration": 1.2, "step": 2e-3},
    "solar_sail": {"duration": 0.4},
    "spider_net": {"spokes": 8, "turns": 4, "elements": 2, "duration": 0.1},
    "spinning_top": {
        "duration": 0.4,
        "step": 5e-4,
        "halvings": 1,
        "upright_step": 1e-3,
        "spins": (0.5, 0.85, 1.15),
    },
    "tensegrity": {"duration": 0.5, "step": 2e-3},
}


class Examples(dict):
    """Every example, imported as its neighbours import the shared style, and its small run, when needed."""

    def __missing__(self, name):
        before = list(sys.path)
        sys.path.insert(0, str(EXAMPLES))
        try:
            module = importlib.import_module(name)
        finally:
            sys.path[:] = before
        self[name] = module, module.run(**SMALL[name])
        return self[name]


@pytest.fixture(scope="module")
def examples():
    """Each example's module and small run by its name."""
    return Examples()


def test_every_example_is_tested_and_shown():
    assert set(SMALL) == set(NAMES)
    gallery = (EXAMPLES.parent / "docs/gallery.md").read_text(encoding="utf-8")
    for name in NAMES:
        assert f"python examples/{name}.py" in gallery
        assert f"python examples/{name}.py" in (EXAMPLES / f"{name}.py").read_text(encoding="utf-8")


def audits(numbers):
    """Scenes that an example has run with a step and half of it."""
    held = [numbers, *getattr(numbers, "__dict__", {}).values()]
    return [part for part in held if hasattr(part, "drifts") and hasattr(part, "scene")]


SCENES = [name for name in NAMES if "from _audit import" in (EXAMPLES / f"{name}.py").read_text()]


@pytest.mark.parametrize("name", SCENES)
def test_a_scene_shows_what_is_expected_of_it(name, examples, record):
    _, numbers = examples[name]
    found = audits(numbers)
    assert found
    for audit in found:
        scene = audit.scene
        assert set(scene.expected) <= set(audit.measured)
        for key, (value, tolerance, source) in scene.expected.items():
            label = f"scene {scene.name} (small), {key}"
            assert record(label, audit.measured[key], value, tolerance, source=source)
        assert audit.drifts[1] < audit.drifts[0]


@pytest.mark.parametrize("name", NAMES)
def test_an_example_draws_and_reports(name, examples, tmp_path, monkeypatch, capsys):
    module, numbers = examples[name]
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(module, "run", lambda: numbers)
    module.main()
    said = capsys.readouterr().out
    for path in said.split("look at ")[1].split(" and "):
        assert Path(path.strip()).stat().st_size > 10_000


def test_the_energy_audit_of_the_falling_rope_closes_with_order_2(examples, record):
    _, fall = examples["falling_rope"]
    # Half the step, a quarter of the gap; higher orders in h are worth a few per cent at 1 ms.
    assert record("example falling rope, order of the energy audit", fall.order, 2.0, 0.1)
    assert fall.gaps[-1] < 1e-4
    # The free end of a flexible rope outruns that of a rigid rod.
    assert fall.lowest_speed > 1.2 * fall.rod_speed
    energy = fall.result.energy
    assert np.all(np.diff(energy.dissipated) >= 0)


def test_the_bridge_carries_its_weight(examples, record):
    _, crossing = examples["catenary_bridge"]
    assert record("example bridge, reactions against the weight", crossing.imbalance, 0.0, 1e-8)


def test_a_free_cable_of_the_bridge_hangs_as_a_catenary(examples, record):
    bridge, crossing = examples["catenary_bridge"]
    # A catenary has no bending stiffness; ours lifts the line by the order of EI w/H^2, and the elements' own
    # error is below that.
    weight = bridge.STEEL.density * bridge.MAIN.area * bridge.GRAVITY
    stiffness = bridge.STEEL.youngs_modulus * bridge.MAIN.area
    force, sag = bridge.catenary(crossing.bridge.free_length, bridge.SPAN, weight, stiffness)
    bending = bridge.STEEL.youngs_modulus * bridge.MAIN.second_moments[0]
    tolerance = 2 * bending * weight / force**2
    assert tolerance < 1e-4 * sag
    assert record("example bridge, sag of a free main cable", crossing.sag, sag, tolerance, "m")
    # A shallow cable is nearly a parabola: sag = w L/(8 H) times the span, wrong by (sag/span)^2 in order.
    assert sag == pytest.approx(weight * bridge.SPAN**2 / (8 * force), rel=4 * (sag / bridge.SPAN) ** 2)


def test_the_bridge_rings_at_its_lowest_vertical_mode(examples, record):
    _, crossing = examples["catenary_bridge"]
    frequency = crossing.frequency
    # Other modes move the passages through zero a little.
    assert record("example bridge, ringing", crossing.ringing, frequency, 0.01 * frequency, "Hz")


def test_a_strip_rolls_up_with_order_4(examples, record):
    module, rolling = examples["rolled_cantilever"]
    # The second term of the error is (2 pi/8)^2 times smaller than the first.
    assert record("example roll-up, order of convergence", rolling.order, 4.0, 0.1)
    published = module.PUBLISHED
    assert record("example roll-up, 16 elements", rolling.errors[-1], published, 1e-3 * published, "L")
    # Thin strips: the same error with the default rule, locked with the exact one.
    assert rolling.thin[-1] == pytest.approx(rolling.errors[-1], rel=0.05)
    assert rolling.locking[-1] > 10 * rolling.thin[-1]
    # The nodes of 16 elements lie on the exact arcs within the error of the end.
    along = np.linspace(0, module.LENGTH, rolling.shapes.shape[1])
    for factor, nodes in zip(rolling.factors, rolling.shapes, strict=True):
        assert np.abs(nodes[:, :2] - module.arc(factor, along)).max() < 2 * published


def test_the_net_catches_the_ball_inelastically(examples, record):
    _, caught = examples["spider_net"]
    # Nothing but the pin acts during the blow; what the far ring feels of it is below 1e-6 in this small net.
    assert record("example catch, momentum", caught.momentum_error, 0.0, 1e-6)
    # Differences of energies of 150 J in rounding; the rest of the flight's net is still to 1e-9 m/s.
    assert caught.loss > 0
    assert record("example catch, energy lost", caught.loss, caught.carnot, 1e-9 * 150.0, "J")
    assert 0.1 < caught.depth < 1.0


def test_the_energy_audit_after_the_catch_closes_with_order_2(examples, record):
    _, caught = examples["spider_net"]
    # The jump relaxes in a few of the small steps: the order is reached from below.
    assert record("example catch, order of the energy audit", caught.order, 2.0, 0.25)
    assert caught.gaps[-1] < 1e-3


def test_a_line_that_yields_holds_the_weight(examples, record):
    _, study = examples["fall_arrester"]
    # Waves in the line, which weighs 2.5 kg, are a few per cent of the force.
    for name, caught in (("elastic line", study.elastic), ("line that yields", study.yielding)):
        what = f"example arrester, {name}: largest force on the weight"
        assert record(what, caught.peak, caught.expected, 0.04 * caught.expected, "N")
        assert caught.gaps[1] < 2e-4
    # The damping takes its part.
    drawn, expected = study.yielding.drawn, study.yielding.expected_drawn
    assert record("example arrester, length that stays", drawn, expected, 0.03 * expected, "m")
    # Strains are driven to 1e-12 of the length.
    assert record("example arrester, loops of the piece", study.largest_gap, 0.0, 1e-6)


def test_the_energy_of_the_flag_drifts_with_order_2(examples, record):
    _, fall = examples["flag"]
    # The numerical damping of high frequencies adds to the scheme's own second order.
    assert record("example flag, order of the energy drift", fall.order, 2.0, 0.35)
    assert fall.drifts[-1] < 1e-3


def test_the_cushion_becomes_as_thick_as_published(examples, record):
    _, filling = examples["inflated_cushion"]
    # Five faces along half a side: a percent of the height; published values scatter by half a percent.
    source = "Contri & Schrefler, Kang & Im"
    assert record("example cushion, height", filling.height, 0.2165, 4e-3, "m", source=source)
    energy = filling.quick.energy
    # Second order of the step, while the film snaps from wrinkle to wrinkle.
    assert np.ptp(energy.total) < 0.02 * energy.work[-1]
    mass = filling.quick_gas.mass
    assert mass[-1] == pytest.approx(filling.gas.mass[-1], rel=1e-6)


def test_the_finger_bends_and_the_gas_does_the_work(examples, record):
    _, finger = examples["inflated_finger"]
    # The trapezoidal rule of the work over few steps.
    assert record("example finger, stored energy over work", finger.stored / finger.work, 1.0, 0.02)
    # Ends of the tube, and membrane theory.
    ratio = finger.smooth / finger.expected
    assert record("example finger, curvature of a smooth tube", ratio, 1.0, 0.05, source="closed form")
    assert np.all(np.diff(finger.angle) > 0)
    # Equilibrium, on a half circle of three cubics: 0.17 per cent of its radius inside.
    section = finger.pressure[-1] * np.pi * 0.01**2 / 2
    assert record("example finger, force on its root", -finger.root / section, 1.0, 5e-3, source="statics")


def test_the_spring_sinks_and_turns_as_a_thin_helix(examples, record):
    _, spring = examples["coil_spring"]
    # 16 elements a turn leave 1 %, and a stretch by a twentieth changes the angle of pitch.
    assert record("example spring, deflection", spring.sink, 1.0, 0.03, unit="thin helix")
    # A small difference of twisting and bending, second order: 0.25 left, 0.06 by twice as many.
    assert record("example spring, turn", spring.turn, 1.0, 0.3, unit="thin helix")
    # A third of the spring's mass is an approximation itself.
    assert record("example spring, frequency", spring.frequency, 1.0, 0.02, unit="mass on a spring")
    assert spring.drift < 1e-2


def test_the_strut_buckles_at_eulers_load_into_the_elastica(examples, record):
    _, buckling = examples["buckling_strut"]
    # Ten elements of fourth order; the compression before is worth 2.5e-6.
    assert record("example strut, bifurcation over Euler's load", buckling.critical, 1.0, 1e-5)
    assert record("example strut, end against the elastica", buckling.error, 0.0, 1e-4, unit="L")
    # A push to the side bends the path before the load is reached.
    pushed = buckling.tips[0][:, 1]
    assert np.interp(0.9, buckling.loads[0], pushed) > 0.02


def test_the_tensegrity_finds_the_only_form_that_it_can_have(examples, record):
    _, found = examples["tensegrity"]
    # Newton's tolerance.
    assert record("example tensegrity, twist", found.twist, 5 * np.pi / 6, 1e-6, "rad", source="closed form")
    # Bending stiffness of the cords.
    assert record(
        "example tensegrity, force densities", found.ratio, found.expected, 1e-4, source="closed form"
    )
    # The cords sway as strings, which rods on springs do not: less the lower the frequency.
    assert np.allclose(found.frequencies[:3], found.rods[:3], rtol=5e-3)
    # The lines that catch it get taut with a kink.
    assert found.order > 1.5
    assert found.gaps[-1] < 1e-3


def test_the_errors_of_the_soft_finger_are_predicted(examples, record):
    _, found = examples["soft_finger"]
    assert found.advice.technique == "hybrid"
    for row in found.advice.table[:-1]:
        # Two constants fitted to other bodies leave a point at most.
        name = f"example finger, predicted error of {row.technique}"
        assert record(name, row.error, found.errors[row.technique], 0.01)


def test_the_soft_finger_rests_and_swings_as_its_body(examples, record):
    _, found = examples["soft_finger"]
    # A cable stretches, and 20 elements leave a little: 1e-3 of the length.
    assert record("example finger, cable against elastica", found.at_rest, 0.0, 1.5e-4, "m")
    # Second order of the scheme: (2 pi f h)^2 / 12 and a slight damping.
    assert record("example finger, small swing", found.swing, found.frequency, 3e-3 * found.frequency, "Hz")
    assert found.audit < 0.02


def test_the_robot_hangs_on_its_cables_as_on_springs(examples, record):
    _, followed = examples["cable_robot"]
    # A cable of weight w L hangs through and is longer by (w L/T)^2/24 of itself: 3e-7 m.
    difference = np.linalg.norm(followed.sag - followed.springs)
    assert record("example cable robot, place of the platform", difference, 0.0, 2e-6, "m", source="SciPy")
    assert np.linalg.norm(followed.springs) > 3e-3


def test_the_feedback_of_the_robot_finds_the_path(examples, record):
    _, followed = examples["cable_robot"]
    early = np.searchsorted(followed.result.time, 1.0)
    blind, fed = (followed.errors[name][early] for name in ("blind", "feedback"))
    # The sum over time has a time constant of a quarter of a second: four of them, on a path hardly begun.
    assert np.all(fed < 3 * np.exp(-4.0) * blind)
    # The controller believes in 113 N at least; the load that it does not know takes from that.
    assert followed.tensions.min() > 80.0
    # As the whole path has with order 2; its slow beginning is too close for an order.
    assert followed.gaps[-1] < 6e-6


def test_what_shapers_leave_of_the_swing_is_what_theory_says(examples, record):
    _, moved = examples["gantry_crane"]
    for shaper, swings in moved.swings.items():
        # Angles of 0.3 change the period by (angle/4)^2, which the sum of the moves feels: some thousandths.
        tolerance = 3e-3 * moved.theory["unshaped"][0]
        name = f"example crane, swing left over by {shaper}"
        assert record(name, swings[0], moved.theory[shaper][0], tolerance, "m", source="spectrum of the move")
    # The rope that the shapers believe.
    assert moved.swings["two moves"][1] < 2e-3 * moved.swings["unshaped"][1]
    assert moved.swings["three moves"][1] < 2e-3 * moved.swings["unshaped"][1]


def test_the_load_lifted_on_its_way_swings_as_a_pendulum(examples, record):
    _, moved = examples["gantry_crane"]
    one = moved.lifted["three moves"]
    # The rope weighs 1.4 kg beside 500 kg; 200 steps a period.
    off = np.abs(one.swing - one.expected).max()
    assert record("example crane, swing of the load lifted", off, 0.0, 1e-3, "m", source="SciPy")
    # The weight of half the rope that hangs below the middle of its last element: 2 N, and its stretching.
    pull = np.abs(one.tension - one.pull).max()
    assert record("example crane, pull of the rope", pull, 0.0, 15.0, "N", source="SciPy")
    assert record("example crane, order of the energy audit", moved.order, 2.0, 0.2)
    assert moved.gaps[-1] < 1e-5


def test_the_regrasped_cable_comes_to_rest_as_a_rod(examples, record):
    _, caught = examples["regrasped_cable"]
    # What is left of its motion after three seconds: some 1e-4 of the length, and of its weight of 0.5 N.
    off = np.linalg.norm(caught.at_rest - caught.elastica, axis=1).max()
    assert record("example regrasped cable, shape at rest", off, 0.0, 3e-4, "m", source="solve_bvp")
    difference = np.linalg.norm(caught.force - caught.expected)
    assert record(
        "example regrasped cable, force of the grip", difference, 0.0, 3e-4, "N", source="solve_bvp"
    )
    # The end stops, and with it at most half of the last element.
    weight = 1100.0 * np.pi * 4e-3**2 / 24 / 2
    assert 0 < caught.loss < weight * caught.speed**2 / 2
    # Of the energy of the fall, with steps of 4 ms.
    assert caught.gaps[-1] < 1e-2
    assert caught.gaps[-1] < 0.5 * caught.gaps[0]


def test_a_motor_turns_the_slider_crank_with_order_2(examples, record):
    module, turning = examples["slider_crank"]
    # Three hinges and a slider in a plane: three of the constraints follow from the others.
    assert sum(one.equations for one in turning.driven.model.redundant) == 3
    for key, order in turning.orders.items():
        # Steps of 4 and 2 ms; the next term of the error is (omega h)^2 of the first.
        assert record(
            f"example slider-crank, order of: {key}", order, 2.0, 0.1, source="inverse dynamics, closed form"
        )
    torque = turning.result.reaction(turning.driven.motor).moment[:, 2]
    exact = module.inverse_dynamics(*module.course(turning.result.time))
    # (4 pi/s * 2 ms)^2 of 3.5 N m.
    error = np.abs(torque - exact).max()
    assert record("example slider-crank, torque of the motor", error, 0.0, 1e-3, "N m", source="closed form")
    # Played back without control, that torque turns the crank as prescribed.
    assert turning.errors["way of the piston"][-1] < 1e-2
    assert turning.errors["energy audit"][-1] < 1e-3


def test_inverse_dynamics_of_the_slider_crank_is_that_of_its_energy(examples):
    """What the closed form puts in is what bodies and spring hold, and what friction takes."""
    module, turning = examples["slider_crank"]
    energy, time = turning.result.energy, turning.result.time
    angle, rate, acceleration = module.course(time)
    dx = module.piston_way(angle)[1]
    lost = (module.DAMPING * dx**2 + module.FRICTION) * rate**2
    power = module.inverse_dynamics(angle, rate, acceleration) * rate
    held = energy.kinetic + energy.elastic + energy.gravitational
    # Trapezoidal rule over steps of 2 ms and errors of the run: (omega h)^2 of 2 J.
    work = cumulative_trapezoid(power - lost, time, initial=0)
    np.testing.assert_allclose(held - held[0], work, atol=2e-3)


def test_the_top_nods_and_goes_round_as_lagrange_says(examples, record):
    module, spinning = examples["spinning_top"]
    lagrange = "Lagrange's equations, DOP853"
    # The spin turns 56 mrad and 28 mrad a step.
    assert record("example top, order", spinning.orders[0], 2.0, 0.1, source=lagrange)
    assert record("example top, axis", spinning.errors[-1], 0.0, 1e-3, "rad", source=lagrange)
    # The leading term of the gap still grows with a higher power of the step.
    assert spinning.orders[1] > 1.9
    assert spinning.gaps[-1] < 5e-4
    for name, found in spinning.axes.items():
        # Pushed back it turns fastest.
        assert np.abs(found - spinning.exact[name]).max() < 2e-3, name
    # Second order, (omega h)^2 of the precession.
    rate, nod = spinning.steady
    assert record("example top, steady precession", rate, module.STEADY, 2e-3, "rad/s", source="closed form")
    assert nod < 1e-3


def test_sleeping_tops_lean_as_far_as_energy_and_momentum_let_them(examples, record):
    _, spinning = examples["spinning_top"]
    for ratio, lean in zip(spinning.spins, spinning.leans, strict=True):
        if ratio < 1:
            # Put up with 1 mrad instead of upright; the fastest turn takes 30 steps.
            exact = 2 * np.arccos(ratio)
            assert record(
                f"example top, lean at {ratio:g} n_c", lean, exact, 3e-3, "rad", source="closed form"
            )
        else:
            # It stays within a few times of what it was put up with.
            assert lean < 3e-3


def test_contact_zones_are_those_of_the_samples(examples, record):
    _, zones = examples["contact_zones"]
    # Six crossings, one after the other.
    assert max(map(len, zones.found)) == 6
    for found, sampled in zip(zones.found, zones.sampled, strict=True):
        # Zones shorter than the distance of the samples, 1 mm, are a micrometre deep: g = s^2/(8 R).
        deep = [[gap for gap in gaps if gap < -4e-6] for gaps in (found, sampled)]
        assert len(deep[0]) == len(deep[1])
        # The samples are half a millimetre off at most, the polyline's chords 1e-7.
        np.testing.assert_allclose(*deep, atol=6e-6)
    # Trapezoid over the steps against the scheme's own mean, through the blows.
    assert record("example contact zones, impulse over momentum", zones.balance + 1, 1.0, 0.01)


def test_crossing_ropes_converge(examples, record):
    _, crossing = examples["crossing_ropes"]
    # Only what Newton's iteration leaves is lost.
    assert record("example crossing ropes, drift of momentum", crossing.momentum, 0.0, 1e-7)
    # Less than a thousandth with each step: longer ones are cut at the blow until they leave out no more.
    assert record("example crossing ropes, energy drift at 1 ms", crossing.gaps[0], 0.0, 1e-3)
    assert max(crossing.gaps) < 1e-3
    mesh, step = (
        np.linalg.norm(places[:-1] - places[-1], axis=2).max(axis=1)
        for places in (crossing.by_elements, crossing.by_step)
    )
    # The ropes move by some 80 mm. Six elements cannot follow the bend at the blow; steps are cut there.
    assert record(
        "example crossing ropes, ends and middles, 12 elements against 24", mesh[1], 0.0, 2e-4, unit="m"
    )
    assert mesh[1] < 0.3 * mesh[0]
    assert record(
        "example crossing ropes, ends and middles, 0.5 ms against 0.25", step[1], 0.0, 2e-5, unit="m"
    )
    assert step[1] < 0.5 * step[0]


def test_the_cloth_gets_what_rope_and_film_give(examples, record):
    _, slide = examples["sliding_cloth"]
    # Differences of places at the end, and trapezoids through the blows.
    assert record("example sliding cloth, momentum without impulse", slide.unexplained, 0.0, 0.03)
    assert slide.drifts[1] < slide.drifts[0]
    assert record("example sliding cloth, energy drift", slide.drifts[1], 0.0, 0.05)


def test_the_quadruped_sets_off_as_it_should(examples, record):
    _, study = examples["quadruped"]
    measured = next(iter(study.measured.values()))
    # Momentum changes by the impulses of ground and weight; sampled at output times, 2 % of the weight over
    # a cycle.
    assert record("example quadruped (small), impulse balance", measured["impulse balance"], 0.0, 0.02)
    # Both sides of the robot do the same: rounding, which contact does not amplify within a cycle.
    assert abs(measured["sideways per cycle [mm]"]) < 1e-3
    # The first stroke goes the same way on every ground, and with steps half as long.
    walk = measured["travel per cycle [mm]"]
    assert np.all(study.travels * walk > 0)
    assert record(
        "example quadruped (small), half the step", study.halved["travel per cycle [mm]"] / walk, 1.0, 0.05
    )


def test_a_motor_gives_the_sail_its_angular_momentum(examples, record):
    _, opening = examples["solar_sail"]
    # What Newton's iteration leaves over, of torques that are small until 0.4 s.
    for film, found in (("film", opening.wrinkling), ("elastic film", opening.elastic)):
        name = f"sail opening, {film}, torque"
        assert record(name, found["momentum balance"], 0.0, 1e-7, source="rate of angular momentum")
    sizes, found = opening.sizes, opening.steady
    for place, c in (("base", sizes.base), ("middle", 0.5 * (sizes.base + sizes.half))):
        # What is left of the corners' swings after 0.06 s.
        expected = sizes.tension(c)
        name = f"sail in steady spin, force at its {place}"
        assert record(name, found[f"tension at the {place}"], expected, 1e-2 * expected, "N", "closed form")


def test_shrinkings_are_counted(examples):
    module, _ = examples["solar_sail"]
    assert module.shrinkings(np.array([0.0, 0.5, 1.0, 0.95, 1.0])) == 0
    assert module.shrinkings(np.array([0.0, 1.0, 0.8, 0.7, 0.95, 0.8, 0.9])) == 2


def test_a_shallow_shell_snaps_at_its_limit_load(examples, record):
    module, found = examples["snapping_shell"]
    source = "closed form"
    for name, path, exact in (
        ("limit point", found.low, module.limit(module.LOW)),
        ("bifurcation", found.high, module.bifurcation(module.HIGH)),
    ):
        kind, height, load = path.critical
        assert kind in name
        # The theory of shallow shells: slopes of 0.016 and 0.04, whose square is compared with one.
        tolerance = 2e-3 * exact[1]
        assert record(f"example snapping shell, load of the {name}", load, exact[1], tolerance, source=source)
        assert record(f"example snapping shell, height there ({name})", height, exact[0], 2e-3, source=source)
    # The closed form has one mode of the push; points of the path against a curve of fine pieces.
    assert record("example snapping shell, tipping over", found.branch, 0.0, 1e-2, source=source)


def test_a_shell_hesitates_at_its_limit_point(examples, record):
    module, found = examples["snapping_shell"]
    for one in found.snaps:
        # 0.04 of the time unit a step, second order over ten of them; the limit load is known to 1e-4.
        gap = float(np.abs(one.height - one.mode).max() / module.LOW)
        name = f"example snapping shell, motion {one.excess:g} above the limit"
        assert record(name, gap, 0.0, 2e-2, source="equation of one mode, solve_ivp")
    # What the law leaves out depends on the excess in the next order: one per cent at these excesses.
    assert record("example snapping shell, hesitation over the law", found.hesitation, 1.0, 0.03)
    assert found.drifts[1] < 1e-2
    # Second order.
    assert found.drifts[0] > 3.0 * found.drifts[1]


def test_shells_roll_up_with_order_4(examples, record):
    _, rolls = examples["rolled_strip"]
    for kind in ("bicubic", "cylindrical"):
        # Elements turn by up to a right angle; between 12 and 24 a turn the order is not yet clean.
        name = f"example rolled strip, order of {kind} elements"
        assert record(name, rolls.order(kind, 1), 4.0, 0.1, source="exact equilibrium")
        assert rolls.errors[kind, 2][-1] < 4e-4
    # Bent one way, both are the same functions.
    gap = np.abs(np.subtract(rolls.errors["bicubic", 1], rolls.errors["cylindrical", 1])).max()
    assert record("example rolled strip, bicubic less cylindrical", float(gap), 0.0, 1e-10, unit="L")


def test_a_tape_coils_up_as_its_width_lets_it(examples, record):
    _, coiling = examples["coiling_tape"]
    for width, found, expected in zip(coiling.widths, coiling.found, coiling.expected, strict=True):
        # Four elements across half a tape, 12 along twice its width.
        name = f"example coiling tape, curvature at rest, {width:g} wide"
        assert record(name, found, expected, 5e-3, unit="c", source="Lamb 1891")
    # It swings still, by some hundredths, 0.1 s after its layers have come to rest.
    final = float(coiling.curvature[-1])
    assert record("example coiling tape, curvature in the end", final, coiling.final, 0.1, unit="c")
    # Nothing from outside: Newton's tolerance.
    assert record("example coiling tape, momentum", coiling.momentum, 0.0, 1e-8, source="conservation")
    # Second order in the step.
    assert coiling.drifts[1] < 1e-2
    assert coiling.drifts[0] > 3.0 * coiling.drifts[1]


def test_a_rope_with_friction_stays_tied(examples, record):
    _, study = examples["knot_tightening"]
    assert study.rope.determinants == (3, 3)
    # It springs back a little where it lies on itself, and then stays: bristles hold.
    assert study.rope.kept > 0.75
    assert record("example knot, slip of the tied rope in half a second", study.rope.slip, 0.0, 5e-3)
