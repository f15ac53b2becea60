"""What is shipped: the stub matches the compiled module, the wheel stays small, files are clean."""

import ast
import importlib.util
import inspect
import re
import subprocess
import sys
import zlib
from pathlib import Path

import pytest
from pliant import _core as core
from tree import ROOT, read, tracked_files

STUB = ast.parse(read("python/pliant/_core.pyi"))


def arguments_of(function):
    """Return (name, kind, has a default) of the arguments of a function in the stub, without self."""
    a = function.args
    plain = [*a.posonlyargs, *a.args]
    defaults = [None] * (len(plain) - len(a.defaults)) + list(a.defaults)
    rows = [(p.arg, "positional", d is not None) for p, d in zip(plain, defaults, strict=True)]
    rows += [(p.arg, "keyword", d is not None) for p, d in zip(a.kwonlyargs, a.kw_defaults, strict=True)]
    return [row for row in rows if row[0] != "self"]


def arguments_of_compiled(function):
    """Return the same of a compiled function."""
    kinds = {inspect.Parameter.KEYWORD_ONLY: "keyword"}
    rows = [
        (p.name, kinds.get(p.kind, "positional"), p.default is not p.empty)
        for p in inspect.signature(function).parameters.values()
    ]
    return [row for row in rows if row[0] != "self"]


def test_stub_names_what_the_core_offers():
    typed_only = {
        n.name
        for n in STUB.body
        if isinstance(n, ast.ClassDef) and any(getattr(b, "id", "") == "TypedDict" for b in n.bases)
    }
    stub = {n.name for n in STUB.body if isinstance(n, ast.ClassDef | ast.FunctionDef)} - typed_only
    compiled = {name for name in dir(core) if not name.startswith("_")}
    assert stub == compiled


def test_stub_signatures_match():
    for node in STUB.body:
        if isinstance(node, ast.FunctionDef):
            assert arguments_of(node) == arguments_of_compiled(getattr(core, node.name)), node.name
        if not isinstance(node, ast.ClassDef) or not hasattr(core, node.name):
            continue
        kind = getattr(core, node.name)
        if issubclass(kind, BaseException):
            continue
        for part in node.body:
            if not isinstance(part, ast.FunctionDef):
                continue
            where = f"{node.name}.{part.name}"
            if part.name == "__init__":
                assert arguments_of(part) == arguments_of_compiled(kind), where
            elif any(getattr(d, "id", "") == "property" for d in part.decorator_list):
                assert inspect.isgetsetdescriptor(inspect.getattr_static(kind, part.name)), where
            else:
                assert arguments_of(part) == arguments_of_compiled(getattr(kind, part.name)), where
        named = {part.name for part in node.body if isinstance(part, ast.FunctionDef)}
        assert {name for name in vars(kind) if not name.startswith("_")} <= named, node.name


def test_wheel_would_be_below_8_megabytes():
    # A wheel is a zip archive: the extension, compressed, is nearly all of it.
    size = len(zlib.compress(Path(core.__file__).read_bytes(), 6))
    size += sum(p.stat().st_size for p in (ROOT / "python/pliant").rglob("*.py"))
    assert size < 8e6


def test_version_is_the_same_everywhere():
    version = re.search(r'^version = "(.*)"', read("Cargo.toml"), re.M).group(1)
    assert core.__version__ == version
    assert f"version: {version}" in read("CITATION.cff")
    assert f"## {version}" in read("CHANGELOG.md")


def test_import_loads_nothing_heavy():
    code = (
        "import sys, pliant; print([m for m in ('scipy', 'matplotlib', 'h5py', 'tqdm') if m in sys.modules])"
    )
    run = subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True)
    assert run.stdout.strip() == "[]"


# Spelled in pieces, so that this file passes.
FORBIDDEN = {
    "a path of one machine": re.compile(r"(?<![\w.<])/(work|root|home/\w|Users/\w|mnt/\w)/?"),
    "a host of a package registry": re.compile(
        r"(pypi\.org|pythonhosted\.org|static\.crates\.io|index\.crates\.io|proxy\.golang)"
    ),
    "a note to self": re.compile(r"\b(TO" + r"DO|FIX" + r"ME|X" + r"XX)\b"),
    "a conflict": re.compile(r"^(<{7}|>{7}) ", re.M),
}
LARGEST = 300_000  # bytes


@pytest.mark.parametrize("what", FORBIDDEN)
def test_no_file_holds(what):
    for path in tracked_files():
        if path != Path(__file__).relative_to(ROOT) and path.name != "Cargo.lock":
            content = (ROOT / path).read_bytes()
            if b"\0" in content:  # a picture: its bytes say nothing
                continue
            match = FORBIDDEN[what].search(content.decode("utf-8", errors="ignore"))
            assert match is None, f"{path}: {match.group()}"


def test_no_file_is_large():
    for path in tracked_files():
        assert (ROOT / path).stat().st_size < LARGEST, path


def test_extras_are_all_in_all():
    tomllib = importlib.util.find_spec("tomllib") and importlib.import_module("tomllib")
    if not tomllib:
        pytest.skip("needs Python 3.11")
    extras = tomllib.loads(read("pyproject.toml"))["project"]["optional-dependencies"]
    assert sorted(extras["all"]) == sorted(
        extras["plot"] + extras["files"] + extras["progress"] + extras["vtk"]
    )


def test_the_import_is_lean():
    # What describing a model does not need comes when it is asked for; what numpy imports is there anyway.
    listing = "import sys; print(' '.join(sys.modules))"
    with_numpy, with_pliant = (
        set(
            subprocess.run(
                [sys.executable, "-c", f"{first}; {listing}"], capture_output=True, check=True, text=True
            ).stdout.split()
        )
        for first in ("import numpy", "import numpy, pliant")
    )
    heavy = {
        "asyncio", "concurrent.futures", "h5py", "hashlib", "html", "inspect", "json", "logging",
        "matplotlib", "numpy.polynomial", "pathlib", "pliant._core", "pliant.simulation", "pliant.stepper",
        "pliant.result", "scipy", "tempfile", "urllib", "uuid", "zipfile",
    }  # fmt: skip
    assert not heavy & (with_pliant - with_numpy)


def test_public_names_that_come_late_are_there():
    program = """
import pliant
late = set(pliant.__all__) - set(vars(pliant))
assert {"simulate", "Stepper", "scenes"} <= late, late
assert late <= set(dir(pliant))
for name in sorted(late):
    value = getattr(pliant, name)
    assert name in ("scenes", "sdi") or (value.__name__ == name and vars(pliant)[name] is value)
assert pliant.__version__
try:
    pliant.simulat
except AttributeError as error:
    assert "simulat" in str(error)
else:
    raise AssertionError
"""
    subprocess.run([sys.executable, "-c", program], check=True)
