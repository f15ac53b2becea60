"""Methods of the model for shells and membranes."""

from __future__ import annotations

from typing import Any

import numpy as np

from pliant import _check
from pliant._mechanism import Mechanism
from pliant.joints import EdgeJoint, axis_of
from pliant.loads import EdgeLoad, EdgeMoment, Pressure
from pliant.materials import Material
from pliant.points import Handle, Joint, Load, Point, RigidBody, require_handle
from pliant.signals import as_signal
from pliant.surfaces import Edge, Faces, Membrane, Shell, SurfaceBody, make_surface
from pliant.typing import ArrayLike

__all__ = ["Sheets"]


class Sheets(Mechanism):
    """Surfaces, what holds their edges, and what loads them."""

    def add_shell(
        self,
        mesh: Any,
        *,
        thickness: Any,
        material: Material,
        element: str = "auto",
        quadrature: str = "standard",
        bending: str = "exact",
        integrals: str = "quadrature",
        initial: ArrayLike | None = None,
        velocity: Any = None,
        angular_velocity: ArrayLike = (0.0, 0.0, 0.0),
        name: str | None = None,
    ) -> Shell:
        """Add a shell: a thin surface that stretches and bends.

        Parameters
        ----------
        mesh : Mesh or meshio.Mesh
            The stress-free surface.
        thickness : float or array_like, shape (faces,)
            Thickness [m], above 0.
        material : LinearElastic, SaintVenantKirchhoff or NeoHookean
            The material; the first two are one law here.
        element : {"auto", "bicubic", "cylindrical", "plate", "triangle"}
            ``"bicubic"``: r, r_u, r_v and r_uv at each node, on meshes with common (u, v) directions.
            ``"cylindrical"``: r and r_u, for strips and tubes that bend along u only: no plate.
            ``"plate"`` and ``"triangle"``: r and both slopes, on plane meshes, in one mesh together.
            ``"auto"`` takes the best that the mesh allows.
        quadrature : {"standard", "reduced", "full"}
            ``"reduced"`` takes fewer points for the membrane, against locking of coarse curved shells (of
            triangles and plates for bending, too); ``"full"`` takes more points than are needed.
        bending : {"exact", "simplified"}
            ``"simplified"``: curvatures are the second derivatives of the position, their forces linear and
            quick. For flat surfaces with small membrane strains and no damping.
        integrals : {"quadrature", "precomputed"}
            ``"precomputed"``: the membrane's energy is integrated exactly, from integrals of products of
            shape functions computed once. For ``"cylindrical"`` and ``"plate"`` with a linear material.
        initial : array_like, shape (nodes, 3), optional
            Positions at the start [m], where they are not the stress-free ones; slopes follow smoothly.
        velocity : array_like, shape (3,) or (nodes, 3), or callable, optional
            Velocity at the start [m/s]; a callable takes the initial positions (n, 3) and returns (n, 3).
        angular_velocity : array_like, shape (3,)
            Angular velocity at the start about the world's origin [rad/s].
        name : str, optional
            Name; else ``shell1``, ``shell2``, ...

        Returns
        -------
        Shell
            Handle with ``node(i)``, ``at(point)``, ``edge(points)`` and ``faces(select)``.

        Examples
        --------
        >>> import pliant as pl
        >>> model = pl.Model(gravity=(0, 0, -9.81))
        >>> rubber = pl.SaintVenantKirchhoff(youngs_modulus=1e6, poisson_ratio=0.3, density=1000.0)
        >>> square = pl.Mesh.rectangle(1, 1, divisions=(4, 4))
        >>> sheet = model.add_shell(square, thickness=0.01, material=rubber)
        >>> _ = model.pin(sheet.node(0))
        >>> model.dof, model.constraints
        (300, 3)
        """
        body = make_surface(
            mesh,
            name=self._new_name(name, "shell"),
            kind="shell",
            element=element,
            thickness=thickness,
            material=material,
            quadrature=quadrature,
            bending=bending,
            integrals=integrals,
            wrinkling=False,
            initial=initial,
            velocity=velocity,
            angular_velocity=angular_velocity,
        )
        self._bodies[body.name] = body
        return Shell(body.name, self._identity, body)

    def add_membrane(
        self,
        mesh: Any,
        *,
        thickness: Any,
        material: Material,
        wrinkling: bool | float = True,
        quadrature: str = "standard",
        initial: ArrayLike | None = None,
        velocity: Any = None,
        angular_velocity: ArrayLike = (0.0, 0.0, 0.0),
        name: str | None = None,
    ) -> Membrane:
        """Add a membrane: a film without bending, whose mesh edges may all fold.

        Parameters
        ----------
        mesh : Mesh or meshio.Mesh
            The stress-free surface, quadrilaterals and triangles.
        thickness, material, initial, velocity, angular_velocity, name
            As for :meth:`add_shell`; the name is ``membrane1``, ``membrane2``, ... otherwise.
        wrinkling : bool or float
            Whether the film wrinkles and goes slack instead of carrying compression; a number is the part of
            the elastic law that it keeps then, 1e-3 by default. Rubber (``NeoHookean``) does not.
        quadrature : {"standard", "full"}
            ``"full"`` takes one more point a direction.

        Returns
        -------
        Membrane
            Handle with ``node(i)``, ``at(point)``, ``edge(points)`` and ``faces(select)``.

        Examples
        --------
        >>> import pliant as pl
        >>> model = pl.Model()
        >>> film = pl.SaintVenantKirchhoff(youngs_modulus=2e9, poisson_ratio=0.3, density=1400.0)
        >>> mesh = pl.Mesh.rectangle(2, 1, divisions=(4, 2))
        >>> sail = model.add_membrane(mesh, thickness=7e-6, material=film)
        >>> model.dof
        45
        """
        if not isinstance(wrinkling, (bool, np.bool_)):
            wrinkling = _check.number(wrinkling, "wrinkling", at_least=0, at_most=1)
        body = make_surface(
            mesh,
            name=self._new_name(name, "membrane"),
            kind="membrane",
            element="membrane",
            thickness=thickness,
            material=material,
            quadrature=quadrature,
            bending="exact",
            integrals="quadrature",
            wrinkling=wrinkling,
            initial=initial,
            velocity=velocity,
            angular_velocity=angular_velocity,
        )
        self._bodies[body.name] = body
        return Membrane(body.name, self._identity, body)

    def symmetry(self, edge: Edge, normal: ArrayLike, *, name: str | None = None) -> Joint:
        """Make an edge lie in a plane of symmetry: it stays there, the surface crosses it at right angles.

        Parameters
        ----------
        edge : Edge
            Such as ``sheet.edge(points)``.
        normal : array_like, shape (3,)
            Normal of the plane; the edge must lie in a plane with this normal at the start.

        Returns
        -------
        Joint
            Handle for ``result.reaction``.

        Examples
        --------
        >>> import pliant as pl
        >>> model = pl.Model()
        >>> rubber = pl.SaintVenantKirchhoff(youngs_modulus=1e6, poisson_ratio=0.3, density=1000.0)
        >>> square = pl.Mesh.rectangle(1, 1, divisions=(4, 4))
        >>> sheet = model.add_shell(square, thickness=0.01, material=rubber)
        >>> model.symmetry(sheet.edge("u_min"), normal=(1, 0, 0)).name
        'symmetry1'
        """
        edge = self._edge(edge, "edge")
        unit = axis_of(normal, "normal")
        body = self._surface(edge.body)
        off = (body.r[list(edge.nodes)] - body.r[edge.nodes[0]]) @ np.array(unit)
        if np.abs(off).max() > 1e-6 * self._size():
            _check.fail(
                "normal", normal, f"the edge leaves a plane with this normal by {np.abs(off).max():.3g} m"
            )
        return self._hold("symmetry", edge, name, axes=(unit,))

    def add_pressure(
        self, surface: Shell | Membrane | Faces, pressure: Any, *, name: str | None = None
    ) -> Load:
        """Add a pressure on faces, along their normal (of the order of the corners) wherever it turns.

        Parameters
        ----------
        surface : Shell, Membrane or Faces
            The surface, or ``sheet.faces(select)``.
        pressure : float, callable, Table or Ramp
            Pressure [Pa].

        Returns
        -------
        Load
            Handle.

        Examples
        --------
        >>> import pliant as pl
        >>> model = pl.Model()
        >>> film = pl.NeoHookean(youngs_modulus=1e6, poisson_ratio=0.5, density=1000.0)
        >>> square = pl.Mesh.rectangle(1, 1, divisions=(4, 4))
        >>> sheet = model.add_membrane(square, thickness=1e-3, material=film)
        >>> model.add_pressure(sheet, 10.0).name
        'pressure1'
        """
        faces = self._one_part(surface, "surface")
        value = as_signal(pressure, "pressure", 1)
        return self._add_load(Pressure(self._new_name(name, "pressure"), faces, value))

    def add_edge_moment(self, edge: Edge, moment_per_length: Any, *, name: str | None = None) -> Load:
        """Add a moment per stress-free length on an edge of a shell, about the edge.

        The axis is the direction in which the edge runs at the start, from its first point to its last; it
        stays in space.

        Parameters
        ----------
        edge : Edge
            Such as ``sheet.edge(points)``.
        moment_per_length : float, callable, Table or Ramp
            Moment per length [N].

        Returns
        -------
        Load
            Handle.

        Examples
        --------
        >>> import pliant as pl
        >>> model = pl.Model()
        >>> steel = pl.LinearElastic(youngs_modulus=2.1e11, poisson_ratio=0.3, density=7850.0)
        >>> mesh = pl.Mesh.rectangle(1, 0.1, divisions=(8, 1))
        >>> strip = model.add_shell(mesh, thickness=1e-3, material=steel)
        >>> model.add_edge_moment(strip.edge("u_max"), 2.0).name
        'edge_moment1'
        """
        edge = self._edge(edge, "edge")
        if self._surface(edge.body).element in ("membrane",):
            _check.fail("edge", str(edge), "a membrane carries no moment; take a shell")
        value = as_signal(moment_per_length, "moment_per_length", 1)
        return self._add_load(EdgeMoment(self._new_name(name, "edge_moment"), edge, value))

    # Shared by the methods of points

    def _pin_directions(self, point: Any, directions: Any, name: str | None) -> Joint:
        """Hold some directions of a node or an edge of a surface."""
        axes: tuple[Any, ...] = ()
        if directions is not None:
            flat = isinstance(directions, (tuple, list, np.ndarray)) and np.ndim(directions) == 1
            rows = _check.array([directions] if flat else directions, "directions", (None, 3))
            axes = tuple(axis_of(row, "directions") for row in rows)
        if isinstance(point, Point):
            at = self._point(point, "point")
            if at.node is None or not isinstance(self._bodies[at.body], SurfaceBody):
                _check.fail("directions", directions, "are there for nodes and edges of surfaces")
            point = Edge(at.identity, at.body, (at.node,), ())
        return self._hold("pin", self._edge(point, "point"), name, axes=axes)

    def _edge_load(self, edge: Edge, value: Any, name: str | None) -> Load:
        self._edge(edge, "cable")
        signal = as_signal(value, "force_per_length", 3)
        return self._add_load(EdgeLoad(self._new_name(name, "line_load"), edge, signal))

    def _surface(self, name: str) -> SurfaceBody:
        body = self._bodies[name]
        assert isinstance(body, SurfaceBody)
        return body

    def _edge(self, edge: object, name: str) -> Edge:
        if isinstance(edge, Handle):
            require_handle(edge, name, self._identity)
        if not isinstance(edge, Edge):
            _check.fail(name, edge, "must be an edge of a shell or membrane, such as sheet.edge(points)")
        self._check_part(edge, name)
        return edge

    def _hold(
        self,
        kind: str,
        edge: Edge | Faces,
        name: str | None,
        *,
        other: Edge | None = None,
        axes: Any = (),
        holder: str | None = None,
    ) -> Joint:
        """Add a joint of an edge (or of faces)."""
        self._check_part(edge, "edge")
        body = self._surface(edge.body)
        if isinstance(edge, Faces):
            nodes = sorted({int(node) for face in edge.numbers for node in body.corners(face)})
            edge = Edge(edge.identity, edge.body, tuple(nodes), ())
        point = body.node_point(self._identity, edge.nodes[0])
        name = self._new_name(name, kind)
        return self._add_joint(EdgeJoint(name, point, kind, edge, other, axes, holder))

    def _pin_to_body(self, edge: Edge, body: RigidBody, name: str | None) -> Joint:
        """Pin an edge to a rigid body."""
        require_handle(body, "to", self._identity)
        return self._hold("pin", self._edge(edge, "point"), name, holder=body.name)

    def _weld_edges(self, a: Edge, b: Edge, name: str | None) -> Joint:
        """Join two edges with matching nodes."""
        a, b = self._matching(a, b, ("a", "b"))
        return self._hold("weld", a, name, other=b)

    def _matching(self, a: Edge, b: Edge, names: tuple[str, str]) -> tuple[Edge, Edge]:
        """Two edges whose nodes coincide, in the same order."""
        self._edge(a, names[0]), self._edge(b, names[1])
        first, second = self._surface(a.body), self._surface(b.body)
        if len(a.nodes) != len(b.nodes):
            _check.fail(names[1], str(b), f"must have as many nodes as {names[0]}, {len(a.nodes)}")
        p, q = first.r[list(a.nodes)], second.r[list(b.nodes)]
        if np.linalg.norm(p[0] - q[0]) > np.linalg.norm(p[0] - q[-1]):
            b = Edge(b.identity, b.body, b.nodes[::-1], b.sides[::-1])
            q = q[::-1]
        gap = float(np.linalg.norm(p - q, axis=1).max())
        if gap > 1e-6 * self._size():
            _check.fail(names[1], str(b), f"the nodes must coincide at the start, but are {gap:.6g} m apart")
        return a, b
