"""A solar sail of four trapezoidal films, let go from a folded cross on a spinning hub."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from pliant import _check
from pliant.materials import SaintVenantKirchhoff
from pliant.mesh import Mesh
from pliant.model import Model
from pliant.points import Point
from pliant.readings import SurfaceStrain
from pliant.result import Result
from pliant.scenes.scene import Expected, Scene
from pliant.shapes import Cylinder
from pliant.typing import FloatArray, IntArray

__all__ = ["SailSizes", "solar_sail"]


@dataclass(frozen=True)
class SailSizes:
    """Sizes of a sail; lengths in m, the rest in SI units.

    Four petals, isosceles trapezoids with edges of 45 degrees, tile a square with a square hole. Each has
    ``rows`` rows of square cells parallel to its base, a right triangle at either end.

    Attributes
    ----------
    cell : float
        Side of a cell.
    base_cells : int
        Cells along the inner base, a multiple of 8.
    rows : int
        Rows of cells: the outer base has ``base_cells + 2 rows`` cells.
    arc_cells : int
        Cells of the folded film that lie on 45 degrees of the hub.
    thickness, youngs_modulus, poisson_ratio, density : float
        Film; the density stands for all it carries. The rig's is polyimide, a hundred times softer: it is
        strained by less than 1e-3, and steps of a millisecond resolve it.
    tip_mass : float
        Mass at each corner of the sail [kg].
    hub_mass, hub_inertia, hub_height : float
        Hub [kg], about its axis [kg m^2], [m].
    tether_stiffness : float
        Force per stretch of a tether [N/m].
    spin : float
        Angular velocity at the start [rad/s].
    driven : bool
        Whether a motor keeps the hub at that rate; else it turns freely.
    """

    cell: float = 0.05
    base_cells: int = 16
    rows: int = 8
    arc_cells: int = 4
    thickness: float = 25e-6
    youngs_modulus: float = 2.5e7
    poisson_ratio: float = 0.34
    density: float = 1420.0
    tip_mass: float = 0.02
    hub_mass: float = 1.0
    hub_inertia: float = 0.0324
    hub_height: float = 0.1
    tether_stiffness: float = 300.0
    spin: float = 20.0 * 2 * np.pi / 60
    driven: bool = True

    def __post_init__(self) -> None:
        for name in ("cell", "thickness", "youngs_modulus", "density", "hub_mass", "hub_inertia"):
            _check.number(getattr(self, name), name, above=0)
        for name in ("tip_mass", "hub_height", "tether_stiffness"):
            _check.number(getattr(self, name), name, above=0)
        _check.number(self.spin, "spin")
        _check.flag(self.driven, "driven")
        for name in ("base_cells", "rows", "arc_cells"):
            _check.count(getattr(self, name), name)
        if self.base_cells % 8:
            _check.fail("base_cells", self.base_cells, "must be a multiple of 8: tethers meet nodes")
        if self.arc_cells > self.base_cells // 2:
            _check.fail("arc_cells", self.arc_cells, "at most half of base_cells")

    @classmethod
    def named(cls, name: str, **changes: Any) -> SailSizes:
        """Sizes of the test rig, ``"rig"``, or of the sail in space, ``"ikaros"``, with changes."""
        return cls(**{**SIZES[_check.choice(name, "sizes", SIZES)], **changes})

    @property
    def base(self) -> float:
        """Half of the inner base, and its distance from the axis [m]."""
        return 0.5 * self.base_cells * self.cell

    @property
    def half(self) -> float:
        """Half of the side of the square [m]."""
        return self.base + self.rows * self.cell

    @property
    def area(self) -> float:
        """Area of the film [m^2]."""
        return 4.0 * (self.half**2 - self.base**2)

    @property
    def areal_density(self) -> float:
        """Mass per area [kg/m^2]."""
        return self.density * self.thickness

    @property
    def inertia(self) -> float:
        """Moment of inertia of the flat sail about its axis, without the hub [kg m^2]."""
        film = self.areal_density * 8.0 / 3.0 * (self.half**4 - self.base**4)
        return film + 4 * self.tip_mass * 2 * self.half**2

    @property
    def hub_radius(self) -> float:
        """Radius of the hub: ``arc_cells`` cells are 45 degrees of it [m]."""
        return 4.0 * self.arc_cells * self.cell / np.pi

    @property
    def fold_radius(self) -> float:
        """Radius of the nodes on the hub: chords there are as long as cells [m]."""
        return float(0.5 * self.cell / np.sin(np.pi / (8 * self.arc_cells)))

    @property
    def tethers(self) -> IntArray:
        """Cells from the middle of the inner base to the nodes that tethers hold."""
        return self.base_cells // 8 * np.array([-3, -1, 1, 3])

    def tension(self, c: float) -> float:
        """Give the normal force through the cut at distance c of the flat sail in steady spin [N].

        ``N = omega^2 (sigma 2 a (a^2 - c^2)/2 + 2 m a)`` with half the side a, whatever the film is made of.
        """
        a, sigma = self.half, self.areal_density
        return self.spin**2 * (sigma * a * (a * a - c * c) + 2 * self.tip_mass * a)

    def grid(self) -> tuple[IntArray, IntArray, IntArray, IntArray]:
        """Nodes (cells along x, rows), quadrilaterals and triangles of a petal."""
        widths = self.base_cells // 2 + np.arange(self.rows + 1)
        first = np.concatenate([[0], np.cumsum(2 * widths + 1)])
        x = np.concatenate([np.arange(-w, w + 1) for w in widths])
        y = np.repeat(np.arange(self.rows + 1), 2 * widths + 1)
        quads, triangles = [], []
        for k, w in enumerate(widths[:-1]):
            below, above = first[k] + w, first[k + 1] + w + 1  # where x = 0
            for i in range(-w, w):
                quads.append((below + i, above + i, above + i + 1, below + i + 1))
            triangles.append((below + w, above + w, above + w + 1))
            triangles.append((below - w, above - w - 1, above - w))
        return x, y, np.array(quads), np.array(triangles)

    def flat(self, petal: int) -> FloatArray:
        """Nodes of a petal in the flat sail, (nodes, 3)."""
        x, y, _, _ = self.grid()
        out, along = _axes(petal)
        return (self.base + self.cell * y)[:, None] * out + (self.cell * x)[:, None] * along

    def cross(self, petal: int) -> FloatArray:
        """Nodes of a petal folded to the cross, (nodes, 3).

        Folded like an accordion along the rows to a strip as wide as a cell, whose middle lies on the hub and
        whose halves stand out along the diagonals, each beside a half of the neighbour. No cell is strained.
        """
        x, y, _, _ = self.grid()
        angle = 0.5 * np.pi * petal + 0.25 * np.pi * np.clip(x / self.arc_cells, -1.0, 1.0)
        radius = self.fold_radius + self.cell * np.maximum(0, np.abs(x) - self.arc_cells)
        z = np.where(y % 2 == 0, -0.5, 0.5) * self.cell
        return np.column_stack([radius * np.cos(angle), radius * np.sin(angle), z])


SIZES: dict[str, dict[str, Any]] = {
    "rig": {},
    # Tsuda et al.: 14 m square of four petals, 0.5 kg at its corners. The film's density stands for all that
    # it carries, 14 kg; tethers of aramid, a millimetre thick.
    "ikaros": {
        "cell": 0.2,
        "rows": 27,
        "arc_cells": 3,
        "thickness": 7.5e-6,
        "youngs_modulus": 3.2e9,
        "poisson_ratio": 0.3,
        "density": 14.0 / 185.76 / 7.5e-6,
        "tip_mass": 0.5,
        "hub_mass": 290.0,
        "hub_inertia": 90.5,
        "hub_height": 0.95,
        "tether_stiffness": 5e4,
        "spin": 7.4 * 2 * np.pi / 60,
        "driven": False,
    },
}


def _axes(petal: int) -> tuple[FloatArray, FloatArray]:
    """Directions outwards and along the base of a petal."""
    angle = 0.5 * np.pi * petal
    out = np.array([np.cos(angle), np.sin(angle), 0.0])
    return np.round(out), np.round(np.array([-out[1], out[0], 0.0]))


def solar_sail(
    sizes: str | SailSizes = "rig",
    *,
    start: str = "folded",
    wrinkling: bool | float = 1e-4,
    retardation_time: float = 1e-4,
    tether_damping: float = 0.0,
    bump: float = 0.0,
    gravity: float = 0.0,
    duration: float = 0.5,
    step: float = 1e-3,
    output_every: int = 10,
    **changes: Any,
) -> Scene:
    """Build the scene: a spinning hub throws out a folded sail, which opens to a square.

    Parameters
    ----------
    sizes : {"rig", "ikaros"} or SailSizes
        ``"rig"``: a test rig of 1.6 m side whose hub is driven at 20 revolutions a minute, 16 triangles and
        184 squares a petal. ``"ikaros"``: the sail of 14 m side behind a free hub, 54 triangles and 1134
        squares a petal, as the stoppers let it go at 7.4 revolutions a minute.
    start : {"folded", "flat"}
        Folded to a cross without strain, or the flat square; both turn like a rigid body.
    wrinkling : bool or float
        As for :meth:`pliant.Model.add_membrane`; False: the film carries compression.
    retardation_time : float
        Damping of the film [s].
    tether_damping : float
        Damping of the tethers [N s/m].
    bump : float
        Radial velocity that the release gives to the tips [m/s], less towards the hub.
    gravity : float
        Gravity along the axis, downwards [m/s^2].
    duration, step, output_every
        Of the run: [s], [s], steps between outputs.
    **changes
        Attributes of :class:`SailSizes`, such as ``tip_mass=0.03``.

    Returns
    -------
    Scene
        With ``model``, ``simulate()``, ``measure(result)`` and ``expected``. Bodies are ``hub`` and
        ``petal1`` to ``petal4``, joints ``shaft``, ``motor`` and ``seam1`` to ``seam4``, tethers
        ``tether1`` to ``tether16``, masses ``tip1`` to ``tip8``, two at each corner.

    Notes
    -----
    ``measure`` returns over the times of the result: ``"tip radius"``, ``"tip lag"`` behind the hub, ``"tip
    height"`` (n, 4); ``"area"`` projected on the plane of spin over that of the film (what is seen from
    behind counts below zero); ``"torque"`` of the motor, ``"angular momentum"`` without the hub,
    ``"hub rate"``, ``"wrinkled"`` and ``"slack"`` parts of the film's area, ``"tether tension"`` (n, 16),
    energies; and numbers: those of ``expected``, and ``"t98"``, when the mean tip radius passes 98 per cent
    of the flat sail's.
    """
    if isinstance(sizes, str):
        sizes = SailSizes.named(sizes, **changes)
    elif changes:
        _check.fail("changes", changes, "go with the name of sizes; dataclasses.replace changes a SailSizes")
    elif not isinstance(sizes, SailSizes):
        _check.fail("sizes", sizes, 'must be "rig", "ikaros" or a SailSizes')
    start = _check.choice(start, "start", ("folded", "flat"))
    sail = _Sail(sizes, start == "flat")
    sail.build(wrinkling, retardation_time, tether_damping, bump, gravity)
    return Scene(
        name="solar_sail",
        title="a spinning hub throws out a folded solar sail of four films",
        model=sail.model,
        # As in contact: with less damping of fast motions films that snap taut gain energy.
        settings={
            "duration": duration,
            "step": step,
            "output_every": output_every,
            "spectral_radius": 0.5,
        },
        expected=sail.expected(gravity),
        measures=sail.measure,
        color="speed",
    )


class _Sail:
    """The model of a sail and what is measured of it."""

    def __init__(self, sizes: SailSizes, flat: bool) -> None:
        self.sizes, self.is_flat = sizes, flat
        self.x, self.y, self.quads, self.triangles = sizes.grid()
        self.corner = int(np.flatnonzero((self.y == sizes.rows) & (self.x == self.x.max()))[0])
        self.anchors: list[tuple[Point, Point]] = []

    def node(self, x: int, y: int) -> int:
        """Return the number of a node of a petal."""
        return int(np.flatnonzero((self.x == x) & (self.y == y))[0])

    def build(
        self,
        wrinkling: bool | float,
        retardation_time: float,
        tether_damping: float,
        bump: float,
        gravity: float,
    ) -> None:
        s = self.sizes
        model = self.model = Model(gravity=(0.0, 0.0, -gravity))
        film = SaintVenantKirchhoff(
            s.youngs_modulus, s.poisson_ratio, s.density, retardation_time=retardation_time
        )
        turning = (0.0, 0.0, s.spin)
        across = 0.25 * s.hub_mass * s.hub_radius**2 + s.hub_mass * s.hub_height**2 / 12
        hub = model.add_rigid_body(
            mass=s.hub_mass,
            inertia=(max(across, 0.6 * s.hub_inertia),) * 2 + (s.hub_inertia,),
            shape=Cylinder(s.hub_radius, s.hub_height),
            angular_velocity=turning,
            name="hub",
        )
        shaft = model.hinge(hub.center, name="shaft")
        if s.driven:
            model.drive(shaft, rate=s.spin, name="motor")
        tips, petals = 0, []
        folded_tip = float(np.linalg.norm(s.cross(0)[self.corner, :2]))
        for j in range(4):
            places = s.flat(j) if self.is_flat else s.cross(j)
            radius = np.linalg.norm(places[:, :2], axis=1)
            outwards = places * [1.0, 1.0, 0.0] / radius[:, None]
            share = (radius - s.fold_radius) / (folded_tip - s.fold_radius)
            petal = model.add_membrane(
                Mesh(s.flat(j), self.quads, self.triangles),
                thickness=s.thickness,
                material=film,
                wrinkling=wrinkling,
                initial=None if self.is_flat else places,
                velocity=bump * share[:, None] * outwards,
                angular_velocity=turning,
                name=f"petal{j + 1}",
            )
            petals.append(petal)
            out, along = _axes(j)
            for i in s.tethers.tolist():
                anchor = s.base * out + i * s.cell * along
                reach = float(np.linalg.norm(anchor))
                length = reach - s.hub_radius
                ends = hub.at(anchor * s.hub_radius / reach), petal.node(self.node(i, 0))
                model.add_tendon(
                    ends,
                    length=length,
                    stiffness=s.tether_stiffness * length,
                    damping=tether_damping,
                    name=f"tether{len(self.anchors) + 1}",
                )
                self.anchors.append(ends)
            for side in (-1, 1):
                tips += 1
                corner = self.node(side * self.x.max(), s.rows)
                model.add_point_mass(0.5 * s.tip_mass, at=petal.node(corner), name=f"tip{tips}")
        rim = [s.base_cells // 2 + k for k in range(s.rows + 1)]
        for j in range(4):
            right = [s.flat(j)[self.node(w, k)] for k, w in enumerate(rim)]
            edges = petals[j].edge(right), petals[(j + 1) % 4].edge(right)
            model.weld(*edges, name=f"seam{j + 1}")

    def expected(self, gravity: float) -> dict[str, Expected]:
        """Tell what closed forms say."""
        s = self.sizes
        expected = {
            "momentum balance": Expected(0.0, 1e-8, "rate of angular momentum = torque of the motor"),
            "work balance": Expected(0.0, 2e-2, "conserved; the scheme damps fast motions of slack film"),
            "momentum across": Expected(0.0, 1e-5, "nothing pushes aside before the tethers tauten"),
        }
        if self.is_flat and gravity == 0.0:
            # By the mean strain the sail is wider than stress-free; its inner corners by some times that.
            strain = s.tension(s.base) / (2 * s.half * s.youngs_modulus * s.thickness)
            wider = 1e-3 + 10 * strain
            for name, c in (("base", s.base), ("middle", s.base + 0.5 * self.sizes.rows * s.cell)):
                value = s.tension(c)
                source = "centrifugal force of what lies outside the cut"
                expected[f"tension at the {name}"] = Expected(value, wider * value, source)
            value = s.inertia * s.spin
            expected["angular momentum at the end"] = Expected(value, wider * value, "closed form")
        return expected

    # Measurements

    def measure(self, result: Result) -> dict[str, Any]:
        """Read everything from a result."""
        s = self.sizes
        rate = result.joint(result.model["shaft"]).velocity
        angle = result.joint(result.model["shaft"]).position
        places = np.stack([result.positions(f"petal{j + 1}") for j in range(4)], axis=1)
        tips = places[:, :, self.corner]
        direction = np.arctan2(tips[..., 1], tips[..., 0])
        corner_angle = angle[:, None] + 0.25 * np.pi + 0.5 * np.pi * np.arange(4)
        lag = (corner_angle - direction + np.pi) % (2 * np.pi) - np.pi
        radius = np.linalg.norm(tips[..., :2], axis=-1)
        torque = np.zeros(len(result.time))
        if s.driven:
            torque = result.reaction(result.model["motor"]).moment[:, 2]
        energy = result.energy
        shares = np.concatenate([np.ones(len(self.quads)), np.full(len(self.triangles), 0.5)])
        shares /= 4 * shares.sum()
        regime = [self._regime(result, f"petal{j + 1}") for j in range(4)]
        flat_radius = np.sqrt(2.0) * s.half
        open_ = np.flatnonzero(radius.mean(axis=1) > 0.98 * flat_radius)
        change = result.angular_momentum_rate[:, 2]
        most = max(np.abs(torque).max(), np.abs(change).max(), 1e-2 * s.inertia * s.spin**2)
        tension = np.stack([result.tendon(result.model[f"tether{k + 1}"]).tension for k in range(16)], axis=1)
        hanging = np.logical_and.accumulate(tension.max(axis=1) == 0.0)
        across = np.abs(result.momentum[:, :2]) * hanging[:, None]
        weight = s.areal_density * s.area + 4 * s.tip_mass
        return {
            "time": result.time,
            "tip radius": radius,
            "tip lag": lag,
            "tip height": tips[..., 2],
            "area": self._projected(places) / s.area,
            "torque": torque,
            "hub rate": rate,
            "angular momentum": result.angular_momentum[:, 2] - s.hub_inertia * rate,
            "kinetic": energy.kinetic,
            "elastic": energy.elastic,
            "dissipated": energy.dissipated,
            "work": energy.work,
            "wrinkled": sum((r == 1) @ shares for r in regime),
            "slack": sum((r == 2) @ shares for r in regime),
            "tether tension": tension,
            "t98": float(result.time[open_[0]]) if len(open_) else np.nan,
            "momentum balance": float(np.abs(change - torque).max() / most),
            "work balance": float(np.abs(energy.total - energy.total[0]).max() / energy.kinetic[0]),
            "momentum across": float(across.max() / (weight * abs(s.spin) * s.half)),
            "angular momentum at the end": float(result.angular_momentum[-1, 2] - s.hub_inertia * rate[-1]),
            "tension at the base": float(self.tension(result, s.base)[-1]),
            "tension at the middle": float(self.tension(result, s.base + 0.5 * s.rows * s.cell)[-1]),
        }

    @staticmethod
    def _regime(result: Result, petal: str) -> IntArray:
        strain = result.strain(petal)
        assert isinstance(strain, SurfaceStrain)
        return strain.regime

    def _projected(self, places: FloatArray) -> FloatArray:
        """Sum of the faces' areas on the plane of spin, with sign, (n,)."""
        total = np.zeros(len(places))
        for faces in (self.quads, self.triangles):
            corners = places[:, :, faces, :2]
            a = corners[..., 2, :] - corners[..., 0, :]
            b = corners[..., -1, :] - corners[..., 1, :] if faces.shape[1] == 4 else None
            if b is None:
                b = corners[..., 2, :] - corners[..., 1, :]
            total += 0.5 * (a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]).sum(axis=(1, 2))
        return total

    def tension(self, result: Result, c: float) -> FloatArray:
        """Force along the first petal's axis that holds what lies beyond the distance c [N], (n,).

        What pulls at the film nearer to the axis, and the tethers of nodes beyond: seams between petals join
        nodes of the cut, which count as beyond.
        """
        angle = result.joint(result.model["shaft"]).position
        outwards = np.column_stack([np.cos(angle), np.sin(angle), np.zeros(len(angle))])
        total = np.zeros((len(angle), 3))
        for j in (0, 1, 3):
            flat = self.sizes.flat(j)
            middles = np.concatenate([flat[f][:, :, 0].mean(axis=1) for f in (self.quads, self.triangles)])
            nearer = middles < c
            if nearer.any():
                total += result.cut_force(result.model[f"petal{j + 1}"].faces(nearer))
            for k in range(4 * j, 4 * j + 4):
                hub, node = self.anchors[k]
                if flat[node.node, 0] > c - 1e-6 * self.sizes.cell:
                    way = result.track(node).position - result.track(hub).position
                    way /= np.linalg.norm(way, axis=1)[:, None]
                    total += result.tendon(result.model[f"tether{k + 1}"]).tension[:, None] * way
        force: FloatArray = (total * outwards).sum(axis=1)
        return force
