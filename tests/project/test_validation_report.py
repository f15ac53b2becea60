"""The validation report says what was compared, and fails where it should."""

import importlib.util
import math
from pathlib import Path

import pytest
from validation_plugin import NOTES

DOCS = Path(__file__).parents[2] / "docs"


@pytest.fixture
def unlisted(request):
    """Keep the comparisons of these tests out of the report."""
    notes = request.config.stash[NOTES]
    before = len(notes)
    yield lambda: notes[before:]
    del notes[before:]


def test_comparison_within_tolerance_is_noted(record, unlisted):
    assert record("area of a circle", 3.1416, math.pi, 1e-5, unit="m^2", source="closed form")
    (note,) = unlisted()
    assert note["passed"]
    assert note["error"] == pytest.approx(3.1416 - math.pi)


@pytest.mark.parametrize("achieved", [3.2, math.nan, [math.pi, 3.2], [math.nan, math.pi]])
def test_comparison_out_of_tolerance_fails_and_is_noted(record, unlisted, achieved):
    with pytest.raises(AssertionError, match="area of a circle"):
        record("area of a circle", achieved, math.pi, 1e-2)
    assert not unlisted()[0]["passed"]


@pytest.fixture
def script():
    """Return the script that writes the page, as a module."""
    spec = importlib.util.spec_from_file_location("build_validation", DOCS / "build_validation.py")
    script = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(script)
    return script


def test_lines_of_rust_tests_are_read(script):
    text = 'running 1 test\ntest order ... validation: {"name": "order of q", "test": "a.rs"}\nok'
    assert script.printed(text) == [{"name": "order of q", "test": "a.rs"}]


def test_page_shows_every_comparison(script):
    note = {
        "name": "area",
        "reference": [1.0, 2.0],
        "achieved": 2.0,
        "error": 1.0,
        "tolerance": 0.5,
        "unit": "m^2",
        "source": "a | b",
        "passed": False,
        "test": "tests/x/test_circle.py::test_y",
        "about": "Circles.",
    }
    text = script.page([note], "abc1234")
    assert "![" not in text
    assert "0 of 1" in text
    assert "## Circle\n\nCircles. (`tests/x/test_circle.py`)" in text.replace("\n\n\n", "\n\n")
    assert "| area | (1, 2) | 2 | 1.0e+00 **fails** | 5.0e-01 | m^2 | a \\| b |" in text


def test_page_shows_the_pictures_of_its_tests(script):
    for test_file, (picture, _) in script.PICTURES.items():
        assert (DOCS / picture).is_file()
        assert (DOCS.parent / test_file).is_file()
        number = {"reference": 1.0, "achieved": 1.0, "error": 0.0, "tolerance": 0.1, "passed": True}
        note = {
            "name": "w",
            "unit": "m",
            "source": "",
            "test": f"{test_file}::test_x",
            "about": "A.",
            **number,
        }
        assert f"({picture})" in script.page([note], "abc1234")
