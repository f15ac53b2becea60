"""Write docs/validation.md from the reports of test runs.

python docs/build_validation.py target/validation.json target/validation-rust.txt

The first is what pytest wrote, the second what the Rust tests printed: JSON after `validation:` for each
comparison.
"""

import json
import subprocess
import sys
from itertools import groupby
from pathlib import Path

HERE = Path(__file__).parent

# What is drawn of the comparisons of a test file, and where: the picture and what it shows.
PICTURES = {
    "tests/verification/test_sze.py": (
        "images/shell_benchmarks.png",
        "Load over deflection of nine shell problems: lines as computed, circles from the published tables; "
        "crosses are limit points (`docs/build_shells.py`)",
    ),
}

INTRODUCTION = """\
# Validation

What `make validate` compared with references that pliant did not produce, at commit {commit}:
{passed} of {count} comparisons within tolerance. The error is the largest difference, in the quantity's unit.
Tolerances come from the order of the discretisation; each test states the reason. This page is written by
`docs/build_validation.py`.
"""


def number(value: object) -> str:
    """Return a reference or a result as text: numbers, or the size of an array too long to show."""
    if not isinstance(value, list):
        return f"{value:.8g}"
    if len(value) <= 3 and not any(isinstance(x, list) for x in value):
        return "(" + ", ".join(map(number, value)) + ")"
    return f"{len(value)} rows"


def page(notes: list[dict], commit: str) -> str:
    """Return the page as Markdown."""
    passed = sum(note["passed"] for note in notes)
    parts = [INTRODUCTION.format(commit=commit, passed=passed, count=len(notes))]
    for test_file, group in groupby(notes, key=lambda note: note["test"].split("::")[0]):
        group = list(group)
        parts += [f"## {Path(test_file).stem.removeprefix('test_').replace('_', ' ').capitalize()}\n"]
        parts += [f"{group[0]['about']} (`{test_file}`)\n"]
        if test_file in PICTURES:
            picture, shown = PICTURES[test_file]
            parts += [f"![{shown.split(' (')[0]}]({picture})\n", f"{shown}.\n"]
        sourced = any(note["source"] for note in group)
        parts += ["| quantity | reference | achieved | error | tolerance | unit |" + sourced * " source |"]
        parts += ["| --- " * (6 + sourced) + "|"]
        for note in group:
            cells = [
                note["name"],
                number(note["reference"]),
                number(note["achieved"]),
                f"{note['error']:.1e}" + ("" if note["passed"] else " **fails**"),
                f"{note['tolerance']:.1e}",
                note["unit"],
                *[note["source"]] * sourced,
            ]
            parts += ["| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |"]
        parts += [""]
    return "\n".join(parts)


def describe_commit() -> str:
    """Return the short name of the commit, marked where the tree differs from it."""
    command = ["git", "describe", "--always", "--dirty=, with changes", "--exclude=*"]
    return subprocess.run(command, cwd=HERE, check=True, capture_output=True, text=True).stdout.strip()


def printed(text: str) -> list[dict]:
    """Return the comparisons that Rust tests printed, test files together."""
    lines = (line.partition("validation: ")[2] for line in text.splitlines())
    return sorted((json.loads(line) for line in lines if line), key=lambda note: (note["test"], note["name"]))


if __name__ == "__main__":
    report = json.loads(Path(sys.argv[1]).read_text())
    for path in sys.argv[2:]:
        report += printed(Path(path).read_text())
    (HERE / "validation.md").write_text(page(report, describe_commit()))
