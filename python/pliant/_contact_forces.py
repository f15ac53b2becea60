"""Readings of a result about contact."""

from __future__ import annotations

from typing import Any

import numpy as np

from pliant import _check
from pliant._forces import Forces
from pliant.contacts import ContactData
from pliant.points import Handle, Obstacle, require_handle
from pliant.readings import ContactPatch
from pliant.typing import FloatArray, IntArray

__all__ = ["ContactForces"]


class ContactForces(Forces):
    """Readings about contact."""

    def contact_force(self, a: Handle | str, b: Handle | str | None = None) -> FloatArray:
        """Force that contact exerts on a body.

        Parameters
        ----------
        a : body
            What the force acts on.
        b : body or Obstacle, optional
            What it comes from; None: from all that ``a`` touches.

        Returns
        -------
        ndarray, shape (n, 3)
            Normal and friction force, summed over the zones [N].
        """
        return self._contact_totals(a, b, 0)

    def contact_impulse(self, a: Handle | str, b: Handle | str | None = None) -> FloatArray:
        """Integral of :meth:`contact_force` over every step so far [N s], (n, 3)."""
        return self._contact_totals(a, b, 3)

    @property
    def contacts(self) -> list[list[ContactPatch]]:
        """Where bodies touch, and the forces there: for each output a list, one entry for each zone or end.

        The first of a run holds what touches at its start.

        Examples
        --------
        >>> import pliant as pl
        >>> model = pl.Model(gravity=(0, 0, -9.81))
        >>> rubber = pl.LinearElastic(youngs_modulus=1e6, poisson_ratio=0.45, density=1000.0)
        >>> line = [(0, 0, 0.0099), (0.2, 0, 0.0099)]
        >>> thin = pl.Circle(radius=0.01)
        >>> rope = model.add_cable(line, elements=2, section=thin, material=rubber, name="rope")
        >>> ground = model.add_obstacle(pl.HalfSpace(), name="ground")
        >>> touch = model.add_contact(rope, ground)
        >>> result = pl.simulate(model, duration=0.5, step=0.005)
        >>> patches = result.contacts[-1]
        >>> weight = sum(patch.normal_force for patch in patches)
        >>> print(patches[0].bodies, patches[0].normal, f"{weight:.2f}")
        ('rope', 'ground') [0. 0. 1.] 0.62
        """
        return [self._patches(rows) for rows in self._patch_rows(slice(None))]

    def _patch_rows(self, rows: slice | IntArray) -> list[FloatArray]:
        """Rows of the patches at some of the outputs."""
        records = self._records
        counts = records.touching[rows].astype(np.int64)
        return np.split(records.patches_of(rows), np.cumsum(counts)[:-1]) if len(counts) else []

    def _patches(self, rows: FloatArray) -> list[ContactPatch]:
        contacts = self._in_order
        found = []
        for row in rows:
            k = int(row[0])
            # The core tells what acts on the first side as it counts them.
            sign = 1.0 if self._first(k) == contacts[k].a else -1.0
            normal, friction = sign * row[4:7], sign * row[9:12]
            bodies = (contacts[k].a, contacts[k].b)
            found.append(ContactPatch(row[1:4], normal, float(row[7]), float(row[8]), friction, bodies))
        return found

    @property
    def _in_order(self) -> list[ContactData]:
        """Contacts in the order of the core: those of lines first."""
        lines = self._lowered.contacts
        return sorted(self.model._contacts.values(), key=lambda contact: contact.name not in lines)

    def _first(self, k: int) -> str:
        """Name of the body that the core's forces of contact number ``k`` act on."""
        contact, lines = self._in_order[k], self._lowered.contacts
        if contact.name not in lines:
            return contact.a
        slave = self._lowered.document["contacts"][k]["slave"]
        return contact.a if self._lowered.line(contact.a) == slave else contact.b

    def _contact_totals(self, a: Any, b: Any, first: int) -> FloatArray:
        on, by = self._partner(a, "a"), None if b is None else self._partner(b, "b")
        total = np.zeros((len(self.time), 3))
        contacts = self._in_order
        rows = self._records.outputs
        start = rows.shape[1] - 6 * len(contacts)
        found = False
        for k, contact in enumerate(contacts):
            if on not in (contact.a, contact.b):
                continue
            other = contact.b if contact.a == on else contact.a
            if by is not None and other != by:
                continue
            found = True
            if other == on:
                continue
            sign = 1.0 if self._first(k) == on else -1.0
            total += sign * rows[:, start + 6 * k + first :][:, :3]
        if not found:
            _check.fail(
                "b" if b is not None else "a", b if b is not None else a, "has no contact in this model"
            )
        return total

    def _partner(self, value: Any, name: str) -> str:
        if isinstance(value, str):
            known = {*self.model._bodies, *self.model._obstacles}
            if value not in known:
                _check.fail(name, value, f"must be one of {', '.join(sorted(known))}")
            return value
        if isinstance(value, Obstacle):
            require_handle(value, name, self.model.identity)
            return value.name
        self.model._body(value, name)
        named: str = value.name
        return named
