"""Readings of a result about motion: nodes, points, joints, states, balances."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np

from pliant import _check
from pliant._crease import Crease
from pliant._lookup import Lookup
from pliant._lowered import BodyState
from pliant.beams import BeamBody, section_axes
from pliant.bodies import GAUSS_5, LineBody, element_masses, hermite
from pliant.errors import translated
from pliant.joints import DriveForce, DriveJoint, Fold, Gear, Hinge
from pliant.points import Handle, Joint, Point, PointMass, RigidBody
from pliant.readings import Energy, JointMotion, Track
from pliant.records import State, by_blocks
from pliant.surfaces import SurfaceBody
from pliant.typing import FloatArray

__all__ = ["Motion"]


class Motion(Lookup):
    """Readings about motion."""

    def positions(self, body: Handle | str) -> FloatArray:
        """Positions of the nodes of a body [m], shape (n, nodes, 3)."""
        return self._nodes(body, self._records.q)

    def velocities(self, body: Handle | str) -> FloatArray:
        """Velocities of the nodes of a body [m/s], shape (n, nodes, 3)."""
        return self._nodes(body, self._records.v)

    def track(self, point: Point | PointMass | RigidBody) -> Track:
        """Motion of a material point, interpolated in its element.

        Parameters
        ----------
        point : Point
            Such as ``rope.end`` or ``rope.at(0.3)``.

        Returns
        -------
        Track
            ``position``, ``velocity``, ``acceleration``, each (n, 3); ``orientation`` on rigid bodies and
            beams.
        """
        at = self.model._point(point, "point")
        records = self._records
        axes = None
        if at.local is not None:
            offsets = self._offsets(at.body)[1:] + np.arange(3)
            axes = np.ascontiguousarray(records.q[:, offsets])
        if at.offset is not None:
            offsets = self._offsets(at.body)[4 * at.element :, 0]
            gradients = [
                (1.0 - at.xi) * records.q[:, offsets[k] + np.arange(3)]
                + at.xi * records.q[:, offsets[k + 4] + np.arange(3)]
                for k in (2, 3)
            ]
            axes = section_axes(*gradients)
        position, velocity, acceleration = (self._at(at, rows) for rows in (records.q, records.v, records.a))
        return Track(position, velocity, acceleration, axes)

    def joint(self, joint: Joint) -> JointMotion:
        """Motion of a joint along its freedom: the angle of a hinge or fold, the way of a slider.

        Parameters
        ----------
        joint : Joint
            Handle that ``hinge``, ``slider`` or ``fold`` returned.

        Returns
        -------
        JointMotion
            ``position`` (zero at the model's start, or where the joint engaged) and ``velocity`` of the first
            body against the second, and the ``force`` that spring, damper, stops, drives and gears exert
            along it, each (n,). Of a fold the mean angle along the crease, 0 where flat, and the moment of
            all of it.
        """
        plan = self._plan_of(joint)
        records = self._records
        data = self.model._joints[joint.name]
        if isinstance(data, Fold):
            return self._fold(data, plan)
        motion = None
        if plan["kind"] == "multiplier":
            column = int(self._system.joint_outputs()[plan["index"], 1])
            turns = isinstance(self.model._joints[joint.name], Hinge)
            for rows, switch in self._poses(plan["index"]):
                read = partial(self._system.joint_motion, plan["index"], switch=switch)
                with translated():
                    if read(records.q[:1], records.v[:1]) is None:
                        break
                    if motion is None:
                        motion = np.zeros((len(records.time), 2))
                    motion[rows] = by_blocks(read, records.q, records.v, rows=rows)
                if switch is not None and turns:
                    motion[rows, 0] = np.unwrap(motion[rows, 0])
                elif switch is None and column >= 0:
                    motion[rows, 0] = records.outputs[rows, column]
        if motion is None:
            _check.fail(
                "joint",
                joint,
                "must be a hinge, a slider, a fold or a point that slides along a path: one number is free",
            )
        position, velocity = np.ascontiguousarray(motion.T)
        return JointMotion(position, velocity, self._along(joint.name))

    def _fold(self, joint: Fold, plan: dict[str, Any]) -> JointMotion:
        """Mean angle of a fold by length, its rate, and the moment about the crease."""
        assert joint.other is not None
        records = self._records
        weights = Crease(self.model, joint.edge, joint.other).lengths
        position, velocity, moment = np.zeros((3, len(records.time)))
        places, offsets = self._system.force_offsets(), self._system.joint_offsets()
        columns = self._system.joint_outputs()[:, 1]
        for index, weight in zip(plan["indices"], weights / weights.sum(), strict=True):
            with translated():
                motion = by_blocks(partial(self._system.joint_motion, index), records.q, records.v)
            position += weight * records.outputs[:, int(columns[index])]
            velocity += weight * motion[:, 1]
        for number in plan.get("springs", ()):
            moment += records.outputs[:, places[number, 0]]
        for index in plan.get("drives", ()):
            moment -= records.lambda_[:, offsets[index, 0]]
        return JointMotion(position, velocity, moment)

    def _along(self, name: str) -> FloatArray:
        """Sum of what acts along the freedom of a joint, (n,)."""
        total = np.zeros(len(self.time))
        places, offsets = self._system.force_offsets(), self._system.joint_offsets()
        for other, data in self.model._joints.items():
            if other == name or (isinstance(data, DriveForce) and data.joint == name):
                if other in self._lowered.forces:
                    total += self._records.outputs[:, places[self._lowered.forces[other], 0]]
                continue
            factor = 0.0
            if isinstance(data, DriveJoint) and data.joint == name:
                factor = -1.0
            elif isinstance(data, Gear):
                factor = -float(data.joint_a == name) + data.ratio * float(data.joint_b == name)
            if factor:
                total += factor * self._records.lambda_[:, offsets[self._lowered.plan[other]["index"], 0]]
        return total

    def state(self, i: int) -> State:
        """State at output ``i`` (negative numbers count from the end): a start for another run."""
        n = len(self.time)
        i = _check.count(i, "i", at_least=-n, at_most=n - 1)
        records = self._records
        bodies = {}
        lowered = self._lowered
        for name in lowered.bodies:
            offsets = self._offsets(name)
            rows = [
                vector[offsets[:, [column]] + np.arange(3)] if column < offsets.shape[1] else np.zeros((1, 3))
                for vector in (records.q[i], records.v[i])
                for column in (0, 1)
            ]
            bodies[name] = BodyState(*rows)
        grows = None if self._lowered.grows is None else tuple(self._lowered.grows)
        at = float(self.time[i])
        first = self._system.chamber_outputs() if lowered.chambers else np.zeros(0, dtype=np.int64)
        gas = {name: float(records.outputs[i][first[k] + 2]) for name, k in lowered.chambers.items()}
        past = {
            name: records.outputs[i][columns.ravel()]
            for name, columns in ((name, self._past_columns(name)) for name in lowered.cables)
            if columns.size
        }
        rows_of = (records.q[i], records.lambda_[i])
        return State(self.model, bodies, self.is_static, at, *rows_of, grows=grows, gas=gas, past=past)

    @property
    def energy(self) -> Energy:
        """Energies [J], each (n,)."""
        return Energy(*np.ascontiguousarray(self._records.energy[:].T))

    @property
    def momentum(self) -> FloatArray:
        """Linear momentum [kg m/s], (n, 3)."""
        return self._momentum()[0]

    @property
    def angular_momentum(self) -> FloatArray:
        """Angular momentum about the world's origin [kg m^2/s], (n, 3)."""
        return self._momentum()[1]

    @property
    def momentum_rate(self) -> FloatArray:
        """Rate of the linear momentum [N], (n, 3): what all forces from outside add up to."""
        return self._momentum(rate=True)[0]

    @property
    def angular_momentum_rate(self) -> FloatArray:
        """Rate of the angular momentum about the world's origin [N m], (n, 3)."""
        return self._momentum(rate=True)[1]

    def center_of_mass(self, body: Handle | str | None = None) -> FloatArray:
        """Centre of mass of the model or of one body [m], shape (n, 3)."""
        if body is None:
            mass = self._system.masses()[0]
            center: FloatArray = self._momentum()[2] / mass
            return center
        name = self._name(body)
        data = self.model._bodies[name]
        if isinstance(data, SurfaceBody):
            with translated():
                number = self._lowered.surfaces[name]
                middle: FloatArray = by_blocks(partial(self._system.surface_center, number), self._records.q)
                return middle
        if isinstance(data, BeamBody):
            with translated():
                beam = self._lowered.beams[name]
                center = by_blocks(partial(self._system.beam_center, beam), self._records.q)
                return center
        if not isinstance(data, LineBody):
            return self._nodes(name, self._records.q)[:, 0]
        offsets = self._offsets(name)[:, :, None] + np.arange(3)
        weights = element_masses(data)
        shapes = np.einsum("eg,keg->ek", weights, hermite(GAUSS_5[None, :], data.lengths[:, None]))
        index = np.stack([offsets[data.element_nodes + k // 2, k % 2] for k in range(4)], axis=1)
        total = np.zeros((len(self.time), 3))
        for k in range(4):
            total += np.einsum("e,nei->ni", shapes[:, k], self._records.q[:, index[:, k]])
        total /= weights.sum()
        return total
