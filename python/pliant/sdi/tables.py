"""What studies leave: tables and figures."""

from __future__ import annotations

import csv
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from pliant.sdi.map import ErrorMap

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["Study", "Table"]


@dataclass(frozen=True)
class Table:
    """A table of a study."""

    title: str
    columns: tuple[str, ...]
    rows: list[tuple[Any, ...]]

    def __str__(self) -> str:
        cells = [[text_of(value) for value in row] for row in self.rows]
        widths = [max(len(c), *(len(row[i]) for row in cells)) for i, c in enumerate(self.columns)]
        head = "  ".join(
            c.ljust(w) if i == 0 else c.rjust(w)
            for i, (c, w) in enumerate(zip(self.columns, widths, strict=True))
        )
        lines = [self.title, head]
        for row in cells:
            lines.append(
                "  ".join(
                    c.ljust(w) if i == 0 else c.rjust(w)
                    for i, (c, w) in enumerate(zip(row, widths, strict=True))
                )
            )
        return "\n".join(lines)

    def column(self, name: str) -> list[Any]:
        """Return one column.

        Examples
        --------
        >>> Table("squares", ("n", "n2"), [(1, 1), (2, 4)]).column("n2")
        [1, 4]
        """
        i = self.columns.index(name)
        return [row[i] for row in self.rows]


def text_of(value: Any) -> str:
    if isinstance(value, complex):
        return f"{value.real:.3f}{value.imag:+.4f}i"
    if isinstance(value, float):
        return "-" if not np.isfinite(value) else f"{value:.4g}"
    return str(value)


@dataclass
class Study:
    """What the studies found.

    Attributes
    ----------
    tables : dict of Table
        By name.
    figures : dict of Figure
        By name.
    """

    tables: dict[str, Table] = field(default_factory=dict)
    figures: dict[str, Figure] = field(default_factory=dict)
    maps: dict[str, ErrorMap] = field(default_factory=dict)

    def save(self, folder: str | Path) -> list[Path]:
        """Write tables as CSV and figures as PNG; return the paths."""
        target = Path(folder)
        target.mkdir(parents=True, exist_ok=True)
        paths = []
        for name, table in self.tables.items():
            path = target / f"{name}.csv"
            with path.open("w", newline="", encoding="utf-8") as file:
                writer = csv.writer(file)
                writer.writerow(table.columns)
                writer.writerows(
                    [text_of(v) if isinstance(v, complex) else v for v in row] for row in table.rows
                )
            paths.append(path)
        for name, figure in self.figures.items():
            path = target / f"{name}.png"
            figure.savefig(path, dpi=130)
            paths.append(path)
        return paths

    def __str__(self) -> str:
        return "\n\n".join(str(table) for table in self.tables.values())
