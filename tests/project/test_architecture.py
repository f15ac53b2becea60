"""ARCHITECTURE.md is true: its names exist, every source file is named, and the floors hold."""

import json
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from tree import ROOT, read, tracked_files

# What each crate may use of the others, and the crates that only one of them may name.
FLOORS = {
    "pliant-math": set(),
    "pliant-elements": {"pliant-math"},
    "pliant-contact": {"pliant-math"},
    "pliant-dae": {"pliant-math"},
    "pliant-multibody": {"pliant-math", "pliant-elements", "pliant-contact", "pliant-dae"},
    "pliant-python": {
        "pliant-math",
        "pliant-elements",
        "pliant-contact",
        "pliant-dae",
        "pliant-multibody",
    },
}
ONLY_IN = {
    "faer": {"pliant-dae"},
    "parry3d-f64": {"pliant-contact"},
    "pyo3": {"pliant-python"},
    "numpy": {"pliant-python"},
}


def rooms():
    """Yield (folder, name) for every name in the rooms of the page."""
    block = re.search(r"```text\n(.*?)```", read("ARCHITECTURE.md"), re.S).group(1)
    folder = None
    for line in filter(str.strip, block.splitlines()):
        if line.startswith(" "):
            names = re.split(r"\s{2,}", line.strip(), maxsplit=1)[0]
            for name in names.split():
                yield folder, name
        else:
            folder = Path(line.strip())


def found(folder, name):
    """Tell whether a name of the page is a module, file or folder of the tree."""
    path = ROOT / folder / name
    return path.exists() or any(path.with_name(name + suffix).exists() for suffix in (".rs", ".py"))


def test_every_name_of_the_page_exists():
    missing = [f"{folder}/{name}" for folder, name in rooms() if not found(folder, name)]
    assert not missing


def test_every_source_file_is_named():
    named = {(folder, name.split(".")[0]) for folder, name in rooms()}
    folders = {folder for folder, _ in named if "src" in folder.parts or folder.parts[0] == "python"}
    for path in tracked_files():
        for folder in folders:
            if folder in path.parents:
                top = path.relative_to(folder).parts[0].split(".")[0]
                assert top in ("lib", "py", "__init__") or (folder, top) in named, (
                    f"{path} is not on the page"
                )


def test_every_crate_has_a_floor():
    assert {path.name for path in (ROOT / "crates").iterdir() if (path / "Cargo.toml").exists()} == set(
        FLOORS
    )


@pytest.mark.skipif(shutil.which("cargo") is None, reason="needs cargo")
def test_crates_use_only_lower_floors():
    command = ["cargo", "metadata", "--format-version", "1", "--no-deps", "--offline"]
    output = subprocess.run(command, cwd=ROOT, check=True, capture_output=True, text=True).stdout
    for package in json.loads(output)["packages"]:
        name = package["name"]
        uses = {d["name"] for d in package["dependencies"] if d["kind"] is None}
        in_tests = {d["name"] for d in package["dependencies"]}
        # Tests of the solver use the vectors of floor 0; no floor may look up, tests included.
        assert in_tests & set(FLOORS) <= FLOORS[name], name
        for crate, homes in ONLY_IN.items():
            assert crate not in uses or name in homes, f"{name} uses {crate}"


@pytest.mark.parametrize("crate", sorted(set(FLOORS) - {"pliant-python"}))
def test_unsafe_is_forbidden_outside_the_binding(crate):
    assert re.search(r"\[lints\]\s+workspace = true", read(f"crates/{crate}/Cargo.toml"))
    assert 'unsafe_code = "forbid"' in read("Cargo.toml")


def test_solver_knows_no_mechanics():
    words = re.compile(r"\b(cable|beam|rope|contact|gravity|pliant_elements|pliant_multibody)\b", re.I)
    for path in tracked_files():
        if path.suffix == ".rs" and path.is_relative_to("crates/pliant-dae/src"):
            match = words.search(read(path))
            assert match is None, f"{path} speaks of {match.group()}"


def test_faer_is_named_in_the_solver_only():
    for path in tracked_files():
        if path.suffix == ".rs" and not path.is_relative_to("crates/pliant-dae"):
            assert not re.search(r"\bfaer::", read(path)), path


def test_parry_is_named_in_its_files():
    naming = [
        path for path in tracked_files() if path.suffix == ".rs" and re.search(r"\bparry3d_f64\b", read(path))
    ]
    assert sorted(path.name for path in naming) == ["broad_phase.rs", "manifolds.rs", "meshes.rs"]


def test_python_floors():
    linter = pytest.importorskip("importlinter.cli")
    command = [
        sys.executable,
        "-c",
        f"from {linter.__name__} import lint_imports_command as c; c()",
        "--no-cache",
    ]
    run = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, encoding="utf-8", check=False)
    assert run.returncode == 0, run.stdout + run.stderr
