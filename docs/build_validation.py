"""Write docs/validation.md from the report of a test run.

python docs/build_validation.py target/validation.json
"""

import json
import subprocess
import sys
from itertools import groupby
from pathlib import Path

HERE = Path(__file__).parent

INTRODUCTION = """\
# Validation

What `make validate` compared with references that pliant did not produce, at commit {commit}:
{passed} of {count} comparisons within tolerance. The error is the largest difference, in the quantity's unit.
Tolerances come from the order of the discretisation; each test states the reason. This page is written by
`docs/build_validation.py`.
"""


def number(value: object) -> str:
    """Return a reference or a result as text: a number, or the shape of an array too long to show."""
    if isinstance(value, list):
        flat = json.dumps(value)
        return (
            "(" + ", ".join(number(x) for x in value) + ")"
            if len(value) <= 3 and "[[" not in flat
            else "array"
        )
    return f"{value:.8g}"


def page(notes: list[dict], commit: str) -> str:
    """Return the page as Markdown."""
    parts = [
        INTRODUCTION.format(commit=commit, passed=sum(note["passed"] for note in notes), count=len(notes))
    ]
    for test_file, group in groupby(notes, key=lambda note: note["test"].split("::")[0]):
        parts.append(f"## {test_file}\n")
        parts.append("| case | quantity | reference | achieved | error | tolerance | source |")
        parts.append("| --- | --- | --- | --- | --- | --- | --- |")
        for note in group:
            error = f"{note['error']:.1e}" + ("" if note["passed"] else " **fails**")
            cells = [
                note["name"],
                note["quantity"],
                number(note["reference"]),
                number(note["achieved"]),
                error,
                f"{note['tolerance']:.0e}",
                note["source"],
            ]
            parts.append("| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |")
        parts.append("")
    return "\n".join(parts)


def describe_commit() -> str:
    """Return the short name of the commit, marked where the tree differs from it."""
    command = ["git", "describe", "--always", "--dirty=, with changes", "--exclude=*"]
    return subprocess.run(command, cwd=HERE, check=True, capture_output=True, text=True).stdout.strip()


if __name__ == "__main__":
    report = json.loads(Path(sys.argv[1]).read_text())
    (HERE / "validation.md").write_text(page(report, describe_commit()))
