"""Checks of arguments: each returns the clean value or raises a ModelError that names argument and remedy."""

from __future__ import annotations

import math
import reprlib
from collections.abc import Iterable
from numbers import Integral, Real
from typing import NoReturn

import numpy as np

from pliant.errors import ModelError
from pliant.typing import FloatArray, IntArray

LARGEST_COUNT = 10**8


def fail(name: str, value: object, allowed: str) -> NoReturn:
    """Raise the ModelError of an argument."""
    shown = (
        np.array2string(value, threshold=6, separator=", ")
        if isinstance(value, np.ndarray)
        else reprlib.repr(value)
    )
    raise ModelError(f"{name} = {shown}: {allowed}")


def number(
    value: object,
    name: str,
    *,
    above: float | None = None,
    at_least: float | None = None,
    below: float | None = None,
    at_most: float | None = None,
) -> float:
    """Return ``value`` as a finite float within the limits."""
    x = value if type(value) is float else _real(value)
    if (
        math.isfinite(x)
        and (above is None or x > above)
        and (at_least is None or x >= at_least)
        and (below is None or x < below)
        and (at_most is None or x <= at_most)
    ):
        return x
    limits = [
        f"{word} {limit:g}"
        for word, limit in (("above", above), ("at least", at_least), ("below", below), ("at most", at_most))
        if limit is not None
    ]
    fail(name, value, "must be a finite number" + (" " + " and ".join(limits) if limits else ""))


def _real(value: object) -> float:
    """Return a real number as a float, NaN for anything else."""
    if isinstance(value, np.ndarray) and value.shape == ():
        value = value[()]
    if isinstance(value, (bool, np.bool_)) or not isinstance(value, Real):
        return math.nan
    try:
        return float(value)
    except OverflowError:
        return math.nan


def count(value: object, name: str, *, at_least: int = 1, at_most: int = LARGEST_COUNT) -> int:
    """Return ``value`` as an int within the limits."""
    if type(value) is int and at_least <= value <= at_most:
        return value
    if isinstance(value, (bool, np.bool_)) or not isinstance(value, Integral):
        fail(name, value, f"must be a whole number from {at_least} to {at_most}")
    if not at_least <= int(value) <= at_most:
        fail(name, value, f"must be a whole number from {at_least} to {at_most}")
    return int(value)


def flag(value: object, name: str) -> bool:
    """Return ``value`` as a bool."""
    if not isinstance(value, (bool, np.bool_)):
        fail(name, value, "must be True or False")
    return bool(value)


def choice(value: object, name: str, allowed: Iterable[str]) -> str:
    """Return ``value`` if it is one of the allowed words."""
    words = list(allowed)
    if not isinstance(value, str) or value not in words:
        fail(name, value, "must be " + " or ".join(f'"{word}"' for word in words))
    return value


def text(value: object, name: str) -> str:
    """Return ``value`` as a string that is not empty."""
    if not isinstance(value, str) or not value.strip():
        fail(name, value, "must be a string that is not empty")
    return value


def _holds_non_numbers(value: object) -> bool:
    if isinstance(value, (bool, np.bool_, str, bytes)):
        return True
    if isinstance(value, np.ndarray):
        return value.dtype.kind not in "iuf"
    if isinstance(value, (list, tuple)):
        return any(_holds_non_numbers(item) for item in value)
    return False


def array(value: object, name: str, shape: tuple[int | None, ...], allowed: str | None = None) -> FloatArray:
    """Return ``value`` as a fresh finite C-contiguous float array of the shape (None: any number of rows)."""
    words = ", ".join("n" if n is None else str(n) for n in shape)
    allowed = allowed or f"must be finite numbers of shape ({words}{',' if len(shape) == 1 else ''})"
    if value is None or _holds_non_numbers(value):
        fail(name, value, allowed)
    try:
        plain = np.asarray(value)
    except (ValueError, TypeError):
        fail(name, value, allowed)
    if plain.dtype.kind not in "iuf":
        fail(name, value, allowed)
    result = np.array(plain, dtype=np.float64, order="C")
    if result.ndim != len(shape) or any(
        n is not None and n != m for n, m in zip(shape, result.shape, strict=True)
    ):
        fail(name, value, f"{allowed}, not {result.shape}")
    if not np.isfinite(result).all():
        where = tuple(int(i) for i in np.argwhere(~np.isfinite(result))[0])
        at = ", ".join(map(str, where))
        fail(f"{name}[{at}]", float(result[where]), f"{allowed}")
    return result


def vector(value: object, name: str) -> FloatArray:
    """Return ``value`` as three finite floats."""
    return array(value, name, (3,), "must be three finite numbers")


def triple(value: object, name: str) -> tuple[float, float, float]:
    """Return ``value`` as three finite floats, not an array."""
    if type(value) is tuple and len(value) == 3:
        x, y, z = value
        if type(x) is type(y) is type(z) is float and math.isfinite(x + y + z):
            return x, y, z
    x, y, z = vector(value, name).tolist()
    return x, y, z


def points(value: object, name: str, at_least: int) -> FloatArray:
    """Return ``value`` as (n, 3) finite floats with at least so many rows."""
    result = array(value, name, (None, 3))
    if not at_least <= len(result) <= LARGEST_COUNT:
        fail(name, value, f"must have at least {at_least} rows of three numbers")
    return result


def integers(value: object, name: str, shape: tuple[int | None, ...]) -> IntArray:
    """Return ``value`` as whole numbers of the shape."""
    result = array(value, name, shape)
    if np.any(result != np.round(result)) or np.any(np.abs(result) > LARGEST_COUNT):
        fail(name, value, "must be whole numbers")
    return result.astype(np.int64)
