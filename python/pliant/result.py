"""Results: what was computed, as arrays, pictures and files."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

from pliant import _check
from pliant._forces import Forces
from pliant._motion import Motion
from pliant.bodies import LineBody, MassBody
from pliant.errors import ModelError
from pliant.records import State
from pliant.typing import ArrayLike, FloatArray

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from pliant.model import Model

__all__ = ["Result", "require_state"]


class Result(Motion, Forces):
    """What :func:`pliant.simulate` or :func:`pliant.solve_static` computed.

    Attributes
    ----------
    time : ndarray, shape (n,)
        Times [s] (statics: load factors) of the outputs; entry 0 is the start.
    model : Model
        The model that was run.
    statistics : Statistics
        Steps, iterations, seconds.
    critical_points : tuple of CriticalPoint
        Of a static path: limit points and bifurcations, with ``kind``, ``index``, ``load_factor`` and
        ``shape``.
    """

    def __repr__(self) -> str:
        kind = "load factor" if self.is_static else "s"
        last = f"{self.time[-1]:g}" if len(self.time) else "nothing"
        return f"<Result: {len(self.time)} outputs to {last} {kind}>"

    @property
    def load_factor(self) -> FloatArray:
        """Load factors (n,) of a static result; the last is full load."""
        if not self.is_static:
            raise AttributeError("load_factor: only the results of solve_static have one")
        return self.time

    def plot(self, color: str | ArrayLike | None = None) -> Figure:
        """Draw the motion with matplotlib: the bodies at a few times, later ones stronger.

        Parameters
        ----------
        color : {"strain", "axial_force", "speed"} or array_like, shape (n, nodes), optional
            Quantity that colours the lines.

        Returns
        -------
        matplotlib.figure.Figure
            The figure; ``figure.savefig("motion.png")`` writes it.
        """
        from pliant.plotting import plot

        return plot(self, color)

    def export_html(self, path: str | os.PathLike[str], color: str | ArrayLike | None = None) -> None:
        """Write one self-contained interactive page: orbit, time slider, play, colours.

        Parameters
        ----------
        path : str or path
            File to write.
        color : {"strain", "axial_force", "speed"} or array_like, shape (n, nodes), optional
            Quantity that colours the lines at first; the page offers the three by name.
        """
        from pliant.export import export_html

        export_html(self, path, color)

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the result to an HDF5 file (layout: :mod:`pliant.storage`)."""
        from pliant.storage import save

        save(self, path)

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Result:
        """Read a result that :meth:`save` wrote; handles of its model serve it."""
        from pliant.storage import load

        return load(path)


def require_state(start: object, name: str, model: Model) -> State:
    """Return ``start`` as a state whose bodies are those of the model."""
    if isinstance(start, Result):
        start = start.state(-1)
    if not isinstance(start, State):
        _check.fail(name, start, "must be a Result or result.state(i)")
    ours, theirs = (
        {
            key: (body.kind, body.nodes, tuple(body.strands))
            if isinstance(body, LineBody)
            else ("mass", body.at)
            if isinstance(body, MassBody)
            else ("rigid", body.mass)
            for key, body in m._bodies.items()
        }
        for m in (model, start.model)
    )
    for key in {**theirs, **ours}:
        if ours.get(key) != theirs.get(key):
            raise ModelError(
                f"{name}: bodies must be the same in both models, but '{key}' "
                + (
                    "is missing in one"
                    if key not in ours or key not in theirs
                    else "differs in kind or in elements"
                )
            )
    return start
