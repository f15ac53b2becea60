"""The pages are true: their code runs, their links lead somewhere, every public name is explained."""

import contextlib
import importlib.util
import inspect
import io
import re

import matplotlib.pyplot as pyplot
import pliant
import pytest
from tree import ROOT, read, tracked_files

PAGES = [path for path in tracked_files() if path.suffix == ".md"]


def python_blocks(page):
    """Return the Python code of a page, one text."""
    return "\n".join(re.findall(r"```python\n(.*?)```", read(page), re.S))


@pytest.mark.parametrize("page", ["README.md", "docs/getting-started.md", "docs/files.md"])
def test_code_of_the_page_runs(page, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(pyplot, "show", lambda *arguments, **options: None)
    output = io.StringIO()
    with contextlib.redirect_stdout(output):
        exec(compile(python_blocks(page), page, "exec"), {"__name__": "__main__"})
    pyplot.close("all")
    assert output.getvalue()


@pytest.mark.parametrize("page", PAGES, ids=str)
def test_links_lead_somewhere(page):
    for target in re.findall(r"\]\(([^)\s]+)\)", read(page)):
        if not re.match(r"https?:|#|mailto:", target):
            assert (ROOT / page.parent / target.split("#")[0]).exists(), target


def test_reference_page_is_up_to_date():
    spec = importlib.util.spec_from_file_location("build_reference", ROOT / "docs/build_reference.py")
    script = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(script)
    assert read("docs/reference.md") == script.page(), "run `make docs`"


def test_every_public_name_is_documented():
    for name in pliant.__all__:
        item = getattr(pliant, name)
        assert inspect.getdoc(item), f"pl.{name} has no docstring"
        if inspect.isclass(item):
            for part, member in inspect.getmembers(item):
                defined = any(
                    part in vars(base) for base in item.__mro__ if base.__module__.startswith("pliant")
                )
                method = callable(member) or isinstance(member, property)
                if defined and method and not part.startswith("_"):
                    assert inspect.getdoc(member), f"pl.{name}.{part} has no docstring"
        elif inspect.isfunction(item):
            assert "Examples\n" in inspect.getdoc(item), f"pl.{name} has no example"


def test_names_of_the_notation_occur_in_the_sources():
    sources = "\n".join(
        read(path)
        for path in tracked_files()
        if path.suffix in (".rs", ".py", ".pyi") and "tests" not in path.parts
    )
    for row in re.findall(r"^\|.*\|$", read("docs/theory/notation.md"), re.M)[2:]:
        for name in re.findall(r"`(\w+)`", row.split("|")[-2]):
            assert re.search(rf"\b{name}\b", sources), f"{name} of the notation is nowhere in the code"


def test_make_targets_of_the_pages_exist():
    targets = set(re.findall(r"^([a-z-]+):", read("Makefile"), re.M))
    for page in PAGES:
        used = re.findall(r"`make ([a-z-]+)`|^ {4}make ([a-z-]+)", read(page), re.M)
        assert {a or b for a, b in used} <= targets, page
