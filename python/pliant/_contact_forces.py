"""Readings of a result about contact."""

from __future__ import annotations

from typing import Any

import numpy as np

from pliant import _check
from pliant._forces import Forces
from pliant.points import Handle, Obstacle, require_handle
from pliant.typing import FloatArray

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

    def _contact_totals(self, a: Any, b: Any, first: int) -> FloatArray:
        on, by = self._partner(a, "a"), None if b is None else self._partner(b, "b")
        total = np.zeros((len(self.time), 3))
        contacts = list(self.model._contacts.values())
        rows = self._records.outputs
        start = rows.shape[1] - 6 * len(contacts)
        lowered = self._lowered
        lines = lowered.contacts
        others = [contact.name for contact in contacts if contact.name not in lines]
        found = False
        for contact in contacts:
            if on not in (contact.a, contact.b):
                continue
            other = contact.b if contact.a == on else contact.a
            if by is not None and other != by:
                continue
            found = True
            if other == on:
                continue
            if contact.name in lines:
                k = lines[contact.name]
                is_first = lowered.cables.get(on) == lowered.document["contacts"][k]["slave"]
            else:
                k = len(lines) + others.index(contact.name)
                is_first = on == contact.a
            sign = 1.0 if is_first else -1.0
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
