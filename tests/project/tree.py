"""The repository as the tests of this folder see it."""

import subprocess
from functools import cache
from pathlib import Path

ROOT = Path(__file__).parents[2]


@cache
def tracked_files():
    """Return the files of the repository, as paths relative to its root."""
    try:
        command = ["git", "ls-files", "--cached", "--others", "--exclude-standard"]
        names = subprocess.run(command, cwd=ROOT, check=True, capture_output=True, text=True).stdout.split(
            "\n"
        )
    except (OSError, subprocess.CalledProcessError):  # an unpacked archive
        skip = {"target", "out", "dist", "__pycache__"}
        names = [
            str(p.relative_to(ROOT))
            for p in ROOT.rglob("*")
            if not any(part in skip or part.startswith(".") for part in p.relative_to(ROOT).parts)
        ]
    return sorted(Path(name) for name in names if name and (ROOT / name).is_file())


def read(path):
    """Return the text of a file of the repository."""
    return (ROOT / path).read_text(encoding="utf-8")
