"""The compiled core: systems built from lowered model documents, and what can be done with them.

Arrays are float64 and C-contiguous; n counts outputs, nq coordinates, nv velocities, nl multipliers.
"""

from collections.abc import Callable, Sequence
from typing import Any, TypedDict

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

class ModelError(ValueError):
    """A model document is wrong; the message names the place, the value and the remedy."""

class ConvergenceError(RuntimeError):
    """A solve failed. ``args`` are the message and a dict with ``time``, ``step``, ``iterations``,
    ``residuals`` (list of float), ``unknown`` (text such as "cable 'rope', node 3, slope y")."""

class Records(TypedDict):
    """What was recorded: one row an output."""

    time: FloatArray  # (n,) [s], or load factors
    q: FloatArray  # (n, nq)
    v: FloatArray  # (n, nv)
    a: FloatArray  # (n, nv)
    lambda_: FloatArray  # (n, nl)
    energy: FloatArray  # (n, 5) kinetic, elastic, gravitational, dissipated, work [J]
    inputs: FloatArray  # (n, inputs that are set from outside)
    outputs: FloatArray  # (n, what the forces show, one after the other)
    switches: FloatArray  # (n,) rows of history before each output
    history: FloatArray  # (k, 5 + pose) time, joint, engaged, gap, size of the pose, pose

class System:
    """A model made ready to compute with.

    ``spec`` is the lowered document (JSON), whose ``{"array": k}`` entries point into ``arrays``.
    """

    def __init__(self, spec: str, arrays: Sequence[FloatArray]) -> None: ...
    @property
    def coordinates(self) -> int: ...
    @property
    def velocities(self) -> int: ...
    @property
    def multipliers(self) -> int: ...
    @property
    def initial_q(self) -> FloatArray: ...
    @property
    def initial_v(self) -> FloatArray: ...
    def cable_offsets(self, cable: int) -> IntArray:
        """Offsets in q of each node's position and slope, shape (nodes, 2)."""
    def shared_offsets(self) -> IntArray:
        """Offsets in q of the shared points, shape (p,)."""
    def rigid_offsets(self) -> IntArray:
        """Offsets in q of the centres of the rigid bodies, whose three axes follow, shape (bodies,)."""
    def surface_offsets(self) -> IntArray:
        """First coordinate of each surface, number of its nodes, nodal vectors at each, (surfaces, 3)."""
    def joint_offsets(self) -> IntArray:
        """First multiplier and number of multipliers of each joint, then of each rigid body, (k, 2)."""
    def force_offsets(self) -> IntArray:
        """First number among the outputs and number of numbers of each force, (k, 2)."""
    def redundant(self) -> list[tuple[str, int, list[str]]]:
        """Joints with equations that follow from others at the start: joint, how many, from which joints."""
    def overlaps(self, q: FloatArray | None = None) -> list[tuple[str, float, float]]:
        """Contacts whose sides overlap by much at q: name, depth, half the thickness of the thinner [m]."""
    def chamber_outputs(self) -> IntArray:
        """First number among the outputs of each chamber: absolute pressure, volume, mass, (k,)."""
    def past_outputs(self) -> IntArray:
        """For each cable the first number among the outputs of what its points remember of having yielded,
        and how many numbers each element has, (k, 2); none where it does not yield."""
    def joint_outputs(self) -> IntArray:
        """For each joint the first of six numbers among the outputs (force and moment of a drive) and the
        number of its freedom's value, (k, 2); -1 where there is none."""
    def describe_solver(self) -> str: ...
    def masses(self) -> tuple[float, FloatArray]:
        """Total mass [kg] and first moment at the start, shape (3,) [kg m]."""
    def cable_mass(self, cable: int) -> float: ...
    def integrator(
        self,
        *,
        spectral_radius: float,
        tolerance: float | None = None,
        threads: int = 1,
        q: FloatArray | None = None,
        v: FloatArray | None = None,
        held: Sequence[float] = [],
        inputs: Callable[[float], FloatArray] | None = None,
        saved: bytes | None = None,
    ) -> Integrator:
        """Starts at ``q``, ``v`` (default: the document's), made consistent with the joints, or continues
        what was ``saved``. ``held`` are inputs set from outside, ``inputs`` gives those that follow."""
    def solve_static(
        self,
        *,
        load_steps: int = 1,
        tolerance: float | None = None,
        stable: bool = True,
        arc_length: bool = False,
        growing: tuple[bool, list[int]] | None = None,
        fade: bool = False,
        q: FloatArray | None = None,
        lambda_: FloatArray | None = None,
        inputs: Callable[[float], FloatArray] | None = None,
        poll: Callable[[float], None] | None = None,
    ) -> Records:
        """Equilibria at the load factors reached, the last at 1. ``poll(load_factor)`` may raise to stop.

        ``growing``: whether gravity grows with the load factor and the numbers of the loads that do
        (default: everything); ``fade``: what is out of balance at the start fades. Beside the records,
        ``unstable`` holds the load factors at which the equilibrium is unstable, and ``critical`` the
        critical points of a path: number of the record, whether it is a bifurcation, shape.
        """
    def is_conservative(self) -> bool:
        """Whether there is neither damping nor a force without potential."""
    def linear(
        self,
        *,
        q: FloatArray | None = None,
        lambda_: FloatArray | None = None,
        t: float = 0.0,
        load_factor: bool = False,
        growing: tuple[bool, list[int]] | None = None,
        inputs: Callable[[float], FloatArray] | None = None,
    ) -> dict[str, Any]:
        """Small motions about a state: entries of ``mass``, ``damping``, ``stiffness`` and ``jacobian`` (with
        its transpose) at ``rows`` and ``columns``, to be summed; multipliers come after all coordinates."""
    def solve_modes(
        self,
        count: int,
        *,
        q: FloatArray | None = None,
        lambda_: FloatArray | None = None,
        t: float = 0.0,
        load_factor: bool = False,
        growing: tuple[bool, list[int]] | None = None,
        inputs: Callable[[float], FloatArray] | None = None,
    ) -> tuple[FloatArray, FloatArray]:
        """Squares of angular frequencies (count,) ascending [1/s^2], shapes (count, nv), mass-normalised."""
    def axial_force(self, cable: int, q: FloatArray, outputs: FloatArray) -> FloatArray:
        """Axial force [N] at mid-element, shape (n, elements), of states (n, nq)."""
    def strain(self, cable: int, q: FloatArray, outputs: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Axial strain (n, elements) and material curvature vector [1/m] (n, elements, 3) at mid-element."""
    def beam_offsets(self) -> IntArray:
        """First coordinate of each beam and number of its nodes, (beams, 2)."""
    def beam_strain(self, beam: int, q: FloatArray) -> FloatArray:
        """Axial strain, shear (2), twist and curvatures (3), axial force at mid-element, (n, elements, 7)."""
    def beam_center(self, beam: int, q: FloatArray) -> FloatArray:
        """Centre of mass of a beam, (n, 3)."""
    def beam_mass(self, beam: int) -> float: ...
    def surface_strain(self, surface: int, q: FloatArray) -> FloatArray:
        """Membrane strain (11, 22, 12), change of curvature (11, 22, 12) [1/m] and regime at the middle of
        each face, (n, faces, 7)."""
    def cut_force(
        self,
        surface: int,
        chosen: list[bool],
        gravity: FloatArray,
        q: FloatArray,
        v: FloatArray,
        a: FloatArray,
    ) -> FloatArray:
        """Force [N] that the rest of the surface exerts on the chosen faces, shape (n, 3)."""
    def surface_center(self, surface: int, q: FloatArray) -> FloatArray:
        """Centre of mass [m], (n, 3)."""
    def surface_mass(self, surface: int) -> float: ...
    def reaction(
        self,
        joint: int,
        time: FloatArray,
        q: FloatArray,
        lambda_: FloatArray,
        switch: FloatArray | None = None,
    ) -> tuple[FloatArray, FloatArray]:
        """Force [N] and moment [N m] that the joint exerts on its first point, each (n, 3)."""
    def joint_motion(
        self, joint: int, q: FloatArray, v: FloatArray, switch: FloatArray | None = None
    ) -> FloatArray | None:
        """Freedom of a joint and its rate, (n, 2): angle [rad] from -pi to pi, or way [m]; else None."""
    def nodal_force(
        self,
        cable: int,
        node: int,
        q: FloatArray,
        v: FloatArray,
        a: FloatArray,
        outputs: FloatArray,
    ) -> FloatArray:
        """Force [N] that everything else exerts on this cable's node (inertia included), shape (n, 3)."""
    def momentum(self, q: FloatArray, v: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Linear and angular momentum (about the world origin) and first moment of mass, each (n, 3)."""

class Integrator:
    """A run in progress."""

    @property
    def time(self) -> float: ...
    @property
    def projection(self) -> float:
        """Size of the correction that joints forced on the initial velocities [m/s]."""
    @property
    def steps(self) -> int:
        """Steps since the start."""
    def advance(
        self,
        steps: int,
        step: float,
        output_every: int = 0,
        *,
        end: float | None = None,
        seconds: float = 0.1,
    ) -> int:
        """Takes up to ``steps`` steps, the last of which lands on the time ``end``, records every
        ``output_every``-th (counted from the start), stops after about ``seconds`` of wall time; returns the
        number taken. The state of a failed step is the one before it."""
    @property
    def next_event(self) -> float | None:
        """Time of the next scheduled event: a step must end there."""
    def switch(self, joint: int, engage: bool, gap: float | None = None) -> None:
        """Engages or releases a joint now; nothing has changed where that fails."""
    def advance_freely(
        self,
        end: float,
        *,
        rtol: float,
        atol: float,
        max_step: float,
        steps: int = ...,
        output_every: int = 0,
        seconds: float = 0.1,
    ) -> int:
        """Takes steps as long as the local error allows, ``rtol`` times the model's size plus ``atol`` [m],
        none past the time ``end`` or a kink of a load; otherwise as ``advance``."""
    def set_inputs(self, first: int, values: Sequence[float]) -> None:
        """Sets inputs from number ``first`` on: they hold at the end of the next step."""
    def save(self) -> bytes:
        """Everything that a continuation with the same bits needs, beside model and options."""
    def reset(self, saved: bytes) -> None:
        """Goes to a saved state and forgets what was recorded."""
    def record(self) -> None:
        """Records the present state."""
    def present(self) -> Records:
        """The present state as one row."""
    def records(self) -> Records:
        """What was recorded since the last call."""
    @property
    def q(self) -> FloatArray: ...
    @property
    def v(self) -> FloatArray: ...
    def combine(self, offsets: list[int], weights: list[float], velocities: bool) -> FloatArray:
        """Weighted sum of vectors of three coordinates, or of their velocities, that begin at the offsets."""
    def statistics(self) -> dict[str, Any]:
        """``steps``, ``rejected``, ``newton_iterations``, ``factorizations`` and ``seconds`` by part."""

def cable_element(cable: str, q: FloatArray, v: FloatArray) -> dict[str, Any]:
    """One cable element for tests and teaching: ``energy`` [J], ``force`` (12,), ``tangent`` (elastic),
    ``damping`` and ``mass`` (12, 12) at coordinates (r1, t1, r2, t2) and their rates. ``cable`` is a JSON
    document like that of a cable of one element in a model document, with its arrays inside."""

def lugre(
    coefficients: FloatArray, time: FloatArray, velocity: FloatArray, normal: FloatArray, end_rule: bool
) -> tuple[FloatArray, FloatArray]:
    """Force and deflection (n, 3) of the LuGre law for ``velocity`` (n, 3); ``coefficients`` are mu_s, mu_d,
    v_s, alpha, sigma_0, sigma_1, sigma_2 of a force."""

__version__: str

def surface_shape(kind: str, chart: FloatArray, at: tuple[float, float]) -> FloatArray:
    """Shape functions of a surface element at a place, (nodal vectors, 6): N, N_u, N_v, N_uu, N_vv, N_uv.

    ``chart`` (corners, 2): parameters of the corners.
    """
