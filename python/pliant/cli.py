"""The command line: ``pliant demo``, ``pliant info``."""

from __future__ import annotations

import argparse
import platform
import sys
from collections.abc import Sequence
from pathlib import Path

__all__ = ["main"]


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line; return its exit code.

    Parameters
    ----------
    arguments : sequence of str, optional
        Words after ``pliant``; by default those of the process.
    """
    parser = argparse.ArgumentParser(prog="pliant", description="Dynamics of soft machines.")
    commands = parser.add_subparsers(dest="command", required=True, metavar="COMMAND")
    demo = commands.add_parser("demo", help="run a scene; leave a picture and an interactive page")
    demo.add_argument("scene", nargs="?", metavar="SCENE", help="name of the scene; by default the first")
    demo.add_argument("--list", action="store_true", help="list the scenes")
    demo.add_argument("--test", action="store_true", help="run the scene (or all) and check it, no pictures")
    demo.add_argument("--out", type=Path, default=Path("out"), metavar="FOLDER", help="where files go (out)")
    commands.add_parser("info", help="versions of pliant and of what it uses")
    options = parser.parse_args(arguments)
    if options.command == "info":
        return _info()
    return _demo(options.scene, options.list, options.test, options.out)


def _info() -> int:
    import importlib.metadata

    import numpy

    import pliant

    print(f"pliant {pliant.__version__}")
    print(f"Python {platform.python_version()} on {platform.platform()}")
    print(f"numpy {numpy.__version__}")
    for package in ("scipy", "matplotlib", "h5py", "tqdm"):
        try:
            print(f"{package} {importlib.metadata.version(package)}")
        except importlib.metadata.PackageNotFoundError:
            print(f"{package} is not installed")
    return 0


def _demo(name: str | None, listing: bool, test: bool, folder: Path) -> int:
    from pliant.scenes import SCENES

    if listing:
        width = max(map(len, SCENES))
        for key, build in SCENES.items():
            print(f"{key:<{width}}  {build().title}")
        return 0
    if name is not None and name not in SCENES:
        print(f"pliant: there is no scene '{name}'; there are {', '.join(SCENES)}", file=sys.stderr)
        return 2
    chosen = [name] if name is not None else list(SCENES) if test else list(SCENES)[:1]
    return max(_run(key, pictures=not test, folder=folder) for key in chosen)


def _run(name: str, *, pictures: bool, folder: Path) -> int:
    """Run one scene, print its checks, leave its picture and page; 1 if a check fails."""
    import time

    from pliant.scenes import SCENES

    scene = SCENES[name]()
    print(f"{scene.name}: {scene.title}")
    begin = time.perf_counter()
    result = scene.simulate()
    print(f"  {result.statistics.steps} steps in {time.perf_counter() - begin:.2f} s")
    measured = scene.measure(result)
    failed = 0
    for key, (value, tolerance, source) in scene.expected.items():
        good = abs(measured[key] - value) <= tolerance
        failed |= not good
        mark = "ok  " if good else "FAIL"
        print(f"  {mark} {key} = {measured[key]:.3g}, expected {value:g} +- {tolerance:g} ({source})")
    if pictures:
        folder.mkdir(parents=True, exist_ok=True)
        page = folder / f"{name}.html"
        result.export_html(page, color=scene.color)
        print(f"  page     {page}  (opens in any browser)")
        picture = folder / f"{name}.png"
        try:
            result.plot(color=scene.color).savefig(picture, dpi=150)
            print(f"  picture  {picture}")
        except ImportError as error:
            print(f"  no picture: {error}")
    return int(failed)
