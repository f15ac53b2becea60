"""Springs and drives, as methods of the model."""

from __future__ import annotations

from typing import Any

import numpy as np

from pliant import _check
from pliant._mechanism import Mechanism
from pliant.beams import BeamBody
from pliant.bodies import LineBody
from pliant.errors import ModelError
from pliant.forces import Spring
from pliant.joints import DriveAxis, DriveForce, DriveJoint, DrivePoint, Gear, Hinge, Slider, axis_of
from pliant.points import Joint, Load, RigidBody, require_handle
from pliant.rigid import RigidBodyData
from pliant.signals import Combination, Input, Signal, Table, as_signal
from pliant.typing import ArrayLike

__all__ = ["Drives"]


class Drives(Mechanism):
    """Springs and drives."""

    def add_spring(
        self,
        a: Any,
        b: Any,
        stiffness: float,
        damping: float = 0.0,
        length: float | None = None,
        *,
        name: str | None = None,
    ) -> Load:
        """Add a spring and damper between two points.

        Parameters
        ----------
        a : Point or RigidBody
            First point; of a bare rigid body its centre.
        b : Point, RigidBody or array_like, shape (3,)
            Second point, or a point fixed in the world.
        stiffness : float
            Force per stretch [N/m], from 0 on.
        damping : float
            Force per rate of the length [N s/m], from 0 on.
        length : float, optional
            Stress-free length [m]; None: the distance at the start. A spring of length 0 pulls by
            ``stiffness`` times the distance and damps motion in all directions alike: a bushing.

        Returns
        -------
        Load
            Handle for ``result.spring``.

        Examples
        --------
        >>> import pliant as pl
        >>> model = pl.Model(gravity=(0, 0, -9.81))
        >>> ball = model.add_point_mass(2.0, at=(0, 0, -1))
        >>> spring = model.add_spring(ball, (0, 0, 0), stiffness=100.0)
        >>> result = pl.solve_static(model)
        >>> print(f"{result.spring(spring).force[-1]:.2f}")
        19.62
        """
        first = self._point(a, "a")
        second = self._other(b, "b")
        if first == second:
            _check.fail("b", b, "is the same point")
        if length is None:
            length = float(np.linalg.norm(self._position(first) - self._position(second)))
        return self._add_load(
            Spring(
                self._new_name(name, "spring"),
                first,
                second,
                _check.number(stiffness, "stiffness", at_least=0),
                _check.number(damping, "damping", at_least=0),
                _check.number(length, "length", at_least=0),
            )
        )

    def drive(
        self,
        target: Any,
        *,
        position: Any = None,
        direction: Any = None,
        orientation: Any = None,
        axis: ArrayLike | None = None,
        angle: Any = None,
        rate: Any = None,
        torque: Any = None,
        force: Any = None,
        name: str | None = None,
    ) -> Joint:
        """Drive a point, a joint or a rigid body.

        Parameters
        ----------
        target : Point, Joint or RigidBody
            What is driven, and by what:

            - a point: ``position`` [m], three components in world axes; at a cable also or only
              ``direction``, that of its tangent (of any length);
            - a hinge: ``angle`` [rad], ``rate`` [rad/s] or ``torque`` [N m];
            - a slider: ``position`` [m], ``rate`` [m/s] or ``force`` [N];
            - a point of a beam: ``position`` and ``orientation`` of the section, either or both;
            - a rigid body: ``position`` of its centre and ``orientation``, either or both; or ``axis``,
              fixed in the world, with ``angle`` or ``rate``: that rotation only, beside any hinge.
        position, direction, angle, rate, torque, force
            A number or vector, a callable of time [s], a Table or a sum or product with a
            :class:`pliant.Ramp`. Angles and ways are 0 where the joint starts, and the value at the start
            must be where things are. What prescribes motion needs smooth values: of a Table ``smooth=True``.
            Callables are differenced by nine values at and after the start or a change of step, to about
            1e-9, 1e-6 and 1e-3 of the first three derivatives' size. Torques, forces and rates may jump and
            may be a :class:`pliant.Input`. In statics drives are evaluated at the load factor.
        orientation : Rotation or callable
            A :class:`scipy.spatial.transform.Rotation` from body or section axes to the world, or a
            callable of time that returns one.
        axis : array_like, shape (3,), optional
            Axis of the world about which a rigid body turns.

        Returns
        -------
        Joint
            Handle for ``result.reaction``: force and moment of the drive on what it drives.

        Examples
        --------
        >>> import pliant as pl
        >>> model = pl.Model()
        >>> disc = model.add_rigid_body(mass=2.0, shape=pl.Cylinder(0.1, 0.02))
        >>> shaft = model.hinge(disc.center)
        >>> motor = model.drive(shaft, angle=3.0 * pl.Ramp(1.0))
        >>> result = pl.simulate(model, duration=1.0, step=1e-2)
        >>> print(f"{result.joint(shaft).position[-1]:.6f} {abs(result.joint(shaft).force).max():.3f}")
        3.000000 0.173
        """
        given = {
            key: value
            for key, value in (
                ("position", position),
                ("direction", direction),
                ("orientation", orientation),
                ("axis", axis),
                ("angle", angle),
                ("rate", rate),
                ("torque", torque),
                ("force", force),
            )
            if value is not None
        }
        if isinstance(target, Joint):
            return self._drive_joint(target, given, name)
        if isinstance(target, RigidBody) and (
            "axis" in given or not given.keys() & {"position", "orientation"}
        ):
            return self._drive_axis(target, given, name)
        return self._drive_point(target, given, name)

    def _drive_joint(self, target: Joint, given: dict[str, Any], name: str | None) -> Joint:
        require_handle(target, "target", self._identity)
        joint = self._joints.get(target.name)
        if not isinstance(joint, (Hinge, Slider)):
            _check.fail("target", target, "must be a point, a rigid body, a hinge or a slider of this model")
        allowed = ("angle", "rate", "torque") if isinstance(joint, Hinge) else ("position", "rate", "force")
        key = _one_of(given, allowed)
        effort = key == allowed[2]
        signal = _smooth(given[key], key, 1, rate=key == "rate" or effort)
        if effort:
            return self._add_joint(DriveForce(self._new_name(name, "drive"), target.name, signal))
        for other in self._joints.values():
            if isinstance(other, DriveJoint) and other.joint == target.name:
                _check.fail("target", target, f"is driven by '{other.name}' already")
        return self._add_joint(DriveJoint(self._new_name(name, "drive"), target.name, signal, key == "rate"))

    def _drive_axis(self, target: RigidBody, given: dict[str, Any], name: str | None) -> Joint:
        point = self._point(target, "target")
        if "axis" not in given:
            _check.fail("axis", None, "must be given: the axis of the world about which the body turns")
        unit = axis_of(given.pop("axis"), "axis")
        key = _one_of(given, ("angle", "rate"))
        signal = _smooth(given[key], key, 1, rate=key == "rate")
        return self._add_joint(DriveAxis(self._new_name(name, "drive"), point, unit, signal, key == "rate"))

    def _drive_point(self, target: Any, given: dict[str, Any], name: str | None) -> Joint:
        point = self._point(target, "target")
        body = self._bodies[point.body]
        allowed = ["position"]
        if isinstance(body, LineBody):
            allowed.append("direction")
        if isinstance(body, (RigidBodyData, BeamBody)):
            allowed.append("orientation")
        _one_of(given, tuple(allowed), several=True)
        signals = {key: _smooth(given[key], key, 3) for key in ("position", "direction") if key in given}
        for value in signals.values():
            self._require_in_plane(body, value, "position" if "position" in given else "direction")
        axes: list[Signal] = []
        if "orientation" in given:
            axes = [as_signal(_axis_of(given["orientation"], k), "orientation", 3) for k in range(3)]
        return self._add_joint(
            DrivePoint(
                self._new_name(name, "drive"),
                point,
                signals.get("position"),
                signals.get("direction"),
                *axes,
            )
        )

    def gear(self, joint_a: Joint, joint_b: Joint, ratio: float, *, name: str | None = None) -> Joint:
        """Couple two hinges or sliders: the position of the first is ``ratio`` times that of the second.

        Parameters
        ----------
        joint_a, joint_b : Joint
            Hinges or sliders; a hinge and a slider make a rack and pinion.
        ratio : float
            Angle or way of ``joint_a`` over that of ``joint_b``, unlike zero; of wheels that turn against
            each other it is negative.

        Returns
        -------
        Joint
            Handle for ``result.reaction``: on the first body of ``joint_a``.

        Examples
        --------
        >>> import pliant as pl
        >>> model = pl.Model()
        >>> wheels = [model.add_rigid_body(mass=1.0, shape=pl.Cylinder(r, 0.01)) for r in (0.1, 0.2)]
        >>> small, large = (model.hinge(wheel.center) for wheel in wheels)
        >>> gear = model.gear(small, large, ratio=-2.0)
        >>> motor = model.drive(small, angle=pl.Ramp(1.0) * 4.0)
        >>> result = pl.simulate(model, duration=1.0, step=1e-2)
        >>> print(f"{result.joint(large).position[-1]:.6f}")
        -2.000000
        """
        names = []
        for key, joint in (("joint_a", joint_a), ("joint_b", joint_b)):
            if not isinstance(joint, Joint):
                _check.fail(key, joint, "must be a hinge or a slider of this model")
            require_handle(joint, key, self._identity)
            if not isinstance(self._joints.get(joint.name), (Hinge, Slider)):
                _check.fail(key, joint, "must be a hinge or a slider of this model")
            names.append(joint.name)
        if names[0] == names[1]:
            _check.fail("joint_b", joint_b, "must be another joint than joint_a")
        ratio = _check.number(ratio, "ratio")
        if ratio == 0:
            _check.fail("ratio", ratio, "must not be zero; a joint that shall not move takes a weld")
        return self._add_joint(Gear(self._new_name(name, "gear"), names[0], names[1], ratio))


def _one_of(given: dict[str, Any], allowed: tuple[str, ...], *, several: bool = False) -> str:
    """Return the one argument given, of those allowed for the target."""
    wrong = [key for key in given if key not in allowed]
    if wrong or not given or (len(given) > 1 and not several):
        what = "one or both" if several and len(allowed) > 1 else "one"
        key = wrong[0] if wrong else " and ".join(given) or allowed[0]
        _check.fail(
            key, given.get(key, tuple(given.values()) or None), f"give {what} of {', '.join(allowed)}"
        )
    return next(iter(given))


def _smooth(value: Any, name: str, size: int, *, rate: bool = False) -> Signal:
    """Return a signal; what prescribes motion (not ``rate``) must not jump in its slope."""
    if size == 1 and not callable(value):
        value = _check.number(value, name)
        signal = as_signal(value, name)
    else:
        signal = as_signal(value, name, size)
    if not rate:
        for part in _parts(signal):
            if isinstance(part, Table) and not part.smooth:
                _check.fail(
                    name,
                    value,
                    "a linear Table has jumps of slope, which are jumps of velocity and take infinite "
                    "forces: give the Table smooth=True",
                )
            if isinstance(part, Input):
                _check.fail(
                    name,
                    value,
                    "an Input jumps, which takes infinite forces: let it set a rate, a torque or a force",
                )
    return signal


def _parts(signal: Signal) -> list[Signal]:
    if isinstance(signal, Combination):
        return [part for term in signal.terms for part in _parts(term)]
    return [signal]


def _axis_of(orientation: Any, k: int) -> Any:
    """Return axis ``k`` of an orientation: a vector, or a callable of time."""
    from scipy.spatial.transform import Rotation

    allowed = "must be a scipy Rotation, or a callable of time that returns one"
    if isinstance(orientation, Rotation):
        if not orientation.single:
            _check.fail("orientation", orientation, allowed)
        return orientation.as_matrix()[:, k]
    if not callable(orientation):
        _check.fail("orientation", orientation, allowed)

    def axis(t: float) -> Any:
        found = orientation(t)
        if not isinstance(found, Rotation) or not found.single:
            raise ModelError(f"orientation at t = {t:g} s: {allowed}, not {found!r}")
        return found.as_matrix()[:, k]

    return axis
