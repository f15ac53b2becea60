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
    record("circle", "area", reference=math.pi, achieved=3.1416, tolerance=1e-5, source="closed form")
    (note,) = unlisted()
    assert note["passed"]
    assert note["error"] == pytest.approx(3.1416 - math.pi)


@pytest.mark.parametrize("achieved", [3.2, math.nan, [math.pi, 3.2], [math.nan, math.pi]])
def test_comparison_out_of_tolerance_fails_and_is_noted(record, unlisted, achieved):
    with pytest.raises(AssertionError, match="circle, area"):
        record("circle", "area", reference=math.pi, achieved=achieved, tolerance=1e-2, source="closed form")
    assert not unlisted()[0]["passed"]


def test_page_shows_every_comparison():
    spec = importlib.util.spec_from_file_location("build_validation", DOCS / "build_validation.py")
    script = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(script)
    note = {"name": "circle", "quantity": "area", "reference": [1.0, 2.0], "achieved": 2.0, "error": 1.0,
            "tolerance": 0.5, "source": "a | b", "passed": False, "test": "tests/x.py::test_y"}  # fmt: skip
    text = script.page([note], "abc1234")
    assert "0 of 1" in text
    assert "| circle | area | (1, 2) | 2 | 1.0e+00 **fails** | 5e-01 | a \\| b |" in text
