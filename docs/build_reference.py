"""Write docs/reference.md: every public name of pliant, its signature and the first line of its docstring."""

import inspect
import re
from pathlib import Path

import pliant

INTRODUCTION = """\
# Reference

Every public name, as `import pliant as pl` offers it; `help(pl.Model.add_cable)` tells all about arguments,
units and shapes. This page is written by `make docs`.
"""


def summary(item: object) -> str:
    """Return the first paragraph of a docstring in one line."""
    text = inspect.getdoc(item) or ""
    paragraph = " ".join(text.split("\n\n")[0].split())
    # Roles and double backticks of docstrings become plain code.
    return re.sub(r":\w+:`~?([^`]*)`|``([^`]*)``", lambda m: f"`{m.group(1) or m.group(2)}`", paragraph)


def signature(item: object) -> str:
    """Return the arguments without their types, as one types them."""
    try:
        plain = inspect.signature(item)
    except (TypeError, ValueError):
        return ""
    empty = inspect.Parameter.empty
    arguments = [p.replace(annotation=empty) for name, p in plain.parameters.items() if name != "self"]
    return str(plain.replace(parameters=arguments, return_annotation=empty))


def members(kind: type) -> list[tuple[str, str]]:
    """Return (how it is typed, summary) of the public members of a class that it defines or documents."""
    rows = []
    for name, member in inspect.getmembers(kind):
        documented = any(name in vars(base) for base in kind.__mro__ if base.__module__.startswith("pliant"))
        if name.startswith("_") or not documented:
            continue
        if isinstance(inspect.getattr_static(kind, name), property):
            rows.append((f".{name}", summary(member)))
        elif callable(member):
            rows.append((f".{name}{signature(member)}", summary(member)))
    return rows


def page() -> str:
    """Return the page as Markdown."""
    groups: dict[str, list[str]] = {"Functions": [], "Classes": [], "Exceptions": [], "Modules": []}
    for name in sorted(pliant.__all__, key=str.lower):
        item = getattr(pliant, name)
        if inspect.ismodule(item):
            lines = [f"### `pl.{name}`\n", summary(item), ""]
            lines += [
                f"- `pl.{name}.{part}{signature(getattr(item, part))}`: {summary(getattr(item, part))}"
                for part in item.__all__
                if callable(getattr(item, part))
            ]
            groups["Modules"].append("\n".join(lines))
            continue
        # Handles and results are made by pliant: a class that one constructs says what its parameters are.
        made_here = isinstance(item, type) and "Parameters\n" not in (inspect.getdoc(item) or "")
        shown = "" if made_here else signature(item)
        lines = [f"### `pl.{name}{shown}`\n", summary(item)]
        if isinstance(item, type):
            rows = members(item)
            if rows and not issubclass(item, BaseException):
                lines += ["", *(f"- `{head}`: {text}" for head, text in rows)]
            kind = "Exceptions" if issubclass(item, BaseException) else "Classes"
        else:
            kind = "Functions"
        groups[kind].append("\n".join(lines))
    parts = [INTRODUCTION]
    for title, entries in groups.items():
        if entries:
            parts += [f"## {title}\n", "\n\n".join(entries) + "\n"]
    return "\n".join(parts)


if __name__ == "__main__":
    (Path(__file__).parent / "reference.md").write_text(page())
