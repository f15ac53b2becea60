"""Where the things of a model are in the rows of a result."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

from pliant import _check
from pliant._lowered import Lowered
from pliant.beams import BeamBody
from pliant.bodies import LineBody, MassBody
from pliant.errors import translated
from pliant.points import Handle, Joint, Point, WorldPoint, require_handle
from pliant.readings import CriticalPoint, Statistics
from pliant.records import Records, Rows, by_blocks
from pliant.rigid import RigidBodyData
from pliant.surfaces import SurfaceBody
from pliant.typing import FloatArray, IntArray, Json

if TYPE_CHECKING:
    from pliant._core import System
    from pliant.model import Model

__all__ = ["Lookup"]


class Lookup:
    """Rows of a run with the model and the system they belong to."""

    def __init__(
        self,
        model: Model,
        lowered: Lowered,
        records: Records,
        *,
        static: bool,
        statistics: Statistics,
        system: System | None = None,
    ) -> None:
        self.model = model
        self.statistics = statistics
        self.time: FloatArray = records.time
        self.is_static = static
        self._records = records
        self._lowered = lowered
        self._built = system
        self._known_offsets: dict[str, IntArray] = {}

    @property
    def critical_points(self) -> tuple[CriticalPoint, ...]:
        """Of a static path: its limit points and bifurcations."""
        known = self._lowered.critical
        return tuple(CriticalPoint(kind, i, factor, np.array(x)) for kind, i, factor, x in known)

    @property
    def _system(self) -> System:
        if self._built is None:
            from pliant import _core

            with translated():
                self._built = _core.System(self._lowered.spec, self._lowered.arrays)
        return self._built

    def _past_columns(self, name: str) -> IntArray:
        """Columns of the outputs that hold what a cable remembers of having yielded, if it can.

        Of shape (elements, points, 2): plastic strain and its path.
        """
        number = self._lowered.cables[name]
        first, width = self._system.past_outputs()[number]
        body = self.model._bodies[name]
        assert isinstance(body, LineBody)
        count = body.elements * int(width)
        columns: IntArray = first + np.arange(count).reshape(body.elements, -1, 2)
        return columns

    def _poses(self, joint: int) -> Iterator[tuple[Any, FloatArray | None]]:
        """Rows of the result, and how the joint had engaged there (None: as at the start)."""
        history, switches = self._records.history, self._records.switches
        engaged = np.flatnonzero((history[:, 1] == joint) & (history[:, 2] == 1.0))
        if not len(engaged):
            yield slice(None), None
            return
        before = np.searchsorted(engaged, switches)
        for k in np.unique(before):
            yield np.flatnonzero(before == k), (history[engaged[k - 1]] if k else None)

    def _name(self, body: object) -> str:
        if isinstance(body, str):
            body = self.model[body]
        if not isinstance(body, Handle):
            _check.fail("body", body, "must be a body of the model, or its name")
        self.model._body(body, "body")
        return body.name

    def _body(self, name: str) -> LineBody:
        body = self.model._bodies[name]
        assert isinstance(body, LineBody)
        return body

    def _line(self, body: object) -> tuple[LineBody, str]:
        name = self._name(body)
        data = self.model._bodies[name]
        if not isinstance(data, LineBody):
            _check.fail("body", body, "must be a cable or a net of cables")
        return data, name

    def _offsets(self, name: str) -> IntArray:
        """Offsets in q: strand nodes (n, 2), a mass (1, 1), vectors of other bodies (k, 1)."""
        if name not in self._known_offsets:
            if name in self._lowered.cables:
                self._known_offsets[name] = self._system.cable_offsets(self._lowered.cables[name])
            elif name in self._lowered.rigid:
                first = self._system.rigid_offsets()[self._lowered.rigid[name]]
                self._known_offsets[name] = first + 3 * np.arange(4)[:, None]
            elif name in self._lowered.surfaces:
                first, nodes, vectors = self._system.surface_offsets()[self._lowered.surfaces[name]]
                self._known_offsets[name] = first + 3 * np.arange(nodes * vectors)[:, None]
            elif name in self._lowered.beams:
                first, nodes = self._system.beam_offsets()[self._lowered.beams[name]]
                self._known_offsets[name] = first + 3 * np.arange(4 * nodes)[:, None]
            else:
                self._known_offsets[name] = self._system.shared_offsets()[self._lowered.shared[name]].reshape(
                    1, 1
                )
        return self._known_offsets[name]

    def _nodes(self, body: object, rows: Rows) -> FloatArray:
        name = self._name(body)
        data = self.model._bodies[name]
        if isinstance(data, LineBody):
            offsets = self._offsets(name)[data.first, 0]
        elif isinstance(data, RigidBodyData):
            offsets = self._offsets(name)[:1, 0]
        elif isinstance(data, SurfaceBody):
            offsets = self._offsets(name)[:: data.vectors, 0]
        elif isinstance(data, BeamBody):
            offsets = self._offsets(name)[::4, 0]
        elif data.at is not None:
            return self._at(data.at, rows)[:, None]
        else:
            offsets = self._offsets(name)[:, 0]
        return np.ascontiguousarray(rows[:, offsets[:, None] + np.arange(3)])

    def _where(self, point: Point | WorldPoint) -> tuple[IntArray, FloatArray]:
        """Offsets in q of the vectors whose weighted sum is a point, and the weights, each (k,)."""
        assert isinstance(point, Point)
        data = self.model._bodies[point.body]
        if isinstance(data, MassBody) and data.at is not None:
            return self._where(data.at)
        offsets = self._offsets(point.body)
        if isinstance(data, RigidBodyData):
            return offsets[:, 0], data.weights(point)
        if isinstance(data, BeamBody):
            index, weights = data.weights(point)
            return offsets[index, 0], weights
        if isinstance(data, SurfaceBody):
            if point.node is not None:
                return offsets[[point.node * data.vectors], 0], np.ones(1)
            index, functions = data.shape(point.element, point.at or (0.0, 0.0))
            return offsets[index, 0], functions[:, 0]
        if not isinstance(data, LineBody):
            return offsets[:, 0], np.ones(1)
        if point.node is not None:
            return offsets[data.first[point.node], :1], np.ones(1)
        first, weights = data.shape(point.element, point.xi)
        return offsets[first : first + 2].ravel(), weights

    def _at(self, point: Point | WorldPoint, rows: Rows) -> FloatArray:
        offsets, weights = self._where(point)
        vectors = rows[:, offsets[:, None] + np.arange(3)]
        value: FloatArray = sum(w * vectors[:, k] for k, w in enumerate(weights))
        return value

    def _momentum(self, rate: bool = False) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Momenta or their rates: the mass matrix is constant and symmetric, so that v x M v adds nothing."""
        records = self._records
        with translated():
            found: tuple[FloatArray, FloatArray, FloatArray] = by_blocks(
                self._system.momentum, records.q, records.a if rate else records.v
            )
            return found

    def _plan_of(self, joint: object) -> Json:
        """Tell how a joint is realised."""
        if not isinstance(joint, Joint):
            _check.fail("joint", joint, "must be a joint of the model")
        require_handle(joint, "joint", self.model.identity)
        if joint.name not in self._lowered.plan:
            _check.fail("joint", joint, "the model that was run has no such joint")
        plan: Json = self._lowered.plan[joint.name]
        return plan
