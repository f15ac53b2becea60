"""Values over time: constants, callables of t, tables and ramps. They add and multiply."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from pliant import _check
from pliant.errors import ModelError
from pliant.typing import ArrayLike, FloatArray, Json

__all__ = ["Function", "Input", "Ramp", "Signal", "Table", "as_signal"]


class Signal(ABC):
    """A value over time. Signals add and multiply with each other and with numbers, vectors and callables."""

    __array_ufunc__ = None  # numpy leaves array * signal to the signal

    @property
    @abstractmethod
    def size(self) -> int:
        """Number of components."""

    @abstractmethod
    def __call__(self, t: float) -> FloatArray:
        """Value at time t [s], shape (size,)."""

    @abstractmethod
    def document(self, register: Callable[[Function | Input], int]) -> Json:
        """Write the signal for the core; ``register`` numbers the callables and inputs."""

    def functions(self) -> Iterator[Function]:
        """Callables inside."""
        return iter(())

    def inputs(self) -> Iterator[Input]:
        """Every input inside."""
        return iter(())

    @property
    def constant(self) -> bool:
        """Whether the value never changes."""
        return False

    def __add__(self, other: object) -> Signal:
        return _combine("sum", self, other)

    def __radd__(self, other: object) -> Signal:
        return _combine("sum", other, self)

    def __mul__(self, other: object) -> Signal:
        return _combine("product", self, other)

    def __rmul__(self, other: object) -> Signal:
        return _combine("product", other, self)

    def __neg__(self) -> Signal:
        return _combine("product", -1.0, self)

    def __sub__(self, other: object) -> Signal:
        return self + (-as_signal(other, "term"))

    def __rsub__(self, other: object) -> Signal:
        return as_signal(other, "term") + (-self)


@dataclass(frozen=True)
class Constant(Signal):
    """The same at all times."""

    value: tuple[float, ...]

    def __post_init__(self) -> None:
        values = _check.array(self.value, "value", (None,))
        object.__setattr__(self, "value", tuple(float(x) for x in values))

    @property
    def size(self) -> int:
        """Number of components."""
        return len(self.value)

    @property
    def constant(self) -> bool:
        """Whether the value never changes."""
        return True

    def __call__(self, t: float) -> FloatArray:
        """Value at time t [s], shape (size,)."""
        return np.array(self.value)

    def document(self, register: Callable[[Function | Input], int]) -> Json:
        """Write the signal for the core."""
        return {"constant": list(self.value)}


@dataclass(frozen=True, eq=False)
class Function(Signal):
    """A Python callable of time [s]."""

    function: Callable[[float], ArrayLike]
    components: int

    @property
    def size(self) -> int:
        """Number of components."""
        return self.components

    def __call__(self, t: float) -> FloatArray:
        """Value at time t [s], shape (size,)."""
        value = np.atleast_1d(np.asarray(self.function(t)))
        if (
            value.shape != (self.components,)
            or value.dtype.kind not in "iuf"
            or not np.all(np.isfinite(value))
        ):
            _check.fail(
                f"value at t = {t:g} s", value, f"the callable must return {self.components} finite numbers"
            )
        return value.astype(np.float64)

    def functions(self) -> Iterator[Function]:
        """Callables inside."""
        yield self

    def document(self, register: Callable[[Function | Input], int]) -> Json:
        """Write the signal for the core."""
        return {"input": {"first": register(self), "size": self.components}}


@dataclass(frozen=True, eq=False)
class Table(Signal):
    """Values between times: linear, or smooth (cubic, without jumps of slope: take this one for drives).

    Parameters
    ----------
    times : array_like, shape (k,)
        Times [s], ascending; two or more.
    values : array_like, shape (k,) or (k, m)
        Values at these times. Before the first and after the last time the value stays.
    period : float, optional
        Repeats with this period [s], at least the span of the times; beyond it the first row follows.
    smooth : bool
        Cubic instead of linear.

    Examples
    --------
    >>> push = Table([0.0, 1.0, 2.0], [(0, 0, 0), (0, 0, 5), (0, 0, 0)])
    >>> push(0.5)
    array([0. , 0. , 2.5])
    >>> wave = Table.sample(lambda t: 3.0 * t, times=[0.0, 1.0])
    >>> wave(0.25)
    array([0.75])
    """

    times: FloatArray
    values: FloatArray
    period: float | None = None
    smooth: bool = False

    def __post_init__(self) -> None:
        times = _check.array(self.times, "times", (None,))
        if len(times) < 2 or np.any(np.diff(times) <= 0):
            _check.fail("times", self.times, "must be two or more ascending numbers")
        flat = np.ndim(self.values) == 1 if not isinstance(self.values, str) else False
        values = _check.array(self.values, "values", (len(times),) if flat else (len(times), None))
        if self.period is not None:
            span = float(times[-1] - times[0])
            period = _check.number(self.period, "period", above=0)
            if period < span * (1 - 1e-12):
                _check.fail("period", period, f"must be at least the span of the times, {span:g} s")
            object.__setattr__(self, "period", period)
        object.__setattr__(self, "times", times)
        object.__setattr__(self, "values", values.reshape(len(times), -1))
        object.__setattr__(self, "smooth", _check.flag(self.smooth, "smooth"))
        closes = self.period is not None and self.period <= float(times[-1] - times[0]) * (1 + 1e-12)
        if self.smooth and closes and not np.array_equal(self.values[0], self.values[-1]):
            _check.fail("values", values[-1], "the last row must be the first where the period is the span")

    @classmethod
    def sample(
        cls,
        function: Callable[[float], ArrayLike],
        times: ArrayLike,
        period: float | None = None,
        smooth: bool = True,
    ) -> Table:
        """Table of a callable at these times: what files can hold.

        Parameters
        ----------
        function : callable
            Value at one time [s].
        times : array_like, shape (k,)
            Times [s], ascending.
        period, smooth
            As for the table; smooth by default.
        """
        if not callable(function):
            _check.fail("function", function, "must be a callable of time")
        at = _check.array(times, "times", (None,))
        return cls(at, np.array([np.asarray(function(float(t))) for t in at]), period=period, smooth=smooth)

    @property
    def size(self) -> int:
        """Number of components."""
        return int(self.values.shape[1])

    def __call__(self, t: float) -> FloatArray:
        """Value at time t [s], shape (size,)."""
        times, values, first = self.times, self.values, float(self.times[0])
        if self.period is not None:
            if self.period > (times[-1] - first) * (1 + 1e-12):
                times = np.append(times, first + self.period)
                values = np.vstack([values, values[:1]])
            t = first + (t - first) % self.period
        t = min(max(t, first), float(times[-1]))
        if self.smooth:
            from scipy.interpolate import CubicSpline

            ends = "not-a-knot" if self.period is None else "periodic"
            return np.asarray(CubicSpline(times, values, axis=0, bc_type=ends)(t), dtype=np.float64)
        k = min(max(int(np.searchsorted(times, t, side="right")) - 1, 0), len(times) - 2)
        x = (t - float(times[k])) / float(times[k + 1] - times[k])
        linear: FloatArray = values[k] + x * (values[k + 1] - values[k])
        return linear

    def document(self, register: Callable[[Function | Input], int]) -> Json:
        """Write the signal for the core."""
        return {
            "table": {
                "times": self.times.tolist(),
                "values": self.values.ravel().tolist(),
                "period": self.period,
                "smooth": self.smooth,
            }
        }


@dataclass(frozen=True)
class Ramp(Signal):
    """Rises from 0 at t = 0 to 1 at ``duration`` without jumps of slope or curvature, and stays there.

    Parameters
    ----------
    duration : float
        Duration [s], above 0.

    Examples
    --------
    >>> lift = (0, 0, 5.0) * Ramp(2.0)
    >>> lift(1.0)
    array([0. , 0. , 2.5])
    """

    duration: float

    def __post_init__(self) -> None:
        object.__setattr__(self, "duration", _check.number(self.duration, "duration", above=0))

    @property
    def size(self) -> int:
        """Number of components."""
        return 1

    def __call__(self, t: float) -> FloatArray:
        """Value at time t [s], shape (size,)."""
        x = min(max(t / self.duration, 0.0), 1.0)
        return np.array([x**3 * (10.0 + x * (6.0 * x - 15.0))])

    def document(self, register: Callable[[Function | Input], int]) -> Json:
        """Write the signal for the core."""
        return {"ramp": {"duration": self.duration}}


@dataclass(frozen=True)
class Input(Signal):
    """A value that :meth:`pliant.Stepper.set_input` sets while the model runs, by its name.

    Loads may share an input. Over the next step the value goes from what it was to what it was set to.

    Parameters
    ----------
    name : str
        Name for ``set_input``.
    initial : float or array_like, shape (3,)
        Value until it is set, in statics, and in modes.

    Examples
    --------
    >>> import pliant as pl
    >>> model = pl.Model()
    >>> ball = model.add_point_mass(2.0, at=(0, 0, 0))
    >>> push = model.add_force(ball, (1, 0, 0) * pl.Input("thrust"))
    >>> stepper = pl.Stepper(model, step=0.1)
    >>> stepper.set_input("thrust", 4.0)
    >>> stepper.advance(10)
    >>> print(f"{stepper.velocity(ball.center)[0]:.1f}")
    1.9
    """

    name: str
    initial: float | tuple[float, ...] = 0.0

    def __post_init__(self) -> None:
        object.__setattr__(self, "name", _check.text(self.name, "name"))
        plain = (
            _check.number(self.initial, "initial")
            if np.ndim(self.initial) == 0
            else tuple(_check.vector(self.initial, "initial").tolist())
        )
        object.__setattr__(self, "initial", plain)

    @property
    def size(self) -> int:
        """Number of components."""
        return int(np.size(self.initial))

    def __call__(self, t: float) -> FloatArray:
        """Value at time t [s], shape (size,): the initial one."""
        return np.atleast_1d(np.asarray(self.initial, dtype=np.float64))

    def inputs(self) -> Iterator[Input]:
        """Every input inside."""
        yield self

    def document(self, register: Callable[[Function | Input], int]) -> Json:
        """Write the signal for the core."""
        return {"input": {"first": register(self), "size": self.size}}


@dataclass(frozen=True, eq=False)
class Combination(Signal):
    """Sum or product of signals; scalars serve every component."""

    operation: str
    terms: tuple[Signal, ...]

    def __post_init__(self) -> None:
        object.__setattr__(self, "operation", _check.choice(self.operation, "operation", ("sum", "product")))
        object.__setattr__(self, "terms", tuple(self.terms))
        sizes = {term.size for term in self.terms} - {1}
        if len(sizes) > 1:
            raise ModelError(
                f"signals of {sorted(sizes)} components cannot be combined: sizes must agree or be 1"
            )

    @property
    def size(self) -> int:
        """Number of components."""
        return max(term.size for term in self.terms)

    @property
    def constant(self) -> bool:
        """Whether the value never changes."""
        return all(term.constant for term in self.terms)

    def __call__(self, t: float) -> FloatArray:
        """Value at time t [s], shape (size,)."""
        result = self.terms[0](t)
        for term in self.terms[1:]:
            result = result + term(t) if self.operation == "sum" else result * term(t)
        return result

    def functions(self) -> Iterator[Function]:
        """Callables inside."""
        for term in self.terms:
            yield from term.functions()

    def inputs(self) -> Iterator[Input]:
        """Every input inside."""
        for term in self.terms:
            yield from term.inputs()

    def document(self, register: Callable[[Function | Input], int]) -> Json:
        """Write the signal for the core."""
        return {self.operation: [term.document(register) for term in self.terms]}


@dataclass(frozen=True)
class LostFunction(Signal):
    """Stands where a callable stood that a result file could not keep."""

    components: int

    @property
    def size(self) -> int:
        """Number of components."""
        return self.components

    def __call__(self, t: float) -> FloatArray:
        """Value at time t [s], shape (size,)."""
        raise ModelError(
            "a Python callable of this model was not kept in the file: add the load again before running"
        )

    def document(self, register: Callable[[Function | Input], int]) -> Json:
        """Write the signal for the core."""
        self(0.0)
        raise AssertionError


def _combine(operation: str, left: object, right: object) -> Signal:
    combined = Combination(operation, (as_signal(left, "term"), as_signal(right, "term")))
    return Constant(tuple(combined(0.0).tolist())) if combined.constant else combined


def scaled(signal: Signal, t: float, factor: float, held: Mapping[str, FloatArray]) -> FloatArray:
    """Value at time t with constants scaled by the load factor of statics, as the core evaluates it.

    ``held`` are the values of the inputs by name.
    """
    if isinstance(signal, Input):
        return held[signal.name]
    if not isinstance(signal, Combination):
        return factor * signal(t) if signal.constant else signal(t)
    if signal.constant:
        return factor * signal(t)
    # A constant factor scales a function of time; it is not itself a load to be scaled again.
    inner = factor if signal.operation == "sum" else 1.0
    terms = [np.broadcast_to(scaled(term, t, inner, held), signal.size) for term in signal.terms]
    combine = np.sum if signal.operation == "sum" else np.prod
    return np.asarray(combine(terms, axis=0), dtype=np.float64)


def as_signal(value: Any, name: str, size: int | None = None) -> Signal:
    """Return ``value`` as a signal, of ``size`` components if given.

    Examples
    --------
    >>> as_signal((0, 0, 1), "force", 3)(2.0)
    array([0., 0., 1.])
    """
    signal: Signal
    if isinstance(value, Signal):
        signal = value
    elif callable(value):
        try:
            first = np.atleast_1d(np.asarray(value(0.0)))
        except Exception as error:
            raise ModelError(f"{name} = {value!r}: the callable failed at t = 0: {error}") from error
        wanted = size if size is not None else first.size
        if first.shape != (wanted,) or first.dtype.kind not in "iuf" or not np.all(np.isfinite(first)):
            _check.fail(f"{name}(0.0)", first, f"the callable must return {wanted} finite numbers")
        signal = Function(value, wanted)
    elif size == 1 or (size is None and np.ndim(value) == 0):
        signal = Constant((_check.number(value, name),))
    elif size is not None:
        signal = Constant(tuple(_check.array(value, name, (size,)).tolist()))
    else:
        signal = Constant(tuple(_check.array(value, name, (None,)).tolist()))
    if size is not None and signal.size != size:
        _check.fail(name, value, f"must have {size} components, not {signal.size}")
    return signal
