"""The interactive page in a real browser: it draws, plays, turns, and complains of nothing."""

from __future__ import annotations

import time
from collections.abc import Iterator
from pathlib import Path

import browser
import numpy as np
import pliant as pl
import pytest


@pytest.fixture(scope="module")
def page() -> Iterator[browser.Browser]:
    path = browser.find()
    if path is None:
        pytest.skip(f"needs a browser: one of {', '.join(browser.NAMES)} on the PATH")
    window = browser.Browser(path)
    yield window
    window.close()


def swing() -> pl.Result:
    model = pl.Model(gravity=(0, 0, -9.81))
    rubber = pl.LinearElastic(1e7, 0.45, 1000.0)
    rope = model.add_cable(
        [(0, 0, 0), (1, 0, 0)], elements=8, section=pl.Circle(8e-3), material=rubber, name="rope"
    )
    model.pin(rope.start, name="hook")
    shape = pl.Box((0.2, 0.1, 0.1))
    plate = model.add_rigid_body(density=500.0, shape=shape, position=(1.1, 0, 0), name="plate")
    model.hinge(rope.end, plate, axis=(0, 1, 0), name="axle")
    model.add_force(plate.at((0.1, 0, 0)), (0, 3.0, 0), follower=True, name="jet")
    model.add_point_mass(0.1, at=(0.5, 0.5, 0.2), velocity=(0, 0, 2), name="ball")
    model.add_obstacle(pl.HalfSpace(), position=(0, 0, -0.9), name="ground")
    model.add_obstacle(pl.Sphere(0.1), position=(0.5, 0.3, -0.6), name="stone")
    model.add_obstacle(pl.Bore([(0.3, 0, 0), (0.7, 0, 0)], radius=0.05), name="guide")
    return pl.simulate(model, duration=0.5, step=2e-3, output_every=5)


def different(one: np.ndarray, other: np.ndarray) -> int:
    """Pixels of the stage that differ."""
    return int((np.abs(one - other).max(axis=2)[:660] > 0.08).sum())


@pytest.mark.slow
def test_the_page_draws_plays_and_turns(tmp_path: Path, page: browser.Browser) -> None:
    swing().export_html(tmp_path / "page.html", color="speed")
    page.open(tmp_path / "page.html")
    page.run("playing && document.getElementById('play').click()")
    seek = (
        "(s => {{ s.value = {}; s.dispatchEvent(new Event('input')); }})(document.getElementById('slider'))"
    )
    page.run(seek.format(0))
    first, _ = page.picture()
    # Coloured things on a grey ground: the spread of the channels tells them.
    assert (np.ptp(first, axis=2)[60:600] > 0.2).sum() > 1000
    page.run(seek.format(40))
    assert page.run("document.getElementById('time').textContent") == "0.400 s"
    later, _ = page.picture()
    assert different(first, later) > 500
    # Obstacles are seen through, the things behind them, too.
    page.run("hidden = scenery.splice(0), render()")
    bare, _ = page.picture()
    assert different(later, bare) > 500
    page.run("scenery.push(...hidden), render()")
    assert different(later, page.picture()[0]) < 50
    # Play goes on from there; pause holds.
    page.run("document.getElementById('play').click()")
    time.sleep(0.6)
    page.run("document.getElementById('play').click()")
    shown = page.run("frame")
    assert shown != 40
    time.sleep(0.2)
    assert page.run("frame") == shown
    # Orbit, pan and zoom change the picture, "Reset view" brings it back.
    page.run(seek.format(20))
    still, _ = page.picture()
    for act in (
        lambda: page.drag((500, 300), (620, 340)),
        lambda: page.drag((500, 300), (560, 330), modifiers=8),
        lambda: page.wheel((500, 300), 240),
    ):
        act()
        time.sleep(0.1)
        assert different(still, page.picture()[0]) > 500
        page.run("document.getElementById('home').click()")
        assert different(still, page.picture()[0]) < 50
    # Arrows and traces come and go, every colour can be chosen.
    for box in ("arrows", "trail"):
        page.run(f"document.getElementById('{box}').click()")
        assert different(still, page.picture()[0]) > 50, box
        page.run(f"document.getElementById('{box}').click()")
    for color in ("", "strain", "axial_force"):
        page.run(f"(c => {{ c.value = '{color}'; c.onchange(); }})(document.getElementById('color'))")
        assert different(still, page.picture()[0]) > 50, color
    assert page.run("gl.getError()") == 0
    assert not page.errors
    assert page.requests == [(tmp_path / "page.html").resolve().as_uri()]
