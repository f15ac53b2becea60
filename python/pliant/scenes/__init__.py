"""Case studies, ready to run and to change. One file a scene; ``SCENES`` lists them."""

from __future__ import annotations

from collections.abc import Callable

from pliant.scenes.falling_rope import falling_rope
from pliant.scenes.scene import Scene

__all__ = ["SCENES", "Scene", "falling_rope"]

SCENES: dict[str, Callable[[], Scene]] = {"falling_rope": falling_rope}
"""Scenes by name, each with its defaults."""
