"""Results: what was computed, as arrays, pictures and files."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING

from pliant import _check
from pliant._contact_forces import ContactForces
from pliant._motion import Motion
from pliant._table import table
from pliant.records import Records
from pliant.typing import ArrayLike, FloatArray

if TYPE_CHECKING:
    from matplotlib.figure import Figure


__all__ = ["Result"]


class Result(Motion, ContactForces):
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

    def _repr_html_(self) -> str:
        """Show a notebook the figures of the run and a picture of its last state."""
        import importlib.util

        facts: list[tuple[str, object]] = [("outputs", len(self.time))]
        if len(self.time):
            facts.append(
                ("load factor" if self.is_static else "time", f"{self.time[0]:g} to {self.time[-1]:g}")
            )
        if self.statistics.steps:
            facts.append(("steps", self.statistics.steps))
        text = table(repr(self)[1:-1], facts)
        if not len(self.time) or importlib.util.find_spec("matplotlib") is None:
            return text
        from pliant.plotting import thumbnail

        return f"{text}<img alt='last state' src='data:image/png;base64,{thumbnail(self)}'>"

    def _part(self, records: Records) -> Result:
        """Give a result of other rows of the same model."""
        part = Result(
            self.model,
            self._lowered,
            records,
            static=self.is_static,
            statistics=self.statistics,
            system=self._system,
        )
        part._known_offsets = self._known_offsets
        return part

    def plot(self, color: str | ArrayLike | None = None) -> Figure:
        """Draw the motion with matplotlib: the bodies at a few times, later ones stronger.

        Obstacles are shown grey, under all bodies, a ground as a piece of its plane. The picture is as large
        as the motion; obstacles near it make it larger by a quarter at most and are cut off there.

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

    def animate(
        self,
        path: str | os.PathLike[str],
        color: str | ArrayLike | None = None,
        speed: float = 1.0,
        fps: float = 30,
        *,
        progress: bool | None = None,
    ) -> Path:
        """Write a film: an mp4 where ffmpeg is on the PATH, else a gif; with obstacles as in :meth:`plot`.

        Parameters
        ----------
        path : str or path
            File to write, ``.mp4`` or ``.gif``.
        color : {"strain", "axial_force", "speed"} or array_like, shape (n, nodes), optional
            Quantity that colours the bodies.
        speed : float
            Seconds of the motion in a second of the film.
        fps : float
            Images in a second of the film.
        progress : bool, optional
            Show a progress bar; by default on a terminal.

        Returns
        -------
        Path
            The file that was written: a ``.gif``, with a warning, where an ``.mp4`` was asked for and there
            is no ffmpeg.
        """
        from pliant.plotting import animate, film_frames
        from pliant.progress import progress_bar

        speed = _check.number(speed, "speed", above=0)
        fps = _check.number(fps, "fps", above=0)
        progress = None if progress is None else _check.flag(progress, "progress")
        with progress_bar(progress, len(film_frames(self, speed, fps))) as report:
            return animate(self, path, color, speed, fps, report)

    def export_vtk(self, folder: str | os.PathLike[str]) -> Path:
        """Write files for ParaView, and ``result.pvd``, which opens them all.

        Cables are lines with velocity, strain, axial_force, curvature and radius at their points; surfaces
        and rigid bodies triangles, these with their axes; forces and reactions points with vectors. ``body``
        is the number of the body in the model. Obstacles, cut off as in :meth:`plot`, stand in a file by
        themselves, ``obstacle`` being their number in the model.

        Parameters
        ----------
        folder : str or path
            Where the files go; it is made if need be.

        Returns
        -------
        Path
            ``folder/result.pvd``.
        """
        from pliant.vtk import export_vtk

        return export_vtk(self, folder)

    def export_html(self, path: str | os.PathLike[str], color: str | ArrayLike | None = None) -> None:
        """Write one self-contained interactive page: orbit, time slider, play, colours.

        Obstacles, cut off as in :meth:`plot`, are as if of glass, so that they hide nothing.

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
