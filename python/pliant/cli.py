"""The command line: ``pliant demo``, ``run``, ``view``, ``info``, ``selftest``."""

from __future__ import annotations

import argparse
import platform
import sys
from collections.abc import Sequence
from pathlib import Path

from pliant.errors import ConvergenceError, FileError, ModelError

__all__ = ["main"]


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line; return its exit code: 0, 1 where something failed, 2 where it was asked wrongly.

    Parameters
    ----------
    arguments : sequence of str, optional
        Words after ``pliant``; by default those of the process.
    """
    options, rest = _parser().parse_known_args(arguments)
    if rest and not (options.command == "run" and options.file.suffix == ".py"):
        _parser().error(f"unrecognized arguments: {' '.join(rest)}")
    try:
        if options.command == "info":
            return _info()
        if options.command == "selftest":
            return _selftest()
        if options.command == "run":
            return _run_file(options, rest)
        if options.command == "view":
            return _view(options)
        return _demo(options.scene, options.list, options.test, options.out)
    except (ModelError, FileError, ConvergenceError, ImportError) as error:
        print(f"pliant: {error}", file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        print("pliant: interrupted", file=sys.stderr)
        return 130


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="pliant", description="Dynamics of soft machines.")
    commands = parser.add_subparsers(dest="command", required=True, metavar="COMMAND")
    demo = commands.add_parser("demo", help="run a scene; leave a picture and an interactive page")
    demo.add_argument("scene", nargs="?", metavar="SCENE", help="name of the scene; by default the first")
    demo.add_argument("--list", action="store_true", help="list the scenes")
    demo.add_argument("--test", action="store_true", help="run the scene (or all) and check it, no pictures")
    demo.add_argument("--out", type=Path, default=Path("out"), metavar="FOLDER", help="where files go (out)")
    run = commands.add_parser("run", help="run a script, or simulate a saved model")
    run.add_argument("file", type=Path, help="script.py (further words go to it) or model.json")
    run.add_argument("--duration", type=float, metavar="S", help="time to simulate a model [s]")
    run.add_argument("--step", type=float, metavar="S", help="step [s] (1e-3)")
    run.add_argument("--output", type=Path, metavar="FILE", help="result file (model.h5)")
    view = commands.add_parser("view", help="make a page of a result and open it in the browser")
    view.add_argument("file", type=Path, help="result.h5")
    view.add_argument("--color", metavar="NAME", help="strain, axial_force or speed")
    view.add_argument("--output", type=Path, metavar="PAGE", help="page to write (result.html)")
    view.add_argument("--no-open", action="store_true", help="write the page only")
    commands.add_parser("info", help="versions, processor, threads")
    commands.add_parser("selftest", help="check the accuracy on this machine, with figures; a minute at most")
    return parser


def _wrong(message: str) -> int:
    print(f"pliant: {message}", file=sys.stderr)
    return 2


def _info() -> int:
    import importlib.metadata

    import numpy

    import pliant
    from pliant._running import thread_count

    print(f"pliant {pliant.__version__}")
    print(f"Python {platform.python_version()} on {platform.platform()}")
    print(f"numpy {numpy.__version__}")
    for package in ("scipy", "matplotlib", "h5py", "tqdm", "meshio"):
        try:
            print(f"{package} {importlib.metadata.version(package)}")
        except importlib.metadata.PackageNotFoundError:
            print(f"{package} is not installed")
    print(f"processor {_processor()}")
    print(f"threads {thread_count(None)} (threads= of simulate; results do not depend on it)")
    return 0


def _processor() -> str:
    """Name the processor and those of its vector instructions that matter."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        return platform.processor() or platform.machine()
    facts = dict(part.split(":", 1) for part in lines if ":" in part)
    facts = {key.strip(): value.strip() for key, value in facts.items()}
    found = set(facts.get("flags", facts.get("Features", "")).split())
    known = [flag for flag in ("sse4_2", "avx", "avx2", "fma", "avx512f", "asimd", "sve") if flag in found]
    return f"{facts.get('model name', platform.machine())} ({', '.join(known) or 'plain'})"


def _selftest() -> int:
    import time

    from pliant.selftest import CHECKS

    begin = time.perf_counter()
    failed = count = 0
    for group in CHECKS:
        for check in group():
            count, failed = count + 1, failed + (not check.passed)
            mark = "ok  " if check.passed else "FAIL"
            line = f"{mark} {check.name}: {check.value:.6g}, exact {check.exact:.6g} +- {check.tolerance:.1g}"
            print(f"{line} ({check.source})", flush=True)
    print(f"{count - failed} of {count} checks passed in {time.perf_counter() - begin:.1f} s")
    return int(failed > 0)


def _run_file(options: argparse.Namespace, rest: Sequence[str]) -> int:
    import runpy

    path: Path = options.file
    if not path.is_file():
        return _wrong(f"{path}: there is no such file")
    if path.suffix == ".py":
        given = [name for name in ("duration", "step", "output") if getattr(options, name) is not None]
        if given:
            return _wrong(f"--{given[0]} is for models; a script decides itself")
        before = sys.argv, list(sys.path)
        sys.argv = [str(path), *rest]
        sys.path.insert(0, str(path.resolve().parent))
        try:
            runpy.run_path(str(path), run_name="__main__")
        finally:
            sys.argv, sys.path[:] = before
        return 0
    if path.suffix != ".json":
        return _wrong(f"{path}: must be a script (.py) or a model (.json)")
    if options.duration is None:
        return _wrong("run: a model needs --duration, the time to simulate [s]")
    from pliant.model import Model
    from pliant.simulation import simulate

    model = Model.load(path)
    output = options.output if options.output is not None else path.with_suffix(".h5")
    step = 1e-3 if options.step is None else options.step
    result = simulate(model, duration=options.duration, step=step, output=output)
    print(f"{result.statistics.steps} steps to {result.time[-1]:g} s; {output}  (pliant view {output})")
    return 0


def _view(options: argparse.Namespace) -> int:
    import webbrowser

    from pliant.result import Result

    result = Result.load(options.file)
    page: Path = options.output if options.output is not None else options.file.with_suffix(".html")
    result.export_html(page, color=options.color)
    print(page)
    if not options.no_open and not webbrowser.open(page.resolve().as_uri()):
        print("pliant: there is no browser to open it", file=sys.stderr)
    return 0


def _demo(name: str | None, listing: bool, test: bool, folder: Path) -> int:
    from pliant.scenes import SCENES

    if listing:
        width = max(map(len, SCENES))
        for key, build in SCENES.items():
            print(f"{key:<{width}}  {build().title}")
        return 0
    if name is not None and name not in SCENES:
        return _wrong(f"there is no scene '{name}'; there are {', '.join(SCENES)}")
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
    print(scene.report(measured))
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
    return int(bool(scene.failures(measured)))
