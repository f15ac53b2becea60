"""Draw the paths of the popular shell benchmarks beside their published tables.

python docs/build_shells.py [PROBLEM ...]

Writes docs/images/shell_benchmarks.png in a few minutes. Models and tables are those of the tests,
``tests/verification/sze.py``.
"""

from __future__ import annotations

import sys
import time
import warnings
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure
from PIL import Image

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE.parent / "tests" / "verification"))

from sze import PROBLEMS, solve, table  # noqa: E402

INK, COLORS = "#22313f", ("#2166ac", "#c0392b", "#2a8f5b")


def main(names: list[str]) -> None:
    """Solve the problems, print their distance from the tables, and draw."""
    rows = -(-len(names) // 3)
    figure = Figure(figsize=(10.5, 3.1 * rows), layout="constrained")
    axes = np.ravel(figure.subplots(rows, 3, squeeze=False))
    for name, ax in zip(names, axes, strict=False):
        begun = time.perf_counter()
        with warnings.catch_warnings():
            # Rolls and snaps pass unstable equilibria.
            warnings.simplefilter("ignore", UserWarning)
            curve = solve(name)
        published = table(name)
        published = published[published[:, 0] <= 1.05]
        for number, (label, values) in enumerate(curve.deflections.items()):
            ax.plot(values, curve.load, color=COLORS[number], linewidth=1.4, label=label)
            ax.plot(
                published[:, 1 + number],
                published[:, 0],
                "o",
                color=COLORS[number],
                markersize=3.2,
                mfc="white",
            )
        for point in curve.result.critical_points:
            if point.kind == "limit":
                at = int(np.argmin(np.abs(curve.load - point.load_factor)))
                ax.plot(
                    next(iter(curve.deflections.values()))[at], curve.load[at], "x", color=INK, markersize=6
                )
        ax.set_title(PROBLEMS[name].title, fontsize=9.5, loc="left")
        ax.set_xlabel("deflection", fontsize=8.5)
        ax.set_ylabel("load / largest load", fontsize=8.5)
        ax.legend(fontsize=7.5, frameon=False)
        ax.grid(alpha=0.25, linewidth=0.6)
        ax.tick_params(labelsize=8)
        last = [float(values[-1]) for values in curve.deflections.values()]
        print(
            f"{PROBLEMS[name].title}: {len(curve.load)} points in {time.perf_counter() - begun:.1f} s;",
            end=" ",
        )
        print("at full load", ", ".join(f"{x:.4g}" for x in last), end="; ")
        print("table", ", ".join(f"{x:.4g}" for x in published[-1, 1:]))
    for ax in axes[len(names) :]:
        ax.set_axis_off()
    path = HERE / "images" / "shell_benchmarks.png"
    figure.savefig(path, dpi=110)
    # Lines on white: few colours.
    Image.open(path).convert("RGB").quantize(64).save(path, optimize=True)
    print("wrote", path)


if __name__ == "__main__":
    main(sys.argv[1:] or list(PROBLEMS))
