"""Methods of the model for what moves surfaces from inside: gas, and changes of their rest curvature."""

from __future__ import annotations

from typing import Any

import numpy as np

from pliant import _check
from pliant._closure import Closure
from pliant._sheets import Sheets
from pliant.forces import Curvature
from pliant.gas import Chamber, Gas
from pliant.points import Load
from pliant.signals import as_signal
from pliant.surfaces import Faces, Membrane, Shell
from pliant.typing import FloatArray

__all__ = ["Pneumatics"]


class Pneumatics(Sheets):
    """Chambers and rest curvature."""

    def add_chamber(
        self,
        faces: Any,
        gas: Gas | None = None,
        inflow: Any = 0.0,
        ambient: float = 101325.0,
        *,
        name: str | None = None,
    ) -> Load:
        """Add a chamber: faces that enclose a gas.

        The gas fills the volume at the start with its pressure. Faces need normals that point out of the gas,
        of one body or of several whose rims meet and are welded. Rims that are held, or lie in a plane of
        symmetry, need nothing more; any other rim is closed by a light lid, whose pressure the rim carries.

        Parameters
        ----------
        faces : Shell, Membrane, Faces, or a sequence of these
            What encloses the gas: bodies, or ``sheet.faces(select)``.
        gas : Gas, optional
            The gas at the start; by default air of the standard atmosphere, isothermal.
        inflow : float, callable, Table, product with a Ramp, or Input
            Mass that flows in per time [kg/s], on the same curve of pressure over density. In statics the
            load factor stands for the time: a constant has flowed in for one second at full load.
        ambient : float
            Absolute pressure of the surroundings [Pa], from 0 on.
        name : str, optional
            Name; else ``chamber1``, ``chamber2``, ...

        Returns
        -------
        Load
            Handle for ``result.chamber``.

        Examples
        --------
        A flat sheet over a hole is blown up by 2 g of air:

        >>> import pliant as pl
        >>> model = pl.Model()
        >>> rubber = pl.NeoHookean(youngs_modulus=1e6, poisson_ratio=0.5, density=1000.0)
        >>> sheet = model.add_membrane(
        ...     pl.Mesh.rectangle(0.2, 0.2, divisions=(4, 4)), thickness=1e-3, material=rubber
        ... )
        >>> rim = [model.pin(sheet.edge(side)) for side in ("u_min", "u_max", "v_min", "v_max")]
        >>> chamber = model.add_chamber(sheet, inflow=2e-3)
        >>> result = pl.solve_static(model)
        >>> print(f"{result.chamber(chamber).volume[-1] * 1e3:.2f} l")
        1.58 l
        """
        parts = self._faces(faces)
        chamber = Chamber(
            self._new_name(name, "chamber"),
            parts,
            Gas() if gas is None else gas,
            as_signal(inflow, "inflow", 1),
            ambient,
        )
        closure = Closure(self, parts, chamber.name)
        volume, area = self._enclosed(closure)
        if volume < -1e-3 * area**1.5:
            _check.fail(
                "faces",
                ", ".join(map(str, parts)),
                f"the normals point into the gas, whose volume would be {volume:.3g} m^3; reverse the order "
                "of the corners",
            )
        return self._add_load(chamber)

    def add_curvature(self, body: Any, curvature: Any, *, name: str | None = None) -> Load:
        """Change the rest curvature of a shell in time: actuation from inside.

        Parameters
        ----------
        body : Shell or Faces
            The body, or ``sheet.faces(select)``.
        curvature : float or array_like, shape (3,), callable, Table, product with a Ramp, or Input
            What the rest curvature gains [1/m]: along u, or its components (11, 22, 12) in the frame whose
            first axis is along u; positive towards the normal. Strips that are free roll up by it.

        Examples
        --------
        A strip becomes half a ring:

        >>> import numpy as np
        >>> import pliant as pl
        >>> model = pl.Model()
        >>> rubber = pl.SaintVenantKirchhoff(youngs_modulus=1e6, poisson_ratio=0.0, density=1000.0)
        >>> mesh = pl.Mesh.rectangle(1, 0.1, divisions=(8, 1))
        >>> strip = model.add_shell(mesh, thickness=1e-2, material=rubber)
        >>> wall = model.clamp(strip.edge("u_min"))
        >>> muscle = model.add_curvature(strip, np.pi)
        >>> result = pl.solve_static(model, load_steps=4)
        >>> print(f"{result.positions(strip)[-1, -1, 2]:.3f}")
        0.637
        """
        faces = self._one_part(body, "body")
        if self._surface(faces.body).kind == "membrane":
            _check.fail("body", body, "a membrane has no curvature at rest; take a shell")
        if self._surface(faces.body).bending == "simplified":
            _check.fail(
                "body", body, 'must have bending="exact"; simplified bending has no curvature at rest'
            )
        value = as_signal(curvature, "curvature")
        if value.size == 1:
            value = value * np.array([1.0, 0.0, 0.0])
        elif value.size != 3:
            _check.fail("curvature", curvature, "must have one component or three (11, 22, 12)")
        return self._add_load(Curvature(self._new_name(name, "curvature"), faces, value))

    def _faces(self, faces: Any) -> tuple[Faces, ...]:
        several = [faces] if isinstance(faces, (Shell, Membrane, Faces)) else faces
        if isinstance(several, (str, dict)) or not np.iterable(several):
            several = [faces]
        parts: dict[str, Faces] = {}
        for part in several:
            part = self._one_part(part, "faces")
            if part.body in parts:
                numbers = tuple(dict.fromkeys((*parts[part.body].numbers, *part.numbers)))
                part = Faces(part.identity, part.body, numbers)
            parts[part.body] = part
        if not parts:
            _check.fail("faces", faces, "must be shells, membranes or sheet.faces(...), one at least")
        return tuple(parts.values())

    def _enclosed(self, closure: Closure) -> tuple[float, float]:
        """Volume and area at the start of the polyhedron of the nodes; without the caps of held rims."""
        volume = area = 0.0
        for part in closure.faces:
            r: FloatArray = self._surface(part.body).r - closure.origin
            for face in part.numbers:
                corners = r[self._surface(part.body).corners(face)]
                for k in range(1, len(corners) - 1):
                    normal = np.cross(corners[k] - corners[0], corners[k + 1] - corners[0]) / 2
                    volume += float(corners[0] @ normal) / 3
                    area += float(np.linalg.norm(normal))
        return volume, area
