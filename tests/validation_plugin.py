"""The fixture ``record``: a verification test hands in what it compared, the run leaves a validation report.

    def test_sag(record):
        assert record("catenary, sag", sag, 3.0, 4e-5, unit="m", source="closed form")

``record`` notes the comparison ``|achieved - reference| <= tolerance`` and fails, saying by how much, if it
does not hold. ``pytest --validation-report FILE`` writes the notes as JSON, those of failed comparisons, too;
``docs/build_validation.py`` turns them into docs/validation.md.
"""

import json
from pathlib import Path

import numpy as np
import pytest

NOTES = pytest.StashKey[list]()


def pytest_addoption(parser):
    parser.addoption("--validation-report", metavar="FILE", help="write what `record` was given as JSON")


def pytest_configure(config):
    config.stash[NOTES] = []


@pytest.fixture
def record(request):
    """Return the function that compares a quantity with its reference and notes it for the report.

    ``achieved`` and ``reference`` are numbers or arrays of one shape, compared in the largest difference;
    ``tolerance`` is absolute, in the quantity's ``unit``; ``source`` says where the reference comes from,
    where the test's file does not.
    """

    def compare(name, achieved, reference, tolerance, unit="", source=""):
        difference = np.abs(np.asarray(achieved, float) - np.asarray(reference, float))
        error = float(np.max(difference))
        passed = bool(np.all(difference <= tolerance))  # not a number never passes
        request.config.stash[NOTES].append(
            {
                "name": name,
                "achieved": np.asarray(achieved, float).tolist(),
                "reference": np.asarray(reference, float).tolist(),
                "error": error,
                "tolerance": float(np.max(tolerance)),
                "unit": unit,
                "source": source,
                "passed": passed,
                "test": request.node.nodeid,
                "about": (request.module.__doc__ or "").strip().split("\n")[0],
            }
        )
        assert passed, (
            f"{name}: {achieved} instead of {reference}, off by {error:.3g} {unit}, allowed {tolerance:.3g}"
        )
        return passed

    return compare


def pytest_sessionfinish(session):
    path = session.config.getoption("--validation-report")
    if path:
        target = Path(path)
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_text(json.dumps(session.config.stash[NOTES], indent=1) + "\n")
