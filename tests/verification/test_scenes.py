"""The closed forms that scenes are measured by, and scenes in other sizes than their own."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pliant as pl
import pytest
from pliant import scenes


def test_a_load_without_weight_hangs_in_the_catenary():
    law = 204.0, 200.0, 30.0, 6e7
    _, _, sag = scenes.elastic_catenary(*law)
    x, depth = scenes.loaded_catenary(*law, load=1e-6, place=102.0)
    # A millionth of a newton in six thousand; the solver's tolerance.
    assert x == pytest.approx(100.0, abs=1e-6)
    assert depth == pytest.approx(sag, abs=1e-6)


def test_a_heavy_load_hangs_in_two_straight_lines():
    x, depth = scenes.loaded_catenary(204.0, 200.0, 1e-3, 1e12, load=1e5, place=51.0)
    # A triangle of sides 51, 153 and 200 m; the weight of the lines is a millionth of the load.
    side = (51.0**2 - 153.0**2 + 200.0**2) / 400.0
    assert x == pytest.approx(side, abs=1e-2)
    assert depth == pytest.approx(np.sqrt(51.0**2 - side**2), abs=1e-2)


def test_a_cord_of_little_mass_stops_a_weight_as_a_spring():
    speed, mass, stiffness = 10.0, 80.0, 120.0
    time = np.linspace(0.0, 3.0, 3001)
    omega = np.sqrt(stiffness / mass)
    rest = 9.81 / omega**2
    spring = stiffness * (speed / omega * np.sin(omega * time) + rest * (1 - np.cos(omega * time)))
    for tension in scenes.stopping_tension(time, speed, mass, stiffness, cord_mass=1e-3):
        # Waves of impedance sqrt(k m_c) = 0.35 kg/s times the speed, to and fro.
        assert np.abs(tension - spring).max() < 8.0


def test_the_first_wave_is_doubled_at_the_anchor():
    impedance, delay = np.sqrt(120.0 * 3.0), np.sqrt(3.0 / 120.0)
    time = delay * np.array([0.001, 0.99, 1.01])
    weight, anchor = scenes.stopping_tension(time, 10.0, 1e9, 120.0, 3.0, gravity=0.0)
    # A weight so heavy that it is not slowed down.
    assert np.allclose(weight, impedance * 10.0, rtol=1e-6)
    assert np.allclose(anchor, [0.0, 0.0, 2 * impedance * 10.0], rtol=1e-6)


def test_lift_that_rises_with_the_angle_never_gallops():
    scene = scenes.galloping_line(lift_slope=0.5, elements=6)
    assert scene.expected["onset"].value == np.inf
    values = pl.solve_modes(scene.model, count=4, about=scene.start).eigenvalues
    assert values.real.max() < 0


def test_an_energy_that_comes_from_nowhere_is_seen():
    model = pl.Model(gravity=(0, 0, -9.81))
    model.add_point_mass(1.0, at=(0, 0, 0))
    fall = pl.simulate(model, duration=1.0, step=1e-2)
    # A parabola is exact.
    assert scenes.energy_drift(fall) < 1e-12
    energy = fall.energy
    energy.dissipated[-1] = 0.1 * energy.kinetic[-1]
    assert scenes.energy_drift(SimpleNamespace(energy=energy)) == pytest.approx(0.1, rel=1e-9)


def test_a_scene_tells_which_measures_fail():
    scene = scenes.falling_rope(elements=4, duration=0.1, step=1e-2)
    assert scene.start is None
    measured = {"energy drift": 1.0, "momentum balance": np.nan, "hook gap": 0.0}
    assert scene.failures(measured) == ["energy drift", "momentum balance"]
    assert scene.report(measured).count("FAIL") == 2


def test_a_scene_refuses_a_colour_that_pictures_do_not_have():
    scene = scenes.falling_rope(elements=4, duration=0.1, step=1e-2)
    with pytest.raises(pl.ModelError, match="color"):
        replace(scene, color="curvature")


def test_a_string_that_misses_the_post_swings_freely():
    length, speed = 12.0, 60.0
    time = np.linspace(0.0, 0.8, 8001)
    way, impulse = scenes.string_and_post(time, length, speed, 3.0, 0.3, 1 / 3, gap=1.0)
    assert not impulse.any()
    # After half a period a string has the shape of its start, turned over in both directions.
    half = round(length / speed / 1e-4)
    assert way[0] == pytest.approx(0.3 * 0.5 / (2 / 3))
    assert way[half] == pytest.approx(-way[0])
    assert np.allclose(way[2 * half :], way[: len(way) - 2 * half], atol=1e-12)


def test_a_string_lies_on_the_post_until_waves_take_it_away():
    length, speed, impedance = 12.0, 60.0, 3.0
    time = np.linspace(0.0, 0.3, 30001)
    way, impulse = scenes.string_and_post(time, length, speed, impedance, 0.3, 1 / 3, gap=0.02)
    assert way.min() == pytest.approx(-0.02, abs=1e-12)
    pushing = np.diff(impulse) > 0
    assert np.all(way[1:][pushing] == pytest.approx(-0.02, abs=1e-12))
    # The middle strikes with the velocity of the passing kinks, c times half the bend of the pluck, and is
    # stopped at once: the post's force is 2 Z times that.
    bend = 0.3 / 4.0 + 0.3 / 8.0
    force = np.diff(impulse)[pushing] / time[1]
    assert np.median(force) == pytest.approx(2 * impedance * speed * bend / 2, rel=1e-9)
