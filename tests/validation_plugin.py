"""The fixture ``record``: a verification test hands in what it compared, the run leaves a validation report.

    def test_catenary_sag(record):
        record("catenary", "sag [m]", reference=sag, achieved=rope_sag, tolerance=1e-5, source="closed form")

``record`` asserts ``|achieved - reference| <= tolerance`` and notes the comparison, also a failed one;
``pytest --validation-report FILE`` writes the notes as JSON. ``docs/build_validation.py`` turns them into
docs/validation.md.
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
    """Compare a quantity with its reference, note it for the report, and fail where it is out of tolerance.

    ``reference`` and ``achieved`` are numbers or arrays of one shape, compared in the largest difference;
    ``tolerance`` is absolute, in the quantity's unit; ``source`` says where the reference comes from.
    """

    def compare(name, quantity, reference, achieved, tolerance, source):
        difference = np.abs(np.asarray(achieved, float) - np.asarray(reference, float))
        error = float(np.max(difference))
        passed = bool(np.all(difference <= tolerance))  # not a number never passes
        request.config.stash[NOTES].append(
            {
                "name": name,
                "quantity": quantity,
                "reference": np.asarray(reference, float).tolist(),
                "achieved": np.asarray(achieved, float).tolist(),
                "error": error,
                "tolerance": float(tolerance),
                "source": source,
                "passed": passed,
                "test": request.node.nodeid,
            }
        )
        assert passed, (
            f"{name}, {quantity}: {achieved} instead of {reference} ({source}): "
            f"off by {error:.3g}, allowed {tolerance:.3g}"
        )

    return compare


def pytest_sessionfinish(session):
    path = session.config.getoption("--validation-report")
    if path:
        target = Path(path)
        target.parent.mkdir(parents=True, exist_ok=True)
        notes = sorted(session.config.stash[NOTES], key=lambda note: (note["test"], note["quantity"]))
        target.write_text(json.dumps(notes, indent=1) + "\n")
