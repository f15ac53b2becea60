"""Pictures and films with matplotlib."""

from __future__ import annotations

import os
import warnings
from collections.abc import Callable
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, Any

import numpy as np

from pliant import _check
from pliant.drawing import (
    COLORS,
    Drawing,
    Lines,
    Solid,
    Surface,
    contact_arrows,
    draw,
    frames_of,
    joint_points,
    up_of,
)
from pliant.errors import FileError
from pliant.files import atomic
from pliant.scenery import Scenery, extent_of, scenery
from pliant.typing import FloatArray, IntArray

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from pliant.result import Result

__all__ = ["animate", "film_frames", "plot", "thumbnail"]

SHOWN = 9  # times in one picture
SHOWN_OF_NETS = 3  # where there are many strands, or solids and surfaces
LIGHT = np.array([-0.35, -0.5, 0.8]) / np.linalg.norm([-0.35, -0.5, 0.8])
MAP = "viridis"
FORCE = "#e08714"
GROUND, EDGE = "#c3ccd5", "#93a0ad"
CLARITY = {"plane": 0.45, "solid": 0.6, "mesh": 0.5, "bore": 0.12}  # opacity of obstacles
FILLED = np.array([0.9, 0.74])  # of width and height, by the box of pictures in space; labels take the rest
STRIP = 0.03  # of a half-space below its plane in flat pictures, over the size of the motion


def _matplotlib() -> ModuleType:
    try:
        import matplotlib
    except ImportError as error:
        raise ImportError('pictures need matplotlib: pip install "pliant[plot]"') from error
    return matplotlib


class Picture:
    """A figure in which frames are drawn.

    Parameters
    ----------
    result : Result
        What is drawn.
    frames : (k,)
        Its outputs.
    color : str, (n, nodes) or None
        Quantity that colours the bodies.
    size : (2,)
        Width and height [inches].
    """

    def __init__(
        self,
        result: Result,
        frames: IntArray,
        color: Any,
        size: tuple[float, float] = (7.2, 5.4),
    ) -> None:
        mpl = _matplotlib()
        from matplotlib.colors import Normalize
        from matplotlib.figure import Figure as NewFigure

        self.drawings = draw(result, frames, color)
        self.joints = joint_points(result, frames)
        self.pushes = contact_arrows(result, frames)
        self.push = max(
            (float(np.linalg.norm(one.vectors, axis=1).max()) for one in self.pushes), default=0.0
        )
        self.up = up_of(result)
        self.key = color if isinstance(color, str) else "color"
        self.cycle = mpl.rcParams["axes.prop_cycle"].by_key()["color"]
        motion = extent_of(self.drawings)
        self.extent, self.scenery = scenery(result, motion)
        self.size = max(motion.size, 1e-9)
        flat = [k for k in range(3) if motion.high[k] - motion.low[k] < 1e-6 * self.size]
        self.shown = [k for k in range(3) if not flat or k != flat[0]]
        values = [d.values[self.key] for d in self.drawings if color is not None and self.key in d.values]
        self.norm = Normalize(min(v.min() for v in values), max(v.max() for v in values)) if values else None
        self.colors = mpl.colormaps[MAP]
        self.figure = NewFigure(figsize=size, layout="constrained")
        self.axes: Any = self._flat_axes() if flat else self._axes_in_space()
        for k, name in zip(self.shown, "xyz", strict=False):
            getattr(self.axes, f"set_{name}label")(f"{'xyz'[k]} [m]")
        if self.norm is not None:
            label = COLORS.get(color, "") if isinstance(color, str) else ""
            self.figure.colorbar(
                mpl.cm.ScalarMappable(self.norm, MAP),
                ax=self.axes,
                label=label,
                shrink=0.75,
                pad=0.1 if self.in_space else 0.02,
            )
        for obstacle in self.scenery:
            self._scenery(obstacle)
        self.artists: list[Any] = []

    @property
    def in_space(self) -> bool:
        """Whether the picture has depth."""
        return len(self.shown) == 3

    def _flat_axes(self) -> Any:
        axes = self.figure.add_subplot()
        axes.set_aspect("equal", adjustable="datalim")
        axes.grid(alpha=0.25)
        # The limits are those of the whole motion, whatever is drawn of it.
        axes.update_datalim([corner[self.shown] for corner in self.extent])
        axes.autoscale_view()
        return axes

    def _axes_in_space(self) -> Any:
        axes: Any = self.figure.add_subplot(projection="3d", computed_zorder=False)
        low, high = self.extent
        extent = high - low
        for k, name in enumerate("xyz"):
            getattr(axes, f"set_{name}lim")(low[k], high[k])
            getattr(axes, f"{name}axis").set_pane_color((0.97, 0.975, 0.98, 1.0))
            getattr(axes, f"{name}axis")._axinfo["grid"].update(color="#dde3e9", linewidth=0.7)
        # Long axes lie across the picture; the eye is a little above.
        turned = extent[0] >= extent[1]
        axes.view_init(elev=22, azim=-62 if turned else -28, vertical_axis="zyx"[int(self._vertical())])
        zoom = 1.0
        for _ in range(2):  # nearly proportional: a box in perspective
            axes.set_box_aspect(extent, zoom=zoom)
            zoom /= self._reach(axes)
        axes.set_box_aspect(extent, zoom=zoom)
        axes.tick_params(labelsize=8)
        for k, name in enumerate("xyz"):
            axes.locator_params(axis=name, nbins=5 if extent[k] > 0.4 * extent.max() else 2)
        return axes

    def _reach(self, axes: Any) -> float:
        """Tell how far the box reaches to where the labels of axes in space begin, 1 being there."""
        from mpl_toolkits.mplot3d import proj3d  # type: ignore[import-untyped]

        corners = np.array(np.meshgrid(*np.transpose(self.extent))).reshape(3, -1)
        seen = np.array(proj3d.proj_transform(*corners, axes.get_proj())[:2]).T
        window = axes.viewLim
        middle = (window.min + window.max) / 2
        return float((np.abs(seen - middle) / (FILLED * (window.max - middle))).max())

    def _vertical(self) -> int:
        """Say which axis is upright, 0 for z."""
        return int({2: 0, 1: 1, 0: 2}[int(np.abs(self.up).argmax())])

    def _scenery(self, obstacle: Scenery) -> None:
        """Draw an obstacle: light, and under all bodies, so that it hides none."""
        faces, lines = obstacle.points[obstacle.triangles], obstacle.lines
        look: dict[str, Any] = {"alpha": CLARITY[obstacle.kind], "linewidths": 0, "zorder": 0.5}
        edges: dict[str, Any] = {"colors": EDGE, "alpha": 0.7, "linewidths": 0.5, "zorder": 0.6}
        if self.in_space:
            from matplotlib.colors import to_rgb
            from mpl_toolkits.mplot3d.art3d import Line3DCollection, Poly3DCollection  # type: ignore[import-untyped]

            colors = _shaded(faces, np.array(to_rgb(GROUND)), two_sided=True)
            self.axes.add_collection3d(Poly3DCollection(faces, facecolors=colors, **look))
            self.axes.add_collection3d(Line3DCollection(lines, **edges))
            return
        from matplotlib.collections import LineCollection, PolyCollection

        seen = faces[:, :, self.shown]
        if obstacle.kind in ("plane", "solid"):
            # Of a half-space a strip below its plane is shown.
            depth = STRIP * self.size if obstacle.kind == "plane" else 0.0
            solid = np.concatenate([obstacle.points, obstacle.points - depth * obstacle.normals])
            seen = _hull(solid[:, self.shown])[None]
        self.axes.add_collection(PolyCollection(list(seen), facecolors=GROUND, **look), autolim=False)
        self.axes.add_collection(LineCollection(list(lines[:, :, self.shown]), **edges), autolim=False)

    def clear(self) -> None:
        """Take away what was drawn."""
        for artist in self.artists:
            artist.remove()
        self.artists.clear()

    def add(self, frame: int, strength: float = 1.0, *, joints: bool = False) -> None:
        """Draw the bodies at a frame, faint or strong."""
        before = list(self.axes.get_children())
        for number, drawing in enumerate(self.drawings):
            plain = self.cycle[number % len(self.cycle)]
            if isinstance(drawing, Lines):
                self._lines(drawing, frame, plain, strength)
            elif isinstance(drawing, Solid):
                self._solid(drawing, frame, plain, strength)
            elif isinstance(drawing, Surface):
                self._faces(drawing, drawing.points[frame], drawing.triangles, frame, plain, strength)
            else:
                self._dots(drawing.points[frame], "o", plain, strength, 6, self._value(drawing, frame))
        if joints and self.joints:
            places = np.array([place[frame] for place in self.joints.values()])
            self._dots(places, "D", "#39424e", 0.9, 3.5, None)
        self._arrows(frame, strength)
        known = set(map(id, before))
        self.artists += [artist for artist in self.axes.get_children() if id(artist) not in known]

    def _arrows(self, frame: int, strength: float) -> None:
        """Draw forces of contact on the first body, the largest of the motion an eighth of the picture."""
        pressing = [one for one in self.pushes if one.vectors[frame].any()]
        if not pressing:
            return
        feet = np.array([one.feet[frame] for one in pressing])[:, self.shown]
        vectors = np.array([one.vectors[frame] for one in pressing])[:, self.shown]
        vectors = vectors * (self.size / 8 / self.push)
        look: dict[str, Any] = {"color": FORCE, "alpha": strength, "zorder": 6}
        if self.in_space:
            self.axes.quiver(*feet.T, *vectors.T, arrow_length_ratio=0.3, linewidth=1.2, **look)
        else:
            look |= {"angles": "xy", "scale_units": "xy", "scale": 1, "width": 0.004}
            self.axes.quiver(*feet.T, *vectors.T, **look)

    def _value(self, drawing: Drawing, frame: int) -> FloatArray | None:
        if self.norm is None or self.key not in drawing.values:
            return None
        value: FloatArray = drawing.values[self.key][frame]
        return value

    def _dots(
        self, places: FloatArray, mark: str, plain: str, strength: float, size: float, value: Any
    ) -> None:
        color = plain if value is None or self.norm is None else self.colors(self.norm(float(value[0])))
        more = {"zorder": 5 if mark == "D" else 4}
        self.axes.plot(*places[:, self.shown].T, mark, color=color, alpha=strength, markersize=size, **more)

    def _lines(self, drawing: Lines, frame: int, plain: str, strength: float) -> None:
        from matplotlib.collections import LineCollection
        from mpl_toolkits.mplot3d.art3d import Line3DCollection

        points = drawing.points[frame][:, self.shown]
        kind: Any = Line3DCollection if self.in_space else LineCollection
        width = float(np.clip(2 * drawing.radius / self.size * 330, 1.4, 4.0))
        look: dict[str, Any] = {"linewidths": width, "alpha": strength, "capstyle": "round", "zorder": 3}
        value = self._value(drawing, frame)
        if value is None:
            # Whole strands: the round ends of pieces would show through each other.
            lines = kind(np.split(points, np.cumsum(drawing.strands)[:-1]), colors=plain, **look)
        else:
            inside = drawing.pieces
            pieces = np.stack([points[inside], points[inside + 1]], axis=1)
            lines = kind(pieces, norm=self.norm, cmap=MAP, **look)
            lines.set_array((value[inside] + value[inside + 1]) / 2 if self.key == "speed" else value[inside])
        self.axes.add_collection(lines)

    def _solid(self, drawing: Solid, frame: int, plain: str, strength: float) -> None:
        points = drawing.at(frame)
        if self.in_space and strength > 0.5:
            self._faces(drawing, points, drawing.triangles, frame, plain, strength)
        elif not self.in_space:
            from matplotlib.patches import Polygon

            hull = _hull(points[:, self.shown])
            value = self._value(drawing, frame)
            color = plain if value is None or self.norm is None else self.colors(self.norm(value.mean()))
            look: dict[str, Any] = {"facecolor": color, "edgecolor": "#39424e", "linewidth": 0.6}
            self.axes.add_patch(Polygon(hull, alpha=0.55 * strength, zorder=2, **look))
        for line in drawing.outline:
            seen = drawing.at(frame, line)[:, self.shown]
            if self.in_space and strength <= 0.5:
                self.axes.plot(*seen.T, color=plain, alpha=strength, linewidth=0.7, zorder=2)

    def _faces(
        self,
        drawing: Solid | Surface,
        points: FloatArray,
        triangles: IntArray,
        frame: int,
        plain: str,
        strength: float,
    ) -> None:
        from matplotlib.colors import to_rgb

        corners = points[triangles]
        value = self._value(drawing, frame)
        if value is None or self.norm is None:
            base = np.array(to_rgb(plain))
        else:
            base = self.colors(self.norm(value[triangles].mean(axis=1)))[:, :3]
        colors = _shaded(corners, base, two_sided=isinstance(drawing, Surface))
        if self.in_space:
            from mpl_toolkits.mplot3d.art3d import Poly3DCollection

            faces = Poly3DCollection(corners, facecolors=colors, alpha=strength, linewidths=0, zorder=2)
            self.axes.add_collection3d(faces)
        else:
            from matplotlib.collections import PolyCollection

            seen = corners[:, :, self.shown]
            self.axes.add_collection(PolyCollection(list(seen), facecolors=colors, alpha=strength, zorder=2))

    def legend(self) -> None:
        """Name the bodies, where they are not too many."""
        if self.norm is not None or not 1 < len(self.drawings) <= 8:
            return
        from matplotlib.lines import Line2D

        marks = [
            Line2D([], [], color=self.cycle[k % len(self.cycle)], label=drawing.name)
            for k, drawing in enumerate(self.drawings)
        ]
        self.axes.legend(handles=marks, frameon=False, fontsize=9)


def _shaded(corners: FloatArray, base: FloatArray, *, two_sided: bool) -> FloatArray:
    """Colours of triangles (t, 3, 3) in the light, (t, 3), from theirs, (t, 3) or (3,)."""
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    shade = normals @ LIGHT / np.maximum(np.linalg.norm(normals, axis=1), 1e-300)
    if two_sided:
        shade = np.abs(shade)
    colors: FloatArray = np.clip(base * (0.62 + 0.38 * np.maximum(shade, -0.4))[:, None], 0, 1)
    return colors


def _hull(points: FloatArray) -> FloatArray:
    """Corners of the convex hull of points (p, 2)."""
    from scipy.spatial import ConvexHull

    corners: FloatArray = points[ConvexHull(points).vertices]
    return corners


def plot(result: Result, color: Any = None) -> Figure:
    """Draw the bodies at a few times, later ones stronger; see :meth:`pliant.Result.plot`."""
    first = draw(result, np.zeros(1, dtype=np.int64), None, points=1)
    strands = sum(len(drawing.strands) for drawing in first if isinstance(drawing, Lines))
    crowded = strands > 8 or any(isinstance(drawing, Solid | Surface) for drawing in first)
    frames = frames_of(result, SHOWN_OF_NETS if crowded else SHOWN)
    picture = Picture(result, frames, color)
    for frame in range(len(frames)):
        strength = 0.18 + 0.82 * (frame / max(len(frames) - 1, 1)) ** 1.5
        picture.add(frame, strength, joints=frame == len(frames) - 1)
    picture.legend()
    times = result.time[frames]
    what = "load factor" if result.is_static else "t ="
    unit = "" if result.is_static else " s"
    title = f"{what} {times[0]:.4g} (light) to {times[-1]:.4g}{unit} (strong)" if len(times) > 1 else ""
    picture.axes.set_title(title, fontsize=10)
    return picture.figure


def thumbnail(result: Result) -> str:
    """Draw the last state, small: a PNG in base64."""
    import base64
    import io

    picture = Picture(result, np.array([len(result.time) - 1]), None, size=(4.2, 3.2))
    picture.add(0, joints=True)
    buffer = io.BytesIO()
    picture.figure.savefig(buffer, format="png", dpi=90)
    return base64.b64encode(buffer.getvalue()).decode("ascii")


def animate(
    result: Result,
    path: str | os.PathLike[str],
    color: Any,
    speed: float,
    fps: float,
    progress: Callable[[int], object],
) -> Path:
    """Write a film; see :meth:`pliant.Result.animate`."""
    _matplotlib()
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    target, writer = _writer(Path(os.fsdecode(path)), fps)
    frames = film_frames(result, speed, fps)
    shown, where = np.unique(frames, return_inverse=True)
    picture = Picture(result, shown, color, size=(8.0, 6.0))
    FigureCanvasAgg(picture.figure)
    picture.legend()
    with atomic(target) as temporary:
        # The writers tell the format by the ending.
        whole = temporary.with_name(temporary.name + target.suffix)
        try:
            with writer.saving(picture.figure, str(whole), dpi=120):
                for frame in where:
                    picture.clear()
                    picture.add(int(frame), joints=True)
                    time = result.time[shown[frame]]
                    what = f"load factor {time:.3f}" if result.is_static else f"t = {time:.3f} s"
                    picture.axes.set_title(what, fontsize=10)
                    writer.grab_frame()
                    progress(1)
            whole.replace(temporary)
        except (OSError, RuntimeError) as error:
            raise FileError(f"{target}: cannot be written: {error}") from error
        finally:
            whole.unlink(missing_ok=True)
    return target


def film_frames(result: Result, speed: float, fps: float) -> IntArray:
    """Output shown in each image of a film."""
    length = float(result.time[-1] - result.time[0])
    if result.is_static or length == 0.0:
        return np.arange(len(result.time))
    count = max(2, round(length / speed * fps) + 1)
    if count > 100_000:
        _check.fail("speed", speed, f"makes a film of {count} images; at most 100,000")
    wanted = np.linspace(result.time[0], result.time[-1], count)
    after = np.clip(np.searchsorted(result.time, wanted), 1, len(result.time) - 1)
    nearer = wanted - result.time[after - 1] < result.time[after] - wanted
    return after - nearer


def _writer(path: Path, fps: float) -> tuple[Path, Any]:
    """Choose who writes the film: ffmpeg an mp4, else Pillow a gif."""
    from matplotlib import animation

    ending = path.suffix.lower()
    if ending not in (".mp4", ".gif"):
        _check.fail("path", str(path), "must end in .mp4 or .gif")
    if not path.parent.is_dir():
        raise FileError(f"{path}: cannot be written: there is no such folder")
    if ending == ".mp4":
        if animation.writers.is_available("ffmpeg"):
            options = ["-pix_fmt", "yuv420p", "-crf", "20", "-f", "mp4"]
            return path, animation.FFMpegWriter(fps=fps, codec="h264", extra_args=options)  # type: ignore[arg-type]
        path = path.with_suffix(".gif")
        warnings.warn(f"there is no ffmpeg on the PATH for an mp4: {path} is written instead", stacklevel=4)
    if not animation.writers.is_available("pillow"):
        raise ImportError("films need ffmpeg on the PATH, or Pillow: pip install pillow")
    return path, animation.PillowWriter(fps=fps)  # type: ignore[arg-type]
