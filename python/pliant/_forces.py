"""Readings of a result about forces: reactions, axial forces, strains."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np

from pliant import _check
from pliant._lookup import Lookup
from pliant.bodies import GAUSS_5, MassBody, element_masses, hermite
from pliant.errors import translated
from pliant.forces import ForceData, Spring, Tendon
from pliant.gas import Chamber
from pliant.joints import EdgeJoint
from pliant.loads import Force, LineLoad
from pliant.points import Handle, Joint, Load, require_handle
from pliant.readings import (
    BeamStrain,
    ChamberGas,
    Reaction,
    SpringForce,
    Strain,
    SurfaceStrain,
    TendonForce,
)
from pliant.records import by_blocks
from pliant.signals import scaled
from pliant.surfaces import Faces
from pliant.typing import FloatArray

__all__ = ["Forces"]


class Forces(Lookup):
    """Readings about forces."""

    def reaction(self, joint: Joint) -> Reaction:
        """Force and moment that a joint exerts on its first body.

        Parameters
        ----------
        joint : Joint
            Handle that ``pin``, ``hinge`` or another joint returned.

        Returns
        -------
        Reaction
            ``force`` [N] and ``moment`` [N m] about the joint's point, each (n, 3), in world axes. Spring,
            damper and stops of a joint are in, drives are not: they have their own. Of pins that close a
            loop of pins at one place, the last carries nothing.
        """
        plan = self._plan_of(joint)
        records = self._records
        zero = np.zeros((len(self.time), 3))
        if plan["kind"] == "redundant":
            return Reaction(zero, zero.copy())
        own = np.zeros((len(self.time), 6))
        if joint.name in self._lowered.forces:
            first = self._system.force_offsets()[self._lowered.forces[joint.name], 0]
            own = records.outputs[:, first + 1 : first + 7]
        if plan["kind"] == "force":
            return Reaction(*np.ascontiguousarray(own.reshape(-1, 2, 3).swapaxes(0, 1)))
        if plan["kind"] == "multiplier":
            first = self._system.joint_outputs()[plan["index"], 0]
            if first >= 0:
                drive = records.outputs[:, first : first + 6]
                return Reaction(*np.ascontiguousarray(drive.reshape(-1, 2, 3).swapaxes(0, 1)))
            force, moment = self._multiplier_reaction(plan["index"])
            return Reaction(force + own[:, :3], moment + own[:, 3:])
        if plan["kind"] == "nodes":
            return self._edge_reaction(joint, plan)
        return Reaction(self._shared_force(plan), zero)

    def _multiplier_reaction(self, index: int) -> tuple[FloatArray, FloatArray]:
        """Force and moment of a joint of the core."""
        records = self._records
        force, moment = (np.zeros((len(self.time), 3)) for _ in range(2))
        for rows, switch in self._poses(index):
            with translated():
                force[rows], moment[rows] = by_blocks(
                    partial(self._system.reaction, index, switch=switch),
                    records.time,
                    records.q,
                    records.lambda_,
                    rows=rows,
                )
        return force, moment

    def _edge_reaction(self, joint: Joint, plan: dict[str, Any]) -> Reaction:
        """Sum over the nodes of an edge; the moment is about its first node."""
        records = self._records
        data = self.model._joints[joint.name]
        assert isinstance(data, EdgeJoint)
        places = self._nodes(data.a.body, records.q)
        center = self._at(data.a, records.q)
        force, moment = np.zeros_like(center), np.zeros_like(center)
        for index, node in zip(plan["indices"], plan["nodes"], strict=True):
            f, m = self._multiplier_reaction(index)
            force += f
            moment += m + np.cross(places[:, node] - center, f)
        return Reaction(force, moment)

    def spring(self, spring: Load) -> SpringForce:
        """Length and force of a spring.

        Parameters
        ----------
        spring : Load
            Handle that ``add_spring`` returned.

        Returns
        -------
        SpringForce
            ``length`` [m], ``rate`` [m/s] and ``force`` [N] (pulling: above zero), each (n,).
        """
        return SpringForce(*self._outputs(spring, Spring, "spring", "a spring of the model"))

    def tendon(self, tendon: Load) -> TendonForce:
        """Length and tensions of a tendon.

        Parameters
        ----------
        tendon : Load
            Handle that ``add_tendon`` returned.

        Returns
        -------
        TendonForce
            ``length`` [m] and ``tension`` at the pulled end [N], each (n,), and ``tensions`` of all spans
            from the pulled end on (n, spans).
        """
        numbers = self._outputs(tendon, Tendon, "tendon", "a tendon of the model")
        return TendonForce(numbers[0], numbers[1], np.ascontiguousarray(numbers[1:].T))

    def chamber(self, chamber: Load) -> ChamberGas:
        """Gas in a chamber.

        Parameters
        ----------
        chamber : Load
            Handle that ``add_chamber`` returned.

        Returns
        -------
        ChamberGas
            Absolute ``pressure`` [Pa], ``volume`` [m^3], ``mass`` [kg] and ``temperature`` [K], each (n,).
        """
        if not isinstance(chamber, Load):
            _check.fail("chamber", chamber, "must be a chamber of the model")
        require_handle(chamber, "chamber", self.model.identity)
        data = self.model._loads.get(chamber.name)
        if not isinstance(data, Chamber):
            _check.fail("chamber", chamber, "must be a chamber of the model")
        first = int(self._system.chamber_outputs()[self._lowered.chambers[chamber.name]])
        pressure, volume, mass = np.ascontiguousarray(self._records.outputs[:, first : first + 3].T)
        density = np.divide(mass, volume, out=np.full(len(mass), data.gas.density), where=volume > 0)
        return ChamberGas(pressure, volume, mass, pressure / (data.gas.gas_constant * density))

    def _outputs(self, load: object, kind: type[ForceData], name: str, what: str) -> FloatArray:
        """Numbers that a force of this kind shows, one a row, (numbers, n)."""
        if not isinstance(load, Load):
            _check.fail(name, load, f"must be {what}")
        require_handle(load, name, self.model.identity)
        if not isinstance(self.model._loads.get(load.name), kind):
            _check.fail(name, load, f"must be {what}")
        first, count = self._system.force_offsets()[self._lowered.forces[load.name]]
        return np.ascontiguousarray(self._records.outputs[:, first : first + count].T)

    def _shared_force(self, plan: dict[str, Any]) -> FloatArray:
        """Force of a pin that shares coordinates: what its first side needs beyond what else acts there."""
        records = self._records
        factor = self.time if self.is_static else np.ones_like(self.time)
        full = np.ones_like(self.time)
        grows = self._lowered.grows
        gravity = self.model.gravity * (factor if grows is None or "gravity" in grows else full)[:, None]
        total = np.zeros((len(self.time), 3))
        inner = [(name, int(node)) for name, node in plan["nodes"]]
        for name, node in inner:
            with translated():
                cable = self._lowered.cables[name]
                total += by_blocks(
                    partial(self._system.nodal_force, cable, node),
                    records.q,
                    records.v,
                    records.a,
                    records.outputs,
                )
        for name in plan["masses"]:
            mass = self.model._bodies[name]
            assert isinstance(mass, MassBody)
            assert mass.at is not None
            total += mass.mass * (self._at(mass.at, records.a) - gravity)
        for name, sign in plan["joints"]:
            total -= sign * self.reaction(Joint(name, self.model.identity)).force
        for load in self.model._loads.values():
            weight = 0.0
            for name, node in inner:
                if isinstance(load, LineLoad) and load.body == name:
                    weight += sum(self._body(name).lengths[e] / 2.0 for e, _ in self._ends(name, node))
                elif isinstance(load, Force) and load.at.body == name:
                    first, shape = self._body(name).shape(load.at.element, load.at.xi)
                    weight += float(shape[0] if first == node else shape[2] if first + 1 == node else 0.0)
            if weight != 0.0 and isinstance(load, (LineLoad, Force)):
                grown = factor if grows is None or load.name in grows else full
                values = [
                    scaled(load.value, float(t), float(f), self._held(i))
                    for i, (t, f) in enumerate(zip(self.time, grown, strict=True))
                ]
                total -= weight * np.array(values)
        if self.is_static:
            for name, node in inner:
                total += self._node_mass(name, node) * (self.model.gravity - gravity)
        return total

    def _held(self, i: int) -> dict[str, FloatArray]:
        """Give the inputs at output i by name."""
        rows = self._records.inputs
        return {
            name: rows[i, first : first + len(initial)] if rows.shape[1] else np.array(initial)
            for name, (first, initial) in self._lowered.held.items()
        }

    def _ends(self, name: str, node: int) -> list[tuple[int, int]]:
        """Elements that meet at a strand node, with the end (0 or 1) that lies there."""
        first = self._body(name).element_nodes
        return [(int(e), end) for end in (0, 1) for e in np.flatnonzero(first + end == node)]

    def _node_mass(self, name: str, node: int) -> float:
        """Share of a uniform acceleration's force that acts on a strand node's position [kg]."""
        body = self._body(name)
        return sum(
            float(element_masses(body)[e] @ hermite(GAUSS_5, np.array(body.lengths[e]))[2 * end])
            for e, end in self._ends(name, node)
        )

    def axial_force(self, body: Handle | str) -> FloatArray:
        """Axial force [N] at mid-element, (n, elements); of a net the mean in each cable, (n, cables)."""
        if self._name(body) in self._lowered.beams:
            return np.ascontiguousarray(self._beam_strain(self._name(body))[..., 6])
        data, name = self._line(body)
        with translated():
            force: FloatArray = by_blocks(
                partial(self._system.axial_force, self._lowered.cables[name]),
                self._records.q,
                self._records.outputs,
            )
        if data.kind == "cable":
            return force
        starts = np.concatenate([[0], np.cumsum(data.strands)[:-1]])
        total = np.add.reduceat(force * data.lengths, starts, axis=1)
        mean: FloatArray = total / np.add.reduceat(data.lengths, starts)
        return mean

    def cut_force(self, faces: Faces) -> FloatArray:
        """Force [N] through a cut: what the rest of a surface exerts on some of its faces, (n, 3).

        The cut is the line of nodes that these faces share with others; inertia, damping and gravity of the
        faces are accounted for, so that it balances with the momentum of what it holds to rounding. What acts
        on the line itself, pressure on the faces beside it, too, counts as acting on the rest.

        Parameters
        ----------
        faces : Faces
            Such as ``sheet.faces(mask)``.

        Examples
        --------
        >>> import pliant as pl
        >>> model = pl.Model(gravity=(0, 0, -9.81))
        >>> film = pl.SaintVenantKirchhoff(youngs_modulus=2e9, poisson_ratio=0.3, density=1400.0)
        >>> mesh = pl.Mesh([(0, 0, 0), (1, 0, 0), (0, 0, -1), (1, 0, -1), (0, 0, -2), (1, 0, -2)],
        ...                quads=[(0, 2, 3, 1), (2, 4, 5, 3)])
        >>> curtain = model.add_membrane(mesh, thickness=1e-5, material=film)
        >>> rail = model.pin(curtain.edge([(0, 0, 0), (1, 0, 0)]))
        >>> result = pl.solve_static(model)
        >>> print(f"{result.cut_force(curtain.faces([1]))[-1, 2]:.5f}")
        0.13734
        """
        if not isinstance(faces, Faces):
            _check.fail("faces", faces, "must be faces of a surface, such as sheet.faces([0, 1])")
        self.model._check_part(faces, "faces")
        name = self._name(faces.body)
        chosen = np.zeros(self.model._surface(name).elements, dtype=bool)
        chosen[list(faces.numbers)] = True
        if chosen.all():
            _check.fail("faces", str(faces), "must leave some faces to the rest of the surface")
        grows = self._lowered.grows
        grown = self.is_static and (grows is None or "gravity" in grows)
        factor = self.time if grown else np.ones_like(self.time)
        records = self._records
        with translated():
            force: FloatArray = by_blocks(
                partial(self._system.cut_force, self._lowered.surfaces[name], chosen.tolist()),
                self.model.gravity * factor[:, None],
                records.q,
                records.v,
                records.a,
            )
        return force

    def strain(self, body: Handle | str) -> Strain | BeamStrain | SurfaceStrain:
        """Strains in the middle of elements.

        Parameters
        ----------
        body : body or str
            Of cables and nets a :class:`Strain`: ``axial`` (n, elements), the vector of ``curvature`` [1/m]
            (n, elements, 3), and the ``plastic`` part of the axial strain (n, elements). Of shells and
            membranes a :class:`SurfaceStrain`: ``membrane`` and ``bending`` (n, faces, 3), and the ``regime``
            (n, faces) of films. Of beams a :class:`BeamStrain`, which also has ``shear``.
        """
        surface = self._name(body)
        if surface in self._lowered.surfaces:
            with translated():
                number = self._lowered.surfaces[surface]
                rows = by_blocks(partial(self._system.surface_strain, number), self._records.q)
            return SurfaceStrain(rows[..., :3].copy(), rows[..., 3:6].copy(), rows[..., 6].astype(np.int64))
        if surface in self._lowered.beams:
            rows = self._beam_strain(surface)
            return BeamStrain(rows[..., 0].copy(), rows[..., 3:6].copy(), rows[..., 1:3].copy())
        _, name = self._line(body)
        with translated():
            axial, curvature = by_blocks(
                partial(self._system.strain, self._lowered.cables[name]),
                self._records.q,
                self._records.outputs,
            )
        columns = self._past_columns(name)
        plastic = np.zeros_like(axial)
        if columns.size:
            middle = columns[:, columns.shape[1] // 2, 0]
            plastic = by_blocks(lambda rows: rows[:, middle], self._records.outputs)
        return Strain(axial, curvature, plastic)

    def _beam_strain(self, name: str) -> FloatArray:
        """Numbers of a beam at mid-element, (n, elements, 7)."""
        with translated():
            read = partial(self._system.beam_strain, self._lowered.beams[name])
            rows: FloatArray = by_blocks(read, self._records.q)
            return rows
