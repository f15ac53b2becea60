"""Case studies, ready to run and to change. One file a scene; ``SCENES`` lists them."""

from __future__ import annotations

from collections.abc import Callable

from pliant.scenes.bridge_catenary import bridge_catenary, elastic_catenary, loaded_catenary
from pliant.scenes.bungee import bungee, drop_test, stopping_tension
from pliant.scenes.cable_slap import cable_slap, string_and_post
from pliant.scenes.capstan import capstan
from pliant.scenes.catheter import catheter, helical_force, sinusoidal_force
from pliant.scenes.falling_rope import falling_rope
from pliant.scenes.folded_chain import folded_chain
from pliant.scenes.friction_rig import friction_rig
from pliant.scenes.galloping_line import galloping_line
from pliant.scenes.hanging_chain import hanging_chain
from pliant.scenes.knot_tightening import (
    knot_tightening,
    loop_radius,
    loose_figure_eight,
    loose_knot,
)
from pliant.scenes.net_capture import net_capture
from pliant.scenes.pendulum_winch import pendulum_winch
from pliant.scenes.quadruped import quadruped
from pliant.scenes.rope_coiling import rope_coiling, steady_coil
from pliant.scenes.scene import Expected, Scene, energy_drift
from pliant.scenes.solar_sail import SailSizes, solar_sail
from pliant.scenes.topology import centre_line, knot_determinant, linking_number, nearest_approach

__all__ = [
    "SCENES",
    "Expected",
    "SailSizes",
    "Scene",
    "bridge_catenary",
    "bungee",
    "cable_slap",
    "capstan",
    "catheter",
    "centre_line",
    "drop_test",
    "elastic_catenary",
    "energy_drift",
    "falling_rope",
    "folded_chain",
    "friction_rig",
    "galloping_line",
    "hanging_chain",
    "helical_force",
    "knot_determinant",
    "knot_tightening",
    "linking_number",
    "loaded_catenary",
    "loop_radius",
    "loose_figure_eight",
    "loose_knot",
    "nearest_approach",
    "net_capture",
    "pendulum_winch",
    "quadruped",
    "rope_coiling",
    "sinusoidal_force",
    "solar_sail",
    "steady_coil",
    "stopping_tension",
    "string_and_post",
]

SCENES: dict[str, Callable[..., Scene]] = {
    build.__name__: build
    for build in (
        falling_rope,
        bridge_catenary,
        hanging_chain,
        folded_chain,
        galloping_line,
        bungee,
        drop_test,
        pendulum_winch,
        capstan,
        cable_slap,
        catheter,
        friction_rig,
        knot_tightening,
        net_capture,
        rope_coiling,
        quadruped,
        solar_sail,
    )
}
"""Scenes by name, each with its defaults."""
